//! A model's relief in the form that each method uses: heights, and normals in either space, converted from the other
//! if the file lacks them.

use super::options::Method;
use std::collections::HashMap;
use taotie_engine::bake::{TexelGrid, TexelSurface};
use taotie_engine::error::Result;
use taotie_engine::image::{Bitmap, Encoding, Image, Texels, Texture};
use taotie_engine::math::{Vec3, srgb};
use taotie_engine::mesh::Mesh;
use taotie_engine::normal_map::{
    Storage, decoded_normals, object_from_tangent, store_normals, tangent_from_object,
};
use taotie_engine::scene::{
    GreenChannel, HeightMap, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef,
};
use taotie_engine::surface::{SurfaceMethod, TangentMethod, with_frames};

/// Provides the scene's materials with what each method needs, deriving it from other forms in the file.
pub(super) struct Relief {
    /// As in the file and the options.
    materials: Vec<Material>,
    /// The texture with the greyscale version of each colour texture.
    greys: HashMap<usize, usize>,
    /// The texture with the normals of each material in the other space.
    converted: HashMap<usize, usize>,
    /// The method of making tangents, if not the renderer's choice.
    tangents: Option<TangentMethod>,
    /// Notes on derived maps, for the report.
    notes: Vec<String>,
}

impl Relief {
    /// Stores the scene's materials, one for each mesh that uses it: converted maps belong to one mesh.
    pub(super) fn new(scene: &mut Scene, tangents: Option<TangentMethod>) -> Result<Self> {
        scene.edit(part_materials)?;
        Ok(Self {
            materials: scene.materials().to_vec(),
            greys: HashMap::new(),
            converted: HashMap::new(),
            tangents,
            notes: Vec::new(),
        })
    }

    /// Returns notes on the maps derived so far.
    pub(super) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Sets up the scene's materials for `method`; returns the reason if none of them has the relief for it.
    ///
    /// # Errors
    /// Fails if a derived texture cannot be made.
    pub(super) fn apply(&mut self, scene: &mut Scene, method: Method) -> Result<Option<&'static str>> {
        scene.edit(|scene| scene.materials.clone_from(&self.materials))?;
        let mut any = false;
        for index in 0..self.materials.len() {
            any |= match method.surface {
                SurfaceMethod::Facet | SurfaceMethod::Smooth => true,
                SurfaceMethod::Bump | SurfaceMethod::BumpPrinted => self.give_height(scene, index, method)?,
                SurfaceMethod::ObjectNormal => self.give_normals(scene, index, NormalSpace::Object)?,
                SurfaceMethod::TangentNormal => self.give_normals(scene, index, NormalSpace::Tangent)?,
            };
        }
        Ok((!any).then(|| lacking(method)))
    }

    /// Gives a material its height map, with white `method.factor` texels above black if specified.
    fn give_height(&mut self, scene: &mut Scene, index: usize, method: Method) -> Result<bool> {
        let height = match self.materials[index].height {
            Some(height) => height,
            // The height of white in a colour texture is unknown.
            None if method == (Method { surface: SurfaceMethod::Bump, factor: None }) => return Ok(false),
            None => match self.grey_of_color(scene, index)? {
                Some(texture) => HeightMap { texture, scale: 1.0 },
                None => return Ok(false),
            },
        };
        let scale = match method.factor {
            Some(factor) => factor * texel_size(scene, index, &height.texture) as f32,
            None => height.scale,
        };
        scene.edit(|scene| scene.materials[index].height = Some(HeightMap { scale, ..height }))?;
        Ok(true)
    }

    /// Returns the base colour's grey as heights, as used by the paper's bump mapping.
    fn grey_of_color(&mut self, scene: &mut Scene, index: usize) -> Result<Option<TextureRef>> {
        let Some(color) = self.materials[index].base_color_texture else { return Ok(None) };
        let texture = match self.greys.get(&color.texture) {
            Some(texture) => *texture,
            None => {
                let grey = grey(&scene.textures()[color.texture])?;
                let texture = scene.add_texture(Texture::new(grey, Encoding::Linear));
                self.greys.insert(color.texture, texture);
                self.notes
                    .push("heights: used the grey of the base colour, as in the paper: no height map".into());
                texture
            }
        };
        Ok(Some(TextureRef { texture, ..color }))
    }

    /// Gives a material its normal map in `space`, converted if the file has the other.
    fn give_normals(&mut self, scene: &mut Scene, index: usize, space: NormalSpace) -> Result<bool> {
        let Some(map) = self.materials[index].normal else { return Ok(false) };
        if map.space != space {
            let Some(texture) = self.convert(scene, index, &map)? else { return Ok(false) };
            let texture = TextureRef { texture, ..map.texture };
            // The conversion has applied both.
            let (scale, green) = (1.0, GreenChannel::Up);
            let map = NormalMap { texture, scale, space, green };
            scene.edit(|scene| scene.materials[index].normal = Some(map))?;
        }
        Ok(true)
    }

    /// Returns the texture with a material's normals in the other space; `None` if no mesh with uvs uses the
    /// material.
    fn convert(&mut self, scene: &mut Scene, index: usize, map: &NormalMap) -> Result<Option<usize>> {
        if let Some(texture) = self.converted.get(&index) {
            return Ok(Some(*texture));
        }
        let user = scene.instances().iter().find(|instance| instance.material == index);
        let Some(mesh) = user.map(|user| &scene.meshes()[user.mesh]) else { return Ok(None) };
        if mesh.uvs().len() <= map.texture.uv_set {
            return Ok(None);
        }
        let source = scene.textures()[map.texture.texture].bitmap();
        let converted = other_space(mesh, source, map, self.tangents)?;
        if converted.shared > 0 {
            self.notes.push(format!(
                "normals: {} texels are covered by several triangles; the converted map has the normal of the first",
                converted.shared
            ));
        }
        self.notes.push(format!("normals: one map was converted to {} on its mesh", converted.space));
        let texture = scene.add_texture(Texture::new(converted.bitmap, Encoding::Normal));
        self.converted.insert(index, texture);
        Ok(Some(texture))
    }
}

/// Gives each mesh separate materials.
fn part_materials(scene: &mut SceneData) {
    let mut users: HashMap<usize, usize> = HashMap::new();
    let mut parted: HashMap<(usize, usize), usize> = HashMap::new();
    for instance in &mut scene.instances {
        let (material, mesh) = (instance.material, instance.mesh);
        if *users.entry(material).or_insert(mesh) == mesh {
            continue;
        }
        instance.material = *parted.entry((material, mesh)).or_insert_with(|| {
            scene.materials.push(scene.materials[material].clone());
            scene.materials.len() - 1
        });
    }
}

fn lacking(method: Method) -> &'static str {
    match (method.surface, method.factor) {
        (SurfaceMethod::Bump, None) => {
            "no material has a height map of known height; add one, or specify a factor: bump:5"
        }
        (SurfaceMethod::Bump | SurfaceMethod::BumpPrinted, _) => {
            "no material has a height map or a base colour texture; add a height map"
        }
        _ => "no material of a mesh with uvs has a normal map; add one",
    }
}

/// Returns the luma of encoded colour, the greyscale conversion of paint programs; 16 bits.
///
/// Source: ITU-R BT.601, the weights of Y'.
fn grey(color: &Texture) -> Result<Bitmap> {
    let encoded = |v: f32| srgb::srgb_from_linear(f64::from(v.clamp(0.0, 1.0)));
    let (width, height) = (color.width(), color.height());
    let rows = (0..height as usize).flat_map(|y| (0..width as usize).map(move |x| (x, y)));
    let texels = rows.map(|(x, y)| {
        let [r, g, b, _] = color.texel(0, x, y);
        let luma = 0.299 * encoded(r) + 0.587 * encoded(g) + 0.114 * encoded(b);
        let code = (luma * 65535.0 + 0.5) as u16;
        [code, code, code, u16::MAX]
    });
    Bitmap::new(width, height, 1, Texels::U16(texels.collect()))
}

/// Returns the side length of a texel on the surface, in model units: √(area / texels) over all triangles of the
/// material. Zero if they have no area in the texture.
fn texel_size(scene: &Scene, material: usize, texture: &TextureRef) -> f64 {
    let map = &scene.textures()[texture.texture];
    let texels = f64::from(map.width()) * f64::from(map.height());
    let (mut area, mut in_map) = (0.0, 0.0);
    for instance in scene.instances().iter().filter(|instance| instance.material == material) {
        let mesh = &scene.meshes()[instance.mesh];
        let Some(uvs) = mesh.uvs().get(texture.uv_set) else { continue };
        for triangle in mesh.triangles() {
            let corner =
                |i: u32| instance.world_from_object.transform_point(mesh.positions()[i as usize].to_f64());
            let uv = |i: u32| texture.transform.apply(uvs[i as usize]);
            let [a, b, c] = triangle.map(corner);
            area += (b - a).cross(c - a).length();
            let [a, b, c] = triangle.map(uv).map(|uv| Vec3::new(f64::from(uv.x), f64::from(uv.y), 0.0));
            in_map += (b - a).cross(c - a).length() * texels;
        }
    }
    if in_map > 0.0 { (area / in_map).sqrt() } else { 0.0 }
}

/// Texels around UV islands that are also filled, as a fraction of the map's side: enough for visible mip levels.
const PADDING: u32 = 128;

/// A converted map.
struct Converted {
    /// 16 bits, green up.
    bitmap: Bitmap,
    /// Its space, in words.
    space: &'static str,
    /// Texels covered by more than one triangle, which cannot be right for all of them in object space.
    shared: usize,
}

/// Returns `source`, a map used as in `map`, converted to the other space for `mesh`.
fn other_space(
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
