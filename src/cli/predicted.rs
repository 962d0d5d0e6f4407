//! What the statics predict for a plan, as `benchdog margin` prints it.

use serde::Serialize;

use crate::{
    check::CheckedPlan,
    model::{lateral::LateralPush, scenario::Scenario},
    statics::{
        ContactModel, ContactModelError, HandModel, HandSensitivity, InternalForces, LoadCases, LoadFactor,
        LoadFactorOutcome, RobustOutcome, StabilityWorkspace, Variation,
    },
};

/// Gains below this are not printed: they round to 0.000.
const LEAST_GAIN: f64 = 5e-4;

/// The step of the grip force for which a gain is stated, N.
const GRIP_STEP_N: f64 = 1.0;
/// The step of measured wrench limits, per cent.
const LIMITS_STEP_PERCENT: f64 = 1.0;
/// The step of the friction coefficient.
const FRICTION_STEP: f64 = 0.01;
/// The step of a torque limit, N m.
const TORQUE_STEP_NM: f64 = 1.0;

/// What the statics predict.
#[derive(Clone, Debug, Serialize)]
pub struct Predicted {
    /// The largest multiple of the load that any distribution of forces resists (lambda*).
    pub best_case: f64,
    /// The limits that bind there.
    binding: Vec<String>,
    /// Upper bound of `best_case` by its certificate, independent of the solver.
    best_case_bound: f64,
    /// The largest multiple at nominal and at scaled friction and grip force alike; only if the scenario scales them.
    #[serde(skip_serializing_if = "Option::is_none")]
    robust: Option<Robust>,
    /// The largest multiple that compliant arms resist.
    pub compliant: f64,
    /// The limit that ends it.
    compliant_ended_by: Option<String>,
    /// The sideways push in the direction with the smallest compliant prediction; only if the scenario has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    lateral: Option<LateralPush>,
    /// What larger limits would add to `best_case`, largest first.
    gains: Vec<Gain>,
}

/// The load factor under uncertain friction and grip force.
#[derive(Clone, Debug, Serialize)]
struct Robust {
    load_factor: f64,
    /// The scenario's scales.
    friction_scale: f64,
    grip_force_scale: f64,
}

/// What a larger limit of a hand would add to the load factor, to first order.
#[derive(Clone, Debug, Serialize)]
struct Gain {
    hand: String,
    /// The limit and its step, with unit.
    change: String,
    load_factor: f64,
}

/// The prediction for a plan at the friction that it assumes, or the reason for its absence.
pub fn predicted(checked: &CheckedPlan<'_>, scenario: &Scenario) -> Result<Predicted, String> {
    let cases =
        LoadCases::of_plan(checked, scenario.grip.friction, &scenario.load).map_err(|error| error.to_string())?;
    of_cases(&cases, scenario).map_err(|error| error.to_string())?
}

/// Each figure is that of the worst case of the loads.
fn of_cases(cases: &LoadCases, scenario: &Scenario) -> Result<Result<Predicted, String>, ContactModelError> {
    let mut workspace = StabilityWorkspace::new();
    let (case, best_case) = workspace.least_load_factor(cases)?;
    let model = &cases.clone().into_case(case);
    let best_case = match best_case {
        LoadFactorOutcome::Solved(best_case) => best_case,
        LoadFactorOutcome::GravityInfeasible { certificate } => {
            let proof = if certificate.proves_infeasible(model)? { "proven by its certificate" } else { "not proven" };
            return Ok(Err(format!("the hands cannot hold the board's weight ({proof})")));
        }
        LoadFactorOutcome::Unknown { status } => return Ok(Err(format!("the solver stopped early: {status}"))),
    };
    let (compliant_case, compliant) = workspace.least_compliant_load_factor(cases, &scenario.limits)?;
    Ok(Ok(Predicted {
        best_case_bound: best_case.dual.upper_bound(model)?,
        robust: robust(&mut workspace, model, scenario)?,
        gains: gains(model, &best_case),
        best_case: best_case.load_factor,
        binding: best_case.binding,
        compliant: compliant.load_factor,
        compliant_ended_by: compliant.first_limit.map(|limit| limit.to_string()),
        lateral: cases.push(compliant_case),
    }))
}

/// The load factor of the worst case at nominal and scaled friction and grip force; `None` if the scenario scales neither, or without a
/// result. The arms do not measure either, so their internal force is the same in both cases.
fn robust(
    workspace: &mut StabilityWorkspace,
    model: &ContactModel,
    scenario: &Scenario,
) -> Result<Option<Robust>, ContactModelError> {
    let (friction_scale, grip_force_scale) =
        (scenario.uncertainty.friction_scale, scenario.uncertainty.grip_force_scale);
    if friction_scale == 1.0 && grip_force_scale == 1.0 {
        return Ok(None);
    }
    let nominal = Variation { load: model.load, friction_ratio: 1.0, grip_force_ratio: 1.0 };
    let scaled = Variation { friction_ratio: friction_scale, grip_force_ratio: grip_force_scale, ..nominal };
    let load_factor = match workspace.robust_load_factor(model, &[nominal, scaled], InternalForces::Fixed)? {
        RobustOutcome::Solved(found) => found.load_factor,
        RobustOutcome::GravityInfeasible { .. } => 0.0,
        _ => return Ok(None),
    };
    Ok(Some(Robust { load_factor, friction_scale, grip_force_scale }))
}

fn gains(model: &ContactModel, best_case: &LoadFactor) -> Vec<Gain> {
    let hands = model.hands.iter().zip(&best_case.sensitivity.hands);
    let mut gains: Vec<Gain> = hands.flat_map(|(hand, by)| gains_of_hand(hand, by)).collect();
    gains.retain(|gain| gain.load_factor >= LEAST_GAIN);
    gains.sort_by(|one, other| other.load_factor.total_cmp(&one.load_factor));
    gains
}

fn gains_of_hand(hand: &HandModel, by: &HandSensitivity) -> Vec<Gain> {
    let gain = |change: String, load_factor: f64| Gain { hand: hand.name.clone(), change, load_factor };
    let mut gains = vec![
        gain(format!("measured limits +{LIMITS_STEP_PERCENT} %"), by.per_measured_limits * LIMITS_STEP_PERCENT / 100.0),
        gain(format!("grip force +{GRIP_STEP_N} N"), by.per_grip_force_n * GRIP_STEP_N),
        gain(format!("pad friction +{FRICTION_STEP}"), by.per_friction.iter().sum::<f64>() * FRICTION_STEP),
    ];
    let joints = hand.joints.iter().zip(by.per_effort_nm.iter());
    gains.extend(joints.map(|(joint, per_nm)| {
        gain(format!("torque limit of {joint} +{TORQUE_STEP_NM} N m"), per_nm * TORQUE_STEP_NM)
    }));
    gains
}

impl Predicted {
    /// Its lines in the table of load factors, and the table of gains.
    pub fn text(&self) -> String {
        let ended_by = self.compliant_ended_by.as_deref().unwrap_or("nothing up to 100");
        let mut text = format!("compliant prediction {:7.3}  {ended_by}\n", self.compliant);
        text.push_str(&format!("best case (lambda*)  {:7.3}  {}\n", self.best_case, self.binding.join(", ")));
        text.push_str(&format!("certified bound      {:7.3}  upper bound of the best case\n", self.best_case_bound));
        if let Some(Robust { load_factor, friction_scale, grip_force_scale }) = &self.robust {
            text.push_str(&format!(
                "robust load factor   {load_factor:7.3}  nominal, and friction x {friction_scale}, grip x {grip_force_scale}\n"
            ));
        }
        if let Some(push) = &self.lateral {
            text.push_str(&format!("sideways push        {push}: the worst direction of the compliant prediction\n"));
        }
        if !self.gains.is_empty() {
            text.push_str("\nhand      change                          best case\n");
        }
        for Gain { hand, change, load_factor } in &self.gains {
            text.push_str(&format!("{hand:<8}  {change:<30}  {load_factor:+9.3}\n"));
        }
        text
    }
}
