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
//! | neck 1..3 | flexion that the gaze asks of the head: up to 10 degrees, up to 20, more |
//! | neck 4 | extension: a gaze above the trunk's horizontal |
//! | neck +1 | yaw of the gaze beyond 10 degrees |
//! | trunk 1..4 | upright; leaning forward by up to 20 degrees, up to 60, more |
//! | trunk +1 | yaw of the gaze beyond the 60 degrees that the neck gives |
//! | legs 1 | both legs supported |
//! | force 0, 1, 3 | tool's weight and tool's force together under 2 kg, up to 10 kg, more: intermittent |
//! | muscle use 0 | one operation of a few seconds, neither static nor repeated |
//!
//! `human::observed` defines the angles.

use std::sync::LazyLock;

use serde::Deserialize;

use super::{
    Human,
    observed::{Observed, Observer, band},
    ranges::ArmAngles,
};
use crate::model::{plan::RulaScore, wrench::Wrench};

/// `assets/human/rula.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    table_a: [[[u8; 8]; 3]; 6],
    table_b: [[u8; 12]; 6],
    table_c: [[u8; 7]; 8],
    bands: Bands,
    observer: Observer,
}

/// The steps between the bands of a score, degrees.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bands {
    upper_arm_deg: [f64; 3],
    lower_arm_deg: [f64; 2],
    wrist_deg: f64,
    neck_deg: [f64; 2],
    trunk_deg: [f64; 3],
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    // The file is compiled in and the tests below parse it.
    toml::from_str(include_str!("../../assets/human/rula.toml")).expect("the built-in RULA tables are valid")
});

/// The thresholds that RULA and REBA leave to the observer.
pub(super) fn observer() -> &'static Observer {
    &TABLES.observer
}

/// The scores of the body's parts, from 1: indices of tables A and B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PartScores {
    upper_arm: usize,
    lower_arm: usize,
    wrist: usize,
    twist: usize,
    neck: usize,
    trunk: usize,
    legs: usize,
}

impl Human {
    /// The RULA score of a posture whose hand exerts `wrench_w` at the tool tip: about the tip, W axes.
    #[must_use]
    pub fn rula(&self, q_rad: &ArmAngles, wrench_w: &Wrench) -> RulaScore {
        score(&part_scores(&self.observed(q_rad, observer())), force_score(self.load_kg(wrench_w)))
    }
}

/// The score of the parts' scores and of the force.
fn score(parts: &PartScores, force: u8) -> RulaScore {
    let PartScores { upper_arm, lower_arm, wrist, twist, neck, trunk, legs } = *parts;
    let in_a = TABLES.table_a[upper_arm - 1][lower_arm - 1][2 * (wrist - 1) + twist - 1];
    let in_b = TABLES.table_b[neck - 1][2 * (trunk - 1) + legs - 1];
    let (arm_and_wrist, neck_trunk_legs) = (in_a + force, in_b + force);
    let row = usize::from(arm_and_wrist).min(TABLES.table_c.len());
    let column = usize::from(neck_trunk_legs).min(TABLES.table_c[0].len());
    RulaScore { score: TABLES.table_c[row - 1][column - 1], arm_and_wrist, neck_trunk_legs }
}

/// The scores of the parts, by the table in the module documentation.
fn part_scores(observed: &Observed) -> PartScores {
    let Bands { upper_arm_deg, lower_arm_deg: [least_deg, most_deg], wrist_deg, neck_deg, trunk_deg } = &TABLES.bands;
    let bent_well = (*least_deg..=*most_deg).contains(&observed.elbow_deg);
    let neck = if observed.neck_deg < 0.0 { 4 } else { band(observed.neck_deg, neck_deg) };
    PartScores {
        upper_arm: observed.upper_arm_band(upper_arm_deg) + usize::from(observed.is_arm_abducted),
        lower_arm: if bent_well { 1 } else { 2 } + usize::from(observed.is_forearm_aside),
        wrist: band(observed.wrist_deg, &[observer().neutral_wrist_deg, *wrist_deg])
            + usize::from(observed.is_wrist_deviated),
        twist: 1 + usize::from(observed.is_forearm_twisted),
        neck: neck + usize::from(observed.is_neck_twisted),
        trunk: band(observed.trunk_deg, trunk_deg) + usize::from(observed.is_trunk_twisted),
        legs: 1,
    }
}

/// RULA's score of an intermittent force, of its size as a mass.
fn force_score(load_kg: f64) -> u8 {
    match load_kg {
        mass_kg if mass_kg < 2.0 => 0,
        mass_kg if mass_kg <= 10.0 => 1,
        _ => 3,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        human::{
            default_tool,
            testing::{average_man, worker},
        },
        model::{
            GRAVITY_W,
            operation::OperationKind,
            scenario::{Hand, Person},
        },
    };

    /// Upper arm hanging, elbow at 80 degrees, wrist straight.
    const BEST_DEG: ArmAngles = [0.0, 0.0, 0.0, 80.0, 0.0, 0.0, 0.0];
    /// The scores of a posture without any fault.
    const BEST: PartScores = PartScores { upper_arm: 1, lower_arm: 1, wrist: 1, twist: 1, neck: 1, trunk: 1, legs: 1 };

    fn observed(q_deg: ArmAngles) -> Observed {
        worker(Hand::Right, OperationKind::Drill).observed(&q_deg.map(f64::to_radians), observer())
    }

    fn scores(q_deg: ArmAngles) -> PartScores {
        part_scores(&observed(q_deg))
    }

    /// The scores with neck and trunk as given, the arm in the best posture.
    fn of_neck_and_trunk(change: impl Fn(&mut Observed)) -> [usize; 2] {
        let mut observed = Observed { neck_deg: 0.0, is_neck_twisted: false, ..observed(BEST_DEG) };
        change(&mut observed);
        let PartScores { neck, trunk, .. } = part_scores(&observed);
        [neck, trunk]
    }

    #[test]
    fn the_best_posture_scores_one() {
        // A 1, B 1, C 1.
        assert_eq!(score(&BEST, 0), RulaScore { score: 1, arm_and_wrist: 1, neck_trunk_legs: 1 });
        // 5 kg: 1 more in both, row 2 and column 2 of table C.
        assert_eq!(score(&BEST, force_score(5.0)), RulaScore { score: 2, arm_and_wrist: 2, neck_trunk_legs: 2 });
        // Above 10 kg: 3 more, row 4 and column 4.
        assert_eq!(score(&BEST, force_score(10.1)), RulaScore { score: 4, arm_and_wrist: 4, neck_trunk_legs: 4 });
    }

    #[test]
    fn an_arm_raised_before_the_body_by_hand() {
        // Upper arm 60 degrees forward: 3. Elbow 30: 2. Wrist flexed 10: 2, deviated 10: 3. Twisted 60: 2.
        let raised = scores([60.0, 0.0, 0.0, 30.0, 60.0, 10.0, 10.0]);
        let arm = PartScores { upper_arm: 3, lower_arm: 2, wrist: 3, twist: 2, ..BEST };
        assert_eq!(PartScores { neck: 1, ..raised }, arm);
        // Table A, third upper arm, second lower arm, wrist 3 with twist 2: 4. B 1. Table C, row 4, column 1: 3.
        assert_eq!(score(&arm, 0), RulaScore { score: 3, arm_and_wrist: 4, neck_trunk_legs: 1 });
        // Looking up and to the side, neck 5: B 7. Table C, row 4, column 7: 6.
        let looking_up = PartScores { neck: 5, ..arm };
        assert_eq!(score(&looking_up, 0), RulaScore { score: 6, arm_and_wrist: 4, neck_trunk_legs: 7 });
    }

    #[test]
    fn every_step_of_the_arm_counts() {
        let upper_arm = |flexion, abduction| scores([flexion, abduction, 0.0, 80.0, 0.0, 0.0, 0.0]).upper_arm;
        assert_eq!([19.0, 21.0, 44.0, 46.0, 89.0, 91.0].map(|q1| upper_arm(q1, 0.0)), [1, 2, 2, 3, 3, 4]);
        assert_eq!([-19.0, -21.0, -50.0].map(|q1| upper_arm(q1, 0.0)), [1, 2, 2]);
        // Out to the side: the elevation, and one more for the abduction.
        assert_eq!([19.0, 30.0, 60.0, 110.0].map(|q2| upper_arm(0.0, q2)), [1, 3, 4, 5]);
        // Turned inward by 90 degrees the forearm crosses the middle; turned outward it is beyond the shoulder.
        assert_eq!(scores(BEST_DEG).lower_arm, 1);
        for turn in [85.0, -85.0] {
            assert_eq!(scores([0.0, 0.0, turn, 80.0, 0.0, 0.0, 0.0]).lower_arm, 2, "{turn}");
        }
        let lower_arm = |elbow| scores([0.0, 0.0, 0.0, elbow, 0.0, 0.0, 0.0]).lower_arm;
        assert_eq!([59.0, 61.0, 99.0, 101.0].map(lower_arm), [2, 1, 1, 2]);
        let wrist = |flexion, deviation| scores([0.0, 0.0, 0.0, 80.0, 0.0, flexion, deviation]).wrist;
        assert_eq!([0.0, 6.0, -6.0, 16.0].map(|q6| wrist(q6, 0.0)), [1, 2, 2, 3]);
        assert_eq!([6.0, -6.0].map(|q7| wrist(0.0, q7)), [2, 2]);
        let twist = |pronation| scores([0.0, 0.0, 0.0, 80.0, pronation, 0.0, 0.0]).twist;
        assert_eq!([0.0, 44.0, 46.0, -46.0].map(twist), [1, 1, 2, 2]);
    }

    #[test]
    fn every_step_of_neck_and_trunk_counts() {
        let neck = |neck_deg| of_neck_and_trunk(|observed| observed.neck_deg = neck_deg)[0];
        assert_eq!([0.0, 9.9, 10.1, 19.9, 20.1, 80.0, -0.1, -30.0].map(neck), [1, 1, 2, 2, 3, 3, 4, 4]);
        let trunk = |trunk_deg| of_neck_and_trunk(|observed| observed.trunk_deg = trunk_deg)[1];
        assert_eq!([0.0, 0.1, 19.9, 20.1, 59.9, 60.1].map(trunk), [1, 2, 2, 3, 3, 4]);
        assert_eq!(of_neck_and_trunk(|observed| observed.is_neck_twisted = true), [2, 1]);
        let turned_far = |observed: &mut Observed| (observed.is_neck_twisted, observed.is_trunk_twisted) = (true, true);
        assert_eq!(of_neck_and_trunk(turned_far), [2, 2]);
    }

    #[test]
    fn the_steps_of_the_force() {
        assert_eq!([0.0, 1.9, 2.0, 10.0, 10.1].map(force_score), [0, 0, 1, 1, 3]);
    }

    #[test]
    fn a_gaze_to_the_tool_a_leaning_trunk_and_the_tools_weight_count() {
        // The hand at the height of the elbow: the person looks steeply down, flexion above 20 degrees, neck 3.
        let tool = default_tool(OperationKind::Drill);
        let leaning = Human::new(&Person { lean_deg: 10.0, ..average_man() }, &tool).unwrap();
        let best_rad = BEST_DEG.map(f64::to_radians);
        let parts = part_scores(&leaning.observed(&best_rad, observer()));
        assert!((3..=4).contains(&parts.neck) && parts.trunk >= 2, "{parts:?}");
        // The drill's 1.3 kg and no force: under 2 kg, so A is 1.
        let idle = leaning.rula(&best_rad, &Wrench::default());
        assert_eq!(idle, score(&parts, 0));
        assert_eq!(idle.arm_and_wrist, 1);
        // 10 N up besides the weight of 12.8 N: above 2 kg.
        let lifting = leaning.rula(&best_rad, &Wrench::from_force(-GRAVITY_W.normalize() * 10.0));
        assert_eq!([lifting.arm_and_wrist, lifting.neck_trunk_legs], [2, idle.neck_trunk_legs + 1]);
    }

    #[test]
    fn a_left_handed_person_scores_as_the_mirror_image() {
        let [right, left] = [Hand::Right, Hand::Left].map(|hand| worker(hand, OperationKind::Cut));
        for q_deg in [BEST_DEG, [60.0, 30.0, 20.0, 30.0, 60.0, 10.0, 10.0], [110.0, -20.0, 0.0, 10.0, 0.0, 0.0, 0.0]] {
            let q_rad = q_deg.map(f64::to_radians);
            let score = |human: &Human| human.rula(&q_rad, &Wrench::default());
            assert_eq!(score(&right), score(&left));
        }
    }

    #[test]
    fn rows_of_the_tables_as_printed() {
        // McAtamney & Corlett 1993, tables 1 to 3: first and last row of each, and one between.
        assert_eq!(TABLES.table_a[0][0], [1, 2, 2, 2, 2, 3, 3, 3]);
        assert_eq!(TABLES.table_a[2][1], [3, 4, 4, 4, 4, 4, 5, 5]);
        assert_eq!(TABLES.table_a[5][2], [9; 8]);
        assert_eq!(TABLES.table_b[0], [1, 3, 2, 3, 3, 4, 5, 5, 6, 6, 7, 7]);
        assert_eq!(TABLES.table_b[3], [5, 5, 5, 6, 6, 7, 7, 7, 7, 7, 8, 8]);
        assert_eq!(TABLES.table_b[5], [8, 8, 8, 8, 8, 8, 8, 9, 9, 9, 9, 9]);
        assert_eq!(TABLES.table_c[0], [1, 2, 3, 3, 4, 5, 5]);
        assert_eq!(TABLES.table_c[3], [3, 3, 3, 4, 5, 6, 6]);
        assert_eq!(TABLES.table_c[7], [5, 5, 6, 7, 7, 7, 7]);
    }

    proptest! {
        /// The tables are monotone: a higher score of one part never lowers any score.
        #[test]
        fn a_higher_score_of_one_part_never_lowers_a_score(
            parts in [0..6_usize, 0..3, 0..4, 0..2, 0..6, 0..6, 0..2],
            raised in 0..7_usize,
            force in [0..4_u8, 0..4],
        ) {
            let largest = [6, 3, 4, 2, 6, 6, 2];
            let mut higher = parts;
            higher[raised] = (higher[raised] + 1).min(largest[raised] - 1);
            let of = |[upper_arm, lower_arm, wrist, twist, neck, trunk, legs]: [usize; 7]| PartScores {
                upper_arm: upper_arm + 1,
                lower_arm: lower_arm + 1,
                wrist: wrist + 1,
                twist: twist + 1,
                neck: neck + 1,
                trunk: trunk + 1,
                legs: legs + 1,
            };
            let [less, more] = [force[0].min(force[1]), force[0].max(force[1])];
            let (low, high) = (score(&of(parts), less), score(&of(higher), more));
            prop_assert!(low.score <= high.score, "{low:?} {high:?}");
            prop_assert!(low.arm_and_wrist <= high.arm_and_wrist && low.neck_trunk_legs <= high.neck_trunk_legs);
        }
    }
}
