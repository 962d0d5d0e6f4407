//! Times of the inverse kinematics and the collision check, next to the crate `k` on the same robot and targets.
//!
//! First prints how many targets are solved, and fails if a posture is on none of its branches.
//! Run with `cargo bench --profile release --bench robot`.

use std::{hint::black_box, path::Path, time::Instant};

use benchdog::{
    collision::{BoardBody, CollisionModel, PersonPart, Scene},
    human::Human,
    model::frames::Pose,
    planner::{Outcome, Planner},
    robot::{
        ArmState, Chain, InverseKinematics, Robot,
        inverse::{Branch, ClosedForm, General},
    },
    scenario,
};
use criterion::Criterion;
use k::InverseKinematicsSolver;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use rand::{RngExt, SeedableRng};
use serde::Deserialize;

/// Starts that the general solver may try on one target.
const STARTS: usize = 60;

/// Random postures whose poses are searched for all branches.
const RANDOM_POSTURES: usize = 300;

/// The peer's tolerance (m and rad), step and steps. Its steps are halved, as its documentation has them; with the
/// tolerance of this crate, 1e-9, it would need another ten.
const PEER_TOLERANCE: f64 = 1e-6;
const PEER_STEP: f64 = 0.5;
const PEER_STEPS: usize = 100;

#[derive(Deserialize)]
struct Targets {
    left: Vec<Target>,
    right: Vec<Target>,
}

#[derive(Deserialize)]
struct Target {
    p_m: [f64; 3],
    quat_xyzw: [f64; 4],
}

/// An arm with the targets of the file.
struct Bench {
    name: &'static str,
    chain: Chain,
    closed_form: ClosedForm,
    inverse: InverseKinematics,
    general: General,
    targets: Vec<Target>,
}

impl Target {
    fn pose(&self) -> Pose {
        let [x, y, z, w] = self.quat_xyzw;
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        Isometry3::from_parts(Translation3::from(self.p_m), rotation)
    }

    /// The same pose for the peer, which has an older nalgebra.
    fn peer_pose(&self) -> k::Isometry3<f64> {
        let [x, y, z, w] = self.quat_xyzw;
        let rotation = k::UnitQuaternion::from_quaternion(k::nalgebra::Quaternion::new(w, x, y, z));
        k::Isometry3::from_parts(k::Translation3::new(self.p_m[0], self.p_m[1], self.p_m[2]), rotation)
    }
}

impl Bench {
    fn new(robot: &Robot, name: &'static str, targets: Vec<Target>) -> Self {
        let chain = Chain::new(robot, robot.arm_index(name).unwrap(), 0.0);
        Self {
            name,
            closed_form: ClosedForm::new(&chain).unwrap(),
            inverse: InverseKinematics::for_chain(&chain),
            general: General::new(&chain),
            chain,
            targets,
        }
    }

    fn middle(&self) -> Vec<f64> {
        self.chain.lower().iter().zip(self.chain.upper()).map(|(lower, upper)| 0.5 * (lower + upper)).collect()
    }

    /// The peer's arm, at the middle of its ranges whenever `reset` is called.
    fn peer(&self, urdf: &k::Chain<f64>) -> k::SerialChain<f64> {
        let arm = k::SerialChain::from_end(urdf.find_link(&format!("{}_gripper", self.name)).unwrap());
        arm.set_joint_positions(&self.middle()).unwrap();
        arm.update_transforms();
        let (peer, own) = (arm.end_transform(), self.chain.gripper_pose(&self.middle()));
        let apart = (0..3).map(|axis| (peer.translation.vector[axis] - own.translation.vector[axis]).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-9, "the peer's arm is another");
        arm
    }

    fn random_postures(&self, count: usize) -> Vec<Vec<f64>> {
        let mut generator = rand_pcg::Pcg64::seed_from_u64(2026);
        let limits: Vec<_> = self.chain.lower().iter().copied().zip(self.chain.upper().iter().copied()).collect();
        let mut posture = || limits.iter().map(|&(lower, upper)| generator.random_range(lower..upper)).collect();
        (0..count).map(|_| posture()).collect()
    }
}

/// Counts what is solved, prints it with the mean time of one target.
fn counted(what: &str, targets: &[Target], mut solves: impl FnMut(&Target) -> bool) {
    let start = Instant::now();
    let solved = targets.iter().filter(|target| solves(target)).count();
    let mean_us = start.elapsed().as_secs_f64() * 1e6 / targets.len() as f64;
    println!("{what}: {solved} of {} solved, mean {mean_us:.0} us", targets.len());
}

fn peer_solves(solver: &k::JacobianIkSolver<f64>, arm: &k::SerialChain<f64>, middle: &[f64], target: &Target) -> bool {
    arm.set_joint_positions_clamped(middle);
    solver.solve(arm, &target.peer_pose()).is_ok()
}

fn peer_solver() -> k::JacobianIkSolver<f64> {
    k::JacobianIkSolver::new(PEER_TOLERANCE, PEER_TOLERANCE, PEER_STEP, PEER_STEPS)
}

fn print_counts(bench: &Bench, urdf: &k::Chain<f64>) {
    let (name, middle) = (bench.name, bench.middle());
    counted(&format!("{name}, local search from the middle"), &bench.targets, |target| {
        bench.inverse.local(&target.pose(), &middle).found().is_some()
    });
    counted(&format!("{name}, general solver, up to {STARTS} starts"), &bench.targets, |target| {
        bench.general.solve(&target.pose(), STARTS).found().is_some()
    });
    counted(&format!("{name}, all branches"), &bench.targets, |target| {
        !bench.closed_form.branches(&target.pose()).branches().is_empty()
    });
    let (peer, solver) = (bench.peer(urdf), peer_solver());
    counted(&format!("{name}, k from the middle, to {PEER_TOLERANCE:e}"), &bench.targets, |target| {
        peer_solves(&solver, &peer, &middle, target)
    });
}

/// Checks that random postures are on a branch of their own pose.
fn check_random_postures(bench: &Bench) {
    let postures = bench.random_postures(RANDOM_POSTURES);
    let (mut branches, mut worst_ms) = (0, 0.0_f64);
    let mut found = 0;
    let start = Instant::now();
    for q_rad in &postures {
        let pose = bench.chain.gripper_pose(q_rad);
        let one = Instant::now();
        let motion = bench.closed_form.branches(&pose);
        worst_ms = worst_ms.max(one.elapsed().as_secs_f64() * 1e3);
        branches += motion.branches().len();
        let is_source = |branch: &Branch| branch.contains(q_rad, 1e-6);
        found += usize::from(motion.branches().iter().any(is_source));
    }
    let mean_ms = start.elapsed().as_secs_f64() * 1e3 / postures.len() as f64;
    let name = bench.name;
    println!("{name}, random postures among their branches: {found} of {RANDOM_POSTURES}, {branches} branches");
    println!("{name}, all branches of a pose: mean {mean_ms:.2} ms, longest {worst_ms:.2} ms");
    assert_eq!(found, postures.len(), "a posture is on none of its branches");
}

fn time_inverse_kinematics(criterion: &mut Criterion, bench: &Bench, urdf: &k::Chain<f64>) {
    let (name, middle) = (bench.name, bench.middle());
    let postures = bench.random_postures(RANDOM_POSTURES);
    let poses: Vec<Pose> = postures.iter().map(|q_rad| bench.chain.gripper_pose(q_rad)).collect();
    let mut group = criterion.benchmark_group(name);
    let mut sources = postures.iter().zip(&poses).cycle();
    group.bench_function("slice", |timer| {
        timer.iter(|| {
            let (q_rad, pose) = sources.next().unwrap();
            black_box(bench.closed_form.slice(pose, q_rad[5]))
        });
    });
    let mut cycle = poses.iter().cycle();
    group.bench_function("all_branches", |timer| {
        timer.iter(|| black_box(bench.closed_form.branches(cycle.next().unwrap())));
    });
    let mut targets = bench.targets.iter().cycle();
    group.bench_function("local_from_the_middle", |timer| {
        timer.iter(|| black_box(bench.inverse.local(&targets.next().unwrap().pose(), &middle)));
    });
    group.bench_function("general_solver", |timer| {
        timer.iter(|| black_box(bench.general.solve(&targets.next().unwrap().pose(), STARTS)));
    });
    let (peer, solver) = (bench.peer(urdf), peer_solver());
    group.bench_function("k_from_the_middle", |timer| {
        timer.iter(|| black_box(peer_solves(&solver, &peer, &middle, targets.next().unwrap())));
    });
    group.finish();
}

/// The collision check of a planned scene without violations.
fn time_collisions(criterion: &mut Criterion) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/quickstart.toml");
    let loaded = scenario::load(&path).unwrap();
    let (scenario, robot) = (loaded.scenario, loaded.robot);
    let Outcome::Found(plan) = Planner::new(&robot).plan(&scenario).unwrap() else { panic!("no plan") };
    let posture = plan.human.as_ref().unwrap();
    let human = Human::new(&scenario.human, &scenario.tool).unwrap();
    let person = human.capsules_w(&posture.x_wb, &posture.q_rad).map(PersonPart::from);
    let holding: Vec<usize> = plan.arms.iter().map(|hold| robot.arm_index(&hold.name).unwrap()).collect();
    let states: Vec<ArmState> = plan
        .arms
        .iter()
        .zip(&holding)
        .map(|(hold, &arm)| {
            let gripper = &robot.arms[arm].gripper;
            let finger_travel_m = [0, 1].map(|finger| gripper.travel_for_gap_m(finger, plan.object.size_m[2]));
            ArmState { arm, q_rad: &hold.q_rad, finger_travel_m }
        })
        .collect();
    let link_poses = robot.link_poses(&robot.positions(&states));
    let (board, x_wo) = (&BoardBody::new(&plan.object.shape()), plan.object.x_wo);
    let scene = Scene { link_poses: &link_poses, holding: &holding, board, x_wo, person: &person, clearance_m: 0.0 };
    let model = CollisionModel::new(&robot);
    assert_eq!(model.first_violation(&scene), None);
    let mut group = criterion.benchmark_group("collision");
    group.bench_function("free_scene", |timer| timer.iter(|| black_box(model.first_violation(black_box(&scene)))));
    group.bench_function("least_margin", |timer| timer.iter(|| black_box(model.min_margin_m(black_box(&scene)))));
    group.finish();
}

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let robot = Robot::load("baxter", root).unwrap();
    let text = std::fs::read_to_string(root.join("tests/data/baxter_ik_targets.json")).unwrap();
    let Targets { left, right } = serde_json::from_str(&text).unwrap();
    let benches = [Bench::new(&robot, "left", left), Bench::new(&robot, "right", right)];
    let urdf = k::Chain::from_urdf_file(root.join("assets/baxter.urdf")).unwrap();
    for bench in &benches {
        print_counts(bench, &urdf);
        check_random_postures(bench);
    }
    let mut criterion = Criterion::default().configure_from_args();
    time_inverse_kinematics(&mut criterion, &benches[0], &urdf);
    time_collisions(&mut criterion);
    criterion.final_summary();
}
