//! The planner: a plan satisfies every constraint, is better than a random one, and is the same bytes for the same seed.

use benchdog::{
    model::{
        operation::Operation,
        plan::{Plan, RebaScore, RulaScore},
        scenario::{Budget, Optima, PlannerKind, Scenario, StabilityKind},
    },
    planner::{Outcome, Planner},
    reproduce::paper,
};
use rayon::prelude::*;

use crate::{
    common::{baxter, scenario},
    shared::{PLANNER, fast, flaws, plan, plan_by, verified},
};

#[test]
fn plans_satisfy_every_constraint() {
    for name in ["quickstart", "cut-rim"] {
        let scenario = scenario(name);
        verified(&plan(&scenario), &scenario);
    }
}

#[test]
fn the_check_finds_what_was_changed() {
    let scenario = scenario("quickstart");
    let good = plan(&scenario);
    let flaws = |spoil: &dyn Fn(&mut Plan)| {
        let mut plan = good.clone();
        spoil(&mut plan);
        flaws(&plan, &scenario).join("; ")
    };
    assert!(flaws(&|plan| plan.arms[0].q_rad[6] += 1e-3).contains("arms[0].x_og: found the gripper"));
    assert!(flaws(&|plan| plan.human.as_mut().unwrap().q_rad[3] += 1e-3).contains("human.q_rad: found the tool"));
    assert!(flaws(&|plan| plan.human.as_mut().unwrap().x_wb.translation.z += 0.1).contains("off the floor"));
    assert!(flaws(&|plan| plan.comfort.as_mut().unwrap().peripersonal_m += 0.01).contains("peripersonal_m"));
    let rula =
        |change: fn(&mut RulaScore)| flaws(&|plan| change(plan.comfort.as_mut().unwrap().rula.as_mut().unwrap()));
    assert!(rula(|rula| rula.arm_and_wrist += 1).contains("comfort.rula.arm_and_wrist: found"));
    let reba =
        |change: fn(&mut RebaScore)| flaws(&|plan| change(plan.comfort.as_mut().unwrap().reba.as_mut().unwrap()));
    assert!(reba(|reba| reba.score += 1).contains("comfort.reba.score: found"));
    assert!(flaws(&|plan| plan.operation.wrench_o.force_n *= 10.0).contains("does not resist the load"));
    assert!(flaws(&|plan| plan.stability = None).contains("stability: found nothing"));
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
fn every_planner_satisfies_every_constraint_and_is_best_at_its_own_comfort() {
    let scenario = scenario("quickstart");
    let [comfort, peripersonal, muscular, random] = PlannerKind::ALL.map(|kind| {
        let scenario = with_kind(&scenario, kind);
        let plan = plan(&scenario);
        verified(&plan, &scenario);
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
    let operations: Vec<_> = paper::printed_operations().iter().map(|operation| operation.load().unwrap()).collect();
    // Before the threads ask for it.
    let planner = &*PLANNER;
    let infeasible: Vec<_> = PlannerKind::ALL
        .into_par_iter()
        .flat_map_iter(|kind| {
            let mut infeasible = Vec::new();
            for loaded in &operations {
                let mut scenario = with_kind(&loaded.scenario, kind);
                scenario.planner.stability = StabilityKind::Paper;
                match planner.plan(&scenario).unwrap() {
                    Outcome::Found(plan) => assert!(plan.stability.unwrap().load_factor >= 1.0),
                    Outcome::Infeasible(why) => infeasible.push(format!("{kind} {}: {why}", scenario.name)),
                }
            }
            infeasible
        })
        .collect();
    assert_eq!(infeasible, [""; 0]);
}

#[test]
fn the_reference_stability_of_the_paper_can_be_asked_for() {
    let mut scenario = fast("cut-rim");
    scenario.planner.stability = StabilityKind::Paper;
    let plan = plan(&scenario);
    verified(&plan, &scenario);
    assert!(plan.stability.unwrap().load_factor >= 1.0);
}

#[test]
fn a_larger_budget_is_never_worse_and_kept_maps_change_nothing() {
    let mut scenario = scenario("quickstart");
    let mut objective = |evaluations| {
        scenario.planner.evaluations = evaluations;
        let Outcome::Found(plan) = PLANNER.plan(&scenario).unwrap() else { return 0.0 };
        assert!(evaluations.is_none_or(|most| plan.planner.unwrap().evaluations <= most));
        plan.comfort.unwrap().objective
    };
    // The search is the same up to where it is cut off.
    let objectives = [Some(10), Some(60), Some(150), None].map(&mut objective);
    assert!(objectives.is_sorted(), "{objectives:?}");
    assert_eq!(plan_by(&Planner::new(baxter()), &scenario).comfort.unwrap().objective, objectives[3]);
}

/// The objective at one seed against the best known, which a hundred times the budget found at other seeds, for four of the
/// paper's cuts.
#[test]
fn the_default_budget_comes_near_the_best_known_objective() {
    let scenario = scenario("cut-rim");
    let [_, _, thickness_m] = scenario.object.size_m;
    for (angle_deg, best_known, least) in
        [(0.0_f64, 86.7, 0.985), (180.0, 86.7, 0.985), (157.5, 86.0, 0.985), (270.0, 89.7, 0.985)]
    {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let mut scenario = scenario.clone();
        let direction_o = nalgebra::Vector3::new(-sin, cos, 0.0);
        scenario.operation = Operation::cut([0.12 * cos, 0.12 * sin], direction_o, 30.0, thickness_m);
        let plan = plan(&scenario);
        let share = plan.comfort.unwrap().objective / best_known;
        // Of 25 operations a single seed reaches 0.99 for 24 or 25, and 0.987 for the rest.
        assert!(share > least, "at {angle_deg} degrees: {share}");
    }
}

/// Warm starts serve all tasks of a family, and a plan does not depend on which task they were made for nor on the number of
/// threads.
#[test]
fn warm_starts_serve_a_task_family_and_change_nothing() {
    let scenario = scenario("cut-rim");
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
    let [warm, cold] = [(); 2].map(|()| Planner::new(baxter()));
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    one_thread.install(|| warm.prepare(&first)).unwrap();
    let json = |planner: &Planner| serde_json::to_string(&plan_by(planner, &other)).unwrap();
    assert_eq!(json(&warm), json(&cold));
}

#[test]
fn more_weight_on_a_comfort_gives_more_of_it() {
    let mut scenario = fast("quickstart");
    scenario.comfort.weight_peripersonal = 0.0;
    let muscular = plan(&scenario).comfort.unwrap();
    scenario.comfort.weight_peripersonal = 1000.0;
    scenario.comfort.weight_muscular = 0.0;
    let peripersonal = plan(&scenario).comfort.unwrap();
    assert!(muscular.muscular_regularised > peripersonal.muscular_regularised);
    assert!(peripersonal.peripersonal_m > muscular.peripersonal_m);
}

/// A normalised objective divides each comfort by what its own planner reaches; the plan states these optima, so that it can
/// be checked by itself.
#[test]
fn a_normalised_objective_is_relative_to_the_optima_of_each_comfort() {
    let mut scenario = fast("cut-rim");
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
    verified(&normalised, &used);
    // Optima that are given are taken as they are.
    let given = Optima { muscular_regularised: 2.0 * optima.muscular_regularised, ..optima };
    scenario.comfort.optima = Some(given);
    assert_eq!(plan(&scenario).scenario.unwrap().comfort.optima, Some(given));
}

#[test]
fn a_load_beyond_anyones_strength_is_infeasible_and_says_so() {
    let mut scenario = fast("quickstart");
    scenario.operation.wrench_o.force_n *= 100.0;
    match PLANNER.plan(&scenario).unwrap() {
        Outcome::Infeasible(why) => assert_eq!(why.removed[0].0, "person's strength", "{why}"),
        Outcome::Found(plan) => panic!("nobody drills with 1500 N: {:?}", plan.comfort),
    }
}

#[test]
fn a_limit_of_a_score_filters_finished_plans_and_is_named() {
    let mut scenario = fast("quickstart");
    let free = plan(&scenario);
    let comfort = free.comfort.unwrap();
    let (rula, reba) = (comfort.rula.unwrap(), comfort.reba.unwrap());
    // A plan that is at its limits is the best one still.
    scenario.limits.rula = Some(rula.score);
    scenario.limits.rula_arm = Some(rula.arm_and_wrist);
    scenario.limits.reba = Some(reba.score);
    assert_eq!(plan(&scenario).object, free.object);
    // Below it, another plan is chosen or none is left.
    scenario.limits.rula_arm = Some(rula.arm_and_wrist - 1);
    let key = "comfort.rula.arm_and_wrist: found";
    assert!(flaws(&free, &scenario).iter().any(|flaw| flaw.starts_with(key)));
    match PLANNER.plan(&scenario).unwrap() {
        Outcome::Found(plan) => verified(&plan, &scenario),
        Outcome::Infeasible(why) => {
            assert!(why.removed.iter().any(|(what, _)| *what == "RULA score of arm and wrist"), "{why}");
        }
    }
}
