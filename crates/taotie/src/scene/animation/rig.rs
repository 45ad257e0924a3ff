//! The rig of a scene: the parts attached to each node.

use super::{Animation, Node, world_matrices};
use crate::error::{Error, Result};
use crate::math::Mat4;
use crate::mesh::deform::Deformable;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::MeshData;
    use crate::mesh::deform::Binding;
    use crate::scene::animation::{Channel, Path};

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
