//! Effect of a scenario's `[comfort]` and the person's lean on the plan and its verification.

use benchdog::model::{plan::MeanComfort, scenario::ResponseKind};

use crate::shared::{fast, flaws, plan, verified};

#[test]
fn the_objective_of_a_mean_scenario_is_that_of_the_mean_response() {
    let mut scenario = fast("cut-rim");
    scenario.comfort.person = ResponseKind::Mean;
    let plan = plan(&scenario);
    verified(&plan, &scenario);
    let comfort = plan.comfort.unwrap();
    let MeanComfort { responses, muscular_regularised, peripersonal_m } = comfort.average.unwrap();
    assert!(responses > 100);
    // The default weights; rounding of one sum.
    assert!((comfort.objective - (muscular_regularised + 64.0 * peripersonal_m)).abs() < 1e-12);
    // The posture in the plan is the best response that the search found.
    let of_posture = comfort.muscular_regularised + 64.0 * comfort.peripersonal_m;
    assert!(of_posture > comfort.objective);

    let mut changed = plan;
    let average = MeanComfort { responses, muscular_regularised: 1.01 * muscular_regularised, peripersonal_m };
    changed.comfort.as_mut().unwrap().average = Some(average);
    assert!(flaws(&changed, &scenario)[0].starts_with("comfort.average.muscular_regularised: found "));
}

#[test]
fn a_saturated_metric_and_a_leaning_person_pass_the_check() {
    let mut scenario = fast("cut-rim");
    scenario.comfort.saturation_m = Some(0.4);
    scenario.human.lean_deg = 10.0;
    let plan = plan(&scenario);
    verified(&plan, &scenario);
    let comfort = plan.comfort.unwrap();
    assert!(comfort.peripersonal_m <= 0.4);
    assert_eq!(comfort.peripersonal_scaled, Some(64.0 * comfort.peripersonal_m));
    // A trunk that leans scores 2 in table B.
    assert!(comfort.rula.unwrap().neck_trunk_legs >= 2);
    assert_eq!(plan.human.unwrap().lean_deg, 10.0);
    // Without saturation the plan's comfort is different.
    scenario.comfort.saturation_m = None;
    assert!(flaws(&plan, &scenario)[0].starts_with("comfort.peripersonal_m: found "));
}
