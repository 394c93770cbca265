//! What a stage will cost: the bytes that it moves over the bandwidth of a plain copy, times how much longer
//! it took when that was measured.
//!
//! Ratios were measured on Mesa's lavapipe with two cores and on an NVIDIA H200 (`cargo bench --bench picture` prints
//! them for a graph). They hold what bytes do not say, such as arithmetic and what stays in caches, so that they are
//! those of one kind of device; another GPU than that one has others. How far off predictions of software drivers
//! are stands in BENCHMARKS.md; of GPUs that is not known yet.

use crate::graph::StageWork;

/// Time over floor of each stage on a software driver.
const ON_CPU: &[(&str, f64)] = &[
    ("walk", 1.3),
    ("principal_propagation/scan", 3.1),
    ("principal_propagation/pack", 1.5),
    ("isotropic_residual/sources", 1.2),
    ("isotropic_residual/sweep", 0.68),
    ("isotropic_residual/gather_lobes", 1.05),
    ("isotropic_residual/gather_moments", 2.4),
    ("isotropic_residual/lobe", 1.3),
    ("isotropic_residual/prolong", 1.4),
    ("raymarch/gather", 2.0),
    ("raymarch", 1.1),
];

/// The same on a GPU, the means over all presets; stages of small grids take longer, because a dispatch takes some
/// microseconds whatever it does.
const ON_GPU: &[(&str, f64)] = &[
    ("walk", 1.0),
    ("principal_propagation/scan", 11.9),
    ("principal_propagation/pack", 1.3),
    ("isotropic_residual/sources", 0.75),
    ("isotropic_residual/sweep", 1.5),
    ("isotropic_residual/gather_lobes", 1.35),
    ("isotropic_residual/gather_moments", 2.9),
    ("isotropic_residual/lobe", 2.1),
    ("isotropic_residual/prolong", 3.2),
    ("spherical_propagation/radial", 1.6),
    ("raymarch/gather", 1.6),
    ("raymarch", 1.9),
];

/// The time of a copy of what a stage moves in ms, at `copy_gb_per_s` of reading and writing together.
pub fn floor_ms(work: &StageWork, copy_gb_per_s: f64) -> Option<f64> {
    work.moved_bytes.map(|bytes| bytes as f64 / copy_gb_per_s * 1e-6)
}

/// The time on the device that all runs of a stage will take in ms; `None` where nobody knows.
pub fn predicted_ms(work: &StageWork, copy_gb_per_s: f64, is_cpu: bool) -> Option<f64> {
    let ratios = if is_cpu { ON_CPU } else { ON_GPU };
    let (_, ratio) = ratios.iter().find(|(stage, _)| *stage == work.stage)?;
    floor_ms(work, copy_gb_per_s).map(|floor| floor * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_bytes_over_bandwidth_and_a_ratio() {
        let work = |stage, moved_bytes| StageWork { stage, runs: 1, moved_bytes };
        let march = work("raymarch", Some(3_000_000));
        // 3 MB at 1.5 GB/s.
        assert_eq!(floor_ms(&march, 1.5), Some(2.0));
        for (is_cpu, ratios) in [(true, ON_CPU), (false, ON_GPU)] {
            let (_, ratio) = ratios.iter().find(|(stage, _)| *stage == "raymarch").unwrap();
            assert_eq!(predicted_ms(&march, 1.5, is_cpu), Some(2.0 * ratio));
        }
        // Nobody knows: rays among surfaces, a stage that was never measured.
        assert_eq!(predicted_ms(&work("raymarch", None), 1.5, true), None);
        assert_eq!(predicted_ms(&work("shadow", Some(1)), 1.5, true), None);
    }
}
