//! Light that comes back along its beam: the depths ahead of it.

use glam::DVec3;

use crate::nodes::testing::{Filling, Scene, aheads, assert_close, gpu, point, sun, taus};
use crate::wire::{Beam, Beams};

fn scene(g: f64) -> Scene {
    Scene { g, ..Scene::new([9, 6, 8], Filling::Random, 5.0) }
}

#[test]
fn depths_ahead_are_those_of_light_the_other_way() {
    let Some(gpu) = gpu() else { return };
    let scene = scene(-0.5);
    let medium = scene.medium(gpu);
    // A texel each, and four in a texel.
    let directions =
        [DVec3::new(0.3, -0.2, 0.9), DVec3::NEG_X, DVec3::Y, DVec3::ONE, DVec3::new(-0.1, 0.7, 0.2)];
    for n in [2, 5] {
        let lights: Vec<_> = directions[..n].iter().map(|direction| sun(*direction, 1.0)).collect();
        let reversed: Vec<_> = lights.iter().map(Beam::reversed).collect();
        let [beams, other_way] =
            [lights, reversed].map(|lights| scene.propagate(gpu, &medium, &lights, [0.0; 3]));
        let expected: Vec<_> = taus(gpu, other_way.get()).into_iter().map(Some).collect();
        assert_eq!(aheads(gpu, beams.get()), expected);
        assert_ne!(aheads(gpu, beams.get()), aheads(gpu, other_way.get()));
    }
}

#[test]
fn only_light_that_is_scattered_backward_comes_back() {
    let Some(gpu) = gpu() else { return };
    let lights = [sun(DVec3::Z, 1.0)];
    for (g, has_surfaces) in [(0.5, false), (0.0, false), (-0.5, true)] {
        let scene = scene(g);
        let medium = scene.medium(gpu);
        let plate = scene.plate([2.0, 2.0], [5.0, 5.0], 3.0);
        let surfaces = if has_surfaces { vec![&plate] } else { vec![] };
        let beams = scene.propagate_behind(gpu, &medium, &lights, [0.0; 3], &surfaces);
        let beams: &Beams = beams.get();
        assert!(!beams.returns && beams.ahead.is_none(), "g {g}");
    }
}

#[test]
fn merged_beams_keep_what_is_ahead() {
    let Some(gpu) = gpu() else { return };
    let scene = scene(-0.8);
    let medium = scene.medium(gpu);
    let of = |directions: &[DVec3]| {
        let lights: Vec<_> = directions.iter().map(|direction| sun(*direction, 1.0)).collect();
        scene.propagate(gpu, &medium, &lights, [0.0; 3])
    };
    let (one, two) = (of(&[DVec3::Z]), of(&[DVec3::X, DVec3::NEG_Y]));
    let merged = Beams::merge(gpu, &scene.lattice(), &[one.get(), two.get()]).unwrap();
    assert!(merged.returns && !merged.is_plain());
    let found = aheads(gpu, &merged);
    // Parts are filled up to texels of four.
    for (at, expected) in [(0, &aheads(gpu, one.get())[0]), (4, &aheads(gpu, two.get())[0])] {
        let [found, expected] = [&found[at], expected].map(|depths| &depths.as_ref().unwrap().data[..]);
        assert_close("merged", found, expected, 1e-3, 1e-6);
    }
    // Beside light that does not come back, because it went among surfaces, none does; lamps never do.
    let plate = scene.plate([2.0, 2.0], [5.0, 5.0], 3.0);
    let behind = |light| scene.propagate_behind(gpu, &medium, &[light], [0.0; 3], &[&plate]);
    for (other, returns) in
        [(behind(sun(DVec3::Y, 1.0)), false), (behind(point(DVec3::splat(-3.0), 1.0)), true)]
    {
        let merged = Beams::merge(gpu, &scene.lattice(), &[one.get(), other.get()]).unwrap();
        assert_eq!((merged.returns, merged.ahead.is_some()), (returns, returns));
    }
}
