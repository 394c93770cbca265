//! The menu bar, made from the table of actions.

use egui::{Button, MenuBar, ScrollArea, Ui};

use super::{Possible, key_text};
use crate::editor::action::{ACTIONS, Action, MENUS};

/// Draws the bar; `title` stands in its middle.
pub fn show(ui: &mut Ui, possible: Possible, title: &str) -> Vec<Action> {
    let mut asked = Vec::new();
    MenuBar::new().ui(ui, |ui| {
        for menu in MENUS {
            ui.menu_button(menu, |ui| {
                ui.set_min_width(210.0);
                // In a low window the longest menu has more lines than it.
                let height = ui.ctx().content_rect().bottom() - ui.cursor().top() - 16.0;
                ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
                    for spec in ACTIONS.iter().filter(|spec| spec.menu == menu) {
                        if spec.is_apart {
                            ui.separator();
                        }
                        let button = Button::new(spec.label).shortcut_text(key_text(ui.ctx(), spec));
                        if ui.add_enabled(possible.is(spec.action), button).clicked() {
                            asked.push(spec.action);
                            ui.close();
                        }
                    }
                });
            });
        }
        ui.separator();
        for (label, action) in [("Undo", Action::Undo), ("Redo", Action::Redo), ("Save", Action::Save)] {
            let button = Button::new(label).frame_when_inactive(false);
            if ui.add_enabled(possible.is(action), button).clicked() {
                asked.push(action);
            }
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.add_space(4.0);
            ui.weak(title);
        });
    });
    asked
}
