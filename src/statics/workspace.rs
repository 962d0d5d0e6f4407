//! Solvers that are kept between holds.

use super::{
    compliance::WeldedHold,
    compliant_load::{self, CompliantLoadFactor},
    elastic,
    equilibrium::{self, CompliantResponse, EquilibriumOutcome, ResponseOutcome, hand_energy},
    hold::{Hold, HoldError},
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
    pub fn load_factor(&mut self, hold: &Hold) -> Result<LoadFactorOutcome, HoldError> {
        hold.check()?;
        Ok(solve_load(&mut self.load, hold, ProgramKind::Load))
    }

    /// The load factor without torque limits: up to there a compliant equilibrium exists.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn friction_load_factor(&mut self, hold: &Hold) -> Result<LoadFactorOutcome, HoldError> {
        hold.check()?;
        Ok(solve_load(&mut self.friction, hold, ProgramKind::Friction))
    }

    /// The compliant equilibrium at a load factor. Torque limits are no part of it.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn equilibrium(&mut self, hold: &Hold, load_factor: f64) -> Result<EquilibriumOutcome, HoldError> {
        hold.check()?;
        Ok(self.solve_equilibrium(hold, &hand_energies(hold), load_factor))
    }

    /// What the load at a load factor does to the hold: the compliant equilibrium against that under the weight alone.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn response(&mut self, hold: &Hold, load_factor: f64) -> Result<ResponseOutcome, HoldError> {
        hold.check()?;
        let welded = WeldedHold::new(hold);
        let mut energies = None;
        let mut equilibrium_at = |lambda: f64| {
            if let Some(found) = welded.as_ref().and_then(|welded| elastic::equilibrium(hold, welded, lambda)) {
                return EquilibriumOutcome::Found(found);
            }
            let energies = energies.get_or_insert_with(|| hand_energies(hold));
            self.solve_equilibrium(hold, energies, lambda)
        };
        let mut equilibria = Vec::with_capacity(2);
        for lambda in [0.0, load_factor] {
            match equilibrium_at(lambda) {
                EquilibriumOutcome::Found(found) => equilibria.push(found),
                EquilibriumOutcome::None => return Ok(ResponseOutcome::NoEquilibrium { load_factor: lambda }),
                EquilibriumOutcome::Unknown { status } => return Ok(ResponseOutcome::Unknown { status }),
            }
        }
        let loaded = equilibria.remove(1);
        Ok(ResponseOutcome::Found(CompliantResponse::between(hold, &equilibria[0], loaded)))
    }

    /// The compliant load factor (METHOD section 6): the smallest load factor at which no compliant equilibrium exists
    /// or a limit of torque ratio, deflection or slip is crossed, at most 100; found to a thousandth, from below.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn compliant_load_factor(&mut self, hold: &Hold, limits: &Limits) -> Result<CompliantLoadFactor, HoldError> {
        hold.check()?;
        Ok(compliant_load::search(self, hold, limits))
    }

    /// The load factor that stands every one of several variations of load and friction; see [`RobustOutcome`].
    ///
    /// # Errors
    /// When the hold or a variation is broken, or there is none.
    pub fn robust_load_factor(
        &mut self,
        hold: &Hold,
        variations: &[Variation],
        internal_forces: InternalForces,
    ) -> Result<RobustOutcome, HoldError> {
        robust::solve(self, hold, variations, internal_forces)
    }

    pub(super) fn solve_equilibrium(
        &mut self,
        hold: &Hold,
        energies: &[HandEnergy],
        load_factor: f64,
    ) -> EquilibriumOutcome {
        if let Some(found) = InteriorPoint::solve(hold, energies, load_factor) {
            return EquilibriumOutcome::Found(found.equilibrium(hold, load_factor));
        }
        let program = Program::equilibrium(hold, energies, load_factor);
        match self.equilibrium.solve(&program) {
            Some(raw) => equilibrium::interpret(hold, &program.layout, load_factor, &raw),
            None => EquilibriumOutcome::Unknown { status: "data refused".into() },
        }
    }

    pub(super) fn solve_friction(&mut self, hold: &Hold) -> LoadFactorOutcome {
        solve_load(&mut self.friction, hold, ProgramKind::Friction)
    }
}

fn solve_load(solver: &mut ReusedSolver, hold: &Hold, kind: ProgramKind) -> LoadFactorOutcome {
    let program = Program::load(hold, kind);
    match solver.solve(&program) {
        Some(raw) => load_factor::interpret(hold, &program, &raw),
        None => LoadFactorOutcome::Unknown { status: "data refused".into() },
    }
}

/// The energy of each hand.
pub(super) fn hand_energies(hold: &Hold) -> Vec<HandEnergy> {
    hold.hands.iter().map(hand_energy).collect()
}
