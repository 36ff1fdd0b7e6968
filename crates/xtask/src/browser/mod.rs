//! A headless Chromium, driven as a user would drive it: keys, clicks, wheel, and looking at what is drawn.

mod axe;
mod context;
mod devtools;
mod display;
mod find;
mod firefox;
mod keys;
mod picture;
mod tab;
mod webkit;
mod webkit_on_disk;

use std::{
    fs,
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::{
        Arc, Mutex, PoisonError, Weak,
        atomic::{AtomicU32, Ordering},
        mpsc,
    },
    thread,
    time::Duration,
};

use anyhow::{Context as _, Result, bail};
use serde_json::json;

pub use axe::axe_script;
pub use context::Context;
pub use display::Hands;
pub use find::{find_or_install_chromium, is_root};
pub use firefox::Firefox;
pub use keys::{Key, Modifiers};
pub use picture::Picture;
pub use tab::{Tab, Widget};
pub use webkit::{WebKit, WebKitPrograms};
pub use webkit_on_disk::WebKitOnDisk;

use devtools::Connection;

use crate::process::lead_group;

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

/// The folder where a browser stores things; removed with the last that uses it.
pub struct Profile(PathBuf);

impl Profile {
    /// An empty folder among temporary files.
    pub fn create() -> Result<Arc<Self>> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let folder = std::env::temp_dir().join(format!(
            "enroute-browser-{}-{}",
            std::process::id(),
            COUNT.fetch_add(1, Ordering::Relaxed)
        ));
        fs::create_dir_all(&folder).with_context(|| format!("creating {}", folder.display()))?;
        Ok(Arc::new(Self(folder)))
    }

    fn folder(&self) -> &Path {
        &self.0
    }
}

impl Drop for Profile {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A running Chromium; ends when it is dropped.
pub struct Browser {
    process: Child,
    // Goes after the process does.
    _profile: Arc<Profile>,
    address: String,
    pixel_ratio: f64,
}

impl Browser {
    /// Starts Chromium, installing it first where that is possible. `pixel_ratio` is the number of pixels for each CSS
    /// pixel along each side, `devicePixelRatio` to pages.
    pub fn start(graphics: Graphics, pixel_ratio: f64) -> Result<Self> {
        Self::launch(graphics, pixel_ratio, Profile::create()?, |_| ())
    }

    /// Starts Chromium on what an earlier one stored, as the leader of a group of processes that can be killed.
    pub fn start_on(profile: &Arc<Profile>, graphics: Graphics, pixel_ratio: f64) -> Result<Self> {
        Self::launch(graphics, pixel_ratio, Arc::clone(profile), lead_group)
    }

    fn launch(
        graphics: Graphics,
        pixel_ratio: f64,
        profile: Arc<Profile>,
        prepare: impl FnOnce(&mut Command),
    ) -> Result<Self> {
        let program = find_or_install_chromium()?;
        let mut command = Command::new(&program);
        prepare(&mut command);
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
                "--lang=en-US",
            ])
            .arg(format!("--force-device-scale-factor={pixel_ratio}"))
            .arg(format!("--user-data-dir={}", profile.folder().display()))
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
        match wait_for_address(&mut process, "DevTools listening on ") {
            Ok(address) => Ok(Self { process, _profile: profile, address, pixel_ratio }),
            Err(reason) => {
                let _ = process.kill();
                let _ = process.wait();
                Err(reason)
            }
        }
    }

    /// Opens a context: nothing that another one stored, cached, or was allowed is known in it.
    pub fn open_context(&self) -> Result<Context> {
        Context::open(&self.address, self.pixel_ratio)
    }

    /// Opens the context whose storage lasts: a browser that is started later on the same profile has it.
    pub fn open_lasting_context(&self) -> Result<Context> {
        Context::lasting(&self.address, self.pixel_ratio)
    }

    /// The process that leads all others, if the browser was started on a profile.
    pub fn leader(&self) -> u32 {
        self.process.id()
    }

    fn is_answering(&self) -> bool {
        Connection::open(&self.address).is_ok()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let closed = Connection::open(&self.address)
            .and_then(|mut connection| connection.call(None, "Browser.close", &json!({})));
        if closed.is_err() {
            let _ = self.process.kill();
        }
        let _ = self.process.wait();
    }
}

/// A browser for all who want one at the same time: the first starts it, and it ends with the last. After a crash the next
/// one starts another.
pub struct SharedBrowser {
    graphics: Graphics,
    pixel_ratio: f64,
    running: Mutex<Weak<Browser>>,
}

impl SharedBrowser {
    /// None runs yet.
    pub const fn new(graphics: Graphics, pixel_ratio: f64) -> Self {
        Self { graphics, pixel_ratio, running: Mutex::new(Weak::new()) }
    }

    /// The browser that runs.
    pub fn get(&self) -> Result<Arc<Browser>> {
        let mut running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(browser) = running.upgrade().filter(|browser| browser.is_answering()) {
            return Ok(browser);
        }
        let browser = Arc::new(Browser::start(self.graphics, self.pixel_ratio)?);
        *running = Arc::downgrade(&browser);
        Ok(browser)
    }
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
