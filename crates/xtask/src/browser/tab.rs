//! One tab: going to a page, asking it, acting on it as a user would, and looking at it.

use std::{cell::RefCell, rc::Rc};

use anyhow::{Context as _, Result, anyhow, bail, ensure};
use data_encoding::BASE64;
use serde_json::{Value, json};

use super::{
    devtools::Connection,
    keys::{Key, Modifiers},
    picture::Picture,
};

/// How long [`Tab::wait_until`] waits, in milliseconds, unless told otherwise.
const WAIT_LIMIT_MILLIS: u32 = 90_000;

/// How many frames [`Tab::click_widget`] looks at before it gives up on a widget that moves.
const FRAMES_TO_KEEP_STILL: u32 = 100;

/// What the browser says of a question that the page did not live to answer.
const PAGE_WAS_LEFT: &str = "Inspected target navigated or closed";

/// A tab of a running browser.
pub struct Tab {
    connection: Rc<RefCell<Connection>>,
    session: String,
    pixel_ratio: f64,
    log: RefCell<Vec<String>>,
}

/// A widget as the page's accessibility mirror describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Widget {
    /// Its role, such as `button`.
    pub role: String,
    /// Its accessible name.
    pub label: String,
    /// Its value, if it has one.
    pub value: Option<String>,
    /// Left edge in CSS pixels.
    pub x: f64,
    /// Upper edge in CSS pixels.
    pub y: f64,
    /// Width in CSS pixels.
    pub width: f64,
    /// Height in CSS pixels.
    pub height: f64,
}

impl Widget {
    /// The middle of the widget.
    pub fn center(&self) -> (f64, f64) {
        (self.x + self.width / 2.0, self.y + self.height / 2.0)
    }
}

impl Tab {
    pub(super) fn prepare(
        connection: Rc<RefCell<Connection>>,
        session: String,
        [width, height]: [u32; 2],
        pixel_ratio: f64,
    ) -> Result<Self> {
        let tab = Self { connection, session, pixel_ratio, log: RefCell::default() };
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            tab.call(domain, &json!({}))?;
        }
        tab.resize(width, height)?;
        // Only one window at a time has the keyboard; to its page each is the one.
        tab.call("Emulation.setFocusEmulationEnabled", &json!({ "enabled": true }))?;
        tab.prefer(&[("prefers-color-scheme", "dark")])?;
        Ok(tab)
    }

    /// Makes the page this large, in CSS pixels.
    pub fn resize(&self, width: u32, height: u32) -> Result<()> {
        self.call(
            "Emulation.setDeviceMetricsOverride",
            &json!({
                "width": width, "height": height, "deviceScaleFactor": self.pixel_ratio, "mobile": false
            }),
        )?;
        Ok(())
    }

    /// What the user has asked of all pages: media features with their values. Others are as the system has them.
    pub fn prefer(&self, features: &[(&str, &str)]) -> Result<()> {
        let features: Vec<Value> =
            features.iter().map(|(name, value)| json!({ "name": name, "value": value })).collect();
        self.call("Emulation.setEmulatedMedia", &json!({ "features": features }))?;
        Ok(())
    }

    /// Goes to an address.
    pub fn go_to(&self, url: &str) -> Result<()> {
        let answer = self.call("Page.navigate", &json!({ "url": url }))?;
        match answer["errorText"].as_str() {
            Some(reason) => bail!("{url}: {reason}"),
            None => Ok(()),
        }
    }

    /// The value of a JavaScript expression; promises are awaited.
    pub fn evaluate(&self, expression: &str) -> Result<Value> {
        let mut answer = self.call(
            "Runtime.evaluate",
            &json!({ "expression": expression, "awaitPromise": true, "returnByValue": true }),
        )?;
        if let Some(thrown) = answer.get("exceptionDetails") {
            let told = thrown["exception"]["description"]
                .as_str()
                .or(thrown["text"].as_str())
                .unwrap_or("an exception");
            bail!("`{expression}` threw {told}");
        }
        Ok(answer["result"]["value"].take())
    }

    /// Waits until a JavaScript expression is true (one that throws is not), and answers its value. Continues in the next
    /// page when this one is left meanwhile. Fails with the page's state and messages when that takes too long.
    pub fn wait_until(&self, expression: &str) -> Result<Value> {
        let waiting = format!(
            "new Promise((resolve, reject) => {{
                const start = performance.now();
                const look = async () => {{
                    let value;
                    try {{ value = await ({expression}); }} catch {{ value = false; }}
                    const waited = performance.now() - start;
                    if (value) resolve(value);
                    else if (waited > {WAIT_LIMIT_MILLIS}) reject(new Error('it never came true'));
                    // Looking takes the page's own time, and seldom more often than this finds it sooner.
                    else setTimeout(look, Math.min(10 + waited / 10, 100));
                }};
                look();
            }})"
        );
        let mut outcome = self.evaluate(&waiting);
        while outcome.as_ref().is_err_and(|reason| reason.to_string().contains(PAGE_WAS_LEFT)) {
            outcome = self.evaluate(&waiting);
        }
        outcome.map_err(|reason| {
            let state = self
                .evaluate("JSON.stringify(window.enroute?.state?.())?.slice(0, 2000)")
                .unwrap_or_default();
            anyhow!(
                "waiting for `{expression}`: {reason}\nstate: {state}\nmessages:\n{}",
                self.messages().join("\n")
            )
        })
    }

    /// Waits until the page can be driven; fails with its reason when it says that it never will be.
    pub fn wait_until_ready(&self) -> Result<()> {
        self.wait_until("'enroute' in window")?;
        self.wait_until("enroute.ready.then(() => 'ready', (reason) => String(reason))").and_then(|outcome| {
            ensure!(outcome == "ready", "the page is not ready: {outcome}\n{}", self.messages().join("\n"));
            Ok(())
        })
    }

    /// Returns what the page wrote to its console and the exceptions that no one caught, so far.
    pub fn messages(&self) -> Vec<String> {
        let events = self.connection.borrow_mut().take_events(&self.session);
        let mut log = self.log.borrow_mut();
        for event in events {
            match event.method.as_str() {
                "Runtime.consoleAPICalled" => {
                    let words: Vec<String> = event.params["args"]
                        .as_array()
                        .into_iter()
                        .flatten()
                        .map(|word| match &word["value"] {
                            Value::String(text) => text.clone(),
                            Value::Null => word["description"].as_str().unwrap_or("").to_owned(),
                            other => other.to_string(),
                        })
                        .collect();
                    let level = event.params["type"].as_str().unwrap_or("log");
                    log.push(format!("{level}: {}", words.join(" ")));
                }
                "Runtime.exceptionThrown" => {
                    let details = &event.params["exceptionDetails"];
                    let told = details["exception"]["description"]
                        .as_str()
                        .or(details["text"].as_str())
                        .unwrap_or("an exception");
                    log.push(format!("uncaught: {told}"));
                }
                "Log.entryAdded" => {
                    let entry = &event.params["entry"];
                    log.push(format!(
                        "{}: {} {}",
                        entry["level"].as_str().unwrap_or("log"),
                        entry["text"].as_str().unwrap_or(""),
                        entry["url"].as_str().unwrap_or("")
                    ));
                }
                _ => {}
            }
        }
        log.clone()
    }

    /// The messages that tell of something wrong.
    pub fn complaints(&self) -> Vec<String> {
        self.messages()
            .into_iter()
            .filter(|message| message.starts_with("error") || message.starts_with("uncaught"))
            .collect()
    }

    /// Presses and releases a key.
    pub fn press(&self, key: Key, modifiers: Modifiers) -> Result<()> {
        let spelling = key.spelling();
        let text = spelling.text.filter(|_| modifiers.types());
        let mut event = json!({
            "type": if text.is_some() { "keyDown" } else { "rawKeyDown" },
            "key": spelling.key,
            "code": spelling.code,
            "windowsVirtualKeyCode": spelling.number,
            "modifiers": modifiers.0,
        });
        if let Some(text) = text {
            event["text"] = text.into();
        }
        self.call("Input.dispatchKeyEvent", &event)?;
        event["type"] = "keyUp".into();
        if let Some(fields) = event.as_object_mut() {
            fields.remove("text");
        }
        self.call("Input.dispatchKeyEvent", &event)?;
        Ok(())
    }

    /// Types a text, key by key.
    pub fn type_text(&self, text: &str) -> Result<()> {
        for character in text.chars() {
            let key = match character {
                '\n' => Key::Enter,
                other => Key::Character(other),
            };
            self.press(key, Modifiers::NONE)?;
        }
        Ok(())
    }

    /// Clicks with the main button. No frame is waited for between press and release: where frames are slow, that
    /// would be a long press.
    pub fn click(&self, x: f64, y: f64) -> Result<()> {
        self.mouse("mouseMoved", (x, y), &json!({}))?;
        // The page learns what lies under the pointer from the frame it draws.
        self.next_frame()?;
        self.mouse("mousePressed", (x, y), &json!({ "button": "left", "buttons": 1, "clickCount": 1 }))?;
        self.mouse("mouseReleased", (x, y), &json!({ "button": "left", "clickCount": 1 }))?;
        self.next_frame()
    }

    /// Presses the main button at the first point, moves through the others and releases it at the last.
    pub fn drag(&self, points: &[(f64, f64)]) -> Result<()> {
        let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
            bail!("a drag needs a point");
        };
        self.mouse("mouseMoved", first, &json!({}))?;
        self.next_frame()?;
        let button = json!({ "button": "left", "buttons": 1, "clickCount": 1 });
        self.mouse("mousePressed", first, &button)?;
        for &point in &points[1..] {
            self.next_frame()?;
            self.mouse("mouseMoved", point, &button)?;
        }
        self.next_frame()?;
        self.mouse("mouseReleased", last, &json!({ "button": "left", "clickCount": 1 }))?;
        self.next_frame()
    }

    /// Moves the pointer without pressing anything.
    pub fn hover(&self, x: f64, y: f64) -> Result<()> {
        self.mouse("mouseMoved", (x, y), &json!({}))?;
        self.next_frame()
    }

    /// Turns the wheel over a point; positive `delta` scrolls down.
    pub fn wheel(&self, x: f64, y: f64, delta: f64) -> Result<()> {
        self.mouse("mouseMoved", (x, y), &json!({}))?;
        self.next_frame()?;
        self.mouse("mouseWheel", (x, y), &json!({ "deltaX": 0, "deltaY": delta }))?;
        self.next_frame()
    }

    /// Waits until the page has drawn twice: once with what was done before, once to show it.
    pub fn next_frame(&self) -> Result<()> {
        self.evaluate(
            "new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve(0))))",
        )?;
        Ok(())
    }

    /// All widgets of a role whose label contains a text, in the order of the mirror.
    pub fn widgets(&self, role: &str, label: &str) -> Result<Vec<Widget>> {
        let found = self.evaluate(&format!("window.enroute.widgets({}, {})", json!(role), json!(label)))?;
        Ok(found
            .as_array()
            .into_iter()
            .flatten()
            .map(|widget| Widget {
                role: widget["role"].as_str().unwrap_or_default().to_owned(),
                label: widget["label"].as_str().unwrap_or_default().to_owned(),
                value: widget["value"].as_str().map(str::to_owned),
                x: widget["x"].as_f64().unwrap_or(0.0),
                y: widget["y"].as_f64().unwrap_or(0.0),
                width: widget["width"].as_f64().unwrap_or(0.0),
                height: widget["height"].as_f64().unwrap_or(0.0),
            })
            .collect())
    }

    /// The widget of this role whose label is this text or else contains it; waits for it to appear.
    pub fn widget(&self, role: &str, label: &str) -> Result<Widget> {
        self.wait_until(&format!("window.enroute.widgets({}, {}).length > 0", json!(role), json!(label)))?;
        let mut found = self.widgets(role, label)?;
        let exact = found.iter().position(|widget| widget.label == label);
        if found.is_empty() {
            bail!("the {role} \"{label}\" went away");
        }
        Ok(found.swap_remove(exact.unwrap_or(0)))
    }

    /// Clicks the middle of a widget, once it keeps still: what has just appeared may make room for something else.
    pub fn click_widget(&self, role: &str, label: &str) -> Result<()> {
        let mut center = self.widget(role, label)?.center();
        for _ in 0..FRAMES_TO_KEEP_STILL {
            self.next_frame()?;
            let now = self.widget(role, label)?.center();
            if now == center {
                return self.click(now.0, now.1);
            }
            center = now;
        }
        bail!("the {role} \"{label}\" does not keep still")
    }

    /// Drops a file on the page, as a user would from a folder.
    pub fn drop_file(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.drop_files(&[(name, bytes)])
    }

    /// Drops files on the page together, in one event.
    pub fn drop_files(&self, files: &[(&str, &[u8])]) -> Result<()> {
        let files: Vec<Value> =
            files.iter().map(|(name, bytes)| json!([name, BASE64.encode(bytes)])).collect();
        self.evaluate(&format!(
            "(() => {{
                const transfer = new DataTransfer();
                for (const [name, text] of {}) {{
                    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
                    transfer.items.add(new File([bytes], name));
                }}
                const options = {{ bubbles: true, cancelable: true, dataTransfer: transfer }};
                document.getElementById('canvas').dispatchEvent(new DragEvent('drop', options));
            }})()",
            json!(files),
        ))?;
        Ok(())
    }

    /// The page as a PNG.
    pub fn screenshot_png(&self) -> Result<Vec<u8>> {
        let answer = self.call("Page.captureScreenshot", &json!({ "format": "png" }))?;
        decode_picture(&answer)
    }

    /// The page as pixels.
    pub fn screenshot(&self) -> Result<Picture> {
        Picture::decode(&self.screenshot_png()?)
    }

    /// A part of the page as pixels.
    pub fn screenshot_of(&self, widget: &Widget) -> Result<Picture> {
        let answer = self.call(
            "Page.captureScreenshot",
            &json!({ "format": "png", "clip": {
                "x": widget.x, "y": widget.y, "width": widget.width, "height": widget.height, "scale": 1
            }}),
        )?;
        Picture::decode(&decode_picture(&answer)?)
    }

    /// Calls a method of the `DevTools` protocol for this tab.
    pub fn call(&self, method: &str, params: &Value) -> Result<Value> {
        self.connection.borrow_mut().call(Some(&self.session), method, params)
    }

    fn mouse(&self, kind: &str, (x, y): (f64, f64), more: &Value) -> Result<()> {
        let mut event = json!({ "type": kind, "x": x, "y": y });
        if let (Some(fields), Some(more)) = (event.as_object_mut(), more.as_object()) {
            fields.extend(more.clone());
        }
        self.call("Input.dispatchMouseEvent", &event)?;
        Ok(())
    }
}

fn decode_picture(answer: &Value) -> Result<Vec<u8>> {
    let encoded = answer["data"].as_str().context("no picture was taken")?;
    BASE64.decode(encoded.as_bytes()).context("the picture is not base64")
}
