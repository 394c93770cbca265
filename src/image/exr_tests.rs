use ::exr::image::Layer as ExrLayer;
use ::exr::meta::header::{ImageAttributes, LayerAttributes};
use ::exr::prelude::f16;

use super::*;

fn temp(name: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    (dir, path)
}

fn layered() -> Image {
    // Not a multiple of ZIP's 16 rows; values that half floats would lose.
    let (width, height) = (5, 19);
    let values = |n: usize, seed: f32| (0..n).map(|i| (i as f32 * 0.37 + seed).sin() * 1e9).collect();
    let n = width * height;
    let mut image = Image::new(width, height, values(3 * n, 0.0));
    image.insert(ALPHA, 1, values(n, 1.0));
    image.insert(DEPTH, 1, values(n, 2.0));
    image.insert("single", 3, values(3 * n, 3.0));
    image.insert("std_error", 1, values(n, 4.0));
    image.insert("light.sun", 3, values(3 * n, 5.0));
    image
}

/// Channels of 2x2 half floats, each filled with its value, as the bytes of a file.
fn file_of(channels: &[(&str, f32)]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let image = ::exr::image::Image::from_channels((2, 2), any(channels));
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn any(channels: &[(&str, f32)]) -> AnyChannels<FlatSamples> {
    let list = channels
        .iter()
        .map(|(name, value)| AnyChannel::new(*name, FlatSamples::F16(vec![f16::from_f32(*value); 4])));
    AnyChannels::sort(list.collect())
}

fn decoded(bytes: &[u8]) -> Result<Image, ImageError> {
    decode(Path::new("x.exr"), bytes)
}

fn error_of(bytes: &[u8]) -> String {
    let text = decoded(bytes).unwrap_err().to_string();
    assert!(text.contains("x.exr") && !text.contains('\n'), "{text}");
    text
}

#[test]
fn layers_come_back_bit_for_bit() {
    let (_dir, path) = temp("layers.exr");
    let image = layered();
    write(&path, &image).unwrap();
    let back = read(&path).unwrap();
    assert_eq!(back.layers.keys().next().unwrap(), BEAUTY);
    assert_eq!(back, image);
    // The same image, the same bytes.
    let first = std::fs::read(&path).unwrap();
    write(&path, &image).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), first);
}

#[test]
fn special_layers_have_their_channels() {
    let (_dir, path) = temp("names.exr");
    write(&path, &layered()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), true).unwrap();
    let header = &meta.headers[0];
    let names: Vec<String> = header.channels.list.iter().map(|c| c.name.to_string()).collect();
    let expected = [
        "A",
        "B",
        "G",
        "R",
        "Z",
        "light.sun.B",
        "light.sun.G",
        "light.sun.R",
        "single.B",
        "single.G",
        "single.R",
        "std_error.Y",
    ];
    assert_eq!(names, expected);
    assert_eq!(header.compression, Compression::ZIP16);
}

#[test]
fn values_that_are_not_finite_come_back() {
    let (_dir, path) = temp("spicy.exr");
    let spicy = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-45, -0.0, f32::MAX];
    write(&path, &Image::new(2, 1, spicy.to_vec())).unwrap();
    let back = read(&path).unwrap();
    assert_eq!(back.beauty().len(), 6);
    for (a, b) in back.beauty().iter().zip(spicy) {
        assert_eq!(a.to_bits(), b.to_bits());
    }
}

#[test]
fn names_that_are_no_channel_are_refused() {
    let (_dir, path) = temp("bad.exr");
    for name in ["", "a b", "größe", &"n".repeat(201)] {
        let mut image = Image::new(1, 1, vec![0.0; 3]);
        image.insert(name, 1, vec![0.0]);
        let error = write(&path, &image).unwrap_err();
        assert!(matches!(error, ImageError::LayerName { .. }), "{error}");
        assert!(!path.exists());
    }
}

#[test]
fn channel_sets_of_other_programs() {
    let rgba = decoded(&file_of(&[("R", 1.0), ("G", 2.0), ("B", 3.0), ("A", 0.5)])).unwrap();
    assert_eq!(rgba.pixels(), [[1.0, 2.0, 3.0]; 4]);
    assert_eq!(rgba.layers[ALPHA].data, [0.5; 4]);
    for grey in ["Y", "density"] {
        let grey = decoded(&file_of(&[(grey, 0.25)])).unwrap();
        assert_eq!(grey.pixels(), [[0.25; 3]; 4]);
        assert_eq!(grey.layers.len(), 1);
    }
    let odd = [("Y", 1.0), ("Z", 7.0), ("N.X", 2.0), ("N.Y", 3.0), ("d.R", 4.0), ("id", 5.0)];
    let odd = decoded(&file_of(&odd)).unwrap();
    let names: Vec<&str> = odd.layers.keys().map(String::as_str).collect();
    assert_eq!(names, ["beauty", "N.X", "N", "depth", "d.R", "id"]);
    assert_eq!(odd.layers["d.R"].data, [4.0; 4]);
    assert!(error_of(&file_of(&[("A", 1.0)])).contains("only the channels A"));
    assert!(error_of(&file_of(&[("R", 1.0), ("G", 1.0)])).contains("G R"));
    assert!(error_of(&file_of(&[("Y", 1.0), ("RY", 0.0), ("BY", 0.0)])).contains("RY"));
    // "N.Y" and "N" would both be the layer N.
    assert!(error_of(&file_of(&[("Y", 1.0), ("N", 1.0), ("N.Y", 1.0)])).contains("twice"));
}

#[test]
fn parts_become_layers() {
    let part = |name: &str, value: f32| {
        let channels = any(&[("R", value), ("G", value), ("B", value)]);
        let attributes = LayerAttributes::named(name);
        ExrLayer::new((2, 2), attributes, Encoding::SMALL_LOSSLESS, channels)
    };
    let attributes = ImageAttributes::with_size((2, 2));
    let parts = vec![part("combined", 1.0), part("diffuse", 2.0)];
    let mut bytes = Cursor::new(Vec::new());
    let file = ::exr::image::Image::from_layers(attributes, parts);
    file.write().to_buffered(&mut bytes).unwrap();
    let image = decoded(bytes.get_ref()).unwrap();
    assert_eq!(image.pixels()[0], [1.0; 3]);
    assert_eq!(image.layers["diffuse"].data, [2.0; 12]);
}

/// A file whose data window is 2x2 at `data` and whose display window is 3x2 at `display`;
/// its four pixels are 1 2 3 4.
fn windowed(data: (i32, i32), display: (i32, i32)) -> Vec<u8> {
    let samples = FlatSamples::F32(vec![1.0, 2.0, 3.0, 4.0]);
    let channels = AnyChannels::sort([AnyChannel::new("Y", samples)].into_iter().collect());
    let mut image = ::exr::image::Image::from_channels((2, 2), channels);
    image.layer_data.attributes.layer_position = data.into();
    image.attributes.display_window = IntegerBounds::new(display, (3, 2));
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn the_display_window_is_the_picture() {
    let red = |bytes: &[u8]| {
        let image = decoded(bytes).unwrap();
        assert_eq!((image.width, image.height), (3, 2));
        image.pixels().iter().map(|p| p[0]).collect::<Vec<_>>()
    };
    assert_eq!(red(&windowed((0, 0), (0, 0))), [1.0, 2.0, 0.0, 3.0, 4.0, 0.0]);
    assert_eq!(red(&windowed((-5, 7), (-6, 7))), [0.0, 1.0, 2.0, 0.0, 3.0, 4.0]);
    // Overscan to the left and above is cut.
    assert_eq!(red(&windowed((-1, -1), (0, 0))), [4.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(error_of(&windowed((3, 0), (0, 0))).contains("outside the display window"));
}

#[test]
fn truncated_and_flipped_files_never_panic() {
    let (_dir, path) = temp("damaged.exr");
    write(&path, &layered()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    for end in (0..bytes.len()).step_by(7) {
        assert!(decoded(&bytes[..end]).is_err(), "{end}");
    }
    // Every byte of the header and every 41st of the rest, turned around.
    for at in (0..1500).chain((1500..bytes.len()).step_by(41)) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0xff;
        let _finishes = decoded(&damaged);
    }
}

// One large size in a file of some hundred bytes: the data window's right edge is made 16383.
#[test]
fn absurd_sizes_cost_nothing() {
    let mut bytes = file_of(&[("Y", 1.0)]);
    let name = b"dataWindow\0box2i\0";
    let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
    bytes[at + 8..at + 16].copy_from_slice(&[0xff, 0x3f, 0, 0, 0xff, 0x3f, 0, 0]);
    assert!(error_of(&bytes).contains("268435456 samples announced"));
    bytes[at + 8..at + 12].copy_from_slice(&[0, 0, 1, 0]);
    assert!(error_of(&bytes).contains("at most"));
}

#[test]
fn a_picture_written_by_openexr_itself() {
    let Some(truth) = crate::shared_dir().map(|d| d.join("truth")) else {
        eprintln!("skipped: no shared files");
        return;
    };
    let mut n_files = 0;
    for entry in std::fs::read_dir(truth).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "exr") {
            let image = read(&path).unwrap();
            assert_eq!(image.layers.len(), 1, "{}", path.display());
            assert!(image.beauty().iter().all(|v| v.is_finite()));
            let (_dir, copy) = temp("copy.exr");
            write(&copy, &image).unwrap();
            assert_eq!(read(&copy).unwrap(), image);
            n_files += 1;
        }
    }
    assert!(n_files > 0);
}
