//! Solvers that are kept between contact models.

use super::{
    contact_model::{ContactModel, ContactModelError},
    elastic,
    equilibrium::{self, CompliantResponse, Equilibrium, EquilibriumOutcome, ResponseOutcome},
    load_factor::{self, LoadFactorOutcome},
    solvers::{
        clarabel::ReusedSolver, cone_program::ConeProgram, energy::HandEnergy, interior_point::InteriorPoint,
        layout::ProgramKind,
    },
    welded::WeldedStiffness,
};

/// The solvers of one thread, for many contact models. Models with the same numbers of hands and joints share memory
/// and symbolic factorisation; results do not depend on earlier calls, bit for bit.
#[derive(Default)]
pub struct StabilityWorkspace {
    load: ReusedSolver,
    friction: ReusedSolver,
    equilibrium: ReusedSolver,
}

/// A solver of the equilibrium program. Both find the same equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EquilibriumSolver {
    /// Dense and of fixed size, the faster one. Cannot prove that there is no equilibrium: its outcome is then
    /// [`EquilibriumOutcome::Unknown`].
    InteriorPoint,
    /// Sparse, with a proof if there is no equilibrium.
    Clarabel,
}

impl StabilityWorkspace {
    /// A new workspace.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The load factor lambda* (docs/method.md#65-load-factor): the largest multiple of the load, from 0 to 100, that
    /// some distribution of forces balances within friction, centre of pressure, grip and torque limits.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn load_factor(&mut self, model: &ContactModel) -> Result<LoadFactorOutcome, ContactModelError> {
        model.check()?;
        Ok(solve_load(&mut self.load, model, ProgramKind::Load))
    }

    /// The load factor without torque limits: a compliant equilibrium exists up to there.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn friction_load_factor(&mut self, model: &ContactModel) -> Result<LoadFactorOutcome, ContactModelError> {
        model.check()?;
        Ok(self.solve_friction(model))
    }

    /// The compliant equilibrium at a load factor by one of the two solvers. Torque limits are not part of it.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn equilibrium(
        &mut self,
        model: &ContactModel,
        load_factor: f64,
        solver: EquilibriumSolver,
    ) -> Result<EquilibriumOutcome, ContactModelError> {
        model.check()?;
        let energies = HandEnergy::of_hands(model);
        Ok(match solver {
            EquilibriumSolver::InteriorPoint => by_interior_point(model, &energies, load_factor).map_or_else(
                || EquilibriumOutcome::Unknown { status: "not converged".into() },
                EquilibriumOutcome::Found,
            ),
            EquilibriumSolver::Clarabel => self.by_clarabel(model, &energies, load_factor),
        })
    }

    /// The effect of the load at a load factor: the compliant equilibrium relative to that under the weight alone.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn response(&mut self, model: &ContactModel, load_factor: f64) -> Result<ResponseOutcome, ContactModelError> {
        model.check()?;
        let welded = WeldedStiffness::new(model);
        let mut energies = None;
        let mut equilibrium_at = |lambda: f64| {
            if let Some(found) = welded.as_ref().and_then(|welded| elastic::equilibrium(model, welded, lambda)) {
                return EquilibriumOutcome::Found(found);
            }
            let energies = energies.get_or_insert_with(|| HandEnergy::of_hands(model));
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
        Ok(ResponseOutcome::Found(Box::new(CompliantResponse::between(model, &equilibria[0], loaded))))
    }

    /// The equilibrium by the interior point, or by clarabel if that does not converge.
    pub(super) fn solve_equilibrium(
        &mut self,
        model: &ContactModel,
        energies: &[HandEnergy],
        load_factor: f64,
    ) -> EquilibriumOutcome {
        by_interior_point(model, energies, load_factor)
            .map_or_else(|| self.by_clarabel(model, energies, load_factor), EquilibriumOutcome::Found)
    }

    fn by_clarabel(&mut self, model: &ContactModel, energies: &[HandEnergy], load_factor: f64) -> EquilibriumOutcome {
        let program = ConeProgram::equilibrium(model, energies, load_factor);
        match self.equilibrium.solve(&program) {
            Some(raw) => equilibrium::interpret(model, &program, load_factor, &raw),
            None => EquilibriumOutcome::Unknown { status: "data refused".into() },
        }
    }

    pub(super) fn solve_friction(&mut self, model: &ContactModel) -> LoadFactorOutcome {
        solve_load(&mut self.friction, model, ProgramKind::Friction)
    }
}

fn by_interior_point(model: &ContactModel, energies: &[HandEnergy], load_factor: f64) -> Option<Equilibrium> {
    let found = InteriorPoint::solve(model, energies, load_factor)?.solution(model);
    Some(Equilibrium::of_hands(model, load_factor, found.hand_wrenches, found.board))
}

fn solve_load(solver: &mut ReusedSolver, model: &ContactModel, kind: ProgramKind) -> LoadFactorOutcome {
    let program = ConeProgram::load(model, kind);
    match solver.solve(&program) {
        Some(raw) => load_factor::interpret(model, &program, &raw),
        None => LoadFactorOutcome::Unknown { status: "data refused".into() },
    }
}
