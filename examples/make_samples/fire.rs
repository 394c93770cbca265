//! A fire, simulated: hot gas that rises, burns out and leaves soot.
//!
//! Stable fluids (Stam 1999) on a staggered grid, incompressible, with vorticity confinement (Fedkiw, Stam,
//! Jensen 2001). Gas enters through a disk in the floor, of a strength that wanders in place and time. What
//! makes a flame of it is three numbers a cell that the flow carries: how much still burns, which shrinks by
//! as much in every step, so that tongues end sharply; heat, which burning keeps up and radiation takes as the
//! fourth power; and soot, which is made where burning ends. The floor is solid, all other sides are open.
//!
//! Units: cells and steps; the grids that are made have cells of 2.7 cm. Deterministic.

use glam::{DMat4, DVec3, IVec3, Vec3};
use rayon::prelude::*;
use tyndall::volume::grid::Grid;

const DIMS: [usize; 3] = [64, 112, 64];
const CELL_M: f64 = 0.027;
const STEPS: usize = 135;
const PRESSURE_SWEEPS: usize = 30;
const BUOYANCY: f32 = 0.12;
const CONFINEMENT: f32 = 0.26;
/// Part of the flame that burns in a step.
const BURN: f32 = 0.0095;
const COOLING: f32 = 0.022;
const SOOT: f32 = 0.022;
const SOURCE_RADIUS: f32 = 10.5;

type Cells = Vec<f32>;

struct Fire {
    /// Velocity through the low faces along each axis.
    flow: [Cells; 3],
    pressure: Cells,
    flame: Cells,
    heat: Cells,
    soot: Cells,
}

/// The grids density (of soot), temperature and flame, each from 0 to about 1.
pub fn grids() -> Vec<Grid> {
    let empty = || vec![0.0; DIMS.iter().product()];
    let mut fire = Fire {
        flow: [empty(), empty(), empty()],
        pressure: empty(),
        flame: empty(),
        heat: empty(),
        soot: empty(),
    };
    for step in 0..STEPS {
        fire.feed(step as f32);
        fire.burn();
        fire.push();
        fire.project();
        fire.carry();
    }
    let middle = DVec3::new((DIMS[0] - 1) as f64 / 2.0, 0.0, (DIMS[2] - 1) as f64 / 2.0);
    let map = DMat4::from_scale(DVec3::splat(CELL_M)) * DMat4::from_translation(-middle);
    // What nobody sees is left out of the file.
    let grid = |name: &str, cells: &Cells, least: f32| {
        let kept: Cells = cells.iter().map(|&value| if value < least { 0.0 } else { value }).collect();
        Grid::from_dense(name, 0.0, map, IVec3::ZERO, DIMS, &kept)
    };
    // Flames fade out, though what burns ends sharply.
    let flame = fire.flame.iter().map(|&flame| smoothstep(flame)).collect();
    vec![
        grid("density", &fire.soot, 0.01),
        grid("temperature", &fire.heat, 0.05),
        grid("flame", &flame, 0.004),
    ]
}

fn idx(x: usize, y: usize, z: usize) -> usize {
    x + DIMS[0] * (y + DIMS[1] * z)
}

/// A value for each cell, from its indices.
fn each(value: impl Fn(usize, usize, usize) -> f32 + Sync) -> Cells {
    let mut cells = vec![0.0; DIMS.iter().product()];
    cells.par_chunks_mut(DIMS[0] * DIMS[1]).enumerate().for_each(|(z, layer)| {
        for (n, cell) in layer.iter_mut().enumerate() {
            *cell = value(n % DIMS[0], n / DIMS[0], z);
        }
    });
    cells
}

/// Trilinear; outside, the nearest value.
fn sample(cells: &Cells, p: Vec3) -> f32 {
    let last = Vec3::new((DIMS[0] - 1) as f32, (DIMS[1] - 1) as f32, (DIMS[2] - 1) as f32);
    let p = p.clamp(Vec3::ZERO, last);
    let [x, y, z] = [p.x as usize, p.y as usize, p.z as usize];
    let t = p - place(x, y, z);
    let strides = [1, DIMS[0], DIMS[0] * DIMS[1]];
    let next = |axis: usize, n: usize| if n + 1 < DIMS[axis] { strides[axis] } else { 0 };
    let (low, dx, dy, dz) = (idx(x, y, z), next(0, x), next(1, y), next(2, z));
    let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
    let row = |at: usize| mix(cells[at], cells[at + dx], t.x);
    mix(mix(row(low), row(low + dy), t.y), mix(row(low + dz), row(low + dy + dz), t.y), t.z)
}

fn place(x: usize, y: usize, z: usize) -> Vec3 {
    Vec3::new(x as f32, y as f32, z as f32)
}

/// From 0 to 1 without corners.
fn smoothstep(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Waves in the plane that never repeat, -1..1.
fn waves(x: f32, z: f32, t: f32) -> f32 {
    let one = |a: f32, b: f32, c: f32, d: f32| (a * x + b * z + c * t + d).sin();
    0.3 * (one(0.31, 0.17, 0.11, 0.3) + one(-0.21, 0.37, 0.083, 1.9) + one(0.47, -0.29, -0.13, 4.1))
        + 0.1 * one(0.83, 0.71, 0.29, 2.6)
}

impl Fire {
    /// Gas comes in at the floor.
    fn feed(&mut self, t: f32) {
        let center = [DIMS[0], DIMS[2]].map(|n| (n - 1) as f32 / 2.0);
        for z in 0..DIMS[2] {
            for y in 1..5 {
                for x in 0..DIMS[0] {
                    let (dx, dz) = (x as f32 - center[0], z as f32 - center[1]);
                    let reach = SOURCE_RADIUS * (1.0 + 0.5 * waves(1.1 * dx, 1.1 * dz, 0.6 * t));
                    let edge = smoothstep((reach - (dx * dx + dz * dz).sqrt()) / 4.0);
                    let strength = edge * (0.7 + waves(1.2 * dx, 1.2 * dz, 1.1 * t)).clamp(0.0, 1.0);
                    let at = idx(x, y, z);
                    self.flame[at] = self.flame[at].max(strength);
                    self.heat[at] = self.heat[at].max(strength);
                    self.flow[1][at] = self.flow[1][at].max(0.8 * strength);
                    self.flow[0][at] += 0.07 * edge * waves(dz, dx, 1.3 * t);
                    self.flow[2][at] += 0.07 * edge * waves(dx + 40.0, dz, 1.3 * t);
                }
            }
        }
    }

    fn burn(&mut self) {
        let burnt = each(|x, y, z| {
            let flame = self.flame[idx(x, y, z)];
            flame.min(BURN) * (if flame < 0.35 { 1.0 } else { 0.15 })
        });
        let fields = self.flame.par_iter_mut().zip(&mut self.heat).zip(&mut self.soot).zip(&burnt);
        fields.for_each(|(((flame, heat), soot), burnt)| {
            let is_alight = *flame > 0.0;
            *flame = (*flame - BURN).max(0.0);
            *heat -= COOLING * heat.powi(4) + if is_alight { 0.0 } else { 0.015 * *heat };
            *soot = (*soot + SOOT * burnt / BURN) * 0.998;
        });
    }

    /// Velocity in the middle of a cell.
    fn velocity(&self, x: usize, y: usize, z: usize) -> Vec3 {
        self.velocity_at(place(x, y, z))
    }

    fn velocity_at(&self, p: Vec3) -> Vec3 {
        Vec3::new(
            sample(&self.flow[0], p + Vec3::new(0.5, 0.0, 0.0)),
            sample(&self.flow[1], p + Vec3::new(0.0, 0.5, 0.0)),
            sample(&self.flow[2], p + Vec3::new(0.0, 0.0, 0.5)),
        )
    }

    /// Buoyancy, and what keeps eddies alive.
    fn push(&mut self) {
        let middle: [Cells; 3] = std::array::from_fn(|axis| each(|x, y, z| self.velocity(x, y, z)[axis]));
        let slope = |cells: &Cells, axis: usize, x: usize, y: usize, z: usize| {
            let at = [x, y, z];
            let mut low = at;
            let mut high = at;
            low[axis] = at[axis].saturating_sub(1);
            high[axis] = (at[axis] + 1).min(DIMS[axis] - 1);
            0.5 * (cells[idx(high[0], high[1], high[2])] - cells[idx(low[0], low[1], low[2])])
        };
        let curl: [Cells; 3] = std::array::from_fn(|axis| {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            each(|x, y, z| slope(&middle[c], b, x, y, z) - slope(&middle[b], c, x, y, z))
        });
        let spin = each(|x, y, z| {
            let at = idx(x, y, z);
            Vec3::new(curl[0][at], curl[1][at], curl[2][at]).length()
        });
        let force: [Cells; 3] = std::array::from_fn(|axis| {
            each(|x, y, z| {
                let at = idx(x, y, z);
                let towards = Vec3::from_array(std::array::from_fn(|a| slope(&spin, a, x, y, z)));
                let curl = Vec3::new(curl[0][at], curl[1][at], curl[2][at]);
                let eddies = CONFINEMENT * towards.normalize_or_zero().cross(curl)[axis];
                eddies + if axis == 1 { BUOYANCY * self.heat[at] } else { 0.0 }
            })
        });
        for (axis, (flow, force)) in self.flow.iter_mut().zip(&force).enumerate() {
            let half = Vec3::from_array(std::array::from_fn(|a| if a == axis { 0.5 } else { 0.0 }));
            *flow = each(|x, y, z| flow[idx(x, y, z)] + sample(force, place(x, y, z) - half));
        }
    }

    /// Takes the divergence out of the flow.
    fn project(&mut self) {
        let [nx, ny, nz] = DIMS;
        let next = |cells: &Cells, axis: usize, x: usize, y: usize, z: usize| {
            let mut at = [x, y, z];
            at[axis] = (at[axis] + 1).min(DIMS[axis] - 1);
            cells[idx(at[0], at[1], at[2])]
        };
        self.flow[1].par_iter_mut().enumerate().for_each(|(n, v)| {
            if n / nx % ny == 0 {
                *v = 0.0;
            }
        });
        let divergence = each(|x, y, z| {
            let at = idx(x, y, z);
            (0..3).map(|axis| next(&self.flow[axis], axis, x, y, z) - self.flow[axis][at]).sum()
        });
        for _ in 0..PRESSURE_SWEEPS {
            let p = &self.pressure;
            self.pressure = each(|x, y, z| {
                let at = idx(x, y, z);
                // Open sides hold 0, the solid floor what stands above it.
                let low = |is_inside: bool, stride: usize| if is_inside { p[at - stride] } else { 0.0 };
                let high = |is_inside: bool, stride: usize| if is_inside { p[at + stride] } else { 0.0 };
                let floor = if y > 0 { p[at - nx] } else { p[at] };
                let around = low(x > 0, 1)
                    + high(x + 1 < nx, 1)
                    + floor
                    + high(y + 1 < ny, nx)
                    + low(z > 0, nx * ny)
                    + high(z + 1 < nz, nx * ny);
                (around - divergence[at]) / 6.0
            });
        }
        for axis in 0..3 {
            let flow = &self.flow[axis];
            let p = &self.pressure;
            self.flow[axis] = each(|x, y, z| {
                let at = [x, y, z];
                let here = p[idx(x, y, z)];
                let stride = [1, nx, nx * ny][axis];
                let before = match at[axis] {
                    0 if axis == 1 => here,
                    0 => 0.0,
                    _ => p[idx(x, y, z) - stride],
                };
                flow[idx(x, y, z)] - (here - before)
            });
        }
    }

    /// Everything moves with the flow: from where it was half a step ago by what flowed there.
    fn carry(&mut self) {
        let from = |p: Vec3| {
            let half_way = p - 0.5 * self.velocity_at(p);
            p - self.velocity_at(half_way)
        };
        let [flame, heat, soot] = [&self.flame, &self.heat, &self.soot]
            .map(|cells| each(|x, y, z| sample(cells, from(place(x, y, z)))));
        let flow = std::array::from_fn(|axis| {
            let half = Vec3::from_array(std::array::from_fn(|a| if a == axis { 0.5 } else { 0.0 }));
            each(|x, y, z| 0.999 * sample(&self.flow[axis], from(place(x, y, z) - half) + half))
        });
        (self.flame, self.heat, self.soot, self.flow) = (flame, heat, soot, flow);
    }
}
