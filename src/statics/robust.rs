//! The load factor that stands a whole set of loads and frictions: what a hold is worth when neither is known exactly.
//!
//! # Which forces may answer a variation
//! [`InternalForces::Adapt`]: for every variation some distribution of forces exists. The programs share nothing but
//! lambda, and the load factors that one of them holds are an interval from 0, since it is convex and the weight alone
//! is required to be held. So the largest common load factor is the smallest of theirs, exactly, and each is solved for itself.
//!
//! [`InternalForces::Fixed`]: position-controlled arms do not know which variation it is. With what they press against
//! each other they have to serve all of them, and the difference between two loads is shared by their stiffness: hand
//! i's wrenches under the loads k and 1 differ by `lambda (a_i(load_k) - a_i(load_1))`, `a_i` the welded hold's answer
//! (METHOD section 6). That is one program: a copy of the load program for each variation, lambda and these rows in
//! common. Never more than the minimum; for a single hand the same, as it has nothing to press against.
//!
//! # More than the listed variations
//! A hold that stands several loads at one friction stands every mixture of them: mix the forces the same way, which
//! stay in the cones, and the answers `a_i` are linear. A hold that stands a load at one friction stands it at any
//! higher one. So for a polytope of loads and an interval of frictions the vertices at the lowest friction are enough.

use clarabel::{
    algebra::CscMatrix,
    solver::{SolverStatus, SupportedConeT},
};

use super::{
    compliance::WeldedStiffness,
    contact_model::{ContactModel, ContactModelError},
    load_factor::{LoadFactorOutcome, NAMED_SHARE},
    program::{Columns, MAX_LOAD_FACTOR, Program, ProgramKind, hand_wrench, new_solver, solve_with_care, wrench_units},
    workspace::StabilityWorkspace,
};
use crate::model::wrench::Wrench;

/// How near to the cap a load factor counts as the cap: far above the solver's tolerance.
const CAP_MARGIN: f64 = 1e-3;

/// What may be instead of the hold's own load and friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// The operation's wrench at load factor 1, about O's origin in O axes.
    pub load: Wrench,
    /// Friction of every pad, as a multiple of its own.
    pub friction_ratio: f64,
}

/// What the arms' internal forces, those that balance each other, may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InternalForces {
    /// Be others in each variation.
    Adapt,
    /// Be the same in all: the loads' differences are shared by the arms' stiffness.
    Fixed,
}

/// A load factor that stands every variation.
#[derive(Clone, Debug, PartialEq)]
pub struct RobustLoadFactor {
    /// The largest multiple, 0 to 100, of every variation's load that is held.
    pub load_factor: f64,
    /// The variations that limit it, by their places in the list: all others could be left out. Empty when nothing but
    /// the cap of 100 does.
    pub limiting: Vec<usize>,
    /// The hands' wrenches on the object in each variation at that load factor, about their grasp points, O axes.
    pub hand_wrenches: Vec<Vec<Wrench>>,
}

/// What became of the robust program.
#[derive(Clone, Debug, PartialEq)]
pub enum RobustOutcome {
    /// Solved.
    Solved(RobustLoadFactor),
    /// Not even the weight alone is held at the friction of this variation.
    GravityInfeasible {
        /// Its place in the list.
        variation: usize,
    },
    /// An arm has a direction without compliance, so how the arms share a load is not defined.
    Rigid,
    /// A solver stopped early: never to be taken for stable.
    Unknown {
        /// The solver's own word.
        status: String,
    },
}

/// See [`StabilityWorkspace::robust_load_factor`].
pub(super) fn solve(
    workspace: &mut StabilityWorkspace,
    model: &ContactModel,
    variations: &[Variation],
    internal_forces: InternalForces,
) -> Result<RobustOutcome, ContactModelError> {
    model.check()?;
    check(variations)?;
    let models: Vec<_> = variations.iter().map(|variation| varied(model, variation)).collect();
    if let Some(outcome) = weight_not_held(workspace, &models, variations)? {
        return Ok(outcome);
    }
    let adapted = smallest(workspace, &models)?;
    match (&adapted, internal_forces) {
        (RobustOutcome::Solved(_), InternalForces::Fixed) if model.hands.len() > 1 => Ok(with_fixed(model, &models)),
        _ => Ok(adapted),
    }
}

fn check(variations: &[Variation]) -> Result<(), ContactModelError> {
    if variations.is_empty() {
        return Err(ContactModelError::NoVariations);
    }
    for (number, Variation { load, friction_ratio }) in variations.iter().enumerate() {
        let place = format!("variation {number}");
        if !load.is_finite() {
            return Err(ContactModelError::NotFinite { place, what: "load" });
        }
        if !(friction_ratio.is_finite() && *friction_ratio >= 0.0) {
            let (what, found, expected) = ("friction ratio", *friction_ratio, "0 or more");
            return Err(ContactModelError::Value { place, what, found, expected });
        }
    }
    Ok(())
}

fn varied(model: &ContactModel, variation: &Variation) -> ContactModel {
    let mut varied = ContactModel { load: variation.load, ..model.clone() };
    varied.hands.iter_mut().flat_map(|hand| &mut hand.pads).for_each(|pad| pad.friction *= variation.friction_ratio);
    varied
}

/// What becomes of a board that its hands cannot carry at the lowest friction: a load that lifts it may be held where
/// less of it is not, and the load factors held are then no interval from 0.
fn weight_not_held(
    workspace: &mut StabilityWorkspace,
    models: &[ContactModel],
    variations: &[Variation],
) -> Result<Option<RobustOutcome>, ContactModelError> {
    let friction = |variation: &usize| variations[*variation].friction_ratio;
    let lowest = (0..models.len()).min_by(|left, right| friction(left).total_cmp(&friction(right)));
    let Some(variation) = lowest else { return Err(ContactModelError::NoVariations) };
    let idle = ContactModel { load: Wrench::default(), ..models[variation].clone() };
    Ok(match workspace.load_factor(&idle)? {
        LoadFactorOutcome::Solved(_) => None,
        LoadFactorOutcome::GravityInfeasible { .. } => Some(RobustOutcome::GravityInfeasible { variation }),
        LoadFactorOutcome::Unknown { status } => Some(RobustOutcome::Unknown { status }),
    })
}

/// The minimum over holds that share nothing but the load factor; the forces of each are those at its own.
fn smallest(workspace: &mut StabilityWorkspace, models: &[ContactModel]) -> Result<RobustOutcome, ContactModelError> {
    let mut worst = (f64::INFINITY, 0);
    let mut hand_wrenches = Vec::with_capacity(models.len());
    for (variation, model) in models.iter().enumerate() {
        match workspace.load_factor(model)? {
            LoadFactorOutcome::Solved(solved) => {
                if solved.load_factor < worst.0 {
                    worst = (solved.load_factor, variation);
                }
                let of_hands = model.hands.iter().zip(&solved.pad_wrenches_p);
                hand_wrenches.push(of_hands.map(|(hand, pads)| hand.wrench_about_grasp_point(pads)).collect());
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
    let answers: Vec<_> = models.iter().map(|varied| welded.hand_wrenches(&varied.load)).collect();
    let blocks: Vec<_> = models.iter().map(|varied| Program::load(varied, ProgramKind::Load)).collect();
    let joint = JointProgram::new(&blocks, &answers);
    let unknown = |status: String| RobustOutcome::Unknown { status };
    let Some(mut solver) =
        new_solver(&CscMatrix::zeros((joint.q.len(), joint.q.len())), &joint.q, &joint.a, &joint.b, &joint.cones)
    else {
        return unknown("data refused".into());
    };
    if solve_with_care(&mut solver).is_none() || solver.solution.status != SolverStatus::Solved {
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

/// The variations whose inequalities have multipliers worth naming.
fn limiting(blocks: &[Program], places: &[Place], z: &[f64]) -> Vec<usize> {
    let size = |(block, place): (&Program, &Place)| {
        // The two rows of the load factor's range stand first: they limit no forces.
        let rows = place.row + block.layout.load_rows() + 2..place.row + block.layout.rows();
        z[rows].iter().map(|value| value * value).sum::<f64>().sqrt()
    };
    let sizes: Vec<f64> = blocks.iter().zip(places).map(size).collect();
    let cap: f64 = blocks.iter().zip(places).map(|(block, place)| z[place.row + block.layout.load_rows() + 1]).sum();
    let largest = sizes.iter().copied().fold(cap, f64::max);
    (0..sizes.len()).filter(|&variation| sizes[variation] >= NAMED_SHARE * largest && cap < largest).collect()
}

/// Where a variation's copy of the program starts.
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
    /// `answers` are the welded hold's, of each variation and hand.
    fn new(blocks: &[Program], answers: &[Vec<Wrench>]) -> Self {
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
        let ties = 6 * (answers[0].len() - 1);
        let tie_rows = ties * (blocks.len() - 1);
        cones.push(SupportedConeT::ZeroConeT(tie_rows));
        b.resize(rows + tie_rows, 0.0);
        let mut columns = Columns::default();
        for number in 0..blocks.len() {
            push_forces(&mut columns, blocks, &places, number, rows);
        }
        push_load_factor(&mut columns, blocks, &places, answers, rows);
        let mut q = vec![0.0; variables + 1];
        q[variables] = -1.0 / blocks[0].load_scale;
        Self { q, a: columns.into_matrix(rows + tie_rows), b, cones, places }
    }
}

/// The columns of one variation's forces. The wrenches of all hands but the first also stand in the ties, the first
/// variation's in those of every other.
fn push_forces(columns: &mut Columns, blocks: &[Program], places: &[Place], number: usize, first_tie: usize) {
    let block = &blocks[number];
    let ties = 6 * (block.layout.hands().len() - 1);
    for column in 0..block.q.len() - 1 {
        columns.begin();
        for entry in block.a.colptr[column]..block.a.colptr[column + 1] {
            columns.push(places[number].row + block.a.rowval[entry], block.a.nzval[entry]);
        }
        let of_hand = block.layout.hands()[1..]
            .iter()
            .position(|hand| (hand.wrench_variables..hand.wrench_variables + 6).contains(&column));
        let Some(hand) = of_hand else { continue };
        let tie = first_tie + 6 * hand + column - block.layout.hands()[hand + 1].wrench_variables;
        match number {
            0 => (1..blocks.len()).for_each(|other| columns.push(tie + ties * (other - 1), -1.0)),
            _ => columns.push(tie + ties * (number - 1), 1.0),
        }
    }
}

/// The load factor's column: each variation's own, in the unit of the first's, and what the ties ask for.
fn push_load_factor(
    columns: &mut Columns,
    blocks: &[Program],
    places: &[Place],
    answers: &[Vec<Wrench>],
    first_tie: usize,
) {
    let unit = blocks[0].load_scale;
    columns.begin();
    for (block, place) in blocks.iter().zip(places) {
        let last = block.q.len() - 1;
        for entry in block.a.colptr[last]..block.a.colptr[last + 1] {
            columns.push(place.row + block.a.rowval[entry], block.a.nzval[entry] * block.load_scale / unit);
        }
    }
    let mut row = first_tie;
    for answer in &answers[1..] {
        for (of_this, of_first) in answer.iter().zip(&answers[0]).skip(1) {
            let difference = (of_this.to_vector() - of_first.to_vector()).component_div(&wrench_units());
            difference.iter().enumerate().for_each(|(component, value)| columns.push(row + component, -value / unit));
            row += 6;
        }
    }
}
