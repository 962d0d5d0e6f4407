//! A plate: a convex outline with holes, extruded along z_O (docs/method.md#24-board).

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::polygon::{
    AreaMoments, Point, contains, convex_hull, cross, crossing_side, distance_from_sides_m, distance_m,
    distance_of_sides_m, separation_m, sides,
};

/// The largest number of corners of an outline or a hole.
pub const MOST_CORNERS: usize = 64;
/// The largest number of holes.
pub const MOST_HOLES: usize = 16;
/// Sides of the polygon that stands for a round hole.
pub const ROUND_SIDES: usize = 32;
/// The least length of a side, width of a hole, and width of the material between holes or between a hole and the outline, m:
/// the least side of a board.
const LEAST_M: f64 = 0.001;
/// The least turn of the outline at a corner, rad: 0.1 degrees, far above the rounding of written corners.
const LEAST_TURN_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// The largest coordinate of a corner, m: the longest side of a board.
const MOST_M: f64 = 5.0;

/// A plate in O's x-y plane; its thickness is that of its board. Clones share their data.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "PlateRecord", into = "PlateRecord")]
pub struct Plate(Arc<PlateData>);

/// The form of a plate in files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlateRecord {
    /// The corners of the convex outline in O, counter-clockwise seen from +z_O, m.
    pub outline_m: Vec<Point>,
    /// The corners of each hole in O, m.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub holes_m: Vec<Vec<Point>>,
}

#[derive(Debug)]
struct PlateData {
    record: PlateRecord,
    sides: Vec<OutlineSide>,
    /// Convex hulls of the holes, from which pads keep away.
    hole_hulls_m: Vec<Vec<Point>>,
    moments: AreaMoments,
}

/// A side of an outline: the points `p` with `outward . p = reach_m`, from `along_m[0]` to `along_m[1]` in the direction
/// `z_O x outward`, counted from the foot of the perpendicular from O.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineSide {
    /// Outward unit normal.
    pub outward: Point,
    /// Distance from O, m.
    pub reach_m: f64,
    /// Its two ends, m.
    pub along_m: [f64; 2],
}

/// What of a plate is at fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlatePart {
    /// The outline.
    Outline,
    /// A corner of the outline.
    Corner(usize),
    /// The holes.
    Holes,
    /// A hole.
    Hole(usize),
}

/// A fault of a plate.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateFault {
    /// What is at fault.
    pub part: PlatePart,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

impl From<PlateRecord> for Plate {
    fn from(mut record: PlateRecord) -> Self {
        for hole in &mut record.holes_m {
            if AreaMoments::of(hole).area_m2 < 0.0 {
                hole.reverse();
            }
        }
        let outline = AreaMoments::of(&record.outline_m);
        let moments = record.holes_m.iter().fold(outline, |all, hole| all.without(&AreaMoments::of(hole)));
        Self(Arc::new(PlateData {
            sides: sides(&record.outline_m).map(OutlineSide::of).collect(),
            hole_hulls_m: record.holes_m.iter().map(|hole| convex_hull(hole)).collect(),
            moments,
            record,
        }))
    }
}

impl From<Plate> for PlateRecord {
    fn from(plate: Plate) -> Self {
        plate.0.record.clone()
    }
}

impl PartialEq for Plate {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0.record == other.0.record
    }
}

impl JsonSchema for Plate {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        PlateRecord::schema_name()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        PlateRecord::json_schema(generator)
    }
}

impl OutlineSide {
    fn of((a, b): (Point, Point)) -> Self {
        let length_m = distance_m(a, b);
        let outward = [(b[1] - a[1]) / length_m, (a[0] - b[0]) / length_m];
        let along = |p: Point| outward[0] * p[1] - outward[1] * p[0];
        Self { outward, reach_m: outward[0] * a[0] + outward[1] * a[1], along_m: [along(a), along(b)] }
    }

    /// Distance of a point inside the side's line, m; negative outside.
    fn depth_m(&self, p: Point) -> f64 {
        self.reach_m - (self.outward[0] * p[0] + self.outward[1] * p[1])
    }
}

impl Plate {
    /// The corners of the outline, counter-clockwise, m.
    #[must_use]
    pub fn outline_m(&self) -> &[Point] {
        &self.0.record.outline_m
    }

    /// The corners of each hole, counter-clockwise, m.
    #[must_use]
    pub fn holes_m(&self) -> &[Vec<Point>] {
        &self.0.record.holes_m
    }

    /// The sides of the outline; side `k` is from corner `k` to the next.
    #[must_use]
    pub fn sides(&self) -> &[OutlineSide] {
        &self.0.sides
    }

    /// The moments of the area without the holes.
    #[must_use]
    pub fn moments(&self) -> &AreaMoments {
        &self.0.moments
    }

    /// The smallest and the largest coordinates of the outline, m.
    #[must_use]
    pub fn bounds_m(&self) -> [Point; 2] {
        let fold = |start: f64, of: fn(f64, f64) -> f64| {
            [0, 1].map(|axis| self.outline_m().iter().map(|corner| corner[axis]).fold(start, of))
        };
        [fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Distance of a point of the material from the nearest side of the outline or a hole, m; negative outside the outline and in
    /// a hole.
    #[must_use]
    pub fn depth_m(&self, p: Point) -> f64 {
        let from_outline_m = self.sides().iter().map(|side| side.depth_m(p)).fold(f64::INFINITY, f64::min);
        self.holes_m().iter().fold(from_outline_m, |least_m, hole| {
            let from_hole_m = distance_from_sides_m(hole, p);
            least_m.min(if contains(hole, p) { -from_hole_m } else { from_hole_m })
        })
    }

    /// How far a convex, counter-clockwise patch is inside each side of the outline and away from the convex hull of each hole,
    /// m; negative where it is not.
    #[must_use]
    pub fn patch_margins_m(&self, patch: &[Point]) -> Vec<f64> {
        let inside = |side: &OutlineSide| patch.iter().map(|&p| side.depth_m(p)).fold(f64::INFINITY, f64::min);
        let of_sides = self.sides().iter().map(inside);
        of_sides.chain(self.0.hole_hulls_m.iter().map(|hull| separation_m(patch, hull))).collect()
    }

    /// The least width of material across the way from one point to another, m: of all sections normal to the way between them.
    #[must_use]
    pub fn narrowest_section_m(&self, from: Point, to: Point) -> f64 {
        let length_m = distance_m(from, to);
        let unit = [(to[0] - from[0]) / length_m, (to[1] - from[1]) / length_m];
        let place = |p: Point| {
            [
                (p[0] - from[0]) * unit[0] + (p[1] - from[1]) * unit[1],
                (p[1] - from[1]) * unit[0] - (p[0] - from[0]) * unit[1],
            ]
        };
        let placed: Vec<Vec<Point>> = std::iter::once(self.outline_m())
            .chain(self.holes_m().iter().map(Vec::as_slice))
            .map(|corners| corners.iter().map(|&corner| place(corner)).collect())
            .collect();
        // Between the places of corners the width changes linearly, at them it may jump.
        let corners = placed.iter().flatten().map(|corner| corner[0]).filter(|at_m| (0.0..length_m).contains(at_m));
        let mut places_m: Vec<f64> = corners.chain([0.0, length_m]).collect();
        places_m.sort_by(f64::total_cmp);
        let width = |at_m: f64| {
            let (outline, holes) = placed.split_at(1);
            holes.iter().fold(section_m(&outline[0], at_m), |width_m, hole| width_m - section_m(hole, at_m))
        };
        let spans = places_m.windows(2).filter(|span| span[1] - span[0] > SAME_CORNER_M);
        let ends = spans.flat_map(|span| {
            let [first, second] = [1.0 / 3.0, 2.0 / 3.0].map(|share| width(span[0] + share * (span[1] - span[0])));
            [2.0 * first - second, 2.0 * second - first]
        });
        ends.fold(f64::INFINITY, f64::min).max(0.0)
    }

    /// By how many sides the outline is shifted if it is turned by quarters about O; `None` if it is another outline then.
    #[must_use]
    pub fn shift_by_quarters(&self, quarters: usize) -> Option<usize> {
        let turned = |[x, y]: Point| match quarters % 4 {
            0 => [x, y],
            1 => [-y, x],
            2 => [-x, -y],
            _ => [y, -x],
        };
        let corners = self.outline_m();
        let count = corners.len();
        let same = |&shift: &usize| {
            (0..count).all(|k| distance_m(turned(corners[k]), corners[(k + shift) % count]) <= SAME_CORNER_M)
        };
        (0..count).find(same)
    }

    /// The first fault: an outline that is not convex, counter-clockwise and about O, or a hole that crosses itself, the outline
    /// or another hole, or leaves too little material.
    ///
    /// # Errors
    /// The fault.
    pub fn check(&self) -> Result<(), PlateFault> {
        check_outline(self.outline_m())?;
        let holes = self.holes_m();
        if holes.len() > MOST_HOLES {
            return Err(fault(PlatePart::Holes, holes.len().to_string(), format!("at most {MOST_HOLES} holes")));
        }
        (0..holes.len()).try_for_each(|hole| self.check_hole(hole))
    }

    fn check_hole(&self, number: usize) -> Result<(), PlateFault> {
        let (part, hole) = (PlatePart::Hole(number), &self.holes_m()[number]);
        check_corners(hole, part, |_| part)?;
        if let Some(side) = crossing_side(hole) {
            return Err(fault(
                part,
                format!("side {side} that meets another side"),
                "a hole that does not cross itself",
            ));
        }
        if AreaMoments::of(hole).area_m2 < LEAST_M * LEAST_M {
            return Err(fault(part, "a hole of less than 1 mm^2", "a hole with an area"));
        }
        let inside_m =
            |corner: &Point| self.sides().iter().map(|side| side.depth_m(*corner)).fold(f64::INFINITY, f64::min);
        let least_m = hole.iter().map(inside_m).fold(f64::INFINITY, f64::min);
        if least_m < LEAST_M {
            let found = if least_m < 0.0 {
                format!("a corner {:.1} mm outside the outline", -least_m * 1e3)
            } else {
                format!("{:.2} mm of material to the outline", least_m * 1e3)
            };
            return Err(fault(part, found, "a hole inside the outline with at least 1 mm of material around it"));
        }
        for (other, before) in self.holes_m()[..number].iter().enumerate() {
            let overlap = contains(before, hole[0]) || contains(hole, before[0]);
            let apart_m = if overlap { 0.0 } else { distance_of_sides_m(before, hole) };
            if apart_m < LEAST_M {
                let found = format!("{:.2} mm of material to hole {other}", apart_m * 1e3);
                return Err(fault(part, found, "at least 1 mm of material between two holes"));
            }
        }
        Ok(())
    }
}

/// Largest distance of the corners of two outlines that are the same but for a turn, m: rounding of written corners.
const SAME_CORNER_M: f64 = 1e-9;

/// Length of a polygon's section at a place along x, m.
fn section_m(corners: &[Point], at_m: f64) -> f64 {
    let mut crossed: Vec<f64> = sides(corners)
        .filter(|(a, b)| (a[0] > at_m) != (b[0] > at_m))
        .map(|(a, b)| a[1] + (at_m - a[0]) / (b[0] - a[0]) * (b[1] - a[1]))
        .collect();
    crossed.sort_by(f64::total_cmp);
    crossed.chunks_exact(2).map(|pair| pair[1] - pair[0]).sum()
}

fn fault(part: PlatePart, found: impl Into<String>, expected: impl Into<String>) -> PlateFault {
    PlateFault { part, found: found.into(), expected: expected.into() }
}

/// Number, values and distances of corners.
fn check_corners(corners: &[Point], whole: PlatePart, of: impl Fn(usize) -> PlatePart) -> Result<(), PlateFault> {
    if !(3..=MOST_CORNERS).contains(&corners.len()) {
        return Err(fault(whole, format!("{} corners", corners.len()), format!("3 to {MOST_CORNERS} corners")));
    }
    for (k, &corner) in corners.iter().enumerate() {
        if !corner.iter().all(|m| m.abs() <= MOST_M) {
            return Err(fault(of(k), format!("{corner:?}"), format!("numbers from -{MOST_M} to {MOST_M} (m)")));
        }
        let next = (k + 1) % corners.len();
        let length_m = distance_m(corner, corners[next]);
        if length_m < LEAST_M {
            let found = format!("corners {k} and {next} that are {:.2} mm apart", length_m * 1e3);
            return Err(fault(of(k), found, "corners that are at least 1 mm apart"));
        }
    }
    Ok(())
}

fn check_outline(corners: &[Point]) -> Result<(), PlateFault> {
    check_corners(corners, PlatePart::Outline, PlatePart::Corner)?;
    if let Some(side) = crossing_side(corners) {
        let found = format!("a side that meets another one: that from corner {side}");
        return Err(fault(PlatePart::Outline, found, "an outline that does not cross itself"));
    }
    if AreaMoments::of(corners).area_m2 < 0.0 {
        return Err(fault(PlatePart::Outline, "clockwise corners", "counter-clockwise corners, seen from +z_O"));
    }
    let count = corners.len();
    for k in 0..count {
        let [before, here, next] = [(k + count - 1) % count, k, (k + 1) % count].map(|k| corners[k]);
        let sine = cross(before, here, next) / (distance_m(before, here) * distance_m(here, next));
        if sine < libm::sin(LEAST_TURN_RAD) {
            let turn_deg = sine.clamp(-1.0, 1.0).asin().to_degrees();
            let found = format!("a turn of {turn_deg:.2} degrees to the left at corner {k}");
            return Err(fault(PlatePart::Corner(k), found, "a convex outline: at least 0.1 degrees at every corner"));
        }
    }
    let least_m = sides(corners).map(|side| OutlineSide::of(side).reach_m).fold(f64::INFINITY, f64::min);
    if least_m < LEAST_M {
        let found = format!("the origin {:.2} mm inside the outline", least_m * 1e3);
        return Err(fault(
            PlatePart::Outline,
            found,
            "corners about the origin of O, at least 1 mm inside the outline",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plate(outline_m: &[Point], holes_m: &[&[Point]]) -> Plate {
        PlateRecord { outline_m: outline_m.to_vec(), holes_m: holes_m.iter().map(|hole| hole.to_vec()).collect() }
            .into()
    }

    const SQUARE: [Point; 4] = [[0.2, -0.2], [0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2]];
    const HOLE: [Point; 4] = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];

    fn moved(hole: &[Point], [x, y]: Point) -> Vec<Point> {
        hole.iter().map(|[px, py]| [px + x, py + y]).collect()
    }

    #[test]
    fn a_rectangle_with_a_hole_has_the_moments_of_the_difference() {
        let found = plate(&SQUARE, &[&HOLE]);
        let moments = found.moments();
        // By hand: 0.16 - 0.01 m^2; the hole's centre is at (0.05, 0.05).
        assert!((moments.area_m2 - 0.15).abs() < 1e-15);
        let at_m = -0.01 * 0.05 / 0.15;
        assert!(moments.centroid_m().iter().all(|m| (m - at_m).abs() < 1e-15));
        let about_origin = 0.16 * 0.16 / 12.0 - 0.01 * (0.01 / 12.0 + 0.0025);
        assert!((moments.central_m2()[0] - (about_origin / 0.15 - at_m * at_m)).abs() < 1e-15);
        assert!((moments.central_m2()[2] - (-0.01 * 0.0025 / 0.15 - at_m * at_m)).abs() < 1e-15);
    }

    #[test]
    fn a_clockwise_hole_is_the_same_hole() {
        let reversed: Vec<Point> = HOLE.iter().rev().copied().collect();
        assert!((plate(&SQUARE, &[&reversed]).moments().area_m2 - 0.15).abs() < 1e-15);
    }

    #[test]
    fn sides_of_a_square_are_where_they_are() {
        let found = plate(&SQUARE, &[]);
        let expected = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        for (side, outward) in found.sides().iter().zip(expected) {
            assert_eq!((side.outward, side.reach_m, side.along_m), (outward, 0.2, [-0.2, 0.2]));
        }
        assert_eq!([0, 1, 2, 3, 4].map(|quarters| found.shift_by_quarters(quarters).unwrap()), [0, 1, 2, 3, 0]);
    }

    #[test]
    fn only_symmetric_outlines_turn() {
        let oblong = plate(&[[0.3, -0.2], [0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2]], &[]);
        assert_eq!([1, 2, 3].map(|quarters| oblong.shift_by_quarters(quarters)), [None, Some(2), None]);
        let triangle = plate(&[[0.2, -0.1], [0.0, 0.2], [-0.2, -0.1]], &[]);
        assert_eq!([0, 1, 2, 3].map(|quarters| triangle.shift_by_quarters(quarters)), [Some(0), None, None, None]);
    }

    #[test]
    fn depth_is_that_of_the_material() {
        let found = plate(&SQUARE, &[&HOLE]);
        for (p, expected_m) in [
            ([0.19, 0.0], 0.01),
            ([0.3, 0.0], -0.1),
            ([0.05, 0.06], -0.04),
            ([0.05, -0.02], 0.02),
            ([-0.1, -0.05], 0.1),
        ] {
            assert!((found.depth_m(p) - expected_m).abs() < 1e-15, "{p:?}: {}", found.depth_m(p));
        }
    }

    #[test]
    fn the_narrowest_section_is_where_the_most_is_missing() {
        let diamond = [[0.3, 0.0], [0.0, 0.2], [-0.3, 0.0], [0.0, -0.2]];
        let found = plate(&diamond, &[]);
        // The width is 0.4 (1 - |x| / 0.3).
        for (from_m, to_m, expected_m) in
            [(-0.15, 0.0, 0.2), (0.0, 0.225, 0.1), (-0.15, 0.075, 0.2), (0.0, 0.0003, 0.3996)]
        {
            assert!((found.narrowest_section_m([from_m, 0.0], [to_m, 0.0]) - expected_m).abs() < 1e-12);
        }
        // In the other direction, and with a triangular hole that jumps to its full height.
        assert!((found.narrowest_section_m([0.0, 0.0], [0.0, 0.1]) - 0.3).abs() < 1e-12);
        let pierced = plate(&SQUARE, &[&[[0.0, -0.05], [0.1, -0.05], [0.0, 0.05]]]);
        assert!((pierced.narrowest_section_m([-0.1, 0.0], [0.15, 0.0]) - 0.3).abs() < 1e-12);
        assert!((pierced.narrowest_section_m([0.05, 0.0], [0.15, 0.0]) - 0.35).abs() < 1e-12);
    }

    #[test]
    fn a_patch_knows_its_margins() {
        let found = plate(&SQUARE, &[&HOLE]);
        let patch = [[0.11, 0.02], [0.15, 0.02], [0.15, 0.06], [0.11, 0.06]];
        let margins_m = found.patch_margins_m(&patch);
        for (found, expected) in margins_m.iter().zip([0.05, 0.14, 0.31, 0.22, 0.01]) {
            assert!((found - expected).abs() < 1e-15, "{margins_m:?}");
        }
        assert!(found.patch_margins_m(&patch.map(|[x, y]| [x - 0.02, y]))[4] < 0.0);
    }

    #[test]
    fn every_fault_is_named() {
        let about = |found: &Plate| found.check().unwrap_err();
        let part = |found: &Plate| about(found).part;
        assert!(plate(&SQUARE, &[&HOLE]).check().is_ok());
        let clockwise: Vec<Point> = SQUARE.iter().rev().copied().collect();
        assert_eq!(about(&plate(&clockwise, &[])).found, "clockwise corners");
        assert_eq!(part(&plate(&[SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]], &[])), PlatePart::Outline);
        assert_eq!(part(&plate(&SQUARE[..2], &[])), PlatePart::Outline);
        let dented = [SQUARE[0], [0.1, 0.0], SQUARE[1], SQUARE[2], SQUARE[3]];
        assert_eq!(part(&plate(&dented, &[])), PlatePart::Corner(1));
        let flat = [SQUARE[0], [0.2, 0.0], SQUARE[1], SQUARE[2], SQUARE[3]];
        assert_eq!(part(&plate(&flat, &[])), PlatePart::Corner(1));
        assert_eq!(part(&plate(&[SQUARE[0], [0.2, f64::NAN], SQUARE[2]], &[])), PlatePart::Corner(1));
        assert_eq!(part(&plate(&[SQUARE[0], [0.2, -0.1995], SQUARE[1], SQUARE[2]], &[])), PlatePart::Corner(0));
        // A pentagram turns to the left at every corner, but twice round.
        let star = [0, 2, 4, 1, 3].map(|k: usize| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / 5.0);
            [0.3 * cos, 0.3 * sin]
        });
        assert!(about(&plate(&star, &[])).expected.contains("does not cross itself"));
        let aside: Vec<Point> = moved(&SQUARE, [0.3, 0.0]);
        assert!(about(&plate(&aside, &[])).found.starts_with("the origin"));
        for (hole, expected) in [
            (moved(&HOLE, [0.15, 0.0]), "50.0 mm outside"),
            (moved(&HOLE, [0.0995, 0.0]), "0.50 mm of material to the outline"),
            (vec![HOLE[0], HOLE[2], HOLE[1], HOLE[3]], "meets another side"),
        ] {
            let found = about(&plate(&SQUARE, &[&hole]));
            assert!(found.part == PlatePart::Hole(0) && found.found.contains(expected), "{found:?}");
        }
        for second in
            [moved(&HOLE, [0.05, 0.0]), moved(&HOLE, [-0.1005, 0.0]), vec![[0.04, 0.04], [0.06, 0.04], [0.05, 0.06]]]
        {
            let found = about(&plate(&SQUARE, &[&HOLE, &second]));
            assert!(found.part == PlatePart::Hole(1) && found.found.ends_with("to hole 0"), "{found:?}");
        }
    }
}
