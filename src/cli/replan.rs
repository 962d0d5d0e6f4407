//! `benchdog replan`: a process that a robot program talks to. It reads requests in lines of JSON and answers each with a plan in a
//! line of JSON.

use std::{io::Write, path::Path, time::Instant};

use schemars::JsonSchema;
use serde::Serialize;

use super::{
    args::ReplanArgs,
    cache,
    exit::{CliError, Exit},
    plan::load_for_planning,
    progress::Progress,
};
use crate::{
    input::{self, MOST_LINE},
    model::{plan::Plan, scenario::Scenario},
    planner::{Motion, Outcome, PlanError, Planner, Replanned, Replanning},
    report,
    scenario::{self, LoadedScenario, ReplanRequest, read_replan_request},
};

/// An answer, in the order of the requests.
#[derive(Serialize, JsonSchema)]
pub struct Answer {
    /// That of the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<serde_json::Value>,
    /// The number of the request's line, from 1.
    line: usize,
    /// What follows.
    result: ResultKind,
    /// Why there is no plan, or what is wrong with the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    /// True if no known hold served and the task was planned from scratch.
    #[serde(skip_serializing_if = "Option::is_none")]
    searched: Option<bool>,
    /// How far the robot is from the plan before.
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<MotionAnswer>,
    /// Time from reading the request to the answer, ms.
    wall_ms: f64,
    /// The plan, as in a plan file.
    #[serde(skip_serializing_if = "Option::is_none")]
    plan: Option<Plan>,
}

/// The kinds of answers.
#[derive(Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum ResultKind {
    /// A plan.
    Found,
    /// No plan keeps every constraint; the next request starts from the plan before.
    Infeasible,
    /// The request is not valid and changed nothing.
    Error,
}

/// How far arms and board are from where the plan before has them.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct MotionAnswer {
    /// The largest difference of a joint, degrees (mm for a prismatic joint).
    pub largest_joint_deg: f64,
    /// The root of the sum of the squared differences of all joints, degrees.
    pub length_deg: f64,
    /// Distance of the board's centres, mm.
    pub board_mm: f64,
    /// Rotation of the board, degrees.
    pub board_deg: f64,
    /// True if a gripper grasps the board elsewhere or otherwise.
    pub regrasps: bool,
}

impl From<Motion> for MotionAnswer {
    fn from(motion: Motion) -> Self {
        let Motion { largest_joint_rad, length_rad, board_m, board_rad, regrasps } = motion;
        Self {
            largest_joint_deg: largest_joint_rad.to_degrees(),
            length_deg: length_rad.to_degrees(),
            board_mm: board_m * 1e3,
            board_deg: board_rad.to_degrees(),
            regrasps,
        }
    }
}

/// Answers requests until their stream ends, or until Ctrl-C.
pub fn replan(args: &ReplanArgs) -> Result<Exit, CliError> {
    if std::iter::once(&args.scenario).chain(&args.plan).any(|path| path == Path::new("-")) {
        return Err(CliError::Usage("-: found standard input, which has the requests, expected a file".into()));
    }
    let mut loaded = load_for_planning(&args.scenario)?;
    args.search.apply(&mut loaded.scenario.planner);
    let progress = Progress::begin("reading the maps", "")?;
    progress.leaves("every answer that was written is complete");
    let mut planner = cache::planner(&loaded.robot, args.cache);
    match &args.plan {
        Some(path) => resume(&mut planner, &loaded, path, &progress)?,
        None => planner.prepare_replanning(&loaded.scenario, &*progress)?,
    }
    progress.does("waiting for a request");
    progress.finish();
    let mut scenario = loaded.scenario;
    let mut exit = Exit::Met;
    let source = Path::new("standard input");
    let mut requests = std::io::stdin().lock();
    for line in 1.. {
        let text = input::line(&mut requests, MOST_LINE);
        let unreadable = |error| CliError::Machine(format!("failed to read {}:{line}: {error}", source.display()));
        let Some(text) = text.map_err(unreadable)? else { break };
        if text.trim().is_empty() {
            continue;
        }
        let start = Instant::now();
        let answer = match read_replan_request(source, line, &text, &mut scenario) {
            Ok(request) => match answered(&mut planner, &scenario, &request, &progress) {
                Ok(answer) => answer,
                Err(PlanError::Stopped) => return Ok(Exit::Interrupted),
                Err(error) => Answer::without_plan(ResultKind::Error, error.to_string()),
            },
            Err(error) => Answer::without_plan(ResultKind::Error, error.to_string()),
        };
        let answer = Answer { id: id_of(&text), line, wall_ms: start.elapsed().as_secs_f64() * 1e3, ..answer };
        exit = exit.max(answer.exit());
        if !written(&answer)? {
            break;
        }
    }
    Ok(exit)
}

/// Makes the plan that the robot holds now the one to start from.
fn resume(planner: &mut Planner, loaded: &LoadedScenario, path: &Path, progress: &Progress) -> Result<(), CliError> {
    let (plan, _) = scenario::read_plan(path, Some(&loaded.robot))?;
    if planner.resume(&loaded.scenario, &plan, progress)? {
        return Ok(());
    }
    let path = path.display();
    Err(CliError::Usage(format!(
        "{path}: found a plan that breaks a limit of the scenario, expected one that keeps all"
    )))
}

fn answered(
    planner: &mut Planner,
    scenario: &Scenario,
    request: &ReplanRequest,
    progress: &Progress,
) -> Result<Answer, PlanError> {
    let how = Replanning {
        most_motion_rad: request.most_motion_deg.map(f64::to_radians),
        keep_grasps: request.keep_grasps.unwrap_or_default(),
        search: request.search.unwrap_or(true),
    };
    let outcome = planner.replan(scenario, &how, progress)?;
    progress.finish();
    Ok(match outcome {
        Outcome::Found(Replanned { plan, motion, searched }) => Answer {
            searched: Some(searched),
            motion: motion.map(MotionAnswer::from),
            plan: Some(plan),
            ..Answer::new(ResultKind::Found)
        },
        Outcome::Infeasible(why) => Answer::without_plan(ResultKind::Infeasible, why.to_string()),
    })
}

impl Answer {
    fn new(result: ResultKind) -> Self {
        Self { id: None, line: 0, result, reason: None, searched: None, motion: None, wall_ms: 0.0, plan: None }
    }

    fn without_plan(result: ResultKind, reason: String) -> Self {
        Self { reason: Some(reason), ..Self::new(result) }
    }

    fn exit(&self) -> Exit {
        match self.result {
            ResultKind::Found => Exit::Met,
            ResultKind::Infeasible => Exit::Infeasible,
            ResultKind::Error => Exit::Input,
        }
    }
}

/// The id of a request, valid or not; `None` without one.
fn id_of(text: &str) -> Option<serde_json::Value> {
    serde_json::from_str::<serde_json::Value>(text).ok()?.get("id").filter(|id| !id.is_null()).cloned()
}

/// Writes an answer at once; false if nobody reads any more.
fn written(answer: &Answer) -> Result<bool, CliError> {
    let text = report::json::line(answer);
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(CliError::Stdout(error)),
        Ok(()) => Ok(true),
    }
}
