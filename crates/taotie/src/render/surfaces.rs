//! A prepared scene's surfaces as plain arrays, for renderers that draw the triangles themselves.

use super::draw::Draw;
use super::prepare::Prepared;
use crate::math::{Vec2, Vec3};
use crate::pixel::NormalSource;
use crate::scene::Material;

/// A mesh in the world with one material, as arrays. Arrays of vertices have equal lengths, except for empty ones.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Surface<'p> {
    /// The vertices' positions, in world space.
    pub positions: &'p [Vec3],
    /// The vertices' normals: unit, in world space.
    pub normals: &'p [Vec3],
    /// The vertices' normals: unit, in object space. Read by [`NormalSource::BumpPrinted`].
    pub object_normals: &'p [Vec3],
    /// The tangents: unit, in world space, with handedness in the fourth number; empty unless a tangent-space map or
    /// a direction is read.
    pub tangents: &'p [[f32; 4]],
    /// The uv sets, origin top left.
    pub uvs: &'p [Vec<Vec2>],
    /// The vertices' colours, linear RGBA; may be empty.
    pub colors: &'p [[f32; 4]],
    /// Indices of three vertices each.
    pub triangles: &'p [[u32; 3]],
    /// The material.
    pub material: &'p Material,
    /// The source of the shading normals.
    pub normal_source: NormalSource,
    /// The columns of the matrix that transforms object-space normals to world space and keeps the length of
    /// uniformly scaled ones.
    pub normal_matrix: [Vec3; 3],
    /// `true` if front faces are clockwise, since the transform mirrors.
    pub mirrored: bool,
}

impl Prepared {
    /// The surfaces, one for each instance of the scene, in the same order.
    ///
    /// ```
    /// use taotie::mesh::Mesh;
    /// use taotie::render::{Prepared, SurfaceSettings};
    /// use taotie::scene::{Material, Scene};
    ///
    /// let scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default())?;
    /// let prepared = Prepared::new(scene, &SurfaceSettings::default())?;
    /// let [sphere] = prepared.surfaces()[..] else { panic!("there is one instance") };
    /// assert_eq!(sphere.positions.len(), sphere.normals.len());
    /// # Ok::<(), taotie::Error>(())
    /// ```
    pub fn surfaces(&self) -> Vec<Surface<'_>> {
        self.ready().draws().all.iter().map(surface).collect()
    }
}

fn surface<'p>(draw: &Draw<'p>) -> Surface<'p> {
    Surface {
        positions: draw.positions,
        normals: draw.normals,
        object_normals: draw.mesh.normals(),
        tangents: draw.tangents,
        uvs: draw.mesh.uvs(),
        colors: draw.mesh.colors(),
        triangles: draw.mesh.triangles(),
        material: draw.material,
        normal_source: draw.normal_source,
        normal_matrix: draw.normal_matrix,
        mirrored: draw.mirrored,
    }
}

#[cfg(test)]
mod tests {
    use crate::math::{Mat4, Vec3};
    use crate::mesh::Mesh;
    use crate::render::{Prepared, SurfaceSettings};
    use crate::scene::{Instance, Material, Scene};

    #[test]
    fn every_instance_is_a_surface_in_the_world() {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        let mut mirror = Mat4::translation(Vec3::new(5.0, 0.0, 0.0));
        mirror.columns[1][1] = -1.0;
        let mirrored = Instance { mesh: 0, material: 0, world_from_object: mirror };
        scene.edit(|data| data.instances.push(mirrored)).unwrap();
        let prepared = Prepared::new(scene, &SurfaceSettings::default()).unwrap();
        let surfaces = prepared.surfaces();
        assert_eq!(surfaces.iter().map(|s| s.mirrored).collect::<Vec<_>>(), [false, true]);
        for (i, p) in surfaces[0].positions.iter().enumerate() {
            let image = surfaces[1].positions[i];
            assert!((image - Vec3::new(p.x + 5.0, -p.y, p.z)).length() < 1e-6, "{p:?} {image:?}");
            let (n, turned) = (surfaces[0].normals[i], surfaces[1].normals[i]);
            assert!((turned - Vec3::new(n.x, -n.y, n.z)).length() < 1e-5, "{n:?} {turned:?}");
        }
    }
}
