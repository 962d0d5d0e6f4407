//! The bodies: arms, fingers with their pads, and the board.

use std::io;

use nalgebra::{Isometry3, Translation3, Vector3};

use super::{
    super::{
        board::TouchedBox, bodies::MovingBody, gripper::FINGER_DAMPING_N_S_M, pad::x_gp, pad_shape::Solid,
        pad_springs::PadSpring,
    },
    exported_arm::ExportedArm,
    scenery::{self, DrawnRobot},
    xml::{Xml, empty, geom, mesh_geom, numbers, pose_attributes, site, with},
};
use crate::{
    model::{board_mesh::BoardMesh, plan::PlacedObject},
    robot::{Joint, JointKind, Robot},
};

/// The group of geoms that touch.
const TOUCHING_GROUP: u8 = 0;
const PAD_RGBA: [f64; 4] = [0.15, 0.15, 0.15, 1.0];
const BOARD_RGBA: [f64; 4] = [0.82, 0.65, 0.42, 1.0];

/// The children of a body, or of the world, recursively, with the inertia of a finger's drive, kg, and the time step, s. The planned joint positions are appended to `positions`, in the
/// order of MuJoCo's coordinates.
pub(super) fn children(
    xml: &mut Xml,
    drawn: &DrawnRobot<'_>,
    arm: &ExportedArm<'_>,
    [drive_kg, timestep_s]: [f64; 2],
    parent: Option<usize>,
    positions: &mut Vec<f64>,
) -> io::Result<()> {
    let robot = drawn.robot;
    let (hand_body, x_bc) = arm.hand();
    if hand_body == parent {
        site(xml, &format!("{} hand", arm.hold.name), &x_bc)?;
    }
    for (index, body) in arm.bodies.bodies.iter().enumerate().filter(|(_, body)| body.parent == parent) {
        let name = robot.links[body.link].name.as_str();
        let place = arm.bodies.body_of_joint.iter().position(|&of| of == index);
        let finger = place.and_then(|place| place.checked_sub(arm.arm.joints.len()));
        let element = with(xml.create_element("body").with_attribute(("name", name)), &pose_attributes(&body.x_pj));
        element.write_inner_content(|xml| {
            inertial(xml, body)?;
            if let (Some(joint), Some(place)) = (body.joint, place) {
                positions.push(finger.map_or_else(|| arm.hold.q_rad[place], |finger| arm.finger_m[finger]));
                let [damping, armature] = finger.map_or([0.0; 2], |_| [FINGER_DAMPING_N_S_M, drive_kg]);
                moving_joint(xml, &robot.joints[joint], damping, armature)?;
            }
            if let Some(springs) = arm.pad_springs.as_ref().filter(|_| arm.bodies.hand == Some(index)) {
                pad_springs(xml, &arm.hold.name, springs, timestep_s)?;
                positions.extend([0.0; 6]);
            }
            scenery::moving(xml, drawn, arm, index)?;
            if let Some(k) = finger {
                pads(xml, robot, arm, k, body)?;
            }
            children(xml, drawn, arm, [drive_kg, timestep_s], Some(index), positions)
        })?;
    }
    Ok(())
}

/// The joint of an arm or a finger.
fn moving_joint(xml: &mut Xml, joint: &Joint, damping: f64, armature: f64) -> io::Result<()> {
    let kind = if joint.kind == JointKind::Prismatic { "slide" } else { "hinge" };
    let attributes = [
        ("name", joint.name.clone()),
        ("type", kind.into()),
        ("axis", numbers(joint.axis_j.as_slice())),
        ("damping", damping.to_string()),
        ("armature", armature.to_string()),
    ];
    empty(xml, "joint", &attributes)
}

/// The joints of a hand on its elastic pads, three slides and three hinges. MuJoCo integrates springs explicitly, so
/// each has an inertia with which it oscillates once in 4 pi time steps; no state of rest depends on it.
fn pad_springs(xml: &mut Xml, hand: &str, springs: &[PadSpring; 6], timestep_s: f64) -> io::Result<()> {
    for (number, spring) in springs.iter().enumerate() {
        let axis: [f64; 3] = std::array::from_fn(|k| f64::from(u8::from(k == number % 3)));
        let armature = spring.stiffness * (2.0 * timestep_s).powi(2);
        let damping = spring.damping + 2.0 * (spring.stiffness * armature).sqrt();
        let attributes = [
            ("name", format!("{hand} pads {}", number + 1)),
            ("type", if number < 3 { "slide" } else { "hinge" }.into()),
            ("axis", numbers(&axis)),
            ("stiffness", spring.stiffness.to_string()),
            ("springref", spring.rest.to_string()),
            ("damping", damping.to_string()),
            ("armature", armature.to_string()),
        ];
        empty(xml, "joint", &attributes)?;
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

/// The parts of a finger's pad, in the finger's body.
fn pads(xml: &mut Xml, robot: &Robot, arm: &ExportedArm<'_>, k: usize, body: &MovingBody) -> io::Result<()> {
    let finger = &arm.arm.gripper.fingers[k];
    let placement = arm.bodies.placements[arm.arm.gripper.frame_link];
    let axis_j: Vector3<f64> = robot.joints[finger.joint].axis_j.into_inner();
    let x_gf = placement.x_bl.inverse() * body.x_pj * Translation3::from(axis_j * finger.closed_m);
    let x_fp = x_gf.inverse() * x_gp(&finger.pad, k);
    for part in arm.parts(k) {
        let (name, x_fc) = (arm.part_name(k, &part), x_fp * part.x_pc);
        let look = (TOUCHING_GROUP, PAD_RGBA);
        match part.solid {
            Solid::Box { half_m } => geom(xml, &name, ("box", &half_m), &x_fc, look)?,
            Solid::Ball { radius_m } => geom(xml, &name, ("sphere", &[radius_m]), &x_fc, look)?,
        }
    }
    Ok(())
}

/// The name of the board: its body, its geom and the mesh of a plate.
const BOARD: &str = "board";
/// The group of geoms that viewers hide at first.
const HIDDEN_GROUP: u8 = 3;

/// The mesh of a plate, among the assets.
pub(super) fn plate_mesh(xml: &mut Xml, object: &PlacedObject) -> io::Result<()> {
    let Some(plate) = &object.plate else { return Ok(()) };
    let mesh = BoardMesh::new(plate, object.size_m[2]);
    let corners: Vec<f64> = mesh
        .triangles_o
        .iter()
        .flatten()
        .flat_map(|corner| corner.coords.into_iter().copied().collect::<Vec<_>>())
        .collect();
    let faces: Vec<String> = (0..3 * mesh.triangles_o.len()).map(|corner| corner.to_string()).collect();
    let attributes = [("name", BOARD.to_owned()), ("vertex", numbers(&corners)), ("face", faces.join(" "))];
    xml.create_element("asset").write_inner_content(|xml| empty(xml, "mesh", &attributes))?;
    Ok(())
}

/// Mass, centre of mass and inertia of the board.
fn board_inertial(xml: &mut Xml, object: &PlacedObject) -> io::Result<()> {
    let mass = ("mass", object.mass_kg.to_string());
    if object.is_uniform_box() {
        let [x, y, z] = object.size_m;
        let inertia = [y * y + z * z, x * x + z * z, x * x + y * y].map(|sum| sum * object.mass_kg / 12.0);
        return empty(xml, "inertial", &[("pos", "0 0 0".to_owned()), mass, ("diaginertia", numbers(&inertia))]);
    }
    let inertia = object.shape().inertia_o(object.mass_kg);
    let of = |row: usize, column: usize| inertia[(row, column)];
    let full = [of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(0, 2), of(1, 2)];
    empty(xml, "inertial", &[("pos", numbers(object.com_o().as_slice())), mass, ("fullinertia", numbers(&full))])
}

/// The board, a free body, with the site of the tool: at the tool point, with the axes of O.
pub(super) fn board(
    xml: &mut Xml,
    object: &PlacedObject,
    arms: &[ExportedArm<'_>],
    p_ot_m: &Vector3<f64>,
) -> io::Result<()> {
    let element = with(xml.create_element("body").with_attribute(("name", BOARD)), &pose_attributes(&object.x_wo));
    element.write_inner_content(|xml| {
        empty(xml, "freejoint", &[("name", BOARD.into())])?;
        board_inertial(xml, object)?;
        if object.plate.is_some() {
            // The picture of the plate, and what each hand touches of it.
            mesh_geom(xml, BOARD, &Isometry3::identity(), (TOUCHING_GROUP, BOARD_RGBA))?;
            for arm in arms {
                let TouchedBox { x_ob, half_m } = &arm.touched;
                geom(xml, &arm.touched_name(), ("box", half_m), x_ob, (HIDDEN_GROUP, BOARD_RGBA))?;
            }
        } else {
            let half_m = object.size_m.map(|side| side / 2.0);
            geom(xml, BOARD, ("box", &half_m), &Isometry3::identity(), (TOUCHING_GROUP, BOARD_RGBA))?;
        }
        site(xml, "tool", &Isometry3::from(*p_ot_m))
    })?;
    Ok(())
}
