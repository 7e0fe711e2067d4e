//! A web server for the files of a folder, such as any that hosts a packed scene.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};

/// Serves a folder as long as the process lives; answers the address.
///
/// * `with_headers`: as a server that reads the folder's `_headers`; else one that sends none of them.
pub(super) fn serve(folder: PathBuf, with_headers: bool) -> String {
    let text = std::fs::read_to_string(folder.join("_headers")).expect("headers");
    let lines = text.lines().skip(1).filter(|_| with_headers);
    let headers: String = lines.map(|line| format!("{}\r\n", line.trim())).collect();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = format!("http://{}/", listener.local_addr().expect("address"));
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let (folder, headers) = (folder.clone(), headers.clone());
            std::thread::spawn(move || answer(stream, &folder, &headers));
        }
    });
    address
}

fn answer(mut stream: TcpStream, folder: &Path, headers: &str) -> std::io::Result<()> {
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let request = lines.next().unwrap_or_else(|| Ok(String::new()))?;
    while lines.next().is_some_and(|line| line.is_ok_and(|line| !line.is_empty())) {}
    let path = request.split(' ').nth(1).unwrap_or("/").trim_start_matches('/');
    let path = folder.join(if path.is_empty() { "index.html" } else { path });
    let kind = match path.extension().and_then(|e| e.to_str()) {
        Some("html") => "text/html",
        Some("css") => "text/css",
        Some("js") => "text/javascript",
        Some("wasm") => "application/wasm",
        Some("json") => "application/json",
        _ => "application/octet-stream",
    };
    let (status, body) = match std::fs::read(&path) {
        Ok(body) => ("200 OK", body),
        Err(_) => ("404 Not Found", Vec::new()),
    };
    let length = body.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n{headers}Connection: close\r\n\r\n"
    )?;
    stream.write_all(&body)
}
