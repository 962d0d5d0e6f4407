//! Objective and constraints of a hold, linearised along its free moves.

use nalgebra::DVector;

use super::{
    super::{
        Problem,
        assess::{self, BOARD_X_M, BOARD_Y_M, BOARD_Z_M, Configured, Feasible},
        candidate::Candidate,
        propose::{ANGLE_RAD, DEPTH_M},
    },
    moves::Moves,
    program::Row,
    rates::Rates,
};
use crate::{
    collision::{Carrier, Near},
    model::{plan::Comfort, scenario::StabilityKind},
    statics::LocalEquilibrium,
};

/// Bodies farther apart than this, beyond what they must keep, are no constraint of a step, m.
const WATCHED_M: f64 = 0.06;
/// How much farther from each other than they must be bodies are kept, m: an exact test follows.
const CLEARANCE_M: f64 = 1e-5;
/// The same for every other constraint, in its own unit.
const BACK_OFF: f64 = 1e-7;
/// Below this share of what stability allows no step looks at it.
const RELAXED: f64 = 0.8;
/// The share that a step may use of what stability allows.
const FULL: f64 = 0.999;
/// Share of a move with which the utilisation is differentiated: well above the solvers' tolerance.
const SMALL_STABLE: f64 = 2e-3;

/// A hold's linearisation.
#[derive(Clone, Debug)]
pub struct Linear {
    /// The free moves.
    pub moves: Moves,
    /// Gradient of the objective.
    pub gradient: DVector<f64>,
    /// The constraints: plain ones, bodies near each other, and stability last where it is watched.
    pub rows: Vec<Row>,
    near: Vec<[(Carrier, usize); 2]>,
    stability: Option<DVector<f64>>,
    /// True when that gradient was carried over from other holds.
    inherited: bool,
}

impl Linear {
    /// Linearises about a hold. Stability is left out until a step or [`Linear::inherit_stability`] asks for it.
    pub fn at(problem: &mut Problem<'_>, here: &Feasible) -> Self {
        let moves = Moves::at(problem, &here.candidate, &here.configured.placed);
        let margins = plain_margins(problem, &here.candidate, &here.configured, &here.comfort.activations);
        let near = problem.map.collision.near(&here.configured.scene(problem), WATCHED_M);
        let rates = Rates::new(problem, here, &moves);
        let plain = rates.plain_gradients().into_iter().zip(margins);
        let mut rows: Vec<_> = plain.map(|(gradient, margin)| Row { gradient, margin: margin - BACK_OFF }).collect();
        let apart = |near: &Near| Row { gradient: rates.near_gradient(near), margin: near.margin_m - CLEARANCE_M };
        rows.extend(near.iter().map(apart));
        let gradient = rates.objective_gradient();
        drop(rates);
        let near = near.iter().map(|near| near.carriers).collect();
        Self { moves, gradient, rows, near, stability: None, inherited: false }
    }

    /// Compares the constraints after a move with what the rows promised. True when one is broken; then `rows` (those
    /// that the move was made with) are moved by what the linearisation had missed.
    pub fn correct(
        &self,
        problem: &Problem<'_>,
        candidate: &Candidate,
        configured: &Configured,
        comfort: &Comfort,
        d: &DVector<f64>,
        rows: &mut [Row],
    ) -> bool {
        let there = plain_margins(problem, candidate, configured, &comfort.activations);
        let near = problem.map.collision.near(&configured.scene(problem), WATCHED_M);
        let mut broken = near.iter().any(|near| near.margin_m <= 0.0 && !self.near.contains(&near.carriers));
        let near_margin = |carriers: &[(Carrier, usize); 2]| {
            near.iter().find(|near| near.carriers == *carriers).map(|near| near.margin_m - CLEARANCE_M)
        };
        let there = there.iter().map(|&margin| Some(margin - BACK_OFF)).chain(self.near.iter().map(near_margin));
        for ((row, linear), there) in rows.iter_mut().zip(&self.rows).zip(there) {
            let Some(there) = there else { continue };
            let missed = there - (linear.margin + linear.gradient.dot(d));
            if missed < 0.0 {
                row.margin = row.margin.min(linear.margin + missed);
            }
            broken |= there < -BACK_OFF.max(CLEARANCE_M);
        }
        broken
    }

    /// Takes stability into the rows after a move that broke it; false when nothing can be learned from it.
    pub fn correct_stability(
        &mut self,
        problem: &mut Problem<'_>,
        here: &Feasible,
        utilisation: f64,
        d: &DVector<f64>,
        rows: &mut Vec<Row>,
    ) -> bool {
        if !utilisation.is_finite() {
            return false;
        }
        let known = self.stability.is_some();
        let gradient = self.stability_gradient(problem, here);
        let margin = FULL - here.utilisation;
        let missed = if known { (here.utilisation + gradient.dot(d)) - utilisation } else { 0.0 };
        if !known {
            self.rows.push(Row { gradient: -&gradient, margin });
            rows.push(Row { gradient: -gradient, margin });
        } else if let Some(row) = rows.last_mut() {
            row.margin = row.margin.min(margin + missed.min(0.0));
        }
        true
    }

    /// Takes stability into the rows where it is near its limit or beyond.
    pub fn watch_stability(&mut self, problem: &mut Problem<'_>, here: &Feasible) {
        if here.utilisation >= RELAXED && here.utilisation.is_finite() {
            let gradient = -self.stability_gradient(problem, here);
            self.rows.push(Row { gradient, margin: FULL - here.utilisation });
        }
    }

    fn stability_gradient(&mut self, problem: &mut Problem<'_>, here: &Feasible) -> DVector<f64> {
        if let Some(known) = &self.stability {
            return known.clone();
        }
        let count = self.moves.count();
        let limits = assess::stability_limits(problem.scenario);
        // Around a compliant response all moves together cost less than one response; else each has its own.
        let nearby = (problem.scenario.planner.stability == StabilityKind::Compliant)
            .then(|| assess::statics_hold(problem, &here.candidate, &here.configured.placed.x_wo).ok())
            .flatten()
            .and_then(|hold| LocalEquilibrium::new(&hold, limits.load_factor));
        let mut gradient = DVector::zeros(count);
        for number in 0..count {
            let mut d = DVector::zeros(count);
            d[number] = SMALL_STABLE;
            let candidate = self.moves.moved(&here.candidate, &d);
            let x_wo = candidate.x_wo(problem);
            let there = nearby
                .as_ref()
                .and_then(|nearby| nearby.utilisation(&assess::statics_hold(problem, &candidate, &x_wo).ok()?, &limits))
                .unwrap_or_else(|| assess::utilisation(problem, &candidate, &x_wo));
            // Where there is no equilibrium, one side tells nothing: stay.
            gradient[number] = if there.is_finite() { (there - here.utilisation) / SMALL_STABLE } else { 1.0 };
        }
        self.stability = Some(gradient.clone());
        gradient
    }

    /// Carries what is known of stability over a move, corrected by what the move showed (Broyden's rank-one update).
    pub fn inherit_stability(&mut self, before: &Self, from: &Feasible, to: &Feasible, d: &DVector<f64>) {
        let Some(known) = &before.stability else { return };
        if to.utilisation < RELAXED {
            return;
        }
        let missed = to.utilisation - from.utilisation - known.dot(d);
        let gradient = known + d * (missed / d.norm_squared());
        self.rows.push(Row { gradient: -&gradient, margin: FULL - to.utilisation });
        self.stability = Some(gradient);
        self.inherited = true;
    }

    /// Works the gradient of stability out anew; false when it is not watched or has been already.
    pub fn refresh_stability(&mut self, problem: &mut Problem<'_>, here: &Feasible) -> bool {
        if !self.inherited {
            return false;
        }
        self.stability = None;
        self.inherited = false;
        let gradient = -self.stability_gradient(problem, here);
        if let Some(row) = self.rows.last_mut() {
            *row = Row { gradient, margin: FULL - here.utilisation };
        }
        true
    }
}

/// The margins of all constraints that cost next to nothing, at least 0 when kept; their gradients, in the same order, are
/// those of [`Rates::plain_gradients`].
pub(super) fn plain_margins(
    problem: &Problem<'_>,
    candidate: &Candidate,
    configured: &Configured,
    activations: &[f64; 7],
) -> Vec<f64> {
    let mut margins = Vec::with_capacity(96);
    let mut between = |value: f64, [low, high]: [f64; 2]| margins.extend([value - low, high - value]);
    for (q, limits) in candidate.q_h_rad.iter().zip(problem.human.arm().limits_rad) {
        between(*q, limits);
    }
    let p_wo = configured.placed.x_wo.translation.vector;
    between(p_wo.x, BOARD_X_M);
    between(p_wo.y, BOARD_Y_M);
    between(p_wo.z, BOARD_Z_M);
    for (arm, hold) in problem.map.arms.iter().zip(&candidate.holds) {
        for (q, (&low, &high)) in hold.q_rad.iter().zip(arm.chain.lower().iter().zip(arm.chain.upper())) {
            between(*q, [low, high]);
        }
        between(hold.grasp.depth_m, DEPTH_M);
        between(hold.grasp.angle_rad, ANGLE_RAD);
    }
    margins.push(assess::facing(&configured.placed.x_wo));
    margins.extend(activations.iter().map(|activation| 1.0 - activation));
    for (arm, hold) in problem.map.arms.iter().zip(&candidate.holds) {
        let gripper = &problem.map.robot.arms[arm.index].gripper;
        margins.extend(assess::pad_margins_m(gripper, &hold.grasp, problem.scenario.object.size_m));
    }
    margins
}
