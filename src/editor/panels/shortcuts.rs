//! The page under `?`: every key, from the table of actions, and the gestures of viewport and canvas.

use egui::{Align, Align2, Key, Layout, Modifiers, RichText, ScrollArea, Ui, Window, vec2};

use super::key_text;
use crate::editor::action::ACTIONS;

/// What the mouse does.
const GESTURES: &[[&str; 2]] = &[
    ["Drag on the picture", "Orbit"],
    ["Shift or middle drag", "Pan"],
    ["Wheel", "Come nearer"],
    ["Right drag, W A S D Q E", "Look around and fly"],
    ["Ctrl wheel, Ctrl drag", "Zoom and move the picture"],
    ["Drag the slice's knob", "Move the slice plane"],
    ["Wheel or drag, slice flat", "Move it through the field"],
    ["Double-click a node", "Look at its picture"],
    ["Double-click its header", "Rename it"],
    ["Double-click a group", "Open it"],
    ["Double-click a wire", "Bend it there"],
    ["Drag a port into the empty", "Add a node that fits"],
    ["Drag a port to a group's edge", "Make it a port of the group"],
    ["Drag a node onto a wire", "Insert it"],
    ["Space drag, middle drag", "Move the canvas"],
    ["Arrows, Enter", "Walk the nodes, inspect one"],
];

/// The blocks of each column, from left to right.
const COLUMNS: [&[&str]; 4] = [&["File", "Edit"], &["Node", "Help"], &["View"], &[MOUSE]];
const MOUSE: &str = "Mouse";
/// Points between columns.
const GAP: f32 = 20.0;

/// What stands in a block: words, and keys or what a gesture does.
fn lines(ui: &Ui, block: &str) -> Vec<[String; 2]> {
    if block == MOUSE {
        return GESTURES.iter().map(|[gesture, what]| [(*gesture).to_owned(), (*what).to_owned()]).collect();
    }
    let specs = ACTIONS.iter().filter(|spec| spec.menu == block && spec.shortcut.is_some());
    specs.map(|spec| [spec.label.to_owned(), key_text(ui.ctx(), spec)]).collect()
}

/// Of the two parts of a line. Said, not measured: what measures itself is drawn once as it is not.
fn widths(block: &str) -> [f32; 2] {
    if block == MOUSE { [190.0, 180.0] } else { [146.0, 104.0] }
}

/// Draws the page while it is open. As many columns stand side by side as the window has room for.
pub fn show(ui: &Ui, open: &mut bool) {
    if *open && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
        *open = false;
    }
    let room = ui.ctx().content_rect().shrink(24.0);
    let width_of = |column: &[&str]| {
        let [left, right] = widths(column[0]);
        left + right + GAP
    };
    let all: f32 = COLUMNS.iter().map(|column| width_of(column)).sum();
    let n_columns = COLUMNS.len().min((COLUMNS.len() as f32 * room.width() / all) as usize).max(1);
    let window = Window::new("Shortcuts").open(open).collapsible(false).resizable(false);
    window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(ui.ctx(), |ui| {
        // A window of a size of its own would be too low for all and scroll.
        let height = room.height() - 60.0;
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = GAP;
                for columns in COLUMNS.chunks(COLUMNS.len().div_ceil(n_columns)) {
                    ui.vertical(|ui| columns.concat().into_iter().for_each(|block| show_block(ui, block)));
                }
            });
        });
    });
}

fn show_block(ui: &mut Ui, block: &str) {
    ui.spacing_mut().item_spacing = vec2(0.0, 4.0);
    ui.strong(block);
    let [left, right] = widths(block);
    for [words, what] in lines(ui, block) {
        let what = RichText::new(what).weak();
        let what = if block == MOUSE { what } else { what.monospace() };
        ui.horizontal(|ui| {
            cell(ui, left, words.into());
            cell(ui, right, what);
        });
    }
    ui.add_space(10.0);
}

fn cell(ui: &mut Ui, width: f32, text: RichText) {
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, 18.0), layout, |ui| {
        ui.set_min_width(width);
        ui.label(text);
    });
}
