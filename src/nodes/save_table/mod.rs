//! `save_table`: writes a table to a file.

use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::image::{Table, table};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "save_table",
    version: 1,
    category: Category::Image,
    purpose: "Writes a table as .csv.",
    doc: "The file appears whole or not at all; its folder is made where it is missing. The first line has the names of the columns, \
          numbers read back to the same bits.",
    inputs: &[PortSpec::new("table", PortType::Table, "the table")],
    outputs: &[PortSpec::new("table", PortType::Table, "the same table")],
    params: &[ParamSpec::out_path("path", "out/table.csv")
        .endings(table::ENDINGS)
        .doc("Where to write, .csv; relative to the graph file.")],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    table::write(run.params.path("path"), run.inputs.one::<Table>("table")).map_err(NodeError::new)?;
    Ok(run.inputs.values("table").to_vec())
}
