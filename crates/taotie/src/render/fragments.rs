//! From hits to fragments: interpolation of vertices and lookup of textures.

use super::batch::{BATCH, Batch, set3};
use super::pass::Pass;
use super::prepare::{Draw, NormalSource};
use super::shadows::shadow_origin;
use super::view::Eye;
use crate::math::{Vec2, Vec3, poly, scalar};
use crate::mesh::Mesh;
use crate::raster::{Barycentric, PerspectiveTriangle};
use crate::scene::{HeightMap, Scene, TextureRef};
use crate::shade::{Hidden, bend};
use crate::surface;

/// A triangle seen at a sample of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// `y · TILE_SIZE + x` in the tile.
    pub pixel: u32,
    /// The triangle's number over all draws.
    pub triangle: u32,
    /// Reversed depth.
    pub depth: f32,
}

/// A point of a triangle with the size of a pixel around it.
pub(super) struct Footprint {
    pub vertices: [u32; 3],
    pub bary: Barycentric,
}

impl Footprint {
    /// A point without extent.
    pub(super) fn point(vertices: [u32; 3], weights: [f32; 3]) -> Self {
        Self { vertices, bary: Barycentric { weights, d_x: [0.0; 3], d_y: [0.0; 3] } }
    }

    fn vec3(&self, values: &[Vec3]) -> Vec3 {
        let [a, b, c] = self.vertices.map(|v| values[v as usize]);
        let [wa, wb, wc] = self.bary.weights;
        a * wa + b * wb + c * wc
    }

    fn array4(&self, values: &[[f32; 4]]) -> [f32; 4] {
        let [a, b, c] = self.vertices.map(|v| values[v as usize]);
        let [wa, wb, wc] = self.bary.weights;
        std::array::from_fn(|i| a[i] * wa + b[i] * wb + c[i] * wc)
    }

    fn uv(&self, mesh: &Mesh, set: usize, weights: [f32; 3]) -> Vec2 {
        let Some(uvs) = mesh.uvs().get(set) else { return Vec2::default() };
        let [a, b, c] = self.vertices.map(|v| uvs[v as usize]);
        a * weights[0] + b * weights[1] + c * weights[2]
    }

    /// Where a texture is read, and log2 of the texels that a pixel covers.
    fn lookup(&self, scene: &Scene, mesh: &Mesh, texture: &TextureRef) -> (Vec2, f32) {
        let uv = texture.transform.apply(self.uv(mesh, texture.uv_set, self.bary.weights));
        let image = &scene.textures[texture.texture];
        let squared = |weights| {
            let d = texture.transform.apply_linear(self.uv(mesh, texture.uv_set, weights));
            let (x, y) = (d.x * image.width() as f32, d.y * image.height() as f32);
            x * x + y * y
        };
        let texels = squared(self.bary.d_x).max(squared(self.bary.d_y));
        (uv, 0.5 * poly::log2(texels.clamp(1e-30, 1e30)))
    }

    fn sample(&self, scene: &Scene, mesh: &Mesh, texture: &TextureRef) -> [f32; 4] {
        let (uv, lod) = self.lookup(scene, mesh, texture);
        texture.sampler.sample(&scene.textures[texture.texture], uv, lod)
    }

    /// Opacity: factor, texture and vertex colour.
    pub(super) fn alpha(&self, scene: &Scene, draw: &Draw<'_>) -> f32 {
        draw.material.base_color[3] * self.tint(scene, draw)[3]
    }

    /// Base colour texture times vertex colour.
    fn tint(&self, scene: &Scene, draw: &Draw<'_>) -> [f32; 4] {
        let texture = draw.material.base_color_texture.as_ref();
        let mut tint = texture.map_or([1.0; 4], |texture| self.sample(scene, &draw.mesh, texture));
        if !draw.mesh.colors().is_empty() {
            let color = self.array4(draw.mesh.colors());
            tint = std::array::from_fn(|c| tint[c] * color[c]);
        }
        tint
    }
}

/// Fills a batch from hits of one draw.
pub(super) struct Gather<'p, 'a> {
    pass: &'p Pass<'p, 'a>,
    draw_index: usize,
    interpolation: Interpolation<'p, 'a>,
    /// The triangle last set up, and its number.
    current: Option<(u32, TriangleSetup, PerspectiveTriangle)>,
}

/// Makes fragments of points on one draw's triangles.
pub(super) struct Interpolation<'p, 'a> {
    pub scene: &'p Scene,
    pub draw: &'p Draw<'a>,
    /// How far above the surface rays leave, model units; `None` where none do.
    pub lift: Option<f32>,
    /// Whether what is too fine for the pixel widens highlights.
    pub specular_aa: bool,
}

/// What fragments of the same triangle share.
#[derive(Clone, Copy)]
pub(super) struct TriangleSetup {
    pub vertices: [u32; 3],
    /// Unit, world space, of the front.
    n_front: Vec3,
    /// Change of position a unit of u and v of the normal or height map.
    dp_du: Vec3,
    dp_dv: Vec3,
}

impl<'p, 'a> Gather<'p, 'a> {
    pub(super) fn new(pass: &'p Pass<'p, 'a>, draw_index: usize) -> Self {
        let interpolation = Interpolation {
            scene: pass.prepared.scene,
            draw: &pass.prepared.draws[draw_index],
            lift: pass.settings.shadows.then_some(pass.shadow_lift),
            specular_aa: pass.settings.specular_aa && !pass.settings.shading.is_printed(),
        };
        Self { pass, draw_index, interpolation, current: None }
    }

    /// Puts `keys` into `batch`; `at` gives each key's position on the screen in pixels. Returns where shadow rays
    /// leave from.
    pub(super) fn fill(
        &mut self,
        keys: &[Key],
        at: impl Fn(&Key) -> [f64; 2],
        batch: &mut Batch,
    ) -> [Vec3; BATCH] {
        let mut origins = [Vec3::default(); BATCH];
        batch.len = keys.len();
        for (i, key) in keys.iter().enumerate() {
            origins[i] = self.fragment(i, key, at(key), batch);
        }
        // Packs read up to the next multiple of eight.
        if let Some(last) = keys.last() {
            for i in keys.len()..keys.len().next_multiple_of(8) {
                self.fragment(i, last, at(last), batch);
            }
        }
        origins
    }

    fn fragment(&mut self, i: usize, key: &Key, [x, y]: [f64; 2], batch: &mut Batch) -> Vec3 {
        let (setup, perspective) = self.setup(key.triangle);
        let mut bary = perspective.at(x, y);
        let spacing = self.pass.viewport.pattern.spacing();
        bary.d_x = bary.d_x.map(|d| d * spacing);
        bary.d_y = bary.d_y.map(|d| d * spacing);
        let footprint = Footprint { vertices: setup.vertices, bary };
        self.interpolation.fragment(i, &setup, &footprint, self.pass.view.eye, batch)
    }

    fn setup(&mut self, triangle: u32) -> (TriangleSetup, PerspectiveTriangle) {
        match self.current {
            Some((id, setup, perspective)) if id == triangle => (setup, perspective),
            _ => {
                let setup = self.interpolation.setup(triangle);
                let clip = &self.pass.clip[self.draw_index];
                let corners = setup.vertices.map(|v| clip[v as usize]);
                let perspective = PerspectiveTriangle::new(corners, &self.pass.viewport);
                self.current = Some((triangle, setup, perspective));
                (setup, perspective)
            }
        }
    }
}

impl Interpolation<'_, '_> {
    /// What fragments of a triangle share; its number counts over all draws.
    pub(super) fn setup(&self, triangle: u32) -> TriangleSetup {
        let draw = self.draw;
        let vertices = draw.mesh.triangles()[(triangle - draw.first_triangle) as usize];
        let [a, b, c] = vertices.map(|v| draw.positions[v as usize]);
        let sign = if draw.mirrored { -1.0 } else { 1.0 };
        let n_front = (b - a).cross(c - a).normalize_or(Vec3::new(0.0, 0.0, 1.0)) * sign;
        let (dp_du, dp_dv) = self.position_derivatives(vertices);
        TriangleSetup { vertices, n_front, dp_du, dp_dv }
    }

    /// Writes entry `i` of a batch. Returns where rays leave from.
    pub(super) fn fragment(
        &self,
        i: usize,
        setup: &TriangleSetup,
        footprint: &Footprint,
        eye: Eye,
        batch: &mut Batch,
    ) -> Vec3 {
        let origin = self.geometry(i, setup, footprint, eye, batch);
        let hidden = self.normal_inputs(i, setup, footprint, batch);
        batch.variance[i] = hidden.variance();
        self.material(i, footprint, hidden, batch);
        origin
    }

    /// ∂P/∂u and ∂P/∂v of the height map's uv; zero where no height map is read or uvs span no area.
    fn position_derivatives(&self, vertices: [u32; 3]) -> (Vec3, Vec3) {
        let zero = (Vec3::default(), Vec3::default());
        let (NormalSource::Bump(map, _) | NormalSource::BumpPrinted(map, _)) = self.draw.normal_source else {
            return zero;
        };
        let uvs = &self.draw.mesh.uvs()[map.texture.uv_set];
        let corners = vertices.map(|v| self.draw.positions[v as usize]);
        let uvs = vertices.map(|v| map.texture.transform.apply(uvs[v as usize]));
        surface::uv_derivatives(corners, uvs).map_or(zero, |d| (d.dp_du, d.dp_dv))
    }

    /// Position, sight, side, normal and tangent. Returns where rays leave from.
    fn geometry(
        &self,
        i: usize,
        setup: &TriangleSetup,
        footprint: &Footprint,
        eye: Eye,
        batch: &mut Batch,
    ) -> Vec3 {
        let draw = self.draw;
        let position = footprint.vec3(&draw.positions);
        let v = match eye {
            Eye::Point(eye) => (eye - position).normalize_or(setup.n_front),
            Eye::Direction(direction) => direction,
        };
        let facing = if setup.n_front.dot(v) < 0.0 { -1.0 } else { 1.0 };
        let n_geom = setup.n_front * facing;
        set3(&mut batch.position, i, position);
        set3(&mut batch.v, i, v);
        set3(&mut batch.n_geom, i, n_geom);
        batch.facing[i] = facing;
        let normals = if matches!(draw.normal_source, NormalSource::BumpPrinted(..)) {
            draw.mesh.normals()
        } else {
            &draw.normals
        };
        set3(&mut batch.normal, i, footprint.vec3(normals));
        if !draw.tangents.is_empty() {
            let [x, y, z, _] = footprint.array4(&draw.tangents);
            set3(&mut batch.tangent, i, Vec3::new(x, y, z));
            batch.handedness[i] = draw.tangents[footprint.vertices[0] as usize][3];
        }
        let Some(lift) = self.lift else { return position };
        let corners = footprint.vertices.map(|v| draw.positions[v as usize]);
        let corner_normals = footprint.vertices.map(|v| draw.normals[v as usize] * facing);
        shadow_origin(position, corners, corner_normals, footprint.bary.weights, n_geom * lift)
    }

    /// What the method of the shading normal needs from textures. Returns what of it is too fine for the pixel.
    fn normal_inputs(
        &self,
        i: usize,
        setup: &TriangleSetup,
        footprint: &Footprint,
        batch: &mut Batch,
    ) -> Hidden {
        let scene = self.scene;
        let mut hidden = Hidden::default();
        if self.specular_aa && !matches!(self.draw.normal_source, NormalSource::Facet) {
            hidden.bend = self.bend(footprint);
        }
        match self.draw.normal_source {
            NormalSource::Facet | NormalSource::Smooth => {}
            NormalSource::ObjectMap(map) | NormalSource::TangentMap(map) => {
                let [r, g, b, variance] = footprint.sample(scene, &self.draw.mesh, &map.texture);
                set3(&mut batch.map, i, Vec3::new(r, g, b));
                if self.specular_aa {
                    hidden.relief = variance * map.scale * map.scale;
                }
            }
            NormalSource::Bump(map, scale) => {
                let [du, dv] = self.height_derivatives(map, footprint);
                batch.dh_du[i] = du * scale;
                batch.dh_dv[i] = dv * scale;
                set3(&mut batch.dp_du, i, setup.dp_du);
                set3(&mut batch.dp_dv, i, setup.dp_dv);
            }
            NormalSource::BumpPrinted(map, _) => {
                // The paper's g: half the difference of the grey levels (0 to 255) of the two neighbours along u.
                let width = scene.textures[map.texture.texture].width() as f32;
                let [du, _] = self.height_derivatives(map, footprint);
                batch.dh_du[i] = du * 255.0 / width;
            }
        }
        hidden
    }

    /// ∂h/∂u and ∂h/∂v by central differences one texel of the level in use to each side.
    fn height_derivatives(&self, map: &HeightMap, footprint: &Footprint) -> [f32; 2] {
        let scene = self.scene;
        let texture = &scene.textures[map.texture.texture];
        let (uv, lod) = footprint.lookup(scene, &self.draw.mesh, &map.texture);
        let texel = poly::exp2(lod.clamp(0.0, (texture.levels() - 1) as f32));
        let step = [texel / texture.width() as f32, texel / texture.height() as f32];
        let height =
            |du: f32, dv: f32| map.texture.sampler.sample(texture, Vec2::new(uv.x + du, uv.y + dv), lod)[0];
        [
            (height(step[0], 0.0) - height(-step[0], 0.0)) / (2.0 * step[0]),
            (height(0.0, step[1]) - height(0.0, -step[1])) / (2.0 * step[1]),
        ]
    }

    fn material(&self, i: usize, footprint: &Footprint, hidden: Hidden, batch: &mut Batch) {
        let (draw, material) = (self.draw, self.draw.material);
        let sample = |texture: &Option<TextureRef>| self.sample(footprint, texture);
        let [r, g, b, a] = footprint.tint(self.scene, draw);
        set3(&mut batch.tint, i, Vec3::new(r, g, b));
        batch.alpha[i] = material.base_color[3] * a;
        let packed = sample(&material.metallic_roughness_texture);
        batch.roughness[i] = hidden.widened(material.roughness * packed[1]);
        batch.metallic[i] = material.metallic * packed[2];
        // Files often pack occlusion into the red channel of the same texture.
        let [occlusion, ..] = match material.occlusion_texture == material.metallic_roughness_texture {
            true => packed,
            false => sample(&material.occlusion_texture),
        };
        batch.occlusion[i] = 1.0 + material.occlusion_strength * (occlusion - 1.0);
        set3(&mut batch.emissive, i, tinted(material.emissive, sample(&material.emissive_texture)));
        let specular = &material.specular;
        batch.specular[i] = specular.factor * sample(&specular.factor_texture)[3];
        set3(&mut batch.specular_color, i, tinted(specular.color, sample(&specular.color_texture)));
        self.layers(i, footprint, batch);
        let uv = footprint.uv(&draw.mesh, 0, footprint.bary.weights);
        batch.uv[0][i] = uv.x;
        batch.uv[1][i] = uv.y;
    }

    fn layers(&self, i: usize, footprint: &Footprint, batch: &mut Batch) {
        let material = self.draw.material;
        let sample = |texture: &Option<TextureRef>| self.sample(footprint, texture);
        let layers = &mut batch.layers;
        if let Some(coat) = &material.clearcoat {
            layers.coat[i] = coat.factor * sample(&coat.factor_texture)[0];
            let mut hidden = Hidden::default();
            if self.specular_aa {
                hidden.bend = self.bend(footprint);
            }
            if let Some(map) = &coat.normal {
                let [r, g, b, variance] = footprint.sample(self.scene, &self.draw.mesh, &map.texture);
                set3(&mut layers.coat_map, i, Vec3::new(r, g, b));
                if self.specular_aa {
                    hidden.relief = variance * map.scale * map.scale;
                }
            }
            layers.coat_roughness[i] = hidden.widened(coat.roughness * sample(&coat.roughness_texture)[1]);
        }
        if let Some(sheen) = &material.sheen {
            set3(&mut layers.sheen_color, i, tinted(sheen.color, sample(&sheen.color_texture)));
            layers.sheen_roughness[i] = sheen.roughness * sample(&sheen.roughness_texture)[3];
        }
        if let Some(anisotropy) = &material.anisotropy {
            let texel = anisotropy.texture.as_ref().map(|t| footprint.sample(self.scene, &self.draw.mesh, t));
            let [x, y, strength] =
                texel.map_or([1.0, 0.0, 1.0], |[r, g, b, _]| [2.0 * r - 1.0, 2.0 * g - 1.0, b]);
            let angle = f64::from(anisotropy.rotation);
            let (sin, cos) = (scalar::sin(angle) as f32, scalar::cos(angle) as f32);
            layers.stretch[i] = anisotropy.strength * strength;
            layers.stretch_turn[0][i] = cos * x - sin * y;
            layers.stretch_turn[1][i] = sin * x + cos * y;
        }
    }

    /// A texture's linear value; white where there is none.
    fn sample(&self, footprint: &Footprint, texture: &Option<TextureRef>) -> [f32; 4] {
        texture.as_ref().map_or([1.0; 4], |texture| footprint.sample(self.scene, &self.draw.mesh, texture))
    }

    /// What the bend of the smooth surface adds to α².
    fn bend(&self, footprint: &Footprint) -> f32 {
        let normals = footprint.vertices.map(|v| self.draw.normals[v as usize]);
        let [dx, dy] = [footprint.bary.d_x, footprint.bary.d_y]
            .map(|[a, b, c]| normals[0] * a + normals[1] * b + normals[2] * c);
        bend(dx, dy)
    }
}

fn tinted([r, g, b]: [f32; 3], [tr, tg, tb, _]: [f32; 4]) -> Vec3 {
    Vec3::new(r * tr, g * tg, b * tb)
}
