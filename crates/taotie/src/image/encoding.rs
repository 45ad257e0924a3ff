//! The meaning of stored numbers.

/// The meaning of stored numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Colour encoded by the sRGB transfer function; alpha is linear.
    Srgb,
    /// Linear numbers: roughness, heights.
    Linear,
    /// Unit vectors, (n + 1)/2. Coarser levels contain the mean of the unit vectors below, which is shorter the more
    /// they diverge, and in the fourth channel their variance 1 − |mean|²; the finest level has none.
    Normal,
}
