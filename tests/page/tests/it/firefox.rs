//! The page in Firefox, where there is one: it starts, compiles, plans, draws, and is used by keyboard.

use anyhow::Result;
use xtask::{browser::Firefox, server::SiteServer};

use crate::opened::SITE;

/// F6, as `WebDriver` spells it.
const F6: &str = "\u{e036}";

#[test]
#[expect(clippy::print_stdout, reason = "what was not tried is said")]
fn firefox_starts_plans_draws_and_takes_keys() -> Result<()> {
    let Some(program) = Firefox::find() else {
        println!("nothing was tried in Firefox: there is none (on Debian: apt-get install firefox-esr xvfb)");
        return Ok(());
    };
    let server = SiteServer::start(&SITE, 0, false)?;
    let mut firefox = Firefox::start(&program, 1280, 800)?;
    firefox.go_to(&format!("{}#mission=enroute", server.url()))?;
    firefox.wait_until("'enroute' in window")?;
    let outcome = firefox.evaluate("enroute.ready.then(() => 'ready', (reason) => String(reason))")?;
    if outcome.as_str().is_some_and(|reason| reason.contains("webgl2 not available")) {
        println!("Firefox has neither WebGPU nor WebGL2 on this machine; nothing more was tried: {outcome}");
        return Ok(());
    }
    assert_eq!(outcome, "ready");
    firefox.wait_until("enroute.state().status === 'plan'")?;
    assert_eq!(firefox.evaluate("enroute.state().verdict.valid")?, true);
    firefox.wait_until("document.getElementById('announcements').textContent.includes('verified')")?;
    let picture = firefox.screenshot()?;
    assert!(picture.colours() > 20, "nothing is drawn");
    // A click into the text, letters, and on to the next panel by a key.
    let text = firefox.evaluate("enroute.widgets('textbox', 'Mission text')[0]")?;
    let middle = |from: &str, size: &str| -> f64 {
        text[from].as_f64().unwrap_or_default() + text[size].as_f64().unwrap_or_default() / 2.0
    };
    firefox.click(middle("x", "width"), middle("y", "height"))?;
    firefox.wait_until("document.querySelector('[aria-activedescendant]')")?;
    firefox.evaluate("enroute.dispatch('edit.select', { start: 0 })")?;
    firefox.press("// ")?;
    firefox.wait_until("enroute.source().startsWith('// ')")?;
    firefox.press(F6)?;
    firefox.wait_until("enroute.state().activePanel !== 'editor'")
}
