//! Self-checks of the simulation: there is no verdict if it violates the laws of mechanics
//! (docs/method.md#75-self-checks).

use std::fmt::Write as _;

use super::checks::check;
use crate::model::{
    trace::{Phase, Sample},
    verdict::{Check, CheckKind},
};

/// Limit of the pads' penetration into the board, mm. Typical: 0.05 mm when a board is first gripped; 0.4 mm under 30 N
/// on the foam board with the softest contacts that a scenario may set.
const PENETRATION_LIMIT_MM: f64 = 2.0;

/// Limit of the rise of the energy from contacts and integration, J. Typical: 0.002 J, which contacts store and return;
/// half a joule would throw the foam board at 2 m/s.
const ENERGY_LIMIT_J: f64 = 0.5;

/// Limit of the difference between the travels of coupled fingers, mm. Typical: 0.001 mm.
const COUPLING_LIMIT_MM: f64 = 1.0;

/// Limit of the residual of the board's momentum balance, N. Typical: 1e-5 N at rest, 0.006 N with a long lever that
/// still swings.
const FORCE_LIMIT_N: f64 = 1.0;

/// Penetration, created energy and finger coupling up to the sample that decides the verdict, and the momentum balance
/// at the end of settling and of a hold that is followed by a release. Samples without contact are left out.
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

/// The larger of two; a NaN gives the largest finite number, which files can store.
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

/// Why the simulation is invalid by these checks; `None` if it is valid.
pub(super) fn failed_self_checks(self_checks: &[Check]) -> Option<String> {
    let mut reason = String::new();
    for check in self_checks.iter().filter(|check| !check.passed) {
        let separator = if reason.is_empty() { "the simulation cannot be believed: " } else { ", " };
        // Writing to a string never fails.
        _ = write!(reason, "{separator}{} {:.3} {}, at most {}", check.name, check.value, check.unit, check.limit);
    }
    (!reason.is_empty()).then_some(reason)
}
