//! Wrong usage and input: the exact line, exit code 2, and no file left behind.

use std::fs;
use std::process::Stdio;

use crate::desk::{BALL, Desk, GRAPH, NODES, Ran, has_adapter, small_vdb};

#[test]
fn graphs_that_are_none() {
    let desk = Desk::new();
    let missing = "No such file or directory (os error 2)";
    let refused = |file: &str, lines: &str| desk.run_blind(&["render", file]).refused(lines);
    refused("a.json", &format!("error: cannot read the graph 'a.json': {missing}\n"));
    desk.write("bad.json", "{ \"tyndall\": 1, ");
    refused(
        "bad.json",
        "bad.json: the graph is not valid JSON: EOF while parsing a value at line 1 column 16\n",
    );
    desk.write("form.json", r#"{ "tyndall": 1, "node": {}, "wires": [3] }"#);
    refused(
        "form.json",
        "form.json: the field \"nodes\" is missing; write \"nodes\": {}\n\
         form.json: unknown field 'node'; did you mean 'nodes'? allowed are tyndall, about, nodes, wires, layout, bends, frames, inputs, outputs\n\
         form.json: wires[0] is 3; write \"node.output -> node.input\"\n",
    );
    desk.write_graph("wire.json", "march.image ->", "sun.light ->");
    refused(
        "wire.json",
        "wire.json: node 'save': cannot wire light into image; 'save.image' takes image, which raymarch.image, \
         slice.image, transfer_function.image, histogram.image, tone_map.image or save_image.image give\n",
    );
    desk.write_graph("cycle.json", "march.image -> save.image", "save.image -> save.image");
    refused("cycle.json", "cycle.json: node 'save': is in the cycle save -> save; remove a wire of it\n");
    desk.write_graph("two.json", r#""g": 0.5"#, r#""g": 1, "colour": 3"#);
    refused(
        "two.json",
        "two.json: node 'medium': unknown parameter 'colour'; allowed are density, density_scale, albedo, g, \
         max_resolution, max_cells, emission, kelvin_per_unit, kelvin_offset, emission_scale, reference_kelvin\n\
         two.json: node 'medium': g = 1 is outside -1 < value < 1; the default is 0\n",
    );
    assert!(!desk.path("out").exists());
}

#[test]
fn parameters_that_are_not_allowed() {
    let desk = Desk::new();
    let refused = |setting: &str, line: &str| {
        desk.run_blind(&["render", "g.json", "--set", setting]).refused(&format!("error: {line}\n"));
    };
    let g = "-1 < value < 1";
    refused("medium.g=1", &format!("cannot set 'medium.g': g = 1 is outside {g}; the default is 0"));
    refused(
        "medium.g=NaN",
        &format!("cannot set 'medium.g': \"NaN\" is not valid JSON; write a number, {g}"),
    );
    refused(
        "medium.albedo=1.2",
        "cannot set 'medium.albedo': albedo = 1.2 is outside 0..=1; the default is [1,1,1]",
    );
    refused(
        "medum.g=0",
        &format!("cannot set 'medum.g': there is no such node; did you mean 'medium'? {NODES}"),
    );
    refused(
        "medium.albdo=1",
        "cannot set 'medium.albdo': unknown parameter 'albdo'; did you mean 'albedo'? allowed are density, \
         density_scale, albedo, g, max_resolution, max_cells, emission, kelvin_per_unit, kelvin_offset, \
         emission_scale, reference_kelvin",
    );
    refused("medium.g", "--set 'medium.g' has no value; write node.parameter=value");
    refused("g=1", "'g' names no parameter; write node.parameter=value");
    let two = ["render", "g.json", "--set", "g=1", "--set", "h"];
    desk.run_blind(&two).refused(
        "error: 'g' names no parameter; write node.parameter=value\n\
         error: --set 'h' has no value; write node.parameter=value\n",
    );
    assert_eq!(desk.files(), ["g.json"]);
}

#[test]
fn outputs_that_cannot_be() {
    let desk = Desk::new();
    desk.write("file", "");
    let refused = |args: &[&str], line: &str| {
        let args = [&["render", "g.json"], args].concat();
        desk.run_blind(&args).refused(&format!("error: {line}\n"));
    };
    refused(&["-o", "x.jpg"], "cannot write x.jpg: pictures are written as .exr or .png; change the ending");
    refused(&["-o", "x"], "cannot write x: pictures are written as .exr or .png; change the ending");
    refused(
        &["-o", "x_##.exr"],
        "x_##.exr: # stands for a frame's number; add --frames 1-100, or write a name without #",
    );
    refused(
        &["-o", "file/x.exr"],
        "cannot create folder file: Not a directory (os error 20); choose a folder that can be written",
    );
    fs::create_dir(desk.path("folder.exr")).unwrap();
    refused(&["-o", "folder.exr"], "cannot write folder.exr: it is a folder; add a file name");
    #[cfg(target_os = "linux")]
    {
        // Not even root can write there.
        let why = "No such file or directory (os error 2); nothing was changed, free space or choose a folder \
                   that can be written";
        refused(&["-o", "/proc/x.exr"], &format!("cannot write /proc/x.exr: {why}"));
        refused(&["--stats", "/proc/s.json"], &format!("cannot write /proc/s.json: {why}"));
    }
    refused(&["--node", "sun", "-o", "x.exr"], "--node 'sun' gives no image; those that do are march, save");
    refused(&["--node", "march"], "--node 'march' is no save_image; say where to write with -o picture.exr");
    refused(
        &["--node", "marsh"],
        &format!("--node 'marsh': there is no such node; did you mean 'march'? {NODES}"),
    );
    refused(
        &["--frames", "1-2"],
        "--frames: nothing in the graph changes with the frame, no load_vdb and no parameter with keys; leave it out",
    );
    refused(
        &["--size", "16385x1"],
        "cannot set 'camera.width': width = 16385 is outside 1..=16384; the default is 512",
    );
    let usage = |args: &[&str], why: &str| {
        let ran = desk.run_blind(&[&["render", "g.json"], args].concat());
        assert_eq!((ran.code, ran.stderr.lines().next()), (Some(2), Some(why)));
    };
    let sizes = "write the width, x, the height, both at least 1: 640x480";
    for size in ["0x0", "7", "1x", "-1x5", "1x2x3"] {
        let size = format!("--size={size}");
        let value = &size["--size=".len()..];
        usage(&[&size], &format!("error: invalid value '{value}' for '--size <WxH>': {sizes}"));
    }
    let frames = "error: invalid value '5-2' for '--frames <FIRST-LAST[xSTEP]>': 5 comes after 2; write 2-5";
    usage(&["--frames", "5-2"], frames);
    assert_eq!(desk.files(), ["file", "g.json"]);
}

#[test]
fn graphs_with_no_or_several_outputs() {
    let desk = Desk::new();
    let save = r#""save": { "type": "save_image", "path": "out/ball.exr" }"#;
    let other = r#""other": { "type": "save_image", "path": "out/ball.exr" }"#;
    desk.write(
        "both.json",
        GRAPH.replace(save, &format!("{save}, {other}")).replace(
            "march.image -> save.image",
            "march.image -> save.image\", \"march.image -> other.image",
        ),
    );
    desk.run_blind(&["render", "both.json", "-o", "x.exr"]).refused(
        "error: the graph has several save_image nodes (save, other); say with --node which of them -o is for\n",
    );
    desk.run_blind(&["render", "both.json"]).refused(
        "error: 'save' and 'other' both write out/ball.exr; give them two paths, or choose one with --node\n",
    );
    let none = GRAPH.replace(&format!(",\n    {save}"), "").replace(", \"march.image -> save.image\"", "");
    desk.write("none.json", &none);
    desk.run_blind(&["render", "none.json"])
        .refused("error: the graph has no save_image node; say where to write with -o picture.exr\n");
    desk.write("dark.json", r#"{ "tyndall": 1, "nodes": { "sun": { "type": "sun" } } }"#);
    desk.run_blind(&["render", "dark.json", "-o", "x.exr"])
        .refused("error: no node of the graph gives an image; add a raymarch\n");
    desk.run_blind(&["render", "dark.json", "--node", "sun", "-o", "x.exr"])
        .refused("error: --node 'sun' gives no image, nor does another node; add a raymarch\n");
    if has_adapter() {
        desk.run(&["render", "none.json", "-o", "x.exr"]).done();
        desk.run(&["render", "both.json", "--node", "other", "-o", "y.exr"]).done();
        assert_eq!(desk.files(), ["both.json", "dark.json", "g.json", "none.json", "x.exr", "y.exr"]);
        assert_eq!(fs::read(desk.path("x.exr")).unwrap(), fs::read(desk.path("y.exr")).unwrap());
    }
}

#[test]
fn words_that_are_no_subcommand() {
    let desk = Desk::new();
    desk.run_blind(&["rendr", "g.json"]).refused(
        "error: there is no subcommand 'rendr'; did you mean 'render'? allowed are render, explain, inspect, compare, \
         nodes, new, doctor\n",
    );
}

#[test]
fn the_editor_is_named_in_the_help_and_has_one_graph() {
    let desk = Desk::new();
    let help = desk.run_blind(&["--help"]);
    assert_eq!(help.code, Some(0));
    assert!(help.stdout.contains("Usage: tyndall [GRAPH | VOLUME | FOLDER]"), "{}", help.stdout);
    assert!(help.stdout.contains("tyndall cloud.vdb"), "{}", help.stdout);
    desk.run_blind(&["g.json", "--set", "medium.g=0"]).refused(
        "error: the editor is opened on one graph or volume; leave out --set medium.g=0, or name a subcommand first, such as \
         render\n",
    );
}

#[test]
fn a_file_that_is_not_there_is_no_subcommand() {
    let ran = Desk::new().run_blind(&["none.vdb"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("none.vdb: no such file or folder: check the path"), "{}", ran.stderr);
}

#[test]
fn no_display() {
    let desk = Desk::new();
    // Elsewhere a window needs no variable.
    if !cfg!(target_os = "linux") {
        eprintln!("skipped: not Linux");
        return;
    }
    let message = "error: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); to render without a window, \
                   type `tyndall render GRAPH -o picture.png`\n";
    desk.run_blind(&["g.json"]).refused(message);
    desk.run_blind(&[]).refused(message);
    let ran = desk.run_blind(&["none.json"]);
    assert!(ran.stderr.starts_with("error: cannot read the graph 'none.json': "), "{}", ran.stderr);
}

#[test]
fn no_driver_at_all() {
    let desk = Desk::new();
    // Only Vulkan's drivers can be hidden.
    if !cfg!(target_os = "linux") {
        eprintln!("skipped: not Linux");
        return;
    }
    desk.run_blind(&["render", "g.json"]).refused(
        "error: no Vulkan, Metal or DX12 driver was found: install one (Debian or Ubuntu without a GPU: apt-get \
         install mesa-vulkan-drivers), then try `tyndall doctor`\n",
    );
    assert_eq!(desk.files(), ["g.json"]);
    let ran = desk.run_blind(&["doctor"]);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(2), ""));
    assert!(ran.stdout.contains("`apt-get install mesa-vulkan-drivers`"), "{}", ran.stdout);
}

#[test]
fn volumes_that_cannot_be_read() {
    if !has_adapter() {
        return;
    }
    let desk = Desk::new();
    desk.write_graph("g.json", BALL, r#""type": "load_vdb", "path": "none.vdb""#);
    let bytes = small_vdb();
    desk.write("cut.vdb", &bytes[..bytes.len() / 2]);
    desk.write("whole.vdb", &bytes);
    desk.run(&["render", "g.json"]).refused(
        "g.json: node 'ball': none.vdb: no such file or folder: check the path; one in a graph starts at the graph's folder\n",
    );
    let ran = desk.run(&["render", "g.json", "--set", "ball.path=cut.vdb"]);
    let line = ran.stderr.strip_suffix('\n').unwrap();
    assert!(line.starts_with("g.json: node 'ball': ") && !line.contains('\n'), "{line}");
    let end = format!("but the file ends at {}: it is cut short, copy it again", bytes.len() / 2);
    assert!(ran.code == Some(2) && line.ends_with(&end), "{line}");
    let ran = desk.run(&["render", "g.json", "--set", "ball.path=whole.vdb", "--set", "medium.density=fog"]);
    let end = "whole.vdb: no grid `fog`; there are `density`\n";
    assert!(ran.code == Some(2) && ran.stderr.starts_with("g.json: node 'medium': "), "{}", ran.stderr);
    assert!(ran.stderr.ends_with(end), "{}", ran.stderr);
    assert_eq!(desk.files(), ["cut.vdb", "g.json", "whole.vdb"]);
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk() {
    if !has_adapter() {
        return;
    }
    let desk = Desk::new();
    std::os::unix::fs::symlink("/dev/full", desk.path("full.exr")).unwrap();
    let ran = desk.run(&["render", "g.json", "-o", "full.exr"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""));
    assert!(ran.stderr.starts_with("g.json: node 'save': cannot write "), "{}", ran.stderr);
    assert!(
        ran.stderr.contains("No space left on device") && ran.stderr.lines().count() == 1,
        "{}",
        ran.stderr
    );
    // Results on a full disk: an error, not a panic.
    let full = || Stdio::from(fs::OpenOptions::new().write(true).open("/dev/full").unwrap());
    let ran = Ran::of(desk.command(&["nodes"]).stdout(full()).output().unwrap());
    ran.refused("error: cannot write to stdout: No space left on device (os error 28)\n");
}
