//! The vessel with its relief as geometry.

use super::draft::draft;
use crate::demo::output::Output;
use std::path::PathBuf;
use taotie_engine::Result;
use taotie_engine::mesh::Mesh;

/// Writes `mesh`, the vessel with its relief as geometry, to `jue-high.glb`; returns the file.
///
/// # Errors
/// Those of writing files.
pub fn write(output: &Output<'_>, mesh: &Mesh) -> Result<PathBuf> {
    let path = output.folder.join("jue-high.glb");
    draft(mesh, None)?.write_glb_in(output.files, &path)?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::Vessel;
    use crate::demo::export;
    use crate::jue;

    #[test]
    fn the_file_contains_the_mesh() {
        let folder = tempfile::tempdir().unwrap();
        let ours = &jue::displaced_mesh(0.004);
        let written = taotie_io::FileSet::one(|files| {
            let output = Output { files, folder: folder.path(), side: 64 };
            export::write(&output, &Vessel::new(64))?;
            write(&output, ours)
        });
        let loaded = taotie_io::load_model(&written.unwrap()).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let read = &loaded.scene.meshes()[0];
        assert_eq!(read.positions(), ours.positions());
        assert_eq!((read.uvs(), read.triangles()), (ours.uvs(), ours.triangles()));
        // The reader normalises normals to the last bit.
        let mut normals = read.normals().iter().zip(ours.normals());
        assert!(normals.all(|(a, b)| (*a - *b).length() < 1e-6));
        assert!(loaded.scene.materials()[0].normal.is_none());
    }
}
