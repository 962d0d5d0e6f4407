//! Points of the unit cube, each by its index alone (`docs/method.md#102-draws`).

use rand::Rng;
use rand_pcg::Pcg64;

use crate::model::sweep::Sampling;

/// The direction numbers of Joe and Kuo: a header, then one row `d s a m_1 ... m_s` for each dimension but the first.
const JOE_KUO: &str = include_str!("../../assets/sweep/new-joe-kuo-6.256.txt");

/// The digits of a Sobol point.
const DIGITS: usize = 32;

/// The bits of a coordinate: with half of the last one added it lies between 0 and 1 and is exact.
const BITS: u32 = 52;

/// Points of the unit cube in the order of their indices.
#[derive(Clone, Debug)]
pub struct Points {
    sampling: Sampling,
    seed: u64,
    dimensions: usize,
    /// The direction numbers and the key of the scrambling of each dimension of Sobol points.
    directions: Vec<([u32; DIGITS], u64)>,
}

impl Points {
    /// The most dimensions of Sobol points.
    pub const MOST_DIMENSIONS: usize = 256;

    /// Points with a number of dimensions, of Sobol points at most [`Points::MOST_DIMENSIONS`]: further ones are left out.
    #[must_use]
    pub fn new(sampling: Sampling, seed: u64, dimensions: usize) -> Self {
        let directions = match sampling {
            Sampling::Independent => Vec::new(),
            Sampling::Sobol => directions(dimensions).into_iter().zip((1..).map(|place| hash(seed, place))).collect(),
        };
        let dimensions = if sampling == Sampling::Sobol { directions.len() } else { dimensions };
        Self { sampling, seed, dimensions, directions }
    }

    /// The number of dimensions.
    #[must_use]
    pub fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// A point: its coordinates are above 0 and below 1. It does not depend on the number of points, and a coordinate not on
    /// the number of dimensions. Sobol points repeat from index 2^32 on.
    #[must_use]
    pub fn point(&self, index: u64) -> Vec<f64> {
        match self.sampling {
            Sampling::Sobol => self.directions.iter().map(|(of, key)| sobol(of, *key, index as u32)).collect(),
            Sampling::Independent => {
                let state = u128::from(hash(self.seed, index)) << 64 | u128::from(hash(!self.seed, index));
                let mut random = Pcg64::new(state, u128::from(index));
                (0..self.dimensions).map(|_| coordinate(random.next_u64())).collect()
            }
        }
    }
}

/// A coordinate from the first bits of a random number.
fn coordinate(random: u64) -> f64 {
    ((random >> (u64::BITS - BITS)) as f64 + 0.5) / (1_u64 << BITS) as f64
}

/// A coordinate of a scrambled Sobol point. Behind its digits follow random ones, as in a scrambling without end.
fn sobol(directions: &[u32; DIGITS], key: u64, index: u32) -> f64 {
    let digits = scrambled(digits(directions, index), key);
    let further = hash(!key, u64::from(index)) >> DIGITS;
    coordinate(u64::from(digits) << DIGITS | further)
}

/// The digits of a coordinate of a Sobol point, the first in the highest bit. The order is that of the Gray code, as in the
/// program of Joe and Kuo.
fn digits(directions: &[u32; DIGITS], index: u32) -> u32 {
    let gray = index ^ (index >> 1);
    let chosen = directions.iter().enumerate().filter(|(bit, _)| gray >> bit & 1 == 1);
    chosen.fold(0, |digits, (_, direction)| digits ^ direction)
}

/// Owen's scrambling: each digit is flipped or not by a random bit that belongs to the digits before it.
fn scrambled(digits: u32, key: u64) -> u32 {
    (0..DIGITS as u32).fold(0, |scrambled, place| {
        // The digits before, behind a one: no two of different length are the same.
        let before = (u64::from(digits) | 1 << DIGITS) >> (DIGITS as u32 - place);
        let flip = (hash(key, before) >> 63) as u32;
        scrambled << 1 | (digits >> (DIGITS as u32 - 1 - place) & 1 ^ flip)
    })
}

/// A number that looks random, by a key and a number: the finaliser of SplitMix64 (Steele, Lea and Flood, Fast splittable
/// pseudorandom number generators, 2014), twice.
fn hash(key: u64, number: u64) -> u64 {
    mix(mix(key.wrapping_add(0x9e37_79b9_7f4a_7c15)) ^ mix(number.wrapping_add(0x9e37_79b9_7f4a_7c15)))
}

fn mix(mut number: u64) -> u64 {
    number = (number ^ (number >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    number = (number ^ (number >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    number ^ (number >> 31)
}

/// The direction numbers of the first dimensions, the first digit in the highest bit.
fn directions(dimensions: usize) -> Vec<[u32; DIGITS]> {
    let van_der_corput: [u32; DIGITS] = std::array::from_fn(|bit| 1 << (DIGITS - 1 - bit));
    let rows = JOE_KUO.lines().skip(1).map(|row| {
        let numbers: Vec<u32> = row.split_whitespace().filter_map(|number| number.parse().ok()).collect();
        recurrence(numbers[2], &numbers[3..])
    });
    std::iter::once(van_der_corput).chain(rows).take(dimensions).collect()
}

/// The direction numbers of a primitive polynomial with the inner coefficients `a` and the first numbers `m` (Joe and Kuo,
/// Constructing Sobol sequences with better two-dimensional projections, SIAM J. Sci. Comput. 30, 2008, equation 2.2).
fn recurrence(a: u32, m: &[u32]) -> [u32; DIGITS] {
    let degree = m.len();
    let mut numbers = [0_u32; DIGITS];
    for bit in 0..DIGITS {
        numbers[bit] = match m.get(bit) {
            Some(first) => first << (DIGITS - 1 - bit),
            None => {
                let inner = (1..degree).filter(|part| a >> (degree - 1 - part) & 1 == 1);
                let last = numbers[bit - degree];
                inner.fold(last ^ (last >> degree), |number, part| number ^ numbers[bit - part])
            }
        };
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(dimensions: usize, index: u32) -> Vec<f64> {
        directions(dimensions).iter().map(|of| f64::from(digits(of, index)) / 4_294_967_296.0).collect()
    }

    /// The first points that the program of Joe and Kuo prints in three dimensions (their page on Sobol sequences).
    #[test]
    fn the_first_points_are_the_published_ones() {
        let published = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
            [0.1875, 0.3125, 0.9375],
            [0.6875, 0.8125, 0.4375],
        ];
        for (index, point) in published.iter().enumerate() {
            assert_eq!(plain(3, index as u32), point, "point {index}");
        }
    }

    /// Every dimension is a permutation of the multiples of 1/2^m, before and after the scrambling.
    #[test]
    fn each_dimension_has_one_point_in_each_part() {
        let count = 1 << 10;
        let points = Points::new(Sampling::Sobol, 7, Points::MOST_DIMENSIONS);
        assert_eq!(points.dimensions(), 256);
        let mut seen = vec![vec![0; count]; 256];
        for index in 0..count {
            for (seen, coordinate) in seen.iter_mut().zip(points.point(index as u64)) {
                seen[(coordinate * count as f64) as usize] += 1;
            }
        }
        assert!(seen.iter().flatten().all(|&times| times == 1));
    }

    /// A (0, m, 2)-net in base 2: each elementary box of volume 1/2^m has one point, also of later blocks of 2^m points.
    #[test]
    fn the_first_two_dimensions_are_a_net() {
        let m = 8;
        for (seed, block) in [(1, 0), (1, 3), (2, 1 << 20), (3, (1 << 24) - 1)] {
            let points = Points::new(Sampling::Sobol, seed, 2);
            let of_block: Vec<_> = (0..1 << m).map(|point| points.point((block << m) + point)).collect();
            for across in 0..=m {
                let [columns, rows] = [1_usize << across, 1 << (m - across)];
                let mut boxes = vec![0; columns * rows];
                for point in &of_block {
                    let [x, y] = [point[0] * columns as f64, point[1] * rows as f64].map(|place| place as usize);
                    boxes[x * rows + y] += 1;
                }
                assert!(boxes.iter().all(|&points| points == 1), "seed {seed}, block {block}, {columns} columns");
            }
        }
    }

    #[test]
    fn a_point_does_not_depend_on_the_number_of_dimensions_and_does_on_the_seed() {
        for sampling in [Sampling::Sobol, Sampling::Independent] {
            let [few, many] = [3, 20].map(|dimensions| Points::new(sampling, 5, dimensions));
            let other = Points::new(sampling, 6, 3);
            for index in [0, 1, 99, (1 << 31) - 1] {
                assert_eq!(few.point(index), many.point(index)[..3]);
                assert!(few.point(index).iter().zip(other.point(index)).all(|(a, b)| *a != b));
                assert!(many.point(index).iter().all(|&coordinate| coordinate > 0.0 && coordinate < 1.0));
            }
        }
        assert!(coordinate(0) > 0.0 && coordinate(u64::MAX) < 1.0);
    }

    /// Over many scramblings each coordinate of one point is uniform: the Kolmogorov distance of 4,000 values is below
    /// 1.95 / sqrt(4000), which it exceeds with a probability of 0.001; the seeds are fixed.
    #[test]
    fn a_scrambled_point_is_uniform() {
        for sampling in [Sampling::Sobol, Sampling::Independent] {
            for index in [0, 1, 77] {
                let mut values: Vec<Vec<f64>> =
                    (0..4000).map(|seed| Points::new(sampling, seed, 5).point(index)).collect();
                for dimension in 0..5 {
                    values.sort_by(|a, b| a[dimension].total_cmp(&b[dimension]));
                    let distance =
                        |(rank, value): (usize, &Vec<f64>)| (value[dimension] - (rank as f64 + 0.5) / 4000.0).abs();
                    let largest = values.iter().enumerate().map(distance).fold(0.0, f64::max);
                    assert!(largest < 1.95 / 4000_f64.sqrt(), "{sampling:?} {index} {dimension}: {largest}");
                }
            }
        }
    }

    /// Warnock's formula of the L2 star discrepancy, squared.
    fn discrepancy(points: &[Vec<f64>]) -> f64 {
        let (count, dimensions) = (points.len() as f64, points[0].len() as i32);
        let single = |point: &Vec<f64>| point.iter().map(|x| (1.0 - x * x) / 2.0).product::<f64>();
        let pair = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| 1.0 - a.max(*b)).product::<f64>();
        let pairs = points.iter().flat_map(|a| points.iter().map(move |b| (a, b)));
        3_f64.powi(-dimensions) - 2.0 / count * points.iter().map(single).sum::<f64>()
            + pairs.map(pair).sum::<f64>() / (count * count)
    }

    /// Independent points have the expected squared discrepancy (2^-d - 3^-d) / n; Sobol points far less.
    #[test]
    fn sobol_points_are_more_even_than_independent_ones() {
        let (count, dimensions) = (512, 5);
        let expected = (0.5_f64.powi(dimensions) - (1.0 / 3.0_f64).powi(dimensions)) / f64::from(count);
        let of = |sampling, seed| {
            let points = Points::new(sampling, seed, dimensions as usize);
            discrepancy(&(0..count as u64).map(|index| points.point(index)).collect::<Vec<_>>()) / expected
        };
        let mean = |sampling| (0..10).map(|seed| of(sampling, seed)).sum::<f64>() / 10.0;
        let independent = mean(Sampling::Independent);
        // The ratio of one sample varies by less than its mean, so that of ten by less than a third.
        assert!((0.4..2.0).contains(&independent), "{independent}");
        let sobol = mean(Sampling::Sobol);
        // A quarter: half the discrepancy, for which four times as many independent points would be needed.
        assert!(sobol < 0.25, "{sobol}");
    }

    /// Streams of neighbouring indices are independent: correlations of 20,000 pairs are below 4 standard errors.
    #[test]
    fn neighbouring_independent_points_are_not_correlated() {
        let points = Points::new(Sampling::Independent, 1, 3);
        let drawn: Vec<_> = (0..20_001).map(|index| points.point(index)).collect();
        for (a, b, later) in [(0, 0, 1), (0, 1, 0), (1, 2, 0), (2, 0, 1), (1, 1, 1)] {
            let product = |index: usize| (drawn[index][a] - 0.5) * (drawn[index + later][b] - 0.5) * 12.0;
            let correlation = (0..20_000).map(product).sum::<f64>() / 20_000.0;
            assert!(correlation.abs() < 4.0 / 20_000_f64.sqrt(), "{a} {b} {later}: {correlation}");
        }
    }
}
