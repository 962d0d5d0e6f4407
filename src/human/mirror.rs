//! Mirror images in the body's plane of symmetry, y_B = 0.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use crate::model::{frames::Pose, wrench::Wrench};

/// Mirror image; its own inverse.
pub(super) trait Mirrored {
    /// The mirror image.
    fn mirrored(self) -> Self;
}

/// A position, a force or any other polar vector.
impl Mirrored for Vector3<f64> {
    fn mirrored(self) -> Self {
        Self::new(self.x, -self.y, self.z)
    }
}

/// With `M = diag(1, -1, 1)`: position `M p`, rotation `M R M`.
impl Mirrored for Pose {
    fn mirrored(self) -> Self {
        let q = self.rotation.quaternion();
        let rotation = UnitQuaternion::new_unchecked(Quaternion::new(q.w, -q.i, q.j, -q.k));
        Isometry3::from_parts(Translation3::from(self.translation.vector.mirrored()), rotation)
    }
}

/// A moment is an axial vector, so its mirror image has the opposite sense about the mirrored axis.
impl Mirrored for Wrench {
    fn mirrored(self) -> Self {
        Self::new(self.force_n.mirrored(), -self.moment_nm.mirrored())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;

    #[test]
    fn a_rotation_is_mirrored_as_its_matrix() {
        let pose = Isometry3::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.4, -1.2, 0.7));
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
        let expected = mirror * pose.rotation.to_rotation_matrix().into_inner() * mirror;
        // Rounding of one conversion.
        assert!((pose.mirrored().rotation.to_rotation_matrix().into_inner() - expected).norm() < 1e-15);
        assert_eq!(pose.mirrored().mirrored(), pose);
    }

    #[test]
    fn a_moment_is_the_lever_arm_times_the_force_on_either_side() {
        let (lever, force) = (Vector3::new(0.3, -0.2, 0.5), Vector3::new(1.0, 2.0, -4.0));
        let wrench = Wrench::new(force, lever.cross(&force)).mirrored();
        assert_eq!(wrench.moment_nm, lever.mirrored().cross(&force.mirrored()));
    }
}
