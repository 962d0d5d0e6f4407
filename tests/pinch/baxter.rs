//! Baxter holding a board by two opposite edges, its worked face towards the person.

use benchdog::{
    model::{
        FORMAT,
        board::{BoardShape, Edge},
        frames::Pose,
        grasp::EdgeGrasp,
        operation::Operation,
        plan::{ArmHold, PlacedObject, Plan},
    },
    robot::{Chain, Robot},
};
use nalgebra::{
    DVector, Isometry3, Matrix3, Matrix6, Matrix6xX, Point3, Translation3, UnitQuaternion, Vector3, Vector6,
};
use rand::{RngExt, SeedableRng};

/// The foam board of docs/method.md#24-board, m and kg.
const BOARD_M: [f64; 3] = [0.50, 0.40, 0.030];
pub const BOARD_KG: f64 = 0.21;

/// The twist in W axes from one pose to another: displacement of the origin, then rotation vector.
fn twist_between(from: &Pose, to: &Pose) -> Vector6<f64> {
    let linear = to.translation.vector - from.translation.vector;
    let angular = (to.rotation * from.rotation.inverse()).scaled_axis();
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

/// Angles within the limits that put the gripper at a pose: damped Newton steps from random starts.
fn inverse_kinematics(chain: &Chain, x_wg: &Pose, seed: u64) -> Vec<f64> {
    let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
    for _ in 0..500 {
        let mut q: Vec<f64> =
            chain.lower().iter().zip(chain.upper()).map(|(lo, hi)| lo + (hi - lo) * random.random::<f64>()).collect();
        for _ in 0..60 {
            let error = twist_between(&chain.gripper_pose(&q), x_wg);
            if error.norm() < 1e-10 && chain.within_limits(&q, -0.05) {
                return q;
            }
            let j = chain.jacobian_w(&q);
            let damped = &j * j.transpose() + Matrix6::identity() * 1e-9;
            let step: DVector<f64> = j.transpose() * damped.lu().solve(&error).unwrap();
            let shrink = (0.4 / step.amax()).min(1.0);
            q.iter_mut().zip(step.iter()).for_each(|(q, s)| *q += s * shrink);
        }
    }
    panic!("no configuration reaches {x_wg}");
}

/// The board in front of the robot, z_O = x_W, x_O = y_W.
fn x_wo() -> Pose {
    let axes = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    Isometry3::from_parts(Translation3::new(0.55, 0.0, 0.3), UnitQuaternion::from_matrix(&axes))
}

/// A plan: the left hand on the +x edge, the right hand on the -x edge.
pub fn plan(robot: &Robot, operation: Operation, mass_kg: f64, grip_force_n: f64) -> Plan {
    let hold = |name: &str, edge: Edge| {
        let arm = robot.arm_index(name).unwrap();
        let grasp = EdgeGrasp { edge, along_m: 0.0, depth_m: 0.035, angle_rad: 0.0, flipped: false };
        let x_og = grasp.x_og(&BoardShape::cuboid(BOARD_M));
        ArmHold {
            name: name.into(),
            joints: robot.arms[arm].joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect(),
            q_rad: inverse_kinematics(&Chain::new(robot, arm, 0.0), &(x_wo() * x_og), 7),
            x_og,
            grip_force_n,
        }
    };
    Plan {
        format: FORMAT,
        name: "two arms".into(),
        robot: "baxter".into(),
        operation,
        object: PlacedObject::cuboid(BOARD_M, mass_kg, x_wo()),
        arms: vec![hold("left", Edge::PLUS_X), hold("right", Edge::MINUS_X)],
        human: None,
        comfort: None,
        muscles: None,
        stability: None,
        clearance: None,
        planner: None,
        scenario: None,
        benchdog: None,
    }
}

/// Compliance of an arm's gripper, `J K^-1 J'`, in W axes about G.
fn compliance(chain: &Chain, stiffness_nm_rad: &[f64], q_rad: &[f64]) -> Matrix6<f64> {
    let j: Matrix6xX<f64> = chain.jacobian_w(q_rad);
    let softness = DVector::from_iterator(stiffness_nm_rad.len(), stiffness_nm_rad.iter().map(|k| 1.0 / k));
    let scaled = &j * nalgebra::DMatrix::from_diagonal(&softness);
    let product = scaled * j.transpose();
    product.fixed_view::<6, 6>(0, 0).into_owned()
}

/// `[1, -[p]x; 0, 1]`: maps a twist at a point to the twist at the point `p` away from it.
fn shift(p: &Vector3<f64>) -> Matrix6<f64> {
    let mut shift = Matrix6::identity();
    shift.fixed_view_mut::<3, 3>(0, 3).copy_from(&-p.cross_matrix());
    shift
}

/// The displacement of the tool tip under the operation by the welded stiffness (docs/method.md#67-welded-stiffness),
/// m, W axes.
pub fn welded_displacement_m(robot: &Robot, plan: &Plan) -> Vector3<f64> {
    let tip_w = plan.object.x_wo * Point3::from(plan.operation.x_ot.translation.vector);
    let mut stiffness = Matrix6::zeros();
    for hold in &plan.arms {
        let arm = robot.arm_index(&hold.name).unwrap();
        let chain = Chain::new(robot, arm, 0.0);
        let p = chain.gripper_pose(&hold.q_rad).translation.vector - tip_w.coords;
        let c = compliance(&chain, &robot.arms[arm].stiffness_nm_rad, &hold.q_rad);
        stiffness += shift(&p).transpose() * c.try_inverse().unwrap() * shift(&p);
    }
    let rotation = plan.object.x_wo.rotation;
    let f = rotation * plan.operation.wrench_o.force_n;
    let m = rotation * plan.operation.wrench_o.moment_nm;
    let twist = stiffness.lu().solve(&Vector6::new(f.x, f.y, f.z, m.x, m.y, m.z)).unwrap();
    twist.fixed_rows::<3>(0).into_owned()
}
