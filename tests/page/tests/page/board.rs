//! A board takes a plan from draft to approval over one edit, with mouse and keyboard.

use anyhow::{Context as _, Result, bail};
use serde_json::Value;
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

/// The panel of the review with all the room there is.
fn reviewing() -> Result<Opened> {
    let page = Opened::with_fragment("mission=enroute&workspace=review")?;
    page.wait_for("state.review.hash !== null && !state.review.stale")?;
    for panel in ["plan", "timeline", "compare", "network", "terrain", "editor", "problems", "outline"] {
        page.tab.evaluate(&format!("enroute.dispatch('view.closePanel', '{panel}')"))?;
    }
    page.settle()?;
    Ok(page)
}

/// The names of the buttons that begin so, in the order in which they stand.
fn buttons(page: &Opened, start: &str) -> Result<Vec<String>> {
    let script = format!(
        "enroute.widgets('button').map((it) => it.label).filter((label) => label?.startsWith('{start}'))"
    );
    let names = page.tab.evaluate(&script)?;
    let names = names.as_array().context("a list")?;
    Ok(names.iter().filter_map(Value::as_str).map(str::to_owned).collect())
}

/// Turns the wheel over the panel until a widget is well inside of it, and clicks it.
fn click_widget(page: &Opened, role: &str, name: &str) -> Result<()> {
    for _ in 0..40 {
        let (_, y) = page.tab.widget(role, name)?.centre();
        match y {
            ..110.0 => page.tab.wheel(640.0, 500.0, -120.0)?,
            700.0.. => page.tab.wheel(640.0, 500.0, 120.0)?,
            _ => return page.tab.click_widget(role, name),
        }
        page.tab.next_frame()?;
    }
    bail!("the {role} \"{name}\" does not come into view")
}

/// Folds a section, so that what follows comes into view.
fn fold(page: &Opened, start: &str) -> Result<()> {
    let name = buttons(page, start)?.first().cloned().with_context(|| format!("no section {start}"))?;
    click_widget(page, "button", &name)?;
    page.settle()
}

/// Clicks the first button that begins so.
fn click(page: &Opened, start: &str) -> Result<()> {
    let name = buttons(page, start)?.first().cloned().with_context(|| format!("no button {start}"))?;
    click_widget(page, "button", &name)?;
    page.settle()
}

fn type_into(page: &Opened, field: &str, text: &str) -> Result<()> {
    click_widget(page, "textbox", field)?;
    page.type_text(text)?;
    page.settle()
}

/// Waits until the panel says this of what differs since the last approval.
fn wait_for_difference(page: &Opened, words: &str) -> Result<()> {
    page.tab.wait_until(&format!(
        "enroute.widgets('button').some((it) => it.label?.startsWith('Since the last approval') && \
         it.label.includes('{words}'))"
    ))?;
    Ok(())
}

#[test]
fn a_board_goes_from_draft_to_approval_and_an_edit_lapses_it() -> Result<()> {
    let page = reviewing()?;
    assert_eq!(page.state()?["review"]["planStatus"], "draft");
    type_into(&page, "Your name", "Ada")?;
    for section in ["Rules of ", "Choices, ", "Threats and ", "States and ", "Resources, ", "Windows and "] {
        fold(&page, section)?;
    }
    // Each line for attention is acknowledged with a reason, sent by Enter.
    let sections = ["Plan, ", "Causal links, ", "Durations that ", "Traverses, ", "Warnings in "];
    for (index, section) in sections.into_iter().enumerate() {
        click(&page, "Acknowledge… ")?;
        type_into(&page, "Why may it be so?", "As meant.")?;
        page.tab.press(Key::Enter, Modifiers::NONE)?;
        page.wait_for(&format!("state.review.history.length === {}", index + 1))?;
        fold(&page, section)?;
    }
    assert_eq!(page.state()?["review"]["blockers"], serde_json::json!([]));
    click_widget(&page, "button", "Approve")?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    page.tab.evaluate(
        "enroute.setSource(enroute.source().replace('PATH1=OK [450,450]', 'PATH1=OK [460,460]'))",
    )?;
    page.wait_for("state.review.planStatus === 'lapsed'")?;
    page.tab.evaluate("enroute.dispatch('review.run')")?;
    page.wait_for("!state.review.stale")?;
    wait_for_difference(&page, "text 1")?;
    page.tab.evaluate("enroute.dispatch('edit.undo')")?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    wait_for_difference(&page, "nothing differs")?;
    // What was done is still there after the page was loaded again.
    let heads = page.state()?["review"]["heads"].clone();
    page.tab.evaluate("window.isOldPage = true; location.reload()")?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    page.wait_for("state.review.planStatus === 'approved'")?;
    assert_eq!(page.state()?["review"]["heads"], heads);
    Ok(())
}
