//! The search for the zeros of the closed form's residual: one target, one angle of W1. The formulas are in
//! [`super::closed_form`].

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use super::geometry::Geometry;
use crate::model::frames::Pose;

/// Number of samples over the range of S0 that detect windows.
const WINDOW_SAMPLES: usize = 48;

/// Number of samples of the residual over a window as wide as the range of S0, and the minimum per window.
const RESIDUAL_SAMPLES: usize = 64;
const MIN_RESIDUAL_SAMPLES: usize = 8;

/// Number of golden sections that detect two zeros between samples: to 1 % of the spacing.
const DIP_SECTIONS: usize = 10;

/// Tangents of the elbow axis's rotation at which a fast rotation is sampled, in both directions.
const TURN_TANGENTS: [f64; 6] = [0.0, 0.3, 0.7, 1.2, 2.2, 5.0];

/// Distance of the first sample from an open end of a window, rad of theta.
const INSET: f64 = 1e-9;

/// Signs of the elbow's axis.
const ELBOW_SIGNS: [f64; 2] = [1.0, -1.0];

/// A target with one angle of W1, in the shoulder's frame.
pub(super) struct Slice<'a> {
    arm: &'a Geometry,
    /// W1 as in the formulas, rad.
    pub w1: f64,
    /// The wrist frame's axes.
    pub x: Vector3<f64>,
    pub y: Vector3<f64>,
    pub z: Vector3<f64>,
    wrist: Vector3<f64>,
    c0: Vector3<f64>,
    k: f64,
    /// `L1^2 + B^2`, m^2.
    length_squared: f64,
}

/// A solution of the slice.
pub(super) struct Zero {
    pub s0: f64,
    /// Which of the two W2, 1 or -1.
    pub w2_sign: f64,
    /// Sign of the elbow's axis, 1 or -1.
    pub elbow_sign: f64,
}

/// The elbow for given S0 and W2.
pub(super) struct Elbow {
    pub a1: Vector3<f64>,
    /// Sine and cosine of W2.
    w2_sin_cos: [f64; 2],
    /// From the intersection of S1 and E0 to that of E1 and W0, m.
    pub r: Vector3<f64>,
    /// The direction of the forearm.
    pub d: Vector3<f64>,
}

impl Elbow {
    /// W2, rad.
    pub fn w2(&self) -> f64 {
        let [sin, cos] = self.w2_sin_cos;
        sin.atan2(cos)
    }
}

/// The equation of W2, `x cos w2 - y sin w2 = n`, at one S0; m^2.
#[derive(Clone, Copy)]
struct Sample {
    s0: f64,
    x: f64,
    y: f64,
    n: f64,
}

impl Sample {
    /// Positive if two W2 solve the equation, zero where they merge, m^4.
    fn discriminant(&self) -> f64 {
        self.x * self.x + self.y * self.y - self.n * self.n
    }
}

/// A range of S0 in which the equation of the upper arm's length has solutions, rad.
#[derive(Clone, Copy)]
struct Window {
    from: f64,
    to: f64,
    /// True for an end at which both W2 merge, false for an end at a limit of S0.
    closes: [bool; 2],
}

impl Window {
    /// S0 and the sign of W2 for a parameter theta: one W2 for theta in [0, pi], the other in [pi, 2 pi]. Near an end at which W2
    /// merge, they vary as the root of the distance; in theta they are smooth.
    fn at(&self, theta: f64) -> (f64, f64) {
        let (middle, half) = (0.5 * (self.from + self.to), 0.5 * (self.to - self.from));
        (middle - half * theta.cos(), if theta.rem_euclid(TAU) <= PI { 1.0 } else { -1.0 })
    }

    /// Ranges of theta in which the residual is continuous. A closed curve overlaps itself by `spacing`, so every sample has
    /// neighbours.
    fn runs(&self, spacing: f64) -> Vec<[f64; 2]> {
        match self.closes {
            [true, true] => vec![[0.0, TAU + spacing]],
            [true, false] => vec![[-PI + INSET, PI - INSET]],
            [false, true] => vec![[INSET, TAU - INSET]],
            [false, false] => vec![[INSET, PI - INSET], [PI + INSET, TAU - INSET]],
        }
    }
}

impl<'a> Slice<'a> {
    pub fn new(arm: &'a Geometry, target: &Pose, w1_rad: f64) -> Self {
        let x_fm = arm.x_wf.inverse() * target * arm.x_gm;
        let axes = x_fm.rotation.to_rotation_matrix();
        let column = |number: usize| axes.matrix().column(number).into_owned();
        let w1 = w1_rad + arm.offset_rad[5];
        let (sin, cos) = w1.sin_cos();
        let [l2, c] = arm.forearm_m;
        let [l1, b] = arm.upper_arm_m;
        Self {
            arm,
            w1,
            x: column(0),
            y: column(1),
            z: column(2),
            wrist: x_fm.translation.vector,
            c0: x_fm.translation.vector - column(2) * (c * sin + l2 * cos),
            k: c * cos - l2 * sin,
            length_squared: l1 * l1 + b * b,
        }
    }

    /// r_M, m.
    pub fn wrist(&self) -> Vector3<f64> {
        self.wrist
    }

    /// `2 k b . q = |q|^2 + k^2 - L1^2 - B^2` in the terms of W2.
    fn sample(&self, s0: f64) -> Sample {
        let (sin, cos) = s0.sin_cos();
        let q = self.c0 - Vector3::new(cos, sin, 0.0) * self.arm.shoulder_m;
        let n = q.norm_squared() + self.k * self.k - self.length_squared;
        Sample { s0, x: 2.0 * self.k * self.x.dot(&q), y: 2.0 * self.k * self.y.dot(&q), n }
    }

    /// The elbow at an S0 within a window.
    pub fn elbow(&self, s0: f64, w2_sign: f64) -> Elbow {
        let Sample { x, y, n, .. } = self.sample(s0);
        let (sin, cos) = s0.sin_cos();
        let (u, a1) = (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0));
        // Solves the equation of W2 for cosine and sine.
        let (square, root) = (x * x + y * y, (x * x + y * y - n * n).max(0.0).sqrt() * w2_sign);
        let (cos2, sin2) = ((n * x + root * y) / square, (root * x - n * y) / square);
        let b = self.x * cos2 - self.y * sin2;
        let (sin1, cos1) = self.w1.sin_cos();
        let q = self.c0 - u * self.arm.shoulder_m;
        Elbow { a1, w2_sin_cos: [sin2, cos2], r: q - b * self.k, d: self.z * cos1 - b * sin1 }
    }

    /// The component of the forearm's direction normal to r, times |r|, m. The elbow's axis is normal to it.
    fn across(&self, window: &Window, theta: f64) -> Vector3<f64> {
        let (s0, w2_sign) = window.at(theta);
        let at = self.elbow(s0, w2_sign);
        (at.d * self.length_squared - at.r * at.r.dot(&at.d)) / self.length_squared.sqrt()
    }

    /// `f . a1` times `|r x d| (L1^2 + B^2)` for both signs of the elbow's axis; continuous wherever there is a W2.
    fn residuals(&self, window: &Window, theta: f64) -> [f64; 2] {
        let (s0, w2_sign) = window.at(theta);
        let at = self.elbow(s0, w2_sign);
        let [l1, b] = self.arm.upper_arm_m;
        let (along_r, along_d) = (at.r.dot(&at.a1), at.d.dot(&at.a1));
        let r_d = at.r.dot(&at.d);
        let m = (self.length_squared - r_d * r_d).max(0.0).sqrt();
        ELBOW_SIGNS.map(|sign| l1 * along_r * m - sign * b * (self.length_squared * along_d - r_d * along_r))
    }

    /// The zeros of the residual in a range of S0, rad; some may occur twice.
    pub fn zeros(&self, range: [f64; 2]) -> Vec<Zero> {
        let mut zeros = Vec::new();
        for window in self.windows(range) {
            let share = (window.to - window.from) / (range[1] - range[0]);
            let count = (share * RESIDUAL_SAMPLES as f64).max(MIN_RESIDUAL_SAMPLES as f64);
            let spacing = PI / count;
            for run in window.runs(spacing) {
                let places = self.places(&window, run, spacing);
                let residuals: Vec<[f64; 2]> = places.iter().map(|&theta| self.residuals(&window, theta)).collect();
                for (number, elbow_sign) in ELBOW_SIGNS.into_iter().enumerate() {
                    let residual = |theta: f64| self.residuals(&window, theta)[number];
                    let values = residuals.iter().map(|values| values[number]);
                    let mut samples: Vec<(f64, f64)> = places.iter().copied().zip(values).collect();
                    add_dips(&mut samples, residual);
                    for [before, after] in samples.array_windows() {
                        if before.1 * after.1 < 0.0 || after.1 == 0.0 {
                            let (s0, w2_sign) = window.at(zero_between(residual, *before, *after));
                            zeros.push(Zero { s0, w2_sign, elbow_sign });
                        }
                    }
                }
            }
        }
        zeros
    }

    /// Samples of the residual: evenly over the run, and densely where r and d are nearly parallel, since there the elbow's axis
    /// rotates by half a turn within `|across| / |across'|`.
    fn places(&self, window: &Window, run: [f64; 2], spacing: f64) -> Vec<f64> {
        let count = ((run[1] - run[0]) / spacing).ceil() as usize;
        let place = |number: usize| run[0] + (run[1] - run[0]) * number as f64 / count as f64;
        let mut places: Vec<f64> = (0..=count).map(place).collect();
        let across: Vec<Vector3<f64>> = places.iter().map(|&theta| self.across(window, theta)).collect();
        for number in 0..count {
            // The straight line through two samples of `across` and its point nearest to zero.
            let along = across[number + 1] - across[number];
            let share = -across[number].dot(&along) / along.norm_squared();
            let nearest = (across[number] + along * share).norm();
            if !(0.0..=1.0).contains(&share) || nearest > 2.0 * along.norm() {
                continue;
            }
            let (low, high) = (places[number], places[number + 1]);
            let (middle, width) = self.fast_turn(window, low + share * (high - low), high - low);
            let around = TURN_TANGENTS.iter().flat_map(|tangent| [middle - tangent * width, middle + tangent * width]);
            places.extend(around.filter(|theta| *theta > run[0] && *theta < run[1]));
        }
        places.sort_by(f64::total_cmp);
        places
    }

    /// The parameter near `theta` at which r and d are closest to parallel, and the width of the rotation there, rad of theta.
    fn fast_turn(&self, window: &Window, theta: f64, spacing: f64) -> (f64, f64) {
        let (mut middle, mut width) = (theta, spacing);
        // Newton's method on |across|^2 with differences over a shrinking width.
        for _ in 0..3 {
            let step = 0.1 * width.clamp(1e-6, spacing);
            let here = self.across(window, middle);
            let slope = (self.across(window, middle + step) - self.across(window, middle - step)) / (2.0 * step);
            let shift = here.dot(&slope) / slope.norm_squared();
            width = (here - slope * shift).norm() / slope.norm();
            middle -= shift.clamp(-spacing, spacing);
        }
        (middle, width)
    }

    /// The windows within the limits of S0.
    fn windows(&self, range: [f64; 2]) -> Vec<Window> {
        let samples = self.samples(range);
        let mut windows = Vec::new();
        let mut from = (samples[0].discriminant() >= 0.0).then_some((range[0], false));
        for [before, after] in samples.array_windows() {
            match from {
                None if after.discriminant() >= 0.0 => from = Some((self.edge(after.s0, before.s0), true)),
                Some((from_s0, closes)) if after.discriminant() < 0.0 => {
                    let to = self.edge(before.s0, after.s0);
                    windows.push(Window { from: from_s0, to, closes: [closes, true] });
                    from = None;
                }
                _ => {}
            }
        }
        windows.extend(from.map(|(from, closes)| Window { from, to: range[1], closes: [closes, false] }));
        windows
    }

    /// Samples of the discriminant, evenly spread, and at possible windows narrower than their spacing:
    /// the peaks of the parabolas through three negative samples, and the zeros of n between two.
    fn samples(&self, [lower, upper]: [f64; 2]) -> Vec<Sample> {
        let spacing = (upper - lower) / WINDOW_SAMPLES as f64;
        let mut samples: Vec<Sample> =
            (0..=WINDOW_SAMPLES).map(|number| self.sample(lower + spacing * number as f64)).collect();
        let mut between = Vec::new();
        for triple in samples.array_windows::<3>() {
            let [before, here, after] = triple.map(|sample| sample.discriminant());
            let (left, right) = (here - before, here - after);
            if here < 0.0 && left > 0.0 && right > 0.0 {
                between.push(self.sample(triple[1].s0 + 0.5 * spacing * (left - right) / (left + right)));
            }
        }
        for [before, after] in samples.array_windows() {
            if before.discriminant() < 0.0 && after.discriminant() < 0.0 && before.n * after.n < 0.0 {
                let n = |s0: f64| self.sample(s0).n;
                between.push(self.sample(zero_between(n, (before.s0, before.n), (after.s0, after.n))));
            }
        }
        samples.extend(between);
        samples.sort_by(|a, b| a.s0.total_cmp(&b.s0));
        samples
    }

    /// The last angle from `inside` to `outside` at which the discriminant is not negative.
    fn edge(&self, mut inside: f64, mut outside: f64) -> f64 {
        // 44 bisections of 0.07 rad reach the spacing of floating-point numbers.
        for _ in 0..44 {
            let middle = 0.5 * (inside + outside);
            if self.sample(middle).discriminant() >= 0.0 { inside = middle } else { outside = middle }
        }
        inside
    }
}

/// Adds samples at local extrema near zero that have the other sign, so that both zeros next to them are found. Golden section
/// search, until the sign changes or the extremum is bracketed.
fn add_dips(samples: &mut Vec<(f64, f64)>, value: impl Fn(f64) -> f64) {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut found = Vec::new();
    for [before, here, after] in samples.array_windows() {
        let sign = here.1.signum();
        if !(sign * before.1 >= sign * here.1 && sign * after.1 > sign * here.1 && sign * here.1 > 0.0) {
            continue;
        }
        let (mut low, mut high) = (before.0, after.0);
        for _ in 0..DIP_SECTIONS {
            let (left, right) = (high - golden * (high - low), low + golden * (high - low));
            let (at_left, at_right) = (sign * value(left), sign * value(right));
            if at_left.min(at_right) < 0.0 {
                let beyond = if at_left < at_right { (left, sign * at_left) } else { (right, sign * at_right) };
                found.push(beyond);
                break;
            }
            if at_left < at_right { high = right } else { low = left }
        }
    }
    samples.extend(found);
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
}

/// The zero between two points with values of different signs, by the Illinois variant of regula falsi.
fn zero_between(value: impl Fn(f64) -> f64, mut low: (f64, f64), mut high: (f64, f64)) -> f64 {
    let scale = low.1.abs().max(high.1.abs());
    // 1e-4 is sufficient for Newton's method; convergence of order 1.4 needs about a dozen steps.
    for _ in 0..30 {
        let place = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        if !place.is_finite() {
            break;
        }
        let here = (place, value(place));
        if here.1.abs() <= 1e-10 * scale {
            return place;
        }
        if here.1 * high.1 < 0.0 {
            low = high;
        } else {
            low.1 *= 0.5;
        }
        high = here;
    }
    high.0
}
