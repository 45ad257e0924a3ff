//! What breaks a rule today, by name. Both lists are to shrink; the tests ask that what is mended be struck.

/// Files that import one another in a circle, sorted, and why they may.
pub const CIRCLES: [(&[&str], &str); 14] = [
    (&["bake/color", "bake/scan"], "to be mended"),
    (&["bake/coverage", "bake/grow", "bake/raster"], "to be mended"),
    (&["bake/simplify", "bake/simplify/whole"], "to be mended"),
    (&["bake/unwrap", "bake/unwrap/layout"], "to be mended"),
    (
        &["image/codec", "image/mips", "image/texture"],
        "to be mended: a texture makes its mip levels, which are textures",
    ),
    (
        &["io/bitmap", "io/bitmap/exr", "io/bitmap/ktx", "io/bitmap/png"],
        "to be mended: formats share what lies in their mod.rs",
    ),
    (
        &[
            "io/gltf/accessor",
            "io/gltf/buffers",
            "io/gltf/document",
            "io/gltf/draco",
            "io/gltf/meshopt",
            "io/gltf/uri",
            "io/gltf/vertices",
        ],
        "to be mended",
    ),
    (
        &[
            "io",
            "io/gltf",
            "io/gltf/materials",
            "io/obj",
            "io/obj/material",
            "io/ply",
            "io/ply/texture",
            "io/stl",
        ],
        "to be mended: readers share what lies in their mod.rs",
    ),
    (&["io/obj/blocks", "io/obj/parse"], "to be mended"),
    (&["io/ply/ascii", "io/ply/names", "io/ply/payload"], "to be mended"),
    (&["io/write/gltf/draft", "io/write/gltf/images", "io/write/gltf/material"], "to be mended"),
    (
        &["shade/dfg", "shade/dfg/cook_torrance", "shade/dfg/ggx", "shade/dfg/sheen"],
        "to be mended: generated tables name the type of their lines",
    ),
    (&["shade/energy", "shade/substance"], "to be mended"),
    (&["surface/mikktspace", "surface/tangents"], "to be mended"),
];

/// Functions that take more arguments than they should, all to be mended: file and name.
pub const LONG_FUNCTIONS: [(&str, &str); 26] = [
    ("crates/taotie-cli/src/bake/mod.rs", "lightened"),
    ("crates/taotie-cli/src/bake/work.rs", "bake_maps"),
    ("crates/taotie-cli/src/compare/paper/misprints.rs", "of_angle"),
    ("crates/taotie-cli/src/compare/paper/printed.rs", "row"),
    ("crates/taotie-cli/src/demo/moving.rs", "write"),
    ("crates/taotie-cli/src/normals/convert.rs", "other_space"),
    ("crates/taotie-cli/src/sheet.rs", "write"),
    ("crates/taotie-cli/src/studio/lights.rs", "lighting"),
    ("crates/taotie/src/bake/cage.rs", "largest_gap"),
    ("crates/taotie/src/bake/texels.rs", "bake"),
    ("crates/taotie/src/bake/unwrap/mod.rs", "cut"),
    ("crates/taotie/src/image/lookup.rs", "lay"),
    ("crates/taotie/src/image/lookup.rs", "place"),
    ("crates/taotie/src/image/mips.rs", "band"),
    ("crates/taotie/src/io/bitmap.rs", "tga"),
    ("crates/taotie/src/io/gltf/accessor.rs", "strided"),
    ("crates/taotie/src/io/gltf/variants.rs", "add"),
    ("crates/taotie/src/io/obj/material.rs", "height_map"),
    ("crates/taotie/src/io/obj/material.rs", "set_opacity_map"),
    ("crates/taotie/src/math/poly.rs", "worst"),
    ("crates/taotie/src/shade/environment/gather.rs", "gather"),
    ("crates/taotie/src/shade/environment/gather.rs", "gather_mean"),
    ("crates/taotie/src/surface/bump.rs", "surface_gradient"),
    ("crates/taotie/src/trace/sheaf.rs", "in_shadow"),
    ("crates/taotie/src/trace/walk.rs", "meet_leaf"),
    ("crates/taotie/src/trace/walk.rs", "walk"),
];
