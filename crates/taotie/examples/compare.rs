//! Compares two meshes of one object: how far do the normals of the low-poly mesh deviate from its high-poly
//! reference?
//!
//! ```text
//! cargo run --release -p taotie --example compare
//! ```

use taotie::comparison::{Comparison, ComparisonOptions, Method, Subject};
use taotie::{Material, Mesh, Progress, Result, Scene, SurfaceMethod};

/// Prints the mean angle between the normals of a coarse sphere and those of a fine one.
#[allow(clippy::print_stdout, reason = "an example prints")]
pub fn main() -> Result<()> {
    for (method, degrees) in compare()? {
        println!("{method:<8} {degrees:>6.2}°");
    }
    Ok(())
}

/// Returns each method with its mean angular error in degrees.
pub fn compare() -> Result<Vec<(String, f64)>> {
    let [low, high] = [[24, 12], [512, 256]]
        .map(|[columns, rows]| Scene::of_mesh(Mesh::sphere(1.0, columns, rows), Material::default()));
    let (low, high) = (low?, high?);
    let subject = Subject::new("a coarse sphere", &low).with_reference("a fine sphere", &high);
    let methods = [SurfaceMethod::Facet, SurfaceMethod::Smooth].map(Method::from).to_vec();
    let options = ComparisonOptions { methods, ..ComparisonOptions::default() };
    let report = Comparison::of(&subject, &options, Progress::SILENT)?.report();
    let methods = report.methods.iter();
    Ok(methods.filter_map(|method| Some((method.method.clone(), method.inner_mean()?))).collect())
}
