//! Replanning: every answer is a plan like any other, the same calls give the same answers, and what a caller asks the robot to
//! keep is kept.

use std::sync::Arc;

use benchdog::{
    cache::Builtin,
    model::{
        grasp::EdgeGrasp,
        plan::Plan,
        scenario::{Scenario, StandingPlace},
        stop::Never,
    },
    planner::{Outcome, Planner, Replanned, Replanning},
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::{
    common::{baxter, scenario},
    shared::verified,
};

/// No search from scratch, which would take seconds.
const KNOWN_HOLDS: Replanning = Replanning { most_motion_rad: None, keep_grasps: false, search: false };

/// A planner with the warm starts that come with the program, so that a test need not make them.
fn planner() -> Planner {
    Planner::with_store(baxter(), Arc::new(Builtin))
}

/// The answer to a scenario, checked.
fn answered(planner: &mut Planner, scenario: &Scenario, how: &Replanning) -> Option<Replanned> {
    let found = planner.replan(scenario, how, &Never).unwrap().found()?;
    verified(&found.plan, scenario);
    Some(found)
}

/// A planner after its first answer to a scenario.
fn begun(scenario: &Scenario) -> (Planner, Plan) {
    let mut planner = planner();
    let first = answered(&mut planner, scenario, &KNOWN_HOLDS).unwrap();
    assert!(first.motion.is_none() && !first.searched);
    (planner, first.plan)
}

/// The scenario with a person who stands where a plan has them, moved by m and degrees.
fn standing(scenario: &Scenario, plan: &Plan, [x_m, y_m]: [f64; 2], turn_deg: f64) -> Scenario {
    let x_wb = plan.human.unwrap().x_wb;
    let ahead = x_wb.rotation * nalgebra::Vector3::x();
    let mut moved = scenario.clone();
    moved.human.place = StandingPlace::Given {
        p_wb_m: [x_wb.translation.x + x_m, x_wb.translation.y + y_m],
        heading_deg: ahead.y.atan2(ahead.x).to_degrees() + turn_deg,
        tolerance_m: 0.02,
        tolerance_deg: 3.0,
    };
    moved
}

fn objective(plan: &Plan) -> f64 {
    plan.comfort.unwrap().objective
}

/// The largest difference of a joint between two plans, rad.
fn largest_motion_rad(one: &Plan, other: &Plan) -> f64 {
    let joints = one.arms.iter().zip(&other.arms).flat_map(|(a, b)| a.q_rad.iter().zip(&b.q_rad));
    joints.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_hold_follows_a_person_who_walks_and_the_same_walk_gives_the_same_plans() {
    let scenario = scenario("quickstart");
    let walk = || {
        let (mut planner, first) = begun(&scenario);
        let step = |number: i32| {
            let moved = standing(&scenario, &first, [0.0, 0.01 * f64::from(number)], 0.0);
            answered(&mut planner, &moved, &KNOWN_HOLDS).unwrap()
        };
        let steps: Vec<_> = (0..15).map(step).collect();
        (first, steps)
    };
    let (first, steps) = walk();
    assert_eq!((first.clone(), steps.clone()), walk());
    let mut before = first;
    for step in steps {
        let motion = step.motion.unwrap();
        // The motion that is told is that between the two plans; differences of the same numbers.
        assert_eq!(motion.largest_joint_rad, largest_motion_rad(&before, &step.plan));
        let moved = before.object.x_wo.translation.vector - step.plan.object.x_wo.translation.vector;
        assert!((motion.board_m - moved.norm()).abs() < 1e-12 && motion.length_rad >= motion.largest_joint_rad);
        before = step.plan;
    }
}

/// A hundred drawn changes at once: the person has moved by up to 10 cm and 10 degrees, the hole by up to 5 cm, the force by up to a
/// third. Most have an answer, whose joints keep the limit; an answer without one is never better than one with it can be.
#[test]
fn drawn_changes_have_answers_within_the_limit_of_motion() {
    let scenario = scenario("quickstart");
    let (_, first) = begun(&scenario);
    let mut random = Pcg64::seed_from_u64(20);
    let mut answers = 0;
    let mut planner = planner();
    for number in 0..100 {
        let mut around = |by: f64| random.random_range(-by..by);
        let mut changed = standing(&scenario, &first, [around(0.1), around(0.1)], around(10.0));
        changed.operation.x_ot.translation.x += around(0.05);
        changed.operation.x_ot.translation.y += around(0.05);
        changed.operation.wrench_o.force_n *= 1.0 + around(0.33);
        let most_rad = (5.0 + 40.0 * f64::from(number) / 100.0).to_radians();
        assert!(planner.resume(&scenario, &first, &Never).unwrap());
        let how = Replanning { most_motion_rad: Some(most_rad), ..KNOWN_HOLDS };
        if let Some(found) = answered(&mut planner, &changed, &how) {
            answers += 1;
            // Rounding of a joint at its limit.
            assert!(largest_motion_rad(&first, &found.plan) <= most_rad + 1e-9, "{number}");
        }
    }
    assert!(answers > 50, "{answers}");
}

#[test]
fn grasps_that_are_kept_stay_where_they_are() {
    let scenario = scenario("quickstart");
    let (mut planner, first) = begun(&scenario);
    let grasps = |plan: &Plan| {
        let shape = plan.object.shape();
        plan.arms.iter().map(|arm| EdgeGrasp::of(&arm.x_og, &shape).unwrap()).collect::<Vec<_>>()
    };
    let moved = standing(&scenario, &first, [0.02, 0.03], 2.0);
    let kept = Replanning { keep_grasps: true, ..KNOWN_HOLDS };
    let found = answered(&mut planner, &moved, &kept).unwrap();
    assert!(!found.motion.unwrap().regrasps);
    // The plan has X_OG, from which rounding comes.
    for (a, b) in grasps(&first).iter().zip(grasps(&found.plan)) {
        let near = [(a.along_m, b.along_m), (a.depth_m, b.depth_m), (a.angle_rad, b.angle_rad)];
        assert!(a.edge == b.edge && near.iter().all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
    }
    let free = answered(&mut planner, &moved, &KNOWN_HOLDS).unwrap();
    // With more variables the same start comes at least as far, but for the switch to another hold.
    assert!(objective(&free.plan) >= objective(&found.plan) * (1.0 - 1e-3));
}

#[test]
fn a_robot_that_must_not_move_answers_with_its_hold_or_says_why_not() {
    let scenario = scenario("quickstart");
    let (mut planner, first) = begun(&scenario);
    let still = Replanning { most_motion_rad: Some(0.0), keep_grasps: true, search: true };
    let found = answered(&mut planner, &scenario, &still).unwrap();
    assert!(found.motion.unwrap().largest_joint_rad <= 1e-9 && !found.searched);
    // Behind the robot nobody reaches the board.
    let elsewhere = standing(&scenario, &first, [-3.0, 0.0], 0.0);
    let Outcome::Infeasible(why) = planner.replan(&elsewhere, &still, &Never).unwrap() else { panic!("a plan") };
    assert!(why.candidates > 0, "{why}");
    // The known holds are still known.
    assert_eq!(answered(&mut planner, &scenario, &still).unwrap().motion.unwrap().largest_joint_rad, 0.0);
}

#[test]
fn replanning_starts_from_a_plan_that_is_given_if_it_keeps_every_limit() {
    let scenario = scenario("quickstart");
    let Outcome::Found(plan) = planner().plan(&scenario).unwrap() else { panic!("no plan") };
    let mut planner = planner();
    assert!(planner.resume(&scenario, &plan, &Never).unwrap());
    let found = answered(&mut planner, &scenario, &KNOWN_HOLDS).unwrap();
    // The search's own optimum: nothing is to be gained.
    assert!((objective(&found.plan) / objective(&plan) - 1.0).abs() < 2e-3, "{}", objective(&found.plan));
    let mut hard = scenario.clone();
    hard.operation.wrench_o.force_n *= 100.0;
    assert!(!planner.resume(&hard, &plan, &Never).unwrap());
    let mut without_person = plan;
    without_person.human = None;
    assert!(!planner.resume(&scenario, &without_person, &Never).unwrap());
}

/// Another board has other holds: nothing is known of it, and it is planned as if it were the first.
#[test]
fn another_board_is_a_first_plan() {
    let scenario = scenario("quickstart");
    let (mut planner, first) = begun(&scenario);
    let mut other = scenario.clone();
    other.limits.clearance_mm = 0.0;
    other.planner.budget = benchdog::model::scenario::Budget::Fast;
    let found = answered(&mut planner, &other, &Replanning::default()).unwrap();
    // The budget has no warm starts, so the task was searched.
    assert!(found.motion.is_none() && found.searched);
    assert_ne!(found.plan.arms, first.arms);
}

/// A person that cannot be is an error, after which the holds are known as before.
#[test]
fn an_error_leaves_the_known_holds() {
    let scenario = scenario("quickstart");
    let (mut planner, _) = begun(&scenario);
    let mut wrong = scenario.clone();
    wrong.human.height_m = -1.0;
    assert!(planner.replan(&wrong, &KNOWN_HOLDS, &Never).is_err());
    assert!(answered(&mut planner, &scenario, &KNOWN_HOLDS).unwrap().motion.is_some());
    // A task of another board that has no answer leaves them too.
    let mut other =
        standing(&scenario, &answered(&mut planner, &scenario, &KNOWN_HOLDS).unwrap().plan, [-3.0, 0.0], 0.0);
    other.limits.clearance_mm = 0.0;
    other.planner.budget = benchdog::model::scenario::Budget::Fast;
    assert!(answered(&mut planner, &other, &KNOWN_HOLDS).is_none());
    assert!(answered(&mut planner, &scenario, &KNOWN_HOLDS).unwrap().motion.is_some());
}
