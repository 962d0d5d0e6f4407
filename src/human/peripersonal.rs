//! Peripersonal comfort: how far the robot stays from the person's body (METHOD section 5).
//!
//! Points in, metres out; this module knows neither bodies nor robots.

use nalgebra::Point3;

use crate::model::scenario::PeripersonalForm;

/// How many points of the person are compared with one of the robot at a time: enough to fill vector registers.
const LANES: usize = 8;

/// The peripersonal metric, m. With `d(p)` the distance from a point of the person to the nearest of the robot:
///
/// ```text
/// min:      min d(p)
/// mean:     (1/n) sum d(p)
/// weighted: (1/n) sum w(p) d(p),   w(p) = 1 - d(p) / sum d
/// ```
///
/// Both sets in the same frame. Infinite when one of them is empty: then nothing comes near.
pub fn peripersonal_m(form: PeripersonalForm, human_points: &[Point3<f64>], robot_points: &[Point3<f64>]) -> f64 {
    if human_points.is_empty() || robot_points.is_empty() {
        return f64::INFINITY;
    }
    let (mut least, mut sum, mut sum_of_squares) = (f64::INFINITY, 0.0, 0.0);
    for chunk in human_points.chunks(LANES) {
        for &squared in &least_squared_distances(chunk, robot_points)[..chunk.len()] {
            least = squared.min(least);
            sum += squared.sqrt();
            sum_of_squares += squared;
        }
    }
    let n = human_points.len() as f64;
    match form {
        PeripersonalForm::Min => least.sqrt(),
        PeripersonalForm::Mean => sum / n,
        // Every point touches: all distances, and so any mean of them, are zero.
        PeripersonalForm::Weighted if sum == 0.0 => 0.0,
        // sum (1 - d / D) d = D - (sum d^2) / D
        PeripersonalForm::Weighted => (sum - sum_of_squares / sum) / n,
    }
}

/// For up to [`LANES`] points of the person the squared distance to the nearest point of the robot, m^2. The person's
/// points lie side by side so that one instruction treats several.
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
            // Not `f64::min`, whose rule for NaN keeps this from becoming one instruction.
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
        assert_eq!(peripersonal_m(PeripersonalForm::Min, &human, &robot), 1.0);
        assert_eq!(peripersonal_m(PeripersonalForm::Mean, &human, &robot), 2.0);
        assert!((peripersonal_m(PeripersonalForm::Weighted, &human, &robot) - 11.0 / 9.0).abs() < 1e-15);
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
            assert!((peripersonal_m(form, &human, &robot) - value).abs() < 1e-13, "{form:?}");
        }
    }

    #[test]
    fn touching_everywhere_is_no_comfort_and_no_robot_is_endless_comfort() {
        let points = [Point3::origin(); 5];
        for form in FORMS {
            assert_eq!(peripersonal_m(form, &points, &points[..1]), 0.0);
            assert_eq!(peripersonal_m(form, &points, &[]), f64::INFINITY);
        }
    }
}
