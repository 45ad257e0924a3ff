//! The lighting of the page: lights in the form that shaders read, and an environment as images of half floats.

use super::document::Blob;
use serde::Serialize;
use taotie_engine::Warnings;
use taotie_engine::pixel::LightSource;
use taotie_engine::render::{EnvironmentLight, Lighting};
use taotie_shader::{EnvironmentAtlas, MOST_LIGHTS, light_numbers};

/// The encoded channels of an image: green, and the differences of red and blue from it.
const CHANNELS: [fn([u16; 3]) -> u16; 3] =
    [|[_, g, _]| g, |[r, g, _]| r.wrapping_sub(g), |[_, g, b]| b.wrapping_sub(g)];

/// The lighting of the page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Light {
    /// Sixteen numbers per light.
    pub lights: Vec<[f32; 16]>,
    /// Ambient radiance.
    pub ambient: [f32; 3],
    environment: Option<EnvironmentMaps>,
}

/// An environment; its texels are in `environment_maps` and `environment_picture`.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct EnvironmentMaps {
    maps: [usize; 2],
    picture: [usize; 2],
    levels: Vec<[f32; 4]>,
    count: usize,
    smoothest_alpha: f32,
    /// Degrees, counter-clockwise as seen from above.
    rotation: f64,
    intensity: f32,
}

/// Returns the lighting as data, and the texels of its environment.
pub(super) fn light(lighting: &Lighting, warnings: &mut Warnings) -> (Light, Vec<Blob>) {
    let all = lighting.lights.len();
    warnings.note("skipped lights beyond the first 16", all.saturating_sub(MOST_LIGHTS));
    let lights = lighting.lights.iter().take(MOST_LIGHTS);
    let environment = lighting.environment.as_ref().map(environment);
    let (maps, blobs) = environment.map_or((None, Vec::new()), |(maps, blobs)| (Some(maps), blobs.into()));
    let light = Light {
        lights: lights.map(|light| light_numbers(&LightSource::new(light))).collect(),
        ambient: lighting.ambient.to_array(),
        environment: maps,
    };
    (light, blobs)
}

fn environment(light: &EnvironmentLight) -> (EnvironmentMaps, [Blob; 2]) {
    let maps = light.environment.maps();
    let atlas = EnvironmentAtlas::new(&maps);
    let described = EnvironmentMaps {
        maps: atlas.size,
        picture: [maps.picture.width, maps.picture.height],
        levels: atlas.table.to_vec(),
        count: maps.levels.len(),
        smoothest_alpha: maps.smoothest_alpha,
        rotation: light.rotation.to_degrees(),
        intensity: light.intensity,
    };
    let colors: Vec<[u16; 3]> = atlas.texels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let maps_blob = Blob::new("environment_maps", coded(&colors, atlas.size[0]));
    let picture = Blob::new("environment_picture", coded(maps.picture.texels, maps.picture.width));
    (described, [maps_blob, picture])
}

/// Losslessly encodes an image of half floats with `width` texels per row, as bytes that compress well. Each number
/// of a channel is stored as its difference from the prediction by its neighbours: left + above − above left, with 0
/// outside the image. All lower bytes come first, then all upper bytes.
fn coded(texels: &[[u16; 3]], width: usize) -> Vec<u8> {
    let codes: Vec<u16> = CHANNELS.iter().flat_map(|channel| differences(texels, width, channel)).collect();
    let [lower, upper] = [0, 1].map(|byte| codes.iter().map(move |code| code.to_le_bytes()[byte]));
    lower.chain(upper).collect()
}

fn differences(
    texels: &[[u16; 3]],
    width: usize,
    channel: impl Fn([u16; 3]) -> u16,
) -> impl Iterator<Item = u16> {
    let numbers: Vec<u16> = texels.iter().map(|texel| channel(*texel)).collect();
    let at = move |x: usize, y: usize| match (x, y) {
        (0, _) | (_, 0) => 0,
        (x, y) => numbers[(y - 1) * width + x - 1],
    };
    (0..texels.len()).map(move |i| {
        let (x, y) = (i % width + 1, i / width + 1);
        let expected = at(x - 1, y).wrapping_add(at(x, y - 1)).wrapping_sub(at(x - 1, y - 1));
        folded(at(x, y).wrapping_sub(expected))
    })
}

/// Maps small differences of either sign to small numbers: 0, −1, 1, −2 become 0, 1, 2, 3.
fn folded(difference: u16) -> u16 {
    let signed = difference as i16;
    ((signed << 1) ^ (signed >> 15)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_predicted() {
        let texels: Vec<[u16; 3]> = (0..12u16).map(|i| [100 + i % 4 + 3 * (i / 4); 3]).collect();
        let codes = coded(&texels, 4);
        assert_eq!(codes.len(), 72);
        // The first row and column contain the start and the slope.
        assert_eq!(codes[..12], [200, 2, 2, 2, 6, 0, 0, 0, 6, 0, 0, 0]);
        assert!(codes[12..].iter().all(|code| *code == 0), "red and blue equal green");
    }

    #[test]
    fn differences_of_either_sign_are_small() {
        assert_eq!([0u16, u16::MAX, 1, u16::MAX - 1, 0x8000].map(folded), [0, 1, 2, 3, u16::MAX]);
    }
}
