//! The scene: the arms that hold, the board, gravity and the tool.

use nalgebra::{Isometry3, Point3, Vector3};
use rapier3d_f64::prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder};

use super::{
    SimError,
    arm::SimArm,
    border, check,
    pad::TouchedBoard,
    world::{board_groups, new_world},
};
use crate::{
    model::{
        frames::Pose,
        plan::{PlacedObject, Plan},
        trace::{ArmSample, PadSample, Phase, Sample},
        wrench::Wrench,
    },
    robot::Robot,
};

/// A joint speed that no servo reaches, rad/s: beyond it the engine has lost the state. (A board that was dropped may
/// well reach any speed under a steady load.)
const LOST_RAD_S: f64 = 100.0;

/// A board held by arms, stepped by hand. `sim::simulate` runs one through a plan's load; tests load it as they like.
pub struct Scene {
    world: PhysicsWorld,
    arms: Vec<SimArm>,
    board: TouchedBoard,
    /// The operation's wrench about the tool point, O axes.
    wrench_o: Wrench,
    /// The tool point in O, m.
    p_ot_m: Vector3<f64>,
    /// The multiple of the wrench that acted in the last step.
    load_factor: f64,
    /// The wrench that acted then, about the tool point, world axes.
    tool_wrench_w: Wrench,
}

impl Scene {
    /// Builds the scene of a plan: the arms that hold, standing still at the planned angles with their pads on the
    /// board, and the board.
    ///
    /// # Errors
    /// [`SimError`] when the plan does not fit the robot or itself.
    pub fn new(robot: &Robot, plan: &Plan, friction: f64, timestep_s: f64) -> Result<Self, SimError> {
        let holds = check::holds(robot, plan, friction)?;
        let mut world = new_world(timestep_s);
        let board = insert_board(&mut world, &plan.object, friction);
        let mut arms = Vec::with_capacity(holds.len());
        for hold in holds {
            let arm = SimArm::new(&mut world, robot, hold.arm_index, hold.hold, &plan.object, friction)?;
            check::hand_is_where_planned(hold.hold, &plan.object.x_wo, &arm.gripper.x_wg(&world))?;
            arms.push(arm);
        }
        let Plan { operation, .. } = plan;
        Ok(Self {
            world,
            arms,
            board,
            wrench_o: operation.wrench_o,
            p_ot_m: operation.x_ot.translation.vector,
            load_factor: 0.0,
            tool_wrench_w: Wrench::default(),
        })
    }

    /// One time step under `load_factor` times the operation's wrench, which turns with the board.
    pub fn step(&mut self, load_factor: f64) {
        let timestep_s = self.world.integration_parameters.dt;
        for arm in &mut self.arms {
            arm.drive(&mut self.world, timestep_s);
        }
        self.load_factor = load_factor;
        self.push_board();
        self.world.step();
    }

    /// Lays the tool's wrench on the board for one step.
    fn push_board(&mut self) {
        let x_wo = self.x_wo();
        let Wrench { force_n, moment_nm } = self.wrench_o.scaled(self.load_factor);
        self.tool_wrench_w = Wrench::new(x_wo.rotation * force_n, x_wo.rotation * moment_nm);
        let tip_w = x_wo * Point3::from(self.p_ot_m);
        let body = &mut self.world.bodies[self.board.body];
        body.reset_forces(false);
        body.reset_torques(false);
        body.add_force_at_point(border::vector(&self.tool_wrench_w.force_n), border::vector(&tip_w.coords), false);
        body.add_torque(border::vector(&self.tool_wrench_w.moment_nm), false);
    }

    /// Pose of the board.
    pub fn x_wo(&self) -> Pose {
        border::from_engine_pose(self.world.bodies[self.board.body].position())
    }

    /// Writes the state, and the forces of the last step, into a sample of [`blank_sample`]'s shape. Time and phase are
    /// the caller's.
    pub fn observe(&self, sample: &mut Sample) {
        sample.load_factor = self.load_factor;
        sample.tool_wrench_w = self.tool_wrench_w;
        sample.x_wo = self.x_wo();
        for (arm, sample_arm) in self.arms.iter().zip(&mut sample.arms) {
            arm.observe_joints(&self.world, sample_arm);
            sample_arm.x_oc = sample.x_wo.inverse() * arm.gripper.x_wc(&self.world);
            for (pad, sample_pad) in arm.gripper.pads.iter().zip(&mut sample_arm.pads) {
                *sample_pad = pad.observe(&self.world, self.board);
            }
        }
    }

    /// Why the state can no longer be believed, if so.
    pub fn breakdown(&self) -> Option<&'static str> {
        if !self.world.quarantine().is_empty() {
            return Some("the state is no longer finite");
        }
        let calm = self.arms.iter().all(|arm| arm.is_slower_than(&self.world, LOST_RAD_S));
        if calm { None } else { Some("the joint speeds have blown up") }
    }
}

/// The board as a free body of evenly spread mass.
fn insert_board(world: &mut PhysicsWorld, object: &PlacedObject, friction: f64) -> TouchedBoard {
    let [hx, hy, hz] = object.size_m.map(|side| side / 2.0);
    // A sleeping board would ignore a load until it is woken.
    let body = RigidBodyBuilder::dynamic().pose(border::engine_pose(&object.x_wo)).can_sleep(false);
    let body = world.bodies.insert(body);
    let collider =
        ColliderBuilder::cuboid(hx, hy, hz).mass(object.mass_kg).friction(friction).collision_groups(board_groups());
    let collider = world.colliders.insert_with_parent(collider, body, &mut world.bodies);
    world.bodies[body].recompute_mass_properties_from_colliders(&world.colliders);
    TouchedBoard { body, collider }
}

/// A sample of the right shape, with nothing observed yet.
pub fn blank_sample(plan: &Plan) -> Sample {
    let pad = PadSample { normal_force_n: 0.0, wrench_w: Wrench::default(), p_wp_m: Vector3::zeros() };
    let arms = plan.arms.iter().map(|hold| ArmSample {
        q_rad: hold.q_rad.clone(),
        finger_m: vec![0.0; 2],
        torque_demanded_nm: vec![0.0; hold.q_rad.len()],
        torque_applied_nm: vec![0.0; hold.q_rad.len()],
        x_oc: Isometry3::identity(),
        pads: vec![pad; 2],
    });
    Sample {
        time_s: 0.0,
        phase: Phase::Settle,
        load_factor: 0.0,
        tool_wrench_w: Wrench::default(),
        x_wo: plan.object.x_wo,
        arms: arms.collect(),
    }
}
