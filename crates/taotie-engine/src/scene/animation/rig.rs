//! The rig of a scene: the parts attached to each node, and their poses at moments of an animation.

use super::{Animation, Node, Path, Transform, world_matrices};
use crate::error::{Error, Result, Warnings};
use crate::math::{Mat4, Vec3};
use crate::mesh::deform::Deformable;
use crate::mesh::{self, Mesh};
use crate::parallel;
use crate::scene::{Scene, rigid};

/// The parts of a [`Rig`], before validation.
#[derive(Debug, Clone, Default)]
pub struct RigData {
    /// The hierarchy at rest.
    pub nodes: Vec<Node>,
    /// The skins.
    pub skins: Vec<Skin>,
    /// The meshes of the scene that morph targets or skins deform.
    pub deformed: Vec<Deformed>,
    /// The node to which each of the scene's instances is attached; `None` for static ones. A skin positions its mesh
    /// on its own, so such an instance is static too.
    pub instances: Vec<Option<usize>>,
    /// The node of each of the scene's cameras.
    pub cameras: Vec<usize>,
    /// The node of each of the scene's lights.
    pub lights: Vec<usize>,
    /// The animations.
    pub animations: Vec<Animation>,
}

/// Joints that deform a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skin {
    /// The nodes of its joints.
    pub joints: Vec<usize>,
    /// The matrix of each joint from the mesh's space at bind time to the joint's.
    pub inverse_bind_matrices: Vec<Mat4>,
}

impl Skin {
    /// The matrix of each joint from the mesh's space at bind time to world space.
    pub fn joint_matrices(&self, world: &[Mat4]) -> Vec<Mat4> {
        let pairs = self.joints.iter().zip(&self.inverse_bind_matrices);
        pairs.map(|(joint, inverse_bind)| world[*joint] * *inverse_bind).collect()
    }
}

/// A deformed mesh of the scene.
#[derive(Debug, Clone)]
pub struct Deformed {
    /// The mesh, by its index in the scene.
    pub mesh: usize,
    /// The node whose weights morph it.
    pub node: usize,
    /// The skin, if its shape has a binding.
    pub skin: Option<usize>,
    /// The shape from which it is made.
    pub shape: Deformable,
}

/// The data that animates a scene: every index in it is in range.
///
/// It is not used for an image of the scene at rest.
#[derive(Debug, Clone, Default)]
pub struct Rig {
    data: RigData,
}

impl Rig {
    /// Validates `data`.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming what does not exist, does not fit or forms a cycle.
    pub fn new(data: RigData) -> Result<Self> {
        world_matrices(&data.nodes)?;
        let nodes = data.nodes.len();
        for (i, skin) in data.skins.iter().enumerate() {
            let at = format!("skin {i}");
            if skin.joints.len() != skin.inverse_bind_matrices.len() {
                return Err(Error::invalid(at, "it needs one inverse bind matrix per joint"));
            }
            skin.joints.iter().try_for_each(|joint| in_range(&at, "node", *joint, nodes))?;
        }
        for deformed in &data.deformed {
            deformed.check(&data)?;
        }
        let hung = data.instances.iter().flatten().chain(&data.cameras).chain(&data.lights);
        hung.into_iter().try_for_each(|node| in_range("scene", "node", *node, nodes))?;
        for animation in &data.animations {
            for channel in &animation.channels {
                animation.check_channel(channel, &data.nodes).map_err(|why| {
                    Error::invalid(format!("a channel of animation '{}'", animation.name), why)
                })?;
            }
        }
        Ok(Self { data })
    }

    /// Returns the animations.
    pub fn animations(&self) -> &[Animation] {
        &self.data.animations
    }

    /// Returns the data of the rig.
    pub fn data(&self) -> &RigData {
        &self.data
    }

    /// Returns the parts, to change and validate them again.
    pub fn into_data(self) -> RigData {
        self.data
    }

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

impl Deformed {
    fn check(&self, data: &RigData) -> Result<()> {
        let at = format!("deformed mesh {}", self.mesh);
        in_range(&at, "node", self.node, data.nodes.len())?;
        self.shape.check()?;
        match (self.skin, &self.shape.binding) {
            (Some(skin), Some(_)) => in_range(&at, "skin", skin, data.skins.len()),
            (None, None) => Ok(()),
            _ => Err(Error::invalid(at, "it needs both a skin and joint weights, or neither")),
        }
    }
}

fn in_range(at: &str, what: &str, index: usize, count: usize) -> Result<()> {
    match index < count {
        true => Ok(()),
        false => Err(Error::invalid(at, format!("it refers to {what} {index}, but there are {count}"))),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;
    use crate::mesh::deform::Binding;
    use crate::scene::animation::Channel;

    /// One node, one skin with one joint, and a triangle that it moves.
    fn sound() -> RigData {
        let base = MeshData {
            positions: vec![Vec3::splat(1.0); 3],
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        };
        let binding = Some(Binding { per_vertex: 1, joints: vec![0; 3], weights: vec![1.0; 3] });
        let shape = Deformable { base, binding, ..Deformable::default() };
        RigData {
            nodes: vec![Node::default()],
            skins: vec![Skin { joints: vec![0], inverse_bind_matrices: vec![Mat4::IDENTITY] }],
            deformed: vec![Deformed { mesh: 0, node: 0, skin: Some(0), shape }],
            ..RigData::default()
        }
    }

    fn why(change: impl FnOnce(&mut RigData)) -> String {
        let mut data = sound();
        change(&mut data);
        Rig::new(data).unwrap_err().to_string()
    }

    #[test]
    fn what_does_not_exist_or_fit_is_refused() {
        assert!(Rig::new(sound()).is_ok());
        assert!(why(|rig| rig.nodes[0].parent = Some(0)).contains("ancestor"));
        assert!(why(|rig| rig.skins[0].joints[0] = 4).contains("node 4"));
        assert!(why(|rig| rig.skins[0].inverse_bind_matrices.clear()).contains("inverse bind matrix"));
        assert!(why(|rig| rig.deformed[0].node = 1).contains("node 1, but there are 1"));
        assert!(why(|rig| rig.deformed[0].skin = Some(3)).contains("skin 3"));
        assert!(why(|rig| rig.deformed[0].skin = None).contains("both a skin"));
        assert!(why(|rig| rig.deformed[0].shape.base.triangles[0][1] = 9).contains("vertex 9"));
        assert!(why(|rig| rig.instances.push(Some(2))).contains("node 2"));
        assert!(why(|rig| rig.lights.push(1)).contains("node 1"));
        let channel = Channel { node: 0, path: Path::Scale, sampler: 0 };
        let animation = Animation { name: "odd".into(), channels: vec![channel], ..Animation::default() };
        assert!(why(|rig| rig.animations.push(animation)).contains("animation 'odd'"));
    }
}
