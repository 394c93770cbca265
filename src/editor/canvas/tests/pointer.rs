//! Selecting, moving, panning and zooming.

use egui::{MouseWheelUnit, PointerButton, TouchPhase, vec2};

use super::*;

fn place(harness: &Harness<Bench>, name: &str) -> [f64; 2] {
    harness.state().project.document().layout[name]
}

#[test]
fn a_click_selects_and_with_shift_adds_or_takes_away() {
    let mut harness = window(SCENE);
    click(&mut harness, "node sun");
    assert_eq!(harness.state().selected(), ["sun"]);
    click(&mut harness, "node split");
    assert_eq!(harness.state().selected(), ["split"]);
    click_with(&mut harness, "node moon", Modifiers::SHIFT);
    assert_eq!(harness.state().selected(), ["split", "moon"]);
    click_with(&mut harness, "node split", Modifiers::COMMAND);
    assert_eq!(harness.state().selected(), ["moon"]);
    harness.hover_at(EMPTY);
    harness.step();
    harness.drag_at(EMPTY);
    harness.step();
    harness.drop_at(EMPTY);
    harness.run_steps(2);
    assert_eq!(harness.state().selected(), [] as [&str; 0]);
}

#[test]
fn a_box_selects_what_it_touches() {
    let mut harness = window(SCENE);
    let from = rect(&harness, "node sun").left_top() - vec2(15.0, 15.0);
    let to = rect(&harness, "node moon").center();
    drag(&mut harness, from, to);
    assert_eq!(harness.state().selected(), ["sun", "moon"]);
}

#[test]
fn a_drag_moves_all_that_is_selected_as_one_step() {
    let mut harness = window(SCENE);
    click(&mut harness, "node sun");
    click_with(&mut harness, "node moon", Modifiers::SHIFT);
    let from = rect(&harness, "node sun").center_top() + vec2(0.0, 8.0);
    let zoom = f64::from(harness.state().canvas.view.zoom);
    drag(&mut harness, from, from + vec2(-40.0, 30.0));
    let moved = [(-40.0 / zoom).round(), (30.0 / zoom).round()];
    assert_eq!(place(&harness, "sun"), moved);
    assert_eq!(place(&harness, "moon"), [moved[0], 150.0 + moved[1]]);
    assert_eq!(place(&harness, "split"), [280.0, 0.0]);
    harness.hover_at(EMPTY);
    undo(&mut harness);
    assert_eq!((place(&harness, "sun"), place(&harness, "moon")), ([0.0, 0.0], [0.0, 150.0]));
    assert_eq!(harness.state_mut().project.undo(), None);
}

#[test]
fn a_drag_of_another_node_selects_it() {
    let mut harness = window(SCENE);
    click(&mut harness, "node sun");
    let from = rect(&harness, "node camera").center_top() + vec2(0.0, 8.0);
    drag(&mut harness, from, from + vec2(0.0, 50.0));
    assert_eq!(harness.state().selected(), ["camera"]);
    assert_eq!(place(&harness, "sun"), [0.0, 0.0]);
    assert!(place(&harness, "camera")[1] > 280.0);
}

#[test]
fn escape_takes_a_move_back() {
    let mut harness = window(SCENE);
    let from = rect(&harness, "node camera").center_top() + vec2(0.0, 8.0);
    drag_to(&mut harness, from, from + vec2(0.0, 50.0));
    assert_ne!(place(&harness, "camera"), [280.0, 250.0]);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(place(&harness, "camera"), [280.0, 250.0]);
}

#[test]
fn moved_nodes_snap_to_the_grid_when_told_to() {
    let mut harness = window(SCENE);
    harness.state_mut().canvas.ask(super::super::Command::ToggleSnap);
    let from = rect(&harness, "node camera").center_top() + vec2(0.0, 8.0);
    drag(&mut harness, from, from + vec2(50.0, 50.0));
    let step = f64::from(super::super::paint::GRID);
    assert!(place(&harness, "camera").iter().all(|x| x % step == 0.0), "{:?}", place(&harness, "camera"));
}

#[test]
fn the_middle_button_alt_and_space_pan() {
    let mut harness = window(SCENE);
    let pan = |harness: &Harness<Bench>| harness.state().canvas.view.pan;
    let by = vec2(30.0, -20.0);
    let mut expected = pan(&harness) + by;
    let button = |pos, pressed, button, modifiers| Event::PointerButton { pos, button, pressed, modifiers };
    let over_node = at(&harness, "node split");
    harness.hover_at(over_node);
    harness.step();
    harness.event(button(over_node, true, PointerButton::Middle, Modifiers::NONE));
    harness.step();
    harness.hover_at(over_node + by);
    harness.step();
    harness.event(button(over_node + by, false, PointerButton::Middle, Modifiers::NONE));
    harness.run_steps(2);
    // Positions near 1e3 in f32.
    assert!((pan(&harness) - expected).length() < 1e-2, "{:?}", pan(&harness));

    harness.key_down(Key::Space);
    harness.step();
    drag(&mut harness, EMPTY, EMPTY + by);
    harness.hover_at(EMPTY);
    harness.key_up(Key::Space);
    harness.run_steps(3);
    expected += by;
    assert!((pan(&harness) - expected).length() < 1e-2, "{:?}", pan(&harness));
    assert!(harness.query_by_label("add sun").is_none(), "a pan opens no search");

    drag_with_alt(&mut harness, by);
    expected += by;
    assert!((pan(&harness) - expected).length() < 1e-2, "{:?} {expected:?}", pan(&harness));
}

fn drag_with_alt(harness: &mut Harness<Bench>, by: Vec2) {
    for (event, _) in [
        (Event::PointerMoved(EMPTY), ()),
        (press_at(EMPTY, true), ()),
        (Event::PointerMoved(EMPTY + by * 0.5), ()),
        (Event::PointerMoved(EMPTY + by), ()),
        (press_at(EMPTY + by, false), ()),
    ] {
        harness.event_modifiers(event, Modifiers::ALT);
        harness.step();
    }
    harness.run_steps(2);
}

fn press_at(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::ALT }
}

#[test]
fn the_wheel_zooms_at_the_pointer_and_a_trackpad_pans() {
    let mut harness = window(SCENE);
    let over = at(&harness, "node march");
    harness.hover_at(over);
    harness.step();
    let (before, zoom) = (harness.state().canvas.view.to_canvas(over), harness.state().canvas.view.zoom);
    let wheel =
        |unit, delta| Event::MouseWheel { unit, delta, phase: TouchPhase::Move, modifiers: Modifiers::NONE };
    harness.event(wheel(MouseWheelUnit::Line, vec2(0.0, 3.0)));
    harness.run_steps(20);
    let view = harness.state().canvas.view;
    assert!(view.zoom > 1.2 * zoom, "{} {zoom}", view.zoom);
    // Places near 1e3 in f32 after twenty small zooms.
    assert!((view.to_canvas(over) - before).length() < 1e-2);
    harness.event(wheel(MouseWheelUnit::Point, vec2(10.0, 25.0)));
    harness.run_steps(20);
    assert_eq!(harness.state().canvas.view.zoom, view.zoom);
    assert!(harness.state().canvas.view.pan.y > view.pan.y);
}

#[test]
fn a_double_click_shows_a_node_and_renames_in_its_header() {
    let mut harness = window(SCENE);
    let body = rect(&harness, "node march").center();
    harness.hover_at(body);
    for _ in 0..2 {
        harness.event(press_plain(body, true));
        harness.event(press_plain(body, false));
        harness.step();
    }
    harness.run_steps(2);
    assert_eq!(harness.state().requests, [Request::Show("march".to_owned())]);
    let head = rect(&harness, "node march").left_top() + vec2(20.0, 8.0);
    harness.hover_at(head);
    // Away from the last double click in time.
    harness.run_steps(60);
    for _ in 0..2 {
        harness.event(press_plain(head, true));
        harness.event(press_plain(head, false));
        harness.step();
    }
    harness.run_steps(2);
    assert!(harness.state().canvas.name_field.is_some());
}

fn press_plain(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

#[test]
fn the_minimap_goes_there() {
    let mut harness = window(SCENE);
    assert!(harness.query_by_label("minimap").is_none(), "all is seen already");
    harness.state_mut().canvas.view.zoom = 2.0;
    harness.run_steps(2);
    let map = rect(&harness, "minimap");
    let before = harness.state().canvas.view.pan;
    drag(&mut harness, map.center(), map.center() + vec2(30.0, 10.0));
    let after = harness.state().canvas.view.pan;
    assert!(after != before);
    harness.state_mut().canvas.ask(super::super::Command::ToggleMinimap);
    harness.run_steps(2);
    assert!(harness.query_by_label("minimap").is_none());
}

#[test]
fn all_stays_in_view_until_the_view_is_changed() {
    let mut harness = window(SCENE);
    let seen = |harness: &Harness<Bench>, size: Vec2| {
        let screen = Rect::from_min_size(Pos2::ZERO, size);
        ["sun", "moon", "march"]
            .iter()
            .all(|name| screen.contains_rect(rect(harness, &format!("node {name}"))))
    };
    let small = vec2(600.0, 300.0);
    harness.set_size(small);
    harness.run_steps(2);
    assert!(seen(&harness, small));
    // A picture makes its node taller.
    let zoom = harness.state().canvas.view.zoom;
    let context = harness.ctx.clone();
    let picture = egui::ColorImage::filled([4, 4], egui::Color32::RED);
    let texture = context.load_texture("small", picture, egui::TextureOptions::LINEAR);
    harness.state_mut().thumbnails.insert("march".to_owned(), texture);
    harness.run_steps(2);
    assert!(seen(&harness, small) && harness.state().canvas.view.zoom < zoom);
    // What the user chose stays.
    harness.state_mut().canvas.view.zoom = 0.7;
    harness.run_steps(2);
    let view = harness.state().canvas.view;
    harness.set_size(vec2(1000.0, 700.0));
    harness.run_steps(2);
    assert_eq!(harness.state().canvas.view, view);
}

#[test]
fn a_node_is_brought_into_view() {
    let mut harness = window(super::groups::GROUPS);
    harness.state_mut().canvas.view.pan = vec2(-4000.0, 0.0);
    harness.run_steps(2);
    assert!(harness.query_by_label("node a").is_none());
    harness.state_mut().canvas.reveal("a");
    harness.run_steps(2);
    let screen = Rect::from_min_size(Pos2::ZERO, vec2(1000.0, 700.0));
    assert!(screen.contains_rect(rect(&harness, "node a")));
    harness.state_mut().canvas.reveal("group/y");
    harness.run_steps(2);
    assert!(screen.contains_rect(rect(&harness, "node y")));
    assert_eq!(harness.state().canvas.group(), "group");
}
