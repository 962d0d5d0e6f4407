//! The cone programs of a contact model in clarabel's form, `min 1/2 x'Px + q'x s.t. A x + s = b, s in K`
//! (docs/method.md#65-load-factor, docs/method.md#68-compliant-equilibrium).
//!
//! Variables: for each hand `(ft1, ft2, fn, mt1, mt2, mn)` of each pad, in pad axes about the pad's centre, then the
//! hand's wrench about its grasp point; last, in the load program, the load factor lambda. Torque rows and energy are
//! written in the hand's wrench, where they have half as many entries as in the pads' variables. A measured gripper has its
//! wrench alone, and with an ellipsoid the six shares `u` of its limits; in the equilibrium program it has no limits. Rows, in
//! the order of the cones:
//!
//! | rows | cone | what |
//! |---|---|---|
//! | 6 | zero | balance of the object: sum of the hands' wrenches + lambda load = -weight |
//! | 6 a hand with pads | zero | the hand's wrench is the sum of its pads' |
//! | 1 a hand with pads | zero | `fn_1 + fn_2 = 2 F` |
//! | 2 (load program) | nonnegative | `0 <= lambda <= 100` |
//! | 4 a pad | nonnegative | centre of pressure: `|mt1| <= b fn`, `|mt2| <= a fn`; `fn >= 0` follows |
//! | 12 a measured gripper (load program) | nonnegative | `w_i / h_i` and `w_i / l_i` at most 1 (box) or `u_i` (ellipsoid) |
//! | 2 n a hand (with torque limits) | nonnegative | `J' w <= tau_max - tau_g`, `-J' w <= tau_max + tau_g` |
//! | 4 a pad | second order | friction: `(mu fn, ft1, ft2, mn / e)` |
//! | 7 an ellipsoid (load program) | second order | `(1, u)` |
//!
//! Scales: see [`super::units`]; torque rows are divided by the joint's limit, lambda is scaled by the load's size.
//! With these clarabel needs no equilibration, which would make results depend on the order of solves.

use clarabel::algebra::CscMatrix;
use nalgebra::Vector6;

use super::{
    energy::HandEnergy,
    layout::{
        HandLayout, HoldLayout, LIMIT_ROWS, Layout, LimitLayout, PAD_VARIABLES, PadLayout, PairLayout, ProgramKind,
        ShareLayout,
    },
    units::{FORCE_UNIT_N, LENGTH_UNIT_M, pad_map, pad_wrench, scaled, wrench_units},
};
use crate::{
    model::wrench::Wrench,
    statics::{
        contact_model::ContactModel,
        hand::HandModel,
        hold::{HandWrench, MeasuredHold},
        pad_model::PadModel,
    },
};

/// The largest load factor that the load program returns.
pub const MAX_LOAD_FACTOR: f64 = 100.0;

/// A load factor this near to the cap counts as the cap: far above the solver's tolerance.
pub const CAP_MARGIN: f64 = 1e-3;

/// Builds a sparse matrix column by column.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl Columns {
    pub fn begin(&mut self) {
        self.starts.push(self.rows.len());
    }

    pub fn push(&mut self, row: usize, value: f64) {
        self.rows.push(row);
        self.values.push(value);
    }

    pub fn into_matrix(mut self, rows: usize) -> CscMatrix<f64> {
        let columns = self.starts.len();
        self.starts.push(self.rows.len());
        CscMatrix::new(rows, columns, self.starts, self.rows, self.values)
    }
}

/// The data of a program.
#[derive(Clone, Debug)]
pub struct ConeProgram {
    pub layout: Layout,
    pub p: CscMatrix<f64>,
    pub q: Vec<f64>,
    pub a: CscMatrix<f64>,
    pub b: Vec<f64>,
    /// lambda is the load variable divided by this.
    pub load_scale: f64,
}

impl ConeProgram {
    /// Maximises lambda, with torque limits for [`ProgramKind::Load`], without for [`ProgramKind::Friction`].
    pub fn load(model: &ContactModel, kind: ProgramKind) -> Self {
        let layout = Layout::new(model, kind);
        let load = scaled(&model.load);
        let size = load.norm();
        // Without a load any lambda is feasible.
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

    /// Minimises the energy `1/2 x'Px + q'x` of the hands at a given lambda.
    pub fn equilibrium(model: &ContactModel, energies: &[HandEnergy], lambda: f64) -> Self {
        let layout = Layout::new(model, ProgramKind::Equilibrium);
        let mut p = Columns::default();
        for (hand, energy) in layout.hands().iter().zip(energies) {
            // A measured gripper has no variables before its wrench.
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
        let mut q = vec![0.0; layout.variables()];
        for (hand, energy) in layout.hands().iter().zip(energies) {
            q[hand.wrench_variables..hand.wrench_variables + 6].copy_from_slice(energy.shift.as_slice());
        }
        let b = limits(model, &layout, lambda);
        Self { p: p.into_matrix(layout.variables()), q, a, b, layout, load_scale: 1.0 }
    }
}

/// The columns of all hands' variables.
fn hand_columns(model: &ContactModel, layout: &Layout) -> Columns {
    let mut columns = Columns::default();
    for (hand, place) in model.hands.iter().zip(layout.hands()) {
        if let (Some(pair), HoldLayout::Pads(pair_place)) = (hand.pad_pair(), &place.hold) {
            for (pad, pad_place) in pair.pads.iter().zip(&pair_place.pads) {
                push_pad(&mut columns, hand, pair_place, pad, pad_place);
            }
        }
        push_wrench(&mut columns, layout, hand, place);
        if let HoldLayout::Measured(LimitLayout { rows, shares: Some(shares) }) = &place.hold {
            push_shares(&mut columns, *rows, shares);
        }
    }
    columns
}

fn push_pad(columns: &mut Columns, hand: &HandModel, pair: &PairLayout, pad: &PadModel, place: &PadLayout) {
    let lever_o = pad.x_op.translation.vector - hand.grasp_point_o;
    let (map, units) = (pad_map(pad, &lever_o), wrench_units());
    let (pressure, friction) = (place.pressure_rows, place.friction_rows);
    for variable in 0..PAD_VARIABLES {
        columns.begin();
        // A moment has no force, so those entries are structurally zero.
        let first = if variable < 3 { 0 } else { 3 };
        (first..6).for_each(|row| columns.push(pair.wrench_rows + row, map[(row, variable)] / units[row]));
        if variable == 2 {
            columns.push(pair.grip_row, 1.0);
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
    // About O's origin the moment is larger by p x f.
    let lever = hand.grasp_point_o.cross_matrix() / LENGTH_UNIT_M;
    for component in 0..6 {
        columns.begin();
        columns.push(component, 1.0);
        if component < 3 {
            (0..3).filter(|&row| row != component).for_each(|row| columns.push(3 + row, lever[(row, component)]));
        }
        match (&place.hold, hand.measured()) {
            (HoldLayout::Pads(pair), _) => columns.push(pair.wrench_rows + component, -1.0),
            (HoldLayout::Measured(limits), Some(measured)) => push_limits(columns, limits, measured, component),
            _ => {}
        }
        if layout.has_torque_rows() {
            let (first, dof) = (place.torque_rows, hand.dof());
            let torque = |joint: usize| hand.jacobian_o[(component, joint)] * units[component] / hand.effort_nm[joint];
            (0..dof).for_each(|joint| columns.push(first + joint, torque(joint)));
            (0..dof).for_each(|joint| columns.push(first + dof + joint, -torque(joint)));
        }
    }
}

/// The entries of a wrench variable in the rows of measured limits. Forces are in the rows of forces alone, moments in those of
/// moments; of these all are pushed, so that programs of one layout have the same structure.
fn push_limits(columns: &mut Columns, limits: &LimitLayout, measured: &MeasuredHold, component: usize) {
    let mut unit = [0.0; 6];
    unit[component] = wrench_units()[component];
    let wrench_g = <[f64; 6]>::from(measured.in_g(&Wrench::from(unit)));
    let first = if component < 3 { 0 } else { 3 };
    for (number, limit) in [measured.limits.high, measured.limits.low].map(<[f64; 6]>::from).into_iter().enumerate() {
        (first..first + 3).for_each(|row| columns.push(limits.rows + 6 * number + row, wrench_g[row] / limit[row]));
    }
}

/// The columns of the shares of an ellipsoid's limits.
fn push_shares(columns: &mut Columns, rows: usize, shares: &ShareLayout) {
    for component in 0..6 {
        columns.begin();
        columns.push(rows + component, -1.0);
        columns.push(rows + 6 + component, -1.0);
        columns.push(shares.cone_rows + 1 + component, -1.0);
    }
}

/// The right-hand side b, which contains `lambda` times the load.
fn limits(model: &ContactModel, layout: &Layout, lambda: f64) -> Vec<f64> {
    let mut b = vec![0.0; layout.rows()];
    let outer = scaled(&(model.weight + model.load.scaled(lambda)));
    (0..6).for_each(|row| b[row] = -outer[row]);
    for (hand, place) in model.hands.iter().zip(layout.hands()) {
        match (&place.hold, hand.pad_pair()) {
            (HoldLayout::Pads(pair_place), Some(pair)) => {
                b[pair_place.grip_row] = 2.0 * pair.grip_force_n / FORCE_UNIT_N;
            }
            (HoldLayout::Measured(LimitLayout { shares: Some(shares), .. }), _) => b[shares.cone_rows] = 1.0,
            (HoldLayout::Measured(LimitLayout { rows, shares: None }), _) => b[*rows..rows + LIMIT_ROWS].fill(1.0),
            _ => {}
        }
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

/// The wrench of a hand on the object from the variables: of its pads, or of the whole of a measured gripper.
pub fn wrench_of(hand: &HandModel, place: &HandLayout, x: &[f64]) -> HandWrench {
    match (hand.pad_pair(), &place.hold) {
        (Some(pair), HoldLayout::Pads(pair_place)) => HandWrench::Pads([0, 1].map(|pad: usize| {
            let first = pair_place.pads[pad].variables;
            pad_wrench(&pair.pads[pad], &Vector6::from_column_slice(&x[first..first + PAD_VARIABLES]))
        })),
        _ => HandWrench::Measured(hand_wrench(place, x)),
    }
}

/// The wrench of a hand on the object about its grasp point, O axes.
pub fn hand_wrench(place: &HandLayout, x: &[f64]) -> Wrench {
    let values = Vector6::from_column_slice(&x[place.wrench_variables..place.wrench_variables + 6]);
    Wrench::from(<[f64; 6]>::from(values.component_mul(&wrench_units())))
}
