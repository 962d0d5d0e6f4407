//! A sequence of board poses along the circle: the hands keep their grasp, the arms move the board from point to point.
//!
//! From each of the most promising holds a tree of poses is grown that the arms reach without letting go. Values of every
//! pose at every point and the motions between poses make a layered graph, and dynamic programming finds the path of
//! the largest sum. Values are rough at first and motions taken for granted; those of the best path are then worked out
//! exactly and the path is looked for again, until all of it is exact. Small changes of single poses follow that keep both
//! motions. The path is the best of that graph: poses that the tree does not have, and ways around what a straight motion
//! touches, are not looked at.

use nalgebra::Vector3;

use super::{
    super::{Onlooker, bank::KnownHold, propose::uniform},
    motion::{self, MotionStep},
    serve::{Circle, Served, nudged},
};
use crate::comfort::Answer;

/// Poses of a tree.
const POSES: usize = 48;
/// Draws of a tree for each pose that is wanted.
const DRAWS_A_POSE: usize = 4;
/// The largest move from one pose of a tree to the next: shift, m; tilt of the board, rad; turn in its plane, rad.
const SHIFT_M: f64 = 0.12;
const TILT_RAD: f64 = 0.35;
const IN_PLANE_RAD: f64 = 0.8;
/// Small changes of a pose that are tried at each point at the end, and their size as a share of a tree's move.
const CHANGES: usize = 12;
const CHANGE: f64 = 0.25;
/// What serving a point counts for, beyond every comfort.
const SERVED: f64 = 1e6;
/// What a radian of the joint that moves most costs: among equals the arms move less.
const COST_A_RAD: f64 = 0.01;

/// The best sequence from these holds; none without one. It serves no fewer points than the first of them, whose place is
/// one of its poses.
pub fn best(circle: &mut Circle<'_>, roots: &[Served], onlooker: &mut Onlooker<'_>) -> Option<Vec<Stop>> {
    let mut best: Option<(f64, Vec<Stop>)> = None;
    for root in roots {
        if best.is_some() && circle.is_stopped(onlooker) {
            break;
        }
        let poses = grown(circle, root.hold.clone());
        let mut stops = Graph::new(circle, poses, root).best_path(circle);
        improve(circle, &mut stops, onlooker);
        let worth: f64 = stops.iter().map(Stop::worth).sum();
        if best.as_ref().is_none_or(|(before, _)| worth > *before) {
            best = Some((worth, stops));
        }
    }
    best.map(|(_, stops)| stops)
}

/// The motions from each stop to the next.
pub fn motions(circle: &Circle<'_>, stops: &[Stop]) -> Vec<Vec<MotionStep>> {
    // Every motion was found before, so none is left out.
    stops.windows(2).filter_map(|pair| motion::between(circle, &pair[0].hold, &pair[1].hold)).collect()
}

/// Where the board is for a point, with the person's answer.
#[derive(Clone)]
pub struct Stop {
    pub hold: KnownHold,
    pub answer: Option<Answer>,
}

impl Stop {
    fn worth(&self) -> f64 {
        self.answer.map_or(0.0, |answer| SERVED + answer.objective)
    }
}

/// Poses of the board that the arms reach from a hold without letting go, the hold's own first.
fn grown(circle: &mut Circle<'_>, root: KnownHold) -> Vec<KnownHold> {
    let mut poses = vec![root];
    for _ in 0..DRAWS_A_POSE * POSES {
        if poses.len() == POSES {
            break;
        }
        let number = (uniform(&mut circle.random, 0.0, poses.len() as f64) as usize).min(poses.len() - 1);
        let x_wo = drawn(circle, &poses[number], 1.0);
        let followed = motion::followed(circle, &poses[number], &x_wo);
        let kept = followed.filter(|hold| motion::between(circle, &poses[number], hold).is_some());
        poses.extend(kept);
    }
    poses
}

/// A pose of the board near a hold's.
fn drawn(circle: &mut Circle<'_>, from: &KnownHold, scale: f64) -> crate::model::frames::Pose {
    let mut within = |most: f64| uniform(&mut circle.random, -scale * most, scale * most);
    let shift = Vector3::from_fn(|_, _| within(SHIFT_M));
    let turn = Vector3::new(within(TILT_RAD), within(TILT_RAD), within(IN_PLANE_RAD));
    nudged(&from.x_wo, shift, turn)
}

/// What a pose is worth at a point.
#[derive(Clone, Copy)]
struct Value {
    worth: f64,
    /// The person's answer, once it was worked out.
    answer: Option<Answer>,
    exact: bool,
}

impl Value {
    /// By the person's map; minus infinity where it knows no answer.
    fn rough(worth: f64) -> Self {
        Self { worth: if worth.is_finite() { SERVED + worth } else { 0.0 }, answer: None, exact: false }
    }

    fn exact(answer: Option<Answer>) -> Self {
        Self { worth: answer.map_or(0.0, |answer| SERVED + answer.objective), answer, exact: true }
    }
}

/// Poses, their values at every point, and which motions between them were found to be none.
struct Graph {
    poses: Vec<KnownHold>,
    /// By pose, then by point.
    values: Vec<Vec<Value>>,
    /// By pose and pose: none as long as nobody has tried.
    motions: Vec<Vec<Option<bool>>>,
}

impl Graph {
    /// The poses of a tree; what the root is worth is known exactly.
    fn new(circle: &Circle<'_>, poses: Vec<KnownHold>, root: &Served) -> Self {
        let rough = |pose| circle.estimates(pose).into_iter().map(Value::rough).collect();
        let mut values: Vec<Vec<_>> = poses.iter().map(rough).collect();
        values[0] = root.answers.iter().copied().map(Value::exact).collect();
        let mut motions = vec![vec![None; poses.len()]; poses.len()];
        for (number, row) in motions.iter_mut().enumerate() {
            row[number] = Some(true);
        }
        Self { poses, values, motions }
    }

    /// The best path of which everything was worked out exactly.
    fn best_path(mut self, circle: &mut Circle<'_>) -> Vec<Stop> {
        loop {
            let path = self.path();
            // Each round works out at least one thing that was not known, and there are finitely many.
            if !self.work_out(circle, &path) {
                let stop = |(point, &pose): (usize, &usize)| Stop {
                    hold: self.poses[pose].clone(),
                    answer: self.values[pose][point].answer,
                };
                return path.iter().enumerate().map(stop).collect();
            }
        }
    }

    /// Works out what a path counts on; false when all of it was known.
    fn work_out(&mut self, circle: &mut Circle<'_>, path: &[usize]) -> bool {
        let mut news = false;
        for (point, &pose) in path.iter().enumerate() {
            let value = self.values[pose][point];
            if !value.exact {
                let answer = if value.worth > 0.0 { circle.answer(&self.poses[pose], point, None) } else { None };
                self.values[pose][point] = Value::exact(answer);
                news = true;
            }
        }
        for pair in path.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            if self.motions[from][to].is_none() {
                let clear = motion::between(circle, &self.poses[from], &self.poses[to]).is_some();
                // A motion back goes through other steps: its seeds are the same, its predecessors are not.
                self.motions[from][to] = Some(clear);
                news = true;
            }
        }
        news
    }

    /// The path of poses with the largest sum of values, by dynamic programming over the points.
    fn path(&self) -> Vec<usize> {
        let count = self.poses.len();
        let points = self.values[0].len();
        let mut sums: Vec<f64> = (0..count).map(|pose| self.values[pose][0].worth).collect();
        let mut before = Vec::with_capacity(points);
        for point in 1..points {
            let best_before = |to: usize| {
                let from = (0..count).filter(|&from| self.motions[from][to] != Some(false));
                let sum =
                    |from: usize| sums[from] - COST_A_RAD * motion::joints_apart(&self.poses[from], &self.poses[to]);
                // Staying is always possible.
                from.map(|from| (from, sum(from))).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((to, sums[to]))
            };
            let best: Vec<_> = (0..count).map(best_before).collect();
            sums = best.iter().enumerate().map(|(to, (_, sum))| sum + self.values[to][point].worth).collect();
            before.push(best);
        }
        let last = (0..count).max_by(|&a, &b| sums[a].total_cmp(&sums[b])).unwrap_or(0);
        let mut path = vec![last];
        for best in before.iter().rev() {
            path.push(best[path[path.len() - 1]].0);
        }
        path.reverse();
        path
    }
}

/// Small changes of single poses that make a point better and keep the motions from the one before and to the next.
fn improve(circle: &mut Circle<'_>, stops: &mut [Stop], onlooker: &mut Onlooker<'_>) {
    for point in 0..stops.len() {
        for _ in 0..CHANGES {
            if circle.is_stopped(onlooker) {
                return;
            }
            let x_wo = drawn(circle, &stops[point].hold, CHANGE);
            let Some(hold) = motion::followed(circle, &stops[point].hold, &x_wo) else { continue };
            let answer = circle.answer(&hold, point, stops[point].answer.as_ref());
            let stop = Stop { hold, answer };
            if stop.worth() <= stops[point].worth() {
                continue;
            }
            let from = point.checked_sub(1).and_then(|before| stops.get(before));
            let reached = from.is_none_or(|from| motion::between(circle, &from.hold, &stop.hold).is_some());
            let next = stops.get(point + 1);
            if reached && next.is_none_or(|next| motion::between(circle, &stop.hold, &next.hold).is_some()) {
                stops[point] = stop;
            }
        }
    }
}
