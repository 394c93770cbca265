//! What the window costs: `cargo bench --bench editor -- [GRAPH or VDB]`
//!
//! Prints the CPU time of a frame with 500 nodes on the screen (pointer moving, nothing solved); then, where
//! there is a display, opens the window on the graph, and prints when the first and the whole picture came, how many
//! came a second while a hand orbited, and the times between two frames of a window that draws without pause, while
//! it orbits and while the whole picture is made again. Timings belong here, never into tests.

use std::path::Path;
use std::time::{Duration, Instant};

use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, Rect, Ui};
use tyndall::editor::{App, Project, project_of};
use tyndall::gpu::AdapterChoice;
use tyndall::graph::Document;

fn main() -> anyhow::Result<()> {
    let graph = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    frames_of_500_nodes()?;
    if std::env::var_os("DISPLAY").is_none() && std::env::var_os("WAYLAND_DISPLAY").is_none() {
        println!("no display: the window was not measured");
        return Ok(());
    }
    watch(Path::new(&graph.unwrap_or_else(|| "data/cumulus.vdb".to_owned())))
}

const N_FRAMES: usize = 210;
const N_FIRST: usize = 10;

/// Frames of a window without a device, so that drawing nodes is all that happens.
fn frames_of_500_nodes() -> anyhow::Result<()> {
    let preset = Document::load(Path::new("graphs/cumulus.json"))?;
    let mut document = preset.clone();
    let mut part = 0;
    while document.nodes.len() + preset.nodes.len() <= 500 {
        part += 1;
        document.paste(&preset, [f64::from(part % 7) * 1500.0, f64::from(part / 7) * 700.0]);
    }
    let n_nodes = document.nodes.len();
    let context = egui::Context::default();
    context.enable_accesskit();
    let adapter = AdapterChoice::Named("no such adapter".to_owned());
    let mut app = App::new(&context, Some(Project::new(document)), &adapter, None);
    let (mut drawing, mut tessellating) = (Vec::new(), Vec::new());
    for n in 0..N_FRAMES {
        let at = Pos2::new(300.0 + 5.0 * n as f32, 640.0);
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(1280.0, 800.0))),
            time: Some(n as f64 / 60.0),
            events: vec![Event::PointerMoved(at)],
            ..RawInput::default()
        };
        let start = cpu_ms()?;
        let output = context.run_ui(input, |ui| {
            eframe::App::ui(&mut app, ui, &mut eframe::Frame::_new_kittest());
        });
        drawing.push(cpu_ms()? - start);
        let start = cpu_ms()?;
        context.tessellate(output.shapes, 1.0);
        tessellating.push(cpu_ms()? - start);
    }
    // The first frames lay out texts that later ones remember. The clock of a thread steps by 4 ms: a mean.
    let mean = |times: &[f64]| times.iter().skip(N_FIRST).sum::<f64>() / (N_FRAMES - N_FIRST) as f64;
    println!(
        "{n_nodes} nodes: CPU time of a frame {:.1} ms, to tessellate it {:.1} ms",
        mean(&drawing),
        mean(&tessellating)
    );
    Ok(())
}

/// What this thread used of a core, whatever else the machine does.
fn cpu_ms() -> anyhow::Result<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat")?;
    let ns: f64 = text.split(' ').next().unwrap_or_default().parse()?;
    Ok(ns * 1e-6)
}

fn spread(times: &mut [f64]) -> String {
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times.get(((times.len() - 1) as f64 * share) as usize).copied().unwrap_or(f64::NAN);
    format!("{:.1} ms (99 %: {:.1}, longest {:.1})", at(0.5), at(0.99), at(1.0))
}

/// How long the hand orbits.
const ORBIT: Duration = Duration::from_secs(8);
/// A point of the viewport in a window of 1280 x 800.
const HELD: Pos2 = Pos2::new(450.0, 230.0);

/// What happens to the window.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    /// Nothing; it draws when it has something to show.
    Opens,
    /// A hand moves in each frame, since a moment and a count of pictures.
    Orbits(Instant, u64),
    /// The hand is up; it draws without pause while the whole picture is made.
    Solves,
}

/// The window, and what was seen of it.
struct Watched {
    app: App,
    started: Instant,
    part: Part,
    has_picture: bool,
    last_frame: Option<Instant>,
    gaps_ms: Vec<f64>,
}

fn watch(path: &Path) -> anyhow::Result<()> {
    println!("{}", path.display());
    let project = project_of(path)?;
    let viewport = egui::ViewportBuilder::default().with_inner_size([1280.0, 800.0]);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let create: eframe::AppCreator = Box::new(move |context| {
        let started = Instant::now();
        let app = App::new(&context.egui_ctx, Some(project), &AdapterChoice::Auto, None);
        let part = Part::Opens;
        Ok(Box::new(Watched {
            app,
            started,
            part,
            has_picture: false,
            last_frame: None,
            gaps_ms: Vec::new(),
        }))
    });
    eframe::run_native("tyndall", options, create).map_err(|error| anyhow::anyhow!("no window: {error}"))
}

impl Watched {
    fn say_gaps(&mut self) {
        println!("    frames of the window: {}", spread(&mut std::mem::take(&mut self.gaps_ms)));
    }

    fn button(pressed: bool) -> Event {
        Event::PointerButton {
            pos: HELD,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }
}

impl eframe::App for Watched {
    fn raw_input_hook(&mut self, _: &egui::Context, input: &mut RawInput) {
        input.focused = true;
        let seen = self.app.pictures_seen();
        match self.part {
            Part::Opens if seen.is_whole => {
                self.part = Part::Orbits(Instant::now(), seen.count);
                self.gaps_ms.clear();
                input.events.extend([Event::PointerMoved(HELD), Self::button(true)]);
            }
            Part::Orbits(start, before) if start.elapsed() > ORBIT => {
                let rate = (seen.count - before) as f64 / start.elapsed().as_secs_f64();
                println!("  orbiting: {rate:.1} pictures a second");
                self.say_gaps();
                self.part = Part::Solves;
                input.events.push(Self::button(false));
            }
            Part::Orbits(start, _) => {
                let sine = start.elapsed().as_secs_f32().sin();
                input.events.push(Event::PointerMoved(HELD + 120.0 * sine * egui::vec2(1.0, 0.3)));
            }
            _ => {}
        }
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let now = Instant::now();
        if let Some(last) = self.last_frame.replace(now) {
            self.gaps_ms.push((now - last).as_secs_f64() * 1e3);
        }
        self.app.ui(ui, frame);
        let (seen, ms) = (self.app.pictures_seen(), self.started.elapsed().as_secs_f64() * 1e3);
        if seen.count > 0 && !self.has_picture {
            println!("  first picture: {ms:.0} ms");
            self.has_picture = true;
        }
        match self.part {
            Part::Opens if seen.is_whole => println!("  whole picture: {ms:.0} ms"),
            Part::Opens => return,
            Part::Solves if seen.is_whole => {
                println!("  solving after the orbit");
                self.say_gaps();
                // The camera has moved, so that closing would ask whether to save.
                std::process::exit(0);
            }
            _ => {}
        }
        ui.ctx().request_repaint();
    }
}
