//! The page as a document: what screen readers and voice control find and use.

use anyhow::Result;
use serde_json::{Value, json};
use xtask::browser::{Key, Modifiers, axe_script};

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
    page.type_text("x")?;
    page.tab.wait_until("enroute.source().trimEnd().endsWith('x')")?;
    Ok(())
}

/// Buttons that stay pressed: all others only select something.
const TOGGLES: [&str; 5] = ["Add obstacle…", "Measure", "Path points", "Place", "Search tree"];

#[test]
fn what_selects_something_says_whether_it_is_current_and_is_not_pressed() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.widget("textbox", "Mission text")?;
    for workspace in ["author", "teach", "review", "execute"] {
        page.tab
            .evaluate(&format!("enroute.dispatch('view.workspace', {})", json!({ "name": workspace })))?;
        page.settle()?;
        let pressed = page.tab.evaluate(
            "[...document.querySelectorAll('#accessibility [aria-pressed]')].map((it) => it.getAttribute('aria-label'))",
        )?;
        let pressed = pressed.as_array().cloned().unwrap_or_default();
        let others: Vec<&Value> =
            pressed.iter().filter(|name| !TOGGLES.iter().any(|toggle| *name == toggle)).collect();
        assert!(others.is_empty(), "{workspace}: {others:?}");
    }
    page.tab.evaluate("enroute.dispatch('view.workspace', { name: 'author' })")?;
    page.tab.evaluate("enroute.dispatch('go.select', { name: 'Group-Wait#1' })")?;
    page.tab.wait_until("document.querySelectorAll('[role=button][aria-current=true][aria-label*=\"Group-Wait\"]').length > 1")?;
    Ok(())
}

/// A browser treats everything within an element that has a listener as clickable, and a screen reader says so.
#[test]
fn nothing_is_clickable_because_of_what_it_lies_in() -> Result<()> {
    let page = Opened::planned()?;
    for parent in ["document.getElementById('accessibility')", "document.body", "document.documentElement"] {
        let object = page.tab.call("Runtime.evaluate", &json!({ "expression": parent }))?;
        let listeners = page
            .tab
            .call("DOMDebugger.getEventListeners", &json!({ "objectId": object["result"]["objectId"] }))?;
        let kinds: Vec<&Value> =
            listeners["listeners"].as_array().into_iter().flatten().map(|it| &it["type"]).collect();
        assert!(!kinds.iter().any(|kind| **kind == "click" || **kind == "mousedown"), "{parent}: {kinds:?}");
    }
    Ok(())
}

/// A screen reader takes the focus from everything while its user reads.
#[test]
fn a_key_is_heard_and_its_outcome_told_while_nothing_has_the_focus() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.click_widget("textbox", "Mission text")?;
    page.wait_for("state.activePanel === 'editor'")?;
    page.tab.evaluate("document.activeElement.blur()")?;
    page.tab.wait_until("document.activeElement === document.body")?;
    page.tab.press(Key::Function(6), Modifiers::NONE)?;
    page.wait_for("state.activePanel !== 'editor'")?;
    page.tab.wait_until(
        "document.getElementById(document.activeElement.getAttribute('aria-activedescendant'))
            ?.getAttribute('role') === 'group'",
    )?;
    Ok(())
}

/// Who follows a link to a term with the keyboard reads on in the manual.
#[test]
fn a_page_of_the_manual_that_is_opened_has_the_keyboard() -> Result<()> {
    let page = Opened::with_fragment("lesson=choices&stop=4")?;
    page.settle()?;
    page.tab.evaluate("enroute.dispatch('help.page', { page: 'glossary' })")?;
    page.tab.wait_until(
        "document.getElementById(document.activeElement?.getAttribute('aria-activedescendant'))
            ?.getAttribute('aria-label')?.includes('Manual')",
    )?;
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

#[test]
fn the_document_has_landmarks_headings_menus_tabs_and_tables() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.widget("textbox", "Mission text")?;
    let count = |selector: &str| -> Result<u64> {
        let found = page.tab.evaluate(&format!("document.querySelectorAll({}).length", json!(selector)))?;
        Ok(found.as_u64().unwrap_or_default())
    };
    for landmark in ["banner", "main", "contentinfo"] {
        assert_eq!(count(&format!("#accessibility [role={landmark}]"))?, 1, "{landmark}");
    }
    assert!(count("[role=main] [role=region][aria-label='Network panel'] [role=img]")? > 0);
    assert_eq!(count("[role=heading][aria-level='1']")?, 1);
    assert!(count("[role=region][aria-label='Plan panel'] [role=heading]")? > 1);
    assert!(count("[role=menubar] > [role=menuitem]")? > 0);
    assert!(count("[role=tablist] > [role=tab][aria-selected=true]")? > 1);
    assert_eq!(count("[role=tablist] > :not([role=tab], span)")?, 0, "only tabs are in a list of tabs");
    page.tab.evaluate("enroute.dispatch('help.keys', null)")?;
    page.tab.wait_until("document.querySelector('[role=dialog] [role=table] [role=row] [role=cell]')")?;
    Ok(())
}

#[test]
fn the_windows_of_a_plan_are_a_table_of_four_columns() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.evaluate("enroute.setSource('scenario S = { delay[1,2] }')")?;
    page.wait_for("state.status === 'plan' && !state.isStale")?;
    let table = "document.querySelector('[role=table][aria-label=Windows]')";
    page.tab.wait_until(&format!("{table}?.querySelectorAll('[role=row] > [role=cell]').length >= 8"))?;
    let columns = page.tab.evaluate(&format!(
        "[...{table}.querySelectorAll('[role=row]')].map((row) => row.querySelectorAll(':scope > [role]').length)"
    ))?;
    let columns = columns.as_array().cloned().unwrap_or_default();
    assert!(columns.len() > 2 && columns.iter().all(|it| *it == json!(4)), "{columns:?}");
    // Of the mission's start, which is when it is: at 0, at the latest 0, without slack.
    let cells = format!("[...{table}.querySelectorAll('[role=row]')[1].querySelectorAll('[role=cell]')]");
    let texts = page.tab.evaluate(&format!("{cells}.slice(1).map((cell) => cell.textContent)"))?;
    assert_eq!(texts, json!(["0", "0", "0"]));
    Ok(())
}

#[test]
fn what_becomes_of_the_plan_and_each_step_is_announced() -> Result<()> {
    let page = Opened::planned()?;
    let says = |words: &str| {
        let question =
            format!("document.getElementById('announcements').textContent.includes({})", json!(words));
        page.tab.wait_until(&question).map(|_| ())
    };
    says("Plan found and verified.")?;
    page.tab.evaluate("enroute.setSource('location A (1, 2);\\nlocation A (1, 2);')")?;
    says("error")?;
    says("Line ")?;
    page.tab.evaluate("enroute.open('enroute')")?;
    says("Plan found and verified.")?;
    page.tab.evaluate("enroute.dispatch('view.workspace', 'teach')")?;
    page.wait_for("state.search.steps > 1")?;
    page.tab.evaluate("enroute.dispatch('search.goTo', { step: 2 })")?;
    says("Step 2 of ")
}

#[test]
fn the_theme_follows_the_system_until_one_is_chosen() -> Result<()> {
    let page = Opened::planned()?;
    page.wait_for("state.theme === 'dark'")?;
    page.tab.prefer(&[("prefers-color-scheme", "light")])?;
    page.wait_for("state.theme === 'light'")?;
    page.tab.evaluate("enroute.dispatch('view.setTheme', { theme: 'dark' })")?;
    page.wait_for("state.theme === 'dark'")?;
    page.tab.evaluate("enroute.dispatch('view.systemTheme', null)")?;
    page.wait_for("state.theme === 'light'")
}

/// Returns what axe-core finds wrong in the page as it stands: rule, how grave, and the elements.
fn violations(page: &Opened, script: &str) -> Result<Value> {
    page.tab.evaluate(&format!("{script}; 0"))?;
    page.tab.evaluate(
        "axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => violations.flatMap(
            ({ id, impact, nodes }) => nodes.slice(0, 3).map(({ html }) => [id, impact, html.slice(0, 300)])))",
    )
}

/// The input that typing goes to stands beside the document: egui makes it, and moves it to the caret.
const STANDS_BESIDE: &str = "<input type=\"text\" autocapitalize=\"off\"";

#[test]
#[expect(clippy::print_stdout, reason = "what was not tried is said")]
fn axe_core_finds_nothing_wrong() -> Result<()> {
    let script = match axe_script() {
        Ok(script) => script,
        Err(reason) => {
            println!("axe-core did not run: {reason}");
            return Ok(());
        }
    };
    let page = Opened::planned()?;
    page.tab.widget("textbox", "Mission text")?;
    let views = [
        ("author", "enroute.dispatch('view.workspace', 'author')"),
        ("teach", "enroute.dispatch('view.workspace', 'teach')"),
        ("review", "enroute.dispatch('view.workspace', 'review')"),
        ("execute", "enroute.dispatch('view.workspace', 'execute')"),
        ("keys", "enroute.dispatch('help.keys', null)"),
        ("missions", "enroute.dispatch('file.missions', null)"),
    ];
    let mut found = Vec::new();
    for (name, act) in views {
        page.tab.evaluate(act)?;
        page.settle()?;
        let all = violations(&page, &script)?;
        let of_document = all.as_array().into_iter().flatten().filter(|violation| {
            let is_beside = violation[2].as_str().is_some_and(|html| html.starts_with(STANDS_BESIDE));
            !(violation[0] == "region" && is_beside)
        });
        found.extend(of_document.map(|violation| format!("{name}: {violation}")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    Ok(())
}
