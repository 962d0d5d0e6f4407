//! Replanning for a person who walks 1 m in 100 steps, on one thread: how long each answer takes, its objective and, at every
//! n-th step, that of a fresh plan.
//!
//! ```sh
//! cargo bench --bench replanning -- [--fresh 10] [--filter drill-5] [--turn -60]
//! ```

use std::time::Instant;

use benchdog::{
    model::{
        scenario::{Scenario, StandingPlace},
        stop::Never,
    },
    planner::{Outcome, Planner, Replanning, verify},
    reproduce::paper,
};

/// Steps of the walk.
const STEPS: usize = 100;

/// The value of an option of the command line.
fn option(name: &str) -> Option<String> {
    let mut arguments = std::env::args().skip_while(|argument| argument != name);
    arguments.nth(1)
}

fn number(name: &str, default: f64) -> f64 {
    option(name).map_or(default, |text| text.parse().expect("a number"))
}

fn main() {
    let filter = option("--filter").unwrap_or_else(|| "drill-5".into());
    let (every, turn_deg) = (number("--fresh", 0.0) as usize, number("--turn", -60.0));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for operation in paper::operations().iter().filter(|operation| operation.name == filter) {
        let loaded = operation.load().expect("they are valid");
        pool.install(|| walk(&mut Planner::new(&loaded.robot), &loaded.scenario, every, turn_deg));
    }
}

/// The person walks along their own y axis through the place of the free plan, and turns meanwhile: by default so that they go on
/// facing the board.
fn walk(planner: &mut Planner, scenario: &Scenario, every: usize, turn_deg: f64) {
    let Outcome::Found(free) = planner.plan(scenario).expect("a valid person") else { return println!("no plan") };
    let x_wb = free.human.expect("it has a person").x_wb;
    let ahead = x_wb.rotation * nalgebra::Vector3::x();
    let heading_deg = ahead.y.atan2(ahead.x).to_degrees();
    let mut wall_ms = Vec::with_capacity(STEPS);
    let mut least = f64::INFINITY;
    for step in 0..=STEPS {
        let along = step as f64 / STEPS as f64 - 0.5;
        let p_wb = x_wb * nalgebra::Point3::new(0.0, along, 0.0);
        let place = StandingPlace::Given {
            p_wb_m: [p_wb.x, p_wb.y],
            heading_deg: heading_deg + along * turn_deg,
            tolerance_m: 0.05,
            tolerance_deg: 5.0,
        };
        let mut moved = scenario.clone();
        moved.human.place = place;
        let start = Instant::now();
        let outcome = planner.replan(&moved, &Replanning::default(), &Never).expect("valid");
        let ms = start.elapsed().as_secs_f64() * 1e3;
        if step > 0 {
            wall_ms.push(ms);
        }
        let objective = match outcome {
            Outcome::Found(found) => {
                let flaws = verify(&found.plan, &moved, planner.robot());
                assert!(flaws.is_empty(), "{flaws:?}");
                let objective = found.plan.comfort.map_or(f64::NAN, |comfort| comfort.objective);
                let motion = found.motion.map_or(String::new(), |motion| format!("{motion:.3?}"));
                println!("{step:4} {ms:7.2} ms  objective {objective:8.3}  {motion}");
                objective
            }
            Outcome::Infeasible(why) => {
                println!("{step:4} {ms:7.2} ms  {why}");
                0.0
            }
        };
        if every > 0 && step % every == 0 {
            let start = Instant::now();
            if let Outcome::Found(fresh) = planner.plan(&moved).expect("a valid person") {
                let fresh = fresh.comfort.map_or(f64::NAN, |comfort| comfort.objective);
                least = least.min(objective / fresh);
                println!(
                    "     fresh {fresh:8.3} share {:.4} {:.1} s",
                    objective / fresh,
                    start.elapsed().as_secs_f64()
                );
            }
        }
    }
    wall_ms.sort_by(f64::total_cmp);
    let at = |share: f64| wall_ms[((wall_ms.len() - 1) as f64 * share).round() as usize];
    println!(
        "median {:.2} ms, 95th percentile {:.2} ms, most {:.2} ms; least share of a fresh plan {least:.4}",
        at(0.5),
        at(0.95),
        at(1.0)
    );
}
