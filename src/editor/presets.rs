//! The presets: the graphs that come with Tyndall, and their small pictures.
//!
//! Presets read volumes beside them, so they are found on disk ([`crate::template::presets`]). Their small pictures are inside of the program; they are made by
//! `docs/thumbnails/make`. Opened, a preset is a copy that has no file yet.

use std::path::{Path, PathBuf};

use crate::graph::{Document, DocumentError};

#[derive(rust_embed::RustEmbed)]
#[folder = "docs/thumbnails"]
#[include = "*.png"]
struct Thumbnails;

/// A graph that comes with Tyndall.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    /// The name of its file, without the ending.
    pub name: String,
    /// What it is for.
    pub about: String,
    /// Its file.
    pub path: PathBuf,
}

/// All presets of a folder that can be read, by name.
pub fn list(folder: &Path) -> Vec<Preset> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let read = |path: PathBuf| {
        let name = path.file_stem()?.to_str()?.to_owned();
        let document = (path.extension()? == "json").then(|| Document::load(&path).ok()).flatten()?;
        Some(Preset { name, about: document.about, path })
    };
    let mut presets: Vec<Preset> = entries.filter_map(|entry| read(entry.path())).collect();
    presets.sort_by(|a, b| a.name.cmp(&b.name));
    // The one to begin with.
    if let Some(first) = presets.iter().position(|preset| preset.name == "cumulus") {
        presets[..=first].rotate_right(1);
    }
    presets
}

impl Preset {
    /// A copy to work on.
    ///
    /// # Errors
    /// Those of [`Document::load`].
    pub fn open(&self) -> Result<Document, DocumentError> {
        Document::load(&self.path)
    }

    /// Its small picture, decoded.
    pub fn thumbnail(&self) -> Option<egui::ColorImage> {
        let file = Thumbnails::get(&format!("{}.png", self.name))?;
        let mut reader = png::Decoder::new(std::io::Cursor::new(file.data.as_ref())).read_info().ok()?;
        let mut bytes = vec![0; reader.output_buffer_size()?];
        let info = reader.next_frame(&mut bytes).ok()?;
        let size = [info.width as usize, info.height as usize];
        match info.color_type {
            png::ColorType::Rgb => Some(egui::ColorImage::from_rgb(size, &bytes[..info.buffer_size()])),
            png::ColorType::Rgba => {
                Some(egui::ColorImage::from_rgba_unmultiplied(size, &bytes[..info.buffer_size()]))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_found_and_have_pictures() {
        let presets = list(&crate::template::presets().expect("the repository's graphs"));
        assert!(presets.len() >= 10 && presets[0].name == "cumulus");
        for preset in &presets {
            assert!(!preset.about.is_empty(), "{}", preset.name);
        }
        // Of whatever preset a picture is, it can be decoded.
        for file in Thumbnails::iter() {
            let name = file.trim_end_matches(".png").to_owned();
            assert!(presets.iter().any(|preset| preset.name == name), "{name} is the picture of no preset");
            let preset = Preset { name, about: String::new(), path: PathBuf::new() };
            assert_eq!(preset.thumbnail().map(|picture| picture.size), Some([448, 252]), "{file}");
        }
    }
}
