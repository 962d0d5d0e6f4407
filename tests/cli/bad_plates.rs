//! Scenarios with invalid plates: exit code 2, one message with file, line, key, the value found and the value expected.

use crate::bad_input::assert_scenario_refused;

const PLATE: &str = "outline_m = [[0.2, -0.2], [0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2]]
thickness_m = 0.02
holes = [{ centre_m = [0.1, 0.1], radius_m = 0.03 }]";

/// Asserts that a scenario of a plate with one replacement is refused with this message.
#[track_caller]
fn assert_plate_refused(replace: &str, with: &str, message: &str) {
    assert!(PLATE.contains(replace));
    assert_scenario_refused("size_m = [0.50, 0.40, 0.030]", &PLATE.replacen(replace, with, 1), message);
}

#[test]
fn outlines_that_are_not_convex_and_counter_clockwise_about_o() {
    assert_plate_refused(
        "[[0.2, -0.2], [0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2]]",
        "[[-0.2, -0.2], [-0.2, 0.2], [0.2, 0.2], [0.2, -0.2]]",
        "bad.toml:5: object.outline_m: found clockwise corners, expected counter-clockwise corners, seen from +z_O",
    );
    assert_plate_refused(
        "[0.2, 0.2], [-0.2, 0.2]",
        "[-0.2, 0.2], [0.2, 0.2]",
        "bad.toml:5: object.outline_m: found a side that meets another one: that from corner 0, expected an outline that \
         does not cross itself",
    );
    assert_plate_refused(
        "[0.2, 0.2], ",
        "[0.1, 0.0], [0.2, 0.2], ",
        "bad.toml:5: object.outline_m[1]: found a turn of -53.13 degrees to the left at corner 1, expected a convex outline: \
         at least 0.1 degrees at every corner",
    );
    assert_plate_refused(
        "[0.2, 0.2], [-0.2, 0.2], ",
        "",
        "bad.toml:5: object.outline_m: found 2 corners, expected 3 to 64 corners",
    );
    assert_plate_refused(
        "[[0.2, -0.2], [0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2]]",
        "[[0.4, -0.2], [0.4, 0.2], [0.1, 0.2], [0.1, -0.2]]",
        "bad.toml:5: object.outline_m: found the origin -100.00 mm inside the outline, expected corners about the origin of O, \
         at least 1 mm inside the outline",
    );
    assert_plate_refused(
        "[0.2, -0.2]",
        "[nan, -0.2]",
        "bad.toml:5: object.outline_m[0]: found [NaN, -0.2], expected numbers from -5 to 5 (m)",
    );
}

#[test]
fn a_plate_is_not_a_box_too() {
    assert_plate_refused(
        "thickness_m = 0.02",
        "size_m = [0.4, 0.4, 0.02]",
        "bad.toml:6: object.size_m: found a value, expected none: it belongs to an object without outline_m",
    );
    assert_plate_refused(
        "thickness_m = 0.02\n",
        "",
        "bad.toml:4: object.thickness_m: found nothing, expected a thickness in m, since there is an outline_m",
    );
    assert_plate_refused(
        "thickness_m = 0.02",
        "thickness_m = 0.0005",
        "bad.toml:6: object.thickness_m: found 0.0005, expected a number from 0.001 to 5 (m)",
    );
    assert_scenario_refused(
        "[operation]",
        "thickness_m = 0.02\n[operation]",
        "bad.toml:7: object.thickness_m: found a value, expected none: it belongs to object.outline_m",
    );
}

#[test]
fn holes_that_are_not_inside_the_plate() {
    assert_plate_refused(
        "centre_m = [0.1, 0.1]",
        "centre_m = [0.18, 0.1]",
        "bad.toml:7: object.holes[0]: found a corner 10.1 mm outside the outline, expected a hole inside the outline with at \
         least 1 mm of material around it",
    );
    assert_plate_refused(
        "{ centre_m = [0.1, 0.1], radius_m = 0.03 }",
        "{ centre_m = [0.1, 0.1], radius_m = 0.03 }, { outline_m = [[0.1, 0.1], [0.15, 0.1], [0.1, 0.15]] }",
        "bad.toml:7: object.holes[1]: found 0.00 mm of material to hole 0, expected at least 1 mm of material between two holes",
    );
    assert_plate_refused(
        "{ centre_m = [0.1, 0.1], radius_m = 0.03 }",
        "{ outline_m = [[0.0, 0.0], [0.1, 0.1], [0.1, 0.0], [0.0, 0.1]] }",
        "bad.toml:7: object.holes[0]: found side 0 that meets another side, expected a hole that does not cross itself",
    );
    assert_plate_refused(
        ", radius_m = 0.03",
        "",
        "bad.toml:7: object.holes[0].radius_m: found nothing, expected a radius in m, or outline_m",
    );
}

#[test]
fn an_operation_point_in_a_hole_or_outside_an_outline() {
    assert_plate_refused(
        "centre_m = [0.1, 0.1]",
        "centre_m = [0.01, 0.0]",
        "bad.toml:11: operation.point_m: found [0, 0], 20.00 mm off the material, expected a point of the plate, inside its \
         outline and outside its holes",
    );
}

#[test]
fn a_mass_and_a_centre_of_mass_that_cannot_be() {
    assert_plate_refused(
        "thickness_m = 0.02",
        "thickness_m = 0.02\nmass_kg = -1.0",
        "bad.toml:7: object.mass_kg: found -1, expected a positive number (kg)",
    );
    assert_plate_refused(
        "thickness_m = 0.02",
        "thickness_m = 0.02\nmass_kg = 1.0\ndensity_kg_m3 = 500.0",
        "bad.toml:8: object.density_kg_m3: found a value, expected none: it belongs to an object without mass_kg",
    );
    assert_plate_refused(
        "thickness_m = 0.02",
        "thickness_m = 0.02\ncom_m = [0.3, 0.0, 0.0]",
        "bad.toml:7: object.com_m: found [0.3, 0.0, 0.0], expected a point within the outline and the thickness of the board",
    );
}
