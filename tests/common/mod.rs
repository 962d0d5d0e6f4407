//! What the test binaries share: the files of the repository and the built-in robot.

// No binary uses all of it.
#![allow(dead_code)]

pub mod best_known;

use std::{path::Path, sync::LazyLock};

use benchdog::{
    check::CheckedPlan,
    human::default_tool,
    model::{
        plan::Plan,
        scenario::{Person, Scenario},
    },
    robot::Robot,
    scenario,
};

/// The folder of the repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The built-in robot.
pub fn baxter() -> &'static Robot {
    static BAXTER: LazyLock<Robot> = LazyLock::new(|| Robot::load("baxter", root()).unwrap());
    &BAXTER
}

/// A scenario under `scenarios/`. All of them use the built-in robot.
pub fn scenario(name: &str) -> Scenario {
    scenario::load(&root().join(format!("scenarios/{name}.toml"))).unwrap().scenario
}

/// The check of a plan with the default tool for its operation.
pub fn checked<'a>(robot: &'a Robot, plan: &'a Plan) -> CheckedPlan<'a> {
    CheckedPlan::new(robot, plan, &Person::default(), &default_tool(plan.operation.kind)).unwrap()
}

/// The ten plans of `tests/data/holds` in the order of their names: object, arms and operation as `benchdog plan` wrote them.
pub fn ten_plans() -> Vec<Plan> {
    let folder = std::fs::read_dir(root().join("tests/data/holds")).unwrap();
    let mut paths: Vec<_> = folder.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert_eq!(paths.len(), 10);
    paths.iter().map(|path| scenario::read_plan(path, Some(baxter())).unwrap().0).collect()
}
