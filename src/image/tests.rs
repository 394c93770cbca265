use super::*;

#[test]
fn files_are_known_by_content_not_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("map.txt");
    let image = Image::new(2, 1, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5e4]);
    exr::write(&path, &image).unwrap();
    assert_eq!(read(&path).unwrap(), image);
    assert_eq!(read_environment(&path).unwrap(), image);
    png::write(&path, &image).unwrap();
    assert_eq!(read(&path).unwrap().width, 2);
    assert!(read_environment(&path).is_err());
    std::fs::write(&path, "P6 1 1").unwrap();
    let error = read(&path).unwrap_err().to_string();
    assert!(error.contains("map.txt") && error.contains("50 36 20 31"), "{error}");
    let error = read(&dir.path().join("none.exr")).unwrap_err();
    assert!(matches!(error, ImageError::Read { .. }), "{error}");
}

#[test]
fn environments_name_the_bad_texel() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("map.exr");
    for bad in [-1e-3, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut rgb = vec![1.0; 3 * 4 * 3];
        rgb[(2 * 4 + 3) * 3 + 1] = bad;
        exr::write(&path, &Image::new(4, 3, rgb)).unwrap();
        let error = read_environment(&path).unwrap_err().to_string();
        assert!(error.contains("texel (3, 2) has G = "), "{error}");
        assert!(error.contains("map.exr"), "{error}");
        // A picture may hold such values: `compare` counts them.
        assert!(read(&path).is_ok());
    }
}

#[test]
fn environments_keep_beauty_alone() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("map.exr");
    let mut image = Image::new(1, 1, vec![1.0; 3]);
    image.insert(ALPHA, 1, vec![f32::NAN]);
    exr::write(&path, &image).unwrap();
    assert_eq!(read_environment(&path).unwrap().layers.len(), 1);
}

#[test]
fn endings_choose_the_format() {
    let dir = tempfile::tempdir().unwrap();
    let image = Image::new(1, 1, vec![1.0; 3]);
    for (name, format) in [("a.exr", Format::Exr), ("a.b.PNG", Format::Png)] {
        let path = dir.path().join(name);
        assert_eq!(Format::of(&path).unwrap(), format);
        write(&path, &image).unwrap();
        assert_eq!(png::has_signature(&std::fs::read(&path).unwrap()), format == Format::Png);
    }
    for name in ["a", "a.jpg", ".png", "exr"] {
        let error = write(&dir.path().join(name), &image).unwrap_err().to_string();
        assert!(error.ends_with("are written as .exr or .png; change the ending"), "{error}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 2);
}

#[test]
fn real_environment_maps() {
    let Some(shared) = crate::shared_dir() else {
        eprintln!("skipped: no shared files");
        return;
    };
    let mut n_maps = 0;
    for entry in std::fs::read_dir(shared.join("env")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "hdr") {
            let map = read_environment(&path).unwrap();
            assert_eq!((map.width, map.height), (1024, 512), "{}", path.display());
            assert!(map.beauty().iter().any(|v| *v > 0.0));
            n_maps += 1;
        }
    }
    assert!(n_maps > 0);
    // Half-float values that OpenEXR's own library reads: 0.079956055 is the least of B.
    let sky = read_environment(&shared.join("samples/sky_sun.exr")).unwrap();
    assert_eq!((sky.width, sky.height), (2048, 1024));
    let channel = |c: usize| sky.pixels().iter().map(move |p| p[c]);
    assert_eq!(channel(2).fold(f32::MAX, f32::min), 0.079_956_055);
    assert_eq!(channel(0).fold(0.0, f32::max), 99_968.0);
}
