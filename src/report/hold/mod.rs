//! Pictures of a hold: robot, board, person and tool from the robot's right and from above, as planned, or of a hold that fails at the
//! moment of its first crossing of a limit, with the failing hand from near.

mod close_up;
mod palette;
mod scene;
#[cfg(test)]
mod tests;

use maud::{Markup, PreEscaped, html};

use self::close_up::CloseUp;
pub use self::{
    palette::Palette,
    scene::{HoldScene, Holding, Moment},
};
use super::{
    projection::{Sheet, View},
    units::unit_suffix,
};
use crate::{
    human::HumanError,
    model::{
        measures::{Event, EventKind, Measures},
        trace::{Sample, Trace},
        verdict::{Check, CheckKind, Failure, Verdict},
    },
};

/// The colours of the pictures beside those of the stages of a task.
pub const STYLE: &str = include_str!("hold.css");

/// Scale, px/m, and margin of a view, px.
const PX_PER_M: f64 = 190.0;
const MARGIN_PX: f64 = 10.0;

/// Height of the line with the name of a view, px.
const NAME_PX: f64 = 18.0;

/// What was simulated and judged of a hold.
#[derive(Clone, Copy)]
pub struct SimulatedHold<'a> {
    /// The trace.
    pub trace: &'a Trace,
    /// The judge's series.
    pub measures: &'a Measures,
    /// The judge's events.
    pub events: &'a [Event],
}

/// The pictures of a hold as SVG, with captions.
#[derive(Clone, Debug, PartialEq)]
pub struct HoldPictures {
    views: [String; 2],
    caption: String,
    /// Two views of the failing hand, and their caption.
    near: Option<([String; 2], String)>,
}

impl HoldPictures {
    /// The pictures of a plan: at the first crossing if a limit was crossed in its simulation, otherwise as planned.
    ///
    /// # Errors
    /// If the plan's person or tool is invalid.
    pub fn new(
        holding: &Holding<'_>,
        simulated: Option<SimulatedHold<'_>>,
        verdict: &Verdict,
    ) -> Result<Self, HumanError> {
        let crossing = simulated.and_then(|hold| Crossing::new(hold, verdict));
        let Some(crossing) = crossing else {
            let moment = Moment::planned(holding.plan, holding.robot);
            let scene = HoldScene::new(holding, &moment, Palette::Page)?;
            let force_n = moment.force_w_n.norm();
            let caption = format!("As planned. Arrow: the tool's force, {force_n:.0} N{}.", in_view(holding));
            return Ok(Self { views: views(&scene), caption, near: None });
        };
        let moment = Moment::simulated(crossing.hold.trace, crossing.sample, holding.robot);
        let scene = HoldScene::new(holding, &moment, Palette::Page)?.with_planned(holding);
        let near = crossing
            .close_up(holding)
            .map(|(name, close_up)| (close_up.svg(), in_words(&name, &close_up, crossing.sample.load_factor)));
        let caption = format!(
            "{}. Arrow: the tool's force, {:.0} N; dashed outlines: as planned{}.",
            crossing.in_words(verdict),
            moment.force_w_n.norm(),
            in_view(holding)
        );
        Ok(Self { views: views(&scene), caption, near })
    }

    /// The pictures with their captions.
    #[must_use]
    pub fn markup(&self) -> Markup {
        let figure = |views: &[String; 2], strong: bool, caption: &str| {
            html! {
                figure.hold {
                    div.views { @for view in views { (PreEscaped(view)) } }
                    figcaption { @if strong { strong { (caption) } } @else { (caption) } }
                }
            }
        };
        html! {
            (figure(&self.views, self.near.is_some(), &self.caption))
            @if let Some((views, caption)) = &self.near { (figure(views, false, caption)) }
        }
    }
}

/// The first crossing of a limit.
struct Crossing<'a> {
    hold: SimulatedHold<'a>,
    failure: &'a Failure,
    check: &'a Check,
    /// The sample at that moment, and its number in the judge's series.
    sample: &'a Sample,
    index: usize,
    /// That of the hand-over.
    hand_over: &'a Sample,
}

impl<'a> Crossing<'a> {
    fn new(hold: SimulatedHold<'a>, verdict: &'a Verdict) -> Option<Self> {
        let failure = verdict.first_failure.as_ref()?;
        let at = |time_s: f64| hold.trace.samples.iter().find(|sample| sample.time_s == time_s);
        Some(Self {
            hold,
            failure,
            check: verdict.check(failure.check)?,
            sample: at(failure.time_s)?,
            index: hold.measures.time_s.iter().position(|&time_s| time_s == failure.time_s)?,
            hand_over: at(*hold.measures.time_s.first()?)?,
        })
    }

    /// `deflects at 1.13 s: deflection 15.02 mm, limit 15 mm`, and the bodies that meet.
    fn in_words(&self, verdict: &Verdict) -> String {
        let Check { name, limit, .. } = self.check;
        let (unit, bound) = (unit_suffix(*name), if name.is_least() { "at least" } else { "limit" });
        let series = self.hold.measures.series(*name);
        let values = series.iter().filter_map(|values| values.get(self.index)).copied();
        let value = if name.is_least() { values.reduce(f64::min) } else { values.reduce(f64::max) };
        let value =
            value.map_or_else(String::new, |value| format!(" {}{unit}", beside(value, *limit, unit.is_empty())));
        let what = self.event().map_or("", |event| event.what.as_str());
        let between = if is_between_bodies(*name) && !what.is_empty() { format!(" ({what})") } else { String::new() };
        format!("{} at {:.2} s: {name}{value}{between}, {bound} {limit}{unit}", verdict.verdict, self.failure.time_s)
    }

    fn event(&self) -> Option<&'a Event> {
        let of_check = |event: &&Event| event.kind == EventKind::LimitCrossed(self.failure.check);
        self.hold.events.iter().find(of_check)
    }

    /// The hand that the crossing is about, with the name of its arm: that of the event, or else the one that has moved most.
    /// `None` for bodies that meet elsewhere.
    fn close_up<'b>(&self, holding: &Holding<'b>) -> Option<(String, CloseUp<'b>)> {
        let SimulatedHold { trace, measures, .. } = self.hold;
        if is_between_bodies(self.failure.check) {
            return None;
        }
        let what = self.event().map_or("", |event| event.what.as_str());
        let named = trace.arms.iter().position(|arm| arm.part(what).is_some());
        let motion = |index: &usize| {
            let at = |values: &[f64]| values.get(self.index).copied().unwrap_or(0.0);
            measures.hands.get(*index).map_or(0.0, |hand| at(&hand.slip_mm) + at(&hand.slip_deg))
        };
        let index = named.or_else(|| (0..trace.arms.len()).max_by(|a, b| motion(a).total_cmp(&motion(b))))?;
        let samples = [self.hand_over, self.sample];
        let object = &holding.plan.object;
        let close_up = CloseUp::new(object, holding.robot, trace, index, samples)?;
        Some((trace.arms[index].name.clone(), close_up))
    }
}

/// True for a check of bodies that may meet anywhere, not in a hand.
fn is_between_bodies(check: CheckKind) -> bool {
    matches!(check, CheckKind::Clearance | CheckKind::PersonOverlap)
}

/// A value with as many digits as tell it from a limit, four at most: at least two of a ratio and beside a limit below 1, otherwise one.
fn beside(value: f64, limit: f64, is_ratio: bool) -> String {
    let least = if is_ratio || limit.abs() < 1.0 { 2 } else { 1 };
    let with = |digits| format!("{value:.digits$}");
    let is_other = |text: &String| text.parse() != Ok(limit);
    (least..=4).map(with).find(is_other).unwrap_or_else(|| with(least).trim_start_matches('-').to_owned())
}

/// What else the caption of a view explains.
fn in_view(holding: &Holding<'_>) -> &'static str {
    if holding.plan.human.is_some() { "; dashed line: line of sight" } else { "" }
}

/// What the picture of a hand shows.
fn in_words(name: &str, close_up: &CloseUp<'_>, load_factor: f64) -> String {
    let larger = match close_up.factor {
        1.0 => String::new(),
        factor => format!(", drawn {factor} times as large"),
    };
    let CloseUp { slip_mm, .. } = close_up;
    let forces: Vec<_> = close_up.forces_n().map(|force_n| format!("{force_n:.1} N")).collect();
    format!(
        "The {name} hand under {load_factor:.2} of the load; dashed: at the hand-over of the board. Since then it has slipped \
         {slip_mm:.2} mm and turned {:.2} deg{larger}. Arrows: its forces on the board, {}.",
        close_up.slip_deg(),
        forces.join(" and ")
    )
}

/// Both views of a scene, each as an SVG of its own.
fn views(scene: &HoldScene) -> [String; 2] {
    [View::from_the_right(), View::from_above()].map(|view| {
        let bounds = scene.bounds(&view);
        let [width, height] = bounds.size_m().map(|side_m| side_m * PX_PER_M + 2.0 * MARGIN_PX);
        let [[left_m, _], [_, top_m]] = bounds.corners_m;
        let origin_px = [MARGIN_PX - left_m * PX_PER_M, NAME_PX + MARGIN_PX + top_m * PX_PER_M];
        let mut body = String::new();
        scene.draw(&mut body, &Sheet { view: &view, origin_px, px_per_m: PX_PER_M });
        let (name, paint, height) = (view.name, Palette::Page.name(), height + NAME_PX);
        format!(
            "<svg class=\"scene\" viewBox=\"0 0 {width:.0} {height:.0}\" style=\"flex-basis:{width:.0}px\" role=\"img\" \
             aria-label=\"{name}\"><text x=\"4\" y=\"13\" {paint}>{name}</text>\n{body}</svg>\n"
        )
    })
}
