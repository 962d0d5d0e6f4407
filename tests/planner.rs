//! The planner's promises: a plan keeps every constraint, a better objective than chance, the same bytes for a seed.

use std::path::Path;

use benchdog::{
    model::{
        operation::Operation,
        plan::Plan,
        scenario::{Budget, Optima, PlannerKind, Scenario, StabilityKind},
    },
    planner::{self, PlanOutcome, RobotMap, WorkMap},
    robot::Robot,
    scenario::{self, paper},
};
use rayon::prelude::*;

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

/// A scenario under another planner, whose budget is the fast one.
fn with_kind(scenario: &Scenario, kind: PlannerKind) -> Scenario {
    let mut scenario = scenario.clone();
    scenario.planner.kind = kind;
    scenario.planner.budget = Budget::Fast;
    scenario
}

#[test]
fn every_planner_keeps_every_constraint_and_is_best_at_its_own_comfort() {
    let (scenario, robot) = load("quickstart");
    let map = RobotMap::new(&robot, scenario.object.size_m);
    let [comfort, peripersonal, muscular, random] = PlannerKind::ALL.map(|kind| {
        let scenario = with_kind(&scenario, kind);
        let PlanOutcome::Found(plan) = planner::plan_on(&scenario, &map).unwrap() else { panic!("{kind}: no plan") };
        assert_eq!(planner::verify(&plan, &scenario, &robot).unwrap(), [], "{kind}");
        assert_eq!(plan.planner.unwrap().kind, kind);
        plan.comfort.unwrap()
    });
    for other in [peripersonal, random] {
        assert!(muscular.muscular_regularised > other.muscular_regularised, "{muscular:?} {other:?}");
    }
    for other in [muscular, random] {
        assert!(peripersonal.peripersonal_m > other.peripersonal_m, "{peripersonal:?} {other:?}");
        assert!(comfort.objective > other.objective, "{comfort:?} {other:?}");
    }
    assert!(comfort.objective > peripersonal.objective);
}

/// With compliant arms `results/plans.csv` shows it; here by the paper's stability, in the fast budget.
#[test]
fn every_operation_has_a_plan_of_every_planner_by_the_papers_stability_too() {
    let operations: Vec<_> = paper::operations().iter().map(|operation| operation.load().unwrap()).collect();
    let map = RobotMap::new(&operations[0].robot, operations[0].scenario.object.size_m);
    let infeasible: Vec<_> = PlannerKind::ALL
        .into_par_iter()
        .flat_map_iter(|kind| {
            let mut maps: Vec<WorkMap> = Vec::new();
            let mut infeasible = Vec::new();
            for loaded in &operations {
                let mut scenario = with_kind(&loaded.scenario, kind);
                scenario.planner.stability = StabilityKind::Paper;
                if !maps.iter().any(|work| work.serves(&scenario)) {
                    maps.push(WorkMap::new(&scenario, &map).unwrap());
                }
                let work = maps.iter().find(|work| work.serves(&scenario)).unwrap();
                match planner::plan_with(&scenario, &map, work, &mut planner::nobody).unwrap() {
                    PlanOutcome::Found(plan) => assert!(plan.stability.unwrap().load_factor >= 1.0),
                    PlanOutcome::Infeasible(why) => infeasible.push(format!("{kind} {}: {why}", scenario.name)),
                }
            }
            infeasible
        })
        .collect();
    assert_eq!(infeasible, [""; 0]);
}

#[test]
fn the_reference_stability_of_the_paper_can_be_asked_for() {
    let (mut scenario, robot) = load("cut-rim");
    scenario.planner.stability = StabilityKind::Paper;
    scenario.planner.budget = Budget::Fast;
    let plan = plan(&scenario, &robot);
    assert_eq!(planner::verify(&plan, &scenario, &robot).unwrap(), []);
    assert!(plan.stability.unwrap().load_factor >= 1.0);
}

#[test]
fn more_work_is_never_worse_and_a_map_at_hand_changes_nothing() {
    let (mut scenario, robot) = load("quickstart");
    let map = RobotMap::new(&robot, scenario.object.size_m);
    let mut objective = |evaluations| {
        scenario.planner.evaluations = evaluations;
        let PlanOutcome::Found(plan) = planner::plan_on(&scenario, &map).unwrap() else { return 0.0 };
        assert!(evaluations.is_none_or(|most| plan.planner.unwrap().evaluations <= most));
        plan.comfort.unwrap().objective
    };
    // The search is the same up to where it is cut off.
    let objectives = [Some(10), Some(60), Some(150), None].map(&mut objective);
    assert!(objectives.is_sorted(), "{objectives:?}");
    assert_eq!(plan(&scenario, &robot).comfort.unwrap().objective, objectives[3]);
}

/// What the search comes to at one seed, against what a hundred times the work at other seeds found: the best known
/// objectives of three of the paper's operations, in this model of person and robot.
#[test]
fn a_default_search_comes_near_the_best_that_is_known() {
    let (scenario, robot) = load("cut-rim");
    let map = RobotMap::new(&robot, scenario.object.size_m);
    let [_, _, thickness_m] = scenario.object.size_m;
    for (angle_deg, best_known, least) in
        [(0.0_f64, 138.8, 0.98), (180.0, 138.8, 0.98), (157.5, 142.2, 0.99), (270.0, 140.8, 0.98)]
    {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let mut scenario = scenario.clone();
        let direction_o = nalgebra::Vector3::new(-sin, cos, 0.0);
        scenario.operation = Operation::cut([0.12 * cos, 0.12 * sin], direction_o, 30.0, thickness_m);
        let PlanOutcome::Found(plan) = planner::plan_on(&scenario, &map).unwrap() else { panic!("no plan") };
        let share = plan.comfort.unwrap().objective / best_known;
        // Single seeds were found between 0.984 and 1. At 157.5 degrees holds that are easier to find are worth 0.985.
        assert!(share > least, "at {angle_deg} degrees: {share}");
    }
}

/// A map of the kind of work serves whatever differs in place and direction alone, and a plan does not tell who made it, nor
/// with how many threads.
#[test]
fn one_map_of_the_work_serves_all_directions_and_changes_nothing() {
    let (scenario, robot) = load("cut-rim");
    let map = RobotMap::new(&robot, scenario.object.size_m);
    let [_, _, thickness_m] = scenario.object.size_m;
    let cut = |angle_deg: f64| {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let direction_o = nalgebra::Vector3::new(-sin, cos, 0.0);
        let operation = Operation::cut([0.12 * cos, 0.12 * sin], direction_o, 30.0, thickness_m);
        let mut scenario = Scenario { operation, ..scenario.clone() };
        scenario.planner.budget = Budget::Default;
        scenario
    };
    let (first, other) = (cut(0.0), cut(112.5));
    assert!(planner::same_work(&first, &other));
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let work = alone.install(|| WorkMap::new(&first, &map)).unwrap();
    let json = |outcome| match outcome {
        PlanOutcome::Found(plan) => serde_json::to_string(&plan).unwrap(),
        PlanOutcome::Infeasible(why) => panic!("{why}"),
    };
    let with = planner::plan_with(&other, &map, &work, &mut planner::nobody).unwrap();
    assert_eq!(json(with), json(planner::plan_on(&other, &map).unwrap()));
    // Another force, another person, another seed: other work.
    let mut heavier = other.clone();
    heavier.operation.wrench_o.force_n *= 1.1;
    let mut taller = other.clone();
    taller.human.height_m += 0.05;
    let mut seeded = other.clone();
    seeded.planner.seed += 1;
    for stranger in [&heavier, &taller, &seeded] {
        assert!(!work.serves(stranger));
    }
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

/// A normalised objective is over what the planners of either comfort alone reach; the plan carries that, so that it can be
/// checked by itself.
#[test]
fn a_normalised_objective_is_over_what_either_comfort_alone_reaches() {
    let (mut scenario, robot) = load("cut-rim");
    scenario.planner.budget = Budget::Fast;
    let map = RobotMap::new(&robot, scenario.object.size_m);
    let plan = |scenario: &Scenario| match planner::plan_on(scenario, &map).unwrap() {
        PlanOutcome::Found(plan) => *plan,
        PlanOutcome::Infeasible(why) => panic!("{why}"),
    };
    let alone = [PlannerKind::Muscular, PlannerKind::Peripersonal].map(|kind| plan(&with_kind(&scenario, kind)));
    let [muscular, peripersonal] = alone.map(|plan| plan.comfort.unwrap());
    scenario.comfort.peripersonal_share = Some(0.4);
    let normalised = plan(&scenario);
    let used = normalised.scenario.clone().unwrap();
    let optima = used.comfort.optima.unwrap();
    // The same searches; a weight other than 1 only scales what they maximise.
    assert!((optima.muscular_regularised / muscular.muscular_regularised - 1.0).abs() < 1e-6);
    assert!((optima.peripersonal_m / peripersonal.peripersonal_m - 1.0).abs() < 1e-6);
    let comfort = normalised.comfort.unwrap();
    let shares =
        [comfort.muscular_regularised / optima.muscular_regularised, comfort.peripersonal_m / optima.peripersonal_m];
    assert!((comfort.objective - (60.0 * shares[0] + 40.0 * shares[1])).abs() < 1e-9);
    assert_eq!(planner::verify(&normalised, &used, &robot).unwrap(), []);
    // Optima that are given are taken as they are.
    let given = Optima { muscular_regularised: 2.0 * optima.muscular_regularised, ..optima };
    scenario.comfort.optima = Some(given);
    assert_eq!(plan(&scenario).scenario.unwrap().comfort.optima, Some(given));
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
