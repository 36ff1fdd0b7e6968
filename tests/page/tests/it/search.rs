//! Stepping a search with the keys of the browser.

use anyhow::Result;
use serde_json::{Value, json};
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

fn lesson() -> Result<Opened> {
    let page = Opened::with_fragment("mission=backjump&workspace=teach")?;
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
    let page = lesson()?;
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
    // Browsers have a use of their own for F6.
    let panel = page.state()?["activePanel"].clone();
    page.tab.press(Key::Function(6), Modifiers::NONE)?;
    page.wait_for(&format!("state.activePanel !== {panel}"))?;
    Ok(())
}
