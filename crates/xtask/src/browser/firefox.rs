//! A headless Firefox with one page, driven by `WebDriver BiDi`: enough to see that the page is not for Chromium alone.
//!
//! The protocol is described at <https://w3c.github.io/webdriver-bidi/>.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::Arc,
};

use anyhow::{Context as _, Result, bail};
use data_encoding::BASE64;
use serde_json::{Value, json};

use super::{
    Picture, Profile,
    devtools::Connection,
    display::{Display, Hands},
    wait_for_address,
};
use crate::process::{find_program, lead_group};

/// What Firefox is called on various systems.
const NAMES: [&str; 2] = ["firefox-esr", "firefox"];

/// Where headless Firefox says that it listens.
const LISTENING: &str = "WebDriver BiDi listening on ";

/// Settings without which pages cannot be drawn on a machine without graphics card, or meet what is not theirs.
const PREFERENCES: &str = "\
user_pref(\"webgl.force-enabled\", true);
user_pref(\"webgl.disable-fail-if-major-performance-caveat\", true);
user_pref(\"browser.shell.checkDefaultBrowser\", false);
user_pref(\"datareporting.policy.dataSubmissionEnabled\", false);
user_pref(\"app.update.enabled\", false);
user_pref(\"gfx.x11-egl.force-enabled\", true);
";

/// Settings with which Firefox starts as usual after it was killed many times.
const AFTER_CRASHES: &str = "\
user_pref(\"toolkit.startup.max_resumed_crashes\", -1);
user_pref(\"browser.sessionstore.resume_from_crash\", false);
";

/// A running Firefox; ends when it is dropped.
pub struct Firefox {
    process: Child,
    display: Option<Display>,
    // Goes after the process does.
    _profile: Arc<Profile>,
    connection: Connection,
    context: String,
}

impl Firefox {
    /// The program, if there is one.
    pub fn find() -> Option<PathBuf> {
        find_program(&NAMES)
    }

    /// Starts Firefox with an empty page of this size, in CSS pixels, and with further settings: lines of a `user.js`.
    pub fn start(program: &Path, width: u32, height: u32, settings: &str) -> Result<Self> {
        Self::launch(program, Profile::create()?, [width, height], settings, |_| ())
    }

    /// Starts Firefox on what an earlier one stored, as the leader of a group of processes that can be killed.
    pub fn start_on(profile: &Arc<Profile>, program: &Path, size: [u32; 2]) -> Result<Self> {
        Self::launch(program, Arc::clone(profile), size, AFTER_CRASHES, lead_group)
    }

    fn launch(
        program: &Path,
        profile: Arc<Profile>,
        [width, height]: [u32; 2],
        settings: &str,
        prepare: impl FnOnce(&mut Command),
    ) -> Result<Self> {
        fs::write(profile.folder().join("user.js"), format!("{PREFERENCES}{settings}"))?;
        let mut command = Command::new(program);
        prepare(&mut command);
        // Headless Firefox draws nothing in WebGL on most systems; a display in memory will do.
        let display = Display::open()?;
        match &display {
            Some(display) => command.env("DISPLAY", display.name()),
            None => command.arg("--headless"),
        };
        let mut process = command
            .args(["--no-remote", "--remote-debugging-port=0", "--profile"])
            .arg(profile.folder())
            .arg("about:blank")
            .env("HOME", profile.folder())
            // Mesa draws where there is no graphics card.
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| format!("{} could not be started", program.display()))?;
        let connected = wait_for_address(&mut process, LISTENING)
            .and_then(|address| Connection::open(&format!("{address}/session")));
        let connection = match connected {
            Ok(connection) => connection,
            Err(reason) => {
                let _ = process.kill();
                let _ = process.wait();
                return Err(reason);
            }
        };
        let mut firefox = Self { process, display, _profile: profile, connection, context: String::new() };
        firefox.call("session.new", &json!({ "capabilities": {} }))?;
        let tree = firefox.call("browsingContext.getTree", &json!({}))?;
        tree["contexts"][0]["context"].as_str().context("there is no page")?.clone_into(&mut firefox.context);
        let viewport = json!({ "width": width, "height": height });
        firefox.call(
            "browsingContext.setViewport",
            &json!({ "context": firefox.context, "viewport": viewport }),
        )?;
        Ok(firefox)
    }

    /// The process that leads all others, if Firefox was started on a profile.
    pub fn leader(&self) -> u32 {
        self.process.id()
    }

    /// Hands for its display, if it has one and `xdotool` is installed.
    pub fn hands(&self) -> Result<Option<Hands>> {
        self.display.as_ref().map_or(Ok(None), Display::hands)
    }

    /// Goes to an address and waits until the document is loaded.
    pub fn go_to(&mut self, url: &str) -> Result<()> {
        let to = json!({ "context": self.context, "url": url, "wait": "complete" });
        self.call("browsingContext.navigate", &to).map(|_| ())
    }

    /// The value of a JavaScript expression; promises are awaited.
    pub fn evaluate(&mut self, expression: &str) -> Result<Value> {
        let answer = self.call(
            "script.evaluate",
            &json!({
                "expression": format!("(async () => JSON.stringify(await ({expression})) ?? 'null')()"),
                "target": { "context": self.context },
                "awaitPromise": true,
            }),
        )?;
        if answer["type"] != "success" {
            bail!("`{expression}` threw {}", answer["exceptionDetails"]["text"]);
        }
        let value = answer["result"]["value"].as_str().context("no value")?;
        Ok(serde_json::from_str(value)?)
    }

    /// Waits until a JavaScript expression is true; one that throws is not. Gives up after a minute and a half.
    pub fn wait_until(&mut self, expression: &str) -> Result<()> {
        let came_true = self.evaluate(&format!(
            "new Promise((resolve) => {{
                const end = performance.now() + 90000;
                const look = async () => {{
                    let value = false;
                    try {{ value = await ({expression}); }} catch {{}}
                    if (value || performance.now() > end) resolve(Boolean(value));
                    else setTimeout(look, 15);
                }};
                look();
            }})"
        ))?;
        if came_true != true {
            let state = self
                .evaluate("JSON.stringify(window.enroute?.state?.())?.slice(0, 1000)")
                .unwrap_or_default();
            bail!("waiting for `{expression}`: it never came true; state: {state}");
        }
        Ok(())
    }

    /// Presses and releases keys one after the other, as characters or as `WebDriver` spells keys without one.
    pub fn press(&mut self, keys: &str) -> Result<()> {
        let actions: Vec<Value> = keys
            .chars()
            .flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key })))
            .collect();
        let source = json!({ "type": "key", "id": "keyboard", "actions": actions });
        let all = json!({ "context": self.context, "actions": [source] });
        self.call("input.performActions", &all).map(|_| ())
    }

    /// Clicks with a button of the mouse (0 is the left one, 2 the right one) at a place, in CSS pixels.
    pub fn click(&mut self, button: u32, x: f64, y: f64) -> Result<()> {
        let actions = json!([
            { "type": "pointerMove", "x": x.round() as i64, "y": y.round() as i64 },
            { "type": "pointerDown", "button": button },
            { "type": "pointerUp", "button": button },
        ]);
        let source = json!({ "type": "pointer", "id": "mouse", "actions": actions });
        let all = json!({ "context": self.context, "actions": [source] });
        self.call("input.performActions", &all).map(|_| ())
    }

    /// The page printed on A4, as a PDF.
    pub fn print(&mut self) -> Result<Vec<u8>> {
        let margin = json!({ "top": 1.6, "bottom": 1.8, "left": 1.5, "right": 1.5 });
        let paper =
            json!({ "context": self.context, "margin": margin, "page": { "width": 21.0, "height": 29.7 } });
        let answer = self.call("browsingContext.print", &paper)?;
        Ok(BASE64.decode(answer["data"].as_str().unwrap_or_default().as_bytes())?)
    }

    /// The page as pixels.
    pub fn screenshot(&mut self) -> Result<Picture> {
        let answer = self.call("browsingContext.captureScreenshot", &json!({ "context": self.context }))?;
        Picture::decode(&BASE64.decode(answer["data"].as_str().unwrap_or_default().as_bytes())?)
    }

    fn call(&mut self, method: &str, params: &Value) -> Result<Value> {
        self.connection.call(None, method, params)
    }
}

impl Drop for Firefox {
    fn drop(&mut self) {
        if self.call("browser.close", &json!({})).is_err() {
            let _ = self.process.kill();
        }
        let _ = self.process.wait();
    }
}
