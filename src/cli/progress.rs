//! Progress of a run on standard error: a line for each finished scenario and, on a terminal, a progress bar.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::output;
use crate::report::{Outcome, console};

/// Interval at which the bar is redrawn.
const TICK: Duration = Duration::from_millis(200);

/// Progress lines and bar.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Progress of `scenarios` scenarios.
    pub fn new(scenarios: usize) -> Self {
        // indicatif hides the bar if standard error is not a terminal.
        let bar = ProgressBar::new(scenarios as u64);
        if let Ok(style) = ProgressStyle::with_template("{spinner} [{bar:30}] {pos}/{len}  {elapsed}  {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        if !bar.is_hidden() {
            bar.enable_steady_tick(TICK);
        }
        Self { bar }
    }

    /// Shows that a scenario has started.
    pub fn begins(&self, name: &str) {
        self.bar.set_message(name.to_owned());
    }

    /// Shows that a scenario has finished after `wall_s` seconds.
    pub fn ends(&self, outcome: &Outcome, wall_s: f64) {
        self.advances(Some(&format!("{} ({wall_s:.1} s)", console::line(outcome))));
    }

    /// Advances the bar by one and prints a line, if there is one.
    pub fn advances(&self, line: Option<&str>) {
        self.bar.inc(1);
        match line {
            Some(line) if self.bar.is_hidden() => output::message(line),
            Some(line) => self.bar.println(line),
            None => {}
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
