//! How many channels a scene needs (DESIGN 7): one where the medium is grey and all light has one
//! chromaticity, three otherwise. Flames of several temperatures have several.

use super::{Beams, Medium};
use crate::light::chromaticity;

/// The channels that are solved, and what they are multiplied by in the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channels {
    /// 1 or 3.
    pub count: usize,
    /// The chromaticity of all light for one channel, ones for three.
    pub color: [f64; 3],
}

/// Components of two chromaticities that differ by less are the same color.
const SAME: f64 = 1e-6;

impl Channels {
    /// All three.
    pub const RGB: Self = Self { count: 3, color: [1.0; 3] };

    /// What this medium in this light needs.
    pub fn of(medium: &Medium, beams: &Beams) -> Self {
        if medium.emission.is_some() || beams.fields.iter().any(|field| field.channels.count == 3) {
            return Self::RGB;
        }
        let of_fields = beams.fields.iter().map(|field| field.channels.color);
        let of_beams = beams.beams.iter().map(|beam| beam.power);
        Self::of_powers(medium, of_fields.chain(of_beams).chain([beams.ambient]))
    }

    /// What this medium needs in lights of these powers.
    pub fn of_powers(medium: &Medium, powers: impl Iterator<Item = [f64; 3]>) -> Self {
        let mut powers = powers.filter_map(chromaticity);
        let Some((_, color)) = powers.next() else {
            return Self { count: 1, color: [1.0; 3] };
        };
        let same = |other: [f64; 3]| other.iter().zip(color).all(|(a, b)| (a - b).abs() < SAME);
        if medium.is_grey() && powers.all(|(_, other)| same(other)) {
            Self { count: 1, color }
        } else {
            Self::RGB
        }
    }

    /// A power per channel: itself for three; for one, what `color` is multiplied by.
    pub fn project(&self, power: [f64; 3]) -> [f64; 3] {
        match self.count {
            1 => [power.into_iter().fold(0.0, f64::max), 0.0, 0.0],
            _ => power,
        }
    }
}
