//! Nothing that was typed is lost: reloads, closed tabs and killed workers right after a key press.

use anyhow::Result;
use serde_json::json;
use xtask::browser::{Key, Modifiers};
use xtask::kill::{Pace, Victim};

use crate::opened::{BROWSER, Opened, SITE};

/// Types at the end of a fresh mission and leaves at once, without waiting for a frame.
fn type_and_leave(page: &Opened, typed: &str, leave: &str) -> Result<()> {
    page.tab.click_widget("textbox", "Mission text")?;
    page.tab.evaluate(&format!(
        "window.isOldPage = true; enroute.dispatch('edit.select', {{ start: {} }})",
        1 << 20
    ))?;
    page.tab.type_text(typed)?;
    page.tab.evaluate(leave)?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()
}

#[test]
fn a_reload_right_after_a_key_press_loses_none() -> Result<()> {
    let page = Opened::with_fragment("mission=enroute")?;
    let mut expected = page.tab.evaluate("enroute.source()")?.as_str().unwrap_or_default().to_owned();
    for round in 0..4 {
        let typed = format!("// {round} the quick brown fox jumps over the lazy dog");
        type_and_leave(&page, &typed, "location.reload()")?;
        expected.push_str(&typed);
        assert_eq!(page.tab.evaluate("enroute.source()")?, json!(expected), "round {round}");
    }
    let library = page.state()?["library"].clone();
    assert_eq!(library["missions"].as_array().map(Vec::len), Some(1), "{library}");
    page.wait_for("state.library.keeping === 'kept'")?;
    Ok(())
}

/// The browser has asked for the page already when the mission that was typed gets an address of its own.
#[test]
fn a_frame_that_comes_after_a_reload_began_loses_no_mission() -> Result<()> {
    let page = Opened::with_fragment("mission=enroute")?;
    page.tab.evaluate(
        "window.isOldPage = true;
         addEventListener('beforeunload', () => {
             enroute.setSource('// one');
             Object.defineProperty(document, 'visibilityState', { get: () => 'hidden' });
             document.dispatchEvent(new Event('visibilitychange'));
         });
         location.reload()",
    )?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, "// one");
    // The example is still there for those who ask for it.
    page.tab.evaluate("window.isOldPage = true; location.hash = 'mission=enroute'; location.reload()")?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    page.tab.wait_until("enroute.source().startsWith('// The Enroute mission')")?;
    Ok(())
}

#[test]
fn a_closed_tab_and_a_tab_beside_it_have_what_was_typed() -> Result<()> {
    let page = Opened::with_fragment("")?;
    page.tab.evaluate("enroute.setSource('// one')")?;
    page.tab.next_frame()?;
    let beside = page.open_beside("")?;
    beside.wait_until_ready()?;
    beside.wait_until("enroute.source() === '// one'")?;
    // What one says the other takes over.
    beside.evaluate("enroute.setSource('// one and two')")?;
    beside.next_frame()?;
    // A tab that no one sees draws no frames, and hears of it when it is shown.
    page.tab.call("Page.bringToFront", &json!({}))?;
    page.tab.wait_until("enroute.source() === '// one and two'")?;
    page.tab.evaluate("enroute.setSource('// one, two and three')")?;
    page.tab.next_frame()?;
    beside.call("Page.bringToFront", &json!({}))?;
    beside.wait_until("enroute.source() === '// one, two and three'")?;
    page.tab.call("Page.bringToFront", &json!({}))?;
    page.tab.evaluate("enroute.setSource('// four')")?;
    page.tab.next_frame()?;
    page.tab.call("Page.close", &json!({}))?;
    let again = page.open_beside("")?;
    again.wait_until_ready()?;
    again.wait_until("enroute.source() === '// four'")?;
    Ok(())
}

#[test]
fn without_any_storage_the_page_says_so_and_works() -> Result<()> {
    let page = Opened::altered("web/database.js", |text| {
        let forbidden = "for (const place of ['localStorage', 'sessionStorage']) {
            Object.defineProperty(window, place, { get() { throw new Error('forbidden'); } });
        }";
        format!("{forbidden}\n{}", text.replace("indexedDB.open(name, 1)", "forbidden()"))
    })?;
    page.tab.evaluate("enroute.setSource('A()[l,u] = { Work()[1,2] }')")?;
    page.wait_for("state.library.keeping === 'nothing'")?;
    page.tab.wait_until("enroute.widgets('button', 'Not saved').length > 0")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, "A()[l,u] = { Work()[1,2] }");
    Ok(())
}

/// Whatever the browser kept is damaged in several ways: the page starts with each, and is of a size that one can use.
#[test]
fn damaged_settings_and_layouts_do_not_keep_the_page_from_starting() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate("enroute.dispatch('view.textLarger')")?;
    page.tab.evaluate("enroute.dispatch('view.panel', { name: 'distances' })")?;
    page.tab.wait_until("Object.keys(localStorage).some((key) => key.includes('settings'))")?;
    page.tab.wait_until("Object.keys(localStorage).some((key) => key.includes('layout'))")?;
    page.tab.evaluate("sessionStorage.setItem('before', JSON.stringify({ ...localStorage }))")?;
    for damage in [
        "text.slice(0, text.length / 2)",
        "text.replace(/-?[0-9]+([.][0-9]+)?/g, '1e30')",
        "text.replace(/-?[0-9]+([.][0-9]+)?/g, '-1e30')",
        "text.replace(/-?[0-9]+([.][0-9]+)?/g, '0')",
        "'[]'",
        "''",
    ] {
        page.tab.evaluate(&format!(
            "window.addEventListener('pagehide', () => {{
                for (const [key, text] of Object.entries(JSON.parse(sessionStorage.getItem('before')))) {{
                    if (!key.includes('mission')) localStorage.setItem(key, {damage});
                }}
            }});
            window.isOldPage = true;
            location.reload()"
        ))?;
        page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
        page.tab.wait_until_ready()?;
        page.tab.next_frame()?;
        let failure =
            page.tab.evaluate("document.querySelector('#loading[role=alert]')?.innerText ?? null")?;
        assert!(failure.is_null(), "{damage}: {failure}");
        let text = page.tab.widget("textbox", "Mission text")?;
        assert!(text.width > 100.0 && text.height > 100.0, "{damage}: {text:?}");
    }
    Ok(())
}

/// Whether the texts that the database holds for the next start contain these words.
fn is_on_disk(words: &str) -> String {
    format!(
        "new Promise((resolve) => {{
            indexedDB.open('enroute', 1).onsuccess = ({{ target: {{ result: database }} }}) => {{
                const range = IDBKeyRange.bound('typed/', 'typed0');
                const all = database.transaction('shelf').objectStore('shelf').getAll(range);
                all.onsuccess = () => {{
                    database.close();
                    resolve(all.result.some((bytes) => new TextDecoder().decode(bytes).includes({})));
                }};
            }};
        }})",
        json!(words)
    )
}

#[test]
fn keys_are_on_the_disk_before_a_late_frame_takes_them_in() -> Result<()> {
    let page = Opened::with_fragment("")?;
    page.tab.evaluate("enroute.setSource('// one ')")?;
    page.wait_for("state.library.keeping === 'kept'")?;
    page.place_caret_after("// one ")?;
    page.settle()?;
    page.tab.evaluate(
        "window.frames_ = []; window.draw = requestAnimationFrame.bind(window);
         window.requestAnimationFrame = (frame) => window.frames_.push(frame)",
    )?;
    // The frame that was asked for before asks for the next one, which waits.
    page.tab.wait_until("frames_.length > 0")?;
    page.tab.type_text("twoo")?;
    page.tab.press(Key::Backspace, Modifiers::NONE)?;
    page.tab.wait_until(&is_on_disk("// one two\""))?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, "// one ", "no frame has taken it in");
    page.tab.evaluate("window.requestAnimationFrame = draw; frames_.forEach((frame) => draw(frame)); 0")?;
    page.tab.wait_until("enroute.source() === '// one two'")?;
    Ok(())
}

#[test]
fn a_killed_browser_has_what_the_database_confirmed_and_opens_the_same_mission() -> Result<()> {
    let deaths = xtask::kill::kill(Victim::Chromium, &SITE, 2, 5, Pace::Confirmed, |_| {})?;
    assert_eq!((deaths.kills, deaths.lost_ages.len()), (2, 0), "{deaths}");
    Ok(())
}

#[test]
fn twenty_disturbances_lose_no_key_press() -> Result<()> {
    let browser = BROWSER.get()?;
    let losses = xtask::disturb::disturb(&browser, &SITE, 20, 7, |_| {})?;
    assert_eq!((losses.runs(), losses.lost()), (20, 0), "{losses}{:?}", losses.differences);
    Ok(())
}
