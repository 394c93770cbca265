//! From radiance to the display.
//!
//! `apply` multiplies by 2^exposure_ev and bends the result by a curve into 0..=1, linear in
//! display light; [`srgb_encode`] then gives the signal. Curves:
//! * `none`: exposure only; values above 1 stay, and are cut by the file or the display.
//! * `filmic`: Hable's Uncharted 2 operator (J. Hable, "Filmic Tonemapping Operators", 2010;
//!   "Uncharted 2: HDR Lighting", GDC 2010): h(2x)/h(W),
//!   h(x) = (x(Ax+CB)+DE)/(x(Ax+B)+DF) − E/F, each channel for itself.
//! * `aces`: Stephen Hill's fit of the ACES reference and output transforms (BakingLab,
//!   `ACES.hlsl`, MIT): a matrix into its working space, a rational curve, a matrix back.
//!   Its toe is black below 0.0032.
//!
//! The constants are public so that the shader takes them from here. Inputs are cut at 0 and
//! at [`CEILING`], where both curves have long reached their end, so that squares stay finite;
//! NaN becomes 0. Tested: monotone and finite from 0 to 1e30, known points, sRGB round trip.

use serde::{Deserialize, Serialize};

/// The curve between radiance and display light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Curve {
    /// Exposure only.
    #[default]
    None,
    /// Hable's filmic operator.
    Filmic,
    /// Hill's fit of ACES.
    Aces,
}

/// The largest exposed value that a curve is evaluated at: the largest half float.
pub const CEILING: f32 = half::f16::MAX.to_f32_const();

/// Hable's A, B, C, D, E and F: shoulder strength, linear strength, linear angle, toe strength,
/// toe numerator, toe denominator.
pub const HABLE: [f32; 6] = [0.15, 0.50, 0.10, 0.20, 0.02, 0.30];
/// Hable's gain before the curve.
pub const HABLE_GAIN: f32 = 2.0;
/// Hable's linear white point W.
pub const HABLE_WHITE: f32 = 11.2;

/// Rows of the matrix from linear Rec. 709 into the fit's working space.
pub const ACES_IN: [[f32; 3]; 3] =
    [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
/// Rows of the matrix from the fit's working space to linear display Rec. 709.
pub const ACES_OUT: [[f32; 3]; 3] =
    [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]];
/// p, q, r, s, t of the fit (v(v + p) − q)/(v(r v + s) + t).
pub const ACES_FIT: [f32; 5] = [0.024_578_6, 0.000_090_537, 0.983_729, 0.432_951, 0.238_081];

/// Display light of radiance `rgb`: linear; 0..=1 for `Filmic` and `Aces`, finite for every
/// input.
pub fn apply(rgb: [f32; 3], exposure_ev: f32, curve: Curve) -> [f32; 3] {
    let gain = exposure_ev.exp2().min(f32::MAX);
    // NaN, of 0 · inf as well, has no color: black.
    let exposed = rgb.map(|v| {
        let v = v * gain;
        if v.is_nan() { 0.0 } else { v.clamp(f32::MIN, f32::MAX) }
    });
    let cut = exposed.map(|v| v.clamp(0.0, CEILING));
    match curve {
        Curve::None => exposed,
        Curve::Filmic => {
            let white = hable(HABLE_WHITE);
            cut.map(|v| (hable(v * HABLE_GAIN) / white).clamp(0.0, 1.0))
        }
        Curve::Aces => {
            let working = multiply(&ACES_IN, cut);
            multiply(&ACES_OUT, working.map(aces_fit)).map(|v| v.clamp(0.0, 1.0))
        }
    }
}

/// Hable's quotient less E/F, brought onto one denominator: the difference of two nearly equal
/// numbers would cost the dark tones their digits.
fn hable(x: f32) -> f32 {
    let [a, b, c, d, e, f] = HABLE;
    x * (a * (f - e) * x + b * (c * f - e)) / (f * (x * (a * x + b) + d * f))
}

fn aces_fit(v: f32) -> f32 {
    let [p, q, r, s, t] = ACES_FIT;
    (v * (v + p) - q) / (v * (r * v + s) + t)
}

fn multiply(rows: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// The sRGB signal of linear display light, 0..=1 both (IEC 61966-2-1).
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Linear display light of an sRGB signal, 0..=1 both.
pub fn srgb_decode(signal: f32) -> f32 {
    if signal <= 0.040_45 { signal / 12.92 } else { ((signal + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVES: [Curve; 3] = [Curve::None, Curve::Filmic, Curve::Aces];

    // Steps of 0.4 % over 45 decades; a rational function of f32 may step back by its own
    // rounding, some 10 roundings of 6e-8, hence 1e-6 relative.
    #[test]
    fn grey_is_monotone_and_finite() {
        for curve in CURVES {
            for ev in [-20.0, 0.0, 20.0, 200.0] {
                let mut before = -1.0;
                for i in 0..26_000 {
                    let x = 1e-15 * 1.004f32.powi(i);
                    let [r, g, b] = apply([x.min(1e30); 3], ev, curve);
                    assert!([r, g, b].iter().all(|v| v.is_finite()));
                    assert!(curve == Curve::None || (0.0..=1.0).contains(&r));
                    assert!(r >= before * (1.0 - 1e-6), "{curve:?} {ev} {x}");
                    before = r;
                }
                assert!(before >= 0.99, "{curve:?} {ev} ends at {before}");
            }
        }
    }

    #[test]
    fn spicy_inputs_stay_in_range() {
        let spicy = [0.0, -0.0, -1.0, 1e-45, f32::MIN_POSITIVE, 1e30, f32::MAX, f32::MIN];
        let worse = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        for curve in CURVES {
            for ev in [-1000.0, 0.0, 1000.0] {
                for v in spicy.into_iter().chain(worse) {
                    for rgb in [[v; 3], [v, 0.0, 1.0], [1.0, v, v]] {
                        let out = apply(rgb, ev, curve);
                        assert!(out.iter().all(|v| v.is_finite()), "{rgb:?} {out:?}");
                        if curve != Curve::None {
                            assert!(out.iter().all(|v| (0.0..=1.0).contains(v)));
                        }
                    }
                }
            }
        }
    }

    // By hand in f64: h(2) = 2(0.3+0.05)+0.004 over 2(0.3+0.5)+0.06, less 1/15 = 0.357430;
    // h(11.2) = 19.380/24.476 - 1/15 = 0.725129; their ratio 0.492919. ACES of grey 1: the
    // rows of the first matrix sum to 1, so v = 1 gives 1.0244881/1.654761 = 0.619115; the
    // rows of the second sum to 1, 1 and 0.99999. 1e-5: the digits kept above.
    #[test]
    fn known_points() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a} {b}");
        near(apply([1.0; 3], 0.0, Curve::Filmic)[1], 0.492_919);
        near(apply([1.0; 3], 0.0, Curve::Aces)[0], 0.619_115);
        near(apply([0.25; 3], 2.0, Curve::Aces)[0], 0.619_115);
        assert_eq!(apply([1.0, 2.0, -3.0], 1.0, Curve::None), [2.0, 4.0, -6.0]);
        assert_eq!(apply([HABLE_WHITE; 3], 0.0, Curve::Filmic), [1.0; 3]);
        // Channels are not mixed up: red stays mostly red.
        let [r, g, b] = apply([1.0, 0.0, 0.0], 0.0, Curve::Aces);
        assert!(r > 5.0 * g && r > 5.0 * b, "{r} {g} {b}");
    }

    // One power function (2 ulp) and its inverse, whose slope is at most 2.4: 1e-6. The
    // standard's own seam: both branches meet within 1e-6 of each other at 0.04045.
    #[test]
    fn srgb_round_trip() {
        for i in 0..=100_000 {
            let x = i as f32 / 100_000.0;
            let back = srgb_decode(srgb_encode(x));
            assert!((back - x).abs() <= 1e-6, "{x} {back}");
        }
        assert!((srgb_encode(0.5) - 0.735_357).abs() < 1e-6);
        assert_eq!([srgb_encode(0.0), srgb_decode(0.0)], [0.0; 2]);
    }

    #[test]
    fn curves_have_their_names_in_files() {
        for (curve, name) in CURVES.into_iter().zip(["none", "filmic", "aces"]) {
            assert_eq!(serde_json::to_value(curve).unwrap(), name);
        }
    }
}
