//! The strip above the picture: layer, exposure, curve, place, wipe.

use egui::{ComboBox, DragValue, Id, Ui};

use super::{STORED, Scene, Viewport, Wipe, hand};
use crate::editor::Project;
use crate::editor::look;
use crate::image::tonemap::Curve;
use crate::image::{BEAUTY, Image};

const CURVES: [(Curve, &str); 3] = [(Curve::None, "none"), (Curve::Filmic, "filmic"), (Curve::Aces, "aces")];

/// Draws the strip.
pub fn show(
    viewport: &mut Viewport,
    ui: &mut Ui,
    project: &mut Project,
    scene: &Scene,
    image: Option<&Image>,
) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        if let Some(look) = scene.look {
            ui.strong(&look.chosen);
            layers(viewport, ui, image);
            tone(viewport, ui, project, look);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            places(viewport, ui, project, scene)
        });
    });
    ui.add_space(2.0);
}

fn named(response: &egui::Response, name: &str) {
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, name));
}

fn layers(viewport: &mut Viewport, ui: &mut Ui, image: Option<&Image>) {
    let Some(image) = image else { return };
    let menu = ComboBox::from_id_salt("layer").selected_text(&viewport.layer).width(90.0);
    let response = menu.show_ui(ui, |ui| {
        for name in image.layers.keys() {
            ui.selectable_value(&mut viewport.layer, name.clone(), name);
        }
    });
    named(&response.response, "Layer");
    response.response.on_hover_text("The layer that is shown");
    if !image.layers.contains_key(&viewport.layer) {
        viewport.layer = BEAUTY.to_owned();
    }
}

/// Exposure and curve, of the tone_map's node where one is looked through.
fn tone(viewport: &mut Viewport, ui: &mut Ui, project: &mut Project, look: &look::Look) {
    let before = look::tone(project.document(), look, viewport.tone);
    let mut tone = before;
    let drag =
        DragValue::new(&mut tone.exposure_ev).speed(0.02).range(-16.0..=16.0).max_decimals(2).suffix(" EV");
    let response = ui.add(drag).on_hover_text("Exposure: one more is twice as bright");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::DragValue, true, "Exposure"));
    let name = CURVES.iter().find(|(curve, _)| *curve == tone.curve).map_or("", |(_, name)| name);
    let curves = ComboBox::from_id_salt("curve").selected_text(name).width(64.0).show_ui(ui, |ui| {
        for (curve, name) in CURVES {
            ui.selectable_value(&mut tone.curve, curve, name);
        }
    });
    named(&curves.response, "Tone curve");
    curves.response.on_hover_text("Tone curve");
    if tone != before {
        match &look.tone {
            Some(node) => project.edit_during(Id::new("exposure"), "change the exposure", |document| {
                if let Some(node) = document.node_mut(node) {
                    // f32 to f64 by its shortest text, so that the file says 0.1.
                    let ev: f64 = tone.exposure_ev.to_string().parse().unwrap_or_default();
                    let curve =
                        CURVES.iter().find(|(curve, _)| *curve == tone.curve).map_or("none", |found| found.1);
                    node.params.insert("exposure_ev".to_owned(), ev.into());
                    node.params.insert("curve".to_owned(), curve.into());
                }
            }),
            None => viewport.tone = tone,
        }
    }
    if response.drag_stopped() || response.lost_focus() {
        project.end_gesture();
    }
}

/// From the right: place, histogram, wipe.
fn places(viewport: &mut Viewport, ui: &mut Ui, project: &mut Project, scene: &Scene) {
    let frames = ui
        .add_enabled(scene.can_frame(), egui::Button::new("Frame"))
        .on_hover_text("Look at the whole volume");
    if frames.on_disabled_hover_text("There is no volume yet, or the camera is refused").clicked() {
        // It can, or the button were not enabled.
        let _ = viewport.frame(project, scene);
    }
    if ui.button("1:1").on_hover_text("A pixel for a pixel").clicked() {
        viewport.one_to_one(ui.ctx());
    }
    if ui.button("Fit").on_hover_text("The whole picture").clicked() {
        viewport.fit();
    }
    if let Some(percent) = hand::percent(viewport.place, ui.ctx().pixels_per_point()) {
        ui.weak(format!("{percent:.0} %"));
    }
    ui.toggle_value(&mut viewport.shows_histogram, "Histogram");
    let mut slices = viewport.slice.is_on();
    if ui.toggle_value(&mut slices, "Slice").on_hover_text("A plane through a field").changed() {
        viewport.slice.toggle();
    }
    ui.menu_button("Wipe", |ui| wipe(viewport, ui, scene))
        .response
        .on_hover_text("Compare with another picture");
}

fn wipe(viewport: &mut Viewport, ui: &mut Ui, scene: &Scene) {
    for (slot, name) in STORED.into_iter().enumerate() {
        if ui.button(format!("Store picture {name}")).clicked() {
            viewport.store(slot, scene);
            ui.close();
        }
    }
    ui.separator();
    ui.radio_value(&mut viewport.wipe, Wipe::Off, "No wipe");
    for (slot, name) in STORED.into_iter().enumerate() {
        let is_there = viewport.stored[slot].is_some();
        ui.add_enabled_ui(is_there, |ui| {
            ui.radio_value(&mut viewport.wipe, Wipe::Stored(slot), format!("With stored {name}"));
        });
    }
    let shown = scene.look.map(|look| look.source.node.as_str());
    let mut others: Vec<&String> =
        scene.pictures.keys().filter(|name| Some(name.as_str()) != shown).collect();
    others.sort_unstable();
    for name in others {
        ui.radio_value(&mut viewport.wipe, Wipe::Node(name.clone()), format!("With {name}"));
    }
}
