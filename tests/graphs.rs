//! The presets in `graphs/` and the samples in `data/`: they are what a newcomer sees first.
//!
//! Each preset is read, checked and rendered small on coarse cells, to a picture that is finite and shows
//! a medium in front of something. How right such a picture is, is the matter of `tests/truth.rs`.

mod common;

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use tyndall::graph::{CancelToken, Document, Target, check};
use tyndall::image::{self, ALPHA, Image, Table};
use tyndall::nodes;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn presets() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder("graphs")).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|ending| ending == "json")).collect();
    found.sort();
    assert!(found.len() >= 4, "presets: {found:?}");
    found
}

/// The names of the nodes of this kind, of which there is at least one.
fn of_kind(document: &Document, kind: &str) -> Vec<String> {
    let found = document.nodes.iter().filter(|(_, node)| node.type_id == kind);
    let names: Vec<_> = found.map(|(name, _)| name.clone()).collect();
    assert!(!names.is_empty(), "no node of type {kind}");
    names
}

#[test]
fn presets_are_without_problems() {
    for path in presets() {
        let document = Document::load(&path).unwrap();
        let problems = check(&document, nodes::catalog(), Target::Sinks);
        assert!(problems.is_empty(), "{path:?}: {problems:?}");
        assert!(!document.about.is_empty(), "{path:?} does not say what it is");
        let placed: Vec<_> =
            document.nodes.keys().filter(|name| document.layout.contains_key(*name)).collect();
        assert_eq!(placed.len(), document.nodes.len(), "{path:?}: places of the nodes");
        assert_eq!(document.layout.len(), document.nodes.len(), "{path:?}: places without a node");
        // The first picture has the preset's name; the others' begin with it.
        let name = path.file_stem().unwrap().to_str().unwrap();
        let mut saved: Vec<_> = of_kind(&document, "save_image")
            .iter()
            .map(|node| document.nodes[node].params["path"].as_str().unwrap().to_owned())
            .collect();
        saved.sort();
        assert_eq!(saved[0], format!("../out/{name}.png"));
        assert!(saved.iter().all(|path| path.starts_with(&format!("../out/{name}"))), "{saved:?}");
    }
}

/// Opened and saved, a preset is the file that it was: what is changed by hand shows in its history, and nothing else.
#[test]
fn presets_are_as_they_would_be_saved() {
    for path in presets() {
        let text = std::fs::read_to_string(&path).unwrap();
        let saved = Document::parse(&text, &folder("graphs")).unwrap().to_json();
        let mut lines = text.lines().zip(saved.lines()).enumerate();
        let differs = lines.find(|(_, (is, would_be))| is != would_be);
        assert_eq!(differs, None, "{path:?}");
        assert!(text == saved, "{path:?}");
    }
}

#[test]
fn the_graph_of_the_readme_is_without_problems() {
    let text = std::fs::read_to_string(folder("README.md")).unwrap();
    let (_, after) = text.split_once("```json\n").unwrap();
    let (graph, _) = after.split_once("```").unwrap();
    let document = Document::parse(graph, &folder("")).unwrap();
    let problems = check(&document, nodes::catalog(), Target::Sinks);
    assert!(problems.is_empty(), "{problems:?}");
}

/// What is wrong with a small picture of a medium before a background, or among surfaces, if anything is.
fn flaw(picture: &Image, tone_mapped: &Image, has_surfaces: bool) -> Option<String> {
    if let Some(value) = picture.beauty().iter().find(|v| !v.is_finite() || **v < 0.0) {
        return Some(format!("radiance {value}"));
    }
    let alpha = &picture.layers[ALPHA].data;
    if let Some(value) = alpha.iter().find(|v| !(0.0..=1.0).contains(*v)) {
        return Some(format!("coverage {value}"));
    }
    let n = alpha.len() as f32;
    let covered = alpha.iter().sum::<f32>() / n;
    let densest = alpha.iter().copied().fold(0.0, f32::max);
    let most = if has_surfaces { 0.95 } else { 0.7 };
    if !(0.05..most).contains(&covered) || densest < 0.7 {
        return Some(format!(
            "the medium covers {covered:.3} of the picture, at most {densest:.3} of a pixel"
        ));
    }
    let luminance = |pixel: &[f32; 3]| (pixel[0] + pixel[1] + pixel[2]) / 3.0;
    let mean = |of: &dyn Fn(f32) -> f32| {
        let weighted = tone_mapped.pixels().iter().zip(alpha).map(|(pixel, &a)| of(a) * luminance(pixel));
        weighted.sum::<f32>() / alpha.iter().map(|&a| of(a)).sum::<f32>()
    };
    let (medium, behind) = (mean(&|a| a), mean(&|a| 1.0 - a));
    // Linear display light: 0.01 is a dark grey (sRGB 25 of 255), 0.002 a black that is not 0 (sRGB 7).
    // The ground may well be darker than the sky.
    let stands_out = has_surfaces || medium > 1.2 * behind;
    if !(0.01..0.95).contains(&medium) || !(0.002..0.95).contains(&behind) || !stands_out {
        return Some(format!("display light of the medium {medium:.4}, of what is behind it {behind:.4}"));
    }
    None
}

#[test]
fn presets_show_a_medium() {
    let Some(mut session) = common::session() else { return };
    let mut flaws = Vec::new();
    for path in presets() {
        let mut document = Document::load(&path).unwrap();
        // What shows data and lights nothing is looked at below.
        if !document.nodes.values().any(|node| node.type_id == "raymarch") {
            continue;
        }
        let has_surfaces = document.nodes.values().any(|node| node.type_id == "mesh");
        // Rays that look for surfaces cost more than all else.
        let resolution = format!("medium.max_resolution={}", if has_surfaces { 16 } else { 32 });
        for set in ["camera.width=64", "camera.height=36", &resolution, "medium.max_cells=40000"] {
            let (name, value) = set.split_once('=').unwrap();
            document.set(nodes::catalog(), name, value).unwrap();
        }
        // Light on surfaces costs as much for a small picture as for a large one, each beam its part.
        for (_, node) in document.nodes.iter_mut().filter(|(_, node)| node.type_id == "light_decomposition") {
            node.params.insert("count".to_owned(), 4.into());
        }
        let tones = of_kind(&document, "tone_map");
        let targets: Vec<&str> = tones.iter().map(String::as_str).collect();
        let solved = session.solve(&document, Target::Nodes(&targets), &CancelToken::new(), &mut |_| ());
        let failures: Vec<_> = solved.evaluation.failures().collect();
        assert!(failures.is_empty(), "{path:?}: {failures:?}");
        let image = |node: &str| solved.evaluation.value(node, "image").unwrap().get::<Image>().clone();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        for tone in &tones {
            let march = document.wires.iter().find(|wire| wire.to.node == *tone).unwrap().from.node.clone();
            if let Some(flaw) = flaw(&image(&march), &image(tone), has_surfaces) {
                flaws.push(format!("{name}, {march}: {flaw}"));
            }
        }
        eprintln!("{name}: {:.0} ms", solved.wall_ms);
    }
    assert!(flaws.is_empty(), "\n{}", flaws.join("\n"));
}

/// Slice, transfer function and histogram of the plume: each shows both the plume and what is beside it.
#[test]
fn the_explorer_shows_its_data() {
    let Some(mut session) = common::session() else { return };
    let mut document = Document::load(&folder("graphs/explore.json")).unwrap();
    for set in ["camera.width=64", "camera.height=36", "slice.resolution=64"] {
        let (name, value) = set.split_once('=').unwrap();
        document.set(nodes::catalog(), name, value).unwrap();
    }
    let targets = ["slice", "look", "histogram"];
    let solved = session.solve(&document, Target::Nodes(&targets), &CancelToken::new(), &mut |_| ());
    let failures: Vec<_> = solved.evaluation.failures().collect();
    assert!(failures.is_empty(), "{failures:?}");
    let value = |node: &str, port: &str| solved.evaluation.value(node, port).unwrap().clone();
    for node in ["slice", "look"] {
        let image = value(node, "image");
        let image: &Image = image.get();
        assert!(image.layers.values().flat_map(|layer| &layer.data).all(|x| x.is_finite()), "{node}");
        let shown = image.pixels().iter().filter(|[r, g, b]| r.max(*g).max(*b) > 0.1).count();
        let n_pixels = image.width * image.height;
        assert!((n_pixels / 50..n_pixels).contains(&shown), "{node}: {shown} of {n_pixels}");
    }
    let table = value("histogram", "table");
    let counts = table.get::<Table>().column("count").unwrap();
    assert!(counts.iter().sum::<f64>() > 10_000.0 && counts.iter().filter(|n| **n > 0.0).count() > 10);
}

#[test]
fn flaws_are_found() {
    let picture = |radiance: [f32; 2], alpha: [f32; 2]| {
        let mut picture = Image::new(2, 1, radiance.iter().flat_map(|&l| [l; 3]).collect());
        picture.insert(ALPHA, 1, alpha.to_vec());
        picture
    };
    let found = |radiance, alpha| {
        let picture = picture(radiance, alpha);
        flaw(&picture, &picture, false)
    };
    assert_eq!(found([0.5, 0.1], [0.9, 0.0]), None);
    let nothing_seen = [0.0, 0.0];
    let flawed = [
        found([f32::NAN, 0.1], [0.9, 0.0]),
        found([f32::INFINITY, 0.1], [0.9, 0.0]),
        found([0.5, -0.1], [0.9, 0.0]),
        found([0.5, 0.1], [1.1, 0.0]),
        found([0.5, 0.1], nothing_seen),
        found([0.5, 0.1], [0.9, 0.9]),
        found([0.0, 0.1], [0.9, 0.0]),
        found([0.5, 0.0], [1.0, 0.0]),
        found([0.1, 0.1], [0.9, 0.0]),
    ];
    assert!(flawed.iter().all(Option::is_some), "{flawed:?}");
    let among_surfaces = |radiance, alpha| {
        let picture = picture(radiance, alpha);
        flaw(&picture, &picture, true)
    };
    assert_eq!(among_surfaces([0.1, 0.2], [0.9, 0.9]), None);
    assert!(among_surfaces([0.1, 0.2], [1.0, 1.0]).is_some());
    assert!(among_surfaces([0.0, 0.0], [0.9, 0.9]).is_some());
}

/// The maps of `examples/make_samples` differ by a sun alone, 24° high in the direction of +Z.
#[test]
fn the_sun_is_where_the_sky_says() {
    let read = |name: &str| image::read_environment(&folder("data").join(name)).unwrap();
    let (with, without) = (read("sky_sun.exr"), read("sky.exr"));
    assert_eq!((with.width, with.height), (without.width, without.height));
    let texel = PI / with.height as f64;
    let (mut sum, mut n_lit) = (glam::DVec3::ZERO, 0);
    for (n, (lit, dark)) in with.pixels().iter().zip(without.pixels()).enumerate() {
        assert!(lit.iter().chain(dark).all(|l| l.is_finite() && *l > 0.0), "texel {n}: {lit:?} {dark:?}");
        if lit != dark {
            let longitude = PI - texel * ((n % with.width) as f64 + 0.5);
            let latitude = 0.5 * PI - texel * ((n / with.width) as f64 + 0.5);
            let (x, z) = longitude.sin_cos();
            sum += f64::from(lit[1] - dark[1])
                * glam::DVec3::new(latitude.cos() * x, latitude.sin(), latitude.cos() * z)
                * latitude.cos();
            n_lit += 1;
        }
    }
    let height = 24f64.to_radians();
    let off = sum.normalize().angle_between(glam::DVec3::new(0.0, height.sin(), height.cos()));
    // The disk takes whole texels; its mean is at most half a texel's diagonal off.
    assert!(off < 0.5 * 2f64.sqrt() * texel, "{off} rad");
    assert!((1..=9).contains(&n_lit), "{n_lit} texels of sun");
}

/// What a field of every node says is no parameter of one.
#[test]
fn no_kind_has_a_reserved_name() {
    assert!(nodes::catalog().find(tyndall::graph::GROUP).is_none());
    for kind in nodes::catalog().0 {
        let is_reserved = |name: &str| tyndall::graph::RESERVED.contains(&name);
        assert!(kind.params.iter().all(|param| !is_reserved(param.name)), "{}", kind.id);
    }
}
