//! The forceful operation: the wrench that the tool exerts on the board and the tool's pose, the paper's tuple
//! `(°f, X_OT)` (`docs/method.md#21-forceful-operation`).

use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    frames::{Pose, PoseForm, WrenchSchema, pose},
    wrench::Wrench,
};

/// The kind of a forceful operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum OperationKind {
    /// A force along the tool's axis, into the board. The tool's roll about this axis is free, because a spindle is
    /// symmetric.
    Drill,
    /// A force along the blade's edge, in the plane of the face.
    Cut,
    /// An arbitrary wrench at an arbitrary pose of the tool.
    Wrench,
}

impl OperationKind {
    /// True if the person may choose the tool's roll about its axis.
    pub fn roll_is_free(self) -> bool {
        self == Self::Drill
    }
}

impl std::fmt::Display for OperationKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Drill => "drill",
            Self::Cut => "cut",
            Self::Wrench => "wrench",
        })
    }
}

/// A forceful operation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Operation {
    /// The kind.
    pub kind: OperationKind,
    /// The wrench that the tool exerts on the board, about the tool tip, O axes.
    #[schemars(with = "WrenchSchema")]
    pub wrench_o: Wrench,
    /// The tool's pose in O: z_T points out of the tool into the material; for a blade x_T is the cutting direction.
    #[serde(with = "pose")]
    #[schemars(with = "PoseForm")]
    pub x_ot: Pose,
}

impl Operation {
    /// Drilling at a point of the worked face: `force_n` along `z_T = -z_O`; `x_T = x_O` until a roll is chosen
    /// (`docs/method.md#22-drilling`).
    #[must_use]
    pub fn drill(point_m: [f64; 2], force_n: f64, thickness_m: f64) -> Self {
        let x_ot = tool_on_face(point_m, Vector3::x(), thickness_m);
        Self { kind: OperationKind::Drill, wrench_o: Wrench::from_force(Vector3::new(0.0, 0.0, -force_n)), x_ot }
    }

    /// Cutting at a point of the worked face: `force_n` along `direction_o`, which is `x_T`; `z_T = -z_O`.
    /// `direction_o` must be a unit vector in the plane of the face.
    #[must_use]
    pub fn cut(point_m: [f64; 2], direction_o: Vector3<f64>, force_n: f64, thickness_m: f64) -> Self {
        let x_ot = tool_on_face(point_m, direction_o, thickness_m);
        Self { kind: OperationKind::Cut, wrench_o: Wrench::from_force(direction_o * force_n), x_ot }
    }

    /// Cutting a circle about the board's centre, counter-clockwise seen from +z_O: `force_n` along the tangent at the point
    /// `angle_rad` from x_O towards y_O (`docs/method.md#23-cutting`).
    #[must_use]
    pub fn cut_on_circle(radius_m: f64, angle_rad: f64, force_n: f64, thickness_m: f64) -> Self {
        let (sin, cos) = libm::sincos(angle_rad);
        Self::cut([radius_m * cos, radius_m * sin], Vector3::new(-sin, cos, 0.0), force_n, thickness_m)
    }

    /// The radius of the circle about the board's centre that this operation cuts, m. `None` if it is not a cut or is at the
    /// centre.
    #[must_use]
    pub fn circle_radius_m(&self) -> Option<f64> {
        let p_ot = self.x_ot.translation.vector;
        let radius_m = libm::hypot(p_ot.x, p_ot.y);
        (self.kind == OperationKind::Cut && radius_m > 0.0).then_some(radius_m)
    }

    /// The operation with the tool rotated by `roll_rad` about z_T.
    #[must_use]
    pub fn rolled(&self, roll_rad: f64) -> Self {
        let roll = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), roll_rad);
        Self { x_ot: self.x_ot * roll, ..*self }
    }

    /// The wrench about the tool tip in W axes, for a board at `x_wo`.
    #[must_use]
    pub fn wrench_w(&self, x_wo: &Pose) -> Wrench {
        Wrench::new(x_wo.rotation * self.wrench_o.force_n, x_wo.rotation * self.wrench_o.moment_nm)
    }

    /// The normal of the worked face in O, out of the board: that of the face with the tool tip or, if the tip is on no face,
    /// against z_T.
    #[must_use]
    pub fn face_normal_o(&self, thickness_m: f64) -> Vector3<f64> {
        /// Of the tip from a face, m: rounding of written numbers.
        const ON_FACE_M: f64 = 1e-6;
        let z_m = self.x_ot.translation.z;
        if (z_m.abs() - thickness_m / 2.0).abs() <= ON_FACE_M {
            Vector3::z() * z_m.signum()
        } else {
            self.x_ot.rotation * -Vector3::z()
        }
    }

    /// [`Operation::face_normal_o`] in T.
    #[must_use]
    pub fn face_normal_t(&self, thickness_m: f64) -> Vector3<f64> {
        self.x_ot.rotation.inverse() * self.face_normal_o(thickness_m)
    }

    /// The wrench about the board's centre in O axes: `(f, m + p_OT x f)`.
    #[must_use]
    pub fn wrench_about_object(&self) -> Wrench {
        self.wrench_o.about(&self.x_ot.translation.vector)
    }
}

/// The tool's pose on the worked face: x_T as given, z_T = -z_O.
fn tool_on_face(point_m: [f64; 2], x_t: Vector3<f64>, thickness_m: f64) -> Pose {
    let z_t = -Vector3::z();
    let rotation = Rotation3::from_basis_unchecked(&[x_t, z_t.cross(&x_t), z_t]);
    Isometry3::from_parts(
        Vector3::new(point_m[0], point_m[1], thickness_m / 2.0).into(),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drill_pushes_into_the_face() {
        let drill = Operation::drill([0.1, -0.1], 15.0, 0.03);
        assert_eq!(drill.wrench_o.force_n, Vector3::new(0.0, 0.0, -15.0));
        assert_eq!(drill.x_ot.translation.vector, Vector3::new(0.1, -0.1, 0.015));
        let z_t = drill.x_ot.rotation * Vector3::z();
        assert!((z_t + Vector3::z()).norm() < 1e-15);
    }

    #[test]
    fn a_blade_moves_along_its_own_x() {
        let direction = Vector3::new(-0.6, 0.8, 0.0);
        let cut = Operation::cut([0.12, 0.0], direction, 30.0, 0.03);
        assert!((cut.x_ot.rotation * Vector3::x() - direction).norm() < 1e-15);
        assert!((cut.wrench_o.force_n - direction * 30.0).norm() < 1e-14);
    }
}
