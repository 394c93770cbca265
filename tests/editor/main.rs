//! The editor in a real window: Xvfb for a screen, xdotool for mouse and keys.
//!
//! Skipped aloud where Xvfb, xdotool or an adapter is missing; with `TYNDALL_WINDOW=require` that is a failure.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Ends its program with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A screen of its own: the server chooses the number.
fn screen() -> Option<(Running, String)> {
    let mut server = Command::new("Xvfb");
    server.args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"]);
    let mut server = Running(server.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?);
    let mut number = String::new();
    BufReader::new(server.0.stdout.take()?).read_line(&mut number).ok()?;
    Some((server, format!(":{}", number.trim())))
}

struct Desk {
    _server: Running,
    display: String,
    folder: tempfile::TempDir,
}

impl Desk {
    /// `None`, said aloud, where there is no window to be had.
    fn new() -> Option<Self> {
        let is_required = std::env::var("TYNDALL_WINDOW").is_ok_and(|mode| mode == "require");
        let has_mouse = Command::new("xdotool").arg("version").output().is_ok();
        let has_adapter = !tyndall::gpu::adapters().is_empty();
        match screen().filter(|_| has_mouse && has_adapter) {
            Some((server, display)) => {
                Some(Self { _server: server, display, folder: tempfile::tempdir().unwrap() })
            }
            None if is_required => panic!("Xvfb, xdotool and an adapter are required"),
            None => {
                eprintln!("skipped: no Xvfb, no xdotool or no adapter");
                None
            }
        }
    }

    fn tyndall(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        command.env("DISPLAY", &self.display).env_remove("WAYLAND_DISPLAY");
        command.env("XDG_CONFIG_HOME", self.folder.path().join("config"));
        command.stderr(Stdio::null());
        command
    }

    fn open(&self, path: &Path) -> Running {
        let running = Running(self.tyndall().arg(path).spawn().unwrap());
        // Named once the first frame was drawn.
        self.until("the window", || {
            let found = self.xdotool(&["search", "--name", "steam.json"]);
            !found.trim().is_empty()
        });
        let id = self.xdotool(&["search", "--name", "steam.json"]);
        self.xdotool(&["windowfocus", "--sync", id.lines().last().unwrap_or_default()]);
        running
    }

    fn xdotool(&self, args: &[&str]) -> String {
        let output = Command::new("xdotool").env("DISPLAY", &self.display).args(args).output().unwrap();
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// A drag by steps, as a hand does it.
    fn drag(&self, from: [i32; 2], by: [i32; 2]) {
        let go = |x: i32, y: i32| drop(self.xdotool(&["mousemove", &x.to_string(), &y.to_string()]));
        go(from[0], from[1]);
        std::thread::sleep(Duration::from_millis(300));
        self.xdotool(&["mousedown", "1"]);
        for n in 1..=10 {
            go(from[0] + by[0] * n / 10, from[1] + by[1] * n / 10);
            std::thread::sleep(Duration::from_millis(50));
        }
        self.xdotool(&["mouseup", "1"]);
        std::thread::sleep(Duration::from_millis(500));
    }

    fn until(&self, what: &str, mut is_so: impl FnMut() -> bool) {
        let start = Instant::now();
        while !is_so() {
            assert!(start.elapsed() < Duration::from_secs(120), "{what} did not come");
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    fn new_graph(&self) -> PathBuf {
        let volume = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/steam.vdb");
        let graph = self.folder.path().join("steam.json");
        let args = ["new", "lit", volume.to_str().unwrap(), "-o", graph.to_str().unwrap()];
        assert!(self.tyndall().args(args).status().unwrap().success());
        graph
    }
}

#[test]
fn a_gesture_is_saved_undone_and_found_again() {
    let Some(desk) = Desk::new() else { return };
    let graph = desk.new_graph();
    let text = || std::fs::read_to_string(&graph).unwrap();
    let first = text();
    let window = desk.open(&graph);
    // The picture has to be there before a hand can take hold of it: a drag on nothing changes nothing.
    let mut saved = first.clone();
    desk.until("an orbit that is saved", || {
        desk.drag([500, 260], [120, 20]);
        desk.xdotool(&["key", "ctrl+s"]);
        std::thread::sleep(Duration::from_secs(1));
        saved = text();
        saved != first
    });
    assert!(saved.contains("\"position\""), "{saved}");
    desk.xdotool(&["key", "ctrl+z"]);
    std::thread::sleep(Duration::from_millis(500));
    desk.xdotool(&["key", "ctrl+s"]);
    desk.until("the step back", || text() == first);
    desk.xdotool(&["key", "ctrl+shift+z"]);
    std::thread::sleep(Duration::from_millis(500));
    desk.xdotool(&["key", "ctrl+s"]);
    desk.until("the step again", || text() == saved);
    drop(window);
    // Opened and saved again, nothing is lost and nothing is added.
    let before = std::fs::metadata(&graph).unwrap().modified().unwrap();
    let _window = desk.open(&graph);
    desk.until("the file", || {
        desk.xdotool(&["key", "ctrl+s"]);
        std::thread::sleep(Duration::from_millis(500));
        std::fs::metadata(&graph).unwrap().modified().unwrap() != before
    });
    assert_eq!(text(), saved);
}
