//! Animations: channels and keyframes, each checked separately.

use super::accessor::Accessor;
use super::document::Document;
use crate::reading::{Reason, no_such};
use gltf::json::animation::{Interpolation as JsonInterpolation, Property};
use gltf::json::validation::Checked;
use gltf::json::{self, Value};
use std::collections::{HashMap, HashSet};
use taotie_engine::error::Warnings;
use taotie_engine::scene::animation::{Animation, Channel, Interpolation, Node, Path, Sampler};

/// Maximum number of values in all keyframes together, per byte of the buffers, plus a constant for small files.
/// Sharing keyframes between channels is common; a small file that requests gigabytes is not.
const MAX_NUMBERS_PER_BYTE: usize = 8;
const MAX_NUMBERS_OF_SMALL: usize = 1 << 22;

/// Returns the animations of the file. `nodes` have their morph weights. A channel that cannot be used is skipped
/// with a warning; an animation without any is kept, so that it can be chosen.
pub(super) fn read(document: &Document, nodes: &[Node], warnings: &mut Warnings) -> Vec<Animation> {
    let mut budget = MAX_NUMBERS_OF_SMALL + MAX_NUMBERS_PER_BYTE * document.total_bytes();
    let mut animations = Vec::new();
    for (i, json) in document.animations.iter().enumerate() {
        let name = json.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        let animation = Animation { name, ..Animation::default() };
        let mut reader = AnimationReader {
            document,
            nodes,
            json,
            budget,
            animation,
            samplers: HashMap::new(),
            seen: HashSet::new(),
        };
        let (mut left_out, mut first_reason) = (0, None);
        for channel in json.get("channels").and_then(Value::as_array).into_iter().flatten() {
            if let Err(why) = reader.channel(channel) {
                left_out += 1;
                first_reason.get_or_insert(why);
            }
        }
        if let Some(why) = first_reason {
            warnings.note(format!("animation {i}: skipped channels, the first because: {why}"), left_out);
        }
        budget = reader.budget;
        animations.push(reader.animation);
    }
    animations
}

/// Reads the channels of one animation.
struct AnimationReader<'a> {
    document: &'a Document,
    nodes: &'a [Node],
    json: &'a Value,
    budget: usize,
    animation: Animation,
    /// Maps the file's samplers to those of `animation`.
    samplers: HashMap<usize, usize>,
    seen: HashSet<(usize, Path)>,
}

impl AnimationReader<'_> {
    fn channel(&mut self, json: &Value) -> Reason<()> {
        let path = json.get("target").and_then(|target| target.get("path")).and_then(Value::as_str);
        if path == Some("pointer") {
            return Err("KHR_animation_pointer is not supported".into());
        }
        let channel: json::animation::Channel =
            json::deserialize::from_value(json.clone()).map_err(|e| malformed("channel", &e))?;
        let Checked::Valid(property) = channel.target.path else {
            return Err(format!("unknown path '{}'", path.unwrap_or_default()));
        };
        let path = match property {
            Property::Translation => Path::Translation,
            Property::Rotation => Path::Rotation,
            Property::Scale => Path::Scale,
            Property::MorphTargetWeights => Path::Weights,
        };
        let node = channel.target.node.value();
        let sampler = self.sampler(channel.sampler.value())?;
        let channel = Channel { node, path, sampler };
        self.animation.check_channel(&channel, self.nodes)?;
        if !self.seen.insert((node, path)) {
            return Err("an earlier channel has the same target".into());
        }
        self.animation.channels.push(channel);
        Ok(())
    }

    /// Returns the index in `animation` of a sampler of the file.
    fn sampler(&mut self, index: usize) -> Reason<usize> {
        if let Some(known) = self.samplers.get(&index) {
            return Ok(*known);
        }
        let json = self.json.get("samplers").and_then(|samplers| samplers.get(index));
        let json = json.ok_or_else(|| no_such("sampler", index))?.clone();
        let json = json::deserialize::from_value(json).map_err(|e| malformed("sampler", &e))?;
        let sampler = self.keyframes(&json).map_err(|why| format!("sampler {index}: {why}"))?;
        self.animation.samplers.push(sampler);
        self.samplers.insert(index, self.animation.samplers.len() - 1);
        Ok(self.animation.samplers.len() - 1)
    }

    fn keyframes(&mut self, json: &json::animation::Sampler) -> Reason<Sampler> {
        let interpolation = match json.interpolation {
            Checked::Valid(JsonInterpolation::Step) => Interpolation::Step,
            Checked::Valid(JsonInterpolation::Linear) => Interpolation::Linear,
            Checked::Valid(JsonInterpolation::CubicSpline) => Interpolation::CubicSpline,
            Checked::Invalid => return Err("unknown interpolation".into()),
        };
        let input = Accessor::open(self.document, json.input.value())?;
        if input.width != 1 {
            return Err("times must be scalars".into());
        }
        let output = Accessor::open(self.document, json.output.value())?;
        let numbers = output.count.saturating_mul(output.width).saturating_add(input.count);
        self.budget =
            self.budget.checked_sub(numbers).ok_or("too many keyframes for the size of the file")?;
        let times = (0..input.count).map(|i| input.floats::<1>(i)[0]).collect();
        let element = |i| output.floats::<16>(i).into_iter().take(output.width);
        let values = (0..output.count).flat_map(element).collect();
        Sampler::new(interpolation, times, values).map_err(|error| error.to_string())
    }
}

fn malformed(what: &str, error: &json::Error) -> String {
    format!("malformed {what}: {error}")
}
