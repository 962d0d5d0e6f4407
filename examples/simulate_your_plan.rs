//! Checks, simulates and judges a plan from another planner.
//!
//! ```sh
//! cargo run --release --example simulate_your_plan                 # a plan under scenarios/plans
//! cargo run --release --example simulate_your_plan my-plan.json    # a plan of yours
//! ```
//!
//! The plan is simulated as it is and with half of its grip force. Then a joint angle is changed, to show how an
//! inconsistent plan is refused.

use std::{error::Error, path::Path, process::ExitCode};

use benchdog::{
    check::CheckedPlan,
    judge::{Judgement, judge},
    model::{plan::Plan, scenario::Scenario},
    robot::Robot,
    scenario,
    sim::{self, Conditions},
};

fn main() -> ExitCode {
    let path = std::env::args().nth(1).unwrap_or_else(|| "scenarios/plans/cut-rim.json".to_owned());
    match run(Path::new(&path)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(path: &Path) -> Result<(), Box<dyn Error>> {
    let (mut plan, robot) = scenario::read_plan(path, None)?;
    // Phases, limits and friction; those that the plan does not state have defaults for its kind of operation.
    let scenario = scenario::default_for_plan(&plan, &robot);
    print("as planned", &simulated(&plan, &scenario, &robot)?);

    for arm in &mut plan.arms {
        arm.grip_force_n /= 2.0;
    }
    print("half the grip force", &simulated(&plan, &scenario, &robot)?);

    plan.arms[0].q_rad[3] += 0.1;
    match simulated(&plan, &scenario, &robot) {
        Ok(judgement) => print("another joint angle", &judgement),
        Err(error) => println!("another joint angle: {error}"),
    }
    Ok(())
}

/// Simulates a plan and judges the trace.
fn simulated(plan: &Plan, scenario: &Scenario, robot: &Robot) -> Result<Judgement, Box<dyn Error>> {
    let checked = CheckedPlan::new(robot, plan, &scenario.human, &scenario.tool)?;
    if let Some(contact) = checked.first_contact(0.0) {
        return Err(format!("bodies touch before the load is applied: {}", contact.reason).into());
    }
    if let Some(reason) = checked.why_not_so(&scenario.limits) {
        return Err(format!("the person would not work so: {reason}").into());
    }
    let trace = sim::simulate(&checked, &Conditions::of(scenario))?;
    Ok(judge(&trace, &scenario.limits))
}

fn print(title: &str, judgement: &Judgement) {
    println!("{title}: {}", judgement.verdict);
    for check in &judgement.checks {
        let mark = if check.passed { " " } else { "!" };
        println!(
            "  {mark} {:<15} {:>9.3} {:<4} limit {:.3}",
            check.name.to_string(),
            check.value,
            check.unit,
            check.limit
        );
    }
    if let Some(first) = &judgement.first_failure {
        println!("    first crossed: {} at {:.3} s, {:.2} of the load", first.check, first.time_s, first.load_factor);
    }
    println!();
}
