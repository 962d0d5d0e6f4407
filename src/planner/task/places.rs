//! The board poses of a task, and the person's postures at them.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::{
    super::{
        domain::uniform,
        library::{BoardGrasp, PostureMap},
        params::task::{DISTINCT_TOOL_M, DISTINCT_TOOL_RAD, MAPPED_STARTS, SHIFT_M, SHIFT_RAD, SHIFTS, TOOL_POSES},
        screen::standing_pose,
    },
    problem::{Posture, TaskProblem},
    root::Root,
};
use crate::{
    human::{BODY_POINTS, Standing, peripersonal_m},
    model::frames::Pose,
};

/// A pose of the board.
pub struct Place {
    x_wo: Pose,
    /// By piece; `None` if the person has no posture for it.
    beside: Vec<Option<Beside>>,
}

/// The person's posture without a robot, with what of its comfort does not depend on the robot.
struct Beside {
    posture: Posture,
    muscular: f64,
    body_w: [Point3<f64>; BODY_POINTS],
}

/// All board poses: for every pose of the tool a lattice of shifts, and for each shift all pieces; then those of the best holds.
pub struct Places {
    /// `None` outside the search domain.
    places: Vec<Option<Place>>,
    /// The number of those of the lattices.
    lattices: usize,
    /// The pieces of the best holds, whose board poses follow the lattices.
    of_roots: Vec<usize>,
    pieces: usize,
    closed: bool,
}

/// A pose of the tool at which a person works comfortably.
#[derive(Clone, Copy)]
struct ToolPose {
    x_wt: Pose,
    posture: Posture,
}

impl ToolPose {
    /// That of a best hold.
    fn of(problem: &TaskProblem<'_>, Root { piece, grasp, posture, .. }: &Root) -> Self {
        let x_wt = grasp.x_wo * problem.operation(*piece, posture.roll_rad).x_ot;
        Self { x_wt, posture: *posture }
    }
}

/// Shifts of a tool's pose.
const LATTICE: usize = SHIFTS * SHIFTS * SHIFTS;

impl Places {
    /// The board poses of the most comfortable holds that differ.
    pub fn new(problem: &TaskProblem<'_>, map: &PostureMap, roots: &[Root], closed: bool) -> Self {
        let tools = distinct_tools(problem, roots);
        let pieces = problem.pieces();
        let numbered: Vec<_> = (0..tools.len() * pieces).collect();
        let of_piece = |&number: &usize| postures(problem, map, &tools[number / pieces], number % pieces);
        let postures: Vec<_> = numbered.par_iter().map(of_piece).collect();
        let of_place = |number: usize| {
            let (tool, shift, piece) = (number / pieces / LATTICE, number / pieces % LATTICE, number % pieces);
            let shift_w = planar(shift, &tools[tool].x_wt.translation.vector);
            place(problem, &tools[tool], &shift_w, piece, &postures[tool * pieces + piece])
        };
        let lattices = tools.len() * LATTICE * pieces;
        let of_root = |root: &Root| {
            let tool = ToolPose::of(problem, root);
            let postures = self::postures(problem, map, &tool, root.piece);
            place(problem, &tool, &Pose::identity(), root.piece, &postures)
        };
        let in_lattices: Vec<_> = (0..lattices).into_par_iter().map(of_place).collect();
        let of_their_own: Vec<_> = roots.par_iter().map(of_root).collect();
        let places = in_lattices.into_iter().chain(of_their_own).collect();
        Self { places, lattices, of_roots: roots.iter().map(|root| root.piece).collect(), pieces, closed }
    }

    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// The board's pose; `None` outside the search domain.
    pub fn x_wo(&self, place: usize) -> Option<Pose> {
        self.places[place].as_ref().map(|place| place.x_wo)
    }

    /// The piece that is at the tool.
    pub fn piece(&self, place: usize) -> usize {
        place.checked_sub(self.lattices).map_or(place % self.pieces, |root| self.of_roots[root])
    }

    /// The place of a best hold.
    pub fn of_root(&self, root: usize) -> usize {
        self.lattices + root
    }

    /// The unshifted places of a piece in the lattices.
    fn central(&self, piece: usize) -> impl Iterator<Item = usize> + use<> {
        let (pieces, tools) = (self.pieces, self.lattices / (LATTICE * self.pieces));
        (0..tools).map(move |tool| (tool * LATTICE + LATTICE / 2) * pieces + piece)
    }

    /// A random place of a piece; `None` if it is outside the search domain.
    pub fn drawn_of(&self, piece: usize, random: &mut Pcg64) -> Option<usize> {
        let (place, _) = self.drawn(random)?;
        let place = place - self.piece(place) + piece;
        self.places[place].as_ref().map(|_| place)
    }

    /// A random place with the board's pose; `None` if it is outside the search domain.
    pub fn drawn(&self, random: &mut Pcg64) -> Option<(usize, Pose)> {
        let count = self.lattices;
        let place = (uniform(random, 0.0, count as f64) as usize).min(count.checked_sub(1)?);
        Some((place, self.x_wo(place)?))
    }

    /// The places beside one: the piece before or after at the tool, or one step of the lattice away.
    pub fn beside(&self, place: usize) -> Vec<usize> {
        if place >= self.lattices {
            return self.central(self.piece(place)).collect();
        }
        let (piece, rest) = (place % self.pieces, place / self.pieces);
        let (shift, tool) = (rest % LATTICE, rest / LATTICE);
        let mut beside = Vec::with_capacity(8);
        for (wraps, other) in [
            (piece == 0, (piece + self.pieces - 1) % self.pieces),
            (piece + 1 == self.pieces, (piece + 1) % self.pieces),
        ] {
            if (self.closed || !wraps) && other != piece {
                beside.push(rest * self.pieces + other);
            }
        }
        for axis in [1, SHIFTS, SHIFTS * SHIFTS] {
            let along = shift / axis % SHIFTS;
            let others = [(along > 0).then(|| shift - axis), (along + 1 < SHIFTS).then_some(shift + axis)];
            beside.extend(others.into_iter().flatten().map(|shift| (tool * LATTICE + shift) * self.pieces + piece));
        }
        if shift == LATTICE / 2 {
            let roots = self.of_roots.iter().enumerate().filter(|(_, of)| **of == piece);
            beside.extend(roots.map(|(root, _)| self.lattices + root));
        }
        beside
    }

    /// The person's posture at a piece with the board at a place.
    pub fn posture(&self, place: usize, piece: usize) -> Option<Posture> {
        self.places[place].as_ref()?.beside[piece].as_ref().map(|beside| beside.posture)
    }

    /// What the pieces cost at a hold, from below: without stability, contacts and sight; infinite without a posture.
    pub fn costs(&self, problem: &TaskProblem<'_>, place: usize, grasp: &BoardGrasp) -> Vec<f64> {
        let points_w = problem.robot_points_w(&problem.robot.link_poses(&grasp.arms));
        let cost = |(piece, beside): (usize, &Option<Beside>)| {
            let Beside { muscular, body_w, .. } = beside.as_ref()?;
            let settings = &problem.of_piece(piece).objective;
            let distance_m = peripersonal_m(settings.peripersonal, settings.saturation_m, body_w, &points_w);
            let [of_muscular, of_peripersonal] = settings.weights();
            problem.cost(piece, of_muscular * muscular + of_peripersonal * distance_m)
        };
        let beside = self.places[place].iter().flat_map(|place| &place.beside);
        beside.enumerate().map(|entry| cost(entry).unwrap_or(f64::INFINITY)).collect()
    }
}

/// The tool's poses of the most comfortable holds that differ.
fn distinct_tools(problem: &TaskProblem<'_>, roots: &[Root]) -> Vec<ToolPose> {
    let mut order: Vec<_> = roots.iter().collect();
    order.sort_by(|a, b| b.objective.total_cmp(&a.objective));
    let mut tools: Vec<ToolPose> = Vec::new();
    for root in order {
        let own = ToolPose::of(problem, root);
        let is_same = |tool: &ToolPose| {
            (tool.x_wt.translation.vector - own.x_wt.translation.vector).norm() < DISTINCT_TOOL_M
                && tool.x_wt.rotation.angle_to(&own.x_wt.rotation) < DISTINCT_TOOL_RAD
        };
        if tools.len() < TOOL_POSES && !tools.iter().any(is_same) {
            tools.push(own);
        }
    }
    tools
}

/// A shift of the lattice: a turn about the vertical through a point, and a shift along x_W and y_W.
fn planar(shift: usize, about_w: &Vector3<f64>) -> Pose {
    let middle = (SHIFTS / 2) as f64;
    let [x, y, turn] = [1, SHIFTS, SHIFTS * SHIFTS].map(|axis| (shift / axis % SHIFTS) as f64 - middle);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn * SHIFT_RAD);
    let shift = about_w + Vector3::new(x * SHIFT_M, y * SHIFT_M, 0.0) - turn * about_w;
    Isometry3::from_parts(shift.into(), turn)
}

/// The person's postures beside the board with a piece at a pose of the tool: that of the tool's pose for this piece; for others a
/// posture near that for the piece between them and this one, or near the most comfortable ones of the posture map.
fn postures(problem: &TaskProblem<'_>, map: &PostureMap, tool: &ToolPose, there: usize) -> Vec<(usize, Posture)> {
    let x_wo = problem.board_pose(&tool.x_wt, tool.posture.roll_rad, there);
    let mut postures = vec![(there, tool.posture)];
    for forward in [true, false] {
        let mut last = Some(tool.posture);
        let mut piece = there;
        loop {
            let next =
                if forward { Some(piece + 1).filter(|&next| next < problem.pieces()) } else { piece.checked_sub(1) };
            let Some(next) = next else { break };
            piece = next;
            let near = last.and_then(|last| problem.response_near(piece, &x_wo, &last, &[], &[]));
            last = near.or_else(|| mapped(problem, map, &x_wo, piece, tool.posture.roll_rad));
            postures.extend(last.map(|found| (piece, found)));
        }
    }
    postures
}

/// The best posture near the most comfortable ones of the map.
fn mapped(problem: &TaskProblem<'_>, map: &PostureMap, x_wo: &Pose, piece: usize, roll_rad: f64) -> Option<Posture> {
    let x_wt = x_wo * problem.operation(piece, roll_rad).x_ot;
    let floor_z_m = problem.robot.robot.floor_z_m;
    let mut known: Vec<_> = map.postures(&x_wt, floor_z_m).iter().collect();
    known.sort_by(|a, b| b.muscular.total_cmp(&a.muscular));
    known.into_iter().take(MAPPED_STARTS).find_map(|posture| {
        let x_wb = standing_pose(&x_wt, &posture.x_bt, floor_z_m);
        let from = Posture { x_wb, q_h_rad: posture.q_h_rad, roll_rad };
        problem.response_near(piece, x_wo, &from, &[], &[])
    })
}

/// Board and person shifted; `None` outside the search domain.
fn place(
    problem: &TaskProblem<'_>,
    tool: &ToolPose,
    shift_w: &Pose,
    piece: usize,
    postures: &[(usize, Posture)],
) -> Option<Place> {
    let x_wo = shift_w * problem.board_pose(&tool.x_wt, tool.posture.roll_rad, piece);
    if !problem.robot.domain.contains(&x_wo) {
        return None;
    }
    let mut beside: Vec<Option<Beside>> = (0..problem.pieces()).map(|_| None).collect();
    for (piece, posture) in postures {
        let posture = Posture { x_wb: shift_w * posture.x_wb, ..*posture };
        let human = &problem.of_piece(*piece).human;
        if !human.may_stand(&Standing::of(&posture.x_wb)) {
            continue;
        }
        let muscular = problem.comfort(*piece, &x_wo, &posture, &[]).muscular_regularised;
        let body_w = human.body_points_w(&posture.x_wb, &posture.q_h_rad);
        beside[*piece] = Some(Beside { posture, muscular, body_w });
    }
    Some(Place { x_wo, beside })
}
