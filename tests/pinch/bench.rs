//! A gripper fixed in the world that grips a block: a minimal robot, built by the same code as any other.

use benchdog::{
    model::{
        FORMAT,
        frames::Pose,
        operation::{Operation, OperationKind},
        plan::{ArmHold, PlacedObject, Plan},
        scenario::SimulationSettings,
        trace::Sample,
        wrench::Wrench,
    },
    robot::{Arm, Finger, Gripper, Holding, Joint, JointKind, Link, Pad, PadGrip, Robot, RobotOptions},
    sim::{Conditions, SimScene, blank_sample},
};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

/// Time step of all tests, s.
const TIMESTEP_S: f64 = 0.002;

/// Half sides of the pad along x_G and z_G, m.
pub const PAD_HALF_M: [f64; 2] = [0.0202, 0.018];

/// Thickness of the block, m.
pub const THICKNESS_M: f64 = 0.03;

fn link(name: &str, parent_joint: Option<usize>, mass_kg: f64, box_m: [f64; 3]) -> Link {
    let [x, y, z] = box_m.map(|side| side * side * mass_kg / 12.0);
    Link {
        name: name.into(),
        parent_joint,
        mass_kg,
        com_l: Vector3::zeros(),
        inertia_l: Matrix3::from_diagonal(&Vector3::new(y + z, x + z, x + y)),
        shapes: Vec::new(),
        visuals: Vec::new(),
    }
}

fn joint(kind: JointKind, links: [usize; 2], x_pj: Pose, axis_j: Vector3<f64>, limits: [f64; 2]) -> Joint {
    Joint {
        name: format!("joint {}", links[1]),
        kind,
        parent_link: links[0],
        child_link: links[1],
        x_pj,
        axis_j: nalgebra::Unit::new_normalize(axis_j),
        lower: limits[0],
        upper: limits[1],
        rest: 0.0_f64.clamp(limits[0], limits[1]),
        most_speed: 0.0,
        mimic: None,
    }
}

fn finger(name: &str, link: usize, opening_sign: f64) -> Finger {
    let pad = Pad {
        name: name.into(),
        link,
        size_m: PAD_HALF_M.map(|half| 2.0 * half),
        centre_m: [0.0, -0.0149],
        offset_m: -0.00185,
    };
    Finger { joint: link - 1, closed_m: 0.0, opening_sign, max_travel_m: 0.020833, pad }
}

/// A gripper with Baxter's dimensions, welded to the world with G at `x_wg`, or on one hinge about the world's z.
pub fn robot(x_wg: Pose, hinge: Option<Hinge>) -> Robot {
    // G is 0.15 m in front of the finger joints; slot 1 of the palm.
    let finger_at = |side: f64| Isometry3::translation(0.0, -0.011 * side, -0.1327);
    let carrier = if hinge.is_some() { JointKind::Revolute } else { JointKind::Fixed };
    let links = vec![
        link("world", None, 0.0, [0.1; 3]),
        link("palm", Some(0), 0.3, [0.07, 0.1, 0.05]),
        link("left finger", Some(1), 0.03, [0.015, 0.0125, 0.112]),
        link("right finger", Some(2), 0.03, [0.015, 0.0125, 0.112]),
    ];
    let joints = vec![
        joint(carrier, [0, 1], x_wg, x_wg.rotation.inverse() * Vector3::z(), [-3.0, 3.0]),
        joint(JointKind::Prismatic, [1, 2], finger_at(1.0), Vector3::y(), [0.0, 0.020833]),
        joint(JointKind::Prismatic, [1, 3], finger_at(-1.0), Vector3::y(), [-0.020833, 0.0]),
    ];
    let arm = Arm {
        name: "arm".into(),
        joints: if hinge.is_some() { vec![0] } else { Vec::new() },
        effort_nm: hinge.iter().map(|hinge| hinge.effort_nm).collect(),
        stiffness_nm_rad: hinge.iter().map(|hinge| hinge.stiffness_nm_rad).collect(),
        damping_nm_s_rad: hinge.iter().map(|hinge| hinge.damping_nm_s_rad).collect(),
        gripper: Gripper {
            frame_link: 1,
            palm_link: 1,
            fingers: vec![finger("left", 2, 1.0), finger("right", 3, -1.0)],
            cup: None,
            opening_m: [-0.0037, 0.038],
            holding: Holding::Pads(PadGrip {
                max_force_n: 100.0,
                grip_force_n: None,
                friction: None,
                pad_stiffness_n_m: None,
            }),
            linkage: None,
        },
    };
    Robot {
        description: "bench".into(),
        links,
        x_wr: Pose::identity(),
        joints,
        arms: vec![arm],
        allowed_collisions: Vec::new(),
        body_points: Vec::new(),
        floor_z_m: -1.0,
        search_box: None,
        with_linkages: None,
        options: RobotOptions::default(),
        notes: Vec::new(),
        files: Vec::new(),
    }
}

/// A servo in the gripper's hinge.
#[derive(Clone, Copy)]
pub struct Hinge {
    pub effort_nm: f64,
    pub stiffness_nm_rad: f64,
    pub damping_nm_s_rad: f64,
}

/// A block in a gripper.
pub struct Grip {
    pub force_n: f64,
    pub friction: f64,
    pub mass_kg: f64,
}

/// Fingers that close along the world's y, palm behind them along -x: gravity acts along x_G, in the plane of the pads.
pub fn fingers_level() -> Pose {
    // Columns: x_G = -z_W, y_G = y_W, z_G = x_W.
    let axes = Matrix3::new(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0);
    let rotation = UnitQuaternion::from_matrix(&axes);
    Isometry3::from_parts(Translation3::new(0.5, 0.1, 0.2), rotation)
}

/// A block held at the centre of its faces, with a wrench in the gripper's axes about the centre between the pads.
pub fn plan(robot: &Robot, x_wg: Pose, grip: &Grip, wrench_g: Wrench) -> Plan {
    let arm = &robot.arms[0];
    // z_O is y_G, x_O is x_G, y_O is -z_G.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
    let x_go = Isometry3::from_parts(Translation3::from(arm.gripper.grasp_point_g()), turn);
    let rotation_og = turn.inverse();
    Plan {
        format: FORMAT,
        name: "bench".into(),
        robot: "bench".into(),
        operation: Operation {
            kind: OperationKind::Wrench,
            wrench_o: Wrench::new(rotation_og * wrench_g.force_n, rotation_og * wrench_g.moment_nm),
            x_ot: Pose::identity(),
        },
        object: PlacedObject::cuboid([0.1, 0.1, THICKNESS_M], grip.mass_kg, x_wg * x_go),
        arms: vec![ArmHold {
            name: arm.name.clone(),
            joints: arm.joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect(),
            q_rad: vec![0.0; arm.joints.len()],
            x_og: x_go.inverse(),
            grip_force_n: grip.force_n,
        }],
        human: None,
        comfort: None,
        muscles: None,
        stability: None,
        clearance: None,
        planner: None,
        scenario: None,
        benchdog: None,
    }
}

/// A scene and its last observed state.
pub struct Bench {
    pub scene: SimScene,
    pub sample: Sample,
}

impl Bench {
    /// A welded gripper with level fingers that grips a block, and a wrench in its axes.
    pub fn welded(grip: &Grip, wrench_g: Wrench) -> Self {
        let robot = robot(fingers_level(), None);
        let plan = plan(&robot, fingers_level(), grip, wrench_g);
        Self::new(&robot, &plan, grip.friction)
    }

    pub fn new(robot: &Robot, plan: &Plan, friction: f64) -> Self {
        let settings = SimulationSettings { timestep_s: TIMESTEP_S, ..SimulationSettings::default() };
        let checked = crate::common::checked(robot, plan);
        let scene = SimScene::new(&checked, &Conditions::new(friction, settings)).unwrap();
        Self { scene, sample: blank_sample(&checked) }
    }

    /// Steps for `duration_s` while the load changes linearly from one multiple of the wrench to another.
    pub fn run(&mut self, duration_s: f64, from: f64, to: f64) -> &Sample {
        let steps = (duration_s / TIMESTEP_S).round() as usize;
        for step in 1..=steps {
            self.scene.step(from + (to - from) * step as f64 / steps as f64);
        }
        self.scene.observe(&mut self.sample);
        &self.sample
    }

    /// Motion of the hand on the block, m and rad, until a second after the load `factor` was applied slowly.
    pub fn motion_under(&mut self, factor: f64) -> (f64, f64) {
        let before = self.run(0.2, 0.0, 0.0).arms[0].x_oc;
        self.run(0.5, 0.0, factor);
        let after = self.run(1.0, factor, factor).arms[0].x_oc;
        let moved = before.inverse() * after;
        (moved.translation.vector.norm(), moved.rotation.angle())
    }
}
