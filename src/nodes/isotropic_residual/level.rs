//! One grid of the cascade: its shader parameters, fields and bound stages.

use std::sync::Arc;

use crate::gpu::{Bind, Bound, Buffer, Format, Gpu, GpuError, Recorder, Texture};
use crate::mirror;
use crate::optics::delta::DeltaScaled;
use crate::optics::directions::{LineDirection, LineSet};
use crate::wire::{Channels, Medium};

pub(super) const REMEDY: &str = "lower medium.max_resolution or medium.max_cells";

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
        pad_0: u32,
        pad_1: u32,
        directions: [DirectionTexel; 50],
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
    g_star: f64,
    channels: [ChannelTexel; 3],
}

impl Problem {
    pub(super) fn new(medium: &Medium, channels: &Channels, ambient: [f64; 3], lines: LineSet) -> Self {
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
        Self { n_channels: channels.count, directions: lines.directions(), g_star, channels: texels }
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

/// Power that enters for an inflow of 1 on every line, as the sweep counts it [m²]: a cell whose
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

/// A grid of the cascade with everything bound.
pub(super) struct Level {
    pub(super) dims: [usize; 3],
    pub(super) params: LevelParams,
    pub(super) sigma_t: Arc<Texture>,
    pub(super) sources: Arc<Texture>,
    /// What a sweep leaves, before its factor.
    pub(super) moments: Texture,
    /// Factors of three channels; power in of three; power out and absorbed of three.
    pub(super) balance: Buffer,
    layers: [usize; 3],
    lobe: Bound,
    batches: Vec<(Bound, Bound, [usize; 3])>,
    rebalance: Bound,
    keep: Bound,
    n_channels: usize,
}

/// Scratch that levels share: the mean radiances of a batch of directions.
pub(super) struct Scratch {
    mean_radiance: Buffer,
    pairs_per_batch: usize,
    /// Takes turns with a level's moments where a sweep needs several batches.
    partial: Texture,
}

/// The largest batch; beyond this a larger one saves nothing.
pub(super) const BATCH_BYTES: u64 = 1 << 30;

impl Scratch {
    /// For the finest level, with batches of at most `batch_bytes`, or of one direction.
    pub(super) fn new(
        gpu: &Gpu,
        problem: &Problem,
        dims: [usize; 3],
        batch_bytes: u64,
    ) -> Result<Self, GpuError> {
        let cells_bytes = 4 * dims.iter().product::<usize>() as u64;
        let n_pairs = problem.n_channels * problem.directions.len();
        let room = (gpu.max_binding_bytes().min(batch_bytes) / cells_bytes) as usize;
        let pairs_per_batch = room.clamp(1, n_pairs);
        let one_batch = pairs_per_batch >= n_pairs;
        Ok(Self {
            mean_radiance: gpu.buffer(
                "radiances of a sweep",
                cells_bytes * pairs_per_batch as u64,
                REMEDY,
            )?,
            pairs_per_batch,
            partial: gpu.texture3(
                "moments of a sweep",
                if one_batch { [1; 3] } else { problem.layers(dims) },
                Format::Rgba32Float,
                REMEDY,
            )?,
        })
    }
}

impl Level {
    pub(super) fn new(
        gpu: &Gpu,
        problem: &Problem,
        scratch: &Scratch,
        cell_m: f64,
        [sigma_t, sources]: [Arc<Texture>; 2],
        source_sums: &Buffer,
    ) -> Result<Self, GpuError> {
        let dims = sigma_t.dims().map(|n| n as usize);
        let params = problem.level(dims, cell_m);
        let layers = problem.layers(dims);
        let moments = gpu.texture3("moments", layers, Format::Rgba32Float, REMEDY)?;
        let lobes = gpu.texture3("lobes", layers, Format::Rgba32Uint, REMEDY)?;
        let balance = gpu.buffer_from("balance", &[1.0_f32; 12], REMEDY)?;
        let n_pairs = problem.n_channels * problem.directions.len();
        let n_sums = params.n_threads as usize * problem.directions.len();
        let line_sums = gpu.buffer("powers of lines", 8 * (n_sums * problem.n_channels) as u64, REMEDY)?;

        let lobe = gpu.stage("isotropic_residual/lobe", &[])?.bind(
            gpu,
            &params,
            &[
                Bind::Texture(&sigma_t),
                Bind::Texture(&sources),
                Bind::Texture(&moments),
                Bind::Buffer(&balance),
            ],
            &[Bind::Texture(&lobes)],
        );
        let sweep = gpu.stage("isotropic_residual/sweep", &[])?;
        let reduce = gpu.stage("isotropic_residual/reduce", &[])?;
        // Enough for every direction; a thread beyond its own grid returns.
        let span = |axis: fn(&Lines) -> usize| {
            problem.directions.iter().map(|direction| axis(&lines(direction, dims))).max().unwrap_or(1)
        };
        let threads = [span(|lines| lines.n_u), span(|lines| lines.n_v * lines.n_phases)];
        let n_batches = n_pairs.div_ceil(scratch.pairs_per_batch);
        let batches = (0..n_batches)
            .map(|batch| {
                let first = batch * scratch.pairs_per_batch;
                let pairs = scratch.pairs_per_batch.min(n_pairs - first);
                let params = BatchParams {
                    level: params,
                    first: first as u32,
                    n_pairs: pairs as u32,
                    pad_0: 0,
                    pad_1: 0,
                    directions: std::array::from_fn(|n| direction_texel(&problem.directions, n)),
                };
                // The last batch must leave its sum in `moments`.
                let (earlier, into) = if (n_batches - batch) % 2 == 1 {
                    (&scratch.partial, &moments)
                } else {
                    (&moments, &scratch.partial)
                };
                let outputs = [Bind::Buffer(&scratch.mean_radiance), Bind::Buffer(&line_sums)];
                let swept = sweep.bind(gpu, &params, &[Bind::Texture(&lobes)], &outputs);
                let inputs = [Bind::Buffer(&scratch.mean_radiance), Bind::Texture(earlier)];
                let reduced = reduce.bind(gpu, &params, &inputs, &[Bind::Texture(into)]);
                (swept, reduced, [threads[0], threads[1], pairs])
            })
            .collect();
        let balance_stage = gpu.stage("isotropic_residual/balance", &[])?;
        let bind_balance = |rebalance: u32| {
            let params = BalanceParams {
                level: params,
                entering: entering(problem, dims, cell_m) as f32,
                rebalance,
                n_sums: n_sums as u32,
                n_sources: (source_sums.bytes() as usize / 4 / problem.n_channels) as u32,
            };
            let inputs = [Bind::Buffer(&line_sums), Bind::Buffer(source_sums)];
            balance_stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&balance)])
        };
        let (rebalance, keep) = (bind_balance(1), bind_balance(0));
        let n_channels = problem.n_channels;
        Ok(Self {
            dims,
            params,
            sigma_t,
            sources,
            moments,
            balance,
            layers,
            lobe,
            batches,
            rebalance,
            keep,
            n_channels,
        })
    }

    /// Cells of all channels.
    pub(super) fn layers(&self) -> [usize; 3] {
        self.layers
    }

    /// One sweep: lobes from the moments, moments from the lines, and the factor that balances them
    /// (1 unless `balanced`).
    pub(super) fn sweep(&self, recorder: &mut Recorder, balanced: bool) {
        recorder.dispatch(&self.lobe, self.layers);
        for (sweep, reduce, threads) in &self.batches {
            recorder.dispatch(sweep, *threads);
            recorder.dispatch(reduce, self.layers);
        }
        let balance = if balanced { &self.rebalance } else { &self.keep };
        recorder.dispatch(balance, [1, 1, self.n_channels]);
    }
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
