//! First derivatives of a candidate's objective and constraints by its free variables.
//!
//! By the chain rule: what depends on the poses of links is differentiated by the arms' joints once, and the joints'
//! derivatives by the variables do the rest; board and body move as rigid bodies, and the person's working arm moves by the
//! axes of its joints.

use nalgebra::{DVector, Point3, Vector3};

use super::{
    super::{
        evaluate::Feasible,
        params::refine::{DIFFERENCE, PERSON_RAD, PLACE_M},
        problem::Problem,
    },
    variables::{RigidTwist, Variables, perturbed_grasp},
};
use crate::{
    collision::{BodyRef, NearPair},
    comfort,
    human::{self, BODY_POINTS, MuscularGradient, body_point_joints, peripersonal_pulls},
};

/// The person's joints.
const JOINTS: usize = 7;

/// A candidate and the derivatives of everything about it.
pub struct Jacobian<'a, 'p> {
    problem: &'a Problem<'p>,
    here: &'a Feasible,
    variables: &'a Variables,
    arms: Vec<ArmAxes>,
    /// Body points, W.
    body_w: [Point3<f64>; BODY_POINTS],
    /// The axes of the person's arm.
    person_axes: human::ArmAxes,
    /// Derivatives by the person's joints.
    muscular: MuscularGradient,
}

/// The axes of an arm's joints in W.
struct ArmAxes {
    origins_w: Vec<Point3<f64>>,
    axes_w: Vec<Vector3<f64>>,
}

impl<'a, 'p> Jacobian<'a, 'p> {
    /// Computes what all derivatives share.
    pub fn new(problem: &'a Problem<'p>, here: &'a Feasible, variables: &'a Variables) -> Self {
        let arms = problem.robot.arms.iter().zip(&here.candidate.arms).map(|(arm, own)| {
            let frames = arm.chain.joint_frames(&own.q_rad);
            ArmAxes {
                axes_w: arm.chain.axes_w(&frames),
                origins_w: frames.iter().map(|x_wj| x_wj.translation.vector.into()).collect(),
            }
        });
        let human = &problem.human;
        let (q_h_rad, x_wb) = (&here.candidate.work.q_h_rad, &here.configuration.placement.x_wb);
        Self {
            problem,
            here,
            variables,
            arms: arms.collect(),
            body_w: human.body_points_w(x_wb, q_h_rad),
            person_axes: human.arm_axes_w(x_wb, q_h_rad),
            muscular: human.muscular_gradient(q_h_rad, &problem.wrench_t, &problem.objective),
        }
    }

    fn zeros(&self) -> DVector<f64> {
        DVector::zeros(self.variables.count())
    }

    /// Gradient of the objective.
    pub fn objective_gradient(&self) -> DVector<f64> {
        let settings = &self.problem.objective;
        let robot = &self.problem.robot.robot;
        let robot_w = comfort::robot_points_w(robot, &self.here.configuration.link_poses);
        let pulls = peripersonal_pulls(settings.peripersonal, settings.saturation_m, &self.body_w, &robot_w);
        let mut gradient = self.zeros();
        let mut robot_pulls = vec![Vector3::zeros(); robot_w.len()];
        for (point, pull) in pulls.iter().enumerate() {
            let away = pull.away * settings.weight_peripersonal;
            robot_pulls[pull.nearest] -= away;
            self.add_person_point(body_point_joints(point), &self.body_w[point], &away, &mut gradient);
        }
        let points = robot.body_points.iter().zip(robot_w.iter().zip(&robot_pulls));
        self.add_link_points(points.map(|(point, (p_w, pull))| (point.link, *p_w, *pull)), &mut gradient);
        for (joint, slope) in self.muscular.regularised.iter().enumerate() {
            gradient[joint] += settings.weight_muscular * PERSON_RAD * slope;
        }
        gradient
    }

    /// Adds `along . v`, v the derivative by each variable of a point of the person that the first `joints` joints of the
    /// working arm move.
    fn add_person_point(&self, joints: usize, p_w: &Point3<f64>, along: &Vector3<f64>, gradient: &mut DVector<f64>) {
        for (number, work) in self.variables.work.iter().enumerate() {
            gradient[number] += along.dot(&work.body.at(p_w));
        }
        for joint in 0..joints {
            gradient[joint] += PERSON_RAD * along.dot(&self.person_axes.velocity_w(joint, p_w));
        }
    }

    /// Adds `sum along . v`, v the derivatives of points of links: the link, the point in W, and `along`.
    fn add_link_points(
        &self,
        points: impl Iterator<Item = (usize, Point3<f64>, Vector3<f64>)>,
        gradient: &mut DVector<f64>,
    ) {
        let mut of_joints: Vec<_> = self.arms.iter().map(|arm| DVector::zeros(arm.axes_w.len())).collect();
        for (link, p_w, along) in points {
            let Some((arm, last)) = self.problem.robot.moved_by[link] else { continue };
            let ArmAxes { origins_w, axes_w } = &self.arms[arm];
            let joints = of_joints[arm].iter_mut().zip(origins_w.iter().zip(axes_w)).take(last + 1);
            joints.for_each(|(sum, (origin_w, axis_w))| *sum += axis_w.dot(&(p_w - origin_w).cross(&along)));
        }
        for (derivatives, of_joints) in self.variables.joints.iter().zip(&of_joints) {
            gradient.gemv_tr(1.0, derivatives, of_joints, 1.0);
        }
    }

    /// Gradient of the distance of two bodies.
    pub fn distance_gradient(&self, near: &NearPair) -> DVector<f64> {
        let mut gradient = self.zeros();
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let (p_w, along) = (near.p_w[side], near.normal_w * sign);
            match near.bodies[side].0 {
                BodyRef::Link(link) => self.add_link_points(std::iter::once((link, p_w, along)), &mut gradient),
                BodyRef::Board => {
                    for (number, work) in self.variables.work.iter().enumerate() {
                        gradient[number] += along.dot(&work.board.at(&p_w));
                    }
                }
                BodyRef::Person(part) => {
                    let joints = self.here.configuration.person[part].name.joints();
                    self.add_person_point(joints, &p_w, &along, &mut gradient);
                }
            }
        }
        gradient
    }

    /// Gradients of the margins of [`super::linearization::simple_margins`], in their order.
    pub fn simple_gradients(&self) -> Vec<DVector<f64>> {
        let mut gradients = Vec::with_capacity(96);
        gradients.extend(self.posture_gradients().map(|gradient| self.of_person(&gradient)));
        gradients.extend(self.place_gradients());
        let mut between = |gradient: DVector<f64>| {
            let opposite = -&gradient;
            gradients.extend([gradient, opposite]);
        };
        between(self.single(8, PLACE_M));
        between(self.single(9, PLACE_M));
        between(self.of_board(|board| board.linear.z));
        for (arm, joints) in self.variables.joints.iter().enumerate() {
            for joint in 0..joints.nrows() {
                between(joints.row(joint).transpose());
            }
            let grasp = self.variables.of_grasp(arm);
            between(self.single(grasp.start + 1, self.problem.grasp_scales[1]));
            between(self.single(grasp.start + 2, self.problem.grasp_scales[2]));
        }
        let normal_w = self.here.configuration.placement.x_wo.rotation * Vector3::z();
        gradients.push(self.of_board(|board| board.angular.cross(&normal_w).x));
        gradients.extend((0..JOINTS).map(|joint| self.activation_gradient(joint)));
        gradients.extend((0..self.arms.len()).flat_map(|arm| self.pad_gradients(arm)));
        gradients
    }

    /// Gradients of the margins of the person's arm in its ranges, then of those of the work in a natural posture, by the
    /// person's joints.
    fn posture_gradients(&self) -> impl Iterator<Item = [f64; JOINTS]> + use<> {
        let Problem { human, normal_t, .. } = self.problem;
        let q_h_rad = &self.here.candidate.work.q_h_rad;
        let frames = human.arm().frames(q_h_rad);
        let of_ranges = human.arm().ranges.margin_gradients(&frames.r_bu, &frames.axes_b);
        of_ranges.into_iter().chain(human.work_margin_gradients(q_h_rad, normal_t))
    }

    /// Gradients of the margins of a given place; none if it is free.
    fn place_gradients(&self) -> Vec<DVector<f64>> {
        if !self.problem.human.place_is_given() {
            return Vec::new();
        }
        let along = |axis: Vector3<f64>| self.of_body(|body| body.linear.dot(&axis));
        let both = |gradient: DVector<f64>| [gradient.clone(), -gradient];
        [along(Vector3::x()), along(Vector3::y()), self.single(7, PERSON_RAD)].into_iter().flat_map(both).collect()
    }

    /// A gradient from derivatives by the person's joints.
    fn of_person(&self, by_joint: &[f64; JOINTS]) -> DVector<f64> {
        let mut gradient = self.zeros();
        for (joint, slope) in by_joint.iter().enumerate() {
            gradient[joint] = PERSON_RAD * slope;
        }
        gradient
    }

    /// A gradient with one entry.
    fn single(&self, number: usize, entry: f64) -> DVector<f64> {
        let mut gradient = self.zeros();
        gradient[number] = entry;
        gradient
    }

    /// A gradient from the body's derivatives.
    fn of_body(&self, derivative: impl Fn(&RigidTwist) -> f64) -> DVector<f64> {
        let mut gradient = self.zeros();
        for (number, work) in self.variables.work.iter().enumerate() {
            gradient[number] = derivative(&work.body);
        }
        gradient
    }

    /// A gradient from the board's derivatives.
    fn of_board(&self, derivative: impl Fn(&RigidTwist) -> f64) -> DVector<f64> {
        let mut gradient = self.zeros();
        for (number, work) in self.variables.work.iter().enumerate() {
            gradient[number] = derivative(&work.board);
        }
        gradient
    }

    /// Gradient of `1 - alpha` of one of the person's joints.
    fn activation_gradient(&self, joint: usize) -> DVector<f64> {
        let mut gradient = self.zeros();
        for (number, slope) in self.muscular.activations[joint].iter().enumerate() {
            gradient[number] = -PERSON_RAD * slope;
        }
        gradient
    }

    /// Gradients of the margins of a gripper's pads on the board.
    fn pad_gradients(&self, arm: usize) -> Vec<DVector<f64>> {
        let robot = self.problem.robot;
        let grasp = self.here.candidate.arms[arm].grasp;
        let margins_m = |grasp| robot.pad_margins_m(&robot.arms[arm], &grasp);
        let here_m = margins_m(grasp);
        let mut gradients = vec![self.zeros(); here_m.len()];
        for (part, number) in self.variables.of_grasp(arm).enumerate() {
            let there_m = margins_m(perturbed_grasp(grasp, &self.problem.grasp_scales, part, DIFFERENCE));
            for (side, gradient) in gradients.iter_mut().enumerate() {
                gradient[number] = (there_m[side] - here_m[side]) / DIFFERENCE;
            }
        }
        gradients
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::super::{
            evaluate::{Configuration, Evaluator, comfort},
            library::GraspLibrary,
            natural_boards::natural_entries,
            params::SearchBudget,
            search::{own_postures, screened},
            stats::SearchStats,
        },
        super::linearization::simple_margins,
        *,
    };
    use crate::{
        model::{
            scenario::{Budget, Scenario, StandingPlace},
            stop::Never,
        },
        reproduce::paper,
    };

    /// The gradients against differences of the figures themselves, on starts of a search for a cut and a drill: by the paper's
    /// person, by one who stands naturally, and by one who stands in a given place.
    #[test]
    fn gradients_equal_differences() {
        let given =
            StandingPlace::Given { p_wb_m: [1.0, -0.2], heading_deg: 185.0, tolerance_m: 0.3, tolerance_deg: 30.0 };
        let natural = paper::operations;
        for (operations, place) in
            [(paper::printed_operations(), StandingPlace::Free), (natural(), StandingPlace::Free), (natural(), given)]
        {
            for name in ["cut-03", "drill-2"] {
                let operation = operations.iter().find(|operation| operation.name == name).unwrap();
                let mut loaded = operation.load().unwrap();
                loaded.scenario.planner.budget = Budget::Fast;
                loaded.scenario.human.place = place;
                let clearance_m = loaded.scenario.limits.clearance_m();
                let library = GraspLibrary::new(&loaded.robot, &loaded.scenario.object.shape(), clearance_m);
                compare_starts(&loaded.scenario, &library);
            }
        }
    }

    /// As above, on a plate with slanted edges and a hole.
    #[test]
    fn gradients_equal_differences_on_a_plate() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plate-with-hole.toml");
        let mut loaded = crate::scenario::load(&path).unwrap();
        loaded.scenario.planner.budget = Budget::Fast;
        let clearance_m = loaded.scenario.limits.clearance_m();
        let library = GraspLibrary::new(&loaded.robot, &loaded.scenario.object.shape(), clearance_m);
        compare_starts(&loaded.scenario, &library);
    }

    fn compare_starts(scenario: &Scenario, library: &GraspLibrary) {
        let problem = Problem::new(scenario, &library.robot, &Never).unwrap();
        let postures = own_postures(&problem.human, scenario, &Never);
        let natural = natural_entries(scenario, &problem.human, &library.robot, &postures, 300, &Never);
        let mut evaluator = Evaluator::new(problem, SearchStats::unlimited(&Never));
        let starts = screened(&mut evaluator, library, &postures, &natural, &SearchBudget::of(scenario), &Never);
        assert!(starts.len() > 1, "{}: {}", scenario.name, starts.len());
        starts.iter().for_each(|start| compare(&evaluator.problem, start));
    }

    fn compare(problem: &Problem<'_>, here: &Feasible) {
        /// Truncation errors grow with it, rounding errors shrink.
        const STEP: f64 = 1e-4;
        let variables = Variables::new(problem, &here.candidate, &here.configuration.placement);
        let jacobian = Jacobian::new(problem, here, &variables);
        let (objective, simple) = (jacobian.objective_gradient(), jacobian.simple_gradients());
        let figures = |step: f64, number: usize| {
            let mut d = DVector::zeros(variables.count());
            d[number] = step;
            let candidate = variables.apply_linear(&here.candidate, &d);
            let configuration = Configuration::new(problem, &candidate);
            let comfort = comfort(problem, &candidate, &configuration);
            let simple = simple_margins(problem, &candidate, &configuration, &comfort.activations);
            (comfort.objective, simple)
        };
        let near = problem.robot.collision.near(&here.configuration.scene(problem), 0.06);
        let distances: Vec<_> = near.iter().map(|near| jacobian.distance_gradient(near)).collect();
        assert_eq!(distances.len(), near.len());
        for number in 0..variables.count() {
            let [(forth, simple_forth), (back, simple_back)] = [STEP, -STEP].map(|step| figures(step, number));
            let slope = (forth - back) / (2.0 * STEP);
            // An objective of some hundred whose third derivatives are of order one; where the robot point that is nearest to a
            // body point changes within the step, a kink of some thousandths.
            let close = |found: f64, slope: f64, size: f64| (found - slope).abs() < 2e-3 * (size + slope.abs());
            let found = objective[number];
            assert!(close(found, slope, 10.0), "objective, variable {number}: {found} {slope}");
            assert_eq!(simple.len(), simple_forth.len());
            for (row, gradient) in simple.iter().enumerate() {
                let slope = (simple_forth[row] - simple_back[row]) / (2.0 * STEP);
                let found = gradient[number];
                assert!(close(found, slope, 0.1), "margin {row}, variable {number}: {found} {slope}");
            }
        }
    }
}
