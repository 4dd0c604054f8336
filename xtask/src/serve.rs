//! A small web server for the page on this machine: files of one folder, no special headers.

use std::{
    fs,
    io::{BufRead, BufReader, Result, Write},
    net::{TcpListener, TcpStream},
    path::{Component, Path},
    thread,
};

/// Serves a folder on localhost until the program ends; prints the address.
pub fn serve(folder: &Path) -> Result<()> {
    let listener = TcpListener::bind("127.0.0.1:8420").or_else(|_| TcpListener::bind("127.0.0.1:0"))?;
    println!("http://{}/ (Ctrl-C ends)", listener.local_addr()?);
    for stream in listener.incoming() {
        let folder = folder.to_path_buf();
        // A browser that goes away while it is answered is no reason to stop.
        thread::spawn(move || answer(&stream?, &folder));
    }
    Ok(())
}

fn answer(mut stream: &TcpStream, folder: &Path) -> Result<()> {
    let mut lines = BufReader::new(stream).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    for line in lines {
        if line?.is_empty() {
            break;
        }
    }
    let target = request.split(' ').nth(1).unwrap_or("/");
    let path = Path::new(target.split(['?', '#']).next().unwrap_or("/").trim_start_matches('/'));
    let inside = path.components().all(|part| matches!(part, Component::Normal(_)));
    let file = if path.as_os_str().is_empty() { folder.join("index.html") } else { folder.join(path) };
    let found = if inside { fs::read(&file).ok() } else { None };
    let (status, body) = found.map_or(("404 Not Found", Vec::new()), |body| ("200 OK", body));
    let kind = kind(&file);
    let length = body.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-cache\r\nConnection: close\r\n\r\n"
    )?;
    stream.write_all(&body)
}

fn kind(file: &Path) -> &'static str {
    match file.extension().and_then(|extension| extension.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript",
        Some("css") => "text/css",
        Some("wasm") => "application/wasm",
        Some("json") => "application/json",
        Some("jpg") => "image/jpeg",
        Some("png") => "image/png",
        _ => "application/octet-stream",
    }
}
