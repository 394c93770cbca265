// A column of the march of a widening peak.

struct Column {
    // E0: light that was not scattered, of 1 W/m2 that entered.
    unscattered: f32,
    // Light of the peak, and times that the covariance of place [cells] and angle and the variance of angle,
    // along one axis.
    power: f32,
    covariance: f32,
    variance: f32,
    // E* as if nothing widened and no surface stood in the way.
    straight: f32,
    // Of the diffusion across the beam in the last slice.
    number: f32,
    // Of the elimination along a row.
    upper: f32,
    pad: f32,
}
