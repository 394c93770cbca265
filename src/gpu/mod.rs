//! The GPU layer: device, shaders, stages, fields and read-back. It knows no domain type.
//!
//! A *stage* is one WGSL entry point. Its bindings follow one convention (group 0 parameters,
//! 1 inputs, 2 outputs, numbered in order), so a stage is bound by three lists and nothing is
//! declared twice: the layout comes from the shader. Big fields live in 3-D textures, because
//! software drivers bind at most 128 MiB as a storage buffer but hold 2 GiB in a texture, and
//! because their trilinear filter is 2–3 times faster than one written by hand.
//!
//! Limits are asked from the device; what does not fit is refused with its size, the limit and
//! the remedy that the caller names. Every allocation is counted, so that a render can report its
//! peak. An error that no scope takes is told once, with the work that it hit, and the next work goes on;
//! only a device that was lost stays lost. Nothing here is `unsafe`, and the GL backend is left out on purpose: its 3-D storage
//! writes reach only z = 0, in silence.

mod bandwidth;
mod device;
mod field;
mod layout;
mod readback;
mod record;
mod shader;
mod stage;
#[cfg(test)]
pub(crate) mod testing;

pub use device::{AdapterChoice, AdapterReport, Faults, Gpu, adapters};
pub use field::{Buffer, Format, Sampler, Texture};
pub use layout::{Mirror, wgsl_constant, wgsl_members};
pub use record::{Recorder, StageTime};
pub use shader::{Shader, shader_names, shader_text};
pub use stage::{Bind, Bound, Stage};

/// How the message of [`GpuError::OutOfMemory`] begins, by which it is known where only messages arrive.
pub const OUT_OF_MEMORY: &str = "the GPU is out of memory";

/// What the GPU layer can refuse or meet.
#[derive(Debug, Clone, thiserror::Error)]
pub enum GpuError {
    /// No adapter at all, or none that was asked for.
    #[error("{0}")]
    Adapter(String),
    /// A field is larger than the device allows.
    #[error("{what} needs {need}, the adapter allows {limit}: {remedy}")]
    TooLarge {
        /// The field's name and size.
        what: String,
        /// Its extent or bytes.
        need: String,
        /// The limit it meets.
        limit: String,
        /// The parameter to change.
        remedy: String,
    },
    /// The device ran out of memory.
    #[error(
        "{OUT_OF_MEMORY} ({in_use_mib} MiB in use by Tyndall): lower medium.max_resolution or medium.max_cells, or use --adapter cpu"
    )]
    OutOfMemory {
        /// Bytes that Tyndall held, in MiB.
        in_use_mib: u64,
    },
    /// A shader does not compile; file and line are those of the source file.
    #[error("{0}")]
    Shader(String),
    /// The driver reported an error; the device goes on.
    #[error("the GPU reported: {0}")]
    Device(String),
    /// The device is gone, and all that it held.
    #[error("the GPU was lost ({0}): start again, with smaller fields or another --adapter")]
    Lost(String),
}

#[cfg(test)]
mod tests;
