//! `taotie mcp`: a session with a client that speaks JSON-RPC over pipes.

mod client;
mod confined;

use crate::balls::{Ball, SCAN};
use crate::place::Place;
use client::{Client, pictures, text};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Returns the arguments of a bake that takes a second.
fn quick() -> Value {
    json!({
        "high": "scan.obj", "output": "out.glb", "triangles": 500, "size": 128, "require": ["mean-angle=60", "missed=90%"],
        "options": ["--proof-points", "20000", "--proof-view", "96"],
    })
}

/// Large enough to keep a bake busy for a while.
fn large() -> Place {
    let place = Place::with("scan.obj", Ball { rings: 400, meridians: 800, ..SCAN }.obj());
    place.write("out.glb", "before");
    place
}

#[test]
fn a_session() {
    let place = Place::with("scan.obj", SCAN.obj());
    let mut client = Client::new(&place, &[], None);
    let tools = client.ask("tools/list", json!({}))["result"]["tools"].clone();
    let names: Vec<&str> =
        tools.as_array().unwrap().iter().filter_map(|tool| tool["name"].as_str()).collect();
    assert_eq!(names, ["inspect", "bake", "verify", "render"]);
    assert_eq!(tools[1]["inputSchema"]["properties"]["triangles"]["type"], "integer");

    let inspected = client.done("inspect", json!({ "model": "scan.obj" }));
    assert_eq!(inspected["structuredContent"]["counts"]["triangles"], 9_024, "{inspected}");
    assert!(text(&inspected).contains("9,024"));

    let baked = client.done("bake", quick());
    let report = &baked["structuredContent"];
    let certificate = &report["certificate"];
    assert_eq!(certificate["verdict"], "met", "{certificate}");
    assert_eq!(certificate["required"][0]["figure"], "mean-angle");
    assert_eq!(certificate["required"][0]["most"], 60.0);
    assert!(certificate["required"][0]["value"].as_f64().unwrap() < 60.0);
    let folder = place.path("").canonicalize().unwrap();
    let files = ["out.glb", "out.report.html", "out.report.json"];
    assert_eq!(report["files"], json!(files.map(|name| folder.join(name))));
    assert_eq!(place.files(), [&files[..], &["scan.obj"]].concat());
    assert!(report["warnings"].is_array() && report.get("proof").is_none());
    assert!(text(&baked).contains("normal error"), "{}", text(&baked));
    let kinds: Vec<String> = pictures(&baked).into_iter().map(|(kind, _)| kind).collect();
    assert_eq!(kinds, ["image/jpeg", "image/jpeg", "image/png"], "scan, asset and difference");

    let values: Vec<f64> = client.progress.iter().filter_map(|report| report["progress"].as_f64()).collect();
    assert!(values.len() > 3 && values.is_sorted_by(|a, b| a < b), "{values:?}");
    assert!(
        client.progress.iter().any(|report| report["message"].as_str().unwrap().starts_with("simplify: "))
    );

    let verify = json!({ "asset": "out.glb", "scan": "scan.obj", "require": "mean-angle=0.001",
        "options": ["--proof-points=20000", "--proof-view=96"] });
    let verified = client.done("verify", verify);
    assert_eq!(verified["structuredContent"]["certificate"]["verdict"], "not-met");
    assert_eq!(pictures(&verified).len(), 3);
    assert!(client.close());
    assert_eq!(place.files().len(), 4, "a verification without an output writes nothing");
}

#[test]
fn renders_are_pictures_of_less_than_a_megabyte() {
    let place = Place::with("scan.obj", SCAN.obj());
    let mut client = Client::new(&place, &[], None);
    let seen = client
        .done("render", json!({ "model": "scan.obj", "size": 64, "orbit": [30, -20], "shadows": true }));
    let [(kind, file)] = &pictures(&seen)[..] else { panic!("one picture: {seen}") };
    assert!(kind == "image/png" && file.starts_with(b"\x89PNG"));
    assert_eq!(seen["structuredContent"]["files"], json!([]));
    assert_eq!(place.files(), ["scan.obj"]);

    let large =
        json!({ "model": "scan.obj", "output": "large.png", "size": "1600", "options": ["--bits", "16"] });
    let kept = client.done("render", large);
    assert!(place.read("large.png").len() > 750_000, "the file is too small for this test");
    let [(kind, _)] = &pictures(&kept)[..] else { panic!("one picture: {kept}") };
    assert_eq!(kind, "image/jpeg");
    assert_eq!(kept["structuredContent"]["files"], json!([place.path("large.png").canonicalize().unwrap()]));
}

#[test]
fn errors_of_the_command_are_errors_of_the_tool() {
    let place = Place::with("broken.obj", "f 1 2 3");
    place.write("scan.obj", SCAN.obj());
    let mut client = Client::new(&place, &[], None);
    assert!(client.refused("inspect", json!({ "model": "broken.obj" })).contains("broken.obj: line 1"));
    assert!(client.refused("inspect", json!({ "model": "none.obj" })).contains("none.obj: "));
    assert!(client.refused("inspect", json!({})).contains("<MODEL>"));
    assert!(
        client
            .refused("bake", json!({ "high": "scan.obj", "output": "out.txt" }))
            .contains("unsupported format")
    );
    let both = json!({ "high": "scan.obj", "output": "out.glb", "triangles": 500, "error": 1 });
    assert!(client.refused("bake", both).contains("cannot be used with"));
    let unit = json!({ "asset": "scan.obj", "scan": "scan.obj", "require": ["hausdorff=1mm"] });
    assert!(client.refused("verify", unit).contains("unit"));
    let over = json!({ "model": "scan.obj", "output": "scan.obj" });
    assert!(client.refused("render", over).contains("scan.obj"));
    assert_eq!(place.files(), ["broken.obj", "scan.obj"]);
}

#[test]
fn a_cancelled_call_ends_and_leaves_no_files() {
    let place = large();
    let mut client = Client::new(&place, &[], None);
    let slow = json!({ "high": "scan.obj", "output": "out.glb", "triangles": 4000, "size": 512 });
    let id = client.request("tools/call", json!({ "name": "bake", "arguments": slow }));
    while client.progress.len() < 3 {
        client.next(Duration::from_secs(60)).expect("it reports progress");
    }
    let start = Instant::now();
    let params = json!({ "requestId": id, "reason": "no longer wanted" });
    client.send(&json!({ "jsonrpc": "2.0", "method": "notifications/cancelled", "params": params }));
    client.done("render", json!({ "model": "scan.obj", "size": 16 }));
    assert!(start.elapsed() < Duration::from_secs(20), "the next call waits for the cancelled one");
    let stray = client.next(Duration::from_millis(300));
    assert!(
        stray.as_ref().is_none_or(|message| message["id"] != id),
        "a cancelled call is not answered: {stray:?}"
    );
    assert_eq!(place.files(), ["out.glb", "scan.obj"]);
    assert_eq!(place.read("out.glb"), b"before");
}

#[test]
fn a_client_that_leaves_ends_the_work() {
    let place = large();
    let mut client = Client::new(&place, &[], None);
    let slow = json!({ "high": "scan.obj", "output": "out.glb", "triangles": 4000, "size": 512 });
    client.request("tools/call", json!({ "name": "bake", "arguments": slow }));
    while client.progress.len() < 3 {
        client.next(Duration::from_secs(60)).expect("it reports progress");
    }
    assert!(client.close());
    std::thread::sleep(Duration::from_secs(1));
    assert_eq!(place.files(), ["out.glb", "scan.obj"]);
    assert_eq!(place.read("out.glb"), b"before");
}

#[test]
fn odd_messages_do_not_end_the_session() {
    let place = Place::with("scan.obj", SCAN.obj());
    let mut client = Client::new(&place, &[], None);
    client.send_line("{ not json");
    client.send_line("");
    client.send_line("[1, 2, 3]");
    client.send_line(r#"{"jsonrpc":"2.0","id":"x","method":"tools/call","params":"none"}"#);
    client.send_line(&format!(r#"{{"jsonrpc":"2.0","id":77,"method":"{}"}}"#, "x".repeat(20 << 20)));
    client.send(&json!({ "jsonrpc": "2.0", "id": 9999, "result": { "roots": [] } }));
    let code = |answer: &Value| answer["error"]["code"].as_i64();
    let unknown = client.ask("tools/call", json!({ "name": "remove", "arguments": {} }));
    assert_eq!(code(&unknown), Some(-32602), "{unknown}");
    assert_eq!(code(&client.ask("resources/read", json!({ "uri": "file:///etc/passwd" }))), Some(-32601));
    assert_eq!(code(&client.ask("none/such", json!({}))), Some(-32601));
    for wrong in [
        json!({ "model": 5 }),
        json!({ "model": {} }),
        json!({ "model": "a\u{0}b" }),
        json!({ "options": 1 }),
    ] {
        client.refused("inspect", wrong);
    }
    client.refused("render", json!({ "model": "x".repeat(100_000) }));
    client.done("inspect", json!({ "model": "scan.obj" }));
    assert!(client.close());
}

#[test]
fn without_a_client_the_server_ends() {
    let place = Place::new();
    let stderr = "taotie: error: no MCP client on stdin: connection closed: initialize request\n";
    place.taotie("mcp").stdin("").assert().code(2).stdout_eq("").stderr_eq(stderr);
    let stderr = "taotie: error: none: No such file or directory (os error 2)\n";
    place.taotie("mcp none").assert().code(2).stderr_eq(stderr);
    place.write("file", "");
    place.taotie("mcp file").assert().code(2).stderr_eq("taotie: error: file: not a folder\n");
}
