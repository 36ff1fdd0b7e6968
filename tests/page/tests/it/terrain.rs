//! The terrain as the browser draws it, and maps that are dropped on it.

use anyhow::Result;

use crate::opened::Opened;

/// The page on a mission, its terrain alone and seen from straight above.
fn from_above(mission: &str) -> Result<Opened> {
    let page = Opened::with_fragment(&format!("mission={mission}&workspace=review"))?;
    page.settle()?;
    for panel in ["review", "compare", "timeline", "network", "plan", "editor", "problems", "outline"] {
        page.tab.evaluate(&format!("enroute.dispatch('view.closePanel', {{ name: '{panel}' }})"))?;
    }
    page.tab.widget("img", "Terrain")?;
    page.tab.evaluate("enroute.dispatch('terrain.top')")?;
    page.tab.next_frame()?;
    // The camera has arrived when names stand still over several frames; while it flies, each frame moves them.
    page.tab.wait_until(
        "(async () => {
            const before = JSON.stringify(enroute.widgets('text', 'on the map'));
            for (let frame = 0; frame < 6; frame += 1) await new Promise(requestAnimationFrame);
            return before.length > 2 && before === JSON.stringify(enroute.widgets('text', 'on the map'));
        })()",
    )?;
    Ok(page)
}

#[test]
fn the_search_tree_grows_and_the_clearance_map_covers_the_ground() -> Result<()> {
    let page = from_above("detour")?;
    let terrain = page.tab.widget("img", "Terrain")?;
    let bare = page.tab.screenshot_of(&terrain)?;
    page.tab.evaluate("enroute.dispatch('terrain.clearance')")?;
    page.wait_for("state.terrain.clearance")?;
    page.tab.next_frame()?;
    let covered = page.tab.screenshot_of(&terrain)?;
    assert!(covered.difference(&bare) > 0.05, "only {}", covered.difference(&bare));
    page.tab.evaluate("enroute.dispatch('terrain.growth')")?;
    page.wait_for("state.terrain.growth?.total > 0")?;
    page.tab.click_widget("button", "Go to last sample")?;
    page.wait_for("state.terrain.growth.samples === state.terrain.growth.total")?;
    assert!(page.state()?["terrain"]["growth"]["length"].as_f64() > Some(0.0));
    Ok(())
}

#[test]
fn a_map_file_dropped_on_the_page_is_read_and_a_broken_one_is_explained() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.drop_file("broken.pgm", b"P5 30 30 255 ")?;
    page.wait_for("state.toasts.some((toast) => toast.includes('import map broken.pgm'))")?;
    page.tab.drop_file("level.pgm", &[b"P5 30 30 255 ".as_slice(), &[b'x'; 900]].concat())?;
    page.wait_for("state.toasts.some((toast) => toast.includes('30 × 30 cells'))")?;
    let text = "terrain \"level.pgm\" cell 10;\\nprimitive Wait()[0,5];\\nscenario S = { Wait() }";
    page.tab.evaluate(&format!("enroute.setSource('{text}')"))?;
    page.wait_for("state.status === 'plan' && state.diagnostics.length === 0")
}
