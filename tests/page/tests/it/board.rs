//! A board that somebody tries to cheat, in the browser: each cheat is refused, or marked on screen and counts for nothing.

use anyhow::{Context as _, Result};
use serde_json::{Value, json};

use crate::opened::Opened;

/// Why a command is refused; fails where it is not.
fn refused(page: &Opened, command: &str, arguments: &Value) -> Result<String> {
    let why = page.tab.evaluate(&format!(
        "(() => {{ try {{ enroute.dispatch({}, {arguments}); }} catch (error) {{ return String(error.message); }} }})()",
        json!(command)
    ))?;
    Ok(why.as_str().with_context(|| format!("{command} {arguments} is not refused"))?.to_owned())
}

fn dispatch(page: &Opened, command: &str, arguments: &Value) -> Result<()> {
    page.tab.evaluate(&format!("enroute.dispatch({}, {arguments})", json!(command)))?;
    Ok(())
}

/// The present plan, approved by Ada before a board of Ada and Grace.
fn approved_by_ada() -> Result<Opened> {
    let page = Opened::planned()?;
    // What is saved is caught instead of downloaded.
    page.tab.evaluate(
        "window.saved = [];
         URL.createObjectURL = (blob) => { blob.text().then((text) => saved.push(text)); return 'blob:none'; }",
    )?;
    page.tab.evaluate("enroute.dispatch('view.workspace', { name: 'review' })")?;
    page.wait_for("state.review.hash !== null && !state.review.stale")?;
    for name in ["Ada", "Grace"] {
        dispatch(&page, "review.createKey", &json!({ "name": name }))?;
        page.wait_for(&format!(
            "state.review.people.some((person) => person.name === '{name}' && person.own)"
        ))?;
    }
    dispatch(&page, "review.rules", &json!({ "board": [{ "role": "Science", "approvals": 2 }] }))?;
    page.wait_for("state.review.board[0].wanted === 2")?;
    page.tab.evaluate(
        "enroute.state().review.items.forEach((it, item) => it.status === 'attention'
            && enroute.dispatch('review.acknowledge', { name: 'Ada', item, text: 'As meant.' }))",
    )?;
    dispatch(&page, "review.approve", &json!({ "name": "Ada" }))?;
    page.wait_for("state.review.board[0].given.length === 1")?;
    Ok(page)
}

#[test]
fn a_board_is_not_cheated_in_the_page() -> Result<()> {
    let page = approved_by_ada()?;
    // One person is not three.
    for name in ["Àda", "\u{410}da", "ADA"] {
        let why = refused(&page, "review.createKey", &json!({ "name": name }))?;
        assert!(why.contains("taken for “Ada”") || why.contains("scripts"), "{why}");
    }
    assert!(refused(&page, "review.approve", &json!({ "name": "Ada" }))?.contains("already"));
    assert!(refused(&page, "review.approve", &json!({ "name": "Eve" }))?.contains("Unknown key “Eve”"));
    // Nobody takes back the signature of somebody else.
    let given = page.state()?["review"]["history"].as_array().and_then(|all| all.last().cloned());
    let id = given.context("an entry")?["id"].clone();
    let back = json!({ "name": "Grace", "id": id, "text": "Not read." });
    assert!(refused(&page, "review.withdraw", &back)?.contains("Only the person who signed"));
    dispatch(&page, "review.approve", &json!({ "name": "Grace" }))?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    // Pinned times were not approved.
    dispatch(&page, "plan.pin", &json!({ "event": "Group-Wait#1.end", "time": 450 }))?;
    dispatch(&page, "export.schedule", &json!({ "as": "json" }))?;
    page.tab.wait_until("saved.some((text) => text.includes('\"plan_status\": \"pinned\"'))")?;
    // Other rules lapse the approvals.
    dispatch(&page, "review.rules", &json!({ "board": [{ "role": "Science", "approvals": 1 }] }))?;
    page.wait_for("state.review.planStatus === 'lapsed'")?;
    Ok(())
}

#[test]
fn a_forged_history_is_marked_and_counts_for_nothing() -> Result<()> {
    let page = approved_by_ada()?;
    dispatch(&page, "review.approve", &json!({ "name": "Grace" }))?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    page.tab.evaluate("enroute.dispatch('review.save')")?;
    page.tab.evaluate("enroute.dispatch('review.saveKeys')")?;
    page.tab.wait_until("saved.length === 2")?;
    let saved = page.tab.evaluate("saved")?;
    let saved: Vec<&str> = saved.as_array().context("a list")?.iter().filter_map(Value::as_str).collect();
    let review = *saved.iter().find(|text| text.contains("enroute-review/3")).context("a history")?;
    let keys = *saved.iter().find(|text| text.contains("enroute-keys/1")).context("keys")?;
    assert!(!keys.contains("secret"), "a secret key is in no file but its own");
    let mut forged: Value = serde_json::from_str(review)?;
    let entries = forged["entries"].as_array_mut().context("a list")?;
    entries.last_mut().context("an entry")?["signature"] = json!("00".repeat(64));

    let other = Opened::planned()?;
    other.tab.evaluate("enroute.dispatch('view.workspace', { name: 'review' })")?;
    other.wait_for("state.review.hash !== null && !state.review.stale")?;
    other.tab.drop_file("forged.review.json", forged.to_string().as_bytes())?;
    other.wait_for("state.review.history.length > 0")?;
    other.wait_for("state.review.history.every((entry) => !entry.counts)")?;
    other.wait_for("state.review.history.at(-1).signature === 'broken'")?;
    other.wait_for("state.review.planStatus === 'draft'")?;
    other.tab.drop_file("board.keys.json", keys.as_bytes())?;
    other.wait_for("state.review.people.length === 2 && state.review.history[0].counts")?;
    other.wait_for("state.review.planStatus === 'in-review'")?;
    // What was signed by nobody else's hand completes the board.
    other.tab.drop_file("board.review.json", review.as_bytes())?;
    other.wait_for("state.review.planStatus === 'approved'")?;
    Ok(())
}

#[test]
fn two_tabs_see_each_other_s_approvals() -> Result<()> {
    let page = approved_by_ada()?;
    let beside = page.open_beside("")?;
    beside.wait_until_ready()?;
    beside.evaluate("enroute.dispatch('view.workspace', { name: 'review' })")?;
    beside.wait_until("enroute.state().review.board[0]?.given.length === 1")?;
    dispatch(&page, "review.approve", &json!({ "name": "Grace" }))?;
    beside.wait_until("enroute.state().review.board[0].given.length === 2")?;
    Ok(())
}
