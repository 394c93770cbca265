//! Everything that can be asked of the editor by key, menu or palette: one table.
//!
//! A new action is a variant, a line in [`ACTIONS`], and an arm in `App::perform`.

use egui::{Key, KeyboardShortcut, Modifiers};

use super::canvas::Command;

/// What can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// The start page.
    Start,
    /// Asks for a graph to open.
    Open,
    /// Asks for a volume to light.
    OpenVolume,
    /// Writes the graph to its file.
    Save,
    /// Asks for a file to write the graph to.
    SaveAs,
    /// Goes back to what the file holds.
    Revert,
    /// What the file held at its last saves.
    Versions,
    /// Closes the window.
    Quit,
    /// Takes the last step back.
    Undo,
    /// Does it again.
    Redo,
    /// Looks for an action by its name.
    Palette,
    /// The whole picture in the viewport.
    FitPicture,
    /// A pixel for a pixel.
    ActualSize,
    /// Looks at the whole volume.
    FrameVolume,
    /// The histogram of the picture.
    Histogram,
    /// A plane through a field.
    Slice,
    /// Keeps the picture to compare with.
    StoreA,
    /// Keeps another one.
    StoreB,
    /// Asks for a graph that becomes a group of this one.
    Insert,
    /// Plays the sequence, or stops.
    Play,
    /// The frame after this one.
    NextFrame,
    /// The frame before this one.
    PreviousFrame,
    /// Brings the keyboard to the canvas, or from there to the inspector.
    OtherPart,
    /// Larger text and controls.
    Larger,
    /// Smaller text and controls.
    Smaller,
    /// Text and controls as they were made.
    NormalSize,
    /// A dark window.
    Dark,
    /// A light window.
    Light,
    /// As the system has it.
    System,
    /// Opens the device anew and computes the picture again.
    Retry,
    /// The page of shortcuts.
    Shortcuts,
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
    /// A line parts it from what stands before it in its menu.
    pub is_apart: bool,
}

impl ActionSpec {
    const fn apart(self) -> Self {
        Self { is_apart: true, ..self }
    }
}

const fn key(modifiers: Modifiers, key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(modifiers, key))
}

const fn spec(
    action: Action,
    menu: &'static str,
    label: &'static str,
    shortcut: Option<KeyboardShortcut>,
) -> ActionSpec {
    ActionSpec { action, label, menu, shortcut, is_apart: false }
}

const fn canvas(
    command: Command,
    menu: &'static str,
    label: &'static str,
    shortcut: Option<KeyboardShortcut>,
) -> ActionSpec {
    spec(Action::Canvas(command), menu, label, shortcut)
}

const NONE: Modifiers = Modifiers::NONE;
const COMMAND: Modifiers = Modifiers::COMMAND;
const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// The menus, in their order.
pub const MENUS: [&str; 5] = ["File", "Edit", "Node", "View", "Help"];

/// All actions, in the order of their menus.
pub const ACTIONS: &[ActionSpec] = &[
    spec(Action::Start, "File", "Start page", key(COMMAND, Key::N)),
    spec(Action::OpenVolume, "File", "Open a VDB…", key(COMMAND_SHIFT, Key::O)),
    spec(Action::Open, "File", "Open a graph…", key(COMMAND, Key::O)),
    spec(Action::Save, "File", "Save", key(COMMAND, Key::S)).apart(),
    spec(Action::SaveAs, "File", "Save as…", key(COMMAND_SHIFT, Key::S)),
    spec(Action::Revert, "File", "Revert to the file", None),
    spec(Action::Versions, "File", "Earlier versions…", None),
    spec(Action::Quit, "File", "Quit", key(COMMAND, Key::Q)).apart(),
    spec(Action::Undo, "Edit", "Undo", key(COMMAND, Key::Z)),
    spec(Action::Redo, "Edit", "Redo", key(COMMAND_SHIFT, Key::Z)),
    canvas(Command::Cut, "Edit", "Cut", key(COMMAND, Key::X)).apart(),
    canvas(Command::Copy, "Edit", "Copy", key(COMMAND, Key::C)),
    canvas(Command::Paste, "Edit", "Paste", key(COMMAND, Key::V)),
    canvas(Command::Duplicate, "Edit", "Duplicate", key(COMMAND, Key::D)),
    canvas(Command::Delete, "Edit", "Delete", key(NONE, Key::Delete)),
    canvas(Command::SelectAll, "Edit", "Select all", key(COMMAND, Key::A)).apart(),
    canvas(Command::AddNode, "Node", "Add a node", key(NONE, Key::Tab)),
    canvas(Command::Rename, "Node", "Rename", key(NONE, Key::F2)),
    canvas(Command::Mute, "Node", "Mute", key(NONE, Key::M)),
    canvas(Command::Bypass, "Node", "Bypass", key(NONE, Key::B)),
    canvas(Command::Group, "Node", "Group", key(COMMAND, Key::G)).apart(),
    canvas(Command::Ungroup, "Node", "Ungroup", key(COMMAND_SHIFT, Key::G)),
    canvas(Command::OpenGroup, "Node", "Open the group", key(COMMAND, Key::ArrowDown)),
    canvas(Command::LeaveGroup, "Node", "Leave the group", key(COMMAND, Key::ArrowUp)),
    spec(Action::Insert, "Node", "Insert a graph as a group…", None),
    canvas(Command::AddFrame, "Node", "Frame with a comment", key(COMMAND_SHIFT, Key::F)).apart(),
    canvas(Command::Arrange, "Node", "Arrange nodes", key(NONE, Key::L)),
    spec(Action::Palette, "View", "Command palette", key(COMMAND_SHIFT, Key::P)),
    spec(Action::OtherPart, "View", "To canvas or inspector", key(NONE, Key::F6)),
    spec(Action::FitPicture, "View", "Fit the picture", key(COMMAND, Key::Num0)).apart(),
    spec(Action::ActualSize, "View", "Picture at 1:1", key(COMMAND, Key::Num1)),
    spec(Action::FrameVolume, "View", "Frame the volume", key(COMMAND, Key::Num2)),
    spec(Action::Slice, "View", "Slice plane", key(COMMAND, Key::Num3)),
    spec(Action::Histogram, "View", "Histogram", key(COMMAND, Key::H)),
    spec(Action::StoreA, "View", "Store picture A", key(COMMAND, Key::F1)),
    spec(Action::StoreB, "View", "Store picture B", key(COMMAND, Key::F2)),
    spec(Action::Play, "View", "Play or stop", key(COMMAND, Key::Space)).apart(),
    spec(Action::NextFrame, "View", "Next frame", key(COMMAND, Key::ArrowRight)),
    spec(Action::PreviousFrame, "View", "Previous frame", key(COMMAND, Key::ArrowLeft)),
    canvas(Command::FrameAll, "View", "Show all nodes", key(NONE, Key::Home)).apart(),
    canvas(Command::FrameSelected, "View", "Show selected nodes", key(NONE, Key::F)),
    canvas(Command::ToggleSnap, "View", "Snap to the grid", None),
    canvas(Command::ToggleMinimap, "View", "Minimap", None),
    spec(Action::Larger, "View", "Larger interface", key(COMMAND, Key::Equals)).apart(),
    spec(Action::Smaller, "View", "Smaller interface", key(COMMAND, Key::Minus)),
    spec(Action::NormalSize, "View", "Normal interface", None),
    spec(Action::Dark, "View", "Dark theme", None),
    spec(Action::Light, "View", "Light theme", None),
    spec(Action::System, "View", "System theme", None),
    spec(Action::Shortcuts, "Help", "Shortcuts", key(NONE, Key::Questionmark)),
    spec(Action::Retry, "Help", "Restart the renderer", None),
];

/// The actions whose keys were pressed, those of the canvas only while keys are meant for it; a text field
/// that has the keyboard keeps its own.
pub fn pressed(context: &egui::Context, canvas_has_keys: bool) -> Vec<Action> {
    if context.text_edit_focused() {
        return Vec::new();
    }
    let heard = ACTIONS.iter().filter(|spec| canvas_has_keys || !matches!(spec.action, Action::Canvas(_)));
    let mut with_key: Vec<_> = heard.filter_map(|spec| Some((spec.action, spec.shortcut?))).collect();
    // Ctrl+Z fits a Ctrl+Shift+Z as well: what has more modifiers is asked first.
    with_key.sort_by_key(|(_, shortcut)| std::cmp::Reverse(n_modifiers(shortcut.modifiers)));
    let taken = with_key
        .into_iter()
        .filter(|(_, shortcut)| context.input_mut(|input| input.consume_shortcut(shortcut)));
    taken.map(|(action, _)| action).collect()
}

fn n_modifiers(modifiers: Modifiers) -> usize {
    [modifiers.alt, modifiers.shift, modifiers.command].into_iter().filter(|is_down| *is_down).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_has_a_place_and_its_own_key() {
        for (idx, spec) in ACTIONS.iter().enumerate() {
            assert!(MENUS.contains(&spec.menu), "{}", spec.label);
            for other in &ACTIONS[..idx] {
                assert_ne!(spec.action, other.action);
                assert_ne!(spec.label, other.label);
                let (Some(key), Some(earlier)) = (spec.shortcut, other.shortcut) else { continue };
                assert_ne!(key, earlier, "{} and {}", spec.label, other.label);
            }
        }
    }

    #[test]
    fn the_shortcut_with_more_modifiers_is_taken() {
        let context = egui::Context::default();
        for spec in ACTIONS {
            let Some(KeyboardShortcut { modifiers, logical_key }) = spec.shortcut else { continue };
            let event = egui::Event::Key {
                key: logical_key,
                physical_key: None,
                pressed: true,
                repeat: false,
                modifiers,
            };
            let input = egui::RawInput { events: vec![event], ..Default::default() };
            let mut heard = Vec::new();
            context.run_ui(input, |ui| heard = pressed(ui.ctx(), true)).textures_delta.clear();
            assert_eq!(heard, [spec.action], "{}", spec.label);
        }
    }
}
