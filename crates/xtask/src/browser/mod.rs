//! A headless Chromium, driven as a user would drive it: keys, clicks, wheel, and looking at what is drawn.

mod axe;
mod devtools;
mod find;
mod firefox;
mod keys;
mod picture;
mod tab;

use std::{
    cell::RefCell,
    fs,
    io::{BufRead as _, BufReader},
    path::PathBuf,
    process::{Child, Command, Stdio},
    rc::Rc,
    sync::{
        atomic::{AtomicU32, Ordering},
        mpsc,
    },
    thread,
    time::Duration,
};

use anyhow::{Context as _, Result, bail};
use serde_json::json;

pub use axe::axe_script;
pub use find::{find_or_install_chromium, is_root};
pub use firefox::Firefox;
pub use keys::{Key, Modifiers};
pub use picture::Picture;
pub use tab::{Tab, Widget};

use devtools::Connection;

/// How long Chromium may take to start.
const START_LIMIT: Duration = Duration::from_mins(1);

/// What the canvas is drawn with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Graphics {
    /// WebGL2, computed on the processor.
    #[default]
    WebGl2,
    /// WebGPU, computed on the processor.
    WebGpu,
    Nothing,
}

impl Graphics {
    /// The switches that make Chromium offer it without a graphics card.
    fn switches(self) -> &'static [&'static str] {
        match self {
            Self::WebGl2 => &["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
            Self::WebGpu => &[
                "--enable-unsafe-webgpu",
                "--enable-features=Vulkan",
                "--use-vulkan=swiftshader",
                "--use-webgpu-adapter=swiftshader",
                "--use-angle=swiftshader",
            ],
            Self::Nothing => &["--disable-gpu", "--disable-3d-apis", "--disable-features=WebGPU"],
        }
    }
}

/// A running Chromium with a profile of its own; ends when it is dropped.
pub struct Browser {
    process: Child,
    profile: PathBuf,
    connection: Rc<RefCell<Connection>>,
}

impl Browser {
    /// Starts Chromium, installing it first where that is possible.
    pub fn start(graphics: Graphics) -> Result<Self> {
        let program = find_or_install_chromium()?;
        let profile = fresh_profile()?;
        let mut command = Command::new(&program);
        command
            .args([
                "--headless",
                "--remote-debugging-port=0",
                "--no-first-run",
                "--no-default-browser-check",
                "--disable-extensions",
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
                "--disable-background-timer-throttling",
                "--disable-backgrounding-occluded-windows",
                "--disable-renderer-backgrounding",
                "--disable-dev-shm-usage",
                "--hide-scrollbars",
                "--mute-audio",
                "--force-device-scale-factor=1",
                "--lang=en-US",
            ])
            .arg(format!("--user-data-dir={}", profile.display()))
            .args(graphics.switches())
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        if is_root() {
            // Chromium refuses to run its sandbox for root.
            command.arg("--no-sandbox");
        }
        let mut process =
            command.spawn().with_context(|| format!("{} could not be started", program.display()))?;
        match connect(&mut process) {
            Ok(connection) => Ok(Self { process, profile, connection: Rc::new(RefCell::new(connection)) }),
            Err(reason) => {
                let _ = process.kill();
                let _ = process.wait();
                let _ = fs::remove_dir_all(&profile);
                Err(reason)
            }
        }
    }

    /// Opens an empty tab whose page is this large, in CSS pixels.
    pub fn open_tab(&self, width: u32, height: u32) -> Result<Tab> {
        let mut connection = self.connection.borrow_mut();
        let target = connection.call(None, "Target.createTarget", &json!({ "url": "about:blank" }))?;
        let attached = connection.call(
            None,
            "Target.attachToTarget",
            &json!({ "targetId": target["targetId"], "flatten": true }),
        )?;
        let session =
            attached["sessionId"].as_str().context("the browser attached to no session")?.to_owned();
        drop(connection);
        Tab::prepare(Rc::clone(&self.connection), session, width, height)
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let closed = self.connection.borrow_mut().call(None, "Browser.close", &json!({}));
        if closed.is_err() {
            let _ = self.process.kill();
        }
        let _ = self.process.wait();
        let _ = fs::remove_dir_all(&self.profile);
    }
}

/// Waits for Chromium to say where it listens, and connects.
fn connect(process: &mut Child) -> Result<Connection> {
    Connection::open(&wait_for_address(process, "DevTools listening on ")?)
}

/// Waits for a browser to say, after these words, where it listens.
fn wait_for_address(process: &mut Child, words: &str) -> Result<String> {
    let stderr = process.stderr.take().context("no standard error to read")?;
    let (sender, receiver) = mpsc::channel();
    // Reads to the very end: Chromium would stop at a full pipe.
    thread::spawn(move || {
        for line in BufReader::new(stderr).lines().map_while(Result::ok) {
            let _ = sender.send(line);
        }
    });
    let mut said = Vec::new();
    loop {
        match receiver.recv_timeout(START_LIMIT) {
            Ok(line) => {
                if let Some(address) = line.strip_prefix(words) {
                    return Ok(address.trim().to_owned());
                }
                said.push(line);
            }
            Err(_) => bail!("the browser did not start:\n{}", said.join("\n")),
        }
    }
}

fn fresh_profile() -> Result<PathBuf> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let folder = std::env::temp_dir().join(format!(
        "enroute-browser-{}-{}",
        std::process::id(),
        COUNT.fetch_add(1, Ordering::Relaxed)
    ));
    fs::create_dir_all(&folder).with_context(|| format!("creating {}", folder.display()))?;
    Ok(folder)
}
