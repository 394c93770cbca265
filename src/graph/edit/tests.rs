use serde_json::json;

use super::*;
use crate::graph::toy::CATALOG;

const TEXT: &str = r#"{"tyndall": 1, "nodes": {"medium": {"type": "medium", "g": 0.5}, "shape": {"type": "shape"},
    "save": {"type": "save"}, "odd": {"type": "od"}}}"#;

fn document() -> Document {
    Document::parse(TEXT, Path::new("graphs")).unwrap()
}

/// The value that is in the document after `text` was set.
fn set(name: &str, text: &str) -> Json {
    let mut document = document();
    document.set(CATALOG, name, text).unwrap();
    let (node, field) = name.split_once('.').unwrap();
    document.nodes[node].params[field].clone()
}

fn error(name: &str, text: &str) -> String {
    let mut document = document();
    let error = document.set(CATALOG, name, text).expect_err("a mistake");
    assert_eq!(document, self::document(), "changed by an error");
    error.to_string()
}

#[test]
fn values_of_each_form() {
    assert_eq!(set("medium.g", "-0.25"), json!(-0.25));
    assert_eq!(set("medium.albedo", "[1, 0.5, 0]"), json!([1, 0.5, 0]));
    assert_eq!(set("medium.albedo", "1"), json!(1));
    assert_eq!(set("medium.density", "smoke"), json!("smoke"));
    assert_eq!(set("medium.density", "\"5\""), json!("5"));
    assert_eq!(set("medium.density", "NaN"), json!("NaN"));
    assert_eq!(set("shape.kind", "cloud"), json!("cloud"));
    assert_eq!(set("shape.loop", "true"), json!(true));
    assert_eq!(set("shape.frame", "null"), json!(null));
    assert_eq!(set("medium.emission", "{}"), json!({}));
}

#[test]
fn members_of_a_record() {
    let mut document = document();
    document.set(CATALOG, "medium.emission.flame", "heat").unwrap();
    document.set(CATALOG, "medium.emission.temperature", "t").unwrap();
    assert_eq!(document.nodes["medium"].params["emission"], json!({"flame": "heat", "temperature": "t"}));
    document.set(CATALOG, "medium.emission", "null").unwrap();
    document.set(CATALOG, "medium.emission.flame", "x").unwrap();
    assert_eq!(document.nodes["medium"].params["emission"], json!({"flame": "x"}));
}

#[test]
fn paths_start_at_the_working_directory() {
    let here = std::env::current_dir().unwrap();
    let expected = here.join("out/a.exr");
    assert_eq!(set("save.path", "out/a.exr"), json!(expected));
    assert_eq!(set("save.path", "\"out/a.exr\""), json!(expected));
    assert_eq!(set("save.path", "/out.exr"), json!("/out.exr"));
}

#[test]
fn names_that_are_not_there() {
    assert_eq!(error("g", "1"), "'g' names no parameter; write node.parameter=value");
    assert_eq!(
        error("medum.g", "1"),
        "cannot set 'medum.g': there is no such node; did you mean 'medium'? nodes are medium, \
         shape, save, odd"
    );
    assert_eq!(
        error("odd.g", "1"),
        "cannot set 'odd.g': unknown type 'od'; allowed are number, sum, pair, paint, save, file, \
         shape, medium, fade"
    );
    assert_eq!(
        error("medium.albdo", "1"),
        "cannot set 'medium.albdo': unknown parameter 'albdo'; did you mean 'albedo'? allowed are \
         density, albedo, g, emission"
    );
    assert_eq!(
        error("medium.emission.flam", "1"),
        "cannot set 'medium.emission.flam': unknown parameter 'emission.flam'; did you mean 'flame'? \
         allowed are temperature, flame"
    );
    assert_eq!(
        error("medium.g.x", "1"),
        "cannot set 'medium.g.x': 'g' has no member 'x'; it is a number, -1 < value < 1"
    );
}

#[test]
fn values_that_are_not_allowed() {
    assert_eq!(
        error("medium.g", "NaN"),
        "cannot set 'medium.g': \"NaN\" is not valid JSON; write a number, -1 < value < 1"
    );
    assert_eq!(
        error("medium.g", "-Infinity"),
        "cannot set 'medium.g': \"-Infinity\" is not valid JSON; write a number, -1 < value < 1"
    );
    assert_eq!(
        error("medium.g", "1e999"),
        "cannot set 'medium.g': \"1e999\" is not valid JSON; write a number, -1 < value < 1"
    );
    assert_eq!(
        error("medium.g", "1"),
        "cannot set 'medium.g': g = 1 is outside -1 < value < 1; the default is 0"
    );
    assert_eq!(
        error("medium.albedo", "[2, 0, 3]"),
        "cannot set 'medium.albedo': albedo[0] = 2 is outside 0..=1; the default is [1,1,1]; also \
         albedo[2] = 3 is outside 0..=1; the default is [1,1,1]"
    );
    assert_eq!(
        error("medium.density", "5"),
        "cannot set 'medium.density': density is 5; write a string; in quotes it is one: '\"5\"'"
    );
    assert_eq!(
        error("shape.kind", "ball"),
        "cannot set 'shape.kind': kind is 'ball'; allowed are sphere, box, cloud"
    );
    assert_eq!(error("save.path", ""), "cannot set 'save.path': path is empty; write a path as a string");
    assert_eq!(
        error("medium.emission", r#"{"flame": "a", "flame": "b"}"#),
        "cannot set 'medium.emission': \"{\\\"flame\\\": \\\"a\\\", \\\"flame\\\": \\\"b\\\"}\" is not \
         valid JSON; write an object with temperature, flame, or null"
    );
}
