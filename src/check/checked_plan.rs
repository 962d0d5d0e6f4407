//! A plan that fits its robot, person and tool.

use std::sync::OnceLock;

use nalgebra::Vector3;

use super::{
    board::{check_pads, check_task, is_board_side},
    bounds,
    flaw::{Flaw, Flaws},
    tolerances::{EXACT, GIVEN, LIMIT_RAD},
};
use crate::{
    collision::{BoardBody, CollisionModel, PersonPart, Scene},
    human::{ArmRanges, Human, ranges},
    model::{
        frames::Pose,
        plan::{ArmHold, HumanPosture, Plan},
        scenario::{Person, Tool},
        verdict::VerdictKind,
    },
    robot::{Chain, Robot},
};

/// A plan without flaws, with what follows from it by kinematics.
pub struct CheckedPlan<'a> {
    robot: &'a Robot,
    plan: &'a Plan,
    arms: Vec<CheckedArm<'a>>,
    person: Option<CheckedPerson<'a>>,
    link_poses: Vec<Pose>,
    holding: Vec<usize>,
    board: BoardBody,
    /// That of the robot if it exists already.
    given_collision: Option<&'a CollisionModel>,
    /// Made when it is needed.
    collision: OnceLock<CollisionModel>,
}

/// Two bodies that are closer than they may be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contact {
    /// `touches` if one is the person or the tool, otherwise `collides`.
    pub verdict: VerdictKind,
    /// The bodies and their distance in words.
    pub reason: String,
}

/// The person of a plan.
pub struct CheckedPerson<'a> {
    /// Pose and joint angles.
    pub posture: &'a HumanPosture,
    /// The person with the tool.
    pub human: Human,
}

/// An arm that holds the board.
pub struct CheckedArm<'a> {
    /// Index into the robot's arms.
    pub index: usize,
    /// Its part of the plan.
    pub hold: &'a ArmHold,
    /// Its chain, with the fingers at the board's thickness.
    pub chain: Chain,
    /// Deviation of the gripper from X_WO X_OG: m, rad.
    off: [f64; 2],
}

impl<'a> CheckedPlan<'a> {
    /// Checks a plan. `rules` has the shoulder's kind, the posture limits and the place of the person, whose body is the plan's;
    /// `tool` is in the person's hand. Neither matters if the plan has no person.
    ///
    /// # Errors
    /// All flaws of the plan.
    pub fn new(robot: &'a Robot, plan: &'a Plan, rules: &Person, tool: &Tool) -> Result<Self, Flaws> {
        let mut flaws = Vec::new();
        check_task(plan, &mut flaws);
        let arms: Vec<_> = (0..plan.arms.len()).filter_map(|arm| check_arm(robot, plan, arm, &mut flaws)).collect();
        if plan.arms.is_empty() {
            flaws.push(Flaw::NoArm);
        }
        let person = plan.human.as_ref().and_then(|posture| check_person(posture, rules, tool, &mut flaws));
        match Flaws::of(flaws) {
            Some(flaws) => Err(flaws),
            None => Ok(Self {
                link_poses: robot.planned_link_poses(&plan.arms, plan.object.size_m[2]),
                board: BoardBody::new(&plan.object.shape()),
                holding: arms.iter().map(|arm| arm.index).collect(),
                robot,
                plan,
                arms,
                person,
                given_collision: None,
                collision: OnceLock::new(),
            }),
        }
    }

    /// With a collision model of this robot, so that none is made.
    #[must_use]
    pub fn with_collision(mut self, collision: &'a CollisionModel) -> Self {
        self.given_collision = Some(collision);
        self
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &'a Plan {
        self.plan
    }

    /// The arms that hold, in the order of the plan.
    #[must_use]
    pub fn arms(&self) -> &[CheckedArm<'a>] {
        &self.arms
    }

    /// The person; `None` if the plan has none.
    #[must_use]
    pub fn person(&self) -> Option<&CheckedPerson<'a>> {
        self.person.as_ref()
    }

    /// Poses of all links, W.
    #[must_use]
    pub fn link_poses(&self) -> &[Pose] {
        &self.link_poses
    }

    /// The collision scene of robot and board without the person.
    #[must_use]
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            link_poses: &self.link_poses,
            holding: &self.holding,
            board: &self.board,
            x_wo: self.plan.object.x_wo,
            person: &[],
            clearance_m: 0.0,
        }
    }

    /// The board as a body.
    #[must_use]
    pub fn board(&self) -> &BoardBody {
        &self.board
    }

    /// The capsules of the person, W; empty without a person.
    #[must_use]
    pub fn person_parts(&self) -> Vec<PersonPart> {
        let Some(CheckedPerson { posture, human }) = &self.person else { return Vec::new() };
        human.capsules_w(&posture.x_wb, &posture.q_rad).map(PersonPart::from).to_vec()
    }

    /// The collision model of the robot.
    #[must_use]
    pub fn collision(&self) -> &CollisionModel {
        self.given_collision.unwrap_or_else(|| self.collision.get_or_init(|| CollisionModel::new(self.robot)))
    }

    /// The first two bodies that are closer than docs/method.md#35-clearances allows, `clearance_m` being that of the robot from
    /// itself and from the board.
    #[must_use]
    pub fn first_contact(&self, clearance_m: f64) -> Option<Contact> {
        let person = self.person_parts();
        let scene = Scene { person: &person, clearance_m, ..self.scene() };
        let found = self.collision().first_violation(&scene)?;
        let verdict = if found.is_of_person() { VerdictKind::Touches } else { VerdictKind::Collides };
        Some(Contact { verdict, reason: found.describe(self.robot) })
    }

    /// Flaws by the tolerances of the planner's own plans: the grippers, the tool, where the person stands, and all joint
    /// limits, which such a plan keeps exactly.
    #[must_use]
    pub fn inexact(&self) -> Vec<Flaw> {
        let mut flaws = Vec::new();
        for (arm, checked) in self.arms.iter().enumerate() {
            check_limits(self.robot, checked.index, arm, checked.hold, 0.0, &mut flaws);
            let ([off_m, off_rad], name) = (checked.off, checked.hold.name.clone());
            if !EXACT.allows(checked.off) {
                flaws.push(Flaw::Hand { arm, name, off_m, off_rad, tolerance: EXACT });
            }
        }
        let Some(CheckedPerson { posture, human }) = &self.person else { return flaws };
        check_person_limits(human, posture, 0.0, &mut flaws);
        let tool = posture.x_wb * human.tool_pose_b(&posture.q_rad);
        let off = deviation(&tool, &(self.plan.object.x_wo * self.plan.operation.x_ot));
        if !EXACT.allows(off) {
            flaws.push(Flaw::Tool { off_m: off[0], off_rad: off[1], tolerance: EXACT });
        }
        let off_m = (posture.x_wb.translation.z - self.robot.floor_z_m).abs();
        let off_rad = (posture.x_wb.rotation * Vector3::z()).angle(&Vector3::z());
        if !EXACT.allows([off_m, off_rad]) {
            flaws.push(Flaw::Standing { off_m, off_rad, tolerance: EXACT });
        }
        flaws
    }
}

/// Distance and angle of two poses, m and rad.
fn deviation(a: &Pose, b: &Pose) -> [f64; 2] {
    [(a.translation.vector - b.translation.vector).norm(), a.rotation.angle_to(&b.rotation)]
}

/// One arm; `None` if it cannot be checked any further.
fn check_arm<'a>(robot: &Robot, plan: &'a Plan, arm: usize, flaws: &mut Vec<Flaw>) -> Option<CheckedArm<'a>> {
    let hold = &plan.arms[arm];
    let Some(index) = robot.arm_index(&hold.name) else {
        let known = robot.arms.iter().map(|arm| arm.name.clone()).collect();
        flaws.push(Flaw::UnknownArm { arm, found: hold.name.clone(), known });
        return None;
    };
    let before = flaws.len();
    if plan.arms[..arm].iter().any(|other| other.name == hold.name) {
        flaws.push(Flaw::ArmTwice { arm, found: hold.name.clone() });
    }
    check_joints(robot, index, arm, hold, flaws);
    let cup = robot.arms[index].gripper.cup;
    flaws.extend(match cup {
        Some(_) => cup_on_face(arm, &hold.x_og, plan.object.size_m[2]),
        None => fingers_across(arm, &hold.x_og),
    });
    // Wrong angles or a wrong grasp put the gripper elsewhere: one fault, one flaw.
    let is_comparable = flaws.len() == before;
    let gripper = &robot.arms[index].gripper;
    let (name, found_n) = (hold.name.clone(), hold.grip_force_n);
    let max_n = gripper.holding.pads().map(|pads| pads.max_force_n);
    if !max_n.map_or(found_n == 0.0, |max_n| found_n > 0.0 && found_n <= max_n) {
        flaws.push(Flaw::GripForce { arm, name: name.clone(), found_n, max_n });
    }
    let (thickness_m, opening_m) = (plan.object.size_m[2], gripper.opening_m);
    if is_board_side(thickness_m) && !(opening_m[0]..=opening_m[1]).contains(&thickness_m) {
        flaws.push(Flaw::Thickness { name: name.clone(), found_m: thickness_m, opening_m });
    }
    if is_comparable {
        check_pads(robot, index, plan, arm, flaws);
    } else {
        return None;
    }
    let chain = Chain::new(robot, index, gripper.travel_for_gap_m(0, thickness_m));
    let off = deviation(&chain.gripper_pose(&hold.q_rad), &(plan.object.x_wo * hold.x_og));
    if !GIVEN.allows(off) {
        flaws.push(Flaw::Hand { arm, name, off_m: off[0], off_rad: off[1], tolerance: GIVEN });
    }
    Some(CheckedArm { index, hold, chain, off })
}

/// The flaw of a grasp whose fingers do not close across the board's thickness: G off the board's middle plane, or y_G off its
/// normal.
#[must_use]
pub fn fingers_across(arm: usize, x_og: &Pose) -> Option<Flaw> {
    let [off_m, off_rad] = [x_og.translation.vector.z.abs(), (x_og.rotation * Vector3::y()).z.abs().min(1.0).acos()];
    (!GIVEN.allows([off_m, off_rad])).then_some(Flaw::FingersAcross { arm, off_m, off_rad })
}

/// The flaw of a suction grasp whose lip does not lie flat on a face: the origin of G off the face, or z_G off the normal into the
/// board.
fn cup_on_face(arm: usize, x_og: &Pose, thickness_m: f64) -> Option<Flaw> {
    let z_g = (x_og.rotation * Vector3::z()).z;
    let off_m = (x_og.translation.vector.z + z_g.signum() * thickness_m / 2.0).abs();
    let off_rad = z_g.abs().min(1.0).acos();
    (!GIVEN.allows([off_m, off_rad])).then_some(Flaw::CupOffFace { arm, off_m, off_rad })
}

fn check_joints(robot: &Robot, index: usize, arm: usize, hold: &ArmHold, flaws: &mut Vec<Flaw>) {
    let joints = &robot.arms[index].joints;
    let names = || joints.iter().map(|&joint| &robot.joints[joint].name);
    if !hold.joints.iter().eq(names()) {
        let (found, expected) = (hold.joints.clone(), names().cloned().collect());
        flaws.push(Flaw::Joints { arm, name: hold.name.clone(), found, expected });
    }
    let (found, expected) = (hold.q_rad.len(), joints.len());
    if found != expected {
        return flaws.push(Flaw::AngleCount { arm, found, expected });
    }
    check_limits(robot, index, arm, hold, LIMIT_RAD, flaws);
}

/// The limits of an arm's joints.
fn check_limits(robot: &Robot, index: usize, arm: usize, hold: &ArmHold, tolerance_rad: f64, flaws: &mut Vec<Flaw>) {
    for (joint, (&of_robot, &found_rad)) in robot.arms[index].joints.iter().zip(&hold.q_rad).enumerate() {
        let of_robot = &robot.joints[of_robot];
        let limits_rad = [of_robot.lower, of_robot.upper];
        if !within(found_rad, limits_rad, tolerance_rad) {
            flaws.push(Flaw::Angle { arm, joint, name: of_robot.name.clone(), found_rad, limits_rad });
        }
    }
}

/// The person; `None` if the person or the tool is invalid.
fn check_person<'a>(
    posture: &'a HumanPosture,
    rules: &Person,
    tool: &Tool,
    flaws: &mut Vec<Flaw>,
) -> Option<CheckedPerson<'a>> {
    let found_m: [f64; 3] = posture.x_wb.translation.vector.into();
    if !found_m.iter().all(|x_m| x_m.abs() <= bounds::MOST_PLACE_M) {
        flaws.push(Flaw::PersonPose { found_m });
    }
    let human = Human::new(&posture.person(rules), tool).map_err(|error| flaws.push(Flaw::Person(error))).ok()?;
    check_person_limits(&human, posture, LIMIT_RAD, flaws);
    Some(CheckedPerson { posture, human })
}

/// The limits of the joints of the person's working arm.
fn check_person_limits(human: &Human, posture: &HumanPosture, tolerance_rad: f64, flaws: &mut Vec<Flaw>) {
    let ArmRanges { joints_rad, twist_rad, elevation_rad } = *human.anatomy();
    for (joint, (&found_rad, limits_rad)) in posture.q_rad.iter().zip(joints_rad).enumerate() {
        if !within(found_rad, limits_rad, tolerance_rad) {
            flaws.push(Flaw::PersonAngle { joint, found_rad, limits_rad });
        }
    }
    let r_vu = human.arm().frames(&posture.q_rad).r_bu;
    let of_shoulder = [
        ("twist", ranges::twist_rad(&r_vu), twist_rad),
        ("elevation", ranges::elevation_rad(&r_vu), elevation_rad.map(|highest| [0.0, highest])),
    ];
    for (what, found_rad, limits_rad) in of_shoulder {
        if let Some(limits_rad) = limits_rad.filter(|limits_rad| !within(found_rad, *limits_rad, tolerance_rad)) {
            flaws.push(Flaw::PersonShoulder { what, found_rad, limits_rad });
        }
    }
}

/// True if an angle exceeds its limits by no more than the tolerance; false if it is not a number.
fn within(q_rad: f64, [low_rad, high_rad]: [f64; 2], tolerance_rad: f64) -> bool {
    q_rad >= low_rad - tolerance_rad && q_rad <= high_rad + tolerance_rad
}
