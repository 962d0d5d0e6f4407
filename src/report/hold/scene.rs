//! The bodies of a hold in W, planned or at a moment of its simulation, and their drawing in a view. The line of sight is
//! dashed; the view from above also shows the sector in front of the person that the tool tip must be over.
//!
//! Overlapping primitives of a link may be drawn in the wrong order: bodies are drawn in the order of their centres.

use std::fmt::Write as _;

use nalgebra::{Point3, Vector3};

use super::palette::Palette;
use crate::{
    human::{BodyPart, Capsule, Human, HumanError, default_tool},
    model::{
        frames::Pose,
        plan::{HumanPosture, Plan},
        scenario::{Person, Tool},
        tool_part::ToolPart,
        trace::{Sample, Trace},
    },
    report::{
        bodies,
        projection::{Bounds, Item, Sheet, View},
    },
    robot::{ArmState, Robot},
};

/// Length of the arrow of the tool's force, m/N: 15 N are 0.15 m.
const ARROW_M_PER_N: f64 = 0.01;

/// Radius of the marks of the eyes, m; chosen for visibility.
const EYE_RADIUS_M: f64 = 0.014;

/// A plan with what its pictures need beside it.
#[derive(Clone, Copy)]
pub struct Holding<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// Its robot.
    pub robot: &'a Robot,
    /// The rules of the person.
    pub person: Person,
    /// The tool in their hand.
    pub tool: Tool,
}

impl<'a> Holding<'a> {
    /// With person and tool of the plan's own scenario; without one with the defaults for its operation.
    #[must_use]
    pub fn of_plan(plan: &'a Plan, robot: &'a Robot) -> Self {
        let scenario = plan.scenario.as_ref();
        let tool = scenario.map_or_else(|| default_tool(plan.operation.kind), |scenario| scenario.tool);
        Self { plan, robot, person: scenario.map_or_else(Person::default, |scenario| scenario.human), tool }
    }
}

/// Where board and robot are, and the force on the board.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Poses of the links.
    pub x_wl: Vec<Pose>,
    /// Pose of the board.
    pub x_wo: Pose,
    /// Where the tool's force acts in W, m.
    pub tip_w: Point3<f64>,
    /// The tool's force in W, N.
    pub force_w_n: Vector3<f64>,
}

impl Moment {
    /// As planned, under the full load.
    #[must_use]
    pub fn planned(plan: &Plan, robot: &Robot) -> Self {
        let x_wo = plan.object.x_wo;
        Self {
            x_wl: robot.planned_link_poses(&plan.arms, plan.object.size_m[2]),
            x_wo,
            tip_w: x_wo * Point3::from(plan.operation.x_ot.translation.vector),
            force_w_n: x_wo.rotation * plan.operation.wrench_o.force_n,
        }
    }

    /// As simulated in a sample of a trace. Arms that the robot does not have are left out.
    #[must_use]
    pub fn simulated(trace: &Trace, sample: &Sample, robot: &Robot) -> Self {
        let states = trace.arms.iter().zip(&sample.arms).filter_map(|(arm, state)| {
            let travel_m = |finger| state.finger_m.get(finger).copied().unwrap_or(0.0);
            let finger_travel_m = [travel_m(0), travel_m(1)];
            Some(ArmState { arm: robot.arm_index(&arm.name)?, q_rad: &state.q_rad, finger_travel_m })
        });
        Self {
            x_wl: robot.link_poses(&robot.positions(&states.collect::<Vec<_>>())),
            x_wo: sample.x_wo,
            tip_w: sample.x_wo * Point3::from(sample.p_ot_m),
            force_w_n: sample.tool_wrench_w.force_n,
        }
    }
}

/// What a picture shows.
pub struct HoldScene {
    palette: Palette,
    items: Vec<Item>,
    /// Board and hands as planned, if they are shown at another moment.
    ghosts: Vec<Item>,
    /// Outline of the sector in front of the person, in W; empty for a posture without limits.
    sector_w: Vec<Point3<f64>>,
    /// The point between the eyes and the tool tip, in W; empty without a person.
    sight_w: Vec<Point3<f64>>,
    /// Where the tool's force acts, and its arrow, in W, m.
    arrow_w: (Point3<f64>, Vector3<f64>),
}

impl HoldScene {
    /// A plan at a moment.
    ///
    /// # Errors
    /// If the plan's person or tool is invalid.
    pub fn new(holding: &Holding<'_>, moment: &Moment, palette: Palette) -> Result<Self, HumanError> {
        let Holding { plan, robot, .. } = *holding;
        let mut items = bodies::links(robot, &moment.x_wl, |part, rgba| Some(palette.link(part, rgba)));
        items.push(bodies::board(&plan.object, &moment.x_wo, palette.board().to_owned()));
        let arrow_w = (moment.tip_w, moment.force_w_n * ARROW_M_PER_N);
        let ghosts = Vec::new();
        let mut scene = Self { palette, items, ghosts, sector_w: Vec::new(), sight_w: Vec::new(), arrow_w };
        if let Some(posture) = &plan.human {
            scene.add_person(holding, posture)?;
        }
        Ok(scene)
    }

    /// With the outlines of board and hands as they are planned.
    #[must_use]
    pub fn with_planned(mut self, Holding { plan, robot, .. }: &Holding<'_>) -> Self {
        let planned = Moment::planned(plan, robot);
        let paint = || self.palette.ghost().to_owned();
        self.ghosts = bodies::links(robot, &planned.x_wl, |part, _| part.filter(|part| part.is_hand).map(|_| paint()));
        self.ghosts.push(bodies::board(&plan.object, &planned.x_wo, paint()));
        self
    }

    /// Adds the person of a plan and the tool in the hand.
    fn add_person(&mut self, holding: &Holding<'_>, posture: &HumanPosture) -> Result<(), HumanError> {
        let kind = holding.plan.operation.kind;
        let human = Human::new(&posture.person(&holding.person), &holding.tool)?;
        let (x_wb, q_rad) = (&posture.x_wb, &posture.q_rad);
        for Capsule { name, p0_w, p1_w, radius_m } in human.capsules_w(x_wb, q_rad) {
            if name != BodyPart::Tool {
                self.items.push(Item::Capsule([p0_w, p1_w], radius_m, self.palette.person()));
            }
        }
        let eye = |eye_w| Item::Capsule([eye_w; 2], EYE_RADIUS_M, self.palette.eye());
        self.items.extend(human.eyes_w(x_wb).map(eye));
        let parts = human.tool_parts_w(x_wb, q_rad, kind).into_iter();
        let part = |part: ToolPart| Item::Hull(part.ends_w.concat(), self.palette.tool(part.material).to_owned());
        self.items.extend(parts.map(part));
        self.sector_w = human.sector_w(x_wb);
        self.sight_w = human.line_of_sight_w(x_wb, q_rad).to_vec();
        Ok(())
    }

    /// The extent of all that is drawn in a view.
    #[must_use]
    pub fn bounds(&self, view: &View) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        let sector = view.is_from_above().then_some((self.sector_w.as_slice(), 0.0));
        for (points_w, reach_m) in self.items.iter().chain(&self.ghosts).map(Item::extent).chain(sector) {
            bounds.include(view, points_w, reach_m);
        }
        bounds
    }

    /// Draws a view.
    pub fn draw(&self, body: &mut String, sheet: &Sheet) {
        // Writing to a string does not fail, so the results are ignored.
        if sheet.view.is_from_above() && !self.sector_w.is_empty() {
            let sector = self.palette.sector();
            let _ = writeln!(body, "<polygon points=\"{}\" {sector}/>", sheet.polyline(&self.sector_w));
        }
        sheet.draw(body, &self.items);
        sheet.draw(body, &self.ghosts);
        if !self.sight_w.is_empty() {
            let _ = writeln!(body, "<polyline points=\"{}\" {}/>", sheet.polyline(&self.sight_w), self.palette.sight());
        }
        // The arrow starts at the tip, so that it does not hide the tool, and is on top of everything.
        let (tip_w, arrow_w) = self.arrow_w;
        sheet.arrow(body, [&tip_w, &(tip_w + arrow_w)], &self.palette.force());
    }
}
