//! The fingerprint of a trace, and whether its numbers are finite.

use sha2::{Digest, Sha256};

use crate::model::{
    frames::Pose,
    trace::{ArmSample, Sample, Trace},
    wrench::Wrench,
};

/// SHA-256 of the trace's numbers, in lowercase hexadecimal: the little-endian bits of every f64 in the order of the
/// fields, the phase as a number (0 to 3), the person's distance if the plan has a person, the robot's clearance if it
/// was measured, the limits and the wrench of a measured gripper while it holds, and the tool point if it has moved. Names are not part of it, nor are the self-checks, which follow from the rest. Equal fingerprints mean
/// simulations that agree bit for bit.
#[must_use]
pub fn fingerprint(trace: &Trace) -> String {
    let mut hasher = Sha256::new();
    visit_constants(trace, &mut |value| hasher.update(value.to_le_bytes()));
    for sample in &trace.samples {
        visit_sample(sample, &mut |value| hasher.update(value.to_le_bytes()));
        if sample.p_ot_m != trace.p_ot_m {
            visit_all(sample.p_ot_m.as_slice(), &mut |value| hasher.update(value.to_le_bytes()));
        }
    }
    base16ct::lower::encode_string(&hasher.finalize())
}

/// True if the constants of the trace are finite.
pub(super) fn constants_are_finite(trace: &Trace) -> bool {
    let mut finite = true;
    visit_constants(trace, &mut |value| finite &= value.is_finite());
    finite
}

/// True if every number of the sample is finite.
pub(super) fn sample_is_finite(sample: &Sample) -> bool {
    let mut finite = true;
    visit_sample(sample, &mut |value| finite &= value.is_finite());
    visit_all(sample.p_ot_m.as_slice(), &mut |value| finite &= value.is_finite());
    finite
}

fn visit_constants(trace: &Trace, visit: &mut impl FnMut(f64)) {
    visit_all(trace.p_ot_m.as_slice(), visit);
    for arm in &trace.arms {
        visit_all(&arm.effort_nm, visit);
        visit(arm.grip_force_n);
        if let Some(limits) = &arm.wrench_limits {
            visit_wrench(&limits.low, visit);
            visit_wrench(&limits.high, visit);
        }
    }
}

fn visit_sample(sample: &Sample, visit: &mut impl FnMut(f64)) {
    visit(sample.time_s);
    visit(f64::from(sample.phase as u8));
    visit(sample.load_factor);
    visit_wrench(&sample.tool_wrench_w, visit);
    visit_pose(&sample.x_wo, visit);
    for arm in &sample.arms {
        visit_arm(arm, visit);
    }
    visit_all(sample.person_distance_m.as_slice(), visit);
    visit_all(sample.robot_clearance_m.as_slice(), visit);
}

fn visit_arm(arm: &ArmSample, visit: &mut impl FnMut(f64)) {
    for series in [&arm.q_rad, &arm.finger_m, &arm.torque_demanded_nm, &arm.torque_applied_nm] {
        visit_all(series, visit);
    }
    visit_pose(&arm.x_oc, visit);
    for pad in &arm.pads {
        visit(pad.normal_force_n);
        visit_wrench(&pad.wrench_w, visit);
        visit_all(pad.p_wp_m.as_slice(), visit);
    }
    arm.grip_wrench_g.iter().for_each(|wrench_g| visit_wrench(wrench_g, visit));
}

fn visit_pose(pose: &Pose, visit: &mut impl FnMut(f64)) {
    visit_all(pose.translation.vector.as_slice(), visit);
    visit_all(pose.rotation.coords.as_slice(), visit);
}

fn visit_wrench(wrench: &Wrench, visit: &mut impl FnMut(f64)) {
    visit_all(wrench.to_vector().as_slice(), visit);
}

fn visit_all(values: &[f64], visit: &mut impl FnMut(f64)) {
    values.iter().copied().for_each(visit);
}
