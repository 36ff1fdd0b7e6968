//! What the page itself takes of the processor for a frame while the network moves, and how long a keystroke takes
//! until what it changes is drawn, at about 1,000 and 10,000 nodes; then frames while a camera turns over a terrain on
//! which four rovers drive. Measured in headless Chromium.
//!
//! `cargo xtask bench page` prints the tables; `--development` takes the page built for development, `--no-build` the
//! page as it was last built, and `cargo bench --package xtask --bench page -- network` or `terrain` one table alone. The window is small and shows one drawing, since this browser draws on the
//! processor, which is not what is measured: times of frames are `enroute.state().timings.frame`, the app's own code,
//! and `frameWithShell`, with all that egui and eframe add on the page's thread. The time of a keystroke runs on the page's
//! clock from the key to `shownAt`, when the frame with its answer is handed over to be drawn.

use std::time::Instant;

use anyhow::{Context as _, Result, bail, ensure};
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
/// The window in CSS pixels.
const WINDOW: (u32, u32) = (800, 500);
/// Steps of a movement, each a frame that is measured.
const STEPS: usize = 40;
/// Keys that are typed, each followed by its deletion.
const KEYS: usize = 12;
/// The longest wait for a frame, and for the answer to an edit or a map.
const LIMIT_MILLIS: u32 = 30_000;
/// More panels than there are.
const MAX_PANELS: usize = 20;

#[expect(clippy::print_stdout, reason = "printing its tables is what a benchmark is for")]
fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().collect();
    let is_asked = |name: &str| arguments.iter().any(|argument| argument == name);
    let flavour = if is_asked("--development") { Flavour::Development } else { Flavour::Release };
    let site = if is_asked("--no-build") { flavour.folder() } else { site::build(flavour)? };
    let server = SiteServer::start(&site, 0, false)?;
    let browser = Browser::start(Graphics::WebGl2, 1.0)?;
    let bench = Bench { begun: Instant::now(), browser, url: server.url().to_owned() };
    let (width, height) = WINDOW;
    println!("milliseconds, p50 / p90 / worst; {flavour:?} build, {width} × {height} pixels\n");
    if !is_asked("terrain") {
        println!("| nodes | movement | app's own code | whole frame |\n|---|---|---|---|");
        let mut keystrokes = Vec::new();
        for nodes in SIZES {
            keystrokes.push(bench.measure_network(nodes)?);
        }
        println!(
            "\n| nodes | key to drawing | of it our own code | parse, compile | plan | frame with layout |\n\
             |---|---|---|---|---|---|"
        );
        for row in keystrokes {
            println!("{row}");
        }
    }
    if !is_asked("network") {
        println!("\n| cells | movement | app's own code | whole frame |\n|---|---|---|---|");
        for side in MAP_SIDES {
            bench.measure_terrain(side)?;
        }
    }
    Ok(())
}

/// A browser, and the page it goes to.
struct Bench {
    begun: Instant,
    browser: Browser,
    url: String,
}

impl Bench {
    #[expect(clippy::print_stderr, reason = "a benchmark of minutes says how far it is")]
    fn say(&self, what: &str) {
        eprintln!("{:4} s: {what}", self.begun.elapsed().as_secs());
    }

    fn open_page(&self) -> Result<Tab> {
        let tab = self.browser.open_context()?.open_tab(WINDOW.0, WINDOW.1)?;
        tab.go_to(&format!("{}#mission=enroute&workspace=author", self.url))?;
        tab.wait_until_ready()?;
        Ok(tab)
    }

    /// Prints the rows of frames, and answers the row of keystrokes.
    #[expect(clippy::print_stdout, reason = "each row is printed as soon as it is known")]
    fn measure_network(&self, nodes: usize) -> Result<String> {
        self.say(&format!("opening {nodes} nodes"));
        let tab = self.open_page()?;
        leave_alone(&tab, &["network"])?;
        let text = mission(Recipe { nodes, tightness: Tightness::Feasible, seed: 1 });
        set_source(&tab, &text, &format!("the mission of {nodes} nodes"))?;
        let counted = tab.evaluate("enroute.state().tpn.nodes")?;
        for (name, movement) in [
            ("pan, all of it in view", Movement::Pan),
            ("zoom in to single arcs and out", Movement::Zoom),
            ("pan, names legible", Movement::PanNear),
        ] {
            self.say(&format!("{counted} nodes: {name}"));
            let frames =
                movement.measure(&tab, "Network").with_context(|| format!("{name}, {counted} nodes"))?;
            println!("| {counted} | {name} | {frames} |");
        }
        self.say(&format!("{counted} nodes: typing"));
        tab.evaluate("enroute.dispatch('view.fit')")?;
        let keys = type_keys(&tab).with_context(|| format!("typing, {counted} nodes"))?;
        Ok(format!("| {counted} | {keys} |"))
    }

    #[expect(clippy::print_stdout, reason = "each row is printed as soon as it is known")]
    fn measure_terrain(&self, side: usize) -> Result<()> {
        self.say(&format!("opening a map of {side} × {side} cells"));
        let tab = self.open_page()?;
        leave_alone(&tab, &["terrain"])?;
        open_map(&tab, side)?;
        for (name, vehicle) in [("turn, whole map", None), ("turn, near a rover", Some("Rover1"))] {
            self.say(&format!("{side} × {side} cells: {name}"));
            if let Some(vehicle) = vehicle {
                tab.evaluate(&format!(
                    "enroute.dispatch('go.select', {{ name: '{vehicle}' }}); enroute.dispatch('terrain.follow')"
                ))?;
                next_frame(&tab)?;
            }
            let frames = Movement::Pan.measure(&tab, "Terrain").with_context(|| format!("{name}, {side}"))?;
            println!("| {side} × {side} | {name} | {frames} |");
        }
        Ok(())
    }
}

/// How a drawing is moved.
#[derive(Clone, Copy)]
enum Movement {
    /// Dragged to and fro.
    Pan,
    /// Nearer with the wheel until single arcs are large, and out again.
    Zoom,
    /// Dragged where names can be read.
    PanNear,
}

impl Movement {
    /// Moves the drawing of this name, and answers how long each frame took.
    fn measure(self, tab: &Tab, drawing: &str) -> Result<Frames> {
        let (x, y) = tab.widget("img", drawing)?.center();
        let mut frames = Frames::default();
        match self {
            Self::Zoom => {
                for step in 0..STEPS {
                    wheel(tab, (x, y), if step < STEPS / 2 { -120.0 } else { 120.0 })?;
                    frames.read(tab)?;
                }
                tab.evaluate("enroute.dispatch('view.fit')")?;
                next_frame(tab)?;
            }
            Self::PanNear => {
                for _ in 0..STEPS / 4 {
                    wheel(tab, (x, y), -120.0)?;
                }
                drag(tab, (x, y), &mut frames)?;
            }
            Self::Pan => drag(tab, (x, y), &mut frames)?,
        }
        Ok(frames)
    }
}

fn drag(tab: &Tab, (x, y): (f64, f64), frames: &mut Frames) -> Result<()> {
    let mouse = |kind: &str, x: f64| {
        let buttons = u8::from(kind != "mouseReleased");
        let event =
            json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1 });
        tab.call("Input.dispatchMouseEvent", &event)
    };
    tab.call("Input.dispatchMouseEvent", &json!({ "type": "mouseMoved", "x": x, "y": y }))?;
    next_frame(tab)?;
    mouse("mousePressed", x)?;
    for step in 0..STEPS {
        let turn = step as f64 / STEPS as f64 * std::f64::consts::TAU;
        mouse("mouseMoved", x + 8.0 + 60.0 * turn.sin())?;
        next_frame(tab)?;
        frames.read(tab)?;
    }
    mouse("mouseReleased", x)?;
    next_frame(tab)
}

fn wheel(tab: &Tab, (x, y): (f64, f64), delta: f64) -> Result<()> {
    let event = json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": delta });
    tab.call("Input.dispatchMouseEvent", &event)?;
    next_frame(tab)
}

/// Waits until the page has drawn twice: once with what was done before, once to show it.
fn next_frame(tab: &Tab) -> Result<()> {
    answer_of(
        tab,
        "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))",
    )?;
    Ok(())
}

/// The value of a promise, or an error if it takes too long.
fn answer_of(tab: &Tab, promise: &str) -> Result<Value> {
    tab.evaluate(&format!(
        "Promise.race([{promise}, new Promise((_, fail) => setTimeout(
            () => fail(new Error('no answer within {LIMIT_MILLIS} ms')), {LIMIT_MILLIS}))])"
    ))
}

/// The value of an expression once it is neither false nor an exception; an error if that takes too long.
fn wait_for(tab: &Tab, expression: &str) -> Result<Value> {
    let waiting = format!(
        "new Promise((done) => {{
            const end = performance.now() + {LIMIT_MILLIS};
            const look = () => {{
                let value = false;
                try {{ value = {expression}; }} catch {{}}
                if (value) done(value); else if (performance.now() < end) setTimeout(look, 30);
            }};
            look();
        }})"
    );
    answer_of(tab, &waiting).with_context(|| format!("waiting for `{expression}`"))
}

/// Closes all panels but these.
fn leave_alone(tab: &Tab, panels: &[&str]) -> Result<()> {
    tab.evaluate("enroute.dispatch('view.resetWorkspace')")?;
    next_frame(tab)?;
    for panel in panels {
        tab.evaluate(&format!("enroute.dispatch('view.panel', {{ name: '{panel}' }})"))?;
    }
    next_frame(tab)?;
    for _ in 0..MAX_PANELS {
        let open = tab.evaluate("enroute.state().panels")?;
        let open = open.as_array().context("panels are a list")?;
        let too_many: Vec<&str> =
            open.iter().filter_map(Value::as_str).filter(|panel| !panels.contains(panel)).collect();
        if too_many.is_empty() {
            ensure!(open.len() == panels.len(), "only {open:?} are on the screen");
            return Ok(());
        }
        for panel in too_many {
            tab.evaluate(&format!("enroute.dispatch('view.closePanel', {{ name: '{panel}' }})"))?;
        }
        next_frame(tab)?;
    }
    bail!("panels cannot be closed")
}

fn set_source(tab: &Tab, text: &str, what: &str) -> Result<()> {
    tab.evaluate(&format!("enroute.setSource({})", json!(text)))?;
    let status = wait_for(
        tab,
        "((state) => state.status !== 'working' && state.timings.shownAt && state.status)(enroute.state())",
    )?;
    ensure!(status == "plan", "{what} is {status}");
    next_frame(tab)
}

/// Drops a hilly map of `side` × `side` cells on the page, opens a mission on it, and lets it play.
fn open_map(tab: &Tab, side: usize) -> Result<()> {
    let mut map = format!("P5 {side} {side} 255\n").into_bytes();
    for cell in 0..side * side {
        let (row, column) = ((cell / side) as f64, (cell % side) as f64);
        map.push((100.0 + 50.0 * (row / 90.0).sin() * (column / 70.0).cos()) as u8);
    }
    tab.drop_file("hills.pgm", &map)?;
    wait_for(tab, "enroute.state().toasts.some((toast) => toast.includes(' cells'))")?;
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
    set_source(tab, &text, &format!("the mission on the map of {side} cells"))?;
    tab.evaluate("enroute.dispatch('play.toggle')")?;
    next_frame(tab)
}

/// From keys to their drawings: all of it, what is our own code, and of that the parts.
fn type_keys(tab: &Tab) -> Result<String> {
    leave_alone(tab, &["network", "editor"])?;
    let source = tab.evaluate("enroute.source()")?;
    let source = source.as_str().context("the source is a text")?;
    // The greatest duration of an activity in the middle of the text: a digit more leaves it plannable.
    let middle = source.len() / 2;
    let digit = |at: &usize| source.as_bytes()[at - 1].is_ascii_digit();
    let close = source[middle..].match_indices(']').map(|(at, _)| middle + at).find(digit);
    let caret = close.context("there are bounds")?;
    tab.click_widget("textbox", "Mission text")?;
    tab.evaluate(&format!("enroute.dispatch('edit.select', {{ start: {caret} }})"))?;
    wait_for(tab, &format!("enroute.state().caret.head === {caret}"))?;
    tab.evaluate("addEventListener('keydown', () => { window.pressed = performance.now(); }, true); 0")?;
    let mut columns = [const { Vec::new() }; 5];
    for index in 0..2 * KEYS {
        let revision = number(&tab.evaluate("enroute.state().revision")?)?;
        let key = if index % 2 == 0 { Key::Character('9') } else { Key::Backspace };
        tab.press(key, Modifiers::NONE)?;
        let answer = wait_for(
            tab,
            &format!(
                "(({{ revision, timings: it }}) => revision > {revision} && it.shownAt && [
                    it.shownAt - window.pressed, it.parse + it.compile + it.plan + it.answerFrame,
                    it.parse + it.compile, it.plan, it.answerFrame,
                ])(enroute.state())"
            ),
        )?;
        for (at, times) in columns.iter_mut().enumerate() {
            times.push(number(&answer[at])?);
        }
        next_frame(tab)?;
    }
    Ok(columns.map(spread).join(" | "))
}

fn number(value: &Value) -> Result<f64> {
    value.as_f64().with_context(|| format!("a number, not {value}"))
}

/// What measured frames took.
#[derive(Default)]
struct Frames {
    own: Vec<f64>,
    whole: Vec<f64>,
}

impl Frames {
    fn read(&mut self, tab: &Tab) -> Result<()> {
        let answer =
            tab.evaluate("((timings) => [timings.frame, timings.frameWithShell])(enroute.state().timings)")?;
        self.own.push(number(&answer[0])?);
        self.whole.push(number(&answer[1])?);
        Ok(())
    }
}

impl std::fmt::Display for Frames {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} | {}", spread(self.own.clone()), spread(self.whole.clone()))
    }
}

/// Returns how measured times are spread: half of them, nine in ten, and all are within.
fn spread(mut times: Vec<f64>) -> String {
    times.sort_by(f64::total_cmp);
    let at = |part: usize| times[((times.len() - 1) * part + 50) / 100];
    [50, 90, 100].map(|part| format!("{:.1}", at(part))).join(" / ")
}
