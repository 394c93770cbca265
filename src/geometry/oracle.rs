//! f64 oracle of rays and triangles: every triangle is tried (Möller, Trumbore 1997).

use glam::DVec3;

/// A ray, its direction of any length.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// In lengths of the ray's direction.
    pub t: f64,
    pub triangle: usize,
    /// The least barycentric coordinate, 0 on an edge: below 0 outside.
    pub inside: f64,
}

/// The nearest hit beyond t_min, of triangles that are larger by the share `grown` in barycentric
/// coordinates (smaller below 0).
pub fn nearest(triangles: &[[DVec3; 3]], ray: Ray, t_min: f64, grown: f64) -> Option<Hit> {
    let hits = triangles.iter().enumerate().filter_map(|(n, corners)| hit(*corners, n, ray));
    hits.filter(|hit| hit.t > t_min && hit.inside >= -grown).min_by(|a, b| a.t.total_cmp(&b.t))
}

fn hit([a, b, c]: [DVec3; 3], triangle: usize, ray: Ray) -> Option<Hit> {
    let (e1, e2) = (b - a, c - a);
    let across = ray.direction.cross(e2);
    let determinant = e1.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let from = ray.origin - a;
    let u = from.dot(across) / determinant;
    let around = from.cross(e1);
    let v = ray.direction.dot(around) / determinant;
    let t = e2.dot(around) / determinant;
    Some(Hit { t, triangle, inside: u.min(v).min(1.0 - u - v) })
}

#[test]
fn a_ray_meets_a_triangle_where_it_must() {
    let triangle = [[DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y]];
    let ray = Ray { origin: DVec3::new(0.5, 0.5, -3.0), direction: 2.0 * DVec3::Z };
    let found = nearest(&triangle, ray, 0.0, 0.0).unwrap();
    assert_eq!(found, Hit { t: 1.5, triangle: 0, inside: 0.25 });
    // Beyond, behind, beside, along.
    assert_eq!(nearest(&triangle, ray, 1.5, 0.0), None);
    let ray = |origin, direction| nearest(&triangle, Ray { origin, direction }, 0.0, 0.0);
    assert_eq!(ray(DVec3::new(0.5, 0.5, -3.0), DVec3::NEG_Z), None);
    assert_eq!(ray(DVec3::new(1.01, 1.01, -3.0), DVec3::Z), None);
    assert_eq!(ray(DVec3::new(-1.0, 0.5, 0.0), DVec3::X), None);
}
