//! A search that finds nothing: the second search, and what is told of it.

use benchdog::{
    model::scenario::Scenario,
    planner::{Infeasible, NearMiss, Outcome, Remedy},
};

use crate::shared::{PLANNER, fast, plan, verified};

/// A hole near a corner, drilled with a force in N: near the limit of what the arms' compliance permits.
fn near_a_corner(force_n: f64) -> Scenario {
    let mut scenario = fast("quickstart");
    scenario.operation.x_ot.translation.x = 0.1;
    scenario.operation.x_ot.translation.y = 0.05;
    scenario.operation.wrench_o.force_n *= force_n / scenario.operation.wrench_o.force_n.norm();
    scenario
}

fn infeasible(scenario: &Scenario) -> Infeasible {
    match PLANNER.plan(scenario).unwrap() {
        Outcome::Found(plan) => panic!("found {:?}", plan.stability),
        Outcome::Infeasible(why) => why,
    }
}

/// Every candidate counts for exactly one reason, and the printed shares sum to 100 %.
#[track_caller]
fn has_whole_shares(why: &Infeasible) {
    assert_eq!(why.removed.iter().map(|(_, count)| count).sum::<u64>(), why.candidates, "{why:?}");
    let text = why.to_string();
    let shares = text.split_once("constraint:").unwrap().1.split(';').next().unwrap();
    let sum: f64 = shares.split(',').map(|share| share.trim().split(' ').next().unwrap().parse::<f64>().unwrap()).sum();
    // Ten decimal fractions of one digit.
    assert!((sum - 100.0).abs() < 1e-9, "{text}");
}

#[track_caller]
fn nearest(why: &Infeasible) -> &NearMiss {
    let nearest = why.nearest.as_deref().unwrap_or_else(|| panic!("{why}"));
    assert!(nearest.load_factor < nearest.required && nearest.load_factor > 0.0, "{why}");
    nearest
}

/// The first search finds a plan with seed 1 and none with seeds 2 and 3.
#[test]
fn what_one_seed_finds_the_others_find_too() {
    for seed in 1..=3 {
        let mut scenario = near_a_corner(18.0);
        scenario.planner.seed = seed;
        let plan = plan(&scenario);
        verified(&plan, &scenario);
        assert_eq!(plan.planner.unwrap().seed, seed);
        if seed == 2 {
            let again = self::plan(&scenario);
            assert_eq!(serde_json::to_string(&again).unwrap(), serde_json::to_string(&plan).unwrap());
            let several = crate::shared::found(PLANNER.search(&scenario).top(2).unwrap());
            several.iter().for_each(|plan| verified(plan, &scenario));
        }
    }
}

#[test]
fn the_nearest_miss_tells_the_load_that_would_do() {
    let scenario = near_a_corner(45.0);
    let why = infeasible(&scenario);
    has_whole_shares(&why);
    assert!(why.searched_twice && !why.ended_early && why.library.is_none());
    let share = nearest(&why).load_share.unwrap();
    assert!((0.3..1.0).contains(&share), "{why}");
    // The compliant load factor is nearly the inverse of the load: the weight is small.
    assert!((share * nearest(&why).required / nearest(&why).load_factor - 1.0).abs() < 0.1, "{why}");
    let less = near_a_corner(45.0 * share);
    verified(&plan(&less), &less);
}

#[test]
fn the_nearest_miss_tells_the_grip_and_the_friction_that_would_do() {
    let mut scenario = fast("quickstart");
    // Nothing but the grip is in the way.
    scenario.limits.deflection_mm = 50.0;
    scenario.grip.force_n = 1.5;
    let why = infeasible(&scenario);
    let NearMiss { grip_force, friction, .. } = *nearest(&why);
    let Remedy { now, enough } = grip_force.unwrap();
    assert!(now == 1.5 && enough > 1.5, "{why}");
    assert!(why.to_string().contains(&format!("a grip force of {enough:.1} N instead of 1.5 N")), "{why}");
    // That grasp resists the load then. To stay clear of itself under it the robot may need another one, which a quarter more
    // leaves room for.
    let mut stronger = scenario.clone();
    stronger.grip.force_n = 1.25 * enough;
    verified(&plan(&stronger), &stronger);
    if let Some(Remedy { enough, .. }) = friction {
        assert!(enough > scenario.grip.friction, "{why}");
        scenario.grip.friction = 1.25 * enough;
        verified(&plan(&scenario), &scenario);
    }
}

#[test]
fn a_limit_of_evaluations_gives_no_second_search_and_no_share_above_the_whole() {
    for evaluations in [1, 3, 50, 4_100] {
        let mut scenario = near_a_corner(45.0);
        scenario.planner.evaluations = Some(evaluations);
        let why = infeasible(&scenario);
        assert!(why.ended_early && !why.searched_twice, "{why}");
        assert!(why.candidates <= evaluations, "{why}");
        if why.candidates > 0 {
            has_whole_shares(&why);
        }
    }
}

#[test]
fn an_empty_library_says_which_test_emptied_it() {
    // A stick: no pad fits on its faces. A wide sheet: both grippers cannot be at its edges.
    for (size_m, expected) in [([0.03, 0.03, 0.03], "pads of the left gripper"), ([3.0, 3.0, 0.03], "does not")] {
        let mut scenario = fast("quickstart");
        scenario.object.size_m = size_m;
        let why = infeasible(&scenario);
        let library = why.library.as_ref().unwrap();
        assert!(library.failed[0].0.contains(expected), "{why}");
        assert!(why.to_string().starts_with("no grasp of this board was found in 40000 draws: "), "{why}");
        assert!(library.failed.iter().map(|(_, draws)| draws).sum::<u64>() == 40_000, "{why}");
    }
}

/// Files cannot ask for it, a program that uses the library can.
#[test]
fn a_force_at_the_end_of_the_range_of_numbers_is_infeasible() {
    for name in ["quickstart", "cut-rim"] {
        for force_n in [1e150, 1e300, f64::MAX] {
            let mut scenario = fast(name);
            let direction_o = scenario.operation.wrench_o.force_n.normalize();
            scenario.operation.wrench_o.force_n = direction_o * force_n;
            let why = infeasible(&scenario);
            assert_eq!(why.removed[0].0, "person's strength", "{why}");
            has_whole_shares(&why);
        }
    }
}
