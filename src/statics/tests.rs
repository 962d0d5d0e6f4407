//! The interior point against clarabel on the ten grasps of `tests/data/holds`.

use std::{f64::consts::PI, path::Path};

use clarabel::solver::SolverStatus;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6xX, UnitQuaternion, Vector3};

use super::{
    contact_model::ContactModel,
    equilibrium::{self, Equilibrium, EquilibriumOutcome, ResponseOutcome},
    hand::HandModel,
    hold::{Hold, PadPair},
    lateral::LoadCases,
    load_factor::{self, LoadFactorOutcome},
    pad_model::PadModel,
    solvers::{
        clarabel::{RawSolution, ReusedSolver},
        cone_program::ConeProgram,
        energy::HandEnergy,
        interior_point::{InteriorPoint, NotFound, Solution},
        layout::ProgramKind,
    },
    twist::Twist,
    workspace::StabilityWorkspace,
};
use crate::{
    check::CheckedPlan,
    human::default_tool,
    model::{load::Load, scenario::Person, uncertainty::Uncertainty, wrench::Wrench},
    robot::Holding,
    scenario::read_plan,
};

/// Friction of pad and board, docs/method.md#76-robot-figures.
pub(super) const FRICTION: f64 = 0.6;

/// Grip force, half sides of the pads and their distance from the grasp point in [`pinch`].
pub(super) const GRIP_N: f64 = 30.0;
pub(super) const HALF_SIDES_M: [f64; 2] = [0.02, 0.018];
pub(super) const LEVER_M: f64 = 0.015;

/// One hand at O whose pads press along z, under a force at O. Its arm moves along and about each axis and has torque limits that no
/// load reaches.
pub(super) fn pinch(force_n: Vector3<f64>) -> ContactModel {
    let pad = |name: &str, side: f64| PadModel {
        name: name.into(),
        x_op: Isometry3::new(Vector3::z() * (side * LEVER_M), Vector3::x() * (PI * f64::from(u8::from(side > 0.0)))),
        half_sides_m: HALF_SIDES_M,
        friction: FRICTION,
        stiffness_n_m: None,
    };
    let hand = HandModel {
        name: "left".into(),
        joints: (0..6).map(|joint| format!("left_{joint}")).collect(),
        hold: Hold::Pads(PadPair { pads: [pad("upper", 1.0), pad("lower", -1.0)], grip_force_n: GRIP_N }),
        grasp_point_o: Vector3::zeros(),
        jacobian_o: Matrix6xX::identity(6),
        gravity_torque_nm: DVector::zeros(6),
        effort_nm: DVector::from_element(6, 1e4),
        stiffness_nm_rad: DVector::from_element(6, 1e3),
        gravity_stiffness_nm_rad: DMatrix::zeros(6, 6),
        offset: Twist::default(),
    };
    ContactModel {
        hands: vec![hand],
        weight: Wrench::default(),
        load: Wrench::from_force(force_n),
        p_ot: Vector3::zeros(),
    }
}

/// An inaccurate solution counts with a margin, an unproven one not at all.
#[test]
fn the_status_of_the_solver_decides_what_a_solution_is_worth() {
    let model = pinch(Vector3::x());
    let program = ConeProgram::load(&model, ProgramKind::Load);
    let mut solver = ReusedSolver::default();
    let RawSolution { x, z, s, status } = solver.solve(&program).unwrap();
    assert_eq!(status, SolverStatus::Solved);
    let with = |status| load_factor::interpret(&model, &program, &RawSolution { x, z, s, status });
    let solved = with(SolverStatus::Solved).load_factor().unwrap();
    // `2 mu F` of a newton.
    assert!((solved / (2.0 * FRICTION * GRIP_N) - 1.0).abs() < 1e-5, "{solved}");
    assert!((solved - with(SolverStatus::AlmostSolved).load_factor().unwrap() - 1e-3).abs() < 1e-12);
    // The vector of a feasible program proves nothing.
    for status in [SolverStatus::PrimalInfeasible, SolverStatus::MaxIterations, SolverStatus::NumericalError] {
        let expected = LoadFactorOutcome::Unknown { status: format!("{status:?}") };
        assert_eq!(with(status), expected);
    }
}

/// Each deviation scales what it names, and nothing else.
#[test]
fn a_contact_model_of_a_deviating_world_is_scaled() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/cut-rim.json");
    let (plan, mut robot) = read_plan(&path, None).unwrap();
    for arm in &mut robot.arms {
        let Holding::Pads(pads) = &mut arm.gripper.holding else { panic!("{} has no pads", arm.name) };
        pads.pad_stiffness_n_m = Some(2e4);
    }
    let checked = CheckedPlan::new(&robot, &plan, &Person::default(), &default_tool(plan.operation.kind)).unwrap();
    let planned = ContactModel::of_plan(&checked, FRICTION).unwrap();
    let of = Uncertainty {
        friction_scale: 0.5,
        friction_scales: vec![1.0, 0.25],
        grip_force_scale: 2.0,
        joint_stiffness_scale: 0.75,
        contact_stiffness_scale: 1.25,
        joint_offset_deg: vec![vec![0.1, -0.2, 0.3, 0.0, 0.1, -0.1, 0.2]],
        force_scale: 1.5,
        ..Uncertainty::default()
    };
    let mut expected = planned.clone();
    expected.load = planned.load.scaled(1.5);
    for (hand, friction) in expected.hands.iter_mut().zip([0.5, 0.125]) {
        for pad in hand.pads_mut() {
            pad.friction *= friction;
            pad.stiffness_n_m = pad.stiffness_n_m.map(|stiffness_n_m| 1.25 * stiffness_n_m);
        }
        hand.scale_grip(2.0);
        hand.stiffness_nm_rad *= 0.75;
    }
    // Of the first arm alone, `t = J (K_q + dg/dq)^-1 K_q d`.
    let hand = &mut expected.hands[0];
    let offsets_rad = DVector::from_iterator(7, of.joint_offset_deg[0].iter().map(|deg: &f64| deg.to_radians()));
    let stiffness = DMatrix::from_diagonal(&hand.stiffness_nm_rad);
    let yielded = (&stiffness + &hand.gravity_stiffness_nm_rad).lu().solve(&(stiffness * offsets_rad)).unwrap();
    let offset = &hand.jacobian_o * yielded;
    let found = ContactModel::under(&checked, FRICTION, &of).unwrap();
    assert!((found.hands[0].offset.to_vector() - offset).norm() < 1e-12 * offset.norm(), "{offset}");
    hand.offset = found.hands[0].offset;
    assert!(expected.hands.iter().all(|hand| hand.pads().iter().all(|pad| pad.stiffness_n_m == Some(2.5e4))));
    assert_eq!(found, expected);
    // The push of the person is a share of the force.
    let push_n = |of: &Uncertainty| {
        let load = Load { lateral_share: 0.2, ..Load::default() };
        LoadCases::under(&checked, FRICTION, &load, of).unwrap().push(0).unwrap().force_o_n
    };
    let (planned_n, scaled_n) = (push_n(&Uncertainty::default()), push_n(&of));
    assert!(planned_n.iter().zip(scaled_n).all(|(planned, scaled)| (1.5 * planned - scaled).abs() < 1e-12));
}

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
            (apart(&guess, &exact, &model), apart(&exact, &equilibrium(&model, 1.0, point.solution(&model)), &model))
        };
        let ((error_m, error_nm), (moved_m, moved_nm)) = error(0.01);
        // The error is of second order, here a hundredth of the motion; a pad that reaches or leaves its limit between
        // the two models causes a few times that.
        assert!(error_m < 0.05 * moved_m + 1e-9, "{error_m:e} m of {moved_m:e} m");
        assert!(error_nm < 0.05 * moved_nm + 1e-6, "{error_nm:e} N m of {moved_nm:e} N m");
    }
}
