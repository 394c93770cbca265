use std::time::{Duration, Instant};

use super::autosave::EVERY;
use super::*;

fn say(text: &'static str) -> impl FnOnce(&mut Document) {
    move |document| document.about = text.to_owned()
}

#[test]
fn a_gesture_is_one_step() {
    let mut project = Project::default();
    project.edit("first", say("a"));
    for text in ["b", "c", "d"] {
        project.edit_during(egui::Id::new("drag"), "drag", say(text));
    }
    project.edit("nothing", say("d"));
    assert_eq!(project.undo().as_deref(), Some("drag"));
    assert_eq!(project.document().about, "a");
    assert_eq!(project.redo().as_deref(), Some("drag"));
    assert_eq!(project.document().about, "d");
    project.undo();
    project.edit("other", say("e"));
    assert_eq!(project.redo(), None);
    assert_eq!((project.undo().as_deref(), project.undo().as_deref()), (Some("other"), Some("first")));
    assert_eq!(project.undo(), None);
    assert_eq!(project.document().about, "");
}

const GRAPH: &str =
    r#"{"tyndall": 1, "about": "kept", "nodes": {"cloud": {"type": "load_vdb", "path": "../data/a.vdb"}}}"#;

/// A folder with `graphs/a.json`, and the state of the program in it.
fn folder() -> (tempfile::TempDir, PathBuf, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("graphs/a.json");
    std::fs::create_dir(dir.path().join("graphs")).unwrap();
    std::fs::write(&file, GRAPH).unwrap();
    let state = dir.path().join("state");
    (dir, file, state)
}

fn about(file: &Path) -> String {
    Document::load(file).unwrap().about
}

#[test]
fn saved_and_unsaved() {
    let (_dir, file, _) = folder();
    let mut project = Project::load(&file).unwrap();
    assert!(!project.is_unsaved() && !project.can_undo());
    project.edit("say", say("a"));
    assert!(project.is_unsaved() && project.can_undo() && !project.can_redo());
    project.undo();
    assert!(!project.is_unsaved() && project.can_redo());
    project.redo();
    assert!(project.save().unwrap());
    assert_eq!(about(&file), "a");
    assert!(!project.is_unsaved());
    // What was saved is not what it was opened with.
    project.undo();
    assert!(project.is_unsaved());
    project.redo();
    assert!(!project.is_unsaved());
    assert!(!Project::default().save().unwrap());
}

#[test]
fn looking_at_another_frame_is_no_change() {
    let (_dir, file, _) = folder();
    let mut project = Project::load(&file).unwrap();
    let revision = project.revision();
    project.look_at(Some(3));
    assert_eq!((project.document().frame, project.revision()), (Some(3), revision));
    assert!(!project.is_unsaved() && !project.can_undo());
    project.edit("say", say("a"));
    project.look_at(Some(5));
    project.undo();
    assert!(project.document().frame == Some(5) && !project.is_unsaved());
    project.redo();
    assert!(project.revert().unwrap());
    assert!(project.document().frame == Some(5) && !project.is_unsaved());
    project.look_at(None);
    assert!(!project.is_unsaved());
}

#[test]
fn another_folder_reaches_the_same_files() {
    let (dir, file, _) = folder();
    let mut project = Project::load(&file).unwrap();
    project.edit("say", say("a"));
    let moved = dir.path().join("b.json");
    project.save_as(&moved).unwrap();
    assert_eq!(project.file(), Some(moved.as_path()));
    let path = |document: &Document| document.nodes["cloud"].params["path"].as_str().unwrap().to_owned();
    let new = Document::load(&moved).unwrap();
    assert_eq!((path(&new), new.about.as_str()), ("data/a.vdb".to_owned(), "a"));
    // The one that was there is as it was, and what is taken back still leads to its files.
    assert_eq!(about(&file), "kept");
    project.undo();
    assert_eq!(path(project.document()), "data/a.vdb");
    assert!(project.is_unsaved());
}

#[test]
fn a_disk_that_fails_loses_nothing() {
    let (dir, file, state) = folder();
    let mut project = Project::load(&file).unwrap();
    project.edit("say", say("a"));
    let error = project.save_as(&file.join("b.json")).unwrap_err().to_string();
    assert!(error.starts_with("cannot create folder"), "{error}");
    assert_eq!(project.file(), Some(file.as_path()));
    assert!(project.is_unsaved());
    assert_eq!((about(&file).as_str(), project.document().about.as_str()), ("kept", "a"));
    // The graph is saved though its version cannot be kept.
    std::fs::write(&state, "a file where a folder should be").unwrap();
    project.keep_versions(&state);
    project.save().unwrap();
    assert_eq!(about(&file), "a");
    let warning = project.take_warning().unwrap();
    assert!(warning.starts_with("saved, but the version was not kept: cannot create folder"), "{warning}");
    assert_eq!(project.take_warning(), None);
    // And what is not saved cannot be written down: said each time that it is tried.
    project.edit("say", say("b"));
    let mut autosave = Autosave::new(&state);
    let error = autosave.tick(&project, Instant::now()).unwrap();
    assert!(error.starts_with("cannot write down what is not saved in "), "{error}");
    drop(dir);
}

#[test]
fn revert_is_a_step() {
    let (_dir, file, _) = folder();
    let mut project = Project::load(&file).unwrap();
    project.edit("say", say("a"));
    assert!(project.revert().unwrap());
    assert!(!project.is_unsaved());
    assert_eq!(project.document().about, "kept");
    assert_eq!(project.undo().as_deref(), Some("revert to the file"));
    assert_eq!(project.document().about, "a");
    std::fs::remove_file(&file).unwrap();
    assert!(project.revert().is_err());
    assert_eq!(project.document().about, "a");
}

#[test]
fn a_later_version_is_unsaved_and_kept() {
    let (_dir, file, state) = folder();
    let later = r#"{"tyndall": 9, "nodes": {"sun": {"type": "sun", "spots": 3}, "rain": {"type": "rain"}}, "wires": [],
        "clouds": 3}"#;
    std::fs::write(&file, later).unwrap();
    let mut project = Project::load(&file).unwrap();
    assert_eq!(project.left_out().len(), 4);
    assert_eq!(project.left_out()[2..], ["parameter 'sun.spots'", "node 'rain' of the unknown type 'rain'"]);
    // What is understood can be worked with.
    assert!(project.document().nodes["sun"].params.is_empty() && project.document().nodes.len() == 1);
    assert!(project.is_unsaved());
    project.keep_versions(&state);
    project.save().unwrap();
    assert!(project.left_out().is_empty() && !project.is_unsaved());
    let versions = versions::list(&state, &file);
    assert_eq!(std::fs::read_to_string(&versions[1].path).unwrap(), later);
}

#[test]
fn the_last_ten_versions() {
    let (_dir, file, state) = folder();
    let mut project = Project::load(&file).unwrap();
    project.keep_versions(&state);
    project.save().unwrap();
    project.save().unwrap();
    // As it was written by hand, and as it is written here; equal ones are one.
    assert_eq!(versions::list(&state, &file).len(), 2);
    for number in 0..12 {
        project.edit("say", |document| document.about = number.to_string());
        project.save().unwrap();
    }
    let versions = versions::list(&state, &file);
    let numbers: Vec<u64> = versions.iter().map(|version| version.number).collect();
    assert_eq!(numbers, (5..=14).rev().collect::<Vec<_>>());
    project.restore(&versions[9]).unwrap();
    assert_eq!(project.document().about, "2");
    assert_eq!(project.document().base, file.parent().unwrap());
    assert!(project.is_unsaved());
    assert_eq!(project.undo().as_deref(), Some("restore a version"));
    assert!(versions::list(&state, Path::new("another.json")).is_empty());
}

#[test]
fn what_was_not_saved_is_found_after_a_kill() {
    let (_dir, file, state) = folder();
    assert!(recoverable(&state).is_empty());
    let start = Instant::now();
    {
        let mut project = Project::load(&file).unwrap();
        let mut autosave = Autosave::new(&state);
        assert_eq!(autosave.tick(&project, start), None);
        project.edit("say", say("a"));
        assert_eq!(autosave.tick(&project, start), None);
        assert_eq!(autosave.finish(), None);
        // It is written down as it is only once the time has come.
        project.edit("say", say("b"));
        autosave.tick(&project, start + EVERY / 2);
        assert_eq!(autosave.finish(), None);
        // While it runs it is nobody else's.
        assert!(recoverable(&state).is_empty());
        let mut second = Autosave::new(&state);
        let mut other = Project::new(Document::default());
        other.edit("say", say("second"));
        second.tick(&other, start);
        second.finish();
    }
    let found = recoverable(&state);
    let mut abouts: Vec<&str> = found.iter().map(|found| found.document.about.as_str()).collect();
    abouts.sort();
    assert_eq!(abouts, ["a", "second"]);
    drop(found);
    // Another start writes over nothing of them.
    let mut third = Autosave::new(&state);
    let mut other = Project::new(Document::default());
    other.edit("say", say("third"));
    third.tick(&other, start);
    third.finish();
    let mut found = recoverable(&state);
    assert_eq!(found.len(), 2);
    third.forget();
    let second = found.iter().position(|found| found.file.is_none()).unwrap();
    found.remove(second).discard();
    let found = found.remove(0);
    assert_eq!(found.file.as_deref(), Some(file.as_path()));
    let mut autosave = Autosave::new(&state);
    let mut project = autosave.recover(found);
    assert_eq!(
        (project.document().about.as_str(), project.document().base.as_path()),
        ("a", file.parent().unwrap())
    );
    assert!(project.is_unsaved());
    // Killed again before anything was done: it is still there.
    drop(autosave);
    let mut autosave = Autosave::new(&state);
    autosave.recover(recoverable(&state).remove(0));
    project.save().unwrap();
    autosave.tick(&project, start + EVERY * 2);
    assert!(recoverable(&state).is_empty());
    assert_eq!(about(&file), "a");
}

#[test]
fn what_is_undone_or_saved_since_is_not_recoverable() {
    let (_dir, file, state) = folder();
    let mut project = Project::load(&file).unwrap();
    let mut autosave = Autosave::new(&state);
    project.edit("say", say("a"));
    autosave.tick(&project, Instant::now());
    autosave.finish();
    project.undo();
    autosave.tick(&project, Instant::now());
    drop(autosave);
    assert!(recoverable(&state).is_empty());
    let mut autosave = Autosave::new(&state);
    project.redo();
    autosave.tick(&project, Instant::now());
    autosave.finish();
    drop(autosave);
    // Somebody saved the file since.
    let later = std::time::SystemTime::now() + Duration::from_secs(60);
    std::fs::File::options().write(true).open(&file).unwrap().set_modified(later).unwrap();
    assert!(recoverable(&state).is_empty());
}
