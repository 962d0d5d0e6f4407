//! The section `[uncertainty]` of a scenario file.

use super::{InputError, check::Checker};
use crate::{model::uncertainty::Uncertainty, robot::Robot};

/// Checks the deviations of a simulation from its plan.
pub fn check_uncertainty(
    check: &Checker<'_>,
    uncertainty: &Uncertainty,
    robot: &Robot,
    thickness_m: f64,
) -> Result<(), InputError> {
    let of = uncertainty;
    let factors = [
        ("friction_scale", of.friction_scale, 0.0, 10.0),
        ("grip_force_scale", of.grip_force_scale, 0.01, 10.0),
        // Below this range pads penetrate by millimetres; above 16/9, two oscillations per substep, boards oscillate.
        ("contact_stiffness_scale", of.contact_stiffness_scale, 0.001, 1.75),
        ("joint_stiffness_scale", of.joint_stiffness_scale, 0.01, 100.0),
        ("board_mass_scale", of.board_mass_scale, 0.01, 100.0),
        ("force_scale", of.force_scale, 0.0, 100.0),
        ("ramp_scale", of.ramp_scale, 0.01, 100.0),
    ];
    let each = |key, values: &[f64], low, high| values.iter().map(|&found| (key, found, low, high)).collect::<Vec<_>>();
    let of_arms = [
        each("friction_scales", &of.friction_scales, 0.0, 10.0),
        each("grip_force_scales", &of.grip_force_scales, 0.01, 10.0),
    ];
    for (key, found, low, high) in factors.into_iter().chain(of_arms.concat()) {
        check.within(&format!("uncertainty.{key}"), found, low, high, "a factor")?;
    }
    let offsets = [
        each("tool_tilt_deg", &of.tool_tilt_deg, -45.0, 45.0),
        each("tool_offset_mm", &of.tool_offset_mm, -500.0, 500.0),
        each("person_offset_mm", &of.person_offset_mm, -2000.0, 2000.0),
        each("joint_offset_deg", &of.joint_offset_deg.concat(), -5.0, 5.0),
        // A board keeps a tenth of its thickness.
        each("board_thickness_mm", &[of.board_thickness_mm], (-900.0 * thickness_m).max(-20.0), 20.0),
    ];
    for (key, found, low, high) in offsets.concat() {
        check.within(&format!("uncertainty.{key}"), found, low, high, "mm or degrees, as the key says")?;
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
