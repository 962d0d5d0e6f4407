//! The 25 operations of the paper's evaluation with natural postures, on kept maps and one thread: how long a plan takes, and its
//! objective as a share of the best known.
//!
//! ```sh
//! cargo bench --bench operations -- [--repeat 5] [--filter cut]
//! ```

use std::time::Instant;

use benchdog::{
    planner::{Outcome, Planner},
    reproduce::paper,
};

#[path = "../tests/common/best_known.rs"]
mod best_known;

/// The value of an option of the command line.
fn option(name: &str) -> Option<String> {
    let mut arguments = std::env::args().skip_while(|argument| argument != name);
    arguments.nth(1)
}

fn main() {
    let repeat: usize = option("--repeat").map_or(5, |text| text.parse().expect("--repeat: a number"));
    let filter = option("--filter").unwrap_or_default();
    let operations: Vec<_> = paper::operations();
    let operations = operations.iter().filter(|operation| operation.name.contains(&filter));
    let loaded: Vec<_> = operations.map(|operation| operation.load().expect("they are valid")).collect();
    let Some(first) = loaded.first() else { return };
    let planner = Planner::new(&first.robot);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        let mut all_ms = Vec::new();
        for loaded in &loaded {
            let scenario = &loaded.scenario;
            let start = Instant::now();
            planner.prepare(scenario).expect("a valid person");
            let map_ms = start.elapsed().as_secs_f64() * 1e3;
            let mut wall_ms = Vec::with_capacity(repeat);
            let mut objective = f64::NAN;
            let mut evaluations = 0;
            for _ in 0..repeat {
                let start = Instant::now();
                let outcome = planner.plan(scenario).expect("a valid person");
                wall_ms.push(start.elapsed().as_secs_f64() * 1e3);
                if let Outcome::Found(plan) = outcome {
                    objective = plan.comfort.map_or(f64::NAN, |comfort| comfort.objective);
                    evaluations = plan.planner.map_or(0, |record| record.evaluations);
                }
            }
            wall_ms.sort_by(f64::total_cmp);
            let (median_ms, best) = (wall_ms[repeat / 2], best_known::natural(&scenario.name));
            println!(
                "{:<8} {median_ms:7.2} ms  maps {map_ms:8.1} ms  {evaluations:5} candidates  objective {objective:9.4}  {:.4} of the best known",
                scenario.name,
                objective / best.unwrap_or(f64::NAN)
            );
            all_ms.push(median_ms);
        }
        all_ms.sort_by(f64::total_cmp);
        let at = |share: f64| all_ms[((all_ms.len() - 1) as f64 * share).round() as usize];
        println!("median {:.2} ms, 95th percentile {:.2} ms, most {:.2} ms", at(0.5), at(0.95), at(1.0));
    });
}
