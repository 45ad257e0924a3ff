//! The viewer of an asset file, with the default light and camera of a picture and the metadata that the file states.

use super::{Bookmark, MeasuredErrors, Subject, Viewer};
use crate::Fact;
use std::path::Path;
use taotie::Limits;
use taotie::asset::model_unit;
use taotie::studio::{self, CameraOptions, Framing, LightOptions, MaterialOptions, Viewpoint};
use taotie_engine::bake::RayPreview;
use taotie_engine::film::Development;
use taotie_engine::image::Texture;
use taotie_engine::length::Unit;
use taotie_engine::render::{Prepared, RenderSettings};
use taotie_engine::scene::Scene;
use taotie_engine::{Result, Warnings};
use taotie_io::{Loaded, xmp_rights, xmp_sources};

/// The maximum side of textures on the page, texels.
pub const MOST_TEXTURE_SIDE: u32 = 2048;

/// The smallest side to which textures are reduced, texels.
const LEAST_TEXTURE_SIDE: u32 = 128;

/// An asset file.
#[derive(Clone, Copy)]
pub struct AssetSubject<'a> {
    /// Its file.
    pub path: &'a Path,
    /// The heading.
    pub title: &'a str,
    /// The limits for reading the file.
    pub limits: &'a Limits,
    /// Its errors, if known.
    pub errors: Option<MeasuredErrors<'a>>,
    /// Projection rays of its bake, in the space of the file.
    pub rays: Option<&'a RayPreview>,
    /// How it is first seen.
    pub staging: Staging<'a>,
}

/// How an asset is first seen; by default as in a picture.
#[derive(Clone, Copy, Default)]
pub struct Staging<'a> {
    /// The camera.
    pub camera: Option<&'a CameraOptions>,
    /// The light.
    pub light: Option<&'a LightOptions>,
    /// Further views that the page offers.
    pub bookmarks: &'a [Bookmark],
}

/// Returns the maximum size of a page for an asset of `bytes`: the asset in base64, and 3 MB for everything else.
pub fn most_page_bytes(bytes: u64) -> u64 {
    bytes / 100 * 134 + 3_000_000
}

impl AssetSubject<'_> {
    /// Writes a page with the asset's viewer. Textures with sides above [`MOST_TEXTURE_SIDE`] texels are reduced, and
    /// reduced further if the page would exceed [`most_page_bytes`]; a fact on the page states this. Problems in the
    /// file are not reported again, since its proof has already read it.
    ///
    /// # Errors
    /// Those of [`studio::load`] and [`Viewer::new`].
    pub fn page(&self, write: &dyn Fn(&Viewer) -> String) -> Result<(String, Warnings)> {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let mut loaded = studio::load(self.path, &MaterialOptions::default(), self.limits)?;
        let (facts, most) = (facts(&loaded, &name), most_page_bytes(loaded.bytes.unwrap_or_default()));
        let (scene, unit) = (std::mem::take(&mut loaded.scene), model_unit(&loaded));
        let mut side = fitting_side(&scene, most);
        loop {
            let viewer = self.viewer((scene.clone(), unit), &facts, side)?;
            let page = write(&viewer);
            // The estimate does not include the page's pictures.
            let over = (page.len() as u64).saturating_sub(most);
            if over == 0 || side <= LEAST_TEXTURE_SIDE || scene.textures().is_empty() {
                return Ok((page, viewer.warnings));
            }
            side = fitting_side(&scene, texture_bytes(&scene, side).saturating_sub(over)).min(side / 2);
        }
    }

    fn viewer(&self, (mut scene, unit): (Scene, Option<Unit>), facts: &[Fact], side: u32) -> Result<Viewer> {
        let facts = facts.iter().cloned().chain(shrink(&mut scene, side)?).collect::<Vec<_>>();
        let settings = RenderSettings::default();
        let prepared = Prepared::new(scene, &settings.surface)?;
        let framing = Framing { size: [1024; 2], all_around: false };
        let Staging { camera, light, bookmarks } = self.staging;
        let (camera, light) = (camera.cloned().unwrap_or_default(), light.cloned().unwrap_or_default());
        let viewpoint = Viewpoint::choose(&camera, framing, prepared.scene())?;
        let view = viewpoint.at(0.0);
        Viewer::new(&Subject {
            title: self.title,
            facts: &facts,
            unit,
            bookmarks,
            prepared: &prepared,
            settings: &settings,
            camera: &view.camera(),
            lighting: &light.lighting(None, prepared.scene(), view),
            development: &Development::default(),
            scan: None,
            errors: self.errors,
            rays: self.rays,
        })
    }
}

/// Returns the source, rights and size of a model, as far as its file states them.
pub fn facts(loaded: &Loaded, file: &str) -> Vec<Fact> {
    let packet = loaded.xmp.first();
    let sources = packet.map(xmp_sources).unwrap_or_default().join("; ");
    let stated = [
        ("File", Some(file.to_owned())),
        ("Triangles", Some(loaded.scene.triangle_count().to_string())),
        ("Copyright", loaded.copyright.clone()),
        ("Rights", packet.and_then(xmp_rights)),
        ("Source", Some(sources).filter(|text| !text.is_empty())),
        ("Made by", loaded.generator.clone()),
    ];
    stated.into_iter().filter_map(|(name, value)| Some(Fact::new(name, value?))).collect()
}

/// Returns the largest texture side, a power of two, with an estimated size of at most `most` bytes.
fn fitting_side(scene: &Scene, most: u64) -> u32 {
    let sides = std::iter::successors(Some(MOST_TEXTURE_SIDE), |side| Some(side / 2));
    let mut sides = sides.take_while(|side| *side >= LEAST_TEXTURE_SIDE);
    sides.find(|side| texture_bytes(scene, *side) <= most).unwrap_or(LEAST_TEXTURE_SIDE)
}

/// Estimates the size in base64 bytes of textures with sides of at most `side` texels, from their coarse levels.
fn texture_bytes(scene: &Scene, side: u32) -> u64 {
    /// The side of the levels that are encoded, texels.
    const SAMPLE: u32 = 64;
    let bytes = |texture: &Texture| {
        let is_whole = texture.width().max(texture.height()) <= side;
        if let (true, Some(file)) = (is_whole, texture.bitmap().file()) {
            return file.len() as u64 * 4 / 3;
        }
        let sample = shrunk(texture, SAMPLE);
        let bitmap = sample.level(0);
        let count = |width: u32, height: u32| f64::from(width) * f64::from(height);
        let mut sizes = (0..texture.levels()).map(|level| texture.level_size(level));
        let (width, height) = sizes.find(|(width, height)| *width.max(height) <= side).unwrap_or_default();
        // Three bytes per texel if its format cannot be encoded.
        let encoded = taotie_io::encode_webp_bitmap(bitmap).map_or(f64::INFINITY, |bytes| bytes.len() as f64);
        let each = (encoded / count(bitmap.width(), bitmap.height())).min(3.0);
        (each * count(width, height) * 4.0 / 3.0) as u64
    };
    scene.textures().iter().map(bytes).sum()
}

/// Replaces textures that are too large for a page by coarser levels, and returns the fact stating this.
fn shrink(scene: &mut Scene, side: u32) -> Result<Option<Fact>> {
    let is_large = |texture: &Texture| texture.width().max(texture.height()) > side;
    if !scene.textures().iter().any(is_large) {
        return Ok(None);
    }
    scene.edit(|data| data.textures.iter_mut().for_each(|texture| *texture = shrunk(texture, side)))?;
    let text = format!("at most {side} × {side}; those of the asset are larger");
    Ok(Some(Fact::new("Textures on this page", text)))
}

fn shrunk(texture: &Texture, side: u32) -> Texture {
    let fits = |level: &usize| {
        let (width, height) = texture.level_size(*level);
        width.max(height) <= side
    };
    match (0..texture.levels()).find(fits) {
        None | Some(0) => texture.clone(),
        Some(level) => Texture::new(texture.level(level).clone(), texture.encoding()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::{Bitmap, Encoding, Texels};
    use taotie_engine::mesh::Mesh;
    use taotie_engine::scene::Material;

    fn texture(width: u32, height: u32) -> Texture {
        let texels = Texels::U8(vec![[7, 8, 9, 255]; (width * height) as usize]);
        Texture::new(Bitmap::new(width, height, 3, texels).unwrap(), Encoding::Linear)
    }

    #[test]
    fn large_maps_become_smaller() {
        let of = |width: u32, height: u32| {
            let small = shrunk(&texture(width, height), 2048);
            [small.width(), small.height()]
        };
        assert_eq!([of(4096, 16), of(16, 2048), of(5000, 2)], [[2048, 8], [16, 2048], [1250, 1]]);
    }

    #[test]
    fn a_fact_reports_reduced_textures() {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        scene.add_texture(texture(16, 2048));
        assert!(shrink(&mut scene, 2048).unwrap().is_none());
        scene.add_texture(texture(2049, 1));
        assert!(shrink(&mut scene, 2048).unwrap().is_some());
        assert_eq!(scene.textures()[1].width(), 1024);
    }

    #[test]
    fn textures_are_as_large_as_their_bytes_allow() {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        assert_eq!(fitting_side(&scene, 0), MOST_TEXTURE_SIDE, "there are no textures");
        let noise = (0..512u32 * 512).map(|i| taotie_engine::math::integration::hash(7, i).to_le_bytes());
        let bitmap = Bitmap::new(512, 512, 3, Texels::U8(noise.collect())).unwrap();
        scene.add_texture(Texture::new(bitmap, Encoding::Linear));
        let sides = [2_000_000, 400_000, 90_000, 0].map(|most| fitting_side(&scene, most));
        assert_eq!(sides, [2048, 256, 128, 128]);
    }
}
