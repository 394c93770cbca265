//! The sky: Preetham, Shirley and Smits, "A practical analytic model for daylight" (1999).
//!
//! Below the horizon lies an even ground. The sun's beam is dimmed by air molecules and aerosol as in their
//! appendix, at one wavelength a channel; its disk is 0.53° across, spread over whole texels.
//!
//! Units: 1 is 10 kcd/m² in the maps, so 10 klx in an irradiance, linear Rec. 709. Values are rounded to
//! 16 bits, which halves the files. Limits: ozone and water vapor, which redden the beam by a few percent,
//! are left out, and chroma outside of Rec. 709 is clipped; clouds and hills are noise.

use std::f64::consts::PI;

use glam::DVec3;
use half::f16;
use tyndall::image::Image;
use tyndall::volume::shapes::noise::fbm;

const SUN_RADIUS_DEG: f64 = 0.265;
/// Illuminance by the sun outside of the atmosphere [10 klx].
const SUN_OUTSIDE: f64 = 12.8;
/// Grass and soil.
const GROUND_ALBEDO: [f64; 3] = [0.17, 0.16, 0.10];
/// Preetham's sky, ready to be asked.
pub struct Sky {
    pub to_sun: DVec3,
    turbidity: f64,
    sun_zenith: f64,
    /// Coefficients A to E of Perez's function for Y, x and y.
    perez: [[f64; 5]; 3],
    /// Y [10 kcd/m²], x and y at the zenith.
    zenith: [f64; 3],
    ground: [f64; 3],
}

impl Sky {
    pub fn new(turbidity: f64, sun_height_deg: f64) -> Self {
        let t = turbidity;
        let height = sun_height_deg.to_radians();
        let sun_zenith = 0.5 * PI - height;
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * sun_zenith);
        let chroma = |rows: [[f64; 4]; 3]| {
            let s = sun_zenith;
            let row = |r: [f64; 4]| ((r[0] * s + r[1]) * s + r[2]) * s + r[3];
            (row(rows[0]) * t + row(rows[1])) * t + row(rows[2])
        };
        let mut sky = Self {
            to_sun: DVec3::new(0.0, height.sin(), height.cos()),
            turbidity,
            sun_zenith,
            perez: [
                [
                    0.1787 * t - 1.4630,
                    -0.3554 * t + 0.4275,
                    -0.0227 * t + 5.3251,
                    0.1206 * t - 2.5771,
                    -0.0670 * t + 0.3703,
                ],
                [
                    -0.0193 * t - 0.2592,
                    -0.0665 * t + 0.0008,
                    -0.0004 * t + 0.2125,
                    -0.0641 * t - 0.8989,
                    -0.0033 * t + 0.0452,
                ],
                [
                    -0.0167 * t - 0.2608,
                    -0.0950 * t + 0.0092,
                    -0.0079 * t + 0.2102,
                    -0.0441 * t - 1.6537,
                    -0.0109 * t + 0.0529,
                ],
            ],
            zenith: [
                0.1 * ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192),
                chroma([
                    [0.00166, -0.00375, 0.00209, 0.0],
                    [-0.02903, 0.06377, -0.03202, 0.00394],
                    [0.11693, -0.21196, 0.06052, 0.25886],
                ]),
                chroma([
                    [0.00275, -0.00610, 0.00317, 0.0],
                    [-0.04214, 0.08970, -0.04153, 0.00516],
                    [0.15346, -0.26756, 0.06670, 0.26688],
                ]),
            ],
            ground: [0.0; 3],
        };
        sky.ground = sky.ground();
        sky
    }

    /// What an even ground sends back, of sun and sky: albedo E / π.
    fn ground(&self) -> [f64; 3] {
        let mut irradiance = self.sun_irradiance().map(|e| e * self.to_sun.y);
        let n = 64;
        for (row, column) in (0..n).flat_map(|row| (0..4 * n).map(move |column| (row, column))) {
            // Even steps of the squared sine of the zenith angle weigh by the cosine.
            let sine = ((row as f64 + 0.5) / n as f64).sqrt();
            let azimuth = 2.0 * PI * (column as f64 + 0.5) / (4 * n) as f64;
            let (x, z) = azimuth.sin_cos();
            let direction = DVec3::new(sine * x, (1.0 - sine * sine).sqrt(), sine * z);
            for (sum, l) in irradiance.iter_mut().zip(self.radiance(direction)) {
                *sum += l * PI / (4 * n * n) as f64;
            }
        }
        std::array::from_fn(|c| GROUND_ALBEDO[c] * irradiance[c] / PI)
    }

    /// Of the sky alone [10 kcd/m²]; `direction` of unit length.
    pub fn radiance(&self, direction: DVec3) -> [f64; 3] {
        if direction.y <= 0.0 {
            return self.ground;
        }
        let gamma = self.to_sun.dot(direction).clamp(-1.0, 1.0).acos();
        let [luminance, x, y] = std::array::from_fn(|c| {
            let [a, b, d, e, f] = self.perez[c];
            let perez = |cosine: f64, gamma: f64| {
                (1.0 + a * (b / cosine).exp()) * (1.0 + d * (e * gamma).exp() + f * gamma.cos().powi(2))
            };
            self.zenith[c] * perez(direction.y, gamma) / perez(1.0, self.sun_zenith)
        });
        let (big_x, big_z) = (luminance * x / y, luminance * (1.0 - x - y) / y);
        [
            3.2406 * big_x - 1.5372 * luminance - 0.4986 * big_z,
            -0.9689 * big_x + 1.8758 * luminance + 0.0415 * big_z,
            0.0557 * big_x - 0.2040 * luminance + 1.0570 * big_z,
        ]
        .map(|l| l.max(0.0))
    }

    /// Of the beam, on a plane across it [10 klx].
    pub fn sun_irradiance(&self) -> [f64; 3] {
        // Air mass by Kasten.
        let air_mass =
            1.0 / (self.sun_zenith.cos() + 0.15 * (93.885 - self.sun_zenith.to_degrees()).powf(-1.253));
        let aerosol = 0.04608 * self.turbidity - 0.04586;
        // Wavelengths of the channels [µm].
        [0.61f64, 0.55, 0.465].map(|wavelength| {
            let tau = 0.008735 * wavelength.powf(-4.08) + aerosol * wavelength.powf(-1.3);
            SUN_OUTSIDE * (-air_mass * tau).exp()
        })
    }

    /// Lat-long in OpenEXR's convention: +Z at the center, +X a quarter from the left, +Y on top.
    pub fn map(&self, height: usize, with_sun: bool, radiance: impl Fn(&Self, DVec3) -> [f64; 3]) -> Image {
        let width = 2 * height;
        let texels: Vec<DVec3> = (0..width * height)
            .map(|n| {
                let longitude = PI - 2.0 * PI * ((n % width) as f64 + 0.5) / width as f64;
                let latitude = 0.5 * PI - PI * ((n / width) as f64 + 0.5) / height as f64;
                let (x, z) = longitude.sin_cos();
                DVec3::new(latitude.cos() * x, latitude.sin(), latitude.cos() * z)
            })
            .collect();
        let mut radiance: Vec<[f64; 3]> = texels.iter().map(|&texel| radiance(self, texel)).collect();
        if with_sun {
            // A disk narrower than a texel takes the texels that it touches.
            let reach = SUN_RADIUS_DEG.to_radians() + 0.5 * PI / height as f64;
            let disk: Vec<usize> =
                (0..texels.len()).filter(|&n| texels[n].dot(self.to_sun) >= reach.cos()).collect();
            let texel_sr =
                |n: usize| 2.0 * PI * PI / (width * height) as f64 * texels[n].with_y(0.0).length();
            let solid_angle: f64 = disk.iter().map(|&n| texel_sr(n)).sum();
            for n in disk {
                for (l, e) in radiance[n].iter_mut().zip(self.sun_irradiance()) {
                    *l += e / solid_angle;
                }
            }
        }
        let rounded = radiance.as_flattened().iter().map(|&l| f16::from_f64(l).to_f32()).collect();
        Image::new(width, height, rounded)
    }

    /// With clouds high up, which the sun lights from below, and hills in the haze.
    pub fn evening(&self, direction: DVec3) -> [f64; 3] {
        let mut radiance = self.radiance(direction);
        if direction.y <= 0.0 {
            return radiance;
        }
        let azimuth = direction.with_y(0.0).normalize_or_zero();
        let elevation = direction.y.asin().to_degrees();
        let horizon = self.radiance((azimuth + 0.02 * DVec3::Y).normalize());

        let flat = direction / (direction.y + 0.09);
        let place = DVec3::new(0.55 * flat.x, 0.0, 1.1 * flat.z);
        let bent = place + 0.35 * DVec3::new(noise(place, 4, 70), 0.0, noise(place, 4, 75));
        let thick = noise(1.3 * bent, 7, 80) + 0.25 * noise(0.4 * place, 3, 90) + 0.06;
        let cover = 0.9 * smooth(thick / 0.55) * smooth(direction.y / 0.05);
        // Thin edges scatter the sun forward; what is thick shows its shaded base.
        let forward = 0.3 / (1.0 + 12.0 * (1.0 - direction.dot(self.to_sun))) + 0.055;
        let through = (-2.2 * thick.max(0.0)).exp();
        let (zenith, sun) = (self.radiance(DVec3::Y), self.sun_irradiance());
        for c in 0..3 {
            let cloud = sun[c] * forward * through + 0.55 * zenith[c] + 0.25 * horizon[c];
            radiance[c] = mix(radiance[c], cloud, cover);
        }
        // Ridges one before the other, the nearer the darker; each is as high as noise says, half a degree soft.
        for (idx, (height, haze)) in [(2.6, 0.8), (1.7, 0.62), (0.9, 0.42)].into_iter().enumerate() {
            let top = height + 1.1 * noise(azimuth * (3.0 + idx as f64), 5, 60 + 10 * idx as u32);
            let share = smooth((top - elevation) / 0.5 + 0.5);
            for c in 0..3 {
                let wood = [0.3, 0.36, 0.3][c] * self.ground[1];
                radiance[c] = mix(radiance[c], mix(wood, horizon[c], haze), share);
            }
        }
        radiance
    }
}

fn noise(p: DVec3, octaves: u32, seed: u32) -> f64 {
    f64::from(fbm(p.as_vec3(), octaves, seed))
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + t * (b - a)
}

/// From 0 to 1 without corners.
fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
