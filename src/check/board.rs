//! The check of a plan's board and operation, and of the pads on a plate.

use std::f64::consts::{PI, TAU};

use super::{
    bounds,
    flaw::Flaw,
    tolerances::{BOARD_SIDE_M, GIVEN, ON_BOARD_M},
};
use crate::{
    model::{
        grasp::pad_corners_m,
        operation::{Operation, OperationKind},
        plan::{PlacedObject, Plan},
        plate::Plate,
    },
    robot::{Cup, Robot},
};

/// Sides of the polygon that stands for the lip of a suction cup.
const LIP_SIDES: u32 = 32;

/// Largest difference of a plate's stated size from that of its outline, m: rounding of written numbers.
const SAME_SIZE_M: f64 = 1e-6;

/// The first fault of a plate as a flaw of a plan; `None` for a sound plate or a box.
#[must_use]
pub fn check_plate(plate: Option<&Plate>) -> Option<Flaw> {
    plate.and_then(|plate| plate.check().err()).map(Flaw::Plate)
}

/// The board and the operation.
pub(super) fn check_task(plan: &Plan, flaws: &mut Vec<Flaw>) {
    let object = &plan.object;
    for (axis, &found_m) in object.size_m.iter().enumerate() {
        if !is_board_side(found_m) {
            flaws.push(Flaw::BoardSide { axis, found_m, range_m: BOARD_SIDE_M });
        }
    }
    let found_kg = object.mass_kg;
    if !(found_kg > 0.0 && found_kg <= bounds::MOST_MASS_KG) {
        flaws.push(Flaw::BoardMass { found_kg });
    }
    check_shape(object, flaws);
    check_operation(plan, flaws);
}

/// The operation, and that its tool point is on the board.
fn check_operation(plan: &Plan, flaws: &mut Vec<Flaw>) {
    let object = &plan.object;
    let Operation { kind, wrench_o, x_ot } = plan.operation;
    let found: [f64; 6] = wrench_o.into();
    let pushes_n = (x_ot.rotation.inverse() * wrench_o.force_n).z;
    if !bounds::wrench_is_within(&found) {
        flaws.push(Flaw::Wrench { found });
    } else if kind == OperationKind::Drill && pushes_n < 0.0 {
        flaws.push(Flaw::Pull { found_n: pushes_n });
    }
    let found_m: [f64; 3] = x_ot.translation.vector.into();
    let half_sides_m = object.size_m.map(|side_m| side_m / 2.0);
    let is_on_board = found_m.iter().zip(half_sides_m).all(|(p_m, half_m)| p_m.abs() - half_m <= ON_BOARD_M);
    // Of a board without size or shape only these are at fault.
    if check_plate(object.plate.as_ref()).is_some() || !object.size_m.iter().all(|&side_m| is_board_side(side_m)) {
        return;
    }
    let of_plate_m = object.plate.as_ref().map(|plate| plate.depth_m([found_m[0], found_m[1]]));
    if let Some(depth_m) = of_plate_m.filter(|depth_m| depth_m.is_nan() || *depth_m < -ON_BOARD_M) {
        return flaws.push(Flaw::ToolOffPlate { found_m: [found_m[0], found_m[1]], depth_m });
    }
    let is_on_board = if of_plate_m.is_some() { found_m[2].abs() - half_sides_m[2] <= ON_BOARD_M } else { is_on_board };
    if !is_on_board {
        return flaws.push(Flaw::ToolPoint { found_m, half_sides_m });
    }
    let sides = if of_plate_m.is_some() { 2..3 } else { 0..3 };
    let depths_m = sides.map(|axis| half_sides_m[axis] - found_m[axis].abs());
    let depth_m = depths_m.fold(of_plate_m.unwrap_or(f64::INFINITY), f64::min);
    if kind != OperationKind::Wrench && depth_m > GIVEN.position_m {
        flaws.push(Flaw::TipInside { depth_m });
    }
}

/// True if a length is in the range of a board's sides; false if it is not a number.
pub(super) fn is_board_side(side_m: f64) -> bool {
    (BOARD_SIDE_M[0]..=BOARD_SIDE_M[1]).contains(&side_m)
}

/// Outline, stated size and centre of mass.
fn check_shape(object: &PlacedObject, flaws: &mut Vec<Flaw>) {
    if let Some(flaw) = check_plate(object.plate.as_ref()) {
        return flaws.push(flaw);
    }
    if let Some(plate) = &object.plate {
        let [low_m, high_m] = plate.bounds_m();
        let (found_m, expected_m) =
            ([object.size_m[0], object.size_m[1]], [high_m[0] - low_m[0], high_m[1] - low_m[1]]);
        if found_m.iter().zip(expected_m).any(|(found_m, expected_m)| (found_m - expected_m).abs() > SAME_SIZE_M) {
            flaws.push(Flaw::PlateSize { found_m, expected_m });
        }
    }
    if let Some(found_m) = object.com_m.filter(|com_m| !object.shape().surrounds(&(*com_m).into())) {
        flaws.push(Flaw::CentreOfMass { found_m });
    }
}

/// The lip of a suction cup: air must not leak in, so all of it is on the material, of a box too.
fn check_cup(cup: &Cup, plan: &Plan, arm: usize, flaws: &mut Vec<Flaw>) {
    let object = &plan.object;
    let plate = object.plate.as_ref();
    if check_plate(plate).is_some() || !object.size_m.iter().all(|&side_m| is_board_side(side_m)) {
        return;
    }
    let centre = plan.arms[arm].x_og.translation.vector;
    // A polygon around the lip.
    let reach_m = cup.radius_m / (PI / f64::from(LIP_SIDES)).cos();
    let corner = |k: u32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(k) / f64::from(LIP_SIDES));
        [centre.x + reach_m * cos, centre.y + reach_m * sin]
    };
    let lip_m: Vec<_> = (0..LIP_SIDES).map(corner).collect();
    let least_m = match plate {
        Some(plate) => plate.patch_margins_m(&lip_m).into_iter().fold(f64::INFINITY, f64::min),
        None => {
            let [half_x_m, half_y_m] = [object.size_m[0] / 2.0, object.size_m[1] / 2.0];
            f64::min(half_x_m - centre.x.abs(), half_y_m - centre.y.abs()) - cup.radius_m
        }
    };
    if least_m < -GIVEN.position_m {
        flaws.push(Flaw::CupOffBoard { arm, off_m: -least_m });
    }
}

/// The pads of an arm on a plate. Of a box pads may overhang: statics and simulation know which part of them touches.
pub(super) fn check_pads(robot: &Robot, index: usize, plan: &Plan, arm: usize, flaws: &mut Vec<Flaw>) {
    if let Some(cup) = &robot.arms[index].gripper.cup {
        return check_cup(cup, plan, arm, flaws);
    }
    let Some(plate) = plan.object.plate.as_ref().filter(|plate| plate.check().is_ok()) else { return };
    let hold = &plan.arms[arm];
    let off_m = robot.arms[index].gripper.fingers.iter().map(|finger| {
        let corners_m = pad_corners_m(&hold.x_og, finger.pad.size_m, finger.pad.centre_m);
        -plate.patch_margins_m(&corners_m).into_iter().fold(f64::INFINITY, f64::min)
    });
    let off_m = off_m.fold(f64::NEG_INFINITY, f64::max);
    if off_m > GIVEN.position_m {
        flaws.push(Flaw::PadOffPlate { arm, off_m });
    }
}
