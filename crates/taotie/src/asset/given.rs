//! The low-poly mesh that is given: read, with what stays of its material.

use super::document::{self, Document, KeptMaterial, shown_materials};
use super::kept_textures::{KeptTextures, note_samplers};
use super::low_file::Read;
use super::options::{BakeOptions, MeshSource};
use super::plan::LowLook;
use super::stripped::Stripped;
use crate::bake::{self, MapKind};
use crate::error::{Result, Warnings};
use crate::mesh::{Mesh, MeshData};
use crate::scene::{AlphaMode, Instance, Material, Scene};

/// A low-poly mesh as its file says.
pub(super) struct GivenMesh {
    scene: Scene,
    /// One for each material that stays, at least one.
    parts: Vec<GivenPart>,
    document: Option<Document>,
}

/// The triangles of a low-poly mesh that show one material.
struct GivenPart {
    /// The material, without what cannot stay.
    material: Material,
    stripped: Stripped,
    /// The material of the file that is kept; `None` where all triangles show the first.
    own: Option<KeptMaterial>,
}

/// The parts of a mesh that is given which go into the asset.
pub(super) struct Taken {
    pub mesh: Mesh,
    pub material: Material,
    pub kept: KeptTextures,
    pub own: Option<KeptMaterial>,
}

impl GivenMesh {
    /// Takes a mesh that was read, at rest.
    ///
    /// # Errors
    /// [`Error::Unsupported`](crate::Error::Unsupported) for what the asset could not keep of it; those of writing it
    /// anew.
    pub fn of(
        options: &BakeOptions,
        source: &MeshSource,
        mut read: Read,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let document = document::kept(source, &mut read, options, warnings)?;
        match document {
            Some(document) => Self::of_document(document, read.scene),
            None => Ok(Self::of_one(read.scene, warnings)),
        }
    }

    /// Makes all of a scene one mesh of its first material.
    fn of_one(scene: Scene, warnings: &mut Warnings) -> Self {
        let used: Vec<usize> = scene.instances().iter().map(|instance| instance.material).collect();
        if used.iter().any(|material| *material != used[0]) {
            warnings.note("materials of the low-poly mesh made one, the first", 1);
        }
        let mut material = used.first().and_then(|m| scene.materials().get(*m)).cloned().unwrap_or_default();
        let stripped = Stripped::off(&mut material, &scene);
        Self { scene, parts: vec![GivenPart { material, stripped, own: None }], document: None }
    }

    /// Takes the materials of a file that stays.
    fn of_document(document: Document, scene: Scene) -> Result<Self> {
        let numbers = shown_materials(&scene);
        let labels = document::labels(&scene, &numbers);
        let mut triangles = document::triangles_by_material(&scene);
        let part = |(number, label): (usize, String)| {
            let material = scene.materials()[number].clone();
            let triangles = triangles.remove(&number).unwrap_or_default();
            let own = KeptMaterial { number, label, said: material.clone(), drops_colors: false, triangles };
            GivenPart { material, stripped: Stripped::default(), own: Some(own) }
        };
        let parts: Vec<GivenPart> = labels.into_iter().map(part).collect();
        let whole = match parts.len() {
            1 => None,
            _ => Some(bake::framed_low_poly_mesh(scene.clone())?),
        };
        Ok(Self { scene, parts, document: Some(Document { whole, ..document }) })
    }

    /// Returns the looks of each material.
    pub fn looks(&self) -> Vec<LowLook<'_>> {
        let meshes = self.scene.meshes();
        let shows = |part: &GivenPart, instance: &Instance| {
            part.own.as_ref().is_none_or(|own| own.number == instance.material)
        };
        let has_colors = |part: &GivenPart| {
            let mut own = self.scene.instances().iter().filter(|instance| shows(part, instance));
            own.any(|instance| !meshes[instance.mesh].colors().is_empty())
        };
        let parts = self.parts.iter();
        parts.map(|part| LowLook { material: &part.material, has_colors: has_colors(part) }).collect()
    }

    /// Returns the number of materials that get maps of their own, at least 1.
    pub fn material_count(&self) -> u64 {
        self.parts.len() as u64
    }

    /// Returns the number of all its triangles.
    pub fn triangle_count(&self) -> usize {
        let meshes = self.scene.meshes();
        self.scene.instances().iter().map(|instance| meshes[instance.mesh].triangles().len()).sum()
    }

    /// Returns its materials to be filled.
    pub fn materials_mut(&mut self) -> impl Iterator<Item = &mut Material> {
        self.parts.iter_mut().map(|part| &mut part.material)
    }

    /// Takes the file that stays.
    pub fn take_document(&mut self) -> Option<Document> {
        self.document.take()
    }

    /// Takes what stays of each part: one mesh in world space, and the material without what is baked in its place. That
    /// and what cannot stay is noted.
    ///
    /// # Errors
    /// Those of [`bake::low_poly_mesh`].
    pub fn taken(self, options: &BakeOptions, warnings: &mut Warnings) -> Result<Vec<Taken>> {
        let Self { scene, parts, .. } = self;
        let mut scenes: Vec<Scene> = Vec::with_capacity(parts.len());
        for part in &parts {
            let mut own = scene.clone();
            if let Some(kept) = &part.own {
                own.edit(|scene| scene.instances.retain(|instance| instance.material == kept.number))?;
            }
            scenes.push(own);
        }
        // The only mesh is taken without a copy.
        drop(scene);
        let taken = parts.into_iter().zip(scenes).map(|(part, scene)| part.taken(scene, options, warnings));
        taken.collect()
    }
}

impl GivenPart {
    fn taken(self, scene: Scene, options: &BakeOptions, warnings: &mut Warnings) -> Result<Taken> {
        let Self { mut material, stripped, own } = self;
        if let Some(own) = own {
            let kept = KeptTextures::beside_roughness(&mut material, &scene, options, warnings);
            leave_alpha(&mut material, options, warnings);
            let mesh = bake::framed_low_poly_mesh(scene)?;
            let drops_colors = !mesh.colors().is_empty() && options.bakes(&[MapKind::Albedo]);
            let mesh = uncolored(mesh, options, warnings)?;
            return Ok(Taken { mesh, material, kept, own: Some(KeptMaterial { drops_colors, ..own }) });
        }
        let kept = KeptTextures::of(&material, &scene);
        stripped.note(options, warnings);
        note_samplers(&material, &scene, options, warnings);
        leave_relief(&material, options, warnings);
        leave_alpha(&mut material, options, warnings);
        let mesh = uncolored(joined(scene, options)?, options, warnings)?;
        Ok(Taken { mesh, material, kept, own: None })
    }
}

/// Returns all of a scene as one mesh. Maps alone are for the file that it is from, so its meshes have the tangents that
/// viewers of that give them; else the mesh is written anew, with tangents of its own.
fn joined(scene: Scene, options: &BakeOptions) -> Result<Mesh> {
    let has_uvs = |instance: &Instance| !scene.meshes()[instance.mesh].uvs().is_empty();
    let is_for_file = options.keep_uvs && scene.instances().iter().all(has_uvs);
    if is_for_file { bake::framed_low_poly_mesh(scene) } else { bake::low_poly_mesh(scene) }
}

/// Leaves out the normal map, which is of other tangents.
fn leave_relief(material: &Material, options: &BakeOptions, warnings: &mut Warnings) {
    let has_relief = material.normal.is_some() && !options.bakes(&[MapKind::Normal]);
    warnings.note(
        "the low-poly mesh's normal map is left out; bake normal in its place",
        usize::from(has_relief),
    );
}

/// Leaves out alpha that stands in a texture in whose place colours without alpha are baked.
fn leave_alpha(material: &mut Material, options: &BakeOptions, warnings: &mut Warnings) {
    let is_textured = material.alpha != AlphaMode::Opaque && material.base_color_texture.is_some();
    if is_textured && options.bakes(&[MapKind::Albedo]) && !options.bakes(&[MapKind::Alpha]) {
        warnings.note("the low-poly mesh's alpha is left out: albedo is baked without", 1);
        material.alpha = AlphaMode::Opaque;
    }
}

/// Leaves out colours of vertices that would be multiplied with the baked ones.
fn uncolored(mesh: Mesh, options: &BakeOptions, warnings: &mut Warnings) -> Result<Mesh> {
    if mesh.colors().is_empty() || !options.bakes(&[MapKind::Albedo]) {
        return Ok(mesh);
    }
    warnings.note("the low-poly mesh's vertex colours are left out: albedo is baked in their place", 1);
    Mesh::new(MeshData { colors: Vec::new(), ..mesh.into_data() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Mat4, Vec3};

    /// Returns the mesh that a ball, stretched in its file, is taken as.
    fn taken(keep_uvs: bool, ball: &MeshData) -> (Scene, Mesh) {
        let mut scene = Scene::of_mesh(Mesh::new(ball.clone()).unwrap(), Material::default()).unwrap();
        let stretched = Mat4::scale(Vec3::new(1.0, 3.0, 1.0));
        scene.edit(|scene| scene.instances[0].world_from_object = stretched).unwrap();
        let mut warnings = Warnings::default();
        let given = GivenMesh::of_one(scene.clone(), &mut warnings);
        let options = BakeOptions { keep_uvs, ..BakeOptions::default() };
        (scene, given.taken(&options, &mut warnings).unwrap().remove(0).mesh)
    }

    #[test]
    fn maps_alone_have_the_frames_of_the_file() {
        let ball = MeshData { tangents: Vec::new(), ..Mesh::sphere(1.0, 8, 4).into_data() };
        let (scene, mesh) = taken(true, &ball);
        let own = bake::framed_low_poly_mesh(scene).unwrap();
        assert!(!own.tangents().is_empty() && mesh.tangents() == own.tangents());
        assert!(taken(false, &ball).1.tangents().is_empty(), "a mesh that is written anew gets its own");
        let bare = MeshData { uvs: Vec::new(), ..ball };
        assert!(taken(true, &bare).1.uvs().is_empty(), "the lack of uvs is told where maps need them");
    }
}
