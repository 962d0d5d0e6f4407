//! The load factor by another method: a linear program in SI units with tangent planes of the friction cones, added
//! until no cone is violated (Kelley), solved by the simplex method. It shares only the contact model with the program
//! under test.

use benchdog::statics::{ContactModel, PadModel};
use microlp::{ComparisonOp, OptimizationDirection, Problem, Variable};
use nalgebra::{Matrix6, Vector3, Vector6};

use crate::fixtures::{HALF_SIDES_M, random_hold, solved, strong_hand};

/// A plane `normal . (ft1, ft2, mn / e) <= mu fn` of one pad.
type Cut = (usize, Vector3<f64>);

/// `[R 0; [p]x R R]`, p from `about` to the pad.
fn pad_wrench(pad: &PadModel, about: &Vector3<f64>) -> Matrix6<f64> {
    let rotation = pad.x_op.rotation.to_rotation_matrix();
    let lever = pad.x_op.translation.vector - about;
    let mut map = Matrix6::zeros();
    map.fixed_view_mut::<3, 3>(0, 0).copy_from(rotation.matrix());
    map.fixed_view_mut::<3, 3>(3, 0).copy_from(&(lever.cross_matrix() * rotation.matrix()));
    map.fixed_view_mut::<3, 3>(3, 3).copy_from(rotation.matrix());
    map
}

/// Removes rounding of coefficients that are zero by geometry, which disturbs the simplex method.
fn without_rounding(terms: impl IntoIterator<Item = (Variable, f64)>) -> Vec<(Variable, f64)> {
    terms.into_iter().filter(|(_, coefficient)| coefficient.abs() > 1e-9).collect()
}

/// The largest load factor within the planes so far, and its solution.
fn relaxed(hold: &ContactModel, cuts: &[Cut]) -> (f64, Vec<Vector6<f64>>) {
    let mut problem = Problem::new(OptimizationDirection::Maximize);
    let lambda = problem.add_var(1.0, (0.0, 100.0));
    let pads: Vec<&PadModel> = hold.hands.iter().flat_map(benchdog::statics::HandModel::pads).collect();
    let variables: Vec<[Variable; 6]> = (0..pads.len())
        .map(|pad| {
            let most = 2.0 * hold.hands[pad / 2].pad_pair().unwrap().grip_force_n;
            [most, most, most, 1.0, 1.0, 1.0].map(|bound| {
                // Bounds that the cones imply, so that the first program, without planes, is bounded.
                let least = if bound == most { -most } else { -bound * most };
                problem.add_var(0.0, (least, -least))
            })
        })
        .collect();
    let (load, weight) = (hold.load.to_vector(), hold.weight.to_vector());
    for row in 0..6 {
        let mut terms = vec![(lambda, load[row])];
        for (pad, variables) in pads.iter().zip(&variables) {
            let map = pad_wrench(pad, &Vector3::zeros());
            terms.extend((0..6).map(|column| (variables[column], map[(row, column)])));
        }
        problem.add_constraint(without_rounding(terms), ComparisonOp::Eq, -weight[row]);
    }
    for (number, hand) in hold.hands.iter().enumerate() {
        let [first, second] = [variables[2 * number], variables[2 * number + 1]];
        let both_n = 2.0 * hand.pad_pair().unwrap().grip_force_n;
        problem.add_constraint([(first[2], 1.0), (second[2], 1.0)], ComparisonOp::Eq, both_n);
        let maps = [0, 1].map(|pad| hand.jacobian_o.transpose() * pad_wrench(&hand.pads()[pad], &hand.grasp_point_o));
        for joint in 0..hand.dof() {
            let terms: Vec<_> = (0..6)
                .flat_map(|column| {
                    [(first[column], maps[0][(joint, column)]), (second[column], maps[1][(joint, column)])]
                })
                .collect();
            let (effort, gravity) = (hand.effort_nm[joint], hand.gravity_torque_nm[joint]);
            problem.add_constraint(without_rounding(terms.clone()), ComparisonOp::Le, effort - gravity);
            problem.add_constraint(without_rounding(terms), ComparisonOp::Ge, -effort - gravity);
        }
    }
    for (pad, variables) in pads.iter().zip(&variables) {
        let [_, _, normal, tilt_1, tilt_2, _] = *variables;
        let [a, b] = pad.half_sides_m;
        problem.add_constraint([(normal, 1.0)], ComparisonOp::Ge, 0.0);
        for (tilt, half_side) in [(tilt_1, b), (tilt_2, a)] {
            problem.add_constraint([(tilt, 1.0), (normal, -half_side)], ComparisonOp::Le, 0.0);
            problem.add_constraint([(tilt, -1.0), (normal, -half_side)], ComparisonOp::Le, 0.0);
        }
    }
    for (pad, plane) in cuts {
        let [t1, t2, normal, _, _, torsion] = variables[*pad];
        let model = pads[*pad];
        let terms =
            [(t1, plane.x), (t2, plane.y), (torsion, plane.z / model.torsion_radius_m()), (normal, -model.friction)];
        problem.add_constraint(without_rounding(terms), ComparisonOp::Le, 0.0);
    }
    let solution = problem.solve().unwrap().into_solution().unwrap();
    let values = variables.iter().map(|pad| Vector6::from_fn(|row, _| solution.var_value(pad[row]))).collect();
    (solution.var_value(lambda), values)
}

/// An upper bound of the load factor, tight up to the remaining violation of at most 1e-4 N.
fn by_cutting_planes(hold: &ContactModel) -> f64 {
    let pads: Vec<&PadModel> = hold.hands.iter().flat_map(benchdog::statics::HandModel::pads).collect();
    let mut cuts = Vec::new();
    for _ in 0..200 {
        let (lambda, wrenches) = relaxed(hold, &cuts);
        let before = cuts.len();
        for (number, (pad, w)) in pads.iter().zip(&wrenches).enumerate() {
            let tangential = Vector3::new(w[0], w[1], w[5] / pad.torsion_radius_m());
            if tangential.norm() > pad.friction * w[2] + 1e-4 {
                cuts.push((number, tangential.normalize()));
            }
        }
        if cuts.len() == before {
            return lambda;
        }
    }
    panic!("cutting planes did not close");
}

/// Both methods stop at a violation of the cones of 1e-4 N, of the 18 N of a pad's friction: 1e-5 for each pad. 1e-3
/// leaves a margin and is far below the effect of a different model.
const AGREEMENT: f64 = 1e-3;

#[test]
fn random_holds_agree_with_cutting_planes() {
    let mut compared = 0;
    for seed in 0..30 {
        let hold = random_hold(seed, 1 + seed as usize % 3);
        if !matches!(
            benchdog::statics::StabilityWorkspace::new().load_factor(&hold).unwrap(),
            benchdog::statics::LoadFactorOutcome::Solved(_)
        ) {
            continue;
        }
        let (ours, theirs) = (solved(&hold).load_factor, by_cutting_planes(&hold));
        approx::assert_relative_eq!(ours, theirs, max_relative = AGREEMENT, epsilon = AGREEMENT);
        compared += 1;
    }
    assert!(compared >= 15, "only {compared} of 30 random holds have a load factor");
}

#[test]
fn a_skew_load_on_one_hand_agrees_with_cutting_planes() {
    // Friction, torsion and tilt at once, with pads of different size.
    let mut hand = strong_hand("left", Vector3::new(0.05, 0.0, 0.02), Vector3::z(), Vector3::x(), 30.0, 0.6, 0.03);
    hand.pads_mut()[1].half_sides_m = [HALF_SIDES_M[0] / 2.0, HALF_SIDES_M[1]];
    let load = benchdog::model::wrench::Wrench::from([3.0, -2.0, 5.0, 0.1, 0.2, -0.1]);
    let hold = ContactModel { hands: vec![hand], weight: Default::default(), load, p_ot: Vector3::zeros() };
    let (ours, theirs) = (solved(&hold).load_factor, by_cutting_planes(&hold));
    approx::assert_relative_eq!(ours, theirs, max_relative = AGREEMENT);
}
