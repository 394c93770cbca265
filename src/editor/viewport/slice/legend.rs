//! Which color stands for which value.

use egui::{
    Align2, Color32, FontId, Mesh, Rect, Sense, Stroke, StrokeKind, Ui, WidgetInfo, WidgetType, pos2, vec2,
};

use crate::editor::viewport::overlay::{INK, SHADE, short};
use crate::image::Colormap;

/// Colors along the bar: more than a map has entries is not seen.
const N_STEPS: usize = 128;

/// Draws the bar at the right edge of `area`; `at` is the value under the cursor.
pub fn show(ui: &mut Ui, area: Rect, map: &str, [name, unit]: [&str; 2], range: [f64; 2], at: Option<f32>) {
    let Some(map) = Colormap::named(map) else { return };
    // Above it the picture says that it is refined, below it stand two lines of values.
    let free = Rect::from_min_max(area.min + vec2(0.0, 40.0), area.max - vec2(0.0, 76.0));
    let height = (free.height() - 46.0).min(220.0);
    // Colors that cannot be told apart, or a legend over half the picture, say nothing.
    if height < 40.0 || area.width() < 300.0 {
        return;
    }
    let title = if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") };
    let font = FontId::proportional(11.0);
    let painter = ui.painter().with_clip_rect(area);
    let title = painter.layout_no_wrap(title, font.clone(), INK);
    let ends = range.map(|value| short(value as f32));
    let width = title.size().x.max(74.0) + 20.0;
    let size = vec2(width, height + 46.0);
    let shade = Rect::from_center_size(pos2(area.right() - 10.0 - 0.5 * width, free.center().y), size);
    let response = ui.interact(shade, ui.id().with("legend"), Sense::hover());
    let spoken = format!("Legend: {name} from {} to {} {unit}", ends[0], ends[1]);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, spoken.trim_end()));
    painter.rect_filled(shade, 4.0, SHADE);
    painter.galley(shade.min + vec2(10.0, 7.0), title, INK);
    let bar = Rect::from_min_size(shade.min + vec2(10.0, 30.0), vec2(14.0, height));
    let mut mesh = Mesh::default();
    for n in 0..=N_STEPS {
        let t = n as f64 / N_STEPS as f64;
        let [r, g, b] = map.srgb(t).map(|signal| (signal * 255.0).round() as u8);
        let y = bar.bottom() - t as f32 * bar.height();
        for x in [bar.left(), bar.right()] {
            mesh.colored_vertex(pos2(x, y), Color32::from_rgb(r, g, b));
        }
        if let Some(first) = (2 * n as u32).checked_sub(2) {
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 2, first + 3);
        }
    }
    painter.add(mesh);
    painter.rect_stroke(bar, 0.0, Stroke::new(1.0, Color32::from_white_alpha(90)), StrokeKind::Outside);
    let middle = short((0.5 * (range[0] + range[1])) as f32);
    for (share, text) in [(0.0, &ends[0]), (0.5, &middle), (1.0, &ends[1])] {
        let y = bar.bottom() - share * bar.height();
        painter.hline(bar.right()..=bar.right() + 4.0, y, Stroke::new(1.0, INK));
        painter.text(pos2(bar.right() + 8.0, y), Align2::LEFT_CENTER, text, font.clone(), INK);
    }
    if let Some(value) = at.filter(|_| range[1] > range[0]) {
        let share = ((f64::from(value) - range[0]) / (range[1] - range[0])).clamp(0.0, 1.0) as f32;
        let y = bar.bottom() - share * bar.height();
        let tip = pos2(bar.left() - 1.0, y);
        let arrow = vec![tip, tip + vec2(-6.0, -4.0), tip + vec2(-6.0, 4.0)];
        painter.add(egui::Shape::convex_polygon(arrow, INK, Stroke::NONE));
    }
}
