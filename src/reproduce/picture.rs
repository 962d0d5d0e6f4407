//! A plan as an SVG file: both views of the scene with a title and the scores of the posture.

use std::fmt::Write as _;

use crate::{
    human::HumanError,
    model::plan::{Comfort, Plan},
    report::{
        hold::{HoldScene, Holding, Moment, Palette},
        projection::{Bounds, Sheet, View},
    },
    robot::Robot,
};

/// Scale, px/m.
const PX_PER_M: f64 = 190.0;

/// Margin around each view, px.
const MARGIN_PX: f64 = 24.0;

/// Height of the two lines of the title and the views' names above the views, px.
const TITLE_PX: f64 = 72.0;

/// The picture of a plan, with a title and the scores of the posture.
///
/// # Errors
/// If the plan's person or tool is invalid.
pub fn svg(plan: &Plan, robot: &Robot, title: &str) -> Result<String, HumanError> {
    let scene = HoldScene::new(&Holding::of_plan(plan, robot), &Moment::planned(plan, robot), Palette::File)?;
    let views = [View::from_the_right(), View::from_above()];
    let bounds = views.each_ref().map(|view| scene.bounds(view));
    let width_px = |b: &Bounds| b.size_m()[0] * PX_PER_M + 2.0 * MARGIN_PX;
    let height_px = |b: &Bounds| b.size_m()[1] * PX_PER_M + 2.0 * MARGIN_PX;
    let (width, height) = (bounds.iter().map(width_px).sum::<f64>(), bounds.iter().map(height_px).fold(0.0, f64::max));
    let mut body = String::new();
    let mut left_px = 0.0;
    for (view, bounds) in views.iter().zip(&bounds) {
        // The views are aligned at the lower edge of the picture.
        let [[left_m, below_m], _] = bounds.corners_m;
        let origin_px = [left_px + MARGIN_PX - left_m * PX_PER_M, TITLE_PX + height - MARGIN_PX + below_m * PX_PER_M];
        scene.draw(&mut body, &Sheet { view, origin_px, px_per_m: PX_PER_M });
        let (x, name) = (left_px + MARGIN_PX, Palette::File.name());
        let _ = writeln!(body, "<text x=\"{x:.0}\" y=\"62\" {name}>{}</text>", view.name);
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{
        model::{plate::PlateRecord, scenario::PostureLimits, tool_part::ToolMaterial},
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
        assert_eq!(
            (natural.matches(Palette::File.sight()).count(), natural.matches(Palette::File.sector()).count()),
            (2, 1)
        );
        let unrestricted = picture(PostureLimits::UNRESTRICTED);
        assert_eq!(
            (unrestricted.matches(Palette::File.sight()).count(), unrestricted.matches(Palette::File.sector()).count()),
            (2, 0)
        );
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
        let count = |material| picture.matches(Palette::File.tool(material)).count();
        // Two views of bit and chuck, of the body, of grip and battery.
        assert_eq!([ToolMaterial::Steel, ToolMaterial::Housing, ToolMaterial::Grip].map(count), [4, 2, 4]);
        assert_eq!(picture.matches(&Palette::File.eye()[1]).count(), 4);
    }
}
