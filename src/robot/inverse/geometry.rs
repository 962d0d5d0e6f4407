//! The geometry of seven joints whose axes intersect in pairs: the parameters of [`super::closed_form`].

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::{model::frames::Pose, robot::chain::Chain};

/// Tolerance of normal (1) and intersecting (m) axes: quarter turns with five decimals have an error of 4e-6. Newton's method
/// removes the resulting error of the angles.
const STRUCTURE_TOLERANCE: f64 = 1e-5;

/// The nearest rotation has entries this near to axes within [`STRUCTURE_TOLERANCE`]; a turn that was not found has not.
const NEAR_AXES: f64 = 1e-3;

/// Steps of the search for a rotation: its error falls with a power of two at least in each, to that of rounding.
const MOST_STEPS: usize = 64;

/// Minimum shoulder offset of the closed form, m.
const MIN_SHOULDER_OFFSET_M: f64 = 1e-3;

/// The parameters of the closed form.
#[derive(Clone, Debug)]
pub(super) struct Geometry {
    /// The shoulder's frame in W: on the axis of S0 at the height of S1; z along S0, y along S1 at zero angles.
    pub x_wf: Pose,
    /// The wrist's frame M in G: where W1 meets W2; z along W2, y along W1 at zero angles.
    pub x_gm: Pose,
    /// A, m.
    pub shoulder_m: f64,
    /// L1 and B, m.
    pub upper_arm_m: [f64; 2],
    /// L2 and C, m.
    pub forearm_m: [f64; 2],
    /// Angles of the formulas minus joint angles, rad.
    pub offset_rad: [f64; 7],
}

/// Axes and points of a chain at zero angles, W.
struct ZeroPosture {
    axes: [Vector3<f64>; 7],
    origins: [Vector3<f64>; 7],
}

impl ZeroPosture {
    fn new(chain: &Chain) -> Option<Self> {
        let frames = chain.joint_frames(&vec![0.0; chain.dof()]);
        let axes: [Vector3<f64>; 7] = chain.axes_w(&frames).try_into().ok()?;
        let origins: Vec<Vector3<f64>> = frames.iter().map(|x_wj| x_wj.translation.vector).collect();
        let normal = axes.windows(2).all(|pair| pair[0].dot(&pair[1]).abs() < STRUCTURE_TOLERANCE);
        normal.then_some(Self { axes, origins: origins.try_into().ok()? })
    }

    /// Intersection of two axes that are normal to each other; `None` if they do not intersect.
    fn meeting(&self, first: usize, second: usize) -> Option<Vector3<f64>> {
        let (along_first, along_second) = (self.axes[first], self.axes[second]);
        let between = self.origins[second] - self.origins[first];
        let passing = between.dot(&along_first.cross(&along_second));
        let on_first = self.origins[first] + along_first * between.dot(&along_first);
        (passing.abs() < STRUCTURE_TOLERANCE).then_some(on_first)
    }
}

impl Geometry {
    /// The geometry of a chain; `None` if it does not have the structure.
    pub fn new(chain: &Chain) -> Option<Self> {
        let zero = ZeroPosture::new(chain)?;
        let [z, a1, f, y, d, a, tool] = zero.axes;
        let (shoulder, elbow, wrist) = (zero.meeting(1, 2)?, zero.meeting(3, 4)?, zero.meeting(5, 6)?);
        let u = a1.cross(&z);
        let x_e = y.cross(&f);
        let x_f = a.cross(&d);
        let from_base = shoulder - zero.origins[0];
        let (upper_arm, forearm) = (elbow - shoulder, wrist - elbow);
        let aside = [from_base.dot(&a1), upper_arm.dot(&y), forearm.dot(&a)];
        let shoulder_m = from_base.dot(&u);
        if aside.iter().any(|m| m.abs() > STRUCTURE_TOLERANCE) || shoulder_m.abs() < MIN_SHOULDER_OFFSET_M {
            return None;
        }
        let down = |s1: f64| -u * s1.sin() - z * s1.cos();
        let s1 = (-f.dot(&z)).atan2(f.dot(&u));
        let e1 = d.dot(&x_e).atan2(d.dot(&f));
        let across = x_e * e1.cos() - f * e1.sin();
        let x_wf = frame(shoulder - u * shoulder_m, [u, a1, z]);
        let x_wm = frame(wrist, [a.cross(&tool), a, tool]);
        Some(Self {
            x_wf,
            x_gm: chain.gripper_pose(&[0.0; 7]).inverse() * x_wm,
            shoulder_m,
            upper_arm_m: [upper_arm.dot(&f), upper_arm.dot(&x_e)],
            forearm_m: [forearm.dot(&d), forearm.dot(&x_f)],
            offset_rad: [
                0.0,
                s1,
                x_e.dot(&a1).atan2(x_e.dot(&down(s1))),
                e1,
                (-a.dot(&across)).atan2(a.dot(&y)),
                tool.dot(&x_f).atan2(tool.dot(&d)),
                0.0,
            ],
        })
    }
}

/// A frame with these axes.
fn frame(origin: Vector3<f64>, axes: [Vector3<f64>; 3]) -> Pose {
    // Orthonormalises axes that are normal only within the tolerance. The search for the nearest rotation begins at the identity,
    // and does not leave it for half turns; then it begins at the axes.
    let axes = Matrix3::from_columns(&axes);
    let mut rotation = Rotation3::from_matrix(&axes);
    if (rotation.matrix() - axes).amax() > NEAR_AXES {
        let start = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        rotation = Rotation3::from_matrix_eps(&axes, f64::EPSILON, MOST_STEPS, start.to_rotation_matrix());
    }
    Isometry3::from_parts(origin.into(), UnitQuaternion::from_rotation_matrix(&rotation))
}

#[cfg(test)]
mod tests {
    use nalgebra::Unit;

    use super::*;

    #[test]
    fn a_frame_has_its_axes_for_half_turns_too() {
        let directions = [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(1.0, -2.0, 3.0)];
        for (number, direction) in directions.into_iter().enumerate() {
            for angle_rad in [0.0, 1.0, std::f64::consts::PI] {
                let turn = Rotation3::from_axis_angle(&Unit::new_normalize(direction), angle_rad);
                let axes = [0, 1, 2].map(|axis| turn.matrix().column(axis).into_owned());
                let found = frame(Vector3::zeros(), axes).rotation.to_rotation_matrix();
                // Rounding of products of numbers up to 1.
                assert!(
                    (found.matrix() - turn.matrix()).amax() < 1e-14,
                    "direction {number}, {angle_rad} rad: {found}"
                );
            }
        }
    }
}
