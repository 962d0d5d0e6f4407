//! The check of a plan: each fault is one typed flaw with its key, and all faults are found at once.

use benchdog::{
    check::{CheckedPlan, Flaw},
    human::{Human, default_tool},
    model::{
        operation::OperationKind,
        plan::Plan,
        plate::PlateRecord,
        polygon::{Point, circle},
        scenario::Person,
    },
    robot::Robot,
    scenario::read_plan,
};
use nalgebra::{UnitQuaternion, Vector3};

use crate::common::{checked, root};

fn load() -> (Plan, Robot) {
    read_plan(&root().join("scenarios/plans/cut-rim.json"), None).unwrap()
}

/// The flaws of the plan after a change.
fn flaws(change: impl Fn(&mut Plan)) -> Vec<Flaw> {
    let (mut plan, robot) = load();
    change(&mut plan);
    match CheckedPlan::new(&robot, &plan, &Person::default(), &default_tool(plan.operation.kind)) {
        Ok(_) => Vec::new(),
        Err(flaws) => flaws.iter().cloned().collect(),
    }
}

#[test]
fn a_good_plan_has_no_flaw() {
    assert_eq!(flaws(|_| ()), []);
    let (plan, robot) = load();
    let checked = checked(&robot, &plan);
    assert_eq!(checked.arms().len(), 2);
    assert_eq!(checked.first_contact(0.0), None);
}

/// The plan's board as a plate with these holes.
fn pierced(plan: &mut Plan, holes_m: Vec<Vec<Point>>) {
    let outline_m = plan.object.shape().outline_m();
    plan.object.plate = Some(PlateRecord { outline_m, holes_m }.into());
}

#[test]
fn each_fault_of_a_plate_is_one_flaw_with_its_key() {
    /// A key, a change of a plan whose board is a plate, and the flaw that it makes.
    type Case = (&'static str, fn(&mut Plan), fn(&Flaw) -> bool);
    let cases: [Case; 7] = [
        (
            "object.plate.outline_m",
            |plan| plan.object.plate = Some(PlateRecord { outline_m: Vec::new(), holes_m: Vec::new() }.into()),
            |flaw| matches!(flaw, Flaw::Plate(_)),
        ),
        (
            "object.plate.holes_m[0]",
            |plan| pierced(plan, vec![vec![[0.0, 0.0], [0.0, 0.3], [-0.1, 0.0]]]),
            |flaw| matches!(flaw, Flaw::Plate(_)),
        ),
        ("object.size_m", |plan| plan.object.size_m[0] += 1e-3, |flaw| matches!(flaw, Flaw::PlateSize { .. })),
        (
            "object.com_m",
            |plan| plan.object.com_m = Some([0.0, 0.0, f64::NAN]),
            |flaw| matches!(flaw, Flaw::CentreOfMass { .. }),
        ),
        (
            "operation.x_ot",
            |plan| plan.operation.x_ot.translation.vector.x = 0.3,
            |flaw| matches!(flaw, Flaw::ToolOffPlate { .. }),
        ),
        (
            "operation.x_ot",
            |plan| pierced(plan, vec![circle([0.12, 0.0], 0.02, 12)]),
            |flaw| matches!(flaw, Flaw::ToolOffPlate { .. }),
        ),
        (
            "arms[1].x_og",
            |plan| {
                let at = plan.arms[1].x_og.translation.vector;
                pierced(plan, vec![circle([at.x, at.y], 0.006, 12)]);
            },
            |flaw| matches!(flaw, Flaw::PadOffPlate { arm: 1, .. }),
        ),
    ];
    assert_eq!(flaws(|plan| pierced(plan, Vec::new())), []);
    for (key, change, expected) in cases {
        let found = flaws(|plan| {
            pierced(plan, Vec::new());
            change(plan);
        });
        assert!(found.len() == 1 && expected(&found[0]) && found[0].key() == key, "{key}: {found:?}");
        assert!(!found[0].found().is_empty() && !found[0].expected().is_empty());
    }
}

#[test]
fn each_fault_is_one_flaw_with_its_key() {
    /// A key, a change of the plan, and the flaw that it makes.
    type Case = (&'static str, fn(&mut Plan), fn(&Flaw) -> bool);
    let cases: [Case; 24] = [
        ("object.size_m[0]", |plan| plan.object.size_m[0] = 6.0, |flaw| matches!(flaw, Flaw::BoardSide { .. })),
        ("object.mass_kg", |plan| plan.object.mass_kg = 0.0, |flaw| matches!(flaw, Flaw::BoardMass { .. })),
        (
            "operation.wrench_o",
            |plan| plan.operation.wrench_o.force_n.x = f64::INFINITY,
            |flaw| matches!(flaw, Flaw::Wrench { .. }),
        ),
        (
            "operation.x_ot",
            |plan| plan.operation.x_ot.translation.vector.x = 0.3,
            |flaw| matches!(flaw, Flaw::ToolPoint { .. }),
        ),
        (
            "operation.x_ot",
            |plan| plan.operation.x_ot.translation.vector.z = f64::NAN,
            |flaw| matches!(flaw, Flaw::ToolPoint { .. }),
        ),
        ("object.mass_kg", |plan| plan.object.mass_kg = 1e300, |flaw| matches!(flaw, Flaw::BoardMass { .. })),
        (
            "operation.wrench_o",
            |plan| plan.operation.wrench_o.force_n *= 1e300,
            |flaw| matches!(flaw, Flaw::Wrench { .. }),
        ),
        // 1 mm is the tolerance of given plans.
        (
            "operation.x_ot",
            |plan| plan.operation.x_ot.translation.vector.z -= 2e-3,
            |flaw| matches!(flaw, Flaw::TipInside { .. }),
        ),
        (
            "human.x_wb",
            |plan| plan.human.as_mut().unwrap().x_wb.translation.vector.y = -11.0,
            |flaw| matches!(flaw, Flaw::PersonPose { .. }),
        ),
        ("arms", |plan| plan.arms.clear(), |flaw| matches!(flaw, Flaw::NoArm)),
        ("arms[0].name", |plan| plan.arms[0].name = "middle".into(), |flaw| matches!(flaw, Flaw::UnknownArm { .. })),
        ("arms[1].name", |plan| plan.arms[1] = plan.arms[0].clone(), |flaw| matches!(flaw, Flaw::ArmTwice { .. })),
        ("arms[0].joints", |plan| plan.arms[0].joints.swap(0, 1), |flaw| matches!(flaw, Flaw::Joints { .. })),
        (
            "arms[0].q_rad",
            |plan| plan.arms[0].q_rad.truncate(6),
            |flaw| matches!(flaw, Flaw::AngleCount { found: 6, expected: 7, .. }),
        ),
        ("arms[0].q_rad[2]", |plan| plan.arms[0].q_rad[2] = f64::NAN, |flaw| matches!(flaw, Flaw::Angle { .. })),
        ("arms[0].q_rad[1]", |plan| plan.arms[0].q_rad[1] = 1.1, |flaw| matches!(flaw, Flaw::Angle { .. })),
        (
            "arms[0].grip_force_n",
            |plan| plan.arms[0].grip_force_n = 36.0,
            |flaw| matches!(flaw, Flaw::GripForce { .. }),
        ),
        (
            "arms[0].grip_force_n",
            |plan| plan.arms[0].grip_force_n = f64::NAN,
            |flaw| matches!(flaw, Flaw::GripForce { .. }),
        ),
        (
            "arms[0].x_og",
            |plan| plan.arms[0].x_og.translation.vector.z += 2e-3,
            |flaw| matches!(flaw, Flaw::FingersAcross { .. }),
        ),
        (
            "arms[0].x_og",
            |plan| plan.arms[0].x_og.translation.vector.x += 1.1e-3,
            |flaw| matches!(flaw, Flaw::Hand { .. }),
        ),
        ("arms[0].x_og", |plan| plan.arms[0].q_rad[6] += 0.002, |flaw| matches!(flaw, Flaw::Hand { .. })),
        ("human", |plan| plan.human.as_mut().unwrap().height_m = -1.0, |flaw| matches!(flaw, Flaw::Person(_))),
        (
            "human.x_wb",
            |plan| plan.human.as_mut().unwrap().x_wb.translation.vector.x = f64::NAN,
            |flaw| matches!(flaw, Flaw::PersonPose { .. }),
        ),
        (
            "human.q_rad[3]",
            |plan| plan.human.as_mut().unwrap().q_rad[3] = -0.1,
            |flaw| matches!(flaw, Flaw::PersonAngle { joint: 3, .. }),
        ),
    ];
    for (key, change, is_it) in cases {
        let flaws = flaws(change);
        let [flaw] = &flaws[..] else { panic!("{key}: {flaws:?}") };
        assert_eq!(flaw.key(), key);
        assert!(is_it(flaw), "{flaw:?}");
        let text = flaw.to_string();
        assert!(text.starts_with(&format!("{key}: found ")) && text.contains(", expected "), "{text}");
    }
}

/// A drill pushes into the board; an arbitrary wrench may pull, and its tool may be anywhere on or in the board.
#[test]
fn a_drill_that_pulls_and_a_wrench_that_does() {
    let with_force = |kind: OperationKind, along_n: f64| {
        flaws(|plan| {
            plan.operation.kind = kind;
            plan.operation.wrench_o.force_n = plan.operation.x_ot.rotation * Vector3::z() * along_n;
        })
    };
    assert_eq!(with_force(OperationKind::Drill, 5.0), []);
    let pull = with_force(OperationKind::Drill, -5.0);
    // Rounding of two rotations.
    assert!(matches!(pull[..], [Flaw::Pull { found_n }] if (found_n + 5.0).abs() < 1e-12), "{pull:?}");
    assert_eq!(pull[0].key(), "operation.wrench_o");
    assert_eq!(with_force(OperationKind::Wrench, -5.0), []);
    let inside = flaws(|plan| {
        plan.operation.kind = OperationKind::Wrench;
        plan.operation.x_ot.translation.vector.z -= 5e-3;
    });
    assert_eq!(inside, []);
}

#[test]
fn all_faults_are_found_at_once() {
    let flaws = flaws(|plan| {
        plan.object.mass_kg = -1.0;
        plan.arms[0].grip_force_n = 99.0;
        plan.arms[1].q_rad[0] = 9.0;
        plan.human.as_mut().unwrap().q_rad[0] = 9.0;
    });
    let keys: Vec<_> = flaws.iter().map(Flaw::key).collect();
    assert_eq!(
        keys,
        [
            "object.mass_kg",
            "arms[0].grip_force_n",
            "arms[1].q_rad[0]",
            "human.q_rad[0]",
            // The upper arm of that angle is raised above the shoulder.
            "human.q_rad"
        ]
    );
}

/// What cannot follow from a fault is still checked, and what follows from it is not reported.
#[test]
fn a_fault_hides_no_other_fault() {
    let keys = |change: fn(&mut Plan)| flaws(change).iter().map(Flaw::key).collect::<Vec<_>>();
    let weak_and_off = keys(|plan| {
        plan.arms[0].grip_force_n = 0.0;
        plan.arms[0].x_og.translation.vector.x += 2e-3;
    });
    assert_eq!(weak_and_off, ["arms[0].grip_force_n", "arms[0].x_og"]);
    // No thickness: neither is the tool off the board, nor does no gripper close on it.
    assert_eq!(keys(|plan| plan.object.size_m[2] = f64::NAN), ["object.size_m[2]"]);
    assert_eq!(keys(|plan| plan.object.size_m[0] = -0.1), ["object.size_m[0]"]);
}

#[test]
fn fingers_that_lean_do_not_close_across() {
    let lean = |angle_deg: f64| {
        flaws(|plan| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle_deg.to_radians());
            plan.arms[0].x_og.rotation *= turn;
        })
    };
    assert_eq!(lean(0.09), []);
    let [Flaw::FingersAcross { arm: 0, off_rad, .. }] = lean(2.0)[..] else { panic!("{:?}", lean(2.0)) };
    assert!((off_rad.to_degrees() - 2.0).abs() < 1e-6);
}

/// A board that no gripper closes on has a flaw for each arm.
#[test]
fn a_thick_board_is_a_flaw_of_both_arms() {
    let flaws = flaws(|plan| plan.object.size_m[2] = 0.05);
    assert!(flaws.iter().filter(|flaw| matches!(flaw, Flaw::Thickness { .. })).count() == 2, "{flaws:?}");
}

/// 0.9 mm off is within the tolerance of given plans, and beyond that of the planner's own. Each message states its own.
#[test]
fn the_two_tolerances_differ() {
    let (mut plan, robot) = load();
    plan.arms[0].x_og.translation.vector.x += 0.9e-3;
    let checked = CheckedPlan::new(&robot, &plan, &Person::default(), &default_tool(plan.operation.kind)).unwrap();
    let inexact = checked.inexact();
    let flaw = inexact.iter().find(|flaw| matches!(flaw, Flaw::Hand { arm: 0, .. })).unwrap().to_string();
    assert!(flaw.contains("9.0e-4 m and ") && flaw.ends_with("within 1e-6 m and 1e-6 rad"), "{flaw}");
    let beyond = flaws(|plan| plan.arms[0].x_og.translation.vector.x += 2e-3)[0].to_string();
    assert!(beyond.contains("2.00 mm and ") && beyond.ends_with("within 1 mm and 0.1 degrees"), "{beyond}");
}

/// Written numbers may exceed a limit by their rounding, the planner's own angles may not.
#[test]
fn the_planner_keeps_limits_exactly() {
    let (mut plan, robot) = load();
    let human =
        Human::new(&plan.human.unwrap().person(&Person::default()), &default_tool(plan.operation.kind)).unwrap();
    plan.human.as_mut().unwrap().q_rad[3] = human.anatomy().joints_rad[3][1] + 1e-7;
    let checked = CheckedPlan::new(&robot, &plan, &Person::default(), &default_tool(plan.operation.kind)).unwrap();
    assert!(checked.inexact().iter().any(|flaw| matches!(flaw, Flaw::PersonAngle { joint: 3, .. })));
    assert_eq!(flaws(|plan| plan.human.as_mut().unwrap().q_rad[0] = 9.0)[0].key(), "human.q_rad[0]");
}
