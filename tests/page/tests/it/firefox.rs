//! The page in Firefox and in WebKit, where they are: it starts, plans, draws, is edited, loaded again, and opens without a
//! network; in Firefox also with what its users block.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;
use xtask::{
    browser::{Firefox, Hands, WebKit},
    dist,
    process::find_program,
    server::SiteServer,
};

use crate::opened::SITE;
use crate::same::every_example_is_the_same;

/// F6, as `WebDriver` spells it.
const F6: &str = "\u{e036}";

/// A browser that is driven.
trait Driven {
    fn open(&mut self, url: &str) -> Result<()>;
    fn ask(&mut self, expression: &str) -> Result<Value>;
    fn press(&mut self, keys: &str) -> Result<()>;
    fn click(&mut self, button: u32, x: f64, y: f64) -> Result<()>;

    /// Waits until a JavaScript expression is true; one that throws is not.
    fn wait_until(&mut self, expression: &str) -> Result<()> {
        let came_true = self.ask(&format!(
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
        let state = self
            .ask("window.enroute ? JSON.stringify(enroute.state()).slice(0, 1000) : document.body.innerText");
        ensure!(came_true == true, "waiting for `{expression}`: it never came true; {state:?}");
        Ok(())
    }

    /// Opens the page and waits until it can be driven. Answers why it cannot be drawn on this machine, if so.
    fn open_page(&mut self, url: &str) -> Result<Option<String>> {
        self.open("about:blank")?;
        self.open(url)?;
        self.wait_until("'enroute' in window")?;
        let outcome = self.ask("enroute.ready.then(() => 'ready', (reason) => String(reason))")?;
        let outcome = outcome.as_str().unwrap_or_default().to_owned();
        if outcome.contains("webgl2 not available") {
            return Ok(Some(outcome));
        }
        ensure!(outcome == "ready", "{outcome}");
        Ok(None)
    }

    /// Clicks with a button into the middle of the text.
    fn click_text(&mut self, button: u32) -> Result<()> {
        let text = self.ask("enroute.widgets('textbox', 'Mission text')[0]")?;
        let middle = |from: &str, size: &str| -> f64 {
            text[from].as_f64().unwrap_or_default() + text[size].as_f64().unwrap_or_default() / 2.0
        };
        self.click(button, middle("x", "width"), middle("y", "height"))
    }

    /// Clicks into the text and puts the caret at its start.
    fn begin_typing(&mut self) -> Result<()> {
        self.click_text(0)?;
        self.wait_until("document.querySelector('[aria-activedescendant]')")?;
        self.ask("enroute.dispatch('edit.select', { start: 0 })")?;
        Ok(())
    }
}

impl Driven for Firefox {
    fn open(&mut self, url: &str) -> Result<()> {
        self.go_to(url)
    }

    fn ask(&mut self, expression: &str) -> Result<Value> {
        self.evaluate(expression)
    }

    fn press(&mut self, keys: &str) -> Result<()> {
        Self::press(self, keys)
    }

    fn click(&mut self, button: u32, x: f64, y: f64) -> Result<()> {
        Self::click(self, button, x, y)
    }
}

impl Driven for WebKit {
    fn open(&mut self, url: &str) -> Result<()> {
        self.go_to(url)
    }

    fn ask(&mut self, expression: &str) -> Result<Value> {
        self.evaluate(expression)
    }

    fn press(&mut self, keys: &str) -> Result<()> {
        Self::press(self, keys)
    }

    fn click(&mut self, button: u32, x: f64, y: f64) -> Result<()> {
        Self::click(self, button, x, y)
    }
}

#[expect(clippy::print_stdout, reason = "what was not tried is said")]
fn not_tried(what: &str) {
    println!("not tried: {what}");
}

/// Firefox, or a word that there is none.
fn firefox(settings: &str) -> Result<Option<Firefox>> {
    let Some(program) = Firefox::find() else {
        not_tried("Firefox is not installed (on Debian: apt-get install firefox-esr xvfb)");
        return Ok(None);
    };
    Firefox::start(&program, 1280, 800, settings).map(Some)
}

/// Starts, edits, undoes, loads again, and opens without a network. `name` tells the folders of tests apart.
fn use_page(browser: &mut dyn Driven, name: &str) -> Result<()> {
    let published = std::env::temp_dir().join(format!("enroute-{name}-{}", std::process::id()));
    dist::pack(&SITE, &published)?;
    let outcome = use_published(browser, &published);
    fs::remove_dir_all(published)?;
    outcome
}

/// Has the browser lose what it draws with.
const LOSE_CONTEXT: &str = "(() => {
    window.textBefore = enroute.source();
    window.lostCanvas = document.getElementById('canvas');
    lostCanvas.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext();
})()";

/// Opens the mission again from a file that begins with a comment, and saves it.
fn open_and_save(browser: &mut dyn Driven) -> Result<()> {
    // No dialog of the browser can be driven: what it would choose is chosen, and what it would be given is taken.
    browser.ask(
        "(() => {
            const text = '// opened\\n' + enroute.source();
            HTMLInputElement.prototype.click = function () {
                const files = new DataTransfer();
                files.items.add(new File([text], 'opened.rmpl'));
                this.files = files.files;
                this.dispatchEvent(new Event('change'));
            };
            HTMLAnchorElement.prototype.click = function () {
                window.savedAs = this.download;
            };
            URL.createObjectURL = (blob) => {
                blob.text().then((text) => (window.saved = text));
                return 'blob:none';
            };
        })()",
    )?;
    browser.ask("enroute.dispatch('file.open')")?;
    browser.wait_until("enroute.source().startsWith('// opened')")?;
    browser.wait_until("enroute.state().status === 'plan'")?;
    browser.ask("enroute.dispatch('file.save')")?;
    browser.wait_until("savedAs === 'opened.rmpl' && saved === enroute.source()")
}

fn use_published(browser: &mut dyn Driven, published: &Path) -> Result<()> {
    let server = SiteServer::start(published, 0, false)?;
    let url = server.url().to_owned();
    if let Some(reason) = browser.open_page(&url)? {
        not_tried(&format!("this browser cannot draw on this machine: {reason}"));
        return Ok(());
    }
    browser.wait_until("enroute.state().status === 'plan'")?;
    assert_eq!(browser.ask("enroute.state().verdict.valid")?, true);
    browser.wait_until("document.getElementById('announcements').textContent.includes('verified')")?;
    open_and_save(browser)?;
    browser.begin_typing()?;
    browser.press("// once")?;
    browser.wait_until("enroute.source().startsWith('// once')")?;
    browser.press(F6)?;
    browser.wait_until("enroute.state().activePanel !== 'editor'")?;
    // A key is heard also after a screen reader has taken the focus from everything.
    browser.ask("window.panelBefore = enroute.state().activePanel, document.activeElement.blur()")?;
    browser.press(F6)?;
    browser.wait_until("enroute.state().activePanel !== panelBefore")?;
    browser.ask("enroute.dispatch('edit.undo')")?;
    browser.wait_until("!enroute.source().startsWith('// once')")?;
    browser.ask("enroute.dispatch('edit.redo')")?;
    browser.wait_until("enroute.source().startsWith('// once')")?;
    // A lost context is followed by another canvas, with everything as it was.
    browser.ask(LOSE_CONTEXT)?;
    browser.wait_until("document.getElementById('canvas') !== lostCanvas")?;
    browser.wait_until(
        "!document.querySelector('#loading[role=alert]') && enroute.source().startsWith('// once')",
    )?;
    browser.begin_typing()?;
    browser.press("// again ")?;
    browser.wait_until("enroute.source().startsWith('// again // once')")?;
    browser.ask("enroute.dispatch('edit.undo')")?;
    browser.wait_until("!enroute.source().startsWith('// again // once')")?;
    browser.ask("enroute.setSource(textBefore)")?;
    browser.wait_until("enroute.state().library.keeping === 'kept'")?;
    // The second visit is answered by the service worker, which isolates the page from others.
    browser.wait_until("navigator.serviceWorker.ready.then(() => true)")?;
    browser.open_page(&url)?;
    assert_eq!(browser.ask("crossOriginIsolated")?, true);
    browser.wait_until("enroute.source().startsWith('// once')")?;
    browser.wait_until("enroute.state().status === 'plan'")?;
    // A page that is left while it writes keeps no other one from reading.
    let text = browser.ask("enroute.source()")?;
    for round in 1..=4 {
        browser.ask(&format!("enroute.setSource('// once {round}')"))?;
        browser.open_page(&url)?;
        browser.wait_until(&format!("enroute.source() === '// once {round}'"))?;
    }
    browser.ask(&format!("enroute.setSource({text})"))?;
    drop(server);
    browser.open_page(&url)?;
    browser.wait_until("enroute.source().startsWith('// once')")?;
    browser.wait_until("enroute.state().status === 'plan'")
}

#[test]
fn firefox_starts_plans_takes_keys_and_opens_again_without_a_network() -> Result<()> {
    let Some(mut firefox) = firefox("")? else { return Ok(()) };
    use_page(&mut firefox, "firefox")?;
    assert!(firefox.screenshot()?.colors() > 20, "nothing is drawn");
    firefox.click_text(2)?;
    Driven::wait_until(&mut firefox, "enroute.widgets('menuitem', 'Go to definition').length > 0")
}

#[test]
fn webkit_starts_plans_takes_keys_and_opens_again_without_a_network() -> Result<()> {
    let Some(programs) = WebKit::find() else {
        not_tried("WebKit is not installed (on Debian: apt-get install webkit2gtk-driver xvfb)");
        return Ok(());
    };
    use_page(&mut WebKit::start(&programs)?, "webkit")
}

#[test]
fn every_example_leads_to_the_same_plan_paths_and_content_in_firefox_and_webkit() -> Result<()> {
    let server = SiteServer::start(&SITE, 0, false)?;
    let mut browsers: Vec<Box<dyn Driven>> = Vec::new();
    if let Some(firefox) = firefox("")? {
        browsers.push(Box::new(firefox));
    }
    match WebKit::find() {
        Some(programs) => browsers.push(Box::new(WebKit::start(&programs)?)),
        None => not_tried("WebKit is not installed (on Debian: apt-get install webkit2gtk-driver xvfb)"),
    }
    for browser in &mut browsers {
        if let Some(reason) = browser.open_page(server.url())? {
            not_tried(&reason);
            continue;
        }
        every_example_is_the_same(|expression| browser.ask(expression))?;
    }
    Ok(())
}

/// A file among temporary ones, gone when it is dropped.
struct Temporary(PathBuf);

impl Temporary {
    fn write(ending: &str, bytes: &[u8]) -> Result<Self> {
        let path = std::env::temp_dir().join(format!("enroute-printed-{}{ending}", std::process::id()));
        fs::write(&path, bytes)?;
        Ok(Self(path))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // What is left behind lies among temporary files.
        let _ = fs::remove_file(&self.0);
    }
}

#[test]
fn firefox_prints_reports_whose_pages_say_their_number_and_their_content() -> Result<()> {
    let Some(mut firefox) = firefox("")? else { return Ok(()) };
    let server = SiteServer::start(&SITE, 0, false)?;
    if let Some(reason) = firefox.open_page(&format!("{}#mission=enroute", server.url()))? {
        not_tried(&reason);
        return Ok(());
    }
    Driven::wait_until(&mut firefox, "enroute.state().status === 'plan'")?;
    let text = firefox.evaluate(
        "new Promise((done) => {
            URL.createObjectURL = (blob) => { blob.text().then(done); return 'blob:none'; };
            enroute.dispatch('file.report');
        })",
    )?;
    let report = Temporary::write(".html", text.as_str().context("a report")?.as_bytes())?;
    firefox.go_to(&format!("file://{}", report.0.display()))?;
    let hash = firefox.evaluate("document.querySelector('.hash').textContent")?;
    let hash = hash.as_str().context("a hash")?.to_owned();
    let printed = firefox.print()?;
    let Some(reader) = find_program(&["pdftotext"]) else {
        not_tried("there is no pdftotext (on Debian: apt-get install poppler-utils)");
        return Ok(());
    };
    let printed = Temporary::write(".pdf", &printed)?;
    let text = Command::new(reader).arg("-layout").arg(&printed.0).arg("-").output()?.stdout;
    let text = String::from_utf8_lossy(&text);
    let pages: Vec<&str> = text.trim_end_matches('\u{c}').split('\u{c}').collect();
    assert!(pages.len() >= 3, "{} pages", pages.len());
    for (page, number) in pages.iter().zip(1..) {
        assert!(page.contains(&format!("Content {hash}")), "page {number} does not say its content: {page}");
        // The last one says that the report ends there.
        let says = page.contains(&format!("Page {number}")) || number == pages.len();
        assert!(says, "page {number} does not say its number: {page}");
    }
    Ok(())
}

#[test]
fn firefox_that_blocks_cookies_and_site_data_starts_and_says_what_is_not_kept() -> Result<()> {
    let blocks = "user_pref(\"network.cookie.cookieBehavior\", 2);\n";
    let Some(mut firefox) = firefox(blocks)? else { return Ok(()) };
    let server = SiteServer::start(&SITE, 0, false)?;
    if let Some(reason) = firefox.open_page(server.url())? {
        not_tried(&reason);
        return Ok(());
    }
    let says = "['nothing', 'latest-only'].includes(enroute.state().library.keeping)";
    Driven::wait_until(&mut firefox, says)?;
    Driven::wait_until(&mut firefox, "enroute.widgets('button', 'saved').length > 0")
}

#[test]
fn a_private_window_of_firefox_says_that_missions_are_not_kept() -> Result<()> {
    let settings = "user_pref(\"browser.privatebrowsing.autostart\", true);\n";
    let Some(mut firefox) = firefox(settings)? else { return Ok(()) };
    let server = SiteServer::start(&SITE, 0, false)?;
    if let Some(reason) = firefox.open_page(server.url())? {
        not_tried(&reason);
        return Ok(());
    }
    firefox.begin_typing()?;
    Driven::press(&mut firefox, "// once")?;
    Driven::wait_until(&mut firefox, "enroute.state().library.keeping === 'until-closed'")?;
    Driven::wait_until(&mut firefox, "enroute.widgets('button', 'Private window').length > 0")
}

#[test]
fn firefox_that_resists_fingerprinting_draws() -> Result<()> {
    let Some(mut firefox) = firefox("user_pref(\"privacy.resistFingerprinting\", true);\n")? else {
        return Ok(());
    };
    let server = SiteServer::start(&SITE, 0, false)?;
    if let Some(reason) = firefox.open_page(server.url())? {
        not_tried(&reason);
        return Ok(());
    }
    assert_eq!(firefox.evaluate("enroute.state().renderer")?, "webgl2");
    Ok(())
}

/// Firefox with hands for its display, or a word that something is missing.
fn firefox_with_hands() -> Result<Option<(Firefox, Hands)>> {
    let Some(firefox) = firefox("")? else { return Ok(None) };
    let hands = firefox.hands()?;
    if hands.is_none() {
        not_tried("xdotool or Xvfb is not installed (on Debian: apt-get install xdotool xvfb)");
    }
    Ok(hands.map(|hands| (firefox, hands)))
}

/// Moves the pointer of the display to a place of the page.
fn point_at(firefox: &mut Firefox, hands: &mut Hands, [x, y]: [f64; 2]) -> Result<()> {
    let corner = firefox.evaluate("[mozInnerScreenX, mozInnerScreenY]")?;
    let on_screen = |at: f64, index: usize| at + corner[index].as_f64().unwrap_or_default();
    hands.act(&format!("mousemove {:.0} {:.0}", on_screen(x, 0), on_screen(y, 1)))
}

/// A place in the text of the mission, so many pixels from its corner.
fn in_text(firefox: &mut Firefox, [x, y]: [f64; 2]) -> Result<[f64; 2]> {
    let text = firefox.evaluate("enroute.widgets('textbox', 'Mission text')[0]")?;
    let from = |name: &str| text[name].as_f64().context("the text is nowhere");
    Ok([from("x")? + x, from("y")? + y])
}

/// Waits until what moves has come to rest.
fn settle(firefox: &mut Firefox) -> Result<()> {
    let frames = "new Promise((done) => {
        let left = 20;
        const next = () => (left-- > 0 ? requestAnimationFrame(next) : done(0));
        next();
    })";
    firefox.evaluate(frames).map(|_| ())
}

/// What Chromium scrolls for one notch of the wheel, in CSS pixels.
const NOTCH: f64 = 120.0;

#[test]
fn a_notch_of_the_wheel_scrolls_firefox_as_far_as_chromium() -> Result<()> {
    const LINE: &str = "// line\n";
    let Some((mut firefox, mut hands)) = firefox_with_hands()? else { return Ok(()) };
    let server = SiteServer::start(&SITE, 0, false)?;
    if let Some(reason) = firefox.open_page(server.url())? {
        not_tried(&reason);
        return Ok(());
    }
    firefox.evaluate(&format!("enroute.setSource({}.repeat(400))", Value::from(LINE)))?;
    firefox.begin_typing()?;
    let row_at = |firefox: &mut Firefox, y: f64| -> Result<f64> {
        let [x, y] = in_text(firefox, [80.0, y])?;
        firefox.click(0, x, y)?;
        settle(firefox)?;
        let caret = firefox.evaluate("enroute.state().caret.head")?.as_f64().context("a caret")?;
        Ok((caret / LINE.len() as f64).floor())
    };
    let first = row_at(&mut firefox, 60.0)?;
    let row_height = 100.0 / (row_at(&mut firefox, 160.0)? - first);
    firefox.evaluate("addEventListener('wheel', ({ deltaMode }) => (window.notchIn = deltaMode), true)")?;
    let place = in_text(&mut firefox, [80.0, 60.0])?;
    point_at(&mut firefox, &mut hands, place)?;
    hands.act("click 5")?;
    Driven::wait_until(&mut firefox, "'notchIn' in window")?;
    assert_eq!(firefox.evaluate("notchIn")?, 1, "a wheel of Firefox turns by lines");
    settle(&mut firefox)?;
    let scrolled = (row_at(&mut firefox, 60.0)? - first) * row_height;
    assert!((scrolled - NOTCH).abs() <= row_height, "{scrolled} pixels, rows of {row_height}");
    Ok(())
}

#[test]
fn alt_alone_takes_the_keyboard_from_no_text_in_firefox() -> Result<()> {
    let Some((mut firefox, mut hands)) = firefox_with_hands()? else { return Ok(()) };
    let server = SiteServer::start(&SITE, 0, false)?;
    // Presses Alt, then a letter.
    let mut press_both = |firefox: &mut Firefox, place: [f64; 2]| -> Result<()> {
        point_at(firefox, &mut hands, place)?;
        hands.act("click 1")?;
        settle(firefox)?;
        hands.act("key Alt_L")?;
        settle(firefox)?;
        hands.act("key q")?;
        settle(firefox)
    };
    firefox.go_to("data:text/html,<textarea style='position:fixed;inset:0;width:100vw;height:100vh'>")?;
    press_both(&mut firefox, [200.0, 200.0])?;
    if firefox.evaluate("document.querySelector('textarea').value")? != "" {
        not_tried("this Firefox has no menu bar that Alt goes to");
        return Ok(());
    }
    if let Some(reason) = firefox.open_page(server.url())? {
        not_tried(&reason);
        return Ok(());
    }
    firefox.evaluate("enroute.setSource('// line')")?;
    firefox.begin_typing()?;
    let place = in_text(&mut firefox, [120.0, 60.0])?;
    press_both(&mut firefox, place)?;
    Driven::wait_until(&mut firefox, "enroute.source().includes('q')")
}
