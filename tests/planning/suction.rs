//! Plans with suction cups: what is a valid grasp, and what the statics and the simulation say of it.

use std::convert::Infallible;

use benchdog::{
    check::{CheckedPlan, Flaw},
    human::default_tool,
    judge::{failing_load, judge},
    model::{
        plan::Plan,
        plate::{Plate, PlateRecord},
        scenario::{Limits, Person, SimulationSettings},
        verdict::VerdictKind,
    },
    robot::Robot,
    scenario::read_plan,
    sim::{Conditions, simulate},
    statics::{ContactModel, LimitCrossing, ResponseOutcome, StabilityWorkspace},
};
use nalgebra::{UnitQuaternion, Vector3};

use crate::common::{checked, root};

/// The given plan with two suction cups on the back of a board.
fn load() -> (Plan, Robot) {
    read_plan(&root().join("scenarios/plans/suction-cups.json"), None).unwrap()
}

/// The flaws of the plan with a change, without those of arms that are elsewhere than their angles put them.
fn flaws(change: impl Fn(&mut Plan)) -> Vec<Flaw> {
    let (mut plan, robot) = load();
    change(&mut plan);
    let checked = CheckedPlan::new(&robot, &plan, &Person::default(), &default_tool(plan.operation.kind));
    let all: Vec<Flaw> = checked.err().map(|flaws| flaws.iter().cloned().collect()).unwrap_or_default();
    all.into_iter().filter(|flaw| !matches!(flaw, Flaw::Hand { .. })).collect()
}

#[test]
fn a_cup_lies_flat_on_a_face_with_all_of_its_lip_on_the_material() {
    assert_eq!(flaws(|_| {}), []);
    let off_face = flaws(|plan| plan.arms[0].x_og.translation.vector.z -= 2e-3);
    let [Flaw::CupOffFace { arm: 0, off_m, .. }] = off_face[..] else { panic!("{off_face:?}") };
    assert!((off_m - 2e-3).abs() < 1e-12);
    let lean = |angle_deg: f64| {
        flaws(|plan| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle_deg.to_radians());
            plan.arms[1].x_og.rotation *= turn;
        })
    };
    assert_eq!(lean(0.09), []);
    let [Flaw::CupOffFace { arm: 1, off_rad, .. }] = lean(2.0)[..] else { panic!("{:?}", lean(2.0)) };
    assert!((off_rad.to_degrees() - 2.0).abs() < 1e-6);
    // On the other face z_G points the other way.
    let front = flaws(|plan| {
        plan.arms[0].x_og.translation.vector.z = 0.015;
        plan.arms[0].x_og.rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    });
    assert_eq!(front, []);
    // The cup of 80 mm ends 2 mm beyond the edge at x = 0.25 m.
    let beyond = flaws(|plan| plan.arms[0].x_og.translation.vector.x = 0.212);
    let [Flaw::CupOffBoard { arm: 0, off_m }] = beyond[..] else { panic!("{beyond:?}") };
    assert!((off_m - 2e-3).abs() < 1e-12);
    assert_eq!(beyond[0].key(), "arms[0].x_og");
    assert!(
        beyond[0].to_string().contains("a suction cup 2.0 mm off the material, expected a lip inside"),
        "{}",
        beyond[0]
    );
    // A hole of 20 mm under the lip.
    let leaking = flaws(|plan| {
        let outline_m = plan.object.shape().outline_m();
        let hole = vec![[0.17, -0.01], [0.19, -0.01], [0.19, 0.01], [0.17, 0.01]];
        plan.object.plate = Some(Plate::from(PlateRecord { outline_m, holes_m: vec![hole] }));
    });
    assert!(matches!(leaking[..], [Flaw::CupOffBoard { arm: 0, .. }]), "{leaking:?}");
}

#[test]
fn a_cup_may_touch_the_board_and_the_rest_of_the_hand_may_not() {
    let (plan, robot) = load();
    assert_eq!(checked(&robot, &plan).first_contact(0.0), None);
    // A board that is thicker by 2 x 80 mm contains the fingers that carry the cup; its cups are off the face, so this is a scene and no plan.
    let mut thick = plan.clone();
    thick.object.size_m[2] += 0.16;
    let board = benchdog::collision::BoardBody::new(&thick.object.shape());
    let own = checked(&robot, &plan);
    let scene = benchdog::collision::Scene { board: &board, ..own.scene() };
    let found = own.collision().first_violation(&scene).unwrap().describe(&robot);
    assert!(found.contains("panda") && found.contains("the board"), "{found}");
}

/// Deflection and failing load of the plan as the statics predict them, within 3 % of the simulation.
#[test]
fn suction_cups_are_predicted() {
    let (plan, robot) = load();
    let friction = 0.6;
    let own = checked(&robot, &plan);
    let hold = ContactModel::of_plan(&own, friction).unwrap();
    let settings = SimulationSettings { release_s: 0.0, ..SimulationSettings::default() };
    let limits = Limits { deflection_mm: 50.0, ..Limits::USUAL };
    let judged = |load_factor: f64| {
        let trace = simulate(&own, &Conditions::new(friction, settings).scaled(load_factor)).unwrap();
        judge(&trace, &limits)
    };
    let mut workspace = StabilityWorkspace::new();
    let ResponseOutcome::Found(response) = workspace.response(&hold, 1.0).unwrap() else { panic!() };
    let moved_mm = *judged(1.0).measures.deflection_mm.last().unwrap();
    let off = response.deflection_mm() / moved_mm - 1.0;
    assert!(off.abs() < 0.03, "{} {moved_mm}", response.deflection_mm());
    let predicted = workspace.compliant_load_factor(&hold, &limits).unwrap();
    assert!(matches!(predicted.first_limit, Some(LimitCrossing::GripWrench { .. })), "{predicted:?}");
    let Ok(found) = failing_load(predicted.load_factor, |load_factor| Ok::<_, Infallible>(judged(load_factor)));
    assert_eq!(found.judgement.verdict, VerdictKind::Detaches);
    assert!((predicted.load_factor / found.holds_at - 1.0).abs() < 0.03, "{predicted:?} {}", found.holds_at);
}
