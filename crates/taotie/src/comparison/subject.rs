//! The model to compare, and its ground truth.

use crate::{Result, Warnings};
use taotie_engine::scene::{Material, Scene};

/// The maximum difference in position or size of model and reference, as a fraction of the diagonal.
const TOLERANCE: f64 = 0.05;

/// A scene with the name used for it in reports and warnings, such as its file's.
///
/// ```
/// # use taotie::{Material, Mesh, Scene};
/// use taotie::comparison::{NamedScene, Subject};
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let model = NamedScene { name: "low.glb", scene: &ball };
/// assert_eq!(Subject { model, reference: None }.report().model, "low.glb");
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct NamedScene<'a> {
    /// The name.
    pub name: &'a str,
    /// The scene.
    pub scene: &'a Scene,
}

/// A model, and optionally a high-poly reference: the same object with its relief as geometry.
///
/// ```
/// # use taotie::{Material, Mesh, Scene};
/// use taotie::comparison::Subject;
///
/// let low = Scene::of_mesh(Mesh::sphere(1.0, 24, 12), Material::default())?;
/// let high = Scene::of_mesh(Mesh::sphere(1.0, 256, 128), Material::default())?;
/// let subject = Subject::new("low.glb", &low).with_reference("scan.ply", &high);
/// assert_eq!(subject.reference.map(|reference| reference.name), Some("scan.ply"));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// The model.
    pub model: NamedScene<'a>,
    /// The ground truth. Without it the others are compared with the first method.
    pub reference: Option<NamedScene<'a>>,
}

/// The names and sizes of the compared models.
///
/// ```
/// # use taotie::{Material, Mesh, Scene};
/// use taotie::comparison::Subject;
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let report = Subject::new("ball", &ball).report();
/// assert_eq!((report.model.as_str(), report.triangles), ("ball", 960));
/// assert!(report.reference.is_none());
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct SubjectReport {
    /// The model's file or name.
    pub model: String,
    /// Its triangles.
    pub triangles: usize,
    /// The reference's file or name.
    pub reference: Option<String>,
    /// Its triangles.
    pub reference_triangles: Option<usize>,
}

impl<'a> Subject<'a> {
    /// Makes a subject of a model without a reference.
    pub fn new(name: &'a str, model: &'a Scene) -> Self {
        Self { model: NamedScene { name, scene: model }, reference: None }
    }

    /// Returns the same model, with `reference` to compare it with.
    pub fn with_reference(self, name: &'a str, reference: &'a Scene) -> Self {
        Self { reference: Some(NamedScene { name, scene: reference }), ..self }
    }

    /// Returns the names and the numbers of triangles.
    pub fn report(&self) -> SubjectReport {
        SubjectReport {
            model: self.model.name.into(),
            triangles: self.model.scene.triangle_count(),
            reference: self.reference.map(|reference| reference.name.into()),
            reference_triangles: self.reference.map(|reference| reference.scene.triangle_count()),
        }
    }

    /// Warns if model and reference are not in the same place.
    pub(super) fn check_place(&self, warnings: &mut Warnings) {
        let Some(reference) = self.reference else { return };
        let (Some(a), Some(b)) = (self.model.scene.bounds(), reference.scene.bounds()) else { return };
        let off = (a.center() - b.center()).length().max((a.diagonal() - b.diagonal()).abs());
        if off > TOLERANCE * a.diagonal() {
            let percent = 100.0 * off / a.diagonal();
            let what = "position or size differs from the model's by";
            let advice = "angles between them mean little; use one coordinate system for both";
            warnings.note(format!("{}: {what} {percent:.0} % of its diagonal: {advice}", reference.name), 1);
        }
    }

    /// Gives materials of a reference that are all defaults the factors of the model's first, so that both match.
    ///
    /// ```
    /// # use taotie::{Material, Mesh, Scene};
    /// use taotie::comparison::Subject;
    ///
    /// let metal = Material { metallic: 1.0, ..Material::default() };
    /// let model = Scene::of_mesh(Mesh::sphere(1.0, 24, 12), metal)?;
    /// let mut reference = Scene::of_mesh(Mesh::sphere(1.0, 256, 128), Material::default())?;
    /// Subject::dress_reference(&mut reference, &model)?;
    /// assert_eq!(reference.materials()[0].metallic, 1.0);
    /// # Ok::<(), taotie::Error>(())
    /// ```
    ///
    /// # Errors
    /// Only if the model's factors are invalid, which they are not in a validated scene.
    pub fn dress_reference(reference: &mut Scene, model: &Scene) -> Result<()> {
        let Some(first) = model.materials().first() else { return Ok(()) };
        reference.edit(|reference| {
            for material in &mut reference.materials {
                let silent = Material { name: material.name.clone(), ..Material::default() };
                if *material == silent {
                    *material = without_textures(first);
                }
            }
        })
    }
}

fn without_textures(material: &Material) -> Material {
    let mut material = material.clone();
    material.retain_textures(|_| false);
    material
}
