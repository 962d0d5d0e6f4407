//! How well a grasp serves the pieces of a path.
//!
//! First an estimate by the posture map, in microseconds; then exactly: the grasp must be stable under the piece's load, and
//! the person's best response near the most promising postures is searched for. All 16 exact responses of a grasp take some
//! tenths of a second.

use nalgebra::Point3;
use rand_pcg::Pcg64;

use super::super::{
    assemble::{accepted, assemble_placed},
    candidate::{Candidate, Placement, WorkPose},
    evaluate::{self, Evaluator},
    library::{BoardGrasp, GraspLibrary, LibraryEntry, Posture, PostureMap},
    natural_boards::{entries_for_place, natural_entries},
    outcome::PlanError,
    params::{SearchBudget, one_hold::RESPONSE_STARTS},
    problem::{self, Problem},
    screen::{aligning_roll, standing_pose},
    stats::SearchStats,
    watch::{Event, Progress, Watch},
};
use crate::{
    comfort::{self, Response},
    human::{ArmAngles, Standing, peripersonal_m},
    model::{frames::Pose, plan::Plan, scenario::Scenario},
};

/// The problems of all pieces, and what their searches share.
pub struct PiecesProblem<'a> {
    pub library: &'a GraspLibrary,
    pub budget: SearchBudget,
    pub random: Pcg64,
    pub watch: &'a dyn Watch,
    evaluators: Vec<Evaluator<'a>>,
    /// The pieces that the search looks at.
    searched: Vec<usize>,
    postures: PostureMap,
    /// Responses that were searched for.
    evaluations: u64,
    /// The most that may be searched for.
    most_evaluations: u64,
}

/// A posture that may respond to a grasp at a piece.
#[derive(Clone, Copy)]
struct Estimate {
    posture: Posture,
    x_wb: Pose,
    /// Roll of the tool from the piece's operation, rad.
    roll_rad: f64,
    objective: f64,
}

/// The person's response to a grasp at a piece.
#[derive(Clone, Copy)]
pub struct PersonResponse {
    x_wb: Pose,
    q_h_rad: ArmAngles,
    /// Roll of the tool from the piece's operation, rad.
    roll_rad: f64,
    pub objective: f64,
}

impl PersonResponse {
    /// A response; its roll is counted from `roll_rad`.
    fn of(response: &Response, roll_rad: f64) -> Self {
        let Response { x_wb, q_rad, objective, .. } = *response;
        Self { x_wb, q_h_rad: q_rad, roll_rad: roll_rad + response.roll_rad(), objective }
    }
}

impl<'a> PiecesProblem<'a> {
    /// The problem of the pieces, of which the search looks at some; `None` if there are no pieces.
    pub fn new(
        pieces: &'a [Scenario],
        searched: &[usize],
        library: &'a GraspLibrary,
        watch: &'a dyn Watch,
    ) -> Result<Option<Self>, PlanError> {
        let evaluator = |scenario| {
            Ok(Evaluator::new(Problem::new(scenario, &library.robot, watch)?, SearchStats::unlimited(watch)))
        };
        let evaluators = pieces.iter().map(evaluator).collect::<Result<Vec<_>, PlanError>>()?;
        let Some(Evaluator { problem, .. }) = evaluators.first() else { return Ok(None) };
        let budget = SearchBudget::of(problem.scenario);
        // The posture map draws from stream 0.
        let random = Pcg64::new(u128::from(problem.scenario.planner.seed), 1);
        // Force and person are the same at all pieces, seen from the tool.
        let postures = problem::posture_map(problem.scenario, &problem.human, watch);
        let most_evaluations = problem.scenario.planner.evaluations.unwrap_or(u64::MAX);
        let searched = searched.to_vec();
        Ok(Some(Self {
            library,
            budget,
            random,
            watch,
            evaluators,
            searched,
            postures,
            evaluations: 0,
            most_evaluations,
        }))
    }

    /// Grasps of the boards that natural postures, or those of a person in the given place, ask for.
    pub fn natural_entries(&self) -> Vec<LibraryEntry> {
        let Some(Evaluator { problem, .. }) = self.evaluators.first() else { return Vec::new() };
        let count = self.budget.natural_boards;
        let mut entries =
            natural_entries(problem.scenario, &problem.human, problem.robot, &self.postures, count, self.watch);
        let share = count / self.searched.len().max(1);
        for &piece in &self.searched {
            let Problem { scenario, human, robot, .. } = &self.evaluators[piece].problem;
            entries.extend(entries_for_place(scenario, human, robot, &self.postures, share, self.watch));
        }
        entries
    }

    /// The estimated objective of a grasp at each searched piece; minus infinity if the map has no posture.
    pub fn estimates(&self, grasp: &BoardGrasp) -> Vec<f64> {
        let robot = &self.library.robot;
        let points = comfort::robot_points_w(&robot.robot, &robot.link_poses(&grasp.arms));
        let best = |&piece: &usize| {
            self.estimated(grasp, piece, &points).first().map_or(f64::NEG_INFINITY, |estimate| estimate.objective)
        };
        self.searched.iter().map(best).collect()
    }

    /// Replaces the estimates of searched pieces whose load the grasp does not resist by minus infinity.
    pub fn remove_unstable(&mut self, grasp: &BoardGrasp, estimates: &mut [f64]) {
        let candidate = Candidate::without_person(grasp);
        for (&piece, estimate) in self.searched.iter().zip(estimates) {
            if estimate.is_finite() && self.evaluators[piece].test_grasp(&candidate, &grasp.x_wo).is_err() {
                *estimate = f64::NEG_INFINITY;
            }
        }
    }

    /// Postures that nearly respond to a grasp at a piece, the best first.
    fn estimated(&self, grasp: &BoardGrasp, piece: usize, robot_points_w: &[Point3<f64>]) -> Vec<Estimate> {
        let problem = &self.evaluators[piece].problem;
        let operation = problem.scenario.operation;
        let floor_z_m = problem.robot.robot.floor_z_m;
        let settings = &problem.objective;
        let estimate = |posture: &Posture| {
            let roll_rad = aligning_roll(problem, &grasp.x_wo, &posture.x_bt);
            let x_wb = standing_pose(&(grasp.x_wo * operation.rolled(roll_rad).x_ot), &posture.x_bt, floor_z_m);
            let body_w = posture.medium_points_w(&x_wb);
            let distance_m = peripersonal_m(settings.peripersonal, settings.saturation_m, &body_w, robot_points_w);
            let objective = settings.weight_muscular * posture.muscular + settings.weight_peripersonal * distance_m;
            Estimate { posture: *posture, x_wb, roll_rad, objective }
        };
        let may_stand = |estimate: &Estimate| problem.human.may_stand(&Standing::of(&estimate.x_wb));
        let postures = self.postures.postures(&(grasp.x_wo * operation.x_ot), floor_z_m);
        let mut estimates: Vec<_> = postures.iter().map(estimate).filter(may_stand).collect();
        estimates.sort_by(|a, b| b.objective.total_cmp(&a.objective));
        estimates
    }

    /// True if the board is in the search domain and the arms and the board are clear of each other.
    pub fn is_clear(&self, grasp: &BoardGrasp) -> bool {
        let robot = &self.library.robot;
        robot.domain.contains(&grasp.x_wo) && robot.is_clear(grasp)
    }

    /// The person's response to a grasp at a piece if the grasp is stable there: the best near `known`, or else near the most
    /// promising postures of the map. `None` beyond the limit of evaluations and after a stop.
    pub fn response(
        &mut self,
        grasp: &BoardGrasp,
        piece: usize,
        known: Option<&PersonResponse>,
    ) -> Option<PersonResponse> {
        if self.evaluations >= self.most_evaluations || self.watch.is_stopped() {
            return None;
        }
        self.evaluations += 1;
        let candidate = Candidate::without_person(grasp);
        if self.evaluators[piece].test_grasp(&candidate, &grasp.x_wo).is_err() {
            return None;
        }
        let link_poses = self.library.robot.link_poses(&grasp.arms);
        let points_w = comfort::robot_points_w(&self.library.robot.robot, &link_poses);
        let near = |x_wb: &Pose, q_h_rad: &ArmAngles, roll_rad: f64| {
            let query = self.query(grasp, (piece, roll_rad), &link_poses, &points_w);
            comfort::response_near(&query, x_wb, q_h_rad).map(|found| PersonResponse::of(&found, roll_rad))
        };
        let near_known = known.and_then(|known| near(&known.x_wb, &known.q_h_rad, known.roll_rad));
        if near_known.is_some() {
            return near_known;
        }
        let estimates = self.estimated(grasp, piece, &points_w);
        let near_estimate =
            |Estimate { posture, x_wb, roll_rad, .. }: &Estimate| near(x_wb, &posture.q_h_rad, *roll_rad);
        let responses = estimates.iter().take(RESPONSE_STARTS).filter_map(near_estimate);
        responses.max_by(|a, b| a.objective.total_cmp(&b.objective))
    }

    /// The better of a response and the best of the whole grid; after a stop the response.
    pub fn best_response(&self, grasp: &BoardGrasp, piece: usize, known: PersonResponse) -> PersonResponse {
        let link_poses = self.library.robot.link_poses(&grasp.arms);
        let points_w = comfort::robot_points_w(&self.library.robot.robot, &link_poses);
        let found = comfort::best_response(&self.query(grasp, (piece, 0.0), &link_poses, &points_w));
        let found = found.map(|found| PersonResponse::of(&found, 0.0));
        found.filter(|found| found.objective > known.objective).unwrap_or(known)
    }

    /// The query for a piece with the tool rolled.
    fn query<'h>(
        &'h self,
        grasp: &BoardGrasp,
        (piece, roll_rad): (usize, f64),
        link_poses: &'h [Pose],
        robot_points_w: &'h [Point3<f64>],
    ) -> comfort::ResponseQuery<'h> {
        let problem = &self.evaluators[piece].problem;
        let operation = problem.scenario.operation.rolled(roll_rad);
        evaluate::response_query(problem, operation, link_poses, grasp.x_wo, robot_points_w)
    }

    /// The plan of a grasp with a response at a piece, if it is accepted.
    pub fn plan(&mut self, grasp: &BoardGrasp, piece: usize, response: &PersonResponse) -> Option<Plan> {
        let evaluations = self.evaluations;
        let robot = &self.library.robot;
        let points_w = comfort::robot_points_w(&robot.robot, &robot.link_poses(&grasp.arms));
        let evaluator = &mut self.evaluators[piece];
        let Problem { scenario, human, objective, .. } = &evaluator.problem;
        let &PersonResponse { x_wb, q_h_rad, roll_rad, .. } = response;
        let wrench_w = scenario.operation.rolled(roll_rad).wrench_w(&grasp.x_wo);
        let comfort = comfort::posture_comfort(human, objective, &points_w, &x_wb, &q_h_rad, &wrench_w);
        let mut candidate = Candidate::without_person(grasp);
        let heading_rad = x_wb.rotation.euler_angles().2;
        candidate.work = WorkPose { q_h_rad, heading_rad, roll_rad, ..candidate.work };
        let placement = Placement { x_wo: grasp.x_wo, x_wb };
        let plan = assemble_placed(evaluator, &candidate, &placement, &comfort, evaluations)?;
        accepted(evaluator, plan)
    }

    /// Seed of the search.
    pub fn seed(&self) -> u64 {
        self.evaluators.first().map_or(0, |evaluator| evaluator.problem.scenario.planner.seed)
    }

    /// Number of pieces.
    pub fn pieces(&self) -> usize {
        self.evaluators.len()
    }

    /// The pieces that the search looks at.
    pub fn searched(&self) -> &[usize] {
        &self.searched
    }

    /// True if the limit of evaluations is reached or the watch stops the search, which it is told of.
    pub fn is_exhausted(&self) -> bool {
        self.watch.tell(&Event::Search(Progress { evaluations: self.evaluations, better: None }));
        self.evaluations >= self.most_evaluations || self.watch.is_stopped()
    }
}

/// A grasp with the person's responses to it.
#[derive(Clone)]
pub struct Coverage {
    pub grasp: BoardGrasp,
    /// The response at each searched piece; `None` where the piece is not served.
    pub responses: Vec<Option<PersonResponse>>,
    pub score: Score,
}

impl Coverage {
    /// The coverage of a grasp with these responses.
    pub fn new(grasp: BoardGrasp, responses: Vec<Option<PersonResponse>>) -> Self {
        let objectives = responses.iter().map(|response| response.map_or(f64::NAN, |response| response.objective));
        let score = Score::of(objectives);
        Self { grasp, responses, score }
    }
}

/// How many pieces are served and the least objective of those: more pieces come first.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Score {
    pub served: usize,
    pub least: f64,
}

impl Score {
    /// The score of the objectives at the pieces; one that is not finite is not served.
    pub fn of(objectives: impl Iterator<Item = f64>) -> Self {
        let nothing = Self { served: 0, least: f64::INFINITY };
        objectives
            .filter(|objective| objective.is_finite())
            .fold(nothing, |score, objective| Self { served: score.served + 1, least: score.least.min(objective) })
    }

    /// The better first.
    pub fn order(&self, other: &Self) -> std::cmp::Ordering {
        other.served.cmp(&self.served).then(other.least.total_cmp(&self.least))
    }
}
