//! The inverse kinematics of six joints that decompose into position and rotation, alone or beyond a free joint.
//!
//! The decomposition is that of [`super::six_joints`]. Axes of a URDF meet only to its decimals; Newton's method removes the error.

use super::{
    general::General,
    manifold::{SelfMotion, Sliced, branches},
    six_joints::{Axis, SixJoints},
    solution::{contains, is_finite, turned_into},
    trace::Angles,
};
use crate::{model::frames::Pose, robot::chain::Chain};

/// Tolerance of limits for angles before Newton's method clamps them, rad: quarter turns with five decimals move a solution by
/// up to a few 1e-5 rad.
const LIMIT_TOLERANCE_RAD: f64 = 1e-4;

/// The closed form of an arm with six or seven joints.
#[derive(Clone, Debug)]
pub struct Decomposed {
    general: General,
    /// The inverse of the gripper's pose at zero angles.
    x_gw_zero: Pose,
    six: SixJoints,
    /// The joint before or after the six.
    free: Option<FreeJoint>,
}

/// A joint whose angle is given.
#[derive(Clone, Copy, Debug)]
struct FreeJoint {
    /// The first or the last joint.
    joint: usize,
    axis: Axis,
}

impl Decomposed {
    /// The closed form of a chain; `None` if the chain does not decompose. Of seven joints the last is free if that is possible,
    /// else the first.
    pub fn new(chain: &Chain) -> Option<Self> {
        let axes = Axis::of_chain(chain);
        let six = |axes: &[Axis]| SixJoints::new(axes.try_into().ok()?);
        let free = |joint: usize| Some(FreeJoint { joint, axis: axes[joint] });
        let (six, free) = match axes.len() {
            6 => (six(&axes)?, None),
            7 => six(&axes[..6]).map(|six| (six, free(6))).or_else(|| Some((six(&axes[1..])?, free(0))))?,
            _ => return None,
        };
        let x_gw_zero = chain.gripper_pose(&vec![0.0; axes.len()]).inverse();
        Some(Self { general: General::new(chain), x_gw_zero, six, free })
    }

    /// The general solver of the same chain.
    pub(super) fn general(&self) -> &General {
        &self.general
    }

    /// The index of the joint whose angle a slice is given for; `None` for six joints, which have finitely many solutions.
    pub fn free_joint(&self) -> Option<usize> {
        self.free.map(|free| free.joint)
    }

    /// Solutions spread over the set of solutions, within the limits, in a fixed order: of seven joints those at `slices` angles of
    /// the free joint, evenly spread over its range; of six joints all.
    pub fn samples(&self, target: &Pose, slices: usize) -> Vec<Vec<f64>> {
        let Some(FreeJoint { joint, .. }) = self.free else { return self.slice(target, 0.0) };
        let (lower, upper) = (self.general.chain().lower()[joint], self.general.chain().upper()[joint]);
        let angle = |number: usize| lower + (upper - lower) * (number as f64 + 0.5) / slices as f64;
        (0..slices).flat_map(|number| self.slice(target, angle(number))).collect()
    }

    /// All solutions within limits with the free joint at `free_rad`, which six joints ignore. Of a joint range wider than one turn
    /// the turn nearest to its middle counts. Empty if there are none or if the target is not finite; of a continuum of solutions,
    /// where two axes coincide, there is one.
    pub fn slice(&self, target: &Pose, free_rad: f64) -> Vec<Vec<f64>> {
        let chain = self.general.chain();
        let mut solutions: Vec<Vec<f64>> = Vec::new();
        for angles in self.unlimited(target, free_rad) {
            let limits = chain.lower().iter().zip(chain.upper());
            let turned = |(angle, (lower, upper)): (&f64, (&f64, &f64))| {
                turned_into(*angle, [*lower, *upper], LIMIT_TOLERANCE_RAD)
            };
            let within: Option<Vec<f64>> = angles.iter().zip(limits).map(turned).collect();
            let polished = within.and_then(|q_rad| self.general.polished(target, q_rad));
            solutions.extend(polished.filter(|q_rad| !contains(&solutions, q_rad)));
        }
        solutions
    }

    /// All branches of solutions within the joint limits, longest first; `None` for six joints, whose solutions are points. Of a
    /// joint range wider than one turn only the first turn is searched.
    pub fn branches(&self, target: &Pose) -> Option<SelfMotion> {
        let free = self.free?;
        Some(branches(&SevenJoints { arm: self, free_joint: free.joint }, target))
    }

    /// The solutions without limits, not polished.
    fn unlimited(&self, target: &Pose, free_rad: f64) -> Vec<Vec<f64>> {
        if !is_finite(target) || !free_rad.is_finite() {
            return Vec::new();
        }
        let motion = target * self.x_gw_zero;
        let Some(FreeJoint { joint, axis }) = self.free else {
            return self.six.solutions(&motion).into_iter().map(Vec::from).collect();
        };
        let back = axis.motion(-free_rad);
        let rest = if joint == 0 { back * motion } else { motion * back };
        let with_free = |angles: [f64; 6]| {
            let mut angles = Vec::from(angles);
            angles.insert(joint, free_rad);
            angles
        };
        self.six.solutions(&rest).into_iter().map(with_free).collect()
    }
}

/// Seven joints, one of them free.
struct SevenJoints<'a> {
    arm: &'a Decomposed,
    free_joint: usize,
}

impl Sliced for SevenJoints<'_> {
    fn general(&self) -> &General {
        self.arm.general()
    }

    fn free_joint(&self) -> usize {
        self.free_joint
    }

    fn unlimited_slice(&self, target: &Pose, free_rad: f64) -> Vec<Angles> {
        let angles = self.arm.unlimited(target, free_rad);
        angles.iter().map(|angles| Angles::from_column_slice(angles)).collect()
    }

    fn further_seeds(&self, _target: &Pose) -> Vec<Angles> {
        Vec::new()
    }
}
