//! The page, opened and ready.

use std::{
    env, fs,
    path::{Path, PathBuf},
    sync::{
        Arc, LazyLock,
        atomic::{AtomicU32, Ordering},
    },
};

use anyhow::{Context as _, Result, ensure};
use serde_json::{Value, json};
use xtask::{
    browser::{Browser, Context, Graphics, Key, Modifiers, Picture, SharedBrowser, Tab},
    server::SiteServer,
    site::{self, Flavour},
};

/// The site's folder; built once per run, which is quick when nothing has changed.
pub(crate) static SITE: LazyLock<PathBuf> =
    LazyLock::new(|| site::build(Flavour::Development).expect("the page can be built"));

/// The browser of all tests that draw with WebGL2, each in a context of its own.
pub(crate) static BROWSER: SharedBrowser = SharedBrowser::new(Graphics::WebGl2, PIXEL_RATIO);

/// The size of the page in CSS pixels.
const WIDTH: u32 = 1280;
const HEIGHT: u32 = 800;

/// Pixels for each CSS pixel along each side. The processor draws every one of them, which is most of what these tests
/// take: a quarter of them takes a third of the time.
pub(crate) const PIXEL_RATIO: f64 = 0.5;

/// The page in a context of its own.
pub(crate) struct Opened {
    pub(crate) tab: Tab,
    copy: Option<PathBuf>,
    server: SiteServer,
    context: Context,
    // Goes after the context does.
    _browser: Arc<Browser>,
}

impl Opened {
    /// Opens the page with this text after `#`, drawn by WebGL2, and waits until it is ready.
    pub(crate) fn with_fragment(fragment: &str) -> Result<Self> {
        let opened = Self::without_waiting(Graphics::WebGl2, fragment)?;
        opened.tab.wait_until_ready()?;
        Ok(opened)
    }

    /// Opens the page on the mission `enroute`, planned.
    pub(crate) fn planned() -> Result<Self> {
        let opened = Self::with_fragment("mission=enroute")?;
        opened.settle()?;
        let status = opened.state()?["status"].clone();
        ensure!(status == "plan", "the mission enroute is {status}");
        Ok(opened)
    }

    /// Goes to the page and leaves it at that.
    pub(crate) fn without_waiting(graphics: Graphics, fragment: &str) -> Result<Self> {
        Self::from_site(&SITE, graphics, fragment)
    }

    /// Opens a copy of the page in which one file says something else, planned or not.
    pub(crate) fn altered(file: &str, alter: impl FnOnce(String) -> String) -> Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let copy = std::env::temp_dir().join(format!("enroute-altered-{}-{number}", std::process::id()));
        copy_folder(&SITE, &copy)?;
        let text = fs::read_to_string(copy.join(file))?;
        let altered = alter(text.clone());
        ensure!(altered != text, "{file} was not altered");
        fs::write(copy.join(file), altered)?;
        let mut opened = Self::from_site(&copy, Graphics::WebGl2, "mission=enroute")?;
        opened.copy = Some(copy);
        opened.tab.wait_until_ready()?;
        Ok(opened)
    }

    /// Goes to the page after a script has changed what its browser offers.
    pub(crate) fn after(script: &str, graphics: Graphics) -> Result<Self> {
        let opened = Self::from_site(&SITE, graphics, "mission=enroute")?;
        opened.tab.call("Page.addScriptToEvaluateOnNewDocument", &json!({ "source": script }))?;
        opened.tab.go_to("about:blank")?;
        opened.tab.go_to(&format!("{}#mission=enroute", opened.server.url()))?;
        Ok(opened)
    }

    fn from_site(site: &Path, graphics: Graphics, fragment: &str) -> Result<Self> {
        let server = SiteServer::start(site, 0, false)?;
        let browser = if graphics == Graphics::WebGl2 {
            BROWSER.get()?
        } else {
            Arc::new(Browser::start(graphics, PIXEL_RATIO)?)
        };
        let context = browser.open_context()?;
        let tab = context.open_tab(WIDTH, HEIGHT)?;
        tab.go_to(&format!("{}#{fragment}", server.url()))?;
        Ok(Self { tab, copy: None, server, context, _browser: browser })
    }

    /// Another tab of the same context, on the page with this text after `#`.
    pub(crate) fn open_beside(&self, fragment: &str) -> Result<Tab> {
        let tab = self.context.open_tab(WIDTH, HEIGHT)?;
        tab.go_to(&format!("{}#{fragment}", self.server.url()))?;
        Ok(tab)
    }

    /// The state as JSON.
    pub(crate) fn state(&self) -> Result<Value> {
        self.tab.evaluate("enroute.state()")
    }

    /// Waits until a condition on the state, called `state`, is true.
    pub(crate) fn wait_for(&self, condition: &str) -> Result<()> {
        self.tab.wait_until(&format!("((state) => {condition})(enroute.state())"))?;
        Ok(())
    }

    /// Waits until the core has answered the present text in full and the answer is drawn.
    pub(crate) fn settle(&self) -> Result<()> {
        self.wait_for("state.status !== 'working' && state.answeredRevision === state.revision")?;
        self.tab.next_frame()
    }

    /// Clicks into the editor and puts the caret behind the first occurrence of a text.
    pub(crate) fn place_caret_after(&self, text: &str) -> Result<()> {
        let source = self.tab.evaluate("enroute.source()")?;
        let source = source.as_str().context("the source is a text")?;
        let end = source.find(text).with_context(|| format!("there is no `{text}`"))? + text.len();
        self.tab.click_widget("textbox", "Mission text")?;
        self.tab.evaluate(&format!("enroute.dispatch('edit.select', {{ start: {end} }})"))?;
        self.wait_for(&format!("state.caret.head === {end}"))
    }

    /// Types a text and waits for the frame that has it.
    pub(crate) fn type_text(&self, text: &str) -> Result<()> {
        self.tab.type_text(text)?;
        self.tab.next_frame()
    }

    /// Deletes this many characters before the caret and types a text.
    pub(crate) fn retype(&self, deleted: usize, typed: &str) -> Result<()> {
        for _ in 0..deleted {
            self.tab.press(Key::Backspace, Modifiers::NONE)?;
        }
        self.type_text(typed)
    }

    /// Keeps a picture of the page in the folder that `ENROUTE_RECORDING` names, if it names one.
    pub(crate) fn keep_picture(&self, name: &str) -> Result<()> {
        self.tab.next_frame()?;
        let Some(folder) = env::var_os("ENROUTE_RECORDING").map(PathBuf::from) else { return Ok(()) };
        fs::create_dir_all(&folder)?;
        fs::write(folder.join(format!("{name}.png")), self.tab.screenshot_png()?)?;
        Ok(())
    }

    /// The page as pixels, once what was done is drawn.
    pub(crate) fn look(&self) -> Result<Picture> {
        self.tab.next_frame()?;
        self.tab.screenshot()
    }
}

impl Drop for Opened {
    fn drop(&mut self) {
        if let Some(copy) = &self.copy {
            // What is left behind lies among temporary files.
            let _ = fs::remove_dir_all(copy);
        }
    }
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}
