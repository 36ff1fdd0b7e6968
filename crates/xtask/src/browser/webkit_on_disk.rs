//! A `WebKit` that keeps what its page stores, which no session of its `WebDriver` does: `MiniBrowser`, asked by the protocol
//! of its inspector, and typed into with the keys of the display.
//!
//! The protocol is that of the remote inspector of `WebKitGTK`: each message to the page is a string in one to its target.
//! `xdotool` presses the keys.

use std::{
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    process::{Child, Command, Stdio},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result, bail, ensure};
use serde_json::{Value, json};

use super::{
    Profile, WebKitPrograms,
    devtools::{Connection, Event},
    display::{Display, Hands},
};
use crate::process::{kill_group, lead_group};

/// How long the browser may take to start, and something to become true.
const LIMIT: Duration = Duration::from_secs(90);
/// How often it is looked whether something has become true.
const PAUSE: Duration = Duration::from_millis(15);
/// Where its inspector speaks for its only page.
const PAGE: &str = "/socket/1/1/WebPage";
/// The name of its window: the title of the page, in any window manager or in none.
const WINDOW: &str = "Enroute";

/// A running browser; ends when it is dropped.
pub struct WebKitOnDisk {
    browser: Child,
    hands: Hands,
    // These go after the browser does.
    _display: Display,
    _home: Arc<Profile>,
    inspector: Connection,
    target: String,
    last_id: u64,
}

impl WebKitOnDisk {
    /// Starts the browser on what an earlier one stored, with a page, as the leader of a group of processes that can be killed.
    pub fn start_on(
        home: &Arc<Profile>,
        programs: &WebKitPrograms,
        [width, height]: [u32; 2],
        url: &str,
    ) -> Result<Self> {
        let display = Display::open()?.context("there is no Xvfb")?;
        let hands = display.hands()?.context("xdotool is not installed")?;
        // Free a moment ago; the browser can only be told a number.
        let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
        let mut command = Command::new(programs.browser());
        lead_group(&mut command);
        let mut browser = command
            .arg(format!("--geometry={width}x{height}"))
            .arg(url)
            .envs([("HOME", home.folder()), ("XDG_RUNTIME_DIR", home.folder())])
            .env("DISPLAY", display.name())
            .env("WEBKIT_INSPECTOR_HTTP_SERVER", format!("127.0.0.1:{port}"))
            // Mesa draws where there is no graphics card.
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .with_context(|| format!("{} could not be started", programs.browser().display()))?;
        let begun = Instant::now();
        let connected = loop {
            match connect(port) {
                Err(_) if begun.elapsed() < LIMIT => thread::sleep(Duration::from_millis(50)),
                connected => break connected,
            }
        };
        let (inspector, target) = match connected {
            Ok(connected) => connected,
            Err(reason) => {
                let _ = kill_group(browser.id());
                let _ = browser.wait();
                return Err(reason);
            }
        };
        Ok(Self { browser, hands, _display: display, _home: Arc::clone(home), inspector, target, last_id: 0 })
    }

    /// The process that leads all others.
    pub fn leader(&self) -> u32 {
        self.browser.id()
    }

    /// The value of a JavaScript expression; promises are awaited.
    pub fn evaluate(&mut self, expression: &str) -> Result<Value> {
        let script = format!("(async () => JSON.stringify(await ({expression})) ?? 'null')()");
        let promise = self.ask_page("Runtime.evaluate", &json!({ "expression": script }))?;
        let awaited = json!({ "promiseObjectId": promise["result"]["objectId"], "returnByValue": true });
        let answer = self.ask_page("Runtime.awaitPromise", &awaited)?;
        if answer["wasThrown"] == true {
            bail!("`{expression}` threw {}", answer["result"]["description"]);
        }
        Ok(serde_json::from_str(answer["result"]["value"].as_str().context("no value")?)?)
    }

    /// Waits until a JavaScript expression is true; one that throws is not, nor is any while a page is replaced.
    pub fn wait_until(&mut self, expression: &str) -> Result<()> {
        let begun = Instant::now();
        loop {
            let found = self.evaluate(expression);
            if found.as_ref().is_ok_and(|value| *value == true) {
                return Ok(());
            }
            ensure!(self.browser.try_wait()?.is_none(), "WebKit has ended");
            ensure!(begun.elapsed() < LIMIT, "waiting for `{expression}`: {found:?}");
            thread::sleep(PAUSE);
        }
    }

    /// Gives the window the keyboard.
    pub fn focus(&mut self) -> Result<()> {
        self.hands.act(&format!("search --onlyvisible --name {WINDOW} windowfocus"))?;
        self.wait_until("document.hasFocus()")
    }

    /// Presses and releases a key of letters, digits and blanks.
    pub fn press(&mut self, key: char) -> Result<()> {
        let name = if key == ' ' { "space".to_owned() } else { key.to_string() };
        self.hands.act(&format!("key {name}"))
    }

    /// One command of the page's own protocol; its answer.
    fn ask_page(&mut self, method: &str, params: &Value) -> Result<Value> {
        self.last_id += 1;
        let id = self.last_id;
        let message = json!({ "id": id, "method": method, "params": params }).to_string();
        let sent = json!({ "targetId": self.target, "message": message });
        if let Err(reason) = self.inspector.call(None, "Target.sendMessageToTarget", &sent) {
            // A page that goes to another process has another name afterwards.
            while let Some(event) = self.inspector.take_event() {
                if let Some(target) = target(&event) {
                    target.clone_into(&mut self.target);
                }
            }
            return Err(reason);
        }
        loop {
            let event = self.inspector.next_event()?;
            if let Some(target) = target(&event) {
                target.clone_into(&mut self.target);
                bail!("{method}: the page was replaced");
            }
            if event.method == "Target.dispatchMessageFromTarget" {
                let answer = event.params["message"].as_str().context("an empty message")?;
                let mut answer: Value = serde_json::from_str(answer)?;
                if answer["id"] == id {
                    ensure!(answer.get("error").is_none(), "{method}: {}", answer["error"]["message"]);
                    return Ok(answer["result"].take());
                }
            }
        }
    }
}

/// The inspector of the only page, and what it calls that page.
fn connect(port: u16) -> Result<(Connection, String)> {
    // The browser crashes if it is asked for a page that does not exist yet.
    let mut list = TcpStream::connect(("127.0.0.1", port))?;
    list.set_read_timeout(Some(PAUSE * 20))?;
    write!(list, "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")?;
    let mut pages = Vec::new();
    // It leaves the connection open.
    let _ = list.read_to_end(&mut pages);
    ensure!(String::from_utf8_lossy(&pages).contains(PAGE), "WebKit shows no page to inspect");
    let mut inspector = Connection::open(&format!("ws://127.0.0.1:{port}{PAGE}"))?;
    loop {
        if let Some(target) = target(&inspector.next_event()?) {
            let target = target.to_owned();
            return Ok((inspector, target));
        }
    }
}

/// The name of the page for the inspector after this event, if the event changes it.
fn target(event: &Event) -> Option<&str> {
    let info = &event.params["targetInfo"];
    match event.method.as_str() {
        "Target.targetCreated" if info["isProvisional"] != true => info["targetId"].as_str(),
        "Target.didCommitProvisionalTarget" => event.params["newTargetId"].as_str(),
        _ => None,
    }
}

impl Drop for WebKitOnDisk {
    fn drop(&mut self) {
        let _ = kill_group(self.browser.id());
        let _ = self.browser.wait();
    }
}
