//! Plans the grasp of a scenario and prints it.
//!
//! ```sh
//! cargo run --release --example plan                               # the quickstart
//! cargo run --release --example plan scenarios/cut-rim.toml        # a scenario of yours
//! ```
//!
//! A plan takes some seconds, most of them for what the planner precomputes; `replan_in_a_loop.rs` shows how to keep that.

use std::{error::Error, path::Path, process::ExitCode};

use benchdog::{
    model::plan::Plan,
    planner::{Outcome, Planner},
    scenario,
};

fn main() -> ExitCode {
    let path = std::env::args().nth(1).unwrap_or_else(|| "scenarios/quickstart.toml".to_owned());
    match run(Path::new(&path)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(path: &Path) -> Result<(), Box<dyn Error>> {
    // An error of the file names its line and key.
    let loaded = scenario::load(path)?;
    // An infeasible scenario is an outcome, not an error.
    match Planner::new(&loaded.robot).plan(&loaded.scenario)? {
        Outcome::Found(plan) => print(&plan),
        Outcome::Infeasible(why) => println!("{}: no plan: {why}", loaded.scenario.name),
    }
    Ok(())
}

fn print(plan: &Plan) {
    let p_wo = plan.object.x_wo.translation;
    println!("{}", plan.name);
    println!("board at       {:.3} {:.3} {:.3} m", p_wo.x, p_wo.y, p_wo.z);
    for arm in &plan.arms {
        let p_og = arm.x_og.translation;
        let q_deg: Vec<_> = arm.q_rad.iter().map(|q_rad| format!("{:.1}", q_rad.to_degrees())).collect();
        println!("{:<5} gripper  {:.3} {:.3} {:.3} m on the board", arm.name, p_og.x, p_og.y, p_og.z);
        println!("{:<5} joints   {} deg", arm.name, q_deg.join(" "));
    }
    if let Some(comfort) = plan.comfort {
        println!("muscular       {:.2} (regularised)", comfort.muscular_regularised);
        println!("peripersonal   {:.3} m", comfort.peripersonal_m);
    }
    if let Some(stability) = &plan.stability {
        println!(
            "load factor    {:.2}, with compliant arms {:.2}",
            stability.load_factor, stability.compliant_load_factor
        );
        println!("deflection     {:.2} mm (predicted)", stability.predicted_deflection_mm);
    }
}
