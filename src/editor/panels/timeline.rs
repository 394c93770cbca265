//! The timeline: frames, what is known of them, and the buttons to play.

use egui::{Color32, DragValue, Rect, Sense, Stroke, Ui, WidgetInfo, WidgetType, pos2, vec2};

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
        legend(ui);
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

/// Marks, what they mean, and how high they stand in the strip.
const MARKS: [(&str, Color32, &str); 3] = [
    ("loaded", Color32::from_rgb(132, 140, 152), "the frame's file has been read and is kept"),
    ("cached", theme::ACCENT, "the frame's picture is kept: it comes at once"),
    ("broken", theme::BAD, "the frame's file is missing or damaged: it is passed over"),
];
/// Height of a mark, in points.
const MARK: f32 = 5.0;

/// What the marks mean.
fn legend(ui: &mut Ui) {
    for (name, color, meaning) in MARKS {
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        let shown = ui.allocate_ui_with_layout(vec2(58.0, 22.0), layout, |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let (rect, _) = ui.allocate_exact_size(vec2(8.0, MARK), Sense::hover());
            ui.painter().rect_filled(rect, 1.0, color);
            ui.label(egui::RichText::new(name).small().weak());
        });
        shown.response.on_hover_text(meaning);
    }
}

/// Frames as a strip: what is known of each is marked, and the frame that is looked at.
fn strip(ui: &mut Ui, player: &mut Player) {
    let size = vec2(ui.available_width(), 22.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Slider, true, "Timeline"));
    let [first, last] = player.range;
    let n_frames = (last - first + 1).max(1) as f32;
    let x = |frame: i64| rect.left() + (frame - first) as f32 / n_frames * rect.width();
    let step = (rect.width() / n_frames).max(1.0);
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    ticks(ui, &painter, rect, [first, last], x);
    let mark = |frame: i64, row: f32, (_, color, _): (&str, Color32, &str)| {
        let at = pos2(x(frame), rect.bottom() - MARK * (1.0 + row));
        // A gap between frames, where there is room for one.
        let width = if step > 4.0 { step - 1.0 } else { step };
        painter.rect_filled(Rect::from_min_size(at, vec2(width, MARK - 1.0)), 0.0, color);
    };
    player.loaded.range(first..=last).for_each(|frame| mark(*frame, 1.0, MARKS[0]));
    player.cached.range(first..=last).for_each(|frame| mark(*frame, 0.0, MARKS[1]));
    for (frame, _) in player.broken.range(first..=last) {
        mark(*frame, 0.0, MARKS[2]);
        mark(*frame, 1.0, MARKS[2]);
    }
    let here = Rect::from_min_size(pos2(x(player.frame), rect.top()), vec2(step.max(2.0), rect.height()));
    painter.rect_filled(here, 1.0, ui.visuals().strong_text_color().gamma_multiply(0.35));
    painter.vline(here.left() + 1.0, rect.y_range(), Stroke::new(2.0, ui.visuals().strong_text_color()));
    let frame_at = |at: egui::Pos2| {
        let share = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        (first + (share * n_frames) as i64).min(last)
    };
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        player.go_to(frame_at(at));
    }
    if let Some(at) = response.hover_pos() {
        let frame = frame_at(at);
        response.on_hover_text_at_pointer(format!("frame {frame}: {}", about(player, frame)));
    }
}

/// What is known of a frame.
fn about(player: &Player, frame: i64) -> String {
    match (player.broken.get(&frame), player.loaded.contains(&frame), player.cached.contains(&frame)) {
        (Some(broken), ..) => format!("passed over, {}", broken.why),
        (None, true, true) => "loaded, and its picture is kept".to_owned(),
        (None, false, true) => "its picture is kept".to_owned(),
        (None, true, false) => "loaded, its picture is not computed yet".to_owned(),
        (None, false, false) => "not loaded yet".to_owned(),
    }
}

/// Numbers of frames, as many as there is room for.
fn ticks(ui: &Ui, painter: &egui::Painter, rect: Rect, [first, last]: [i64; 2], x: impl Fn(i64) -> f32) {
    let most = (rect.width() / 60.0).max(1.0) as i64;
    let span = last.saturating_sub(first);
    let steps = (0..18).flat_map(|power| [1, 2, 5].map(|n| n * 10_i64.pow(power)));
    let step = steps.into_iter().find(|step| span / step <= most).unwrap_or(i64::MAX);
    let mut frame = first.div_euclid(step).saturating_mul(step);
    let ink = ui.visuals().weak_text_color();
    while frame <= last {
        if frame >= first {
            let at = pos2(x(frame), rect.top());
            painter.vline(at.x, rect.top()..=rect.top() + 4.0, Stroke::new(1.0, ink));
            let font = egui::FontId::proportional(9.5);
            painter.text(at + vec2(3.0, 0.0), egui::Align2::LEFT_TOP, frame.to_string(), font, ink);
        }
        let Some(next) = frame.checked_add(step) else { break };
        frame = next;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use egui::{Event, Modifiers, PointerButton, Pos2, vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    type Bench = (Player, f64);

    fn window() -> Harness<'static, Bench> {
        let mut player = Player::default();
        player.set_span(Some(([1, 20], BTreeSet::from([7]))), |_| true);
        (player.loaded, player.cached) = ([2, 3].into(), [3].into());
        let draw = |ui: &mut Ui, (player, fps): &mut Bench| {
            player.advance(ui.input(|input| input.time), *fps);
            show(ui, player, fps);
        };
        let builder = Harness::builder().with_size(vec2(1100.0, 60.0)).with_step_dt(1.0 / 60.0);
        let mut harness = builder.build_ui_state(draw, (player, 24.0));
        harness.run_steps(2);
        harness
    }

    /// The middle of a frame in the strip.
    fn place(harness: &Harness<Bench>, frame: i64) -> Pos2 {
        let strip = harness.get_by_label("Timeline").rect();
        strip.left_center() + vec2((frame as f32 - 0.5) / 20.0 * strip.width(), 0.0)
    }

    fn frame(harness: &Harness<Bench>) -> i64 {
        harness.state().0.frame
    }

    fn press(harness: &mut Harness<Bench>, pos: Pos2, pressed: bool) {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        harness.event(Event::PointerButton { pos, button, pressed, modifiers });
        harness.step();
    }

    #[test]
    fn a_click_goes_to_a_frame_and_a_drag_scrubs() {
        let mut harness = window();
        let at = place(&harness, 12);
        harness.hover_at(at);
        harness.step();
        press(&mut harness, at, true);
        press(&mut harness, at, false);
        assert_eq!(frame(&harness), 12);
        press(&mut harness, at, true);
        for n in [13, 15, 18] {
            harness.hover_at(place(&harness, n));
            harness.step();
        }
        assert_eq!(frame(&harness), 18);
        // Beyond the end there is the last.
        harness.hover_at(place(&harness, 40));
        harness.step();
        assert_eq!(frame(&harness), 20);
        let end = place(&harness, 20);
        press(&mut harness, end, false);
    }

    #[test]
    fn it_plays_at_true_rate_and_stops() {
        let mut harness = window();
        harness.get_by_label("Play").click();
        harness.run_steps(3);
        let first = frame(&harness);
        harness.run_steps(15);
        // A quarter of a second of 24.
        assert_eq!(frame(&harness) - first, 6);
        harness.get_by_label("Stop").click();
        harness.run_steps(3);
        let stopped = frame(&harness);
        harness.run_steps(30);
        assert_eq!(frame(&harness), stopped);
    }

    #[test]
    fn range_and_loop_are_set() {
        let mut harness = window();
        let at = harness.get_by_label("Last frame").rect().center();
        harness.hover_at(at);
        harness.step();
        press(&mut harness, at, true);
        for n in 1..6 {
            harness.hover_at(at - vec2(10.0 * n as f32, 0.0));
            harness.step();
        }
        press(&mut harness, at - vec2(50.0, 0.0), false);
        let [first, last] = harness.state().0.range;
        assert!(first == 1 && (8..15).contains(&last), "{last}");
        harness.get_by_label("Loop").click();
        harness.run_steps(2);
        assert!(!harness.state().0.loops);
        // Without a loop it ends at the last frame.
        harness.get_by_label("Play").click();
        harness.run_steps(90);
        assert!(frame(&harness) == last && !harness.state().0.is_playing());
    }

    #[test]
    fn the_rate_is_dragged() {
        let mut harness = window();
        let at = harness.get_by_label("Frames a second").rect().center();
        press(&mut harness, at, true);
        for n in 0..=5 {
            harness.hover_at(at + vec2(12.0 * n as f32, 0.0));
            harness.step();
        }
        press(&mut harness, at + vec2(60.0, 0.0), false);
        let fps = harness.state().1;
        assert!((26.0..31.0).contains(&fps), "{fps}");
    }

    #[test]
    fn marks_are_told_by_frame() {
        let mut harness = window();
        for (frame, told) in [
            (2, "frame 2: loaded, its picture is not computed yet"),
            (3, "frame 3: loaded, and its picture is kept"),
            (7, "frame 7: passed over, there is no file of this frame"),
            (9, "frame 9: not loaded yet"),
        ] {
            harness.hover_at(place(&harness, frame));
            harness.run_steps(60);
            assert!(harness.query_by_label(told).is_some(), "{told}");
        }
        for (name, ..) in MARKS {
            assert!(harness.query_by_label(name).is_some());
        }
    }
}
