//! The viewport: the picture of the node that is looked at.

use crate::image::Image;

/// What the viewport remembers between frames.
#[derive(Default)]
pub struct Viewport;

impl Viewport {
    /// Draws the picture.
    pub fn show(&mut self, ui: &mut egui::Ui, image: Option<&Image>) {
        match image {
            Some(image) => ui.label(format!("{} x {}", image.width, image.height)),
            None => ui.weak("No picture yet."),
        };
    }
}
