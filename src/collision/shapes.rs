//! Primitives as parry knows them. Its poses are glam's: they are converted here and nowhere else.

use nalgebra::{Point3, Unit, Vector3};
use parry3d_f64::{
    glamx::{DMat3, DQuat, DVec3},
    math::Pose as ParryPose,
    query,
    shape::{SharedShape, SupportMap},
};

use super::convex::{Bounds, ClosestPoints, Core, Round, Search};
use crate::{
    model::frames::Pose,
    robot::{Link, Shape},
};

/// A primitive in the frame of its body, with its bounding sphere.
#[derive(Clone)]
pub struct Piece {
    x_ls: ParryPose,
    shape: SharedShape,
    core: Core,
    /// The radius about the core, m.
    round_m: f64,
    /// The radius of the bounding sphere, m.
    radius_m: f64,
}

/// The measure between two primitives.
#[derive(Clone, Copy)]
pub enum Measure {
    /// Distance, zero if they overlap.
    Distance,
    /// Distance, or the penetration depth as a negative number.
    SignedDistance,
}

/// The closest points of two primitives.
pub struct Closest {
    /// Points of the first and the second, W, m.
    pub p_w: [Point3<f64>; 2],
    /// From the first towards the second.
    pub normal_w: Vector3<f64>,
    /// Distance along the normal, negative if they overlap, m.
    pub distance_m: f64,
}

/// A primitive in W.
#[derive(Clone, Copy)]
pub struct Placed<'a> {
    pose: ParryPose,
    /// That of the pose.
    rotation: DMat3,
    piece: &'a Piece,
}

impl Piece {
    /// A box centred at the origin.
    pub fn cuboid(size_m: [f64; 3]) -> Self {
        let [x, y, z] = size_m.map(|side| side / 2.0);
        Self::at(&Pose::identity(), SharedShape::cuboid(x, y, z), DVec3::new(x, y, z).length())
    }

    /// The convex hull of points; `None` if they have no volume.
    pub fn prism(corners: &[Point3<f64>]) -> Option<Self> {
        let corners: Vec<DVec3> = corners.iter().map(|p| DVec3::new(p.x, p.y, p.z)).collect();
        let reach_m = corners.iter().map(|corner| corner.length()).fold(0.0, f64::max);
        Some(Self::at(&Pose::identity(), SharedShape::convex_hull(&corners)?, reach_m))
    }

    /// A capsule between two points of W; its frame is W translated to its middle.
    pub fn capsule_w(p0_w: &Point3<f64>, p1_w: &Point3<f64>, radius_m: f64) -> Self {
        let middle = nalgebra::center(p0_w, p1_w);
        let half = (p1_w - p0_w) / 2.0;
        let end = DVec3::new(half.x, half.y, half.z);
        let shape = SharedShape::capsule(-end, end, radius_m);
        Self::at(&Pose::translation(middle.x, middle.y, middle.z), shape, half.norm() + radius_m)
    }

    /// All primitives of a link.
    pub fn of_link(link: &Link) -> Vec<Self> {
        link.shapes.iter().map(|placed| Self::of_shape(&placed.x_ls, &placed.shape)).collect()
    }

    fn of_shape(x_ls: &Pose, shape: &Shape) -> Self {
        match *shape {
            Shape::Box { half_m: [x, y, z] } => {
                Self::at(x_ls, SharedShape::cuboid(x, y, z), DVec3::new(x, y, z).length())
            }
            Shape::Cylinder { radius_m, half_length_m } => {
                // parry's cylinders lie along y, a URDF's along z.
                let y_to_z =
                    nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), 90_f64.to_radians());
                let shape = SharedShape::cylinder(half_length_m, radius_m);
                Self::at(&(x_ls * y_to_z), shape, radius_m.hypot(half_length_m))
            }
            Shape::Sphere { radius_m } => Self::at(x_ls, SharedShape::ball(radius_m), radius_m),
            Shape::Hull(ref hull) => {
                let points: Vec<DVec3> = hull.points_m.iter().map(|p| DVec3::new(p.x, p.y, p.z)).collect();
                let radius_m = points.iter().map(|point| point.length()).fold(0.0, f64::max);
                // The surface of a convex hull is one of a convex polyhedron but for faces of rounding size; the hull of its
                // corners is then computed once more.
                let shape = SharedShape::convex_mesh(points.clone(), &hull.triangles)
                    .or_else(|| SharedShape::convex_hull(&points))
                    .unwrap_or_else(|| SharedShape::ball(radius_m));
                Self::at(x_ls, shape, radius_m)
            }
        }
    }

    fn at(x_ls: &Pose, shape: SharedShape, radius_m: f64) -> Self {
        let (core, round_m) = Core::of_shape(&shape);
        Self { x_ls: to_parry(x_ls), shape, core, round_m, radius_m }
    }

    /// The primitive of a link at `x_wl`.
    pub fn placed(&self, x_wl: &Pose) -> Placed<'_> {
        self.placed_by(&to_parry(x_wl))
    }

    fn placed_by(&self, x_wl: &ParryPose) -> Placed<'_> {
        let pose = x_wl * self.x_ls;
        Placed { pose, rotation: DMat3::from_quat(pose.rotation), piece: self }
    }
}

/// All primitives of a link at `x_wl`.
pub fn place_all<'a>(pieces: &'a [Piece], x_wl: &Pose) -> impl Iterator<Item = Placed<'a>> + use<'a> {
    let x_wl = to_parry(x_wl);
    pieces.iter().map(move |piece| piece.placed_by(&x_wl))
}

/// A point of a link in W.
pub fn point_w(x_wl: &Pose, p_l: &Point3<f64>) -> DVec3 {
    let p_w = x_wl * p_l;
    DVec3::new(p_w.x, p_w.y, p_w.z)
}

/// Bounding sphere of several primitives in the frame of their body: centre and radius, m.
pub fn sphere_about(pieces: &[Piece]) -> (Point3<f64>, f64) {
    let count = pieces.len().max(1) as f64;
    let centre = pieces.iter().map(|piece| piece.x_ls.translation).sum::<DVec3>() / count;
    let radius_m =
        pieces.iter().map(|piece| (piece.x_ls.translation - centre).length() + piece.radius_m).fold(0.0, f64::max);
    (Point3::new(centre.x, centre.y, centre.z), radius_m)
}

impl Placed<'_> {
    /// Its core in W.
    fn round(&self) -> Round<'_> {
        Round::new(&self.piece.core, self.piece.round_m, self.rotation, self.pose.translation)
    }

    /// Its bounding sphere in W: centre and radius, m.
    pub fn sphere(&self) -> (DVec3, f64) {
        (self.pose.translation, self.piece.radius_m)
    }

    /// False only if the bounding spheres are more than `within_m` apart.
    fn spheres_within(&self, other: &Placed<'_>, within_m: f64) -> bool {
        let reach_m = self.piece.radius_m + other.piece.radius_m + within_m;
        (self.pose.translation - other.pose.translation).length_squared() <= reach_m * reach_m
    }

    /// True if two primitives overlap or are closer than `required_m`.
    pub fn closer_than(&self, other: &Placed<'_>, required_m: f64) -> bool {
        if !self.spheres_within(other, required_m) {
            return false;
        }
        let (one, two) = (self.round(), other.round());
        match one.bounds(&two, required_m) {
            Bounds::Beyond => false,
            Bounds::Within(_) => true,
            Bounds::Unknown(towards) => match one.closest(&two, required_m, towards) {
                Search::Beyond => false,
                Search::Found(found) => found.distance_m <= required_m,
                Search::Overlap | Search::Failed if required_m > 0.0 => self.distance_m(other) <= required_m,
                Search::Overlap | Search::Failed => self.overlaps(other),
            },
        }
    }

    /// True if two primitives overlap. Faster than a distance.
    fn overlaps(&self, other: &Placed<'_>) -> bool {
        query::intersection_test(&self.pose, &*self.piece.shape, &other.pose, &*other.piece.shape)
            .is_ok_and(|found| found.intersecting)
    }

    /// Minimum of `bound_m` and the measure between two primitives, m.
    pub fn distance_within(&self, other: &Placed<'_>, bound_m: f64, measure: Measure) -> f64 {
        if !self.spheres_within(other, bound_m) {
            return bound_m;
        }
        bound_m.min(match measure {
            Measure::Distance => self.distance_m(other),
            Measure::SignedDistance => self.signed_distance_m(other),
        })
    }

    /// Minimum of `bound_m` and the signed distance of two primitives, m. Each is first tested against the other's bounding
    /// sphere.
    pub fn signed_distance_within(&self, other: &Placed<'_>, bound_m: f64) -> f64 {
        let near = self.may_meet_sphere(other.pose.translation, other.piece.radius_m + bound_m)
            && other.may_meet_sphere(self.pose.translation, self.piece.radius_m + bound_m);
        if near { bound_m.min(self.signed_distance_m(other)) } else { bound_m }
    }

    /// False only if the primitive does not intersect a sphere in W. For polyhedra one plane is tested, normal to the line
    /// between the centres.
    pub fn may_meet_sphere(&self, centre_w: DVec3, radius_m: f64) -> bool {
        let reach_m = self.piece.radius_m + radius_m;
        if (self.pose.translation - centre_w).length_squared() > reach_m * reach_m {
            return false;
        }
        match &self.piece.core {
            Core::Hull(_) => {
                let centre_s = self.pose.inverse_transform_point(centre_w);
                let Some(towards) = centre_s.try_normalize() else { return true };
                towards.dot(centre_s - self.piece.core.local_support_point(towards)) <= radius_m
            }
            _ => (self.round().nearest(centre_w) - centre_w).length() <= self.piece.round_m + radius_m,
        }
    }

    /// True if the primitive intersects a sphere in W.
    #[cfg(test)]
    pub fn meets_sphere(&self, centre_w: DVec3, radius_m: f64) -> bool {
        self.piece.shape.distance_to_point(&self.pose, centre_w, true) <= radius_m
    }

    /// Distance between two primitives, or the penetration depth as a negative number, m.
    pub fn signed_distance_m(&self, other: &Placed<'_>) -> f64 {
        let distance_m = self.distance_m(other);
        if distance_m > 0.0 {
            return distance_m;
        }
        self.contact(other, 0.0).map_or(0.0, |contact| contact.distance_m.min(0.0))
    }

    /// The closest points of two primitives; `None` if they are farther apart than `within_m`.
    pub fn closest(&self, other: &Placed<'_>, within_m: f64) -> Option<Closest> {
        if !self.spheres_within(other, within_m) {
            return None;
        }
        let (one, two) = (self.round(), other.round());
        let towards = match one.bounds(&two, within_m) {
            Bounds::Beyond => return None,
            Bounds::Within(towards) | Bounds::Unknown(towards) => towards,
        };
        match one.closest(&two, within_m, towards) {
            Search::Beyond => None,
            Search::Found(found) => Some(found.into()),
            Search::Overlap | Search::Failed => self.contact(other, within_m),
        }
    }

    /// As [`Placed::closest`], also for primitives that overlap.
    fn contact(&self, other: &Placed<'_>, within_m: f64) -> Option<Closest> {
        let (shape, others) = (&*self.piece.shape, &*other.piece.shape);
        let found = query::contact(&self.pose, shape, &other.pose, others, within_m).ok().flatten()?;
        let points = [found.point1, found.point2];
        Some(ClosestPoints { points, normal: found.normal1, distance_m: found.dist }.into())
    }

    /// Distance along a ray to the primitive if it is less than `within_m`, m; zero from inside.
    pub fn ray_m(&self, origin_w: &Point3<f64>, direction_w: &Unit<Vector3<f64>>, within_m: f64) -> Option<f64> {
        let vector = |v: [f64; 3]| DVec3::from_array(v);
        let ray = query::Ray::new(vector(origin_w.coords.into()), vector(direction_w.into_inner().into()));
        self.piece.shape.cast_ray(&self.pose, &ray, within_m, true)
    }

    /// Distance between two primitives, m; zero if they overlap.
    pub fn distance_m(&self, other: &Placed<'_>) -> f64 {
        // All pairs are supported, since boxes, cylinders, balls, capsules and convex polyhedra are support-mapped.
        query::distance(&self.pose, &*self.piece.shape, &other.pose, &*other.piece.shape)
            .map_or(0.0, |found| found.distance)
    }
}

impl From<ClosestPoints> for Closest {
    fn from(ClosestPoints { points, normal, distance_m }: ClosestPoints) -> Self {
        let p_w = points.map(|p| Point3::new(p.x, p.y, p.z));
        Self { p_w, normal_w: Vector3::new(normal.x, normal.y, normal.z), distance_m }
    }
}

fn to_parry(pose: &Pose) -> ParryPose {
    let t = pose.translation.vector;
    let r = pose.rotation.coords;
    ParryPose::from_parts(DVec3::new(t.x, t.y, t.z), DQuat::from_xyzw(r.x, r.y, r.z, r.w))
}
