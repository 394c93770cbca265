//! Wavefront OBJ: positions (`v`) and faces (`f`), polygons as fans.
//!
//! Read by `tobj`, which names no place and panics on some indices of texture coordinates: it is given the
//! lines of positions and faces alone, with the indices of positions alone, line by line as they stand in
//! the file, so that what it stops at has a line.

use std::io::Cursor;
use std::path::Path;

use glam::DVec3;

use super::{MeshError, Parts};

const OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Parts, MeshError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = line_of(&bytes[..error.valid_up_to()]);
        let what = "it is not UTF-8 text: an OBJ file is text, convert it or take another file";
        MeshError::invalid(path, format!("line {line}"), what)
    })?;
    let shape: String = text.lines().map(|line| bare(line) + "\n").collect();
    let mut reader = Cursor::new(shape.as_bytes());
    let loaded = tobj::load_obj_buf(&mut reader, &OPTIONS, |_| Err(tobj::LoadError::GenericFailure));
    // Of a line that it cannot read tobj has taken the line's end.
    let reached = &shape.as_bytes()[..reader.position() as usize];
    let (models, _) = loaded.map_err(|error| match error {
        tobj::LoadError::FaceVertexOutOfBounds => index_out_of_range(path, &shape),
        error => {
            let line = line_of(&reached[..reached.len().saturating_sub(1)]);
            let what = format!("{error}: write 'v x y z' and 'f i j k', with numbers");
            MeshError::invalid(path, format!("line {line}"), what)
        }
    })?;
    let mut parts = Parts { positions: Vec::new(), triangles: Vec::new() };
    for model in models {
        let first = parts.positions.len() as u32;
        let positions = model.mesh.positions.chunks_exact(3);
        parts.positions.extend(positions.map(|p| DVec3::new(p[0], p[1], p[2])));
        let triangles = model.mesh.indices.chunks_exact(3);
        parts.triangles.extend(triangles.map(|t| [t[0] + first, t[1] + first, t[2] + first]));
    }
    if let Some(line) = shape.lines().position(|line| line.starts_with("v ") && !is_finite(line)) {
        let what = "a coordinate is no finite number: write 'v x y z', each finite";
        return Err(MeshError::invalid(path, format!("line {}", line + 1), what));
    }
    Ok(parts)
}

/// A line with what is read of it; empty where nothing is.
fn bare(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().take_while(|word| !word.starts_with('#')).collect();
    match words.first() {
        // Colors may follow a position.
        Some(&"v") if words.len() >= 7 => words[..4].join(" "),
        Some(&"v") => words.join(" "),
        Some(&"f") if words.len() > 1 => {
            let corners = words.iter().map(|word| word.split('/').next().unwrap_or_default());
            corners.collect::<Vec<_>>().join(" ")
        }
        _ => String::new(),
    }
}

/// Number of the line in which the bytes end, from 1.
fn line_of(bytes: &[u8]) -> usize {
    1 + bytes.iter().filter(|&&byte| byte == b'\n').count()
}

fn is_finite(line: &str) -> bool {
    line.split(' ').skip(1).all(|word| word.parse::<f64>().is_ok_and(f64::is_finite))
}

fn index_out_of_range(path: &Path, shape: &str) -> MeshError {
    let n_all = shape.lines().filter(|line| line.starts_with("v ")).count() as i64;
    let mut n_before = 0;
    for (line, words) in shape.lines().enumerate() {
        n_before += i64::from(words.starts_with("v "));
        let corners = words.strip_prefix("f ").into_iter().flat_map(|rest| rest.split(' '));
        for index in corners.filter_map(|word| word.parse::<i64>().ok()) {
            // An index below 0 counts back from the last vertex before the face.
            if index == 0 || index > n_all || index < -n_before {
                let what = format!("face index {index} of {n_all} vertices: allowed are 1..={n_all}");
                return MeshError::invalid(path, format!("line {}", line + 1), what);
            }
        }
    }
    MeshError::invalid(path, "a face", format!("an index is not among {n_all} vertices"))
}
