//! Which runs the statics decide without a simulation (`docs/method.md#104-screening-and-intervals`).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::points::Points;
use crate::model::sweep::Sampling;

/// The predicted load factor, corrected by [`Screen::ratio`], from which on a run counts as one that holds. The simulated failing
/// load of a run differs from the corrected prediction by a few per cent.
const HOLDS_FROM: f64 = 1.12;

/// Distinguishes the choice of audited runs from the draws.
const AUDIT_STREAM: u64 = 0x6175_6469_7400_0000;

/// How runs are screened: one whose corrected load factor is far above 1 holds without a simulation, but for a random share of
/// these runs, which is simulated all the same. Runs that may fail are all simulated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Screen {
    /// Simulated failing load of the plan without deviations, divided by its predicted load factor.
    pub ratio: f64,
    /// The share of the runs that is simulated whatever the prediction is, from 0 to 1.
    pub audit_share: f64,
    /// The seed of their choice.
    pub seed: u64,
}

impl Screen {
    /// The largest share of mistakes among screened runs that was measured, with a margin: see the table of
    /// docs/method.md#104-screening-and-intervals.
    pub const MOST_MISTAKES: f64 = 0.002;

    /// The share of audited runs of a sweep that does not state it.
    pub const AUDIT_SHARE: f64 = 0.1;

    /// True if a run with this predicted load factor holds.
    #[must_use]
    pub fn holds(&self, load_factor: f64) -> bool {
        load_factor * self.ratio >= HOLDS_FROM
    }

    /// True if a run is simulated whatever its prediction is. It depends on the seed and the run's index alone.
    #[must_use]
    pub fn is_audited(&self, index: u64) -> bool {
        Points::new(Sampling::Independent, self.seed ^ AUDIT_STREAM, 1).point(index)[0] < self.audit_share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_audited_share_is_as_asked_and_independent_of_the_other_runs() {
        for audit_share in [0.0, 0.05, 0.3, 1.0] {
            let screen = Screen { ratio: 1.0, audit_share, seed: 7 };
            let audited = (0..20_000).filter(|&index| screen.is_audited(index)).count() as f64 / 2e4;
            // Four standard deviations.
            let off = 4.0 * (audit_share * (1.0 - audit_share) / 2e4).sqrt();
            assert!((audited - audit_share).abs() <= off, "{audit_share}: {audited}");
        }
    }

    #[test]
    fn the_threshold_applies_to_the_corrected_load_factor() {
        let screen = Screen { ratio: 0.9, audit_share: 0.1, seed: 1 };
        assert!(screen.holds(HOLDS_FROM / 0.9 + 1e-9));
        assert!(!screen.holds(HOLDS_FROM / 0.9 - 1e-9));
        assert!(!screen.holds(f64::NAN));
    }
}
