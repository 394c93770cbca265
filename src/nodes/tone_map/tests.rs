use serde_json::json;

use super::ToneParams;
use crate::graph::{PortType, Value};
use crate::image::Image;
use crate::image::tonemap::{Curve, apply};
use crate::nodes::testing::{Random, assert_close, assert_layout, gpu, output};

#[test]
fn every_curve_is_that_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    // 71 x 3 pixels from 1e-8 to 1e8, a few negative, and the ends of f32, but for what is so small that a device may
    // take it for 0.
    let mut random = Random(5);
    let mut radiance: Vec<f32> = (0..71 * 3 * 3)
        .map(|_| {
            let value = 10f64.powf(16.0 * random.unit() - 8.0);
            if random.unit() < 0.05 { -value as f32 } else { value as f32 }
        })
        .collect();
    radiance[..6].copy_from_slice(&[0.0, f32::MAX, f32::MIN, 1e30, 1e-36, 65504.0]);
    let mut picture = Image::new(71, 3, radiance);
    picture.insert("depth", 1, vec![7.0; 71 * 3]);
    let value = Value::new(PortType::Image, 0, picture.clone());
    for (name, curve) in [("none", Curve::None), ("filmic", Curve::Filmic), ("aces", Curve::Aces)] {
        for ev in [-100.0, -3.5, 0.0, 2.0, 100.0] {
            let params = json!({ "curve": name, "exposure_ev": ev });
            let mapped = output(gpu, "tone_map", params, &[("image", &value)]);
            let mapped: &Image = mapped.get();
            let found: Vec<f64> = mapped.beauty().iter().map(|v| f64::from(*v)).collect();
            let expected: Vec<f64> = (picture.pixels().iter())
                .flat_map(|pixel| apply(*pixel, ev as f32, curve).map(f64::from))
                .collect();
            // Three dot products and quotients of 2.5 ulps: some 20 roundings, of terms that cancel to a
            // tenth in the matrices. 2^ev is exact in neither: 4 ulps.
            let absolute = if curve == Curve::None { 1e-37 } else { 2e-6 };
            assert_close(&format!("{name} {ev}"), &found, &expected, 3e-6, absolute);
            assert_eq!(mapped.layers["depth"], picture.layers["depth"]);
        }
    }
}

#[test]
fn layouts_are_those_of_the_shader() {
    assert_layout::<ToneParams>("tone_map.wgsl", "ToneParams", &[]);
}
