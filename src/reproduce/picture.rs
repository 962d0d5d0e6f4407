//! A plan as SVG: robot, board, person and tool as convex primitives, seen from the right and from above. The line of sight
//! is dashed; the view from above also shows the sector in front of the person that the tool tip must be over.
//!
//! Overlapping primitives of a link may be drawn in the wrong order: bodies are drawn in the order of their centres.

use std::fmt::Write as _;

use nalgebra::Point3;

use crate::{
    human::{BodyPart, Capsule, Human, HumanError, default_tool},
    model::{
        plan::{Comfort, HumanPosture, Plan},
        scenario::Person,
        tool_part::ToolMaterial,
    },
    report::{
        hull::Point2,
        projection::{Bounds, Item, Sheet, View},
    },
    robot::Robot,
};

/// Scale, px/m.
const PX_PER_M: f64 = 190.0;

/// Margin around each view, px.
const MARGIN_PX: f64 = 24.0;

/// Height of the two lines of the title and the views' names above the views, px.
const TITLE_PX: f64 = 72.0;

/// Length of the arrow of the tool's force, m/N: 15 N are 0.15 m.
const ARROW_M_PER_N: f64 = 0.01;

/// SVG attributes of the board.
const BOARD: &str = "fill=\"#e3c58f\" fill-opacity=\"0.85\" stroke=\"#8a6a2f\"";

/// Colour of the force.
const FORCE: &str = "#c8102e";

/// Radius of the marks of the eyes, m; chosen for visibility.
const EYE_RADIUS_M: f64 = 0.014;

/// Colours of outline and fill, of the person and of their eyes.
const PERSON_STROKE: [&str; 2] = ["#2f5f8a", "#7fb2dc"];
const EYE_STROKE: [&str; 2] = ["#ffffff", "#111111"];

/// SVG attributes of the line of sight and of the sector in front of the person.
const SIGHT: &str = "fill=\"none\" stroke=\"#17456e\" stroke-width=\"1.3\" stroke-dasharray=\"5 3\"";
const SECTOR: &str = "fill=\"#7fb2dc\" fill-opacity=\"0.18\" stroke=\"#2f5f8a\" stroke-width=\"0.8\"";

/// What a picture shows.
#[derive(Default)]
struct Scene {
    items: Vec<Item>,
    /// Outline of the sector in front of the person, in W; empty for a posture without limits.
    sector_w: Vec<Point3<f64>>,
    /// The point between the eyes and the tool tip, in W; empty without a person.
    sight_w: Vec<Point3<f64>>,
}

/// The picture of a plan, with a title and the scores of the posture.
///
/// # Errors
/// If the plan's person or tool is invalid.
pub fn svg(plan: &Plan, robot: &Robot, title: &str) -> Result<String, HumanError> {
    let scene = scene(plan, robot)?;
    let views = [View::from_the_right(), View::from_above()];
    let bounds = views.each_ref().map(|view| bounds(view, &scene));
    let width_px = |b: &Bounds| b.size_m()[0] * PX_PER_M + 2.0 * MARGIN_PX;
    let height_px = |b: &Bounds| b.size_m()[1] * PX_PER_M + 2.0 * MARGIN_PX;
    let (width, height) = (bounds.iter().map(width_px).sum::<f64>(), bounds.iter().map(height_px).fold(0.0, f64::max));
    let mut body = String::new();
    let mut left_px = 0.0;
    for (view, bounds) in views.iter().zip(&bounds) {
        // The views are aligned at the lower edge of the picture.
        let [[left_m, below_m], _] = bounds.corners_m;
        let origin_px = [left_px + MARGIN_PX - left_m * PX_PER_M, TITLE_PX + height - MARGIN_PX + below_m * PX_PER_M];
        draw(&mut body, &Sheet { view, origin_px, px_per_m: PX_PER_M }, &scene, plan);
        let _ = writeln!(body, "<text x=\"{:.0}\" y=\"62\" fill=\"#666666\">{}</text>", left_px + MARGIN_PX, view.name);
        left_px += width_px(bounds);
    }
    let height = height + TITLE_PX;
    let scores = plan.comfort.as_ref().and_then(Comfort::scores).unwrap_or_default();
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" font-family=\"sans-serif\" font-size=\"13\" stroke-linejoin=\"round\">\n\
         <rect width=\"{width:.0}\" height=\"{height:.0}\" fill=\"#ffffff\"/>\n\
         <text x=\"{MARGIN_PX}\" y=\"22\" font-size=\"14\" fill=\"#222222\">{title}</text>\n\
         <text x=\"{MARGIN_PX}\" y=\"40\" fill=\"#222222\">{scores}</text>\n{body}</svg>\n"
    ))
}

/// All that is drawn but the force.
fn scene(plan: &Plan, robot: &Robot) -> Result<Scene, HumanError> {
    let mut scene = Scene::default();
    let x_wl = robot.planned_link_poses(&plan.arms, plan.object.size_m[2]);
    for (link, x_wl) in robot.links.iter().zip(&x_wl) {
        for placed in &link.shapes {
            let points_w = placed.shape.surface_points().into_iter().map(|p| x_wl * placed.x_ls * p).collect();
            scene.items.push(Item::Hull(points_w, robot_paint(placed.rgba)));
        }
    }
    let x_wo = &plan.object.x_wo;
    let board_w = plan.object.shape().corners_o().into_iter().map(|p| x_wo * p).collect();
    let in_plane = |[x, y]: &[f64; 2]| x_wo * Point3::new(*x, *y, 0.0);
    let holes = plan.object.plate.iter().flat_map(|plate| plate.holes_m());
    scene.items.push(match holes.map(|hole| hole.iter().map(in_plane).collect()).collect::<Vec<_>>() {
        holes_w if holes_w.is_empty() => Item::Hull(board_w, BOARD.to_owned()),
        holes_w => Item::Pierced(board_w, holes_w, BOARD.to_owned()),
    });
    if let Some(posture) = &plan.human {
        add_person(&mut scene, plan, posture)?;
    }
    Ok(scene)
}

/// Adds the person of a plan and the tool in the hand.
fn add_person(scene: &mut Scene, plan: &Plan, posture: &HumanPosture) -> Result<(), HumanError> {
    let kind = plan.operation.kind;
    let rules = plan.scenario.as_ref().map_or_else(Person::default, |scenario| scenario.human);
    let tool = plan.scenario.as_ref().map_or_else(|| default_tool(kind), |scenario| scenario.tool);
    let human = Human::new(&posture.person(&rules), &tool)?;
    let (x_wb, q_rad) = (&posture.x_wb, &posture.q_rad);
    for Capsule { name, p0_w, p1_w, radius_m } in human.capsules_w(x_wb, q_rad) {
        if name != BodyPart::Tool {
            scene.items.push(Item::Capsule([p0_w, p1_w], radius_m, strokes(PERSON_STROKE)));
        }
    }
    scene.items.extend(human.eyes_w(x_wb).map(|eye_w| Item::Capsule([eye_w; 2], EYE_RADIUS_M, strokes(EYE_STROKE))));
    let parts = human.tool_parts_w(x_wb, q_rad, kind).into_iter();
    scene.items.extend(parts.map(|part| Item::Hull(part.ends_w.concat(), tool_paint(part.material))));
    scene.sector_w = human.sector_w(x_wb);
    scene.sight_w = human.line_of_sight_w(x_wb, q_rad).to_vec();
    Ok(())
}

/// The attributes of a capsule.
fn strokes(colours: [&str; 2]) -> [String; 2] {
    colours.map(|colour| format!("stroke=\"{colour}\""))
}

fn tool_paint(material: ToolMaterial) -> String {
    let fill = match material {
        ToolMaterial::Steel => "#cfd4da",
        ToolMaterial::Housing => "#e07b39",
        ToolMaterial::Grip => "#4a4a4a",
    };
    format!("fill=\"{fill}\" stroke=\"#222222\"")
}

/// The robot's colours, lightened so that outlines are visible.
fn robot_paint(rgba: [f64; 4]) -> String {
    let [r, g, b] = [0, 1, 2].map(|channel| (255.0 * (0.45 + 0.55 * rgba[channel].clamp(0.0, 1.0))) as u8);
    format!("fill=\"#{r:02x}{g:02x}{b:02x}\" stroke=\"#444444\"")
}

/// The extent of all that is drawn in a view.
fn bounds(view: &View, scene: &Scene) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    let sector = view.is_from_above().then_some((scene.sector_w.as_slice(), 0.0));
    for (points_w, reach_m) in scene.items.iter().map(Item::extent).chain(sector) {
        bounds.include(view, points_w, reach_m);
    }
    bounds
}

/// Draws one view.
fn draw(body: &mut String, sheet: &Sheet, scene: &Scene, plan: &Plan) {
    if sheet.view.is_from_above() && !scene.sector_w.is_empty() {
        let _ = writeln!(body, "<polygon points=\"{}\" {SECTOR}/>", sheet.polyline(&scene.sector_w));
    }
    sheet.draw(body, &scene.items);
    if !scene.sight_w.is_empty() {
        let _ = writeln!(body, "<polyline points=\"{}\" {SIGHT}/>", sheet.polyline(&scene.sight_w));
    }
    arrow(body, plan, |point| sheet.px(point));
}

/// Draws the tool's force as an arrow that starts at the tip, so that it does not hide the tool, on top of everything.
fn arrow(body: &mut String, plan: &Plan, px: impl Fn(&Point3<f64>) -> Point2) {
    let tip_w = plan.object.x_wo * Point3::from(plan.operation.x_ot.translation.vector);
    let force_m = plan.object.x_wo.rotation * plan.operation.wrench_o.force_n * ARROW_M_PER_N;
    let ([x1, y1], [x2, y2]) = (px(&tip_w), px(&(tip_w + force_m)));
    let _ = writeln!(body, "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke=\"{FORCE}\" stroke-width=\"2.5\"/>");
    let length_px = libm::hypot(x2 - x1, y2 - y1);
    // Along the direction of view the arrow is a dot.
    if length_px > 6.0 {
        let (ux, uy) = ((x2 - x1) / length_px, (y2 - y1) / length_px);
        let wing = |side: f64| format!("{:.1},{:.1}", x2 - 9.0 * ux + 4.0 * side * uy, y2 - 9.0 * uy - 4.0 * side * ux);
        let _ = writeln!(body, "<polygon points=\"{x2:.1},{y2:.1} {} {}\" fill=\"{FORCE}\"/>", wing(1.0), wing(-1.0));
    } else {
        let _ = writeln!(body, "<circle cx=\"{x2:.1}\" cy=\"{y2:.1}\" r=\"4\" fill=\"{FORCE}\"/>");
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{
        model::{plate::PlateRecord, scenario::PostureLimits},
        scenario,
    };

    /// The picture of a committed plan under limits of the posture.
    fn picture(posture: PostureLimits) -> String {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/long-lever.json");
        let loaded = scenario::load_plan(&path, None).unwrap();
        let mut plan = loaded.plan;
        let mut rules = loaded.scenario;
        rules.human.posture = posture;
        plan.scenario = Some(rules);
        svg(&plan, &loaded.robot, "long-lever").unwrap()
    }

    #[test]
    fn both_views_show_the_line_of_sight_and_the_view_from_above_the_sector() {
        let natural = picture(PostureLimits::NATURAL);
        assert_eq!((natural.matches(SIGHT).count(), natural.matches(SECTOR).count()), (2, 1));
        let unrestricted = picture(PostureLimits::UNRESTRICTED);
        assert_eq!((unrestricted.matches(SIGHT).count(), unrestricted.matches(SECTOR).count()), (2, 0));
    }

    #[test]
    fn a_plate_shows_what_is_behind_its_holes() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/long-lever.json");
        let loaded = scenario::load_plan(&path, None).unwrap();
        let mut plan = loaded.plan;
        let without = svg(&plan, &loaded.robot, "box").unwrap();
        let outline_m = plan.object.shape().outline_m();
        plan.object.plate = Some(PlateRecord { outline_m: outline_m.clone(), holes_m: Vec::new() }.into());
        // The same outline is the same picture.
        assert_eq!(svg(&plan, &loaded.robot, "box").unwrap(), without);
        let holes_m = vec![vec![[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]], vec![[-0.1, 0.0], [-0.05, 0.0], [-0.1, -0.1]]];
        plan.object.plate = Some(PlateRecord { outline_m, holes_m }.into());
        let pierced = svg(&plan, &loaded.robot, "box").unwrap();
        let paths: Vec<_> = pierced.lines().filter(|line| line.contains("evenodd")).collect();
        // Two views, each with the outline and two holes.
        assert_eq!((paths.len(), paths[0].matches('M').count(), paths[1].matches('M').count()), (2, 3, 3));
    }

    #[test]
    fn a_drill_has_parts_of_three_materials_and_the_person_two_eyes() {
        let picture = picture(PostureLimits::NATURAL);
        let count = |material| picture.matches(&tool_paint(material)).count();
        // Two views of bit and chuck, of the body, of grip and battery.
        assert_eq!([ToolMaterial::Steel, ToolMaterial::Housing, ToolMaterial::Grip].map(count), [4, 2, 4]);
        assert_eq!(picture.matches(EYE_STROKE[1]).count(), 4);
    }
}
