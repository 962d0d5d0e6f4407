//! What is seen of a run while it lasts, on standard error: a line for each scenario that ends and, on a terminal, a bar.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::output;
use crate::report::{Outcome, console};

/// The bar redraws so often while nothing ends, to show that it lives.
const TICK: Duration = Duration::from_millis(200);

/// The lines and the bar.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Begins with this many scenarios to go.
    pub fn new(scenarios: usize) -> Self {
        // Hidden by itself where standard error is no terminal.
        let bar = ProgressBar::new(scenarios as u64);
        if let Ok(style) = ProgressStyle::with_template("{spinner} [{bar:30}] {pos}/{len}  {elapsed}  {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        if !bar.is_hidden() {
            bar.enable_steady_tick(TICK);
        }
        Self { bar }
    }

    /// A scenario's turn has come.
    pub fn begins(&self, name: &str) {
        self.bar.set_message(name.to_owned());
    }

    /// A scenario has ended after so many seconds.
    pub fn ends(&self, outcome: &Outcome, wall_s: f64) {
        self.advances(Some(&format!("{} ({wall_s:.1} s)", console::line(outcome))));
    }

    /// Something has ended, and this is to be said of it.
    pub fn advances(&self, line: Option<&str>) {
        self.bar.inc(1);
        match line {
            Some(line) if self.bar.is_hidden() => output::message(line),
            Some(line) => self.bar.println(line),
            None => {}
        }
    }

    /// All is over: the bar goes, the lines stay.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
