//! The light of a photograph, and the checks that all lights of a set have in common.

use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::math::Vec3;

/// The light of one photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Unit vector towards the light from the picture's centre: x to the right of the picture, y up, z towards the
    /// camera.
    pub direction: Vec3<f64>,
    /// Radiance in red, green and blue, above 0, relative to the other photographs.
    pub intensity: [f64; 3],
    /// The place of a near lamp, pixels from the picture's centre on the plane of the object; `None` if it is distant.
    pub position: Option<Vec3<f64>>,
}

/// A light as one pixel sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lit {
    /// Unit vector towards the light.
    pub direction: Vec3<f64>,
    /// The squared distance, relative to that of the picture's centre: samples are multiplied by it.
    pub falloff: f64,
}

impl Light {
    /// Makes a light of intensity 1 from a vector towards it, of any length; `None` if the vector has no direction.
    pub fn towards(vector: [f64; 3]) -> Option<Self> {
        let length = vector.iter().fold(0.0, |sum: f64, v| sum + v * v).sqrt();
        let usable = length.is_finite() && length > 1e-9;
        usable.then(|| Self {
            direction: Vec3::from_array(vector.map(|v| v / length)),
            intensity: [1.0; 3],
            position: None,
        })
    }

    /// Returns the light as a point sees it, in pixels from the picture's centre.
    pub fn at(&self, point: Vec3<f64>) -> Lit {
        match self.position {
            None => Lit { direction: self.direction, falloff: 1.0 },
            Some(position) => near(position, point),
        }
    }
}

/// Returns the centre of a pixel on the plane of the object, pixels from the picture's centre.
pub fn place(pixel: [usize; 2], [width, height]: [usize; 2]) -> Vec3<f64> {
    let x = pixel[0] as f64 + 0.5 - 0.5 * width as f64;
    Vec3::new(x, 0.5 * height as f64 - pixel[1] as f64 - 0.5, 0.0)
}

/// Returns a near lamp as a point sees it.
pub fn near(position: Vec3<f64>, point: Vec3<f64>) -> Lit {
    let to = position - point;
    let square = to.dot(to);
    let direction = to / square.sqrt().max(f64::MIN_POSITIVE);
    Lit { direction, falloff: square / position.dot(position) }
}

/// Sets the intensities of near lamps that are equally bright: those further away light the object less.
pub fn equalise(lights: Vec<&mut Light>) {
    let near = lights.into_iter().filter_map(|light| Some((light.position?.dot(light.position?), light)));
    let near: Vec<(f64, &mut Light)> = near.collect();
    let mean = near.iter().map(|(square, _)| square).sum::<f64>() / near.len().max(1) as f64;
    for (square, light) in near {
        light.intensity = [mean / square; 3];
    }
}

/// The fewest photographs from which a normal and its uncertainty follow: three unknowns, and one more for the
/// residual.
pub const FEWEST: usize = 4;

/// The smallest eigenvalue of the mean of l lᵀ with which the normal is determined. Lights on a cone of half-angle 4°
/// around the view reach it.
const LEAST_SPREAD: f64 = 0.002;

/// Checks that the lights determine a normal. `file` is the file that states them.
///
/// # Errors
/// [`Error::Invalid`] if there are fewer than [`FEWEST`], all come from behind, or they lie nearly in a plane.
pub fn check(lights: &[Light], file: &str) -> Result<()> {
    if lights.len() < FEWEST {
        let what = format!("{file}: {} lights", lights.len());
        return Err(Error::invalid(what, format!("at least {FEWEST} are needed; add photographs")));
    }
    if lights.iter().all(|light| light.direction.z <= 0.0) {
        return Err(Error::invalid(
            format!("{file}: lights from behind the object"),
            "z must point from the object towards the camera; negate z in the file",
        ));
    }
    if least_spread(lights) < LEAST_SPREAD {
        return Err(Error::invalid(
            format!("{file}: lights nearly in one plane or from one direction"),
            "normals cannot be determined; add photographs lit from other directions",
        ));
    }
    Ok(())
}

/// Notes lights from behind.
pub fn note_behind(lights: &[Light], warnings: &mut Warnings) {
    let behind = lights.iter().filter(|light| light.direction.z <= 0.0).count();
    warnings.note("a light comes from behind the object", behind);
}

/// Notes vectors that differ in length.
pub fn note_lengths(lengths: impl Iterator<Item = f64>, remedy: &str, warnings: &mut Warnings) {
    let (least, most) = lengths.fold((f64::INFINITY, 0.0), |(least, most), v| (v.min(least), v.max(most)));
    let what =
        "the vectors of the lights differ in length, like positions of lamps: only their directions are used";
    warnings.note(format!("{what}{remedy}"), usize::from(most > 1.05 * least));
}

/// Returns the smallest eigenvalue of the mean of l lᵀ.
fn least_spread(lights: &[Light]) -> f64 {
    let mut sums = crate::symmetric::Sym3::default();
    lights.iter().for_each(|light| sums.add(light.direction, 1.0 / lights.len() as f64));
    sums.least_eigenvalue()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lights(vectors: &[[f64; 3]]) -> Vec<Light> {
        vectors.iter().map(|v| Light::towards(*v).unwrap()).collect()
    }

    #[test]
    fn lights_that_determine_nothing_are_refused() {
        let good = [[0.5, 0.0, 1.0], [-0.5, 0.0, 1.0], [0.0, 0.5, 1.0], [0.0, -0.5, 1.0]];
        assert!(check(&lights(&good), "a.lp").is_ok());
        let why = |vectors: &[[f64; 3]]| check(&lights(vectors), "a.lp").unwrap_err().to_string();
        assert!(why(&good[..3]).contains("at least 4"));
        assert!(why(&[[0.1, 0.0, 1.0]; 5]).contains("one direction"));
        assert!(
            why(&[[0.1, 0.0, 1.0], [0.5, 0.0, 1.0], [-0.3, 0.0, 1.0], [0.9, 0.0, 0.2]]).contains("plane")
        );
        assert!(why(&good.map(|[x, y, z]| [x, y, -z])).contains("negate z"));
        assert!(Light::towards([0.0; 3]).is_none() && Light::towards([f64::NAN, 0.0, 1.0]).is_none());
    }
}
