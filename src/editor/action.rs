//! Everything that can be asked of the editor by key, menu or palette: one table.
//!
//! A new action is a variant, a line in [`ACTIONS`], and an arm in `App::perform`.

use egui::{Key, KeyboardShortcut, Modifiers};

use super::canvas::Command;

/// What can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Takes the last step back.
    Undo,
    /// Does it again.
    Redo,
    /// Writes the graph to its file.
    Save,
    /// A command of the canvas, whose keys count while they are meant for it.
    Canvas(Command),
}

/// An action as menus, palette and the page of shortcuts show it.
#[derive(Debug)]
pub struct ActionSpec {
    /// Which.
    pub action: Action,
    /// Its name, as a command: "Undo".
    pub label: &'static str,
    /// Its menu.
    pub menu: &'static str,
    /// Its key, where it has one.
    pub shortcut: Option<KeyboardShortcut>,
}

const fn key(modifiers: Modifiers, key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(modifiers, key))
}

const COMMAND: Modifiers = Modifiers::COMMAND;
const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

const NONE: Modifiers = Modifiers::NONE;

const fn canvas(
    command: Command,
    label: &'static str,
    menu: &'static str,
    shortcut: Option<KeyboardShortcut>,
) -> ActionSpec {
    ActionSpec { action: Action::Canvas(command), label, menu, shortcut }
}

/// All actions, in the order of their menus. A shortcut with more modifiers stands before the one with
/// fewer, because a shortcut is taken by the first that fits.
pub const ACTIONS: &[ActionSpec] = &[
    ActionSpec { action: Action::Save, label: "Save", menu: "File", shortcut: key(COMMAND, Key::S) },
    ActionSpec { action: Action::Redo, label: "Redo", menu: "Edit", shortcut: key(COMMAND_SHIFT, Key::Z) },
    ActionSpec { action: Action::Undo, label: "Undo", menu: "Edit", shortcut: key(COMMAND, Key::Z) },
    canvas(Command::OpenGroup, "Open the group", "Node", key(COMMAND, Key::ArrowDown)),
    canvas(Command::LeaveGroup, "Leave the group", "Node", key(COMMAND, Key::ArrowUp)),
    canvas(Command::AddFrame, "Frame with a comment", "Node", key(COMMAND_SHIFT, Key::F)),
    canvas(Command::Ungroup, "Ungroup", "Node", key(COMMAND_SHIFT, Key::G)),
    canvas(Command::Group, "Group", "Node", key(COMMAND, Key::G)),
    canvas(Command::Mute, "Mute", "Node", key(NONE, Key::M)),
    canvas(Command::Bypass, "Bypass", "Node", key(NONE, Key::B)),
    canvas(Command::AddNode, "Add a node", "Node", key(NONE, Key::Tab)),
    canvas(Command::Cut, "Cut", "Edit", key(COMMAND, Key::X)),
    canvas(Command::Copy, "Copy", "Edit", key(COMMAND, Key::C)),
    canvas(Command::Paste, "Paste", "Edit", key(COMMAND, Key::V)),
    canvas(Command::Duplicate, "Duplicate", "Edit", key(COMMAND, Key::D)),
    canvas(Command::Delete, "Delete", "Edit", key(NONE, Key::Delete)),
    canvas(Command::SelectAll, "Select all", "Edit", key(COMMAND, Key::A)),
    canvas(Command::Rename, "Rename", "Node", key(NONE, Key::F2)),
    canvas(Command::FrameAll, "Show all nodes", "View", key(NONE, Key::Home)),
    canvas(Command::FrameSelected, "Show selected nodes", "View", key(NONE, Key::F)),
    canvas(Command::Arrange, "Arrange nodes", "Node", key(NONE, Key::L)),
    canvas(Command::ToggleSnap, "Snap to the grid", "View", None),
    canvas(Command::ToggleMinimap, "Minimap", "View", None),
];

/// The actions whose keys were pressed, those of the canvas only while keys are meant for it; a text field
/// that has the keyboard keeps its own.
pub fn pressed(context: &egui::Context, canvas_has_keys: bool) -> Vec<Action> {
    if context.text_edit_focused() {
        return Vec::new();
    }
    let heard = ACTIONS.iter().filter(|spec| canvas_has_keys || !matches!(spec.action, Action::Canvas(_)));
    let with_key = heard.filter_map(|spec| Some((spec.action, spec.shortcut?)));
    let taken = with_key.filter(|(_, shortcut)| context.input_mut(|input| input.consume_shortcut(shortcut)));
    taken.map(|(action, _)| action).collect()
}
