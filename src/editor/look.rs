//! Which picture is looked at, and from which nodes it comes.
//!
//! A tone_map is not waited for: what it reads is looked at, and its exposure and curve are applied in the window,
//! so that they follow a slider without a new picture. Without a choice it is the last tone_map that is wired,
//! else the last picture that a camera sees, else the last of any. Pure functions of the document, tested here.

use std::collections::HashSet;

use super::viewport::Tone;
use crate::camera::Camera;
use crate::graph::{Document, End, FileState, Moment, NodeSpec, ParamKind, Params, PortType};
use crate::image::tonemap::Curve;
use crate::nodes::{self, catalog};

/// A picture, and the nodes around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// The node that was chosen.
    pub chosen: String,
    /// Who gives the radiance.
    pub source: End,
    /// The tone_map whose parameters are applied.
    pub tone: Option<String>,
    /// The camera above it.
    pub camera: Option<String>,
    /// What of it fills space.
    pub matter: Option<Matter>,
}

/// What fills the space that a picture shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Matter {
    /// Who gives it: a medium, else a volume.
    pub output: End,
    /// Of a volume, the grid that is shown.
    pub grid: Option<String>,
}

const CAMERA: &str = "camera";

/// What is looked at; `None` where no node gives a picture.
pub fn look(document: &Document, chosen: Option<&str>) -> Option<Look> {
    let chosen = chosen.and_then(|name| of_node(document, name)).or_else(|| {
        let last = |is_tone: bool| {
            let nodes = document.nodes.iter().rev();
            let mut nodes = nodes.filter(|(_, node)| (node.type_id == "tone_map") == is_tone);
            nodes.find_map(|(name, _)| of_node(document, name))
        };
        let through_camera = || {
            let mut nodes = document.nodes.keys().rev().filter_map(|name| of_node(document, name));
            nodes.find(|(_, source, _)| {
                above(document, &source.node).iter().any(|name| document.nodes[*name].type_id == CAMERA)
            })
        };
        last(true).or_else(through_camera).or_else(|| last(false))
    })?;
    let above = above(document, &chosen.1.node);
    let camera = above.iter().find(|name| document.nodes[**name].type_id == CAMERA);
    Some(Look {
        camera: camera.map(|name| (*name).to_owned()),
        matter: matter(document, &above),
        chosen: chosen.0,
        source: chosen.1,
        tone: chosen.2,
    })
}

/// The nearest medium that these nodes read, else the nearest volume.
fn matter(document: &Document, above: &[&str]) -> Option<Matter> {
    let read = |kind: PortType| {
        let wires =
            above.iter().flat_map(|name| document.wires.iter().filter(move |wire| wire.to.node == *name));
        let mut wires = wires.filter(move |wire| kind_of(document, &wire.from) == Some(kind));
        wires.next()
    };
    if let Some(wire) = read(PortType::Medium) {
        return Some(Matter { output: wire.from.clone(), grid: None });
    }
    let wire = read(PortType::Volume)?;
    let reader = document.nodes.get(&wire.to.node)?;
    let params = catalog().find(&reader.type_id)?.params;
    let spec = params.iter().find(|param| matches!(param.kind, ParamKind::Grid))?;
    let grid = reader.params.get(spec.name).cloned().or_else(|| spec.default_json())?;
    Some(Matter { output: wire.from.clone(), grid: Some(grid.as_str()?.to_owned()) })
}

/// What an output gives.
fn kind_of(document: &Document, output: &End) -> Option<PortType> {
    let spec = catalog().find(&document.nodes.get(&output.node)?.type_id)?;
    spec.outputs.iter().find(|port| port.name == output.port).map(|port| port.kind)
}

/// The node, who gives its radiance, and whether it maps tones.
fn of_node(document: &Document, name: &str) -> Option<(String, End, Option<String>)> {
    let node = document.nodes.get(name)?;
    let read = || document.wires.iter().find(|wire| wire.to.node == name && wire.to.port == "image");
    match node.type_id.as_str() {
        "tone_map" => {
            let from = read()?.from.clone();
            document.nodes.contains_key(&from.node).then(|| (name.to_owned(), from, Some(name.to_owned())))
        }
        // It shows what it saves.
        "save_image" => {
            of_node(document, &read()?.from.node).map(|found| (name.to_owned(), found.1, found.2))
        }
        kind => {
            let spec = catalog().find(kind)?;
            let port = spec.outputs.iter().find(|port| port.kind == PortType::Image)?;
            let end = End { node: name.to_owned(), port: port.name.to_owned() };
            Some((name.to_owned(), end, None))
        }
    }
}

/// The nodes that a node reads, directly or not, the nearest first; itself too.
pub fn above<'a>(document: &'a Document, name: &'a str) -> Vec<&'a str> {
    let mut found = vec![name];
    let mut next = 0;
    while let Some(&name) = found.get(next) {
        next += 1;
        for wire in document.wires.iter().filter(|wire| wire.to.node == name) {
            let from = wire.from.node.as_str();
            if document.nodes.contains_key(from) && !found.contains(&from) {
                found.push(from);
            }
        }
    }
    found
}

/// The files that a node and all above it read in a frame, as they are now.
pub fn files_above(document: &Document, name: &str, frame: i64) -> Vec<FileState> {
    let moment = Moment { frame: Some(frame), is_aside: false };
    let files = |name: &str| {
        let node = document.nodes.get(name)?;
        let kind = nodes::kind(&node.type_id)?;
        let params = Params::resolve(kind.spec.params, &node.params, &document.base, moment).ok()?;
        (kind.files)(&params).ok()
    };
    let files = above(document, name).into_iter().filter_map(files).flatten();
    files.map(|path| FileState::of(&path)).collect()
}

/// How the picture of a tone_map is shown; without one, or with parameters that it would refuse, `other`.
pub fn tone(document: &Document, look: &Look, other: Tone) -> Tone {
    let Some(node) = look.tone.as_ref().and_then(|name| document.node(name)) else { return other };
    let exposure_ev = node.params.get("exposure_ev").map_or(Some(0.0), |ev| ev.as_f64());
    let curve = node
        .params
        .get("curve")
        .map_or(Some(Curve::None), |curve| serde_json::from_value(curve.clone()).ok());
    match (exposure_ev, curve) {
        (Some(ev), Some(curve)) => Tone { exposure_ev: ev as f32, curve },
        _ => other,
    }
}

/// The camera as it is at the frame; `None` where its node would refuse its parameters.
pub fn camera(document: &Document, name: &str) -> Option<Camera> {
    let node = document.node(name).filter(|node| node.type_id == CAMERA)?;
    let spec = catalog().find(CAMERA)?;
    let moment = Moment { frame: document.frame, is_aside: false };
    let params = Params::resolve(spec.params, &node.params, &document.base, moment).ok()?;
    Some(Camera {
        position: glam::DVec3::from_array(params.vec("position")),
        look_at: glam::DVec3::from_array(params.vec("look_at")),
        up: glam::DVec3::from_array(params.vec("up")),
        fov_y_deg: params.f64("fov_y_deg"),
        width: params.i64("width") as usize,
        height: params.i64("height") as usize,
    })
}

/// Nodes that are wired, give something and write nothing: what may be run only to know more of it.
pub fn harmless(document: &Document) -> Vec<String> {
    let is_wired =
        |name: &str| document.wires.iter().any(|wire| wire.from.node == name || wire.to.node == name);
    let writes = |spec: &NodeSpec| spec.params.iter().any(|param| matches!(param.kind, ParamKind::OutPath));
    let nodes = document.nodes.iter().filter(|(name, node)| {
        let spec = catalog().find(&node.type_id);
        spec.is_some_and(|spec| !spec.outputs.is_empty() && !writes(spec)) && is_wired(name)
    });
    nodes.map(|(name, _)| name.clone()).collect()
}

/// The nodes whose results an edit changes: those that are not as they were, or read others, and all below.
pub fn changed<'a>(before: &Document, after: &'a Document) -> HashSet<&'a str> {
    let inputs = |document: &Document, name: &str| -> Vec<(End, String)> {
        let wires = document.wires.iter().filter(|wire| wire.to.node == name);
        wires.map(|wire| (wire.from.clone(), wire.to.port.clone())).collect()
    };
    let is_new = |name: &str| {
        before.nodes.get(name) != after.nodes.get(name) || inputs(before, name) != inputs(after, name)
    };
    let mut found: Vec<&str> = after.nodes.keys().map(String::as_str).filter(|name| is_new(name)).collect();
    let mut next = 0;
    while let Some(&name) = found.get(next) {
        next += 1;
        for wire in after.wires.iter().filter(|wire| wire.from.node == name) {
            if !found.contains(&wire.to.node.as_str()) {
                found.push(&wire.to.node);
            }
        }
    }
    found.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn document() -> Document {
        let text = r#"{"tyndall": 1, "nodes": {
            "cloud": {"type": "shape"}, "medium": {"type": "medium"}, "camera": {"type": "camera"},
            "march": {"type": "raymarch"},
            "tone": {"type": "tone_map", "exposure_ev": 1.5, "curve": "aces"},
            "loose": {"type": "tone_map"}, "save": {"type": "save_image"}
        }, "wires": ["cloud.volume -> medium.volume", "medium.medium -> march.medium",
            "camera.camera -> march.camera", "march.image -> tone.image", "tone.image -> save.image"]}"#;
        Document::parse(text, Path::new("")).unwrap()
    }

    #[test]
    fn the_tone_map_is_looked_through() {
        let document = document();
        for (chosen, is) in
            [(None, "tone"), (Some("save"), "save"), (Some("tone"), "tone"), (Some("cloud"), "tone")]
        {
            let look = look(&document, chosen).unwrap();
            assert_eq!((look.chosen.as_str(), look.source.to_string().as_str()), (is, "march.image"));
            assert_eq!(look.tone.as_deref(), Some("tone"));
            assert_eq!(look.camera.as_deref(), Some("camera"));
            let matter = look.matter.as_ref().unwrap();
            assert_eq!((matter.output.to_string().as_str(), matter.grid.as_ref()), ("medium.medium", None));
            let shown = tone(&document, &look, Tone::default());
            assert_eq!(shown, Tone { exposure_ev: 1.5, curve: Curve::Aces });
        }
        let plain = look(&document, Some("march")).unwrap();
        assert_eq!((plain.chosen.as_str(), plain.tone), ("march", None));
        assert_eq!(look(&Document::default(), None), None);
        assert!(
            !harmless(&document).contains(&"save".to_owned())
                && !harmless(&document).contains(&"loose".to_owned())
        );
    }

    #[test]
    fn what_a_camera_sees_goes_before_a_chart() {
        let text = r#"{"tyndall": 1, "nodes": {"cloud": {"type": "shape"}, "camera": {"type": "camera"},
            "seen": {"type": "transfer_function"}, "bars": {"type": "histogram"}, "save": {"type": "save_image"}},
            "wires": ["cloud.volume -> seen.volume", "cloud.volume -> bars.volume", "camera.camera -> seen.camera",
            "bars.image -> save.image"]}"#;
        let mut document = Document::parse(text, Path::new("")).unwrap();
        let source = |document: &Document| look(document, None).unwrap().source.to_string();
        assert_eq!(source(&document), "seen.image");
        let matter = |document: &Document| look(document, None).unwrap().matter.unwrap();
        let shown = |grid: &str| Matter { output: End::new("cloud", "volume"), grid: Some(grid.to_owned()) };
        assert_eq!(matter(&document), shown("density"));
        document.set(catalog(), "seen.grid", "heat").unwrap();
        assert_eq!(matter(&document), shown("heat"));
        let mut blind = document.clone();
        blind.wires.retain(|wire| wire.from.node != "camera");
        assert_eq!(source(&blind), "bars.image");
    }

    #[test]
    fn a_camera_is_where_it_is_at_the_frame() {
        let mut document = document();
        let keys = r#"{"keys": [[10, [0, 0, 4]], [20, [2, 0, 4]]]}"#;
        document.set(catalog(), "camera.position", keys).unwrap();
        let x = |frame: Option<i64>| {
            let document = Document { frame, ..document.clone() };
            camera(&document, "camera").unwrap().position.x
        };
        assert_eq!([None, Some(10), Some(15), Some(30)].map(x), [0.0, 0.0, 1.0, 2.0]);
        assert_eq!(camera(&document, "march"), None);
        document.nodes["camera"].params.insert("fov_y_deg".to_owned(), 999.into());
        assert_eq!(camera(&document, "camera"), None);
    }

    #[test]
    fn an_edit_changes_what_is_below() {
        let (before, mut after) = (document(), document());
        after.set(catalog(), "medium.g", "0.5").unwrap();
        let mut names: Vec<&str> = changed(&before, &after).into_iter().collect();
        names.sort_unstable();
        assert_eq!(names, ["march", "medium", "save", "tone"]);
        let mut unwired = document();
        unwired.wires.retain(|wire| wire.from.node != "camera");
        assert!(
            changed(&before, &unwired).contains("march") && !changed(&before, &unwired).contains("medium")
        );
        assert!(changed(&before, &document()).is_empty());
    }
}
