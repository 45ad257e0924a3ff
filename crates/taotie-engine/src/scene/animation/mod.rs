//! Animation: nodes, skins and morph weights driven by keyframes, in the terms of glTF 2.0.

mod rig;
mod sampler;

pub use rig::{Deformed, Rig, RigData, Skin};
pub use sampler::{Interpolation, Sampler, Tolerance};

use crate::error::{self, Error};
use crate::math::{Mat4, Vec3};
use sampler::unit_quaternion;

/// An animation: keyframes for the properties of nodes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Animation {
    /// Its name; may be empty.
    pub name: String,
    /// The animated properties.
    pub channels: Vec<Channel>,
    /// The keyframes.
    pub samplers: Vec<Sampler>,
}

/// The target to which a sampler's values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Channel {
    /// The animated node, by index.
    pub node: usize,
    /// The property of the node.
    pub path: Path,
    /// The keyframes, as an index into [`Animation::samplers`].
    pub sampler: usize,
}

/// A property of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Path {
    /// Its position: three numbers, model units.
    Translation,
    /// Its rotation: a quaternion (x, y, z, w).
    Rotation,
    /// Its scale: a factor per axis.
    Scale,
    /// The weights of its morph targets: one number per target.
    Weights,
}

impl Animation {
    /// Returns the time of the last keyframe that a channel uses, in seconds; 0 without one.
    pub fn seconds(&self) -> f64 {
        let samplers = self.channels.iter().filter_map(|channel| self.samplers.get(channel.sampler));
        let ends = samplers.filter_map(|sampler| sampler.times().last());
        ends.fold(0.0, |longest, end| f64::from(*end).max(longest))
    }

    /// Checks that `channel` can be applied to `nodes`.
    ///
    /// # Errors
    /// A message that states the fault: a node or sampler that does not exist, values of the wrong width, or a node
    /// that cannot be animated this way.
    pub fn check_channel(&self, channel: &Channel, nodes: &[Node]) -> Result<(), String> {
        let sampler = self.samplers.get(channel.sampler).ok_or("its sampler does not exist")?;
        let node = nodes.get(channel.node).ok_or("its node does not exist")?;
        let wanted = match channel.path {
            Path::Weights if node.weights.is_empty() => return Err("its node has no morph targets".into()),
            Path::Weights => node.weights.len(),
            _ if matches!(node.local, Transform::Matrix(_)) => {
                return Err("its node has a matrix, which cannot be animated".into());
            }
            Path::Rotation => 4,
            Path::Translation | Path::Scale => 3,
        };
        match sampler.width() {
            width if width == wanted => Ok(()),
            width => Err(format!("its values have {width} components, expected {wanted}")),
        }
    }
}

/// The position, rotation and scale of a node relative to its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Transform {
    /// Scaled, then rotated, then translated; these parts can be animated.
    Parts {
        /// Model units.
        translation: Vec3<f64>,
        /// A unit quaternion (x, y, z, w).
        rotation: [f64; 4],
        /// A factor per axis.
        scale: Vec3<f64>,
    },
    /// Any affine transform; it cannot be animated.
    Matrix(Mat4),
}

impl Default for Transform {
    fn default() -> Self {
        Self::parts(Vec3::splat(0.0), [0.0, 0.0, 0.0, 1.0], Vec3::splat(1.0))
    }
}

impl Transform {
    /// Makes a transform from its parts, normalising the quaternion.
    pub fn parts(translation: Vec3<f64>, rotation: [f64; 4], scale: Vec3<f64>) -> Self {
        Self::Parts { translation, rotation: unit_quaternion(rotation), scale }
    }

    /// Returns the matrix from the node's space to its parent's.
    pub fn matrix(&self) -> Mat4 {
        match self {
            Self::Parts { translation, rotation, scale } => {
                Mat4::translation(*translation) * Mat4::rotation(*rotation) * Mat4::scale(*scale)
            }
            Self::Matrix(matrix) => *matrix,
        }
    }
}

/// A node in a hierarchy, at rest.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Node {
    /// The parent node, by index.
    pub parent: Option<usize>,
    /// Its transform relative to the parent.
    pub local: Transform,
    /// The weights of the morph targets of its mesh, one per target.
    pub weights: Vec<f32>,
}

/// Returns the matrix from each node's space to world space.
///
/// # Errors
/// [`Error::Invalid`] naming a node that is its own ancestor, or whose parent does not exist.
pub fn world_matrices(nodes: &[Node]) -> error::Result<Vec<Mat4>> {
    let mut world: Vec<Option<Mat4>> = vec![None; nodes.len()];
    let mut waiting = Vec::new();
    for start in 0..nodes.len() {
        // Up to a known node or a root, then down again; a path longer than the number of nodes is a cycle.
        let mut above = Some(start);
        while let Some(node) = above.filter(|node| world.get(*node).is_none_or(Option::is_none)) {
            check_place(nodes, node, start, waiting.len())?;
            waiting.push(node);
            above = nodes[node].parent;
        }
        let mut parent = above.and_then(|node| world[node]).unwrap_or_default();
        while let Some(node) = waiting.pop() {
            parent = parent * nodes[node].local.matrix();
            world[node] = Some(parent);
        }
    }
    Ok(world.into_iter().map(Option::unwrap_or_default).collect())
}

fn check_place(nodes: &[Node], node: usize, start: usize, depth: usize) -> error::Result<()> {
    let wrong = |why: String| Err(Error::invalid(format!("node {start}"), why));
    if node >= nodes.len() {
        return wrong(format!("its parent is node {node}, but there are {}", nodes.len()));
    }
    if depth >= nodes.len() {
        return wrong("it is its own ancestor; nodes must form trees".into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn animation() -> Animation {
        let sampler = |times: &[f32], width: usize| {
            Sampler::new(Interpolation::Linear, times.to_vec(), vec![0.5; times.len() * width]).unwrap()
        };
        let channel = |sampler| Channel { node: 0, path: Path::Scale, sampler };
        Animation {
            samplers: vec![sampler(&[1.0, 4.0], 3), sampler(&[0.0, 2.0, 3.0], 3), sampler(&[9.0], 4)],
            channels: vec![channel(0), channel(1)],
            ..Animation::default()
        }
    }

    #[test]
    fn an_animation_lasts_as_long_as_its_channels() {
        assert_eq!(animation().seconds(), 4.0);
        assert_eq!(Animation::default().seconds(), 0.0);
    }

    #[test]
    fn channels_are_checked() {
        let matrix = Node { local: Transform::Matrix(Mat4::IDENTITY), ..Node::default() };
        let nodes = [Node::default(), Node { weights: vec![0.0; 3], ..matrix }];
        let check = |node, path, sampler| animation().check_channel(&Channel { node, path, sampler }, &nodes);
        assert_eq!(check(0, Path::Scale, 0), Ok(()));
        assert_eq!(check(0, Path::Rotation, 2), Ok(()));
        assert_eq!(check(1, Path::Weights, 0), Ok(()));
        let why = |node, path, sampler| check(node, path, sampler).unwrap_err();
        assert!(why(0, Path::Rotation, 0).contains("3 components, expected 4"));
        assert!(why(0, Path::Weights, 0).contains("no morph targets"));
        assert!(why(1, Path::Translation, 0).contains("matrix"));
        assert!(why(2, Path::Scale, 0).contains("node") && why(0, Path::Scale, 3).contains("sampler"));
    }

    fn node(parent: Option<usize>, x: f64) -> Node {
        let local = Transform::parts(Vec3::new(x, 0.0, 0.0), [0.0, 0.0, 3.0, 3.0], Vec3::splat(2.0));
        Node { parent, local, ..Node::default() }
    }

    #[test]
    fn children_follow_parents_in_whatever_order() {
        let nodes = [node(Some(2), 1.0), node(Some(0), 1.0), node(None, 1.0)];
        let world = world_matrices(&nodes).unwrap();
        let at = |i: usize| world[i].axis(3);
        // Each level turns by 90° about z and doubles: (1, 0, 0), then (1, 2, 0), then (1 − 4, 2, 0).
        let expected = [[1.0, 2.0, 0.0], [-3.0, 2.0, 0.0], [1.0, 0.0, 0.0]];
        for (i, p) in expected.into_iter().enumerate() {
            assert!((at(i) - Vec3::from_array(p)).length() < 1e-12, "{i}: {:?}", at(i));
        }
    }

    #[test]
    fn circles_and_missing_parents_are_refused() {
        let why = |nodes: &[Node]| world_matrices(nodes).unwrap_err().to_string();
        assert!(why(&[node(None, 0.0), node(Some(2), 0.0), node(Some(1), 0.0)]).contains("node 1"));
        assert!(why(&[node(Some(0), 0.0)]).contains("ancestor"));
        assert!(why(&[node(Some(7), 0.0)]).contains("node 7, but there are 1"));
    }

    #[test]
    fn a_long_chain_needs_no_stack() {
        let nodes: Vec<Node> = (0..200_000)
            .map(|i| Node { parent: (i < 199_999).then_some(i + 1), ..Node::default() })
            .collect();
        assert_eq!(world_matrices(&nodes).unwrap()[0], Mat4::IDENTITY);
    }
}
