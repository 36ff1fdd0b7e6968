//! Typing changes everything live.

use anyhow::Result;
use serde_json::json;
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

#[test]
fn shortening_a_path_s_opening_takes_the_plan_away_and_restoring_it_brings_it_back() -> Result<()> {
    let page = Opened::planned()?;
    let planned = page.look()?;
    let windows = page.state()?["plan"]["windows"].clone();

    page.place_caret_after("PATH1=OK [450,450")?;
    page.retype(7, "404,404")?;
    page.wait_for("state.status === 'no-plan'")?;
    page.settle()?;
    assert_eq!(page.state()?["plan"], json!(null));
    assert!(page.look()?.difference(&planned) > 0.01, "the picture did not change");

    page.retype(7, "450,450")?;
    page.wait_for("state.status === 'plan'")?;
    assert_eq!(page.state()?["plan"]["windows"], windows);
    Ok(())
}

#[test]
fn a_syntax_error_keeps_the_last_good_network_and_points_at_the_cause() -> Result<()> {
    let page = Opened::planned()?;
    let network = page.state()?["tpn"].clone();

    page.place_caret_after("choose {")?;
    page.tab.press(Key::Backspace, Modifiers::NONE)?;
    page.wait_for("state.diagnostics.length > 0")?;
    page.settle()?;
    let state = page.state()?;
    assert_eq!(state["status"], "broken");
    assert_eq!(state["isStale"], true);
    assert_eq!(state["tpn"], network);
    assert!(state["diagnostics"][0]["span"]["line"].as_u64() > Some(1), "{}", state["diagnostics"]);

    page.type_text("{")?;
    page.wait_for("state.status === 'plan' && !state.isStale")?;
    let diagnostics = page.state()?["diagnostics"].clone();
    assert!(diagnostics.as_array().is_some_and(|all| all.iter().all(|it| it["severity"] != "error")));
    Ok(())
}

#[test]
fn every_key_press_is_a_revision_and_undo_takes_it_back() -> Result<()> {
    let page = Opened::planned()?;
    let before = page.tab.evaluate("enroute.source()")?;
    let revision = page.state()?["revision"].clone();

    page.place_caret_after("scenario Day1")?;
    page.type_text("x")?;
    page.tab.wait_until("enroute.source().includes('scenario Day1x')")?;
    assert!(page.state()?["revision"].as_u64() > revision.as_u64());

    page.tab.press(Key::Character('z'), Modifiers::CONTROL)?;
    page.tab.wait_until(&format!("enroute.source() === {before}"))?;
    page.wait_for("!state.isStale")
}

#[test]
fn a_mission_is_written_with_real_keys_templates_pairs_and_several_carets() -> Result<()> {
    let page = Opened::planned()?;
    let is_source = |text: &str| page.tab.wait_until(&format!("enroute.source() === {}", json!(text)));
    page.place_caret_after("scenario Day1")?;
    page.tab.press(Key::Character('a'), Modifiers::CONTROL)?;
    page.tab.press(Key::Delete, Modifiers::NONE)?;
    is_source("")?;

    // A bracket comes with its partner, which is typed over, and a block comes out as typed.
    page.type_text("primitive Go()[1,2];\nscenario S = {\n")?;
    is_source("primitive Go()[1,2];\nscenario S = {\n  \n}")?;
    page.type_text("Go();\nGo()\n}")?;
    is_source("primitive Go()[1,2];\nscenario S = {\n  Go();\n  Go()\n}")?;
    page.wait_for("state.status === 'plan' && !state.isStale")?;

    // The same word three times, typed over at once; Escape leaves one caret and the keyboard in the text.
    page.place_caret_after("primitive G")?;
    for _ in 0..3 {
        page.tab.press(Key::Character('d'), Modifiers::CONTROL)?;
    }
    page.type_text("Run")?;
    is_source("primitive Run()[1,2];\nscenario S = {\n  Run();\n  Run()\n}")?;
    page.tab.press(Key::Escape, Modifiers::NONE)?;
    page.type_text("m")?;
    page.tab.wait_until("enroute.source().split('Runm').length === 2")?;
    page.tab.press(Key::Character('z'), Modifiers::CONTROL)?;

    // A caret below, a line copied, a line selected and deleted.
    page.place_caret_after("  Run();")?;
    page.tab.press(Key::ArrowDown, Modifiers::CONTROL | Modifiers::ALT)?;
    page.type_text(" ")?;
    page.tab.wait_until("enroute.source().includes('Run(); \\n  Run() \\n')")?;
    page.tab.press(Key::Escape, Modifiers::NONE)?;
    page.tab.press(Key::ArrowDown, Modifiers::ALT | Modifiers::SHIFT)?;
    page.tab.wait_until("enroute.source().split('Run()').length === 5")?;
    page.tab.press(Key::Character('l'), Modifiers::CONTROL)?;
    page.tab.press(Key::Delete, Modifiers::NONE)?;
    page.tab.wait_until("enroute.source().split('Run()').length === 4")?;
    Ok(())
}

#[test]
fn a_mission_of_two_files_is_written_with_real_keys_planned_and_there_after_a_reload() -> Result<()> {
    let page = Opened::planned()?;
    page.place_caret_after("scenario Day1")?;
    page.tab.press(Key::Character('a'), Modifiers::CONTROL)?;
    page.tab.press(Key::Delete, Modifiers::NONE)?;
    page.type_text("import \"world.rmpl\";\nscenario S = { Go(BASE) }")?;
    page.wait_for("state.diagnostics.some(it => it.message.includes('no file `world.rmpl`'))")?;
    // The fix of the import adds the file, and what is typed there counts.
    page.place_caret_after("import \"wor")?;
    page.tab.press(Key::Character('.'), Modifiers::CONTROL)?;
    page.tab.press(Key::Enter, Modifiers::NONE)?;
    page.tab.wait_until("enroute.source().endsWith('\\n\\u001cworld.rmpl\\n')")?;
    page.tab.press(Key::End, Modifiers::CONTROL)?;
    page.type_text("primitive Go(place)[1,2];\nlocation BASE (0, 0);")?;
    page.wait_for("state.status === 'plan' && !state.isStale")?;
    let text = page.tab.evaluate("enroute.source()")?;
    // A name of one file is changed in both; Backspace at a file's first line keeps its name.
    page.place_caret_after("location BAS")?;
    page.tab.press(Key::Function(2), Modifiers::NONE)?;
    page.wait_for("state.dialog === 'rename'")?;
    page.type_text("HOME")?;
    page.tab.press(Key::Enter, Modifiers::NONE)?;
    page.tab.wait_until("enroute.source().split('HOME').length === 3")?;
    page.tab.press(Key::Character('z'), Modifiers::CONTROL)?;
    page.place_caret_after("\u{1c}world.rmpl\n")?;
    page.tab.press(Key::Backspace, Modifiers::NONE)?;
    page.tab.wait_until(&format!("enroute.source() === {text}"))?;
    page.tab.evaluate("window.isOldPage = true; location.reload()")?;
    page.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
    page.tab.wait_until_ready()?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, text);
    Ok(())
}

#[test]
fn long_lines_are_wrapped_by_a_key_and_the_caret_goes_down_within_them() -> Result<()> {
    let page = Opened::planned()?;
    let line = format!("// {}", "word ".repeat(80).trim_end());
    page.tab.evaluate(&format!(
        "enroute.setSource({})",
        json!(format!("{line}\nscenario S = {{ delay[1,2] }}"))
    ))?;
    page.settle()?;
    page.place_caret_after("// ")?;
    let down = |condition: &str| -> Result<()> {
        page.tab.press(Key::ArrowDown, Modifiers::NONE)?;
        page.wait_for(condition)
    };
    down(&format!("state.caret.head > {}", line.len()))?;
    page.place_caret_after("// ")?;
    page.tab.press(Key::Character('z'), Modifiers::ALT)?;
    page.tab.next_frame()?;
    page.tab.next_frame()?;
    down(&format!("state.caret.head > 20 && state.caret.head < {}", line.len()))?;
    page.tab.press(Key::Home, Modifiers::NONE)?;
    page.tab.press(Key::Character('x'), Modifiers::NONE)?;
    page.tab.wait_until("enroute.source().includes(' xword') && !enroute.source().includes('// xword')")?;
    Ok(())
}
