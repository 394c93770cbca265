//! The worker on a small graph: what it answers, in which order.

use std::path::Path;
use std::time::Duration;

use super::*;
use crate::image::Image;

fn graph() -> Document {
    let text = r#"{"tyndall": 1, "nodes": {
        "ball": {"type": "shape", "kind": "sphere", "resolution": 64},
        "medium": {"type": "medium", "density_scale": 2},
        "sun": {"type": "sun"},
        "split": {"type": "light_decomposition"},
        "beams": {"type": "principal_propagation"},
        "camera": {"type": "camera", "width": 128, "height": 96},
        "march": {"type": "raymarch"}
    }, "wires": ["ball.volume -> medium.volume", "sun.light -> split.lights", "medium.medium -> beams.medium",
        "split.ordinates -> beams.ordinates", "medium.medium -> march.medium", "beams.beams -> march.beams",
        "camera.camera -> march.camera"]}"#;
    Document::parse(text, Path::new("")).unwrap()
}

fn ask(document: Document, is_drag: bool) -> Ask {
    Ask { document, looked_at: vec!["march".to_owned()], is_drag, ..Ask::default() }
}

/// Replies until the worker rests, or `None`, said aloud, where there is no adapter and none is required.
fn until_rested(worker: &Worker, number: u64) -> Option<Vec<Reply>> {
    let mut replies = Vec::new();
    loop {
        let (of, reply) = worker.replies.recv_timeout(Duration::from_secs(300)).expect("an answer");
        match reply {
            Reply::Rested if of == number => return Some(replies),
            Reply::Trouble { message, .. } if std::env::var("TYNDALL_GPU").as_deref() == Ok("require") => {
                panic!("{message}")
            }
            Reply::Trouble { message, .. } => {
                eprintln!("skipped: {message}");
                return None;
            }
            reply if of == number => replies.push(reply),
            _ => {}
        }
    }
}

/// Level and width of each picture.
fn pictures(replies: &[Reply]) -> Vec<(Level, usize)> {
    let solved = replies.iter().filter_map(|reply| match reply {
        Reply::Solved(solved) => Some(solved),
        _ => None,
    });
    let picture = |solved: &Solved| {
        let (_, _, value) = solved.values.iter().find(|(name, ..)| name == "march")?;
        Some((solved.level, value.get::<Image>().width))
    };
    solved.filter_map(picture).collect()
}

#[test]
fn coarse_first_then_full_and_a_drag_keeps_the_fields() {
    let mut worker = Worker::start(&AdapterChoice::Auto, || {});
    let number = worker.ask(ask(graph(), false));
    let Some(replies) = until_rested(&worker, number) else { return };
    assert_eq!(pictures(&replies), [(Level::FIRST, 32), (Level::FULL, 128)]);
    // The camera moves: no field is computed again.
    let mut moved = graph();
    moved.set(catalog(), "camera.position", "[1, 0, 5]").unwrap();
    let number = worker.ask(ask(moved.clone(), true));
    let replies = until_rested(&worker, number).unwrap();
    let levels = pictures(&replies);
    assert!(matches!(levels.as_slice(), [(Level { is_coarse: false, .. }, _)]), "{levels:?}");
    let started: Vec<&str> = replies
        .iter()
        .filter_map(|reply| match reply {
            Reply::Event { event: Event::Started { name }, .. } => Some(name.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(started, ["camera", "march"]);
    // The light moves: all is coarse.
    moved.set(catalog(), "sun.direction", "[1, 0, 0]").unwrap();
    let number = worker.ask(ask(moved, true));
    let levels = pictures(&until_rested(&worker, number).unwrap());
    assert!(matches!(levels.as_slice(), [(Level { is_coarse: true, .. }, _)]), "{levels:?}");
    // What is known is shown at once.
    let number = worker.ask(ask(graph(), false));
    assert_eq!(pictures(&until_rested(&worker, number).unwrap()), [(Level::FULL, 128)]);
}
