//! Positions of surface points on their maps: at the uvs of the material's leading texture.

use super::appearance::Part;
use crate::math::Vec2;
use crate::mesh::Mesh;
use crate::scene::{Material, TextureRef, UvTransform};
use std::borrow::Cow;

/// Returns the texture whose uv set and transform define where a material's errors are laid out, on a mesh with this
/// number of uv sets: its normal map, else its height map, its base colour, or any other. `None` if the mesh lacks
/// the uv sets of all of them.
pub fn leading_texture(material: &Material, uv_sets: usize) -> Option<TextureRef> {
    let normal = material.normal.map(|map| map.texture);
    let height = material.height.map(|map| map.texture);
    let first = normal.into_iter().chain(height).chain(material.base_color_texture);
    first.chain(material.textures()).find(|texture| texture.uv_set < uv_sets)
}

/// Returns the leading texture of each part.
pub(super) fn leading<'a>(
    parts: &'a [Part],
    materials: &'a [Material],
) -> impl Iterator<Item = Option<TextureRef>> + 'a {
    parts.iter().map(|part| leading_texture(&materials[part.material], part.uv_sets))
}

/// Returns the position of each vertex of all parts on the maps of its material: transformed uvs; the first set's
/// untransformed ones without textures. Empty if no part has uvs.
pub(super) fn places<'a>(mesh: &'a Mesh, parts: &[Part], leads: &[Option<TextureRef>]) -> Cow<'a, [Vec2]> {
    let first = mesh.uvs().first().map_or(&[][..], Vec::as_slice);
    let is_first = |lead: &TextureRef| lead.uv_set == 0 && lead.transform == UvTransform::default();
    if leads.iter().flatten().all(is_first) {
        return first.into();
    }
    let mut places = first.to_vec();
    let ends = parts.iter().skip(1).map(|part| part.vertex as usize).chain([places.len()]);
    for ((part, end), lead) in parts.iter().zip(ends).zip(leads) {
        let Some((lead, uvs)) = lead.and_then(|lead| Some((lead, mesh.uvs().get(lead.uv_set)?))) else {
            continue;
        };
        for v in part.vertex as usize..end {
            places[v] = lead.transform.apply(uvs[v]);
        }
    }
    places.into()
}
