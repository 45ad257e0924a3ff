//! Options of simplification, and the method that reached the number of triangles.

/// The options of simplification.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimplifyOptions {
    /// The wanted number of triangles, at least 1.
    pub triangles: usize,
    /// The weight of the turn of a vertex normal beside distances: 0 is nothing, 1 much. With more, creases and fine
    /// waves keep their triangles and flat parts lose theirs.
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
    /// The surface had no more triangles than were wanted.
    Kept,
    /// Edges were collapsed; what is connected stays so, and holes and handles stay.
    Collapsed,
    /// Edges were collapsed across places where more than two triangles meet too, or small parts without a connection
    /// to the rest were left out.
    Pruned,
    /// Vertices that lie near one another were made one, whatever they belong to: holes may close, and parts may
    /// touch. For a soup of loose triangles nothing else helps, and nothing else is simplified so.
    Clustered,
}
