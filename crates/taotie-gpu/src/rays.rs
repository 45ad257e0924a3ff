//! The tree of boxes that shaders trace rays through.

use taotie_engine::trace::FlatBox;

/// The shader functions that trace rays.
pub(crate) const RAYS: &str = include_str!("rays.wgsl");

/// The end of a list of boxes, which shaders recognise by its `skip`.
pub(crate) const END_BOX: [u32; 8] = [0; 8];

/// Returns the words of boxes: low corner, skip, high corner, triangles; floats as bits. The low four bits of the last
/// one are the number of a box's triangles, the others the index of the first.
pub(crate) fn box_words(boxes: &[FlatBox]) -> Vec<[u32; 8]> {
    let words = |around: &FlatBox| {
        let [[a, b, c], [d, e, f]] = [around.low, around.high].map(|corner| corner.map(f32::to_bits));
        let triangles = around.triangles.start << 4 | around.triangles.len() as u32;
        [a, b, c, around.skip, d, e, f, triangles]
    };
    boxes.iter().map(words).collect()
}
