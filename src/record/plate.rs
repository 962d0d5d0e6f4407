//! A plate as a mesh with its holes.

use rerun::{Color, EntityPath, Mesh3D};

use super::{
    crossings::colours_over_time,
    error::RecordError,
    frames::{Frames, vec3},
    messages::Messages,
};
use crate::model::{board_mesh::BoardMesh, plate::Plate};

/// Logs the surface of a plate of this thickness, m: in its `own` colour from the start, in that of limits from the time
/// `crossed_s`.
pub(super) fn log(
    messages: &mut Messages,
    path: &EntityPath,
    frames: &Frames,
    (plate, thickness_m): (&Plate, f64),
    own: Color,
    crossed_s: Option<f64>,
) -> Result<(), RecordError> {
    let mesh = BoardMesh::new(plate, thickness_m);
    let corners = mesh.triangles_o.iter().flatten().map(|corner| vec3(&corner.coords));
    let normals = mesh.normals_o().flat_map(|normal| [vec3(&normal); 3]);
    let surface = Mesh3D::new(corners).with_vertex_normals(normals);
    let Some((times_s, colours)) = colours_over_time(frames, own, crossed_s) else {
        return messages.log_static(path, &surface.with_albedo_factor(own.0));
    };
    messages.log_static(path, &surface)?;
    let colours = Mesh3D::update_fields().with_many_albedo_factor(colours.into_iter().map(|colour| colour.0));
    messages.log_columns(path, &times_s, colours.columns_of_unit_batches().map_err(RecordError::encode)?)
}
