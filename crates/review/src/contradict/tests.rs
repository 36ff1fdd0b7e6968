//! Lines that promise too much are contradicted, and those of the examples are not.

use exact::{Bound, Rational, Time};
use executive::{Ending, Happening, Script};
use mission::{Core, Evaluated, Manner};
use snapshot::Goal;
use test_core::Answers;

use super::super::tests::{MISSION, SCENARIO, snapshot};
use super::super::{FlightRules, MissionRule, Outcome, Review, Section, review};
use super::schedules::{Made, Schedules};
use super::{Effort, Observed, Trial, Tried, Verdict, named_times};

const SCHEDULES: Effort = Effort { schedules: 100, runs: 0, seed: 1 };

/// The lines of a mission as schedules tried them, after `change` has changed its review.
fn tried(source: &str, rules: &[&str], change: impl FnOnce(&mut Review)) -> Vec<Tried> {
    let snapshot = snapshot(source);
    let mut reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let named = rules.iter().enumerate().map(|(at, rule)| MissionRule {
        name: format!("R{at}"),
        rule: (*rule).to_owned(),
        ..MissionRule::default()
    });
    let rules = FlightRules { rules: named.collect(), ..FlightRules::default() };
    reviewed.hold_against(&snapshot, &rules, None, &mut || false);
    change(&mut reviewed);
    let mut trial = Trial::new(&snapshot, &reviewed, None, SCHEDULES).expect("a plan");
    while trial.try_schedule() {}
    trial.tried().cloned().collect()
}

/// A mission, planned.
fn evaluated(core: &mut Core, source: &str) -> Evaluated {
    let mut host = Answers::default();
    let compiled = core.compile(&link::Update::new(1, source), &host);
    let ground = core.ground(&compiled.program).expect("its ground is known");
    core.plan(compiled, ground, Manner::default(), &mut host).expect("it has no errors")
}

/// A run that tells nothing of what vehicles see.
fn observed(log: &[executive::Entry], ending: Ending) -> Observed<'_> {
    Observed { log, ending, sight: &|_, _, _| None }
}

/// The lines of a mission as schedules and runs tried them, after `change` has changed its review; and how they are run.
fn run(source: &str, change: impl FnOnce(&mut Review)) -> (Vec<Tried>, Core, Evaluated) {
    let mut core = Core::default();
    let evaluated = evaluated(&mut core, source);
    let snapshot = evaluated.snapshot();
    let mut reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    change(&mut reviewed);
    let effort = Effort { schedules: 60, runs: 8, seed: 1 };
    let mut trial = Trial::new(&snapshot, &reviewed, None, effort).expect("a plan");
    // The core knows another build of this crate, so that its own loop cannot be used.
    while trial.try_schedule() {}
    while let Some(script) = trial.next_run() {
        let (log, ending) = replayed(&mut core, &evaluated, &script);
        trial.try_run(&script, &observed(&log, ending));
    }
    assert_eq!(trial.progress()[0], trial.progress()[1]);
    (trial.tried().cloned().collect(), core, evaluated)
}

/// Returns what happens in the run of a script.
fn replayed(core: &mut Core, evaluated: &Evaluated, script: &Script) -> (Vec<executive::Entry>, Ending) {
    evaluated.compiled.check_script(script).expect("it is about this mission");
    let ran = core.run(evaluated, script).expect("a plan").expect("its times fit");
    (ran.outcome.log, ran.outcome.ending)
}

/// The lines of a section that were contradicted, and those that survived.
fn outcomes(tried: &[Tried], section: Section) -> [usize; 2] {
    let of = tried.iter().filter(|it| it.line.section == section && it.schedules > 0);
    let (contradicted, survived): (Vec<&Tried>, Vec<&Tried>) = of.partition(|it| it.counterexample.is_some());
    [contradicted.len(), survived.len()]
}

const OPEN: &str = "state Mast : {UP, DOWN} = DOWN; resource Battery 0..100 = 60; var Sun : {UP, SET};
primitive Raise()[1,2] sets Mast=UP; primitive Drive()[5,9] consumes Battery 20;
primitive Talk()[2,3] requires Mast=UP, Sun=UP;
scenario Day[0,60] = { { Raise(); delay; Talk(); Drive() }, { delay; Drive() }, { Sun=UP [50,50] } }";

#[test]
fn a_line_that_promises_too_much_is_contradicted() {
    let rules = ["Battery >= 20", "Mast=UP while Talk"];
    let honest = tried(OPEN, &rules, |_| {});
    assert!(honest.iter().all(|it| it.counterexample.is_none()), "{honest:?}");
    for section in [Section::Plan, Section::CausalLinks, Section::Resources, Section::MissionRules] {
        assert!(outcomes(&honest, section)[1] > 0, "{section:?}: {honest:?}");
    }
    let levels = tried(OPEN, &rules, |review| {
        review.resources[0].levels =
            tpn::Levels::Range { low: Rational::from_integer(40), high: Rational::from_integer(60) };
    });
    assert_eq!(outcomes(&levels, Section::Resources), [1, 0]);
    let margins = tried(OPEN, &rules, |review| {
        for link in &mut review.causal_links {
            link.margin.greatest = Bound::Finite(Time::ONE);
            link.lead.greatest = Bound::ZERO;
        }
    });
    let [contradicted, _] = outcomes(&margins, Section::CausalLinks);
    assert!(contradicted > 0, "{margins:?}");
    // What is taken for held and is not.
    let rule = tried(OPEN, &["Battery > 20"], |review| {
        review.findings[0].outcome = Outcome::Holds;
        let rules = review.rules.clone();
        review.judge(&rules, None);
    });
    assert_eq!(outcomes(&rule, Section::MissionRules), [1, 0]);
    let found = rule.iter().find_map(|it| it.counterexample.as_ref()).expect("a counterexample");
    let time = |name: &str| found.script.schedule.get(name).copied();
    let both = [time("Drive#1.start"), time("Drive#2.start")].into_iter().max().flatten();
    assert_eq!(
        Some(found.text.clone()),
        both.map(|at| format!("it is not known to hold at {}", at.readable()))
    );
}

#[test]
fn durations_are_tried_at_their_declared_ends() {
    let source = "primitive A()[5,10]; primitive B()[1,2];
    scenario S[0,LAST] = { A(); B(), B() }";
    let of = |last: &str| {
        let all = tried(&source.replace("LAST", last), &[], |review| review.durations.clear());
        let is_it = |it: &Tried| it.line.section == Section::Durations;
        all.into_iter().find(is_it).expect("it has passed")
    };
    let free = of("30");
    assert_eq!((free.verdict(), free.schedules), (Verdict::Survived, 6), "two ends of three activities");
    let tight = of("10");
    assert_eq!(tight.sentence(), "contradicted: no schedule lets A#1 last 10");
}

/// A battery that is charged while a rover that consumes it drives.
const CHARGED: &str = "terrain \"tai-plain\" cell 0.6 origin (0, 0);
location P0 (70, 95); location P3 (96, 81); vehicle V0 : ATRV at P0; resource Battery 0..100 = 54;
primitive Drive(r, to) contingent [8,30] moves r speed (0.01, 0.3) consumes Battery 0.1 per metre;
primitive Charge()[10,10] produces Battery 15;
scenario S[0,230] = { Drive(V0, P3), Charge() }";

#[test]
fn a_drive_that_consumes_less_than_the_most_leaves_no_more_than_planned() {
    let (all, mut core, evaluated) = run(CHARGED, |_| {});
    let line = all.iter().find(|it| it.line.section == Section::Resources).expect("it has passed");
    assert!(
        line.line.text.ends_with("; for every distance that drives may take along their paths"),
        "{line:?}"
    );
    assert_eq!((line.verdict(), line.runs), (Verdict::Survived, 8), "{line:?}");
    // Had the plan counted on the most, the line would be contradicted.
    let network = &evaluated.planned.network;
    let used = network.uses.iter().find(|used| used.at_least < used.amount).expect("it drives");
    let spread = used.amount.checked_sub(used.at_least).expect("it fits");
    let lowered = |high: Rational| high.checked_sub(spread).expect("it fits");
    let (all, ..) = run(CHARGED, |review| {
        let tpn::Levels::Range { low, high } = review.resources[0].levels else { panic!("a reservoir") };
        review.resources[0].levels = tpn::Levels::Range { low, high: lowered(high) };
    });
    let line = all.iter().find(|it| it.line.section == Section::Resources).expect("it has passed");
    assert_eq!(line.verdict(), Verdict::Contradicted);
    // Nor does a flight rule hold that only a drive keeps which takes the most.
    let snapshot = evaluated.snapshot();
    let mut reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let tpn::Levels::Range { high, .. } = reviewed.resources[0].levels else { panic!("a reservoir") };
    let rule = |name: &str, most: Rational| {
        let most = Rational::from_f64_up(most.to_f64(), 100).expect("it fits");
        MissionRule { name: name.to_owned(), rule: format!("Battery <= {most}"), ..MissionRule::default() }
    };
    let rules = vec![rule("most", lowered(high)), rule("least", high)];
    reviewed.hold_against(&snapshot, &FlightRules { rules, ..FlightRules::default() }, None, &mut || false);
    let outcomes: Vec<&Outcome> = reviewed.findings.iter().map(|it| &it.outcome).collect();
    assert!(!matches!(outcomes[0], Outcome::Holds) && matches!(outcomes[1], Outcome::Holds), "{outcomes:?}");
    // Runs tell the same, by what the drive consumes in them.
    reviewed.findings[0].outcome = Outcome::Holds;
    let rules = reviewed.rules.clone();
    reviewed.judge(&rules, None);
    let mut trial =
        Trial::new(&snapshot, &reviewed, None, Effort { schedules: 0, runs: 8, seed: 1 }).expect("a plan");
    while let Some(script) = trial.next_run() {
        let (log, ending) = replayed(&mut core, &evaluated, &script);
        trial.try_run(&script, &observed(&log, ending));
    }
    let of_rules = trial.tried().filter(|it| it.line.section == Section::MissionRules);
    let verdicts: Vec<_> = of_rules.map(|it| (it.verdict(), it.runs > 0)).collect();
    assert_eq!(verdicts, [(Verdict::Contradicted, true), (Verdict::Survived, true)]);
}

/// A battery that a drive makes room in for a charge: enough, if it drives as far as it does at most.
#[test]
fn no_plan_relies_on_a_drive_that_takes_the_most() {
    let with = |level: &str| {
        CHARGED
            .replace("= 54", &format!("= {level}"))
            .replace("Drive(V0, P3), Charge()", "Drive(V0, P3); Charge()")
    };
    // A path of 30 m: from 2.6 to 4.3 of the battery.
    let tight = snapshot(&with("89"));
    assert!(tight.plan().is_none(), "there may be no room for 15");
    let planning = tight.planning.as_ref().expect("it was planned");
    let failure = planning.outcome.failure.as_ref().expect("it is explained");
    let told: Vec<&str> = failure.reasons.iter().map(|it| it.message.as_str()).collect();
    assert!(
        told.iter()
            .any(|it| it.contains("depending on the distance that is really driven, Drive(V0, P3) takes ")),
        "{told:?}"
    );
    let (all, ..) = run(&with("87"), |_| {});
    let contradicted: Vec<&Tried> = all.iter().filter(|it| it.verdict() == Verdict::Contradicted).collect();
    assert!(contradicted.is_empty(), "{contradicted:?}");
}

#[test]
fn what_stays_as_it_is_is_tried_in_runs() {
    let source = "state ARM : {STOWED, OUT} = STOWED; state LAMP : {ON, OFF} = OFF;
    primitive Drive()[5,10] requires ARM=STOWED; primitive Switch()[1,1] sets LAMP=ON;
    scenario S[0,100] = { Drive(), Switch() }";
    let line = |tried: &[Tried], text: &str| {
        tried.iter().find(|it| it.line.text.starts_with(text)).cloned().expect("it has passed")
    };
    let (honest, ..) = run(source, |_| {});
    assert_eq!(line(&honest, "ARM stays STOWED").how(), "1 run");
    let (all, ..) = run(source, |review| {
        for line in review.states.iter_mut().filter(|it| it.text.starts_with("LAMP")) {
            (line.names, line.text) = (vec!["LAMP".to_owned()], "LAMP stays OFF".to_owned());
        }
    });
    let lamp = line(&all, "LAMP stays OFF");
    assert_eq!(lamp.verdict(), Verdict::Contradicted, "{lamp:?}");
}

#[test]
fn no_schedule_contradicts_what_the_reviews_of_examples_have_passed() {
    let examples: [(&str, &[&str]); 6] = [
        (MISSION, &["PATH1=OK while Group-Traverse-Path", "never Group-Wait while PROCEED=OK"]),
        (SCENARIO, &["PROCEED!=OK while Group-Wait"]),
        (
            include_str!("../../../../assets/missions/arm.rmpl"),
            &["ARM=OUT while Dig", "never Drive while ARM=OUT"],
        ),
        (include_str!("../../../../assets/missions/battery.rmpl"), &["Battery >= 10", "Battery <= 100"]),
        (include_str!("../../../../assets/missions/storm.rmpl"), &["RELAY=UP while Send"]),
        (include_str!("../../../../assets/missions/sol.rmpl"), &["RELAY=UP while Downlink", "Memory <= 400"]),
    ];
    for (source, rules) in examples {
        let found = tried(source, rules, |_| {});
        assert!(found.iter().any(|it| it.schedules > 1), "{found:?}");
        let contradicted: Vec<&Tried> = found.iter().filter(|it| it.counterexample.is_some()).collect();
        assert!(contradicted.is_empty(), "{contradicted:?}");
    }
}

/// The environment chooses how long Drill takes, and the battery is charged meanwhile.
const NATURE: &str = "resource Battery 0..100 = 50; state Arm : {IN, OUT} = IN;
primitive Drill() contingent [3,8] consumes Battery 20; primitive Extend()[1,2] sets Arm=OUT;
primitive Charge()[2,4] produces Battery 30; location A (0, 0); vehicle Rover : ATRV at A;
scenario S[0,40] = { { Extend(); Drill(); delay }, { delay; Charge(); delay } }";

#[test]
fn a_counterexample_is_a_run_that_replays() {
    // A level that only some schedules leave.
    let (tried, mut core, evaluated) = run(NATURE, |review| {
        review.resources[0].levels =
            tpn::Levels::Range { low: Rational::from_integer(50), high: Rational::from_integer(100) };
    });
    let fell = |section: Section| tried.iter().filter(move |it| it.line.section == section);
    let found = fell(Section::Resources).find_map(|it| it.counterexample.clone()).expect("a counterexample");
    let (log, _) = replayed(&mut core, &evaluated, &found.script);
    let times: Vec<(&str, Time)> = log
        .iter()
        .filter_map(|entry| match &entry.happening {
            Happening::Executed { name } => Some((name.as_str(), entry.time)),
            _ => None,
        })
        .collect();
    let is_violated = log.iter().any(|entry| matches!(entry.happening, Happening::Violation { .. }));
    assert!(!found.script.schedule.is_empty() && !is_violated, "{found:?} {log:?}");
    for (name, time) in &times {
        assert_eq!(found.script.schedule.get(*name), Some(time), "{name}: {found:?}");
    }
    let is_low = |entry: &executive::Entry| matches!(&entry.happening, Happening::Level { level, .. } if *level < Rational::from_integer(50));
    assert!(log.iter().any(is_low), "{log:?}");
    // Its JSON is a script, too.
    let text = serde_json::to_string(&found.script).expect("JSON");
    assert_eq!(serde_json::from_str::<Script>(&text).expect("a script"), found.script);
}

#[test]
fn every_schedule_is_executed_at_its_times() {
    for source in [NATURE, OPEN, include_str!("../../../../assets/missions/arm.rmpl")] {
        let mut core = Core::default();
        let evaluated = evaluated(&mut core, source);
        let network = std::sync::Arc::clone(&evaluated.planned.network);
        let plan = evaluated.planned.planning.outcome.plans.first().expect("a plan").clone();
        let mut schedules = Schedules::new(&network, &plan, 3).expect("its times fit");
        let mut executed = 0;
        for _ in 0..15 {
            let Made::New { times, .. } = schedules.make() else { continue };
            let script = Script { schedule: named_times(&network, &plan, &times), ..Script::default() };
            let (log, ending) = replayed(&mut core, &evaluated, &script);
            assert_eq!(ending, Ending::Finished, "{script:?} {log:?}");
            for entry in &log {
                assert!(!matches!(entry.happening, Happening::Violation { .. }), "{script:?} {log:?}");
                if let Happening::Executed { name } = &entry.happening {
                    assert_eq!(script.schedule.get(name), Some(&entry.time), "{name}: {script:?}");
                    executed += 1;
                }
            }
        }
        assert!(executed > 50, "{executed} {source}");
    }
}

#[test]
fn nature_is_tried_at_both_ends_of_its_ranges_and_against_the_plan() {
    let (tried, ..) = run(NATURE, |_| {});
    assert!(tried.iter().all(|it| it.counterexample.is_none()), "{tried:?}");
    let runs = tried.iter().find(|it| it.line.text.contains("dynamically controllable"));
    assert_eq!(runs.map(|it| (it.schedules, it.runs)), Some((0, 8)), "{tried:?}");
    for section in [Section::States, Section::Resources] {
        let all = tried.iter().filter(|it| it.line.section == section);
        assert!(
            all.clone().count() > 0 && all.clone().all(|it| it.verdict() == Verdict::Survived),
            "{tried:?}"
        );
    }
    // A duration that the environment has beyond the range of a line.
    let mut core = Core::default();
    let evaluated = evaluated(&mut core, NATURE);
    let script = |drill: i64| Script {
        nature: [("Drill#1".into(), Time::from(drill))].into(),
        run_seed: Some(7),
        ..Script::default()
    };
    for drill in [3, 8] {
        let (log, ending) = replayed(&mut core, &evaluated, &script(drill));
        let came = |event: &str| {
            let is_it = |it: &&executive::Entry| matches!(&it.happening, Happening::Executed { name } if name == event);
            log.iter().find(is_it).map(|it| it.time).expect("it happens")
        };
        let lasted = came("Drill#1.end").checked_sub(came("Drill#1.start"));
        assert_eq!((lasted, ending), (Some(Time::from(drill)), Ending::Finished));
    }
    let unknown = Script { nature: [("Dig#1".into(), Time::ONE)].into(), ..Script::default() };
    assert!(evaluated.compiled.check_script(&unknown).is_err());
    let unknown = Script { schedule: [("Dig#1.start".into(), Time::ONE)].into(), ..Script::default() };
    assert!(evaluated.compiled.check_script(&unknown).is_err());
}

#[test]
fn overlaps_orders_and_choices_are_tried() {
    let source = "location A (0, 0); vehicle Rover : ATRV at A; state Arm : {IN, OUT} = IN;
primitive Extend()[1,2] sets Arm=OUT; primitive Retract()[1,2] sets Arm=IN; primitive Look()[1,3];
scenario S[0,40] = { delay; Extend(); delay; Retract(); choose { Look(), delay[9,9] } }";
    let (tried, ..) = run(source, |_| {});
    for section in [Section::Overlaps, Section::States, Section::Choices] {
        let mut all = tried.iter().filter(|it| it.line.section == section).peekable();
        assert!(
            all.peek().is_some() && all.all(|it| it.verdict() == Verdict::Survived),
            "{section:?} {tried:?}"
        );
    }
    // What is taken for kept apart and is not.
    let source =
        "location A (0, 0); vehicle Rover : ATRV at A; primitive Drill()[3,5]; primitive Brush()[2,4];
scenario S[0,20] = { Drill(), { delay; Brush() } }";
    let (tried, mut core, evaluated) = run(source, |review| {
        for line in &mut review.overlaps {
            line.status = super::super::Status::Passed;
            line.names = vec!["Rover".to_owned()];
        }
    });
    let fell = tried.iter().find(|it| it.line.section == Section::Overlaps).expect("a line");
    let found = fell.counterexample.as_ref().expect("the two overlap in some schedule");
    assert!(found.text.contains("are both in progress"), "{found:?}");
    let (log, ending) = replayed(&mut core, &evaluated, &found.script);
    assert!(ending == Ending::Finished && !log.is_empty());
}

#[test]
fn one_line_alone_is_tried_and_few_schedules_are_not_counted_twice() {
    let source = "primitive Walk()[5,5]; scenario S[0,9] = { Walk() }";
    let snapshot = snapshot(source);
    let reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let all = Trial::new(&snapshot, &reviewed, None, SCHEDULES).expect("a plan");
    let line = all.tried().find(|it| it.line.section == Section::Plan).expect("a line").line.clone();
    let mut trial = Trial::new(&snapshot, &reviewed, Some(&line), SCHEDULES).expect("a plan");
    while trial.try_schedule() {}
    let tried: Vec<&Tried> = trial.tried().collect();
    assert_eq!(tried.len(), 1);
    // Walk starts at 0; only the end of the scenario moves.
    let [only] = tried.as_slice() else { panic!("one line") };
    assert!((1..=100).contains(&only.schedules), "{only:?}");
    let fixed = "primitive Walk()[5,5]; scenario S[5,5] = { Walk() }";
    let [tried] = &tried_by(fixed)[..1] else { panic!("a line") };
    assert_eq!(tried.schedules, 1, "there is one schedule");
    assert_eq!(tried.sentence(), "survived 1 schedule");
}

fn tried_by(source: &str) -> Vec<Tried> {
    tried(source, &[], |_| {})
}

#[test]
fn changes_to_one_value_are_told_in_any_order() {
    let source = "state X : {A, B} = A; primitive P()[1,2] sets X=B;
scenario S[0,30] = { { delay[0,9]; X=A [1,2] }, { delay[0,9]; X=A [1,2] }, { delay[15,20]; P() } }";
    let (tried, ..) = run(source, |_| {});
    let line = tried.iter().find(|it| it.line.text.starts_with("X is A, then A")).expect("a line");
    assert_eq!(
        line.line.text, "X is A, then A (Tell(X=A)#1 and Tell(X=A)#2, in any order), then B (P#1)",
        "their order is not the plan's to keep"
    );
    assert_eq!(line.verdict(), Verdict::Survived, "{line:?}");
}

#[test]
fn a_contact_in_a_run_contradicts_that_vehicles_keep_apart() {
    let source = "location A (0, 0); location B (30, 0); location C (0, 30); location D (30, 30);
        vehicle R1 : ATRV at A; vehicle R2 : ATRV at C;
        primitive Drive(r, to)[0,100] moves r;
        scenario S[0,100] = { Drive(R1, B), Drive(R2, D) }";
    let snapshot = snapshot(source);
    let reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let of = |is_contact: bool| {
        let mut trial = Trial::new(&snapshot, &reviewed, None, Effort::default()).expect("a plan");
        let reason = "R1 and R2 touch".to_owned();
        let happening = Happening::Violation { name: "Drive#1.end".into(), reason, is_contact };
        let log = [executive::Entry { time: Time::from(2), happening }];
        trial.try_run(&Script::default(), &observed(&log, Ending::Stopped));
        let line = trial.tried().find(|it| it.line.section == Section::SeparationViolations);
        line.expect("vehicles keep apart").verdict()
    };
    assert_eq!(of(true), Verdict::Contradicted);
    assert_eq!(of(false), Verdict::Survived);
}

#[test]
fn a_drive_that_another_event_stops_is_not_contradicted() {
    let source = "location A (0, 0); location B (30, 0); vehicle R1 : ATRV at A; vehicle R2 : ATRV at B;
        primitive Drive(r, to)[1,100] moves r; scenario S[0,100] = { Drive(R1, A); Drive(R2, A) }";
    let snapshot = snapshot(source);
    let reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let of = |stopped_by: &str, at: i64| {
        let mut trial = Trial::new(&snapshot, &reviewed, None, Effort::default()).expect("a plan");
        let entry = |time: i64, happening| executive::Entry { time: Time::from(time), happening };
        let reason = "late".to_owned();
        let log = [
            entry(0, Happening::Executed { name: "Drive#1.start".into() }),
            entry(at, Happening::Violation { name: stopped_by.into(), reason, is_contact: false }),
        ];
        trial.try_run(&Script::default(), &observed(&log, Ending::Stopped));
        let line = trial.tried().find(|it| it.line.text.starts_with("Drive(R1, A): ")).expect("it drives");
        line.verdict()
    };
    assert_ne!(of("Drive#2.end", 5), Verdict::Contradicted);
    assert_eq!(of("Drive#1.end", 5), Verdict::Contradicted);
    assert_eq!(of("Drive#2.end", 101), Verdict::Contradicted, "it is late as well");
}

#[test]
fn a_level_that_is_required_is_tried_in_schedules() {
    let source = "resource Battery 0..100 = 50; primitive Dig()[1,2] requires Battery >= 30 at start consumes Battery 10;
                  scenario S[0,9] = { Dig() }";
    let tried = tried(source, &[], |_| ());
    let level = tried.iter().find(|it| it.line.text.contains("requires Battery >= 30")).expect("a line");
    assert!(level.schedules > 0 && level.counterexample.is_none(), "{level:?}");
}
