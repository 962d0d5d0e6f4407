//! `--robust`: the most comfortable plan that holds with a probability (docs/method.md#107-robust-plans).
//!
//! Comfort falls as more load is required, so the required load factor is raised step by step until a plan is found that holds
//! often enough. Candidates pass three tests, from the cheapest on: the robust load factor at unfavourable friction, grip force and
//! load; the predicted load factors of many draws; a small sweep.

use rayon::prelude::*;

use super::exit::CliError;
use crate::{
    check::CheckedPlan,
    model::{
        plan::{Plan, PlannerRecord, Robustness},
        scenario::{Expectation, Limits, Scenario},
        sweep::Sweep,
        verdict::VerdictKind,
    },
    pipeline::sweep::{Study, screen},
    planner::{Infeasible, Outcome, Planner, Unreliable, Watch},
    scenario,
    statics::{ContactModel, InternalForces, RobustOutcome, StabilityWorkspace, Variation},
    sweep::{ArmJoints, Draws, estimate::Estimate, screen::Screen},
};

/// The multiples of `limits.load_factor` that are required, one after the other. The steps are the same for all scenarios, so that
/// scenarios share the planner's maps.
const STEPS: [f64; 10] = [1.0, 1.1, 1.2, 1.3, 1.45, 1.6, 1.8, 2.0, 2.5, 3.0];

/// The plans that differ which are tried at each step.
const CANDIDATES: usize = 3;

/// The largest ratio of simulated to predicted failing load of plans, with a margin: it was 1.11 at most.
const LARGEST_RATIO: f64 = 1.15;

/// Draws of which the load factor is predicted.
const PREDICTED: u64 = 400;

/// The fewest runs of the small sweep. So many that a probability of 0.99 leaves two failures.
const LEAST_RUNS: u64 = 200;

/// Failures that the small sweep has at the wanted probability: its number of runs is this over `1 - probability`.
const FAILURES: f64 = 2.0;

/// The most runs of the small sweep.
const MOST_RUNS: u64 = 2000;

/// The probability of holding if neither the command nor the scenario states one.
pub const PROBABILITY: f64 = 0.99;

/// The most comfortable plan of a scenario that holds with the wanted probability.
///
/// # Errors
/// If the scenario is invalid, and after a stop.
pub fn plan(planner: &Planner, scenario: &Scenario, wanted: f64, watch: &dyn Watch) -> Result<Outcome<Plan>, CliError> {
    let sweep = match &scenario.sweep {
        Some(sweep) => sweep.clone(),
        None => scenario::usual_sweep(scenario, planner.robot())?,
    };
    // A run needs no list of what varies.
    let tested = Scenario { sweep: None, ..scenario.clone() };
    let demand = Demand { planner, scenario: &tested, sweep: &sweep, wanted, watch };
    let mut best = 0.0_f64;
    let mut step = 0;
    while let Some(&factor) = STEPS.get(step) {
        let limits = Limits { load_factor: scenario.limits.load_factor * factor, ..scenario.limits };
        let plans = match planner.search(&Scenario { limits, ..scenario.clone() }).watch(watch).top(CANDIDATES)? {
            Outcome::Found(plans) => plans,
            Outcome::Infeasible(why) if step == 0 => return Ok(Outcome::Infeasible(why)),
            Outcome::Infeasible(_) => break,
        };
        let mut needed = f64::INFINITY;
        for mut plan in plans {
            // The plan answers the scenario that was asked.
            plan.scenario = plan.scenario.map(|_| scenario.clone());
            match demand.test(&plan)? {
                Tested::Robust { estimate: Estimate { probability, low, high, .. }, runs } => {
                    let robustness = Robustness { probability, low, high, runs, load_factor: limits.load_factor };
                    plan.planner = plan.planner.map(|record| PlannerRecord { robust: Some(robustness), ..record });
                    return Ok(Outcome::Found(plan));
                }
                Tested::Fails { probability, short_by } => {
                    needed = needed.min(factor * short_by);
                    best = best.max(probability);
                }
            }
        }
        step = next_step(step, needed);
    }
    Ok(Outcome::Infeasible(Infeasible { unreliable: Some(Unreliable { best, wanted }), ..Infeasible::default() }))
}

/// The next step that is tried: the last one that does not require more than `needed`, or else the one after this.
fn next_step(step: usize, needed: f64) -> usize {
    let reached = STEPS.iter().rposition(|&factor| factor <= needed).unwrap_or(0);
    reached.max(step + 1)
}

/// What plans are tested for.
struct Demand<'a> {
    planner: &'a Planner,
    /// The scenario without its sweep.
    scenario: &'a Scenario,
    sweep: &'a Sweep,
    /// The probability of holding.
    wanted: f64,
    watch: &'a dyn Watch,
}

/// What came of testing a plan.
enum Tested {
    /// It holds often enough.
    Robust {
        /// By a sweep.
        estimate: Estimate,
        /// The runs of this sweep.
        runs: u64,
    },
    /// It does not.
    Fails {
        /// The probability of holding, as far as it was found out.
        probability: f64,
        /// By how much the required load factor falls short, as a factor.
        short_by: f64,
    },
}

impl Demand<'_> {
    /// Tests a plan: unfavourable corner, predictions, small sweep.
    fn test(&self, plan: &Plan) -> Result<Tested, CliError> {
        let &Self { planner, scenario, sweep, wanted, watch } = self;
        let checked = CheckedPlan::new(planner.robot(), plan, &scenario.human, &scenario.tool)?;
        let draws = Draws::new(sweep, &ArmJoints::of(plan));
        let draws = draws.map_err(|error| CliError::Usage(format!("sweep: {error}")))?;
        let unscreened = Study { scenario, checked: &checked, draws: &draws, screen: None };
        let predicted = PredictedDraws::of(&unscreened, wanted);
        let fails = |ratio| Tested::Fails { probability: predicted.hold(ratio), short_by: predicted.short_by(ratio) };
        // Without a simulation, if no ratio that plans have would help.
        if predicted.hold(LARGEST_RATIO) < wanted || !resists_corner(&checked, scenario, &draws, wanted) {
            return Ok(fails(1.0));
        }
        let screen = screen(&checked, scenario, sweep, Screen::AUDIT_SHARE, watch)?;
        let ratio = screen.map_or(1.0, |screen| screen.ratio);
        if predicted.hold(ratio) < wanted {
            return Ok(fails(ratio));
        }
        let study = Study { screen, ..unscreened };
        let runs = ((FAILURES / (1.0 - wanted)).ceil() as u64).clamp(LEAST_RUNS, MOST_RUNS);
        let records: Result<Vec<_>, _> = (0..runs).into_par_iter().map(|index| study.run(index, watch)).collect();
        let expect = Expectation { confidence: scenario.expect.confidence, ..Expectation::of(VerdictKind::Holds) };
        let estimate = Estimate::of(&expect, &records?);
        if estimate.probability < wanted {
            // The predictions are too good: one step further.
            return Ok(Tested::Fails { probability: estimate.probability, short_by: 1.0 });
        }
        Ok(Tested::Robust { estimate, runs })
    }
}

/// The predicted load factors of many draws.
struct PredictedDraws {
    /// In increasing order.
    load_factors: Vec<f64>,
    /// The probability with which the plan must hold.
    wanted: f64,
}

impl PredictedDraws {
    fn of(study: &Study<'_>, wanted: f64) -> Self {
        let mut load_factors: Vec<f64> = (0..PREDICTED).into_par_iter().map(|index| study.predicted(index)).collect();
        load_factors.sort_by(f64::total_cmp);
        Self { load_factors, wanted }
    }

    /// The share of the draws that hold if the predictions are off by this ratio.
    fn hold(&self, ratio: f64) -> f64 {
        let hold = self.load_factors.iter().filter(|&&load_factor| load_factor * ratio >= 1.0).count();
        hold as f64 / self.load_factors.len() as f64
    }

    /// The factor by which the load factor falls short that all but the allowed share of the draws exceed.
    fn short_by(&self, ratio: f64) -> f64 {
        let allowed = self.load_factors[((1.0 - self.wanted) * self.load_factors.len() as f64) as usize] * ratio;
        if allowed > 0.0 { 1.0 / allowed } else { f64::INFINITY }
    }
}

/// True if some forces resist the load at unfavourable friction, grip force and load at once: each at the quantile that all but the
/// cube root of the allowed share of the draws exceed. A grasp that does not resist them fails too often for certain, if the three are
/// independent.
fn resists_corner(checked: &CheckedPlan<'_>, scenario: &Scenario, draws: &Draws, wanted: f64) -> bool {
    let Ok(model) = ContactModel::under(checked, scenario.grip.friction, &scenario.uncertainty) else { return false };
    let drawn: Vec<_> = (0..PREDICTED).map(|index| draws.draw(index).uncertainty).collect();
    let share = libm::cbrt(1.0 - wanted);
    let quantile = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[(share * (values.len() - 1) as f64) as usize]
    };
    let arms = 0..model.hands.len();
    let best = |of: &dyn Fn(usize) -> f64| arms.clone().map(of).fold(0.0, f64::max);
    let friction_ratio = quantile(drawn.iter().map(|of| best(&|arm| of.friction_scale_of(arm))).collect());
    let grip_force_ratio = quantile(drawn.iter().map(|of| best(&|arm| of.grip_force_scale_of(arm))).collect());
    let force = -quantile(drawn.iter().map(|of| -of.force_scale).collect());
    let corner = Variation { load: model.load.scaled(force), friction_ratio, grip_force_ratio };
    let nominal = Variation { load: model.load, friction_ratio: 1.0, grip_force_ratio: 1.0 };
    match StabilityWorkspace::new().robust_load_factor(&model, &[nominal, corner], InternalForces::Adapt) {
        Ok(RobustOutcome::Solved(found)) => found.load_factor >= 1.0,
        Ok(RobustOutcome::GravityInfeasible { .. }) => false,
        // Not proven.
        _ => true,
    }
}
