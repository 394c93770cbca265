//! Moving the camera by hand: orbit, pan, dolly, turn, fly and frame, as pure functions.
//!
//! Angles in radians, lengths in meters. An orbit turns the position around `look_at`, about `up` and about the
//! picture's horizontal; it stops [`POLE`] short of `up`, where the picture would have no roll. Tested by what
//! each must keep.

use glam::{DQuat, DVec3};

use crate::camera::Camera;

/// How close to `up` the view may come.
const POLE: f64 = 0.02;

/// Turns the position around the point that is looked at; the distance stays.
pub fn orbit(camera: Camera, yaw: f64, pitch: f64) -> Camera {
    let back = camera.position - camera.look_at;
    Camera { position: camera.look_at + turned(back, camera.up, yaw, pitch), ..camera }
}

/// Turns the view around the position; the distance stays.
pub fn turn(camera: Camera, yaw: f64, pitch: f64) -> Camera {
    let ahead = camera.look_at - camera.position;
    Camera { look_at: camera.position + turned(ahead, camera.up, yaw, -pitch), ..camera }
}

/// `v` turned about `up`, and then towards it (positive pitch) as far as the pole.
fn turned(v: DVec3, up: DVec3, yaw: f64, pitch: f64) -> DVec3 {
    let up = up.normalize_or(DVec3::Y);
    let v = DQuat::from_axis_angle(up, yaw) * v;
    let Some(axis) = v.cross(up).try_normalize() else { return v };
    let from_up = v.angle_between(up);
    let pitch = pitch.clamp(from_up - (std::f64::consts::PI - POLE), from_up - POLE);
    DQuat::from_axis_angle(axis, pitch) * v
}

/// Moves position and target across the view; the direction stays. Shares of the picture's height, to the
/// right and up.
pub fn pan(camera: Camera, right: f64, up: f64) -> Camera {
    let Ok([_, _, half_up]) = camera.frame() else { return camera };
    let Ok([forward, half_right, _]) = camera.frame() else { return camera };
    let height = 2.0 * half_up.length() * camera.position.distance(camera.look_at);
    let shift = forward_free(half_right, forward) * (right * height) + half_up.normalize() * (up * height);
    Camera { position: camera.position + shift, look_at: camera.look_at + shift, ..camera }
}

fn forward_free(v: DVec3, forward: DVec3) -> DVec3 {
    (v - forward * v.dot(forward)).normalize_or_zero()
}

/// Comes nearer by `steps` of a tenth; the target is never reached, let alone passed.
pub fn dolly(camera: Camera, steps: f64) -> Camera {
    let back = camera.position - camera.look_at;
    let nearer = back * 0.9_f64.powf(steps);
    // Closer than that, position and target would become one number.
    let least = 1e-9 * (1.0 + camera.look_at.length());
    if nearer.length() < least || !nearer.is_finite() {
        return camera;
    }
    Camera { position: camera.look_at + nearer, ..camera }
}

/// Flies along the view, to the right and up, by shares of the distance to the target.
pub fn fly(camera: Camera, ahead: f64, right: f64, up: f64) -> Camera {
    let Ok([forward, half_right, half_up]) = camera.frame() else { return camera };
    let way = forward * ahead + half_right.normalize() * right + half_up.normalize() * up;
    let shift = way * camera.position.distance(camera.look_at);
    Camera { position: camera.position + shift, look_at: camera.look_at + shift, ..camera }
}

/// Looks the same way at a box, all of whose surrounding sphere is in the picture.
pub fn frame(camera: Camera, min: DVec3, max: DVec3) -> Camera {
    let center = 0.5 * (min + max);
    let radius = 0.5 * min.distance(max);
    let half_y = 0.5 * camera.fov_y_deg.to_radians();
    let aspect = camera.width as f64 / camera.height as f64;
    let half = half_y.min((half_y.tan() * aspect).atan());
    let back = (camera.position - camera.look_at).normalize_or(DVec3::Z);
    Camera { position: center + back * (radius / half.sin()).max(1e-6), look_at: center, ..camera }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Camera = Camera {
        position: DVec3::new(3.0, 2.0, 6.0),
        look_at: DVec3::new(1.0, 0.5, -1.0),
        up: DVec3::Y,
        fov_y_deg: 40.0,
        width: 160,
        height: 90,
    };

    fn distance(camera: Camera) -> f64 {
        camera.position.distance(camera.look_at)
    }

    // Some ten operations on numbers of size 10: 1e-13.
    const EPS: f64 = 1e-13;

    #[test]
    fn orbit_keeps_the_distance_and_stops_at_the_pole() {
        for (yaw, pitch) in [(0.3, 0.2), (-2.0, 0.0), (0.0, 5.0), (0.0, -5.0)] {
            let moved = orbit(CAMERA, yaw, pitch);
            assert!((distance(moved) - distance(CAMERA)).abs() < EPS, "{yaw} {pitch}");
            assert_eq!(moved.look_at, CAMERA.look_at);
            assert!(moved.frame().is_ok());
        }
        assert!(orbit(CAMERA, 0.0, 0.2).position.y > CAMERA.position.y);
        let around = orbit(CAMERA, std::f64::consts::TAU, 0.0);
        assert!(around.position.distance(CAMERA.position) < 10.0 * EPS);
    }

    #[test]
    fn turning_keeps_the_place() {
        let moved = turn(CAMERA, 0.4, 0.1);
        assert_eq!(moved.position, CAMERA.position);
        assert!((distance(moved) - distance(CAMERA)).abs() < EPS);
    }

    #[test]
    fn pan_keeps_the_direction() {
        let moved = pan(CAMERA, 0.25, -0.5);
        let direction = |camera: Camera| camera.look_at - camera.position;
        assert!(direction(moved).distance(direction(CAMERA)) < EPS);
        // A whole height down brings the top edge to where the bottom edge was.
        let height = 2.0 * (20.0_f64.to_radians()).tan() * distance(CAMERA);
        let down = pan(CAMERA, 0.0, -1.0).position.distance(CAMERA.position);
        assert!((down - height).abs() < 10.0 * EPS, "{down} {height}");
    }

    #[test]
    fn dolly_never_passes_the_target() {
        let direction = (CAMERA.position - CAMERA.look_at).normalize();
        let mut near = CAMERA;
        for _ in 0..1000 {
            near = dolly(near, 3.0);
        }
        assert!(distance(near) > 0.0 && near.frame().is_ok());
        let back = (near.position - near.look_at).normalize();
        // The distance has lost all but some 7 of its digits beside the target's.
        assert!(back.dot(direction) > 0.999);
        let there_and_back = dolly(dolly(CAMERA, 4.0), -4.0);
        assert!(there_and_back.position.distance(CAMERA.position) < 10.0 * EPS);
    }

    #[test]
    fn a_framed_sphere_touches_the_edge() {
        let (min, max) = (DVec3::new(-1.0, 0.0, 2.0), DVec3::new(3.0, 1.0, 4.0));
        let framed = frame(CAMERA, min, max);
        let radius = 0.5 * min.distance(max);
        assert!((radius / distance(framed) - 20.0_f64.to_radians().sin()).abs() < EPS);
        assert_eq!(framed.look_at, 0.5 * (min + max));
        let tall = frame(Camera { width: 90, height: 160, ..CAMERA }, min, max);
        assert!(distance(tall) > distance(framed));
    }

    #[test]
    fn flying_takes_the_target_along() {
        let moved = fly(CAMERA, 0.5, 0.0, 0.0);
        let direction = (CAMERA.look_at - CAMERA.position).normalize();
        assert!((moved.position - CAMERA.position).normalize().distance(direction) < EPS);
        assert!((distance(moved) - distance(CAMERA)).abs() < EPS);
    }
}
