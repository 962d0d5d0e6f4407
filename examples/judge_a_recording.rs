//! Reads a recording and judges its trace by other limits, without simulating again.
//!
//! ```sh
//! cargo run --release -- run scenarios/quickstart.toml             # writes out/quickstart/recording.rrd
//! cargo run --release --example judge_a_recording
//! cargo run --release --example judge_a_recording my-recording.rrd
//! ```
//!
//! A recording contains the scenario, the plan, the verdict and the whole trace, in 64-bit numbers. The judge is a pure
//! function of trace and limits, so the same limits give the same verdict.

use std::{error::Error, path::Path, process::ExitCode};

use benchdog::{judge::judge, model::scenario::Limits, record};

fn main() -> ExitCode {
    let path = std::env::args().nth(1).unwrap_or_else(|| "out/quickstart/recording.rrd".to_owned());
    match run(Path::new(&path)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(path: &Path) -> Result<(), Box<dyn Error>> {
    let recorded = record::read_run(path)?;
    let (verdict, limits) = (&recorded.verdict, &recorded.scenario.limits);
    println!("{}: {} (recorded)", verdict.name, verdict.verdict);

    let judgement = judge(&recorded.trace, limits);
    let same = if judgement.fingerprint == verdict.fingerprint { "the recorded one" } else { "another one" };
    println!("{}: {} (judged again; the trace is {same})", verdict.name, judgement.verdict);

    println!("\nlimit of deflection  verdict");
    for share in [1.0, 0.9, 0.8, 0.7, 0.6] {
        let deflection_mm = share * limits.deflection_mm;
        let judgement = judge(&recorded.trace, &Limits { deflection_mm, ..*limits });
        let when = judgement.first_failure.map_or_else(String::new, |first| {
            format!(" at {:.3} s under {:.2} of the load", first.time_s, first.load_factor)
        });
        println!("{deflection_mm:>16.2} mm  {}{when}", judgement.verdict);
    }
    Ok(())
}
