//! Curves of control points: points are dragged, added by a double click, removed by a right click; colors from a
//! map.
//!
//! Across is the first column, up the last one; columns r, g, b between them color the points and the strip below.
//! The plot spans the points themselves, so a point at its end goes further out by being dragged over the border or
//! typed. A drag stops at the plot's upper and lower border, which are the limits of the column.

use egui::{
    Align, Color32, ComboBox, Layout, Mesh, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, pos2, vec2,
};
use serde_json::Value as Json;

use super::expression::evaluate;
use super::number::{entry, named, text_of};
use super::row::{LETTER, column};
use super::slot::{Slot, numbers};
use crate::image::colormap::{self, Colormap};
use crate::image::tonemap::srgb_encode;

type Rows = Vec<Vec<f64>>;

const HEIGHT: f32 = 110.0;
const STRIP: f32 = 12.0;
const GRIP: f32 = 6.0;
/// As many as a map needs to be told from its table by nobody.
const POINTS_OF_A_MAP: usize = 9;

/// What a curve that was null begins as: from nothing at 0 to all at 1.
pub fn ramp(columns: &[&str]) -> Json {
    let row = |x: f64| {
        let colors = columns.len().saturating_sub(2);
        let row: Vec<f64> = [x].into_iter().chain(std::iter::repeat_n(1.0, colors)).chain([x]).collect();
        numbers(&row[..columns.len()])
    };
    Json::Array(vec![row(0.0), row(1.0)])
}

/// The plot, the selected point's numbers, and the maps.
pub fn show(ui: &mut Ui, slot: &mut Slot, columns: &[&str]) -> Option<String> {
    let rows = rows(slot, columns)?;
    let size = vec2(ui.available_width() - 4.0, HEIGHT + STRIP);
    let (whole, plot) = ui.allocate_exact_size(size, Sense::click());
    named(&plot, &slot.name());
    let area = Area::new(Rect::from_min_size(whole.min, vec2(size.x, HEIGHT)), &rows, slot);
    paint(ui, &area, &rows, columns, whole);
    let mut message = None;
    if plot.double_clicked()
        && let Some(at) = plot.interact_pointer_pos()
    {
        let rows = with_point(&rows, area.row_at(at));
        message = slot.set(json(&rows), None).err();
    }
    let chosen_id = slot.id().with("chosen");
    let mut chosen: usize = ui.data(|data| data.get_temp(chosen_id)).unwrap_or(0);
    for (idx, row) in rows.iter().enumerate() {
        let at = area.place(row);
        let id = slot.id().with(("point", idx));
        let grip = Rect::from_center_size(at, vec2(2.0 * GRIP, 2.0 * GRIP));
        let response = ui.interact(grip, id, Sense::click_and_drag());
        named(&response, &format!("{} point {idx}", slot.name()));
        if response.clicked() || response.drag_started() {
            chosen = idx;
        }
        message = message.take().or_else(|| moved(slot, &rows, idx, &area, &response));
        let stroke = Stroke::new(if idx == chosen { 2.5 } else { 1.0 }, ui.visuals().strong_text_color());
        ui.painter().circle(at, GRIP - 1.0, color_of(row, columns), stroke);
    }
    chosen = chosen.min(rows.len() - 1);
    ui.data_mut(|data| data.insert_temp(chosen_id, chosen));
    let changed = point(ui, slot, &rows, columns, chosen);
    let mapped = maps(ui, slot, &rows, columns);
    message.or(changed).or(mapped)
}

/// A point that is dragged or removed.
fn moved(slot: &mut Slot, rows: &Rows, idx: usize, area: &Area, response: &Response) -> Option<String> {
    let mut rows = rows.clone();
    if response.secondary_clicked() && rows.len() > 1 {
        rows.remove(idx);
        return slot.set(json(&rows), None).err();
    }
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged())?;
    let (x, y) = area.row_at(pointer);
    let last = rows[idx].len() - 1;
    (rows[idx][0], rows[idx][last]) = (x, y);
    // Past its neighbor it would be refused: it waits there, and the reason stands below.
    slot.set(json(&rows), Some(slot.id().with("points"))).err()
}

/// The numbers of the chosen point.
fn point(ui: &mut Ui, slot: &mut Slot, rows: &Rows, columns: &[&str], chosen: usize) -> Option<String> {
    let mut message = None;
    let rgb = rgb_of(columns);
    let is_color = |part: usize| rgb.is_some_and(|rgb| (rgb..rgb + 3).contains(&part));
    // The components of the color in a line of their own, as other colors have them.
    for colors in [false, true] {
        ui.horizontal(|ui| {
            let cell = vec2(column(ui, 3), ui.spacing().interact_size.y);
            let name_width = if colors { LETTER } else { 52.0 };
            for (part, name) in columns.iter().enumerate().filter(|(part, _)| is_color(*part) == colors) {
                let (id, label) =
                    (slot.id().with(("number", chosen, part)), format!("{}.{name}", slot.name()));
                let typed = ui.allocate_ui_with_layout(cell, Layout::left_to_right(Align::Center), |ui| {
                    ui.set_min_size(cell);
                    ui.spacing_mut().item_spacing.x = 0.0;
                    let taken = ui.weak(*name).rect.width();
                    ui.add_space((name_width - taken).max(4.0));
                    entry(ui, id, &label, &text_of(rows[chosen][part]), ui.available_width(), |text| {
                        let mut rows = rows.clone();
                        rows[chosen][part] = evaluate(text)?;
                        slot.set(json(&rows), None)
                    })
                });
                message = message.take().or(typed.inner);
            }
            if let Some(rgb) = rgb.filter(|_| !colors) {
                message = message.take().or(swatch(ui, slot, rows, rgb, chosen));
            }
        });
    }
    message
}

/// The chosen point's color, which opens a picker.
fn swatch(ui: &mut Ui, slot: &mut Slot, rows: &Rows, rgb: usize, chosen: usize) -> Option<String> {
    let row = &rows[chosen];
    let mut picked = [row[rgb], row[rgb + 1], row[rgb + 2]].map(|x| x as f32);
    let response = egui::color_picker::color_edit_button_rgb(ui, &mut picked);
    named(&response, &format!("{} picker", slot.name()));
    if !response.changed() {
        return None;
    }
    let mut rows = rows.clone();
    for (n, x) in picked.into_iter().enumerate() {
        rows[chosen][rgb + n] = f64::from((x * 1e4).round()) / 1e4;
    }
    slot.set(json(&rows), Some(slot.id().with("picker"))).err()
}

/// Colors from a map over the same span, the last column as it is.
fn maps(ui: &mut Ui, slot: &mut Slot, rows: &Rows, columns: &[&str]) -> Option<String> {
    let rgb = rgb_of(columns)?;
    let mut chosen = None;
    let combo = ComboBox::from_id_salt(slot.id().with("map")).selected_text("Colors of a map");
    let shown = combo.show_ui(ui, |ui| {
        for name in colormap::NAMES {
            if ui.selectable_label(false, *name).clicked() {
                chosen = Colormap::named(name);
            }
        }
    });
    named(&shown.response, &format!("{} map", slot.name()));
    let map = chosen?;
    let (low, high) = (rows[0][0], rows[rows.len() - 1][0]);
    let count = if high > low { POINTS_OF_A_MAP } else { 1 };
    let colored = (0..count).map(|n| {
        let t = n as f64 / (count - 1).max(1) as f64;
        let mut row = between(rows, low + t * (high - low));
        for (x, light) in row[rgb..].iter_mut().zip(map.linear(t)) {
            *x = (f64::from(light) * 1e4).round() / 1e4;
        }
        row
    });
    let colored: Rows = colored.collect();
    slot.set(json(&colored), None).err()
}

/// Where the plot is, and what it spans.
struct Area {
    rect: Rect,
    x: [f64; 2],
    y: [f64; 2],
}

impl Area {
    fn new(rect: Rect, rows: &Rows, slot: &Slot) -> Self {
        let (first, last) = (rows[0][0], rows[rows.len() - 1][0]);
        let half = if last > first { 0.0 } else { 0.5 * first.abs().max(1.0) };
        let highest = rows.iter().filter_map(|row| row.last()).copied().fold(1.0, f64::max);
        let y = [slot.spec.hard.min.unwrap_or(0.0), slot.spec.hard.max.unwrap_or(highest)];
        Self { rect: rect.shrink(GRIP), x: [first - half, last + half], y }
    }

    fn place(&self, row: &[f64]) -> Pos2 {
        let x = (row[0] - self.x[0]) / (self.x[1] - self.x[0]);
        let y = (row[row.len() - 1] - self.y[0]) / (self.y[1] - self.y[0]);
        pos2(
            self.rect.left() + x as f32 * self.rect.width(),
            self.rect.bottom() - y as f32 * self.rect.height(),
        )
    }

    /// First and last number of a place, to a thousandth of what the plot spans.
    fn row_at(&self, at: Pos2) -> (f64, f64) {
        let x = f64::from((at.x - self.rect.left()) / self.rect.width());
        let y = f64::from(((self.rect.bottom() - at.y) / self.rect.height()).clamp(0.0, 1.0));
        let short = |t: f64, [low, high]: [f64; 2]| {
            let step = 10f64.powf((1e-3 * (high - low)).log10().floor());
            // Divided, because a tenth has no exact double and 3 * 0.1 is not 0.3.
            ((low + t * (high - low)) / step).round() / (1.0 / step).round().max(1.0) * step.max(1.0)
        };
        (short(x, self.x), short(y, self.y))
    }
}

fn paint(ui: &Ui, area: &Area, rows: &Rows, columns: &[&str], whole: Rect) {
    let painter = ui.painter_at(whole);
    let visuals = ui.visuals();
    let outer = area.rect.expand(GRIP);
    painter.rect_filled(outer, 2.0, visuals.extreme_bg_color);
    let line: Vec<Pos2> = rows.iter().map(|row| area.place(row)).collect();
    painter.add(Shape::line(line, Stroke::new(1.5, visuals.weak_text_color())));
    let strip =
        Rect::from_min_max(pos2(outer.left(), outer.bottom()), outer.right_bottom() + vec2(0.0, STRIP));
    let mut mesh = Mesh::default();
    const STEPS: usize = 64;
    for n in 0..=STEPS {
        let t = n as f32 / STEPS as f32;
        let value = area.x[0] + f64::from(t) * (area.x[1] - area.x[0]);
        let color = color_of(&between(rows, value), columns);
        for y in [strip.top(), strip.bottom()] {
            mesh.colored_vertex(pos2(strip.left() + t * strip.width(), y), color);
        }
        if n > 0 {
            let corner = 2 * n as u32;
            mesh.add_triangle(corner - 2, corner - 1, corner);
            mesh.add_triangle(corner - 1, corner, corner + 1);
        }
    }
    painter.add(Shape::mesh(mesh));
}

/// The column at which r, g, b begin.
fn rgb_of(columns: &[&str]) -> Option<usize> {
    columns.windows(3).position(|names| names == ["r", "g", "b"])
}

fn color_of(row: &[f64], columns: &[&str]) -> Color32 {
    let Some(rgb) = rgb_of(columns) else { return Color32::GRAY };
    let byte = |x: f64| (255.0 * srgb_encode(x.clamp(0.0, 1.0) as f32)).round() as u8;
    Color32::from_rgb(byte(row[rgb]), byte(row[rgb + 1]), byte(row[rgb + 2]))
}

fn rows(slot: &Slot, columns: &[&str]) -> Option<Rows> {
    let row = |json: &Json| -> Option<Vec<f64>> {
        let items = json.as_array().filter(|items| items.len() == columns.len())?;
        items.iter().map(Json::as_f64).collect()
    };
    let rows: Option<Rows> = slot.json().as_array()?.iter().map(row).collect();
    // A file may hold what is no curve; then only its message is shown.
    rows.filter(|rows| !rows.is_empty())
}

fn json(rows: &Rows) -> Json {
    rows.iter().map(|row| numbers(row)).collect()
}

/// All columns at a value, linear between rows, beyond the ends those of the end.
fn between(rows: &Rows, value: f64) -> Vec<f64> {
    let next = rows.partition_point(|row| row[0] <= value);
    let mut row = match (next.checked_sub(1).map(|low| &rows[low]), rows.get(next)) {
        (Some(low), Some(high)) => {
            let share = (value - low[0]) / (high[0] - low[0]);
            low.iter().zip(high).map(|(a, b)| a + share * (b - a)).collect()
        }
        (Some(end), None) | (None, Some(end)) => end.clone(),
        (None, None) => Vec::new(),
    };
    if let Some(first) = row.first_mut() {
        *first = value;
    }
    row
}

/// With another point, whose inner columns are those of the curve there.
fn with_point(rows: &Rows, (x, y): (f64, f64)) -> Rows {
    let mut row = between(rows, x);
    if let Some(last) = row.last_mut() {
        *last = y;
    }
    let mut rows = rows.clone();
    rows.insert(rows.partition_point(|row| row[0] < x), row);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_between_points() {
        let rows = vec![vec![0.0, 1.0, 0.0], vec![4.0, 0.0, 1.0]];
        assert_eq!(between(&rows, 1.0), [1.0, 0.75, 0.25]);
        assert_eq!((between(&rows, -1.0), between(&rows, 9.0)), (vec![-1.0, 1.0, 0.0], vec![9.0, 0.0, 1.0]));
        assert_eq!(with_point(&rows, (2.0, 0.9))[1], [2.0, 0.5, 0.9]);
        assert_eq!(ramp(&["value", "r", "g", "b", "opacity"])[1].to_string(), "[1,1,1,1,1]");
        assert_eq!(ramp(&["value", "opacity"]).to_string(), "[[0,0],[1,1]]");
    }

    #[test]
    fn places_are_short_numbers() {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 50.0));
        let area = Area { rect, x: [0.0, 3.0], y: [0.0, 1.0] };
        assert_eq!(area.row_at(pos2(10.0, 35.0)), (0.3, 0.3));
        assert_eq!(area.row_at(pos2(110.0, -5.0)).1, 1.0);
        let (x, y) = area.row_at(area.place(&[1.234, 0.5]));
        assert!((x - 1.234).abs() < 2e-3 && y == 0.5, "{x} {y}");
        let wide = Area { rect, x: [0.0, 50_000.0], y: [0.0, 1.0] };
        assert_eq!(wide.row_at(pos2(50.0, 0.0)).0, 25_000.0);
    }
}
