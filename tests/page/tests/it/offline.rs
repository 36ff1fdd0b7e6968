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
