//! The compliant equilibrium by an interior-point method of its own.
//!
//! Planners ask for thousands of equilibria of the same small shape, and for how they change from one hold to a near one.
//! This is the same program that [`super::program`] writes for clarabel, in the same scaled variables, but dense and of
//! fixed size: hands meet in the balance alone, so each has its own block of 12 variables, and what is left is a system
//! with one row for each balance and each grip. Mehrotra's predictor and corrector with the scaling of [`super::pad_cone`].
//!
//! Where it does not end well within a few iterations (no equilibrium exists, or hardly), it says nothing, and clarabel,
//! which can prove that there is none, decides. What both find is the same; a test compares them.
//!
//! # The neighbour's equilibrium
//! At the end the factorised system is at hand. One Newton step with it, from this equilibrium to the conditions of a hold
//! that differs a little, is exact to first order: derivatives of an equilibrium cost a fraction of an equilibrium.

use nalgebra::{Cholesky, Const, SMatrix, SVector, Vector6};

use super::{
    contact_model::{ContactModel, HandModel, MAX_HANDS},
    equilibrium::Equilibrium,
    load_factor::balance_twist,
    pad_cone::{self, Scaling, Slack},
    program::{self, DISPLACEMENT_UNIT_M, FORCE_UNIT_N, HandEnergy},
};
use crate::model::wrench::Wrench;

/// Rows of the balance and of up to four grips.
const ROWS: usize = 6 + MAX_HANDS;
/// Rows that a hand has a part in: the balance and its own grip.
const OWN_ROWS: usize = 7;

/// The variables of a hand: those of its two pads.
type Variables = SVector<f64, 12>;
type Rows = SVector<f64, ROWS>;
type HandRows = SMatrix<f64, 12, OWN_ROWS>;

/// Iterations after which it is given up; 8 to 14 are usual.
const MAX_ITERATIONS: usize = 25;
/// A step shorter than this share of what Newton asks for, twice in a row, leads nowhere.
const SHORT_STEP: f64 = 0.02;
/// Residuals and complementarity in the scaled units: 1e-8 N and 1e-8 mm.
const TOLERANCE: f64 = 1e-9;
/// Share of the way to the boundary that a step goes.
const INSIDE: f64 = 0.99;

/// The program of one hand in its scaled variables.
#[derive(Clone, Debug)]
struct HandProgram {
    /// Second derivatives of the energy.
    energy: SMatrix<f64, 12, 12>,
    /// Its part of the rows of the balance and its grip's row, transposed.
    rows: HandRows,
    friction: [f64; 2],
}

/// The program of a hold at a load factor: minimise the energy subject to `sum rows' x = wanted` and the pads' limits.
#[derive(Clone, Debug)]
struct HoldProgram {
    hands: Vec<HandProgram>,
    wanted: Rows,
}

impl HoldProgram {
    /// `None` if a pad has no friction.
    fn new(model: &ContactModel, energies: &[HandEnergy], load_factor: f64) -> Option<Self> {
        let outer = program::scaled(&(model.weight + model.load.scaled(load_factor)));
        let mut wanted = Rows::zeros();
        wanted.fixed_rows_mut::<6>(0).copy_from(&-outer);
        let mut hands = Vec::with_capacity(model.hands.len());
        for (number, (hand, energy)) in model.hands.iter().zip(energies).enumerate() {
            if !hand.pads.iter().all(|pad| pad.friction > 0.0) {
                return None;
            }
            wanted[6 + number] = 2.0 * hand.grip_force_n / FORCE_UNIT_N;
            hands.push(hand_program(hand, energy));
        }
        Some(Self { hands, wanted })
    }
}

fn hand_program(hand: &HandModel, energy: &HandEnergy) -> HandProgram {
    let units = program::wrench_units();
    let mut about_grasp = SMatrix::<f64, 6, 12>::zeros();
    let mut about_object = SMatrix::<f64, 6, 12>::zeros();
    for (index, pad) in hand.pads.iter().enumerate() {
        let place_o = pad.x_op.translation.vector;
        for (map, lever_o) in [(&mut about_grasp, place_o - hand.grasp_point_o), (&mut about_object, place_o)] {
            let mut of_pad = program::pad_map(pad, &lever_o);
            of_pad.row_iter_mut().zip(units.iter()).for_each(|(mut row, unit)| row /= *unit);
            map.fixed_view_mut::<6, 6>(0, 6 * index).copy_from(&of_pad);
        }
    }
    let mut rows = HandRows::zeros();
    rows.fixed_view_mut::<12, 6>(0, 0).copy_from(&about_object.transpose());
    rows[(2, 6)] = 1.0;
    rows[(8, 6)] = 1.0;
    HandProgram {
        energy: about_grasp.tr_mul(&(energy.arm * about_grasp)) + SMatrix::from_diagonal_element(energy.pads),
        rows,
        friction: hand.pads.each_ref().map(|pad| pad.friction),
    }
}

/// One hand's part of an iterate: its variables and the multipliers of its pads' limits.
#[derive(Clone, Debug)]
struct HandPoint {
    x: Variables,
    z: [Slack; 2],
}

impl HandPoint {
    /// Both pads press with half of the grip, and nothing else: deep inside their limits.
    fn start(hand: &HandProgram, normal: f64) -> Self {
        let mut x = Variables::zeros();
        (x[2], x[8]) = (normal, normal);
        let z = [0, 1].map(|pad| {
            // Complementary products of one: displacements of a millimetre against forces of 10 N.
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
    /// `sum rows' M^-1 rows`, with ones for grips that are not there.
    balance: Cholesky<f64, Const<ROWS>>,
}

#[derive(Clone, Debug)]
struct HandFactor {
    scalings: [Scaling; 2],
    /// M, the energy and the curvature of the limits.
    own: Cholesky<f64, Const<12>>,
    /// `M^-1 rows`.
    solved_rows: HandRows,
}

/// An equilibrium, with what it takes to step to a near one.
#[derive(Clone, Debug)]
pub(super) struct InteriorPoint {
    hands: Vec<HandPoint>,
    /// Multipliers of balance and grips.
    y: Rows,
    factor: Factor,
}

impl InteriorPoint {
    /// Solves; none when the hold is not of this kind, or when no end is in sight.
    pub(super) fn solve(model: &ContactModel, energies: &[HandEnergy], load_factor: f64) -> Option<Self> {
        let program = HoldProgram::new(model, energies, load_factor)?;
        let starts = program.hands.iter().enumerate();
        let mut hands: Vec<_> =
            starts.map(|(number, hand)| HandPoint::start(hand, program.wanted[6 + number] / 2.0)).collect();
        let mut y = Rows::zeros();
        let degree = pad_cone::DEGREE * 2.0 * hands.len() as f64;
        let mut short_steps = 0;
        for _ in 0..MAX_ITERATIONS {
            let factor = factorised(&program, &hands)?;
            let residual = residuals(&program, &hands, &y);
            let gap = gap(&program, &hands);
            if residual.largest() <= TOLERANCE && gap <= TOLERANCE * degree {
                return Some(Self { hands, y, factor });
            }
            let (step, length) = corrected_step(&program, &factor, &residual, &hands, gap / degree);
            // Written so that a length that is not a number counts as short.
            short_steps = if length > SHORT_STEP { 0 } else { short_steps + 1 };
            if short_steps == 2 {
                return None;
            }
            for (point, change) in hands.iter_mut().zip(&step.hands) {
                point.x += change.x * length;
                (0..2).for_each(|pad| point.z[pad] += change.z[pad] * length);
            }
            y += step.y * length;
        }
        None
    }

    /// The equilibrium of a near hold with as many hands, to first order in what it differs by; none when it is not of this
    /// kind.
    pub(super) fn first_order(
        &self,
        model: &ContactModel,
        energies: &[HandEnergy],
        load_factor: f64,
    ) -> Option<Equilibrium> {
        let program = HoldProgram::new(model, energies, load_factor).filter(|it| it.hands.len() == self.hands.len())?;
        let residual = residuals(&program, &self.hands, &self.y);
        // The products of slack and multiplier stay as they are.
        let unchanged = vec![[Slack::zeros(); 2]; self.hands.len()];
        let step = newton_step(&program, &self.factor, &residual, &unchanged);
        let moved = self.hands.iter().zip(&step.hands).map(|(point, change)| point.x + change.x);
        Some(equilibrium(model, load_factor, moved, &(self.y + step.y)))
    }

    /// The equilibrium itself.
    pub(super) fn equilibrium(&self, model: &ContactModel, load_factor: f64) -> Equilibrium {
        equilibrium(model, load_factor, self.hands.iter().map(|point| point.x), &self.y)
    }
}

/// The equilibrium with these variables and multipliers.
fn equilibrium(
    model: &ContactModel,
    load_factor: f64,
    hands: impl Iterator<Item = Variables>,
    y: &Rows,
) -> Equilibrium {
    let wrenches_p = model.hands.iter().zip(hands).map(|(hand, x)| {
        [0, 1].map(|pad: usize| {
            let [fx, fy, fz, mx, my, mz] = pad_part(&x, pad).component_mul(&program::pad_units(&hand.pads[pad])).into();
            Wrench::from([fx, fy, fz, mx, my, mz])
        })
    });
    let board = balance_twist(y.as_slice(), FORCE_UNIT_N * DISPLACEMENT_UNIT_M);
    Equilibrium::of_pads(model, load_factor, wrenches_p.collect(), board)
}

/// What an iterate leaves of the conditions: of the energy's gradient, one entry a hand, and of balance and grips.
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
fn residuals(program: &HoldProgram, hands: &[HandPoint], y: &Rows) -> Residuals {
    let mut primal = -program.wanted;
    let dual = program.hands.iter().zip(hands).enumerate().map(|(number, (hand, point))| {
        add_own(&mut primal, number, &hand.rows.tr_mul(&point.x));
        hand.energy * point.x + hand.rows * own(y, number) - joined_gradient(&point.z, &hand.friction)
    });
    let dual = dual.collect();
    Residuals { dual, primal }
}

/// The entries of the rows that a hand has a part in.
fn own(rows: &Rows, number: usize) -> SVector<f64, OWN_ROWS> {
    let mut own = SVector::<f64, OWN_ROWS>::zeros();
    own.fixed_rows_mut::<6>(0).copy_from(&rows.fixed_rows::<6>(0));
    own[6] = rows[6 + number];
    own
}

/// Adds to the rows that a hand has a part in.
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
fn gap(program: &HoldProgram, hands: &[HandPoint]) -> f64 {
    let of_hand = |(hand, point): (&HandProgram, &HandPoint)| {
        (0..2).map(|pad| point.slack(hand, pad).dot(&point.z[pad])).sum::<f64>()
    };
    program.hands.iter().zip(hands).map(of_hand).sum()
}

/// The Newton system at an iterate; none when it cannot be factorised, which only lost iterates cause.
fn factorised(program: &HoldProgram, points: &[HandPoint]) -> Option<Factor> {
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
        let own = own.cholesky()?;
        let solved_rows = own.solve(&hand.rows);
        let part = hand.rows.tr_mul(&solved_rows);
        let mut shared = balance.fixed_view_mut::<6, 6>(0, 0);
        shared += part.fixed_view::<6, 6>(0, 0);
        balance.fixed_view_mut::<6, 1>(0, 6 + number).copy_from(&part.fixed_view::<6, 1>(0, 6));
        balance.fixed_view_mut::<1, 6>(6 + number, 0).copy_from(&part.fixed_view::<1, 6>(6, 0));
        balance[(6 + number, 6 + number)] = part[(6, 6)];
        hands.push(HandFactor { scalings, own, solved_rows });
    }
    Some(Factor { hands, balance: balance.cholesky()? })
}

/// The step that takes the residuals to zero and the scaled complementarity by `wanted`, `W dz + W^-1 ds`, two entries a
/// hand.
fn newton_step(program: &HoldProgram, factor: &Factor, residual: &Residuals, wanted: &[[Slack; 2]]) -> Step {
    let mut missing = residual.primal;
    let mut free = Vec::with_capacity(program.hands.len());
    for (number, hand) in program.hands.iter().enumerate() {
        let HandFactor { scalings, own, .. } = &factor.hands[number];
        let pull = [0, 1].map(|pad| scalings[pad].apply_inverse(&wanted[number][pad]));
        let x = own.solve(&(joined_gradient(&pull, &hand.friction) - residual.dual[number]));
        add_own(&mut missing, number, &hand.rows.tr_mul(&x));
        free.push(x);
    }
    let y = factor.balance.solve(&missing);
    let hands = program.hands.iter().zip(free).enumerate().map(|(number, (hand, free))| {
        let (factor, wanted) = (&factor.hands[number], &wanted[number]);
        let x = free - factor.solved_rows * own(&y, number);
        let s = [0, 1].map(|pad| pad_cone::slack(&pad_part(&x, pad), hand.friction[pad]));
        let z = [0, 1].map(|pad| {
            let scaling = &factor.scalings[pad];
            scaling.apply_inverse(&(wanted[pad] - scaling.apply_inverse(&s[pad])))
        });
        HandStep { x, s, z }
    });
    Step { hands: hands.collect(), y }
}

/// Mehrotra's step from an iterate whose mean complementary product is `mean`, and how much of it stays inside.
fn corrected_step(
    program: &HoldProgram,
    factor: &Factor,
    residual: &Residuals,
    points: &[HandPoint],
    mean: f64,
) -> (Step, f64) {
    let of_pads = |wanted: &dyn Fn(usize, usize) -> Slack| -> Vec<[Slack; 2]> {
        (0..points.len()).map(|hand| [0, 1].map(|pad| wanted(hand, pad))).collect()
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
            let bent = pad_cone::product(&scaling.apply_inverse(&step.s[pad]), &scaling.apply(&step.z[pad]));
            let target = pad_cone::unit() * (centring * mean) - bent;
            pad_cone::quotient(&target, &scaling.scaled) - scaling.scaled
        }),
    );
    let length = (INSIDE * longest_step(program, points, &step)).min(1.0);
    (step, length)
}

/// The largest multiple of a step with which slacks and multipliers stay in their cones.
fn longest_step(program: &HoldProgram, points: &[HandPoint], step: &Step) -> f64 {
    let mut longest = f64::INFINITY;
    for ((hand, point), change) in program.hands.iter().zip(points).zip(&step.hands) {
        for pad in 0..2 {
            longest = longest.min(pad_cone::longest_step(&point.slack(hand, pad), &change.s[pad]));
            longest = longest.min(pad_cone::longest_step(&point.z[pad], &change.z[pad]));
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use nalgebra::Vector3;

    use super::{
        super::{
            equilibrium::{self, EquilibriumOutcome},
            program::{Program, ReusedSolver},
            workspace::hand_energies,
        },
        *,
    };
    use crate::scenario::read_plan;

    /// METHOD section 7.
    const FRICTION: f64 = 0.6;

    /// The ten holds of `tests/data/holds`.
    fn models() -> Vec<ContactModel> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/holds");
        let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        let (_, robot) = read_plan(&paths[0], None).unwrap();
        let model = |path: &std::path::PathBuf| {
            let (plan, _) = read_plan(path, Some(&robot)).unwrap();
            ContactModel::from_plan(&robot, &plan.arms, &plan.object, &plan.operation, FRICTION).unwrap()
        };
        paths.iter().map(model).collect()
    }

    /// By clarabel.
    fn by_program(model: &ContactModel, load_factor: f64) -> EquilibriumOutcome {
        let program = Program::equilibrium(model, &hand_energies(model), load_factor);
        let mut solver = ReusedSolver::default();
        equilibrium::interpret(model, &program.layout, load_factor, &solver.solve(&program).unwrap())
    }

    fn apart(one: &Equilibrium, other: &Equilibrium, model: &ContactModel) -> (f64, f64) {
        let tip = |found: &Equilibrium| found.board.at(&model.p_ot).linear;
        let torque = one.joint_torque_nm.iter().zip(&other.joint_torque_nm).map(|(one, other)| (one - other).amax());
        ((tip(one) - tip(other)).norm(), torque.fold(0.0, f64::max))
    }

    #[test]
    fn it_finds_what_the_cone_program_finds() {
        let mut found = 0;
        for model in models() {
            for load_factor in [0.0, 0.5, 1.0, 1.1] {
                let EquilibriumOutcome::Found(expected) = by_program(&model, load_factor) else { continue };
                let point = InteriorPoint::solve(&model, &hand_energies(&model), load_factor).unwrap();
                let (tip_m, torque_nm) = apart(&point.equilibrium(&model, load_factor), &expected, &model);
                // Clarabel stops at 1e-7 of a unit, where the flattest directions of the energy are known to 1e-4 of it.
                assert!(tip_m < 1e-6 && torque_nm < 1e-3, "at {load_factor}: {tip_m:e} m, {torque_nm:e} N m");
                found += 1;
            }
        }
        assert!(found > 30, "{found}");
    }

    #[test]
    fn it_says_nothing_of_a_load_that_no_equilibrium_holds() {
        for model in models() {
            assert!(InteriorPoint::solve(&model, &hand_energies(&model), 50.0).is_none());
            assert_eq!(by_program(&model, 50.0), EquilibriumOutcome::NoEquilibrium);
        }
    }

    #[test]
    fn a_neighbours_equilibrium_is_exact_to_first_order() {
        // The tool's force a little further along the board and a little turned.
        let moved = |model: &ContactModel, step: f64| {
            let mut moved = model.clone();
            moved.load.force_n += Vector3::new(0.4, -0.3, 0.5) * step;
            moved.load.moment_nm += Vector3::new(0.02, 0.05, -0.04) * step;
            moved.hands[0].grasp_point_o.x += 1e-3 * step;
            moved.hands[0].pads.iter_mut().for_each(|pad| pad.x_op.translation.vector.x += 1e-3 * step);
            moved
        };
        for model in models() {
            let energies = hand_energies(&model);
            let point = InteriorPoint::solve(&model, &energies, 1.0).unwrap();
            let error = |step: f64| {
                let there = moved(&model, step);
                let energies = hand_energies(&there);
                let exact = InteriorPoint::solve(&there, &energies, 1.0).unwrap().equilibrium(&there, 1.0);
                let guess = point.first_order(&there, &energies, 1.0).unwrap();
                let moved_m = apart(&exact, &point.equilibrium(&model, 1.0), &model).0;
                (apart(&guess, &exact, &model).0, moved_m)
            };
            let (error_m, moved_m) = error(0.01);
            // What is left goes with the square of the step, a hundredth of the motion here; a pad that reaches or leaves
            // its limit between the two holds may take a few times that.
            assert!(error_m < 0.05 * moved_m + 1e-9, "{error_m:e} m of {moved_m:e} m");
        }
    }
}
