//! The canvas is really drawn, and what the user does changes it.

use anyhow::Result;
use xtask::browser::{Graphics, Key, Modifiers};

use crate::opened::Opened;

#[test]
fn the_page_is_drawn_in_many_colors() -> Result<()> {
    let page = Opened::planned()?;
    let picture = page.look()?;
    assert!(picture.colors() > 50, "only {} colors", picture.colors());
    assert!(picture.drawn() > 0.05, "only {} of the page differs from the ground", picture.drawn());
    Ok(())
}

#[test]
fn playing_moves_time_and_vehicles_and_the_picture() -> Result<()> {
    let page = Opened::planned()?;
    let before = page.look()?;
    let vehicles = page.state()?["vehicles"].clone();
    assert_eq!(vehicles.as_array().map(Vec::len), Some(2), "{vehicles}");

    page.tab.press(Key::Character(' '), Modifiers::NONE)?;
    page.wait_for("state.isPlaying && state.time > 0")?;
    page.tab.press(Key::Character(' '), Modifiers::NONE)?;
    page.wait_for("!state.isPlaying")?;
    page.tab.evaluate("enroute.dispatch('play.seek', { time: 200 })")?;
    page.wait_for("state.time === 200")?;
    assert_ne!(page.state()?["vehicles"], vehicles);
    assert!(page.look()?.difference(&before) > 0.0005, "the picture did not change");
    Ok(())
}

#[test]
fn dragging_over_the_terrain_turns_the_view() -> Result<()> {
    let page = Opened::planned()?;
    let terrain = page.tab.widget("img", "Terrain")?;
    let (x, y) = terrain.center();
    page.tab.hover(x, y)?;
    let before = page.tab.screenshot_of(&terrain)?;
    page.tab.drag(&[(x, y), (x + 40.0, y + 10.0), (x + 90.0, y + 20.0)])?;
    page.tab.next_frame()?;
    let turned = page.tab.screenshot_of(&terrain)?;
    assert!(turned.difference(&before) > 0.01, "only {}", turned.difference(&before));

    page.tab.wheel(x, y, -240.0)?;
    page.tab.next_frame()?;
    let nearer = page.tab.screenshot_of(&terrain)?;
    assert!(nearer.difference(&turned) > 0.01, "only {}", nearer.difference(&turned));
    Ok(())
}

#[test]
fn web_gpu_draws_the_page_where_there_is_one() -> Result<()> {
    let page = Opened::without_waiting(Graphics::WebGpu, "mission=enroute")?;
    page.tab.wait_until_ready()?;
    page.settle()?;
    assert_eq!(page.state()?["renderer"], "webgpu");
    let picture = page.look()?;
    assert!(picture.colors() > 50, "only {} colors", picture.colors());
    Ok(())
}
