//! The moving bodies of one arm: links of a [`Robot`] without a moving joint between them are merged.

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::world::inertial_mass_kg;
use crate::{
    model::{frames::Pose, plan::PlacedObject},
    robot::{Arm, Gripper, Holding, Link, Robot},
};

/// A link that one joint of the arm or gripper moves, or the hand on its elastic pads, with all links fixed to it.
pub(super) struct MovingBody {
    /// The joint that moves it, an index into [`Robot::joints`]; `None` for a hand on its pads, which moves in all
    /// directions.
    pub joint: Option<usize>,
    /// The link that names it, an index into [`Robot::links`]: the joint's child, or the palm.
    pub link: usize,
    /// The parent body, an index into [`ArmBodies::bodies`]; `None` for the world.
    pub parent: Option<usize>,
    /// Pose of the joint's frame in the parent body, or in W.
    pub x_pj: Pose,
    /// Mass properties in the body's frame: that of the joint's child link, or D for a hand on its pads.
    pub mass: CompositeInertia,
}

/// Mass, centre of mass and inertia of several links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CompositeInertia {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass in the body's frame, m.
    pub com_b: Vector3<f64>,
    /// Inertia about the centre of mass in the body's axes, kg m^2.
    pub inertia_b: Matrix3<f64>,
}

impl CompositeInertia {
    const ZERO: Self = Self {
        mass_kg: 0.0,
        com_b: Vector3::new(0.0, 0.0, 0.0),
        inertia_b: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    /// A board with its inertia in the engine, see [`inertial_mass_kg`].
    pub fn of_board(object: &PlacedObject) -> Self {
        let mass_kg = inertial_mass_kg(object);
        Self { mass_kg, com_b: object.com_o(), inertia_b: object.shape().inertia_o(mass_kg) }
    }

    /// Adds a link at `x_bl`.
    fn with_link(&self, link: &Link, x_bl: &Pose) -> Self {
        self.with(&Self { mass_kg: link.mass_kg, com_b: link.com_l, inertia_b: link.inertia_l }, x_bl)
    }

    /// Adds a part whose frame is at `x_bp`, by the parallel axis theorem.
    pub fn with(&self, part: &Self, x_bp: &Pose) -> Self {
        let mass_kg = self.mass_kg + part.mass_kg;
        if mass_kg == 0.0 {
            return *self;
        }
        let part_com_b = (x_bp * nalgebra::Point3::from(part.com_b)).coords;
        let com_b = (self.com_b * self.mass_kg + part_com_b * part.mass_kg) / mass_kg;
        let rotation = x_bp.rotation.to_rotation_matrix();
        let part_inertia_b = rotation.matrix() * part.inertia_b * rotation.matrix().transpose();
        let inertia_b = self.inertia_b
            + steiner(self.mass_kg, &(self.com_b - com_b))
            + part_inertia_b
            + steiner(part.mass_kg, &(part_com_b - com_b));
        Self { mass_kg, com_b, inertia_b }
    }

    /// The part of half the mass with the same centre of mass.
    fn halved(&self) -> Self {
        Self { mass_kg: self.mass_kg / 2.0, inertia_b: self.inertia_b / 2.0, ..*self }
    }

    /// The same in the frame B' with B at `x_b1b`.
    fn moved(&self, x_b1b: &Pose) -> Self {
        Self::ZERO.with(self, x_b1b)
    }

    /// Inertia about the origin of the body's frame in its axes, kg m^2.
    pub fn inertia_about_origin(&self) -> Matrix3<f64> {
        self.inertia_b + steiner(self.mass_kg, &self.com_b)
    }
}

/// Inertia of a point mass at `r`, kg m^2.
fn steiner(mass_kg: f64, r: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * mass_kg
}

/// A link's pose in its moving body, or in the world.
#[derive(Clone, Copy)]
pub(super) struct LinkPlacement {
    /// An index into [`ArmBodies::bodies`]; `None` for the world.
    pub body: Option<usize>,
    /// Pose of the link in that body, or in W.
    pub x_bl: Pose,
}

/// An arm and its gripper as moving bodies.
pub(super) struct ArmBodies {
    /// Parents before children.
    pub bodies: Vec<MovingBody>,
    /// The body of each joint of the arm, then of each finger that moves.
    pub body_of_joint: Vec<usize>,
    /// The hand, if it is a body of its own.
    pub hand: Option<usize>,
    /// The placement of every link of the robot, in the robot's order.
    pub placements: Vec<LinkPlacement>,
}

/// Share of the mass of arm and hand on the two sides of the pads below which it is shared evenly, see
/// [`ArmBodies::new`].
const LEAST_MASS_SHARE: f64 = 0.05;

impl ArmBodies {
    /// Merges the robot's links into the bodies that this arm moves. Other joints stay at zero, or at the nearest
    /// limit.
    ///
    /// With elastic pads the palm, all that is fixed to it and the fingers are a body of their own, whose frame is the
    /// frame D of the pads' springs, at `x_gd` in G ([`PadSprings`](super::pad_springs::PadSprings)). Every body needs a
    /// mass. So if the palm or what carries it has hardly any, as where both are one link, each gets half of their sum;
    /// no state of rest depends on it.
    ///
    /// The fingers of a measured gripper are part of the palm, at the gap of the board's thickness.
    pub fn new(robot: &Robot, arm: &Arm, x_gd: Option<&Pose>, thickness_m: f64) -> Self {
        let gripper = &arm.gripper;
        let mut at_rest = robot.positions(&[]);
        let mut moving = arm.joints.clone();
        for (finger, position_m) in gripper.fingers.iter().zip(gripper.finger_positions_m(thickness_m)) {
            match gripper.holding {
                Holding::Pads(_) => moving.push(finger.joint),
                Holding::Measured(_) => at_rest[finger.joint] = position_m,
            }
        }
        let mut merged =
            Self { bodies: Vec::new(), body_of_joint: vec![0; moving.len()], hand: None, placements: Vec::new() };
        for (index, link) in robot.links.iter().enumerate() {
            let mut placement = match link.parent_joint {
                None => LinkPlacement { body: None, x_bl: robot.x_wr },
                Some(joint) => {
                    let hinge = &robot.joints[joint];
                    let parent = merged.placements[hinge.parent_link];
                    match moving.iter().position(|&m| m == joint) {
                        None => LinkPlacement { body: parent.body, x_bl: parent.x_bl * hinge.x_pc(at_rest[joint]) },
                        Some(place) => {
                            merged.body_of_joint[place] = merged.bodies.len();
                            merged.push(Some(joint), index, parent.body, parent.x_bl * hinge.x_pj)
                        }
                    }
                }
            };
            if let Some(x_gd) = x_gd.filter(|_| index == arm.gripper.palm_link) {
                let x_pd = palm_to_gripper(robot, &arm.gripper) * x_gd;
                merged.hand = Some(merged.bodies.len());
                placement = merged.push(None, index, placement.body, placement.x_bl * x_pd);
                placement.x_bl = x_pd.inverse();
            }
            if let Some(body) = placement.body {
                let mass = &mut merged.bodies[body].mass;
                *mass = mass.with_link(link, &placement.x_bl);
            }
            merged.placements.push(placement);
        }
        if let (Some(hand), Some(x_gd)) = (merged.hand, x_gd) {
            merged.share_mass(hand);
            // The frame G belongs to the hand, whichever link has it.
            merged.placements[arm.gripper.frame_link] = LinkPlacement { body: Some(hand), x_bl: x_gd.inverse() };
        }
        merged
    }

    /// Adds a body without mass, and returns the placement of the link at its origin.
    fn push(&mut self, joint: Option<usize>, link: usize, parent: Option<usize>, x_pj: Pose) -> LinkPlacement {
        self.bodies.push(MovingBody { joint, link, parent, x_pj, mass: CompositeInertia::ZERO });
        LinkPlacement { body: Some(self.bodies.len() - 1), x_bl: Isometry3::identity() }
    }

    /// Shares the mass of the hand and its parent evenly if one of them has less than [`LEAST_MASS_SHARE`] of it.
    fn share_mass(&mut self, hand: usize) {
        let Some(parent) = self.bodies[hand].parent else { return };
        let (x_ph, of_hand, of_parent) = (self.bodies[hand].x_pj, self.bodies[hand].mass, self.bodies[parent].mass);
        let sum = of_parent.with(&of_hand, &x_ph);
        if of_hand.mass_kg.min(of_parent.mass_kg) < LEAST_MASS_SHARE * sum.mass_kg {
            self.bodies[parent].mass = sum.halved();
            self.bodies[hand].mass = sum.halved().moved(&x_ph.inverse());
        }
    }
}

/// The pose of G in the palm, which carries it or is carried with it.
fn palm_to_gripper(robot: &Robot, gripper: &Gripper) -> Pose {
    let x_wl = robot.link_poses(&robot.positions(&[]));
    x_wl[gripper.palm_link].inverse() * x_wl[gripper.frame_link]
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;

    fn box_link(mass_kg: f64, [x, y, z]: [f64; 3], com_l: Vector3<f64>) -> Link {
        let diagonal = Vector3::new(y * y + z * z, x * x + z * z, x * x + y * y) * (mass_kg / 12.0);
        let inertia_l = Matrix3::from_diagonal(&diagonal);
        Link {
            name: "box".into(),
            parent_joint: None,
            mass_kg,
            com_l,
            inertia_l,
            shapes: Vec::new(),
            visuals: Vec::new(),
        }
    }

    #[test]
    fn two_halves_make_a_whole() {
        // A box 0.4 m long, cut in two; the halves' frames are rotated and offset from their centres of mass.
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
        let x_bl = |x: f64| Isometry3::from_parts(Vector3::new(x, 0.0, 0.0).into(), turn);
        // Rotated by 90 degrees about z, the half's long side is along y_L, and x_B is -y_L.
        let half = box_link(1.5, [0.1, 0.2, 0.3], Vector3::new(0.0, -0.05, 0.0));
        let merged = CompositeInertia::ZERO.with_link(&half, &x_bl(-0.15)).with_link(&half, &x_bl(0.05));
        let whole = box_link(3.0, [0.4, 0.1, 0.3], Vector3::zeros());
        assert_eq!(merged.mass_kg, 3.0);
        // Rounding of products of numbers below 1.
        assert!(merged.com_b.norm() < 1e-15, "{}", merged.com_b);
        assert!((merged.inertia_b - whole.inertia_l).norm() < 1e-15, "{}", merged.inertia_b);
    }

    #[test]
    fn a_hand_on_its_pads_leaves_mass_and_inertia_of_the_whole_as_they_are() {
        let robot = Robot::load("baxter", std::path::Path::new(".")).unwrap();
        let arm = &robot.arms[0];
        let x_gd = Isometry3::from_parts(
            Vector3::new(0.01, 0.0, -0.02).into(),
            UnitQuaternion::from_euler_angles(0.3, -1.0, 0.2),
        );
        let whole = ArmBodies::new(&robot, arm, None, 0.03);
        let mut split = ArmBodies::new(&robot, arm, Some(&x_gd), 0.03);
        let hand = split.hand.unwrap();
        assert_eq!(split.bodies.len(), whole.bodies.len() + 1);
        assert_eq!(split.placements[arm.gripper.frame_link].body, Some(hand));
        // The hand carries the fingers; the last joint of the arm carries the hand.
        let last = split.body_of_joint[arm.joints.len() - 1];
        assert_eq!(split.bodies[hand].parent, Some(last));
        assert!(
            split.body_of_joint[arm.joints.len()..].iter().all(|&finger| split.bodies[finger].parent == Some(hand))
        );
        let expected = whole.bodies[whole.body_of_joint[arm.joints.len() - 1]].mass;
        for _ in 0..2 {
            let found = split.bodies[last].mass.with(&split.bodies[hand].mass, &split.bodies[hand].x_pj);
            // Rounding of kilograms and decimetres.
            assert!((found.mass_kg - expected.mass_kg).abs() < 1e-14 && (found.com_b - expected.com_b).norm() < 1e-14);
            assert!((found.inertia_b - expected.inertia_b).norm() < 1e-14, "{}", found.inertia_b - expected.inertia_b);
            // Once more with all of the mass in the hand, which is then shared.
            let (x_ph, sum) = (split.bodies[hand].x_pj, expected);
            split.bodies[last].mass = CompositeInertia::ZERO;
            split.bodies[hand].mass = sum.moved(&x_ph.inverse());
            split.share_mass(hand);
            assert_eq!(split.bodies[last].mass.mass_kg, expected.mass_kg / 2.0);
        }
    }
}
