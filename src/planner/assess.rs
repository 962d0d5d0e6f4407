//! What a candidate is worth and which constraint it breaks, cheap tests first.

use std::{collections::BTreeMap, rc::Rc};

use nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use rand_pcg::Pcg64;

use super::{
    Infeasible, Problem,
    candidate::{Candidate, Placed},
    propose::uniform,
    watch::Count,
};
use crate::{
    collision::{PersonPart, Scene},
    comfort,
    human::{ArmAngles, CAPSULES, Human, Muscular},
    model::{
        frames::Pose,
        grasp::EdgeGrasp,
        plan::{ArmHold, AverageComfort, Comfort, PlacedObject},
        scenario::{Limits, Scenario, StabilityKind, StrengthDirection},
        wrench::Wrench,
    },
    robot::Gripper,
    statics::{ContactModel, ContactModelError, HandModel},
};

/// Height of the board's centre in W, m (METHOD section 3).
pub const BOARD_Z_M: [f64; 2] = [-0.3, 0.6];
/// Place of the board's centre along x_W, m (METHOD section 3).
pub const BOARD_X_M: [f64; 2] = [0.35, 0.85];
/// Place of the board's centre along y_W, m (METHOD section 3).
pub const BOARD_Y_M: [f64; 2] = [-0.25, 0.25];
/// The worked face looks within 100 degrees of the person's side, +x_W (METHOD section 3).
const FACING_LIMIT_RAD: f64 = 100.0 * std::f64::consts::PI / 180.0;

/// How much more than asked for a hold must stand by the compliant prediction. Small-displacement springs and pads that
/// are pressed evenly are a model: over the 100 holds of `results/` the simulated failing load was found 0.95 to 1.10 of its
/// figure, so the reserve is about as large as what it can be off, and no larger.
const COMPLIANT_RESERVE: f64 = 1.1;

/// The first constraint that a candidate breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rejection {
    /// The board's centre outside the domain of the search, or its worked face turned from the person's side.
    BoardPlace,
    /// A joint of the person loaded beyond its strength.
    Strength,
    /// A tool pose that the person cannot bring about.
    PersonReach,
    /// A hand that an arm of the robot cannot bring there.
    RobotReach,
    /// Bodies that touch or come too close.
    Collision,
    /// A load that the hold does not stand.
    Stability,
    /// A result that the check from scratch does not confirm.
    Verification,
    /// A candidate that was not looked at: the limit of evaluations is reached, or the search was stopped.
    NotLookedAt,
}

impl Rejection {
    /// What stood in the way, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::BoardPlace => "board outside the search domain",
            Self::Strength => "person's strength",
            Self::PersonReach => "human reach",
            Self::RobotReach => "robot reach",
            Self::Collision => "collision or too close",
            Self::Stability => "stability",
            Self::Verification => "the check from scratch",
            Self::NotLookedAt => "not looked at",
        }
    }
}

/// How many candidates were drawn, and what removed them.
#[derive(Clone, Debug)]
pub struct Tally {
    count: Rc<Count>,
    removed: BTreeMap<Rejection, u64>,
}

impl Tally {
    /// Nothing removed yet of what is counted here.
    pub fn new(count: Rc<Count>) -> Self {
        Self { count, removed: BTreeMap::new() }
    }

    /// True when no further candidate may be looked at.
    pub fn is_exhausted(&self) -> bool {
        self.count.is_exhausted()
    }

    /// Counts a candidate that was drawn.
    pub fn draw(&mut self) {
        self.count.draw();
    }

    /// Counts so many candidates that one thing removed.
    pub fn remove_all(&mut self, count: u64, why: Rejection) {
        self.count.draw_all(count);
        *self.removed.entry(why).or_default() += count;
    }

    /// Counts what removed a candidate, but for those that nobody looked at.
    pub fn remove(&mut self, why: Rejection) {
        if why != Rejection::NotLookedAt {
            *self.removed.entry(why).or_default() += 1;
        }
    }

    /// How many candidates were looked at.
    pub fn candidates(&self) -> u64 {
        self.count.looked_at()
    }

    /// The evidence that nothing was found.
    pub fn into_infeasible(self) -> Infeasible {
        let candidates = self.candidates();
        let mut removed: Vec<_> = self.removed.into_iter().map(|(why, count)| (why.name(), count)).collect();
        removed.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        Infeasible { candidates, removed }
    }
}

/// Everything about a candidate that follows from its numbers.
#[derive(Clone, Debug)]
pub struct Configured {
    pub placed: Placed,
    pub link_poses: Vec<Pose>,
    pub person: [PersonPart; CAPSULES],
}

/// A candidate that keeps every constraint, with its figures.
#[derive(Clone, Debug)]
pub struct Feasible {
    pub candidate: Candidate,
    pub configured: Configured,
    /// Both comforts.
    pub comfort: Comfort,
    /// What the search maximises.
    pub worth: f64,
    /// The share that the hold uses of what the limits of stability allow it.
    pub utilisation: f64,
}

impl Configured {
    /// Computes it; the candidate's arms must have configurations.
    pub fn new(problem: &Problem<'_>, candidate: &Candidate) -> Self {
        let placed = candidate.placed(problem);
        Self {
            placed,
            link_poses: problem.map.link_poses(&candidate.holds),
            person: problem.human.capsules_w(&placed.x_wb, &candidate.q_h_rad).map(PersonPart::from),
        }
    }

    /// The scene of collisions.
    pub fn scene<'a>(&'a self, problem: &'a Problem<'_>) -> Scene<'a> {
        Scene { person: &self.person, ..problem.map.scene(&self.link_poses, self.placed.x_wo) }
    }
}

/// A candidate that breaks a constraint, with what its tests worked out until then.
pub struct Rejected {
    pub why: Rejection,
    pub candidate: Candidate,
    pub configured: Configured,
    /// As in [`Feasible`]; zero when the tests ended before.
    pub utilisation: f64,
}

/// All that a candidate is and is worth, when it keeps every constraint.
pub fn feasible(problem: &mut Problem<'_>, candidate: Candidate) -> Result<Feasible, Rejection> {
    tested(problem, candidate).map_err(|rejected| rejected.why)
}

/// As [`feasible`], for whom the figures of a rejected candidate are of use; the cheapest tests come first.
pub fn tested(problem: &mut Problem<'_>, candidate: Candidate) -> Result<Feasible, Box<Rejected>> {
    let configured = Configured::new(problem, &candidate);
    if let Err(why) = free(problem, &candidate, &configured) {
        return Err(Box::new(Rejected { why, candidate, configured, utilisation: 0.0 }));
    }
    let utilisation = utilisation(problem, &candidate, &configured.placed.x_wo);
    if utilisation > 1.0 {
        return Err(Box::new(Rejected { why: Rejection::Stability, candidate, configured, utilisation }));
    }
    let comfort = comfort(problem, &candidate, &configured);
    Ok(rated(problem, candidate, configured, comfort, utilisation))
}

/// Tests everything but stability, which costs the most.
fn free(problem: &mut Problem<'_>, candidate: &Candidate, configured: &Configured) -> Result<(), Rejection> {
    if !problem.watch.allows() {
        return Err(Rejection::NotLookedAt);
    }
    place(problem, candidate)?;
    collisions(problem, configured)
}

/// What a candidate that has passed every test is worth; whoever looks on is told.
pub fn rated(
    problem: &mut Problem<'_>,
    candidate: Candidate,
    configured: Configured,
    comfort: Comfort,
    utilisation: f64,
) -> Feasible {
    problem.watch.found(&comfort);
    Feasible { candidate, configured, comfort, worth: comfort.objective, utilisation }
}

/// Tests what depends on the person and the board's pose alone.
pub fn place(problem: &Problem<'_>, candidate: &Candidate) -> Result<(), Rejection> {
    let x_wo = candidate.x_wo(problem);
    if !in_domain(&x_wo) {
        return Err(Rejection::BoardPlace);
    }
    let (human, direction) = (&problem.human, problem.scenario.comfort.direction);
    let x_bt = human.tool_pose_b(&candidate.q_h_rad);
    posture_comfort(human, &candidate.q_h_rad, &x_bt, &problem.wrench_t, direction).ok_or(Rejection::Strength)?;
    Ok(())
}

/// True when the board's centre and worked face are in the domain of the search (METHOD section 3).
pub fn in_domain(x_wo: &Pose) -> bool {
    let p_wo = x_wo.translation.vector;
    within(p_wo.x, BOARD_X_M) && within(p_wo.y, BOARD_Y_M) && within(p_wo.z, BOARD_Z_M) && faces_person(x_wo)
}

/// A pose of the board, uniformly from the domain of the search (METHOD section 3).
pub fn draw_board(random: &mut Pcg64) -> Pose {
    let p_wo = [BOARD_X_M, BOARD_Y_M, BOARD_Z_M].map(|[low, high]| uniform(random, low, high));
    loop {
        // A point of the unit ball in four dimensions is a uniform rotation.
        let [x, y, z, w] = std::array::from_fn(|_| uniform(random, -1.0, 1.0));
        let quaternion = Quaternion::new(w, x, y, z);
        if !(0.01..=1.0).contains(&quaternion.norm_squared()) {
            continue;
        }
        let x_wo = Isometry3::from_parts(p_wo.into(), UnitQuaternion::from_quaternion(quaternion));
        if faces_person(&x_wo) {
            return x_wo;
        }
    }
}

fn within(value: f64, [low, high]: [f64; 2]) -> bool {
    (low..=high).contains(&value)
}

/// True when the worked face looks towards the person's side: how much further it may turn away.
pub fn faces_person(x_wo: &Pose) -> bool {
    facing(x_wo) >= 0.0
}

/// How far the worked face's normal is inside the cone about the person's side, as a difference of cosines.
pub fn facing(x_wo: &Pose) -> f64 {
    (x_wo.rotation * Vector3::z()).x - FACING_LIMIT_RAD.cos()
}

/// The muscular comfort of a posture, if every joint is strong enough. It does not depend on where the person stands or
/// looks: the operation's wrench is fixed in the tool, and gravity is vertical.
pub fn posture_comfort(
    human: &Human,
    q_h_rad: &ArmAngles,
    x_bt: &Pose,
    wrench_t: &Wrench,
    direction: StrengthDirection,
) -> Option<Muscular> {
    let muscular = posture_muscular(human, q_h_rad, x_bt, wrench_t, direction);
    muscular.activations.iter().all(|&activation| activation <= 1.0).then_some(muscular)
}

/// The muscular comfort of a posture, strong enough or not.
pub fn posture_muscular(
    human: &Human,
    q_h_rad: &ArmAngles,
    x_bt: &Pose,
    wrench_t: &Wrench,
    direction: StrengthDirection,
) -> Muscular {
    let wrench_b = Wrench::new(x_bt.rotation * wrench_t.force_n, x_bt.rotation * wrench_t.moment_nm);
    human.muscular(q_h_rad, &Pose::identity(), &wrench_b, direction)
}

/// True when every corner of the gripper's pads lies on the face of the board.
pub fn pads_on_board(gripper: &Gripper, grasp: &EdgeGrasp, size_m: [f64; 3]) -> bool {
    pad_margins_m(gripper, grasp, size_m).iter().all(|&margin_m| margin_m >= 0.0)
}

/// How far the gripper's pads are inside each edge of the board, m: +x_O, -x_O, +y_O, -y_O.
pub fn pad_margins_m(gripper: &Gripper, grasp: &EdgeGrasp, size_m: [f64; 3]) -> [f64; 4] {
    let x_og = grasp.x_og(size_m);
    let pad = &gripper.fingers[0].pad;
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    corners.iter().fold([f64::INFINITY; 4], |margins_m, [side_x, side_z]| {
        let x_g = pad.centre_m[0] + side_x * pad.size_m[0] / 2.0;
        let z_g = pad.centre_m[1] + side_z * pad.size_m[1] / 2.0;
        let p_o = x_og * Point3::new(x_g, 0.0, z_g);
        let [half_x_m, half_y_m, _] = size_m.map(|side_m| side_m / 2.0);
        let here_m = [half_x_m - p_o.x, half_x_m + p_o.x, half_y_m - p_o.y, half_y_m + p_o.y];
        std::array::from_fn(|side| margins_m[side].min(here_m[side]))
    })
}

/// Both comforts of a candidate, and the objective of the search.
pub fn comfort(problem: &Problem<'_>, candidate: &Candidate, configured: &Configured) -> Comfort {
    let surface = comfort::robot_points_w(&problem.map.robot, &configured.link_poses);
    let Placed { x_wo, x_wb } = configured.placed;
    let wrench_w = problem.scenario.operation.wrench_w(&x_wo);
    comfort::of_posture(&problem.human, &problem.objective, &surface, &x_wb, &candidate.q_h_rad, &wrench_w)
}

/// A candidate's hold, for the person to answer.
pub fn hold<'a>(
    problem: &'a Problem<'_>,
    candidate: &Candidate,
    configured: &'a Configured,
    robot_points_w: &'a [Point3<f64>],
) -> comfort::Hold<'a> {
    comfort::Hold {
        human: &problem.human,
        collision: &problem.map.collision,
        settings: problem.objective,
        operation: problem.scenario.operation.rolled(candidate.roll_rad),
        floor_z_m: problem.map.robot.floor_z_m,
        robot_points_w,
        scene: Scene { person: &[], ..configured.scene(problem) },
    }
}

/// The mean comfort of the person's answers to a candidate's hold.
pub fn average(problem: &Problem<'_>, found: &Feasible) -> Option<AverageComfort> {
    let points = comfort::robot_points_w(&problem.map.robot, &found.configured.link_poses);
    comfort::average(&hold(problem, &found.candidate, &found.configured, &points))
}

/// Tests that nothing touches what it must not.
pub fn collisions(problem: &Problem<'_>, configured: &Configured) -> Result<(), Rejection> {
    match problem.map.collision.first_violation(&configured.scene(problem)) {
        None => Ok(()),
        Some(_) => Err(Rejection::Collision),
    }
}

/// The arms' part of a plan, for the stability program.
pub fn arm_holds(problem: &Problem<'_>, candidate: &Candidate) -> Vec<ArmHold> {
    let scenario = problem.scenario;
    problem
        .map
        .arms
        .iter()
        .zip(&candidate.holds)
        .map(|(arm, hold)| ArmHold {
            name: arm.name.clone(),
            joints: arm.joints.clone(),
            q_rad: hold.q_rad.clone(),
            x_og: hold.grasp.x_og(scenario.object.size_m),
            grip_force_n: scenario.grip.force_n,
        })
        .collect()
}

/// The share that a candidate's hold uses of what the limits of stability allow it, reserve included: at most 1 when it
/// stands, infinite when it cannot.
pub fn utilisation(problem: &mut Problem<'_>, candidate: &Candidate, x_wo: &Pose) -> f64 {
    let limits = stability_limits(problem.scenario);
    statics_hold(problem, candidate, x_wo)
        .and_then(|hold| problem.stability.utilisation(&hold, &limits, problem.scenario.planner.stability))
        // A hold that the statics call broken, say by a pad off the board, stands nothing.
        .unwrap_or(f64::INFINITY)
}

/// The limits of stability, reserve included.
pub fn stability_limits(scenario: &Scenario) -> Limits {
    let reserve = if scenario.planner.stability == StabilityKind::Compliant { COMPLIANT_RESERVE } else { 1.0 };
    Limits { load_factor: reserve * scenario.limits.load_factor, ..scenario.limits }
}

/// A candidate as the statics see it.
pub fn statics_hold(
    problem: &Problem<'_>,
    candidate: &Candidate,
    x_wo: &Pose,
) -> Result<ContactModel, ContactModelError> {
    let Scenario { object, operation, grip, .. } = problem.scenario;
    let object = PlacedObject { size_m: object.size_m, mass_kg: object.mass_kg(), x_wo: *x_wo };
    let hands: Result<Vec<_>, _> = arm_holds(problem, candidate)
        .iter()
        .zip(&problem.map.arms)
        .map(|(hold, arm)| HandModel::from_plan(&problem.map.robot, &arm.chain, hold, &object, grip.friction))
        .collect();
    Ok(ContactModel::from_hands(hands?, &object, &operation.rolled(candidate.roll_rad)))
}
