//! A control program is stepped, broken and misled in the page, with mouse and keyboard.

use anyhow::{Context as _, Result};
use serde_json::Value;
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

/// The page with the program of SPEC 8.4 and its plant, high enough for all that belongs to it.
fn orbit_insertion() -> Result<Opened> {
    let page = Opened::with_fragment("mission=orbit-insertion")?;
    page.tab.resize(1400, 1300)?;
    page.wait_for("state.hca !== null")?;
    page.tab.next_frame()?;
    Ok(page)
}

/// Steps on by the key for it, so often.
fn step(page: &Opened, times: u64) -> Result<()> {
    for _ in 0..times {
        let next = page.state()?["hca"]["step"].as_u64().context("a step")? + 1;
        page.tab.press(Key::Character('.'), Modifiers::NONE)?;
        page.wait_for(&format!("state.hca.step === {next}"))?;
    }
    Ok(())
}

/// What the diagnosis says of the last step.
fn conflicts(page: &Opened) -> Result<String> {
    Ok(page.state()?["hca"]["plant"]["conflicts"].to_string())
}

#[test]
fn a_pressed_mode_fails_the_engine_and_stepping_back_lets_it_be_taken_back() -> Result<()> {
    let page = orbit_insertion()?;
    step(&page, 2)?;
    page.tab.click_widget("button", "EngineA: Failed")?;
    page.tab.widget("button", "EngineA: Failed, 0 %, injected in this step")?;
    let before = page.look()?;
    step(&page, 1)?;
    assert_eq!(page.state()?["hca"]["plant"]["trueState"]["EngineA"], "Failed");
    step(&page, 1)?;
    // SPEC 8.4: the failure shows when the engine is to fire, and the reserve takes over.
    let marked = page.state()?["hca"]["marked"].to_string();
    assert!(marked.contains("EngineB=Firing"), "{marked}");
    assert!(conflicts(&page)?.contains("EngineA=Firing contradicts"), "{}", conflicts(&page)?);
    assert!(page.look()?.difference(&before) > 0.005, "automaton, plant and belief show it");

    for _ in 0..2 {
        page.tab.press(Key::Character(','), Modifiers::NONE)?;
    }
    page.wait_for("state.hca.step === 2")?;
    page.tab.click_widget("button", "EngineA: Failed, 0 %, injected in this step")?;
    step(&page, 2)?;
    assert_eq!(page.state()?["hca"]["plant"]["trueState"]["EngineA"], "Firing");
    Ok(())
}

#[test]
fn another_observation_changes_the_diagnosis_and_the_plants_own_brings_it_back() -> Result<()> {
    let page = orbit_insertion()?;
    step(&page, 4)?;
    assert_eq!(conflicts(&page)?, "[]");
    page.tab.click_widget("combobox", "EngineA.thrust was observed to be")?;
    page.tab.click_widget("button", "zero")?;
    page.wait_for("state.hca.plant.conflicts.length > 0")?;
    assert!(conflicts(&page)?.contains("EngineA=Firing contradicts"), "{}", conflicts(&page)?);
    let believed = |page: &Opened| -> Result<Value> {
        Ok(page.state()?["hca"]["plant"]["belief"][0]["state"]["EngineA"].clone())
    };
    assert_eq!(believed(&page)?, "Failed");
    page.tab.click_widget("button", "as shown")?;
    page.wait_for("state.hca.plant.conflicts.length === 0")?;
    assert_eq!(believed(&page)?, "Firing");
    Ok(())
}

#[test]
fn a_composite_and_its_text_are_selected_together() -> Result<()> {
    let page = orbit_insertion()?;
    let source = page.tab.evaluate("enroute.source()")?;
    let source = source.as_str().context("the source is a text")?;
    let caret = source.find("EngineA = Firing").context("the goal to fire")? + 2;
    let before = page.look()?;
    page.tab.evaluate(&format!("enroute.dispatch('edit.select', {{ start: {caret} }})"))?;
    page.wait_for(&format!("state.caret.head === {caret}"))?;
    assert!(
        page.look()?.difference(&before) > 0.0,
        "the drawing marks what the text at the caret stands for"
    );
    page.tab.click_widget("button", "a1: assert EngineA=Standby")?;
    page.wait_for("state.caret.anchor !== state.caret.head")?;
    let caret = page.state()?["caret"].clone();
    let (from, to) = (caret["anchor"].as_u64().unwrap_or(0), caret["head"].as_u64().unwrap_or(0));
    let selected = &source[from.min(to) as usize..from.max(to) as usize];
    assert!(selected.contains("EngineA = Standby"), "`{selected}` is selected");
    Ok(())
}
