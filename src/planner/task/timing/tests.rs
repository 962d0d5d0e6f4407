use rand_pcg::Pcg64;

use super::{profile::Profile, spline::distance, *};
use crate::planner::domain::uniform;

/// Spacing of waypoints, 3 degrees.
const DENSE: f64 = 3.0 * std::f64::consts::PI / 180.0;

fn limits(velocity: &[f64], acceleration: &[f64]) -> MotionLimits {
    MotionLimits { velocity: velocity.to_vec(), acceleration: acceleration.to_vec() }
}

/// The waypoints of lines between corners, dense.
fn polyline(corners: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut path = vec![corners[0].clone()];
    for pair in corners.windows(2) {
        let count = (distance(&pair[0], &pair[1]) / DENSE).ceil().max(1.0) as usize;
        path.extend((1..=count).map(|k| {
            let share = k as f64 / count as f64;
            pair[0].iter().zip(&pair[1]).map(|(from, to)| from + share * (to - from)).collect()
        }));
    }
    path
}

/// Sums of sines of a parameter, each joint with its own amplitudes and phases, with waypoints at about the dense
/// spacing.
fn smooth(joints: usize, random: &mut Pcg64) -> Vec<Vec<f64>> {
    let waves: Vec<Vec<[f64; 3]>> = (0..joints)
        .map(|_| (0..3).map(|_| [(0.1, 0.6), (0.5, 3.0), (0.0, 6.3)].map(|(a, b)| uniform(random, a, b))).collect())
        .collect();
    let at = |p: f64| -> Vec<f64> {
        waves.iter().map(|waves| waves.iter().map(|[a, f, phase]| a * libm::sin(f * p + phase)).sum()).collect()
    };
    let mut path = vec![at(0.0)];
    for k in 1..=3000 {
        let q = at(f64::from(k) * 1e-3);
        if distance(&q, &path[path.len() - 1]) > DENSE {
            path.push(q);
        }
    }
    path
}

fn drawn_limits(joints: usize, random: &mut Pcg64) -> MotionLimits {
    let velocity = (0..joints).map(|_| uniform(random, 0.5, 2.0)).collect();
    let acceleration = (0..joints).map(|_| uniform(random, 1.0, 8.0)).collect();
    MotionLimits { velocity, acceleration }
}

/// Duration of a line of this length from rest to rest: a trapezoid or triangle of the velocity.
fn line_s(length: f64, velocity: f64, acceleration: f64) -> f64 {
    if length * acceleration > velocity * velocity {
        length / velocity + velocity / acceleration
    } else {
        2.0 * (length / acceleration).sqrt()
    }
}

/// The largest shares of the limits that the joints use at each inner sample, by differences of positions: of velocity,
/// of acceleration. Differences are means, so they are within limits that hold at every time.
fn shares(timed: &Timed, limits: &MotionLimits) -> Vec<[f64; 2]> {
    let joints = 0..limits.velocity.len();
    let share = |k: usize, joint: usize| {
        let [t0, t1, t2] = [k - 1, k, k + 1].map(|k| timed.time_s[k]);
        let [q0, q1, q2] = [k - 1, k, k + 1].map(|k| timed.q[k][joint]);
        let (v0, v1) = ((q1 - q0) / (t1 - t0), (q2 - q1) / (t2 - t1));
        let a = 2.0 * (v1 - v0) / (t2 - t0);
        [v0.abs().max(v1.abs()) / limits.velocity[joint], a.abs() / limits.acceleration[joint]]
    };
    let largest = |k: usize| {
        joints.clone().map(|joint| share(k, joint)).fold([0.0_f64; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])])
    };
    // The last interval may be so short that differences over it are rounding.
    (1..timed.time_s.len().saturating_sub(2)).map(largest).collect()
}

/// The limits hold at the points that are checked in each grid interval; between them they may be exceeded a little.
fn assert_within(timed: &Timed, limits: &MotionLimits) {
    for [velocity, acceleration] in shares(timed, limits) {
        assert!(velocity < 1.001 && acceleration < 1.01, "{velocity} {acceleration}");
    }
}

#[test]
fn a_straight_path_is_a_trapezoid_or_a_triangle() {
    let mut random = Pcg64::new(1, 0);
    for _ in 0..300 {
        let (length, velocity, acceleration) =
            (uniform(&mut random, 0.01, 3.0), uniform(&mut random, 0.2, 3.0), uniform(&mut random, 0.5, 10.0));
        let timed = time(&polyline(&[vec![0.2], vec![0.2 - length]]), &limits(&[velocity], &[acceleration])).unwrap();
        let least_s = line_s(length, velocity, acceleration);
        assert!(timed.duration_s() > least_s * (1.0 - 1e-9));
        assert!(timed.duration_s() < least_s * 1.01, "{} {least_s}", timed.duration_s());
        assert_within(&timed, &limits(&[velocity], &[acceleration]));
    }
}

#[test]
fn the_slower_joint_binds() {
    let path = polyline(&[vec![0.0, 0.0], vec![2.0, 1.0]]);
    // Joint 0 binds by its velocity, joint 1 by its acceleration: along joint 0, 1.0 rad/s and 2 x 0.6 rad/s².
    let timed = time(&path, &limits(&[1.0, 3.0], &[5.0, 0.6])).unwrap();
    let least_s = line_s(2.0, 1.0, 1.2);
    assert!((timed.duration_s() / least_s - 1.0).abs() < 0.01);
    let (q, velocity) = timed.at(timed.duration_s() / 2.0);
    assert!(distance(&q, &[1.0, 0.5]) < 1e-3 && (velocity[0] - 1.0).abs() < 1e-9 && (velocity[1] - 0.5).abs() < 1e-9);
}

#[test]
fn smooth_paths_keep_the_limits_and_use_them() {
    let mut random = Pcg64::new(2, 0);
    for number in 0..200 {
        let joints = [1, 2, 7, 14][number % 4];
        let (path, limits) = (smooth(joints, &mut random), drawn_limits(joints, &mut random));
        let timed = time(&path, &limits).unwrap();
        assert_within(&timed, &limits);
        let shares = shares(&timed, &limits);
        let active = shares.iter().filter(|[velocity, acceleration]| velocity.max(*acceleration) > 0.95).count();
        assert!(active as f64 > 0.9 * shares.len() as f64, "{joints} joints: {active} of {}", shares.len());
        assert_eq!((&timed.q[0], timed.q.last()), (&path[0], path.last()));
    }
}

#[test]
fn a_motion_is_continuous_and_at_rest_at_its_ends() {
    let mut random = Pcg64::new(3, 0);
    for _ in 0..100 {
        let (path, limits) = (smooth(3, &mut random), drawn_limits(3, &mut random));
        let timed = time(&path, &limits).unwrap();
        let end_s = timed.duration_s();
        for time_s in [-1.0, 0.0, end_s, end_s + 1.0] {
            let (q, velocity) = timed.at(time_s);
            assert_eq!(&q, if time_s > 0.0 { &path[path.len() - 1] } else { &path[0] });
            assert!(velocity.iter().all(|velocity| *velocity == 0.0));
        }
        let tau_s = 1e-4;
        let mut before = timed.at(0.0);
        for k in 1..=(end_s / tau_s) as usize + 1 {
            let after = timed.at(k as f64 * tau_s);
            for joint in 0..3 {
                let most = 1.01 * tau_s * limits.acceleration[joint];
                let change = after.1[joint] - before.1[joint];
                assert!(change.abs() < most);
                // Positions are the integral of velocities.
                let mean = 0.5 * (after.1[joint] + before.1[joint]);
                assert!((after.0[joint] - before.0[joint] - mean * tau_s).abs() < most * tau_s);
            }
            before = after;
        }
    }
}

#[test]
fn the_duration_scales_with_the_limits() {
    let mut random = Pcg64::new(4, 0);
    for _ in 0..100 {
        let (path, slow) = (smooth(4, &mut random), drawn_limits(4, &mut random));
        let c = uniform(&mut random, 0.2, 5.0);
        let fast = MotionLimits {
            velocity: slow.velocity.iter().map(|v| v * c).collect(),
            acceleration: slow.acceleration.iter().map(|a| a * c * c).collect(),
        };
        let [slow_s, fast_s] = [slow, fast].map(|limits| time(&path, &limits).unwrap().duration_s());
        // Equal but for rounding.
        assert!((slow_s / (c * fast_s) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_finer_grid_changes_the_duration_by_less_than_one_percent() {
    let mut random = Pcg64::new(5, 0);
    for _ in 0..40 {
        let (path, limits) = (distinct(&smooth(5, &mut random)), drawn_limits(5, &mut random));
        let [coarse_s, fine_s] =
            [8, 48].map(|points| Profile::on_grid(Spline::through(&path), &limits, points).duration_s());
        assert!((coarse_s / fine_s - 1.0).abs() < 0.01, "{coarse_s} {fine_s}");
    }
}

#[test]
fn the_joints_stop_at_corners() {
    let corners = [vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 0.5], vec![1.0, 0.2]];
    let limits = limits(&[1.0, 1.0], &[4.0, 2.0]);
    let timed = time(&polyline(&corners), &limits).unwrap();
    let parts_s = [line_s(1.0, 1.0, 4.0), line_s(0.5, 1.0, 2.0), line_s(0.3, 1.0, 2.0)];
    assert!((timed.duration_s() / parts_s.iter().sum::<f64>() - 1.0).abs() < 0.01);
    assert_eq!(timed.pieces.len(), 3);
    for ((start_s, _), corner) in timed.pieces.iter().zip(&corners) {
        let (q, velocity) = timed.at(*start_s);
        assert!(distance(&q, corner) < 1e-12 && velocity.iter().all(|velocity| velocity.abs() < 1e-9));
    }
    assert_within(&timed, &limits);
}

#[test]
fn a_motion_stays_near_its_polyline() {
    let mut random = Pcg64::new(6, 0);
    for number in 0..300 {
        // Corners from blunt to sharp, with the spacing of the waypoints and with longer chords.
        let (joints, turn, spacing) =
            ([2, 3, 7][number % 3], uniform(&mut random, 0.0, 0.8), uniform(&mut random, 0.02, 0.6));
        let mut direction: Vec<f64> = (0..joints).map(|_| uniform(&mut random, -1.0, 1.0)).collect();
        let mut path = vec![vec![0.0; joints]];
        for _ in 0..30 {
            direction.iter_mut().for_each(|part| *part += turn * uniform(&mut random, -1.0, 1.0));
            let length = distance(&direction, &vec![0.0; joints]);
            direction.iter_mut().for_each(|part| *part /= length);
            let next = path[path.len() - 1].iter().zip(&direction).map(|(q, part)| q + spacing * part).collect();
            path.push(next);
        }
        let path = if number % 2 == 0 { path } else { polyline(&path) };
        let limits = drawn_limits(joints, &mut random);
        let timed = time(&path, &limits).unwrap();
        assert_within(&timed, &limits);
        for q in &timed.q {
            let off = |pair: &[Vec<f64>]| {
                let chord: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(from, to)| to - from).collect();
                let along: f64 = (0..joints).map(|joint| (q[joint] - pair[0][joint]) * chord[joint]).sum();
                let share = (along / chord.iter().map(|part| part * part).sum::<f64>()).clamp(0.0, 1.0);
                (0..joints).map(|j| (q[j] - pair[0][j] - share * chord[j]).abs()).fold(0.0, f64::max)
            };
            // The deviation is measured at seven points in each interval: 2 % below its largest value at most.
            assert!(path.windows(2).map(off).fold(f64::INFINITY, f64::min) < 1.02 * DEVIATION);
        }
    }
}

#[test]
fn a_path_without_length_takes_no_time() {
    for path in [vec![vec![0.3, 0.4]], vec![vec![0.3, 0.4]; 5]] {
        let timed = time(&path, &limits(&[1.0; 2], &[1.0; 2])).unwrap();
        assert_eq!((&timed.time_s[..], &timed.q[..]), (&[0.0][..], &[vec![0.3, 0.4]][..]));
        assert_eq!(timed.at(0.5), (vec![0.3, 0.4], vec![0.0, 0.0]));
    }
    // Shorter than what distinguishes waypoints: the ends stay.
    let timed = time(&[vec![0.0], vec![1e-8]], &limits(&[1.0], &[1.0])).unwrap();
    assert!((timed.duration_s() / line_s(1e-8, 1.0, 1.0) - 1.0).abs() < 0.01);
    assert_eq!(time(&[vec![0.0], vec![1e-300]], &limits(&[1.0], &[1.0])).unwrap().q, [[1e-300]]);
}

#[test]
fn repeated_waypoints_change_nothing_and_the_same_path_gives_the_same_bytes() {
    let mut random = Pcg64::new(7, 0);
    for _ in 0..50 {
        let (path, limits) = (smooth(3, &mut random), drawn_limits(3, &mut random));
        let repeated: Vec<_> = path.iter().flat_map(|q| [q.clone(), q.clone()]).collect();
        let [first, second, third] = [&path, &path, &repeated].map(|path| time(path, &limits).unwrap());
        let bytes = |timed: &Timed| -> Vec<u64> {
            timed.time_s.iter().chain(timed.q.iter().flatten()).map(|number| number.to_bits()).collect()
        };
        assert_eq!(bytes(&first), bytes(&second));
        assert_eq!(bytes(&first), bytes(&third));
    }
}

#[test]
fn samples_are_ten_milliseconds_apart_and_the_last_one_is_the_end() {
    let timed = time(&polyline(&[vec![0.0], vec![1.0]]), &limits(&[1.0], &[4.0])).unwrap();
    let (end_s, before) = timed.time_s.split_last().unwrap();
    assert!(before.iter().enumerate().all(|(k, time_s)| *time_s == k as f64 / 100.0));
    let last_s = end_s - before[before.len() - 1];
    assert!(0.0 < last_s && last_s <= 0.01 + 1e-9);
    assert_eq!((timed.q.len(), timed.q.last()), (timed.time_s.len(), Some(&vec![1.0])));
}

#[test]
fn wrong_input_is_an_error() {
    let fine = limits(&[1.0], &[1.0]);
    let cases = [
        (vec![], fine.clone(), TimingError::Empty),
        (vec![vec![0.0], vec![0.0, 1.0]], fine.clone(), TimingError::Lengths),
        (vec![vec![0.0]], limits(&[1.0], &[]), TimingError::Lengths),
        (vec![vec![0.0], vec![f64::NAN]], fine, TimingError::Waypoint),
        (vec![vec![0.0]], limits(&[0.0], &[1.0]), TimingError::Limit),
        (vec![vec![0.0]], limits(&[1.0], &[f64::INFINITY]), TimingError::Limit),
    ];
    for (path, limits, error) in cases {
        assert_eq!(time(&path, &limits), Err(error));
    }
}
