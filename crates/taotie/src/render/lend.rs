//! Scenes that are changed between pictures.

use crate::scene::Scene;
use std::sync::Arc;

/// Lends `scene` to work that shares it, such as a [`Renderer`](super::Renderer), and takes it back when the work is
/// done. It is copied only where the work still shares it then. While it is lent, and should the work panic, `scene` is
/// empty.
pub fn lend<T>(scene: &mut Scene, work: impl FnOnce(&Arc<Scene>) -> T) -> T {
    let shared = Arc::new(std::mem::take(scene));
    let done = work(&shared);
    *scene = Arc::unwrap_or_clone(shared);
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn what_is_lent_comes_back_as_it_was() {
        let mut scene = Scene { meshes: vec![Mesh::sphere(1.0, 8, 4)], ..Scene::default() };
        let place = scene.meshes.as_ptr();
        assert_eq!(lend(&mut scene, |scene| scene.clone().meshes.len()), 1);
        assert_eq!(scene.meshes.as_ptr(), place, "it was copied");
        let kept = lend(&mut scene, Arc::clone);
        assert_eq!((kept.meshes.len(), scene.meshes.len()), (1, 1));
    }
}
