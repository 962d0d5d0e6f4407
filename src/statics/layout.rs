//! Where the variables and rows of a hold's programs are.

use clarabel::solver::SupportedConeT::{self, NonnegativeConeT, SecondOrderConeT, ZeroConeT};

use super::{
    contact::{LimitShape, PadKind},
    contact_model::{ContactModel, HandModel, PadModel},
    program::{PAD_VARIABLES, POINT_VARIABLES, ProgramKind},
};

/// Rows of a soft finger's friction cone.
pub(super) const SOFT_CONE: usize = 4;

/// Rows of a measured ellipsoid's cone.
pub(super) const MEASURED_CONE: usize = 7;

/// Of a pad of points: how many, where their variables are, and where the rows that sum them up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PointLayout {
    pub(super) count: usize,
    pub(super) variables: usize,
    pub(super) sum_rows: usize,
}

/// One pad's variables and rows; each the first of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PadLayout {
    pub(super) variables: usize,
    /// Centre of pressure, `+mt1, -mt1, +mt2, -mt2`; of a pad of points the normal force of each.
    pub(super) pressure_rows: usize,
    /// The friction cone, or those of the points.
    pub(super) friction_rows: usize,
    pub(super) points: Option<PointLayout>,
}

/// What limits a hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contact {
    /// Its pads.
    Pads([PadLayout; 2]),
    /// Measured limits, one by one: the first of six rows of `+w`, followed by six of `-w`.
    Box { rows: usize },
    /// Measured limits, together: the first of the rows of their cone.
    Ellipsoid { rows: usize },
}

/// One hand's variables and rows; each the first of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HandLayout {
    pub(super) dof: usize,
    pub(super) first_variable: usize,
    pub(super) wrench_variables: usize,
    /// The rows that say what the hand's wrench is; those of a hand with pads only, as the next.
    pub(super) wrench_rows: usize,
    pub(super) grip_row: usize,
    /// n of `+J'w`, then n of `-J'w`.
    pub(super) torque_rows: usize,
    pub(super) contact: Contact,
}

impl HandLayout {
    /// Its pads' places; none for a hand with measured limits.
    pub(super) fn pads(&self) -> Option<&[PadLayout; 2]> {
        match &self.contact {
            Contact::Pads(pads) => Some(pads),
            Contact::Box { .. } | Contact::Ellipsoid { .. } => None,
        }
    }

    fn pads_mut(&mut self) -> impl Iterator<Item = &mut PadLayout> {
        match &mut self.contact {
            Contact::Pads(pads) => pads.as_mut_slice(),
            Contact::Box { .. } | Contact::Ellipsoid { .. } => &mut [],
        }
        .iter_mut()
    }
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
        for points in self.hands.iter_mut().flat_map(HandLayout::pads_mut).filter_map(|pad| pad.points.as_mut()) {
            points.variables = next.take(POINT_VARIABLES * points.count);
        }
        next.take(usize::from(self.has_load_factor()));
        self.variables = next.0;
    }

    fn place_equalities(&mut self) {
        let mut next = Counter(6);
        let with_pads = |hand: &&mut HandLayout| hand.pads().is_some();
        self.hands.iter_mut().filter(with_pads).for_each(|hand| hand.wrench_rows = next.take(6));
        self.hands.iter_mut().filter(with_pads).for_each(|hand| hand.grip_row = next.take(1));
        for points in self.hands.iter_mut().flat_map(HandLayout::pads_mut).filter_map(|pad| pad.points.as_mut()) {
            points.sum_rows = next.take(PAD_VARIABLES);
        }
        self.load_rows = next.0;
    }

    fn place_inequalities(&mut self) {
        let mut next = Counter(self.load_rows);
        next.take(if self.has_load_factor() { 2 } else { 0 });
        for pad in self.hands.iter_mut().flat_map(HandLayout::pads_mut) {
            pad.pressure_rows = next.take(pad.points.map_or(4, |points| points.count));
        }
        for hand in &mut self.hands {
            if let Contact::Box { rows } = &mut hand.contact {
                *rows = next.take(12);
            }
        }
        let with_torque = self.has_torque_rows();
        for hand in &mut self.hands {
            hand.torque_rows = next.take(if with_torque { 2 * hand.dof } else { 0 });
        }
        self.first_cone = next.0;
    }

    fn place_cones(&mut self) {
        let mut next = Counter(self.first_cone);
        for pad in self.hands.iter_mut().flat_map(HandLayout::pads_mut) {
            pad.friction_rows = next.take(pad.points.map_or(SOFT_CONE, |points| POINT_VARIABLES * points.count));
        }
        for hand in &mut self.hands {
            if let Contact::Ellipsoid { rows } = &mut hand.contact {
                *rows = next.take(MEASURED_CONE);
            }
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
        for pad in self.hands.iter().filter_map(HandLayout::pads).flatten() {
            match pad.points {
                None => cones.push(SecondOrderConeT(SOFT_CONE)),
                Some(points) => cones.extend(std::iter::repeat_n(SecondOrderConeT(POINT_VARIABLES), points.count)),
            }
        }
        let of_hand = |hand: &&HandLayout| matches!(hand.contact, Contact::Ellipsoid { .. });
        cones.extend(self.hands.iter().filter(of_hand).map(|_| SecondOrderConeT(MEASURED_CONE)));
        cones
    }
}

/// A hand's variables but those of points; its rows are placed later.
fn place_hand(hand: &HandModel, next: &mut Counter) -> HandLayout {
    let first_variable = next.0;
    let contact = match &hand.wrench_limits {
        None => Contact::Pads([0, 1].map(|pad: usize| place_pad(&hand.pads[pad], next))),
        Some(limits) => match limits.shape {
            LimitShape::Box => Contact::Box { rows: 0 },
            LimitShape::Ellipsoid => Contact::Ellipsoid { rows: 0 },
        },
    };
    let wrench_variables = next.take(6);
    let dof = hand.dof();
    HandLayout { dof, first_variable, wrench_variables, wrench_rows: 0, grip_row: 0, torque_rows: 0, contact }
}

fn place_pad(pad: &PadModel, next: &mut Counter) -> PadLayout {
    let points = match &pad.kind {
        PadKind::SoftFinger => None,
        PadKind::Points(points) => Some(PointLayout { count: points.len(), variables: 0, sum_rows: 0 }),
    };
    PadLayout { variables: next.take(PAD_VARIABLES), pressure_rows: 0, friction_rows: 0, points }
}
