//! Maps that outlive a planner: where they are kept, and what they depend on.
//!
//! A planner asks its store before it makes a map, and gives it what it has made. A store finds a map again by [`MapSource`], which
//! states everything that the map is made from but the program. So a plan on maps from a store is that on fresh ones, bit for bit,
//! if the store returns only what the same program has written for the same source.

use std::fmt;

use serde::{Serialize, de::DeserializeOwned};

use crate::{
    model::{
        board::BoardShape,
        scenario::{Budget, PlannerSettings, RobotParameters, Scenario},
    },
    robot::{Link, Robot},
};

/// Where maps are kept, such as a folder. No error of a store is an error of a plan: what cannot be read is made, and what cannot be
/// written is made again by the next planner.
pub trait MapStore: Send + Sync {
    /// The bytes that were written for this source; `None` if there are none.
    fn read(&self, source: &MapSource<'_>) -> Option<Vec<u8>>;
    /// Keeps bytes for this source.
    fn write(&self, source: &MapSource<'_>, bytes: &[u8]);
}

/// The kinds of maps that are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapKind {
    /// The grasps of a library.
    Grasps,
    /// The further grasps of a library, for the second search.
    FurtherGrasps,
    /// The solutions that plans of a task family start from.
    WarmStarts,
}

/// A map: its kind, and everything that it is made from but the program.
#[derive(Clone, Copy, Debug)]
pub struct MapSource<'a> {
    /// Its kind.
    pub kind: MapKind,
    /// The robot, its linkage grippers at the board's thickness.
    pub robot: &'a Robot,
    /// The shape of the board.
    pub board: &'a BoardShape,
    /// Clearance of the robot, m.
    pub clearance_m: f64,
    /// The scenario that all tasks of the family share; `None` for a map that knows no task.
    pub task: Option<&'a Scenario>,
}

/// A map in words, for a list.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, serde::Deserialize)]
pub struct MapLabel {
    /// What it is.
    pub map: String,
    /// The robot's name or description.
    pub robot: String,
    /// The board.
    pub board: String,
    /// The kind of task; empty for a map that knows no task.
    pub task: String,
}

impl MapSource<'_> {
    /// Writes everything that the map is made from as text, every number exactly. Two sources with the same text have the same map.
    /// Names of files are left out, so that a map serves wherever the robot's description is.
    ///
    /// # Errors
    /// Those of `text`.
    pub fn write_inputs(&self, text: &mut dyn fmt::Write) -> fmt::Result {
        let Self { kind, robot, board, clearance_m, task } = self;
        write!(text, "{kind:?} {board:?} {clearance_m:?} ")?;
        write_robot(text, robot)?;
        let nameless = |scenario: &Scenario| Scenario {
            name: String::new(),
            robot: RobotParameters { description: String::new(), packages: Vec::new(), ..scenario.robot.clone() },
            ..scenario.clone()
        };
        write!(text, "{:?}", task.map(nameless))
    }

    /// The map in words.
    #[must_use]
    pub fn label(&self) -> MapLabel {
        let map = match self.kind {
            MapKind::Grasps => "grasps",
            MapKind::FurtherGrasps => "further grasps",
            MapKind::WarmStarts => "warm starts",
        };
        let [x, y, z] = self.board.size_m.map(|side_m| (side_m * 1e4).round() / 10.0);
        let plate = if self.board.plate.is_some() { ", a plate" } else { "" };
        MapLabel {
            map: map.into(),
            robot: self.robot.description.clone(),
            board: format!("{x} x {y} x {z} mm{plate}"),
            task: self.task.map(task_in_words).unwrap_or_default(),
        }
    }
}

/// The kind of task of a family: `drill 15 N, natural posture, comfort`.
fn task_in_words(scenario: &Scenario) -> String {
    let force_n = (scenario.operation.wrench_o.force_n.norm() * 10.0).round() / 10.0;
    let posture = if scenario.human.posture.is_natural() { "natural posture" } else { "any posture" };
    let budget = match scenario.planner.budget {
        Budget::Fast => ", fast",
        Budget::Default => "",
        Budget::Exhaustive => ", exhaustive",
    };
    let seed = match scenario.planner.seed {
        seed if seed == PlannerSettings::default().seed => String::new(),
        seed => format!(", seed {seed}"),
    };
    format!("{} {force_n} N, {posture}, {}{budget}{seed}", scenario.operation.kind, scenario.planner.kind)
}

/// A robot without names of files and without what is only seen. A field that is new must be written or left out here.
///
/// # Errors
/// Those of `text`.
pub fn write_robot(text: &mut dyn fmt::Write, robot: &Robot) -> fmt::Result {
    let Robot {
        description: _,
        links,
        x_wr,
        joints,
        arms,
        allowed_collisions,
        body_points,
        floor_z_m,
        search_box,
        with_linkages,
        // In the positions of the joints.
        options: _,
        notes: _,
        files: _,
    } = robot;
    for Link { name, parent_joint, mass_kg, com_l, inertia_l, shapes, visuals: _ } in links {
        write!(text, "{name:?} {parent_joint:?} {mass_kg:?} {com_l:?} {inertia_l:?} {shapes:?} ")?;
    }
    write!(text, "{x_wr:?} {joints:?} {arms:?} {allowed_collisions:?} {body_points:?} {floor_z_m:?} {search_box:?} ")?;
    with_linkages.as_ref().map_or(Ok(()), |robot| write_robot(text, robot))
}

/// What a store has for a source, if it can be read to its last byte; numbers are exactly those that were written.
pub fn read<T: DeserializeOwned>(store: Option<&dyn MapStore>, source: &MapSource<'_>) -> Option<T> {
    let bytes = store?.read(source)?;
    let MapLabel { map, robot, board, .. } = source.label();
    tracing::info!(map, robot, board, bytes = bytes.len(), "found a kept map");
    postcard::take_from_bytes(&bytes).ok().filter(|(_, rest)| rest.is_empty()).map(|(map, _)| map)
}

/// Gives a store what was made for a source.
pub fn write<T: Serialize>(store: Option<&dyn MapStore>, source: &MapSource<'_>, map: &T) {
    // Serialisation fails only for types whose length is not known.
    if let Some((store, bytes)) = store.zip(postcard::to_stdvec(map).ok()) {
        let MapLabel { map, robot, board, .. } = source.label();
        tracing::info!(map, robot, board, bytes = bytes.len(), "made a map");
        store.write(source, &bytes);
    }
}
