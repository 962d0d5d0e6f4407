//! Runs one job of the evaluation: plans, simulates, searches the failing load. The result is cached on disk, so a stopped
//! run can continue.
//!
//! A cached result is valid only for the same executable, compared by its hash, and the same scenario: a different build
//! may plan differently under the same version.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
    time::Instant,
};

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use sha2::{Digest, Sha256};

use super::circle;
use crate::{
    check::CheckedPlan,
    cli::{
        args::{RecordChoice, ReproduceArgs},
        exit::CliError,
        interrupt, margin,
        planners::Planners,
        progress::Progress,
    },
    input::{self, MOST_DOCUMENT},
    model::{plan::Plan, scenario::Scenario},
    pipeline::{self, Run, recording},
    planner::{Front, FrontPoint, Outcome},
    report::file,
    reproduce::{
        evaluation::{Circle, FrontRow, HoldRow},
        jobs::{Job, Stage},
        paper::Evaluation,
    },
    robot::Robot,
};

/// The result of a job.
pub struct JobResult {
    /// The plan and what became of it.
    pub row: HoldRow,
    /// False if it was read from the cache.
    is_new: bool,
}

impl JobResult {
    /// The progress message of a job with this name; `None` for a cached result and one that was only planned.
    pub fn line(&self, name: &str) -> Option<String> {
        let verdict = self.row.verdict.as_ref().filter(|_| self.is_new)?;
        let load = self.row.load_factor_simulated.map(|factor| format!(", up to {factor:.2} of the load"));
        Some(format!("{name}: {}{}", verdict.verdict, load.unwrap_or_default()))
    }
}

/// Runs the jobs of an evaluation and caches their results in a folder.
#[derive(Clone)]
pub struct JobRunner<'a> {
    evaluation: Evaluation,
    robot: &'a Robot,
    progress: &'a Progress,
    planners: Arc<Planners>,
    out: PathBuf,
    /// SHA-256 of this executable.
    executable: String,
    record: RecordChoice,
}

/// The file of a cached result.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CachedResult<T> {
    fingerprint: String,
    result: T,
}

impl<'a> JobRunner<'a> {
    /// The runner of the natural evaluation, whose results go to the folder `out`.
    ///
    /// # Errors
    /// If the executable file cannot be read.
    pub fn natural(
        robot: &'a Robot,
        out: &Path,
        args: &ReproduceArgs,
        progress: &'a Progress,
    ) -> Result<Self, CliError> {
        let executable = std::env::current_exe()
            .and_then(fs::read)
            .map_err(|error| CliError::Machine(format!("failed to read this program's own file: {error}")))?;
        Ok(Self {
            evaluation: Evaluation::Natural,
            robot,
            progress,
            planners: Arc::new(Planners::new(args.cache)),
            out: out.to_owned(),
            executable: base16ct::lower::encode_string(&Sha256::digest(executable)),
            record: args.record,
        })
    }

    /// The runner of the evaluation as printed, with a folder of its own and the same planners.
    pub fn printed(&self, out: &Path) -> Self {
        Self { evaluation: Evaluation::Printed, out: out.to_owned(), ..self.clone() }
    }

    /// Where the run's progress is shown.
    pub fn progress(&self) -> &'a Progress {
        self.progress
    }

    /// The name of a job in messages.
    pub fn name(&self, job: &Job) -> String {
        match self.evaluation {
            Evaluation::Natural => job.name(),
            Evaluation::Printed => format!("{}, {}", job.name(), self.evaluation.name()),
        }
    }

    /// The folder of the cache.
    pub fn folder(&self) -> PathBuf {
        self.out.join("work")
    }

    /// Computes the planner's maps for all jobs without a cached result.
    pub fn prepare(&self, jobs: &[Job]) {
        let uncached = jobs.iter().filter(|job| self.cached(job, &self.fingerprint(job)).is_none());
        self.planners.prepare(&uncached.map(|job| (self.robot, &job.scenario)).collect::<Vec<_>>(), self.progress);
    }

    /// The cached result of a job, unless it lacks a recording that is now wanted.
    fn cached(&self, job: &Job, fingerprint: &str) -> Option<HoldRow> {
        read(&self.cache_path(job), fingerprint).filter(|row| !self.lacks_recording(job, row))
    }

    fn cache_path(&self, job: &Job) -> PathBuf {
        self.folder().join(job.folder()).join(format!("{}.json", job.stem()))
    }

    /// The cached result of a job, or else a new one, which is then cached.
    ///
    /// # Errors
    /// If the plan cannot be simulated or a file cannot be written.
    pub fn run(&self, job: &Job) -> Result<JobResult, CliError> {
        let fingerprint = self.fingerprint(job);
        if let Some(row) = self.cached(job, &fingerprint) {
            return Ok(JobResult { row, is_new: false });
        }
        let row = write(&self.cache_path(job), fingerprint, self.compute(job)?)?;
        Ok(JobResult { row, is_new: true })
    }

    /// The front of both comforts for an operation, from the cache or else computed; `None` if there is no plan.
    ///
    /// # Errors
    /// If the search is stopped or a file cannot be written.
    pub fn front(&self, scenario: &Scenario) -> Result<Option<FrontRow>, CliError> {
        let path = self.folder().join("front").join(format!("{}.json", scenario.name));
        read_or_compute(&path, self.fingerprint_of(&("front", scenario)), || {
            self.progress.begins(&format!("{} front", scenario.name));
            let planner = self.planners.of(self.robot);
            let outcome = planner.search(scenario).watch(self.progress).front()?;
            Ok(outcome.found().map(|front| front_row(scenario, &front)))
        })
    }

    /// The whole circle, from the cache or else planned, compared, simulated and judged.
    ///
    /// # Errors
    /// If it cannot be planned or simulated, or a file cannot be written.
    pub fn circle(&self) -> Result<Circle, CliError> {
        let path = self.folder().join("circle.json");
        let fingerprint = self.fingerprint_of(&("circle", circle::SCENARIO));
        read_or_compute(&path, fingerprint, || circle::circle(&self.planners, self.progress))
    }

    /// SHA-256 of all that a job's result depends on: the executable, the scenario and the stage.
    fn fingerprint(&self, job: &Job) -> String {
        self.fingerprint_of(&(&job.scenario, job.stage))
    }

    /// SHA-256 of the executable and of inputs.
    fn fingerprint_of(&self, inputs: &impl Serialize) -> String {
        let inputs = serde_json::to_vec(&(&self.executable, inputs));
        base16ct::lower::encode_string(&Sha256::digest(inputs.expect("a scenario has only string keys")))
    }

    fn recording_path(&self, job: &Job) -> PathBuf {
        self.out.join("recordings").join(job.folder()).join(format!("{}.rrd", job.stem()))
    }

    /// True if a recording is wanted that an earlier run did not write.
    fn lacks_recording(&self, job: &Job, row: &HoldRow) -> bool {
        let wanted = row.verdict.as_ref().is_some_and(|verdict| self.record.wants(verdict.met));
        wanted && cfg!(feature = "recording") && !self.recording_path(job).exists()
    }

    fn compute(&self, job: &Job) -> Result<HoldRow, CliError> {
        let scenario = &job.scenario;
        let start = Instant::now();
        let outcome = self.planners.timed_plan(scenario, self.robot, self.progress)?;
        let mut row = HoldRow {
            operation: scenario.name.clone(),
            kind: scenario.operation.kind,
            planner: scenario.planner.kind,
            seed: scenario.planner.seed,
            plan: None,
            infeasible: None,
            verdict: None,
            load_factor_simulated: None,
            ended_by: None,
            plan_ms: start.elapsed().as_secs_f64() * 1e3,
            simulate_ms: None,
        };
        match outcome {
            Outcome::Infeasible(why) => row.infeasible = Some(why.to_string()),
            Outcome::Found(plan) => {
                // Without the time of the maps, which are shared by all plans.
                row.plan_ms = plan.planner.and_then(|planner| planner.wall_ms).unwrap_or(row.plan_ms);
                if job.stage != Stage::Plan {
                    self.simulate(job, &plan, &mut row)?;
                }
                row.plan = Some(plan);
            }
        }
        Ok(row)
    }

    fn simulate(&self, job: &Job, plan: &Plan, row: &mut HoldRow) -> Result<(), CliError> {
        let start = Instant::now();
        self.progress.simulates();
        let run = pipeline::run_plan(&job.scenario, self.robot, plan.clone(), &[], self.progress)?;
        row.simulate_ms = Some(start.elapsed().as_secs_f64() * 1e3);
        self.write_recording(job, &run)?;
        if job.stage == Stage::FailingLoad && run.simulated.is_some() {
            let guess = plan.stability.as_ref().map_or(1.0, |stability| stability.compliant_load_factor);
            let checked = CheckedPlan::new(self.robot, plan, &job.scenario.human, &job.scenario.tool)?;
            let found = margin::simulated(&checked, &job.scenario, guess, self.progress)?;
            row.load_factor_simulated = Some(found.holds_at);
            row.ended_by = Some(found.judgement.verdict);
        }
        row.verdict = Some(run.verdict);
        Ok(())
    }

    fn write_recording(&self, job: &Job, run: &Run) -> Result<(), CliError> {
        let path = self.recording_path(job);
        if self.record.wants(run.verdict.met)
            && let Some(bytes) = recording::encode(run, &job.scenario, self.robot)?
        {
            let _writing = interrupt::writing();
            return Ok(file::write_whole(&path, &bytes)?);
        }
        // A recording of an earlier run does not belong to this result.
        Ok(file::remove(&path)?)
    }
}

/// What a front says of its operation.
fn front_row(scenario: &Scenario, front: &Front) -> FrontRow {
    let [weight_muscular, weight_peripersonal] = scenario.comfort.weights();
    let objective = |point: &FrontPoint| {
        let [muscular, peripersonal_m] = point.comforts();
        weight_muscular * muscular + weight_peripersonal * peripersonal_m
    };
    FrontRow {
        operation: scenario.name.clone(),
        kind: scenario.operation.kind,
        points: front.points.len(),
        optima: front.optima,
        best_objective: front.points.iter().chain([&front.own]).map(objective).fold(f64::NEG_INFINITY, f64::max),
    }
}

/// The cached result in a file, or else a computed one, which is then cached.
fn read_or_compute<T: Serialize + DeserializeOwned>(
    path: &Path,
    fingerprint: String,
    compute: impl FnOnce() -> Result<T, CliError>,
) -> Result<T, CliError> {
    match read(path, &fingerprint) {
        Some(result) => Ok(result),
        None => write(path, fingerprint, compute()?),
    }
}

/// The cached result in a file, if it has this fingerprint.
fn read<T: DeserializeOwned>(path: &Path, fingerprint: &str) -> Option<T> {
    let cached: CachedResult<T> = serde_json::from_slice(&input::kept(path, MOST_DOCUMENT).ok()?).ok()?;
    (cached.fingerprint == fingerprint).then_some(cached.result)
}

/// Writes a result into its file, and returns it.
fn write<T: Serialize>(path: &Path, fingerprint: String, result: T) -> Result<T, CliError> {
    let cached = CachedResult { fingerprint, result };
    // Serialisation fails only for maps whose keys are not strings; there are none.
    let bytes = serde_json::to_vec(&cached).expect("a result has only string keys");
    let _writing = interrupt::writing();
    file::write_whole(path, &bytes)?;
    Ok(cached.result)
}
