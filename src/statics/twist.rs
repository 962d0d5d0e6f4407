//! Small displacements of a rigid body.

use nalgebra::{Vector3, Vector6};

use crate::model::wrench::Wrench;

/// A small displacement of a rigid body in O axes: the translation of a reference point and the rotation vector.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Translation of the reference point, m.
    pub linear: Vector3<f64>,
    /// Rotation vector, rad.
    pub angular: Vector3<f64>,
}

impl Twist {
    /// The same displacement for the reference point at `lever` from the present one: `t_q = t_p + theta x p_pq`.
    #[must_use]
    pub fn at(&self, lever: &Vector3<f64>) -> Self {
        Self { linear: self.linear + self.angular.cross(lever), angular: self.angular }
    }

    /// Work of a wrench about the same point, J for a twist in m and rad.
    #[must_use]
    pub fn work(&self, wrench: &Wrench) -> f64 {
        self.linear.dot(&wrench.force_n) + self.angular.dot(&wrench.moment_nm)
    }

    pub(super) fn from_vector(vector: &Vector6<f64>) -> Self {
        Self { linear: vector.fixed_rows::<3>(0).into(), angular: vector.fixed_rows::<3>(3).into() }
    }

    pub(super) fn to_vector(self) -> Vector6<f64> {
        let (t, r) = (self.linear, self.angular);
        Vector6::new(t.x, t.y, t.z, r.x, r.y, r.z)
    }
}

impl std::ops::Sub for Twist {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { linear: self.linear - other.linear, angular: self.angular - other.angular }
    }
}
