//! Servos, finger drives, and the motors that apply the tool's wrench; with their controls.

use std::io;

use super::{
    super::conditions::Conditions,
    exported_arm::ExportedArm,
    xml::{Xml, empty, numbers},
};
use crate::robot::Robot;

/// The motors of the tool's wrench at the site `tool`: force, then moment, along the axes of O.
const TOOL_MOTORS: [&str; 6] = ["tool_fx", "tool_fy", "tool_fz", "tool_mx", "tool_my", "tool_mz"];

/// Writes the element `actuator`: per arm the servos, then the fingers; then the motors of the tool.
pub(super) fn actuators(
    xml: &mut Xml,
    robot: &Robot,
    arms: &[ExportedArm<'_>],
    conditions: &Conditions,
) -> io::Result<()> {
    xml.create_element("actuator").write_inner_content(|xml| {
        for arm in arms {
            servos(xml, robot, arm, conditions)?;
            for finger in &arm.arm.gripper.fingers {
                let name = robot.joints[finger.joint].name.clone();
                empty(xml, "motor", &[("name", name.clone()), ("joint", name)])?;
            }
        }
        for (axis, name) in TOOL_MOTORS.into_iter().enumerate() {
            let gear: [f64; 6] = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
            empty(xml, "motor", &[("name", name.into()), ("site", "tool".into()), ("gear", numbers(&gear))])?;
        }
        Ok(())
    })?;
    Ok(())
}

/// The controls of an arm in the planned state.
pub(super) fn controls(arm: &ExportedArm<'_>, conditions: &Conditions) -> Vec<f64> {
    let servos = (0..arm.arm.joints.len()).map(|k| {
        arm.hold.q_rad[k]
            + (arm.feed_forward.arm_nm[k] + arm.feed_forward.board_nm[k]) / stiffness_nm_rad(arm, k, conditions)
    });
    let fingers = arm.arm.gripper.fingers.iter().map(|finger| -finger.opening_sign * arm.grip_force_n);
    servos.chain(fingers).collect()
}

fn stiffness_nm_rad(arm: &ExportedArm<'_>, joint: usize, conditions: &Conditions) -> f64 {
    arm.arm.stiffness_nm_rad[joint] * conditions.uncertainty.joint_stiffness_scale
}

fn servos(xml: &mut Xml, robot: &Robot, arm: &ExportedArm<'_>, conditions: &Conditions) -> io::Result<()> {
    for (k, &joint) in arm.arm.joints.iter().enumerate() {
        let stiffness = stiffness_nm_rad(arm, k, conditions);
        let (damping, effort) = (arm.arm.damping_nm_s_rad[k], arm.arm.effort_nm[k]);
        let name = robot.joints[joint].name.clone();
        let attributes = [
            ("name", name.clone()),
            ("joint", name),
            ("gainprm", stiffness.to_string()),
            ("biastype", "affine".into()),
            ("biasprm", numbers(&[0.0, -stiffness, -damping])),
            ("forcelimited", "true".into()),
            ("forcerange", numbers(&[-effort, effort])),
        ];
        empty(xml, "general", &attributes)?;
    }
    Ok(())
}
