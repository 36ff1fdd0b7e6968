//! How long the page's own code takes for a frame while drawings move, and how long a keystroke takes until what it
//! changes is drawn: measured in headless Chromium, at about 1,000 and 10,000 nodes.
//!
//! Then the same for a camera that turns over a terrain while four rovers drive on it.
//!
//! `cargo xtask bench page` prints the tables; `--development` takes the page built for development. Times of frames
//! are `enroute.state().timings.frame`: they leave out drawing, which this browser computes on the processor. The time
//! of a keystroke runs on the page's clock from the key to the state that says its answer is drawn.

use anyhow::{Context as _, Result, ensure};
use serde_json::{Value, json};
use tpn::generate::{Recipe, Tightness, mission};
use xtask::{
    browser::{Browser, Graphics, Key, Modifiers, Tab},
    server::SiteServer,
    site::{self, Flavour},
};

const SIZES: [usize; 2] = [1_000, 10_000];
/// Cells along the sides of maps.
const MAP_SIDES: [usize; 2] = [512, 2_048];
/// Steps of a drag, each a frame.
const STEPS: usize = 60;
/// Keys that are typed, each followed by its deletion.
const KEYS: usize = 30;

#[expect(clippy::print_stdout, reason = "printing its tables is what a benchmark is for")]
fn main() -> Result<()> {
    let is_development = std::env::args().any(|argument| argument == "--development");
    let flavour = if is_development { Flavour::Development } else { Flavour::Release };
    let site = site::build(flavour)?;
    let server = SiteServer::start(&site, 0, false)?;
    let browser = Browser::start(Graphics::WebGl2)?;
    println!("milliseconds on the page, p50 / p90 / p99, {flavour:?} build");
    println!(
        "| nodes | pan network | pan network, near | pan timeline | key to drawing | of it worked out |"
    );
    println!("|---|---|---|---|---|---|");
    for nodes in SIZES {
        let tab = browser.open_tab(1440, 900)?;
        tab.go_to(&format!("{}#mission=enroute&workspace=review", server.url()))?;
        tab.wait_until_ready()?;
        open(&tab, nodes)?;
        let far = pan(&tab, ("img", "Network"), 0)?;
        let near = pan(&tab, ("img", "Network"), 12)?;
        let timeline = pan(&tab, ("slider", "Time axis"), 0)?;
        let (keys, worked_out) = type_keys(&tab)?;
        let counted = tab.evaluate("enroute.state().tpn.nodes")?;
        println!("| {counted} | {far} | {near} | {timeline} | {keys} | {worked_out} |");
    }
    println!("\nmilliseconds on the page with four rovers under way, p50 / p90 / p99, {flavour:?} build");
    println!("| cells | turn, whole map | turn, near a rover |");
    println!("|---|---|---|");
    for side in MAP_SIDES {
        let tab = browser.open_tab(1440, 900)?;
        tab.go_to(&format!("{}#mission=enroute&workspace=review", server.url()))?;
        tab.wait_until_ready()?;
        open_map(&tab, side)?;
        let far = pan(&tab, ("img", "Terrain"), 0)?;
        tab.evaluate("enroute.dispatch('go.select', 'Rover1'); enroute.dispatch('terrain.follow')")?;
        let near = pan(&tab, ("img", "Terrain"), 4)?;
        println!("| {side} × {side} | {far} | {near} |");
    }
    Ok(())
}

/// Drops a hilly map of `side` × `side` cells on the page, opens a mission on it, lets it play, and leaves the terrain
/// alone on the screen.
fn open_map(tab: &Tab, side: usize) -> Result<()> {
    let mut map = format!("P5 {side} {side} 255\n").into_bytes();
    for cell in 0..side * side {
        let (row, column) = ((cell / side) as f64, (cell % side) as f64);
        map.push((100.0 + 50.0 * (row / 90.0).sin() * (column / 70.0).cos()) as u8);
    }
    tab.drop_file("hills.pgm", &map)?;
    tab.wait_until("enroute.state().toasts.some((toast) => toast.includes('hills.pgm is a map'))")?;
    let far = 10 * side - 200;
    let text = format!(
        "terrain \"hills.pgm\" cell 10;
         location A (200, 200); location B ({far}, 300); location C (300, {far}); location D ({far}, {far});
         vehicle Rover1 : ATRV at A; vehicle Rover2 : ATRV at A;
         vehicle Rover3 : ATRV at B; vehicle Rover4 : ATRV at C;
         primitive Go(to) moves Rover1, Rover2 speed (0, 1);
         primitive Cross(to) moves Rover3 speed (0, 1);
         primitive Climb(to) moves Rover4 speed (0, 1);
         scenario S = {{ Go(D), Cross(C), Climb(B) }}"
    );
    tab.evaluate(&format!("enroute.setSource({})", json!(text)))?;
    settle(tab)?;
    let status = tab.evaluate("enroute.state().status")?;
    ensure!(status == "plan", "the mission on the map of {side} cells is {status}");
    for panel in ["review", "compare", "timeline", "network", "plan", "editor", "problems", "outline"] {
        tab.evaluate(&format!("enroute.dispatch('view.closePanel', {{ name: '{panel}' }})"))?;
    }
    tab.evaluate("enroute.dispatch('play.toggle')")?;
    tab.next_frame()
}

fn open(tab: &Tab, nodes: usize) -> Result<()> {
    let text = mission(Recipe { nodes, tightness: Tightness::Feasible, seed: 1 });
    tab.evaluate(&format!("enroute.setSource({})", json!(text)))?;
    settle(tab)?;
    let status = tab.evaluate("enroute.state().status")?;
    ensure!(status == "plan", "the mission of {nodes} nodes is {status}");
    Ok(())
}

fn settle(tab: &Tab) -> Result<()> {
    tab.wait_until(
        "((state) => state.status !== 'working' && state.shownRevision === state.revision)(enroute.state())",
    )?;
    tab.next_frame()
}

/// The times of frames while a drawing is dragged to and fro, after turning the wheel so often to come nearer.
fn pan(tab: &Tab, (role, label): (&str, &str), turns: usize) -> Result<Spread> {
    let widget = tab.widget(role, label)?;
    // Below the axis lies the track; of the network, the middle.
    let (x, y) =
        if role == "slider" { (widget.centre().0, widget.y + widget.height + 60.0) } else { widget.centre() };
    for _ in 0..turns {
        tab.wheel(x, y, -120.0)?;
    }
    let mut times = Vec::new();
    let button = |kind: &str, x: f64| {
        let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1 });
        tab.call("Input.dispatchMouseEvent", &event)
    };
    tab.hover(x, y)?;
    button("mousePressed", x)?;
    for step in 0..STEPS {
        let away = 40.0 * (step as f64 / STEPS as f64 * std::f64::consts::TAU).sin();
        button("mouseMoved", x + 8.0 + away)?;
        tab.next_frame()?;
        times.push(number(&tab.evaluate("enroute.state().timings.frame")?)?);
    }
    button("mouseReleased", x)?;
    tab.next_frame()?;
    Ok(Spread::of(times))
}

/// The times from keys to their drawings, and what the stages and the layout take of it.
fn type_keys(tab: &Tab) -> Result<(Spread, Spread)> {
    let source = tab.evaluate("enroute.source()")?;
    let source = source.as_str().context("the source is a text")?;
    // The greatest duration of an activity in the middle of the text: a digit more leaves it plannable.
    let middle = source.len() / 2;
    let digit = |at: &usize| source.as_bytes()[at - 1].is_ascii_digit();
    let close = source[middle..].match_indices(']').map(|(at, _)| middle + at).find(digit);
    let caret = close.context("there are bounds")?;
    tab.click_widget("textbox", "Mission text")?;
    tab.evaluate(&format!("enroute.dispatch('edit.select', {{ start: {caret} }})"))?;
    tab.wait_until(&format!("enroute.state().caret.head === {caret}"))?;
    tab.evaluate("addEventListener('keydown', () => { window.pressed = performance.now(); }, true)")?;
    let (mut times, mut worked_out) = (Vec::new(), Vec::new());
    for index in 0..2 * KEYS {
        let revision = number(&tab.evaluate("enroute.state().revision")?)?;
        tab.evaluate(&format!(
            "window.answered = new Promise((resolve) => {{
                const end = enroute.subscribe((state) => {{
                    if (state.revision > {revision} && state.shownRevision === state.revision) {{
                        const timings = state.timings;
                        end();
                        resolve([performance.now() - window.pressed, timings.total + timings.frame]);
                    }}
                }});
            }}); 0"
        ))?;
        let key = if index % 2 == 0 { Key::Character('9') } else { Key::Backspace };
        tab.press(key, Modifiers::NONE)?;
        let answer = tab.evaluate("window.answered")?;
        times.push(number(&answer[0])?);
        worked_out.push(number(&answer[1])?);
        settle(tab)?;
    }
    Ok((Spread::of(times), Spread::of(worked_out)))
}

fn number(value: &Value) -> Result<f64> {
    value.as_f64().with_context(|| format!("a number, not {value}"))
}

/// How measured times are spread.
struct Spread([f64; 3]);

impl Spread {
    fn of(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        let at = |part: usize| times[((times.len() - 1) * part + 50) / 100];
        Self([50, 90, 99].map(at))
    }
}

impl std::fmt::Display for Spread {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [half, most, nearly_all] = self.0;
        write!(f, "{half:.1} / {most:.1} / {nearly_all:.1}")
    }
}
