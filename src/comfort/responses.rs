//! The person's feasible responses, on a uniform grid.
//!
//! A response is feasible if the arm's inverse kinematics has a solution within the joint limits, every activation is at
//! most 1, all bodies keep their clearances (docs/method.md#34-constraints), and the person stands where they may, naturally,
//! and sees the work (docs/method.md#413-natural-postures). Cheap tests run first: standing places from
//! which the wrist is out of reach are skipped; the exact intervals of the swivel leave out angles beyond joint limits; the
//! parts that do not move with the arm are tested once per standing pose.

use std::{cell::OnceCell, f64::consts::TAU};

use nalgebra::{Point3, Vector3};

use super::{posture::objective, query::ResponseQuery};
use crate::{
    collision::{PersonPart, Scene},
    human::{
        ArmAngles, Distances, Muscular, STILL_POINTS, ShoulderBranch, Standing, SwivelCircle, SwivelInterval,
        standing_pose_w,
    },
    model::{frames::Pose, wrench::Wrench},
};

/// Step of the standing place along x_W and along y_W, m.
pub(super) const PLACE_STEP_M: f64 = 0.05;
/// Step of the heading, rad: 10 degrees.
pub(super) const HEADING_STEP_RAD: f64 = TAU / HEADINGS as f64;
const HEADINGS: i32 = 36;
/// Step of the tool's roll if it is free, rad: 30 degrees.
pub(super) const ROLL_STEP_RAD: f64 = TAU / ROLLS as f64;
const ROLLS: i32 = 12;
/// Step of the arm's swivel, rad: 5 degrees.
pub(super) const SWIVEL_STEP_RAD: f64 = TAU / 72.0;

/// The person's decision variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    pub place_w_m: [f64; 2],
    pub heading_rad: f64,
    pub roll_rad: f64,
    pub swivel_rad: f64,
    pub branch: ShoulderBranch,
}

/// A feasible response of the person. On the grid the standing place is a multiple of 5 cm along x_W and y_W, the heading of
/// 10 degrees, the roll (if free) of 30 degrees and the swivel of 5 degrees, for each branch of the shoulder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    pub(super) choice: Choice,
    /// Pose of the body.
    pub x_wb: Pose,
    /// Angles of the working arm, rad.
    pub q_rad: ArmAngles,
    /// Muscular comfort.
    pub muscular: Muscular,
    /// Peripersonal comfort, m.
    pub peripersonal_m: f64,
    /// The weighted sum of both comforts.
    pub objective: f64,
}

impl Response {
    /// The tool's roll relative to the operation's, rad.
    #[must_use]
    pub fn roll_rad(&self) -> f64 {
        self.choice.roll_rad
    }
}

/// A standing pose of the grid: multiples of the steps in x, y and heading.
pub(super) type GridPlace = [i32; 3];

/// The pose of the tool tip at one roll.
struct RolledTool {
    roll_rad: f64,
    x_wt: Pose,
    /// Required position of the wrist, m.
    p_ww: Point3<f64>,
    /// The worked face's normal in T.
    normal_t: Vector3<f64>,
}

impl RolledTool {
    fn new(query: &ResponseQuery<'_>, roll_rad: f64) -> Self {
        let operation = query.operation.rolled(roll_rad);
        let x_wt = query.scene.x_wo * operation.x_ot;
        let wrist = x_wt * query.human.x_ht().inverse();
        let normal_t = operation.face_normal_t(query.scene.board.thickness_m());
        Self { roll_rad, x_wt, p_ww: wrist.translation.vector.into(), normal_t }
    }

    fn all(query: &ResponseQuery<'_>) -> Vec<Self> {
        let rolls = if query.operation.kind.roll_is_free() { ROLLS } else { 1 };
        (0..rolls).map(|k| Self::new(query, f64::from(k) * ROLL_STEP_RAD)).collect()
    }
}

/// Calls `visitor` with every feasible response of the grid, in a fixed order, until a stop.
pub(super) fn visit(query: &ResponseQuery<'_>, mut visitor: impl FnMut(GridPlace, &Response)) {
    let tools = RolledTool::all(query);
    let reach_m = query.human.reach_m();
    let origin = query.human.given_standing();
    for k in 0..HEADINGS {
        let heading_rad = origin.heading_rad + f64::from(k) * HEADING_STEP_RAD;
        let shoulder = standing_pose_w(0.0, 0.0, heading_rad, query.floor_z_m) * query.human.x_bs();
        let p_shoulder_m = shoulder.translation.vector;
        let [xs, ys] = [0, 1].map(|axis| {
            let wrists = || tools.iter().map(|tool| tool.p_ww[axis] - p_shoulder_m[axis]);
            let low_m = wrists().fold(f64::INFINITY, f64::min) - reach_m - origin.p_wb_m[axis];
            let high_m = wrists().fold(f64::NEG_INFINITY, f64::max) + reach_m - origin.p_wb_m[axis];
            (low_m / PLACE_STEP_M).ceil() as i32..=(high_m / PLACE_STEP_M).floor() as i32
        });
        for (i, j) in xs.flat_map(|i| ys.clone().map(move |j| (i, j))) {
            if query.stop.is_stopped() {
                return;
            }
            let step_m = [i, j].map(|step| f64::from(step) * PLACE_STEP_M);
            let place_w_m = [0, 1].map(|axis| origin.p_wb_m[axis] + step_m[axis]);
            if !query.human.may_stand(&Standing { p_wb_m: place_w_m, heading_rad }) {
                continue;
            }
            let p_ws = Point3::new(place_w_m[0], place_w_m[1], 0.0) + p_shoulder_m;
            let standing = StandingPose::new(query, place_w_m, heading_rad);
            for tool in tools.iter().filter(|tool| (tool.p_ww - p_ws).norm() <= reach_m) {
                standing.visit(tool, |response| visitor([i, j, k], response));
            }
        }
    }
}

/// The response of a choice, if it is feasible.
pub(super) fn response_to(query: &ResponseQuery<'_>, choice: &Choice) -> Option<Response> {
    let Choice { place_w_m, heading_rad, .. } = *choice;
    if !query.human.may_stand(&Standing { p_wb_m: place_w_m, heading_rad }) {
        return None;
    }
    let standing = StandingPose::new(query, place_w_m, heading_rad);
    let tool = RolledTool::new(query, choice.roll_rad);
    let circle = standing.circle(&tool)?;
    standing.response(&circle, &tool, *choice)
}

/// A standing place and heading.
struct StandingPose<'a> {
    query: &'a ResponseQuery<'a>,
    place_w_m: [f64; 2],
    heading_rad: f64,
    x_wb: Pose,
    wrench_w: Wrench,
    /// Distances of the robot's points from the body points that do not move with the arm; `None` inside if those parts break
    /// a clearance.
    still: OnceCell<Option<Distances>>,
}

impl<'a> StandingPose<'a> {
    fn new(query: &'a ResponseQuery<'a>, place_w_m: [f64; 2], heading_rad: f64) -> Self {
        let [x_m, y_m] = place_w_m;
        let x_wb = standing_pose_w(x_m, y_m, heading_rad, query.floor_z_m);
        let wrench_w = query.operation.wrench_w(&query.scene.x_wo);
        Self { query, place_w_m, heading_rad, x_wb, wrench_w, still: OnceCell::new() }
    }

    /// The solutions of the arm; `None` out of reach, or if the tool's pose is not that of a natural posture.
    fn circle(&self, tool: &RolledTool) -> Option<SwivelCircle> {
        let x_bt = self.x_wb.inverse() * tool.x_wt;
        match self.query.human.work_violation(&x_bt, &tool.normal_t) {
            None => self.query.human.swivel_circle(&x_bt),
            Some(_) => None,
        }
    }

    /// Calls `visitor` with the feasible responses at this standing pose and one roll of the tool.
    fn visit(&self, tool: &RolledTool, mut visitor: impl FnMut(&Response)) {
        let Some(circle) = self.circle(tool) else { return };
        for SwivelInterval { branch, from_rad, to_rad } in circle.intervals() {
            let first = (from_rad / SWIVEL_STEP_RAD).ceil() as i32;
            // Both ends of a full circle are the same angle.
            let whole = to_rad - from_rad >= TAU;
            let last = (to_rad / SWIVEL_STEP_RAD).floor() as i32 - i32::from(whole);
            for swivel_rad in (first..=last).map(|k| f64::from(k) * SWIVEL_STEP_RAD) {
                let Self { place_w_m, heading_rad, .. } = *self;
                let choice = Choice { place_w_m, heading_rad, roll_rad: tool.roll_rad, swivel_rad, branch };
                if let Some(response) = self.response(&circle, tool, choice) {
                    visitor(&response);
                }
            }
        }
    }

    /// The response of a choice, if it is feasible.
    fn response(&self, circle: &SwivelCircle, tool: &RolledTool, choice: Choice) -> Option<Response> {
        let ResponseQuery { human, settings, robot_points_w, .. } = *self.query;
        let q_rad = circle.solution(choice.swivel_rad, choice.branch)?;
        let muscular = human.muscular(&q_rad, &self.x_wb, &self.wrench_w, &settings);
        if muscular.activations.iter().any(|&activation| activation > 1.0) {
            return None;
        }
        let mut distances = (*self.still.get_or_init(|| self.still(&q_rad)))?;
        if self.breaks_clearance(&q_rad, true) || !self.sees(&q_rad, tool) {
            return None;
        }
        distances.add(&human.body_points_w(&self.x_wb, &q_rad)[STILL_POINTS..], robot_points_w);
        let peripersonal_m = distances.peripersonal_m(settings.peripersonal);
        let objective = objective(&settings, muscular.regularised, peripersonal_m);
        Some(Response { choice, x_wb: self.x_wb, q_rad, muscular, peripersonal_m, objective })
    }

    fn still(&self, q_rad: &ArmAngles) -> Option<Distances> {
        if self.breaks_clearance(q_rad, false) {
            return None;
        }
        let mut distances = Distances::new(self.query.settings.saturation_m);
        distances.add(&self.query.human.body_points_w(&self.x_wb, q_rad)[..STILL_POINTS], self.query.robot_points_w);
        Some(distances)
    }

    /// True if nothing is in the line of sight, or nothing needs to be out of it.
    fn sees(&self, q_rad: &ArmAngles, tool: &RolledTool) -> bool {
        let ResponseQuery { human, collision, scene, .. } = *self.query;
        if !human.needs_sight() {
            return true;
        }
        let person = human.capsules_w(&self.x_wb, q_rad).map(PersonPart::from);
        let scene = Scene { person: &person, ..scene };
        let tip_w = tool.x_wt.translation.vector.into();
        collision.free_share_of_sight(&scene, &(self.x_wb * human.eye_b()), &tip_w) >= 1.0
    }

    /// True if the working arm and the tool (`arm`), or all other parts, break a clearance.
    fn breaks_clearance(&self, q_rad: &ArmAngles, arm: bool) -> bool {
        let capsules = self.query.human.capsules_w(&self.x_wb, q_rad);
        let parts: Vec<_> =
            capsules.into_iter().filter(|part| part.name.moves_with_arm() == arm).map(PersonPart::from).collect();
        let scene = Scene { person: &parts, ..self.query.scene };
        self.query.collision.first_violation_of_person(&scene).is_some()
    }
}
