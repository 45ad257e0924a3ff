//! The cause of a gross mismatch: a change of the whole asset that, if undone, brings it onto its scan.

use crate::bake::Scan;
use crate::length::Unit;
use crate::math::Vec3;
use crate::mesh::{Mesh, Point, sample_area};
use crate::names::Named;
use crate::parallel;
use crate::scene::Bounds;

/// Number of points of each surface with which a change is tried, and with which the best one is confirmed.
const FEW: usize = 300;
const POINTS: usize = 2_000;
/// Surfaces closer than this fraction of the diagonal on average are in the same place.
const NEAR: f64 = 0.003;
/// Without the change the asset is closer to the scan than this fraction of the diagonal on average.
const ON_SCAN: f64 = 0.005;
/// Without the change the surfaces are closer by at least this factor.
const TIMES: f64 = 3.0;
/// Changes whose distances differ by less than this ratio are equally good, since objects may be symmetric.
const EQUAL: f64 = 1.25;
/// The sides of the boxes differ by less than this fraction of the diagonal, and the diagonals by less than this
/// fraction.
const SIDES: f64 = 0.1;
const SIZES: f64 = 0.08;

/// A change of a whole asset, as made by programs that use another up axis, unit or origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mismatch {
    axes: Axes,
    /// The units of the asset's and of the scan's coordinates, if they differ.
    pub units: Option<[Unit; 2]>,
    /// The offset from the scan to the asset, in model units of the scan; `None` if both have the same origin.
    pub moved: Option<[f64; 3]>,
    /// The mean distance between the surfaces as a fraction of the diagonal.
    pub distance: f64,
    /// The same without the change.
    pub without: f64,
}

impl Mismatch {
    /// Finds the change that explains why an asset is not on its scan; `None` if it is, or if no change explains it.
    /// If `is_off`, the asset differs so much in other ways that the cause is searched even if it is near its scan,
    /// such as a mirrored face.
    pub fn find(scan: &Scan, asset: &Scan, is_off: bool) -> Option<Self> {
        let pair = Surfaces::of(scan, asset)?;
        let before = pair.distances(&Placement::NONE, POINTS)?;
        if before.mean() < NEAR && !is_off {
            return None;
        }
        let candidates: Vec<Placement> = pair.placements();
        let tried =
            candidates.iter().map(|placement| Some((placement, pair.distances(placement, FEW)?.mean())));
        let tried: Vec<(&Placement, f64)> = tried.collect::<Option<_>>()?;
        let least = tried.iter().map(|(_, distance)| *distance).fold(f64::INFINITY, f64::min);
        let (placement, _) = tried.into_iter().find(|(_, distance)| *distance <= least * EQUAL)?;
        let after = pair.distances(placement, POINTS)?;
        if after.of_asset > ON_SCAN || after.mean() * TIMES >= before.mean() {
            return None;
        }
        let moved = placement.shift.map(|shift| shift.map(|v| 0.0 - v));
        let (units, distance, without) = (placement.units, before.mean(), after.mean());
        Some(Self { axes: placement.axes, units, moved, distance, without })
    }

    /// Describes the axes of the asset in words, such as `turned by 90° about x`; `None` if they are the scan's.
    pub fn axes_text(&self) -> Option<String> {
        (self.axes != Axes::SAME).then(|| self.axes.text())
    }

    /// Returns the size of the asset relative to the scan.
    pub fn size(&self) -> f64 {
        self.units.map_or(1.0, |[asset, scan]| scan.metres() / asset.metres())
    }
}

/// The axes of a scan in terms of the asset's: coordinate i of the scan is the asset's axis `from[i]`, or its
/// negative.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axes {
    from: [usize; 3],
    negative: [bool; 3],
}

/// The names of axes.
const NAMES: [&str; 3] = ["x", "y", "z"];

impl Axes {
    const SAME: Self = Self { from: [0, 1, 2], negative: [false; 3] };

    /// Returns all 48 ways to swap and reverse axes: first the rotations, simplest first, then the reflections.
    fn all() -> Vec<Self> {
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [2, 1, 0], [1, 0, 2], [1, 2, 0], [2, 0, 1]];
        let signs = |of: u8| [0, 1, 2].map(|i| of >> i & 1 != 0);
        let of = |from: [usize; 3]| (0..8).map(move |sign| Self { from, negative: signs(sign) });
        let mut all: Vec<Self> = ORDERS.into_iter().flat_map(of).collect();
        all.sort_by_key(|axes| (axes.mirrors(), 3 - axes.kept().len()));
        all
    }

    /// Returns the axes that are unchanged.
    fn kept(&self) -> Vec<usize> {
        (0..3).filter(|i| self.from[*i] == *i && !self.negative[*i]).collect()
    }

    /// Returns `true` if an object and its image have opposite handedness.
    fn mirrors(&self) -> bool {
        let is_odd = (0..3).filter(|i| self.from[*i] == *i).count() == 1;
        let negatives = self.negative.iter().filter(|negative| **negative).count();
        is_odd != (negatives % 2 == 1)
    }

    /// Converts a point from the asset's axes to the scan's.
    fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| if self.negative[i] { -p[self.from[i]] } else { p[self.from[i]] })
    }

    /// Converts a point from the scan's axes to the asset's.
    fn invert(&self, p: [f64; 3]) -> [f64; 3] {
        let mut found = [0.0; 3];
        for i in 0..3 {
            found[self.from[i]] = if self.negative[i] { -p[i] } else { p[i] };
        }
        found
    }

    /// Describes the asset as seen from the scan.
    fn text(&self) -> String {
        match (self.mirrors(), &self.kept()[..]) {
            (false, [axis]) => {
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                let angle = match self.negative {
                    negative if negative[u] && negative[v] => "180°",
                    // A quarter about x takes y to z: the scan's y is the asset's z.
                    negative if negative[v] => "90°",
                    _ => "−90°",
                };
                let up = match (axis, angle) {
                    (0, "90°") => " (Z up instead of Y up)",
                    (0, "−90°") => " (Y up instead of Z up)",
                    _ => "",
                };
                format!("turned by {angle} about {}{up}", NAMES[*axis])
            }
            (true, [u, v]) => format!("mirrored in {}", NAMES[3 - u - v]),
            (true, [axis]) if !self.negative.contains(&true) => {
                format!("mirrored: {} and {} are swapped", NAMES[(axis + 1) % 3], NAMES[(axis + 2) % 3])
            }
            (mirrors, _) => {
                let name =
                    |i: usize| format!("{}{}", if self.negative[i] { "−" } else { "" }, NAMES[self.from[i]]);
                let how = if mirrors { "mirrored" } else { "turned" };
                format!("{how}: the scan's x, y and z are its {}, {} and {}", name(0), name(1), name(2))
            }
        }
    }
}

/// A way to align an asset with its scan: axes, then scale, then shift.
#[derive(Debug, Clone, Copy)]
struct Placement {
    axes: Axes,
    units: Option<[Unit; 2]>,
    shift: Option<[f64; 3]>,
}

impl Placement {
    const NONE: Self = Self { axes: Axes::SAME, units: None, shift: None };

    fn scale(&self) -> f64 {
        self.units.map_or(1.0, |[asset, scan]| asset.metres() / scan.metres())
    }

    fn onto_scan(&self, p: Vec3) -> Vec3 {
        let (p, shift) = (self.axes.apply(p.to_f64().to_array()), self.shift.unwrap_or_default());
        Vec3::from_array([0, 1, 2].map(|i| p[i] * self.scale() + shift[i])).to_f32()
    }

    fn onto_asset(&self, p: Vec3) -> Vec3 {
        let (p, shift) = (p.to_f64().to_array(), self.shift.unwrap_or_default());
        let p = self.axes.invert([0, 1, 2].map(|i| (p[i] - shift[i]) / self.scale()));
        Vec3::from_array(p).to_f32()
    }
}

/// Mean distances as fractions of the scan's diagonal.
#[derive(Debug, Clone, Copy)]
struct Distances {
    of_asset: f64,
    of_scan: f64,
}

impl Distances {
    fn mean(&self) -> f64 {
        0.5 * (self.of_asset + self.of_scan)
    }
}

/// The surfaces, and their boxes: centres and sides.
struct Surfaces<'a> {
    scan: &'a Scan,
    asset: &'a Scan,
    boxes: [[[f64; 3]; 2]; 2],
    diagonal: f64,
}

impl<'a> Surfaces<'a> {
    fn of(scan: &'a Scan, asset: &'a Scan) -> Option<Self> {
        let boxes = [box_of(scan.mesh())?, box_of(asset.mesh())?];
        let diagonal = length(boxes[0][1]);
        (diagonal > 0.0).then_some(Self { scan, asset, boxes, diagonal })
    }

    /// Returns the ways to align the asset's box with the scan's, those about the origin first.
    fn placements(&self) -> Vec<Placement> {
        let [[scan_middle, scan_sides], [middle, sides]] = self.boxes;
        let Some(units) = self.units(self.diagonal / length(sides)) else { return Vec::new() };
        let fits = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() <= SIDES * self.diagonal);
        let [mut here, mut moved] = [Vec::new(), Vec::new()];
        for axes in Axes::all() {
            let placement = Placement { axes, units, shift: None };
            let [middle, sides] = [middle, sides].map(|v| axes.apply(v).map(|v| v * placement.scale()));
            if !fits(sides.map(f64::abs), scan_sides) {
                continue;
            }
            if fits(middle, scan_middle) {
                here.push(placement);
            }
            let shift = Some([0, 1, 2].map(|i| scan_middle[i] - middle[i]));
            moved.push(Placement { shift, ..placement });
        }
        here.extend(moved);
        here
    }

    /// Returns the units of asset and scan that explain this ratio of their sizes: `Some(None)` if they are the same,
    /// `None` if none explain it.
    fn units(&self, ratio: f64) -> Option<Option<[Unit; 2]>> {
        let fits = |explained: f64| (ratio / explained - 1.0).abs() < SIZES;
        if fits(1.0) {
            return Some(None);
        }
        let units = || Unit::NAMES.iter().map(|(_, unit)| *unit);
        let mut pairs = units().flat_map(|asset| units().map(move |scan| [asset, scan]));
        pairs.find(|[asset, scan]| fits(asset.metres() / scan.metres())).map(Some)
    }

    /// Measures the distances from `count` points of each surface to the other.
    fn distances(&self, placement: &Placement, count: usize) -> Option<Distances> {
        let points =
            [sample_area(self.asset.mesh(), count).ok()?, sample_area(self.scan.mesh(), count).ok()?];
        let mean = |distance: &(dyn Fn(usize) -> Option<f32> + Sync)| {
            let found = parallel::collect(count, |i| distance(i).unwrap_or_default());
            found.into_iter().map(f64::from).sum::<f64>() / count as f64 / self.diagonal
        };
        let at = |of: &Scan, point: Point| point.position(of.mesh());
        let closest = |to: &Scan, p: Vec3| Some(to.bvh().closest(p, f32::INFINITY)?.distance);
        let of_asset = |i| closest(self.scan, placement.onto_scan(at(self.asset, points[0](i))));
        let of_scan = |i| closest(self.asset, placement.onto_asset(at(self.scan, points[1](i))));
        Some(Distances { of_asset: mean(&of_asset), of_scan: mean(&of_scan) * placement.scale() })
    }
}

/// Returns the centre and the sides of the box around a mesh's triangles; `None` without any.
fn box_of(mesh: &Mesh) -> Option<[[f64; 3]; 2]> {
    let corners = (0..mesh.triangles().len()).flat_map(|t| mesh.corners(t));
    let bounds = Bounds::around(corners.map(Vec3::to_f64))?;
    Some([bounds.center().to_array(), (bounds.max - bounds.min).to_array()])
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    Vec3::new(x, y, z).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;
    use crate::scene::{Material, Scene};

    /// A distorted ball that no rotation and no reflection maps to itself.
    fn lump([columns, rows]: [usize; 2], change: impl Fn([f64; 3]) -> [f64; 3]) -> Scan {
        let data = Mesh::sphere(1.0, columns, rows).into_data();
        let place = |p: &Vec3| {
            let [x, y, z] = p.to_f64().to_array();
            let bump = 0.25 * x.max(0.0) * y.max(0.0) + 0.15 * y.max(0.0) * z.max(0.0);
            let r = 1.0 + bump + 0.2 * z.max(0.0) * z.max(0.0);
            Vec3::from_array(change([r * x + 0.3, 0.9 * r * y + 0.2, 0.95 * r * z])).to_f32()
        };
        let positions = data.positions.iter().map(place).collect();
        let mesh = MeshData { positions, triangles: data.triangles, ..MeshData::default() };
        Scan::new(Scene::of_mesh(Mesh::new(mesh).unwrap(), Material::default()).unwrap()).unwrap()
    }

    fn found(change: impl Fn([f64; 3]) -> [f64; 3]) -> Option<Mismatch> {
        Mismatch::find(&lump([96, 48], |p| p), &lump([40, 20], change), true)
    }

    #[test]
    fn all_axes_are_different_and_come_back() {
        let all = Axes::all();
        assert_eq!((all.len(), all[0]), (48, Axes::SAME));
        assert_eq!(all.iter().position(Axes::mirrors), Some(24));
        let p = [1.0, 2.0, 3.0];
        for (i, axes) in all.iter().enumerate() {
            assert_eq!(axes.invert(axes.apply(p)), p);
            assert!(all[..i].iter().all(|other| other.apply(p) != axes.apply(p)));
        }
        let names: Vec<String> = all.iter().skip(1).map(Axes::text).collect();
        assert!(names.iter().enumerate().all(|(i, name)| !names[..i].contains(name)), "{names:?}");
    }

    #[test]
    fn a_change_of_the_whole_asset_is_named() {
        let turned = found(|[x, y, z]| [x, -z, y]).unwrap();
        assert_eq!(turned.axes_text().unwrap(), "turned by 90° about x (Z up instead of Y up)");
        assert!((turned.units, turned.moved) == (None, None) && turned.without < 0.002, "{turned:?}");
        let text = |change: fn([f64; 3]) -> [f64; 3]| found(change).unwrap().axes_text().unwrap();
        assert_eq!(text(|[x, y, z]| [x, z, -y]), "turned by −90° about x (Y up instead of Z up)");
        assert_eq!(text(|[x, y, z]| [z, y, -x]), "turned by 90° about y");
        assert_eq!(text(|[x, y, z]| [-x, -y, z]), "turned by 180° about z");
        assert_eq!(text(|[x, y, z]| [x, y, -z]), "mirrored in z");
        assert_eq!(text(|[x, y, z]| [y, x, z]), "mirrored: x and y are swapped");
        assert_eq!(text(|[x, y, z]| [y, z, x]), "turned: the scan's x, y and z are its z, x and y");
        let size = |factor: f64| found(move |p| p.map(|v| v * factor)).unwrap();
        for factor in [1000.0, 0.001, 0.01, 25.4, 1.0 / 2.54] {
            let found = size(factor);
            assert!((found.size() / factor - 1.0).abs() < 1e-6 && found.axes_text().is_none(), "{found:?}");
        }
        let both = found(|[x, y, z]| [1000.0 * x, -1000.0 * z, 1000.0 * y]).unwrap();
        assert_eq!(both.units, Some([Unit::Millimetre, Unit::Metre]));
        assert!(both.axes_text().unwrap().starts_with("turned by 90° about x"));
        let moved = found(|[x, y, z]| [x, y + 0.5, z]).unwrap().moved.unwrap();
        assert!((moved[1] - 0.5).abs() < 0.02 && moved[0].abs() < 0.02 && moved[2].abs() < 0.02, "{moved:?}");
    }

    #[test]
    fn other_differences_are_not_named() {
        assert_eq!(found(|p| p), None);
        assert_eq!(found(|[x, y, z]| [x, y.max(0.4), z]), None, "a part is missing");
        assert_eq!(found(|p| p.map(|v| v * 1.3)), None, "no unit explains this factor");
        assert_eq!(found(|[x, y, z]| [x + 0.4 * y * y, y, z]), None, "another shape");
    }
}
