//! Fields that take text, and numbers: typed, dragged by their label, or slid.
//!
//! What is typed counts when the field is left (Enter, Tab, a click elsewhere); Escape takes it back. What is refused
//! stays in its field, in red, with the reason below, and the document keeps the last valid value.

use egui::{CursorIcon, Label, Response, Sense, Slider, SliderClamping, TextEdit, Ui};

use super::expression::evaluate;
use super::slot::{Slot, number};
use crate::graph::ParamKind;

/// Text that is not in the document: it is being typed, or was refused.
#[derive(Debug, Clone)]
struct Draft {
    text: String,
    /// Why it was refused.
    message: Option<String>,
    /// What the document said then: when it says something else, the draft is out of date.
    instead_of: String,
}

/// Gives a control the name by which tests and screen readers know it.
pub fn named(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// Says what a named text is: readers know a plain label by its text and would not find the name.
pub fn in_role(response: &Response, role: egui::accesskit::Role) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_role(role));
}

/// A line of text that is taken over by `commit`; the reason why it was not is returned as long as it stands.
pub fn entry(
    ui: &mut Ui,
    id: egui::Id,
    name: &str,
    current: &str,
    width: f32,
    commit: impl FnOnce(&str) -> Result<(), String>,
) -> Option<String> {
    entry_shown(ui, id, name, current, None, width, commit)
}

/// Such a line that shows another text, a shorter one, while nobody writes in it.
pub fn entry_shown(
    ui: &mut Ui,
    id: egui::Id,
    name: &str,
    current: &str,
    shown: Option<&str>,
    width: f32,
    commit: impl FnOnce(&str) -> Result<(), String>,
) -> Option<String> {
    let mut draft: Option<Draft> = ui.data(|data| data.get_temp(id));
    let is_focused = ui.memory(|memory| memory.has_focus(id));
    if !is_focused && draft.as_ref().is_some_and(|draft| draft.instead_of != current) {
        draft = None;
    }
    let whole = draft.as_ref().map_or(current, |draft| &draft.text).to_owned();
    let mut text = match shown {
        Some(shown) if !is_focused && draft.is_none() => shown.to_owned(),
        _ => whole.clone(),
    };
    let is_refused = draft.as_ref().is_some_and(|draft| draft.message.is_some());
    let color = is_refused.then(|| ui.visuals().error_fg_color);
    let edit = TextEdit::singleline(&mut text).id(id).desired_width(f32::INFINITY).text_color_opt(color);
    let edit = edit.vertical_align(egui::Align::Center);
    // With its margins, so that what stands after it has the room that it was left.
    let response = ui.add_sized(egui::vec2(width, ui.spacing().interact_size.y), edit);
    named(&response, name);
    if response.gained_focus() {
        select_all(ui, id, &whole);
    }
    if response.changed() {
        draft = Some(Draft { text: text.clone(), message: None, instead_of: current.to_owned() });
    }
    if response.lost_focus() {
        let is_taken_back = ui.input(|input| input.key_pressed(egui::Key::Escape));
        // A text that was refused is tried again: what it needs may have changed.
        draft = draft.filter(|_| !is_taken_back).and_then(|draft| {
            let message = commit(&draft.text).err()?;
            Some(Draft { message: Some(message), ..draft })
        });
    }
    let message = draft.as_ref().and_then(|draft| draft.message.clone());
    ui.data_mut(|data| match draft {
        Some(draft) => drop(data.insert_temp(id, draft)),
        None => data.remove::<Draft>(id),
    });
    message
}

/// A field that is entered is typed over, as in every other program with such fields.
fn select_all(ui: &Ui, id: egui::Id, text: &str) {
    use egui::text::{CCursor, CCursorRange};
    if let Some(mut state) = TextEdit::load_state(ui.ctx(), id) {
        let end = CCursor::new(text.chars().count());
        state.cursor.set_char_range(Some(CCursorRange::two(CCursor::default(), end)));
        state.store(ui.ctx(), id);
    }
}

/// One number of a parameter as a field that takes arithmetic.
pub fn field(ui: &mut Ui, slot: &mut Slot, part: usize, suffix: &str, width: f32) -> Option<String> {
    let x = slot.numbers()[part];
    let (current, shown) = (text_of(x), rounded_to_fit(x, |text| has_room(ui, text, width)));
    let (id, name) = (slot.id().with(("field", part)), slot.name() + suffix);
    entry_shown(ui, id, &name, &current, Some(&shown), width, |text| {
        slot.set_number(part, evaluate(text)?, None)
    })
}

/// Whether a text is seen in whole in a field of this width.
pub fn has_room(ui: &Ui, text: &str, width: f32) -> bool {
    let font = egui::TextStyle::Body.resolve(ui.style());
    // The margins of a field are 4 points each.
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::PLACEHOLDER);
    galley.size().x + 8.0 <= width
}

/// A number with as many digits as fit, three at least: cut, its end would be lost, and with it its power of ten.
fn rounded_to_fit(x: f64, fits: impl Fn(&str) -> bool) -> String {
    let whole = text_of(x);
    if fits(&whole) {
        return whole;
    }
    let with_digits = |digits: usize| format!("{x:.*e}", digits - 1).parse().map_or(whole.clone(), text_of);
    (4..=15).rev().map(with_digits).find(|text| fits(text)).unwrap_or_else(|| with_digits(3))
}

/// A number as people write it.
pub fn text_of(x: f64) -> String {
    number(x).to_string()
}

/// A label by which a number is dragged: 300 points across the soft range, with Shift ten times finer.
pub fn handle(ui: &mut Ui, slot: &mut Slot, part: usize, label: &str, suffix: &str) -> Option<String> {
    let text = egui::RichText::new(label);
    let text = if slot.is_set() { text.strong() } else { text };
    let response = ui.add(Label::new(text).selectable(false).truncate().sense(Sense::click_and_drag()));
    let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal).on_hover_text(help(slot));
    named(&response, &format!("{}{suffix} drag", slot.name()));
    in_role(&response, egui::accesskit::Role::SpinButton);
    let id = slot.id().with(("drag", part));
    if response.drag_started() {
        slot.end_gesture();
        ui.data_mut(|data| data.insert_temp(id, slot.numbers()[part]));
    }
    let mut message = None;
    if response.dragged() {
        let before: f64 = ui.data(|data| data.get_temp(id)).unwrap_or(slot.numbers()[part]);
        let speed = speed(slot, before) * if ui.input(|input| input.modifiers.shift) { 0.1 } else { 1.0 };
        let x = before + f64::from(response.drag_delta().x) * speed;
        ui.data_mut(|data| data.insert_temp(id, x));
        let x = if is_whole(slot) { x.round() } else { rounded(x, speed) };
        if x != slot.numbers()[part] {
            message = slot.set_number(part, x, Some(id)).err();
        }
    }
    if response.drag_stopped() {
        slot.end_gesture();
        ui.data_mut(|data| data.remove::<f64>(id));
    }
    message
}

/// A slider across the soft range, for a parameter that has one; it never moves a value by itself.
pub fn slider(ui: &mut Ui, slot: &mut Slot, part: usize) -> Option<String> {
    let (low, high) = slot.spec.soft?;
    let mut x = slot.numbers()[part];
    ui.spacing_mut().slider_width = ui.available_width() - 8.0;
    let mut slider =
        Slider::new(&mut x, low..=high).show_value(false).clamping(SliderClamping::Never).trailing_fill(true);
    if is_whole(slot) {
        slider = slider.integer();
    }
    // Where the ends are more than a hundred times apart, the small half would have no room.
    if low > 0.0 && high / low >= 100.0 {
        slider = slider.logarithmic(true);
    }
    let response = ui.add(slider);
    named(&response, &format!("{} slider", slot.name()));
    if !response.changed() {
        return None;
    }
    let x =
        if is_whole(slot) { x.round() } else { rounded(x, 1e-3 * (high - low).min(x.abs().max(low.abs()))) };
    slot.set_number(part, x, Some(slot.id().with("slider"))).err()
}

fn is_whole(slot: &Slot) -> bool {
    matches!(slot.spec.kind, ParamKind::Int)
}

/// What a point of dragging changes.
fn speed(slot: &Slot, x: f64) -> f64 {
    let speed = match slot.spec.soft {
        Some((low, high)) => (high - low) / 300.0,
        None => (0.01 * x.abs()).max(0.01),
    };
    if is_whole(slot) { speed.max(0.1) } else { speed }
}

/// To the decimals that a step of this size needs, so that nobody gets 0.30000000000000004.
fn rounded(x: f64, step: f64) -> f64 {
    let decimals = (-step.abs().max(1e-12).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{x:.decimals$}").parse().unwrap_or(x)
}

/// What stands in the tooltip of a parameter.
pub fn help(slot: &Slot) -> String {
    let default = match slot.spec.default_json() {
        Some(json) => format!("; default {json}"),
        None => String::new(),
    };
    format!("{}\n{}{default}", slot.spec.doc, slot.spec.form())
}

#[cfg(test)]
mod tests {
    use super::{rounded, rounded_to_fit};

    #[test]
    fn long_numbers_are_rounded_to_their_field() {
        let shown = |x: f64, most: usize| rounded_to_fit(x, |text| text.len() <= most);
        assert_eq!(shown(std::f64::consts::TAU, 9), "6.2831853");
        assert_eq!(shown(std::f64::consts::TAU, 2), "6.28");
        assert_eq!(shown(0.1, 9), "0.1");
        assert_eq!(shown(-1.0 / 3e12, 10), "-3.333e-13");
        assert_eq!(shown(2_100_000.0, 9), "2100000");
    }

    #[test]
    fn dragged_numbers_are_short() {
        assert_eq!(rounded(0.1 + 0.2, 0.005), 0.3);
        assert_eq!(rounded(123.456, 20.0), 123.0);
        assert_eq!(rounded(-1.0 / 3.0, 1e-3), -0.333);
        assert_eq!(rounded(1e-9, 1e-11), 1e-9);
    }
}
