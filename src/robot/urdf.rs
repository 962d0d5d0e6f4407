//! Reads a URDF into links and joints.
//!
//! urdf-rs parses the XML; this module checks the result and converts it into a [`Tree`] with parents before children.
//! Arms and grippers are defined by the description.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};
use urdf_rs::{Geometry, JointType};

use super::tree::{Joint, JointKind, Link, PlacedShape, Shape};
use crate::model::frames::Pose;

/// Colour of geometry without a colour in its visual.
const DEFAULT_RGBA: [f64; 4] = [0.6, 0.6, 0.6, 1.0];

/// Tolerance of negative eigenvalues of an inertia, relative to the largest, since published values are rounded.
const INERTIA_TOLERANCE: f64 = 1e-6;

/// The content of a URDF, parents before children.
pub(super) struct Tree {
    /// The root comes first.
    pub links: Vec<Link>,
    /// In the order in which the links are reached from the root.
    pub joints: Vec<Joint>,
    /// The effort limit of each joint, N m or N; 0 where the URDF gives none.
    pub effort: Vec<f64>,
}

/// Reads a URDF.
///
/// # Errors
/// The message names the link or joint, the value found and the value expected.
pub(super) fn read(text: &str) -> Result<Tree, String> {
    let robot = urdf_rs::read_from_string(text).map_err(|error| format!("found malformed urdf: {error}"))?;
    let colours = global_colours(&robot.materials);
    let index = index_by_name("link", robot.links.iter().map(|link| link.name.as_str()))?;
    index_by_name("joint", robot.joints.iter().map(|joint| joint.name.as_str()))?;
    let hierarchy = Hierarchy::new(&robot, &index)?;
    let mut tree = Tree { links: Vec::new(), joints: Vec::new(), effort: Vec::new() };
    tree.add(&robot, &hierarchy, &colours, hierarchy.root, None)?;
    if let Some(lost) = robot.links.iter().find(|link| tree.links.iter().all(|reached| reached.name != link.name)) {
        return Err(format!(
            "link {}: found no chain of joints from the root {}, expected one tree",
            lost.name, tree.links[0].name
        ));
    }
    Ok(tree)
}

/// The tree by indices into the URDF's lists.
struct Hierarchy {
    root: usize,
    /// For each link its child joints and child links, in file order.
    children: Vec<Vec<(usize, usize)>>,
}

impl Hierarchy {
    fn new(robot: &urdf_rs::Robot, index: &BTreeMap<&str, usize>) -> Result<Self, String> {
        let mut children = vec![Vec::new(); robot.links.len()];
        let mut carrier: Vec<Option<&str>> = vec![None; robot.links.len()];
        for (number, joint) in robot.joints.iter().enumerate() {
            let find = |name: &str| {
                index.get(name).copied().ok_or_else(|| {
                    format!("joint {}: found link \"{name}\", expected the name of a link of this file", joint.name)
                })
            };
            let (parent, child) = (find(&joint.parent.link)?, find(&joint.child.link)?);
            if let Some(other) = carrier[child].replace(&joint.name) {
                return Err(format!(
                    "link {}: found two joints that carry it, {other} and {}, expected one",
                    joint.child.link, joint.name
                ));
            }
            children[parent].push((number, child));
        }
        let roots: Vec<usize> = (0..robot.links.len()).filter(|&link| carrier[link].is_none()).collect();
        match roots[..] {
            [root] => Ok(Self { root, children }),
            _ => Err(format!("found {} links that no joint carries, expected one, the root", roots.len())),
        }
    }
}

impl Tree {
    /// Adds a link and its descendants; the recursion depth is that of the tree.
    fn add(
        &mut self,
        robot: &urdf_rs::Robot,
        hierarchy: &Hierarchy,
        colours: &BTreeMap<&str, [f64; 4]>,
        link: usize,
        parent_joint: Option<usize>,
    ) -> Result<(), String> {
        let placed = self.links.len();
        self.links.push(read_link(&robot.links[link], parent_joint, colours)?);
        for &(joint, child) in &hierarchy.children[link] {
            let (read, effort) = read_joint(&robot.joints[joint], placed, self.links.len())?;
            self.joints.push(read);
            self.effort.push(effort);
            self.add(robot, hierarchy, colours, child, Some(self.joints.len() - 1))?;
        }
        Ok(())
    }
}

fn index_by_name<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Result<BTreeMap<&'a str, usize>, String> {
    let mut index = BTreeMap::new();
    for (number, name) in names.enumerate() {
        if index.insert(name, number).is_some() {
            return Err(format!("{what} {name}: found this name twice, expected names to be unique"));
        }
    }
    Ok(index)
}

fn global_colours(materials: &[urdf_rs::Material]) -> BTreeMap<&str, [f64; 4]> {
    materials.iter().filter_map(|m| m.color.as_ref().map(|c| (m.name.as_str(), c.rgba.0))).collect()
}

fn read_link(
    link: &urdf_rs::Link,
    parent_joint: Option<usize>,
    colours: &BTreeMap<&str, [f64; 4]>,
) -> Result<Link, String> {
    let at = |problem: String| format!("link {}: {problem}", link.name);
    let (mass_kg, com_l, inertia_l) = read_inertial(&link.inertial).map_err(at)?;
    let mut shapes = Vec::with_capacity(link.collision.len());
    for (number, collision) in link.collision.iter().enumerate() {
        // Pictures show the collision shapes with the colours of the visuals.
        let visual =
            if link.visual.len() == link.collision.len() { link.visual.get(number) } else { link.visual.first() };
        shapes.push(PlacedShape {
            x_ls: read_pose(&collision.origin).map_err(at)?,
            shape: read_shape(&collision.geometry).map_err(at)?,
            rgba: visual.and_then(|v| colour(v, colours)).unwrap_or(DEFAULT_RGBA),
        });
    }
    Ok(Link { name: link.name.clone(), parent_joint, mass_kg, com_l, inertia_l, shapes })
}

fn colour(visual: &urdf_rs::Visual, colours: &BTreeMap<&str, [f64; 4]>) -> Option<[f64; 4]> {
    let material = visual.material.as_ref()?;
    material.color.as_ref().map(|c| c.rgba.0).or_else(|| colours.get(material.name.as_str()).copied())
}

/// Mass, centre of mass in the link, inertia about the centre of mass in axes of the link.
fn read_inertial(inertial: &urdf_rs::Inertial) -> Result<(f64, Vector3<f64>, Matrix3<f64>), String> {
    let mass_kg = inertial.mass.value;
    if !(mass_kg.is_finite() && mass_kg >= 0.0) {
        return Err(format!("found a mass of {mass_kg} kg, expected a finite number, at least 0"));
    }
    let i = &inertial.inertia;
    let inertia = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
    if !inertia.iter().all(|v| v.is_finite()) {
        return Err("found an inertia that is not finite, expected kg m^2".into());
    }
    let eigenvalues = inertia.symmetric_eigenvalues();
    if eigenvalues.min() < -INERTIA_TOLERANCE * eigenvalues.amax() {
        return Err(format!("found an inertia with eigenvalue {}, expected none below 0", eigenvalues.min()));
    }
    let x_lc = read_pose(&inertial.origin)?;
    let r = x_lc.rotation.to_rotation_matrix();
    Ok((mass_kg, x_lc.translation.vector, r.matrix() * inertia * r.matrix().transpose()))
}

fn read_pose(pose: &urdf_rs::Pose) -> Result<Pose, String> {
    if !pose.xyz.iter().chain(pose.rpy.iter()).all(|v| v.is_finite()) {
        return Err("found an origin that is not finite, expected m and rad".into());
    }
    let [roll, pitch, yaw] = pose.rpy.0;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok(Isometry3::from_parts(Translation3::from(pose.xyz.0), rotation))
}

fn read_shape(geometry: &Geometry) -> Result<Shape, String> {
    let (shape, sizes) = match geometry {
        Geometry::Box { size } => (Shape::Box { half_m: size.map(|side| side / 2.0) }, size.to_vec()),
        Geometry::Cylinder { radius, length } => {
            (Shape::Cylinder { radius_m: *radius, half_length_m: length / 2.0 }, vec![*radius, *length])
        }
        Geometry::Sphere { radius } => (Shape::Sphere { radius_m: *radius }, vec![*radius]),
        Geometry::Capsule { .. } => return Err(unsupported("a capsule")),
        Geometry::Mesh { filename, .. } => return Err(unsupported(&format!("the mesh {filename}"))),
    };
    match sizes.iter().find(|size| !(size.is_finite() && **size > 0.0)) {
        Some(size) => Err(format!("found geometry with a size of {size} m, expected sizes above 0")),
        None => Ok(shape),
    }
}

fn unsupported(found: &str) -> String {
    format!("found {found} as collision geometry, expected a box, a cylinder or a sphere")
}

/// A joint and its effort limit.
fn read_joint(joint: &urdf_rs::Joint, parent_link: usize, child_link: usize) -> Result<(Joint, f64), String> {
    let at = |problem: String| format!("joint {}: {problem}", joint.name);
    let kind = match joint.joint_type {
        JointType::Fixed => JointKind::Fixed,
        JointType::Revolute | JointType::Continuous => JointKind::Revolute,
        JointType::Prismatic => JointKind::Prismatic,
        ref other => {
            return Err(at(format!("found type {other:?}, expected fixed, revolute, continuous or prismatic")));
        }
    };
    // Fingers of a gripper often mimic each other in a URDF; the description defines that instead.
    if joint.mimic.is_some() && kind != JointKind::Prismatic {
        return Err(at("found a joint that mimics another, expected joints that move by themselves".into()));
    }
    let (lower, upper) = read_limits(joint).map_err(at)?;
    let axis = Vector3::from(joint.axis.xyz.0);
    let axis_j = if kind == JointKind::Fixed { Some(Vector3::x_axis()) } else { Unit::try_new(axis, 1e-9) };
    let axis_j = axis_j
        .filter(|axis| axis.iter().all(|v| v.is_finite()))
        .ok_or_else(|| at(format!("found axis {:?}, expected a direction", joint.axis.xyz.0)))?;
    let x_pj = read_pose(&joint.origin).map_err(at)?;
    let read = Joint { name: joint.name.clone(), kind, parent_link, child_link, x_pj, axis_j, lower, upper };
    Ok((read, joint.limit.effort))
}

/// Limits of a joint: zero for a fixed joint, half a turn either way for a continuous joint.
fn read_limits(joint: &urdf_rs::Joint) -> Result<(f64, f64), String> {
    match joint.joint_type {
        JointType::Fixed => return Ok((0.0, 0.0)),
        JointType::Continuous => return Ok((-std::f64::consts::PI, std::f64::consts::PI)),
        _ => {}
    }
    let (lower, upper) = (joint.limit.lower, joint.limit.upper);
    if lower.is_finite() && upper.is_finite() && lower < upper {
        Ok((lower, upper))
    } else {
        Err(format!("found limits {lower} to {upper}, expected two finite numbers, the lower first"))
    }
}
