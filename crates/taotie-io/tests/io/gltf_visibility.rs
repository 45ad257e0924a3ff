//! Nodes that KHR_node_visibility hides, with all below them, and names that nodes have from those above them.

use crate::gltf::{Maker, triangle, warned};

/// Three nodes with a triangle at y = 0, 1 and 2, each the parent of the next, and a camera on the last; the extensions
/// of the nodes are given.
fn visible(extensions: [&str; 3]) -> (Maker, String) {
    let [a, b, c] = extensions.map(|visible| match visible {
        "" => String::new(),
        visible => format!(r#","extensions":{{"KHR_node_visibility":{{"visible":{visible}}}}}"#),
    });
    let rest = format!(
        r#""extensionsUsed":["KHR_node_visibility"],"extensionsRequired":["KHR_node_visibility"],
        "nodes":[{{"mesh":0,"children":[1]{a}}},{{"mesh":0,"translation":[0,1,0],"children":[2]{b}}},
            {{"mesh":0,"translation":[0,1,0],"camera":0{c}}}],
        "cameras":[{{"type":"perspective","perspective":{{"yfov":1,"znear":0.1}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]"#
    );
    (triangle(), rest)
}

#[test]
fn hidden_nodes_hide_all_below_them() {
    let shown = |extensions: [&str; 3]| {
        let (maker, rest) = visible(extensions);
        let loaded = maker.load(&rest);
        assert_eq!(loaded.scene.cameras().len(), 1, "cameras are not affected");
        (loaded.scene.instances().len(), warned(&loaded, "nodes hidden by KHR_node_visibility: left out"))
    };
    assert_eq!(shown(["", "true", ""]), (3, 0));
    assert_eq!(shown(["", "", "false"]), (2, 1));
    assert_eq!(shown(["", "false", "true"]), (1, 2));
}

#[test]
fn a_file_whose_meshes_are_all_hidden_is_refused() {
    let (maker, rest) = visible(["false", "", ""]);
    let error = maker.try_load(&rest).unwrap_err();
    let why = "all that have a mesh are hidden (KHR_node_visibility); make them visible, and export again";
    assert!(error.contains(why), "{error}");
}

#[test]
fn parts_of_a_node_that_is_named_for_baking_have_its_name() {
    let nodes = r#""nodes":[{"name":"wheel_low","children":[1,2]},{"name":"rim","mesh":0,"children":[3]},
                 {"name":"tyre_low","mesh":0},{"mesh":0},{"name":"axle","mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;
    let names = triangle().load(nodes).objects.names;
    assert_eq!(names, ["wheel_low", "wheel_low", "tyre_low", "axle"]);
}
