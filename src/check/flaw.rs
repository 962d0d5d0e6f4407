//! What can be wrong with a plan.

use std::fmt;

use super::{
    bounds,
    tolerances::{GIVEN, ON_BOARD_M, PoseTolerance},
};
use crate::{
    human::{HumanError, Standing},
    model::{
        plan::{ExceededScore, PostureConstraint, PostureFigure},
        plate::{PlateFault, PlatePart},
    },
};

/// One fault of a plan: its key, what was found and what was expected.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Flaw {
    /// A side of the board out of range, m.
    BoardSide {
        /// 0 to 2: along x_O, y_O, z_O.
        axis: usize,
        /// The side, m.
        found_m: f64,
        /// Its range, m.
        range_m: [f64; 2],
    },
    /// An outline or a hole of the plate.
    Plate(PlateFault),
    /// A stated size of the plate that is not that of its outline.
    PlateSize {
        /// Width and height, m.
        found_m: [f64; 2],
        /// Those of the outline, m.
        expected_m: [f64; 2],
    },
    /// A centre of mass outside the board.
    CentreOfMass {
        /// In O, m.
        found_m: [f64; 3],
    },
    /// The tool point is outside the outline of a plate, or in a hole.
    ToolOffPlate {
        /// The point in O, m.
        found_m: [f64; 2],
        /// Its distance from the material, negative, m.
        depth_m: f64,
    },
    /// A pad that is not wholly on the plate's material.
    PadOffPlate {
        /// Index in the plan's `arms`.
        arm: usize,
        /// How far it is off, m.
        off_m: f64,
    },
    /// The board's mass is not a positive number.
    BoardMass {
        /// The mass, kg.
        found_kg: f64,
    },
    /// A component of the operation's wrench is not finite or beyond [`bounds`].
    Wrench {
        /// Force, N, and moment, N m.
        found: [f64; 6],
    },
    /// A drill whose force does not push along its axis into the board.
    Pull {
        /// The force along z_T, N.
        found_n: f64,
    },
    /// The tip of a drill or of a knife is on no face of the board.
    TipInside {
        /// Its depth below the nearest face, m.
        depth_m: f64,
    },
    /// The tool point is off the board.
    ToolPoint {
        /// The point in O, m.
        found_m: [f64; 3],
        /// Half of the board's sides, m.
        half_sides_m: [f64; 3],
    },
    /// No arm holds the board.
    NoArm,
    /// An arm that the robot does not have.
    UnknownArm {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Its name.
        found: String,
        /// The robot's arms.
        known: Vec<String>,
    },
    /// An arm that occurs twice.
    ArmTwice {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Its name.
        found: String,
    },
    /// Joints that are not the arm's, or in another order.
    Joints {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Its name.
        name: String,
        /// The plan's joints.
        found: Vec<String>,
        /// The arm's joints.
        expected: Vec<String>,
    },
    /// A wrong number of angles.
    AngleCount {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Number of angles.
        found: usize,
        /// Number of joints.
        expected: usize,
    },
    /// An angle beyond its joint's limits, or not a number.
    Angle {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Index of the joint in the arm.
        joint: usize,
        /// The joint's name.
        name: String,
        /// The angle, rad.
        found_rad: f64,
        /// The joint's limits, rad.
        limits_rad: [f64; 2],
    },
    /// A grip force that is not positive, or more than the gripper exerts.
    GripForce {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Its name.
        name: String,
        /// The force, N.
        found_n: f64,
        /// The gripper's largest force, N; `None` for a gripper with measured wrench limits.
        max_n: Option<f64>,
    },
    /// A board that the gripper does not close on.
    Thickness {
        /// Name of the arm.
        name: String,
        /// Thickness, m.
        found_m: f64,
        /// The gripper's opening, m.
        opening_m: [f64; 2],
    },
    /// Fingers that do not close across the board's thickness.
    FingersAcross {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Distance of G from the board's middle plane, m.
        off_m: f64,
        /// Angle between the finger axis and the board's normal, rad.
        off_rad: f64,
    },
    /// A suction cup whose lip does not lie flat on a face of the board.
    CupOffFace {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Distance of the lip's centre from the face, m.
        off_m: f64,
        /// Angle between z_G and the normal into the board, rad.
        off_rad: f64,
    },
    /// A suction cup whose lip reaches over the edge of the board or over a hole.
    CupOffBoard {
        /// Index in the plan's `arms`.
        arm: usize,
        /// How far, m.
        off_m: f64,
    },
    /// Joint angles that put the gripper elsewhere than X_WO X_OG.
    Hand {
        /// Index in the plan's `arms`.
        arm: usize,
        /// Its name.
        name: String,
        /// Distance, m.
        off_m: f64,
        /// Angle, rad.
        off_rad: f64,
        /// The tolerance that they exceed.
        tolerance: PoseTolerance,
    },
    /// The person or the tool is invalid.
    Person(HumanError),
    /// The person's pose is not finite.
    PersonPose {
        /// The position, m.
        found_m: [f64; 3],
    },
    /// An angle of the person's arm beyond its limits, or not a number.
    PersonAngle {
        /// Index of the joint.
        joint: usize,
        /// The angle, rad.
        found_rad: f64,
        /// The joint's limits, rad.
        limits_rad: [f64; 2],
    },
    /// The upper arm's twist or elevation beyond the shoulder's limits.
    PersonShoulder {
        /// `twist` or `elevation`.
        what: &'static str,
        /// The angle, rad.
        found_rad: f64,
        /// Its limits, rad.
        limits_rad: [f64; 2],
    },
    /// The person's arm puts the tool elsewhere than X_WO X_OT.
    Tool {
        /// Distance, m.
        off_m: f64,
        /// Angle, rad.
        off_rad: f64,
        /// The tolerance that they exceed.
        tolerance: PoseTolerance,
    },
    /// The person does not stand upright on the floor.
    Standing {
        /// Height above the floor, m.
        off_m: f64,
        /// Tilt against the vertical, rad.
        off_rad: f64,
        /// The tolerance that they exceed.
        tolerance: PoseTolerance,
    },
    /// Two bodies touch or are closer than their clearance.
    Contact(String),
    /// A joint of the person needs more than its strength.
    Strength {
        /// The largest activation.
        found: f64,
    },
    /// The person does not stand naturally, or does not see the work.
    Posture {
        /// The limit.
        constraint: PostureConstraint,
        /// The figure and its limits.
        figure: PostureFigure,
    },
    /// A score of the person's posture beyond the scenario's limit.
    Score(ExceededScore),
    /// The person stands elsewhere than the scenario says.
    Place {
        /// Where the plan puts them.
        found: Standing,
        /// Where the scenario does.
        expected: Standing,
    },
    /// The person has no response on the grid of the mean.
    NoResponse,
    /// There is no equilibrium under the load.
    NoEquilibrium,
    /// The contact model refuses the grasp.
    ContactModel(String),
    /// The plan lacks figures that are to be verified.
    Missing {
        /// What is missing.
        key: &'static str,
    },
    /// A figure of stability or a score of the posture beyond the scenario's limit.
    Limit {
        /// The figure's key.
        key: &'static str,
        /// Its recomputed value.
        found: f64,
        /// The limit.
        limit: f64,
    },
    /// A figure of the posture that differs from the recomputed one.
    OtherPosture {
        /// The figure.
        constraint: PostureConstraint,
        /// As the plan states it.
        stated: f64,
        /// As it is recomputed.
        computed: f64,
    },
    /// A stated figure that differs from the recomputed one.
    Figure {
        /// The figure's key.
        key: &'static str,
        /// As the plan states it.
        stated: f64,
        /// As it is recomputed.
        computed: f64,
    },
}

impl Flaw {
    /// The plan's key that is at fault.
    #[must_use]
    pub fn key(&self) -> String {
        match self {
            Self::BoardSide { axis, .. } => format!("object.size_m[{axis}]"),
            Self::Thickness { .. } => "object.size_m[2]".into(),
            Self::Plate(PlateFault { part, .. }) => match part {
                PlatePart::Outline => "object.plate.outline_m".into(),
                PlatePart::Corner(corner) => format!("object.plate.outline_m[{corner}]"),
                PlatePart::Holes => "object.plate.holes_m".into(),
                PlatePart::Hole(hole) => format!("object.plate.holes_m[{hole}]"),
            },
            Self::PlateSize { .. } => "object.size_m".into(),
            Self::CentreOfMass { .. } => "object.com_m".into(),
            Self::BoardMass { .. } => "object.mass_kg".into(),
            Self::Wrench { .. } | Self::Pull { .. } => "operation.wrench_o".into(),
            Self::ToolPoint { .. } | Self::ToolOffPlate { .. } | Self::TipInside { .. } => "operation.x_ot".into(),
            Self::NoArm => "arms".into(),
            Self::UnknownArm { arm, .. } | Self::ArmTwice { arm, .. } => format!("arms[{arm}].name"),
            Self::Joints { arm, .. } => format!("arms[{arm}].joints"),
            Self::AngleCount { arm, .. } => format!("arms[{arm}].q_rad"),
            Self::Angle { arm, joint, .. } => format!("arms[{arm}].q_rad[{joint}]"),
            Self::GripForce { arm, .. } => format!("arms[{arm}].grip_force_n"),
            Self::FingersAcross { arm, .. }
            | Self::CupOffFace { arm, .. }
            | Self::CupOffBoard { arm, .. }
            | Self::Hand { arm, .. }
            | Self::PadOffPlate { arm, .. } => format!("arms[{arm}].x_og"),
            Self::Person(_) => "human".into(),
            Self::PersonPose { .. } | Self::Standing { .. } => "human.x_wb".into(),
            Self::PersonAngle { joint, .. } => format!("human.q_rad[{joint}]"),
            Self::Tool { .. } | Self::PersonShoulder { .. } => "human.q_rad".into(),
            Self::Contact(_) => "object.x_wo".into(),
            Self::Strength { .. } => "comfort.activations".into(),
            Self::Posture { constraint, .. } | Self::OtherPosture { constraint, .. } => {
                format!("human.posture.{}", constraint.key())
            }
            Self::Place { .. } => "human.x_wb".into(),
            Self::Score(exceeded) => exceeded.score.key().into(),
            Self::NoResponse => "comfort.average".into(),
            Self::NoEquilibrium | Self::ContactModel(_) => "stability".into(),
            Self::Missing { key } | Self::Limit { key, .. } | Self::Figure { key, .. } => (*key).into(),
        }
    }

    /// The name of a flaw for which there is no simulation: `not_visible` if the person does not see the work, `not_natural` if
    /// they would not stand so or a score of the posture is too high, `not_there` if they stand elsewhere; `None` for all others.
    #[must_use]
    pub fn verdict_name(&self) -> Option<&'static str> {
        match self {
            Self::Posture { constraint, .. } if constraint.is_of_sight() => Some("not_visible"),
            Self::Posture { .. } | Self::Score(_) => Some("not_natural"),
            Self::Place { .. } => Some("not_there"),
            _ => None,
        }
    }

    /// What was found.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            Self::BoardSide { found_m, .. } | Self::Thickness { found_m, .. } => found_m.to_string(),
            Self::BoardMass { found_kg } => found_kg.to_string(),
            Self::Plate(fault) => fault.found.clone(),
            Self::PlateSize { found_m, .. } => format!("{found_m:?}"),
            Self::CentreOfMass { found_m } => format!("{found_m:?}"),
            Self::ToolOffPlate { found_m: [x_m, y_m], depth_m } => off_material(*x_m, *y_m, *depth_m),
            Self::PadOffPlate { off_m, .. } => format!("a pad {:.1} mm off the plate's material", off_m * 1e3),
            Self::Wrench { found } => format!("{found:?}"),
            Self::Pull { found_n } => format!("{found_n} N along the drill's axis z_T"),
            Self::TipInside { depth_m } => format!("a tool tip {:.2} mm inside the board", depth_m * 1e3),
            Self::ToolPoint { found_m: [x, y, z], half_sides_m } => {
                if is_off(*z, half_sides_m[2]) {
                    format!("z = {z}")
                } else {
                    format!("[{x}, {y}]")
                }
            }
            Self::NoArm => "no arm".into(),
            Self::UnknownArm { found, .. } => format!("\"{found}\""),
            Self::ArmTwice { found, .. } => format!("\"{found}\" again"),
            Self::Joints { found, .. } => found.join(", "),
            Self::AngleCount { found, .. } => found.to_string(),
            Self::Angle { found_rad, .. } | Self::PersonAngle { found_rad, .. } => found_rad.to_string(),
            Self::GripForce { found_n, .. } => found_n.to_string(),
            Self::FingersAcross { off_m, off_rad, .. } => {
                format!("fingers {} off the board's middle plane", GIVEN.deviation([*off_m, *off_rad]))
            }
            Self::CupOffFace { off_m, off_rad, .. } => {
                format!("a suction cup {} off a face of the board", GIVEN.deviation([*off_m, *off_rad]))
            }
            Self::CupOffBoard { off_m, .. } => format!("a suction cup {:.1} mm off the material", off_m * 1e3),
            Self::Hand { off_m, off_rad, tolerance, .. } => {
                format!("the gripper {} from where q_rad puts it", tolerance.deviation([*off_m, *off_rad]))
            }
            Self::Person(error) => error.to_string(),
            Self::PersonPose { found_m } => format!("a position of {found_m:?}"),
            Self::PersonShoulder { what, found_rad, .. } => {
                format!("the upper arm at {found_rad} rad of {what}")
            }
            Self::Tool { off_m, off_rad, tolerance } => {
                format!("the tool {} off the operation", tolerance.deviation([*off_m, *off_rad]))
            }
            Self::Standing { off_m, off_rad, tolerance } => {
                format!("feet {} off the floor and the vertical", tolerance.deviation([*off_m, *off_rad]))
            }
            Self::Contact(contact) => contact.clone(),
            Self::Strength { found } => format!("an activation of {found}"),
            Self::Posture { constraint, figure } => format!("{:.3}, {}", figure.value, constraint.broken()),
            Self::Score(exceeded) => exceeded.found.to_string(),
            Self::Place { found, .. } => describe(found),
            Self::NoResponse => "no response on the grid".into(),
            Self::NoEquilibrium => "a grasp that does not resist the load".into(),
            Self::ContactModel(error) => error.clone(),
            Self::Missing { .. } => "nothing".into(),
            Self::Limit { found, .. } => found.to_string(),
            Self::OtherPosture { stated, .. } | Self::Figure { stated, .. } => stated.to_string(),
        }
    }

    /// What was expected.
    #[must_use]
    pub fn expected(&self) -> String {
        match self {
            Self::BoardSide { range_m: [low, high], .. } => format!("a number from {low} to {high} (m)"),
            Self::Thickness { name, opening_m: [closed, open], .. } => {
                format!("a thickness that the {name} gripper closes on: {closed} to {open} m")
            }
            Self::BoardMass { .. } => format!("a positive number up to {} (kg)", bounds::MOST_MASS_KG),
            Self::Plate(fault) => fault.expected.clone(),
            Self::PlateSize { expected_m, .. } => format!("{expected_m:?}, the size of the outline (m)"),
            Self::CentreOfMass { .. } => "a point within the outline and the thickness of the board".into(),
            Self::ToolOffPlate { .. } => ON_MATERIAL.into(),
            Self::PadOffPlate { .. } => "pads inside the outline and off the convex hulls of the holes".into(),
            Self::Wrench { .. } => bounds::wrench_in_words(),
            Self::Pull { .. } => "a force that pushes into the board: more than 0".into(),
            Self::TipInside { .. } => format!("a tip on a face of the board, within {:.0} mm", GIVEN.position_m * 1e3),
            Self::ToolPoint { found_m, half_sides_m } => point_on_board(found_m, half_sides_m),
            Self::NoArm => "at least one".into(),
            Self::UnknownArm { known, .. } => format!("an arm of the robot: {}", known.join(", ")),
            Self::ArmTwice { .. } => "every arm once".into(),
            Self::Joints { name, expected, .. } => format!("the joints of the {name} arm: {}", expected.join(", ")),
            Self::AngleCount { expected, .. } => format!("{expected} angles in rad"),
            Self::Angle { name, limits_rad: [low, high], .. } => format!("{low} to {high} rad, the limits of {name}"),
            Self::GripForce { name, found_n, max_n, .. } => expected_grip(name, *found_n, *max_n),
            Self::FingersAcross { .. } => format!("fingers that close across the thickness, within {GIVEN}"),
            Self::CupOffFace { .. } => {
                format!("the origin of G on a face and z_G along its normal into the board, within {GIVEN}")
            }
            Self::CupOffBoard { .. } => "a lip inside the outline and off the convex hulls of the holes".into(),
            Self::Hand { tolerance, .. } => {
                format!("x_wo x_og to equal the arm's forward kinematics within {tolerance}")
            }
            Self::Person(_) => "a valid person and tool".into(),
            Self::PersonPose { .. } => format!("numbers from -{0} to {0} (m)", bounds::MOST_PLACE_M),
            Self::PersonAngle { joint, limits_rad: [low, high], .. } => {
                format!("{low} to {high} rad, the limits of the person's joint q{}", joint + 1)
            }
            Self::PersonShoulder { what, limits_rad: [low, high], .. } => {
                format!("{low} to {high} rad, the shoulder's range of {what}")
            }
            Self::Tool { tolerance, .. } => {
                format!("x_wo x_ot to equal the person's forward kinematics within {tolerance}")
            }
            Self::Standing { tolerance, .. } => format!("a person who stands upright on the floor within {tolerance}"),
            Self::Contact(_) => "bodies that keep their clearances".into(),
            Self::Strength { .. } => "at most 1".into(),
            Self::Posture { figure, .. } => figure.limits_in_words().unwrap_or_else(|| "any value".into()),
            Self::Score(exceeded) => format!("at most {}", exceeded.limit),
            Self::Place { expected, .. } => format!("the scenario's {}", describe(expected)),
            Self::NoResponse => "at least one response".into(),
            Self::NoEquilibrium | Self::ContactModel(_) => "a stable grasp".into(),
            Self::Missing { .. } => "a value to verify".into(),
            Self::Limit { limit, .. } => format!("the limit {limit}"),
            Self::OtherPosture { computed, .. } | Self::Figure { computed, .. } => {
                format!("{computed}, as recomputed")
            }
        }
    }
}

/// What is expected of a tool point off a box: along its thickness if that is wrong, else along its sides.
fn point_on_board(found_m: &[f64; 3], [x, y, z]: &[f64; 3]) -> String {
    if is_off(found_m[2], *z) {
        format!("a point on the board: |z| <= {z} m")
    } else {
        format!("a point on the board: |x| <= {x} m, |y| <= {y} m")
    }
}

/// What is expected of a tool point on a plate.
pub const ON_MATERIAL: &str = "a point of the plate, inside its outline and outside its holes";

/// A tool point that is off the material of a plate, in words; `depth_m` as [`Plate::depth_m`](crate::model::plate::Plate::depth_m) has it.
#[must_use]
pub fn off_material(x_m: f64, y_m: f64, depth_m: f64) -> String {
    format!("[{x_m}, {y_m}], {:.2} mm off the material", -depth_m * 1e3)
}

/// A standing pose in words.
fn describe(Standing { p_wb_m: [x_m, y_m], heading_rad }: &Standing) -> String {
    format!("place ({x_m:.3}, {y_m:.3}) m with a heading of {:.1} degrees", heading_rad.to_degrees())
}

/// True if a coordinate of the tool point is off the board; true if it is not a number.
fn is_off(p_m: f64, half_side_m: f64) -> bool {
    p_m.is_nan() || p_m.abs() - half_side_m > ON_BOARD_M
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: found {}, expected {}", self.key(), self.found(), self.expected())
    }
}

/// All faults of a plan, at least one: those of board and operation, then those of each arm, then those of the person.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaws {
    first: Flaw,
    others: Vec<Flaw>,
}

/// What a grip force should have been, of a gripper that gives so much, or that has measured wrench limits.
fn expected_grip(name: &str, found_n: f64, max_n: Option<f64>) -> String {
    match max_n {
        None => format!("no grip force: the {name} gripper has measured wrench limits"),
        Some(max_n) if found_n > 0.0 => format!("at most {max_n} N, what the {name} gripper gives"),
        Some(_) => "a positive number (N)".into(),
    }
}

impl Flaws {
    /// These flaws; `None` without any.
    #[must_use]
    pub fn of(flaws: Vec<Flaw>) -> Option<Self> {
        let mut flaws = flaws.into_iter();
        flaws.next().map(|first| Self { first, others: flaws.collect() })
    }

    /// The first one.
    #[must_use]
    pub fn first(&self) -> &Flaw {
        &self.first
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Flaw> {
        std::iter::once(&self.first).chain(&self.others)
    }
}

impl fmt::Display for Flaws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.first)?;
        self.others.iter().try_for_each(|flaw| write!(f, "; {flaw}"))
    }
}

impl std::error::Error for Flaws {}
