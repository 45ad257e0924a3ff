//! The triangle of a mesh that each texel of a map belongs to.

use super::grow::grow;
use super::owner::{NONE, PADDING};
use super::raster::{Canvas, Rasterizer};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::math::Vec2;
use crate::mesh::Mesh;
use crate::parallel;

/// The map on which a mesh is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TexelGrid {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// The uv set of the mesh.
    pub uv_set: usize,
    /// The number of texels by which UV islands are dilated.
    pub padding: u32,
}

/// The triangle that each texel belongs to.
///
/// A texel belongs to the triangle that covers its centre. Corners are rounded to fixed point and the rest is exact:
/// if triangles share an edge, only one of them covers a centre on it. If triangles overlap, the one with the lowest
/// index gets the texel. Uvs outside [0, 1] are wrapped.
///
/// A texel in the padding, which surrounds UV islands and continues across the map's borders, belongs to the triangle
/// of the nearest covered texel, counted in steps to the left, right, up and down.
#[derive(Debug, Clone)]
pub struct Coverage {
    width: u32,
    height: u32,
    /// The triangle, with [`PADDING`] set if its texel is in the padding; [`NONE`].
    texels: Vec<u32>,
    covered: usize,
    shared: usize,
    skipped: usize,
}

impl Coverage {
    /// Lays out the triangles of a mesh.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the mesh has no such uv set or a side of the map is zero, [`Error::Limit`] if a side is
    /// above [`Image::MAX_SIDE`], a triangle's uvs span more than 16 copies of the map, or the mesh has 2³¹
    /// triangles.
    pub fn new(mesh: &Mesh, grid: &TexelGrid) -> Result<Self> {
        let TexelGrid { width, height, .. } = *grid;
        Image::check_size(width, height)?;
        if mesh.triangles().len() >= PADDING as usize {
            return Err(Error::limit("a mesh of 2^31 triangles for a map", "split it"));
        }
        let uvs = uv_set(mesh, grid.uv_set)?;
        let rasterizer = Rasterizer::new(mesh.triangles(), uvs, [width, height])?;
        let canvas = Canvas::new(width, height);
        let skipped = parallel::count(mesh.triangles().len(), |t| !rasterizer.draw(t, &canvas));
        let (mut texels, shared) = canvas.finish();
        let covered = parallel::count(texels.len(), |i| texels[i] != NONE);
        grow(&mut texels, width as usize, grid.padding);
        Ok(Self { width, height, texels, covered, shared, skipped })
    }

    /// Texels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Texels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the triangle that a texel belongs to, padding included.
    pub fn triangle(&self, x: u32, y: u32) -> Option<u32> {
        let texel = self.texels[self.index(x, y)];
        (texel != NONE).then_some(texel & !PADDING)
    }

    /// Returns `true` if a triangle covers the centre of a texel, excluding padding.
    pub fn is_covered(&self, x: u32, y: u32) -> bool {
        self.texels[self.index(x, y)] < PADDING
    }

    /// Returns a flag per texel, row by row from the top: `true` if a triangle covers its centre.
    pub fn mask(&self) -> Vec<bool> {
        parallel::collect(self.texels.len(), |i| self.texels[i] < PADDING)
    }

    /// Returns the number of texels whose centre is covered by a triangle.
    pub fn covered(&self) -> usize {
        self.covered
    }

    /// Returns the number of texels whose centre is covered by more than one triangle: UV islands that overlap, or
    /// uvs that wrap around.
    pub fn shared(&self) -> usize {
        self.shared
    }

    /// Returns the number of triangles that cannot cover a texel because their uvs span no area or are not finite.
    pub fn skipped(&self) -> usize {
        self.skipped
    }

    fn index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width && y < self.height, "texel ({x}, {y}) of {}x{}", self.width, self.height);
        y as usize * self.width as usize + x as usize
    }
}

/// Returns the uv set `set` of a mesh.
pub(super) fn uv_set(mesh: &Mesh, set: usize) -> Result<&[Vec2]> {
    mesh.uvs().get(set).map(Vec::as_slice).ok_or_else(|| {
        let count = mesh.uvs().len();
        Error::invalid(format!("uv set {set} for a map"), format!("the mesh has {count}; unwrap it first"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::mesh::MeshData;

    /// Makes a mesh with these uvs, three per triangle.
    fn mesh(uvs: &[[f32; 2]]) -> Mesh {
        let uvs: Vec<Vec2> = uvs.iter().map(|[u, v]| Vec2::new(*u, *v)).collect();
        let positions = vec![Vec3::splat(0.0); uvs.len()];
        let triangles = (0..uvs.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::new(MeshData { positions, uvs: vec![uvs], triangles, ..MeshData::default() }).unwrap()
    }

    fn grid(width: u32, height: u32, padding: u32) -> TexelGrid {
        TexelGrid { width, height, uv_set: 0, padding }
    }

    /// Returns the map as text: triangle indices as digits, as letters in the padding, and dots for free texels.
    fn text(coverage: &Coverage) -> String {
        let texel = |y: u32, x: u32| match (coverage.triangle(x, y), coverage.is_covered(x, y)) {
            (None, _) => '.',
            (Some(t), true) => char::from(b'0' + t as u8),
            (Some(t), false) => char::from(b'a' + t as u8),
        };
        let row = |y: u32| (0..coverage.width()).map(|x| texel(y, x)).collect::<String>();
        (0..coverage.height()).map(row).collect::<Vec<_>>().join("/")
    }

    #[test]
    fn the_two_halves_of_a_square_share_no_texel_and_leave_none() {
        let square = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [1.0, 0.0]];
        let coverage = Coverage::new(&mesh(&square), &grid(4, 4, 0)).unwrap();
        assert_eq!((coverage.covered(), coverage.shared()), (16, 0), "{}", text(&coverage));
        // The same, mirrored.
        let mirrored: Vec<[f32; 2]> = square.iter().map(|[u, v]| [1.0 - u, *v]).collect();
        let coverage = Coverage::new(&mesh(&mirrored), &grid(4, 4, 0)).unwrap();
        assert_eq!((coverage.covered(), coverage.shared()), (16, 0), "{}", text(&coverage));
    }

    #[test]
    fn the_lowest_number_has_a_texel_that_is_shared() {
        let corner = [[0.0, 0.0], [0.0, 0.45], [0.45, 0.0]];
        let all = [[0.0, 0.0], [0.0, 2.0], [2.0, 0.0]];
        let both = |first: [[f32; 2]; 3], second: [[f32; 2]; 3]| {
            let coverage = Coverage::new(&mesh(&[first, second].concat()), &grid(4, 4, 0)).unwrap();
            (text(&coverage), coverage.shared())
        };
        let (small_first, shared) = both(corner, all);
        assert_eq!(small_first, "0111/1111/1111/1111");
        assert!(shared >= 1);
        assert_eq!(both(all, corner).0, "0000/0000/0000/0000");
    }

    #[test]
    fn padding_goes_around_islands_and_across_borders() {
        let left = [[0.0, 0.25], [0.0, 0.45], [0.2, 0.25]];
        let coverage = Coverage::new(&mesh(&left), &grid(8, 8, 0)).unwrap();
        assert_eq!(
            text(&coverage),
            "......../......../0......./......../......../......../......../........"
        );
        let coverage = Coverage::new(&mesh(&left), &grid(8, 8, 1)).unwrap();
        assert_eq!(
            text(&coverage),
            "......../a......./0a.....a/a......./......../......../......../........"
        );
        assert_eq!((coverage.covered(), coverage.mask().iter().filter(|m| **m).count()), (1, 1));
    }

    #[test]
    fn uvs_outside_are_wrapped() {
        let plain = [[0.125, 0.125], [0.125, 0.875], [0.875, 0.125]];
        let moved: Vec<[f32; 2]> = plain.iter().map(|[u, v]| [u + 3.0, v - 2.0]).collect();
        let [a, b] =
            [&plain[..], &moved].map(|uvs| text(&Coverage::new(&mesh(uvs), &grid(16, 16, 2)).unwrap()));
        assert_eq!(a, b);
        // Across the border: half of a square on the left, half on the right.
        let across = [[0.75, 0.0], [0.75, 1.0], [1.25, 1.0], [0.75, 0.0], [1.25, 1.0], [1.25, 0.0]];
        let coverage = Coverage::new(&mesh(&across), &grid(4, 1, 0)).unwrap();
        assert_eq!((text(&coverage).replace('1', "0").as_str(), coverage.shared()), ("0..0", 0));
    }

    #[test]
    fn triangles_without_area_cover_nothing_and_are_counted() {
        let uvs = [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3], [f32::NAN, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let coverage = Coverage::new(&mesh(&uvs), &grid(8, 8, 3)).unwrap();
        assert_eq!((coverage.covered(), coverage.skipped()), (0, 2));
    }

    #[test]
    fn what_cannot_be_laid_out_is_refused() {
        let sound = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let far = [[0.0, 0.0], [0.0, 1.0], [40.0, 1.0]];
        let refused =
            |uvs: &[[f32; 2]], grid: TexelGrid| Coverage::new(&mesh(uvs), &grid).unwrap_err().to_string();
        assert!(refused(&sound, TexelGrid { uv_set: 1, ..grid(4, 4, 0) }).contains("uv set 1"));
        assert!(refused(&sound, grid(0, 4, 0)).contains("0x4"));
        assert!(refused(&far, grid(4, 4, 0)).contains("copies of the map"));
    }
}
