//! What the page says when something outside it fails.

use anyhow::Result;
use xtask::browser::Graphics;

use crate::opened::Opened;

#[test]
fn without_graphics_the_page_explains_itself() -> Result<()> {
    let page = Opened::without_waiting(Graphics::Nothing, "")?;
    page.tab.wait_until("document.querySelector('#loading[role=alert]')?.innerText.includes('WebGL2')")?;
    let code = page.tab.evaluate("enroute.ready.then(() => 'ready', (error) => error.code)")?;
    assert_eq!(code, "no-graphics");
    Ok(())
}

#[test]
fn a_planning_core_that_cannot_be_loaded_leaves_the_editor_usable() -> Result<()> {
    let page = Opened::without_waiting(Graphics::WebGl2, "")?;
    page.tab.call("Network.enable", &serde_json::json!({}))?;
    page.tab.call("Network.setBlockedURLs", &serde_json::json!({ "urls": ["*worker_bg.wasm"] }))?;
    page.tab.go_to(&format!("{}?blocked#mission=enroute", page.server.url()))?;
    page.tab.wait_until_ready()?;
    page.wait_for("state.toasts.length > 0")?;
    page.tab.evaluate("enroute.setSource('A()[l,u] = { Work()[1,2] }')")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, "A()[l,u] = { Work()[1,2] }");
    Ok(())
}
