//! Arms that are given by the lines of their axes at zero angles.

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

/// A chain with these axes and a gripper beyond the last one. `base` is the `xyz` and `rpy` of the base in W; every joint turns
/// from -`limit_rad` to `limit_rad`.
pub fn chain(axes: &[Line], base: [[f64; 3]; 2], limit_rad: f64) -> Chain {
    let text = |v: [f64; 3]| format!("{} {} {}", v[0], v[1], v[2]);
    let mut urdf = String::from("<robot name=\"serial\"><link name=\"base\"/><link name=\"l0\"/>");
    let fixed = |name: &str, parent: &str, child: &str, xyz: [f64; 3], rpy: [f64; 3]| {
        format!(
            "<joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"{}\" rpy=\"{}\"/></joint>",
            text(xyz),
            text(rpy)
        )
    };
    urdf += &fixed("mount", "base", "l0", base[0], base[1]);
    let mut joints = String::new();
    let mut from = [0.0; 3];
    for (number, (point, along)) in axes.iter().enumerate() {
        let offset = std::array::from_fn(|axis| point[axis] - from[axis]);
        from = *point;
        write!(
            urdf,
            "<link name=\"l{0}\"/><joint name=\"j{0}\" type=\"revolute\"><parent link=\"l{number}\"/><child link=\"l{0}\"/>\
             <origin xyz=\"{1}\"/><axis xyz=\"{2}\"/>\
             <limit lower=\"-{limit_rad}\" upper=\"{limit_rad}\" effort=\"100\" velocity=\"1\"/></joint>",
            number + 1,
            text(offset),
            text(*along)
        )
        .unwrap();
        write!(joints, "\"j{}\", ", number + 1).unwrap();
    }
    let last = format!("l{}", axes.len());
    urdf += "<link name=\"palm\"/><link name=\"tip\"/>";
    urdf += &fixed("hand", &last, "palm", [0.02, -0.03, 0.1], [0.3, 0.2, 0.1]);
    urdf += &fixed("point", "palm", "tip", [0.0, 0.0, 0.1], [0.0; 3]);
    for (finger, side) in [(1, 1), (2, -1)] {
        write!(
            urdf,
            "<link name=\"f{finger}\"><collision><origin xyz=\"0 {} 0.05\"/><geometry><box size=\"0.02 0.02 0.02\"/></geometry>\
             </collision></link><joint name=\"g{finger}\" type=\"prismatic\"><parent link=\"palm\"/><child link=\"f{finger}\"/>\
             <origin xyz=\"0 0 0.05\"/><axis xyz=\"0 {side} 0\"/>\
             <limit lower=\"0\" upper=\"0.04\" effort=\"20\" velocity=\"1\"/></joint>",
            0.01 * f64::from(side)
        )
        .unwrap();
    }
    let each = vec!["100.0"; axes.len()].join(", ");
    let description = format!(
        "format = 1\nurdf = \"serial.urdf\"\nfloor_z_m = -1.0\nbody_points = [{{ link = \"l1\", p_m = [0.0, 0.0, 0.0] }}]\n\
         [[arms]]\nname = \"arm\"\nbase_link = \"l0\"\njoints = [{joints}]\nstiffness_nm_rad = [{each}]\n\
         damping_nm_s_rad = [{each}]\n[arms.gripper]\nframe_link = \"tip\"\npalm_link = \"palm\"\nopening_m = [0.0, 0.08]\n\
         max_force_n = 20.0\npad_size_m = [0.02, 0.02]\npad_centre_m = [0.0, 0.0]\nfingers = [\n\
         {{ name = \"one\", joint = \"g1\", pad_link = \"f1\" }},\n{{ name = \"other\", joint = \"g2\", pad_link = \"f2\" }},\n]\n"
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("serial.urdf"), urdf + "</robot>").unwrap();
    std::fs::write(folder.path().join("serial.toml"), description).unwrap();
    Chain::new(&Robot::load("serial.toml", folder.path()).unwrap(), 0, 0.0)
}
