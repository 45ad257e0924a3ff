//! The viewer of an asset as it lies on disk, under the light and by the camera that a picture has where nothing is said.

use super::{MeasuredErrors, Subject, Viewer, facts};
use crate::Fact;
use std::path::Path;
use taotie::Result;
use taotie::asset::{Limits, model_unit};
use taotie::film::Development;
use taotie::image::Texture;
use taotie::render::{Prepared, RenderSettings};
use taotie::scene::Scene;
use taotie::studio::{self, CameraOptions, Framing, LightOptions, MaterialOptions, Viewpoint};

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

impl AssetSubject<'_> {
    /// Makes its viewer. Textures of more than [`MOST_TEXTURE_SIDE`] texels along a side are taken smaller, and a fact of the page says so.
    /// What is wrong in the file is not told once more: its proof has read it before.
    ///
    /// # Errors
    /// Those of [`studio::load_within`] and [`Viewer::new`].
    pub fn viewer(&self) -> Result<Viewer> {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let mut loaded = studio::load_within(self.path, &MaterialOptions::default(), self.limits)?;
        let mut facts = facts(&loaded, &name);
        facts.extend(shrink(&mut loaded.scene)?);
        let unit = model_unit(&loaded);
        let settings = RenderSettings::default();
        let prepared = Prepared::new(loaded.scene, &settings.surface)?;
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
            scan: None,
            errors: self.errors,
        })
    }
}

/// Takes coarser levels of textures that are too large for a page, and returns the fact that says so.
fn shrink(scene: &mut Scene) -> Result<Option<Fact>> {
    let is_large = |texture: &Texture| texture.width().max(texture.height()) > MOST_TEXTURE_SIDE;
    if !scene.textures().iter().any(is_large) {
        return Ok(None);
    }
    scene.edit(|data| data.textures.iter_mut().for_each(|texture| *texture = shrunk(texture)))?;
    let said = format!("at most {MOST_TEXTURE_SIDE} × {MOST_TEXTURE_SIDE}; the asset's are larger");
    Ok(Some(Fact::new("Textures of this page", said)))
}

fn shrunk(texture: &Texture) -> Texture {
    let fits = |level: &usize| {
        let (width, height) = texture.level_size(*level);
        width.max(height) <= MOST_TEXTURE_SIDE
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
            let small = shrunk(&texture(width, height));
            [small.width(), small.height()]
        };
        assert_eq!([of(4096, 16), of(16, 2048), of(5000, 2)], [[2048, 8], [16, 2048], [1250, 1]]);
    }

    #[test]
    fn the_page_says_that_they_are() {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        scene.add_texture(texture(16, 2048));
        assert!(shrink(&mut scene).unwrap().is_none());
        scene.add_texture(texture(2049, 1));
        assert!(shrink(&mut scene).unwrap().is_some());
        assert_eq!(scene.textures()[1].width(), 1024);
    }
}
