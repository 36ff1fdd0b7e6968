//! A board that somebody tries to cheat, in the browser: each cheat is refused, or marked on screen and counts for nothing.

use anyhow::{Context as _, Result};
use serde_json::{Value, json};
use xtask::browser::Graphics;

use crate::opened::Opened;

/// Returns why a command is refused; fails where it is not.
fn refused(page: &Opened, command: &str, arguments: &Value) -> Result<String> {
    let why = page.tab.evaluate(&format!(
        "(() => {{ try {{ enroute.dispatch({}, {arguments}); }} catch (error) {{ return String(error.message); }} }})()",
        json!(command)
    ))?;
    Ok(why.as_str().with_context(|| format!("{command} {arguments} is not refused"))?.to_owned())
}

/// Whether a message is shown with these words.
fn says(words: &str) -> String {
    format!("state.toasts.some((it) => it.includes({}))", json!(words))
}

fn dispatch(page: &Opened, command: &str, arguments: &Value) -> Result<()> {
    page.tab.evaluate(&format!("enroute.dispatch({}, {arguments})", json!(command)))?;
    Ok(())
}

/// The mission `enroute`, or another text, reviewed before a board of Ada and Grace.
fn before_the_board(page: Opened, source: Option<&str>) -> Result<Opened> {
    // What is saved is caught instead of downloaded.
    page.tab.evaluate(
        "window.saved = [];
         URL.createObjectURL = (blob) => { blob.text().then((text) => saved.push(text)); return 'blob:none'; }",
    )?;
    if let Some(source) = source {
        page.tab.evaluate(&format!("enroute.setSource({})", json!(source)))?;
        page.settle()?;
    }
    dispatch(&page, "view.workspace", &json!({ "name": "review" }))?;
    page.wait_for("state.review.hash !== null && !state.review.stale")?;
    for name in ["Ada", "Grace"] {
        dispatch(&page, "review.createKey", &json!({ "name": name }))?;
        page.wait_for(&format!(
            "state.review.people.some((person) => person.name === '{name}' && person.own)"
        ))?;
    }
    dispatch(&page, "review.rules", &json!({ "board": [{ "role": "Science", "approvals": 2 }] }))?;
    page.wait_for("state.review.board[0].wanted === 2")?;
    Ok(page)
}

/// Ada acknowledges whatever no one has acknowledged or waived.
fn acknowledge_all(page: &Opened) -> Result<()> {
    page.tab.evaluate(
        "enroute.state().review.items.forEach((it, item) => it.status === 'attention' && !it.acknowledged
            && enroute.dispatch('review.acknowledge', { name: 'Ada', item, text: 'As meant.' }))",
    )?;
    Ok(())
}

/// The same, approved by Ada.
fn approved_by_ada() -> Result<Opened> {
    let page = before_the_board(Opened::planned()?, None)?;
    acknowledge_all(&page)?;
    dispatch(&page, "review.approve", &json!({ "name": "Ada" }))?;
    page.wait_for("state.review.board[0].given.length === 1")?;
    Ok(page)
}

/// The same, approved by both, with the history and the trusted keys as they are saved.
fn approved_and_saved() -> Result<(Opened, String, String)> {
    let page = approved_by_ada()?;
    dispatch(&page, "review.approve", &json!({ "name": "Grace" }))?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    dispatch(&page, "review.save", &Value::Null)?;
    dispatch(&page, "review.saveKeys", &Value::Null)?;
    page.tab.wait_until("saved.length === 2")?;
    let saved = page.tab.evaluate("saved")?;
    let saved: Vec<&str> = saved.as_array().context("a list")?.iter().filter_map(Value::as_str).collect();
    let with = |format: &str| saved.iter().find(|text| text.contains(format)).map(|text| (*text).to_owned());
    let review = with("enroute-review/3").context("a history")?;
    let keys = with("enroute-keys/1").context("keys")?;
    assert!(!keys.contains("secret"), "a secret key is in no file but its own");
    Ok((page, review, keys))
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
    // No one takes back the signature of someone else.
    let given = page.state()?["review"]["history"].as_array().and_then(|all| all.last().cloned());
    let id = given.context("an entry")?["id"].clone();
    let back = json!({ "name": "Grace", "id": id, "text": "Not read." });
    assert!(refused(&page, "review.withdraw", &back)?.contains("Only the person who signed"));
    // One key has one name.
    let key = page.state()?["review"]["people"][0]["key"].clone();
    let why = refused(&page, "review.trust", &json!({ "name": "Eve", "key": key }))?;
    assert!(why.contains("trusted already"), "{why}");
    // No one resolves the comment of someone else.
    dispatch(&page, "review.comment", &json!({ "author": "Ada", "text": "Why so long?" }))?;
    page.wait_for("state.review.comments.length === 1")?;
    let id = page.state()?["review"]["comments"][0]["id"].clone();
    let resolve = |name: &str| json!({ "name": name, "id": id, "text": "It waits for light." });
    assert!(refused(&page, "review.resolve", &resolve("Grace"))?.contains("Only the author"));
    assert!(refused(&page, "review.approve", &json!({ "name": "Grace" }))?.contains("1 comment is open"));
    dispatch(&page, "review.resolve", &resolve("Ada"))?;
    dispatch(&page, "review.approve", &json!({ "name": "Grace" }))?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    // Pinned times were not approved.
    dispatch(&page, "plan.pin", &json!({ "event": "Group-Wait#1.end", "time": 450 }))?;
    dispatch(&page, "export.schedule", &json!({ "as": "json" }))?;
    page.tab.wait_until("saved.some((text) => text.includes('\"plan_status\": \"pinned\"'))")?;
    // Other rules lapse the approvals.
    dispatch(&page, "review.rules", &json!({ "slope_deg": 14 }))?;
    page.wait_for("state.review.planStatus === 'lapsed'")?;
    Ok(())
}

#[test]
fn nobody_weakens_a_board_alone() -> Result<()> {
    let page = approved_by_ada()?;
    let one = json!({ "board": [{ "role": "Science", "approvals": 1 }] });
    // The person who signed last signs the rules.
    dispatch(&page, "review.rules", &one)?;
    page.wait_for(&says("not in force yet"))?;
    page.wait_for("state.review.history.at(-1).withoutEffect !== null")?;
    page.wait_for("state.review.board[0].wanted === 2 && state.review.planStatus === 'in-review'")?;
    // Grace approves under the board of two, and agrees to one approval; then both approve again.
    dispatch(&page, "review.approve", &json!({ "name": "Grace" }))?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    dispatch(&page, "review.rules", &one)?;
    page.wait_for("state.review.board[0].wanted === 1 && state.review.board[0].given.length === 0")?;
    dispatch(&page, "review.approve", &json!({ "name": "Ada" }))?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    Ok(())
}

/// Drops a file of keys, and agrees to trust them.
fn trust_keys(page: &Opened, keys: &str) -> Result<()> {
    page.tab.drop_file("board.keys.json", keys.as_bytes())?;
    page.wait_for("state.dialog === 'trust-keys'")?;
    page.wait_for("state.review.people.length === 0")?;
    // Nothing can be trusted in the first second.
    std::thread::sleep(std::time::Duration::from_millis(1500));
    page.tab.click_widget("button", "Trust")?;
    Ok(())
}

#[test]
fn a_forged_history_is_marked_and_counts_for_nothing() -> Result<()> {
    let (page, review, keys) = approved_and_saved()?;
    let mut forged: Value = serde_json::from_str(&review)?;
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
    trust_keys(&other, &keys)?;
    other.wait_for("state.review.people.length === 2 && state.review.history[0].counts")?;
    other.wait_for("state.review.planStatus === 'in-review'")?;
    // The panel shows it, not only the state.
    dispatch(&other, "view.panel", &json!({ "name": "review" }))?;
    for delta in [2000.0, 2000.0, 2000.0, 2000.0, -350.0] {
        other.tab.wheel(100.0, 300.0, delta)?;
        other.tab.next_frame()?;
    }
    other.tab.wait_until(
        "[...document.querySelectorAll('[id^=widget-]')].some((it) => it.textContent.includes('broken'))",
    )?;
    other.keep_picture("forged-history")?;
    // What was signed by no one else's hand completes the board.
    other.tab.drop_file("board.review.json", review.as_bytes())?;
    other.wait_for("state.review.planStatus === 'approved'")?;
    // What is left out, or says something else, is not a history.
    for (name, from, to) in
        [("words", "As meant.", "Whatever."), ("order", "\"former\": []", "\"former\": [\"00\"]")]
    {
        let altered = review.replacen(from, to, 1);
        anyhow::ensure!(altered != review, "{from} is not in the history");
        page.tab.drop_file(&format!("{name}.review.json"), altered.as_bytes())?;
        page.wait_for(&says(&format!("Couldn't add {name}.review.json")))?;
    }
    // What was taken back is not handed in again.
    let history = page.state()?["review"]["history"].clone();
    let of_ada = history.as_array().into_iter().flatten().find(|it| it["act"] == "approved");
    let back = json!({ "name": "Ada", "id": of_ada.context("an approval")?["id"], "text": "Not read." });
    dispatch(&page, "review.withdraw", &back)?;
    page.wait_for("state.review.planStatus === 'in-review'")?;
    page.tab.drop_file("again.review.json", review.as_bytes())?;
    page.wait_for(&says("Added 0 new entries from again.review.json"))?;
    page.wait_for("state.review.planStatus === 'in-review'")?;
    Ok(())
}

#[test]
fn a_history_of_another_mission_counts_for_nothing() -> Result<()> {
    let (_page, review, keys) = approved_and_saved()?;
    let other = Opened::with_fragment("mission=both-paths")?;
    other.settle()?;
    dispatch(&other, "view.workspace", &json!({ "name": "review" }))?;
    other.wait_for("state.review.hash !== null && !state.review.stale")?;
    trust_keys(&other, &keys)?;
    other.wait_for("state.review.people.length === 2")?;
    other.tab.drop_file("board.review.json", review.as_bytes())?;
    other.wait_for(&says("is a review of “enroute”"))?;
    assert_eq!(other.state()?["review"]["history"], json!([]));
    // The file says that it is of this mission; each signature says otherwise.
    let mut renamed: Value = serde_json::from_str(&review)?;
    renamed["mission"] = other.state()?["mission"].clone();
    other.tab.drop_file("board.review.json", renamed.to_string().as_bytes())?;
    other.wait_for("state.review.history.length > 0")?;
    other.wait_for(
        "state.review.history.every((it) => !it.counts && it.problem.includes('the history of “enroute”'))",
    )?;
    other.wait_for("state.review.planStatus === 'draft' && state.review.board[0].wanted === 1")?;
    other.wait_for("state.review.items.every((it) => !it.acknowledged)")?;
    Ok(())
}

/// A mission in which no one knows when the permission comes.
fn with_delay(world: &str) -> String {
    format!(
        "var GO : {{OK, NO}}; var STORM : {{ON, OFF}}; primitive Dig()[4,4];
        scenario Day[0,90] = {{ {{ delay; do {{ Dig() }} maintaining GO=OK }}, {{ {world} }} }}"
    )
}

#[test]
fn a_delay_that_is_moved_needs_another_acknowledgment() -> Result<()> {
    let here = with_delay("delay[5,20]; GO=OK [10,10]; STORM=ON [5,5]");
    let page = before_the_board(Opened::planned()?, Some(&here))?;
    acknowledge_all(&page)?;
    for name in ["Ada", "Grace"] {
        dispatch(&page, "review.approve", &json!({ "name": name }))?;
    }
    page.wait_for("state.review.planStatus === 'approved'")?;
    let assumed = |acknowledged: bool| {
        format!(
            "!state.review.stale && state.review.items.some((it) =>
                it.text.startsWith('assumes favorable timing') && !!it.acknowledged === {acknowledged})"
        )
    };
    page.wait_for(&assumed(true))?;
    let there = with_delay("GO=OK [10,10]; delay[5,20]; STORM=ON [5,5]");
    for (text, is_acknowledged, status) in [(&there, false, "lapsed"), (&here, true, "approved")] {
        page.tab.evaluate(&format!("enroute.setSource({})", json!(text)))?;
        page.settle()?;
        dispatch(&page, "review.run", &Value::Null)?;
        page.wait_for(&assumed(is_acknowledged))?;
        page.wait_for(&format!("state.review.planStatus === '{status}'"))?;
    }
    Ok(())
}

#[test]
fn a_waiver_lapses_on_its_day_while_the_page_is_open() -> Result<()> {
    let clock = "window.ahead = 0; const now = Date.now.bind(Date); Date.now = () => now() + window.ahead * 86400000;";
    let page = Opened::after(clock, Graphics::WebGl2)?;
    page.tab.wait_until_ready()?;
    page.settle()?;
    let page = before_the_board(page, None)?;
    page.tab.evaluate(
        "(() => {
            const until = new Date(Date.now() + 10 * 86400000).toISOString().slice(0, 10);
            const item = enroute.state().review.items.findIndex((it) => it.status === 'attention');
            enroute.dispatch('review.waive', { name: 'Ada', item, text: 'Mended soon.', until });
        })()",
    )?;
    page.wait_for("state.review.waivers.length === 1")?;
    acknowledge_all(&page)?;
    for name in ["Ada", "Grace"] {
        dispatch(&page, "review.approve", &json!({ "name": name }))?;
    }
    for (days, state, status) in
        [(0, "in-force", "approved"), (5, "about-to-lapse", "approved"), (11, "lapsed", "in-review")]
    {
        page.tab.evaluate(&format!("window.ahead = {days}"))?;
        // The next frame looks at the clock.
        dispatch(&page, "view.workspace", &json!({ "name": "review" }))?;
        page.wait_for(&format!(
            "state.review.waivers[0].state === '{state}' && state.review.planStatus === '{status}'"
        ))?;
    }
    Ok(())
}

#[test]
fn two_tabs_see_each_other_s_approvals() -> Result<()> {
    let page = approved_by_ada()?;
    let beside = page.open_beside("mission=enroute")?;
    beside.wait_until_ready()?;
    beside.evaluate("enroute.dispatch('view.workspace', { name: 'review' })")?;
    beside.wait_until("enroute.state().review.board[0]?.given.length === 1")?;
    dispatch(&page, "review.approve", &json!({ "name": "Grace" }))?;
    beside.wait_until("enroute.state().review.board[0].given.length === 2")?;
    Ok(())
}
