//! Stepping a search with the keyboard, comparing two, and one selection across panels.

use anyhow::Result;
use serde_json::{Value, json};
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

fn lesson(more: &str) -> Result<Opened> {
    let page = Opened::with_fragment(&format!("mission=backjump&workspace=teach{more}"))?;
    page.settle()?;
    page.wait_for("state.search.steps > 100")?;
    Ok(page)
}

/// Steps over every step of the search instead of over key steps only, and the other way round.
const EVERY_STEP: &str = "enroute.dispatch('search.keySteps')";

/// Presses a key and answers the search once it has come to another step.
fn stepped(page: &Opened, key: Key, modifiers: Modifiers) -> Result<Value> {
    let before = page.state()?["search"]["step"].clone();
    page.tab.press(key, modifiers)?;
    page.wait_for(&format!("state.search.step !== {before}"))?;
    Ok(page.state()?["search"].clone())
}

#[test]
fn a_search_is_stepped_back_and_forth_with_the_keyboard() -> Result<()> {
    let page = lesson("")?;
    let planned = page.look()?;
    page.tab.evaluate(EVERY_STEP)?;
    let mut forth = Vec::new();
    for _ in 0..6 {
        forth.push(stepped(&page, Key::Character('.'), Modifiers::NONE)?);
    }
    assert_eq!(
        forth.iter().map(|it| it["step"].clone()).collect::<Vec<_>>(),
        [1, 2, 3, 4, 5, 6].map(|it| json!(it))
    );
    assert!(page.look()?.difference(&planned) > 0.01, "the panels show the step");
    for expected in forth.iter().rev().skip(1) {
        let back = stepped(&page, Key::Character(','), Modifiers::NONE)?;
        assert_eq!(back["known"], expected["known"]);
    }
    let last = stepped(&page, Key::End, Modifiers::NONE)?;
    assert_eq!((&last["step"], &last["known"]["event"]), (&last["steps"], &json!("solution")));
    assert_eq!(last["known"]["windows"], page.state()?["plan"]["windows"]);
    page.tab.press(Key::Escape, Modifiers::NONE)?;
    page.wait_for("state.search.step === 0")?;
    page.tab.evaluate(EVERY_STEP)?;
    let key_step = stepped(&page, Key::Character('.'), Modifiers::NONE)?["step"].as_u64();
    assert!(key_step > Some(1), "the beginning is no key step: {key_step:?}");
    Ok(())
}

#[test]
fn arrows_walk_the_search_tree_and_select_in_all_panels() -> Result<()> {
    let page = lesson("")?;
    stepped(&page, Key::Character('r'), Modifiers::NONE)?;
    stepped(&page, Key::ArrowDown, Modifiers::NONE)?;
    page.wait_for("state.selection?.name === 'D1=0'")?;
    stepped(&page, Key::ArrowRight, Modifiers::NONE)?;
    page.wait_for("state.selection?.name === 'D1=1'")?;
    stepped(&page, Key::ArrowDown, Modifiers::NONE)?;
    page.wait_for("state.selection?.name === 'D2=0'")?;
    // From the timeline to the text and the windows: what is selected there is an activity.
    page.tab.press(Key::Escape, Modifiers::NONE)?;
    page.wait_for("state.search.step === 0")?;
    page.tab.click_widget("button", "Pass#1:")?;
    page.wait_for("state.selection?.name === 'Pass#1'")?;
    // From the text.
    let source = page.tab.evaluate("enroute.source()")?;
    let at = source.as_str().and_then(|source| source.find("MODE=B [80,80]")).expect("an assertion") + 2;
    page.tab.evaluate(&format!("enroute.dispatch('edit.select', {{ start: {at} }})"))?;
    page.wait_for("state.selection?.name === 'Tell(MODE=B)@Tell(MODE=B)#2'")
}

#[test]
fn a_link_brings_the_step_back() -> Result<()> {
    let page = lesson("&step=60")?;
    page.wait_for("state.search.step === 60 && state.search.known.event === 'add-arc'")?;
    page.tab.evaluate(EVERY_STEP)?;
    stepped(&page, Key::Character('.'), Modifiers::NONE)?;
    assert_eq!(page.state()?["search"]["step"], 61);
    Ok(())
}

#[test]
fn both_searches_are_compared_step_by_step() -> Result<()> {
    let page = lesson("")?;
    page.tab.evaluate("enroute.dispatch('plan.compare')")?;
    page.wait_for("state.search.compare?.searches.length === 2")?;
    let compared = page.state()?["search"]["compare"]["searches"].clone();
    assert!(compared[0]["backtracks"].as_u64() > compared[1]["backtracks"].as_u64(), "{compared}");
    page.tab.press(Key::Character('.'), Modifiers::NONE)?;
    page.wait_for("state.search.compare.searches.every((it) => it.step > 0)")?;
    page.tab.press(Key::End, Modifiers::NONE)?;
    page.wait_for("state.search.compare.searches.every((it) => it.step === it.steps)")
}

#[test]
fn the_keyboard_goes_from_panel_to_panel() -> Result<()> {
    let page = lesson("")?;
    let panels = page.state()?["panels"].as_array().map_or(0, Vec::len);
    assert!(panels >= 4);
    let mut seen = Vec::new();
    for _ in 0..panels {
        let before = page.state()?["activePanel"].clone();
        page.tab.press(Key::Function(6), Modifiers::NONE)?;
        page.wait_for(&format!("state.activePanel !== {before}"))?;
        seen.push(page.state()?["activePanel"].to_string());
    }
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), panels, "{seen:?}");
    Ok(())
}
