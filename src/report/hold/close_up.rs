//! One hand at the board, seen onto the face of the board and along its edge: the pads where they were at the hand-over and where
//! they are, and their forces. Small motions are drawn larger.

use std::fmt::Write as _;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use crate::{
    model::{
        board::PlacedObject,
        frames::Pose,
        trace::{ArmSample, PadSample, Sample, Trace},
    },
    report::{
        bodies::{self, ARM_COLOURS},
        projection::{Item, Sheet, View},
    },
    robot::{Gripper, Robot},
};

/// Width and height of a view, px, and of what it shows, m.
pub const SIZE_PX: f64 = 300.0;
const SHOWN_M: f64 = 0.13;

/// Motions of pads are drawn at most this long, m, and rotations this large, rad, by these factors.
const DRAWN_M: f64 = 0.008;
const DRAWN_RAD: f64 = 0.5;
const FACTORS: [f64; 6] = [100.0, 50.0, 20.0, 10.0, 5.0, 2.0];

/// Motions and rotations that are not seen even by the largest factor are drawn as they are: of half a pixel, and of half a degree.
const SEEN_M: f64 = 0.5 * SHOWN_M / SIZE_PX / FACTORS[0];
const SEEN_RAD: f64 = 0.5_f64.to_radians() / FACTORS[0];

/// Length of the scale's bar, m.
const SCALE_M: f64 = 0.02;

/// Thickness of a drawn pad, m.
const PAD_M: f64 = 0.004;

/// Length of the arrow of the largest force, m.
const ARROW_M: f64 = 0.03;

/// Half the sides of a gripper without pads, as drawn, along x_G and z_G, m.
const HALF_GRIPPER_M: [f64; 2] = [0.015, 0.010];

/// A part of the hand that touches the board.
struct Part {
    /// Where it was, in O, m.
    before_o: Point3<f64>,
    /// Where it is, in O, m.
    now_o: Point3<f64>,
    /// Its corners about its place, in G axes, m.
    corners_g: Vec<Vector3<f64>>,
    /// Its force on the board in O, N; 0 without contact.
    force_o_n: Vector3<f64>,
}

/// A hand at two moments.
pub struct CloseUp<'a> {
    object: &'a PlacedObject,
    parts: Vec<Part>,
    /// Orientation of G in O at the hand-over, and the rotation since.
    r_og: UnitQuaternion<f64>,
    turned_o: UnitQuaternion<f64>,
    /// Motion of the hand on the board since the hand-over, mm.
    pub slip_mm: f64,
    /// By what motions are multiplied in the drawing.
    pub factor: f64,
    /// Number of the arm in the robot.
    arm: usize,
}

impl<'a> CloseUp<'a> {
    /// The hand of the arm with this index in the trace, at the hand-over `before` and `now`; `None` if the robot has no such arm.
    #[must_use]
    pub fn new(
        object: &'a PlacedObject,
        robot: &Robot,
        trace: &Trace,
        index: usize,
        [before, now]: [&Sample; 2],
    ) -> Option<Self> {
        let arm = robot.arm_index(&trace.arms.get(index)?.name)?;
        let [hand_before, hand_now] = [before.arms.get(index)?, now.arms.get(index)?];
        let parts = parts(&robot.arms[arm].gripper, object, [before, now], [hand_before, hand_now]);
        let turned_o = hand_now.x_oc.rotation * hand_before.x_oc.rotation.inverse();
        let moved_m = |part: &Part| (part.now_o - part.before_o).norm();
        let most_m = parts.iter().map(moved_m).fold(0.0, f64::max);
        let is_seen = most_m > SEEN_M || turned_o.angle() > SEEN_RAD;
        let is_small = |factor: &f64| is_seen && factor * most_m <= DRAWN_M && factor * turned_o.angle() <= DRAWN_RAD;
        let moved = hand_now.x_oc.translation.vector - hand_before.x_oc.translation.vector;
        Some(Self {
            object,
            parts,
            r_og: hand_before.x_oc.rotation,
            turned_o,
            slip_mm: 1e3 * moved.norm(),
            factor: FACTORS.into_iter().find(is_small).unwrap_or(1.0),
            arm,
        })
    }

    /// Rotation of the hand on the board since the hand-over, degrees.
    #[must_use]
    pub fn slip_deg(&self) -> f64 {
        self.turned_o.angle().to_degrees()
    }

    /// The magnitudes of the forces, N.
    pub fn forces_n(&self) -> impl Iterator<Item = f64> {
        self.parts.iter().map(|part| part.force_o_n.norm())
    }

    /// The two views as SVG, each with its name.
    #[must_use]
    pub fn svg(&self) -> [String; 2] {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| self.r_og * axis);
        // The hand comes from below. Both views are in O.
        let views = [
            View { name: "onto the face of the board", axes_w: [x, z, -y] },
            View { name: "along the edge of the board", axes_w: [y, z, x] },
        ];
        views.map(|view| self.view(&view))
    }

    fn view(&self, view: &View) -> String {
        let px_per_m = SIZE_PX / SHOWN_M;
        let sum: Vector3<f64> = self.parts.iter().map(|part| part.before_o.coords).sum();
        let [right, up] = view.project(&Point3::from(sum / self.parts.len().max(1) as f64));
        let origin_px = [SIZE_PX / 2.0 - right * px_per_m, SIZE_PX / 2.0 + up * px_per_m];
        let sheet = Sheet { view, origin_px, px_per_m };
        let mut body = String::new();
        let mut items = vec![bodies::board(self.object, &Isometry3::identity(), "class=\"board\"".to_owned())];
        let paint = format!("class=\"pad hand{}\"", self.arm % ARM_COLOURS);
        items.extend(self.parts.iter().map(|part| self.item(part, self.factor, paint.clone())));
        sheet.draw(&mut body, &items);
        let before = |part| self.item(part, 0.0, "class=\"ghost\"".to_owned());
        sheet.draw(&mut body, &self.parts.iter().map(before).collect::<Vec<_>>());
        self.forces(&mut body, &sheet);
        let name = view.name;
        format!(
            "<svg class=\"scene near\" viewBox=\"0 0 {SIZE_PX} {SIZE_PX}\" role=\"img\" aria-label=\"hand, {name}\">{body}\
             <text class=\"name\" x=\"6\" y=\"14\">{name}</text>{}</svg>\n",
            scale_bar()
        )
    }

    /// Where a part is drawn, with its motion multiplied.
    fn place_o(&self, part: &Part, factor: f64) -> Pose {
        let p_o = part.before_o + (part.now_o - part.before_o) * factor;
        let turned_o = UnitQuaternion::from_scaled_axis(self.turned_o.scaled_axis() * factor);
        Isometry3::from_parts(p_o.into(), turned_o * self.r_og)
    }

    fn item(&self, part: &Part, factor: f64, paint: String) -> Item {
        let x_op = self.place_o(part, factor);
        Item::Hull(part.corners_g.iter().map(|corner| x_op * Point3::from(*corner)).collect(), paint)
    }

    /// The forces as arrows that end at their pads.
    fn forces(&self, body: &mut String, sheet: &Sheet) {
        let most_n = self.forces_n().fold(0.0, f64::max);
        if most_n <= 0.0 {
            return;
        }
        let paint = ["class=\"force\"", "class=\"force-head\""].map(str::to_owned);
        for part in self.parts.iter().filter(|part| part.force_o_n.norm() > 0.0) {
            let head_o = Point3::from(self.place_o(part, self.factor).translation.vector);
            let tail_o = head_o - part.force_o_n * (ARROW_M / most_n);
            sheet.arrow(body, [&tail_o, &head_o], &paint);
            let ([x1, y1], [x2, _]) = (sheet.px(&tail_o), sheet.px(&head_o));
            let (x, anchor) = if x1 < x2 { (x1, "end") } else { (x1, "start") };
            // Writing to a string does not fail, so the result is ignored.
            let _ = writeln!(
                body,
                "<text class=\"force-size\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{:.1} N</text>",
                x.clamp(40.0, SIZE_PX - 40.0),
                (y1 - 5.0).clamp(26.0, SIZE_PX - 6.0),
                part.force_o_n.norm()
            );
        }
    }
}

/// The bar of the scale, with its length.
fn scale_bar() -> String {
    let (left, y, length) = (10.0, SIZE_PX - 10.0, SCALE_M * SIZE_PX / SHOWN_M);
    let (right, mm) = (left + length, 1e3 * SCALE_M);
    format!(
        "<path class=\"scale\" d=\"M{left} {} v8 M{left} {y} H{right:.1} m0 -4 v8\"/><text class=\"scale\" x=\"{:.1}\" y=\"{}\">\
         {mm:.0} mm</text>",
        y - 4.0,
        right + 6.0,
        y + 4.0
    )
}

/// The pads, or a gripper without pads as one part.
fn parts(
    gripper: &Gripper,
    object: &PlacedObject,
    [before, now]: [&Sample; 2],
    [hand_before, hand_now]: [&ArmSample; 2],
) -> Vec<Part> {
    if hand_now.pads.is_empty() || gripper.fingers.is_empty() {
        let force_g_n = hand_now.grip_wrench_g.unwrap_or_default().force_n;
        return vec![Part {
            before_o: Point3::from(hand_before.x_oc.translation.vector),
            now_o: Point3::from(hand_now.x_oc.translation.vector),
            corners_g: corners_of_gripper(gripper, object.size_m[2]),
            force_o_n: hand_now.x_oc.rotation * force_g_n,
        }];
    }
    let pads = hand_before.pads.iter().zip(&hand_now.pads).enumerate();
    let part = |(number, (pad_before, pad_now)): (usize, (&PadSample, _))| {
        let pad_now: &PadSample = pad_now;
        let in_o = |sample: &Sample, p_w: Vector3<f64>| sample.x_wo.inverse() * Point3::from(p_w);
        let [x_m, z_m] = gripper.fingers[number % gripper.fingers.len()].pad.size_m;
        // The first finger is on the side of +y_G. A pad is drawn on its side of the face of the board.
        let side = if number == 0 { PAD_M } else { -PAD_M };
        Part {
            before_o: in_o(before, pad_before.p_wp_m),
            now_o: in_o(now, pad_now.p_wp_m),
            corners_g: box_corners(
                [-x_m / 2.0, 0.0_f64.min(side), -z_m / 2.0],
                [x_m / 2.0, 0.0_f64.max(side), z_m / 2.0],
            ),
            force_o_n: now.x_wo.rotation.inverse() * pad_now.wrench_w.force_n,
        }
    };
    pads.map(part).collect()
}

/// A gripper with measured limits: a block around the edge of the board, or the lip of a cup.
fn corners_of_gripper(gripper: &Gripper, thickness_m: f64) -> Vec<Vector3<f64>> {
    if let Some(cup) = &gripper.cup {
        return box_corners([-cup.radius_m, -cup.radius_m, -PAD_M], [cup.radius_m, cup.radius_m, 0.0]);
    }
    let [x_m, z_m] = HALF_GRIPPER_M;
    let y_m = thickness_m / 2.0 + PAD_M;
    box_corners([-x_m, -y_m, -z_m], [x_m, y_m, z_m])
}

fn box_corners(low: [f64; 3], high: [f64; 3]) -> Vec<Vector3<f64>> {
    let pick = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
    (0..8).map(|corner| Vector3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2))).collect()
}
