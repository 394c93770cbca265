//! What has room, and pictures to look at.

use super::*;

#[test]
fn units_stand_in_whole_at_the_usual_width() {
    let node_of = |type_id: &str| match type_id {
        "medium" => json!({ "type": type_id, "emission": {}, "density_scale": 12 }),
        _ => json!({ "type": type_id }),
    };
    let mut n_units = 0;
    for spec in crate::nodes::catalog().0 {
        let mut harness = on(node_of(spec.id));
        harness.set_size(vec2(crate::editor::settings::Settings::default().inspector_width, 3000.0));
        harness.run();
        let members = spec.params.iter().flat_map(|param| match param.kind {
            crate::graph::ParamKind::Record(members) => members,
            _ => std::slice::from_ref(param),
        });
        for unit in members.map(|param| param.unit).filter(|unit| !unit.is_empty()) {
            let font = egui::TextStyle::Body.resolve(&harness.ctx.global_style());
            let whole = harness.ctx.fonts_mut(|fonts| {
                fonts.layout_no_wrap(unit.to_owned(), font, egui::Color32::WHITE).size().x
            });
            for label in harness.query_all_by_label(unit) {
                let width = label.rect().width();
                assert!(width >= whole - 0.6, "{unit} of {} has {width} of {whole} points", spec.id);
                n_units += 1;
            }
        }
    }
    assert!(n_units > 30, "{n_units}");
}

/// For looking: `cargo test inspector::tests::looks::pictures -- --ignored` writes PNG files to `out/`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures() {
    let out = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("out");
    std::fs::create_dir_all(&out).unwrap();
    let points = json!([[0, 0.1, 0, 0.3, 0], [0.3, 0.9, 0.2, 0.2, 0.2], [1, 1, 0.9, 0.6, 1]]);
    let nodes = json!({
        "cloud": { "type": "load_vdb", "path": "../data/plume.vdb" },
        "medium": { "type": "medium", "g": { "keys": [[12, 0.5], [20, 0.7]] }, "density_scale": 12, "emission": {} },
        "sun": { "type": "sun", "direction": [0.3, -0.4, 0.86], "irradiance": [20, 18, 15] },
        "look": { "type": "transfer_function", "points": points },
        "camera": { "type": "camera" }
    });
    for name in ["medium", "sun", "look", "camera", "cloud"] {
        for theme in [egui::Theme::Light, egui::Theme::Dark] {
            let mut harness = inspector(nodes.clone(), json!(["cloud.volume -> medium.volume"]), &[name]);
            harness.ctx.set_theme(theme);
            harness.set_size(vec2(320.0, 860.0));
            harness.run();
            if name == "medium" {
                type_into(&mut harness, "medium.density_scale", "-1");
            }
            let picture = harness.render().unwrap();
            picture.save(out.join(format!("inspector_{name}_{theme:?}.png"))).unwrap();
        }
    }
}
