//! Recording and running stages, with their times.

use std::time::Instant;

use super::{Bound, Buffer, Gpu, GpuError, Texture};

/// GPU time of one pass.
#[derive(Debug, Clone, serde::Serialize)]
pub struct StageTime {
    /// The stage's name, or the recorder's where its stages share a pass.
    pub stage: String,
    /// Milliseconds on the GPU's own clock.
    pub gpu_ms: f64,
}

/// Collects dispatches and runs them at [`Recorder::finish`].
pub struct Recorder<'a> {
    gpu: &'a Gpu,
    label: String,
    encoder: wgpu::CommandEncoder,
    pass: Option<wgpu::ComputePass<'static>>,
    queries: Option<Queries>,
    stages: Vec<String>,
    apart: bool,
    scope: Option<wgpu::ErrorScopeGuard>,
    /// The first stage that could not be bound.
    unbound: Option<GpuError>,
}

struct Queries {
    set: wgpu::QuerySet,
    capacity: u32,
}

impl Gpu {
    /// A new recorder; `label` names it in errors and timings.
    pub fn recorder(&self, label: &str) -> Recorder<'_> {
        let apart = self.stages_timed();
        let capacity = if apart { 4096 } else { 2 };
        let queries = self.timestamps.then(|| Queries {
            set: self.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some(label),
                ty: wgpu::QueryType::Timestamp,
                count: capacity,
            }),
            capacity,
        });
        Recorder {
            gpu: self,
            label: label.to_owned(),
            scope: Some(self.device.push_error_scope(wgpu::ErrorFilter::Validation)),
            encoder: self
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) }),
            pass: None,
            queries,
            stages: Vec::new(),
            apart,
            unbound: None,
        }
    }
}

impl Recorder<'_> {
    /// Runs `bound` once for each of `threads`.
    pub fn dispatch(&mut self, bound: &Bound, threads: [usize; 3]) {
        let groups = match &bound.groups {
            Ok(groups) => groups,
            Err(error) => {
                self.unbound.get_or_insert_with(|| error.clone());
                return;
            }
        };
        if self.apart && self.stages.last() != Some(&bound.label) {
            self.pass = None;
        }
        if self.pass.is_none() {
            self.begin(&bound.label.clone());
        }
        let pass = self.pass.as_mut().expect("a pass was begun above");
        pass.set_pipeline(&bound.pipeline.pipeline);
        for (idx, group) in groups.iter().enumerate() {
            pass.set_bind_group(idx as u32, group, &[]);
        }
        let [x, y, z] = bound.workgroups(threads);
        pass.dispatch_workgroups(x, y, z);
    }

    /// Copies a box of `size` texels.
    pub fn copy_box(
        &mut self,
        from: &Texture,
        from_texel: [u32; 3],
        to: &Texture,
        to_texel: [u32; 3],
        size: [usize; 3],
    ) {
        self.pass = None;
        self.encoder.copy_texture_to_texture(
            corner(from, from_texel),
            corner(to, to_texel),
            super::field::extent(size.map(|n| n as u32)),
        );
    }

    fn begin(&mut self, stage: &str) {
        let first = 2 * self.stages.len() as u32;
        let timestamps =
            self.queries.as_ref().filter(|queries| first + 1 < queries.capacity).map(|queries| {
                wgpu::ComputePassTimestampWrites {
                    query_set: &queries.set,
                    beginning_of_pass_write_index: Some(first),
                    end_of_pass_write_index: Some(first + 1),
                }
            });
        let pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(stage),
            timestamp_writes: timestamps,
        });
        self.pass = Some(pass.forget_lifetime());
        self.stages.push(stage.to_owned());
    }

    /// Submits, waits, and returns the milliseconds of GPU time (wall time of what has no
    /// timestamps), which [`Gpu::take_ms`] also counts.
    ///
    /// # Errors
    /// [`GpuError::Device`] with what the driver said; [`GpuError::OutOfMemory`], also where a stage that
    /// was dispatched could not be bound: then nothing runs.
    pub fn finish(mut self) -> Result<f64, GpuError> {
        self.pass = None;
        if let Some(error) = self.unbound.take() {
            return Err(error);
        }
        let ticks = self.resolve()?;
        let start = Instant::now();
        self.gpu.queue.submit([self.encoder.finish()]);
        // The times are mapped by the wait for what they time: each wait costs a round trip to the device.
        let mapped = ticks.as_ref().map(|ticks| self.gpu.map(ticks));
        let waited = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
        let wall_ms = start.elapsed().as_secs_f64() * 1e3;
        if let Some(error) = self.scope.take().and_then(|scope| pollster::block_on(scope.pop())) {
            return Err(GpuError::Device(format!("{}: {error}", self.label)));
        }
        self.gpu.check(&self.label)?;
        waited.map_err(|error| GpuError::Device(error.to_string()))?;
        let times = match mapped {
            // Copies have no timestamps.
            None => vec![StageTime { stage: self.label, gpu_ms: wall_ms }],
            Some(ticks) => {
                let ticks: Vec<u64> = ticks.read(bytemuck::pod_collect_to_vec)?;
                let period = f64::from(self.gpu.queue.get_timestamp_period()) * 1e-6;
                let ms = |pair: &[u64]| pair[1].saturating_sub(pair[0]) as f64 * period;
                let named = ticks.chunks_exact(2).zip(self.stages);
                named.map(|(pair, stage)| StageTime { stage, gpu_ms: ms(pair) }).collect()
            }
        };
        self.gpu.add_stage_times(&times);
        let gpu_ms = times.iter().map(|time| time.gpu_ms).sum();
        self.gpu.add_ms(gpu_ms);
        Ok(gpu_ms)
    }

    /// Where the timestamps can be read, two a pass; `None` where there are none.
    fn resolve(&mut self) -> Result<Option<Buffer>, GpuError> {
        let Some(queries) = &self.queries else { return Ok(None) };
        let n_queries = (2 * self.stages.len() as u32).min(queries.capacity);
        if n_queries == 0 {
            return Ok(None);
        }
        let bytes = u64::from(n_queries) * 8;
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = self.gpu.allocate("timestamps", bytes, usage, "")?;
        let staging = self.gpu.staging(bytes)?;
        self.encoder.resolve_query_set(&queries.set, 0..n_queries, &resolved.buffer, 0);
        self.encoder.copy_buffer_to_buffer(&resolved.buffer, 0, &staging.buffer, 0, bytes);
        Ok(Some(staging))
    }
}

fn corner(texture: &Texture, [x, y, z]: [u32; 3]) -> wgpu::TexelCopyTextureInfo<'_> {
    wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x, y, z }, ..texture.texture.as_image_copy() }
}
