//! The command palette: actions and presets by a few of their letters.
//!
//! Letters must come in order; those that follow each other or begin a word count more ([`score`], tested).

use egui::{Align2, Area, Frame, Id, Key, Order, ScrollArea, TextEdit, Ui, vec2};

use super::{Possible, key_text};
use crate::editor::action::{ACTIONS, Action};
use crate::editor::presets::Preset;

/// What is typed and which line is marked; `None` while it is closed.
#[derive(Debug, Default)]
pub struct Palette {
    open: Option<(String, usize)>,
}

/// What was chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum Choice {
    /// An action.
    Action(Action),
    /// A preset by its place in the list.
    Preset(usize),
}

impl Palette {
    /// Opens it, or closes it.
    pub fn toggle(&mut self) {
        self.open = if self.open.is_some() { None } else { Some(Default::default()) };
    }

    /// Whether it has the keyboard.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Draws it and gives what was chosen.
    pub fn show(&mut self, ui: &Ui, possible: Possible, presets: &[Preset]) -> Option<Choice> {
        let (query, mark) = self.open.as_mut()?;
        let context = ui.ctx().clone();
        let lines = lines(query, possible, presets);
        let step = |key| context.input_mut(|input| input.consume_key(egui::Modifiers::NONE, key));
        let (down, up) = (step(Key::ArrowDown), step(Key::ArrowUp));
        if down {
            *mark += 1;
        }
        if up {
            *mark = mark.saturating_sub(1);
        }
        *mark = (*mark).min(lines.len().saturating_sub(1));
        let (enter, escape) = (step(Key::Enter), step(Key::Escape));
        let mut chosen = enter.then(|| lines.get(*mark).map(|line| line.choice.clone())).flatten();
        let area = Area::new(Id::new("palette"))
            .order(Order::Foreground)
            .anchor(Align2::CENTER_TOP, vec2(0.0, 80.0));
        let shown = area.show(&context, |ui| {
            Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
                ui.set_width(440.0);
                let field = TextEdit::singleline(query)
                    .hint_text("What do you want to do?")
                    .desired_width(f32::INFINITY);
                let field = ui.add(field);
                field.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::TextEdit, true, "Command"));
                field.request_focus();
                if field.changed() {
                    *mark = 0;
                }
                ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                    for (idx, line) in lines.iter().enumerate() {
                        let button = egui::Button::selectable(idx == *mark, &line.label)
                            .shortcut_text(line.hint(&context))
                            .min_size(vec2(ui.available_width(), 22.0));
                        let response = ui.add(button);
                        if idx == *mark && (down || up) {
                            response.scroll_to_me(None);
                        }
                        if response.clicked() {
                            chosen = Some(line.choice.clone());
                        }
                    }
                    if lines.is_empty() {
                        ui.weak("Nothing is called so.");
                    }
                });
            });
        });
        if chosen.is_some() || escape || shown.response.clicked_elsewhere() {
            self.open = None;
        }
        chosen
    }
}

struct Line {
    label: String,
    choice: Choice,
    score: i32,
}

impl Line {
    fn hint(&self, context: &egui::Context) -> String {
        match self.choice {
            Choice::Action(action) => {
                let spec = ACTIONS.iter().find(|spec| spec.action == action);
                spec.map(|spec| key_text(context, spec)).unwrap_or_default()
            }
            Choice::Preset(_) => "preset".to_owned(),
        }
    }
}

fn lines(query: &str, possible: Possible, presets: &[Preset]) -> Vec<Line> {
    let line = |label: String, choice| Some(Line { score: score(query, &label)?, label, choice });
    let actions = ACTIONS.iter().filter(|spec| possible.is(spec.action) && spec.action != Action::Palette);
    let actions = actions.filter_map(|spec| line(spec.label.to_owned(), Choice::Action(spec.action)));
    let presets = presets.iter().enumerate();
    let presets =
        presets.filter_map(|(idx, preset)| line(format!("Open preset {}", preset.name), Choice::Preset(idx)));
    let mut lines: Vec<Line> = actions.chain(presets).collect();
    // Stable: what fits equally well stays in the order of the table.
    lines.sort_by_key(|line| -line.score);
    lines
}

/// How well a query fits; `None` where its letters do not come in this order.
pub fn score(query: &str, label: &str) -> Option<i32> {
    let label: Vec<char> = label.chars().flat_map(char::to_lowercase).collect();
    let (mut at, mut total, mut last) = (0, 0, None);
    for letter in query.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_lowercase) {
        let found = (at..label.len()).find(|&idx| label[idx] == letter)?;
        let follows = last == found.checked_sub(1) && found > 0;
        let begins = found == 0 || !label[found - 1].is_alphanumeric();
        total += 1 + if follows { 4 } else { 0 } + if begins { 3 } else { 0 };
        (last, at) = (Some(found), found + 1);
    }
    Some(total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_fit_is_first() {
        let all = Possible { graph: true, undo: true, redo: true, frames: true };
        let first = |query: &str| lines(query, all, &[]).first().map(|line| line.label.clone());
        assert_eq!(first("undo").as_deref(), Some("Undo"));
        assert_eq!(first("sav as").as_deref(), Some("Save as…"));
        assert_eq!(first("frame v").as_deref(), Some("Frame the volume"));
        assert_eq!(first("xyzzy"), None);
        assert!(lines("undo", Possible::default(), &[]).is_empty());
        assert_eq!(score("", "anything"), Some(0));
        assert_eq!(score("ba", "ab"), None);
    }
}
