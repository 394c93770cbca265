//! Files of versions 218 to 221, which no library in use writes; OpenVDB 10.0.1 has read the bytes made here.

use super::*;

struct Bytes(Vec<u8>);

impl Bytes {
    fn u32s(&mut self, values: &[u32]) {
        self.0.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }

    fn f64s(&mut self, values: &[f64]) {
        self.0.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }

    fn string(&mut self, text: &str) {
        self.u32s(&[text.len() as u32]);
        self.0.extend(text.as_bytes());
    }

    /// A bit mask with these bits set.
    fn mask(&mut self, n_bits: usize, bits: &[usize]) {
        let mut mask = vec![0; n_bits / 8];
        for bit in bits {
            mask[bit / 8] |= 1 << (bit % 8);
        }
        self.0.extend(mask);
    }

    fn zipped(&mut self, values: &[f32]) {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let mut zipped = Vec::new();
        let mut encoder = flate2::read::ZlibEncoder::new(&bytes[..], flate2::Compression::default());
        encoder.read_to_end(&mut zipped).expect("reading from memory");
        self.0.extend((zipped.len() as i64).to_le_bytes());
        self.0.extend(zipped);
    }
}

fn leaf_value(n: usize) -> f32 {
    (n % 13) as f32
}

/// A leaf at (0, 0, 0) with two buffers, an active tile of 8³ beside it and one of 128³; scale 0.5.
fn legacy_file(version: u32) -> Vec<u8> {
    let mut out = Bytes(b" BDV\0\0\0\0".to_vec());
    out.u32s(&[version, 1, 1]);
    out.0.push(1);
    if version >= 220 {
        // Zipped.
        out.0.push(1);
    }
    out.0.extend(b"00000000-0000-0000-0000-000000000000");
    out.u32s(&[0, 1]);
    out.string("density");
    out.string("Tree_float_5_4_3");
    out.string("");
    let offsets_at = out.0.len();
    out.0.extend([0; 24]);
    let grid_at = out.0.len();
    // No metadata.
    out.u32s(&[0]);
    if version < 219 {
        out.string("LinearTransform");
        out.u32s(&[0; 6]);
        let scale = |scale| DMat4::from_scale(DVec3::splat(scale)).to_cols_array();
        for matrix in [scale(5.0), scale(0.2), scale(0.1), scale(10.0)] {
            out.f64s(&matrix);
        }
    } else {
        out.string("UniformScaleMap");
        for value in [0.5, 0.5, 2.0, 4.0, 1.0] {
            out.f64s(&[value; 3]);
        }
    }
    // One buffer, background 0, no tiles, one child at the origin.
    out.u32s(&[1, 0, 0, 1, 0, 0, 0]);
    // Only slots that are no child have values: one less than the slots.
    for (n_slots, value) in [(32768, 4.0), (4096, 3.0)] {
        out.mask(n_slots, &[0]);
        out.mask(n_slots, &[1]);
        let mut values = vec![0.0; n_slots - 1];
        values[0] = value;
        out.zipped(&values);
    }
    let active: Vec<usize> = (0..512).step_by(3).collect();
    out.mask(512, &active);
    let buffers_at = out.0.len();
    out.mask(512, &active);
    out.u32s(&[0; 3]);
    out.0.push(2);
    let values: Vec<f32> = (0..512).map(leaf_value).collect();
    out.zipped(&values);
    out.zipped(&[9.0; 512]);
    for (i, at) in [grid_at, buffers_at, out.0.len()].into_iter().enumerate() {
        out.0[offsets_at + 8 * i..][..8].copy_from_slice(&(at as u64).to_le_bytes());
    }
    out.0
}

#[test]
fn versions_before_222() {
    for version in 218..222 {
        let bytes = legacy_file(version);
        let file = File::from_bytes("old.vdb", bytes.clone()).expect("a legacy file");
        assert_eq!(file.version, version);
        let grid = file.read("density").expect("a legacy grid");
        assert!((grid.world_from_index.x_axis.x - 0.5).abs() < 1e-15, "{}", grid.world_from_index);
        let tile = |z, size, value| Tile { origin: IVec3::new(0, 0, z), size, value, active: true };
        assert_eq!(grid.tiles, [tile(128, 128, 4.0), tile(8, 8, 3.0)]);
        assert_eq!(grid.leaves.len(), 1);
        assert_eq!(*grid.leaves[0].values, std::array::from_fn(leaf_value));
        assert_eq!(grid.active_voxels(), 171 + 512 + 128 * 128 * 128);
        for n in (0..bytes.len()).step_by(7) {
            let err = File::from_bytes("cut.vdb", bytes[..n].to_vec()).and_then(|file| file.read("density"));
            assert!(err.is_err(), "{version} cut at {n}");
        }
    }
}

#[test]
fn unknown_versions_are_named() {
    for version in [0, 217, 226, u32::MAX] {
        let mut bytes = legacy_file(221);
        bytes[8..12].copy_from_slice(&version.to_le_bytes());
        let err = File::from_bytes("new.vdb", bytes).expect_err("an unknown version").to_string();
        assert!(err.contains(&format!("file version {version}, read are 218 to 225")), "{err}");
    }
}
