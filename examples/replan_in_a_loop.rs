//! Plans one scenario again and again while it changes, on precomputed maps.
//!
//! ```sh
//! cargo run --release --example replan_in_a_loop
//! ```
//!
//! A [`Planner`] keeps what its plans share: a grasp library per size of board, and warm starts per task family. Holes of
//! one board that differ only in place are one family. Its first plan takes seconds, each further one a fraction of a
//! second. A changed force is another family; `prepare` makes its warm starts ahead of time.

use std::{error::Error, path::Path, process::ExitCode, time::Instant};

use benchdog::{
    model::scenario::Scenario,
    planner::{Outcome, Planner},
    scenario,
};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let loaded = scenario::load(Path::new("scenarios/quickstart.toml"))?;
    let planner = Planner::new(&loaded.robot);
    let mut scenario = loaded.scenario;

    prepare(&planner, &scenario)?;
    for step in 0..8 {
        let x_m = -0.14 + 0.04 * f64::from(step);
        scenario.operation.x_ot.translation.x = x_m;
        replan(&planner, &scenario, &format!("hole at x = {x_m:+.2} m"))?;
    }

    scenario.operation.wrench_o.force_n *= 10.0;
    prepare(&planner, &scenario)?;
    replan(&planner, &scenario, "the last hole with ten times the force")?;

    // The planner checks the person and the tool. A scenario from a file has been checked already.
    scenario.human.height_m = -1.0;
    if let Err(error) = planner.plan(&scenario) {
        println!("a person of -1 m: {error}");
    }
    Ok(())
}

fn prepare(planner: &Planner, scenario: &Scenario) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    planner.prepare(scenario)?;
    println!("{:>7.3} s  maps", start.elapsed().as_secs_f64());
    Ok(())
}

fn replan(planner: &Planner, scenario: &Scenario, title: &str) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let outcome = planner.plan(scenario)?;
    let wall_s = start.elapsed().as_secs_f64();
    match outcome {
        Outcome::Found(plan) => {
            let objective = plan.comfort.map_or(f64::NAN, |comfort| comfort.objective);
            println!("{wall_s:>7.3} s  {title}: objective {objective:.2}");
        }
        Outcome::Infeasible(why) => println!("{wall_s:>7.3} s  {title}: {why}"),
    }
    Ok(())
}
