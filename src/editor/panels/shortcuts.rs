//! The page under `?`: every key, from the table of actions, and the gestures of viewport and canvas.

use egui::{Align2, Grid, Ui, Window};

use super::key_text;
use crate::editor::action::{ACTIONS, MENUS};

/// What the mouse does.
const GESTURES: &[(&str, &str)] = &[
    ("Drag on the picture", "Orbit"),
    ("Shift or middle drag", "Pan"),
    ("Wheel", "Come nearer"),
    ("Right drag, W A S D Q E", "Look around and fly"),
    ("Ctrl wheel, Ctrl drag", "Zoom and move the picture"),
    ("Drag the slice's knob", "Move the slice plane"),
    ("Wheel or drag, slice flat", "Move it through the field"),
    ("Double-click a node", "Look at its picture"),
    ("Double-click its header", "Rename it"),
    ("Double-click a group", "Open it"),
    ("Double-click a wire", "Bend it there"),
    ("Drag a port into the empty", "Add a node that fits"),
    ("Drag a port to a group's edge", "Make it a port of the group"),
    ("Drag a node onto a wire", "Insert it"),
    ("Space drag, middle drag", "Move the canvas"),
    ("Arrows, Enter", "Walk the nodes, to their parameters"),
];

/// Draws the page while it is open.
pub fn show(ui: &Ui, open: &mut bool) {
    let window = Window::new("Shortcuts").open(open).collapsible(false).resizable(false);
    window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(ui.ctx(), |ui| {
        ui.horizontal_top(|ui| {
            for column in [&MENUS[..2], &MENUS[2..3], &MENUS[3..]] {
                ui.vertical(|ui| {
                    for menu in column {
                        ui.strong(*menu);
                        Grid::new(("keys", menu)).num_columns(2).min_col_width(120.0).show(ui, |ui| {
                            for spec in
                                ACTIONS.iter().filter(|spec| spec.menu == *menu && spec.shortcut.is_some())
                            {
                                ui.label(spec.label);
                                ui.monospace(key_text(ui.ctx(), spec));
                                ui.end_row();
                            }
                        });
                        ui.add_space(8.0);
                    }
                });
                ui.add_space(16.0);
            }
            ui.vertical(|ui| {
                ui.strong("Mouse");
                Grid::new("gestures").num_columns(2).show(ui, |ui| {
                    for (gesture, what) in GESTURES {
                        ui.label(*gesture);
                        ui.weak(*what);
                        ui.end_row();
                    }
                });
            });
        });
    });
}
