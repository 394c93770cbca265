//! The bar that shows how far a render is: on a terminal alone, on stderr.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use tyndall::graph::Event;

use super::output;

/// A bar that counts nodes.
pub struct Progress {
    bar: ProgressBar,
    frame: String,
}

impl Progress {
    /// For so many runs of nodes in all.
    pub fn new(n_runs: usize) -> Self {
        // It hides itself where stderr is no terminal.
        let bar = ProgressBar::new(n_runs as u64);
        let style = ProgressStyle::with_template("{elapsed:>4} [{bar:30}] {pos}/{len} {msg}");
        bar.set_style(style.expect("a constant template").progress_chars("=> "));
        if !bar.is_hidden() {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        Self { bar, frame: String::new() }
    }

    /// What follows belongs to this frame; so many runs of nodes are still to come.
    pub fn begin_frame(&mut self, frame: i64, n_left: usize) {
        self.bar.set_length(self.bar.position() + n_left as u64);
        self.frame = format!("frame {frame}: ");
    }

    /// What a node does.
    pub fn show(&self, event: &Event) {
        match event {
            Event::Started { name } => self.bar.set_message(format!("{}{name}", self.frame)),
            Event::Finished { .. } | Event::Failed { .. } | Event::Skipped { .. } => self.bar.inc(1),
            Event::Cancelled => {}
        }
    }

    /// Prints a line of the result above the bar.
    ///
    /// # Errors
    /// As [`output::print`].
    pub fn print(&self, line: &str) -> anyhow::Result<()> {
        self.bar.suspend(|| output::print(&format!("{line}\n")))
    }

    /// Prints complaints above the bar.
    pub fn complain(&self, lines: &output::Lines) {
        self.bar.suspend(|| output::complain(lines));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
