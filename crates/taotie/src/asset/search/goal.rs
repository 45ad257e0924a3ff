//! The goal that a candidate must reach: limits of differences, ceilings of device resources, and the permitted image
//! formats, at a level of detail.

use crate::asset::ask::{Figure, Lod, Requirement};
use taotie_engine::image::Encoding;
use taotie_engine::proof::{PATCH_SHARE, Picture, PixelDifferences};
use taotie_io::{CodecKind, CodecSet, ImageCodec};

/// The approximate ratios of p95, and of the mean of the worst patch, to the mean angle.
const P95_OF_MEAN: f64 = 2.5;
const PATCH_OF_MEAN: f64 = 6.0;

/// The maximum share of the scan that an asset may lack if no requirement states it; thin parts are lost at coarse levels
/// of detail.
const MISSING: f64 = 0.01;

/// The lower bound of limits, so that they can be divisors.
const LEAST: f64 = 1e-6;
/// The figures that limit angles, those that limit colours, and those that limit metallic, roughness and occlusion.
const ANGLES: [Figure; 4] = [Figure::MeanAngle, Figure::P95Angle, Figure::PatchAngle, Figure::WithinAngle];
const COLORS: [Figure; 4] = [Figure::MeanColor, Figure::P95Color, Figure::PatchColor, Figure::WithinColor];
const MATERIALS: [Figure; 2] = [Figure::MeanMaterial, Figure::PatchMaterial];
/// The maximum factors on the visually lossless limits of colours, and of materials, if none are requested.
const MOST_FACTORS: [f64; 2] = [2.0, 4.0];

/// The maximum differences of a candidate.
#[derive(Debug, Clone)]
pub(super) struct Goal {
    angles: Vec<Limit>,
    colors: Vec<Limit>,
    /// Of metallic, roughness and occlusion, as fractions of the largest number.
    materials: Vec<Limit>,
    /// The maximum detail lost in the worst patch; infinite without a limit.
    detail: f64,
    /// The maximum share of the scan's pixels in which an asset lacks it.
    missing: f64,
    /// The factor on limits of shape, at most 1.
    pub shape: f64,
}

/// A limit of a statistic of differences.
#[derive(Debug, Clone, Copy)]
struct Limit {
    statistic: Statistic,
    most: f64,
}

/// Returns limits multiplied by `factor`.
fn times(limits: &[Limit], factor: f64) -> Vec<Limit> {
    limits.iter().map(|limit| Limit { most: limit.most * factor, ..*limit }).collect()
}

/// Returns the largest ratio of differences, in ascending order, to their limits; `patch` is the mean in the worst patch,
/// if that is known.
fn worst(limits: &[Limit], differences: &[f32], patch: Option<f64>) -> f64 {
    let ratio = |limit: &Limit| match (limit.statistic, patch) {
        (Statistic::Worst(_), Some(mean)) => mean / limit.most,
        _ => limit.ratio(differences),
    };
    limits.iter().map(ratio).fold(0.0, f64::max)
}

/// Returns the approximate mean difference at which one of the limits is reached.
fn least_mean(limits: &[Limit]) -> f64 {
    limits.iter().map(Limit::mean).fold(f64::INFINITY, f64::min)
}

/// A statistic of differences.
#[derive(Debug, Clone, Copy)]
pub(super) enum Statistic {
    Mean,
    /// The difference that this fraction of the pixels stays within.
    Quantile(f64),
    /// The mean of the worst pixels, by this fraction. No patch of the same area has a larger mean.
    Worst(f64),
}

impl Goal {
    /// Creates the goal from the requirements that pixels decide. If there are none for angles, those of
    /// [`Requirement::visually_lossless`] apply. The same holds for colours, but if normals may be further off, so
    /// may colours, up to twice, and materials, up to four times. A requirement for only the level with this number overrides
    /// that for all.
    pub fn of(requirements: &[Requirement], level: usize) -> Self {
        let lossless = Requirement::visually_lossless();
        let of = |from: &[Requirement], figures: &[Figure]| -> Vec<Limit> {
            let counts = |required: &&Requirement| {
                figures.contains(&required.figure) && required.counts_at(level, from)
            };
            from.iter().filter(counts).filter_map(Limit::of).collect()
        };
        let required = |figures: &[Figure], factor: f64| {
            let required = of(requirements, figures);
            if required.is_empty() { times(&of(&lossless, figures), factor) } else { required }
        };
        let angles = required(&ANGLES, 1.0);
        // Coarser levels are never seen close up, where the proof judges it, unless a requirement names them.
        let is_judged = |required: &&Requirement| match required.level {
            Some(of) => of == level,
            None => level == 0,
        };
        let of_detail = |from: &[Requirement]| -> f64 {
            let own =
                from.iter().filter(|required| required.figure == Figure::PatchDetail && is_judged(required));
            own.map(|required| required.most.max(LEAST)).fold(f64::INFINITY, f64::min)
        };
        let names_angles = requirements.iter().any(|required| ANGLES.contains(&required.figure));
        let detail = match of_detail(requirements) {
            f64::INFINITY if !names_angles => of_detail(&lossless),
            own => own,
        };
        let factor = (least_mean(&angles) / least_mean(&of(&lossless, &ANGLES))).max(1.0);
        let [colors, materials] = MOST_FACTORS.map(|most| factor.min(most));
        let missed = requirements.iter().filter(|required| required.figure == Figure::Missed);
        let of_level = missed.filter(is_judged);
        let missing = of_level.map(|required| required.most.max(LEAST)).reduce(f64::min).unwrap_or(MISSING);
        Self {
            angles,
            colors: required(&COLORS, colors),
            materials: required(&MATERIALS, materials),
            detail,
            missing,
            shape: 1.0,
        }
    }

    /// Returns the requirements that a search takes into account; those of [`Requirement::visually_lossless`] if there are none
    /// for differences.
    pub fn decided(requirements: &[Requirement]) -> Vec<Requirement> {
        let others = [Figure::PatchDetail, Figure::Missed, Figure::Hausdorff];
        let of_shape = |required: &Requirement| others.contains(&required.figure);
        let is_decided = |required: &&Requirement| Limit::of(required).is_some() || of_shape(required);
        let decided: Vec<Requirement> = requirements.iter().filter(is_decided).copied().collect();
        if !decided.iter().all(of_shape) {
            return decided;
        }
        let mut lossless = Requirement::visually_lossless();
        lossless.retain(|own| decided.iter().all(|required| required.figure != own.figure));
        [lossless, decided].concat()
    }

    /// Returns the goal with all limits of differences multiplied by `factor`; those of shape only if that is stricter.
    pub fn times(&self, factor: f64) -> Self {
        let [angles, colors, materials] =
            [&self.angles, &self.colors, &self.materials].map(|limits| times(limits, factor));
        let shape = factor.min(1.0);
        let (detail, missing) = (self.detail * factor, self.missing * shape);
        Self { angles, colors, materials, detail, missing, shape }
    }

    /// Returns the largest ratios of differences, in ascending order, to the limits of angles and of materials; `None`
    /// for materials that are not compared. The first is also at least the ratio of what is missing to its limit, and
    /// infinite without angles to compare. `patches` are those of the worst patches of angles, colours, materials and detail, if
    /// known; otherwise the worst pixels count, wherever they are, and no lost detail.
    pub fn ratios(&self, seen: &PixelDifferences, patches: [Option<f64>; 4]) -> (f64, Option<f64>) {
        let color = (!seen.colors.is_empty()).then(|| {
            let materials = worst(&self.materials, &seen.materials, patches[2]);
            worst(&self.colors, &seen.colors, patches[1]).max(materials)
        });
        let lost = patches[3].map_or(0.0, |lost| lost / self.detail);
        let angles = worst(&self.angles, &seen.angles, patches[0]);
        (angles.max(lost).max(seen.missing / self.missing), color)
    }

    /// Returns `true` if it limits the worst patch, of angles, of colours, of materials and of detail.
    pub fn limits_patches(&self) -> [bool; 4] {
        let is_patch = |limit: &Limit| matches!(limit.statistic, Statistic::Worst(_));
        let [angles, colors, materials] =
            [&self.angles, &self.colors, &self.materials].map(|limits| limits.iter().any(is_patch));
        [angles, colors, materials, self.detail.is_finite()]
    }

    /// Returns the largest ratio of an image's visible differences, in ascending order, to their limit; infinite if
    /// no pixel shows it. Numbers that are neither colours nor normals have separate limits.
    pub fn image_ratio(&self, encoding: Encoding, differences: &[f32]) -> f64 {
        let limits: &[Limit] = match encoding {
            Encoding::Normal => &self.angles,
            Encoding::Srgb => &self.colors,
            Encoding::Linear => &self.materials,
        };
        worst(limits, differences, None)
    }

    /// Returns the approximate ratio of a mean angle, degrees.
    pub fn ratio_of_mean(&self, mean: f64) -> f64 {
        mean / least_mean(&self.angles)
    }
}

impl Limit {
    /// Returns the limit that a requirement sets; `None` if pixels do not decide it.
    fn of(required: &Requirement) -> Option<Self> {
        let most = required.most;
        let (statistic, most) = match required.figure {
            Figure::MeanAngle | Figure::MeanColor | Figure::MeanMaterial => (Statistic::Mean, most),
            Figure::P95Angle | Figure::P95Color => (Statistic::Quantile(0.95), most),
            Figure::PatchAngle | Figure::PatchColor | Figure::PatchMaterial => {
                (Statistic::Worst(PATCH_SHARE), most)
            }
            Figure::WithinAngle | Figure::WithinColor => (Statistic::Quantile(most), required.within?),
            _ => return None,
        };
        Some(Self { statistic, most: most.max(LEAST) })
    }

    /// Returns the ratio to the limit of the largest value that the statistic of all pixels has with a probability of
    /// 99 %, given the differences of some, in ascending order.
    fn ratio(&self, differences: &[f32]) -> f64 {
        match self.statistic.at_most(differences) {
            Some(value) if value.is_finite() => value / self.most,
            _ => f64::INFINITY,
        }
    }

    /// Returns the approximate mean difference at which it is reached.
    fn mean(&self) -> f64 {
        match self.statistic {
            Statistic::Mean => self.most,
            Statistic::Quantile(_) => self.most / P95_OF_MEAN,
            Statistic::Worst(_) => self.most / PATCH_OF_MEAN,
        }
    }
}

/// The standard deviations above the mean that a normally distributed number exceeds in 1 % of all cases.
const CERTAIN: f64 = 2.326;

impl Statistic {
    /// Returns the statistic of differences in ascending order; `None` if there are none.
    pub fn of(self, differences: &[f32]) -> Option<f64> {
        let count = differences.len();
        let at = |part: f64| ((count as f64 * part) as usize).min(count.saturating_sub(1));
        (count > 0).then(|| match self {
            Self::Mean => mean(differences),
            Self::Quantile(part) => f64::from(differences[at(part)]),
            Self::Worst(part) => mean(&differences[at(1.0 - part)..]),
        })
    }

    /// Returns the statistic of all pixels, or more with a probability of 99 %, from the differences of random ones in
    /// ascending order. The worst pixels are not raised: no patch is as bad as all of them together.
    fn at_most(self, differences: &[f32]) -> Option<f64> {
        let count = differences.len() as f64;
        let value = self.of(differences)?;
        Some(match self {
            Self::Mean => {
                let off = |v: &f32| f64::from(*v) - value;
                let squares: f64 = differences.iter().map(|v| off(v) * off(v)).sum();
                value + CERTAIN * squares.sqrt() / count
            }
            Self::Quantile(part) => {
                let raised = part + CERTAIN * (part * (1.0 - part) / count).sqrt();
                Self::Quantile(raised).of(differences)?
            }
            Self::Worst(_) => value,
        })
    }
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64
}

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

/// A level of detail of an asset: its number, 0 the finest, and the size of the object on the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::asset) struct Level {
    pub number: usize,
    /// Pixels across the object.
    pub across: u32,
}

/// The minimum number of triangles of any candidate.
const LEAST_TRIANGLES: u32 = 16;

impl Level {
    pub const FINEST: Self = Self { number: 0, across: Lod::FINEST };

    /// Returns `true` for the finest.
    pub fn is_finest(self) -> bool {
        self.number == 0
    }

    /// Returns its number of pixels as a fraction of the finest level's, for the whole object.
    pub fn part(self) -> f64 {
        let part = f64::from(self.across) / f64::from(Lod::FINEST);
        part * part
    }

    /// Returns a number of triangles of the finest level in proportion to the pixels of this one.
    pub fn triangles(self, of_finest: u32) -> u32 {
        ((f64::from(of_finest) * self.part()) as u32).max(LEAST_TRIANGLES)
    }

    /// Returns the map side of the finest level, texels, in proportion to the pixels of this one, a multiple of 4.
    pub fn side(self, of_finest: u32) -> u32 {
        (of_finest * self.across / Lod::FINEST).next_multiple_of(4).max(16)
    }

    /// Returns the picture at which it is measured, with `count` pixels if it is the finest.
    pub fn picture(self, count: usize) -> Picture {
        Picture::of(self.across as f32, count)
    }
}

/// Candidate qualities, in ascending order.
const WEBP: [u8; 9] = [20, 35, 50, 65, 75, 82, 88, 93, 97];
const JPEG: [u8; 9] = [40, 55, 70, 80, 86, 90, 94, 96, 98];
const AVIF: [u8; 9] = [30, 42, 54, 65, 75, 82, 88, 93, 97];
/// Candidate λ of KTX2, from the most lossy down.
const KTX2: [u8; 5] = [12, 6, 3, 1, 0];

/// The image formats available to a search.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Codecs {
    kinds: Vec<CodecKind>,
    /// The codec set, which determines the extension for packed geometry.
    pub set: CodecSet,
}

impl Codecs {
    /// Takes the allowed kinds, without those that this build cannot write; those of the set if none are given.
    pub fn new(kinds: &[CodecKind], set: CodecSet) -> Self {
        let kinds = if kinds.is_empty() { set.images() } else { kinds };
        let can_write = |kind: &CodecKind| match kind {
            CodecKind::WebP => cfg!(feature = "webp"),
            CodecKind::Avif => cfg!(feature = "avif"),
            CodecKind::Png | CodecKind::Jpeg | CodecKind::Ktx2 => true,
        };
        let mut kinds: Vec<CodecKind> = kinds.iter().copied().filter(can_write).collect();
        if kinds.is_empty() {
            kinds.push(CodecKind::Png);
        }
        Self { kinds, set }
    }

    /// Returns `true` if images of a kind may be kept as is.
    pub fn allows(&self, kind: CodecKind) -> bool {
        self.kinds.contains(&kind)
    }

    /// Returns the maximum bytes of a texel on a graphics card.
    pub fn bytes_per_texel(&self) -> f64 {
        if self.kinds == [CodecKind::Ktx2] { 1.0 } else { 4.0 }
    }

    /// Returns the smallest lossless format; `None` if all are lossy.
    pub fn lossless(&self) -> Option<ImageCodec> {
        let both = [(CodecKind::WebP, ImageCodec::WebP), (CodecKind::Png, ImageCodec::Png)];
        both.into_iter().find(|(kind, _)| self.kinds.contains(kind)).map(|(_, codec)| codec)
    }

    /// Returns the format with the least loss.
    pub fn least_lossy(&self) -> ImageCodec {
        self.lossless()
            .or_else(|| self.ladders().find_map(|ladder| ladder.last().copied()))
            .unwrap_or_default()
    }

    /// Returns the lossy formats of each kind, starting with the most lossy.
    pub fn ladders(&self) -> impl Iterator<Item = Vec<ImageCodec>> {
        let ladder = |kind: &CodecKind| match kind {
            CodecKind::Png => Vec::new(),
            CodecKind::Jpeg => JPEG.map(ImageCodec::Jpeg).into(),
            CodecKind::WebP => WEBP.map(ImageCodec::LossyWebP).into(),
            CodecKind::Avif => AVIF.map(ImageCodec::Avif).into(),
            CodecKind::Ktx2 => KTX2.map(ImageCodec::Ktx2).into(),
        };
        self.kinds.iter().map(ladder).filter(|ladder| !ladder.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goal(texts: &[&str]) -> Goal {
        Goal::of(&texts.iter().map(|text| text.parse().unwrap()).collect::<Vec<_>>(), 0)
    }

    /// A million pixels, a hundredth of which is far off.
    fn seen() -> PixelDifferences {
        let angle = |i: u32| if i < 99 { (i + 1) as f32 * 0.01 } else { 20.0 };
        let angles: Vec<f32> = (0..1_000_000).map(|i| angle(i / 10_000)).collect();
        let colors = angles.iter().map(|v| v * 2.0).collect();
        PixelDifferences { colors, angles, materials: vec![0.0], missing: 0.0, across: 512.0 }
    }

    #[test]
    fn the_worst_limit_decides() {
        let (angle, color) = goal(&["mean-angle=1", "mean-color=2"]).ratios(&seen(), [None; 4]);
        assert!((angle - 0.7).abs() < 6e-3 && (color.unwrap() - 0.7).abs() < 6e-3, "{angle} {color:?}");
        assert!((goal(&["mean-angle=1", "p95-angle=0.48"]).ratios(&seen(), [None; 4]).0 - 2.0).abs() < 3e-2);
        assert!((goal(&["patch-angle=5"]).ratios(&seen(), [None; 4]).0 - 4.0).abs() < 1e-6);
        assert_eq!(goal(&["patch-angle=5"]).ratios(&seen(), [Some(10.0), None, None, None]).0, 2.0);
        let (_, color) = goal(&["within-1dE=50%"]).ratios(&seen(), [None; 4]);
        assert!((color.unwrap() - 1.02).abs() < 2e-2, "{color:?}");
    }

    #[test]
    fn all_pixels_are_within_what_some_of_them_promise() {
        let random = |seed: u32| {
            let mixed = (seed ^ (seed >> 15)).wrapping_mul(0x2c1b_3c6d);
            let mixed = (mixed ^ (mixed >> 12)).wrapping_mul(0x297a_2d39);
            (mixed ^ (mixed >> 15)) as f32 / u32::MAX as f32
        };
        // The cubes of even numbers, with a mean of 1/4 and a p95 of 0.95³.
        for (statistic, truth) in [(Statistic::Mean, 0.25), (Statistic::Quantile(0.95), 0.857_375)] {
            let bounds = (0..1000u32).map(|draw| {
                let mut some: Vec<f32> =
                    (0..400).map(|i| random(draw * 400 + i)).map(|u| u * u * u).collect();
                some.sort_unstable_by(f32::total_cmp);
                statistic.at_most(&some).unwrap()
            });
            let broken = bounds.filter(|most| *most < truth).count();
            assert!((1..=25).contains(&broken), "{statistic:?}: {broken} of 1000");
        }
    }

    #[test]
    fn what_is_not_required_stays_visually_lossless() {
        let (lossless, wanted) =
            (Goal::of(&[], 0), goal(&["mean-angle@0=4", "flip=0.1", "mean-angle@1=0.1"]));
        assert_eq!(
            wanted.ratios(&seen(), [None; 4]).1.map(|ratio| ratio * 2.0),
            lossless.ratios(&seen(), [None; 4]).1
        );
        assert_eq!(
            goal(&["mean-angle=0.1"]).ratios(&seen(), [None; 4]).1,
            lossless.ratios(&seen(), [None; 4]).1
        );
        assert!((wanted.ratio_of_mean(1.0) - 0.25).abs() < 1e-9, "only of level 0");
    }

    #[test]
    fn what_lacks_a_part_is_not_near() {
        let lacks = |missing: f64| PixelDifferences { missing, ..seen() };
        let loose = |more: &'static str| goal(&["mean-angle=90", "p95-angle=90", "patch-angle=90", more]);
        let ratio = |goal: Goal, missing: f64| goal.ratios(&lacks(missing), [None; 4]).0;
        assert!(ratio(loose("flip=1"), 0.009) < 1.0 && ratio(loose("flip=1"), 0.011) > 1.0);
        assert!(ratio(loose("missed=0.1%"), 0.0009) < 1.0);
        assert!((ratio(loose("missed=0.1%").times(9.0), 0.002) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn nothing_to_compare_is_not_near() {
        assert_eq!(Goal::of(&[], 0).ratios(&PixelDifferences::default(), [None; 4]), (f64::INFINITY, None));
    }

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

    #[test]
    fn small_objects_have_fewer_triangles_and_texels() {
        let quarter = Level { number: 1, across: 256 };
        assert_eq!((quarter.triangles(8000), quarter.side(512), quarter.side(20)), (2000, 256, 16));
        assert_eq!((Level::FINEST.triangles(8000), Level::FINEST.side(512)), (8000, 512));
        let smallest = Level { number: 1, across: 32 };
        assert_eq!((smallest.triangles(100), smallest.side(256)), (LEAST_TRIANGLES, 16));
        assert_eq!(quarter.picture(1000), Picture { across: 256.0, count: 500 });
    }

    #[test]
    fn each_set_has_a_format_that_loses_least() {
        let least = |kinds: &[CodecKind]| Codecs::new(kinds, CodecSet::Portable).least_lossy();
        assert_eq!(least(&[CodecKind::Ktx2]), ImageCodec::Ktx2(0));
        assert_eq!(least(&[CodecKind::Jpeg]), ImageCodec::Jpeg(98));
        assert_eq!(least(&[CodecKind::Jpeg, CodecKind::Png]), ImageCodec::Png);
        #[cfg(feature = "webp")]
        assert_eq!(least(&[]), ImageCodec::WebP);
    }
}
