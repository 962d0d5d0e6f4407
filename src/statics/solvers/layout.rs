//! Positions of the variables and rows in the cone programs of a contact model.

use clarabel::solver::SupportedConeT::{self, NonnegativeConeT, SecondOrderConeT, ZeroConeT};

use crate::{
    model::wrench_limits::LimitShape,
    statics::{contact_model::ContactModel, hand::HandModel, hold::Hold},
};

/// Variables of one pad.
pub const PAD_VARIABLES: usize = 6;

/// Rows of a pad's friction cone.
pub const FRICTION_CONE: usize = 4;

/// Rows of measured limits, one for each direction of a component, and of the cone of an ellipsoid.
pub const LIMIT_ROWS: usize = 12;
pub const SHARE_CONE: usize = 7;

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

/// First indices of the rows of two pads, and of their variables and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairLayout {
    /// The rows that define the hand's wrench.
    pub wrench_rows: usize,
    pub grip_row: usize,
    pub pads: [PadLayout; 2],
}

/// First indices of the rows of measured limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitLayout {
    /// Six rows of `w_i / h_i`, then six of `w_i / l_i`: at most 1, or at most the share of an ellipsoid.
    pub rows: usize,
    /// The shares of an ellipsoid; `None` for a box.
    pub shares: Option<ShareLayout>,
}

/// First indices of the six shares of an ellipsoid and of their cone `(1, shares)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShareLayout {
    pub variables: usize,
    pub cone_rows: usize,
}

/// What limits a hand's wrench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldLayout {
    /// Its pads.
    Pads(PairLayout),
    /// Measured limits.
    Measured(LimitLayout),
    /// Nothing: the equilibrium program has no measured limits.
    Free,
}

/// First indices of one hand's variables and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HandLayout {
    pub dof: usize,
    pub first_variable: usize,
    pub wrench_variables: usize,
    /// n rows of `+J'w`, then n of `-J'w`.
    pub torque_rows: usize,
    pub hold: HoldLayout,
}

impl HandLayout {
    /// The places of its pads; none of a measured gripper.
    pub fn pads(&self) -> &[PadLayout] {
        match &self.hold {
            HoldLayout::Pads(pair) => &pair.pads,
            HoldLayout::Measured(_) | HoldLayout::Free => &[],
        }
    }

    fn pair_mut(&mut self) -> Option<&mut PairLayout> {
        match &mut self.hold {
            HoldLayout::Pads(pair) => Some(pair),
            HoldLayout::Measured(_) | HoldLayout::Free => None,
        }
    }

    fn limits_mut(&mut self) -> Option<&mut LimitLayout> {
        match &mut self.hold {
            HoldLayout::Measured(limits) => Some(limits),
            HoldLayout::Pads(_) | HoldLayout::Free => None,
        }
    }
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
        let limited = self.has_load_factor();
        self.hands = model.hands.iter().map(|hand| place_hand(hand, limited, &mut next)).collect();
        next.take(usize::from(self.has_load_factor()));
        self.variables = next.0;
    }

    fn place_equalities(&mut self) {
        let mut next = Counter(6);
        self.hands.iter_mut().filter_map(HandLayout::pair_mut).for_each(|pair| pair.wrench_rows = next.take(6));
        self.hands.iter_mut().filter_map(HandLayout::pair_mut).for_each(|pair| pair.grip_row = next.take(1));
        self.load_rows = next.0;
    }

    fn place_inequalities(&mut self) {
        let mut next = Counter(self.load_rows);
        next.take(if self.has_load_factor() { 2 } else { 0 });
        for pad in self.hands.iter_mut().filter_map(HandLayout::pair_mut).flat_map(|pair| &mut pair.pads) {
            pad.pressure_rows = next.take(4);
        }
        self.hands.iter_mut().filter_map(HandLayout::limits_mut).for_each(|limits| limits.rows = next.take(LIMIT_ROWS));
        let with_torque = self.has_torque_rows();
        for hand in &mut self.hands {
            hand.torque_rows = next.take(if with_torque { 2 * hand.dof } else { 0 });
        }
        self.first_cone = next.0;
    }

    fn place_cones(&mut self) {
        let mut next = Counter(self.first_cone);
        for pad in self.hands.iter_mut().filter_map(HandLayout::pair_mut).flat_map(|pair| &mut pair.pads) {
            pad.friction_rows = next.take(FRICTION_CONE);
        }
        for shares in
            self.hands.iter_mut().filter_map(HandLayout::limits_mut).filter_map(|limits| limits.shares.as_mut())
        {
            shares.cone_rows = next.take(SHARE_CONE);
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
        let pads: usize = self.hands.iter().map(|hand| hand.pads().len()).sum();
        cones.extend(vec![SecondOrderConeT(FRICTION_CONE); pads]);
        let is_ellipsoid =
            |hand: &&HandLayout| matches!(hand.hold, HoldLayout::Measured(LimitLayout { shares: Some(_), .. }));
        cones.extend(vec![SecondOrderConeT(SHARE_CONE); self.hands.iter().filter(is_ellipsoid).count()]);
        cones
    }
}

/// Allocates a hand's variables; its rows follow later. Measured limits count if `limited`.
fn place_hand(hand: &HandModel, limited: bool, next: &mut Counter) -> HandLayout {
    let first_variable = next.0;
    let place_pad =
        |next: &mut Counter| PadLayout { variables: next.take(PAD_VARIABLES), pressure_rows: 0, friction_rows: 0 };
    let (wrench_variables, hold) = match &hand.hold {
        Hold::Pads(_) => {
            let pads = [place_pad(next), place_pad(next)];
            (next.take(6), HoldLayout::Pads(PairLayout { wrench_rows: 0, grip_row: 0, pads }))
        }
        Hold::Measured(measured) => {
            let wrench_variables = next.take(6);
            let is_ellipsoid = measured.limits.shape == LimitShape::Ellipsoid;
            let shares = (limited && is_ellipsoid).then(|| ShareLayout { variables: next.take(6), cone_rows: 0 });
            let limits = LimitLayout { rows: 0, shares };
            (wrench_variables, if limited { HoldLayout::Measured(limits) } else { HoldLayout::Free })
        }
    };
    HandLayout { dof: hand.dof(), first_variable, wrench_variables, torque_rows: 0, hold }
}
