//! The interior point against clarabel on the ten grasps of `tests/data/holds`.

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    contact_model::ContactModel,
    equilibrium::{self, Equilibrium, EquilibriumOutcome, ResponseOutcome},
    solvers::{
        clarabel::ReusedSolver,
        cone_program::ConeProgram,
        energy::HandEnergy,
        interior_point::{InteriorPoint, NotFound, Solution},
    },
    workspace::StabilityWorkspace,
};
use crate::{
    check::CheckedPlan,
    human::default_tool,
    model::{scenario::Person, wrench::Wrench},
    scenario::read_plan,
};

/// Friction of pad and board, docs/method.md#76-robot-figures.
const FRICTION: f64 = 0.6;

/// The contact models of `tests/data/holds`.
fn models() -> Vec<ContactModel> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/holds");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let (_, robot) = read_plan(&paths[0], None).unwrap();
    let model = |path: &std::path::PathBuf| {
        let (plan, _) = read_plan(path, Some(&robot)).unwrap();
        let checked = CheckedPlan::new(&robot, &plan, &Person::default(), &default_tool(plan.operation.kind)).unwrap();
        ContactModel::of_plan(&checked, FRICTION).unwrap()
    };
    paths.iter().map(model).collect()
}

/// The equilibrium by clarabel.
fn by_program(model: &ContactModel, load_factor: f64) -> EquilibriumOutcome {
    let program = ConeProgram::equilibrium(model, &HandEnergy::of_hands(model), load_factor);
    let mut solver = ReusedSolver::default();
    equilibrium::interpret(model, &program, load_factor, &solver.solve(&program).unwrap())
}

fn equilibrium(model: &ContactModel, load_factor: f64, found: Solution) -> Equilibrium {
    Equilibrium::of_hands(model, load_factor, found.hand_wrenches, found.board)
}

/// Differences of two equilibria: displacement of the tool tip, m, and largest joint torque, N m.
fn apart(one: &Equilibrium, other: &Equilibrium, model: &ContactModel) -> (f64, f64) {
    let tip = |found: &Equilibrium| found.board.at(&model.p_ot).linear;
    let torque = one.joint_torque_nm.iter().zip(&other.joint_torque_nm).map(|(one, other)| (one - other).amax());
    ((tip(one) - tip(other)).norm(), torque.fold(0.0, f64::max))
}

#[test]
fn the_interior_point_agrees_with_clarabel() {
    let mut found = 0;
    for model in models() {
        for load_factor in [0.0, 0.5, 1.0, 1.1] {
            let EquilibriumOutcome::Found(expected) = by_program(&model, load_factor) else { continue };
            let point = InteriorPoint::solve(&model, &HandEnergy::of_hands(&model), load_factor).unwrap();
            let (tip_m, torque_nm) =
                apart(&equilibrium(&model, load_factor, point.solution(&model)), &expected, &model);
            // Clarabel's tolerance is 1e-7 of a unit; along the flattest directions of the energy that is 1e-4 of it.
            assert!(tip_m < 1e-6 && torque_nm < 1e-3, "at {load_factor}: {tip_m:e} m, {torque_nm:e} N m");
            found += 1;
        }
    }
    assert!(found > 30, "{found}");
}

/// A workspace keeps its last equilibria: whatever it was asked for before, its answers are those of a new one.
#[test]
fn an_equilibrium_does_not_depend_on_earlier_ones() {
    let (models, mut kept) = (models(), StabilityWorkspace::new());
    for _ in 0..2 {
        for model in &models {
            let energies = HandEnergy::of_hands(model);
            for load_factor in [0.0, 1.0, 1.0, 0.0, 50.0] {
                let solve =
                    |workspace: &mut StabilityWorkspace| workspace.solve_equilibrium(model, &energies, load_factor);
                assert_eq!(solve(&mut kept), solve(&mut StabilityWorkspace::new()), "at {load_factor}");
            }
        }
    }
}

/// Where the interior point claims a proof, clarabel has one; and it proves most of what clarabel does.
/// Loads of one grasp share what does not depend on them, in any order, and each response is that of the load alone.
#[test]
fn responses_to_many_loads_are_those_to_each_alone() {
    let mut found = 0;
    for model in models() {
        let (mut shared, mut workspace) = (None, StabilityWorkspace::new());
        for (turn_rad, factor) in [(0.0, 1.0), (0.7, 0.5), (2.1, 1.0), (4.0, 3.0), (0.0, 0.2)] {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
            let load = Wrench::new(turn * model.load.force_n, turn * model.load.moment_nm).scaled(factor);
            let of_load = ContactModel { load, p_ot: turn * model.p_ot, ..model.clone() };
            let together = workspace.response_from(&of_load, 1.0, &mut shared).unwrap();
            let alone = StabilityWorkspace::new().response(&of_load, 1.0).unwrap();
            match (together, alone) {
                (ResponseOutcome::Found(together), ResponseOutcome::Found(alone)) => {
                    let (displacement_m, torque_nm) = apart(&together.equilibrium, &alone.equilibrium, &of_load);
                    let deflection_m = (together.deflection_m - alone.deflection_m).norm();
                    // Of the equilibrium under the weight alone the solver's last digits depend on the load that it leaves out.
                    assert!(displacement_m < 1e-12 && torque_nm < 1e-9 && deflection_m < 1e-12);
                    found += 1;
                }
                (together, alone) => assert_eq!(format!("{together:?}"), format!("{alone:?}")),
            }
        }
    }
    // Both outcomes occur.
    assert!((20..50).contains(&found), "{found}");
}

#[test]
fn the_interior_point_proves_that_there_is_no_equilibrium() {
    let (mut proven, mut infeasible) = (0, 0);
    for model in models() {
        for load_factor in [1.0, 1.2, 1.5, 1.8, 2.2, 3.0, 5.0, 50.0] {
            let found = InteriorPoint::solve(&model, &HandEnergy::of_hands(&model), load_factor);
            match by_program(&model, load_factor) {
                EquilibriumOutcome::NoEquilibrium => {
                    assert!(found.is_err(), "at {load_factor}");
                    infeasible += 1;
                    proven += usize::from(matches!(found, Err(NotFound::NoEquilibrium)));
                }
                outcome => assert!(!matches!(found, Err(NotFound::NoEquilibrium)), "at {load_factor}: {outcome:?}"),
            }
        }
    }
    assert!(infeasible > 30 && proven * 10 > infeasible * 9, "{proven} of {infeasible}");
}

#[test]
fn the_newton_step_to_another_model_is_exact_to_first_order() {
    // The tool's force a little larger and turned, one hand shifted.
    let moved = |model: &ContactModel, step: f64| {
        let mut moved = model.clone();
        moved.load.force_n += Vector3::new(0.4, -0.3, 0.5) * step;
        moved.load.moment_nm += Vector3::new(0.02, 0.05, -0.04) * step;
        moved.hands[0].grasp_point_o.x += 1e-3 * step;
        moved.hands[0].pads_mut().iter_mut().for_each(|pad| pad.x_op.translation.vector.x += 1e-3 * step);
        moved
    };
    for model in models() {
        let energies = HandEnergy::of_hands(&model);
        let point = InteriorPoint::solve(&model, &energies, 1.0).unwrap();
        let error = |step: f64| {
            let there = moved(&model, step);
            let energies = HandEnergy::of_hands(&there);
            let solved = |found: Solution| equilibrium(&there, 1.0, found);
            let exact = solved(InteriorPoint::solve(&there, &energies, 1.0).unwrap().solution(&there));
            let guess = solved(point.first_order(&there, &energies, 1.0).unwrap());
            let moved_m = apart(&exact, &equilibrium(&model, 1.0, point.solution(&model)), &model).0;
            (apart(&guess, &exact, &model).0, moved_m)
        };
        let (error_m, moved_m) = error(0.01);
        // The error is of second order, here a hundredth of the motion; a pad that reaches or leaves its limit between
        // the two models causes a few times that.
        assert!(error_m < 0.05 * moved_m + 1e-9, "{error_m:e} m of {moved_m:e} m");
    }
}
