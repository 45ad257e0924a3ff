//! The viewer of an asset as it lies on disk, under the light and by the camera that a picture has where nothing is said.

use super::{MeasuredErrors, Subject, Viewer, facts};
use crate::Fact;
use std::path::Path;
use taotie::asset::{Limits, model_unit};
use taotie::film::Development;
use taotie::image::Texture;
use taotie::length::Unit;
use taotie::render::{Prepared, RenderSettings};
use taotie::scene::Scene;
use taotie::studio::{self, CameraOptions, Framing, LightOptions, MaterialOptions, Viewpoint};
use taotie::{Result, Warnings};

/// Texels along a side of the textures that the page holds, at most.
pub const MOST_TEXTURE_SIDE: u32 = 2048;

/// An asset as it lies on disk.
#[derive(Clone, Copy)]
pub struct AssetSubject<'a> {
    /// Its file.
    pub path: &'a Path,
    /// The heading.
    pub title: &'a str,
    /// How much may be read.
    pub limits: &'a Limits,
    /// Its errors where they are known.
    pub errors: Option<MeasuredErrors<'a>>,
}

/// What a page may lose of textures to keep to its size.
#[derive(Debug, Clone, Copy)]
struct Reduction {
    /// Texels along a side, at most.
    side: u32,
    /// The quality of base colour and emission as lossy WebP; `None` loses nothing.
    quality: Option<u8>,
}

/// Reductions in the order in which they are tried.
const REDUCTIONS: [Reduction; 5] = [
    Reduction { side: MOST_TEXTURE_SIDE, quality: None },
    Reduction { side: MOST_TEXTURE_SIDE, quality: Some(90) },
    Reduction { side: MOST_TEXTURE_SIDE / 2, quality: Some(90) },
    Reduction { side: MOST_TEXTURE_SIDE / 4, quality: Some(85) },
    Reduction { side: MOST_TEXTURE_SIDE / 8, quality: Some(80) },
];

/// Returns the bytes that a page of an asset of `bytes` may have: the asset in base64, and 3 MB for all else.
pub fn most_page_bytes(bytes: u64) -> u64 {
    bytes / 100 * 134 + 3_000_000
}

impl AssetSubject<'_> {
    /// Writes a page with its viewer. Textures of more than [`MOST_TEXTURE_SIDE`] texels along a side are taken smaller, and
    /// more is lost of them where the page has more than [`most_page_bytes`]; a fact of the page says so. What is wrong in the
    /// file is not noted again: its proof has read it before.
    ///
    /// # Errors
    /// Those of [`studio::load_within`] and [`Viewer::new`].
    pub fn page(&self, write: &dyn Fn(&Viewer) -> String) -> Result<(String, Warnings)> {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let mut loaded = studio::load_within(self.path, &MaterialOptions::default(), self.limits)?;
        let (facts, most) = (facts(&loaded, &name), most_page_bytes(loaded.bytes.unwrap_or_default()));
        let (scene, unit) = (std::mem::take(&mut loaded.scene), model_unit(&loaded));
        let texels: usize = scene.textures().iter().map(texels_of_page).sum();
        let mut last = None;
        for reduction in REDUCTIONS {
            let viewer = self.viewer(scene.clone(), (&facts, unit), reduction)?;
            let page = write(&viewer);
            let is_small = page.len() as u64 <= most;
            // Losing more of textures is of no use if all else is too large already.
            let is_vain = page.len().saturating_sub(texels * MOST_TEXEL_BYTES) as u64 > most;
            last = Some((page, viewer.warnings));
            if is_small || is_vain {
                break;
            }
        }
        Ok(last.unwrap_or_default())
    }

    fn viewer(
        &self,
        mut scene: Scene,
        (facts, unit): (&[Fact], Option<Unit>),
        reduction: Reduction,
    ) -> Result<Viewer> {
        let facts = [facts, &reduce(&mut scene, reduction)?].concat();
        let settings = RenderSettings::default();
        let prepared = Prepared::new(scene, &settings.surface)?;
        let framing = Framing { size: [1024; 2], all_around: false };
        let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, prepared.scene())?;
        let view = viewpoint.at(0.0);
        Viewer::new(&Subject {
            title: self.title,
            facts: &facts,
            unit,
            bookmarks: &[],
            prepared: &prepared,
            settings: &settings,
            camera: &view.camera(),
            lighting: &LightOptions::default().lighting(None, prepared.scene(), view),
            development: &Development::default(),
            quality: reduction.quality,
            scan: None,
            errors: self.errors,
        })
    }
}

/// Bytes of a page that a texel takes, at most: four in base64.
const MOST_TEXEL_BYTES: usize = 6;

/// Returns the texels that the page holds of a texture, at most.
fn texels_of_page(texture: &Texture) -> usize {
    [texture.width(), texture.height()].map(|side| side.min(MOST_TEXTURE_SIDE) as usize).iter().product()
}

/// Takes coarser levels of textures that are too large for a page, and returns the fact that says what is lost.
fn reduce(scene: &mut Scene, Reduction { side, quality }: Reduction) -> Result<Vec<Fact>> {
    let is_large = |texture: &Texture| texture.width().max(texture.height()) > side;
    let mut losses = Vec::new();
    if scene.textures().iter().any(is_large) {
        scene.edit(|data| data.textures.iter_mut().for_each(|texture| *texture = shrunk(texture, side)))?;
        losses.push(format!("at most {side} × {side}; the asset's are larger"));
    }
    if let Some(quality) = quality.filter(|_| !scene.textures().is_empty()) {
        losses.push(format!("colours of quality {quality}"));
    }
    let fact = Fact::new("Textures of this page", losses.join("; "));
    Ok(if losses.is_empty() { Vec::new() } else { vec![fact] })
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
    use taotie::image::{Bitmap, Encoding, Texels};
    use taotie::mesh::Mesh;
    use taotie::scene::Material;

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
    fn the_page_says_what_it_lost() {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        scene.add_texture(texture(16, 2048));
        let [whole, lossy, half, ..] = REDUCTIONS;
        assert!(reduce(&mut scene, whole).unwrap().is_empty());
        assert_eq!(reduce(&mut scene.clone(), lossy).unwrap()[0].value, "colours of quality 90");
        let said = "at most 1024 × 1024; the asset's are larger; colours of quality 90";
        assert_eq!(reduce(&mut scene, half).unwrap()[0].value, said);
        assert_eq!(scene.textures()[0].height(), 1024);
    }
}
