//! What is asked of the worker, and what its answers change.

use glam::{DMat4, DVec3};

use super::{App, PicturesSeen};
use crate::editor::NodeState;
use crate::editor::look::{self, Look, Matter};
use crate::editor::player::{Broken, LOADER};
use crate::editor::viewport::{self, Picture, SLICE, Tone};
use crate::editor::worker::{Ask, Reply, Solved};
use crate::gpu::OUT_OF_MEMORY;
use crate::graph::{Document, Event, Node, PortType, Value, Wire};
use crate::image::tonemap::Curve;
use crate::image::{Image, Table};
use crate::volume::Volume;
use crate::wire::Medium;

/// The last request.
pub struct Asked {
    revision: u64,
    frame: Option<i64>,
    is_drag: bool,
    look: Option<Look>,
    slice: Option<(Node, Wire)>,
    number: u64,
    /// The first request of this revision: what came of an earlier one says nothing of its frames.
    first: u64,
    /// What was asked, flat.
    pub(super) document: Document,
}

#[cfg(test)]
impl Asked {
    /// Counts requests.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The frame that was asked for.
    pub fn frame(&self) -> Option<i64> {
        self.frame
    }

    /// The slice plane that was asked for.
    pub fn slice(&self) -> Option<&(Node, Wire)> {
        self.slice.as_ref()
    }
}

impl App {
    /// Asks for the picture of the document as it is now.
    pub(super) fn ask(&mut self, context: &egui::Context) {
        let now = context.input(|input| input.time);
        let is_down = context.input(|input| input.pointer.any_down());
        let is_drag = is_down || self.viewport.is_moving(now) || self.player.is_playing();
        let frame = self.asks_frame();
        let is_changed = frame.is_some_and(|frame| self.player.unmark_changed(frame));
        if frame.is_some_and(|frame| self.player.broken.contains_key(&frame)) {
            // Nobody tells that a file was mended.
            context.request_repaint_after_secs(1.0);
            return;
        }
        let revision = self.project.revision();
        let flat = self.flat();
        let slice = self.viewport.slice.node(&flat);
        let is_known = self.asked.as_ref().is_some_and(|asked| {
            // A pointer that goes down changes nothing; when it goes up, the rest is made up for.
            !is_changed
                && (asked.revision, asked.frame) == (revision, frame)
                && asked.look == self.look
                && asked.slice == slice
                && (is_drag || !asked.is_drag)
        });
        if is_known {
            return;
        }
        let document = Document::clone(&flat);
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
        let matter = look.iter().filter_map(|look| look.matter.as_ref());
        let mut wanted: Vec<String> = matter.map(|matter| matter.output.node.clone()).collect();
        self.figures.progress = [0, rest.len()];
        let mut with_slice = document.clone();
        let beside = match self.viewport.slice.add_to(&mut with_slice) {
            true => vec![SLICE.to_owned()],
            false => Vec::new(),
        };
        wanted.extend(beside.iter().cloned());
        let frames = frame.map(|frame| self.player.kept(frame)).unwrap_or_default();
        let is_restart = std::mem::take(&mut self.restarts);
        let ask = Ask { document: with_slice, looked_at, rest, beside, wanted, frames, is_drag, is_restart };
        let number = self.worker.ask(ask);
        self.viewport.slice.asked(number);
        let of_revision = self.asked.as_ref().filter(|asked| asked.revision == revision);
        let first = of_revision.map_or(number, |asked| asked.first);
        self.asked = Some(Asked { revision, frame, is_drag, look, slice, number, first, document });
    }

    /// Opens the device anew, and looks again at frames that were broken.
    pub(super) fn retry(&mut self) {
        (self.asked, self.spanned, self.restarts) = (None, None, true);
        self.figures.trouble = None;
    }

    pub(super) fn listen(&mut self, context: &egui::Context) {
        for (number, reply) in self.worker.replies() {
            let is_last = self.asked.as_ref().is_none_or(|asked| asked.number == number);
            match reply {
                Reply::Opened(adapter) => {
                    self.figures.adapter = Some(adapter);
                    self.figures.trouble = None;
                }
                Reply::Event { event, is_full, frame } => {
                    let is_of_revision = self.asked.as_ref().is_some_and(|asked| number >= asked.first);
                    self.note(event, is_full && is_last, frame.filter(|_| is_of_revision));
                }
                Reply::Solved(solved) => self.take(context, solved, number),
                Reply::Kept { loaded, cached } if is_last => {
                    (self.player.loaded, self.player.cached) = (loaded, cached);
                }
                Reply::Kept { .. } => {}
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

    pub(super) fn take(&mut self, context: &egui::Context, solved: Solved, number: u64) {
        let Solved { level, frame, values, costs, wall_ms, cache_bytes, gpu_bytes } = solved;
        let is_last = self.asked.as_ref().is_none_or(|asked| asked.number == number);
        let (of_slice, values): (Vec<_>, Vec<_>) = values.into_iter().partition(|(name, ..)| name == SLICE);
        if let [(_, _, image), (_, _, plane)] = of_slice.as_slice() {
            self.viewport.slice.take(number, image, plane.get::<Table>());
        }
        (self.figures.cache_bytes, self.figures.gpu_bytes) = (cache_bytes, gpu_bytes);
        let source = self.look.as_ref().map(|look| look.source.clone());
        let is_source =
            |name: &str, port: &str| source.as_ref().is_some_and(|end| end.node == name && end.port == port);
        let has_picture = values.iter().any(|(name, port, _)| is_source(name, port));
        for (name, port, value) in values {
            if value.kind == PortType::Image {
                if is_source(&name, port) {
                    self.figures.trouble = None;
                    let count = self.pictures_seen.count + 1;
                    self.pictures_seen = PicturesSeen { count, is_whole: level.is_full() };
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
                    if let Some(frame) = frame.filter(|_| is_last && level.is_full()) {
                        self.player.cached.insert(frame);
                    }
                }
                self.small_picture(context, &name, value.get());
                self.pictures.insert(name, Picture { value, level });
            } else if let Some(matter) = self.matter_of(&name, port)
                && (level.is_full() || self.bounds().is_none())
                // What a picture shows has been decoded for it; the window must not wait for that.
                && (value.kind == PortType::Medium || has_picture)
            {
                // Coarse, it fills the same box, but for a cell. Its box alone: the fields are the cache's to keep or drop.
                self.bounds = box_of(&value, matter.grid.as_deref()).map(|bounds| (matter, bounds));
            }
        }
        if level.is_full() {
            for cost in costs.into_iter().filter(|cost| !cost.cached) {
                self.statuses.entry(cost.name).or_default().gpu_ms = cost.gpu_ms;
            }
        }
    }

    /// What is shown, if this output gives it.
    fn matter_of(&self, name: &str, port: &str) -> Option<Matter> {
        let matter = self.look.as_ref()?.matter.as_ref()?;
        (matter.output.node == name && matter.output.port == port).then(|| matter.clone())
    }

    /// The box of what is shown now, in meters.
    pub(super) fn bounds(&self) -> Option<[DVec3; 2]> {
        let (of, bounds) = self.bounds.as_ref()?;
        (self.look.as_ref()?.matter.as_ref()? == of).then_some(*bounds)
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
    pub(super) fn note(&mut self, event: Event, counts: bool, frame: Option<i64>) {
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
        if name == SLICE {
            match event {
                Event::Failed { message, .. } => self.viewport.slice.fail(message),
                Event::Skipped { because, .. } => self.viewport.slice.fail(format!("{because} failed")),
                Event::Started { name } => self.figures.running = Some(name),
                _ => {}
            }
            return;
        }
        if let Some(frame) = frame {
            self.note_frame(&event, frame);
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
            }
            Event::Skipped { because, .. } => status.state = NodeState::Skipped(because),
            Event::Cancelled => {}
        }
    }

    /// Notes what a node says of a frame: that its file has been read, or that it has no picture.
    fn note_frame(&mut self, event: &Event, frame: i64) {
        let Some(asked) = &self.asked else { return };
        let document = &asked.document;
        let is_loader = |name: &str| document.nodes.get(name).is_some_and(|node| node.type_id == LOADER);
        match event {
            Event::Finished { name, .. } if is_loader(name) => drop(self.player.loaded.insert(frame)),
            Event::Failed { name, message } if !message.starts_with(OUT_OF_MEMORY) => {
                // A damaged file may fail where its grids are decoded, which is a node that reads the loader.
                let reads_file = look::above(document, name).into_iter().any(is_loader);
                let is_seen = asked
                    .look
                    .as_ref()
                    .is_some_and(|look| look::above(document, &look.source.node).contains(&name.as_str()));
                if reads_file && is_seen {
                    let files = look::files_above(document, name, frame);
                    self.player.broken.insert(frame, Broken::told(name, message, files));
                }
            }
            _ => {}
        }
    }

    /// Why there is no picture of the document as it is: the frame or node that failed, and its message.
    pub(super) fn problem(&self) -> Option<(String, String)> {
        if let Some(broken) = self.player.broken.get(&self.player.frame).filter(|_| self.has_frames()) {
            return Some((format!("Frame {}", self.player.frame), broken.why.clone()));
        }
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

/// The box around what a medium or a volume's grid fills, in meters; `None` where there is no such grid.
fn box_of(value: &Value, grid: Option<&str>) -> Option<[DVec3; 2]> {
    if value.kind == PortType::Medium {
        let lattice = &value.get::<Medium>().lattice;
        return Some(box_around(lattice.occupied, lattice.world_from_index));
    }
    let (dense, _) = value.get::<Volume>().signed_grid(grid?).ok()?;
    Some(box_around(dense.dims, dense.world_from_index))
}

/// The box around so many cells, in meters.
fn box_around(n_cells: [usize; 3], world_from_index: DMat4) -> [DVec3; 2] {
    let high = DVec3::from_array(n_cells.map(|n| n as f64 - 0.5));
    let corner = |n: usize| {
        let pick = |axis: usize| if n >> axis & 1 == 0 { -0.5 } else { high[axis] };
        world_from_index.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
    };
    let first = corner(0);
    (1..8).map(corner).fold([first; 2], |[low, high], corner| [low.min(corner), high.max(corner)])
}
