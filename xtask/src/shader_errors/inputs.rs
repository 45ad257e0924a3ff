//! The buffers and pictures that both graphics APIs bind.

use super::cases::Case;
use super::lighting::{self, Lighting};
use super::points::{OBJECT_NORMALS, Points, WIDTH};
use super::random::Random;
use taotie_engine::scene::{Material, TextureRole};
use taotie_engine::shade::dfg;
use taotie_engine::shade::environment::Environment;
use taotie_engine::surface::SurfaceMethod;
use taotie_shader::{EnvironmentAtlas, MOST_LIGHTS, light_numbers, opaque};

/// A picture of floats.
pub struct Picture {
    pub size: [usize; 2],
    pub texels: Vec<[f32; 4]>,
}

/// Points under a kind of light.
pub struct Draw {
    pub lighting: Lighting,
    pub points: Points,
}

/// The inputs of all measurements, independent of the surface.
pub struct Inputs {
    pub sky: Environment,
    pub draws: Vec<Draw>,
    pub albedo_tables: Picture,
    pub environment_maps: Picture,
    pub environment_picture: Picture,
    /// The table of the environment's levels.
    pub levels: Vec<[f32; 4]>,
}

/// Converts a half float that is neither negative nor infinite.
fn half(bits: u16) -> f32 {
    // 2¹¹²: the difference between the exponent biases.
    f32::from_bits(u32::from(bits) << 13) * f32::from_bits((112 + 127) << 23)
}

fn halves(size: [usize; 2], texels: impl Iterator<Item = [u16; 4]>) -> Picture {
    Picture { size, texels: texels.map(|texel| texel.map(half)).collect() }
}

impl Inputs {
    /// Creates `rows` rows of points under each kind of light.
    pub fn new(rows: usize) -> Self {
        let (sky, mut random) = (lighting::sky(), Random::new(17));
        let draws = lighting::kinds().map(|lighting| {
            let points = Points::new(rows, &lighting, &mut random);
            Draw { lighting, points }
        });
        let maps = sky.maps();
        let atlas = EnvironmentAtlas::new(&maps);
        let picture = maps.picture;
        let tables = dfg::tables();
        Self {
            draws: draws.into(),
            albedo_tables: Picture { size: [dfg::COLUMNS, tables.len() / dfg::COLUMNS], texels: tables },
            environment_maps: halves(atlas.size, atlas.texels.into_iter()),
            environment_picture: halves([picture.width, picture.height], picture.texels.iter().map(opaque)),
            levels: atlas.table.to_vec(),
            sky,
        }
    }

    /// Returns the number of points.
    pub fn points(&self) -> usize {
        self.draws.iter().map(|draw| draw.points.len()).sum()
    }

    /// Returns the factors of a surface under each kind of light, which differ between them.
    pub fn materials(&self, case: &Case) -> Vec<Material> {
        let draws = self.draws.iter().enumerate();
        draws
            .map(|(number, draw)| {
                let mut material = case.material(&mut Random::new(100 + number as u64));
                material.emissive = material.emissive.map(|channel| channel * draw.lighting.emission);
                material
            })
            .collect()
    }

    /// Returns a picture that is the same in all draws.
    pub fn shared(&self, name: &str) -> Option<&Picture> {
        match name {
            "albedo_tables" => Some(&self.albedo_tables),
            "environment_maps" => Some(&self.environment_maps),
            "environment_picture" => Some(&self.environment_picture),
            _ => None,
        }
    }
}

/// Returns the picture that a surface uses for a texture.
pub fn picture_of<'n>(case: &Case, texture: &'n str) -> &'n str {
    let object = case.method == SurfaceMethod::ObjectNormal && texture == TextureRole::Normal.name();
    if object { OBJECT_NORMALS } else { texture }
}

impl Draw {
    /// Returns the points across and down.
    pub fn size(&self) -> [usize; 2] {
        [WIDTH, self.points.rows]
    }

    /// Returns the bytes of a buffer of the frame, by name.
    pub fn buffer(&self, name: &str, inputs: &Inputs) -> Vec<u8> {
        match name {
            "frame" => self.lighting.frame(&inputs.sky).bytes(),
            "lights" => {
                let mut numbers: Vec<f32> = self.lighting.lights.iter().flat_map(light_numbers).collect();
                numbers.resize(16 * MOST_LIGHTS, 0.0);
                bytes(&numbers)
            }
            _ => bytes(inputs.levels.as_flattened()),
        }
    }
}

/// Converts numbers to little-endian bytes.
pub fn bytes(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Converts bytes to numbers.
pub fn numbers(bytes: &[u8]) -> Vec<[f32; 4]> {
    let number = |four: &[u8]| f32::from_le_bytes([four[0], four[1], four[2], four[3]]);
    let four = |texel: &[u8]| {
        [number(&texel[..4]), number(&texel[4..8]), number(&texel[8..12]), number(&texel[12..])]
    };
    bytes.chunks_exact(16).map(four).collect()
}
