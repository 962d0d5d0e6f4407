//! Objective and constraints of a candidate, linearised along its free variables.

use nalgebra::DVector;

use super::{
    super::{
        candidate::Candidate,
        contact::load_cases,
        domain::ANGLE_RAD,
        evaluate::{Configuration, Evaluator, Feasible},
        load_shift::LoadShift,
        params::refine::{
            CLEARANCE_MARGIN_M, FULL_UTILISATION, MARGIN, NEAR_M, RELAXED_UTILISATION, STABILITY_DIFFERENCE,
            STEP_TOLERANCE,
        },
        problem::Problem,
        qp::LinearConstraint,
    },
    jacobian::Jacobian,
    variables::Variables,
};
use crate::{
    collision::{BodyRef, NearPair},
    human::Standing,
    model::plan::Comfort,
};

/// The linearisation about a candidate.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// The free variables.
    pub variables: Variables,
    /// Gradient of the objective.
    pub gradient: DVector<f64>,
    /// The constraints: simple ones, then pairs of near bodies, then stability if it is included.
    pub constraints: Vec<LinearConstraint>,
    /// The pairs of near bodies.
    near: Vec<NearBodies>,
    /// Gradient of the utilisation of stability, if it is included.
    stability: Option<DVector<f64>>,
    /// True if that gradient is an update of one at another candidate.
    stability_is_updated: bool,
}

/// Two primitives that are near each other.
#[derive(Clone, Copy, Debug)]
struct NearBodies {
    bodies: [(BodyRef, usize); 2],
    /// How much nearer the load brings them, m, at least 0; taken as constant in a step.
    approach_m: f64,
}

/// A candidate with the displacement by its load.
#[derive(Clone, Copy)]
pub struct Shifted<'a> {
    pub candidate: &'a Candidate,
    pub configuration: &'a Configuration,
    pub shift: &'a Option<LoadShift>,
}

impl Shifted<'_> {
    /// The pairs of near bodies of robot and board under the load; none if the clearance is not kept under the load.
    fn near(&self, problem: &Problem<'_>) -> Vec<NearPair> {
        let Some(shift) = self.shift else { return Vec::new() };
        let link_poses = problem.robot.link_poses(&shift.arms(&self.candidate.arms));
        let x_wo = shift.board(&self.configuration.placement.x_wo);
        problem.robot.collision.near(&problem.robot.scene(&link_poses, x_wo), NEAR_M)
    }
}

/// The pair of the same primitives.
fn same<'n>(near: &'n [NearPair], bodies: &[(BodyRef, usize); 2]) -> Option<&'n NearPair> {
    near.iter().find(|near| near.bodies == *bodies)
}

impl Linearization {
    /// Linearises about a candidate, without stability.
    pub fn new(problem: &Problem<'_>, here: &Feasible) -> Self {
        let Feasible { candidate, configuration, comfort, stability, .. } = here;
        let variables = Variables::new(problem, candidate, &configuration.placement);
        let margins = simple_margins(problem, candidate, configuration, &comfort.activations);
        let near = problem.robot.collision.near(&configuration.scene(problem), NEAR_M);
        let loaded = Shifted { candidate, configuration, shift: &stability.shift }.near(problem);
        let approach_m =
            |near: &NearPair| same(&loaded, &near.bodies).map_or(0.0, |loaded| near.margin_m - loaded.margin_m);
        let approaches_m: Vec<f64> = near.iter().map(|near| approach_m(near).max(0.0)).collect();
        let jacobian = Jacobian::new(problem, here, &variables);
        let simple = jacobian.simple_gradients().into_iter().zip(margins);
        let mut constraints: Vec<_> =
            simple.map(|(gradient, margin)| LinearConstraint { gradient, margin: margin - MARGIN }).collect();
        constraints.extend(near.iter().zip(&approaches_m).map(|(near, approach_m)| LinearConstraint {
            gradient: jacobian.distance_gradient(near),
            margin: near.margin_m - approach_m - CLEARANCE_MARGIN_M,
        }));
        let gradient = jacobian.objective_gradient();
        drop(jacobian);
        let near = near.iter().zip(approaches_m);
        let near = near.map(|(near, approach_m)| NearBodies { bodies: near.bodies, approach_m }).collect();
        Self { variables, gradient, constraints, near, stability: None, stability_is_updated: false }
    }

    /// Compares the constraints after a step with their linearisation. True if one is violated; then `corrected` (the
    /// constraints of the step's program) is shifted by the linearisation's error.
    pub fn correct(
        &self,
        problem: &Problem<'_>,
        candidate: &Candidate,
        configuration: &Configuration,
        comfort: &Comfort,
        d: &DVector<f64>,
        corrected: &mut [LinearConstraint],
    ) -> bool {
        let simple = simple_margins(problem, candidate, configuration, &comfort.activations);
        let near = problem.robot.collision.near(&configuration.scene(problem), NEAR_M);
        let is_known = |near: &NearPair| self.near.iter().any(|known| known.bodies == near.bodies);
        let mut violated = near.iter().any(|near| near.margin_m <= 0.0 && !is_known(near));
        let near_margin = |known: &NearBodies| {
            same(&near, &known.bodies).map(|near| near.margin_m - known.approach_m - CLEARANCE_MARGIN_M)
        };
        let margins = simple.iter().map(|&margin| Some(margin - MARGIN)).chain(self.near.iter().map(near_margin));
        for ((corrected, linear), margin) in corrected.iter_mut().zip(&self.constraints).zip(margins) {
            let Some(margin) = margin else { continue };
            let error = margin - (linear.margin + linear.gradient.dot(d));
            if error < 0.0 {
                corrected.margin = corrected.margin.min(linear.margin + error);
            }
            violated |= margin < -STEP_TOLERANCE;
        }
        violated
    }

    /// Shifts the constraints of near bodies after a step that brought bodies too close under the load (`corrected` are the
    /// constraints of the step's program); false if nothing can be learned from it.
    pub fn correct_loaded(
        &self,
        problem: &Problem<'_>,
        there: Shifted<'_>,
        d: &DVector<f64>,
        corrected: &mut [LinearConstraint],
    ) -> bool {
        let loaded = there.near(problem);
        let first = self.constraints.len() - self.near.len() - usize::from(self.stability.is_some());
        let mut learned = false;
        for (number, known) in self.near.iter().enumerate() {
            let Some(loaded) = same(&loaded, &known.bodies) else { continue };
            let (linear, corrected) = (&self.constraints[first + number], &mut corrected[first + number]);
            let margin = loaded.margin_m - CLEARANCE_MARGIN_M;
            let error = margin - (linear.margin + linear.gradient.dot(d));
            if margin < 0.0 && error < 0.0 && linear.margin + error < corrected.margin {
                corrected.margin = linear.margin + error;
                learned = true;
            }
        }
        learned
    }

    /// Includes stability in the constraints after a step that violated it; false if nothing can be learned from it.
    pub fn correct_stability(
        &mut self,
        evaluator: &mut Evaluator<'_>,
        here: &Feasible,
        utilisation: f64,
        d: &DVector<f64>,
        corrected: &mut Vec<LinearConstraint>,
    ) -> bool {
        if !utilisation.is_finite() {
            return false;
        }
        let was_included = self.stability.is_some();
        let gradient = self.stability_gradient(evaluator, here);
        let margin = FULL_UTILISATION - here.stability.utilisation;
        if !was_included {
            self.constraints.push(LinearConstraint { gradient: -&gradient, margin });
            corrected.push(LinearConstraint { gradient: -gradient, margin });
        } else if let Some(stability) = corrected.last_mut() {
            let error = (here.stability.utilisation + gradient.dot(d)) - utilisation;
            stability.margin = stability.margin.min(margin + error.min(0.0));
        }
        true
    }

    /// Includes stability in the constraints if it is near its limit or beyond.
    pub fn include_stability(&mut self, evaluator: &mut Evaluator<'_>, here: &Feasible) {
        if here.stability.utilisation >= RELAXED_UTILISATION && here.stability.utilisation.is_finite() {
            let gradient = -self.stability_gradient(evaluator, here);
            self.constraints.push(LinearConstraint { gradient, margin: FULL_UTILISATION - here.stability.utilisation });
        }
    }

    /// The gradient of the utilisation by differences, unless it is known; that of the worst case of the loads.
    fn stability_gradient(&mut self, evaluator: &mut Evaluator<'_>, here: &Feasible) -> DVector<f64> {
        if let Some(known) = &self.stability {
            return known.clone();
        }
        let count = self.variables.count();
        // Around a compliant equilibrium a whole gradient costs less than one equilibrium.
        let case = here.stability.case;
        let local = evaluator.local_equilibrium(&here.candidate, &here.configuration.placement.x_wo, case);
        let limits = evaluator.problem.stability_limits();
        let mut gradient = DVector::zeros(count);
        for number in 0..count {
            let mut d = DVector::zeros(count);
            d[number] = STABILITY_DIFFERENCE;
            let candidate = self.variables.apply_linear(&here.candidate, &d);
            let x_wo = candidate.x_wo(&evaluator.problem);
            let there = local
                .as_ref()
                .and_then(|local| {
                    let cases = load_cases(&evaluator.problem, &candidate, &x_wo).ok()?;
                    local.utilisation(&cases.into_case(case), &limits)
                })
                .unwrap_or_else(|| evaluator.assess(&candidate, &x_wo).utilisation);
            // Where there is no equilibrium the difference says nothing: a positive entry keeps the step away.
            gradient[number] =
                if there.is_finite() { (there - here.stability.utilisation) / STABILITY_DIFFERENCE } else { 1.0 };
        }
        self.stability = Some(gradient.clone());
        gradient
    }

    /// Takes over the gradient of the utilisation from the linearisation before a step (Broyden's rank-one update).
    pub fn update_stability(&mut self, before: &Self, from: &Feasible, to: &Feasible, d: &DVector<f64>) {
        let Some(known) = &before.stability else { return };
        if to.stability.utilisation < RELAXED_UTILISATION {
            return;
        }
        let error = to.stability.utilisation - from.stability.utilisation - known.dot(d);
        let gradient = known + d * (error / d.norm_squared());
        self.constraints
            .push(LinearConstraint { gradient: -&gradient, margin: FULL_UTILISATION - to.stability.utilisation });
        self.stability = Some(gradient);
        self.stability_is_updated = true;
    }

    /// Recomputes an updated gradient of the utilisation; false without one.
    pub fn refresh_stability(&mut self, evaluator: &mut Evaluator<'_>, here: &Feasible) -> bool {
        if !self.stability_is_updated {
            return false;
        }
        self.stability = None;
        self.stability_is_updated = false;
        let gradient = -self.stability_gradient(evaluator, here);
        if let Some(stability) = self.constraints.last_mut() {
            *stability = LinearConstraint { gradient, margin: FULL_UTILISATION - here.stability.utilisation };
        }
        true
    }
}

/// The margins of all constraints that cost next to nothing, at least 0 if satisfied, in the order of
/// [`Jacobian::simple_gradients`].
pub fn simple_margins(
    problem: &Problem<'_>,
    candidate: &Candidate,
    configuration: &Configuration,
    activations: &[f64; 7],
) -> Vec<f64> {
    let mut margins = Vec::with_capacity(96);
    let q_h_rad = &candidate.work.q_h_rad;
    let arm = problem.human.arm();
    margins.extend(arm.ranges.margins(q_h_rad, &arm.frames(q_h_rad).r_bu));
    margins.extend(problem.human.work_margins(&problem.human.tool_pose_b(q_h_rad), &problem.normal_t));
    margins.extend(problem.human.place_margins(&Standing::of(&configuration.placement.x_wb)));
    let mut between = |value: f64, [low, high]: [f64; 2]| margins.extend([value - low, high - value]);
    let domain = &problem.robot.domain;
    let x_wo = &configuration.placement.x_wo;
    let p_wo = x_wo.translation.vector;
    between(p_wo.x, domain.x_m);
    between(p_wo.y, domain.y_m);
    between(p_wo.z, domain.z_m);
    for (number, (arm, own)) in problem.robot.arms.iter().zip(&candidate.arms).enumerate() {
        for (joint, q) in own.q_rad.iter().enumerate() {
            between(*q, problem.joint_range(number, joint));
        }
        between(own.grasp.depth_m, arm.depth_m);
        between(own.grasp.angle_rad, ANGLE_RAD);
    }
    margins.push(domain.facing_margin(x_wo));
    margins.extend(activations.iter().map(|activation| 1.0 - activation));
    for (arm, own) in problem.robot.arms.iter().zip(&candidate.arms) {
        margins.extend(problem.robot.pad_margins_m(arm, &own.grasp));
    }
    margins
}
