//! A sequence of board poses along the circle with one grasp: the arms move the board from point to point.
//!
//! From each of the best single grasps a tree of poses is grown that the arms reach without regrasping. The values of every
//! pose at every point and the motions between poses make a layered graph, and dynamic programming finds the path of the
//! largest sum. Values are estimates at first and motions are assumed to exist; those of the best path are computed exactly
//! and the path is searched again, until all of it is exact. Then single poses are improved by small changes that keep both
//! motions. The path is the best of that graph: poses outside the tree, and detours around what a straight motion touches,
//! are not considered.

use nalgebra::Vector3;

use super::{
    super::{
        domain::uniform,
        library::{BoardGrasp, largest_joint_difference_rad},
        params::path::{
            CHANGE, CHANGES, COST_PER_RAD, COVERED, DRAWS_PER_POSE, TREE_POSES, TREE_SHIFT_M, TREE_TILT_RAD,
            TREE_TURN_RAD,
        },
    },
    coverage::{Coverage, PathProblem, displaced},
    motion::{self, MotionStep},
};
use crate::{comfort::Response, model::frames::Pose};

/// The best sequence from these grasps; `None` without a grasp, or after a stop before there was one. It covers no fewer points
/// than the first of them, whose pose is one of its poses.
pub fn search(problem: &mut PathProblem<'_>, roots: &[Coverage]) -> Option<Vec<Waypoint>> {
    problem.begin_search();
    let mut best: Option<(f64, Vec<Waypoint>)> = None;
    for root in roots {
        if best.is_some() && problem.is_exhausted() {
            break;
        }
        let poses = pose_tree(problem, root.grasp.clone());
        let graph = Graph::new(problem, poses, root);
        let Some(mut waypoints) = graph.best_path(problem) else { break };
        improve(problem, &mut waypoints);
        let value: f64 = waypoints.iter().map(Waypoint::value).sum();
        if best.as_ref().is_none_or(|(before, _)| value > *before) {
            best = Some((value, waypoints));
        }
    }
    best.map(|(_, waypoints)| waypoints)
}

/// The motions from each waypoint to the next.
pub fn motions(problem: &PathProblem<'_>, waypoints: &[Waypoint]) -> Vec<Vec<MotionStep>> {
    // The search has found every motion, so none is dropped.
    waypoints.windows(2).filter_map(|pair| motion::between(problem, &pair[0].grasp, &pair[1].grasp)).collect()
}

/// Where the board is for a point, with the person's response.
#[derive(Clone)]
pub struct Waypoint {
    pub grasp: BoardGrasp,
    pub response: Option<Response>,
}

impl Waypoint {
    fn value(&self) -> f64 {
        self.response.map_or(0.0, |response| COVERED + response.objective)
    }
}

/// Poses of the board that the arms reach from a grasp without regrasping, the grasp's own first.
fn pose_tree(problem: &mut PathProblem<'_>, root: BoardGrasp) -> Vec<BoardGrasp> {
    let mut poses = vec![root];
    for _ in 0..DRAWS_PER_POSE * TREE_POSES {
        if poses.len() == TREE_POSES || problem.watch.is_stopped() {
            break;
        }
        let number = (uniform(&mut problem.random, 0.0, poses.len() as f64) as usize).min(poses.len() - 1);
        let x_wo = draw_near(problem, &poses[number], 1.0);
        let followed = motion::followed(problem, &poses[number], &x_wo);
        let kept = followed.filter(|grasp| motion::between(problem, &poses[number], grasp).is_some());
        poses.extend(kept);
    }
    poses
}

/// A random pose of the board near a grasp's.
fn draw_near(problem: &mut PathProblem<'_>, from: &BoardGrasp, scale: f64) -> Pose {
    let mut within = |most: f64| uniform(&mut problem.random, -scale * most, scale * most);
    let shift = Vector3::from_fn(|_, _| within(TREE_SHIFT_M));
    let turn = Vector3::new(within(TREE_TILT_RAD), within(TREE_TILT_RAD), within(TREE_TURN_RAD));
    displaced(&from.x_wo, shift, turn)
}

/// The value of a pose at a point.
#[derive(Clone, Copy)]
struct Value {
    value: f64,
    /// The person's response, once it has been computed.
    response: Option<Response>,
    exact: bool,
}

impl Value {
    /// From an estimated objective; minus infinity if the map has no posture.
    fn estimate(objective: f64) -> Self {
        let value = if objective.is_finite() { COVERED + objective } else { 0.0 };
        Self { value, response: None, exact: false }
    }

    fn exact(response: Option<Response>) -> Self {
        let value = response.map_or(0.0, |response| COVERED + response.objective);
        Self { value, response, exact: true }
    }
}

/// The layered graph of poses and points.
struct Graph {
    poses: Vec<BoardGrasp>,
    /// By pose, then by point.
    values: Vec<Vec<Value>>,
    /// Whether there is a motion from pose to pose; `None` if not computed yet.
    motions: Vec<Vec<Option<bool>>>,
}

impl Graph {
    /// The graph of a tree's poses; the values of the root are exact.
    fn new(problem: &PathProblem<'_>, poses: Vec<BoardGrasp>, root: &Coverage) -> Self {
        let estimates = |pose| problem.estimates(pose).into_iter().map(Value::estimate).collect();
        let mut values: Vec<Vec<_>> = poses.iter().map(estimates).collect();
        values[0] = root.responses.iter().copied().map(Value::exact).collect();
        let mut motions = vec![vec![None; poses.len()]; poses.len()];
        for (number, row) in motions.iter_mut().enumerate() {
            row[number] = Some(true);
        }
        Self { poses, values, motions }
    }

    /// The best path, all of it exact; `None` after a stop.
    fn best_path(mut self, problem: &mut PathProblem<'_>) -> Option<Vec<Waypoint>> {
        while !problem.watch.is_stopped() {
            let path = self.path();
            // Every round makes something exact that was not, so the loop ends.
            if !self.make_exact(problem, &path) {
                let waypoint = |(point, &pose): (usize, &usize)| Waypoint {
                    grasp: self.poses[pose].clone(),
                    response: self.values[pose][point].response,
                };
                return Some(path.iter().enumerate().map(waypoint).collect());
            }
        }
        None
    }

    /// Computes the values and motions of a path; false if all of it was exact. After a stop they are not complete.
    fn make_exact(&mut self, problem: &mut PathProblem<'_>, path: &[usize]) -> bool {
        let mut changed = false;
        let stop = problem.watch;
        for (point, &pose) in path.iter().enumerate().take_while(|_| !stop.is_stopped()) {
            let value = self.values[pose][point];
            if !value.exact {
                let response = if value.value > 0.0 { problem.response(&self.poses[pose], point, None) } else { None };
                self.values[pose][point] = Value::exact(response);
                changed = true;
            }
        }
        for pair in path.windows(2).take_while(|_| !stop.is_stopped()) {
            let (from, to) = (pair[0], pair[1]);
            if self.motions[from][to].is_none() {
                let exists = motion::between(problem, &self.poses[from], &self.poses[to]).is_some();
                // The motion back has other intermediate steps, so it is computed by itself.
                self.motions[from][to] = Some(exists);
                changed = true;
            }
        }
        changed
    }

    /// The path of poses with the largest sum of values, by dynamic programming over the points.
    fn path(&self) -> Vec<usize> {
        let count = self.poses.len();
        let points = self.values[0].len();
        let mut sums: Vec<f64> = (0..count).map(|pose| self.values[pose][0].value).collect();
        let mut before = Vec::with_capacity(points);
        for point in 1..points {
            let best_before = |to: usize| {
                let from = (0..count).filter(|&from| self.motions[from][to] != Some(false));
                let cost = |from: usize| {
                    COST_PER_RAD * largest_joint_difference_rad(&self.poses[from].arms, &self.poses[to].arms)
                };
                // Staying at a pose is always possible.
                from.map(|from| (from, sums[from] - cost(from)))
                    .max_by(|a, b| a.1.total_cmp(&b.1))
                    .unwrap_or((to, sums[to]))
            };
            let best: Vec<_> = (0..count).map(best_before).collect();
            sums = best.iter().enumerate().map(|(to, (_, sum))| sum + self.values[to][point].value).collect();
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

/// Improves single waypoints by small changes that keep the motions from the one before and to the next.
fn improve(problem: &mut PathProblem<'_>, waypoints: &mut [Waypoint]) {
    for point in 0..waypoints.len() {
        for _ in 0..CHANGES {
            if problem.is_exhausted() {
                return;
            }
            let x_wo = draw_near(problem, &waypoints[point].grasp, CHANGE);
            let Some(grasp) = motion::followed(problem, &waypoints[point].grasp, &x_wo) else { continue };
            let response = problem.response(&grasp, point, waypoints[point].response.as_ref());
            let changed = Waypoint { grasp, response };
            if changed.value() <= waypoints[point].value() {
                continue;
            }
            let before = point.checked_sub(1).and_then(|before| waypoints.get(before));
            let reached = before.is_none_or(|from| motion::between(problem, &from.grasp, &changed.grasp).is_some());
            let next = waypoints.get(point + 1);
            if reached && next.is_none_or(|next| motion::between(problem, &changed.grasp, &next.grasp).is_some()) {
                waypoints[point] = changed;
            }
        }
    }
}
