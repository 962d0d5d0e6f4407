//! What a robot can grasp and which postures suit a person, computed once for many plans.
//!
//! Nothing here knows the task: a grasp library depends on the robot and the board's size alone, a posture map on the
//! person, the tool and its load. Candidates are pairs of the two ([`super::screen`]).

mod board_grasps;
mod direction;
mod draws;
mod entry;
mod failures;
mod grasp;
mod grasping_robot;
mod grasps;
mod palm;
mod postures;
mod reach;
mod resample;

pub use board_grasps::{grasps_of_board, grasps_on_any_edges};
pub use draws::draw_grasp;
pub use entry::LibraryEntry;
pub use grasp::{ArmGrasp, BoardGrasp, GraspPattern, largest_joint_difference_rad, pattern};
pub use grasping_robot::{GraspingArm, GraspingRobot};
pub use grasps::GraspLibrary;
pub use postures::{COARSE_POINTS, MEDIUM_POINTS, Posture, PostureLoad, PostureMap, posture_muscular, within_strength};
pub use resample::{grasps_for, resample};
