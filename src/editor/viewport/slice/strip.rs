//! The line of controls of the slice plane.

use egui::{ComboBox, DragValue, Slider, Ui, WidgetInfo, WidgetType};

use super::{Axis, Field, NAME, Slice, fields};
use crate::editor::inspector::grid_choices;
use crate::graph::{Document, Moment, PortType};
use crate::image::colormap;

fn named(response: &egui::Response, kind: WidgetType, name: &str) {
    response.widget_info(|| WidgetInfo::labeled(kind, true, name));
}

/// Draws it for a flat document; `has_place` where the plane can be shown in the picture.
pub fn show(slice: &mut Slice, ui: &mut Ui, document: &Document, has_place: bool) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        let Some(field) = slice.field(document) else {
            ui.weak("no node gives a volume, medium, beams or residual");
            return;
        };
        field_menu(slice, ui, document, &field);
        of_field(slice, ui, document, &field);
        for axis in Axis::ALL {
            let label = ui.selectable_label(slice.axis == axis, axis.name());
            named(&label, WidgetType::SelectableLabel, &format!("Slice across {}", axis.name()));
            if label.clicked() && slice.axis != axis {
                (slice.axis, slice.position) = (axis, None);
            }
        }
        position(slice, ui);
        let map = ComboBox::from_id_salt("slice colors").selected_text(slice.colormap).width(76.0);
        let map = map.show_ui(ui, |ui| {
            for &name in colormap::NAMES {
                ui.selectable_value(&mut slice.colormap, name, name);
            }
        });
        named(&map.response, WidgetType::ComboBox, "Slice colors");
        range(slice, ui);
        ui.add_enabled_ui(has_place, |ui| {
            let is_flat = slice.is_flat(has_place);
            for (name, flat) in [("In the picture", false), ("Flat", true)] {
                if ui.selectable_label(is_flat == flat, name).clicked() {
                    slice.is_flat = flat;
                }
            }
        })
        .response
        .on_disabled_hover_text("Without a picture and its camera the plane has no place: it is shown flat");
    });
    ui.add_space(2.0);
}

fn field_menu(slice: &mut Slice, ui: &mut Ui, document: &Document, field: &Field) {
    let text = |field: &Field| match field.kind {
        PortType::Medium => format!("{} · sigma_t", field.output.node),
        PortType::Beams => format!("{} · tau", field.output.node),
        PortType::Residual => format!("{} · phi", field.output.node),
        _ => format!("{} · grid", field.output.node),
    };
    let menu = ComboBox::from_id_salt("slice field").selected_text(text(field)).width(130.0);
    let shown = menu.show_ui(ui, |ui| {
        let mut chosen = None;
        for other in fields(document) {
            if ui.selectable_label(other == *field, text(&other)).clicked() {
                chosen = Some(other);
            }
        }
        chosen
    });
    named(&shown.response, WidgetType::ComboBox, "Slice field");
    if let Some(other) = shown.inner.flatten().filter(|other| other != field) {
        slice.chosen = Some(other.output);
        (slice.position, slice.range) = (None, None);
        slice.renew();
    }
}

/// Which grid of a volume, or which of the beams.
fn of_field(slice: &mut Slice, ui: &mut Ui, document: &Document, field: &Field) {
    match field.kind {
        PortType::Volume => {
            let menu = ComboBox::from_id_salt("slice grid").selected_text(slice.grid.as_str()).width(80.0);
            let shown = menu.show_ui(ui, |ui| {
                let mut with_slice = document.clone();
                slice.add_to(&mut with_slice);
                let mut chosen = None;
                let moment = Moment { frame: document.frame, is_aside: false };
                match grid_choices(ui, &with_slice, NAME, moment) {
                    Ok(grids) => {
                        for grid in grids {
                            let text = format!("{}   {}", grid.name, grid.about);
                            if ui.selectable_label(grid.name == slice.grid, text).clicked() {
                                chosen = Some(grid.name);
                            }
                        }
                    }
                    Err(message) => drop(ui.weak(message)),
                }
                chosen
            });
            named(&shown.response, WidgetType::ComboBox, "Slice grid");
            if let Some(grid) = shown.inner.flatten().filter(|grid| *grid != slice.grid) {
                slice.grid = grid;
                slice.range = None;
                slice.renew();
            }
        }
        PortType::Beams => {
            let before = slice.beam;
            let drag =
                ui.add(DragValue::new(&mut slice.beam).range(0..=1_000_000).speed(0.1).prefix("beam "));
            named(&drag, WidgetType::DragValue, "Slice beam");
            if slice.beam != before {
                slice.renew();
            }
        }
        _ => {}
    }
}

fn position(slice: &mut Slice, ui: &mut Ui) {
    let Some(plane) = slice.cut.as_ref().map(|cut| cut.plane) else {
        ui.add_enabled(false, Slider::new(&mut 0.0, 0.0..=1.0).show_value(false));
        return;
    };
    let [from, to] = plane.extent;
    let mut position = slice.position.unwrap_or(plane.position);
    let before = position;
    // Four digits of the box.
    let digits = (3.0 - (to - from).abs().max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    let slider = ui.add(Slider::new(&mut position, from..=to).suffix(" m").fixed_decimals(digits));
    named(&slider, WidgetType::Slider, "Slice position");
    if position != before {
        slice.move_to(position);
    }
}

/// Values of the map's ends: those of the data, or given ones.
fn range(slice: &mut Slice, ui: &mut Ui) {
    let Some(of_cut) = slice.cut.as_ref().map(|cut| cut.plane.range) else { return };
    let mut follows = slice.range.is_none();
    let tick =
        ui.checkbox(&mut follows, "Auto").on_hover_text("The map's ends are the least and the largest value");
    named(&tick, WidgetType::Checkbox, "Slice range of the data");
    if tick.changed() {
        slice.range = (!follows && of_cut[0] < of_cut[1]).then_some(of_cut);
    }
    let Some([low, high]) = &mut slice.range else { return };
    let speed = 0.005 * (of_cut[1] - of_cut[0]).abs().max(1e-9);
    let gap = 1e-6 * low.abs().max(high.abs()).max(1e-9);
    let least = ui.add(DragValue::new(low).speed(speed).range(f64::MIN..=*high - gap).max_decimals(4));
    named(&least, WidgetType::DragValue, "Slice lowest value");
    let most = ui.add(DragValue::new(high).speed(speed).range(*low + gap..=f64::MAX).max_decimals(4));
    named(&most, WidgetType::DragValue, "Slice highest value");
}
