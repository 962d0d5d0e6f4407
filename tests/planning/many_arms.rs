//! Robots with one to four arms, all of which hold the board.

use benchdog::{
    model::{
        grasp::grasped_edge,
        plan::Plan,
        scenario::{Budget, Scenario},
    },
    planner::{self, Planner},
};

use crate::{
    common::root,
    serial::{Base, pandas},
    shared::plan_by,
};

/// Bases in a half circle about the board: one, two, three or four.
fn bases(arms: usize) -> Vec<Base> {
    let at = |x_m: f64, y_m: f64, yaw_rad: f64| [[x_m, y_m, 0.0], [0.0, 0.0, yaw_rad]];
    match arms {
        1 => vec![at(0.0, 0.0, 0.0)],
        2 => vec![at(0.0, 0.45, 0.0), at(0.0, -0.45, 0.0)],
        3 => vec![at(0.45, 0.6, -1.57), at(0.0, 0.0, 0.0), at(0.45, -0.6, 1.57)],
        _ => vec![at(0.5, 0.65, -1.57), at(0.0, 0.3, 0.0), at(0.0, -0.3, 0.0), at(0.5, -0.65, 1.57)],
    }
}

/// A hole of a board with the fast budget; one arm can hold it too, at a force that does not turn the board in its pads.
fn fast() -> Scenario {
    let path = root().join("scenarios/quickstart.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("force_n = 15.0"));
    let text = text.replace("force_n = 15.0", "force_n = 6.0");
    let mut scenario = benchdog::scenario::load_text(&path, &text).unwrap().scenario;
    scenario.planner.budget = Budget::Fast;
    scenario.grip.force_n = 60.0;
    scenario
}

fn text(plan: &Plan) -> String {
    serde_json::to_string(plan).unwrap()
}

#[test]
fn one_to_four_arms_find_a_plan() {
    let scenario = fast();
    for arms in 1..=4 {
        let robot = pandas(&bases(arms));
        let plan = plan_by(&Planner::new(&robot), &scenario);
        assert_eq!(plan.arms.len(), arms);
        let flaws = planner::verify(&plan, &scenario, &robot);
        assert!(flaws.is_empty(), "{arms} arms: {flaws:?}");
    }
}

/// The third arm may hold any edge of a plate that is long enough for its pads, and no pad reaches into the hole.
#[test]
fn three_arms_find_a_plan_for_a_plate_with_a_hole() {
    let path = root().join("scenarios/plate-with-hole.toml");
    let mut scenario = benchdog::scenario::load(&path).unwrap().scenario;
    let (of_plate, other) = (scenario.object.clone(), fast());
    (scenario.planner, scenario.grip) = (other.planner, other.grip);
    let robot = pandas(&bases(3));
    let plan = plan_by(&Planner::new(&robot), &scenario);
    assert_eq!((plan.arms.len(), &plan.object.plate), (3, &of_plate.plate));
    let flaws = planner::verify(&plan, &scenario, &robot);
    assert!(flaws.is_empty(), "{flaws:?}");
    let board = plan.object.shape();
    assert!(plan.arms.iter().all(|hold| grasped_edge(&hold.x_og, &board).is_some()));
}

/// Boards of three and more arms are drawn in parallel.
#[test]
fn the_number_of_threads_does_not_change_the_plan() {
    let (scenario, robot) = (fast(), pandas(&bases(3)));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| text(&plan_by(&Planner::new(&robot), &scenario)))
    };
    assert_eq!(with(1), with(3));
}
