//! Every gesture that changes the graph is one step of undo, and one of redo.

use egui::vec2;

use super::groups::{GROUPS, double_click};
use super::wiring::TONES;
use super::*;

type Gesture = fn(&mut Harness<Bench>);

fn enter(harness: &mut Harness<Bench>, text: &str) {
    harness.event(Event::Text(text.to_owned()));
    harness.run_steps(2);
    press(harness, Modifiers::NONE, Key::Enter);
}

fn open_group(harness: &mut Harness<Bench>) {
    harness.state_mut().canvas.reveal("group/x");
    harness.run_steps(2);
}

const ON_SCENE: &[(&str, Gesture)] = &[
    ("connect", |harness| drag_labels(harness, "output moon.light", "input split.lights")),
    ("unplug", |harness| {
        let from = at(harness, "input split.lights");
        drag(harness, from, EMPTY);
    }),
    ("add", |harness| {
        press(harness, Modifiers::NONE, Key::Tab);
        enter(harness, "sun");
    }),
    ("drop a wire and add", |harness| {
        let from = at(harness, "output moon.light");
        drag(harness, from, EMPTY);
        enter(harness, "split");
    }),
    ("move", |harness| {
        let from = rect(harness, "node camera").center_top() + vec2(0.0, 8.0);
        drag(harness, from, from + vec2(30.0, 20.0));
    }),
    ("delete", |harness| {
        click(harness, "node sun");
        press(harness, Modifiers::NONE, Key::Delete);
    }),
    ("cut", |harness| {
        click(harness, "node sun");
        harness.event(Event::Cut);
        harness.run_steps(2);
    }),
    ("paste", |harness| {
        let text = harness.state().project.document().copy(&["sun".to_owned(), "split".to_owned()]);
        harness.event(Event::Paste(text));
        harness.run_steps(2);
    }),
    ("duplicate", |harness| {
        click(harness, "node sun");
        press(harness, Modifiers::COMMAND, Key::D);
    }),
    ("rename", |harness| {
        click(harness, "node sun");
        press(harness, Modifiers::NONE, Key::F2);
        enter(harness, "dawn");
    }),
    ("mute", |harness| {
        click(harness, "node sun");
        press(harness, Modifiers::NONE, Key::M);
    }),
    ("bypass", |harness| {
        click(harness, "node sun");
        press(harness, Modifiers::NONE, Key::B);
    }),
    ("group", |harness| {
        click(harness, "node sun");
        press(harness, Modifiers::COMMAND, Key::G);
    }),
    ("arrange", |harness| press(harness, Modifiers::NONE, Key::L)),
    ("frame", |harness| {
        click(harness, "node sun");
        press(harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::F);
        press(harness, Modifiers::NONE, Key::Enter);
    }),
    ("bend", |harness| {
        let middle = at(harness, "wire sun.light -> split.lights");
        double_click(harness, middle);
    }),
];

const ON_GROUPS: &[(&str, Gesture)] = &[
    ("ungroup", |harness| {
        click(harness, "node group");
        press(harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::G);
    }),
    ("move a frame", |harness| {
        let title = rect(harness, "frame tones").left_center() + vec2(20.0, 0.0);
        drag(harness, title, title + vec2(0.0, 30.0));
    }),
    ("resize a frame", |harness| {
        let corner = at(harness, "size of frame tones");
        drag(harness, corner, corner + vec2(30.0, 20.0));
    }),
    ("remove a frame", |harness| {
        click(harness, "frame tones");
        press(harness, Modifiers::NONE, Key::Delete);
    }),
    ("title a frame", |harness| {
        let title = rect(harness, "frame tones").left_center() + vec2(20.0, 0.0);
        double_click(harness, title);
        enter(harness, "curves");
    }),
    ("move a bend", |harness| {
        let from = at(harness, "bend 1 of wire a.image -> b.image");
        drag(harness, from, from + vec2(0.0, -20.0));
    }),
    ("remove a bend", |harness| {
        click(harness, "bend 1 of wire a.image -> b.image");
        press(harness, Modifiers::NONE, Key::Delete);
    }),
    ("expose a port", |harness| {
        open_group(harness);
        drag_labels(harness, "output x.image", "new group output");
    }),
    ("remove a port", |harness| {
        open_group(harness);
        let from = at(harness, "input x.image");
        drag(harness, from, EMPTY);
    }),
    ("rename a port", |harness| {
        harness.get_by_label("input group.image").click_secondary();
        harness.run_steps(3);
        click(harness, "Rename");
        enter(harness, "light");
    }),
    ("move in a group", |harness| {
        open_group(harness);
        let from = rect(harness, "node x").center_top() + vec2(0.0, 8.0);
        drag(harness, from, from + vec2(30.0, 20.0));
    }),
];

const ON_TONES: &[(&str, Gesture)] = &[("drop on a wire", |harness| {
    let from = rect(harness, "node c").center_top() + vec2(0.0, 8.0);
    let up = at(harness, "wire a.image -> b.image") - rect(harness, "node c").center();
    drag(harness, from, from + up);
})];

#[test]
fn every_gesture_is_one_step() {
    for (text, gestures) in [(SCENE, ON_SCENE), (GROUPS, ON_GROUPS), (TONES, ON_TONES)] {
        for (name, gesture) in gestures {
            let mut harness = window(text);
            let before = harness.state().project.document().clone();
            gesture(&mut harness);
            let after = harness.state().project.document().clone();
            assert_ne!(before, after, "{name} changes nothing");
            // By key, as the user does it.
            harness.hover_at(EMPTY);
            harness.run_steps(2);
            undo(&mut harness);
            assert_eq!(*harness.state().project.document(), before, "{name} is not taken back");
            assert!(!harness.state().project.can_undo(), "{name} is more than one step");
            press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
            assert_eq!(*harness.state().project.document(), after, "{name} is not done again");
        }
    }
}
