//! `benchdog sweep`: how likely a plan holds (`docs/method.md#10-sweeps`).

mod arrow;
pub mod folder;
mod journal;

use std::path::PathBuf;

use self::{folder::SweepFolder, journal::Journal};
use super::{
    exit::{CliError, Exit},
    inputs, interrupt,
    out_folder::Values,
    output,
    planners::Planners,
    progress::Progress,
    streams,
    sweep_args::SweepArgs,
    threads,
};
use crate::{
    check::CheckedPlan,
    model::{plan::Plan, scenario::Scenario, stop::Stop as _, sweep::Sweep},
    pipeline::{
        self, recording,
        sweep::{self, Description, Extent, OptionError, Study, SweepOptions, as_swept, info},
    },
    planner::Outcome,
    report,
    robot::Robot,
    scenario::{self, FileText, LoadedPlan, is_json},
    sweep::{
        ArmJoints, Draws,
        estimate::Estimate,
        info::{Shard, SweepInfo},
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
    let out = args.out.filled(&Values::of(&scenario, None).with(&scenario.name, sweep.seed));
    let folder = SweepFolder::new(&out);
    inputs::protect(&inputs, folder.files())?;
    report::file::check_folder(&out)?;
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
    let plan = as_swept(plan, &scenario, &sweep);
    let checked = CheckedPlan::new(&robot, &plan, &scenario.human, &scenario.tool)?;
    if let Some((_, reason)) = checked.refusal(&scenario.limits) {
        progress.finish();
        output::message(&format!("{}: not simulated: {reason}", plan.name));
        return Ok(Exit::NotMet);
    }
    let draws =
        Draws::new(&sweep, &ArmJoints::of(&plan)).map_err(|error| CliError::Usage(format!("sweep: {error}")))?;
    threads::with_threads(args.jobs, || {
        let screen = match args.all {
            true => None,
            false => sweep::screen(&checked, &scenario, &sweep, args.audit, &*progress)?,
        };
        let study = Study { scenario: &scenario, checked: &checked, draws: &draws, screen };
        let description = Description { sweep: &sweep, until: args.until, shard: args.shard, worst: args.worst };
        let info = info(&study, &description);
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
    let records =
        sweep::run(study, &Extent { indices, enough: &enough }, known, &mut |new| journal.add(new), progress)?;
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
    let path = &args.input;
    let text = scenario::plan_text(path)?;
    let is_toml = path.extension().is_some_and(|extension| extension == "toml");
    if is_toml || streams::is_stdin(path) && !is_json(&text) {
        if args.scenario.is_some() {
            return Err(CliError::Usage("--scenario: found one beside a scenario, expected a plan (.json)".into()));
        }
        let loaded = scenario::load_text(path, &text)?;
        loaded.filled_in.iter().for_each(|note| progress.message(&output::note(note)));
        let (scenario, robot, plan) = (loaded.scenario, loaded.robot, loaded.plan);
        return Ok(Subject { scenario, robot, plan, inputs: loaded.inputs });
    }
    let of_scenario = args.scenario.as_deref().map(scenario::scenario_text).transpose()?.unwrap_or_default();
    let given = args.scenario.as_ref().map(|path| FileText { path, text: &of_scenario });
    let LoadedPlan { plan, filled_in, robot, scenario, inputs, .. } =
        scenario::load_plan_text(FileText { path, text: &text }, given)?;
    filled_in.iter().for_each(|note| progress.message(&output::note(note)));
    Ok(Subject { scenario, robot, plan: Some(plan), inputs })
}

/// The sweep of a scenario with what the arguments override; by default the usual one.
fn sweep_of(args: &SweepArgs, scenario: &mut Scenario, robot: &Robot, progress: &Progress) -> Result<Sweep, CliError> {
    let SweepArgs { until, all, audit, seed, .. } = *args;
    let options = SweepOptions { runs: args.runs.map(std::num::NonZero::get), seed, until, all, audit };
    options.check().map_err(|error: OptionError| CliError::Usage(format!("--{error}")))?;
    if scenario.sweep.is_none() {
        progress.message(&output::note("the scenario has no [sweep]: preset = \"workshop\" is used"));
    }
    let sweep = options.sweep_of(scenario, robot)?;
    scenario.sweep = None;
    Ok(sweep)
}

/// The bytes of the recording of a run, which is simulated for it; `None` without recordings.
fn recording_of(study: &Study<'_>, index: u64, progress: &Progress) -> Result<Option<Vec<u8>>, CliError> {
    let scenario = Scenario { name: format!("{}-run-{index:06}", study.scenario.name), ..study.scenario_of(index) };
    let plan = Plan { name: scenario.name.clone(), ..study.checked.plan().clone() };
    let _writing = interrupt::writing();
    progress.simulates();
    let run = pipeline::run_plan(&scenario, study.checked.robot(), plan, &[], progress)?;
    Ok(recording::encode(&run, &scenario, study.checked.robot())?)
}
