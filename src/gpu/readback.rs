//! Reading fields back to the CPU.

use super::{Buffer, Gpu, GpuError, Texture};

impl Gpu {
    /// The contents of a buffer.
    ///
    /// # Errors
    /// [`GpuError::Device`] where the device was lost.
    pub fn read_buffer<T: bytemuck::Pod>(&self, buffer: &Buffer) -> Result<Vec<T>, GpuError> {
        let raw = self.read_raw(&buffer.buffer, 0, buffer.bytes())?;
        Ok(bytemuck::pod_collect_to_vec(&raw))
    }

    /// The texels of a texture, x fastest.
    ///
    /// # Errors
    /// As [`Self::read_buffer`], and [`GpuError::OutOfMemory`].
    pub fn read_texture<T: bytemuck::Pod>(&self, texture: &Texture) -> Result<Vec<T>, GpuError> {
        let [nx, ny, nz] = texture.dims().map(u64::from);
        let row = nx * texture.format().texel_bytes();
        // Rows of a copy start at multiples of 256 bytes.
        let pitch = row.next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: pitch * ny * nz,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(pitch as u32),
                    rows_per_image: Some(ny as u32),
                },
            },
            super::field::extent(texture.dims()),
        );
        self.queue.submit([encoder.finish()]);
        let raw = self.read_raw(&staging, 0, pitch * ny * nz)?;
        let mut packed = Vec::with_capacity((row * ny * nz) as usize);
        for line in raw.chunks_exact(pitch as usize) {
            packed.extend_from_slice(&line[..row as usize]);
        }
        Ok(bytemuck::pod_collect_to_vec(&packed))
    }

    pub(super) fn read_raw(
        &self,
        buffer: &wgpu::Buffer,
        offset: u64,
        bytes: u64,
    ) -> Result<Vec<u8>, GpuError> {
        let lost = |error: &dyn std::fmt::Display| GpuError::Device(error.to_string());
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("map"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, offset, &staging, 0, bytes);
        self.queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver waits below; it is gone only if poll failed, which is reported there.
            let _ = sender.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| lost(&error))?;
        let mapped = receiver.recv().map_err(|error| lost(&error))?;
        mapped.map_err(|error| lost(&error))?;
        let view = staging.get_mapped_range(..).map_err(|error| lost(&error))?;
        Ok(view.to_vec())
    }
}
