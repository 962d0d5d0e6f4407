//! Pictures of a plan that is drawn as planned, and of one whose left hand slips.

use std::path::Path;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::*;
use crate::{
    human::default_tool,
    model::{
        frames::Pose,
        measures::HandMeasures,
        plan::Plan,
        scenario::Person,
        trace::{ArmSample, ArmTrace, PadSample, Phase, StepCheck},
        verdict::{CheckKind, VerdictKind},
        wrench::Wrench,
    },
    robot::Robot,
};

/// A plan with a person, and the verdict on it.
struct Example {
    plan: Plan,
    robot: Robot,
    trace: Trace,
    measures: Measures,
    events: Vec<Event>,
    verdict: Verdict,
}

/// How far the left hand has moved on the board at the second sample, along x_O, m, and turned about z_O, rad.
const MOVED_M: f64 = 5e-4;
const TURNED_RAD: f64 = 0.01;

impl Example {
    fn holding(&self) -> Holding<'_> {
        let tool = default_tool(self.plan.operation.kind);
        Holding { plan: &self.plan, robot: &self.robot, person: Person::default(), tool }
    }

    fn failed(&self) -> HoldPictures {
        let Self { trace, measures, events, .. } = self;
        HoldPictures::new(&self.holding(), Some(SimulatedHold { trace, measures, events }), &self.verdict).unwrap()
    }
}

fn example() -> Example {
    let plan: Plan = serde_json::from_str(include_str!("../../../scenarios/plans/cut-rim.json")).unwrap();
    let robot = Robot::load("baxter", Path::new("")).unwrap();
    let samples = vec![sample(&plan, 0.0, Isometry3::identity()), {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), TURNED_RAD);
        sample(&plan, 0.5, Isometry3::from_parts(Vector3::new(MOVED_M, 0.0, 0.0).into(), turn))
    }];
    let arm = |hold: &crate::model::plan::ArmHold| ArmTrace {
        name: hold.name.clone(),
        joints: hold.joints.clone(),
        effort_nm: vec![50.0; hold.joints.len()],
        pads: vec!["upper".into(), "lower".into()],
        grip_force_n: 30.0,
        wrench_limits: None,
    };
    let trace = Trace {
        arms: plan.arms.iter().map(arm).collect(),
        p_ot_m: plan.operation.x_ot.translation.vector,
        samples,
        broke_down: None,
        person_touch: None,
        robot_touch: None,
    };
    let hand = |name: &str, slip_mm| HandMeasures { name: name.into(), slip_mm, ..HandMeasures::default() };
    let measures = Measures {
        time_s: vec![0.0, 0.5],
        judged: 2,
        load_factor: vec![0.0, 0.75],
        hands: vec![hand(&plan.arms[0].name, vec![0.0, 0.52]), hand(&plan.arms[1].name, vec![0.0, 0.1])],
        ..Measures::default()
    };
    let name = CheckKind::Slip;
    let slip = Check { name, value: 20.0, limit: 0.5, margin: -19.5, unit: "mm".into(), passed: false };
    let what = format!("{} hand", plan.arms[0].name);
    let event = Event { time_s: 0.5, kind: EventKind::LimitCrossed(name), text: String::new(), what };
    let verdict = Verdict {
        format: 1,
        criteria: 1,
        name: "cut-rim".into(),
        verdict: VerdictKind::Slips,
        expected: VerdictKind::Holds,
        met: false,
        checks: vec![slip],
        self_checks: Vec::new(),
        first_failure: Some(Failure { check: name, time_s: 0.5, load_factor: 0.75 }),
        peak_torque_ratio: std::collections::BTreeMap::new(),
        confirmation: None,
        reason: None,
        notes: Vec::new(),
        muscles: None,
        versions: std::collections::BTreeMap::new(),
        seed: 1,
        fingerprint: String::new(),
    };
    Example { plan, robot, trace, measures, events: vec![event], verdict }
}

/// A sample at which the first hand has moved on the board by `moved_o`. Each pad presses with 30 N.
fn sample(plan: &Plan, time_s: f64, moved_o: Pose) -> Sample {
    let x_wo = plan.object.x_wo;
    let arms = plan.arms.iter().enumerate().map(|(number, hold)| {
        // The hand turns about itself.
        let turned_o = moved_o.rotation * hold.x_og.rotation;
        let moved = Isometry3::from_parts((hold.x_og.translation.vector + moved_o.translation.vector).into(), turned_o);
        let x_oc = if number == 0 { moved } else { hold.x_og };
        let pad = |side: f64| {
            let outward_w = x_wo.rotation * x_oc.rotation * Vector3::y() * side;
            let face_o = x_oc * Point3::new(0.0, side * plan.object.size_m[2] / 2.0, 0.0);
            let force_n = -30.0 * outward_w;
            let wrench_w = Wrench { force_n, moment_nm: Vector3::zeros() };
            PadSample { normal_force_n: 30.0, wrench_w, p_wp_m: (x_wo * face_o).coords }
        };
        ArmSample {
            q_rad: hold.q_rad.clone(),
            finger_m: vec![0.01; 2],
            torque_demanded_nm: vec![0.0; hold.q_rad.len()],
            torque_applied_nm: vec![0.0; hold.q_rad.len()],
            x_oc,
            pads: vec![pad(1.0), pad(-1.0)],
            grip_wrench_g: None,
        }
    });
    Sample {
        time_s,
        phase: Phase::Ramp,
        load_factor: 0.75,
        tool_wrench_w: Wrench { force_n: Vector3::new(0.0, 0.0, -20.0), moment_nm: Vector3::zeros() },
        x_wo,
        p_ot_m: plan.operation.x_ot.translation.vector,
        arms: arms.collect(),
        self_check: StepCheck::default(),
        person_distance_m: None,
        robot_clearance_m: None,
    }
}

/// The number of elements of a class in a drawing.
fn count(svg: &str, class: &str) -> usize {
    let drawing = roxmltree::Document::parse(svg).unwrap();
    let is_one = |node: &roxmltree::Node<'_, '_>| {
        node.attribute("class").is_some_and(|classes| classes.split(' ').any(|one| one == class))
    };
    drawing.descendants().filter(is_one).count()
}

#[test]
fn a_plan_is_drawn_from_two_sides_with_robot_board_person_and_force() {
    let example = example();
    let holds = Verdict { verdict: VerdictKind::Holds, first_failure: None, ..example.verdict.clone() };
    let pictures = HoldPictures::new(&example.holding(), None, &holds).unwrap();
    assert!(pictures.near.is_none());
    assert!(pictures.caption.starts_with("As planned"), "{}", pictures.caption);
    for (view, name) in pictures.views.iter().zip(["from the robot&apos;s right", "from above"]) {
        assert!(view.contains(&name.replace("&apos;", "'")), "{view}");
        for class in ["board", "hand0", "hand1", "arm0", "still", "person", "sight", "force"] {
            assert!(count(view, class) > 0, "{name}: {class}");
        }
        assert_eq!(count(view, "ghost"), 0, "{name}");
    }
}

#[test]
fn a_failure_is_drawn_at_its_moment_with_the_plan_dashed_and_its_values() {
    let pictures = example().failed();
    let caption = "slips at 0.50 s: slip 0.52 mm, limit 0.5 mm. Arrow: the tool's force, 20 N; dashed outlines: as planned; dashed line: \
                   line of sight.";
    assert_eq!(pictures.caption, caption);
    assert!(pictures.views.iter().all(|view| count(view, "ghost") > 1));
    let (near, caption) = pictures.near.clone().unwrap();
    // 0.5 mm and 0.01 rad = 0.57 deg; 10 times that is less than 8 mm, 20 times is more.
    let expected = "has slipped 0.50 mm and turned 0.57 deg, drawn 10 times as large. Arrows: its forces on the board, 30.0 N \
                    and 30.0 N.";
    assert!(caption.starts_with("The left hand under 0.75 of the load") && caption.ends_with(expected), "{caption}");
    for view in &near {
        // Two pads where they are and where they were, and two forces.
        assert_eq!(["pad", "ghost", "force", "force-size"].map(|class| count(view, class)), [2; 4], "{view}");
    }
    let page = pictures.markup().into_string();
    assert!(page.contains("<strong>slips at 0.50 s: slip 0.52 mm, limit 0.5 mm. "), "{page}");
}

#[test]
fn a_value_has_the_digits_that_tell_it_from_its_limit() {
    for (value, limit, is_ratio, text) in [
        (5.0321, 5.0, false, "5.03"),
        (5.0004, 5.0, false, "5.0004"),
        (15.6, 15.0, false, "15.6"),
        (-0.0012, 0.0, false, "-0.001"),
        (-1e-7, 0.0, false, "0.00"),
        (1.0312, 1.0, true, "1.03"),
        (0.496, 0.5, false, "0.496"),
    ] {
        assert_eq!(beside(value, limit, is_ratio), text);
    }
}

/// Where robot and board meet no hand is to be seen.
#[test]
fn bodies_that_meet_are_named_and_no_hand_is_drawn() {
    let mut example = example();
    let name = CheckKind::Clearance;
    example.measures.clearance_mm = vec![4.0, -0.0012];
    example.verdict.checks[0] = Check { name, value: -3.0, limit: 0.0, margin: -3.0, unit: "mm".into(), passed: false };
    example.verdict.first_failure = Some(Failure { check: name, time_s: 0.5, load_factor: 0.75 });
    example.events[0].kind = EventKind::LimitCrossed(name);
    example.events[0].what = "left_lower_forearm and the board".into();
    let pictures = example.failed();
    assert!(pictures.near.is_none());
    let expected = " at 0.50 s: clearance -0.001 mm (left_lower_forearm and the board), at least 0 mm. ";
    assert!(pictures.caption.contains(expected), "{}", pictures.caption);
}

#[test]
fn the_hand_is_that_of_the_event_or_else_the_one_that_moved_most() {
    let mut example = example();
    let near = |example: &Example| example.failed().near.unwrap().1;
    for what in ["right hand", "right upper pad", "right_w1"] {
        example.events[0].what = what.into();
        assert!(near(&example).starts_with("The right hand"), "{what}");
    }
    example.events[0].what.clear();
    assert!(near(&example).starts_with("The left hand"));
    // A hand that has not moved is drawn as it is.
    example.events[0].what = "right hand".into();
    let text = near(&example);
    assert!(text.contains("slipped 0.00 mm and turned 0.00 deg. Arrows"), "{text}");
}

#[test]
fn a_pad_is_drawn_ten_times_as_far_from_where_it_was() {
    let example = example();
    let samples = [&example.trace.samples[0], &example.trace.samples[1]];
    let close_up = CloseUp::new(&example.plan.object, &example.robot, &example.trace, 0, samples).unwrap();
    assert_eq!(close_up.factor, 10.0);
    assert!((close_up.slip_mm - 1e3 * MOVED_M).abs() < 1e-9, "{}", close_up.slip_mm);
    assert!((close_up.slip_deg() - TURNED_RAD.to_degrees()).abs() < 1e-9);
}
