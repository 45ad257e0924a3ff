//! A level of detail of an asset as a viewer shows it, prepared for measurement.

use super::level_figures::PartSurface;
use super::look;
use super::scan::Scan;
use crate::bake::{self, Cage, TexturedMesh, Verifier};
use crate::error::{Error, Result};
use crate::scene::Scene;
use std::path::Path;

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
        Ok(Self { surface, parts, scan, whole_cage, has_material, is_plain: look::is_plain(scene) })
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

    /// Returns `true` if colours and materials are compared, since the scan specifies them.
    pub fn has_material(&self) -> bool {
        self.has_material
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
