//! The static optimisation of the muscles against clarabel, and which muscles work in postures that anatomy knows.

use benchdog::{
    human::{
        Human, default_tool,
        muscles::{MOMENTS, MUSCLES, MuscleProgram},
        standing_pose_w,
    },
    model::{
        operation::OperationKind,
        scenario::{Hand, Person, PostureLimits, Sex, Tool},
        wrench::Wrench,
    },
};
use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT},
};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// The least cost `sum a^2 + 50 sum (r / r0)^2` by clarabel.
fn cost_by_clarabel(program: &MuscleProgram) -> f64 {
    let (moments_nm, demanded_nm) = (program.muscle_moments_nm(), program.demanded_nm());
    let variables = MUSCLES + MOMENTS;
    // Rows: 7 of balance, 50 of a >= 0, 50 of a <= 1.
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for (muscle, of_muscle) in moments_nm.iter().enumerate() {
        rows.extend(0..MOMENTS);
        values.extend(of_muscle);
        rows.extend([MOMENTS + muscle, MOMENTS + MUSCLES + muscle]);
        values.extend([-1.0, 1.0]);
        starts.push(rows.len());
    }
    for moment in 0..MOMENTS {
        rows.push(moment);
        values.push(1.0);
        starts.push(rows.len());
    }
    let a = CscMatrix::new(MOMENTS + 2 * MUSCLES, variables, starts, rows, values);
    let b: Vec<_> = demanded_nm.into_iter().chain([0.0; MUSCLES]).chain([1.0; MUSCLES]).collect();
    let weights: Vec<_> = (0..variables)
        .map(|variable| if variable < MUSCLES { 2.0 } else { 2.0 * weight(variable - MUSCLES) })
        .collect();
    let p = CscMatrix::new(variables, variables, (0..=variables).collect(), (0..variables).collect(), weights);
    let cones = [SupportedConeT::ZeroConeT(MOMENTS), SupportedConeT::NonnegativeConeT(2 * MUSCLES)];
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-11)
        .tol_gap_rel(1e-11)
        .tol_feas(1e-11)
        .build()
        .unwrap();
    let mut solver = DefaultSolver::new(&p, &vec![0.0; variables], &a, &b, &cones, settings).unwrap();
    solver.solve();
    assert!(matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved));
    solver.solution.obj_val
}

/// Weight of a reserve: 50 / r0^2.
fn weight(moment: usize) -> f64 {
    if moment < 4 { 50.0 } else { 200.0 }
}

#[test]
fn clarabel_finds_the_same_effort() {
    let person = Person { posture: PostureLimits::UNRESTRICTED, ..Person::default() };
    let human = Human::new(&person, &default_tool(OperationKind::Drill)).unwrap();
    let (x_wb, mut generator) = (standing_pose_w(0.0, 0.0, 0.0, 0.0), Pcg64::seed_from_u64(61));
    for _ in 0..1_000 {
        let mut within = |low: f64, high: f64| generator.random_range(low..=high);
        let q_rad = human.arm().ranges.at_shares(std::array::from_fn(|_| within(0.0, 1.0)));
        let wrench_w = Wrench::from_force(Vector3::from_fn(|_, _| within(-20.0, 20.0)));
        let program = human.muscle_program(&q_rad, &x_wb, &wrench_w);
        let found = program.solve().unwrap();
        let of_reserves: f64 = found.missing_nm.iter().enumerate().map(|(moment, r)| weight(moment) * r * r).sum();
        let (ours, theirs) = (found.effort + of_reserves, cost_by_clarabel(&program));
        // clarabel's tolerances; the cost is up to 1e4 where the arm is too weak.
        assert!((ours - theirs).abs() < 1e-6 * (1.0 + theirs), "{ours} {theirs}");
    }
}

/// The activation of each muscle of the default man with this tool, his forearm and hand neither pronated nor bent unless the
/// angles say so.
fn activations(tool: &Tool, q_deg: [f64; 7], force_w_n: Vector3<f64>) -> impl Fn(&str) -> f64 + use<> {
    let person = Person { posture: PostureLimits::UNRESTRICTED, ..Person::default() };
    let human = Human::new(&person, tool).unwrap();
    let x_wb = standing_pose_w(0.0, 0.0, 0.0, 0.0);
    let program = human.muscle_program(&q_deg.map(f64::to_radians), &x_wb, &Wrench::from_force(force_w_n));
    let found: Vec<_> = program.solve().unwrap().activations().collect();
    move |name| found.iter().find(|(muscle, _)| *muscle == name).unwrap().1
}

/// Nothing in the hand; a force acts in the palm.
const PALM: Tool = Tool { mass_kg: 0.0, tip_h_m: [0.0, 0.0, -0.05], rotation_xyzw: [1.0, 0.0, 0.0, 0.0] };

const ELBOW_FLEXORS: [&str; 4] = ["brachialis", "brachioradialis", "long head of biceps", "short head of biceps"];
const ELBOW_EXTENSORS: [&str; 3] = ["long head of triceps", "lateral head of triceps", "medial head of triceps"];

// Which muscles move the joints: Standring (ed.), Gray's Anatomy, 41st edition, 2016, chapters 48 (shoulder girdle and arm)
// and 49 (elbow and forearm).

#[test]
fn a_drill_held_with_a_bent_elbow_hangs_on_the_flexors_of_the_elbow() {
    let of = activations(&default_tool(OperationKind::Drill), [0.0, 0.0, 0.0, 90.0, 0.0, 0.0, 0.0], Vector3::zeros());
    // With the thumb up brachialis and brachioradialis do more than the biceps, which also supinates.
    assert!(of("brachialis") > 0.1 && of("brachioradialis") > 0.1, "{} {}", of("brachialis"), of("brachioradialis"));
    assert!(ELBOW_FLEXORS[2..].iter().all(|muscle| of(muscle) < 0.7 * of("brachialis")));
    assert!(ELBOW_EXTENSORS.iter().all(|muscle| of(muscle) < 0.005));
    // The weight hangs in front of the shoulder.
    assert!(of("anterior deltoid") > 0.1 && of("posterior deltoid") < 0.05);
}

#[test]
fn an_arm_raised_sideways_hangs_on_deltoid_and_supraspinatus() {
    let raised = |abduction_deg| activations(&PALM, [0.0, abduction_deg, 0.0, 15.0, 0.0, 0.0, 0.0], Vector3::zeros());
    let of = raised(45.0);
    assert!(of("supraspinatus") > 0.2 && of("middle deltoid") > 0.2);
    let of = raised(80.0);
    let others = ["anterior deltoid", "posterior deltoid", "subscapularis", "infraspinatus", "brachialis"];
    assert!(others.iter().all(|muscle| of(muscle) < 0.5 * of("middle deltoid")));
    let adductors = ["costal pectoralis major", "thoracic latissimus dorsi", "iliac latissimus dorsi", "teres major"];
    assert!(adductors.iter().all(|muscle| of(muscle) < 0.01));
}

#[test]
fn pushing_forward_at_the_height_of_the_shoulder_takes_the_triceps() {
    let of = activations(&PALM, [85.0, 0.0, 0.0, 60.0, 0.0, 0.0, 0.0], Vector3::new(60.0, 0.0, 0.0));
    assert!(ELBOW_EXTENSORS.iter().all(|muscle| of(muscle) > 0.2));
    assert!(ELBOW_FLEXORS.iter().all(|muscle| of(muscle) < 0.02));
    // Pulling back takes the antagonists.
    let of = activations(&PALM, [85.0, 0.0, 0.0, 60.0, 0.0, 0.0, 0.0], Vector3::new(-60.0, 0.0, 0.0));
    assert!(of("brachialis") > 0.1 && ELBOW_EXTENSORS.iter().all(|muscle| of(muscle) < 0.02));
}

#[test]
fn both_hands_work_alike_and_a_stronger_person_works_less() {
    let x_wb = standing_pose_w(0.0, 0.0, 0.0, 0.0);
    let q_rad = [0.6, 0.3, 0.2, 1.2, 0.3, 0.1, 0.05];
    let effort = |person: &Person, side: f64| {
        let human = Human::new(person, &PALM).unwrap();
        let wrench_w = Wrench::from_force(Vector3::new(12.0, 5.0 * side, -8.0));
        human.muscle_program(&q_rad, &x_wb, &wrench_w).solve().unwrap().effort
    };
    let man = Person { posture: PostureLimits::UNRESTRICTED, ..Person::default() };
    let left = Person { hand: Hand::Left, ..man };
    assert!((effort(&man, 1.0) - effort(&left, -1.0)).abs() < 1e-12);
    let [weak, strong] = [5.0, 95.0].map(|percentile| effort(&Person { percentile, ..man }, 1.0));
    assert!(weak > effort(&man, 1.0) && effort(&man, 1.0) > strong);
    let woman = Person { sex: Sex::Female, height_m: 1.62, mass_kg: 62.0, ..man };
    assert!(effort(&woman, 1.0) > effort(&man, 1.0));
}
