//! How far a picture is, on a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Parts of the whole that the bar tells apart.
const STEPS: u64 = 1000;

/// A bar on standard error, which is there only if that is a terminal.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// An empty bar.
    pub fn new(what: &'static str) -> Progress {
        // `ProgressBar` draws on standard error, and nothing where that is no terminal.
        let bar = ProgressBar::new(STEPS).with_message(what);
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3}% {eta:>4}");
        bar.set_style(style.expect("the template is well formed"));
        bar.enable_steady_tick(Duration::from_millis(200));
        Progress { bar }
    }

    /// Shows which part is done, 0 to 1; the bar never goes back.
    pub fn show(&self, part: f64) {
        let position = (part * STEPS as f64) as u64;
        if position > self.bar.position() {
            self.bar.set_position(position);
        }
    }

    /// Takes the bar away.
    pub fn end(self) {
        self.bar.finish_and_clear();
    }
}
