//! A file server on a loopback address, for the built page.
//!
//! It knows just enough of HTTP for a browser on the same machine: one request on each connection, GET and HEAD. `axum` with
//! `tower-http` would halve these lines, for 22 more crates before the first `cargo xtask`; `tiny_http` keeps connections that
//! were open when the server has gone.

use std::{
    fs::{self, File},
    io::{self, Read as _, Write as _},
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
    path::{Component, Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::{Result, anyhow};

/// How many ports above the wished one are tried.
const PORTS_TRIED: u16 = 50;

/// More than any browser sends as the head of a request.
const LONGEST_HEAD: usize = 64 * 1024;

/// How long a connection may say nothing; browsers open some in advance that they never use.
const PATIENCE: Duration = Duration::from_mins(1);

/// How long the head of a request may take once it has started, and each piece of the answer.
const LONGEST_TRANSFER: Duration = Duration::from_secs(20);

/// How often the page was rebuilt: a page that asks for this loads itself again when the number changes.
const BUILDS_PATH: &str = "/dev/builds";

/// What a page that is being developed carries to notice that it was rebuilt.
const RELOAD_SCRIPT: &str = include_str!("reload.js");

/// Where it finds that.
const RELOAD_PATH: &str = "/dev/reload.js";

/// Serves a folder until it is dropped.
pub struct SiteServer {
    address: SocketAddr,
    url: String,
    site: Arc<Site>,
}

struct Site {
    folder: PathBuf,
    builds: AtomicU64,
    reloading: bool,
    is_over: AtomicBool,
}

/// What is sent back.
struct Answer {
    status: &'static str,
    media_type: &'static str,
    length: u64,
    body: Box<dyn io::Read>,
}

impl SiteServer {
    /// Serves `folder` at `port`, or at the next free port above it; port 0 is any free port.
    ///
    /// With `reloading`, the page asks now and then whether it was rebuilt, and loads itself again.
    pub fn start(folder: &Path, port: u16, reloading: bool) -> Result<Self> {
        let listener = bind(port)?;
        let address = listener.local_addr()?;
        let site = Arc::new(Site {
            folder: folder.to_path_buf(),
            builds: AtomicU64::new(1),
            reloading,
            is_over: AtomicBool::new(false),
        });
        let listening = Arc::clone(&site);
        thread::spawn(move || {
            for connection in listener.incoming().map_while(io::Result::ok) {
                if listening.is_over.load(Ordering::Relaxed) {
                    break;
                }
                let site = Arc::clone(&listening);
                // A browser that goes away while it is answered is not our concern.
                thread::spawn(move || site.serve(connection).ok());
            }
        });
        Ok(Self { address, url: format!("http://{address}/"), site })
    }

    /// The address of the page.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Tells open pages that there is a new build.
    pub fn announce_build(&self) {
        self.site.builds.fetch_add(1, Ordering::Relaxed);
    }
}

impl Drop for SiteServer {
    fn drop(&mut self) {
        self.site.is_over.store(true, Ordering::Relaxed);
        // Wakes the listener, which then notices.
        drop(TcpStream::connect(self.address));
    }
}

fn bind(port: u16) -> Result<TcpListener> {
    let last = if port == 0 { 0 } else { port.saturating_add(PORTS_TRIED) };
    let mut refusal = anyhow!("no port was tried");
    for port in port..=last {
        match TcpListener::bind((Ipv4Addr::LOCALHOST, port)) {
            Ok(listener) => return Ok(listener),
            Err(reason) => refusal = anyhow!("no free port up to {last}: {reason}"),
        }
    }
    Err(refusal)
}

impl Site {
    /// Reads one request and answers it.
    fn serve(&self, mut connection: TcpStream) -> io::Result<()> {
        connection.set_read_timeout(Some(PATIENCE))?;
        connection.set_write_timeout(Some(LONGEST_TRANSFER))?;
        let Some(Request { method, path, host }) = read_request(&mut connection)? else {
            return Ok(());
        };
        let mut answer = match method.as_str() {
            // Another name for this machine may be anybody's, whose pages must not read what is served here.
            _ if !is_own_name(&host) => {
                Answer::text("421 Misdirected Request", format!("this is not {host}\n"))
            }
            "GET" | "HEAD" => self.answer(&path)?,
            _ => Answer::text("405 Method Not Allowed", "read only\n".to_owned()),
        };
        // The two cross-origin headers isolate the page from others, which is what browsers want of a page that
        // shares memory with its worker.
        write!(
            connection,
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
             Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Embedder-Policy: require-corp\r\n\
             X-Content-Type-Options: nosniff\r\nContent-Security-Policy: frame-ancestors 'none'\r\n\
             Referrer-Policy: no-referrer\r\nConnection: close\r\n\r\n",
            answer.status, answer.media_type, answer.length
        )?;
        if method == "GET" {
            io::copy(&mut answer.body, &mut connection)?;
        }
        connection.flush()
    }

    fn answer(&self, path: &str) -> io::Result<Answer> {
        if path == BUILDS_PATH {
            return Ok(Answer::text("200 OK", self.builds.load(Ordering::Relaxed).to_string()));
        }
        if self.reloading && path == RELOAD_PATH {
            let script = Answer::text("200 OK", RELOAD_SCRIPT.to_owned());
            return Ok(Answer { media_type: "text/javascript; charset=utf-8", ..script });
        }
        let Some(path) = file_of(&self.folder, path) else {
            return Ok(Answer::text("404 Not Found", format!("there is no {path}\n")));
        };
        let media_type = media_type(&path);
        if self.reloading && path.extension().is_some_and(|extension| extension == "html") {
            let carried = format!("<script type=\"module\" src=\"{RELOAD_PATH}\"></script>\n  </body>");
            let page = fs::read_to_string(&path)?.replace("</body>", &carried);
            return Ok(Answer { media_type, ..Answer::text("200 OK", page) });
        }
        let file = File::open(&path)?;
        let length = file.metadata()?.len();
        Ok(Answer { status: "200 OK", media_type, length, body: Box::new(file.take(length)) })
    }
}

impl Answer {
    fn text(status: &'static str, text: String) -> Self {
        Self {
            status,
            media_type: "text/plain; charset=utf-8",
            length: text.len() as u64,
            body: Box::new(io::Cursor::new(text)),
        }
    }
}

/// What is asked for.
struct Request {
    method: String,
    /// Without what follows `?`.
    path: String,
    /// The name by which the server was addressed.
    host: String,
}

/// Reads the head of a request. `None` if nothing was asked.
fn read_request(connection: &mut TcpStream) -> io::Result<Option<Request>> {
    let mut head = Vec::new();
    let mut piece = [0; 4096];
    let mut begun: Option<Instant> = None;
    while head.len() < LONGEST_HEAD {
        let length = connection.read(&mut piece)?;
        if length == 0 {
            return Ok(None);
        }
        head.extend_from_slice(&piece[..length]);
        let mut headers = [httparse::EMPTY_HEADER; 128];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(&head) {
            Ok(httparse::Status::Partial) => {}
            Ok(httparse::Status::Complete(_)) => {
                let path = request.path.unwrap_or("/").split(['?', '#']).next().unwrap_or("/");
                let host = request.headers.iter().find(|header| header.name.eq_ignore_ascii_case("host"));
                let host =
                    host.map_or_else(String::new, |host| String::from_utf8_lossy(host.value).into_owned());
                let method = request.method.unwrap_or_default().to_owned();
                return Ok(Some(Request { method, path: path.to_owned(), host }));
            }
            Err(reason) => return Err(io::Error::other(reason)),
        }
        let spent = begun.get_or_insert_with(Instant::now).elapsed();
        let Some(left) = LONGEST_TRANSFER.checked_sub(spent).filter(|left| !left.is_zero()) else {
            return Err(io::Error::other("the head of the request takes too long"));
        };
        connection.set_read_timeout(Some(left))?;
    }
    Err(io::Error::other("the head of the request is too long"))
}

/// Returns whether a `Host` header, with or without a port, names this machine to itself.
fn is_own_name(host: &str) -> bool {
    let name = host.rsplit_once(':').filter(|(_, port)| port.bytes().all(|it| it.is_ascii_digit()));
    matches!(name.map_or(host, |(name, _)| name), "127.0.0.1" | "localhost" | "[::1]")
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

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(server: &SiteServer, request: &str) -> String {
        let mut connection = TcpStream::connect(server.address).expect("a listening server");
        write!(connection, "{request}\r\nHost: {}\r\n\r\n", server.address).expect("an open connection");
        let mut answer = String::new();
        connection.read_to_string(&mut answer).expect("an answer");
        answer
    }

    #[test]
    fn files_are_sent_with_their_type_and_length_to_all_who_ask_at_once() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let server = SiteServer::start(&folder.join("../../web"), 0, false).expect("any port");
        let file = fs::read_to_string(folder.join("../../web/start.js")).expect("a file of the page");
        thread::scope(|scope| {
            for _ in 0..40 {
                scope.spawn(|| {
                    let answer = ask(&server, "GET /start.js?x=1 HTTP/1.1");
                    assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
                    assert!(answer.contains("Content-Type: text/javascript"), "{answer}");
                    assert!(answer.ends_with(&file), "{answer}");
                });
            }
        });
        assert!(ask(&server, "GET /missing.js HTTP/1.1").starts_with("HTTP/1.1 404"));
        assert!(ask(&server, "POST /start.js HTTP/1.1").starts_with("HTTP/1.1 405"));
        assert!(ask(&server, "HEAD /start.js HTTP/1.1").ends_with("\r\n\r\n"));
    }

    #[test]
    fn other_names_of_this_machine_are_not_answered_to() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let server = SiteServer::start(folder, 0, false).expect("any port");
        let answer = |host: &str| {
            let mut connection = TcpStream::connect(server.address).expect("a listening server");
            write!(connection, "GET /Cargo.toml HTTP/1.1\r\nHost: {host}\r\n\r\n")
                .expect("an open connection");
            let mut answer = String::new();
            connection.read_to_string(&mut answer).expect("an answer");
            answer
        };
        for host in ["localhost", "localhost:8080", "127.0.0.1:1", "[::1]:80"] {
            let answer = answer(host);
            assert!(answer.starts_with("HTTP/1.1 200"), "{host}: {answer}");
            assert!(answer.contains("X-Content-Type-Options: nosniff\r\n"), "{answer}");
        }
        for host in ["", "evil.example", "evil.example:8080", "127.0.0.1.evil.example", "localhost.evil"] {
            assert!(answer(host).starts_with("HTTP/1.1 421"), "{host}");
        }
    }

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
