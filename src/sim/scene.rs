//! The scene: the arms that hold, the board, gravity and the tool.

use nalgebra::Vector3;
use rapier3d_f64::prelude::{
    ColliderBuilder, IntegrationParameters, PhysicsWorld, RigidBodyBuilder, SpringCoefficients,
};

use super::{
    SimError,
    arm::SimArm,
    border, check,
    pad::{TouchedBoard, board_groups},
};
use crate::{
    model::{
        GRAVITY_W,
        frames::Pose,
        plan::{PlacedObject, Plan},
        trace::Sample,
        wrench::Wrench,
    },
    robot::Robot,
};

/// Substeps of the engine's solver in a step.
const SUBSTEPS: usize = 4;

/// Stiffness of the contacts as a frequency, Hz: at 30 Hz pads sink in by millimetres, at 10 kHz the solver stops
/// converging; between lies a plateau.
const CONTACT_FREQUENCY_HZ: f64 = 1000.0;

/// Damping of the contacts, as a multiple of the critical one.
const CONTACT_DAMPING_RATIO: f64 = 10.0;

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
            let arm = SimArm::new(&mut world, robot, hold.arm, hold.hold, &plan.object, friction)?;
            check::hand_is_where_planned(hold.hold, &plan.object.x_wo, &arm.gripper.x_wg(&world))?;
            arms.push(arm);
        }
        let Plan { operation, .. } = plan;
        Ok(Self { world, arms, board, wrench_o: operation.wrench_o, p_ot_m: operation.x_ot.translation.vector })
    }

    /// One time step under `load_factor` times the operation's wrench, which turns with the board.
    pub fn step(&mut self, load_factor: f64) {
        let timestep_s = self.world.integration_parameters.dt;
        for arm in &mut self.arms {
            arm.drive(&mut self.world, timestep_s);
        }
        let wrench_w = self.tool_wrench_w(load_factor);
        let tip_w = self.x_wo() * nalgebra::Point3::from(self.p_ot_m);
        let body = &mut self.world.bodies[self.board.body];
        body.reset_forces(false);
        body.reset_torques(false);
        body.add_force_at_point(border::vector(&wrench_w.force_n), border::vector(&tip_w.coords), false);
        body.add_torque(border::vector(&wrench_w.moment_nm), false);
        self.world.step();
    }

    /// Pose of the board.
    pub fn x_wo(&self) -> Pose {
        border::from_engine_pose(self.world.bodies[self.board.body].position())
    }

    /// `load_factor` times the operation's wrench about the tool point, world axes.
    fn tool_wrench_w(&self, load_factor: f64) -> Wrench {
        let rotation = self.x_wo().rotation;
        let Wrench { force_n, moment_nm } = self.wrench_o.scaled(load_factor);
        Wrench::new(rotation * force_n, rotation * moment_nm)
    }

    /// Writes the state into a sample that has a place for every arm, joint and pad.
    pub fn observe(&self, load_factor: f64, sample: &mut Sample) {
        let substep_s = self.world.integration_parameters.dt / SUBSTEPS as f64;
        sample.load_factor = load_factor;
        sample.tool_wrench_w = self.tool_wrench_w(load_factor);
        sample.x_wo = self.x_wo();
        for (arm, sample_arm) in self.arms.iter().zip(&mut sample.arms) {
            arm.observe_joints(&self.world, sample_arm);
            sample_arm.x_oc = sample.x_wo.inverse() * arm.gripper.x_wc(&self.world);
            for (pad, sample_pad) in arm.gripper.pads.iter().zip(&mut sample_arm.pads) {
                *sample_pad = pad.observe(&self.world, self.board, substep_s);
            }
        }
    }

    /// Why the state can no longer be believed, if so.
    pub fn breakdown(&self) -> Option<&'static str> {
        if !self.world.quarantine().is_empty() {
            return Some("the state is no longer finite");
        }
        let joint_rad_s = self.arms.iter().map(|arm| arm.fastest_joint_rad_s(&self.world)).fold(0.0, f64::max);
        // Written so that a speed that is not a number counts as lost.
        if joint_rad_s <= LOST_RAD_S { None } else { Some("the joint speeds have blown up") }
    }
}

/// A world with the settings of this module's documentation.
fn new_world(timestep_s: f64) -> PhysicsWorld {
    let softness = SpringCoefficients::new(CONTACT_FREQUENCY_HZ, CONTACT_DAMPING_RATIO);
    PhysicsWorld {
        gravity: border::vector(&GRAVITY_W),
        integration_parameters: IntegrationParameters {
            dt: timestep_s,
            num_solver_iterations: SUBSTEPS,
            num_internal_pgs_iterations: 1,
            num_internal_stabilization_iterations: 1,
            contact_softness: softness,
            static_contact_softness: softness,
            // A recycled contact outlives the geometry: a hand would hold on to a board that it has left.
            contact_recycling: false,
            // Clustering would merge the boxes of a pad into one with four corners.
            contact_clustering: false,
            // Without it every change of load slides the hands a little: 3 mrad and 0.16 mm short of the limit, against
            // 0.1 mrad and 0.001 mm.
            friction_in_bias_pass: true,
            normalized_prediction_distance: 0.002,
            ..IntegrationParameters::default()
        },
        ..PhysicsWorld::default()
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
