//! The timeline: frames, what is known of them, and the buttons to play.

use egui::{DragValue, Rect, Sense, Ui, WidgetInfo, WidgetType, pos2, vec2};

use crate::editor::player::Player;
use crate::editor::theme;

/// Draws it and applies what is clicked.
pub fn show(ui: &mut Ui, player: &mut Player, fps: &mut f64) {
    let now = ui.input(|input| input.time);
    ui.horizontal(|ui| {
        let play = if player.is_playing() { "Stop" } else { "Play" };
        if ui.add_sized([48.0, 22.0], egui::Button::new(play)).clicked() {
            player.toggle(now);
        }
        let mut frame = player.frame;
        let drag = ui.add(DragValue::new(&mut frame).range(player.range[0]..=player.range[1]).speed(0.2));
        drag.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, "Frame"));
        if frame != player.frame {
            player.go_to(frame);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let rate =
                ui.add(DragValue::new(fps).range(1.0..=240.0).speed(0.1).max_decimals(3).suffix(" fps"));
            rate.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, "Frames a second"));
            ui.checkbox(&mut player.loops, "Loop");
            let [first, last] = &mut player.range;
            let end = ui.add(DragValue::new(last).range(*first..=i64::MAX).speed(0.2));
            end.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, "Last frame"));
            let start = ui.add(DragValue::new(first).range(i64::MIN..=*last).speed(0.2));
            start.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, "First frame"));
            strip(ui, player);
        });
    });
}

/// Frames as a strip: known ones are marked, broken ones too.
fn strip(ui: &mut Ui, player: &mut Player) {
    let size = vec2(ui.available_width(), 22.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Slider, true, "Timeline"));
    let [first, last] = player.range;
    let n_frames = (last - first + 1).max(1) as f32;
    let x = |frame: i64| rect.left() + (frame - first) as f32 / n_frames * rect.width();
    let step = (rect.width() / n_frames).max(1.0);
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let mark = |frame: &i64, color| {
        let at = pos2(x(*frame), rect.bottom() - 6.0);
        painter.rect_filled(Rect::from_min_size(at, vec2(step, 6.0)), 0.0, color);
    };
    player.known.range(first..=last).for_each(|frame| mark(frame, theme::ACCENT.gamma_multiply(0.7)));
    player.broken.range(first..=last).for_each(|frame| mark(frame, theme::BAD));
    let here = Rect::from_min_size(pos2(x(player.frame), rect.top()), vec2(step.max(2.0), rect.height()));
    painter.rect_filled(here, 1.0, ui.visuals().strong_text_color().gamma_multiply(0.8));
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        let share = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        player.go_to(first + (share * n_frames) as i64);
    }
    if let Some(at) = response.hover_pos() {
        let frame = first + ((at.x - rect.left()) / rect.width() * n_frames) as i64;
        let what = match (player.broken.contains(&frame), player.known.contains(&frame)) {
            (true, _) => "missing or broken: passed over",
            (_, true) => "its picture is known",
            _ => "not computed yet",
        };
        response.on_hover_text_at_pointer(format!("frame {frame}: {what}"));
    }
}
