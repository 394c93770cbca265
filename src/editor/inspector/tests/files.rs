//! Files picked in a dialog.

use super::*;

#[test]
fn files_are_picked_in_a_dialog() {
    let mut harness = on(json!({ "type": "load_vdb", "path": "../data/plume.vdb" }));
    assert!(!says(&harness, "Choose n.path"));
    node(&harness, "n.path pick").click();
    // The dialog reads its folder on a thread and asks for frames meanwhile.
    harness.run_steps(4);
    assert!(says(&harness, "Choose n.path"));
    harness.key_press(Key::Escape);
    harness.run_steps(4);
    assert!(!says(&harness, "Choose n.path"));
}

#[test]
fn what_is_picked_is_written_relative_to_the_graph() {
    let mut harness = on(json!({ "type": "load_vdb", "path": "../data/plume.vdb" }));
    harness.set_size(vec2(1100.0, 900.0));
    harness.run_steps(2);
    node(&harness, "n.path pick").click();
    for part in ["checker.vdb", "🗀  Open"] {
        let start = std::time::Instant::now();
        while !says(&harness, part) {
            assert!(start.elapsed().as_secs() < 20, "'{part}' is not offered");
            std::thread::sleep(std::time::Duration::from_millis(10));
            harness.run_steps(2);
        }
        harness.query_all_by_label_contains(part).next().unwrap().click();
        harness.run_steps(4);
    }
    assert_eq!(param(&harness, "path"), json!("../data/checker.vdb"));
    assert!(!says(&harness, "Choose n.path"));
    harness.state_mut().undo();
    assert_eq!(param(&harness, "path"), json!("../data/plume.vdb"));
}
