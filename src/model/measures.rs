//! What a trace says about a hold, as numbers over time and as sentences. The judge derives them once; recordings and
//! reports show the same ones.

use super::verdict::CheckKind;

/// The measured series of a hold (METHOD section 8), from the reference, the end of settling, to the end of what can be believed of the trace.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measures {
    /// Time since the start of the simulation, s; one entry a sample, as in every series below.
    pub time_s: Vec<f64>,
    /// The multiple of the operation's wrench that acted.
    pub load_factor: Vec<f64>,
    /// How each hand moved on the board.
    pub hands: Vec<HandMeasures>,
    /// Displacement of the tool point of the board in the world, mm.
    pub deflection_mm: Vec<f64>,
    /// How hard each joint worked.
    pub joints: Vec<JointMeasures>,
}

/// How one hand moved on the board since the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct HandMeasures {
    /// The arm's name.
    pub name: String,
    /// Translation of the point between its pads, in the board's frame, mm.
    pub slip_mm: Vec<f64>,
    /// Rotation against the board, degrees.
    pub slip_deg: Vec<f64>,
}

/// How hard one joint worked.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMeasures {
    /// The joint's name.
    pub name: String,
    /// Size of the demanded torque over the joint's limit.
    pub torque_ratio: Vec<f64>,
}

/// Something that a reader of a recording wants to jump to.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// When, since the start of the simulation, s.
    pub time_s: f64,
    /// What kind of news it is.
    pub kind: EventKind,
    /// What happened, in words.
    pub text: String,
    /// What it happened to: a hand (`left hand`), a pad (`left upper pad`) or a joint; empty for the board and for phases.
    pub what: String,
}

/// What kind of news an [`Event`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A part of the simulation begins.
    Phase,
    /// The limit of this check was crossed for the first time.
    LimitCrossed(CheckKind),
    /// The simulation broke down.
    BrokeDown,
}

/// The top of an axis from zero that shows a series and its limit: with a tenth above the larger of both, but not
/// beyond four times the limit, lest a board that is lost press the limit's line to the floor. Without a limit, or with one
/// of zero, the peak decides.
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
        // Far below its limit, above it, and lost: 1.1 of the limit, of the peak, of four limits.
        for (peak, top) in [(0.1, 2.2), (3.0, 3.3), (500.0, 8.8)] {
            // Two multiplications of exact decimals: a rounding each.
            assert!((axis_top(peak, Some(2.0)) - top).abs() < 1e-12);
        }
        assert_eq!(axis_top(2.0, None), 2.2);
        assert_eq!(axis_top(0.0, Some(0.0)), 1.0);
        assert_eq!(axis_top(f64::INFINITY, None), 1.0);
    }
}
