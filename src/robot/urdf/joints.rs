//! Joints: kinds, axes, limits, and joints that follow others.

use std::collections::BTreeMap;

use nalgebra::{Unit, Vector3};
use urdf_rs::JointType;

use super::pose::read_pose;
use crate::robot::tree::{Joint, JointKind, Mimic};

/// A joint and its effort limit.
pub(super) fn read(
    joint: &urdf_rs::Joint,
    parent_link: usize,
    child_link: usize,
    notes: &mut Vec<String>,
) -> Result<(Joint, f64), String> {
    let at = |problem: String| format!("joint {}: {problem}", joint.name);
    let x_pj = read_pose(&joint.origin).map_err(at)?;
    let kind = match joint.joint_type {
        JointType::Fixed => JointKind::Fixed,
        JointType::Revolute | JointType::Continuous => JointKind::Revolute,
        JointType::Prismatic => JointKind::Prismatic,
        ref other => {
            return Err(at(format!("found type {other:?}, expected fixed, revolute, continuous or prismatic")));
        }
    };
    let limits = if kind == JointKind::Fixed { None } else { read_limits(joint).map_err(at)? };
    let Some([lower, upper]) = limits else {
        if kind != JointKind::Fixed {
            notes.push(format!("joint {} has no range; it is held fixed at {}", joint.name, joint.limit.lower));
        }
        return Ok((Joint::fixed(&joint.name, [parent_link, child_link], x_pj), 0.0));
    };
    let axis = Vector3::from(joint.axis.xyz.0);
    let axis_j = Unit::try_new(axis, 1e-9)
        .filter(|axis| axis.iter().all(|v| v.is_finite()))
        .ok_or_else(|| at(format!("found axis {:?}, expected a direction", joint.axis.xyz.0)))?;
    let rest = 0.0_f64.clamp(lower, upper);
    let most_speed = joint.limit.velocity.max(0.0);
    let name = joint.name.clone();
    let read = Joint { name, kind, parent_link, child_link, x_pj, axis_j, lower, upper, rest, most_speed, mimic: None };
    Ok((read, joint.limit.effort))
}

/// Limits of a joint that moves: half a turn either way for a continuous joint; `None` if it has no range at 0.
fn read_limits(joint: &urdf_rs::Joint) -> Result<Option<[f64; 2]>, String> {
    if joint.joint_type == JointType::Continuous {
        return Ok(Some([-std::f64::consts::PI, std::f64::consts::PI]));
    }
    let (lower, upper) = (joint.limit.lower, joint.limit.upper);
    if lower == 0.0 && upper == 0.0 {
        return Ok(None);
    }
    if lower.is_finite() && upper.is_finite() && lower < upper {
        Ok(Some([lower, upper]))
    } else {
        Err(format!("found limits {lower} to {upper}, expected two finite numbers, the lower first"))
    }
}

/// Sets which joints follow which. Where the leader of one follows another itself, both steps become one. A joint whose leader
/// the file does not have moves by itself, with a note.
pub(super) fn resolve_mimics(
    robot: &urdf_rs::Robot,
    joints: &mut [Joint],
    notes: &mut Vec<String>,
) -> Result<(), String> {
    let of_file: BTreeMap<&str, &urdf_rs::Joint> =
        robot.joints.iter().map(|joint| (joint.name.as_str(), joint)).collect();
    let places: BTreeMap<String, usize> =
        joints.iter().enumerate().map(|(place, joint)| (joint.name.clone(), place)).collect();
    for joint in &robot.joints {
        let leader = joint.mimic.as_ref().map(|mimic| &mimic.joint);
        if let Some(leader) = leader.filter(|leader| !of_file.contains_key(leader.as_str())) {
            let name = &joint.name;
            notes.push(format!(
                "joint {name} mimics {leader}, which is no joint of the file; it is taken to move by itself"
            ));
        }
    }
    for index in 0..joints.len() {
        let (mut multiplier, mut offset, mut at) = (1.0, 0.0, index);
        // As many steps as there are joints: more would be a circle.
        for _ in 0..=joints.len() {
            let name = &joints[at].name;
            let mimic = of_file.get(name.as_str()).and_then(|joint| joint.mimic.as_ref());
            let Some(mimic) = mimic.filter(|_| joints[at].kind != JointKind::Fixed) else { break };
            let Some(&leader) = places.get(&mimic.joint) else { break };
            let [own_multiplier, own_offset] = [mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0)];
            if !(own_multiplier.is_finite() && own_offset.is_finite()) {
                return Err(format!(
                    "joint {name}: found a mimic with the multiplier {own_multiplier} and the offset {own_offset}, expected finite \
                     numbers"
                ));
            }
            offset += multiplier * own_offset;
            multiplier *= own_multiplier;
            at = leader;
        }
        let mimic = of_file.get(joints[at].name.as_str()).and_then(|joint| joint.mimic.as_ref());
        let follows = mimic.is_some_and(|mimic| places.contains_key(&mimic.joint));
        if joints[at].kind != JointKind::Fixed && follows {
            return Err(format!("joint {}: found joints that mimic each other in a circle", joints[index].name));
        }
        if at != index {
            joints[index].mimic = Some(Mimic { leader: at, multiplier, offset });
        }
    }
    Ok(())
}
