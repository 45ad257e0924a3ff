//! The audit of a model by a schema of the Khronos glTF Asset Auditor.
//!
//! ```no_run
//! use taotie::inspection::{Audit, AuditSchema};
//!
//! let schema = AuditSchema::parse(&taotie_io::read_bytes("schema.json".as_ref())?, "schema.json")?;
//! let audit = Audit::of(&taotie::load_model("vase.glb")?, &schema, None)?;
//! for failed in audit.failed() {
//!     println!("{:?}: {}", failed.name, failed.message);
//! }
//! # Ok::<(), taotie::Error>(())
//! ```

mod check;
mod model;
mod schema;
mod textures;
mod uvs;

pub use check::{Check, CheckResult, CheckStatus};
pub use schema::{AuditSchema, ProductInfo};

use taotie_engine::Warning;
use taotie_engine::error::Result;
use taotie_engine::scene::Scene;
use taotie_io::Loaded;
use uvs::MOST_SIDE;

/// The results of an audit.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Audit {
    /// The version stated in the schema.
    pub schema_version: String,
    /// True if no check failed.
    pub passed: bool,
    /// One result per check, in the order of the auditor's report.
    pub checks: Vec<CheckResult>,
    /// Content that was skipped or corrected on reading; the checks do not see it.
    pub warnings: Vec<Warning>,
}

impl Audit {
    /// Audits a loaded model; `product` gives the dimensions of the product that it shows.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Limit`] if UVs of a mesh of 2³¹ triangles must be checked.
    pub fn of(loaded: &Loaded, schema: &AuditSchema, product: Option<&ProductInfo>) -> Result<Self> {
        let scene = &loaded.scene;
        let mut checks = vec![CheckResult::not_tested(
            Check::GltfValidator,
            "not part of a schema; run the Khronos glTF validator",
        )];
        checks.extend(model::counts(loaded, schema));
        checks.extend(model::edges(scene, &schema.model));
        checks.extend(model::dimensions(scene, &schema.product.dimensions, product));
        checks.extend(textures::results(loaded, &schema.textures));
        checks.extend(textures::texel_density(scene, schema.uvs.pixels_per_meter));
        checks.extend(uvs::results(scene, &schema.uvs)?);
        Ok(Self {
            schema_version: schema.version().to_owned(),
            passed: checks.iter().all(|check| check.status != CheckStatus::Fail),
            warnings: loaded.warnings.list(),
            checks,
        })
    }

    /// Returns an upper bound of the memory in bytes that an audit of `scene` needs in addition to it.
    pub fn memory(scene: &Scene, schema: &AuditSchema) -> u64 {
        /// Per texel: its triangle, and its island twice or the island nearest to it.
        const TEXEL: u64 = 16;
        /// Per triangle: its edges, or its uvs and those of its island.
        const TRIANGLE: u64 = 192;
        let largest = scene.meshes().iter().map(|mesh| mesh.triangles().len() as u64).max().unwrap_or(0);
        let is_drawn = schema.uvs.require_not_overlapping || schema.uvs.gutter_width.widest().is_some();
        let texels = if is_drawn { u64::from(MOST_SIDE) * u64::from(MOST_SIDE) } else { 0 };
        largest * TRIANGLE + texels * TEXEL
    }

    /// Returns the checks that failed.
    pub fn failed(&self) -> impl Iterator<Item = &CheckResult> {
        self.checks.iter().filter(|check| check.status == CheckStatus::Fail)
    }
}

#[cfg(test)]
mod tests {
    //! Every check passes on a model that meets it and fails on one that does not.

    use super::*;
    use taotie_engine::Warnings;
    use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
    use taotie_engine::math::{Mat4, Vec2, Vec3};
    use taotie_engine::mesh::{Mesh, MeshData};
    use taotie_engine::scene::{Instance, Material, Scene, SceneData, TextureRef, UvTransform};
    use taotie_io::{GltfStructure, Loaded, RootNode, load_model};

    /// A rectangle in uv: left, top, right and bottom.
    type UvRectangle = [f32; 4];

    /// A row of squares with a side of one metre, each with a rectangle in uv.
    fn row(rectangles: &[UvRectangle]) -> Mesh {
        let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
        for (i, [left, top, right, bottom]) in rectangles.iter().enumerate() {
            let first = data.positions.len() as u32;
            // Separate, so that no edge is shared.
            let x = 2.0 * i as f32;
            let corners = [(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)];
            data.positions.extend(corners.map(|(x, y)| Vec3::new(x, y, 0.0)));
            let uvs = [(left, bottom), (right, bottom), (right, top), (left, top)];
            data.uvs[0].extend(uvs.map(|(u, v)| Vec2::new(*u, *v)));
            data.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        Mesh::new(data).unwrap()
    }

    /// A box of `size`, each face with the same uvs.
    fn cuboid(size: [f32; 3]) -> Mesh {
        let corner =
            |i: usize| Vec3::from_array(std::array::from_fn(|k| if i >> k & 1 == 1 { size[k] } else { 0.0 }));
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Mesh::new(MeshData { positions: (0..8).map(corner).collect(), triangles, ..MeshData::default() })
            .unwrap()
    }

    /// A model of one mesh whose base colour is an image of this size and these two values of grey.
    fn model(mesh: Mesh, (width, height): (u32, u32), greys: [u8; 2]) -> Loaded {
        let mut texels = vec![[greys[0], greys[0], greys[0], 255]; (width * height) as usize];
        texels[0] = [0, greys[1], 0, 0];
        let bitmap = Bitmap::new(width, height, 3, Texels::U8(texels)).unwrap();
        let (sampler, transform) = (Sampler::default(), UvTransform::default());
        let used = TextureRef { texture: 0, uv_set: 0, sampler, transform };
        let scene = Scene::new(SceneData {
            meshes: vec![mesh],
            materials: vec![Material { base_color_texture: Some(used), ..Material::default() }],
            textures: vec![Texture::new(bitmap, Encoding::Srgb)],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..SceneData::default()
        });
        Loaded {
            texture_names: vec!["base.png".into()],
            ..Loaded::new(scene.unwrap(), Warnings::default(), "GLB")
        }
    }

    fn plain(mesh: Mesh) -> Loaded {
        model(mesh, (4, 4), [100, 100])
    }

    fn schema(text: &str) -> AuditSchema {
        let text = format!(r#"{{ "version": "1.0.4", {text} }}"#);
        AuditSchema::parse(text.as_bytes(), "s.json").unwrap()
    }

    fn result(loaded: &Loaded, text: &str, check: Check) -> CheckResult {
        let audit = Audit::of(loaded, &schema(text), None).unwrap();
        audit.checks.into_iter().find(|result| result.name == check).unwrap()
    }

    #[track_caller]
    fn assert_status(loaded: &Loaded, text: &str, expected: (Check, CheckStatus)) {
        let found = result(loaded, text, expected.0);
        assert_eq!(found.status, expected.1, "{text}: {found:?}");
    }

    /// Asserts that a requirement is met by one model and not by the other, and is not tested if not required.
    #[track_caller]
    fn assert_requirement(key: &str, check: Check, good: &Loaded, bad: &Loaded) {
        let (group, key) = key.split_once('.').unwrap();
        let text = |required: bool| format!(r#""{group}": {{ "{key}": {required} }}"#);
        assert_status(good, &text(true), (check, CheckStatus::Pass));
        assert_status(bad, &text(true), (check, CheckStatus::Fail));
        assert_status(bad, &text(false), (check, CheckStatus::NotTested));
    }

    /// A value, limits that it satisfies, and limits that it violates.
    struct Limited<'a>(f64, [&'a str; 2]);

    /// Asserts that a value satisfies `limits[0]` and violates `limits[1]`. `SCHEMA` in the text is replaced by the
    /// limits.
    #[track_caller]
    fn assert_limits(loaded: &Loaded, text: &str, check: Check, Limited(value, limits): Limited<'_>) {
        let with = |limits: &str| text.replace("SCHEMA", &format!("{{ {limits} }}"));
        for (limits, status) in limits.iter().zip([CheckStatus::Pass, CheckStatus::Fail]) {
            let found = result(loaded, &with(limits), check);
            assert_eq!((found.status, found.value), (status, Some(value)), "{limits}: {found:?}");
        }
        let unlimited = result(loaded, &with(r#""maximum": -1, "minimum": -1"#), check);
        assert_eq!((unlimited.status, unlimited.value), (CheckStatus::NotTested, Some(value)));
    }

    #[test]
    fn every_check_has_one_result_in_the_order_of_its_names() {
        use taotie_engine::names::Named;
        let audit = Audit::of(&plain(row(&[[0.0, 0.0, 1.0, 1.0]])), &schema(r#""uvs": {}"#), None).unwrap();
        let names: Vec<&str> = audit.checks.iter().map(|result| result.name.name()).collect();
        let all: Vec<&str> = Check::NAMES.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, all);
        assert!(audit.passed && audit.checks.iter().all(|result| result.status == CheckStatus::NotTested));
    }

    #[test]
    fn counts_and_file_size() {
        let structure = GltfStructure {
            nodes: 3,
            meshes: 4,
            primitives: 5,
            triangles: 6,
            materials: 7,
            ..GltfStructure::default()
        };
        let loaded =
            Loaded { structure: Some(structure), bytes: Some(20_400), ..plain(row(&[[0.0, 0.0, 1.0, 1.0]])) };
        let cases = [
            (r#""fileSizeInKb": SCHEMA"#, Check::FileSize, 20.0),
            (r#""materials": SCHEMA"#, Check::MaterialCount, 7.0),
            (r#""model": { "triangles": SCHEMA }"#, Check::TriangleCount, 6.0),
            (r#""model": { "objectCount": { "nodes": SCHEMA } }"#, Check::NodeCount, 3.0),
            (r#""model": { "objectCount": { "meshes": SCHEMA } }"#, Check::MeshCount, 4.0),
            (r#""model": { "objectCount": { "primitives": SCHEMA } }"#, Check::PrimitiveCount, 5.0),
        ];
        for (text, check, value) in cases {
            let limit = |key: &str, limit: f64| format!(r#""{key}": {limit}"#);
            let (least, most) = (limit("minimum", value), limit("maximum", value));
            assert_limits(&loaded, text, check, Limited(value, [&most, &limit("maximum", value - 1.0)]));
            assert_limits(&loaded, text, check, Limited(value, [&least, &limit("minimum", value + 1.0)]));
            let both = format!("{least}, {most}");
            assert_limits(&loaded, text, check, Limited(value, [&both, r#""minimum": 100"#]));
        }
    }

    #[test]
    fn formats_without_nodes_are_not_tested_for_them() {
        let loaded = plain(row(&[[0.0, 0.0, 1.0, 1.0]]));
        let text = r#""model": { "objectCount": { "nodes": { "maximum": 0 } }, "requireCleanRootNodeTransform": true }"#;
        for check in [Check::NodeCount, Check::CleanRootTransform] {
            assert_status(&loaded, text, (check, CheckStatus::NotTested));
        }
        let sized = r#""fileSizeInKb": { "maximum": 1 }"#;
        assert_status(&loaded, sized, (Check::FileSize, CheckStatus::NotTested));
        let triangles = r#""model": { "triangles": SCHEMA }"#;
        let limits = [r#""maximum": 2"#, r#""maximum": 1"#];
        assert_limits(&loaded, triangles, Check::TriangleCount, Limited(2.0, limits));
    }

    #[test]
    fn root_nodes_stay_where_they_are() {
        let with = |roots: &[Mat4]| {
            let root =
                |(i, matrix): (usize, &Mat4)| RootNode { name: format!("n{i}"), world_from_node: *matrix };
            let roots = roots.iter().enumerate().map(root).collect();
            let structure = Some(GltfStructure { roots, ..GltfStructure::default() });
            Loaded { structure, ..plain(row(&[[0.0, 0.0, 1.0, 1.0]])) }
        };
        let moved = Mat4::translation(Vec3::new(0.0, 0.5, 0.0));
        let (good, bad) = (with(&[Mat4::IDENTITY]), with(&[Mat4::IDENTITY, moved]));
        let key = "model.requireCleanRootNodeTransform";
        assert_requirement(key, Check::CleanRootTransform, &good, &bad);
        let said = |root: Mat4| result(&with(&[root]), r#""uvs": {}"#, Check::CleanRootTransform).message;
        assert_eq!(said(moved), "'n0' moves by 0 0.5 0");
        assert_eq!(said(Mat4::scale(Vec3::new(2.0, 2.0, 1.0))), "'n0' scales by 2 2 1");
        assert_eq!(said(Mat4::rotation_about(Vec3::new(0.0, 0.0, 1.0), 0.5)), "'n0' rotates");
    }

    #[test]
    fn hard_and_crowded_edges() {
        let ball = plain(Mesh::sphere(1.0, 32, 16));
        let cube = plain(cuboid([1.0; 3]));
        assert_requirement("model.requireBeveledEdges", Check::BeveledEdges, &ball, &cube);
        let hard = result(&cube, r#""model": { "requireBeveledEdges": true }"#, Check::BeveledEdges);
        assert_eq!((hard.value, hard.maximum), (Some(12.0), Some(0.0)), "{hard:?}");
        // A wall on the cube, from the edge 0-1 inwards.
        let mut data = cuboid([1.0; 3]).into_data();
        data.triangles.push([0, 1, 7]);
        let walled = plain(Mesh::new(data).unwrap());
        assert_requirement("model.requireManifoldEdges", Check::ManifoldEdges, &cube, &walled);
    }

    #[test]
    fn dimensions_are_those_along_x_z_and_y() {
        let loaded = plain(cuboid([3.0, 1.0, 2.0]));
        for (name, size) in [("length", 3.0), ("width", 2.0), ("height", 1.0)] {
            let with = |key: &str, limit: f64| {
                format!(r#""product": {{ "dimensions": {{ "{name}": {{ "{key}": {limit} }} }} }}"#)
            };
            let check = Check::OverallDimensions;
            assert_status(&loaded, &with("maximum", size), (check, CheckStatus::Pass));
            assert_status(&loaded, &with("minimum", size), (check, CheckStatus::Pass));
            assert_status(&loaded, &with("maximum", size - 0.1), (check, CheckStatus::Fail));
            assert_status(&loaded, &with("minimum", size + 0.1), (check, CheckStatus::Fail));
            assert_status(&loaded, &with("percentTolerance", 3.0), (check, CheckStatus::NotTested));
        }
    }

    #[test]
    fn products_are_compared_within_their_tolerance() {
        let loaded = plain(cuboid([3.0, 1.0, 2.0]));
        let status = |dimensions: &str, percent: f64| {
            let text = format!(
                r#""product": {{ "dimensions": {{ "length": {{ "percentTolerance": {percent} }} }} }}"#
            );
            let product = format!(r#"{{ "dimensions": {{ {dimensions} }} }}"#);
            let product = ProductInfo::parse(product.as_bytes(), "p.json").unwrap();
            let audit = Audit::of(&loaded, &schema(&text), Some(&product)).unwrap();
            audit.checks.into_iter().find(|result| result.name == Check::ProductDimensions).unwrap().status
        };
        assert_eq!(status(r#""length": 3, "width": 2, "height": 1"#, 0.0), CheckStatus::Pass);
        assert_eq!(status(r#""length": 2.95"#, 2.0), CheckStatus::Pass);
        assert_eq!(status(r#""length": 2.95"#, 1.0), CheckStatus::Fail);
        assert_eq!(status(r#""length": 3.05"#, 1.0), CheckStatus::Fail);
        assert_eq!(
            status(r#""height": 1.01"#, 5.0),
            CheckStatus::Fail,
            "each dimension has its own tolerance"
        );
    }

    #[test]
    fn sizes_of_textures() {
        let square = row(&[[0.0, 0.0, 1.0, 1.0]]);
        let loaded = model(square.clone(), (8, 4), [100, 100]);
        let (height, width) = (r#""textures": { "height": SCHEMA }"#, r#""textures": { "width": SCHEMA }"#);
        let (most, least) = ([r#""maximum": 4"#, r#""maximum": 3"#], [r#""minimum": 4"#, r#""minimum": 5"#]);
        assert_limits(&loaded, height, Check::TextureHeightMaximum, Limited(4.0, most));
        assert_limits(&loaded, height, Check::TextureHeightMinimum, Limited(4.0, least));
        let (most, least) = ([r#""maximum": 8"#, r#""maximum": 7"#], [r#""minimum": 8"#, r#""minimum": 9"#]);
        assert_limits(&loaded, width, Check::TextureWidthMaximum, Limited(8.0, most));
        assert_limits(&loaded, width, Check::TextureWidthMinimum, Limited(8.0, least));
        let failed =
            result(&loaded, r#""textures": { "width": { "maximum": 7 } }"#, Check::TextureWidthMaximum);
        assert_eq!(failed.message, "8 (at most 7): base.png");
        let odd = model(square, (6, 6), [100, 100]);
        let key = "textures.requireDimensionsBePowersOfTwo";
        assert_requirement(key, Check::PowerOfTwoTextures, &loaded, &odd);
        let key = "textures.requireDimensionsBeQuadratic";
        assert_requirement(key, Check::SquareTextures, &odd, &loaded);
    }

    /// The value of a colour is its largest channel.
    #[test]
    fn base_colours_keep_their_distance_from_black_and_white() {
        let loaded = model(row(&[[0.0, 0.0, 1.0, 1.0]]), (4, 4), [240, 30]);
        let text = r#""textures": { "pbrColorRange": SCHEMA }"#;
        let most = [r#""maximum": 240"#, r#""maximum": 239"#];
        assert_limits(&loaded, text, Check::PbrColorMaximum, Limited(240.0, most));
        let least = [r#""minimum": 30"#, r#""minimum": 31"#];
        assert_limits(&loaded, text, Check::PbrColorMinimum, Limited(30.0, least));
    }

    /// A square of one metre has half an 8×8 image's width and height: 4 pixels per metre; the other square 2.
    #[test]
    fn texel_density_is_measured_in_pixels_per_metre() {
        let mesh = row(&[[0.0, 0.0, 0.5, 0.5], [0.5, 0.5, 0.75, 0.75]]);
        let mut loaded = model(mesh, (8, 8), [100, 100]);
        let text = r#""uvs": { "pixelsPerMeter": SCHEMA }"#;
        let most = [r#""maximum": 4"#, r#""maximum": 3.9"#];
        assert_limits(&loaded, text, Check::TexelDensityMaximum, Limited(4.0, most));
        let least = [r#""minimum": 2"#, r#""minimum": 2.1"#];
        assert_limits(&loaded, text, Check::TexelDensityMinimum, Limited(2.0, least));
        loaded
            .scene
            .edit(|scene| scene.instances[0].world_from_object = Mat4::scale(Vec3::splat(10.0)))
            .unwrap();
        assert_limits(
            &loaded,
            text,
            Check::TexelDensityMaximum,
            Limited(0.4, [r#""maximum": 1"#, r#""maximum": 0.3"#]),
        );
    }

    #[test]
    fn uvs_in_range_and_upright() {
        let inside = plain(row(&[[0.0, 0.0, 1.0, 1.0]]));
        let outside = plain(row(&[[0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.5, 1.001]]));
        assert_requirement("uvs.requireRangeZeroToOne", Check::UvRange, &inside, &outside);
        let mirrored = plain(row(&[[0.0, 0.0, 0.4, 1.0], [1.0, 0.0, 0.6, 1.0]]));
        assert_requirement("uvs.requireNotInverted", Check::InvertedUvs, &inside, &mirrored);
        let inverted = result(&mirrored, r#""uvs": { "requireNotInverted": true }"#, Check::InvertedUvs);
        assert_eq!(inverted.value, Some(2.0));
    }

    #[test]
    fn overlapping_uvs() {
        let key = "uvs.requireNotOverlapping";
        let adjacent = plain(row(&[[0.0, 0.0, 0.5, 1.0], [0.5, 0.0, 1.0, 1.0]]));
        let over = plain(row(&[[0.0, 0.0, 0.5, 1.0], [0.49, 0.0, 1.0, 1.0]]));
        assert_requirement(key, Check::OverlappingUvs, &adjacent, &over);
        // Tiles that would meet if uvs wrapped around do not overlap.
        let tiles = plain(row(&[[0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 2.0, 1.0]]));
        assert_requirement(key, Check::OverlappingUvs, &tiles, &over);
        let same = plain(row(&[[0.0, 0.0, 1.0, 1.0]; 2]));
        assert_requirement(key, Check::OverlappingUvs, &tiles, &same);
    }

    fn gutter(rectangles: &[UvRectangle], keys: &str) -> (CheckStatus, Option<f64>) {
        let text = format!(r#""uvs": {{ "gutterWidth": {{ {keys} }} }}"#);
        let found = result(&plain(row(rectangles)), &text, Check::GutterWidth);
        (found.status, found.value)
    }

    #[test]
    fn gutters_are_measured_to_a_sixteenth() {
        let asked = r#""resolution1024": 8"#;
        let apart = |pixels: f32| [[0.0, 0.0, 0.5, 1.0], [0.5 + pixels / 1024.0, 0.0, 1.0, 1.0]];
        let measured = |pixels: f32| gutter(&apart(pixels), asked);
        for (pixels, expected) in [
            (10.0, CheckStatus::Pass),
            (8.0, CheckStatus::Pass),
            (7.0, CheckStatus::Fail),
            (1.0, CheckStatus::Fail),
        ] {
            let (status, value) = measured(pixels);
            assert_eq!(status, expected, "{pixels}: {value:?}");
            let error = value.unwrap() - f64::from(pixels);
            assert!((0.0..=1.0).contains(&error), "{pixels}: {value:?}");
        }
        // Along a diagonal the longer axis counts.
        let diagonal = [[0.0, 0.0, 0.4, 0.4], [0.41, 0.401, 1.0, 1.0]];
        assert_eq!(gutter(&diagonal, asked).0, CheckStatus::Pass);
        assert_eq!(gutter(&apart(10.0), "").0, CheckStatus::NotTested);
    }

    #[test]
    fn islands_over_one_another_have_no_gutter() {
        let asked = r#""resolution256": 2"#;
        let nested = [[0.0, 0.0, 1.0, 1.0], [0.4, 0.4, 0.6, 0.6]];
        assert_eq!(gutter(&nested, asked), (CheckStatus::Fail, Some(0.0)));
        // The same with the corners of one island, without a gutter between them.
        assert_eq!(gutter(&[[0.0, 0.0, 1.0, 1.0]; 2], asked), (CheckStatus::Pass, None));
        // Unmeasurable widths are not silently accepted: a texel of the raster is wider than the gutter.
        let wide = [[0.0, 0.0, 1.0, 1.0], [99.0, 0.0, 100.0, 1.0]];
        assert_eq!(gutter(&wide, asked).0, CheckStatus::NotTested);
    }

    #[test]
    fn models_without_uvs_or_textures_are_not_tested_for_them() {
        let scene = Scene::of_mesh(cuboid([1.0; 3]), Material::default()).unwrap();
        let loaded = Loaded::new(scene, Warnings::default(), "GLB");
        let text = r#""uvs": { "requireRangeZeroToOne": true, "requireNotInverted": true, "requireNotOverlapping": true,
                               "gutterWidth": { "resolution256": 2 }, "pixelsPerMeter": { "minimum": 9 } },
                      "textures": { "height": { "minimum": 9 }, "requireDimensionsBeQuadratic": true,
                                    "pbrColorRange": { "minimum": 9 } }"#;
        let audit = Audit::of(&loaded, &schema(text), None).unwrap();
        assert!(audit.passed, "{:?}", audit.failed().collect::<Vec<_>>());
    }

    /// Packed models give the same results as the plain one.
    #[cfg(feature = "draco")]
    #[test]
    fn models_packed_by_draco_are_audited() {
        let text = r#""materials": { "maximum": 1 }, "fileSizeInKb": { "maximum": 20 },
            "model": { "objectCount": { "nodes": { "maximum": 1 }, "meshes": { "maximum": 1 },
                                        "primitives": { "maximum": 1 } },
                       "triangles": { "maximum": 96 }, "requireBeveledEdges": true, "requireManifoldEdges": true,
                       "requireCleanRootNodeTransform": true },
            "product": { "dimensions": { "height": { "minimum": 1 } } },
            "uvs": { "requireRangeZeroToOne": true, "requireNotInverted": true, "requireNotOverlapping": true,
                     "gutterWidth": { "resolution256": 2 } }"#;
        let audit = |name: &str| {
            let path = format!("{}/../../tests/data/meshes/{name}", env!("CARGO_MANIFEST_DIR"));
            Audit::of(&load_model(path).unwrap(), &schema(text), None).unwrap()
        };
        let plain = audit("patch.glb");
        let tested = plain.checks.iter().filter(|result| result.status != CheckStatus::NotTested).count();
        assert!(tested >= 14, "{plain:?}");
        for name in ["patch-draco-sequential.glb", "patch-draco-edgebreaker.glb"] {
            let packed = audit(name);
            for (packed, plain) in packed.checks.iter().zip(&plain.checks) {
                assert_eq!(packed.status, plain.status, "{name}: {packed:?}, {plain:?}");
            }
        }
    }
}
