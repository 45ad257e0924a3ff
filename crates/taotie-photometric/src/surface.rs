//! The relief as a mesh with the estimated normals and colours.

use crate::depth::Relief;
use crate::estimate::Estimate;
use taotie_engine::error::Result;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Instance, Scene, SceneData};

/// The most vertices along a side: 16 MB of GLB for a square.
const SIDE: usize = 512;

impl Estimate {
    /// Returns the relief as a surface of at most 512 × 512 vertices with the estimated normals and base colour; the
    /// vertices are at pixel centres, `pixel_size` apart. Depth edges are open. `None` if no four neighbouring pixels have a
    /// normal.
    ///
    /// # Errors
    /// Those of [`Scene::new`], none of which can occur.
    pub fn surface(&self, relief: &Relief, pixel_size: f64) -> Result<Option<Scene>> {
        let data = self.mesh(relief, pixel_size);
        if data.triangles.is_empty() {
            return Ok(None);
        }
        let mesh = Mesh::new(data)?;
        let scene = Scene::new(SceneData {
            meshes: vec![mesh],
            instances: vec![Instance {
                mesh: 0,
                material: 0,
                world_from_object: taotie_engine::math::Mat4::IDENTITY,
            }],
            ..self.appearance(None)?
        })?;
        Ok(Some(scene))
    }

    fn mesh(&self, relief: &Relief, pixel_size: f64) -> MeshData {
        let grid = &relief.grid;
        let step = grid.width.max(grid.height).div_ceil(SIDE);
        let [width, height] = [grid.width, grid.height].map(|side| side as f64);
        let normals: Vec<Vec3<f64>> = self.best.iter().flatten().map(|best| best.normal).collect();
        let mut data = MeshData::default();
        let mut uvs = Vec::new();
        let mut vertices = vec![u32::MAX; grid.pixels.len()];
        let kept = |i: usize| grid.position(i).iter().all(|v| v % step == 0);
        for i in (0..grid.pixels.len()).filter(|i| kept(*i)) {
            let [x, y] = grid.position(i).map(|v| v as f64 + 0.5);
            vertices[i] = data.positions.len() as u32;
            let place = Vec3::new(x - 0.5 * width, 0.5 * height - y, relief.heights[i]) * pixel_size;
            data.positions.push(place.to_f32());
            data.normals.push(normals[i].to_f32());
            uvs.push(Vec2::new((x / width) as f32, (y / height) as f32));
        }
        data.uvs = vec![uvs];
        let side = step as i64;
        for i in (0..grid.pixels.len()).filter(|i| kept(*i)) {
            let [x, y] = grid.position(i).map(|v| v as i64);
            let corner = |dx: i64, dy: i64| grid.at(x + dx, y + dy);
            // The pixel, the one on the right, and the two below.
            if let (Some(b), Some(c), Some(d)) = (corner(side, 0), corner(side, side), corner(0, side))
                && relief.continues_within([x, y], side)
            {
                let [a, b, c, d] = [i, b, c, d].map(|i| vertices[i]);
                data.triangles.extend([[a, d, c], [a, c, b]]);
            }
        }
        data
    }
}

impl Relief {
    /// Returns true if all pixels of a square are there, and no depth edge is between them.
    fn continues_within(&self, [x, y]: [i64; 2], side: i64) -> bool {
        let inside = |dx: i64, dy: i64| {
            let Some(i) = self.grid.at(x + dx, y + dy) else { return false };
            let [right, above] = self.continues[i];
            (dx == side || right) && (dy == 0 || above)
        };
        (0..=side).all(|dy| (0..=side).all(|dx| inside(dx, dy)))
    }

    /// Returns the heights as an image, times `scale`; the fourth channel is 1 where there is one.
    pub fn image(&self, scale: f64) -> taotie_engine::image::Image {
        let mut pixels = vec![[0.0; 4]; self.grid.width * self.grid.height];
        for (pixel, height) in self.grid.pixels.iter().zip(&self.heights) {
            let v = (height * scale) as f32;
            pixels[*pixel as usize] = [v, v, v, 1.0];
        }
        taotie_engine::image::Image::from_pixels(self.grid.width as u32, self.grid.height as u32, pixels)
            .expect("the size is that of the grid")
    }
}
