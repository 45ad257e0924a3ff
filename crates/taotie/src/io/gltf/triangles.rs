//! Converts primitive modes and indices to triangles.

use super::accessor::Accessor;
use super::reason::Reason;
use crate::mesh::first;
use crate::parallel;
use gltf::json::mesh::Mode;

/// The triangles of a primitive, and the number of surplus indices.
pub(super) struct Triangles {
    /// The triangles, counter-clockwise, in the file's vertex indices.
    pub list: Vec<[u32; 3]>,
    /// The number of indices at the end that do not form a whole triangle.
    pub surplus: usize,
}

/// Reads the vertex indices of a primitive with `vertices` vertices; without `indices` they count up from zero.
pub(super) fn read_indices(indices: Option<&Accessor>, vertices: usize) -> Reason<Vec<u32>> {
    let Some(accessor) = indices else { return Ok((0..vertices as u32).collect()) };
    if accessor.width != 1 || !accessor.is_unsigned() {
        return Err("indices must be unsigned integer scalars".into());
    }
    let read = parallel::collect(accessor.count, |i| accessor.unsigned::<1>(i)[0]);
    match first(&read, |v| *v as usize >= vertices) {
        Some(i) => Err(format!("index {i} refers to vertex {}, but there are only {vertices}", read[i])),
        None => Ok(read),
    }
}

/// Converts strips and fans to triangles; returns `None` for points and lines.
///
/// Every second triangle of a strip is flipped, so that all keep the winding of the first. Strip and fan triangles
/// with a repeated vertex only join parts and are dropped.
/// Source: glTF 2.0, 3.7.2.1.
pub(super) fn triangulate(mode: Mode, indices: &[u32]) -> Option<Triangles> {
    let list: Vec<[u32; 3]> = match mode {
        Mode::Triangles => {
            let list = indices.as_chunks::<3>();
            return Some(Triangles { list: list.0.to_vec(), surplus: list.1.len() });
        }
        Mode::TriangleStrip => indices.windows(3).enumerate().map(|(i, w)| turned(i, w)).collect(),
        Mode::TriangleFan => match indices.split_first() {
            Some((hub, rim)) => rim.windows(2).map(|w| [w[0], w[1], *hub]).collect(),
            None => Vec::new(),
        },
        _ => return None,
    };
    let whole = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    Some(Triangles { list: list.into_iter().filter(whole).collect(), surplus: 0 })
}

fn turned(i: usize, window: &[u32]) -> [u32; 3] {
    let odd = i % 2;
    [window[0], window[1 + odd], window[2 - odd]]
}

/// Returns the vertices used by triangles, in ascending order, and the triangles re-indexed to them.
pub(super) fn compact(mut triangles: Vec<[u32; 3]>, count: usize) -> (Vec<u32>, Vec<[u32; 3]>) {
    let corners = triangles.as_flattened();
    if corners.len() < count / 4 {
        // A small part of a large shared array: time and memory must depend only on the part.
        let mut used = corners.to_vec();
        used.sort_unstable();
        used.dedup();
        for index in triangles.as_flattened_mut() {
            *index = used.partition_point(|u| u < index) as u32;
        }
        return (used, triangles);
    }
    let mut new_index = vec![u32::MAX; count];
    corners.iter().for_each(|i| new_index[*i as usize] = 0);
    let mut used = Vec::with_capacity(count);
    for (i, new) in new_index.iter_mut().enumerate().filter(|(_, new)| **new == 0) {
        *new = used.len() as u32;
        used.push(i as u32);
    }
    for index in triangles.as_flattened_mut() {
        *index = new_index[*index as usize];
    }
    (used, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_the_winding() {
        let strip = triangulate(Mode::TriangleStrip, &[0, 1, 2, 3, 4]).unwrap();
        assert_eq!(strip.list, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        let fan = triangulate(Mode::TriangleFan, &[9, 1, 2, 3]).unwrap();
        assert_eq!(fan.list, [[1, 2, 9], [2, 3, 9]]);
    }

    #[test]
    fn joints_of_strips_and_surplus_indices_go() {
        let strip = triangulate(Mode::TriangleStrip, &[0, 1, 2, 2, 3, 3, 4, 5]).unwrap();
        assert_eq!(strip.list, [[0, 1, 2], [3, 5, 4]]);
        let list = triangulate(Mode::Triangles, &[0, 1, 2, 3]).unwrap();
        assert_eq!((list.list, list.surplus), (vec![[0, 1, 2]], 1));
        assert!(triangulate(Mode::Lines, &[0, 1]).is_none());
        assert!(triangulate(Mode::TriangleFan, &[]).unwrap().list.is_empty());
    }

    #[test]
    fn compacting_drops_what_no_triangle_names() {
        let triangles = vec![[7, 2, 4], [4, 2, 9]];
        let expected = (vec![2, 4, 7, 9], vec![[2, 0, 1], [1, 0, 3]]);
        assert_eq!(compact(triangles.clone(), 10), expected, "dense");
        assert_eq!(compact(triangles, 1000), expected, "sparse");
        assert_eq!(compact(vec![[2, 0, 1]], 3), (vec![0, 1, 2], vec![[2, 0, 1]]), "all used: as stored");
    }
}
