//! The phases of a simulation (docs/method.md#74-phases).

use super::error::SimError;
use crate::model::{scenario::SimulationSettings, trace::Phase};

/// Time in which the grippers close, s, at most a tenth of the time before the load. Grippers that close at once knock
/// light boards and small pads: faces penetrate by up to 0.6 mm in the first 20 ms. With 50 ms they do not penetrate
/// deeper than under the grip force at rest.
const GRIP_S: f64 = 0.05;

/// The largest number of steps: that of a scenario at a quarter of its time step, as a confirmation may need.
const MOST_STEPS: usize = 4 * SimulationSettings::MAX_STEPS;

/// The number of steps in which the grippers close.
pub(super) fn grip_steps(settings: &SimulationSettings) -> usize {
    (GRIP_S.min(settings.settle_s / 10.0) / settings.timestep_s).round() as usize
}

/// The ramp of the load over the steps of a simulation: 0 while the grippers close and the board settles, linear in the
/// ramp, 1 in the hold, 0 after the release.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PhaseSchedule {
    /// The steps in which the grippers close, part of `settle`.
    grip: usize,
    settle: usize,
    ramp: usize,
    hold: usize,
    release: usize,
}

impl PhaseSchedule {
    /// The schedule of these settings, each phase rounded to whole steps.
    ///
    /// # Errors
    /// [`SimError::Settings`] if the time step is not positive or longer than 4 ms, a phase is negative or not finite,
    /// or the simulation is longer than 400 000 steps.
    pub fn new(settings: &SimulationSettings) -> Result<Self, SimError> {
        let SimulationSettings { settle_s, ramp_s, hold_s, release_s, timestep_s } = *settings;
        if !(timestep_s > 0.0 && timestep_s <= SimulationSettings::MAX_TIMESTEP_S) {
            let expected = "a positive time of at most 0.004 s";
            return Err(SimError::Settings { key: "timestep_s", found: timestep_s, expected });
        }
        let steps = |key, duration_s: f64| {
            if duration_s.is_finite() && duration_s >= 0.0 {
                // The cast saturates; the value is not negative.
                Ok((duration_s / timestep_s).round() as usize)
            } else {
                Err(SimError::Settings { key, found: duration_s, expected: "a time of at least zero" })
            }
        };
        let profile = Self {
            grip: grip_steps(settings),
            settle: steps("settle_s", settle_s)?,
            ramp: steps("ramp_s", ramp_s)?,
            hold: steps("hold_s", hold_s)?,
            release: steps("release_s", release_s)?,
        };
        if profile.steps() > MOST_STEPS {
            let found = settle_s + ramp_s + hold_s + release_s;
            return Err(SimError::Settings { key: "duration in s", found, expected: "at most 400000 time steps" });
        }
        Ok(profile)
    }

    /// The number of steps.
    pub fn steps(&self) -> usize {
        self.settle.saturating_add(self.ramp).saturating_add(self.hold).saturating_add(self.release)
    }

    /// The number of steps before the load.
    pub fn settle_steps(&self) -> usize {
        self.settle
    }

    /// The number of steps of the ramp.
    pub fn ramp_steps(&self) -> usize {
        self.ramp
    }

    /// The phase and the multiple of the operation's wrench in a step. Steps count from 1; 0 is the initial state.
    pub fn at(&self, step: usize) -> (Phase, f64) {
        let ramp_end = self.settle + self.ramp;
        if step <= self.grip && self.grip > 0 {
            (Phase::Grip, 0.0)
        } else if step <= self.settle {
            (Phase::Settle, 0.0)
        } else if step <= ramp_end {
            (Phase::Ramp, (step - self.settle) as f64 / self.ramp as f64)
        } else if step <= ramp_end + self.hold {
            (Phase::Hold, 1.0)
        } else {
            (Phase::Release, 0.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(settle_s: f64, ramp_s: f64) -> PhaseSchedule {
        PhaseSchedule::new(&SimulationSettings { settle_s, ramp_s, hold_s: 1.0, release_s: 0.5, timestep_s: 0.002 })
            .unwrap()
    }

    #[test]
    fn the_load_increases_linearly_to_one_and_is_released() {
        let profile = profile(0.5, 1.0);
        assert_eq!(profile.steps(), 1500);
        assert_eq!(profile.at(25), (Phase::Grip, 0.0));
        assert_eq!(profile.at(26), (Phase::Settle, 0.0));
        assert_eq!(profile.at(250), (Phase::Settle, 0.0));
        assert_eq!(profile.at(500), (Phase::Ramp, 0.5));
        assert_eq!(profile.at(750), (Phase::Ramp, 1.0));
        assert_eq!(profile.at(1250), (Phase::Hold, 1.0));
        assert_eq!(profile.at(1251), (Phase::Release, 0.0));
    }

    #[test]
    fn without_a_ramp_the_whole_load_acts_at_once() {
        assert_eq!(profile(0.5, 0.0).at(251), (Phase::Hold, 1.0));
    }

    #[test]
    fn invalid_settings_are_refused() {
        for timestep_s in [0.0, -0.002, 0.005, f64::NAN, f64::INFINITY] {
            let settings = SimulationSettings { timestep_s, ..SimulationSettings::default() };
            assert!(matches!(PhaseSchedule::new(&settings), Err(SimError::Settings { key: "timestep_s", .. })));
        }
        let settings = SimulationSettings { hold_s: -1.0, ..SimulationSettings::default() };
        assert!(matches!(PhaseSchedule::new(&settings), Err(SimError::Settings { key: "hold_s", .. })));
        let settings = SimulationSettings { hold_s: 1e300, ..SimulationSettings::default() };
        assert!(matches!(PhaseSchedule::new(&settings), Err(SimError::Settings { key: "duration in s", .. })));
    }
}
