//! The channels that are solved: one where one color is all there is (`planner::channels`), else three.

/// The channels that are solved, and what they are multiplied by in the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channels {
    /// 1 or 3.
    pub count: usize,
    /// The chromaticity of all light for one channel, ones for three.
    pub color: [f64; 3],
}

impl Channels {
    /// All three.
    pub const RGB: Self = Self { count: 3, color: [1.0; 3] };

    /// A power per channel: itself for three; for one, what `color` is multiplied by.
    pub fn project(&self, power: [f64; 3]) -> [f64; 3] {
        match self.count {
            1 => [power.into_iter().fold(0.0, f64::max), 0.0, 0.0],
            _ => power,
        }
    }
}
