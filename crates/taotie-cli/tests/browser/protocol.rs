//! The DevTools protocol: JSON over a web socket, one answer for each command, events in between.

use serde_json::{Value, json};
use std::net::TcpStream;
use tungstenite::{Message, WebSocket, client};

/// A connection to a browser.
pub struct Connection {
    socket: WebSocket<TcpStream>,
    last: u64,
    /// Name and content of all that was reported.
    pub events: Vec<(String, Value)>,
}

impl Connection {
    /// Connects to `ws://host:port/...`.
    pub fn new(address: &str) -> Self {
        let host = address.trim_start_matches("ws://").split('/').next().expect("an address has a host");
        let stream = TcpStream::connect(host).expect("the browser listens");
        stream.set_read_timeout(Some(super::PATIENCE)).expect("a limit can be set");
        let (socket, _) = client(address, stream).expect("the browser answers");
        Self { socket, last: 0, events: Vec::new() }
    }

    /// A command, of a session or of the browser; its result.
    pub fn call(&mut self, session: Option<&str>, method: &str, parameters: Value) -> Value {
        self.last += 1;
        let mut command = json!({ "id": self.last, "method": method, "params": parameters });
        if let Some(session) = session {
            command["sessionId"] = json!(session);
        }
        self.socket.send(Message::text(command.to_string())).expect("the browser is there");
        loop {
            let mut answer = self.read();
            if answer["id"] == self.last {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].take();
            }
            if let Some(name) = answer["method"].as_str().map(str::to_owned) {
                self.events.push((name, answer["params"].take()));
            }
        }
    }

    fn read(&mut self) -> Value {
        let message = self.socket.read().expect("the browser answers in time");
        let text = message.into_text().expect("it speaks text");
        if text.is_empty() { Value::Null } else { serde_json::from_str(&text).expect("it speaks JSON") }
    }
}
