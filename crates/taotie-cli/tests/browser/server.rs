//! A server for one page: files of some folders, and what a test holds in memory.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;

/// What an address gives.
pub enum Content {
    /// These bytes.
    Bytes(Vec<u8>),
    /// The file, or a file below the folder, that lies there.
    Path(PathBuf),
}

/// Serves each content under its address for as long as the program runs; gives the address of the server. Nobody but
/// this machine reaches it.
pub fn serve(contents: Vec<(&'static str, Content)>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let address = format!("http://{}", listener.local_addr().expect("it is bound"));
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            // A browser that leaves early needs no answer.
            let _ = answer(stream, &contents);
        }
    });
    address
}

fn answer(mut stream: TcpStream, contents: &[(&'static str, Content)]) -> std::io::Result<()> {
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let request = lines.next().unwrap_or(Ok(String::new()))?;
    for line in lines {
        if line?.is_empty() {
            break;
        }
    }
    let address = request.split(' ').nth(1).unwrap_or_default();
    let (status, body) = match find(address, contents) {
        Some(body) => ("200 OK", body),
        None => ("404 Not Found", Vec::new()),
    };
    let length = body.len();
    let kind = kind_of(address);
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
    )?;
    stream.write_all(&body)
}

fn find(address: &str, contents: &[(&'static str, Content)]) -> Option<Vec<u8>> {
    contents.iter().find_map(|(at, content)| {
        let rest = address.strip_prefix(at)?;
        match content {
            Content::Bytes(bytes) => rest.is_empty().then(|| bytes.clone()),
            Content::Path(path) if rest.is_empty() => std::fs::read(path).ok(),
            Content::Path(_) if rest.contains("..") => None,
            Content::Path(path) => std::fs::read(path.join(rest.trim_start_matches('/'))).ok(),
        }
    })
}

/// Scripts are run only where they say what they are.
fn kind_of(address: &str) -> &'static str {
    match address.rsplit_once('.').map(|(_, extension)| extension) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript",
        Some("json") => "application/json",
        _ => "application/octet-stream",
    }
}
