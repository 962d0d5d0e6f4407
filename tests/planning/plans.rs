//! Searches that are limited, and searches for several plans: the best few and the Pareto front.

use benchdog::{
    model::{
        plan::Plan,
        scenario::{Budget, PlannerKind},
    },
    planner::{self, Outcome},
};

use crate::shared::{PLANNER, fast, found, plan, verified};

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
