//! The menu bar, made from the table of actions.

use egui::{Button, Color32, MenuBar, RichText, ScrollArea, Ui, WidgetInfo, WidgetType};

use super::{Marks, Possible, key_text};
use crate::editor::action::{ACTIONS, Action, ActionSpec, MENUS};

/// Draws the bar; `title` stands in its middle.
pub fn show(ui: &mut Ui, possible: Possible, marks: Marks, title: &str) -> Vec<Action> {
    let mut asked = Vec::new();
    MenuBar::new().ui(ui, |ui| {
        for menu in MENUS {
            ui.menu_button(menu, |ui| {
                ui.set_min_width(210.0);
                // In a low window the longest menu has more lines than it.
                let height = ui.ctx().content_rect().bottom() - ui.cursor().top() - 16.0;
                ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
                    let lines = || ACTIONS.iter().filter(|spec| spec.menu == menu);
                    // Where one line has a mark, all leave room for it.
                    let has_marks = lines().any(|spec| marks.is_on(spec.action).is_some());
                    for spec in lines() {
                        if spec.is_apart {
                            ui.separator();
                        }
                        if line(ui, spec, possible.is(spec.action), has_marks, marks.is_on(spec.action)) {
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

/// A line of a menu, with a check mark where what it puts on is on; whether it was chosen.
fn line(ui: &mut Ui, spec: &ActionSpec, is_possible: bool, has_marks: bool, is_on: Option<bool>) -> bool {
    let button = match has_marks {
        true => {
            let mark = RichText::new("✔");
            Button::new((
                if is_on == Some(true) { mark } else { mark.color(Color32::TRANSPARENT) },
                spec.label,
            ))
        }
        false => Button::new(spec.label),
    };
    let key = key_text(ui.ctx(), spec);
    let name = format!("{} {key}", spec.label);
    let response = ui.add_enabled(is_possible, button.shortcut_text(key));
    // A screen reader is told of the mark by the line's state, not by a sign.
    response.widget_info(|| match is_on {
        Some(is_on) => WidgetInfo::selected(WidgetType::Checkbox, is_possible, is_on, name.trim_end()),
        None => WidgetInfo::labeled(WidgetType::Button, is_possible, name.trim_end()),
    });
    response.clicked()
}
