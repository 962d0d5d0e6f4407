//! A hold as plain geometry: what the programs of this module are built from.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix6xX, Vector3};

use super::patch::mean_distance_from_centre_m;
use crate::model::{frames::Pose, wrench::Wrench};

/// The most hands that a hold may have.
pub(super) const MAX_HANDS: usize = 4;

/// One pad on the object, a soft finger with a rectangular patch (METHOD section 6).
#[derive(Clone, Debug, PartialEq)]
pub struct PadModel {
    /// Which of the hand's pads it is, such as `upper`.
    pub name: String,
    /// Pose in O of the centre of the part of the pad that lies on the face; z_P is the normal INTO the object.
    pub x_op: Pose,
    /// Half sides of that part along x_P and y_P, m.
    pub half_sides_m: [f64; 2],
    /// Coulomb friction between pad and object.
    pub friction: f64,
}

impl PadModel {
    /// The lever arm of the patch's torsional friction, m: the mean distance of the patch from its centre.
    pub fn torsion_radius_m(&self) -> f64 {
        mean_distance_from_centre_m(self.half_sides_m)
    }

    /// R_OP.
    pub(super) fn rotation(&self) -> Matrix3<f64> {
        self.x_op.rotation.to_rotation_matrix().into_inner()
    }

    /// The wrench of the pad on the object about O's origin in O axes, for that about the pad's centre in pad axes.
    pub fn wrench_about_object(&self, wrench_p: &Wrench) -> Wrench {
        wrench_p.moved(&self.x_op)
    }
}

/// One hand of a hold; everything in O axes unless said otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct HandModel {
    /// The arm's name, such as `left`.
    pub name: String,
    /// The names of the arm's n joints, from the base outward.
    pub joints: Vec<String>,
    /// Its two pads.
    pub pads: [PadModel; 2],
    /// Force F with which each finger is pushed, N; the fingers are coupled, so the two normal forces add up to 2 F.
    pub grip_force_n: f64,
    /// The point between the pads about which the hand's wrench is taken, in O, m.
    pub grasp_point_o: Vector3<f64>,
    /// 6 x n: rows 0 to 2 the velocity of the grasp point (m/s), rows 3 to 5 the angular velocity (rad/s), O axes, for
    /// joint rates in rad/s.
    pub jacobian_o: Matrix6xX<f64>,
    /// Torque that holds the arm, gripper included, against gravity, n, N m.
    pub gravity_torque_nm: DVector<f64>,
    /// Largest torque of each joint, n, N m.
    pub effort_nm: DVector<f64>,
    /// Stiffness of each joint's position control, n, N m/rad.
    pub stiffness_nm_rad: DVector<f64>,
    /// `dg/dq`, n x n, N m/rad: how the torque that gravity asks for changes with the angles. The control compensates
    /// gravity at the planned angles, so this adds to its stiffness, or takes from it.
    pub gravity_stiffness_nm_rad: DMatrix<f64>,
}

impl HandModel {
    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The wrench of the hand on the object about the grasp point in O axes, for its pads' wrenches, each about the
    /// pad's centre in pad axes.
    pub fn wrench_about_grasp_point(&self, pads_p: &[Wrench; 2]) -> Wrench {
        let about_object = |index: usize| self.pads[index].wrench_about_object(&pads_p[index]);
        (about_object(0) + about_object(1)).about(&-self.grasp_point_o)
    }
}

/// A board in the grip of one to four hands, under its weight and an operation.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactModel {
    /// The hands.
    pub hands: Vec<HandModel>,
    /// Gravity on the object, about O's origin in O axes.
    pub weight: Wrench,
    /// The operation's wrench at load factor 1, about O's origin in O axes.
    pub load: Wrench,
    /// The tool tip in O, m: deflection is measured there.
    pub p_ot: Vector3<f64>,
}

/// A hold that no figure can be computed for: broken input, unlike a hold that is too weak.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContactModelError {
    /// Too few or too many hands.
    #[error("found {0} hands, expected 1 to {MAX_HANDS}")]
    HandCount(usize),
    /// An array whose length is not the number of joints.
    #[error("{hand} hand: found {found} entries of {what}, expected one for each of {expected} joints")]
    JointCount {
        /// The hand.
        hand: String,
        /// The array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The number of joints.
        expected: usize,
    },
    /// A figure outside its range, or not finite.
    #[error("{place}: found {what} {found}, expected {expected}")]
    Value {
        /// The hand or pad.
        place: String,
        /// The quantity.
        what: &'static str,
        /// Its value.
        found: f64,
        /// Its range.
        expected: &'static str,
    },
    /// A wrench, point or pose that is not finite.
    #[error("{place}: found a {what} that is not finite")]
    NotFinite {
        /// The hand, pad or object.
        place: String,
        /// The quantity.
        what: &'static str,
    },
    /// An arm that the robot does not have.
    #[error("found arm \"{0}\", which the robot does not have")]
    UnknownArm(String),
    /// Joints that are not the arm's, or in another order.
    #[error("{hand} hand: found the joints {found:?}, expected {expected:?}")]
    JointNames {
        /// The hand.
        hand: String,
        /// The plan's joints.
        found: Vec<String>,
        /// The robot's.
        expected: Vec<String>,
    },
    /// No variations of a load to stand.
    #[error("found no variations, expected at least one")]
    NoVariations,
    /// Springs that give way under the arm's own weight without end.
    #[error("{0} hand: the joints' springs are too soft for the arm's own weight")]
    TooSoft(String),
    /// A pad that does not touch the object's face.
    #[error("{hand} {pad} pad: no part of it lies on the board")]
    PadOffBoard {
        /// The hand.
        hand: String,
        /// The pad.
        pad: String,
    },
    /// A gripper that does not straddle the board's faces.
    #[error(
        "{hand} hand: found the finger axis {angle_deg:.3} degrees from the board's normal, expected less than {limit_deg}"
    )]
    FingersNotAcross {
        /// The hand.
        hand: String,
        /// Angle between finger axis and normal, degrees.
        angle_deg: f64,
        /// The largest angle that is accepted, degrees.
        limit_deg: f64,
    },
}

impl ContactModel {
    /// Checks dimensions and ranges.
    ///
    /// # Errors
    /// The first thing that is wrong, with its place.
    pub fn check(&self) -> Result<(), ContactModelError> {
        if self.hands.is_empty() || self.hands.len() > MAX_HANDS {
            return Err(ContactModelError::HandCount(self.hands.len()));
        }
        let finite = [
            ("weight", self.weight.is_finite()),
            ("load", self.load.is_finite()),
            ("tool tip", self.p_ot.iter().all(|v| v.is_finite())),
        ];
        if let Some((what, _)) = finite.into_iter().find(|(_, finite)| !finite) {
            return Err(ContactModelError::NotFinite { place: "object".into(), what });
        }
        self.hands.iter().try_for_each(check_hand)
    }
}

fn check_hand(hand: &HandModel) -> Result<(), ContactModelError> {
    let expected = hand.dof();
    let lengths = [
        ("the jacobian's columns", hand.jacobian_o.ncols()),
        ("gravity torque", hand.gravity_torque_nm.len()),
        ("effort", hand.effort_nm.len()),
        ("stiffness", hand.stiffness_nm_rad.len()),
        ("gravity stiffness (rows)", hand.gravity_stiffness_nm_rad.nrows()),
        ("gravity stiffness (columns)", hand.gravity_stiffness_nm_rad.ncols()),
    ];
    if let Some((what, found)) = lengths.into_iter().find(|(_, found)| *found != expected) {
        return Err(ContactModelError::JointCount { hand: hand.name.clone(), what, found, expected });
    }
    let place = || format!("{} hand", hand.name);
    let finite = [
        ("jacobian", hand.jacobian_o.iter().all(|v| v.is_finite())),
        ("gravity torque", hand.gravity_torque_nm.iter().all(|v| v.is_finite())),
        ("gravity stiffness", hand.gravity_stiffness_nm_rad.iter().all(|v| v.is_finite())),
        ("grasp point", hand.grasp_point_o.iter().all(|v| v.is_finite())),
    ];
    if let Some((what, _)) = finite.into_iter().find(|(_, finite)| !finite) {
        return Err(ContactModelError::NotFinite { place: place(), what });
    }
    let positive = |what, found: f64| {
        let good = found.is_finite() && found > 0.0;
        if good {
            Ok(())
        } else {
            Err(ContactModelError::Value { place: place(), what, found, expected: "more than 0" })
        }
    };
    positive("grip force", hand.grip_force_n)?;
    hand.effort_nm.iter().try_for_each(|&effort| positive("effort", effort))?;
    hand.stiffness_nm_rad.iter().try_for_each(|&stiffness| positive("stiffness", stiffness))?;
    if expected > 0 && hand.spring_factor().is_none() {
        return Err(ContactModelError::TooSoft(hand.name.clone()));
    }
    hand.pads.iter().try_for_each(|pad| check_pad(hand, pad))
}

fn check_pad(hand: &HandModel, pad: &PadModel) -> Result<(), ContactModelError> {
    let place = || format!("{} {} pad", hand.name, pad.name);
    let translation = pad.x_op.translation.vector;
    if !translation.iter().chain(pad.x_op.rotation.coords.iter()).all(|v| v.is_finite()) {
        return Err(ContactModelError::NotFinite { place: place(), what: "pose" });
    }
    if let Some(&found) = pad.half_sides_m.iter().find(|side| !(side.is_finite() && **side > 0.0)) {
        return Err(ContactModelError::Value { place: place(), what: "half side", found, expected: "more than 0 m" });
    }
    if !(pad.friction.is_finite() && pad.friction >= 0.0) {
        return Err(ContactModelError::Value {
            place: place(),
            what: "friction",
            found: pad.friction,
            expected: "0 or more",
        });
    }
    Ok(())
}
