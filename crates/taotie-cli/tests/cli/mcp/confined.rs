//! Paths outside the allowed folders, by every way that a client has.

use super::client::{Client, text};
use super::quick;
use crate::balls::SCAN;
use crate::place::Place;
use serde_json::{Value, json};
use std::fs;

/// Returns a place with the folders `in` and `out`, each with a scan.
fn place() -> Place {
    let place = Place::new();
    for name in ["in", "out"] {
        fs::create_dir(place.path(name)).unwrap();
        place.write(&format!("{name}/scan.obj"), SCAN.obj());
    }
    place
}

/// Asserts that a server for the folder `in` refuses the call, and that the folder `out` is unchanged.
fn assert_refused(place: &Place, client: &mut Client, tool: &str, arguments: Value) {
    let message = client.refused(tool, arguments.clone());
    let reasons = ["outside", "not allowed", "not available", "leads nowhere", "unexpected", "not a path"];
    assert!(reasons.iter().any(|reason| message.contains(reason)), "{arguments}: {message}");
    let names = fs::read_dir(place.path("out")).unwrap().count();
    assert_eq!(names, 1, "{arguments} wrote a file");
}

#[test]
fn paths_outside_the_folder_are_refused() {
    let place = place();
    let mut client = Client::new(&place, &["in"], None);
    let outside = place.path("out/scan.obj").display().to_string();
    let new = place.path("out/new.glb").display().to_string();
    client.done("inspect", json!({ "model": "scan.obj" }));
    client.done("inspect", json!({ "model": place.path("in/scan.obj") }));
    for model in
        [&outside, "../out/scan.obj", "/etc/passwd", "in/../../out/scan.obj", "/", "/proc/self/environ"]
    {
        assert_refused(&place, &mut client, "inspect", json!({ "model": model }));
        assert_refused(&place, &mut client, "render", json!({ "model": model, "size": 16 }));
        assert_refused(&place, &mut client, "verify", json!({ "asset": "scan.obj", "scan": model }));
        assert_refused(&place, &mut client, "bake", json!({ "high": model, "output": "out.glb" }));
    }
    assert_refused(&place, &mut client, "bake", json!({ "high": "scan.obj", "output": new }));
    assert_refused(
        &place,
        &mut client,
        "bake",
        json!({ "high": "scan.obj", "output": "a.glb", "low": outside }),
    );
    for options in [
        json!(["--cage", outside, "--low", "scan.obj"]),
        json!([format!("--trials={}", place.path("out/t.csv").display())]),
        json!(["--provenance", outside]),
        json!(["--low", "scan.obj", "--skew", outside]),
        json!(["--allow-outside"]),
        json!(["--output", new]),
        json!(["--", outside]),
    ] {
        let mut arguments = json!({ "high": "scan.obj", "options": options });
        if options[0] != "--output" {
            arguments["output"] = "a.glb".into();
        }
        assert_refused(&place, &mut client, "bake", arguments);
    }
    assert_refused(
        &place,
        &mut client,
        "inspect",
        json!({ "model": "scan.obj", "options": ["--audit", outside] }),
    );
    assert_refused(&place, &mut client, "render", json!({ "model": "scan.obj", "env": outside }));
}

#[test]
fn files_inside_cannot_name_files_outside() {
    let place = place();
    place.write("out.toml", "roughness = 0.1");
    place.write("in/m.toml", "maps = { normal = '../out/n.png' }");
    let buffer = json!({ "uri": "../out/scan.obj", "byteLength": 36 });
    let gltf = json!({
        "asset": { "version": "2.0" }, "buffers": [buffer], "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }], "nodes": [{ "mesh": 0 }],
        "scenes": [{ "nodes": [0] }], "scene": 0,
    });
    place.write("in/a.gltf", gltf.to_string());
    let mut client = Client::new(&place, &["in"], None);
    assert_refused(&place, &mut client, "inspect", json!({ "model": "a.gltf" }));
    assert_refused(&place, &mut client, "render", json!({ "model": "scan.obj", "material": "m.toml" }));
    assert_refused(&place, &mut client, "render", json!({ "model": "scan.obj", "material": "../out.toml" }));
    client.done("render", json!({ "model": "scan.obj", "material": "bronze", "env": "studio", "size": 16 }));
}

#[cfg(unix)]
#[test]
fn links_lead_nowhere_outside() {
    use std::os::unix::fs::symlink;
    let place = place();
    let link = |target: &str, name: &str| symlink(target, place.path(name)).unwrap();
    link("../out", "in/way");
    link("../out/scan.obj", "in/link.obj");
    link("../out/new.glb", "in/new.glb");
    link("../out/new.report.html", "in/out.report.html");
    link("scan.obj", "in/near.obj");
    link("/", "in/root");
    link("loop.obj", "in/loop.obj");
    place.write("out/new.report.html", "before");
    let mut client = Client::new(&place, &["in"], None);
    for model in ["way/scan.obj", "link.obj", "root/etc/passwd", "loop.obj"] {
        let message = client.refused("inspect", json!({ "model": model }));
        assert!(message.contains("outside") || message.contains("nowhere"), "{message}");
    }
    for output in ["way/new.glb", "new.glb", "way/new/new.glb"] {
        let message = client.refused("bake", json!({ "high": "scan.obj", "output": output }));
        assert!(message.contains("outside") || message.contains("nowhere"), "{message}");
    }
    client.done("inspect", json!({ "model": "near.obj" }));
    // A file next to the asset replaces a link of its name.
    client.done("bake", quick());
    assert_eq!(place.read("out/new.report.html"), b"before");
    assert_eq!(fs::read_dir(place.path("out")).unwrap().count(), 2);
    assert!(fs::symlink_metadata(place.path("in/out.report.html")).unwrap().is_file());
}

#[cfg(unix)]
#[test]
fn the_folder_of_the_start_is_the_default() {
    let place = place();
    let mut rootless = Client::in_folder(&place, "/");
    assert!(rootless.refused("inspect", json!({ "model": place.path("in/scan.obj") })).contains("no folder"));
    let mut client = Client::new(&place, &[], None);
    client.done("inspect", json!({ "model": "out/scan.obj" }));
    assert!(client.refused("inspect", json!({ "model": "/etc/passwd" })).contains("outside"));
}

#[test]
fn roots_of_the_client_are_the_limit() {
    let place = place();
    let [inside, outside] = ["in", "out"].map(|name| place.path(name));
    let mut client = Client::new(&place, &[], Some(&[&inside]));
    client.done("inspect", json!({ "model": "scan.obj" }));
    assert!(client.refused("inspect", json!({ "model": outside.join("scan.obj") })).contains("outside"));
    client.declare(&[&outside]);
    client.send(&json!({ "jsonrpc": "2.0", "method": "notifications/roots/list_changed" }));
    client.done("inspect", json!({ "model": outside.join("scan.obj") }));
    assert!(client.refused("inspect", json!({ "model": inside.join("scan.obj") })).contains("outside"));
    client.declare(&[]);
    client.done("inspect", json!({ "model": "in/scan.obj" }));
    client.roots = vec!["https://example.org/in".into(), "file://elsewhere/in".into(), "none".into()];
    assert!(client.refused("inspect", json!({ "model": "scan.obj" })).contains("no folder"));
    assert_eq!(client.asked, 6, "the roots are asked for at each call");
}

#[test]
fn roots_do_not_widen_the_folders_of_the_command() {
    let place = place();
    let mut client = Client::new(&place, &["in"], Some(&[&place.path("")]));
    client.done("inspect", json!({ "model": place.path("in/scan.obj") }));
    assert!(client.refused("inspect", json!({ "model": place.path("out/scan.obj") })).contains("outside"));
}

#[test]
fn a_client_of_the_protocol_without_sessions_is_asked_in_the_result() {
    let place = place();
    let mut client = Client::start(&place, &[]);
    let meta = json!({
        "io.modelcontextprotocol/protocolVersion": "2026-07-28",
        "io.modelcontextprotocol/clientInfo": { "name": "test", "version": "1" },
        "io.modelcontextprotocol/clientCapabilities": { "roots": {} },
    });
    client.ask("server/discover", json!({ "_meta": meta }));
    let mut params = json!({ "name": "inspect", "arguments": { "model": "scan.obj" }, "_meta": meta });
    let asked = client.ask("tools/call", params.clone());
    assert_eq!(asked["result"]["resultType"], "input_required", "{asked}");
    assert_eq!(asked["result"]["inputRequests"]["roots"]["method"], "roots/list");
    let uri = format!("file://{}", place.path("in").display());
    params["inputResponses"] = json!({ "roots": { "roots": [{ "uri": uri }] } });
    let done = client.ask("tools/call", params.clone());
    assert_eq!(done["result"]["structuredContent"]["counts"]["triangles"], 9_024, "{done}");
    params["arguments"]["model"] = json!(place.path("out/scan.obj"));
    assert!(text(&client.ask("tools/call", params.clone())["result"]).contains("outside"));
    params["inputResponses"] = json!({ "roots": "all" });
    assert!(text(&client.ask("tools/call", params)["result"]).contains("invalid list of roots"));
}
