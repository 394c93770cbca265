//! The viewport: the picture of the node that is looked at, and the hand on its camera.
//!
//! Left drag orbits, middle or shift-drag pans, the wheel comes nearer, right drag looks around and with it
//! W A S D Q E fly; each gesture changes position and look_at of the wired camera and is one step of undo. With
//! Ctrl the wheel zooms the picture and a drag moves it. Exposure and curve are those of the tone_map that is looked
//! through, else the window's own. A wipe shows another node's picture, or a stored one, beyond its divider.
//!
//! Camera math stands in [`eye`], what is shown in [`display`], where it lies in [`place`]: all tested without a
//! window. Gestures are tested by `egui_kittest`.

mod bar;
pub mod display;
mod eye;
mod hand;
mod lens;
mod overlay;
mod place;
mod slice;
#[cfg(test)]
mod tests;

use std::collections::HashMap;

use egui::{Rect, Sense, TextureHandle, TextureOptions, Ui, WidgetInfo, WidgetType};
use glam::DVec3;

use super::look::{self, Look};
use super::preview::Level;
use super::{Project, theme};
use crate::camera::Camera;
use crate::graph::{Document, Value};
use crate::image::{BEAUTY, Image};

use display::Histogram;
pub use display::{Tone, thumbnail};
use lens::Lens;
use place::Place;
pub use slice::{NAME as SLICE, Slice};

/// A picture that came to be.
#[derive(Debug, Clone)]
pub struct Picture {
    /// An [`Image`].
    pub value: Value,
    /// How much of it was computed.
    pub level: Level,
}

/// What there is to show.
pub struct Scene<'a> {
    /// What is looked at.
    pub look: Option<&'a Look>,
    /// Pictures by node.
    pub pictures: &'a HashMap<String, Picture>,
    /// The camera of the document, where it has one.
    pub camera: Option<Camera>,
    /// Lowest and highest corner of the volume, in meters.
    pub bounds: Option<[DVec3; 2]>,
    /// Why there is no picture: a node and its message.
    pub problem: Option<(String, String)>,
    /// Something runs.
    pub is_busy: bool,
    /// The document without groups, while there is a slice plane.
    pub flat: Option<&'a Document>,
}

impl Scene<'_> {
    /// Whether what is shown is seen by a camera, also by one that would refuse its values.
    fn has_camera(&self) -> bool {
        self.look.is_some_and(|look| look.camera.is_some())
    }

    /// Whether there is something to look at as a whole: a box before a camera, or a picture without one.
    fn can_frame(&self) -> bool {
        match self.has_camera() {
            true => self.camera.is_some() && self.bounds.is_some(),
            false => self.look.is_some(),
        }
    }
}

/// What a wipe shows beyond its divider.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) enum Wipe {
    /// No wipe.
    #[default]
    Off,
    /// A stored picture.
    Stored(usize),
    /// Another node's.
    Node(String),
}

impl Wipe {
    /// What its other side shows.
    fn name(&self) -> String {
        match self {
            Self::Off => String::new(),
            Self::Stored(slot) => format!("stored {}", STORED[*slot]),
            Self::Node(name) => name.clone(),
        }
    }
}

/// Names of the stored pictures.
const STORED: [&str; 2] = ["A", "B"];

/// What the viewport remembers between frames.
pub struct Viewport {
    place: Place,
    layer: String,
    /// Where no tone_map is looked through.
    tone: Tone,
    wipe: Wipe,
    /// Share of the picture's width at which the wipe divides it.
    divider: f32,
    stored: [Option<Picture>; 2],
    shown: [Option<Shown>; 2],
    shows_histogram: bool,
    /// When the camera last moved by the wheel, in seconds.
    wheeled: Option<f64>,
    /// The slice plane.
    pub slice: Slice,
}

impl Default for Viewport {
    fn default() -> Self {
        Self {
            place: Place::Fit,
            layer: BEAUTY.to_owned(),
            tone: Tone::default(),
            wipe: Wipe::Off,
            divider: 0.5,
            stored: [None, None],
            shown: [None, None],
            shows_histogram: false,
            wheeled: None,
            slice: Slice::default(),
        }
    }
}

/// A picture on the device, and what it was made from.
struct Shown {
    value: Value,
    layer: String,
    tone: Tone,
    texture: TextureHandle,
    histogram: Histogram,
}

impl Viewport {
    /// The whole picture, as large as fits.
    pub fn fit(&mut self) {
        self.place = Place::Fit;
        self.slice.fit();
    }

    /// Whether the whole picture is shown, for tests.
    #[cfg(test)]
    pub fn is_fitted(&self) -> bool {
        self.place == Place::Fit
    }

    /// A pixel of the screen for each of the picture.
    pub fn one_to_one(&mut self, context: &egui::Context) {
        self.place = Place::one_to_one(context.pixels_per_point());
    }

    /// Whether the histogram is shown.
    pub fn shows_histogram(&self) -> bool {
        self.shows_histogram
    }

    /// Shows or hides the histogram.
    pub fn toggle_histogram(&mut self) {
        self.shows_histogram = !self.shows_histogram;
    }

    /// Keeps the picture to compare others with.
    pub fn store(&mut self, slot: usize, scene: &Scene) {
        self.stored[slot] = scene.look.and_then(|look| scene.pictures.get(&look.source.node)).cloned();
        self.wipe = if self.stored[slot].is_some() { Wipe::Stored(slot) } else { Wipe::Off };
    }

    /// Whether a move of this camera sets a key.
    pub fn has_keys(document: &Document, camera: &str) -> bool {
        hand::keys(document, camera).is_some()
    }

    /// Whether the wheel moved the camera a moment ago: what is asked for must keep up.
    pub fn is_moving(&self, now: f64) -> bool {
        self.wheeled.is_some_and(|then| now - then < 0.3)
    }

    /// Looks at the whole volume: by the camera, or without one, as of a slice, at the whole picture.
    ///
    /// # Errors
    /// Says why it cannot, in a line.
    pub fn frame(&mut self, project: &mut Project, scene: &Scene) -> Result<(), &'static str> {
        if !scene.has_camera() {
            self.fit();
            return Ok(());
        }
        let camera = scene.camera.ok_or("The camera's own values are refused: mend them first")?;
        let [min, max] = scene.bounds.ok_or("Nothing to frame: no volume has been computed yet")?;
        hand::write(project, scene, None, "frame the volume", eye::frame(camera, min, max));
        Ok(())
    }

    /// Draws the picture and takes gestures on it.
    pub fn show(&mut self, ui: &mut Ui, project: &mut Project, scene: &Scene) {
        let picture = scene.look.and_then(|look| scene.pictures.get(&look.source.node));
        bar::show(self, ui, project, scene, picture.map(|picture| picture.value.get::<Image>()));
        let has_place = scene.camera.is_some_and(|camera| camera.frame().is_ok());
        if let Some(flat) = scene.flat {
            slice::strip(&mut self.slice, ui, flat, has_place);
        }
        let area = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(area, Sense::click_and_drag());
        ui.painter().rect_filled(area, 0.0, theme::backdrop(ui));
        if let Some(flat) = scene.flat.filter(|_| self.slice.is_flat(has_place)) {
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, "Flat slice"));
            slice::flat(&mut self.slice, ui, area, &response, flat);
            return;
        }
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, "Picture"));
        let Some(picture) = picture else {
            overlay::placeholder(ui, area, scene);
            return;
        };
        let image: &Image = picture.value.get();
        let size = match scene.camera {
            Some(camera) => [camera.width, camera.height],
            None => [image.width, image.height],
        };
        let rect = self.place.rect(area, size);
        let tone = match scene.look {
            Some(look) => look::tone(project.document(), look, self.tone),
            None => self.tone,
        };
        self.develop(ui, 0, picture, tone);
        let other = match &self.wipe {
            Wipe::Off => None,
            Wipe::Stored(slot) => self.stored[*slot].clone(),
            Wipe::Node(name) => scene.pictures.get(name).cloned(),
        };
        if let Some(other) = &other {
            self.develop(ui, 1, other, tone);
        }
        self.paint(ui, area, rect, other.is_some());
        if other.is_some() {
            hand::divider(self, ui, area, rect);
            let left = scene.look.map_or("", |look| look.source.node.as_str());
            let x = rect.left() + self.divider * rect.width();
            overlay::sides(ui, area, x, [left, &self.wipe.name()]);
        }
        let lens = scene.camera.and_then(|camera| Lens::new(camera, rect));
        let mut told = Vec::new();
        if let (Some(flat), Some(lens)) = (scene.flat, &lens) {
            told.extend(slice::in_picture(&mut self.slice, ui, (area, rect), &response, lens, flat));
        }
        if let Some(at) = response.hover_pos() {
            told.extend(overlay::readout(ui, area, rect, at, image, scene.camera, &self.layer));
        }
        if scene.is_busy && !picture.level.is_full() {
            overlay::refining(ui, area);
        }
        overlay::guides(ui, area, rect, scene.camera, &told);
        if let (true, Some(shown)) = (self.shows_histogram, &self.shown[0]) {
            overlay::histogram(ui, area, rect, &shown.histogram, &self.layer);
        }
        if let Some((frames, frame)) =
            scene.look.and_then(|look| hand::keys(project.document(), look.camera.as_ref()?))
        {
            overlay::keys(ui, area, &frames, frame);
        }
        if let Some((name, message)) = &scene.problem {
            overlay::problem(ui, area, name, message);
        }
        hand::take(self, ui, &response, project, scene, (area, rect, size));
    }

    /// Makes the texture, unless it is there.
    fn develop(&mut self, ui: &Ui, slot: usize, picture: &Picture, tone: Tone) {
        let image: &Image = picture.value.get();
        let layer = if image.layers.contains_key(&self.layer) { &self.layer } else { BEAUTY };
        let is_same = self.shown[slot].as_ref().is_some_and(|shown| {
            shown.value.shares_data_with(&picture.value) && shown.layer == layer && shown.tone == tone
        });
        let Some(pixels) = (!is_same).then(|| display::develop(image, layer, tone)).flatten() else { return };
        let options = TextureOptions { magnification: egui::TextureFilter::Linear, ..TextureOptions::LINEAR };
        let texture = match self.shown[slot].take() {
            Some(Shown { mut texture, .. }) => {
                texture.set(pixels, options);
                texture
            }
            None => ui.ctx().load_texture(format!("picture {slot}"), pixels, options),
        };
        let histogram = Histogram::of(&image.layers[layer]);
        self.shown[slot] =
            Some(Shown { value: picture.value.clone(), layer: layer.to_owned(), tone, texture, histogram });
    }

    fn paint(&self, ui: &Ui, area: Rect, rect: Rect, has_other: bool) {
        let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        let painter = ui.painter().with_clip_rect(area);
        if let Some(shown) = &self.shown[0] {
            painter.image(shown.texture.id(), rect, whole, egui::Color32::WHITE);
        }
        if let (true, Some(other)) = (has_other, &self.shown[1]) {
            let x = rect.left() + self.divider * rect.width();
            let beyond = Rect::from_min_max(egui::pos2(x, area.top()), area.max);
            ui.painter().with_clip_rect(beyond.intersect(area)).image(
                other.texture.id(),
                rect,
                whole,
                egui::Color32::WHITE,
            );
            painter.vline(x, rect.y_range(), (2.0, egui::Color32::from_white_alpha(200)));
        }
    }
}
