//! The robust load factor: the largest one for every load and friction of a set
//! (docs/method.md#611-uncertain-friction-and-loads).
//!
//! # Internal forces
//! [`InternalForces::Adapt`]: some distribution of forces exists for every variation. The variations share only lambda,
//! and the feasible load factors of each are an interval from 0, since its program is convex and the weight alone is
//! held. So the robust load factor is the smallest of theirs, and each is solved separately.
//!
//! [`InternalForces::Fixed`]: position-controlled arms do not measure the variation. Their internal force is the same
//! in all variations, and the difference between two loads is shared by their stiffness: hand i's wrenches under the
//! loads k and 1 differ by `lambda (a_i(load_k) - a_i(load_1))`, with `a_i` hand i's share of a load by the welded
//! stiffness (docs/method.md#67-welded-stiffness). This is one program: a copy of the load program for each variation,
//! coupled by lambda and by these rows. Its load factor is at most the minimum above, and equal to it for a single
//! hand, which has no internal force.
//!
//! # More than the listed variations
//! A grasp that resists several loads at one friction resists every convex combination of them: the same combination of
//! the forces stays in the cones, and `a_i` is linear. A grasp that resists a load at one friction and grip force
//! resists it at any higher ones. So for a polytope of loads and intervals of friction and grip force the vertices at
//! the lowest friction and grip force are enough.

use clarabel::{
    algebra::CscMatrix,
    solver::{SolverStatus, SupportedConeT},
};

use super::{
    contact_model::{ContactModel, ContactModelError},
    load_factor::{LoadFactorOutcome, NAMED_SHARE},
    solvers::{
        clarabel::{new_solver, solve_conclusively},
        cone_program::{CAP_MARGIN, Columns, ConeProgram, MAX_LOAD_FACTOR, hand_wrench},
        layout::ProgramKind,
        units::wrench_units,
    },
    welded::WeldedStiffness,
    workspace::StabilityWorkspace,
};
use crate::model::wrench::Wrench;

/// A load, friction and grip force in place of the contact model's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// The operation's wrench at load factor 1, about O's origin in O axes.
    pub load: Wrench,
    /// Friction of every pad, as a multiple of its own.
    pub friction_ratio: f64,
    /// Grip force of every hand, or its measured limits, as a multiple of its own; more than 0.
    pub grip_force_ratio: f64,
}

/// How the arms' internal forces, which balance each other, vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InternalForces {
    /// Different in each variation.
    Adapt,
    /// The same in all: differences between loads are shared by the arms' stiffness.
    Fixed,
}

/// The load factor for a set of variations.
#[derive(Clone, Debug, PartialEq)]
pub struct RobustLoadFactor {
    /// The largest multiple of the load, 0 to 100, that the grasp resists in every variation.
    pub load_factor: f64,
    /// Indices of the variations that limit it; all others could be left out. Empty if only the cap of 100 binds.
    pub limiting: Vec<usize>,
    /// The hands' wrenches on the object in each variation at that load factor, about their grasp points, O axes.
    pub hand_wrenches: Vec<Vec<Wrench>>,
}

/// The outcome of the robust program.
#[derive(Clone, Debug, PartialEq)]
pub enum RobustOutcome {
    /// Solved.
    Solved(RobustLoadFactor),
    /// Not even the weight alone is held at the friction of this variation.
    GravityInfeasible {
        /// The index of the variation.
        variation: usize,
    },
    /// An arm is rigid in some direction, so the arms' shares of a load are not defined.
    Rigid,
    /// A solver stopped early; must not be taken for stable.
    Unknown {
        /// The solver's status.
        status: String,
    },
}

impl StabilityWorkspace {
    /// The largest load factor at which the grasp resists every one of several variations of load and friction
    /// (docs/method.md#611-uncertain-friction-and-loads).
    ///
    /// # Errors
    /// If the contact model or a variation is invalid, or there are no variations.
    pub fn robust_load_factor(
        &mut self,
        model: &ContactModel,
        variations: &[Variation],
        internal_forces: InternalForces,
    ) -> Result<RobustOutcome, ContactModelError> {
        model.check()?;
        check(variations)?;
        let models: Vec<_> = variations.iter().map(|variation| varied(model, variation)).collect();
        if let Some(outcome) = weight_not_held(self, &models)? {
            return Ok(outcome);
        }
        let adapted = smallest(self, &models)?;
        match (&adapted, internal_forces) {
            (RobustOutcome::Solved(_), InternalForces::Fixed) if model.hands.len() > 1 => {
                Ok(with_fixed(model, &models))
            }
            _ => Ok(adapted),
        }
    }
}

fn check(variations: &[Variation]) -> Result<(), ContactModelError> {
    if variations.is_empty() {
        return Err(ContactModelError::NoVariations);
    }
    for (number, Variation { load, friction_ratio, grip_force_ratio }) in variations.iter().enumerate() {
        let place = format!("variation {number}");
        if !load.is_finite() {
            return Err(ContactModelError::NotFinite { place, what: "load" });
        }
        if !(friction_ratio.is_finite() && *friction_ratio >= 0.0) {
            let (what, found, expected) = ("friction ratio", *friction_ratio, "0 or more");
            return Err(ContactModelError::Value { place, what, found, expected });
        }
        if !(grip_force_ratio.is_finite() && *grip_force_ratio > 0.0) {
            let (what, found, expected) = ("grip force ratio", *grip_force_ratio, "more than 0");
            return Err(ContactModelError::Value { place, what, found, expected });
        }
    }
    Ok(())
}

fn varied(model: &ContactModel, variation: &Variation) -> ContactModel {
    let mut varied = ContactModel { load: variation.load, ..model.clone() };
    for hand in &mut varied.hands {
        hand.scale_grip(variation.grip_force_ratio);
        hand.pads_mut().iter_mut().for_each(|pad| pad.friction *= variation.friction_ratio);
    }
    varied
}

/// The outcome if the hands cannot carry the board in some variation. A load that lifts the board may then be held
/// where less of it is not, and the feasible load factors are no interval from 0.
fn weight_not_held(
    workspace: &mut StabilityWorkspace,
    models: &[ContactModel],
) -> Result<Option<RobustOutcome>, ContactModelError> {
    for (variation, model) in models.iter().enumerate() {
        let idle = ContactModel { load: Wrench::default(), ..model.clone() };
        match workspace.load_factor(&idle)? {
            LoadFactorOutcome::Solved(_) => {}
            LoadFactorOutcome::GravityInfeasible { .. } => {
                return Ok(Some(RobustOutcome::GravityInfeasible { variation }));
            }
            LoadFactorOutcome::Unknown { status } => return Ok(Some(RobustOutcome::Unknown { status })),
        }
    }
    Ok(None)
}

/// The minimum over models that share only the load factor. The wrenches of each are those at its own load factor.
fn smallest(workspace: &mut StabilityWorkspace, models: &[ContactModel]) -> Result<RobustOutcome, ContactModelError> {
    let mut worst = (f64::INFINITY, 0);
    let mut hand_wrenches = Vec::with_capacity(models.len());
    for (variation, model) in models.iter().enumerate() {
        match workspace.load_factor(model)? {
            LoadFactorOutcome::Solved(solved) => {
                if solved.load_factor < worst.0 {
                    worst = (solved.load_factor, variation);
                }
                let of_hands = model.hands.iter().zip(&solved.hand_wrenches);
                hand_wrenches.push(of_hands.map(|(hand, wrench)| hand.wrench_about_grasp_point(wrench)).collect());
            }
            LoadFactorOutcome::GravityInfeasible { .. } => return Ok(RobustOutcome::GravityInfeasible { variation }),
            LoadFactorOutcome::Unknown { status } => return Ok(RobustOutcome::Unknown { status }),
        }
    }
    let limiting = if worst.0 < MAX_LOAD_FACTOR - CAP_MARGIN { vec![worst.1] } else { Vec::new() };
    Ok(RobustOutcome::Solved(RobustLoadFactor { load_factor: worst.0, limiting, hand_wrenches }))
}

/// One program with the rows that fix the internal forces.
fn with_fixed(model: &ContactModel, models: &[ContactModel]) -> RobustOutcome {
    let Some(welded) = WeldedStiffness::new(model) else { return RobustOutcome::Rigid };
    let shares: Vec<_> = models.iter().map(|varied| welded.hand_wrenches(&varied.load)).collect();
    let blocks: Vec<_> = models.iter().map(|varied| ConeProgram::load(varied, ProgramKind::Load)).collect();
    let joint = JointProgram::new(&blocks, &shares);
    let unknown = |status: String| RobustOutcome::Unknown { status };
    let Some(mut solver) =
        new_solver(&CscMatrix::zeros((joint.q.len(), joint.q.len())), &joint.q, &joint.a, &joint.b, &joint.cones)
    else {
        return unknown("data refused".into());
    };
    if solve_conclusively(&mut solver).is_none() || solver.solution.status != SolverStatus::Solved {
        return unknown(format!("{:?}", solver.solution.status));
    }
    let (x, z) = (&solver.solution.x, &solver.solution.z);
    let load_factor = x[x.len() - 1] / blocks[0].load_scale;
    let hand_wrenches = blocks.iter().zip(&joint.places).map(|(block, place)| {
        let of_hand = |hand| hand_wrench(hand, &x[place.column..]);
        block.layout.hands().iter().map(of_hand).collect()
    });
    RobustOutcome::Solved(RobustLoadFactor {
        load_factor: load_factor.clamp(0.0, MAX_LOAD_FACTOR),
        limiting: limiting(&blocks, &joint.places, z),
        hand_wrenches: hand_wrenches.collect(),
    })
}

/// The variations whose inequalities have significant multipliers.
fn limiting(blocks: &[ConeProgram], places: &[Place], z: &[f64]) -> Vec<usize> {
    let size = |(block, place): (&ConeProgram, &Place)| {
        // The first two rows are the load factor's range and limit no forces.
        let rows = place.row + block.layout.load_rows() + 2..place.row + block.layout.rows();
        z[rows].iter().map(|value| value * value).sum::<f64>().sqrt()
    };
    let sizes: Vec<f64> = blocks.iter().zip(places).map(size).collect();
    let cap: f64 = blocks.iter().zip(places).map(|(block, place)| z[place.row + block.layout.load_rows() + 1]).sum();
    let largest = sizes.iter().copied().fold(cap, f64::max);
    (0..sizes.len()).filter(|&variation| sizes[variation] >= NAMED_SHARE * largest && cap < largest).collect()
}

/// The first row and column of a variation's copy of the program.
struct Place {
    row: usize,
    column: usize,
}

/// Copies of the load program with one load factor, the last variable.
struct JointProgram {
    q: Vec<f64>,
    a: CscMatrix<f64>,
    b: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
    places: Vec<Place>,
}

impl JointProgram {
    /// `shares` are the hands' wrenches by the welded stiffness, for each variation.
    fn new(blocks: &[ConeProgram], shares: &[Vec<Wrench>]) -> Self {
        let mut places = Vec::with_capacity(blocks.len());
        let (mut rows, mut variables) = (0, 0);
        let (mut b, mut cones) = (Vec::new(), Vec::new());
        for block in blocks {
            places.push(Place { row: rows, column: variables });
            rows += block.b.len();
            variables += block.q.len() - 1;
            b.extend(&block.b);
            cones.extend(block.layout.cones());
        }
        // The first hand's wrench follows from the balance.
        let couplings = 6 * (shares[0].len() - 1);
        let coupling_rows = couplings * (blocks.len() - 1);
        cones.push(SupportedConeT::ZeroConeT(coupling_rows));
        b.resize(rows + coupling_rows, 0.0);
        let mut columns = Columns::default();
        for number in 0..blocks.len() {
            push_force_columns(&mut columns, blocks, &places, number, rows);
        }
        push_load_factor_column(&mut columns, blocks, &places, shares, rows);
        let mut q = vec![0.0; variables + 1];
        q[variables] = -1.0 / blocks[0].load_scale;
        Self { q, a: columns.into_matrix(rows + coupling_rows), b, cones, places }
    }
}

/// The columns of one variation's forces. The wrenches of all hands but the first are also in the coupling rows; those
/// of the first variation in the coupling rows of every other.
fn push_force_columns(
    columns: &mut Columns,
    blocks: &[ConeProgram],
    places: &[Place],
    number: usize,
    first_coupling: usize,
) {
    let block = &blocks[number];
    let couplings = 6 * (block.layout.hands().len() - 1);
    for column in 0..block.q.len() - 1 {
        columns.begin();
        for entry in block.a.colptr[column]..block.a.colptr[column + 1] {
            columns.push(places[number].row + block.a.rowval[entry], block.a.nzval[entry]);
        }
        let of_hand = block.layout.hands()[1..]
            .iter()
            .position(|hand| (hand.wrench_variables..hand.wrench_variables + 6).contains(&column));
        let Some(hand) = of_hand else { continue };
        let coupling = first_coupling + 6 * hand + column - block.layout.hands()[hand + 1].wrench_variables;
        match number {
            0 => (1..blocks.len()).for_each(|other| columns.push(coupling + couplings * (other - 1), -1.0)),
            _ => columns.push(coupling + couplings * (number - 1), 1.0),
        }
    }
}

/// The column of the load factor: each variation's own, in the unit of the first's, and the entries of the coupling
/// rows.
fn push_load_factor_column(
    columns: &mut Columns,
    blocks: &[ConeProgram],
    places: &[Place],
    shares: &[Vec<Wrench>],
    first_coupling: usize,
) {
    let unit = blocks[0].load_scale;
    columns.begin();
    for (block, place) in blocks.iter().zip(places) {
        let last = block.q.len() - 1;
        for entry in block.a.colptr[last]..block.a.colptr[last + 1] {
            columns.push(place.row + block.a.rowval[entry], block.a.nzval[entry] * block.load_scale / unit);
        }
    }
    let mut row = first_coupling;
    for share in &shares[1..] {
        for (of_this, of_first) in share.iter().zip(&shares[0]).skip(1) {
            let difference = (of_this.to_vector() - of_first.to_vector()).component_div(&wrench_units());
            difference.iter().enumerate().for_each(|(component, value)| columns.push(row + component, -value / unit));
            row += 6;
        }
    }
}
