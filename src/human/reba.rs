//! The REBA score of a posture (Rapid Entire Body Assessment, Hignett & McAtamney 2000; docs/method.md#412-posture-score).
//! It is reported beside the metrics and not optimised, since it is a step function.
//!
//! # Scores
//!
//! | REBA | from |
//! |---|---|
//! | neck 1 or 2 | flexion that the gaze asks of the head: up to 20 degrees; more, or an extension |
//! | neck +1 | yaw of the gaze beyond 10 degrees |
//! | trunk 1..4 | upright; leaning forward by up to 20 degrees, up to 60, more |
//! | trunk +1 | yaw of the gaze beyond the 60 degrees that the neck gives |
//! | legs 1 | both legs bear the weight, knees straight |
//! | load 0..2 | tool's weight and tool's force together under 5 kg, up to 10 kg, more |
//! | upper arm 1..4 | angle between upper arm and trunk, backward when the elbow is behind the shoulder: up to 20 degrees; 20..45, or more than 20 backward; 45..90; more |
//! | upper arm +1 | abduction q2 beyond 20 degrees, or twist from hanging beyond 45 degrees |
//! | lower arm 1 or 2 | elbow flexion q4 within 60..100 degrees, or outside |
//! | wrist 1 or 2 | flexion q6 within 15 degrees, or beyond |
//! | wrist +1 | deviation q7 beyond 5 degrees, or pronation q5 beyond 45 degrees |
//! | coupling 0 | good: a tool with a handle |
//! | activity 0 | one operation of a few seconds: nothing is held for a minute or repeated |
//!
//! `human::observed` defines the angles. Without shocks the load has no addition.

use std::sync::LazyLock;

use serde::Deserialize;

use super::{
    Human,
    observed::{Observed, band},
    ranges::ArmAngles,
    rula::observer,
};
use crate::model::{plan::RebaScore, wrench::Wrench};

/// `assets/human/reba.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    table_a: [[[u8; 4]; 5]; 3],
    table_b: [[[u8; 3]; 2]; 6],
    table_c: [[u8; 12]; 12],
    bands: Bands,
}

/// The steps between the bands of a score, degrees.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bands {
    neck_deg: f64,
    trunk_deg: [f64; 3],
    upper_arm_deg: [f64; 3],
    lower_arm_deg: [f64; 2],
    wrist_deg: f64,
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    // The file is compiled in and the tests below parse it.
    toml::from_str(include_str!("../../assets/human/reba.toml")).expect("the built-in REBA tables are valid")
});

/// The scores of the body's parts, from 1: indices of tables A and B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PartScores {
    neck: usize,
    trunk: usize,
    legs: usize,
    upper_arm: usize,
    lower_arm: usize,
    wrist: usize,
}

impl Human {
    /// The REBA score of a posture whose hand exerts `wrench_w` at the tool tip: about the tip, W axes.
    #[must_use]
    pub fn reba(&self, q_rad: &ArmAngles, wrench_w: &Wrench) -> RebaScore {
        score(&part_scores(&self.observed(q_rad, observer())), load_score(self.load_kg(wrench_w)))
    }
}

/// The score of the parts' scores and of the load; coupling and activity add nothing.
fn score(parts: &PartScores, load: u8) -> RebaScore {
    let PartScores { neck, trunk, legs, upper_arm, lower_arm, wrist } = *parts;
    let neck_trunk_legs = TABLES.table_a[neck - 1][trunk - 1][legs - 1] + load;
    let arm_and_wrist = TABLES.table_b[upper_arm - 1][lower_arm - 1][wrist - 1];
    let score = TABLES.table_c[usize::from(neck_trunk_legs) - 1][usize::from(arm_and_wrist) - 1];
    RebaScore { score, neck_trunk_legs, arm_and_wrist }
}

/// The scores of the parts, by the table in the module documentation.
fn part_scores(observed: &Observed) -> PartScores {
    let Bands { neck_deg, trunk_deg, upper_arm_deg, lower_arm_deg: [least_deg, most_deg], wrist_deg } = &TABLES.bands;
    let neck = if observed.neck_deg < 0.0 { 2 } else { band(observed.neck_deg, &[*neck_deg]) };
    let bent_well = (*least_deg..=*most_deg).contains(&observed.elbow_deg);
    PartScores {
        neck: neck + usize::from(observed.is_neck_twisted),
        trunk: band(observed.trunk_deg, trunk_deg) + usize::from(observed.is_trunk_twisted),
        legs: 1,
        upper_arm: observed.upper_arm_band(upper_arm_deg)
            + usize::from(observed.is_arm_abducted || observed.is_arm_turned),
        lower_arm: if bent_well { 1 } else { 2 },
        wrist: band(observed.wrist_deg, &[*wrist_deg])
            + usize::from(observed.is_wrist_deviated || observed.is_forearm_twisted),
    }
}

/// REBA's score of a load without shocks, of its size as a mass.
fn load_score(load_kg: f64) -> u8 {
    match load_kg {
        mass_kg if mass_kg < 5.0 => 0,
        mass_kg if mass_kg <= 10.0 => 1,
        _ => 2,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        human::testing::worker,
        model::{GRAVITY_W, operation::OperationKind, scenario::Hand},
    };

    /// Upper arm hanging, elbow at 80 degrees, wrist straight.
    const BEST_DEG: ArmAngles = [0.0, 0.0, 0.0, 80.0, 0.0, 0.0, 0.0];
    /// The scores of a posture without any fault.
    const BEST: PartScores = PartScores { neck: 1, trunk: 1, legs: 1, upper_arm: 1, lower_arm: 1, wrist: 1 };

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
        assert_eq!(score(&BEST, 0), RebaScore { score: 1, neck_trunk_legs: 1, arm_and_wrist: 1 });
        // Above 10 kg: A is 3. Table C, row 3, column 1: 2.
        assert_eq!(score(&BEST, load_score(10.1)), RebaScore { score: 2, neck_trunk_legs: 3, arm_and_wrist: 1 });
    }

    #[test]
    fn a_raised_arm_and_a_bent_neck_by_hand() {
        // Upper arm 60 degrees forward: 3. Elbow 30: 2. Wrist flexed 10: 1, deviated 10: 2.
        let raised = scores([60.0, 0.0, 0.0, 30.0, 0.0, 10.0, 10.0]);
        let arm = PartScores { upper_arm: 3, lower_arm: 2, wrist: 2, ..BEST };
        assert_eq!(PartScores { neck: 1, ..raised }, arm);
        // Table B, third upper arm, second lower arm, wrist 2: 5. A 1. Table C, row 1, column 5: 3.
        assert_eq!(score(&arm, 0), RebaScore { score: 3, neck_trunk_legs: 1, arm_and_wrist: 5 });
        // Neck bent and twisted, 3, trunk leaning, 2: A 4. Table C, row 4, column 5: 5.
        let bent = PartScores { neck: 3, trunk: 2, ..arm };
        assert_eq!(score(&bent, 0), RebaScore { score: 5, neck_trunk_legs: 4, arm_and_wrist: 5 });
        // With 5 kg A is 5. Table C, row 5, column 5: 6.
        assert_eq!(score(&bent, load_score(5.0)), RebaScore { score: 6, neck_trunk_legs: 5, arm_and_wrist: 5 });
    }

    #[test]
    fn every_step_of_the_arm_counts() {
        let upper_arm = |flexion, abduction, turn| scores([flexion, abduction, turn, 80.0, 0.0, 0.0, 0.0]).upper_arm;
        assert_eq!([19.0, 21.0, 44.0, 46.0, 89.0, 91.0].map(|q1| upper_arm(q1, 0.0, 0.0)), [1, 2, 2, 3, 3, 4]);
        assert_eq!([-19.0, -21.0, -50.0].map(|q1| upper_arm(q1, 0.0, 0.0)), [1, 2, 2]);
        // Abducted or turned: one more, and not two.
        assert_eq!(
            [[19.0, 0.0], [30.0, 0.0], [0.0, 44.0], [0.0, 46.0]].map(|[q2, q3]| upper_arm(0.0, q2, q3)),
            [1, 3, 1, 2]
        );
        assert_eq!(upper_arm(0.0, 30.0, 70.0), 3);
        let lower_arm = |elbow| scores([0.0, 0.0, 0.0, elbow, 0.0, 0.0, 0.0]).lower_arm;
        assert_eq!([59.0, 61.0, 99.0, 101.0].map(lower_arm), [2, 1, 1, 2]);
        let wrist = |[pronation, flexion, deviation]: [f64; 3]| {
            scores([0.0, 0.0, 0.0, 80.0, pronation, flexion, deviation]).wrist
        };
        assert_eq!([[0.0, 14.0, 0.0], [0.0, 16.0, 0.0], [0.0, -16.0, 0.0]].map(wrist), [1, 2, 2]);
        // Deviated or twisted: one more, and not two.
        assert_eq!([[0.0, 0.0, 6.0], [46.0, 0.0, 0.0], [46.0, 16.0, 6.0]].map(wrist), [2, 2, 3]);
    }

    #[test]
    fn every_step_of_neck_and_trunk_counts() {
        let neck = |neck_deg| of_neck_and_trunk(|observed| observed.neck_deg = neck_deg)[0];
        assert_eq!([0.0, 19.9, 20.1, 80.0, -0.1].map(neck), [1, 1, 2, 2, 2]);
        let trunk = |trunk_deg| of_neck_and_trunk(|observed| observed.trunk_deg = trunk_deg)[1];
        assert_eq!([0.0, 0.1, 19.9, 20.1, 59.9, 60.1].map(trunk), [1, 2, 2, 3, 3, 4]);
        assert_eq!(of_neck_and_trunk(|observed| observed.is_neck_twisted = true), [2, 1]);
        let turned_far = |observed: &mut Observed| (observed.is_neck_twisted, observed.is_trunk_twisted) = (true, true);
        assert_eq!(of_neck_and_trunk(turned_far), [2, 2]);
    }

    #[test]
    fn the_steps_of_the_load() {
        assert_eq!([0.0, 4.9, 5.0, 10.0, 10.1].map(load_score), [0, 0, 1, 1, 2]);
        // The drill's 1.3 kg and 60 N: above 5 kg.
        let human = worker(Hand::Right, OperationKind::Drill);
        let of = |force_n| {
            let lifting = Wrench::from_force(-GRAVITY_W.normalize() * force_n);
            human.reba(&BEST_DEG.map(f64::to_radians), &lifting).neck_trunk_legs
        };
        assert_eq!(of(60.0), of(0.0) + 1);
    }

    #[test]
    fn a_left_handed_person_scores_as_the_mirror_image() {
        let [right, left] = [Hand::Right, Hand::Left].map(|hand| worker(hand, OperationKind::Cut));
        for q_deg in [BEST_DEG, [60.0, 30.0, 20.0, 30.0, 60.0, 10.0, 10.0], [110.0, -20.0, 0.0, 10.0, 0.0, 0.0, 0.0]] {
            let score = |human: &Human| human.reba(&q_deg.map(f64::to_radians), &Wrench::default());
            assert_eq!(score(&right), score(&left));
        }
    }

    #[test]
    fn rows_of_the_tables_as_printed() {
        // Hignett & McAtamney 2000, tables A to C: first and last row of each, and one between.
        assert_eq!(TABLES.table_a[0][0], [1, 2, 3, 4]);
        assert_eq!(TABLES.table_a[1][2], [4, 5, 6, 7]);
        assert_eq!(TABLES.table_a[2][4], [7, 8, 9, 9]);
        assert_eq!(TABLES.table_b[0], [[1, 2, 2], [1, 2, 3]]);
        assert_eq!(TABLES.table_b[2], [[3, 4, 5], [4, 5, 5]]);
        assert_eq!(TABLES.table_b[5], [[7, 8, 8], [8, 9, 9]]);
        assert_eq!(TABLES.table_c[0], [1, 1, 1, 2, 3, 3, 4, 5, 6, 7, 7, 7]);
        assert_eq!(TABLES.table_c[5], [6, 6, 6, 7, 8, 8, 9, 9, 10, 10, 10, 10]);
        assert_eq!(TABLES.table_c[11], [12; 12]);
    }

    proptest! {
        /// The tables are monotone: a higher score of one part never lowers any score. The largest scores with the largest
        /// load are inside table C.
        #[test]
        fn a_higher_score_of_one_part_never_lowers_a_score(
            parts in [0..3_usize, 0..5, 0..4, 0..6, 0..2, 0..3],
            raised in 0..6_usize,
            load in [0..3_u8, 0..3],
        ) {
            let largest = [3, 5, 4, 6, 2, 3];
            let mut higher = parts;
            higher[raised] = (higher[raised] + 1).min(largest[raised] - 1);
            let of = |[neck, trunk, legs, upper_arm, lower_arm, wrist]: [usize; 6]| PartScores {
                neck: neck + 1,
                trunk: trunk + 1,
                legs: legs + 1,
                upper_arm: upper_arm + 1,
                lower_arm: lower_arm + 1,
                wrist: wrist + 1,
            };
            let [less, more] = [load[0].min(load[1]), load[0].max(load[1])];
            let (low, high) = (score(&of(parts), less), score(&of(higher), more));
            prop_assert!(low.score <= high.score, "{low:?} {high:?}");
            prop_assert!(low.arm_and_wrist <= high.arm_and_wrist && low.neck_trunk_legs <= high.neck_trunk_legs);
        }
    }
}
