//! Self-checks of the simulation: there is no verdict if it violates the laws of mechanics
//! (docs/method.md#75-self-checks).

use std::fmt::Write as _;

use super::checks::check;
use crate::model::{
    trace::{Phase, Sample, Trace},
    verdict::{Check, CheckKind},
};

/// Limit of the pads' penetration into the board, mm. Typical: 0.05 mm when a board is first gripped; 0.4 mm under 30 N
/// on the foam board with the softest contacts that a scenario may set.
pub(super) const PENETRATION_LIMIT_MM: f64 = 2.0;

/// Limit of the rise of the energy from contacts and integration, J. Typical: 0.002 J, which contacts store and return;
/// half a joule would throw the foam board at 2 m/s.
pub(super) const ENERGY_LIMIT_J: f64 = 0.5;

/// Limit of the difference between the travels of coupled fingers, mm. Typical: 0.001 mm.
pub(super) const COUPLING_LIMIT_MM: f64 = 1.0;

/// Limit of the residual of the board's momentum balance, N. Typical: 1e-5 N at rest, 0.006 N with a long lever that
/// still swings.
pub(super) const FORCE_LIMIT_N: f64 = 1.0;

/// Limit of the fast oscillation of a pad's normal force, as a share of the grip force, and of a measured gripper's ratio. Typical: 0.003; 0.02 for hands that
/// slide. Pads that ring reach 0.2 to 1.
pub(super) const CHATTER_LIMIT: f64 = 0.1;

/// Time over which a pad's oscillation is averaged, s.
pub(super) const CHATTER_WINDOW_S: f64 = 0.05;

/// Half of the longest period that counts as fast, s, if the time step is shorter.
pub(super) const CHATTER_LAG_S: f64 = 0.002;

/// Penetration, created energy and finger coupling up to the sample that decides the verdict, the last of the first `decided`, the
/// momentum balance at the end of settling and of a hold that is followed by a release, and chatter from the hand-over on, the
/// sample of this number. Samples without contact are left out.
pub(super) fn self_checks(trace: &Trace, samples: &[Sample], decided: usize, hand_over: usize) -> Vec<Check> {
    let decisive = &samples[..decided];
    let largest = |of: fn(&Sample) -> f64| decisive.iter().map(of).fold(0.0, worse);
    // That a phase ends with the deciding sample is known from the one after it.
    let pairs = samples.windows(2).take(decided);
    let ends = |phase| pairs.clone().filter(move |pair| pair[0].phase == phase && pair[1].phase != phase);
    let steady_ends = ends(Phase::Settle).chain(ends(Phase::Hold)).map(|pair| &pair[0]);
    let held = steady_ends.filter(|sample| sample.has_contact());
    let residual_n = held.map(|sample| sample.self_check.force_residual_n).fold(0.0, worse);
    vec![
        check(CheckKind::Penetration, 1e3 * largest(|s| s.self_check.penetration_m), PENETRATION_LIMIT_MM),
        check(CheckKind::EnergyCreated, created_j(decisive), ENERGY_LIMIT_J),
        check(CheckKind::ForceResidual, residual_n, FORCE_LIMIT_N),
        check(CheckKind::CouplingDrift, 1e3 * largest(|s| s.self_check.coupling_m), COUPLING_LIMIT_MM),
        check(CheckKind::Chatter, chatter(trace, &decisive[hand_over.min(decisive.len())..]), CHATTER_LIMIT),
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

/// The largest fast oscillation of a pad's normal force N over the grip force: the root mean square over 50 ms of
/// `(N(t - h) - 2 N(t) + N(t + h)) / 4`, with h the time step or 2 ms. An oscillation of amplitude a and period 2 h gives
/// a; one that is ten times as slow, 0.02 a. Of a measured gripper it is that of the ratio of its wrench to the limits, while it
/// holds. 0 if fewer samples are known.
fn chatter(trace: &Trace, samples: &[Sample]) -> f64 {
    let [first, second, ..] = samples else { return 0.0 };
    let steps = |time_s: f64| (time_s / (second.time_s - first.time_s)).round() as usize;
    let lags = [1, steps(CHATTER_LAG_S).max(1)];
    let mut largest = 0.0;
    for shares in shares_of_hands(trace, samples) {
        for lag in lags {
            let bends: Vec<f64> = (lag..shares.len().saturating_sub(lag))
                .map(|at| (shares[at - lag] - 2.0 * shares[at] + shares[at + lag]) / 4.0)
                .collect();
            let count = steps(CHATTER_WINDOW_S).max(1);
            let means = bends.chunks_exact(count).map(|w| w.iter().map(|bend| bend * bend).sum::<f64>() / count as f64);
            largest = means.map(f64::sqrt).fold(largest, worse);
        }
    }
    largest
}

/// What may oscillate: of each pad its normal force over the grip force, of each measured gripper the ratio of its wrench to the
/// limits up to where it lets go.
fn shares_of_hands(trace: &Trace, samples: &[Sample]) -> Vec<Vec<f64>> {
    let mut shares: Vec<Vec<f64>> = Vec::new();
    for (arm, constants) in trace.arms.iter().enumerate() {
        let of_pad = |pad: usize| {
            let share = |sample: &Sample| sample.arms[arm].pads[pad].normal_force_n / constants.grip_force_n;
            samples.iter().map(share).collect()
        };
        shares.extend((0..constants.pads.len()).map(of_pad));
        shares.extend(constants.wrench_limits.map(|limits| {
            let held = samples.iter().map_while(|sample| sample.arms[arm].grip_wrench_g);
            held.map(|wrench_g| limits.ratio(&wrench_g)).collect()
        }));
    }
    shares
}

/// Why the simulation is invalid by these checks; `None` if it is valid.
pub(super) fn failed_self_checks(self_checks: &[Check]) -> Option<String> {
    let mut reason = String::new();
    for check in self_checks.iter().filter(|check| !check.passed) {
        let separator = if reason.is_empty() { "the simulation is not valid: " } else { ", " };
        // Writing to a string never fails.
        _ = write!(reason, "{separator}{} {:.3} {}, at most {}", check.name, check.value, check.unit, check.limit);
    }
    (!reason.is_empty()).then_some(reason)
}
