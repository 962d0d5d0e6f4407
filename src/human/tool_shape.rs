//! The shape of the tool in the person's hand, for recordings and pictures: a cordless drill, a knife, or two rods for an
//! arbitrary wrench. Collisions use the capsule of [`super::shape`].
//!
//! All parts extend along an axis through the tip from one convex section to another: of a drill along z_T, of a knife along
//! its blade. Sections are given in (u, v) coordinates about this axis. Where the palm is in T decides the place of the grip,
//! so the shapes fit every tool of a scenario. The sizes are assumed: those of common tools.

use nalgebra::{Point3, Vector3};

use super::{Human, ranges::ArmAngles};
use crate::model::{
    frames::Pose,
    operation::OperationKind,
    tool_part::{ToolMaterial, ToolPart},
};

/// Corners of a polygon that represents a circle.
const ROUND: u32 = 16;

/// Least distance of the palm behind the tip along the tool that a shape is made for, m.
const MIN_LENGTH_M: f64 = 0.03;

/// Half the thickness of a rod, m.
const ROD_M: f64 = 0.008;

/// Corners of a section in (u, v), m.
type Section = Vec<[f64; 2]>;

/// Where the hand holds the tool.
struct Hold {
    /// Pose of the tool tip in W.
    x_wt: Pose,
    /// Centre of the palm in T, m.
    palm_t: Vector3<f64>,
    /// Direction from the fist's side of the little finger to that of the thumb, in T.
    thumb_t: Vector3<f64>,
}

/// Frame of the sections of a tool, with its origin at the tip.
struct Sections<'a> {
    x_wt: &'a Pose,
    /// Axis of the first coordinate, in T.
    u_t: Vector3<f64>,
    /// Axis of the second coordinate, in T.
    v_t: Vector3<f64>,
    /// Axis along the tool towards the tip, in T.
    axis_t: Vector3<f64>,
}

impl Sections<'_> {
    /// The part between two sections, each with its coordinate along the axis, m.
    fn part(&self, material: ToolMaterial, ends: [(f64, Section); 2]) -> ToolPart {
        let corner_w = |along_m, [u_m, v_m]: [f64; 2]| {
            self.x_wt * Point3::from(self.u_t * u_m + self.v_t * v_m + self.axis_t * along_m)
        };
        let end_w = |(along_m, section): (f64, Section)| section.into_iter().map(|uv| corner_w(along_m, uv)).collect();
        ToolPart { material, ends_w: ends.map(end_w) }
    }

    /// The part with one section over a range along the axis, m.
    fn straight(&self, material: ToolMaterial, [from_m, to_m]: [f64; 2], section: Section) -> ToolPart {
        self.part(material, [(from_m, section.clone()), (to_m, section)])
    }
}

impl Hold {
    /// Sections along an axis, with u along a direction without its part along the axis.
    fn sections(&self, axis_t: Vector3<f64>, direction_t: &Vector3<f64>) -> Sections<'_> {
        let across = direction_t - axis_t * axis_t.dot(direction_t);
        // Along the axis itself any direction will do: the tool is symmetric then.
        let u_t = across.try_normalize(1e-9).unwrap_or_else(|| axis_t.cross(&Vector3::y()).normalize());
        Sections { x_wt: &self.x_wt, u_t, v_t: axis_t.cross(&u_t), axis_t }
    }

    /// Distance of the palm behind the tip along an axis, m.
    fn length_m(&self, axis_t: &Vector3<f64>) -> f64 {
        (-self.palm_t.dot(axis_t)).max(MIN_LENGTH_M)
    }

    /// A cordless drill: bit, chuck, body, pistol grip and battery. The body is on the side of the thumb.
    fn drill(&self) -> Vec<ToolPart> {
        let axis_t = Vector3::z();
        let length_m = self.length_m(&axis_t);
        let up_t = if self.palm_t.dot(&self.thumb_t) > 0.0 { -self.thumb_t } else { self.thumb_t };
        let sections = self.sections(axis_t, &up_t);
        let (bit_m, chuck_m) = (-0.35 * length_m, -0.55 * length_m);
        let grip_bottom_m = sections.u_t.dot(&self.palm_t) - 0.045;
        let chuck = [(chuck_m, circle(0.021)), (bit_m, circle(0.011))];
        let grip = rectangle([grip_bottom_m, 0.0], [-0.017, 0.017]);
        let battery = rectangle([grip_bottom_m - 0.05, grip_bottom_m], [-0.035, 0.035]);
        vec![
            sections.straight(ToolMaterial::Steel, [bit_m, 0.0], circle(0.004)),
            sections.part(ToolMaterial::Steel, chuck),
            sections.straight(ToolMaterial::Housing, [-length_m - 0.05, chuck_m], circle(0.03)),
            sections.straight(ToolMaterial::Grip, [-length_m - 0.022, -length_m + 0.022], grip),
            sections.straight(ToolMaterial::Grip, [-length_m - 0.045, -length_m + 0.065], battery),
        ]
    }

    /// A knife: handle and thin blade along the line from the palm to the tip, in the plane of x_T and z_T. The edge ends at
    /// the tip and is on the side of x_T, the cutting direction.
    fn knife(&self) -> Vec<ToolPart> {
        let in_plane = Vector3::new(-self.palm_t.x, 0.0, -self.palm_t.z);
        let axis_t = in_plane.try_normalize(1e-9).unwrap_or_else(Vector3::z);
        let length_m = self.length_m(&axis_t);
        let sections = self.sections(axis_t, &Vector3::x());
        let width_m: f64 = 0.02;
        let blade = |width_m: f64| rectangle([-width_m, 0.0], [-0.0015, 0.0015]);
        let handle = |half_m| oval([-width_m / 2.0, 0.0], half_m);
        let (point_m, heel_m, front_m) = (-width_m.min(0.4 * length_m), -0.6 * length_m, -0.75 * length_m);
        vec![
            sections.part(ToolMaterial::Steel, [(point_m, blade(width_m)), (0.0, blade(0.001))]),
            sections.straight(ToolMaterial::Steel, [heel_m, point_m], blade(width_m)),
            sections.part(ToolMaterial::Housing, [(front_m, handle([0.015, 0.011])), (heel_m, handle([0.012, 0.006]))]),
            sections.straight(ToolMaterial::Grip, [-length_m - 0.065, front_m], handle([0.015, 0.011])),
        ]
    }

    /// Two rods: from the tip along z_T to the height of the palm, and from there to the palm.
    fn rods(&self) -> Vec<ToolPart> {
        let axis_t = Vector3::z();
        let length_m = self.length_m(&axis_t);
        let sections = self.sections(axis_t, &self.palm_t);
        let across = rectangle([-ROD_M, sections.u_t.dot(&self.palm_t) + ROD_M], [-ROD_M, ROD_M]);
        vec![
            sections.straight(ToolMaterial::Housing, [-length_m, 0.0], circle(ROD_M)),
            sections.straight(ToolMaterial::Housing, [-length_m - ROD_M, -length_m + ROD_M], across),
        ]
    }
}

impl Human {
    /// The parts of the tool for an operation of a kind.
    #[must_use]
    pub fn tool_parts_w(&self, x_wb: &Pose, q_rad: &ArmAngles, kind: OperationKind) -> Vec<ToolPart> {
        let x_th = self.x_ht().inverse();
        let hold = Hold {
            x_wt: x_wb * self.tool_pose_b(q_rad),
            // The palm is in the hand's plane of symmetry and x_H points to the thumb: the same for both hands.
            palm_t: (x_th * Point3::from(self.body.palm_h)).coords,
            thumb_t: x_th.rotation * Vector3::x(),
        };
        match kind {
            OperationKind::Drill => hold.drill(),
            OperationKind::Cut => hold.knife(),
            OperationKind::Wrench => hold.rods(),
        }
    }
}

fn rectangle([u0, u1]: [f64; 2], [v0, v1]: [f64; 2]) -> Section {
    vec![[u0, v0], [u1, v0], [u1, v1], [u0, v1]]
}

/// An ellipse with its half axes along u and v, m.
fn oval(centre: [f64; 2], half_m: [f64; 2]) -> Section {
    let corner = |k: u32| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / f64::from(ROUND));
        [centre[0] + half_m[0] * cos, centre[1] + half_m[1] * sin]
    };
    (0..ROUND).map(corner).collect()
}

fn circle(radius_m: f64) -> Section {
    oval([0.0, 0.0], [radius_m; 2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        human::{default_tool, standing_pose_w, testing::average_man},
        model::scenario::{Hand, Person},
    };

    const KINDS: [OperationKind; 3] = [OperationKind::Drill, OperationKind::Cut, OperationKind::Wrench];
    const Q_RAD: ArmAngles = [0.6, 0.3, 0.2, 1.2, 0.4, 0.2, 0.1];

    fn worker_and_poses(hand: Hand, kind: OperationKind) -> (Human, Pose, Pose) {
        let human = Human::new(&Person { hand, ..average_man() }, &default_tool(kind)).unwrap();
        let x_wb = standing_pose_w(1.0, 0.2, 2.0, -0.9);
        let x_wt = x_wb * human.tool_pose_b(&Q_RAD);
        (human, x_wb, x_wt)
    }

    /// Corners of parts in T, m.
    fn corners_t<'a>(parts: impl Iterator<Item = &'a ToolPart>, x_wt: &Pose) -> Vec<Point3<f64>> {
        parts.flat_map(|part| part.ends_w.iter().flatten()).map(|corner_w| x_wt.inverse() * corner_w).collect()
    }

    #[test]
    fn every_tool_ends_at_its_tip_and_no_part_is_beyond_it() {
        for hand in [Hand::Right, Hand::Left] {
            for kind in KINDS {
                let (human, x_wb, x_wt) = worker_and_poses(hand, kind);
                let corners = corners_t(human.tool_parts_w(&x_wb, &Q_RAD, kind).iter(), &x_wt);
                // Rounding of a product of poses; the rods are the thickest at the tip.
                assert!(corners.iter().all(|corner| corner.z < 1e-14));
                let tip = corners.iter().filter(|corner| corner.z > -1e-14).collect::<Vec<_>>();
                assert!(!tip.is_empty() && tip.iter().all(|corner| corner.coords.norm() < 1.01 * ROD_M), "{kind}");
            }
        }
    }

    #[test]
    fn the_grip_is_in_the_hand() {
        for hand in [Hand::Right, Hand::Left] {
            for kind in KINDS {
                let (human, x_wb, _) = worker_and_poses(hand, kind);
                let parts = human.tool_parts_w(&x_wb, &Q_RAD, kind);
                let palm_w = human.capsules_w(&x_wb, &Q_RAD)[7].p1_w;
                let nearest_m = parts
                    .iter()
                    .flat_map(|part| part.ends_w.iter().flatten())
                    .map(|corner_w| (corner_w - palm_w).norm())
                    .fold(f64::INFINITY, f64::min);
                // The drill's grip touches the palm from outside, and its corners are at its ends.
                assert!(nearest_m < 0.08, "{kind}: {nearest_m}");
            }
        }
    }

    #[test]
    fn the_body_of_the_drill_is_on_the_side_of_the_thumb_and_the_battery_on_the_other() {
        for hand in [Hand::Right, Hand::Left] {
            let (human, x_wb, x_wt) = worker_and_poses(hand, OperationKind::Drill);
            let parts = human.tool_parts_w(&x_wb, &Q_RAD, OperationKind::Drill);
            let thumb_h_m = |part: &ToolPart| {
                let corners_t = corners_t(std::iter::once(part), &x_wt);
                corners_t.iter().map(|corner_t| (human.x_ht() * corner_t).x).sum::<f64>() / corners_t.len() as f64
            };
            let (body, battery) = (&parts[2], &parts[4]);
            assert!(thumb_h_m(body) > 0.04 && thumb_h_m(battery) < -0.04);
        }
    }

    #[test]
    fn the_blade_is_thin_along_y_and_its_edge_looks_along_x() {
        let (human, x_wb, x_wt) = worker_and_poses(Hand::Right, OperationKind::Cut);
        let parts = human.tool_parts_w(&x_wb, &Q_RAD, OperationKind::Cut);
        for part in parts.iter().filter(|part| part.material == ToolMaterial::Steel) {
            let corners_t = corners_t(std::iter::once(part), &x_wt);
            assert!(corners_t.iter().all(|corner| corner.y.abs() < 0.002));
            // Of each end two corners are on the back and two on the edge.
            for end_t in corners_t.chunks(4) {
                assert!(end_t[1].x > end_t[0].x && end_t[2].x > end_t[3].x);
            }
        }
    }
}
