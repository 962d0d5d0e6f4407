//! `benchdog sweep`: how likely a plan holds (`docs/method.md#10-sweeps`).

mod arrow;
pub mod folder;
mod runner;
pub mod study;

use std::path::PathBuf;

use self::{
    folder::SweepFolder,
    runner::{Extent, Journal},
    study::Study,
};
use super::{
    exit::{CliError, Exit},
    inputs, interrupt, output, pipeline,
    planners::Planners,
    progress::Progress,
    recording,
    sweep_args::SweepArgs,
    threads,
    versions::versions,
};
use crate::{
    cache::hash_of,
    check::CheckedPlan,
    model::{FORMAT, plan::Plan, scenario::Scenario, stop::Stop as _, sweep::Sweep},
    planner::{Outcome, write_robot},
    report,
    robot::Robot,
    scenario::{self, LoadedPlan},
    sweep::{
        ArmJoints, Draws,
        estimate::Estimate,
        info::{Fingerprints, Shard, SweepInfo},
        record::RunRecord,
    },
};

/// What is swept: a plan, or a scenario that is still to be planned.
struct Subject {
    scenario: Scenario,
    robot: Robot,
    plan: Option<Plan>,
    inputs: Vec<PathBuf>,
}

/// Simulates a plan many times.
pub fn sweep(args: &SweepArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the scenario", "the finished runs are kept: the same command goes on")?;
    let Subject { mut scenario, robot, plan, inputs } = subject(args, &progress)?;
    let sweep = sweep_of(args, &mut scenario, &robot, &progress)?;
    let folder = SweepFolder::new(&args.out);
    inputs::protect(&inputs, folder.files())?;
    report::file::check_folder(&args.out)?;
    let plan = match plan {
        Some(plan) => plan,
        None => match Planners::new(args.cache).timed_plan(&scenario, &robot, &*progress)? {
            Outcome::Found(plan) => plan,
            Outcome::Infeasible(why) => {
                progress.finish();
                output::message(&format!("{}: no plan: {why}", scenario.name));
                return Ok(Exit::Infeasible);
            }
        },
    };
    let plan = as_written(plan, &scenario, &sweep);
    let checked = CheckedPlan::new(&robot, &plan, &scenario.human, &scenario.tool)?;
    if let Some(reason) = why_not_simulated(&checked, &scenario) {
        progress.finish();
        output::message(&format!("{}: not simulated: {reason}", plan.name));
        return Ok(Exit::NotMet);
    }
    let draws =
        Draws::new(&sweep, &ArmJoints::of(&plan)).map_err(|error| CliError::Usage(format!("sweep: {error}")))?;
    threads::with_threads(args.jobs, || {
        let screen = match args.all {
            true => None,
            false => study::screen(&checked, &scenario, &sweep, args.audit, &*progress)?,
        };
        let study = Study { scenario: &scenario, checked: &checked, draws: &draws, screen };
        let info = info(args, &study, &sweep);
        swept(args, &study, info, &folder, &progress)
    })?
}

/// Does the runs and writes the folder.
fn swept(
    args: &SweepArgs,
    study: &Study<'_>,
    info: SweepInfo,
    folder: &SweepFolder,
    progress: &Progress,
) -> Result<Exit, CliError> {
    let header = info.header();
    let key = info.key();
    let known = folder.known_runs(&key, &header);
    folder.begin()?;
    let mut journal = Journal::begin(folder.path(), &key, &header, &known)?;
    progress.keep();
    let all = Shard { number: 1, of: 1 };
    let indices: Vec<u64> = info.shard.unwrap_or(all).indices(info.runs).collect();
    progress.expect(indices.len());
    progress.does("simulating");
    let enough = |runs: &[RunRecord]| args.until.is_some_and(|width| Estimate::of(&info.expect, runs).width() <= width);
    let records = runner::run(study, &Extent { indices, enough: &enough }, known, &mut journal, progress)?;
    if progress.is_stopped() {
        progress.finish();
        return Ok(Exit::Interrupted);
    }
    progress.does("recording the worst runs");
    let recording = |index: u64| recording_of(study, index, progress);
    let plan = report::json::plan(study.checked.plan());
    let exit = folder.write(&info, &records, plan.as_bytes(), &recording, args.format, progress)?;
    Ok(exit)
}

/// Reads the scenario or the plan.
fn subject(args: &SweepArgs, progress: &Progress) -> Result<Subject, CliError> {
    if args.input.extension().is_some_and(|extension| extension == "toml") {
        if args.scenario.is_some() {
            return Err(CliError::Usage("--scenario: found one beside a scenario, expected a plan (.json)".into()));
        }
        let loaded = scenario::load(&args.input)?;
        loaded.filled_in.iter().for_each(|note| progress.message(&output::note(note)));
        let (scenario, robot, plan) = (loaded.scenario, loaded.robot, loaded.plan);
        return Ok(Subject { scenario, robot, plan, inputs: loaded.inputs });
    }
    let LoadedPlan { plan, filled_in, robot, scenario, inputs, .. } =
        scenario::load_plan(&args.input, args.scenario.as_deref())?;
    filled_in.iter().for_each(|note| progress.message(&output::note(note)));
    Ok(Subject { scenario, robot, plan: Some(plan), inputs })
}

/// The sweep of a scenario with what the arguments override; by default the usual one.
fn sweep_of(args: &SweepArgs, scenario: &mut Scenario, robot: &Robot, progress: &Progress) -> Result<Sweep, CliError> {
    let range = |name: &str, found: f64, low: f64, high: f64| match (low..=high).contains(&found) {
        true => Ok(()),
        false => Err(CliError::Usage(format!("{name}: found {found}, expected a number from {low} to {high}"))),
    };
    range("--audit", args.audit, 0.0, 1.0)?;
    args.until.map_or(Ok(()), |width| range("--until", width, 1e-4, 1.0))?;
    let mut sweep = match scenario.sweep.take() {
        Some(sweep) => sweep,
        None => {
            progress.message(&output::note("the scenario has no [sweep]: preset = \"workshop\" is used"));
            scenario::usual_sweep(scenario, robot)?
        }
    };
    sweep.runs = args.runs.map_or(sweep.runs, std::num::NonZero::get);
    sweep.seed = args.seed.unwrap_or(sweep.seed);
    if sweep.runs > Sweep::MOST_RUNS {
        return Err(CliError::Usage(format!("--runs: found {}, expected at most {}", sweep.runs, Sweep::MOST_RUNS)));
    }
    Ok(sweep)
}

/// A plan as a sweep writes it: without durations, so that equal sweeps give equal files, and with the sweep in its scenario.
fn as_written(mut plan: Plan, scenario: &Scenario, sweep: &Sweep) -> Plan {
    if let Some(planner) = &mut plan.planner {
        (planner.wall_ms, planner.map_ms) = (None, None);
    }
    plan.scenario = Some(Scenario { sweep: Some(sweep.clone()), ..scenario.clone() });
    plan
}

/// Why no run of a plan would be simulated.
fn why_not_simulated(checked: &CheckedPlan<'_>, scenario: &Scenario) -> Option<String> {
    checked.first_contact(0.0).map(|contact| contact.reason).or_else(|| checked.why_not_so(&scenario.limits))
}

fn info(args: &SweepArgs, study: &Study<'_>, sweep: &Sweep) -> SweepInfo {
    SweepInfo {
        format: FORMAT,
        name: study.checked.plan().name.clone(),
        expect: study.scenario.expect,
        runs: sweep.runs,
        until: args.until,
        sampling: sweep.sampling,
        seed: sweep.seed,
        shard: args.shard,
        screen: study.screen,
        recorded: args.worst,
        variables: sweep.variables.clone(),
        dimensions: study.draws.dimensions().to_vec(),
        fingerprints: Fingerprints { program: env!("BENCHDOG_PROGRAM").into(), inputs: inputs_fingerprint(study) },
        versions: versions(),
    }
}

/// SHA-256 of plan, scenario and robot; names of files are left out.
fn inputs_fingerprint(study: &Study<'_>) -> String {
    let mut scenario = study.scenario.clone();
    scenario.robot.description.clear();
    scenario.robot.packages.clear();
    let plan = Plan { scenario: None, robot: String::new(), ..study.checked.plan().clone() };
    let hash = hash_of(|text| {
        write!(text, "{plan:?} {scenario:?} ")?;
        write_robot(text, study.checked.robot())
    });
    base16ct::lower::encode_string(&hash)
}

/// The bytes of the recording of a run, which is simulated for it; `None` without recordings.
fn recording_of(study: &Study<'_>, index: u64, progress: &Progress) -> Result<Option<Vec<u8>>, CliError> {
    let scenario = Scenario { name: format!("{}-run-{index:06}", study.scenario.name), ..study.scenario_of(index) };
    let plan = Plan { name: scenario.name.clone(), ..study.checked.plan().clone() };
    let _writing = interrupt::writing();
    let run = pipeline::run_plan(&scenario, study.checked.robot(), plan, &[], progress)?;
    recording::encode(&run, &scenario, study.checked.robot())
}
