//! Time: which frame is looked at, and how it goes on.
//!
//! Frames follow the clock: after t seconds the frame is the first plus t·fps, whatever a picture takes; those in
//! between are dropped, time is never stretched. A frame whose file is missing or broken is marked and passed over:
//! the frame before it stays in the window. Which frames there are follows from numbered sequences and from keys.
//! Pure functions of the clock, tested here.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value as Json;

use crate::graph::{Document, FileState};
use crate::volume::sequence::Sequence;

/// First and last frame of a flat document, and those in between that have no file; `None` where nothing changes
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
        let Some(path) = path.filter(|_| node.type_id == LOADER) else { continue };
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

/// The kind of node that reads a frame's file.
pub const LOADER: &str = "load_vdb";

/// Frames of the keys of a parameter, also inside of a record.
fn key_frames(json: &Json) -> Vec<i64> {
    let Some(object) = json.as_object() else { return Vec::new() };
    match object.get("keys").and_then(Json::as_array) {
        Some(keys) => keys.iter().filter_map(|key| key.get(0)?.as_i64()).collect(),
        None => object.values().flat_map(key_frames).collect(),
    }
}

/// Why a frame has no picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Broken {
    /// A line.
    pub why: String,
    /// The node that said so, and the files that it and all that it reads were made of; `None` where there is no file.
    told: Option<(String, Vec<FileState>)>,
}

impl Broken {
    /// A sequence has no such frame.
    pub fn missing() -> Self {
        Self { why: "there is no file of this frame".to_owned(), told: None }
    }

    /// A node failed that reads these files.
    pub fn told(node: &str, message: &str, files: Vec<FileState>) -> Self {
        Self { why: format!("{node}: {message}"), told: Some((node.to_owned(), files)) }
    }

    /// Whether it may be otherwise by now.
    fn is_out_of_date(&self) -> bool {
        self.told.as_ref().is_some_and(|(_, files)| !files.iter().all(FileState::is_current))
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
    /// Frames whose files have been read and are kept.
    pub loaded: BTreeSet<i64>,
    /// Frames whose whole picture is kept.
    pub cached: BTreeSet<i64>,
    /// Frames that have no picture, and why.
    pub broken: BTreeMap<i64, Broken>,
    /// First and last frame of the document; `None` where nothing changes with the frame.
    span: Option<[i64; 2]>,
    /// When and at which frame it began to play.
    started: Option<(f64, i64)>,
}

impl Player {
    /// At the first frame of a document; a frame that is inside of its span stays, and so does a range that was
    /// chosen. A frame that was broken is looked at again where the node that said so is not `as_it_was`.
    pub fn set_span(&mut self, found: Option<([i64; 2], BTreeSet<i64>)>, as_it_was: impl Fn(&str) -> bool) {
        let (span, missing) = found.unzip();
        if self.span != span {
            if self.span.is_none() {
                self.loops = true;
            }
            if self.span.is_none_or(|before| before == self.range) {
                self.range = span.unwrap_or_default();
            }
            self.span = span;
        }
        self.frame = self.frame.clamp(self.range[0], self.range[1]);
        // What an edit changed is not the picture that is kept.
        self.cached.clear();
        self.broken.retain(|_, broken| broken.told.as_ref().is_some_and(|(node, _)| as_it_was(node)));
        self.broken.extend(missing.unwrap_or_default().into_iter().map(|frame| (frame, Broken::missing())));
    }

    /// Takes the mark from a frame whose files are others by now; whether it did.
    pub fn unmark_changed(&mut self, frame: i64) -> bool {
        let is_changed = self.broken.get(&frame).is_some_and(Broken::is_out_of_date);
        if is_changed {
            self.broken.remove(&frame);
        }
        is_changed
    }

    /// Whether something changes with the frame.
    pub fn has_frames(&self) -> bool {
        self.span.is_some()
    }

    /// Frames of which something is kept and `frame`, from the furthest to the nearest, itself last.
    pub fn kept(&self, frame: i64) -> Vec<i64> {
        let mut frames: BTreeSet<i64> = self.loaded.union(&self.cached).copied().collect();
        frames.insert(frame);
        let mut frames: Vec<i64> = frames.into_iter().collect();
        frames.sort_by_key(|other| std::cmp::Reverse(other.abs_diff(frame)));
        frames
    }

    /// Ends the playing.
    pub fn stop(&mut self) {
        self.started = None;
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
    fn a_chosen_range_outlives_edits() {
        let mut player = Player::default();
        assert!(!player.has_frames());
        player.set_span(Some(([1, 10], [4].into())), |_| true);
        assert_eq!((player.frame, player.range, player.loops), (1, [1, 10], true));
        assert_eq!(player.broken.keys().copied().collect::<Vec<_>>(), [4]);
        (player.range, player.frame, player.loops) = ([1, 48], 40, false);
        player.cached.insert(40);
        player.broken.insert(40, Broken::told("medium", "damaged", Vec::new()));
        player.set_span(Some(([1, 10], [].into())), |node| node != "medium");
        assert_eq!((player.frame, player.range, player.loops), (40, [1, 48], false));
        assert!(player.cached.is_empty() && player.broken.is_empty());
        // A key at 40.
        player.set_span(Some(([1, 40], [].into())), |_| true);
        assert_eq!(player.range, [1, 48]);
        // Nobody chose: the range goes with the document.
        player.range = [1, 40];
        player.set_span(Some(([1, 20], [].into())), |_| true);
        assert_eq!((player.frame, player.range), (20, [1, 20]));
        player.set_span(None, |_| true);
        assert!(!player.has_frames());
    }

    #[test]
    fn what_is_broken_stays_so_until_it_may_be_otherwise() {
        let folder = tempfile::tempdir().unwrap();
        let [file, missing] = ["a_0002.vdb", "b_0002.vdb"].map(|name| folder.path().join(name));
        std::fs::write(&file, "damaged").unwrap();
        let files = || vec![FileState::of(&file), FileState::of(&missing)];
        let mut player = Player::default();
        let span = || Some(([1, 4], [3].into()));
        player.set_span(span(), |_| true);
        player.broken.insert(2, Broken::told("medium", "no grid", files()));
        let broken = |player: &Player| player.broken.keys().copied().collect::<Vec<_>>();
        // An edit elsewhere.
        player.set_span(span(), |node| node != "march");
        assert_eq!(broken(&player), [2, 3]);
        assert!((2..=4).all(|frame| !player.unmark_changed(frame)));
        assert_eq!(broken(&player), [2, 3]);
        // One is mended, then there is one that was not.
        for changed in [&file, &missing] {
            std::fs::write(changed, "mended now").unwrap();
            assert!(player.unmark_changed(2) && !player.unmark_changed(2));
            assert_eq!(broken(&player), [3]);
            player.broken.insert(2, Broken::told("medium", "no grid", files()));
        }
        player.set_span(span(), |node| node != "medium");
        assert_eq!(broken(&player), [3]);
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
