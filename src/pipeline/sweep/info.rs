//! What a sweep is, for its summary.

use super::study::Study;
use crate::{
    cache::hash_of,
    model::{FORMAT, plan::Plan, sweep::Sweep},
    pipeline::versions::versions,
    planner::write_robot,
    sweep::info::{Fingerprints, Shard, SweepInfo},
};

/// What a sweep's description says beside its study.
#[derive(Clone, Copy, Debug)]
pub struct Description<'a> {
    /// The sweep.
    pub sweep: &'a Sweep,
    /// The width of the interval at which it ends early.
    pub until: Option<f64>,
    /// The part of the runs that is done.
    pub shard: Option<Shard>,
    /// The number of worst runs that are named, and recorded by the command.
    pub worst: usize,
}

/// The description of a sweep.
#[must_use]
pub fn info(study: &Study<'_>, of: &Description<'_>) -> SweepInfo {
    SweepInfo {
        format: FORMAT,
        name: study.checked.plan().name.clone(),
        expect: study.scenario.expect,
        runs: of.sweep.runs,
        until: of.until,
        sampling: of.sweep.sampling,
        seed: of.sweep.seed,
        shard: of.shard,
        screen: study.screen,
        recorded: of.worst,
        variables: of.sweep.variables.clone(),
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
