//! A vessel at different moments of pouring.

use super::rig::{CUP, PIVOT, rig};
use taotie_engine::math::Mat4;
use taotie_engine::render::{SurfaceSettings, bind_tangents};
use taotie_engine::scene::Scene;
use taotie_engine::scene::animation::Rig;
use taotie_engine::{Error, Result, Warnings};

/// A vessel that can be posed at any moment of pouring.
pub struct Pouring {
    scene: Scene,
    rig: Rig,
}

impl Pouring {
    /// Creates a pouring vessel from a scene made by [`crate::jue::scene`]. Tangents are bound to the mesh if its
    /// normal map needs them.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the scene has no mesh, or tangents cannot be computed for its mesh.
    pub fn new(mut scene: Scene) -> Result<Self> {
        let no_mesh = || Error::invalid("a pouring vessel", "the scene has no mesh");
        let rig = rig(scene.meshes().first().ok_or_else(no_mesh)?);
        let settings = SurfaceSettings::default();
        let (rig, _) = bind_tangents(&mut scene, rig, &settings, &mut Warnings::default())?;
        Ok(Self { scene, rig })
    }

    /// Poses the vessel at a moment.
    ///
    /// # Errors
    /// None unless the time is NaN.
    pub fn at(&mut self, seconds: f64) -> Result<&Scene> {
        self.rig.pose(&mut self.scene, 0, seconds)?;
        Ok(&self.scene)
    }

    /// Returns the transform of the cup relative to its upright position.
    pub(super) fn motion(&self, seconds: f64) -> Result<Mat4> {
        Ok(self.rig.world_matrices(0, seconds)?[CUP] * Mat4::translation(-PIVOT))
    }
}

#[cfg(test)]
mod tests {
    use super::super::rig::{POURED, TIP_DEG, follows};
    use super::*;
    use crate::jue::{low_mesh, scene};
    use taotie_engine::math::scalar;

    #[test]
    fn feet_are_fixed_and_the_cup_turns_as_a_whole() {
        let mut vessel = Pouring::new(scene(16)).unwrap();
        let motion = vessel.motion(POURED).unwrap();
        let (rest, poured) = (low_mesh(), vessel.at(POURED).unwrap().meshes()[0].clone());
        assert_eq!(poured.triangles().len(), rest.triangles().len());
        let (mut feet, mut cup, mut between) = (0, 0, 0);
        for triangle in 0..rest.triangles().len() {
            for (p, q) in rest.corners(triangle).into_iter().zip(poured.corners(triangle)) {
                let turned = motion.transform_point(p.to_f64()).to_f32();
                match follows(p) {
                    0.0 => {
                        feet += 1;
                        assert_eq!(p, q);
                    }
                    1.0 => {
                        cup += 1;
                        assert!((q - turned).length() < 1e-7);
                    }
                    _ => {
                        between += 1;
                        assert!((q - p).length() < (turned - p).length() + 1e-7);
                    }
                }
            }
        }
        assert!(feet > 5 && cup > 500 && between > 100, "{feet} {cup} {between}");
    }

    #[test]
    fn it_tips_by_45_degrees_and_comes_back() {
        let vessel = Pouring::new(scene(16)).unwrap();
        let tipped = |seconds: f64| {
            let m = vessel.motion(seconds).unwrap();
            let cosine = (m.axis(0).x + m.axis(1).y + m.axis(2).z - 1.0) / 2.0;
            scalar::acos(cosine.clamp(-1.0, 1.0)).to_degrees()
        };
        assert!(tipped(0.0) < 1e-6 && tipped(2.0 * POURED) < 1e-6);
        assert!((tipped(POURED) - TIP_DEG).abs() < 1e-4, "{}", tipped(POURED));
        assert!((tipped(POURED / 2.0) - TIP_DEG / 2.0).abs() < 1e-4, "half way at half the time");
    }
}
