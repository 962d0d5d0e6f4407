//! One arm as a serial chain of revolute and prismatic joints, with rigidly connected links merged.
//!
//! Positions, velocities and torques of a prismatic joint are in m, m/s and N where those of a revolute joint are in rad,
//! rad/s and N m.
//!
//! Gripper and fingers are rigid parts of the last link.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix6xX, Translation3, Unit, UnitQuaternion, Vector3, Vector6};

use super::tree::{ArmState, JointKind, Robot};
use crate::model::{GRAVITY_W, frames::Pose};

/// An arm's joints, the fixed transforms between them, and the merged inertia of the links that each carries.
#[derive(Clone, Debug)]
pub struct Chain {
    joints: Vec<ChainJoint>,
    /// Pose of the gripper's frame G in the frame of the last joint.
    x_lg: Pose,
    lower: Vec<f64>,
    upper: Vec<f64>,
    effort_nm: Vec<f64>,
}

/// A joint and the inertia of the links that it carries.
#[derive(Clone, Debug)]
struct ChainJoint {
    slides: bool,
    /// Pose of the joint's frame in the frame of the previous joint, in W for the first.
    x_pj: Pose,
    axis_j: Unit<Vector3<f64>>,
    inertia: SpatialInertia,
}

impl ChainJoint {
    /// The pose in W of the moving frame, from that of the previous joint.
    fn moved(&self, x_wp: &Pose, position: f64) -> Pose {
        let x_wj = x_wp * self.x_pj;
        if self.slides {
            x_wj * Translation3::from(self.axis_j.into_inner() * position)
        } else {
            x_wj * UnitQuaternion::from_axis_angle(&self.axis_j, position)
        }
    }

    /// Velocity of a point that the joint moves, for a unit rate, m/s: `lever_w` is the point from the joint's origin.
    fn velocity_w(&self, axis_w: &Vector3<f64>, lever_w: &Vector3<f64>) -> Vector3<f64> {
        if self.slides { *axis_w } else { axis_w.cross(lever_w) }
    }

    /// Angular velocity for a unit rate, rad/s.
    fn turn_w(&self, axis_w: &Vector3<f64>) -> Vector3<f64> {
        if self.slides { Vector3::zeros() } else { *axis_w }
    }
}

/// Mass properties of rigidly connected links, in the frame of the joint that carries them.
#[derive(Clone, Debug)]
struct SpatialInertia {
    mass_kg: f64,
    com_j: Vector3<f64>,
    /// About the centre of mass, kg m^2.
    inertia_j: Matrix3<f64>,
}

/// The links that a joint carries.
#[derive(Clone, Debug)]
struct Carried {
    mass_kg: f64,
    /// First moment of the mass about the joint's origin, kg m, W axes.
    lever_kg_m: Vector3<f64>,
}

impl Chain {
    /// The chain of an arm (an index into [`Robot::arms`]) with both fingers at this travel from their closed limits. All other
    /// joints are at 0 or at the limit nearest to 0.
    pub fn new(robot: &Robot, arm_index: usize, finger_travel_m: f64) -> Self {
        let arm = &robot.arms[arm_index];
        let q_rad = vec![0.0; arm.joints.len()];
        let state = ArmState { arm: arm_index, q_rad: &q_rad, finger_travel_m: [finger_travel_m; 2] };
        // At zero angles the frame of a joint is that of its child link.
        let x_wl = robot.link_poses(&robot.positions(&[state]));
        let x_wj: Vec<Pose> = arm.joints.iter().map(|&joint| x_wl[robot.joints[joint].child_link]).collect();
        // For each link the last joint of the chain above it.
        let carrier = robot.nearest_above(|joint| arm.joints.iter().position(|&own| own == joint));
        let joints = (0..arm.joints.len()).map(|number| {
            let carried = (0..robot.links.len()).filter(|&link| carrier[link] == Some(number));
            ChainJoint {
                slides: robot.joints[arm.joints[number]].kind == JointKind::Prismatic,
                x_pj: if number == 0 { x_wj[0] } else { x_wj[number - 1].inverse() * x_wj[number] },
                axis_j: robot.joints[arm.joints[number]].axis_j,
                inertia: merge(robot, carried, &x_wj[number], &x_wl),
            }
        });
        let limit = |of: fn(&super::tree::Joint) -> f64| arm.joints.iter().map(|&j| of(&robot.joints[j])).collect();
        Self {
            joints: joints.collect(),
            // A gripper without an arm stands in the world.
            x_lg: x_wj.last().unwrap_or(&Pose::identity()).inverse() * x_wl[arm.gripper.frame_link],
            lower: limit(|joint| joint.lower),
            upper: limit(|joint| joint.upper),
            effort_nm: arm.effort_nm.clone(),
        }
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Smallest angle of each joint, rad.
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// Largest angle of each joint, rad.
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// Largest torque of each joint, N m.
    pub fn effort_nm(&self) -> &[f64] {
        &self.effort_nm
    }

    /// True if every angle is within its limits, with a tolerance of `tolerance_rad`.
    pub fn within_limits(&self, q_rad: &[f64], tolerance_rad: f64) -> bool {
        let limits = self.lower.iter().zip(&self.upper);
        q_rad.iter().zip(limits).all(|(q, (lo, hi))| *q >= lo - tolerance_rad && *q <= hi + tolerance_rad)
    }

    /// The pose of the gripper's frame, X_WG.
    pub fn gripper_pose(&self, q_rad: &[f64]) -> Pose {
        let mut x_wj = Pose::identity();
        for (joint, &angle) in self.joints.iter().zip(q_rad) {
            x_wj = joint.moved(&x_wj, angle);
        }
        x_wj * self.x_lg
    }

    /// The pose in W of each joint's moving frame, which is that of its child link.
    pub fn joint_frames(&self, q_rad: &[f64]) -> Vec<Pose> {
        let mut x_wj = Pose::identity();
        let turn = |(joint, &angle): (&ChainJoint, &f64)| {
            x_wj = joint.moved(&x_wj, angle);
            x_wj
        };
        self.joints.iter().zip(q_rad).map(turn).collect()
    }

    /// The first joint's axis in W, which is fixed: a point on it and its direction.
    pub fn first_axis_w(&self) -> (Vector3<f64>, Vector3<f64>) {
        let joint = &self.joints[0];
        (joint.x_pj.translation.vector, joint.x_pj.rotation * joint.axis_j.into_inner())
    }

    /// The last joint's axis in W for a gripper pose: a point on it and its direction. It does not depend on that joint's angle.
    pub fn last_axis_w(&self, x_wg: &Pose) -> (Vector3<f64>, Vector3<f64>) {
        let x_wl = x_wg * self.x_lg.inverse();
        let axis_l = self.joints.last().map_or(Vector3::z(), |joint| joint.axis_j.into_inner());
        (x_wl.translation.vector, x_wl.rotation * axis_l)
    }

    /// The angle of the last joint that minimises the rotation error of G to `x_wg` with all other joints at `q_rad`, rad, in
    /// [-pi, pi]; `None` if that joint is prismatic.
    pub fn last_angle_towards(&self, q_rad: &[f64], x_wg: &Pose) -> Option<f64> {
        let joint = self.joints.last().filter(|joint| !joint.slides)?;
        let mut q_rad = q_rad.to_vec();
        if let Some(last) = q_rad.last_mut() {
            *last = 0.0;
        }
        let turn = self.gripper_pose(&q_rad).rotation * self.x_lg.rotation.inverse();
        let wanted = turn.inverse() * x_wg.rotation * self.x_lg.rotation.inverse();
        // The twist of the rotation about the axis, from the quaternion's projection on it.
        let along = wanted.vector().dot(&joint.axis_j);
        let angle_rad = 2.0 * along.atan2(wanted.scalar());
        Some(angle_rad.sin().atan2(angle_rad.cos()))
    }

    /// True if the first joint is revolute.
    pub fn begins_revolute(&self) -> bool {
        self.joints.first().is_some_and(|joint| !joint.slides)
    }

    /// The Jacobian of G, 6 x dof: rows 0 to 2 the velocity of G's origin (m/s), rows 3 to 5 the angular velocity
    /// (rad/s), both in W axes, for joint rates in rad/s.
    pub fn jacobian_w(&self, q_rad: &[f64]) -> Matrix6xX<f64> {
        let frames = self.joint_frames(q_rad);
        self.jacobian_from_frames(&frames)
    }

    /// [`Chain::jacobian_w`] from the frames of all joints.
    pub fn jacobian_from_frames(&self, frames: &[Pose]) -> Matrix6xX<f64> {
        let p_wg = self.gripper_from_frames(frames).translation.vector;
        let mut jacobian = Matrix6xX::zeros(self.dof());
        for (number, (joint, x_wj)) in self.joints.iter().zip(frames).enumerate() {
            let axis_w = x_wj.rotation * joint.axis_j.into_inner();
            let linear = joint.velocity_w(&axis_w, &(p_wg - x_wj.translation.vector));
            let mut column = jacobian.column_mut(number);
            column.fixed_rows_mut::<3>(0).copy_from(&linear);
            column.fixed_rows_mut::<3>(3).copy_from(&joint.turn_w(&axis_w));
        }
        jacobian
    }

    /// X_WG; writes the columns of [`Chain::jacobian_w`] into `columns`. Does not allocate.
    pub(super) fn pose_and_columns(&self, q_rad: &[f64], columns: &mut [Vector6<f64>]) -> Pose {
        let mut x_wj = Pose::identity();
        for ((joint, &angle), column) in self.joints.iter().zip(q_rad).zip(columns.iter_mut()) {
            x_wj = joint.moved(&x_wj, angle);
            let axis_w = x_wj.rotation * joint.axis_j.into_inner();
            column.fixed_rows_mut::<3>(0).copy_from(&x_wj.translation.vector);
            column.fixed_rows_mut::<3>(3).copy_from(&axis_w);
        }
        let x_wg = x_wj * self.x_lg;
        for (joint, column) in self.joints.iter().zip(columns) {
            let origin_w = column.fixed_rows::<3>(0).into_owned();
            let axis_w = column.fixed_rows::<3>(3).into_owned();
            let linear = joint.velocity_w(&axis_w, &(x_wg.translation.vector - origin_w));
            column.fixed_rows_mut::<3>(0).copy_from(&linear);
            column.fixed_rows_mut::<3>(3).copy_from(&joint.turn_w(&axis_w));
        }
        x_wg
    }

    /// X_WG from the frames of all joints.
    pub fn gripper_from_frames(&self, frames: &[Pose]) -> Pose {
        frames.last().map_or(self.x_lg, |x_wl| x_wl * self.x_lg)
    }

    /// The axis of each joint in W from the frames of all joints.
    pub fn axes_w(&self, frames: &[Pose]) -> Vec<Vector3<f64>> {
        self.joints.iter().zip(frames).map(|(joint, x_wj)| x_wj.rotation * joint.axis_j.into_inner()).collect()
    }

    /// The joint torques that hold the arm against gravity, N m, or forces of prismatic joints, N: the gradient of the potential
    /// energy, `tau_i = -g . z_i x l_i` with `l_i = sum_{k >= i} (c_k - p_i) m_k`; `-g . z_i sum_{k >= i} m_k` of a prismatic
    /// joint.
    pub fn gravity_torque_nm(&self, q_rad: &[f64]) -> DVector<f64> {
        let frames = self.joint_frames(q_rad);
        let (axes_w, carried) = (self.axes_w(&frames), self.carried_w(&frames));
        let torques = self.joints.iter().zip(&axes_w).zip(&carried).map(|((joint, axis_w), carried)| {
            if joint.slides {
                -axis_w.dot(&(GRAVITY_W * carried.mass_kg))
            } else {
                -axis_w.dot(&carried.lever_kg_m.cross(&GRAVITY_W))
            }
        });
        DVector::from_iterator(self.dof(), torques)
    }

    /// The derivative of the gravity torques by the angles, dof x dof, N m/rad: the Hessian of the potential energy,
    /// `dtau_i/dq_j = -g . z_i x (z_j x l_j)` for `i <= j`, and symmetric. A prismatic joint j moves the moment by
    /// `z_j sum m_k`; the force of a prismatic joint i does not depend on the joints after it.
    pub fn gravity_stiffness_nm_rad(&self, q_rad: &[f64]) -> DMatrix<f64> {
        let frames = self.joint_frames(q_rad);
        let (axes_w, carried) = (self.axes_w(&frames), self.carried_w(&frames));
        let mut stiffness = DMatrix::zeros(self.dof(), self.dof());
        for (column, carried) in carried.iter().enumerate() {
            let moved = if self.joints[column].slides {
                axes_w[column] * carried.mass_kg
            } else {
                axes_w[column].cross(&carried.lever_kg_m)
            };
            for row in (0..=column).filter(|&row| !self.joints[row].slides) {
                let entry = -axes_w[row].dot(&moved.cross(&GRAVITY_W));
                stiffness[(row, column)] = entry;
                stiffness[(column, row)] = entry;
            }
        }
        stiffness
    }

    /// What each joint carries.
    fn carried_w(&self, frames: &[Pose]) -> Vec<Carried> {
        let mut carried = vec![Carried { mass_kg: 0.0, lever_kg_m: Vector3::zeros() }; self.dof()];
        let mut mass_kg = 0.0;
        let mut moment_kg_m = Vector3::zeros();
        for (number, (joint, x_wj)) in self.joints.iter().zip(frames).enumerate().rev() {
            let segment = &joint.inertia;
            mass_kg += segment.mass_kg;
            moment_kg_m += (x_wj.rotation * segment.com_j + x_wj.translation.vector) * segment.mass_kg;
            carried[number] = Carried { mass_kg, lever_kg_m: moment_kg_m - x_wj.translation.vector * mass_kg };
        }
        carried
    }

    /// The joint-space inertia, dof x dof, kg m^2: `sum_k m_k Jv_k' Jv_k + Jw_k' I_k Jw_k`, without motor inertia.
    pub fn mass_matrix(&self, q_rad: &[f64]) -> DMatrix<f64> {
        let frames = self.joint_frames(q_rad);
        let axes_w = self.axes_w(&frames);
        let mut mass = DMatrix::zeros(self.dof(), self.dof());
        for (number, (joint, x_wj)) in self.joints.iter().zip(&frames).enumerate() {
            let segment = &joint.inertia;
            let com_w = x_wj.rotation * segment.com_j + x_wj.translation.vector;
            let rotation = x_wj.rotation.to_rotation_matrix();
            let inertia_w = rotation.matrix() * segment.inertia_j * rotation.matrix().transpose();
            let velocity = |joint: usize| {
                self.joints[joint].velocity_w(&axes_w[joint], &(com_w - frames[joint].translation.vector))
            };
            let turn = |joint: usize| self.joints[joint].turn_w(&axes_w[joint]);
            for row in 0..=number {
                for column in 0..=number {
                    mass[(row, column)] += segment.mass_kg * velocity(row).dot(&velocity(column))
                        + turn(row).dot(&(inertia_w * turn(column)));
                }
            }
        }
        mass
    }

    /// Mass and first moment of all links that the chain carries: `(sum m, sum m c)`, kg and kg m, W.
    pub fn mass_and_moment_w(&self, q_rad: &[f64]) -> (f64, Vector3<f64>) {
        let frames = self.joint_frames(q_rad);
        self.joints.iter().zip(&frames).fold((0.0, Vector3::zeros()), |(mass, moment), (joint, x_wj)| {
            let com_w = x_wj.rotation * joint.inertia.com_j + x_wj.translation.vector;
            (mass + joint.inertia.mass_kg, moment + com_w * joint.inertia.mass_kg)
        })
    }

    /// The origin of the first joint in W, m; it is fixed.
    pub fn shoulder_w(&self) -> Vector3<f64> {
        self.joints[0].x_pj.translation.vector
    }

    /// An upper bound of the distance between [`Chain::shoulder_w`] and G's origin, m: the sum of all offsets, and of the farther
    /// limits of prismatic joints.
    pub fn reach_m(&self) -> f64 {
        let offsets = self.joints.iter().skip(1).map(|joint| joint.x_pj.translation.vector.norm());
        let slides = self.joints.iter().enumerate().filter(|(_, joint)| joint.slides);
        let strokes = slides.map(|(number, _)| self.lower[number].abs().max(self.upper[number].abs()));
        offsets.chain(strokes).sum::<f64>() + self.x_lg.translation.vector.norm()
    }

    /// True if no joint is prismatic.
    pub fn is_revolute(&self) -> bool {
        self.joints.iter().all(|joint| !joint.slides)
    }
}

/// The mass properties of links as one rigid body in the frame `x_wj`.
fn merge(robot: &Robot, links: impl Iterator<Item = usize> + Clone, x_wj: &Pose, x_wl: &[Pose]) -> SpatialInertia {
    let placed: Vec<_> = links.map(|link| (&robot.links[link], x_wj.inverse() * x_wl[link])).collect();
    let mass_kg: f64 = placed.iter().map(|(link, _)| link.mass_kg).sum();
    let com_of = |link: &super::tree::Link, x_jl: &Pose| x_jl.rotation * link.com_l + x_jl.translation.vector;
    let moment: Vector3<f64> = placed.iter().map(|(link, x_jl)| com_of(link, x_jl) * link.mass_kg).sum();
    // Without mass the centre is arbitrary.
    let com_j = if mass_kg > 0.0 { moment / mass_kg } else { Vector3::zeros() };
    let mut inertia_j = Matrix3::zeros();
    for (link, x_jl) in &placed {
        let rotation = x_jl.rotation.to_rotation_matrix();
        let offset = com_of(link, x_jl) - com_j;
        let steiner = Matrix3::from_diagonal_element(offset.norm_squared()) - offset * offset.transpose();
        inertia_j += rotation.matrix() * link.inertia_l * rotation.matrix().transpose() + steiner * link.mass_kg;
    }
    SpatialInertia { mass_kg, com_j, inertia_j }
}
