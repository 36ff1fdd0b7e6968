//! State that lasts (SPEC 10.2) and resources (SPEC 11) in the check of schedules.

use exact::Time;
use verify::{Rule, Violation, check_schedule, earliest_schedule};

use crate::missions::{Sketch, event, network, plan, time};

/// What is said of the schedule of `text` that has these activities from start to end, all else as early as it can be.
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
        only(&arm(0, at_dig, 40), Rule::State, &[dig, deploy], "Deploy#1 stands against it");
    }
    for at_stow in [6, 14] {
        only(&arm(0, 5, at_stow), Rule::State, &[dig, stow], "Dig#1 requires ARM=OUT from 5 to 15");
    }
    // Stowed before it is needed.
    only(&arm(0, 30, 10), Rule::State, &[dig, stow], "Stow#1 stands against it");
    // Both at once: then nothing is left of either.
    for (at_stow, words) in [(4, "both about ARM at 4"), (0, "both about ARM at 0")] {
        let found = arm(0, 30, at_stow);
        only(&found[..1], Rule::State, &[deploy, stow], words);
        only(&found[1..], Rule::State, &[dig, stow], "Stow#1 stands against it");
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
    let (a, b, c, d) = ("Ask(X=A)@NeedA#1", "Ask(X=B)@NeedB#1", "Ask(X=C)@NeedC#1", "Ask(not(X=C))@NeedD#1");
    for (users, names) in [
        ("{ delay[2,2]; NeedA() }, { delay[4,4]; NeedB() }", &[a, b][..]),
        ("{ delay[3,3]; NeedC() }, { delay[3,3]; NeedD() }", &[c, d]),
        ("{ delay[3,3]; NeedC() }, { delay[3,3]; NeedB() }, { delay[5,5]; NeedD() }", &[c, b, d]),
    ] {
        // In textual order of the requirements.
        only(&later(users), Rule::State, names, "need different last values of X at 2");
    }
    // The initial value is before whatever happens at the start.
    let first =
        "state X : {A, B} = A; primitive NeedA() [3,3] requires X=A; scenario S [0,9] = { X=B, NeedA() }";
    only(&violations(first, &[], 9), Rule::State, &[a, "Tell(X=B)@Tell(X=B)#1"], "stands against it");
    let first = first.replace("NeedA() }", "ask X=A }");
    assert_eq!(violations(&first, &[], 9), []);
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
