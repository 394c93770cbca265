//! Where the picture lies in the viewport: fitted, one to one, zoomed and moved.
//!
//! Places are points of the window; a pixel is one of the camera's, also while a smaller picture stands for it.
//! Tested by going there and back.

use egui::{Pos2, Rect, Vec2, pos2, vec2};

/// How the picture is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Place {
    /// As large as fits.
    #[default]
    Fit,
    /// Points a pixel, and where the picture's center is from the viewport's center.
    Free {
        /// Points a pixel.
        zoom: f32,
        /// In points.
        offset: Vec2,
    },
}

impl Place {
    /// Where a picture of so many pixels lies.
    pub fn rect(self, area: Rect, size: [usize; 2]) -> Rect {
        let pixels = vec2(size[0] as f32, size[1] as f32);
        match self {
            Self::Fit => {
                let zoom = (area.width() / pixels.x).min(area.height() / pixels.y);
                Rect::from_center_size(area.center(), pixels * zoom)
            }
            Self::Free { zoom, offset } => Rect::from_center_size(area.center() + offset, pixels * zoom),
        }
    }

    /// Larger by a factor; what is under `at` stays there.
    pub fn zoomed(self, area: Rect, size: [usize; 2], at: Pos2, factor: f32) -> Self {
        let before = self.rect(area, size);
        let zoom = before.width() / size[0] as f32;
        let wanted = (zoom * factor).clamp(1.0 / 64.0, 64.0);
        let center = at + (before.center() - at) * (wanted / zoom);
        Self::Free { zoom: wanted, offset: center - area.center() }
    }

    /// Moved by so many points.
    pub fn moved(self, area: Rect, size: [usize; 2], by: Vec2) -> Self {
        let before = self.rect(area, size);
        Self::Free { zoom: before.width() / size[0] as f32, offset: before.center() + by - area.center() }
    }

    /// A pixel of the screen for each of the picture.
    pub fn one_to_one(pixels_per_point: f32) -> Self {
        Self::Free { zoom: 1.0 / pixels_per_point, offset: Vec2::ZERO }
    }
}

/// Column and row of a picture of `size` that lies at `rect`; `None` beside it.
pub fn pixel_at(rect: Rect, size: [usize; 2], at: Pos2) -> Option<[usize; 2]> {
    let share = (at - rect.min) / rect.size();
    let inside = |x: f32, n: usize| (0.0..1.0).contains(&x).then_some((x * n as f32) as usize);
    Some([inside(share.x, size[0])?, inside(share.y, size[1])?])
}

/// A round length (1, 2 or 5 times a power of ten) that is at most `longest`.
pub fn round_length(longest: f64) -> f64 {
    if !(longest.is_finite() && longest > 0.0) {
        return 0.0;
    }
    let power = 10_f64.powf(longest.log10().floor());
    [5.0, 2.0, 1.0]
        .into_iter()
        .map(|n| n * power)
        .find(|length| *length <= longest * (1.0 + 1e-9))
        .unwrap_or(power)
}

/// With the unit that needs the fewest digits.
pub fn length_text(meters: f64) -> String {
    match meters {
        m if m >= 1000.0 => format!("{} km", m / 1000.0),
        m if m >= 1.0 => format!("{m} m"),
        m if m >= 0.01 => format!("{} cm", (m * 1e4).round() / 1e2),
        m => format!("{} mm", (m * 1e5).round() / 1e2),
    }
}

/// The corner of a rectangle, lower left.
pub fn lower_left(rect: Rect) -> Pos2 {
    pos2(rect.left(), rect.bottom())
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rect = Rect { min: Pos2::new(10.0, 20.0), max: Pos2::new(410.0, 220.0) };

    #[test]
    fn fitted_pictures_are_whole() {
        assert_eq!(Place::Fit.rect(AREA, [100, 100]).size(), vec2(200.0, 200.0));
        assert_eq!(Place::Fit.rect(AREA, [1000, 100]).size(), vec2(400.0, 40.0));
        assert_eq!(Place::one_to_one(2.0).rect(AREA, [100, 50]).size(), vec2(50.0, 25.0));
    }

    #[test]
    fn what_is_under_the_cursor_stays_there() {
        let (size, at) = ([64, 32], pos2(100.0, 80.0));
        let place = Place::Fit.moved(AREA, size, vec2(5.0, -3.0));
        let share = |place: Place| {
            let rect = place.rect(AREA, size);
            (at - rect.min) / rect.size()
        };
        let near = place.zoomed(AREA, size, at, 3.0);
        // Some ten roundings of numbers below 1000 by parts of 6e-8.
        assert!((share(near) - share(place)).length() < 1e-5);
        let back = near.zoomed(AREA, size, at, 1.0 / 3.0).rect(AREA, size);
        assert!((back.min - place.rect(AREA, size).min).length() < 1e-2);
    }

    #[test]
    fn pixels_are_found() {
        let rect = Rect::from_min_size(pos2(10.0, 10.0), vec2(20.0, 10.0));
        assert_eq!(pixel_at(rect, [4, 2], pos2(10.0, 10.0)), Some([0, 0]));
        assert_eq!(pixel_at(rect, [4, 2], pos2(29.9, 19.9)), Some([3, 1]));
        assert_eq!(pixel_at(rect, [4, 2], pos2(30.0, 12.0)), None);
    }

    #[test]
    fn lengths_are_round() {
        for (longest, length) in
            [(7.3, 5.0), (4.9, 2.0), (1.0, 1.0), (0.199, 0.1), (1234.0, 1000.0), (50.0, 50.0)]
        {
            assert!((round_length(longest) / length - 1.0).abs() < 1e-12, "{longest}");
        }
        assert_eq!((round_length(0.0), round_length(f64::NAN)), (0.0, 0.0));
        assert_eq!(length_text(2000.0) + &length_text(5.0) + &length_text(0.2), "2 km5 m20 cm");
    }
}
