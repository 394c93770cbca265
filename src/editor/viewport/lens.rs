//! Between the world and where it is seen in the window: a camera, and the rectangle that its picture fills.
//!
//! Tested by going there and back.

use egui::{Pos2, Rect, vec2};
use glam::DVec3;

use crate::camera::Camera;

/// A camera and the place of its picture.
#[derive(Debug, Clone, Copy)]
pub struct Lens {
    position: DVec3,
    forward: DVec3,
    /// To the right and upper edge of the picture, a meter ahead.
    edges: [DVec3; 2],
    rect: Rect,
}

impl Lens {
    /// `None` for a camera that has no frame.
    pub fn new(camera: Camera, rect: Rect) -> Option<Self> {
        let [forward, right, up] = camera.frame().ok()?;
        Some(Self { position: camera.position, forward, edges: [right, up], rect })
    }

    /// Where a point of the world is seen; `None` behind the camera, and so near to it that places lose their digits.
    pub fn project(&self, p: DVec3) -> Option<Pos2> {
        let to = p - self.position;
        let depth = to.dot(self.forward);
        if depth <= 1e-6 * to.length() || depth <= 0.0 {
            return None;
        }
        let share = self.edges.map(|edge| (to.dot(edge) / (edge.length_squared() * depth)) as f32);
        Some(self.rect.center() + 0.5 * vec2(share[0] * self.rect.width(), -share[1] * self.rect.height()))
    }

    /// Origin and unit direction of the ray through a point of the window.
    pub fn ray(&self, at: Pos2) -> [DVec3; 2] {
        let share = (at - self.rect.min) / self.rect.size();
        let [x, y] = [2.0 * f64::from(share.x) - 1.0, 1.0 - 2.0 * f64::from(share.y)];
        [self.position, (self.forward + self.edges[0] * x + self.edges[1] * y).normalize()]
    }
}

/// How far along the line through `origin` with the unit direction `normal` the line comes nearest to a ray; `None`
/// where they are so parallel (10 degrees) that a hand's tremor would be a leap.
pub fn along(origin: DVec3, normal: DVec3, [eye, ray]: [DVec3; 2]) -> Option<f64> {
    let cos = normal.dot(ray);
    let sin_squared = 1.0 - cos * cos;
    let from_eye = origin - eye;
    (sin_squared > 0.03).then(|| (cos * ray.dot(from_eye) - normal.dot(from_eye)) / sin_squared)
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    const CAMERA: Camera = Camera {
        position: DVec3::new(3.0, 2.0, 6.0),
        look_at: DVec3::new(1.0, 0.5, -1.0),
        up: DVec3::Y,
        fov_y_deg: 40.0,
        width: 160,
        height: 90,
    };
    const RECT: Rect = Rect { min: Pos2::new(20.0, 40.0), max: Pos2::new(340.0, 220.0) };

    #[test]
    fn what_is_seen_is_where_its_ray_goes() {
        let lens = Lens::new(CAMERA, RECT).unwrap();
        // In f32 a place below 1000 has 6e-5.
        assert!((lens.project(CAMERA.look_at).unwrap() - RECT.center()).length() < 1e-4);
        for at in [pos2(20.0, 40.0), pos2(333.0, 99.0), pos2(180.0, 220.0)] {
            let [origin, ray] = lens.ray(at);
            assert!((lens.project(origin + 3.7 * ray).unwrap() - at).length() < 1e-3, "{at}");
            assert_eq!(lens.project(origin - ray), None);
        }
        // Half the vertical angle above the middle is the upper edge.
        let [_, ray] = lens.ray(RECT.center_top());
        let [_, middle] = lens.ray(RECT.center());
        assert!((ray.angle_between(middle).to_degrees() - 20.0).abs() < 1e-4);
        assert!(Lens::new(Camera { up: DVec3::ZERO, ..CAMERA }, RECT).is_none());
    }

    #[test]
    fn a_line_is_grasped_where_it_is_nearest() {
        let lens = Lens::new(CAMERA, RECT).unwrap();
        let (origin, normal) = (DVec3::new(0.5, 0.2, 0.1), DVec3::X);
        for s in [-0.7, 0.0, 1.3] {
            let at = lens.project(origin + s * normal).unwrap();
            // The place has f32: 1e-5 of some meters.
            let found = along(origin, normal, lens.ray(at)).unwrap();
            assert!((found - s).abs() < 1e-4, "{s} {found}");
        }
        let ahead = (CAMERA.look_at - CAMERA.position).normalize();
        assert_eq!(along(CAMERA.look_at, ahead, lens.ray(RECT.center())), None);
    }
}
