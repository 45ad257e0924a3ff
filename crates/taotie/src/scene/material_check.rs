//! Checks that a material can be shaded: its textures exist, and its factors are in range.

use super::layers::{FactorValue, LAYERS};
use super::{AlphaMode, Light, Material, UvTransform};

/// A factor with its name.
type Factor = (&'static str, f32);

impl Material {
    /// Checks the material for a scene with this number of `textures`.
    ///
    /// # Errors
    /// The first texture that does not exist, or factor outside the range documented at [`Material`].
    pub(super) fn check(&self, textures: usize) -> Result<(), String> {
        if let Some(lost) = self.textures().into_iter().find(|used| used.texture >= textures) {
            return Err(format!("it refers to texture {}, but there are {textures}", lost.texture));
        }
        if self.textures().iter().any(|used| !used.transform.is_bounded()) {
            return Err(format!(
                "a texture transform has a number beyond the limit of ±{:e}",
                UvTransform::MOST
            ));
        }
        within(&self.fractions(), "between 0 and 1", |v| (0.0..=1.0).contains(&v))?;
        within(&self.amounts(), "between 0 and 1e12", |v| (0.0..=Light::MOST).contains(&v))?;
        within(&self.numbers(), "finite", f32::is_finite)?;
        within(&[("ior", self.ior)], "0, or at least 1", |v| v == 0.0 || (1.0..=f32::MAX).contains(&v))?;
        let slope = self.classic.slope.unwrap_or(1.0);
        within(&[("slope", slope)], "above 0", |v| v > 0.0 && v.is_finite())
    }

    fn fractions(&self) -> Vec<Factor> {
        let mut factors = vec![
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("occlusion strength", self.occlusion_strength),
        ];
        factors.extend(self.layer_factors().filter_map(|(name, value)| match value {
            FactorValue::Number(number) => Some((name, number)),
            _ => None,
        }));
        factors
    }

    /// Returns the factors of all layers of the material.
    fn layer_factors(&self) -> impl Iterator<Item = (&'static str, FactorValue)> {
        let factors = LAYERS.iter().flat_map(|layer| layer.factors);
        factors.filter_map(|factor| Some((factor.name, (factor.get)(self)?)))
    }

    fn amounts(&self) -> Vec<Factor> {
        let classic = &self.classic;
        let colors = [
            ("f0", self.f0),
            ("f82", self.f82),
            ("emissive", Some(self.emissive)),
            ("ambient", classic.ambient),
            ("diffuse", classic.diffuse),
            ("specular", classic.specular),
        ];
        let of_layers = self.layer_factors().filter_map(|(name, value)| match value {
            FactorValue::Color(color) => Some((name, Some(color))),
            _ => None,
        });
        let channels =
            |(name, color): (_, Option<[f32; 3]>)| color.into_iter().flatten().map(move |v| (name, v));
        let mut factors: Vec<Factor> = colors.into_iter().chain(of_layers).flat_map(channels).collect();
        factors.extend(self.base_color.map(|v| ("base colour", v)));
        factors.extend(classic.shininess.map(|v| ("shininess", v)));
        if let AlphaMode::Mask(cutoff) = self.alpha {
            factors.push(("alpha cutoff", cutoff));
        }
        factors
    }

    fn numbers(&self) -> Vec<Factor> {
        let coat = self.clearcoat.iter().filter_map(|coat| coat.normal.as_ref());
        let maps = self.normal.iter().chain(coat).map(|map| ("normal scale", map.scale));
        let heights = self.height.iter().map(|map| ("height scale", map.scale));
        maps.chain(heights).collect()
    }
}

fn within(factors: &[Factor], range: &str, holds: impl Fn(f32) -> bool) -> Result<(), String> {
    match factors.iter().find(|(_, value)| !holds(*value)) {
        None => Ok(()),
        Some((name, value)) => Err(format!("its {name} is {value}; it must be {range}")),
    }
}
