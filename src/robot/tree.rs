//! The data types of a robot, and forward kinematics of its links.

use std::{collections::BTreeMap, path::PathBuf, sync::Arc};

use nalgebra::{Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

use super::{
    geometry::{PlacedShape, Visual},
    holding::Holding,
};
use crate::model::{frames::Pose, plan::ArmHold};

/// A robot: a tree of links, its arms, and the data of the description.
#[derive(Clone, Debug)]
pub struct Robot {
    /// The name or path by which it was loaded.
    pub description: String,
    /// Parents before children; the first is the root.
    pub links: Vec<Link>,
    /// Pose of the root in W.
    pub x_wr: Pose,
    /// Parents before children.
    pub joints: Vec<Joint>,
    /// The arms that can hold a board, in the description's order.
    pub arms: Vec<Arm>,
    /// Pairs of links (indices, smaller first) that may overlap: neighbours, and primitives larger than their part.
    pub allowed_collisions: Vec<[usize; 2]>,
    /// Points on the robot's surface for the peripersonal metric (docs/method.md#51-point-sets).
    pub body_points: Vec<BodyPoint>,
    /// Height of the floor in W, m.
    pub floor_z_m: f64,
    /// Where the planner looks for poses of the board, if the description says so.
    pub search_box: Option<SearchBox>,
    /// The robot with its linkage grippers as the URDF has them, if it has any, see [`Robot::at_gap`].
    pub with_linkages: Option<Arc<Robot>>,
    /// With what it was loaded beside its description.
    pub options: RobotOptions,
    /// What was changed or left out to read the files.
    pub notes: Vec<String>,
    /// The files that were read: description, URDF, collision meshes; none for a built-in robot.
    pub files: Vec<PathBuf>,
}

/// What a scenario adds to a robot's description.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotOptions {
    /// Folders in which packages are looked for before those of the description.
    pub packages: Vec<PathBuf>,
    /// Positions of joints that are not part of an arm or a gripper, rad or m, in place of those of the description.
    pub posture: BTreeMap<String, f64>,
}

/// A box of positions in W, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchBox {
    /// Range along x_W.
    pub x_m: [f64; 2],
    /// Range along y_W.
    pub y_m: [f64; 2],
    /// Range along z_W.
    pub z_m: [f64; 2],
}

/// A rigid part.
#[derive(Clone, Debug)]
pub struct Link {
    /// The URDF's name.
    pub name: String,
    /// The joint that carries it, an index into [`Robot::joints`]; `None` for the root.
    pub parent_joint: Option<usize>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass in the link's frame, m.
    pub com_l: Vector3<f64>,
    /// Inertia about the centre of mass in axes of the link's frame, kg m^2.
    pub inertia_l: Matrix3<f64>,
    /// Convex geometry for collisions, and for pictures of links without visuals.
    pub shapes: Vec<PlacedShape>,
    /// Geometry for pictures.
    pub visuals: Vec<Visual>,
}

/// The type of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Does not move.
    Fixed,
    /// Rotates about its axis.
    Revolute,
    /// Translates along its axis.
    Prismatic,
}

/// A joint between a link and its parent link.
#[derive(Clone, Debug)]
pub struct Joint {
    /// The URDF's name.
    pub name: String,
    /// Its type.
    pub kind: JointKind,
    /// Index of the parent link.
    pub parent_link: usize,
    /// Index of the child link.
    pub child_link: usize,
    /// Pose of the joint's frame in the parent link's; the child link's frame at position 0.
    pub x_pj: Pose,
    /// Axis in the joint's frame.
    pub axis_j: Unit<Vector3<f64>>,
    /// Smallest position, rad or m.
    pub lower: f64,
    /// Largest position, rad or m.
    pub upper: f64,
    /// Position of a joint that is not part of an arm or a gripper, rad or m.
    pub rest: f64,
    /// Largest speed, rad/s or m/s; 0 where the URDF states none.
    pub most_speed: f64,
    /// The joint that it follows.
    pub mimic: Option<Mimic>,
}

/// A joint whose position follows another's: `multiplier * position + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mimic {
    /// The joint that leads, an index into [`Robot::joints`]; it follows no other.
    pub leader: usize,
    /// Factor of its position.
    pub multiplier: f64,
    /// Position at zero of the leader, rad or m.
    pub offset: f64,
}

/// A serial chain from the root to a gripper.
#[derive(Clone, Debug)]
pub struct Arm {
    /// The description's name, such as `left`.
    pub name: String,
    /// Its moving joints, indices into [`Robot::joints`], from the base outward.
    pub joints: Vec<usize>,
    /// Maximum torque of each joint, N m: from the description if given, else from the URDF.
    pub effort_nm: Vec<f64>,
    /// Stiffness of each joint's position control, N m/rad.
    pub stiffness_nm_rad: Vec<f64>,
    /// Damping of each joint's position control, N m s/rad.
    pub damping_nm_s_rad: Vec<f64>,
    /// Its gripper.
    pub gripper: Gripper,
}

/// A parallel gripper, two coupled fingers that close on each other along y_G, or a suction cup.
#[derive(Clone, Debug)]
pub struct Gripper {
    /// The link whose frame is G: z out of the gripper, fingers opening along y; of a cup its origin is the centre of the lip.
    pub frame_link: usize,
    /// The parent link of the finger joints.
    pub palm_link: usize,
    /// The finger on the +y_G side, then the one on the -y_G side; none of a suction cup.
    pub fingers: Vec<Finger>,
    /// The suction cup; `None` of a gripper with fingers.
    pub cup: Option<Cup>,
    /// Gap between the pads when closed and when open, m: the range of thicknesses that it can hold. A cup holds any.
    pub opening_m: [f64; 2],
    /// With what it holds the board.
    pub holding: Holding,
    /// The mechanism that moves the fingers, if it is not one prismatic joint each.
    pub linkage: Option<Linkage>,
}

/// A suction cup, whose lip lies flat on a face of the board: z_G points into the board, the origin of G is on the face.
#[derive(Clone, Copy, Debug)]
pub struct Cup {
    /// The link of the cup: all of it may touch the board.
    pub link: usize,
    /// Radius of the lip, m.
    pub radius_m: f64,
}

/// Shapes of links that move as one, each as the index of its link and its place among the shapes of the link.
#[derive(Clone, Debug)]
pub struct Face {
    pub(super) shapes: Vec<[usize; 2]>,
}

/// The mechanism of a gripper's fingers (docs/method.md#26-linkage-grippers).
#[derive(Clone, Debug)]
pub struct Linkage {
    /// One joint that moves both pads, or one for each.
    pub(super) drives: Vec<Drive>,
    /// For each pad its links, which move as one.
    pub(super) pads: [Vec<usize>; 2],
    /// For each pad the joint that carries the first of its links, in the order of the tree, an index into [`Robot::joints`].
    pub(super) carriers: [usize; 2],
    /// For each pad the joints that carry its other links.
    pub(super) others: [Vec<usize>; 2],
    /// For each pad the shapes that may touch the board.
    pub(super) faces: [Face; 2],
    /// For each pad the side of the plane y_G = 0 that it is on, 1 or -1.
    pub(super) sides: [f64; 2],
}

/// A joint that moves pads, with its positions when the gripper is closed and when it is open, rad or m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drive {
    pub joint: usize,
    pub closed: f64,
    pub open: f64,
}

/// One finger and its pad.
#[derive(Clone, Debug)]
pub struct Finger {
    /// The prismatic joint that moves it, an index into [`Robot::joints`].
    pub joint: usize,
    /// The joint's position at travel 0, fully closed: one of the joint's limits, m.
    pub closed_m: f64,
    /// 1 if the joint's position increases as the finger opens, else -1.
    pub opening_sign: f64,
    /// Maximum travel, m.
    pub max_travel_m: f64,
    /// Its pad.
    pub pad: Pad,
}

impl Finger {
    /// The joint's position at this travel from the closed limit, m; travels beyond the limits are clamped.
    pub fn joint_position_m(&self, travel_m: f64) -> f64 {
        self.closed_m + self.opening_sign * travel_m.clamp(0.0, self.max_travel_m)
    }
}

/// The flat face of a finger that touches the board, a rectangle normal to y_G.
#[derive(Clone, Debug)]
pub struct Pad {
    /// The description's name of the finger.
    pub name: String,
    /// The link that the pad is part of.
    pub link: usize,
    /// Full sides along x_G and z_G, m.
    pub size_m: [f64; 2],
    /// Centre along x_G and z_G, m.
    pub centre_m: [f64; 2],
    /// Distance of the face from the plane y_G = 0 at travel 0, m; it increases with the travel.
    pub offset_m: f64,
}

impl Gripper {
    /// Travel of a finger, from its closed limit, at which the gap between the pads is `gap_m`:
    /// the pad's face is then `gap_m / 2` from the plane y_G = 0. 0 for a finger that a suction cup does not have.
    pub fn travel_for_gap_m(&self, finger: usize, gap_m: f64) -> f64 {
        self.fingers.get(finger).map_or(0.0, |finger| gap_m / 2.0 - finger.pad.offset_m)
    }

    /// Joint positions of the fingers with the pads `gap_m` apart, m; zeros of a suction cup.
    pub fn finger_positions_m(&self, gap_m: f64) -> [f64; 2] {
        [0, 1].map(|k| self.fingers.get(k).map_or(0.0, |of| of.joint_position_m(self.travel_for_gap_m(k, gap_m))))
    }

    /// Name of a pad on a board: `upper` on the front face (+z_O), `lower` on the other.
    pub fn pad_name(&self, finger: usize, x_og: &Pose) -> &'static str {
        let y_g_in_o = x_og.rotation * Vector3::y();
        let finger_is_up = (finger == 0) == (y_g_in_o.z > 0.0);
        if finger_is_up { "upper" } else { "lower" }
    }

    /// The force that closes each finger of this gripper in a plan, N: that of the scenario, 0 for a measured gripper.
    pub fn grip_force_n(&self, of_scenario_n: f64) -> f64 {
        self.holding.pads().map_or(0.0, |_| of_scenario_n)
    }

    /// The grasp point in G: the centre between the pads, or of a cup's lip, m.
    pub fn grasp_point_g(&self) -> Vector3<f64> {
        let [x, z] = self.fingers.first().map_or([0.0; 2], |finger| finger.pad.centre_m);
        Vector3::new(x, 0.0, z)
    }
}

/// A point on the robot's surface.
#[derive(Clone, Copy, Debug)]
pub struct BodyPoint {
    /// The link that it moves with.
    pub link: usize,
    /// Position in the link's frame, m.
    pub p_l: Point3<f64>,
}

/// The state of one arm, for [`Robot::positions`].
#[derive(Clone, Copy, Debug)]
pub struct ArmState<'a> {
    /// Index into [`Robot::arms`].
    pub arm: usize,
    /// Joint angles in the order of [`Arm::joints`], rad.
    pub q_rad: &'a [f64],
    /// Travel of each finger from its closed limit, in the order of [`Gripper::fingers`], m.
    pub finger_travel_m: [f64; 2],
}

impl Robot {
    /// The index of the arm of this name.
    pub fn arm_index(&self, name: &str) -> Option<usize> {
        self.arms.iter().position(|arm| arm.name == name)
    }

    /// The index of the link of this name.
    pub fn link_index(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }

    /// The poses of all links in W for planned arms that hold a board of this thickness. Unknown arms are ignored.
    pub fn planned_link_poses(&self, holds: &[ArmHold], thickness_m: f64) -> Vec<Pose> {
        let states = holds.iter().filter_map(|hold| {
            let arm = self.arm_index(&hold.name)?;
            let gripper = &self.arms[arm].gripper;
            let finger_travel_m = [0, 1].map(|finger| gripper.travel_for_gap_m(finger, thickness_m));
            Some(ArmState { arm, q_rad: &hold.q_rad, finger_travel_m })
        });
        self.link_poses(&self.positions(&states.collect::<Vec<_>>()))
    }

    /// The positions of all joints, in the order of [`Robot::joints`], rad or m. Joints of no given arm are at [`Joint::rest`],
    /// joints that follow another where that takes them. Angles of the arms are not clamped to the limits.
    pub fn positions(&self, arms: &[ArmState]) -> Vec<f64> {
        let mut positions: Vec<f64> = self.joints.iter().map(|joint| joint.rest).collect();
        for state in arms {
            let arm = &self.arms[state.arm];
            for (&joint, &q_rad) in arm.joints.iter().zip(state.q_rad) {
                positions[joint] = q_rad;
            }
            for (finger, travel_m) in arm.gripper.fingers.iter().zip(state.finger_travel_m) {
                positions[finger.joint] = finger.joint_position_m(travel_m);
            }
        }
        self.follow(&mut positions);
        positions
    }

    /// Moves the joints that follow others.
    pub(super) fn follow(&self, positions: &mut [f64]) {
        for (index, joint) in self.joints.iter().enumerate() {
            if let Some(Mimic { leader, multiplier, offset }) = joint.mimic {
                positions[index] = multiplier * positions[leader] + offset;
            }
        }
    }

    /// The poses in W of all links, in the order of [`Robot::links`]. `positions` has one entry per joint, rad or m;
    /// those of fixed joints are ignored.
    pub fn link_poses(&self, positions: &[f64]) -> Vec<Pose> {
        let mut x_wl: Vec<Pose> = Vec::with_capacity(self.links.len());
        for link in &self.links {
            x_wl.push(match link.parent_joint {
                None => self.x_wr,
                Some(joint) => {
                    let joint_of_link = &self.joints[joint];
                    x_wl[joint_of_link.parent_link] * joint_of_link.x_pc(positions[joint])
                }
            });
        }
        x_wl
    }

    /// For each joint whether an arm or a gripper moves it; all others stay at rest.
    pub fn active_joints(&self) -> Vec<bool> {
        let mut active = vec![false; self.joints.len()];
        for arm in &self.arms {
            let fingers = arm.gripper.fingers.iter().map(|finger| finger.joint);
            arm.joints.iter().copied().chain(fingers).for_each(|joint| active[joint] = true);
        }
        active
    }

    /// For each link whether an arm or a gripper moves it.
    pub fn moved_links(&self) -> Vec<bool> {
        self.active_carriers().iter().map(Option::is_some).collect()
    }

    /// Adds a link without mass and shapes that is fixed to another, and returns its index.
    pub fn add_frame(&mut self, name: &str, parent_link: usize, x_pl: Pose) -> usize {
        let child_link = self.links.len();
        self.links.push(Link::empty(name, Some(self.joints.len())));
        self.joints.push(Joint::fixed(&format!("{name}_joint"), [parent_link, child_link], x_pl));
        child_link
    }

    /// For each link the moving joint that carries it, directly or through fixed joints; `None` for fixed links.
    pub fn carriers(&self) -> Vec<Option<usize>> {
        self.nearest_above(|joint| (self.joints[joint].kind != JointKind::Fixed).then_some(joint))
    }

    /// For each link the joint of an arm or a gripper that carries it; `None` for links that stay at rest. Links with the same
    /// one do not move against each other.
    pub fn active_carriers(&self) -> Vec<Option<usize>> {
        let active = self.active_joints();
        self.nearest_above(|joint| active[joint].then_some(joint))
    }

    /// For each link the value of the first joint on the way to the root that has one; `None` if none has.
    pub fn nearest_above<T: Copy>(&self, of_joint: impl Fn(usize) -> Option<T>) -> Vec<Option<T>> {
        let mut nearest: Vec<Option<T>> = Vec::with_capacity(self.links.len());
        // Parents come before children.
        for link in &self.links {
            let above = |joint: usize| of_joint(joint).or_else(|| nearest[self.joints[joint].parent_link]);
            nearest.push(link.parent_joint.and_then(above));
        }
        nearest
    }
}

impl Link {
    /// A link without mass and geometry.
    #[must_use]
    pub fn empty(name: &str, parent_joint: Option<usize>) -> Self {
        Self {
            name: name.into(),
            parent_joint,
            mass_kg: 0.0,
            com_l: Vector3::zeros(),
            inertia_l: Matrix3::zeros(),
            shapes: Vec::new(),
            visuals: Vec::new(),
        }
    }
}

impl Joint {
    /// A joint that does not move, between a parent and a child link.
    #[must_use]
    pub fn fixed(name: &str, [parent_link, child_link]: [usize; 2], x_pj: Pose) -> Self {
        Self {
            name: name.into(),
            kind: JointKind::Fixed,
            parent_link,
            child_link,
            x_pj,
            axis_j: Vector3::x_axis(),
            lower: 0.0,
            upper: 0.0,
            rest: 0.0,
            most_speed: 0.0,
            mimic: None,
        }
    }

    /// The child link's pose in the parent link at this position, rad or m.
    pub fn x_pc(&self, position: f64) -> Pose {
        match self.kind {
            JointKind::Fixed => self.x_pj,
            JointKind::Revolute => self.x_pj * UnitQuaternion::from_axis_angle(&self.axis_j, position),
            JointKind::Prismatic => self.x_pj * Translation3::from(self.axis_j.into_inner() * position),
        }
    }
}
