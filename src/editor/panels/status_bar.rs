//! The line at the bottom: what runs, what it costs, on which device, and what is wrong with it.

use egui::{Align, Layout, Sense, Shape, Stroke, Ui, Vec2, vec2};

/// What the bar shows.
#[derive(Debug, Clone, Default)]
pub struct Figures {
    /// Name of the device.
    pub adapter: Option<String>,
    /// The node that runs.
    pub running: Option<String>,
    /// Nodes that are done, and all that are needed.
    pub progress: [usize; 2],
    /// Of the last whole picture, in ms.
    pub picture_ms: Option<f64>,
    /// Of the last picture while something was dragged, in ms.
    pub preview_ms: Option<f64>,
    /// On the device, in bytes.
    pub gpu_bytes: u64,
    /// In the cache, in bytes.
    pub cache_bytes: u64,
    /// What is wrong with the device, and whether it is tried again by itself.
    pub trouble: Option<(String, bool)>,
    /// Nodes that failed.
    pub n_failed: usize,
}

/// Draws the bar; says whether to try again.
pub fn show(ui: &mut Ui, figures: &Figures) -> bool {
    let mut retries = false;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        if let Some((message, by_itself)) = &figures.trouble {
            ui.colored_label(ui.visuals().error_fg_color, message);
            if *by_itself {
                ui.weak("starting again …");
            } else {
                retries = ui.button("Try again").clicked();
            }
        } else if let Some(name) = &figures.running {
            turning(ui);
            let [done, all] = figures.progress;
            ui.label(format!("{name}  {done}/{all}"));
        } else if figures.n_failed > 0 {
            let nodes = if figures.n_failed == 1 {
                "1 node failed".to_owned()
            } else {
                format!("{} nodes failed", figures.n_failed)
            };
            ui.colored_label(ui.visuals().error_fg_color, nodes);
        } else {
            ui.weak("Ready");
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 14.0;
            match &figures.adapter {
                Some(name) => ui.weak(name),
                None => ui.weak("opening the device …"),
            };
            ui.weak(format!("GPU {}", size(figures.gpu_bytes))).on_hover_text("Held on the device");
            ui.weak(format!("cache {}", size(figures.cache_bytes)))
                .on_hover_text("Results that need not be computed again");
            if let Some(ms) = figures.picture_ms {
                ui.weak(format!("picture {}", time(ms))).on_hover_text("Time of the last whole picture");
            }
            if let Some(ms) = figures.preview_ms {
                ui.weak(format!("{:.1}/s", 1e3 / ms.max(1e-3)))
                    .on_hover_text("Pictures a second while dragging");
            }
        });
    });
    retries
}

/// With a unit that leaves three digits.
pub fn time(ms: f64) -> String {
    match ms {
        ms if ms < 10.0 => format!("{ms:.1} ms"),
        ms if ms < 1000.0 => format!("{ms:.0} ms"),
        ms => format!("{:.1} s", ms / 1e3),
    }
}

/// With a unit that leaves three digits: "3.4 MiB".
pub fn size(n_bytes: u64) -> String {
    let units = ["B", "KiB", "MiB", "GiB", "TiB"];
    let (mut size, mut unit) = (n_bytes as f64, 0);
    while size >= 1000.0 && unit + 1 < units.len() {
        (size, unit) = (size / 1024.0, unit + 1);
    }
    let digits = usize::from(unit > 0 && size < 10.0);
    format!("{size:.digits$} {}", units[unit])
}

/// Something runs: an arc that turns twice a second. One that turns smoothly would have the window drawn as often as
/// the screen shows it, and where there is no GPU that takes the cores that compute.
fn turning(ui: &mut Ui) {
    const STEP_SECS: f64 = 0.5;
    let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
    let steps = (ui.input(|input| input.time) / STEP_SECS).floor() % 8.0;
    let angle = |n: u8| (steps as f32 + 0.75 * f32::from(n)) * std::f32::consts::FRAC_PI_4;
    let arc = (0..=8).map(|n| rect.center() + 5.0 * Vec2::angled(angle(n))).collect();
    ui.painter().add(Shape::line(arc, Stroke::new(1.5, ui.visuals().strong_text_color())));
    ui.ctx().request_repaint_after_secs(STEP_SECS as f32);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_short() {
        assert_eq!([time(4.25), time(42.0), time(4200.0)], ["4.2 ms", "42 ms", "4.2 s"]);
        assert_eq!(
            [size(0), size(999), size(3_565_158), size(123 << 30)],
            ["0 B", "999 B", "3.4 MiB", "123 GiB"]
        );
    }
}
