//! Random missions with random disturbances: what was executed keeps to the rules, or the run says why it stopped.

use std::sync::Arc;

use exact::Time;
use executive::{Disturbance, Ending, Facts, Happening, Replanner, RunOutcome, World, run};
use tpn::generate::{Recipe, Rng, Tightness};
use tpn::{Network, OccurrenceKind, Plan, Top};

/// Plans again without paths, and keeps the facts it was given.
struct Kirk {
    network: Arc<Network>,
    facts: Vec<Facts>,
}

impl Replanner for Kirk {
    fn replan(&mut self, facts: &Facts) -> Result<(Arc<Network>, Plan), String> {
        self.facts.push(facts.clone());
        let network = Arc::new(facts.apply(&self.network, self.network.nodes.len()));
        let options = kirk::Options { relax: false, ..kirk::Options::default() };
        let outcome = kirk::plan(&network, &options, &mut kirk::Unlimited);
        match outcome.plans.into_iter().next() {
            Some(plan) => Ok((network, plan)),
            None => Err("no plan".to_owned()),
        }
    }
}

fn compiled(source: &str) -> Arc<Network> {
    let program = rmpl::parse(source).program();
    let (network, diagnostics) = tpn::compile(&program, &Top::Scenario(None));
    Arc::new(network.unwrap_or_else(|| panic!("{diagnostics:?}")))
}

fn execute(network: &Arc<Network>, disturbances: &[Disturbance]) -> (RunOutcome, Vec<Facts>) {
    let outcome = kirk::plan(network, &kirk::Options::default(), &mut kirk::Unlimited);
    let plan = outcome.plans.into_iter().next().expect("the mission has a plan");
    let mut kirk = Kirk { network: Arc::clone(network), facts: Vec::new() };
    let world = World::new(disturbances);
    let outcome = run(network, plan, network.nodes.len(), &world, &mut kirk).expect("its times fit");
    (outcome, kirk.facts)
}

fn random_disturbances(network: &Network, rng: &mut Rng) -> Vec<Disturbance> {
    let mut disturbances = Vec::new();
    for occurrence in &network.occurrences {
        if !rng.chance(12) {
            continue;
        }
        let name = occurrence.name.clone();
        let time = Time::from(rng.between(0, 60));
        match occurrence.kind {
            OccurrenceKind::Primitive => {
                let duration = time.checked_div(3).expect("a small time");
                disturbances.push(Disturbance::Duration { activity: name, duration });
            }
            OccurrenceKind::Assertion if rng.chance(50) => {
                disturbances.push(Disturbance::Withdrawn { condition: name, at: time });
            }
            OccurrenceKind::Assertion => disturbances.push(Disturbance::Late { condition: name, at: time }),
            _ => {}
        }
    }
    disturbances
}

#[test]
fn undisturbed_runs_follow_the_earliest_schedule_and_pass_the_schedule_check() {
    for seed in 0..40 {
        let source = tpn::generate::mission(Recipe { nodes: 40, tightness: Tightness::Feasible, seed });
        let network = compiled(&source);
        let (outcome, facts) = execute(&network, &[]);
        assert_eq!(outcome.ending, Ending::Finished, "seed {seed}: {:?}", outcome.log.last());
        assert!(facts.is_empty(), "seed {seed} planned again");
        assert_eq!(outcome.last().times, verify::earliest_schedule(&outcome.last().plan), "seed {seed}");
        let verdict = verify::check_schedule(&network, &outcome.last().plan, &outcome.last().times);
        assert!(verdict.valid, "seed {seed}: {:?}", verdict.violations);
    }
}

#[test]
fn disturbed_runs_keep_the_rules_or_report_a_violation_and_stop() {
    let (mut finished, mut stopped, mut replanned) = (0, 0, 0);
    for seed in 0..150 {
        let source = tpn::generate::mission(Recipe { nodes: 40, tightness: Tightness::Feasible, seed });
        let network = compiled(&source);
        let mut rng = Rng::new(seed);
        let disturbances = random_disturbances(&network, &mut rng);
        let (outcome, facts) = execute(&network, &disturbances);
        replanned += facts.len();
        match outcome.ending {
            Ending::Finished => {
                finished += 1;
                let verdict = verify::check_schedule(
                    &outcome.last().network,
                    &outcome.last().plan,
                    &outcome.last().times,
                );
                assert!(verdict.valid, "seed {seed}: {:?}", verdict.violations);
            }
            Ending::Stopped => {
                stopped += 1;
                let has_violation =
                    outcome.log.iter().any(|entry| matches!(entry.happening, Happening::Violation { .. }));
                assert!(has_violation, "seed {seed}: {:?}", outcome.log.last());
            }
        }
    }
    assert!(
        finished > 20 && stopped > 5 && replanned > 20,
        "{finished} finished, {stopped} stopped, {replanned}"
    );
}

#[test]
fn planning_again_never_changes_the_past_and_time_never_goes_back() {
    for seed in 0..150 {
        let source = tpn::generate::mission(Recipe { nodes: 40, tightness: Tightness::Feasible, seed });
        let network = compiled(&source);
        let disturbances = random_disturbances(&network, &mut Rng::new(seed));
        let (outcome, facts) = execute(&network, &disturbances);
        assert!(outcome.log.is_sorted_by_key(|entry| entry.time), "seed {seed}");
        for pair in facts.windows(2) {
            for happened in &pair[0].happened {
                assert!(pair[1].happened.contains(happened), "seed {seed}: {happened:?} changed");
            }
        }
        if let (Some(last), Ending::Finished) = (facts.last(), outcome.ending) {
            for &(node, time) in &last.happened {
                assert_eq!(outcome.last().times[node.index()], Some(time), "seed {seed}");
            }
        }
    }
}

#[test]
fn the_same_disturbances_give_the_same_log() {
    for seed in 0..40 {
        let source = tpn::generate::mission(Recipe { nodes: 40, tightness: Tightness::Feasible, seed });
        let network = compiled(&source);
        let disturbances = random_disturbances(&network, &mut Rng::new(seed));
        assert_eq!(execute(&network, &disturbances), execute(&network, &disturbances), "seed {seed}");
    }
}

#[test]
fn a_window_withdrawn_while_the_rovers_wait_sends_them_the_other_way() {
    let source = include_str!("../../../../tests/conformance/t03_enroute_both_paths.rmpl");
    let network = compiled(&source.replace("delay[10,inf]", "delay[40,inf]"));
    let withdrawn = Disturbance::Withdrawn { condition: "Tell(PATH1=OK)#1".into(), at: Time::from(30) };
    let (outcome, facts) = execute(&network, &[withdrawn]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(facts.len(), 1);
    assert_eq!(outcome.last().plan.choices[0].alternative, 1);
    let changes = outcome.log.iter().find_map(|entry| match &entry.happening {
        Happening::Replanned { changes } => Some((entry.time, changes.clone())),
        _ => None,
    });
    let change = "D1 takes Group-Traverse-Path(PATH2_1, …, TAI_POS) instead of Group-Traverse-Path(PATH1_1, …, TAI_POS)";
    assert_eq!(changes, Some((Time::from(30), vec![change.to_owned()])));
}

#[test]
fn an_activity_in_a_choice_that_ends_late_but_within_its_window_breaks_nothing() {
    let network = compiled("scenario S[0,90] = { choose { Dig()[10,60], Rest()[70,80] }; Pack()[5,10] }");
    let late = Disturbance::Duration { activity: "Dig#1".into(), duration: Time::from(30) };
    let (outcome, facts) = execute(&network, &[late]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert!(facts.is_empty(), "{:?}", outcome.log);
    let time = |name: &str| {
        let is_it = |entry: &&executive::Entry| matches!(&entry.happening, Happening::Executed { name: it } if it == name);
        outcome.log.iter().find(is_it).map(|entry| entry.time)
    };
    assert_eq!(time("Dig#1.end"), Some(Time::from(30)));
    assert_eq!(time("Pack#1.start"), Some(Time::from(30)));
    assert_eq!(time("scenario#1.end"), Some(Time::from(35)));
}

/// Runs a mission in which `condition` begins at 5 instead of at once, and returns when some events came.
#[track_caller]
fn times_when_late(source: &str, condition: &str, names: &[&str]) -> Vec<Option<Time>> {
    let network = compiled(source);
    let late = Disturbance::Late { condition: condition.into(), at: Time::from(5) };
    let (outcome, facts) = execute(&network, &[late]);
    assert_eq!(outcome.ending, Ending::Finished, "{source}: {:?}", outcome.log);
    assert_eq!(facts.len(), 1, "{source}: {:?}", outcome.log);
    let last = outcome.last();
    let verdict = verify::check_schedule(&last.network, &last.plan, &last.times);
    assert!(verdict.valid, "{source}: {:?}", verdict.violations);
    let time = |name: &&str| {
        let is_it = |entry: &&executive::Entry| matches!(&entry.happening, Happening::Executed { name: it } if it == name);
        outcome.log.iter().find(is_it).map(|entry| entry.time)
    };
    names.iter().map(time).collect()
}

/// SPEC 6.2: a condition that comes late is late alone.
#[test]
fn what_a_late_condition_starts_together_with_does_not_wait_for_it() {
    let (zero, five) = (Some(Time::ZERO), Some(Time::from(5)));
    let declared = "var PASS : {CLOSED, OPEN}; primitive Transmit()[5,10] requires PASS=OPEN;
        primitive Store()[5,10]; primitive Wake()[2,2];";
    let tell = "Tell(PASS=OPEN)#1";
    for (scenario, names, times) in [
        ("{ { delay; Transmit() }, { PASS=OPEN [60,60] } }", vec!["Transmit#1.start"], vec![five]),
        (
            "{ PASS=OPEN [60,60], { delay; Transmit() }, Store() }",
            vec!["Transmit#1.start", "Store#1.start"],
            vec![five, zero],
        ),
        (
            "{ { delay; choose { Transmit(), Store() } }, PASS=OPEN [60,60] }",
            vec!["Transmit#1.start"],
            vec![five],
        ),
        (
            "{ { choose { Transmit(), Store() } }, PASS=OPEN [60,60] }",
            vec!["Transmit#1.start", "Store#1.start"],
            vec![None, zero],
        ),
        (
            "{ { delay; Transmit() }, { Wake(); PASS=OPEN [60,60] } }",
            vec!["Wake#1.end", "Transmit#1.start"],
            vec![Some(Time::from(2)), five],
        ),
        (
            "{ { delay; Transmit() }, { delay[2,2]; { PASS=OPEN [60,60], Store() } } }",
            vec!["Store#1.start", "Transmit#1.start"],
            vec![Some(Time::from(2)), five],
        ),
        ("{ { delay; Transmit() }, Pass() }", vec!["Transmit#1.start"], vec![five]),
    ] {
        let source = format!("{declared} Pass() = {{ PASS=OPEN [60,60] }} scenario Day[0,120] = {scenario}");
        assert_eq!(times_when_late(&source, tell, &names), times, "{scenario}");
    }
}

/// An alternative that was not taken stays excluded once another one has started, however late its condition may come.
#[test]
fn a_late_condition_does_not_open_a_choice_again() {
    let network = compiled(
        "var A : {OFF, ON}; var B : {OFF, ON}; primitive Long()[20,20]; primitive Need()[5,5] requires B=ON;
         scenario Day[0,100] = { choose { { A=ON [1,1]; Long() }, { B=ON [5,30]; Long() } }, { delay[30,30]; A=OFF [1,1] } }",
    );
    let late = [
        Disturbance::Late { condition: "Tell(A=OFF)#1".into(), at: Time::from(50) },
        Disturbance::Late { condition: "Tell(B=ON)#1".into(), at: Time::from(40) },
    ];
    let (outcome, _) = execute(&network, &late);
    assert_eq!(outcome.ending, Ending::Finished, "{:?}", outcome.log);
    assert!(outcome.plans.iter().all(|it| it.plan.choices[0].alternative == 0));
}

/// SPEC 6.2: the rovers may arrive later than at the earliest moment, and everything behind waits for their report.
#[test]
fn what_follows_an_activity_at_once_waits_for_the_report_of_its_end() {
    let source = include_str!("../../../../tests/conformance/t01_enroute_scenario.rmpl");
    let network = compiled(source);
    let duration = Time::from(430);
    let longer = Disturbance::Duration { activity: "Group-Traverse-Path#1".into(), duration };
    let (outcome, facts) = execute(&network, &[longer]);
    assert_eq!(outcome.ending, Ending::Finished, "{:?}", outcome.log);
    assert!(facts.is_empty(), "the plan holds: it allows for arrivals from 415 to 460");
    let verdict = verify::check_schedule(&network, &outcome.last().plan, &outcome.last().times);
    assert!(verdict.valid, "{:?}", verdict.violations);
}

/// Returns what is withdrawn leaves one way under way and another one that opens later (SPEC 15).
fn two_ways(clause: &str) -> Arc<Network> {
    compiled(&format!(
        "primitive Walk(way)[20,40]{clause};
         var PATH1 : {{OK, GONE}};
         var PATH2 : {{OK, GONE}};
         scenario S[0,800] = {{
           {{ choose {{ do {{ Walk(A) }} maintaining PATH1=OK, do {{ Walk(B) }} maintaining PATH2=OK }} }},
           {{ PATH1=OK [300,300] }},
           {{ delay [200,200]; PATH2=OK [300,300] }}
         }}"
    ))
}

fn withdrawn(at: i64) -> Vec<Disturbance> {
    vec![Disturbance::Withdrawn { condition: "Tell(PATH1=OK)#1".into(), at: Time::from(at) }]
}

#[test]
fn an_abortable_activity_is_ended_early_and_the_other_alternative_is_taken() {
    let (outcome, facts) = execute(&two_ways(" aborts [3,5]"), &withdrawn(10));
    assert_eq!(outcome.ending, Ending::Finished, "{:#?}", outcome.log);
    let taken = facts.last().map(|facts| facts.taken_back.clone()).unwrap_or_default();
    assert_eq!(taken.len(), 1);
    assert_eq!(taken[0].since, Time::from(13));
    let time = |plan: &executive::ExecutedPlan, name: &str| {
        let occurrence = plan.network.occurrences.iter().find(|it| it.name == name).expect("an activity");
        [plan.times[occurrence.start.index()], plan.times[occurrence.end.index()]]
    };
    assert_eq!(time(&outcome.plans[0], "Walk#1"), [Some(Time::ZERO), None]);
    assert_eq!(time(outcome.last(), "Walk#2"), [Some(Time::from(200)), Some(Time::from(220))]);
    let words: Vec<(Time, &str)> = outcome
        .log
        .iter()
        .filter_map(|entry| match &entry.happening {
            Happening::Progress { text, .. } => Some((entry.time, text.as_str())),
            _ => None,
        })
        .collect();
    assert_eq!(words, [(Time::from(10), "is being ended early, until 13"), (Time::from(13), "has ended")]);
}

#[test]
fn what_cannot_be_aborted_stops_with_what_it_needed_and_when() {
    let (outcome, _) = execute(&two_ways(""), &withdrawn(10));
    assert_eq!(outcome.ending, Ending::Stopped);
    let Some(Happening::Stopped { reason }) = outcome.log.last().map(|entry| &entry.happening) else {
        panic!("{:#?}", outcome.log)
    };
    assert_eq!(
        reason,
        "Walk#1 needs PATH1=OK until 20, but PATH1=OK holds only until 10. Walk#1 is in progress and cannot be ended early."
    );
}

/// Plans with more events than the dispatchable form is made for run in the same way.
#[test]
fn plans_of_thousands_of_events_are_executed() {
    for (separator, end) in [("; ", 1200), (", ", 1)] {
        let calls = vec!["A()"; 1200].join(separator);
        let network = compiled(&format!("primitive A()[1,3]; scenario S[0,inf] = {{ {calls} }}"));
        let (outcome, facts) = execute(&network, &[]);
        assert_eq!(outcome.ending, Ending::Finished);
        assert!(facts.is_empty());
        assert_eq!(outcome.log.last().map(|entry| entry.time), Some(Time::from(end)));
        assert_eq!(outcome.last().times, verify::earliest_schedule(&outcome.last().plan));
        let late = Disturbance::Duration { activity: "A#700".into(), duration: Time::from(5) };
        let (outcome, _) = execute(&network, &[late]);
        let violation = outcome.log.iter().find(|it| matches!(it.happening, Happening::Violation { .. }));
        let at = if end == 1 { 3 } else { 702 };
        assert_eq!(violation.map(|entry| entry.time), Some(Time::from(at)));
        assert_eq!(outcome.ending, Ending::Finished);
        let verdict =
            verify::check_schedule(&outcome.last().network, &outcome.last().plan, &outcome.last().times);
        assert!(verdict.valid, "{:?}", verdict.violations);
    }
}

/// SPEC 15: any number of events executes. One thread and many, where each activity takes any time between its bounds.
#[test]
fn ten_thousand_activities_of_any_duration_are_executed_to_the_end() {
    for (threads, each) in [(1, 10_000), (1000, 10)] {
        let thread = format!("repeat {each} {{ A() }}");
        let all = vec![thread; threads].join(", ");
        let network = compiled(&format!("primitive A()[1,3];\nscenario S[0,40000] = {{ {all} }}"));
        let mut rng = Rng::new(3);
        let activities = network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive);
        let disturbances: Vec<Disturbance> = activities
            .map(|it| {
                let duration = Time::from(rng.between(100, 300)).checked_div(100).expect("a small time");
                Disturbance::Duration { activity: it.name.clone(), duration }
            })
            .collect();
        assert_eq!(disturbances.len(), 10_000);
        let (outcome, facts) = execute(&network, &disturbances);
        assert_eq!(outcome.ending, Ending::Finished, "{:?}", outcome.log.last());
        assert!(facts.is_empty(), "no duration is outside of its bounds");
        let verdict = verify::check_schedule(&network, &outcome.last().plan, &outcome.last().times);
        assert!(verdict.valid, "{:?}", verdict.violations.first());
        let lasts = |it: &Disturbance| {
            let Disturbance::Duration { activity, duration } = it else { panic!("{it:?}") };
            let of = network.occurrences.iter().find(|of| of.name == *activity).expect("it is known");
            let time = |node: tpn::NodeId| outcome.last().times[node.index()].expect("it has come");
            time(of.end).checked_sub(time(of.start)) == Some(*duration)
        };
        assert!(disturbances.iter().step_by(97).all(lasts), "each takes as long as it takes");
    }
}
