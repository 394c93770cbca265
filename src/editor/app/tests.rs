//! The window without a window: by AccessKit names.

mod gestures;
mod keys;
mod safety;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::*;
use crate::camera::Camera;

fn harness() -> Harness<'static, App> {
    harness_in(None)
}

fn harness_in(state: Option<PathBuf>) -> Harness<'static, App> {
    let adapter = AdapterChoice::Named("no such adapter".to_owned());
    let mut app = App::new(&egui::Context::default(), None, &adapter, state);
    (app.settings, app.settings_file) = (Settings::default(), None);
    let draw = |ui: &mut Ui, app: &mut App| eframe::App::ui(app, ui, &mut eframe::Frame::_new_kittest());
    Harness::builder().with_size([1280.0, 800.0]).build_ui_state(draw, app)
}

#[test]
fn a_preset_opens_as_an_unsaved_copy() {
    let mut harness = harness();
    harness.run_steps(3);
    harness.get_by_label("Preset cumulus").click();
    harness.run_steps(3);
    let app = harness.state();
    assert!(app.is_open && app.project.is_unsaved() && app.project.file().is_none());
    assert_eq!(app.document().nodes["medium"].params["g"], 0.85);
    // Wherever it is saved, its files are found.
    assert!(app.document().nodes["cloud"].params["path"].as_str().is_some_and(|path| path.starts_with('/')));
    // Leaving it asks.
    harness.get_by_label("File").click();
    harness.run_steps(2);
    harness.get_by_label_contains("Start page").click();
    harness.run_steps(2);
    harness.get_by_label("Cancel").click();
    harness.run_steps(2);
    assert!(harness.state().is_open);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::N);
    harness.run_steps(2);
    harness.get_by_label("Do not save").click();
    harness.run_steps(2);
    assert!(!harness.state().is_open);
}

/// As the window hands it in.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn a_dropped_volume_is_lit() {
    let mut harness = harness();
    harness.run_steps(2);
    let volume = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/steam.vdb");
    harness.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(volume.clone())));
    harness.run_steps(2);
    let document = harness.state().document();
    let node = |kind: &str| document.nodes.values().find(|node| node.type_id == kind).unwrap();
    assert_eq!(node("load_vdb").params["path"].as_str(), volume.to_str());
    // Density scale and camera are ordinary parameters.
    assert!(node("medium").params["density_scale"].as_f64().is_some_and(|scale| scale > 0.0));
    assert!(node("camera").params["look_at"].is_array());
    assert!(harness.state().is_open);
    // What cannot be opened says so, and leaves what is there.
    let nothing = PathBuf::from("/nowhere/nothing.vdb");
    let folder = tempfile::tempdir().unwrap();
    harness.state_mut().project.save_as(&folder.path().join("graph.json")).unwrap();
    harness.input_mut().dropped_files = vec![std::sync::Arc::new(Dropped(nothing))];
    harness.run_steps(2);
    assert!(harness.query_all_by_label_contains("/nowhere/nothing.vdb").next().is_some());
    assert!(harness.state().is_open);
}

#[test]
fn a_link_and_the_enter_key_lead_to_a_node() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset smoke").click();
    harness.run_steps(3);
    harness.get_by_label("node medium").click();
    harness.run_steps(3);
    harness.get_by_label("plume.volume").click();
    harness.run_steps(3);
    assert_eq!(harness.state().selection.active(), Some("plume"));
    assert!(harness.query_by_label("plume.path").is_some());
    harness.get_by_label("node sun").click();
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(3);
    assert!(harness.get_by_label("inspector of sun").is_focused());
}

#[test]
fn the_palette_finds_and_runs() {
    let mut harness = harness();
    harness.run_steps(3);
    harness.key_press_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::P);
    harness.run_steps(2);
    for letter in ["s", "m", "o", "k", "e"] {
        harness.event(egui::Event::Text(letter.to_owned()));
        harness.step();
    }
    harness.key_press(egui::Key::Enter);
    harness.run_steps(3);
    assert!(harness.state().is_open);
    assert!(
        harness.state().document().about.contains("smoke")
            || harness.state().document().nodes.contains_key("smoke")
    );
}

#[test]
fn a_drag_on_the_picture_is_one_step() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset fog_sphere").click();
    harness.run_steps(3);
    {
        // No adapter: a picture from elsewhere, as the worker would give it.
        let app = harness.state_mut();
        let source = app.look.as_ref().unwrap().source.node.clone();
        let image = crate::image::Image::new(16, 9, vec![0.5; 16 * 9 * 3]);
        let value = crate::graph::Value::new(crate::graph::PortType::Image, 0, image);
        app.pictures.insert(source, Picture { value, level: super::super::preview::Level::FULL });
    }
    harness.run_steps(2);
    let place = |harness: &Harness<App>| {
        let app = harness.state();
        look::camera(app.document(), app.look.as_ref().unwrap().camera.as_ref().unwrap()).unwrap()
    };
    let before = place(&harness);
    let at = harness.get_by_label("Picture").rect().center();
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    for n in 1..6 {
        harness.hover_at(at + egui::vec2(12.0 * n as f32, 4.0));
        harness.step();
    }
    harness.drop_at(at + egui::vec2(60.0, 4.0));
    harness.run_steps(2);
    let after = place(&harness);
    assert!(before.position.distance(after.position) > 0.01);
    // Numbers are written with seven digits.
    let distance = |camera: Camera| camera.position.distance(camera.look_at);
    assert!((distance(before) / distance(after) - 1.0).abs() < 1e-5);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    harness.run_steps(2);
    assert_eq!(place(&harness), before);
    assert!(!harness.state().project.can_undo());
}

#[test]
fn shortcuts_and_themes() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.key_press(egui::Key::Questionmark);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Double-click a node").is_some());
    let context = harness.ctx.clone();
    harness.state_mut().perform(&context, Action::Light);
    harness.run_steps(2);
    assert!(!harness.ctx.global_style().visuals.dark_mode);
}

#[test]
fn an_end_that_nobody_asked_for_keeps_what_is_not_saved() {
    let state = tempfile::tempdir().unwrap();
    let found = || crate::editor::project::recoverable(state.path()).len();
    let mut harness = harness_in(Some(state.path().to_owned()));
    harness.run_steps(3);
    harness.get_by_label("Preset smoke").click();
    harness.run_steps(3);
    harness.state_mut().project.edit("say", |document| document.about = "mine".to_owned());
    harness.run_steps(2);
    harness.state_mut().end();
    drop(harness);
    // Written by a thread of its own.
    let start = std::time::Instant::now();
    while found() == 0 && start.elapsed().as_secs() < 10 {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert_eq!(found(), 1);
}

/// A window on a graph of a folder.
fn opened(text: &str, folder: &Path) -> Harness<'static, App> {
    let file = folder.join("graph.json");
    std::fs::write(&file, text).unwrap();
    let mut harness = harness();
    harness.run_steps(2);
    harness.state_mut().show(Project::load(&file).unwrap());
    harness.run_steps(2);
    harness
}

#[test]
fn without_a_device_the_graph_is_kept_and_it_is_tried_again() {
    let mut harness = harness();
    harness.run_steps(2);
    harness.get_by_label("Preset smoke").click();
    // It tries once by itself, and then asks.
    let wait = |harness: &mut Harness<App>| {
        harness.run_steps(3);
        let start = std::time::Instant::now();
        while harness.query_by_label("Try again").is_none() {
            assert!(start.elapsed().as_secs() < 60, "it does not ask");
            std::thread::sleep(std::time::Duration::from_millis(20));
            harness.run_steps(2);
        }
    };
    wait(&mut harness);
    assert!(harness.query_by_label_contains("no such adapter").is_some());
    assert!(harness.state().is_open && harness.state().document().nodes.contains_key("medium"));
    // The graph can be changed meanwhile.
    harness.state_mut().project.edit("say", |document| document.about = "mine".to_owned());
    wait(&mut harness);
    let before = harness.state().asked.as_ref().map(|asked| asked.number());
    // The answer to the edit may take the button away again before it is clicked.
    while harness.state().asked.as_ref().map(|asked| asked.number()) == before {
        wait(&mut harness);
        harness.get_by_label("Try again").click();
        harness.run_steps(3);
    }
    assert_eq!(harness.state().document().about, "mine");
}

#[test]
fn a_window_whose_device_is_lost_leaves_its_graph_to_the_next() {
    let state = tempfile::tempdir().unwrap();
    let mut harness = harness_in(Some(state.path().to_owned()));
    let (faults, place) = (crate::gpu::Faults::default(), crate::editor::window::Place::default());
    harness.state_mut().watch(faults.clone(), place.clone());
    harness.run_steps(2);
    harness.get_by_label("Preset smoke").click();
    harness.run_steps(3);
    harness.state_mut().project.edit("say", |document| document.about = "mine".to_owned());
    harness.run_steps(2);
    assert!(!harness.state().files.is_closing());
    faults.lose("it was unplugged");
    harness.run_steps(2);
    // No question: nothing is given up.
    assert!(harness.state().files.is_closing() && harness.query_by_label("Do not save").is_none());
    harness.state_mut().end();
    drop(harness);
    assert!(crate::editor::project::recoverable(state.path()).is_empty());
    let left = place.take().unwrap();
    let mut project = left.project.unwrap();
    assert_eq!((project.document().about.as_str(), project.is_unsaved()), ("mine", true));
    assert_eq!(project.undo().as_deref(), Some("say"));
    project.redo();
    // The next one has it and says why.
    let adapter = AdapterChoice::Named("no such adapter".to_owned());
    let mut next = App::new(&egui::Context::default(), Some(project), &adapter, None);
    next.tell_lost(&left.why.unwrap());
    let draw = |ui: &mut Ui, app: &mut App| eframe::App::ui(app, ui, &mut eframe::Frame::_new_kittest());
    let mut harness = Harness::builder().with_size([1280.0, 800.0]).build_ui_state(draw, next);
    harness.run_steps(3);
    assert!(harness.query_by_label_contains("it was unplugged").is_some());
    assert!(harness.state().is_open && harness.state().project.can_undo());
    // Where there is no next one it is written down.
    let said = crate::editor::project::Autosave::write_down(
        &harness.state().project,
        Some(state.path().to_owned()),
        None,
    );
    assert!(said.contains("next start"), "{said}");
    assert_eq!(crate::editor::project::recoverable(state.path())[0].document.about, "mine");
}

/// Three frames, of which the medium is made in a group.
const SEQUENCE: &str = r#"{"tyndall": 1, "nodes": {
    "files": {"type": "group", "nodes": {"steam": {"type": "load_vdb", "path": "steam_#.vdb"}}, "wires": [],
        "outputs": {"volume": "steam.volume"}},
    "medium": {"type": "medium"}, "camera": {"type": "camera"}, "march": {"type": "raymarch"}
}, "wires": ["files.volume -> medium.volume", "medium.medium -> march.medium", "camera.camera -> march.camera"]}"#;

fn sequence() -> (tempfile::TempDir, Harness<'static, App>) {
    let folder = tempfile::tempdir().unwrap();
    for number in 1..=3 {
        std::fs::write(folder.path().join(format!("steam_{number}.vdb")), "").unwrap();
    }
    let harness = opened(SEQUENCE, folder.path());
    (folder, harness)
}

fn failed(name: &str, message: &str) -> crate::graph::Event {
    crate::graph::Event::Failed { name: name.to_owned(), message: message.to_owned() }
}

#[test]
fn frames_of_files_in_groups_are_on_the_timeline() {
    let (_folder, harness) = sequence();
    assert_eq!(harness.state().player.range, [1, 3]);
    assert!(harness.query_by_label("Timeline").is_some());
    assert_eq!(harness.state().document().frame, Some(1));
    assert!(!harness.state().project.is_unsaved());
}

#[test]
fn a_broken_frame_is_told_marked_and_passed_over() {
    let (folder, mut harness) = sequence();
    // Of a request for the second frame, while the first is looked at; the file is damaged where the medium
    // decodes its grid.
    harness.state_mut().note(failed("medium", "the grid ends in its middle"), false, Some(2));
    let broken = |harness: &Harness<App>| harness.state().player.broken.keys().copied().collect::<Vec<_>>();
    assert_eq!(broken(&harness), [2]);
    // What does not read the file, what is not in the way of the picture, and a full device are no frame's fault.
    for (name, message) in [("camera", "no"), ("march", crate::gpu::OUT_OF_MEMORY)] {
        harness.state_mut().note(failed(name, message), false, Some(3));
    }
    assert_eq!(broken(&harness), [2]);
    harness.run_steps(2);
    assert!(harness.query_by_label("Frame 2 failed").is_none());
    let asked = |harness: &Harness<App>| harness.state().asked.as_ref().unwrap().frame();
    assert_eq!(asked(&harness), Some(1));
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::ArrowRight);
    harness.run_steps(3);
    assert!(harness.query_by_label("Frame 2 failed").is_some());
    assert!(harness.query_by_label("medium: the grid ends in its middle").is_some());
    assert_eq!(asked(&harness), Some(1));
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::ArrowRight);
    harness.run_steps(3);
    assert_eq!(asked(&harness), Some(3));
    assert!(harness.query_by_label("Frame 2 failed").is_none());
    // An edit that has nothing to do with it leaves the mark, one of what failed takes it away.
    let edit = |harness: &mut Harness<App>, node: &str, param: &str| {
        let (node, param) = (node.to_owned(), param.to_owned());
        harness.state_mut().project.edit("change", move |document| {
            document.nodes.get_mut(&node).unwrap().params.insert(param, 2.into());
        });
        harness.run_steps(3);
    };
    edit(&mut harness, "march", "step");
    assert_eq!(broken(&harness), [2]);
    edit(&mut harness, "medium", "density_scale");
    assert_eq!(broken(&harness), [] as [i64; 0]);
    // Nor does it stay when the file is another.
    harness.state_mut().note(failed("medium", "the grid ends in its middle"), false, Some(2));
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::ArrowLeft);
    harness.run_steps(3);
    assert!(asked(&harness) == Some(3) && broken(&harness) == [2]);
    std::fs::write(folder.path().join("steam_2.vdb"), "mended").unwrap();
    harness.run_steps(2);
    assert!(asked(&harness) == Some(2) && broken(&harness) == [] as [i64; 0]);
    // It is tried again where that is asked for.
    harness.state_mut().note(failed("medium", "the grid ends in its middle"), false, Some(2));
    let context = harness.ctx.clone();
    harness.state_mut().perform(&context, Action::Retry);
    harness.run_steps(2);
    assert_eq!(broken(&harness), [] as [i64; 0]);
}

#[test]
fn a_frame_that_failed_is_asked_for_again_where_its_file_is_mended() {
    let (folder, mut harness) = sequence();
    harness.run_steps(2);
    harness.state_mut().note(failed("medium", "the grid ends in its middle"), false, Some(1));
    harness.run_steps(2);
    let asked = |harness: &Harness<App>| {
        let asked = harness.state().asked.as_ref().unwrap();
        (asked.frame(), asked.number(), harness.state().player.broken.contains_key(&1))
    };
    let (_, before, _) = asked(&harness);
    assert_eq!(asked(&harness), (Some(1), before, true));
    // The window looks at the file again without being touched.
    let delay = harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert!(delay <= std::time::Duration::from_secs(1), "{delay:?}");
    std::fs::write(folder.path().join("steam_1.vdb"), "mended").unwrap();
    harness.run_steps(3);
    // Once.
    assert_eq!(asked(&harness), (Some(1), before + 1, false));
}

#[test]
fn groups_are_dissolved_where_the_graph_changes_alone() {
    let (_folder, mut harness) = sequence();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Num3);
    harness.run_steps(3);
    let flat = harness.state_mut().flat();
    assert!(flat.nodes.contains_key("files/steam"));
    harness.run_steps(3);
    assert!(Rc::ptr_eq(&flat, &harness.state_mut().flat()));
    // Another frame, and another graph.
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::ArrowRight);
    harness.run_steps(2);
    assert_eq!(harness.state_mut().flat().frame, Some(2));
    harness.state_mut().project.edit("say", |document| document.about = "mine".to_owned());
    assert_eq!(harness.state_mut().flat().about, "mine");
}

#[test]
fn a_slice_plane_is_asked_for_and_is_not_in_the_graph() {
    let (_folder, mut harness) = sequence();
    let before = harness.state().document().clone();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Num3);
    harness.run_steps(3);
    assert!(harness.query_by_label("Slice field").is_some());
    let number = harness.state().asked.as_ref().unwrap().number();
    let asked = |harness: &Harness<App>| harness.state().asked.as_ref().unwrap().slice().cloned();
    assert_eq!(asked(&harness).unwrap().1.to_string(), "medium.medium -> slice plane.medium");
    harness.get_by_label("Slice across x").click();
    harness.run_steps(3);
    assert!(harness.state().asked.as_ref().unwrap().number() > number);
    assert_eq!(asked(&harness).unwrap().0.params["axis"], "x");
    assert_eq!(harness.state().document(), &before);
    assert!(!harness.state().project.is_unsaved() && !harness.state().project.can_undo());
    assert!(!harness.state().statuses.contains_key(crate::editor::viewport::SLICE));
    // What it says of itself is its own.
    harness.state_mut().note(failed(crate::editor::viewport::SLICE, "no such grid"), true, Some(1));
    harness.run_steps(2);
    assert!(!harness.state().statuses.contains_key(crate::editor::viewport::SLICE));
}
