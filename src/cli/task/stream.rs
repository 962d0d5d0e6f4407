//! The stages of a task as they are planned, for a robot that carries them out meanwhile (docs/method.md#118-streaming).

use std::{
    fs::File,
    io::{self, Write as _},
    path::{Path, PathBuf},
    time::Instant,
};

use serde::Serialize;

use crate::{
    model::{
        staged_plan::{Stage, StagedPlan},
        staged_verdict::StageVerdict,
    },
    report::file::WriteError,
};

/// A line of the file: a stage, and when it was known.
#[derive(Serialize)]
struct StageLine<'a> {
    /// From 1.
    number: usize,
    /// Time since the search began, s.
    planned_s: f64,
    stage: &'a Stage,
}

/// A file to which stages are written while later ones are planned. Its first line is the plan without stages; each other line is a
/// stage.
pub struct StageStream {
    path: PathBuf,
    file: Result<File, io::Error>,
    start: Instant,
    planned_s: Vec<f64>,
}

impl StageStream {
    /// Creates the file, in place of an existing one. The search begins now.
    pub fn new(path: &Path) -> Result<Self, WriteError> {
        let create = || {
            std::fs::create_dir_all(path.parent().unwrap_or(Path::new("")))?;
            File::create(path)
        };
        let file = create().map_err(|source| WriteError { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned(), file: Ok(file), start: Instant::now(), planned_s: Vec::new() })
    }

    /// Writes what is new of a plan. The first error is kept until the end: the planner does not write.
    pub fn write(&mut self, plan: &StagedPlan) {
        let planned_s = self.start.elapsed().as_secs_f64();
        if let Ok(file) = &mut self.file
            && let Err(error) = write_new(file, plan, self.planned_s.len(), planned_s)
        {
            self.file = Err(error);
        }
        self.planned_s.resize(plan.stages.len(), planned_s);
    }

    /// When each stage was planned, s after the search began.
    pub fn finish(self) -> Result<Vec<f64>, WriteError> {
        let Self { path, file, planned_s, .. } = self;
        file.map(|_| planned_s).map_err(|source| WriteError { path, source })
    }
}

/// Writes the stages after the first `known` ones, all at once.
fn write_new(file: &mut File, plan: &StagedPlan, known: usize, planned_s: f64) -> io::Result<()> {
    let mut lines = Vec::new();
    if known == 0 {
        serde_json::to_writer(&mut lines, &StagedPlan { stages: Vec::new(), ..plan.clone() })?;
        lines.push(b'\n');
    }
    for (number, stage) in plan.stages.iter().enumerate().skip(known) {
        serde_json::to_writer(&mut lines, &StageLine { number: number + 1, planned_s, stage })?;
        lines.push(b'\n');
    }
    file.write_all(&lines)
}

/// How long the person waits for the planner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waiting {
    /// Before the first stage, s.
    pub first_s: f64,
    /// Between later stages, all together, s.
    pub later_s: f64,
}

impl Waiting {
    /// If every stage begins when it is planned and the one before has ended, with these times of planning, s after the search began,
    /// and these stages as they were simulated. Stages that were not simulated are not waited for.
    pub fn new(planned_s: &[f64], stages: &[StageVerdict]) -> Self {
        let first_s = planned_s.first().copied().unwrap_or(0.0);
        let (mut ended_s, mut later_s) = (first_s, 0.0);
        for (planned_s, stage) in planned_s.iter().zip(stages) {
            let begins_s = planned_s.max(ended_s);
            later_s += begins_s - ended_s;
            ended_s = begins_s + stage.to_s - stage.from_s;
        }
        Self { first_s, later_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::verdict::VerdictKind;

    fn stages(durations_s: &[f64]) -> Vec<StageVerdict> {
        let mut from_s = 0.0;
        let stage = |(number, duration_s): (usize, &f64)| {
            let stage = StageVerdict {
                stage: number + 1,
                kind: "hold".into(),
                from_s,
                to_s: from_s + duration_s,
                verdict: VerdictKind::Holds,
                checks: Vec::new(),
                self_checks: Vec::new(),
            };
            from_s = stage.to_s;
            stage
        };
        durations_s.iter().enumerate().map(stage).collect()
    }

    #[test]
    fn nobody_waits_for_stages_that_are_planned_while_others_are_carried_out() {
        let stages = stages(&[4.0, 4.0, 4.0]);
        assert_eq!(Waiting::new(&[2.0, 5.0, 9.5], &stages), Waiting { first_s: 2.0, later_s: 0.0 });
        // The second stage is planned 1 s after the first has ended, the third 0.5 s after the second.
        assert_eq!(Waiting::new(&[2.0, 7.0, 11.5], &stages), Waiting { first_s: 2.0, later_s: 1.5 });
        assert_eq!(Waiting::new(&[3.0, 3.0, 3.0], &stages), Waiting { first_s: 3.0, later_s: 0.0 });
        assert_eq!(Waiting::new(&[], &stages), Waiting { first_s: 0.0, later_s: 0.0 });
    }
}
