//! One hold of the evaluation: planned, simulated, its failing load looked for, and kept on disk, so that a run that was
//! stopped goes on where it was.
//!
//! What is kept counts only for the program that made it, to the byte, and for the same scenario: another program may plan
//! otherwise under the same version.

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
        args::RecordChoice,
        exit::CliError,
        margin,
        pipeline::{self, Run},
        planners::Planners,
        recording,
    },
    model::{
        plan::Plan,
        scenario::{PlannerKind, Scenario, StabilityKind},
    },
    planner::Outcome,
    report::{
        file,
        reproduce::{FIRST_SEED, Hold},
    },
    robot::Robot,
};

/// How far a hold is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Work {
    /// It is planned.
    Plan,
    /// And simulated under its load.
    Simulate,
    /// And simulated under more, until it fails.
    FailingLoad,
}

/// A hold that is asked for.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scenario, with planner and seed.
    pub scenario: Scenario,
    /// What of the default it departs in; none for the evaluation itself.
    pub variant: Option<&'static str>,
    /// How far it is followed.
    pub work: Work,
}

/// The jobs of one operation: every planner, and the random one with so many seeds. The hold of the first seed is followed
/// as far as `first` says, the others are planned.
pub fn jobs_of(scenario: &Scenario, random_seeds: u64, first: Work) -> Vec<Job> {
    let mut jobs = Vec::new();
    for kind in PlannerKind::ALL {
        let seeds = if kind == PlannerKind::Random { random_seeds } else { 1 };
        for seed in FIRST_SEED..FIRST_SEED + seeds {
            let mut scenario = scenario.clone();
            scenario.planner.kind = kind;
            scenario.planner.seed = seed;
            jobs.push(Job { scenario, variant: None, work: if seed == FIRST_SEED { first } else { Work::Plan } });
        }
    }
    jobs
}

/// The comfort planner's hold when the planner asks for no more than the paper's stability: that some forces hold the load.
pub fn best_case(scenario: &Scenario) -> Job {
    let mut scenario = scenario.clone();
    scenario.planner.kind = PlannerKind::Comfort;
    scenario.planner.seed = FIRST_SEED;
    scenario.planner.stability = StabilityKind::Paper;
    Job { scenario, variant: Some("the paper's stability"), work: Work::Simulate }
}

impl Job {
    /// `cut-01 random 7`, for people.
    pub fn name(&self) -> String {
        let planner = &self.scenario.planner;
        let variant = self.variant.map_or_else(String::new, |name| format!(" ({name})"));
        format!("{} {} {}{variant}", self.scenario.name, planner.kind, planner.seed)
    }

    /// The folder of what departs from the default; none of the evaluation itself.
    fn folder(&self) -> String {
        self.variant.map_or_else(String::new, |name| name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"))
    }

    /// The file name of what is kept or recorded, without its ending.
    fn stem(&self) -> String {
        let planner = &self.scenario.planner;
        format!("{}-{}-{}", self.scenario.name, planner.kind, planner.seed)
    }
}

/// A hold, and whether it was made just now.
pub struct Done {
    /// The hold.
    pub hold: Hold,
    fresh: bool,
}

impl Done {
    /// What is said of it: nothing of what was kept or only planned.
    pub fn line(&self, job: &Job) -> Option<String> {
        let verdict = self.hold.verdict.as_ref().filter(|_| self.fresh)?;
        let load = self.hold.load_factor_simulated.map(|factor| format!(", up to {factor:.2} of the load"));
        Some(format!("{}: {}{}", job.name(), verdict.verdict, load.unwrap_or_default()))
    }
}

/// Where holds are made and kept.
pub struct Workshop<'a> {
    robot: &'a Robot,
    planners: Planners,
    out: PathBuf,
    program: String,
    record: RecordChoice,
}

/// A hold as it is kept.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    fingerprint: String,
    hold: Hold,
}

impl<'a> Workshop<'a> {
    /// A workshop whose results go into this folder.
    ///
    /// # Errors
    /// When this program cannot be read.
    pub fn new(robot: &'a Robot, out: &Path, record: RecordChoice) -> Result<Self, CliError> {
        let program = std::env::current_exe()
            .and_then(fs::read)
            .map_err(|error| CliError::Machine(format!("failed to read this program's own file: {error}")))?;
        Ok(Self {
            robot,
            planners: Planners::default(),
            out: out.to_owned(),
            program: hex(&Sha256::digest(program)),
            record,
        })
    }

    /// Where holds are kept.
    pub fn folder(&self) -> PathBuf {
        self.out.join("work")
    }

    /// Makes the planner's maps for all jobs whose holds are not kept.
    pub fn prepare(&self, jobs: &[Job]) {
        let to_be_planned = jobs.iter().filter(|job| self.kept(job, &self.fingerprint(job)).is_none());
        self.planners.prepare(&to_be_planned.map(|job| (self.robot, &job.scenario)).collect::<Vec<_>>());
    }

    /// The hold of a job, if it is kept and needs no new recording.
    fn kept(&self, job: &Job, fingerprint: &str) -> Option<Hold> {
        read(&self.path(job), fingerprint).filter(|hold| !self.lacks_recording(job, hold))
    }

    fn path(&self, job: &Job) -> PathBuf {
        self.folder().join(job.folder()).join(format!("{}.json", job.stem()))
    }

    /// The hold of a job: the one that is kept, or a new one, which is kept.
    ///
    /// # Errors
    /// When it cannot be simulated or kept.
    pub fn hold(&self, job: &Job) -> Result<Done, CliError> {
        let fingerprint = self.fingerprint(job);
        if let Some(hold) = self.kept(job, &fingerprint) {
            return Ok(Done { hold, fresh: false });
        }
        let kept = Kept { fingerprint, hold: self.make(job)? };
        // Serialisation fails only for maps with keys that are no strings, and there are none.
        let bytes = serde_json::to_vec(&kept).expect("a hold has only string keys");
        file::write_whole(&self.path(job), &bytes)?;
        Ok(Done { hold: kept.hold, fresh: true })
    }

    /// SHA-256 of all that a hold depends on: this program, the scenario and how far it is followed.
    fn fingerprint(&self, job: &Job) -> String {
        let asked = serde_json::to_vec(&(&self.program, &job.scenario, job.work));
        hex(&Sha256::digest(asked.expect("a scenario has only string keys")))
    }

    fn recording_path(&self, job: &Job) -> PathBuf {
        self.out.join("recordings").join(job.folder()).join(format!("{}.rrd", job.stem()))
    }

    fn is_to_be_recorded(&self, met: bool) -> bool {
        match self.record {
            RecordChoice::Never => false,
            RecordChoice::Failed => !met,
            RecordChoice::Always => true,
        }
    }

    /// True when a recording is asked for that an earlier run did not make.
    fn lacks_recording(&self, job: &Job, hold: &Hold) -> bool {
        let wanted = hold.verdict.as_ref().is_some_and(|verdict| self.is_to_be_recorded(verdict.met));
        wanted && cfg!(feature = "recording") && !self.recording_path(job).exists()
    }

    fn make(&self, job: &Job) -> Result<Hold, CliError> {
        let scenario = &job.scenario;
        let start = Instant::now();
        let outcome = self.planners.timed_plan(scenario, self.robot, None)?;
        let mut hold = Hold {
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
            Outcome::Infeasible(why) => hold.infeasible = Some(why.to_string()),
            Outcome::Found(plan) => {
                // Without the map, which is made once for all plans.
                hold.plan_ms = plan.planner.and_then(|planner| planner.wall_ms).unwrap_or(hold.plan_ms);
                if job.work != Work::Plan {
                    self.simulate(job, &plan, &mut hold)?;
                }
                hold.plan = Some(plan);
            }
        }
        Ok(hold)
    }

    fn simulate(&self, job: &Job, plan: &Plan, hold: &mut Hold) -> Result<(), CliError> {
        let start = Instant::now();
        let run = pipeline::run_plan(&job.scenario, self.robot, plan.clone())?;
        hold.simulate_ms = Some(start.elapsed().as_secs_f64() * 1e3);
        self.write_recording(job, &run)?;
        if job.work == Work::FailingLoad && run.simulated.is_some() {
            let guess = plan.stability.as_ref().map_or(1.0, |stability| stability.compliant_load_factor);
            let checked = CheckedPlan::new(self.robot, plan, &job.scenario.tool)?;
            let found = margin::simulated(&checked, &job.scenario, guess)?;
            hold.load_factor_simulated = Some(found.holds_at);
            hold.ended_by = Some(found.judgement.verdict);
        }
        hold.verdict = Some(run.verdict);
        Ok(())
    }

    fn write_recording(&self, job: &Job, run: &Run) -> Result<(), CliError> {
        let path = self.recording_path(job);
        if self.is_to_be_recorded(run.verdict.met)
            && let Some(bytes) = recording::encode(run, &job.scenario, self.robot)?
        {
            return Ok(file::write_whole(&path, &bytes)?);
        }
        // What an earlier program recorded is not of this hold.
        Ok(file::remove(&path)?)
    }
}

/// The hold that is kept in a file, if it is the one that is asked for.
fn read(path: &Path, fingerprint: &str) -> Option<Hold> {
    let kept: Kept = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
    (kept.fingerprint == fingerprint).then_some(kept.hold)
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
