//! Solves cone programs with clarabel.

use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT},
};

use super::{cone_program::ConeProgram, layout::Layout};

/// Tolerance of gap and feasibility in the scaled units: 1e-7 of a load factor, 1e-4 micrometres.
const SOLVER_TOLERANCE: f64 = 1e-7;

/// A clarabel solver that reuses memory, ordering and symbolic factorisation for programs of the same layout.
#[derive(Default)]
pub struct ReusedSolver {
    solver: Option<(Layout, DefaultSolver<f64>)>,
}

/// Clarabel's result: x, multipliers z and slacks s in the program's scaled rows.
pub struct RawSolution<'a> {
    pub status: SolverStatus,
    pub x: &'a [f64],
    pub z: &'a [f64],
    pub s: &'a [f64],
}

impl ReusedSolver {
    /// Solves a program; `None` if clarabel rejects its data, which happens only if a number is not finite.
    pub fn solve(&mut self, program: &ConeProgram) -> Option<RawSolution<'_>> {
        let ConeProgram { layout, p, q, a, b, .. } = program;
        let reusable = self
            .solver
            .as_mut()
            .is_some_and(|(known, solver)| known == layout && solver.update_data(p, q, a, b).is_ok());
        if !reusable {
            let solver = new_solver(p, q, a, b, &layout.cones())?;
            self.solver = Some((layout.clone(), solver));
        }
        let (_, solver) = self.solver.as_mut()?;
        solve_conclusively(solver)?;
        let solution = &solver.solution;
        Some(RawSolution { status: solution.status, x: &solution.x, z: &solution.z, s: &solution.s })
    }
}

/// A solver for a program; `None` if clarabel rejects the data.
pub fn new_solver(
    p: &CscMatrix<f64>,
    q: &[f64],
    a: &CscMatrix<f64>,
    b: &[f64],
    cones: &[SupportedConeT<f64>],
) -> Option<DefaultSolver<f64>> {
    DefaultSolver::new(p, q, a, b, cones, settings(false)).ok()
}

/// Solves, and solves again with iterative refinement if the first solve is inconclusive.
pub fn solve_conclusively(solver: &mut DefaultSolver<f64>) -> Option<()> {
    solver.solve();
    if !is_conclusive(solver.solution.status) {
        // These settings may change between solves, so neither call fails.
        solver.update_settings(settings(true)).ok()?;
        solver.solve();
        solver.update_settings(settings(false)).ok()?;
    }
    Some(())
}

fn is_conclusive(status: SolverStatus) -> bool {
    matches!(status, SolverStatus::Solved | SolverStatus::PrimalInfeasible)
}

/// Settings for small, well-scaled programs whose data change between solves. Iterative refinement takes a third of the
/// time and is rarely needed: clarabel checks its own residuals, so a solve without it either succeeds or is repeated
/// with refinement.
fn settings(refine: bool) -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        // Typical: 8 to 15.
        max_iter: 60,
        max_threads: 1,
        // Presolve prevents the reuse of a solver; equilibration would make results depend on earlier programs.
        presolve_enable: false,
        equilibrate_enable: false,
        iterative_refinement_enable: refine,
        tol_gap_abs: SOLVER_TOLERANCE,
        tol_gap_rel: SOLVER_TOLERANCE,
        tol_feas: SOLVER_TOLERANCE,
        ..DefaultSettings::default()
    }
}
