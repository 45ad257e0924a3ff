//! Animation: nodes, skins and morph weights driven by keyframes, in the terms of glTF 2.0.

mod node;
mod pose;
mod rig;
mod sampler;

pub use node::{Node, Transform, world_matrices};
pub use rig::{Deformed, Rig, RigData, Skin};
pub use sampler::{Interpolation, Sampler};

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Mat4;

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
}
