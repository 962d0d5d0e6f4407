//! The quadratic program of a refinement step: our dual active-set method beside clarabel, on the same random programs of the
//! planner's size. Before anything is measured, both must find the same optimum.

use std::hint::black_box;

use benchdog::planner::qp::{LinearConstraint, solve};
use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, SupportedConeT},
};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Variables and constraints of a step with two arms of seven joints.
const VARIABLES: usize = 19;
const CONSTRAINTS: usize = 100;
/// Half the side of the trust region.
const RADIUS: f64 = 1.0;

struct Program {
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
    constraints: Vec<LinearConstraint>,
}

fn programs(count: usize) -> Vec<Program> {
    let mut random = Pcg64::seed_from_u64(1);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    let program = |_| {
        let root = DMatrix::from_fn(VARIABLES, VARIABLES, |_, _| draw(-1.0, 1.0));
        let constraint = |margin: f64, gradient: DVector<f64>| LinearConstraint { gradient, margin };
        let hessian = &root * root.transpose() + DMatrix::identity(VARIABLES, VARIABLES) * 0.1;
        let gradient = DVector::from_fn(VARIABLES, |_, _| draw(-5.0, 5.0));
        let constraints = (0..CONSTRAINTS)
            .map(|_| constraint(draw(0.0, 0.5), DVector::from_fn(VARIABLES, |_, _| draw(-1.0, 1.0))))
            .collect();
        Program { gradient, hessian, constraints }
    };
    (0..count).map(program).collect()
}

/// The same program by clarabel: minimise `1/2 d' H d - g . d` within `A d <= b`.
fn by_clarabel(program: &Program) -> DVector<f64> {
    let mut upper = Vec::new();
    for column in 0..VARIABLES {
        for row in 0..=column {
            upper.push((row, column, program.hessian[(row, column)]));
        }
    }
    let hessian = sparse(VARIABLES, VARIABLES, &upper);
    let mut entries = Vec::new();
    let mut bounds = Vec::new();
    for (row, constraint) in program.constraints.iter().enumerate() {
        bounds.push(constraint.margin);
        entries.extend((0..VARIABLES).map(|column| (row, column, -constraint.gradient[column])));
    }
    for (variable, sign) in (0..VARIABLES).flat_map(|variable| [(variable, 1.0), (variable, -1.0)]) {
        entries.push((bounds.len(), variable, sign));
        bounds.push(RADIUS);
    }
    let matrix = sparse(bounds.len(), VARIABLES, &entries);
    let cones = [SupportedConeT::NonnegativeConeT(bounds.len())];
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let linear: Vec<f64> = program.gradient.iter().map(|g| -g).collect();
    let mut solver =
        DefaultSolver::new(&hessian, &linear, &matrix, &bounds, &cones, settings).expect("a valid program");
    solver.solve();
    DVector::from_column_slice(&solver.solution.x)
}

fn sparse(rows: usize, columns: usize, entries: &[(usize, usize, f64)]) -> CscMatrix<f64> {
    let (mut i, mut j, mut v) = (Vec::new(), Vec::new(), Vec::new());
    for &(row, column, value) in entries {
        i.push(row);
        j.push(column);
        v.push(value);
    }
    CscMatrix::new_from_triplets(rows, columns, i, j, v)
}

fn qp(criterion: &mut Criterion) {
    let programs = programs(20);
    for program in &programs {
        let ours = solve(&program.gradient, &program.hessian, &program.constraints, RADIUS).expect("d = 0 is feasible");
        // clarabel stops at a duality gap of 1e-8.
        assert!((ours - by_clarabel(program)).norm() < 1e-4);
    }
    criterion.bench_function("20 programs/active set", |bencher| {
        bencher.iter(|| {
            for Program { gradient, hessian, constraints } in &programs {
                black_box(solve(black_box(gradient), hessian, constraints, RADIUS));
            }
        });
    });
    criterion.bench_function("20 programs/clarabel", |bencher| {
        bencher.iter(|| programs.iter().for_each(|program| drop(black_box(by_clarabel(black_box(program))))));
    });
}

criterion_group!(benches, qp);
criterion_main!(benches);
