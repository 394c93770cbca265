//! Every gesture on the viewport by AccessKit names, on a viewport alone in a window of 900 × 560 points.

mod hand;
mod seen;
mod slice;

use std::path::Path;

use egui::{Event, Modifiers, PointerButton, Pos2, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::*;
use crate::editor::look;
use crate::graph::PortType;
use crate::image::{ALPHA, DEPTH};

/// The viewport with what the editor would hold.
pub struct Bench {
    pub viewport: Viewport,
    pub project: Project,
    pub pictures: HashMap<String, Picture>,
}

impl Bench {
    /// On a march under a tone_map, whose pictures are there.
    pub fn new() -> Self {
        let text = r#"{"tyndall": 1, "nodes": {
            "ball": {"type": "shape"}, "medium": {"type": "medium"},
            "camera": {"type": "camera", "position": [0, 1, 6], "look_at": [0, 0, 0], "width": 96, "height": 64},
            "march": {"type": "raymarch"}, "tone": {"type": "tone_map"}, "other": {"type": "raymarch"}
        }, "wires": ["ball.volume -> medium.volume", "medium.medium -> march.medium", "march.image -> tone.image",
            "camera.camera -> march.camera"]}"#;
        let project = Project::new(Document::parse(text, Path::new("")).unwrap());
        let pictures = [("march", [0.25, 0.5, 0.0]), ("other", [0.0, 0.125, 0.5])];
        let pictures = pictures.map(|(name, rgb)| (name.to_owned(), picture(rgb)));
        Self { viewport: Viewport::default(), project, pictures: HashMap::from(pictures) }
    }

    pub fn show(&mut self, ui: &mut Ui) {
        let flat = self.project.document().clone();
        let look = look::look(&flat, Some("tone"));
        let scene = Scene {
            look: look.as_ref(),
            pictures: &self.pictures,
            camera: look::camera(&flat, "camera"),
            bounds: Some([DVec3::splat(-1.0), DVec3::splat(1.0)]),
            problem: None,
            is_busy: false,
            flat: self.viewport.slice.is_on().then_some(&flat),
        };
        self.viewport.show(ui, &mut self.project, &scene);
    }

    pub fn camera(&self) -> Camera {
        look::camera(self.project.document(), "camera").unwrap()
    }

    pub fn param(&self, node: &str, name: &str) -> Option<&serde_json::Value> {
        self.project.document().nodes[node].params.get(name)
    }
}

/// Brighter to the right and blue upwards, 6 m away; covered in its right half.
fn picture([r, g, b]: [f32; 3]) -> Picture {
    let (width, height) = (96, 64);
    let share = |idx: usize| [(idx % width) as f32 / width as f32, (idx / width) as f32 / height as f32];
    let rgb = (0..width * height).flat_map(|idx| {
        let [x, y] = share(idx);
        [r + 0.5 * x, g * x, b + 0.5 * (1.0 - y)]
    });
    let mut image = Image::new(width, height, rgb.collect());
    image.insert(ALPHA, 1, (0..width * height).map(|idx| share(idx)[0].round()).collect());
    image.insert(DEPTH, 1, vec![6.0; width * height]);
    Picture { value: Value::new(PortType::Image, 0, image), level: Level::FULL }
}

pub const SIZE: Vec2 = vec2(900.0, 560.0);

pub fn window() -> Harness<'static, Bench> {
    let builder = Harness::builder().with_size(SIZE).with_step_dt(1.0 / 60.0);
    let mut harness = builder.build_ui_state(|ui, bench: &mut Bench| bench.show(ui), Bench::new());
    harness.run_steps(3);
    harness
}

pub fn at(harness: &Harness<Bench>, label: &str) -> Pos2 {
    harness.get_by_label(label).rect().center()
}

pub fn click(harness: &mut Harness<Bench>, label: &str) {
    harness.get_by_label(label).click();
    harness.run_steps(3);
}

/// From one point to another by steps, with a button and modifiers.
pub fn drag(harness: &mut Harness<Bench>, from: Pos2, by: Vec2, button: PointerButton, modifiers: Modifiers) {
    let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
    harness.hover_at(from);
    harness.run_steps(2);
    let events = (0..=4).map(|n| Event::PointerMoved(from + by * (n as f32 / 4.0)));
    let events = [press(from, true)].into_iter().chain(events).chain([press(from + by, false)]);
    for event in events {
        harness.event_modifiers(event, modifiers);
        harness.step();
    }
    harness.run_steps(2);
}

pub fn plain_drag(harness: &mut Harness<Bench>, from: Pos2, by: Vec2) {
    drag(harness, from, by, PointerButton::Primary, Modifiers::NONE);
}

/// Notches of a wheel, towards the screen where they are above 0.
pub fn wheel(harness: &mut Harness<Bench>, at: Pos2, notches: f32, modifiers: Modifiers) {
    harness.hover_at(at);
    harness.run_steps(2);
    let delta = vec2(0.0, notches);
    let (unit, phase) = (egui::MouseWheelUnit::Line, egui::TouchPhase::Move);
    harness.event_modifiers(Event::MouseWheel { unit, delta, phase, modifiers }, modifiers);
    harness.run_steps(40);
}

/// A name that begins so.
pub fn has(harness: &Harness<Bench>, part: &str) -> bool {
    harness.query_all_by_label_contains(part).next().is_some()
}
