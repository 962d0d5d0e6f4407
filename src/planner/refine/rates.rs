//! First derivatives of a hold's objective and constraints along its free moves.
//!
//! By the chain rule: whatever depends on where links are is differentiated with respect to the arms' joints once, and the
//! joints' rates along each move do the rest; board and body move as rigid bodies. Only what the person's own joints change
//! is differenced. It must say what differences of the figures themselves would say; a test holds it to that.

use nalgebra::{DVector, Point3, Vector3};

use super::{
    super::{
        Problem,
        assess::{self, Feasible},
    },
    moves::{GRASP, Moves, PERSON_RAD, PLACE_M, SMALL, nudged, nudged_grasp},
};
use crate::{
    collision::{Carrier, Near, PersonPart},
    comfort,
    human::{ArmAngles, BODY_POINTS, CAPSULES, Muscular, peripersonal_pulls},
};

/// The person's joints.
const JOINTS: usize = 7;

/// A hold and how everything about it moves.
pub struct Rates<'a, 'p> {
    problem: &'a Problem<'p>,
    here: &'a Feasible,
    moves: &'a Moves,
    arms: Vec<ArmAxes>,
    /// Body points in the hold, W.
    body_w: [Point3<f64>; BODY_POINTS],
    /// A little along each of the person's joints.
    nudged: Vec<NudgedPerson>,
}

/// The axes of an arm's joints in W.
struct ArmAxes {
    origins_w: Vec<Point3<f64>>,
    axes_w: Vec<Vector3<f64>>,
}

/// The person with one joint moved by [`SMALL`] of a move.
struct NudgedPerson {
    body_w: [Point3<f64>; BODY_POINTS],
    capsules: [PersonPart; CAPSULES],
    muscular: Muscular,
}

impl<'a, 'p> Rates<'a, 'p> {
    pub fn new(problem: &'a Problem<'p>, here: &'a Feasible, moves: &'a Moves) -> Self {
        let arms = problem.map.arms.iter().zip(&here.candidate.holds).map(|(arm, hold)| {
            let frames = arm.chain.joint_frames(&hold.q_rad);
            ArmAxes {
                axes_w: arm.chain.axes_w(&frames),
                origins_w: frames.iter().map(|x_wj| x_wj.translation.vector.into()).collect(),
            }
        });
        let nudged = (0..JOINTS).map(|joint| {
            let stance = nudged(here.candidate.stance(), joint);
            let (q_h_rad, x_wb) = (&stance.q_h_rad, stance.placed(problem).x_wb);
            NudgedPerson {
                body_w: problem.human.body_points_w(&x_wb, q_h_rad),
                capsules: problem.human.capsules_w(&x_wb, q_h_rad).map(PersonPart::from),
                muscular: muscular(problem, q_h_rad),
            }
        });
        Self {
            problem,
            here,
            moves,
            arms: arms.collect(),
            body_w: problem.human.body_points_w(&here.configured.placed.x_wb, &here.candidate.q_h_rad),
            nudged: nudged.collect(),
        }
    }

    fn zeros(&self) -> DVector<f64> {
        DVector::zeros(self.moves.count())
    }

    /// Of the objective.
    pub fn objective_gradient(&self) -> DVector<f64> {
        let settings = &self.problem.objective;
        let map = self.problem.map;
        let robot_w = comfort::robot_points_w(&map.robot, &self.here.configured.link_poses);
        let pulls = peripersonal_pulls(settings.peripersonal, settings.saturation_m, &self.body_w, &robot_w);
        let mut gradient = self.zeros();
        let mut robot_pulls = vec![Vector3::zeros(); robot_w.len()];
        for (point, pull) in pulls.iter().enumerate() {
            let away = pull.away * settings.weight_peripersonal;
            robot_pulls[pull.nearest] -= away;
            self.add_body_point(point, &away, &mut gradient);
        }
        let points = map.robot.body_points.iter().zip(robot_w.iter().zip(&robot_pulls));
        self.add_link_points(points.map(|(point, (p_w, pull))| (point.link, *p_w, *pull)), &mut gradient);
        let here = self.here.comfort.muscular_regularised;
        for (joint, nudged) in self.nudged.iter().enumerate() {
            gradient[joint] += settings.weight_muscular * (nudged.muscular.regularised - here) / SMALL;
        }
        gradient
    }

    /// Adds `along . v`, v the rate of a point of the body along each move.
    fn add_body_point(&self, point: usize, along: &Vector3<f64>, gradient: &mut DVector<f64>) {
        for (number, stance) in self.moves.stances.iter().enumerate() {
            gradient[number] += match self.nudged.get(number) {
                Some(nudged) => along.dot(&(nudged.body_w[point] - self.body_w[point])) / SMALL,
                None => along.dot(&stance.body.at(&self.body_w[point])),
            };
        }
    }

    /// Adds `sum along . v`, v the rates of points of links: the link, the point in W, and what its rate is multiplied by.
    fn add_link_points(
        &self,
        points: impl Iterator<Item = (usize, Point3<f64>, Vector3<f64>)>,
        gradient: &mut DVector<f64>,
    ) {
        let mut of_joints: Vec<_> = self.arms.iter().map(|arm| DVector::zeros(arm.axes_w.len())).collect();
        for (link, p_w, along) in points {
            let Some((arm, last)) = self.problem.map.carriers[link] else { continue };
            let ArmAxes { origins_w, axes_w } = &self.arms[arm];
            let joints = of_joints[arm].iter_mut().zip(origins_w.iter().zip(axes_w)).take(last + 1);
            joints.for_each(|(sum, (origin_w, axis_w))| *sum += axis_w.dot(&(p_w - origin_w).cross(&along)));
        }
        for (rates, of_joints) in self.moves.rates.iter().zip(&of_joints) {
            gradient.gemv_tr(1.0, rates, of_joints, 1.0);
        }
    }

    /// Of how far two bodies are apart.
    pub fn near_gradient(&self, near: &Near) -> DVector<f64> {
        let mut gradient = self.zeros();
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let (p_w, along) = (near.p_w[side], near.normal_w * sign);
            match near.carriers[side].0 {
                Carrier::Link(link) => self.add_link_points(std::iter::once((link, p_w, along)), &mut gradient),
                Carrier::Board => {
                    for (number, stance) in self.moves.stances.iter().enumerate() {
                        gradient[number] += along.dot(&stance.board.at(&p_w));
                    }
                }
                Carrier::Person(part) => self.add_person_part(part, &p_w, &along, &mut gradient),
            }
        }
        gradient
    }

    fn add_person_part(&self, part: usize, p_w: &Point3<f64>, along: &Vector3<f64>, gradient: &mut DVector<f64>) {
        let here = &self.here.configured.person[part];
        let share = share_along(p_w, &here.p0_w, &here.p1_w);
        for (number, stance) in self.moves.stances.iter().enumerate() {
            gradient[number] += match self.nudged.get(number) {
                Some(nudged) => {
                    let there = &nudged.capsules[part];
                    let moved = (there.p0_w - here.p0_w) * (1.0 - share) + (there.p1_w - here.p1_w) * share;
                    along.dot(&moved) / SMALL
                }
                None => along.dot(&stance.body.at(p_w)),
            };
        }
    }

    /// Of the margins that [`super::linear`] calls plain, in their order.
    pub fn plain_gradients(&self) -> Vec<DVector<f64>> {
        let mut gradients = Vec::with_capacity(96);
        let mut between = |gradient: DVector<f64>| {
            let opposite = -&gradient;
            gradients.extend([gradient, opposite]);
        };
        for joint in 0..JOINTS {
            between(self.single(joint, PERSON_RAD));
        }
        between(self.single(8, PLACE_M));
        between(self.single(9, PLACE_M));
        between(self.of_board(|board| board.linear.z));
        for (arm, rates) in self.moves.rates.iter().enumerate() {
            for joint in 0..rates.nrows() {
                between(rates.row(joint).transpose());
            }
            let grasp = self.moves.of_grasp(arm);
            between(self.single(grasp.start + 1, GRASP[1]));
            between(self.single(grasp.start + 2, GRASP[2]));
        }
        let normal_w = self.here.configured.placed.x_wo.rotation * Vector3::z();
        gradients.push(self.of_board(|board| board.angular.cross(&normal_w).x));
        gradients.extend((0..JOINTS).map(|joint| self.activation_gradient(joint)));
        gradients.extend((0..self.arms.len()).flat_map(|arm| self.pad_gradients(arm)));
        gradients
    }

    /// A gradient with one entry.
    fn single(&self, number: usize, entry: f64) -> DVector<f64> {
        let mut gradient = self.zeros();
        gradient[number] = entry;
        gradient
    }

    fn of_board(&self, rate: impl Fn(&super::moves::RigidRates) -> f64) -> DVector<f64> {
        let mut gradient = self.zeros();
        self.moves.stances.iter().enumerate().for_each(|(number, stance)| gradient[number] = rate(&stance.board));
        gradient
    }

    /// Of `1 - alpha` of one of the person's joints.
    fn activation_gradient(&self, joint: usize) -> DVector<f64> {
        let mut gradient = self.zeros();
        let here = self.here.comfort.activations[joint];
        for (number, nudged) in self.nudged.iter().enumerate() {
            gradient[number] = (here - nudged.muscular.activations[joint]) / SMALL;
        }
        gradient
    }

    /// Of how far a gripper's pads are inside each edge of the board.
    fn pad_gradients(&self, arm: usize) -> [DVector<f64>; 4] {
        let map = self.problem.map;
        let gripper = &map.robot.arms[map.arms[arm].index].gripper;
        let grasp = self.here.candidate.holds[arm].grasp;
        let margins_m = |grasp| assess::pad_margins_m(gripper, &grasp, self.problem.scenario.object.size_m);
        let here_m = margins_m(grasp);
        let mut gradients = [(); 4].map(|()| self.zeros());
        for (part, number) in self.moves.of_grasp(arm).enumerate() {
            let there_m = margins_m(nudged_grasp(grasp, part, SMALL));
            for (side, gradient) in gradients.iter_mut().enumerate() {
                gradient[number] = (there_m[side] - here_m[side]) / SMALL;
            }
        }
        gradients
    }
}

/// The muscular comfort of a posture, which does not depend on where the person stands.
fn muscular(problem: &Problem<'_>, q_h_rad: &ArmAngles) -> Muscular {
    let human = &problem.human;
    let direction = problem.scenario.comfort.direction;
    assess::posture_muscular(human, q_h_rad, &human.tool_pose_b(q_h_rad), &problem.wrench_t, direction)
}

/// How far along a segment a point is, from 0 to 1.
fn share_along(p: &Point3<f64>, p0: &Point3<f64>, p1: &Point3<f64>) -> f64 {
    let axis = p1 - p0;
    let length2 = axis.norm_squared();
    if length2 == 0.0 { 0.0 } else { ((p - p0).dot(&axis) / length2).clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::{
        super::super::{
            Count, Effort, RobotMap, Tally, Watch,
            assess::{Configured, comfort},
            propose,
        },
        super::linear::plain_margins,
        *,
    };
    use crate::{model::scenario::Budget, scenario::paper};

    /// The gradients against differences of the figures themselves, on starts of a search for a cut and a drill.
    #[test]
    fn rates_are_what_differences_say() {
        for name in ["cut-03", "drill-2"] {
            let operation = paper::operations().into_iter().find(|operation| operation.name == name).unwrap();
            let mut loaded = operation.load().unwrap();
            loaded.scenario.planner.budget = Budget::Fast;
            let map = RobotMap::new(&loaded.robot, loaded.scenario.object.size_m);
            let mut problem = Problem::new(&loaded.scenario, &map, Watch::unseen()).unwrap();
            let mut tally = Tally::new(Count::of_at_most(None));
            let starts = propose::best_candidates(&mut problem, &map.bank, &Effort::of(Budget::Fast), &mut tally);
            assert!(starts.len() > 2);
            starts.iter().for_each(|start| compare(&problem, start));
        }
    }

    fn compare(problem: &Problem<'_>, here: &Feasible) {
        /// Share of a move: errors go with it, rounding against it.
        const STEP: f64 = 1e-4;
        let moves = Moves::at(problem, &here.candidate, &here.configured.placed);
        let rates = Rates::new(problem, here, &moves);
        let (objective, plain) = (rates.objective_gradient(), rates.plain_gradients());
        let figures = |share: f64, number: usize| {
            let mut d = DVector::zeros(moves.count());
            d[number] = share;
            let candidate = moves.moved(&here.candidate, &d);
            let configured = Configured::new(problem, &candidate);
            let comfort = comfort(problem, &candidate, &configured);
            (comfort.objective, plain_margins(problem, &candidate, &configured, &comfort.activations))
        };
        let near = problem.map.collision.near(&here.configured.scene(problem), 0.06);
        let apart: Vec<_> = near.iter().map(|near| rates.near_gradient(near)).collect();
        assert_eq!(apart.len(), near.len());
        for number in 0..moves.count() {
            let [(forth, plain_forth), (back, plain_back)] = [STEP, -STEP].map(|share| figures(share, number));
            let slope = (forth - back) / (2.0 * STEP);
            // A worth of some hundred whose third derivatives are of order one; where a body point changes the robot's
            // point that is nearest to it within the step, a kink of some thousandths.
            let close = |found: f64, slope: f64, size: f64| (found - slope).abs() < 2e-3 * (size + slope.abs());
            assert!(close(objective[number], slope, 10.0), "objective, move {number}: {} {slope}", objective[number]);
            assert_eq!(plain.len(), plain_forth.len());
            for (row, gradient) in plain.iter().enumerate() {
                let slope = (plain_forth[row] - plain_back[row]) / (2.0 * STEP);
                assert!(close(gradient[number], slope, 0.1), "row {row}, move {number}: {} {slope}", gradient[number]);
            }
        }
    }
}
