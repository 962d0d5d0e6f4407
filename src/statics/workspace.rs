//! Solvers that are kept between holds.

use super::{
    compliance::WeldedStiffness,
    compliant_load::{self, CompliantLoadFactor},
    contact_model::{ContactModel, ContactModelError},
    elastic,
    equilibrium::{self, CompliantResponse, EquilibriumOutcome, ResponseOutcome, hand_energy},
    interior_point::InteriorPoint,
    load_factor::{self, LoadFactorOutcome},
    program::{HandEnergy, Program, ProgramKind, ReusedSolver},
    robust::{self, InternalForces, RobustOutcome, Variation},
};
use crate::model::scenario::Limits;

/// The solvers of a thread that asks about many holds. Holds with the same numbers of hands and joints share memory and
/// symbolic factorisation; the answer for a hold does not depend on what was asked before, bit by bit.
#[derive(Default)]
pub struct StabilityWorkspace {
    load: ReusedSolver,
    friction: ReusedSolver,
    equilibrium: ReusedSolver,
}

impl StabilityWorkspace {
    /// A workspace that knows no hold yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The load factor lambda* (METHOD section 6): the largest multiple of the load, from 0 to 100, that some
    /// distribution of forces holds within friction, centre of pressure, grip and torque limits.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn load_factor(&mut self, model: &ContactModel) -> Result<LoadFactorOutcome, ContactModelError> {
        model.check()?;
        Ok(solve_load(&mut self.load, model, ProgramKind::Load))
    }

    /// The load factor without torque limits: up to there a compliant equilibrium exists.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn friction_load_factor(&mut self, model: &ContactModel) -> Result<LoadFactorOutcome, ContactModelError> {
        model.check()?;
        Ok(solve_load(&mut self.friction, model, ProgramKind::Friction))
    }

    /// The compliant equilibrium at a load factor. Torque limits are no part of it.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn equilibrium(
        &mut self,
        model: &ContactModel,
        load_factor: f64,
    ) -> Result<EquilibriumOutcome, ContactModelError> {
        model.check()?;
        Ok(self.solve_equilibrium(model, &hand_energies(model), load_factor))
    }

    /// What the load at a load factor does to the hold: the compliant equilibrium against that under the weight alone.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn response(&mut self, model: &ContactModel, load_factor: f64) -> Result<ResponseOutcome, ContactModelError> {
        model.check()?;
        let welded = WeldedStiffness::new(model);
        let mut energies = None;
        let mut equilibrium_at = |lambda: f64| {
            if let Some(found) = welded.as_ref().and_then(|welded| elastic::equilibrium(model, welded, lambda)) {
                return EquilibriumOutcome::Found(found);
            }
            let energies = energies.get_or_insert_with(|| hand_energies(model));
            self.solve_equilibrium(model, energies, lambda)
        };
        let mut equilibria = Vec::with_capacity(2);
        for lambda in [0.0, load_factor] {
            match equilibrium_at(lambda) {
                EquilibriumOutcome::Found(found) => equilibria.push(found),
                EquilibriumOutcome::NoEquilibrium => return Ok(ResponseOutcome::NoEquilibrium { load_factor: lambda }),
                EquilibriumOutcome::Unknown { status } => return Ok(ResponseOutcome::Unknown { status }),
            }
        }
        let loaded = equilibria.remove(1);
        Ok(ResponseOutcome::Found(CompliantResponse::between(model, &equilibria[0], loaded)))
    }

    /// The compliant load factor (METHOD section 6): the smallest load factor at which no compliant equilibrium exists
    /// or a limit of torque ratio, deflection or slip is crossed, at most 100; found to a thousandth, from below.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn compliant_load_factor(
        &mut self,
        model: &ContactModel,
        limits: &Limits,
    ) -> Result<CompliantLoadFactor, ContactModelError> {
        model.check()?;
        Ok(compliant_load::search(self, model, limits))
    }

    /// The load factor that stands every one of several variations of load and friction; see [`RobustOutcome`].
    ///
    /// # Errors
    /// When the hold or a variation is broken, or there is none.
    pub fn robust_load_factor(
        &mut self,
        model: &ContactModel,
        variations: &[Variation],
        internal_forces: InternalForces,
    ) -> Result<RobustOutcome, ContactModelError> {
        robust::solve(self, model, variations, internal_forces)
    }

    pub(super) fn solve_equilibrium(
        &mut self,
        model: &ContactModel,
        energies: &[HandEnergy],
        load_factor: f64,
    ) -> EquilibriumOutcome {
        if let Some(found) = InteriorPoint::solve(model, energies, load_factor) {
            return EquilibriumOutcome::Found(found.equilibrium(model, load_factor));
        }
        let program = Program::equilibrium(model, energies, load_factor);
        match self.equilibrium.solve(&program) {
            Some(raw) => equilibrium::interpret(model, &program.layout, load_factor, &raw),
            None => EquilibriumOutcome::Unknown { status: "data refused".into() },
        }
    }

    pub(super) fn solve_friction(&mut self, model: &ContactModel) -> LoadFactorOutcome {
        solve_load(&mut self.friction, model, ProgramKind::Friction)
    }
}

fn solve_load(solver: &mut ReusedSolver, model: &ContactModel, kind: ProgramKind) -> LoadFactorOutcome {
    let program = Program::load(model, kind);
    match solver.solve(&program) {
        Some(raw) => load_factor::interpret(model, &program, &raw),
        None => LoadFactorOutcome::Unknown { status: "data refused".into() },
    }
}

/// The energy of each hand.
pub(super) fn hand_energies(model: &ContactModel) -> Vec<HandEnergy> {
    model.hands.iter().map(hand_energy).collect()
}
