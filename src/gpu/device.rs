//! The adapter, its limits and features, and the memory that is held on it.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use super::stage::Pipeline;
use super::{GpuError, Sampler};

/// Which adapter to use: `--adapter auto|cpu|NAME`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// A discrete GPU before an integrated one before a software driver.
    #[default]
    Auto,
    /// A software driver such as Mesa's lavapipe.
    Cpu,
    /// The first adapter whose name contains this, case ignored.
    Named(String),
}

impl std::str::FromStr for AdapterChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "auto" => Self::Auto,
            "cpu" => Self::Cpu,
            name => Self::Named(name.to_owned()),
        })
    }
}

/// What `tyndall doctor` says of an adapter.
#[derive(Debug, Clone, serde::Serialize)]
pub struct AdapterReport {
    /// The adapter's own name.
    pub name: String,
    /// Driver name and version.
    pub driver: String,
    /// Vulkan, Metal or Dx12.
    pub backend: String,
    /// DiscreteGpu, IntegratedGpu, Cpu, ...
    pub device_type: String,
    /// Largest 3-D texture extent, in texels.
    pub max_texture_3d: u32,
    /// Largest storage binding, in bytes.
    pub max_storage_binding_bytes: u64,
    /// Largest buffer, in bytes.
    pub max_buffer_bytes: u64,
    /// Whether stages can be timed on the GPU.
    pub timestamps: bool,
    /// Features that Tyndall needs and this adapter lacks; empty when it can be used.
    pub missing: Vec<String>,
}

/// Features without which nothing works: trilinear sampling of 32-bit fields.
const REQUIRED: wgpu::Features = wgpu::Features::FLOAT32_FILTERABLE;

/// Bytes held on the device, and the most that were held at once.
#[derive(Debug, Default)]
pub(super) struct Memory {
    now: AtomicU64,
    peak: AtomicU64,
}

impl Memory {
    pub(super) fn add(&self, bytes: u64) {
        let now = self.now.fetch_add(bytes, Ordering::Relaxed) + bytes;
        self.peak.fetch_max(now, Ordering::Relaxed);
    }

    pub(super) fn sub(&self, bytes: u64) {
        self.now.fetch_sub(bytes, Ordering::Relaxed);
    }
}

/// An open device with its compiled stages.
pub struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) memory: Arc<Memory>,
    pub(super) pipelines: Mutex<HashMap<String, Arc<Pipeline>>>,
    pub(super) timestamps: bool,
    /// Why the device is gone; it stays so.
    lost: Arc<Mutex<Option<String>>>,
    /// The first error since the last check that no scope took.
    uncaptured: Arc<Mutex<Option<String>>>,
    stage_times: Mutex<Option<Vec<super::StageTime>>>,
    /// GPU time since it was last taken.
    gpu_ms: Mutex<f64>,
    report: AdapterReport,
    limits: wgpu::Limits,
}

impl Gpu {
    /// Opens the adapter that was asked for.
    ///
    /// # Errors
    /// [`GpuError::Adapter`] says which adapters there are, or what to install when there is none.
    pub fn open(choice: &AdapterChoice) -> Result<Self, GpuError> {
        let mut found = list();
        found.sort_by_key(|adapter| rank(adapter.get_info().device_type));
        let names: Vec<String> = found.iter().map(|a| a.get_info().name).collect();
        if found.is_empty() {
            return Err(GpuError::Adapter(
                "no Vulkan, Metal or DX12 driver was found: install one (Debian or Ubuntu without a GPU: apt-get install mesa-vulkan-drivers), then try `tyndall doctor`".into(),
            ));
        }
        let adapter = found
            .into_iter()
            .find(|adapter| {
                let info = adapter.get_info();
                match choice {
                    AdapterChoice::Auto => true,
                    AdapterChoice::Cpu => info.device_type == wgpu::DeviceType::Cpu,
                    AdapterChoice::Named(name) => info.name.to_lowercase().contains(&name.to_lowercase()),
                }
            })
            .ok_or_else(|| {
                let wanted = match choice {
                    AdapterChoice::Named(name) => format!("named '{name}'"),
                    _ => "that runs on the CPU (apt-get install mesa-vulkan-drivers)".to_owned(),
                };
                GpuError::Adapter(format!("no adapter {wanted}; there is: {}", names.join(", ")))
            })?;
        Self::from_adapter(&adapter)
    }

    fn from_adapter(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let report = report(adapter);
        if !report.missing.is_empty() {
            return Err(GpuError::Adapter(format!(
                "{} lacks {}: choose another adapter with --adapter ({})",
                report.name,
                report.missing.join(", "),
                "cpu always works where Mesa's lavapipe is installed"
            )));
        }
        let limits = adapter.limits();
        let timing = wgpu::Features::TIMESTAMP_QUERY;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("tyndall"),
            required_features: REQUIRED | (adapter.features() & timing),
            required_limits: limits.clone(),
            ..Default::default()
        }))
        .map_err(|error| GpuError::Adapter(format!("{} cannot be opened: {error}", report.name)))?;
        let lost = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                *seen.lock().unwrap() = Some(message);
            }
        });
        let uncaptured = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&uncaptured);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            seen.lock().unwrap().get_or_insert(error.to_string());
        }));
        Ok(Self {
            timestamps: device.features().contains(timing),
            device,
            queue,
            memory: Arc::default(),
            pipelines: Mutex::default(),
            lost,
            uncaptured,
            stage_times: Mutex::new(None),
            gpu_ms: Mutex::default(),
            report,
            limits,
        })
    }

    /// Fails where something went wrong since the last check: an error that no scope took is told once,
    /// as one of `work`; a lost device is told every time.
    ///
    /// # Errors
    /// [`GpuError::Lost`], [`GpuError::Device`].
    pub fn check(&self, work: &str) -> Result<(), GpuError> {
        let uncaptured = self.uncaptured.lock().unwrap().take();
        if let Some(why) = self.lost.lock().unwrap().clone() {
            return Err(GpuError::Lost(why));
        }
        uncaptured.map_or(Ok(()), |error| Err(GpuError::Device(format!("{work}: {error}"))))
    }

    /// As if the driver had said that the device is gone.
    #[cfg(test)]
    pub(crate) fn lose(&self, why: &str) {
        *self.lost.lock().unwrap() = Some(why.to_owned());
    }

    /// Name, driver and limits of the open adapter.
    pub fn report(&self) -> &AdapterReport {
        &self.report
    }

    /// Whether the adapter is a software driver, where a sample costs about 10 ns, not 10 ps.
    pub fn is_cpu(&self) -> bool {
        self.report.device_type == "Cpu"
    }

    /// The largest storage binding, in bytes.
    pub fn max_binding_bytes(&self) -> u64 {
        self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size)
    }

    /// The largest extent of a 3-D texture, in texels.
    pub fn max_texture_3d(&self) -> u32 {
        self.limits.max_texture_dimension_3d
    }

    pub(super) fn limits(&self) -> &wgpu::Limits {
        &self.limits
    }

    /// Bytes of buffers and textures held now.
    pub fn bytes_now(&self) -> u64 {
        self.memory.now.load(Ordering::Relaxed)
    }

    /// The most bytes held at once since the last call, which starts a new count.
    pub fn take_peak_bytes(&self) -> u64 {
        self.memory.peak.swap(self.bytes_now(), Ordering::Relaxed)
    }

    /// GPU time in ms of all that ran since the last call (wall time of what has no timestamps).
    pub fn take_ms(&self) -> f64 {
        std::mem::take(&mut *self.gpu_ms.lock().unwrap())
    }

    pub(super) fn add_ms(&self, ms: f64) {
        *self.gpu_ms.lock().unwrap() += ms;
    }

    /// From now on each stage is timed apart (a pass of its own, which costs a little); the times
    /// are handed out by [`Self::take_stage_times`].
    pub fn time_stages(&self) {
        *self.stage_times.lock().unwrap() = Some(Vec::new());
    }

    /// The times of the stages that ran since the last call; empty unless asked for.
    pub fn take_stage_times(&self) -> Vec<super::StageTime> {
        self.stage_times.lock().unwrap().as_mut().map(std::mem::take).unwrap_or_default()
    }

    pub(super) fn stages_timed(&self) -> bool {
        self.stage_times.lock().unwrap().is_some()
    }

    pub(super) fn add_stage_times(&self, times: &[super::StageTime]) {
        if let Some(list) = self.stage_times.lock().unwrap().as_mut() {
            list.extend_from_slice(times);
        }
    }

    /// A sampler that filters linearly and clamps to the edge.
    pub fn linear_sampler(&self) -> Sampler {
        self.sampler(wgpu::AddressMode::ClampToEdge)
    }

    /// The same for a map of all directions: it repeats along the first axis.
    pub fn latlong_sampler(&self) -> Sampler {
        self.sampler(wgpu::AddressMode::Repeat)
    }

    fn sampler(&self, address_mode_u: wgpu::AddressMode) -> Sampler {
        Sampler(self.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("linear"),
            address_mode_u,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        }))
    }
}

/// All adapters of this machine, usable or not.
pub fn adapters() -> Vec<AdapterReport> {
    list().iter().map(report).collect()
}

fn list() -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    let backends = descriptor.backends;
    pollster::block_on(wgpu::Instance::new(descriptor).enumerate_adapters(backends))
}

fn rank(kind: wgpu::DeviceType) -> u8 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn report(adapter: &wgpu::Adapter) -> AdapterReport {
    let info = adapter.get_info();
    let limits = adapter.limits();
    let missing = REQUIRED - adapter.features();
    AdapterReport {
        name: info.name,
        driver: format!("{} {}", info.driver, info.driver_info),
        backend: format!("{:?}", info.backend),
        device_type: format!("{:?}", info.device_type),
        max_texture_3d: limits.max_texture_dimension_3d,
        max_storage_binding_bytes: limits.max_storage_buffer_binding_size,
        max_buffer_bytes: limits.max_buffer_size,
        timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        missing: missing.iter_names().map(|(name, _)| name.to_owned()).collect(),
    }
}
