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

/// Presses a key of some keyboard with Ctrl and Shift: what the keyboard calls it, and its place.
fn press_with_control_and_shift(page: &Opened, key: &str, code: &str, number: u32) -> Result<()> {
    let modifiers = (Modifiers::CONTROL | Modifiers::SHIFT).0;
    for kind in ["rawKeyDown", "keyUp"] {
        page.tab.call(
            "Input.dispatchKeyEvent",
            &json!({
                "type": kind, "key": key, "code": code, "windowsVirtualKeyCode": number, "modifiers": modifiers
            }),
        )?;
    }
    page.tab.next_frame()
}

#[test]
fn brackets_with_control_and_shift_work_on_american_german_and_french_keyboards() -> Result<()> {
    let page = Opened::planned()?;
    let text = "primitive Go()[1,2];\nscenario S[0,9] = {\n  Go();\n  Go()\n}\n";
    page.tab.evaluate(&format!("enroute.setSource({})", json!(text)))?;
    page.settle()?;
    let (open, close) = (text.find('{').unwrap_or_default(), text.find('}').unwrap_or_default());
    for key in ["|", "'", "µ"] {
        page.place_caret_after("[0,9] = ")?;
        press_with_control_and_shift(&page, key, "Backslash", 220)?;
        page.wait_for(&format!("[{close}, {}].includes(state.caret.head)", close + 1))
            .map_err(|reason| reason.context(format!("`{key}`, from {open}")))?;
    }
    Ok(())
}

#[test]
fn a_right_click_in_the_text_opens_a_menu() -> Result<()> {
    let page = Opened::planned()?;
    let text = page.tab.widget("textbox", "Mission text")?;
    let (x, y) = (text.x + 120.0, text.y + 40.0);
    for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
        let press = json!({ "type": kind, "x": x, "y": y, "button": "right", "clickCount": 1 });
        page.tab.call("Input.dispatchMouseEvent", &press)?;
        page.tab.next_frame()?;
    }
    page.tab.wait_until("enroute.widgets('menuitem', 'Go to definition').length > 0")?;
    Ok(())
}
