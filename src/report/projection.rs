//! Bodies of a scene in W as SVG: parallel projections, which bodies are drawn over which, and what a view extends over.
//!
//! Bodies are drawn in the order of their centres, farthest first (painter's algorithm); bodies that overlap may be drawn in the
//! wrong order. Colours are SVG attributes or CSS classes of the caller.

use std::fmt::Write as _;

use nalgebra::{Point3, Vector3};

use super::hull::{Point2, convex_hull};

/// A direction of view.
pub struct View {
    /// Its name in pictures.
    pub name: &'static str,
    /// Directions in W: to the right, upward, and towards the viewer.
    pub axes_w: [Vector3<f64>; 3],
}

impl View {
    /// From above: x_W to the right, y_W upward.
    #[must_use]
    pub fn from_above() -> Self {
        Self { name: "from above", axes_w: [Vector3::x(), Vector3::y(), Vector3::z()] }
    }

    /// From the robot's right: x_W to the right, z_W upward.
    #[must_use]
    pub fn from_the_right() -> Self {
        Self { name: "from the robot's right", axes_w: [Vector3::x(), Vector3::z(), -Vector3::y()] }
    }

    /// True if the viewer is above the scene.
    #[must_use]
    pub fn is_from_above(&self) -> bool {
        self.axes_w[2] == Vector3::z()
    }

    /// The projection of a point, m: to the right and upward.
    #[must_use]
    pub fn project(&self, p_w: &Point3<f64>) -> Point2 {
        [self.axes_w[0].dot(&p_w.coords), self.axes_w[1].dot(&p_w.coords)]
    }
}

/// A body of the scene, in W.
#[derive(Clone, Debug)]
pub enum Item {
    /// A plate: the convex hull of points without holes, whose corners are in its middle plane, with SVG attributes.
    Pierced(Vec<Point3<f64>>, Vec<Vec<Point3<f64>>>, String),
    /// The convex hull of points, with SVG attributes.
    Hull(Vec<Point3<f64>>, String),
    /// A capsule: ends, radius, SVG attributes of outline and fill.
    Capsule([Point3<f64>; 2], f64, [String; 2]),
}

impl Item {
    /// Its points, and how far it reaches beyond them, m.
    #[must_use]
    pub fn extent(&self) -> (&[Point3<f64>], f64) {
        match self {
            Self::Hull(points, _) | Self::Pierced(points, ..) => (points, 0.0),
            Self::Capsule(ends, radius_m, _) => (ends, *radius_m),
        }
    }

    fn centre(&self) -> Vector3<f64> {
        let (points, _) = self.extent();
        points.iter().map(|point| point.coords).sum::<Vector3<f64>>() / points.len().max(1) as f64
    }
}

/// A rectangle in the plane of a view, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower left and upper right corner.
    pub corners_m: [Point2; 2],
}

impl Bounds {
    /// Of nothing.
    pub const EMPTY: Self = Self { corners_m: [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]] };

    /// With these points and what is within a distance of them.
    pub fn include(&mut self, view: &View, points_w: &[Point3<f64>], reach_m: f64) {
        let [low, high] = &mut self.corners_m;
        for point in points_w.iter().map(|point| view.project(point)) {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis] - reach_m);
                high[axis] = high[axis].max(point[axis] + reach_m);
            }
        }
    }

    /// Width and height, m.
    #[must_use]
    pub fn size_m(&self) -> Point2 {
        let [low, high] = self.corners_m;
        [high[0] - low[0], high[1] - low[1]]
    }
}

/// A view on paper.
pub struct Sheet<'a> {
    /// The view.
    pub view: &'a View,
    /// Position of W's origin, px.
    pub origin_px: Point2,
    /// Scale, px/m.
    pub px_per_m: f64,
}

impl Sheet<'_> {
    /// Where a point is drawn, px: to the right and downward.
    #[must_use]
    pub fn px(&self, p_w: &Point3<f64>) -> Point2 {
        let [right, up] = self.view.project(p_w);
        [self.origin_px[0] + right * self.px_per_m, self.origin_px[1] - up * self.px_per_m]
    }

    /// The points of an SVG polygon or path.
    #[must_use]
    pub fn polyline(&self, points_w: &[Point3<f64>]) -> String {
        corners(&points_w.iter().map(|point| self.px(point)).collect::<Vec<_>>())
    }

    /// Draws bodies, the nearest last.
    pub fn draw(&self, body: &mut String, items: &[Item]) {
        let mut order: Vec<(f64, &Item)> =
            items.iter().map(|item| (self.view.axes_w[2].dot(&item.centre()), item)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, item) in order {
            self.draw_item(body, item);
        }
    }

    /// Draws an arrow from one point to another, with SVG attributes of its line and of its head. Along the direction of view it
    /// is a dot.
    pub fn arrow(&self, body: &mut String, [from_w, to_w]: [&Point3<f64>; 2], [line, head]: &[String; 2]) {
        let ([x1, y1], [x2, y2]) = (self.px(from_w), self.px(to_w));
        let _ = writeln!(body, "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" {line} stroke-width=\"2.5\"/>");
        let length_px = libm::hypot(x2 - x1, y2 - y1);
        if length_px > 6.0 {
            let (ux, uy) = ((x2 - x1) / length_px, (y2 - y1) / length_px);
            let wing =
                |side: f64| format!("{:.1},{:.1}", x2 - 9.0 * ux + 4.0 * side * uy, y2 - 9.0 * uy - 4.0 * side * ux);
            let _ = writeln!(body, "<polygon points=\"{x2:.1},{y2:.1} {} {}\" {head}/>", wing(1.0), wing(-1.0));
        } else {
            let _ = writeln!(body, "<circle cx=\"{x2:.1}\" cy=\"{y2:.1}\" r=\"4\" {head}/>");
        }
    }

    // Writing to a string does not fail, so the results are ignored.
    fn draw_item(&self, body: &mut String, item: &Item) {
        let outline = |points: &[Point3<f64>]| corners(&convex_hull(points.iter().map(|p| self.px(p)).collect()));
        match item {
            Item::Hull(points, paint) => {
                let _ = writeln!(body, "<polygon points=\"{}\" {paint} stroke-width=\"0.7\"/>", outline(points));
            }
            Item::Pierced(points, holes, paint) => {
                let holes: Vec<_> = holes.iter().map(|hole| format!(" M{}Z", self.polyline(hole))).collect();
                let path = format!("M{}Z{}", outline(points), holes.concat());
                let _ = writeln!(body, "<path d=\"{path}\" fill-rule=\"evenodd\" {paint} stroke-width=\"0.7\"/>");
            }
            Item::Capsule(ends, radius_m, paints) => {
                let ([x1, y1], [x2, y2]) = (self.px(&ends[0]), self.px(&ends[1]));
                let width_px = 2.0 * radius_m * self.px_per_m;
                for (paint, width_px) in paints.iter().zip([width_px, width_px - 1.6]) {
                    let _ = writeln!(
                        body,
                        "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" {paint} stroke-width=\"{width_px:.1}\" \
                         stroke-linecap=\"round\"/>"
                    );
                }
            }
        }
    }
}

fn corners(points: &[Point2]) -> String {
    points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}
