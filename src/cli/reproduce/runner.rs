//! Runs one job of the evaluation: plans, simulates, searches the failing load. The result is cached on disk, so a stopped
//! run can continue.
//!
//! A cached result is valid only for the same executable, compared by its hash, and the same scenario: a different build
//! may plan differently under the same version.

use std::{
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

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
    model::plan::Plan,
    pipeline::{self, Run, recording},
    planner::Outcome,
    report::file,
    reproduce::{
        evaluation::HoldRow,
        jobs::{Job, Stage},
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
    /// The progress message; `None` for a cached result and one that was only planned.
    pub fn line(&self, job: &Job) -> Option<String> {
        let verdict = self.row.verdict.as_ref().filter(|_| self.is_new)?;
        let load = self.row.load_factor_simulated.map(|factor| format!(", up to {factor:.2} of the load"));
        Some(format!("{}: {}{}", job.name(), verdict.verdict, load.unwrap_or_default()))
    }
}

/// Runs jobs and caches their results in a folder.
pub struct JobRunner<'a> {
    robot: &'a Robot,
    progress: &'a Progress,
    planners: Planners,
    out: PathBuf,
    /// SHA-256 of this executable.
    executable: String,
    record: RecordChoice,
}

/// The file of a cached result.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CachedResult {
    fingerprint: String,
    hold: HoldRow,
}

impl<'a> JobRunner<'a> {
    /// A runner whose results go to the folder `out`.
    ///
    /// # Errors
    /// If the executable file cannot be read.
    pub fn new(robot: &'a Robot, out: &Path, args: &ReproduceArgs, progress: &'a Progress) -> Result<Self, CliError> {
        let executable = std::env::current_exe()
            .and_then(fs::read)
            .map_err(|error| CliError::Machine(format!("failed to read this program's own file: {error}")))?;
        Ok(Self {
            robot,
            progress,
            planners: Planners::new(args.cache),
            out: out.to_owned(),
            executable: base16ct::lower::encode_string(&Sha256::digest(executable)),
            record: args.record,
        })
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
        let result = CachedResult { fingerprint, hold: self.compute(job)? };
        // Serialisation fails only for maps whose keys are not strings; there are none.
        let bytes = serde_json::to_vec(&result).expect("a result has only string keys");
        let _writing = interrupt::writing();
        file::write_whole(&self.cache_path(job), &bytes)?;
        Ok(JobResult { row: result.hold, is_new: true })
    }

    /// SHA-256 of all that a result depends on: the executable, the scenario and the stage.
    fn fingerprint(&self, job: &Job) -> String {
        let inputs = serde_json::to_vec(&(&self.executable, &job.scenario, job.stage));
        base16ct::lower::encode_string(&Sha256::digest(inputs.expect("a scenario has only string keys")))
    }

    fn recording_path(&self, job: &Job) -> PathBuf {
        self.out.join("recordings").join(job.folder()).join(format!("{}.rrd", job.stem()))
    }

    fn is_recorded(&self, met: bool) -> bool {
        match self.record {
            RecordChoice::Never => false,
            RecordChoice::Failed => !met,
            RecordChoice::Always => true,
        }
    }

    /// True if a recording is wanted that an earlier run did not write.
    fn lacks_recording(&self, job: &Job, row: &HoldRow) -> bool {
        let wanted = row.verdict.as_ref().is_some_and(|verdict| self.is_recorded(verdict.met));
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
        if self.is_recorded(run.verdict.met)
            && let Some(bytes) = recording::encode(run, &job.scenario, self.robot)?
        {
            let _writing = interrupt::writing();
            return Ok(file::write_whole(&path, &bytes)?);
        }
        // A recording of an earlier run does not belong to this result.
        Ok(file::remove(&path)?)
    }
}

/// The cached result in a file, if it has this fingerprint.
fn read(path: &Path, fingerprint: &str) -> Option<HoldRow> {
    let cached: CachedResult = serde_json::from_slice(&input::kept(path, MOST_DOCUMENT).ok()?).ok()?;
    (cached.fingerprint == fingerprint).then_some(cached.hold)
}
