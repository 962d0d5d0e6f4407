//! Quantities and events that the judge derives from a trace. Recordings and reports show the same ones.

use super::verdict::CheckKind;

/// The measured series of a hold, from the hand-over of the board to the end of the valid part of the trace
/// (`docs/method.md#81-reference-states`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measures {
    /// Time since the start of the simulation, s. This and every series below have one entry per sample.
    pub time_s: Vec<f64>,
    /// The number of samples that are judged, from the first; those after them show what else happened, such as the release.
    pub judged: usize,
    /// The applied multiple of the operation's wrench.
    pub load_factor: Vec<f64>,
    /// Motion of each hand relative to the board.
    pub hands: Vec<HandMeasures>,
    /// Displacement in W of the board's tool point since the hand-over, mm; from the end of settling on that of its end.
    pub sag_mm: Vec<f64>,
    /// Displacement in W of the board's tool point since the end of settling, mm; 0 before.
    pub deflection_mm: Vec<f64>,
    /// Distance of the robot from itself and from the board, mm; empty if it was not measured.
    pub clearance_mm: Vec<f64>,
    /// Torque ratio of each joint.
    pub joints: Vec<JointMeasures>,
}

impl Measures {
    /// The series that a check judges; empty for a check that judges none of them.
    #[must_use]
    pub fn series(&self, kind: CheckKind) -> Vec<&[f64]> {
        match kind {
            CheckKind::Slip => self.hands.iter().map(|hand| hand.slip_mm.as_slice()).collect(),
            CheckKind::SlipRotation => self.hands.iter().map(|hand| hand.slip_deg.as_slice()).collect(),
            CheckKind::Sag => vec![&self.sag_mm],
            CheckKind::Deflection => vec![&self.deflection_mm],
            CheckKind::TorqueRatio => self.joints.iter().map(|joint| joint.torque_ratio.as_slice()).collect(),
            CheckKind::Clearance => vec![&self.clearance_mm],
            CheckKind::GripWrench => self.hands.iter().map(|hand| hand.grip_ratio.as_slice()).collect(),
            CheckKind::Creep
            | CheckKind::PadOpen
            | CheckKind::ContactLost
            | CheckKind::Drop
            | CheckKind::PersonOverlap
            | CheckKind::Penetration
            | CheckKind::EnergyCreated
            | CheckKind::ForceResidual
            | CheckKind::CouplingDrift
            | CheckKind::Chatter => Vec::new(),
        }
    }
}

/// Motion of one hand relative to the board since the hand-over.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HandMeasures {
    /// The arm's name.
    pub name: String,
    /// Translation in O of the point between the pads, mm.
    pub slip_mm: Vec<f64>,
    /// Rotation relative to the board, degrees.
    pub slip_deg: Vec<f64>,
    /// Ratio of the wrench of a measured gripper to its limits, 0 once it has let go; empty for a hand with pads.
    pub grip_ratio: Vec<f64>,
}

/// Torque ratio of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMeasures {
    /// The joint's name.
    pub name: String,
    /// Absolute value of the demanded torque divided by the joint's limit.
    pub torque_ratio: Vec<f64>,
}

/// An event in a trace that recordings and reports mark.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Time since the start of the simulation, s.
    pub time_s: f64,
    /// The kind of event.
    pub kind: EventKind,
    /// A description.
    pub text: String,
    /// The affected hand (`left hand`), pad (`left upper pad`) or joint; empty for the board and for phases.
    pub what: String,
}

/// The kind of an [`Event`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EventKind {
    /// A phase of the simulation begins.
    Phase,
    /// The limit of this check is exceeded for the first time.
    LimitCrossed(CheckKind),
    /// The simulation broke down: its state is no longer finite or valid.
    BrokeDown,
}

/// The upper end of a plot's axis that starts at 0 and shows a series and its limit: 1.1 times the larger of peak and
/// limit, where the peak counts at most four times the limit, so that the limit's line stays visible when a board is
/// dropped. Without a limit, or if it is 0, 1.1 times the peak.
#[must_use]
pub fn axis_top(peak: f64, limit: Option<f64>) -> f64 {
    let top = match limit.filter(|limit| *limit > 0.0) {
        Some(limit) => peak.clamp(limit, 4.0 * limit),
        None => peak,
    };
    if top > 0.0 && top.is_finite() { 1.1 * top } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::axis_top;

    #[test]
    fn an_axis_shows_the_limit_whatever_the_series_does() {
        // Far below the limit, above it, and dropped: 1.1 times the limit, the peak, four times the limit.
        for (peak, top) in [(0.1, 2.2), (3.0, 3.3), (500.0, 8.8)] {
            // Two multiplications of exact decimals: a rounding each.
            assert!((axis_top(peak, Some(2.0)) - top).abs() < 1e-12);
        }
        assert_eq!(axis_top(2.0, None), 2.2);
        assert_eq!(axis_top(0.0, Some(0.0)), 1.0);
        assert_eq!(axis_top(f64::INFINITY, None), 1.0);
    }
}
