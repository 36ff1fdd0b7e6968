//! The editor's help with real keys: complete, hover, rename, fix, format.
//!
//! With `ENROUTE_RECORDING` naming a folder, a picture of the page after each press is kept there.

use anyhow::{Result, bail};
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

/// A mission small enough to be read whole, with everything in it still to be done.
const MISSION: &str = "var LAMP : {ON, OFF};
primitive Drive(to)[2,4];
location   Ridge (10,20);
scenario Survey = { Drive(Ridge) };
";

struct Recording {
    page: Opened,
    count: u32,
}

impl Recording {
    fn of(source: &str) -> Result<Self> {
        let page = Opened::with_fragment("")?;
        page.tab.evaluate(&format!("enroute.setSource({})", serde_json::to_string(source)?))?;
        page.settle()?;
        Ok(Self { page, count: 0 })
    }

    fn keep(&mut self, name: &str) -> Result<()> {
        self.count += 1;
        self.page.keep_picture(&format!("{name}-{:02}", self.count))
    }

    fn press(&mut self, key: Key, modifiers: Modifiers) -> Result<()> {
        self.page.tab.press(key, modifiers)?;
        self.keep("press")
    }

    fn source_has(&self, text: &str) -> Result<()> {
        let text = serde_json::to_string(text)?;
        self.page.tab.wait_until(&format!("enroute.source().includes({text})"))?;
        Ok(())
    }

    fn widget(&self, role: &str, label: &str) -> Result<()> {
        let (role, label) = (serde_json::to_string(role)?, serde_json::to_string(label)?);
        self.page.tab.wait_until(&format!("enroute.widgets({role}, {label}).length > 0"))?;
        Ok(())
    }
}

#[test]
fn keys_complete_a_value_rename_a_name_fix_a_mistake_and_format_the_text() -> Result<()> {
    let mut recording = Recording::of(MISSION)?;

    // Completion knows that a variable's value is wanted, and Tab takes the chosen one.
    recording.page.place_caret_after("Drive(Ridge)")?;
    recording.page.type_text("; LAMP=")?;
    recording.widget("option", "ON")?;
    recording.widget("option", "OFF")?;
    recording.keep("complete")?;
    recording.press(Key::Tab, Modifiers::NONE)?;
    recording.page.tab.wait_until("/LAMP=O(N|FF) }/.test(enroute.source())")?;

    // F2 renames the declaration and the call at once, as one step of undo.
    recording.page.place_caret_after("primitive Dri")?;
    recording.press(Key::Function(2), Modifiers::NONE)?;
    recording.page.wait_for("state.dialog === 'rename'")?;
    recording.press(Key::Character('a'), Modifiers::CONTROL)?;
    recording.page.type_text("Go")?;
    recording.press(Key::Enter, Modifiers::NONE)?;
    recording.source_has("primitive Go(to)")?;
    recording.source_has("{ Go(Ridge)")?;
    recording.press(Key::Character('z'), Modifiers::CONTROL)?;
    recording.source_has("{ Drive(Ridge)")?;
    recording.press(Key::Character('y'), Modifiers::CONTROL)?;
    recording.source_has("{ Go(Ridge)")?;

    // A wrong name is told, and Control with the full stop fixes it.
    recording.page.place_caret_after("Survey = { Go")?;
    recording.page.type_text("o")?;
    recording.page.wait_for("state.diagnostics.some((it) => it.code === 'W-UNDEF')")?;
    recording.press(Key::Escape, Modifiers::NONE)?;
    recording.press(Key::Character('.'), Modifiers::CONTROL)?;
    recording.press(Key::Enter, Modifiers::NONE)?;
    recording.source_has("{ Go(Ridge)")?;
    recording.page.wait_for("!state.diagnostics.some((it) => it.code === 'W-UNDEF')")?;

    // Alt, Shift and F give the text its canonical spaces.
    recording.press(Key::Character('f'), Modifiers::ALT | Modifiers::SHIFT)?;
    recording.source_has("\nlocation Ridge (10, 20);\n")?;
    recording.keep("formatted")?;
    Ok(())
}

#[test]
fn resting_on_a_call_shows_its_signature() -> Result<()> {
    let mut recording = Recording::of(MISSION)?;
    let editor = recording.page.tab.widget("textbox", "Mission text")?;
    // Down the column in which the call stands, until the pointer is on it.
    let shows_signature = "enroute.widgets('text', 'primitive Drive(to)').length > 0";
    for step in 0..20 {
        recording.page.tab.hover(editor.x + 215.0, editor.y + 8.0 * f64::from(step))?;
        let rested = format!(
            "new Promise((resolve) => {{
                const end = performance.now() + 1500;
                const look = () => {{
                    if ({shows_signature} || performance.now() > end) resolve({shows_signature});
                    else setTimeout(look, 20);
                }};
                look();
            }})"
        );
        if recording.page.tab.evaluate(&rested)? == true {
            return recording.keep("hover");
        }
    }
    recording.keep("nowhere")?;
    bail!(
        "no place of the column shows the signature: {}",
        recording.page.tab.evaluate("enroute.widgets('text').map((it) => it.label)")?
    )
}
