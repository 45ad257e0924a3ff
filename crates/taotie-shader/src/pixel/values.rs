//! The values of a material at a point: textures times factors, widened by subpixel detail.

use super::inputs::Inputs;
use crate::recorder::Recorded;
use taotie_engine::math::Vec3;
use taotie_engine::pixel::occluded;
use taotie_engine::scene::TextureRole;
use taotie_engine::shade::{SubPixelVariance, curvature_variance};

type Number<'g> = Recorded<'g>;
type Vector<'g> = Vec3<Recorded<'g>>;

impl<'g> Inputs<'g, '_> {
    fn has(self, role: TextureRole) -> bool {
        self.variant.textures.contains_key(&role)
    }

    /// A texel times its factor; only the factor if there is no texture.
    fn scaled(self, role: TextureRole, texel: &'static str, factor: &'static str) -> Number<'g> {
        match self.has(role) {
            true => self.number(texel) * self.number(factor),
            false => self.number(factor),
        }
    }

    /// A colour's texel times its factor; only the factor if there is no texture.
    fn colored(self, role: TextureRole, texel: &'static str, factor: &'static str) -> Vector<'g> {
        match self.has(role) {
            true => self.vector(texel).mul_elements(self.vector(factor)),
            false => self.vector(factor),
        }
    }

    /// Base colour texture times vertex colour.
    pub(super) fn tint(self) -> Vector<'g> {
        let texel = self.vector_or(self.has(TextureRole::BaseColor), "t.base_color", 1.0);
        texel.mul_elements(self.vector_or(self.variant.vertex_color, "t.color", 1.0))
    }

    /// Opacity.
    pub(super) fn alpha(self) -> Number<'g> {
        let alpha = self.scaled(TextureRole::BaseColor, "t.alpha", "u.alpha");
        if self.variant.vertex_color { alpha * self.number("t.color_alpha") } else { alpha }
    }

    fn occlusion(self) -> Number<'g> {
        match self.variant.is_occluded() {
            true => occluded(self.number("t.occlusion"), self.number("u.occlusion_strength")),
            false => self.constant(1.0),
        }
    }

    fn curvature(self) -> Number<'g> {
        match self.variant.has_curvature() {
            true => curvature_variance(self.vector("g.normal_dx"), self.vector("g.normal_dy")),
            false => self.constant(0.0),
        }
    }

    /// The variance of a map's normals within the pixel.
    fn mapped_variance(self, counts: bool, texel: &'static str, scale: &'static str) -> Number<'g> {
        match counts {
            true => self.number(texel) * (self.number(scale) * self.number(scale)),
            false => self.constant(0.0),
        }
    }

    fn hidden(self) -> SubPixelVariance<Number<'g>> {
        let counts = self.variant.has_normal_variance();
        let normal_variance = self.mapped_variance(counts, "t.normal_variance", "u.normal_scale");
        SubPixelVariance { curvature: self.curvature(), normal_variance }
    }

    fn hidden_in_coat(self) -> SubPixelVariance<Number<'g>> {
        let counts = self.variant.specular_aa && self.has(TextureRole::ClearcoatNormal);
        let normal_variance =
            self.mapped_variance(counts, "t.clearcoat_variance", "u.clearcoat_normal_scale");
        SubPixelVariance { curvature: self.curvature(), normal_variance }
    }

    fn roughness(self) -> Number<'g> {
        let roughness = self.scaled(TextureRole::MetallicRoughness, "t.roughness", "u.roughness");
        if self.variant.widens { self.hidden().widened(roughness) } else { roughness }
    }

    fn coat_roughness(self) -> Number<'g> {
        let role = TextureRole::ClearcoatRoughness;
        let roughness = self.scaled(role, "t.clearcoat_roughness", "u.clearcoat_roughness");
        self.hidden_in_coat().widened(roughness)
    }

    /// All values, in the order of the structure's fields.
    pub(super) fn material_values(self) -> Vec<Number<'g>> {
        let metallic = self.scaled(TextureRole::MetallicRoughness, "t.metallic", "u.metallic");
        let specular = self.scaled(TextureRole::Specular, "t.specular", "u.specular");
        let specular_color = self.colored(TextureRole::SpecularColor, "t.specular_color", "u.specular_color");
        let emissive = self.colored(TextureRole::Emissive, "t.emissive", "u.emissive");
        let sheen_color = self.colored(TextureRole::SheenColor, "t.sheen_color", "u.sheen_color");
        let sheen = self.scaled(TextureRole::SheenRoughness, "t.sheen_roughness", "u.sheen_roughness");
        let mut values = self.tint().to_array().to_vec();
        values.extend([metallic, self.roughness(), specular]);
        values.extend(specular_color.to_array());
        values.push(self.occlusion());
        values.extend(emissive.to_array());
        values.push(self.hidden().variance());
        values.push(self.scaled(TextureRole::Clearcoat, "t.clearcoat", "u.clearcoat"));
        values.push(self.coat_roughness());
        values.extend(sheen_color.to_array());
        values.push(sheen);
        values.push(self.scaled(TextureRole::Anisotropy, "t.anisotropy", "u.anisotropy"));
        values
    }
}
