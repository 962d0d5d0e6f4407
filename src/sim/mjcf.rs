//! Export of the scene as MJCF, the file format of MuJoCo, to check a verdict in another engine.
//!
//! Bodies, joints, servo gains, grip forces, pads and board are those of the scene, from the same data. The load is
//! data too: MuJoCo does not interpret `<custom>` fields, so the user of the file applies the wrench at the board's
//! site `tool`. The file must not contain anything that only rapier needs.
//!
//! Checked by hand in MuJoCo 3: in `scenarios/plans/meets-itself.json` the tool tip deflects by 5.39 mm there and by 5.31 mm
//! here. MuJoCo's contacts are much softer, so the faces are farther behind the cores, and pads that tilt rock by that
//! much: under the quickstart's drill, which tilts them, the tip deflects by 6.2 mm there and by 3.9 mm here and in the
//! statics.
//!
//! Contents beyond the model:
//! - the key frame `planned` holds the planned state; its controls are the servos' rest angles `q + tau_ff / K`, the
//!   torque that holds the arm's own weight fed forward, and the grip forces;
//! - `tool_timestep_s`, `tool_wrench_o` (six numbers a step: N and N m about the tool point in O axes) and
//!   `tool_point_o` (three a step: m) are the load over time; the text `tool_frame` says whether its direction turns
//!   with the `board` or stays in the `world`.

use std::io;

use nalgebra::{Translation3, Vector3};
use quick_xml::Writer;

use super::{
    arm::weight_torque_nm,
    bodies::{ArmBodies, MovingBody},
    conditions::Conditions,
    error::SimError,
    gripper::FINGER_DAMPING_N_S_M,
    pad::x_gp,
    pad_shape::{GraspingHand, PadLoading, PadPart, Solid, pad_parts},
    tool_load::ToolLoad,
};
use crate::{
    check::{CheckedArm, CheckedPlan},
    model::{
        GRAVITY_W,
        frames::Pose,
        load::ForceFrame,
        plan::{ArmHold, PlacedObject, Plan},
    },
    robot::{Arm, Finger, JointKind, Robot},
};

/// The stiffest contacts that MuJoCo allows at a time step of 2 ms.
const CONTACT: [(&str, &str); 2] = [("solref", "0.004 1"), ("solimp", "0.99 0.999 0.0001")];

/// Their softness, s^2: by its documentation, MuJoCo's contacts of time constant `t`, damping ratio 1 and impedance `d`
/// penetrate by `(1 - d) / d * (d t)^2 * F / m`, with `d` and `t` of [`CONTACT`].
const SOFTNESS_S2: f64 = 0.01 * 0.99 * 0.004 * 0.004;

type Xml = Writer<Vec<u8>>;

/// An arm of the plan with its moving bodies and planned positions.
struct ExportedArm<'a> {
    arm: &'a Arm,
    hold: &'a ArmHold,
    bodies: ArmBodies,
    weight_nm: Vec<f64>,
    finger_m: [f64; 2],
    loading: PadLoading,
}

/// Writes the scene of a plan as MJCF.
///
/// # Errors
/// If the conditions or the load over time are invalid.
pub fn mjcf(checked: &CheckedPlan<'_>, conditions: &Conditions) -> Result<String, SimError> {
    let (robot, plan) = (checked.robot(), checked.plan());
    conditions.check()?;
    let tool = ToolLoad::new(plan, conditions)?;
    let arms: Vec<_> = checked
        .arms()
        .iter()
        .map(|&CheckedArm { index, hold, .. }| {
            let arm = &robot.arms[index];
            let gap_m = plan.object.size_m[2];
            let finger_m =
                [0, 1].map(|k| arm.gripper.fingers[k].joint_position_m(arm.gripper.travel_for_gap_m(k, gap_m)));
            let weight_nm = weight_torque_nm(robot, index, &hold.q_rad, gap_m);
            let bodies = ArmBodies::new(robot, arm);
            let hand = GraspingHand { arm, bodies: &bodies, x_og: hold.x_og };
            let grip_force_n = hold.grip_force_n * conditions.uncertainty.grip_force_scale;
            let loading = PadLoading::new(&hand, &plan.object, grip_force_n, SOFTNESS_S2);
            ExportedArm { arm, hold, bodies, weight_nm, finger_m, loading }
        })
        .collect();
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    // Writing to memory does not fail.
    document(&mut xml, robot, plan, conditions, &arms, &tool).map_err(|_| SimError::Engine)?;
    Ok(format!("{}\n", String::from_utf8_lossy(&xml.into_inner())))
}

fn document(
    xml: &mut Xml,
    robot: &Robot,
    plan: &Plan,
    conditions: &Conditions,
    arms: &[ExportedArm<'_>],
    tool: &ToolLoad<'_>,
) -> io::Result<()> {
    let timestep_s = conditions.settings.timestep_s.to_string();
    let root = xml.create_element("mujoco").with_attribute(("model", plan.name.as_str()));
    root.write_inner_content(|xml| {
        empty(xml, "compiler", &[("angle", "radian".into()), ("autolimits", "false".into())])?;
        let gravity = numbers(GRAVITY_W.as_slice());
        let cone = [("cone", "elliptic".into()), ("integrator", "implicitfast".into()), ("impratio", "10".into())];
        empty(xml, "option", &[vec![("timestep", timestep_s.clone()), ("gravity", gravity)], cone.to_vec()].concat())?;
        custom(xml, conditions, tool)?;
        let mut positions = Vec::new();
        xml.create_element("worldbody").write_inner_content(|xml| {
            for arm in arms {
                children(xml, robot, arm, plan.object.mass_kg, None, &mut positions)?;
            }
            board(xml, &plan.object, &plan.operation.x_ot)
        })?;
        contact_pairs(xml, arms, conditions.real_friction())?;
        xml.create_element("equality")
            .write_inner_content(|xml| arms.iter().try_for_each(|arm| coupling(xml, robot, arm)))?;
        let mut controls = Vec::new();
        xml.create_element("actuator").write_inner_content(|xml| {
            arms.iter().try_for_each(|arm| actuators(xml, robot, arm, conditions, &mut controls))
        })?;
        positions.extend(pose_numbers(&plan.object.x_wo));
        xml.create_element("keyframe").write_inner_content(|xml| {
            let key = [("name", "planned".into()), ("qpos", numbers(&positions)), ("ctrl", numbers(&controls))];
            empty(xml, "key", &key)
        })?;
        Ok(())
    })?;
    Ok(())
}

/// The load over time, as data.
fn custom(xml: &mut Xml, conditions: &Conditions, tool: &ToolLoad<'_>) -> io::Result<()> {
    let states: Vec<_> = (0..=tool.steps()).map(|step| tool.at(step).1).collect();
    let wrenches: Vec<f64> = states.iter().flat_map(|state| <[f64; 6]>::from(state.wrench_o)).collect();
    let points: Vec<f64> = states.iter().flat_map(|state| <[f64; 3]>::from(state.p_ot_m)).collect();
    let frame = match conditions.load.frame {
        ForceFrame::Board => "board",
        ForceFrame::World => "world",
    };
    xml.create_element("custom").write_inner_content(|xml| {
        let step_s = [conditions.settings.timestep_s];
        for (name, data) in [("tool_timestep_s", &step_s[..]), ("tool_wrench_o", &wrenches), ("tool_point_o", &points)]
        {
            let size = data.len().to_string();
            empty(xml, "numeric", &[("name", name.into()), ("size", size), ("data", numbers(data))])?;
        }
        empty(xml, "text", &[("name", "tool_frame".into()), ("data", frame.into())])
    })?;
    Ok(())
}

/// The children of a body, or of the world, recursively.
fn children(
    xml: &mut Xml,
    robot: &Robot,
    arm: &ExportedArm<'_>,
    board_kg: f64,
    parent: Option<usize>,
    positions: &mut Vec<f64>,
) -> io::Result<()> {
    for (index, body) in arm.bodies.bodies.iter().enumerate().filter(|(_, body)| body.parent == parent) {
        let joint = &robot.joints[body.joint];
        let name = robot.links[joint.child_link].name.as_str();
        let place = arm.bodies.body_of_joint.iter().position(|&of| of == index).unwrap_or_default();
        let element = with(xml.create_element("body").with_attribute(("name", name)), &pose_attributes(&body.x_pj));
        element.write_inner_content(|xml| {
            inertial(xml, body)?;
            let arm_joints = arm.arm.joints.len();
            positions.push(match place.checked_sub(arm_joints) {
                None => arm.hold.q_rad[place],
                Some(finger) => arm.finger_m[finger],
            });
            let kind = if joint.kind == JointKind::Prismatic { "slide" } else { "hinge" };
            let [damping, armature] = if place < arm_joints { [0.0, 0.0] } else { [FINGER_DAMPING_N_S_M, board_kg] };
            let attributes = [
                ("name", joint.name.clone()),
                ("type", kind.into()),
                ("axis", numbers(joint.axis_j.as_slice())),
                ("damping", damping.to_string()),
                ("armature", armature.to_string()),
            ];
            empty(xml, "joint", &attributes)?;
            if let Some(k) = place.checked_sub(arm_joints) {
                pads(xml, robot, arm, k, body)?;
            }
            children(xml, robot, arm, board_kg, Some(index), positions)
        })?;
    }
    Ok(())
}

fn inertial(xml: &mut Xml, body: &MovingBody) -> io::Result<()> {
    let i = &body.mass.inertia_b;
    let full = [i[(0, 0)], i[(1, 1)], i[(2, 2)], i[(0, 1)], i[(0, 2)], i[(1, 2)]];
    let attributes = [
        ("pos", numbers(body.mass.com_b.as_slice())),
        ("mass", body.mass.mass_kg.to_string()),
        ("fullinertia", numbers(&full)),
    ];
    empty(xml, "inertial", &attributes)
}

fn pad_geom_name(arm: &ExportedArm<'_>, k: usize, part: &PadPart) -> String {
    format!("{} {} {}", arm.hold.name, arm.arm.gripper.fingers[k].pad.name, part.name)
}

/// The parts of a finger's pad, in the finger's body.
fn pads(xml: &mut Xml, robot: &Robot, arm: &ExportedArm<'_>, k: usize, body: &MovingBody) -> io::Result<()> {
    let finger: &Finger = &arm.arm.gripper.fingers[k];
    let placement = arm.bodies.placements[arm.arm.gripper.frame_link];
    let axis_j: Vector3<f64> = robot.joints[finger.joint].axis_j.into_inner();
    let x_gf = placement.x_bl.inverse() * body.x_pj * Translation3::from(axis_j * finger.closed_m);
    let x_fp = x_gf.inverse() * x_gp(&finger.pad, k);
    for part in pad_parts(&finger.pad, &arm.loading) {
        geom(xml, &pad_geom_name(arm, k, &part), &part.solid, &(x_fp * part.x_pc))?;
    }
    Ok(())
}

/// A massless solid that collides only in explicit contact pairs.
fn geom(xml: &mut Xml, name: &str, solid: &Solid, x_bc: &Pose) -> io::Result<()> {
    let (kind, size) = match solid {
        Solid::Box { half_m } => ("box", numbers(half_m)),
        Solid::Ball { radius_m } => ("sphere", numbers(&[*radius_m])),
    };
    let mut attributes = vec![("name", name.to_owned()), ("type", kind.into()), ("size", size)];
    attributes.extend(pose_attributes(x_bc));
    attributes.extend([("contype", "0".into()), ("conaffinity", "0".into()), ("mass", "0".into())]);
    empty(xml, "geom", &attributes)
}

/// The board, a free body, with the tool's site.
fn board(xml: &mut Xml, object: &PlacedObject, x_ot: &Pose) -> io::Result<()> {
    let [x, y, z] = object.size_m;
    let element = with(xml.create_element("body").with_attribute(("name", "board")), &pose_attributes(&object.x_wo));
    element.write_inner_content(|xml| {
        empty(xml, "freejoint", &[("name", "board".into())])?;
        let inertia = [y * y + z * z, x * x + z * z, x * x + y * y].map(|sum| sum * object.mass_kg / 12.0);
        let attributes =
            [("pos", "0 0 0".to_owned()), ("mass", object.mass_kg.to_string()), ("diaginertia", numbers(&inertia))];
        empty(xml, "inertial", &attributes)?;
        geom(xml, "board", &Solid::Box { half_m: object.size_m.map(|side| side / 2.0) }, &Pose::identity())?;
        let mut site = vec![("name", "tool".to_owned())];
        site.extend(pose_attributes(x_ot));
        empty(xml, "site", &site)
    })?;
    Ok(())
}

/// The contact pairs of pads and board.
fn contact_pairs(xml: &mut Xml, arms: &[ExportedArm<'_>], friction: f64) -> io::Result<()> {
    // MuJoCo requires positive friction.
    let mu = friction.max(1e-5);
    xml.create_element("contact").write_inner_content(|xml| {
        for arm in arms {
            let fingers = arm.arm.gripper.fingers.iter().enumerate();
            let parts = fingers.flat_map(|(k, finger)| pad_parts(&finger.pad, &arm.loading).map(|part| (k, part)));
            for (k, part) in parts {
                let mut attributes = vec![
                    ("geom1", pad_geom_name(arm, k, &part)),
                    ("geom2", "board".to_owned()),
                    ("condim", "3".into()),
                    ("friction", numbers(&[mu, mu, 0.005, 0.0001, 0.0001])),
                ];
                attributes.extend(CONTACT.map(|(key, value)| (key, value.to_owned())));
                empty(xml, "pair", &attributes)?;
            }
        }
        Ok(())
    })?;
    Ok(())
}

/// The coupling of the second finger to the first.
fn coupling(xml: &mut Xml, robot: &Robot, arm: &ExportedArm<'_>) -> io::Result<()> {
    let [first, second] = &arm.arm.gripper.fingers;
    let slope = first.opening_sign * second.opening_sign;
    let offset_m = second.closed_m - slope * first.closed_m;
    let attributes = [
        ("joint1", robot.joints[second.joint].name.clone()),
        ("joint2", robot.joints[first.joint].name.clone()),
        ("polycoef", numbers(&[offset_m, slope, 0.0, 0.0, 0.0])),
    ];
    empty(xml, "joint", &attributes)
}

/// Servos and finger drives, and their controls in the planned state.
fn actuators(
    xml: &mut Xml,
    robot: &Robot,
    arm: &ExportedArm<'_>,
    conditions: &Conditions,
    controls: &mut Vec<f64>,
) -> io::Result<()> {
    for (k, &joint) in arm.arm.joints.iter().enumerate() {
        let stiffness = arm.arm.stiffness_nm_rad[k] * conditions.uncertainty.joint_stiffness_scale;
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
        controls.push(arm.hold.q_rad[k] + arm.weight_nm[k] / stiffness);
    }
    for finger in &arm.arm.gripper.fingers {
        let name = robot.joints[finger.joint].name.clone();
        empty(xml, "motor", &[("name", name.clone()), ("joint", name)])?;
        controls.push(-finger.opening_sign * arm.hold.grip_force_n * conditions.uncertainty.grip_force_scale);
    }
    Ok(())
}

fn empty(xml: &mut Xml, name: &str, attributes: &[(&str, String)]) -> io::Result<()> {
    with(xml.create_element(name), attributes).write_empty()?;
    Ok(())
}

fn with<'a>(
    element: quick_xml::writer::ElementWriter<'a, Vec<u8>>,
    attributes: &[(&str, String)],
) -> quick_xml::writer::ElementWriter<'a, Vec<u8>> {
    element.with_attributes(attributes.iter().map(|(key, value)| (*key, value.as_str())))
}

/// Numbers in the shortest decimals that read back exactly.
fn numbers(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

/// A pose in MuJoCo's order: position `x y z`, then the quaternion `w x y z`.
fn pose_numbers(pose: &Pose) -> [f64; 7] {
    let ([x, y, z], [i, j, k, w]): ([f64; 3], [f64; 4]) =
        (pose.translation.vector.into(), pose.rotation.quaternion().coords.into());
    [x, y, z, w, i, j, k]
}

fn pose_attributes(pose: &Pose) -> [(&'static str, String); 2] {
    let all = pose_numbers(pose);
    [("pos", numbers(&all[..3])), ("quat", numbers(&all[3..]))]
}
