//! The scene: arms, board, gravity and the tool's wrench.

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d_f64::prelude::{PhysicsWorld, RigidBodyHandle};

use super::{
    arm::{PlacedBoard, SimArm},
    balance::{Balance, mechanical_energy_j, weight_n},
    board::insert_board,
    conditions::Conditions,
    convert,
    error::SimError,
    feed_forward::feed_forward,
    hand_over::HandOver,
    pad::BoardHandles,
    staged::{ArmCommand, NewGrasp},
    tool_load::{ToolState, wrench_w},
    world::{new_world, sweep_for_joints},
};
use crate::{
    check::{CheckedArm, CheckedPlan},
    model::{
        frames::Pose,
        load::ForceFrame,
        plan::ArmHold,
        trace::{ArmSample, PadSample, Phase, Sample, StepCheck},
        wrench::Wrench,
    },
};

/// A joint speed that no servo reaches, rad/s: beyond it the engine's state is invalid. (A dropped board may reach any
/// speed under a constant load.)
const LOST_RAD_S: f64 = 100.0;

/// A board held by arms, advanced step by step. [`simulate`](super::simulate) applies a plan's load; tests apply their
/// own.
pub struct SimScene {
    world: PhysicsWorld,
    arms: Vec<SimArm>,
    /// The board as each arm touches it; its body is the same for all.
    boards: Vec<BoardHandles>,
    board: RigidBodyHandle,
    /// The operation's wrench about the tool point, O axes.
    wrench_o: Wrench,
    /// The tool point in O, m.
    p_ot_m: Vector3<f64>,
    /// The frame in which the tool's direction is fixed.
    frame: ForceFrame,
    /// The planned pose of the board.
    x_wo_planned: Pose,
    /// State of the tool in the last step.
    tool: ToolState,
    /// The tool's wrench in the last step, about the tool point, world axes.
    tool_wrench_w: Wrench,
    /// The closing of the grippers and the hand-over of the board.
    hand_over: HandOver,
    /// Balance of momentum and energy.
    balance: Balance,
}

impl SimScene {
    /// Builds the scene of a plan: the board, and the arms at rest at the planned angles with their pads on the board.
    ///
    /// # Errors
    /// If the conditions are invalid, or a moving part of the robot has no mass.
    pub fn new(checked: &CheckedPlan<'_>, conditions: &Conditions) -> Result<Self, SimError> {
        let plan = checked.plan();
        conditions.check()?;
        let stiffness_scale = conditions.uncertainty.contact_stiffness_scale;
        let mut world = new_world(conditions.settings.timestep_s, stiffness_scale);
        if checked.arms().iter().any(|arm| checked.robot().arms[arm.index].gripper.holding.measured().is_some()) {
            sweep_for_joints(&mut world);
        }
        let object = conditions.uncertainty.board(&plan.object);
        let boards = insert_board(&mut world, &object, &plan.arms);
        // A checked plan has an arm.
        let board = boards.first().ok_or(SimError::Engine)?.body;
        let mut arms = Vec::with_capacity(checked.arms().len());
        for (number, (arm, feed_forward)) in checked.arms().iter().zip(feed_forward(checked, conditions)).enumerate() {
            let on = PlacedBoard { object: &object, body: board };
            arms.push(SimArm::new(&mut world, checked.robot(), (number, arm), feed_forward, on, conditions)?);
        }
        let energy_j = energy_j(&world, &arms, board);
        let operation = conditions.uncertainty.operation(&plan.operation);
        let p_ot_m = operation.x_ot.translation.vector;
        Ok(Self {
            balance: Balance::new(&world, board, energy_j),
            world,
            arms,
            boards,
            board,
            wrench_o: operation.wrench_o,
            p_ot_m,
            frame: conditions.load.frame,
            x_wo_planned: plan.object.x_wo,
            hand_over: HandOver::new(&conditions.settings),
            tool: ToolState { load_factor: 0.0, wrench_o: Wrench::default(), p_ot_m },
            tool_wrench_w: Wrench::default(),
        })
    }

    /// One time step under `load_factor` times the operation's wrench, without a sideways push.
    pub fn step(&mut self, load_factor: f64) {
        let wrench_o = self.wrench_o.scaled(load_factor);
        self.step_under(ToolState { load_factor, wrench_o, p_ot_m: self.p_ot_m });
    }

    /// One time step under a state of the tool.
    pub(super) fn step_under(&mut self, tool: ToolState) {
        let timestep_s = self.world.integration_parameters.dt;
        self.hand_over.advance();
        for arm in &mut self.arms {
            arm.drive(&mut self.world, timestep_s, &self.hand_over);
        }
        self.tool = tool;
        self.push_board();
        self.world.step();
        for arm in &mut self.arms {
            arm.hand.end_step(&mut self.world);
        }
        let worked_j = self.arms.iter().map(|arm| arm.work_j(&self.world)).sum();
        let energy_j = energy_j(&self.world, &self.arms, self.board);
        self.balance.end_step(&self.world, energy_j, worked_j);
    }

    /// Applies the tool's wrench, and the support of the hand-over, to the board for one step.
    fn push_board(&mut self) {
        let x_wo = self.x_wo();
        self.tool_wrench_w = wrench_w(self.frame, &self.tool.wrench_o, &x_wo, &self.x_wo_planned);
        let tip_w = x_wo * Point3::from(self.tool.p_ot_m);
        let body = &self.world.bodies[self.board];
        let com_w = body.center_of_mass();
        let support = Wrench::from_force(weight_n(body) * (self.hand_over.carried_share() - 1.0));
        let outer_w = self.tool_wrench_w + support.about(&(convert::from_engine_vector(com_w) - tip_w.coords));
        self.balance.begin_step(&self.world, &outer_w, &tip_w.coords);
        let body = &mut self.world.bodies[self.board];
        body.reset_forces(false);
        body.reset_torques(false);
        body.add_force_at_point(
            convert::to_engine_vector(&self.tool_wrench_w.force_n),
            convert::to_engine_vector(&tip_w.coords),
            false,
        );
        body.add_torque(convert::to_engine_vector(&self.tool_wrench_w.moment_nm), false);
        body.add_force_at_point(convert::to_engine_vector(&support.force_n), com_w, false);
    }

    /// Gives the arms new targets.
    pub(super) fn command(&mut self, arms: &[ArmCommand]) {
        for (arm, command) in self.arms.iter_mut().zip(arms) {
            arm.command(command);
        }
    }

    /// # Errors
    /// [`SimError::Staged`] if a gripper has no rigid pads: it cannot let go and grip again.
    pub(super) fn may_regrasp(&self) -> Result<(), SimError> {
        if self.arms.iter().all(SimArm::has_rigid_pads) { Ok(()) } else { Err(SimError::Staged) }
    }

    /// Gives an arm the pads of a new grasp of a box, and its grip force.
    pub(super) fn regrip(&mut self, initial: &CheckedPlan<'_>, grasp: &NewGrasp, conditions: &Conditions) {
        let NewGrasp { arm, x_og, grip_force_n } = *grasp;
        let checked = &initial.arms()[arm];
        let hold = ArmHold { x_og, grip_force_n, ..checked.hold.clone() };
        let object = conditions.uncertainty.board(&initial.plan().object);
        self.arms[arm].regrip(&mut self.world, initial.robot(), (arm, checked.index, &hold), &object, conditions);
    }

    /// X_WO.
    pub fn x_wo(&self) -> Pose {
        convert::from_engine_pose(self.world.bodies[self.board].position())
    }

    /// Writes the state and the forces of the last step into a sample of [`blank_sample`]'s shape. The caller sets time
    /// and phase.
    pub fn observe(&self, sample: &mut Sample) {
        sample.load_factor = self.tool.load_factor;
        sample.p_ot_m = self.tool.p_ot_m;
        sample.tool_wrench_w = self.tool_wrench_w;
        sample.x_wo = self.x_wo();
        for ((arm, &board), sample_arm) in self.arms.iter().zip(&self.boards).zip(&mut sample.arms) {
            arm.observe_joints(&self.world, sample_arm);
            sample_arm.x_oc = sample.x_wo.inverse() * arm.hand.x_wc(&self.world);
            arm.hand.observe(&self.world, board, sample_arm);
        }
        sample.self_check = self.self_check(&sample.arms);
    }

    /// The self-checks of the last step.
    fn self_check(&self, observed: &[ArmSample]) -> StepCheck {
        let pads = self.arms.iter().zip(&self.boards);
        let pads = pads.flat_map(|(arm, &board)| arm.hand.pads().iter().map(move |pad| (pad, board)));
        let pads_w_n: Vector3<f64> = observed.iter().flat_map(|arm| &arm.pads).map(|pad| pad.wrench_w.force_n).sum();
        let joints = self.arms.iter().map(|arm| arm.hand.joint_force_w_n(&self.world));
        let hands_w_n = joints.fold(pads_w_n, |sum, force_n| sum + force_n);
        let apart_m = |arm: &ArmSample| (arm.finger_m[0] - arm.finger_m[1]).abs();
        StepCheck {
            penetration_m: pads.map(|(pad, board)| pad.penetration_m(&self.world, board)).fold(0.0, f64::max),
            force_residual_n: self.balance.force_residual_n(&self.world, &hands_w_n),
            coupling_m: observed.iter().map(apart_m).fold(0.0, f64::max),
            contact_energy_j: self.balance.contact_energy_j,
        }
    }

    /// Why the state is invalid; `None` if it is valid.
    pub fn breakdown(&self) -> Option<&'static str> {
        if !self.world.quarantine().is_empty() {
            return Some("the state is no longer finite");
        }
        let calm = self.arms.iter().all(|arm| arm.is_slower_than(&self.world, LOST_RAD_S));
        if calm { None } else { Some("the joint speeds have blown up") }
    }
}

/// Kinetic and gravitational energy of arms and board, J.
fn energy_j(world: &PhysicsWorld, arms: &[SimArm], board: RigidBodyHandle) -> f64 {
    arms.iter().map(|arm| arm.energy_j(world)).sum::<f64>() + mechanical_energy_j(&world.bodies[board])
}

/// A sample of the right shape, without observations.
#[must_use]
pub fn blank_sample(checked: &CheckedPlan<'_>) -> Sample {
    let plan = checked.plan();
    let pad = PadSample { normal_force_n: 0.0, wrench_w: Wrench::default(), p_wp_m: Vector3::zeros() };
    let arms = checked.arms().iter().map(|CheckedArm { index, hold, .. }| {
        let has_pads = checked.robot().arms[*index].gripper.holding.pads().is_some();
        ArmSample {
            q_rad: hold.q_rad.clone(),
            finger_m: vec![0.0; 2],
            torque_demanded_nm: vec![0.0; hold.q_rad.len()],
            torque_applied_nm: vec![0.0; hold.q_rad.len()],
            x_oc: Isometry3::identity(),
            pads: vec![pad; if has_pads { 2 } else { 0 }],
            grip_wrench_g: (!has_pads).then(Wrench::default),
        }
    });
    Sample {
        time_s: 0.0,
        phase: Phase::Grip,
        load_factor: 0.0,
        tool_wrench_w: Wrench::default(),
        x_wo: plan.object.x_wo,
        p_ot_m: plan.operation.x_ot.translation.vector,
        arms: arms.collect(),
        self_check: StepCheck::default(),
        person_distance_m: None,
        robot_clearance_m: None,
    }
}
