//! The properties of materials as glTF has them, read from a scene without any of the library's own baking rules.

use taotie_engine::scene::{AlphaMode, Instance, Material, Scene, Specular};

/// A property over a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Look {
    /// That of a material that does not specify it.
    Unsaid,
    /// One value.
    Value(Vec<f32>),
    /// A texture, vertex colours, or parts that differ.
    Varies,
}

/// Reads a property of a part.
pub type Reader = fn(&Part) -> Look;

/// The properties by their names in reports.
pub const PROPERTIES: [(&str, Reader); 12] = [
    ("base colour", base_color),
    ("alpha", alpha),
    ("normal map", |part| varies(part.material.normal.is_some())),
    ("metallic-roughness", metallic_roughness),
    ("occlusion texture", occlusion),
    ("emission", emission),
    ("index of refraction", |part| value(part.material.ior != 1.5, vec![part.material.ior])),
    ("specular strength", specular),
    ("clearcoat", clearcoat),
    ("sheen", sheen),
    ("anisotropy", anisotropy),
    ("unlit look", |part| value(part.material.unlit, vec![1.0])),
];

/// A part of a scene.
pub struct Part<'a> {
    material: &'a Material,
    has_colors: bool,
}

impl<'a> Part<'a> {
    fn of(scene: &'a Scene, instance: &Instance) -> Self {
        let has_colors = !scene.meshes()[instance.mesh].colors().is_empty();
        Self { material: &scene.materials()[instance.material], has_colors }
    }
}

impl Look {
    /// Reads a property over all parts of a scene.
    pub fn over(scene: &Scene, look: Reader) -> Self {
        let mut looks = scene.instances().iter().map(|instance| look(&Part::of(scene, instance)));
        let first = looks.next().unwrap_or(Self::Unsaid);
        if looks.all(|look| look == first) { first } else { Self::Varies }
    }

    /// Returns true if an asset with this look can show what its scan shows. A texture may hold any value.
    pub fn keeps(&self, scan: &Self) -> bool {
        match (scan, self) {
            (Self::Unsaid, _) | (_, Self::Varies) => true,
            (Self::Value(scan), Self::Value(asset)) => are_near(scan, asset),
            _ => false,
        }
    }
}

/// Returns true if any part is double-sided.
pub fn is_double_sided(scene: &Scene) -> bool {
    scene.instances().iter().any(|instance| Part::of(scene, instance).material.double_sided)
}

fn are_near(a: &[f32], b: &[f32]) -> bool {
    let is_near = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-4 * a.abs().max(1.0);
    a.len() == b.len() && a.iter().zip(b).all(is_near)
}

fn varies(is: bool) -> Look {
    if is { Look::Varies } else { Look::Unsaid }
}

fn value(is: bool, value: Vec<f32>) -> Look {
    if is { Look::Value(value) } else { Look::Unsaid }
}

fn base_color(part: &Part) -> Look {
    let (material, plain) = (part.material, Material::default());
    let [color, unsaid] = [material, &plain].map(|material| material.base_color[..3].to_vec());
    match part.has_colors || material.base_color_texture.is_some() {
        true => Look::Varies,
        false => value(color != unsaid, color),
    }
}

fn alpha(part: &Part) -> Look {
    let material = part.material;
    let mode = match material.alpha {
        AlphaMode::Opaque => return Look::Unsaid,
        AlphaMode::Mask(cutoff) => cutoff,
        AlphaMode::Blend => -1.0,
    };
    match part.has_colors || material.base_color_texture.is_some() {
        true => Look::Varies,
        false => Look::Value(vec![mode, material.base_color[3]]),
    }
}

fn metallic_roughness(part: &Part) -> Look {
    let (material, plain) = (part.material, Material::default());
    let [own, unsaid] = [material, &plain].map(|material| vec![material.metallic, material.roughness]);
    match material.metallic_roughness_texture {
        Some(_) => Look::Varies,
        None => value(own != unsaid, own),
    }
}

fn occlusion(part: &Part) -> Look {
    varies(part.material.occlusion_texture.is_some() && part.material.occlusion_strength > 0.0)
}

fn emission(part: &Part) -> Look {
    let material = part.material;
    match (material.emissive == [0.0; 3], material.emissive_texture) {
        (true, _) => Look::Unsaid,
        (false, Some(_)) => Look::Varies,
        (false, None) => Look::Value(material.emissive.to_vec()),
    }
}

fn specular(part: &Part) -> Look {
    let own = part.material.specular;
    let [r, g, b] = own.color;
    match own.factor_texture.or(own.color_texture) {
        Some(_) => Look::Varies,
        None => value(own != Specular::default(), vec![own.factor, r, g, b]),
    }
}

fn clearcoat(part: &Part) -> Look {
    let Some(coat) = part.material.clearcoat.filter(|coat| coat.factor > 0.0) else { return Look::Unsaid };
    let has_texture =
        coat.factor_texture.is_some() || coat.roughness_texture.is_some() || coat.normal.is_some();
    if has_texture { Look::Varies } else { Look::Value(vec![coat.factor, coat.roughness]) }
}

fn sheen(part: &Part) -> Look {
    let Some(sheen) = part.material.sheen.filter(|sheen| sheen.color != [0.0; 3]) else {
        return Look::Unsaid;
    };
    let [r, g, b] = sheen.color;
    match sheen.color_texture.or(sheen.roughness_texture) {
        Some(_) => Look::Varies,
        None => Look::Value(vec![r, g, b, sheen.roughness]),
    }
}

/// Its direction follows the UVs, which are new: none of its values is the scan's.
fn anisotropy(part: &Part) -> Look {
    varies(part.material.anisotropy.is_some_and(|anisotropy| anisotropy.strength > 0.0))
}

/// An unreported loss is found: tests the readers and the rule that judge all other models.
#[test]
fn a_property_that_is_lost_is_not_kept() {
    let shining = Material { emissive: [2.0, 0.0, 0.0], ior: 1.3, ..Material::default() };
    let dull = Material { emissive: [1.0, 0.0, 0.0], ..Material::default() };
    let of = |material: &Material, look: Reader| look(&Part { material, has_colors: false });
    let [red, darker] = [&shining, &dull].map(|material| of(material, emission));
    assert!(red.keeps(&red) && Look::Varies.keeps(&red) && !darker.keeps(&red) && !Look::Unsaid.keeps(&red));
    assert!(!red.keeps(&Look::Varies), "one value is not a texture");
    let lost: Vec<&str> = PROPERTIES
        .into_iter()
        .filter(|(_, look)| !of(&dull, *look).keeps(&of(&shining, *look)))
        .map(|(name, _)| name)
        .collect();
    assert_eq!(lost, ["emission", "index of refraction"]);
}
