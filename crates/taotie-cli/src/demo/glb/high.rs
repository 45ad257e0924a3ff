//! The vessel with its relief as geometry.

use anyhow::Result;
use std::path::{Path, PathBuf};
use taotie::scene::Scene;

/// Writes the first mesh of `scene` to `jue-high.glb` in `folder`; returns the file.
///
/// # Errors
/// Those of writing.
pub fn write(folder: &Path, scene: &Scene) -> Result<PathBuf> {
    let path = folder.join("jue-high.glb");
    super::draft(&scene.meshes()[0], None)?.write_glb(&path)?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::{export, truth};
    use crate::jue;
    use taotie::io;

    #[test]
    fn the_file_holds_the_mesh() {
        let folder = tempfile::tempdir().unwrap();
        let scene = jue::scene(64);
        export::write(folder.path(), &scene).unwrap();
        let high = truth::with_relief(&scene, jue::displaced_mesh(0.004));
        let loaded = io::load_model(&write(folder.path(), &high).unwrap()).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let (read, ours) = (&loaded.scene.meshes()[0], &high.meshes()[0]);
        assert_eq!(read.positions(), ours.positions());
        assert_eq!((read.uvs(), read.triangles()), (ours.uvs(), ours.triangles()));
        // The reader makes normals unit to the last bit.
        let mut normals = read.normals().iter().zip(ours.normals());
        assert!(normals.all(|(a, b)| (*a - *b).length() < 1e-6));
        assert!(loaded.scene.materials()[0].normal.is_none());
    }
}
