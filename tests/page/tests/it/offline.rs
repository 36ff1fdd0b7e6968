//! The published page opens without a network once it was loaded.

use anyhow::Result;
use xtask::{dist, server::SiteServer};

use crate::opened::{BROWSER, SITE};

#[test]
fn the_published_page_opens_and_plans_when_its_server_is_gone() -> Result<()> {
    let published = std::env::temp_dir().join(format!("enroute-published-{}", std::process::id()));
    dist::pack(&SITE, &published)?;
    let server = SiteServer::start(&published, 0, false)?;
    let url = server.url().to_owned();
    let browser = BROWSER.get()?;
    let tab = browser.open_context()?.open_tab(800, 500)?;
    tab.go_to(&url)?;
    tab.wait_until_ready()?;
    tab.wait_until("navigator.serviceWorker.ready.then(() => true)")?;

    tab.go_to(&format!("{url}elsewhere"))?;
    assert_eq!(tab.evaluate("typeof enroute")?, "undefined", "another path is its server's to answer");

    drop(server);
    tab.wait_until(&format!("fetch('{url}not-kept').then(() => false, () => true)"))?;
    tab.go_to(&format!("{url}?again#mission=enroute"))?;
    tab.wait_until_ready()?;
    tab.wait_until("enroute.state().status === 'plan'")?;
    std::fs::remove_dir_all(published)?;
    Ok(())
}

#[test]
fn a_new_version_opens_when_the_only_tab_is_loaded_again_and_not_under_another_tab() -> Result<()> {
    let published = std::env::temp_dir().join(format!("enroute-updated-{}", std::process::id()));
    dist::pack(&SITE, &published)?;
    let server = SiteServer::start(&published, 0, false)?;
    // The browser ends with the last test that has it.
    let browser = BROWSER.get()?;
    let context = browser.open_context()?;
    let (tab, beside) = (context.open_tab(800, 500)?, context.open_tab(800, 500)?);
    for tab in [&tab, &beside] {
        tab.go_to(server.url())?;
        tab.wait_until_ready()?;
        tab.wait_until("navigator.serviceWorker.controller !== null")?;
    }
    let version = "document.documentElement.dataset.version";
    let first = tab.evaluate(version)?;
    // The next version differs in its name.
    let name = first.as_str().unwrap_or_default();
    for file in ["index.html", "service-worker.js"] {
        let path = published.join(file);
        std::fs::write(&path, std::fs::read_to_string(&path)?.replace(name, "next"))?;
    }
    tab.wait_until(
        "navigator.serviceWorker.getRegistration()
            .then(async (it) => { await it.update(); return it.waiting !== null; })",
    )?;
    tab.wait_until("enroute.state().toasts.some((it) => it.includes('A new version is available'))")?;
    // Another tab shows the version before: nothing is mixed.
    tab.evaluate("window.isOldPage = true; location.reload()")?;
    tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    tab.wait_until_ready()?;
    assert_eq!(tab.evaluate(version)?, first);
    beside.call("Page.close", &serde_json::json!({}))?;
    tab.evaluate("window.isOldPage = true; location.reload()")?;
    tab.wait_until(&format!("!('isOldPage' in window) && {version} === 'next'"))?;
    tab.wait_until_ready()?;
    drop(server);
    std::fs::remove_dir_all(published)?;
    Ok(())
}
