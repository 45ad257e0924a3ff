//! The plan of a bake: the side of the maps, and where each property of a scan's material goes: into a map, into a
//! factor of the asset, or nowhere, which is reported.

use crate::asset::ask::BakeOptions;
use crate::asset::source::{Carried, Found, LowLook, LowPoly, Property, ScanSize};
use std::collections::BTreeSet;
use taotie_engine::bake::{MapKind, SetSizes};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;
use taotie_engine::names::Named;
use taotie_engine::scene::Material;

/// A property of a scan's material that its asset lacks.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct DroppedProperty {
    /// Its name.
    pub what: String,
    /// The share of the scan's surface that has it, [0, 1].
    pub part: f64,
}

/// The options of a bake with all maps, and the outcome for each property of the scan's material.
pub(in crate::asset) struct BakePlan {
    /// The options, with maps for the scan's properties if requested.
    pub options: BakeOptions,
    /// The properties that the asset has.
    pub carried: Vec<Property>,
    /// The properties that it does not have.
    pub left: Vec<DroppedProperty>,
    /// The properties stored in factors.
    factors: Vec<Property>,
    notes: Warnings,
}

impl BakePlan {
    /// Plans for a scan and the low-poly mesh, if given, by the appearance of each of its materials. A property is
    /// free if all of them leave it at its default.
    pub fn of(asked: &BakeOptions, scan: &Carried, low: &[LowLook<'_>]) -> Self {
        let options = BakeOptions { maps: maps(asked, scan, low), ..asked.clone() };
        let mut notes = lacking(asked, scan);
        if scan.has_mixed_sides && low.is_empty() {
            let what = "some of the scan's materials are double-sided and others are not: the asset is double-sided everywhere";
            notes.note(what, 1);
        }
        let mut plan = Self { options, carried: vec![], left: vec![], factors: vec![], notes };
        for found in &scan.found {
            let pair = Pair { scan, low };
            plan.add(found, pair.fate(found, &plan.options));
        }
        plan.replace_default_metal(scan, low);
        plan
    }

    /// Replaces the default of glTF, a rough metal, by that of other formats, if the scan has colours or other properties, and
    /// metallic and roughness have their defaults: such a scan is shown as a dielectric.
    fn replace_default_metal(&mut self, scan: &Carried, low: &[LowLook<'_>]) {
        let property = Property::MetallicRoughness;
        let is_stated = scan.found.is_empty() || scan.found.iter().any(|found| found.property == property);
        let is_baked =
            self.options.bakes(&[MapKind::Roughness]) || self.options.bakes(&[MapKind::MetallicRoughness]);
        let is_free = !low.is_empty() && low.iter().all(|low| low.is_free(property));
        if self.options.carry && is_free && !is_stated && !is_baked {
            self.carried.push(property);
            self.factors.push(property);
        }
    }

    fn add(&mut self, found: &Found, fate: Fate) {
        let property = found.property;
        match fate {
            Fate::Map => self.carried.push(property),
            Fate::Factor => {
                self.carried.push(property);
                self.factors.push(property);
            }
            Fate::DroppedProperty(why) => {
                let (what, percent) = (property.name(), found.part * 100.0);
                let why = if why.is_empty() { why } else { format!("; {why}") };
                self.notes
                    .note(format!("left out: the scan's {what}, on {percent:.1} % of its surface{why}"), 1);
                self.left.push(DroppedProperty { what: what.to_owned(), part: found.part });
            }
        }
    }

    /// Notes omitted properties, and requested maps that are uniform.
    pub fn note(&self, warnings: &mut Warnings) {
        warnings.absorb(self.notes.clone());
    }

    /// Fills in the factors that the material of a low-poly mesh leaves at their defaults.
    pub fn fill(&self, scan: &Carried, material: &mut Material) {
        self.factors.iter().for_each(|property| property.copy(&scan.material, material));
    }
}

/// Returns the requested maps, and those of varying properties if the options carry them.
fn maps(options: &BakeOptions, scan: &Carried, low: &[LowLook<'_>]) -> Vec<MapKind> {
    let mut maps = options.maps.clone();
    let is_open = |property: &Property| options.carry && low.iter().all(|low| low.is_free(*property));
    let wanted = scan.varying().filter(is_open).filter_map(Property::map);
    // Ray-traced occlusion overrides that of a texture.
    let wanted = wanted.filter(|map| *map != MapKind::OcclusionMap || !options.bakes(&[MapKind::Occlusion]));
    maps.extend(wanted);
    if maps.contains(&MapKind::Alpha) {
        maps.push(MapKind::Albedo);
    }
    let mut unique = Vec::with_capacity(maps.len());
    maps.into_iter().for_each(|map| {
        if !unique.contains(&map) {
            unique.push(map);
        }
    });
    unique
}

/// A scan and the given low-poly mesh.
#[derive(Clone, Copy)]
struct Pair<'a> {
    scan: &'a Carried,
    /// One for each material; empty if the mesh is generated.
    low: &'a [LowLook<'a>],
}

/// The outcome for a property.
enum Fate {
    /// It is stored in a map.
    Map,
    /// It is stored in a factor of the asset's material.
    Factor,
    /// It is not stored; the text is the remedy, or empty.
    DroppedProperty(String),
}

impl Pair<'_> {
    fn fate(&self, found: &Found, options: &BakeOptions) -> Fate {
        let (property, map) = (found.property, found.property.map());
        let by_rays = map == Some(MapKind::OcclusionMap) && options.bakes(&[MapKind::Occlusion]);
        if !by_rays && map.is_some_and(|map| options.bakes(&[map])) {
            return Fate::Map;
        }
        let is_free = self.low.iter().all(|low| low.is_free(property));
        if found.is_uniform && (self.is_same(property) || (is_free && (self.low.is_empty() || options.carry)))
        {
            return Fate::Factor;
        }
        let is_rough = property == Property::MetallicRoughness && options.bakes(&[MapKind::Roughness]);
        Fate::DroppedProperty(match map {
            _ if !is_free && is_rough => {
                "roughness is baked, and the low-poly mesh's metalness is kept".into()
            }
            _ if !is_free => "the low-poly mesh's own is kept".into(),
            Some(MapKind::OcclusionMap) if options.bakes(&[MapKind::Occlusion]) => {
                "ao is baked instead".into()
            }
            Some(map) => format!("bake {} to keep it", map.name()),
            None => String::new(),
        })
    }

    /// Returns true if the low-poly mesh has the same value.
    fn is_same(&self, property: Property) -> bool {
        let is_same = |low: &LowLook| {
            property.isolated(low.material) == property.isolated(&self.scan.material)
                && !(property == Property::BaseColor && low.has_colors)
        };
        !self.low.is_empty() && self.low.iter().all(is_same)
    }
}

/// Returns notes on requested maps of properties that are uniform over the scan.
fn lacking(asked: &BakeOptions, scan: &Carried) -> Warnings {
    let mut warnings = Warnings::default();
    let is_idle = |property: &Property| {
        let map = property.map().filter(|map| *map != MapKind::Normal);
        map.is_some_and(|map| asked.bakes(&[map])) && !scan.varies(*property)
    };
    for property in Property::all().into_iter().filter(is_idle) {
        let (what, map) = (property.name(), property.map().map_or("", MapKind::name));
        warnings.note(format!("the {map} map is uniform: the scan's {what} does not vary"), 1);
    }
    warnings
}

impl BakeOptions {
    /// Returns the options with [`BakeOptions::AUTO_SIZE`] replaced by the number of texels chosen for a scan of this size.
    pub fn sized(&self, scan: ScanSize) -> Self {
        let size = if self.size == Self::AUTO_SIZE { chosen_side(scan.detail_side) } else { self.size };
        Self { size, ..self.clone() }
    }
}

/// Returns the size of the maps of each low-poly mesh. Notes even sizes if there is only one.
///
/// # Errors
/// [`Error::Invalid`] if a size has the name of no material.
pub(in crate::asset) fn set_sizes(
    options: &BakeOptions,
    lows: &[LowPoly],
    warnings: &mut Warnings,
) -> Result<Vec<[u32; 2]>> {
    let usual = options.map_size();
    match &options.sizes {
        SetSizes::Same => Ok(vec![usual; lows.len()]),
        SetSizes::Even => {
            let is_single = usize::from(lows.len() == 1);
            warnings.note("even sizes have no effect: the low-poly mesh has one set of maps", is_single);
            let widths: Vec<f64> = lows.iter().map(|low| width_of_map(&low.mesh)).collect();
            let widest = widths.iter().fold(0.0, |most: f64, width| most.max(*width));
            let side = |side: u32, width: f64| (f64::from(side) * width / widest / 4.0).round() as u32 * 4;
            let size = |width: &f64| usual.map(|usual| side(usual, *width).clamp(16, usual));
            Ok(widths.iter().map(size).collect())
        }
        SetSizes::Named(sizes) => {
            let names: BTreeSet<&str> = lows.iter().flat_map(|low| [low.label(), low.file_label()]).collect();
            if let Some(name) = sizes.keys().find(|name| !names.contains(name.as_str())) {
                let names: Vec<&str> = names.into_iter().filter(|name| !name.is_empty()).collect();
                let why = match names.is_empty() {
                    true => "the low-poly mesh has one set of maps; set the size of the bake".to_owned(),
                    false => format!("the low-poly mesh has no such maps; it has {}", names.join(", ")),
                };
                return Err(Error::invalid(format!("the size of {name}"), why));
            }
            // The name of a tile overrides that of its material.
            let own = |low: &LowPoly| sizes.get(low.label()).or_else(|| sizes.get(low.file_label())).copied();
            let size = |low: &LowPoly| own(low).map_or(usual, |side| [side; 2]);
            Ok(lows.iter().map(size).collect())
        }
    }
}

/// Returns the width on the surface, in model units, of a map on the first uvs of a mesh, on average.
fn width_of_map(mesh: &Mesh) -> f64 {
    let Some(uvs) = mesh.uvs().first() else { return 0.0 };
    let (mut surface, mut map) = (0.0, 0.0);
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = mesh.corners(t).map(Vec3::to_f64);
        surface += (b - a).cross(c - a).length();
        let [a, b, c] = corners.map(|v| uvs[v as usize]);
        map += f64::from((b - a).cross(c - a)).abs();
    }
    if map > 0.0 { (surface / map).sqrt() } else { 0.0 }
}

/// The range of automatically chosen sides.
const CHOSEN: [u32; 2] = [256, 8192];

/// Returns the side of maps for a scan whose detail needs `detail` texels.
pub(in crate::asset) fn chosen_side(detail: u32) -> u32 {
    detail.clamp(CHOSEN[0], CHOSEN[1])
}

/// Returns a warning if the chosen side loses detail.
pub(in crate::asset) fn side_shortfall(detail: u32) -> Option<String> {
    let side = chosen_side(detail);
    (detail > side).then(|| {
        format!(
            "maps of {side}×{side} texels, the largest that auto chooses, are about {} × coarser than the scan's detail; use \
             a larger size, or bake parts of the scan",
            detail / side
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scan with these properties; varying ones are on a quarter of its surface.
    fn scan(material: Material, varying: &[Property]) -> Carried {
        let uniform = Property::all().into_iter().filter(|property| property.is_said(&material));
        let uniform = uniform.map(|property| Found { property, is_uniform: true, part: 1.0 });
        let varying = varying.iter().map(|p| Found { property: *p, is_uniform: false, part: 0.25 });
        let found = uniform.chain(varying).collect();
        Carried { material, found, ..Carried::default() }
    }

    fn plan(options: &BakeOptions, scan: &Carried) -> BakePlan {
        BakePlan::of(options, scan, &[])
    }

    fn onto(low: &Material, scan: &Carried) -> BakePlan {
        let low = LowLook { material: low, has_colors: false };
        BakePlan::of(&BakeOptions::default(), scan, &[low])
    }

    fn said(plan: &BakePlan) -> String {
        let mut warnings = Warnings::default();
        plan.note(&mut warnings);
        warnings.iter().map(|(what, _)| format!("{what}\n")).collect()
    }

    fn lamp() -> Material {
        Material { emissive: [1.0; 3], ..Material::default() }
    }

    #[test]
    fn auto_bakes_what_varies() {
        let varying = [Property::BaseColor, Property::NormalMap, Property::Emission];
        let plan = plan(&BakeOptions::default(), &scan(Material::default(), &varying));
        assert_eq!(plan.options.maps, [MapKind::Normal, MapKind::Albedo, MapKind::Emission]);
        assert_eq!((plan.carried.as_slice(), plan.left.as_slice()), (&varying[..], &[][..]));
        assert_eq!(said(&plan), "");
    }

    #[test]
    fn what_is_not_asked_for_is_told_with_its_share() {
        let options = BakeOptions { carry: false, ..BakeOptions::default() };
        let plan = plan(&options, &scan(Material::default(), &[Property::Emission, Property::Unlit]));
        assert_eq!(plan.options.maps, options.maps);
        let left = [Property::Emission, Property::Unlit];
        assert_eq!(plan.left, left.map(|p| DroppedProperty { what: p.name().into(), part: 0.25 }));
        let emission = "left out: the scan's emission, on 25.0 % of its surface; bake emission to keep it\n";
        assert_eq!(
            said(&plan),
            format!("{emission}left out: the scan's unlit look, on 25.0 % of its surface\n")
        );
    }

    #[test]
    fn occlusion_by_rays_goes_before_that_of_a_texture() {
        let maps = vec![MapKind::Normal, MapKind::Occlusion];
        let options = BakeOptions { maps: maps.clone(), ..BakeOptions::default() };
        let plan = plan(&options, &scan(Material::default(), &[Property::Occlusion]));
        assert_eq!(plan.options.maps, maps);
        assert!(said(&plan).ends_with("; ao is baked instead\n"), "{}", said(&plan));
    }

    #[test]
    fn alpha_brings_the_texture_that_it_stands_in() {
        let options = BakeOptions { maps: vec![MapKind::Alpha], carry: false, ..BakeOptions::default() };
        let plan = plan(&options, &scan(Material::default(), &[Property::Alpha]));
        assert_eq!(plan.options.maps, [MapKind::Alpha, MapKind::Albedo]);
    }

    #[test]
    fn a_low_poly_mesh_keeps_what_it_says_and_is_given_what_it_leaves_open() {
        let red = Material { base_color: [1.0, 0.0, 0.0, 1.0], ..Material::default() };
        let scan = scan(lamp(), &[Property::BaseColor]);
        for open in [Material::default(), Material { base_color: [1.0; 4], ..Material::default() }] {
            let plan = onto(&open, &scan);
            assert_eq!(plan.options.maps, [MapKind::Normal, MapKind::Albedo]);
            let mut filled = open.clone();
            plan.fill(&scan, &mut filled);
            assert_eq!(filled, Material { emissive: [1.0; 3], ..open });
        }
        let plan = onto(&red, &scan);
        assert_eq!(plan.options.maps, [MapKind::Normal]);
        assert!(
            said(&plan).contains("base colour, on 25.0 % of its surface; the low-poly mesh's own is kept")
        );
        let mut filled = Material { emissive: [2.0; 3], ..red.clone() };
        onto(&filled.clone(), &scan).fill(&scan, &mut filled);
        assert_eq!(filled.emissive, [2.0; 3]);
        // A property equal on both sides is not reported.
        assert!(onto(&lamp(), &self::scan(lamp(), &[])).left.is_empty());
    }

    #[test]
    fn what_one_material_says_stays_for_all() {
        let (open, red) =
            (Material::default(), Material { base_color: [1.0, 0.0, 0.0, 1.0], ..Material::default() });
        let looks = [&open, &red].map(|material| LowLook { material, has_colors: false });
        let scan = scan(Material::default(), &[Property::BaseColor]);
        let plan = BakePlan::of(&BakeOptions::default(), &scan, &looks);
        assert_eq!(plan.options.maps, [MapKind::Normal]);
        assert!(said(&plan).contains("the low-poly mesh's own is kept"));
        let plan = BakePlan::of(&BakeOptions::default(), &scan, &looks[..1]);
        assert_eq!(plan.options.maps, [MapKind::Normal, MapKind::Albedo]);
    }

    #[test]
    fn roughness_is_baked_beside_the_metalness_of_a_low_poly_mesh() {
        let brass = Material { metallic: 1.0, roughness: 0.3, ..Material::default() };
        let low = LowLook { material: &brass, has_colors: false };
        let scan = scan(Material::default(), &[Property::MetallicRoughness]);
        let stays = |maps: &[MapKind]| {
            let options = BakeOptions { maps: maps.to_vec(), ..BakeOptions::default() };
            said(&BakePlan::of(&options, &scan, &[low]))
        };
        let noted = stays(&[MapKind::Roughness]);
        assert!(
            noted.contains("; roughness is baked, and the low-poly mesh's metalness is kept\n"),
            "{noted}"
        );
        let noted = stays(&[MapKind::Normal]);
        assert!(noted.contains("; the low-poly mesh's own is kept\n"), "{noted}");
    }

    #[test]
    fn maps_of_what_does_not_vary_are_told() {
        let maps = vec![MapKind::Normal, MapKind::Emission];
        let options = BakeOptions { maps, ..BakeOptions::default() };
        assert_eq!(lacking(&options, &scan(lamp(), &[])).iter().count(), 1);
        assert!(lacking(&options, &scan(Material::default(), &[Property::Emission])).is_empty());
    }

    #[test]
    fn maps_that_auto_adds_are_not_judged() {
        let scan = scan(Material::default(), &[Property::Alpha]);
        let plan = plan(&BakeOptions::default(), &scan);
        assert_eq!(plan.options.maps, [MapKind::Normal, MapKind::Alpha, MapKind::Albedo]);
        assert_eq!(said(&plan), "", "albedo was not requested");
        let options = BakeOptions { maps: vec![MapKind::Albedo], ..BakeOptions::default() };
        assert!(said(&BakePlan::of(&options, &scan, &[])).contains("the albedo map is uniform"));
    }

    #[test]
    fn chosen_sides_are_bounded_and_a_loss_is_stated() {
        assert_eq!([1, 256, 2048, 8192, 32_768].map(chosen_side), [256, 256, 2048, 8192, 8192]);
        assert_eq!(side_shortfall(8192), None);
        assert!(side_shortfall(32_768).is_some_and(|text| text.contains("about 4 × coarser")));
    }
}
