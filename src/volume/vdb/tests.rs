//! The reader against OpenVDB's own readings, its own round trips, and damage.
//!
//! `reference.json` was made with OpenVDB 10.0.1 in C++: a row a grid with name, type, active voxels, leaves,
//! background, min, max, sum, bounding box, a hash over all leaves and one over 512 voxels of 8 seeded boxes. The
//! `fixtures` were written by the same library, one grid a value type, and hold each mask code and tiles on all levels;
//! they lie deflated. `blosc_chunks.json` was made with c-blosc.

mod damage;
mod legacy;

use super::*;
use crate::volume::grid::{Grid, Leaf, Tile};
use crate::volume::stats::Sample;
use glam::{DMat4, DVec3, IVec3};
use rayon::prelude::*;
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::io::Read;

const FIXTURES: [(&str, &[u8]); 5] = [
    ("blosc", include_bytes!("fixtures/blosc.vdb.z")),
    ("mask", include_bytes!("fixtures/mask.vdb.z")),
    ("zip_mask", include_bytes!("fixtures/zip_mask.vdb.z")),
    ("blosc_mask", include_bytes!("fixtures/blosc_mask.vdb.z")),
    ("stream", include_bytes!("fixtures/stream.vdb.z")),
];

fn fixture(name: &str) -> File {
    let (_, bytes) = FIXTURES.iter().find(|(known, _)| *known == name).expect("a fixture's name");
    let mut inflated = Vec::new();
    flate2::read::ZlibDecoder::new(*bytes).read_to_end(&mut inflated).expect("a whole fixture");
    File::from_bytes(format!("{name}.vdb"), inflated).expect("a fixture opens")
}

fn reference() -> BTreeMap<String, Vec<Vec<Json>>> {
    serde_json::from_str(include_str!("reference.json")).expect("the table is JSON")
}

const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

fn fnv(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

fn leaf_hash(grid: &Grid) -> u64 {
    grid.leaves.iter().fold(FNV_BASIS, |hash, leaf| {
        let hash = leaf.origin.to_array().iter().fold(hash, |hash, v| fnv(hash, &v.to_le_bytes()));
        let hash = leaf.active.iter().fold(hash, |hash, v| fnv(hash, &v.to_le_bytes()));
        leaf.values.iter().fold(hash, |hash, v| fnv(hash, &v.to_le_bytes()))
    })
}

/// Values in 8 boxes of 4³ voxels in and around the active box; the generator is Knuth's 64-bit one from seed 1.
fn probe_hash(grid: &Grid) -> u64 {
    let Some((min, max)) = grid.active_bbox() else {
        return FNV_BASIS;
    };
    let mut state = 1_u64;
    let mut random = |range: i32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % range as u64) as i32
    };
    (0..8).fold(FNV_BASIS, |hash, _| {
        let origin = IVec3::from_array(std::array::from_fn(|i| min[i] - 4 + random(max[i] - min[i] + 9)));
        grid.dense(origin, [4; 3]).iter().fold(hash, |hash, value| fnv(hash, &value.to_le_bytes()))
    })
}

fn numbers(sample: Option<Sample>) -> Vec<f64> {
    match sample {
        None => vec![],
        Some(Sample::Scalar(value)) => vec![value],
        Some(Sample::Vector(values)) => values.to_vec(),
    }
}

fn close(ours: &[f64], theirs: &Json, what: &str) {
    let theirs: Vec<f64> = theirs.as_array().expect(what).iter().map(|v| v.as_f64().expect(what)).collect();
    assert_eq!(ours.len(), theirs.len(), "{what}: {ours:?} {theirs:?}");
    for (a, b) in ours.iter().zip(&theirs) {
        // The table has 9 digits, so half a unit of the ninth: 5e-9 relative; sums of up to 1e6 terms in f64 in another
        // order add less than 1e6 · 2^-53 = 1e-10. Sums that cancel are measured by their terms, which are below 1e6.
        assert!((a - b).abs() <= 1e-8 * a.abs().max(b.abs()) + 1e-5, "{what}: {a} is not {b}");
    }
}

/// Checks a file against its rows; `listed` says which of the rows' names it has.
fn check(file: &File, rows: &[Vec<Json>], what: &str) {
    for row in rows {
        let name = row[0].as_str().expect(what);
        let entry = file.find(name).unwrap_or_else(|err| panic!("{what}: {err}"));
        let what = format!("{what} {name}");
        if entry.refused.is_some() {
            assert_eq!(name, "frustum", "{what}: {:?}", entry.refused);
            continue;
        }
        let (figures, background) = file.figures(entry).unwrap_or_else(|err| panic!("{what}: {err}"));
        let kind = if name == "mask" { "mask" } else { row[1].as_str().expect("a type") };
        assert_eq!(entry.kind.to_string(), kind, "{what}");
        assert_eq!(figures.active_voxels, row[2].as_u64().expect("a count"), "{what}");
        close(&numbers(Some(background)), &row[4], &what);
        close(&numbers(figures.min), &row[5], &what);
        close(&numbers(figures.max), &row[6], &what);
        let count = figures.active_voxels as f64;
        let sum: Vec<f64> = numbers(figures.mean).iter().map(|mean| mean * count).collect();
        close(&sum, &row[7], &what);
        let bbox: Vec<i32> = figures.bbox_min.into_iter().chain(figures.bbox_max).flatten().collect();
        assert_eq!(serde_json::to_value(bbox).expect("JSON"), row[8], "{what}");
        if entry.kind.is_vector() {
            continue;
        }
        let grid = file.read(name).unwrap_or_else(|err| panic!("{what}: {err}"));
        assert_eq!(grid.leaves.len() as u64, row[3].as_u64().expect("a count"), "{what}");
        assert_eq!(grid.active_voxels(), figures.active_voxels, "{what}");
        assert_eq!(format!("{:016x}", leaf_hash(&grid)), row[9].as_str().expect("a hash"), "{what}");
        assert_eq!(format!("{:016x}", probe_hash(&grid)), row[10].as_str().expect("a hash"), "{what}");
    }
}

#[test]
fn real_files_have_openvdbs_values() {
    let Some(folder) = crate::shared_dir() else {
        eprintln!("skipped: no shared files");
        return;
    };
    let files = reference();
    let files: Vec<_> = files.iter().filter(|(name, _)| *name != "fixtures").collect();
    assert!(files.len() > 30);
    files.par_iter().for_each(|(name, rows)| {
        let path = folder.join("volumes").join(name);
        let file = File::open(&path).unwrap_or_else(|err| panic!("{err}"));
        check(&file, rows, name);
    });
}

#[test]
fn fixtures_of_all_types_have_openvdbs_values() {
    for (name, _) in FIXTURES {
        let mut rows = reference().remove("fixtures").expect("rows of the fixtures");
        if name == "stream" {
            // `io::Stream` lists grids by their names without numbers.
            rows.retain(|row| row[0] != "float[1]");
        }
        check(&fixture(name), &rows, name);
    }
}

#[test]
fn names_instances_metadata_and_maps() {
    let file = fixture("blosc_mask");
    let names: Vec<_> = file.grids.iter().map(|entry| entry.name.as_str()).collect();
    let expected = "float[0] half double double_half int32 int64 bool mask vec3s vec3s_half vec3d vec3i float[1] frustum";
    assert_eq!(names.join(" "), expected);
    let first = file.read("float").expect("the first of two");
    let mut second = file.read("float[1]").expect("its instance");
    assert_eq!(second.world_from_index, DMat4::from_scale(DVec3::splat(0.5)));
    assert_eq!(file.grids[12].parent.as_deref(), Some("float[0]"));
    second.world_from_index = first.world_from_index;
    second.name.clone_from(&first.name);
    assert_eq!(first, second);
    let half = file.read("half").expect("a scaled map").world_from_index;
    assert_eq!(half.transform_point3(DVec3::ONE), DVec3::new(1.0 + 1.0, 2.0 + 2.0, 4.0 + 3.0));
    // OpenVDB's rotation about y takes z towards x; the map rotates first and translates last, in index order.
    let turned = file.read("double").expect("a rotated map").world_from_index;
    assert!((turned.determinant() - 1.0).abs() < 1e-12 && turned.x_axis.x == 0.5_f64.cos(), "{turned}");
    let metadata = &file.grids[0].metadata;
    assert_eq!(metadata["an_int"], MetaValue::Int(7));
    assert_eq!(metadata["an_int64"], MetaValue::Int(1 << 40));
    assert_eq!(metadata["a_flag"], MetaValue::Bool(true));
    assert_eq!(metadata["a_double"], MetaValue::Float(0.1));
    assert_eq!(metadata["a_vector"], MetaValue::Floats(vec![1.0, 2.0, 3.0]));
    assert!(matches!(&metadata["a_matrix"], MetaValue::Floats(values) if values.len() == 16));
    let refused = |name: &str| file.read(name).expect_err("refused").to_string();
    assert!(refused("frustum").contains("frustum transform"));
    assert!(refused("vec3s").contains("holds vectors (vec3s)"));
    assert!(refused("smoke").contains("there are `float[0]`, `half`"), "{}", refused("smoke"));
}

#[test]
fn names_are_unique() {
    // A file that no library writes: two unique names are alike.
    let grids = ["a", "b", "c"].map(|name| sample_grid(name, DMat4::IDENTITY));
    let mut bytes = to_bytes(&grids, WriteOptions::default());
    let name = b"\x01\0\0\0b\x10\0\0\0Tree";
    let at = bytes.windows(name.len()).position(|window| window == name).expect("a descriptor");
    bytes[at + 4] = b'a';
    let file = File::from_bytes("alike.vdb", bytes).expect("a file");
    let names: Vec<_> = file.grids.iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(names, ["a", "a[1]", "c"]);
}

#[test]
fn summary_has_the_contracts_fields() {
    let summary = serde_json::to_value(fixture("blosc_mask").summary()).expect("JSON");
    let keys = |value: &Json| {
        let mut keys: Vec<_> = value.as_object().expect("an object").keys().map(String::as_str).collect();
        keys.sort_unstable();
        keys.join(" ")
    };
    assert_eq!(keys(&summary), "file grids version");
    assert_eq!(
        keys(&summary["grids"][1]),
        "active_voxels background bbox_max bbox_min compression max mean metadata min name type voxel_size world_from_index"
    );
    assert_eq!(summary["grids"][1]["type"], "half");
    assert_eq!(summary["grids"][1]["voxel_size"], serde_json::json!([1.0, 2.0, 4.0]));
    assert_eq!(summary["grids"][1]["world_from_index"][7], 2.0);
    assert_eq!(summary["grids"][8]["min"].as_array().map(Vec::len), Some(3));
    assert_eq!(summary["grids"][12]["active_voxels"], summary["grids"][0]["active_voxels"]);
    assert_eq!(keys(&summary["grids"][13]), "compression metadata name refused type");
}

#[test]
fn blosc_chunks_of_all_codecs() {
    let expected: Vec<u8> = (0..750_u32).flat_map(|i| (i * i % 97 + i / 50 * 256).to_le_bytes()).collect();
    let chunks: BTreeMap<String, String> =
        serde_json::from_str(include_str!("fixtures/blosc_chunks.json")).expect("JSON");
    assert!(chunks.len() > 10);
    for (name, text) in chunks {
        let digit = |c: u8| (c as char).to_digit(16).expect("hexadecimal") as u8;
        let chunk: Vec<u8> =
            text.as_bytes().chunks(2).map(|pair| digit(pair[0]) << 4 | digit(pair[1])).collect();
        let mut out = vec![0; expected.len()];
        let result = blosc::decompress(&chunk, 0, &mut out);
        if name.contains("shuffle2") {
            assert!(result.expect_err("bit shuffle").what.contains("bit shuffle"));
        } else {
            result.unwrap_or_else(|fault| panic!("{name}: {}", fault.what));
            assert_eq!(out, expected, "{name}");
        }
        // Damage: no panic, and no more than is there.
        for i in 0..chunk.len() {
            let mut damaged = chunk.clone();
            damaged[i] ^= 1 << (i % 8);
            let _ = blosc::decompress(&damaged, 0, &mut out);
            let _ = blosc::decompress(&chunk[..i], 0, &mut out).expect_err("a truncated chunk");
        }
    }
}

/// A grid with all mask codes and tiles on all levels.
fn sample_grid(name: &str, matrix: DMat4) -> Grid {
    let mut leaves = Vec::new();
    for code in 0..9 {
        let mut leaf = Leaf {
            origin: IVec3::new(8 * code, 0, 0),
            active: [0x0f0f_3355_0000_ff01; 8],
            values: Box::new([2.0; 512]),
        };
        for n in 0..512 {
            let is_odd = n % 2 == 1;
            leaf.values[n] = match (leaf.active[n / 64] >> (n % 64) & 1, code, is_odd) {
                (1, _, _) => n as f32 / 8.0,
                (_, 1, _) | (_, 3, true) => -2.0,
                (_, 2, _) | (_, 4, true) | (_, 5, true) => 3.5,
                (_, 5, false) => 4.5,
                (_, 6, _) => (n % 5) as f32,
                _ => 2.0,
            };
        }
        if code > 6 {
            leaf.active = [if code == 7 { 0 } else { u64::MAX }; 8];
        }
        leaves.push(leaf);
    }
    let tile = |x, size, value, active| Tile { origin: IVec3::new(x, 0, 0), size, value, active };
    let tiles = vec![
        tile(-4096, 4096, 1.0, false),
        tile(256, 128, 5.0, true),
        tile(80, 8, 6.0, false),
        tile(88, 8, 7.0, true),
    ];
    Grid { name: name.into(), background: 2.0, world_from_index: matrix, leaves, tiles }
}

fn options() -> impl Iterator<Item = WriteOptions> {
    let compressions = [WriteCompression::None, WriteCompression::Zip];
    compressions
        .into_iter()
        .flat_map(|compression| [false, true].map(|half| WriteOptions { compression, half }))
}

/// In the order of the file, leaves by node and tiles by level.
fn sorted(mut grid: Grid) -> Grid {
    grid.leaves.sort_by_key(|leaf| leaf.origin.to_array());
    grid.tiles.sort_by_key(|tile| tile.origin.to_array());
    grid
}

#[test]
fn what_is_written_is_read() {
    let affine = DMat4::from_cols_array(&[
        0.0, 2.0, 0.0, 0.0, -1.0, 0.0, 0.5, 0.0, 0.0, 0.0, 3.0, 0.0, 7.0, 8.0, 9.0, 1.0,
    ]);
    let uniform = DMat4::from_translation(DVec3::new(1.0, -2.0, 3.0)) * DMat4::from_scale(DVec3::splat(0.1));
    let grids = [("density", affine), ("density", uniform), ("", uniform)]
        .map(|(name, matrix)| sorted(sample_grid(name, matrix)));
    for options in options() {
        let file = File::from_bytes("sample.vdb", to_bytes(&grids, options)).expect("our own file");
        for (grid, name) in grids.iter().zip(["density[0]", "density[1]", "[0]"]) {
            let back = file.read(name).expect("our own grid");
            let expected = Grid { name: name.into(), ..grid.clone() };
            assert_eq!(sorted(back), expected, "{options:?}");
        }
        assert_eq!(file.grids[0].metadata["class"], MetaValue::Text("fog volume".into()));
    }
}

#[test]
fn a_file_appears_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cloud.vdb");
    std::fs::write(&path, b"old").expect("a file");
    let grid = sorted(sample_grid("density", DMat4::IDENTITY));
    write(&path, std::slice::from_ref(&grid), WriteOptions::default()).expect("written");
    assert_eq!(sorted(File::open(&path).expect("a file").read("density").expect("a grid")), grid);
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    let missing = folder.path().join("none/cloud.vdb");
    assert!(matches!(write(&missing, &[grid], WriteOptions::default()), Err(VdbError::Io { .. })));
}

#[test]
fn dense_is_the_tree_with_its_tiles() {
    let grid = sample_grid("density", DMat4::IDENTITY);
    let (min, size) = (IVec3::new(-21, -3, -5), [110, 13, 29]);
    let dense = grid.dense(min, size);
    let mut n_checked = 0;
    for (i, &value) in dense.iter().enumerate() {
        let local = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]].map(|v| v as i32);
        let at = min + IVec3::from_array(local);
        let inside =
            |origin: IVec3, size: i32| (0..3).all(|k| (origin[k]..origin[k] + size).contains(&at[k]));
        let tile = grid.tiles.iter().find(|tile| inside(tile.origin, tile.size)).map(|tile| tile.value);
        let leaf = grid.leaves.iter().find(|leaf| inside(leaf.origin, 8)).map(|leaf| {
            let n = at - leaf.origin;
            leaf.values[(n.x * 64 + n.y * 8 + n.z) as usize]
        });
        n_checked += usize::from(leaf.is_some());
        assert_eq!(value, leaf.or(tile).unwrap_or(2.0), "{at}");
    }
    assert_eq!(n_checked, 9 * 512);
    assert_eq!(grid.dense(IVec3::splat(i32::MAX - 1), [2, 2, 2]), [2.0; 8]);
    assert!(grid.dense(min, [0, 3, 3]).is_empty());
}
