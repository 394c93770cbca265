//! What is done by keys alone, and what stands over the window: palette, pages, dialogs, toasts.

use egui::{Key, Modifiers};

use super::*;

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

fn on_smoke() -> Harness<'static, App> {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset smoke").click();
    harness.run_steps(3);
    harness
}

fn press(harness: &mut Harness<App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

#[test]
fn what_stands_over_the_window_has_its_keys_to_itself() {
    let mut harness = on_smoke();
    harness.get_by_label("node medium").click();
    harness.run_steps(2);
    assert_eq!(harness.state().selection.active(), Some("medium"));
    for (modifiers, key, label) in
        [(COMMAND_SHIFT, Key::P, "Command"), (Modifiers::NONE, Key::Questionmark, "Double-click a node")]
    {
        press(&mut harness, modifiers, key);
        assert!(harness.query_by_label(label).is_some(), "{label}");
        press(&mut harness, Modifiers::NONE, Key::Escape);
        assert!(harness.query_by_label(label).is_none(), "{label}");
        // Escape was not the canvas' too, which gives up its selection at it.
        assert_eq!(harness.state().selection.active(), Some("medium"));
    }
    // Nor are the letters of commands, while the page is read and the pointer rests on the canvas beside it.
    harness.hover_at(egui::pos2(20.0, 760.0));
    press(&mut harness, Modifiers::NONE, Key::Questionmark);
    press(&mut harness, Modifiers::NONE, Key::M);
    assert!(!harness.state().document().nodes["medium"].mute);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    press(&mut harness, Modifiers::NONE, Key::M);
    assert!(harness.state().document().nodes["medium"].mute);
}

#[test]
fn the_page_of_shortcuts_stands_still_and_fits() {
    for size in [[1280.0, 800.0], [640.0, 400.0]] {
        let mut harness = on_smoke();
        harness.set_size(size.into());
        harness.run_steps(2);
        harness.key_press(Key::Questionmark);
        harness.step();
        harness.step();
        let place = |harness: &Harness<App>| harness.get_by_label("Drag on the picture").rect();
        let first = harness.query_by_label("Drag on the picture").map(|node| node.rect());
        harness.run_steps(3);
        // A window that is new is measured once, unseen.
        assert_eq!(first, Some(place(&harness)), "{size:?}");
        assert!(place(&harness).right() < size[0], "{size:?}");
        // Where there is room all lines are seen: they stand around the window's middle, below a title and a heading of
        // some 20 points more than half of which they are lower. A page that scrolls has its last lines 30 lower still.
        let last = harness.get_by_label("Walk the nodes, inspect one").rect();
        let middle = 0.5 * (place(&harness).center().y + last.center().y);
        assert!(size[1] < 800.0 || (middle - 400.0).abs() < 35.0, "{middle}");
    }
}

#[test]
fn the_mark_of_the_palette_stays_in_sight() {
    let mut harness = on_smoke();
    press(&mut harness, COMMAND_SHIFT, Key::P);
    let first = harness.get_by_label_contains("Start page").rect();
    for _ in 0..24 {
        harness.key_press(Key::ArrowDown);
        harness.step();
    }
    harness.run_steps(30);
    // The list has moved up under it.
    let seen = harness.query_by_label_contains("Start page").map(|node| node.rect().top());
    assert!(seen.is_none_or(|top| top < first.top() - 100.0), "{seen:?}");
}

#[test]
fn keys_lead_from_canvas_to_inspector_and_scale_the_window() {
    let mut harness = on_smoke();
    press(&mut harness, Modifiers::NONE, Key::F6);
    assert!(harness.state().canvas.is_focused());
    // The node that has the keyboard is the one that Enter is about.
    let name = harness.state().selection.active().unwrap().to_owned();
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(harness.get_by_label(&format!("inspector of {name}")).is_focused());
    press(&mut harness, Modifiers::NONE, Key::F6);
    assert!(harness.state().canvas.is_focused());
    press(&mut harness, Modifiers::COMMAND, Key::Equals);
    press(&mut harness, Modifiers::COMMAND, Key::Equals);
    assert_eq!(harness.state().settings.scale, 1.2);
    press(&mut harness, Modifiers::COMMAND, Key::Minus);
    assert_eq!(harness.state().settings.scale, 1.1);
}

#[test]
fn dialogs_open_by_their_keys_and_close_by_escape() {
    let mut harness = on_smoke();
    for (modifiers, key, title) in [
        (Modifiers::COMMAND, Key::O, "Open a graph"),
        (COMMAND_SHIFT, Key::O, "Open a VDB"),
        (COMMAND_SHIFT, Key::S, "Save the graph"),
        // It has no file yet.
        (Modifiers::COMMAND, Key::S, "Save the graph"),
    ] {
        press(&mut harness, modifiers, key);
        assert!(harness.query_by_label(title).is_some(), "{title}");
        press(&mut harness, Modifiers::NONE, Key::Escape);
        harness.run_steps(3);
        assert!(harness.query_by_label(title).is_none() && !harness.state().files.is_asking(), "{title}");
    }
}

/// The dialog draws its field to search on black, whatever the theme: dark letters could not be read there.
#[test]
fn dialogs_of_the_light_theme_have_nothing_black() {
    let mut harness = on_smoke();
    for (action, has_search) in [(Action::Dark, true), (Action::Light, false)] {
        let context = harness.ctx.clone();
        harness.state_mut().perform(&context, action);
        press(&mut harness, Modifiers::COMMAND, Key::O);
        harness.run_steps(4);
        assert!(harness.query_by_label("Open a graph").is_some());
        assert_eq!(harness.query_by_label("🔍").is_some(), has_search);
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn the_time_of_a_picture_is_not_that_of_the_next_graph() {
    let mut harness = on_smoke();
    harness.state_mut().figures.picture_ms = Some(4200.0);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("4.2 s").is_some());
    harness.state_mut().show(Project::default());
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("4.2 s").is_none());
}

#[test]
fn what_cannot_be_framed_says_so_and_an_error_stays_until_it_is_dismissed() {
    let mut harness = on_smoke();
    press(&mut harness, Modifiers::COMMAND, Key::Num2);
    assert!(harness.query_by_label_contains("no volume has been computed yet").is_some());
    harness.state_mut().toasts.complain("the disk is full");
    harness.run_steps(400);
    assert!(harness.query_by_label_contains("no volume has been computed yet").is_none());
    assert!(harness.query_by_label("the disk is full").is_some());
    harness.get_by_label("×").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("the disk is full").is_none());
}
