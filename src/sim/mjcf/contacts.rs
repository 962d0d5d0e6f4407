//! Settings of MuJoCo's solver, and the contacts of pads and board.
//!
//! A contact of MuJoCo with the time constant `t`, the damping ratio 1 and the constant impedance `d` penetrates under the
//! force `F` by `(1 - d) t^2 F / m`, with `1/m` the sum of the inverse masses of both bodies as MuJoCo assumes them: means
//! over all directions, without rotation for a body that is pushed beside its centre of mass. So each contact has the `d`
//! that gives it the compliance `c` of the contact in the scene here, and the pads have the same recess:
//!
//! ```text
//! d = 1 - c m / t^2
//! ```

use std::io;

use super::{
    exported_arm::ExportedArm,
    xml::{Xml, empty, numbers},
};
use crate::{
    model::{GRAVITY_W, scenario::SimulationSettings},
    robot::Robot,
};

/// The longest time step, s.
const TIMESTEP_S: f64 = 0.00025;

/// Time constant of the contacts and of the fingers' coupling, s: two time steps are the least that MuJoCo allows.
const TIME_CONSTANT_S: f64 = 2.0 * TIMESTEP_S;

/// How much stiffer friction is than the normal direction. MuJoCo's friction is viscous: under the force `F` a contact creeps
/// at `c F / (2 t)` divided by this number, with 10 by a tenth of a millimetre in a simulation, with 1000 by a micrometre.
const FRICTION_STIFFNESS_RATIO: f64 = 1000.0;

/// The least impedance of a contact. If a contact must be softer, its time constant is longer.
const LEAST_IMPEDANCE: f64 = 0.9;

/// The largest impedance that MuJoCo allows.
const LARGEST_IMPEDANCE: f64 = 0.9999;

/// Time steps of MuJoCo in one of the scenario's.
pub(super) fn steps_per_sample(settings: &SimulationSettings) -> usize {
    // Rounding must not add a step to eight steps of 0.25 ms; the scenario's step is at most 4 ms.
    (settings.timestep_s / TIMESTEP_S - 1e-9).ceil().max(1.0) as usize
}

/// MuJoCo's time step, s.
pub(super) fn timestep_s(settings: &SimulationSettings) -> f64 {
    settings.timestep_s / steps_per_sample(settings) as f64
}

/// The element `option`.
pub(super) fn option(xml: &mut Xml, settings: &SimulationSettings) -> io::Result<()> {
    let attributes = [
        ("timestep", timestep_s(settings).to_string()),
        ("gravity", numbers(GRAVITY_W.as_slice())),
        ("cone", "elliptic".into()),
        ("integrator", "implicitfast".into()),
        ("impratio", FRICTION_STIFFNESS_RATIO.to_string()),
    ];
    empty(xml, "option", &attributes)
}

/// The contact pairs of pads and board.
pub(super) fn contact_pairs(xml: &mut Xml, arms: &[ExportedArm<'_>], board_kg: f64) -> io::Result<()> {
    xml.create_element("contact").write_inner_content(|xml| {
        for arm in arms {
            // MuJoCo requires positive friction.
            let mu = arm.friction.max(1e-5);
            let parts = (0..2).flat_map(|k| arm.parts(k).map(|part| (k, part)));
            for (k, part) in parts {
                let [time_constant_s, impedance] = softness(part.compliance_m_n, arm.finger_per_kg + 1.0 / board_kg);
                let mut attributes = vec![
                    ("geom1", arm.part_name(k, &part)),
                    ("geom2", arm.touched_name()),
                    ("condim", "3".into()),
                    ("friction", numbers(&[mu, mu, 0.005, 0.0001, 0.0001])),
                ];
                attributes.extend(softness_attributes(time_constant_s, impedance));
                empty(xml, "pair", &attributes)?;
            }
        }
        Ok(())
    })?;
    Ok(())
}

/// Time constant, s, and impedance of a contact with this compliance between bodies with this sum of inverse masses.
fn softness(compliance_m_n: f64, inverse_mass_per_kg: f64) -> [f64; 2] {
    let softness_s2 = compliance_m_n / inverse_mass_per_kg;
    let time_constant_s = TIME_CONSTANT_S.max((softness_s2 / (1.0 - LEAST_IMPEDANCE)).sqrt());
    let impedance = 1.0 - softness_s2 / (time_constant_s * time_constant_s);
    [time_constant_s, impedance.min(LARGEST_IMPEDANCE)]
}

/// MuJoCo's parameters of a critically damped constraint whose impedance does not depend on the penetration.
fn softness_attributes(time_constant_s: f64, impedance: f64) -> [(&'static str, String); 2] {
    [("solref", numbers(&[time_constant_s, 1.0])), ("solimp", numbers(&[impedance, impedance, 0.001]))]
}

/// The couplings of the second finger of each hand to the first.
pub(super) fn couplings(xml: &mut Xml, robot: &Robot, arms: &[ExportedArm<'_>]) -> io::Result<()> {
    xml.create_element("equality").write_inner_content(|xml| {
        for arm in arms {
            let [first, second] = arm.arm.gripper.fingers.as_slice() else { continue };
            let slope = first.opening_sign * second.opening_sign;
            let offset_m = second.closed_m - slope * first.closed_m;
            let mut attributes = vec![
                ("joint1", robot.joints[second.joint].name.clone()),
                ("joint2", robot.joints[first.joint].name.clone()),
                ("polycoef", numbers(&[offset_m, slope, 0.0, 0.0, 0.0])),
            ];
            attributes.extend(softness_attributes(TIME_CONSTANT_S, LARGEST_IMPEDANCE));
            empty(xml, "joint", &attributes)?;
        }
        Ok(())
    })?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_has_the_compliance_of_the_scene_whatever_it_is() {
        for compliance_m_n in [1e-9, 1e-7, 1e-6, 1e-3] {
            let inverse_mass_per_kg = 7.1;
            let [t, d] = softness(compliance_m_n, inverse_mass_per_kg);
            let found = (1.0 - d) * t * t * inverse_mass_per_kg;
            // Rounding of `1 - d`, which is at least 1e-4, to 1e-16.
            assert!((found / compliance_m_n - 1.0).abs() < 1e-11, "{compliance_m_n}: {found}");
            assert!(t >= TIME_CONSTANT_S && (LEAST_IMPEDANCE - 1e-12..=LARGEST_IMPEDANCE).contains(&d), "{t} {d}");
        }
        // Stiffer than MuJoCo allows.
        assert_eq!(softness(1e-12, 7.1)[1], LARGEST_IMPEDANCE);
    }

    #[test]
    fn the_time_step_divides_that_of_the_scenario() {
        for (timestep_s, expected) in [(0.002, 8), (0.0005, 2), (0.00025, 1), (0.004, 16), (0.0003, 2), (0.0012, 5)] {
            let settings = SimulationSettings { timestep_s, ..SimulationSettings::default() };
            assert_eq!(steps_per_sample(&settings), expected, "{timestep_s}");
        }
    }
}
