//! Closed forms, and a file of known values.

use super::*;
use crate::graph::{Target, check};
use crate::volume::grid::Grid;
use crate::volume::vdb::{WriteOptions, write};

fn figures() -> VolumeFigures {
    VolumeFigures {
        path: "/cache/smoke_####.vdb".into(),
        grid: "soot".to_owned(),
        mean: 0.5,
        bounds: [DVec3::new(-1.0, 0.0, -2.0), DVec3::new(3.0, 2.0, 6.0)],
    }
}

#[test]
fn the_shortest_way_through_the_middle_has_the_depth() {
    let document = new_graph(&figures());
    let medium = &document.nodes["medium"].params;
    // 8 / (0.5 · 2).
    assert_eq!((&medium["density_scale"], &medium["density"]), (&json!(8.0), &json!("soot")));
    assert_eq!(document.nodes["volume"].params["path"], "/cache/smoke_####.vdb");
    assert_eq!(check(&document, catalog(), Target::Sinks).len(), 0);
}

// Places are rounded to a thousandth of the shortest edge: 0.002 of a distance of 17.
#[test]
fn the_box_fills_the_view() {
    let document = new_graph(&figures());
    let camera = &document.nodes["camera"].params;
    let place = |name: &str| DVec3::from_array(serde_json::from_value(camera[name].clone()).unwrap());
    assert!(place("look_at").distance(DVec3::new(1.0, 1.0, 2.0)) < 0.002);
    let radius = 0.5 * DVec3::new(4.0, 2.0, 8.0).length();
    let half = (0.5 * 35.0_f64).to_radians();
    let distance = place("position").distance(place("look_at"));
    assert!((distance - radius / (half * FILL).sin()).abs() < 0.004, "{distance}");
}

#[test]
fn a_file_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    // 4 x 2 x 2 voxels of 0.5 m, one of them 3, the others 1: mean 18/16.
    let mut values = vec![1.0; 16];
    values[5] = 3.0;
    let scale = DMat4::from_scale(DVec3::splat(0.5));
    let grid = Grid::from_dense("soot", 0.0, scale, IVec3::new(2, 0, 0), [4, 2, 2], &values);
    let path = |n: usize| folder.path().join(format!("a_{n:04}.vdb"));
    write(&path(1), std::slice::from_ref(&grid), WriteOptions::default()).unwrap();
    let found = measure(&path(1), true).unwrap();
    assert_eq!((found.path.as_path(), found.grid.as_str(), found.mean), (path(1).as_path(), "soot", 1.125));
    assert_eq!(found.bounds, [DVec3::new(0.75, -0.25, -0.25), DVec3::new(2.75, 0.75, 0.75)]);
    // With another frame beside it, it is part of a sequence.
    write(&path(2), &[grid], WriteOptions::default()).unwrap();
    let pattern = folder.path().join("a_####.vdb");
    assert_eq!(measure(&path(2), true).unwrap().path, pattern);
    assert_eq!(measure(&path(2), false).unwrap().path, path(2));
    assert_eq!(measure(folder.path(), true).unwrap().path, pattern);
    assert!(measure(&folder.path().join("none.vdb"), true).is_err());
}

#[test]
fn a_preset_without_a_file_is_refused() {
    assert!(matches!(fit(Document::default(), &figures()), Err(TemplateError::NoLoader)));
}
