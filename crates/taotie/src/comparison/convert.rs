//! Converts a material's normal map to the other space.

use crate::bake::{TexelGrid, TexelSurface};
use crate::error::Result;
use crate::image::{Bitmap, Image};
use crate::mesh::Mesh;
use crate::normal_map::{Storage, decoded_normals, object_from_tangent, store_normals, tangent_from_object};
use crate::scene::{GreenChannel, NormalMap, NormalSpace};
use crate::surface::{TangentMethod, with_frames};

/// Texels around UV islands that are also filled, as a fraction of the map's side: enough for visible mip levels.
const PADDING: u32 = 128;

/// A converted map.
pub(super) struct Converted {
    /// 16 bits, green up.
    pub(super) bitmap: Bitmap,
    /// Its space, in words.
    pub(super) space: &'static str,
    /// Texels covered by more than one triangle, which cannot be right for all of them in object space.
    pub(super) shared: usize,
}

/// Returns `source`, a map used as in `map`, converted to the other space for `mesh`.
pub(super) fn other_space(
    mesh: &Mesh,
    source: &Bitmap,
    map: &NormalMap,
    tangents: Option<TangentMethod>,
) -> Result<Converted> {
    let surface = laid_out(mesh, [source.width(), source.height()], map, tangents)?;
    let mut normals = decoded_normals(source, map.space, map.green)?;
    scale(&mut normals, map);
    let (other, space, made) = match map.space {
        NormalSpace::Tangent => {
            (NormalSpace::Object, "object space", object_from_tangent(&surface, &normals)?)
        }
        NormalSpace::Object => {
            (NormalSpace::Tangent, "tangent space", tangent_from_object(&surface, &normals)?)
        }
    };
    let storage = Storage { bits: 16, dither: false };
    let bitmap = store_normals(&made, other, GreenChannel::Up, storage)?.bitmap;
    Ok(Converted { bitmap, space, shared: surface.coverage().shared() })
}

/// Returns the mesh laid out on the map, by the uvs used to look up the map and with the frames that the renderer
/// gives it.
fn laid_out(
    mesh: &Mesh,
    [width, height]: [u32; 2],
    map: &NormalMap,
    tangents: Option<TangentMethod>,
) -> Result<TexelSurface> {
    let uv_set = map.texture.uv_set;
    let (mesh, _) = with_frames(mesh, uv_set, tangents)?;
    let mut data = mesh.into_owned().into_data();
    for uv in &mut data.uvs[uv_set] {
        *uv = map.texture.transform.apply(*uv);
    }
    let padding = (width.max(height) / PADDING).max(2);
    TexelSurface::new(Mesh::new(data)?, &TexelGrid { width, height, uv_set, padding })
}

/// Returns glTF's `scale` on x and y of tangent-space normals.
fn scale(normals: &mut Image, map: &NormalMap) {
    if map.space == NormalSpace::Tangent && map.scale != 1.0 {
        for [x, y, ..] in normals.pixels_mut() {
            (*x, *y) = (*x * map.scale, *y * map.scale);
        }
    }
}
