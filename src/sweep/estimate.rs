//! The probability that a sweep estimates, with its interval (`docs/method.md#104-screening-and-intervals`).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    interval::{lower_bound, upper_bound, wilson},
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
    /// which were chosen at random: an unbiased estimate, however good the prediction is. The interval is Wilson's. Its
    /// lower end is lower by the mistakes that [`Self::most_mistakes`] allows for beyond those found; its upper end is higher by those
    /// that the audit may have found by chance, down to the lower bound of Clopper and Pearson.
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
        let one_sided = (1.0 + confidence) / 2.0;
        let proven = upper_bound(mistakes, audited, one_sided);
        let most_mistakes = match (screened, mistakes) {
            (0, _) => 0.0,
            (_, 0) => proven.min(Screen::MOST_MISTAKES),
            _ => proven,
        };
        let [low, high] = wilson(probability, runs, confidence);
        let share = screened as f64 / runs.max(1.0);
        let low = (low - share * (most_mistakes - mistaken)).max(0.0);
        let high = (high + share * (mistaken - lower_bound(mistakes, audited, one_sided))).min(1.0);
        Self { probability, low, high, confidence, screened, audited, mistakes, most_mistakes }
    }

    /// The width of the interval.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.high - self.low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::{sweep::Sampling, verdict::VerdictKind},
        sweep::points::Points,
    };

    /// A population of runs whose shares are known.
    #[derive(Clone, Copy, Debug)]
    struct Population {
        /// The share of runs that the statics decide.
        screened: f64,
        /// The share of these that do not hold.
        mistakes: f64,
        /// The share of the others that hold.
        held: f64,
        /// The share of runs that is audited.
        audited: f64,
    }

    impl Population {
        fn probability(self) -> f64 {
            self.screened * (1.0 - self.mistakes) + (1.0 - self.screened) * self.held
        }

        fn runs(self, seed: u64, count: u64) -> Vec<RunRecord> {
            let points = Points::new(Sampling::Independent, seed, 3);
            let run = |index| {
                let [of_screen, of_verdict, of_audit] = points.point(index)[..] else { unreachable!() };
                let screened = of_screen < self.screened;
                let audited = of_audit < self.audited;
                let holds = of_verdict < if screened { 1.0 - self.mistakes } else { self.held };
                let decided = match (screened, audited) {
                    (true, false) => Decided::Predicted,
                    (true, true) => Decided::Audited,
                    (false, _) => Decided::Simulated,
                };
                let verdict =
                    if holds || decided == Decided::Predicted { VerdictKind::Holds } else { VerdictKind::Slips };
                RunRecord { index, values: Vec::new(), predicted: None, decided, verdict, measured: None }
            };
            (0..count).map(run).collect()
        }
    }

    const SWEEPS: u64 = 2000;

    fn expect() -> Expectation {
        Expectation { confidence: 0.95, ..Expectation::of(VerdictKind::Holds) }
    }

    /// The shares of sweeps whose interval lies above and below the probability, and the mean of their estimates.
    fn misses(of: Population, runs: u64) -> ([f64; 2], f64) {
        let probability = of.probability();
        let (mut misses, mut mean) = ([0.0; 2], 0.0);
        for seed in 0..SWEEPS {
            let found = Estimate::of(&expect(), &of.runs(seed, runs));
            misses[0] += f64::from(found.low > probability) / SWEEPS as f64;
            misses[1] += f64::from(found.high < probability) / SWEEPS as f64;
            mean += found.probability / SWEEPS as f64;
        }
        (misses, mean)
    }

    /// Each end of the interval fails as seldom as that of Wilson's interval with every run simulated, or seldomer, while the share
    /// of mistakes is what the interval allows for, or so large that the audit finds it.
    #[test]
    fn the_interval_of_a_screened_sweep_covers_at_least_as_often_as_without_a_screen() {
        let populations = [
            (0.8, 0.9, 0.0),
            (0.8, 0.9, 0.0005),
            (0.98, 0.5, Screen::MOST_MISTAKES),
            (0.95, 0.95, Screen::MOST_MISTAKES),
            (0.95, 0.95, 0.05),
        ];
        for (screened, held, mistakes) in populations {
            let of = Population { screened, mistakes, held, audited: 0.1 };
            let ([above, below], mean) = misses(of, 1000);
            let ([plain_above, plain_below], _) = misses(Population { audited: 1.0, ..of }, 1000);
            // Four standard deviations of a share of 0.025 of the sweeps.
            let noise = 4.0 * (0.025 * 0.975 / SWEEPS as f64).sqrt();
            assert!(above <= plain_above.max(0.025) + noise, "{of:?}: {above} {plain_above}");
            assert!(below <= plain_below.max(0.025) + noise, "{of:?}: {below} {plain_below}");
            // Unbiased: an audited run stands for ten, so the variance is less than ten times that of simulated ones.
            let probability = of.probability();
            let error = (10.0 * probability * (1.0 - probability) / 1000.0 / SWEEPS as f64).sqrt();
            assert!((mean - probability).abs() < 4.0 * error, "{of:?}: {mean} {probability}");
        }
    }

    #[test]
    fn without_a_screen_the_interval_is_wilsons() {
        for audited in [0.0, 1.0] {
            let screened = audited;
            let of = Population { screened, mistakes: 0.1, held: 0.9, audited };
            let runs = of.runs(3, 500);
            let share = runs.iter().filter(|run| run.verdict == VerdictKind::Holds).count() as f64 / 500.0;
            let found = Estimate::of(&expect(), &runs);
            assert_eq!((found.probability, [found.low, found.high]), (share, wilson(share, 500.0, 0.95)));
            assert_eq!((found.screened, found.most_mistakes), (0, 0.0));
        }
    }

    #[test]
    fn a_sweep_that_audits_nothing_or_has_no_runs_has_an_interval() {
        let of = Population { screened: 1.0, mistakes: 0.0, held: 1.0, audited: 0.0 };
        let found = Estimate::of(&expect(), &of.runs(1, 400));
        let [low, high] = wilson(1.0, 400.0, 0.95);
        assert_eq!((found.probability, found.high), (1.0, high));
        assert!((found.low - (low - Screen::MOST_MISTAKES)).abs() < 1e-15);
        let none = Estimate::of(&expect(), &[]);
        assert_eq!((none.low, none.high, none.screened, none.audited), (0.0, 1.0, 0, 0));
    }

    /// An audit of 2 mistakes among 50 of 550 runs that the statics decide, beside 450 simulated ones of which 400 hold: by hand.
    #[test]
    fn mistakes_of_the_audit_correct_the_estimate_and_widen_both_ends() {
        let run = |index, decided, verdict| RunRecord {
            index,
            values: Vec::new(),
            predicted: None,
            decided,
            verdict,
            measured: None,
        };
        let parts = [
            (400, Decided::Simulated, VerdictKind::Holds),
            (50, Decided::Simulated, VerdictKind::Slips),
            (48, Decided::Audited, VerdictKind::Holds),
            (2, Decided::Audited, VerdictKind::Slips),
            (500, Decided::Predicted, VerdictKind::Holds),
        ];
        let kinds = parts.iter().flat_map(|&(many, decided, verdict)| (0..many).map(move |_| (decided, verdict)));
        let runs: Vec<_> =
            kinds.enumerate().map(|(index, (decided, verdict))| run(index as u64, decided, verdict)).collect();
        let found = Estimate::of(&expect(), &runs);
        // 400 + 48 + 500 (1 - 2 / 50) of 1000.
        assert!((found.probability - 0.928).abs() < 1e-15);
        assert_eq!((found.screened, found.audited, found.mistakes), (500, 50, 2));
        let [low, high] = wilson(0.928, 1000.0, 0.95);
        // Clopper and Pearson's interval of 2 of 50 at 95 % is 0.0049 to 0.1371 (tables); half of the runs are screened.
        assert!((found.low - (low - 0.5 * (0.1371 - 0.04))).abs() < 5e-5, "{found:?}");
        assert!((found.high - (high + 0.5 * (0.04 - 0.0049))).abs() < 5e-5, "{found:?}");
    }
}
