//! Writes the description of a robot from its URDF: finds arms and grippers, guesses pads, and samples which links may
//! overlap, where points lie on the surface and where boards can be held.
//!
//! The text is made in two passes. The first has the arms; loading it checks them and gives the robot from which the rest
//! is sampled. The second has all, and is loaded once more, so that what is written can be used.

mod draft;
mod hand;
mod hulls;
mod pairs;
mod place;
mod points;
mod skeleton;
mod srdf;
mod write;

use std::path::{Path, PathBuf};

pub use pairs::{AllowedPair, Overlaps, Reason, middle, positions};

use crate::{
    input::{self, MOST_URDF},
    robot::{BodyPoint, Robot, RobotError},
};
use write::{Names, Rest};

/// From what a description is written.
#[derive(Clone, Debug, Default)]
pub struct SetupInput {
    /// The URDF.
    pub urdf: PathBuf,
    /// An SRDF with pairs of links whose collisions are disabled.
    pub srdf: Option<PathBuf>,
    /// Folders that contain packages.
    pub packages: Vec<PathBuf>,
}

/// A written description.
#[derive(Debug)]
pub struct Setup {
    /// The text of the description.
    pub text: String,
    /// The robot that it describes.
    pub robot: Robot,
    /// The pairs of links that may overlap.
    pub allowed: Vec<AllowedPair>,
    /// Of each arm why it has a clamp in place of its fingers.
    pub clamps: Vec<(String, String)>,
}

/// Why no description was written.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The URDF cannot be used, or the description that was made from it.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The SRDF cannot be used.
    #[error("{file}: {problem}")]
    Srdf {
        /// The file.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// No arm was found.
    #[error(
        "{file}: found no run of at least five moving joints that could be an arm, expected one; a description by hand can name any"
    )]
    NoArm {
        /// The URDF.
        file: String,
    },
}

/// Writes the description of a robot for a file in `folder`.
///
/// # Errors
/// If the URDF or the SRDF cannot be used, or no arm is found.
pub fn setup(input: &SetupInput, folder: &Path) -> Result<Setup, SetupError> {
    let disabled = input.srdf.as_deref().map(read_srdf).transpose()?;
    let (bare, effort) = Robot::bare(&input.urdf, &input.packages)?;
    let arms = draft::arms(&bare, &effort);
    if arms.is_empty() {
        return Err(SetupError::NoArm { file: input.urdf.display().to_string() });
    }
    let urdf = relative(&input.urdf, folder);
    let packages: Vec<String> = input.packages.iter().map(|given| relative(given, folder)).collect();
    let names = Names { urdf: &urdf, packages: &packages };
    let load = |text: &str| Robot::from_text("new description", text, folder);
    let placeholder = BodyPoint { link: 0, p_l: nalgebra::Point3::origin() };
    let with = |yaw_deg: f64, decompose: &[usize]| {
        let body_points = vec![placeholder];
        let rest = Rest { yaw_deg, decompose: decompose.to_vec(), body_points, ..Rest::default() };
        load(&write::description(&bare, &names, &arms, &rest))
    };
    let yaw_deg = place::yaw_deg(&with(0.0, &[])?);
    let mut robot = with(yaw_deg, &[])?;
    let often = hulls::often(&robot);
    let mut decompose = hulls::in_the_way(&robot, &often);
    if !decompose.is_empty() {
        decompose = hulls::worth_decomposing(&robot, &often, &with(yaw_deg, &decompose)?, &decompose);
        robot = with(yaw_deg, &decompose)?;
    }
    let floor_z_m = place::floor_z_m(&robot);
    robot.floor_z_m = floor_z_m.0;
    let rest = Rest {
        yaw_deg,
        decompose,
        floor_z_m,
        search_box: place::search_box(&robot),
        allowed: pairs::allowed(&robot, disabled.as_deref()),
        body_points: points::body_points(&robot),
    };
    let clamps = arms.iter().filter_map(|arm| Some((arm.name.clone(), arm.hand.remark.clone()?))).collect();
    // Links that the description adds come after those of the URDF, so indices are the same in both.
    let text = write::description(&robot, &names, &arms, &rest);
    Ok(Setup { robot: load(&text)?, text, allowed: rest.allowed, clamps })
}

fn read_srdf(path: &Path) -> Result<Vec<[String; 2]>, SetupError> {
    let file = path.display().to_string();
    let text = input::text(path, MOST_URDF)
        .map_err(|error| SetupError::Srdf { file: file.clone(), problem: format!("failed to read: {error}") })?;
    srdf::disabled_pairs(&text).map_err(|problem| SetupError::Srdf { file, problem })
}

/// A path as a file in a folder names it: without the folder if it is in it, else the absolute path.
fn relative(path: &Path, folder: &Path) -> String {
    let absolute = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let (path, folder) = (absolute(path), absolute(here));
    path.strip_prefix(&folder).map_or_else(|_| path.display().to_string(), |inside| inside.display().to_string())
}
