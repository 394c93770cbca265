use std::path::Path;

use super::*;
use crate::nodes::catalog;

const TEXT: &str = r#"{"tyndall": 1, "nodes": {"sun": {"type": "sun"}, "split": {"type": "light_decomposition"},
    "odd": {"type": "unheard_of"}}, "wires": ["sun.light -> split.lights", "odd.thing -> split.nothing"],
    "layout": {"sun": [0, 0], "split": [300, 50]}, "bends": {"sun.light -> split.lights": [[250, -40]]}}"#;

fn scene() -> Scene {
    Scene::new(&Document::parse(TEXT, Path::new("")).unwrap(), catalog())
}

#[test]
fn ports_stand_at_the_edges_of_their_nodes() {
    let scene = scene();
    for node in &scene.nodes {
        for port in &node.ports {
            let edge = if port.port.side == Side::Input { node.rect.left() } else { node.rect.right() };
            assert_eq!(port.at.x, edge);
            assert!(node.rect.y_range().contains(port.at.y), "{}", port.port.label());
            assert_eq!(scene.port_at(port.at + vec2(3.0, 3.0), 6.0).unwrap().port, port.port);
        }
        assert_eq!(scene.node_at(node.rect.center()).unwrap().name, node.name);
    }
    assert!(scene.port_at(pos2(-500.0, 0.0), 14.0).is_none());
    // What only wires name is there too, to be pulled off.
    let odd = scene.port(&Port { end: "split.nothing".parse().unwrap(), side: Side::Input }).unwrap();
    assert_eq!((odd.kind, odd.is_wired), (None, true));
    // A node without a place stands below those that have one.
    assert!(scene.node("odd").unwrap().rect.top() > scene.node("split").unwrap().rect.bottom());
}

#[test]
fn wires_pass_through_their_ends_and_bends() {
    let scene = scene();
    let wire = &scene.wires[0];
    let line = curve(&wire.points, 1.0, 24);
    assert_eq!(wire.points.len(), 3);
    for (place, point) in [(0, 0), (24, 1), (48, 2)] {
        // The weights of a cubic at its ends are 0 and 1 but for rounding, of coordinates below 1e3 in f32.
        assert!((line[place] - wire.points[point]).length() < 1e-3);
    }
    assert!(line.iter().all(|point| wire.bounds().expand(1e-3).contains(*point)));
    assert_eq!(scene.wire_at(line[13] + vec2(0.0, 2.0), 5.0).unwrap().wire, wire.wire);
    assert!(scene.wire_at(line[13] + vec2(0.0, 300.0), 5.0).is_none());
}

#[test]
fn distances_to_a_line() {
    let line = [pos2(0.0, 0.0), pos2(10.0, 0.0), pos2(10.0, 10.0)];
    let far = |x, y| distance(&line, pos2(x, y));
    assert_eq!((far(5.0, 3.0), far(-3.0, 4.0), far(12.0, 5.0)), (3.0, 5.0, 2.0));
}

/// Presets and the graph of a dropped volume are laid out by hand, with room for the pictures that come.
#[test]
fn no_node_of_a_preset_lies_on_another() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut documents: Vec<(String, Document)> = files
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .map(|path| (path.display().to_string(), Document::load(&path).unwrap()))
        .collect();
    assert!(documents.len() > 5);
    let steam = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/steam.vdb");
    let lit = crate::template::new_graph(&crate::template::measure(&steam, true).unwrap());
    documents.push(("a dropped volume".to_owned(), lit));
    for (from, document) in documents {
        let scene = Scene::new(&document, catalog());
        for (idx, node) in scene.nodes.iter().enumerate() {
            for other in &scene.nodes[..idx] {
                let lies_on = node.rect.expand(3.0).intersects(other.rect.expand(3.0));
                assert!(!lies_on, "{from}: {} lies on {}", node.name, other.name);
            }
        }
    }
}
