//! How grasps resist their load, and where the load moves arms and board.

use rayon::prelude::*;

use super::{
    candidate::Candidate,
    contact::load_cases,
    library::{ArmGrasp, BoardGrasp},
    load_shift::LoadShift,
    outcome::Rejection,
    problem::Problem,
};
use crate::{
    model::{frames::Pose, scenario::StabilityKind},
    statics::{
        AtRest, CaseAssessment, ContactModel, ContactModelError, LoadCases, ResponseOutcome, StabilityWorkspace,
    },
};

/// How a grasp resists its loads, by the worst of their cases.
#[derive(Clone, Debug, Default)]
pub struct Assessment {
    /// The share of the limits of stability that it uses, safety factor included: at most 1 if it is stable, infinite if there is
    /// no equilibrium.
    pub utilisation: f64,
    /// Where the load of the worst case, at the required load factor, moves arms and board; `None` unless the clearance is kept under the load.
    pub shift: Option<LoadShift>,
    /// The case of the loads from which both follow.
    pub case: usize,
}

/// How a candidate's grasp resists its load.
pub fn assess(
    problem: &Problem<'_>,
    workspace: &mut StabilityWorkspace,
    candidate: &Candidate,
    x_wo: &Pose,
) -> Assessment {
    assess_cases(problem, workspace, load_cases(problem, candidate, x_wo), &mut None)
}

/// How a grasp resists these loads; `at_rest` is what its other loads have in common with them.
pub fn assess_cases(
    problem: &Problem<'_>,
    workspace: &mut StabilityWorkspace,
    cases: Result<LoadCases, ContactModelError>,
    at_rest: &mut Option<AtRest>,
) -> Assessment {
    let keeps_clear = problem.scenario.limits.clearance_mm > 0.0;
    cases
        .and_then(|cases| {
            workspace.assess_from(&cases, &problem.stability_limits(), problem.scenario.planner.stability, at_rest)
        })
        .map(|CaseAssessment { utilisation, response, case }| {
            let shift = response.filter(|_| keeps_clear).map(|response| LoadShift::of(&response));
            Assessment { utilisation, shift, case }
        })
        // A contact model is refused if, for example, a pad is off the board: such a grasp resists nothing.
        .unwrap_or(Assessment { utilisation: f64::INFINITY, ..Assessment::default() })
}

/// The utilisation of each grasp with the roll of the scenario's tool, see [`Assessment`]; infinite after a stop.
pub fn utilisations(problem: &Problem<'_>, grasps: &[&BoardGrasp]) -> Vec<f64> {
    let of_grasp = |workspace: &mut StabilityWorkspace, grasp: &&BoardGrasp| {
        if problem.stop.is_stopped() {
            return f64::INFINITY;
        }
        assess(problem, workspace, &Candidate::without_person(grasp), &grasp.x_wo).utilisation
    };
    grasps.par_iter().map_init(StabilityWorkspace::new, of_grasp).collect()
}

/// Where the load at load factor 1 moves arms and board; `None` unless stability is compliant, or without an equilibrium.
pub fn load_shift(workspace: &mut StabilityWorkspace, model: &ContactModel, kind: StabilityKind) -> Option<LoadShift> {
    if kind != StabilityKind::Compliant {
        return None;
    }
    match workspace.response(model, 1.0) {
        Ok(ResponseOutcome::Found(response)) => Some(LoadShift::of(&response)),
        _ => None,
    }
}

/// Tests that a grasp resists the load, and that the robot keeps its clearance under it.
pub fn test_stability(
    problem: &Problem<'_>,
    arms: &[ArmGrasp],
    x_wo: &Pose,
    stability: &Assessment,
) -> Result<(), Rejection> {
    if stability.utilisation > 1.0 {
        return Err(Rejection::Stability);
    }
    let Some(shift) = &stability.shift else { return Ok(()) };
    let link_poses = problem.robot.link_poses(&shift.arms(arms));
    let scene = problem.robot.scene(&link_poses, shift.board(x_wo));
    let violation = problem.robot.collision.first_violation(&scene);
    if violation.is_none() { Ok(()) } else { Err(Rejection::LoadedCollision) }
}
