//! The tour: the page shows each step, and says when its task is done.

use anyhow::{Result, ensure};

use crate::opened::Opened;

#[test]
fn each_task_of_the_tour_is_checked_in_the_page() -> Result<()> {
    let page = Opened::with_fragment("lesson=tour&stop=1")?;
    page.wait_for("state.lesson.open && !state.lesson.open.isDue")?;
    let steps = page.state()?["lesson"]["open"]["stops"].as_u64().unwrap_or_default();
    ensure!(steps > 5, "{steps} steps");
    // The last step asks a question instead.
    for step in 1..steps {
        page.wait_for(&format!("state.lesson.open.stop === {step} && !state.lesson.open.isDue"))?;
        let question = page.state()?["lesson"]["open"]["question"].clone();
        ensure!(question["isRight"] != true, "step {step} is done before anybody does it: {question}");
        page.tab.click_widget("button", "Show me")?;
        page.wait_for("state.lesson.open.question.isRight")?;
        page.tab.click_widget("button", "Next")?;
    }
    page.wait_for(&format!("state.lesson.open.stop === {steps} && !state.lesson.open.isDue"))?;
    ensure!(page.tab.complaints().is_empty(), "{:?}", page.tab.complaints());
    Ok(())
}
