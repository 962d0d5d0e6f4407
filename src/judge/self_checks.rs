//! Whether the simulation itself can be believed: a state that leaves the laws of mechanics allows no verdict.

use std::fmt::Write as _;

use super::checks::check;
use crate::model::{
    trace::{Phase, Sample},
    verdict::{Check, CheckKind},
};

/// How deep pads may sink into the board, mm. Holds show 0.05 mm, when a board is first gripped; the softest contacts that a
/// scenario may ask for sink in by 0.4 mm where 30 N press the foam board.
const PENETRATION_LIMIT_MM: f64 = 2.0;

/// By how much the energy that contacts and integration brought in may ever rise, J. Holds show 0.002 J, what contacts store
/// and give back; half a joule would throw the foam board at 2 m/s.
const ENERGY_LIMIT_J: f64 = 0.5;

/// How far the travels of coupled fingers may differ, mm. Holds show 0.001 mm.
const COUPLING_LIMIT_MM: f64 = 1.0;

/// What the board's momentum may leave unexplained, N. Holds show 1e-5 N at rest, 0.006 N with a long lever that still
/// swings.
const FORCE_LIMIT_N: f64 = 1.0;

/// Penetration, created energy and the fingers' coupling up to the moment that decided the verdict, and the board's
/// momentum at the end of settling, and of a hold that a release follows, until then. What a board does that was torn out of its
/// hands decides nothing.
pub(super) fn self_checks(decisive: &[Sample]) -> Vec<Check> {
    let largest = |of: fn(&Sample) -> f64| decisive.iter().map(of).fold(0.0, worse);
    let ends = |phase| decisive.windows(2).filter(move |pair| pair[0].phase == phase && pair[1].phase != phase);
    let steady_ends = ends(Phase::Settle).chain(ends(Phase::Hold)).map(|pair| &pair[0]);
    let held = steady_ends.filter(|sample| sample.has_contact());
    let residual_n = held.map(|sample| sample.self_check.force_residual_n).fold(0.0, worse);
    vec![
        check(CheckKind::Penetration, 1e3 * largest(|s| s.self_check.penetration_m), PENETRATION_LIMIT_MM),
        check(CheckKind::EnergyCreated, created_j(decisive), ENERGY_LIMIT_J),
        check(CheckKind::ForceResidual, residual_n, FORCE_LIMIT_N),
        check(CheckKind::CouplingDrift, 1e3 * largest(|s| s.self_check.coupling_m), COUPLING_LIMIT_MM),
    ]
}

/// The larger of two; what is not a number is larger than all that are, and stays a number for files.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::MAX } else { a.max(b) }
}

/// The largest rise of the contacts' energy between any two times, J: its height above its lowest value so far.
fn created_j(samples: &[Sample]) -> f64 {
    let mut lowest = 0.0_f64;
    samples.iter().fold(0.0, |created, sample| {
        lowest = lowest.min(sample.self_check.contact_energy_j);
        worse(created, sample.self_check.contact_energy_j - lowest)
    })
}

/// Why a trace with these checks cannot be believed, if so.
pub(super) fn failed_self_checks(self_checks: &[Check]) -> Option<String> {
    let mut reason = String::new();
    for check in self_checks.iter().filter(|check| !check.passed) {
        let separator = if reason.is_empty() { "the simulation cannot be believed: " } else { ", " };
        // Writing to a string never fails.
        _ = write!(reason, "{separator}{} {:.3} {}, at most {}", check.name, check.value, check.unit, check.limit);
    }
    (!reason.is_empty()).then_some(reason)
}
