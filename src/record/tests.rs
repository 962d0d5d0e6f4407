//! A recording is written, read back, cut short and compared, byte by byte.

mod damage;
mod muscles;
mod opening;
mod peaks;

use std::{collections::BTreeMap, fs, path::Path};

use nalgebra::{Isometry3, Point3, Rotation3, UnitQuaternion, Vector3};

use rerun::{StoreId, StoreKind};

use super::{
    entity::{APPLICATION, TIMELINE, entity},
    messages::Messages,
    *,
};
use crate::{
    model::{
        board::{BoardShape, Edge},
        frames::Pose,
        grasp::EdgeGrasp,
        measures::{Event, EventKind, HandMeasures, JointMeasures, Measures},
        muscle_work::{BusyMuscle, MuscleBelly},
        operation::Operation,
        plan::{ArmHold, PlacedObject, Plan},
        plate::PlateRecord,
        scenario::Scenario,
        tool_part::{ToolMaterial, ToolPart},
        trace::{ArmSample, ArmTrace, PadSample, PersonTouch, Phase, Sample, StepCheck, Trace},
        verdict::{Check, CheckKind, Failure, Verdict, VerdictKind},
        wrench::Wrench,
        wrench_limits::{LimitShape, WrenchLimits},
    },
    robot::{Chain, InverseKinematics, Robot},
};

const STEP_S: f64 = 0.002;
const SIZE_M: [f64; 3] = [0.5, 0.4, 0.03];

/// All that a recording is made of.
struct Example {
    robot: Robot,
    scenario: Scenario,
    plan: Plan,
    trace: Trace,
    measures: Measures,
    events: Vec<Event>,
    verdict: Verdict,
    person: PersonShape,
}

impl Example {
    fn input(&self) -> RecordingInput<'_> {
        RecordingInput {
            robot: &self.robot,
            scenario: &self.scenario,
            plan: &self.plan,
            trace: &self.trace,
            measures: &self.measures,
            events: &self.events,
            verdict: &self.verdict,
            person: Some(&self.person),
            people: &[],
        }
    }
}

/// A hold of an upright board by both hands of a Baxter: the left hand turns under a cut until it pivots.
fn example() -> Example {
    let robot = Robot::load("baxter", Path::new("")).unwrap();
    let plan = plan(&robot);
    let trace = trace(&robot, &plan);
    let measures = measures(&trace);
    let verdict = verdict(&trace, &measures);
    let event = |time_s, kind, what: &str, text: &str| Event { time_s, kind, text: text.into(), what: what.into() };
    let turned = EventKind::LimitCrossed(CheckKind::SlipRotation);
    let events = vec![
        event(0.0, EventKind::Phase, "", "settle: the board's weight alone"),
        event(0.1, EventKind::Phase, "", "ramp: the load grows"),
        event(0.276, turned, "left hand", "left hand turns past 2 deg at load factor 0.88"),
    ];
    let capsule = |a: [f64; 3], b: [f64; 3], radius_m| Capsule { ends_w: [a.into(), b.into()], radius_m };
    let tip_w = plan.object.x_wo * Point3::from(plan.operation.x_ot.translation.vector);
    let person = PersonShape {
        capsules: vec![
            capsule([1.25, 0.0, 0.0], [1.25, 0.0, 0.4], 0.14),
            capsule([1.25, 0.0, 0.68], [1.25, 0.0, 0.68], 0.11),
            capsule([1.25, 0.2, 0.45], [1.1, 0.25, 0.2], 0.05),
            capsule([1.1, 0.25, 0.2], [0.85, 0.17, 0.25], 0.035),
            capsule([1.25, -0.2, 0.45], [1.25, -0.25, -0.1], 0.05),
            capsule([1.25, 0.1, 0.0], [1.25, 0.1, -0.85], 0.07),
            capsule([1.25, -0.1, 0.0], [1.25, -0.1, -0.85], 0.07),
        ],
        eyes_w: [[1.15, 0.032, 0.7].into(), [1.15, -0.032, 0.7].into()],
        line_of_sight_w: [[1.16, 0.0, 0.7].into(), tip_w],
        sector_w: sector_w(),
        tool: vec![bit(tip_w)],
        muscles: bellies(),
        points_w: vec![Point3::new(1.2, 0.0, 0.3)],
    };
    let scenario = crate::scenario::default_for_plan(&plan, &robot);
    Example { robot, scenario, plan, trace, measures, events, verdict, person }
}

/// The outline of a sector from -30 to 30 degrees about -x_W.
fn sector_w() -> Vec<Point3<f64>> {
    let person_w = Point3::new(1.25, 0.0, -0.9);
    let at_w = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        person_w - 0.9 * Vector3::new(cos, sin, 0.0)
    };
    vec![person_w, at_w(-30.0), at_w(0.0), at_w(30.0), person_w]
}

/// Two spindles of the upper arm, with muscles at 12 % and at rest.
fn bellies() -> Vec<MuscleBelly> {
    let belly = |region: &str, name: &str, activation, x_m: f64| MuscleBelly {
        region: region.into(),
        ends_w: [Point3::new(x_m, 0.2, 0.45), Point3::new(x_m, 0.2, 0.25)],
        radius_m: 0.03,
        busiest: BusyMuscle { name: name.into(), region: region.into(), activation },
    };
    vec![belly("back of the upper arm", "anconeus", 0.0, 1.3), belly("front of the upper arm", "brachialis", 0.12, 1.2)]
}

/// A bit along x_W, square and 0.1 m long, that ends with an edge of its last section at the tip.
fn bit(tip_w: Point3<f64>) -> ToolPart {
    let section = |x_m: f64| {
        [[0.0, 0.0], [0.008, 0.0], [0.008, 0.008], [0.0, 0.008]].map(|[y, z]| tip_w + Vector3::new(x_m, y, z)).to_vec()
    };
    ToolPart { material: ToolMaterial::Steel, ends_w: [section(0.1), section(0.0)] }
}

fn plan(robot: &Robot) -> Plan {
    // z_O, the worked face's normal, points at the person: along +x_W.
    let upright = Rotation3::from_basis_unchecked(&[Vector3::y(), Vector3::z(), Vector3::x()]);
    let x_wo = Pose::from_parts(Vector3::new(0.6, 0.0, 0.25).into(), UnitQuaternion::from_rotation_matrix(&upright));
    let hold = |arm: usize, edge| {
        let grasp = EdgeGrasp { edge, along_m: 0.0, depth_m: 0.035, angle_rad: 0.0, flipped: false };
        let x_og = grasp.x_og(&BoardShape::cuboid(SIZE_M));
        let chain = Chain::new(robot, arm, 0.0);
        let middle: Vec<f64> = chain.lower().iter().zip(chain.upper()).map(|(a, b)| (a + b) / 2.0).collect();
        let ik = InverseKinematics::for_chain(&chain);
        ArmHold {
            name: robot.arms[arm].name.clone(),
            joints: robot.arms[arm].joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect(),
            q_rad: ik.nearest(&(x_wo * x_og), &middle).found().unwrap(),
            x_og,
            grip_force_n: 30.0,
        }
    };
    Plan {
        format: 1,
        name: "cut-05".into(),
        robot: "baxter".into(),
        operation: Operation::cut([0.0, 0.12], -Vector3::x(), 30.0, SIZE_M[2]),
        object: PlacedObject::cuboid(SIZE_M, 0.21, x_wo),
        arms: vec![hold(0, Edge::PLUS_X), hold(1, Edge::MINUS_X)],
        human: None,
        comfort: None,
        muscles: None,
        stability: None,
        clearance: None,
        planner: None,
        scenario: None,
        benchdog: None,
    }
}

fn trace(robot: &Robot, plan: &Plan) -> Trace {
    let arm = |hold: &ArmHold| ArmTrace {
        name: hold.name.clone(),
        joints: hold.joints.clone(),
        effort_nm: vec![50.0, 100.0, 50.0, 50.0, 15.0, 15.0, 15.0],
        pads: vec!["upper".into(), "lower".into()],
        grip_force_n: hold.grip_force_n,
        wrench_limits: None,
    };
    Trace {
        arms: plan.arms.iter().map(arm).collect(),
        p_ot_m: plan.operation.x_ot.translation.vector,
        samples: (0..=250).map(|step| sample(robot, plan, step)).collect(),
        broke_down: None,
        robot_touch: Some(["left_wrist".into(), "the board".into()]),
        person_touch: Some(PersonTouch { body: "the board".into(), part: "the person's Head".into() }),
    }
}

fn sample(robot: &Robot, plan: &Plan, step: usize) -> Sample {
    let time_s = step as f64 * STEP_S;
    let (phase, load_factor) = match step {
        0..=50 => (Phase::Settle, 0.0),
        51..=150 => (Phase::Ramp, (step - 50) as f64 / 100.0),
        151..=200 => (Phase::Hold, 1.0),
        _ => (Phase::Release, 0.0),
    };
    let x_wo = plan.object.x_wo * Isometry3::translation(-0.006 * load_factor, 0.0, 0.0);
    let hand = |index: usize, hold: &ArmHold| {
        let gripper = &robot.arms[index].gripper;
        let p_oc = hold.x_og * Point3::from(gripper.grasp_point_g());
        let turn_rad = if index == 0 { 0.04 * load_factor } else { 0.002 * load_factor };
        let pad = |side: f64| PadSample {
            normal_force_n: 30.0,
            wrench_w: Wrench::from_force(x_wo.rotation * Vector3::new(15.0 * load_factor, 0.0, -30.0 * side)),
            p_wp_m: (x_wo * (p_oc + Vector3::z() * (side * SIZE_M[2] / 2.0))).coords,
        };
        ArmSample {
            q_rad: hold.q_rad.clone(),
            finger_m: vec![gripper.travel_for_gap_m(0, SIZE_M[2]); 2],
            torque_demanded_nm: (0..7).map(|joint| 2.0 + joint as f64 * load_factor).collect(),
            torque_applied_nm: (0..7).map(|joint| 2.0 + joint as f64 * load_factor).collect(),
            x_oc: Pose::from_parts(
                p_oc.into(),
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad) * hold.x_og.rotation,
            ),
            pads: vec![pad(1.0), pad(-1.0)],
            grip_wrench_g: None,
        }
    };
    Sample {
        time_s,
        phase,
        load_factor,
        tool_wrench_w: Wrench::from_force(x_wo.rotation * plan.operation.wrench_o.force_n * load_factor),
        x_wo,
        p_ot_m: plan.operation.x_ot.translation.vector,
        self_check: StepCheck::default(),
        // Every other digit of a third: nothing that a rounding would leave alone.
        robot_clearance_m: Some(0.1 / 7.0 - 0.02 * load_factor),
        person_distance_m: Some(0.1 / 3.0 - 0.04 * load_factor),
        arms: plan.arms.iter().enumerate().map(|(index, hold)| hand(index, hold)).collect(),
    }
}

/// The series as they follow from how [`sample`] moves, in closed form.
fn measures(trace: &Trace) -> Measures {
    let samples = &trace.samples[50..];
    let of = |figure: &dyn Fn(&Sample) -> f64| samples.iter().map(figure).collect::<Vec<f64>>();
    let joint = |(index, name): (usize, &String), arm: usize| JointMeasures {
        name: name.clone(),
        torque_ratio: of(&|s| s.arms[arm].torque_demanded_nm[index] / trace.arms[arm].effort_nm[index]),
    };
    Measures {
        time_s: of(&|s| s.time_s),
        judged: samples.iter().filter(|sample| sample.phase != Phase::Release).count(),
        load_factor: of(&|s| s.load_factor),
        hands: ["left", "right"]
            .into_iter()
            .zip([0.04_f64, 0.002])
            .map(|(name, turn_rad)| HandMeasures {
                name: name.into(),
                slip_mm: of(&|s| 0.3 * s.load_factor),
                slip_deg: of(&|s| turn_rad.to_degrees() * s.load_factor),
                grip_ratio: Vec::new(),
            })
            .collect(),
        sag_mm: of(&|_| 0.25),
        deflection_mm: of(&|s| 6.0 * s.load_factor),
        clearance_mm: of(&|s| 1e3 * s.robot_clearance_m.unwrap()),
        joints: (0..2)
            .flat_map(|arm| trace.arms[arm].joints.iter().enumerate().map(move |name| joint(name, arm)))
            .collect(),
    }
}

fn verdict(trace: &Trace, measures: &Measures) -> Verdict {
    let check = |name: CheckKind, value: f64, limit: f64| Check {
        name,
        value,
        limit,
        margin: limit - value,
        unit: name.unit().into(),
        passed: value <= limit,
    };
    let peak = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    Verdict {
        format: 1,
        criteria: 1,
        name: "cut-05".into(),
        verdict: VerdictKind::Pivots,
        expected: VerdictKind::Holds,
        met: false,
        checks: vec![
            check(CheckKind::Slip, 0.3, 1.0),
            check(CheckKind::SlipRotation, peak(&measures.hands[0].slip_deg), 2.0),
            check(CheckKind::Deflection, 6.0, 15.0),
            check(CheckKind::TorqueRatio, 8.0 / 15.0, 1.0),
        ],
        self_checks: Vec::new(),
        first_failure: Some(Failure { check: CheckKind::SlipRotation, time_s: 0.276, load_factor: 0.88 }),
        peak_torque_ratio: measures.joints.iter().map(|j| (j.name.clone(), peak(&j.torque_ratio))).collect(),
        confirmation: None,
        reason: None,
        notes: Vec::new(),
        muscles: None,
        versions: BTreeMap::from([("benchdog".into(), "0.1.0".into()), ("rapier3d-f64".into(), "0.36.1".into())]),
        seed: 1,
        fingerprint: format!("{:064x}", trace.samples.len()),
    }
}

/// What [`read_summary`] says of a file of these bytes.
fn read(bytes: &[u8]) -> Result<RecordedSummary, RecordError> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.rrd");
    fs::write(&path, bytes).unwrap();
    read_summary(&path)
}

#[test]
fn what_is_recorded_is_read_back() {
    let example = example();
    let summary = read(&encode(&example.input()).unwrap()).unwrap();
    assert_eq!(summary.verdict, example.verdict);
    assert_eq!(summary.end_s, 0.5);
    let phases: Vec<_> = summary.phases.iter().map(|phase| (phase.name.as_str(), phase.start_s)).collect();
    assert_eq!(phases, [("settle", 0.0), ("ramp", 0.102), ("hold", 0.302), ("release", 0.402)]);
    let events: Vec<_> = example.events.iter().map(|event| (event.time_s, event.text.clone())).collect();
    assert_eq!(summary.events, events);
    // Series are stored as they are, in double precision: equality, and no tolerance.
    assert_eq!(summary.peaks.deflection_mm, 6.0);
    assert_eq!(summary.peaks.slip_mm, BTreeMap::from([("left".into(), 0.3), ("right".into(), 0.3)]));
    assert_eq!(summary.peaks.rotation_deg["left"], 0.04_f64.to_degrees());
    assert_eq!(summary.peaks.torque_ratio, example.verdict.peak_torque_ratio);
}

#[test]
fn equal_inputs_give_equal_bytes_and_small_files() {
    let bytes = encode(&example().input()).unwrap();
    assert!(bytes == encode(&example().input()).unwrap(), "two recordings of one run differ");
    // A fifth of a run's usual length, so a fifth of the 5 MB that a recording may take.
    assert!(bytes.len() < 1_000_000, "found {} bytes", bytes.len());
}

#[test]
fn a_recording_cut_short_is_told_from_a_whole_one() {
    let bytes = encode(&example().input()).unwrap();
    for kept in [bytes.len() / 3, bytes.len() * 9 / 10, bytes.len() - 1] {
        let message = read(&bytes[..kept]).unwrap_err().to_string();
        assert!(message.ends_with("the recording was cut short"), "{message}");
    }
}

#[test]
fn other_files_are_refused_with_what_was_found() {
    let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    assert!(message(b"").ends_with("found no rerun recording, expected a file that starts with \"RRF2\""));
    assert!(message(b"PNG, say").ends_with("found no rerun recording, expected a file that starts with \"RRF2\""));
    let other = Messages::new(StoreId::new(StoreKind::Recording, "other", "run"));
    assert!(
        message(&rrd::bytes(other.into_messages()).unwrap()).ends_with("found no recording of benchdog, expected one")
    );
    let missing = read_summary(Path::new("no/such.rrd")).unwrap_err().to_string();
    assert!(missing.starts_with("failed to read no/such.rrd: "), "{missing}");
}

#[test]
fn an_arm_that_the_robot_does_not_have_is_an_error() {
    let mut example = example();
    example.trace.arms[1].name = "third".into();
    assert_eq!(
        encode(&example.input()).unwrap_err().to_string(),
        "found arm \"third\" in the trace, expected one of \"left\", \"right\""
    );
}

#[test]
fn runs_without_person_verdict_or_samples_are_recorded_too() {
    let mut example = example();
    example.verdict = Verdict {
        verdict: VerdictKind::NoVerdict,
        checks: Vec::new(),
        peak_torque_ratio: BTreeMap::new(),
        reason: Some("the trace is empty".into()),
        ..example.verdict
    };
    (example.trace.samples, example.measures, example.events) = (Vec::new(), Measures::default(), Vec::new());
    let bytes = encode(&RecordingInput { person: None, ..example.input() }).unwrap();
    assert_eq!(read(&bytes).unwrap().verdict, example.verdict);
}

#[test]
fn the_stored_run_is_read_back_bit_by_bit() {
    let example = example();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.rrd");
    fs::write(&path, encode(&example.input()).unwrap()).unwrap();
    let run = read_run(&path).unwrap();
    // Equality of numbers: stored as they are.
    assert_eq!(run.trace, example.trace);
    assert_eq!((run.plan, run.scenario, run.verdict), (example.plan, example.scenario, example.verdict));
}

#[test]
fn a_measured_gripper_is_read_back_with_its_limits_and_where_it_let_go() {
    let mut example = example();
    let trace = &mut example.trace;
    trace.arms[1].pads.clear();
    let most = Wrench::from([100.0, 100.0, 100.0, 10.0, 10.0, 10.0]);
    trace.arms[1].wrench_limits = Some(WrenchLimits::symmetric(LimitShape::Ellipsoid, most));
    for (index, sample) in trace.samples.iter_mut().enumerate() {
        sample.arms[1].pads.clear();
        let wrench_g = Wrench::from([index as f64 / 3.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        sample.arms[1].grip_wrench_g = (index < 100).then_some(wrench_g);
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.rrd");
    fs::write(&path, encode(&example.input()).unwrap()).unwrap();
    assert_eq!(read_run(&path).unwrap().trace, example.trace);
}

#[test]
fn a_run_without_a_person_is_read_back_without_one() {
    let mut example = example();
    example.trace.samples.iter_mut().for_each(|sample| sample.person_distance_m = None);
    example.trace.person_touch = None;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.rrd");
    fs::write(&path, encode(&example.input()).unwrap()).unwrap();
    assert_eq!(read_run(&path).unwrap().trace, example.trace);
}

#[test]
fn the_time_that_a_search_took_is_not_recorded() {
    let mut example = example();
    let record = |wall_ms| {
        let kind = crate::model::scenario::PlannerKind::Comfort;
        Some(crate::model::plan::PlannerRecord {
            kind,
            seed: 1,
            wall_ms,
            map_ms: wall_ms,
            evaluations: 7,
            robust: None,
        })
    };
    example.plan.planner = record(Some(1234.5));
    let one = encode(&example.input()).unwrap();
    example.plan.planner = record(Some(2345.6));
    assert!(one == encode(&example.input()).unwrap(), "two recordings of one run differ");
}

/// The times of an entity's rows, ns, and how many there are of this component.
fn times_ns(bytes: &[u8], path: &[&str], component: &str) -> Vec<i64> {
    let path = entity(path);
    let chunks = decode::chunks(bytes).unwrap();
    let rows = chunks.iter().filter(|chunk| *chunk.entity_path() == path);
    rows.filter(|chunk| chunk.components_identifiers().any(|found| found.as_str() == component))
        .filter_map(|chunk| chunk.timelines().get(&TIMELINE.into()))
        .flat_map(|column| column.times_raw().to_vec())
        .collect()
}

/// The vectors of a component of an entity, in the order of logging.
fn vectors(bytes: &[u8], path: &[&str], component: &'static str) -> Vec<[f32; 3]> {
    let chunks = decode::chunks(bytes).unwrap();
    let of_entity = chunks.iter().filter(|chunk| *chunk.entity_path() == entity(path));
    of_entity
        .flat_map(|chunk| chunk.iter_slices::<[f32; 3]>(component.into()).flatten().copied().collect::<Vec<_>>())
        .collect()
}

/// The points of the line strips of an entity.
fn line_points(bytes: &[u8], path: &[&str]) -> Vec<[f32; 3]> {
    let chunks = decode::chunks(bytes).unwrap();
    let of_entity = chunks.iter().filter(|chunk| *chunk.entity_path() == entity(path));
    let strips = of_entity.flat_map(|chunk| {
        chunk
            .iter_component::<rerun::components::LineStrip3D>("LineStrips3D:strips".into())
            .flat_map(|row| row.as_slice().to_vec())
            .collect::<Vec<_>>()
    });
    strips.flat_map(|strip| strip.0).map(|point| point.0).collect()
}

fn single(point: &Point3<f64>) -> [f32; 3] {
    point.coords.map(|v| v as f32).into()
}

#[test]
fn the_scene_shows_where_the_person_looks_and_works() {
    let example = example();
    let bytes = encode(&example.input()).unwrap();
    let person = &example.person;
    assert_eq!(
        vectors(&bytes, &["scene", "person", "eyes"], "Ellipsoids3D:centers"),
        person.eyes_w.each_ref().map(single)
    );
    let tip_w = example.plan.object.x_wo * Point3::from(example.plan.operation.x_ot.translation.vector);
    let sight = line_points(&bytes, &["scene", "person", "line_of_sight"]);
    assert_eq!(sight, [single(&person.line_of_sight_w[0]), single(&tip_w)]);
    let sector = line_points(&bytes, &["scene", "person", "sector"]);
    assert_eq!(sector, person.sector_w.iter().map(single).collect::<Vec<_>>());
}

#[test]
fn a_person_without_limits_has_no_sector() {
    let mut example = example();
    example.person.sector_w.clear();
    let bytes = encode(&example.input()).unwrap();
    assert!(line_points(&bytes, &["scene", "person", "sector"]).is_empty());
    assert_eq!(line_points(&bytes, &["scene", "person", "line_of_sight"]).len(), 2);
}

#[test]
fn the_tool_is_a_closed_surface_that_ends_at_its_tip() {
    let example = example();
    let bytes = encode(&example.input()).unwrap();
    let corners = vectors(&bytes, &["scene", "tool"], "Mesh3D:vertex_positions");
    let normals = vectors(&bytes, &["scene", "tool"], "Mesh3D:vertex_normals");
    // Two triangles for each of the six faces.
    assert_eq!((corners.len(), normals.len()), (36, 36));
    let tip_w = example.person.line_of_sight_w[1];
    assert!(corners.contains(&single(&tip_w)));
    assert!(corners.iter().all(|corner| f64::from(corner[0]) > tip_w.x - 1e-6));
    // By the divergence theorem the volume is a third of the sum of `p . n dA` over triangles with outward normals.
    let vector = |v: &[f32; 3]| Vector3::from(v.map(f64::from));
    let part_m3 = |(corners, normals): (&[[f32; 3]], &[[f32; 3]])| {
        let [a, b, c] = [0, 1, 2].map(|corner| vector(&corners[corner]) - tip_w.coords);
        let area = (b - a).cross(&(c - a)) / 2.0;
        // The normal is unit and along the area: single precision.
        assert!((area.normalize() - vector(&normals[0])).norm() < 1e-3);
        a.dot(&area) / 3.0
    };
    let volume_m3: f64 = corners.chunks(3).zip(normals.chunks(3)).map(part_m3).sum();
    assert!((volume_m3 - 0.1 * 0.008 * 0.008).abs() < 1e-9, "{volume_m3}");
}

#[test]
fn the_moment_of_failure_has_one_time_stamp_in_scene_plot_and_log() {
    let example = example();
    let bytes = encode(&example.input()).unwrap();
    let failure_s = example.verdict.first_failure.as_ref().unwrap().time_s;
    let moment = (failure_s * 1e9).round() as i64;
    assert_eq!(times_ns(&bytes, &["scene", "first crossing"], "Points3D:labels"), [moment]);
    assert_eq!(times_ns(&bytes, &["plots", "rotation", "first crossing"], "Scalars:scalars"), [moment]);
    assert!(times_ns(&bytes, &["events"], "TextLog:text").contains(&moment));
    // The pads of the hand that turned change their colour, those of the other do not.
    for pad in ["upper", "lower"] {
        assert_eq!(times_ns(&bytes, &["scene", "pads", "left", pad], "Boxes3D:colors"), [0, moment]);
        assert_eq!(times_ns(&bytes, &["scene", "pads", "right", pad], "Boxes3D:colors"), [0]);
    }
    assert_eq!(times_ns(&bytes, &["scene", "board"], "Boxes3D:colors"), [0]);
}

#[test]
fn a_plate_is_drawn_as_a_mesh_in_place_of_the_box() {
    let mut example = example();
    let outline_m = example.plan.object.shape().outline_m();
    let holes_m = vec![vec![[0.0, 0.0], [0.05, 0.0], [0.0, 0.05]]];
    example.plan.object.plate = Some(PlateRecord { outline_m, holes_m }.into());
    let bytes = encode(&example.input()).unwrap();
    assert_eq!(times_ns(&bytes, &["scene", "board"], "Mesh3D:albedo_factor"), [0]);
    assert!(times_ns(&bytes, &["scene", "board"], "Boxes3D:colors").is_empty());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.rrd");
    fs::write(&path, &bytes).unwrap();
    assert_eq!(read_run(&path).unwrap().plan, example.plan);
}

#[test]
fn a_hold_that_stands_has_no_moment_of_failure() {
    let mut example = example();
    example.verdict.first_failure = None;
    example.events.truncate(2);
    let bytes = encode(&example.input()).unwrap();
    assert!(times_ns(&bytes, &["scene", "first crossing"], "Points3D:labels").is_empty());
    assert!(times_ns(&bytes, &["plots", "rotation", "first crossing"], "Scalars:scalars").is_empty());
    assert_eq!(times_ns(&bytes, &["scene", "pads", "left", "upper"], "Boxes3D:colors"), [0]);
}

#[test]
fn recordings_of_other_versions_are_refused_with_theirs() {
    let bytes = encode(&example().input()).unwrap();
    let with_header = |header: [u8; 8]| {
        let mut bytes = bytes.clone();
        bytes[..8].copy_from_slice(&header);
        read(&bytes).unwrap_err().to_string()
    };
    let expected = |version: &str| format!("found a recording of rerun {version}, expected one of 0.36");
    assert!(with_header([b'R', b'R', b'F', b'2', 0, 40, 1, 0]).ends_with(&expected("0.40.1")));
    assert!(with_header([b'R', b'R', b'F', b'1', 0, 20, 0, 0]).ends_with(&expected("0.20.0")));

    let mut later = Messages::new(StoreId::new(StoreKind::Recording, APPLICATION, "run"));
    let about = rerun::TextDocument::new("{\"format\":2,\"benchdog\":\"9.9.9\"}");
    later.log_static(&entity(&["about"]), &about).unwrap();
    let message = read(&rrd::bytes(later.into_messages()).unwrap()).unwrap_err().to_string();
    let expected =
        "found a recording of format 2, made by benchdog 9.9.9, expected format 1, the only one that benchdog";
    assert!(message.contains(expected), "{message}");
}
