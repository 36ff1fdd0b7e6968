//! State that lasts (SPEC 10.2) and resources (SPEC 11) in the check of schedules.

use exact::Time;
use verify::{Rule, Violation, check_schedule, earliest_schedule};

use crate::missions::{
    CONSUMED_FIRST, LOOK_BEFORE_OPEN, MUTUAL_SUPPORT, PRODUCED_AS_CONSUMED, Sketch, event, network, plan,
    time,
};

/// Returns what is said of the schedule of `text` that has these activities from start to end, all else as early as it
/// can be.
fn violations(text: &str, activities: &[(&str, i64, i64)], end: i64) -> Vec<Violation> {
    let network = network(text);
    let plan = plan(&network, Sketch::default());
    let mut times: Vec<Option<Time>> = earliest_schedule(&plan);
    for &(name, start, end) in activities {
        times[event(&network, &format!("{name}.start")).index()] = Some(time(start));
        times[event(&network, &format!("{name}.end")).index()] = Some(time(end));
    }
    times[network.end.index()] = Some(time(end));
    check_schedule(&network, &plan, &times).violations
}

#[track_caller]
fn only(found: &[Violation], rule: Rule, names: &[&str], words: &str) {
    let [violation] = found else { panic!("not one violation: {found:#?}") };
    let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
    assert_eq!((violation.rule, &violation.intervals), (rule, &names), "{violation:?}");
    assert!(violation.message.contains(words), "{violation:?}");
}

const ARM: &str = "state ARM : {IN, OUT} = IN;
    primitive Deploy() [5,5] sets ARM=OUT; primitive Dig() [10,10] requires ARM=OUT; primitive Stow() [5,5] sets ARM=IN;
    scenario S [0,90] = { { delay; Deploy() }, { delay; Dig() }, { delay; Stow() } }";

/// The schedule of [`ARM`] with these starts.
fn arm(deploy: i64, dig: i64, stow: i64) -> Vec<Violation> {
    let activities = [("Deploy#1", deploy, deploy + 5), ("Dig#1", dig, dig + 10), ("Stow#1", stow, stow + 5)];
    violations(ARM, &activities, 90)
}

#[test]
fn what_is_required_holds_throughout() {
    let (deploy, dig, stow) = ("Set(ARM=OUT)@Deploy#1", "Ask(ARM=OUT)@Dig#1", "Set(ARM=IN)@Stow#1");
    for (at_deploy, at_dig, at_stow) in [(0, 5, 15), (0, 30, 40), (5, 10, 0), (20, 60, 15), (20, 60, 70)] {
        assert_eq!(arm(at_deploy, at_dig, at_stow), [], "{at_deploy}, {at_dig}, {at_stow}");
    }
    for at_dig in [0, 4] {
        only(&arm(0, at_dig, 40), Rule::State, &[dig, deploy], "Deploy#1 contradicts it");
    }
    for at_stow in [6, 14] {
        only(&arm(0, 5, at_stow), Rule::State, &[dig, stow], "Dig#1 requires ARM=OUT from 5 to 15");
    }
    // Stowed before it is needed.
    only(&arm(0, 30, 10), Rule::State, &[dig, stow], "Stow#1 contradicts it");
    // Both at once: then nothing is left of either.
    for (at_stow, words) in [(4, "both set ARM at 4"), (0, "both set ARM at 0")] {
        let found = arm(0, 30, at_stow);
        only(&found[..1], Rule::State, &[deploy, stow], words);
        only(&found[1..], Rule::State, &[dig, stow], "Stow#1 contradicts it");
    }
}

/// Three values at one instant: whatever is asked of them afterwards must be the same.
#[test]
fn ties_are_decided_in_any_order_that_works() {
    let text = |users: &str| {
        format!(
            "state X : {{A, B, C}} = A;
            primitive NeedA() [3,3] requires X=A; primitive NeedB() [3,3] requires X=B;
            primitive NeedC() [3,3] requires X=C; primitive NeedD() [3,3] requires not X=C;
            scenario S [0,9] = {{ {{ delay[2,2]; X=A }}, {{ delay[2,2]; X=B }}, {{ delay[2,2]; X=C }}, {users} }}"
        )
    };
    let later = |users: &str| violations(&text(users), &[], 9);
    for users in [
        "{ delay[2,2]; NeedB() }",
        "{ delay[4,4]; NeedC() }",
        "{ delay[3,3]; NeedA() }, { delay[4,4]; NeedA() }, { delay[5,5]; NeedD() }",
        "{ delay[3,3]; NeedB() }, { delay[4,4]; NeedD() }",
        // At the instant itself each value holds once.
        "{ delay[2,2]; ask X=A }, { delay[2,2]; ask X=B }, { delay[2,2]; ask X=C }, { delay[5,5]; NeedB() }",
        // From the start to the changes it is A.
        "{ ask X=A [2,2] }",
    ] {
        assert_eq!(later(users), [], "{users}");
    }
    for users in [
        "{ delay[2,2]; NeedA() }, { delay[4,4]; NeedB() }",
        "{ delay[3,3]; NeedC() }, { delay[3,3]; NeedD() }",
        "{ delay[3,3]; NeedC() }, { delay[3,3]; NeedB() }, { delay[5,5]; NeedD() }",
    ] {
        without_order(&later(users), Rule::State, "which does not hold then");
    }
    // The initial value is before whatever happens at the start.
    let first =
        "state X : {A, B} = A; primitive NeedA() [3,3] requires X=A; scenario S [0,9] = { X=B, NeedA() }";
    without_order(&violations(first, &[], 9), Rule::State, "the events at 0");
    let first = first.replace("NeedA() }", "ask X=A }");
    assert_eq!(violations(&first, &[], 9), []);
}

/// Exactly one violation: no order within an instant keeps a rule.
#[track_caller]
fn without_order(found: &[Violation], rule: Rule, words: &str) {
    let [violation] = found else { panic!("not one violation: {found:#?}") };
    assert_eq!(violation.rule, rule, "{violation:?}");
    assert!(violation.message.starts_with("no order of the events at "), "{violation:?}");
    assert!(violation.message.contains(words), "{violation:?}");
}

#[test]
fn events_of_one_instant_follow_the_text() {
    for (text, end) in [(MUTUAL_SUPPORT, 10), (LOOK_BEFORE_OPEN, 0)] {
        without_order(&violations(text, &[], end), Rule::State, "which does not hold then");
    }
    let text = CONSUMED_FIRST;
    without_order(&violations(text, &[], 0), Rule::Resource, "Bat would be at -5, below 0, after C#1 (5)");
    assert_eq!(violations(&text.replace("C(); P()", "P(); C()"), &[], 0), []);
    // Nothing in the text says which is first: some order will do.
    assert_eq!(violations(PRODUCED_AS_CONSUMED, &[], 15), []);
    // One arm does not do two things of which each lasts longer than the instant in which it starts.
    let text = "resource Arm; primitive Wave() [0,0] uses Arm; primitive Hold() [5,5] uses Arm;
        scenario S [0,9] = { Wave(), Hold() }";
    assert_eq!(violations(text, &[], 9), []);
    let nested = text.replace("Wave(), Hold()", "do { Wave(); Wave() } using Arm");
    without_order(&violations(&nested, &[], 0), Rule::Resource, "2 of 1");
}

/// A chain of changes at one instant, written backwards, with `count` links.
fn chain(count: usize, first: usize, users: &str) -> String {
    let values: Vec<String> = (0..=count).map(|value| format!("V{value}")).collect();
    let link = |link: usize| format!("primitive L{link}() [0,0] requires X=V{link} sets X=V{};", link + 1);
    let links: String = (0..count).map(link).collect();
    let calls: Vec<String> = (0..count).rev().map(|link| format!("L{link}()")).collect();
    format!(
        "state X : {{{}}} = V{first}; {links} primitive Need(v) [3,3] requires X=v;
        scenario S [0,9] = {{ {}, {users} }}",
        values.join(", "),
        calls.join(", ")
    )
}

/// Six activities without length are twelve events, and only one of their orders will do.
#[test]
fn twelve_events_at_one_instant_are_decided() {
    for count in 1..=8 {
        let last = format!("{{ delay[1,1]; Need(V{count}) }}");
        assert_eq!(violations(&chain(count, 0, &last), &[], 9), [], "{count}");
        if count > 1 {
            // The first link lacks its value.
            let found = violations(&chain(count, 1, &last), &[], 9);
            assert!(found.iter().any(|it| it.rule == Rule::State), "{count}: {found:#?}");
            assert!(found.iter().all(|it| it.rule != Rule::Form), "{count}: {found:#?}");
        }
    }
    // Twelve assertions of as many values: any may be the last, and not two of them.
    let text = |count: usize, users: &str| {
        let values: Vec<String> = (0..count).map(|value| format!("V{value}")).collect();
        let told: Vec<String> = values.iter().map(|value| format!("X={value}")).collect();
        format!(
            "state X : {{{}}} = V0; primitive Need(v) [1,1] requires X=v; scenario S [0,9] = {{ {}, {users} }}",
            values.join(", "),
            told.join(", ")
        )
    };
    let need = |value: usize, at: usize| format!("{{ delay[{at},{at}]; Need(V{value}) }}");
    assert_eq!(violations(&text(6, &need(3, 1)), &[], 9), []);
    let both = format!("{}, {}", need(3, 1), need(4, 3));
    without_order(&violations(&text(6, &both), &[], 9), Rule::State, "which does not hold then");
    // Of many more it is said that they were not decided.
    let found = violations(&text(20, &both), &[], 9);
    only(&found, Rule::Form, &[], "the search stopped");
}

/// What is about different things continues beside each other, however much there is of it.
#[test]
fn many_independent_events_at_one_instant_are_decided() {
    let declared: String = (0..40)
        .map(|it| {
            format!("state X{it} : {{A, B}} = A; primitive P{it}() [0,0] requires X{it}=A sets X{it}=B;")
        })
        .collect();
    let calls: Vec<String> = (0..40).map(|it| format!("P{it}()")).collect();
    let text = |more: &str| format!("{declared} scenario S [0,9] = {{ {}, {more} }}", calls.join(", "));
    assert_eq!(violations(&text("{ delay[2,2]; ask X39=B }"), &[], 9), []);
    without_order(&violations(&text("P39()"), &[], 9), Rule::State, "P39#2 requires X39=A");
}

const POWER: &str = "resource Power capacity 5;
    primitive Radio() uses Power 3; primitive Heat() uses Power 2; primitive Lamp() uses Power 2;
    scenario S [0,40] = { { delay; Radio() }, { delay; Heat() }, { delay; Lamp() } }";

#[test]
fn a_resource_is_never_used_beyond_its_capacity() {
    let at = |radio: [i64; 2], heat: [i64; 2], lamp: [i64; 2]| {
        let [radio, heat, lamp] = [("Radio#1", radio), ("Heat#1", heat), ("Lamp#1", lamp)]
            .map(|(name, [from, to])| (name, from, to));
        violations(POWER, &[radio, heat, lamp], 40)
    };
    assert_eq!(at([0, 10], [0, 5], [5, 10]), []);
    assert_eq!(at([0, 10], [0, 12], [10, 20]), []);
    let names = ["Uses(Power)@Radio#1", "Uses(Power)@Heat#1", "Uses(Power)@Lamp#1"];
    let found = at([0, 10], [0, 12], [9, 20]);
    only(&found, Rule::Resource, &names, "Radio#1 (3), Heat#1 (2) and Lamp#1 (2) use Power at 9: 7 of 5");
    // A use without length counts strictly inside.
    for instant in [0, 10, 12, 30] {
        assert_eq!(at([0, 10], [0, 12], [instant, instant]), [], "{instant}");
    }
    only(&at([0, 10], [0, 12], [4, 4]), Rule::Resource, &names, "at 4: 7 of 5");
    // Two without length at one instant are one after the other.
    assert_eq!(at([0, 10], [4, 4], [4, 4]), []);
}

#[test]
fn a_level_stays_in_its_range_after_each_instant() {
    let text = "resource Batt 0..10 = 4;
        primitive Drive() consumes Batt 6; primitive Charge() produces Batt 5; primitive Fill() produces Batt 2;
        scenario S [0,40] = { { delay; Drive() }, { delay; Charge() }, { delay; Fill() } }";
    let (drive, charge) = ("Consumes(Batt)@Drive#1", "Produces(Batt)@Charge#1");
    let at = |drive_start: i64, charge_end: i64, fill_end: i64| {
        let activities = [("Drive#1", drive_start, 40), ("Charge#1", 0, charge_end), ("Fill#1", 0, fill_end)];
        violations(text, &activities, 40)
    };
    assert_eq!(at(10, 5, 20), []);
    // At one instant in any order.
    assert_eq!(at(10, 10, 20), []);
    assert_eq!(at(20, 20, 10), []);
    only(&at(10, 11, 20), Rule::Resource, &[drive], "Batt is at -2 after 10, below 0: Drive#1 (6)");
    only(
        &at(20, 5, 5),
        Rule::Resource,
        &["Produces(Batt)@Charge#1", "Produces(Batt)@Fill#1"],
        "at 11 after 5, above 10",
    );
    let found = at(20, 10, 5);
    only(&found, Rule::Resource, &[charge], "at 11 after 10, above 10: Charge#1 (5)");
}
