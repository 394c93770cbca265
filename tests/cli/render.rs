//! Pictures and sequences that are rendered.

use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value as Json;
use tyndall::image;

use crate::desk::{BALL, Desk, GRAPH, Ran, has_adapter, sequence, small_vdb};

#[test]
fn picture_and_its_costs() {
    if !has_adapter() {
        return;
    }
    let desk = Desk::new();
    desk.write("deep/g.json", GRAPH);
    // The path in the graph starts at the graph, those on the command line at the working directory.
    let text = desk.run(&["render", "deep/g.json"]).done();
    assert!(text.starts_with("deep/out/ball.exr: 32x32, "), "{text}");
    // As one finds it from here.
    desk.write("deep/near.json", GRAPH.replace("out/ball.exr", "../near.exr"));
    let text = desk.run(&["render", "deep/near.json"]).done();
    assert!(text.starts_with("near.exr: 32x32, "), "{text}");
    for name in ["near.exr", "deep/near.json"] {
        fs::remove_file(desk.path(name)).unwrap();
    }
    let args = ["render", "deep/g.json", "-o", "new/a.png", "--size", "48x16", "--stats", "s.json"];
    desk.run(&[&args[..], &["--set", "medium.g=0", "--adapter", "auto"]].concat()).done();
    assert_eq!(desk.files(), ["deep/g.json", "deep/out/ball.exr", "g.json", "new/a.png", "s.json"]);
    let exr = image::read(&desk.path("deep/out/ball.exr")).unwrap();
    let png = image::read(&desk.path("new/a.png")).unwrap();
    assert_eq!([exr.width, exr.height, png.width, png.height], [32, 32, 48, 16]);
    assert!(exr.beauty().iter().all(|value| value.is_finite()));
    assert!(exr.beauty().iter().any(|value| *value > 0.01));
    let stats = desk.json("s.json");
    let keys: Vec<&String> = stats.as_object().unwrap().keys().collect();
    assert_eq!(keys, ["wall_ms", "peak_bytes", "adapter", "nodes"]);
    assert!(stats["wall_ms"].as_f64().unwrap() > 0.0 && stats["peak_bytes"].as_u64().unwrap() > 0);
    let nodes = stats["nodes"].as_array().unwrap();
    let names: Vec<&str> = nodes.iter().map(|node| node["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["ball", "medium", "sun", "split", "beams", "camera", "march", "save"]);
    let keys: Vec<&String> = nodes[6].as_object().unwrap().keys().collect();
    assert_eq!(keys, ["name", "type", "cpu_ms", "gpu_ms", "bytes", "cached", "decisions"]);
    assert_eq!((&nodes[6]["type"], &nodes[6]["cached"]), (&Json::from("raymarch"), &Json::from(false)));
}

#[test]
fn any_image_can_be_looked_at() {
    if !has_adapter() {
        return;
    }
    let desk = Desk::new();
    desk.run(&["render", "g.json"]).done();
    desk.run(&["render", "g.json", "--node", "march", "-o", "march.exr"]).done();
    assert_eq!(desk.files(), ["g.json", "march.exr", "out/ball.exr"]);
    // Deterministic: the same graph, data and adapter give the same bytes.
    assert_eq!(fs::read(desk.path("march.exr")).unwrap(), fs::read(desk.path("out/ball.exr")).unwrap());
}

#[test]
fn frames_are_kept_and_failures_counted() {
    if !has_adapter() {
        return;
    }
    let desk = sequence();
    let render = |frames: &str, output: &str| {
        desk.run(&["render", "g.json", "--frames", frames, "-o", output, "--stats", "s.json"])
    };
    desk.write("p/f_04.png", "kept");
    let ran = render("1-5", "p/f_##.png");
    assert_eq!(ran.code, Some(1));
    let why = "g.json: frame 3: node 'ball': no frame 3 in cache/a_####.vdb: there are 1 to 5, some of them missing";
    let lines: Vec<&str> = ran.stderr.lines().collect();
    assert!(lines.len() == 2 && lines[0] == why, "{}", ran.stderr);
    assert!(lines[1].starts_with("g.json: frame 5: node 'ball': cache/a_0005.vdb: "), "{}", ran.stderr);
    let lines: Vec<&str> = ran.stdout.lines().collect();
    assert!(lines[0].starts_with("frame 1: p/f_01.png: 32x32, "), "{}", ran.stdout);
    assert_eq!(lines[2], "frame 4: p/f_04.png is there, kept");
    let counts = "2 written, 1 kept (--overwrite renders them again), 2 failed, ";
    assert!(lines.len() == 4 && lines[3].starts_with(counts), "{}", ran.stdout);
    assert_eq!(fs::read(desk.path("p/f_04.png")).unwrap(), b"kept");
    let stats = desk.json("s.json");
    let frames = stats["frames"].as_array().unwrap();
    assert_eq!(frames.iter().map(|frame| frame["frame"].as_i64().unwrap()).collect::<Vec<_>>(), [1, 2]);
    let sum: f64 = frames.iter().map(|frame| frame["wall_ms"].as_f64().unwrap()).sum();
    assert!((stats["wall_ms"].as_f64().unwrap() - sum).abs() <= 1e-9 * sum);
    // The sun does not move: the second frame found it in the cache.
    let sun = |nodes: &Json| {
        let mut nodes = nodes.as_array().unwrap().iter();
        nodes.find(|node| node["name"] == "sun").unwrap()["cached"].as_bool().unwrap()
    };
    assert_eq!([&frames[0]["nodes"], &frames[1]["nodes"], &stats["nodes"]].map(sun), [false, true, false]);

    assert_eq!(render("1-4x3", "p/f_##.png").done().lines().count(), 3);
    let again = ["render", "g.json", "--frames", "4", "-o", "p/f_##.png", "--overwrite"];
    let text = desk.run(&again).done();
    assert!(text.lines().nth(1).unwrap().starts_with("1 written, 0 kept, 0 failed, "), "{text}");
    assert_ne!(fs::read(desk.path("p/f_04.png")).unwrap(), b"kept");
    assert_eq!(desk.run(&["render", "g.json", "--overwrite"]).code, Some(2), "it is for frames");
    // Without a place for the number it stands before the ending.
    render("1-2", "q.exr").done();
    assert!(desk.path("q_0001.exr").is_file() && desk.path("q_0002.exr").is_file());
    let ran = render("7-8", "r.exr");
    assert_eq!((ran.code, ran.stderr.lines().count()), (Some(2), 2), "all failed: {}", ran.stderr);
}

#[test]
fn a_camera_moves_over_frames() {
    if !has_adapter() {
        return;
    }
    let desk = Desk::new();
    desk.write_graph("g.json", BALL, r#""type": "load_vdb", "path": "a.vdb""#);
    desk.write("a.vdb", small_vdb());
    let moving = r#"camera.position={"keys": [[1, [0, 0, 5]], [3, [2, 0, 5]]]}"#;
    let frames = ["render", "g.json", "--frames", "1-4", "-o", "p.exr", "--stats", "s.json", "--set", moving];
    desk.run(&frames).done();
    let pixels = |name: &str| image::read(&desk.path(name)).unwrap().beauty().to_vec();
    assert_ne!(pixels("p_0001.exr"), pixels("p_0002.exr"));
    assert_eq!(pixels("p_0003.exr"), pixels("p_0004.exr"), "after the last key");
    // Half way, as if it were written there.
    desk.run(&["render", "g.json", "-o", "half.exr", "--set", "camera.position=[1, 0, 5]"]).done();
    assert_eq!(pixels("p_0002.exr"), pixels("half.exr"));
    // Without a frame it is the first key's.
    desk.run(&["render", "g.json", "-o", "still.exr", "--set", moving]).done();
    assert_eq!(pixels("p_0001.exr"), pixels("still.exr"));
    // What the frame does not change is not done again: a file without numbers is the same in each.
    let stats = desk.json("s.json");
    let again = stats["frames"][1]["nodes"].as_array().unwrap().iter().filter(|node| node["cached"] == false);
    assert_eq!(
        again.map(|node| node["name"].as_str().unwrap()).collect::<Vec<_>>(),
        ["camera", "march", "save"]
    );
}

#[cfg(unix)]
#[test]
fn interrupted_frames_are_whole() {
    if !has_adapter() {
        return;
    }
    let desk = Desk::new();
    desk.write_graph("g.json", BALL, r#""type": "load_vdb", "path": "a.vdb""#);
    desk.write("a.vdb", small_vdb());
    let mut command = desk.command(&["render", "g.json", "--frames", "1-99999", "-o", "p/f.exr"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !desk.path("p/f_0001.exr").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let ran = Ran::of(child.wait_with_output().unwrap());
    assert_eq!(
        (ran.code, ran.stderr.as_str()),
        (Some(130), "error: interrupted; type the same again to go on\n")
    );
    for file in desk.files().iter().filter(|file| file.starts_with("p/")) {
        assert_eq!(image::read(&desk.path(file)).unwrap().width, 32, "{file}");
    }
}

#[test]
fn a_table_is_written_as_csv() {
    let desk = Desk::new();
    desk.write(
        "count.json",
        r#"{ "tyndall": 1, "nodes": {
            "ball": { "type": "shape", "kind": "box", "resolution": 8 },
            "counts": { "type": "histogram", "bins": 2, "range": [0, 2] } },
            "wires": ["ball.volume -> counts.volume"] }"#,
    );
    let refused = |args: &[&str], why: &str| {
        desk.run_blind(&[&["render", "count.json"], args].concat()).refused(&format!("error: {why}\n"));
    };
    refused(&["--node", "ball", "-o", "h.csv"], "--node 'ball' gives no table; those that do are counts");
    refused(&["--node", "ball", "-o", "h.exr"], "--node 'ball' gives no image; those that do are counts");
    if !has_adapter() {
        return;
    }
    desk.run(&["render", "count.json", "--node", "counts", "-o", "h.csv"]).done();
    // The box fills its 8³ voxels; a value on the border of two bins is in the upper one.
    assert_eq!(std::fs::read_to_string(desk.path("h.csv")).unwrap(), "low,high,count\n0,1,0\n1,2,512\n");
    // The only table of the graph needs no name.
    desk.run(&["render", "count.json", "-o", "again.csv"]).done();
    desk.run(&["render", "count.json", "-o", "bars.png"]).done();
}
