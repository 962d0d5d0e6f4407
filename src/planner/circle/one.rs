//! One hold for the whole circle: as many points as can be, and then the worst of them as comfortable as can be.
//!
//! Every hold of the robot's bank is valued at all points by the person's map, the best of them by what they stand, too;
//! boards that lean like theirs are held anew in other places. The most promising of both are rated exactly; the best few
//! of them climb by random steps of board, grasps and elbows that shrink while none is better. That is a local search from
//! a few starts: it does not prove that no hold serves more points or serves them better.

use nalgebra::Vector3;

use super::{
    super::{
        Onlooker, assess,
        bank::{BankedHold, KnownHold},
        candidate::Hold,
        focus,
        propose::{ANGLE_RAD, DEPTH_M, uniform},
    },
    serve::{Circle, Score, Served, nudged},
};
use crate::comfort::Answer;

/// Holds of the bank that are rated exactly for each start of a plan's search.
const RATED_A_START: usize = 4;
/// Boards of the best guesses that are held anew in other places.
const BOARDS: usize = 80;
/// Random steps of a climb for each last step of a plan's search.
const TRIES_A_STEP: usize = 8;
/// The largest step: shift of the board, m, and its turn, rad.
const SHIFT_M: f64 = 0.06;
const TURN_RAD: f64 = 0.25;
/// Of the grasps: along the edge, m, depth, m, angle, rad; and of the arms' joints before they follow the hand, rad.
const GRASP: [f64; 3] = [0.04, 0.01, 0.2];
const JOINTS_RAD: f64 = 0.2;
/// How a step's scale changes after one that is better, and after one that is not.
const WIDER: f64 = 1.3;
const NARROWER: f64 = 0.96;

/// The best holds that are found for all points, the best first; each climbed to.
pub fn holds(circle: &mut Circle<'_>, onlooker: &mut Onlooker<'_>) -> Vec<Served> {
    let mut starts = promising(circle, onlooker);
    starts.truncate(circle.effort.circle_climbs);
    let mut climbed: Vec<_> = starts.into_iter().map(|start| climb(circle, start, onlooker)).collect();
    climbed.sort_by(|a, b| a.score.order(&b.score));
    climbed
}

/// Holds that serve the circle best, rated exactly, the best first: of the bank, and of boards that lean like the best of
/// the bank wherever they may be.
fn promising(circle: &mut Circle<'_>, onlooker: &mut Onlooker<'_>) -> Vec<Served> {
    let map = circle.map;
    let mut guessed = best_guesses(circle, &map.bank, onlooker);
    let boards: Vec<_> = guessed.iter().take(BOARDS).map(|(_, hold)| hold.x_wo).collect();
    let focus = focus::holds(map, &boards, circle.effort.circle_places, [circle.seed(), 1]);
    guessed.extend(best_guesses(circle, &focus, onlooker));
    guessed.sort_by(|a, b| a.0.order(&b.0));
    let mut served = Vec::new();
    for (_, hold) in guessed.into_iter().take(RATED_A_START * circle.effort.starts) {
        if circle.is_stopped(onlooker) {
            break;
        }
        let answers = (0..circle.points()).map(|point| circle.answer(hold, point, None)).collect();
        served.push(Served::new(hold.clone(), answers));
    }
    served.retain(|served| served.score.served > 0);
    served.sort_by(|a, b| a.score.order(&b.score));
    served
}

/// Of some holds those that look best by the person's map, ordered by that and by what they stand, which costs a hundred
/// times as much to say.
fn best_guesses<'b>(
    circle: &mut Circle<'_>,
    holds: &'b [BankedHold],
    onlooker: &mut Onlooker<'_>,
) -> Vec<(Score, &'b KnownHold)> {
    let rough = |BankedHold { hold, .. }: &'b BankedHold| {
        let estimates = circle.estimates(hold);
        (Score::of(estimates.iter().copied()), hold, estimates)
    };
    let mut guessed: Vec<_> = holds.iter().map(rough).collect();
    guessed.sort_by(|a, b| a.0.order(&b.0));
    guessed.truncate(circle.effort.circle_guesses);
    for (score, hold, estimates) in &mut guessed {
        if circle.is_stopped(onlooker) {
            break;
        }
        circle.strike_unstable(hold, estimates);
        *score = Score::of(estimates.iter().copied());
    }
    let mut guessed: Vec<_> = guessed.into_iter().map(|(score, hold, _)| (score, hold)).collect();
    guessed.sort_by(|a, b| a.0.order(&b.0));
    guessed
}

fn climb(circle: &mut Circle<'_>, mut here: Served, onlooker: &mut Onlooker<'_>) -> Served {
    let mut scale = 1.0_f64;
    for _ in 0..TRIES_A_STEP * circle.effort.circle_steps {
        if circle.is_stopped(onlooker) {
            break;
        }
        let better = moved(circle, &here.hold, scale).and_then(|hold| better(circle, hold, &here));
        scale = if better.is_some() { (WIDER * scale).min(1.0) } else { NARROWER * scale };
        here = better.unwrap_or(here);
    }
    here
}

/// A hold near another that the arms can take without touching anything.
fn moved(circle: &mut Circle<'_>, from: &KnownHold, scale: f64) -> Option<KnownHold> {
    let map = circle.map;
    let random = &mut circle.random;
    let mut within = |most: f64| uniform(random, -scale * most, scale * most);
    let shift = Vector3::from_fn(|_, _| within(SHIFT_M));
    let turn = Vector3::from_fn(|_, _| within(TURN_RAD));
    let x_wo = nudged(&from.x_wo, shift, turn);
    let mut holds = Vec::with_capacity(from.holds.len());
    for (arm, hold) in map.arms.iter().zip(&from.holds) {
        let mut grasp = hold.grasp;
        grasp.along_m += within(GRASP[0]);
        grasp.depth_m = (grasp.depth_m + within(GRASP[1])).clamp(DEPTH_M[0], DEPTH_M[1]);
        grasp.angle_rad = (grasp.angle_rad + within(GRASP[2])).clamp(ANGLE_RAD[0], ANGLE_RAD[1]);
        let seed: Vec<_> = hold.q_rad.iter().map(|q| q + within(JOINTS_RAD)).collect();
        if !assess::pads_on_board(&map.robot.arms[arm.index].gripper, &grasp, map.size_m) {
            return None;
        }
        holds.push(Hold { grasp, q_rad: arm.inverse.local(&(x_wo * grasp.x_og(map.size_m)), &seed).found()? });
    }
    let moved = KnownHold { x_wo, holds };
    circle.is_clear(&moved).then_some(moved)
}

/// A hold with its answers when it is better than another; the points that decide are asked first.
fn better(circle: &mut Circle<'_>, hold: KnownHold, than: &Served) -> Option<Served> {
    let worth = |answer: &Option<Answer>| answer.map_or(f64::INFINITY, |answer| answer.objective);
    let mut order: Vec<_> = (0..circle.points()).collect();
    order.sort_by(|&a, &b| worth(&than.answers[a]).total_cmp(&worth(&than.answers[b])));
    let mut answers = vec![None; order.len()];
    let mut hopes = order.len();
    for point in order {
        let answer = circle.answer(&hold, point, than.answers[point].as_ref());
        hopes -= usize::from(answer.is_none());
        // What serves fewer points, or as many and one of them worse than the worst, is not better.
        let too_few = hopes < than.score.served;
        let too_bad = hopes == than.score.served && answer.is_some_and(|found| found.objective <= than.score.worst);
        if too_few || too_bad {
            return None;
        }
        answers[point] = answer;
    }
    let served = Served::new(hold, answers);
    served.score.order(&than.score).is_lt().then_some(served)
}
