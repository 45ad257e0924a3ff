//! temporary
use super::Material;
pub struct Preset {
    pub name: &'static str,
}
pub const PRESETS: &[Preset] = &[Preset { name: "bronze" }];
pub fn preset(n: &str) -> Option<Material> {
    (n == "bronze").then(|| Material {
        base_color: [0.7, 0.5, 0.3, 1.0],
        metallic: 1.0,
        roughness: 0.35,
        f0: Some([0.963, 0.713, 0.464]),
        ..Material::default()
    })
}
