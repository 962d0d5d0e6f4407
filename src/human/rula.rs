//! The RULA score of a posture (Rapid Upper Limb Assessment, McAtamney & Corlett 1993; docs/method.md#412-posture-score).
//! It is reported beside the metrics and not optimised, since it is a step function.
//!
//! # Scores
//!
//! | RULA | from |
//! |---|---|
//! | upper arm 1..4 | angle between upper arm and trunk, backward when the elbow is behind the shoulder: up to 20 degrees; 20..45, or more than 20 backward; 45..90; more |
//! | upper arm +1 | abduction q2 beyond 20 degrees |
//! | lower arm 1..2 | elbow flexion q4 within 60..100 degrees, or outside |
//! | lower arm +1 | wrist across the body's middle, or outside the shoulder by more than an upper arm's radius |
//! | wrist 1..3 | flexion q6: within 5 degrees, up to 15, more |
//! | wrist +1 | ulnar or radial deviation q7 beyond 5 degrees |
//! | wrist twist 1..2 | pronation q5 within 45 degrees, or beyond |
//! | neck 1 | neutral |
//! | trunk 1..2 | upright, or leaning forward by up to 20 degrees |
//! | legs 1 | both legs supported |
//! | force 0, 1, 3 | tool's weight and tool's force together under 2 kg, up to 10 kg, more: intermittent |
//! | muscle use 0 | one operation of a few seconds, neither static nor repeated |
//!
//! Raised shoulders, supported arms, and a turned head or trunk do not occur in this body model.

use std::sync::LazyLock;

use nalgebra::Vector3;
use serde::Deserialize;

use super::{arm::Arm, body::Body, ranges::ArmAngles};
use crate::model::{GRAVITY_W, plan::RulaScore};

/// `assets/human/rula.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    table_a: [[[u8; 8]; 3]; 6],
    table_b: [[u8; 12]; 6],
    table_c: [[u8; 7]; 8],
    observer: Observer,
}

/// Thresholds that RULA leaves to the observer, degrees.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Observer {
    abducted_deg: f64,
    neutral_wrist_deg: f64,
    twist_mid_range_deg: f64,
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    // The file is compiled in and the tests below parse it.
    toml::from_str(include_str!("../../assets/human/rula.toml")).expect("the built-in RULA tables are valid")
});

/// The scores of the arm's parts, from 1: indices of table A.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ArmScores {
    upper_arm: usize,
    lower_arm: usize,
    wrist: usize,
    twist: usize,
}

/// The score of a posture of the right arm whose hand carries `load_n`, the tool's weight and force together.
pub fn rula(arm: &Arm, body: &Body, q_rad: &ArmAngles, load_n: f64) -> RulaScore {
    let ArmScores { upper_arm, lower_arm, wrist, twist } = arm_scores(arm, body, q_rad);
    let force = force_score(load_n);
    let in_a = TABLES.table_a[upper_arm - 1][lower_arm - 1][2 * (wrist - 1) + twist - 1];
    let (neck, trunk, legs) = (1, if body.lean_rad > 0.0 { 2 } else { 1 }, 1);
    let in_b = TABLES.table_b[neck - 1][2 * (trunk - 1) + legs - 1];
    let (arm_and_wrist, neck_trunk_legs) = (in_a + force, in_b + force);
    let row = usize::from(arm_and_wrist).min(TABLES.table_c.len());
    let column = usize::from(neck_trunk_legs).min(TABLES.table_c[0].len());
    RulaScore { score: TABLES.table_c[row - 1][column - 1], arm_and_wrist, neck_trunk_legs }
}

/// The scores of the arm's parts, by the table in the module documentation.
fn arm_scores(arm: &Arm, body: &Body, q_rad: &ArmAngles) -> ArmScores {
    let frames = arm.frames(q_rad);
    let [_, abduction, _, elbow, twist, flexion, deviation] = q_rad.map(f64::to_degrees);
    let observer = &TABLES.observer;
    let upper_arm = frames.p_be_m - frames.p_bs_m;
    let raised_deg = upper_arm.angle(&-Vector3::z()).to_degrees();
    let by_elevation = match raised_deg {
        raised if raised <= 20.0 => 1,
        raised if raised <= 45.0 || upper_arm.x < 0.0 => 2,
        raised if raised <= 90.0 => 3,
        _ => 4,
    };
    // Right arm: y_B points to the left.
    let outermost_m = body.p_bs_m.y - body.thickness.upper_arm_radius_m;
    let aside = frames.p_bw_m.y > 0.0 || frames.p_bw_m.y < outermost_m;
    let by_flexion = match flexion.abs() {
        bent if bent <= observer.neutral_wrist_deg => 1,
        bent if bent <= 15.0 => 2,
        _ => 3,
    };
    ArmScores {
        upper_arm: by_elevation + usize::from(abduction > observer.abducted_deg),
        lower_arm: if (60.0..=100.0).contains(&elbow) { 1 } else { 2 } + usize::from(aside),
        wrist: by_flexion + usize::from(deviation.abs() > observer.neutral_wrist_deg),
        twist: 1 + usize::from(twist.abs() > observer.twist_mid_range_deg),
    }
}

/// RULA's score of an intermittent force. Its thresholds are masses, kg.
fn force_score(load_n: f64) -> u8 {
    match load_n / GRAVITY_W.norm() {
        mass_kg if mass_kg < 2.0 => 0,
        mass_kg if mass_kg <= 10.0 => 1,
        _ => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        human::{
            Human, default_tool,
            testing::{average_man, worker},
        },
        model::{
            operation::OperationKind,
            scenario::{Hand, Person},
            wrench::Wrench,
        },
    };

    fn scores(q_deg: ArmAngles) -> ArmScores {
        let human = worker(Hand::Right, OperationKind::Drill);
        arm_scores(human.arm(), human.body(), &q_deg.map(f64::to_radians))
    }

    fn score(q_deg: ArmAngles, load_n: f64) -> RulaScore {
        let human = worker(Hand::Right, OperationKind::Drill);
        rula(human.arm(), human.body(), &q_deg.map(f64::to_radians), load_n)
    }

    #[test]
    fn the_best_posture_scores_one() {
        // Upper arm hanging, elbow at 80 degrees, wrist straight: A 1, B 1, C 1.
        let best = [0.0, 0.0, 0.0, 80.0, 0.0, 0.0, 0.0];
        assert_eq!(score(best, 10.0), RulaScore { score: 1, arm_and_wrist: 1, neck_trunk_legs: 1 });
        // 5 kg: 1 more in both, row 2 and column 2 of table C.
        assert_eq!(score(best, 49.0), RulaScore { score: 2, arm_and_wrist: 2, neck_trunk_legs: 2 });
        // Above 10 kg: 3 more, row 4 and column 4.
        assert_eq!(score(best, 99.0), RulaScore { score: 4, arm_and_wrist: 4, neck_trunk_legs: 4 });
    }

    #[test]
    fn an_arm_raised_before_the_body_by_hand() {
        // Upper arm 60 degrees forward: 3. Elbow 30: 2. Wrist flexed 10: 2, deviated 10: 3. Twisted 60: 2.
        let raised = [60.0, 0.0, 0.0, 30.0, 60.0, 10.0, 10.0];
        assert_eq!(scores(raised), ArmScores { upper_arm: 3, lower_arm: 2, wrist: 3, twist: 2 });
        // Table A, third upper arm, second lower arm, wrist 3 with twist 2: 4. B 1. Table C, row 4, column 1: 3.
        assert_eq!(score(raised, 0.0), RulaScore { score: 3, arm_and_wrist: 4, neck_trunk_legs: 1 });
    }

    #[test]
    fn every_step_of_the_arm_counts() {
        let hanging = [0.0, 0.0, 0.0, 80.0, 0.0, 0.0, 0.0];
        let upper_arm = |flexion, abduction| scores([flexion, abduction, 0.0, 80.0, 0.0, 0.0, 0.0]).upper_arm;
        assert_eq!([19.0, 21.0, 44.0, 46.0, 89.0, 91.0].map(|q1| upper_arm(q1, 0.0)), [1, 2, 2, 3, 3, 4]);
        assert_eq!([-19.0, -21.0, -50.0].map(|q1| upper_arm(q1, 0.0)), [1, 2, 2]);
        // Out to the side: the elevation, and one more for the abduction.
        assert_eq!([19.0, 30.0, 60.0, 110.0].map(|q2| upper_arm(0.0, q2)), [1, 3, 4, 5]);
        // Turned inward by 90 degrees the forearm crosses the middle; turned outward it is beyond the shoulder.
        assert_eq!(scores(hanging).lower_arm, 1);
        for turn in [85.0, -85.0] {
            assert_eq!(scores([0.0, 0.0, turn, 80.0, 0.0, 0.0, 0.0]).lower_arm, 2, "{turn}");
        }
        let wrist = |flexion, deviation| scores([0.0, 0.0, 0.0, 80.0, 0.0, flexion, deviation]).wrist;
        assert_eq!([0.0, 6.0, -6.0, 16.0].map(|q6| wrist(q6, 0.0)), [1, 2, 2, 3]);
        assert_eq!([6.0, -6.0].map(|q7| wrist(0.0, q7)), [2, 2]);
    }

    #[test]
    fn a_leaning_trunk_and_the_tools_weight_count() {
        // Trunk 2: table B gives 2; the drill's 1.3 kg and no force: under 2 kg. Table C, row 1, column 2: 2.
        let tool = default_tool(OperationKind::Drill);
        let leaning = Human::new(&Person { lean_deg: 10.0, ..average_man() }, &tool).unwrap();
        let best = [0.0, 0.0, 0.0, 80_f64.to_radians(), 0.0, 0.0, 0.0];
        let idle = leaning.rula(&best, &Wrench::default());
        assert_eq!(idle, RulaScore { score: 2, arm_and_wrist: 1, neck_trunk_legs: 2 });
        // 10 N up besides the weight of 12.8 N: above 2 kg.
        let lifting = leaning.rula(&best, &Wrench::from_force(-GRAVITY_W.normalize() * 10.0));
        assert_eq!(lifting.arm_and_wrist, 2);
    }
}
