//! Bounding boxes, and a scene's outermost triangles, found by boxes around neighbours.

use super::Scene;
use super::camera::{Frame, Orbit};
use crate::math::Vec3;
use crate::parallel;
use std::ops::Range;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner of minimum coordinates.
    pub min: Vec3<f64>,
    /// The corner of maximum coordinates.
    pub max: Vec3<f64>,
}

impl Bounds {
    /// Returns the centre.
    pub fn center(&self) -> Vec3<f64> {
        (self.min + self.max) * 0.5
    }

    /// Returns the smallest box around both.
    pub fn united(&self, other: &Self) -> Self {
        let lower =
            Vec3::new(self.min.x.min(other.min.x), self.min.y.min(other.min.y), self.min.z.min(other.min.z));
        let upper =
            Vec3::new(self.max.x.max(other.max.x), self.max.y.max(other.max.y), self.max.z.max(other.max.z));
        Self { min: lower, max: upper }
    }

    /// Returns the smallest box around all points; `None` if there are none.
    pub fn around(points: impl Iterator<Item = Vec3<f64>>) -> Option<Self> {
        points.map(|point| Self { min: point, max: point }).reduce(|all, point| all.united(&point))
    }

    /// Returns the eight corners.
    pub fn corners(&self) -> [Vec3<f64>; 8] {
        let Self { min, max } = *self;
        std::array::from_fn(|i| {
            let pick = |axis: usize, low: f64, high: f64| if i >> axis & 1 == 0 { low } else { high };
            Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
        })
    }

    /// Returns the length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).length()
    }
}

/// Neighbouring triangles of one mesh that share a box.
const BLOCK: usize = 1024;

/// The relative amount that rounding may add to a box's required distance.
const ROUNDING: f64 = 1e-9;

/// A scene with boxes around neighbouring triangles, which answer queries about the outermost without visiting each.
pub struct Outline<'s> {
    scene: &'s Scene,
    blocks: Vec<Block>,
}

/// Neighbouring triangles of an instance, and the world-space box around their corners.
struct Block {
    instance: usize,
    triangles: Range<usize>,
    bounds: Bounds,
}

impl<'s> Outline<'s> {
    /// Makes the boxes. Each corner is visited once.
    pub fn new(scene: &'s Scene) -> Self {
        let ranges: Vec<(usize, Range<usize>)> = scene
            .instances()
            .iter()
            .enumerate()
            .flat_map(|(i, instance)| {
                let count = scene.meshes()[instance.mesh].triangles().len();
                (0..count).step_by(BLOCK).map(move |start| (i, start..count.min(start + BLOCK)))
            })
            .collect();
        let blocks = parallel::tasks(ranges.len(), &|i| {
            let (instance, triangles) = ranges[i].clone();
            let bounds = Bounds::around(corners(scene, instance, triangles.clone()))?;
            Some(Block { instance, triangles, bounds })
        });
        Self { scene, blocks: blocks.into_iter().flatten().collect() }
    }

    /// Returns the box around every triangle's corners, or `None` if there are no triangles.
    pub fn bounds(&self) -> Option<Bounds> {
        self.blocks.iter().map(|block| block.bounds).reduce(|all, block| all.united(&block))
    }

    /// Returns [`super::fitting_distance`] of every triangle's corners.
    pub fn fitting_distance(&self, orbit: &Orbit, aspect: f64, fill: f64) -> f64 {
        let frame = Frame::new(orbit, aspect, fill);
        // The required distance is convex: none within a box is above that of its corners.
        let need = |block: &Block| {
            block.bounds.corners().map(|corner| frame.need(corner)).into_iter().fold(0.0, f64::max)
        };
        let mut blocks: Vec<(f64, &Block)> =
            self.blocks.iter().map(|block| (need(block) * (1.0 + ROUNDING), block)).collect();
        blocks.sort_unstable_by(|(a, _), (b, _)| b.total_cmp(a));
        let mut distance = f64::MIN_POSITIVE;
        for (most, block) in blocks {
            if most < distance {
                break;
            }
            let corners = corners(self.scene, block.instance, block.triangles.clone());
            distance = corners.fold(distance, |distance, corner| distance.max(frame.need(corner)));
        }
        distance
    }
}

/// Returns the corners of some triangles of an instance, world space.
fn corners(scene: &Scene, instance: usize, triangles: Range<usize>) -> impl Iterator<Item = Vec3<f64>> + '_ {
    let instance = &scene.instances()[instance];
    let mesh = &scene.meshes()[instance.mesh];
    let indices = mesh.triangles()[triangles].as_flattened();
    indices
        .iter()
        .map(|index| instance.world_from_object.transform_point(mesh.positions()[*index as usize].to_f64()))
}

#[cfg(test)]
mod tests {
    use super::super::{Instance, Material, fitting_distance};
    use super::*;
    use crate::math::Mat4;
    use crate::mesh::Mesh;

    #[test]
    fn boxes_tell_what_all_corners_tell() {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 150, 70), Material::default()).unwrap();
        scene
            .edit(|scene| {
                let turned = Mat4::rotation_about(Vec3::new(0.6, 0.0, 0.8), 0.7);
                let world_from_object = Mat4::translation(Vec3::new(2.0, 0.3, -1.0)) * turned;
                scene.meshes.push(Mesh::sphere(0.5, 9, 5));
                scene.instances.push(Instance { mesh: 1, world_from_object, ..scene.instances[0] });
            })
            .unwrap();
        let outline = Outline::new(&scene);
        assert!(outline.blocks.len() > 10);
        assert_eq!(outline.bounds(), Bounds::around(scene.corners()));
        for step in 0..12 {
            let (azimuth, elevation) = (0.55 * f64::from(step), 0.3 * f64::from(step % 5) - 0.6);
            let target = Vec3::new(0.1 * f64::from(step), 0.2, -0.5);
            let orbit = Orbit { azimuth, elevation, distance: 0.0, target, fov_y: 0.5 };
            let expected = fitting_distance(&orbit, 1.3, 0.9, scene.corners());
            assert_eq!(outline.fitting_distance(&orbit, 1.3, 0.9), expected);
        }
    }

    #[test]
    fn nothing_has_no_outline() {
        let scene = Scene::default();
        let outline = Outline::new(&scene);
        let orbit =
            Orbit { azimuth: 0.0, elevation: 0.0, distance: 0.0, target: Vec3::default(), fov_y: 0.5 };
        assert!(outline.bounds().is_none());
        assert_eq!(outline.fitting_distance(&orbit, 1.0, 0.9), f64::MIN_POSITIVE);
    }
}
