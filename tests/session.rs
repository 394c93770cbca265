//! What a change of the graph runs again.

mod common;

use std::path::Path;

use tyndall::graph::{CancelToken, Document, End, Event, Node, Target, Wire};
use tyndall::nodes;
use tyndall::session::{Session, Solved};
use tyndall::volume::Volume;

/// A sample from a file in a sun, small enough for a test.
fn document() -> Document {
    let text = r#"{ "tyndall": 1, "nodes": {
        "cloud": { "type": "load_vdb", "path": "data/checker.vdb" },
        "medium": { "type": "medium", "max_resolution": 16 },
        "sun": { "type": "sun" },
        "split": { "type": "light_decomposition" },
        "beams": { "type": "principal_propagation" },
        "residual": { "type": "isotropic_residual", "quality": "draft" },
        "camera": { "type": "camera", "width": 16, "height": 16 },
        "march": { "type": "raymarch" } },
      "wires": [ "cloud.volume -> medium.volume", "sun.light -> split.lights",
        "split.ordinates -> beams.ordinates", "medium.medium -> beams.medium",
        "beams.beams -> residual.beams", "beams.beams -> march.beams",
        "medium.medium -> residual.medium", "medium.medium -> march.medium",
        "camera.camera -> march.camera", "residual.residual -> march.residual" ] }"#;
    Document::parse(text, Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn solve(session: &mut Session, document: &Document) -> Solved {
    let solved = session.solve(document, Target::Sinks, &CancelToken::new(), &mut |_| ());
    let failures: Vec<_> = solved.evaluation.failures().collect();
    assert!(failures.is_empty(), "{failures:?}");
    solved
}

/// Nodes that ran, not those that the cache had.
fn ran(solved: &Solved) -> Vec<&str> {
    solved.costs.iter().filter(|cost| !cost.cached).map(|cost| cost.name.as_str()).collect()
}

#[test]
fn a_change_runs_only_what_depends_on_it() {
    let Some(mut session) = common::session() else { return };
    let mut document = document();
    assert_eq!(ran(&solve(&mut session, &document)).len(), 8);
    assert_eq!(ran(&solve(&mut session, &document)), [] as [&str; 0]);

    document.set(nodes::catalog(), "camera.position", "[0, 1, 6]").unwrap();
    assert_eq!(ran(&solve(&mut session, &document)), ["camera", "march"]);

    // A new albedo does not read the file again.
    document.set(nodes::catalog(), "medium.albedo", "0.5").unwrap();
    assert_eq!(ran(&solve(&mut session, &document)), ["medium", "beams", "residual", "march"]);

    document.set(nodes::catalog(), "sun.irradiance", "[1, 0.5, 0.25]").unwrap();
    assert_eq!(ran(&solve(&mut session, &document)), ["sun", "split", "beams", "residual", "march"]);

    session.forget();
    assert_eq!(ran(&solve(&mut session, &document)).len(), 8);
}

#[test]
fn a_changed_file_is_read_again() {
    let Some(mut session) = common::session() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("volume.vdb");
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/checker.vdb");
    std::fs::copy(&sample, &path).unwrap();
    let mut document = document();
    document.set(nodes::catalog(), "cloud.path", path.to_str().unwrap()).unwrap();
    solve(&mut session, &document);
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(5);
    std::fs::File::options().write(true).open(&path).unwrap().set_modified(later).unwrap();
    assert!(ran(&solve(&mut session, &document)).contains(&"cloud"));
}

#[test]
fn a_picture_is_written_again_only_where_it_changed() {
    let Some(mut session) = common::session() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.exr");
    let mut document = document();
    let node = Node::new("save_image");
    document.nodes.insert("save".to_owned(), node);
    let end = |node: &str| End { node: node.to_owned(), port: "image".to_owned() };
    document.wires.push(Wire { from: end("march"), to: end("save") });
    document.set(nodes::catalog(), "save.path", path.to_str().unwrap()).unwrap();
    let nothing = [] as [&str; 0];

    solve(&mut session, &document);
    let bright = std::fs::read(&path).unwrap();
    assert_eq!(ran(&solve(&mut session, &document)), nothing);
    std::fs::write(&path, "somebody else's").unwrap();
    assert_eq!(ran(&solve(&mut session, &document)), ["save"]);
    assert_eq!(std::fs::read(&path).unwrap(), bright);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(ran(&solve(&mut session, &document)), ["save"]);
    assert_eq!(ran(&solve(&mut session, &document)), nothing);

    // Another picture in the same place, and back: the first is found in the cache, its file is not.
    document.set(nodes::catalog(), "sun.irradiance", "0.1").unwrap();
    solve(&mut session, &document);
    assert_ne!(std::fs::read(&path).unwrap(), bright);
    document.nodes["sun"].params.clear();
    assert_eq!(ran(&solve(&mut session, &document)), ["save"]);
    assert_eq!(std::fs::read(&path).unwrap(), bright);
}

#[test]
fn a_volume_is_counted_by_the_grids_that_were_asked_for() {
    let Some(mut session) = common::session() else { return };
    let document = document();
    let bytes = |solved: &Solved| solved.costs.iter().find(|cost| cost.name == "cloud").unwrap().bytes;
    let alone = session.solve(&document, Target::Nodes(&["cloud"]), &CancelToken::new(), &mut |_| ());
    assert_eq!(bytes(&alone), 0);
    let solved = solve(&mut session, &document);
    let volume: &Volume = solved.evaluation.value("cloud", "volume").unwrap().get();
    let voxels = volume.grid("density").unwrap().values.len() as u64;
    assert!(voxels > 0);
    assert_eq!(bytes(&solved), 4 * voxels);
}

#[test]
fn all_gpu_time_belongs_to_a_node() {
    let Some(mut session) = common::session() else { return };
    session.gpu().time_stages();
    // The light of two splits, whose beams are merged.
    let mut document = document();
    for (name, like) in [("split_2", "split"), ("beams_2", "beams")] {
        let node = document.nodes[like].clone();
        document.nodes.insert(name.to_owned(), node);
    }
    let wires: Vec<Wire> = document.wires.clone();
    let renamed = |end: &End| match end.node.as_str() {
        "split" | "beams" => End { node: format!("{}_2", end.node), port: end.port.clone() },
        _ => end.clone(),
    };
    for wire in wires {
        let other = Wire { from: renamed(&wire.from), to: renamed(&wire.to) };
        if other != wire {
            document.wires.push(other);
        }
    }
    let solved = solve(&mut session, &document);
    let times = session.gpu().take_stage_times();
    let stages: Vec<&str> = times.iter().map(|time| time.stage.as_str()).collect();
    assert!(stages.contains(&"repack"), "{stages:?}");
    let of_stages: f64 = times.iter().map(|time| time.gpu_ms).sum();
    let of_nodes: f64 = solved.costs.iter().map(|cost| cost.gpu_ms).sum();
    // The same numbers in another order of addition.
    assert!((of_nodes - of_stages).abs() < 1e-9 * of_stages, "{of_nodes} of {of_stages} ms");
}

#[test]
fn a_cancel_is_heard_between_nodes() {
    let Some(mut session) = common::session() else { return };
    let cancel = CancelToken::new();
    let solved = session.solve(&document(), Target::Sinks, &cancel, &mut |event| {
        if matches!(event, Event::Finished { name, .. } if name == "beams") {
            cancel.cancel();
        }
    });
    assert!(solved.evaluation.cancelled);
    assert!(solved.evaluation.value("residual", "residual").is_none());
    // What was finished is kept.
    let solved = solve(&mut session, &document());
    assert!(!ran(&solved).contains(&"beams"));
}

#[test]
fn the_same_graph_gives_the_same_bytes() {
    let Some(mut session) = common::session() else { return };
    let picture = |session: &mut Session| {
        let solved = solve(session, &document());
        solved.evaluation.value("march", "image").unwrap().get::<tyndall::image::Image>().clone()
    };
    let first = picture(&mut session);
    session.forget();
    assert_eq!(first, picture(&mut session));
}
