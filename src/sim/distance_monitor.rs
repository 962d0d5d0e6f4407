//! Distances during the simulation: of robot and board from the person (docs/method.md#87-person-overlap), and of the robot
//! from itself and from the board (docs/method.md#811-clearance).
//!
//! Neither is part of the dynamics, in which only pads and board collide: the person stands still in the posture of the plan,
//! and links pass through each other. The judge interprets the distances.

use nalgebra::Vector3;

use super::conditions::Conditions;
use crate::{
    check::CheckedPlan,
    collision::{BoardBody, Body, CollisionModel, Nearest, PersonClearance, PersonPart, Scene},
    model::trace::{PersonTouch, Sample, Trace},
    robot::{ArmState, Robot},
};

/// Interval between two measurements, s.
const INTERVAL_S: f64 = 0.01;

/// Below this distance from the person it is measured in every step, m: at up to 1 m/s no body gets from beyond it into
/// contact between two measurements.
const NEAR_PERSON_M: f64 = 0.01;

/// The same for the robot and itself or the board, which move by millimetres relative to each other: at up to 0.1 m/s. It is
/// less than the usual clearance of a plan.
const NEAR_ROBOT_M: f64 = 0.001;

/// The nearest bodies are first searched for within the last distance plus this, m: nearly always enough, and fast.
const SLACK_M: f64 = 0.02;

/// One distance that is watched.
struct Watched {
    /// Below this distance it is measured in every step, m.
    near_m: f64,
    /// The last measured distance, m; infinite if there are no bodies to measure.
    distance_m: f64,
    /// True before the first measurement.
    is_new: bool,
    /// The first pair of bodies that overlapped.
    touch: Option<[Body; 2]>,
}

impl Watched {
    fn new(near_m: f64) -> Self {
        Self { near_m, distance_m: f64::INFINITY, is_new: true, touch: None }
    }

    /// True if the distance has to be measured in a step.
    fn is_due(&self, step: usize, interval_steps: usize) -> bool {
        self.is_new || step.is_multiple_of(interval_steps) || self.distance_m < self.near_m
    }

    /// Takes the nearest bodies, searched for within a distance.
    fn measure(&mut self, within: impl Fn(f64) -> Option<Nearest>) {
        self.is_new = false;
        let found = within(self.distance_m + SLACK_M).or_else(|| within(f64::INFINITY));
        let Some(Nearest { bodies, distance_m }) = found else { return };
        self.distance_m = distance_m;
        if distance_m < 0.0 && self.touch.is_none() {
            self.touch = Some(bodies);
        }
    }
}

/// Watches the distances of a plan.
pub(super) struct DistanceMonitor<'a> {
    robot: &'a Robot,
    model: &'a CollisionModel,
    /// Indices of the robot's arms in the order of the samples.
    arms: Vec<usize>,
    board: &'a BoardBody,
    /// Interval between two measurements in steps.
    interval_steps: usize,
    /// The person, if the plan has one.
    person: Option<(PersonClearance, Watched)>,
    itself: Watched,
}

impl<'a> DistanceMonitor<'a> {
    /// The monitor of a plan.
    pub fn of(checked: &'a CheckedPlan<'_>, conditions: &Conditions) -> Self {
        let board = checked.board();
        let [x_mm, y_mm] = conditions.uncertainty.person_offset_mm;
        let moved_m = Vector3::new(x_mm, y_mm, 0.0) * 1e-3;
        let parts = || checked.person_parts().into_iter().map(|part| part.moved(&moved_m)).collect::<Vec<_>>();
        let person = checked.person().map(|_| PersonClearance::new(&parts(), board));
        Self {
            robot: checked.robot(),
            model: checked.collision(),
            arms: checked.arms().iter().map(|arm| arm.index).collect(),
            board,
            interval_steps: ((INTERVAL_S / conditions.settings.timestep_s).round() as usize).max(1),
            person: person.map(|person| (person, Watched::new(NEAR_PERSON_M))),
            itself: Watched::new(NEAR_ROBOT_M),
        }
    }

    /// Sets the distances of a sample: measured if due, otherwise those measured last.
    pub fn observe(&mut self, step: usize, sample: &mut Sample) {
        let is_due = |watched: &Watched| watched.is_due(step, self.interval_steps);
        let due = [self.person.as_ref().is_some_and(|(_, person)| is_due(person)), is_due(&self.itself)];
        if due.contains(&true) {
            self.measure(sample, due);
        }
        sample.person_distance_m = self.person.as_ref().map(|(_, person)| person.distance_m);
        sample.robot_clearance_m = Some(self.itself.distance_m).filter(|distance_m| distance_m.is_finite());
    }

    fn measure(&mut self, sample: &Sample, [of_person, of_itself]: [bool; 2]) {
        let states = self.arms.iter().zip(&sample.arms).map(|(&arm, state)| ArmState {
            arm,
            q_rad: &state.q_rad,
            finger_travel_m: [0, 1].map(|finger| state.finger_m[finger]),
        });
        let link_poses = self.robot.link_poses(&self.robot.positions(&states.collect::<Vec<_>>()));
        let (model, x_wo) = (self.model, sample.x_wo);
        if let Some((person, watched)) = self.person.as_mut().filter(|_| of_person) {
            watched.measure(|within_m| model.nearest_to_person(person, &link_poses, &x_wo, within_m));
        }
        if of_itself {
            let (holding, board) = (&self.arms[..], self.board);
            let scene = Scene { link_poses: &link_poses, holding, board, x_wo, person: &[], clearance_m: 0.0 };
            self.itself.measure(|within_m| model.nearest_of_robot(&scene, within_m));
        }
    }

    /// Another person, or the same one elsewhere; the first overlap so far is entered in the trace.
    pub fn replace_person(&mut self, parts: &[PersonPart], trace: &mut Trace) {
        self.enter(trace);
        let person = (!parts.is_empty()).then(|| PersonClearance::new(parts, self.board));
        self.person = person.map(|person| (person, Watched::new(NEAR_PERSON_M)));
    }

    /// Enters the first overlaps in the trace.
    pub fn enter(&self, trace: &mut Trace) {
        let names = |bodies: [Body; 2]| bodies.map(|body| body.describe(self.robot));
        let person = self.person.as_ref().and_then(|(_, person)| person.touch);
        let touched = person.map(|bodies| {
            let [body, part] = names(bodies);
            PersonTouch { body, part }
        });
        trace.person_touch = trace.person_touch.take().or(touched);
        trace.robot_touch = self.itself.touch.map(names);
    }
}
