//! The planner's promises: a plan keeps every constraint, a better objective than chance, the same bytes for a seed.

use std::path::Path;

use benchdog::{
    model::{plan::Plan, scenario::Scenario},
    planner::{self, PlanOutcome},
    robot::Robot,
    scenario,
};

fn load(name: &str) -> (Scenario, Robot) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenarios/{name}.toml"));
    let loaded = scenario::load(&path).unwrap();
    (loaded.scenario, loaded.robot)
}

fn plan(scenario: &Scenario, robot: &Robot) -> Plan {
    match planner::plan(scenario, robot).unwrap() {
        PlanOutcome::Found(plan) => *plan,
        PlanOutcome::Infeasible(why) => panic!("{}: {why}", scenario.name),
    }
}

#[test]
fn plans_keep_every_constraint() {
    for name in ["quickstart", "cut-rim"] {
        let (scenario, robot) = load(name);
        let t = std::time::Instant::now();
        let plan = plan(&scenario, &robot);
        eprintln!("TIME {:?}", t.elapsed());
        eprintln!("{:#?} {:#?} {:?}", plan.comfort, plan.stability, plan.planner);
        assert_eq!(planner::verify(&plan, &scenario, &robot).unwrap(), [], "{name}");
    }
}
