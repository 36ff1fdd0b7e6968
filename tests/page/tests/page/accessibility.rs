//! The page as a document: what screen readers and voice control find and use.

use anyhow::Result;
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

#[test]
fn widgets_are_found_by_role_and_name_where_they_are_drawn() -> Result<()> {
    let page = Opened::planned()?;
    let editor = page.tab.widget("textbox", "Mission text")?;
    assert!(editor.width > 200.0 && editor.height > 200.0, "{editor:?}");
    let network = page.tab.widget("img", "Network")?;
    assert!(network.x >= editor.x + editor.width, "{network:?} overlaps {editor:?}");
    page.tab.click_widget("button", "Teach")?;
    page.wait_for("state.workspace === 'teach'")
}

#[test]
fn clicking_an_element_of_the_document_clicks_the_widget() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.widget("button", "Review")?;
    page.tab.evaluate("document.querySelector('[role=button][aria-label=Review]').click()")?;
    page.wait_for("state.workspace === 'review'")
}

#[test]
fn focusing_an_element_of_the_document_sends_keys_to_the_widget() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.widget("textbox", "Mission text")?;
    page.tab.evaluate("document.querySelector('[role=textbox][aria-label=\"Mission text\"]').focus()")?;
    page.tab.wait_until("document.querySelector('[aria-activedescendant]')")?;
    page.tab.press(Key::End, Modifiers::CONTROL)?;
    page.tab.type_text("x")?;
    page.tab.wait_until("enroute.source().trimEnd().endsWith('x')")?;
    Ok(())
}

#[test]
fn everything_that_takes_input_has_a_name() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.widget("textbox", "Mission text")?;
    let nameless = page.tab.evaluate(
        "['button', 'checkbox', 'combobox', 'link', 'radio', 'slider', 'spinbutton', 'textbox']
            .flatMap((role) => enroute.widgets(role))
            .filter((widget) => !widget.label)
            .map((widget) => JSON.stringify(widget))",
    )?;
    assert_eq!(nameless, serde_json::json!([]));
    Ok(())
}
