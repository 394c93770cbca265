//! explain: its text on two presets, its JSON, and what it refuses.

use std::path::Path;

use serde_json::json;

use crate::desk::{Desk, has_adapter};

fn preset(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("graphs/{name}.json")).display().to_string()
}

/// The table without bytes and times, and all that follows up to the last line.
fn explained(desk: &Desk, name: &str) -> (Vec<Vec<String>>, String) {
    let graph = preset(name);
    let text = desk.run(&["explain", &graph, "--set", "medium.max_resolution=24", "--size", "32x18"]).done();
    let mut parts = text.splitn(3, "\n\n");
    assert!(parts.next().unwrap().starts_with(&format!("{graph} on ")), "{text}");
    let cells = |line: &str| {
        line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).take(5).map(str::to_owned).collect()
    };
    let table = parts.next().unwrap().lines().skip(1).map(cells).collect();
    let (rest, last) = parts.next().unwrap().rsplit_once("\n\n").unwrap();
    assert!(last.starts_with("about ") && last.ends_with(" tone, save\n"), "{last}");
    (table, rest.to_owned())
}

#[test]
fn a_fire_is_explained() {
    if !has_adapter() {
        return;
    }
    let (table, text) = explained(&Desk::new(), "fire");
    let row = |name: &str| table.iter().find(|row| row[0] == name).unwrap().join(", ");
    assert_eq!(row("medium"), "medium, medium, was run, 16 x 32 x 16, -");
    assert_eq!(row("residual"), "residual, isotropic_residual, would run, 16 x 32 x 16, 3");
    assert_eq!(row("save"), "save, save_image, would run, -, -");
    let lines = [
        "  left out  ordinates         it flows in from all sides alike (radiance from everywhere 0.004 0.006 0.011)",
        "  empty     input lights      there is only the environment",
        "  left out  beams           no light has a direction (0 beams)",
        "  empty     input surfaces  nothing is in the way of the light",
        "  kept      three channels       the albedo differs from channel to channel (albedo 0.8 0.78 0.75; light of 1 color)",
        "  kept      directions of lobes  scattering keeps some of the direction (g = 0.4)",
        "  kept      the residual                it holds what was scattered more than once (lit)",
    ];
    for line in lines {
        assert!(text.lines().any(|found| found == line), "{line}\n{text}");
    }
}

#[test]
fn a_fog_sphere_is_explained() {
    if !has_adapter() {
        return;
    }
    let (table, text) = explained(&Desk::new(), "fog_sphere");
    let row = |name: &str| table.iter().find(|row| row[0] == name).unwrap().join(", ");
    assert_eq!(row("glow"), "glow, spherical_propagation, would run, 32 x 32 x 32, -");
    assert_eq!(text, FOG_SPHERE);
}

const FOG_SPHERE: &str = "\
medium
  left out  subdivision                cells are thin (at most 0.09167 optical depths a cell)
  left out  optical depths by samples  the shape's are known (an even shape)

split
  left out  ordinates         it flows in from all sides alike (radiance from everywhere 0.012 0.02 0.04)
  empty     input lights      there is only the environment
  empty     input importance  all light counts alike

ambient
  left out  beams           no light has a direction (0 beams)
  empty     input surfaces  nothing is in the way of the light

glow
  kept      beams                              light is scattered out of them (2 beams; albedo 0.99)
  left out  an optical depth for each channel  extinction is the same in all: color is in the albedo (2 beams)
  kept      walks to the lights                a shape in closed form needs no samples (2 lights; walks take 970300 samples and 1 MiB, grids of 32 x 32 directions and 32 distances 73980 samples and 1 MiB)
  empty     input surfaces                     nothing is in the way of the light

residual
  kept      multiple scattering  light is scattered more than once (albedo up to 0.99, optical depth up to 4.192; light: beams, ambient; share of multiple scattering not bounded)
  kept      three channels       lights have several colors: optical depths are shared, scattered light is not (albedo 0.99; light of 3 colors)
  left out  36 of 50 directions  14 carry light that comes from outside (0 lights inside, emission: no)
  kept      directions of lobes  scattering keeps some of the direction (g = 0.6)
  kept      beams                light is scattered out of them (2 beams; albedo 0.99)
  empty     input surfaces       nothing sends light back

march
  kept   three channels                       lights have several colors: optical depths are shared, scattered light is not (albedo 0.99; light of 3 colors)
  kept   beams                                light is scattered out of them (2 beams; albedo 0.99)
  kept   the forward peak                     matter scatters forward (g = 0.6)
  kept   the residual                         it holds what was scattered more than once (lit)
  kept   directions of lobes                  scattering keeps some of the direction (g = 0.6)
  kept   looking up every beam at every step  lights have places, shadows, peaks that widen, or ways back (2 beams)
  empty  input surfaces                       only the medium is seen";

#[test]
fn what_scripts_read() {
    if !has_adapter() {
        return;
    }
    let desk = Desk::new();
    desk.write_graph("stray.json", r#""sun": {"#, r#""stray": { "type": "sun" }, "sun": {"#);
    let found = desk.run(&["explain", "stray.json", "--set", "medium.g=0", "--json"]).json();
    let keys: Vec<&String> = found.as_object().unwrap().keys().collect();
    assert_eq!(keys, ["graph", "adapter", "copy_gb_per_s", "ms", "nodes", "left_out"]);
    assert_eq!(found["left_out"], json!([{ "name": "stray", "reason": "no output needs it" }]));
    let node =
        |name: &str| found["nodes"].as_array().unwrap().iter().find(|node| node["name"] == name).unwrap();
    let march = node("march");
    let keys: Vec<&String> = march.as_object().unwrap().keys().collect();
    let contract =
        ["name", "type", "was_run", "cells", "channels", "bytes", "ms", "stages", "decisions", "absent"];
    assert_eq!(keys, contract);
    assert_eq!(
        (&march["was_run"], &march["channels"], &march["bytes"]),
        (&json!(false), &json!(1), &json!(80 * 32 * 32))
    );
    assert_eq!(node("medium")["was_run"], json!(true));
    let peak =
        march["decisions"].as_array().unwrap().iter().find(|found| found["rule"] == "forward_peak").unwrap();
    assert_eq!(
        *peak,
        json!({ "rule": "forward_peak", "kept": false, "what": "the forward peak",
            "reason": "nothing is scattered more forward than back", "data": "g = 0" })
    );
    assert_eq!(
        march["absent"][0],
        json!({ "input": "residual",
        "meaning": "light that was scattered more than once is not seen, but for the forward peak" })
    );
    let stage = &march["stages"][0];
    assert_eq!((&stage["stage"], &stage["runs"]), (&json!("raymarch"), &json!(1)));
    assert!(stage["moved_bytes"].as_u64().unwrap() > 0 && stage["floor_ms"].as_f64().unwrap() > 0.0);
    // Nothing was rendered.
    assert_eq!(desk.files(), ["g.json", "stray.json"]);
    // And with everything modeled the peak is there.
    let full = desk.run(&["explain", "stray.json", "--set", "medium.g=0", "--json", "--full"]).json();
    let march = full["nodes"].as_array().unwrap().iter().find(|node| node["name"] == "march").unwrap();
    assert!(
        march["decisions"]
            .as_array()
            .unwrap()
            .iter()
            .all(|decision| decision["rule"] == "residual" || decision["kept"] == true)
    );
}

#[test]
fn what_is_wrong_is_refused_as_by_render() {
    let desk = Desk::new();
    desk.run_blind(&["explain", "none.json"])
        .refused("error: cannot read the graph 'none.json': No such file or directory (os error 2)\n");
    desk.run_blind(&["explain", "g.json", "--set", "medium.g=1"])
        .refused("error: cannot set 'medium.g': g = 1 is outside -1 < value < 1; the default is 0\n");
    desk.write_graph("wire.json", "march.image ->", "sun.light ->");
    desk.run_blind(&["explain", "wire.json"]).refused(
        "wire.json: node 'save': cannot wire light into image; 'save.image' takes image, which raymarch.image, \
         slice.image, transfer_function.image, histogram.image, tone_map.image or save_image.image give\n",
    );
    if has_adapter() {
        desk.write_graph(
            "gone.json",
            r#""type": "shape", "resolution": 16"#,
            r#""type": "load_vdb", "path": "gone.vdb""#,
        );
        let ran = desk.run(&["explain", "gone.json"]);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""));
        assert!(
            ran.stderr.starts_with("gone.json: node 'ball': ") && ran.stderr.lines().count() == 1,
            "{}",
            ran.stderr
        );
    }
}
