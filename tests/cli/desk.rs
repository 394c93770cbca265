//! A folder to try the program in, and what came of it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glam::{DMat4, DVec3, IVec3};
use serde_json::Value as Json;
use tyndall::volume::grid::Grid;
use tyndall::volume::vdb;

pub const GRAPH: &str = r#"{ "tyndall": 1,
  "nodes": {
    "ball": { "type": "shape", "resolution": 16 },
    "medium": { "type": "medium", "density_scale": 2, "albedo": 0.9, "g": 0.5 },
    "sun": { "type": "sun" },
    "split": { "type": "light_decomposition" },
    "beams": { "type": "principal_propagation" },
    "camera": { "type": "camera", "width": 32, "height": 32 },
    "march": { "type": "raymarch" },
    "save": { "type": "save_image", "path": "out/ball.exr" }
  },
  "wires": [
    "ball.volume -> medium.volume", "sun.light -> split.lights",
    "medium.medium -> beams.medium", "split.ordinates -> beams.ordinates",
    "medium.medium -> march.medium", "beams.beams -> march.beams",
    "camera.camera -> march.camera", "march.image -> save.image"
  ] }"#;
pub const NODES: &str = "nodes are ball, medium, sun, split, beams, camera, march, save";

/// A folder with the graph `g.json`, in which the program runs.
pub struct Desk(tempfile::TempDir);

impl Desk {
    pub fn new() -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        desk.write("g.json", GRAPH);
        desk
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        fs::write(self.path(name), bytes).unwrap();
    }

    /// The graph with one text replaced, which must be there.
    pub fn write_graph(&self, name: &str, from: &str, to: &str) {
        assert!(GRAPH.contains(from), "{from}");
        self.write(name, GRAPH.replace(from, to));
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        // Mesa complains on stderr where this is not set.
        command.args(args).current_dir(self.0.path()).env("XDG_RUNTIME_DIR", self.0.path());
        // No test opens a window.
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command
    }

    pub fn run(&self, args: &[&str]) -> Ran {
        Ran::of(self.command(args).output().unwrap())
    }

    /// Without any driver: what is refused here is refused before a device is opened.
    pub fn run_blind(&self, args: &[&str]) -> Ran {
        let mut command = self.command(args);
        for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            command.env(name, "/nonexistent");
        }
        Ran::of(command.output().unwrap())
    }

    /// All files below the folder, sorted.
    pub fn files(&self) -> Vec<String> {
        fn walk(folder: &Path, files: &mut Vec<PathBuf>) {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() { walk(&path, files) } else { files.push(path) }
            }
        }
        let mut files = Vec::new();
        walk(self.0.path(), &mut files);
        let relative = |path: &PathBuf| path.strip_prefix(self.0.path()).unwrap().display().to_string();
        let mut names: Vec<String> = files.iter().map(relative).collect();
        names.sort();
        names
    }

    pub fn json(&self, name: &str) -> Json {
        serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap()
    }
}

pub struct Ran {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Ran {
    pub fn of(output: Output) -> Self {
        let [stdout, stderr] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        Self { code: output.status.code(), stdout, stderr }
    }

    #[track_caller]
    pub fn done(self) -> String {
        assert_eq!((self.code, self.stderr.as_str()), (Some(0), ""), "{}", self.stdout);
        assert!(!self.stdout.contains('\u{1b}'), "colors in a pipe: {}", self.stdout);
        self.stdout
    }

    #[track_caller]
    pub fn refused(self, stderr: &str) {
        assert_eq!((self.code, self.stderr.as_str()), (Some(2), stderr), "{}", self.stdout);
        assert_eq!(self.stdout, "");
    }

    pub fn json(self) -> Json {
        serde_json::from_str(&self.done()).unwrap()
    }
}

/// Whether pictures can be rendered here.
pub fn has_adapter() -> bool {
    crate::common::session().is_some()
}

/// A file with one grid, `density`: a cube of 1.6 m.
pub fn small_vdb() -> Vec<u8> {
    let world_from_index = DMat4::from_translation(DVec3::splat(-0.7)) * DMat4::from_scale(DVec3::splat(0.2));
    let grid = Grid::from_dense("density", 0.0, world_from_index, IVec3::ZERO, [8; 3], &[1.0; 512]);
    vdb::to_bytes(&[grid], vdb::WriteOptions::default())
}

/// What to replace for another volume.
pub const BALL: &str = r#""type": "shape", "resolution": 16"#;

/// Frames 1, 2, 4 of a sequence, and a damaged 5.
pub fn sequence() -> Desk {
    let desk = Desk::new();
    desk.write_graph("g.json", BALL, r#""type": "load_vdb", "path": "cache""#);
    for frame in [1, 2, 4] {
        desk.write(&format!("cache/a_{frame:04}.vdb"), small_vdb());
    }
    desk.write("cache/a_0005.vdb", &small_vdb()[..100]);
    desk
}
