//! What the pictures of a plan's stages are made from.

use crate::{
    model::{
        scenario::Scenario,
        staged_plan::{Holding, PersonDuring, StagedPlan},
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

    /// True if the person is a step back before the stage of this number, from 0.
    #[must_use]
    pub fn is_back_before(&self, number: usize) -> bool {
        let before = number.checked_sub(1).and_then(|before| self.plan.stages.get(before));
        before.is_some_and(|before| before.person() == PersonDuring::StepsBack)
    }
}
