//! The page that explains how to bind shaders.

use super::args::{ShaderArgs, Target};
use super::description::{Description, SurfaceValues};
use super::files::TABLES;
use taotie_engine::names::Named;
use taotie_engine::scene::TextureRole;
use taotie_report::{Cell, Column, Fact, Page, Section};
use taotie_shader::{BufferSlot, TextureSlot, UniformField, ValueKind};

/// Maximum number of surfaces whose values a table shows.
const MOST_COLUMNS: usize = 8;

/// Makes the page of shaders and of all `files` next to it.
pub fn page(args: &ShaderArgs, shaders: &[Description], files: &[&str]) -> Page {
    let model = args.model.as_ref().and_then(|path| path.file_name());
    let title = model.map_or("A plain material".into(), |name| name.to_string_lossy());
    let mut sections = vec![Section::Text { title: "How to bind them".into(), paragraphs: how(args.target) }];
    if args.target == Target::GlslEs {
        sections.extend(shaders.first().map(example));
    }
    sections.push(Section::Text { title: "Inputs and outputs".into(), paragraphs: owned(&CONTRACT) });
    sections.push(file_table(files));
    if let Some(shader) = shaders.first() {
        sections.push(frame_table(shader));
    }
    sections.extend(shaders.iter().flat_map(shader_tables));
    Page {
        title: title.into_owned(),
        subtitle: format!("Shaders in {}", args.target.name()),
        facts: facts(args, shaders),
        sections,
        footer: format!(
            "Made by taotie {}. The .json files also contain all of this.",
            env!("CARGO_PKG_VERSION")
        ),
        ..Page::default()
    }
}

fn facts(args: &ShaderArgs, shaders: &[Description]) -> Vec<Fact> {
    let mut facts = vec![
        Fact::new("Shaders", shaders.len().to_string()),
        Fact::new("Reflectance model", args.surface.shading.name()),
    ];
    if let Some(environment) = &args.env {
        facts.push(Fact::new("Environment", environment));
    }
    facts
}

fn owned(paragraphs: &[&str]) -> Vec<String> {
    paragraphs.iter().map(|text| (*text).to_owned()).collect()
}

/// Facts that every host needs to know.
const CONTRACT: [&str; 5] = [
    "Vertices are in world space. Positions are multiplied only by frame.clip_from_world.",
    "The fragment is linear RGB radiance, not premultiplied by alpha, and alpha. The host applies exposure, tone curve \
     and the sRGB curve, and blends.",
    "Colour textures are decoded from sRGB before they are filtered. A normal map holds the variance of its vectors, \
     1 − |mean|², in the alpha of every level but the finest, where alpha is 0: means of unit vectors are stored without \
     renormalising them. An ordinary mip chain with alpha 1 would blur every highlight.",
    "albedo-tables.bin is the texture albedo_tables: 64 texels across and 144 down, four 32-bit floats each, \
     little-endian, row by row. It is read texel by texel, without a sampler.",
    "A light is 16 floats: the position or the unit direction to it, its kind (0 infinitely far, 1 without falloff, 2 \
     falling off by the inverse square), its colour, its range, the unit axis of its cone, the cosines of the inner and \
     the outer angle, and three unused. Lights other than spots have the cosines −2 and −3; lights without a range \
     have 1e18.",
];

fn how(target: Target) -> Vec<String> {
    owned(match target {
        Target::Wgsl => &[
            "The entry points are vertex_main and fragment_main. Bind the frame as group 0 and the material as group 1, as the \
             tables below show.",
            "The crate taotie-gpu binds these shaders with wgpu: it is a host to use or to read.",
        ],
        Target::GlslEs => &[
            "NAME.vert and NAME.frag form a WebGL 2 program. Buffers are the uniform blocks FrameBlock, LightBlock, \
             EnvironmentBlock and MaterialBlock, in the std140 layout; a texture with its sampler is one sampler2D.",
            "A host with its own lights defines the macro HOST_LIGHTS and adds the function vec3 \
             host_lights(SurfacePoint p, vec3 position), which sums reflect_light(p, l) times the irradiance. There is then no \
             LightBlock.",
            "material.js makes three.js materials for WebGLRenderer this way. The mesh keeps its place in the scene: transforms, \
             skins, morph targets, instances, lights, shadows, fog and tone mapping are three.js's. Serve the folder, since \
             browsers fetch nothing for a page opened from disk, and name three in an import map.",
        ],
        Target::Hlsl => &[
            "The entry points are vertex_main and fragment_main, for shader model 5.1. A resource of group g and binding b is \
             register b of space g: b registers for buffers of uniforms, t registers for textures and the lights.",
            "Samplers come from the heap nagaSamplerHeap. The buffer nagaGroup1SamplerIndexArray at t1 of space 255 \
             holds, at the binding of each sampler, its number in the heap.",
        ],
        Target::Msl => &[
            "The entry points are vertex_main and fragment_main, for Metal 2.0. Buffers, textures and samplers are numbered by \
             their positions in the lists buffers and textures of the .json, from 0; a sampler has the number of its texture.",
            "The buffer after the last holds the size of the lights in bytes as a 32-bit integer, if a shader asks for it. \
             Vertices are attributes by their locations: keep their buffers above these.",
        ],
        Target::Spirv => &[
            "The module has the entry points vertex_main and fragment_main, for Vulkan 1.0. A resource of group g and binding b \
             is binding b of descriptor set g. Clip space is WebGPU's, y up: the module flips y.",
        ],
    })
}

/// Returns the code that draws with a shader in three.js.
fn example(shader: &Description) -> Section {
    let roles = shader.interface.textures.iter().filter_map(|slot| TextureRole::named(slot.name));
    let textures: Vec<String> = roles.map(three_texture).collect();
    let is_mapped = textures.iter().any(|line| line.contains("normalTexture("));
    let imports = if is_mapped { "loadMaterial, normalTexture" } else { "loadMaterial" };
    let name = &shader.name;
    let (declared, options) = match textures.is_empty() {
        true => (String::new(), ""),
        false => (format!("const textures = {{\n{}}};\n", textures.concat()), ", { textures }"),
    };
    let code = format!(
        "import {{ {imports} }} from \"./material.js\";\n\n\
         {declared}mesh.material = await loadMaterial(\"{name}\"{options});\n"
    );
    let note = "The mesh has the material that GLTFLoader made, and stays in its scene. A surface other than the first in the \
        .json is chosen by its number, as in { textures, surface: 1 }.";
    Section::Code { title: "In three.js".into(), note: note.into(), code }
}

/// Returns the line that takes a texture from a material of `GLTFLoader`.
fn three_texture(role: TextureRole) -> String {
    let property = match role {
        TextureRole::BaseColor => "map",
        TextureRole::MetallicRoughness => "roughnessMap",
        TextureRole::Occlusion => "aoMap",
        TextureRole::Height => "bumpMap",
        TextureRole::Specular => "specularIntensityMap",
        // The others have glTF's names: `emissiveTexture` is `emissiveMap`.
        _ => &role.gltf_member().replace("Texture", "Map"),
    };
    let texture = format!("mesh.material.{property}");
    let is_vectors = matches!(role, TextureRole::Normal | TextureRole::ClearcoatNormal);
    let value = if is_vectors { format!("normalTexture({texture}, renderer)") } else { texture };
    format!("    {}: {value},\n", role.name())
}

fn file_table(files: &[&str]) -> Section {
    let row = |name: &&str| vec![Cell::text(*name), Cell::text(content(name))];
    Section::Table {
        title: "Files".into(),
        note: String::new(),
        columns: vec![Column::words("file"), Column::words("content")],
        rows: files.iter().map(row).collect(),
    }
}

fn content(name: &str) -> &'static str {
    match name.rsplit_once('.').map_or("", |(_, end)| end) {
        "frag" => "the fragment shader",
        "vert" => "the vertex shader",
        "wgsl" | "hlsl" | "metal" | "spv" => "both shaders",
        "json" => "the bindings, and a model's values",
        "js" => "makes three.js materials",
        _ if name == TABLES => "the tables of directional albedos",
        _ => "the environment as textures",
    }
}

fn frame_table(shader: &Description) -> Section {
    fields("The uniform frame", &format!("{} bytes", shader.frame_bytes), &shader.interface.frame, &[])
}

fn shader_tables(shader: &Description) -> Vec<Section> {
    let Description { name, interface, .. } = shader;
    let mut sections = vec![vertices(shader), bindings(shader)];
    if !interface.material.is_empty() {
        let shown = &shader.surfaces[..shader.surfaces.len().min(MOST_COLUMNS)];
        let note = format!("{} bytes{}", shader.material_bytes, left_out(shader));
        sections.push(fields(&format!("{name}: the uniform material"), &note, &interface.material, shown));
    }
    sections
}

/// Returns a note on the surfaces that the table of values leaves out.
fn left_out(shader: &Description) -> String {
    match shader.surfaces.len() {
        count if count > MOST_COLUMNS => {
            format!("; values of the first {MOST_COLUMNS} surfaces, all {count} are in {}.json", shader.name)
        }
        _ => String::new(),
    }
}

/// Returns the label of a column of values: its material and its instances.
fn label(surface: &SurfaceValues) -> String {
    let SurfaceValues { material, number, instances, .. } = surface;
    let place = match instances.as_slice() {
        [] => return "plain material".into(),
        [instance] => format!("instance {instance}"),
        many => format!("{} instances", many.len()),
    };
    let name = format!("material {number} {material}");
    format!("{} on {place}", name.trim_end())
}

fn vertices(shader: &Description) -> Section {
    let row = |input: &taotie_shader::VertexInput| {
        vec![
            Cell::number(f64::from(input.location), 0),
            Cell::text(&input.name),
            Cell::text(kind(input.kind)),
            Cell::text(input.meaning),
        ]
    };
    Section::Table {
        title: format!("{}: vertices", shader.name),
        note: format!("{}, {}", shader.shading, shader.surface),
        columns: [
            vec![Column::numbers("location", "")],
            ["name", "type", "meaning"].map(Column::words).to_vec(),
        ]
        .concat(),
        rows: shader.interface.vertex.iter().map(row).collect(),
    }
}

fn bindings(shader: &Description) -> Section {
    let buffers = shader.interface.buffers.iter().map(buffer_row);
    let textures = shader.interface.textures.iter().map(texture_row);
    let numbers = ["group", "binding", "sampler"].map(|name| Column::numbers(name, ""));
    Section::Table {
        title: format!("{}: buffers and textures", shader.name),
        note: String::new(),
        columns: [numbers.to_vec(), ["name", "kind", "content"].map(Column::words).to_vec()].concat(),
        rows: buffers.chain(textures).collect(),
    }
}

fn buffer_row(slot: &BufferSlot) -> Vec<Cell> {
    let kind = if slot.storage { "storage" } else { "uniform" };
    vec![
        Cell::number(f64::from(slot.group), 0),
        Cell::number(f64::from(slot.binding), 0),
        Cell::Number { value: None, digits: 0 },
        Cell::text(slot.name),
        Cell::text(format!("{kind}, {}", slot.block)),
        Cell::text(slot.meaning),
    ]
}

fn texture_row(slot: &TextureSlot) -> Vec<Cell> {
    let uv_set = slot.uv_set.map_or(String::new(), |set| format!(", uv{set}"));
    vec![
        Cell::number(f64::from(slot.group), 0),
        Cell::number(f64::from(slot.binding), 0),
        Cell::Number { value: slot.sampler.map(f64::from), digits: 0 },
        Cell::text(slot.name),
        Cell::text(format!("texture{uv_set}")),
        Cell::text(slot.meaning),
    ]
}

/// Returns a table of fields, with a column of values for each surface.
fn fields(title: &str, note: &str, fields: &[UniformField], surfaces: &[SurfaceValues]) -> Section {
    let row = |field: &UniformField| {
        let values = surfaces.iter().map(|surface| Cell::text(numbers(surface, &field.name)));
        let own = [
            Cell::number(field.offset as f64, 0),
            Cell::text(&field.name),
            Cell::text(kind(field.kind)),
            Cell::text(field.meaning),
        ];
        own.into_iter().chain(values).collect()
    };
    let columns =
        [vec![Column::numbers("offset", "bytes")], ["name", "type", "meaning"].map(Column::words).to_vec()];
    let values = surfaces.iter().map(|surface| Column::words(label(surface)));
    Section::Table {
        title: title.into(),
        note: note.into(),
        columns: columns.concat().into_iter().chain(values).collect(),
        rows: fields.iter().map(row).collect(),
    }
}

fn numbers(surface: &SurfaceValues, field: &str) -> String {
    let numbers = surface.uniforms.get(field).map_or(&[][..], Vec::as_slice);
    numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

fn kind(kind: ValueKind) -> &'static str {
    match kind {
        ValueKind::Number => "number",
        ValueKind::Vec2 => "vec2",
        ValueKind::Vec3 => "vec3",
        ValueKind::Vec4 => "vec4",
        ValueKind::Mat4 => "mat4",
    }
}
