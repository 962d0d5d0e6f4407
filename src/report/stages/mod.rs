//! Pictures of the stages of a plan, one a stage, with captions.

mod caption;
mod drawing;
mod face;
mod input;
mod path;
mod scene;
#[cfg(test)]
mod tests;

pub use input::JudgedPlan;

use maud::{Markup, PreEscaped, html};

use self::{
    caption::{Caption, captions},
    drawing::{Layout, WIDTH_PX},
    scene::{StageScene, still_links},
};
use super::bodies::ARM_COLOURS;
use crate::human::HumanError;

/// The colours of the pictures, in light and dark mode.
pub const STYLE: &str = include_str!("stages.css");

/// What the pictures show once.
const STILL: &str = "stages-still";

/// The legend and a picture for each stage.
///
/// # Errors
/// If the person or the tool is invalid.
pub fn pictures(input: &JudgedPlan<'_>) -> Result<Markup, HumanError> {
    let scenes =
        (0..input.plan.stages.len()).map(|number| StageScene::new(input, number)).collect::<Result<Vec<_>, _>>()?;
    let (still, board) = (still_links(input), input.plan.object.shape());
    let layout = Layout::of(&scenes, &still, board.thickness_m());
    let captions = captions(input, &scenes);
    Ok(html! {
        svg.shared width="0" height="0" aria-hidden="true" { defs { g id=(STILL) { (PreEscaped(layout.still(&still))) } } }
        (legend(input))
        div.pictures {
            @for (scene, caption) in scenes.iter().zip(&captions) {
                figure id={ "stage-" (caption.number) } class=(if caption.failed { "stage fails" } else { "stage" }) {
                    figcaption {
                        (in_words(caption))
                        (PreEscaped(face::svg(scene, &board)))
                    }
                    svg.stage viewBox={ "0 0 " (WIDTH_PX) " " (format!("{:.0}", layout.height_px())) } role="img"
                        aria-label={ "stage " (caption.number) ", from above and from the robot's right" } {
                        use href={ "#" (STILL) } {}
                        (PreEscaped(layout.draw(scene, &board)))
                    }
                }
            }
        }
    })
}

fn in_words(caption: &Caption) -> Markup {
    html! {
        div {
            strong { (caption.number) ": " (caption.kind) } " "
            span class=(if caption.failed { "failed" } else { "ok" }) { (caption.verdict) }
            @for line in &caption.lines { br; (line) }
        }
    }
}

/// What the colours and lines mean.
fn legend(input: &JudgedPlan<'_>) -> Markup {
    let key = |class: &str, text: &str| {
        html! { span { svg.key viewBox="0 0 26 12" width="26" height="12" { path class=(class) d="M2 6H24" {} } " " (text) } }
    };
    let named = input.plan.arms.iter().filter_map(|hold| Some((input.robot.arm_index(&hold.name)?, &hold.name)));
    html! {
        p {
            "Every stage as it is planned, at its end; a hold with the person at its middle piece. The small drawing is the worked \
             face of the board with the grasps; the marked corner is the same in all drawings."
        }
        p.keys {
            @for (arm, name) in named { (key(&format!("grip c{}", arm % ARM_COLOURS), &format!("{name} hand"))) }
            (key("trail now", "worked on in the stage"))
            (key("trail done", "worked on before"))
            (key("trail to-come", "still to come"))
            @if input.plan.moves() > 0 { (key("ghost", "the board before a motion")) }
            @if input.plan.regrasps() > 0 { (key("grip was c0", "a grasp that was let go")) }
            @if input.has_person() { (key("way step", "the person moves")) }
        }
    }
}
