//! How much load a hold stands: the smallest multiple of its load at which it does not hold, and by what it fails.
//!
//! Found by bisection over whole simulations, which the caller provides. A slow ramp of one simulation would be cheaper,
//! but it would answer another question: creep, the swing after the ramp and the time under the whole load are part of
//! a verdict, so the load that a ramp reaches before a limit is crossed is no load that the hold stands. With bisection
//! the answer is one that `simulate` gives too.

use super::Judgement;
use crate::model::verdict::VerdictKind;

/// The largest factor that is tried, as in the stability program.
pub const MAX_SIMULATED_FACTOR: f64 = 100.0;

/// The smallest factor that is tried before the load is taken away altogether.
const MIN_FACTOR: f64 = 1.0 / 64.0;

/// How wide the bracket of the answer is in the end, relative to the answer.
const RELATIVE_WIDTH: f64 = 1e-3;

/// How much load a hold stands.
#[derive(Clone, Debug, PartialEq)]
pub struct FailingLoad {
    /// The largest factor that was found to hold; 0 when none did.
    pub holds_at: f64,
    /// The smallest factor that was found not to hold, at most 0.1 % more; none when the hold stands
    /// [`MAX_SIMULATED_FACTOR`]. It is 0 when the hold fails without any load.
    pub fails_at: Option<f64>,
    /// What the judge said there; at `holds_at` when nothing fails.
    pub judgement: Judgement,
    /// How many simulations it took.
    pub simulations: usize,
}

/// Finds the load at which a hold fails: `judged` simulates it under a multiple of its load and judges it. The search
/// begins at `guess`, such as a predicted load factor, doubles or halves until the failing load is bracketed and halves
/// the bracket until it is 0.1 % wide. A load that allows no verdict counts as one that does not hold.
///
/// Holds are taken to fail at every load beyond the first that they fail at; between the loads tried nothing is known.
///
/// # Errors
/// The first error of `judged`.
pub fn failing_load<E>(guess: f64, mut judged: impl FnMut(f64) -> Result<Judgement, E>) -> Result<FailingLoad, E> {
    let start = if guess.is_finite() { guess.clamp(MIN_FACTOR, MAX_SIMULATED_FACTOR) } else { 1.0 };
    // A prediction is good to a few per cent, so the first bracket around it is narrow.
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

/// The factor to try after some were found to hold and to fail; none when the answer is known.
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
    use crate::{
        judge::judge,
        model::{scenario::Limits, trace::Trace},
    };

    /// A hold that stands every load below `limit`, and how often it was asked.
    fn search(guess: f64, limit: f64) -> FailingLoad {
        let empty = Trace {
            arms: Vec::new(),
            p_ot_m: nalgebra::Vector3::zeros(),
            samples: Vec::new(),
            broke_down: None,
            person_touch: None,
        };
        let limits = Limits {
            slip_mm: 1.0,
            slip_deg: 2.0,
            deflection_mm: 5.0,
            creep_mm_s: 0.1,
            torque_ratio: 1.0,
            load_factor: 1.0,
        };
        let verdict = |factor| if factor < limit { VerdictKind::Holds } else { VerdictKind::Slips };
        let judged = |factor: f64| {
            Ok::<_, std::convert::Infallible>(Judgement { verdict: verdict(factor), ..judge(&empty, &limits) })
        };
        let Ok(found) = failing_load(guess, judged);
        found
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
        // Four to bracket a prediction that is 5 % off, eight to halve 15 % down to 0.1 %.
        assert!(search(1.3, 1.36).simulations <= 12);
    }

    #[test]
    fn what_never_fails_and_what_never_holds_end() {
        let never_fails = search(1.0, f64::INFINITY);
        assert_eq!((never_fails.holds_at, never_fails.fails_at), (MAX_SIMULATED_FACTOR, None));
        assert_eq!(never_fails.judgement.verdict, VerdictKind::Holds);
        let never_holds = search(1.0, -1.0);
        assert_eq!((never_holds.holds_at, never_holds.fails_at), (0.0, Some(0.0)));
        // Between no load at all and a sixty-fourth of it the answer is a bracket from zero.
        assert!(search(1.0, 1e-6).holds_at < 1e-6);
    }
}
