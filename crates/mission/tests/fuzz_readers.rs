//! A bounded fuzz run of what reads other people's data: networks, control programs and models, plans, disturbances,
//! uncertainty and reviews. Pieces of a small corpus are cut, doubled, swapped and changed; nothing may panic, whatever is
//! read is planned as far as it goes, and what is written can be read again. The seed of a failure is printed with it.

use std::sync::Arc;

use executive::Script;
use mission::planning;
use mission::review::Record;
use mission::{Snapshot, Uncertainty};
use tpn::interchange::Source;
use tpn::plan_schema::Document;

const ROUNDS: u64 = 1200;

const NETWORKS: [&str; 2] = [include_str!("corpus/network.tpn.json"), include_str!("corpus/network.tpn.edn")];

const CONTROL: [&str; 3] = [
    include_str!("../../../tests/conformance/h01_orbit_nominal.rmpl"),
    "(DEFCLASS Valve (MODES Closed Open Stuck))\n(DEFINSTANCE V Valve INIT Closed)\n(DEFINE (Main) (PARALLEL (WHEN (V = Open) (V = Closed))))",
    "(",
];

const DOCUMENTS: [&str; 4] = [
    include_str!("corpus/disturbances.json"),
    include_str!("corpus/uncertainty.json"),
    include_str!("corpus/review.json"),
    include_str!("corpus/board.json"),
];

/// What breaks readers: signs of every notation, numbers at the ends of their ranges, texts that cannot be shown.
const PIECES: [&str; 26] = [
    "{",
    "}",
    "[",
    "]",
    "(",
    ")",
    "\"",
    ":",
    ",",
    "#{",
    "#_",
    ";",
    "\\",
    "null",
    "-1",
    "1e308",
    "1e-308",
    "NaN",
    "\"Infinity\"",
    "99999999999999999999",
    "0.1",
    "\"1/3\"",
    "\u{feff}",
    "\u{202e}",
    "\u{0}",
    "n1",
];

struct Source64(u64);

impl Source64 {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % limit.max(1)
    }

    fn place(&mut self, text: &str) -> usize {
        let at = self.below(text.len() + 1);
        text.floor_char_boundary(at)
    }

    fn range(&mut self, text: &str) -> std::ops::Range<usize> {
        let start = self.place(text);
        let end = text.floor_char_boundary((start + self.below(40)).min(text.len()));
        start..end.max(start)
    }

    /// One of `texts`, changed in a few places.
    fn mutated(&mut self, texts: &[&str]) -> String {
        let mut text = texts[self.below(texts.len())].to_owned();
        for _ in 0..=self.below(5) {
            match self.below(5) {
                0 => {
                    let range = self.range(&text);
                    text.replace_range(range, "");
                }
                1 => {
                    let piece = text[self.range(&text)].to_owned();
                    let at = self.place(&text);
                    text.insert_str(at, &piece);
                }
                2 => {
                    let range = self.range(&text);
                    text.replace_range(range, PIECES[self.below(PIECES.len())]);
                }
                3 => {
                    let from = text[self.range(&text)].to_owned();
                    let range = self.range(&text);
                    text.replace_range(range, &from);
                }
                _ => {
                    // A number becomes another one.
                    let digits: Vec<usize> =
                        text.match_indices(|c: char| c.is_ascii_digit()).map(|(at, _)| at).collect();
                    if let Some(&at) = digits.get(self.below(digits.len())) {
                        text.replace_range(at..=at, PIECES[self.below(PIECES.len())].trim_matches('"'));
                    }
                }
            }
        }
        text
    }
}

/// Runs `exercise` on mutations of `texts`.
fn fuzz(texts: &[&str], exercise: impl Fn(&str) + std::panic::RefUnwindSafe) {
    for text in texts {
        exercise(text);
    }
    for seed in 1..=ROUNDS {
        let text = Source64::new(seed).mutated(texts);
        let outcome = std::panic::catch_unwind(|| exercise(&text));
        assert!(outcome.is_ok(), "seed {seed}: {text:?}");
    }
}

#[test]
fn no_network_panics_and_what_is_read_is_planned_and_written() {
    fuzz(&NETWORKS, |text| {
        let Ok(source) = Source::read(text) else { return };
        let _ = source.not_honoured();
        let network = Arc::new(source.into_network());
        let written = tpn::plan_schema::write(&network);
        assert!(Document::parse(&written.to_string()).is_ok(), "what is written can be read");
        let mut left = 200;
        let mut stop = || {
            left -= 1;
            left <= 0
        };
        let snapshot = Snapshot::of_network(text.into(), Arc::clone(&network), Vec::new(), &mut stop);
        if let Some(plan) = snapshot.plan() {
            let plan = tpn::plan_json::plan_to_json(&network, plan);
            assert!(tpn::plan_json::plan_from_json(&network, &plan).is_ok(), "what is written can be read");
        }
    });
}

#[test]
fn no_control_program_and_no_model_panics() {
    fuzz(&CONTROL, |text| {
        let parsed = rmpl::control::parse(text);
        let formatted = rmpl::control::format(text);
        assert_eq!(rmpl::control::format(&formatted), formatted, "formatting twice");
        let (model, _) = plant::compile(&parsed.file);
        if let Some(model) = model {
            let _ = model.state_names(&model.initial_state());
        }
        let _ = mission::read_control(text, None);
    });
}

#[test]
fn no_document_panics() {
    let mission = rmpl::parse(include_str!("../../../assets/missions/enroute.rmpl"));
    let program = mission.program();
    let network = mission::compile(&program, &mission::Goal::Default, &mut Vec::new()).expect("the example");
    let (programs, _) = mission::programs::Programs::compile(&program, Some(&network));
    fuzz(&DOCUMENTS, |text| {
        if let Ok(script) = serde_json::from_str::<Script>(text) {
            let _ =
                mission::execution::check_disturbances(&network, &program, &programs, &script.disturbances);
        }
        if let Ok(uncertainty) = serde_json::from_str::<Uncertainty>(text) {
            let _ = uncertainty.problem(&network);
        }
        if let Ok(record) = Record::from_json(text) {
            assert_eq!(Record::from_json(&record.to_json()), Ok(record), "what is written can be read");
        }
    });
}

#[test]
fn no_plan_panics() {
    let text = include_str!("../../../assets/missions/causal-links.rmpl");
    let program = rmpl::parse(text).program();
    let network = mission::compile(&program, &mission::Goal::Default, &mut Vec::new()).expect("the example");
    let network = Arc::new(network);
    let outcome = kirk::plan(&network, &kirk::Options::default(), &mut |_: &kirk::Stats| false);
    let planned = planning::without_paths(&network, outcome);
    let plan = planned.planning.outcome.plans.first().expect("a plan");
    let written = tpn::plan_json::plan_to_json(&network, plan).to_string();
    fuzz(&[&written], |text| {
        let Ok(value) = serde_json::from_str::<serde_json::Value>(text) else { return };
        if let Ok(plan) = tpn::plan_json::plan_from_json(&network, &value) {
            let _ = verify::check_plan(&network, &plan);
        }
    });
}
