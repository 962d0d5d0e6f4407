//! Replans while the person walks past the robot, then for another hole, for a larger force, and with the grasps kept.
//!
//! ```sh
//! cargo run --release --example replan_in_a_loop
//! ```
//!
//! `Planner::replan` starts from the holds that it knows from the calls before. The first call needs the maps of the task
//! family: some seconds, unless the planner has a store that keeps them. Every further call takes some milliseconds, makes no
//! maps, and is checked like every plan.

use std::{error::Error, path::Path, process::ExitCode, time::Instant};

use benchdog::{
    model::{
        scenario::{Scenario, StandingPlace},
        stop::Never,
    },
    planner::{Outcome, Planner, Replanned, Replanning},
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
    let mut planner = Planner::new(&loaded.robot);
    let mut scenario = loaded.scenario;
    let free = Replanning::default();

    let Some(first) = replan(&mut planner, &scenario, &free, "a person who may stand anywhere")? else { return Ok(()) };
    // Where the plan has them stand.
    let x_wb = first.plan.human.ok_or("the plan has no person")?.x_wb;
    let ahead = x_wb.rotation * benchdog::nalgebra::Vector3::x();
    for step in 0..5 {
        scenario.human.place = StandingPlace::Given {
            p_wb_m: [x_wb.translation.x, x_wb.translation.y + 0.02 * f64::from(step)],
            heading_deg: ahead.y.atan2(ahead.x).to_degrees(),
            tolerance_m: 0.05,
            tolerance_deg: 5.0,
        };
        replan(&mut planner, &scenario, &free, &format!("the person {} cm to the side", 2 * step))?;
    }
    scenario.operation.x_ot.translation.x += 0.04;
    replan(&mut planner, &scenario, &free, "a hole 4 cm further")?;
    scenario.operation.wrench_o.force_n *= 1.5;
    replan(&mut planner, &scenario, &free, "half as much force again")?;
    scenario.operation.x_ot.translation.x -= 0.02;
    let held = Replanning { keep_grasps: true, most_motion_rad: Some(10_f64.to_radians()), ..free };
    replan(&mut planner, &scenario, &held, "a hole 2 cm back, the grasps kept, at most 10 degrees")?;
    Ok(())
}

fn replan(
    planner: &mut Planner,
    scenario: &Scenario,
    how: &Replanning,
    title: &str,
) -> Result<Option<Replanned>, Box<dyn Error>> {
    let start = Instant::now();
    let outcome = planner.replan(scenario, how, &Never)?;
    let wall_ms = start.elapsed().as_secs_f64() * 1e3;
    match outcome {
        Outcome::Found(found) => {
            let objective = found.plan.comfort.map_or(f64::NAN, |comfort| comfort.objective);
            let motion = found.motion.map_or(String::new(), |motion| {
                format!(", joints move by at most {:.1} degrees", motion.largest_joint_rad.to_degrees())
            });
            println!("{wall_ms:>9.1} ms  {title}: objective {objective:.2}{motion}");
            Ok(Some(found))
        }
        Outcome::Infeasible(why) => {
            println!("{wall_ms:>9.1} ms  {title}: {why}");
            Ok(None)
        }
    }
}
