//! `slice`: a plane through a field, as colors and as numbers.
//!
//! The plane's picture is the smallest rectangle that holds where it could meet the box of voxels, with square pixels.
//! It is seen from the side to which its normal points, with +Y up, or −Z where the normal is along Y. On the CPU: a
//! picture of 512² is a quarter of a million interpolations, a few milliseconds. Where the plane lies and which values
//! the colors stand for is a table, so that whoever shows the picture can put it into its place and write a legend.
//! Tested by a linear field, which the interpolation reproduces, for every axis and a plane that lies crooked, and by
//! depths and fluences that are known.

use glam::DVec3;
use rayon::prelude::*;

use super::scalar::{BEAM, GRID, INPUTS, Scalar, range};
use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::image::{ALPHA, Colormap, Image, Table, colormap};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "slice",
    version: 1,
    category: Category::Image,
    purpose: "Cuts a plane through a volume, medium, beam or residual and colors its values.",
    doc: "Layers: beauty (colors of the map), value (the numbers themselves), alpha (1 in the box of voxels, 0 beside it). \
          Values beyond the range have the color of its nearer end. The colors are linear light, so that a PNG shows the map's own. \
          The table has one row: middle of the upper left pixel, steps to the next pixel right and down, values of the map's two \
          ends, and along the plane's normal its place and the ends of the box.",
    inputs: INPUTS,
    outputs: &[
        PortSpec::new("image", PortType::Image, "colors, and the values as a layer"),
        PortSpec::new("plane", PortType::Table, "where the pixels lie [m], and the values of the map's ends"),
    ],
    params: &[
        GRID,
        BEAM,
        ParamSpec::choice("axis", &["z", "x", "y", "free"])
            .doc("The plane's normal: an axis of the world, or free for `normal` and `origin`."),
        ParamSpec::float("position", 0.0)
            .unit("m")
            .or_null()
            .doc("Where the plane cuts its axis; null is the middle of the volume."),
        ParamSpec::direction("normal", [0.0, 0.0, 1.0]).doc("Of a free plane; it points to the viewer."),
        ParamSpec::vector("origin", &[0.0, 0.0, 0.0])
            .unit("m")
            .or_null()
            .doc("A point of a free plane; null is the middle of the volume."),
        ParamSpec::int("resolution", 512)
            .unit("px")
            .between(1.0, 8192.0)
            .soft(64.0, 2048.0)
            .doc("Pixels along the longer side."),
        ParamSpec::choice("colormap", colormap::NAMES).doc("From the range's lower end to its upper one."),
        ParamSpec::vector("range", &[0.0, 1.0])
            .or_null()
            .doc("Values of the map's two ends; null is the least and the largest of all the data."),
    ],
};

/// Columns of the table.
const COLUMNS: &[&str] = &[
    "first_x_m",
    "first_y_m",
    "first_z_m",
    "right_x_m",
    "right_y_m",
    "right_z_m",
    "down_x_m",
    "down_y_m",
    "down_z_m",
    "low",
    "high",
    "position_m",
    "from_m",
    "to_m",
];

/// Where the pixels are.
struct Plane {
    /// Middle of the upper left pixel in meters.
    first: DVec3,
    /// From a pixel to the next one to the right and the next one below.
    step: [DVec3; 2],
    /// Pixels across and down.
    size: [usize; 2],
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let scalar = Scalar::read(run)?;
    let [low, high] = range(run, scalar.range())?;
    let map = Colormap::named(run.params.text("colormap")).expect("a choice of the spec");
    let (normal, origin) = plane(run, &scalar);
    let Plane { first, step: [right, down], size: [width, height] } =
        Plane::around(&scalar, normal, origin, run.params.i64("resolution") as usize);
    let along = scalar.corners().map(|corner| corner.dot(normal));
    let [from, to] = ends(along);
    let mut row: Vec<f64> = [first, right, down].iter().flat_map(DVec3::to_array).collect();
    row.extend([low, high, origin.dot(normal), from, to]);
    let table = Table::new(COLUMNS, vec![row]);
    let pixels = (0..width * height).into_par_iter().map(|idx| {
        let position = first + (idx % width) as f64 * right + (idx / width) as f64 * down;
        let index = scalar.index_of(position);
        (scalar.at(index), scalar.is_inside(index))
    });
    let pixels: Vec<(f64, bool)> = pixels.collect();
    run.cancel.check()?;
    let color = |&(value, is_inside): &(f64, bool)| {
        // A field of one value is the lower end.
        let t = if high > low { (value - low) / (high - low) } else { 0.0 };
        if is_inside { map.linear(t) } else { [0.0; 3] }
    };
    let mut image = Image::new(width, height, pixels.par_iter().flat_map_iter(color).collect());
    image.insert(ALPHA, 1, pixels.iter().map(|(_, is_inside)| f32::from(u8::from(*is_inside))).collect());
    image.insert("value", 1, pixels.iter().map(|(value, _)| *value as f32).collect());
    Ok(vec![
        Value::new(PortType::Image, image.bytes(), image),
        Value::new(PortType::Table, table.bytes(), table),
    ])
}

/// The least and the largest.
fn ends(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let all = values.into_iter();
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// Unit normal and a point.
fn plane(run: &Run, scalar: &Scalar) -> (DVec3, DVec3) {
    let center = scalar.center();
    let normal = match run.params.text("axis") {
        "x" => DVec3::X,
        "y" => DVec3::Y,
        "z" => DVec3::Z,
        _ => {
            let origin = run.params.is_set("origin").then(|| DVec3::from_array(run.params.vec("origin")));
            return (DVec3::from_array(run.params.unit("normal")), origin.unwrap_or(center));
        }
    };
    let position = run.params.is_set("position").then(|| run.params.f64("position"));
    (normal, center + normal * position.map_or(0.0, |position| position - center.dot(normal)))
}

impl Plane {
    fn around(scalar: &Scalar, normal: DVec3, origin: DVec3, resolution: usize) -> Self {
        let up = if normal.cross(DVec3::Y).length() > 1e-3 { DVec3::Y } else { DVec3::NEG_Z };
        let right = up.cross(normal).normalize();
        let up = normal.cross(right);
        let corners =
            scalar.corners().map(|corner| [(corner - origin).dot(right), (corner - origin).dot(up)]);
        let along = |axis: usize| ends(corners.iter().map(|corner| corner[axis]));
        let ([left, most_right], [bottom, top]) = (along(0), along(1));
        let pixel = (most_right - left).max(top - bottom) / resolution as f64;
        // Less than a millionth of a pixel is rounding.
        let count = |span: f64| ((span / pixel - 1e-6).ceil() as usize).clamp(1, resolution);
        let size = [count(most_right - left), count(top - bottom)];
        let middle = origin + 0.5 * (left + most_right) * right + 0.5 * (bottom + top) * up;
        let half = |axis: usize| 0.5 * (size[axis] as f64 - 1.0) * pixel;
        Self { first: middle - half(0) * right + half(1) * up, step: [pixel * right, -pixel * up], size }
    }
}

#[cfg(test)]
mod tests;
