//! The uvs of a mesh on a raster that just fits them.

use crate::bake::{Coverage, TexelGrid};
use crate::error::Result;
use crate::math::{Vec2, Vec3};
use crate::mesh::{Mesh, MeshData};
use crate::parallel;

/// The longest side of a raster.
pub(super) const MOST_SIDE: u32 = 4096;

/// The uvs of uv set 0, translated and scaled to fill a raster, without wrapping.
pub(super) struct UvRaster<'a> {
    mesh: &'a Mesh,
    /// In [0, 1].
    uvs: Vec<Vec2>,
    size: [u32; 2],
    /// The side of a texel in the mesh's own uvs.
    pub texel: f64,
}

impl<'a> UvRaster<'a> {
    /// Makes a raster with texels of `1 / texels_per_uv` or less, at most [`MOST_SIDE`] of them across; `None` if no
    /// triangle has uvs that span an area.
    pub fn per_uv(mesh: &'a Mesh, texels_per_uv: f64) -> Option<Self> {
        Self::new(mesh, |longest| longest * texels_per_uv)
    }

    /// Makes a raster whose longer side has this many texels, at most [`MOST_SIDE`]; `None` as for [`Self::per_uv`].
    pub fn across(mesh: &'a Mesh, texels: f64) -> Option<Self> {
        Self::new(mesh, |_| texels)
    }

    /// Makes a raster whose longer side has the number of texels that `texels` returns for its length in uv.
    fn new(mesh: &'a Mesh, texels: impl Fn(f64) -> f64) -> Option<Self> {
        let uvs = mesh.uvs().first()?;
        let [low, high] = extent(mesh, uvs);
        let extent = [high[0] - low[0], high[1] - low[1]];
        let longest = extent[0].max(extent[1]);
        let has_area = extent.iter().all(|side| side.is_finite() && *side > 0.0);
        if !has_area {
            return None;
        }
        let side = texels(longest).ceil().clamp(1.0, f64::from(MOST_SIDE));
        let texel = longest / side;
        let size = extent.map(|side| (side / texel).ceil().clamp(1.0, f64::from(MOST_SIDE)) as u32);
        let scale = size.map(|side| 1.0 / (texel * f64::from(side)));
        let fit = |v: f32, axis: usize| ((f64::from(v) - low[axis]) * scale[axis]) as f32;
        let uvs = parallel::collect(uvs.len(), |i| Vec2::new(fit(uvs[i].x, 0), fit(uvs[i].y, 1)));
        Some(Self { mesh, uvs, size, texel })
    }

    /// Lays out the triangles in this order; if several cover a texel, the first has it.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] for a mesh of 2³¹ triangles.
    pub fn coverage(&self, order: impl Iterator<Item = u32>) -> Result<Coverage> {
        let triangles = order.map(|triangle| self.mesh.triangles()[triangle as usize]).collect();
        let positions = vec![Vec3::splat(0.0); self.uvs.len()];
        let data = MeshData { positions, uvs: vec![self.uvs.clone()], triangles, ..MeshData::default() };
        let [width, height] = self.size;
        Coverage::new(&Mesh::new(data)?, &TexelGrid { width, height, uv_set: 0, padding: 0 })
    }
}

/// Returns the minimum and maximum finite u and v of the triangles' corners.
fn extent(mesh: &Mesh, uvs: &[Vec2]) -> [[f64; 2]; 2] {
    let triangles = mesh.triangles();
    let parts = parallel::fold(triangles.len(), |sum: &mut Extent, triangle| {
        for corner in triangles[triangle] {
            let uv = uvs[corner as usize];
            sum.take([uv.x, uv.y]);
        }
    });
    let mut all = Extent::default();
    for Extent { low, high } in parts {
        all.take(low);
        all.take(high);
    }
    [all.low, all.high].map(|corner| corner.map(f64::from))
}

/// The minimum and maximum finite u and v.
struct Extent {
    low: [f32; 2],
    high: [f32; 2],
}

impl Default for Extent {
    fn default() -> Self {
        Self { low: [f32::INFINITY; 2], high: [f32::NEG_INFINITY; 2] }
    }
}

impl Extent {
    fn take(&mut self, uv: [f32; 2]) {
        for axis in (0..2).filter(|axis| uv[*axis].is_finite()) {
            self.low[axis] = self.low[axis].min(uv[axis]);
            self.high[axis] = self.high[axis].max(uv[axis]);
        }
    }
}
