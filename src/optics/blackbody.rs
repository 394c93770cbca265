//! The color of a black body.
//!
//! Planck's spectrum λ⁻⁵ / (e^{c₂/λT} − 1) is weighed by the CIE 1931 observer in the multi-lobe
//! fit of Wyman, Sloan, Shirley (JCGT 2, 2013), summed over 360 … 830 nm in steps of 5 nm, and
//! brought to linear Rec. 709; negative channels (colors outside Rec. 709) become 0. It is scaled so
//! that the luminance Y is 1 at the reference temperature.
//!
//! Shaders look it up in a table ([`blackbody_table`]). B falls like e^{−c/T} in the cold and grows
//! like T in the heat, so what is tabulated is B/(T + KNEE), over w = T/(T + KNEE) in equal steps:
//! both ends are smooth, and one table holds for all temperatures. A linear interpolation over a
//! step of δ kelvin is δ²/8 |B''| off; with B'' = (c₂/λT²)² B at most, c₂/λ = 24,000 K in the red,
//! and δ = (T + KNEE)²/(KNEE · 4095), that is 9e-5 of B at 1000 K, 2e-5 at 2000 K and less above.
//!
//! Inputs in kelvin. Total: up to 1 K is black, beyond 1e100 K it is as bright as there. Tested by Y
//! at the reference, by Wien's and Rayleigh and Jeans's law, by the whiteness of 6500 K, and the table
//! against the sum.

/// Second radiation constant h c / k_B [m K].
const C2: f64 = 1.438_776_877e-2;

/// Linear Rec. 709 from CIE XYZ, a row a channel.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
];

/// Hotter is no brighter: sums stay numbers.
const HOTTEST: f64 = 1e100;

/// The temperature in the middle of the table, in kelvin; `KNEE` of `lib/emission.wgsl`.
pub const KNEE: f64 = 2000.0;

/// Entries of the table.
pub const TABLE_SIZE: usize = 4096;

/// Linear Rec. 709 color of a black body at `kelvin`, relative to the luminance of one at
/// `reference_kelvin`.
pub fn blackbody_rgb(kelvin: f64, reference_kelvin: f64) -> [f64; 3] {
    let scale = 1.0 / blackbody_xyz(reference_kelvin)[1];
    let xyz = blackbody_xyz(kelvin).map(|value| value * scale);
    RGB_FROM_XYZ.map(|row| (row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]).max(0.0))
}

/// B/(T + KNEE), a texel for each of [`TABLE_SIZE`] equal steps of T/(T + KNEE) from 0 to 1; the
/// fourth number is 0.
pub fn blackbody_table(reference_kelvin: f64) -> Vec<[f32; 4]> {
    let last = (TABLE_SIZE - 1) as f64;
    let entry = |n: usize| {
        let w = n as f64 / last;
        let kelvin = if w < 1.0 { KNEE * w / (1.0 - w) } else { HOTTEST };
        let [red, green, blue] =
            blackbody_rgb(kelvin, reference_kelvin).map(|value| (value / (kelvin + KNEE)) as f32);
        [red, green, blue, 0.0]
    };
    (0..TABLE_SIZE).map(entry).collect()
}

/// CIE XYZ of a black body, up to a constant factor.
fn blackbody_xyz(kelvin: f64) -> [f64; 3] {
    let kelvin = kelvin.clamp(1.0, HOTTEST);
    let mut xyz = [0.0; 3];
    for step in 0..95 {
        let nm = 360.0 + 5.0 * f64::from(step);
        let lambda_m = nm * 1e-9;
        // Beyond 700 the exponential overflows, and the spectrum is below 1e-270 of any that is
        // seen.
        let exponent = (C2 / (lambda_m * kelvin)).min(700.0);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::spectrum::luminance;

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
        // In the heat of Rayleigh and Jeans it is as T; what lacks is c₂/2λT, less than 2e-8.
        let [cool, hot] = [1e12, 3e12].map(|kelvin| blackbody_rgb(kelvin, 2000.0));
        for (cool, hot) in cool.into_iter().zip(hot) {
            assert!((hot / cool - 3.0).abs() < 1e-6, "{cool} {hot}");
        }
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
    fn any_temperature_has_a_color() {
        for kelvin in [f64::MIN, -5.0, 0.0, 1.0, 200.0] {
            assert!(
                blackbody_rgb(kelvin, 2000.0).iter().all(|value| value.is_finite() && *value < 1e-20),
                "{kelvin}"
            );
        }
        for kelvin in [1e6, 1e38, f64::MAX] {
            let color = blackbody_rgb(kelvin, 2000.0);
            assert!(color.iter().all(|value| value.is_finite() && *value > 1e3), "{kelvin}: {color:?}");
        }
    }

    /// What the shader does, in f64.
    fn looked_up(table: &[[f32; 4]], kelvin: f64) -> [f64; 3] {
        let at = kelvin / (kelvin + KNEE) * (TABLE_SIZE - 1) as f64;
        let low = (at as usize).min(TABLE_SIZE - 2);
        let t = at - low as f64;
        std::array::from_fn(|c| {
            let [a, b] = [low, low + 1].map(|n| f64::from(table[n][c]));
            (a + t * (b - a)) * (kelvin + KNEE)
        })
    }

    #[test]
    fn the_table_is_the_sum() {
        let table = blackbody_table(2000.0);
        assert_eq!(table.len(), TABLE_SIZE);
        let mut kelvin = 1000.0;
        while kelvin < 1e9 {
            let exact = blackbody_rgb(kelvin, 2000.0);
            let most = exact[0].max(exact[2]);
            for (found, exact) in looked_up(&table, kelvin).into_iter().zip(exact) {
                // As derived above, and where blue sets in, a corner of its own curve.
                assert!((found - exact).abs() < 1e-4 * most, "{kelvin} K: {found} {exact}");
            }
            kelvin *= 1.0137;
        }
        assert_eq!(looked_up(&table, 0.0), [0.0; 3]);
    }
}
