//! A file server on a loopback address, for the built page.

use std::{
    fs::{self, File},
    io,
    net::{Ipv4Addr, SocketAddr},
    path::{Component, Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    thread,
};

use anyhow::{Result, anyhow};
use tiny_http::{Header, Method, Request, Response, Server};

/// How many requests are answered at once; browsers ask for six files of one host at a time.
const ANSWERING_THREADS: usize = 6;

/// How many ports above the wished one are tried.
const PORTS_TRIED: u16 = 50;

/// Asked by a page that wants to be loaded anew when it was rebuilt; answers with [`SiteServer::builds`].
const BUILDS_PATH: &str = "/dev/builds";

/// What a page that is being developed carries to notice that it was rebuilt.
const RELOAD_SCRIPT: &str = include_str!("reload.html");

/// Serves a folder until it is dropped.
pub struct SiteServer {
    server: Arc<Server>,
    url: String,
    builds: Arc<AtomicU64>,
}

struct Site {
    folder: PathBuf,
    builds: Arc<AtomicU64>,
    reloading: bool,
}

impl SiteServer {
    /// Serves `folder` at `port`, or at the next free port above it; port 0 is any free port.
    ///
    /// With `reloading`, the page asks now and then whether it was rebuilt and loads itself anew.
    pub fn start(folder: &Path, port: u16, reloading: bool) -> Result<Self> {
        let server = Arc::new(bind(port)?);
        let address = server.server_addr().to_ip().ok_or_else(|| anyhow!("the server has no address"))?;
        let builds = Arc::new(AtomicU64::new(1));
        let site = Arc::new(Site { folder: folder.to_path_buf(), builds: Arc::clone(&builds), reloading });
        for _ in 0..ANSWERING_THREADS {
            let (server, site) = (Arc::clone(&server), Arc::clone(&site));
            thread::spawn(move || {
                while let Ok(request) = server.recv() {
                    // A browser that went away while it was answered is no trouble of ours.
                    let _ = site.answer(request);
                }
            });
        }
        Ok(Self { server, url: format!("http://{address}/"), builds })
    }

    /// The address of the page.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Tells open pages that there is a new build.
    pub fn announce_build(&self) {
        self.builds.fetch_add(1, Ordering::Relaxed);
    }
}

impl Drop for SiteServer {
    fn drop(&mut self) {
        for _ in 0..ANSWERING_THREADS {
            self.server.unblock();
        }
    }
}

fn bind(port: u16) -> Result<Server> {
    let last = if port == 0 { 0 } else { port.saturating_add(PORTS_TRIED) };
    let mut refusal = anyhow!("no port was tried");
    for port in port..=last {
        match Server::http(SocketAddr::from((Ipv4Addr::LOCALHOST, port))) {
            Ok(server) => return Ok(server),
            Err(reason) => {
                refusal = anyhow!("no free port between {port} and {last}: {reason}");
            }
        }
    }
    Err(refusal)
}

impl Site {
    fn answer(&self, request: Request) -> io::Result<()> {
        if !matches!(request.method(), Method::Get | Method::Head) {
            return request.respond(Response::from_string("read only\n").with_status_code(405));
        }
        let path = request.url().split(['?', '#']).next().unwrap_or("/");
        if path == BUILDS_PATH {
            let builds = self.builds.load(Ordering::Relaxed).to_string();
            return request.respond(Response::from_string(builds).with_header(not_cached()));
        }
        let Some(file) = file_of(&self.folder, path) else {
            let missing = format!("there is no {path}\n");
            return request.respond(Response::from_string(missing).with_status_code(404));
        };
        let kind = header("Content-Type", media_type(&file));
        if self.reloading && file.extension().is_some_and(|extension| extension == "html") {
            let page = fs::read_to_string(&file)?.replace("</body>", RELOAD_SCRIPT);
            return request.respond(with_headers(Response::from_string(page), kind));
        }
        request.respond(with_headers(Response::from_file(File::open(&file)?), kind))
    }
}

/// The file that a path of an address names, if it lies within `folder`.
fn file_of(folder: &Path, path: &str) -> Option<PathBuf> {
    let relative = Path::new(path.trim_start_matches('/'));
    if !relative.components().all(|component| matches!(component, Component::Normal(_))) {
        return None;
    }
    let mut file = folder.join(relative);
    if file.is_dir() {
        file.push("index.html");
    }
    file.is_file().then_some(file)
}

/// The media type of a file, by its name; browsers refuse modules and wasm of another type.
pub fn media_type(file: &Path) -> &'static str {
    match file.extension().and_then(|extension| extension.to_str()).unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "wasm" => "application/wasm",
        "json" => "application/json",
        "webmanifest" => "application/manifest+json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "ts" | "txt" | "rmpl" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

/// Adds what every file of the page is sent with. The two cross-origin headers isolate the page from others, which is
/// what browsers want of a page that shares memory with its worker.
fn with_headers<R: io::Read>(response: Response<R>, kind: Header) -> Response<R> {
    response
        .with_header(kind)
        .with_header(not_cached())
        .with_header(header("Cross-Origin-Opener-Policy", "same-origin"))
        .with_header(header("Cross-Origin-Embedder-Policy", "require-corp"))
}

fn not_cached() -> Header {
    header("Cache-Control", "no-store")
}

fn header(name: &str, value: &str) -> Header {
    Header::from_bytes(name, value).expect("names and values here are plain ASCII")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_outside_the_folder_name_no_file() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert_eq!(file_of(folder, "/Cargo.toml"), Some(folder.join("Cargo.toml")));
        for path in ["/../page/Cargo.toml", "/src/../../page/Cargo.toml", "//etc/passwd"] {
            assert_eq!(file_of(folder, path), None, "{path}");
        }
    }

    #[test]
    fn a_taken_port_is_passed_over() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let first = SiteServer::start(folder, 0, false).expect("any port");
        let port: u16 = first
            .url()
            .trim_end_matches('/')
            .rsplit(':')
            .next()
            .and_then(|port| port.parse().ok())
            .expect("the address ends in a port");
        let second = SiteServer::start(folder, port, false).expect("the next port");
        assert_ne!(first.url(), second.url());
    }
}
