//! The search for a node to add: by its id and what it is for, at the pointer.
//!
//! Letters must be found in order, in the id or in the purpose; those that stand at the start of a word or
//! follow each other count more. Opened for a wire, it offers what fits the wire and wires it. Tested by
//! orders of known queries.

use egui::{Area, Frame, Id, Key, Modifiers, Order, Pos2, RichText, ScrollArea, TextEdit, vec2};

use super::Canvas;
use super::desk::Desk;
use super::edge;
use super::scene::{Port, WIDTH};
use crate::graph::{Document, End, Node, NodeSpec, PortSpec, Side, Wire};
use crate::nodes::catalog;

/// An open search.
#[derive(Debug)]
pub struct Search {
    purpose: Purpose,
    /// Where it was opened, on the screen and on the canvas.
    at: Pos2,
    place: Pos2,
    text: String,
    chosen: usize,
    is_new: bool,
}

/// What the node is for.
#[derive(Debug, Clone, PartialEq)]
pub enum Purpose {
    Add,
    /// To be wired to this port.
    Connect(Port),
    /// To be put on this wire.
    Insert(Wire),
}

impl Purpose {
    /// Whether a node of this kind serves it.
    fn takes(&self, document: &Document, spec: &NodeSpec) -> bool {
        match self {
            Self::Add => true,
            Self::Connect(port) => matching_port(document, port, spec).is_some(),
            Self::Insert(wire) => {
                let from = Port { end: wire.from.clone(), side: Side::Output };
                let to = Port { end: wire.to.clone(), side: Side::Input };
                matching_port(document, &from, spec).is_some() && matching_port(document, &to, spec).is_some()
            }
        }
    }

    /// Adds a node at a place of the canvas, wires it, and says its name.
    ///
    /// # Errors
    /// Where the wire does not fit; the node is there nevertheless.
    fn add(&self, document: &mut Document, spec: &NodeSpec, place: Pos2) -> (String, Result<(), String>) {
        let place = [place.x.round(), place.y.round()].map(f64::from);
        let name = document.add_node(spec.id, Node::new(spec.id), place);
        let wired = match self {
            Self::Add => Ok(()),
            Self::Insert(wire) => document.insert_on(catalog(), wire, &name),
            Self::Connect(port) => match matching_port(document, port, spec) {
                None => Err(format!("{} fits nothing of {name}", port.label())),
                Some(own) => {
                    let own = End { node: name.clone(), port: own.name.to_owned() };
                    let (from, to) = match port.side {
                        Side::Output => (port.end.clone(), own),
                        Side::Input => (own, port.end.clone()),
                    };
                    edge::connect(document, Wire { from, to })
                }
            },
        };
        (name, wired)
    }
}

/// The first port of a kind that a wire from `port` may end at.
fn matching_port(document: &Document, port: &Port, spec: &NodeSpec) -> Option<&'static PortSpec> {
    let kind = edge::kind_of(document, port)?;
    let others = match port.side {
        Side::Output => spec.inputs,
        Side::Input => spec.outputs,
    };
    others.iter().find(|other| other.kind == kind)
}

/// How well a kind fits a query; `None` where letters are missing.
fn score(query: &str, spec: &NodeSpec) -> Option<i32> {
    let in_id = subsequence(query, spec.id).map(|score| score * 3 - spec.id.len() as i32 / 2);
    in_id.max(subsequence(query, spec.purpose).map(|score| score - 40))
}

/// The best way to find the letters of a query in order: 1 for a letter, 3 more for one at the start of a
/// word, 2 more for one that follows the last.
fn subsequence(query: &str, text: &str) -> Option<i32> {
    let text: Vec<char> = text.to_lowercase().chars().collect();
    let starts = |at: usize| at == 0 || !text[at - 1].is_alphanumeric();
    // For each letter of the text, the best of the query so far that ends there.
    let mut ends: Vec<Option<i32>> = Vec::new();
    for letter in query.to_lowercase().chars().filter(|letter| !letter.is_whitespace()) {
        let is_first = ends.is_empty();
        let mut before = is_first.then_some(0);
        let next = (0..text.len()).map(|at| {
            let follows = at.checked_sub(1).and_then(|last| *ends.get(last)?).map(|score| score + 2);
            let found = before.max(follows).filter(|_| text[at] == letter);
            if !is_first {
                before = before.max(ends[at]);
            }
            found.map(|score| score + 1 + 3 * i32::from(starts(at)))
        });
        ends = next.collect();
    }
    if ends.is_empty() { Some(0) } else { ends.into_iter().max().flatten() }
}

/// The kinds that fit a query, the best first, in the menu's order among equals.
fn found(query: &str, purpose: &Purpose, document: &Document) -> Vec<&'static NodeSpec> {
    let kinds = catalog().0.iter().copied().filter(|spec| purpose.takes(document, spec));
    let mut scored: Vec<_> = kinds.filter_map(|spec| Some((score(query, spec)?, spec))).collect();
    if !query.trim().is_empty() {
        scored.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
    }
    scored.into_iter().map(|(_, spec)| spec).collect()
}

impl Canvas {
    /// Opens the search at the pointer, or in the middle where the pointer is elsewhere.
    pub(super) fn open_search(&mut self, purpose: Purpose) {
        let screen = self.screen.unwrap_or(egui::Rect::NOTHING);
        let at = if screen.contains(self.pointer) { self.pointer } else { screen.center() };
        let place = self.view.to_canvas(at);
        self.search = Some(Search { purpose, at, place, text: String::new(), chosen: 0, is_new: true });
    }

    pub(super) fn show_search(&mut self, ui: &egui::Ui, desk: &mut Desk) {
        let Some(mut search) = self.search.take() else { return };
        let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        if pressed(Key::Escape) {
            return;
        }
        let kinds = found(&search.text, &search.purpose, desk.document());
        let last = kinds.len().saturating_sub(1);
        if pressed(Key::ArrowDown) {
            search.chosen += 1;
        }
        if pressed(Key::ArrowUp) {
            search.chosen = search.chosen.saturating_sub(1);
        }
        search.chosen = search.chosen.min(last);
        let mut taken = kinds.get(search.chosen).copied().filter(|_| pressed(Key::Enter));
        let screen = self.screen.unwrap_or(egui::Rect::EVERYTHING);
        let area = Area::new(Id::new("canvas search")).order(Order::Foreground).fixed_pos(search.at);
        let shown = area.constrain_to(screen.shrink(4.0)).show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(300.0);
                let field = TextEdit::singleline(&mut search.text)
                    .hint_text("add a node")
                    .id(Id::new("canvas search text"))
                    .desired_width(f32::INFINITY);
                let field = ui.add(field);
                if std::mem::take(&mut search.is_new) {
                    field.request_focus();
                }
                if field.changed() {
                    search.chosen = 0;
                }
                ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
                    for (idx, spec) in kinds.iter().enumerate() {
                        if self.kind_line(ui, spec, idx == search.chosen) {
                            taken = Some(spec);
                        }
                    }
                    if kinds.is_empty() {
                        ui.weak("nothing is called or does so");
                    }
                });
            });
        });
        let pressed_elsewhere = ui.input(|input| {
            let at = input.pointer.interact_pos();
            input.pointer.any_pressed() && at.is_some_and(|at| !shown.response.rect.contains(at))
        });
        match taken {
            Some(spec) => self.add_found(ui, &search, spec, desk),
            None if pressed_elsewhere => {}
            None => self.search = Some(search),
        }
    }

    /// Whether the line of a kind was clicked.
    fn kind_line(&self, ui: &mut egui::Ui, spec: &NodeSpec, is_chosen: bool) -> bool {
        let theme = super::theme::Theme::of(ui);
        let mut text = egui::text::LayoutJob::default();
        let style = ui.style();
        RichText::new(spec.id).color(theme.text).append_to(
            &mut text,
            style,
            Default::default(),
            egui::Align::Center,
        );
        let purpose = RichText::new(format!("  {}", spec.purpose)).small().color(theme.weak);
        purpose.append_to(&mut text, style, Default::default(), egui::Align::Center);
        text.wrap.max_rows = 1;
        let line = ui.horizontal(|ui| {
            let (mark, _) = ui.allocate_exact_size(vec2(6.0, 14.0), egui::Sense::hover());
            ui.painter().rect_filled(mark, 2.0, theme.category(Some(spec.category)));
            // What is right of a text pushes it to the left; else it stands in the middle.
            let button = egui::Button::selectable(is_chosen, text).truncate().right_text("");
            let button = ui.add(button.min_size(vec2(ui.available_width(), 20.0)));
            let label = || format!("add {}", spec.id);
            button.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, label()));
            button
        });
        let button = line.inner;
        if is_chosen && ui.input(|input| input.key_down(Key::ArrowDown) || input.key_down(Key::ArrowUp)) {
            button.scroll_to_me(None);
        }
        button.clicked()
    }

    fn add_found(&mut self, ui: &egui::Ui, search: &Search, spec: &NodeSpec, desk: &mut Desk) {
        let place = match &search.purpose {
            // Its port should stand where the wire was dropped.
            Purpose::Connect(Port { side: Side::Output, .. }) => search.place - vec2(0.0, 40.0),
            Purpose::Connect(_) => search.place - vec2(WIDTH, 40.0),
            _ => search.place - vec2(WIDTH / 2.0, 14.0),
        };
        let scene = self.scene.clone();
        let mut added = None;
        desk.edit(&format!("Add {}", spec.id), |document| {
            Self::pin(&scene, document);
            added = Some(search.purpose.add(document, spec, place));
        });
        let Some((name, wired)) = added else { return };
        desk.selection.only(&name);
        self.focus_next = Some(name.clone());
        if let Err(reason) = wired {
            self.tell(ui, reason);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(query: &str, purpose: &Purpose, document: &Document) -> Vec<&'static str> {
        found(query, purpose, document).iter().map(|spec| spec.id).collect()
    }

    #[test]
    fn the_best_comes_first() {
        let first = |query: &str| ids(query, &Purpose::Add, &Document::default())[0];
        assert_eq!(first("sun"), "sun");
        assert_eq!(first("pp"), "principal_propagation");
        assert_eq!(first("ld"), "light_decomposition");
        assert_eq!(first("vdb"), "load_vdb");
        assert_eq!(first("march"), "raymarch");
        assert_eq!(first("tone"), "tone_map");
        assert!(ids("xyzzy", &Purpose::Add, &Document::default()).is_empty());
        assert_eq!(ids("", &Purpose::Add, &Document::default()).len(), catalog().0.len());
    }

    #[test]
    fn only_what_fits_is_offered_and_it_is_wired() {
        let text = r#"{"tyndall": 1, "nodes": {"sun": {"type": "sun"}, "split": {"type": "light_decomposition"}},
            "wires": ["sun.light -> split.lights"]}"#;
        let mut document = Document::parse(text, std::path::Path::new("")).unwrap();
        let port = Port { end: "sun.light".parse().unwrap(), side: Side::Output };
        let purpose = Purpose::Connect(port);
        assert_eq!(ids("", &purpose, &document), ["light_decomposition", "spherical_propagation"]);
        let spec = catalog().find("spherical_propagation").unwrap();
        let (name, wired) = purpose.add(&mut document, spec, Pos2::new(7.2, 8.0));
        assert_eq!((name.as_str(), wired), ("spherical_propagation", Ok(())));
        assert_eq!(document.wires[1].to_string(), "sun.light -> spherical_propagation.lights");
        assert_eq!(document.layout["spherical_propagation"], [7.0, 8.0]);
        let into = Purpose::Connect(Port { end: "split.lights".parse().unwrap(), side: Side::Input });
        assert_eq!(ids("", &into, &document), ["sun", "point_light", "bounce_lights"]);
        let (name, wired) = into.add(&mut document, catalog().find("sun").unwrap(), Pos2::ZERO);
        assert_eq!((name.as_str(), wired), ("sun_2", Ok(())));
        assert_eq!(document.wires[2].to_string(), "sun_2.light -> split.lights");
        // Nothing takes light and gives it.
        assert!(ids("", &Purpose::Insert(document.wires[0].clone()), &document).is_empty());
    }
}
