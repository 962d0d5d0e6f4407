//! The verdict on a simulated hold, with every value that decided it.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::muscle_work::MuscleWork;

/// The result of a scenario or plan. The first limit that was exceeded determines it (`docs/method.md#88-verdict`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VerdictKind {
    /// No limit was exceeded.
    Holds,
    /// A hand slipped on the board.
    Slips,
    /// A hand rotated relative to the board.
    Pivots,
    /// A pad lost its normal force.
    Opens,
    /// The wrench of a measured gripper exceeded its limits, and it let go.
    Detaches,
    /// The board fell.
    Drops,
    /// The demanded torque of a joint exceeded its limit.
    Saturates,
    /// The displacement of the tool point under the load exceeded its limit.
    Deflects,
    /// The displacement of the tool point under the board's weight exceeded its limit.
    Sags,
    /// A hand kept slipping under constant load.
    Creeps,
    /// In the planned pose, robot or board violate a clearance to the person; or they touched the person during the simulation.
    Touches,
    /// In the planned pose or during the simulation, the robot touches itself, or the board other than with its fingers.
    Collides,
    /// No feasible plan was found.
    Infeasible,
    /// The simulation is not valid: it broke down or failed a self-check.
    NoVerdict,
}

impl VerdictKind {
    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Slips => "slips",
            Self::Pivots => "pivots",
            Self::Opens => "opens",
            Self::Detaches => "detaches",
            Self::Drops => "drops",
            Self::Saturates => "saturates",
            Self::Deflects => "deflects",
            Self::Sags => "sags",
            Self::Creeps => "creeps",
            Self::Touches => "touches",
            Self::Collides => "collides",
            Self::Infeasible => "infeasible",
            Self::NoVerdict => "no_verdict",
        }
    }
}

impl std::fmt::Display for VerdictKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// The verdict on one scenario or plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Verdict {
    /// The file format, 1.
    pub format: u32,
    /// The number of the criteria by which it was judged (`docs/method.md#88-verdict`); 0 in files from before they were
    /// numbered.
    #[serde(default)]
    pub criteria: u32,
    /// The scenario's or plan's name.
    pub name: String,
    /// The verdict.
    pub verdict: VerdictKind,
    /// The expected verdict.
    pub expected: VerdictKind,
    /// True if the verdict is the expected one and not `no_verdict`.
    pub met: bool,
    /// One entry per limit; empty if nothing was simulated.
    pub checks: Vec<Check>,
    /// Checks of the simulation itself. Without all of them passing there is no verdict. Empty if nothing was simulated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub self_checks: Vec<Check>,
    /// The first limit that was exceeded.
    pub first_failure: Option<Failure>,
    /// Largest torque ratio of each joint: demanded torque divided by its limit.
    pub peak_torque_ratio: BTreeMap<String, f64>,
    /// Simulations at shorter time steps, if the first one was too near to a limit to decide. `None` if it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confirmation: Option<Confirmation>,
    /// Why there is no plan or no valid simulation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Assumptions of the simulation that this plan strains, such as that of a rigid board. They do not influence the verdict.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// What the muscles of the person's working arm do. Absent without a person. They do not influence the verdict.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub muscles: Option<MuscleWork>,
    /// Versions of Benchdog and of the engines that the verdict depends on.
    pub versions: BTreeMap<String, String>,
    /// Seed of the planner.
    pub seed: u64,
    /// SHA-256 of the trace. Simulations with equal fingerprints are equal bit by bit. Empty if nothing was simulated.
    pub fingerprint: String,
}

impl Verdict {
    /// The check of this kind; `None` if it was not made.
    #[must_use]
    pub fn check(&self, kind: CheckKind) -> Option<&Check> {
        self.checks.iter().find(|check| check.name == kind)
    }
}

/// The quantities that are checked, in the order of tables (`docs/method.md#8-judgement`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CheckKind {
    /// Largest translation of a hand on the board since the hand-over, mm.
    Slip,
    /// Largest rotation of a hand on the board since the hand-over, degrees.
    SlipRotation,
    /// Largest displacement of the board's tool point under the weight, from the hand-over to the load, mm.
    Sag,
    /// Largest displacement of the board's tool point under the load, mm.
    Deflection,
    /// Rate of slip in the second half of the hold, mm/s.
    Creep,
    /// Largest demanded joint torque divided by its limit.
    TorqueRatio,
    /// Largest ratio of a measured gripper's wrench to its limits.
    GripWrench,
    /// Longest time that a pad had almost no normal force, ms.
    PadOpen,
    /// Longest time without contact of any hand with the board, ms.
    ContactLost,
    /// Largest slip, mm; beyond the limit the board counts as dropped.
    Drop,
    /// Deepest overlap of robot or board with the person, who does not move, mm; without an overlap, the negative of the
    /// least distance. Not made if the plan has no person.
    PersonOverlap,
    /// Least distance of the robot from itself and from the board, mm; negative if they overlap. The only limit from below.
    Clearance,
    /// Self-check: deepest penetration of pad and board, mm.
    Penetration,
    /// Self-check: largest increase of the energy that contacts and integration added, J.
    EnergyCreated,
    /// Self-check: residual of the board's momentum balance at the end of the hold, N.
    ForceResidual,
    /// Self-check: largest difference between the travels of coupled fingers, mm.
    CouplingDrift,
    /// Self-check: largest fast oscillation of a pad's normal force, divided by the grip force, or of a measured gripper's ratio
    /// of its wrench to its limits.
    Chatter,
}

impl CheckKind {
    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slip => "slip",
            Self::SlipRotation => "slip_rotation",
            Self::Sag => "sag",
            Self::Deflection => "deflection",
            Self::Creep => "creep",
            Self::TorqueRatio => "torque_ratio",
            Self::GripWrench => "grip_wrench",
            Self::PadOpen => "pad_open",
            Self::ContactLost => "contact_lost",
            Self::Drop => "drop",
            Self::PersonOverlap => "person_overlap",
            Self::Clearance => "clearance",
            Self::Penetration => "penetration",
            Self::EnergyCreated => "energy_created",
            Self::ForceResidual => "force_residual",
            Self::CouplingDrift => "coupling_drift",
            Self::Chatter => "chatter",
        }
    }

    /// The unit of value, limit and margin; `1` for a ratio.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Slip
            | Self::Sag
            | Self::Deflection
            | Self::Drop
            | Self::PersonOverlap
            | Self::Clearance
            | Self::Penetration
            | Self::CouplingDrift => "mm",
            Self::SlipRotation => "deg",
            Self::Creep => "mm/s",
            Self::TorqueRatio | Self::GripWrench | Self::Chatter => "1",
            Self::PadOpen | Self::ContactLost => "ms",
            Self::EnergyCreated => "J",
            Self::ForceResidual => "N",
        }
    }

    /// True if the limit is the least permitted value and not the largest.
    #[must_use]
    pub fn is_least(self) -> bool {
        self == Self::Clearance
    }

    /// What is left of the limit, negative if it is violated: `limit - value`, or `value - limit` if it is the least permitted
    /// value.
    #[must_use]
    pub fn margin(self, value: f64, limit: f64) -> f64 {
        if self.is_least() { value - limit } else { limit - value }
    }

    /// The verdict if this is the first limit that was exceeded.
    pub fn verdict(self) -> VerdictKind {
        match self {
            Self::Slip => VerdictKind::Slips,
            Self::SlipRotation => VerdictKind::Pivots,
            Self::Sag => VerdictKind::Sags,
            Self::Deflection => VerdictKind::Deflects,
            Self::Creep => VerdictKind::Creeps,
            Self::TorqueRatio => VerdictKind::Saturates,
            Self::GripWrench => VerdictKind::Detaches,
            Self::PadOpen => VerdictKind::Opens,
            Self::ContactLost | Self::Drop => VerdictKind::Drops,
            Self::PersonOverlap => VerdictKind::Touches,
            Self::Clearance => VerdictKind::Collides,
            Self::Penetration | Self::EnergyCreated | Self::ForceResidual | Self::CouplingDrift | Self::Chatter => {
                VerdictKind::NoVerdict
            }
        }
    }
}

impl std::fmt::Display for CheckKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// A measured value and its limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// The measured quantity.
    pub name: CheckKind,
    /// The worst value.
    pub value: f64,
    /// The limit.
    pub limit: f64,
    /// `limit - value`; of a `clearance` `value - limit`.
    pub margin: f64,
    /// The unit of value, limit and margin.
    pub unit: String,
    /// True if the margin is not negative.
    pub passed: bool,
}

impl Check {
    /// The limit in a table, with three digits: `5.000`, or `>= 0.000` if it is the least permitted value.
    #[must_use]
    pub fn limit_text(&self) -> String {
        let sign = if self.name.is_least() { ">= " } else { "" };
        format!("{sign}{:.3}", self.limit)
    }
}

/// Simulations of one plan at shorter and shorter time steps (docs/method.md#812-confirmation).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Confirmation {
    /// Why the first simulation alone does not decide.
    pub because: String,
    /// The verdict at each time step, the scenario's first.
    pub runs: Vec<StepVerdict>,
}

/// The verdict at a time step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StepVerdict {
    /// The time step, s.
    pub timestep_s: f64,
    /// The verdict.
    pub verdict: VerdictKind,
    /// The first stage of a staged plan that does not hold, from 1; absent if all hold, and for a plan of one hold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stage: Option<usize>,
}

impl std::fmt::Display for Confirmation {
    /// `deflection 4.80 mm is within 10 % of its limit of 5 mm: 2 ms holds, 1 ms holds`; of a staged plan `1 ms slips in stage 3`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.because)?;
        for (index, StepVerdict { timestep_s, verdict, stage }) in self.runs.iter().enumerate() {
            let separator = if index == 0 { ':' } else { ',' };
            // Halves and quarters of round steps are short decimals.
            write!(f, "{separator} {} ms {verdict}", (timestep_s * 1e9).round() / 1e6)?;
            if let Some(stage) = stage {
                write!(f, " in stage {stage}")?;
            }
        }
        Ok(())
    }
}

/// The first time that a limit was exceeded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Failure {
    /// The check that failed.
    pub check: CheckKind,
    /// Time since the start of the simulation, s.
    pub time_s: f64,
    /// The multiple of the operation's wrench that was applied then.
    pub load_factor: f64,
}
