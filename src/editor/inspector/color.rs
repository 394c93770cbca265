//! Colors: linear Rec. 709 light, which may exceed 1.
//!
//! A picker knows 0 to 1 alone. So a color is shown as a strength (its largest component) times a color whose largest
//! component is 1; a share, which is bounded by 1 (an albedo), is the picker's color as it is.

use egui::{Ui, color_picker::color_edit_button_rgb};

use super::number::{entry, named, text_of};
use super::row::{LETTER, column, component};
use super::slot::Slot;

/// A swatch that opens a picker, the strength, and the three numbers.
pub fn show(ui: &mut Ui, slot: &mut Slot) -> Option<String> {
    let mut message = None;
    ui.horizontal(|ui| {
        let Split { strength, color, shown, picks } = split(slot);
        let mut picked = shown.map(|x| x as f32);
        let response = color_edit_button_rgb(ui, &mut picked);
        named(&response, &format!("{} picker", slot.name()));
        // The picker's way there and back through hue and saturation is not exact: only a change counts.
        if response.changed() {
            // Four digits are finer than a picker's 8 bits.
            let picked = picked.map(|x| picks * f64::from((x * 1e4).round()) / 1e4);
            message = slot.set_numbers(&picked, Some(slot.id().with("picker"))).err();
        }
        if is_share(slot) {
            return;
        }
        ui.weak("strength");
        let (id, name) = (slot.id().with("strength"), format!("{}.strength", slot.name()));
        let typed = entry(ui, id, &name, &text_of(strength), 64.0, |text| {
            let wanted = super::expression::evaluate(text)?;
            slot.set_numbers(&color.map(|x| x * wanted), None)
        });
        message = message.take().or(typed);
    });
    ui.horizontal(|ui| {
        let width = column(ui, 3) - LETTER;
        for (part, label) in ["r", "g", "b"].into_iter().enumerate() {
            let changed = component(ui, slot, part, label, width);
            message = message.take().or(changed);
        }
    });
    message
}

fn is_share(slot: &Slot) -> bool {
    slot.spec.hard.max.is_some_and(|max| max <= 1.0)
}

/// A color as strength times color.
struct Split {
    /// The largest component.
    strength: f64,
    /// What a strength multiplies.
    color: [f64; 3],
    /// What the swatch shows.
    shown: [f64; 3],
    /// What a picked color is multiplied by.
    picks: f64,
}

/// Black is given a strength as white is, and takes a picked color as it is: else it would stay black.
fn split(slot: &Slot) -> Split {
    let values = slot.numbers();
    let rgb = [values[0], values[1], values[2]];
    let largest = rgb.iter().copied().fold(0.0, f64::max);
    match () {
        () if is_share(slot) => Split { strength: 1.0, color: rgb, shown: rgb, picks: 1.0 },
        () if largest <= 0.0 => Split { strength: 0.0, color: [1.0; 3], shown: [0.0; 3], picks: 1.0 },
        () => {
            let color = rgb.map(|x| (x / largest).max(0.0));
            Split { strength: largest, color, shown: color, picks: largest }
        }
    }
}
