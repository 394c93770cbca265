//! Fields on the GPU: 3-D textures and buffers, counted and checked against the device's limits.

use std::sync::Arc;

use super::device::Memory;
use super::{Gpu, GpuError};

/// Texel formats in use. All of them can be written as storage and (but the integer one) filtered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// One 32-bit float.
    R32Float,
    /// Four 16-bit floats.
    Rgba16Float,
    /// Four 32-bit floats.
    Rgba32Float,
    /// Four 32-bit unsigned integers.
    Rgba32Uint,
}

impl Format {
    /// Bytes of a texel.
    pub fn texel_bytes(self) -> u64 {
        match self {
            Self::R32Float => 4,
            Self::Rgba16Float => 8,
            Self::Rgba32Float | Self::Rgba32Uint => 16,
        }
    }

    /// Its name in WGSL, for shaders that are written for several.
    pub fn wgsl(self) -> &'static str {
        match self {
            Self::R32Float => "r32float",
            Self::Rgba16Float => "rgba16float",
            Self::Rgba32Float => "rgba32float",
            Self::Rgba32Uint => "rgba32uint",
        }
    }

    fn wgpu(self) -> wgpu::TextureFormat {
        match self {
            Self::R32Float => wgpu::TextureFormat::R32Float,
            Self::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
            Self::Rgba32Float => wgpu::TextureFormat::Rgba32Float,
            Self::Rgba32Uint => wgpu::TextureFormat::Rgba32Uint,
        }
    }
}

/// A 3-D (or 2-D) texture that shaders can sample and write; zero when new.
pub struct Texture {
    pub(super) texture: wgpu::Texture,
    pub(super) view: wgpu::TextureView,
    dims: [u32; 3],
    format: Format,
    pub(super) counted: Arc<Counted>,
}

/// A buffer; zero when new.
pub struct Buffer {
    pub(super) buffer: wgpu::Buffer,
    pub(super) counted: Arc<Counted>,
}

/// A texture sampler.
pub struct Sampler(pub(super) wgpu::Sampler);

/// Takes the bytes off the account when the field, and all that is bound to it, is gone.
pub(super) struct Counted {
    bytes: u64,
    memory: Arc<Memory>,
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.memory.sub(self.bytes);
    }
}

impl Texture {
    /// Extent in texels, x y z.
    pub fn dims(&self) -> [u32; 3] {
        self.dims
    }

    /// The texel format.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.counted.bytes
    }
}

impl Buffer {
    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.counted.bytes
    }
}

impl Gpu {
    /// A new 3-D texture of zeros.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] with `remedy` where an extent is over the device's limit,
    /// [`GpuError::OutOfMemory`] where it has no room.
    pub fn texture3(
        &self,
        what: &str,
        dims: [usize; 3],
        format: Format,
        remedy: &str,
    ) -> Result<Texture, GpuError> {
        let limit = self.limits().max_texture_dimension_3d;
        self.texture(what, dims, wgpu::TextureDimension::D3, limit, format, remedy)
    }

    fn texture(
        &self,
        what: &str,
        dims: [usize; 3],
        dimension: wgpu::TextureDimension,
        limit: u32,
        format: Format,
        remedy: &str,
    ) -> Result<Texture, GpuError> {
        if dims.iter().any(|&n| n > limit as usize) {
            return Err(GpuError::TooLarge {
                what: what.to_owned(),
                need: format!("{} x {} x {} texels", dims[0], dims[1], dims[2]),
                limit: format!("{limit} along an axis"),
                remedy: remedy.to_owned(),
            });
        }
        let dims = dims.map(|n| n.max(1) as u32);
        let bytes = dims.iter().map(|&n| u64::from(n)).product::<u64>() * format.texel_bytes();
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(what),
            size: extent(dims),
            mip_level_count: 1,
            sample_count: 1,
            dimension,
            format: format.wgpu(),
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        if pollster::block_on(scope.pop()).is_some() || self.memory.is_full() {
            return Err(self.out_of_memory());
        }
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Texture { texture, view, dims, format, counted: self.count(bytes) })
    }

    /// A 2-D texture with the given texels, row by row.
    ///
    /// # Errors
    /// As [`Self::texture3`].
    pub fn texture2_from<T: bytemuck::Pod>(
        &self,
        what: &str,
        [width, height]: [usize; 2],
        format: Format,
        texels: &[T],
        remedy: &str,
    ) -> Result<Texture, GpuError> {
        let limit = self.limits().max_texture_dimension_2d;
        let texture =
            self.texture(what, [width, height, 1], wgpu::TextureDimension::D2, limit, format, remedy)?;
        self.upload(&texture, what, texels);
        Ok(texture)
    }

    /// A texture with the given texels, x fastest.
    ///
    /// # Errors
    /// As [`Self::texture3`].
    pub fn texture3_from<T: bytemuck::Pod>(
        &self,
        what: &str,
        dims: [usize; 3],
        format: Format,
        texels: &[T],
        remedy: &str,
    ) -> Result<Texture, GpuError> {
        let texture = self.texture3(what, dims, format, remedy)?;
        self.upload(&texture, what, texels);
        Ok(texture)
    }

    fn upload<T: bytemuck::Pod>(&self, texture: &Texture, what: &str, texels: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(texels);
        assert_eq!(bytes.len() as u64, texture.bytes(), "texels of {what}");
        let [nx, ny, nz] = texture.dims;
        self.queue.write_texture(
            texture.texture.as_image_copy(),
            bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(nx * texture.format.texel_bytes() as u32),
                rows_per_image: Some(ny),
            },
            extent([nx, ny, nz]),
        );
    }

    /// A new storage buffer of zeros.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] with `remedy` where it is over the device's limit,
    /// [`GpuError::OutOfMemory`] where it has no room.
    pub fn buffer(&self, what: &str, bytes: u64, remedy: &str) -> Result<Buffer, GpuError> {
        let limit = self.max_binding_bytes();
        if bytes > limit {
            return Err(GpuError::TooLarge {
                what: what.to_owned(),
                need: format!("{} MiB", bytes >> 20),
                limit: format!("{} MiB", limit >> 20),
                remedy: remedy.to_owned(),
            });
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        self.allocate(what, bytes.max(16).next_multiple_of(16), usage, remedy)
    }

    /// Every buffer comes from here, so that each is checked, counted and inside an error scope.
    pub(super) fn allocate(
        &self,
        what: &str,
        bytes: u64,
        usage: wgpu::BufferUsages,
        remedy: &str,
    ) -> Result<Buffer, GpuError> {
        let limit = self.limits().max_buffer_size;
        if bytes > limit {
            return Err(GpuError::TooLarge {
                what: what.to_owned(),
                need: format!("{} MiB", bytes >> 20),
                limit: format!("{} MiB", limit >> 20),
                remedy: remedy.to_owned(),
            });
        }
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size: bytes,
            usage,
            mapped_at_creation: false,
        });
        if pollster::block_on(scope.pop()).is_some() || self.memory.is_full() {
            return Err(self.out_of_memory());
        }
        Ok(Buffer { buffer, counted: self.count(bytes) })
    }

    /// A storage buffer with the given contents.
    ///
    /// # Errors
    /// As [`Self::buffer`].
    pub fn buffer_from<T: bytemuck::Pod>(
        &self,
        what: &str,
        contents: &[T],
        remedy: &str,
    ) -> Result<Buffer, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(contents);
        let buffer = self.buffer(what, bytes.len() as u64, remedy)?;
        self.queue.write_buffer(&buffer.buffer, 0, bytes);
        Ok(buffer)
    }

    fn count(&self, bytes: u64) -> Arc<Counted> {
        self.memory.add(bytes);
        Arc::new(Counted { bytes, memory: Arc::clone(&self.memory) })
    }

    pub(super) fn out_of_memory(&self) -> GpuError {
        GpuError::OutOfMemory { in_use_mib: self.bytes_now() >> 20 }
    }
}

pub(super) fn extent(dims: [u32; 3]) -> wgpu::Extent3d {
    wgpu::Extent3d { width: dims[0], height: dims[1], depth_or_array_layers: dims[2] }
}
