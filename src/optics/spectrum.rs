//! Colors as one number.

/// Luminance weights of linear Rec. 709.
pub const LUMINANCE_WEIGHTS: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Luminance of a linear Rec. 709 color.
pub fn luminance(rgb: [f64; 3]) -> f64 {
    LUMINANCE_WEIGHTS.iter().zip(rgb).map(|(weight, value)| weight * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_its_radiance() {
        assert!((luminance([0.7; 3]) - 0.7).abs() < 1e-15);
        assert_eq!(luminance([0.0, 2.0, 0.0]), 1.4304);
    }
}
