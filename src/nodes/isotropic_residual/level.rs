//! One grid of the cascade: its shader parameters, fields and bound stages.

use crate::gpu::{Bind, Bound, Buffer, Format, Gpu, GpuError, Stage, Texture};
use crate::graph::NodeError;
use crate::mirror;
use crate::optics::delta::DeltaScaled;
use crate::optics::directions::{LineDirection, LineSet};
use crate::wire::{Channels, Medium, Surfaces};

use super::super::Run;
use super::super::bands::Bands;
use super::sources::Sources;
use super::walls::walls;

pub(super) const REMEDY: &str = "lower medium.max_resolution or medium.max_cells";

/// Sweeps of one submission at the most; of as many the moments are not rounded in between.
pub(super) const SWEEPS_AT_ONCE: usize = 4;

/// Lines that a workgroup adds up, at least.
const LINES_OF_A_SUM: usize = 1024;
/// Workgroups along an axis that every device can dispatch.
const MOST_SUMS: usize = 65_535;
/// `THREADS` of `line_sum.wgsl`.
pub(super) const THREADS_OF_A_SUM: usize = 64;

mirror! {
    /// `Channel` of `common.wgsl`.
    pub(super) struct ChannelTexel {
        k: f32,
        scatter: f32,
        absorb: f32,
        inflow: f32,
    }
}

mirror! {
    /// `Level` of `common.wgsl`.
    pub(super) struct LevelParams {
        dims: [u32; 3],
        n_channels: u32,
        cell_m: f32,
        g_star: f32,
        n_directions: u32,
        n_threads: u32,
        channels: [ChannelTexel; 3],
    }
}

mirror! {
    /// `Direction` of `batch.wgsl`.
    pub(super) struct DirectionTexel {
        e: [i32; 3],
        weight: f32,
        omega: [f32; 3],
        stride: f32,
    }
}

mirror! {
    /// `Batch` of `batch.wgsl`.
    pub(super) struct BatchParams {
        level: LevelParams,
        first: u32,
        n_pairs: u32,
        first_channel: u32,
        pad: u32,
        directions: [DirectionTexel; LineSet::MOST],
    }
}

mirror! {
    /// `LineSumParams` of `line_sum.wgsl`.
    pub(super) struct LineSumParams {
        n_lines: u32,
        n_sums: u32,
        lines_per_sum: u32,
        pad: u32,
    }
}

mirror! {
    /// `BalanceParams` of `balance.wgsl`.
    pub(super) struct BalanceParams {
        level: LevelParams,
        entering: f32,
        rebalance: u32,
        n_sums: u32,
        n_sources: u32,
    }
}

/// What all levels share.
pub(super) struct Problem {
    pub(super) n_channels: usize,
    pub(super) directions: Vec<LineDirection>,
    /// Whether lobes have a direction.
    has_lobes: bool,
    g_star: f64,
    channels: [ChannelTexel; 3],
    /// Which segments end at surfaces (`walls.rs`), for each grid, finest first; none where no surface is inside.
    walls: Vec<Option<Buffer>>,
}

impl Problem {
    pub(super) fn new(
        medium: &Medium,
        channels: &Channels,
        ambient: [f64; 3],
        lines: LineSet,
        has_lobes: bool,
    ) -> Self {
        let inflow = channels.project(ambient);
        let texels = std::array::from_fn(|c| {
            let scaled = DeltaScaled::new(medium.albedo[c], medium.g);
            ChannelTexel {
                k: scaled.k as f32,
                scatter: scaled.sigma_s_ratio as f32,
                absorb: (scaled.sigma_a_ratio / scaled.k) as f32,
                inflow: inflow[c] as f32,
            }
        });
        let g_star = DeltaScaled::new(1.0, medium.g).g_star;
        Self {
            n_channels: channels.count,
            directions: lines.directions(),
            has_lobes,
            g_star,
            channels: texels,
            walls: Vec::new(),
        }
    }

    /// The same with these surfaces between the cells of grids of these sizes, finest first.
    pub(super) fn behind(
        self,
        gpu: &Gpu,
        surfaces: &Surfaces,
        grids: &[[usize; 3]],
    ) -> Result<Self, GpuError> {
        let wall = |(n_halvings, dims): (usize, &[usize; 3])| {
            let bits = walls(&surfaces.corners, *dims, n_halvings, &self.directions);
            bits.map(|bits| gpu.buffer_from("surfaces between cells", &bits, REMEDY)).transpose()
        };
        let walls = grids.iter().enumerate().map(wall).collect::<Result<_, GpuError>>()?;
        Ok(Self { walls, ..self })
    }

    /// Which segments of a grid end at surfaces.
    pub(super) fn walls_of(&self, grid: usize) -> Option<&Buffer> {
        self.walls.get(grid)?.as_ref()
    }

    /// Shader parameters of a level.
    pub(super) fn level(&self, dims: [usize; 3], cell_m: f64) -> LevelParams {
        LevelParams {
            dims: dims.map(|n| n as u32),
            n_channels: self.n_channels as u32,
            cell_m: cell_m as f32,
            g_star: self.g_star as f32,
            n_directions: self.directions.len() as u32,
            n_threads: self
                .directions
                .iter()
                .map(|direction| lines(direction, dims).n_threads())
                .max()
                .unwrap_or(0) as u32,
            channels: self.channels,
        }
    }

    /// Cells of all channels, channels along z.
    pub(super) fn layers(&self, dims: [usize; 3]) -> [usize; 3] {
        [dims[0], dims[1], dims[2] * self.n_channels]
    }
}

/// The threads of one direction: one axis of the face its lines start on, the other, and its
/// interleaved sets of lines. The shader marches along z before y before x.
struct Lines {
    n_u: usize,
    n_v: usize,
    n_phases: usize,
}

impl Lines {
    fn n_threads(&self) -> usize {
        self.n_u * self.n_v * self.n_phases
    }
}

fn lines(direction: &LineDirection, dims: [usize; 3]) -> Lines {
    let steps = direction.e.abs().to_array().map(|n| n as usize);
    let hop = steps.into_iter().max().unwrap_or(1);
    let along = (0..3).rev().find(|&axis| steps[axis] == hop).unwrap_or(2);
    let (u, v) = match along {
        0 => (1, 2),
        1 => (0, 2),
        _ => (0, 1),
    };
    Lines { n_u: dims[u], n_v: dims[v], n_phases: hop.min(dims[along]) }
}

/// Power in m² that enters for an inflow of 1 on every line, as the sweep counts it: a cell whose
/// predecessor lies outside begins a line.
fn entering(problem: &Problem, dims: [usize; 3], cell_m: f64) -> f64 {
    let all: usize = dims.iter().product();
    problem
        .directions
        .iter()
        .map(|direction| {
            let steps = direction.e.abs().to_array();
            let inside: usize = (0..3).map(|axis| dims[axis].saturating_sub(steps[axis] as usize)).product();
            direction.weight * (all - inside) as f64 * cell_m * cell_m / direction.step_length()
        })
        .sum()
}

/// Which (channel, direction) pairs are swept by one dispatch, and among whose lobes.
struct Batch {
    first: usize,
    n_pairs: usize,
    group: usize,
}

/// What levels share: the mean radiances of a batch, and the division into batches.
pub(super) struct Scratch {
    mean_radiance: Buffer,
    /// Takes turns with a level's moments where a channel needs several batches.
    partial: Texture,
    batches: Vec<Batch>,
    /// Channels whose lobes stand in one buffer: all of them, or one.
    channels_per_group: usize,
}

/// The largest scratch; beyond this a larger one saves nothing.
pub(super) const BATCH_BYTES: u64 = 1 << 30;
/// Bytes of a packed lobe.
const LOBE_BYTES: u64 = 16;

impl Scratch {
    /// For the finest level, with batches of at most `batch_bytes`, or of one direction.
    pub(super) fn new(
        gpu: &Gpu,
        problem: &Problem,
        dims: [usize; 3],
        batch_bytes: u64,
    ) -> Result<Self, GpuError> {
        let n_cells = dims.iter().product::<usize>() as u64;
        let n_directions = problem.directions.len();
        let n_pairs = problem.n_channels * n_directions;
        let room = (batch_bytes.min(gpu.max_binding_bytes()) / (4 * n_cells)) as usize;
        // All channels at once, or one after the other in as few batches as fit.
        let at_once =
            room >= n_pairs && LOBE_BYTES * n_cells * problem.n_channels as u64 <= gpu.max_binding_bytes();
        let (batch, channels_per_group) = if at_once {
            (n_pairs, problem.n_channels)
        } else {
            (n_directions.div_ceil(n_directions.div_ceil(room.max(1))), 1)
        };
        let group_pairs = channels_per_group * n_directions;
        let batches: Vec<Batch> = (0..n_pairs / group_pairs)
            .flat_map(|group| {
                (0..group_pairs).step_by(batch).map(move |first| Batch {
                    first: group * group_pairs + first,
                    n_pairs: batch.min(group_pairs - first),
                    group,
                })
            })
            .collect();
        let whole = batch == group_pairs;
        let partial = if whole { [1; 3] } else { problem.layers(dims) };
        Ok(Self {
            mean_radiance: gpu.buffer("radiances of a sweep", 4 * n_cells * batch as u64, REMEDY)?,
            partial: gpu.texture3("moments of a sweep", partial, Format::Rgba32Float, REMEDY)?,
            batches,
            channels_per_group,
        })
    }
}

/// A grid of the cascade with everything bound.
pub(super) struct Level {
    pub(super) params: LevelParams,
    /// phi and F after the last sweep.
    pub(super) moments: Texture,
    /// Factors of three channels.
    pub(super) balance: Buffer,
    layers: [usize; 3],
    /// Cells of the channels of a batch.
    batch_layers: [usize; 3],
    n_channels: usize,
    steps: Vec<Step>,
    line_sum: Bound,
    /// Sums of a channel's lines.
    n_sums: usize,
    rebalance: Bound,
    keep: Bound,
}

/// The stages of one batch.
struct Step {
    start: Option<Bound>,
    sweep: Bound,
    threads: [usize; 3],
    /// Into lobes, and into moments; partial sums for all but the last batch of a channel.
    gather: [Bound; 2],
    /// The last batch of its channels.
    completes: bool,
}

impl Level {
    pub(super) fn new(
        gpu: &Gpu,
        problem: &Problem,
        scratch: &Scratch,
        grid: usize,
        cell_m: f64,
        [sigma_t, sources]: [&Texture; 2],
        finest: &Sources,
    ) -> Result<Self, GpuError> {
        let dims = sigma_t.dims().map(|n| n as usize);
        let n_cells = dims.iter().product::<usize>() as u64;
        let params = problem.level(dims, cell_m);
        let layers = problem.layers(dims);
        let n_directions = problem.directions.len();
        let n_lines = params.n_threads as usize * n_directions;
        let lines_per_sum = lines_per_sum(n_lines);
        let n_sums = n_lines.div_ceil(lines_per_sum);
        let moments = gpu.texture3("moments", layers, Format::Rgba32Float, REMEDY)?;
        let balance = gpu.buffer_from("balance", &[1.0_f32; 3], REMEDY)?;
        let powers = |what, n: usize| gpu.buffer(what, 8 * (n * problem.n_channels) as u64, REMEDY);
        let (line_powers, line_sums) =
            (powers("powers of lines", n_lines)?, powers("sums of powers", n_sums)?);
        let lobe_bytes = LOBE_BYTES * n_cells * scratch.channels_per_group as u64;
        let lobes = (0..problem.n_channels / scratch.channels_per_group)
            .map(|_| gpu.buffer("lobes", lobe_bytes, REMEDY))
            .collect::<Result<Vec<Buffer>, GpuError>>()?;

        let walls = problem.walls_of(grid);
        let choices = [("lobes", problem.has_lobes.to_string()), ("walls", walls.is_some().to_string())];
        let [lobe, sweep, partial, to_lobes, to_moments, line_sum, balance_stage] =
            ["lobe", "sweep", "gather_partial", "gather_lobes", "gather_moments", "line_sum", "balance"]
                .map(|stage| gpu.stage(&format!("isotropic_residual/{stage}"), &choices));
        let (lobe, sweep, partial) = (lobe?, sweep?, partial?);
        let (to_lobes, to_moments) = (to_lobes?, to_moments?);
        let (line_sum, balance_stage) = (line_sum?, balance_stage?);
        let span = |axis: fn(&Lines) -> usize| {
            problem.directions.iter().map(|direction| axis(&lines(direction, dims))).max().unwrap_or(1)
        };
        // Enough for every direction; a thread beyond its own grid returns.
        let threads = [span(|lines| lines.n_u), span(|lines| lines.n_v * lines.n_phases)];
        let group_pairs = scratch.channels_per_group * n_directions;
        let steps = scratch
            .batches
            .iter()
            .map(|batch| {
                let params = BatchParams {
                    level: params,
                    first: batch.first as u32,
                    n_pairs: batch.n_pairs as u32,
                    first_channel: (batch.group * scratch.channels_per_group) as u32,
                    pad: 0,
                    directions: std::array::from_fn(|n| direction_texel(&problem.directions, n)),
                };
                let bind = |stage: &Stage, inputs: &[Bind], outputs: &[Bind]| {
                    stage.bind(gpu, &params, inputs, outputs)
                };
                let lobes = || Bind::Buffer(&lobes[batch.group]);
                let fields = || [Bind::Texture(sigma_t), Bind::Texture(sources)];
                // Batches of a channel take turns, so that the last one reads what those before it left.
                let end = (batch.group + 1) * group_pairs;
                let to_come = (end - batch.first).div_ceil(scratch.batches[0].n_pairs);
                let (earlier, into) = if to_come % 2 == 1 {
                    (&scratch.partial, &moments)
                } else {
                    (&moments, &scratch.partial)
                };
                let gathered = || vec![Bind::Buffer(&scratch.mean_radiance), Bind::Texture(earlier)];
                let gather = if to_come > 1 {
                    [0, 1].map(|_| bind(&partial, &gathered(), &[Bind::Texture(into)]))
                } else {
                    let balanced = || [gathered(), vec![Bind::Buffer(&balance)]].concat();
                    [
                        bind(&to_lobes, &[balanced(), fields().to_vec()].concat(), &[lobes()]),
                        bind(&to_moments, &balanced(), &[Bind::Texture(&moments)]),
                    ]
                };
                let begins = batch.first % group_pairs == 0;
                let swept: Vec<Bind> = [lobes()].into_iter().chain(walls.map(Bind::Buffer)).collect();
                let outputs = [Bind::Buffer(&scratch.mean_radiance), Bind::Buffer(&line_powers)];
                Step {
                    start: begins.then(|| {
                        let [a, b] = fields();
                        bind(&lobe, &[a, b, Bind::Texture(&moments)], &[lobes()])
                    }),
                    sweep: bind(&sweep, &swept, &outputs),
                    threads: [threads[0], threads[1], batch.n_pairs],
                    gather,
                    completes: to_come == 1,
                }
            })
            .collect();
        let bind_balance = |rebalance: u32| {
            let params = BalanceParams {
                level: params,
                entering: entering(problem, dims, cell_m) as f32,
                rebalance,
                n_sums: n_sums as u32,
                n_sources: finest.n_sums as u32,
            };
            let inputs = [Bind::Buffer(&line_sums), Bind::Buffer(&finest.sums)];
            balance_stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&balance)])
        };
        let (rebalance, keep) = (bind_balance(1), bind_balance(0));
        let params_of_sums = LineSumParams {
            n_lines: n_lines as u32,
            n_sums: n_sums as u32,
            lines_per_sum: lines_per_sum as u32,
            pad: 0,
        };
        let line_sum =
            line_sum.bind(gpu, &params_of_sums, &[Bind::Buffer(&line_powers)], &[Bind::Buffer(&line_sums)]);
        let batch_layers = [dims[0], dims[1], dims[2] * scratch.channels_per_group];
        let n_channels = problem.n_channels;
        Ok(Self {
            params,
            moments,
            balance,
            layers,
            batch_layers,
            n_channels,
            steps,
            line_sum,
            n_sums,
            rebalance,
            keep,
        })
    }

    /// Cells of all channels.
    pub(super) fn layers(&self) -> [usize; 3] {
        self.layers
    }

    /// `n` sweeps, from the moments to the moments, each followed by the factor that balances power
    /// (1 unless `balanced`). Between submissions a cancel is heard.
    pub(super) fn sweep(&self, run: &Run, n: usize, balanced: bool) -> Result<(), NodeError> {
        let balance = if balanced { &self.rebalance } else { &self.keep };
        let n_steps = self.steps.len();
        for part in Bands::new(n * n_steps, SWEEPS_AT_ONCE * n_steps) {
            let mut recorder = run.gpu.recorder("isotropic_residual");
            if part.start == 0 {
                for step in self.steps.iter().filter_map(|step| step.start.as_ref()) {
                    recorder.dispatch(step, self.batch_layers);
                }
            }
            for (idx, step) in part.map(|at| (at / n_steps, &self.steps[at % n_steps])) {
                let into = usize::from(idx + 1 == n);
                recorder.dispatch(&step.sweep, step.threads);
                if step.completes {
                    // Channels that are still to come get a stale factor here, and theirs before it is read.
                    recorder.dispatch(&self.line_sum, [self.n_sums * THREADS_OF_A_SUM, 1, self.n_channels]);
                    recorder.dispatch(balance, [1, 1, self.n_channels]);
                }
                recorder.dispatch(&step.gather[into], self.batch_layers);
            }
            run.finish(recorder)?;
        }
        Ok(())
    }
}

/// Lines of a sum, so many that no device has too many sums.
pub(super) fn lines_per_sum(n_lines: usize) -> usize {
    n_lines.div_ceil(MOST_SUMS).max(LINES_OF_A_SUM)
}

fn direction_texel(directions: &[LineDirection], n: usize) -> DirectionTexel {
    let direction = &directions[n.min(directions.len() - 1)];
    DirectionTexel {
        e: direction.e.to_array(),
        weight: direction.weight as f32,
        omega: direction.unit().as_vec3().to_array(),
        stride: direction.step_length() as f32,
    }
}
