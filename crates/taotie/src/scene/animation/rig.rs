//! Which parts of a scene hang on which node.

use super::{Animation, Node, world_matrices};
use crate::error::{Error, Result};
use crate::math::Mat4;
use crate::mesh::deform::Deformable;

/// The parts of a [`Rig`], before they are checked.
#[derive(Debug, Clone, Default)]
pub struct RigData {
    /// The hierarchy at rest.
    pub nodes: Vec<Node>,
    /// The skins.
    pub skins: Vec<Skin>,
    /// The meshes of the scene that morph targets or skins deform.
    pub deformed: Vec<Deformed>,
    /// The node that each of the scene's instances hangs on; `None` for one that stands still. A skin places its mesh
    /// by itself, so such an instance stands still too.
    pub instances: Vec<Option<usize>>,
    /// The node of each of the scene's cameras.
    pub cameras: Vec<usize>,
    /// The node of each of the scene's lights.
    pub lights: Vec<usize>,
    /// The motions.
    pub animations: Vec<Animation>,
}

/// Joints that move a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skin {
    /// The nodes that are its joints.
    pub joints: Vec<usize>,
    /// For each joint, what takes the mesh's space at bind time to the joint's.
    pub inverse_bind_matrices: Vec<Mat4>,
}

impl Skin {
    /// For each joint, what takes the mesh's space at bind time to the world.
    pub fn joint_matrices(&self, world: &[Mat4]) -> Vec<Mat4> {
        let pairs = self.joints.iter().zip(&self.inverse_bind_matrices);
        pairs.map(|(joint, inverse_bind)| world[*joint] * *inverse_bind).collect()
    }
}

/// A mesh of the scene that is deformed.
#[derive(Debug, Clone)]
pub struct Deformed {
    /// Which of the scene's meshes.
    pub mesh: usize,
    /// The node whose weights morph it.
    pub node: usize,
    /// The skin, where its shape has a binding.
    pub skin: Option<usize>,
    /// What it is made from.
    pub shape: Deformable,
}

/// What lets a scene move: every number in it is in range.
///
/// Nothing in it is read for a picture of the scene at rest.
#[derive(Debug, Clone, Default)]
pub struct Rig {
    data: RigData,
}

impl Rig {
    /// Checks `data`.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming what does not exist, does not fit or goes in a circle.
    pub fn new(data: RigData) -> Result<Self> {
        world_matrices(&data.nodes)?;
        let nodes = data.nodes.len();
        for (i, skin) in data.skins.iter().enumerate() {
            let at = format!("skin {i}");
            if skin.joints.len() != skin.inverse_bind_matrices.len() {
                return Err(Error::invalid(at, "it needs one inverse bind matrix a joint"));
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

    /// The motions.
    pub fn animations(&self) -> &[Animation] {
        &self.data.animations
    }

    /// What the rig is made of.
    pub fn data(&self) -> &RigData {
        &self.data
    }

    /// Gives the parts back, to change them and check them again.
    pub fn into_data(self) -> RigData {
        self.data
    }
}

impl Deformed {
    fn check(&self, data: &RigData) -> Result<()> {
        let at = format!("deformed mesh {}", self.mesh);
        in_range(&at, "node", self.node, data.nodes.len())?;
        match (self.skin, &self.shape.binding) {
            (Some(skin), Some(_)) => in_range(&at, "skin", skin, data.skins.len()),
            (None, None) => Ok(()),
            _ => Err(Error::invalid(at, "skin and joint weights come together or not at all")),
        }
    }
}

fn in_range(at: &str, what: &str, index: usize, count: usize) -> Result<()> {
    match index < count {
        true => Ok(()),
        false => Err(Error::invalid(at, format!("it names {what} {index}, but there are {count}"))),
    }
}
