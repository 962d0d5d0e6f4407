//! A sweep of a pinched block against closed forms: how likely two pads hold it, and what matters.

use benchdog::{
    judge::judge,
    model::{
        scenario::{Expectation, Limits, SimulationSettings},
        sweep::{Distribution, Quantity, Sampling, Sweep, Variable},
        verdict::VerdictKind,
    },
    robot::Robot,
    sim::Conditions,
    sweep::{
        ArmJoints, Draws,
        distribution::standard_probability,
        estimate::Estimate,
        indices::first_order,
        interval::exactly,
        record::{Decided, RunRecord},
    },
};
use rayon::prelude::*;

use crate::{
    GRAVITY_M_S2, LIGHT_KG,
    bench::{self, Grip, fingers_level},
    checked, force_along_x_g,
};

const SETTINGS: SimulationSettings =
    SimulationSettings { settle_s: 0.2, ramp_s: 0.3, hold_s: 0.2, release_s: 0.0, timestep_s: 0.002 };

/// Planned friction and grip force, and the pull along the fingers: a block of almost no weight.
const GRIP: Grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: LIGHT_KG };
const PULL_N: f64 = 30.0;

fn factor(quantity: Quantity, mean: f64, sd: f64) -> Variable {
    Variable {
        quantity,
        distribution: Distribution::Normal { mean, sd },
        min: None,
        max: None,
        nominal: None,
        correlation: Some(1.0),
        source: None,
    }
}

fn sweep(sampling: Sampling, seed: u64, variables: Vec<Variable>) -> Sweep {
    Sweep { runs: 0, sampling, seed, variables }
}

/// The runs of a sweep of the block.
fn swept(robot: &Robot, sweep: &Sweep, runs: u64) -> Vec<RunRecord> {
    let plan = bench::plan(robot, fingers_level(), &GRIP, force_along_x_g(PULL_N));
    let checked = checked(robot, &plan);
    let draws = Draws::new(sweep, &ArmJoints::of(&plan)).unwrap();
    let limits = Limits { deflection_mm: 1e3, slip_deg: 180.0, ..Limits::USUAL };
    let run = |index: u64| {
        let drawn = draws.draw(index);
        let conditions = Conditions { uncertainty: drawn.uncertainty, ..Conditions::new(GRIP.friction, SETTINGS) };
        let trace = benchdog::sim::simulate(&checked, &conditions).unwrap();
        let verdict = judge(&trace, &limits).verdict;
        RunRecord { index, values: drawn.values, predicted: None, decided: Decided::Simulated, verdict, measured: None }
    };
    (0..runs).into_par_iter().map(run).collect()
}

/// The planned slip load and what pulls along the fingers, N.
fn slip_and_pull_n() -> (f64, f64) {
    (2.0 * GRIP.friction * GRIP.force_n, PULL_N + GRIP.mass_kg * GRAVITY_M_S2)
}

/// A block of weight `m g` that is pulled down by `F` slips at `2 mu N = F + m g`: with normal friction the probability of holding is
/// in closed form.
#[test]
fn the_probability_of_holding_is_that_of_the_closed_form() {
    let robot = bench::robot(fingers_level(), None);
    let (mean, sd) = (1.0, 0.2);
    let (slip_at, along_n) = slip_and_pull_n();
    let expected = 1.0 - standard_probability((along_n / slip_at - mean) / sd);
    let runs = 400;
    for sampling in [Sampling::Independent, Sampling::Sobol] {
        let records = swept(&robot, &sweep(sampling, 5, vec![factor(Quantity::Friction, mean, sd)]), runs);
        let expect = Expectation { confidence: 0.999, ..Expectation::of(VerdictKind::Holds) };
        let estimate = Estimate::of(&expect, &records);
        assert!(
            (estimate.low..=estimate.high).contains(&expected),
            "{sampling:?}: {estimate:?}, closed form {expected}"
        );
        // Every run by itself: the friction at which the block slips is that of the closed form within a per cent.
        for RunRecord { values, verdict, .. } in &records {
            let margin = values[0] * slip_at / along_n;
            if (margin - 1.0).abs() > 0.01 {
                assert_eq!(*verdict == VerdictKind::Holds, margin > 1.0, "{sampling:?}: friction factor {}", values[0]);
            }
        }
    }
}

/// The first-order index of an indicator is the variance of the conditional probability over `p (1 - p)`: with normal friction and
/// grip force a one-dimensional integral of the closed form.
#[test]
fn what_matters_is_what_the_closed_form_says() {
    let robot = bench::robot(fingers_level(), None);
    let sds = [0.2, 0.1];
    let variables = vec![factor(Quantity::Friction, 1.0, sds[0]), factor(Quantity::GripForce, 1.0, sds[1])];
    let records = swept(&robot, &sweep(Sampling::Sobol, 3, variables), 2000);
    let held: Vec<f64> = records.iter().map(|run| f64::from(run.verdict == VerdictKind::Holds)).collect();
    let (slip_at, along_n) = slip_and_pull_n();
    for input in 0..2 {
        let (own, other) = (sds[input], sds[1 - input]);
        // The other factor must be above c / x.
        let given = |x: f64| 1.0 - standard_probability((along_n / slip_at / x - 1.0) / other);
        let moments = |power: i32| {
            // The midpoint rule over six standard deviations.
            let step = 12.0 / 4000.0;
            let density = |z: f64| (-z * z / 2.0).exp() / std::f64::consts::TAU.sqrt();
            let at = |k: i32| -6.0 + (f64::from(k) + 0.5) * step;
            (0..4000).map(|k| given(1.0 + own * at(k)).powi(power) * density(at(k)) * step).sum::<f64>()
        };
        let expected = (moments(2) - moments(1).powi(2)) / (moments(1) * (1.0 - moments(1)));
        let values: Vec<f64> = records.iter().map(|run| run.values[input]).collect();
        let found = first_order(&values, &held).unwrap();
        println!("{input}: {found:?}, closed form {expected}");
        // Four standard errors, and the variance of the probability inside a bin.
        assert!((found.value - expected).abs() < 4.0 * found.error + 0.02 * expected, "{input}: {found:?} {expected}");
        assert!(found.error < 0.05);
    }
}

/// Sobol points: over 300 scramblings of the closed form Wilson's interval contains the probability at least as often as its
/// confidence says.
#[test]
fn wilsons_interval_is_valid_for_sobol_points() {
    let plan_arms = [ArmJoints { name: "arm".into(), joints: 0 }];
    let variables = || vec![factor(Quantity::Friction, 1.0, 0.2), factor(Quantity::GripForce, 1.0, 0.1)];
    let (slip_at, along_n) = slip_and_pull_n();
    let holds = |values: &[f64]| values[0] * values[1] * slip_at > along_n;
    let share = |sampling, seed, runs: u64| {
        let draws = Draws::new(&sweep(sampling, seed, variables()), &plan_arms).unwrap();
        (0..runs).filter(|&index| holds(&draws.draw(index).values)).count() as f64 / runs as f64
    };
    // The share of a million points is as good as the probability.
    let probability = share(Sampling::Sobol, 999_999, 1 << 20);
    for runs in [100_u64, 300] {
        let covers = |sampling| {
            let covered = |seed: &u64| {
                let [low, high] = benchdog::sweep::interval::wilson(share(sampling, *seed, runs), runs as f64, 0.95);
                (low..=high).contains(&probability)
            };
            (0..2000_u64).into_par_iter().filter(covered).count() as f64 / 2000.0
        };
        let (sobol, independent) = (covers(Sampling::Sobol), covers(Sampling::Independent));
        let exact: f64 = (0..=runs)
            .filter(|&seen| {
                let [low, high] = benchdog::sweep::interval::wilson(seen as f64 / runs as f64, runs as f64, 0.95);
                (low..=high).contains(&probability)
            })
            .map(|seen| exactly(seen, runs, probability))
            .sum();
        println!("{runs} runs: Sobol {sobol}, independent {independent}, exact binomial {exact:.4}");
        // Three standard deviations of a share of 0.95 of 2000 are 1.5 points.
        assert!((independent - exact).abs() < 0.015, "{runs}: {independent} {exact}");
        assert!(sobol >= exact, "{runs}: {sobol} {exact}");
    }
}
