//! `probe`: values of a field at a point or along a line, as a table.
//!
//! Index coordinates are those of the file, as other programs show them. Tested by a linear field.

use glam::DVec3;

use super::scalar::{BEAM, GRID, INPUTS, Scalar};
use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::image::Table;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "probe",
    version: 1,
    category: Category::Image,
    purpose: "Reads values of a volume or medium at a point, or along a line.",
    doc: "A row for each sample: distance_m from the first point, position x_m, y_m, z_m, index coordinates i, j, k of the file, value. \
          `tyndall render GRAPH --node NAME -o line.csv` writes it.",
    inputs: INPUTS,
    outputs: &[PortSpec::new("table", PortType::Table, "distance, position, index and value of each sample")],
    params: &[
        GRID,
        BEAM,
        ParamSpec::vector("from", &[0.0, 0.0, 0.0]).unit("m").doc("The point, or where the line begins."),
        ParamSpec::vector("to", &[0.0, 0.0, 0.0])
            .unit("m")
            .or_null()
            .doc("Where the line ends; null: a point."),
        ParamSpec::int("samples", 128)
            .between(2.0, 1e6)
            .soft(2.0, 1024.0)
            .doc("Samples of the line, both ends among them."),
    ],
};

const COLUMNS: &[&str] = &["distance_m", "x_m", "y_m", "z_m", "i", "j", "k", "value"];

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let scalar = Scalar::read(run)?;
    let from = DVec3::from_array(run.params.vec("from"));
    let to = run.params.is_set("to").then(|| DVec3::from_array(run.params.vec("to")));
    let last = if to.is_some() { run.params.i64("samples") - 1 } else { 0 };
    let along = to.unwrap_or(from) - from;
    let rows = (0..=last).map(|n| {
        let share = if last > 0 { n as f64 / last as f64 } else { 0.0 };
        let position = from + share * along;
        let index = scalar.index_of(position);
        let of_file = index + scalar.first.as_dvec3();
        let mut row = vec![share * along.length()];
        row.extend(position.to_array());
        row.extend(of_file.to_array());
        row.push(scalar.at(index));
        row
    });
    let table = Table::new(COLUMNS, rows.collect());
    Ok(vec![Value::new(PortType::Table, table.bytes(), table)])
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};
    use serde_json::json;

    use crate::graph::{PortType, Value};
    use crate::image::Table;
    use crate::nodes::testing::{gpu, output};
    use crate::volume::{Dense, Volume};

    /// 3i + 1 on 5³ voxels of half a meter, the first at (1, 2, 3) m.
    fn volume() -> Value {
        let values = (0..125).map(|idx| (3 * (idx % 5) + 1) as f32).collect();
        let world_from_index =
            DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0)) * DMat4::from_scale(DVec3::splat(0.5));
        let dense = Dense { dims: [5; 3], values, world_from_index };
        Value::new(PortType::Volume, 0, Volume::from_shape(dense, None, DMat4::IDENTITY))
    }

    #[test]
    fn a_point_and_a_line() {
        let Some(gpu) = gpu() else { return };
        let probe = |params| output(gpu, "probe", params, &[("volume", &volume())]).get::<Table>().clone();
        let point = probe(json!({ "from": [1.75, 2.5, 3.0] }));
        // Halves and quarters: exact.
        assert_eq!(point.rows, [[0.0, 1.75, 2.5, 3.0, 1.5, 1.0, 0.0, 5.5]]);
        let line = probe(json!({ "from": [1, 2, 3], "to": [3, 2, 3], "samples": 5 }));
        assert_eq!(line.column("distance_m").unwrap(), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(line.column("value").unwrap(), [1.0, 4.0, 7.0, 10.0, 13.0]);
        // Outside, what stands there.
        assert_eq!(probe(json!({ "from": [9, 9, 9] })).column("value").unwrap(), [0.0]);
    }
}
