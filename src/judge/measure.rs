//! The measured series of a trace.

use crate::model::{
    frames::Pose,
    measures::{HandMeasures, JointMeasures, Measures},
    trace::{Sample, Trace},
};

/// Slip, deflection and torque ratios of the samples of a trace, relative to the first one
/// (docs/method.md#81-reference-state):
///
/// - slip of a hand: `|p_OC(t) - p_OC(ref)|` and the angle of `R_OC(ref)' R_OC(t)`, C at the centre between its pads;
/// - deflection: `|X_WO(t) p_OT - X_WO(ref) p_OT|`, T the tool point at that time;
/// - torque ratio of a joint: `|tau_demanded| / tau_max`;
/// - clearance: the distance of the robot from itself and from the board.
pub(super) fn measures(trace: &Trace, samples: &[Sample]) -> Measures {
    let deflection_mm = |sample: &Sample| {
        let p_ot = nalgebra::Point3::from(sample.p_ot_m);
        1e3 * (sample.x_wo * p_ot - samples[0].x_wo * p_ot).norm()
    };
    Measures {
        time_s: samples.iter().map(|sample| sample.time_s).collect(),
        load_factor: samples.iter().map(|sample| sample.load_factor).collect(),
        hands: (0..trace.arms.len()).map(|arm| hand_measures(trace, samples, arm)).collect(),
        deflection_mm: samples.iter().map(deflection_mm).collect(),
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
        slip_deg: samples.iter().map(|sample| start.rotation.angle_to(&x_oc(sample).rotation).to_degrees()).collect(),
    }
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
