//! Splits the triangles of a mesh by alpha mode into parts with separate materials.

use crate::mesh::Mesh;
use crate::scene::AlphaMode;
use std::borrow::Cow;

/// Triangles of a mesh that become one primitive.
pub(super) struct MeshPart<'a> {
    pub triangles: Cow<'a, [[u32; 3]]>,
    /// The index of its material.
    pub material: usize,
}

impl<'a> MeshPart<'a> {
    /// Returns a whole mesh, with material 0.
    pub fn whole(mesh: &'a Mesh) -> Self {
        Self { triangles: Cow::Borrowed(mesh.triangles()), material: 0 }
    }

    /// Returns the parts of a mesh whose triangles have the modes `each`, in the order of `materials`, which are the
    /// modes of the materials; the whole mesh if there is only one material.
    pub fn by_mode(mesh: &'a Mesh, each: &[AlphaMode], materials: &[AlphaMode]) -> Vec<Self> {
        if materials.len() < 2 {
            return vec![Self::whole(mesh)];
        }
        let of = |(material, mode): (usize, &AlphaMode)| {
            let triangles = mesh.triangles().iter().zip(each);
            let triangles = triangles.filter(|(_, own)| *own == mode).map(|(triangle, _)| *triangle);
            Self { triangles: triangles.collect(), material }
        };
        materials.iter().enumerate().map(of).filter(|part| !part.triangles.is_empty()).collect()
    }
}

/// Returns each mode used by the triangles of all levels once: opaque, masks by their cutoffs, blended; the
/// material's own if there are none.
pub(super) fn distinct(levels: &[Vec<AlphaMode>], own: AlphaMode) -> Vec<AlphaMode> {
    let mut modes = Vec::new();
    for mode in levels.iter().flatten() {
        if !modes.contains(mode) {
            modes.push(*mode);
        }
    }
    modes.sort_by(|a, b| order(*a).total_cmp(&order(*b)));
    if modes.is_empty() { vec![own] } else { modes }
}

fn order(mode: AlphaMode) -> f32 {
    match mode {
        AlphaMode::Opaque => -1.0,
        AlphaMode::Mask(cutoff) => cutoff,
        AlphaMode::Blend => f32::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODES: [AlphaMode; 4] =
        [AlphaMode::Opaque, AlphaMode::Mask(0.25), AlphaMode::Mask(0.5), AlphaMode::Blend];

    #[test]
    fn each_mode_has_one_part_in_a_fixed_order() {
        let mesh = Mesh::sphere(1.0, 8, 4);
        let count = mesh.triangles().len();
        let each: Vec<AlphaMode> = (0..count).map(|t| MODES[(t * 3 + 2) % 4]).collect();
        let materials = distinct(std::slice::from_ref(&each), AlphaMode::Opaque);
        assert_eq!(materials, MODES);
        let parts = MeshPart::by_mode(&mesh, &each, &materials);
        assert_eq!(parts.iter().map(|part| part.triangles.len()).sum::<usize>(), count);
        for (part, mode) in parts.iter().zip(MODES) {
            let own = mesh.triangles().iter().zip(&each).filter(|(_, own)| **own == mode);
            assert!(own.map(|(triangle, _)| triangle).eq(part.triangles.iter()), "{mode:?}");
        }
        // A level that does not use a mode has no part for it.
        let opaque = vec![AlphaMode::Opaque; count];
        let parts = MeshPart::by_mode(&mesh, &opaque, &materials);
        assert_eq!((parts.len(), parts[0].material, parts[0].triangles.len()), (1, 0, count));
    }

    #[test]
    fn one_mode_is_the_whole_mesh() {
        let mesh = Mesh::sphere(1.0, 8, 4);
        for (levels, own) in
            [(vec![], AlphaMode::Blend), (vec![vec![AlphaMode::Blend; 3]], AlphaMode::Opaque)]
        {
            let materials = distinct(&levels, own);
            assert_eq!(materials, [AlphaMode::Blend]);
            let parts = MeshPart::by_mode(&mesh, &[], &materials);
            assert!(parts.len() == 1 && matches!(parts[0].triangles, Cow::Borrowed(_)));
        }
    }
}
