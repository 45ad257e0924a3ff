//! The maximum device resources that a candidate may take.

use super::codecs::Codecs;
use super::level::Level;
use crate::asset::figure::Figure;
use crate::asset::requirement::Requirement;

/// The fraction of graphics memory that textures may take; the rest is for vertices.
const FOR_TEXTURES: f64 = 0.8;
/// Bytes per triangle on a graphics card: half a vertex of 28 bytes, more at seams, and three indices.
const TRIANGLE: f64 = 40.0;
/// The factor on the finest level's texels for all mip levels.
const WITH_MIPS: f64 = 4.0 / 3.0;

/// The maximum triangles and bytes of a candidate; infinite without a ceiling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ceilings {
    pub triangles: f64,
    pub gpu_bytes: f64,
    /// Of the file.
    pub bytes: f64,
}

impl Ceilings {
    /// Collects the ceilings among requirements of the finest level of detail.
    pub fn of(requirements: &[Requirement]) -> Self {
        let least = |figure: Figure| {
            let finest = requirements.iter().filter(|required| required.level.is_none_or(|level| level == 0));
            let those = finest.filter(|required| required.figure == figure);
            those.map(|required| required.most).fold(f64::INFINITY, f64::min)
        };
        Self {
            triangles: least(Figure::Triangles),
            gpu_bytes: least(Figure::GpuMemory),
            bytes: least(Figure::Bytes),
        }
    }

    /// Returns the ceilings of one of several levels of detail. Three quarters of the memory are for the finest, and
    /// each coarser one gets the same in proportion to its pixels: a quarter for all of them if each has half as many
    /// across as the one before.
    pub fn of_level(self, level: Level) -> Self {
        const FINEST: f64 = 0.75;
        Self { gpu_bytes: self.gpu_bytes * FINEST * level.part(), bytes: f64::INFINITY, ..self }
    }

    /// Returns the largest ratio of a candidate to a ceiling of the device; 0 without ceilings.
    pub fn ratio(&self, triangles: usize, gpu_bytes: u64) -> f64 {
        (triangles as f64 / self.triangles).max(gpu_bytes as f64 / self.gpu_bytes)
    }

    /// Returns the maximum number of triangles of a candidate, at least 4.
    pub fn most_triangles(&self, has_textures: bool) -> f64 {
        let share = if has_textures { 1.0 - FOR_TEXTURES } else { 1.0 };
        self.triangles.min(self.gpu_bytes * share / TRIANGLE).floor().max(4.0)
    }

    /// Returns the maximum number of texels of all textures together.
    pub fn most_texels(&self, codecs: &Codecs) -> f64 {
        self.gpu_bytes * FOR_TEXTURES / (codecs.bytes_per_texel() * WITH_MIPS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::CodecSet;

    #[test]
    fn ceilings_are_those_of_the_finest_level() {
        let required = Requirement::read("triangles@1=10,triangles=200,gpu-memory=1MB,mean-angle=1").unwrap();
        let ceilings = Ceilings::of(&required);
        assert_eq!(ceilings, Ceilings { triangles: 200.0, gpu_bytes: 1e6, bytes: f64::INFINITY });
        assert_eq!((ceilings.ratio(100, 2_000_000), ceilings.most_triangles(true)), (2.0, 200.0));
        let coarser = ceilings.of_level(Level { number: 1, across: 256 });
        assert_eq!([ceilings.of_level(Level::FINEST), coarser].map(|own| own.gpu_bytes), [750e3, 187_500.0]);
        assert_eq!(Ceilings::of(&[]).ratio(100, 100), 0.0);
        assert_eq!(Ceilings::of(&[]).most_texels(&Codecs::new(&[], CodecSet::Portable)), f64::INFINITY);
    }
}
