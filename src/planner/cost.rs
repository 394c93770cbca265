//! What a stage will cost: the bytes that it moves over the bandwidth of a plain copy, times how much longer
//! it took when that was measured.
//!
//! Ratios were measured on Mesa's lavapipe with two cores (`cargo bench --bench picture` prints them for a
//! graph). They hold what bytes do not say, such as arithmetic and what stays in caches, so that they are
//! those of one kind of device: on others nothing is predicted until they have been measured there. How far
//! off predictions are stands in BENCHMARKS.md.

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

/// The time of a copy of what a stage moves in ms, at `copy_gb_per_s` of reading and writing together.
pub fn floor_ms(work: &StageWork, copy_gb_per_s: f64) -> Option<f64> {
    work.moved_bytes.map(|bytes| bytes as f64 / copy_gb_per_s * 1e-6)
}

/// The time that all runs of a stage will take in ms; `None` where nobody knows.
pub fn predicted_ms(work: &StageWork, copy_gb_per_s: f64, is_cpu: bool) -> Option<f64> {
    let (_, ratio) = ON_CPU.iter().find(|(stage, _)| *stage == work.stage)?;
    floor_ms(work, copy_gb_per_s).filter(|_| is_cpu).map(|floor| floor * ratio)
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
        let (_, ratio) = ON_CPU.iter().find(|(stage, _)| *stage == "raymarch").unwrap();
        assert_eq!(predicted_ms(&march, 1.5, true), Some(2.0 * ratio));
        // Nobody knows: another kind of device, rays among surfaces, a stage that was never measured.
        assert_eq!(predicted_ms(&march, 1.5, false), None);
        assert_eq!(predicted_ms(&work("raymarch", None), 1.5, true), None);
        assert_eq!(predicted_ms(&work("shadow", Some(1)), 1.5, true), None);
    }
}
