//! Events are dragged on the timeline with a real mouse.

use anyhow::{Context as _, Result};
use serde_json::{Value, json};
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

#[test]
fn dragging_an_event_inside_its_window_moves_the_others_and_escape_gives_them_back() -> Result<()> {
    let page = Opened::with_fragment("mission=enroute&workspace=review")?;
    page.settle()?;
    let free = page.state()?["plan"]["windows"].clone();
    let before = page.look()?;
    let handle = page.tab.widget("slider", "Move Group-Enroute#1.start on the timeline")?;
    let (x, y) = handle.centre();

    // Far beyond the end of its window, where it stays.
    page.tab.drag(&[(x, y), (x + 10.0, y), (x + 60.0, y), (x + 300.0, y)])?;
    page.wait_for("state.pinned !== null")?;
    let pinned = page.state()?["pinned"].clone();
    assert_eq!(pinned["events"], json!({ "Group-Enroute#1.start": 55 }));
    // SPEC 3.6: slack 45; pinned at the end of its window, the drive in it is rigid.
    assert_eq!(pinned["windows"]["Group-Enroute#1.start"], json!([55, 55]));
    assert_eq!(pinned["windows"]["Group-Traverse-Path#1.end"], json!([460, 460]));
    assert_eq!(page.state()?["plan"]["windows"], free, "the plan itself is as it was");
    assert!(page.look()?.difference(&before) > 0.001, "the picture did not change");

    page.tab.press(Key::Escape, Modifiers::NONE)?;
    page.wait_for("state.pinned === null")?;
    Ok(())
}

#[test]
fn dragging_a_bound_changes_the_text_and_undo_takes_the_whole_drag_back() -> Result<()> {
    let page = Opened::with_fragment("mission=enroute&workspace=review")?;
    page.settle()?;
    let source = page.tab.evaluate("enroute.source()")?;
    page.tab.evaluate("enroute.dispatch('go.select', { name: 'Group-Enroute#1' })")?;
    let handle = page.tab.widget("slider", "Change the greatest duration of Group-Enroute#1")?;
    let (x, y) = handle.centre();
    page.tab.drag(&[(x, y), (x - 6.0, y), (x - 12.0, y), (x - 20.0, y)])?;
    page.wait_for("state.status === 'plan' && !state.isStale")?;
    let changed = page.tab.evaluate("enroute.source()")?;
    let at = "Group-Enroute()[450,";
    let bound = |text: &Value| -> Result<f64> {
        let text = text.as_str().context("the source is a text")?;
        let rest = text.split(at).nth(1).context("the call is there")?;
        Ok(rest.split(']').next().context("its bounds are closed")?.parse()?)
    };
    assert_eq!(bound(&source)?, 540.0);
    assert!((450.0..540.0).contains(&bound(&changed)?), "{changed}");

    page.tab.evaluate("enroute.dispatch('edit.undo')")?;
    page.wait_for("!state.isStale")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, source);
    Ok(())
}
