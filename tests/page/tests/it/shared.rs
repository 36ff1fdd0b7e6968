//! The browser that tests share: what one context keeps no other one finds, and a crash is told and followed by another
//! browser.

use anyhow::Result;
use serde_json::json;
use xtask::{
    browser::{Graphics, SharedBrowser},
    server::SiteServer,
};

use crate::opened::{BROWSER, PIXEL_RATIO, SITE};

#[test]
fn what_one_context_keeps_no_other_one_finds() -> Result<()> {
    let server = SiteServer::start(&SITE, 0, false)?;
    let browser = BROWSER.get()?;
    let address = format!("{}web/icon.svg", server.url());
    let (first, second) = (browser.open_context()?, browser.open_context()?);
    let (here, beside, elsewhere) =
        (first.open_tab(200, 200)?, first.open_tab(200, 200)?, second.open_tab(200, 200)?);
    for tab in [&here, &beside, &elsewhere] {
        tab.go_to(&address)?;
    }
    here.evaluate("localStorage.setItem('kept', 'here'); document.cookie = 'kept=here'")?;
    let found = "[localStorage.getItem('kept'), document.cookie]";
    assert_eq!(beside.evaluate(found)?, json!(["here", "kept=here"]));
    assert_eq!(elsewhere.evaluate(found)?, json!([null, ""]));
    Ok(())
}

#[test]
fn a_browser_that_crashed_is_told_and_followed_by_another_one() -> Result<()> {
    let shared = SharedBrowser::new(Graphics::Nothing, PIXEL_RATIO);
    let crashed = shared.get()?;
    let tab = crashed.open_context()?.open_tab(200, 200)?;
    let refusal = tab.call("Browser.crash", &json!({})).expect_err("nobody is left to answer");
    assert!(format!("{refusal:#}").contains("the browser has ended"), "{refusal:#}");
    assert!(tab.evaluate("1 + 1").is_err());
    let another = shared.get()?;
    let next = another.open_context()?.open_tab(200, 200)?;
    assert_eq!(next.evaluate("1 + 1")?, 2);
    Ok(())
}
