use super::*;
use crate::geometry::oracle::{Ray, nearest};
use crate::nodes::testing::{Random, ball};
use crate::optics::directions::LineSet;

#[test]
fn segments_that_meet_a_surface_are_found() {
    let mut random = Random(9);
    let mut point = |size: f64| size * DVec3::new(random.unit(), random.unit(), random.unit());
    let dims = [9, 7, 12];
    // Small and large ones, near and around the grid.
    let triangles: Vec<[Vec3; 3]> = (0..40)
        .map(|n| {
            let (at, size) = if n % 4 == 0 { (DVec3::splat(-6.0), 26.0) } else { (point(12.0), 6.0) };
            [(); 3].map(|()| (at + point(size)).as_vec3())
        })
        .collect();
    for n_halvings in [0, 1] {
        let scale = f64::from(1 << n_halvings);
        let place = |p: Vec3| (p.as_dvec3() + APART + 0.5) / scale - 0.5;
        let placed: Vec<[DVec3; 3]> = triangles.iter().map(|corners| corners.map(place)).collect();
        for lines in [LineSet::Lines14, LineSet::Lines50] {
            let directions = lines.directions();
            let bits = walls(&triangles, dims, n_halvings, &directions).unwrap();
            let (mut n_met, mut n_unsure) = (0, 0);
            for (pair, direction) in directions.iter().step_by(2).enumerate() {
                for (idx, bits) in bits.iter().enumerate() {
                    let cell = [idx % 9, idx / 9 % 7, idx / 63].map(|i| i as i32);
                    let next = direction.e + glam::IVec3::from_array(cell);
                    let is_inside = (0..3).all(|axis| (0..dims[axis] as i32).contains(&next[axis]));
                    let origin = DVec3::from_array(cell.map(f64::from));
                    let ray = Ray { origin, direction: direction.e.as_dvec3() };
                    // Past an edge by less than 1e-9 of the triangle either answer is right.
                    let [most, least] = [1e-9, -1e-9]
                        .map(|grown| nearest(&placed, ray, -1e-9, grown).is_some_and(|hit| hit.t < 1.0));
                    n_unsure += usize::from(most != least);
                    n_met += usize::from(most && is_inside);
                    let found = bits >> pair & 1 == 1;
                    assert!(most != least || found == (most && is_inside), "{cell:?} {direction:?} {found}");
                }
            }
            assert!(n_met > 100 && n_unsure < 5, "{n_met} {n_unsure}");
        }
    }
}

#[test]
fn no_line_leaves_a_closed_ball() {
    // Cells are inside or outside; a segment is met where its ends are not the same. Of a ball whose corners are
    // at a distance of 10 the triangles are at 9.87 at least: no center is as close to both.
    let center = DVec3::new(13.1, 12.8, 12.3);
    let triangles: Vec<[Vec3; 3]> = ball(center, 3).iter().map(|t| t.map(|p| p.as_vec3())).collect();
    let dims = [26; 3];
    let directions = LineSet::Lines26.directions();
    let bits = walls(&triangles, dims, 0, &directions).unwrap();
    let radius = |cell: glam::IVec3| (cell.as_dvec3() - center).length();
    for (idx, bits) in bits.iter().enumerate() {
        let cell = glam::IVec3::from_array([idx % 26, idx / 26 % 26, idx / 676].map(|i| i as i32));
        for (pair, direction) in directions.iter().step_by(2).enumerate() {
            let next = cell + direction.e;
            let radii = [radius(cell), radius(next)];
            let is_sure = radii.iter().all(|radius| *radius < 9.86 || *radius > 10.01);
            if is_sure
                && (0..3).all(|axis| (0..26).contains(&next[axis]))
                && (radii[0] < 10.0) != (radii[1] < 10.0)
            {
                assert!(bits >> pair & 1 == 1, "{cell} {direction:?}");
            }
        }
    }
}

#[test]
fn a_wall_on_centers_parts_them() {
    // Every line crosses it in the same place, on every grid.
    let directions = LineSet::Lines14.directions();
    for z in [8.0, 7.5, 3.5] {
        let corners = [(-99.0, -99.0), (99.0, -99.0), (0.0, 99.0)].map(|(x, y)| Vec3::new(x, y, z));
        for n_halvings in [0, 1, 2] {
            let n = 16 >> n_halvings;
            let bits = walls(&[corners], [n; 3], n_halvings, &directions).unwrap();
            let scale = f64::from(1 << n_halvings);
            let wall = (f64::from(z) + APART.z + 0.5) / scale - 0.5;
            for (idx, bits) in bits.iter().enumerate() {
                let cell = [idx % n, idx / n % n, idx / (n * n)].map(|i| i as i32);
                for (pair, direction) in directions.iter().step_by(2).enumerate() {
                    let next = [0, 1, 2].map(|axis| cell[axis] + direction.e[axis]);
                    let is_inside = next.iter().all(|i| (0..n as i32).contains(i));
                    let parts = (f64::from(cell[2]) < wall) != (f64::from(next[2]) < wall);
                    assert_eq!(bits >> pair & 1 == 1, parts && is_inside, "{z} {cell:?} {direction:?}");
                }
            }
        }
    }
}

#[test]
fn surfaces_elsewhere_are_no_walls() {
    let directions = LineSet::Lines14.directions();
    let far = [Vec3::new(-9.0, -9.0, 40.0), Vec3::new(9.0, -9.0, 40.0), Vec3::new(0.0, 90.0, 40.0)];
    assert_eq!(walls(&[far], [8; 3], 0, &directions), None);
    assert_eq!(walls(&[], [8; 3], 0, &directions), None);
}
