//! From files to an asset: read, make light, bake, write.

use super::args::{Auto, BakeArgs};
use super::memory::{self, Need};
use super::provenance;
use super::stages::Stages;
use super::textures::{Kept, Textures};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver};
use taotie::Warnings;
use taotie::bake::{
    self, BakeCounts, BakeSettings, Baked, Cage, MapKind, Maps, Scan, Simplified, SimplifyOptions,
    UnwrapOptions,
};
use taotie::io::{self, Loaded};
use taotie::mesh::{Mesh, MeshData};
use taotie::scene::{Material, Scene};
use taotie::surface::with_frames;

/// A light mesh, ready to be baked onto.
pub struct Light {
    /// With uvs, normals and tangents.
    pub mesh: Mesh,
    /// Where it came from.
    pub origin: Origin,
    /// Its material.
    pub material: Material,
    /// Textures of it that stay.
    pub kept: Kept,
}

/// Where a light mesh came from.
#[derive(Debug, Clone, Default, serde::Serialize)]
pub struct Origin {
    /// Whether the scan was simplified, and how.
    pub simplified: Option<Simplification>,
    /// Charts of the atlas, where uvs were made.
    pub charts: Option<usize>,
}

/// How a scan was made light.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Simplification {
    /// What had to be done: `kept`, `collapsed`, `pruned` or `clustered`.
    pub means: String,
    /// How far the light mesh lies from the scan, as the simplifier estimates, model units.
    pub error: f64,
}

/// What was made.
pub struct Made {
    /// The maps as textures.
    pub textures: Textures,
    /// What became of the samples.
    pub counts: BakeCounts,
    /// Where the scan was looked for.
    pub cage: Cage,
}

/// The scan as read.
pub struct Source {
    /// The SHA-256 of its file, counted while all else goes on.
    hash: Receiver<std::io::Result<String>>,
    path: PathBuf,
    /// What the file says beside its triangles.
    pub loaded: Loaded,
    /// Its triangles, sorted for rays.
    pub scan: Scan,
    /// The material of its first part.
    pub material: Material,
}

impl Source {
    /// Reads the scan and sorts it.
    ///
    /// # Errors
    /// The reader's; where the memory does not suffice; where the scan is one point.
    pub fn read(args: &BakeArgs, stages: &mut Stages, warnings: &mut Warnings) -> Result<Self> {
        let hash = hashed(&args.high);
        let limit = memory::limit(args.memory_limit);
        memory::check_file(&args.high, limit)?;
        let mut loaded = stages.run("read the scan", |_| read(&args.high, warnings))?;
        let triangles = loaded.scene.triangle_count() as u64;
        let vertices = loaded.scene.meshes().iter().map(|m| m.positions().len() as u64).sum();
        let need = Need {
            scan: [triangles, vertices],
            simplifies: args.low.is_none(),
            proves: !args.no_verify,
            texels: u64::from(args.size) * u64::from(args.size),
            texel_bytes: texel_bytes(args),
        };
        need.check(limit)?;
        if !args.json {
            crate::console::say(&format!("baking {triangles} triangles takes about {}", need.bytes()));
        }
        let mut parts = std::mem::take(&mut loaded.scene).into_data();
        warnings.note(
            "meshes of the scan with a normal for each facet, or none, as glTF shows them; they are smoothed",
            smooth_facets(&mut parts.meshes)?,
        );
        let scene = Scene::new(parts)?;
        let first = scene.instances().first().map(|instance| instance.material);
        let material = first.and_then(|m| scene.materials().get(m)).cloned().unwrap_or_default();
        let scan = stages.run("sort the scan", |_| Ok(Scan::new(scene)?))?;
        Ok(Self { hash, path: args.high.clone(), loaded, scan, material })
    }
}

/// Takes the normals of meshes whose triangles share nothing and are flat, so that smooth ones are made; gives back how
/// many such meshes there are. A scan is never meant in facets.
fn smooth_facets(meshes: &mut [Mesh]) -> Result<usize> {
    let mut count = 0;
    for mesh in meshes {
        if is_faceted(mesh) {
            let data = std::mem::take(mesh).into_data();
            *mesh = Mesh::new(MeshData { normals: Vec::new(), tangents: Vec::new(), ..data })?;
            count += 1;
        }
    }
    Ok(count)
}

fn is_faceted(mesh: &Mesh) -> bool {
    let is_alone = |(t, triangle): (usize, &[u32; 3])| *triangle == [0, 1, 2].map(|i| 3 * t as u32 + i);
    let is_flat = |normals: &[taotie::math::Vec3]| normals[0] == normals[1] && normals[1] == normals[2];
    !mesh.normals().is_empty()
        && mesh.triangles().iter().enumerate().all(is_alone)
        && mesh.normals().chunks_exact(3).all(is_flat)
}

impl Source {
    /// The SHA-256 of the scan's file, hexadecimal.
    ///
    /// # Errors
    /// Where it cannot be read any more.
    pub fn sha256(&self) -> Result<String> {
        let hash = self.hash.recv().context("the thread that reads the scan's file once more is gone")?;
        Ok(hash.map_err(|error| taotie::Error::io(&self.path, error))?)
    }
}

/// Begins to count a file's hash beside all else.
fn hashed(path: &Path) -> Receiver<std::io::Result<String>> {
    let (sender, receiver) = mpsc::channel();
    let path = path.to_path_buf();
    // The receiver is gone where the bake failed meanwhile: nobody waits for the hash.
    std::thread::spawn(move || sender.send(provenance::sha256(&path)));
    receiver
}

/// Bytes a texel over all maps: floats while they are baked, codes afterwards, and what filling takes.
fn texel_bytes(args: &BakeArgs) -> u64 {
    let floats = |map: &MapKind| match map {
        MapKind::Normal | MapKind::Albedo | MapKind::Bent => 12,
        _ => 4,
    };
    let codes = 4 * u64::from(args.bits() / 8);
    8 + args.maps.iter().map(|map| floats(map) + codes).sum::<u64>()
}

fn read(path: &Path, warnings: &mut Warnings) -> Result<Loaded> {
    let mut loaded = io::load_model(path)?;
    warnings.absorb(std::mem::take(&mut loaded.warnings));
    let meshes = loaded.scene.meshes();
    let mut positions = meshes.iter().flat_map(|mesh| mesh.positions());
    let first = positions.next();
    if !positions.any(|position| Some(position) != first) {
        bail!("{}: all its triangles lie in one point; there is nothing to bake", path.display());
    }
    Ok(loaded)
}

impl Light {
    /// The mesh of `--low`, with uvs where it had none.
    ///
    /// # Errors
    /// Those of reading and unwrapping.
    pub fn read(path: &Path, args: &BakeArgs, stages: &mut Stages, warnings: &mut Warnings) -> Result<Self> {
        let loaded = stages.run("read the light mesh", |_| read(path, warnings))?;
        let scene = loaded.scene;
        let used: Vec<usize> = scene.instances().iter().map(|instance| instance.material).collect();
        if used.iter().any(|material| *material != used[0]) {
            warnings.note("materials of the light mesh made one, the first", 1);
        }
        let material = used.first().and_then(|m| scene.materials().get(*m)).cloned().unwrap_or_default();
        note_lost(&material, warnings);
        let kept = Kept::of(&material, &scene);
        let mesh = bake::light_mesh(scene)?;
        let mut origin = Origin::default();
        let mesh = match mesh.uvs().is_empty() {
            false => mesh,
            true => unwrapped(&mesh, args.size, &mut origin, stages)?,
        };
        note_uvs(&mesh, warnings);
        Ok(Self { mesh: framed(&mesh, stages)?, origin, material, kept })
    }

    /// A scan made light, unwrapped for maps of this size.
    ///
    /// # Errors
    /// Those of unwrapping.
    pub fn made(source: &Source, simplified: &Simplified, size: u32, stages: &mut Stages) -> Result<Self> {
        let means = format!("{:?}", simplified.means).to_lowercase();
        let simplification = Simplification { means, error: simplified.error };
        let mut origin = Origin { simplified: Some(simplification), charts: None };
        let mesh = unwrapped(&simplified.mesh, size, &mut origin, stages)?;
        let material = Material { base_color_texture: None, ..source.material.clone() };
        Ok(Self { mesh: framed(&mesh, stages)?, origin, material, kept: Kept::default() })
    }
}

/// Makes the scan light.
///
/// # Errors
/// Those of simplification.
pub fn simplified(source: &Source, triangles: u32, stages: &mut Stages) -> Result<Simplified> {
    let options = SimplifyOptions { triangles: triangles as usize, ..SimplifyOptions::default() };
    stages.run("simplify", |progress| Ok(bake::simplify(source.scan.mesh(), &options, progress)?))
}

/// What simplification left out, and whether it went as far as was wanted.
pub fn note_simplified(simplified: &Simplified, triangles: u32, warnings: &mut Warnings) {
    warnings.absorb(simplified.notes.clone());
    if !simplified.reached {
        let what = format!(
            "{} triangles were wanted; {} is what could be reached",
            triangles,
            simplified.mesh.triangles().len()
        );
        warnings.note(what, 1);
    }
}

fn unwrapped(mesh: &Mesh, size: u32, origin: &mut Origin, stages: &mut Stages) -> Result<Mesh> {
    let options = UnwrapOptions { size, padding: (size / 512).clamp(2, 16) };
    let unwrapped = stages.run("unwrap", |progress| Ok(bake::unwrap(mesh, &options, progress)?))?;
    origin.charts = Some(unwrapped.charts);
    Ok(unwrapped.mesh)
}

/// With normals and tangents; those of the file stay.
fn framed(mesh: &Mesh, stages: &mut Stages) -> Result<Mesh> {
    stages.run("tangents", |_| Ok(with_frames(mesh, 0, None)?.0.into_owned()))
}

/// What an asset cannot keep of the light mesh's material.
fn note_lost(material: &Material, warnings: &mut Warnings) {
    let lost = [
        ("clearcoat", material.clearcoat.is_some()),
        ("sheen", material.sheen.is_some()),
        ("anisotropy", material.anisotropy.is_some()),
        ("emission", material.emissive != [0.0; 3]),
    ];
    for (what, _) in lost.iter().filter(|(_, is)| *is) {
        warnings.note(format!("the light mesh's {what} is left out"), 1);
    }
}

fn note_uvs(mesh: &Mesh, warnings: &mut Warnings) {
    let inside = |v: f32| (0.0..=1.0).contains(&v);
    let outside = mesh.uvs()[0].iter().filter(|uv| !(inside(uv.x) && inside(uv.y))).count();
    warnings.note("vertices of the light mesh with uvs outside of the map, which is repeated there", outside);
}

/// Bakes the maps asked for.
///
/// # Errors
/// Those of the cage and of baking.
pub fn bake_maps(
    args: &BakeArgs,
    size: u32,
    (source, light): (&Source, &Light),
    stages: &mut Stages,
) -> Result<Made> {
    let scan = &source.scan;
    let cage = stages.run("measure the gap", |_| cage(args, &light.mesh, scan))?;
    let settings = BakeSettings {
        size: [size; 2],
        side: args.side(),
        maps: args.maps.iter().copied().collect::<Maps>(),
        space: args.space.into(),
        sky_rays: args.ao_rays,
        sky_reach: args.ao_distance.map(|distance| distance as f32),
        roughness: args.roughness.map_or(source.material.roughness, |v| v as f32),
        dilation: match args.dilation {
            Auto::Auto => None,
            Auto::Given(texels) => Some(texels),
        },
    };
    let Baked { planes, counts } =
        stages.run("bake", |progress| Ok(bake::bake(&light.mesh, &cage, scan, &settings, progress)?))?;
    let textures = stages.run("store", |_| Textures::new(&planes, args, light.material.metallic))?;
    Ok(Made { textures, counts, cage })
}

fn cage(args: &BakeArgs, low: &Mesh, scan: &Scan) -> Result<Cage> {
    if let Some(path) = &args.cage {
        let cage = bake::light_mesh(io::load_model(path)?.scene)?;
        return Cage::from_mesh(low, &cage).with_context(|| path.display().to_string());
    }
    Ok(match args.ray_distance {
        Auto::Auto => Cage::automatic(low, scan),
        Auto::Given(distance) => Cage::uniform(low, distance as f32)?,
    })
}

/// The coarser levels of detail, all on the finest one's atlas.
///
/// # Errors
/// Those of simplification.
pub fn levels(
    args: &BakeArgs,
    light: &Light,
    (stages, warnings): (&mut Stages, &mut Warnings),
) -> Result<Vec<Mesh>> {
    if args.lods.is_empty() {
        return Ok(Vec::new());
    }
    let counts: Vec<usize> = args.lods.iter().map(|count| *count as usize).collect();
    let levels =
        stages.run("levels of detail", |progress| Ok(bake::levels(&light.mesh, &counts, progress)?))?;
    let all = light.mesh.triangles().len();
    for (wanted, level) in counts.iter().zip(&levels) {
        let got = level.mesh.triangles().len();
        if !level.reached {
            warnings.note(format!("a level of {wanted} triangles was wanted; its charts leave {got}"), 1);
        } else if got >= all {
            warnings.note(
                format!("a level of {wanted} triangles is no lighter than the light mesh, which has {all}"),
                1,
            );
        }
    }
    levels.iter().map(|level| Ok(with_frames(&level.mesh, 0, None)?.0.into_owned())).collect()
}

/// The least part of the screen that the object covers while each level is shown: half as wide and half as high from
/// level to level.
pub fn coverages(count: usize) -> Vec<f32> {
    let quarters = std::iter::successors(Some(0.25f32), |part| Some(part * 0.25));
    quarters.take(count.saturating_sub(1)).chain([0.0]).collect()
}
