//! inspect, compare, nodes and doctor.

use tyndall::image::{self, Image};

use crate::desk::{Desk, has_adapter, sequence};

#[test]
fn inspect_volumes_frames_and_pictures() {
    let desk = sequence();
    let found = desk.run_blind(&["inspect", "cache/a_0001.vdb", "--json"]).json();
    let grid = &found["grids"][0];
    assert_eq!(
        (&found["version"], &grid["name"], &grid["type"]),
        (&224.into(), &"density".into(), &"float".into())
    );
    assert_eq!((&grid["active_voxels"], &grid["mean"]), (&512.into(), &1.0.into()));
    assert_eq!(grid["bbox_max"], serde_json::json!([7, 7, 7]));
    let text = desk.run_blind(&["inspect", "cache/a_0001.vdb"]).done();
    assert!(text.contains("  extent                  8 x 8 x 8 voxels, [0, 0, 0] to [7, 7, 7]\n"), "{text}");
    assert!(text.contains("  voxel size              0.2 x 0.2 x 0.2\n"), "{text}");

    for path in ["cache", "cache/a_####.vdb"] {
        let found = desk.run_blind(&["inspect", path, "--json"]).json();
        assert_eq!([&found["first"], &found["last"], &found["count"]], [1, 5, 4]);
        assert_eq!((&found["missing"], &found["frames"][3]["bytes"]), (&serde_json::json!([3]), &100.into()));
    }

    let mut picture = Image::new(2, 1, vec![1.0, 2.0, 3.0, f32::NAN, 4.0, 5.0]);
    picture.insert("alpha", 1, vec![0.25, 0.75]);
    image::write(&desk.path("a.exr"), &picture).unwrap();
    let found = desk.run_blind(&["inspect", "a.exr", "--json"]).json();
    assert_eq!([&found["width"], &found["height"]], [2, 1]);
    let [beauty, alpha] = [&found["layers"][0], &found["layers"][1]];
    assert_eq!((&beauty["name"], &beauty["non_finite"]), (&"beauty".into(), &1.into()));
    assert_eq!(beauty["max"], serde_json::json!([1.0, 4.0, 5.0]));
    assert_eq!((&alpha["name"], &alpha["mean"]), (&"alpha".into(), &serde_json::json!([0.5])));

    desk.run_blind(&["inspect", "none.vdb"]).refused("error: none.vdb: there is no such file or folder\n");
    let ran = desk.run_blind(&["inspect", "cache/a_0005.vdb"]);
    assert!(ran.code == Some(2) && ran.stderr.starts_with("error: cache/a_0005.vdb: "), "{}", ran.stderr);
    desk.run_blind(&["inspect", "g.json"]).refused(
        "error: g.json: cannot look into this; name a .vdb, .exr, .hdr or .png file, a folder, or a pattern such \
         as smoke_####.vdb\n",
    );
}

#[test]
fn compare_pictures() {
    let desk = Desk::new();
    let write = |name: &str, size: usize, value: f32| {
        image::write(&desk.path(name), &Image::new(size, size, vec![value; size * size * 3])).unwrap();
    };
    write("a.exr", 16, 1.02);
    write("r.exr", 16, 1.0);
    write("small.exr", 8, 1.0);
    let found = desk.run_blind(&["compare", "a.exr", "r.exr", "--json"]).json();
    let keys: Vec<&String> = found.as_object().unwrap().keys().collect();
    let contract =
        ["mean_relative", "block_relative", "rel_mse", "bias", "flip", "ssim", "non_finite", "per_channel"];
    assert_eq!(keys, contract);
    // 1.02 is rounded to f32, 6e-8 of it.
    for name in ["mean_relative", "block_relative", "bias"] {
        assert!((found[name].as_f64().unwrap() - 0.02).abs() < 1e-7, "{name}: {found}");
    }
    let tolerance = |x: &str| {
        let args = ["compare", "a.exr", "r.exr", "--mask", "r.exr", "--map", "map.png", "--tolerance", x];
        desk.run_blind(&args)
    };
    assert!(tolerance("0.021").done().ends_with("block_relative is within the tolerance of 2.100 %\n"));
    assert_eq!(image::read(&desk.path("map.png")).unwrap().width, 16);
    let ran = tolerance("0.019");
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(1), ""));
    assert_eq!(tolerance("NaN").code, Some(2));
    desk.run_blind(&["compare", "small.exr", "r.exr"]).refused(
        "error: the picture is 8x8, the reference 16x16 pixels; sizes must be equal, render it again at 16x16\n",
    );
    desk.run_blind(&["compare", "a.exr", "r.exr", "--map", "map.exr"])
        .refused("error: --map map.exr: the map is a .png; change the ending\n");
}

#[test]
fn nodes_are_listed_and_shown() {
    let desk = Desk::new();
    let list = desk.run_blind(&["nodes"]).done();
    let shown = desk.run_blind(&["nodes", "--json"]).json();
    let kinds: Vec<&str> =
        shown.as_array().unwrap().iter().map(|node| node["type"].as_str().unwrap()).collect();
    assert_eq!(kinds.len(), tyndall::nodes::KINDS.len());
    for kind in kinds {
        assert!(list.contains(&format!("  {kind} ")), "{kind}");
        let text = desk.run_blind(&["nodes", kind]).done();
        assert!(text.starts_with(&format!("{kind} (")), "{text}");
    }
    let medium = desk.run_blind(&["nodes", "medium", "--json"]).json();
    let g = medium["params"].as_array().unwrap().iter().find(|param| param["name"] == "g").unwrap();
    assert_eq!((&g["min"], &g["open_min"], &g["default"]), (&(-1.0).into(), &true.into(), &0.into()));
    desk.run_blind(&["nodes", "mediun"])
        .refused("error: there is no node 'mediun'; did you mean 'medium'? `tyndall nodes` lists them\n");
}

#[test]
fn doctor_proves_it() {
    if has_adapter() {
        let text = Desk::new().run(&["doctor"]).done();
        assert!(text.contains("A picture can be rendered: a test of 8x8 pixels took "), "{text}");
    }
}
