//! Recent graphs, what is offered after a kill, and the way back to what was saved.

use super::*;

/// A graph in a folder, with the program's own folder beside it.
fn saved() -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mist.json");
    std::fs::write(&file, r#"{"tyndall": 1, "about": "saved", "nodes": {"sun": {"type": "sun"}}}"#).unwrap();
    let state = folder.path().join("state");
    (folder, file, state)
}

fn say(app: &mut App, text: &str) {
    app.project.edit("say", |document| document.about = text.to_owned());
}

/// A window that was killed with changes in `file`; the next one.
fn after_a_kill(file: &Path, state: &Path) -> Harness<'static, App> {
    let mut killed = harness_in(Some(state.to_owned()));
    killed.run_steps(2);
    killed.state_mut().open(file);
    say(killed.state_mut(), "mine");
    killed.run_steps(3);
    drop(killed);
    let start = std::time::Instant::now();
    // Written by a thread of its own.
    while crate::editor::project::recoverable(state).is_empty() {
        assert!(start.elapsed().as_secs() < 10, "nothing was written down");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let mut next = harness_in(Some(state.to_owned()));
    next.run_steps(3);
    next
}

#[test]
fn what_a_kill_left_is_offered_and_recovered() {
    let (_folder, file, state) = saved();
    let mut harness = after_a_kill(&file, &state);
    assert!(harness.query_by_label_contains("mist.json that were not saved").is_some());
    harness.get_by_label("Recover").click();
    harness.run_steps(3);
    assert!(harness.state().is_open && harness.state().project.is_unsaved());
    assert_eq!(harness.state().document().about, "mine");
    assert_eq!(harness.state().project.file(), Some(file.as_path()));
    assert!(harness.query_by_label("Recover").is_none());
}

#[test]
fn what_a_kill_left_is_discarded() {
    let (_folder, file, state) = saved();
    let mut harness = after_a_kill(&file, &state);
    harness.get_by_label("Discard").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("Discard").is_none() && !harness.state().is_open);
    assert!(crate::editor::project::recoverable(&state).is_empty());
    assert!(std::fs::read_to_string(&file).unwrap().contains("saved"));
}

#[test]
fn recent_graphs_open_from_the_start_page() {
    let (folder, file, _) = saved();
    let mut harness = harness();
    harness.state_mut().settings.recent = vec![file.clone()];
    let settings = folder.path().join("settings.json");
    harness.state_mut().settings_file = Some(settings.clone());
    harness.run_steps(3);
    harness.get_by_label("mist.json").click();
    harness.run_steps(3);
    assert!(harness.state().is_open && harness.state().project.file() == Some(file.as_path()));
    // Kept at once, not only at an end that a kill passes over.
    assert_eq!(Settings::load(Some(&settings)).recent, harness.state().settings.recent);
    assert!(settings.exists());
}

#[test]
fn graphs_and_folders_are_dropped_too() {
    let (folder, file, _) = saved();
    let mut harness = harness();
    harness.run_steps(2);
    harness.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(file.clone())));
    harness.run_steps(2);
    assert_eq!(harness.state().document().about, "saved");
    let steam = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/steam.vdb");
    let frames = folder.path().join("frames");
    std::fs::create_dir(&frames).unwrap();
    for number in 1..=3 {
        std::fs::copy(&steam, frames.join(format!("steam_{number:04}.vdb"))).unwrap();
    }
    harness.input_mut().dropped_files = vec![std::sync::Arc::new(Dropped(frames))];
    harness.run_steps(3);
    assert!(harness.state().document().nodes.values().any(|node| node.type_id == "load_vdb"));
    assert_eq!(harness.state().player.range, [1, 3]);
    assert!(harness.query_by_label("Timeline").is_some());
}

#[test]
fn the_way_back_to_the_file_and_to_its_versions() {
    let (_folder, file, state) = saved();
    let before = std::time::SystemTime::now() - std::time::Duration::from_secs(200_000);
    std::fs::File::options().write(true).open(&file).unwrap().set_modified(before).unwrap();
    let mut harness = harness_in(Some(state));
    harness.run_steps(2);
    harness.state_mut().open(&file);
    harness.run_steps(2);
    for text in ["first", "second"] {
        say(harness.state_mut(), text);
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
        harness.run_steps(2);
    }
    say(harness.state_mut(), "third");
    let context = harness.ctx.clone();
    harness.state_mut().perform(&context, Action::Revert);
    harness.run_steps(2);
    assert!(harness.state().document().about == "second" && !harness.state().project.is_unsaved());
    harness.state_mut().perform(&context, Action::Versions);
    harness.run_steps(3);
    // The file as it was found, and both that were saved.
    for number in 1..=3 {
        assert!(harness.query_by_label(&format!("Restore version {number}")).is_some());
    }
    for told in ["1. written 2 days ago", "3. written just now"] {
        assert!(harness.query_by_label(told).is_some(), "{told}");
    }
    harness.get_by_label("Restore version 2").click();
    harness.run_steps(3);
    assert_eq!(harness.state().document().about, "first");
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    harness.run_steps(2);
    assert_eq!(harness.state().document().about, "second");
}

#[test]
fn what_is_written_down_goes_with_the_graph_where_the_device_is_lost() {
    let (_folder, file, state) = saved();
    let found = || crate::editor::project::recoverable(&state);
    let mut lost = harness_in(Some(state.clone()));
    let (faults, place) = (crate::gpu::Faults::default(), crate::editor::window::Place::default());
    lost.state_mut().watch(faults.clone(), place.clone());
    lost.run_steps(2);
    lost.state_mut().open(&file);
    say(lost.state_mut(), "mine");
    lost.run_steps(3);
    faults.lose("it was unplugged");
    lost.run_steps(2);
    lost.state_mut().end();
    drop(lost);
    let left = place.take().unwrap();
    // The next window is not offered what it has.
    let mut next = harness_in(Some(state.clone()));
    next.run_steps(2);
    assert!(next.query_by_label("Recover").is_none());
    next.state_mut().show(left.project.unwrap());
    next.state_mut().go_on_with(left.autosave);
    let written = || std::fs::read_dir(state.join("recovery")).unwrap().flatten();
    let records = || written().filter(|entry| entry.path().extension().is_some_and(|end| end == "json"));
    say(next.state_mut(), "mine still");
    // At the most every three seconds.
    let start = std::time::Instant::now();
    while !records()
        .any(|entry| std::fs::read_to_string(entry.path()).is_ok_and(|text| text.contains("still")))
    {
        assert!(start.elapsed().as_secs() < 60, "nothing was written down");
        std::thread::sleep(std::time::Duration::from_millis(50));
        next.run_steps(1);
    }
    // In the place of what the lost window wrote, and once.
    assert_eq!(records().count(), 1);
    drop(next);
    assert_eq!(found()[0].document.about, "mine still");
}
