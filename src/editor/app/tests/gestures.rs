//! Gestures across the window: files chosen in dialogs, borders dragged, pictures kept, the theme from its menu.

use egui::{Key, Modifiers, Pos2, Vec2, vec2};
use egui_kittest::kittest::NodeT;

use super::*;
use crate::editor::action::Action;
use crate::editor::canvas::Command;
use crate::editor::preview::Level;
use crate::editor::worker::Solved;
use crate::graph::{PortType, Value};
use crate::image::Image;

const GRAPH: &str = r#"{"tyndall": 1, "about": "of a file", "nodes": {"sun": {"type": "sun"}}}"#;

/// Chooses what a dialog offers by its name, and confirms it; the dialog reads its folder on a thread.
fn choose(harness: &mut Harness<App>, name: Option<&str>, button: &str) {
    for name in name.into_iter().chain([button]) {
        let click = |harness: &Harness<App>| {
            // With a sign before it; a toast says the whole path.
            let is_it = |label: String| label.ends_with(name) && !label.contains(std::path::MAIN_SEPARATOR);
            let mut found = harness.query_all_by_label_contains(name);
            let found = found.find(|node| node.accesskit_node().label().is_some_and(is_it));
            found.map(|node| node.click()).is_some()
        };
        let start = std::time::Instant::now();
        while !click(harness) {
            assert!(start.elapsed().as_secs() < 20, "'{name}' is not offered");
            std::thread::sleep(std::time::Duration::from_millis(10));
            harness.run_steps(2);
        }
        harness.run_steps(4);
    }
}

fn press(harness: &mut Harness<App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

fn drag(harness: &mut Harness<App>, from: Pos2, by: Vec2) {
    harness.hover_at(from);
    harness.run_steps(2);
    harness.drag_at(from);
    harness.step();
    for n in 1..=4 {
        harness.hover_at(from + by * (n as f32 / 4.0));
        harness.step();
    }
    harness.drop_at(from + by);
    harness.run_steps(3);
}

/// A window whose dialogs begin in a folder.
fn in_folder(folder: &Path) -> Harness<'static, App> {
    let mut harness = harness();
    harness.state_mut().settings.folder = Some(folder.to_owned());
    harness.run_steps(3);
    harness
}

#[test]
fn a_graph_and_a_volume_are_chosen_in_their_dialogs() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mine.json"), GRAPH).unwrap();
    let steam = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/steam.vdb");
    std::fs::copy(steam, folder.path().join("cloud.vdb")).unwrap();
    let mut harness = in_folder(folder.path());
    press(&mut harness, Modifiers::COMMAND, Key::O);
    choose(&mut harness, Some("mine.json"), "🗀  Open");
    assert_eq!(harness.state().document().about, "of a file");
    assert_eq!(harness.state().project.file(), Some(folder.path().join("mine.json").as_path()));
    assert!(!harness.state().files.is_asking());
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::O);
    choose(&mut harness, Some("cloud.vdb"), "🗀  Open");
    let loader = harness.state().document().nodes.values().find(|node| node.type_id == "load_vdb");
    assert!(loader.unwrap().params["path"].as_str().unwrap().ends_with("cloud.vdb"));
}

#[test]
fn a_graph_and_a_group_are_saved_where_the_dialog_says() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = in_folder(folder.path());
    harness.get_by_label("Preset smoke").click();
    harness.run_steps(3);
    press(&mut harness, Modifiers::COMMAND, Key::S);
    choose(&mut harness, None, "📥  Save");
    let file = folder.path().join("graph.json");
    assert!(!harness.state().project.is_unsaved() && harness.state().project.file() == Some(&file));
    assert!(Document::load(&file).unwrap().nodes.contains_key("medium"));
    // Dialogs begin at the graph from now on.
    harness.state_mut().settings.folder = None;
    assert_eq!(harness.state().folder().as_deref(), Some(folder.path()));
    // A group as a graph of its own, which leaves this one as it is.
    let names = ["medium".to_owned()];
    harness.state_mut().project.edit("group", |document| {
        document.make_group(&names, "look").unwrap();
        // Places that nobody chose.
        document.layout.clear();
    });
    harness.state_mut().ask_preset("look");
    harness.run_steps(3);
    choose(&mut harness, None, "📥  Save");
    let preset = Document::load(&folder.path().join("look.json")).unwrap();
    assert!(preset.nodes.contains_key("medium") && !preset.inputs.is_empty());
    assert!(harness.state().project.file() == Some(&file) && harness.state().project.is_unsaved());
    // And it comes back as a group of any graph, with its ports, in one step.
    let sun = harness.get_by_label("node sun").rect();
    harness.get_by_label("Node").click();
    harness.run_steps(2);
    harness.get_by_label_contains("Insert a graph as a group").click();
    harness.run_steps(3);
    choose(&mut harness, Some("look.json"), "🗀  Open");
    assert_eq!(harness.state().selection.active(), Some("look_2"));
    let document = harness.state().document();
    assert_eq!(document.inside("look_2").unwrap().inputs, preset.inputs);
    // What was there stays where it stood.
    assert!(harness.query_by_label("node look_2").is_some());
    assert_eq!(harness.get_by_label("node sun").rect(), sun);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(!harness.state().document().nodes.contains_key("look_2"));
}

#[test]
fn panels_are_as_large_as_their_borders_are_dragged() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset smoke").click();
    harness.run_steps(3);
    let picture = |harness: &Harness<App>| harness.get_by_label("Picture").rect();
    let before = picture(&harness);
    let width = harness.state().settings.inspector_width;
    // Six points of margin between the picture and its neighbors.
    drag(&mut harness, Pos2::new(before.right() + 6.0, 300.0), vec2(-80.0, 0.0));
    let wider = harness.state().settings.inspector_width;
    assert!((wider - width - 80.0).abs() < 3.0, "{width} {wider}");
    assert!((before.right() - picture(&harness).right() - 80.0).abs() < 3.0);
    assert_eq!(harness.state().settings.canvas_height, None);
    let border = Pos2::new(400.0, before.bottom() + 6.0);
    drag(&mut harness, border, vec2(0.0, -90.0));
    assert!((before.bottom() - picture(&harness).bottom() - 90.0).abs() < 3.0);
    let usual = (0.4_f32 * 800.0).round();
    let height = harness.state().settings.canvas_height.unwrap();
    assert!((height - usual - 90.0).abs() < 3.0, "{height}");
}

#[test]
fn pictures_are_stored_by_key_and_compared() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset fog_sphere").click();
    harness.run_steps(3);
    let source = harness.state().look.as_ref().unwrap().source.node.clone();
    let image = Image::new(16, 9, vec![0.5; 16 * 9 * 3]);
    let value = Value::new(PortType::Image, 0, image);
    harness.state_mut().pictures.insert(source, Picture { value, level: Level::FULL });
    harness.run_steps(2);
    for (key, name, other) in [(Key::F1, "stored A", "stored B"), (Key::F2, "stored B", "stored A")] {
        assert!(harness.query_by_label(name).is_none());
        press(&mut harness, Modifiers::COMMAND, key);
        assert!(harness.query_by_label(name).is_some() && harness.query_by_label(other).is_none());
    }
}

#[test]
fn the_theme_is_chosen_from_its_menu() {
    let mut harness = harness();
    harness.run_steps(2);
    for (name, is_dark) in [("Light theme", false), ("Dark theme", true)] {
        harness.get_by_label("View").click();
        harness.run_steps(2);
        harness.get_by_label_contains(name).click();
        harness.run_steps(3);
        assert_eq!(harness.ctx.global_style().visuals.dark_mode, is_dark);
    }
    assert_eq!(harness.state().settings.theme, ThemeChoice::Dark);
}

#[test]
fn menus_mark_what_is_on() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset smoke").click();
    harness.run_steps(3);
    let marked = |harness: &mut Harness<App>| {
        harness.get_by_label("View").click();
        harness.run_steps(2);
        let names =
            ["Snap to the grid", "Minimap", "Slice plane", "Histogram Ctrl", "Dark theme", "Light theme"];
        let is_on = |name: &&str| {
            let node = harness.get_by_label_contains(name);
            node.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
        };
        let on: Vec<&str> = names.into_iter().filter(is_on).collect();
        press(harness, Modifiers::NONE, Key::Escape);
        on
    };
    assert_eq!(marked(&mut harness), ["Minimap", "Dark theme"]);
    let context = harness.ctx.clone();
    for action in [
        Action::Canvas(Command::ToggleSnap),
        Action::Canvas(Command::ToggleMinimap),
        Action::Slice,
        Action::Histogram,
        Action::Light,
    ] {
        harness.state_mut().perform(&context, action);
    }
    harness.run_steps(3);
    assert_eq!(marked(&mut harness), ["Snap to the grid", "Slice plane", "Histogram Ctrl", "Light theme"]);
}

#[test]
fn what_a_transfer_function_shows_is_framed() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset explore").click();
    harness.run_steps(3);
    let context = harness.ctx.clone();
    let camera = |harness: &Harness<App>| look::camera(harness.state().document(), "camera").unwrap();
    let before = camera(&harness);
    // As the worker answers: a box around the origin and what shows it.
    let dense = crate::volume::Dense::centered([20, 10, 10], 0.1);
    let volume = crate::volume::Volume::from_shape(dense, None, glam::DMat4::IDENTITY);
    let volume = Value::measured(PortType::Volume, volume, crate::volume::Volume::bytes);
    let image = Value::new(PortType::Image, 0, Image::new(16, 9, vec![0.5; 16 * 9 * 3]));
    let values = vec![("plume".to_owned(), "volume", volume), ("look".to_owned(), "image", image)];
    let (costs, wall_ms, cache_bytes, gpu_bytes) = (Vec::new(), 1.0, 0, 0);
    let solved = Solved { level: Level::FULL, frame: None, values, costs, wall_ms, cache_bytes, gpu_bytes };
    harness.state_mut().take(&context, solved, 1);
    harness.run_steps(2);
    harness.get_by_label("Frame").click();
    harness.run_steps(2);
    assert_ne!(camera(&harness), before);
    assert!(camera(&harness).look_at.length() < 1e-9);
    assert_eq!(harness.state_mut().project.undo().as_deref(), Some("frame the volume"));
}

#[test]
fn a_slice_is_framed_as_a_picture() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset explore").click();
    harness.run_steps(3);
    harness.state_mut().chosen = Some("slice".to_owned());
    harness.run_steps(2);
    let context = harness.ctx.clone();
    harness.state_mut().perform(&context, Action::ActualSize);
    harness.run_steps(2);
    harness.get_by_label("Frame").click();
    harness.run_steps(2);
    assert!(harness.state().viewport.is_fitted() && !harness.state().project.can_undo());
}

#[test]
fn a_menu_that_is_higher_than_the_window_is_scrolled() {
    let mut harness = harness();
    harness.set_size(vec2(1000.0, 420.0));
    harness.run_steps(2);
    harness.get_by_label("View").click();
    harness.run_steps(3);
    let first = harness.get_by_label_contains("Command palette").rect();
    harness.hover_at(first.center());
    harness.run_steps(2);
    let (unit, phase, modifiers) = (egui::MouseWheelUnit::Point, egui::TouchPhase::Move, Modifiers::NONE);
    harness.event(egui::Event::MouseWheel { unit, delta: vec2(0.0, -2000.0), phase, modifiers });
    harness.run_steps(60);
    let last = harness.get_by_label_contains("System theme");
    assert!(last.rect().bottom() < 420.0, "{:?}", last.rect());
    last.click();
    harness.run_steps(3);
    assert_eq!(harness.state().settings.theme, ThemeChoice::System);
}
