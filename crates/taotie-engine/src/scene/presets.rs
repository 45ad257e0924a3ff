//! Materials by name.
//!
//! The metals' colours are measured: exact Fresnel reflectance from tabulated n and k (refractiveindex.info, CC0)
//! under the CIE 1931 observer and D65, in linear sRGB; `tests/oracle/metals_oracle.py` computes them and a test
//! compares. A value above 1 is outside the gamut of sRGB and is clipped to 1, which happens only to gold's red.
//! Roughness is not measured: a dull polish that lights relief well.

use super::{Classic, Material};

/// A material that `--material` accepts by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// The name on the command line.
    pub name: &'static str,
    /// A short description.
    pub what: &'static str,
    /// The source of its colours: a measurement, or another origin.
    pub source: &'static str,
}

/// Every preset.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "guo-wang-2025",
        what: "a ruby lacquer that its authors call bronze, as published",
        source: "Guo and Wang 2025, Table 1",
    },
    Preset {
        name: "bronze",
        what: "commercial bronze Cu90Zn10, for lack of measured tin bronze",
        source: "Querry 1985",
    },
    Preset {
        name: "bronze-patina",
        what: "aged bronze: brown-green minerals half covering the metal",
        source: "by eye, over Querry 1985",
    },
    Preset { name: "copper", what: "pure copper", source: "Johnson and Christy 1972" },
    Preset { name: "cu85zn15", what: "red brass Cu85Zn15", source: "Querry 1985" },
    Preset { name: "brass", what: "cartridge brass Cu70Zn30", source: "Querry 1985" },
    Preset {
        name: "gold",
        what: "pure gold; red clipped from 1.038 to 1",
        source: "Johnson and Christy 1972",
    },
    Preset { name: "silver", what: "pure silver", source: "Johnson and Christy 1972" },
    Preset { name: "clay", what: "fired red clay", source: "by eye" },
    Preset { name: "plaster", what: "white plaster, the colour of casts", source: "by eye" },
    Preset { name: "marble", what: "polished white marble without veins or translucency", source: "by eye" },
];

/// Returns the material of this name, or `None`; [`PRESETS`] lists the names.
pub fn preset(name: &str) -> Option<Material> {
    let material = match name {
        "guo-wang-2025" => guo_wang_2025(),
        "bronze" => metal(BRONZE_F0, [0.9511, 0.8406, 0.7258]),
        "bronze-patina" => bronze_patina(),
        "copper" => metal([0.9317, 0.6227, 0.5223], [0.9459, 0.7549, 0.7024]),
        "cu85zn15" => metal([0.9125, 0.7141, 0.4199], [0.9203, 0.8492, 0.7270]),
        "brass" => metal([0.9097, 0.7783, 0.4228], [0.9057, 0.8621, 0.7043]),
        "gold" => metal([1.0, 0.7283, 0.3646], [0.9909, 0.8572, 0.6464]),
        "silver" => metal([0.9894, 0.9840, 0.9778], [0.9876, 0.9860, 0.9870]),
        "clay" => matte([0.46, 0.22, 0.13], 0.85),
        "plaster" => matte([0.80, 0.78, 0.74], 0.90),
        "marble" => Material { f0: Some([0.05; 3]), ..matte([0.82, 0.80, 0.76], 0.30) },
        _ => return None,
    };
    Some(Material { name: name.to_owned(), ..material })
}

/// The reflectance of Cu90Zn10 at normal incidence.
const BRONZE_F0: [f32; 3] = [0.9626, 0.7133, 0.4640];

/// Returns a bare metal.
fn metal(f0: [f32; 3], f82: [f32; 3]) -> Material {
    Material {
        base_color: opaque(f0),
        metallic: 1.0,
        roughness: 0.35,
        f0: Some(f0),
        f82: Some(f82),
        ..Material::default()
    }
}

/// Returns a dielectric of the usual reflectance.
fn matte(base_color: [f32; 3], roughness: f32) -> Material {
    Material { base_color: opaque(base_color), metallic: 0.0, roughness, ..Material::default() }
}

/// Source: Guo and Wang 2025, Table 1. The metallic-roughness values are ours: k_d for the base colour and the
/// roughness whose α equals the slope.
fn guo_wang_2025() -> Material {
    let diffuse = [0.614, 0.341, 0.041];
    Material {
        roughness: std::f32::consts::FRAC_1_SQRT_2,
        f0: Some([0.3; 3]),
        classic: Classic {
            ambient: Some([0.175, 0.012, 0.012]),
            diffuse: Some(diffuse),
            specular: Some([0.8; 3]),
            shininess: None,
            slope: Some(0.5),
        },
        ..matte(diffuse, 0.0)
    }
}

/// Cuprite and malachite behave as dielectrics with an index near 1.8 (F0 0.08); a map may vary the fraction of bare
/// metal, here 0.4 everywhere.
fn bronze_patina() -> Material {
    let metallic = 0.4;
    let f0 = BRONZE_F0.map(|metal| 0.08 * (1.0 - metallic) + metal * metallic);
    Material { metallic, f0: Some(f0), ..matte([0.155, 0.140, 0.085], 0.45) }
}

fn opaque([r, g, b]: [f32; 3]) -> [f32; 4] {
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_name_is_a_material() {
        for listed in PRESETS {
            let material = preset(listed.name).unwrap();
            assert_eq!(material.name, listed.name);
            let colors =
                [material.f0, material.f82, material.classic.diffuse].into_iter().flatten().flatten();
            assert!(colors.chain(material.base_color).all(|c| (0.0..=1.0).contains(&c)), "{}", listed.name);
        }
        assert_eq!(preset("bronz"), None);
    }

    #[test]
    fn the_papers_table_is_kept() {
        let paper = preset("guo-wang-2025").unwrap();
        assert_eq!(paper.classic.ambient, Some([0.175, 0.012, 0.012]));
        assert_eq!(paper.classic.diffuse, Some([0.614, 0.341, 0.041]));
        assert_eq!(
            (paper.classic.specular, paper.f0, paper.classic.slope),
            (Some([0.8; 3]), Some([0.3; 3]), Some(0.5))
        );
    }
}
