//! An arm of the plan with what its bodies, contacts and servos have in common.

use nalgebra::{Isometry3, Point3};

use super::super::{
    board::TouchedBox,
    bodies::{ArmBodies, MovingBody},
    conditions::Conditions,
    feed_forward::FeedForward,
    pad_shape::{GraspingHand, PadLoading, PadPart, pad_parts},
    pad_springs::{PadLayer, PadSpring},
    world::drive_inertia_kg,
};
use crate::{
    check::{CheckedArm, CheckedPlan},
    model::{frames::Pose, plan::ArmHold},
    robot::{Arm, Chain, Robot},
};

/// An arm of the plan with its moving bodies and planned positions.
pub(super) struct ExportedArm<'a> {
    /// The arm.
    pub arm: &'a Arm,
    /// How it holds the board.
    pub hold: &'a ArmHold,
    /// Its moving bodies.
    pub bodies: ArmBodies,
    /// The springs of the hand, if its pads are elastic.
    pub pad_springs: Option<[PadSpring; 6]>,
    /// The torques that its servos feed forward.
    pub feed_forward: FeedForward,
    /// The planned positions of the finger joints, m.
    pub finger_m: [f64; 2],
    /// The force that closes each finger, N.
    pub grip_force_n: f64,
    /// Coulomb coefficient of its pads.
    pub friction: f64,
    /// The load on its pads.
    pub loading: PadLoading,
    /// What of the board its pads touch.
    pub touched: TouchedBox,
    /// True if that is a part of a plate, which only this hand touches.
    is_of_plate: bool,
    /// Inverse mass of a finger as MuJoCo's contacts assume it, 1/kg, see [`inverse_mass_per_kg`].
    pub finger_per_kg: f64,
}

impl<'a> ExportedArm<'a> {
    /// An arm of a checked plan; `softness_s2` is that of its pads' contacts.
    pub fn new(
        checked: &CheckedPlan<'a>,
        (number, checked_arm): (usize, &CheckedArm<'a>),
        feed_forward: FeedForward,
        conditions: &Conditions,
        softness_s2: f64,
    ) -> Self {
        let (robot, of) = (checked.robot(), &conditions.uncertainty);
        let object = &of.board(&checked.plan().object);
        let &CheckedArm { index, hold, .. } = checked_arm;
        let arm = &robot.arms[index];
        let gap_m = object.size_m[2];
        let finger_m = arm.gripper.finger_positions_m(gap_m);
        let grip_force_n = hold.grip_force_n * of.grip_force_scale_of(number);
        let layer = PadLayer::of(robot, checked_arm, object, conditions);
        let bodies = ArmBodies::new(robot, arm, layer.as_ref().map(|layer| &layer.x_gd), gap_m);
        let loading =
            PadLoading::new(&GraspingHand { arm, bodies: &bodies, x_og: hold.x_og }, object, grip_force_n, softness_s2);
        Self {
            feed_forward,
            friction: conditions.friction_of(number),
            finger_per_kg: inverse_mass_per_kg(robot, index, &bodies, drive_inertia_kg(object)),
            pad_springs: layer.and_then(|layer| layer.springs(robot, arm, &bodies, finger_m)),
            arm,
            hold,
            bodies,
            finger_m,
            grip_force_n,
            loading,
            touched: TouchedBox::of(&object.shape(), &hold.x_og),
            is_of_plate: object.plate.is_some(),
        }
    }

    /// The name of finger `k`'s pad, with its hand's.
    pub fn pad_name(&self, k: usize) -> String {
        format!("{} {}", self.hold.name, self.arm.gripper.fingers[k].pad.name)
    }

    /// The name of a part of finger `k`'s pad.
    pub fn part_name(&self, k: usize, part: &PadPart) -> String {
        format!("{} {}", self.pad_name(k), part.name)
    }

    /// The name of the geom of the board that its pads touch.
    pub fn touched_name(&self) -> String {
        if self.is_of_plate { format!("board at {} hand", self.hold.name) } else { "board".into() }
    }

    /// The parts of finger `k`'s pad.
    pub fn parts(&self, k: usize) -> [PadPart; 3] {
        pad_parts(&self.arm.gripper.fingers[k].pad, &self.loading)
    }

    /// The body that contains the hand, `None` for the world, and in it the pose of C, with the axes of G at the centre
    /// between the pads.
    pub fn hand(&self) -> (Option<usize>, Pose) {
        let placement = self.bodies.placements[self.arm.gripper.frame_link];
        (placement.body, placement.x_bl * Isometry3::from(self.arm.gripper.grasp_point_g()))
    }
}

/// Inverse mass of a finger as MuJoCo's contacts assume it, 1/kg: the mean over all directions at zero joint angles, `(1/3)
/// (trace(J M^-1 J') + 1/m)`, with the Jacobian `J` of the finger's centre of mass, the mass matrix `M` of the arm, and the
/// mass `m` of finger and drive.
fn inverse_mass_per_kg(robot: &Robot, arm_index: usize, bodies: &ArmBodies, drive_kg: f64) -> f64 {
    let chain = Chain::new(robot, arm_index, 0.0);
    let zero_rad = vec![0.0; chain.dof()];
    let finger = bodies.body_of_joint[chain.dof()];
    let mass = &bodies.bodies[finger].mass;
    let com_w = pose_at_zero(bodies, finger) * Point3::from(mass.com_b);
    let r_m = com_w.coords - chain.gripper_pose(&zero_rad).translation.vector;
    let of_g = chain.jacobian_w(&zero_rad);
    let jacobian = of_g.fixed_rows::<3>(0) - r_m.cross_matrix() * of_g.fixed_rows::<3>(3);
    // The mass matrix of a chain of bodies with mass can be inverted; without joints there is nothing to add.
    let inverse = chain.mass_matrix(&zero_rad).cholesky();
    let of_arm = inverse.map_or(0.0, |inverse| (&jacobian * inverse.solve(&jacobian.transpose())).trace());
    (of_arm + 1.0 / (mass.mass_kg + drive_kg)) / 3.0
}

/// The pose of a body in W with all joints at zero.
fn pose_at_zero(bodies: &ArmBodies, body: usize) -> Pose {
    let MovingBody { parent, x_pj, .. } = &bodies.bodies[body];
    parent.map_or(Pose::identity(), |parent| pose_at_zero(bodies, parent)) * x_pj
}
