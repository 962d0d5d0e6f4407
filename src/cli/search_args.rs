//! Arguments that override a scenario's search.

use std::num::NonZero;

use clap::{Args, ValueEnum};

use crate::model::scenario::{Budget, PlannerSettings};

/// Options that override a scenario's budget and seed.
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Search")]
pub struct SearchArgs {
    /// Search budget; overrides the scenario's
    #[arg(long, value_enum, value_name = "BUDGET")]
    pub budget: Option<BudgetChoice>,
    /// Largest number of candidates that a search evaluates; overrides the scenario's
    #[arg(long, value_name = "N")]
    pub evaluations: Option<NonZero<u64>>,
    /// Seed of the planner; overrides the scenario's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
}

/// A search budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BudgetChoice {
    /// For replanning while the person moves
    Fast,
    /// For one plan
    Default,
    /// A hundred times the default
    Exhaustive,
}

impl From<BudgetChoice> for Budget {
    fn from(choice: BudgetChoice) -> Self {
        match choice {
            BudgetChoice::Fast => Self::Fast,
            BudgetChoice::Default => Self::Default,
            BudgetChoice::Exhaustive => Self::Exhaustive,
        }
    }
}

impl SearchArgs {
    /// Overrides a scenario's settings.
    pub fn apply(&self, settings: &mut PlannerSettings) {
        settings.budget = self.budget.map_or(settings.budget, Budget::from);
        settings.evaluations = self.evaluations.map(NonZero::get).or(settings.evaluations);
        settings.seed = self.seed.unwrap_or(settings.seed);
    }
}
