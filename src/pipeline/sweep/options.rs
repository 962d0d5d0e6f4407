//! What a caller asks of a sweep in place of what the scenario says.

use crate::{
    model::{scenario::Scenario, sweep::Sweep},
    robot::Robot,
    scenario::{InputError, usual_sweep},
    sweep::screen::Screen,
};

/// What a caller asks of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepOptions {
    /// The number of runs; `None` for the scenario's.
    pub runs: Option<u64>,
    /// The seed of the draws; `None` for the scenario's.
    pub seed: Option<u64>,
    /// The width of the interval at which the sweep ends before all runs are done, from 0.0001 to 1.
    pub until: Option<f64>,
    /// True if every run is simulated, also those that the statics would decide.
    pub all: bool,
    /// The share of the runs, from 0 to 1, that is simulated as a check though the statics would decide them.
    pub audit: f64,
}

impl Default for SweepOptions {
    fn default() -> Self {
        Self { runs: None, seed: None, until: None, all: false, audit: Screen::AUDIT_SHARE }
    }
}

/// An option that is not valid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name}: found {found}, expected {expected}")]
pub struct OptionError {
    /// The option.
    pub name: &'static str,
    /// Its value.
    pub found: String,
    /// What it should be.
    pub expected: String,
}

impl SweepOptions {
    /// Requires valid options.
    ///
    /// # Errors
    /// If a number is out of its range.
    pub fn check(&self) -> Result<(), OptionError> {
        let within = |name, found: f64, low: f64, high: f64| {
            let expected = format!("a number from {low} to {high}");
            if (low..=high).contains(&found) {
                Ok(())
            } else {
                Err(OptionError { name, found: found.to_string(), expected })
            }
        };
        within("audit", self.audit, 0.0, 1.0)?;
        self.until.map_or(Ok(()), |width| within("until", width, 1e-4, 1.0))?;
        match self.runs {
            Some(runs) if !(1..=Sweep::MOST_RUNS).contains(&runs) => {
                let expected =
                    if runs == 0 { "at least 1".to_owned() } else { format!("at most {}", Sweep::MOST_RUNS) };
                Err(OptionError { name: "runs", found: runs.to_string(), expected })
            }
            _ => Ok(()),
        }
    }

    /// The sweep of a scenario with these options; that of the preset `workshop` for a scenario without one.
    ///
    /// # Errors
    /// If the preset does not fit the scenario.
    pub fn sweep_of(&self, scenario: &Scenario, robot: &Robot) -> Result<Sweep, InputError> {
        let mut sweep = match &scenario.sweep {
            Some(sweep) => sweep.clone(),
            None => usual_sweep(scenario, robot)?,
        };
        sweep.runs = self.runs.unwrap_or(sweep.runs);
        sweep.seed = self.seed.unwrap_or(sweep.seed);
        Ok(sweep)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_are_refused_with_their_option() {
        let usual = SweepOptions::default();
        assert_eq!(usual.check(), Ok(()));
        for (options, text) in [
            (SweepOptions { audit: 1.5, ..usual }, "audit: found 1.5, expected a number from 0 to 1"),
            (SweepOptions { until: Some(0.0), ..usual }, "until: found 0, expected a number from 0.0001 to 1"),
            (SweepOptions { runs: Some(0), ..usual }, "runs: found 0, expected at least 1"),
            (SweepOptions { until: Some(f64::NAN), ..usual }, "until: found NaN, expected a number from 0.0001 to 1"),
        ] {
            assert_eq!(options.check().unwrap_err().to_string(), text);
        }
        let many = SweepOptions { runs: Some(Sweep::MOST_RUNS + 1), ..usual };
        assert!(many.check().unwrap_err().to_string().ends_with(&format!("at most {}", Sweep::MOST_RUNS)));
    }
}
