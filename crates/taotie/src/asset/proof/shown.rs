//! A level of detail of an asset as a viewer shows it, and its differences on the surface, along the rays of a bake.

use super::figures::{LevelFigures, MaterialFigures, PartFigures};
use crate::asset::source::{Scan, is_plain};
use std::path::Path;
use taotie_engine::bake::{self, Cage, LookupPoint, MaterialError, TexturedMesh, Verifier};
use taotie_engine::compare::Field;
use taotie_engine::error::{Error, Result};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::sample_area;
use taotie_engine::proof::Properties;
use taotie_engine::scene::{AlphaMode, Scene};
use taotie_engine::surface::facet_normal;

/// The maximum number of materials measured separately; more are measured as one.
const MOST_PARTS: usize = 64;

/// The triangles of one material, and the cage from which they are projected onto the scan.
pub(super) struct ShownPart {
    /// The material's name, or its number if it has none; empty if the asset has only one.
    pub label: String,
    pub shown: TexturedMesh,
    /// `true` if the material has a normal or height map.
    pub has_relief: bool,
    cage: Cage,
}

/// A level of detail, sorted for rays.
pub(super) struct ShownLevel<'a> {
    /// All of its triangles.
    pub surface: bake::Scan,
    /// One for each material, at least one.
    pub parts: Vec<ShownPart>,
    scan: &'a Scan,
    whole_cage: Cage,
    /// `true` if the files show a material, and the scan specifies one.
    has_material: bool,
    /// `true` if the files specify no colour and no material.
    is_plain: bool,
}

impl ShownPart {
    fn of(scene: Scene, label: String, scan: &Scan) -> Result<Self> {
        let has_relief = scene.instances().iter().any(|instance| {
            let material = &scene.materials()[instance.material];
            material.normal.is_some() || material.height.is_some()
        });
        let shown = TexturedMesh::new(scene)?;
        let cage = Cage::automatic(shown.mesh(), scan.sorted());
        Ok(Self { label, shown, has_relief, cage })
    }
}

impl<'a> ShownLevel<'a> {
    /// Creates a level from a scene that was read from `path`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it has no triangles; [`Error::Limit`] for more than 2^32 − 1 vertices.
    pub fn of(scene: &Scene, scan: &'a Scan, (path, has_material): (&Path, bool)) -> Result<Self> {
        let surface = bake::Scan::of_asset(scene.clone(), scan.sorted())?;
        if surface.mesh().triangles().is_empty() {
            return Err(Error::invalid(path.display().to_string(), "it has no triangles to measure"));
        }
        let mut used: Vec<usize> = scene.instances().iter().map(|instance| instance.material).collect();
        used.sort_unstable();
        used.dedup();
        let parts = match used.len() {
            2..=MOST_PARTS => {
                used.iter().map(|material| part(scene, *material, scan)).collect::<Result<_>>()?
            }
            _ => vec![ShownPart::of(scene.clone(), String::new(), scan)?],
        };
        let whole_cage = match &parts[..] {
            [only] => only.cage.clone(),
            _ => Cage::automatic(surface.mesh(), scan.sorted()),
        };
        let has_material = has_material && !scan.about.is_plain;
        Ok(Self { surface, parts, scan, whole_cage, has_material, is_plain: is_plain(scene) })
    }

    /// Returns the surfaces of all parts.
    pub fn part_surfaces(&self) -> Vec<PartSurface<'_>> {
        self.parts.iter().map(|part| self.of_part(part)).collect()
    }

    fn of_part<'s>(&'s self, part: &'s ShownPart) -> PartSurface<'s> {
        let (mesh, cage) = (part.shown.mesh(), &part.cage);
        let plain = Verifier { mesh, shown: None, cage, scan: self.scan.sorted() };
        let mapped = Verifier { shown: Some(&part.shown), ..plain };
        PartSurface { mapped, plain, material: self.has_material.then_some(&part.shown) }
    }

    /// Returns all triangles, for their fit to the scan.
    pub fn whole(&self) -> Verifier<'_> {
        Verifier { mesh: self.surface.mesh(), shown: None, cage: &self.whole_cage, scan: self.scan.sorted() }
    }

    /// Returns the scan, sorted for rays.
    pub fn scan(&self) -> &bake::Scan {
        self.scan.sorted()
    }

    /// Returns the properties that are compared in addition to normals.
    pub fn properties(&self) -> Properties {
        Properties::of([self.has_material, self.scan.about.states_material], &self.surface)
    }

    /// Returns `true` if the scan specifies colours or materials, but the asset shows the default of its format.
    pub fn lacks_material(&self) -> bool {
        self.has_material && self.is_plain
    }
}

/// Returns the triangles of one of several materials.
fn part(scene: &Scene, material: usize, scan: &Scan) -> Result<ShownPart> {
    let mut own = scene.clone();
    own.edit(|scene| scene.instances.retain(|instance| instance.material == material))?;
    let label = match scene.materials()[material].name.as_str() {
        "" => format!("material {material}"),
        name => name.to_owned(),
    };
    ShownPart::of(own, label, scan)
}

/// The triangles of one material at a level of detail, with their normal map and without.
pub(super) struct PartSurface<'a> {
    pub mapped: Verifier<'a>,
    pub plain: Verifier<'a>,
    /// Their material, if it is compared.
    pub material: Option<&'a TexturedMesh>,
}

/// The differences of the triangles of one material, point by point.
pub(super) struct Measured {
    pub angles: Field,
    pub plain: Field,
    pub missed: f64,
    pub lost: f64,
    material: Option<MaterialError>,
}

impl PartSurface<'_> {
    fn measured(&self, points: usize) -> Result<Measured> {
        let normal_error = self.mapped.normal_error(points)?;
        Ok(Measured {
            plain: self.plain.normal_error((points / 10).max(1))?.angles,
            missed: normal_error.missed,
            lost: normal_error.lost,
            angles: normal_error.angles,
            material: self.material.map(|own| self.mapped.material_error(own, points)).transpose()?,
        })
    }
}

/// Measures each part along the rays of a bake, at `points` points spread evenly over the total area.
///
/// # Errors
/// Those of [`Verifier::normal_error`].
pub(super) fn measured(parts: &[PartSurface<'_>], points: usize) -> Result<Vec<Measured>> {
    if let [only] = parts {
        return Ok(vec![only.measured(points)?]);
    }
    let areas: Vec<f64> = parts.iter().map(|part| part.mapped.mesh.area(&Mat4::IDENTITY)).collect();
    let all: f64 = areas.iter().sum();
    let count = |area: f64| (points as f64 * area / all).max(1.0) as usize;
    parts.iter().zip(areas).map(|(part, area)| part.measured(count(area))).collect()
}

/// Bins of the histogram.
const BINS: usize = 50;

impl LevelFigures {
    /// Returns the figures on the surface, from the measurements of all parts.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] for more than 2^32 − 1 points.
    pub(super) fn on_surface(found: &[Measured], triangles: usize) -> Result<Self> {
        let angles = chained(found.iter().map(|part| &part.angles))?;
        let plain = chained(found.iter().map(|part| &part.plain))?;
        Ok(Self {
            triangles,
            surface_angles: angles.summary(),
            histogram: angles.histogram(BINS, (BINS as f64 * LevelFigures::BIN_WIDTH) as f32),
            without_map: plain.summary(),
            surface_missed: weighted(found, |part| part.missed),
            material: material_figures(found)?,
            ..Self::default()
        })
    }
}

/// Returns the mean of a figure over the points of all parts.
fn weighted(found: &[Measured], figure: impl Fn(&Measured) -> f64) -> f64 {
    if let [only] = found {
        return figure(only);
    }
    let points = |part: &Measured| part.angles.values().len() as f64;
    let sum: f64 = found.iter().map(|part| figure(part) * points(part)).sum();
    sum / found.iter().map(points).sum::<f64>()
}

fn material_figures(found: &[Measured]) -> Result<MaterialFigures> {
    let errors: Option<Vec<&MaterialError>> = found.iter().map(|part| part.material.as_ref()).collect();
    let Some(errors) = errors else { return Ok(MaterialFigures::default()) };
    let all = |of: fn(&MaterialError) -> &Field| chained(errors.iter().map(|error| of(error)));
    Ok(MaterialFigures::of(&MaterialError {
        color: all(|error| &error.color)?,
        metallic: all(|error| &error.metallic)?,
        roughness: all(|error| &error.roughness)?,
        emission: all(|error| &error.emission)?,
        alpha: all(|error| &error.alpha)?,
        not_finite: weighted(found, |part| part.material.as_ref().map_or(0.0, |error| error.not_finite)),
    }))
}

/// Returns the values of several fields as one row.
fn chained<'a>(fields: impl Iterator<Item = &'a Field>) -> Result<Field> {
    let values: Vec<f32> = fields.flat_map(|field| field.values()).copied().collect();
    Field::new(values.len() as u32, 1, values)
}

/// Returns fields stacked vertically, left-aligned; narrower ones are padded with NaN.
pub(super) fn stacked(fields: &[Field]) -> Result<Field> {
    let width = fields.iter().map(Field::width).max().unwrap_or_default();
    let mut values = Vec::new();
    for field in fields {
        for row in field.values().chunks(field.width() as usize) {
            values.extend_from_slice(row);
            values.extend(std::iter::repeat_n(f32::NAN, width as usize - row.len()));
        }
    }
    Field::new(width, fields.iter().map(Field::height).sum(), values)
}

impl PartFigures {
    /// Summarizes the measurements of a material with this number of triangles.
    pub(super) fn of(material: &str, triangles: usize, found: &Measured) -> Self {
        Self {
            material: material.to_owned(),
            triangles,
            angles: found.angles.summary(),
            without_map: found.plain.summary(),
            missed: found.missed,
            lost: found.lost,
        }
    }
}

/// Properties of a surface that figures do not compare.
pub(super) struct Shading {
    /// The share of the area whose normals are those of the triangles.
    pub flat: f64,
    /// The mean occlusion, 1 where there is no texture of it.
    pub occlusion: f64,
    /// The share of the area whose materials are blended although all of their surface is solid.
    pub needlessly_blended: f64,
}

impl Shading {
    pub fn of(surface: &TexturedMesh) -> Self {
        const POINTS: usize = 2_000;
        /// The cosine of 0.5°.
        const SAME: f32 = 0.999_962;
        let mesh = surface.mesh();
        let Ok(point) = sample_area(mesh, POINTS) else {
            return Self { flat: 0.0, occlusion: 1.0, needlessly_blended: 0.0 };
        };
        let (mut occlusion, mut flat, mut blended, mut is_seen_through) = (0.0, 0, 0, false);
        for point in (0..POINTS).map(point) {
            let material = surface.material(point.triangle);
            let facet = facet_normal(mesh.corners(point.triangle as usize));
            flat += i32::from(facet.is_some_and(|facet| facet.dot(point.normal(mesh)) > SAME));
            occlusion += match material.occlusion_texture {
                Some(_) => f64::from(surface.sample(LookupPoint::finest(point)).occlusion),
                None => 1.0,
            };
            if material.alpha == AlphaMode::Blend {
                blended += 1;
                is_seen_through |= !surface.is_solid_at(point);
            }
        }
        let share = |count: i32| f64::from(count) / POINTS as f64;
        let needlessly_blended = if is_seen_through { 0.0 } else { share(blended) };
        Self { flat: share(flat), occlusion: occlusion / POINTS as f64, needlessly_blended }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(angles: &[f32], missed: f64) -> Measured {
        let row = |values: &[f32]| Field::new(values.len() as u32, 1, values.to_vec()).unwrap();
        Measured { angles: row(angles), plain: row(&[1.0]), missed, lost: 0.0, material: None }
    }

    #[test]
    fn parts_count_by_their_points() {
        let found = [measured(&[1.0, 2.0, 3.0], 0.0), measured(&[10.0], 1.0)];
        let all = chained(found.iter().map(|part| &part.angles)).unwrap();
        assert_eq!((all.values().len(), all.summary().unwrap().mean), (4, 4.0));
        assert_eq!(weighted(&found, |part| part.missed), 0.25);
        let columns = [Field::new(1, 2, vec![1.0, 2.0]).unwrap(), Field::new(2, 1, vec![3.0, 4.0]).unwrap()];
        let stack = stacked(&columns).unwrap();
        assert_eq!((stack.width(), stack.height()), (2, 3));
        let known: Vec<f32> = stack.values().iter().copied().filter(|value| !value.is_nan()).collect();
        assert_eq!(known, [1.0, 2.0, 3.0, 4.0]);
        assert!(stack.values()[1].is_nan() && stack.values()[3].is_nan(), "next to the narrower one");
    }
}
