//! A slice that was made: where it lies, its values and colors.
//!
//! Tested by a plane whose places and values are known.

use egui::{Color32, ColorImage};
use glam::DVec3;

use crate::graph::Value;
use crate::image::tonemap::srgb_encode;
use crate::image::{ALPHA, Image, Table};

/// What the node gave.
#[derive(Debug, Clone)]
pub struct Cut {
    /// An [`Image`] with the layers `value` and `alpha`.
    pub image: Value,
    /// Where it lies.
    pub plane: Plane,
}

/// Where the pixels are, and what the colors stand for; lengths in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Middle of the upper left pixel.
    pub first: DVec3,
    /// From a pixel to the next one to the right and the next one below.
    pub step: [DVec3; 2],
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Values of the map's two ends.
    pub range: [f64; 2],
    /// Along the normal.
    pub position: f64,
    /// Ends of the field's box along the normal.
    pub extent: [f64; 2],
}

impl Cut {
    /// Of the node's two outputs; `None` where they are not what this program's node gives.
    pub fn new(image: &Value, table: &Table) -> Option<Self> {
        let picture: &Image = image.get();
        let column = |name: &str| table.column(name)?.first().copied();
        let point = |name: &str| {
            let axis = |axis: &str| column(&format!("{name}_{axis}_m"));
            Some(DVec3::new(axis("x")?, axis("y")?, axis("z")?))
        };
        let plane = Plane {
            first: point("first")?,
            step: [point("right")?, point("down")?],
            size: [picture.width, picture.height],
            range: [column("low")?, column("high")?],
            position: column("position_m")?,
            extent: [column("from_m")?, column("to_m")?],
        };
        Some(Self { image: image.clone(), plane })
    }

    /// The value at a share of its width and height; `None` beside the box of voxels.
    pub fn value(&self, share: [f64; 2]) -> Option<f32> {
        let image: &Image = self.image.get();
        let is_inside = share.iter().all(|x| (0.0..1.0).contains(x));
        let idx = is_inside.then(|| {
            let [x, y] = [0, 1].map(|axis| (share[axis] * self.plane.size[axis] as f64) as usize);
            x + image.width * y
        })?;
        let covered = image.layers.get(ALPHA)?.data[idx] > 0.0;
        covered.then(|| image.layers.get("value").map(|layer| layer.data[idx])).flatten()
    }

    /// The map's own colors; nothing beside the box.
    pub fn pixels(&self) -> ColorImage {
        let image: &Image = self.image.get();
        let alpha = image.layers.get(ALPHA).map(|layer| layer.data.as_slice()).unwrap_or_default();
        let color = |(idx, rgb): (usize, &[f32; 3])| {
            let [r, g, b] = rgb.map(|x| (srgb_encode(x) * 255.0).round() as u8);
            if alpha.get(idx).is_some_and(|a| *a == 0.0) {
                Color32::TRANSPARENT
            } else {
                Color32::from_rgb(r, g, b)
            }
        };
        ColorImage::new(self.plane.size, image.pixels().iter().enumerate().map(color).collect())
    }
}

impl Plane {
    /// The place of a share of the width, from the left, and of the height, from the top.
    pub fn at(&self, [u, v]: [f64; 2]) -> DVec3 {
        let along = |share: f64, axis: usize| share * self.size[axis] as f64 - 0.5;
        self.first + along(u, 0) * self.step[0] + along(v, 1) * self.step[1]
    }

    /// The share that a ray hits; `None` where it does not.
    pub fn hit(&self, [eye, ray]: [DVec3; 2]) -> Option<[f64; 2]> {
        let normal = self.normal();
        let slope = ray.dot(normal);
        let t = (self.first - eye).dot(normal) / slope;
        if slope.abs() < 1e-9 || t <= 0.0 {
            return None;
        }
        let to = eye + t * ray - self.first;
        let share = |axis: usize| {
            (to.dot(self.step[axis]) / self.step[axis].length_squared() + 0.5) / self.size[axis] as f64
        };
        let found = [share(0), share(1)];
        found.iter().all(|x| (0.0..1.0).contains(x)).then_some(found)
    }

    /// Unit normal, towards the side from which it is seen the right way round.
    pub fn normal(&self) -> DVec3 {
        self.step[1].cross(self.step[0]).normalize_or(DVec3::Z)
    }

    /// Names of the world's axes to the right and up: `x`, `−z`.
    pub fn axes(&self) -> [String; 2] {
        [self.step[0], -self.step[1]].map(|v| {
            let (axis, largest) =
                v.to_array().into_iter().enumerate().fold((0, 0.0_f64), |best, (axis, x)| {
                    if x.abs() > best.1.abs() { (axis, x) } else { best }
                });
            format!("{}{}", if largest < 0.0 { "−" } else { "" }, ["x", "y", "z"][axis])
        })
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::graph::PortType;

    /// 4 × 2 pixels of half a meter in the plane x = 1, seen from +x: −z to the right, y up. The value is the pixel's
    /// place in the list; the last one lies beside the box.
    pub fn cut() -> Cut {
        let mut image = Image::new(4, 2, (0..8).flat_map(|n| [n as f32 / 8.0, 0.0, 1.0]).collect());
        image.insert(ALPHA, 1, (0..8).map(|n| if n < 7 { 1.0 } else { 0.0 }).collect());
        image.insert("value", 1, (0..8).map(|n| n as f32).collect());
        let row = vec![1.0, 0.75, 0.25, 0.0, 0.0, -0.5, 0.0, -0.5, 0.0, 0.0, 8.0, 1.0, -2.0, 3.0];
        Cut::new(&Value::new(PortType::Image, 0, image), &table(row)).unwrap()
    }

    /// As the node gives it.
    pub fn table(row: Vec<f64>) -> Table {
        let columns = &[
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
        Table::new(columns, vec![row])
    }

    #[test]
    fn places_and_values_are_known() {
        let cut = cut();
        // Quarters are exact.
        assert_eq!(cut.plane.at([0.0, 0.0]), DVec3::new(1.0, 1.0, 0.5));
        assert_eq!(cut.plane.at([1.0, 1.0]), DVec3::new(1.0, 0.0, -1.5));
        assert_eq!((cut.plane.normal(), cut.plane.axes()), (DVec3::X, ["−z".to_owned(), "y".to_owned()]));
        let eye = DVec3::new(5.0, 0.0, 0.0);
        for share in [[0.1, 0.2], [0.9, 0.6], [0.5, 0.5]] {
            let ray = (cut.plane.at(share) - eye).normalize();
            let hit = cut.plane.hit([eye, ray]).unwrap();
            assert!(hit.iter().zip(share).all(|(a, b)| (a - b).abs() < 1e-12));
            assert_eq!(cut.plane.hit([eye, -ray]), None);
        }
        assert_eq!(cut.plane.hit([eye, (cut.plane.at([1.2, 0.5]) - eye).normalize()]), None);
        assert_eq!(
            [[0.1, 0.1], [0.9, 0.1], [0.6, 0.9]].map(|share| cut.value(share)),
            [0.0, 3.0, 6.0].map(Some)
        );
        assert_eq!([cut.value([0.9, 0.9]), cut.value([1.0, 0.5]), cut.value([0.5, -0.1])], [None; 3]);
        let pixels = cut.pixels();
        assert_eq!(
            (pixels.pixels[0], pixels.pixels[7]),
            (Color32::from_rgb(0, 0, 255), Color32::TRANSPARENT)
        );
    }
}
