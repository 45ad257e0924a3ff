//! The demo object: a Shang bronze *jue* (爵), a tripod for warm wine, generated procedurally.

mod atlas;
mod bake;
mod builder;
mod displaced;
mod limbs;
mod mask;
mod patina;
mod patterns;
pub mod pour;
mod relief;
mod rounded;
mod vessel;

pub use relief::{DEPTH, height};

use bake::Bake;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texture, Wrap};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{
    GreenChannel, HeightMap, Instance, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef,
    UvTransform,
};

/// Returns the low-poly mesh: 251 vertices, metres, resting on y = 0, with its spout along +x and its handle at −z.
///
/// Every part is closed and faces outwards; the single uv set has no mirrored or overlapping UV islands. Tangents are
/// left to the renderer.
pub fn low_mesh() -> Mesh {
    let mut builder = builder::Builder::default();
    vessel::add(&mut builder);
    limbs::add(&mut builder);
    builder.finish()
}

/// Returns the relief as a linear 16-bit greyscale map of `size` × `size` texels (1 to [`Bitmap::MAX_SIDE`]), padded
/// around the UV islands by 1/128 of its side.
pub fn height_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).height_map()
}

/// Returns the relief as a linear 16-bit tangent-space normal map, green up, for [`low_mesh`] in MikkTSpace.
pub fn normal_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).normal_map()
}

/// Returns the relief as a linear 16-bit object-space normal map for [`low_mesh`].
pub fn object_normal_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).object_normal_map()
}

/// Returns bare bronze and its patina as an sRGB-encoded 8-bit colour map.
pub fn base_color_map(size: u32) -> Bitmap {
    let [color, _] = Bake::new(&low_mesh(), size).material_maps();
    color
}

/// Returns occlusion (red), roughness (green) and metallic (blue) as a linear 8-bit map.
pub fn orm_map(size: u32) -> Bitmap {
    let [_, orm] = Bake::new(&low_mesh(), size).material_maps();
    orm
}

/// Returns the vessel with its material: one instance, no light and no camera. Textures 0 to 3 are colour;
/// occlusion, roughness and metallic; normals; and heights, each of `size` × `size` texels.
pub fn scene(size: u32) -> Scene {
    let mesh = low_mesh();
    let bake = Bake::new(&mesh, size);
    let [color, orm] = bake.material_maps();
    let textures = vec![
        Texture::new(color, Encoding::Srgb),
        Texture::new(orm, Encoding::Linear),
        Texture::new(bake.normal_map(), Encoding::Normal),
        Texture::new(bake.height_map(), Encoding::Linear),
    ];
    let instances = vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }];
    let (meshes, materials) = (vec![mesh], vec![material()]);
    let data = SceneData { meshes, materials, textures, instances, ..SceneData::default() };
    Scene::new(data).expect("there are four textures")
}

/// Returns `scene`, made by [`scene`], with the relief as an object-space map of `size` × `size` texels.
pub fn with_object_map(scene: &Scene, size: u32) -> Scene {
    let mut scene = scene.clone();
    let index = scene.add_texture(Texture::new(object_normal_map(size), Encoding::Normal));
    let edited = scene.edit(|scene| {
        for map in scene.materials.iter_mut().filter_map(|material| material.normal.as_mut()) {
            map.texture.texture = index;
            map.space = NormalSpace::Object;
        }
    });
    edited.expect("the texture exists");
    scene
}

/// Returns `scene`, made by [`scene`], with `mesh`, which has its relief as geometry, instead of relief maps.
pub fn with_relief(scene: &Scene, mesh: Mesh) -> Scene {
    let mut scene = scene.clone();
    let edited = scene.edit(|scene| {
        scene.meshes = vec![mesh];
        for material in &mut scene.materials {
            (material.normal, material.height) = (None, None);
        }
    });
    edited.expect("one mesh replaces another");
    scene
}

/// The material, with all factors 1: everything is in the textures.
fn material() -> Material {
    let texture = |texture| TextureRef {
        texture,
        uv_set: 0,
        sampler: Sampler { wrap_u: Wrap::Clamp, wrap_v: Wrap::Clamp, ..Sampler::default() },
        transform: UvTransform::default(),
    };
    Material {
        name: "excavated bronze".into(),
        base_color: [1.0; 4],
        base_color_texture: Some(texture(0)),
        metallic: 1.0,
        roughness: 1.0,
        metallic_roughness_texture: Some(texture(1)),
        occlusion_texture: Some(texture(1)),
        // Fully occluded texels would turn black under the few lights of a demo.
        occlusion_strength: 0.7,
        normal: Some(NormalMap {
            texture: texture(2),
            scale: 1.0,
            space: NormalSpace::Tangent,
            green: GreenChannel::Up,
        }),
        height: Some(HeightMap { texture: texture(3), scale: DEPTH as f32 }),
        ..Material::default()
    }
}

/// The edge length at which a [`displaced_mesh`] resolves the finest lines, metres: more than a million triangles.
pub const FINEST: f64 = 0.0002;

/// Returns the vessel with its relief as geometry: each triangle of [`low_mesh`] is rounded by its normals, displaced
/// by [`height`], and split until its edges follow the relief or are at most `finest` metres long.
///
/// Its uvs are those of the low-poly mesh, so the two can be compared point by point; its normals are those of the
/// displaced surface.
pub fn displaced_mesh(finest: f64) -> Mesh {
    displaced::mesh(&low_mesh(), finest, height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;
    use taotie_engine::math::Vec3;

    /// Returns the index of the first vertex at the position of each vertex.
    fn welded(mesh: &Mesh) -> Vec<usize> {
        let key = |p: &Vec3| p.to_array().map(f32::to_bits);
        let mut first = HashMap::new();
        mesh.positions().iter().enumerate().map(|(i, p)| *first.entry(key(p)).or_insert(i)).collect()
    }

    #[test]
    fn has_exactly_251_vertices_and_all_are_used() {
        let mesh = low_mesh();
        assert_eq!(mesh.positions().len(), 251);
        let used: std::collections::BTreeSet<u32> = mesh.triangles().iter().flatten().copied().collect();
        assert_eq!(used.len(), 251);
        assert!(mesh.tangents().is_empty());
    }

    #[test]
    fn every_edge_is_shared_by_two_triangles_in_opposite_directions() {
        let mesh = low_mesh();
        let welded = welded(&mesh);
        let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
        for triangle in mesh.triangles() {
            let t = triangle.map(|i| welded[i as usize]);
            for k in 0..3 {
                *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
            }
        }
        for ((a, b), count) in &edges {
            let (p, q) = (mesh.positions()[*a], mesh.positions()[*b]);
            assert_eq!(*count, 1, "edge {p:?} {q:?} is used twice in the same direction");
            assert!(edges.contains_key(&(*b, *a)), "edge {p:?} {q:?} is open");
        }
    }

    /// Returns the component of each vertex: the smallest welded index to which triangles connect it.
    fn components(mesh: &Mesh) -> Vec<usize> {
        let welded = welded(mesh);
        let mut component = welded.clone();
        loop {
            let mut changed = false;
            for triangle in mesh.triangles() {
                let t = triangle.map(|i| welded[i as usize]);
                let least = t.iter().map(|i| component[*i]).min().unwrap();
                for i in t {
                    changed |= component[i] != least;
                    component[i] = least;
                }
            }
            if !changed {
                return welded.iter().map(|i| component[*i]).collect();
            }
        }
    }

    #[test]
    fn every_part_encloses_a_positive_volume() {
        let mesh = low_mesh();
        let components = components(&mesh);
        let mut volumes: HashMap<usize, f64> = HashMap::new();
        for (i, triangle) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = mesh.corners(i).map(Vec3::to_f64);
            *volumes.entry(components[triangle[0] as usize]).or_default() += a.dot(b.cross(c)) / 6.0;
        }
        assert_eq!(volumes.len(), 7, "vessel, three legs, two posts, handle");
        assert!(volumes.values().all(|v| *v > 1e-7), "{volumes:?}");
    }

    #[test]
    fn has_no_sliver_and_stands_on_the_ground() {
        let mesh = low_mesh();
        assert_eq!(mesh.degenerate_triangles(), 0);
        for i in 0..mesh.triangles().len() {
            let [a, b, c] = mesh.corners(i).map(Vec3::to_f64);
            assert!((b - a).cross(c - a).length() > 1e-6, "triangle {i} is a sliver: {a:?} {b:?} {c:?}");
        }
        let lowest = mesh.positions().iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        assert_eq!(lowest, 0.0);
    }

    #[test]
    fn normals_are_unit_and_on_the_side_of_their_faces() {
        let mesh = low_mesh();
        assert!(mesh.normals().iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
        let against = (0..mesh.triangles().len()).filter(|i| {
            let [a, b, c] = mesh.corners(*i);
            let face = (b - a).cross(c - a).normalize();
            mesh.triangles()[*i].iter().any(|k| mesh.normals()[*k as usize].dot(face) < -0.2)
        });
        // The lids of the limbs' hidden ends do not affect normals: one per leg, two per post, four on the handle.
        assert!(against.count() <= 11);
    }

    #[test]
    fn proportions_are_those_of_a_shang_jue() {
        let bounds = scene(16).bounds().unwrap();
        let size = bounds.max - bounds.min;
        assert!((0.195..0.215).contains(&size.y), "height {}", size.y);
        assert!((0.165..0.185).contains(&size.x), "length {}", size.x);
        assert!(bounds.max.x > -bounds.min.x, "the spout is longer than the tail");
    }

    /// Returns the indices of the triangles that cover the centre of each texel.
    fn coverage(mesh: &Mesh, size: usize) -> Vec<Vec<usize>> {
        let mut texels = vec![Vec::new(); size * size];
        for (i, triangle) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = triangle.map(|k| {
                let uv = mesh.uvs()[0][k as usize];
                [uv.x, uv.y].map(|c| f64::from(c) * size as f64)
            });
            let side = |p: [f64; 2], q: [f64; 2], x: f64, y: f64| {
                (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
            };
            for (k, texel) in texels.iter_mut().enumerate() {
                let (x, y) = ((k % size) as f64 + 0.5, (k / size) as f64 + 0.5);
                if side(a, b, x, y) < -1e-6 && side(b, c, x, y) < -1e-6 && side(c, a, x, y) < -1e-6 {
                    texel.push(i);
                }
            }
        }
        texels
    }

    /// Returns the UV island of each triangle: triangles connected by shared vertices, but not across uv seams.
    fn islands(mesh: &Mesh) -> Vec<u32> {
        let mut island: Vec<u32> = (0..mesh.positions().len() as u32).collect();
        for _ in 0..mesh.positions().len() {
            for triangle in mesh.triangles() {
                let least = triangle.iter().map(|i| island[*i as usize]).min().unwrap();
                triangle.iter().for_each(|i| island[*i as usize] = least);
            }
        }
        mesh.triangles().iter().map(|t| island[t[0] as usize]).collect()
    }

    #[test]
    fn islands_lie_apart_in_the_unit_square() {
        const SIZE: usize = 512;
        let mesh = low_mesh();
        assert_eq!(mesh.uvs().len(), 1);
        assert!(mesh.uvs()[0].iter().all(|uv| uv.x > 0.0 && uv.x < 1.0 && uv.y > 0.0 && uv.y < 1.0));
        let coverage = coverage(&mesh, SIZE);
        let double = coverage.iter().position(|texel| texel.len() > 1);
        assert!(double.is_none(), "triangles overlap in uv: {:?}", double.map(|i| (i % SIZE, i / SIZE)));
        let islands = islands(&mesh);
        let at = |x: usize, y: usize| coverage[y * SIZE + x].first().map(|t| islands[*t]);
        // 3 texels here are 12 at 2048.
        for y in 0..SIZE - 3 {
            for x in 3..SIZE - 3 {
                let Some(here) = at(x, y) else { continue };
                for (dx, dy) in [(3, 0), (0, 3), (3, 3), (2, 3), (3, 2)] {
                    assert!(
                        at(x + dx, y + dy).is_none_or(|there| there == here),
                        "UV islands touch at {x} {y}"
                    );
                    assert!(
                        at(x - dx, y + dy).is_none_or(|there| there == here),
                        "UV islands touch at {x} {y}"
                    );
                }
            }
        }
        let covered = coverage.iter().filter(|texel| !texel.is_empty()).count() as f64 / (SIZE * SIZE) as f64;
        assert!(covered > 0.5, "only {covered} of the atlas is used");
    }

    #[test]
    fn displaced_mesh_closes_without_cracks() {
        let mesh = displaced_mesh(0.001);
        assert!(mesh.triangles().len() > 256 * low_mesh().triangles().len());
        let key = |i: u32| mesh.positions()[i as usize].to_array().map(|c| (c + 0.0).to_bits());
        let mut edges = HashMap::new();
        for t in mesh.triangles() {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                *edges.entry((key(a), key(b))).or_insert(0) += 1;
            }
        }
        let open = edges.keys().filter(|(a, b)| !edges.contains_key(&(*b, *a))).count();
        assert_eq!(open, 0, "of {} edges", edges.len());
    }

    #[test]
    fn more_than_a_million_triangles_on_demand() {
        let mesh = displaced_mesh(FINEST);
        assert!(mesh.triangles().len() > 1_000_000);
        assert!(mesh.normals().iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    }
}
