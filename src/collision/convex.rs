//! Primitives as a convex core with a radius about it: distances of round primitives are those of their cores less the radii.
//!
//! A ball is a point, a capsule a segment. The search for closest points (GJK) ends after a few steps where the surfaces are not
//! round, and with one type for all primitives their support functions are compiled into it.

use parry3d_f64::{
    glamx::{DMat3, DVec3},
    math::Pose as ParryPose,
    query::{gjk, gjk::GJKResult},
    shape::{SharedShape, SupportMap},
};

/// Alternating projections that a pair of primitives is given to show a separating plane; after four the search for the closest
/// points costs less.
const PROJECTIONS: usize = 4;

/// Cores nearer to each other than this have no reliable direction between them, m.
const LEAST_DISTANCE_M: f64 = 1e-7;

/// A convex body with its centre at the origin, to which a radius is added.
#[derive(Clone)]
pub enum Core {
    /// The origin.
    Point,
    /// From minus this point to this point.
    Segment(DVec3),
    /// A box by its half sides.
    Cuboid(DVec3),
    /// A cylinder along y.
    Cylinder { radius_m: f64, half_m: f64 },
    /// A convex polyhedron about the origin.
    Hull(SharedShape),
}

impl Core {
    /// The core of one of parry's shapes, and the radius about it.
    pub fn of_shape(shape: &SharedShape) -> (Self, f64) {
        if let Some(ball) = shape.as_ball() {
            (Self::Point, ball.radius)
        } else if let Some(capsule) = shape.as_capsule().filter(|capsule| capsule.segment.a == -capsule.segment.b) {
            (Self::Segment(capsule.segment.b), capsule.radius)
        } else if let Some(cuboid) = shape.as_cuboid() {
            (Self::Cuboid(cuboid.half_extents), 0.0)
        } else if let Some(cylinder) = shape.as_cylinder() {
            (Self::Cylinder { radius_m: cylinder.radius, half_m: cylinder.half_height }, 0.0)
        } else {
            (Self::Hull(shape.clone()), 0.0)
        }
    }

    /// The point nearest to `p`. Of a polyhedron a point of its surface that may not be the nearest.
    fn nearest(&self, p: DVec3) -> DVec3 {
        match self {
            Self::Point => DVec3::ZERO,
            Self::Segment(half) => {
                let squared = half.length_squared();
                if squared > 0.0 { *half * (half.dot(p) / squared).clamp(-1.0, 1.0) } else { DVec3::ZERO }
            }
            Self::Cuboid(half) => p.clamp(-*half, *half),
            Self::Cylinder { radius_m, half_m } => {
                let radial_m = (p.x * p.x + p.z * p.z).sqrt();
                let share = if radial_m > *radius_m { radius_m / radial_m } else { 1.0 };
                DVec3::new(p.x * share, p.y.clamp(-half_m, *half_m), p.z * share)
            }
            Self::Hull(_) => self.local_support_point(p),
        }
    }
}

impl SupportMap for Core {
    fn local_support_point(&self, towards: DVec3) -> DVec3 {
        match self {
            Self::Point => DVec3::ZERO,
            Self::Segment(half) => {
                if half.dot(towards) < 0.0 {
                    -*half
                } else {
                    *half
                }
            }
            Self::Cuboid(half) => half.copysign(towards),
            Self::Cylinder { radius_m, half_m } => {
                let radial = (towards.x * towards.x + towards.z * towards.z).sqrt();
                let scale = if radial > 0.0 { radius_m / radial } else { 0.0 };
                DVec3::new(towards.x * scale, half_m.copysign(towards.y), towards.z * scale)
            }
            Self::Hull(shape) => shape.as_support_map().map_or(DVec3::ZERO, |map| map.local_support_point(towards)),
        }
    }
}

/// A core at a pose, with the radius about it.
#[derive(Clone, Copy)]
pub struct Round<'a> {
    core: &'a Core,
    radius_m: f64,
    rotation: DMat3,
    centre: DVec3,
}

impl SupportMap for Round<'_> {
    fn local_support_point(&self, towards: DVec3) -> DVec3 {
        self.centre + self.rotation * self.core.local_support_point(self.rotation.transpose() * towards)
    }

    /// The pose is part of the body.
    fn support_point(&self, _: &ParryPose, towards: DVec3) -> DVec3 {
        self.local_support_point(towards)
    }
}

/// What alternating projections tell of the distance of two bodies.
pub enum Bounds {
    /// It is larger than the distance in question: a plane separates them.
    Beyond,
    /// It is at most that; a direction from the first towards the second.
    Within(DVec3),
    /// Neither is certain; the same.
    Unknown(DVec3),
}

/// The closest points of two bodies.
pub struct ClosestPoints {
    pub points: [DVec3; 2],
    /// From the first towards the second.
    pub normal: DVec3,
    pub distance_m: f64,
}

/// The result of a search for the closest points within a distance.
pub enum Search {
    Beyond,
    Found(ClosestPoints),
    /// The cores overlap, or nearly so.
    Overlap,
    /// The search ended without a result.
    Failed,
}

impl<'a> Round<'a> {
    pub fn new(core: &'a Core, radius_m: f64, rotation: DMat3, centre: DVec3) -> Self {
        Self { core, radius_m, rotation, centre }
    }

    /// The point of the core nearest to `p`, see [`Core::nearest`].
    pub fn nearest(&self, p: DVec3) -> DVec3 {
        self.centre + self.rotation * self.core.nearest(self.rotation.transpose() * (p - self.centre))
    }

    /// The same body with its centre moved.
    fn moved(&self, by: DVec3) -> Self {
        Self { centre: self.centre + by, ..*self }
    }

    /// Compares the distance of two bodies with `within_m` by alternating projections of a point on the two cores. The plane
    /// normal to the line between the projections may separate the bodies; the projections are an upper bound.
    pub fn bounds(&self, other: &Self, within_m: f64) -> Bounds {
        let limit_m = within_m + self.radius_m + other.radius_m;
        let mut on_other = other.centre;
        let mut direction = other.centre - self.centre;
        for _ in 0..PROJECTIONS {
            let on_self = self.nearest(on_other);
            on_other = other.nearest(on_self);
            let across = on_other - on_self;
            let across_m = across.length();
            if across_m > 0.0 {
                direction = across / across_m;
            }
            if across_m <= limit_m {
                return Bounds::Within(direction);
            }
            let gap_m = direction.dot(other.local_support_point(-direction) - self.local_support_point(direction));
            if gap_m > limit_m {
                return Bounds::Beyond;
            }
        }
        Bounds::Unknown(direction)
    }

    /// The closest points of two bodies if these are at most `within_m` apart; `towards` is a first guess of the direction from
    /// the first to the second.
    pub fn closest(&self, other: &Self, within_m: f64, towards: DVec3) -> Search {
        let radii_m = self.radius_m + other.radius_m;
        // About the first body's centre, where numbers are small.
        let origin = self.centre;
        let (one, two) = (self.moved(-origin), other.moved(-origin));
        let here = ParryPose::IDENTITY;
        let mut simplex = gjk::VoronoiSimplex::new();
        simplex.reset(gjk::CsoPoint::from_shapes(&here, &one, &two, towards));
        match gjk::closest_points(&here, &one, &two, within_m + radii_m, true, &mut simplex) {
            GJKResult::ClosestPoints(on_one, on_two, normal) => {
                let distance_m = (on_two - on_one).dot(normal);
                if distance_m < LEAST_DISTANCE_M {
                    return Search::Overlap;
                }
                let points = [origin + on_one + normal * self.radius_m, origin + on_two - normal * other.radius_m];
                Search::Found(ClosestPoints { points, normal, distance_m: distance_m - radii_m })
            }
            GJKResult::NoIntersection(towards) => {
                let apart_m = gjk::CsoPoint::from_shapes(&here, &one, &two, towards).point.dot(-towards);
                if apart_m > within_m + radii_m { Search::Beyond } else { Search::Failed }
            }
            GJKResult::Intersection => Search::Overlap,
            GJKResult::Proximity(_) => Search::Failed,
        }
    }
}

#[cfg(test)]
mod tests {
    use parry3d_f64::{glamx::DQuat, query, shape::ConvexPolyhedron};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;

    fn drawn_shape(generator: &mut Pcg64) -> SharedShape {
        let mut side = || generator.random_range(0.01..0.3);
        let [x, y, z] = [side(), side(), side()];
        match generator.random_range(0..5) {
            0 => SharedShape::ball(x),
            1 => SharedShape::cuboid(x, y, z),
            2 => SharedShape::cylinder(x, y),
            3 => SharedShape::capsule(-DVec3::new(x, y, z), DVec3::new(x, y, z), 0.5 * y),
            _ => {
                let mut point = || DVec3::from_array([(); 3].map(|()| generator.random_range(-0.2..0.2)));
                let points: Vec<_> = (0..12).map(|_| point()).collect();
                SharedShape::new(ConvexPolyhedron::from_convex_hull(&points).unwrap())
            }
        }
    }

    fn drawn_pose(generator: &mut Pcg64) -> ParryPose {
        let mut number = || generator.random_range(-1.0..1.0_f64);
        let rotation = DQuat::from_xyzw(number(), number(), number(), number() + 1.5).normalize();
        ParryPose::from_parts(DVec3::new(number(), number(), number()) * 0.7, rotation)
    }

    /// Bounds and closest points against parry's distances of the primitives themselves, and the closest points with a proof of
    /// their own. On round surfaces the search ends where a step brings no progress: in one of ten thousand draws 1e-5 m early.
    #[test]
    fn distances_are_those_of_parry() {
        const TOLERANCE_M: f64 = 5e-5;
        let mut generator = Pcg64::seed_from_u64(20);
        let mut counts = [0; 4];
        for round in 0..40_000 {
            let shapes = [(); 2].map(|()| drawn_shape(&mut generator));
            let poses = [(); 2].map(|()| drawn_pose(&mut generator));
            let within_m = generator.random_range(0.0..0.2);
            let cores = shapes.each_ref().map(Core::of_shape);
            let [one, two] = [0, 1].map(|body: usize| {
                let (core, radius_m) = &cores[body];
                Round::new(core, *radius_m, DMat3::from_quat(poses[body].rotation), poses[body].translation)
            });
            let expected_m = query::distance(&poses[0], &*shapes[0], &poses[1], &*shapes[1]).unwrap().distance;
            let towards = match one.bounds(&two, within_m) {
                Bounds::Beyond => {
                    counts[0] += 1;
                    assert!(expected_m > within_m - TOLERANCE_M, "{round}: {expected_m} {within_m}");
                    continue;
                }
                Bounds::Within(towards) => {
                    counts[1] += 1;
                    assert!(expected_m < within_m + TOLERANCE_M, "{round}: {expected_m} {within_m}");
                    towards
                }
                Bounds::Unknown(towards) => towards,
            };
            match one.closest(&two, within_m, towards) {
                Search::Beyond => assert!(expected_m > within_m - TOLERANCE_M, "{round}: {expected_m} {within_m}"),
                Search::Found(found) => {
                    counts[2] += 1;
                    // A plane normal to the line between the points proves that no points are nearer.
                    let gap_m = found
                        .normal
                        .dot(two.local_support_point(-found.normal) - one.local_support_point(found.normal))
                        - one.radius_m
                        - two.radius_m;
                    assert!((gap_m - found.distance_m).abs() < TOLERANCE_M, "{round}: {gap_m} {}", found.distance_m);
                    // parry's search on round bodies ends earlier.
                    assert!((found.distance_m.max(0.0) - expected_m).abs() < 1e-4, "{round}: {expected_m}");
                    let [on_one, on_two] = found.points;
                    assert!((on_one + found.normal * found.distance_m - on_two).length() < TOLERANCE_M, "{round}");
                    for (point, body) in found.points.iter().zip([&one, &two]) {
                        let off_core_m = (body.nearest(*point) - *point).length();
                        let is_hull = matches!(body.core, Core::Hull(_));
                        assert!(is_hull || (off_core_m - body.radius_m).abs() < TOLERANCE_M, "{round}: {off_core_m}");
                    }
                }
                Search::Overlap => {
                    counts[3] += 1;
                    assert!(expected_m < TOLERANCE_M, "{round}: {expected_m}");
                }
                Search::Failed => {}
            }
        }
        assert!(counts.iter().all(|count| *count > 1000), "{counts:?}");
    }
}
