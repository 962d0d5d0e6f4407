//! The series behind the checks as arrays, and the events. The classes `Measures`, `HandMeasures` and `Event` of the package say their
//! units.

use benchdog::model::measures::{Event, EventKind, Measures};
use pyo3::{prelude::*, types::PyDict};

use crate::table::Arrays;

/// The fields of `Measures`.
pub fn arrays<'py>(py: Python<'py>, measures: &Measures) -> PyResult<Bound<'py, PyDict>> {
    let table = Arrays::new(py);
    for (name, values) in [
        ("time_s", &measures.time_s),
        ("load_factor", &measures.load_factor),
        ("sag_mm", &measures.sag_mm),
        ("deflection_mm", &measures.deflection_mm),
        ("clearance_mm", &measures.clearance_mm),
    ] {
        table.vector(name, values.iter().copied())?;
    }
    table.put("judged", measures.judged)?;
    let hands = PyDict::new(py);
    for hand in &measures.hands {
        let of_hand = Arrays::new(py);
        for (name, values) in
            [("slip_mm", &hand.slip_mm), ("slip_deg", &hand.slip_deg), ("grip_ratio", &hand.grip_ratio)]
        {
            of_hand.vector(name, values.iter().copied())?;
        }
        hands.set_item(&hand.name, of_hand.into_dict())?;
    }
    table.put("hands", hands)?;
    let joints = Arrays::new(py);
    for joint in &measures.joints {
        joints.vector(&joint.name, joint.torque_ratio.iter().copied())?;
    }
    table.put("torque_ratio", joints.into_dict())?;
    Ok(table.into_dict())
}

/// The fields of `Event`.
pub fn event<'py>(py: Python<'py>, event: &Event) -> PyResult<Bound<'py, PyDict>> {
    let check = match event.kind {
        EventKind::LimitCrossed(check) => Some(check.name()),
        _ => None,
    };
    let dict = PyDict::new(py);
    dict.set_item("time_s", event.time_s)?;
    dict.set_item("text", &event.text)?;
    dict.set_item("check", check)?;
    Ok(dict)
}
