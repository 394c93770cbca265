//! Time: which frame is looked at, and how it goes on.
//!
//! Frames follow the clock: after t seconds the frame is the first plus t·fps, whatever a picture takes; those in
//! between are dropped, time is never stretched. A frame whose file is missing or broken is marked and passed over:
//! the frame before it stays in the window. Which frames there are follows from numbered sequences and from keys.
//! Pure functions of the clock, tested here.

use std::collections::BTreeSet;

use serde_json::Value as Json;

use crate::graph::Document;
use crate::volume::sequence::Sequence;

/// First and last frame of a document, and those in between that have no file; `None` where nothing changes
/// with the frame.
pub fn span(document: &Document) -> Option<([i64; 2], BTreeSet<i64>)> {
    let mut found: Option<[i64; 2]> = None;
    let mut missing = BTreeSet::new();
    let mut widen = |first: i64, last: i64| {
        found = Some(found.map_or([first, last], |[a, b]| [a.min(first), b.max(last)]));
    };
    for node in document.nodes.values() {
        for json in node.params.values() {
            let keys = key_frames(json);
            if let (Some(first), Some(last)) = (keys.iter().min(), keys.iter().max()) {
                widen(*first, *last);
            }
        }
        let path = node.params.get("path").and_then(Json::as_str);
        let Some(path) = path.filter(|_| node.type_id == "load_vdb") else { continue };
        let Ok(Sequence::Numbered { files, .. }) = Sequence::find(&document.base.join(path)) else {
            continue;
        };
        let whole = |name: &str| node.params.get(name).and_then(Json::as_i64);
        let (first, last) = (*files.keys().next().unwrap_or(&0), *files.keys().next_back().unwrap_or(&0));
        let start = whole("first_frame").unwrap_or(first);
        // The scene's frame of a file's number.
        let shift = start.saturating_sub(first).saturating_sub(whole("offset").unwrap_or(0));
        widen(first.saturating_add(shift), last.saturating_add(shift));
        let gaps = files.keys().zip(files.keys().skip(1)).flat_map(|(a, b)| a + 1..*b);
        missing.extend(gaps.take(100_000).map(|number| number.saturating_add(shift)));
    }
    Some((found?, missing))
}

/// Frames of the keys of a parameter, also inside of a record.
fn key_frames(json: &Json) -> Vec<i64> {
    let Some(object) = json.as_object() else { return Vec::new() };
    match object.get("keys").and_then(Json::as_array) {
        Some(keys) => keys.iter().filter_map(|key| key.get(0)?.as_i64()).collect(),
        None => object.values().flat_map(key_frames).collect(),
    }
}

/// The frame that is looked at.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Player {
    /// Now.
    pub frame: i64,
    /// The first and last that are played.
    pub range: [i64; 2],
    /// After the last comes the first.
    pub loops: bool,
    /// Frames whose picture is known.
    pub known: BTreeSet<i64>,
    /// Frames that have none, by their files.
    pub broken: BTreeSet<i64>,
    /// When and at which frame it began to play.
    started: Option<(f64, i64)>,
}

impl Player {
    /// At the first frame of a span; a frame that is inside of it stays.
    pub fn set_span(&mut self, range: [i64; 2], missing: BTreeSet<i64>) {
        if self.range != range {
            self.range = range;
            self.loops = true;
        }
        self.frame = self.frame.clamp(range[0], range[1]);
        self.known.clear();
        self.broken = missing;
    }

    /// Whether it goes on by itself.
    pub fn is_playing(&self) -> bool {
        self.started.is_some()
    }

    /// Begins at `now` (in seconds), or stops. At the end it begins anew.
    pub fn toggle(&mut self, now: f64) {
        let from = if self.frame >= self.range[1] { self.range[0] } else { self.frame };
        self.started = if self.is_playing() { None } else { Some((now, from)) };
    }

    /// Goes to a frame and stops.
    pub fn go_to(&mut self, frame: i64) {
        self.started = None;
        self.frame = frame.clamp(self.range[0], self.range[1]);
    }

    /// Follows the clock.
    pub fn advance(&mut self, now: f64, fps: f64) {
        let Some((then, from)) = self.started else { return };
        let [first, last] = self.range;
        let passed = from - first + ((now - then) * fps).max(0.0) as i64;
        let n_frames = last - first + 1;
        self.frame = if self.loops { first + passed.rem_euclid(n_frames) } else { last.min(first + passed) };
        if !self.loops && passed >= n_frames {
            self.started = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn time_is_never_stretched() {
        let mut player = Player { range: [10, 19], loops: true, frame: 12, ..Player::default() };
        player.toggle(100.0);
        // However seldom it is asked, the frame is that of the clock.
        for (now, frame) in [(100.0, 12), (100.05, 13), (100.25, 18), (100.34, 10), (101.0, 16)] {
            player.advance(now, 24.0);
            assert_eq!(player.frame, frame, "{now}");
        }
        player.loops = false;
        player.advance(200.0, 24.0);
        assert!(player.frame == 19 && !player.is_playing());
        player.toggle(300.0);
        player.advance(300.0, 24.0);
        assert_eq!(player.frame, 10);
        player.go_to(99);
        assert!(player.frame == 19 && !player.is_playing());
    }

    #[test]
    fn frames_follow_from_files_and_keys() {
        let folder = tempfile::tempdir().unwrap();
        for number in [3, 4, 7] {
            std::fs::write(folder.path().join(format!("a_{number:04}.vdb")), "").unwrap();
        }
        let text = |params: &str| {
            format!(
                r#"{{"tyndall": 1, "nodes": {{"a": {{"type": "load_vdb", "path": "a_####.vdb"{params}}}}}, "wires": []}}"#
            )
        };
        let span_of = |text: &str| span(&Document::parse(text, folder.path()).unwrap());
        assert_eq!(span_of(&text("")), Some(([3, 7], [5, 6].into())));
        assert_eq!(span_of(&text(r#", "first_frame": 101"#)), Some(([101, 105], [103, 104].into())));
        assert_eq!(span_of(&text(r#", "offset": 1"#)), Some(([2, 6], [4, 5].into())));
        let keyed = r#"{"tyndall": 1, "nodes": {"m": {"type": "medium", "g": {"keys": [[2, 0], [9, 0.5]]},
            "emission": {"scale": {"keys": [[12, 1]]}}}}, "wires": []}"#;
        assert_eq!(span(&Document::parse(keyed, Path::new("")).unwrap()), Some(([2, 12], [].into())));
        assert_eq!(span(&Document::default()), None);
    }
}
