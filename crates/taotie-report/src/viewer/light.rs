//! The lighting of the page: lights in the form that shaders read, and an environment.

use super::blob::Blob;
use super::halves::coded;
use serde::Serialize;
use taotie_engine::Warnings;
use taotie_engine::pixel::LightSource;
use taotie_engine::render::{EnvironmentLight, Lighting};
use taotie_shader::{EnvironmentAtlas, MOST_LIGHTS, light_numbers};

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
