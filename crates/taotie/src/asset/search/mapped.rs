//! Candidates with a normal map: their bytes and errors are forecast from a few measured meshes and map sizes.

use super::encodings::{Encodings, NORMAL_RATIOS};
use super::workshop::{AIM, Best, Candidate, Draft, Shape, Workshop, is_hit, under_map};
use taotie_engine::error::Result;
use taotie_engine::image::Encoding;
use taotie_engine::math::Curve;
use taotie_engine::math::scalar::{exp, ln};
use taotie_engine::progress::Progress;
use taotie_engine::proof::{Relook, Side};
use taotie_io::{ImageCodec, LossyTexture};

/// The number of trials that close in on the goal.
const ROUNDS: usize = 5;
/// A candidate is made if its forecast is at most this fraction of the bytes of the smallest one so far.
const WORTH: f64 = 0.99;
/// If no candidate reaches the goal, the search targets those whose ratio is at most this factor above the smallest
/// one.
const NEARLY: f64 = 1.03;

/// Finds the smallest candidate with a normal map that reaches the goal, and replaces `best` if it is smaller. Its
/// maps have at least `least_size` texels along a side.
pub(super) fn smallest(
    workshop: &mut Workshop<'_>,
    least_size: u32,
    best: &mut Best,
    progress: Progress<'_>,
) -> Result<()> {
    let Some(mut forecast) = Forecast::measured(workshop, least_size, best.bytes(), progress)? else {
        return Ok(());
    };
    let is_out_of_reach = best.bytes().is_infinite() && forecast.smallest(AIM).is_none();
    let target = if is_out_of_reach { NEARLY * forecast.least_ratio() } else { AIM };
    let (mut aim, mut tried) = (target, Vec::new());
    for _ in 0..ROUNDS {
        let Some(choice) = forecast.smallest(aim) else { break };
        if choice.bytes > WORTH * best.bytes() || tried.contains(&(choice.shape, choice.normals)) {
            break;
        }
        tried.push((choice.shape, choice.normals));
        let Some(draft) = workshop.draft(choice.shape, progress)? else { break };
        let rounding = workshop.rounding(under_map(choice.shape.size), choice.normals);
        let trial = workshop.trial(&draft, rounding)?;
        best.offer(Candidate::made(draft, rounding), trial);
        if is_hit(&trial) {
            break;
        }
        forecast.correct(trial.bytes as f64 / choice.bytes);
        aim *= target / trial.ratio().max(f64::MIN_POSITIVE);
    }
    Ok(())
}

/// The triangles of the meshes measured for the finest level, and of the one on which map sizes are measured.
const TRIANGLES: [u32; 3] = [2_000, 8_000, 32_000];
const ON_TRIANGLES: u32 = 8_000;
/// The map sizes measured for it, and the one with which meshes are measured.
const SIZES: [u32; 4] = [256, 512, 1024, 2048];
const ON_SIZE: u32 = 512;
/// If a size has more than this fraction of the squared error of half the size, doubling it is not worthwhile.
const WORTH_DOUBLING: f64 = 0.85 * 0.85;
/// That fraction for details much larger than a texel: the error of interpolation is proportional to a texel's area.
const OF_DOUBLING: f64 = 0.0625;
/// Maps of half a size have at least this fraction of the bytes.
const BYTES_OF_HALF: f64 = 0.25;
/// The minimum number of triangles for it, and the ratio between successive candidates.
const LEAST_TRIANGLES: u32 = 200;
const RATIO: f64 = 1.1;
/// The fraction of the square of an error that remains, however much a mesh or a map is refined.
const FLOOR: f64 = 0.1;

/// Curves from which bytes and errors are estimated.
struct Forecast {
    /// The square of the error of meshes with a lossless map of one size, over their triangles.
    squared: Curve,
    mesh_bytes: Curve,
    /// The measured sizes, in ascending order, and the square of the error at which the curves cross.
    sizes: Vec<MapSize>,
    crossing: f64,
    /// The minimum and maximum number of triangles.
    triangles: [f64; 2],
    /// The ratio of true to estimated bytes.
    factor: f64,
}

/// A candidate and its estimated bytes.
#[derive(Debug, Clone, Copy)]
struct Choice {
    pub shape: Shape,
    /// The format of the normal map.
    pub normals: ImageCodec,
    pub bytes: f64,
}

impl Forecast {
    /// Measures meshes and maps, the latter of at least `least_size`; `None` if the first mesh is refused, or if just
    /// its maps exceed `most_bytes`. Skips meshes and maps whose candidates
    /// are unlikely to be smaller.
    pub fn measured(
        workshop: &mut Workshop<'_>,
        least_size: u32,
        most_bytes: f64,
        progress: Progress<'_>,
    ) -> Result<Option<Self>> {
        let (all, level) = (workshop.triangles(), workshop.level());
        let on = level.triangles(ON_TRIANGLES).min(all);
        let size = level.side(ON_SIZE).max(least_size).min(workshop.most_side());
        let Some(draft) = workshop.draft(mapped(on, size), progress)? else { return Ok(None) };
        let crossing = MapSize::measured(workshop, &draft)?;
        let least = crossing.least();
        if size == least_size.max(level.side(SIZES[0])) && crossing.least_bytes() > most_bytes {
            return Ok(None);
        }
        let mut forecast = Self {
            squared: Curve::default(),
            mesh_bytes: Curve::default(),
            crossing: crossing.squared,
            sizes: Vec::new(),
            triangles: [level.triangles(LEAST_TRIANGLES), all].map(f64::from),
            factor: 1.0,
        };
        forecast.add_mesh(&draft, &crossing);
        let (mesh_bytes, map_bytes) = (crossing.mesh_bytes, crossing.least_bytes());
        forecast.sizes.push(crossing);
        // Bytes grow less than triangles, but faster than their square root. Fewer triangles are always measured: the
        // candidates around them are forecast from both ends.
        let is_light = |triangles: u32| {
            let growth = (f64::from(triangles) / f64::from(on)).sqrt();
            triangles < on || mesh_bytes * growth + map_bytes * BYTES_OF_HALF <= WORTH * most_bytes
        };
        let counts = TRIANGLES.map(|count| level.triangles(count)).into_iter();
        for triangles in counts.filter(|count| *count != on && *count < all && is_light(*count)) {
            if let Some(draft) = workshop.draft(mapped(triangles, size), progress)? {
                forecast.add_mesh(&draft, &MapSize::with(workshop, &draft, least)?);
            }
        }
        let range = least_size..=workshop.most_side();
        for size in SIZES
            .map(|size| level.side(size))
            .into_iter()
            .filter(|other| *other != size && range.contains(other))
        {
            if forecast.may_be_smaller(size, most_bytes)
                && let Some(draft) = workshop.draft(mapped(on, size), progress)?
            {
                forecast.sizes.push(MapSize::measured(workshop, &draft)?);
                forecast.sizes.sort_by_key(|of| of.size);
            }
        }
        Ok(Some(forecast))
    }

    /// Adds a mesh with the maps measured on it.
    fn add_mesh(&mut self, draft: &Draft, maps: &MapSize) {
        let count = draft.low.mesh.triangles().len() as f64;
        self.squared.add(count, maps.squared);
        self.mesh_bytes.add(count, maps.mesh_bytes);
    }

    /// Returns `true` if a candidate with maps of this size is likely to reach the goal with at most `most_bytes`. The
    /// estimate: for the same losses, they take as many bytes as those of half the size, and help as much as the doubling
    /// before.
    fn may_be_smaller(&self, size: u32, most_bytes: f64) -> bool {
        let find = |size: u32| self.sizes.iter().find(|of| of.size == size);
        let (quarter, half) = (find(size / 4), find(size / 2));
        let Some(half) = half else { return quarter.is_none() };
        let gain = quarter.map_or(OF_DOUBLING, |quarter| half.squared / quarter.squared);
        let expected = MapSize { size, squared: half.squared * gain, ..half.clone() };
        let is_smaller =
            |(choice, squared): (Choice, f64)| squared <= AIM * AIM && choice.bytes <= WORTH * most_bytes;
        gain < WORTH_DOUBLING && (most_bytes.is_infinite() || self.choices(&[expected]).any(is_smaller))
    }

    /// Returns the smallest candidate with at most this ratio of angles.
    pub fn smallest(&self, ratio: f64) -> Option<Choice> {
        let sizes = self.all_sizes();
        let enough = self.choices(&sizes).filter(|(_, squared)| *squared <= ratio * ratio);
        enough.map(|(choice, _)| choice).min_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }

    /// Returns the smallest ratio of angles of any candidate.
    pub fn least_ratio(&self) -> f64 {
        self.choices(&self.all_sizes()).map(|(_, squared)| squared).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Returns the measured sizes, and some between them.
    fn all_sizes(&self) -> Vec<MapSize> {
        let pairs = self.sizes.windows(2).flat_map(|pair| pair[0].up_to(&pair[1]));
        pairs.chain(self.sizes.last().cloned()).collect()
    }

    /// Returns the candidates with maps of these sizes, with the squares of their ratios.
    fn choices<'a>(&'a self, sizes: &'a [MapSize]) -> impl Iterator<Item = (Choice, f64)> + 'a {
        let [least, most] = self.triangles;
        let steps = std::iter::successors(Some(least.min(most)), |count| Some(count * RATIO));
        let counts = steps.take_while(move |count| *count < most).chain([most]);
        counts.flat_map(move |triangles| sizes.iter().map(move |size| (triangles, size))).flat_map(
            move |(triangles, size)| {
                let squared = self.lossless(triangles, size);
                size.losses().map(move |loss| (self.choice(triangles, size, loss), squared + loss.squared))
            },
        )
    }

    /// Returns the square of the error with lossless maps: those of mesh and map, minus their common part.
    fn lossless(&self, triangles: f64, size: &MapSize) -> f64 {
        let of_mesh = self.squared.at(triangles);
        (of_mesh + size.squared - self.crossing).max(FLOOR * of_mesh.max(size.squared))
    }

    fn choice(&self, triangles: f64, size: &MapSize, loss: Loss) -> Choice {
        let shape = mapped(triangles as u32, size.size);
        let bytes = (self.mesh_bytes.at(triangles) + loss.bytes) * self.factor;
        Choice { shape, normals: loss.normals, bytes }
    }

    /// Corrects estimated bytes by the ratio of true to estimated bytes of the last choice.
    pub fn correct(&mut self, factor: f64) {
        self.factor *= factor;
    }
}

fn mapped(triangles: u32, size: u32) -> Shape {
    Shape { triangles, size, has_normal_map: true }
}

/// Steps between two sizes.
const STEPS: u32 = 4;
/// The lower bound of values, which keeps logarithms finite.
const LEAST_VALUE: f64 = 1e-9;

/// Maps of a size.
#[derive(Debug, Clone)]
struct MapSize {
    /// Texels along a side.
    pub size: u32,
    /// The square of the ratio of angles with lossless maps.
    pub squared: f64,
    /// The bytes of the mesh that they were measured on.
    pub mesh_bytes: f64,
    /// The measured bytes of all maps.
    bytes: f64,
    /// The possible losses of the normal map, in ascending order, with the resulting bytes of all maps.
    lossy: Vec<Loss>,
}

/// The cost of a lossy normal map.
#[derive(Debug, Clone, Copy)]
struct Loss {
    pub normals: ImageCodec,
    /// Its contribution to that square.
    pub squared: f64,
    pub bytes: f64,
}

impl MapSize {
    /// Measures the maps of a draft.
    pub fn measured(workshop: &mut Workshop<'_>, draft: &Draft) -> Result<Self> {
        let mut lossy = losses(workshop, draft)?;
        if lossy.is_empty() {
            lossy.push(Loss { normals: workshop.codecs().least_lossy(), squared: 0.0, bytes: 0.0 });
        }
        let least = lossy[0];
        let mut maps = Self::with(workshop, draft, least)?;
        let others = maps.bytes - least.bytes;
        maps.lossy = lossy.into_iter().map(|loss| Loss { bytes: loss.bytes + others, ..loss }).collect();
        Ok(maps)
    }

    /// Measures the maps of a draft with one loss.
    pub fn with(workshop: &mut Workshop<'_>, draft: &Draft, loss: Loss) -> Result<Self> {
        let bits = under_map(draft.shape.size);
        let trial = workshop.trial(draft, workshop.rounding(bits, loss.normals))?;
        let mesh_bytes = draft.mesh_bytes(bits, workshop.codecs().set)? as f64;
        let squared = (trial.angle_ratio * trial.angle_ratio - loss.squared).max(0.0);
        let bytes = trial.bytes as f64 - mesh_bytes;
        Ok(Self { size: draft.shape.size, squared, mesh_bytes, bytes, lossy: vec![loss] })
    }

    /// Returns the smallest loss.
    pub fn least(&self) -> Loss {
        self.lossy[0]
    }

    /// Returns the fewest bytes of the measured maps.
    pub fn least_bytes(&self) -> f64 {
        self.losses().map(|loss| loss.bytes).fold(f64::INFINITY, f64::min)
    }

    /// Returns the available losses.
    pub fn losses(&self) -> impl Iterator<Item = Loss> {
        self.lossy.iter().copied()
    }

    /// Returns this size and some between it and a larger one.
    pub fn up_to<'a>(&'a self, larger: &'a Self) -> impl Iterator<Item = Self> + 'a {
        steps().map(|part| {
            let lossy = self.lossy.iter().zip(&larger.lossy).map(|(a, b)| a.toward(*b, part)).collect();
            Self {
                size: (between(f64::from(self.size), f64::from(larger.size), part) as u32)
                    .next_multiple_of(4),
                squared: between(self.squared, larger.squared, part),
                mesh_bytes: self.mesh_bytes,
                bytes: between(self.bytes, larger.bytes, part),
                lossy,
            }
        })
    }
}

impl Loss {
    fn toward(self, other: Self, part: f64) -> Self {
        Self {
            squared: between(self.squared, other.squared, part),
            bytes: between(self.bytes, other.bytes, part),
            ..self
        }
    }
}

/// Returns the possible losses of a draft's normal map, in ascending order, each with the bytes of that map.
fn losses(workshop: &Workshop<'_>, draft: &Draft) -> Result<Vec<Loss>> {
    let Some(normals) = &draft.maps.textures.normal else { return Ok(Vec::new()) };
    let (texture, size) = (LossyTexture::new(normals.clone(), Encoding::Normal), draft.shape.size);
    let surface = workshop.surface(draft)?;
    let side = Side::of(&surface);
    let look = Relook::new(&side, workshop.picture());
    let Some(look) = look.first(Encoding::Normal)? else { return Ok(Vec::new()) };
    let encodings = Encodings::new(&texture, look, (&workshop.goal, workshop.codecs()));
    let mut losses: Vec<Loss> = Vec::with_capacity(NORMAL_RATIOS.len());
    for ratio in NORMAL_RATIOS {
        let Some(encoded) = encodings.smallest_of(size, ratio)? else { continue };
        let (squared, bytes) = (encoded.ratio * encoded.ratio, encoded.bytes.len() as f64);
        losses.push(Loss { normals: encoded.codec, squared, bytes });
    }
    Ok(losses)
}

/// Returns the interpolation fractions between two measured sizes, without the end.
fn steps() -> impl Iterator<Item = f64> {
    (0..STEPS).map(|i| f64::from(i) / f64::from(STEPS))
}

/// Interpolates logarithmically.
fn between(a: f64, b: f64, part: f64) -> f64 {
    let [a, b] = [a, b].map(|v| ln(v.max(LEAST_VALUE)));
    exp(a + (b - a) * part)
}
