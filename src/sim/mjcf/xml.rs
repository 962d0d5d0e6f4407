//! Elements and attributes.

use std::io;

use quick_xml::{Writer, writer::ElementWriter};

use crate::model::frames::Pose;

/// A document in memory.
pub(super) type Xml = Writer<Vec<u8>>;

/// Writes an element without content.
pub(super) fn empty(xml: &mut Xml, name: &str, attributes: &[(&str, String)]) -> io::Result<()> {
    with(xml.create_element(name), attributes).write_empty()?;
    Ok(())
}

/// An element with these attributes.
pub(super) fn with<'a>(
    element: ElementWriter<'a, Vec<u8>>,
    attributes: &[(&str, String)],
) -> ElementWriter<'a, Vec<u8>> {
    element.with_attributes(attributes.iter().map(|(key, value)| (*key, value.as_str())))
}

/// Numbers in the shortest decimals that read back exactly.
pub(super) fn numbers(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

/// A pose in MuJoCo's order: position `x y z`, then the quaternion `w x y z`.
pub(super) fn pose_numbers(pose: &Pose) -> [f64; 7] {
    let ([x, y, z], [i, j, k, w]): ([f64; 3], [f64; 4]) =
        (pose.translation.vector.into(), pose.rotation.quaternion().coords.into());
    [x, y, z, w, i, j, k]
}

/// The attributes of a pose.
pub(super) fn pose_attributes(pose: &Pose) -> [(&'static str, String); 2] {
    let all = pose_numbers(pose);
    [("pos", numbers(&all[..3])), ("quat", numbers(&all[3..]))]
}

/// A geom of a kind and its sizes that has no mass and collides with nothing but in explicit contact pairs.
pub(super) fn geom(
    xml: &mut Xml,
    name: &str,
    (kind, size): (&str, &[f64]),
    x_bg: &Pose,
    look: (u8, [f64; 4]),
) -> io::Result<()> {
    let attributes = vec![("name", name.to_owned()), ("type", kind.into()), ("size", numbers(size))];
    any_geom(xml, attributes, x_bg, look)
}

/// As [`geom`], with the mesh of the same name.
pub(super) fn mesh_geom(xml: &mut Xml, name: &str, x_bg: &Pose, look: (u8, [f64; 4])) -> io::Result<()> {
    let attributes = vec![("name", name.to_owned()), ("type", "mesh".into()), ("mesh", name.to_owned())];
    any_geom(xml, attributes, x_bg, look)
}

fn any_geom(
    xml: &mut Xml,
    mut attributes: Vec<(&str, String)>,
    x_bg: &Pose,
    (group, rgba): (u8, [f64; 4]),
) -> io::Result<()> {
    attributes.extend(pose_attributes(x_bg));
    attributes.extend([("contype", "0".into()), ("conaffinity", "0".into()), ("mass", "0".into())]);
    attributes.extend([("group", group.to_string()), ("rgba", numbers(&rgba))]);
    empty(xml, "geom", &attributes)
}

/// A site.
pub(super) fn site(xml: &mut Xml, name: &str, x_bs: &Pose) -> io::Result<()> {
    let mut attributes = vec![("name", name.to_owned()), ("size", "0.003".into())];
    attributes.extend(pose_attributes(x_bs));
    empty(xml, "site", &attributes)
}
