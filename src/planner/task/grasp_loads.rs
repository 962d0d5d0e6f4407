//! How one grasp carries the board and resists the loads of many pieces: hands and the equilibrium under the weight alone are
//! computed once.

use nalgebra::Vector3;

use super::{
    super::{
        assessment::{assess_cases, test_stability},
        candidate::Candidate,
        contact::{hand_models, placed_object, plan_arms},
        library::BoardGrasp,
        params::task::{CARRIED_RESERVE, EARLIER_LOADS_FACTOR},
    },
    problem::TaskProblem,
};
use crate::{
    model::{operation::Operation, plan::PlacedObject, scenario::Limits},
    statics::{AtRest, ContactModel, HandModel, LoadCases, ResponseOutcome, StabilityWorkspace},
};

/// A grasp with what of its stability does not depend on the load.
pub struct GraspLoads<'g> {
    grasp: &'g BoardGrasp,
    object: PlacedObject,
    /// `None` if a pad is off the board: such a grasp resists nothing.
    hands: Option<Vec<HandModel>>,
    at_rest: Option<AtRest>,
}

impl<'g> GraspLoads<'g> {
    /// A grasp of the board where it is.
    pub fn new(problem: &TaskProblem<'_>, grasp: &'g BoardGrasp) -> Self {
        let of_piece = problem.of_piece(0);
        let scenario = of_piece.scenario;
        let object = placed_object(scenario, grasp.x_wo);
        let arms = plan_arms(of_piece, &Candidate::without_person(grasp));
        let hands = hand_models(problem.robot, &arms, &object, scenario.grip.friction).ok();
        Self { grasp, object, hands, at_rest: None }
    }

    /// True if the grasp resists the load in the middle of a piece, [`EARLIER_LOADS_FACTOR`] times.
    pub fn resists(
        &mut self,
        problem: &TaskProblem<'_>,
        workspace: &mut StabilityWorkspace,
        piece: usize,
        roll_rad: f64,
    ) -> bool {
        self.resists_operation(problem, workspace, piece, &problem.operation(piece, roll_rad))
    }

    /// True if the grasp resists the load from where a piece begins to where it ends: in its middle and at both ends.
    pub fn resists_along(
        &mut self,
        problem: &TaskProblem<'_>,
        workspace: &mut StabilityWorkspace,
        piece: usize,
        roll_rad: f64,
    ) -> bool {
        let ends = problem.operations_at_ends(piece, roll_rad);
        self.resists(problem, workspace, piece, roll_rad)
            && ends.iter().all(|operation| self.resists_operation(problem, workspace, piece, operation))
    }

    fn resists_operation(
        &mut self,
        problem: &TaskProblem<'_>,
        workspace: &mut StabilityWorkspace,
        piece: usize,
        operation: &Operation,
    ) -> bool {
        let operation = &Operation { wrench_o: operation.wrench_o.scaled(EARLIER_LOADS_FACTOR), ..*operation };
        let Some(hands) = &self.hands else { return false };
        let of_piece = problem.of_piece(piece);
        let model = ContactModel::from_hands(hands.clone(), &self.object, operation);
        let cases = LoadCases::new(model, operation, &of_piece.scenario.load);
        let stability = assess_cases(of_piece, workspace, Ok(cases), &mut self.at_rest);
        test_stability(of_piece, &self.grasp.arms, &self.grasp.x_wo, &stability).is_ok()
    }

    /// True if the arms but `without` carry the board, and [`CARRIED_RESERVE`] of its weight more, within the limits of torque.
    pub fn carries(
        self,
        problem: &TaskProblem<'_>,
        workspace: &mut StabilityWorkspace,
        without: Option<usize>,
    ) -> bool {
        let Some(mut hands) = self.hands else { return false };
        if let Some(arm) = without {
            hands.remove(arm);
        }
        if hands.is_empty() {
            return false;
        }
        let of_piece = problem.of_piece(0);
        let model = ContactModel::from_hands(hands, &self.object, &of_piece.scenario.operation);
        // A share of the weight once more as the load; displacements are those of the board's centre.
        let load = model.weight.scaled(CARRIED_RESERVE);
        let model = ContactModel { load, p_ot: Vector3::zeros(), ..model };
        let limits = Limits { deflection_mm: of_piece.scenario.limits.sag_mm, ..of_piece.stability_limits() };
        match workspace.response(&model, 1.0) {
            Ok(ResponseOutcome::Found(response)) => response.utilisation(&model, &limits) <= 1.0,
            _ => false,
        }
    }
}
