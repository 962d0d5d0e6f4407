//! The closed form for six joints that decompose into position and rotation.
//!
//! With the axes at zero angles as the lines `p_i + t h_i` in W, and `E_i` the rotation about such a line by the angle of
//! joint i, the gripper's pose is `E_1 E_2 ... E_6` times its pose at zero angles. Two kinds of arms have a closed form:
//!
//! - *Wrist*: the axes 4, 5 and 6 meet in a point c. Then `E_1 E_2 E_3 c` is given, which determines three angles if among the
//!   first three axes two neighbours meet or are parallel. What remains is a rotation about three axes.
//! - *Parallel*: the axes 2, 3 and 4 are parallel to h, and 5 and 6 meet in a point o. Then `E_1 E_2 E_3 E_4 o` is given, whose
//!   component along h depends on joint 1 alone. The rotation about h by the sum of three angles, joint 5 and joint 6 follow
//!   from the gripper's rotation, and a triangle gives the rest.
//!
//! Both are tried from either end of the arm: the inverse of the pose is `E_6' ... E_1'` with negative angles. An arm of seven
//! joints is one of these beyond a first or a last joint, whose angle is free. Robots with such arms are those with a
//! spherical wrist, those like a UR5, and seven joints with a spherical shoulder or wrist.

use nalgebra::{Isometry3, Rotation3, Unit, UnitQuaternion, Vector3};

use super::subproblems::{Angles, component_angles, distance_angles, three_angles, turn_between, turned, two_angles};
use crate::{model::frames::Pose, robot::chain::Chain};

/// Tolerance of meeting (m) and parallel (1) axes, as for the other closed form.
const STRUCTURE_TOLERANCE: f64 = 1e-5;

/// The axis of a joint at zero angles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// A point on it, W, m.
    point: Vector3<f64>,
    /// Its direction, W.
    along: Vector3<f64>,
}

/// Which two neighbours of the first three axes meet or are parallel.
#[derive(Clone, Copy, Debug)]
enum Pair {
    /// Axes 1 and 2 meet in this point.
    FirstMeet(Vector3<f64>),
    /// Axes 2 and 3 meet in this point.
    LastMeet(Vector3<f64>),
    /// Axes 1 and 2 are parallel.
    FirstParallel,
    /// Axes 2 and 3 are parallel.
    LastParallel,
}

/// How the six joints decompose.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// The last three axes meet in the point `centre`.
    Wrist { centre: Vector3<f64>, pair: Pair },
    /// The axes 2 to 4 are parallel and the last two meet in this point.
    Parallel { meeting: Vector3<f64> },
}

/// Six joints that decompose.
#[derive(Clone, Debug)]
pub(super) struct SixJoints {
    axes: [Axis; 6],
    kind: Kind,
    /// True if the joints are in the order from the gripper to the base.
    reversed: bool,
}

impl Axis {
    /// The axes of all joints of a chain.
    pub fn of_chain(chain: &Chain) -> Vec<Self> {
        let frames = chain.joint_frames(&vec![0.0; chain.dof()]);
        let axes = chain.axes_w(&frames).into_iter().zip(&frames);
        axes.map(|(along, x_wj)| Self { point: x_wj.translation.vector, along }).collect()
    }

    /// The motion by an angle about the axis, rad.
    pub fn motion(&self, angle_rad: f64) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Unit::new_unchecked(self.along), angle_rad);
        Isometry3::from_parts((self.point - turn * self.point).into(), turn)
    }

    /// A point turned by an angle about the axis, m.
    fn turned(&self, angle_rad: f64, p: &Vector3<f64>) -> Vector3<f64> {
        self.point + turned(&self.along, angle_rad, &(p - self.point))
    }

    fn is_parallel_to(&self, other: &Self) -> bool {
        self.along.cross(&other.along).norm() < STRUCTURE_TOLERANCE
    }

    /// The point in which two axes meet; `None` if they do not, or are parallel.
    fn meeting(&self, other: &Self) -> Option<Vector3<f64>> {
        let normal = self.along.cross(&other.along);
        let square = normal.norm_squared();
        if square < STRUCTURE_TOLERANCE {
            return None;
        }
        let between = other.point - self.point;
        let apart = between.dot(&normal) / square.sqrt();
        let on_self = self.point + self.along * (between.cross(&other.along).dot(&normal) / square);
        (apart.abs() < STRUCTURE_TOLERANCE).then_some(on_self)
    }

    /// True if the point is on the axis.
    fn contains(&self, p: &Vector3<f64>) -> bool {
        (p - self.point).cross(&self.along).norm() < STRUCTURE_TOLERANCE
    }
}

impl SixJoints {
    /// The decomposition of six axes in the order from the base, from either end; `None` if there is no closed form.
    pub fn new(axes: [Axis; 6]) -> Option<Self> {
        let mut backward = axes;
        backward.reverse();
        let of = |axes: [Axis; 6], reversed: bool| Kind::of(&axes).map(|kind| Self { axes, kind, reversed });
        of(axes, false).or_else(|| of(backward, true))
    }

    /// The angles of all solutions with the motion `E_1 ... E_6 = motion`, without limits, rad; exact as far as the axes meet.
    pub fn solutions(&self, motion: &Pose) -> Vec<[f64; 6]> {
        let motion = if self.reversed { motion.inverse() } else { *motion };
        let mut solutions = match self.kind {
            Kind::Wrist { centre, pair } => self.wrist(&motion, &centre, pair),
            Kind::Parallel { meeting } => self.parallel(&motion, &meeting),
        };
        if self.reversed {
            for angles in &mut solutions {
                angles.reverse();
                angles.iter_mut().for_each(|angle| *angle = -*angle);
            }
        }
        solutions
    }

    fn along(&self, joint: usize) -> &Vector3<f64> {
        &self.axes[joint].along
    }

    fn rotation(&self, joint: usize, angle_rad: f64) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Unit::new_unchecked(self.axes[joint].along), angle_rad)
    }

    fn wrist(&self, motion: &Pose, centre: &Vector3<f64>, pair: Pair) -> Vec<[f64; 6]> {
        let target = motion * nalgebra::Point3::from(*centre);
        let rotation = motion.rotation.to_rotation_matrix();
        let mut solutions = Vec::new();
        for [q1, q2, q3] in self.positions(centre, &target.coords, pair) {
            let before = self.rotation(0, q1) * self.rotation(1, q2) * self.rotation(2, q3);
            let rest = three_angles([self.along(3), self.along(4), self.along(5)], &(before.inverse() * rotation));
            solutions.extend(rest.into_iter().map(|[q4, q5, q6]| [q1, q2, q3, q4, q5, q6]));
        }
        solutions
    }

    /// The angles with `E_1 E_2 E_3 c = target`.
    fn positions(&self, c: &Vector3<f64>, target: &Vector3<f64>, pair: Pair) -> Vec<[f64; 3]> {
        let [first, second, third] = [&self.axes[0], &self.axes[1], &self.axes[2]];
        let mut found = Vec::new();
        match pair {
            Pair::FirstMeet(o) => {
                let distance_m = (target - o).norm();
                for q3 in distance_angles(&third.along, &(c - third.point), &(o - third.point), distance_m) {
                    let arm = third.turned(q3, c) - o;
                    let two = two_angles(&first.along, &second.along, &arm, &(target - o));
                    found.extend(two.into_iter().map(|[q1, q2]| [q1, q2, q3]));
                }
            }
            Pair::LastMeet(o) => {
                let distance_m = (c - o).norm();
                let to_target = target - first.point;
                for back in distance_angles(&first.along, &to_target, &(o - first.point), distance_m) {
                    let two = two_angles(&second.along, &third.along, &(c - o), &(first.turned(back, target) - o));
                    found.extend(two.into_iter().map(|[q2, q3]| [-back, q2, q3]));
                }
            }
            Pair::FirstParallel => {
                let component = first.along.dot(&(target - third.point));
                for q3 in component_angles(&third.along, &(c - third.point), &first.along, component) {
                    let two = planar(first, second, &third.turned(q3, c), target);
                    found.extend(two.into_iter().map(|[q1, q2]| [q1, q2, q3]));
                }
            }
            Pair::LastParallel => {
                let component = second.along.dot(&(c - first.point));
                for back in component_angles(&first.along, &(target - first.point), &second.along, component) {
                    let two = planar(second, third, c, &first.turned(back, target));
                    found.extend(two.into_iter().map(|[q2, q3]| [-back, q2, q3]));
                }
            }
        }
        found
    }

    fn parallel(&self, motion: &Pose, meeting: &Vector3<f64>) -> Vec<[f64; 6]> {
        let [first, second, third, fourth] = [&self.axes[0], &self.axes[1], &self.axes[2], &self.axes[3]];
        let h = &second.along;
        let target = (motion * nalgebra::Point3::from(*meeting)).coords;
        let rotation = motion.rotation.to_rotation_matrix();
        let mut solutions = Vec::new();
        let component = h.dot(&(meeting - first.point));
        for back in component_angles(&first.along, &(target - first.point), h, component) {
            let wrist = first.turned(back, &target);
            let rest = self.rotation(0, back) * rotation;
            for [sum, q5, q6] in three_angles([h, self.along(4), self.along(5)], &rest) {
                let elbow = wrist - turned(h, sum, &(meeting - fourth.point));
                let two = planar(second, third, &fourth.point, &elbow);
                // The axes 3 and 4 may point against axis 2.
                let sign = |axis: &Axis| h.dot(&axis.along).signum();
                let fourth_angle = |q2: f64, q3: f64| sign(fourth) * (sum - q2 - sign(third) * q3);
                solutions.extend(two.into_iter().map(|[q2, q3]| [-back, q2, q3, fourth_angle(q2, q3), q5, q6]));
            }
        }
        solutions
    }
}

/// The angles about two parallel axes that bring the point `p` to a target in the same plane.
fn planar(first: &Axis, second: &Axis, p: &Vector3<f64>, target: &Vector3<f64>) -> Angles<[f64; 2]> {
    // The plane through the first axis' point; nothing along the axes matters.
    let flat = |v: Vector3<f64>| v - first.along * first.along.dot(&v);
    let (from, to) = (flat(p - second.point), flat(target - first.point));
    let base = flat(first.point - second.point);
    let angles = distance_angles(&second.along, &from, &base, to.norm());
    let complete = |angle: f64| {
        let arm = turned(&second.along, angle, &from) - base;
        [turn_between(&first.along, &arm, &to), angle]
    };
    angles.into_iter().map(complete).collect()
}

impl Kind {
    /// How these axes decompose; `None` if they do not.
    fn of(axes: &[Axis; 6]) -> Option<Self> {
        let centre = axes[3].meeting(&axes[4]).filter(|centre| axes[5].contains(centre));
        let is_wrist = !axes[4].is_parallel_to(&axes[5]);
        if let Some(centre) = centre.filter(|_| is_wrist)
            && let Some(pair) = Pair::of(&axes[..3])
        {
            return Some(Self::Wrist { centre, pair });
        }
        let parallel = axes[1].is_parallel_to(&axes[2]) && axes[1].is_parallel_to(&axes[3]);
        let across = !axes[0].is_parallel_to(&axes[1]) && !axes[3].is_parallel_to(&axes[4]);
        axes[4].meeting(&axes[5]).filter(|_| parallel && across).map(|meeting| Self::Parallel { meeting })
    }
}

impl Pair {
    /// The pair among three axes; `None` without one or if all three are parallel.
    fn of(axes: &[Axis]) -> Option<Self> {
        let [first, second, third] = [&axes[0], &axes[1], &axes[2]];
        let [before, after] = [first.is_parallel_to(second), second.is_parallel_to(third)];
        match (first.meeting(second), second.meeting(third)) {
            (Some(o), _) => Some(Self::FirstMeet(o)),
            (None, _) if after && !before => Some(Self::LastParallel),
            (None, Some(o)) => Some(Self::LastMeet(o)),
            (None, None) => (before && !after).then_some(Self::FirstParallel),
        }
    }
}
