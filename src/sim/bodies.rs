//! The moving bodies of one arm: links of a [`Robot`] without a moving joint between them are merged.

use nalgebra::{Isometry3, Matrix3, Vector3};

use crate::{
    model::frames::Pose,
    robot::{Arm, Link, Robot},
};

/// A link that one joint of the arm or gripper moves, with all links fixed to it.
pub(super) struct MovingBody {
    /// The joint that moves it, an index into [`Robot::joints`].
    pub joint: usize,
    /// The parent body, an index into [`ArmBodies::bodies`]; `None` for the world.
    pub parent: Option<usize>,
    /// Pose of the joint's frame in the parent body, or in W.
    pub x_pj: Pose,
    /// Mass properties in the frame of the joint's child link.
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

    /// Adds a link at `x_bl`, by the parallel axis theorem.
    fn with_link(&self, link: &Link, x_bl: &Pose) -> Self {
        let mass_kg = self.mass_kg + link.mass_kg;
        if mass_kg == 0.0 {
            return *self;
        }
        let link_com_b = (x_bl * nalgebra::Point3::from(link.com_l)).coords;
        let com_b = (self.com_b * self.mass_kg + link_com_b * link.mass_kg) / mass_kg;
        let rotation = x_bl.rotation.to_rotation_matrix();
        let link_inertia_b = rotation.matrix() * link.inertia_l * rotation.matrix().transpose();
        let inertia_b = self.inertia_b
            + steiner(self.mass_kg, &(self.com_b - com_b))
            + link_inertia_b
            + steiner(link.mass_kg, &(link_com_b - com_b));
        Self { mass_kg, com_b, inertia_b }
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
    /// The body of each joint of the arm, then of each finger.
    pub body_of_joint: Vec<usize>,
    /// The placement of every link of the robot, in the robot's order.
    pub placements: Vec<LinkPlacement>,
}

impl ArmBodies {
    /// Merges the robot's links into the bodies that this arm moves. Other joints stay at zero, or at the nearest
    /// limit.
    pub fn new(robot: &Robot, arm: &Arm) -> Self {
        let moving: Vec<usize> =
            arm.joints.iter().copied().chain(arm.gripper.fingers.iter().map(|finger| finger.joint)).collect();
        let at_rest = robot.positions(&[]);
        let mut bodies: Vec<MovingBody> = Vec::new();
        let mut body_of_joint = vec![0; moving.len()];
        let mut placements: Vec<LinkPlacement> = Vec::with_capacity(robot.links.len());
        for link in &robot.links {
            let placement = match link.parent_joint {
                None => LinkPlacement { body: None, x_bl: Isometry3::identity() },
                Some(joint) => {
                    let hinge = &robot.joints[joint];
                    let parent = placements[hinge.parent_link];
                    let x_bj = parent.x_bl * hinge.x_pj;
                    match moving.iter().position(|&m| m == joint) {
                        None => LinkPlacement { body: parent.body, x_bl: parent.x_bl * hinge.x_pc(at_rest[joint]) },
                        Some(place) => {
                            body_of_joint[place] = bodies.len();
                            bodies.push(MovingBody {
                                joint,
                                parent: parent.body,
                                x_pj: x_bj,
                                mass: CompositeInertia::ZERO,
                            });
                            LinkPlacement { body: Some(bodies.len() - 1), x_bl: Isometry3::identity() }
                        }
                    }
                }
            };
            if let Some(body) = placement.body {
                bodies[body].mass = bodies[body].mass.with_link(link, &placement.x_bl);
            }
            placements.push(placement);
        }
        Self { bodies, body_of_joint, placements }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;

    fn box_link(mass_kg: f64, [x, y, z]: [f64; 3], com_l: Vector3<f64>) -> Link {
        let diagonal = Vector3::new(y * y + z * z, x * x + z * z, x * x + y * y) * (mass_kg / 12.0);
        let inertia_l = Matrix3::from_diagonal(&diagonal);
        Link { name: "box".into(), parent_joint: None, mass_kg, com_l, inertia_l, shapes: Vec::new() }
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
}
