//! glTF 2.0, as text (.gltf) or binary (.glb): the triangles of the default scene, each under its nodes'
//! transforms.
//!
//! The crate `gltf` parses and validates the document; the numbers are read here, since its own reader
//! panics on empty and on overlong accessors. Triangles, strips and fans count; points and lines do not.
//! Limits: buffers in the file, beside it or as base64; no sparse or compressed accessors, no skins,
//! no morph targets.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::Source;
use ::gltf::mesh::Mode;
use ::gltf::{Accessor, Gltf, Node, Primitive, Semantic};
use base64::Engine;
use glam::{DMat4, DVec3};

use super::{MeshError, Parts, bytes};

pub(super) fn parse(path: &Path, file: &[u8]) -> Result<Parts, MeshError> {
    let gltf =
        Gltf::from_slice(file).map_err(|error| MeshError::invalid(path, "document", error.to_string()))?;
    let mut blob = gltf.blob.as_deref();
    let buffers = gltf
        .buffers()
        .map(|buffer| match buffer.source() {
            Source::Bin => blob.take().map(<[u8]>::to_vec).ok_or_else(|| {
                MeshError::invalid(path, place("buffer", buffer.index()), "the file has no binary chunk")
            }),
            Source::Uri(uri) => load(path, uri, buffer.index()),
        })
        .collect::<Result<Vec<Vec<u8>>, MeshError>>()?;
    let scene = gltf.default_scene().or_else(|| gltf.scenes().next()).ok_or_else(|| {
        MeshError::not_supported(path, "no scene", "export a scene with the meshes that are to be seen")
    })?;
    let mut parts = Parts { positions: Vec::new(), triangles: Vec::new() };
    let mut to_visit: Vec<(Node, DMat4)> = scene.nodes().map(|node| (node, DMat4::IDENTITY)).collect();
    let mut seen = HashSet::new();
    while let Some((node, above)) = to_visit.pop() {
        if !seen.insert(node.index()) {
            let what = "it stands below two nodes or below itself: a node has one parent";
            return Err(MeshError::invalid(path, place("node", node.index()), what));
        }
        let columns = node.transform().matrix().map(|column| column.map(f64::from));
        let scene_from_node = above * DMat4::from_cols_array_2d(&columns);
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                let at = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
                add(&mut parts, &Reader { path, buffers: &buffers, at }, &primitive, scene_from_node)?;
            }
        }
        to_visit.extend(node.children().map(|child| (child, scene_from_node)));
    }
    Ok(parts)
}

/// The files beside a document that it takes its buffers from; none where it is no document.
pub(super) fn buffer_files(path: &Path, file: &[u8]) -> Vec<PathBuf> {
    let Ok(gltf) = Gltf::from_slice(file) else { return Vec::new() };
    let beside = |source: Source| match source {
        Source::Uri(uri) if !uri.contains(':') => Some(beside(path, &urlencoding::decode(uri).ok()?)),
        _ => None,
    };
    gltf.buffers().filter_map(|buffer| beside(buffer.source())).collect()
}

fn beside(path: &Path, name: &str) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(name)
}

fn place(element: &str, index: usize) -> String {
    format!("{element} {index}")
}

/// A buffer beside the file, or in its text.
fn load(path: &Path, uri: &str, index: usize) -> Result<Vec<u8>, MeshError> {
    let invalid = |what: String| MeshError::invalid(path, place("buffer", index), what);
    if let Some((_, data)) = uri.strip_prefix("data:").and_then(|rest| rest.split_once(";base64,")) {
        let decoded = base64::engine::general_purpose::STANDARD.decode(data);
        return decoded.map_err(|error| invalid(format!("its base64 text is damaged: {error}")));
    }
    if uri.contains(':') {
        let remedy = "put the buffer into the file or beside it";
        return Err(MeshError::not_supported(path, format!("buffer {index} at another place"), remedy));
    }
    let name = urlencoding::decode(uri).map_err(|error| invalid(format!("its name is no text: {error}")))?;
    bytes(&beside(path, &name))
}

/// Reads the accessors of one primitive.
struct Reader<'a> {
    path: &'a Path,
    buffers: &'a [Vec<u8>],
    at: String,
}

impl Reader<'_> {
    fn invalid(&self, what: impl Into<String>) -> MeshError {
        MeshError::invalid(self.path, &self.at, what)
    }

    /// The bytes of each element.
    fn elements(&self, accessor: &Accessor) -> Result<Vec<&[u8]>, MeshError> {
        let Some(view) = accessor.view().filter(|_| accessor.sparse().is_none()) else {
            let what = format!("{}: a sparse or compressed accessor", self.at);
            return Err(MeshError::not_supported(self.path, what, "export plain buffers"));
        };
        let buffer = self.buffers.get(view.buffer().index()).map_or(&[][..], Vec::as_slice);
        let end = view.offset().saturating_add(view.length());
        let slice = buffer.get(view.offset()..end).ok_or_else(|| {
            let n = buffer.len();
            self.invalid(format!("bytes {}..{end} of a buffer of {n}: is the file cut off?", view.offset()))
        })?;
        let size = accessor.size();
        let stride = view.stride().unwrap_or(size).max(1);
        let element = |n: usize| {
            let first = n.checked_mul(stride)?.checked_add(accessor.offset())?;
            slice.get(first..first.checked_add(size)?)
        };
        // Asking for the last one first keeps an absurd count from taking memory.
        let n = accessor.count();
        let all_inside = n == 0 || element(n - 1).is_some();
        all_inside.then(|| (0..n).filter_map(element).collect()).ok_or_else(|| {
            self.invalid(format!("{n} elements do not fit into {} bytes: is the file cut off?", slice.len()))
        })
    }

    fn positions(&self, accessor: &Accessor) -> Result<Vec<DVec3>, MeshError> {
        if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
            let what = format!("{}: quantized positions", self.at);
            return Err(MeshError::not_supported(self.path, what, "export positions as 32-bit floats"));
        }
        let number = |element: &[u8], n: usize| {
            f64::from(bytemuck::pod_read_unaligned::<f32>(&element[4 * n..4 * n + 4]))
        };
        let elements = self.elements(accessor)?.into_iter();
        Ok(elements.map(|e| DVec3::new(number(e, 0), number(e, 1), number(e, 2))).collect())
    }

    fn indices(&self, accessor: &Accessor) -> Result<Vec<u32>, MeshError> {
        if accessor.dimensions() != Dimensions::Scalar {
            return Err(self.invalid("indices that are no single numbers"));
        }
        let elements = self.elements(accessor)?.into_iter();
        match accessor.data_type() {
            DataType::U8 => Ok(elements.map(|e| u32::from(e[0])).collect()),
            DataType::U16 => Ok(elements.map(|e| u32::from(u16::from_le_bytes([e[0], e[1]]))).collect()),
            DataType::U32 => Ok(elements.map(|e| u32::from_le_bytes([e[0], e[1], e[2], e[3]])).collect()),
            other => Err(self.invalid(format!("indices as {other:?}: allowed are u8, u16 and u32"))),
        }
    }
}

fn add(
    parts: &mut Parts,
    reader: &Reader,
    primitive: &Primitive,
    scene_from_node: DMat4,
) -> Result<(), MeshError> {
    let mode = primitive.mode();
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(());
    }
    let Some(positions) = primitive.get(&Semantic::Positions) else {
        return Err(reader.invalid("no POSITION: a primitive of triangles needs one"));
    };
    let positions = reader.positions(&positions)?;
    let indices = match primitive.indices() {
        Some(indices) => reader.indices(&indices)?,
        None => (0..positions.len() as u32).collect(),
    };
    if let Some(bad) = indices.iter().find(|&&index| index as usize >= positions.len()) {
        let n = positions.len();
        return Err(reader.invalid(format!("index {bad} of {n} positions: allowed are indices below {n}")));
    }
    if let Some(idx) = positions.iter().position(|p| !p.is_finite()) {
        return Err(reader.invalid(format!("position {idx} is no finite number: export it again")));
    }
    let first = parts.positions.len() as u32;
    parts.positions.extend(positions.iter().map(|p| scene_from_node.transform_point3(*p)));
    let mut push = |a: u32, b: u32, c: u32| parts.triangles.push([a, b, c].map(|n| n + first));
    match mode {
        Mode::Triangles => indices.chunks_exact(3).for_each(|t| push(t[0], t[1], t[2])),
        // Every second one of a strip has the other sense; both sides count, so it does not matter.
        Mode::TriangleStrip => indices.windows(3).for_each(|t| push(t[0], t[1], t[2])),
        _ => indices.windows(2).skip(1).for_each(|t| push(indices[0], t[0], t[1])),
    }
    Ok(())
}
