//! What the pictures of a plan's stages are made from.

use crate::{
    model::{
        scenario::Scenario,
        staged_plan::{Holding, StagedPlan},
        staged_verdict::StagedVerdict,
    },
    robot::Robot,
};

/// A plan with what follows from it, and its verdict.
#[derive(Clone, Copy)]
pub struct JudgedPlan<'a> {
    /// The plan.
    pub plan: &'a StagedPlan,
    /// How the board is held before each stage, and after the last one.
    pub holdings: &'a [Holding],
    /// The robot.
    pub robot: &'a Robot,
    /// The scenario, with person and tool.
    pub scenario: &'a Scenario,
    /// The verdict.
    pub verdict: &'a StagedVerdict,
}

impl JudgedPlan<'_> {
    /// True if a person works on a piece.
    #[must_use]
    pub fn has_person(&self) -> bool {
        self.plan.worked_pieces().any(|(_, worked)| worked.human.is_some())
    }
}
