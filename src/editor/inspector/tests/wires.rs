//! Wires, nodes in groups, and the ports of groups.

use super::*;

#[test]
fn ports_lead_to_what_they_are_wired_to() {
    let nodes =
        json!({ "cloud": { "type": "shape" }, "n": { "type": "medium" }, "march": { "type": "raymarch" } });
    let mut harness =
        inspector(nodes, json!(["cloud.volume -> n.volume", "n.medium -> march.medium"]), &["n"]);
    click(&mut harness, "march.medium");
    assert_eq!(harness.state().asked.as_deref(), Some("march"));
    click(&mut harness, "cloud.volume");
    assert_eq!(harness.state().asked.as_deref(), Some("cloud"));
    // Wired without a mouse on the canvas.
    let wires = |harness: &Inspector| harness.state().project.document().wires.len();
    click(&mut harness, "wires of input n.volume");
    click(&mut harness, "Unplug cloud.volume");
    assert_eq!(wires(&harness), 1);
    click(&mut harness, "wires of input n.volume");
    assert!(!says(&harness, "Connect march"));
    click(&mut harness, "Connect cloud.volume");
    assert_eq!(wires(&harness), 2);
    let nodes = json!({ "n": { "type": "medium" } });
    let harness = inspector(nodes, json!([]), &["n"]);
    assert!(
        says(&harness, "empty: wire an output of type volume to it") && says(&harness, "read by nothing")
    );
}

/// A group of two media, and a march that reads one of them.
fn group(selected: &[&str]) -> Inspector {
    let inside = json!({
        "type": "group", "nodes": { "a": { "type": "medium", "density": "x" }, "b": { "type": "medium" } },
        "wires": [], "inputs": { "volume": ["a.volume", "b.volume"] }, "outputs": { "medium": "a.medium" }
    });
    let nodes = json!({ "cloud": { "type": "load_vdb", "path": "../data/plume.vdb" }, "group": inside,
        "march": { "type": "raymarch" } });
    let wires = json!(["cloud.volume -> group.volume", "group.medium -> march.medium"]);
    inspector(nodes, wires, selected)
}

#[test]
fn nodes_in_groups_are_edited() {
    let mut harness = group(&["group/b", "group/a"]);
    assert!(says(&harness, "2 nodes are edited together"));
    type_into(&mut harness, "group/a.g", "0.5");
    let g = |harness: &Inspector, path: &str| {
        harness.state().project.document().node(path).unwrap().params.get("g").cloned()
    };
    assert_eq!((g(&harness, "group/a"), g(&harness, "group/b")), (Some(json!(0.5)), Some(json!(0.5))));
    // The file is found through the group's port.
    click(&mut harness, "group/a.density menu");
    assert!(says(&harness, "density   float"));
    harness.key_press(Key::Escape);
    harness.run();
    assert!(says(&harness, "input of the group: volume"));
    let mut harness = group(&["group/b"]);
    click(&mut harness, "wires of output b.medium");
    click(&mut harness, "Expose as a port of the group");
    let inside = harness.state().project.document().inside("group").unwrap();
    assert_eq!(inside.outputs["b_medium"].to_string(), "b.medium");
    assert!(says(&harness, "output of the group: b_medium"));
    // Of a graph there are no ports to make.
    let mut harness = on(json!({ "type": "medium" }));
    click(&mut harness, "wires of output n.medium");
    assert!(!says(&harness, "Expose"));
}

#[test]
fn ports_of_a_group_are_renamed_ordered_and_removed() {
    let mut harness = group(&["group"]);
    type_into(&mut harness, "group input volume", "cloud");
    let wires = |harness: &Inspector| {
        let wires = &harness.state().project.document().wires;
        wires.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(wires(&harness), ["cloud.volume -> group.cloud", "group.medium -> march.medium"]);
    type_into(&mut harness, "group input cloud", "a b");
    assert!(says(&harness, "'a b' is no name of a port"));
    harness.state_mut().project.edit("expose", |document| {
        let inside = document.inside_mut("group").unwrap();
        inside
            .expose(crate::nodes::catalog(), crate::graph::Side::Output, &"b.medium".parse().unwrap())
            .unwrap();
    });
    harness.run();
    let outputs = |harness: &Inspector| {
        let inside = harness.state().project.document().inside("group").unwrap();
        inside.outputs.keys().cloned().collect::<Vec<_>>()
    };
    click(&mut harness, "group output b_medium up");
    assert_eq!(outputs(&harness), ["b_medium", "medium"]);
    click(&mut harness, "group output b_medium down");
    assert_eq!(outputs(&harness), ["medium", "b_medium"]);
    click(&mut harness, "group output medium remove");
    assert_eq!((outputs(&harness).len(), wires(&harness).len()), (1, 1));
    click(&mut harness, "a.volume");
    assert_eq!(harness.state().asked.as_deref(), Some("group/a"));
    // Rename, expose, up, down, remove.
    for _ in 0..5 {
        harness.state_mut().undo();
    }
    assert!(harness.state_mut().project.undo().is_none());
}

#[test]
fn the_keyboard_comes_to_the_heading() {
    let mut harness = on(json!({ "type": "medium" }));
    harness.state_mut().takes_keyboard = true;
    harness.run_steps(2);
    assert!(node(&harness, "inspector of n").is_focused());
    // The opened group where no node is selected.
    let mut harness = group(&[]);
    assert!(says(&harness, "Select a node"));
    harness.state_mut().opened = "group".to_owned();
    harness.run();
    assert!(harness.query_by_label("group input volume").is_some());
}
