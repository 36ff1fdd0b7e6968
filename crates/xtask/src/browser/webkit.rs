//! A `WebKit` with one page, driven by `WebDriver`: the small browser of `WebKitGTK`, in a display in memory.
//!
//! The protocol is described at <https://www.w3.org/TR/webdriver2/>. Each command is one request over a connection of its own.

use std::{
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result, bail, ensure};
use serde_json::{Value, json};

use super::{Profile, display::Display};
use crate::process::find_program;

/// Where Debian puts the browser that the driver drives.
const BROWSERS: [&str; 2] = [
    "/usr/lib/x86_64-linux-gnu/webkit2gtk-4.1/MiniBrowser",
    "/usr/lib/aarch64-linux-gnu/webkit2gtk-4.1/MiniBrowser",
];

/// How long the driver may take to start.
const START_LIMIT: Duration = Duration::from_mins(1);

/// How long a script or a page may take, in milliseconds.
const LIMIT_MILLIS: u32 = 120_000;

/// A running browser; ends when it is dropped.
pub struct WebKit {
    driver: Child,
    // Goes after the driver does.
    _display: Display,
    // Goes after the driver does.
    _home: Arc<Profile>,
    port: u16,
    session: String,
}

/// The programs that are needed.
#[derive(Clone, Debug)]
pub struct WebKitPrograms {
    driver: PathBuf,
    browser: PathBuf,
}

impl WebKitPrograms {
    pub(super) fn browser(&self) -> &Path {
        &self.browser
    }
}

impl WebKit {
    /// The driver, the browser and a display, if they are there.
    pub fn find() -> Option<WebKitPrograms> {
        let driver = find_program(&["WebKitWebDriver"])?;
        let browser = BROWSERS.map(PathBuf::from).into_iter().find(|path| path.is_file())?;
        Display::is_there().then_some(WebKitPrograms { driver, browser })
    }

    /// Starts the browser with an empty page.
    pub fn start(programs: &WebKitPrograms) -> Result<Self> {
        let home = Profile::create()?;
        // Free a moment ago; the driver can only be told a number.
        let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
        let display = Display::open()?.context("there is no Xvfb")?;
        let driver = Command::new(&programs.driver)
            .env("DISPLAY", display.name())
            .arg(format!("--port={port}"))
            .envs([("HOME", home.folder()), ("XDG_RUNTIME_DIR", home.folder())])
            // Mesa draws where there is no graphics card.
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .with_context(|| format!("{} could not be started", programs.driver.display()))?;
        let mut webkit = Self { driver, _display: display, _home: home, port, session: String::new() };
        let begun = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            ensure!(begun.elapsed() < START_LIMIT, "the driver of WebKit did not start");
            thread::sleep(Duration::from_millis(50));
        }
        let options = json!({ "binary": programs.browser, "args": ["--automation"] });
        let wanted = json!({ "capabilities": { "alwaysMatch": { "webkitgtk:browserOptions": options } } });
        let session = webkit.call("POST", "/session", &wanted)?;
        webkit.session =
            format!("/session/{}", session["sessionId"].as_str().context("WebKit opened no session")?);
        webkit.command("timeouts", &json!({ "script": LIMIT_MILLIS, "pageLoad": LIMIT_MILLIS }))?;
        Ok(webkit)
    }

    /// Goes to an address and waits until the document is loaded.
    pub fn go_to(&self, url: &str) -> Result<()> {
        self.command("url", &json!({ "url": url })).map(|_| ())
    }

    /// The value of a JavaScript expression; promises are awaited.
    pub fn evaluate(&self, expression: &str) -> Result<Value> {
        let script = format!(
            "const done = arguments[arguments.length - 1];
             (async () => ({expression}))().then((value) => done({{ value }}), (error) => done({{ thrown: String(error) }}));"
        );
        let mut answer = self.command("execute/async", &json!({ "script": script, "args": [] }))?;
        if let Some(thrown) = answer.get("thrown") {
            bail!("`{expression}` threw {thrown}");
        }
        Ok(answer["value"].take())
    }

    /// Presses and releases keys one after the other, as characters or as `WebDriver` spells keys without one.
    pub fn press(&self, keys: &str) -> Result<()> {
        let actions: Vec<Value> = keys
            .chars()
            .flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key })))
            .collect();
        self.act(&json!({ "type": "key", "id": "keyboard", "actions": actions }))
    }

    /// Clicks with a button of the mouse (0 is the left one, 2 the right one) at a place, in CSS pixels.
    pub fn click(&self, button: u32, x: f64, y: f64) -> Result<()> {
        let actions = json!([
            { "type": "pointerMove", "x": x.round() as i64, "y": y.round() as i64 },
            { "type": "pointerDown", "button": button },
            { "type": "pointerUp", "button": button },
        ]);
        self.act(&json!({ "type": "pointer", "id": "mouse", "actions": actions }))
    }

    fn act(&self, source: &Value) -> Result<()> {
        self.command("actions", &json!({ "actions": [source] })).map(|_| ())
    }

    fn command(&self, name: &str, body: &Value) -> Result<Value> {
        self.call("POST", &format!("{}/{name}", self.session), body)
    }

    /// One command of the protocol; its value, or what the driver says is wrong.
    fn call(&self, method: &str, path: &str, body: &Value) -> Result<Value> {
        let body = body.to_string();
        let mut stream = TcpStream::connect(("127.0.0.1", self.port))?;
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n\
             Content-Length: {}\r\nConnection: close\r\n\r\n{body}",
            body.len()
        )?;
        let answer = read_answer(&mut stream)?;
        let mut answer: Value = serde_json::from_slice(&answer).context("the driver answers no JSON")?;
        if let Some(error) = answer["value"]["error"].as_str() {
            bail!("{path}: {error}: {}", answer["value"]["message"]);
        }
        Ok(answer["value"].take())
    }
}

/// The body of an answer, which the driver gives the length of and may leave the connection open after.
fn read_answer(stream: &mut TcpStream) -> Result<Vec<u8>> {
    let mut received = Vec::new();
    let mut part = [0; 4096];
    loop {
        if let Some(start) = received.windows(4).position(|bytes| bytes == b"\r\n\r\n") {
            let head = String::from_utf8_lossy(&received[..start]).to_ascii_lowercase();
            let length =
                head.lines().find_map(|line| line.strip_prefix("content-length:")?.trim().parse().ok());
            let end = start + 4 + length.unwrap_or(usize::MAX - start - 4);
            if received.len() >= end {
                return Ok(received[start + 4..end].to_vec());
            }
        }
        match stream.read(&mut part)? {
            0 => bail!("the driver broke off: {}", String::from_utf8_lossy(&received)),
            count => received.extend_from_slice(&part[..count]),
        }
    }
}

impl Drop for WebKit {
    fn drop(&mut self) {
        // The browser ends with its session; one that does not ends with its display.
        let _ = self.call("DELETE", &self.session, &json!({}));
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
