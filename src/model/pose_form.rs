//! The forms in which files state a pose.

use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

/// Largest deviation of a quaternion's length from 1 in a file. Six written digits stay within it.
const UNIT_TOLERANCE: f64 = 1e-5;

/// Largest deviation of an entry of `R' R` from the unit matrix in a file: six written digits of each entry give at most
/// 2 sqrt(3) 5e-7 = 1.7e-6, numbers of 32 bits less.
const RIGID_TOLERANCE: f64 = 1e-5;

/// A quaternion whose length deviates less than this is kept bit by bit: a plan read from a file then gives the same
/// simulation as the plan that was written.
const NORMALISED: f64 = 1e-12;

/// The forms of a pose, for messages.
const FORMS: &str = "one of: translation_m with rotation_xyzw; matrix; xyz_m with rpy_rad";

/// A pose as files are written: `{"translation_m": [x, y, z], "rotation_xyzw": [x, y, z, w]}`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PoseRecord {
    /// Position of the frame's origin, m.
    pub translation_m: [f64; 3],
    /// Unit quaternion, scalar last.
    pub rotation_xyzw: [f64; 4],
}

/// A pose as files may state it. `Pose::try_from` checks and converts it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PoseForm {
    /// `{"translation_m": [x, y, z], "rotation_xyzw": [x, y, z, w]}`.
    Quaternion(PoseRecord),
    /// `{"matrix": [[r11, r12, r13, x], [r21, r22, r23, y], [r31, r32, r33, z], [0, 0, 0, 1]]}`.
    Matrix(MatrixRecord),
    /// `{"xyz_m": [x, y, z], "rpy_rad": [roll, pitch, yaw]}`.
    Rpy(RpyRecord),
}

/// A pose as a homogeneous matrix.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MatrixRecord {
    /// The four rows; the last column is the position in m, the last row `[0, 0, 0, 1]`.
    pub matrix: [[f64; 4]; 4],
}

/// A pose as in a URDF: the frame is turned about the fixed axes x, y and z, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RpyRecord {
    /// Position of the frame's origin, m.
    pub xyz_m: [f64; 3],
    /// Roll, pitch and yaw, rad: `R = R_z(yaw) R_y(pitch) R_x(roll)`.
    pub rpy_rad: [f64; 3],
}

/// The keys of all forms.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    translation_m: Option<[f64; 3]>,
    rotation_xyzw: Option<[f64; 4]>,
    matrix: Option<[[f64; 4]; 4]>,
    xyz_m: Option<[f64; 3]>,
    rpy_rad: Option<[f64; 3]>,
}

impl Keys {
    /// The keys that are given, in words.
    fn given(&self) -> String {
        let given = [
            ("translation_m", self.translation_m.is_some()),
            ("rotation_xyzw", self.rotation_xyzw.is_some()),
            ("matrix", self.matrix.is_some()),
            ("xyz_m", self.xyz_m.is_some()),
            ("rpy_rad", self.rpy_rad.is_some()),
        ];
        let names: Vec<_> = given.iter().filter(|(_, given)| *given).map(|(name, _)| *name).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    }
}

impl<'de> Deserialize<'de> for PoseForm {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let keys = Keys::deserialize(deserializer)?;
        match keys {
            Keys {
                translation_m: Some(translation_m),
                rotation_xyzw: Some(rotation_xyzw),
                matrix: None,
                xyz_m: None,
                rpy_rad: None,
            } => Ok(Self::Quaternion(PoseRecord { translation_m, rotation_xyzw })),
            Keys { translation_m: None, rotation_xyzw: None, matrix: Some(matrix), xyz_m: None, rpy_rad: None } => {
                Ok(Self::Matrix(MatrixRecord { matrix }))
            }
            Keys {
                translation_m: None,
                rotation_xyzw: None,
                matrix: None,
                xyz_m: Some(xyz_m),
                rpy_rad: Some(rpy_rad),
            } => Ok(Self::Rpy(RpyRecord { xyz_m, rpy_rad })),
            _ => Err(D::Error::custom(format!("found a pose with the keys {}, expected {FORMS}", keys.given()))),
        }
    }
}

impl From<&Isometry3<f64>> for PoseRecord {
    fn from(pose: &Isometry3<f64>) -> Self {
        Self { translation_m: pose.translation.vector.into(), rotation_xyzw: pose.rotation.quaternion().coords.into() }
    }
}

/// The rotation of a quaternion, scalar last.
///
/// # Errors
/// If the quaternion is not finite or its length differs from 1 by more than 1e-5.
pub fn rotation_from_xyzw(xyzw: [f64; 4]) -> Result<UnitQuaternion<f64>, String> {
    let [x, y, z, w] = xyzw;
    let quaternion = Quaternion::new(w, x, y, z);
    let length = quaternion.norm();
    let deviation = (length - 1.0).abs();
    if deviation.is_nan() || deviation > UNIT_TOLERANCE {
        return Err(format!("found a quaternion of length {length}, expected unit length"));
    }
    Ok(if deviation <= NORMALISED {
        UnitQuaternion::new_unchecked(quaternion)
    } else {
        UnitQuaternion::new_normalize(quaternion)
    })
}

/// The rotation of a matrix that is one up to the rounding of its numbers.
///
/// # Errors
/// If the matrix is not finite, an entry of `R' R` differs from the unit matrix by more than 1e-5, or it is a reflection.
pub fn rotation_from_rows(rows: [[f64; 3]; 3]) -> Result<UnitQuaternion<f64>, String> {
    let matrix = Matrix3::from_fn(|row, column| rows[row][column]);
    let deviation = (matrix.transpose() * matrix - Matrix3::identity()).abs().max();
    // The maximum leaves out what is not a number.
    if !matrix.iter().all(|entry| entry.is_finite()) || deviation > RIGID_TOLERANCE {
        return Err(format!(
            "found a matrix R with R' R off the unit matrix by {deviation:.1e}, expected a rotation, within {RIGID_TOLERANCE:e}"
        ));
    }
    if matrix.determinant() < 0.0 {
        return Err("found a matrix of determinant -1, a reflection, expected a rotation".into());
    }
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    Ok(UnitQuaternion::new_normalize(rotation.into_inner()))
}

/// The rotation of roll, pitch and yaw about fixed axes, as in a URDF: `R = R_z(yaw) R_y(pitch) R_x(roll)`.
#[must_use]
pub fn rotation_from_rpy([roll_rad, pitch_rad, yaw_rad]: [f64; 3]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(roll_rad, pitch_rad, yaw_rad)
}

/// A position that is finite, as a translation.
fn translation(p_m: [f64; 3]) -> Result<Translation3<f64>, String> {
    if !p_m.iter().all(|v| v.is_finite()) {
        return Err("found a translation that is not finite, expected metres".into());
    }
    Ok(Translation3::from(Vector3::from(p_m)))
}

impl TryFrom<PoseRecord> for Isometry3<f64> {
    type Error = String;

    fn try_from(record: PoseRecord) -> Result<Self, String> {
        Ok(Self::from_parts(translation(record.translation_m)?, rotation_from_xyzw(record.rotation_xyzw)?))
    }
}

impl TryFrom<MatrixRecord> for Isometry3<f64> {
    type Error = String;

    fn try_from(MatrixRecord { matrix }: MatrixRecord) -> Result<Self, String> {
        let [a, b, c, last] = matrix;
        if last != [0.0, 0.0, 0.0, 1.0] {
            return Err(format!("found a matrix with the last row {last:?}, expected [0, 0, 0, 1]"));
        }
        let rows = [a, b, c];
        let p_m = rows.map(|[_, _, _, position_m]| position_m);
        Ok(Self::from_parts(translation(p_m)?, rotation_from_rows(rows.map(|[x, y, z, _]| [x, y, z]))?))
    }
}

impl TryFrom<RpyRecord> for Isometry3<f64> {
    type Error = String;

    fn try_from(RpyRecord { xyz_m, rpy_rad }: RpyRecord) -> Result<Self, String> {
        if !rpy_rad.iter().all(|v| v.is_finite()) {
            return Err(format!("found rpy_rad = {rpy_rad:?}, expected finite angles in rad"));
        }
        Ok(Self::from_parts(translation(xyz_m)?, rotation_from_rpy(rpy_rad)))
    }
}

impl TryFrom<PoseForm> for Isometry3<f64> {
    type Error = String;

    fn try_from(form: PoseForm) -> Result<Self, String> {
        match form {
            PoseForm::Quaternion(record) => record.try_into(),
            PoseForm::Matrix(record) => record.try_into(),
            PoseForm::Rpy(record) => record.try_into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(json: &str) -> Result<Isometry3<f64>, String> {
        let form: PoseForm = serde_json::from_str(json).map_err(|error| error.to_string())?;
        form.try_into()
    }

    fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        (a.to_homogeneous() - b.to_homogeneous()).abs().max()
    }

    fn rows(pose: &Isometry3<f64>) -> [[f64; 4]; 4] {
        let matrix = pose.to_homogeneous();
        std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)]))
    }

    /// A quarter turn about z: x goes to y. Every form by hand.
    #[test]
    fn every_form_of_one_pose() {
        let half = 0.5_f64.sqrt();
        let of_quaternion =
            read(&format!("{{\"translation_m\": [1, 2, 3], \"rotation_xyzw\": [0, 0, {half}, {half}]}}")).unwrap();
        let of_matrix = read("{\"matrix\": [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]}").unwrap();
        let of_rpy = read("{\"xyz_m\": [1, 2, 3], \"rpy_rad\": [0, 0, 1.5707963267948966]}").unwrap();
        // Rounding of cos, sin and a square root of order 1.
        assert!(apart(&of_quaternion, &of_matrix) < 1e-15);
        assert!(apart(&of_quaternion, &of_rpy) < 1e-15);
    }

    /// Roll before yaw about fixed axes: roll takes y to z, which yaw leaves; with moving axes it would go to another place.
    #[test]
    fn rpy_turns_about_fixed_axes() {
        let quarter_rad = std::f64::consts::FRAC_PI_2;
        let turned = rotation_from_rpy([quarter_rad, 0.0, quarter_rad]) * Vector3::y();
        assert!((turned - Vector3::z()).norm() < 1e-15);
    }

    #[test]
    fn malformed_poses() {
        let forms = "expected one of: translation_m with rotation_xyzw; matrix; xyz_m with rpy_rad";
        for (json, message) in [
            ("{}", format!("found a pose with the keys none, {forms}")),
            ("{\"xyz_m\": [0, 0, 0]}", format!("found a pose with the keys xyz_m, {forms}")),
            (
                "{\"xyz_m\": [0, 0, 0], \"rotation_xyzw\": [0, 0, 0, 1]}",
                format!("found a pose with the keys rotation_xyzw, xyz_m, {forms}"),
            ),
            (
                "{\"xyz_m\": [0, 0, 0], \"rpy_rad\": [0, 0, 0], \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}",
                format!("found a pose with the keys matrix, xyz_m, rpy_rad, {forms}"),
            ),
            (
                "{\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1.001,0],[0,0,0,1]]}",
                "found a matrix R with R' R off the unit matrix by 2.0e-3, expected a rotation, within 1e-5".into(),
            ),
            (
                "{\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}",
                "found a matrix of determinant -1, a reflection, expected a rotation".into(),
            ),
            (
                "{\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[1,2,3,1]]}",
                "found a matrix with the last row [1.0, 2.0, 3.0, 1.0], expected [0, 0, 0, 1]".into(),
            ),
        ] {
            let error = read(json).unwrap_err();
            assert!(error.starts_with(&message), "{error}");
        }
        let nan = [f64::NAN, 0.0, 0.0];
        assert!(rotation_from_rows([nan; 3]).is_err());
        assert!(Isometry3::try_from(RpyRecord { xyz_m: [0.0; 3], rpy_rad: nan }).is_err());
        assert!(Isometry3::try_from(RpyRecord { xyz_m: nan, rpy_rad: [0.0; 3] }).is_err());
    }

    proptest! {
        /// Any rigid pose is the same through its matrix, its quaternion and roll, pitch and yaw. Angles near a pitch of a
        /// quarter turn lose half of the digits.
        #[test]
        fn random_poses_through_every_form(
            p_m in prop::array::uniform3(-10.0..10.0_f64),
            xyzw in prop::array::uniform4(-1.0..1.0_f64).prop_filter("a length", |q| q.iter().map(|v| v * v).sum::<f64>() > 0.01),
        ) {
            let [x, y, z, w] = xyzw;
            let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            let pose = Isometry3::from_parts(Translation3::from(Vector3::from(p_m)), rotation);
            let by_matrix = Isometry3::try_from(MatrixRecord { matrix: rows(&pose) }).unwrap();
            prop_assert!(apart(&pose, &by_matrix) < 1e-14);
            prop_assert_eq!(Isometry3::try_from(PoseRecord::from(&pose)).unwrap(), pose);
            let (roll, pitch, yaw) = pose.rotation.euler_angles();
            let by_rpy = Isometry3::try_from(RpyRecord { xyz_m: p_m, rpy_rad: [roll, pitch, yaw] }).unwrap();
            prop_assert!(apart(&pose, &by_rpy) < 1e-7);
            // Six written digits are still a pose, as near as they are.
            let rounded = rows(&pose).map(|row| row.map(|v| (v * 1e6).round() / 1e6));
            let by_digits = Isometry3::try_from(MatrixRecord { matrix: rounded }).unwrap();
            prop_assert!(apart(&pose, &by_digits) < 2e-6);
        }
    }
}
