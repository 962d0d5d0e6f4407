//! Export of the scene as MJCF, the file format of MuJoCo, to check a verdict in another engine
//! (docs/method.md#77-the-scene-for-mujoco).
//!
//! Bodies, joints, servo gains, grip forces, pads and board are those of the scene, from the same data. The file is
//! complete: `tools/crosscheck.py` plays it and judges the result with nothing but what it contains. It must not
//! contain anything that only rapier needs.
//!
//! Contents beyond the model:
//! - solver settings and the compliance of every contact, the same as here (`contacts.rs`);
//! - six motors at the board's site `tool`, in O axes, that apply the tool's wrench (`actuators.rs`);
//! - the key frame `planned`: the planned state; its controls are those after the hand-over of the board: the servos'
//!   rest angles `q + tau_ff / K` with the torque that they feed forward for arm and board, and the grip forces;
//!   `loaded`: the same under the largest load;
//! - the load over time, phases, what the hand-over changes in the controls, limits and names as `<custom>` fields
//!   (`data.rs`), which MuJoCo stores without interpreting them;
//! - the robot's shapes, a floor, a light and a camera, which do not collide (`scenery.rs`).

mod actuators;
mod bodies;
mod contacts;
mod data;
mod document;
mod exported_arm;
mod scenery;
mod xml;

pub use document::mjcf;
