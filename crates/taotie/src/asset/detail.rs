//! The size of a map that preserves the detail of a scan.

use crate::bake::texel_width;
use crate::math::scalar;
use crate::mesh::Mesh;
use crate::proof::{Footprint, edges};
use crate::scene::{Instance, Scene};

/// The share of a map that UV islands cover in a generated atlas.
const COVERED: f64 = 0.6;
/// The share of the surface whose detail may be finer than the map's texels.
const LOST: f64 = 0.01;
/// The largest side considered.
const MOST: f64 = 65_536.0;

/// A piece of the scan.
struct Piece {
    /// Its area, square model units.
    area: f64,
    /// The width of its finest texel, model units.
    texel: Option<f32>,
}

/// Returns the side of the smallest square map, a power of two, whose texels are at most as wide as the scan's finest
/// detail on all but one per cent of its area: a texel of its textures, or half its median edge, but at least 1/4096
/// of its diagonal.
pub(super) fn map_side(scene: &Scene) -> u32 {
    let (mut pieces, mut lengths) = (Vec::new(), Vec::new());
    let mut first = 0;
    let count = scene.triangle_count();
    let mut looked_at = Footprint::looked_at(count).peekable();
    let looked = Footprint::looked_at(count).count();
    for instance in scene.instances() {
        let placed = Placed::of(scene, instance);
        let end = first + placed.mesh.triangles().len();
        while let Some(t) = looked_at.next_if(|t| *t < end) {
            lengths.extend(placed.edges(t - first));
            pieces.push(placed.piece(t - first));
        }
        first = end;
    }
    let footprint = Footprint::of_edges(lengths, scene.bounds().map_or(0.0, |bounds| bounds.diagonal()));
    let mut widths: Vec<(f32, f64)> =
        pieces.into_iter().map(|piece| (footprint.of_texel(piece.texel), piece.area)).collect();
    widths.sort_by(|a, b| a.0.total_cmp(&b.0));
    let seen: f64 = widths.iter().map(|(_, area)| area).sum();
    let mut finer = 0.0;
    let is_preserved = |(_, area): &&(f32, f64)| {
        finer += area;
        finer >= seen * LOST
    };
    let Some((width, _)) = widths.iter().find(is_preserved) else { return 1 };
    let area = seen * count as f64 / looked.max(1) as f64;
    let side = (area / COVERED).sqrt() / f64::from(*width);
    (side.min(MOST).ceil() as u32).next_power_of_two()
}

/// An instance of a mesh.
struct Placed<'a> {
    scene: &'a Scene,
    instance: &'a Instance,
    mesh: &'a Mesh,
    /// The scale of its lengths.
    scale: f64,
}

impl<'a> Placed<'a> {
    fn of(scene: &'a Scene, instance: &'a Instance) -> Self {
        let scale = scalar::cbrt(instance.world_from_object.determinant3().abs());
        Self { scene, instance, mesh: &scene.meshes()[instance.mesh], scale }
    }

    fn edges(&self, triangle: usize) -> [f32; 3] {
        edges(self.mesh, triangle).map(|length| length * self.scale as f32)
    }

    fn piece(&self, triangle: usize) -> Piece {
        let [a, b, c] = self.mesh.corners(triangle).map(|corner| corner.to_f64());
        let material = &self.scene.materials()[self.instance.material];
        let textures = self.scene.textures();
        let widths = material
            .textures()
            .into_iter()
            .filter_map(|used| texel_width((self.mesh, triangle as u32), textures, &used));
        Piece {
            area: (b - a).cross(c - a).length() * 0.5 * self.scale * self.scale,
            texel: widths.reduce(f32::min).map(|width| width * self.scale as f32),
        }
    }
}
