//! Noise and random numbers from integer hashes, the same on every machine.
//!
//! Lattice points are hashed (xor and multiply, finalized as in Wellons, "hash prospector",
//! 2018), so a field is a function of position and seed alone: no table, no state, any
//! resolution. Only additions, products, floor and sqrt touch the numbers; IEEE 754 rounds all of
//! these exactly, and Rust contracts none of them, so that the bits do not depend on the libm.
//!
//! - [`perlin`]: gradient noise (Perlin, "Improving noise", 2002), period 1, about -1..1, mean 0.
//! - [`fbm`]: octaves of it, each twice as fine and half as strong.
//! - [`bumps`]: paraboloids around the points of a jittered lattice (Worley, "A cellular texture
//!   basis function", 1996): round humps with sharp creases between them.
//!
//! Limits: coordinates up to 2^31 lattice cells; f32 leaves 1e-3 cells of precision at 1e4.
//! Tests: ranges, means, continuity, dependence on the seed.

use glam::{IVec3, Vec3};

/// Twelve edge midpoints of a cube, four of them twice, so that four hashed bits pick one.
const GRADIENTS: [Vec3; 16] = [
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(-1.0, 1.0, 0.0),
    Vec3::new(1.0, -1.0, 0.0),
    Vec3::new(-1.0, -1.0, 0.0),
    Vec3::new(1.0, 0.0, 1.0),
    Vec3::new(-1.0, 0.0, 1.0),
    Vec3::new(1.0, 0.0, -1.0),
    Vec3::new(-1.0, 0.0, -1.0),
    Vec3::new(0.0, 1.0, 1.0),
    Vec3::new(0.0, -1.0, 1.0),
    Vec3::new(0.0, 1.0, -1.0),
    Vec3::new(0.0, -1.0, -1.0),
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(-1.0, 1.0, 0.0),
    Vec3::new(0.0, -1.0, 1.0),
    Vec3::new(0.0, -1.0, -1.0),
];

/// Mean of the squared distance to the nearest point of the jittered lattice, measured over 1e6
/// positions, so that [`bumps`] has mean 0.
const MEAN_SQUARED_DISTANCE: f32 = 0.301;

/// Least and largest value of [`bumps`]; the least was measured, deeper ones are too rare to see.
pub const BUMP_RANGE: [f32; 2] = [-1.1, MEAN_SQUARED_DISTANCE];

/// Numbers in a row from one seed, for laying out a scene.
pub struct Random {
    state: u32,
}

impl Random {
    /// Two calls with the same seed give the same numbers.
    pub fn new(seed: u32) -> Self {
        Self { state: mix(seed) }
    }

    /// The next number in 0..1.
    pub fn unit(&mut self) -> f32 {
        self.state = self.state.wrapping_add(0x9e37_79b9);
        unit(mix(self.state))
    }

    /// The next number in low..high.
    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// The next point on the unit sphere, all equally likely.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = Vec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0));
            let r2 = p.length_squared();
            if (0.01..=1.0).contains(&r2) {
                return p / r2.sqrt();
            }
        }
    }
}

/// A seed of its own for the field number `field` of something made from `seed`.
pub fn stream(seed: u32, field: u32) -> u32 {
    mix(mix(seed).wrapping_add(field))
}

/// Gradient noise at `p`, about -1..1.
pub fn perlin(p: Vec3, seed: u32) -> f32 {
    let floor = p.floor();
    let cell = floor.as_ivec3();
    let f = p - floor;
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let corner = |x: i32, y: i32, z: i32| {
        let offset = IVec3::new(x, y, z);
        let gradient = GRADIENTS[(hash(cell + offset, seed) >> 28) as usize];
        gradient.dot(f - offset.as_vec3())
    };
    let along_x = |y, z| mix_f32(corner(0, y, z), corner(1, y, z), w.x);
    let along_y = |z| mix_f32(along_x(0, z), along_x(1, z), w.y);
    mix_f32(along_y(0), along_y(1), w.z)
}

/// `octaves` of [`perlin`], halved in wavelength and strength from one to the next.
pub fn fbm(p: Vec3, octaves: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut amplitude = 1.0;
    let mut q = p;
    for octave in 0..octaves {
        sum += amplitude * perlin(q, seed.wrapping_add(octave));
        amplitude *= 0.5;
        q *= 2.0;
    }
    sum
}

/// Round humps of about one cell's width with creases between, mean 0, within [`BUMP_RANGE`].
pub fn bumps(p: Vec3, seed: u32) -> f32 {
    let floor = p.floor();
    let cell = floor.as_ivec3();
    let f = p - floor;
    let mut nearest = f32::INFINITY;
    for z in -1..=1 {
        for y in -1..=1 {
            for x in -1..=1 {
                let offset = IVec3::new(x, y, z);
                let h = hash(cell + offset, seed);
                let jitter = Vec3::new(bits(h), bits(h >> 10), bits(h >> 20));
                nearest = nearest.min((offset.as_vec3() + jitter - f).length_squared());
            }
        }
    }
    MEAN_SQUARED_DISTANCE - nearest
}

/// 3 t² - 2 t³ of `t` cut to 0..1, the position of `x` from `low` to `high`.
pub fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn mix_f32(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

fn hash(cell: IVec3, seed: u32) -> u32 {
    let c = cell.as_uvec3();
    mix(c.x.wrapping_mul(0x8da6_b343)
        ^ c.y.wrapping_mul(0xd816_3841)
        ^ c.z.wrapping_mul(0xcb1a_b31f)
        ^ seed.wrapping_mul(0x9e37_79b1))
}

fn mix(mut h: u32) -> u32 {
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb_352d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}

fn unit(h: u32) -> f32 {
    (h >> 8) as f32 / (1 << 24) as f32
}

fn bits(h: u32) -> f32 {
    (h & 1023) as f32 / 1024.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, least and largest value of a field over 200,000 positions in 60³ cells.
    fn figures(field: impl Fn(Vec3) -> f32) -> (f64, f32, f32) {
        let mut random = Random::new(2);
        let (mut sum, mut low, mut high) = (0.0, f32::INFINITY, f32::NEG_INFINITY);
        for _ in 0..200_000 {
            let [x, y, z] = [(); 3].map(|()| random.within(-30.0, 30.0));
            let value = field(Vec3::new(x, y, z));
            sum += f64::from(value);
            low = low.min(value);
            high = high.max(value);
        }
        (sum / 200_000.0, low, high)
    }

    // Standard errors: values of deviation 0.3 (fbm 0.35) at 200,000 positions, which see each of
    // 216,000 cells about once: 0.001 at most; five of them.
    const MEAN_TOLERANCE: f64 = 0.005;

    #[test]
    fn ranges_and_means() {
        let (mean, low, high) = figures(|p| perlin(p, 7));
        assert!(mean.abs() < MEAN_TOLERANCE, "{mean}");
        assert!((-1.1..-0.6).contains(&low) && (0.6..1.1).contains(&high), "{low} {high}");
        let (mean, low, high) = figures(|p| fbm(p, 3, 7));
        assert!(mean.abs() < MEAN_TOLERANCE, "{mean}");
        assert!(low < -0.7 && high > 0.7, "{low} {high}");
        let (mean, low, high) = figures(|p| bumps(p, 7));
        assert!(mean.abs() < MEAN_TOLERANCE, "{mean}");
        assert!((BUMP_RANGE[0]..-0.4).contains(&low) && (0.29..=BUMP_RANGE[1]).contains(&high));
    }

    #[test]
    fn perlin_is_zero_on_the_lattice_and_continuous_across() {
        for i in -3..3 {
            let corner = Vec3::new(i as f32, 2.0, -5.0);
            assert_eq!(perlin(corner, 3), 0.0);
            let side = corner + Vec3::new(0.0, 0.37, 0.61);
            let step = Vec3::X * 1e-3;
            // The slope of one term is at most 2, so 2e-3 between the sides, twice for the fade.
            assert!((perlin(side - step, 3) - perlin(side + step, 3)).abs() < 8e-3);
            // |grad r²| = 2 r < 2 sqrt(3), over 2e-3.
            assert!((bumps(side - step, 3) - bumps(side + step, 3)).abs() < 7e-3);
        }
    }

    #[test]
    fn seeds_differ_and_repeat() {
        let p = Vec3::new(0.3, 10.7, -4.4);
        for field in [perlin, bumps] {
            assert_eq!(field(p, 1).to_bits(), field(p, 1).to_bits());
            assert_ne!(field(p, 1), field(p, 2));
        }
        assert_ne!(stream(1, 2), stream(2, 1));
        assert_ne!(stream(0, 0), stream(0, 1));
    }

    #[test]
    fn random_directions_are_uniform() {
        let mut random = Random::new(11);
        let mut sum = Vec3::ZERO;
        let mut squares = Vec3::ZERO;
        for _ in 0..20_000 {
            let d = random.direction();
            // Five roundings around 1.
            assert!((d.length() - 1.0).abs() < 5.0 * f32::EPSILON);
            sum += d / 20_000.0;
            squares += d * d / 20_000.0;
        }
        // A component has deviation 0.58, its square 0.30: standard errors 0.0041 and 0.0021,
        // five of them for six numbers.
        assert!(sum.abs().max_element() < 0.021, "{sum}");
        assert!((squares - 1.0 / 3.0).abs().max_element() < 0.011, "{squares}");
    }
}
