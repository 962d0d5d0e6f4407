//! The self-checks: simulations that violate mechanics, and pads that ring.

use super::*;

/// A hold one of whose pads rings with this amplitude, as a share of the grip force.
fn ringing(share: f64, period_steps: usize) -> Trace {
    let mut trace = still();
    for (index, sample) in trace.samples.iter_mut().enumerate() {
        let turn = std::f64::consts::TAU * (index % period_steps) as f64 / period_steps as f64;
        sample.arms[1].pads[0].normal_force_n += share * GRIP_N * turn.cos();
    }
    trace
}

#[test]
fn pads_that_ring_give_no_verdict() {
    let judgement = judge(&ringing(0.15, 2), &limits());
    assert_eq!(judgement.verdict, VerdictKind::NoVerdict);
    assert!(
        judgement.reason.as_ref().unwrap().starts_with("the simulation is not valid: chatter 0.150 1, at most 0.1")
    );
    // An oscillation of period 2 h counts fully, one of 20 h by `(1 - cos 18 deg) / 2`, with the mean of a cosine's square.
    let slow = self_value(&judge(&ringing(0.5, 20), &limits()), CheckKind::Chatter);
    let expected = 0.5 * (1.0 - 18_f64.to_radians().cos()) / 2.0 * 0.5_f64.sqrt();
    // A window of 25 samples is not a whole number of periods.
    assert!((slow / expected - 1.0).abs() < 0.15, "{slow} {expected}");
    assert_eq!(judge(&ringing(0.5, 20), &limits()).verdict, VerdictKind::Holds);
}

fn self_value(judgement: &Judgement, kind: CheckKind) -> f64 {
    judgement.self_checks.iter().find(|check| check.name == kind).unwrap().value
}

#[test]
fn a_simulation_that_violates_mechanics_has_no_verdict() {
    type Spoil = fn(&mut StepCheck);
    let spoils: [(CheckKind, Spoil); 4] = [
        (CheckKind::Penetration, |check| check.penetration_m = 3e-3),
        (CheckKind::EnergyCreated, |check| check.contact_energy_j = 0.6),
        (CheckKind::CouplingDrift, |check| check.coupling_m = 2e-3),
        (CheckKind::Penetration, |check| check.penetration_m = f64::NAN),
    ];
    for (kind, spoil) in spoils {
        let judgement = judge(&changed(SETTLE + 1, |sample| spoil(&mut sample.self_check)), &limits());
        assert_eq!(judgement.verdict, VerdictKind::NoVerdict, "{kind}");
        assert!(judgement.reason.unwrap().starts_with(&format!("the simulation is not valid: {kind}")));
        assert!(judgement.checks.is_empty() && judgement.self_checks.len() == 5);
    }
    let residual = judge(&changed(0, |sample| sample.self_check.force_residual_n = 1.5), &limits());
    assert_eq!(residual.verdict, VerdictKind::NoVerdict);
}

#[test]
fn friction_takes_energy_and_only_a_rise_counts() {
    let mut trace = still();
    for (index, sample) in trace.samples.iter_mut().enumerate() {
        // Down by 10 J, then up by 0.1 J.
        sample.self_check.contact_energy_j = if index < SETTLE { -10.0 } else { -9.9 };
    }
    let judgement = judge(&trace, &limits());
    assert_eq!(judgement.verdict, VerdictKind::Holds);
    assert!((self_value(&judgement, CheckKind::EnergyCreated) - 0.1).abs() < 1e-12);
}

#[test]
fn samples_after_the_failure_do_not_change_the_verdict() {
    let mut trace = changed(SETTLE + 1, |sample| slide(sample, 0, 2.0));
    for sample in &mut trace.samples[SETTLE + 3..] {
        sample.self_check.penetration_m = 0.01;
    }
    assert_eq!(judge(&trace, &limits()).verdict, VerdictKind::Slips);
}
