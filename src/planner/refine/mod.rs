//! The second half of the search: from a hold that keeps every constraint to the best one near it.
//!
//! Sequential quadratic steps. Around the current hold everything is linearised along the moves that are left free: the
//! person's joints, heading and place, the tool's roll, each grasp along its edge, in depth and angle, and each arm's
//! redundancy; the arms' joints follow the board. A quadratic program then asks for the best move within a trust region
//! that keeps all linearised constraints; its objective's curvature is learned from step to step. The move is made exactly,
//! by inverse kinematics, and accepted when it is better and keeps every constraint; one that curvature has led across a
//! constraint is bent back once or twice before the region shrinks. Stability costs a hundred times as much as all other
//! constraints together: it is linearised when a step has broken it, and its gradient then carried along by Broyden's
//! update and worked out anew when the climb stalls.

mod linear;
mod moves;
mod program;
mod rates;

use nalgebra::{DMatrix, DVector};

use super::{
    Problem,
    assess::{self, Feasible, Rejected, Tally},
    candidate::Candidate,
    effort::Heat,
};
use linear::Linear;
use program::{Row, best_move};

/// Half the trust region's side at the start; 1 is the scale of a move in [`moves`].
const START_RADIUS: f64 = 1.0;
/// The range of the trust region.
const RADIUS_RANGE: [f64; 2] = [2e-3, 2.0];
/// Share of the predicted gain above which a step is good, and below which it is poor.
const GOOD: f64 = 0.7;
const POOR: f64 = 0.25;
/// A predicted gain below this share of what the hold is worth ends the climb.
const LEAST_GAIN: f64 = 1e-4;
/// Moves after which a candidate that breaks a constraint is given up.
const RESTORING_MOVES: usize = 4;
/// How often a move that breaks a constraint is bent back.
const CORRECTIONS: usize = 2;

/// What steps lead to from the starts, the best first.
pub fn refine(problem: &mut Problem<'_>, starts: Vec<Feasible>, heats: &[Heat], tally: &mut Tally) -> Vec<Feasible> {
    let mut climbs: Vec<_> = starts.into_iter().map(|start| Climb::new(problem, start)).collect();
    for heat in heats {
        for climb in climbs.iter_mut().take(heat.climbs) {
            climb.run(problem, heat.steps, tally);
        }
        sort_best_first(&mut climbs);
    }
    climbs.into_iter().map(|climb| climb.here).collect()
}

/// The candidate itself when it keeps every constraint, or else one near it that does: the least moves that keep the
/// linearised constraints are made until they keep the exact ones. None when a few of them do not lead there.
pub fn restored(problem: &mut Problem<'_>, mut candidate: Candidate, tally: &mut Tally) -> Option<Feasible> {
    for _ in 0..=RESTORING_MOVES {
        if tally.is_exhausted() {
            return None;
        }
        tally.draw();
        let rejected = match assess::tested(problem, candidate) {
            Ok(found) => return Some(found),
            Err(rejected) => *rejected,
        };
        tally.remove(rejected.why);
        candidate = towards_feasible(problem, rejected)?;
    }
    None
}

/// Stability is looked at only when it is what is broken: it costs more than all else, and what touches something has to move
/// anyway.
fn towards_feasible(problem: &mut Problem<'_>, rejected: Rejected) -> Option<Candidate> {
    let Rejected { candidate, configured, utilisation, .. } = rejected;
    let comfort = assess::comfort(problem, &candidate, &configured);
    let here = Feasible { worth: comfort.objective, candidate, configured, comfort, utilisation };
    let mut linear = Linear::at(problem, &here);
    linear.watch_stability(problem, &here);
    let count = linear.gradient.len();
    let d = best_move(&DVector::zeros(count), &DMatrix::identity(count, count), &linear.rows, RADIUS_RANGE[1])?;
    linear.moves.make(problem, &here.candidate, &d)
}

fn sort_best_first(found: &mut [Climb]) {
    found.sort_by(|a, b| b.here.worth.total_cmp(&a.here.worth));
}

/// A climb and what it has learned.
#[derive(Clone)]
struct Climb {
    here: Feasible,
    linear: Linear,
    /// Curvature of the negative objective in the coordinates of the moves, positive definite.
    curvature: DMatrix<f64>,
    radius: f64,
}

/// What came of a move.
enum Trial {
    /// A hold that keeps every constraint.
    Feasible(Box<Feasible>),
    /// Constraints broken: the rows with margins moved by what the linearisation had missed.
    Broken(Vec<Row>),
    /// The arms cannot follow.
    Lost,
}

impl Climb {
    fn new(problem: &mut Problem<'_>, here: Feasible) -> Self {
        let linear = Linear::at(problem, &here);
        let count = linear.gradient.len();
        // A start that makes the first step about as long as the trust region.
        let curvature = DMatrix::identity(count, count) * (0.2 * linear.gradient.amax());
        Self { here, linear, curvature, radius: START_RADIUS }
    }

    fn run(&mut self, problem: &mut Problem<'_>, steps: usize, tally: &mut Tally) {
        for _ in 0..steps {
            if self.radius < RADIUS_RANGE[0] || tally.is_exhausted() {
                break;
            }
            if !self.step(problem, tally) {
                break;
            }
        }
    }

    /// One step; false when no step promises anything.
    fn step(&mut self, problem: &mut Problem<'_>, tally: &mut Tally) -> bool {
        let mut rows = self.linear.rows.clone();
        for _ in 0..=CORRECTIONS {
            if tally.is_exhausted() {
                return false;
            }
            let Some(d) = best_move(&self.linear.gradient, &self.curvature, &rows, self.radius) else { break };
            let gain = self.linear.gradient.dot(&d) - 0.5 * d.dot(&(&self.curvature * &d));
            if gain < LEAST_GAIN * self.here.worth.abs() {
                return self.linear.refresh_stability(problem, &self.here);
            }
            tally.draw();
            match self.trial(problem, &d, &rows) {
                Trial::Feasible(there) => {
                    let ratio = (there.worth - self.here.worth) / gain;
                    if ratio > 0.0 {
                        self.accept(problem, *there, &d);
                    }
                    if ratio > GOOD && d.amax() > 0.9 * self.radius {
                        self.radius = (2.0 * self.radius).min(RADIUS_RANGE[1]);
                    } else if ratio < POOR {
                        self.radius *= 0.4;
                    }
                    return true;
                }
                Trial::Broken(corrected) => rows = corrected,
                Trial::Lost => break,
            }
        }
        // A gradient that has been carried along may be to blame.
        if !self.linear.refresh_stability(problem, &self.here) {
            self.radius *= 0.4;
        }
        true
    }

    fn trial(&mut self, problem: &mut Problem<'_>, d: &DVector<f64>, rows: &[Row]) -> Trial {
        let Some(candidate) = self.linear.moves.make(problem, &self.here.candidate, d) else { return Trial::Lost };
        let configured = assess::Configured::new(problem, &candidate);
        let comfort = assess::comfort(problem, &candidate, &configured);
        let mut corrected = rows.to_vec();
        // The bodies' margins are those that a test for collisions asks for.
        if self.linear.correct(problem, &candidate, &configured, &comfort, d, &mut corrected) {
            return Trial::Broken(corrected);
        }
        if !problem.watch.allows() || assess::place(problem, &candidate).is_err() {
            return Trial::Lost;
        }
        let utilisation = assess::utilisation(problem, &candidate, &configured.placed.x_wo);
        if utilisation <= 1.0 {
            return Trial::Feasible(Box::new(assess::rated(problem, candidate, configured, comfort, utilisation)));
        }
        if self.linear.correct_stability(problem, &self.here, utilisation, d, &mut corrected) {
            Trial::Broken(corrected)
        } else {
            Trial::Lost
        }
    }

    /// Moves there and learns from the move.
    fn accept(&mut self, problem: &mut Problem<'_>, there: Feasible, d: &DVector<f64>) {
        let mut linear = Linear::at(problem, &there);
        linear.inherit_stability(&self.linear, &self.here, &there, d);
        // Damped BFGS (Powell) on the negative objective.
        let y = &self.linear.gradient - &linear.gradient;
        let bd = &self.curvature * d;
        let (dbd, dy) = (d.dot(&bd), d.dot(&y));
        if dbd > 0.0 {
            let theta = if dy >= 0.2 * dbd { 1.0 } else { 0.8 * dbd / (dbd - dy) };
            let r = y * theta + &bd * (1.0 - theta);
            self.curvature += &r * r.transpose() / d.dot(&r) - &bd * bd.transpose() / dbd;
        }
        self.linear = linear;
        self.here = there;
    }
}
