//! The description file of a robot: arms, grippers and other data that a URDF does not have, in TOML.
//!
//! This file defines the format; [`super::assemble`] checks the entries against the URDF.

use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::tree::RobotError;
use crate::model::FORMAT;

/// A text with the name of its file, for messages.
pub(super) struct Source<'a> {
    pub file: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// An error at a position of this text.
    pub fn error(&self, span: Range<usize>, problem: &str) -> RobotError {
        let line = 1 + self.text.bytes().take(span.start).filter(|&byte| byte == b'\n').count();
        RobotError::Invalid { file: self.file.into(), problem: format!("line {line}: {problem}") }
    }
}

/// A description file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Description {
    pub format: Spanned<u32>,
    pub urdf: Spanned<String>,
    pub floor_z_m: Spanned<f64>,
    pub arms: Spanned<Vec<ArmEntry>>,
    #[serde(default)]
    pub allowed_collisions: Vec<Spanned<[String; 2]>>,
    pub body_points: Spanned<Vec<PointEntry>>,
}

/// An arm entry.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ArmEntry {
    pub name: Spanned<String>,
    pub base_link: Spanned<String>,
    pub joints: Spanned<Vec<Spanned<String>>>,
    pub effort_nm: Option<Spanned<Vec<f64>>>,
    pub stiffness_nm_rad: Spanned<Vec<f64>>,
    pub damping_nm_s_rad: Spanned<Vec<f64>>,
    pub gripper: GripperEntry,
}

/// A gripper entry.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GripperEntry {
    pub frame_link: Spanned<String>,
    pub palm_link: Spanned<String>,
    pub opening_m: Spanned<[f64; 2]>,
    pub max_force_n: Spanned<f64>,
    pub pad_size_m: Spanned<[f64; 2]>,
    pub pad_centre_m: Spanned<[f64; 2]>,
    pub pad_stiffness_n_m: Option<Spanned<f64>>,
    pub fingers: Spanned<[FingerEntry; 2]>,
}

/// A finger entry.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FingerEntry {
    pub name: String,
    pub joint: Spanned<String>,
    pub pad_link: Spanned<String>,
}

/// An entry of a point on the robot's surface.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointEntry {
    pub link: Spanned<String>,
    pub p_m: Spanned<[f64; 3]>,
}

impl Description {
    pub fn read(source: &Source) -> Result<Self, RobotError> {
        let description: Self = toml::from_str(source.text)
            .map_err(|error| source.error(error.span().unwrap_or_default(), error.message()))?;
        let format = *description.format.get_ref();
        if format != FORMAT {
            let problem = format!("format: found {format}, expected {FORMAT}");
            return Err(source.error(description.format.span(), &problem));
        }
        Ok(description)
    }
}
