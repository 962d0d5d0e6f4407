//! Grippers whose fingers are moved by a linkage: the equivalent parallel jaw.
//!
//! A linkage that keeps its pads parallel holds a board as two prismatic fingers do. For a gap between the pads, the
//! positions of its joints follow from the opening map (docs/method.md#26-linkage-grippers). [`Robot::at_gap`] holds the
//! linkage fixed there and lets each pad slide along y_G, so that everything else sees a gripper with prismatic fingers.

use std::sync::Arc;

use nalgebra::{Unit, Vector3};

use super::{
    faces::Rectangle,
    tree::{Arm, ArmState, Drive, Face, Finger, Gripper, JointKind, Linkage, Pad, Robot},
};
use crate::model::frames::Pose;

/// Number of positions at which the opening map is checked to be monotonic.
const SAMPLES: usize = 33;

/// Steps of the bisection of the opening map: rounding of a range of 1 rad.
const BISECTIONS: usize = 52;

/// Links that move as one keep their place to this, m and rad: a tenth of a millimetre, the rounding of published lengths, and
/// what turns a pad of 10 cm by as much.
const AS_ONE: f64 = 1e-4;

/// The largest angle by which a pad may turn over the opening, rad: two degrees, as the flatness of a rubber pad allows.
const PARALLEL_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;

impl Linkage {
    /// The linkage between a palm and two pads of one or more links each. `rectangle` is where the pads are at the narrowest
    /// opening; without it all shapes of a pad that face the other one are its face.
    ///
    /// # Errors
    /// Why the mechanism is not equivalent to a parallel jaw.
    pub fn new(
        robot: &Robot,
        [frame, palm]: [usize; 2],
        pads: [Vec<usize>; 2],
        rectangle: Option<[[f64; 2]; 2]>,
    ) -> Result<Self, String> {
        let drives = drives(robot, palm, [pads[0][0], pads[1][0]])?;
        let mut own = Vec::new();
        for pad in &pads {
            let mut carriers = Vec::new();
            for &link in pad {
                carriers.push(chain(robot, link, palm)?[0]);
            }
            // Parents come before children.
            carriers.sort_unstable_by_key(|&joint| robot.joints[joint].child_link);
            carriers.dedup();
            own.push(carriers);
        }
        let carriers = [own[0].remove(0), own[1].remove(0)];
        let [Some(second), Some(first)] = [own.pop(), own.pop()] else { return Err("found no pads".into()) };
        let faces = pads.each_ref().map(|links| Face::of_links(robot, links));
        let mut linkage = Self { drives, pads, carriers, others: [first, second], faces, sides: [1.0, -1.0] };
        linkage.orient(robot, frame)?;
        linkage.narrow_faces(robot, frame, rectangle.as_ref());
        linkage.check_pads(robot)?;
        Ok(linkage)
    }

    /// Leaves the shapes that may touch the board.
    fn narrow_faces(&mut self, robot: &Robot, frame: usize, rectangle: Option<&Rectangle>) {
        let x_wl = robot.link_poses(&self.positions(robot, if rectangle.is_some() { 0.0 } else { 0.5 }));
        let x_gw = x_wl[frame].inverse();
        self.faces = match rectangle {
            Some(rectangle) => self.faces.each_ref().map(|face| face.across(robot, &x_wl, &x_gw, rectangle)),
            None => Face::facing(&self.faces, robot, &x_wl, &x_gw),
        };
    }

    /// Checks that the links of each pad move as one.
    fn check_pads(&self, robot: &Robot) -> Result<(), String> {
        for (pad, links) in self.pads.iter().enumerate() {
            if let Some(&loose) = links.iter().find(|&&link| !self.moves_with(robot, pad, link)) {
                let [loose, first] = [loose, links[0]].map(|link| robot.links[link].name.as_str());
                return Err(format!(
                    "found {loose}, which moves against {first} as the gripper opens, expected links of a pad that move as one"
                ));
            }
        }
        Ok(())
    }

    /// True if a link keeps its pose relative to a pad as the gripper opens.
    #[must_use]
    pub fn moves_with(&self, robot: &Robot, pad: usize, link: usize) -> bool {
        let relative = |share: f64| {
            let x_wl = robot.link_poses(&self.positions(robot, share));
            x_wl[self.pads[pad][0]].inverse() * x_wl[link]
        };
        let start = relative(0.0);
        let stays = |here: Pose| {
            let off_m = (here.translation.vector - start.translation.vector).norm();
            off_m < AS_ONE && here.rotation.angle_to(&start.rotation) < AS_ONE
        };
        shares().all(|share| stays(relative(share)))
    }

    /// The direction in which two pads of one drive move apart, in the frame of W; `None` if there are two drives.
    #[must_use]
    pub fn opening_w(robot: &Robot, palm: usize, pad_links: [usize; 2]) -> Option<Vector3<f64>> {
        let drives = drives(robot, palm, pad_links).ok()?;
        let [Drive { joint, closed, open }] = drives[..] else { return None };
        let between = |position: f64| {
            let mut positions = robot.positions(&[] as &[ArmState]);
            positions[joint] = position;
            robot.follow(&mut positions);
            let x_wl = robot.link_poses(&positions);
            x_wl[pad_links[0]].translation.vector - x_wl[pad_links[1]].translation.vector
        };
        (between(open) - between(closed)).try_normalize(AS_ONE)
    }

    /// Finds the sides of the pads and which end of each drive's range is open.
    fn orient(&mut self, robot: &Robot, frame: usize) -> Result<(), String> {
        let x_wl = robot.link_poses(&self.positions(robot, 0.5));
        let y_m = [0, 1].map(|pad| self.faces[pad].mean_y(robot, &x_wl, &x_wl[frame].inverse()));
        self.sides = y_m.map(f64::signum);
        if self.sides[0] == self.sides[1] {
            return Err("found both pads on one side of y_G = 0, expected one on either side".into());
        }
        for drive in 0..self.drives.len() {
            let gap_m = |linkage: &Self| linkage.gap_m(robot, frame, 1.0) - linkage.gap_m(robot, frame, 0.0);
            let swapped = {
                let mut swapped = self.clone();
                let Drive { closed, open, .. } = swapped.drives[drive];
                (swapped.drives[drive].closed, swapped.drives[drive].open) = (open, closed);
                swapped
            };
            if gap_m(&swapped) > gap_m(self) {
                *self = swapped;
            }
        }
        Ok(())
    }

    /// The pads' gaps fully closed and fully open, m.
    ///
    /// # Errors
    /// If the gap does not grow all the way or the pads turn.
    pub fn range_m(&self, robot: &Robot, frame: usize) -> Result<[f64; 2], String> {
        let gaps_m: Vec<f64> = shares().map(|share| self.gap_m(robot, frame, share)).collect();
        if gaps_m.windows(2).any(|pair| pair[1] <= pair[0]) {
            return Err(
                "found pads whose gap does not grow over the whole range of the joint, expected an opening map".into(),
            );
        }
        let middle = self.x_gl(robot, frame, 0.5);
        let turned = |share: f64| {
            let here = self.x_gl(robot, frame, share);
            [0, 1].map(|pad| here[pad].rotation.angle_to(&middle[pad].rotation)).into_iter().fold(0.0, f64::max)
        };
        let turn_rad = shares().map(turned).fold(0.0, f64::max);
        if turn_rad > PARALLEL_RAD {
            return Err(format!(
                "found pads that turn by {:.0} degrees as the gripper opens, expected at most {:.0}: only parallel pads lie flat \
                 on a board",
                turn_rad.to_degrees(),
                PARALLEL_RAD.to_degrees()
            ));
        }
        Ok([gaps_m[0], gaps_m[SAMPLES - 1]])
    }

    /// Positions of all joints with the arms at rest and the drives at a share of their way from closed to open.
    fn positions(&self, robot: &Robot, share: f64) -> Vec<f64> {
        let mut positions = robot.positions(&[] as &[ArmState]);
        for Drive { joint, closed, open } in &self.drives {
            positions[*joint] = closed + share * (open - closed);
        }
        robot.follow(&mut positions);
        positions
    }

    /// Poses of the pads' first links in G.
    fn x_gl(&self, robot: &Robot, frame: usize, share: f64) -> [Pose; 2] {
        let x_wl = robot.link_poses(&self.positions(robot, share));
        self.pads.each_ref().map(|links| x_wl[frame].inverse() * x_wl[links[0]])
    }

    /// Poses of the pads' first links in G at this gap between the pads, m; in the order of the links given to [`Linkage::new`].
    #[must_use]
    pub fn pad_poses_g(&self, robot: &Robot, frame: usize, gap_m: f64) -> [Pose; 2] {
        self.x_gl(robot, frame, self.share_at(robot, frame, gap_m))
    }

    /// Distance of each pad's face from the plane y_G = 0, m.
    fn faces_m(&self, robot: &Robot, frame: usize, share: f64) -> [f64; 2] {
        let x_wl = robot.link_poses(&self.positions(robot, share));
        let x_gw = x_wl[frame].inverse();
        [0, 1].map(|pad| self.faces[pad].nearest_m(robot, &x_wl, &x_gw, self.sides[pad]))
    }

    /// The shapes of each pad that may touch the board, in the order of [`Linkage::new`].
    pub fn faces(&self) -> &[Face; 2] {
        &self.faces
    }

    fn gap_m(&self, robot: &Robot, frame: usize, share: f64) -> f64 {
        self.faces_m(robot, frame, share).iter().sum()
    }

    /// The share of the way from closed to open at which the pads have this gap; 0 or 1 for gaps out of range.
    fn share_at(&self, robot: &Robot, frame: usize, gap_m: f64) -> f64 {
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..BISECTIONS {
            let middle = (low + high) / 2.0;
            if self.gap_m(robot, frame, middle) < gap_m { low = middle } else { high = middle }
        }
        (low + high) / 2.0
    }

    /// True for the drives and for the joints that follow them.
    fn drives(&self, robot: &Robot, joint: usize) -> bool {
        let leads = |joint: usize| self.drives.iter().any(|drive| drive.joint == joint);
        leads(joint) || robot.joints[joint].mimic.is_some_and(|mimic| leads(mimic.leader))
    }

    /// Replaces the linkage by two sliding pads at this gap.
    fn hold_at(&self, robot: &mut Robot, gripper: &Gripper, gap_m: f64) -> [Finger; 2] {
        let frame = gripper.frame_link;
        let share = self.share_at(robot, frame, gap_m);
        let positions = self.positions(robot, share);
        let x_wl = robot.link_poses(&positions);
        let half_m = self.faces_m(robot, frame, share);
        let moved_m = self.shift_m(robot, gripper, share);
        let driven: Vec<usize> = (0..robot.joints.len()).filter(|&joint| self.drives(robot, joint)).collect();
        for index in driven {
            let joint = &mut robot.joints[index];
            joint.x_pj = joint.x_pc(positions[index]);
            (joint.kind, joint.mimic) = (JointKind::Fixed, None);
            (joint.lower, joint.upper, joint.rest) = (0.0, 0.0, 0.0);
        }
        for (carrier, others) in self.carriers.iter().zip(&self.others) {
            let first = robot.joints[*carrier].child_link;
            for &other in others {
                let joint = &mut robot.joints[other];
                joint.parent_link = first;
                joint.x_pj = x_wl[first].inverse() * x_wl[joint.child_link];
            }
        }
        let [narrow_m, wide_m] = gripper.opening_m;
        [0, 1].map(|pad| {
            let child = robot.joints[self.carriers[pad]].child_link;
            let outward_w = x_wl[frame].rotation * (Vector3::y() * self.sides[pad]);
            let joint = &mut robot.joints[self.carriers[pad]];
            joint.parent_link = gripper.palm_link;
            joint.x_pj = x_wl[gripper.palm_link].inverse() * x_wl[child];
            joint.axis_j = Unit::new_normalize(x_wl[child].rotation.inverse() * outward_w);
            joint.kind = JointKind::Prismatic;
            [joint.lower, joint.upper] = [narrow_m, wide_m].map(|wanted_m| (wanted_m - gap_m) / 2.0);
            joint.rest = 0.0_f64.clamp(joint.lower, joint.upper);
            let given = &gripper.fingers[pad].pad;
            let [x_m, z_m] = given.centre_m;
            let pad_at = Pad {
                link: self.pads[pad][0],
                centre_m: [x_m + moved_m[0], z_m + moved_m[1]],
                offset_m: half_m[pad] + joint.lower,
                ..given.clone()
            };
            Finger {
                joint: self.carriers[pad],
                closed_m: joint.lower,
                opening_sign: 1.0,
                max_travel_m: joint.upper - joint.lower,
                pad: pad_at,
            }
        })
    }

    /// How far the pads have moved along x_G and z_G since the narrowest opening, for which the description has their centre, m.
    fn shift_m(&self, robot: &Robot, gripper: &Gripper, share: f64) -> [f64; 2] {
        let frame = gripper.frame_link;
        let start = self.x_gl(robot, frame, self.share_at(robot, frame, gripper.opening_m[0]));
        let here = self.x_gl(robot, frame, share);
        let moved = |pad: usize| here[pad].translation.vector - start[pad].translation.vector;
        let mean = (moved(0) + moved(1)) / 2.0;
        [mean.x, mean.z]
    }
}

/// The moving joints between a link and one above it, the nearest to the link first; `None` if it is not above.
fn moving_joints(robot: &Robot, mut link: usize, above: usize) -> Option<Vec<usize>> {
    let mut joints = Vec::new();
    while link != above {
        let joint = robot.links[link].parent_joint?;
        if robot.joints[joint].kind != JointKind::Fixed {
            joints.push(joint);
        }
        link = robot.joints[joint].parent_link;
    }
    Some(joints)
}

/// The moving joints between the palm and a link of a pad, the nearest to the link first.
fn chain(robot: &Robot, link: usize, palm: usize) -> Result<Vec<usize>, String> {
    let found = moving_joints(robot, link, palm);
    let found = found.filter(|chain| !chain.is_empty() && !robot.links[link].shapes.is_empty());
    let [link, palm] = [link, palm].map(|link| robot.links[link].name.as_str());
    found.ok_or_else(|| format!("found {link}, expected a link with collision geometry that joints after {palm} move"))
}

/// The positions at which the opening map is checked, as shares of the way from closed to open.
fn shares() -> impl Iterator<Item = f64> {
    (0..SAMPLES).map(|sample| sample as f64 / (SAMPLES - 1) as f64)
}

/// The joints that move two pads, taken to open towards their upper limits.
fn drives(robot: &Robot, palm: usize, pad_links: [usize; 2]) -> Result<Vec<Drive>, String> {
    let chains = [chain(robot, pad_links[0], palm)?, chain(robot, pad_links[1], palm)?];
    let leader = |joint: &usize| robot.joints[*joint].mimic.map_or(*joint, |mimic| mimic.leader);
    let leaders = |chain: &Vec<usize>| {
        let mut leaders: Vec<usize> = chain.iter().map(leader).collect();
        leaders.sort_unstable();
        leaders.dedup();
        leaders
    };
    let [first, second] = [leaders(&chains[0]), leaders(&chains[1])];
    let (all, allowed) =
        if first == second { (first.clone(), 1) } else { ([first.clone(), second.clone()].concat(), 2) };
    let one_each = first.len() == 1 && second.len() == 1;
    if !one_each || all.len() != allowed {
        let names: Vec<&str> = all.iter().map(|&joint| robot.joints[joint].name.as_str()).collect();
        let [one, other] = pad_links.map(|link| robot.links[link].name.as_str());
        let names = names.join(", ");
        return Err(format!("found the joints {names} that move {one} and {other}, expected one, or one for each pad"));
    }
    let drive = |joint: usize| Drive { joint, closed: robot.joints[joint].lower, open: robot.joints[joint].upper };
    Ok(all.into_iter().map(drive).collect())
}

impl Robot {
    /// The links with shapes that the linkage of an arm's gripper moves, but the pads.
    pub fn bars(&self, arm: &Arm) -> Vec<usize> {
        let (Some(original), Some(linkage)) = (&self.with_linkages, &arm.gripper.linkage) else { return Vec::new() };
        let moved = original.nearest_above(|joint| linkage.drives(original, joint).then_some(joint));
        let is_pad = |joint: usize| {
            linkage.carriers.contains(&joint) || linkage.others.iter().flatten().any(|&other| other == joint)
        };
        let is_bar = |link: &usize| moved[*link].is_some_and(|joint| !is_pad(joint));
        (0..self.links.len()).filter(is_bar).filter(|&link| !self.links[link].shapes.is_empty()).collect()
    }

    /// The robot with every linkage gripper as a parallel jaw around this gap between its pads, m. Robots without such
    /// grippers stay as they are.
    #[must_use]
    pub fn at_gap(&self, gap_m: f64) -> Self {
        let Some(original) = &self.with_linkages else { return self.clone() };
        let mut robot = Self::clone(original);
        for arm in 0..robot.arms.len() {
            let gripper = robot.arms[arm].gripper.clone();
            if let Some(linkage) = &gripper.linkage {
                let [narrow_m, wide_m] = gripper.opening_m;
                let fingers = linkage.hold_at(&mut robot, &gripper, gap_m.clamp(narrow_m, wide_m));
                robot.arms[arm].gripper.fingers = fingers.into();
            }
        }
        robot.description.clone_from(&self.description);
        robot.files.clone_from(&self.files);
        robot.with_linkages = Some(Arc::clone(original));
        robot
    }
}
