//! The measured series of a trace.

use nalgebra::{Point3, Vector3};

use crate::model::{
    frames::Pose,
    measures::{HandMeasures, JointMeasures, Measures},
    trace::{Sample, Trace},
};

/// Slip, sag, deflection and torque ratios of the samples of a trace, the first of which is the hand-over and
/// `settled` the end of settling (docs/method.md#81-reference-states):
///
/// - slip of a hand: `|p_OC(t) - p_OC(0)|` and the angle of `R_OC(0)' R_OC(t)`, C at the centre between its pads;
/// - sag: `|X_WO(t) p_OT - X_WO(0) p_OT|` up to the end of settling, T the tool point there;
/// - deflection: `|X_WO(t) p_OT - X_WO(settled) p_OT|` from then on, T the tool point at that time;
/// - torque ratio of a joint: `|tau_demanded| / tau_max`;
/// - grip ratio of a measured gripper: that of its wrench to the limits;
/// - clearance: the distance of the robot from itself and from the board.
pub(super) fn measures(trace: &Trace, samples: &[Sample], settled: usize) -> Measures {
    let moved_mm = |sample: &Sample, since: &Sample, p_ot_m: Vector3<f64>| {
        let p_ot = Point3::from(p_ot_m);
        1e3 * (sample.x_wo * p_ot - since.x_wo * p_ot).norm()
    };
    let sag_mm = |index: usize| moved_mm(&samples[index.min(settled)], &samples[0], trace.p_ot_m);
    let deflection_mm = |sample: &Sample| moved_mm(sample, &samples[settled], sample.p_ot_m);
    Measures {
        time_s: samples.iter().map(|sample| sample.time_s).collect(),
        judged: 0,
        load_factor: samples.iter().map(|sample| sample.load_factor).collect(),
        hands: (0..trace.arms.len()).map(|arm| hand_measures(trace, samples, arm)).collect(),
        sag_mm: (0..samples.len()).map(sag_mm).collect(),
        deflection_mm: samples[..settled]
            .iter()
            .map(|_| 0.0)
            .chain(samples[settled..].iter().map(deflection_mm))
            .collect(),
        clearance_mm: clearance_mm(samples).unwrap_or_default(),
        joints: (0..trace.arms.len()).flat_map(|arm| joint_measures(trace, samples, arm)).collect(),
    }
}

/// The distance of the robot from itself and from the board, mm; `None` if it was not measured.
fn clearance_mm(samples: &[Sample]) -> Option<Vec<f64>> {
    samples.iter().map(|sample| sample.robot_clearance_m.map(|distance_m| 1e3 * distance_m)).collect()
}

fn hand_measures(trace: &Trace, samples: &[Sample], arm: usize) -> HandMeasures {
    let x_oc = |sample: &Sample| -> Pose { sample.arms[arm].x_oc };
    let start = x_oc(&samples[0]);
    HandMeasures {
        name: trace.arms[arm].name.clone(),
        slip_mm: samples
            .iter()
            .map(|sample| 1e3 * (x_oc(sample).translation.vector - start.translation.vector).norm())
            .collect(),
        grip_ratio: grip_ratio(trace, samples, arm),
        slip_deg: samples.iter().map(|sample| start.rotation.angle_to(&x_oc(sample).rotation).to_degrees()).collect(),
    }
}

/// The ratio of the wrench of a measured gripper to its limits; empty for a hand with pads.
fn grip_ratio(trace: &Trace, samples: &[Sample], arm: usize) -> Vec<f64> {
    let Some(limits) = &trace.arms[arm].wrench_limits else { return Vec::new() };
    let wrenches = samples.iter().map(|sample| sample.arms[arm].grip_wrench_g);
    wrenches.map(|wrench_g| wrench_g.map_or(0.0, |wrench_g| limits.ratio(&wrench_g))).collect()
}

fn joint_measures<'a>(trace: &'a Trace, samples: &'a [Sample], arm: usize) -> impl Iterator<Item = JointMeasures> + 'a {
    let effort_nm = &trace.arms[arm].effort_nm;
    trace.arms[arm].joints.iter().enumerate().map(move |(joint, name)| JointMeasures {
        name: name.clone(),
        torque_ratio: samples
            .iter()
            .map(|sample| sample.arms[arm].torque_demanded_nm[joint].abs() / effort_nm[joint])
            .collect(),
    })
}
