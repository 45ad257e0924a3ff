//! Directional albedos of the lobes, as tables: the total reflection of a highlight, at any angle and roughness.
//!
//! The fraction of light that a lobe reflects depends only on n·v and the roughness, apart from the Fresnel factor,
//! which is linear in the colours at normal and at grazing incidence and in the F82 term. So one table of four
//! numbers per lobe is the second factor of the split sum, determines how much light single scattering loses, and how
//! much remains for the layer below. `cargo run -p xtask -- tables` computes the tables with
//! [`super::furnace`].

mod albedos;

use crate::math::{Lane, Number, Vec3};
use std::array::from_fn;

/// Nodes along √(n·v).
pub const COLUMNS: usize = 64;

/// Nodes along the roughness.
pub const ROWS: usize = 48;

/// The directional albedo of a lobe, for each term of its Fresnel factor: F0 `scale` + F90 `bias` − drop `edge`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dfg<L> {
    /// ∫ D V (1 − (1 − v·h)⁵) n·l dl, [0, 1].
    pub scale: L,
    /// ∫ D V (1 − v·h)⁵ n·l dl, [0, 1].
    pub bias: L,
    /// ∫ D V v·h (1 − v·h)⁶ n·l dl, [0, 0.06].
    pub edge: L,
    /// ∫ (1 − v·h)⁵ n·l / π dl, [0, 1]: Schlick's rise averaged over a diffuse reflection.
    pub diffuse_edge: L,
}

impl<L: Lane> Dfg<L> {
    /// The fraction of light that the lobe reflects if every facet reflects all, (0, 1].
    #[inline(always)]
    pub fn total(&self) -> L {
        self.scale + self.bias
    }

    /// The fraction of light that the lobe reflects, linear RGB, for Schlick's Fresnel factor between `f0` and `f90`
    /// with Lazányi's `drop`.
    #[inline(always)]
    pub fn albedo(&self, f0: Vec3<L>, f90: L, drop: Vec3<L>) -> Vec3<L> {
        let albedo = f0 * self.scale + Vec3::splat(f90 * self.bias) - drop * self.edge;
        Vec3::new(albedo.x.clamp(0.0, 1.0), albedo.y.clamp(0.0, 1.0), albedo.z.clamp(0.0, 1.0))
    }
}

/// Reads the table of the GGX lobe.
///
/// `n_dot_v` and `roughness` in [0, 1]; α is the square of the roughness.
/// Law: within 0.5 % of the quadrature (`laws::energy::tables_are_exact_between_their_nodes`).
/// Source: Karis 2013, "Real Shading in Unreal Engine 4", the second factor of the split sum; computed by quadrature.
pub fn of_ggx(n_dot_v: f32, roughness: f32) -> Dfg<f32> {
    from_array(bilinear(&albedos::GGX, n_dot_v, roughness))
}

/// Reads the table of the Cook-Torrance lobe: Beckmann's distribution between V-shaped cavities.
///
/// `n_dot_v` in [0, 1]; `slope` at least 0, clamped to 1.
/// Law: within 0.5 % of the quadrature (`laws::energy::tables_are_exact_between_their_nodes`).
pub fn of_cook_torrance(n_dot_v: f32, slope: f32) -> Dfg<f32> {
    from_array(bilinear(&albedos::COOK_TORRANCE, n_dot_v, slope.max(0.0).sqrt()))
}

/// The fraction of light that white sheen reflects, [0, 2].
///
/// The lobe as published reflects more light than it receives if seen edge-on: up to 1.9 times at n·v below 0.1 and
/// roughness below 0.3.
///
/// `n_dot_v` and `roughness` in [0, 1].
/// Law: within 1 % of the quadrature (`laws::energy::sheen_reflects_what_its_table_says_and_no_more_than_arrives`).
pub fn of_sheen(n_dot_v: f32, roughness: f32) -> f32 {
    bilinear(&albedos::SHEEN, n_dot_v, roughness)[0]
}

fn from_array([scale, bias, edge, diffuse_edge]: [f32; 4]) -> Dfg<f32> {
    Dfg { scale, bias, edge, diffuse_edge }
}

/// The cosine at column `i` of a table.
pub fn column_cosine(i: usize) -> f64 {
    let t = i as f64 / (COLUMNS - 1) as f64;
    t * t
}

/// The roughness at row `j` of a table.
pub fn row_roughness(j: usize) -> f64 {
    j as f64 / (ROWS - 1) as f64
}

/// A position in a table.
#[derive(Debug, Clone, Copy)]
pub struct TablePosition<L> {
    /// The lower node, an integer: its row times [`COLUMNS`] plus its column.
    pub node: L,
    /// The fraction of the way from this node to the next along the cosine, [0, 1].
    pub across: L,
    /// The same along the roughness.
    pub down: L,
}

impl<L: Lane> TablePosition<L> {
    /// Finds the position for `n_dot_v` and `roughness` in [0, 1].
    #[inline(always)]
    pub fn of_ggx(n_dot_v: L, roughness: L) -> Self {
        let (i, across) = node(n_dot_v.max(n_dot_v.lit(0.0)).sqrt(), COLUMNS);
        let (j, down) = node(roughness, ROWS);
        Self { node: j * j.lit(COLUMNS as f64) + i, across, down }
    }

    /// Finds the position for `n_dot_v` in [0, 1] and a `slope` of at least 0.
    #[inline(always)]
    pub fn of_cook_torrance(n_dot_v: L, slope: L) -> Self {
        Self::of_ggx(n_dot_v, slope.max(slope.lit(0.0)).sqrt())
    }
}

/// A table of directional albedos.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AlbedoTable {
    /// The table of GGX's lobe.
    Ggx,
    /// The table of Cook-Torrance's lobe.
    CookTorrance,
    /// The table of white sheen, whose only number is [`Dfg::scale`].
    Sheen,
}

impl<L: Number> TablePosition<L> {
    /// Reads a table at this position.
    pub fn read(&self, table: AlbedoTable) -> Dfg<L> {
        let (node, shares) = (self.node.index(), [self.across, self.down]);
        let [scale, bias, edge, diffuse_edge] = match table {
            AlbedoTable::Ggx => between(&albedos::GGX, node, shares),
            AlbedoTable::CookTorrance => between(&albedos::COOK_TORRANCE, node, shares),
            AlbedoTable::Sheen => {
                let [albedo] = between(&albedos::SHEEN, node, shares);
                let zero = albedo.lit(0.0);
                [albedo, zero, zero, zero]
            }
        };
        Dfg { scale, bias, edge, diffuse_edge }
    }
}

impl Dfg<f32> {
    /// The values of GGX's lobe at a position, in the order of the fields.
    #[inline]
    pub fn of_ggx_at(node: u32, shares: [f32; 2]) -> [f32; 4] {
        between(&albedos::GGX, node as usize, shares)
    }

    /// The values of Cook-Torrance's lobe at a position, in the order of the fields.
    #[inline]
    pub fn of_cook_torrance_at(node: u32, shares: [f32; 2]) -> [f32; 4] {
        between(&albedos::COOK_TORRANCE, node as usize, shares)
    }
}

fn bilinear<const N: usize>(table: &[[f32; N]; COLUMNS * ROWS], n_dot_v: f32, roughness: f32) -> [f32; N] {
    let TablePosition { node, across, down } = TablePosition::of_ggx(n_dot_v, roughness);
    between(table, node as usize, [across, down])
}

#[inline]
fn between<L: Lane, const N: usize>(
    table: &[[f32; N]; COLUMNS * ROWS],
    node: usize,
    [across, down]: [L; 2],
) -> [L; N] {
    let node = node.min(COLUMNS * (ROWS - 1) - 2);
    let corners = [&table[node], &table[node + 1], &table[node + COLUMNS], &table[node + COLUMNS + 1]];
    from_fn(|n| {
        let at = |corner: usize| across.lit(f64::from(corners[corner][n]));
        between_entries([at(0), at(1), at(2), at(3)], [across, down])
    })
}

/// The value of a table interpolated between four entries: the node, the next along the cosine, and the two below;
/// `across` and `down` in [0, 1] as in [`TablePosition`].
#[inline(always)]
pub fn between_entries<L: Lane>([a, b, c, d]: [L; 4], [across, down]: [L; 2]) -> L {
    let top = a + (b - a) * across;
    let bottom = c + (d - c) * across;
    top + (bottom - top) * down
}

/// All tables as one image, [`COLUMNS`] texels wide: [`ROWS`] rows of GGX, as many of Cook-Torrance, both with the
/// fields of [`Dfg`] in order, and as many of sheen, in the first channel.
pub fn tables() -> Vec<[f32; 4]> {
    let lobes = albedos::GGX.iter().chain(&albedos::COOK_TORRANCE).copied();
    lobes.chain(albedos::SHEEN.iter().map(|[albedo]| [*albedo, 0.0, 0.0, 0.0])).collect()
}

/// The node below `x` in [0, 1] among `count` nodes, and the fraction of the way from it to the next.
#[inline(always)]
fn node<L: Lane>(x: L, count: usize) -> (L, L) {
    let scaled = x.clamp(0.0, 1.0) * x.lit((count - 1) as f64);
    let node = scaled.floor().min(x.lit((count - 2) as f64));
    (node, scaled - node)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_of_all_tables_has_their_entries_at_the_nodes() {
        let tables = tables();
        assert_eq!(tables.len(), 3 * COLUMNS * ROWS);
        for (i, j) in [(3, 5), (20, 30), (63, 47), (40, 10)] {
            let (n_dot_v, roughness) = (column_cosine(i) as f32, row_roughness(j) as f32);
            let at = |table: usize| tables[(table * ROWS + j) * COLUMNS + i];
            let numbers = |dfg: Dfg<f32>| [dfg.scale, dfg.bias, dfg.edge, dfg.diffuse_edge];
            let near = |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
            assert!(near(at(0), numbers(of_ggx(n_dot_v, roughness))), "{i} {j}");
            assert!(near(at(1), numbers(of_cook_torrance(n_dot_v, roughness * roughness))), "{i} {j}");
            assert!((at(2)[0] - of_sheen(n_dot_v, roughness)).abs() < 1e-4, "{i} {j}");
        }
    }
}
