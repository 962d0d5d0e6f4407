//! `benchdog task`: plans, simulates and judges a whole task; and the judgement of staged plans for `benchdog simulate`.

mod compare;
mod staged;
mod stream;

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use super::{
    args::{RecordChoice, SimulateArgs},
    cache,
    exit::{CliError, Exit},
    format::Format,
    inputs, interrupt,
    out_folder::Values,
    output,
    progress::Progress,
    task_args::TaskArgs,
};
use crate::{
    check::StagedStates,
    model::{
        plan::PlannerRecord,
        scenario::{ResponseKind, Scenario},
        staged_plan::StagedPlan,
        staged_verdict::StagedVerdict,
        task::Task,
        verdict::VerdictKind,
    },
    pipeline::{mcap, recording, task_recording::TaskRecording},
    planner::{
        Planner, Search,
        task::{TaskInfeasible, TaskPlan},
    },
    report::{self, comparison::Comparison, stages::JudgedPlan},
    robot::Robot,
    scenario::{self, LoadedStagedPlan},
};
pub use compare::compared;
use staged::StagedRun;
pub use staged::run_staged;
use stream::{StageStream, Waiting};

/// The files of a task.
struct TaskFiles {
    plan: PathBuf,
    comparison: PathBuf,
    compared_pieces: PathBuf,
    verdict: PathBuf,
    stages: PathBuf,
    path: PathBuf,
    page: PathBuf,
    recording: PathBuf,
    mcap: PathBuf,
    stream: PathBuf,
}

impl TaskFiles {
    fn new(folder: &Path) -> Self {
        let file = |file: &str| folder.join(file);
        Self {
            plan: file("plan.json"),
            comparison: file("comparison.csv"),
            compared_pieces: file("comparison-pieces.csv"),
            verdict: file("verdict.json"),
            stages: file("stages.csv"),
            path: file("path.csv"),
            page: file("report.html"),
            recording: file("recording.rrd"),
            mcap: file("trace.mcap"),
            stream: file("stages.jsonl"),
        }
    }

    /// Those that `task` writes; `simulate` leaves the first four as they are.
    fn all(&self) -> [PathBuf; 10] {
        let Self { plan, stream, comparison, compared_pieces, verdict, stages, path, page, recording, mcap } = self;
        [plan, stream, comparison, compared_pieces, verdict, stages, path, page, recording, mcap].map(Clone::clone)
    }
}

/// Plans a task, simulates and judges it, and writes plan, verdict, tables and report.
pub fn task(args: &TaskArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the task", "nothing is written")?;
    let (mut loaded, task) = scenario::load_task(&args.task)?;
    args.search.apply(&mut loaded.scenario.planner);
    // Holds are compared by the person's best response: the mean response would take minutes per grasp.
    loaded.scenario.comfort.person = ResponseKind::Best;
    let files = TaskFiles::new(&args.out.of_one(&Values::of(&loaded.scenario, None)));
    inputs::protect(&loaded.inputs, files.all())?;
    report::file::check_folder(&args.out.of_all())?;
    let planner = cache::planner(&loaded.robot, args.cache);
    let start = Instant::now();
    planner.search(&loaded.scenario).watch(&*progress).prepare_task(&task)?;
    let map_ms = start.elapsed().as_secs_f64() * 1e3;
    let start = Instant::now();
    let search = planner.search(&loaded.scenario).watch(&*progress);
    let FoundTask { plan, planned_s } = found(search, &task, args.stream, &files.stream)?;
    let wall_ms = start.elapsed().as_secs_f64() * 1e3;
    let mut found = match plan {
        Ok(found) => found,
        Err(why) => {
            progress.finish();
            return Ok(infeasible(&loaded.scenario, &why));
        }
    };
    let TaskPlan { staged, separate } = &mut found;
    staged.planner =
        staged.planner.map(|record| PlannerRecord { wall_ms: Some(wall_ms), map_ms: Some(map_ms), ..record });
    say_planned(staged, wall_ms, map_ms);
    let best: Vec<_> = separate.iter().map(|plan| Some(plan.as_ref()?.comfort?.objective)).collect();
    report::file::write_whole(&files.plan, report::json::pretty(staged).as_bytes())?;
    report::file::write_whole(&files.path, report::task::path_csv(staged, &best).as_bytes())?;
    let comparison = comparison(args.compare, &planner, &loaded.scenario, &found, (&files, &progress))?;
    let staged = found.staged;
    if args.plan_only {
        progress.finish();
        print_comparison(comparison.as_ref(), args.format)?;
        return Ok(Exit::Met);
    }
    let robot = loaded.robot.at_gap(staged.object.size_m[2]);
    let states = StagedStates::new(&robot, &staged)?;
    let record = if args.no_recording { RecordChoice::Never } else { RecordChoice::Always };
    let output = (&files, args.format, Records { record, mcap: args.mcap }, comparison);
    let verdict = judged(&loaded.scenario, &robot, &staged, &states, output, &progress)?;
    if let Some(planned_s) = planned_s {
        let Waiting { first_s, later_s } = Waiting::new(&planned_s, &verdict.stages);
        output::message(&format!(
            "{}: the person waits {first_s:.2} s for the planner before the first stage and {later_s:.2} s later",
            staged.name
        ));
    }
    Ok(Exit::judged(verdict.met, verdict.verdict))
}

/// Says how long a plan took, and what it has.
fn say_planned(staged: &StagedPlan, wall_ms: f64, map_ms: f64) {
    let (moves, regrasps) = (staged.moves(), staged.regrasps());
    output::message(&format!(
        "{}: planned in {:.2} s (maps {:.1} s): {} holds, {moves} motions, {regrasps} regrasps",
        staged.name,
        wall_ms / 1e3,
        map_ms / 1e3,
        staged.stages.len() - moves - regrasps,
    ));
}

/// What a search found.
struct FoundTask {
    plan: Result<TaskPlan, TaskInfeasible>,
    /// When each stage was planned, s after the search began; `None` if all were at once.
    planned_s: Option<Vec<f64>>,
}

/// Searches the plan of a task: as a whole, or in parts with this number of pieces ahead, whose stages are written to a file as soon as
/// they are planned.
fn found(search: Search<'_>, task: &Task, ahead: Option<u16>, path: &Path) -> Result<FoundTask, CliError> {
    report::file::remove(path)?;
    let Some(pieces) = ahead else { return Ok(FoundTask { plan: search.task(task)?, planned_s: None }) };
    let mut stream = StageStream::new(path)?;
    let plan = search.task_in_parts(task, pieces.into(), &mut |plan| stream.write(plan))?;
    Ok(FoundTask { plan, planned_s: Some(stream.finish()?) })
}

/// Compares the plan with other strategies if that is wanted, and writes the tables; otherwise removes those of another plan.
fn comparison(
    is_wanted: bool,
    planner: &Planner,
    scenario: &Scenario,
    found: &TaskPlan,
    (files, progress): (&TaskFiles, &Progress),
) -> Result<Option<Comparison>, CliError> {
    report::file::remove(&files.comparison)?;
    report::file::remove(&files.compared_pieces)?;
    if !is_wanted {
        return Ok(None);
    }
    progress.leaves("the plan is written");
    let comparison = compared(planner, scenario, found, progress)?;
    report::file::write_whole(&files.compared_pieces, report::comparison::pieces_csv(&comparison).as_bytes())?;
    report::file::write_whole(&files.comparison, report::comparison::csv(&comparison).as_bytes())?;
    Ok(Some(comparison))
}

/// Prints the comparison for people.
fn print_comparison(comparison: Option<&Comparison>, format: Format) -> Result<(), CliError> {
    match (comparison, format) {
        (Some(comparison), Format::Human) => output::report(&report::comparison::table(comparison)),
        _ => Ok(()),
    }
}

/// Which files of the simulation are wanted.
#[derive(Clone, Copy)]
struct Records {
    record: RecordChoice,
    mcap: bool,
}

/// The bytes of the recording and of the MCAP file, each if it is wanted.
fn recorded(task: &TaskRecording<'_>, Records { record, mcap }: Records) -> Result<[Option<Vec<u8>>; 2], CliError> {
    let recording = if record.wants(task.verdict.met) { recording::encode_task(task)? } else { None };
    let mcap = if mcap { mcap::encode_task(task)? } else { None };
    Ok([recording, mcap])
}

/// Simulates and judges a staged plan of any planner.
pub fn simulate(args: &SimulateArgs, loaded: &LoadedStagedPlan, progress: &Progress) -> Result<Exit, CliError> {
    let LoadedStagedPlan { plan, states, robot, scenario, inputs, .. } = loaded;
    let seed = plan.planner.map_or(scenario.planner.seed, |planner| planner.seed);
    let files = TaskFiles::new(&args.report.out.of_one(&Values::of(scenario, None).with(&plan.name, seed)));
    inputs::protect(inputs, files.all().into_iter().skip(4))?;
    report::file::check_folder(&args.report.out.of_all())?;
    report::file::write_whole(&files.path, report::task::path_csv(plan, &[]).as_bytes())?;
    let records = Records { record: args.report.record, mcap: args.report.mcap };
    let output = (&files, args.report.format, records, None);
    judged(scenario, robot, plan, states, output, progress).map(|of| Exit::judged(of.met, of.verdict))
}

/// Simulates and judges a plan, writes verdict, table and report, the recording and the MCAP file if `records` says so, and prints
/// the table.
fn judged(
    scenario: &Scenario,
    robot: &Robot,
    plan: &StagedPlan,
    states: &StagedStates,
    (files, format, records, comparison): (&TaskFiles, Format, Records, Option<Comparison>),
    progress: &Progress,
) -> Result<StagedVerdict, CliError> {
    report::file::remove(&files.verdict)?;
    report::file::remove(&files.recording)?;
    report::file::remove(&files.mcap)?;
    let StagedRun { verdict, simulated } = run_staged(scenario, robot, plan, states, progress)?;
    progress.finish();
    let recorded = match &simulated {
        Some((trace, judgement)) => {
            let (pieces, judgements) = (&states.pieces[..], &judgement.stages[..]);
            let verdict = &verdict;
            recorded(&TaskRecording { scenario, robot, plan, pieces, verdict, trace, judgements }, records)?
        }
        None => [None, None],
    };
    let writing = interrupt::writing();
    for (path, bytes) in [&files.recording, &files.mcap].into_iter().zip(recorded) {
        if let Some(bytes) = bytes {
            report::file::write_whole(path, &bytes)?;
        }
    }
    report::file::write_whole(&files.stages, report::task::stages_csv(&verdict).as_bytes())?;
    let judged = JudgedPlan { plan, holdings: &states.holdings, robot, scenario, verdict: &verdict };
    let trace = simulated.as_ref().map(|(trace, _)| trace);
    let page = report::task::page(&judged, trace, comparison.as_ref())?;
    report::file::write_whole(&files.page, page.as_bytes())?;
    report::file::write_whole(&files.verdict, report::json::pretty(&verdict).as_bytes())?;
    drop(writing);
    match format {
        Format::Human => {
            let hint = report::console::hint((!verdict.met).then_some(verdict.verdict));
            output::report(&format!("{}{hint}", report::task::table(&verdict)))?;
        }
        Format::Json => output::print(&report::json::pretty(&verdict))?,
    }
    print_comparison(comparison.as_ref(), format)?;
    Ok(verdict)
}

/// Prints why no plan was found.
fn infeasible(scenario: &Scenario, why: &TaskInfeasible) -> Exit {
    output::message(&format!("{}: no feasible plan: {why}", scenario.name));
    let is_expected = scenario.expect.verdict == VerdictKind::Infeasible;
    if is_expected { Exit::Met } else { Exit::Infeasible }
}
