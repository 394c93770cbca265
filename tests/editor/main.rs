//! The editor in a real window: Xvfb for a screen, xdotool for mouse and keys, a drop by its protocol.
//!
//! What is clicked on is found by its color on the screen, which the themes in `src/editor` say. Skipped aloud where
//! Xvfb, xdotool or an adapter is missing; with `TYNDALL_WINDOW=require` that is a failure.

#![cfg(target_os = "linux")]

mod screen;
mod xdnd;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use screen::{Screen, Spot};
use serde_json::Value as Json;

/// Ends its program with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A screen of its own, whose pixels are written to this folder: the server chooses the number.
fn screen(folder: &Path) -> Option<(Running, String)> {
    let mut server = Command::new("Xvfb");
    // Without -noreset it begins anew whenever its last client leaves, and refuses who comes meanwhile.
    server
        .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-noreset", "-fbdir"])
        .arg(folder);
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
        let folder = tempfile::tempdir().unwrap();
        match screen(folder.path()).filter(|_| has_mouse && has_adapter) {
            Some((server, display)) => Some(Self { _server: server, display, folder }),
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
        command.env("XDG_STATE_HOME", self.folder.path().join("state"));
        command.stderr(Stdio::null());
        command
    }

    fn open(&self, path: &Path) -> Running {
        let running = Running(self.tyndall().arg(path).spawn().unwrap());
        let id = self.window(&path.file_name().unwrap().to_string_lossy());
        self.xdotool(&["windowfocus", "--sync", &id]);
        running
    }

    /// The window of this name, once there is one: it is named when its first frame was drawn.
    fn window(&self, name: &str) -> String {
        let mut id = String::new();
        self.until(&format!("the window '{name}'"), || {
            let found = self.xdotool(&["search", "--name", name]);
            id = found.lines().last().unwrap_or_default().to_owned();
            !id.is_empty()
        });
        id
    }

    fn screen(&self) -> Screen {
        Screen::read(&self.folder.path().join("Xvfb_screen0"))
    }

    fn key(&self, key: &str) {
        self.xdotool(&["key", key]);
        std::thread::sleep(Duration::from_millis(500));
    }

    fn hover(&self, [x, y]: [i32; 2]) {
        self.xdotool(&["mousemove", &x.to_string(), &y.to_string()]);
        std::thread::sleep(Duration::from_millis(500));
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
        // A window that computes draws few frames; the press has to be in one before the move.
        std::thread::sleep(Duration::from_millis(300));
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

/// Of the dark theme: behind the nodes, around a selected node, the headers of lights.
const BACKGROUND: u32 = 0x0017_191d;
const SELECTED: u32 = 0x00ff_b454;
const LIGHT: u32 = 0x009c_6810;
/// Behind what is open over the rest.
const POPUP: u32 = 0x0022_2429;
/// What is filled of a slider.
const FILLED: u32 = 0x0045_6891;

/// A part of the screen that is a node: the largest that is outlined as selected, or in which a color is.
fn largest(spots: Vec<Spot>) -> Option<Spot> {
    spots.into_iter().max_by_key(|spot| spot.size()[0] * spot.size()[1])
}

/// The headers of the lights' nodes, but for one.
fn lights<'a>(screen: &Screen, but: &'a Spot) -> impl Iterator<Item = Spot> + use<'a> {
    let headers = screen.spots(LIGHT).into_iter();
    headers.filter(|spot| spot.size()[0] > 30 && !but.contains(spot.center()))
}

/// Draws a wire from the new node, which is selected, to the split.
fn wire_to_split(desk: &Desk) {
    let screen = desk.screen();
    let new = largest(screen.spots(SELECTED)).expect("the new node is selected");
    // A wire that ends on a node finds the port that fits. Of the nodes with a light's header the split is the
    // rightmost.
    let split = lights(&screen, &new).max_by_key(|spot| spot.min[0]).expect("the split");
    // Its only row holds its output: header 42, pad 5 and half a row of 20, of 92 points in all.
    let from = [new.max[0] - 2, new.min[1] + (new.size()[1] * 57 + 46) / 92];
    let [to_x, to_y] = split.center();
    desk.drag(from, [to_x - from[0], to_y - from[1]]);
}

/// Drags the handle of the first slider of the inspector, which is at the end of what is filled.
fn slide(desk: &Desk) {
    let screen = desk.screen();
    let half = screen.size[0] as i32 / 2;
    let filled = screen.spots(FILLED).into_iter().filter(|spot| spot.min[0] > half && spot.size()[1] < 12);
    let first = filled.min_by_key(|spot| spot.min[1]).expect("a slider");
    desk.drag([first.max[0], first.center()[1]], [40, 0]);
}

#[test]
fn a_volume_is_dropped_and_its_graph_changed_saved_and_opened_again() {
    let Some(desk) = Desk::new() else { return };
    let first = desk.new_graph();
    let window = desk.open(&first);

    // Dropped, a volume has a graph of its own, which is saved beside it.
    let volume = desk.folder.path().join("dropped.vdb");
    std::fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("data/steam.vdb"), &volume).unwrap();
    let id: u32 = desk.window("steam.json").parse().unwrap();
    xdnd::drop_file(&desk.display, id, &volume);
    desk.window("untitled");
    let graph = desk.folder.path().join("graph.json");
    desk.until("the dialog that saves", || {
        desk.key("ctrl+s");
        std::thread::sleep(Duration::from_secs(1));
        desk.key("Return");
        graph.exists()
    });
    let read = || serde_json::from_str::<Json>(&std::fs::read_to_string(&graph).unwrap()).unwrap();
    let save = |what: &str, is_so: &dyn Fn(&Json) -> bool| {
        desk.until(what, || {
            desk.key("ctrl+s");
            is_so(&read())
        });
    };
    let lit = read();
    assert!(lit["nodes"]["volume"]["path"].as_str().unwrap().ends_with("dropped.vdb"), "{lit}");
    let path = lit["nodes"]["volume"]["path"].as_str().unwrap();
    assert!(graph.parent().unwrap().join(path).exists());

    // A node at the pointer, where there is room for it; from farther away there is more.
    let size = [150, 90];
    let room = || desk.screen().room(BACKGROUND, size);
    let mut place = room();
    desk.until("room for a node", || {
        if place.is_none() {
            let canvas = largest(desk.screen().spots(BACKGROUND)).unwrap();
            desk.hover(canvas.center());
            desk.xdotool(&["click", "5"]);
            std::thread::sleep(Duration::from_secs(1));
            place = room();
        }
        place.is_some()
    });
    let is_open = || desk.screen().spots(POPUP).iter().any(|spot| spot.size()[0] > 250);
    desk.hover(place.unwrap());
    // Once: in an open search the key leaves its field.
    desk.key("Tab");
    desk.until("the search", is_open);
    desk.xdotool(&["type", "sun"]);
    std::thread::sleep(Duration::from_secs(2));
    desk.key("Return");
    desk.until("the end of the search", || !is_open());
    save("the new node", &|graph| graph["nodes"]["sun_2"]["type"] == "sun");

    // Again where a picture that comes makes its node larger, and the rest moves.
    desk.until("the wire", || {
        wire_to_split(&desk);
        desk.key("ctrl+s");
        let graph = read();
        let wires = graph["wires"].as_array().unwrap();
        wires.iter().any(|wire| wire == "sun_2.light -> split.lights")
    });
    let wired = read();

    // The slider of the first sun, the topmost light; the new one's is at its least, where nothing is filled.
    let screen = desk.screen();
    let new = largest(screen.spots(SELECTED)).expect("the new node is selected");
    let sun = lights(&screen, &new).min_by_key(|spot| spot.min[1]).expect("the first sun");
    desk.hover(sun.center());
    desk.xdotool(&["click", "1"]);
    std::thread::sleep(Duration::from_secs(1));
    desk.until("the slider", || {
        slide(&desk);
        desk.key("ctrl+s");
        read()["nodes"]["sun"] != wired["nodes"]["sun"]
    });
    let slid = read();
    assert_eq!(slid["wires"], wired["wires"]);
    desk.key("ctrl+z");
    save("the step back", &|graph| *graph == wired);

    // Opened and saved again, nothing is lost and nothing is added.
    let text = || std::fs::read(&graph).unwrap();
    let before = (text(), std::fs::metadata(&graph).unwrap().modified().unwrap());
    drop(window);
    let _window = desk.open(&graph);
    desk.until("the file", || {
        desk.key("ctrl+s");
        std::fs::metadata(&graph).unwrap().modified().unwrap() != before.1
    });
    assert_eq!(text(), before.0);
}
