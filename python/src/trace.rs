//! A trace as arrays. The classes `Trace` and `ArmTrace` of the package say their shapes, frames and units.

use benchdog::model::{
    frames::Pose,
    trace::{ArmSample, PadSample, Sample, Trace},
    wrench::Wrench,
};
use pyo3::{prelude::*, types::PyDict};

use crate::table::{Arrays, Column};

/// The fields of `Trace`.
pub fn arrays<'py>(py: Python<'py>, trace: &Trace) -> PyResult<Bound<'py, PyDict>> {
    let (table, samples) = (Arrays::new(py), &trace.samples);
    let count = samples.len();
    table.vector("time_s", samples.iter().map(|sample| sample.time_s))?;
    table.put("phase", samples.iter().map(|sample| sample.phase.name()).collect::<Vec<_>>())?;
    table.vector("load_factor", samples.iter().map(|sample| sample.load_factor))?;
    table.array("tool_wrench_w", [count, 6], samples.iter().flat_map(|sample| wrench(&sample.tool_wrench_w)))?;
    table.array("p_wo_m", [count, 3], samples.iter().flat_map(|sample| position(&sample.x_wo)))?;
    table.array("rotation_wo_xyzw", [count, 4], samples.iter().flat_map(|sample| rotation(&sample.x_wo)))?;
    table.array(
        "p_ot_m",
        [count, 3],
        samples.iter().flat_map(|sample| [sample.p_ot_m.x, sample.p_ot_m.y, sample.p_ot_m.z]),
    )?;
    let distances: [Column<Sample, Option<f64>>; 2] = [
        ("person_distance_m", |sample| sample.person_distance_m),
        ("robot_clearance_m", |sample| sample.robot_clearance_m),
    ];
    for (name, distance) in distances {
        table.vector(name, samples.iter().map(|sample| distance(sample).unwrap_or(f64::NAN)))?;
    }
    let arms = PyDict::new(py);
    for (index, arm) in trace.arms.iter().enumerate() {
        let of_arm = arm_arrays(py, trace, index)?;
        of_arm.set_item("joints", &arm.joints)?;
        of_arm.set_item("pads", &arm.pads)?;
        arms.set_item(&arm.name, of_arm)?;
    }
    table.put("arms", arms)?;
    table.put("broke_down", trace.broke_down.as_deref())?;
    Ok(table.into_dict())
}

/// The arrays of `ArmTrace`.
fn arm_arrays<'py>(py: Python<'py>, trace: &Trace, index: usize) -> PyResult<Bound<'py, PyDict>> {
    let (table, arm) = (Arrays::new(py), &trace.arms[index]);
    let samples = || trace.samples.iter().map(move |sample| &sample.arms[index]);
    let (count, joints, pads) = (trace.samples.len(), arm.joints.len(), arm.pads.len());
    let fingers = trace.samples.first().map_or(0, |sample| sample.arms[index].finger_m.len());
    let rows: [(usize, Column<ArmSample, Vec<f64>>); 4] = [
        (joints, ("q_rad", |arm| arm.q_rad.clone())),
        (joints, ("torque_demanded_nm", |arm| arm.torque_demanded_nm.clone())),
        (joints, ("torque_applied_nm", |arm| arm.torque_applied_nm.clone())),
        (fingers, ("finger_m", |arm| arm.finger_m.clone())),
    ];
    for (width, (name, of)) in rows {
        table.array(name, [count, width], samples().flat_map(of))?;
    }
    table.vector("effort_nm", arm.effort_nm.iter().copied())?;
    table.array("p_oc_m", [count, 3], samples().flat_map(|arm| position(&arm.x_oc)))?;
    table.array("rotation_oc_xyzw", [count, 4], samples().flat_map(|arm| rotation(&arm.x_oc)))?;
    let of_pads = || samples().flat_map(|arm| &arm.pads);
    table.array("pad_force_n", [count, pads], of_pads().map(|pad| pad.normal_force_n))?;
    table.array("pad_wrench_w", [count, pads, 6], of_pads().flat_map(|pad| wrench(&pad.wrench_w)))?;
    let place = |pad: &PadSample| [pad.p_wp_m.x, pad.p_wp_m.y, pad.p_wp_m.z];
    table.array("p_wp_m", [count, pads, 3], of_pads().flat_map(place))?;
    let of_gripper = |arm: &ArmSample| arm.grip_wrench_g.as_ref().map_or([f64::NAN; 6], wrench);
    table.array("grip_wrench_g", [count, 6], samples().flat_map(of_gripper))?;
    Ok(table.into_dict())
}

/// Force, N, and moment, N m.
fn wrench(wrench: &Wrench) -> [f64; 6] {
    let (f, m) = (wrench.force_n, wrench.moment_nm);
    [f.x, f.y, f.z, m.x, m.y, m.z]
}

fn position(pose: &Pose) -> [f64; 3] {
    let p = pose.translation.vector;
    [p.x, p.y, p.z]
}

fn rotation(pose: &Pose) -> [f64; 4] {
    let q = pose.rotation.coords;
    [q.x, q.y, q.z, q.w]
}
