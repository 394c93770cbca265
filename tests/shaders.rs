//! Every shader that can be dispatched is valid, with all choices that Rust makes of it.
//!
//! That structs agree with their mirrors in Rust is tested beside each node, and so are constants that only one
//! node has. Those that a module of Rust owns, or mathematics, are held against it here.

use std::f64::consts::PI;

use tyndall::gpu::{Shader, shader_names, shader_text, wgsl_constant};
use tyndall::light::environment::{STACK_TURNS, STACK_X};
use tyndall::optics::peak;

/// A part of a shader that is there or not.
const SWITCH: &[&str] = &["true", "false"];

/// The values that stages fill in for a name in braces.
const CHOICES: &[(&str, &[&str])] = &[
    ("channels", &["1", "3"]),
    ("format", &["r32float", "rgba16float", "rgba32float"]),
    ("pack", &["1", "4"]),
    ("n_beams", &["0u", "2u", "params.n_beams"]),
    ("voxels", SWITCH),
    ("points", SWITCH),
    ("peak", SWITCH),
    ("residual", SWITCH),
    ("window", SWITCH),
    ("stack", SWITCH),
    ("surfaces", SWITCH),
    ("shadows", SWITCH),
    ("gathered", SWITCH),
    ("widening", SWITCH),
    ("radial", SWITCH),
    ("narrow", SWITCH),
    ("emission", SWITCH),
    ("returns", SWITCH),
    ("beams", SWITCH),
    ("sums", SWITCH),
    ("grey", SWITCH),
    ("lobes", SWITCH),
    ("skips", SWITCH),
    ("skips_dark", SWITCH),
    ("glows", SWITCH),
    ("whole", SWITCH),
    ("singles", SWITCH),
    ("depths", SWITCH),
    ("walls", SWITCH),
    ("directions", &["4", "16", "64"]),
    ("least_anisotropy", &["0.1"]),
    ("least_share", &["1e-5"]),
    ("least_power", &["1e-30"]),
];

/// Ways to fill in the names that the text asks for: all products of those with many values; of those that are
/// true or false, all true, all false, and each one false alone.
fn ways(text: &str) -> Vec<Vec<(&'static str, String)>> {
    let asked = |(name, _): &&(&'static str, &[&str])| text.contains(&format!("{{{name}}}"));
    let (switches, many): (Vec<_>, Vec<_>) =
        CHOICES.iter().filter(asked).partition(|(_, values)| *values == SWITCH);
    let mut ways = vec![Vec::new()];
    for &(name, values) in many {
        let with = |way: &Vec<(&'static str, String)>, value: &&str| {
            way.iter().cloned().chain([(name, (*value).to_owned())]).collect()
        };
        ways = ways
            .iter()
            .flat_map(|way| values.iter().map(|value| with(way, value)).collect::<Vec<_>>())
            .collect();
    }
    let on = |is_on: &dyn Fn(usize) -> bool| -> Vec<(&'static str, String)> {
        switches.iter().enumerate().map(|(idx, (name, _))| (*name, is_on(idx).to_string())).collect()
    };
    let mut settings = vec![on(&|_| true)];
    if !switches.is_empty() {
        settings.push(on(&|_| false));
        settings.extend((0..switches.len()).map(|off| on(&|idx| idx != off)));
    }
    ways.iter()
        .flat_map(|way| settings.iter().map(|set| [way.clone(), set.clone()].concat()).collect::<Vec<_>>())
        .collect()
}

/// The text of a shader and of all that it imports.
fn with_imports(name: &str) -> String {
    let mut text = String::new();
    let mut to_read = vec![name.to_owned()];
    while let Some(name) = to_read.pop() {
        let name = name.replace("{channels}", "3").replace("{pack}", "1").replace("{walls}", "true");
        let file = shader_text(&name).unwrap();
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

/// What a shader, with any of its choices, declares as a constant.
fn constant(shader: &str, name: &str) -> Vec<f64> {
    let shader = Shader::expand(shader, &ways(&with_imports(shader))[0]).unwrap();
    wgsl_constant(&shader, name).unwrap()
}

#[test]
fn constants_are_those_of_rust() {
    let table = [peak::COLUMNS as f64, peak::ROWS as f64];
    assert_eq!(constant("raymarch.wgsl", "PEAK_SIZE"), table);
    assert_eq!(constant("raymarch.wgsl", "PEAK_X_MAX"), [peak::X_MAX]);
    assert_eq!(constant("raymarch.wgsl", "STACK_LEVELS"), [STACK_X.len() as f64]);
    assert_eq!(constant("raymarch.wgsl", "STACK_TURNS"), [STACK_TURNS as f64]);
    assert_eq!(constant("lib/half.wgsl", "LARGEST_HALF"), [half::f16::MAX.to_f64()]);
    assert_eq!(constant("tone_map.wgsl", "F32_MAX"), [f64::from(f32::MAX)]);
    let f32s = |x: f64| [f64::from(x as f32)];
    assert_eq!(constant("lib/phase.wgsl", "PI"), f32s(PI));
    assert_eq!(constant("lib/phase.wgsl", "FOUR_PI"), f32s(4.0 * PI));
    let n_directions = constant("isotropic_residual/uncollided.wgsl", "N_DIRECTIONS")[0];
    assert_eq!(constant("isotropic_residual/uncollided.wgsl", "WEIGHT"), f32s(4.0 * PI / n_directions));
}

#[test]
fn a_constant_that_is_not_there_is_an_error() {
    let shader = Shader::expand("lib/phase.wgsl", &[]).unwrap();
    let error = wgsl_constant(&shader, "TAU").unwrap_err().to_string();
    assert!(error.contains("no number or vector TAU"), "{error}");
}

#[test]
fn choices_multiply() {
    assert_eq!(ways("none").len(), 1);
    assert_eq!(ways("spectrum_{channels}.wgsl").len(), 2);
    assert_eq!(ways("{channels} {format}").len(), 6);
    assert_eq!(ways("{channels} {peak} {points}").len(), 2 * 4);
}

#[test]
fn errors_name_the_file_and_line_of_the_source() {
    // Without its choice the import is no file.
    let error = Shader::expand("raymarch.wgsl", &[]).unwrap_err().to_string();
    assert!(error.starts_with("raymarch.wgsl:"), "{error}");
    let error = Shader::expand("nothing.wgsl", &[]).unwrap_err().to_string();
    assert!(error.contains("no shader file 'nothing.wgsl'"), "{error}");
}
