//! A scene at a moment of an animation.

use super::{Animation, Deformed, Node, Path, Rig, Transform, world_matrices};
use crate::error::{Error, Result, Warnings};
use crate::math::{Mat4, Vec3};
use crate::mesh::{self, Mesh};
use crate::parallel;
use crate::scene::{Scene, rigid};

impl Rig {
    /// Poses `scene` at the moment `seconds` of an animation, by index; a time outside its keyframes is clamped.
    /// Nodes that the animation does not move are at rest, whatever the earlier pose of the scene.
    ///
    /// Authored normals and tangents of a mesh are deformed with it. Without normals, those of the deformed faces are
    /// used. Missing tangents are made from the deformed mesh when it is drawn, unless `render::bind_tangents` gave
    /// it those of its authored shape, for which normal maps are baked.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no such animation, the scene is not the rig's, or a moved mesh exceeds the
    /// range of numbers; the scene is then unchanged.
    pub fn pose(&self, scene: &mut Scene, animation: usize, seconds: f64) -> Result<()> {
        self.place(scene, &self.posed(animation, seconds)?)
    }

    /// Returns the matrices from each node's space to world space at a moment, as [`Rig::pose`] understands it.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no such animation.
    pub fn world_matrices(&self, animation: usize, seconds: f64) -> Result<Vec<Mat4>> {
        world_matrices(&self.posed(animation, seconds)?)
    }

    fn posed(&self, animation: usize, seconds: f64) -> Result<Vec<Node>> {
        let animations = &self.data().animations;
        let animation = animations.get(animation).ok_or_else(|| {
            Error::invalid(format!("animation {animation}"), format!("there are {}", animations.len()))
        })?;
        Ok(posed(&self.data().nodes, animation, seconds))
    }

    /// Resets `scene` to rest, bit-exactly.
    ///
    /// # Errors
    /// As [`Rig::pose`].
    pub fn rest(&self, scene: &mut Scene) -> Result<()> {
        self.place(scene, &self.data().nodes)
    }

    fn place(&self, scene: &mut Scene, nodes: &[Node]) -> Result<()> {
        let (data, parts) = (self.data(), &mut scene.data);
        let fits = data.instances.len() == parts.instances.len()
            && data.cameras.len() == parts.cameras.len()
            && data.lights.len() == parts.lights.len()
            && data.deformed.iter().all(|deformed| deformed.mesh < parts.meshes.len());
        if !fits {
            return Err(Error::invalid("rig", "it belongs to another scene"));
        }
        let world = world_matrices(nodes)?;
        let deformed = |i: usize| self.mesh(&data.deformed[i], nodes, &world);
        let meshes = parallel::tasks(data.deformed.len(), &deformed);
        let meshes = meshes.into_iter().collect::<Result<Vec<Mesh>>>()?;
        for (deformed, mesh) in data.deformed.iter().zip(meshes) {
            parts.meshes[deformed.mesh] = mesh;
        }
        for (instance, node) in parts.instances.iter_mut().zip(&data.instances) {
            if let Some(node) = node {
                instance.world_from_object = world[*node];
            }
        }
        for (camera, node) in parts.cameras.iter_mut().zip(&data.cameras) {
            camera.world_from_view = rigid(&world[*node]);
        }
        for (light, node) in parts.lights.iter_mut().zip(&data.lights) {
            light.place(&world[*node]);
        }
        Ok(())
    }

    /// Makes the deformed mesh. Faults corrected at rest were reported then, and are now corrected silently.
    fn mesh(&self, deformed: &Deformed, nodes: &[Node], world: &[Mat4]) -> Result<Mesh> {
        let joints = deformed.skin.map(|skin| self.data().skins[skin].joint_matrices(world));
        let weights = &nodes[deformed.node].weights;
        let mut data = deformed.shape.deformed(weights, &joints.unwrap_or_default())?;
        mesh::repair(&mut data, &mut Warnings::default());
        Mesh::new(data)
    }
}

/// The nodes at a moment.
fn posed(rest: &[Node], animation: &Animation, seconds: f64) -> Vec<Node> {
    let mut nodes = rest.to_vec();
    for channel in &animation.channels {
        let (node, sampler) = (&mut nodes[channel.node], &animation.samplers[channel.sampler]);
        if channel.path == Path::Weights {
            node.weights = sampler.at(seconds).into_iter().map(|weight| weight as f32).collect();
        } else if let Transform::Parts { translation, rotation, scale } = &mut node.local {
            let vector = || {
                let value = sampler.at(seconds);
                Vec3::new(value[0], value[1], value[2])
            };
            match channel.path {
                Path::Translation => *translation = vector(),
                Path::Scale => *scale = vector(),
                _ => *rotation = sampler.rotation_at(seconds),
            }
        }
    }
    nodes
}
