//! A person who stands as people stand, or where the scenario says, and the person of the first release.

use benchdog::{
    human::Human,
    model::{
        operation::OperationKind,
        plan::{Plan, PostureConstraint},
        scenario::{Budget, PlannerKind, PostureLimits, Scenario, StandingPlace},
        stop::Never,
    },
    planner::{Infeasible, Outcome},
    reproduce::paper,
};

use crate::{
    comparison::{compared, square},
    shared::{PLANNER, fast, flaws, found, plan, verified},
};

/// An operation of the paper's evaluation for a natural person.
fn natural(name: &str) -> Scenario {
    let operation = paper::operations().into_iter().find(|operation| operation.name == name).unwrap();
    operation.load().unwrap().scenario
}

/// The plan keeps every limit of a natural posture exactly, not only within the tolerance of given plans.
#[track_caller]
fn is_natural(plan: &Plan) {
    for (constraint, figure) in plan.human.unwrap().posture.unwrap().iter() {
        // Conversions to degrees round.
        assert!(figure.margin() > -1e-9, "{}: {} {figure:?}", plan.name, constraint.key());
    }
}

/// The reason why nothing was found.
fn infeasible(scenario: &Scenario) -> Infeasible {
    match PLANNER.plan(scenario).unwrap() {
        Outcome::Found(plan) => panic!("{:?}", plan.human),
        Outcome::Infeasible(why) => why,
    }
}

#[test]
fn every_planner_keeps_every_limit_of_a_natural_posture() {
    for (name, kinds) in [("cut-05", &PlannerKind::ALL[..]), ("drill-2", &PlannerKind::ALL[..])] {
        for &kind in kinds {
            let mut scenario = natural(name);
            scenario.planner.kind = kind;
            scenario.planner.budget = Budget::Fast;
            let plan = plan(&scenario);
            verified(&plan, &scenario);
            is_natural(&plan);
        }
    }
}

#[test]
fn several_plans_the_front_and_the_plans_of_a_path_keep_them_too() {
    let scenario = fast("cut-front");
    let search = || PLANNER.search(&scenario);
    let plans = found(search().top(3).unwrap());
    let front = found(search().front().unwrap());
    assert!(plans.len() > 1 && front.points.len() > 1);
    let compared = compared(&scenario, &square(), &Never).unwrap();
    let of_path: Vec<_> = compared.one_hold.iter().chain(&compared.separate).flatten().collect();
    // Every side of a square can be cut from somewhere.
    assert!(of_path.len() > 4, "{}", of_path.len());
    let of_front = front.points.iter().map(|point| &point.plan);
    plans.iter().chain(of_front).chain(of_path).for_each(is_natural);
}

#[test]
fn every_limit_names_itself_when_it_leaves_nothing() {
    use PostureConstraint as C;
    type Change = fn(&mut PostureLimits);
    let impossible: [(C, Change); 6] = [
        (C::Facing, |limits| limits.facing_deg = 0.0),
        (C::View, |limits| limits.view_deg = 0.1),
        (C::GazeYaw, |limits| limits.gaze_yaw_deg = 0.0),
        (C::GazePitch, |limits| limits.gaze_pitch_deg = [34.9, 35.0]),
        (C::EyeDistance, |limits| limits.eye_distance_m = [0.2, 0.201]),
        (C::FaceElevation, |limits| limits.face_elevation_deg = 89.9),
    ];
    for (constraint, change) in impossible {
        let mut scenario = fast("quickstart");
        change(&mut scenario.human.posture);
        let why = infeasible(&scenario);
        let unnatural = why.unnatural.as_ref().unwrap();
        assert!(unnatural.candidates > 100);
        assert_eq!(unnatural.broken[&constraint], unnatural.candidates, "{constraint:?}: {why}");
        assert!(why.to_string().contains(&format!("100 % break {}", constraint.key())), "{why}");
    }
    // Limits of the arm can leave little, but a range that is not empty always leaves something. They are named among the limits
    // that are broken.
    let mut scenario = fast("quickstart");
    scenario.human.posture.facing_deg = 0.0;
    let text = infeasible(&scenario).to_string();
    for constraint in [C::UpperArm, C::Reach, C::Elbow, C::LimitMargin, C::DeviationMargin, C::LineOfSight] {
        assert!(text.contains(&format!("% break {}", constraint.key())), "{text}");
    }
}

#[test]
fn a_person_who_stands_somewhere_gets_a_plan_for_that_place() {
    for (name, p_wb_m, heading_deg) in [("drill-5", [0.95, -0.10], 180.0), ("cut-05", [1.10, -0.30], 170.0)] {
        let mut scenario = natural(name);
        scenario.planner.budget = Budget::Fast;
        scenario.human.place = StandingPlace::Given { p_wb_m, heading_deg, tolerance_m: 0.05, tolerance_deg: 5.0 };
        let plan = plan(&scenario);
        verified(&plan, &scenario);
        is_natural(&plan);
        let x_wb = plan.human.unwrap().x_wb;
        let ahead = x_wb.rotation * nalgebra::Vector3::x();
        for (axis, given) in p_wb_m.into_iter().enumerate() {
            assert!((x_wb.translation.vector[axis] - given).abs() <= 0.05 + 1e-9);
        }
        let turn_deg = (ahead.y.atan2(ahead.x).to_degrees() - heading_deg + 180.0).rem_euclid(360.0) - 180.0;
        assert!(turn_deg.abs() <= 5.0 + 1e-6, "{turn_deg}");
        // The same person elsewhere is a flaw.
        let StandingPlace::Given { p_wb_m, .. } = &mut scenario.human.place else { unreachable!() };
        p_wb_m[0] += 0.5;
        assert!(flaws(&plan, &scenario).iter().any(|flaw| flaw.starts_with("human.x_wb: found place")));
    }
    // A square, cut from one place: its plans are for that place too.
    let mut scenario = natural("cut-05");
    scenario.planner.budget = Budget::Fast;
    scenario.human.place =
        StandingPlace::Given { p_wb_m: [1.10, -0.30], heading_deg: 170.0, tolerance_m: 0.05, tolerance_deg: 5.0 };
    let compared = compared(&scenario, &square(), &Never).unwrap();
    let plans: Vec<_> = compared.separate.iter().chain(&compared.one_hold).flatten().collect();
    assert!(plans.len() > 4, "{}", plans.len());
    plans.into_iter().for_each(|plan| verified(plan, plan.scenario.as_ref().unwrap()));
    // Nobody drills from the far end of the room.
    let mut scenario = fast("quickstart");
    scenario.human.place =
        StandingPlace::Given { p_wb_m: [4.0, 0.0], heading_deg: 180.0, tolerance_m: 0.05, tolerance_deg: 5.0 };
    let why = infeasible(&scenario);
    let unnatural = why.unnatural.as_ref().unwrap();
    assert_eq!(unnatural.elsewhere, unnatural.candidates);
    assert!(why.to_string().contains("100 % break place"), "{why}");
}

#[test]
fn a_left_handed_person_mirrors_what_a_right_handed_one_does() {
    let scenario = fast("drill-left-handed");
    let plan = plan(&scenario);
    verified(&plan, &scenario);
    is_natural(&plan);
    // Positive is the working side, for either hand: the optimum leans on the bound there.
    let facing = plan.human.unwrap().posture.unwrap().facing_deg;
    assert!(facing.value > 0.0, "{facing:?}");
}

/// `tests/data/first_release` has plans of the release before postures were natural: the present program computes the same comfort
/// for them and finds plans as comfortable. Their search took other ways to the same optima.
#[test]
fn the_papers_person_gives_the_comfort_of_the_first_release() {
    for name in ["cut-05-comfort", "drill-5-muscular", "cut-05-peripersonal", "drill-5-random"] {
        let path = crate::common::root().join(format!("tests/data/first_release/{name}.json"));
        let old: Plan = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let operation = paper::printed_operations().into_iter().find(|operation| operation.name == old.name).unwrap();
        assert!(matches!(operation.kind, OperationKind::Cut | OperationKind::Drill));
        let mut scenario = operation.load().unwrap().scenario;
        scenario.planner.kind = old.planner.unwrap().kind;
        // That release only kept the robot from touching itself, and its torque limits had no safety factor.
        scenario.limits.clearance_mm = 0.0;
        scenario.limits.torque_ratio = 1.1;
        let human = Human::new(&scenario.human, &scenario.tool).unwrap();
        let (of_old, stated) = (old.human.unwrap(), old.comfort.unwrap());
        let wrench_w = old.operation.wrench_w(&old.object.x_wo);
        let found = human.muscular(&of_old.q_rad, &of_old.x_wb, &wrench_w, &scenario.comfort);
        // Rounding: the search had the wrench in the body's axes.
        assert!((found.regularised / stated.muscular_regularised - 1.0).abs() < 1e-12, "{name}: {found:?}");
        let new = plan(&scenario);
        if scenario.planner.kind != PlannerKind::Random {
            let share = new.comfort.unwrap().objective / stated.objective;
            // A search is local, and takes fewer steps than that release's: 0.9845 for the hole, whose comfort is near its upper bound.
            assert!(share > 0.98, "{name}: {share}");
        }
    }
}
