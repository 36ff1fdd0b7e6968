//! Reloads, closes and starves the page right after key presses, again and again, and counts the key presses that are
//! lost: `cargo xtask disturb`, and a few of them in the tests of the page.

use std::{
    fmt::{self, Display, Formatter},
    path::Path,
};

use anyhow::{Context as _, Result, ensure};
use serde_json::json;

use crate::{
    browser::{Browser, Context, Tab},
    server::SiteServer,
};

/// What happens to the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Disturbance {
    /// The page is loaded again.
    Reload,
    /// Its tab is closed, and another one opened.
    CloseTab,
    /// The workers that plan are ended; later the page is loaded again.
    KillWorkers,
    /// The storage takes nothing more while someone types; then it does again, and the page is loaded again.
    FillStorage,
}

impl Disturbance {
    const ALL: [Self; 4] = [Self::Reload, Self::CloseTab, Self::KillWorkers, Self::FillStorage];

    const fn words(self) -> &'static str {
        match self {
            Self::Reload => "reloaded right after a key press",
            Self::CloseTab => "tab closed right after a key press",
            Self::KillWorkers => "planning workers killed while typing",
            Self::FillStorage => "database full (quota of 1 byte) while typing",
        }
    }
}

/// What came of the disturbances of one kind.
#[derive(Clone, Copy, Default)]
struct Tally {
    runs: u32,
    keys: usize,
    /// Pressed, but never told to the page: its tab was closed first.
    undelivered: usize,
    lost: usize,
}

impl Tally {
    const fn with(self, other: Self) -> Self {
        Self {
            runs: self.runs + other.runs,
            keys: self.keys + other.keys,
            undelivered: self.undelivered + other.undelivered,
            lost: self.lost + other.lost,
        }
    }
}

/// What came of all disturbances. Displays as a table in Markdown.
pub struct Losses {
    tallies: [Tally; Disturbance::ALL.len()],
    /// Each text that was not as it was to be, with what it was to be.
    pub differences: Vec<[String; 2]>,
}

impl Losses {
    /// Returns how many disturbances there were.
    pub fn runs(&self) -> u32 {
        self.tallies.iter().map(|tally| tally.runs).sum()
    }

    /// Returns how many key presses that the page was told of were lost.
    pub fn lost(&self) -> usize {
        self.tallies.iter().map(|tally| tally.lost).sum()
    }
}

impl Display for Losses {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        out.write_str(
            "| disturbance | runs | key presses | not told to the page | lost |\n|---|---|---|---|---|\n",
        )?;
        let mut sum = Tally::default();
        for (kind, &tally) in Disturbance::ALL.iter().zip(&self.tallies) {
            let Tally { runs, keys, undelivered, lost } = tally;
            writeln!(out, "| {} | {runs} | {keys} | {undelivered} | {lost} |", kind.words())?;
            sum = sum.with(tally);
        }
        writeln!(out, "| all | {} | {} | {} | {} |", sum.runs, sum.keys, sum.undelivered, sum.lost)
    }
}

/// Gives the text the keyboard, and tells whether it has it.
pub(crate) const FOCUS_TEXT: &str = "(() => { \
    const text = document.querySelector('[role=textbox][aria-label=\"Mission text\"]'); \
    if (document.querySelector(`[aria-activedescendant=${text.id}]`)) return true; \
    text.focus(); return false; })()";
/// A longer text is replaced by a new one.
pub(crate) const LONGEST_TEXT: usize = 1500;
/// After so many disturbances a context gives way to a fresh one: closed tabs leave memory in use.
const RUNS_OF_A_CONTEXT: u32 = 100;
/// Width and height of the page in CSS pixels: small, because it is drawn without a graphics card.
pub(crate) const SIZE: [u32; 2] = [560, 420];
/// Bytes that a full storage has room for.
const NO_ROOM: u64 = 1;
/// Collects the workers that the page starts, so that they can be ended, and writes down which keys the page is told of.
const COLLECT: &str = "window.startedWorkers = []; window.Worker = class extends Worker { \
    constructor(...all) { super(...all); window.startedWorkers.push(this); } }; \
    addEventListener('keydown', ({ key }) => { if (key.length === 1) \
    localStorage.setItem('told-keys', (localStorage.getItem('told-keys') ?? '') + key); }, true);";

/// Disturbs the page of a site `runs` times; `seed` decides what is typed and what happens then. `tell` hears of each
/// run that has been made.
pub fn disturb(
    browser: &Browser,
    site: &Path,
    runs: u32,
    seed: u64,
    mut tell: impl FnMut(u32),
) -> Result<Losses> {
    let server = SiteServer::start(site, 0, false)?;
    let mut context = browser.open_context()?;
    let mut chance = Chance::from_seed(seed);
    let mut page = Page { tab: opened(&context, &server)?, expected: String::new(), differences: Vec::new() };
    page.begin("// ")?;
    let mut losses = Losses { tallies: [Tally::default(); Disturbance::ALL.len()], differences: Vec::new() };
    for run in 0..runs {
        if run > 0 && run % RUNS_OF_A_CONTEXT == 0 {
            context = browser.open_context()?;
            page.tab = opened(&context, &server)?;
            page.begin(&format!("// {run} "))?;
        }
        let kind = chance.below(Disturbance::ALL.len() as u64) as usize;
        let typed: String = (0..4 + chance.below(28)).map(|_| chance.key()).collect();
        if page.expected.len() > LONGEST_TEXT {
            page.begin(&format!("// {run} "))?;
        }
        let (undelivered, lost) = page
            .disturbed(Disturbance::ALL[kind], &typed, &context, &server)
            .with_context(|| format!("run {run}, {}", Disturbance::ALL[kind].words()))?;
        let tally = &mut losses.tallies[kind];
        *tally = tally.with(Tally { runs: 1, keys: typed.len(), undelivered, lost });
        tell(run + 1);
    }
    losses.differences = page.differences;
    Ok(losses)
}

fn opened(context: &Context, server: &SiteServer) -> Result<Tab> {
    let tab = context.open_tab(SIZE[0], SIZE[1])?;
    tab.call("Page.addScriptToEvaluateOnNewDocument", &json!({ "source": COLLECT }))?;
    tab.go_to(server.url())?;
    tab.wait_until_ready()?;
    Ok(tab)
}

/// The page, and the text that it must have.
struct Page {
    tab: Tab,
    expected: String,
    /// Texts found and expected, where they differ.
    differences: Vec<[String; 2]>,
}

impl Page {
    /// Replaces the text.
    fn begin(&mut self, text: &str) -> Result<()> {
        self.tab.evaluate(&format!("enroute.setSource({})", json!(text)))?;
        self.tab.wait_until(&format!("enroute.source() === {}", json!(text)))?;
        text.clone_into(&mut self.expected);
        Ok(())
    }

    /// Types at the end while something happens. Returns how many key presses the page was not told of, and how many of the
    /// others are missing afterwards.
    fn disturbed(
        &mut self,
        kind: Disturbance,
        typed: &str,
        context: &Context,
        server: &SiteServer,
    ) -> Result<(usize, usize)> {
        self.tab.wait_until(FOCUS_TEXT)?;
        self.tab.evaluate("localStorage.removeItem('told-keys')")?;
        self.tab.evaluate(&format!("enroute.dispatch('edit.select', {{ start: {} }})", 1 << 20))?;
        let origin = server.url().trim_end_matches('/').to_owned();
        let (first, rest) = typed.split_at(typed.len() / 2);
        match kind {
            Disturbance::Reload | Disturbance::CloseTab => self.tab.type_text(typed)?,
            Disturbance::KillWorkers => {
                self.tab.type_text(first)?;
                self.tab.evaluate("startedWorkers.splice(0).forEach((worker) => worker.terminate())")?;
                self.tab.type_text(rest)?;
            }
            Disturbance::FillStorage => {
                let quota = json!({ "origin": origin, "quotaSize": NO_ROOM });
                self.tab.call("Storage.overrideQuotaForOrigin", &quota)?;
                self.tab.type_text(first)?;
                self.tab.next_frame()?;
                self.tab.call("Storage.overrideQuotaForOrigin", &json!({ "origin": origin }))?;
                self.tab.type_text(rest)?;
            }
        }
        if kind == Disturbance::CloseTab {
            self.tab.call("Page.close", &json!({}))?;
            self.tab = opened(context, server)?;
        } else {
            self.tab.evaluate("window.isOldPage = true; location.reload()")?;
            self.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
            self.tab.wait_until_ready()?;
        }
        let told = self.tab.evaluate("localStorage.getItem('told-keys') ?? ''")?;
        let told = told.as_str().unwrap_or_default();
        ensure!(typed.starts_with(told), "`{typed}` was typed, and the page was told of `{told}`");
        self.expected.push_str(told);
        // What is kept may come a moment after the page itself.
        let text = json!(self.expected);
        let outcome = self.tab.evaluate(&format!(
            "(async () => {{ for (let at = 0; at < 40 && enroute.source() !== {text}; at++) \
             await new Promise((done) => setTimeout(done, 50)); return enroute.source(); }})()"
        ))?;
        let found = outcome.as_str().unwrap_or_default().to_owned();
        let lost = missing(&self.expected, &found);
        if found != self.expected {
            self.differences.push([found.clone(), std::mem::replace(&mut self.expected, found)]);
        }
        Ok((typed.len() - told.len(), lost))
    }
}

/// Returns how many characters of `expected` are not in `found` at their place.
pub(crate) fn missing(expected: &str, found: &str) -> usize {
    let same = expected.bytes().zip(found.bytes()).take_while(|(left, right)| left == right).count();
    expected.len() - same
}

/// Numbers that a seed decides (xorshift).
pub(crate) struct Chance(u64);

impl Chance {
    pub(crate) fn from_seed(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end
    }

    /// A letter, a digit or a blank.
    pub(crate) fn key(&mut self) -> char {
        const KEYS: &[u8] = b"abcdefghijklmnopqrstuvwxyz0123456789  ";
        char::from(KEYS[self.below(KEYS.len() as u64) as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_counted_from_the_first_difference() {
        assert_eq!(missing("// abc", "// abc"), 0);
        assert_eq!(missing("// abc", "// ab"), 1);
        assert_eq!(missing("// abc", "// xbc"), 3);
        assert_eq!(missing("// abc", ""), 6);
    }

    #[test]
    fn the_table_sums_what_happened() {
        let tally = Tally { runs: 2, keys: 10, undelivered: 2, lost: 1 };
        let losses = Losses { tallies: [tally; 4], differences: Vec::new() };
        assert_eq!((losses.runs(), losses.lost()), (8, 4));
        let text = losses.to_string();
        assert!(text.ends_with("| all | 8 | 40 | 8 | 4 |\n"), "{text}");
    }
}
