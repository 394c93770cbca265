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

/// A worker's own end, on a device of its own; `None`, said aloud, where there is none.
fn bench() -> Option<Bench> {
    crate::gpu::testing::gpu()?;
    Some(Bench { session: None, coarse: Pace::default(), fine: Pace::default() })
}

/// What is told while a request is answered.
fn answered(bench: &mut Bench, ask: Ask) -> (Result<(), String>, Vec<Reply>) {
    let request = Request { number: 1, ask, cancel: CancelToken::new() };
    let replies = std::cell::RefCell::new(Vec::new());
    let tell = |_, reply| replies.borrow_mut().push(reply);
    let result = bench.answer(&AdapterChoice::Auto, &request, &tell);
    (result, replies.into_inner())
}

fn n_opened(replies: &[Reply]) -> usize {
    replies.iter().filter(|reply| matches!(reply, Reply::Opened(_))).count()
}

#[test]
fn a_device_that_is_lost_is_told_and_opened_again() {
    let Some(mut bench) = bench() else { return };
    let (result, replies) = answered(&mut bench, ask(graph(), false));
    assert!(result.is_ok() && n_opened(&replies) == 1);
    bench.session.as_ref().unwrap().gpu().lose("the driver was reset");
    // Another camera, so that something has to run.
    let mut moved = graph();
    moved.set(catalog(), "camera.position", "[1, 0, 5]").unwrap();
    let (result, _) = answered(&mut bench, ask(moved.clone(), false));
    let message = result.unwrap_err();
    assert!(message.contains("the driver was reset"), "{message}");
    // What the thread does then.
    bench.session = None;
    let (result, replies) = answered(&mut bench, ask(moved, false));
    assert!(result.is_ok() && n_opened(&replies) == 1);
    assert_eq!(pictures(&replies).last(), Some(&(Level::FULL, 128)));
}

#[test]
fn a_restart_opens_the_device_anew_even_where_a_newer_request_comes_first() {
    let mut worker = Worker::start(&AdapterChoice::Auto, || {});
    let number = worker.ask(ask(graph(), false));
    if until_rested(&worker, number).is_none() {
        return;
    }
    worker.ask(Ask { is_restart: true, ..ask(graph(), false) });
    let number = worker.ask(ask(graph(), false));
    let mut n_opened = 0;
    loop {
        match worker.replies.recv_timeout(Duration::from_secs(300)).expect("an answer") {
            (_, Reply::Opened(_)) => n_opened += 1,
            (of, Reply::Rested) if of == number => break,
            _ => {}
        }
    }
    assert_eq!(n_opened, 1);
}

#[test]
fn what_is_shown_over_the_picture_is_solved_with_it() {
    let Some(mut bench) = bench() else { return };
    let mut document = graph();
    document.nodes.insert("slice plane".to_owned(), crate::graph::Node::new("slice"));
    let to = crate::graph::End::new("slice plane", "medium");
    document.wires.push(crate::graph::Wire { from: crate::graph::End::new("medium", "medium"), to });
    let beside = vec!["slice plane".to_owned()];
    let ask = Ask { beside: beside.clone(), wanted: beside, ..ask(document, false) };
    let (_, replies) = answered(&mut bench, ask.clone());
    let slices = |replies: &[Reply]| -> Vec<(Level, usize)> {
        let of = |reply: &Reply| match reply {
            Reply::Solved(solved) => {
                Some((solved.level, solved.values.iter().filter(|(name, ..)| name == "slice plane").count()))
            }
            _ => None,
        };
        replies.iter().filter_map(of).filter(|(_, n)| *n > 0).collect()
    };
    // Picture and plane, coarse and full.
    assert_eq!(slices(&replies), [(Level::FIRST, 2), (Level::FULL, 2)]);
    assert_eq!(pictures(&replies), [(Level::FIRST, 32), (Level::FULL, 128)]);
    // Without a picture there is the plane alone.
    let (_, replies) = answered(&mut bench, Ask { looked_at: Vec::new(), ..ask });
    assert_eq!(slices(&replies), [(Level::FULL, 2)]);
}

#[test]
fn frames_that_are_kept_are_told() {
    let Some(mut bench) = bench() else { return };
    let folder = tempfile::tempdir().unwrap();
    let steam = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/steam.vdb");
    for number in 1..=3 {
        std::fs::copy(&steam, folder.path().join(format!("steam_{number}.vdb"))).unwrap();
    }
    let text = r#"{"tyndall": 1, "nodes": {
        "steam": {"type": "load_vdb", "path": "steam_#.vdb"},
        "medium": {"type": "medium", "max_resolution": 24},
        "camera": {"type": "camera", "width": 32, "height": 24, "position": {"keys": [[1, [0, 0, 5]], [3, [1, 0, 5]]]}},
        "march": {"type": "raymarch"}
    }, "wires": ["steam.volume -> medium.volume", "medium.medium -> march.medium", "camera.camera -> march.camera"]}"#;
    let at = |frame| Document { frame: Some(frame), ..Document::parse(text, folder.path()).unwrap() };
    let kept = |replies: Vec<Reply>| {
        let found = replies.into_iter().find_map(|reply| match reply {
            Reply::Kept { loaded, cached } => Some((loaded, cached)),
            _ => None,
        });
        found.expect("what is kept")
    };
    let (_, replies) = answered(&mut bench, Ask { frames: vec![2, 1], ..ask(at(1), false) });
    assert_eq!(kept(replies), ([1].into(), [1].into()));
    let (_, replies) = answered(&mut bench, Ask { frames: vec![3, 1, 2], ..ask(at(2), false) });
    assert_eq!(kept(replies), ([1, 2].into(), [1, 2].into()));
    // Another medium: the files are still loaded, the pictures are others.
    let mut denser = at(2);
    denser.set(catalog(), "medium.density_scale", "3").unwrap();
    let (_, replies) = answered(&mut bench, Ask { frames: vec![1, 2], ..ask(denser, false) });
    assert_eq!(kept(replies), ([1, 2].into(), [2].into()));
}
