//! Checks of the model as a whole: the size of the file and the number of its parts, the edges of its meshes, and its
//! dimensions.

use super::check::{AuditRange, Check, CheckResult, counted, number, rounded};
use super::schema::{
    AuditSchema, DimensionSchema, DimensionsSchema, ModelSchema, ProductDimensions, ProductInfo,
};
use taotie_engine::groups::Groups;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::parallel;
use taotie_engine::scene::Scene;
use taotie_engine::surface::by_position;
use taotie_io::{GltfStructure, Loaded, RootNode, listed};

/// Checks the size of the file and the number of its parts.
pub(super) fn counts(loaded: &Loaded, schema: &AuditSchema) -> Vec<CheckResult> {
    let (model, objects) = (&schema.model, &schema.model.object_count);
    let of_document = |check, count: fn(&GltfStructure) -> usize, range: AuditRange| match &loaded.structure {
        Some(structure) => CheckResult::of_value(check, (count(structure) as f64, ""), range),
        None => not_gltf(check, loaded),
    };
    vec![
        file_size(loaded.bytes, schema.file_size_in_kb),
        CheckResult::of_value(Check::TriangleCount, (triangles(loaded) as f64, ""), model.triangles),
        CheckResult::of_value(Check::MaterialCount, (materials(loaded) as f64, ""), schema.materials),
        of_document(Check::NodeCount, |all| all.nodes, objects.nodes),
        of_document(Check::MeshCount, |all| all.meshes, objects.meshes),
        of_document(Check::PrimitiveCount, |all| all.primitives, objects.primitives),
        clean_root_transform(loaded, model.require_clean_root_node_transform),
    ]
}

fn not_gltf(check: Check, loaded: &Loaded) -> CheckResult {
    CheckResult::not_tested(check, format!("not a glTF file but {}", loaded.format))
}

/// Whole KiB, as the auditor counts.
fn file_size(bytes: Option<u64>, range: AuditRange) -> CheckResult {
    match bytes {
        Some(bytes) => {
            let size = (bytes as f64 / 1024.0).round();
            CheckResult::of_value(Check::FileSize, (size, " KiB"), range)
        }
        None => CheckResult::not_tested(Check::FileSize, "the model was not read from a file"),
    }
}

fn triangles(loaded: &Loaded) -> usize {
    let of_meshes = || loaded.scene.meshes().iter().map(|mesh| mesh.triangles().len()).sum();
    loaded.structure.as_ref().map_or_else(of_meshes, |structure| structure.triangles)
}

fn materials(loaded: &Loaded) -> usize {
    let of_scene = loaded.scene.materials().len();
    loaded.structure.as_ref().map_or(of_scene, |structure| structure.materials)
}

fn clean_root_transform(loaded: &Loaded, required: bool) -> CheckResult {
    let check = Check::CleanRootTransform;
    let Some(structure) = &loaded.structure else { return not_gltf(check, loaded) };
    let is_unclean = |root: &&RootNode| root.world_from_node != Mat4::IDENTITY;
    let unclean: Vec<String> = structure.roots.iter().filter(is_unclean).map(displaced).collect();
    let message = match unclean.as_slice() {
        [] => "root nodes neither move, rotate nor scale".to_owned(),
        unclean => listed(unclean),
    };
    match required {
        true => CheckResult::of_faults(check, unclean.len(), message),
        false => CheckResult::not_tested(check, message),
    }
}

/// Returns the name of a root node and a description of its transform.
fn displaced(root: &RootNode) -> String {
    let matrix = &root.world_from_node;
    let vector = |v: Vec3<f64>| v.to_array().map(number).join(" ");
    let lengths = Vec3::new(matrix.axis(0).length(), matrix.axis(1).length(), matrix.axis(2).length());
    let mut does = Vec::new();
    if matrix.axis(3).length() > 0.0 {
        does.push(format!("moves by {}", vector(matrix.axis(3))));
    }
    let is_scaled = lengths.to_array().iter().any(|length| (length - 1.0).abs() > 1e-9);
    if is_scaled {
        does.push(format!("scales by {}", vector(lengths)));
    }
    let stretched = Mat4::scale(lengths);
    let is_rotated = (0..3).any(|j| (matrix.axis(j) - stretched.axis(j)).length() > 1e-9 * lengths.length());
    if is_rotated {
        does.push("rotates".into());
    }
    format!("'{}' {}", root.name, does.join(", "))
}

/// The cosine at which faces meet at 90° or more, with two thousandths of a degree for rounding.
const RIGHT_ANGLE: f64 = 3e-5;

const NOT_REQUIRED: &str = "not required";

/// The edges of a mesh that a check counts. Vertices at bit-identical positions count as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Edges {
    /// Edges of two faces whose normals are 90° or more apart.
    hard: usize,
    /// Edges of more than two faces.
    non_manifold: usize,
    /// Edges of one face.
    open: usize,
}

/// Checks the edges of all meshes, if the schema asks.
pub(super) fn edges(scene: &Scene, schema: &ModelSchema) -> Vec<CheckResult> {
    let (beveled, manifold) = (schema.require_beveled_edges, schema.require_manifold_edges);
    let mut all = Edges::default();
    if beveled || manifold {
        scene.meshes().iter().for_each(|mesh| all.add(Edges::of(mesh)));
    }
    let hard = format!("{} of 90° or more (at most 0)", counted(all.hard, "hard edge"));
    let crowded = counted(all.non_manifold, "edge");
    let crowded = format!("{crowded} of more than two faces (at most 0), {} open", counted(all.open, "edge"));
    let result = |check, required: bool, faults: usize, what: String| match required {
        true => CheckResult::of_faults(check, faults, what),
        false => CheckResult::not_tested(check, NOT_REQUIRED),
    };
    vec![
        result(Check::BeveledEdges, beveled, all.hard, hard),
        result(Check::ManifoldEdges, manifold, all.non_manifold, crowded),
    ]
}

impl Edges {
    fn of(mesh: &Mesh) -> Self {
        let places = by_position(mesh.positions());
        // Each edge with its triangle, grouped by the lower of the two positions that it joins.
        let entries = || {
            mesh.triangles().iter().enumerate().flat_map(|(triangle, corners)| {
                let [a, b, c] = corners.map(|corner| places.of[corner as usize]);
                let collapsed = a == b || b == c || c == a;
                let edges = [(a, b), (b, c), (c, a)].into_iter().filter(move |_| !collapsed);
                edges.map(move |(p, q)| (p.min(q) as usize, (p.max(q), triangle as u32)))
            })
        };
        let edges = Groups::new(places.firsts.len(), entries);
        let sums = parallel::fold(edges.count(), |sum: &mut Self, place| {
            let mut from_here = edges.of(place).to_vec();
            from_here.sort_unstable();
            for edge in from_here.chunk_by(|a, b| a.0 == b.0) {
                sum.count(mesh, edge);
            }
        });
        let mut all = Self::default();
        sums.into_iter().for_each(|sum| all.add(sum));
        all
    }

    /// Counts an edge with its faces.
    fn count(&mut self, mesh: &Mesh, faces: &[(u32, u32)]) {
        match faces {
            [_] => self.open += 1,
            [(_, one), (_, other)] => self.hard += usize::from(is_hard(mesh, [*one, *other])),
            _ => self.non_manifold += 1,
        }
    }

    fn add(&mut self, other: Self) {
        self.hard += other.hard;
        self.non_manifold += other.non_manifold;
        self.open += other.open;
    }
}

/// Returns true if the normals of two faces are 90° or more apart. Faces without area have none.
fn is_hard(mesh: &Mesh, faces: [u32; 2]) -> bool {
    let [n, m]: [Vec3<f64>; 2] = faces.map(|face| {
        let [a, b, c] = mesh.corners(face as usize).map(Vec3::to_f64);
        (b - a).cross(c - a)
    });
    let lengths = n.length() * m.length();
    lengths > 0.0 && n.dot(m) <= RIGHT_ANGLE * lengths
}

/// Dimensions are rounded to a micrometre.
const SIZE_STEPS: f64 = 1e6;

/// A dimension of the model with its limits in the schema.
struct Dimension {
    name: &'static str,
    /// Metres.
    size: f64,
    schema: DimensionSchema,
}

/// Checks the dimensions of a scene.
pub(super) fn dimensions(
    scene: &Scene,
    schema: &DimensionsSchema,
    product: Option<&ProductInfo>,
) -> Vec<CheckResult> {
    let checks = [Check::OverallDimensions, Check::ProductDimensions];
    let Some(all) = measured(scene, schema) else {
        return checks.map(|check| CheckResult::not_tested(check, "nothing is drawn")).into();
    };
    vec![overall(&all), of_product(&all, product)]
}

/// Returns length, width and height: the extents along x, z and y, as the auditor defines them.
fn measured(scene: &Scene, schema: &DimensionsSchema) -> Option<[Dimension; 3]> {
    let bounds = scene.bounds()?;
    let [x, y, z] = (bounds.max - bounds.min).to_array().map(|size| rounded(size, SIZE_STEPS));
    Some([
        Dimension { name: "length", size: x, schema: schema.length },
        Dimension { name: "width", size: z, schema: schema.width },
        Dimension { name: "height", size: y, schema: schema.height },
    ])
}

fn overall(all: &[Dimension; 3]) -> CheckResult {
    let check = Check::OverallDimensions;
    let range = |dimension: &Dimension| {
        let DimensionSchema { minimum, maximum, .. } = dimension.schema;
        AuditRange { minimum, maximum }
    };
    let words = |dimension: &Dimension| match range(dimension) {
        range if range.is_limited() => format!("{} ({})", metres(dimension), range.words()),
        _ => metres(dimension),
    };
    let message = all.iter().map(words).collect::<Vec<_>>().join(", ");
    match all.iter().any(|dimension| range(dimension).is_limited()) {
        true => {
            let passes = all.iter().all(|dimension| range(dimension).allows(dimension.size));
            CheckResult::tested(check, passes, message)
        }
        false => CheckResult::not_tested(check, message),
    }
}

fn of_product(all: &[Dimension; 3], product: Option<&ProductInfo>) -> CheckResult {
    let check = Check::ProductDimensions;
    let Some(product) = product else {
        return CheckResult::not_tested(check, "no product info given");
    };
    let ProductDimensions { length, width, height } = product.dimensions;
    let pairs = all.iter().zip([length, width, height]);
    let compared = pairs.filter_map(|(dimension, wanted)| Some((dimension, wanted?)));
    let (mut passes, mut messages) = (true, Vec::new());
    for (dimension, wanted) in compared {
        let percent = dimension.schema.percent_tolerance.unwrap_or(0.0);
        let margin = wanted * percent / 100.0;
        passes &= (dimension.size - wanted).abs() <= margin + 0.5 / SIZE_STEPS;
        messages.push(format!("{} ({} m ± {} %)", metres(dimension), number(wanted), number(percent)));
    }
    CheckResult::tested(check, passes, messages.join(", "))
}

fn metres(dimension: &Dimension) -> String {
    format!("{} {} m", dimension.name, number(dimension.size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::mesh::MeshData;

    fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
        let positions = positions.iter().map(|p| Vec3::from_array(*p)).collect();
        Mesh::new(MeshData { positions, triangles: triangles.to_vec(), ..MeshData::default() }).unwrap()
    }

    /// Two faces sharing the edge from 0 to 1, the second one rotated out of the plane of the first by an angle.
    fn folded(cosine: f32, sine: f32) -> Edges {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -cosine, -sine]];
        Edges::of(&mesh(&corners, &[[0, 1, 2], [1, 0, 3]]))
    }

    #[test]
    fn edges_are_hard_from_a_right_angle_on() {
        assert_eq!(folded(1.0, 0.0), Edges { hard: 0, non_manifold: 0, open: 4 });
        assert_eq!(folded(0.0175, 0.9998).hard, 0, "89 degrees");
        assert_eq!(folded(0.0, 1.0).hard, 1, "90 degrees");
        assert_eq!(folded(-0.8, 0.6).hard, 1);
    }

    /// A corner that is stored twice, with two uvs, is one position.
    #[test]
    fn vertices_at_the_same_place_are_one() {
        let corners =
            [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let split = Edges::of(&mesh(&corners, &[[0, 1, 2], [4, 3, 5]]));
        assert_eq!(split, Edges { hard: 1, non_manifold: 0, open: 4 });
        let third = [&corners[..], &[[0.0, -1.0, 0.0]]].concat();
        let crowded = Edges::of(&mesh(&third, &[[0, 1, 2], [4, 3, 5], [1, 0, 6]]));
        assert_eq!(crowded, Edges { hard: 0, non_manifold: 1, open: 6 });
    }

    #[test]
    fn collapsed_triangles_have_no_edges() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]];
        assert_eq!(Edges::of(&mesh(&corners, &[[0, 1, 2]])), Edges::default());
    }
}
