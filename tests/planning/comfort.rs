//! How a scenario's `[comfort]` and the person's lean reach the plan and the check of it.

use std::path::Path;

use benchdog::{
    model::{
        plan::{MeanComfort, Plan},
        scenario::ResponseKind,
    },
    planner::{self, Outcome, Planner},
    robot::Robot,
    scenario::{self, LoadedScenario},
};

fn cut() -> LoadedScenario {
    scenario::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/cut-rim.toml")).unwrap()
}

fn plan(loaded: &LoadedScenario) -> Plan {
    match Planner::new(&loaded.robot).plan(&loaded.scenario).unwrap() {
        Outcome::Found(plan) => plan,
        Outcome::Infeasible(why) => panic!("{why}"),
    }
}

fn flaws(plan: &Plan, loaded: &LoadedScenario) -> Vec<String> {
    let robot: &Robot = &loaded.robot;
    planner::verify(plan, &loaded.scenario, robot).iter().map(ToString::to_string).collect()
}

#[test]
fn the_mean_answer_is_the_objective_of_a_scenario_that_asks_for_it() {
    let mut loaded = cut();
    loaded.scenario.comfort.person = ResponseKind::Mean;
    let plan = plan(&loaded);
    assert_eq!(flaws(&plan, &loaded), [""; 0]);
    let comfort = plan.comfort.unwrap();
    let MeanComfort { responses, muscular_regularised, peripersonal_m } = comfort.average.unwrap();
    assert!(responses > 100);
    // The default weights; rounding of one sum.
    assert!((comfort.objective - (muscular_regularised + 64.0 * peripersonal_m)).abs() < 1e-12);
    // The posture in the plan is the best answer that the search found, not a middling one.
    let of_posture = comfort.muscular_regularised + 64.0 * comfort.peripersonal_m;
    assert!(of_posture > comfort.objective);

    let mut spoiled = plan;
    let average = MeanComfort { responses, muscular_regularised: 1.01 * muscular_regularised, peripersonal_m };
    spoiled.comfort.as_mut().unwrap().average = Some(average);
    assert!(flaws(&spoiled, &loaded)[0].starts_with("comfort.average.muscular_regularised is"));
}

#[test]
fn a_saturated_metric_and_a_leaning_person_pass_the_check() {
    let mut loaded = cut();
    loaded.scenario.comfort.saturation_m = Some(0.4);
    loaded.scenario.human.lean_deg = 10.0;
    let plan = plan(&loaded);
    assert_eq!(flaws(&plan, &loaded), [""; 0]);
    let comfort = plan.comfort.unwrap();
    assert!(comfort.peripersonal_m <= 0.4);
    assert_eq!(comfort.peripersonal_scaled, Some(64.0 * comfort.peripersonal_m));
    // A trunk that leans scores 2 in table B.
    assert!(comfort.rula.unwrap().neck_trunk_legs >= 2);
    assert_eq!(plan.human.unwrap().lean_deg, 10.0);
    // The same plan is another one to a scenario without saturation.
    loaded.scenario.comfort.saturation_m = None;
    assert!(flaws(&plan, &loaded)[0].starts_with("comfort.peripersonal_m is"));
}
