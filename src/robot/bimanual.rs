//! Combinations of the solutions of several arms that hold one object, in order of cost.
//!
//! Each arm has a list of solutions; a combination has one of each. Combinations are generated lazily in order of their cost,
//! so the first one that passes a test is the best.

use std::{cmp::Ordering, collections::BinaryHeap};

use super::inverse::InverseKinematics;
use crate::model::frames::Pose;

/// One arm's solutions in order of cost.
#[derive(Clone, Debug)]
pub struct RankedSolutions {
    /// Cost and angles (rad), lowest cost first.
    solutions: Vec<(f64, Vec<f64>)>,
}

impl RankedSolutions {
    /// Solutions sorted by `cost`. Solutions with a cost that is not finite are left out. The sort is stable.
    pub fn new(solutions: impl IntoIterator<Item = Vec<f64>>, cost: impl Fn(&[f64]) -> f64) -> Self {
        let ranked = solutions.into_iter().map(|q_rad| (cost(&q_rad), q_rad));
        let mut solutions: Vec<_> = ranked.filter(|(cost, _)| cost.is_finite()).collect();
        solutions.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { solutions }
    }

    /// All solutions that are known ([`InverseKinematics::all`]) of an arm with its gripper at `x_wg`, W. Empty without a solution.
    pub fn of_arm(arm: &InverseKinematics, x_wg: &Pose, starts: usize, cost: impl Fn(&[f64]) -> f64) -> Self {
        Self::new(arm.all(x_wg, starts), cost)
    }

    /// The number of solutions.
    pub fn len(&self) -> usize {
        self.solutions.len()
    }

    /// True if the arm has no solution.
    pub fn is_empty(&self) -> bool {
        self.solutions.is_empty()
    }
}

/// One solution of every arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Combination<'a> {
    /// The sum of the costs.
    pub cost: f64,
    /// The angles of each arm, in the order of the arms, rad.
    pub q_rad: Vec<&'a [f64]>,
}

/// Iterator over all combinations of the solutions of any number of arms, lowest sum of costs first; equal sums in the order
/// of the first arm's solutions, then the second's. Empty if an arm has no solution or there is no arm.
///
/// A heap holds the candidates for the next combination. The successors of a combination advance one arm to its next
/// solution, for the arms from the last one that is not at its first solution on. So each combination has exactly one
/// predecessor, whose cost is not greater. The k-th combination costs `O(log k)`.
#[derive(Clone, Debug)]
pub struct Combinations<'a> {
    arms: &'a [RankedSolutions],
    next: BinaryHeap<Candidate>,
}

impl<'a> Combinations<'a> {
    /// The combinations of these arms. Filter the iterator for tests of pairs, such as collisions between the arms.
    pub fn new(arms: &'a [RankedSolutions]) -> Self {
        let mut combinations = Self { arms, next: BinaryHeap::new() };
        if !arms.is_empty() && arms.iter().all(|arm| !arm.is_empty()) {
            combinations.push(vec![0; arms.len()]);
        }
        combinations
    }

    fn push(&mut self, ranks: Vec<usize>) {
        let cost = ranks.iter().zip(self.arms).map(|(&rank, arm)| arm.solutions[rank].0).sum();
        self.next.push(Candidate { cost, ranks });
    }
}

impl<'a> Iterator for Combinations<'a> {
    type Item = Combination<'a>;

    fn next(&mut self) -> Option<Self::Item> {
        let Candidate { cost, ranks } = self.next.pop()?;
        let first_movable = ranks.iter().rposition(|&rank| rank > 0).unwrap_or(0);
        for arm in first_movable..ranks.len() {
            if ranks[arm] + 1 < self.arms[arm].len() {
                let mut successor = ranks.clone();
                successor[arm] += 1;
                self.push(successor);
            }
        }
        let q_rad = ranks.iter().zip(self.arms).map(|(&rank, arm)| arm.solutions[rank].1.as_slice()).collect();
        Some(Combination { cost, q_rad })
    }
}

/// The indices of a combination in the arms' lists.
#[derive(Clone, Debug)]
struct Candidate {
    cost: f64,
    ranks: Vec<usize>,
}

impl Ord for Candidate {
    /// Reversed, since the heap returns the greatest element first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then_with(|| other.ranks.cmp(&self.ranks))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}
