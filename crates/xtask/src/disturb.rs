//! `cargo xtask disturb`: reloads, closes and starves the page right after key presses, again and again, and
//! counts the key presses that are lost.

use std::fmt::Write as _;

use anyhow::{Context as _, Result, ensure};
use serde_json::{Value, json};
use xtask::{
    browser::{Browser, Graphics, Tab},
    server::SiteServer,
    site::{self, Flavour},
};

/// How often, and with which chance.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// How many disturbances.
    #[arg(long, default_value_t = 100)]
    runs: u32,
    /// Decides what is typed and what happens then.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Takes the page as it was last built.
    #[arg(long)]
    no_build: bool,
}

/// What happens to the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Disturbance {
    /// The page is loaded again.
    Reload,
    /// Its tab is closed, and another one opened.
    CloseTab,
    /// The workers that plan are ended; later the page is loaded again.
    KillWorkers,
    /// The storage takes nothing more while somebody types; then it does again, and the page is loaded again.
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
    lost: usize,
}

/// A text longer than this is begun anew.
const LONGEST_TEXT: usize = 1500;
/// Bytes that a full storage has room for.
const NO_ROOM: u64 = 1;
/// Collects the workers that the page starts, so that they can be ended.
const COLLECT_WORKERS: &str = "window.startedWorkers = []; window.Worker = class extends Worker { \
    constructor(...all) { super(...all); window.startedWorkers.push(this); } };";

/// Builds the page, disturbs it, and prints the table of losses. Fails if a key press was lost.
pub(crate) fn run(options: &Options) -> Result<()> {
    let flavour = Flavour::Development;
    let folder = if options.no_build { flavour.folder() } else { site::build(flavour)? };
    let server = SiteServer::start(&folder, 0, false)?;
    let browser = Browser::start(Graphics::WebGl2)?;
    let mut chance = Chance(options.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut page = Page { tab: opened(&browser, &server)?, expected: String::new() };
    page.begin("// ")?;
    let mut tallies = [Tally::default(); Disturbance::ALL.len()];
    for run in 0..options.runs {
        let kind = chance.below(Disturbance::ALL.len() as u64) as usize;
        let typed: String = (0..4 + chance.below(28)).map(|_| chance.key()).collect();
        if page.expected.len() > LONGEST_TEXT {
            page.begin(&format!("// {run} "))?;
        }
        let lost = page
            .disturbed(Disturbance::ALL[kind], &typed, &browser, &server)
            .with_context(|| format!("run {run}, {}", Disturbance::ALL[kind].words()))?;
        let tally = &mut tallies[kind];
        *tally = Tally { runs: tally.runs + 1, keys: tally.keys + typed.len(), lost: tally.lost + lost };
    }
    print!("{}", table(&tallies));
    let lost: usize = tallies.iter().map(|tally| tally.lost).sum();
    ensure!(lost == 0, "{lost} key presses were lost (seed {})", options.seed);
    Ok(())
}

/// The table of losses, in Markdown.
fn table(tallies: &[Tally]) -> String {
    let mut text = "| disturbance | runs | key presses | lost |\n|---|---|---|---|\n".to_owned();
    let mut sum = Tally::default();
    let mut row = |words: &str, tally: Tally| {
        let Tally { runs, keys, lost } = tally;
        let _ = writeln!(text, "| {words} | {runs} | {keys} | {lost} |");
    };
    for (kind, &tally) in Disturbance::ALL.iter().zip(tallies) {
        row(kind.words(), tally);
        sum = Tally { runs: sum.runs + tally.runs, keys: sum.keys + tally.keys, lost: sum.lost + tally.lost };
    }
    row("all", sum);
    text
}

fn opened(browser: &Browser, server: &SiteServer) -> Result<Tab> {
    let tab = browser.open_tab(1000, 700)?;
    tab.call("Page.addScriptToEvaluateOnNewDocument", &json!({ "source": COLLECT_WORKERS }))?;
    tab.go_to(server.url())?;
    tab.wait_until_ready()?;
    Ok(tab)
}

/// The page, and the text that it must have.
struct Page {
    tab: Tab,
    expected: String,
}

impl Page {
    /// Begins a text anew.
    fn begin(&mut self, text: &str) -> Result<()> {
        self.tab.evaluate(&format!("enroute.setSource({})", json!(text)))?;
        self.tab.wait_until(&format!("enroute.source() === {}", json!(text)))?;
        text.clone_into(&mut self.expected);
        Ok(())
    }

    /// Types at the end while something happens. Returns how many key presses are missing afterwards.
    fn disturbed(
        &mut self,
        kind: Disturbance,
        typed: &str,
        browser: &Browser,
        server: &SiteServer,
    ) -> Result<usize> {
        self.tab.click_widget("textbox", "Mission text")?;
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
        self.expected.push_str(typed);
        if kind == Disturbance::CloseTab {
            self.tab.call("Page.close", &json!({}))?;
            self.tab = opened(browser, server)?;
        } else {
            self.tab.evaluate("window.isOldPage = true; location.reload()")?;
            self.tab.wait_until("!('isOldPage' in window) && 'enroute' in window")?;
            self.tab.wait_until_ready()?;
        }
        // What is kept may come a moment after the page itself.
        let text = json!(self.expected);
        let outcome = self.tab.evaluate(&format!(
            "(async () => {{ for (let at = 0; at < 40 && enroute.source() !== {text}; at++) \
             await new Promise((done) => setTimeout(done, 50)); return enroute.source(); }})()"
        ))?;
        let found = outcome.as_str().unwrap_or_default().to_owned();
        let lost = missing(&self.expected, &found);
        if found != self.expected {
            eprintln!("expected {text}\nfound    {}", Value::from(found.clone()));
            self.expected = found;
        }
        Ok(lost)
    }
}

/// How many characters of `expected` are not in `found` at their place.
fn missing(expected: &str, found: &str) -> usize {
    let same = expected.bytes().zip(found.bytes()).take_while(|(left, right)| left == right).count();
    expected.len() - same
}

/// Numbers that a seed decides (xorshift).
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end
    }

    /// A letter, a digit or a blank.
    fn key(&mut self) -> char {
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
        let tally = Tally { runs: 2, keys: 10, lost: 1 };
        let text = table(&[tally; 4]);
        assert!(text.ends_with("| all | 8 | 40 | 4 |\n"), "{text}");
    }
}
