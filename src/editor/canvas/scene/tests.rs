use std::path::Path;

use super::*;
use crate::nodes::catalog;

const TEXT: &str = r#"{"tyndall": 1, "nodes": {"sun": {"type": "sun"}, "split": {"type": "light_decomposition"},
    "odd": {"type": "unheard_of"}}, "wires": ["sun.light -> split.lights", "odd.thing -> split.nothing"],
    "layout": {"sun": [0, 0], "split": [300, 50]}, "bends": {"sun.light -> split.lights": [[250, -40]]}}"#;

fn scene() -> Scene {
    Scene::new(&Document::parse(TEXT, Path::new("")).unwrap(), catalog(), &HashSet::new())
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
