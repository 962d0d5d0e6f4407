//! Peripersonal comfort: distances between points of the person and points of the robot
//! (docs/method.md#5-peripersonal-comfort).

use nalgebra::{Point3, Vector3};

use crate::model::scenario::PeripersonalForm;

/// Number of the person's points that are compared with a point of the robot at a time; fills vector registers.
const LANES: usize = 8;

/// The peripersonal metric, m. With `d(p)` the distance from a point of the person to the nearest point of the robot, at most
/// `saturation_m`:
///
/// ```text
/// min:      min d(p)
/// mean:     (1/n) sum d(p)
/// weighted: (1/n) sum w(p) d(p),   w(p) = 1 - d(p) / sum d
/// ```
///
/// Both sets are in the same frame. Infinite if one of them is empty.
pub fn peripersonal_m(
    form: PeripersonalForm,
    saturation_m: Option<f64>,
    human_points: &[Point3<f64>],
    robot_points: &[Point3<f64>],
) -> f64 {
    let mut distances = Distances::new(saturation_m);
    distances.add(human_points, robot_points);
    distances.peripersonal_m(form)
}

/// Gradient of the metric by one point of the person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Index of the nearest point of the robot.
    pub nearest: usize,
    /// The gradient by the person's point, dimensionless, along the line from the robot's point. The gradient by the robot's
    /// point is its negative.
    pub away: Vector3<f64>,
}

/// The gradient of [`peripersonal_m`], one [`Pull`] per point of the person: with `D = sum d`,
///
/// ```text
/// min: 1 for the nearest point;   mean: 1/n;   weighted: (1 - 2 d/D + (sum d^2)/D^2) / n;   0 beyond the saturation
/// ```
///
/// Undefined where two points of the robot are equally near; there the first one is used.
pub fn peripersonal_pulls(
    form: PeripersonalForm,
    saturation_m: Option<f64>,
    human_points: &[Point3<f64>],
    robot_points: &[Point3<f64>],
) -> Vec<Pull> {
    if robot_points.is_empty() {
        return Vec::new();
    }
    let most_m = saturation_m.unwrap_or(f64::INFINITY);
    let nearest = |p: &Point3<f64>| {
        let squared = robot_points.iter().map(|robot| (p - robot).norm_squared()).enumerate();
        let (nearest, _) =
            squared.fold((0, f64::INFINITY), |least, other| if other.1 < least.1 { other } else { least });
        (nearest, p - robot_points[nearest])
    };
    let found: Vec<_> = human_points.iter().map(nearest).collect();
    let distances_m: Vec<_> = found.iter().map(|(_, apart)| apart.norm().min(most_m)).collect();
    let n = found.len() as f64;
    let (sum_m, sum_m2) = distances_m.iter().fold((0.0, 0.0), |(sum, sum2), d| (sum + d, sum2 + d * d));
    let least = distances_m.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map(|(point, _)| point);
    let slope = |point: usize| match form {
        _ if distances_m[point] >= most_m || distances_m[point] == 0.0 => 0.0,
        PeripersonalForm::Min => f64::from(least == Some(point)),
        PeripersonalForm::Mean => 1.0 / n,
        PeripersonalForm::Weighted => (1.0 - 2.0 * distances_m[point] / sum_m + sum_m2 / (sum_m * sum_m)) / n,
    };
    let pull = |(point, (nearest, apart)): (usize, &(usize, Vector3<f64>))| {
        let slope = slope(point);
        Pull { nearest: *nearest, away: if slope == 0.0 { Vector3::zeros() } else { apart * (slope / apart.norm()) } }
    };
    found.iter().enumerate().map(pull).collect()
}

/// Sums of the distances that the metric needs. Points may be added in parts, so the points that do not move with the arm are
/// evaluated once per standing pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distances {
    most_m2: f64,
    least_m2: f64,
    sum_m: f64,
    sum_m2: f64,
    count: usize,
    no_robot: bool,
}

impl Distances {
    /// No points. Distances saturate at `saturation_m`.
    pub fn new(saturation_m: Option<f64>) -> Self {
        let most_m2 = saturation_m.map_or(f64::INFINITY, |most_m| most_m * most_m);
        Self { most_m2, least_m2: f64::INFINITY, sum_m: 0.0, sum_m2: 0.0, count: 0, no_robot: false }
    }

    /// Adds points of the person. The robot's points must be the same in every call.
    pub fn add(&mut self, human_points: &[Point3<f64>], robot_points: &[Point3<f64>]) {
        self.no_robot = robot_points.is_empty();
        self.count += human_points.len();
        for chunk in human_points.chunks(LANES) {
            for &squared in &least_squared_distances(chunk, robot_points)[..chunk.len()] {
                let squared = squared.min(self.most_m2);
                self.least_m2 = squared.min(self.least_m2);
                self.sum_m += squared.sqrt();
                self.sum_m2 += squared;
            }
        }
    }

    /// The metric of all added points, as defined by [`peripersonal_m`].
    pub fn peripersonal_m(&self, form: PeripersonalForm) -> f64 {
        if self.count == 0 || self.no_robot {
            return f64::INFINITY;
        }
        let n = self.count as f64;
        match form {
            PeripersonalForm::Min => self.least_m2.sqrt(),
            PeripersonalForm::Mean => self.sum_m / n,
            // All distances are zero, and so is any mean of them.
            PeripersonalForm::Weighted if self.sum_m == 0.0 => 0.0,
            // sum (1 - d / D) d = D - (sum d^2) / D
            PeripersonalForm::Weighted => (self.sum_m - self.sum_m2 / self.sum_m) / n,
        }
    }
}

/// Squared distance to the nearest point of the robot, m^2, for up to [`LANES`] points of the person, in a layout that the
/// compiler vectorises.
fn least_squared_distances(human_points: &[Point3<f64>], robot_points: &[Point3<f64>]) -> [f64; LANES] {
    let mut lanes = [[0.0; LANES]; 3];
    for (lane, point) in human_points.iter().enumerate() {
        for axis in 0..3 {
            lanes[axis][lane] = point[axis];
        }
    }
    let mut least = [f64::INFINITY; LANES];
    for robot in robot_points {
        for lane in 0..LANES {
            let (dx, dy, dz) = (lanes[0][lane] - robot.x, lanes[1][lane] - robot.y, lanes[2][lane] - robot.z);
            let squared = dx * dx + dy * dy + dz * dz;
            // Not `f64::min`: its rule for NaN prevents vectorisation.
            least[lane] = if squared < least[lane] { squared } else { least[lane] };
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMS: [PeripersonalForm; 3] = [PeripersonalForm::Min, PeripersonalForm::Mean, PeripersonalForm::Weighted];

    #[test]
    fn three_points_by_hand() {
        let robot = [Point3::origin(), Point3::new(10.0, 0.0, 0.0)];
        let human = [Point3::new(0.0, 1.0, 0.0), Point3::new(10.0, 0.0, -2.0), Point3::new(0.0, 0.0, 3.0)];
        // d = 1, 2, 3 and sum d = 6: weights 5/6, 4/6, 3/6; (5 + 8 + 9) / 6 / 3 = 11/9.
        assert_eq!(peripersonal_m(PeripersonalForm::Min, None, &human, &robot), 1.0);
        assert_eq!(peripersonal_m(PeripersonalForm::Mean, None, &human, &robot), 2.0);
        assert!((peripersonal_m(PeripersonalForm::Weighted, None, &human, &robot) - 11.0 / 9.0).abs() < 1e-15);
    }

    #[test]
    fn any_number_of_points_gives_the_printed_formula() {
        // Points on two spirals; 19 and 13 leave an incomplete group of lanes.
        let spiral = |n: usize, x: f64| -> Vec<Point3<f64>> {
            (0..n).map(|i| i as f64).map(|i| Point3::new(x + 0.1 * i.cos(), 0.3 * i.sin(), 0.05 * i)).collect()
        };
        let (human, robot) = (spiral(19, 1.0), spiral(13, 0.0));
        let distance = |p: &Point3<f64>| robot.iter().map(|r| (p - r).norm()).fold(f64::INFINITY, f64::min);
        let d: Vec<f64> = human.iter().map(distance).collect();
        let (n, sum) = (d.len() as f64, d.iter().sum::<f64>());
        let weighted = d.iter().map(|d| (1.0 - d / sum) * d).sum::<f64>() / n;
        let expected = [d.iter().copied().fold(f64::INFINITY, f64::min), sum / n, weighted];
        for (form, value) in FORMS.into_iter().zip(expected) {
            // Sums of twenty numbers of order one in another order.
            assert!((peripersonal_m(form, None, &human, &robot) - value).abs() < 1e-13, "{form:?}");
        }
    }

    #[test]
    fn beyond_the_saturation_farther_is_no_better() {
        let robot = [Point3::origin()];
        let human = [1.0, 2.0, 3.0].map(|x| Point3::new(x, 0.0, 0.0));
        // d = 1, 2, 2 and sum d = 5: weights 4/5, 3/5, 3/5; (4 + 6 + 6) / 5 / 3 = 16/15.
        let of = |form, saturation_m| peripersonal_m(form, Some(saturation_m), &human, &robot);
        assert_eq!(of(PeripersonalForm::Mean, 2.0), 5.0 / 3.0);
        assert!((of(PeripersonalForm::Weighted, 2.0) - 16.0 / 15.0).abs() < 1e-15);
        assert_eq!(of(PeripersonalForm::Min, 0.5), 0.5);
        for form in FORMS {
            assert_eq!(of(form, 3.0), peripersonal_m(form, None, &human, &robot));
        }
    }

    #[test]
    fn points_may_come_a_few_at_a_time() {
        let robot = [Point3::origin(), Point3::new(0.4, 0.1, -0.3)];
        let human: Vec<_> = (0..20).map(f64::from).map(|i| Point3::new(0.1 * i, 1.0 - 0.05 * i, 0.3)).collect();
        let mut distances = Distances::new(Some(1.2));
        distances.add(&human[..7], &robot);
        distances.add(&human[7..], &robot);
        for form in FORMS {
            let at_once = peripersonal_m(form, Some(1.2), &human, &robot);
            // Twenty numbers of order one in another order.
            assert!((distances.peripersonal_m(form) - at_once).abs() < 1e-14);
        }
    }

    #[test]
    fn touching_everywhere_is_no_comfort_and_no_robot_is_endless_comfort() {
        let points = [Point3::origin(); 5];
        for form in FORMS {
            assert_eq!(peripersonal_m(form, None, &points, &points[..1]), 0.0);
            assert_eq!(peripersonal_m(form, None, &points, &[]), f64::INFINITY);
        }
    }

    #[test]
    fn pulls_are_the_gradient() {
        let robot = [Point3::origin(), Point3::new(0.4, 0.1, -0.3)];
        let human: Vec<_> = (0..20).map(f64::from).map(|i| Point3::new(0.1 * i, 1.0 - 0.05 * i, 0.3)).collect();
        const STEP: f64 = 1e-6;
        for form in FORMS {
            for saturation_m in [None, Some(1.0)] {
                let pulls = peripersonal_pulls(form, saturation_m, &human, &robot);
                let value = |human: &[Point3<f64>]| peripersonal_m(form, saturation_m, human, &robot);
                for (point, pull) in pulls.iter().enumerate() {
                    for axis in 0..3 {
                        let [mut forth, mut back] = [human.clone(), human.clone()];
                        forth[point][axis] += STEP;
                        back[point][axis] -= STEP;
                        let slope = (value(&forth) - value(&back)) / (2.0 * STEP);
                        // Rounding of values of order one over the step.
                        assert!((pull.away[axis] - slope).abs() < 1e-9, "{form:?} {point} {axis}: {pull:?} {slope}");
                    }
                }
            }
        }
        assert_eq!(peripersonal_pulls(PeripersonalForm::Mean, None, &human, &[]), []);
    }
}
