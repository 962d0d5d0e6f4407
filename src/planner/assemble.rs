//! From a feasible candidate to a verified plan.

use super::{
    candidate::{Candidate, Placement},
    contact::{placed_object, plan_arms},
    evaluate::{Configuration, Evaluator, Feasible},
    library::GraspingRobot,
    outcome::Rejection,
    scores::{self, scored},
    verify::verify_with,
};
use crate::{
    comfort,
    model::{
        FORMAT,
        plan::{Comfort, HumanPosture, Plan, PlannerRecord},
        scenario::PlannerSettings,
    },
};

/// The plan of a candidate; `None` if its stability cannot be predicted.
pub fn assemble(evaluator: &mut Evaluator<'_>, found: &Feasible, evaluations: u64) -> Option<Plan> {
    let Feasible { candidate, configuration, comfort, .. } = found;
    assemble_placed(evaluator, candidate, &configuration.placement, comfort, evaluations)
}

/// As [`assemble`], with the poses of board and person given: those that follow from the candidate differ by rounding.
pub fn assemble_placed(
    evaluator: &mut Evaluator<'_>,
    candidate: &Candidate,
    &Placement { x_wo, x_wb }: &Placement,
    comfort: &Comfort,
    evaluations: u64,
) -> Option<Plan> {
    let problem = &evaluator.problem;
    let (scenario, robot) = (problem.scenario, problem.robot);
    let PlannerSettings { kind, seed, .. } = scenario.planner;
    let operation = scenario.operation.rolled(candidate.work.roll_rad);
    let object = placed_object(scenario, x_wo);
    let arms = plan_arms(problem, candidate);
    let free_share = Configuration::placed(problem, candidate, Placement { x_wo, x_wb }).free_share_of_sight(problem);
    let figures = problem.human.posture_figures(&candidate.work.q_h_rad, &problem.normal_t, free_share);
    let posture = HumanPosture::new(&scenario.human, x_wb, candidate.work.q_h_rad);
    let comfort = comfort::weighted(*comfort, &scenario.comfort);
    let wrench_w = operation.wrench_w(&x_wo);
    let comfort = scored(&problem.human, &candidate.work.q_h_rad, &wrench_w, comfort);
    let muscles = problem.human.muscle_work(&candidate.work.q_h_rad, &x_wb, &wrench_w);
    let (stability, clearance) = evaluator.predict(&arms, &object, &operation)?;
    Some(Plan {
        format: FORMAT,
        name: scenario.name.clone(),
        robot: robot.robot.description.clone(),
        operation,
        object,
        arms,
        human: Some(HumanPosture { posture: Some(figures), ..posture }),
        comfort: Some(comfort),
        muscles,
        stability: Some(stability),
        clearance,
        planner: Some(PlannerRecord { kind, seed, wall_ms: None, map_ms: None, evaluations, robust: None }),
        scenario: Some(scenario.clone()),
        benchdog: Some(env!("CARGO_PKG_VERSION").into()),
    })
}

/// The plan of a candidate if it is [`accepted`]. Rejections are counted.
pub fn verified(evaluator: &mut Evaluator<'_>, found: &Feasible) -> Option<Plan> {
    let evaluations = evaluator.stats.candidates();
    let Some(plan) = assemble(evaluator, found, evaluations) else {
        evaluator.stats.reject(Rejection::Stability);
        return None;
    };
    accepted(evaluator, plan)
}

/// The finished plan if its posture's scores keep their limits and its check finds no flaw. The check takes nothing from the
/// search but the plan. Rejections are counted.
pub fn accepted(evaluator: &mut Evaluator<'_>, plan: Plan) -> Option<Plan> {
    match rejection(evaluator, &plan) {
        None => Some(plan),
        Some(why) => {
            evaluator.stats.reject(why);
            None
        }
    }
}

/// Why a finished plan is rejected.
fn rejection(evaluator: &Evaluator<'_>, plan: &Plan) -> Option<Rejection> {
    let problem = &evaluator.problem;
    let by_scores = plan.comfort.and_then(|comfort| scores::rejection(&comfort, &problem.scenario.limits));
    by_scores.or_else(|| {
        let GraspingRobot { robot, collision, .. } = problem.robot;
        let flaws = verify_with(plan, problem.scenario, robot, collision);
        (!flaws.is_empty()).then_some(Rejection::Verification)
    })
}
