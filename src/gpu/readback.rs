//! Reading fields back to the CPU.
//!
//! A field is copied into a buffer that can be mapped; it is on the account for as long as it lives.

use super::{Buffer, Gpu, GpuError, Texture};

const REMEDY: &str = "lower medium.max_resolution or the size of the picture";

impl Gpu {
    /// The contents of a buffer.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`]; [`GpuError::Device`] where the device was lost.
    pub fn read_buffer<T: bytemuck::Pod>(&self, buffer: &Buffer) -> Result<Vec<T>, GpuError> {
        self.read_prefix(buffer, buffer.bytes(), bytemuck::pod_collect_to_vec)
    }

    /// What `take` makes of the first `bytes` of a buffer, where they lie: a large picture is not copied once more.
    ///
    /// # Errors
    /// As [`Self::read_buffer`].
    ///
    /// # Panics
    /// If `bytes` are more than there are, or no multiple of 4.
    pub fn read_prefix<T>(
        &self,
        buffer: &Buffer,
        bytes: u64,
        take: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, GpuError> {
        assert!(bytes <= buffer.bytes() && bytes.is_multiple_of(4), "{bytes} bytes");
        let copy = |encoder: &mut wgpu::CommandEncoder, staging: &wgpu::Buffer| {
            encoder.copy_buffer_to_buffer(&buffer.buffer, 0, staging, 0, bytes);
        };
        self.read_back(bytes, copy, take)
    }

    /// The texels of a texture, x fastest.
    ///
    /// # Errors
    /// As [`Self::read_buffer`]; [`GpuError::TooLarge`].
    pub fn read_texture<T: bytemuck::Pod>(&self, texture: &Texture) -> Result<Vec<T>, GpuError> {
        let [nx, ny, nz] = texture.dims().map(u64::from);
        let row = nx * texture.format().texel_bytes();
        // Rows of a copy start at multiples of 256 bytes.
        let pitch = row.next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
        let copy = |encoder: &mut wgpu::CommandEncoder, staging: &wgpu::Buffer| {
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(pitch as u32),
                rows_per_image: Some(ny as u32),
            };
            encoder.copy_texture_to_buffer(
                texture.texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo { buffer: staging, layout },
                super::field::extent(texture.dims()),
            );
        };
        self.read_back(pitch * ny * nz, copy, |raw| {
            let mut packed = Vec::with_capacity((row * ny * nz) as usize);
            for line in raw.chunks_exact(pitch as usize) {
                packed.extend_from_slice(&line[..row as usize]);
            }
            bytemuck::pod_collect_to_vec(&packed)
        })
    }

    /// What `take` makes of that which `copy` leaves in a buffer of so many bytes.
    fn read_back<T>(
        &self,
        bytes: u64,
        copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer),
        take: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, GpuError> {
        let staging = self.staging(bytes)?;
        let mut encoder = self.device.create_command_encoder(&Default::default());
        copy(&mut encoder, &staging.buffer);
        self.queue.submit([encoder.finish()]);
        let mapped = self.map(&staging);
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check("reading back")?;
        polled.map_err(|error| GpuError::Device(error.to_string()))?;
        mapped.read(take)
    }

    /// A buffer that can be mapped.
    pub(super) fn staging(&self, bytes: u64) -> Result<Buffer, GpuError> {
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        self.allocate("read back", bytes, usage, REMEDY)
    }

    /// Asks for a mapping, which is there after the next wait for the device.
    pub(super) fn map<'a>(&self, staging: &'a Buffer) -> Mapping<'a> {
        let (sender, receiver) = std::sync::mpsc::channel();
        staging.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is asked after the wait; it is gone only where that failed, which is told there.
            let _ = sender.send(result);
        });
        Mapping { staging, receiver }
    }
}

/// A mapping that was asked for.
pub(super) struct Mapping<'a> {
    staging: &'a Buffer,
    receiver: std::sync::mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Mapping<'_> {
    /// What `take` makes of the contents.
    pub(super) fn read<T>(self, take: impl FnOnce(&[u8]) -> T) -> Result<T, GpuError> {
        let lost = |error: &dyn std::fmt::Display| GpuError::Device(error.to_string());
        let mapped = self.receiver.recv().map_err(|error| lost(&error))?;
        mapped.map_err(|error| lost(&error))?;
        let view = self.staging.buffer.get_mapped_range(..).map_err(|error| lost(&error))?;
        Ok(take(&view))
    }
}
