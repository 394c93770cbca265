//! The pinhole camera: position, frame, vertical angle, and the pixels it fills.
//!
//! World: right-handed, Y up, meters. Row 0 is on top; a pixel covers a square. A ray through
//! (x, y) in -1..=1, y up, is `forward + x * right + y * up` of [`Camera::frame`].

use glam::DVec3;

/// A view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Of the pinhole, in meters.
    pub position: DVec3,
    /// A point in the middle of the picture, in meters.
    pub look_at: DVec3,
    /// What is up in the picture; need be neither unit nor across the view.
    pub up: DVec3,
    /// Full vertical angle.
    pub fov_y_deg: f64,
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
}

impl Camera {
    /// Forward (unit), and right and up scaled to the edges of the picture.
    ///
    /// # Errors
    /// Where position and target coincide, or `up` is along the view: what to change.
    pub fn frame(&self) -> Result<[DVec3; 3], String> {
        let forward = (self.look_at - self.position)
            .try_normalize()
            .ok_or("position and look_at coincide: move one of them")?;
        let right = forward.cross(self.up.normalize_or_zero());
        // Under 1e-6 the picture's roll would be rounding noise.
        if right.length() < 1e-6 {
            return Err("up is along the view: choose another, for instance [0, 0, 1]".to_owned());
        }
        let right = right.normalize();
        let up = right.cross(forward);
        let tan = (0.5 * self.fov_y_deg.to_radians()).tan();
        let aspect = self.width as f64 / self.height as f64;
        Ok([forward, right * (tan * aspect), up * tan])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: Camera = Camera {
        position: DVec3::new(0.0, 0.0, 5.0),
        look_at: DVec3::ZERO,
        up: DVec3::Y,
        fov_y_deg: 90.0,
        width: 200,
        height: 100,
    };

    #[test]
    fn frame_spans_the_picture() {
        let [forward, right, up] = VIEW.frame().unwrap();
        // Three normalizations of unit vectors: a few ulps.
        assert!((forward + DVec3::Z).length() < 1e-15);
        assert!((right - 2.0 * DVec3::X).length() < 1e-15);
        assert!((up - DVec3::Y).length() < 1e-15);
    }

    #[test]
    fn views_without_a_frame_are_refused() {
        assert!(Camera { look_at: VIEW.position, ..VIEW }.frame().unwrap_err().contains("coincide"));
        assert!(Camera { up: DVec3::Z, ..VIEW }.frame().unwrap_err().contains("along the view"));
        assert!(Camera { up: DVec3::ZERO, ..VIEW }.frame().is_err());
    }
}
