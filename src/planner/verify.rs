//! The check of a plan from scratch: nothing is taken from the search but the plan itself.
//!
//! Every pose is computed again from joint angles, in the world; comfort, load factors and deflection are compared with
//! what comes out; reach, joint limits, strength, standing and collisions are tested. It serves plans of other planners
//! as well. Metrics, collision model and stability program are those of the search; its way of choosing and placing is not.

use nalgebra::Vector3;

use super::outcome::PlanError;
use crate::{
    collision::{CollisionModel, PersonPart, Scene},
    comfort,
    human::{Human, HumanError},
    model::{
        plan::{Comfort, HumanPosture, MeanComfort, Plan},
        scenario::{ResponseKind, Scenario, StabilityKind, Tool},
    },
    robot::{Chain, Robot},
    statics::{ContactModel, StabilityWorkspace},
};

/// How exact inverse kinematics must be, m and rad (docs/method.md#34-constraints).
const POSE_TOLERANCE: f64 = 1e-6;
/// How far a figure of the plan may be from the one computed again: rounding, relative.
const FIGURE_TOLERANCE: f64 = 1e-6;

/// Something that is not as the plan has it, or not allowed, in words.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw(pub String);

impl std::fmt::Display for Flaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// Everything that is wrong with a plan under a scenario; empty when it keeps every constraint.
///
/// # Errors
/// When the scenario's person or tool is none.
pub fn verify(plan: &Plan, scenario: &Scenario, robot: &Robot) -> Result<Vec<Flaw>, PlanError> {
    let mut flaws = Vec::new();
    arms(plan, robot, &mut flaws);
    stability(plan, scenario, robot, &mut flaws);
    match (&plan.human, &plan.comfort) {
        (Some(posture), Some(comfort)) => {
            let human = Human::new(&posture.person(), &scenario.tool)?;
            person(plan, posture, robot, &human, &mut flaws);
            figures(plan, posture, comfort, scenario, robot, &human, &mut flaws);
            flaws.extend(first_touch(plan, &scenario.tool, robot)?.map(Flaw));
        }
        _ => flaws.push(Flaw("the plan has no person and comfort to check".into())),
    }
    Ok(flaws)
}

fn expect(holds: bool, flaws: &mut Vec<Flaw>, flaw: impl FnOnce() -> String) {
    if !holds {
        flaws.push(Flaw(flaw()));
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= FIGURE_TOLERANCE * a.abs().max(b.abs()).max(1.0)
}

fn arms(plan: &Plan, robot: &Robot, flaws: &mut Vec<Flaw>) {
    for hold in &plan.arms {
        let Some(index) = robot.arm_index(&hold.name) else {
            flaws.push(Flaw(format!("{}: no such arm", hold.name)));
            continue;
        };
        let chain = Chain::new(robot, index, 0.0);
        let reached = chain.gripper_pose(&hold.q_rad);
        let meant = plan.object.x_wo * hold.x_og;
        let apart_m = (reached.translation.vector - meant.translation.vector).norm();
        let apart_rad = reached.rotation.angle_to(&meant.rotation);
        expect(apart_m.max(apart_rad) <= POSE_TOLERANCE, flaws, || {
            format!("{}: the hand is {apart_m:e} m and {apart_rad:e} rad off its grasp", hold.name)
        });
        expect(chain.within_limits(&hold.q_rad, 0.0), flaws, || format!("{}: beyond a joint limit", hold.name));
    }
}

fn person(plan: &Plan, posture: &HumanPosture, robot: &Robot, human: &Human, flaws: &mut Vec<Flaw>) {
    let tool = posture.x_wb * human.tool_pose_b(&posture.q_rad);
    let meant = plan.object.x_wo * plan.operation.x_ot;
    let apart_m = (tool.translation.vector - meant.translation.vector).norm();
    let apart_rad = tool.rotation.angle_to(&meant.rotation);
    expect(apart_m.max(apart_rad) <= POSE_TOLERANCE, flaws, || {
        format!("the tool is {apart_m:e} m and {apart_rad:e} rad off the operation")
    });
    expect(human.arm().within_limits(&posture.q_rad), flaws, || "the person's arm is beyond a joint limit".into());
    let off_floor_m = (posture.x_wb.translation.z - robot.floor_z_m).abs();
    expect(off_floor_m <= POSE_TOLERANCE, flaws, || format!("the person stands {off_floor_m:e} m off the floor"));
    let tilt_rad = (posture.x_wb.rotation * Vector3::z()).angle(&Vector3::z());
    expect(tilt_rad <= POSE_TOLERANCE, flaws, || format!("the person leans by {tilt_rad:e} rad"));
}

fn figures(
    plan: &Plan,
    posture: &HumanPosture,
    written: &Comfort,
    scenario: &Scenario,
    robot: &Robot,
    human: &Human,
    flaws: &mut Vec<Flaw>,
) {
    let wrench_w = plan.operation.wrench_w(&plan.object.x_wo);
    let surface = comfort::robot_points_w(robot, &robot.planned_link_poses(&plan.arms, plan.object.size_m[2]));
    let mut found =
        comfort::posture_comfort(human, &scenario.comfort, &surface, &posture.x_wb, &posture.q_rad, &wrench_w);
    let strongest = found.activations.iter().copied().fold(0.0, f64::max);
    expect(strongest <= 1.0, flaws, || format!("an activation is {strongest}, more than the person has"));
    if scenario.comfort.person == ResponseKind::Mean {
        match average(plan, scenario, robot, human) {
            Some(average) => comfort::use_mean_response(&mut found, average, &scenario.comfort),
            None => flaws.push(Flaw("the person has no answer on the grid of the average".into())),
        }
    }
    let mut compared = vec![
        ("muscular", written.muscular, found.muscular),
        ("muscular_regularised", written.muscular_regularised, found.muscular_regularised),
        ("peripersonal_m", written.peripersonal_m, found.peripersonal_m),
        ("objective", written.objective, found.objective),
    ];
    if let (Some(written), Some(found)) = (written.average, found.average) {
        let MeanComfort { muscular_regularised, peripersonal_m, .. } = found;
        compared.push(("average.muscular_regularised", written.muscular_regularised, muscular_regularised));
        compared.push(("average.peripersonal_m", written.peripersonal_m, peripersonal_m));
    }
    for (name, written, found) in compared {
        expect(same(written, found), flaws, || format!("comfort.{name} is {written} in the plan and {found} in fact"));
    }
}

/// The mean comfort of the person's answers to the plan's hold.
fn average(plan: &Plan, scenario: &Scenario, robot: &Robot, human: &Human) -> Option<MeanComfort> {
    let poses = robot.planned_link_poses(&plan.arms, plan.object.size_m[2]);
    let holding: Vec<_> = plan.arms.iter().filter_map(|hold| robot.arm_index(&hold.name)).collect();
    comfort::mean_response(&comfort::ResponseQuery {
        human,
        collision: &CollisionModel::new(robot),
        settings: scenario.comfort,
        operation: plan.operation,
        floor_z_m: robot.floor_z_m,
        robot_points_w: &comfort::robot_points_w(robot, &poses),
        scene: Scene {
            link_poses: &poses,
            holding: &holding,
            board_size_m: plan.object.size_m,
            x_wo: plan.object.x_wo,
            person: &[],
        },
    })
}

/// The first two bodies of a plan that touch, or come closer to the person than docs/method.md#35-clearances allows; the person is
/// left out where the plan has none.
///
/// # Errors
/// When the plan's person or the tool is none.
pub fn first_touch(plan: &Plan, tool: &Tool, robot: &Robot) -> Result<Option<String>, HumanError> {
    let person = match &plan.human {
        Some(posture) => {
            let human = Human::new(&posture.person(), tool)?;
            human.capsules_w(&posture.x_wb, &posture.q_rad).map(PersonPart::from).to_vec()
        }
        None => Vec::new(),
    };
    let holding: Vec<_> = plan.arms.iter().filter_map(|hold| robot.arm_index(&hold.name)).collect();
    let scene = Scene {
        link_poses: &robot.planned_link_poses(&plan.arms, plan.object.size_m[2]),
        holding: &holding,
        board_size_m: plan.object.size_m,
        x_wo: plan.object.x_wo,
        person: &person,
    };
    Ok(CollisionModel::new(robot).first_violation(&scene).map(|violation| violation.describe(robot)))
}

fn stability(plan: &Plan, scenario: &Scenario, robot: &Robot, flaws: &mut Vec<Flaw>) {
    let found = ContactModel::from_plan(robot, &plan.arms, &plan.object, &plan.operation, scenario.grip.friction)
        .and_then(|hold| StabilityWorkspace::new().predict(&hold, &scenario.limits));
    let (found, written) = match (found, &plan.stability) {
        (Ok(Some(found)), Some(written)) => (found, written),
        (Ok(None), _) => return flaws.push(Flaw("the hold does not stand the load".into())),
        (Err(error), _) => return flaws.push(Flaw(error.to_string())),
        (_, None) => return flaws.push(Flaw("the plan states no stability".into())),
    };
    let least = scenario.limits.load_factor;
    expect(found.load_factor >= least, flaws, || format!("the load factor is {}", found.load_factor));
    if scenario.planner.stability == StabilityKind::Compliant {
        let (factor, deflection_mm) = (found.compliant_load_factor, found.predicted_deflection_mm);
        // The compliant load factor is found to a thousandth, from below.
        expect(factor >= least - 1e-3, flaws, || format!("the compliant load factor is {factor}"));
        let limit_mm = scenario.limits.deflection_mm;
        expect(deflection_mm <= limit_mm, flaws, || format!("the predicted deflection is {deflection_mm} mm"));
    }
    let compared = [
        ("load_factor", written.load_factor, found.load_factor),
        ("predicted_deflection_mm", written.predicted_deflection_mm, found.predicted_deflection_mm),
    ];
    for (name, written, found) in compared {
        // Two solves of the same conic program agree to its tolerance, which is coarser than rounding.
        expect((written - found).abs() <= 1e-4 * found.max(1.0), flaws, || {
            format!("stability.{name} is {written} in the plan and {found} in fact")
        });
    }
}
