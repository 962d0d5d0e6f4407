//! Collisions and clearances: robot with itself, with the board, with the person and the tool; person with the board.
//!
//! Primitives of robot and board and capsules of the person are compared with parry. Bounding spheres of links and of
//! primitives exclude pairs that are far apart. The required distances are those of docs/method.md#35-clearances.

mod bars;
mod board_distance;
mod clearances;
mod convex;
mod link_shapes;
mod near_pairs;
mod nearest;
mod overlaps;
mod person_clearance;
mod self_pairs;
mod shapes;
mod sight;

use nalgebra::{Point3, Vector3};
use parry3d_f64::glamx::DVec3;
use serde::{Deserialize, Serialize};

use crate::{
    human::BodyPart,
    model::{board::BoardShape, frames::Pose},
    robot::Robot,
};
pub use bars::board_between_pads;
use link_shapes::LinkShapes;
pub use near_pairs::{BodyRef, NearPair};
pub use nearest::Nearest;
pub use person_clearance::PersonClearance;
use self_pairs::{SelfPair, self_pairs};
use shapes::{Measure, Piece, Placed, place_all, point_w, sphere_about};

/// Poses of robot, board and person, in W.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Poses of the robot's links, as [`Robot::link_poses`] gives them.
    pub link_poses: &'a [Pose],
    /// Indices of the arms that hold the board; their fingers may touch it.
    pub holding: &'a [usize],
    /// The board.
    pub board: &'a BoardBody,
    /// Pose of the board.
    pub x_wo: Pose,
    /// The person and the tool.
    pub person: &'a [PersonPart],
    /// Required distance of the robot from itself and from the board, m; at 0 they must only not touch.
    pub clearance_m: f64,
}

/// A board without its holes: a box, or the prism over a plate's convex outline.
#[derive(Clone)]
pub struct BoardBody {
    piece: Piece,
    thickness_m: f64,
    /// False if a side or a corner is not a number.
    is_finite: bool,
}

impl BoardBody {
    /// The body of a board.
    #[must_use]
    pub fn new(board: &BoardShape) -> Self {
        let corners_o = board.corners_o();
        let is_finite = corners_o.iter().flat_map(|corner| corner.iter()).all(|m| m.is_finite());
        let prism = board.plate.as_ref().filter(|_| is_finite).and_then(|_| Piece::prism(&corners_o));
        Self {
            piece: prism.unwrap_or_else(|| Piece::cuboid(board.size_m)),
            thickness_m: board.thickness_m(),
            is_finite,
        }
    }

    /// Thickness, m.
    #[must_use]
    pub fn thickness_m(&self) -> f64 {
        self.thickness_m
    }
}

impl std::fmt::Debug for BoardBody {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BoardBody").field("is_finite", &self.is_finite).finish_non_exhaustive()
    }
}

/// A capsule of the person's body or the tool, with its required clearances.
#[derive(Clone, Copy, Debug)]
pub struct PersonPart {
    /// The part.
    pub name: BodyPart,
    /// One end of the capsule's axis in W, m.
    pub p0_w: Point3<f64>,
    /// The other end, m.
    pub p1_w: Point3<f64>,
    /// Radius, m.
    pub radius_m: f64,
    /// Required distance to the robot, m.
    pub robot_clearance_m: f64,
    /// Required distance to the board, m; `None` if it may touch the board.
    pub board_clearance_m: Option<f64>,
}

impl PersonPart {
    /// The part displaced in W.
    #[must_use]
    pub fn moved(self, by_m: &Vector3<f64>) -> Self {
        Self { p0_w: self.p0_w + by_m, p1_w: self.p1_w + by_m, ..self }
    }
}

/// A body of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Body {
    /// A link of the robot, by its index.
    Link(usize),
    /// The board.
    Board,
    /// A part of the person, or the tool.
    Person(BodyPart),
}

impl Body {
    /// Name for messages: `left_wrist`, `the board`, `the person's Head`.
    pub fn describe(self, robot: &Robot) -> String {
        match self {
            Self::Link(link) => robot.links[link].name.clone(),
            Self::Board => "the board".to_owned(),
            Self::Person(part) => format!("the person's {part:?}"),
        }
    }
}

/// Two bodies that are closer than their required distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// The two bodies.
    pub bodies: [Body; 2],
    /// Required distance, m; zero if they must only not touch.
    pub required_m: f64,
    /// Distance, m; zero if they overlap, NaN if the pose or size of the body (then named twice) is not finite.
    pub distance_m: f64,
}

impl Violation {
    /// True if one of the bodies is the person or the tool.
    #[must_use]
    pub fn is_of_person(&self) -> bool {
        self.bodies.iter().any(|body| matches!(body, Body::Person(_)))
    }

    /// Message: `left_wrist is 12 mm from the person's Head, expected more than 50 mm`.
    pub fn describe(&self, robot: &Robot) -> String {
        let [one, other] = self.bodies.map(|body| body.describe(robot));
        if self.distance_m.is_nan() {
            return format!("{one} has a pose or a size that is not finite, expected finite numbers");
        }
        let [distance_mm, required_mm] = [self.distance_m, self.required_m].map(|m| m * 1e3);
        format!("{one} is {distance_mm:.0} mm from {other}, expected more than {required_mm:.0} mm")
    }
}

/// The robot's primitives and the pairs of links that must not touch.
#[derive(Clone)]
pub struct CollisionModel {
    links: Vec<LinkShapes>,
    self_pairs: Vec<SelfPair>,
    /// For each arm the links of its fingers, which may touch the board.
    fingers: Vec<Vec<usize>>,
    /// For each link the most that it can be asked to keep from the board, m; infinite but for the bars of linkages.
    board_most_m: Vec<f64>,
}

/// A link in W.
struct PlacedLink<'a> {
    pieces: &'a [Placed<'a>],
    /// Centre of the bounding sphere.
    centre_w: DVec3,
    radius_m: f64,
}

impl<'a> PlacedLink<'a> {
    /// A link at a pose, with its placed primitives.
    fn new(link: &LinkShapes, pieces: &'a [Placed<'a>], x_wl: &Pose) -> Self {
        Self { pieces, centre_w: point_w(x_wl, &link.centre_l), radius_m: link.radius_m }
    }

    /// Distance to another link if it is at most `required_m`, m.
    fn too_close_to(&self, other: &Self, required_m: f64) -> Option<f64> {
        let reach_m = self.radius_m + other.radius_m + required_m;
        if (self.centre_w - other.centre_w).length_squared() > reach_m * reach_m {
            return None;
        }
        let near =
            self.pieces.iter().filter(|piece| piece.may_meet_sphere(other.centre_w, other.radius_m + required_m));
        let pairs = near.flat_map(|piece| other.pieces.iter().map(move |other| (piece, other)));
        let close = pairs.filter(|(piece, other)| piece.closer_than(other, required_m));
        close.map(|(piece, other)| piece.distance_m(other)).min_by(f64::total_cmp)
    }

    /// Distance to another body if it is less than `required_m`, m.
    fn too_close(&self, other: &Placed<'_>, required_m: f64) -> Option<f64> {
        if self.pieces.is_empty() || !other.may_meet_sphere(self.centre_w, self.radius_m + required_m) {
            return None;
        }
        let close = self.pieces.iter().filter(|piece| piece.closer_than(other, required_m));
        close.map(|piece| piece.distance_m(other)).min_by(f64::total_cmp)
    }
}

impl CollisionModel {
    /// The collision model of a robot.
    pub fn new(robot: &Robot) -> Self {
        let links: Vec<_> = robot
            .links
            .iter()
            .map(|link| {
                let pieces = Piece::of_link(link);
                let (centre_l, radius_m) = sphere_about(&pieces);
                LinkShapes { pieces, centre_l, radius_m }
            })
            .collect();
        let self_pairs = self_pairs(robot, &links);
        let fingers = robot.arms.iter().map(|arm| fingers(robot, &arm.gripper)).collect();
        let board_most_m = vec![f64::INFINITY; links.len()];
        let mut model = Self { links, self_pairs, fingers, board_most_m };
        for (bar, most_m) in model.bars(robot) {
            model.board_most_m[bar] = most_m;
        }
        model
    }

    /// The first violation of a scene: robot with itself, then robot with board, then person. A body whose pose or size is not
    /// finite is a violation that names it twice, with distance NaN.
    #[must_use]
    pub fn first_violation(&self, scene: &Scene<'_>) -> Option<Violation> {
        if let Some(body) = self.undefined_body(scene) {
            return Some(Violation { bodies: [body; 2], required_m: 0.0, distance_m: f64::NAN });
        }
        // Every primitive is placed once, since a link is compared with several others.
        let placed = self.placed_primitives(scene.link_poses);
        let links = self.placed_links(scene.link_poses, &placed);
        let board = scene.board.piece.placed(&scene.x_wo);
        self.robot_self(scene, &links)
            .or_else(|| self.robot_board(scene, &links, &board))
            .or_else(|| scene.person.iter().find_map(|part| person(&links, &board, part)))
    }

    /// True if the fingers of an arm keep the clearance from the board that links have which may not touch it.
    #[must_use]
    pub fn fingers_are_off(&self, scene: &Scene<'_>, arm: usize) -> bool {
        let board = scene.board.piece.placed(&scene.x_wo);
        self.fingers[arm].iter().all(|&link| {
            let (shapes, x_wl) = (&self.links[link], &scene.link_poses[link]);
            let pieces: Vec<_> = place_all(&shapes.pieces, x_wl).collect();
            self.link_board(scene, link, &PlacedLink::new(shapes, &pieces, x_wl), &board).is_none()
        })
    }

    /// The first violation of the person. Robot and board are not checked and must be finite. Without link poses only the board
    /// is an obstacle.
    #[must_use]
    pub fn first_violation_of_person(&self, scene: &Scene<'_>) -> Option<Violation> {
        let placed = self.placed_primitives(scene.link_poses);
        let links = self.placed_links(scene.link_poses, &placed);
        let board = scene.board.piece.placed(&scene.x_wo);
        scene.person.iter().find_map(|part| person(&links, &board, part))
    }

    /// Minimum over all pairs of distance minus required distance, m: at most 0 if there is a violation, infinite if there are no
    /// pairs, NaN if the scene is not finite.
    #[must_use]
    pub fn min_margin_m(&self, scene: &Scene<'_>) -> f64 {
        self.margin_m(scene, Measure::Distance)
    }

    /// As [`CollisionModel::min_margin_m`], with the penetration depth of overlapping primitives as a negative distance.
    #[must_use]
    pub fn min_signed_margin_m(&self, scene: &Scene<'_>) -> f64 {
        self.margin_m(scene, Measure::SignedDistance)
    }

    fn margin_m(&self, scene: &Scene<'_>, measure: Measure) -> f64 {
        if self.undefined_body(scene).is_some() {
            return f64::NAN;
        }
        let poses = scene.link_poses;
        let board = scene.board.piece.placed(&scene.x_wo);
        let mut margin_m = f64::INFINITY;
        for pair in &self.self_pairs {
            let ([a, b], clearance_m) = (pair.links, pair.required_m(scene.clearance_m));
            let bound_m = margin_m + clearance_m;
            let nearest = self.links[a].distance_within(&poses[a], &self.links[b], &poses[b], bound_m, measure);
            margin_m = nearest - clearance_m;
        }
        for link in (0..self.links.len()).filter(|&link| !self.may_touch_board(scene, link)) {
            let required_m = self.board_clearance_m(link, scene.clearance_m);
            let bound_m = margin_m + required_m;
            let nearest = self.links[link].distance_to_within(&poses[link], &board, bound_m, measure);
            margin_m = nearest - required_m;
        }
        for part in scene.person {
            let capsule = Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m);
            let capsule = capsule.placed(&Pose::identity());
            if let Some(clearance_m) = part.board_clearance_m {
                margin_m = capsule.distance_within(&board, margin_m + clearance_m, measure) - clearance_m;
            }
            let clearance_m = part.robot_clearance_m;
            let links = self.links.iter().zip(poses);
            let nearest = links.fold(margin_m + clearance_m, |bound_m, (link, x_wl)| {
                link.distance_to_within(x_wl, &capsule, bound_m, measure)
            });
            margin_m = nearest - clearance_m;
        }
        margin_m
    }

    /// The first body whose pose or size is not finite; a link without a pose is one.
    fn undefined_body(&self, scene: &Scene<'_>) -> Option<Body> {
        let finite =
            |pose: &Pose| pose.translation.vector.iter().chain(pose.rotation.coords.iter()).all(|v| v.is_finite());
        let link = (0..self.links.len()).find(|&link| !scene.link_poses.get(link).is_some_and(finite));
        if let Some(link) = link {
            return Some(Body::Link(link));
        }
        if !finite(&scene.x_wo) || !scene.board.is_finite {
            return Some(Body::Board);
        }
        let part_is_finite = |part: &&PersonPart| {
            let ends = part.p0_w.coords.iter().chain(part.p1_w.coords.iter());
            let clearances = [part.radius_m, part.robot_clearance_m, part.board_clearance_m.unwrap_or(0.0)];
            ends.chain(&clearances).all(|v| v.is_finite())
        };
        scene.person.iter().find(|part| !part_is_finite(part)).map(|part| Body::Person(part.name))
    }

    /// The distance that a link must keep from the board, m, where `clearance_m` is asked for.
    pub fn board_clearance_m(&self, link: usize, clearance_m: f64) -> f64 {
        clearance_m.min(self.board_most_m[link])
    }

    /// True for fingers of a gripper that holds the board.
    fn may_touch_board(&self, scene: &Scene<'_>, link: usize) -> bool {
        scene.holding.iter().any(|&arm| self.fingers[arm].contains(&link))
    }

    /// All primitives of all links in W, in order of the links.
    fn placed_primitives(&self, poses: &[Pose]) -> Vec<Placed<'_>> {
        self.links.iter().zip(poses).flat_map(|(link, x_wl)| place_all(&link.pieces, x_wl)).collect()
    }

    /// All links, with their primitives from the list of all.
    fn placed_links<'a>(&self, poses: &[Pose], mut placed: &'a [Placed<'a>]) -> Vec<PlacedLink<'a>> {
        let place = |(link, x_wl): (&LinkShapes, &Pose)| {
            let (pieces, rest) = placed.split_at(link.pieces.len());
            placed = rest;
            PlacedLink::new(link, pieces, x_wl)
        };
        self.links.iter().zip(poses).map(place).collect()
    }

    fn robot_self(&self, scene: &Scene<'_>, links: &[PlacedLink<'_>]) -> Option<Violation> {
        self.self_pairs.iter().find_map(|pair| {
            let ([a, b], required_m) = (pair.links, pair.required_m(scene.clearance_m));
            let distance_m = links[a].too_close_to(&links[b], required_m)?;
            Some(Violation { bodies: [Body::Link(a), Body::Link(b)], required_m, distance_m })
        })
    }

    fn robot_board(&self, scene: &Scene<'_>, links: &[PlacedLink<'_>], board: &Placed<'_>) -> Option<Violation> {
        let mut links = links.iter().enumerate().filter(|(link, _)| !self.may_touch_board(scene, *link));
        links.find_map(|(link, placed)| self.link_board(scene, link, placed, board))
    }

    /// The violation of a link's clearance from the board.
    fn link_board(
        &self,
        scene: &Scene<'_>,
        link: usize,
        placed: &PlacedLink<'_>,
        board: &Placed<'_>,
    ) -> Option<Violation> {
        let required_m = self.board_clearance_m(link, scene.clearance_m);
        let distance_m = placed.too_close(board, required_m)?;
        Some(Violation { bodies: [Body::Link(link), Body::Board], required_m, distance_m })
    }
}

/// The first violation of one part of the person.
fn person(links: &[PlacedLink<'_>], board: &Placed<'_>, part: &PersonPart) -> Option<Violation> {
    let capsule = Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m);
    let capsule = capsule.placed(&Pose::identity());
    let violation =
        |other, required_m, distance_m| Violation { bodies: [Body::Person(part.name), other], required_m, distance_m };
    if let Some(required_m) = part.board_clearance_m
        && capsule.closer_than(board, required_m)
    {
        return Some(violation(Body::Board, required_m, capsule.distance_m(board)));
    }
    let required_m = part.robot_clearance_m;
    links.iter().enumerate().find_map(|(index, link)| {
        let distance_m = link.too_close(&capsule, required_m)?;
        Some(violation(Body::Link(index), required_m, distance_m))
    })
}

/// The links that move with a gripper's fingers, or its suction cup: they may touch the board.
fn fingers(robot: &Robot, gripper: &crate::robot::Gripper) -> Vec<usize> {
    let mut fingers: Vec<usize> = gripper.fingers.iter().map(|finger| robot.joints[finger.joint].child_link).collect();
    fingers.extend(gripper.cup.map(|cup| cup.link));
    for joint in &robot.joints {
        if fingers.contains(&joint.parent_link) && !fingers.contains(&joint.child_link) {
            fingers.push(joint.child_link);
        }
    }
    fingers
}
