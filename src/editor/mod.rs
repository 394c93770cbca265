//! The editor: a window onto a graph, its pictures and its costs.
//!
//! It is a client of [`Session`](crate::session::Session): the graph lives in a [`Project`] (document,
//! undo, file), a [`Worker`] solves it on a thread of its own, and everything on the screen is drawn from
//! these two each frame. There is no second copy of the graph: the canvas draws the document, and a gesture
//! changes the document through the project, one step of undo a gesture. What it does to a graph, the
//! command line can do to a file.
//!
//! What can be done stands in one table, [`action::ACTIONS`]: shortcuts, menus, the palette and the page
//! under `?` are made from it.
//!
//! Data flow can be read as: events → actions and edits → document → worker → statuses and pictures → screen.
//!
//! Tested by `egui_kittest` through AccessKit names, and under a real window by `tests/editor`.

mod action;
mod app;
mod canvas;
mod dialog;
mod inspector;
mod look;
mod panels;
mod player;
mod presets;
mod preview;
mod project;
mod selection;
mod settings;
#[cfg(test)]
mod snapshot;
mod status;
mod theme;
mod viewport;
mod window;
mod worker;

use std::path::Path;

use crate::gpu::{AdapterChoice, adapters};
use crate::template;

pub use action::{ACTIONS, Action, ActionSpec};
pub use app::{App, PicturesSeen};
pub use project::{Autosave, Project, Recoverable, recoverable, state_folder, versions};
pub use selection::Selection;
pub use status::{NodeState, NodeStatus, Statuses};
pub use worker::Worker;

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum EditorError {
    /// The display or its driver; what to do instead.
    #[error("{0}")]
    Window(String),
    /// The graph that was to be opened.
    #[error(transparent)]
    Graph(#[from] crate::graph::DocumentError),
    /// The volume that was to be lit.
    #[error(transparent)]
    Volume(#[from] template::TemplateError),
}

/// Opens the window, on a graph, on a graph for a volume, or on the start page, and stays until it is closed.
///
/// # Errors
/// Without a display or a driver, and for a graph or a volume that cannot be read.
pub fn open(graph: Option<&Path>, adapter: &AdapterChoice) -> Result<(), EditorError> {
    let project = graph.map(project_of).transpose()?;
    if cfg!(target_os = "linux") && !has_display() {
        let remedy = "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); to render without a \
                      window, type `tyndall render GRAPH -o picture.png`";
        return Err(EditorError::Window(remedy.to_owned()));
    }
    // Asked before the window, whose own message would be obscure.
    if adapters().is_empty() {
        let remedy = "no Vulkan, Metal or DX12 driver was found; `tyndall doctor` says what to install";
        return Err(EditorError::Window(remedy.to_owned()));
    }
    window::run(project, adapter)
}

/// A graph, or a volume or folder of frames lit by [`template::new_graph`].
///
/// # Errors
/// For a graph or a volume that cannot be read.
pub fn project_of(path: &Path) -> Result<Project, EditorError> {
    if path.extension().is_some_and(|ending| ending == "vdb") || path.is_dir() {
        return Ok(Project::new(template::new_graph(&template::measure(path, true)?)));
    }
    Ok(Project::load(path)?)
}

fn has_display() -> bool {
    ["DISPLAY", "WAYLAND_DISPLAY"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}
