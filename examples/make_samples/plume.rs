//! Plumes out of a chimney: puff after puff, carried by the wind, that grow, billow and fade.
//!
//! Each stroke of an engine, or breath of a fire, sends a puff; by its age the wind has carried it, its own
//! heat raised it, and it has grown by what it took in. Puffs carry smaller ones on their skin, and those
//! smaller ones (Neyret 1997, "Qualitative simulation of convective cloud formation and evolution"). The depth
//! under their union, in a field warped by gradient noise, is pushed in and out by round bumps of falling
//! size; the density rises over an edge that gets softer with age, is the thinner the more a puff has grown,
//! and old smoke is torn by noise into wisps. Nothing here simulates a flow.
//!
//! Units: meters and seconds; the density is 1 in the chimney. Deterministic.

use glam::{DMat4, DVec3, IVec3, Vec3};
use rayon::prelude::*;
use tyndall::volume::grid::Grid;
use tyndall::volume::shapes::noise::{Random, bumps, fbm, perlin, smoothstep};

/// What a chimney sends, and where it goes.
pub struct Plume {
    pub voxel_m: f64,
    /// Middle of the chimney's top.
    pub source: Vec3,
    pub radius: f32,
    /// [m/s]
    pub wind: Vec3,
    /// Height at which the first push has spent itself, and the time it takes.
    pub jet: [f32; 2],
    /// Of its own heat, [m/s^(2/3)].
    pub rise: f32,
    /// Of the radius, [m/s^0.8].
    pub growth: f32,
    /// From puff to puff, in radii.
    pub stride: f32,
    /// Age of the oldest puff [s].
    pub oldest: f32,
    /// How much thinner smoke is for being wider: the power of the radius.
    pub thinning: f32,
    /// How much of the oldest smoke noise takes away.
    pub tearing: f32,
    pub seed: u32,
}

#[derive(Clone, Copy)]
struct Puff {
    center: Vec3,
    radius: f32,
}

/// Puffs by cells of space.
struct Near {
    low: Vec3,
    dims: [usize; 3],
    cells: Vec<Vec<Puff>>,
}

/// Edge of such a cell [m], and how far outside of a puff it is still of interest, in its radii.
const CELL_M: f32 = 0.6;
const REACH: f32 = 0.4;

impl Plume {
    pub fn grid(&self) -> Grid {
        let puffs = self.puffs();
        let reach = |puff: &Puff| (1.0 + REACH) * puff.radius;
        let low = puffs.iter().fold(Vec3::INFINITY, |low, puff| low.min(puff.center - reach(puff)));
        let high = puffs.iter().fold(Vec3::NEG_INFINITY, |high, puff| high.max(puff.center + reach(puff)));
        let near = Near::new(&puffs, low, high);
        let dims = ((high - low).as_dvec3() / self.voxel_m).ceil().to_array().map(|n| n as usize);
        let map = DMat4::from_translation(low.as_dvec3()) * DMat4::from_scale(DVec3::splat(self.voxel_m));
        let mut values = vec![0.0; dims.iter().product()];
        values.par_chunks_mut(dims[0]).enumerate().for_each(|(row, values)| {
            for (i, value) in values.iter_mut().enumerate() {
                let index = DVec3::new(i as f64, (row % dims[1]) as f64, (row / dims[1]) as f64);
                let density = self.density(&near, map.transform_point3(index).as_vec3());
                // Steps of 1/256 of a power of two, which halves the file; what nobody sees is left out.
                let step = 2.0_f32.powi(density.max(1e-6).log2().floor() as i32 - 7);
                *value = if density < 0.002 { 0.0 } else { (density / step).round() * step };
            }
        });
        Grid::from_dense("density", 0.0, map, IVec3::ZERO, dims, &values)
    }

    /// Where the middle of a puff of this age is.
    fn place(&self, age: f32) -> Vec3 {
        let [height, time] = self.jet;
        let up = height * (1.0 - (-age / time).exp()) + self.rise * age.powf(2.0 / 3.0);
        // The wind takes hold of it little by little.
        self.source + self.wind * (age - time * (1.0 - (-age / time).exp())) + up * Vec3::Y
    }

    fn radius_at(&self, age: f32) -> f32 {
        self.radius + self.growth * age.powf(0.8)
    }

    /// Age of what is found at `p`: that of the nearest middle.
    fn age(&self, p: Vec3) -> f32 {
        let distance = |age: f32| self.place(age).distance_squared(p);
        let n = 48;
        let coarse = (0..=n).map(|k| self.oldest * k as f32 / n as f32);
        let mut best = coarse.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0.0);
        let mut step = 0.5 * self.oldest / n as f32;
        for _ in 0..4 {
            for side in [best - step, best + step] {
                if side >= 0.0 && distance(side) < distance(best) {
                    best = side;
                }
            }
            step *= 0.5;
        }
        best
    }

    fn puffs(&self) -> Vec<Puff> {
        let mut random = Random::new(self.seed);
        let mut all = Vec::new();
        let mut age = 0.0;
        while age < self.oldest {
            let radius = self.radius_at(age);
            // Eddies throw puffs about, the more the larger they have grown.
            let sway = 0.5 * (radius - self.radius) * random.direction();
            let size = radius * random.within(0.75, 1.12);
            all.push(Puff { center: self.place(age) + sway, radius: size });
            let speed = self.place(age + 0.01).distance(self.place(age)) / 0.01;
            age += self.stride * radius / speed * random.within(0.7, 1.3);
        }
        let mut parents = all.clone();
        for generation in 0..3 {
            let mut children = Vec::new();
            for parent in &parents {
                for _ in 0..[9, 7, 5][generation] {
                    let out = random.direction();
                    let radius = parent.radius * random.within(0.28, 0.52);
                    let center = parent.center + out * (parent.radius * random.within(0.78, 1.0));
                    // What lies inside of another one adds nothing.
                    let is_hidden =
                        all.iter().any(|puff| puff.center.distance(center) + 0.5 * radius < puff.radius);
                    if !is_hidden && f64::from(radius) > 1.2 * self.voxel_m {
                        children.push(Puff { center, radius });
                    }
                }
            }
            all.extend(&children);
            parents = children;
        }
        all
    }

    fn density(&self, near: &Near, p: Vec3) -> f32 {
        if near.at(p).is_empty()
            && near.at(p + Vec3::Y * CELL_M).is_empty()
            && near.at(p - Vec3::Y * CELL_M).is_empty()
        {
            return 0.0;
        }
        let age = self.age(p);
        let old = age / self.oldest;
        let radius = self.radius_at(age);
        // Eddies of several sizes, none larger than the plume.
        let mut q = p;
        for (octave, size) in [2.0, 1.0, 0.5].into_iter().enumerate() {
            let wave = size * radius;
            let warp =
                [0, 1, 2].map(|axis| perlin(p / wave.max(0.3), self.seed + 10 + 3 * octave as u32 + axis));
            q += 0.16 * wave * Vec3::from_array(warp) * old.sqrt().min(1.0);
        }
        let mut depth = -REACH * radius;
        for puff in near.at(q) {
            let one = puff.radius - puff.center.distance(q);
            depth = smooth_max(depth, one, 0.15 * puff.radius);
        }
        for (octave, size) in [0.5, 0.25, 0.125, 0.0625].into_iter().enumerate() {
            let width = size * 2.4;
            let share = smoothstep(1.8, 3.2, width / self.voxel_m as f32)
                * smoothstep(0.2, 0.6, radius / width - 0.9);
            if share > 0.0 {
                depth += 0.8 * share * width * bumps(q / width, self.seed + 30 + octave as u32);
            }
        }
        let edge = self.voxel_m as f32 * 1.3 + radius * (0.02 + 0.2 * old * old);
        let body = smoothstep(-0.5 * edge, edge, depth);
        // A thin veil hangs around it.
        let veil = 0.07 * smoothstep(-0.35 * radius, 0.0, depth) * old.min(0.6);
        let torn = fbm(q / (0.9 * radius).max(0.5), 4, self.seed + 50);
        let kept = smoothstep(-0.25, 0.25, torn + 0.55 - self.tearing * old * old * 1.2);
        let thick = (self.radius / radius).powf(self.thinning);
        // Nothing at the end, where no older puffs are.
        let end = smoothstep(1.0, 0.82, old);
        let inside = 0.75 + 0.5 * smoothstep(0.0, 0.5 * radius, depth);
        (body * inside).max(veil * smoothstep(-0.1, 0.4, torn)) * kept * thick * end
    }
}

impl Near {
    fn new(puffs: &[Puff], low: Vec3, high: Vec3) -> Self {
        let dims = ((high - low) / CELL_M).ceil().to_array().map(|n| n as usize + 1);
        let mut near = Self { low, dims, cells: vec![Vec::new(); dims.iter().product()] };
        for puff in puffs {
            let reach = Vec3::splat((1.0 + REACH) * puff.radius);
            let cell = |p: Vec3| ((p - low) / CELL_M).max(Vec3::ZERO).to_array().map(|n| n as usize);
            let (from, to) = (cell(puff.center - reach), cell(puff.center + reach));
            for k in from[2]..=to[2].min(dims[2] - 1) {
                for j in from[1]..=to[1].min(dims[1] - 1) {
                    for i in from[0]..=to[0].min(dims[0] - 1) {
                        near.cells[i + dims[0] * (j + dims[1] * k)].push(*puff);
                    }
                }
            }
        }
        near
    }

    fn at(&self, p: Vec3) -> &[Puff] {
        let last = Vec3::from_array(self.dims.map(|n| (n - 1) as f32));
        let [i, j, k] = ((p - self.low) / CELL_M).clamp(Vec3::ZERO, last).to_array().map(|n| n as usize);
        &self.cells[i + self.dims[0] * (j + self.dims[1] * k)]
    }
}

/// The larger of `a` and `b`, rounded off where they differ by less than `k` (Quilez, "Smooth minimum", 2013).
fn smooth_max(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.max(b) + 0.25 * h * h * k
}
