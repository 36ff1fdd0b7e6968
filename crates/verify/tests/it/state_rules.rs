//! Each rule of state that lasts (SPEC 10.2) in the check of plans: plans that keep it, and what is said of those that
//! break it.

use serde_json::Value;
use tpn::plan_json::plan_to_json;
use tpn::{CausalLink, Departure, Network, Ordering, Plan};
use verify::{Rule, Violation, check_plan, check_schedule, earliest_schedule};

use crate::missions::{LOOK_BEFORE_OPEN, MUTUAL_SUPPORT, Sketch, label, network, plan, time, windows};

/// One of the conformance cases: its text and what is expected.
macro_rules! case {
    ($name:literal) => {
        (
            include_str!(concat!("../../../../tests/conformance/", $name, ".rmpl")),
            include_str!(concat!("../../../../tests/conformance/", $name, ".json")),
        )
    };
}

fn violations(network: &Network, plan: &Plan) -> Vec<Violation> {
    let verdict = check_plan(network, plan);
    assert_eq!(verdict.valid, verdict.violations.is_empty());
    verdict.violations
}

fn said_of(text: &str, sketch: Sketch<'_>) -> Vec<Violation> {
    let network = network(text);
    violations(&network, &plan(&network, sketch))
}

#[track_caller]
fn only(found: &[Violation], rule: Rule, names: &[&str], words: &str) {
    let [violation] = found else { panic!("not one violation: {found:#?}") };
    let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
    assert_eq!((violation.rule, &violation.intervals), (rule, &names), "{violation:?}");
    assert!(violation.message.contains(words), "{violation:?}");
}

/// The plan of a conformance case is accepted, and so is its earliest schedule; its windows are those of the case.
#[track_caller]
fn accepted((text, case): (&str, &str), sketch: Sketch<'_>) {
    let network = network(text);
    let plan = plan(&network, sketch);
    assert_eq!(violations(&network, &plan), []);
    let verdict = check_schedule(&network, &plan, &earliest_schedule(&plan));
    assert!(verdict.valid, "{:#?}", verdict.violations);
    let case: Value = serde_json::from_str(case).expect("a case is JSON");
    let made = plan_to_json(&network, &plan);
    for (event, window) in case["expect"]["windows"].as_object().into_iter().flatten() {
        assert_eq!(&made["windows"][event], window, "{event}");
    }
    for (event, times) in case["expect"]["earliest"].as_object().into_iter().flatten() {
        let times = times.as_array().expect("a list of times");
        assert!(times.contains(&made["windows"][event][0]), "{event}: {}", made["windows"][event]);
    }
}

const DEPLOY: &str = "Set(ARM=OUT)@Deploy#1";
const STOW: &str = "Set(ARM=IN)@Stow#1";
const DIG: &str = "Ask(ARM=OUT)@Dig#1";
const LOOK: &str = "Ask(ARM=IN)@Look#1";
const FIRST: &str = "Init(ARM=IN)";

#[test]
fn values_last_across_gaps() {
    let sketch = Sketch { links: &[(DIG, DEPLOY)], states: &[&[FIRST, DEPLOY]], ..Sketch::default() };
    accepted(case!("s01_persistence"), sketch);
}

#[test]
fn nothing_has_the_value_while_it_changes() {
    let sketch = Sketch {
        links: &[(LOOK, FIRST)],
        states: &[&[FIRST, DEPLOY]],
        added: &[(LOOK, DEPLOY)],
        ..Sketch::default()
    };
    accepted(case!("s02_effect_while_changing"), sketch);
    // Without the ordering nothing keeps the two apart.
    let found = said_of(case!("s02_effect_while_changing").0, Sketch { added: &[], ..sketch });
    only(&found, Rule::State, &[LOOK, DEPLOY], "Deploy#1 changes ARM while Look#1 requires ARM=IN");
}

const OPEN: &str = "Set(DOOR=OPEN)@Open#1";
const CLOSE: &str = "Set(DOOR=SHUT)@Close#1";
const BEFORE_OPEN: &str = "Ask(DOOR=SHUT)@Open#1";
const BEFORE_CLOSE: &str = "Ask(DOOR=OPEN)@Close#1";
const SHUT: &str = "Init(DOOR=SHUT)";
const DOOR: Sketch<'static> = Sketch {
    choices: &[],
    links: &[(BEFORE_OPEN, SHUT), (BEFORE_CLOSE, OPEN)],
    order: &[],
    states: &[&[SHUT, OPEN, CLOSE]],
    added: &[],
};

#[test]
fn what_requires_and_sets_requires_at_its_start() {
    accepted(case!("s03_requires_and_sets"), DOOR);
    // Both requirements are where their producers are in the order; nothing else is right.
    let found = said_of(case!("s03_requires_and_sets").0, Sketch { states: &[&[SHUT, CLOSE, OPEN]], ..DOOR });
    only(&found[..1], Rule::State, &[CLOSE, OPEN], "may overlap");
}

const STOW_FIRST: Sketch<'static> = Sketch {
    choices: &[],
    links: &[(DIG, DEPLOY)],
    order: &[],
    states: &[&[FIRST, STOW, DEPLOY]],
    added: &[(STOW, DEPLOY)],
};
const STOW_LAST: Sketch<'static> = Sketch {
    choices: &[],
    links: &[(DIG, DEPLOY)],
    order: &[],
    states: &[&[FIRST, DEPLOY, STOW]],
    added: &[(DIG, STOW)],
};

#[test]
fn a_threat_is_resolved_before_or_after() {
    accepted(case!("s04_threat_both_ways"), STOW_FIRST);
    accepted(case!("s04_threat_both_ways"), STOW_LAST);
}

/// What changes a variable is in its list once, and nothing else is.
#[test]
fn the_order_of_a_variable_lists_each_change_once() {
    let text = case!("s04_threat_both_ways").0;
    for good in [STOW_FIRST, STOW_LAST] {
        let order = good.states[0];
        // The initial value goes without saying.
        assert_eq!(said_of(text, Sketch { states: &[&order[1..]], ..good }), []);
        for left_out in 1..order.len() {
            let mut fewer = order.to_vec();
            let missing = fewer.remove(left_out);
            let found = said_of(text, Sketch { states: &[&fewer], ..good });
            let words = format!("does not say where {missing} is in the order of ARM");
            assert!(
                found.iter().any(|it| it.rule == Rule::State && it.message.contains(&words)),
                "{found:#?}"
            );
            let mut twice = order.to_vec();
            twice.push(missing);
            let found = said_of(text, Sketch { states: &[&twice], ..good });
            only(&found[..1], Rule::State, &[missing], "appears twice in the order of ARM");
        }
        let none = said_of(text, Sketch { states: &[], ..good });
        assert!(none.iter().any(|it| it.message.contains("does not say where")), "{none:#?}");
        let mut reversed = order.to_vec();
        reversed.swap(1, 2);
        let found = said_of(text, Sketch { states: &[&reversed], ..good });
        assert!(found.iter().any(|it| it.rule == Rule::State), "{found:#?}");
        let with_need = [order, &[DIG]].concat();
        let found = said_of(text, Sketch { states: &[&with_need], ..good });
        only(&found[..1], Rule::State, &[DIG], "changes nothing");
        let found = said_of(text, Sketch { states: &[order, order], ..good });
        assert!(found.iter().any(|it| it.message == "ARM has two orders"), "{found:#?}");
        let found = said_of(text, Sketch { added: &[], ..good });
        let may_overlap = |it: &Violation| it.rule == Rule::State && it.message.contains("may overlap");
        assert!(found.iter().any(may_overlap), "{found:#?}");
        assert!(found.iter().all(|it| it.rule == Rule::State), "{found:#?}");
    }
}

#[test]
fn changes_do_not_overlap() {
    let text = case!("s04_threat_both_ways").0;
    // Stow is said to be first, and nothing sees to it.
    let found = said_of(text, Sketch { added: &[], ..STOW_FIRST });
    only(&found[..1], Rule::State, &[STOW, DEPLOY], "Stow#1 changes ARM while Deploy#1 changes ARM");
    // Nothing sees to it that Dig finds what it needs, either.
    only(&found[1..], Rule::State, &[STOW, DIG], "when Dig#1 needs it");
    let backwards = Sketch { states: &[&[STOW, FIRST, DEPLOY]], ..STOW_FIRST };
    let found = said_of(text, backwards);
    let is_first =
        |it: &Violation| it.rule == Rule::State && it.message.contains("where ARM has its first value");
    assert!(found.iter().any(is_first), "{found:#?}");
}

#[test]
fn requirements_are_linked_to_one_producer_of_their_value() {
    let text = case!("s04_threat_both_ways").0;
    let found = said_of(text, Sketch { links: &[], ..STOW_FIRST });
    only(&found, Rule::Support, &[DIG], "has no causal link");
    let found = said_of(text, Sketch { links: &[(DIG, STOW)], ..STOW_FIRST });
    only(&found, Rule::Support, &[DIG, STOW], "does not make the requirement hold");
    let found = said_of(text, Sketch { links: &[(DIG, DEPLOY), (DIG, DEPLOY)], ..STOW_FIRST });
    only(&found, Rule::Support, &[DIG], "has 2 causal links");
}

/// A requirement that begins before its producer is ready contradicts the link.
#[test]
fn producers_are_ready_in_time() {
    let text = "state ARM : {IN, OUT} = IN;
        primitive Deploy() [5,5] sets ARM=OUT;
        primitive Dig() [10,10] requires ARM=OUT;
        scenario S [0,40] = { Deploy(), Dig() }";
    let sketch = Sketch { links: &[(DIG, DEPLOY)], states: &[&[FIRST, DEPLOY]], ..Sketch::default() };
    let found = said_of(text, sketch);
    assert!(matches!(found.as_slice(), [it] if it.rule == Rule::Temporal), "{found:#?}");
    assert!(found[0].message.contains("must start when Set(ARM=OUT)@Deploy#1 is ready"), "{found:#?}");
}

/// Not even where it has no length.
#[test]
fn nothing_rests_on_its_own_effect() {
    let text = "state ARM : {IN, OUT} = IN;
        primitive Shake() [0,0] requires ARM=OUT sets ARM=OUT; primitive Deploy() [1,1] sets ARM=OUT;
        scenario S [0,9] = { { delay[2,2]; Shake() }, Deploy() }";
    let (shake, needs) = ("Set(ARM=OUT)@Shake#1", "Ask(ARM=OUT)@Shake#1");
    let good = Sketch { links: &[(needs, DEPLOY)], states: &[&[FIRST, DEPLOY, shake]], ..Sketch::default() };
    assert_eq!(said_of(text, good), []);
    let found = said_of(text, Sketch { links: &[(needs, shake)], ..good });
    only(&found, Rule::Support, &[needs, shake], "cannot rely on its own effect");
    // Without Deploy no schedule is right either.
    let network = network(&text.replace("Deploy() }", "Wait()[1,1] }"));
    let plan = plan(&network, Sketch::default());
    let verdict = check_schedule(&network, &plan, &earliest_schedule(&plan));
    only(&verdict.violations, Rule::State, &[needs, FIRST], "contradicts it");
}

/// The gap is for variables that do not last: what is required may begin the moment it is so.
#[test]
fn touching_is_allowed_whatever_the_gap() {
    let text = "option threat_gap = 5;
        state ARM : {IN, OUT} = IN;
        primitive Deploy() [5,5] sets ARM=OUT;
        primitive Stow() [5,5] sets ARM=IN;
        scenario S [10,10] = { { delay; Deploy() }, { delay; Stow() } }";
    let good = Sketch { states: &[&[FIRST, DEPLOY, STOW]], added: &[(DEPLOY, STOW)], ..Sketch::default() };
    assert_eq!(said_of(text, good), []);
}

/// An assertion keeps its value to its end, and beyond; two that say the same may overlap.
#[test]
fn assertions_keep_their_value_and_leave_it_behind() {
    let text = "state GATE : {OPEN, SHUT} = SHUT;
        primitive Pass() [2,2] requires GATE=OPEN;
        scenario S [0,30] = { { delay[5,5]; GATE=OPEN [4,4] }, { delay[7,7]; GATE=OPEN [4,4] }, { delay[20,20]; Pass() } }";
    let (one, two, pass, shut) = (
        "Tell(GATE=OPEN)@Tell(GATE=OPEN)#1",
        "Tell(GATE=OPEN)@Tell(GATE=OPEN)#2",
        "Ask(GATE=OPEN)@Pass#1",
        "Init(GATE=SHUT)",
    );
    for link in [one, two] {
        for states in [[shut, one, two], [shut, two, one]] {
            let sketch = Sketch { links: &[(pass, link)], states: &[&states], ..Sketch::default() };
            assert_eq!(said_of(text, sketch), []);
        }
    }
    let added = [(one, two)];
    let sketch =
        Sketch { links: &[(pass, one)], states: &[&[shut, one, two]], added: &added, ..Sketch::default() };
    let found = said_of(&text.replace("GATE=OPEN [4,4]", "GATE=OPEN [1,4]"), sketch);
    only(&found, Rule::State, &[one, two], "but the plan's order of changes lacks this pair");
}

/// Several values at one instant have an order, and it decides what holds afterwards.
#[test]
fn ties_are_decided_by_an_order_without_circles() {
    let text = "state X : {A, B, C} = A;
        primitive Use() [3,3] requires X=B;
        scenario S [0,9] = { X=A, X=B, X=C, { delay[2,2]; Use() } }";
    let (first, a, b, c, needs) = (
        "Init(X=A)",
        "Tell(X=A)@Tell(X=A)#1",
        "Tell(X=B)@Tell(X=B)#1",
        "Tell(X=C)@Tell(X=C)#1",
        "Ask(X=B)@Use#1",
    );
    let sketch = |order: [&str; 3], added: &[(&str, &str)]| {
        let states = [first, order[0], order[1], order[2]];
        said_of(text, Sketch { links: &[(needs, b)], states: &[&states], added, ..Sketch::default() })
    };
    // B is last.
    for (one, other) in [(a, c), (c, a)] {
        let order = [one, other, b];
        assert_eq!(sketch(order, &[(one, other), (other, b)]), []);
        // Nothing that is only said makes it so.
        for (added, missing) in [((one, other), [other, b]), ((other, b), [one, other])] {
            only(&sketch(order, &[added])[..1], Rule::State, &missing, "may overlap");
        }
    }
    // What was added goes round in a circle.
    let found = sketch([a, c, b], &[(a, c), (c, b), (b, a)]);
    assert!(matches!(found.as_slice(), [it] if it.rule == Rule::Temporal), "{found:#?}");
    assert!(found[0].message.contains("would have to happen before the next"), "{found:#?}");
    assert_eq!(found[0].events.len(), 6, "{found:#?}");
    // What was added is another order than the one that is stated.
    let found = sketch([a, c, b], &[(c, a), (a, b), (c, b)]);
    assert!(
        found.iter().any(|it| it.message.contains("but the plan's order of changes lacks this pair")),
        "{found:#?}"
    );
    // C is last, and Use requires B.
    let found = sketch([a, b, c], &[(a, b), (b, c)]);
    only(&found, Rule::State, &[needs, c], "Tell(X=C)#1 keeps X=C while Use#1 requires X=B");
}

/// Each needs the effect of the other at the same instant: whichever happens first lacks its condition (SPEC 10.4).
#[test]
fn activities_without_length_do_not_support_each_other() {
    let network = network(MUTUAL_SUPPORT);
    let (x, y) = ("Set(X=T)@B#1", "Set(Y=T)@A#1");
    let (needs_x, needs_y) = ("Ask(X=T)@A#1", "Ask(Y=T)@B#1");
    let (no_x, no_y) = ("Init(X=F)", "Init(Y=F)");
    let states: [&[&str]; 2] = [&[no_x, x], &[no_y, y]];
    let circle = Sketch { links: &[(needs_x, x), (needs_y, y)], states: &states, ..Sketch::default() };
    let found = violations(&network, &plan(&network, circle));
    assert!(matches!(found.as_slice(), [it] if it.rule == Rule::Temporal), "{found:#?}");
    assert_eq!(found[0].events.len(), 4, "{found:#?}");
    for name in ["A#1.start", "A#1.end", "B#1.start", "B#1.end"] {
        assert!(found[0].events.iter().any(|event| event == name), "{found:#?}");
    }
    assert!(found[0].message.contains("must start when Set(X=T)@B#1 is ready"), "{found:#?}");
}

/// The text has Look before Open, though both come at one time.
#[test]
fn what_comes_later_in_a_sequence_does_not_support_what_comes_before() {
    let (look, open, shut) = ("Ask(DOOR=OPEN)@Look#1", "Set(DOOR=OPEN)@Open#1", "Init(DOOR=SHUT)");
    let sketch = Sketch { links: &[(look, open)], states: &[&[shut, open]], ..Sketch::default() };
    let text = LOOK_BEFORE_OPEN;
    let found = said_of(text, sketch);
    assert!(matches!(found.as_slice(), [it] if it.rule == Rule::Temporal), "{found:#?}");
    // The other way round it does.
    assert_eq!(said_of(&text.replace("Look(); Open()", "Open(); Look()"), sketch), []);
}

/// A change at the very instant at which a requirement starts is before or after it, and the plan says which.
#[test]
fn what_changes_at_one_instant_is_ordered_with_what_is_required_there() {
    let text = "state DOOR : {OPEN, SHUT} = OPEN;
        primitive Shut() [0,0] sets DOOR=SHUT; primitive Look() [0,0] requires DOOR=OPEN;
        scenario S [0,9] = { { delay[2,2]; Shut() }, { delay[2,2]; Look() } }";
    let (look, shut, open) = ("Ask(DOOR=OPEN)@Look#1", "Set(DOOR=SHUT)@Shut#1", "Init(DOOR=OPEN)");
    let sketch = Sketch { links: &[(look, open)], states: &[&[open, shut]], ..Sketch::default() };
    only(&said_of(text, sketch), Rule::State, &[look, shut], "may overlap");
    assert_eq!(said_of(text, Sketch { added: &[(look, shut)], ..sketch }), []);
}

/// Two requirements of one value by one activity: at its start, as it changes the variable, and throughout.
#[test]
fn each_requirement_of_an_activity_has_a_name_of_its_own() {
    let text = "state ARM : {A, B} = A; primitive Dig()[0,4] requires ARM=A sets ARM=A;
        scenario S[0,60] = { do { Dig() } maintaining ARM=A }";
    let network = network(text);
    let (first, effect) = ("Init(ARM=A)", "Set(ARM=A)@Dig#1");
    let (at_start, throughout) = ("Ask(ARM=A)@Dig#1", "Ask(ARM=A)#2@Dig#1");
    assert_ne!(label(&network, at_start), label(&network, throughout));
    let links = [(at_start, first), (throughout, first)];
    let made = plan(&network, Sketch { links: &links, states: &[&[first, effect]], ..Sketch::default() });
    let written = plan_to_json(&network, &made);
    let read = tpn::plan_json::plan_from_json(&network, &written).expect("its own names");
    assert_eq!(read.causal_links, made.causal_links);
    // Whatever is required throughout is not kept while it changes.
    let found = violations(&network, &read);
    only(&found, Rule::State, &[throughout, effect], "Dig#1 changes ARM while Dig#1 requires ARM=A");
}

#[test]
fn labels_of_other_plans_are_refused() {
    let network = network(case!("s04_threat_both_ways").0);
    let good = plan(&network, STOW_FIRST);
    for one in [DIG, DEPLOY, STOW, FIRST] {
        for other in [DIG, DEPLOY, STOW, FIRST] {
            let mut linked = good.clone();
            linked.causal_links =
                vec![CausalLink { ask: label(&network, one), tell: label(&network, other) }];
            linked.windows = windows(&network, &linked);
            let is_right = (one, other) == (DIG, DEPLOY);
            assert_eq!(check_plan(&network, &linked).valid, is_right, "{one}, {other}");
            let mut added = good.clone();
            added
                .orderings_added
                .push(Ordering { first: label(&network, one), then: label(&network, other) });
            added.windows = windows(&network, &added);
            // What follows from the order may be added, too.
            let stated = [(FIRST, STOW), (FIRST, DEPLOY), (STOW, DEPLOY), (FIRST, DIG), (STOW, DIG)];
            let is_right = stated.contains(&(one, other));
            assert_eq!(check_plan(&network, &added).valid, is_right, "{one}, {other} added");
        }
    }
}

/// Where vehicles are is a state variable (SPEC 10.3).
#[test]
fn one_vehicle_never_moves_twice_at_once() {
    let text = "vehicle R : ATRV at HOME; location HOME (0, 0); location ROCK (5, 0);
        primitive Drive(to) [4,4] moves R; primitive Dig() [3,3] requires R.at=ROCK;
        scenario S [0,30] = { { delay; Drive(ROCK) }, { delay; Dig() }, { delay; Drive(HOME) } }";
    let network = network(text);
    let names: Vec<String> =
        (0..network.labels.len()).map(|it| network.label_name(tpn::LabelId::from_index(it))).collect();
    let (first, there, back, dig) =
        ("Init(R.at=HOME)", "Set(R.at=ROCK)@Drive#1", "Set(R.at=HOME)@Drive#2", "Ask(R.at=ROCK)@Dig#1");
    for name in [first, there, back, dig] {
        assert!(names.iter().any(|it| it == name), "{name}: {names:?}");
    }
    let states: &[&[&str]] = &[&[first, there, back]];
    let good = Sketch { links: &[(dig, there)], states, added: &[(dig, back)], ..Sketch::default() };
    assert_eq!(violations(&network, &plan(&network, good)), []);
    let found = violations(&network, &plan(&network, Sketch { added: &[], ..good }));
    assert!(
        found.iter().any(|it| it.message.contains("Drive#1 changes R.at while Drive#2 changes R.at")),
        "{found:#?}"
    );
}

/// Where a movement starts decides how long it takes at least, as far as the network knows that.
#[test]
fn movements_take_their_time_from_where_they_start() {
    let text = "vehicle R : ATRV at HOME; location HOME (0, 0); location ROCK (5, 0); location HILL (9, 0);
        primitive Drive(to) [4,10] moves R;
        scenario S [0,30] = { { Drive(ROCK) }, { delay; Drive(HILL) } }";
    let mut network = network(text);
    let (first, rock, hill) = ("Init(R.at=HOME)", "Set(R.at=ROCK)@Drive#1", "Set(R.at=HILL)@Drive#2");
    let value = |network: &Network, name: &str| {
        let values = &network.variables[0].values;
        let index = values.iter().position(|value| value == name).expect("a location");
        tpn::ValueId::from_index(index)
    };
    let departure = |network: &Network, arrival: &str, from: &str, least: Option<i64>| Departure {
        arrival: label(network, arrival),
        from: value(network, from),
        least: least.map(time),
    };
    let known = vec![
        departure(&network, rock, "HOME", Some(6)),
        departure(&network, rock, "HILL", Some(9)),
        departure(&network, hill, "ROCK", Some(8)),
        departure(&network, hill, "HOME", None),
    ];
    let sketch = Sketch { states: &[&[first, rock, hill]], added: &[(rock, hill)], ..Sketch::default() };
    let early = plan(&network, sketch);
    assert_eq!(violations(&network, &early), []);
    // Six to ROCK and eight from there to HILL, whatever it would take from elsewhere.
    let mut slower = network.clone();
    for (name, least) in [(rock, 6), (hill, 8)] {
        let arc = slower.labels[label(&slower, name).index()].arc;
        slower.arcs[arc.index()].lower = time(least);
    }
    let late = plan(&slower, sketch);
    network.departures = known;
    assert_eq!(violations(&network, &late), []);
    let found = violations(&network, &early);
    assert!(!found.is_empty() && found.iter().all(|it| it.rule == Rule::Window), "{found:#?}");
    let said_at = |plan: &Plan| check_schedule(&network, plan, &earliest_schedule(plan)).violations;
    assert_eq!(said_at(&late), []);
    let found = said_at(&early);
    assert_eq!(found.len(), 2, "{found:#?}");
    only(&found[..1], Rule::State, &[rock, first], "starts too early to drive there");
    only(&found[1..], Rule::State, &[hill, rock], "starts too early to drive there");
    // The other way round HILL is driven to from HOME, which cannot be.
    let mut other = plan(&network, Sketch { states: &[&[first, hill, rock]], ..Sketch::default() });
    other.windows = early.windows.clone();
    let found = violations(&network, &other);
    let is_said = |it: &Violation| {
        it.rule == Rule::State && it.message.contains("cannot be driven from the end of Init")
    };
    assert!(found.iter().any(is_said), "{found:#?}");
}
