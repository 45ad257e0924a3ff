//! Baked maps as textures of an asset, and as files beside it.

use super::args::BakeArgs;
use crate::sheet::Sheet;
use crate::studio::Space;
use anyhow::Result;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::PathBuf;
use taotie::bake::{MapKind, Planes, Storage, Texel, store_codes, store_unit_vectors};
use taotie::image::{Bitmap, Encoding};
use taotie::io::{self, GltfImage, GltfMaterial};
use taotie::math::srgb::srgb_from_linear;
use taotie::names::Named;
use taotie::scene::{Material, Scene};

/// What goes into the asset.
#[derive(Default)]
pub struct Textures {
    /// Tangent space.
    pub normal: Option<Bitmap>,
    /// sRGB.
    pub color: Option<Bitmap>,
    /// Occlusion, roughness and metallic; or occlusion alone.
    pub orm: Option<Bitmap>,
    /// Which of the three are in `orm`.
    pub has: Has,
    /// Maps that glTF has no place for.
    pub beside: Vec<Beside>,
    /// Where rays missed; `None` where none did.
    pub missed: Option<Sheet>,
}

/// What a texture of occlusion, roughness and metallic holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Has {
    /// Red is occlusion.
    pub occlusion: bool,
    /// Green is roughness, and blue one.
    pub roughness: bool,
}

/// A map in a file of its own.
pub struct Beside {
    /// What it shows.
    pub note: MapNote,
    /// What is written.
    pub bitmap: Bitmap,
}

/// What the numbers of a map mean.
#[derive(Debug, Clone, Serialize)]
pub struct MapNote {
    /// Its name, as on the command line.
    pub map: &'static str,
    /// The file, or `None` inside of the asset.
    pub file: Option<PathBuf>,
    /// Bits a channel.
    pub bits: u8,
    /// The value of black, in `unit`, where the map holds numbers.
    pub black: Option<f64>,
    /// The value of white.
    pub white: Option<f64>,
    /// The unit of these.
    pub unit: &'static str,
}

impl Textures {
    /// Of the maps that were baked; `scan` is the material of the scan, `output` where the asset goes.
    ///
    /// # Errors
    /// None but where sizes are out of range, which they are not.
    pub fn new(planes: &Planes, args: &BakeArgs, metallic: f32) -> Result<Self> {
        let mut textures = Self { missed: missed(planes), ..Self::default() };
        let storage = Storage { bits: args.bits(), dither: args.bits() == 8 };
        let fine = Storage { bits: 16, dither: false };
        if !planes.normal.is_empty() {
            let bitmap = store_unit_vectors(planes.size(), &planes.normal, storage)?;
            match args.space {
                Space::Tangent => textures.normal = Some(bitmap),
                Space::Object => textures.put_beside(args, MapKind::Normal, bitmap, None),
            }
        }
        if !planes.albedo.is_empty() {
            textures.color = Some(color(planes)?);
        }
        textures.has =
            Has { occlusion: !planes.occlusion.is_empty(), roughness: !planes.roughness.is_empty() };
        if textures.has != Has::default() {
            textures.orm = Some(orm(planes, textures.has, metallic)?);
        }
        if !planes.bent.is_empty() {
            let bitmap = store_unit_vectors(planes.size(), &planes.bent, storage)?;
            textures.put_beside(args, MapKind::Bent, bitmap, None);
        }
        for (kind, plane, unit) in [
            (MapKind::Height, &planes.lift, "model units"),
            (MapKind::Curvature, &planes.curvature, "1 / model unit"),
        ] {
            if plane.is_empty() {
                continue;
            }
            let [black, white] = range(kind, planes, plane);
            let number = |v: f32| (v - black) / (white - black);
            let bitmap = store_codes(planes.size(), |i| [number(plane[i]); 3], 1, fine)?;
            textures.put_beside(args, kind, bitmap, Some(([black, white], unit)));
        }
        Ok(textures)
    }

    fn put_beside(
        &mut self,
        args: &BakeArgs,
        kind: MapKind,
        bitmap: Bitmap,
        range: Option<([f32; 2], &'static str)>,
    ) {
        let note = MapNote {
            map: kind.name(),
            file: Some(args.output.with_extension(format!("{}.png", kind.name()))),
            bits: bitmap.bits(),
            black: range.map(|([black, _], _)| f64::from(black)),
            white: range.map(|([_, white], _)| f64::from(white)),
            unit: range.map_or("", |(_, unit)| unit),
        };
        self.beside.push(Beside { note, bitmap });
    }

    /// Writes what goes beside the asset; gives back the files.
    ///
    /// # Errors
    /// Where a file cannot be written.
    pub fn write_beside(&self) -> Result<Vec<PathBuf>> {
        let mut files = Vec::new();
        for Beside { note, bitmap } in &self.beside {
            let path = note.file.clone().unwrap_or_default();
            io::write_png_bitmap(&path, bitmap, Encoding::Linear)?;
            files.push(path);
        }
        Ok(files)
    }

    /// What each map is and where.
    pub fn notes(&self) -> Vec<MapNote> {
        let inside = |map: MapKind, bitmap: &Bitmap| MapNote {
            map: map.name(),
            file: None,
            bits: bitmap.bits(),
            black: None,
            white: None,
            unit: "",
        };
        let mut notes = Vec::new();
        notes.extend(self.normal.as_ref().map(|bitmap| inside(MapKind::Normal, bitmap)));
        notes.extend(self.color.as_ref().map(|bitmap| inside(MapKind::Albedo, bitmap)));
        if let Some(orm) = &self.orm {
            notes.extend(self.has.occlusion.then(|| inside(MapKind::Occlusion, orm)));
            notes.extend(self.has.roughness.then(|| inside(MapKind::Roughness, orm)));
        }
        notes.extend(self.beside.iter().map(|beside| beside.note.clone()));
        notes
    }

    /// The file of a normal map in object space.
    pub fn object_map(&self) -> Option<PathBuf> {
        let map = self.beside.iter().find(|beside| beside.note.map == MapKind::Normal.name())?;
        map.note.file.clone()
    }

    /// What the asset says of the files beside it; `None` where there are none.
    pub fn extras(&self) -> Option<Value> {
        let file = |beside: &Beside| {
            let name = beside.note.file.as_ref()?.file_name()?.to_string_lossy().into_owned();
            let note = &beside.note;
            Some((
                note.map.to_owned(),
                json!({ "file": name, "black": note.black, "white": note.white, "unit": note.unit }),
            ))
        };
        let maps: serde_json::Map<String, Value> = self.beside.iter().filter_map(file).collect();
        (!maps.is_empty()).then(|| json!({ "maps": maps }))
    }

    /// The asset's material: the factors of `base`, its textures where `kept` holds them and nothing was baked in their
    /// place.
    pub fn material<'a>(&'a self, base: &'a Material, kept: &'a Kept) -> GltfMaterial<'a> {
        let color = self.color.as_ref().or(kept.color.as_ref());
        let orm = self.has.roughness.then_some(self.orm.as_ref()).flatten();
        let mr = orm.or(kept.metallic_roughness.as_ref());
        let occlusion = self.has.occlusion.then_some(self.orm.as_ref()).flatten().or(kept.occlusion.as_ref());
        let [r, g, b, a] = base.base_color;
        GltfMaterial {
            name: &base.name,
            base_color: if self.color.is_some() { [1.0, 1.0, 1.0, a] } else { [r, g, b, a] }
                .map(|v| v.clamp(0.0, 1.0)),
            metallic: if orm.is_some() { 1.0 } else { base.metallic },
            roughness: if orm.is_some() { 1.0 } else { base.roughness },
            base_color_map: color.map(GltfImage::from),
            metallic_roughness_map: mr.map(GltfImage::from),
            occlusion_map: occlusion.map(GltfImage::from),
            occlusion_strength: if self.has.occlusion { 1.0 } else { base.occlusion_strength },
            normal_map: self.normal.as_ref().map(GltfImage::from),
            normal_scale: 1.0,
            double_sided: base.double_sided,
        }
    }
}

/// Textures of a light mesh's material that stay.
#[derive(Default)]
pub struct Kept {
    color: Option<Bitmap>,
    metallic_roughness: Option<Bitmap>,
    occlusion: Option<Bitmap>,
}

impl Kept {
    /// Those of uv set 0 that are not moved by a transform.
    pub fn of(material: &Material, scene: &Scene) -> Self {
        let bitmap = |texture: &Option<taotie::scene::TextureRef>| {
            let texture = texture.as_ref()?;
            let plain = texture.uv_set == 0 && texture.transform == taotie::scene::UvTransform::default();
            plain.then(|| scene.textures()[texture.texture].bitmap().clone())
        };
        Self {
            color: bitmap(&material.base_color_texture),
            metallic_roughness: bitmap(&material.metallic_roughness_texture),
            occlusion: bitmap(&material.occlusion_texture),
        }
    }
}

fn color(planes: &Planes) -> taotie::Result<Bitmap> {
    let encode = |v: f32| srgb_from_linear(f64::from(v.clamp(0.0, 1.0))) as f32;
    store_codes(planes.size(), |i| planes.albedo[i].map(encode), 3, Storage { bits: 8, dither: true })
}

fn orm(planes: &Planes, has: Has, metallic: f32) -> taotie::Result<Bitmap> {
    let at = |plane: &[f32], i: usize, none: f32| plane.get(i).copied().unwrap_or(none);
    let codes = |i: usize| [at(&planes.occlusion, i, 1.0), at(&planes.roughness, i, 1.0), metallic];
    let channels = if has.roughness { 3 } else { 1 };
    let codes = |i: usize| if has.roughness { codes(i) } else { [codes(i)[0]; 3] };
    store_codes(planes.size(), codes, channels, Storage { bits: 8, dither: true })
}

/// The values of black and white: from the least to the greatest height, and as much curvature either way as all but
/// the hundredth part of the texels have.
fn range(kind: MapKind, planes: &Planes, plane: &[f32]) -> [f32; 2] {
    let mut covered = planes.covered(plane);
    covered.sort_unstable_by(f32::total_cmp);
    let (Some(least), Some(most)) = (covered.first(), covered.last()) else { return [0.0, 1.0] };
    let [low, high] = match kind {
        MapKind::Curvature => {
            let rank = |part: f64| covered[((covered.len() - 1) as f64 * part) as usize].abs();
            let most = rank(0.005).max(rank(0.995));
            [-most, most]
        }
        _ => [*least, *most],
    };
    if high > low { [low, high] } else { [low, low + 1.0] }
}

/// A picture of a map for people to look at.
pub fn preview(bitmap: &Bitmap, side: usize) -> Sheet {
    let step = (bitmap.width().max(bitmap.height()) as usize).div_ceil(side).max(1);
    let (width, height) = (bitmap.width() as usize / step, bitmap.height() as usize / step);
    let code = |i: usize| {
        let at = i / width * step * bitmap.width() as usize + i % width * step;
        let [r, g, b, _] = bitmap.stored(at);
        [r, g, b].map(|v| (v * 255.0 + 0.5) as u8)
    };
    Sheet { width, height, pixels: (0..width * height).map(code).collect() }
}

/// Where rays missed, as a picture: amber took the closest point, red found nothing.
fn missed(planes: &Planes) -> Option<Sheet> {
    const SIDE: usize = 1024;
    const GROUND: [u8; 3] = [24, 25, 27];
    const COVERED: [u8; 3] = [70, 90, 80];
    const CLOSEST: [u8; 3] = [240, 170, 40];
    const LOST: [u8; 3] = [230, 50, 40];
    let [width, height] = planes.size().map(|side| side as usize);
    planes.texels.iter().find(|texel| matches!(texel, Texel::Closest | Texel::Lost))?;
    let step = width.max(height).div_ceil(SIDE);
    let (across, down) = (width / step, height / step);
    // The worst texel of each block: a single miss is to be seen.
    let worst = |i: usize| {
        let (x, y) = (i % across * step, i / across * step);
        let block = (y..y + step).flat_map(|y| planes.texels[y * width + x..][..step].iter());
        block.copied().max_by_key(|texel| *texel as u8).unwrap_or_default()
    };
    let color = |texel: Texel| match texel {
        Texel::Free => GROUND,
        Texel::Met => COVERED,
        Texel::Closest => CLOSEST,
        Texel::Lost => LOST,
    };
    let pixels = (0..across * down).map(|i| color(worst(i))).collect();
    Some(Sheet { width: across, height: down, pixels })
}
