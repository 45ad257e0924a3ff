//! Texture lookups at a point of a surface, at the resolution of neighbouring samples, and the normal there, bent by
//! a normal or height map.

use crate::error::Result;
use crate::image::{Bitmap, Encoding, MipFilter, Sampler, TexelFilter, Texels, Texture};
use crate::math::{Mat4, Vec2, Vec3, poly};
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::scene::{NormalMap, TextureRef};
use crate::surface::{
    UvDerivatives, bump, decode_normal, decode_object_normal, object_normal, surface_gradient,
    tangent_normal, uv_derivatives,
};

/// A point at which a material is read, and its distance to the next such point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookupPoint {
    /// The point of the mesh.
    pub point: Point,
    /// The lookup width, in model units: finer detail is averaged. 0 reads the finest level of each texture.
    pub width: f32,
}

impl LookupPoint {
    /// Returns a point at which textures are read at their finest level.
    pub fn finest(point: Point) -> Self {
        Self { point, width: 0.0 }
    }
}

/// The minimum alpha by which a premultiplied colour is divided: 8 of its 65535 steps. Rounding is then less than a
/// tenth of a colour that hardly counts.
const LEAST_ALPHA: f32 = 8.0 / 65535.0;

/// Returns the texture with its colours multiplied by alpha, linear: its mip levels are means of visible colours.
pub(super) fn premultiplied(texture: &Texture) -> Result<Texture> {
    let (width, height) = (texture.width(), texture.height());
    let texel = |i: usize| {
        let [r, g, b, alpha] = texture.texel(0, i % width as usize, i / width as usize);
        [r * alpha, g * alpha, b * alpha, alpha]
    };
    let count = texture.bitmap().texels().len();
    let texels = match texture.bitmap().texels() {
        Texels::F32(_) => Texels::F32(parallel::collect(count, texel)),
        _ => Texels::U16(parallel::collect(count, |i| texel(i).map(|v| (v * 65535.0 + 0.5) as u16))),
    };
    Ok(Texture::new(Bitmap::new(width, height, 4, texels)?, Encoding::Linear))
}

/// Returns the width of a finest-level texel of a texture on a triangle, in model units; `None` if uvs span no area.
pub fn texel_width((mesh, triangle): (&Mesh, u32), textures: &[Texture], used: &TextureRef) -> Option<f32> {
    let middle = Point { triangle, weights: [1.0 / 3.0; 3] };
    TextureOnMesh { mesh, texture: &textures[used.texture], used }.texel_size(middle)
}

/// A texture as a material uses it on a mesh.
pub(super) struct TextureOnMesh<'a> {
    pub mesh: &'a Mesh,
    pub texture: &'a Texture,
    pub used: &'a TextureRef,
}

impl TextureOnMesh<'_> {
    /// Returns the linear RGBA value at a point. A mesh without the uv set uses the texel at the origin.
    pub fn read(&self, at: LookupPoint) -> [f32; 4] {
        self.value(self.uv(at.point), self.lod_at(at))
    }

    /// Like [`Self::read`], but beyond the finest level returns the mean visible colour from `premultiplied`: this
    /// texture with its colours multiplied by alpha.
    pub fn read_visible(&self, premultiplied: &Texture, at: LookupPoint) -> [f32; 4] {
        let (uv, lod) = (self.uv(at.point), self.lod_at(at));
        let straight = self.value(uv, lod);
        if lod <= 0.0 {
            return straight;
        }
        let visible = TextureOnMesh { mesh: self.mesh, texture: premultiplied, used: self.used };
        let [r, g, b, alpha] = visible.value(uv, lod);
        if alpha < LEAST_ALPHA { straight } else { [r / alpha, g / alpha, b / alpha, straight[3]] }
    }

    /// Returns the value at a texture position, filtered by the file's sampler up to the finest level, trilinear
    /// beyond.
    fn value(&self, uv: Vec2, lod: f32) -> [f32; 4] {
        let filtered = Sampler { minify: TexelFilter::Linear, mip: MipFilter::Linear, ..self.used.sampler };
        let sampler = if lod > 0.0 { filtered } else { self.used.sampler };
        sampler.sample(self.texture, uv, lod.max(0.0))
    }

    /// Returns the variance of normals stored in a value of this texture, [0, 1].
    fn variance(&self, [.., alpha]: [f32; 4], lod: f32) -> f32 {
        // There is none at the finest level, and only mip levels of normals keep it.
        if lod > 0.0 && self.texture.encoding() == Encoding::Normal { alpha.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Returns the texture position of a point.
    fn uv(&self, point: Point) -> Vec2 {
        let has_set = self.used.uv_set < self.mesh.uvs().len();
        let uv = if has_set { point.uv(self.mesh, self.used.uv_set) } else { Vec2::default() };
        self.used.transform.apply(uv)
    }

    /// Returns the derivatives of position by texture position; `None` if uvs span no area.
    fn derivatives(&self, point: Point) -> Option<UvDerivatives> {
        let uvs = self.mesh.uvs().get(self.used.uv_set)?;
        let places = point.vertices(self.mesh).map(|v| self.used.transform.apply(uvs[v]));
        uv_derivatives(self.mesh.corners(point.triangle as usize), places)
    }

    /// Returns the width of a finest-level texel at a point, in model units; `None` if uvs span no area.
    pub fn texel_size(&self, point: Point) -> Option<f32> {
        let derivatives = self.derivatives(point)?;
        Some(poly::exp2(-self.lod(&derivatives, 1.0)))
    }

    fn lod_at(&self, at: LookupPoint) -> f32 {
        // Checked first, since most lookups of the finest level need no derivatives.
        if at.width > 0.0 { self.derivatives(at.point).map_or(0.0, |d| self.lod(&d, at.width)) } else { 0.0 }
    }

    /// Returns log2 of the number of finest-level texels per `width`, in the direction in which they are densest; for
    /// needle shapes at most 16 times as dense as on average.
    ///
    /// A texel is the parallelogram of a = ∂p/∂u / columns and b = ∂p/∂v / rows; the smallest eigenvalue of their
    /// Gram matrix is its squared minimum width.
    fn lod(&self, derivatives: &UvDerivatives, width: f32) -> f32 {
        const MOST: f64 = 16.0;
        let a = derivatives.dp_du.to_f64() / f64::from(self.texture.width());
        let b = derivatives.dp_dv.to_f64() / f64::from(self.texture.height());
        let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
        let (mean, half) = ((aa + bb) * 0.5, (aa - bb) * 0.5);
        let area = a.cross(b).length();
        let most = mean + (half * half + ab * ab).sqrt();
        let least = (area * area / most).max(area / (MOST * MOST));
        let squared = f64::from(width) * f64::from(width) / least;
        // If the lookup width or the triangle's is 0, there is nothing to average.
        if squared > 0.0 { 0.5 * poly::log2(squared.clamp(1e-30, 1e30) as f32) } else { 0.0 }
    }
}

/// A normal including the relief of its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MappedNormal {
    /// Unit, world space.
    pub normal: Vec3,
    /// The variance of the map's normals within the lookup width, [0, 1].
    pub variance: f32,
}

/// Returns the normal from an object-space map.
pub(super) fn of_object_map(
    on: &TextureOnMesh<'_>,
    at: LookupPoint,
    world_from_object: &Mat4,
) -> MappedNormal {
    let lod = on.derivatives(at.point).map_or(0.0, |d| on.lod(&d, at.width));
    let value @ [r, g, b, _] = on.value(on.uv(at.point), lod);
    let matrix = world_from_object.normal_matrix();
    let stored = decode_object_normal(Vec3::new(r, g, b)).to_f64();
    let normal = object_normal(stored, [0, 1, 2].map(|j| matrix.axis(j))).to_f32();
    MappedNormal { normal, variance: on.variance(value, lod) }
}

/// Returns the normal from a tangent-space map; `None` if uvs span no area, so that tangents are undefined.
pub(super) fn of_tangent_map(
    on: &TextureOnMesh<'_>,
    at: LookupPoint,
    map: &NormalMap,
) -> Option<MappedNormal> {
    let lod = on.lod(&on.derivatives(at.point)?, at.width);
    let value @ [r, g, b, _] = on.value(on.uv(at.point), lod);
    let stored = decode_normal(Vec3::new(r, g, b), map.scale, map.green.sign());
    let frame = at.point.frame(on.mesh);
    let variance = (on.variance(value, lod) * map.scale * map.scale).min(1.0);
    Some(MappedNormal {
        normal: tangent_normal(frame.normal, frame.tangent, frame.handedness, stored),
        variance,
    })
}

/// Returns the smooth normal bent by heights in model units; `None` if uvs span no area.
pub(super) fn of_heights(
    on: &TextureOnMesh<'_>,
    at: LookupPoint,
    scale: f32,
    smooth: Vec3,
) -> Option<MappedNormal> {
    let derivatives = on.derivatives(at.point)?;
    let slopes = height_slopes(on, at.point, on.lod(&derivatives, at.width)).map(|slope| slope * scale);
    let UvDerivatives { dp_du, dp_dv, .. } = derivatives;
    let normal = bump(smooth, surface_gradient(smooth, [dp_du, dp_dv], slopes));
    Some(MappedNormal { normal, variance: 0.0 })
}

/// Returns the derivatives of the first channel by u and v: central differences of one texel of the level to each
/// side.
fn height_slopes(on: &TextureOnMesh<'_>, point: Point, lod: f32) -> [f32; 2] {
    let last = (on.texture.levels() - 1) as f32;
    let texels = poly::exp2(lod.clamp(0.0, last));
    let uv = on.uv(point);
    let slope = |size: u32, along: Vec2| {
        let step = texels / size as f32;
        let height = |side: f32| on.value(uv + along * (side * step), lod)[0];
        (height(1.0) - height(-1.0)) / (2.0 * step)
    };
    [slope(on.texture.width(), Vec2::new(1.0, 0.0)), slope(on.texture.height(), Vec2::new(0.0, 1.0))]
}
