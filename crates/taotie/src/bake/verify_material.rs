//! The error of the material that a low-poly mesh shows against the scan it was baked from.

use super::layout::{BAND, Layout};
use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use super::verify::{Verifier, sample_area};
use crate::compare::{Field, color_difference};
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::mesh::Point;
use crate::parallel;
use crate::scene::{AlphaMode, Material};

/// The differences of a material from that of the scan, one number for each of many points spread evenly over the
/// low-poly mesh; NaN where a point found no scan, and between colours where either side is not there to be seen.
#[derive(Debug, Clone)]
pub struct MaterialError {
    /// CIEDE2000 between the base colours.
    pub color: Field,
    /// Between the values of metallic, [0, 1].
    pub metallic: Field,
    /// Between the roughnesses as artists set them, [0, 1].
    pub roughness: Field,
    /// Between the radiances emitted, in the channel that differs most.
    pub emission: Field,
    /// Between the alphas, [0, 1]: 1 where opaque, 0 or 1 where a mask decides.
    pub alpha: Field,
}

impl Verifier<'_> {
    /// Measures the material that `shown` has, the textures of both sides looked up at their finest levels, at the
    /// points of [`Verifier::normal_error`]. `shown` has the triangles of [`Verifier::mesh`], in the same order.
    ///
    /// # Errors
    /// [`Error::Invalid`] where the mesh has no area, or other triangles than `shown`.
    pub fn material_error(&self, shown: &TexturedMesh, count: usize) -> Result<MaterialError> {
        self.check_triangles(shown)?;
        let point = sample_area(self.mesh, count)?;
        let found = parallel::collect(count, |i| self.material_difference(shown, point(i)));
        let field = |of: fn(&Difference) -> f32| Field::new(count as u32, 1, found.iter().map(of).collect());
        Ok(MaterialError {
            color: field(|d| d.color)?,
            metallic: field(|d| d.metallic)?,
            roughness: field(|d| d.roughness)?,
            emission: field(|d| d.emission)?,
            alpha: field(|d| d.alpha)?,
        })
    }

    /// Returns the difference of the base colours, CIEDE2000, at the middle of each texel of a map of this size; NaN away
    /// from all UV islands, and where either side is not there to be seen.
    ///
    /// # Errors
    /// As [`Verifier::material_error`]; [`Error::Invalid`] where the mesh has no uvs.
    pub fn color_map(&self, shown: &TexturedMesh, size: [u32; 2]) -> Result<Field> {
        self.check_triangles(shown)?;
        let layout = Layout::new(self.mesh, size, 1)?;
        let mut values = vec![f32::NAN; size[0] as usize * size[1] as usize];
        parallel::pieces(&mut values, (BAND * size[0]) as usize, &|band, values| {
            layout.triangle_samples(band, |group| {
                for sample in &group.samples {
                    let difference = self.material_difference(shown, group.point(sample));
                    values[sample.texel as usize] = difference.color;
                }
            });
        });
        Field::new(size[0], size[1], values)
    }

    fn check_triangles(&self, shown: &TexturedMesh) -> Result<()> {
        let [own, others] = [self.mesh, shown.mesh()].map(|mesh| mesh.triangles().len());
        if own == others {
            return Ok(());
        }
        Err(Error::invalid(
            "the low-poly mesh",
            format!("it has {own} triangles; the mesh of its material has {others}"),
        ))
    }

    fn material_difference(&self, shown: &TexturedMesh, point: Point) -> Difference {
        let (Some(found), _) = self.found(point) else { return Difference::default() };
        let scan = Shown::of(self.scan.surface(), found.point);
        Shown::of(shown, point).difference(&scan)
    }
}

/// The material that a viewer shows at a point.
struct Shown {
    color: [f32; 3],
    metallic: f32,
    roughness: f32,
    emission: Vec3,
    alpha: f32,
}

impl Shown {
    fn of(mesh: &TexturedMesh, point: Point) -> Self {
        let sample = mesh.sample(LookupPoint::finest(point));
        Self {
            color: sample.color.to_array(),
            metallic: sample.metallic,
            roughness: sample.roughness,
            emission: sample.emission,
            alpha: visible(mesh.material(point.triangle), sample.alpha),
        }
    }

    fn difference(&self, other: &Self) -> Difference {
        let emission = (self.emission - other.emission).to_array().map(f32::abs);
        Difference {
            color: match self.alpha > 0.0 && other.alpha > 0.0 {
                true => color_difference(self.color, other.color) as f32,
                false => f32::NAN,
            },
            metallic: (self.metallic - other.metallic).abs(),
            roughness: (self.roughness - other.roughness).abs(),
            emission: emission.into_iter().fold(0.0, f32::max),
            alpha: (self.alpha - other.alpha).abs(),
        }
    }
}

/// Returns how much of a surface with this alpha is seen, [0, 1].
fn visible(material: &Material, alpha: f32) -> f32 {
    match material.alpha {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
        AlphaMode::Blend => alpha,
    }
}

/// The differences at a point.
#[derive(Clone, Copy)]
struct Difference {
    color: f32,
    metallic: f32,
    roughness: f32,
    emission: f32,
    alpha: f32,
}

impl Default for Difference {
    /// Where no scan was found.
    fn default() -> Self {
        Self { color: f32::NAN, metallic: f32::NAN, roughness: f32::NAN, emission: f32::NAN, alpha: f32::NAN }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_seen_follows_the_mode() {
        let of = |alpha: AlphaMode, value: f32| visible(&Material { alpha, ..Material::default() }, value);
        assert_eq!(of(AlphaMode::Opaque, 0.2), 1.0);
        assert_eq!([0.4, 0.5].map(|v| of(AlphaMode::Mask(0.5), v)), [0.0, 1.0]);
        assert_eq!(of(AlphaMode::Blend, 0.2), 0.2);
    }

    #[test]
    fn every_value_counts_by_itself() {
        let shown = |emission: Vec3, roughness: f32| Shown {
            color: [0.5; 3],
            metallic: 1.0,
            roughness,
            emission,
            alpha: 1.0,
        };
        let d = shown(Vec3::new(1.0, 2.0, 5.0), 0.25).difference(&shown(Vec3::new(3.0, 2.0, 4.0), 0.5));
        assert_eq!((d.color, d.metallic, d.roughness, d.emission, d.alpha), (0.0, 0.0, 0.25, 2.0, 0.0));
        let red = Shown { color: [1.0, 0.0, 0.0], ..shown(Vec3::default(), 0.5) };
        assert!(red.difference(&shown(Vec3::default(), 0.5)).color > 20.0);
        let hidden = Shown { alpha: 0.0, ..red };
        let d = hidden.difference(&shown(Vec3::default(), 0.5));
        assert!(d.color.is_nan() && d.alpha == 1.0, "nobody sees its colour");
    }
}
