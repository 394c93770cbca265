//! What a first, coarse picture leaves out, and how large the picture may be while something is dragged.
//!
//! A preview is an ordinary document with other parameters, so that nodes know nothing of it and the cache
//! keeps both results: [`at`] gives the document of a [`Level`]. Coarse fields have at most
//! [`COARSE_CELLS`] cells an axis and the residual's draft; a smaller picture takes one ray a pixel and steps of
//! a cell. The full level is the document itself.
//!
//! The picture's share of its sides follows the clock: time goes with the number of pixels, the square of the
//! share, so that the next share is share·√(target/measured), held between half and twice the last
//! ([`Pace`]). Tested here by parameters and by a model of the clock.

use serde_json::Value as Json;

use crate::graph::{Document, Node};
use crate::nodes::catalog;

/// How much of the document is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The picture's sides as a share of the camera's, up to 1.
    pub share: f64,
    /// Fields are coarse.
    pub is_coarse: bool,
}

impl Level {
    /// The document as it is.
    pub const FULL: Self = Self { share: 1.0, is_coarse: false };
    /// The first picture of a graph that was not seen before.
    pub const FIRST: Self = Self { share: 0.25, is_coarse: true };

    /// Whether it is the document as it is.
    pub fn is_full(self) -> bool {
        self == Self::FULL
    }
}

/// Cells of a coarse field along its longest axis.
const COARSE_CELLS: i64 = 48;
/// Cameras do not get smaller than so many pixels a side.
const LEAST_PIXELS: i64 = 24;

/// The document of a level.
pub fn at(document: &Document, level: Level) -> Document {
    let mut document = document.clone();
    for node in document.nodes.values_mut() {
        if level.share < 1.0 {
            shrink(node, level.share);
        }
        if level.is_coarse {
            coarsen(node);
        }
    }
    document
}

fn shrink(node: &mut Node, share: f64) {
    match node.type_id.as_str() {
        "camera" => {
            for side in ["width", "height"] {
                if let Some(pixels) = number(node, side) {
                    let fewer = (pixels * share).round() as i64;
                    set(node, side, fewer.max(LEAST_PIXELS).min(pixels as i64));
                }
            }
        }
        "raymarch" => {
            set(node, "samples", 1);
            if let Some(step) = number(node, "step").filter(|step| *step < 1.0 && *step > 0.0) {
                set(node, "step", step.max(1.0));
            }
        }
        _ => {}
    }
}

fn coarsen(node: &mut Node) {
    match node.type_id.as_str() {
        "medium" => {
            let given = number(node, "max_resolution").unwrap_or(0.0) as i64;
            set(node, "max_resolution", if given == 0 { COARSE_CELLS } else { given.min(COARSE_CELLS) });
        }
        "isotropic_residual" => {
            // What was given for another quality does not make a draft.
            node.params.shift_remove("sweeps");
            node.params.shift_remove("coarse_sweeps");
            set(node, "quality", "draft");
        }
        // A widening peak costs seven scans.
        "principal_propagation" if node.params.get("peak").is_some_and(|peak| peak == "widening") => {
            set(node, "peak", "straight");
        }
        _ => {}
    }
}

fn set(node: &mut Node, name: &str, value: impl Into<Json>) {
    node.params.insert(name.to_owned(), value.into());
}

/// What is given, else the default; `None` for what is no number, which the node will report.
fn number(node: &Node, name: &str) -> Option<f64> {
    match node.params.get(name) {
        Some(given) => given.as_f64(),
        None => catalog().find(&node.type_id)?.param(name)?.default_json()?.as_f64(),
    }
}

/// A picture while something is dragged: 5 a second, and something left for the window.
const TARGET_MS: f64 = 160.0;
const SMALLEST_SHARE: f64 = 1.0 / 12.0;

/// The share of the picture that the machine keeps up with, as last measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    share: f64,
    ms: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self { share: 0.25, ms: TARGET_MS }
    }
}

impl Pace {
    /// The share to try next.
    pub fn share(&self) -> f64 {
        let wanted = self.share * (TARGET_MS / self.ms.max(1.0)).sqrt();
        wanted.clamp(0.5 * self.share, 2.0 * self.share).clamp(SMALLEST_SHARE, 1.0)
    }

    /// What a share took.
    pub fn measured(&mut self, share: f64, ms: f64) {
        *self = Self { share, ms };
    }

    /// What the whole picture would take, in ms.
    pub fn full_ms(&self) -> f64 {
        self.ms / (self.share * self.share)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn document() -> Document {
        let text = r#"{"tyndall": 1, "nodes": {
            "medium": {"type": "medium"},
            "fine": {"type": "medium", "max_resolution": 32},
            "residual": {"type": "isotropic_residual", "quality": "reference", "sweeps": 40},
            "camera": {"type": "camera", "width": 961, "height": 30},
            "march": {"type": "raymarch", "samples": 16},
            "odd": {"type": "camera", "width": "wide"}
        }, "wires": []}"#;
        Document::parse(text, Path::new("")).unwrap()
    }

    #[test]
    fn the_full_level_is_the_document() {
        assert_eq!(at(&document(), Level::FULL), document());
    }

    #[test]
    fn a_coarse_level_is_cheap() {
        let preview = at(&document(), Level::FIRST);
        let param = |node: &str, name: &str| preview.nodes[node].params.get(name).cloned();
        assert_eq!(param("medium", "max_resolution"), Some(48.into()));
        assert_eq!(param("fine", "max_resolution"), Some(32.into()));
        assert_eq!((param("residual", "quality"), param("residual", "sweeps")), (Some("draft".into()), None));
        assert_eq!(param("camera", "width"), Some(240.into()));
        // Not under 24, and never more than were asked for.
        assert_eq!(param("camera", "height"), Some(24.into()));
        assert_eq!((param("march", "samples"), param("march", "step")), (Some(1.into()), Some(1.0.into())));
        // What is wrong stays as it is, so that its message is the same.
        assert_eq!(param("odd", "width"), Some("wide".into()));
        assert_eq!(param("odd", "height"), Some(128.into()));
        // Only the picture: fields are the document's own, so that they are found in the cache.
        let small = at(&document(), Level { share: 0.5, is_coarse: false });
        assert_eq!(small.nodes["medium"], document().nodes["medium"]);
        assert_eq!(small.nodes["residual"], document().nodes["residual"]);
    }

    // A machine that takes 1 s for the whole picture and 20 ms whatever its size: the share settles where
    // 1000 s² + 20 = 160, s = 0.374. √ leaves an error of the constant part alone: within 10 %.
    #[test]
    fn the_pace_settles() {
        let mut pace = Pace::default();
        for _ in 0..20 {
            let share = pace.share();
            pace.measured(share, 1000.0 * share * share + 20.0);
        }
        assert!((pace.share() - 0.374).abs() < 0.037, "{pace:?}");
        // Never all of a sudden, never more than the picture, never nothing.
        pace.measured(0.4, 1e6);
        assert_eq!(pace.share(), 0.2);
        pace.measured(1.0, 1.0);
        assert_eq!(pace.share(), 1.0);
        pace.measured(0.1, 1e9);
        assert_eq!(pace.share(), SMALLEST_SHARE);
    }
}
