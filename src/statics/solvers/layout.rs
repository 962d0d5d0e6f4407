//! Positions of the variables and rows in the cone programs of a contact model.

use clarabel::solver::SupportedConeT::{self, NonnegativeConeT, SecondOrderConeT, ZeroConeT};

use crate::statics::{contact_model::ContactModel, hand::HandModel};

/// Variables of one pad.
pub const PAD_VARIABLES: usize = 6;

/// Rows of a pad's friction cone.
pub const FRICTION_CONE: usize = 4;

/// Which program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramKind {
    /// Maximise lambda within friction and torque limits.
    Load,
    /// Maximise lambda within friction limits alone: a compliant equilibrium exists up to there.
    Friction,
    /// Minimise the complementary energy at a given lambda.
    Equilibrium,
}

/// First indices of one pad's variables and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PadLayout {
    pub variables: usize,
    /// Centre of pressure, `+mt1, -mt1, +mt2, -mt2`.
    pub pressure_rows: usize,
    /// The friction cone.
    pub friction_rows: usize,
}

/// First indices of one hand's variables and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HandLayout {
    pub dof: usize,
    pub first_variable: usize,
    pub wrench_variables: usize,
    /// The rows that define the hand's wrench.
    pub wrench_rows: usize,
    pub grip_row: usize,
    /// n rows of `+J'w`, then n of `-J'w`.
    pub torque_rows: usize,
    pub pads: [PadLayout; 2],
}

/// Positions of all variables and rows; see the table of [`super::cone_program`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    kind: ProgramKind,
    hands: Vec<HandLayout>,
    variables: usize,
    load_rows: usize,
    first_cone: usize,
    rows: usize,
}

/// Allocates consecutive indices.
struct Counter(usize);

impl Counter {
    fn take(&mut self, count: usize) -> usize {
        let first = self.0;
        self.0 += count;
        first
    }
}

impl Layout {
    pub fn new(model: &ContactModel, kind: ProgramKind) -> Self {
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

    pub fn kind(&self) -> ProgramKind {
        self.kind
    }

    pub fn hands(&self) -> &[HandLayout] {
        &self.hands
    }

    pub fn has_load_factor(&self) -> bool {
        self.kind != ProgramKind::Equilibrium
    }

    pub fn has_torque_rows(&self) -> bool {
        self.kind == ProgramKind::Load
    }

    pub fn variables(&self) -> usize {
        self.variables
    }

    /// The row `-lambda <= 0`; the next one is `lambda <= 100`. Also the number of equalities.
    pub fn load_rows(&self) -> usize {
        self.load_rows
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    pub fn cones(&self) -> Vec<SupportedConeT<f64>> {
        let mut cones = vec![ZeroConeT(self.load_rows), NonnegativeConeT(self.first_cone - self.load_rows)];
        cones.extend(vec![SecondOrderConeT(FRICTION_CONE); 2 * self.hands.len()]);
        cones
    }
}

/// Allocates a hand's variables; its rows follow later.
fn place_hand(hand: &HandModel, next: &mut Counter) -> HandLayout {
    let first_variable = next.0;
    let place_pad =
        |next: &mut Counter| PadLayout { variables: next.take(PAD_VARIABLES), pressure_rows: 0, friction_rows: 0 };
    let pads = [place_pad(next), place_pad(next)];
    let wrench_variables = next.take(6);
    HandLayout { dof: hand.dof(), first_variable, wrench_variables, wrench_rows: 0, grip_row: 0, torque_rows: 0, pads }
}
