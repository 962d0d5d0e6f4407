//! Deviations of a simulation from its plan.

use nalgebra::{UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    frames::Pose,
    omitted::{is_default, is_one},
    operation::Operation,
    plan::PlacedObject,
};

/// Deviations of the simulation from what the plan assumes; none by default. They do not affect plans and predictions
/// (`docs/method.md#611-uncertain-friction-and-loads`). Factors are multiples of the planned values. A sweep draws one for each of
/// its runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Uncertainty {
    /// Factor of the friction between pads and board.
    pub friction_scale: f64,
    /// Factor of the grip force.
    pub grip_force_scale: f64,
    /// Factor of the stiffness of the contacts between pads and board, and of elastic pads.
    pub contact_stiffness_scale: f64,
    /// Factor of the stiffness of every joint's position control.
    pub joint_stiffness_scale: f64,
    /// Further factors of the friction, one for each of the plan's arms in its order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub friction_scales: Vec<f64>,
    /// Further factors of the grip force, one for each of the plan's arms in its order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub grip_force_scales: Vec<f64>,
    /// Factor of the board's mass, about an unchanged centre. The arms know the planned mass.
    #[serde(skip_serializing_if = "is_one")]
    pub board_mass_scale: f64,
    /// What the board is thicker than planned, mm. Its faces move by half of it.
    #[serde(skip_serializing_if = "is_default")]
    pub board_thickness_mm: f64,
    /// Factor of the tool's wrench.
    #[serde(skip_serializing_if = "is_one")]
    pub force_scale: f64,
    /// Rotation of the tool's wrench about the tool tip: about x_T, then about y_T, degrees.
    #[serde(skip_serializing_if = "is_default")]
    pub tool_tilt_deg: [f64; 2],
    /// Displacement of the tool point in the worked face, mm along x_O and y_O.
    #[serde(skip_serializing_if = "is_default")]
    pub tool_offset_mm: [f64; 2],
    /// Displacement of the person in their planned posture, mm along x_W and y_W.
    #[serde(skip_serializing_if = "is_default")]
    pub person_offset_mm: [f64; 2],
    /// How far the arms' true joint angles are from the measured ones: for each of the plan's arms in its order, one value a
    /// joint, degrees.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joint_offset_deg: Vec<Vec<f64>>,
    /// Factor of the duration of the ramp.
    #[serde(skip_serializing_if = "is_one")]
    pub ramp_scale: f64,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Self {
            friction_scale: 1.0,
            grip_force_scale: 1.0,
            contact_stiffness_scale: 1.0,
            joint_stiffness_scale: 1.0,
            friction_scales: Vec::new(),
            grip_force_scales: Vec::new(),
            board_mass_scale: 1.0,
            board_thickness_mm: 0.0,
            force_scale: 1.0,
            tool_tilt_deg: [0.0; 2],
            tool_offset_mm: [0.0; 2],
            person_offset_mm: [0.0; 2],
            joint_offset_deg: Vec::new(),
            ramp_scale: 1.0,
        }
    }
}

impl Uncertainty {
    /// The board as it is, for one as planned.
    #[must_use]
    pub fn board(&self, planned: &PlacedObject) -> PlacedObject {
        let [width_m, height_m, thickness_m] = planned.size_m;
        let size_m = [width_m, height_m, thickness_m + 1e-3 * self.board_thickness_mm];
        PlacedObject { size_m, mass_kg: planned.mass_kg * self.board_mass_scale, ..planned.clone() }
    }

    /// The operation as it is, for one as planned: the tool tilted about its tip, the tip displaced, and on the face of the
    /// board as it is. `force_scale` is not in it.
    #[must_use]
    pub fn operation(&self, planned: &Operation) -> Operation {
        if *self == Self::default() {
            return *planned;
        }
        let tilt_o = self.tilt_o(planned);
        let p_ot_m = planned.x_ot.translation.vector;
        let [x_mm, y_mm] = self.tool_offset_mm;
        let moved_mm = Vector3::new(x_mm, y_mm, p_ot_m.z.signum() * self.board_thickness_mm / 2.0);
        Operation {
            wrench_o: planned.wrench_o.rotated(&tilt_o),
            x_ot: Pose::from_parts((p_ot_m + moved_mm * 1e-3).into(), tilt_o * planned.x_ot.rotation),
            ..*planned
        }
    }

    /// The rotation of the tool by its tilt, O axes.
    #[must_use]
    pub fn tilt_o(&self, planned: &Operation) -> UnitQuaternion<f64> {
        if self.tool_tilt_deg == [0.0; 2] {
            return UnitQuaternion::identity();
        }
        let [about_x, about_y] = self.tool_tilt_deg.map(f64::to_radians);
        let tilt_t = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), about_x)
            * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), about_y);
        let rotation_ot = planned.x_ot.rotation;
        rotation_ot * tilt_t * rotation_ot.inverse()
    }

    /// These deviations and further ones together: factors multiply, offsets add.
    #[must_use]
    pub fn and(&self, further: &Self) -> Self {
        let pairs = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self {
            friction_scale: self.friction_scale * further.friction_scale,
            grip_force_scale: self.grip_force_scale * further.grip_force_scale,
            contact_stiffness_scale: self.contact_stiffness_scale * further.contact_stiffness_scale,
            joint_stiffness_scale: self.joint_stiffness_scale * further.joint_stiffness_scale,
            friction_scales: each(&self.friction_scales, &further.friction_scales, |a, b| a * b),
            grip_force_scales: each(&self.grip_force_scales, &further.grip_force_scales, |a, b| a * b),
            board_mass_scale: self.board_mass_scale * further.board_mass_scale,
            board_thickness_mm: self.board_thickness_mm + further.board_thickness_mm,
            force_scale: self.force_scale * further.force_scale,
            tool_tilt_deg: pairs(self.tool_tilt_deg, further.tool_tilt_deg),
            tool_offset_mm: pairs(self.tool_offset_mm, further.tool_offset_mm),
            person_offset_mm: pairs(self.person_offset_mm, further.person_offset_mm),
            joint_offset_deg: each(&self.joint_offset_deg, &further.joint_offset_deg, |a, b| {
                each(&a, &b, |a, b| a + b)
            }),
            ramp_scale: self.ramp_scale * further.ramp_scale,
        }
    }

    /// Factor of the friction of an arm's pads, by its place in the plan.
    #[must_use]
    pub fn friction_scale_of(&self, arm: usize) -> f64 {
        self.friction_scale * self.friction_scales.get(arm).copied().unwrap_or(1.0)
    }

    /// Factor of an arm's grip force, by its place in the plan.
    #[must_use]
    pub fn grip_force_scale_of(&self, arm: usize) -> f64 {
        self.grip_force_scale * self.grip_force_scales.get(arm).copied().unwrap_or(1.0)
    }
}

/// Two lists, entry by entry; where one of them has no entry, that of the other.
fn each<T: Clone>(first: &[T], second: &[T], join: impl Fn(T, T) -> T) -> Vec<T> {
    let entry = |index: usize| match (first.get(index).cloned(), second.get(index).cloned()) {
        (Some(a), Some(b)) => Some(join(a, b)),
        (a, b) => a.or(b),
    };
    (0..first.len().max(second.len())).filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_multiply_and_offsets_add() {
        let first = Uncertainty {
            friction_scale: 0.5,
            grip_force_scales: vec![2.0, 3.0],
            board_thickness_mm: 0.5,
            tool_tilt_deg: [1.0, 2.0],
            joint_offset_deg: vec![vec![0.25, 0.5], vec![]],
            ..Uncertainty::default()
        };
        let second = Uncertainty {
            friction_scale: 0.5,
            friction_scales: vec![4.0, 1.0],
            grip_force_scales: vec![0.5, 2.0],
            board_thickness_mm: -1.0,
            tool_tilt_deg: [0.5, -2.0],
            joint_offset_deg: vec![vec![0.25, -0.5], vec![1.0]],
            ..Uncertainty::default()
        };
        let both = first.and(&second);
        assert_eq!([both.friction_scale_of(0), both.friction_scale_of(1)], [1.0, 0.25]);
        assert_eq!(both.grip_force_scales, [1.0, 6.0]);
        assert_eq!((both.board_thickness_mm, both.tool_tilt_deg), (-0.5, [1.5, 0.0]));
        assert_eq!(both.joint_offset_deg, [vec![0.5, 0.0], vec![1.0]]);
        assert_eq!(both, second.and(&first));
        assert_eq!(first.and(&Uncertainty::default()), first);
    }
}
