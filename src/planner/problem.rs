//! The problem that a search solves: task, person, robot and objective.

use nalgebra::Vector3;

use crate::{
    human::{Human, Standing, standing_pose_w},
    model::{
        frames::Pose,
        operation::Operation,
        scenario::{ComfortSettings, Limits, Scenario, StabilityKind},
        stop::Stop,
        wrench::Wrench,
    },
};

use super::{
    library::{ArmGrasp, GraspingRobot, PostureLoad, PostureMap},
    outcome::PlanError,
    params::{
        COMPLIANT_SAFETY_FACTOR, SearchBudget,
        refine::{GRASP, STEP_TOLERANCE},
    },
    watch::Watch,
};

/// Rounding of a joint at the end of its motion, rad or m.
const ROUNDING_RAD: f64 = 1e-9;

/// The robot's joints that a search may use, from where they are.
#[derive(Clone, Debug)]
pub struct Reachable {
    /// Where the joints of each arm are, rad or m.
    pub from_rad: Vec<Vec<f64>>,
    /// The most that each may move, rad or m.
    pub most_rad: f64,
}

/// What is the same for all candidates of one search.
pub struct Problem<'a> {
    pub scenario: &'a Scenario,
    pub robot: &'a GraspingRobot,
    pub human: Human,
    /// What the search maximises: the scenario's comfort with the weights of its planner.
    pub objective: ComfortSettings,
    /// The operation's wrench about the tool tip, T axes: it does not change with the candidate.
    pub wrench_t: Wrench,
    /// The worked face's normal, T axes: it does not change either.
    pub normal_t: Vector3<f64>,
    /// How far the robot's joints may move; `None` if that is not limited.
    pub reachable: Option<Reachable>,
    /// Scales of the variables of a grasp, see [`super::params::refine::GRASP`]; zero if the grasps are to stay as they are.
    pub grasp_scales: [f64; 3],
    /// Ends what takes long.
    pub stop: &'a dyn Stop,
}

impl<'a> Problem<'a> {
    /// The problem of a scenario.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid.
    pub fn new(scenario: &'a Scenario, robot: &'a GraspingRobot, stop: &'a dyn Stop) -> Result<Self, PlanError> {
        Ok(Self {
            scenario,
            robot,
            human: Human::new(&scenario.human, &scenario.tool)?,
            objective: scenario.planner.kind.objective(scenario.comfort),
            wrench_t: wrench_t(&scenario.operation),
            normal_t: scenario.operation.face_normal_t(scenario.object.size_m[2]),
            reachable: None,
            grasp_scales: GRASP,
            stop,
        })
    }

    /// The standing pose nearest to another at which the person may stand.
    pub fn as_given(&self, x_wb: Pose) -> Pose {
        let standing = Standing::of(&x_wb);
        if self.human.may_stand(&standing) {
            return x_wb;
        }
        let Standing { p_wb_m: [x_m, y_m], heading_rad } = self.human.standing_nearest_to(&standing);
        standing_pose_w(x_m, y_m, heading_rad, self.robot.robot.floor_z_m)
    }

    /// The range of an arm's joint, rad or m: its limits and, if the motion is limited, what it reaches from where it is.
    pub fn joint_range(&self, arm: usize, joint: usize) -> [f64; 2] {
        let chain = &self.robot.arms[arm].chain;
        let limits = [chain.lower()[joint], chain.upper()[joint]];
        let Some(Reachable { from_rad, most_rad }) = &self.reachable else { return limits };
        let here_rad = from_rad[arm][joint];
        // A step may miss its margins by a little, and the limit of the motion is exact.
        let most_rad = (most_rad - STEP_TOLERANCE).max(0.0);
        [limits[0].max(here_rad - most_rad), limits[1].min(here_rad + most_rad)]
    }

    /// True if the motion is not limited, or no joint of the arms moves farther than it may.
    pub fn is_reachable(&self, arms: &[ArmGrasp]) -> bool {
        self.reachable.as_ref().is_none_or(|Reachable { from_rad, most_rad }| {
            let pairs = arms.iter().zip(from_rad).flat_map(|(arm, from_rad)| arm.q_rad.iter().zip(from_rad));
            pairs.into_iter().all(|(q, from)| (q - from).abs() <= most_rad + ROUNDING_RAD)
        })
    }

    /// The limits of stability, safety factor included.
    pub fn stability_limits(&self) -> Limits {
        let Scenario { limits, planner, .. } = self.scenario;
        let factor = if planner.stability == StabilityKind::Compliant { COMPLIANT_SAFETY_FACTOR } else { 1.0 };
        Limits { load_factor: factor * limits.load_factor, torque_ratio: limits.torque_ratio / factor, ..*limits }
    }
}

/// An operation's wrench about the tool tip, T axes.
pub fn wrench_t(operation: &Operation) -> Wrench {
    let to_tool = operation.x_ot.rotation.inverse();
    Wrench::new(to_tool * operation.wrench_o.force_n, to_tool * operation.wrench_o.moment_nm)
}

/// The posture map of a scenario's person; after a stop it is not complete.
pub fn posture_map(scenario: &Scenario, human: &Human, watch: &dyn Watch) -> PostureMap {
    posture_map_of(scenario, human, &SearchBudget::of(scenario), watch)
}

/// The posture map of a scenario's person, as large as a budget says.
pub fn posture_map_of(scenario: &Scenario, human: &Human, budget: &SearchBudget, watch: &dyn Watch) -> PostureMap {
    let operation = &scenario.operation;
    PostureMap::new(
        human,
        &PostureLoad {
            wrench_t: wrench_t(operation),
            normal_t: operation.face_normal_t(scenario.object.size_m[2]),
            roll_is_free: operation.kind.roll_is_free(),
        },
        &scenario.planner.kind.objective(scenario.comfort),
        budget,
        scenario.planner.seed,
        watch,
    )
}
