//! The scores of a finished plan's posture and their limits (docs/method.md#412-posture-score).
//!
//! They are step functions, so the search does not optimise them and does not compute them for its candidates: of the
//! candidates that it returns, the best whose scores keep their limits becomes the plan.

use super::outcome::Rejection;
use crate::{
    human::{ArmAngles, Human},
    model::{plan::Comfort, scenario::Limits, wrench::Wrench},
};

/// A score that exceeds its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exceeded {
    pub why: Rejection,
    /// The score's key in a plan.
    pub key: &'static str,
    pub found: u8,
    pub limit: u8,
}

/// A comfort with the RULA and REBA scores of its posture. `wrench_w` is the operation's about the tool tip, W axes.
pub fn scored(human: &Human, q_rad: &ArmAngles, wrench_w: &Wrench, comfort: Comfort) -> Comfort {
    let (rula, reba) = (human.rula(q_rad, wrench_w), human.reba(q_rad, wrench_w));
    Comfort { rula: Some(rula), reba: Some(reba), ..comfort }
}

/// The scores that exceed their limits.
pub fn beyond_limits(comfort: &Comfort, limits: &Limits) -> impl Iterator<Item = Exceeded> {
    let Comfort { rula, reba, .. } = *comfort;
    let scores = [
        (Rejection::Rula, "comfort.rula.score", rula.map(|rula| rula.score), limits.rula),
        (Rejection::RulaArm, "comfort.rula.arm_and_wrist", rula.map(|rula| rula.arm_and_wrist), limits.rula_arm),
        (Rejection::Reba, "comfort.reba.score", reba.map(|reba| reba.score), limits.reba),
    ];
    scores.into_iter().filter_map(|(why, key, found, limit)| {
        let (found, limit) = (found?, limit?);
        (found > limit).then_some(Exceeded { why, key, found, limit })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        human::default_tool,
        model::{
            operation::OperationKind,
            plan::{RebaScore, RulaScore},
            scenario::Person,
        },
    };

    const NO_COMFORT: Comfort = Comfort {
        muscular: 0.0,
        muscular_regularised: 0.0,
        muscular_intrinsic: None,
        shoulder: None,
        peripersonal_m: 0.0,
        peripersonal_scaled: None,
        objective: 0.0,
        activations: [0.0; 7],
        average: None,
        rula: None,
        reba: None,
    };
    const NO_LIMITS: Limits = Limits {
        slip_mm: 1.0,
        slip_deg: 2.0,
        deflection_mm: 5.0,
        creep_mm_s: 0.1,
        torque_ratio: 1.0,
        load_factor: 1.0,
        rula: None,
        rula_arm: None,
        reba: None,
    };

    fn comfort() -> Comfort {
        Comfort {
            rula: Some(RulaScore { score: 4, arm_and_wrist: 3, neck_trunk_legs: 5 }),
            reba: Some(RebaScore { score: 6, neck_trunk_legs: 4, arm_and_wrist: 5 }),
            ..NO_COMFORT
        }
    }

    fn reasons(limits: &Limits) -> Vec<&'static str> {
        beyond_limits(&comfort(), limits).map(|score| score.why.name()).collect()
    }

    #[test]
    fn a_score_is_rejected_above_its_limit_and_not_at_it() {
        assert_eq!(reasons(&NO_LIMITS), [""; 0]);
        assert_eq!(reasons(&Limits { rula: Some(4), rula_arm: Some(3), reba: Some(6), ..NO_LIMITS }), [""; 0]);
        assert_eq!(reasons(&Limits { rula: Some(3), ..NO_LIMITS }), ["RULA score"]);
        assert_eq!(reasons(&Limits { rula_arm: Some(2), ..NO_LIMITS }), ["RULA score of arm and wrist"]);
        assert_eq!(reasons(&Limits { reba: Some(5), ..NO_LIMITS }), ["REBA score"]);
        let all = Limits { rula: Some(1), rula_arm: Some(1), reba: Some(1), ..NO_LIMITS };
        let found: Vec<_> =
            beyond_limits(&comfort(), &all).map(|score| (score.key, score.found, score.limit)).collect();
        let expected =
            [("comfort.rula.score", 4, 1), ("comfort.rula.arm_and_wrist", 3, 1), ("comfort.reba.score", 6, 1)];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_comfort_without_scores_keeps_every_limit_until_it_has_them() {
        let strictest = Limits { rula: Some(1), rula_arm: Some(1), reba: Some(1), ..NO_LIMITS };
        assert_eq!(beyond_limits(&NO_COMFORT, &strictest).next(), None);
        // The arm is raised above 90 degrees and abducted.
        let human = Human::new(&Person::default(), &default_tool(OperationKind::Drill)).unwrap();
        let raised_rad = [100.0, 40.0, 0.0, 20.0, 60.0, 30.0, 20.0].map(f64::to_radians);
        let comfort = scored(&human, &raised_rad, &Wrench::default(), NO_COMFORT);
        assert_eq!(beyond_limits(&comfort, &strictest).count(), 3);
    }
}
