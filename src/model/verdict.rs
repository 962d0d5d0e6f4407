//! The verdict: what became of a hold, with every figure that decided it.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What became of a hold. The first limit that was crossed names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VerdictKind {
    /// Every limit was kept.
    Holds,
    /// A hand slid on the board.
    Slips,
    /// A hand turned on the board.
    Pivots,
    /// A pad lost its squeeze.
    Opens,
    /// The board fell.
    Drops,
    /// A joint was asked for more torque than it has.
    Saturates,
    /// The tool point of the board gave way.
    Deflects,
    /// A hand kept sliding under the steady load.
    Creeps,
    /// Bodies of the plan touch, or come closer to the person than they may, before anything moves; or robot or board
    /// touch the person as the arms give way.
    Touches,
    /// There is no plan.
    Infeasible,
    /// The simulation broke down, so nothing can be said.
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
            Self::Drops => "drops",
            Self::Saturates => "saturates",
            Self::Deflects => "deflects",
            Self::Creeps => "creeps",
            Self::Touches => "touches",
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
    /// The scenario's or plan's name.
    pub name: String,
    /// What became of the hold.
    pub verdict: VerdictKind,
    /// What the author expected.
    pub expected: VerdictKind,
    /// True when the two agree and a verdict was possible.
    pub met: bool,
    /// Every limit, with what was found; empty when there was nothing to simulate.
    pub checks: Vec<Check>,
    /// What the simulation made of the laws of mechanics; a verdict stands on all of them. Empty when nothing was
    /// simulated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub self_checks: Vec<Check>,
    /// The first limit that was crossed.
    pub first_failure: Option<Failure>,
    /// Largest torque over limit of each joint.
    pub peak_torque_ratio: BTreeMap<String, f64>,
    /// Why there is no plan or no verdict, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Versions of Benchdog and of the engines that decided.
    pub versions: BTreeMap<String, String>,
    /// Seed of the planner.
    pub seed: u64,
    /// SHA-256 of the trace: equal fingerprints, equal simulations, bit by bit. Empty when nothing was simulated.
    pub fingerprint: String,
}

impl Verdict {
    /// The check of this kind; none when it was not made.
    pub fn check(&self, kind: CheckKind) -> Option<&Check> {
        self.checks.iter().find(|check| check.name == kind)
    }
}

/// What a hold is checked for (METHOD section 8), in the order of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CheckKind {
    /// Largest translation of a hand on the board, mm.
    Slip,
    /// Largest rotation of a hand on the board, degrees.
    SlipRotation,
    /// Largest displacement of the tool point of the board, mm.
    Deflection,
    /// Rate of slip in the second half of the hold, mm/s.
    Creep,
    /// Largest demanded joint torque over its limit.
    TorqueRatio,
    /// Longest time that a pad went almost without squeeze, ms.
    PadOpen,
    /// Longest time that no pad touched the board, ms.
    ContactLost,
    /// Slip beyond which the board counts as dropped, mm.
    Drop,
    /// Deepest overlap of robot or board with the person, who stands still, mm; while they are apart, their least distance
    /// as a negative number. Not made when the plan has no person.
    PersonOverlap,
    /// The simulation itself: deepest penetration of pad and board, mm.
    Penetration,
    /// The simulation itself: largest rise of the energy that contacts and integration brought in, J.
    EnergyCreated,
    /// The simulation itself: the board's momentum against the forces on it at the end of the hold, N.
    ForceResidual,
    /// The simulation itself: largest difference between the travels of coupled fingers, mm.
    CouplingDrift,
}

impl CheckKind {
    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slip => "slip",
            Self::SlipRotation => "slip_rotation",
            Self::Deflection => "deflection",
            Self::Creep => "creep",
            Self::TorqueRatio => "torque_ratio",
            Self::PadOpen => "pad_open",
            Self::ContactLost => "contact_lost",
            Self::Drop => "drop",
            Self::PersonOverlap => "person_overlap",
            Self::Penetration => "penetration",
            Self::EnergyCreated => "energy_created",
            Self::ForceResidual => "force_residual",
            Self::CouplingDrift => "coupling_drift",
        }
    }

    /// The unit of its value, limit and margin; `1` for a ratio.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Slip
            | Self::Deflection
            | Self::Drop
            | Self::PersonOverlap
            | Self::Penetration
            | Self::CouplingDrift => "mm",
            Self::SlipRotation => "deg",
            Self::Creep => "mm/s",
            Self::TorqueRatio => "1",
            Self::PadOpen | Self::ContactLost => "ms",
            Self::EnergyCreated => "J",
            Self::ForceResidual => "N",
        }
    }

    /// The verdict on a hold whose first crossed limit this is.
    pub fn verdict(self) -> VerdictKind {
        match self {
            Self::Slip => VerdictKind::Slips,
            Self::SlipRotation => VerdictKind::Pivots,
            Self::Deflection => VerdictKind::Deflects,
            Self::Creep => VerdictKind::Creeps,
            Self::TorqueRatio => VerdictKind::Saturates,
            Self::PadOpen => VerdictKind::Opens,
            Self::ContactLost | Self::Drop => VerdictKind::Drops,
            Self::PersonOverlap => VerdictKind::Touches,
            Self::Penetration | Self::EnergyCreated | Self::ForceResidual | Self::CouplingDrift => {
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

/// One limit and what was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// What was measured.
    pub name: CheckKind,
    /// The worst value found.
    pub value: f64,
    /// The limit.
    pub limit: f64,
    /// `limit - value`: how much is left.
    pub margin: f64,
    /// The unit of all three.
    pub unit: String,
    /// True when the limit was kept.
    pub passed: bool,
}

/// The first crossing of a limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Failure {
    /// The check that failed.
    pub check: CheckKind,
    /// When, since the start of the simulation, s.
    pub time_s: f64,
    /// The multiple of the operation's wrench that acted then.
    pub load_factor: f64,
}
