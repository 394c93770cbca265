//! Everything that can be asked of the editor by key, menu or palette: one table.
//!
//! A new action is a variant, a line in [`ACTIONS`], and an arm in `App::perform`.

use egui::{Key, KeyboardShortcut, Modifiers};

/// What can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Takes the last step back.
    Undo,
    /// Does it again.
    Redo,
    /// Writes the graph to its file.
    Save,
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

/// All actions, in the order of their menus. A shortcut with more modifiers stands before the one with
/// fewer, because a shortcut is taken by the first that fits.
pub const ACTIONS: &[ActionSpec] = &[
    ActionSpec { action: Action::Save, label: "Save", menu: "File", shortcut: key(COMMAND, Key::S) },
    ActionSpec { action: Action::Redo, label: "Redo", menu: "Edit", shortcut: key(COMMAND_SHIFT, Key::Z) },
    ActionSpec { action: Action::Undo, label: "Undo", menu: "Edit", shortcut: key(COMMAND, Key::Z) },
];

/// The actions whose keys were pressed; a text field that has the keyboard keeps its own.
pub fn pressed(context: &egui::Context) -> Vec<Action> {
    if context.text_edit_focused() {
        return Vec::new();
    }
    let with_key = ACTIONS.iter().filter_map(|spec| Some((spec.action, spec.shortcut?)));
    let taken = with_key.filter(|(_, shortcut)| context.input_mut(|input| input.consume_shortcut(shortcut)));
    taken.map(|(action, _)| action).collect()
}
