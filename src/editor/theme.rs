//! Colors, spacing and sizes of the window: calm greys, so that the picture is the only bright thing.

use egui::{Color32, Context, CornerRadius, Stroke, Theme, ThemePreference, Visuals, vec2};

/// The one color that means "this".
pub const ACCENT: Color32 = Color32::from_rgb(86, 146, 214);
/// What failed.
pub const BAD: Color32 = Color32::from_rgb(226, 102, 92);

/// Sets both themes, and which of them is used.
pub fn apply(context: &Context, preference: ThemePreference) {
    context.set_visuals_of(Theme::Dark, dark());
    context.set_visuals_of(Theme::Light, light());
    context.all_styles_mut(|style| {
        style.spacing.item_spacing = vec2(8.0, 6.0);
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
    shared(&mut visuals);
    visuals
}

fn light() -> Visuals {
    let mut visuals = Visuals::light();
    visuals.panel_fill = Color32::from_rgb(240, 241, 243);
    visuals.window_fill = Color32::from_rgb(250, 250, 251);
    visuals.faint_bg_color = Color32::from_rgb(232, 234, 237);
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_rgb(212, 215, 220));
    shared(&mut visuals);
    visuals
}

fn shared(visuals: &mut Visuals) {
    visuals.selection.bg_fill = ACCENT.gamma_multiply(0.55);
    visuals.selection.stroke.color = if visuals.dark_mode { Color32::WHITE } else { Color32::BLACK };
    visuals.hyperlink_color = ACCENT;
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
