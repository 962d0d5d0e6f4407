//! The bodies of a stage in W: robot, board, person and tool as they are at its end, and as ghosts what has changed in it.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::{input::JudgedPlan, path::PathParts};
use crate::{
    human::{BodyPart, Capsule, Human, HumanError, place::step_back_w},
    model::{
        frames::Pose,
        plan::{ArmHold, HumanPosture},
        staged_plan::{ArmPath, Holding, PersonDuring, Stage, StagedPlan},
        tool_part::ToolMaterial,
    },
    report::{
        bodies::{self, ARM_COLOURS, ArmPart},
        projection::Item,
    },
    robot::{Chain, Robot},
};

/// Points of a drawn motion of a hand.
const WAY_POINTS: usize = 24;

/// Radius of the marks of the eyes, m; chosen for visibility.
const EYE_RADIUS_M: f64 = 0.016;

/// A hand that holds the board, or changes its grasp.
pub struct HandMark {
    /// Number of the arm in the robot.
    pub arm: usize,
    /// Where it holds the board after the stage, in O, m.
    pub point_o: Point3<f64>,
    /// The direction in which it reaches onto the board, in O.
    pub ahead_o: Vector3<f64>,
    /// Its way in the stage in W, m, from before to after; empty if it does not move.
    pub way_w: Vec<Point3<f64>>,
    /// Where it held the board before, and in which direction it reached onto it, if it has let go in the stage.
    pub before_o: Option<(Point3<f64>, Vector3<f64>)>,
}

/// A stage as it is drawn.
pub struct StageScene {
    /// The board's pose after the stage.
    pub x_wo: Pose,
    /// Robot, board, person and tool after the stage, without links that stay.
    pub items: Vec<Item>,
    /// The hand at its old grasp, and the person before a step back.
    pub ghosts: Vec<Item>,
    /// The board before a motion.
    pub board_before: Vec<Item>,
    /// The head in W: before and after a step back, or at the pieces of a hold.
    pub step_w: Vec<Point3<f64>>,
    /// The hands.
    pub hands: Vec<HandMark>,
    /// The path on the board.
    pub path: PathParts,
}

impl StageScene {
    /// The stage of this number, from 0.
    ///
    /// # Errors
    /// If the person or the tool is invalid.
    pub fn new(input: &JudgedPlan<'_>, number: usize) -> Result<Self, HumanError> {
        let JudgedPlan { plan, holdings, robot, .. } = *input;
        let [before, after] = [&holdings[number], &holdings[number + 1]];
        let stage = &plan.stages[number];
        let mut scene = Self {
            x_wo: after.x_wo,
            items: arms(robot, plan, after),
            ghosts: Vec::new(),
            board_before: Vec::new(),
            step_w: Vec::new(),
            hands: after.arms.iter().filter_map(|hold| hand(robot, plan, hold, before, stage)).collect(),
            path: PathParts::of(plan, number),
        };
        scene.items.push(bodies::board(&plan.object, &after.x_wo, "class=\"board\"".to_owned()));
        match stage {
            Stage::Hold(_) => {}
            Stage::Move(_) => {
                scene.board_before.push(bodies::board(&plan.object, &before.x_wo, "class=\"ghost\"".to_owned()))
            }
            Stage::Regrasp(regrasp) => scene.ghosts.extend(ghost_of_hand(robot, plan, before, &regrasp.arm.name)),
        }
        scene.add_person(input, number)?;
        Ok(scene)
    }

    /// All bodies that are drawn.
    pub fn bodies(&self) -> impl Iterator<Item = &Item> {
        self.items.iter().chain(&self.ghosts).chain(&self.board_before)
    }

    /// Points on the face of the board in W.
    #[must_use]
    pub fn on_face_w(&self, trail: &[[f64; 2]], thickness_m: f64) -> Vec<Point3<f64>> {
        trail.iter().map(|[x, y]| self.x_wo * Point3::new(*x, *y, thickness_m / 2.0)).collect()
    }

    /// Adds the person with the tool where they are in the stage, and where they have worked if they step back in it.
    fn add_person(&mut self, input: &JudgedPlan<'_>, number: usize) -> Result<(), HumanError> {
        let Some(posture) = posture(input.plan, number) else { return Ok(()) };
        let human = Human::new(&posture.person(&input.scenario.human), &input.scenario.tool)?;
        if let Stage::Hold(hold) = &input.plan.stages[number] {
            let postures = hold.pieces.iter().filter_map(|worked| worked.human.as_ref());
            self.step_w = postures.map(|at| human.capsules_w(&at.x_wb, &at.q_rad)[0].p0_w).collect();
        }
        if input.plan.stages[number].person() == PersonDuring::StepsBack {
            let capsules = human.capsules_w(&posture.x_wb, &posture.q_rad);
            let [head_w, tip_w] = [capsules[0].p0_w, capsules[capsules.len() - 1].p1_w];
            let step_w = step_back_w(&head_w, &tip_w);
            let back = Isometry3::from_parts(step_w.into(), UnitQuaternion::identity());
            if !input.is_back_before(number) {
                self.step_w = vec![head_w, head_w + step_w];
                self.ghosts.extend(person(input.plan, &human, posture, &posture.x_wb));
            }
            self.items.extend(person(input.plan, &human, posture, &(back * posture.x_wb)));
        } else {
            self.items.extend(person(input.plan, &human, posture, &posture.x_wb));
        }
        Ok(())
    }
}

/// The person's posture in a stage: in a hold that of its middle piece, otherwise that of the piece before, or of the first one.
fn posture(plan: &StagedPlan, number: usize) -> Option<&HumanPosture> {
    let worked = if let Stage::Hold(hold) = &plan.stages[number] {
        hold.pieces.get(hold.pieces.len().saturating_sub(1) / 2)
    } else {
        let last = plan.worked_pieces().take_while(|(stage, _)| *stage < number).last();
        last.or_else(|| plan.worked_pieces().next()).map(|(_, worked)| worked)
    };
    worked.and_then(|worked| worked.human.as_ref())
}

/// The person's body, eyes and tool.
fn person(plan: &StagedPlan, human: &Human, posture: &HumanPosture, x_wb: &Pose) -> Vec<Item> {
    let q_rad = &posture.q_rad;
    let paints = |class: &str| ["-edge", ""].map(|part| format!("class=\"{class}{part}\""));
    let body = human.capsules_w(x_wb, q_rad).into_iter().filter(|capsule| capsule.name != BodyPart::Tool);
    let mut items: Vec<Item> = body
        .map(|Capsule { name, p0_w, p1_w, radius_m }| {
            let class = if name.moves_with_arm() { "work" } else { "person" };
            Item::Capsule([p0_w, p1_w], radius_m, paints(class))
        })
        .collect();
    items.extend(human.eyes_w(x_wb).map(|eye_w| Item::Capsule([eye_w; 2], EYE_RADIUS_M, paints("eye"))));
    items.extend(human.tool_parts_w(x_wb, q_rad, plan.task.kind).into_iter().map(|part| {
        let class = match part.material {
            ToolMaterial::Steel => "steel",
            ToolMaterial::Housing => "housing",
            ToolMaterial::Grip => "handle",
        };
        Item::Hull(part.ends_w.concat(), format!("class=\"{class}\""))
    }));
    items
}

/// The links of these classes while the board is held so.
fn links(
    robot: &Robot,
    plan: &StagedPlan,
    holding: &Holding,
    class: impl Fn(Option<ArmPart>) -> Option<String>,
) -> Vec<Item> {
    let x_wl = robot.planned_link_poses(&holding.arms, plan.object.size_m[2]);
    bodies::links(robot, &x_wl, |part, _| class(part).map(|class| format!("class=\"{class}\"")))
}

/// The links that do not belong to an arm; they are the same in all stages.
pub fn still_links(input: &JudgedPlan<'_>) -> Vec<Item> {
    links(input.robot, input.plan, &input.holdings[0], |of_arm| of_arm.is_none().then(|| "still".to_owned()))
}

/// The arms of the robot.
fn arms(robot: &Robot, plan: &StagedPlan, holding: &Holding) -> Vec<Item> {
    links(robot, plan, holding, |of_arm| {
        let ArmPart { arm, is_hand } = of_arm?;
        Some(format!("{}{}", if is_hand { "hand" } else { "arm" }, arm % ARM_COLOURS))
    })
}

/// The hand of an arm as it held the board.
fn ghost_of_hand(robot: &Robot, plan: &StagedPlan, before: &Holding, name: &str) -> Vec<Item> {
    let index = robot.arm_index(name);
    links(robot, plan, before, |of_arm| {
        let ArmPart { arm, is_hand } = of_arm?;
        (is_hand && Some(arm) == index).then(|| format!("ghost{}", arm % ARM_COLOURS))
    })
}

/// The mark of a hand after a stage; `None` if the robot has no such arm.
fn hand(robot: &Robot, plan: &StagedPlan, hold: &ArmHold, before: &Holding, stage: &Stage) -> Option<HandMark> {
    let arm = robot.arm_index(&hold.name)?;
    let grasp_g = Point3::from(robot.arms[arm].gripper.grasp_point_g());
    let on_board = |x_og: &Pose| (x_og * grasp_g, x_og.rotation * Vector3::z());
    let (point_o, ahead_o) = on_board(&hold.x_og);
    let old = || before.arms.iter().find(|old| old.name == hold.name).map(|old| on_board(&old.x_og));
    let way = |path: &ArmPath| {
        let travel_m = robot.arms[arm].gripper.travel_for_gap_m(0, plan.object.size_m[2]);
        let chain = Chain::new(robot, arm, travel_m);
        let last = path.q_rad.len().saturating_sub(1);
        let rows = (0..=WAY_POINTS).map(|k| k * last / WAY_POINTS);
        rows.map(|row| chain.gripper_pose(&path.q_rad[row]) * grasp_g).collect::<Vec<_>>()
    };
    let (way_w, before_o) = match stage {
        Stage::Move(motion) => {
            (motion.arms.iter().find(|path| path.name == hold.name).map_or_else(Vec::new, way), None)
        }
        Stage::Regrasp(regrasp) if regrasp.arm.name == hold.name => (way(&regrasp.arm), old()),
        Stage::Hold(_) | Stage::Regrasp(_) => (Vec::new(), None),
    };
    Some(HandMark { arm, point_o, ahead_o, way_w, before_o })
}
