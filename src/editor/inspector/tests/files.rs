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

/// Whether a picker offers this, once it has read its folder.
fn offers(harness: &mut Inspector, name: &str) -> bool {
    for _ in 0..100 {
        std::thread::sleep(std::time::Duration::from_millis(5));
        harness.run_steps(2);
        if says(harness, name) {
            return true;
        }
    }
    false
}

#[test]
fn what_can_be_read_is_offered_first() {
    let mut harness = on(json!({ "type": "load_vdb", "path": "../data/plume.vdb" }));
    harness.set_size(vec2(1100.0, 900.0));
    harness.run_steps(2);
    node(&harness, "n.path pick").click();
    assert!(offers(&mut harness, "checker.vdb") && !says(&harness, "sky.exr"));
    harness.get_by_value(".vdb").click();
    harness.run_steps(3);
    node(&harness, "All Files").click();
    assert!(offers(&mut harness, "sky.exr") && says(&harness, "checker.vdb"));
}

#[test]
fn what_is_written_keeps_its_name_in_the_dialog() {
    let mut harness = on(json!({ "type": "save_image", "path": "../out/smoke.png" }));
    harness.set_size(vec2(1100.0, 900.0));
    harness.run_steps(2);
    node(&harness, "n.path pick").click();
    harness.run_steps(4);
    let holds = |value: &str| harness.query_all_by_value(value).next().is_some();
    assert!(holds("smoke.png") && holds("PNG (.png)"));
}
