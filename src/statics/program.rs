//! The cone programs of a hold in clarabel's form, `min 1/2 x'Px + q'x  s.t.  A x + s = b, s in K`, scaled.
//!
//! Variables: for each hand, for each of its pads, `(ft1, ft2, fn, mt1, mt2, mn)` in pad axes about the pad's centre;
//! then the hand's wrench about its grasp point, which torque rows and energy are written in, half as wide as they
//! would be in the pads' variables; last, in the load program, the load factor. Rows, in the order of the cones:
//!
//! | rows | cone | what |
//! |---|---|---|
//! | 6 | zero | balance of the object: sum of the hands' wrenches + lambda load = -weight |
//! | 6 a hand | zero | the hand's wrench is the sum of its pads' |
//! | 1 a hand | zero | `fn_1 + fn_2 = 2 F` |
//! | 2 (load program) | nonnegative | `0 <= lambda <= 100` |
//! | 4 a pad | nonnegative | centre of pressure: `|mt1| <= b fn`, `|mt2| <= a fn`; `fn >= 0` follows |
//! | 2 n a hand (with torque limits) | nonnegative | `J' w <= tau_max - tau_g`, `-J' w <= tau_max + tau_g` |
//! | 4 a pad | second order | friction: `(mu fn, ft1, ft2, mn / e)` |
//!
//! Scales: forces in units of 10 N, moments of 10 N x 0.2 m in hands' wrenches and balance; a pad's own moments by its half sides
//! and torsion radius, so that every pad's rows look alike; torque rows by the joint's limit; lambda by the load's size.
//! With these clarabel needs no equilibration of its own, whose memory of earlier data would make results depend on
//! the order of solves.

use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT},
};
use nalgebra::{Matrix6, Vector3, Vector6};

use super::{
    contact_model::{ContactModel, HandModel, PadModel},
    layout::{HandLayout, Layout, PadLayout},
};
use crate::model::wrench::Wrench;

/// The load factor is searched for up to this.
pub const MAX_LOAD_FACTOR: f64 = 100.0;

/// Unit of force, N.
pub(super) const FORCE_UNIT_N: f64 = 10.0;

/// Displacements are solved for in this unit, m: those of interest are a few of it.
pub(super) const DISPLACEMENT_UNIT_M: f64 = 1e-3;

/// Unit of length of the moments in the balance rows, m.
pub(super) const LENGTH_UNIT_M: f64 = 0.2;

/// Clarabel's tolerance of gap and feasibility, in the scaled units.
const SOLVER_TOLERANCE: f64 = 1e-7;

/// Variables of one pad.
pub(super) const PAD_VARIABLES: usize = 6;

/// What a program contains beside the balance, the grip and the pads' limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ProgramKind {
    /// Maximise lambda within friction and torque limits.
    Load,
    /// Maximise lambda within friction limits alone: up to there a compliant equilibrium exists.
    Friction,
    /// Minimise the complementary energy at a given lambda.
    Equilibrium,
}

/// A sparse matrix in the making, column by column.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl Columns {
    pub(super) fn begin(&mut self) {
        self.starts.push(self.rows.len());
    }

    pub(super) fn push(&mut self, row: usize, value: f64) {
        self.rows.push(row);
        self.values.push(value);
    }

    pub(super) fn into_matrix(mut self, rows: usize) -> CscMatrix<f64> {
        let columns = self.starts.len();
        self.starts.push(self.rows.len());
        CscMatrix::new(rows, columns, self.starts, self.rows, self.values)
    }
}

/// A program's data.
#[derive(Clone, Debug)]
pub(super) struct Program {
    pub(super) layout: Layout,
    pub(super) p: CscMatrix<f64>,
    pub(super) q: Vec<f64>,
    pub(super) a: CscMatrix<f64>,
    pub(super) b: Vec<f64>,
    /// lambda = load variable / this.
    pub(super) load_scale: f64,
}

impl Program {
    /// Maximise lambda, with torque limits for [`ProgramKind::Load`], without for
    /// [`ProgramKind::Friction`].
    pub(super) fn load(model: &ContactModel, kind: ProgramKind) -> Self {
        let layout = Layout::new(model, kind);
        let load = scaled(&model.load);
        let size = load.norm();
        // Without a load any lambda will do.
        let load_scale = if size > 0.0 { size } else { 1.0 };
        let mut columns = hand_columns(model, &layout);
        columns.begin();
        (0..6).for_each(|row| columns.push(row, load[row] / load_scale));
        columns.push(layout.load_rows(), -1.0);
        columns.push(layout.load_rows() + 1, 1.0 / (MAX_LOAD_FACTOR * load_scale));
        let mut q = vec![0.0; layout.variables()];
        q[layout.variables() - 1] = -1.0 / load_scale;
        let mut b = limits(model, &layout, 0.0);
        b[layout.load_rows() + 1] = 1.0;
        let a = columns.into_matrix(layout.rows());
        Self { p: CscMatrix::zeros((q.len(), q.len())), q, a, b, layout, load_scale }
    }

    /// Minimise `1/2 x'Px` at the given lambda, `P` made of the energy of each hand.
    pub(super) fn equilibrium(model: &ContactModel, energies: &[HandEnergy], lambda: f64) -> Self {
        let layout = Layout::new(model, ProgramKind::Equilibrium);
        let mut p = Columns::default();
        for (hand, energy) in layout.hands().iter().zip(energies) {
            for variable in hand.first_variable..hand.wrench_variables {
                p.begin();
                p.push(variable, energy.pads);
            }
            for column in 0..6 {
                p.begin();
                (0..=column).for_each(|row| p.push(hand.wrench_variables + row, energy.arm[(row, column)]));
            }
        }
        let a = hand_columns(model, &layout).into_matrix(layout.rows());
        let q = vec![0.0; layout.variables()];
        let b = limits(model, &layout, lambda);
        Self { p: p.into_matrix(layout.variables()), q, a, b, layout, load_scale: 1.0 }
    }
}

/// The second derivatives of one hand's energy in the scaled variables.
#[derive(Clone, Debug)]
pub(super) struct HandEnergy {
    /// Of the hand's wrench.
    pub(super) arm: Matrix6<f64>,
    /// Of each of its pads' variables.
    pub(super) pads: f64,
}

/// Units of a pad's variables: N for the forces, N m for the moments.
pub(super) fn pad_units(pad: &PadModel) -> Vector6<f64> {
    let [a, b] = pad.half_sides_m;
    Vector6::new(1.0, 1.0, 1.0, b, a, pad.torsion_radius_m()) * FORCE_UNIT_N
}

/// A wrench in units of the balance rows.
pub(super) fn scaled(wrench: &Wrench) -> Vector6<f64> {
    Wrench::new(wrench.force_n, wrench.moment_nm / LENGTH_UNIT_M).to_vector() / FORCE_UNIT_N
}

/// `[R 0; [p]x R, R]` times the variables' units: the wrench about a point, p leading from it to the pad, N and N m.
pub(super) fn pad_map(pad: &PadModel, lever_o: &Vector3<f64>) -> Matrix6<f64> {
    let rotation = pad.rotation();
    let mut map = Matrix6::zeros();
    map.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    map.fixed_view_mut::<3, 3>(3, 0).copy_from(&(lever_o.cross_matrix() * rotation));
    map.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
    for (mut column, unit) in map.column_iter_mut().zip(pad_units(pad).iter()) {
        column *= *unit;
    }
    map
}

/// Units of a hand's wrench variables, N and N m.
pub(super) fn wrench_units() -> Vector6<f64> {
    let (force, moment) = (FORCE_UNIT_N, FORCE_UNIT_N * LENGTH_UNIT_M);
    Vector6::new(force, force, force, moment, moment, moment)
}

/// The columns of all hands' variables.
fn hand_columns(model: &ContactModel, layout: &Layout) -> Columns {
    let mut columns = Columns::default();
    for (hand, place) in model.hands.iter().zip(layout.hands()) {
        for (pad, pad_place) in hand.pads.iter().zip(&place.pads) {
            push_pad(&mut columns, hand, place, pad, pad_place);
        }
        push_wrench(&mut columns, layout, hand, place);
    }
    columns
}

fn push_pad(columns: &mut Columns, hand: &HandModel, hand_place: &HandLayout, pad: &PadModel, place: &PadLayout) {
    let lever_o = pad.x_op.translation.vector - hand.grasp_point_o;
    let (map, units) = (pad_map(pad, &lever_o), wrench_units());
    let (pressure, friction) = (place.pressure_rows, place.friction_rows);
    for variable in 0..PAD_VARIABLES {
        columns.begin();
        // A moment has no force: those entries are zero by structure.
        let first = if variable < 3 { 0 } else { 3 };
        (first..6).for_each(|row| columns.push(hand_place.wrench_rows + row, map[(row, variable)] / units[row]));
        if variable == 2 {
            columns.push(hand_place.grip_row, 1.0);
        }
        match variable {
            0 | 1 => columns.push(friction + 1 + variable, -1.0),
            2 => {
                (0..4).for_each(|row| columns.push(pressure + row, -1.0));
                columns.push(friction, -pad.friction);
            }
            3 | 4 => {
                columns.push(pressure + 2 * (variable - 3), 1.0);
                columns.push(pressure + 2 * (variable - 3) + 1, -1.0);
            }
            _ => columns.push(friction + 3, -1.0),
        }
    }
}

fn push_wrench(columns: &mut Columns, layout: &Layout, hand: &HandModel, place: &HandLayout) {
    let units = wrench_units();
    // The wrench about O: the moment gains p x f.
    let lever = hand.grasp_point_o.cross_matrix() / LENGTH_UNIT_M;
    for component in 0..6 {
        columns.begin();
        columns.push(component, 1.0);
        if component < 3 {
            (0..3).filter(|&row| row != component).for_each(|row| columns.push(3 + row, lever[(row, component)]));
        }
        columns.push(place.wrench_rows + component, -1.0);
        if layout.has_torque_rows() {
            let (first, dof) = (place.torque_rows, hand.dof());
            let torque = |joint: usize| hand.jacobian_o[(component, joint)] * units[component] / hand.effort_nm[joint];
            (0..dof).for_each(|joint| columns.push(first + joint, torque(joint)));
            (0..dof).for_each(|joint| columns.push(first + dof + joint, -torque(joint)));
        }
    }
}

/// The right-hand side, with `lambda` times the load moved to it.
fn limits(model: &ContactModel, layout: &Layout, lambda: f64) -> Vec<f64> {
    let mut b = vec![0.0; layout.rows()];
    let outer = scaled(&(model.weight + model.load.scaled(lambda)));
    (0..6).for_each(|row| b[row] = -outer[row]);
    for (hand, place) in model.hands.iter().zip(layout.hands()) {
        b[place.grip_row] = 2.0 * hand.grip_force_n / FORCE_UNIT_N;
        if layout.has_torque_rows() {
            let row = place.torque_rows;
            for joint in 0..hand.dof() {
                let ratio = hand.gravity_torque_nm[joint] / hand.effort_nm[joint];
                b[row + joint] = 1.0 - ratio;
                b[row + hand.dof() + joint] = 1.0 + ratio;
            }
        }
    }
    b
}

/// The pads' wrenches of one hand, each about its centre in pad axes, from the variables.
pub(super) fn pad_wrenches(hand: &HandModel, place: &HandLayout, x: &[f64]) -> [Wrench; 2] {
    [0, 1].map(|pad: usize| {
        let first = place.pads[pad].variables;
        let values = Vector6::from_column_slice(&x[first..first + PAD_VARIABLES]);
        let [fx, fy, fz, mx, my, mz] = values.component_mul(&pad_units(&hand.pads[pad])).into();
        Wrench::from([fx, fy, fz, mx, my, mz])
    })
}

/// The wrench of a hand on the object about its grasp point, O axes.
pub(super) fn hand_wrench(place: &HandLayout, x: &[f64]) -> Wrench {
    let values = Vector6::from_column_slice(&x[place.wrench_variables..place.wrench_variables + 6]);
    Wrench::from(<[f64; 6]>::from(values.component_mul(&wrench_units())))
}

/// A clarabel solver that is kept as long as programs have the same layout, so that memory, ordering and symbolic
/// factorisation are reused.
#[derive(Default)]
pub(super) struct ReusedSolver {
    solver: Option<(Layout, DefaultSolver<f64>)>,
}

/// What clarabel found, with the slacks' and duals' scales of the program.
pub(super) struct RawSolution<'a> {
    pub(super) status: SolverStatus,
    pub(super) x: &'a [f64],
    pub(super) z: &'a [f64],
    pub(super) s: &'a [f64],
}

impl ReusedSolver {
    /// Solves a program; none when clarabel refuses its data, which only figures that are not finite can cause.
    pub(super) fn solve(&mut self, program: &Program) -> Option<RawSolution<'_>> {
        let Program { layout, p, q, a, b, .. } = program;
        let reusable = self
            .solver
            .as_mut()
            .is_some_and(|(known, solver)| known == layout && solver.update_data(p, q, a, b).is_ok());
        if !reusable {
            let solver = new_solver(p, q, a, b, &layout.cones())?;
            self.solver = Some((layout.clone(), solver));
        }
        let (_, solver) = self.solver.as_mut()?;
        solve_with_care(solver)?;
        let solution = &solver.solution;
        Some(RawSolution { status: solution.status, x: &solution.x, z: &solution.z, s: &solution.s })
    }
}

/// A solver for a program; none when clarabel refuses the data.
pub(super) fn new_solver(
    p: &CscMatrix<f64>,
    q: &[f64],
    a: &CscMatrix<f64>,
    b: &[f64],
    cones: &[SupportedConeT<f64>],
) -> Option<DefaultSolver<f64>> {
    DefaultSolver::new(p, q, a, b, cones, settings(false)).ok()
}

/// Solves, and again with refinement when that ends without a conclusion.
pub(super) fn solve_with_care(solver: &mut DefaultSolver<f64>) -> Option<()> {
    solver.solve();
    if !is_conclusive(solver.solution.status) {
        // Settings that may change between solves: neither call can fail.
        solver.update_settings(settings(true)).ok()?;
        solver.solve();
        solver.update_settings(settings(false)).ok()?;
    }
    Some(())
}

fn is_conclusive(status: SolverStatus) -> bool {
    matches!(status, SolverStatus::Solved | SolverStatus::PrimalInfeasible)
}

/// Clarabel's settings for small, well-scaled programs whose data are replaced between solves. The refinement of its
/// linear solves is a third of the time and seldom needed: clarabel measures its own residuals, so a solve without it
/// either ends well or is repeated with care.
fn settings(careful: bool) -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        // 8 to 15 iterations are usual.
        max_iter: 60,
        max_threads: 1,
        // Both would forbid, or colour, the reuse of a solver: see the module's text.
        presolve_enable: false,
        equilibrate_enable: false,
        iterative_refinement_enable: careful,
        // In the scaled units: 1e-7 of a load factor, 1e-4 micrometres.
        tol_gap_abs: SOLVER_TOLERANCE,
        tol_gap_rel: SOLVER_TOLERANCE,
        tol_feas: SOLVER_TOLERANCE,
        ..DefaultSettings::default()
    }
}
