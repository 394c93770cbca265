//! The window: panels, and what passes between them.

use super::action::{self, Action};
use super::canvas::Canvas;
use super::viewport::Viewport;
use super::worker::Reply;
use super::{NodeState, Project, Selection, Statuses, Worker, inspector};
use crate::gpu::AdapterChoice;
use crate::graph::{Event, PortType, Value};
use crate::image::Image;
use crate::nodes::catalog;

/// The editor.
pub struct App {
    project: Project,
    selection: Selection,
    statuses: Statuses,
    worker: Worker,
    canvas: Canvas,
    viewport: Viewport,
    picture: Option<Value>,
    /// The revision that was last asked for.
    asked: Option<u64>,
}

impl App {
    /// On a graph, or on the start page.
    pub fn new(context: &egui::Context, project: Option<Project>, adapter: &AdapterChoice) -> Self {
        let waker = context.clone();
        Self {
            project: project.unwrap_or_default(),
            selection: Selection::default(),
            statuses: Statuses::default(),
            worker: Worker::start(adapter, move || waker.request_repaint()),
            canvas: Canvas::default(),
            viewport: Viewport::default(),
            picture: None,
            asked: None,
        }
    }

    /// Does what was asked for.
    pub fn perform(&mut self, action: Action) {
        match action {
            Action::Undo => drop(self.project.undo()),
            Action::Redo => drop(self.project.redo()),
            Action::Save => {}
        }
    }

    /// Asks for the picture of the document as it is now.
    fn ask(&mut self) {
        if self.asked == Some(self.project.revision()) {
            return;
        }
        self.asked = Some(self.project.revision());
        let document = self.project.document();
        let mut givers = document.nodes.iter().filter_map(|(name, node)| {
            let spec = catalog().find(&node.type_id)?;
            let image = spec.outputs.iter().find(|port| port.kind == PortType::Image)?;
            Some((name.clone(), image.name))
        });
        if let Some((name, port)) = givers.next_back() {
            self.worker.solve(document, &name, port);
        }
    }

    fn listen(&mut self) {
        for reply in self.worker.replies() {
            match reply {
                Reply::Event(event) => self.note(event),
                Reply::Solved { value, costs } => {
                    for cost in costs {
                        self.statuses.entry(cost.name).or_default().gpu_ms = cost.gpu_ms;
                    }
                    self.picture = value.or(self.picture.take());
                }
                Reply::NoDevice(_) => {}
            }
        }
    }

    fn note(&mut self, event: Event) {
        let (Event::Started { name }
        | Event::Finished { name, .. }
        | Event::Failed { name, .. }
        | Event::Skipped { name, .. }) = &event
        else {
            return;
        };
        let status = self.statuses.entry(name.clone()).or_default();
        match event {
            Event::Started { .. } => status.state = NodeState::Running,
            Event::Finished { cached, cpu_ms, bytes, report, .. } => {
                (status.state, status.cached, status.bytes, status.report) =
                    (NodeState::Done, cached, bytes, report);
                if !cached {
                    status.cpu_ms = cpu_ms;
                }
            }
            Event::Failed { message, .. } => status.state = NodeState::Failed(message),
            Event::Skipped { because, .. } => status.state = NodeState::Skipped(because),
            Event::Cancelled => {}
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.listen();
        for action in action::pressed(ui.ctx()) {
            self.perform(action);
        }
        egui::Panel::right("inspector").default_size(300.0).show(ui, |ui| {
            inspector::show(ui, &mut self.project, &self.selection);
        });
        egui::Panel::bottom("canvas").resizable(true).default_size(360.0).show(ui, |ui| {
            self.canvas.show(ui, &mut self.project, &mut self.selection, &self.statuses);
        });
        egui::CentralPanel::default().show(ui, |ui| {
            self.viewport.show(ui, self.picture.as_ref().map(|value| value.get::<Image>()));
        });
        self.ask();
    }
}
