//! The size of the file and the number of its parts.

use super::check::{Check, CheckResult};
use super::range::AuditRange;
use super::schema::AuditSchema;
use super::words::{listed, number};
use crate::io::{GltfStructure, Loaded, RootNode};
use crate::math::{Mat4, Vec3};

/// Checks the size of the file and the number of its parts.
pub(super) fn results(loaded: &Loaded, schema: &AuditSchema) -> Vec<CheckResult> {
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
