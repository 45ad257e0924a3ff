//! The inputs of a bake besides the scan: the low-poly mesh and the cage. They are read before the work begins.

use super::given::GivenMesh;
use super::low_file::{self, Read};
use super::options::{BakeOptions, MeshSource, RayDistance};
use super::scan::Scan;
use crate::bake;
use crate::error::{Error, Result, Warnings};
use crate::mesh::{Mesh, MeshData};
use crate::progress::Progress;
use std::ops::Range;
use std::path::PathBuf;

/// The inputs of a bake besides the scan.
pub(super) struct Inputs {
    /// The given low-poly mesh; `None` if it is generated.
    pub given: Option<GivenMesh>,
    pub rays: Rays,
    /// The files that they were read from.
    pub files: Vec<PathBuf>,
    /// The warnings about these files.
    pub warnings: Warnings,
}

/// The lengths of projection rays, with the cage from the options.
pub(super) enum Rays {
    /// By the measured gap between the meshes.
    Auto,
    /// One length, model units.
    Uniform(f64),
    Cage(CageMesh),
}

/// The mesh of a cage.
pub(super) struct CageMesh {
    pub mesh: Mesh,
    pub source: MeshSource,
}

impl CageMesh {
    /// Refuses a cage whose number of triangles differs from the low-poly mesh's.
    fn check(&self, count: usize) -> Result<()> {
        let own = self.mesh.triangles().len();
        if own == count {
            return Ok(());
        }
        let why = "it must be the low-poly mesh with moved vertices";
        let error = Error::invalid(
            "the cage",
            format!("it has {own} triangles, but the low-poly mesh has {count}; {why}"),
        );
        Err(self.named(error))
    }

    /// Returns the cage of a part of the low-poly mesh, given its triangle ranges in the whole.
    pub fn part(&self, ranges: &[Range<usize>]) -> Result<Mesh> {
        let (positions, all) = (self.mesh.positions().to_vec(), self.mesh.triangles());
        let triangles = ranges.iter().flat_map(|range| all[range.clone()].iter().copied()).collect();
        Mesh::new(MeshData { positions, triangles, ..MeshData::default() })
    }

    /// Returns the error prefixed with the file it concerns.
    pub fn named(&self, error: Error) -> Error {
        match (self.source.path(), error) {
            (Some(path), Error::Invalid { what, why }) => Error::invalid(format!("{path}: {what}"), why),
            (_, error) => error,
        }
    }
}

/// Reads meshes for a scan and collects their files and warnings.
struct Reader<'a> {
    scan: &'a Scan,
    files: Vec<PathBuf>,
    warnings: Warnings,
}

impl Inputs {
    /// Reads the inputs that the options name, for a scan.
    ///
    /// # Errors
    /// Those of [`GivenMesh::of`], and of reading.
    pub fn read(options: &BakeOptions, scan: &Scan, progress: Progress<'_>) -> Result<Self> {
        let mut reader = Reader { scan, files: Vec::new(), warnings: Warnings::default() };
        let given = match &options.low {
            Some(source) => {
                let reading = progress.begin("read the low-poly mesh")?;
                let read = reader.read(source)?;
                let given = GivenMesh::of(options, source, read, &mut reader.warnings)?;
                reading.at(1.0)?;
                Some(given)
            }
            None => None,
        };
        let rays = reader.rays(&options.ray_distance)?;
        if let (Some(given), Rays::Cage(cage)) = (&given, &rays) {
            cage.check(given.triangle_count())?;
        }
        let Reader { files, warnings, .. } = reader;
        Ok(Self { given, rays, files, warnings })
    }
}

impl Reader<'_> {
    fn read(&mut self, source: &MeshSource) -> Result<Read> {
        let mut read = low_file::read(source, self.scan, &mut self.warnings)?;
        self.files.append(&mut read.files);
        Ok(read)
    }

    fn rays(&mut self, distance: &RayDistance) -> Result<Rays> {
        Ok(match distance {
            RayDistance::Auto => Rays::Auto,
            RayDistance::Uniform(distance) => Rays::Uniform(*distance),
            RayDistance::Cage(source) => {
                let mesh = bake::low_poly_mesh(self.read(source)?.scene)?;
                Rays::Cage(CageMesh { mesh, source: source.clone() })
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{GltfAsset, GltfFormat, GltfLevel, write_gltf};

    #[test]
    fn every_file_of_low_poly_mesh_and_cage_is_known() {
        let folder = tempfile::tempdir().unwrap();
        let levels = [GltfLevel { mesh: &Mesh::sphere(1.0, 8, 4), coverage: None }];
        let asset = GltfAsset { levels: &levels, ..GltfAsset::default() };
        let [low, cage] = ["low.gltf", "cage.gltf"].map(|name| {
            let path = folder.path().join(name);
            write_gltf(&path, &asset, &GltfFormat::default()).unwrap();
            MeshSource::File(path)
        });
        let options =
            BakeOptions { low: Some(low), ray_distance: RayDistance::Cage(cage), ..BakeOptions::default() };
        let scan = Scan::from_mesh(Mesh::sphere(1.0, 16, 8), Progress::SILENT).unwrap();
        let inputs = Inputs::read(&options, &scan, Progress::SILENT).unwrap();
        let names: Vec<_> = inputs.files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
        assert_eq!(names, ["low.gltf", "low.bin", "cage.gltf", "cage.bin"]);
        assert!(inputs.given.is_some() && matches!(inputs.rays, Rays::Cage(_)));
        let none = Inputs::read(&BakeOptions::default(), &scan, Progress::SILENT).unwrap();
        assert!(none.given.is_none() && none.files.is_empty());
    }
}
