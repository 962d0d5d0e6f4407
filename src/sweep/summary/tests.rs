//! Summaries of runs that are made by hand or drawn.

use super::*;
use crate::{
    model::{
        scenario::Expectation,
        sweep::{Distribution, Sampling, Sweep, Variable},
    },
    sweep::{
        ArmJoints, Draws,
        info::Fingerprints,
        record::{Decided, PredictedRun},
    },
};

fn variable(quantity: Quantity, correlation: Option<f64>) -> Variable {
    let distribution = Distribution::Normal { mean: 1.0, sd: 0.1 };
    Variable { quantity, distribution, min: None, max: None, nominal: None, correlation, source: None }
}

/// What a sweep of two arms is, and the values of its runs.
fn drawn(variables: Vec<Variable>, runs: u64) -> (SweepInfo, Vec<Vec<f64>>) {
    let sweep = Sweep { runs, sampling: Sampling::Independent, seed: 2, variables };
    let arms = ["left", "right"].map(|name| ArmJoints { name: name.into(), joints: 2 });
    let draws = Draws::new(&sweep, &arms).unwrap();
    let info = SweepInfo {
        format: 1,
        name: "block".into(),
        expect: Expectation::of(VerdictKind::Holds),
        runs,
        until: None,
        sampling: sweep.sampling,
        seed: sweep.seed,
        shard: None,
        screen: None,
        recorded: 4,
        variables: sweep.variables,
        dimensions: draws.dimensions().to_vec(),
        fingerprints: Fingerprints { program: "p".into(), inputs: "i".into() },
        versions: BTreeMap::new(),
    };
    (info, (0..runs).map(|index| draws.draw(index).values).collect())
}

/// A simulated run that holds with this predicted load factor, or fails at this share of the load.
fn run(index: u64, values: Vec<f64>, load_factor: f64, failed_at: Option<f64>) -> RunRecord {
    let measured = MeasuredRun {
        slip_mm: index as f64,
        slip_deg: 0.0,
        deflection_mm: 1.0,
        torque_ratio: 0.5,
        failed_at,
        first_check: failed_at.map(|_| CheckKind::Slip),
    };
    RunRecord {
        index,
        values,
        predicted: Some(PredictedRun { load_factor, deflection_mm: 1.0 }),
        decided: Decided::Simulated,
        verdict: if failed_at.is_some() { VerdictKind::Slips } else { VerdictKind::Holds },
        measured: Some(measured),
    }
}

fn force_alone() -> Vec<Variable> {
    vec![variable(Quantity::Force, None)]
}

#[test]
fn the_worst_runs_fail_first_and_then_have_the_smallest_prediction() {
    let (info, values) = drawn(force_alone(), 6);
    let figures = [(0.9, None), (1.3, Some(0.8)), (1.1, Some(0.4)), (1.2, None), (1.0, Some(0.8)), (0.9, None)];
    let records: Vec<_> = (0..).zip(values).zip(figures).map(|((index, of), (a, b))| run(index, of, a, b)).collect();
    let summary = summarise(&info, &records);
    // 2 fails earliest; of 1 and 4, which fail at the same load, 4 has the smaller prediction; 0 and 5 are equal but for the index.
    assert_eq!(summary.worst_runs(), [2, 4, 1, 0]);
    assert_eq!(summary.verdicts, BTreeMap::from([("holds".to_owned(), 3), ("slips".to_owned(), 3)]));
    assert_eq!(summary.first_checks.values().sum::<u64>(), 3);
    assert_eq!((summary.worst[0].failed_at, summary.worst[3].failed_at), (Some(0.4), None));
}

#[test]
fn quantiles_are_those_of_the_nearest_rank() {
    let (info, values) = drawn(force_alone(), 201);
    let records: Vec<_> = (0..).zip(values).map(|(index, of)| run(index, of, 1.5, None)).collect();
    let summary = summarise(&info, &records);
    // The slip of run i is i mm, so the quantile at p is 200 p.
    let slip = summary.quantiles.iter().find(|of| of.figure == "slip_mm").unwrap();
    assert_eq!(slip.values, [0.0, 2.0, 10.0, 50.0, 100.0, 150.0, 190.0, 198.0, 200.0]);
    assert_eq!(slip.runs, 201);
    assert!(summary.quantiles.iter().all(|of| of.figure != "failed_at"));
}

#[test]
fn an_expectation_is_met_if_the_whole_interval_is_above_it() {
    let (mut info, values) = drawn(force_alone(), 400);
    let records: Vec<_> =
        (0..).zip(values).map(|(index, of)| run(index, of, 1.5, (index < 4).then_some(0.9))).collect();
    assert_eq!(summarise(&info, &records).met, None);
    // 396 of 400: Wilson's interval at 95 % begins at 0.9746.
    for (expected, met) in [(0.974, true), (0.975, false), (0.99, false)] {
        info.expect.probability = Some(expected);
        let summary = summarise(&info, &records);
        assert_eq!((summary.met, summary.is_met()), (Some(met), met), "{expected}");
    }
}

/// A file without a number that JSON has not: a load without a limit has an infinite load factor.
#[test]
fn a_summary_is_read_as_it_was_written() {
    let (info, values) = drawn(vec![variable(Quantity::Force, None), variable(Quantity::JointOffset, None)], 40);
    let load_factor = |index: u64| if index.is_multiple_of(3) { f64::INFINITY } else { 1.0 + index as f64 / 50.0 };
    let mut records: Vec<_> =
        (0..).zip(values).map(|(index, of)| run(index, of, load_factor(index), (index == 7).then_some(0.3))).collect();
    records[9].predicted = None;
    for records in [&records[..], &records[..1], &[]] {
        let summary = summarise(&info, records);
        let text = serde_json::to_string(&summary).unwrap();
        assert_eq!(serde_json::from_str::<SweepSummary>(&text).unwrap(), summary, "{text}");
    }
}

/// The load factor `mean of the grip forces / force`, linear for small deviations: the grip force of correlated arms explains
/// `s^2 (1 + r) / 2` of `s^2 (1 + r) / 2 + s^2`, however strongly they are correlated.
#[test]
fn what_the_arms_share_counts_once() {
    for correlation in [0.0, 0.5, 0.9] {
        let (info, values) =
            drawn(vec![variable(Quantity::GripForce, Some(correlation)), variable(Quantity::Force, None)], 10_000);
        let records: Vec<_> = (0..)
            .zip(values)
            .map(|(index, of)| {
                let load_factor = 1.0 + (of[0] + of[1]) / 2.0 - of[2];
                run(index, of, load_factor, (load_factor < 0.9).then_some(load_factor))
            })
            .collect();
        let summary = summarise(&info, &records);
        let grip = (1.0 + correlation) / 2.0;
        for (quantity, expected) in [(Quantity::GripForce, grip / (grip + 1.0)), (Quantity::Force, 1.0 / (grip + 1.0))]
        {
            let of = summary.importance.iter().find(|of| of.quantity == quantity).unwrap();
            let Index { value, error } = of.load_factor;
            // Four standard errors, and the variance inside a bin.
            assert!((value - expected).abs() < 4.0 * error + 0.01, "{correlation} {quantity:?}: {value} {expected}");
        }
        assert_eq!(summary.importance[0].quantity, Quantity::Force);
    }
}
