//! What the editor remembers from one start to the next: recent graphs, theme, scale, panels.
//!
//! A JSON file in the user's configuration folder, written whole. What cannot be read is forgotten, not complained
//! about: settings are no work. Tested by a round trip and by a damaged file.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::image::atomic;

/// Graphs that are remembered.
const MOST_RECENT: usize = 8;

/// Light, dark, or as the system has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ThemeChoice {
    /// Dark, whatever the system says: a picture is judged in the dark.
    #[default]
    Dark,
    /// Light.
    Light,
    /// As the system has it.
    System,
}

impl From<ThemeChoice> for egui::ThemePreference {
    fn from(choice: ThemeChoice) -> Self {
        match choice {
            ThemeChoice::Dark => Self::Dark,
            ThemeChoice::Light => Self::Light,
            ThemeChoice::System => Self::System,
        }
    }
}

/// All that is remembered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Light or dark.
    pub theme: ThemeChoice,
    /// What sizes are multiplied by.
    pub scale: f32,
    /// Graphs, the last first.
    pub recent: Vec<PathBuf>,
    /// Width of the inspector, in points.
    pub inspector_width: f32,
    /// Height of the canvas, in points, where the user chose one.
    pub canvas_height: Option<f32>,
    /// Where files are looked for first.
    pub folder: Option<PathBuf>,
    /// Pictures a second of the timeline.
    pub fps: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::Dark,
            scale: 1.0,
            recent: Vec::new(),
            // The longest unit stands in whole beside a number of five digits.
            inspector_width: 344.0,
            canvas_height: None,
            folder: None,
            fps: 24.0,
        }
    }
}

impl Settings {
    /// The user's file; `None` where the system has no such folder.
    pub fn file() -> Option<PathBuf> {
        Some(dirs::config_dir()?.join("tyndall").join("settings.json"))
    }

    /// What was remembered, else the defaults.
    pub fn load(file: Option<&Path>) -> Self {
        let text = file.and_then(|file| std::fs::read_to_string(file).ok());
        let mut settings: Self = text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        // A scale that nobody could read would leave no way back.
        if !(0.5..=3.0).contains(&settings.scale) {
            settings.scale = 1.0;
        }
        settings
    }

    /// Remembers. A folder that cannot be written to leaves things as they were.
    pub fn save(&self, file: Option<&Path>) {
        let (Some(file), Ok(mut text)) = (file, serde_json::to_string_pretty(self)) else { return };
        text.push('\n');
        if let Some(folder) = file.parent() {
            let _ = std::fs::create_dir_all(folder);
        }
        let _ = atomic::write(file, text.as_bytes());
    }

    /// Puts a graph in front of the recent ones.
    pub fn opened(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|other| *other != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_saved_is_loaded() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("new").join("settings.json");
        let mut settings = Settings { scale: 1.5, theme: ThemeChoice::Light, ..Settings::default() };
        for n in 0..10 {
            settings.opened(Path::new(&format!("/graphs/{}.json", n % 9)));
        }
        assert_eq!((settings.recent.len(), settings.recent[0].as_path()), (8, Path::new("/graphs/0.json")));
        settings.save(Some(&file));
        assert_eq!(Settings::load(Some(&file)), settings);
        // Of an older or newer version: what is not there has its default.
        std::fs::write(&file, r#"{"theme": "light", "unknown": 1, "scale": 40}"#).unwrap();
        assert_eq!(
            Settings::load(Some(&file)),
            Settings { theme: ThemeChoice::Light, ..Settings::default() }
        );
        std::fs::write(&file, "{").unwrap();
        assert_eq!(Settings::load(Some(&file)), Settings::default());
    }
}
