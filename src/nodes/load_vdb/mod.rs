//! `load_vdb`: an OpenVDB file, or one frame of a numbered sequence.

use std::path::PathBuf;

use super::{NodeKind, Rules, Run, transform};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, Params, PortSpec, PortType, Timing, Value};
use crate::volume::sequence::{Playback, Sequence};
use crate::volume::{Volume, vdb};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "load_vdb",
    version: 2,
    category: Category::Volume,
    purpose: "Reads an OpenVDB file, or one frame of a numbered sequence of them.",
    doc: "`path` is a file, a pattern such as smoke_####.vdb, or a folder that holds one numbered sequence. \
          Grids are decoded when a medium asks for them by name.",
    inputs: &[],
    outputs: &[PortSpec::new("volume", PortType::Volume, "all grids of the file")],
    params: &[
        ParamSpec::path("path").endings(vdb::ENDINGS).doc("A .vdb file, a pattern with ####, or a folder."),
        ParamSpec::int("frame", 0)
            .or_null()
            .timed(Timing::Frame)
            .doc("Frame of the scene; null is the sequence's first. Set by render --frames."),
        ParamSpec::int("first_frame", 0)
            .or_null()
            .doc("The scene's frame at which the sequence begins; null is its own first number."),
        ParamSpec::int("offset", 0).soft(-100.0, 100.0).doc("Added to the frame."),
        ParamSpec::bool("loop", false).doc("After its last frame the sequence begins again."),
        ParamSpec::bool("hold", false).timed(Timing::Aside).doc(
            "A frame that is not there is the one before it that is, else the first. Where light_decomposition looks \
             at other frames than the one that is rendered, it is so without being said.",
        ),
        transform::PARAM,
    ],
};

/// The file that these parameters mean.
fn file(params: &Params) -> Result<PathBuf, NodeError> {
    let whole = |name: &str| params.is_set(name).then(|| params.i64(name));
    Sequence::find(params.path("path"))
        .and_then(|sequence| {
            sequence.file(
                whole("frame"),
                Playback {
                    first_frame: whole("first_frame"),
                    offset: params.i64("offset"),
                    loops: params.bool("loop"),
                    holds: params.bool("hold"),
                },
            )
        })
        .map_err(NodeError::new)
}

fn files(params: &Params) -> Result<Vec<PathBuf>, NodeError> {
    Ok(vec![file(params)?])
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let path = file(run.params)?;
    let file = vdb::File::open(&path).map_err(NodeError::new)?;
    let volume = Volume::from_file(file, transform::read(run.params)?);
    Ok(vec![Value::measured(PortType::Volume, volume, Volume::bytes)])
}
