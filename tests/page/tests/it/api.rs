//! `window.enroute` as host pages use it.

use anyhow::Result;
use serde_json::json;

use crate::opened::Opened;

#[test]
fn the_page_opens_on_a_planned_mission_without_complaints() -> Result<()> {
    let page = Opened::planned()?;
    let state = page.state()?;
    assert!(state["revision"].as_u64() > Some(0), "{state}");
    let diagnostics = state["diagnostics"].as_array().cloned().unwrap_or_default();
    assert!(diagnostics.iter().all(|it| it["severity"] != "error"), "{diagnostics:?}");
    assert_eq!(state["renderer"], "webgl2");
    assert!(state["tpn"]["nodes"].as_u64() > Some(10), "{}", state["tpn"]);
    assert_eq!(state["plan"]["choices"], json!({ "D1": 0 }));
    assert_eq!(page.tab.complaints(), Vec::<String>::new());
    Ok(())
}

#[test]
fn setting_the_source_is_one_undoable_edit_that_subscribers_hear_of() -> Result<()> {
    let page = Opened::planned()?;
    let before = page.tab.evaluate("enroute.source()")?;
    page.tab.evaluate(
        "window.heard = []; window.stop = enroute.subscribe((state) => heard.push(state.revision));
         enroute.setSource('A()[l,u] = { Work()[1,2] }')",
    )?;
    page.settle()?;
    let revision = page.state()?["revision"].clone();
    page.tab.wait_until(&format!("heard.includes({revision})"))?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, "A()[l,u] = { Work()[1,2] }");
    page.tab.evaluate("stop(); enroute.dispatch('edit.undo')")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, before);
    Ok(())
}

#[test]
fn refusals_are_errors_with_a_code() -> Result<()> {
    let page = Opened::planned()?;
    let code_of = |call: &str| {
        page.tab
            .evaluate(&format!("(() => {{ try {{ {call}; }} catch (error) {{ return error.code; }} }})()"))
    };
    assert_eq!(code_of("enroute.open('no such mission')")?, "unknown-mission");
    assert_eq!(code_of("enroute.dispatch('no such command')")?, "unknown-command");
    assert_eq!(code_of("enroute.subscribe(3)")?, "bad-arguments");
    assert_eq!(code_of("enroute.open('enroute')")?, json!(null));
    Ok(())
}

#[test]
fn links_bring_a_shared_text_back() -> Result<()> {
    let page = Opened::with_fragment("")?;
    // "A()[l,u] = { Work()[1,2] }" in raw deflate and base64 for addresses, made by another program (zlib).
    let packed = "c9TQjM7RKY1VsFWoVgjPL8oG8g11jGIVagE";
    page.tab.evaluate(&format!("location.hash = '#source={packed}'"))?;
    page.tab.wait_until("enroute.source() === 'A()[l,u] = { Work()[1,2] }'")?;
    Ok(())
}
