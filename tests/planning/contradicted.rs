//! What reviews of random missions have passed, held against schedules of the plan and undisturbed runs: a line that is
//! contradicted is a defect. No vehicle drives in these missions.

use acceptance::lasting_missions::{Kind, lasting_mission};
use acceptance::random::{crowded_mission, small_mission};
use link::Update;
use mission::{Core, Manner};
use review::contradict::{Effort, Trial, Tried, Verdict};
use review::{FlightRules, Section, review};
use snapshot::Goal;
use test_core::Answers;
use tpn::generate::Rng;

/// The text of a mission number.
type Made = fn(u64) -> String;

/// Missions of each kind.
const MISSIONS: u64 = 60;
const EFFORT: Effort = Effort { schedules: 40, runs: 8, seed: 5 };

/// What was tried.
#[derive(Default, Debug)]
struct Count {
    plans: u64,
    /// Plans in which nature chooses something.
    with_nature: u64,
    lines: u64,
    schedules: u64,
    runs: u64,
    contradicted: Vec<String>,
}

/// The mission with some of its bounds given to nature, by chance.
fn with_nature(text: &str, seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0x6e61);
    let mut parts = text.split("()[");
    let mut changed = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        changed.push_str(if rng.chance(30) { "() contingent [" } else { "()[" });
        changed.push_str(part);
    }
    changed
}

fn try_mission(text: &str, seed: u64, count: &mut Count) {
    let mut core = Core::default();
    let mut host = Answers::default();
    let compiled = core.compile(&Update::new(1, text), &host);
    let Some(evaluated) = core.plan(compiled, None, Manner::unexplained(), &mut host) else { return };
    let snapshot = evaluated.snapshot();
    let Some(plan) = snapshot.plan() else { return };
    let mut arcs = evaluated.planned.network.arcs.iter().zip(&plan.selected_arcs);
    let has_nature = arcs.any(|(arc, is_selected)| arc.is_contingent && *is_selected);
    count.plans += 1;
    count.with_nature += u64::from(has_nature);
    let mut reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    reviewed.hold_against(&snapshot, &FlightRules::default(), None, &mut || false);
    let Some(mut trial) = Trial::new(&snapshot, &reviewed, None, EFFORT) else { return };
    while core.try_next(&evaluated, &mut trial).expect("its times fit") {}
    let is_tried = |tried: &&Tried| tried.verdict() != Verdict::NotTried;
    for tried in trial.tried().filter(is_tried) {
        count.lines += 1;
        count.schedules += tried.schedules;
        count.runs += tried.runs;
        if let Some(found) = &tried.counterexample {
            let (section, line) = (tried.line.section, &tried.line.text);
            let problem = format!("seed {seed}, {section:?}: {line}: {}\n{text}", found.text);
            count.contradicted.push(problem);
        }
    }
}

#[test]
#[expect(clippy::print_stdout, reason = "the count is part of the evidence")]
fn nothing_that_reviews_of_random_missions_have_passed_is_contradicted() {
    let kinds: [(&str, Made); 5] = [
        ("conditions", small_mission),
        ("crowded", crowded_mission),
        ("states", |seed| lasting_mission(seed, Kind::STATES)),
        ("resources", |seed| lasting_mission(seed, Kind::RESOURCES)),
        ("both", |seed| lasting_mission(seed, Kind::BOTH)),
    ];
    for (kind, mission) in kinds {
        let mut count = Count::default();
        for seed in 0..MISSIONS {
            let text = mission(seed);
            try_mission(&text, seed, &mut count);
            try_mission(&with_nature(&text, seed), seed, &mut count);
        }
        let Count { plans, with_nature, lines, schedules, runs, contradicted } = count;
        println!(
            "{kind}: {plans} plans ({with_nature} with nature), {lines} lines, {schedules} schedules, {runs} runs"
        );
        assert!(contradicted.is_empty(), "{}: {}", contradicted.len(), contradicted.join("\n"));
        assert!(plans > MISSIONS / 4 && lines > plans && schedules > lines && runs > 0, "{kind}");
    }
}

/// The sections whose lines are tried in missions without vehicles.
#[test]
fn what_can_be_tried_is_tried() {
    let snapshot = test_core::snapshot(
        "state X : {A, B} = A; resource R capacity 2; primitive P()[1,2] requires X=A uses R 1 sets X=B;
scenario S[0,9] = { P(); delay }",
    );
    let reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let mut trial = Trial::new(&snapshot, &reviewed, None, EFFORT).expect("a plan");
    while trial.try_schedule() {}
    for section in [Section::Plan, Section::CausalLinks, Section::States, Section::Resources] {
        let mut tried = trial.tried().filter(|it| it.line.section == section);
        assert!(tried.any(|it| it.verdict() == Verdict::Survived), "{section:?}");
    }
}
