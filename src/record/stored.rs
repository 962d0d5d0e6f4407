//! Stores the whole run in the recording, so that it can be judged again from the file alone: the trace as columns of
//! 64-bit numbers on the entities `trace/...`, scenario and plan as JSON.
//!
//! Columns instead of one block of bytes can also be read by rerun's dataframes.

use std::{collections::BTreeMap, sync::Arc};

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use rerun::{
    ComponentDescriptor, EntityPath, SerializedComponentColumn, TextDocument,
    external::arrow::{
        array::{Float64Array, ListArray},
        buffer::OffsetBuffer,
        datatypes::{DataType, Field},
    },
    log::Chunk,
};
use serde::{Deserialize, Serialize};

use super::{decode::json, entity::entity, error::RecordError, input::RecordingInput, messages::Messages};
use crate::model::{
    frames::Pose,
    plan::Plan,
    scenario::Scenario,
    trace::{ArmSample, ArmTrace, PadSample, PersonTouch, Phase, Sample, StepCheck, Trace},
    wrench::Wrench,
    wrench_limits::WrenchLimits,
};

/// The folder of the columns.
const TRACE: &str = "trace";

/// The archetype of the columns.
const ARCHETYPE: &str = "benchdog.Trace";

/// The column of the person's distance; its rows are empty if the plan has no person.
const PERSON_DISTANCE: &str = "person_distance_m";

/// The column of the robot's distance from itself and the board; older recordings do not have it.
const ROBOT_CLEARANCE: &str = "robot_clearance_m";

/// The column of a measured gripper's wrench; its rows are empty after it has let go.
const GRIP_WRENCH: &str = "grip_wrench_g";

/// A phase is stored as the number of its variant.
const PHASES: [Phase; 7] =
    [Phase::Grip, Phase::Settle, Phase::Ramp, Phase::Hold, Phase::Release, Phase::Move, Phase::Regrasp];

/// Data of the trace that does not depend on time.
#[derive(Serialize, Deserialize)]
struct Constants {
    arms: Vec<ArmConstants>,
    p_ot_m: [f64; 3],
    broke_down: Option<String>,
    /// The body that touched the person, and the part of the person.
    #[serde(default)]
    person_touch: Option<[String; 2]>,
    /// The first two bodies of robot and board that overlapped.
    #[serde(default)]
    robot_touch: Option<[String; 2]>,
}

#[derive(Serialize, Deserialize)]
struct ArmConstants {
    name: String,
    joints: Vec<String>,
    effort_nm: Vec<f64>,
    pads: Vec<String>,
    grip_force_n: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    wrench_limits: Option<WrenchLimits>,
}

/// Stores trace, scenario and plan. The durations of the search are left out of the plan, so equal runs give equal files.
pub(super) fn log(messages: &mut Messages, input: &RecordingInput) -> Result<(), RecordError> {
    let mut plan = input.plan.clone();
    if let Some(planner) = &mut plan.planner {
        planner.wall_ms = None;
        planner.map_ms = None;
    }
    document(messages, "scenario", input.scenario)?;
    document(messages, "plan", &plan)?;
    log_trace(messages, input.trace)
}

fn document(messages: &mut Messages, path: &str, what: &impl Serialize) -> Result<(), RecordError> {
    let json = serde_json::to_string_pretty(what).map_err(RecordError::encode)?;
    messages.log_static(&entity(&[path]), &TextDocument::new(json).with_media_type("application/json"))
}

fn log_trace(messages: &mut Messages, trace: &Trace) -> Result<(), RecordError> {
    document(messages, TRACE, &constants(trace))?;
    let samples = &trace.samples;
    let times_s: Vec<f64> = samples.iter().map(|sample| sample.time_s).collect();
    let of = |name, row: fn(&Sample) -> Vec<f64>| column(name, samples.iter().map(row));
    let board = [
        of("time_s", |sample| vec![sample.time_s]),
        of("phase", |sample| vec![f64::from(sample.phase as u8)]),
        of("load_factor", |sample| vec![sample.load_factor]),
        of("tool_wrench_w", |sample| wrench(&sample.tool_wrench_w)),
        of("x_wo", |sample| pose(&sample.x_wo)),
        of("p_ot_m", |sample| sample.p_ot_m.as_slice().to_vec()),
        of("self_check", |sample| self_check(&sample.self_check)),
        of(PERSON_DISTANCE, |sample| sample.person_distance_m.into_iter().collect()),
        of(ROBOT_CLEARANCE, |sample| sample.robot_clearance_m.into_iter().collect()),
    ];
    messages.log_columns(&entity(&[TRACE, "board"]), &times_s, board)?;
    for (arm, ArmTrace { name, pads, wrench_limits, .. }) in trace.arms.iter().enumerate() {
        let of = |name, row: fn(&ArmSample) -> Vec<f64>| column(name, samples.iter().map(|s| row(&s.arms[arm])));
        let columns = [
            of("q_rad", |arm| arm.q_rad.clone()),
            of("finger_m", |arm| arm.finger_m.clone()),
            of("torque_demanded_nm", |arm| arm.torque_demanded_nm.clone()),
            of("torque_applied_nm", |arm| arm.torque_applied_nm.clone()),
            of("x_oc", |arm| pose(&arm.x_oc)),
        ];
        let wrenches = of(GRIP_WRENCH, |arm| arm.grip_wrench_g.iter().flat_map(wrench).collect());
        let columns = columns.into_iter().chain(wrench_limits.map(|_| wrenches));
        messages.log_columns(&entity(&[TRACE, "arms", name]), &times_s, columns)?;
        for (pad, pad_name) in pads.iter().enumerate() {
            let of = |name, row: fn(&PadSample) -> Vec<f64>| {
                column(name, samples.iter().map(|sample| row(&sample.arms[arm].pads[pad])))
            };
            let columns = [
                of("normal_force_n", |pad| vec![pad.normal_force_n]),
                of("wrench_w", |pad| wrench(&pad.wrench_w)),
                of("p_wp_m", |pad| pad.p_wp_m.as_slice().to_vec()),
            ];
            messages.log_columns(&entity(&[TRACE, "arms", name, pad_name]), &times_s, columns)?;
        }
    }
    Ok(())
}

fn constants(trace: &Trace) -> Constants {
    let arm = |arm: &ArmTrace| {
        let ArmTrace { name, joints, effort_nm, pads, grip_force_n, wrench_limits } = arm.clone();
        ArmConstants { name, joints, effort_nm, pads, grip_force_n, wrench_limits }
    };
    Constants {
        arms: trace.arms.iter().map(arm).collect(),
        p_ot_m: trace.p_ot_m.into(),
        broke_down: trace.broke_down.clone(),
        person_touch: trace.person_touch.clone().map(|PersonTouch { body, part }| [body, part]),
        robot_touch: trace.robot_touch.clone(),
    }
}

fn wrench(wrench: &Wrench) -> Vec<f64> {
    wrench.to_vector().as_slice().to_vec()
}

/// The values in order of declaration.
fn self_check(check: &StepCheck) -> Vec<f64> {
    let StepCheck { penetration_m, force_residual_n, coupling_m, contact_energy_j } = *check;
    vec![penetration_m, force_residual_n, coupling_m, contact_energy_j]
}

fn self_check_of([penetration_m, force_residual_n, coupling_m, contact_energy_j]: [f64; 4]) -> StepCheck {
    StepCheck { penetration_m, force_residual_n, coupling_m, contact_energy_j }
}

/// Position, then the quaternion with the scalar last.
fn pose(pose: &Pose) -> Vec<f64> {
    pose.translation.vector.iter().chain(pose.rotation.coords.iter()).copied().collect()
}

fn descriptor(name: &'static str) -> ComponentDescriptor {
    ComponentDescriptor { archetype: Some(ARCHETYPE.into()), component: name.into(), component_type: None }
}

/// A column with a list of numbers per row.
fn column(name: &'static str, rows: impl Iterator<Item = Vec<f64>>) -> SerializedComponentColumn {
    let rows: Vec<Vec<f64>> = rows.collect();
    let offsets = OffsetBuffer::from_lengths(rows.iter().map(Vec::len));
    let numbers = Float64Array::from_iter_values(rows.into_iter().flatten());
    let item = Arc::new(Field::new("item", DataType::Float64, true));
    SerializedComponentColumn::new(ListArray::new(item, offsets, Arc::new(numbers), None), descriptor(name))
}

/// The scenario and the plan of a recording.
pub(super) fn scenario_and_plan(chunks: &[Chunk]) -> Result<(Scenario, Plan), String> {
    Ok((json(chunks, "scenario")?, json(chunks, "plan")?))
}

/// The trace of a recording, equal to the stored one bit by bit.
pub(super) fn trace(chunks: &[Chunk]) -> Result<Trace, String> {
    let constants: Constants = json(chunks, TRACE)?;
    let arms: Vec<ArmTrace> = constants.arms.into_iter().map(arm_trace).collect();
    let board = Columns::new(chunks, entity(&[TRACE, "board"]));
    let count = board.rows("time_s").len();
    let mut arm_samples = arms.iter().map(|arm| arm_series(chunks, arm, count)).collect::<Result<Vec<_>, _>>()?;
    let samples = (0..count)
        .map(|index| {
            Ok(Sample {
                time_s: board.numbers::<1>("time_s", index)?[0],
                phase: phase(board.numbers::<1>("phase", index)?[0])?,
                load_factor: board.numbers::<1>("load_factor", index)?[0],
                tool_wrench_w: wrench_of(board.numbers("tool_wrench_w", index)?),
                x_wo: pose_of(board.numbers("x_wo", index)?),
                p_ot_m: Vector3::from(board.numbers::<3>("p_ot_m", index)?),
                self_check: self_check_of(board.numbers("self_check", index)?),
                person_distance_m: board.optional(PERSON_DISTANCE, index),
                robot_clearance_m: board.optional(ROBOT_CLEARANCE, index),
                arms: arm_samples.iter_mut().filter_map(Iterator::next).collect(),
            })
        })
        .collect::<Result<Vec<_>, String>>()?;
    Ok(Trace {
        arms,
        p_ot_m: Vector3::from(constants.p_ot_m),
        samples,
        broke_down: constants.broke_down,
        person_touch: constants.person_touch.map(|[body, part]| PersonTouch { body, part }),
        robot_touch: constants.robot_touch,
    })
}

fn arm_trace(arm: ArmConstants) -> ArmTrace {
    let ArmConstants { name, joints, effort_nm, pads, grip_force_n, wrench_limits } = arm;
    ArmTrace { name, joints, effort_nm, pads, grip_force_n, wrench_limits }
}

/// The samples of one arm.
fn arm_series(chunks: &[Chunk], arm: &ArmTrace, count: usize) -> Result<std::vec::IntoIter<ArmSample>, String> {
    let columns = Columns::new(chunks, entity(&[TRACE, "arms", &arm.name]));
    let pads: Vec<_> =
        arm.pads.iter().map(|pad| Columns::new(chunks, entity(&[TRACE, "arms", &arm.name, pad]))).collect();
    let pad = |columns: &Columns, index| {
        Ok::<_, String>(PadSample {
            normal_force_n: columns.numbers::<1>("normal_force_n", index)?[0],
            wrench_w: wrench_of(columns.numbers("wrench_w", index)?),
            p_wp_m: Vector3::from(columns.numbers::<3>("p_wp_m", index)?),
        })
    };
    let sample = |index| {
        Ok::<_, String>(ArmSample {
            q_rad: columns.row("q_rad", index)?.to_vec(),
            finger_m: columns.row("finger_m", index)?.to_vec(),
            torque_demanded_nm: columns.row("torque_demanded_nm", index)?.to_vec(),
            torque_applied_nm: columns.row("torque_applied_nm", index)?.to_vec(),
            x_oc: pose_of(columns.numbers("x_oc", index)?),
            pads: pads.iter().map(|columns| pad(columns, index)).collect::<Result<_, _>>()?,
            grip_wrench_g: match (&arm.wrench_limits, columns.row(GRIP_WRENCH, index)) {
                (None, _) => None,
                (Some(_), row) => match row? {
                    [] => None,
                    _ => Some(wrench_of(columns.numbers(GRIP_WRENCH, index)?)),
                },
            },
        })
    };
    Ok((0..count).map(sample).collect::<Result<Vec<_>, _>>()?.into_iter())
}

fn phase(number: f64) -> Result<Phase, String> {
    let found = PHASES.into_iter().find(|phase| f64::from(*phase as u8) == number);
    found.ok_or_else(|| format!("found phase {number}, expected 0 to 6"))
}

fn wrench_of(numbers: [f64; 6]) -> Wrench {
    Wrench::from(numbers)
}

/// The stored pose, not normalised again, because that would change its last bits.
fn pose_of([x, y, z, i, j, k, w]: [f64; 7]) -> Pose {
    Isometry3::from_parts(Vector3::new(x, y, z).into(), UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)))
}

/// The columns of an entity.
struct Columns<'a> {
    path: EntityPath,
    columns: BTreeMap<String, Vec<&'a [f64]>>,
}

impl<'a> Columns<'a> {
    fn new(chunks: &'a [Chunk], path: EntityPath) -> Self {
        let mut columns = BTreeMap::<String, Vec<&'a [f64]>>::new();
        for chunk in chunks.iter().filter(|chunk| *chunk.entity_path() == path) {
            for component in chunk.components_identifiers() {
                let rows = columns.entry(component.as_str().to_owned()).or_default();
                rows.extend(chunk.iter_slices::<f64>(component));
            }
        }
        Self { path, columns }
    }

    fn rows(&self, name: &str) -> &[&'a [f64]] {
        self.columns.get(name).map_or(&[], Vec::as_slice)
    }

    /// The number of a row that may be empty or missing.
    fn optional(&self, name: &str, index: usize) -> Option<f64> {
        self.rows(name).get(index).and_then(|row| row.first()).copied()
    }

    fn row(&self, name: &str, index: usize) -> Result<&'a [f64], String> {
        let row = self.rows(name).get(index).copied();
        row.ok_or_else(|| format!("found no row {index} of {name} in {}, expected one per sample", self.path))
    }

    fn numbers<const N: usize>(&self, name: &str, index: usize) -> Result<[f64; N], String> {
        let row = self.row(name, index)?;
        let wrong = |_| format!("found {} numbers in row {index} of {name} in {}, expected {N}", row.len(), self.path);
        row.try_into().map_err(wrong)
    }
}
