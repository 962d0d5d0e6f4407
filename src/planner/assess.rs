//! What a candidate is worth and which constraint it breaks, cheap tests first.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use super::{Candidate, Infeasible, Problem};
use crate::{
    collision::{PersonPart, Scene},
    comfort,
    human::{ArmAngles, Muscular},
    model::{
        frames::Pose,
        grasp::EdgeGrasp,
        plan::{ArmHold, AverageComfort, Comfort, PlacedObject},
        scenario::{Limits, Scenario, StabilityKind},
        wrench::Wrench,
    },
    robot::{ArmState, Gripper},
    statics::{HandModel, Hold},
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
/// are pressed evenly are a model: simulated deflections and rotations were found up to 6 % above its figures.
const COMPLIANT_RESERVE: f64 = 1.1;

/// The first constraint that a candidate breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rejection {
    /// The board's centre outside the domain of the search.
    BoardPlace,
    /// The worked face turned away from the person's side.
    Facing,
    /// A joint of the person loaded beyond its strength.
    Strength,
    /// A pad over the edge of the board.
    PadOverEdge,
    /// A hand that an arm of the robot cannot bring there.
    RobotReach,
    /// Bodies that touch or come too close.
    Collision,
    /// A load that the hold does not stand.
    Stability,
    /// A result that the check from scratch does not confirm.
    Verification,
}

impl Rejection {
    /// What stood in the way, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::BoardPlace => "board outside the search domain",
            Self::Facing => "worked face turned from the person",
            Self::Strength => "person's strength",
            Self::PadOverEdge => "pads over the edge",
            Self::RobotReach => "robot reach",
            Self::Collision => "collision or too close",
            Self::Stability => "stability",
            Self::Verification => "the check from scratch",
        }
    }
}

/// How many candidates were drawn, and what removed them.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    candidates: u64,
    removed: BTreeMap<Rejection, u64>,
}

impl Tally {
    /// Counts a candidate that was drawn.
    pub fn draw(&mut self) {
        self.candidates += 1;
    }

    /// Counts what removed a candidate.
    pub fn remove(&mut self, why: Rejection) {
        *self.removed.entry(why).or_default() += 1;
    }

    /// How many candidates were drawn.
    pub fn candidates(&self) -> u64 {
        self.candidates
    }

    /// The evidence that nothing was found.
    pub fn into_infeasible(self) -> Infeasible {
        let mut removed: Vec<_> = self.removed.into_iter().map(|(why, count)| (why.name(), count)).collect();
        removed.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        Infeasible { candidates: self.candidates, removed }
    }
}

/// The poses that follow from a candidate's posture and place.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    pub x_wo: Pose,
    pub x_wb: Pose,
}

/// Places board and person, and tests what depends on the person and the board's pose alone.
pub fn place(problem: &Problem<'_>, candidate: &Candidate) -> Result<Placed, Rejection> {
    let x_wo = candidate.x_wo(problem);
    let within = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
    let p_wo = x_wo.translation.vector;
    if !(within(p_wo.x, BOARD_X_M) && within(p_wo.y, BOARD_Y_M) && within(p_wo.z, BOARD_Z_M)) {
        return Err(Rejection::BoardPlace);
    }
    if (x_wo.rotation * Vector3::z()).x < FACING_LIMIT_RAD.cos() {
        return Err(Rejection::Facing);
    }
    posture_comfort(problem, &candidate.q_h_rad).ok_or(Rejection::Strength)?;
    Ok(Placed { x_wo, x_wb: candidate.x_wb(problem) })
}

/// The muscular comfort of a posture, if every joint is strong enough. It does not depend on where the person stands or
/// looks: the operation's wrench is fixed in the tool, and gravity is vertical.
pub fn posture_comfort(problem: &Problem<'_>, q_h_rad: &ArmAngles) -> Option<Muscular> {
    let r_bt = problem.human.tool_pose_b(q_h_rad).rotation;
    let wrench_b = Wrench::new(r_bt * problem.wrench_t.force_n, r_bt * problem.wrench_t.moment_nm);
    let direction = problem.scenario.comfort.direction;
    let muscular = problem.human.muscular(q_h_rad, &Pose::identity(), &wrench_b, direction);
    muscular.activations.iter().all(|&activation| activation <= 1.0).then_some(muscular)
}

/// True when every corner of the gripper's pads lies on the face of the board.
pub fn pads_on_board(gripper: &Gripper, grasp: &EdgeGrasp, size_m: [f64; 3]) -> bool {
    let x_og = grasp.x_og(size_m);
    let pad = &gripper.fingers[0].pad;
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    corners.iter().all(|[side_x, side_z]| {
        let x_g = pad.centre_m[0] + side_x * pad.size_m[0] / 2.0;
        let z_g = pad.centre_m[1] + side_z * pad.size_m[1] / 2.0;
        let p_o = x_og * Point3::new(x_g, 0.0, z_g);
        p_o.x.abs() <= size_m[0] / 2.0 && p_o.y.abs() <= size_m[1] / 2.0
    })
}

/// Both comforts and the objective of a candidate whose arms reach.
pub fn comfort(problem: &Problem<'_>, candidate: &Candidate, placed: &Placed) -> Comfort {
    let poses = problem.robot.link_poses(&positions(problem, candidate));
    let surface = comfort::robot_points_w(problem.robot, &poses);
    let wrench_w = problem.scenario.operation.wrench_w(&placed.x_wo);
    let settings = &problem.scenario.comfort;
    comfort::of_posture(&problem.human, settings, &surface, &placed.x_wb, &candidate.q_h_rad, &wrench_w)
}

/// The mean comfort of the person's answers to a candidate's hold.
pub fn average(problem: &Problem<'_>, candidate: &Candidate) -> Option<AverageComfort> {
    let poses = problem.robot.link_poses(&positions(problem, candidate));
    let hold = comfort::Hold {
        human: &problem.human,
        collision: &problem.collision,
        settings: problem.scenario.comfort,
        operation: problem.scenario.operation.rolled(candidate.roll_rad),
        floor_z_m: problem.robot.floor_z_m,
        robot_points_w: &comfort::robot_points_w(problem.robot, &poses),
        scene: Scene {
            link_poses: &poses,
            holding: &problem.arms.iter().map(|arm| arm.index).collect::<Vec<_>>(),
            board_size_m: problem.scenario.object.size_m,
            x_wo: candidate.x_wo(problem),
            person: &[],
        },
    };
    comfort::average(&hold)
}

/// Positions of all joints of the robot.
fn positions(problem: &Problem<'_>, candidate: &Candidate) -> Vec<f64> {
    let states: Vec<_> = problem
        .arms
        .iter()
        .zip(&candidate.holds)
        .map(|(arm, hold)| ArmState { arm: arm.index, q_rad: &hold.q_rad, finger_travel_m: arm.finger_travel_m })
        .collect();
    problem.robot.positions(&states)
}

/// Tests that nothing touches what it must not.
pub fn collisions(problem: &Problem<'_>, candidate: &Candidate, placed: &Placed) -> Result<(), Rejection> {
    let person = problem.human.capsules_w(&placed.x_wb, &candidate.q_h_rad).map(PersonPart::from);
    let scene = Scene {
        link_poses: &problem.robot.link_poses(&positions(problem, candidate)),
        holding: &problem.arms.iter().map(|arm| arm.index).collect::<Vec<_>>(),
        board_size_m: problem.scenario.object.size_m,
        x_wo: placed.x_wo,
        person: &person,
    };
    match problem.collision.first_violation(&scene) {
        None => Ok(()),
        Some(_) => Err(Rejection::Collision),
    }
}

/// The arms' part of a plan, for the stability program.
pub fn arm_holds(problem: &Problem<'_>, candidate: &Candidate) -> Vec<ArmHold> {
    let scenario = problem.scenario;
    problem
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

/// Tests that a candidate stands the load.
pub fn stability(problem: &mut Problem<'_>, candidate: &Candidate, placed: &Placed) -> Result<(), Rejection> {
    let Scenario { object, operation, grip, limits, planner, .. } = problem.scenario;
    let object = PlacedObject { size_m: object.size_m, mass_kg: object.mass_kg(), x_wo: placed.x_wo };
    let hands: Result<Vec<_>, _> = arm_holds(problem, candidate)
        .iter()
        .zip(&problem.arms)
        .map(|(hold, arm)| HandModel::from_plan(problem.robot, &arm.chain, hold, &object, grip.friction))
        .collect();
    let reserve = if planner.stability == StabilityKind::Compliant { COMPLIANT_RESERVE } else { 1.0 };
    let limits = Limits { load_factor: reserve * limits.load_factor, ..*limits };
    let stands = hands
        .map(|hands| Hold::from_hands(hands, &object, &operation.rolled(candidate.roll_rad)))
        .and_then(|hold| problem.stability.stands(&hold, &limits, planner.stability));
    match stands {
        Ok(true) => Ok(()),
        // A hold that the statics call broken, say by a pad off the board, stands nothing.
        Ok(false) | Err(_) => Err(Rejection::Stability),
    }
}
