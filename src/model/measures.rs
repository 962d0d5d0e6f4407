//! What a trace says about a hold, as numbers over time and as sentences. The judge derives them once; recordings and
//! reports show the same ones.

/// The measured series of a hold (METHOD section 8), from the reference, the end of settling, to the trace's end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measures {
    /// Time since the start of the simulation, s; one entry a sample, as in every series below.
    pub time_s: Vec<f64>,
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
}

/// What kind of news an [`Event`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A part of the simulation begins.
    Phase,
    /// A limit was crossed for the first time.
    LimitCrossed,
    /// The simulation broke down.
    BrokeDown,
}
