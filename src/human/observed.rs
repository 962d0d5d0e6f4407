//! The posture as an observer sees it who scores it by RULA or REBA (docs/method.md#412-posture-score).
//!
//! The arm is that of a right-handed person. Angles of upper arm and neck are relative to the trunk, which may lean. The head
//! follows the gaze from the eyes to the tool tip: with the gaze's declination `d` below the trunk's horizontal and the
//! declination `d_eyes` that the eyes alone give,
//!
//! ```text
//! neck flexion = d - min(max(d, 0), d_eyes)        neck turn = yaw of the gaze
//! ```
//!
//! A negative flexion is an extension: a gaze above the horizontal. Raised shoulders, supported arms, bending to the side and
//! unequal legs do not occur in this body model.

use nalgebra::Vector3;
use serde::Deserialize;

use super::{Human, ranges::ArmAngles, ranges::twist_rad};
use crate::model::{GRAVITY_W, wrench::Wrench};

/// Rounding of the elbow's place, m: an arm that is abducted is not behind the trunk.
const ROUNDING_M: f64 = 1e-9;

/// Thresholds that both scores leave to the observer, degrees.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Observer {
    /// The upper arm counts as abducted beyond this abduction q2.
    abducted_deg: f64,
    /// The upper arm counts as turned about itself beyond this twist from hanging.
    turned_deg: f64,
    /// The wrist counts as straight up to this flexion, extension or deviation.
    pub(super) neutral_wrist_deg: f64,
    /// The forearm counts as near the end of its range of pronation beyond this.
    twist_mid_range_deg: f64,
    /// Declination of the gaze that the eyes give without the head.
    eyes_down_deg: f64,
    /// The neck counts as twisted beyond this yaw of the gaze.
    neck_twisted_deg: f64,
    /// The neck turns no farther than this: beyond it the trunk counts as twisted too.
    neck_turn_deg: f64,
}

/// The parts of a posture, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observed {
    /// Angle between upper arm and trunk.
    pub upper_arm_deg: f64,
    /// True if the elbow is behind the shoulder.
    pub is_arm_behind: bool,
    pub is_arm_abducted: bool,
    pub is_arm_turned: bool,
    pub elbow_deg: f64,
    /// True if the wrist is beyond the body's middle, or farther out than the shoulder by the upper arm's radius.
    pub is_forearm_aside: bool,
    /// Flexion or extension of the wrist.
    pub wrist_deg: f64,
    pub is_wrist_deviated: bool,
    pub is_forearm_twisted: bool,
    /// Flexion of the neck, negative for an extension.
    pub neck_deg: f64,
    pub is_neck_twisted: bool,
    /// Forward lean of the trunk.
    pub trunk_deg: f64,
    pub is_trunk_twisted: bool,
}

impl Human {
    /// What an observer sees of a posture.
    pub(super) fn observed(&self, q_rad: &ArmAngles, observer: &Observer) -> Observed {
        let (body, frames) = (&self.body, self.arm.frames(q_rad));
        let [_, abduction_deg, _, elbow_deg, pronation_deg, flexion_deg, deviation_deg] = q_rad.map(f64::to_degrees);
        let upper_arm = frames.p_be_m - frames.p_bs_m;
        // Right arm: y_B points to the left.
        let outermost_m = body.p_bs_m.y - body.thickness.upper_arm_radius_m;
        let gaze = self.gaze_v(q_rad);
        let (down_deg, turn_deg) = (-gaze.pitch_rad.to_degrees(), gaze.yaw_rad.to_degrees().abs());
        Observed {
            upper_arm_deg: upper_arm.angle(&-Vector3::z()).to_degrees(),
            is_arm_behind: upper_arm.x < -ROUNDING_M,
            is_arm_abducted: abduction_deg > observer.abducted_deg,
            is_arm_turned: twist_rad(&frames.r_bu).to_degrees().abs() > observer.turned_deg,
            elbow_deg,
            is_forearm_aside: frames.p_bw_m.y > 0.0 || frames.p_bw_m.y < outermost_m,
            wrist_deg: flexion_deg.abs(),
            is_wrist_deviated: deviation_deg.abs() > observer.neutral_wrist_deg,
            is_forearm_twisted: pronation_deg.abs() > observer.twist_mid_range_deg,
            neck_deg: down_deg - down_deg.clamp(0.0, observer.eyes_down_deg),
            is_neck_twisted: turn_deg > observer.neck_twisted_deg,
            trunk_deg: body.lean_rad.to_degrees(),
            is_trunk_twisted: turn_deg > observer.neck_turn_deg,
        }
    }

    /// The load that the hand carries, the tool's weight and the tool's force together, as a mass, kg:
    /// `|f_W - m_tool g_W| / |g_W|`.
    pub(super) fn load_kg(&self, wrench_w: &Wrench) -> f64 {
        (wrench_w.force_n - GRAVITY_W * self.tool_kg).norm() / GRAVITY_W.norm()
    }
}

impl Observed {
    /// The band of the upper arm's angle, at most the second if the arm is behind the body.
    pub(super) fn upper_arm_band(&self, steps_deg: &[f64]) -> usize {
        let band = band(self.upper_arm_deg, steps_deg);
        if self.is_arm_behind { band.min(2) } else { band }
    }
}

/// The band of a value, from 1: one more than the number of steps that it exceeds.
pub(super) fn band(value: f64, steps: &[f64]) -> usize {
    1 + steps.iter().filter(|&&step| value > step).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        human::{
            default_tool, rula,
            testing::{average_man, worker},
        },
        model::{
            operation::OperationKind,
            scenario::{Hand, Person},
        },
    };

    fn observed(person: Person, q_deg: ArmAngles) -> Observed {
        let human = Human::new(&person, &default_tool(OperationKind::Drill)).unwrap();
        human.observed(&q_deg.map(f64::to_radians), rula::observer())
    }

    #[test]
    fn a_band_begins_above_its_step() {
        let steps = [0.0, 20.0, 60.0];
        assert_eq!([0.0, 0.1, 20.0, 20.1, 60.0, 60.1].map(|value| band(value, &steps)), [1, 2, 2, 3, 3, 4]);
    }

    #[test]
    fn the_head_follows_the_gaze_beyond_what_the_eyes_do() {
        let human = worker(Hand::Right, OperationKind::Drill);
        for shoulder_deg in [0.0, 40.0, 80.0, 110.0, 140.0] {
            let q_deg = [shoulder_deg, 0.0, 0.0, 30.0, 0.0, 0.0, 0.0];
            let gaze = human.gaze_v(&q_deg.map(f64::to_radians));
            let down_deg = -gaze.pitch_rad.to_degrees();
            // The three cases of the rule, by hand: extension, eyes alone, flexion.
            let expected_deg = match down_deg {
                down if down < 0.0 => down,
                down if down <= 15.0 => 0.0,
                down => down - 15.0,
            };
            let neck_deg = observed(average_man(), q_deg).neck_deg;
            assert!((neck_deg - expected_deg).abs() < 1e-12, "{shoulder_deg}: {neck_deg} and {expected_deg}");
        }
    }

    #[test]
    fn a_leaning_trunk_extends_the_neck_that_looks_ahead() {
        // The same arm relative to the trunk: the neck's angle to the trunk does not depend on the lean.
        let raised_deg = [95.0, 0.0, 0.0, 20.0, 0.0, 0.0, 0.0];
        let [upright, leaning] = [0.0, 15.0].map(|lean_deg| observed(Person { lean_deg, ..average_man() }, raised_deg));
        assert_eq!(leaning, Observed { trunk_deg: leaning.trunk_deg, ..upright });
        assert!((leaning.trunk_deg - 15.0).abs() < 1e-12 && upright.trunk_deg == 0.0);
        // In the body's frame the leaning person looks 15 degrees lower.
        let human = |lean_deg| {
            let person = Person { lean_deg, ..average_man() };
            Human::new(&person, &default_tool(OperationKind::Drill)).unwrap()
        };
        let pitch_rad = |human: Human| human.gaze(&human.tool_pose_b(&raised_deg.map(f64::to_radians))).pitch_rad;
        let lower_rad = pitch_rad(human(0.0)) - pitch_rad(human(15.0));
        // The gaze is nearly in the plane of symmetry.
        assert!((lower_rad.to_degrees() - 15.0).abs() < 2.0, "{lower_rad}");
    }

    #[test]
    fn neck_and_trunk_turn_with_the_gaze() {
        let human = worker(Hand::Right, OperationKind::Drill);
        let mut seen = [false; 3];
        for abduction_deg in (-6..=24).map(|step| f64::from(step) * 5.0) {
            // The raised, straight arm goes from the body's middle to its side.
            let q_deg = [80.0, abduction_deg, 0.0, 0.0, 0.0, 0.0, 0.0];
            let turn_deg = human.gaze_v(&q_deg.map(f64::to_radians)).yaw_rad.to_degrees().abs();
            let observed = observed(average_man(), q_deg);
            let expected = [turn_deg > 10.0, turn_deg > 60.0];
            assert_eq!([observed.is_neck_twisted, observed.is_trunk_twisted], expected, "{turn_deg}");
            seen[expected.iter().filter(|&&twisted| twisted).count()] = true;
        }
        assert_eq!(seen, [true; 3]);
    }

    #[test]
    fn the_upper_arm_counts_as_turned_by_its_twist() {
        let turned = |twist_deg| observed(average_man(), [0.0, 0.0, twist_deg, 80.0, 0.0, 0.0, 0.0]).is_arm_turned;
        assert_eq!([0.0, 44.0, 46.0, -44.0, -46.0].map(turned), [false, false, true, false, true]);
    }

    #[test]
    fn the_load_is_the_force_and_the_weight_of_the_tool() {
        // The drill's mass is 1.3 kg; 13 N upward besides.
        let human = worker(Hand::Right, OperationKind::Drill);
        let up_n = -GRAVITY_W.normalize() * 13.0;
        assert!((human.load_kg(&Wrench::from_force(up_n)) - (1.3 + 13.0 / GRAVITY_W.norm())).abs() < 1e-12);
        assert!((human.load_kg(&Wrench::default()) - 1.3).abs() < 1e-12);
    }
}
