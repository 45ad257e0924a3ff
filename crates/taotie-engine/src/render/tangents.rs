//! Tangents that follow a surface as it is deformed.

use super::settings::SurfaceSettings;
use crate::error::{Result, Warnings};
use crate::mesh::Mesh;
use crate::mesh::deform::Deformable;
use crate::scene::animation::Rig;
use crate::scene::{NormalSpace, Scene};
use crate::surface::{self, SurfaceMethod, TangentMethod};

/// Gives each mesh with a tangent-space normal map the tangents of its authored shape, if it lacks them or `settings`
/// asks for others; from then on `rig` deforms them with it. Resets `scene` to rest. Returns the rig, and the
/// settings that keep those tangents.
///
/// Otherwise they are recomputed for every pose. A map is baked with the tangents of the authored shape, so these,
/// moved along, are correct for it, and glTF 2.0, 3.7.2.1 requires them. MikkTSpace of a deformed mesh follows the
/// stretched uvs instead, and may weld and split different vertices from one image to the next.
///
/// Meshes without normals are skipped: they are flat in every pose, and so are their tangents.
///
/// # Errors
/// As for [`surface::with_tangents`] and [`Rig::rest`].
pub fn bind_tangents(
    scene: &mut Scene,
    rig: Rig,
    settings: &SurfaceSettings,
    warnings: &mut Warnings,
) -> Result<(Rig, SurfaceSettings)> {
    let maker = Maker { method: settings.tangents, warnings };
    let rig = if reads_tangent_maps(settings) { maker.bind(scene, rig)? } else { rig };
    rig.rest(scene)?;
    Ok((rig, SurfaceSettings { tangents: None, ..*settings }))
}

fn reads_tangent_maps(settings: &SurfaceSettings) -> bool {
    settings.method.is_none_or(|method| method == SurfaceMethod::TangentNormal)
}

struct Maker<'a> {
    method: Option<TangentMethod>,
    warnings: &'a mut Warnings,
}

impl Maker<'_> {
    fn bind(mut self, scene: &mut Scene, rig: Rig) -> Result<Rig> {
        let mut data = rig.into_data();
        for mesh in 0..scene.meshes().len() {
            let Some(uv_set) = tangent_uv_set(scene, mesh) else { continue };
            match data.deformed.iter_mut().find(|deformed| deformed.mesh == mesh) {
                Some(deformed) => self.bind_shape(&mut deformed.shape, uv_set)?,
                None if self.method.is_some() => {
                    let tangented = self.tangented(&scene.meshes()[mesh], uv_set)?;
                    scene.edit(|parts| parts.meshes[mesh] = tangented)?;
                }
                None => {}
            }
        }
        Rig::new(data)
    }

    fn bind_shape(&mut self, shape: &mut Deformable, uv_set: usize) -> Result<()> {
        let lacks = shape.base.tangents.is_empty() || self.method.is_some();
        if !lacks || shape.base.normals.is_empty() {
            return Ok(());
        }
        let made = self.tangented(&Mesh::new(shape.base.clone())?, uv_set)?;
        let corners = made.triangles().iter().map(|t| t.map(|vertex| made.tangents()[vertex as usize]));
        *shape = std::mem::take(shape).with_corner_tangents(&corners.collect::<Vec<_>>())?;
        Ok(())
    }

    fn tangented(&mut self, mesh: &Mesh, uv_set: usize) -> Result<Mesh> {
        let method = self.method.unwrap_or(TangentMethod::MikkTSpace);
        let made = surface::with_tangents(mesh, uv_set, method)?;
        self.warnings.note(surface::NO_UV_AREA, made.degenerate_uvs);
        Ok(made.mesh)
    }
}

/// The uv set of the tangent-space normal map of a mesh; if there are several, the first.
fn tangent_uv_set(scene: &Scene, mesh: usize) -> Option<usize> {
    let materials =
        scene.instances().iter().filter(|i| i.mesh == mesh).map(|i| &scene.materials()[i.material]);
    let maps = materials.filter_map(|m| m.normal.as_ref()).filter(|map| map.space == NormalSpace::Tangent);
    let sets = maps.map(|map| map.texture.uv_set);
    let there = &scene.meshes()[mesh];
    sets.into_iter().find(|set| *set < there.uvs().len() && !there.normals().is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Bitmap, Encoding, Sampler as TextureSampler, Texels, Texture};
    use crate::math::{Mat4, Vec2, Vec3};
    use crate::mesh::MeshData;
    use crate::mesh::deform::MorphTarget;
    use crate::scene::animation::{Animation, Channel, Interpolation, Node, Path, RigData, Sampler};
    use crate::scene::{GreenChannel, Instance, Material, NormalMap, SceneData, TextureRef, UvTransform};

    /// A square whose uvs follow it, and which a morph target shears along x.
    fn sheared() -> (Scene, Rig) {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let base = MeshData {
            positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).into(),
            normals: vec![Vec3::new(0.0, 0.0, 1.0); 4],
            uvs: vec![corners.map(|[x, y]| Vec2::new(x, 1.0 - y)).into()],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        };
        let target = MorphTarget {
            positions: corners.map(|[x, _]| Vec3::new(0.0, x, 0.0)).into(),
            ..MorphTarget::default()
        };
        let texel = Bitmap::new(1, 1, 3, Texels::U8(vec![[128, 128, 255, 255]])).unwrap();
        let texture = TextureRef {
            texture: 0,
            uv_set: 0,
            sampler: TextureSampler::default(),
            transform: UvTransform::default(),
        };
        let map = NormalMap { texture, scale: 1.0, space: NormalSpace::Tangent, green: GreenChannel::Up };
        let scene = Scene::new(SceneData {
            meshes: vec![Mesh::new(base.clone()).unwrap()],
            materials: vec![Material { normal: Some(map), ..Material::default() }],
            textures: vec![Texture::new(texel, Encoding::Normal)],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..SceneData::default()
        });
        let sampler = Sampler::new(Interpolation::Linear, vec![0.0, 1.0], vec![0.0, 1.0]).unwrap();
        let channel = Channel { node: 0, path: Path::Weights, sampler: 0 };
        let animation =
            Animation { channels: vec![channel], samplers: vec![sampler], ..Animation::default() };
        let shape = Deformable { base, targets: vec![target], binding: None };
        let rig = Rig::new(RigData {
            nodes: vec![Node { weights: vec![0.0], ..Node::default() }],
            deformed: vec![crate::scene::animation::Deformed { mesh: 0, node: 0, skin: None, shape }],
            instances: vec![Some(0)],
            animations: vec![animation],
            ..RigData::default()
        });
        (scene.unwrap(), rig.unwrap())
    }

    #[test]
    fn bound_tangents_move_with_the_mesh_and_are_not_made_anew() {
        let (mut scene, rig) = sheared();
        let asked = SurfaceSettings { tangents: Some(TangentMethod::Face), ..SurfaceSettings::default() };
        let (rig, settings) = bind_tangents(&mut scene, rig, &asked, &mut Warnings::default()).unwrap();
        assert_eq!((settings.tangents, scene.meshes()[0].tangents().len()), (None, 4));
        rig.pose(&mut scene, 0, 1.0).unwrap();
        // The target moves only positions, so tangents stay; computed from the sheared mesh, they would follow its
        // uvs.
        assert_eq!(scene.meshes()[0].positions()[1], Vec3::new(1.0, 1.0, 0.0));
        assert!(scene.meshes()[0].tangents().iter().all(|t| *t == [1.0, 0.0, 0.0, 1.0]));
        let recomputed = surface::with_tangents(&scene.meshes()[0], 0, TangentMethod::Face).unwrap().mesh;
        assert!(recomputed.tangents().iter().all(|t| (t[1] - 0.5f32.sqrt()).abs() < 1e-6));
    }

    #[test]
    fn nothing_is_made_where_no_map_is_read() {
        let (mut scene, rig) = sheared();
        let smooth = SurfaceSettings { method: Some(SurfaceMethod::Smooth), ..SurfaceSettings::default() };
        bind_tangents(&mut scene, rig, &smooth, &mut Warnings::default()).unwrap();
        assert!(scene.meshes()[0].tangents().is_empty());
    }
}
