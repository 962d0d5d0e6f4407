//! Builds a [`ContactModel`] from a plan. The only file of this module that uses the robot model.

use nalgebra::{DVector, Isometry2, Isometry3, Matrix6xX, Rotation3, UnitQuaternion, Vector2, Vector3};

use super::{
    contact_model::{ContactModel, ContactModelError},
    hand::HandModel,
    hold::{Hold, MeasuredHold, PadPair},
    pad_model::PadModel,
    patch::{clip_to_outline, clip_to_rectangle},
    twist::Twist,
};
use crate::{
    check::{CheckedArm, CheckedPlan},
    model::{
        GRAVITY_W,
        frames::Pose,
        operation::Operation,
        plan::{ArmHold, PlacedObject},
        uncertainty::Uncertainty,
        wrench::Wrench,
    },
    robot::{Arm, Chain, Gripper, Holding, MeasuredGrip, PadGrip},
};

impl ContactModel {
    /// The contact model of a plan. Board, pads and arms are at the plan's poses and angles. Pads lie flat on the two
    /// faces; only the part of a pad that is on the face counts (see `patch.rs`).
    ///
    /// # Errors
    /// If a pad is off the board.
    pub fn of_plan(checked: &CheckedPlan<'_>, friction: f64) -> Result<Self, ContactModelError> {
        Self::under(checked, friction, &Uncertainty::default())
    }

    /// The contact model of a plan whose world deviates from it. Contacts between rigid pads and board stay rigid.
    ///
    /// # Errors
    /// If a pad is off the board.
    pub fn under(checked: &CheckedPlan<'_>, friction: f64, of: &Uncertainty) -> Result<Self, ContactModelError> {
        let object = &of.board(&checked.plan().object);
        let hand = |(number, arm): (usize, &CheckedArm<'_>)| {
            let friction = friction * of.friction_scale_of(number);
            let robot_arm = &checked.robot().arms[arm.index];
            let mut hand = HandModel::new(robot_arm, &arm.chain, arm.hold, object, friction)?;
            hand.scale_grip(of.grip_force_scale_of(number));
            hand.stiffness_nm_rad *= of.joint_stiffness_scale;
            if let Some(offset_deg) = of.joint_offset_deg.get(number) {
                hand.set_offset(&DVector::from_iterator(
                    offset_deg.len(),
                    offset_deg.iter().map(|deg| deg.to_radians()),
                ));
            }
            for pad in hand.pads_mut() {
                pad.stiffness_n_m = pad.stiffness_n_m.map(|stiffness_n_m| stiffness_n_m * of.contact_stiffness_scale);
            }
            Ok(hand)
        };
        let hands: Result<Vec<_>, _> = checked.arms().iter().enumerate().map(hand).collect();
        let model = Self::from_hands(hands?, object, &of.operation(&checked.plan().operation));
        Ok(Self { load: model.load.scaled(of.force_scale), ..model })
    }

    /// The contact model of these hands, see [`HandModel::new`].
    #[must_use]
    pub fn from_hands(hands: Vec<HandModel>, object: &PlacedObject, operation: &Operation) -> Self {
        let weight_o = Wrench::from_force(object.x_wo.rotation.inverse() * (GRAVITY_W * object.mass_kg));
        Self {
            hands,
            weight: if object.is_uniform_box() { weight_o } else { weight_o.about(&object.com_o()) },
            load: operation.wrench_about_object(),
            p_ot: operation.x_ot.translation.vector,
        }
    }
}

impl HandModel {
    /// One arm's part of the contact model. `chain` is that of the arm with its fingers at the board's thickness, and `hold`
    /// belongs to the arm.
    ///
    /// # Errors
    /// If a pad is off the board.
    pub fn new(
        arm: &Arm,
        chain: &Chain,
        hold: &ArmHold,
        object: &PlacedObject,
        friction: f64,
    ) -> Result<Self, ContactModelError> {
        let held_by = match &arm.gripper.holding {
            Holding::Pads(pads) => {
                let [first, second] =
                    [0, 1].map(|finger| pad_model(&arm.gripper, pads, finger, hold, object, friction));
                Hold::Pads(PadPair { pads: [first?, second?], grip_force_n: hold.grip_force_n })
            }
            Holding::Measured(MeasuredGrip { limits, stiffness }) => {
                Hold::Measured(MeasuredHold { rotation_og: hold.x_og.rotation, limits: *limits, stiffness: *stiffness })
            }
        };
        let grasp_point_g = arm.gripper.grasp_point_g();
        Ok(Self {
            name: hold.name.clone(),
            joints: hold.joints.clone(),
            hold: held_by,
            grasp_point_o: (hold.x_og * nalgebra::Point3::from(grasp_point_g)).coords,
            jacobian_o: jacobian_o(chain, hold, object, &grasp_point_g),
            gravity_torque_nm: chain.gravity_torque_nm(&hold.q_rad),
            effort_nm: chain.effort_nm().to_vec().into(),
            stiffness_nm_rad: arm.stiffness_nm_rad.clone().into(),
            gravity_stiffness_nm_rad: chain.gravity_stiffness_nm_rad(&hold.q_rad),
            offset: Twist::default(),
        })
    }
}

/// The Jacobian of the grasp point in O axes, from that of G's origin in W axes.
fn jacobian_o(chain: &Chain, hold: &ArmHold, object: &PlacedObject, grasp_point_g: &Vector3<f64>) -> Matrix6xX<f64> {
    let mut jacobian = chain.jacobian_w(&hold.q_rad);
    let r_ow = object.x_wo.rotation.inverse();
    // The hand is at the plan's X_WO X_OG; the arm's angles agree with it.
    let lever_o = hold.x_og.rotation * grasp_point_g;
    for mut column in jacobian.column_iter_mut() {
        let angular = r_ow * Vector3::new(column[3], column[4], column[5]);
        let linear = r_ow * Vector3::new(column[0], column[1], column[2]) + angular.cross(&lever_o);
        column.fixed_rows_mut::<3>(0).copy_from(&linear);
        column.fixed_rows_mut::<3>(3).copy_from(&angular);
    }
    jacobian
}

/// The pad of a finger on the board.
fn pad_model(
    gripper: &Gripper,
    pads: &PadGrip,
    finger: usize,
    hold: &ArmHold,
    object: &PlacedObject,
    friction: f64,
) -> Result<PadModel, ContactModelError> {
    let name = gripper.pad_name(finger, &hold.x_og);
    let is_upper = name == "upper";
    let pad = &gripper.fingers[finger].pad;
    let normal_o = if is_upper { -Vector3::z() } else { Vector3::z() };
    let rotation = pad_rotation(&(hold.x_og.rotation * Vector3::x()), &normal_o);
    let centre_g = Vector3::new(pad.centre_m[0], 0.0, pad.centre_m[1]);
    let centre_o = (hold.x_og * nalgebra::Point3::from(centre_g)).coords;
    let x_fp = face_pose(&centre_o, &rotation);
    let [width, height, thickness] = object.size_m;
    let half_sides = pad.size_m.map(|side| side / 2.0);
    let clipped = match &object.plate {
        None => clip_to_rectangle([width / 2.0, height / 2.0], &x_fp, half_sides),
        Some(plate) => clip_to_outline(plate.sides(), &x_fp, half_sides),
    };
    let (centre_f, half_sides_m) =
        clipped.ok_or_else(|| ContactModelError::PadOffBoard { hand: hold.name.clone(), pad: name.into() })?;
    let place_o = Vector3::new(centre_f.x, centre_f.y, -normal_o.z * thickness / 2.0);
    // A uniform layer: a part of it has the same share of its stiffness as of its area.
    let share = half_sides_m[0] * half_sides_m[1] / (half_sides[0] * half_sides[1]);
    Ok(PadModel {
        name: name.into(),
        x_op: Pose::from_parts(place_o.into(), rotation),
        half_sides_m,
        friction,
        stiffness_n_m: pads.pad_stiffness_n_m.map(|stiffness_n_m| stiffness_n_m * share),
    })
}

/// R_OP: z_P along the normal into the board, x_P along the projection of x_G on the face.
fn pad_rotation(x_g_in_o: &Vector3<f64>, normal_o: &Vector3<f64>) -> UnitQuaternion<f64> {
    let x_p = (x_g_in_o - normal_o * normal_o.dot(x_g_in_o)).normalize();
    let rotation = Rotation3::from_basis_unchecked(&[x_p, normal_o.cross(&x_p), *normal_o]);
    UnitQuaternion::from_rotation_matrix(&rotation)
}

/// The pad's pose in the face, seen from +z_O. The rectangle is its own mirror image, so this serves both faces.
fn face_pose(centre_o: &Vector3<f64>, rotation: &UnitQuaternion<f64>) -> Isometry2<f64> {
    let x_p: Isometry3<f64> = Isometry3::from_parts(Vector3::zeros().into(), *rotation);
    let x_p = x_p * Vector3::x();
    Isometry2::new(Vector2::new(centre_o.x, centre_o.y), x_p.y.atan2(x_p.x))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gripper that is tilted about its own y axis still has its pads flat on the faces.
    #[test]
    fn a_pad_lies_flat_below_a_tilted_gripper() {
        for normal_o in [Vector3::z(), -Vector3::z()] {
            let rotation = pad_rotation(&Vector3::new(0.6, 0.0, 0.8), &normal_o);
            // Rounding of unit vectors.
            assert!((rotation * Vector3::z() - normal_o).norm() < 1e-15);
            assert!((rotation * Vector3::x() - Vector3::x()).norm() < 1e-15);
        }
    }
}
