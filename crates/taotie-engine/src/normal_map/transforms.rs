//! Heights turned into normals, and normals into those of another space.
//!
//! The functions work on images of vectors: x, y and z, and a fourth channel that is 1 if there is a normal. If not,
//! the vector is the padding value.

use crate::bake::{SurfacePoint, TexelSurface};
use crate::error::{Error, Result};
use crate::image::{Bitmap, Image, Wrap};
use crate::math::Vec3;
use crate::parallel;
use crate::scene::{GreenChannel, NormalSpace};
use crate::surface::{
    Relief, ReliefBase, decode_normal, decode_object_normal, relief_normal, tangent_normal,
    tangent_space_normal,
};

/// The heights of a map, [0, 1] if they come from integers; row by row from the top.
///
/// ```
/// use taotie_engine::image::Wrap;
/// use taotie_engine::normal_map::Heights;
///
/// let ramp = Heights::new([5, 1], vec![0.0, 1.0, 2.0, 3.0, 4.0], [Wrap::Clamp; 2])?;
/// assert_eq!((ramp.at(2, 0), ramp.slopes(2, 0)), (2.0, [1.0, 0.0]));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Heights {
    width: usize,
    height: usize,
    values: Vec<f32>,
    wrap: [Wrap; 2],
}

impl Heights {
    /// Makes heights from numbers; `wrap` defines how they continue beyond the borders, along u and v.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a side is zero or the count is not `width · height`.
    pub fn new([width, height]: [u32; 2], values: Vec<f32>, wrap: [Wrap; 2]) -> Result<Self> {
        let (width, height) = (width as usize, height as usize);
        if width == 0 || height == 0 || values.len() != width * height {
            return Err(Error::invalid(
                format!("heights of {width}x{height}"),
                format!("expected one number per texel, found {}", values.len()),
            ));
        }
        Ok(Self { width, height, values, wrap })
    }

    /// Takes the first channel of a bitmap, without decoding.
    pub fn from_bitmap(bitmap: &Bitmap, wrap: [Wrap; 2]) -> Self {
        let values = (0..bitmap.texels().len()).map(|i| bitmap.stored(i)[0]).collect();
        Self { width: bitmap.width() as usize, height: bitmap.height() as usize, values, wrap }
    }

    /// Returns the width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    /// Returns the height at a texel.
    pub fn at(&self, x: u32, y: u32) -> f64 {
        self.neighbour([x.into(), y.into()], [0, 0])
    }

    /// Returns the change of the height per texel to the right and per texel down: central differences over ±1 and ±2
    /// texels, exact for polynomials of the fourth degree (Fornberg 1988, table 1). Relief not confined to three
    /// texels is preserved better than by Sobel's or Prewitt's operators, which blur.
    pub fn slopes(&self, x: u32, y: u32) -> [f64; 2] {
        let at = |offset| self.neighbour([x.into(), y.into()], offset);
        let across = 8.0 * (at([1, 0]) - at([-1, 0])) - (at([2, 0]) - at([-2, 0]));
        let down = 8.0 * (at([0, 1]) - at([0, -1])) - (at([0, 2]) - at([0, -2]));
        [across / 12.0, down / 12.0]
    }

    fn neighbour(&self, [x, y]: [i64; 2], [dx, dy]: [i64; 2]) -> f64 {
        let column = within(self.wrap[0], x + dx, self.width);
        let row = within(self.wrap[1], y + dy, self.height);
        f64::from(self.values[row * self.width + column])
    }
}

/// Returns the texel in [0, size) to which index `i` wraps.
fn within(wrap: Wrap, i: i64, size: usize) -> usize {
    let size = size as i64;
    let i = match wrap {
        Wrap::Repeat => i.rem_euclid(size),
        Wrap::Clamp => i.clamp(0, size - 1),
        Wrap::Mirror => {
            let j = i.rem_euclid(2 * size);
            j.min(2 * size - 1 - j)
        }
    };
    i as usize
}

/// The padding of a tangent-space map: no relief.
const FLAT: [f32; 4] = [0.0, 0.0, 1.0, 0.0];
/// The padding of an object-space map: grey, which is not a normal.
const NOTHING: [f32; 4] = [0.0; 4];

/// Returns the vectors stored in a normal map, not normalised, with green up.
///
/// Texels with alpha 0 or a vector shorter than 0.25, such as grey padding, have no normal. In tangent space z is
/// raised above 0 ([`decode_normal`]).
///
/// ```
/// use taotie_engine::image::{Bitmap, Texels};
/// use taotie_engine::normal_map::decoded_normals;
/// use taotie_engine::scene::{GreenChannel, NormalSpace};
///
/// let texels = vec![[255, 127, 127, 255], [128, 128, 128, 255]];
/// let map = Bitmap::new(2, 1, 3, Texels::U8(texels))?;
/// let normals = decoded_normals(&map, NormalSpace::Object, GreenChannel::Up)?;
/// assert_eq!((normals.pixel(0, 0)[0], normals.pixel(0, 0)[3]), (1.0, 1.0));
/// assert_eq!(normals.pixel(1, 0), [0.0; 4], "grey is padding");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Limit`] if a side is above [`Image::MAX_SIDE`].
pub fn decoded_normals(bitmap: &Bitmap, space: NormalSpace, green: GreenChannel) -> Result<Image> {
    const SHORTEST: f32 = 0.25;
    let sign = if green == GreenChannel::Up { 1.0 } else { -1.0 };
    let padding = if space == NormalSpace::Tangent { FLAT } else { NOTHING };
    let normal = |i: usize| {
        let [r, g, b, alpha] = bitmap.stored(i);
        let stored = decode_object_normal(Vec3::new(r, g, b));
        let v = match space {
            NormalSpace::Object => stored,
            NormalSpace::Tangent => decode_normal(Vec3::new(r, g, b), 1.0, sign),
        };
        if alpha > 0.0 && stored.length() >= SHORTEST { [v.x, v.y, v.z, 1.0] } else { padding }
    };
    picture([bitmap.width(), bitmap.height()], parallel::collect(bitmap.texels().len(), normal))
}

/// Returns the tangent-space normals of a height map without a mesh, green up. `scale` is the height of 1 in texels,
/// so a slope of 1 per texel is 45° if it is 1.
///
/// n = (−s ∂h/∂x, −s ∂h/∂y, 1), normalised, with y up the image; differences as in [`Heights::slopes`].
///
/// ```
/// use taotie_engine::image::Wrap;
/// use taotie_engine::normal_map::{Heights, tangent_from_height};
///
/// let ramp = Heights::new([5, 1], vec![0.0, 1.0, 2.0, 3.0, 4.0], [Wrap::Clamp; 2])?;
/// let [x, y, z, _] = tangent_from_height(&ramp, 1.0)?.pixel(2, 0);
/// assert_eq!((x, y), (-z, 0.0), "45° to the left");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Limit`] if a side is above [`Image::MAX_SIDE`].
pub fn tangent_from_height(heights: &Heights, scale: f64) -> Result<Image> {
    let [width, height] = heights.size();
    let normal = |i: usize| {
        let [across, down] = heights.slopes((i % width as usize) as u32, (i / width as usize) as u32);
        with_mask(Vec3::new(-scale * across, scale * down, 1.0).normalize())
    };
    picture([width, height], parallel::collect(width as usize * height as usize, normal))
}

/// Returns the tangent-space normals, green up, of a height map on a mesh: they make the mesh look as if it were
/// displaced by the map. `scale` is the height of 1 in model units.
///
/// ```
/// use taotie_engine::image::Wrap;
/// use taotie_engine::normal_map::{Heights, tangent_from_height_on};
///
/// # let grid = taotie_engine::bake::TexelGrid { width: 32, height: 32, uv_set: 0, padding: 0 };
/// # let (ball, _) = taotie_engine::normal_map::lay_out(&taotie_engine::mesh::Mesh::sphere(1.0, 32, 16), &grid, None)?;
/// // Constant heights do not bend the normals of a ball that is laid out on 32×32 texels.
/// let even = Heights::new([32, 32], vec![0.5; 32 * 32], [Wrap::Repeat; 2])?;
/// let [.., z, _] = tangent_from_height_on(&ball, &even, 0.1)?.pixel(16, 16);
/// assert!(z > 0.999_99);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] if the mesh was laid out on a map of another size.
pub fn tangent_from_height_on(surface: &TexelSurface, heights: &Heights, scale: f64) -> Result<Image> {
    check_size(surface, heights.size())?;
    let [width, height] = heights.size().map(f64::from);
    let normals = surface.map(FLAT, |x, y, point| {
        let [across, down] = heights.slopes(x, y);
        let relief = Relief {
            height: heights.at(x, y) * scale,
            by_u: across * width * scale,
            by_v: down * height * scale,
        };
        let base = ReliefBase { n: point.normal, dp: point.position_by_uv, dn: point.normal_by_uv };
        with_mask(to_tangent(point, relief_normal(base, relief)))
    });
    picture(heights.size(), normals)
}

/// Converts tangent-space normals to object-space ones, as the renderer does: [`tangent_normal`].
///
/// ```
/// use taotie_engine::image::Image;
/// use taotie_engine::normal_map::object_from_tangent;
///
/// # let grid = taotie_engine::bake::TexelGrid { width: 32, height: 32, uv_set: 0, padding: 0 };
/// # let (ball, _) = taotie_engine::normal_map::lay_out(&taotie_engine::mesh::Mesh::sphere(1.0, 32, 16), &grid, None)?;
/// // The middle of the map shows the back of a ball.
/// let flat = Image::new(32, 32, [0.0, 0.0, 1.0, 1.0])?;
/// let [_, _, z, _] = object_from_tangent(&ball, &flat)?.pixel(16, 16);
/// assert!(z < -0.99);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// As [`tangent_from_height_on`].
pub fn object_from_tangent(surface: &TexelSurface, tangent: &Image) -> Result<Image> {
    converted(surface, tangent, NOTHING, |point, v| {
        tangent_normal(point.normal, point.tangent, point.handedness, v)
    })
}

/// Converts object-space normals to tangent-space ones, green up: the inverse of [`object_from_tangent`].
///
/// ```
/// use taotie_engine::compare::angular_error;
/// use taotie_engine::image::Image;
/// use taotie_engine::normal_map::{object_from_tangent, tangent_from_object};
///
/// # let grid = taotie_engine::bake::TexelGrid { width: 32, height: 32, uv_set: 0, padding: 0 };
/// # let (ball, _) = taotie_engine::normal_map::lay_out(&taotie_engine::mesh::Mesh::sphere(1.0, 32, 16), &grid, None)?;
/// let tilted = Image::new(32, 32, [0.6, 0.0, 0.8, 1.0])?;
/// let back = tangent_from_object(&ball, &object_from_tangent(&ball, &tilted)?)?;
/// let degrees = angular_error(&tilted, &back)?.summary().map(|summary| summary.max);
/// assert!(degrees.is_some_and(|degrees| degrees < 0.001), "{degrees:?}");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// As [`tangent_from_height_on`].
pub fn tangent_from_object(surface: &TexelSurface, object: &Image) -> Result<Image> {
    converted(surface, object, FLAT, to_tangent)
}

fn to_tangent(point: &SurfacePoint, v: Vec3<f64>) -> Vec3<f64> {
    tangent_space_normal(point.normal, point.tangent, point.handedness, v)
}

fn converted(
    surface: &TexelSurface,
    normals: &Image,
    padding: [f32; 4],
    turn: impl Fn(&SurfacePoint, Vec3<f64>) -> Vec3<f64> + Sync,
) -> Result<Image> {
    check_size(surface, [normals.width(), normals.height()])?;
    let texels = surface.map(padding, |x, y, point| match normals.pixel(x, y) {
        [x, y, z, mask] if mask > 0.0 => with_mask(turn(point, Vec3::new(x, y, z).to_f64())),
        _ => padding,
    });
    picture([normals.width(), normals.height()], texels)
}

fn check_size(surface: &TexelSurface, [width, height]: [u32; 2]) -> Result<()> {
    let (w, h) = (surface.coverage().width(), surface.coverage().height());
    if (w, h) == (width, height) {
        return Ok(());
    }
    Err(Error::invalid(
        format!("a map of {width}x{height} on a mesh laid out for {w}x{h}"),
        "lay out the mesh for the size of the map",
    ))
}

fn with_mask(v: Vec3<f64>) -> [f32; 4] {
    let v = v.to_f32();
    [v.x, v.y, v.z, 1.0]
}

fn picture([width, height]: [u32; 2], texels: Vec<[f32; 4]>) -> Result<Image> {
    let mut image = Image::new(width, height, [0.0; 4])?;
    image.pixels_mut().copy_from_slice(&texels);
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heights(size: [u32; 2], wrap: Wrap, value: impl Fn(f64, f64) -> f64) -> Heights {
        let values =
            (0..size[0] * size[1]).map(|i| value(f64::from(i % size[0]), f64::from(i / size[0])) as f32);
        Heights::new(size, values.collect(), [wrap; 2]).unwrap()
    }

    #[test]
    fn slopes_of_a_quartic_are_exact() {
        let map = heights([9, 9], Wrap::Clamp, |x, y| x * x * x * x - 3.0 * x * y + 2.0 * y * y * y);
        let (x, y) = (4.0, 3.0);
        assert_eq!(map.slopes(4, 3), [4.0 * x * x * x - 3.0 * y, -3.0 * x + 6.0 * y * y]);
    }

    #[test]
    fn borders_go_on_as_asked() {
        let slope = |wrap| heights([4, 1], wrap, |x, _| x).slopes(0, 0)[0];
        // Neighbours −2, −1, 1, 2: 2 3 1 2, then 0 0 1 2, then 1 0 1 2.
        assert_eq!(slope(Wrap::Repeat), (8.0 * (1.0 - 3.0) - (2.0 - 2.0)) / 12.0);
        assert_eq!(slope(Wrap::Clamp), (8.0 * (1.0 - 0.0) - (2.0 - 0.0)) / 12.0);
        assert_eq!(slope(Wrap::Mirror), (8.0 * (1.0 - 0.0) - (2.0 - 1.0)) / 12.0);
        assert_eq!(heights([1, 1], Wrap::Repeat, |_, _| 5.0).slopes(0, 0), [0.0; 2]);
    }

    #[test]
    fn a_wrong_count_is_refused() {
        assert!(Heights::new([2, 2], vec![0.0; 3], [Wrap::Clamp; 2]).is_err());
    }
}
