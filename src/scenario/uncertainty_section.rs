//! The section `[uncertainty]` of a scenario file.

use super::{InputError, check::Checker};
use crate::{
    model::{sweep::Quantity, uncertainty::Uncertainty},
    robot::Robot,
};

/// The deviations of a quantity that the simulation accepts: factors, or offsets in the unit of the quantity.
pub fn accepted(quantity: Quantity, thickness_m: f64) -> [f64; 2] {
    match quantity {
        Quantity::Friction => [0.0, 10.0],
        Quantity::GripForce => [0.01, 10.0],
        // Below this range pads penetrate by millimetres; above 16/9, two oscillations per substep, boards oscillate.
        Quantity::ContactStiffness => [0.001, 1.75],
        Quantity::JointStiffness | Quantity::BoardMass | Quantity::RampTime => [0.01, 100.0],
        // A board keeps a tenth of its thickness.
        Quantity::BoardThickness => [(-900.0 * thickness_m).max(-20.0), 20.0],
        Quantity::Force => [0.0, 100.0],
        Quantity::ToolTilt => [-45.0, 45.0],
        Quantity::ToolOffset => [-500.0, 500.0],
        Quantity::PersonOffset => [-2000.0, 2000.0],
        Quantity::JointOffset => [-5.0, 5.0],
    }
}

/// Checks the deviations of a simulation from its plan.
pub fn check_uncertainty(
    check: &Checker<'_>,
    uncertainty: &Uncertainty,
    robot: &Robot,
    thickness_m: f64,
) -> Result<(), InputError> {
    let of = uncertainty;
    let entries: [(&str, &[f64], Quantity); 14] = [
        ("friction_scale", &[of.friction_scale], Quantity::Friction),
        ("grip_force_scale", &[of.grip_force_scale], Quantity::GripForce),
        ("contact_stiffness_scale", &[of.contact_stiffness_scale], Quantity::ContactStiffness),
        ("joint_stiffness_scale", &[of.joint_stiffness_scale], Quantity::JointStiffness),
        ("board_mass_scale", &[of.board_mass_scale], Quantity::BoardMass),
        ("force_scale", &[of.force_scale], Quantity::Force),
        ("ramp_scale", &[of.ramp_scale], Quantity::RampTime),
        ("friction_scales", &of.friction_scales, Quantity::Friction),
        ("grip_force_scales", &of.grip_force_scales, Quantity::GripForce),
        ("tool_tilt_deg", &of.tool_tilt_deg, Quantity::ToolTilt),
        ("tool_offset_mm", &of.tool_offset_mm, Quantity::ToolOffset),
        ("person_offset_mm", &of.person_offset_mm, Quantity::PersonOffset),
        ("joint_offset_deg", &of.joint_offset_deg.concat(), Quantity::JointOffset),
        ("board_thickness_mm", &[of.board_thickness_mm], Quantity::BoardThickness),
    ];
    for (key, found, quantity) in entries {
        let [low, high] = accepted(quantity, thickness_m);
        let unit = if key.contains("scale") { "a factor" } else { "mm or degrees, as the key says" };
        found.iter().try_for_each(|&found| check.within(&format!("uncertainty.{key}"), found, low, high, unit))?;
    }
    for (key, found) in [
        ("friction_scales", of.friction_scales.len()),
        ("grip_force_scales", of.grip_force_scales.len()),
        ("joint_offset_deg", of.joint_offset_deg.len()),
    ] {
        let fits = found == 0 || found == robot.arms.len();
        let expected = format!("one for each of the robot's {} arms, or none", robot.arms.len());
        check.that(fits, &format!("uncertainty.{key}"), format!("{found} entries"), &expected)?;
    }
    let joints = of.joint_offset_deg.iter().zip(&robot.arms);
    let wrong = joints.map(|(offsets, arm)| (offsets.len(), arm.joints.len())).find(|(found, joints)| found != joints);
    wrong.map_or(Ok(()), |(found, joints)| {
        let expected = format!("one for each of the arm's {joints} joints");
        Err(check.value("uncertainty.joint_offset_deg", format!("{found} entries"), &expected))
    })
}
