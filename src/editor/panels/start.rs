//! The start page: presets with small pictures, recent graphs, and what can be opened.

use std::collections::HashMap;
use std::path::PathBuf;

use egui::{
    Align, Color32, Layout, Rect, RichText, ScrollArea, Sense, TextureHandle, Ui, Vec2, WidgetInfo,
    WidgetType, vec2,
};

use crate::editor::action::Action;
use crate::editor::presets::Preset;
use crate::editor::theme;

/// What was chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum Choice {
    /// A preset by its place in the list.
    Preset(usize),
    /// A file that was open before.
    Recent(PathBuf),
    /// An action.
    Action(Action),
}

/// The pictures of the presets, as textures.
#[derive(Default)]
pub struct Start {
    pictures: HashMap<String, Option<TextureHandle>>,
}

const CARD: Vec2 = vec2(224.0, 186.0);

impl Start {
    /// Draws the page.
    pub fn show(&mut self, ui: &mut Ui, presets: &[Preset], recent: &[PathBuf]) -> Option<Choice> {
        let mut chosen = None;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let width = (ui.available_width() - 64.0).clamp(240.0, 1180.0);
            let margin = (0.5 * (ui.available_width() - width)).max(0.0);
            ui.horizontal_top(|ui| {
                ui.add_space(margin);
                ui.vertical(|ui| {
                    ui.set_width(width);
                    ui.add_space(36.0);
                    ui.label(RichText::new("Tyndall").size(34.0).strong());
                    ui.weak("Light in smoke, fire and cloud. Drop a .vdb file or a folder of frames anywhere on this window.");
                    ui.add_space(16.0);
                    ui.horizontal(|ui| {
                        for (label, action) in [("Open a VDB…", Action::OpenVolume), ("Open a graph…", Action::Open)] {
                            let button = egui::Button::new(RichText::new(label).size(14.0)).min_size(vec2(140.0, 32.0));
                            if ui.add(button).clicked() {
                                chosen = Some(Choice::Action(action));
                            }
                        }
                    });
                    ui.add_space(20.0);
                    if !recent.is_empty() {
                        heading(ui, "Recent");
                        chosen = recents(ui, recent).or(chosen.take());
                        ui.add_space(16.0);
                    }
                    heading(ui, "Presets");
                    if presets.is_empty() {
                        ui.weak("The folder 'graphs' that comes with Tyndall is not beside the program.");
                    }
                    ui.horizontal_wrapped(|ui| {
                        ui.spacing_mut().item_spacing = vec2(14.0, 14.0);
                        for (idx, preset) in presets.iter().enumerate() {
                            if self.card(ui, preset) {
                                chosen = Some(Choice::Preset(idx));
                            }
                        }
                    });
                    ui.add_space(24.0);
                });
            });
        });
        chosen
    }

    fn card(&mut self, ui: &mut Ui, preset: &Preset) -> bool {
        let (rect, response) = ui.allocate_exact_size(CARD, Sense::click());
        let name = format!("Preset {}", preset.name);
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &name));
        let picture = self.pictures.entry(preset.name.clone()).or_insert_with(|| {
            let image = preset.thumbnail()?;
            Some(ui.ctx().load_texture(&name, image, egui::TextureOptions::LINEAR))
        });
        let painter = ui.painter().with_clip_rect(rect);
        let lit = response.hovered() || response.has_focus();
        painter.rect_filled(rect, 6.0, ui.visuals().faint_bg_color);
        let top = Rect::from_min_size(rect.min, vec2(CARD.x, 126.0));
        match picture {
            Some(picture) => {
                let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                let tint = if lit { Color32::WHITE } else { Color32::from_gray(225) };
                painter.image(picture.id(), top, whole, tint);
            }
            None => drop(painter.rect_filled(top, 6.0, ui.visuals().extreme_bg_color)),
        }
        let below = Rect::from_min_max(top.left_bottom(), rect.max).shrink2(vec2(10.0, 6.0));
        let mut text =
            ui.new_child(egui::UiBuilder::new().max_rect(below).layout(Layout::top_down(Align::Min)));
        text.spacing_mut().item_spacing.y = 1.0;
        text.label(RichText::new(&preset.name).strong());
        text.add(egui::Label::new(RichText::new(&preset.about).weak().size(11.0)).wrap());
        if lit {
            ui.painter().rect_stroke(rect, 6.0, (1.5, theme::ACCENT), egui::StrokeKind::Outside);
        }
        response.on_hover_text(&preset.about).clicked()
    }
}

fn heading(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).size(15.0).strong());
    ui.add_space(4.0);
}

fn recents(ui: &mut Ui, recent: &[PathBuf]) -> Option<Choice> {
    let mut chosen = None;
    for path in recent {
        ui.horizontal(|ui| {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            if ui.link(name).clicked() {
                chosen = Some(Choice::Recent(path.clone()));
            }
            let folder = path.parent().map(|folder| folder.display().to_string()).unwrap_or_default();
            ui.weak(RichText::new(folder).size(11.0));
        });
    }
    chosen
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;

    use super::*;
    use crate::editor::snapshot::assert_looks;

    #[test]
    fn snapshot_of_the_start_page() {
        // Of no preset that there is, whose picture may be made anew.
        let preset = |name: &str, about: &str| Preset {
            name: name.to_owned(),
            about: about.to_owned(),
            path: PathBuf::new(),
        };
        let presets = [preset("mist", "Thin, and lit from behind"), preset("steam", "Thick and white")];
        let recent = [PathBuf::from("/graphs/cloud.json"), PathBuf::from("/graphs/fire.json")];
        for (name, theme) in [("start_dark", egui::Theme::Dark), ("start_light", egui::Theme::Light)] {
            let page = |ui: &mut Ui, start: &mut Start| {
                egui::CentralPanel::default().show(ui, |ui| drop(start.show(ui, &presets, &recent)));
            };
            let builder = Harness::builder().with_size(vec2(600.0, 460.0));
            let mut harness = builder.build_ui_state(page, Start::default());
            theme::apply(&harness.ctx, theme.into());
            harness.run_steps(3);
            assert_looks(&mut harness, name);
        }
    }
}
