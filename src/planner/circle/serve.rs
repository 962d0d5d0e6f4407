//! How well a hold serves each point of the circle.
//!
//! First by the person's map, in microseconds and roughly; then exactly: the hold must stand the point's cut, and the
//! person's best answer near the most promising postures is looked for. Whoever asks for all 16 exact answers of a hold pays
//! some tenths of a second.

use nalgebra::{Isometry3, Point3};
use rand_pcg::Pcg64;

use super::super::{
    Effort, Onlooker, Problem, Progress, RobotMap, Watch, assemble_placed, assess,
    bank::KnownHold,
    candidate::{Candidate, Placed},
    person_map::{PersonMap, Posture},
    propose::standing,
    verify,
};
use crate::{
    comfort::{self, Answer},
    human::{HumanError, peripersonal_m},
    model::{frames::Pose, plan::Plan, scenario::Scenario},
};

/// Postures of the map from which an exact answer is looked for.
const STARTS: usize = 3;

/// What all searches for one circle share.
pub struct Circle<'a> {
    pub map: &'a RobotMap,
    pub effort: Effort,
    pub random: Pcg64,
    problems: Vec<Problem<'a>>,
    person: PersonMap,
    evaluations: u64,
}

/// A posture that may answer a hold at a point.
#[derive(Clone, Copy)]
struct Guess {
    posture: Posture,
    x_wb: Pose,
    worth: f64,
}

impl<'a> Circle<'a> {
    /// The circle of these points; none when there are none.
    pub fn new(points: &'a [Scenario], map: &'a RobotMap) -> Result<Option<Self>, HumanError> {
        let problem = |scenario| Problem::new(scenario, map, Watch::unseen());
        let mut problems = points.iter().map(problem).collect::<Result<Vec<_>, _>>()?;
        let Some(first) = problems.first_mut() else { return Ok(None) };
        let effort = Effort::of(first.scenario.planner.budget);
        // The person's map draws from the first stream.
        let random = Pcg64::new(u128::from(first.scenario.planner.seed), 1);
        // The knife's force and the person are the same at all points, seen from the tool.
        let person = PersonMap::of(first.scenario, &first.human);
        Ok(Some(Self { map, effort, random, problems, person, evaluations: 0 }))
    }

    /// What each point is worth under a hold, roughly; minus infinity where the map knows no answer.
    pub fn estimates(&self, hold: &KnownHold) -> Vec<f64> {
        let points = comfort::robot_points_w(&self.map.robot, &self.map.link_poses(&hold.holds));
        let best = |point| self.guesses(hold, point, &points).first().map_or(f64::NEG_INFINITY, |guess| guess.worth);
        (0..self.problems.len()).map(best).collect()
    }

    /// Minus infinity in place of the estimate of every point whose cut the hold does not stand.
    pub fn strike_unstable(&mut self, hold: &KnownHold, estimates: &mut [f64]) {
        let candidate = candidate(hold, None);
        for (problem, estimate) in self.problems.iter_mut().zip(estimates) {
            if estimate.is_finite() && assess::utilisation(problem, &candidate, &hold.x_wo) > 1.0 {
                *estimate = f64::NEG_INFINITY;
            }
        }
    }

    /// Postures that nearly answer a hold at a point, the best first.
    fn guesses(&self, hold: &KnownHold, point: usize, robot_points_w: &[Point3<f64>]) -> Vec<Guess> {
        let problem = &self.problems[point];
        let x_wt = hold.x_wo * problem.scenario.operation.x_ot;
        let floor_z_m = self.map.robot.floor_z_m;
        let settings = &problem.objective;
        let guess = |posture: &Posture| {
            let x_wb = standing(&x_wt, &posture.x_bt, floor_z_m);
            let body = posture.sketch_w(&x_wb);
            let distance_m = peripersonal_m(settings.peripersonal, settings.saturation_m, &body, robot_points_w);
            let worth = settings.weight_muscular * posture.muscular + settings.weight_peripersonal * distance_m;
            Guess { posture: *posture, x_wb, worth }
        };
        let mut guesses: Vec<_> = self.person.postures(&x_wt, floor_z_m).iter().map(guess).collect();
        guesses.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        guesses
    }

    /// True when the arms and the board are clear of each other in a place where boards may be.
    pub fn is_clear(&self, hold: &KnownHold) -> bool {
        let poses = self.map.link_poses(&hold.holds);
        assess::in_domain(&hold.x_wo)
            && self.map.collision.first_violation(&self.map.scene(&poses, hold.x_wo)).is_none()
    }

    /// The person's answer to a hold at a point, when the hold stands that point's cut: the best near `known`, or else near
    /// the most promising postures of the map. Its objective is what the hold is worth there.
    pub fn answer(&mut self, hold: &KnownHold, point: usize, known: Option<&Answer>) -> Option<Answer> {
        self.evaluations += 1;
        let candidate = candidate(hold, None);
        if assess::utilisation(&mut self.problems[point], &candidate, &hold.x_wo) > 1.0 {
            return None;
        }
        let poses = self.map.link_poses(&hold.holds);
        let robot_points_w = comfort::robot_points_w(&self.map.robot, &poses);
        let asked = self.asked(hold, point, &poses, &robot_points_w);
        let again = known.and_then(|known| comfort::near(&asked, &known.x_wb, &known.q_rad));
        if again.is_some() {
            return again;
        }
        let guesses = self.guesses(hold, point, &robot_points_w);
        let answers =
            guesses.iter().take(STARTS).filter_map(|guess| comfort::near(&asked, &guess.x_wb, &guess.posture.q_h_rad));
        answers.max_by(|a, b| a.objective.total_cmp(&b.objective))
    }

    /// The better of an answer and the best of the whole grid of answers.
    pub fn best_answer(&self, hold: &KnownHold, point: usize, known: Answer) -> Answer {
        let poses = self.map.link_poses(&hold.holds);
        let robot_points_w = comfort::robot_points_w(&self.map.robot, &poses);
        let found = comfort::most(&self.asked(hold, point, &poses, &robot_points_w));
        found.filter(|found| found.objective > known.objective).unwrap_or(known)
    }

    fn asked<'h>(
        &'h self,
        hold: &KnownHold,
        point: usize,
        link_poses: &'h [Pose],
        robot_points_w: &'h [Point3<f64>],
    ) -> comfort::Hold<'h> {
        let problem = &self.problems[point];
        comfort::Hold {
            human: &problem.human,
            collision: &self.map.collision,
            settings: problem.objective,
            operation: problem.scenario.operation,
            floor_z_m: self.map.robot.floor_z_m,
            robot_points_w,
            scene: self.map.scene(link_poses, hold.x_wo),
        }
    }

    /// The plan of a hold with an answer at a point, when the check from scratch confirms it.
    pub fn plan(&mut self, hold: &KnownHold, point: usize, answer: &Answer) -> Result<Option<Plan>, HumanError> {
        let evaluations = self.evaluations;
        let problem = &mut self.problems[point];
        let candidate = candidate(hold, Some(answer));
        let surface = comfort::robot_points_w(&self.map.robot, &self.map.link_poses(&hold.holds));
        let wrench_w = problem.scenario.operation.wrench_w(&hold.x_wo);
        let comfort =
            comfort::of_posture(&problem.human, &problem.objective, &surface, &answer.x_wb, &answer.q_rad, &wrench_w);
        let placed = Placed { x_wo: hold.x_wo, x_wb: answer.x_wb };
        let Some(plan) = assemble_placed(problem, &candidate, &placed, &comfort, evaluations) else { return Ok(None) };
        Ok(verify(&plan, problem.scenario, &self.map.robot)?.is_empty().then_some(plan))
    }

    /// The search's seed.
    pub fn seed(&self) -> u64 {
        self.problems.first().map_or(0, |problem| problem.scenario.planner.seed)
    }

    /// How many points there are.
    pub fn points(&self) -> usize {
        self.problems.len()
    }

    /// True when the onlooker asks for an end.
    pub fn is_stopped(&self, onlooker: &mut Onlooker<'_>) -> bool {
        onlooker(&Progress { evaluations: self.evaluations, better: None }).is_break()
    }
}

/// The hold as a candidate, with a person or with nobody.
fn candidate(hold: &KnownHold, answer: Option<&Answer>) -> Candidate {
    let p_wo = hold.x_wo.translation.vector;
    Candidate {
        q_h_rad: answer.map_or([0.0; 7], |answer| answer.q_rad),
        heading_rad: answer.map_or(0.0, |answer| answer.x_wb.rotation.euler_angles().2),
        roll_rad: 0.0,
        p_wo_xy_m: [p_wo.x, p_wo.y],
        holds: hold.holds.clone(),
    }
}

/// A hold with the person's answers to it.
#[derive(Clone)]
pub struct Served {
    pub hold: KnownHold,
    /// The answer at each point; none where the point is not served.
    pub answers: Vec<Option<Answer>>,
    pub score: Score,
}

impl Served {
    /// A hold with these answers.
    pub fn new(hold: KnownHold, answers: Vec<Option<Answer>>) -> Self {
        let score = Score::of(answers.iter().map(|answer| answer.map_or(f64::NAN, |answer| answer.objective)));
        Self { hold, answers, score }
    }
}

/// How many points are served and what the worst of them is worth: more points first.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Score {
    pub served: usize,
    pub worst: f64,
}

impl Score {
    /// Of what each point is worth; what is not finite is not served.
    pub fn of(worths: impl Iterator<Item = f64>) -> Self {
        worths.filter(|worth| worth.is_finite()).fold(Self { served: 0, worst: f64::INFINITY }, |score, worth| Self {
            served: score.served + 1,
            worst: score.worst.min(worth),
        })
    }

    /// The better first.
    pub fn order(&self, other: &Self) -> std::cmp::Ordering {
        other.served.cmp(&self.served).then(other.worst.total_cmp(&self.worst))
    }
}

/// A board pose turned and shifted about the board's own centre.
pub fn nudged(x_wo: &Pose, shift_w_m: nalgebra::Vector3<f64>, turn_o_rad: nalgebra::Vector3<f64>) -> Pose {
    let rotation = x_wo.rotation * nalgebra::UnitQuaternion::from_scaled_axis(turn_o_rad);
    Isometry3::from_parts((x_wo.translation.vector + shift_w_m).into(), rotation)
}
