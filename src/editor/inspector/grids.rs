//! Names of grids: typed, or chosen from what the wired file holds.
//!
//! Read from the file's head alone, and kept by path, size and time, so that a menu costs nothing while it is open.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use egui::Ui;

use super::number::{entry, named};
use super::slot::Slot;
use crate::graph::{Document, FileState, Moment, Params, PortType, flatten};
use crate::nodes;
use crate::volume::vdb::{self, MetaValue};

/// A grid as the menu shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// As a parameter takes it.
    pub name: String,
    /// Its type and how many voxels its file says that it has.
    pub about: String,
}

type Found = Result<Vec<Choice>, String>;
type Known = Arc<Mutex<HashMap<PathBuf, (FileState, Found)>>>;

/// A field, and a menu of what is there.
pub fn show(ui: &mut Ui, slot: &mut Slot, width: f32) -> Option<String> {
    let current = slot.json().as_str().unwrap_or_default().to_owned();
    let (id, name) = (slot.id().with("grid"), slot.name());
    let typed = entry(ui, id, &name, &current, width - 30.0, |text| slot.set(text.into(), None));
    let mut chosen = None;
    let menu = ui.menu_button("⏷", |ui| {
        let document = flatten(slot.document(), nodes::catalog());
        match choices(ui, &document, slot.node(), slot.moment()) {
            Ok(grids) => {
                for grid in grids {
                    let text = format!("{}   {}", grid.name, grid.about);
                    if ui.selectable_label(grid.name == current, text).clicked() {
                        chosen = Some(grid.name);
                        ui.close();
                    }
                }
            }
            Err(message) => drop(ui.weak(message)),
        }
    });
    named(&menu.response, &format!("{name} menu"));
    let chosen = chosen.and_then(|chosen| slot.set(chosen.into(), None).err());
    typed.or(chosen)
}

/// The grids of the volume that a node of a document without groups reads, or why none are known.
///
/// # Errors
/// Where no volume is wired, or its file cannot be read.
pub fn choices(ui: &Ui, document: &Document, node: &str, moment: Moment) -> Found {
    let Some(path) = file(document, node, moment)? else {
        return Ok(vec![Choice { name: "density".to_owned(), about: "shape".to_owned() }]);
    };
    let known: Known =
        ui.data_mut(|data| data.get_temp_mut_or_default::<Known>(egui::Id::new("grids")).clone());
    let mut known =
        known.lock().map_err(|_| "the names of grids were lost; open the graph again".to_owned())?;
    if let Some((state, found)) = known.get(&path)
        && state.holds()
    {
        return found.clone();
    }
    let state = FileState::of(&path);
    let found = read(&path);
    known.insert(path, (state, found.clone()));
    found
}

/// The grids of a file, from its head.
fn read(path: &Path) -> Found {
    let file = vdb::File::open(path).map_err(|error| error.to_string())?;
    let readable = file.grids.iter().filter(|grid| grid.refused.is_none());
    let choice = |grid: &vdb::Entry| {
        let voxels = match grid.metadata.get("file_voxel_count") {
            Some(MetaValue::Int(n)) => format!(", {n} voxels"),
            _ => String::new(),
        };
        Choice { name: grid.name.clone(), about: format!("{}{voxels}", grid.kind) }
    };
    Ok(readable.map(choice).collect())
}

/// The file whose volume reaches a node; `None` for a shape.
fn file(document: &Document, node: &str, moment: Moment) -> Result<Option<PathBuf>, String> {
    let mut name = node;
    // A chain cannot be longer than there are nodes, unless it is a circle.
    for _ in 0..document.nodes.len() {
        let spec = document.nodes.get(name).and_then(|node| nodes::kind(&node.type_id)).map(|kind| kind.spec);
        let spec = spec.ok_or_else(|| format!("'{name}' is of no known kind"))?;
        let input = spec.inputs.iter().find(|port| port.kind == PortType::Volume);
        let Some(input) = input else { break };
        let wire = document.wires.iter().find(|wire| wire.to.node == name && wire.to.port == input.name);
        let wire = wire.ok_or_else(|| format!("wire a volume to {name}.{} to see its grids", input.name))?;
        name = &wire.from.node;
    }
    let node = document.nodes.get(name).ok_or_else(|| format!("'{name}' is not there"))?;
    let kind = nodes::kind(&node.type_id).ok_or_else(|| format!("'{name}' is of no known kind"))?;
    let params =
        Params::resolve(kind.spec.params, &node.params, &document.base, moment).map_err(|problems| {
            problems.into_iter().map(|problem| problem.message).collect::<Vec<_>>().join("; ")
        })?;
    let files = (kind.files)(&params).map_err(|error| error.to_string())?;
    Ok(files.into_iter().next())
}
