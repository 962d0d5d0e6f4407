//! The figures printed in the paper, from `assets/paper.toml` (`docs/method.md#9-the-papers-figures`).

use std::sync::LazyLock;

use serde::Deserialize;

use crate::model::{operation::OperationKind, scenario::PlannerKind};

/// The comforts of one planner for one kind of operation.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Printed {
    /// Cut or drill.
    pub task: OperationKind,
    /// The planner.
    pub planner: PlannerKind,
    /// Muscular comfort.
    pub muscular: f64,
    /// Peripersonal comfort.
    pub peripersonal: f64,
}

/// The duration of planning, s.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanTime {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Paper {
    table: Vec<Printed>,
    caption: Vec<Printed>,
    plan_s: PlanTime,
}

static PAPER: LazyLock<Paper> = LazyLock::new(|| {
    // The file is part of the program and read by a test.
    toml::from_str(include_str!("../../assets/paper.toml")).expect("the built-in figures of the paper are valid")
});

fn find(rows: &[Printed], task: OperationKind, planner: PlannerKind) -> Option<Printed> {
    rows.iter().find(|row| row.task == task && row.planner == planner).copied()
}

/// Table I: comforts divided by those of the random planner.
#[must_use]
pub fn table(task: OperationKind, planner: PlannerKind) -> Option<Printed> {
    find(&PAPER.table, task, planner)
}

/// The captions of the configurations in the figures.
#[must_use]
pub fn caption(task: OperationKind, planner: PlannerKind) -> Option<Printed> {
    find(&PAPER.caption, task, planner)
}

/// The duration of planning.
#[must_use]
pub fn plan_time() -> PlanTime {
    PAPER.plan_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::evaluation::KINDS;

    #[test]
    fn every_task_and_planner_has_its_figures() {
        for task in KINDS {
            for planner in PlannerKind::ALL {
                assert!(table(task, planner).is_some() && caption(task, planner).is_some(), "{task} {planner}");
            }
            let random = table(task, PlannerKind::Random).unwrap();
            assert_eq!((random.muscular, random.peripersonal), (1.0, 1.0));
        }
        assert_eq!((PAPER.table.len(), PAPER.caption.len()), (8, 8));
        assert!(plan_time().mean > plan_time().standard_deviation);
    }
}
