//! A client that speaks JSON-RPC over pipes.

use crate::place::Place;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

/// Maximum time to wait for a message.
const MOST: Duration = Duration::from_secs(120);

/// A client with a running server.
pub struct Client {
    server: Child,
    stdin: Option<ChildStdin>,
    messages: Receiver<Value>,
    last: u64,
    /// The folders that it declares as roots.
    pub roots: Vec<String>,
    /// All progress so far.
    pub progress: Vec<Value>,
    /// The number of requests for roots so far.
    pub asked: usize,
}

impl Client {
    /// Starts `taotie mcp` in a place without a handshake.
    pub fn start(place: &Place, folders: &[&str]) -> Self {
        Self::of(place.process(&[&["mcp"], folders].concat()))
    }

    /// Starts the server in another folder, and shakes hands.
    pub fn in_folder(place: &Place, folder: &str) -> Self {
        let mut process = place.process(&["mcp"]);
        process.current_dir(folder);
        let mut client = Self::of(process);
        client.shake(&json!({}));
        client
    }

    fn of(mut process: Command) -> Self {
        process.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut server = process.spawn().expect("the server starts");
        let (stdin, stdout) = (server.stdin.take(), server.stdout.take().expect("it is a pipe"));
        let (sender, messages) = mpsc::channel();
        std::thread::spawn(move || {
            for line in BufReader::new(stdout).lines().map_while(Result::ok) {
                let message: Value = serde_json::from_str(&line).expect("stdout has only JSON");
                assert_eq!(message["jsonrpc"], "2.0", "stdout has only the protocol: {line}");
                let _ = sender.send(message);
            }
        });
        let (roots, progress) = (Vec::new(), Vec::new());
        Self { server, stdin, messages, last: 0, roots, progress, asked: 0 }
    }

    /// Starts the server and shakes hands; with roots, if there are any.
    pub fn new(place: &Place, folders: &[&str], roots: Option<&[&Path]>) -> Self {
        let mut client = Self::start(place, folders);
        client.declare(roots.unwrap_or_default());
        let capabilities = match roots {
            Some(_) => json!({ "roots": { "listChanged": true } }),
            None => json!({}),
        };
        client.shake(&capabilities);
        client
    }

    fn shake(&mut self, capabilities: &Value) {
        let answer = self.ask(
            "initialize",
            json!({ "protocolVersion": "2025-06-18", "capabilities": capabilities,
                "clientInfo": { "name": "test", "version": "1" } }),
        );
        assert_eq!(answer["result"]["protocolVersion"], "2025-06-18", "{answer}");
        assert_eq!(answer["result"]["serverInfo"]["name"], "taotie");
        self.send(&json!({ "jsonrpc": "2.0", "method": "notifications/initialized" }));
    }

    /// Declares folders as roots from now on.
    pub fn declare(&mut self, roots: &[&Path]) {
        self.roots = roots.iter().map(|root| format!("file://{}", root.display())).collect();
    }

    /// Sends a message.
    pub fn send(&mut self, message: &Value) {
        self.send_line(&message.to_string());
    }

    /// Sends a line.
    pub fn send_line(&mut self, line: &str) {
        let stdin = self.stdin.as_mut().expect("it is open");
        writeln!(stdin, "{line}").and_then(|()| stdin.flush()).expect("the server reads");
    }

    /// Sends a request, with a token for progress; returns its number.
    pub fn request(&mut self, method: &str, mut params: Value) -> u64 {
        self.last += 1;
        if method == "tools/call" {
            params["_meta"]["progressToken"] = json!(self.last);
        }
        self.send(&json!({ "jsonrpc": "2.0", "id": self.last, "method": method, "params": params }));
        self.last
    }

    /// Returns the next message from the server, after answering its requests and noting progress.
    pub fn next(&mut self, most: Duration) -> Option<Value> {
        let end = Instant::now() + most;
        loop {
            let message = self.messages.recv_timeout(end.saturating_duration_since(Instant::now())).ok()?;
            match message["method"].as_str() {
                Some("roots/list") => {
                    self.asked += 1;
                    let roots: Vec<Value> = self.roots.iter().map(|uri| json!({ "uri": uri })).collect();
                    self.send(
                        &json!({ "jsonrpc": "2.0", "id": message["id"], "result": { "roots": roots } }),
                    );
                }
                Some("notifications/progress") => {
                    self.progress.push(message["params"].clone());
                    return Some(message);
                }
                _ => return Some(message),
            }
        }
    }

    /// Sends a request and returns the answer to it.
    pub fn ask(&mut self, method: &str, params: Value) -> Value {
        let id = self.request(method, params);
        self.answer(id)
    }

    /// Returns the answer to a request.
    pub fn answer(&mut self, id: u64) -> Value {
        loop {
            let message = self.next(MOST).unwrap_or_else(|| panic!("request {id} is not answered"));
            if message["id"] == id && message.get("method").is_none() {
                return message;
            }
        }
    }

    /// Calls a tool; returns its result, which may be an error.
    pub fn call(&mut self, tool: &str, arguments: Value) -> Value {
        let answer = self.ask("tools/call", json!({ "name": tool, "arguments": arguments }));
        answer.get("result").unwrap_or_else(|| panic!("{tool}: {answer}")).clone()
    }

    /// Calls a tool that must succeed.
    pub fn done(&mut self, tool: &str, arguments: Value) -> Value {
        let result = self.call(tool, arguments);
        assert_eq!(result["isError"], false, "{tool}: {}", text(&result));
        result
    }

    /// Calls a tool that must fail; returns its message.
    pub fn refused(&mut self, tool: &str, arguments: Value) -> String {
        let result = self.call(tool, arguments.clone());
        assert_eq!(result["isError"], true, "{tool} {arguments}: {}", text(&result));
        text(&result)
    }

    /// Closes stdin; returns true if the server then ends successfully.
    pub fn close(mut self) -> bool {
        self.stdin = None;
        let end = Instant::now() + Duration::from_secs(10);
        while Instant::now() < end {
            if let Some(status) = self.server.try_wait().expect("it can be waited for") {
                return status.success();
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        false
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Returns the first text of a result.
pub fn text(result: &Value) -> String {
    result["content"][0]["text"].as_str().unwrap_or_default().to_owned()
}

/// Returns the pictures of a result: media type and file.
pub fn pictures(result: &Value) -> Vec<(String, Vec<u8>)> {
    use base64::Engine;
    let content = result["content"].as_array().expect("content is a list");
    let of = |item: &Value| {
        let data = item["data"].as_str()?;
        assert!(data.len() <= 1_000_000, "a picture is too large");
        let file = base64::engine::general_purpose::STANDARD.decode(data).expect("it is Base64");
        Some((item["mimeType"].as_str()?.to_owned(), file))
    };
    content.iter().filter(|item| item["type"] == "image").filter_map(of).collect()
}
