//! Kills the browser at random moments while someone types, starts it again on what it stored, and counts the key presses
//! that are lost and how old they were: `cargo xtask disturb --kill`.

use std::{
    fmt::{self, Display, Formatter},
    path::{Path, PathBuf},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result, bail, ensure};
use serde_json::{Value, json};

use crate::{
    browser::{Browser, Firefox, Graphics, Key, Modifiers, Profile, Tab, WebKit, WebKitOnDisk},
    disturb::{Chance, FOCUS_TEXT, LONGEST_TEXT, SIZE, missing},
    process::kill_group,
    server::SiteServer,
};

/// Which browser is killed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Victim {
    Chromium,
    Firefox,
    #[value(name = "webkit")]
    WebKit,
}

/// When the browser is killed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// At any moment, while keys are pressed.
    Random,
    /// As soon as the database has confirmed the last of some keys: nothing may be lost then.
    Confirmed,
}

/// The latest moment of a kill after the first key press.
const LATEST_KILL_MILLIS: u64 = 2000;
/// The longest pauses between two key presses: of a program that types, of a fast typist, and of a slow one.
const PAUSES_MILLIS: [u64; 3] = [0, 40, 200];
/// How many keys are pressed before the database is to confirm them.
const KEYS_TO_CONFIRM: usize = 12;
/// A key press may be lost if the browser is killed so soon after it.
const TOLERATED: Duration = Duration::from_millis(100);

/// The database has confirmed the latest text: only then is the small copy of it removed.
const IS_SAVED: &str =
    "!Object.keys(localStorage).some((key) => key.startsWith('enroute/enroute/writing-1/'))";

/// Counts the keys that the page is told of.
const COUNT_PRESSED: &str = "(() => { window.pressed = 0; \
    addEventListener('keydown', () => window.pressed++, true); })()";

/// The result of all kills of a browser. Displays as the row of a table in Markdown.
#[derive(Debug)]
pub struct Deaths {
    victim: Victim,
    /// How often the browser was killed.
    pub kills: u32,
    /// How many keys were pressed before.
    pub presses: usize,
    /// How long before the kill each lost key was pressed.
    pub lost_ages: Vec<Duration>,
    /// How many kills lost a key press.
    pub losing: u32,
}

impl Deaths {
    /// The heading of the table.
    pub const HEADING: &str = "| browser killed | kills | key presses | lost | kills that lost some | pressed more than 100 ms \
        before the kill | median age | greatest age |\n|---|---|---|---|---|---|---|---|";

    /// Returns how many of the lost keys were pressed so long before the kill that they must be kept.
    pub fn inexcusable(&self) -> usize {
        self.lost_ages.iter().filter(|&&age| age > TOLERATED).count()
    }
}

impl Display for Deaths {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let mut ages = self.lost_ages.clone();
        ages.sort_unstable();
        let millis =
            |age: Option<&Duration>| age.map_or("–".to_owned(), |age| format!("{} ms", age.as_millis()));
        let Self { victim, kills, presses, losing, .. } = self;
        write!(
            out,
            "| {victim:?} | {kills} | {presses} | {} | {losing} | {} | {} | {} |",
            ages.len(),
            self.inexcusable(),
            millis(ages.get(ages.len() / 2)),
            millis(ages.last()),
        )
    }
}

/// Kills a browser that shows the page of a site `kills` times; `seed` decides what is typed, how fast, and when the browser
/// ends. `tell` hears of each kill.
pub fn kill(
    victim: Victim,
    site: &Path,
    kills: u32,
    seed: u64,
    pace: Pace,
    mut tell: impl FnMut(&Deaths),
) -> Result<Deaths> {
    let server = SiteServer::start(site, 0, false)?;
    let profile = Profile::create()?;
    let start = || Running::start(victim, &profile, server.url());
    let mut chance = Chance::from_seed(seed);
    let mut deaths = Deaths { victim, kills: 0, presses: 0, lost_ages: Vec::new(), losing: 0 };
    let mut running = start()?;
    let mut text = Typed::default();
    for _ in 0..kills {
        if text.expected.is_empty() || text.expected.len() > LONGEST_TEXT {
            text = Typed { expected: format!("// {} ", deaths.kills), presses: Vec::new() };
            running.begin(&text.expected)?;
        }
        let begun = text.presses.len();
        let killed = match pace {
            Pace::Random => running.type_until_killed(&mut text, &mut chance)?,
            Pace::Confirmed => running.type_and_kill(&mut text, &mut chance)?,
        };
        deaths.kills += 1;
        deaths.presses += text.presses.len() - begun;
        running = start()?;
        let found = running.find(&text.expected)?;
        let lost = missing(&text.expected, &found);
        deaths.losing += u32::from(lost > 0);
        let ages =
            text.presses.iter().rev().take(lost).map(|&pressed| killed.saturating_duration_since(pressed));
        deaths.lost_ages.extend(ages);
        ensure!(lost <= text.presses.len(), "`{}` was saved, and `{found}` was found", text.expected);
        text.presses.truncate(text.presses.len() - lost);
        text.expected = found;
        tell(&deaths);
    }
    Ok(deaths)
}

/// The text that the page must have: how it began, then what was pressed, and when.
#[derive(Default)]
struct Typed {
    expected: String,
    presses: Vec<Instant>,
}

/// A browser that shows the page.
enum Running {
    Chromium { browser: Browser, tab: Tab },
    Firefox(Box<Firefox>),
    WebKit(Box<WebKitOnDisk>),
}

impl Running {
    fn start(victim: Victim, profile: &Arc<Profile>, url: &str) -> Result<Self> {
        let mut running = match victim {
            Victim::Chromium => {
                let browser = Browser::start_on(profile, Graphics::WebGl2, 1.0)?;
                let tab = browser.open_lasting_context()?.open_tab(SIZE[0], SIZE[1])?;
                tab.go_to(url)?;
                Self::Chromium { browser, tab }
            }
            Victim::Firefox => {
                let program: PathBuf = Firefox::find().context("Firefox is not installed")?;
                let mut firefox = Firefox::start_on(profile, &program, SIZE)?;
                firefox.go_to(url)?;
                Self::Firefox(Box::new(firefox))
            }
            Victim::WebKit => {
                let programs = WebKit::find().context("WebKit is not installed")?;
                Self::WebKit(Box::new(WebKitOnDisk::start_on(profile, &programs, SIZE, url)?))
            }
        };
        running.wait_until("'enroute' in window")?;
        let outcome = running.ask("enroute.ready.then(() => 'ready', (reason) => String(reason))")?;
        ensure!(outcome == "ready", "the page is not ready: {outcome}");
        Ok(running)
    }

    fn ask(&mut self, expression: &str) -> Result<Value> {
        match self {
            Self::Chromium { tab, .. } => tab.evaluate(expression),
            Self::Firefox(firefox) => firefox.evaluate(expression),
            Self::WebKit(webkit) => webkit.evaluate(expression),
        }
    }

    fn wait_until(&mut self, expression: &str) -> Result<()> {
        match self {
            Self::Chromium { tab, .. } => tab.wait_until(expression).map(|_| ()),
            Self::Firefox(firefox) => firefox.wait_until(expression),
            Self::WebKit(webkit) => webkit.wait_until(expression),
        }
    }

    fn press(&mut self, key: char) -> Result<()> {
        match self {
            Self::Chromium { tab, .. } => tab.press(Key::Character(key), Modifiers::NONE),
            Self::Firefox(firefox) => firefox.press(&key.to_string()),
            // The display takes keys without waiting for anybody.
            Self::WebKit(webkit) => {
                webkit.press(key)?;
                webkit.wait_until("window.pressed > 0 && window.pressed-- > 0")
            }
        }
    }

    fn leader(&self) -> u32 {
        match self {
            Self::Chromium { browser, .. } => browser.leader(),
            Self::Firefox(firefox) => firefox.leader(),
            Self::WebKit(webkit) => webkit.leader(),
        }
    }

    /// Gives the text the keyboard.
    fn click_text(&mut self) -> Result<()> {
        match self {
            Self::Chromium { tab, .. } => tab.wait_until(FOCUS_TEXT).map(|_| ()),
            // Firefox tells no page of a focus that its window does not have; a click gives it to both.
            Self::Firefox(firefox) => {
                firefox.wait_until("enroute.widgets('textbox', 'Mission text').length > 0")?;
                let text = firefox.evaluate("enroute.widgets('textbox', 'Mission text')[0]")?;
                let middle = |from: &str, size: &str| Some(text[from].as_f64()? + text[size].as_f64()? / 2.0);
                let place = middle("x", "width").zip(middle("y", "height"));
                let (x, y) = place.context("the text is nowhere")?;
                firefox.click(0, x, y)?;
                firefox.wait_until("document.querySelector('[aria-activedescendant]')")
            }
            Self::WebKit(webkit) => {
                webkit.focus()?;
                webkit.wait_until(FOCUS_TEXT)?;
                webkit.evaluate(COUNT_PRESSED).map(|_| ())
            }
        }
    }

    /// Replaces the text, and waits until the database has it.
    fn begin(&mut self, text: &str) -> Result<()> {
        self.ask(&format!("enroute.setSource({})", json!(text)))?;
        self.wait_until(&format!("enroute.source() === {}", json!(text)))?;
        self.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))")?;
        self.wait_until(IS_SAVED)
    }

    /// The text that the page has after it was started; a missing end may come a moment after the page itself.
    fn find(&mut self, expected: &str) -> Result<String> {
        // A busy machine opens the database late after a kill; the page goes on without it meanwhile.
        self.wait_until("enroute.state().library.keeping !== 'opening'")?;
        let found = self.ask(&format!(
            "(async () => {{ for (let at = 0; at < 40 && enroute.source() !== {}; at++) \
             await new Promise((done) => setTimeout(done, 50)); return enroute.source(); }})()",
            json!(expected)
        ))?;
        let missions = self.ask("enroute.state().library.missions.length")?;
        ensure!(missions == 1, "{missions} missions were found after a kill, and the text {found}");
        Ok(found.as_str().unwrap_or_default().to_owned())
    }

    /// Types some keys at the end, waits until the database has them, and kills the browser. Answers when it was dead.
    fn type_and_kill(mut self, text: &mut Typed, chance: &mut Chance) -> Result<Instant> {
        self.click_text()?;
        self.ask(&format!("enroute.dispatch('edit.select', {{ start: {} }})", 1 << 20))?;
        for _ in 0..KEYS_TO_CONFIRM {
            let key = chance.key();
            text.presses.push(Instant::now());
            self.press(key)?;
            text.expected.push(key);
        }
        self.wait_until(&format!("enroute.source() === {}", json!(text.expected)))?;
        self.wait_until(IS_SAVED)?;
        kill_group(self.leader())?;
        Ok(Instant::now())
    }

    /// Types at the end until the browser is killed. Answers when it was dead.
    fn type_until_killed(mut self, text: &mut Typed, chance: &mut Chance) -> Result<Instant> {
        self.click_text()?;
        self.ask(&format!("enroute.dispatch('edit.select', {{ start: {} }})", 1 << 20))?;
        let longest_pause = PAUSES_MILLIS[chance.below(PAUSES_MILLIS.len() as u64) as usize];
        let delay = Duration::from_micros(chance.below(LATEST_KILL_MILLIS * 1000));
        let leader = self.leader();
        let killing = thread::spawn(move || {
            thread::sleep(delay);
            kill_group(leader).map(|()| Instant::now())
        });
        while !killing.is_finished() {
            let key = chance.key();
            let pressed = Instant::now();
            if self.press(key).is_err() {
                // The browser may have handled what it no longer answered.
                text.expected.push(key);
                text.presses.push(pressed);
                break;
            }
            text.expected.push(key);
            text.presses.push(pressed);
            if longest_pause > 0 {
                thread::sleep(Duration::from_millis(chance.below(longest_pause)));
            }
        }
        match killing.join() {
            Ok(killed) => killed,
            Err(_) => bail!("the killer of the browser failed"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_what_was_lost_and_how_old_it_was() {
        let lost_ages = [30, 120, 10].map(Duration::from_millis).to_vec();
        let deaths = Deaths { victim: Victim::Firefox, kills: 5, presses: 40, lost_ages, losing: 2 };
        assert_eq!(deaths.to_string(), "| Firefox | 5 | 40 | 3 | 2 | 1 | 30 ms | 120 ms |");
        let none =
            Deaths { victim: Victim::Chromium, kills: 1, presses: 9, lost_ages: Vec::new(), losing: 0 };
        assert_eq!(none.to_string(), "| Chromium | 1 | 9 | 0 | 0 | 0 | – | – |");
    }
}
