//! Where the variables and rows of a hold's programs are.

use clarabel::solver::SupportedConeT::{self, NonnegativeConeT, SecondOrderConeT, ZeroConeT};

use super::{
    contact_model::{ContactModel, HandModel},
    program::{PAD_VARIABLES, ProgramKind},
};

/// Rows of a pad's friction cone.
pub(super) const FRICTION_CONE: usize = 4;

/// One pad's variables and rows; each the first of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PadLayout {
    pub(super) variables: usize,
    /// Centre of pressure, `+mt1, -mt1, +mt2, -mt2`.
    pub(super) pressure_rows: usize,
    /// The friction cone.
    pub(super) friction_rows: usize,
}

/// One hand's variables and rows; each the first of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HandLayout {
    pub(super) dof: usize,
    pub(super) first_variable: usize,
    pub(super) wrench_variables: usize,
    /// The rows that define the hand's wrench.
    pub(super) wrench_rows: usize,
    pub(super) grip_row: usize,
    /// n of `+J'w`, then n of `-J'w`.
    pub(super) torque_rows: usize,
    pub(super) pads: [PadLayout; 2],
}

/// Where which variable and row is; see the table of `program`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    kind: ProgramKind,
    hands: Vec<HandLayout>,
    variables: usize,
    load_rows: usize,
    first_cone: usize,
    rows: usize,
}

/// Counts places.
struct Counter(usize);

impl Counter {
    fn take(&mut self, count: usize) -> usize {
        let first = self.0;
        self.0 += count;
        first
    }
}

impl Layout {
    pub(super) fn new(model: &ContactModel, kind: ProgramKind) -> Self {
        let mut layout = Self { kind, hands: Vec::new(), variables: 0, load_rows: 0, first_cone: 0, rows: 0 };
        layout.place_variables(model);
        layout.place_equalities();
        layout.place_inequalities();
        layout.place_cones();
        layout
    }

    fn place_variables(&mut self, model: &ContactModel) {
        let mut next = Counter(0);
        self.hands = model.hands.iter().map(|hand| place_hand(hand, &mut next)).collect();
        next.take(usize::from(self.has_load_factor()));
        self.variables = next.0;
    }

    fn place_equalities(&mut self) {
        let mut next = Counter(6);
        self.hands.iter_mut().for_each(|hand| hand.wrench_rows = next.take(6));
        self.hands.iter_mut().for_each(|hand| hand.grip_row = next.take(1));
        self.load_rows = next.0;
    }

    fn place_inequalities(&mut self) {
        let mut next = Counter(self.load_rows);
        next.take(if self.has_load_factor() { 2 } else { 0 });
        for pad in self.hands.iter_mut().flat_map(|hand| &mut hand.pads) {
            pad.pressure_rows = next.take(4);
        }
        let with_torque = self.has_torque_rows();
        for hand in &mut self.hands {
            hand.torque_rows = next.take(if with_torque { 2 * hand.dof } else { 0 });
        }
        self.first_cone = next.0;
    }

    fn place_cones(&mut self) {
        let mut next = Counter(self.first_cone);
        for pad in self.hands.iter_mut().flat_map(|hand| &mut hand.pads) {
            pad.friction_rows = next.take(FRICTION_CONE);
        }
        self.rows = next.0;
    }

    pub(super) fn kind(&self) -> ProgramKind {
        self.kind
    }

    pub(super) fn hands(&self) -> &[HandLayout] {
        &self.hands
    }

    pub(super) fn has_load_factor(&self) -> bool {
        self.kind != ProgramKind::Equilibrium
    }

    pub(super) fn has_torque_rows(&self) -> bool {
        self.kind == ProgramKind::Load
    }

    pub(super) fn variables(&self) -> usize {
        self.variables
    }

    /// The row `-lambda <= 0`; the next one is `lambda <= 100`. Also the number of equalities.
    pub(super) fn load_rows(&self) -> usize {
        self.load_rows
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn cones(&self) -> Vec<SupportedConeT<f64>> {
        let mut cones = vec![ZeroConeT(self.load_rows), NonnegativeConeT(self.first_cone - self.load_rows)];
        cones.extend(vec![SecondOrderConeT(FRICTION_CONE); 2 * self.hands.len()]);
        cones
    }
}

/// A hand's variables; its rows are placed later.
fn place_hand(hand: &HandModel, next: &mut Counter) -> HandLayout {
    let first_variable = next.0;
    let place_pad =
        |next: &mut Counter| PadLayout { variables: next.take(PAD_VARIABLES), pressure_rows: 0, friction_rows: 0 };
    let pads = [place_pad(next), place_pad(next)];
    let wrench_variables = next.take(6);
    HandLayout { dof: hand.dof(), first_variable, wrench_variables, wrench_rows: 0, grip_row: 0, torque_rows: 0, pads }
}
