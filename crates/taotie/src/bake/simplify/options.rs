//! Options of simplification, and the method that reached the number of triangles.

/// The options of simplification.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimplifyOptions {
    /// The requested number of triangles, at least 1.
    pub triangles: usize,
    /// The weight of changes in vertex normals relative to distances: 0 is none, 1 is high. With higher values,
    /// creases and fine waves keep more triangles and flat parts fewer.
    pub normal_weight: f32,
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self { triangles: 10_000, normal_weight: 0.0 }
    }
}

/// The method that reached a number of triangles, from mild to rough.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimplifyMethod {
    /// The surface had no more triangles than requested.
    Kept,
    /// Edges were collapsed; connectivity, holes and handles are preserved.
    Collapsed,
    /// Edges were also collapsed across places where more than two triangles meet, or small disconnected parts were
    /// left out.
    Pruned,
    /// Nearby vertices were merged, whatever they belong to: holes may close, and parts may touch. Used only for a
    /// soup of loose triangles, which nothing else can simplify.
    Clustered,
}
