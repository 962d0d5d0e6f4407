//! Force and moment.

use nalgebra::{UnitQuaternion, Vector3, Vector6};
use serde::{Deserialize, Serialize};

use super::frames::Pose;

/// A force and its moment about a point. The field or function that holds the value states the point and the axes.
/// In files: `[fx, fy, fz, mx, my, mz]`, N and N m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 6]", into = "[f64; 6]")]
pub struct Wrench {
    /// Force, N.
    pub force_n: Vector3<f64>,
    /// Moment about the stated point, N m.
    pub moment_nm: Vector3<f64>,
}

impl Wrench {
    /// A wrench from force and moment.
    pub fn new(force_n: Vector3<f64>, moment_nm: Vector3<f64>) -> Self {
        Self { force_n, moment_nm }
    }

    /// A force through the reference point: no moment.
    pub fn from_force(force_n: Vector3<f64>) -> Self {
        Self::new(force_n, Vector3::zeros())
    }

    /// The same wrench about another point Q: `m_q = m_p + p_qp x f`, where `p_qp` is the position of the old point P
    /// relative to Q, in the wrench's axes.
    #[must_use]
    pub fn about(&self, p_qp: &Vector3<f64>) -> Self {
        Self::new(self.force_n, self.moment_nm + p_qp.cross(&self.force_n))
    }

    /// The same wrench about the origin of A in A axes, for a wrench about the origin of B in B axes.
    #[must_use]
    pub fn moved(&self, x_ab: &Pose) -> Self {
        Self::new(x_ab.rotation * self.force_n, x_ab.rotation * self.moment_nm).about(&x_ab.translation.vector)
    }

    /// This wrench times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self::new(self.force_n * factor, self.moment_nm * factor)
    }

    /// This wrench turned about the point that it is stated about.
    #[must_use]
    pub fn rotated(&self, rotation: &UnitQuaternion<f64>) -> Self {
        Self::new(rotation * self.force_n, rotation * self.moment_nm)
    }

    /// `(force; moment)` as one column.
    #[must_use]
    pub fn to_vector(&self) -> Vector6<f64> {
        let (f, m) = (self.force_n, self.moment_nm);
        Vector6::new(f.x, f.y, f.z, m.x, m.y, m.z)
    }

    /// True if all six components are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.to_vector().iter().all(|v| v.is_finite())
    }
}

impl From<[f64; 6]> for Wrench {
    fn from([fx, fy, fz, mx, my, mz]: [f64; 6]) -> Self {
        Self::new(Vector3::new(fx, fy, fz), Vector3::new(mx, my, mz))
    }
}

impl From<Wrench> for [f64; 6] {
    fn from(wrench: Wrench) -> Self {
        wrench.to_vector().into()
    }
}

impl std::ops::Add for Wrench {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.force_n + other.force_n, self.moment_nm + other.moment_nm)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, UnitQuaternion};

    use super::*;

    #[test]
    fn a_force_off_the_point_gains_the_lever_arm() {
        let wrench = Wrench::from_force(Vector3::new(0.0, 0.0, -10.0));
        let moved = wrench.about(&Vector3::new(0.5, 0.0, 0.0));
        assert_eq!(moved.moment_nm, Vector3::new(0.0, 5.0, 0.0));
    }

    #[test]
    fn power_is_the_same_in_every_frame() {
        let x_ab = Isometry3::from_parts(
            Vector3::new(0.3, -0.2, 0.7).into(),
            UnitQuaternion::from_euler_angles(0.4, -1.1, 2.0),
        );
        let wrench_b = Wrench::from([1.0, -2.0, 3.0, 0.4, 0.5, -0.6]);
        let (velocity_b, omega_b) = (Vector3::new(0.2, 0.1, -0.5), Vector3::new(-0.3, 0.9, 0.4));
        let omega_a = x_ab.rotation * omega_b;
        let velocity_at_a = x_ab.rotation * velocity_b - omega_a.cross(&x_ab.translation.vector);
        let wrench_a = wrench_b.moved(&x_ab);
        let power_b = wrench_b.force_n.dot(&velocity_b) + wrench_b.moment_nm.dot(&omega_b);
        let power_a = wrench_a.force_n.dot(&velocity_at_a) + wrench_a.moment_nm.dot(&omega_a);
        // Ten products of numbers of order one: rounding errors stay below 1e-14.
        assert!((power_a - power_b).abs() < 1e-14);
    }
}
