//! The data that a recording is made from.

use nalgebra::Point3;

use crate::{
    model::{
        measures::{Event, Measures},
        muscle_work::MuscleBelly,
        plan::Plan,
        scenario::Scenario,
        tool_part::ToolPart,
        trace::Trace,
        verdict::Verdict,
    },
    robot::Robot,
};

/// The data of a recording.
#[derive(Clone, Copy, Debug)]
pub struct RecordingInput<'a> {
    /// The robot of the plan.
    pub robot: &'a Robot,
    /// The scenario under which the plan was simulated.
    pub scenario: &'a Scenario,
    /// The plan that was simulated.
    pub plan: &'a Plan,
    /// The trace of the simulation.
    pub trace: &'a Trace,
    /// The judge's time series.
    pub measures: &'a Measures,
    /// The judge's events.
    pub events: &'a [Event],
    /// The verdict.
    pub verdict: &'a Verdict,
    /// The person in the planned posture; `None` if the plan has no person.
    pub person: Option<&'a PersonShape>,
    /// The person over the stages of a task, each from a time on, s; empty for a plan of one hold.
    pub people: &'a [(f64, PersonShape)],
}

/// The person as drawn in the scene. The person does not move.
#[derive(Clone, Debug, PartialEq)]
pub struct PersonShape {
    /// The body's parts.
    pub capsules: Vec<Capsule>,
    /// Where the eyes are on the head, in W, m.
    pub eyes_w: [Point3<f64>; 2],
    /// The point between the eyes and the tool tip that it looks at, in W, m.
    pub line_of_sight_w: [Point3<f64>; 2],
    /// Outline on the floor of the sector in front of the person that the tool tip must be over, in W, m; empty if the
    /// posture has no limits.
    pub sector_w: Vec<Point3<f64>>,
    /// The parts of the tool in the hand.
    pub tool: Vec<ToolPart>,
    /// The muscles of the working arm; empty if their activations are not known.
    pub muscles: Vec<MuscleBelly>,
    /// The body points of the peripersonal metric, in W, m.
    pub points_w: Vec<Point3<f64>>,
}

/// A cylinder with hemispherical ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Centres of the hemispheres, in W, m.
    pub ends_w: [Point3<f64>; 2],
    /// Radius, m.
    pub radius_m: f64,
}
