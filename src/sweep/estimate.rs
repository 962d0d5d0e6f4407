//! The probability that a sweep estimates, with its interval (`docs/method.md#104-screening-and-intervals`).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    interval::{upper_bound, wilson},
    record::{Decided, RunRecord},
    screen::Screen,
};
use crate::model::scenario::Expectation;

/// The probability of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// The estimate.
    pub probability: f64,
    /// The lower end of its interval.
    pub low: f64,
    /// The upper end of its interval.
    pub high: f64,
    /// The confidence of the interval.
    pub confidence: f64,
    /// Runs that the statics decided, without audited ones.
    pub screened: u64,
    /// Runs that the statics would have decided and that were simulated as a check.
    pub audited: u64,
    /// Audited runs without the verdict that the statics would have given.
    pub mistakes: u64,
    /// The largest share of mistakes among screened runs that the interval allows for: [`Screen::MOST_MISTAKES`], or less if the
    /// audit proves less at this confidence; if the audit found a mistake, what the audit leaves possible. 0 without screened runs.
    pub most_mistakes: f64,
}

impl Estimate {
    /// The estimate of the probability of the expected verdict.
    ///
    /// The runs that were not screened count as simulated. Of those screened the share of mistakes is that of the audited ones,
    /// which were chosen at random: an unbiased estimate, however good the prediction is. The interval is Wilson's; its lower end
    /// is lower by the mistakes that [`Self::most_mistakes`] allows for.
    #[must_use]
    pub fn of(expect: &Expectation, records: &[RunRecord]) -> Self {
        let count = |kind: Decided, met: Option<bool>| {
            let is =
                |run: &&RunRecord| run.decided == kind && met.is_none_or(|met| met == (run.verdict == expect.verdict));
            records.iter().filter(is).count() as u64
        };
        let screened = count(Decided::Predicted, None);
        let (audited, mistakes) = (count(Decided::Audited, None), count(Decided::Audited, Some(false)));
        let seen = count(Decided::Simulated, Some(true)) + count(Decided::Audited, Some(true));
        let runs = records.len() as f64;
        let mistaken = if audited > 0 { mistakes as f64 / audited as f64 } else { 0.0 };
        let held = seen as f64 + screened as f64 * (1.0 - mistaken);
        let probability = if runs > 0.0 { held / runs } else { 0.0 };
        let confidence = expect.confidence;
        let proven = upper_bound(mistakes, audited, (1.0 + confidence) / 2.0);
        let most_mistakes = match (screened, mistakes) {
            (0, _) => 0.0,
            (_, 0) => proven.min(Screen::MOST_MISTAKES),
            _ => proven,
        };
        let [low, high] = wilson(probability, runs, confidence);
        let undetected = screened as f64 / runs.max(1.0) * (most_mistakes - mistaken);
        let low = (low - undetected).max(0.0);
        Self { probability, low, high, confidence, screened, audited, mistakes, most_mistakes }
    }

    /// The width of the interval.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.high - self.low
    }
}
