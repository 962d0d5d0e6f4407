//! The hand at the end of an arm: its fingers, the frame G, the pads.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};

use super::skeleton::Run;
use crate::{
    model::frames::Pose,
    robot::{Face, JointKind, Linkage, Robot},
};

/// Tolerance of directions of existing frames, as the sine of an angle: four quarter turns with six digits.
const SAME_DIRECTION: f64 = 1e-5;

/// Points of a finger within this distance of its innermost plane belong to the pad, m.
const PAD_DEPTH_M: f64 = 1.5e-3;

/// Smallest and largest side of a guessed pad, m.
const PAD_SIDE_M: [f64; 2] = [0.008, 0.080];

/// Distance of a board's edge from the palm at least, m: the usual clearance, and as much to search in.
const PALM_CLEARANCE_M: f64 = 0.015;

/// Side of a clamp's pads, m, its opening, m, and its distance in front of the hand, m: assumed.
const CLAMP_PAD_M: f64 = 0.040;
const CLAMP_OPENING_M: [f64; 2] = [0.0, 0.060];
const CLAMP_AHEAD_M: f64 = 0.040;

/// Largest distance of G from the centre of the pads at which an existing frame is taken for G, m.
const NEAR_PADS_M: f64 = 0.03;

/// Openings are written in steps of this size, m, inside what the joints allow.
const OPENING_STEP_M: f64 = 1e-4;

/// What holds the board at the end of an arm.
#[derive(Clone, Debug)]
pub(super) struct Hand {
    /// The link in which the frame G is given.
    pub frame_link: usize,
    /// The pose of G in it; `None` if it is the link's own frame.
    pub x_lg: Option<Pose>,
    pub palm_link: usize,
    pub fingers: Fingers,
    pub opening_m: [f64; 2],
    pub pad_size_m: [f64; 2],
    pub pad_centre_m: [f64; 2],
    /// Why it is not what one might expect.
    pub remark: Option<String>,
}

/// The fingers of a hand.
#[derive(Clone, Debug)]
pub(super) enum Fingers {
    /// Two prismatic joints, each with its pad's link.
    Prismatic([(usize, usize); 2]),
    /// The links of the two pads of a linkage.
    Linkage([Vec<usize>; 2]),
    /// None that close in parallel: a clamp in their place.
    Clamp,
}

/// The hand at the end of a run.
pub(super) fn hand(robot: &Robot, run: &Run) -> Hand {
    let x_wl = robot.link_poses(&robot.positions(&[]));
    let scene = Scene { robot, run, x_wl: &x_wl };
    let fingers = scene.prismatic().map_or_else(|| scene.linkage(), Ok);
    fingers.unwrap_or_else(|remark| scene.clamp(remark)).with_frame_at_pads()
}

impl Hand {
    /// The hand with G at the pads, if it is far from them: grasps are searched with G 20 to 60 mm inside the board's edge
    /// (docs/method.md#25-edge-grasps).
    fn with_frame_at_pads(mut self) -> Self {
        let [x_m, z_m] = self.pad_centre_m;
        if x_m.hypot(z_m) > NEAR_PADS_M {
            let x_gp = Isometry3::translation(x_m, 0.0, z_m);
            self.x_lg = Some(self.x_lg.map_or(x_gp, |x_lg| x_lg * x_gp));
            self.pad_centre_m = [0.0; 2];
        }
        self
    }
}

struct Scene<'a> {
    robot: &'a Robot,
    run: &'a Run,
    /// Poses of all links at rest.
    x_wl: &'a [Pose],
}

impl Scene<'_> {
    /// The links that hang on a joint without further joints between them.
    fn rigid_behind(&self, joint: usize) -> Vec<usize> {
        let carriers = self.robot.carriers();
        (0..self.robot.links.len()).filter(|&link| carriers[link] == Some(joint)).collect()
    }

    /// All links behind the end of the run.
    fn behind_end(&self) -> Vec<usize> {
        let mut behind = self.run.end_links.clone();
        // Parents come before children.
        for (index, link) in self.robot.links.iter().enumerate() {
            let parent = link.parent_joint.map(|joint| self.robot.joints[joint].parent_link);
            if parent.is_some_and(|parent| behind.contains(&parent)) && !behind.contains(&index) {
                behind.push(index);
            }
        }
        behind
    }

    /// Points on the surface of a link's shapes, W.
    fn points_w(&self, link: usize) -> Vec<Point3<f64>> {
        self.face_points_w(&Face::of_links(self.robot, &[link]))
    }

    /// Points on the surface of shapes, W.
    fn face_points_w(&self, face: &Face) -> Vec<Point3<f64>> {
        let of_shape = |&[link, shape]: &[usize; 2]| {
            let placed = &self.robot.links[link].shapes[shape];
            let points = placed.shape.surface_points().into_iter();
            points.map(move |p_s| self.x_wl[link] * (placed.x_ls * p_s))
        };
        face.shapes().iter().flat_map(of_shape).collect()
    }

    fn mean_w(&self, links: &[usize]) -> Option<Vector3<f64>> {
        let points: Vec<_> = links.iter().flat_map(|&link| self.points_w(link)).collect();
        let count = points.len() as f64;
        (!points.is_empty()).then(|| points.iter().map(|point| point.coords).sum::<Vector3<f64>>() / count)
    }

    /// Two prismatic joints on the end of the run that move along one line.
    fn prismatic(&self) -> Option<Hand> {
        let slides = |joint: &&usize| self.robot.joints[**joint].kind == JointKind::Prismatic;
        let slides: Vec<usize> = self.run.end_joints.iter().filter(slides).copied().collect();
        let axis_w = |joint: usize| {
            let joint = &self.robot.joints[joint];
            (self.x_wl[joint.parent_link] * joint.x_pj).rotation * joint.axis_j.into_inner()
        };
        let pairs =
            slides.iter().enumerate().flat_map(|(number, &a)| slides[number + 1..].iter().map(move |&b| [a, b]));
        let [first, second] = pairs.into_iter().find(|[a, b]| axis_w(*a).cross(&axis_w(*b)).norm() < SAME_DIRECTION)?;
        let palm_link = self.robot.joints[first].parent_link;
        let groups = [first, second].map(|joint| self.rigid_behind(joint));
        let centres = [self.mean_w(&groups[0])?, self.mean_w(&groups[1])?];
        let y_w = axis_w(first) * (centres[0] - centres[1]).dot(&axis_w(first)).signum();
        let (frame_link, x_lg) = self.frame(palm_link, &y_w, &((centres[0] + centres[1]) / 2.0));
        let x_wg = x_lg.map_or(self.x_wl[frame_link], |x_lg| self.x_wl[frame_link] * x_lg);
        // Pads are at the tips.
        let pad_of = |links: &[usize]| {
            let ahead_m = |link: usize| self.mean_w(&[link]).map(|mean_w| (x_wg.inverse() * Point3::from(mean_w)).z);
            let solid = links.iter().filter_map(|&link| Some((ahead_m(link)?, link)));
            solid.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, link)| link)
        };
        let pads = [pad_of(&groups[0])?, pad_of(&groups[1])?];
        let faces = pads.map(|link| Face::of_links(self.robot, &[link]));
        let faces = Face::facing(&faces, self.robot, self.x_wl, &x_wg.inverse());
        let range_m = self.prismatic_range_m([first, second], &faces, &x_wg);
        let (pad_size_m, pad_centre_m) = self.pads(&faces, [x_wg; 2])?;
        Some(Hand {
            frame_link,
            x_lg,
            palm_link,
            fingers: Fingers::Prismatic([(first, pads[0]), (second, pads[1])]),
            opening_m: rounded(range_m),
            pad_size_m,
            pad_centre_m,
            remark: None,
        })
    }

    /// Distance of the innermost plane of shapes from y_G = 0 on their side, m.
    fn face_m(&self, face: &Face, x_wg: &Pose, side: f64) -> f64 {
        let points = self.face_points_w(face).into_iter().map(|p_w| x_wg.inverse() * p_w);
        points.map(|p_g| side * p_g.y).fold(f64::INFINITY, f64::min)
    }

    /// The gaps between two pads that their joints allow.
    fn prismatic_range_m(&self, joints: [usize; 2], faces: &[Face; 2], x_wg: &Pose) -> [f64; 2] {
        let gap_now = self.face_m(&faces[0], x_wg, 1.0) + self.face_m(&faces[1], x_wg, -1.0);
        // Each finger opens from its rest position to one of its limits and closes to the other.
        let axis_y = |joint: usize| {
            let joint = &self.robot.joints[joint];
            let axis_w = (self.x_wl[joint.parent_link] * joint.x_pj).rotation * joint.axis_j.into_inner();
            (x_wg.rotation.inverse() * axis_w).y
        };
        let mut range = [gap_now; 2];
        for (joint, side) in joints.into_iter().zip([1.0, -1.0]) {
            let Some(of) = self.robot.joints.get(joint) else { continue };
            let (to_lower, to_upper) = (of.lower - of.rest, of.upper - of.rest);
            let opens = side * axis_y(joint) > 0.0;
            let [closing, opening] = if opens { [to_lower, to_upper] } else { [-to_upper, -to_lower] };
            range[0] += closing;
            range[1] += opening;
        }
        range
    }

    /// The link whose frame is G, or a link and the pose of G in it: y along `y_w`, z towards the fingers.
    fn frame(&self, palm_link: usize, y_w: &Vector3<f64>, fingers_w: &Vector3<f64>) -> (usize, Option<Pose>) {
        let palm = &self.x_wl[palm_link];
        let ahead = fingers_w - palm.translation.vector;
        let ahead = ahead - y_w * ahead.dot(y_w);
        let z_w = self.nearest_axis(palm, &ahead.try_normalize(1e-9).unwrap_or_else(|| palm.rotation * Vector3::z()));
        let is_g = |link: &&usize| {
            let rotation = self.x_wl[**link].rotation;
            (rotation * Vector3::y()).cross(y_w).norm() < SAME_DIRECTION && (rotation * Vector3::z()).dot(&z_w) > 0.999
        };
        let ahead_m = |link: &usize| (self.x_wl[*link].translation.vector - palm.translation.vector).dot(&z_w);
        let existing = self.run.end_links.iter().filter(is_g).max_by(|a, b| ahead_m(a).total_cmp(&ahead_m(b)));
        if let Some(&link) = existing {
            return (link, None);
        }
        (palm_link, Some(palm.inverse() * frame_at(palm.translation.vector, y_w, &z_w)))
    }

    /// The axis of a frame that is nearest to a direction, if it is within ten degrees of it.
    fn nearest_axis(&self, frame: &Pose, direction_w: &Vector3<f64>) -> Vector3<f64> {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().flat_map(|axis| [axis, -axis]);
        let axes = axes.map(|axis| frame.rotation * axis);
        let nearest = axes.max_by(|a, b| a.dot(direction_w).total_cmp(&b.dot(direction_w)));
        nearest.filter(|axis| axis.dot(direction_w) > 10_f64.to_radians().cos()).unwrap_or(*direction_w)
    }

    /// Sides along x_G and z_G and centre of the area in which both pads touch; `None` if they do not face each other. Each pad's
    /// links are at rest in W, and G at its entry of `x_wg`.
    fn pads(&self, faces: &[Face; 2], x_wg: [Pose; 2]) -> Option<([f64; 2], [f64; 2])> {
        let mut common = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
        for ((face, side), x_wg) in faces.iter().zip([1.0, -1.0]).zip(x_wg) {
            let points: Vec<_> = self.face_points_w(face).into_iter().map(|p_w| x_wg.inverse() * p_w).collect();
            let inner = points.iter().map(|p_g| side * p_g.y).fold(f64::INFINITY, f64::min);
            let face = points.iter().filter(|p_g| side * p_g.y <= inner + PAD_DEPTH_M);
            let mut own = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
            for p_g in face {
                for (range, value) in own.iter_mut().zip([p_g.x, p_g.z]) {
                    *range = [range[0].min(value), range[1].max(value)];
                }
            }
            for (common, own) in common.iter_mut().zip(own) {
                *common = [common[0].max(own[0]), common[1].min(own[1])];
            }
        }
        if common.iter().any(|[low, high]| high <= low) {
            return None;
        }
        // A board reaches to the palm at most.
        let palm_m = self.palm_front_m(&x_wg[0]) + PALM_CLEARANCE_M;
        if palm_m < common[1][1] - PAD_SIDE_M[0] {
            common[1][0] = common[1][0].max(palm_m);
        }
        let millimetre_tenths = |v: f64| (v * 1e4).round() / 1e4 + 0.0;
        let size = common.map(|[low, high]| millimetre_tenths((high - low).clamp(PAD_SIDE_M[0], PAD_SIDE_M[1])));
        Some((size, common.map(|[low, high]| millimetre_tenths((low + high) / 2.0))))
    }

    /// How far the links at the end of the run reach along z of G, m.
    fn palm_front_m(&self, x_wg: &Pose) -> f64 {
        let points = self.run.end_links.iter().flat_map(|&link| self.points_w(link));
        points.map(|p_w| (x_wg.inverse() * p_w).z).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Two links of the hand that a linkage moves in parallel; else why there are none.
    fn linkage(&self) -> Result<Hand, Option<String>> {
        let moving: Vec<usize> =
            self.behind_end().into_iter().filter(|link| !self.run.end_links.contains(link)).collect();
        let solid: Vec<usize> =
            moving.iter().copied().filter(|&link| !self.robot.links[link].shapes.is_empty()).collect();
        if solid.len() < 2 {
            return Err(solid.first().map(|&only| format!("found {} alone", self.robot.links[only].name)));
        }
        let mut best: Option<(f64, Hand)> = None;
        let mut problem = None;
        for (number, &a) in solid.iter().enumerate() {
            for &b in &solid[number + 1..] {
                match self.linkage_of([vec![a], vec![b]], &solid) {
                    Ok((ahead_m, hand)) if best.as_ref().is_none_or(|(most_m, _)| ahead_m > *most_m) => {
                        best = Some((ahead_m, hand));
                    }
                    Ok(_) => {}
                    Err(found) => problem = problem.or(Some(found)),
                }
            }
        }
        best.map(|(_, hand)| hand).ok_or(problem)
    }

    /// A hand with these pads, and how far in front of the palm they are, m. If they do not face each other those of the `solid`
    /// links that move with one of them are taken to be part of it.
    fn linkage_of(&self, pads: [Vec<usize>; 2], solid: &[usize]) -> Result<(f64, Hand), String> {
        let first = [pads[0][0], pads[1][0]];
        let palm_link = self.palm_of(first);
        let [first_w, second_w] = pads.each_ref().map(|links| self.mean_w(links).unwrap_or_default());
        let between_w = first_w - second_w;
        let y_w = match Linkage::opening_w(self.robot, palm_link, first) {
            Some(y_w) => y_w * y_w.dot(&between_w).signum(),
            None => between_w.try_normalize(1e-6).ok_or("found pads at one place")?,
        };
        let y_w = self.nearest_axis(&self.x_wl[palm_link], &y_w);
        let (frame_link, x_lg) = self.frame(palm_link, &y_w, &((first_w + second_w) / 2.0));
        let mut robot = self.robot.clone();
        let frame = x_lg.map_or(frame_link, |x_lg| robot.add_frame("gripper frame", frame_link, x_lg));
        let linkage = Linkage::new(&robot, [frame, palm_link], pads.clone(), None)?;
        let range_m = linkage.range_m(&robot, frame)?;
        let opening_m = rounded([range_m[0].max(0.0), range_m[1]]);
        let x_gl = linkage.pad_poses_g(&robot, frame, opening_m[0]);
        // The pads as they are at the narrowest opening: as if G had moved to the link's pose at rest.
        let mut x_wg = [0, 1].map(|pad| self.x_wl[first[pad]] * x_gl[pad].inverse());
        let (mut fingers, mut faces) = (pads.clone(), linkage.faces().clone());
        if x_gl[0].translation.y < x_gl[1].translation.y {
            fingers.reverse();
            faces.reverse();
            x_wg.reverse();
        }
        let Some((pad_size_m, pad_centre_m)) = self.pads(&faces, x_wg) else {
            let with_others = [0, 1].map(|pad| {
                let others = solid.iter().copied().filter(|link| !first.contains(link));
                let mut links = pads[pad].clone();
                links.extend(others.filter(|&link| linkage.moves_with(&robot, pad, link)));
                links
            });
            if pads.iter().any(|links| links.len() > 1) || with_others == pads {
                return Err("found pads that do not face each other".into());
            }
            return self.linkage_of(with_others, solid);
        };
        let fingers = Fingers::Linkage(fingers);
        let hand = Hand { frame_link, x_lg, palm_link, fingers, opening_m, pad_size_m, pad_centre_m, remark: None };
        Ok((pad_centre_m[1], hand))
    }

    /// The link of the hand on which the joints of two pads hang.
    fn palm_of(&self, links: [usize; 2]) -> usize {
        let mut link = links[0];
        while !self.run.end_links.contains(&link) {
            let Some(joint) = self.robot.links[link].parent_joint else { break };
            link = self.robot.joints[joint].parent_link;
        }
        link
    }

    /// A clamp in front of everything at the end of the run.
    fn clamp(&self, problem: Option<String>) -> Hand {
        let last = self.run.joints.last().map_or(0, |&joint| self.robot.joints[joint].child_link);
        let tip = self.tip_link();
        let start_w = self.x_wl[last].translation.vector;
        let along_w = self.x_wl[tip].translation.vector - start_w;
        let behind = self.behind_end();
        let wanted = along_w.try_normalize(0.005).unwrap_or_else(|| self.outward_axis_w());
        let z_w = self.nearest_axis(&self.x_wl[last], &wanted);
        let y_w = self.perpendicular(last, &z_w);
        let tip_w = self.x_wl[tip].translation.vector;
        let points = behind.iter().flat_map(|&link| self.points_w(link));
        let ahead_m = points.map(|p_w| (p_w.coords - tip_w).dot(&z_w)).fold(0.0, f64::max);
        let x_wg = frame_at(tip_w, &y_w, &z_w);
        let centre_m = ahead_m + CLAMP_AHEAD_M + CLAMP_PAD_M / 2.0;
        let remark = problem.map_or_else(
            || "no fingers were found at its end".to_owned(),
            |problem| format!("its fingers do not close in parallel ({problem})"),
        );
        Hand {
            frame_link: tip,
            x_lg: Some(self.x_wl[tip].inverse() * x_wg),
            palm_link: tip,
            fingers: Fingers::Clamp,
            opening_m: CLAMP_OPENING_M,
            pad_size_m: [CLAMP_PAD_M; 2],
            pad_centre_m: [0.0, (centre_m * 1e3).round() / 1e3],
            remark: Some(remark),
        }
    }

    /// The axis of the last joint, away from the joint before it.
    fn outward_axis_w(&self) -> Vector3<f64> {
        let frame = |joint: usize| self.x_wl[self.robot.joints[joint].child_link];
        let [.., before, last] = self.run.joints[..] else { return Vector3::z() };
        let axis_w = frame(last).rotation * self.robot.joints[last].axis_j.into_inner();
        let outward = axis_w.dot(&(frame(last).translation.vector - frame(before).translation.vector));
        if outward < 0.0 { -axis_w } else { axis_w }
    }

    /// The link at the end of the run that is farthest from its last joint.
    fn tip_link(&self) -> usize {
        let last = self.run.joints.last().map_or(0, |&joint| self.robot.joints[joint].child_link);
        let from_m = |link: usize| (self.x_wl[link].translation.vector - self.x_wl[last].translation.vector).norm();
        let farthest = self.run.end_links.iter().copied().map(|link| (from_m(link), link));
        farthest.fold((0.0, last), |best, next| if next.0 > best.0 + 1e-9 { next } else { best }).1
    }

    /// The axis of a link's frame that is most nearly normal to a direction, made exactly normal to it.
    fn perpendicular(&self, link: usize, z_w: &Vector3<f64>) -> Vector3<f64> {
        let axes = [Vector3::y(), Vector3::x(), Vector3::z()].map(|axis| self.x_wl[link].rotation * axis);
        let along = |axis: &Vector3<f64>| axis.dot(z_w).abs();
        let axis = axes.into_iter().min_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or_else(Vector3::y);
        (axis - z_w * axis.dot(z_w)).normalize()
    }
}

/// A frame with these axes.
fn frame_at(origin_w: Vector3<f64>, y_w: &Vector3<f64>, z_w: &Vector3<f64>) -> Pose {
    let z_w = (z_w - y_w * z_w.dot(y_w)).normalize();
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[y_w.cross(&z_w), *y_w, z_w]));
    Isometry3::from_parts(origin_w.into(), UnitQuaternion::from_rotation_matrix(&rotation))
}

/// An opening in whole steps, inside the range.
fn rounded([low_m, high_m]: [f64; 2]) -> [f64; 2] {
    // Rounding of a sum of decimals is no step.
    let tiny = 1e-9;
    let low = ((low_m.max(0.0) - tiny) / OPENING_STEP_M).ceil().max(0.0) * OPENING_STEP_M;
    let high = ((high_m + tiny) / OPENING_STEP_M).floor() * OPENING_STEP_M;
    [low, high].map(|v| (v * 1e6).round() / 1e6)
}
