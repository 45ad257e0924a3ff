//! Writes the jue as files, for trying out the other subcommands.

use super::{Output, Vessel};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use taotie_engine::image::{Texels, Texture};
use taotie_engine::mesh::Mesh;
use taotie_engine::{Error, Result};
use taotie_io::{FileSet, PngColor, PngImage, PngSamples};

/// The names of the jue's textures in the order of its scene, without extensions.
const MAPS: [&str; 4] = ["color", "orm", "normal", "height"];

/// Writes `jue.obj`, `jue.mtl` and the maps; returns the files.
///
/// # Errors
/// [`Error::Io`] if a file cannot be written.
pub fn write(output: &Output<'_>, vessel: &Vessel) -> Result<Vec<PathBuf>> {
    let Output { files: set, folder, .. } = output;
    let mut files = vec![folder.join("jue.obj"), folder.join("jue.mtl")];
    set.write_text(&files[0], &obj(vessel.mesh()))?;
    set.write_text(&files[1], &mtl())?;
    for (name, texture) in MAPS.iter().zip(vessel.scene().textures()) {
        let path = folder.join(format!("jue_{name}.png"));
        write_map(set, &path, texture)?;
        files.push(path);
    }
    Ok(files)
}

/// Returns the mesh as OBJ, which has its uv origin at the bottom left and indices starting at 1.
fn obj(mesh: &Mesh) -> String {
    let mut text = String::from("# The built-in jue, 251 vertices\nmtllib jue.mtl\nusemtl jue\n");
    for p in mesh.positions() {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for uv in &mesh.uvs()[0] {
        let _ = writeln!(text, "vt {} {}", uv.x, 1.0 - uv.y);
    }
    for n in mesh.normals() {
        let _ = writeln!(text, "vn {} {} {}", n.x, n.y, n.z);
    }
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|i| i + 1);
        let _ = writeln!(text, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}");
    }
    text
}

/// Returns the material file. The same file for roughness and metalness means that they are packed as in glTF.
fn mtl() -> String {
    "newmtl jue\nKd 1 1 1\nmap_Kd jue_color.png\nmap_Pr jue_orm.png\nmap_Pm jue_orm.png\nnorm jue_normal.png\n".into()
}

fn write_map(set: &FileSet, path: &Path, texture: &Texture) -> Result<()> {
    let bitmap = texture.bitmap();
    let channels = if bitmap.channels() == 1 { 1 } else { 3 };
    let color = if channels == 1 { PngColor::Grey } else { PngColor::Rgb };
    let encoding = texture.encoding();
    let (width, height) = (bitmap.width(), bitmap.height());
    let write =
        |samples: PngSamples<'_>| set.write_png(path, &PngImage { width, height, color, samples, encoding });
    match bitmap.texels() {
        Texels::U8(texels) => {
            let samples: Vec<u8> = texels.iter().flat_map(|t| &t[..channels]).copied().collect();
            write(PngSamples::U8(&samples))?;
        }
        Texels::U16(texels) => {
            let samples: Vec<u16> = texels.iter().flat_map(|t| &t[..channels]).copied().collect();
            write(PngSamples::U16(&samples))?;
        }
        Texels::F32(_) => {
            let why = format!("{}: PNG supports only 8 or 16 bits", path.display());
            return Err(Error::unsupported("exporting a float map", why));
        }
    }
    Ok(())
}
