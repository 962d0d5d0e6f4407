//! Robots whose arms are given by the lines of their axes at zero angles.

// No binary uses all of it.
#![allow(dead_code)]

use std::fmt::Write;

use benchdog::robot::{Chain, Robot};

/// The axis of a joint at zero angles in the frame of the arm's base: a point on it, m, and its direction.
pub type Line = ([f64; 3], [f64; 3]);

/// The Panda of Franka Robotics: a spherical shoulder, and an elbow and a wrist with offsets.
pub const PANDA: [Line; 7] = [
    ([0.0, 0.0, 0.333], [0.0, 0.0, 1.0]),
    ([0.0, 0.0, 0.333], [0.0, 1.0, 0.0]),
    ([0.0, 0.0, 0.649], [0.0, 0.0, 1.0]),
    ([0.0825, 0.0, 0.649], [0.0, -1.0, 0.0]),
    ([0.0, 0.0, 1.033], [0.0, 0.0, 1.0]),
    ([0.0, 0.0, 1.033], [0.0, -1.0, 0.0]),
    ([0.088, 0.0, 1.033], [0.0, 0.0, -1.0]),
];

/// The iiwa 14 of Kuka: a spherical shoulder and a spherical wrist without offsets.
pub const IIWA: [Line; 7] = [
    ([0.0, 0.0, 0.1575], [0.0, 0.0, 1.0]),
    ([0.0, 0.0, 0.36], [0.0, 1.0, 0.0]),
    ([0.0, 0.0, 0.5645], [0.0, 0.0, 1.0]),
    ([0.0, 0.0, 0.78], [0.0, -1.0, 0.0]),
    ([0.0, 0.0, 0.9645], [0.0, 0.0, 1.0]),
    ([0.0, 0.0, 1.18], [0.0, 1.0, 0.0]),
    ([0.0, 0.0, 1.261], [0.0, 0.0, 1.0]),
];

/// The UR5 of Universal Robots: three parallel axes.
pub const UR5: [Line; 6] = [
    ([0.0, 0.0, 0.089159], [0.0, 0.0, 1.0]),
    ([0.0, 0.13585, 0.089159], [0.0, 1.0, 0.0]),
    ([0.425, 0.01615, 0.089159], [0.0, 1.0, 0.0]),
    ([0.81725, 0.01615, 0.089159], [0.0, 1.0, 0.0]),
    ([0.81725, 0.10915, 0.089159], [0.0, 0.0, -1.0]),
    ([0.81725, 0.10915, -0.005491], [0.0, 1.0, 0.0]),
];

/// An industrial arm: the shoulder's axes do not meet, those of upper arm and elbow are parallel, the wrist is spherical.
pub const INDUSTRIAL: [Line; 6] = [
    ([0.0, 0.0, 0.2], [0.0, 0.0, 1.0]),
    ([0.15, 0.0, 0.45], [0.0, 1.0, 0.0]),
    ([0.15, 0.0, 1.05], [0.0, 1.0, 0.0]),
    ([0.3, 0.0, 1.25], [1.0, 0.0, 0.0]),
    ([0.79, 0.0, 1.25], [0.0, 1.0, 0.0]),
    ([0.9, 0.0, 1.25], [1.0, 0.0, 0.0]),
];

/// The base of an arm in W: `xyz`, m, and `rpy`, rad.
pub type Base = [[f64; 3]; 2];

/// A capsule of an arm without its caps: the number of the joint that moves it, and its middle at zero angles in the frame of
/// the base, m; it is vertical.
type Cylinder = (usize, [f64; 3]);

/// Upper arm and forearm of [`PANDA`].
const CYLINDERS: [Cylinder; 2] = [(3, [0.0, 0.0, 0.49]), (5, [0.0, 0.0, 0.84])];

/// Length and radius of the cylinders, m.
const CYLINDER_M: [f64; 2] = [0.22, 0.05];

/// The pose of the palm behind the last joint: `xyz` and `rpy`. Any pose serves inverse kinematics.
const TILTED: Base = [[0.02, -0.03, 0.1], [0.3, 0.2, 0.1]];

/// A hand like the Panda's, along the last axis, which points down at zero angles.
const STRAIGHT: Base = [[0.0, 0.0, -0.107], [std::f64::consts::PI, 0.0, 0.0]];

/// A chain with these axes and a gripper beyond the last one; every joint turns from -`limit_rad` to `limit_rad`.
pub fn chain(axes: &[Line], base: Base, limit_rad: f64) -> Chain {
    Chain::new(&Arms { axes, cylinders: &[], hand: TILTED, limit_rad }.robot(&[base]), 0, 0.0)
}

/// A robot with Panda arms at these bases, 0.8 m above the floor. Its bodies are upper arms, forearms, palms and fingers.
pub fn pandas(bases: &[Base]) -> Robot {
    Arms { axes: &PANDA, cylinders: &CYLINDERS, hand: STRAIGHT, limit_rad: 2.8 }.robot(bases)
}

/// Equal arms.
struct Arms<'a> {
    axes: &'a [Line],
    cylinders: &'a [Cylinder],
    hand: Base,
    limit_rad: f64,
}

impl Arms<'_> {
    /// The robot with an arm at each of these bases.
    fn robot(&self, bases: &[Base]) -> Robot {
        let mut urdf = String::from("<robot name=\"serial\"><link name=\"base\"/>");
        let mut description = String::from(
            "format = 1\nurdf = \"serial.urdf\"\nfloor_z_m = -0.8\nbody_points = [{ link = \"{arm}_l1\", p_m = [0.0, 0.0, 0.0] }]\n",
        );
        for (arm, base) in bases.iter().enumerate() {
            self.add_links(&mut urdf, &format!("a{arm}_"), base);
            self.describe(&mut description, &format!("a{arm}"));
        }
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("serial.urdf"), urdf + "</robot>").unwrap();
        std::fs::write(folder.path().join("serial.toml"), description).unwrap();
        Robot::load("serial.toml", folder.path()).unwrap()
    }

    /// Adds the links and joints of one arm, whose names have this prefix.
    fn add_links(&self, urdf: &mut String, prefix: &str, base: &Base) {
        let mut from = [0.0; 3];
        *urdf += &fixed(prefix, "base", "l0", base).replacen(&format!("{prefix}base"), "base", 1);
        for (number, (point, along)) in self.axes.iter().enumerate() {
            let joint = number + 1;
            let bodies = self.cylinders.iter().filter(|(of, _)| *of == joint);
            let bodies: String = bodies.map(|(_, middle)| cylinder(offset(point, middle))).collect();
            let limit_rad = self.limit_rad;
            write!(
                urdf,
                "<link name=\"{prefix}l{joint}\">{bodies}{MASS}</link><joint name=\"{prefix}j{joint}\" type=\"revolute\">\
                 <parent link=\"{prefix}l{number}\"/><child link=\"{prefix}l{joint}\"/><origin xyz=\"{}\"/>\
                 <axis xyz=\"{}\"/><limit lower=\"-{limit_rad}\" upper=\"{limit_rad}\" effort=\"87\" velocity=\"1\"/></joint>",
                text(&offset(&from, point)),
                text(along)
            )
            .unwrap();
            from = *point;
        }
        let palm = if self.cylinders.is_empty() { "" } else { PALM };
        *urdf += &fixed(prefix, &format!("l{}", self.axes.len()), "palm", &self.hand).replacen(
            "/>",
            &format!(">{palm}{MASS}</link>"),
            1,
        );
        *urdf += &fixed(prefix, "palm", "tip", &[[0.0, 0.0, 0.1034], [0.0; 3]]);
        for (finger, side) in [(1, 1.0), (2, -1.0)] {
            write!(
                urdf,
                "<link name=\"{prefix}f{finger}\"><collision><origin xyz=\"0 {} 0.04\"/><geometry><box size=\"0.02 0.02 0.03\"/>\
                 </geometry></collision></link><joint name=\"{prefix}g{finger}\" type=\"prismatic\">\
                 <parent link=\"{prefix}palm\"/><child link=\"{prefix}f{finger}\"/><origin xyz=\"0 0 0.0584\"/>\
                 <axis xyz=\"0 {side} 0\"/><limit lower=\"0\" upper=\"0.04\" effort=\"70\" velocity=\"1\"/></joint>",
                0.01 * side
            )
            .unwrap();
        }
    }

    /// Adds the description of one arm.
    fn describe(&self, description: &mut String, name: &str) {
        let joints: Vec<_> = (1..=self.axes.len()).map(|joint| format!("\"{name}_j{joint}\"")).collect();
        let each = |value: &str| vec![value; joints.len()].join(", ");
        write!(
            description,
            "[[arms]]\nname = \"{name}\"\nbase_link = \"{name}_l0\"\njoints = [{}]\nstiffness_nm_rad = [{}]\n\
             damping_nm_s_rad = [{}]\n[arms.gripper]\nframe_link = \"{name}_tip\"\npalm_link = \"{name}_palm\"\n\
             opening_m = [0.0, 0.08]\nmax_force_n = 70.0\npad_size_m = [0.018, 0.018]\npad_centre_m = [0.0, 0.0]\nfingers = [\n\
             {{ name = \"one\", joint = \"{name}_g1\", pad_link = \"{name}_f1\" }},\n\
             {{ name = \"other\", joint = \"{name}_g2\", pad_link = \"{name}_f2\" }},\n]\n",
            joints.join(", "),
            each("3000.0"),
            each("50.0")
        )
        .unwrap();
    }
}

/// The mass of a link.
const MASS: &str = "<inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";

/// The body of a palm: its face is 22 mm behind the tip, as the Panda's.
const PALM: &str = "<collision><origin xyz=\"0 0 0.03\"/><geometry><box size=\"0.06 0.2 0.1\"/></geometry></collision>";

/// A link without a body at a fixed pose in its parent.
fn fixed(prefix: &str, parent: &str, child: &str, [xyz, rpy]: &Base) -> String {
    format!(
        "<link name=\"{prefix}{child}\"/><joint name=\"{prefix}{child}_at\" type=\"fixed\"><parent link=\"{prefix}{parent}\"/>\
         <child link=\"{prefix}{child}\"/><origin xyz=\"{}\" rpy=\"{}\"/></joint>",
        text(xyz),
        text(rpy)
    )
}

/// The body of a cylinder.
fn cylinder(middle: [f64; 3]) -> String {
    let [length_m, radius_m] = CYLINDER_M;
    let geometry = format!("<cylinder length=\"{length_m}\" radius=\"{radius_m}\"/>");
    format!("<collision><origin xyz=\"{}\"/><geometry>{geometry}</geometry></collision>", text(&middle))
}

fn offset(from: &[f64; 3], to: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| to[axis] - from[axis])
}

fn text(v: &[f64; 3]) -> String {
    format!("{} {} {}", v[0], v[1], v[2])
}
