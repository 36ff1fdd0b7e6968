//! The terrain with the real mouse: measuring, moving, and an obstacle on the chosen path.

use anyhow::{Context as _, Result};

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

/// Where a named thing is in the window: right under its name.
fn place(page: &Opened, name: &str) -> Result<(f64, f64)> {
    let plate = page.tab.widget("text", &format!("{name} on the map"))?;
    Ok((plate.x + plate.width / 2.0, plate.y + plate.height + 3.0))
}

#[test]
fn an_obstacle_dragged_onto_the_first_path_makes_the_plan_take_the_second() -> Result<()> {
    let page = from_above("detour")?;
    let choice =
        |page: &Opened| -> Result<serde_json::Value> { Ok(page.state()?["plan"]["choices"]["D1"].clone()) };
    assert_eq!(choice(&page)?, 0);
    let source = page.tab.evaluate("enroute.source()")?;
    let (boulder, gap) = (place(&page, "Boulder")?, place(&page, "GAP")?);
    let steps = 6_u8;
    let way: Vec<(f64, f64)> = (0..=steps)
        .map(|step| {
            let part = f64::from(step) / f64::from(steps);
            (boulder.0 + part * (gap.0 - boulder.0), boulder.1 + part * (gap.1 - boulder.1))
        })
        .collect();
    // A drag that begins on what is not selected turns the view.
    page.tab.click(boulder.0, boulder.1)?;
    page.wait_for("state.selection?.name === 'Boulder'")?;
    page.tab.drag(&way)?;
    page.wait_for("state.plan?.choices.D1 === 1")?;
    page.settle()?;
    assert_ne!(page.tab.evaluate("enroute.source()")?, source);
    page.tab.evaluate("enroute.dispatch('edit.undo')")?;
    page.wait_for("state.plan?.choices.D1 === 0")?;
    assert_eq!(page.tab.evaluate("enroute.source()")?, source);
    Ok(())
}

#[test]
fn two_clicks_of_the_mouse_measure_the_ground_between_them() -> Result<()> {
    let page = from_above("detour")?;
    page.tab.click_widget("button", "Measure")?;
    page.wait_for("state.terrain.tool === 'measure'")?;
    for name in ["CAMP", "LANDER"] {
        let (x, y) = place(&page, name)?;
        page.tab.click(x, y)?;
    }
    page.wait_for("state.terrain.points.length === 2")?;
    let image = page.tab.widget("img", "Measured")?;
    let straight = image.label.split("Straight ").nth(1).and_then(|rest| rest.split(" m").next());
    let metres: f64 = straight.context("a distance")?.parse()?;
    // The camp is at (116, 72) and the lander at (288, 72).
    assert!((metres - 172.0).abs() < 6.0, "{}", image.label);
    page.tab.widget("img", "Height profile")?;
    Ok(())
}

#[test]
fn the_wheel_brings_the_ground_nearer() -> Result<()> {
    let page = from_above("detour")?;
    let terrain = page.tab.widget("img", "Terrain")?;
    let (x, y) = terrain.centre();
    page.tab.hover(x, y)?;
    let before = page.tab.screenshot_of(&terrain)?;
    page.tab.wheel(x, y, -300.0)?;
    page.tab.next_frame()?;
    let nearer = page.tab.screenshot_of(&terrain)?;
    assert!(nearer.difference(&before) > 0.02, "only {}", nearer.difference(&before));
    Ok(())
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
    page.tab.click_widget("button", "To the end of the search")?;
    page.wait_for("state.terrain.growth.samples === state.terrain.growth.total")?;
    assert!(page.state()?["terrain"]["growth"]["length"].as_f64() > Some(0.0));
    Ok(())
}

#[test]
fn a_map_file_dropped_on_the_page_is_read_and_a_broken_one_is_explained() -> Result<()> {
    let page = Opened::planned()?;
    page.tab.drop_file("broken.pgm", b"P5 30 30 255 ")?;
    page.wait_for("state.toasts.some((toast) => toast.includes('broken.pgm cannot be used'))")?;
    page.tab.drop_file("level.pgm", &[b"P5 30 30 255 ".as_slice(), &[b'x'; 900]].concat())?;
    page.wait_for("state.toasts.some((toast) => toast.includes('30 × 30 cells'))")?;
    let text = "terrain \"level.pgm\" cell 10;\\nprimitive Wait()[0,5];\\nscenario S = { Wait() }";
    page.tab.evaluate(&format!("enroute.setSource('{text}')"))?;
    page.wait_for("state.status === 'plan' && state.diagnostics.length === 0")
}
