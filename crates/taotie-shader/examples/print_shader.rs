//! Prints the shader of a plain surface: `cargo run -p taotie-shader --example print_shader -- ggx wgsl`.

use std::io::Write;
use taotie_engine::names::Named;
use taotie_engine::scene::Material;
use taotie_engine::shade::Shading;
use taotie_shader::{Language, Variant, VariantOptions, pixel_shader};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments.next().unwrap_or_else(|| "ggx".into());
    let shading = Shading::from_name(&model)?;
    let language = match arguments.next().as_deref() {
        None | Some("wgsl") => Language::Wgsl,
        Some("glsl-es") => Language::GlslEs,
        Some(other) => return Err(format!("unknown language `{other}`; expected wgsl or glsl-es").into()),
    };
    let options = VariantOptions { shading, ..VariantOptions::default() };
    let shader = pixel_shader(&Variant::new(&Material::default(), &options), language);
    Ok(std::io::stdout().write_all(shader.text.as_bytes())?)
}
