//! `benchdog schema`: JSON Schemas of the file formats, derived from the types that read and write them.

use schemars::{Schema, schema_for};

use super::{
    args::{SchemaArgs, SchemaOf},
    exit::{CliError, Exit},
    output,
    replan::Answer,
};
use crate::{
    model::{staged_plan::StagedPlan, staged_verdict::StagedVerdict, verdict::Verdict},
    scenario::{ReplanRequest, file::ScenarioFile, plan_input::PlanFile},
    sweep::summary::SweepSummary,
};

/// Prints a schema.
pub fn schema(args: &SchemaArgs) -> Result<Exit, CliError> {
    output::print(&schema_text(args.of))?;
    Ok(Exit::Met)
}

/// The schema of a format, as stored in `schemas/`.
fn schema_text(of: SchemaOf) -> String {
    let schema: Schema = match of {
        SchemaOf::Scenario => schema_for!(ScenarioFile),
        SchemaOf::Plan => schema_for!(PlanFile),
        SchemaOf::Verdict => schema_for!(Verdict),
        SchemaOf::StagedPlan => schema_for!(StagedPlan),
        SchemaOf::StagedVerdict => schema_for!(StagedVerdict),
        SchemaOf::Sweep => schema_for!(SweepSummary),
        SchemaOf::ReplanRequest => schema_for!(ReplanRequest),
        SchemaOf::ReplanAnswer => schema_for!(Answer),
    };
    // A JSON value can always be printed: its keys are strings and its numbers finite.
    let text = serde_json::to_string_pretty(&schema).expect("a JSON value prints");
    format!("{text}\n")
}
