//! Colors, spacing and sizes of the window: calm greys, so that the picture is the only bright thing.

use egui::{Color32, Context, CornerRadius, Stroke, Theme, ThemePreference, Visuals, vec2};

/// The one color that means "this".
pub const ACCENT: Color32 = Color32::from_rgb(86, 146, 214);
/// What failed.
pub const BAD: Color32 = Color32::from_rgb(226, 102, 92);

/// Height of a line of controls, in points.
const LINE: f32 = 24.0;

/// Sets both themes, and which of them is used.
pub fn apply(context: &Context, preference: ThemePreference) {
    context.set_visuals_of(Theme::Dark, dark());
    context.set_visuals_of(Theme::Light, light());
    context.all_styles_mut(|style| {
        style.spacing.item_spacing = vec2(8.0, 6.0);
        // As high as a button: what stands in one line then has one middle, whichever of it comes first.
        style.spacing.interact_size.y = LINE;
        style.spacing.button_padding = vec2(8.0, 3.0);
        style.spacing.menu_margin = egui::Margin::same(6);
        style.interaction.selectable_labels = false;
    });
    context.set_theme(preference);
}

/// Behind the picture.
pub fn backdrop(ui: &egui::Ui) -> Color32 {
    if ui.visuals().dark_mode { Color32::from_rgb(17, 18, 20) } else { Color32::from_rgb(198, 201, 206) }
}

fn dark() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = Color32::from_rgb(28, 30, 34);
    visuals.window_fill = Color32::from_rgb(34, 36, 41);
    visuals.extreme_bg_color = Color32::from_rgb(19, 20, 23);
    visuals.faint_bg_color = Color32::from_rgb(33, 35, 40);
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_rgb(46, 49, 55));
    visuals.widgets.noninteractive.fg_stroke.color = Color32::from_rgb(196, 200, 207);
    visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(44, 47, 53);
    visuals.widgets.inactive.bg_fill = Color32::from_rgb(50, 53, 60);
    visuals.widgets.inactive.fg_stroke.color = Color32::from_rgb(208, 212, 219);
    visuals.widgets.hovered.weak_bg_fill = Color32::from_rgb(56, 60, 68);
    visuals.widgets.active.weak_bg_fill = Color32::from_rgb(66, 71, 80);
    visuals.window_stroke = Stroke::new(1.0, Color32::from_rgb(52, 55, 62));
    visuals.weak_text_color = Some(Color32::from_rgb(148, 154, 164));
    visuals.error_fg_color = Color32::from_rgb(240, 128, 118);
    visuals.hyperlink_color = Color32::from_rgb(112, 168, 230);
    shared(&mut visuals);
    visuals
}

fn light() -> Visuals {
    let mut visuals = Visuals::light();
    visuals.panel_fill = Color32::from_rgb(240, 241, 243);
    visuals.window_fill = Color32::from_rgb(250, 250, 251);
    visuals.faint_bg_color = Color32::from_rgb(232, 234, 237);
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_rgb(212, 215, 220));
    visuals.widgets.noninteractive.fg_stroke.color = Color32::from_rgb(52, 57, 65);
    visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(222, 225, 230);
    visuals.widgets.inactive.bg_fill = Color32::from_rgb(212, 216, 222);
    visuals.widgets.inactive.fg_stroke.color = Color32::from_rgb(40, 44, 52);
    visuals.widgets.hovered.weak_bg_fill = Color32::from_rgb(210, 214, 221);
    visuals.widgets.active.weak_bg_fill = Color32::from_rgb(196, 201, 210);
    visuals.weak_text_color = Some(Color32::from_rgb(92, 98, 108));
    visuals.error_fg_color = Color32::from_rgb(178, 36, 30);
    visuals.warn_fg_color = Color32::from_rgb(150, 92, 0);
    visuals.hyperlink_color = Color32::from_rgb(24, 92, 170);
    shared(&mut visuals);
    visuals
}

fn shared(visuals: &mut Visuals) {
    visuals.selection.bg_fill = ACCENT.gamma_multiply(0.55);
    visuals.selection.stroke.color = if visuals.dark_mode { Color32::WHITE } else { Color32::BLACK };
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    for widget in [
        &mut visuals.widgets.noninteractive,
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
    ] {
        widget.corner_radius = CornerRadius::same(4);
    }
}

/// Of the Web Content Accessibility Guidelines 2.1: 1 for equal, 21 for black on white.
#[cfg(test)]
pub fn contrast(a: Color32, b: Color32) -> f32 {
    let luminance = |color: Color32| {
        let [r, g, b, _] = egui::Rgba::from(color).to_array();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_can_be_read() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-4);
        for visuals in [dark(), light()] {
            let inks = [
                visuals.text_color(),
                visuals.weak_text_color(),
                visuals.error_fg_color,
                visuals.warn_fg_color,
                visuals.hyperlink_color,
            ];
            for ink in inks {
                for ground in [visuals.panel_fill, visuals.window_fill, visuals.faint_bg_color] {
                    let contrast = contrast(ink, ground);
                    assert!(contrast > 4.5, "{ink:?} on {ground:?}: {contrast}");
                }
            }
            let on_button =
                contrast(visuals.widgets.inactive.fg_stroke.color, visuals.widgets.inactive.weak_bg_fill);
            assert!(on_button > 4.5, "{on_button}");
        }
    }
}
