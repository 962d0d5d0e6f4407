//! The failing load: the smallest multiple of the load at which a grasp fails in simulation, and how it fails
//! (docs/method.md#89-failing-load).
//!
//!
//! Bisection over whole simulations, which the caller runs. One simulation with a slow ramp would be cheaper but would
//! measure something else: creep, the swing after the ramp and the time under the full load are part of a verdict, so a
//! grasp may fail at a load that it passes on a ramp. The result of bisection is reproduced by `simulate`.

use super::judgement::Judgement;
use crate::model::verdict::VerdictKind;

/// The largest factor tried, as in the load program of the statics.
const MAX_SIMULATED_FACTOR: f64 = 100.0;

/// The smallest positive factor tried; below it comes 0.
const MIN_FACTOR: f64 = 1.0 / 64.0;

/// Final width of the bracket, relative to the failing load.
const RELATIVE_WIDTH: f64 = 1e-3;

/// The result of the search for the failing load.
#[derive(Clone, Debug, PartialEq)]
pub struct FailingLoad {
    /// The largest factor at which the grasp holds; 0 without one.
    pub holds_at: f64,
    /// The smallest factor at which it fails, at most 0.1 % more; `None` if it holds 100 times the load, 0 if it fails
    /// without a load.
    pub fails_at: Option<f64>,
    /// The judgement there, or at `holds_at` if it does not fail.
    pub judgement: Judgement,
    /// The number of simulations.
    pub simulations: usize,
}

/// Finds the failing load. `judged` simulates the plan under a multiple of its load and judges it. The search starts at
/// `guess`, such as a predicted load factor, moves with growing strides until the failing load is bracketed and bisects
/// the bracket to 0.1 %. A factor without a verdict counts as a failure.
///
/// It is assumed that a grasp fails at every load above the failing load.
///
/// # Errors
/// The first error of `judged`.
pub fn failing_load<E>(guess: f64, mut judged: impl FnMut(f64) -> Result<Judgement, E>) -> Result<FailingLoad, E> {
    let start = if guess.is_finite() { guess.clamp(MIN_FACTOR, MAX_SIMULATED_FACTOR) } else { 1.0 };
    // A prediction is accurate to a few per cent, so the first stride is short.
    let mut stride = 1.1;
    let (mut factor, mut simulations) = (start, 0);
    let (mut holds_at, mut failing): (Option<f64>, Option<(f64, Judgement)>) = (None, None);
    loop {
        let judgement = judged(factor)?;
        simulations += 1;
        if judgement.verdict == VerdictKind::Holds {
            holds_at = Some(factor);
        } else {
            failing = Some((factor, judgement.clone()));
        }
        match next_factor(holds_at, failing.as_ref().map(|(factor, _)| *factor), stride) {
            Some(next) => factor = next,
            None => {
                let (fails_at, judgement) = match failing {
                    Some((factor, judgement)) => (Some(factor), judgement),
                    None => (None, judgement),
                };
                return Ok(FailingLoad { holds_at: holds_at.unwrap_or(0.0), fails_at, judgement, simulations });
            }
        }
        stride *= stride;
    }
}

/// The next factor to try; `None` if the failing load is found.
fn next_factor(holds_at: Option<f64>, fails_at: Option<f64>, stride: f64) -> Option<f64> {
    match (holds_at, fails_at) {
        (Some(low), Some(high)) => (high - low > RELATIVE_WIDTH * high).then_some((low + high) / 2.0),
        (Some(low), None) => (low < MAX_SIMULATED_FACTOR).then_some((low * stride).min(MAX_SIMULATED_FACTOR)),
        (None, Some(high)) if high > MIN_FACTOR => Some((high / stride).max(MIN_FACTOR)),
        (None, Some(high)) => (high > 0.0).then_some(0.0),
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The failing load of a grasp that holds below `limit`, and the factors that were tried.
    fn searched(guess: f64, limit: f64) -> (FailingLoad, Vec<f64>) {
        let judgement = |verdict| Judgement {
            verdict,
            checks: Vec::new(),
            self_checks: Vec::new(),
            first_failure: None,
            peak_torque_ratio: std::collections::BTreeMap::new(),
            confirmation: None,
            reason: None,
            fingerprint: String::new(),
            events: Vec::new(),
            measures: crate::model::measures::Measures::default(),
        };
        let mut factors = Vec::new();
        let judged = |factor: f64| {
            factors.push(factor);
            let verdict = if factor < limit { VerdictKind::Holds } else { VerdictKind::Slips };
            Ok::<_, std::convert::Infallible>(judgement(verdict))
        };
        let Ok(found) = failing_load(guess, judged);
        (found, factors)
    }

    fn search(guess: f64, limit: f64) -> FailingLoad {
        searched(guess, limit).0
    }

    #[test]
    fn the_failing_load_is_bracketed_from_any_guess() {
        for limit in [0.02, 0.9, 1.296, 3.7, 99.0] {
            for guess in [0.0, 0.5, 1.0, 1.3, 100.0, f64::NAN] {
                let found = search(guess, limit);
                let fails_at = found.fails_at.unwrap();
                assert!(found.holds_at < limit && limit <= fails_at, "{limit} from {guess}: {found:?}");
                assert!(fails_at - found.holds_at <= 1e-3 * fails_at);
                assert_eq!(found.judgement.verdict, VerdictKind::Slips);
            }
        }
        // Four to bracket a prediction that is 5 % off, eight to bisect 15 % to 0.1 %.
        assert!(search(1.3, 1.36).simulations <= 12);
    }

    /// Strides grow as 1.1, 1.1^2, 1.1^4 and so on up to the largest factor, or down to the smallest positive one and then 0.
    #[test]
    fn strides_grow_until_the_failing_load_is_bracketed() {
        let close = |found: &[f64], expected: &[f64]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-12 * b), "{found:?}");
        };
        let tried = |limit: f64| {
            let (found, factors) = searched(1.0, limit);
            assert_eq!(found.simulations, factors.len());
            factors
        };
        let power = |exponent: i32| 1.1_f64.powi(exponent);
        close(&tried(f64::INFINITY), &[1.0, power(1), power(3), power(7), power(15), power(31), 100.0]);
        close(&tried(-1.0), &[1.0, power(-1), power(-3), power(-7), power(-15), power(-31), 1.0 / 64.0, 0.0]);
        // Then the middle of the bracket.
        let bracketed = tried(0.8);
        close(&bracketed[..4], &[1.0, power(-1), power(-3), (power(-1) + power(-3)) / 2.0]);
    }

    #[test]
    fn the_search_ends_if_the_grasp_never_fails_or_never_holds() {
        let never_fails = search(1.0, f64::INFINITY);
        assert_eq!((never_fails.holds_at, never_fails.fails_at), (MAX_SIMULATED_FACTOR, None));
        assert_eq!(never_fails.judgement.verdict, VerdictKind::Holds);
        let never_holds = search(1.0, -1.0);
        assert_eq!((never_holds.holds_at, never_holds.fails_at), (0.0, Some(0.0)));
        // Between 0 and 1/64 the bracket starts at zero.
        assert!(search(1.0, 1e-6).holds_at < 1e-6);
    }
}
