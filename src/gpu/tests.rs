use super::testing::fresh;
use super::{Bind, Format, Gpu, GpuError};

/// What wgpu refuses outside of any scope: nothing may be mapped for reading and be a uniform.
fn provoke(gpu: &Gpu) {
    let _refused = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("provoked"),
        size: 16,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::UNIFORM,
        mapped_at_creation: false,
    });
}

#[test]
fn an_error_is_told_once_and_the_next_work_goes_on() {
    let Some(gpu) = fresh() else { return };
    let field = gpu.buffer_from("field", &[1.0_f32; 4], "").unwrap();
    provoke(&gpu);
    let error = gpu.recorder("some work").finish().unwrap_err();
    assert!(matches!(error, GpuError::Device(_)), "{error:?}");
    let text = error.to_string();
    assert!(text.starts_with("the GPU reported: some work: "), "{text}");
    assert!(gpu.recorder("more work").finish().is_ok());
    provoke(&gpu);
    assert!(gpu.read_buffer::<f32>(&field).is_err());
    assert_eq!(gpu.read_buffer::<f32>(&field).unwrap(), [1.0; 4]);
}

#[test]
fn a_device_that_is_lost_stays_lost() {
    let Some(gpu) = fresh() else { return };
    gpu.lose("it was unplugged");
    for _ in 0..2 {
        let error = gpu.recorder("some work").finish().unwrap_err();
        assert!(matches!(&error, GpuError::Lost(why) if why == "it was unplugged"), "{error:?}");
    }
}

#[test]
fn every_buffer_is_counted() {
    let Some(gpu) = fresh() else { return };
    let field = gpu.texture3("field", [64; 3], Format::R32Float, "").unwrap();
    let copied = gpu.texture3("copied", [8; 3], Format::Rgba32Float, "").unwrap();
    let held = gpu.bytes_now();
    gpu.take_peak_bytes();
    // Rows of 256 bytes need no padding, so the field is read through as many bytes as it has.
    gpu.read_texture::<f32>(&field).unwrap();
    assert_eq!(gpu.take_peak_bytes(), held + field.bytes());
    assert_eq!(gpu.bytes_now(), held);
    let stage = gpu.stage("copy", &[]).unwrap();
    let bound = stage.bind(&gpu, &[8_u32, 8, 8, 0], &[Bind::Texture(&field)], &[Bind::Texture(&copied)]);
    assert_eq!(gpu.bytes_now(), held + 16);
    let mut recorder = gpu.recorder("copy");
    recorder.dispatch(&bound, [8; 3]);
    recorder.finish().unwrap();
    drop(bound);
    assert_eq!(gpu.bytes_now(), held);
}

#[test]
fn what_is_too_large_is_refused_before_the_driver_sees_it() {
    let Some(gpu) = fresh() else { return };
    let bytes = gpu.limits().max_buffer_size + 4;
    let refused = gpu.allocate("all of it", bytes, wgpu::BufferUsages::COPY_DST, "ask for less").err();
    assert!(matches!(refused, Some(GpuError::TooLarge { .. })), "{refused:?}");
    assert!(gpu.check("nothing").is_ok());
}
