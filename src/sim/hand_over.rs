//! The first steps of a simulation: the grippers close while the board is supported from outside, then its weight is
//! handed over to the arms (docs/method.md#74-phases).

use super::phases::grip_steps;
use crate::model::scenario::SimulationSettings;

/// Time in which the board's weight is handed over, s, at most half of the time before the load. Arms that take the
/// weight at once overshoot by a fifth, and hands that slide in the swing keep an offset: under a tenth of the load some
/// then turn less than hands that were loaded slowly. With 0.1 to 0.25 s the difference vanishes.
const HAND_OVER_S: f64 = 0.15;

/// What the grippers and the arms do in the current step.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandOver {
    step: usize,
    grip_steps: usize,
    hand_over_steps: usize,
}

impl HandOver {
    /// Before the first step.
    pub fn new(settings: &SimulationSettings) -> Self {
        let hand_over_s = HAND_OVER_S.min(settings.settle_s / 2.0);
        Self {
            step: 0,
            grip_steps: grip_steps(settings),
            hand_over_steps: (hand_over_s / settings.timestep_s).round() as usize,
        }
    }

    /// The number of steps in which the grippers close, and in which the weight is handed over.
    pub fn steps(&self) -> [usize; 2] {
        [self.grip_steps, self.hand_over_steps]
    }

    /// Goes on to the next step.
    pub fn advance(&mut self) {
        self.step += 1;
    }

    /// The share of its force with which every gripper closes in this step: above 0, 1 from the end of closing on.
    pub fn grip_share(&self) -> f64 {
        share(self.step, self.grip_steps)
    }

    /// The share of the board's weight that the arms carry in this step: 0 while the grippers close, 1 after the
    /// hand-over.
    pub fn carried_share(&self) -> f64 {
        match self.step.checked_sub(self.grip_steps) {
            Some(step) if step > 0 => share(step, self.hand_over_steps),
            _ if self.grip_steps == 0 && self.hand_over_steps == 0 => 1.0,
            _ => 0.0,
        }
    }
}

/// The share of `steps` that are over after the `step`th; 1 without any.
fn share(step: usize, steps: usize) -> f64 {
    if step >= steps { 1.0 } else { step as f64 / steps as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grippers_close_before_the_weight_is_handed_over() {
        let mut hand_over = HandOver::new(&SimulationSettings::default());
        let mut shares = Vec::new();
        for _ in 0..250 {
            hand_over.advance();
            shares.push((hand_over.grip_share(), hand_over.carried_share()));
        }
        // 0.05 s in steps of 2 ms, then 0.15 s.
        assert_eq!(shares[0], (1.0 / 25.0, 0.0));
        assert_eq!(shares[24], (1.0, 0.0));
        assert_eq!(shares[25], (1.0, 1.0 / 75.0));
        assert_eq!(shares[99], (1.0, 1.0));
        assert!(shares.windows(2).all(|pair| pair[0].0 <= pair[1].0 && pair[0].1 <= pair[1].1));
    }

    #[test]
    fn without_time_before_the_load_the_arms_hold_the_board_at_once() {
        let mut hand_over = HandOver::new(&SimulationSettings { settle_s: 0.0, ..SimulationSettings::default() });
        hand_over.advance();
        assert_eq!((hand_over.grip_share(), hand_over.carried_share()), (1.0, 1.0));
    }
}
