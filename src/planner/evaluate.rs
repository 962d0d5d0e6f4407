//! The evaluation of a candidate: every constraint in order of cost, and the objective.

use nalgebra::Point3;

use super::{
    assessment::{self, Assessment, load_shift, test_stability},
    candidate::{Candidate, Placement},
    contact::{hand_models, load_cases},
    library::{posture_muscular, within_strength},
    load_shift::Held,
    near_miss::NearMisses,
    outcome::Rejection,
    problem::Problem,
    stats::SearchStats,
};
use crate::{
    collision::{PersonPart, Scene},
    comfort,
    human::{CAPSULES, Standing},
    model::{
        frames::Pose,
        operation::Operation,
        plan::{ArmHold, Clearance, Comfort, MeanComfort, PlacedObject, PostureConstraint, Stability},
        scenario::{ResponseKind, StabilityKind},
    },
    statics::{ContactModel, LoadCases, LocalEquilibrium, Prediction, StabilityWorkspace},
};

/// Evaluates candidates of one problem and keeps the statistics of the search.
pub struct Evaluator<'a> {
    pub problem: Problem<'a>,
    pub stats: SearchStats<'a>,
    /// The candidates that kept every constraint but stability and came nearest to it.
    pub near_misses: NearMisses,
    stability: StabilityWorkspace,
}

/// Everything that follows from a candidate's variables by kinematics.
#[derive(Clone, Debug)]
pub struct Configuration {
    pub placement: Placement,
    /// Poses of the robot's links, W.
    pub link_poses: Vec<Pose>,
    /// Capsules of the person, W.
    pub person: [PersonPart; CAPSULES],
}

/// A candidate that satisfies every constraint.
#[derive(Clone, Debug)]
pub struct Feasible {
    pub candidate: Candidate,
    pub configuration: Configuration,
    pub comfort: Comfort,
    /// What the search maximises.
    pub objective: f64,
    /// Its stability; the utilisation is at most 1.
    pub stability: Assessment,
}

/// A candidate that violates a constraint, with what was computed before that was found.
pub struct Rejected {
    pub why: Rejection,
    pub candidate: Candidate,
    pub configuration: Configuration,
    /// As in [`Feasible`]; zero and no shift if stability was not evaluated.
    pub stability: Assessment,
}

impl Configuration {
    /// The configuration of a candidate whose arms have joint angles.
    pub fn new(problem: &Problem<'_>, candidate: &Candidate) -> Self {
        Self::placed(problem, candidate, candidate.placement(problem))
    }

    /// The configuration of a candidate with board and person at given poses.
    pub fn placed(problem: &Problem<'_>, candidate: &Candidate, placement: Placement) -> Self {
        Self {
            placement,
            link_poses: problem.robot.link_poses(&candidate.arms),
            person: problem.human.capsules_w(&placement.x_wb, &candidate.work.q_h_rad).map(PersonPart::from),
        }
    }

    /// The free share of the line of sight.
    pub fn free_share_of_sight(&self, problem: &Problem<'_>) -> f64 {
        let Placement { x_wo, x_wb } = self.placement;
        let eye_w = x_wb * problem.human.eye_b();
        // A roll does not move the tip.
        let tip_w = x_wo * Point3::from(problem.scenario.operation.x_ot.translation.vector);
        problem.robot.collision.free_share_of_sight(&self.scene(problem), &eye_w, &tip_w)
    }

    /// The collision scene.
    pub fn scene<'a>(&'a self, problem: &'a Problem<'_>) -> Scene<'a> {
        Scene { person: &self.person, ..problem.robot.scene(&self.link_poses, self.placement.x_wo) }
    }
}

impl<'a> Evaluator<'a> {
    /// An evaluator of a problem.
    pub fn new(problem: Problem<'a>, stats: SearchStats<'a>) -> Self {
        Self { problem, stats, near_misses: NearMisses::default(), stability: StabilityWorkspace::new() }
    }

    /// Tests every constraint, the cheapest first, and computes the objective.
    pub fn evaluate(&mut self, candidate: Candidate) -> Result<Feasible, Box<Rejected>> {
        let configuration = Configuration::new(&self.problem, &candidate);
        if let Err(why) = self.test_geometry(&candidate, &configuration) {
            return Err(Box::new(Rejected { why, candidate, configuration, stability: Assessment::default() }));
        }
        let stability = self.assess(&candidate, &configuration.placement.x_wo);
        if let Err(why) = test_stability(&self.problem, &candidate.arms, &configuration.placement.x_wo, &stability) {
            if why == Rejection::Stability {
                self.near_misses.add(stability.utilisation, &candidate, &configuration.placement.x_wo);
            }
            return Err(Box::new(Rejected { why, candidate, configuration, stability }));
        }
        let comfort = comfort(&self.problem, &candidate, &configuration);
        Ok(self.feasible(candidate, configuration, comfort, stability))
    }

    /// Tests every constraint but stability, which costs most.
    fn test_geometry(&mut self, candidate: &Candidate, configuration: &Configuration) -> Result<(), Rejection> {
        if !self.stats.may_evaluate() {
            return Err(Rejection::NotEvaluated);
        }
        test_placement(&self.problem, candidate)?;
        test_collisions(&self.problem, configuration)
    }

    /// A candidate that passed every test; the watch is told of it.
    pub fn feasible(
        &mut self,
        candidate: Candidate,
        configuration: Configuration,
        comfort: Comfort,
        stability: Assessment,
    ) -> Feasible {
        self.stats.found(&comfort);
        // With the mean response, it is not known yet whether there is one.
        if self.problem.objective.person == ResponseKind::Best {
            self.stats.tell_found();
        }
        Feasible { candidate, configuration, comfort, objective: comfort.objective, stability }
    }

    /// Why a grasp is not stable, or too close to itself or the board under the load.
    pub fn test_grasp(&mut self, candidate: &Candidate, x_wo: &Pose) -> Result<(), Rejection> {
        let stability = self.assess(candidate, x_wo);
        test_stability(&self.problem, &candidate.arms, x_wo, &stability)
    }

    /// The objective of a candidate, feasible or not.
    pub fn objective(&self, candidate: &Candidate) -> f64 {
        let configuration = Configuration::new(&self.problem, candidate);
        comfort(&self.problem, candidate, &configuration).objective
    }

    /// How a grasp resists its load.
    pub fn assess(&mut self, candidate: &Candidate, x_wo: &Pose) -> Assessment {
        assessment::assess(&self.problem, &mut self.stability, candidate, x_wo)
    }

    /// The equilibrium at a candidate under the load of a case, from which those nearby are cheap; `None` if stability is not compliant or there is no
    /// equilibrium.
    pub fn local_equilibrium(&mut self, candidate: &Candidate, x_wo: &Pose, case: usize) -> Option<LocalEquilibrium> {
        if self.problem.scenario.planner.stability != StabilityKind::Compliant {
            return None;
        }
        let model = load_cases(&self.problem, candidate, x_wo).ok()?.into_case(case);
        let load_factor = self.problem.stability_limits().load_factor;
        LocalEquilibrium::new(&mut self.stability, &model, load_factor)
    }

    /// The predicted stability of a plan's grasp, with its clearances; `None` if there is no equilibrium.
    pub fn predict(
        &mut self,
        arms: &[ArmHold],
        object: &PlacedObject,
        operation: &Operation,
    ) -> Option<(Stability, Option<Clearance>)> {
        let Problem { scenario, robot, .. } = &self.problem;
        let hands = hand_models(robot, arms, object, scenario.grip.friction);
        let model = ContactModel::from_hands(hands.ok()?, object, operation);
        let cases = LoadCases::new(model, operation, &scenario.load);
        let Prediction { stability, case } = self.stability.predict(&cases, &scenario.limits).ok()??;
        let shift = load_shift(&mut self.stability, &cases.into_case(case), scenario.planner.stability);
        let held = Held { robot: &robot.robot, collision: &robot.collision, arms, object };
        Some((stability, held.clearance(shift.as_ref())))
    }
}

/// Tests the motion to a candidate, and what depends on the person and the board's pose alone.
pub fn test_placement(problem: &Problem<'_>, candidate: &Candidate) -> Result<(), Rejection> {
    if !problem.is_reachable(&candidate.arms) {
        return Err(Rejection::Motion);
    }
    let Placement { x_wo, x_wb } = candidate.placement(problem);
    if !problem.robot.domain.contains(&x_wo) {
        return Err(Rejection::BoardPlace);
    }
    if problem.human.place_is_given() && !problem.human.may_stand(&Standing::of(&x_wb)) {
        return Err(Rejection::PersonPlace);
    }
    let q_h_rad = &candidate.work.q_h_rad;
    if !problem.human.arm().permits_shoulder(q_h_rad) {
        return Err(Rejection::PersonReach);
    }
    let x_bt = problem.human.tool_pose_b(q_h_rad);
    if let Some(constraint) = problem.human.work_violation(&x_bt, &problem.normal_t) {
        return Err(Rejection::Posture(constraint));
    }
    let muscular = posture_muscular(&problem.human, q_h_rad, &x_bt, &problem.wrench_t, &problem.objective);
    if within_strength(&muscular) { Ok(()) } else { Err(Rejection::Strength) }
}

/// Tests that all bodies keep their clearances.
pub fn test_collisions(problem: &Problem<'_>, configuration: &Configuration) -> Result<(), Rejection> {
    match problem.robot.collision.first_violation(&configuration.scene(problem)) {
        None => test_sight(problem, configuration),
        Some(_) => Err(Rejection::Collision),
    }
}

/// Tests that nothing is in the line of sight.
pub fn test_sight(problem: &Problem<'_>, configuration: &Configuration) -> Result<(), Rejection> {
    if !problem.human.needs_sight() || configuration.free_share_of_sight(problem) >= 1.0 {
        return Ok(());
    }
    Err(Rejection::Posture(PostureConstraint::LineOfSight))
}

/// Both comforts of a candidate, and the objective of the search.
pub fn comfort(problem: &Problem<'_>, candidate: &Candidate, configuration: &Configuration) -> Comfort {
    let robot_points_w = comfort::robot_points_w(&problem.robot.robot, &configuration.link_poses);
    let Placement { x_wo, x_wb } = configuration.placement;
    let wrench_w = problem.scenario.operation.wrench_w(&x_wo);
    comfort::posture_comfort(
        &problem.human,
        &problem.objective,
        &robot_points_w,
        &x_wb,
        &candidate.work.q_h_rad,
        &wrench_w,
    )
}

/// The query for the person's responses to a grasp; the tool's roll is counted from that of `operation`.
pub fn response_query<'q>(
    problem: &'q Problem<'_>,
    operation: Operation,
    link_poses: &'q [Pose],
    x_wo: Pose,
    robot_points_w: &'q [Point3<f64>],
) -> comfort::ResponseQuery<'q> {
    comfort::ResponseQuery {
        human: &problem.human,
        collision: &problem.robot.collision,
        settings: problem.objective,
        operation,
        floor_z_m: problem.robot.robot.floor_z_m,
        robot_points_w,
        scene: problem.robot.scene(link_poses, x_wo),
        stop: problem.stop,
    }
}

/// The mean comfort over the person's responses to a candidate's grasp; `None` without a response, and after a stop.
pub fn mean_response(problem: &Problem<'_>, found: &Feasible) -> Option<MeanComfort> {
    let Configuration { placement, link_poses, .. } = &found.configuration;
    let points_w = comfort::robot_points_w(&problem.robot.robot, link_poses);
    let operation = problem.scenario.operation.rolled(found.candidate.work.roll_rad);
    comfort::mean_response(&response_query(problem, operation, link_poses, placement.x_wo, &points_w))
}
