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
        let plan = plan(&scenario, &robot);
        assert_eq!(planner::verify(&plan, &scenario, &robot).unwrap(), [], "{name}");
    }
}

#[test]
fn a_spoilt_plan_is_found_out() {
    let (scenario, robot) = load("quickstart");
    let good = plan(&scenario, &robot);
    let flaws = |spoil: &dyn Fn(&mut Plan)| {
        let mut plan = good.clone();
        spoil(&mut plan);
        let flaws = planner::verify(&plan, &scenario, &robot).unwrap();
        flaws.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
    };
    assert!(flaws(&|plan| plan.arms[0].q_rad[6] += 1e-3).contains("off its grasp"));
    assert!(flaws(&|plan| plan.human.as_mut().unwrap().q_rad[3] += 1e-3).contains("off the operation"));
    assert!(flaws(&|plan| plan.human.as_mut().unwrap().x_wb.translation.z += 0.1).contains("off the floor"));
    assert!(flaws(&|plan| plan.comfort.as_mut().unwrap().peripersonal_m += 0.01).contains("peripersonal_m"));
    assert!(flaws(&|plan| plan.operation.wrench_o.force_n *= 10.0).contains("does not stand the load"));
    assert!(flaws(&|plan| plan.stability = None).contains("states no stability"));
    // The person walks into the robot, board and all.
    assert!(flaws(&|plan| plan.human.as_mut().unwrap().x_wb.translation.vector.fill(0.0)).contains("mm from"));
}

#[test]
fn more_weight_on_a_comfort_gives_more_of_it() {
    let (mut scenario, robot) = load("quickstart");
    scenario.comfort.weight_peripersonal = 0.0;
    let muscular = plan(&scenario, &robot).comfort.unwrap();
    scenario.comfort.weight_peripersonal = 1000.0;
    scenario.comfort.weight_muscular = 0.0;
    let peripersonal = plan(&scenario, &robot).comfort.unwrap();
    assert!(muscular.muscular_regularised > peripersonal.muscular_regularised);
    assert!(peripersonal.peripersonal_m > muscular.peripersonal_m);
}

#[test]
fn a_load_beyond_anyones_strength_is_infeasible_and_says_so() {
    let (mut scenario, robot) = load("quickstart");
    scenario.operation.wrench_o.force_n *= 100.0;
    match planner::plan(&scenario, &robot).unwrap() {
        PlanOutcome::Infeasible(why) => assert_eq!(why.removed[0].0, "person's strength", "{why}"),
        PlanOutcome::Found(plan) => panic!("nobody drills with 1500 N: {:?}", plan.comfort),
    }
}
