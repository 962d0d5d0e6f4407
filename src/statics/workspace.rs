//! Solvers that are kept between contact models.

use std::collections::VecDeque;

use super::{
    contact_model::{ContactModel, ContactModelError},
    elastic,
    equilibrium::{self, CompliantResponse, Equilibrium, EquilibriumOutcome, ResponseOutcome},
    load_factor::{self, LoadFactorOutcome},
    solvers::{
        clarabel::ReusedSolver,
        cone_program::ConeProgram,
        energy::HandEnergy,
        interior_point::{InteriorPoint, NotFound},
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
    recent: RecentPoints,
}

/// The last equilibria by the interior point, the newest first: a planner that has assessed a grasp asks for the derivatives of
/// its response soon. An equilibrium that is taken from here is that of a new solve, bit for bit.
#[derive(Default)]
struct RecentPoints(VecDeque<RecentPoint>);

struct RecentPoint {
    model: ContactModel,
    load_factor: f64,
    point: InteriorPoint,
}

/// Two of each of a few grasps, with and without the load.
const RECENT_POINTS: usize = 8;

impl RecentPoints {
    /// The equilibrium of a contact model, as [`InteriorPoint::solve`] finds it.
    fn solve(
        &mut self,
        model: &ContactModel,
        energies: &[HandEnergy],
        load_factor: f64,
    ) -> Result<&InteriorPoint, NotFound> {
        let is_same = |recent: &RecentPoint| recent.load_factor == load_factor && recent.model == *model;
        let number = match self.0.iter().position(is_same) {
            Some(number) => number,
            None => {
                let point = InteriorPoint::solve(model, energies, load_factor)?;
                self.0.truncate(RECENT_POINTS - 1);
                self.0.push_front(RecentPoint { model: model.clone(), load_factor, point });
                0
            }
        };
        Ok(&self.0[number].point)
    }
}

/// What of a grasp's responses does not depend on the load: it is computed for the first of its loads and serves for all.
pub struct AtRest {
    welded: Option<WeldedStiffness>,
    /// Computed where the closed form does not do.
    energies: Option<Vec<HandEnergy>>,
    /// The equilibrium under the weight alone, once it is found.
    unloaded: Option<Equilibrium>,
}

/// A solver of the equilibrium program. Both find the same equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EquilibriumSolver {
    /// Dense and of fixed size, the faster one. It does not prove in all cases that there is no equilibrium: its outcome may then
    /// be [`EquilibriumOutcome::Unknown`].
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
            EquilibriumSolver::InteriorPoint => match InteriorPoint::solve(model, &energies, load_factor) {
                Ok(point) => EquilibriumOutcome::Found(of_point(model, load_factor, &point)),
                Err(NotFound::NoEquilibrium) => EquilibriumOutcome::NoEquilibrium,
                Err(NotFound::Unknown) => EquilibriumOutcome::Unknown { status: "not converged".into() },
            },
            EquilibriumSolver::Clarabel => self.by_clarabel(model, &energies, load_factor),
        })
    }

    /// The effect of the load at a load factor: the compliant equilibrium relative to that under the weight alone.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn response(&mut self, model: &ContactModel, load_factor: f64) -> Result<ResponseOutcome, ContactModelError> {
        self.response_from(model, load_factor, &mut None)
    }

    /// As [`StabilityWorkspace::response`], with what does not depend on the load; it is filled in if it is `None`.
    pub(super) fn response_from(
        &mut self,
        model: &ContactModel,
        load_factor: f64,
        at_rest: &mut Option<AtRest>,
    ) -> Result<ResponseOutcome, ContactModelError> {
        model.check()?;
        let AtRest { welded, energies, unloaded } = at_rest.get_or_insert_with(|| AtRest {
            welded: WeldedStiffness::new(model),
            energies: None,
            unloaded: None,
        });
        let mut equilibrium_at = |lambda: f64| {
            if let Some(found) = welded.as_ref().and_then(|welded| elastic::equilibrium(model, welded, lambda)) {
                return Ok(found);
            }
            let energies = energies.get_or_insert_with(|| HandEnergy::of_hands(model));
            match self.solve_equilibrium(model, energies, lambda) {
                EquilibriumOutcome::Found(found) => Ok(found),
                EquilibriumOutcome::NoEquilibrium => Err(ResponseOutcome::NoEquilibrium { load_factor: lambda }),
                EquilibriumOutcome::Unknown { status } => Err(ResponseOutcome::Unknown { status }),
            }
        };
        let found = unloaded.take().map_or_else(|| equilibrium_at(0.0), Ok);
        let loaded = found.and_then(|found| {
            let unloaded = unloaded.insert(found);
            equilibrium_at(load_factor).map(|loaded| CompliantResponse::between(model, unloaded, loaded))
        });
        Ok(loaded.map_or_else(|failed| failed, |response| ResponseOutcome::Found(Box::new(response))))
    }

    /// The equilibrium by the interior point, or by clarabel if that does not converge.
    pub(super) fn solve_equilibrium(
        &mut self,
        model: &ContactModel,
        energies: &[HandEnergy],
        load_factor: f64,
    ) -> EquilibriumOutcome {
        match self.recent.solve(model, energies, load_factor) {
            Ok(point) => EquilibriumOutcome::Found(of_point(model, load_factor, point)),
            Err(NotFound::NoEquilibrium) => EquilibriumOutcome::NoEquilibrium,
            Err(NotFound::Unknown) => self.by_clarabel(model, energies, load_factor),
        }
    }

    /// The converged equilibrium with its factorised system; `None` without convergence.
    pub(super) fn interior_point(
        &mut self,
        model: &ContactModel,
        energies: &[HandEnergy],
        load_factor: f64,
    ) -> Option<InteriorPoint> {
        self.recent.solve(model, energies, load_factor).ok().cloned()
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

fn of_point(model: &ContactModel, load_factor: f64, point: &InteriorPoint) -> Equilibrium {
    let found = point.solution(model);
    Equilibrium::of_hands(model, load_factor, found.hand_wrenches, found.board)
}

fn solve_load(solver: &mut ReusedSolver, model: &ContactModel, kind: ProgramKind) -> LoadFactorOutcome {
    let program = ConeProgram::load(model, kind);
    match solver.solve(&program) {
        Some(raw) => load_factor::interpret(model, &program, &raw),
        None => LoadFactorOutcome::Unknown { status: "data refused".into() },
    }
}
