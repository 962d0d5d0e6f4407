//! The largest values that a scenario or a plan may state (docs/method.md#13-bounds-of-input).
//!
//! They exclude what cannot be meant: a wrong unit, a slip of the keyboard, a number near the end of the range of numbers,
//! with which figures overflow. They are far beyond any hold that this program can judge, so a value below them may still
//! be infeasible.

/// Force, N: the weight of a tonne. The strongest arms that grip a board exert less than a tenth.
pub const MOST_FORCE_N: f64 = 1e4;

/// Moment, N m: the largest force at a lever of 0.1 m; a person exerts less than a tenth.
pub const MOST_MOMENT_NM: f64 = 1e3;

/// Distance from an origin along an axis, m: twice the longest board, and a room.
pub const MOST_PLACE_M: f64 = 10.0;

/// Weight of a comfort: larger ones leave nothing of the other, which has weight 0 for that.
pub const MOST_WEIGHT: f64 = 1e6;

/// Board, kg: the longest board of 40 mm of the densest material.
pub const MOST_MASS_KG: f64 = 25_000.0;

/// A limit of a figure, in the figure's unit: no limit at all, practically.
pub const MOST_LIMIT: f64 = 1e6;

/// Time in a file of measured forces, s: eleven days.
pub const MOST_TIME_S: f64 = 1e6;

/// True if a force and a moment are within their bounds; false if one is not a number.
#[must_use]
pub fn wrench_is_within(components: &[f64; 6]) -> bool {
    let [forces, moments] = [&components[..3], &components[3..]];
    forces.iter().all(|force_n| force_n.abs() <= MOST_FORCE_N)
        && moments.iter().all(|moment_nm| moment_nm.abs() <= MOST_MOMENT_NM)
}

/// What [`wrench_is_within`] expects, in words.
#[must_use]
pub fn wrench_in_words() -> String {
    format!("forces up to {MOST_FORCE_N} N and moments up to {MOST_MOMENT_NM} N m")
}
