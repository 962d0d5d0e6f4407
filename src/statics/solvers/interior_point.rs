//! Dense primal-dual interior-point solver for the equilibrium program.
//!
//! Planners solve thousands of equilibria of the same small shape and need their derivatives. This solves the program
//! of [`super::cone_program`] in the same scaled variables, but dense and of fixed size: hands are coupled by the
//! balance alone, so each hand has its own block of 12 variables, and the Schur complement has one row for each
//! component of the balance and each grip. Predictor-corrector steps after Mehrotra with the scaling of
//! [`super::pad_cone`].
//!
//! Without an equilibrium the multipliers of the balance grow along a motion of the board that the hands cannot resist, which
//! is a proof ([`ContactModel::is_moved`]). If it neither converges within a few iterations nor finds such a motion, the caller
//! solves the program with clarabel. A test compares the two.
//!
//! # Sensitivity to the contact model
//! After convergence the factorised system remains. One Newton step with it, from this equilibrium to the optimality
//! conditions of a slightly different contact model, is exact to first order. A derivative of an equilibrium therefore
//! costs a fraction of an equilibrium.

use nalgebra::{SMatrix, SVector, Vector6};

use super::{
    energy::HandEnergy,
    lower::Lower,
    pad_cone::{self, Scaling, Slack},
    units::{self, DISPLACEMENT_UNIT_M, FORCE_UNIT_N, balance_twist, pad_wrench},
};
use crate::statics::{
    contact_model::{ContactModel, MAX_HANDS},
    hand::HandModel,
    hold::{HandWrench, PadPair},
    twist::Twist,
};

/// Rows of the balance and of the largest number of grips.
const ROWS: usize = 6 + MAX_HANDS;
/// Rows that contain a hand's variables: the balance and its own grip.
const OWN_ROWS: usize = 7;

/// Variables of a hand: those of its two pads.
type Variables = SVector<f64, 12>;
type Rows = SVector<f64, ROWS>;
type HandRows = SMatrix<f64, 12, OWN_ROWS>;

/// Limit of iterations; 8 to 14 are typical.
const MAX_ITERATIONS: usize = 25;
/// The solver gives up after two consecutive steps shorter than this share of the Newton step.
const SHORT_STEP: f64 = 0.02;
/// Tolerance of residuals and mean complementarity in the scaled units: 1e-8 N and 1e-8 mm.
const TOLERANCE: f64 = 1e-9;
/// Share of the distance to the cone's boundary that a step may take.
const BOUNDARY_SHARE: f64 = 0.99;

/// The program of one hand in its scaled variables.
#[derive(Clone, Debug)]
struct HandProgram {
    /// Second derivatives of the energy.
    energy: SMatrix<f64, 12, 12>,
    /// The energy's first derivative at zero.
    shift: Variables,
    /// Its columns of the balance rows and of its grip's row, transposed.
    rows: HandRows,
    friction: [f64; 2],
}

/// Steps shorter than this share of the Newton step suggest that there is no equilibrium.
const DOUBTFUL_STEP: f64 = 0.3;

/// Why there is no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotFound {
    /// A motion of the board that the hands cannot resist proves that there is no equilibrium.
    NoEquilibrium,
    /// The program has a pad without friction or a measured gripper, or the iterations did not converge.
    Unknown,
}

/// The equilibrium program: minimise the energy subject to `sum rows' x = rhs` and the pads' limits.
#[derive(Clone, Debug)]
struct EquilibriumProgram {
    hands: Vec<HandProgram>,
    rhs: Rows,
}

impl EquilibriumProgram {
    /// `None` if a pad has no friction, or for a measured gripper.
    fn new(model: &ContactModel, energies: &[HandEnergy], load_factor: f64) -> Option<Self> {
        let outer = units::scaled(&(model.weight + model.load.scaled(load_factor)));
        let mut rhs = Rows::zeros();
        rhs.fixed_rows_mut::<6>(0).copy_from(&-outer);
        let mut hands = Vec::with_capacity(model.hands.len());
        for (number, (hand, energy)) in model.hands.iter().zip(energies).enumerate() {
            let pair = hand.pad_pair()?;
            if !pair.pads.iter().all(|pad| pad.friction > 0.0) {
                return None;
            }
            rhs[6 + number] = 2.0 * pair.grip_force_n / FORCE_UNIT_N;
            hands.push(hand_program(hand, pair, energy));
        }
        Some(Self { hands, rhs })
    }
}

fn hand_program(hand: &HandModel, pair: &PadPair, energy: &HandEnergy) -> HandProgram {
    let wrench_units = units::wrench_units();
    let mut about_grasp = SMatrix::<f64, 6, 12>::zeros();
    let mut about_object = SMatrix::<f64, 6, 12>::zeros();
    for (index, pad) in pair.pads.iter().enumerate() {
        let place_o = pad.x_op.translation.vector;
        for (map, lever_o) in [(&mut about_grasp, place_o - hand.grasp_point_o), (&mut about_object, place_o)] {
            let mut of_pad = units::pad_map(pad, &lever_o);
            of_pad.row_iter_mut().zip(wrench_units.iter()).for_each(|(mut row, unit)| row /= *unit);
            map.fixed_view_mut::<6, 6>(0, 6 * index).copy_from(&of_pad);
        }
    }
    let mut rows = HandRows::zeros();
    rows.fixed_view_mut::<12, 6>(0, 0).copy_from(&about_object.transpose());
    rows[(2, 6)] = 1.0;
    rows[(8, 6)] = 1.0;
    HandProgram {
        energy: about_grasp.tr_mul(&(energy.arm * about_grasp)) + SMatrix::from_diagonal_element(energy.pads),
        shift: about_grasp.tr_mul(&energy.shift),
        rows,
        friction: pair.pads.each_ref().map(|pad| pad.friction),
    }
}

/// One hand's part of an iterate: its variables and the multipliers of its pads' limits.
#[derive(Clone, Debug)]
struct HandPoint {
    x: Variables,
    z: [Slack; 2],
}

impl HandPoint {
    /// Both pads press with half of the grip force and nothing else: well inside their limits.
    fn start(hand: &HandProgram, normal: f64) -> Self {
        let mut x = Variables::zeros();
        (x[2], x[8]) = (normal, normal);
        let z = [0, 1].map(|pad| {
            // Complementarity products of one: displacements of a millimetre against forces of 10 N.
            let s = pad_cone::slack(&pad_part(&x, pad), hand.friction[pad]);
            pad_cone::quotient(&pad_cone::unit(), &s)
        });
        Self { x, z }
    }

    fn slack(&self, hand: &HandProgram, pad: usize) -> Slack {
        pad_cone::slack(&pad_part(&self.x, pad), hand.friction[pad])
    }
}

fn pad_part(x: &Variables, pad: usize) -> Vector6<f64> {
    x.fixed_rows::<6>(6 * pad).into_owned()
}

/// A change of an iterate.
struct Step {
    hands: Vec<HandStep>,
    y: Rows,
}

struct HandStep {
    x: Variables,
    s: [Slack; 2],
    z: [Slack; 2],
}

/// The Newton system at an iterate, factorised.
#[derive(Clone, Debug)]
struct Factor {
    hands: Vec<HandFactor>,
    /// `sum rows' M^-1 rows`, with ones for absent grips.
    balance: Lower<ROWS>,
}

#[derive(Clone, Debug)]
struct HandFactor {
    scalings: [Scaling; 2],
    /// `M = L L'`, the energy plus the curvature of the limits.
    own: Lower<12>,
    /// `L^-1 rows`.
    half_solved_rows: HandRows,
}

/// A converged equilibrium with its factorised Newton system.
#[derive(Clone, Debug)]
pub struct InteriorPoint {
    hands: Vec<HandPoint>,
    /// Multipliers of balance and grips.
    y: Rows,
    factor: Factor,
}

impl InteriorPoint {
    /// Solves the program.
    ///
    /// # Errors
    /// See [`NotFound`].
    pub fn solve(model: &ContactModel, energies: &[HandEnergy], load_factor: f64) -> Result<Self, NotFound> {
        let program = EquilibriumProgram::new(model, energies, load_factor).ok_or(NotFound::Unknown)?;
        let starts = program.hands.iter().enumerate();
        let mut hands: Vec<_> =
            starts.map(|(number, hand)| HandPoint::start(hand, program.rhs[6 + number] / 2.0)).collect();
        let mut y = Rows::zeros();
        let degree = pad_cone::DEGREE * 2.0 * hands.len() as f64;
        let mut short_steps = 0;
        for _ in 0..MAX_ITERATIONS {
            let factor = factorised(&program, &hands).ok_or(NotFound::Unknown)?;
            let residual = residuals(&program, &hands, &y);
            let gap = gap(&program, &hands);
            if residual.largest() <= TOLERANCE && gap <= TOLERANCE * degree {
                return Ok(Self { hands, y, factor });
            }
            let (step, length) = corrected_step(&program, &factor, &residual, &hands, gap / degree);
            for (point, change) in hands.iter_mut().zip(&step.hands) {
                point.x += change.x * length;
                (0..2).for_each(|pad| point.z[pad] += change.z[pad] * length);
            }
            y += step.y * length;
            if length < DOUBTFUL_STEP && model.is_moved(&(model.weight + model.load.scaled(load_factor)), &board(&y)) {
                return Err(NotFound::NoEquilibrium);
            }
            // A NaN length counts as short.
            short_steps = if length > SHORT_STEP { 0 } else { short_steps + 1 };
            if short_steps == 2 {
                break;
            }
        }
        Err(NotFound::Unknown)
    }

    /// The equilibrium of a slightly different contact model, to first order in the difference; `None` if it has
    /// another number of hands, or a pad without friction.
    pub fn first_order(&self, model: &ContactModel, energies: &[HandEnergy], load_factor: f64) -> Option<Solution> {
        let program =
            EquilibriumProgram::new(model, energies, load_factor).filter(|it| it.hands.len() == self.hands.len())?;
        let residual = residuals(&program, &self.hands, &self.y);
        // The complementarity products do not change.
        let unchanged = vec![[Slack::zeros(); 2]; self.hands.len()];
        let step = newton_step(&program, &self.factor, &residual, &unchanged);
        let moved = self.hands.iter().zip(&step.hands).map(|(point, change)| point.x + change.x);
        Some(solution(model, moved, &(self.y + step.y)))
    }

    /// The equilibrium itself.
    pub fn solution(&self, model: &ContactModel) -> Solution {
        solution(model, self.hands.iter().map(|point| point.x), &self.y)
    }
}

/// An equilibrium: the forces and the board's displacement.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The wrench of each hand on the object.
    pub hand_wrenches: Vec<HandWrench>,
    /// Displacement of the board at O's origin.
    pub board: Twist,
}

/// The equilibrium with these variables and multipliers.
fn solution(model: &ContactModel, hands: impl Iterator<Item = Variables>, y: &Rows) -> Solution {
    let pairs = model.hands.iter().filter_map(HandModel::pad_pair);
    let of_pair = |(pair, x): (&PadPair, Variables)| {
        HandWrench::Pads([0, 1].map(|pad: usize| pad_wrench(&pair.pads[pad], &pad_part(&x, pad))))
    };
    Solution { hand_wrenches: pairs.zip(hands).map(of_pair).collect(), board: board(y) }
}

/// The displacement of the board at O's origin that the multipliers stand for.
fn board(y: &Rows) -> Twist {
    balance_twist(y.as_slice(), FORCE_UNIT_N * DISPLACEMENT_UNIT_M)
}

/// Residuals of the optimality conditions: of the energy's gradient, one entry a hand, and of balance and grips.
struct Residuals {
    dual: Vec<Variables>,
    primal: Rows,
}

impl Residuals {
    fn largest(&self) -> f64 {
        self.dual.iter().map(SVector::amax).fold(self.primal.amax(), f64::max)
    }
}

/// `energy x + rows y - K' z`, and `sum rows' x - wanted`.
fn residuals(program: &EquilibriumProgram, hands: &[HandPoint], y: &Rows) -> Residuals {
    let mut primal = -program.rhs;
    let dual = program.hands.iter().zip(hands).enumerate().map(|(number, (hand, point))| {
        add_own(&mut primal, number, &hand.rows.tr_mul(&point.x));
        hand.energy * point.x + hand.shift + hand.rows * own(y, number) - joined_gradient(&point.z, &hand.friction)
    });
    let dual = dual.collect();
    Residuals { dual, primal }
}

/// The entries of the rows that contain a hand's variables.
fn own(rows: &Rows, number: usize) -> SVector<f64, OWN_ROWS> {
    let mut own = SVector::<f64, OWN_ROWS>::zeros();
    own.fixed_rows_mut::<6>(0).copy_from(&rows.fixed_rows::<6>(0));
    own[6] = rows[6 + number];
    own
}

/// Adds to the rows that contain a hand's variables.
fn add_own(rows: &mut Rows, number: usize, own: &SVector<f64, OWN_ROWS>) {
    let mut balance = rows.fixed_rows_mut::<6>(0);
    balance += own.fixed_rows::<6>(0);
    rows[6 + number] += own[6];
}

/// `K' z` of both pads.
fn joined_gradient(z: &[Slack; 2], friction: &[f64; 2]) -> Variables {
    let mut joined = Variables::zeros();
    for pad in 0..2 {
        joined.fixed_rows_mut::<6>(6 * pad).copy_from(&pad_cone::gradient(&z[pad], friction[pad]));
    }
    joined
}

/// `sum s'z`.
fn gap(program: &EquilibriumProgram, hands: &[HandPoint]) -> f64 {
    let of_hand = |(hand, point): (&HandProgram, &HandPoint)| {
        (0..2).map(|pad| point.slack(hand, pad).dot(&point.z[pad])).sum::<f64>()
    };
    program.hands.iter().zip(hands).map(of_hand).sum()
}

/// The Newton system at an iterate; `None` if it cannot be factorised, which happens only to diverged iterates.
fn factorised(program: &EquilibriumProgram, points: &[HandPoint]) -> Option<Factor> {
    let mut balance = SMatrix::<f64, ROWS, ROWS>::zeros();
    (6 + points.len()..ROWS).for_each(|absent| balance[(absent, absent)] = 1.0);
    let mut hands = Vec::with_capacity(points.len());
    for (number, (hand, point)) in program.hands.iter().zip(points).enumerate() {
        let scalings = [0, 1].map(|pad| Scaling::new(&point.slack(hand, pad), &point.z[pad]));
        let mut own = hand.energy;
        for (pad, scaling) in scalings.iter().enumerate() {
            let mut block = own.fixed_view_mut::<6, 6>(6 * pad, 6 * pad);
            block += scaling.curvature(hand.friction[pad]);
        }
        let own = Lower::new(&own)?;
        let half_solved_rows = own.forward_matrix(&hand.rows);
        let part = half_solved_rows.tr_mul(&half_solved_rows);
        let mut shared = balance.fixed_view_mut::<6, 6>(0, 0);
        shared += part.fixed_view::<6, 6>(0, 0);
        balance.fixed_view_mut::<6, 1>(0, 6 + number).copy_from(&part.fixed_view::<6, 1>(0, 6));
        balance.fixed_view_mut::<1, 6>(6 + number, 0).copy_from(&part.fixed_view::<1, 6>(6, 0));
        balance[(6 + number, 6 + number)] = part[(6, 6)];
        hands.push(HandFactor { scalings, own, half_solved_rows });
    }
    Some(Factor { hands, balance: Lower::new(&balance)? })
}

/// The step that removes the residuals and changes the scaled complementarity, `W dz + W^-1 ds`, by `target`, one entry
/// a pad.
fn newton_step(program: &EquilibriumProgram, factor: &Factor, residual: &Residuals, target: &[[Slack; 2]]) -> Step {
    let mut missing = residual.primal;
    let mut half_solved = Vec::with_capacity(program.hands.len());
    for (number, hand) in program.hands.iter().enumerate() {
        let HandFactor { scalings, own, half_solved_rows } = &factor.hands[number];
        let pull = [0, 1].map(|pad| scalings[pad].apply_inverse(&target[number][pad]));
        let free = own.forward(&(joined_gradient(&pull, &hand.friction) - residual.dual[number]));
        add_own(&mut missing, number, &half_solved_rows.tr_mul(&free));
        half_solved.push(free);
    }
    let y = factor.balance.solve(&missing);
    let hands = program.hands.iter().zip(half_solved).enumerate().map(|(number, (hand, free))| {
        let (factor, target) = (&factor.hands[number], &target[number]);
        let x = factor.own.backward(&(free - factor.half_solved_rows * own(&y, number)));
        let s = [0, 1].map(|pad| pad_cone::slack(&pad_part(&x, pad), hand.friction[pad]));
        let z = [0, 1].map(|pad| {
            let scaling = &factor.scalings[pad];
            scaling.apply_inverse(&(target[pad] - scaling.apply_inverse(&s[pad])))
        });
        HandStep { x, s, z }
    });
    Step { hands: hands.collect(), y }
}

/// Mehrotra's predictor-corrector step from an iterate with mean complementarity `mean`, and the share of it to take.
fn corrected_step(
    program: &EquilibriumProgram,
    factor: &Factor,
    residual: &Residuals,
    points: &[HandPoint],
    mean: f64,
) -> (Step, f64) {
    let of_pads = |target: &dyn Fn(usize, usize) -> Slack| -> Vec<[Slack; 2]> {
        (0..points.len()).map(|hand| [0, 1].map(|pad| target(hand, pad))).collect()
    };
    let scaling = |hand: usize, pad: usize| &factor.hands[hand].scalings[pad];
    let affine = newton_step(program, factor, residual, &of_pads(&|hand, pad| -scaling(hand, pad).scaled));
    let centring = (1.0 - longest_step(program, points, &affine).min(1.0)).powi(3);
    let step = newton_step(
        program,
        factor,
        residual,
        &of_pads(&|hand, pad| {
            let (scaling, step) = (scaling(hand, pad), &affine.hands[hand]);
            let second_order = pad_cone::product(&scaling.apply_inverse(&step.s[pad]), &scaling.apply(&step.z[pad]));
            let product = pad_cone::unit() * (centring * mean) - second_order;
            pad_cone::quotient(&product, &scaling.scaled) - scaling.scaled
        }),
    );
    let length = (BOUNDARY_SHARE * longest_step(program, points, &step)).min(1.0);
    (step, length)
}

/// The largest multiple of a step that keeps slacks and multipliers in their cones.
fn longest_step(program: &EquilibriumProgram, points: &[HandPoint], step: &Step) -> f64 {
    let mut longest = f64::INFINITY;
    for ((hand, point), change) in program.hands.iter().zip(points).zip(&step.hands) {
        for pad in 0..2 {
            longest = longest.min(pad_cone::longest_step(&point.slack(hand, pad), &change.s[pad]));
            longest = longest.min(pad_cone::longest_step(&point.z[pad], &change.z[pad]));
        }
    }
    longest
}
