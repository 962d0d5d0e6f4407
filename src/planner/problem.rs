//! The problem that a search solves: task, person, robot and objective.

use nalgebra::Vector3;

use crate::{
    human::Human,
    model::{
        operation::Operation,
        scenario::{ComfortSettings, Limits, Scenario, StabilityKind},
        stop::Stop,
        wrench::Wrench,
    },
};

use super::{
    library::{GraspingRobot, PostureLoad, PostureMap},
    outcome::PlanError,
    params::{COMPLIANT_SAFETY_FACTOR, SearchBudget},
    watch::Watch,
};

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
            stop,
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
