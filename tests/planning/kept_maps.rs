//! Maps from a store: a plan on them is the plan on fresh ones, bit for bit, and a store may return anything.

use std::{
    collections::BTreeMap,
    sync::{
        Arc, Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use benchdog::{
    model::scenario::{Budget, PostureLimits, Scenario},
    planner::{MapSource, MapStore, Outcome, Planner},
    robot::{Robot, Shape},
};

use crate::{
    common::{baxter, root, scenario},
    serial::pandas,
    shared::{fast, found},
};

/// A store in memory.
#[derive(Default)]
struct Memory {
    maps: Mutex<BTreeMap<String, Vec<u8>>>,
    /// Number of maps that were found.
    found: AtomicUsize,
}

fn inputs(source: &MapSource<'_>) -> String {
    let mut text = String::new();
    source.write_inputs(&mut text).unwrap();
    text
}

impl MapStore for Memory {
    fn read(&self, source: &MapSource<'_>) -> Option<Vec<u8>> {
        let found = self.maps.lock().unwrap().get(&inputs(source)).cloned();
        self.found.fetch_add(usize::from(found.is_some()), Ordering::SeqCst);
        found
    }

    fn write(&self, source: &MapSource<'_>, bytes: &[u8]) {
        self.maps.lock().unwrap().insert(inputs(source), bytes.to_vec());
    }
}

/// A search of a planner, whose result is a text with every digit.
type Search = fn(&Planner, &Scenario) -> String;

fn plan(planner: &Planner, scenario: &Scenario) -> String {
    match planner.plan(scenario).unwrap() {
        Outcome::Found(plan) => serde_json::to_string(&plan).unwrap(),
        Outcome::Infeasible(why) => format!("{why:?}"),
    }
}

fn top(planner: &Planner, scenario: &Scenario) -> String {
    serde_json::to_string(&found(planner.search(scenario).top(2).unwrap())).unwrap()
}

/// The same result without a store, on the maps of a store as they are made, and on those that it kept: `reads` of them.
#[track_caller]
fn is_the_same(robot: &Robot, scenario: &Scenario, search: Search, reads: usize) -> String {
    let fresh = search(&Planner::new(robot), scenario);
    let store = Arc::new(Memory::default());
    let with_store = || search(&Planner::with_store(robot, store.clone()), scenario);
    assert_eq!(with_store(), fresh);
    assert_eq!(store.found.load(Ordering::SeqCst), 0);
    assert_eq!(with_store(), fresh);
    assert_eq!(store.found.load(Ordering::SeqCst), reads);
    fresh
}

/// The quickstart with any posture, whose warm starts take a third of the time.
fn warm() -> Scenario {
    let mut scenario = scenario("quickstart");
    scenario.human.posture = PostureLimits::UNRESTRICTED;
    scenario
}

#[test]
fn plans_on_kept_maps_are_those_on_fresh_ones() {
    // Warm starts alone: the grasps are not read.
    is_the_same(baxter(), &warm(), plan, 1);
    // The library, the warm starts and the screening of both.
    is_the_same(baxter(), &warm(), top, 2);
    // The library alone.
    is_the_same(baxter(), &fast("cut-rim"), plan, 1);
}

/// A normalised objective has the warm starts of three families.
/// What is simulated, and what is expected of it, is no part of a plan: the maps are found again.
#[test]
fn another_simulation_needs_no_maps_of_its_own() {
    let store = Arc::new(Memory::default());
    let planned = |scenario: &Scenario| plan(&Planner::with_store(baxter(), store.clone()), scenario);
    let scenario = warm();
    planned(&scenario);
    let mut other = scenario.clone();
    other.uncertainty.friction_scale = 0.9;
    other.simulation.hold_s *= 2.0;
    other.expect.probability = Some(0.9);
    other.sweep = Some(benchdog::scenario::usual_sweep(&scenario, baxter()).unwrap());
    let before = store.maps.lock().unwrap().len();
    planned(&other);
    assert_eq!((store.maps.lock().unwrap().len(), store.found.load(Ordering::SeqCst)), (before, 1));
}

#[test]
fn a_normalised_objective_has_the_same_optima_on_kept_maps() {
    let mut scenario = warm();
    scenario.comfort.peripersonal_share = Some(0.4);
    is_the_same(baxter(), &scenario, plan, 3);
}

/// The second search draws further grasps, which are kept too.
#[test]
fn a_search_that_finds_nothing_tells_the_same_on_kept_maps() {
    let mut scenario = fast("quickstart");
    scenario.operation.wrench_o.force_n *= 100.0;
    let told = is_the_same(baxter(), &scenario, plan, 2);
    assert!(told.contains("searched_twice: true"), "{told}");
}

/// A board without an edge for the pads has an empty library: what its draws failed at is kept.
#[test]
fn an_empty_library_tells_the_same_on_kept_maps() {
    let mut scenario = fast("quickstart");
    scenario.object.size_m = [0.03, 0.03, 0.03];
    scenario.limits.clearance_mm = 0.0;
    let told = is_the_same(baxter(), &scenario, plan, 2);
    assert!(told.contains("lie partly off the board"), "{told}");
}

#[test]
fn robots_with_one_and_three_arms_have_the_same_plans_on_kept_maps() {
    let at = |x_m: f64, y_m: f64, yaw_rad: f64| [[x_m, y_m, 0.0], [0.0, 0.0, yaw_rad]];
    let mut scenario = fast("quickstart");
    scenario.operation.wrench_o.force_n *= 0.4;
    scenario.grip.force_n = 60.0;
    is_the_same(&pandas(&[at(0.0, 0.0, 0.0)]), &scenario, plan, 1);
    let three = [at(0.45, 0.6, -1.57), at(0.0, 0.0, 0.0), at(0.45, -0.6, 1.57)];
    is_the_same(&pandas(&three), &scenario, plan, 1);
}

/// A store that returns what it likes.
struct Wrong(Vec<u8>);

impl MapStore for Wrong {
    fn read(&self, _: &MapSource<'_>) -> Option<Vec<u8>> {
        Some(self.0.clone())
    }

    fn write(&self, _: &MapSource<'_>, _: &[u8]) {}
}

/// Bytes that are no map, and maps of another robot or another kind, are as good as none.
#[test]
fn what_is_no_map_of_this_robot_is_made_anew() {
    let (baxters, ur5) = (fast("cut-rim"), Robot::load("dual-ur5", root()).unwrap());
    let store = Arc::new(Memory::default());
    Planner::with_store(&ur5, store.clone()).prepare(&scenario("dual-ur5")).unwrap();
    let mut all: Vec<_> = store.maps.lock().unwrap().values().cloned().collect();
    assert_eq!(all.len(), 2, "the grasps and the warm starts");
    all.extend([Vec::new(), vec![0xff; 1_000], vec![0; 1_000]]);
    let fresh = plan(&Planner::new(baxter()), &baxters);
    for bytes in all {
        let length = bytes.len();
        assert_eq!(plan(&Planner::with_store(baxter(), Arc::new(Wrong(bytes))), &baxters), fresh, "{length} bytes");
    }
}

/// What a map is made from changes its source to the last bit; names of files do not.
#[test]
fn the_source_of_a_map_has_every_input() {
    let (robot, scenario) = (baxter(), scenario("quickstart"));
    let written = |robot: &Robot, scenario: &Scenario| {
        let store = Arc::new(Memory::default());
        let mut scenario = scenario.clone();
        scenario.planner.budget = Budget::Fast;
        Planner::with_store(robot, store.clone()).prepare_library(&scenario);
        let keys: Vec<_> = store.maps.lock().unwrap().keys().cloned().collect();
        keys.concat()
    };
    let board = scenario.object.shape();
    let source = |robot: &Robot, scenario: &Scenario| {
        let clearance_m = scenario.limits.clearance_m();
        let kind = benchdog::planner::MapKind::WarmStarts;
        inputs(&MapSource { kind, robot, board: &board, clearance_m, task: Some(scenario) })
    };
    // What the planner asks for is such a source.
    assert!(written(robot, &scenario).starts_with("Grasps "));
    let own = source(robot, &scenario);
    let next = |value: &mut f64| *value = value.next_up();
    let robots: [fn(&mut Robot); 6] = [
        |robot| robot.joints[3].upper = robot.joints[3].upper.next_up(),
        |robot| robot.joints[3].rest = robot.joints[3].rest.next_up(),
        |robot| robot.body_points[0].p_l.x = robot.body_points[0].p_l.x.next_up(),
        |robot| robot.arms[1].effort_nm[0] = robot.arms[1].effort_nm[0].next_up(),
        |robot| robot.floor_z_m = robot.floor_z_m.next_up(),
        |robot| {
            let shape = robot.links.iter_mut().find_map(|link| link.shapes.first_mut()).unwrap();
            shape.shape = Shape::Sphere { radius_m: 0.1 };
        },
    ];
    for (number, change) in robots.into_iter().enumerate() {
        let mut other = robot.clone();
        change(&mut other);
        assert_ne!(source(&other, &scenario), own, "robot {number}");
    }
    let scenarios: [&dyn Fn(&mut Scenario); 5] = [
        &|scenario| next(&mut scenario.operation.wrench_o.force_n.z),
        &|scenario| next(&mut scenario.limits.clearance_mm),
        &|scenario| next(&mut scenario.human.height_m),
        &|scenario| scenario.planner.seed += 1,
        &|scenario| scenario.comfort.peripersonal_share = Some(0.5),
    ];
    for (number, change) in scenarios.into_iter().enumerate() {
        let mut other = scenario.clone();
        change(&mut other);
        assert_ne!(source(robot, &other), own, "scenario {number}");
    }
    let mut elsewhere = robot.clone();
    elsewhere.description = "/elsewhere/baxter.toml".into();
    elsewhere.files = vec!["/elsewhere/baxter.urdf".into()];
    elsewhere.links[0].visuals.clear();
    let mut renamed = scenario.clone();
    renamed.name = "another".into();
    renamed.robot.description = "/elsewhere/baxter.toml".into();
    assert_eq!(source(&elsewhere, &renamed), own);
}
