//! Damaged files: each truncation, each changed byte, and the files that OpenImageIO tests with.

use super::*;

#[test]
fn damaged_files_of_openimageio() {
    let Some(folder) = crate::shared_dir() else {
        eprintln!("skipped: no shared files");
        return;
    };
    let mut n_files = 0;
    for entry in std::fs::read_dir(folder.join("volumes/oiio_damaged")).expect("a folder") {
        let path = entry.expect("an entry").path();
        n_files += 1;
        match File::open(&path) {
            Err(err) => assert!(
                path.to_string_lossy().contains("truncated") && err.to_string().contains("cut off"),
                "{err}"
            ),
            Ok(file) => {
                // Their bounding boxes lie, their trees are empty.
                let grid = file.read(&file.grids[0].name).expect("an empty tree");
                assert_eq!(
                    (grid.active_bbox(), grid.active_voxels(), grid.leaves.len()),
                    (None, 0, 0),
                    "{}",
                    path.display()
                );
            }
        }
    }
    assert_eq!(n_files, 14);
}

/// A small file for damage: one leaf, zipped.
fn small_file(options: WriteOptions) -> Vec<u8> {
    let values: Vec<f32> = (0..512).map(|n| (n % 7) as f32).collect();
    to_bytes(&[Grid::from_dense("density", 0.0, DMat4::IDENTITY, IVec3::ZERO, [8; 3], &values)], options)
}

#[test]
fn each_truncation_is_an_error() {
    for options in options() {
        let bytes = small_file(options);
        // The long runs of an inner node's empty masks are all alike: every byte of head and tail, some between.
        let lengths = (0..bytes.len()).filter(|&n| n < 600 || n > bytes.len() - 600 || n % 61 == 0);
        for n in lengths {
            let err = File::from_bytes("cut.vdb", bytes[..n].to_vec())
                .and_then(|file| file.read("density"))
                .expect_err("cut");
            assert!(err.to_string().contains("at byte"), "{n}: {err}");
        }
    }
}

#[test]
fn each_changed_byte_gives_data_or_an_error() {
    for options in options() {
        let bytes = small_file(options);
        // Every byte of head and tail in the smallest file, less of the others and of the runs of empty masks.
        let is_smallest = options.half && options.compression == WriteCompression::Zip;
        let stride = if is_smallest { 1 } else { 5 };
        let at_ends = |n: usize| (n < 600 || n + 700 > bytes.len()) && n.is_multiple_of(stride);
        let places: Vec<usize> = (0..bytes.len()).filter(|&n| at_ends(n) || n % 197 == 0).collect();
        places.par_iter().for_each(|&i| {
            for value in [0x00, 0x7f, 0xff, bytes[i] ^ 0x01] {
                let mut damaged = bytes.clone();
                damaged[i] = value;
                let Ok(file) = File::from_bytes("damaged.vdb", damaged) else {
                    continue;
                };
                assert!(file.grids.len() <= 1);
                // A leaf of 2048 bytes stands for at least 129 bytes of the file, a tile of 24 for 2 bits of a mask.
                if let Ok(grid) = file.read("density") {
                    assert!(grid.bytes() <= 100 * bytes.len() as u64, "{i}: {}", grid.bytes());
                }
            }
        });
    }
}
