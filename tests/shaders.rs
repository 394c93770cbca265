//! Every shader that can be dispatched is valid, with all choices that Rust makes of it.
//!
//! That structs agree with their mirrors in Rust is tested beside each node.

use tyndall::gpu::{Shader, shader_names, shader_text};

/// The values that stages fill in for a name in braces.
const CHOICES: &[(&str, &[&str])] = &[
    ("channels", &["1", "3"]),
    ("format", &["r32float", "rgba16float", "rgba32float"]),
    ("pack", &["1", "4"]),
    ("n_beams", &["0u", "2u", "params.n_beams"]),
    ("voxels", &["true", "false"]),
    ("points", &["true", "false"]),
    ("peak", &["true", "false"]),
    ("residual", &["true", "false"]),
    ("narrow", &["true", "false"]),
    ("directions", &["16", "64"]),
];

/// All ways to fill in the names that the text asks for.
fn ways(text: &str) -> Vec<Vec<(&'static str, String)>> {
    let mut ways = vec![Vec::new()];
    for (name, values) in CHOICES.iter().filter(|(name, _)| text.contains(&format!("{{{name}}}"))) {
        let with = |way: &Vec<(&'static str, String)>, value: &&str| {
            way.iter().cloned().chain([(*name, (*value).to_owned())]).collect()
        };
        ways = ways
            .iter()
            .flat_map(|way| values.iter().map(|value| with(way, value)).collect::<Vec<_>>())
            .collect();
    }
    ways
}

/// The text of a shader and of all that it imports.
fn with_imports(name: &str) -> String {
    let mut text = String::new();
    let mut to_read = vec![name.to_owned()];
    while let Some(name) = to_read.pop() {
        let file = shader_text(&name.replace("{channels}", "1").replace("{pack}", "1")).unwrap();
        let imports = file.lines().filter_map(|line| line.strip_prefix("#import "));
        to_read.extend(imports.map(|import| import.trim().trim_matches('"').to_owned()));
        text += &file;
    }
    text
}

#[test]
fn every_entry_point_is_valid_in_all_its_forms() {
    let mut n_stages = 0;
    for name in shader_names() {
        let text = shader_text(&name).unwrap();
        if !text.contains("@compute") {
            continue;
        }
        n_stages += 1;
        for way in ways(&with_imports(&name)) {
            let shader = Shader::expand(&name, &way).unwrap();
            let module = shader.validate().unwrap_or_else(|error| panic!("{way:?}: {error}"));
            assert_eq!(module.entry_points.len(), 1, "{name} {way:?}");
        }
    }
    assert!(n_stages > 10, "{n_stages} stages: are the shaders found?");
}

#[test]
fn choices_multiply() {
    assert_eq!(ways("none").len(), 1);
    assert_eq!(ways("spectrum_{channels}.wgsl").len(), 2);
    assert_eq!(ways("{channels} {format}").len(), 6);
}

#[test]
fn errors_name_the_file_and_line_of_the_source() {
    // Without its choice the import is no file.
    let error = Shader::expand("raymarch.wgsl", &[]).unwrap_err().to_string();
    assert!(error.starts_with("raymarch.wgsl:"), "{error}");
    let error = Shader::expand("nothing.wgsl", &[]).unwrap_err().to_string();
    assert!(error.contains("no shader file 'nothing.wgsl'"), "{error}");
}
