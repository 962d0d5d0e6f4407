//! The 3-D scene: robot, board, operation, person, tool, pads and forces.

use nalgebra::{Point3, Vector3};
use rerun::{Arrows3D, Boxes3D, EntityPath, FillMode, LineStrips3D, Points3D, ViewCoordinates};

use super::{
    crossings,
    entity::entity,
    error::RecordError,
    frames::{Frames, arm_indices, frames, vec3},
    input::RecordingInput,
    messages::Messages,
    palette, person, plate,
    poses::log_poses,
    robot,
};
use crate::model::{
    frames::Pose,
    operation::{Operation, OperationKind},
    trace::Sample,
};

/// Length of a force's arrow, m/N: 30 N are 0.12 m.
pub(super) const ARROW_M_PER_N: f64 = 0.004;

/// Thickness of the plates that show pads, m; chosen for visibility.
const PAD_PLATE_M: f64 = 0.004;

/// The folder of the points of the peripersonal metric, which the layout hides.
pub(super) const POINTS: &str = "points";

/// Radius of the ring that marks a hole, and half the length of the line that marks a cut, m.
const HOLE_RADIUS_M: f64 = 0.012;
const HALF_CUT_M: f64 = 0.05;

/// Logs the scene.
pub(super) fn log(messages: &mut Messages, input: &RecordingInput) -> Result<(), RecordError> {
    messages.log_static(&entity(&["scene"]), &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    let arms = arm_indices(input)?;
    let frames = frames(input, &arms);
    robot::log(messages, input.robot, &frames)?;
    log_board(messages, input, &frames)?;
    if let Some(person) = input.person.filter(|_| input.people.is_empty()) {
        person::log(messages, person, None)?;
    }
    for (from_s, person) in input.people {
        person::log(messages, person, Some(*from_s))?;
    }
    log_points(messages, input, &frames)?;
    crossings::log_mark(messages, input, &arms)?;
    for (arm, &robot_arm) in arms.iter().enumerate() {
        log_pads(messages, input, &frames, arm, robot_arm)?;
    }
    log_grips(messages, input, &frames, &arms)?;
    log_load(messages, &frames)
}

fn log_board(messages: &mut Messages, input: &RecordingInput, frames: &Frames) -> Result<(), RecordError> {
    let path = entity(&["scene", "board"]);
    let (object, crossed_s) = (&input.plan.object, crossings::board_crossed_s(input));
    if let Some(plate) = &object.plate {
        plate::log(messages, &path, frames, (plate, object.size_m[2]), palette::board(), crossed_s)?;
    } else {
        let half = object.size_m.map(|side| side as f32 / 2.0);
        messages.log_static(&path, &Boxes3D::from_half_sizes([half]).with_fill_mode(FillMode::Solid))?;
        crossings::log_box_colour(messages, &path, frames, palette::board(), crossed_s)?;
    }
    log_poses(messages, &path, &frames.times_s, frames.samples.iter().map(|sample| sample.x_wo))?;
    let operation = &input.plan.operation;
    let point =
        Points3D::new([vec3(&operation.x_ot.translation.vector)]).with_radii([0.004]).with_colors([palette::load()]);
    messages.log_static(&entity(&["scene", "board", "operation"]), &point)?;
    let lines = marks_o(operation, input.plan.object.size_m[2]);
    let marks = LineStrips3D::new(lines.iter().map(|line| line.iter().map(|p_o| vec3(&p_o.coords))))
        .with_radii([0.0025])
        .with_colors([palette::load()]);
    messages.log_static(&entity(&["scene", "board", "operation", "mark"]), &marks)
}

/// Lines that show the operation on the board, in O, m: rings on both faces for a drill, a line along the blade for a cut,
/// nothing for a wrench.
fn marks_o(operation: &Operation, thickness_m: f64) -> Vec<Vec<Point3<f64>>> {
    let on_board = |x: f64, y: f64, z: f64| operation.x_ot * Point3::new(x, y, z);
    match operation.kind {
        OperationKind::Drill => {
            let ring = |depth_m| {
                let point = |k: u32| {
                    let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 24.0);
                    on_board(HOLE_RADIUS_M * cos, HOLE_RADIUS_M * sin, depth_m)
                };
                (0..=24).map(point).collect()
            };
            // z_T points into the board. The rings are 1 mm outside the faces, or the board would hide half of them.
            vec![ring(-0.001), ring(thickness_m + 0.001)]
        }
        OperationKind::Cut => vec![vec![on_board(-HALF_CUT_M, 0.0, -0.001), on_board(HALF_CUT_M, 0.0, -0.001)]],
        OperationKind::Wrench => Vec::new(),
    }
}

/// Logs the points of person and robot of the peripersonal metric (`docs/method.md#51-point-sets`).
fn log_points(messages: &mut Messages, input: &RecordingInput, frames: &Frames) -> Result<(), RecordError> {
    let points = |points_w: Vec<[f32; 3]>| Points3D::new(points_w).with_radii([0.01]).with_colors([palette::points()]);
    if let Some(person) = input.person {
        let body = points(person.points_w.iter().map(|point| vec3(&point.coords)).collect());
        messages.log_static(&entity(&["scene", POINTS, "person"]), &body)?;
    }
    // In the planned pose, for which the metric is computed.
    let Some(x_wl) = frames.x_wl.first() else { return Ok(()) };
    let point_w = |point: &crate::robot::BodyPoint| vec3(&(x_wl[point.link] * point.p_l).coords);
    let robot = points(input.robot.body_points.iter().map(point_w).collect());
    messages.log_static(&entity(&["scene", POINTS, "robot"]), &robot)
}

/// `drill, 15 N`.
pub(super) fn operation_label(operation: &Operation) -> String {
    let kind = format!("{:?}", operation.kind).to_lowercase();
    format!("{kind}, {:.0} N", operation.wrench_o.force_n.norm())
}

/// Logs the pads of a hand as plates, and their forces on the board.
fn log_pads(
    messages: &mut Messages,
    input: &RecordingInput,
    frames: &Frames,
    arm: usize,
    robot_arm: usize,
) -> Result<(), RecordError> {
    let names = &input.trace.arms[arm];
    let gripper = &input.robot.arms[robot_arm].gripper;
    for (pad, name) in names.pads.iter().enumerate() {
        let samples = || frames.samples.iter().map(|sample| &sample.arms[arm].pads[pad]);
        let path = entity(&["scene", "pads", &names.name, name]);
        let [x_m, z_m] = gripper.fingers[pad % gripper.fingers.len()].pad.size_m;
        let plate = Boxes3D::from_sizes([[x_m as f32, PAD_PLATE_M as f32, z_m as f32]]).with_fill_mode(FillMode::Solid);
        messages.log_static(&path, &plate)?;
        let crossed_s = crossings::pad_crossed_s(input, &names.name, name);
        crossings::log_box_colour(messages, &path, frames, palette::hand(arm), crossed_s)?;
        let poses = samples()
            .zip(&frames.x_wl)
            .map(|(sample, x_wl)| Pose::from_parts(sample.p_wp_m.into(), x_wl[gripper.frame_link].rotation));
        log_poses(messages, &path, &frames.times_s, poses)?;

        let forces = samples().map(|sample| (sample.p_wp_m, sample.wrench_w.force_n));
        let path = entity(&["scene", "forces", &names.name, name]);
        let style =
            Arrows3D::update_fields().with_colors([palette::hand(arm)]).with_radii([0.006]).with_show_labels(false);
        log_forces(messages, &path, &frames.times_s, forces, &style)?;
    }
    Ok(())
}

/// Logs the forces of measured grippers on the board at their grasp points, without length once they have let go.
fn log_grips(
    messages: &mut Messages,
    input: &RecordingInput,
    frames: &Frames,
    arms: &[usize],
) -> Result<(), RecordError> {
    for (arm, &robot_arm) in arms.iter().enumerate() {
        let constants = &input.trace.arms[arm];
        if constants.wrench_limits.is_none() {
            continue;
        }
        let gripper = &input.robot.arms[robot_arm].gripper;
        let forces = frames.samples.iter().zip(&frames.x_wl).map(|(sample, x_wl)| {
            let x_wg = x_wl[gripper.frame_link];
            let force_g_n = sample.arms[arm].grip_wrench_g.unwrap_or_default().force_n;
            ((x_wg * Point3::from(gripper.grasp_point_g())).coords, x_wg.rotation * force_g_n)
        });
        let path = entity(&["scene", "forces", &constants.name, "gripper"]);
        let style =
            Arrows3D::update_fields().with_colors([palette::hand(arm)]).with_radii([0.006]).with_show_labels(false);
        log_forces(messages, &path, &frames.times_s, forces, &style)?;
    }
    Ok(())
}

/// Logs the tool's force at the tool point of the moving board.
fn log_load(messages: &mut Messages, frames: &Frames) -> Result<(), RecordError> {
    let tool_point_w = |sample: &Sample| (sample.x_wo * Point3::from(sample.p_ot_m)).coords;
    let forces = frames.samples.iter().map(|sample| (tool_point_w(sample), sample.tool_wrench_w.force_n));
    let style = Arrows3D::update_fields().with_colors([palette::load()]).with_radii([0.009]).with_show_labels(true);
    log_forces(messages, &entity(&["scene", "forces", "tool"]), &frames.times_s, forces, &style)
}

/// Logs forces as arrows, labelled in newtons. An arrow ends at the point of application, outside the board.
fn log_forces(
    messages: &mut Messages,
    path: &EntityPath,
    times_s: &[f64],
    forces: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>,
    style: &Arrows3D,
) -> Result<(), RecordError> {
    let (mut origins, mut vectors, mut labels) = (Vec::new(), Vec::new(), Vec::new());
    for (point_w, force_n) in forces {
        let arrow = force_n * ARROW_M_PER_N;
        origins.push(vec3(&(point_w - arrow)));
        vectors.push(vec3(&arrow));
        labels.push(format!("{:.1} N", force_n.norm()));
    }
    messages.log_static(path, style)?;
    let arrows = Arrows3D::from_vectors(vectors).with_origins(origins).with_labels(labels);
    messages.log_columns(path, times_s, arrows.columns_of_unit_batches().map_err(RecordError::encode)?)
}
