//! Repairs a mesh's arrays, as read or as deformed, and counts each kind of repair.

use super::MeshData;
use crate::error::Warnings;
use crate::math::{Vec2, Vec3};
use crate::parallel;

/// Makes normals unit and finite, adds flat ones if there are none, and cleans uvs, colours and tangents.
pub fn repair(data: &mut MeshData, warnings: &mut Warnings) {
    let mut note = |what: &str, count| warnings.note(what, count);
    if data.normals.is_empty() {
        *data = with_flat_normals(data);
    } else {
        note("normals that were zero or NaN, taken from the faces", mend_normals(data));
    }
    note("tangents that were zero or NaN; all are recomputed", mend_tangents(data));
    note("uvs that were infinite, NaN or beyond ±1e12, set to 0", mend_uvs(&mut data.uvs));
    note("vertex colours that were infinite or NaN, set to white", mend_colors(&mut data.colors));
}

/// Returns the mesh with three separate vertices per triangle and the face's normal. Tangents are dropped, as glTF
/// 2.0, 3.7.2.1 specifies.
pub fn with_flat_normals(data: &MeshData) -> MeshData {
    let corners = data.triangles.as_flattened();
    let normal = |t: &[u32; 3]| face_vector(data, t).normalize_or(Vec3::new(0.0, 0.0, 1.0)).to_f32();
    let normals: Vec<[Vec3; 3]> =
        parallel::collect(data.triangles.len(), |i| [normal(&data.triangles[i]); 3]);
    MeshData {
        positions: taken(&data.positions, corners),
        normals: normals.into_flattened(),
        tangents: Vec::new(),
        uvs: data.uvs.iter().map(|uvs| taken(uvs, corners)).collect(),
        colors: if data.colors.is_empty() { Vec::new() } else { taken(&data.colors, corners) },
        triangles: parallel::collect(data.triangles.len(), |i| {
            let first = 3 * i as u32;
            [first, first + 1, first + 2]
        }),
    }
}

/// Returns the value at each index.
fn taken<T: Copy + Default + Send + Sync>(values: &[T], indices: &[u32]) -> Vec<T> {
    parallel::collect(indices.len(), |i| values[indices[i] as usize])
}

/// The face's normal times twice its area.
fn face_vector(data: &MeshData, triangle: &[u32; 3]) -> Vec3<f64> {
    let at = |i: u32| data.positions[i as usize].to_f64();
    let (a, b, c) = (at(triangle[0]), at(triangle[1]), at(triangle[2]));
    (b - a).cross(c - a)
}

fn mend_normals(data: &mut MeshData) -> usize {
    let usable = |n: &Vec3| n.is_finite() && n.to_f64().length() > 1e-18;
    let bad = parallel::filter(data.normals.len(), |i| !usable(&data.normals[i]));
    if !bad.is_empty() {
        let faces = area_weighted_normals(data);
        bad.iter().for_each(|i| data.normals[*i] = faces[*i]);
    }
    parallel::change(&mut data.normals, |_, normal| *normal = normal.to_f64().normalize().to_f32());
    bad.len()
}

fn area_weighted_normals(data: &MeshData) -> Vec<Vec3> {
    let mut sums = vec![Vec3::splat(0.0); data.positions.len()];
    for triangle in &data.triangles {
        let face = face_vector(data, triangle);
        triangle.iter().for_each(|i| sums[*i as usize] += face);
    }
    sums.into_iter().map(|s| s.normalize_or(Vec3::new(0.0, 0.0, 1.0)).to_f32()).collect()
}

/// Drops all tangents if one is unusable: one vertex cannot be corrected without its neighbours.
fn mend_tangents(data: &mut MeshData) -> usize {
    let usable = |[x, y, z, _]: &[f32; 4]| {
        let t = Vec3::new(*x, *y, *z);
        t.is_finite() && t.to_f64().length() > 1e-18
    };
    let bad = data.tangents.iter().filter(|t| !usable(t)).count();
    if bad > 0 {
        data.tangents.clear();
    }
    for tangent in &mut data.tangents {
        tangent[3] = if tangent[3] < 0.0 { -1.0 } else { 1.0 };
    }
    bad
}

fn mend_uvs(sets: &mut [Vec<Vec2>]) -> usize {
    /// Texture transforms have the same bound, so transformed uvs are finite.
    const MOST: f32 = 1e12;
    let mut count = 0;
    for uv in sets.iter_mut().flatten().filter(|uv| !(uv.x.abs() <= MOST && uv.y.abs() <= MOST)) {
        *uv = Vec2::default();
        count += 1;
    }
    count
}

fn mend_colors(colors: &mut [[f32; 4]]) -> usize {
    let mut count = 0;
    for color in colors.iter_mut().filter(|c| c.iter().any(|v| !v.is_finite())) {
        *color = [1.0; 4];
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> MeshData {
        let corner = |x, y| Vec3::new(x, y, 0.0);
        MeshData {
            positions: vec![corner(0.0, 0.0), corner(2.0, 0.0), corner(2.0, 2.0), corner(0.0, 2.0)],
            uvs: vec![vec![Vec2::new(0.5, f32::NAN); 4]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshData::default()
        }
    }

    #[test]
    fn flat_normals_unweld() {
        let mut data = square();
        data.positions[3] = Vec3::new(0.0, 0.0, 5.0);
        data.tangents = vec![[1.0, 0.0, 0.0, 1.0]; 4];
        let mut warnings = Warnings::default();
        repair(&mut data, &mut warnings);
        assert_eq!(data.positions.len(), 6);
        assert_eq!(data.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(data.normals[0], Vec3::new(0.0, 0.0, 1.0));
        assert!((data.normals[3] - data.normals[5]).length() == 0.0 && data.normals[3].z.abs() < 1e-6);
        assert!(data.tangents.is_empty());
        assert_eq!(data.uvs[0], [Vec2::default(); 6]);
        assert_eq!(
            warnings.iter().next(),
            Some(("uvs that were infinite, NaN or beyond ±1e12, set to 0", 6))
        );
    }

    #[test]
    fn bad_normals_come_from_the_faces() {
        let mut data = square();
        data.normals = vec![Vec3::new(0.0, 3.0, 0.0); 4];
        data.normals[1] = Vec3::new(f32::NAN, 0.0, 0.0);
        data.normals[2] = Vec3::splat(0.0);
        assert_eq!(mend_normals(&mut data), 2);
        let (up, out) = (Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0));
        assert_eq!(data.normals, [up, out, out, up]);
    }

    #[test]
    fn tangents_stay_unless_one_is_unusable() {
        let mut data = square();
        data.tangents = vec![[0.0, 2.0, 0.0, -1.0]; 4];
        assert_eq!(mend_tangents(&mut data), 0);
        assert_eq!(data.tangents, [[0.0, 2.0, 0.0, -1.0]; 4]);
        data.tangents[2] = [0.0, 0.0, 0.0, 1.0];
        assert_eq!(mend_tangents(&mut data), 1);
        assert!(data.tangents.is_empty());
    }
}
