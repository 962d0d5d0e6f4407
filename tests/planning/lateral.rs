//! Plans for a person who also pushes sideways.

use benchdog::{
    check::CheckedPlan,
    judge::judge,
    model::{lateral::DIRECTIONS, plan::Plan, scenario::Scenario, verdict::VerdictKind},
    planner::Outcome,
    sim::{Conditions, LateralDirection, simulate},
};

use crate::{
    clearance::drawn,
    common::baxter,
    shared::{PLANNER, verified},
};

/// The share of the thrust that people push sideways with a hammer drill (docs/method.md#614-sideways-push).
const SHARE: f64 = 0.13;

/// Simulates a plan pushed in some direction; by default the worst.
fn verdict(scenario: &Scenario, plan: &Plan, direction_deg: Option<f64>) -> VerdictKind {
    let checked = CheckedPlan::new(baxter(), plan, &scenario.human, &scenario.tool).unwrap();
    let worst = Conditions::of(scenario);
    let lateral_direction = direction_deg.map_or(worst.lateral_direction, LateralDirection::Given);
    let trace = simulate(&checked, &Conditions { lateral_direction, ..worst }).unwrap();
    judge(&trace, &scenario.limits).verdict
}

fn pushed(scenario: &Scenario) -> Scenario {
    let mut pushed = scenario.clone();
    pushed.load.lateral_share = SHARE;
    pushed
}

#[test]
fn a_plan_with_a_push_holds_whatever_its_direction() {
    let mut found = 0;
    for scenario in drawn(4).iter().map(pushed) {
        let Outcome::Found(plan) = PLANNER.plan(&scenario).unwrap() else { continue };
        verified(&plan, &scenario);
        let stability = plan.stability.as_ref().unwrap();
        let push = stability.lateral.unwrap();
        let size_n = nalgebra::Vector3::from(push.force_o_n).norm();
        assert!((size_n - SHARE * plan.operation.wrench_o.force_n.norm()).abs() < 1e-9, "{push}");
        // The safety factor, and the tolerance of the compliant load factor.
        assert!(stability.compliant_load_factor > 1.1 - 1e-3, "{}: {stability:?}", scenario.name);
        for number in 0..DIRECTIONS {
            let direction_deg = 360.0 * number as f64 / DIRECTIONS as f64;
            let verdict = verdict(&scenario, &plan, Some(direction_deg));
            assert_eq!(verdict, VerdictKind::Holds, "{} at {direction_deg} degrees", scenario.name);
        }
        found += 1;
    }
    assert!(found >= 3, "{found}");
}

/// The plan of the third cut of the evaluation resists 1.1 times its load, and a push of 13 % turns a hand on the board.
#[test]
fn a_plan_without_a_push_need_not_hold_with_one() {
    let operations = benchdog::reproduce::paper::operations();
    let cut = operations.iter().find(|operation| operation.name == "cut-03").unwrap();
    let scenario = cut.load().unwrap().scenario;
    let Outcome::Found(plan) = PLANNER.plan(&scenario).unwrap() else { panic!("a cut of the evaluation has a plan") };
    assert_eq!(plan.stability.as_ref().unwrap().lateral, None);
    assert_eq!(verdict(&scenario, &plan, None), VerdictKind::Holds);
    assert_ne!(verdict(&pushed(&scenario), &plan, None), VerdictKind::Holds);
    // Its verification under the other scenario tells so, and that the push is missing.
    let flaws = crate::shared::flaws(&plan, &pushed(&scenario));
    assert!(!flaws.is_empty());
}
