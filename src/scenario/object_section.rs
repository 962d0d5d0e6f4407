//! `[object]` of a scenario file: a box or a plate, its material, mass and centre of mass.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{InputError, check::Checker, material};
use crate::{
    check::{BOARD_SIDE_M, bounds},
    model::{
        board::BoardShape,
        plate::{MOST_CORNERS, Plate, PlateFault, PlatePart, PlateRecord, ROUND_SIDES},
        polygon::{Point, circle},
        scenario::Board,
    },
    robot::Robot,
};

/// `[object]`: a box with `size_m`, or a plate with `outline_m` and `thickness_m`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ObjectSection {
    /// Width, height and thickness of a box, m; 0.50, 0.40 and 0.030 by default.
    pub size_m: Option<[f64; 3]>,
    /// The corners of a plate's convex outline in O, counter-clockwise seen from +z_O, m. O, the origin, is inside.
    pub outline_m: Option<Vec<Point>>,
    /// With `outline_m`: the plate's thickness, m.
    pub thickness_m: Option<f64>,
    /// Holes of the box or plate.
    pub holes: Vec<HoleSection>,
    /// Density, kg/m^3; by default the material's.
    pub density_kg_m3: Option<f64>,
    /// Mass, kg; by default that of volume and density.
    pub mass_kg: Option<f64>,
    /// Centre of mass in O, m; by default the centroid.
    pub com_m: Option<[f64; 3]>,
    /// A material of `assets/materials.toml`.
    pub material: String,
}

/// A hole: `outline_m`, or `centre_m` and `radius_m`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleSection {
    /// The corners of a hole in O, m; they need not be convex.
    pub outline_m: Option<Vec<Point>>,
    /// The centre of a round hole in O, m.
    pub centre_m: Option<Point>,
    /// The radius of a round hole, m. It becomes a regular polygon with 32 sides and the same area.
    pub radius_m: Option<f64>,
}

impl Default for ObjectSection {
    fn default() -> Self {
        Self {
            size_m: None,
            outline_m: None,
            thickness_m: None,
            holes: Vec::new(),
            density_kg_m3: None,
            mass_kg: None,
            com_m: None,
            material: "foam".into(),
        }
    }
}

impl ObjectSection {
    /// The thickness of the board before it is checked, m; the usual one of a plate without a thickness, which has an error of
    /// its own.
    pub fn thickness_m(&self) -> f64 {
        let of_box_m = self.size_m.unwrap_or(DEFAULT_SIZE_M)[2];
        self.outline_m.as_ref().and(self.thickness_m).unwrap_or(of_box_m)
    }
}

/// The board of the reproduction (`docs/method.md#24-board`), m.
const DEFAULT_SIZE_M: [f64; 3] = [0.50, 0.40, 0.030];

/// The board of a file.
pub fn board(check: &Checker<'_>, section: &ObjectSection, robot: &Robot) -> Result<Board, InputError> {
    let material_density = material::density_kg_m3(&section.material)
        .map_err(|expected| check.value("object.material", format!("\"{}\"", section.material), expected))?;
    let density_kg_m3 = section.density_kg_m3.unwrap_or(material_density);
    check.within("object.density_kg_m3", density_kg_m3, 1.0, 25_000.0, "kg/m^3")?;
    let shape = shape(check, section, robot)?;
    if let Some(mass_kg) = section.mass_kg {
        check.absent("object.density_kg_m3", section.density_kg_m3.is_some(), "an object without mass_kg")?;
        check.positive("object.mass_kg", mass_kg, bounds::MOST_MASS_KG, "kg")?;
    }
    if let Some(com_m) = section.com_m {
        let expected = "a point within the outline and the thickness of the board";
        check.that(shape.surrounds(&com_m.into()), "object.com_m", format!("{com_m:?}"), expected)?;
    }
    Ok(Board {
        size_m: shape.size_m,
        density_kg_m3: section.mass_kg.map_or(density_kg_m3, |mass_kg| mass_kg / shape.volume_m3()),
        plate: shape.plate,
        mass_kg: section.mass_kg,
        com_m: section.com_m,
        material: section.material.clone(),
    })
}

fn shape(check: &Checker<'_>, section: &ObjectSection, robot: &Robot) -> Result<BoardShape, InputError> {
    let Some(outline_m) = &section.outline_m else {
        check.absent("object.thickness_m", section.thickness_m.is_some(), "object.outline_m")?;
        let size_m = section.size_m.unwrap_or(DEFAULT_SIZE_M);
        check.board_size("object.size_m", size_m, robot.arms.iter())?;
        let cuboid = BoardShape::cuboid(size_m);
        return if section.holes.is_empty() {
            Ok(cuboid)
        } else {
            plate(check, section, &cuboid.outline_m(), size_m[2])
        };
    };
    check.absent("object.size_m", section.size_m.is_some(), "an object without outline_m")?;
    let key = "object.thickness_m";
    let thickness_m = check.present(key, section.thickness_m, "a thickness in m, since there is an outline_m")?;
    check.within(key, thickness_m, BOARD_SIDE_M[0], BOARD_SIDE_M[1], "m")?;
    check.thickness(key, thickness_m, robot.arms.iter())?;
    plate(check, section, outline_m, thickness_m)
}

fn plate(
    check: &Checker<'_>,
    section: &ObjectSection,
    outline_m: &[Point],
    thickness_m: f64,
) -> Result<BoardShape, InputError> {
    let holes_m: Result<Vec<_>, _> =
        section.holes.iter().enumerate().map(|(number, hole)| corners_of(check, number, hole)).collect();
    let plate = Plate::from(PlateRecord { outline_m: outline_m.to_vec(), holes_m: holes_m? });
    plate.check().map_err(|PlateFault { part, found, expected }| {
        let key = match part {
            PlatePart::Outline => "object.outline_m".into(),
            PlatePart::Corner(corner) => format!("object.outline_m[{corner}]"),
            PlatePart::Holes => "object.holes".into(),
            PlatePart::Hole(hole) => format!("object.holes[{hole}]"),
        };
        check.value(&key, found, expected)
    })?;
    let shape = BoardShape::plate(plate, thickness_m);
    for (axis, side_m) in shape.size_m.into_iter().enumerate().take(2) {
        let found = format!("an outline of {side_m} m along {}", ["x_O", "y_O"][axis]);
        check.that(side_m <= BOARD_SIDE_M[1], "object.outline_m", found, &format!("at most {} m", BOARD_SIDE_M[1]))?;
    }
    Ok(shape)
}

fn corners_of(check: &Checker<'_>, number: usize, hole: &HoleSection) -> Result<Vec<Point>, InputError> {
    let key = |name: &str| format!("object.holes[{number}].{name}");
    if let Some(corners) = &hole.outline_m {
        check.absent(&key("centre_m"), hole.centre_m.is_some(), "a hole without outline_m")?;
        check.absent(&key("radius_m"), hole.radius_m.is_some(), "a hole without outline_m")?;
        let found = format!("{} corners", corners.len());
        let expected = format!("3 to {MOST_CORNERS} corners");
        check.that((3..=MOST_CORNERS).contains(&corners.len()), &key("outline_m"), found, &expected)?;
        return Ok(corners.clone());
    }
    let centre_m = check.present(&key("centre_m"), hole.centre_m, "a centre [x, y] in m, or outline_m")?;
    let radius_m = check.present(&key("radius_m"), hole.radius_m, "a radius in m, or outline_m")?;
    check.place(&key("centre_m"), &centre_m)?;
    check.within(&key("radius_m"), radius_m, LEAST_RADIUS_M, BOARD_SIDE_M[1] / 2.0, "m")?;
    Ok(circle(centre_m, radius_m, ROUND_SIDES))
}

/// The least radius of a round hole, m: the sides of its polygon are 1 mm long.
const LEAST_RADIUS_M: f64 = 0.0051;
