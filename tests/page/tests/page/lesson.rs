//! Lessons in the page: keys that go from stop to stop, a task done in the text, and what a reload brings back.

use anyhow::Result;
use serde_json::json;
use xtask::browser::{Key, Modifiers};

use crate::opened::Opened;

#[test]
fn keys_go_from_stop_to_stop_and_the_drawings_follow() -> Result<()> {
    let page = Opened::with_fragment("lesson=negative-cycle&stop=2")?;
    page.settle()?;
    page.wait_for("state.lesson.open && !state.lesson.open.isDue && state.search.step > 0")?;
    assert_eq!(page.state()?["selection"]["name"], "D1");
    let decided = page.look()?;
    page.tab.press(Key::Character('n'), Modifiers::NONE)?;
    page.wait_for("state.lesson.open.stop === 3 && state.search.known?.event === 'inconsistent'")?;
    assert!(page.look()?.difference(&decided) > 0.01, "the drawings show the cycle");
    let state = page.state()?;
    assert!(
        state["lesson"]["open"]["prose"].as_str().is_some_and(|prose| prose.contains("15 minutes")),
        "{state}"
    );
    page.tab.press(Key::Character('n'), Modifiers::SHIFT)?;
    page.wait_for("state.lesson.open.stop === 2")?;
    assert_eq!(page.state()?["panels"], json!(["lesson", "network", "search"]));
    Ok(())
}
