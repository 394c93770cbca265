//! What stands around canvas, inspector and viewport: menus, status bar, toasts, palette, pages, timeline.
//!
//! Each is one function of what it shows; what was asked for comes back as [`Action`]s.

pub mod menu;
pub mod palette;
pub mod shortcuts;
pub mod start;
pub mod status_bar;
pub mod timeline;
pub mod toasts;
pub mod unsaved;

use egui::Context;

use super::action::{Action, ActionSpec};
use super::canvas::Command;
use super::settings::ThemeChoice;

/// A key as people write it: "Ctrl+Z".
fn key_text(context: &Context, spec: &ActionSpec) -> String {
    let text = spec.shortcut.map(|shortcut| context.format_shortcut(&shortcut)).unwrap_or_default();
    // egui writes keys by their names.
    [("Questionmark", "?"), ("Equals", "="), ("Minus", "-")]
        .into_iter()
        .fold(text, |text, (name, sign)| text.replace(name, sign))
}

/// Which of the actions that put something on or off are on.
#[derive(Debug, Clone, Copy, Default)]
pub struct Marks {
    /// Moved nodes stand on the grid.
    pub snaps: bool,
    /// The map is in the corner of the canvas.
    pub minimap: bool,
    /// The histogram is over the picture.
    pub histogram: bool,
    /// There is a slice plane.
    pub slice: bool,
    /// Which theme was chosen.
    pub theme: ThemeChoice,
}

impl Marks {
    /// Whether what an action puts on is on; `None` for one that does something once.
    pub fn is_on(self, action: Action) -> Option<bool> {
        match action {
            Action::Canvas(Command::ToggleSnap) => Some(self.snaps),
            Action::Canvas(Command::ToggleMinimap) => Some(self.minimap),
            Action::Histogram => Some(self.histogram),
            Action::Slice => Some(self.slice),
            Action::Dark => Some(self.theme == ThemeChoice::Dark),
            Action::Light => Some(self.theme == ThemeChoice::Light),
            Action::System => Some(self.theme == ThemeChoice::System),
            _ => None,
        }
    }
}

/// Whether an action can be asked for now, by what is open.
#[derive(Debug, Clone, Copy, Default)]
pub struct Possible {
    /// A graph is open.
    pub graph: bool,
    /// A step can be taken back.
    pub undo: bool,
    /// A step can be done again.
    pub redo: bool,
    /// Something changes with the frame.
    pub frames: bool,
}

impl Possible {
    /// Whether this action makes sense now.
    pub fn is(self, action: Action) -> bool {
        match action {
            Action::Undo => self.undo,
            Action::Redo => self.redo,
            Action::Play | Action::NextFrame | Action::PreviousFrame => self.frames,
            Action::Canvas(_)
            | Action::Save
            | Action::SaveAs
            | Action::Revert
            | Action::Versions
            | Action::Insert
            | Action::OtherPart
            | Action::FitPicture
            | Action::ActualSize
            | Action::FrameVolume
            | Action::Histogram
            | Action::Slice
            | Action::StoreA
            | Action::StoreB => self.graph,
            _ => true,
        }
    }
}
