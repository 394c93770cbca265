//! What is asked of the worker, and what its answers change.

use glam::DVec3;

use super::App;
use crate::editor::NodeState;
use crate::editor::look::{self, Look};
use crate::editor::viewport::{self, Picture, Tone};
use crate::editor::worker::{Ask, Reply, Solved};
use crate::graph::{Document, Event, PortType, flatten};
use crate::image::Image;
use crate::image::tonemap::Curve;
use crate::nodes::catalog;
use crate::volume::Lattice;
use crate::wire::Medium;

/// The last request.
pub struct Asked {
    revision: u64,
    frame: Option<i64>,
    is_drag: bool,
    look: Option<Look>,
    number: u64,
    /// What was asked, flat.
    document: Document,
}

impl App {
    /// Asks for the picture of the document as it is now.
    pub(super) fn ask(&mut self, context: &egui::Context) {
        let now = context.input(|input| input.time);
        let is_down = context.input(|input| input.pointer.any_down());
        let is_drag = is_down || self.viewport.is_moving(now) || self.player.is_playing();
        let frame = self.asks_frame();
        if frame.is_some_and(|frame| self.player.broken.contains(&frame)) {
            return;
        }
        let revision = self.project.revision();
        let is_known = self.asked.as_ref().is_some_and(|asked| {
            // A pointer that goes down changes nothing; when it goes up, the rest is made up for.
            (asked.revision, asked.frame) == (revision, frame)
                && asked.look == self.look
                && (is_drag || !asked.is_drag)
        });
        if is_known {
            return;
        }
        let mut document = flatten(self.project.document(), catalog()).into_owned();
        document.frame = frame;
        let changed: Vec<String> = match &self.asked {
            Some(asked) => look::changed(&asked.document, &document).into_iter().map(str::to_owned).collect(),
            None => Vec::new(),
        };
        for name in changed {
            let status = self.statuses.entry(name).or_default();
            if status.state != NodeState::Idle {
                status.state = NodeState::Stale;
            }
        }
        self.statuses.retain(|name, _| document.nodes.contains_key(name));
        self.pictures.retain(|name, _| document.nodes.contains_key(name));
        self.thumbnails.retain(|name, _| document.nodes.contains_key(name));
        let look = self.look.clone();
        let looked_at = look.iter().map(|look| look.source.node.clone()).collect();
        let mut rest = look::harmless(&document);
        // The node that is looked at comes first among the rest, and its tone_map tells its own errors.
        rest.sort_by_key(|name| look.as_ref().is_none_or(|look| look.tone.as_ref() != Some(name)));
        let wanted = look.iter().filter_map(|look| look.medium.clone()).collect();
        self.figures.progress = [0, rest.len()];
        let ask = Ask { document: document.clone(), looked_at, rest, wanted, is_drag };
        let number = self.worker.ask(ask);
        self.asked = Some(Asked { revision, frame, is_drag, look, number, document });
    }

    pub(super) fn listen(&mut self, context: &egui::Context) {
        for (number, reply) in self.worker.replies() {
            let is_last = self.asked.as_ref().is_none_or(|asked| asked.number == number);
            match reply {
                Reply::Opened(adapter) => {
                    self.figures.adapter = Some(adapter);
                    self.figures.trouble = None;
                }
                Reply::Event { event, is_full } => self.note(event, is_full && is_last),
                Reply::Solved(solved) => self.take(context, solved, is_last),
                Reply::Rested => self.figures.running = None,
                Reply::Trouble { message, retries } => {
                    self.figures.running = None;
                    self.figures.trouble = Some((message, retries));
                }
            }
        }
        let failed = self.statuses.values().filter(|status| matches!(status.state, NodeState::Failed(_)));
        self.figures.n_failed = failed.count();
    }

    fn take(&mut self, context: &egui::Context, solved: Solved, is_last: bool) {
        let Solved { level, values, costs, wall_ms, cache_bytes, gpu_bytes } = solved;
        (self.figures.cache_bytes, self.figures.gpu_bytes) = (cache_bytes, gpu_bytes);
        let source = self.look.as_ref().map(|look| look.source.clone());
        for (name, port, value) in values {
            if value.kind == PortType::Image {
                let is_looked_at =
                    source.as_ref().is_some_and(|source| source.node == name && source.port == port);
                if is_looked_at {
                    self.figures.trouble = None;
                    match level.is_full() {
                        true if wall_ms > 1.0
                            && costs.iter().any(|cost| cost.name == name && !cost.cached) =>
                        {
                            self.figures.picture_ms = Some(wall_ms);
                        }
                        false if self.asked.as_ref().is_some_and(|asked| asked.is_drag) => {
                            self.figures.preview_ms = Some(wall_ms);
                        }
                        _ => {}
                    }
                    if let Some(frame) = self.asked.as_ref().and_then(|asked| asked.frame).filter(|_| is_last)
                    {
                        self.player.known.insert(frame);
                    }
                }
                self.small_picture(context, &name, value.get());
                self.pictures.insert(name, Picture { value, level });
            } else if value.kind == PortType::Medium && level.is_full() {
                // Its lattice alone: the medium's fields are the cache's to keep or drop.
                self.lattice = Some(value.get::<Medium>().lattice.clone());
            }
        }
        if level.is_full() {
            for cost in costs.into_iter().filter(|cost| !cost.cached) {
                self.statuses.entry(cost.name).or_default().gpu_ms = cost.gpu_ms;
            }
        }
    }

    /// The picture of a node, as small as the canvas shows it.
    fn small_picture(&mut self, context: &egui::Context, name: &str, image: &Image) {
        // What a tone_map gives is display light already.
        let kind = self.project.document().node(name).map(|node| node.type_id.as_str());
        let curve = if kind == Some("raymarch") { Curve::Aces } else { Curve::None };
        let small = viewport::thumbnail(image, Tone { exposure_ev: 0.0, curve });
        match self.thumbnails.get_mut(name) {
            Some(texture) => texture.set(small, egui::TextureOptions::LINEAR),
            None => {
                let texture =
                    context.load_texture(format!("small {name}"), small, egui::TextureOptions::LINEAR);
                self.thumbnails.insert(name.to_owned(), texture);
            }
        }
    }

    /// Notes what a node does. `counts` where it is of the document as it is now.
    fn note(&mut self, event: Event, counts: bool) {
        let (Event::Started { name }
        | Event::Finished { name, .. }
        | Event::Failed { name, .. }
        | Event::Skipped { name, .. }) = &event
        else {
            return;
        };
        if let Some((_, frame)) = name.split_once('@') {
            // It ran for the sake of another frame; what it says of that one is not this one's.
            self.figures.running = Some(format!("{name} (frame {frame})"));
            return;
        }
        let name = name.clone();
        let status = self.statuses.entry(name.clone()).or_default();
        match event {
            Event::Started { .. } => {
                status.state = NodeState::Running;
                self.figures.running = Some(name);
            }
            Event::Finished { cached, cpu_ms, bytes, report, .. } => {
                if !counts {
                    // A preview's, or an older document's.
                    if status.state == NodeState::Running {
                        status.state = NodeState::Stale;
                    }
                    return;
                }
                (status.state, status.cached, status.bytes, status.report) =
                    (NodeState::Done, cached, bytes, report);
                if !cached {
                    status.cpu_ms = cpu_ms;
                }
                let done = self.statuses.values().filter(|status| status.state == NodeState::Done);
                self.figures.progress[0] = done.count();
            }
            Event::Failed { message, .. } => {
                status.state = NodeState::Failed(message);
                let asked = self.asked.as_ref();
                let is_loader =
                    asked.and_then(|asked| asked.document.nodes.get(&name)).map(|node| &node.type_id);
                if let (true, Some(frame)) =
                    (is_loader.is_some_and(|kind| kind == "load_vdb"), asked.and_then(|asked| asked.frame))
                {
                    self.player.broken.insert(frame);
                }
            }
            Event::Skipped { because, .. } => status.state = NodeState::Skipped(because),
            Event::Cancelled => {}
        }
    }

    /// Why there is no picture of the document as it is: the node that failed, and its message.
    pub(super) fn problem(&self) -> Option<(String, String)> {
        let source = &self.look.as_ref()?.source.node;
        let name = match &self.statuses.get(source)?.state {
            NodeState::Failed(_) => source,
            NodeState::Skipped(because) => because,
            _ => return None,
        };
        match &self.statuses.get(name)?.state {
            NodeState::Failed(message) => Some((name.clone(), message.clone())),
            _ => None,
        }
    }
}

/// The box around the occupied cells, in meters.
pub fn bounds(lattice: &Lattice) -> [DVec3; 2] {
    let high = DVec3::from_array(lattice.occupied.map(|n| n as f64 - 0.5));
    let corner = |n: usize| {
        let pick = |axis: usize| if n >> axis & 1 == 0 { -0.5 } else { high[axis] };
        lattice.world_from_index.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
    };
    let first = corner(0);
    (1..8).map(corner).fold([first; 2], |[low, high], corner| [low.min(corner), high.max(corner)])
}
