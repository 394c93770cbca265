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

/// A key as people write it: "Ctrl+Z".
fn key_text(context: &Context, spec: &ActionSpec) -> String {
    let text = spec.shortcut.map(|shortcut| context.format_shortcut(&shortcut)).unwrap_or_default();
    // egui writes keys by their names.
    [("Questionmark", "?"), ("Equals", "="), ("Minus", "-")]
        .into_iter()
        .fold(text, |text, (name, sign)| text.replace(name, sign))
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
            | Action::FrameMedium
            | Action::Histogram
            | Action::Slice
            | Action::StoreA
            | Action::StoreB => self.graph,
            _ => true,
        }
    }
}
