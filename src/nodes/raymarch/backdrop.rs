//! What stands behind the medium, and what of it comes through.
//!
//! A constant or a lat-long map is seen through the medium by exp(-tau); with a stack (`prefilter`), what the
//! medium scatters forward out of the map is added (DESIGN 6.5), more of it from where the medium is thin:
//! `shaders/raymarch/environment.wgsl`, whose oracle is `bend.rs`.

use crate::gpu::{Format, Gpu, GpuError, Texture};
use crate::light::environment::{Environment, STACK_X, Stack};

/// An environment as the shader reads it.
pub(super) struct Backdrop {
    /// 0 nothing, 1 constant, 2 a map.
    pub(super) kind: u32,
    /// Of the constant, or what the map is multiplied by.
    pub(super) radiance: [f64; 3],
    /// Turn of map and stack about +Y in radians.
    pub(super) rotate_y: f64,
    /// RGBA texels, or one.
    pub(super) map: Texture,
    /// Levels along z, or one texel.
    pub(super) stack: Texture,
    /// Whether the levels are there.
    pub(super) has_stack: bool,
    /// Of each level, as in [`Stack`].
    pub(super) turns: [[f32; 4]; STACK_X.len()],
}

const REMEDY: &str = "use a smaller picture as environment";

impl Backdrop {
    /// Of an environment that is seen, or only shines through.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub(super) fn new(gpu: &Gpu, environment: Option<&Environment>, is_seen: bool) -> Result<Self, GpuError> {
        let map = match environment {
            Some(Environment::Map(map)) => Some(map),
            _ => None,
        };
        let (kind, radiance) = match environment.filter(|_| is_seen) {
            None => (0, [0.0; 3]),
            Some(Environment::Constant(radiance)) => (1, *radiance),
            Some(Environment::Map(map)) => (2, [map.scale; 3]),
        };
        let texture = match map.filter(|_| is_seen) {
            None => gpu.texture2_from("no map", [1, 1], Format::Rgba32Float, &[[0.0_f32; 4]], "")?,
            Some(map) => {
                let size = [map.width, map.height];
                gpu.texture2_from("environment", size, Format::Rgba32Float, &four(&map.texels), REMEDY)?
            }
        };
        let stack = map.and_then(|map| map.stack.as_deref());
        Ok(Self {
            kind,
            radiance,
            rotate_y: map.map_or(0.0, |map| map.rotate_y),
            map: texture,
            stack: stack_texture(gpu, stack)?,
            has_stack: stack.is_some(),
            turns: stack
                .map_or([[0.0; 4]; STACK_X.len()], |stack| stack.turns.map(|[a, b, c]| [a, b, c, 0.0])),
        })
    }
}

fn stack_texture(gpu: &Gpu, stack: Option<&Stack>) -> Result<Texture, GpuError> {
    match stack {
        None => gpu.texture3_from("no stack", [1; 3], Format::Rgba32Float, &[[0.0_f32; 4]], ""),
        Some(stack) => {
            let size = [stack.width, stack.height, STACK_X.len()];
            gpu.texture3_from(
                "stack of environments",
                size,
                Format::Rgba32Float,
                &four(&stack.texels),
                REMEDY,
            )
        }
    }
}

fn four(texels: &[[f32; 3]]) -> Vec<[f32; 4]> {
    texels.iter().map(|[red, green, blue]| [*red, *green, *blue, 0.0]).collect()
}
