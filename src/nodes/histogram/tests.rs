use glam::DMat4;
use serde_json::{Value as Json, json};

use crate::graph::{PortType, Value};
use crate::image::{Image, Table};
use crate::nodes::testing::{gpu, run};
use crate::volume::{Dense, Volume};

/// 0 eight times, then 1, 2, 2, 3, 3, 3, 8 and one −2.
fn volume() -> Value {
    let values = [[0.0_f32; 8], [1.0, 2.0, 2.0, 3.0, 3.0, 3.0, 8.0, -2.0]].concat();
    let dense = Dense { dims: [4, 2, 2], values, world_from_index: DMat4::IDENTITY };
    Value::new(PortType::Volume, 0, Volume::from_shape(dense, None, DMat4::IDENTITY))
}

fn histogram(params: Json) -> Option<(Table, Image, Table)> {
    let values = run(gpu()?, "histogram", params, &[("volume", &volume())]).unwrap();
    Some((
        values[0].get::<Table>().clone(),
        values[1].get::<Image>().clone(),
        values[2].get::<Table>().clone(),
    ))
}

#[test]
fn every_value_has_its_bin() {
    let Some((table, _, summary)) = histogram(json!({ "bins": 5 })) else { return };
    assert_eq!(table.column("low").unwrap(), [-2.0, 0.0, 2.0, 4.0, 6.0]);
    assert_eq!(table.column("high").unwrap(), [0.0, 2.0, 4.0, 6.0, 8.0]);
    // 8 is the upper end, and in the last bin.
    assert_eq!(table.column("count").unwrap(), [1.0, 1.0, 5.0, 0.0, 1.0]);
    assert_eq!(summary.rows, [[8.0, -2.0, 8.0, 20.0 / 8.0, 0.0, 0.0]]);
    let (table, _, summary) = histogram(json!({ "bins": 5, "background": true })).unwrap();
    assert_eq!(table.column("count").unwrap(), [1.0, 9.0, 5.0, 0.0, 1.0]);
    assert_eq!(summary.rows[0][0], 16.0);
}

#[test]
fn what_is_beyond_the_range_is_counted_apart() {
    let Some((table, _, summary)) = histogram(json!({ "bins": 2, "range": [1, 3] })) else { return };
    assert_eq!(table.rows, [[1.0, 2.0, 1.0], [2.0, 3.0, 5.0]]);
    assert_eq!(summary.rows[0][4..], [1.0, 1.0]);
    let refused = run(gpu().unwrap(), "histogram", json!({ "range": [3, 3] }), &[("volume", &volume())]);
    assert_eq!(refused.unwrap_err().to_string(), "range is [3.0, 3.0]; write the smaller number first");
}

#[test]
fn bars_are_as_high_as_their_counts() {
    let params = json!({ "bins": 5, "width": 10, "height": 5, "log": false });
    let Some((_, image, _)) = histogram(params) else { return };
    let lit = |x: usize| (0..5).filter(|y| image.pixels()[y * 10 + x][0] > 0.5).count();
    assert_eq!((0..10).map(lit).collect::<Vec<_>>(), [1, 1, 1, 1, 5, 5, 0, 0, 1, 1]);
    // ln 2 / ln 6 of 100 is 38.7.
    let (_, image, _) = histogram(json!({ "bins": 5, "width": 5, "height": 100 })).unwrap();
    assert_eq!((0..100).filter(|y| image.pixels()[y * 5][0] > 0.5).count(), 39);
}

#[test]
fn nothing_and_one_value() {
    let Some(gpu) = gpu() else { return };
    let of = |value: f32| {
        let dense = Dense { dims: [1; 3], values: vec![value], world_from_index: DMat4::IDENTITY };
        let volume = Value::new(PortType::Volume, 0, Volume::from_shape(dense, None, DMat4::IDENTITY));
        let values = run(gpu, "histogram", json!({ "bins": 1 }), &[("volume", &volume)]).unwrap();
        (values[0].get::<Table>().rows.clone(), values[2].get::<Table>().rows.clone())
    };
    assert_eq!(of(0.0), (vec![vec![0.0, 1.0, 0.0]], vec![vec![0.0; 6]]));
    assert_eq!(of(4.0), (vec![vec![2.0, 6.0, 1.0]], vec![vec![1.0, 4.0, 4.0, 4.0, 0.0, 0.0]]));
}
