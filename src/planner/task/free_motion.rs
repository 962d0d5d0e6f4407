//! A path of one arm from one configuration to another that is free of collisions: RRT-Connect (Kuffner and LaValle
//! 2000, RRT-Connect: An Efficient Approach to Single-Query Path Planning, IEEE International Conference on Robotics
//! and Automation) in joint space with the Euclidean metric, then shortcuts.
//!
//! Every configuration of the result has been tested itself: a path is kept as the tested configurations, not as its
//! corners.

use std::cell::Cell;

use rand_pcg::Pcg64;

use super::super::domain::uniform;

/// An edge of a tree turns no joint by more than this many steps, 18 degrees for a step of 3 degrees: much longer ones
/// are often blocked, much shorter ones make the trees large.
const EDGE_STEPS: f64 = 6.0;
/// Number of attempts to shorten a path: twice as many make the paths of the tests' drawn worlds 1 % shorter at most.
const SHORTCUTS: usize = 100;
/// A corner counts as this much of the path's length, rad: a stop costs about v / a = 0.3 s at 1.5 rad/s and 5 rad/s²,
/// in which the arm would go on by half a radian.
const CORNER_RAD: f64 = 0.5;
/// A shortcut that saves less does not pay, rad: it may be rounding.
const LEAST_SAVING_RAD: f64 = 1e-9;
/// A configuration may be outside the joint limits by this, rad, the rounding of inverse kinematics at a limit.
const LIMIT_TOLERANCE_RAD: f64 = 1e-9;
/// Share of the ends of shortcuts that are moved to the next corner, so that corners disappear.
const AT_A_CORNER: f64 = 0.5;

/// A motion that is asked for.
pub struct FreeMotion<'a> {
    /// Lower joint limits, rad.
    pub lower: &'a [f64],
    /// Upper joint limits, rad.
    pub upper: &'a [f64],
    /// True if the arm collides with nothing at these joint angles, rad. It always gives the same answer.
    pub is_free: &'a dyn Fn(&[f64]) -> bool,
    /// Largest difference of any joint between configurations that are tested in succession along a path, rad;
    /// positive.
    pub step_rad: f64,
    /// Largest number of calls of `is_free`.
    pub most_tests: usize,
}

/// The configurations of a path from `start` to `goal`, rad, both included; one configuration if they are equal.
///
/// `is_free` is true of each of them, and between neighbours no joint turns by more than `step_rad`. The straight line
/// is tried first. Then two trees are grown until they meet, and the path is shortened, with few corners preferred; the
/// path of a search that reaches `most_tests` meanwhile is returned as it is then.
///
/// `None` if start or goal is not free or not within the joint limits, if the lengths differ or the step is not
/// positive, or if no path is found within `most_tests` calls of `is_free`.
pub fn find(problem: &FreeMotion<'_>, start: &[f64], goal: &[f64], random: &mut Pcg64) -> Option<Vec<Vec<f64>>> {
    if problem.step_rad.is_nan() || problem.step_rad <= 0.0 || !problem.is_within(start) || !problem.is_within(goal) {
        return None;
    }
    let tests = Tests { problem, left: Cell::new(problem.most_tests) };
    if !tests.is_free(start)? {
        return None;
    }
    if start == goal {
        return Some(vec![start.to_vec()]);
    }
    if !tests.is_free(goal)? {
        return None;
    }
    if let Some(line) = tests.edge(start, goal)? {
        return Some([start.to_vec()].into_iter().chain(line).collect());
    }
    let mut path = Path::of(connect(&tests, start, goal, random)?);
    // A path has been found: it is as short as the remaining tests make it.
    let _exhausted = path.shorten(&tests, random);
    Some(path.q_rad)
}

impl FreeMotion<'_> {
    fn is_within(&self, q_rad: &[f64]) -> bool {
        let range = |(low, high): (&f64, &f64)| low - LIMIT_TOLERANCE_RAD..=high + LIMIT_TOLERANCE_RAD;
        let mut joints = q_rad.iter().zip(self.lower.iter().zip(self.upper).map(range));
        self.lower.len() == q_rad.len()
            && self.upper.len() == q_rad.len()
            && joints.all(|(q_rad, range_rad)| range_rad.contains(q_rad))
    }
}

/// The counted tests. Their methods return `None` when the number of tests is used up.
struct Tests<'a> {
    problem: &'a FreeMotion<'a>,
    left: Cell<usize>,
}

impl Tests<'_> {
    fn is_free(&self, q_rad: &[f64]) -> Option<bool> {
        self.left.set(self.left.get().checked_sub(1)?);
        Some((self.problem.is_free)(q_rad))
    }

    /// The configurations after `from` up to `to` at steps of at most `step_rad`, if all but `to`, which is known to be
    /// free, are free. They are tested in the order of repeated bisection, which finds a wide obstacle soon.
    #[allow(clippy::option_option)]
    fn edge(&self, from: &[f64], to: &[f64]) -> Option<Option<Vec<Vec<f64>>>> {
        let largest_rad = from.iter().zip(to).map(|(from, to)| (to - from).abs()).fold(0.0, f64::max);
        let count = (largest_rad / self.problem.step_rad).ceil().max(1.0) as usize;
        let at = |k: usize| if k == count { to.to_vec() } else { between(from, to, k as f64 / count as f64) };
        let mut stride = count.next_power_of_two();
        while stride > 1 {
            // The odd multiples of half the stride have not been tested with a larger one.
            for k in (stride / 2..count).step_by(stride) {
                if !self.is_free(&at(k))? {
                    return Some(None);
                }
            }
            stride /= 2;
        }
        Some(Some((1..=count).map(at).collect()))
    }
}

/// A tree of configurations. Each one has its parent's number and the tested configurations after the parent, itself
/// the last.
struct Tree {
    q_rad: Vec<Vec<f64>>,
    parents: Vec<usize>,
    edges: Vec<Vec<Vec<f64>>>,
}

/// How far a tree has got towards a configuration.
enum Extended {
    Trapped,
    Advanced,
    Reached,
}

impl Tree {
    fn at(root: &[f64]) -> Self {
        Self { q_rad: vec![root.to_vec()], parents: vec![0], edges: vec![vec![root.to_vec()]] }
    }

    /// Number of the node nearest to a configuration, and the distance, rad.
    fn nearest(&self, q_rad: &[f64]) -> (usize, f64) {
        let distances = self.q_rad.iter().map(|node| distance_rad(node, q_rad)).enumerate();
        distances.fold((0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
    }

    /// Adds a node towards a configuration, at most an edge's length from the nearest node. It makes at least one test,
    /// so that a search ends.
    fn extend(&mut self, tests: &Tests<'_>, towards: &[f64]) -> Option<Extended> {
        let (nearest, apart_rad) = self.nearest(towards);
        let longest_rad = EDGE_STEPS * tests.problem.step_rad;
        let reaches = apart_rad <= longest_rad;
        let from = &self.q_rad[nearest];
        let to = if reaches { towards.to_vec() } else { between(from, towards, longest_rad / apart_rad) };
        if !tests.is_free(&to)? {
            return Some(Extended::Trapped);
        }
        let Some(edge) = tests.edge(from, &to)? else { return Some(Extended::Trapped) };
        self.q_rad.push(to);
        self.parents.push(nearest);
        self.edges.push(edge);
        Some(if reaches { Extended::Reached } else { Extended::Advanced })
    }

    /// The nodes' numbers from the newest one to the root.
    fn to_root(&self) -> Vec<usize> {
        let mut node = self.q_rad.len() - 1;
        let mut nodes = vec![node];
        while node != 0 {
            node = self.parents[node];
            nodes.push(node);
        }
        nodes
    }

    /// The configurations from the root to the newest node, by edges.
    fn edges_from_root(&self) -> Vec<Vec<Vec<f64>>> {
        self.to_root().into_iter().rev().map(|node| self.edges[node].clone()).collect()
    }
}

/// The edges of a path by RRT-Connect; the first one is the start alone. `None` if the tests are used up.
fn connect(tests: &Tests<'_>, start: &[f64], goal: &[f64], random: &mut Pcg64) -> Option<Vec<Vec<Vec<f64>>>> {
    let mut trees = [Tree::at(start), Tree::at(goal)];
    let mut grown = 0;
    loop {
        let limits = tests.problem.lower.iter().zip(tests.problem.upper);
        let drawn: Vec<f64> = limits.map(|(low, high)| uniform(random, *low, *high)).collect();
        if !matches!(trees[grown].extend(tests, &drawn)?, Extended::Trapped) {
            let newest = trees[grown].q_rad.last()?.clone();
            loop {
                match trees[1 - grown].extend(tests, &newest)? {
                    Extended::Trapped => break,
                    Extended::Advanced => {}
                    Extended::Reached => return Some(joined(&trees)),
                }
            }
        }
        grown = 1 - grown;
    }
}

/// The edges from the first tree's root over the newest node of both to the second one's root.
fn joined([from_start, from_goal]: &[Tree; 2]) -> Vec<Vec<Vec<f64>>> {
    let mut edges = from_start.edges_from_root();
    for node in from_goal.to_root() {
        // The second tree's edges point away from the goal: each is reversed and ends with its parent.
        if node != 0 {
            let parent = &from_goal.q_rad[from_goal.parents[node]];
            let inner = from_goal.edges[node].iter().rev().skip(1);
            edges.push(inner.chain([parent]).cloned().collect());
        }
    }
    edges
}

/// Tested configurations, rad, and which of them are corners or ends.
struct Path {
    q_rad: Vec<Vec<f64>>,
    is_corner: Vec<bool>,
}

impl Path {
    fn of(edges: Vec<Vec<Vec<f64>>>) -> Self {
        let mut path = Self { q_rad: Vec::new(), is_corner: Vec::new() };
        for edge in edges {
            path.is_corner.extend((1..=edge.len()).map(|k| k == edge.len()));
            path.q_rad.extend(edge);
        }
        path
    }

    /// Replaces parts of the path by straight lines if the tests find them free and the path costs less. `None` if the
    /// tests are used up; the path is valid then too.
    fn shorten(&mut self, tests: &Tests<'_>, random: &mut Pcg64) -> Option<()> {
        for _ in 0..SHORTCUTS {
            let [a, b] = [self.draw(random), self.draw(random)];
            self.cut(tests, a.min(b), a.max(b))?;
        }
        // Then no corner is left that can simply be omitted.
        let mut corner = 1;
        while let Some(&[before, _, after]) = self.corners().get(corner - 1..corner + 2) {
            corner = if self.cut(tests, before, after)? { 1 } else { corner + 1 };
        }
        Some(())
    }

    /// The number of a configuration, of a corner or end about every second time.
    fn draw(&self, random: &mut Pcg64) -> usize {
        let drawn = below(random, self.q_rad.len());
        let is_moved = uniform(random, 0.0, 1.0) < AT_A_CORNER;
        (drawn..self.q_rad.len()).find(|k| !is_moved || self.is_corner[*k]).unwrap_or(drawn)
    }

    fn corners(&self) -> Vec<usize> {
        (0..self.q_rad.len()).filter(|k| self.is_corner[*k]).collect()
    }

    /// Replaces the part between two configurations by a line; false if that does not pay or the line is not free.
    fn cut(&mut self, tests: &Tests<'_>, first: usize, last: usize) -> Option<bool> {
        let is_inner = |k: usize| 0 < k && k + 1 < self.q_rad.len();
        let corners = (first..=last).filter(|k| is_inner(*k) && self.is_corner[*k]).count();
        let corners_then = [first, last].into_iter().filter(|k| is_inner(*k)).count();
        let part = &self.q_rad[first..=last];
        let length_rad: f64 = part.windows(2).map(|pair| distance_rad(&pair[0], &pair[1])).sum();
        let saved_rad = length_rad - distance_rad(&self.q_rad[first], &self.q_rad[last]);
        if corners == 0 || saved_rad + CORNER_RAD * (corners as f64 - corners_then as f64) <= LEAST_SAVING_RAD {
            return Some(false);
        }
        let Some(line) = tests.edge(&self.q_rad[first], &self.q_rad[last])? else { return Some(false) };
        self.is_corner[first] = true;
        self.is_corner.splice(first + 1..=last, (1..=line.len()).map(|k| k == line.len()));
        self.q_rad.splice(first + 1..=last, line);
        Some(true)
    }
}

/// A uniformly distributed index of a list of this length.
fn below(random: &mut Pcg64, length: usize) -> usize {
    (uniform(random, 0.0, length as f64) as usize).min(length.saturating_sub(1))
}

fn between(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect()
}

fn distance_rad(from: &[f64], to: &[f64]) -> f64 {
    from.iter().zip(to).map(|(from, to)| (to - from) * (to - from)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_RAD: f64 = 0.05;

    fn found(
        joints: usize,
        is_free: &dyn Fn(&[f64]) -> bool,
        most_tests: usize,
        ends: [&[f64]; 2],
        seed: u64,
    ) -> Option<Vec<Vec<f64>>> {
        let (lower, upper) = (vec![-1.0; joints], vec![1.0; joints]);
        let problem = FreeMotion { lower: &lower, upper: &upper, is_free, step_rad: STEP_RAD, most_tests };
        find(&problem, ends[0], ends[1], &mut Pcg64::new(u128::from(seed), 0))
    }

    fn assert_is_a_path(path: &[Vec<f64>], [start, goal]: [&[f64]; 2], is_free: &dyn Fn(&[f64]) -> bool) {
        assert_eq!((path[0].as_slice(), path[path.len() - 1].as_slice()), (start, goal));
        assert!(path.iter().all(|q_rad| is_free(q_rad) && q_rad.iter().all(|q_rad| q_rad.abs() <= 1.0)));
        for pair in path.windows(2) {
            let largest_rad = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Rounding of a configuration between two others.
            assert!(0.0 < largest_rad && largest_rad <= STEP_RAD + 1e-12);
        }
    }

    fn length_rad(path: &[Vec<f64>]) -> f64 {
        path.windows(2).map(|pair| distance_rad(&pair[0], &pair[1])).sum()
    }

    fn corners(path: &[Vec<f64>]) -> usize {
        let is_corner = |three: &&[Vec<f64>]| {
            // The triangle inequality is strict at a corner.
            length_rad(three) - distance_rad(&three[0], &three[2]) > 1e-6
        };
        path.windows(3).filter(is_corner).count()
    }

    /// Balls of which none contains an end.
    fn balls(joints: usize, ends: [&[f64]; 2], random: &mut Pcg64) -> Vec<(Vec<f64>, f64)> {
        let mut balls = Vec::new();
        while balls.len() < 8 * joints {
            let centre: Vec<f64> = (0..joints).map(|_| uniform(random, -1.0, 1.0)).collect();
            let radius_rad = uniform(random, 0.1, 0.35);
            if ends.iter().all(|end| distance_rad(&centre, end) > radius_rad + 0.05) {
                balls.push((centre, radius_rad));
            }
        }
        balls
    }

    #[test]
    fn a_free_line_is_the_path() {
        let ends = [[-0.9, 0.3], [0.8, -0.2]];
        let path = found(2, &|_| true, 100, [&ends[0], &ends[1]], 1).unwrap();
        assert_eq!(path.len(), 35);
        assert_is_a_path(&path, [&ends[0], &ends[1]], &|_| true);
        assert!((length_rad(&path) - distance_rad(&ends[0], &ends[1])).abs() < 1e-12);
    }

    #[test]
    fn a_path_from_a_configuration_to_itself_is_that_configuration() {
        assert_eq!(found(2, &|_| true, 1, [&[0.1, 0.2]; 2], 1), Some(vec![vec![0.1, 0.2]]));
        assert_eq!(found(2, &|_| false, 1, [&[0.1, 0.2]; 2], 1), None);
    }

    #[test]
    fn a_path_through_a_gap_is_short_and_has_few_corners() {
        // A wall 0.2 thick with a gap 0.2 wide at the top. By hand: the taut path passes the gap's two lower corners.
        let is_free = |q: &[f64]| q[0].abs() > 0.1 || (0.7..0.9).contains(&q[1]);
        let ends = [[-0.8, -0.5], [0.8, -0.5]];
        let taut_rad = 2.0 * libm::hypot(0.7, 1.2) + 0.2;
        let (mut total_rad, mut total_corners) = (0.0, 0);
        for seed in 0..200 {
            let path = found(2, &is_free, 100_000, [&ends[0], &ends[1]], seed).unwrap();
            assert_is_a_path(&path, [&ends[0], &ends[1]], &is_free);
            let (length_rad, corners) = (length_rad(&path), corners(&path));
            // A line may cut the wall's corner between two tests. Shortcuts are random, so the upper bounds are loose.
            assert!(
                taut_rad - 2.0 * STEP_RAD < length_rad && length_rad < 1.25 * taut_rad,
                "{length_rad} of {taut_rad}"
            );
            assert!(corners <= 4, "{corners}");
            total_rad += length_rad;
            total_corners += corners;
        }
        assert!(total_rad < 200.0 * 1.08 * taut_rad && total_corners < 500, "{total_rad} {total_corners}");
    }

    #[test]
    fn an_unreachable_goal_ends_the_search_after_the_given_number_of_tests() {
        for most_tests in [0, 1, 2, 3, 50, 2000] {
            let tests = Cell::new(0);
            let is_free = |q: &[f64]| {
                tests.set(tests.get() + 1);
                q[0].abs() > 0.1
            };
            assert_eq!(found(2, &is_free, most_tests, [&[-0.5, 0.0], &[0.5, 0.0]], 3), None);
            assert_eq!(tests.get(), most_tests);
        }
    }

    #[test]
    fn a_search_without_room_ends() {
        let problem = FreeMotion {
            lower: &[0.0, 0.0],
            upper: &[0.0, 1.0],
            is_free: &|q| (q[1] - 0.5).abs() > 0.2,
            step_rad: STEP_RAD,
            most_tests: 1000,
        };
        assert_eq!(find(&problem, &[0.0, 0.0], &[0.0, 1.0], &mut Pcg64::new(1, 0)), None);
    }

    #[test]
    fn a_wrong_problem_has_no_path() {
        let ends: [[&[f64]; 2]; 4] =
            [[&[0.0], &[1.1]], [&[-1.1], &[0.0]], [&[0.0], &[f64::NAN]], [&[0.0, 0.0], &[0.5, 0.0]]];
        assert!(ends.iter().all(|ends| found(1, &|_| true, 1000, *ends, 1).is_none()));
        for step_rad in [0.0, -0.1, f64::NAN] {
            let problem = FreeMotion { lower: &[-1.0], upper: &[1.0], is_free: &|_| true, step_rad, most_tests: 1000 };
            assert_eq!(find(&problem, &[0.0], &[0.5], &mut Pcg64::new(1, 0)), None);
        }
    }

    /// True if a walk over a square grid of 0.01 rad leads from one end to the other.
    fn is_connected(ends: [f64; 2], is_free: &dyn Fn(&[f64]) -> bool) -> bool {
        const SIDE: usize = 201;
        let [start, goal] = ends.map(|q_rad| ((q_rad + 1.0) * 100.0).round() as usize);
        let mut is_seen = vec![false; SIDE * SIDE];
        let mut open = vec![(start, start)];
        while let Some((x, y)) = open.pop() {
            let q_rad = [x, y].map(|index| index as f64 / 100.0 - 1.0);
            if x < SIDE && y < SIDE && !is_seen[x * SIDE + y] && is_free(&q_rad) {
                is_seen[x * SIDE + y] = true;
                open.extend([(x + 1, y), (x.wrapping_sub(1), y), (x, y + 1), (x, y.wrapping_sub(1))]);
            }
        }
        is_seen[goal * SIDE + goal]
    }

    #[test]
    fn every_configuration_of_a_path_among_balls_is_free() {
        let (mut paths, mut bent) = (0, 0);
        for seed in 0..400 {
            let joints = [2, 3, 6, 7][seed as usize % 4];
            let mut random = Pcg64::new(u128::from(seed), 1);
            let [start, goal] = [-0.95, 0.95].map(|q_rad| vec![q_rad; joints]);
            let ends: [&[f64]; 2] = [&start, &goal];
            let balls = balls(joints, ends, &mut random);
            let tests = Cell::new(0);
            let is_free = |q: &[f64]| {
                tests.set(tests.get() + 1);
                balls.iter().all(|(centre, radius_rad)| distance_rad(centre, q) > *radius_rad)
            };
            let path = found(joints, &is_free, 20_000, ends, seed);
            assert!(tests.get() <= 20_000);
            if let Some(path) = &path {
                assert_is_a_path(path, ends, &is_free);
                paths += 1;
                bent += usize::from(corners(path) > 0);
            } else {
                // In the plane balls may separate the ends; more joints leave a way around them.
                assert!(joints == 2 && !is_connected([-0.95, 0.95], &is_free), "{seed}");
            }
            assert_eq!(path, found(joints, &is_free, 20_000, ends, seed));
        }
        assert!(paths > 350 && bent > 100, "{paths} {bent}");
    }

    #[test]
    fn a_path_that_is_found_is_kept_when_the_tests_end() {
        let is_free = |q: &[f64]| q[0].abs() > 0.1 || (0.7..0.9).contains(&q[1]);
        let ends: [&[f64]; 2] = [&[-0.8, -0.5], &[0.8, -0.5]];
        let mut is_found = false;
        for most_tests in (10..3000).step_by(37) {
            let path = found(2, &is_free, most_tests, ends, 5);
            // More tests never lose a path.
            assert!(path.is_some() || !is_found);
            is_found = path.is_some();
            assert!(path.is_none_or(|path| {
                assert_is_a_path(&path, ends, &is_free);
                true
            }));
        }
        assert!(is_found);
    }
}
