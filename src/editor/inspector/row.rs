//! A parameter: its label, its control, what may be done with it, and what is wrong with it.

use egui::{
    Button, Color32, ComboBox, Rect, RichText, Sense, Shape, Stroke, Ui, WidgetInfo, WidgetType, vec2,
};
use serde_json::{Map, Value as Json};

use super::number::{entry, field, handle, help, in_role, named, slider};
use super::slot::Slot;
use super::{color, curve, direction, grids, path};
use crate::graph::ParamKind;
use crate::graph::spec::Default;

/// Of the column of labels.
const LABEL: f32 = 112.0;
/// Of a button with a sign.
const BUTTON: f32 = 20.0;
/// Of a letter before a number, with the gap behind it.
pub const LETTER: f32 = 16.0;
/// Between controls of a line (`theme.rs`).
const GAP: f32 = 8.0;

/// Shows a parameter and applies what is changed.
pub fn show(ui: &mut Ui, slot: &mut Slot) {
    ui.push_id(slot.id(), |ui| {
        let message = row(ui, slot).or_else(|| slot.problem());
        if let Some(message) = message {
            ui.colored_label(ui.visuals().error_fg_color, message);
        }
        ui.add_space(2.0);
    });
}

/// The label and the control; what is wrong, if anything is.
fn row(ui: &mut Ui, slot: &mut Slot) -> Option<String> {
    // Empty text is what a path that is not set looks like; all else that may be null has a switch.
    if slot.spec.default == Default::Null && !matches!(slot.spec.kind, ParamKind::Path) {
        let is_on = ui.horizontal(|ui| {
            label(ui, slot);
            let is_on = switch(ui, slot);
            space_before_tail(ui, slot);
            tail(ui, slot);
            is_on
        });
        return if is_on.inner? { below(ui, slot) } else { None };
    }
    match slot.spec.kind {
        ParamKind::Float | ParamKind::Int => {
            let line = ui.horizontal(|ui| {
                let dragged = in_label(ui, |ui| handle(ui, slot, 0, slot.spec.name, ""));
                let typed = field(ui, slot, 0, "", width_before_tail(ui, slot));
                tail(ui, slot);
                dragged.or(typed)
            });
            let slid = slider(ui, slot, 0);
            line.inner.or(slid)
        }
        ParamKind::Bool
        | ParamKind::Text
        | ParamKind::Grid
        | ParamKind::Choice(_)
        | ParamKind::IntChoice(_)
        | ParamKind::Path
        | ParamKind::OutPath => {
            let line = ui.horizontal(|ui| {
                label(ui, slot);
                let message = short(ui, slot);
                tail(ui, slot);
                message
            });
            line.inner
        }
        ParamKind::Vector(_)
        | ParamKind::Rgb
        | ParamKind::Direction
        | ParamKind::Curve(_)
        | ParamKind::Record(_) => {
            ui.horizontal(|ui| {
                label(ui, slot);
                space_before_tail(ui, slot);
                tail(ui, slot);
            });
            below(ui, slot)
        }
    }
}

/// A control that stands beside its label.
fn short(ui: &mut Ui, slot: &mut Slot) -> Option<String> {
    let width = width_before_tail(ui, slot);
    match slot.spec.kind {
        ParamKind::Bool => {
            let mut is_on = slot.json().as_bool().unwrap_or_default();
            let response = ui.checkbox(&mut is_on, "");
            named(&response, &slot.name());
            response.changed().then(|| slot.set(is_on.into(), None).err()).flatten()
        }
        ParamKind::Choice(choices) => {
            let choices: Vec<Json> = choices.iter().map(|choice| (*choice).into()).collect();
            choose(ui, slot, &choices, width)
        }
        ParamKind::IntChoice(choices) => {
            let choices: Vec<Json> = choices.iter().map(|choice| (*choice).into()).collect();
            choose(ui, slot, &choices, width)
        }
        ParamKind::Grid => grids::show(ui, slot, width),
        ParamKind::Path | ParamKind::OutPath => path::show(ui, slot, width),
        _ => {
            let current = slot.json().as_str().unwrap_or_default().to_owned();
            let (id, name) = (slot.id().with("text"), slot.name());
            entry(ui, id, &name, &current, width, |text| slot.set(text.into(), None))
        }
    }
}

/// A control that needs the width.
fn below(ui: &mut Ui, slot: &mut Slot) -> Option<String> {
    match slot.spec.kind {
        ParamKind::Float | ParamKind::Int => {
            let typed = ui.horizontal(|ui| {
                let dragged = in_label(ui, |ui| handle(ui, slot, 0, "↔", ""));
                let typed = field(ui, slot, 0, "", width_before_tail(ui, slot));
                dragged.or(typed)
            });
            let slid = slider(ui, slot, 0);
            typed.inner.or(slid)
        }
        ParamKind::Vector(count) => vector(ui, slot, count),
        ParamKind::Rgb => color::show(ui, slot),
        ParamKind::Direction => direction::show(ui, slot),
        ParamKind::Curve(columns) => curve::show(ui, slot, columns),
        ParamKind::Record(members) => {
            ui.indent(slot.id().with("members"), |ui| {
                for member in members {
                    show(ui, &mut slot.member(member));
                }
            });
            None
        }
        _ => short(ui, slot),
    }
}

/// Numbers side by side, three or four in a line.
fn vector(ui: &mut Ui, slot: &mut Slot, count: usize) -> Option<String> {
    let columns = if count > 4 { 4 } else { count };
    let mut message = None;
    for line in 0..count.div_ceil(columns) {
        ui.horizontal(|ui| {
            let width = column(ui, columns);
            for part in line * columns..count.min((line + 1) * columns) {
                let axis = ["x", "y", "z"].get(part).filter(|_| count == 3);
                let label = axis.map_or_else(|| part.to_string(), |axis| (*axis).to_owned());
                let suffix = format!(".{label}");
                let taken = if count <= 4 {
                    let dragged = handle(ui, slot, part, &label, &suffix);
                    message = message.take().or(dragged);
                    LETTER
                } else {
                    0.0
                };
                let typed = field(ui, slot, part, &suffix, width - taken);
                message = message.take().or(typed);
            }
        });
    }
    message
}

/// Of each of so many columns, as far to the right as sliders go.
pub fn column(ui: &Ui, count: usize) -> f32 {
    (ui.available_width() - ui.spacing().item_spacing.x * count as f32) / count as f32
}

/// The name, with the doc as its tooltip; the dragged kind of it is `number::handle`.
fn label(ui: &mut Ui, slot: &Slot) {
    in_label(ui, |ui| {
        let text = RichText::new(slot.spec.name);
        let text = if slot.is_set() { text.strong() } else { text };
        ui.add(egui::Label::new(text).selectable(false).truncate()).on_hover_text(help(slot));
    });
}

fn in_label<T>(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> T) -> T {
    let size = vec2(LABEL, ui.spacing().interact_size.y);
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    let shown = ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_size(size);
        add(ui)
    });
    shown.inner
}

/// Whether a value that may be null has one.
fn switch(ui: &mut Ui, slot: &mut Slot) -> Option<bool> {
    let mut is_on = !slot.json().is_null();
    let response = ui.checkbox(&mut is_on, "");
    named(&response, &format!("{} set", slot.name()));
    if !is_on {
        ui.weak("not set");
    }
    if response.changed() {
        let value = if is_on { first_value(slot) } else { Json::Null };
        // The first value may be one that is not allowed, such as a name: the message then stands below.
        if let Err(message) = slot.set(value, None) {
            ui.colored_label(ui.visuals().error_fg_color, message);
        }
    }
    Some(is_on)
}

/// What a value that was null begins as: the allowed number nearest to the middle of its soft range or to 0.
fn first_value(slot: &Slot) -> Json {
    let spec = slot.spec;
    let middle = spec.soft.map_or(0.0, |(low, high)| 0.5 * (low + high));
    let allowed = [middle, 0.0, 1.0, spec.hard.min.unwrap_or(0.0), spec.hard.max.unwrap_or(0.0)];
    let x = allowed.into_iter().find(|x| spec.hard.contains(*x)).unwrap_or(middle);
    match spec.kind {
        ParamKind::Float => super::slot::number(x),
        ParamKind::Int => super::slot::number(x.round()),
        ParamKind::IntChoice(choices) => choices[0].into(),
        ParamKind::Bool => false.into(),
        ParamKind::Choice(choices) => choices[0].into(),
        ParamKind::Text | ParamKind::Grid | ParamKind::Path | ParamKind::OutPath => "".into(),
        // A range needs two different ends.
        ParamKind::Vector(2) => super::slot::numbers(&[0.0, 1.0]),
        ParamKind::Vector(count) => super::slot::numbers(&vec![x; count]),
        ParamKind::Rgb => super::slot::numbers(&[x; 3]),
        ParamKind::Direction => super::slot::numbers(&[0.0, 1.0, 0.0]),
        ParamKind::Record(_) => Json::Object(Map::new()),
        ParamKind::Curve(columns) => curve::ramp(columns),
    }
}

fn choose(ui: &mut Ui, slot: &mut Slot, choices: &[Json], width: f32) -> Option<String> {
    let text = |choice: &Json| choice.as_str().map_or_else(|| choice.to_string(), str::to_owned);
    let current = slot.json();
    let mut chosen = None;
    let combo = ComboBox::from_id_salt(slot.id()).width(width - 8.0).selected_text(text(&current));
    let shown = combo.show_ui(ui, |ui| {
        for choice in choices {
            if ui.selectable_label(*choice == current, text(choice)).clicked() {
                chosen = Some(choice.clone());
            }
        }
    });
    named(&shown.response, &slot.name());
    slot.set(chosen?, None).err()
}

/// Whether others differ, unit, key and reset.
fn tail(ui: &mut Ui, slot: &mut Slot) {
    if slot.is_mixed() {
        let text = RichText::new("mixed").small().color(ui.visuals().warn_fg_color);
        let response = ui.label(text).on_hover_text("The other selected nodes have another value.");
        named(&response, &format!("{} mixed", slot.name()));
        in_role(&response, egui::accesskit::Role::Status);
    }
    if !slot.spec.unit.is_empty() {
        // Cut where the panel is too narrow for it; the rest of the line is not pushed out.
        let after = tail_width(ui, slot) - unit_width(ui, slot) - GAP;
        let room = ui.available_width() - after;
        let size = vec2(unit_width(ui, slot).min(room).max(0.0), ui.spacing().interact_size.y);
        let unit = egui::Label::new(RichText::new(slot.spec.unit).weak()).truncate();
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            // Also where the text is a little narrower, so that what follows stands in one column.
            ui.set_min_size(size);
            ui.add(unit)
        });
    }
    if slot.spec.kind.takes_keys() {
        key(ui, slot);
    }
    if slot.is_set() && slot.spec.default != Default::Required {
        let button = Button::new("⟲").frame(false).min_size(vec2(BUTTON, BUTTON));
        let response = ui.add(button).on_hover_text("Reset to the default");
        named(&response, &format!("{} reset", slot.name()));
        if response.clicked() {
            slot.reset();
        }
    }
}

/// A key at the frame: filled where there is one, hollow where there are others, faint where there is none.
fn key(ui: &mut Ui, slot: &mut Slot) {
    let keys = slot.keys().unwrap_or_default();
    let frame = slot.frame();
    let is_here = keys.iter().any(|key| key[0].as_f64() == Some(frame as f64));
    let what = if is_here { "Remove the key" } else { "Add a key" };
    let (rect, response) = ui.allocate_exact_size(vec2(BUTTON, BUTTON), Sense::click());
    diamond(ui, rect, is_here, keys.is_empty(), response.hovered() || response.has_focus());
    let response = response.on_hover_ui(|ui| {
        ui.label(format!("{what} at frame {frame}"));
        for key in &keys {
            ui.weak(format!("frame {}: {}", key[0], key[1]));
        }
    });
    response.widget_info(|| WidgetInfo::selected(WidgetType::Checkbox, true, is_here, what));
    named(&response, &format!("{} key", slot.name()));
    if response.clicked() {
        slot.toggle_key();
    }
}

/// Painted, because no font of egui has the sign.
fn diamond(ui: &Ui, rect: Rect, is_filled: bool, is_faint: bool, is_hovered: bool) {
    let visuals = ui.visuals();
    let color = match (is_hovered, is_faint) {
        (true, _) => visuals.strong_text_color(),
        (_, true) => visuals.weak_text_color(),
        _ => visuals.warn_fg_color,
    };
    let (center, r) = (rect.center(), 4.5);
    let corners = [vec2(0.0, -r), vec2(r, 0.0), vec2(0.0, r), vec2(-r, 0.0)].map(|corner| center + corner);
    let fill = if is_filled { color } else { Color32::TRANSPARENT };
    ui.painter().add(Shape::convex_polygon(corners.to_vec(), fill, Stroke::new(1.0, color)));
}

/// Of a unit in whole.
fn unit_width(ui: &Ui, slot: &Slot) -> f32 {
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.painter().layout_no_wrap(slot.spec.unit.to_owned(), font, Color32::PLACEHOLDER).size().x.ceil() + 1.0
}

fn tail_width(ui: &Ui, slot: &Slot) -> f32 {
    let unit = if slot.spec.unit.is_empty() { 0.0 } else { unit_width(ui, slot) + GAP };
    let key = if slot.spec.kind.takes_keys() { BUTTON + GAP } else { 0.0 };
    let mixed = if slot.is_mixed() { 32.0 + GAP } else { 0.0 };
    mixed + unit + key + BUTTON + GAP
}

/// Nothing that has a gap behind it stands there, so that the first gap of the tail is not taken.
fn space_before_tail(ui: &mut Ui, slot: &Slot) {
    ui.add_space((ui.available_width() - tail_width(ui, slot) + GAP).max(0.0));
}

fn width_before_tail(ui: &Ui, slot: &Slot) -> f32 {
    (ui.available_width() - tail_width(ui, slot)).max(56.0)
}

/// A number beside others that belong to it, as colors and directions have them.
pub fn component(ui: &mut Ui, slot: &mut Slot, part: usize, label: &str, width: f32) -> Option<String> {
    let suffix = format!(".{label}");
    let dragged = handle(ui, slot, part, label, &suffix);
    let typed = field(ui, slot, part, &suffix, width);
    dragged.or(typed)
}
