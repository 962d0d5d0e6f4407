//! Searches that are limited, and searches for several plans: the best few, the Pareto front, a whole circle.

use benchdog::{
    collision::{BoardBody, CollisionModel, Scene},
    model::{
        board::BoardShape,
        frames::Pose,
        plan::Plan,
        scenario::{Budget, PlannerKind},
    },
    planner::{self, Outcome, path},
    robot::{ArmState, Chain},
};

use crate::{
    common::baxter,
    shared::{PLANNER, fast, found, plan, verified},
};

fn objective(plan: &Plan) -> f64 {
    plan.comfort.as_ref().unwrap().objective
}

fn comforts(plan: &Plan) -> [f64; 2] {
    let comfort = plan.comfort.as_ref().unwrap();
    [comfort.muscular_regularised, comfort.peripersonal_m]
}

#[test]
fn no_more_candidates_are_evaluated_than_allowed() {
    let mut scenario = fast("quickstart");
    let free = plan(&scenario);
    let needed = free.planner.unwrap().evaluations;
    for fewer in [1, 5, 10] {
        scenario.planner.evaluations = Some(needed - fewer);
        let limited = plan(&scenario);
        assert!(limited.planner.unwrap().evaluations <= needed - fewer);
        verified(&limited, &scenario);
    }
    scenario.planner.evaluations = Some(needed);
    assert_eq!(comforts(&plan(&scenario)), comforts(&free));
    scenario.planner.evaluations = Some(3);
    match PLANNER.plan(&scenario).unwrap() {
        Outcome::Found(plan) => assert!(plan.planner.unwrap().evaluations <= 3),
        Outcome::Infeasible(why) => assert!(why.candidates <= 3, "{why}"),
    }
}

#[test]
fn the_best_few_differ_are_sorted_and_satisfy_every_constraint() {
    let scenario = fast("quickstart");
    let plans = found(PLANNER.search(&scenario).top(3).unwrap());
    assert_eq!(plans.len(), 3);
    assert!(plans.windows(2).all(|pair| objective(&pair[0]) >= objective(&pair[1])));
    for (index, plan) in plans.iter().enumerate() {
        verified(plan, &scenario);
        assert!(plans[..index].iter().all(|other| planner::differ(other, plan)));
        assert!(!planner::differ(plan, plan));
    }
    // Each way to differ counts alone; just within the distance does not.
    let changed = |change: &dyn Fn(&mut Plan)| {
        let mut other = plans[0].clone();
        change(&mut other);
        planner::differ(&plans[0], &other)
    };
    assert!(changed(&|plan| plan.object.x_wo.translation.vector.x += 0.051));
    assert!(!changed(&|plan| plan.object.x_wo.translation.vector.x += 0.049));
    assert!(changed(&|plan| plan.arms[1].q_rad[0] += 0.53));
    assert!(!changed(&|plan| plan.arms[1].q_rad[0] += 0.52));
    assert!(changed(&|plan| plan.arms[0].x_og = plan.arms[1].x_og) || plans[0].arms[0].x_og == plans[0].arms[1].x_og);
    assert!(!changed(&|plan| plan.human.as_mut().unwrap().q_rad[0] += 1.0));
}

#[test]
fn the_front_is_non_dominated_and_ends_at_the_single_optima() {
    let scenario = fast("quickstart");
    let front = found(PLANNER.search(&scenario).front().unwrap());
    for pair in front.points.windows(2) {
        let ([m0, p0], [m1, p1]) = (comforts(&pair[0].plan), comforts(&pair[1].plan));
        assert!(m0 > m1 && p0 < p1, "one dominates the other: {m0} {p0}, {m1} {p1}");
    }
    let ends = [&front.points[0], &front.points[front.points.len() - 1]];
    for (index, (end, kind)) in ends.into_iter().zip([PlannerKind::Muscular, PlannerKind::Peripersonal]).enumerate() {
        let best = comforts(&end.plan)[index];
        // The pool's best, computed again in the plan: rounding.
        assert!((best - front.optima[index]).abs() <= 1e-9 * best);
        let mut alone = scenario.clone();
        alone.planner.kind = kind;
        let alone = plan(&alone);
        assert!(best >= comforts(&alone)[index] * (1.0 - 1e-9), "{kind} alone finds more");
    }
    let own = plan(&scenario);
    assert!(objective(&front.own.plan) >= objective(&own) * (1.0 - 1e-9), "the comfort planner alone finds more");
    for point in front.points.iter().chain([&front.own]) {
        verified(&point.plan, point.plan.scenario.as_ref().unwrap());
    }
}

/// Warm starts serve the front and the best few as they serve a plan: neither loses what the planner itself finds.
#[test]
fn the_front_and_the_best_few_use_warm_starts_too() {
    let mut scenario = fast("quickstart");
    scenario.planner.budget = Budget::Default;
    let alone = objective(&plan(&scenario));
    let plans = found(PLANNER.search(&scenario).top(2).unwrap());
    let front = found(PLANNER.search(&scenario).front().unwrap());
    // The same starts in other rounds: their refinements may end a few tenths of a percent apart.
    for of in [objective(&plans[0]), objective(&front.own.plan)] {
        assert!(of >= 0.995 * alone, "{of}, the planner alone finds {alone}");
    }
}

#[test]
fn a_front_marks_the_share_that_a_normalised_objective_asks_for() {
    let mut scenario = fast("quickstart");
    scenario.comfort.peripersonal_share = Some(0.3);
    // The front is of both comforts, whatever planner the scenario names.
    for kind in [PlannerKind::Comfort, PlannerKind::Muscular] {
        scenario.planner.kind = kind;
        let front = found(PLANNER.search(&scenario).front().unwrap());
        // The sweep's own optima may be some hundredths better than those of the objective.
        assert!((front.own.share - 0.3).abs() < 0.02, "{kind}: {}", front.own.share);
    }
}

/// Poses of the robot's links when its arms take these configurations.
fn link_poses(q_rad: &[Vec<f64>], thickness_m: f64) -> Vec<Pose> {
    let states: Vec<_> = (0..q_rad.len())
        .map(|arm| {
            let finger_travel_m = [0, 1].map(|finger| baxter().arms[arm].gripper.travel_for_gap_m(finger, thickness_m));
            ArmState { arm, q_rad: &q_rad[arm], finger_travel_m }
        })
        .collect();
    baxter().link_poses(&baxter().positions(&states))
}

#[test]
fn a_circle_is_covered_by_one_grasp_and_by_a_sequence_with_one_grasp() {
    let scenario = fast("cut-rim");
    let points = path::points(&scenario).unwrap();
    let found = found(PLANNER.search(&scenario).circle().unwrap()).continuous;
    let covered = |plans: &path::PlansByPoint| plans.iter().flatten().count();
    assert!(covered(&found.hold) > 0 && covered(&found.sequence) >= covered(&found.hold));
    for plans in [&found.hold, &found.sequence] {
        let first = plans.iter().flatten().next().unwrap();
        for (plan, scenario) in plans.iter().zip(&points) {
            let Some(plan) = plan else { continue };
            verified(plan, scenario);
            assert!(plan.arms.iter().zip(&first.arms).all(|(a, b)| a.x_og == b.x_og), "the grasp stays");
            assert_eq!(plan.operation.x_ot, scenario.operation.x_ot);
        }
    }
    let first = found.hold.iter().flatten().next().unwrap();
    for plan in found.hold.iter().flatten() {
        assert_eq!((&plan.arms, plan.object.x_wo), (&first.arms, first.object.x_wo), "one grasp for all points");
    }
    motions_are_clear(&found, first.object.size_m);
}

/// The limit of evaluations applies to each of the three searches of a circle.
#[test]
fn no_search_of_a_circle_evaluates_more_than_allowed() {
    const LIMIT: u64 = 60;
    let mut scenario = fast("cut-rim");
    scenario.planner.evaluations = Some(LIMIT);
    let plans = found(PLANNER.search(&scenario).circle().unwrap());
    let most = |plans: &path::PlansByPoint| {
        plans.iter().flatten().map(|plan| plan.planner.unwrap().evaluations).max().unwrap_or(0)
    };
    // The two searches without regrasping share a count.
    assert!(most(&plans.continuous.hold) <= 2 * LIMIT, "{}", most(&plans.continuous.hold));
    assert!(most(&plans.continuous.sequence) <= 2 * LIMIT, "{}", most(&plans.continuous.sequence));
    assert!(most(&plans.separate) <= LIMIT, "{}", most(&plans.separate));
    assert!(plans.continuous.hold.iter().any(Option::is_some), "60 evaluations find some coverage");
}

/// Every step of every motion within joint limits, on the grasps, free of collisions, short, and from plan to plan.
fn motions_are_clear(found: &path::Continuous, size_m: [f64; 3]) {
    let collision = CollisionModel::new(baxter());
    let board = BoardBody::new(&BoardShape::cuboid(size_m));
    let grasp = &found.sequence.iter().flatten().next().unwrap().arms;
    let chains: Vec<_> = (0..2).map(|arm| Chain::new(baxter(), arm, 0.0)).collect();
    assert_eq!(found.motions.len(), path::POINTS - 1);
    for (index, motion) in found.motions.iter().enumerate() {
        for (plan, step) in
            [(&found.sequence[index], &motion[0]), (&found.sequence[index + 1], &motion[motion.len() - 1])]
        {
            let Some(plan) = plan else { continue };
            assert_eq!(plan.object.x_wo, step.x_wo);
            assert!(plan.arms.iter().zip(&step.q_rad).all(|(arm, q_rad)| arm.q_rad == *q_rad));
        }
        for step in motion {
            for ((chain, hold), q_rad) in chains.iter().zip(grasp).zip(&step.q_rad) {
                assert!(chain.within_limits(q_rad, 0.0));
                let (is, meant) = (chain.gripper_pose(q_rad), step.x_wo * hold.x_og);
                // The tolerance of docs/method.md#34-constraints.
                assert!((is.translation.vector - meant.translation.vector).norm() < 1e-6);
                assert!(is.rotation.angle_to(&meant.rotation) < 1e-6);
            }
            let poses = link_poses(&step.q_rad, size_m[2]);
            let scene = Scene {
                link_poses: &poses,
                holding: &[0, 1],
                board: &board,
                x_wo: step.x_wo,
                person: &[],
                clearance_m: 0.0,
            };
            assert_eq!(collision.first_violation(&scene), None);
        }
        for pair in motion.windows(2) {
            let joints = pair[0].q_rad.iter().flatten().zip(pair[1].q_rad.iter().flatten());
            let most_rad = joints.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(most_rad <= 3.0 * path::STEP_RAD, "a step of {most_rad} rad");
        }
    }
}
