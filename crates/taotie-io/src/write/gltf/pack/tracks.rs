//! The keyframes of animations: thinned, rounded, and each array stored once.

use super::super::draft::Component;
use super::super::edit;
use super::super::stream::{PowerOfTwo, Quaternions, Stream};
use crate::gltf::StoredTrack;
use serde_json::Value;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use taotie_engine::scene::animation::{Interpolation, Tolerance};

/// Dropped keyframes change a rotation by at most this many degrees. Rounding adds less than 0.01.
const DEGREES: f64 = 0.05;
/// Bits of quaternions.
const BITS_OF_ROTATIONS: u8 = 14;
/// Other values change by at most their range divided by this.
const STEPS: f64 = 20_000.0;
/// Rounding adds their range divided by two to this power.
const BITS_OF_OTHERS: u8 = 16;
/// A range counts as no less than the largest number divided by this.
const LEAST_RANGE: f64 = 8.0;

impl StoredTrack {
    /// Returns the time of the last keyframe, seconds.
    fn end(&self) -> f32 {
        self.keys.times().last().copied().unwrap_or(f32::NEG_INFINITY)
    }

    fn tolerance(&self) -> Tolerance {
        match self.is_rotation {
            true => Tolerance::Degrees(DEGREES),
            false => Tolerance::Numbers(self.range() / STEPS),
        }
    }

    /// Returns the largest difference between two values of a component.
    fn range(&self) -> f64 {
        let values = self.keys.values();
        let of_component = |k: usize| {
            let own = values.iter().skip(k).step_by(self.keys.width()).map(|v| f64::from(*v));
            own.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], v| [v.min(least), v.max(most)])
        };
        let ranges = (0..self.keys.width()).map(of_component).map(|[least, most]| most - least);
        let largest = values.iter().fold(0.0f64, |largest, v| largest.max(f64::from(*v).abs()));
        ranges.fold(largest / LEAST_RANGE, f64::max)
    }

    /// Returns the track without the keyframes that interpolation restores.
    fn thinned(self) -> Self {
        Self { keys: self.keys.thinned(self.tolerance()), ..self }
    }
}

/// Thins tracks and removes their times and values from a document, as well as channels that never change anything, except
/// for one by which an animation ends later than by the others.
pub(super) fn taken(json: &mut Value, tracks: Vec<StoredTrack>) -> Vec<StoredTrack> {
    let moved = moved_targets(json, &tracks);
    let ends: BTreeMap<[usize; 2], f32> = tracks.iter().map(|track| (track.place, track.end())).collect();
    let mut kept: BTreeMap<[usize; 2], StoredTrack> =
        tracks.into_iter().map(|track| (track.place, track.thinned())).collect();
    let mut renumbered = Vec::with_capacity(kept.len());
    for (a, animation) in edit::items_mut(json, "animations").enumerate() {
        let is_moved = |channel: &Value| target(channel).is_none_or(|target| moved.contains(&target));
        let channels = edit::taken(animation, "channels");
        let (mut channels, still): (Vec<Value>, Vec<Value>) = channels.into_iter().partition(is_moved);
        // Tracks that are not packed end at an unknown time, and stay.
        let end = |channel: &Value| ends.get(&[a, edit::number(channel, "sampler")?]).copied();
        let last = |of: &[Value]| of.iter().filter_map(end).fold(f32::NEG_INFINITY, f32::max);
        if channels.is_empty() || last(&still) > last(&channels) {
            channels.extend(
                still.into_iter().max_by(|x, y| end(x).partial_cmp(&end(y)).unwrap_or(Ordering::Equal)),
            );
        }
        let used: BTreeSet<usize> =
            channels.iter().filter_map(|channel| edit::number(channel, "sampler")).collect();
        let samplers = edit::taken(animation, "samplers").into_iter().enumerate();
        let mut left = Vec::with_capacity(used.len());
        let mut numbers = HashMap::new();
        for (old, mut sampler) in samplers.filter(|(s, _)| used.contains(s)) {
            numbers.insert(old, left.len());
            if let Some(track) = kept.remove(&[a, old]) {
                ["input", "output"].iter().for_each(|name| edit::remove(&mut sampler, name));
                renumbered.push(StoredTrack { place: [a, left.len()], ..track });
            }
            left.push(sampler);
        }
        for channel in &mut channels {
            let number = edit::number(channel, "sampler").and_then(|old| numbers.get(&old));
            number.into_iter().for_each(|new| channel["sampler"] = (*new).into());
        }
        animation["channels"] = Value::Array(channels);
        animation["samplers"] = Value::Array(left);
    }
    renumbered
}

/// The node of a channel, and the property of it.
type Target = (usize, String);

/// Returns the target of a channel; `None` if it is not a property of a node.
fn target(channel: &Value) -> Option<Target> {
    let target = channel.get("target")?;
    Some((edit::number(target, "node")?, target.get("path")?.as_str()?.to_owned()))
}

/// Returns the targets that some animation moves away from their value at rest.
fn moved_targets(json: &Value, tracks: &[StoredTrack]) -> BTreeSet<Target> {
    let tracks: BTreeMap<[usize; 2], &StoredTrack> =
        tracks.iter().map(|track| (track.place, track)).collect();
    let mut moved = BTreeSet::new();
    for (a, animation) in edit::items(json, "animations").iter().enumerate() {
        for channel in edit::items(animation, "channels") {
            let (Some(target), Some(s)) = (target(channel), edit::number(channel, "sampler")) else {
                continue;
            };
            let rest = rest(json, &target);
            let track = tracks
                .get(&[a, s])
                .filter(|track| rest.as_ref().is_some_and(|rest| rest.len() == track.keys.width()));
            let is_still = track
                .zip(rest.as_ref())
                .is_some_and(|(track, rest)| track.keys.stays_at(rest, track.tolerance()));
            if !is_still {
                moved.insert(target);
            }
        }
    }
    moved
}

/// Returns the value of a property in the document; `None` for weights.
fn rest(json: &Value, (node, path): &Target) -> Option<Vec<f64>> {
    let own = json.pointer(&format!("/nodes/{node}"))?;
    let default: &[f64] = match path.as_str() {
        "translation" => &[0.0; 3],
        "rotation" => &[0.0, 0.0, 0.0, 1.0],
        "scale" => &[1.0; 3],
        _ => return None,
    };
    match own.get(path) {
        Some(value) => value.as_array()?.iter().map(Value::as_f64).collect(),
        None => own.get("matrix").is_none().then(|| default.to_vec()),
    }
}

/// Returns times as stored.
fn times(track: &StoredTrack) -> Stream {
    let times = track.keys.times();
    let ends =
        [times.first(), times.last()].map(|end| end.map(|end| Value::from(*end)).into_iter().collect());
    Stream { bounds: Some(ends), ..exact(times, 1) }
}

/// Returns rounded values, or those of which a filter cannot represent one as they are.
fn values(track: &StoredTrack) -> Stream {
    let values = track.keys.values();
    let is_spline = track.keys.interpolation() == Interpolation::CubicSpline;
    if track.is_rotation && !is_spline {
        return Quaternions { bits: BITS_OF_ROTATIONS }.stream("", values);
    }
    let step = PowerOfTwo::within(track.range(), BITS_OF_OTHERS);
    step.stream("", values, track.width).unwrap_or_else(|| exact(values, track.width))
}

fn exact(values: &[f32], width: usize) -> Stream {
    Stream {
        name: String::new(),
        bytes: values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        stride: 4 * width,
        component: Component::F32,
        width,
        normalized: false,
        filter: None,
        bounds: None,
    }
}

/// The arrays of tracks, equal ones once.
pub(super) struct Arrays {
    pub streams: Vec<Stream>,
    /// The indices of each track's times and values among these.
    pub of_tracks: Vec<[usize; 2]>,
}

impl Arrays {
    pub fn of(tracks: &[StoredTrack]) -> Self {
        let (mut streams, mut known) = (Vec::new(), HashMap::new());
        let mut number = |stream: Stream| -> usize {
            let key = (stream.bytes.clone(), stream.width, stream.filter, stream.bounds.is_some());
            *known.entry(key).or_insert_with(|| {
                streams.push(stream);
                streams.len() - 1
            })
        };
        let of_tracks = tracks.iter().map(|track| [number(times(track)), number(values(track))]).collect();
        Self { streams, of_tracks }
    }
}
