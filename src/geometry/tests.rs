use std::path::Path;

use base64::Engine;
use glam::{DMat4, DVec3, Vec3};
use serde_json::{Value as Json, json};

use super::bvh::Bvh;
use super::oracle::{Ray, nearest};
use super::{Mesh, MeshError, files, read};

const WHITE: [f64; 3] = [1.0; 3];

/// Reads what a file of this name would hold.
fn read_text(name: &str, contents: impl AsRef<[u8]>) -> Result<Mesh, MeshError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, contents).unwrap();
    read(&path, DMat4::IDENTITY, WHITE)
}

fn refusal(name: &str, contents: impl AsRef<[u8]>) -> String {
    read_text(name, contents).unwrap_err().to_string()
}

fn corners(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|n| mesh.positions[n as usize])).collect()
}

const SQUARE: &str =
    "# a square\no square\nv 0 0 0\nv 1 0 0 # to the right\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/-99 4\n";

#[test]
fn polygons_are_fans_and_the_transform_is_applied() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.OBJ");
    std::fs::write(&path, SQUARE).unwrap();
    let moved = DMat4::from_translation(DVec3::Z) * DMat4::from_scale(DVec3::splat(2.0));
    let mesh = read(&path, moved, [0.1, 0.2, 0.3]).unwrap();
    let [a, b, c, d] = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
    assert_eq!(corners(&mesh), [[a, b, c], [a, c, d]]);
    assert_eq!((mesh.reflectance, mesh.n_degenerate), ([0.1, 0.2, 0.3], 0));
}

#[test]
fn obj_knows_relative_indices_colors_and_several_objects() {
    let text = "v 0 0 0 1 1 1\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\ng b\nusemtl x\nv 0 0 1\nf 1 2 4\nl 1 2\n";
    let mesh = read_text("a.obj", text).unwrap();
    assert_eq!(corners(&mesh)[1], [DVec3::ZERO, DVec3::X, DVec3::Z]);
    assert_eq!(mesh.triangles.len(), 2);
}

#[test]
fn triangles_without_area_are_counted() {
    let text = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 4\nf 1 2 4\n";
    let mesh = read_text("a.obj", text).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.n_degenerate), (1, 2));
    let error = refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    assert!(
        error
            .ends_with("a.obj: no triangle with an area (1 without): export faces, not only points or lines")
    );
}

#[test]
fn refusals_of_obj_name_the_line() {
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let cases = [
        (format!("{three}f 1 2 4\n"), "line 4: face index 4 of 3 vertices: allowed are 1..=3"),
        (format!("{three}f 1 2 0\n"), "line 4: face index 0 of 3 vertices"),
        (format!("{three}\nf 1 2 -4\n"), "line 5: face index -4 of 3 vertices"),
        (format!("{three}f 1 2 x\n"), "line 4: face parse error"),
        (format!("{three}f 1 2 99999999999999999999\n"), "line 4: face parse error"),
        ("v 0 0 0\nv 1 0\n".to_owned(), "line 2: position parse error"),
        (format!("v nan 0 0\n{three}f 1 2 3\n"), "line 1: a coordinate is no finite number"),
        (format!("{three}f\n"), "no triangle with an area (0 without)"),
        (String::new(), "no triangle with an area"),
    ];
    for (text, expected) in cases {
        let error = refusal("a.obj", &text);
        assert!(error.contains(expected), "{text}: {error}");
    }
    assert!(refusal("a.obj", b"v 0 0 0\nv \xff").contains("line 2: it is not UTF-8"));
    let far = refusal("a.obj", "v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n");
    assert!(far.contains("allowed are finite numbers up to 1e9"), "{far}");
}

#[test]
fn other_files_are_refused() {
    assert!(refusal("a.stl", "solid").contains("use .obj, .gltf or .glb"));
    let missing = read(Path::new("/nowhere/a.obj"), DMat4::IDENTITY, WHITE).unwrap_err().to_string();
    assert!(missing.starts_with("/nowhere/a.obj: ") && missing.len() > 20, "{missing}");
    assert!(refusal("a.gltf", "{}").contains("a.gltf: document: "));
}

/// A document of one triangle (0,0,0) (1,0,0) (0,1,0) with u16 indices, its node moved by +Z under one
/// that is twice as large, in one buffer.
fn document() -> (Json, Vec<u8>) {
    let mut data: Vec<u8> = Vec::new();
    for x in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        data.extend(x.to_le_bytes());
    }
    for index in [0_u16, 1, 2, 0] {
        data.extend(index.to_le_bytes());
    }
    let uri = base64::engine::general_purpose::STANDARD.encode(&data);
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "scale": [2.0, 2.0, 2.0], "children": [1] },
            { "translation": [0.0, 0.0, 1.0], "mesh": 0 }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "byteLength": 44, "uri": format!("data:application/octet-stream;base64,{uri}") }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 8 }
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
              "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.0] },
            { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" }
        ]
    });
    (document, data)
}

const MOVED: [DVec3; 3] = [DVec3::new(0.0, 0.0, 2.0), DVec3::new(2.0, 0.0, 2.0), DVec3::new(0.0, 2.0, 2.0)];

#[test]
fn gltf_nodes_move_what_is_below_them() {
    let (document, _) = document();
    let mesh = read_text("a.gltf", document.to_string()).unwrap();
    assert_eq!(corners(&mesh), [MOVED]);
}

#[test]
fn gltf_buffers_may_stand_beside_the_file_or_in_it() {
    let (mut document, data) = document();
    document["buffers"][0]["uri"] = "a%20b.bin".into();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, document.to_string()).unwrap();
    let missing = read(&path, DMat4::IDENTITY, WHITE).unwrap_err().to_string();
    assert!(missing.contains("a b.bin: "), "{missing}");
    assert_eq!(files(&path), [path.clone(), folder.path().join("a b.bin")]);
    std::fs::write(folder.path().join("a b.bin"), &data).unwrap();
    assert_eq!(corners(&read(&path, DMat4::IDENTITY, WHITE).unwrap()), [MOVED]);

    document["buffers"][0].as_object_mut().unwrap().remove("uri");
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = Vec::new();
    glb.extend(b"glTF");
    glb.extend(2_u32.to_le_bytes());
    glb.extend((12 + 8 + text.len() as u32 + 8 + data.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &data)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    assert_eq!(corners(&read_text("a.glb", &glb).unwrap()), [MOVED]);
    for n in 0..glb.len() {
        assert!(read_text("a.glb", &glb[..n]).is_err(), "{n} bytes");
    }
}

#[test]
fn gltf_strips_fans_and_no_indices() {
    // Mode, whether there are indices, how many of them, triangles, and those without an area.
    let cases = [(4, true, 3, 1, 0), (4, false, 3, 1, 0), (5, true, 4, 2, 0), (6, true, 4, 1, 1)];
    for (mode, indices, count, n_triangles, n_degenerate) in cases {
        let (mut document, _) = document();
        let primitive = &mut document["meshes"][0]["primitives"][0];
        primitive["mode"] = mode.into();
        if !indices {
            primitive.as_object_mut().unwrap().remove("indices");
        }
        document["accessors"][1]["count"] = count.into();
        let mesh = read_text("a.gltf", document.to_string()).unwrap();
        assert_eq!((mesh.triangles.len(), mesh.n_degenerate), (n_triangles, n_degenerate), "{mode}");
    }
}

#[test]
fn refusals_of_gltf_name_the_element() {
    let cases: &[(&str, Json, &str)] = &[
        ("/accessors/1/count", json!(400), "mesh 0, primitive 0: 400 elements do not fit into 8 bytes"),
        ("/accessors/0/count", json!(1_u64 << 60), "elements do not fit"),
        ("/accessors/0/count", json!(2), "index 2 of 2 positions: allowed are indices below 2"),
        ("/bufferViews/0/byteLength", json!(1_000_000), "of a buffer of 44: is the file cut off?"),
        ("/bufferViews/1/byteOffset", json!(0), "mesh 0, primitive 0: "),
        ("/accessors/1/componentType", json!(5122), "indices as I16: allowed are u8, u16 and u32"),
        ("/accessors/0/componentType", json!(5122), "export positions as 32-bit floats"),
        ("/nodes/1/children", json!([0]), "it stands below two nodes or below itself"),
        ("/buffers/0/uri", json!("https://example.org/a.bin"), "buffer 0 at another place"),
        ("/buffers/0/uri", json!("data:x;base64,!"), "buffer 0: its base64 text is damaged"),
        ("/accessors/0/bufferView", json!(9), "document: "),
    ];
    for (place, value, expected) in cases {
        let (mut document, _) = document();
        match document.pointer_mut(place) {
            Some(found) => *found = value.clone(),
            None => document["nodes"][1]["children"] = value.clone(),
        }
        if *place == "/bufferViews/1/byteOffset" {
            // Bytes of floats as indices.
            document["accessors"][1]["byteOffset"] = json!(14);
            document["bufferViews"][1]["byteLength"] = json!(36);
        }
        let error = refusal("a.gltf", document.to_string());
        assert!(error.contains(expected), "{place}: {error}");
    }
}

#[test]
fn samples_of_both_kinds() {
    let Some(shared) = crate::shared_dir() else {
        eprintln!("skipped: no shared folder");
        return;
    };
    let sphere = read(&shared.join("samples/icosphere.obj"), DMat4::IDENTITY, WHITE).unwrap();
    assert_eq!((sphere.triangles.len(), sphere.n_degenerate), (320, 0));
    // Its vertices stand on the unit sphere, written with seven digits.
    assert!(sphere.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
    let ground = read(&shared.join("samples/ground.obj"), DMat4::IDENTITY, WHITE).unwrap();
    assert_eq!(ground.triangles.len(), 2);
}

/// Numbers in 0..1 from a seed (splitmix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// Random triangles of one size in a unit cube, as f32 numbers.
fn soup(random: &mut Random, n: usize, size: f64) -> Vec<[DVec3; 3]> {
    let mut triangle = || {
        let at = random.point();
        [(); 3].map(|()| (at + size * random.point()).as_vec3().as_dvec3())
    };
    (0..n).map(|_| triangle()).collect()
}

/// The nearest hit by the tree's boxes, each leaf's triangles by the oracle.
fn walked(bvh: &Bvh, triangles: &[[DVec3; 3]], ray: Ray) -> (Option<f64>, usize) {
    let (mut found, mut n_tried): (Option<f64>, usize) = (None, 0);
    let mut idx = 0;
    while idx < bvh.nodes.len() {
        let node = bvh.nodes[idx];
        let (a, b) = (node.low.as_dvec3() - ray.origin, node.high.as_dvec3() - ray.origin);
        let (a, b) = (a / ray.direction, b / ray.direction);
        let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
        if near > far {
            idx = node.skip as usize;
            continue;
        }
        let leaf = &bvh.order[node.first as usize..][..node.n_triangles as usize];
        let held: Vec<[DVec3; 3]> = leaf.iter().map(|&n| triangles[n as usize]).collect();
        n_tried += held.len();
        let hit = nearest(&held, ray, 0.0, 0.0).map(|hit| hit.t);
        found = found.into_iter().chain(hit).reduce(f64::min);
        idx += 1;
    }
    (found, n_tried)
}

#[test]
fn the_tree_finds_what_trying_all_finds() {
    let mut random = Random(11);
    for (n, size) in [(1, 1.0), (4, 0.5), (5, 0.5), (300, 0.1), (2000, 0.02), (20_000, 5e-3)] {
        let triangles = soup(&mut random, n, size);
        let singles: Vec<[Vec3; 3]> = triangles.iter().map(|t| t.map(|p| p.as_vec3())).collect();
        let bvh = Bvh::new(&singles);
        let mut order = bvh.order.clone();
        order.sort_unstable();
        assert_eq!(order, (0..n as u32).collect::<Vec<_>>());
        let (mut n_hits, mut n_tried) = (0, 0);
        for _ in 0..500 {
            let origin = 3.0 * random.point() - 1.0;
            let ray = Ray { origin, direction: random.point() - origin };
            let (found, tried) = walked(&bvh, &triangles, ray);
            assert_eq!(found, nearest(&triangles, ray, 0.0, 0.0).map(|hit| hit.t), "{n} {ray:?}");
            n_hits += usize::from(found.is_some());
            n_tried += tried;
        }
        assert!(n_hits > 10, "{n}: {n_hits} hits say nothing");
        // A tree that were none would try all.
        assert!(n < 300 || n_tried < 500 * n / 5, "{n}: {n_tried} tried");
    }
}

#[test]
fn triangles_in_one_place_make_a_tree() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let bvh = Bvh::new(&[corners; 33]);
    assert_eq!(bvh.order.len(), 33);
    assert!(bvh.nodes.iter().all(|node| node.n_triangles <= 4 && node.skip as usize <= bvh.nodes.len()));
    assert!(Bvh::new(&[]).nodes.is_empty());
}
