//! The drawing of a stage: two views, one over the other, with the same scale and axes in all stages.

use std::fmt::Write as _;

use nalgebra::Point3;

use super::scene::{HandMark, StageScene};
use crate::{
    model::{board::BoardShape, polygon::Point},
    report::{
        bodies::ARM_COLOURS,
        hull::Point2,
        projection::{Bounds, Item, Sheet, View},
    },
};

/// Width of a drawing, px.
pub const WIDTH_PX: f64 = 340.0;

/// Margin of a view, px.
const MARGIN_PX: f64 = 8.0;

/// Height of the line with the name of a view, px.
const NAME_PX: f64 = 16.0;

/// Largest scale, px/m, for scenes that are small.
const MOST_PX_PER_M: f64 = 300.0;

/// Length of the scale bar, m.
const BAR_M: f64 = 0.5;

/// Radii of the marks of hands that stay and of those that change their grasp, px.
const MARK_PX: [f64; 2] = [3.2, 4.8];

/// Size of the mark of a corner of the board, as a share of its sides.
const CORNER_SHARE: f64 = 0.2;

/// Least distance of two points of a line, px.
const APART_PX: f64 = 1.0;

/// Length of an arrowhead, px.
const HEAD_PX: f64 = 8.0;

/// Scale and places of the views of all drawings.
pub struct Layout {
    views: [View; 2],
    /// Position of W's origin in each view, px.
    origins_px: [Point2; 2],
    /// The lower edge of each view, px.
    below_px: [f64; 2],
    px_per_m: f64,
}

impl Layout {
    /// The layout in which all stages and the links that stay have their place.
    #[must_use]
    pub fn of(scenes: &[StageScene], still: &[Item], thickness_m: f64) -> Self {
        let views = [View::from_above(), View::from_the_right()];
        let bounds = views.each_ref().map(|view| bounds(view, scenes, still, thickness_m));
        let [width_m, _] = bounds[0].size_m();
        let px_per_m = ((WIDTH_PX - 2.0 * MARGIN_PX) / width_m.max(1e-3)).min(MOST_PX_PER_M);
        let mut top_px = 0.0;
        let mut below_px = [0.0; 2];
        let mut origins_px = [[0.0; 2]; 2];
        for (number, bounds) in bounds.iter().enumerate() {
            let [[left_m, low_m], [right_m, high_m]] = bounds.corners_m;
            let x_px = WIDTH_PX / 2.0 - (left_m + right_m) / 2.0 * px_per_m;
            origins_px[number] = [x_px, top_px + NAME_PX + MARGIN_PX + high_m * px_per_m];
            top_px += NAME_PX + 2.0 * MARGIN_PX + (high_m - low_m) * px_per_m;
            below_px[number] = top_px;
        }
        Self { views, origins_px, below_px, px_per_m }
    }

    /// Height of a drawing, px.
    #[must_use]
    pub fn height_px(&self) -> f64 {
        self.below_px[1]
    }

    /// The views on paper.
    pub fn sheets(&self) -> impl Iterator<Item = Sheet<'_>> {
        let place = |(view, origin_px)| Sheet { view, origin_px, px_per_m: self.px_per_m };
        self.views.iter().zip(self.origins_px).map(place)
    }

    /// What is the same in all drawings: names of the views, the scale and the links that stay.
    #[must_use]
    pub fn still(&self, items: &[Item]) -> String {
        let mut body = String::new();
        for (sheet, top_px) in self.sheets().zip([0.0, self.below_px[0]]) {
            sheet.draw(&mut body, items);
            let _ =
                writeln!(body, "<text class=\"name\" x=\"4\" y=\"{:.1}\">{}</text>", top_px + 12.0, sheet.view.name);
        }
        let (right, left) = (WIDTH_PX - 6.0, WIDTH_PX - 6.0 - BAR_M * self.px_per_m);
        let _ = writeln!(
            body,
            "<path class=\"bar\" d=\"M{left:.1} 5v4H{right:.1}v-4M0 {:.1}h{WIDTH_PX}\"/>",
            self.below_px[0]
        );
        let _ = writeln!(
            body,
            "<text class=\"name\" x=\"{:.1}\" y=\"12\" text-anchor=\"end\">{BAR_M} m</text>",
            left - 4.0
        );
        body
    }

    /// The drawing of a stage without what is the same in all.
    #[must_use]
    pub fn draw(&self, scene: &StageScene, board: &BoardShape) -> String {
        let mut body = String::new();
        for sheet in self.sheets() {
            body.push_str("<g class=\"ghosts\">");
            sheet.draw(&mut body, &scene.ghosts);
            body.push_str("</g>");
            sheet.draw(&mut body, &scene.items);
            sheet.draw(&mut body, &scene.board_before);
            let corner = scene.on_face_w(&corner_m(board), board.thickness_m());
            let _ = writeln!(body, "<polygon class=\"corner\" points=\"{}\"/>", sheet.polyline(&corner));
            path(&mut body, &sheet, scene, board.thickness_m());
            arrow(&mut body, &scene.step_w.iter().map(|p| sheet.px(p)).collect::<Vec<_>>(), "way step");
            scene.hands.iter().for_each(|mark| hand(&mut body, &sheet, scene, mark));
        }
        body
    }
}

/// The extent of all that is drawn in a view.
fn bounds(view: &View, scenes: &[StageScene], still: &[Item], thickness_m: f64) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    let items = scenes.iter().flat_map(StageScene::bodies);
    for (points_w, reach_m) in items.chain(still).map(Item::extent) {
        bounds.include(view, points_w, reach_m);
    }
    for scene in scenes {
        bounds.include(view, &scene.step_w, 0.0);
        scene.hands.iter().for_each(|hand| bounds.include(view, &hand.way_w, 0.0));
        let trails = scene.path.done.iter().chain(&scene.path.now).chain(&scene.path.to_come);
        trails.for_each(|trail| bounds.include(view, &scene.on_face_w(trail, thickness_m), 0.0));
    }
    bounds
}

// Writing to a string does not fail, so the results are ignored.

/// The triangle that marks a corner of the board in all drawings: the second one of its outline, of a box that at +x_O and +y_O.
#[must_use]
pub fn corner_m(board: &BoardShape) -> [Point; 3] {
    let outline = board.outline_m();
    let at = |k: usize| outline[k % outline.len()];
    let towards = |to: Point| [0, 1].map(|axis| at(1)[axis] + CORNER_SHARE * (to[axis] - at(1)[axis]));
    [towards(at(0)), at(1), towards(at(2))]
}

/// The three parts of the path on the board.
fn path(body: &mut String, sheet: &Sheet, scene: &StageScene, thickness_m: f64) {
    let parts = &scene.path;
    for (class, trails) in [("to-come", &parts.to_come), ("done", &parts.done), ("now", &parts.now)] {
        let points = trails.iter().map(|trail| scene.on_face_w(trail, thickness_m));
        let lines = points.map(|points| points.iter().map(|p| sheet.px(p)).collect::<Vec<_>>());
        trails_of(body, class, lines);
    }
}

/// Lines of one class, and dots for lines of one point. Points that cannot be told from the one before are left out.
pub fn trails_of(body: &mut String, class: &str, lines: impl Iterator<Item = Vec<Point2>>) {
    let (mut d, mut dots) = (String::new(), String::new());
    for line in lines {
        if let [[x, y]] = line[..] {
            let _ = write!(dots, "M{x:.1} {y:.1}h.1");
            continue;
        }
        let mut drawn: Option<Point2> = None;
        for (number, &[x, y]) in line.iter().enumerate() {
            let is_apart = drawn.is_none_or(|[a, b]| libm::hypot(x - a, y - b) >= APART_PX);
            if is_apart || number + 1 == line.len() {
                let _ = write!(d, "{}{x:.1} {y:.1}", if drawn.is_none() { 'M' } else { 'L' });
                drawn = Some([x, y]);
            }
        }
    }
    for (kind, d) in [("trail", d), ("trail dot", dots)] {
        if !d.is_empty() {
            let _ = writeln!(body, "<path class=\"{kind} {class}\" d=\"{d}\"/>");
        }
    }
}

/// The mark of a hand where it holds the board, with its way and its old grasp.
fn hand(body: &mut String, sheet: &Sheet, scene: &StageScene, mark: &HandMark) {
    let colour = mark.arm % ARM_COLOURS;
    let way: Vec<_> = mark.way_w.iter().map(|p| sheet.px(p)).collect();
    arrow(body, &way, &format!("way c{colour}"));
    let px = |point_o: &Point3<f64>| sheet.px(&(scene.x_wo * point_o));
    if let Some((before_o, _)) = &mark.before_o {
        let [x, y] = px(before_o);
        let _ = writeln!(body, "<circle class=\"left c{colour}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{}\"/>", MARK_PX[1]);
    }
    let [x, y] = px(&mark.point_o);
    let radius_px = MARK_PX[usize::from(mark.before_o.is_some())];
    let _ = writeln!(body, "<circle class=\"held c{colour}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius_px}\"/>");
}

/// A line through points with an arrowhead at its end; nothing if it is shorter than the head.
pub fn arrow(body: &mut String, points: &[Point2], class: &str) {
    let distance = |a: &Point2, b: &Point2| libm::hypot(a[0] - b[0], a[1] - b[1]);
    let Some(end) = points.last() else { return };
    let Some(from) = points.iter().rev().find(|point| distance(point, end) >= HEAD_PX) else { return };
    trails_of(body, class, std::iter::once(points.to_vec()));
    let length = distance(from, end);
    let (ux, uy) = ((end[0] - from[0]) / length, (end[1] - from[1]) / length);
    let wing = |side: f64| {
        let (x, y) = (end[0] - HEAD_PX * ux + side * uy, end[1] - HEAD_PX * uy - side * ux);
        format!("{x:.1},{y:.1}")
    };
    let (x, y) = (end[0], end[1]);
    let _ = writeln!(
        body,
        "<polygon class=\"head {class}\" points=\"{x:.1},{y:.1} {} {}\"/>",
        wing(HEAD_PX / 2.0),
        wing(-HEAD_PX / 2.0)
    );
}
