//! The document.

use std::io;

use quick_xml::Writer;

use super::{
    super::{
        conditions::Conditions,
        error::SimError,
        feed_forward::feed_forward,
        tool_load::ToolLoad,
        world::{contact_softness_s2, drive_inertia_kg, new_world},
    },
    actuators::{actuators, controls},
    bodies::{board, children, plate_mesh},
    contacts::{contact_pairs, couplings, option, timestep_s},
    data::{custom, largest_wrench_o},
    exported_arm::ExportedArm,
    scenery::{self, DrawnRobot},
    xml::{Xml, empty, numbers, pose_numbers},
};
use crate::{
    check::CheckedPlan,
    model::{plan::Plan, scenario::Limits},
    robot::Robot,
};

/// What the file is about.
struct Exported<'a> {
    robot: &'a Robot,
    plan: &'a Plan,
    conditions: &'a Conditions,
    limits: &'a Limits,
    arms: Vec<ExportedArm<'a>>,
    tool: ToolLoad<'a>,
}

/// Writes the scene of a plan as MJCF, with the limits by which a player judges it.
///
/// # Errors
/// If the conditions or the load over time are invalid, or a gripper has measured wrench limits: its joint with the board is not
/// exported.
pub fn mjcf(checked: &CheckedPlan<'_>, conditions: &Conditions, limits: &Limits) -> Result<String, SimError> {
    let (robot, plan) = (checked.robot(), checked.plan());
    conditions.check()?;
    let measured = checked.arms().iter().find(|arm| robot.arms[arm.index].gripper.holding.measured().is_some());
    if let Some(arm) = measured {
        return Err(SimError::ExportMeasured { arm: arm.hold.name.clone() });
    }
    let stiffness_scale = conditions.uncertainty.contact_stiffness_scale;
    let world = new_world(conditions.settings.timestep_s, stiffness_scale);
    let softness_s2 = contact_softness_s2(&world);
    let arms = checked.arms().iter().enumerate().zip(feed_forward(checked, conditions));
    let exported = Exported {
        arms: arms.map(|(arm, fed)| ExportedArm::new(checked, arm, fed, conditions, softness_s2)).collect(),
        tool: ToolLoad::new(checked, conditions)?,
        robot,
        plan,
        conditions,
        limits,
    };
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    // Writing to memory does not fail.
    document(&mut xml, &exported).map_err(|_| SimError::Engine)?;
    Ok(format!("{}\n", String::from_utf8_lossy(&xml.into_inner())))
}

fn document(xml: &mut Xml, exported: &Exported<'_>) -> io::Result<()> {
    let Exported { robot, plan, conditions, limits, arms, tool } = exported;
    let object = &conditions.uncertainty.board(&plan.object);
    let root = xml.create_element("mujoco").with_attribute(("model", plan.name.as_str()));
    root.write_inner_content(|xml| {
        empty(xml, "compiler", &[("angle", "radian".into()), ("autolimits", "false".into())])?;
        option(xml, &conditions.settings)?;
        custom(xml, conditions, limits, tool, arms)?;
        let board_w_m = object.x_wo.translation.vector;
        // The part of the scene that a viewer shows at first.
        empty(xml, "statistic", &[("center", numbers(board_w_m.as_slice())), ("extent", "1".into())])?;
        plate_mesh(xml, object)?;
        let drawn = DrawnRobot::new(robot);
        scenery::assets(xml, &drawn)?;
        let mut positions = Vec::new();
        let inertia = [drive_inertia_kg(object), timestep_s(&conditions.settings)];
        xml.create_element("worldbody").write_inner_content(|xml| {
            scenery::fixed(xml, &drawn, arms, &board_w_m)?;
            for arm in arms {
                children(xml, &drawn, arm, inertia, None, &mut positions)?;
            }
            board(xml, object, arms, &tool.at(0).1.p_ot_m)
        })?;
        contact_pairs(xml, arms, object.mass_kg)?;
        couplings(xml, robot, arms)?;
        actuators(xml, robot, arms, conditions)?;
        positions.extend(pose_numbers(&object.x_wo));
        key_frames(xml, &positions, exported)
    })?;
    Ok(())
}

/// The planned state without and with the largest load.
fn key_frames(xml: &mut Xml, positions: &[f64], exported: &Exported<'_>) -> io::Result<()> {
    let Exported { conditions, arms, tool, .. } = exported;
    let held: Vec<f64> = arms.iter().flat_map(|arm| controls(arm, conditions)).collect();
    let frames = [("planned", [0.0; 6]), ("loaded", largest_wrench_o(tool).into())];
    xml.create_element("keyframe").write_inner_content(|xml| {
        frames.iter().try_for_each(|(name, wrench_o)| {
            let controls = [held.as_slice(), wrench_o].concat();
            let key = [("name", (*name).into()), ("qpos", numbers(positions)), ("ctrl", numbers(&controls))];
            empty(xml, "key", &key)
        })
    })?;
    Ok(())
}
