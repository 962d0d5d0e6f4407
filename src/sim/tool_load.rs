//! The tool's wrench on the board over the steps of a simulation (docs/method.md#73-applied-load).

use std::f64::consts::TAU;

use nalgebra::{UnitQuaternion, Vector3};

use super::{conditions::Conditions, error::SimError, phases::PhaseSchedule};
use crate::{
    check::CheckedPlan,
    model::{
        frames::Pose,
        load::{BREAKTHROUGH_S, ForceFrame, ForceProfile},
        operation::Operation,
        scenario::SimulationSettings,
        trace::Phase,
        wrench::Wrench,
    },
};

/// The state of the tool in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ToolState {
    /// The multiple of the profile's wrench.
    pub load_factor: f64,
    /// The wrench about the tool point, in O axes; in the planned board's axes if the load's frame is the world.
    pub wrench_o: Wrench,
    /// The tool point in O, m.
    pub p_ot_m: Vector3<f64>,
}

/// The tool's wrench over the steps of a simulation.
pub(super) struct ToolLoad<'a> {
    phases: PhaseSchedule,
    profile: &'a ForceProfile,
    operation: Operation,
    /// The sideways push at load factor 1, if there is one: about the tool tip, O axes.
    lateral_o: Option<Wrench>,
    scale: f64,
    /// Tilt of the tool, O axes.
    tilt_o: UnitQuaternion<f64>,
    timestep_s: f64,
    /// Magnitude of the largest row of a measured profile.
    largest: f64,
}

/// Magnitude of a row's force, or of its moment if `force` is false.
fn size(row: &[f64; 7], force: bool) -> f64 {
    let first = if force { 1 } else { 4 };
    Vector3::from_column_slice(&row[first..first + 3]).norm()
}

impl<'a> ToolLoad<'a> {
    /// The load of a plan's operation under these conditions.
    ///
    /// # Errors
    /// [`SimError::Settings`] if phases or time step are invalid, [`SimError::Profile`] if the profile is.
    pub fn new(checked: &'a CheckedPlan<'a>, conditions: &'a Conditions) -> Result<Self, SimError> {
        let plan = checked.plan();
        let profile = &conditions.load.profile;
        check(profile, &plan.operation)?;
        let largest = match profile {
            ForceProfile::Measured { samples } => largest(samples),
            _ => 1.0,
        };
        let of = &conditions.uncertainty;
        let ramp_s = conditions.settings.ramp_s * of.ramp_scale;
        Ok(Self {
            phases: PhaseSchedule::new(&SimulationSettings { ramp_s, ..conditions.settings })?,
            profile,
            tilt_o: of.tilt_o(&plan.operation),
            operation: of.operation(&plan.operation),
            lateral_o: conditions.lateral_push(checked).map(|push| push.wrench_o()),
            scale: conditions.load_scale * of.force_scale,
            timestep_s: conditions.settings.timestep_s,
            largest,
        })
    }

    /// The number of steps.
    pub fn steps(&self) -> usize {
        self.phases.steps()
    }

    /// The phase and the state of the tool in a step. Steps count from 1; 0 is the initial state.
    pub fn at(&self, step: usize) -> (Phase, ToolState) {
        let (phase, ramp) = self.phases.at(step);
        let loaded_s = step.saturating_sub(self.phases.settle_steps()) as f64 * self.timestep_s;
        let held_s =
            step.saturating_sub(self.phases.settle_steps() + self.phases.ramp_steps()) as f64 * self.timestep_s;
        let still =
            ToolState { load_factor: 0.0, wrench_o: Wrench::default(), p_ot_m: self.operation.x_ot.translation.vector };
        let state = match phase {
            Phase::Ramp | Phase::Hold => self.acting(ramp, loaded_s, held_s),
            _ => still,
        };
        (phase, state)
    }

    /// The operation's wrench with the sideways push, about the tool tip, O axes.
    fn pushed_o(&self) -> Wrench {
        let wrench_o = self.operation.wrench_o;
        self.lateral_o.map_or(wrench_o, |lateral_o| wrench_o + lateral_o)
    }

    fn acting(&self, ramp: f64, loaded_s: f64, held_s: f64) -> ToolState {
        let x_ot = &self.operation.x_ot;
        let force_n = self.operation.wrench_o.force_n;
        let wrench_o = self.pushed_o();
        let p_ot_m = x_ot.translation.vector;
        let z_t = x_ot.rotation * Vector3::z();
        let (share, whole, p_ot_m) = match self.profile {
            ForceProfile::Ramp => (ramp, wrench_o, p_ot_m),
            &ForceProfile::Drill { spindle_torque_nm, vibration_n, vibration_hz, breakthrough_s } => {
                let shake_n = vibration_n * libm::sin(TAU * vibration_hz * loaded_s);
                let whole = wrench_o + Wrench::new(z_t * shake_n, z_t * spindle_torque_nm);
                let left = breakthrough_s.map_or(1.0, |at_s| 1.0 - (held_s - at_s) / BREAKTHROUGH_S);
                (ramp * left.clamp(0.0, 1.0), whole, p_ot_m)
            }
            &ForceProfile::Path { speed_m_s, centre_m, normal_share } => {
                let turned_rad = ForceProfile::travel_angle_rad(speed_m_s, centre_m, &p_ot_m, &force_n, held_s);
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turned_rad);
                let centre = Vector3::new(centre_m[0], centre_m[1], 0.0);
                let pressed = Wrench::from_force(z_t * (normal_share * force_n.norm()));
                let whole = Wrench::new(turn * wrench_o.force_n, turn * wrench_o.moment_nm) + pressed;
                (ramp, whole, centre + turn * (p_ot_m - centre))
            }
            ForceProfile::Measured { samples } => {
                let (row, wrench_o) = interpolated(samples, loaded_s);
                let wrench_o = wrench_o.rotated(&self.tilt_o);
                let share = size(&row, samples.iter().any(|row| size(row, true) > 0.0)) / self.largest;
                return ToolState { load_factor: self.scale * share, wrench_o: wrench_o.scaled(self.scale), p_ot_m };
            }
        };
        let load_factor = self.scale * share;
        ToolState { load_factor, wrench_o: whole.scaled(load_factor), p_ot_m }
    }
}

/// Magnitude of the largest force of measured rows, or of the largest moment if there is no force.
fn largest(samples: &[[f64; 7]]) -> f64 {
    let of = |force: bool| samples.iter().map(|row| size(row, force)).fold(0.0, f64::max);
    if of(true) > 0.0 { of(true) } else { of(false) }
}

/// The measured row and wrench at a time, by linear interpolation.
fn interpolated(samples: &[[f64; 7]], time_s: f64) -> ([f64; 7], Wrench) {
    let next = samples.partition_point(|row| row[0] <= time_s);
    let row = match (next.checked_sub(1).map(|last| samples[last]), samples.get(next)) {
        (Some(a), Some(b)) => {
            let share = (time_s - a[0]) / (b[0] - a[0]);
            std::array::from_fn(|k| a[k] + share * (b[k] - a[k]))
        }
        (Some(a), None) => a,
        // Before the first row. `check` refuses a profile without rows.
        (None, b) => b.copied().unwrap_or_default(),
    };
    let [_, fx, fy, fz, mx, my, mz] = row;
    (row, Wrench::from([fx, fy, fz, mx, my, mz]))
}

/// # Errors
/// [`SimError::Profile`] if a value of the profile is not finite, or it does not match the operation.
fn check(profile: &ForceProfile, operation: &Operation) -> Result<(), SimError> {
    let refuse = |found: String, expected| Err(SimError::Profile { found, expected });
    match profile {
        ForceProfile::Ramp => Ok(()),
        ForceProfile::Drill { spindle_torque_nm, vibration_n, vibration_hz, breakthrough_s } => {
            let figures = [*spindle_torque_nm, *vibration_n, *vibration_hz, breakthrough_s.unwrap_or(0.0)];
            if figures.iter().all(|figure| figure.is_finite()) {
                return Ok(());
            }
            refuse(format!("{figures:?}"), "a drill's profile of finite figures")
        }
        ForceProfile::Path { speed_m_s, centre_m, normal_share } => {
            let p_ot_m = operation.x_ot.translation.vector;
            let radius_m = libm::hypot(p_ot_m.x - centre_m[0], p_ot_m.y - centre_m[1]);
            if speed_m_s.is_finite() && normal_share.is_finite() && radius_m.is_finite() && radius_m > 0.0 {
                return Ok(());
            }
            let found = format!("speed {speed_m_s} m/s, radius {radius_m} m, share {normal_share}");
            refuse(found, "a path of finite figures around a centre beside the tool point")
        }
        ForceProfile::Measured { samples } => {
            let finite = samples.iter().flatten().all(|figure| figure.is_finite());
            let ordered = samples.windows(2).all(|pair| pair[0][0] < pair[1][0]);
            if finite && ordered && largest(samples) > 0.0 {
                return Ok(());
            }
            refuse(format!("{} rows", samples.len()), "finite rows in the order of time, with some load")
        }
    }
}

/// The wrench in world axes for a board at `x_wo` that was planned at `x_wo_planned`.
pub(super) fn wrench_w(frame: ForceFrame, wrench_o: &Wrench, x_wo: &Pose, x_wo_planned: &Pose) -> Wrench {
    let rotation = match frame {
        ForceFrame::Board => x_wo.rotation,
        ForceFrame::World => x_wo_planned.rotation,
    };
    Wrench::new(rotation * wrench_o.force_n, rotation * wrench_o.moment_nm)
}
