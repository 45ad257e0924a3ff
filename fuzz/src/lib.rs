//! What the targets share: models are read from paths, so the bytes at hand go into a file first.

/// Reads `bytes` as the model file `a.<extension>`, beside the given other files. Only a panic is a failure.
pub fn load(extension: &str, bytes: &[u8], beside: &[(&str, &[u8])]) {
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let path = folder.path().join(format!("a.{extension}"));
    std::fs::write(&path, bytes).expect("room for temporary files");
    for (name, bytes) in beside {
        std::fs::write(folder.path().join(name), bytes).expect("room for temporary files");
    }
    if let Ok(mut loaded) = taotie::io::load_model(&path) {
        // What a reader lets through must be consistent.
        let scene = &loaded.scene;
        assert!(scene.instances().iter().all(|i| i.mesh < scene.meshes().len()));
        assert!(scene.instances().iter().all(|i| i.material < scene.materials().len()));
        scene.bounds();
        if let Some(rig) = loaded.rig {
            for animation in 0..rig.animations().len().min(4) {
                let _ = rig.pose(&mut loaded.scene, animation, rig.animations()[animation].seconds() * 0.4);
            }
        }
    }
}
