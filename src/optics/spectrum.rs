//! Colors: luminance, and the color of a black body.
//!
//! Planck's spectrum λ⁻⁵ / (e^{c₂/λT} − 1) is weighed by the CIE 1931 observer in the multi-lobe
//! fit of Wyman, Sloan, Shirley (JCGT 2, 2013), summed over 360 … 830 nm in steps of 5 nm, and
//! brought to linear Rec. 709 by the matrix below; negative channels (colors outside Rec. 709)
//! become 0. It is scaled so that the luminance Y is 1 at the reference temperature. Inputs in
//! kelvin; temperatures of 1 K and less count as 1 K, which is black. Tested by Y at the reference,
//! by Wien's law, and by the whiteness of 6500 K.

/// Luminance weights of linear Rec. 709.
pub const LUMINANCE_WEIGHTS: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Second radiation constant h c / k_B [m K].
const C2: f64 = 1.438_776_877e-2;

/// Linear Rec. 709 from CIE XYZ, a row a channel.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
];

/// Luminance of a linear Rec. 709 color.
pub fn luminance(rgb: [f64; 3]) -> f64 {
    dot(LUMINANCE_WEIGHTS, rgb)
}

/// Linear Rec. 709 color of a black body at `kelvin`, relative to the luminance of one at
/// `reference_kelvin`.
pub fn blackbody_rgb(kelvin: f64, reference_kelvin: f64) -> [f64; 3] {
    let scale = 1.0 / blackbody_xyz(reference_kelvin)[1];
    let xyz = blackbody_xyz(kelvin).map(|value| value * scale);
    RGB_FROM_XYZ.map(|row| dot(row, xyz).max(0.0))
}

/// CIE XYZ of a black body, up to a constant factor.
fn blackbody_xyz(kelvin: f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for step in 0..95 {
        let nm = 360.0 + 5.0 * f64::from(step);
        let lambda_m = nm * 1e-9;
        // Beyond 700 the exponential overflows, and the spectrum is below 1e-270 of any that is
        // seen.
        let exponent = (C2 / (lambda_m * kelvin.max(1.0))).min(700.0);
        let radiance = lambda_m.powi(-5) / exponent.exp_m1();
        for (sum, weight) in xyz.iter_mut().zip(observer(nm)) {
            *sum += radiance * weight;
        }
    }
    xyz
}

/// CIE 1931 2° color matching functions at a wavelength in nm, the fit of Wyman, Sloan, Shirley.
fn observer(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, center: f64, below: f64, above: f64| {
        let t = (nm - center) / if nm < center { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    [
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    ]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luminance_is_one_at_the_reference() {
        // The weights are rounded to 4 digits, the matrix to 7: 1e-4 times channels up to 3.
        for kelvin in [3000.0, 4500.0, 6500.0, 10_000.0] {
            let y = luminance(blackbody_rgb(kelvin, kelvin));
            assert!((y - 1.0).abs() < 3e-4, "{kelvin} K: {y}");
        }
        // Below about 1900 K blue is outside Rec. 709 and is cut: red and green alone are a little
        // brighter than Y.
        let [red, green, blue] = blackbody_rgb(1500.0, 1500.0);
        assert_eq!(blue, 0.0);
        assert!(red > green && (1.0..1.05).contains(&luminance([red, green, blue])));
    }

    #[test]
    fn follows_planck_between_temperatures() {
        // Where c₂/λT >> 1 the ratio of the luminances at T and 2T is e^{c₂/λ (1/2T − 1/T)} at some
        // λ between 550 and 650 nm.
        let ratio = luminance(blackbody_rgb(1500.0, 3000.0));
        let bound = |nm: f64| (-C2 / (nm * 1e-9) / 3000.0).exp();
        assert!(bound(550.0) < ratio && ratio < bound(650.0), "{ratio}");
    }

    #[test]
    fn at_6500_kelvin_is_nearly_white() {
        // The Planckian locus lies a little to the magenta side of D65: every channel within 6 % of
        // 1.
        for value in blackbody_rgb(6500.0, 6500.0) {
            assert!((value - 1.0).abs() < 0.06, "{value}");
        }
    }

    #[test]
    fn cold_is_black_and_finite() {
        for kelvin in [-5.0, 0.0, 1.0, 200.0] {
            assert!(
                blackbody_rgb(kelvin, 2000.0).iter().all(|value| value.is_finite() && *value < 1e-20),
                "{kelvin}"
            );
        }
        assert!(blackbody_rgb(1e6, 2000.0).iter().all(|value| value.is_finite() && *value > 1e3));
    }
}
