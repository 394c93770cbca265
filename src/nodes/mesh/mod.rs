//! `mesh`: surfaces from a file.

use std::path::PathBuf;

use super::{NodeKind, Rules, Run, transform};
use crate::geometry::{self, Mesh};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, Params, PortSpec, PortType, Value};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "mesh",
    version: 1,
    category: Category::Geometry,
    purpose: "Surfaces from a file: triangles with one diffuse color.",
    doc: "Reads the triangles of a .obj, .gltf or .glb file, each glTF mesh under its nodes' transforms. Both sides of a \
          surface count. The file's own materials are not read: `albedo` is the color of all of it.",
    inputs: &[],
    outputs: &[PortSpec::new(
        "surface",
        PortType::Surface,
        "the triangles, for the surfaces of solvers and raymarch",
    )],
    params: &[
        ParamSpec::path("path").endings(geometry::ENDINGS).doc("A .obj, .gltf or .glb file."),
        ParamSpec::rgb("albedo", [0.5; 3])
            .between(0.0, 1.0)
            .doc("Share of the light that comes back, linear Rec. 709."),
        transform::PARAM,
    ],
};

fn files(params: &Params) -> Result<Vec<PathBuf>, NodeError> {
    Ok(geometry::files(params.path("path")))
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let mesh =
        geometry::read(run.params.path("path"), transform::read(run.params)?, run.params.rgb("albedo"))
            .map_err(NodeError::new)?;
    Ok(vec![Value::new::<Mesh>(PortType::Surface, mesh.bytes(), mesh)])
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use serde_json::json;

    use crate::geometry::Mesh;
    use crate::nodes::testing::{gpu, output, run};

    #[test]
    fn a_file_is_moved_and_colored() {
        let Some(gpu) = gpu() else { return };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        // Row by row: x becomes y, and all is moved along z.
        let transform = [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 5, 0, 0, 0, 1];
        let params = json!({ "path": path, "albedo": [0.1, 0.2, 0.3], "transform": transform });
        let mesh = output(gpu, "mesh", params, &[]);
        let mesh: &Mesh = mesh.get();
        assert_eq!(mesh.positions[1], DVec3::new(0.0, 1.0, 5.0));
        assert_eq!(mesh.reflectance, [0.1, 0.2, 0.3]);
        let missing = run(gpu, "mesh", json!({ "path": "nowhere.obj" }), &[]).unwrap_err().to_string();
        assert!(missing.contains("nowhere.obj: "), "{missing}");
    }
}
