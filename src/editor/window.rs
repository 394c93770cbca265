//! The window, and what becomes of the graph where the window's own GPU goes away.
//!
//! The device that draws the window is eframe's, which opens it once and has no way to open another (a surface alone it
//! makes anew). So where it is lost the window ends, leaves its graph with all steps of undo, and another is opened on
//! it. One that is lost at once again ends the program: what is not saved is written down and offered at the next start.
//!
//! Limits: what is no part of the graph (what is selected, the part of the canvas that is seen) begins anew. Tested
//! without a device; seen under Xvfb with one that was destroyed.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use super::project::{Autosave, state_folder};
use super::{App, EditorError, Project};
use crate::gpu::{AdapterChoice, Faults};

/// What one window leaves to the next.
#[derive(Debug, Default)]
pub struct Left {
    /// The graph, where one was open.
    pub project: Option<Project>,
    /// Why the device is gone; `None` for the first window.
    pub why: Option<String>,
    /// What is written down of the graph, until the next window writes it.
    pub autosave: Option<Autosave>,
}

/// Where it is left.
pub type Place = Rc<RefCell<Option<Left>>>;

/// A device that is lost sooner would be lost again.
const SHORTEST: Duration = Duration::from_secs(20);

/// Opens a window, and after it another wherever its device was lost.
///
/// # Errors
/// Where the window cannot be opened, or its device is lost too soon.
pub fn run(project: Option<Project>, adapter: &AdapterChoice) -> Result<(), EditorError> {
    let place = Place::new(RefCell::new(Some(Left { project, ..Left::default() })));
    loop {
        let start = Instant::now();
        let ended = open(&place, adapter);
        let message = match ended {
            Ok(()) if place.borrow().is_none() => return Ok(()),
            Ok(()) if start.elapsed() > SHORTEST => continue,
            Ok(()) => {
                let secs = start.elapsed().as_secs();
                format!(
                    "the window's GPU was lost after {secs} s: update its driver; tyndall render needs no window"
                )
            }
            Err(error) => format!("the window cannot be opened: {error}"),
        };
        let kept = match place.take() {
            Some(Left { project: Some(project), why: Some(_), autosave }) => {
                Autosave::write_down(&project, state_folder(), autosave)
            }
            _ => "",
        };
        return Err(EditorError::Window(format!("{message}{kept}")));
    }
}

/// Opens a window on what was left, and stays until it is closed.
fn open(place: &Place, adapter: &AdapterChoice) -> Result<(), eframe::Error> {
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_title("Tyndall").with_inner_size([1280.0, 800.0]),
        ..Default::default()
    };
    let (adapter, place) = (adapter.clone(), Rc::clone(place));
    let create: eframe::AppCreator = Box::new(move |context| {
        let Left { project, why, autosave } = place.take().unwrap_or_default();
        let mut app = App::new(&context.egui_ctx, project, &adapter, state_folder());
        if let Some(state) = &context.wgpu_render_state {
            app.watch(Faults::of(&state.device), place);
        }
        if let Some(why) = why {
            app.tell_lost(&why);
            app.go_on_with(autosave);
        }
        Ok(Box::new(app))
    });
    eframe::run_native("tyndall", options, create)
}
