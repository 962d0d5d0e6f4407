//! How well a grasp covers the points of a circle.
//!
//! First an estimate by the posture map, in microseconds; then exactly: the grasp must be stable under the point's load, and
//! the person's best response near the most promising postures is searched for. All 16 exact responses of a grasp take some
//! tenths of a second.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rand_pcg::Pcg64;

use super::super::{
    assemble::{accepted, assemble_placed},
    candidate::{Candidate, Placement, WorkPose},
    evaluate::{self, Evaluator},
    library::{BoardGrasp, GraspLibrary, LibraryEntry, Posture, PostureMap},
    natural_boards::{entries_for_place, natural_entries},
    outcome::PlanError,
    params::{SearchBudget, path::RESPONSE_STARTS},
    problem::{self, Problem},
    screen::standing_pose,
    stats::SearchStats,
    watch::{Event, Progress, Watch},
};
use crate::{
    comfort::{self, Response},
    human::{Standing, peripersonal_m},
    model::{frames::Pose, plan::Plan, scenario::Scenario},
};

/// The problems of all points, and what their searches share.
pub struct PathProblem<'a> {
    pub library: &'a GraspLibrary,
    pub budget: SearchBudget,
    pub random: Pcg64,
    evaluators: Vec<Evaluator<'a>>,
    postures: PostureMap,
    /// Responses that were searched for.
    evaluations: u64,
    /// The number of them at which the present search ends.
    last_evaluation: u64,
    pub watch: &'a dyn Watch,
}

/// A posture that may respond to a grasp at a point.
#[derive(Clone, Copy)]
struct Estimate {
    posture: Posture,
    x_wb: Pose,
    objective: f64,
}

impl<'a> PathProblem<'a> {
    /// The problem of the points; `None` if there are none.
    pub fn new(
        points: &'a [Scenario],
        library: &'a GraspLibrary,
        watch: &'a dyn Watch,
    ) -> Result<Option<Self>, PlanError> {
        let evaluator = |scenario| {
            Ok(Evaluator::new(Problem::new(scenario, &library.robot, watch)?, SearchStats::unlimited(watch)))
        };
        let evaluators = points.iter().map(evaluator).collect::<Result<Vec<_>, PlanError>>()?;
        let Some(Evaluator { problem, .. }) = evaluators.first() else { return Ok(None) };
        let budget = SearchBudget::of(problem.scenario);
        // The posture map draws from stream 0.
        let random = Pcg64::new(u128::from(problem.scenario.planner.seed), 1);
        // Force and person are the same at all points, seen from the tool.
        let postures = problem::posture_map(problem.scenario, &problem.human, watch);
        Ok(Some(Self { library, budget, random, evaluators, postures, evaluations: 0, last_evaluation: 0, watch }))
    }

    /// Grasps of the boards that natural postures, or those of a person in the given place, ask for.
    pub fn natural_entries(&self) -> Vec<LibraryEntry> {
        let Some(Evaluator { problem, .. }) = self.evaluators.first() else { return Vec::new() };
        let count = self.budget.natural_boards;
        let mut entries =
            natural_entries(problem.scenario, &problem.human, problem.robot, &self.postures, count, self.watch);
        let share = count / self.evaluators.len();
        for Evaluator { problem: Problem { scenario, human, robot, .. }, .. } in &self.evaluators {
            entries.extend(entries_for_place(scenario, human, robot, &self.postures, share, self.watch));
        }
        entries
    }

    /// Begins a search: the scenario's limit of evaluations applies to each one.
    pub fn begin_search(&mut self) {
        let limit = self.evaluators.first().and_then(|first| first.problem.scenario.planner.evaluations);
        self.last_evaluation = self.evaluations.saturating_add(limit.unwrap_or(u64::MAX));
    }

    /// The estimated objective of a grasp at each point; minus infinity if the map has no posture.
    pub fn estimates(&self, grasp: &BoardGrasp) -> Vec<f64> {
        let robot = &self.library.robot;
        let points = comfort::robot_points_w(&robot.robot, &robot.link_poses(&grasp.arms));
        let best = |point| {
            self.estimated(grasp, point, &points).first().map_or(f64::NEG_INFINITY, |estimate| estimate.objective)
        };
        (0..self.evaluators.len()).map(best).collect()
    }

    /// Replaces the estimates of points whose load the grasp does not resist by minus infinity.
    pub fn remove_unstable(&mut self, grasp: &BoardGrasp, estimates: &mut [f64]) {
        let candidate = Candidate::without_person(grasp);
        for (evaluator, estimate) in self.evaluators.iter_mut().zip(estimates) {
            if estimate.is_finite() && evaluator.test_grasp(&candidate, &grasp.x_wo).is_err() {
                *estimate = f64::NEG_INFINITY;
            }
        }
    }

    /// Postures that nearly respond to a grasp at a point, the best first.
    fn estimated(&self, grasp: &BoardGrasp, point: usize, robot_points_w: &[Point3<f64>]) -> Vec<Estimate> {
        let problem = &self.evaluators[point].problem;
        let x_wt = grasp.x_wo * problem.scenario.operation.x_ot;
        let floor_z_m = problem.robot.robot.floor_z_m;
        let settings = &problem.objective;
        let estimate = |posture: &Posture| {
            let x_wb = standing_pose(&x_wt, &posture.x_bt, floor_z_m);
            let body_w = posture.medium_points_w(&x_wb);
            let distance_m = peripersonal_m(settings.peripersonal, settings.saturation_m, &body_w, robot_points_w);
            let objective = settings.weight_muscular * posture.muscular + settings.weight_peripersonal * distance_m;
            Estimate { posture: *posture, x_wb, objective }
        };
        let may_stand = |estimate: &Estimate| problem.human.may_stand(&Standing::of(&estimate.x_wb));
        let mut estimates: Vec<_> =
            self.postures.postures(&x_wt, floor_z_m).iter().map(estimate).filter(may_stand).collect();
        estimates.sort_by(|a, b| b.objective.total_cmp(&a.objective));
        estimates
    }

    /// True if the board is in the search domain and the arms and the board are clear of each other.
    pub fn is_clear(&self, grasp: &BoardGrasp) -> bool {
        let robot = &self.library.robot;
        robot.domain.contains(&grasp.x_wo) && robot.is_clear(grasp)
    }

    /// The person's response to a grasp at a point if the grasp is stable there: the best near `known`, or else near the most
    /// promising postures of the map. `None` beyond the limit of evaluations and after a stop.
    pub fn response(&mut self, grasp: &BoardGrasp, point: usize, known: Option<&Response>) -> Option<Response> {
        if self.evaluations >= self.last_evaluation || self.watch.is_stopped() {
            return None;
        }
        self.evaluations += 1;
        let candidate = Candidate::without_person(grasp);
        if self.evaluators[point].test_grasp(&candidate, &grasp.x_wo).is_err() {
            return None;
        }
        let link_poses = self.library.robot.link_poses(&grasp.arms);
        let points_w = comfort::robot_points_w(&self.library.robot.robot, &link_poses);
        let query = self.query(grasp, point, &link_poses, &points_w);
        let near_known = known.and_then(|known| comfort::response_near(&query, &known.x_wb, &known.q_rad));
        if near_known.is_some() {
            return near_known;
        }
        let estimates = self.estimated(grasp, point, &points_w);
        let near = |estimate: &Estimate| comfort::response_near(&query, &estimate.x_wb, &estimate.posture.q_h_rad);
        let responses = estimates.iter().take(RESPONSE_STARTS).filter_map(near);
        responses.max_by(|a, b| a.objective.total_cmp(&b.objective))
    }

    /// The better of a response and the best of the whole grid; after a stop the response.
    pub fn best_response(&self, grasp: &BoardGrasp, point: usize, known: Response) -> Response {
        let link_poses = self.library.robot.link_poses(&grasp.arms);
        let points_w = comfort::robot_points_w(&self.library.robot.robot, &link_poses);
        let found = comfort::best_response(&self.query(grasp, point, &link_poses, &points_w));
        found.filter(|found| found.objective > known.objective).unwrap_or(known)
    }

    fn query<'h>(
        &'h self,
        grasp: &BoardGrasp,
        point: usize,
        link_poses: &'h [Pose],
        robot_points_w: &'h [Point3<f64>],
    ) -> comfort::ResponseQuery<'h> {
        let problem = &self.evaluators[point].problem;
        evaluate::response_query(problem, problem.scenario.operation, link_poses, grasp.x_wo, robot_points_w)
    }

    /// The plan of a grasp with a response at a point, if it is accepted.
    pub fn plan(&mut self, grasp: &BoardGrasp, point: usize, response: &Response) -> Option<Plan> {
        let evaluations = self.evaluations;
        let robot = &self.library.robot;
        let points_w = comfort::robot_points_w(&robot.robot, &robot.link_poses(&grasp.arms));
        let evaluator = &mut self.evaluators[point];
        let Problem { scenario, human, objective, .. } = &evaluator.problem;
        let wrench_w = scenario.operation.wrench_w(&grasp.x_wo);
        let comfort = comfort::posture_comfort(human, objective, &points_w, &response.x_wb, &response.q_rad, &wrench_w);
        let mut candidate = Candidate::without_person(grasp);
        let heading_rad = response.x_wb.rotation.euler_angles().2;
        candidate.work = WorkPose { q_h_rad: response.q_rad, heading_rad, ..candidate.work };
        let placement = Placement { x_wo: grasp.x_wo, x_wb: response.x_wb };
        let plan = assemble_placed(evaluator, &candidate, &placement, &comfort, evaluations)?;
        accepted(evaluator, plan)
    }

    /// Seed of the search.
    pub fn seed(&self) -> u64 {
        self.evaluators.first().map_or(0, |evaluator| evaluator.problem.scenario.planner.seed)
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.evaluators.len()
    }

    /// True if the limit of evaluations is reached or the watch stops the search, which it is told of.
    pub fn is_exhausted(&self) -> bool {
        self.watch.tell(&Event::Search(Progress { evaluations: self.evaluations, better: None }));
        self.evaluations >= self.last_evaluation || self.watch.is_stopped()
    }
}

/// A grasp with the person's responses to it.
#[derive(Clone)]
pub struct Coverage {
    pub grasp: BoardGrasp,
    /// The response at each point; `None` where the point is not covered.
    pub responses: Vec<Option<Response>>,
    pub score: Score,
}

impl Coverage {
    /// The coverage of a grasp with these responses.
    pub fn new(grasp: BoardGrasp, responses: Vec<Option<Response>>) -> Self {
        let objectives = responses.iter().map(|response| response.map_or(f64::NAN, |response| response.objective));
        let score = Score::of(objectives);
        Self { grasp, responses, score }
    }
}

/// How many points are covered and the least objective of those: more points come first.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Score {
    pub covered: usize,
    pub worst: f64,
}

impl Score {
    /// The score of the objectives at the points; one that is not finite is not covered.
    pub fn of(objectives: impl Iterator<Item = f64>) -> Self {
        let none = Self { covered: 0, worst: f64::INFINITY };
        objectives
            .filter(|objective| objective.is_finite())
            .fold(none, |score, objective| Self { covered: score.covered + 1, worst: score.worst.min(objective) })
    }

    /// The better first.
    pub fn order(&self, other: &Self) -> std::cmp::Ordering {
        other.covered.cmp(&self.covered).then(other.worst.total_cmp(&self.worst))
    }
}

/// A board pose turned and shifted about the board's centre.
pub fn displaced(x_wo: &Pose, shift_w_m: Vector3<f64>, turn_o_rad: Vector3<f64>) -> Pose {
    let rotation = x_wo.rotation * UnitQuaternion::from_scaled_axis(turn_o_rad);
    Isometry3::from_parts((x_wo.translation.vector + shift_w_m).into(), rotation)
}
