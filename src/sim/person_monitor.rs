//! Distance of robot and board from the person during the simulation (docs/method.md#87-person-overlap).
//!
//! The person stands still in the posture of the plan and is not part of the dynamics. All links of the robot and the
//! board are measured against them, without the body parts that move with the tool (see [`PersonClearance`]). The judge
//! interprets the distance.

use super::conditions::Conditions;
use crate::{
    check::CheckedPlan,
    collision::{CollisionModel, Nearest, PersonClearance},
    model::trace::{PersonTouch, Sample},
    robot::{ArmState, Robot},
};

/// Interval between two measurements, s.
const INTERVAL_S: f64 = 0.01;

/// Below this distance it is measured in every step, m: at up to 1 m/s no body gets from beyond it into contact between
/// two measurements.
const NEAR_M: f64 = 0.01;

/// The nearest bodies are first searched for within the last distance plus this, m: nearly always enough, and fast.
const SLACK_M: f64 = 0.02;

/// Monitors the distance of the person of a plan.
pub(super) struct PersonMonitor<'a> {
    robot: &'a Robot,
    model: CollisionModel,
    person: PersonClearance,
    /// Indices of the robot's arms in the order of the samples.
    arms: Vec<usize>,
    /// Interval between two measurements in steps.
    interval_steps: usize,
    /// The last measured distance, m.
    distance_m: f64,
    /// The first pair of bodies that overlapped.
    pub touch: Option<PersonTouch>,
}

impl<'a> PersonMonitor<'a> {
    /// The monitor of a plan's person; `None` if the plan has no person.
    pub fn of(checked: &CheckedPlan<'a>, conditions: &Conditions) -> Option<Self> {
        checked.person()?;
        Some(Self {
            robot: checked.robot(),
            model: CollisionModel::new(checked.robot()),
            person: PersonClearance::new(&checked.person_parts(), checked.plan().object.size_m),
            arms: checked.arms().iter().map(|arm| arm.index).collect(),
            interval_steps: ((INTERVAL_S / conditions.settings.timestep_s).round() as usize).max(1),
            distance_m: f64::INFINITY,
            touch: None,
        })
    }

    /// The smallest distance of robot and board from the person after a step, m, negative if they overlap. Measured if
    /// due, otherwise the last measured value.
    pub fn distance_m(&mut self, step: usize, sample: &Sample) -> f64 {
        if step.is_multiple_of(self.interval_steps) || self.distance_m < NEAR_M {
            self.measure(sample);
        }
        self.distance_m
    }

    fn measure(&mut self, sample: &Sample) {
        let states = self.arms.iter().zip(&sample.arms).map(|(&arm, state)| ArmState {
            arm,
            q_rad: &state.q_rad,
            finger_travel_m: [0, 1].map(|finger| state.finger_m[finger]),
        });
        let link_poses = self.robot.link_poses(&self.robot.positions(&states.collect::<Vec<_>>()));
        let within = |within_m| self.model.nearest_to_person(&self.person, &link_poses, &sample.x_wo, within_m);
        let found = within(self.distance_m + SLACK_M).or_else(|| within(f64::INFINITY));
        let Some(Nearest { bodies, distance_m }) = found else { return };
        self.distance_m = distance_m;
        if distance_m < 0.0 && self.touch.is_none() {
            let [body, part] = bodies.map(|body| body.describe(self.robot));
            self.touch = Some(PersonTouch { body, part });
        }
    }
}
