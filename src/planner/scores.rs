//! The scores of a finished plan's posture and their limits (docs/method.md#412-posture-score).
//!
//! They are step functions, so the search does not optimise them and does not compute them for its candidates: of the
//! candidates that it returns, the best whose scores keep their limits becomes the plan.

use super::outcome::Rejection;
use crate::{
    human::{ArmAngles, Human},
    model::{
        plan::{Comfort, PostureScore, exceeded_scores},
        scenario::Limits,
        wrench::Wrench,
    },
};

/// A comfort with the RULA and REBA scores of its posture. `wrench_w` is the operation's about the tool tip, W axes.
pub fn scored(human: &Human, q_rad: &ArmAngles, wrench_w: &Wrench, comfort: Comfort) -> Comfort {
    let (rula, reba) = (human.rula(q_rad, wrench_w), human.reba(q_rad, wrench_w));
    Comfort { rula: Some(rula), reba: Some(reba), ..comfort }
}

/// Why a posture's scores reject a plan: the first that exceeds its limit.
pub fn rejection(comfort: &Comfort, limits: &Limits) -> Option<Rejection> {
    exceeded_scores(comfort.rula, comfort.reba, limits).next().map(|exceeded| match exceeded.score {
        PostureScore::Rula => Rejection::Rula,
        PostureScore::RulaArm => Rejection::RulaArm,
        PostureScore::Reba => Rejection::Reba,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        human::default_tool,
        model::{
            operation::OperationKind,
            plan::{ExceededScore, RebaScore, RulaScore},
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
    const NO_LIMITS: Limits = Limits::USUAL;

    fn comfort() -> Comfort {
        Comfort {
            rula: Some(RulaScore { score: 4, arm_and_wrist: 3, neck_trunk_legs: 5 }),
            reba: Some(RebaScore { score: 6, neck_trunk_legs: 4, arm_and_wrist: 5 }),
            ..NO_COMFORT
        }
    }

    fn exceeded(comfort: &Comfort, limits: &Limits) -> impl Iterator<Item = ExceededScore> + use<> {
        exceeded_scores(comfort.rula, comfort.reba, limits)
    }

    fn reasons(limits: &Limits) -> Vec<&'static str> {
        rejection(&comfort(), limits).map(Rejection::name).into_iter().collect()
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
            exceeded(&comfort(), &all).map(|score| (score.score.key(), score.found, score.limit)).collect();
        let expected =
            [("comfort.rula.score", 4, 1), ("comfort.rula.arm_and_wrist", 3, 1), ("comfort.reba.score", 6, 1)];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_comfort_without_scores_keeps_every_limit_until_it_has_them() {
        let strictest = Limits { rula: Some(1), rula_arm: Some(1), reba: Some(1), ..NO_LIMITS };
        assert_eq!(exceeded(&NO_COMFORT, &strictest).next(), None);
        // The arm is raised above 90 degrees and abducted.
        let human = Human::new(&Person::default(), &default_tool(OperationKind::Drill)).unwrap();
        let raised_rad = [100.0, 40.0, 0.0, 20.0, 60.0, 30.0, 20.0].map(f64::to_radians);
        let comfort = scored(&human, &raised_rad, &Wrench::default(), NO_COMFORT);
        assert_eq!(exceeded(&comfort, &strictest).count(), 3);
    }
}
