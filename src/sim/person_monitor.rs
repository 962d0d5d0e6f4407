//! The person beside the hold: how far robot and board are from them while the arms give way.
//!
//! The person stands still in the posture of the plan and nothing pushes them: they are looked at, not simulated. Against
//! them go all links of the robot and the board; what goes with the tool is left out, as
//! [`StandingPerson`] has it. What the distance means is the judge's business.

use super::Conditions;
use crate::{
    check::CheckedPlan,
    collision::{CollisionModel, Nearest, StandingPerson},
    model::trace::{PersonTouch, Sample},
    robot::{ArmState, Robot},
};

/// How often the distance is measured, s.
const INTERVAL_S: f64 = 0.01;

/// Bodies nearer than this are measured in every step, m: at up to 1 m/s nothing comes from beyond it to a touch between two
/// measurements.
const NEAR_M: f64 = 0.01;

/// How much farther away than last time the nearest bodies are looked for at first, m: nearly always enough, and little to
/// look at.
const SLACK_M: f64 = 0.02;

/// The person of a plan.
pub(super) struct PersonMonitor<'a> {
    robot: &'a Robot,
    model: CollisionModel,
    person: StandingPerson,
    /// The robot's arms (indices) in the order of every sample.
    arms: Vec<usize>,
    /// How many steps the distance is measured after.
    every: usize,
    /// The distance as it was measured last, m.
    distance_m: f64,
    /// The first bodies that overlapped.
    pub touch: Option<PersonTouch>,
}

impl<'a> PersonMonitor<'a> {
    /// The person of a plan; `None` if the plan has none.
    pub fn of(checked: &CheckedPlan<'a>, conditions: &Conditions) -> Option<Self> {
        checked.person()?;
        Some(Self {
            robot: checked.robot(),
            model: CollisionModel::new(checked.robot()),
            person: StandingPerson::new(&checked.person_parts(), checked.plan().object.size_m),
            arms: checked.arms().iter().map(|arm| arm.index).collect(),
            every: ((INTERVAL_S / conditions.settings.timestep_s).round() as usize).max(1),
            distance_m: f64::INFINITY,
            touch: None,
        })
    }

    /// The least distance of robot and board from the person after a step, m, negative when they overlap: measured where
    /// it is due, else as it was measured last.
    pub fn distance_m(&mut self, step: usize, sample: &Sample) -> f64 {
        if step.is_multiple_of(self.every) || self.distance_m < NEAR_M {
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
