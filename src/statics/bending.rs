//! How far a board bends under an operation, if it is not rigid: an estimate by the beam of Euler and Bernoulli
//! (docs/method.md#78-rigid-board).
//!
//! Two beams are considered, and the worse one counts: a strip that is simply supported by the two hands farthest apart, with
//! the force in its middle, and a strip that is clamped along the line through these hands and carries the force at the tool.
//! A strip of a box is as wide as the board across it. A strip of a plate is as wide as the material of the narrowest section
//! across it: holes weaken it over its whole length.

use nalgebra::Vector2;

use crate::model::{
    plan::{ArmHold, Plan},
    scenario::{BendingProperties, Limits},
};

/// The bending of a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bending {
    /// Largest deflection, m.
    pub deflection_m: f64,
    /// Largest stress, Pa.
    pub stress_pa: f64,
}

/// A strip of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    /// Distance of the supports or, for a clamped strip, of the force from the clamp, m.
    pub length_m: f64,
    /// Width across the length, m.
    pub width_m: f64,
    /// Thickness, m.
    pub thickness_m: f64,
}

impl Strip {
    /// The second moment of area, `b t^3 / 12`, m^4.
    fn second_moment_m4(&self) -> f64 {
        self.width_m * self.thickness_m.powi(3) / 12.0
    }

    /// Stress at the surface under a bending moment: `M t / (2 I)`, Pa.
    fn stress_pa(&self, moment_nm: f64) -> f64 {
        moment_nm * self.thickness_m / (2.0 * self.second_moment_m4())
    }

    /// Simply supported at both ends, with a force in the middle: `w = F L^3 / (48 E I)`, `M = F L / 4`.
    #[must_use]
    pub fn supported(&self, force_n: f64, youngs_modulus_pa: f64) -> Bending {
        Bending {
            deflection_m: force_n * self.length_m.powi(3) / (48.0 * youngs_modulus_pa * self.second_moment_m4()),
            stress_pa: self.stress_pa(force_n * self.length_m / 4.0),
        }
    }

    /// Clamped at one end, with a force at the other: `w = F a^3 / (3 E I)`, `M = F a`.
    #[must_use]
    pub fn clamped(&self, force_n: f64, youngs_modulus_pa: f64) -> Bending {
        Bending {
            deflection_m: force_n * self.length_m.powi(3) / (3.0 * youngs_modulus_pa * self.second_moment_m4()),
            stress_pa: self.stress_pa(force_n * self.length_m),
        }
    }
}

/// The bending of a plan's board under the part of its operation's force that is along the board's normal; `None` without an arm.
#[must_use]
pub fn bending(plan: &Plan, properties: &BendingProperties) -> Option<Bending> {
    let place = |hold: &ArmHold| hold.x_og.translation.vector.xy();
    let places: Vec<Vector2<f64>> = plan.arms.iter().map(place).collect();
    let pairs = places.iter().enumerate().flat_map(|(number, a)| places[number..].iter().map(move |b| (*a, *b)));
    let (one, other) = pairs.max_by(|(a, b), (c, d)| (b - a).norm().total_cmp(&(d - c).norm()))?;
    let tool = plan.operation.x_ot.translation.vector.xy();
    let force_n = plan.operation.wrench_o.force_n.z.abs();
    let [x_m, y_m, thickness_m] = plan.object.size_m;
    let strip = |from: Vector2<f64>, along: Vector2<f64>| {
        let length_m = along.norm();
        // A single hand, or a tool on the line through the hands: no length, and so no bending, whatever the width.
        let unit = if length_m > 0.0 { along / length_m } else { Vector2::x() };
        let width_m = match &plan.object.plate {
            Some(plate) if length_m > 0.0 => plate.narrowest_section_m(from.into(), (from + along).into()),
            _ => x_m * unit.y.abs() + y_m * unit.x.abs(),
        };
        Strip { length_m, width_m, thickness_m }
    };
    let between = other - one;
    let to_tool = tool - one;
    let along = if between.norm() > 0.0 { between * (to_tool.dot(&between) / between.norm_squared()) } else { between };
    let of_supported = strip(one, between).supported(force_n, properties.youngs_modulus_pa);
    let of_clamped = strip(one + along, to_tool - along).clamped(force_n, properties.youngs_modulus_pa);
    Some(Bending {
        deflection_m: of_supported.deflection_m.max(of_clamped.deflection_m),
        stress_pa: of_supported.stress_pa.max(of_clamped.stress_pa),
    })
}

/// Share of the limit of deflection that the board may bend before a note says so.
const NOTED_SHARE: f64 = 0.5;

/// A note if a board of this material bends by more than half of the limit of deflection, or is stressed beyond its strength;
/// `None` if a rigid board is a fair assumption.
#[must_use]
pub fn bending_note(plan: &Plan, material: &str, properties: &BendingProperties, limits: &Limits) -> Option<String> {
    let Bending { deflection_m, stress_pa } = bending(plan, properties)?;
    let (deflection_mm, thickness_mm) = (deflection_m * 1e3, plan.object.size_m[2] * 1e3);
    let assumed = "the simulation assumes a rigid board";
    if stress_pa > properties.strength_pa {
        let [stress_mpa, strength_mpa] = [stress_pa, properties.strength_pa].map(|pa| pa * 1e-6);
        return Some(format!(
            "the board breaks ({material}, {thickness_mm} mm thick): a bending stress of {stress_mpa:.2} MPa, its strength is \
             {strength_mpa:.2} MPa; {assumed}"
        ));
    }
    (deflection_mm > NOTED_SHARE * limits.deflection_mm)
        .then(|| format!("the board bends by {deflection_mm:.1} mm ({material}, {thickness_mm} mm thick): {assumed}"))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use nalgebra::Vector3;

    use super::*;
    use crate::{
        model::{
            operation::{Operation, OperationKind},
            plate::PlateRecord,
        },
        scenario::read_plan,
    };

    const STRIP: Strip = Strip { length_m: 0.4, width_m: 0.3, thickness_m: 0.006 };

    /// Half of a supported strip is a clamped one with half the force at half the length.
    #[test]
    fn half_a_supported_strip_is_a_clamped_one() {
        let half = Strip { length_m: STRIP.length_m / 2.0, ..STRIP };
        let (whole, half) = (STRIP.supported(20.0, 14e6), half.clamped(10.0, 14e6));
        // Rounding of a few products.
        assert!((whole.deflection_m / half.deflection_m - 1.0).abs() < 1e-12);
        assert!((whole.stress_pa / half.stress_pa - 1.0).abs() < 1e-12);
    }

    #[test]
    fn bending_scales_with_the_force_the_modulus_and_the_thickness() {
        let soft = STRIP.supported(15.0, 14e6);
        // F L^3 / (48 E I) and 3 F L / (2 b t^2) by hand: I = 0.3 x 0.006^3 / 12 = 5.4e-9 m^4.
        assert!((soft.deflection_m - 15.0 * 0.064 / (48.0 * 14e6 * 5.4e-9)).abs() < 1e-12);
        assert!((soft.stress_pa - 1.5 * 15.0 * 0.4 / (0.3 * 36e-6)).abs() < 1e-6);
        let thicker = Strip { thickness_m: 0.012, ..STRIP }.supported(15.0, 14e6);
        assert!((soft.deflection_m / thicker.deflection_m - 8.0).abs() < 1e-9);
        assert!((soft.stress_pa / thicker.stress_pa - 4.0).abs() < 1e-9);
        let stiffer = STRIP.supported(30.0, 28e6);
        assert!((stiffer.deflection_m / soft.deflection_m - 1.0).abs() < 1e-12);
        assert!((stiffer.stress_pa / soft.stress_pa - 2.0).abs() < 1e-12);
    }

    /// A plan with both hands on the board, at these places, and a force at the tool along the normal.
    fn plan(hands_m: [[f64; 2]; 2], tool_m: [f64; 2], force_n: f64, size_m: [f64; 3]) -> Plan {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/cut-rim.json");
        let (mut plan, _) = read_plan(&path, None).unwrap();
        for (hold, [x_m, y_m]) in plan.arms.iter_mut().zip(hands_m) {
            hold.x_og.translation.vector = Vector3::new(x_m, y_m, 0.0);
        }
        plan.operation = Operation::drill(tool_m, force_n, size_m[2]);
        plan.object.size_m = size_m;
        plan
    }

    const FOAM: BendingProperties = BendingProperties { youngs_modulus_pa: 14e6, strength_pa: 0.3e6 };

    #[test]
    fn the_worse_beam_counts_and_only_the_force_along_the_normal() {
        let size_m = [0.5, 0.4, 0.006];
        // Rounding of differences of places and of the projection.
        let same = |found: &Bending, expected: &Bending| {
            (found.deflection_m / expected.deflection_m - 1.0).abs() < 1e-12
                && (found.stress_pa / expected.stress_pa - 1.0).abs() < 1e-12
        };
        // Between opposite hands, along x and along y.
        let along_x = bending(&plan([[-0.2, 0.0], [0.2, 0.0]], [0.1, 0.0], 15.0, size_m), &FOAM).unwrap();
        assert!(same(&along_x, &Strip { length_m: 0.4, width_m: 0.4, thickness_m: 0.006 }.supported(15.0, 14e6)));
        let along_y = bending(&plan([[0.0, -0.15], [0.0, 0.15]], [0.0, 0.1], 15.0, size_m), &FOAM).unwrap();
        assert!(same(&along_y, &Strip { length_m: 0.3, width_m: 0.5, thickness_m: 0.006 }.supported(15.0, 14e6)));
        // Side by side on one edge, with the tool 0.3 m away.
        let one_edge = plan([[-0.2, -0.1], [-0.2, 0.1]], [0.1, 0.05], 15.0, size_m);
        let clamped = Strip { length_m: 0.3, width_m: 0.4, thickness_m: 0.006 }.clamped(15.0, 14e6);
        assert!(same(&bending(&one_edge, &FOAM).unwrap(), &clamped));
        // One hand holds as a clamp through itself.
        let mut one_hand = one_edge.clone();
        one_hand.arms.truncate(1);
        assert!(bending(&one_hand, &FOAM).unwrap().deflection_m > 0.0);
        let mut along_face = one_edge;
        along_face.operation.wrench_o.force_n = Vector3::new(3.0, 4.0, 0.0);
        assert_eq!(bending(&along_face, &FOAM).unwrap().deflection_m, 0.0);
    }

    #[test]
    fn a_hole_between_the_hands_weakens_a_plate_and_one_beside_them_does_not() {
        let size_m = [0.5, 0.4, 0.006];
        let mut plan = plan([[-0.2, 0.0], [0.2, 0.0]], [0.0, 0.0], 15.0, size_m);
        let of_box = bending(&plan, &FOAM).unwrap();
        let outline_m = plan.object.shape().outline_m();
        let mut with_hole = |[x, y]: [f64; 2]| {
            let hole = vec![[x, y], [x + 0.04, y], [x + 0.04, y + 0.1], [x, y + 0.1]];
            plan.object.plate = Some(PlateRecord { outline_m: outline_m.clone(), holes_m: vec![hole] }.into());
            bending(&plan, &FOAM).unwrap()
        };
        // A quarter of the section is missing: 4/3 of the deflection and the stress. Rounding of the section's ends.
        let between = with_hole([0.05, -0.05]);
        assert!((between.deflection_m / of_box.deflection_m - 4.0 / 3.0).abs() < 1e-9);
        assert!((between.stress_pa / of_box.stress_pa - 4.0 / 3.0).abs() < 1e-9);
        let beside = with_hole([0.205, -0.05]);
        assert!((beside.deflection_m / of_box.deflection_m - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_hole_beside_the_line_through_the_hands_weakens_the_clamped_strip() {
        let size_m = [0.5, 0.4, 0.006];
        let mut plan = plan([[-0.2, -0.1], [-0.2, 0.1]], [0.1, 0.05], 15.0, size_m);
        let outline_m = plan.object.shape().outline_m();
        let mut with_hole = |x: f64| {
            let hole = vec![[x, 0.0], [x + 0.04, 0.0], [x + 0.04, 0.1], [x, 0.1]];
            plan.object.plate = Some(PlateRecord { outline_m: outline_m.clone(), holes_m: vec![hole] }.into());
            bending(&plan, &FOAM).unwrap()
        };
        // The strip reaches from the line at x = -0.2 m to the tool at 0.1 m: a hole in between takes a quarter of its width.
        let strip =
            |width_m: f64| Strip { length_m: 0.3, width_m, thickness_m: 0.006 }.clamped(15.0, FOAM.youngs_modulus_pa);
        assert!((with_hole(0.0).deflection_m / strip(0.3).deflection_m - 1.0).abs() < 1e-9);
        assert!((with_hole(0.15).deflection_m / strip(0.4).deflection_m - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_tool_at_the_only_hand_bends_nothing() {
        let mut plan = plan([[-0.2, 0.0], [-0.2, 0.0]], [-0.2, 0.0], 15.0, [0.5, 0.4, 0.006]);
        plan.arms.truncate(1);
        let none = Bending { deflection_m: 0.0, stress_pa: 0.0 };
        assert_eq!(bending(&plan, &FOAM).unwrap(), none);
        let outline_m = plan.object.shape().outline_m();
        plan.object.plate = Some(PlateRecord { outline_m, holes_m: Vec::new() }.into());
        assert_eq!(bending(&plan, &FOAM).unwrap(), none);
    }

    #[test]
    fn a_board_at_its_strength_or_at_half_of_its_limit_has_no_note() {
        let plan = plan([[-0.2, 0.0], [0.2, 0.0]], [0.0, 0.0], 15.0, [0.5, 0.4, 0.03]);
        let Bending { deflection_m, stress_pa } = bending(&plan, &FOAM).unwrap();
        let note = |strength_pa: f64, limit_mm: f64| {
            let limits = Limits { deflection_mm: limit_mm, ..Limits::of(OperationKind::Drill) };
            bending_note(&plan, "foam", &BendingProperties { strength_pa, ..FOAM }, &limits)
        };
        // Doubling and halving are exact.
        let limit_mm = 2.0 * (deflection_m * 1e3);
        assert_eq!(note(stress_pa, limit_mm), None);
        assert!(note(0.999 * stress_pa, limit_mm).unwrap().starts_with("the board breaks"));
        assert!(note(stress_pa, 0.999 * limit_mm).unwrap().starts_with("the board bends"));
    }

    #[test]
    fn a_note_states_bending_or_breaking_and_a_stiff_board_has_none() {
        let limits = Limits::of(OperationKind::Drill);
        let note = |thickness_m: f64, force_n: f64| {
            let plan = plan([[-0.2, 0.0], [0.2, 0.0]], [0.0, 0.0], force_n, [0.5, 0.4, thickness_m]);
            bending_note(&plan, "foam", &FOAM, &limits)
        };
        // By hand: 15 N x 0.064 m^3 / (48 x 14 MPa x 0.4 m x t^3 / 12) is 19.5 mm at t = 13 mm, 1.6 mm at 30 mm.
        let expected = "the board bends by 19.5 mm (foam, 13 mm thick): the simulation assumes a rigid board";
        assert_eq!(note(0.013, 15.0).unwrap(), expected);
        assert_eq!(note(0.030, 15.0), None);
        // 3 F L / (2 b t^2) = 0.625 MPa.
        let broken = note(0.006, 15.0).unwrap();
        assert!(
            broken.starts_with("the board breaks (foam, 6 mm thick): a bending stress of 0.62 MPa, its strength is"),
            "{broken}"
        );
    }
}
