//! The rules of resources (SPEC 11) and of what plans are worth (SPEC 12) in the check of plans.

use std::fmt::Write as _;

use exact::Rational;
use tpn::generate::Rng;
use tpn::{Levels, Network, Plan, UseId, UseOrdering};
use verify::{Rule, Violation, check_plan, check_schedule, earliest_schedule};

use crate::missions::{
    CONSUMED_FIRST, PRODUCED_AS_CONSUMED, Sketch, network, peak, plan_of_resources, plan_without_windows,
    range, time, used, windows,
};

macro_rules! case {
    ($name:literal) => {
        include_str!(concat!("../../../../tests/conformance/", $name, ".rmpl"))
    };
}

fn violations(network: &Network, plan: &Plan) -> Vec<Violation> {
    let verdict = check_plan(network, plan);
    assert_eq!(verdict.valid, verdict.violations.is_empty());
    verdict.violations
}

/// The plan with these orderings of uses and these levels, worth what it says.
fn made(text: &str, ordered: &[(&str, &str)], levels: &[Levels], end: i64) -> (Network, Plan) {
    let network = network(text);
    let mut plan = plan_of_resources(&network, Sketch::default(), ordered, levels);
    plan.quality.end = time(end);
    (network, plan)
}

/// It is accepted, and so is its earliest schedule.
#[track_caller]
fn accepted(text: &str, ordered: &[(&str, &str)], levels: &[Levels], end: i64) {
    let (network, plan) = made(text, ordered, levels, end);
    assert_eq!(violations(&network, &plan), []);
    let verdict = check_schedule(&network, &plan, &earliest_schedule(&plan));
    assert!(verdict.valid, "{:#?}", verdict.violations);
}

#[track_caller]
fn only(found: &[Violation], rule: Rule, names: &[&str], words: &str) {
    let [violation] = found else { panic!("not one violation: {found:#?}") };
    assert_eq!((violation.rule, violation.intervals.as_slice()), (rule, &owned(names)[..]), "{violation:?}");
    assert!(violation.message.contains(words), "{violation:?}");
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

const SHOOT: &str = "Uses(Cam)@Shoot#1";
const FILM: &str = "Uses(Cam)@Film#1";

#[test]
fn one_user_comes_after_the_other() {
    let text = case!("r01_unary_order");
    accepted(text, &[(SHOOT, FILM)], &[peak(1)], 20);
    accepted(text, &[(FILM, SHOOT)], &[peak(1)], 20);
    let (network, plan) = made(text, &[], &[peak(2)], 10);
    let words = "Shoot#1 (1) and Film#1 (1) may use Cam at the same time: 2 of 1";
    only(&violations(&network, &plan), Rule::Resource, &[SHOOT, FILM], words);
}

#[test]
fn three_users_are_too_many_and_two_are_not() {
    let text = case!("r03_three_users");
    let (radio, heat, lamp) = ("Uses(Power)@Radio#1", "Uses(Power)@Heat#1", "Uses(Power)@Lamp#1");
    accepted(text, &[(heat, lamp)], &[peak(5)], 20);
    accepted(text, &[(radio, lamp)], &[peak(5)], 20);
    accepted(text, &[(radio, lamp), (radio, heat)], &[peak(4)], 20);
    accepted(text, &[(radio, heat), (heat, lamp)], &[peak(3)], 30);
    let (network, plan) = made(text, &[], &[peak(7)], 10);
    let words = "Radio#1 (3), Heat#1 (2) and Lamp#1 (2) may use Power at the same time: 7 of 5";
    only(&violations(&network, &plan), Rule::Resource, &[radio, heat, lamp], words);
    // What the plan says of the peak is checked, too.
    for wrong in [peak(4), peak(6), range(0, 5)] {
        let (network, plan) = made(text, &[(heat, lamp)], &[wrong], 20);
        only(&violations(&network, &plan), Rule::Resource, &[], "but it is used up to 5 at a time");
    }
    let (network, plan) = made(text, &[(heat, lamp)], &[], 20);
    only(&violations(&network, &plan), Rule::Resource, &[], "lists 0 resources, but the mission has 1");
}

#[test]
fn charging_comes_before_driving() {
    let text = case!("r05_reservoir_low");
    let (drive, charge) = ("Consumes(Batt)@Drive#1", "Produces(Batt)@Charge#1");
    // 4 at first, 9 when charged, 3 when driving begins.
    accepted(text, &[(charge, drive)], &[range(3, 9)], 13);
    let (network, plan) = made(text, &[], &[range(-2, 9)], 8);
    let words = "when Drive#1 consumes 6, Batt may fall to -2, but its minimum is 0";
    only(&violations(&network, &plan), Rule::Resource, &[drive], words);
    for wrong in [range(2, 9), range(3, 10), range(4, 9)] {
        let (network, plan) = made(text, &[(charge, drive)], &[wrong], 13);
        only(&violations(&network, &plan), Rule::Resource, &[], "but it stays within 3 and 9");
    }
}

/// At 10 the store is filled and emptied: production counts if it happens before.
#[test]
fn what_is_produced_at_one_instant_counts_if_it_is_before_what_is_consumed() {
    let text = PRODUCED_AS_CONSUMED;
    let (produced, consumed) = ("Produces(Bat)@A#1", "Consumes(Bat)@B#1");
    accepted(text, &[(produced, consumed)], &[range(0, 5)], 15);
    for (order, low) in [(&[][..], -5), (&[(consumed, produced)], -5)] {
        let (network, plan) = made(text, order, &[range(low, if order.is_empty() { 5 } else { 0 })], 15);
        let words = "when B#1 consumes 5, Bat may fall to -5, but its minimum is 0";
        only(&violations(&network, &plan), Rule::Resource, &[consumed], words);
    }
    // In a sequence the text says which is first.
    let text = CONSUMED_FIRST;
    let (network, plan) = made(text, &[], &[range(-5, 0)], 0);
    only(&violations(&network, &plan), Rule::Resource, &["Consumes(Bat)@C#1"], "may fall to -5");
    accepted(&text.replace("C(); P()", "P(); C()"), &[], &[range(0, 5)], 0);
}

#[test]
fn amounts_per_minute_are_part_of_the_network() {
    let (drive, charge) = ("Consumes(Batt)@Drive#1", "Produces(Batt)@Charge#1");
    accepted(case!("r07_per_minute"), &[(charge, drive)], &[range(0, 12)], 7);
}

#[test]
fn a_reservoir_does_not_overflow() {
    let text = "resource Tank 0..10 = 8;
        primitive Fill() [2,2] produces Tank 4; primitive Drain() [3,3] consumes Tank 5;
        scenario S [0,20] = { { delay; Fill() }, { delay; Drain() } }";
    let (fill, drain) = ("Produces(Tank)@Fill#1", "Consumes(Tank)@Drain#1");
    accepted(text, &[(drain, fill)], &[range(3, 8)], 0);
    let (network, plan) = made(text, &[(fill, drain)], &[range(7, 12)], 0);
    let words = "when Fill#1 has produced 4, Tank may reach 12, but its maximum is 10";
    only(&violations(&network, &plan), Rule::Resource, &[fill], words);
    // Neither is before the other where each is said to be.
    let (network, plan) = made(text, &[(drain, fill), (fill, drain)], &[range(7, 8)], 0);
    let found = violations(&network, &plan);
    assert!(matches!(found.as_slice(), [it] if it.rule == Rule::Temporal), "{found:#?}");
    assert!(found[0].message.contains("would have to happen before the next"), "{found:#?}");
}

/// Consumers that are not ordered count together, one that is entailed to be later does not.
#[test]
fn consumption_counts_unless_it_comes_later() {
    let text = "resource Tank 0..10 = 6;
        primitive Sip() [2,2] consumes Tank 2; primitive Pour() [1,1] produces Tank 3;
        scenario S [0,20] = { { Sip(); Pour(); Sip() }, { delay; Sip() } }";
    // The third may come at any time, so that at its start all may have drunk and nothing may have been poured yet.
    // First: 6 - 2; second: 6 - 6 + 3; third: 6 - 6. Poured, before the second drinks: 6 + 3 - 2.
    accepted(text, &[], &[range(0, 7)], 0);
    let (network, plan) = made(text, &[], &[range(2, 7)], 0);
    only(&violations(&network, &plan), Rule::Resource, &[], "but it stays within 0 and 7");
    // After the second: 6 - 2; 6 - 4 + 3; 6 - 6 + 3. Poured as before.
    let order = [("Consumes(Tank)@Sip#2", "Consumes(Tank)@Sip#3")];
    accepted(text, &order, &[range(3, 7)], 0);
}

#[test]
fn uses_without_length_count_inside_others() {
    let text = |at: &str| {
        format!(
            "resource Cam; primitive Snap() [0,0] uses Cam; primitive Film() [4,4] uses Cam;
            scenario S [0,9] = {{ {{ {at} Snap() }}, {{ delay[2,2]; Film() }} }}"
        )
    };
    for outside in ["", "delay[0,2];"] {
        accepted(&text(outside), &[], &[peak(1)], 0);
    }
    let snap = "Uses(Cam)@Snap#1";
    // Where one ends the moment the other starts, the plan says so (SPEC 10.4).
    for (touching, order) in [("delay[2,2];", (snap, FILM)), ("delay[6,6];", (FILM, snap))] {
        accepted(&text(touching), &[order], &[peak(1)], 0);
        let (network, plan) = made(&text(touching), &[], &[peak(2)], 0);
        only(&violations(&network, &plan), Rule::Resource, &[snap, FILM], "2 of 1");
    }
    for inside in ["delay[3,3];", "delay[0,3];", "delay[5,6];"] {
        let (network, plan) = made(&text(inside), &[], &[peak(2)], 0);
        only(&violations(&network, &plan), Rule::Resource, &["Uses(Cam)@Snap#1", FILM], "2 of 1");
    }
}

#[test]
fn orderings_join_selected_uses_of_one_resource() {
    let text = "resource Cam capacity 2; resource Power capacity 2;
        primitive Shoot() [1,1] uses Cam, Power; primitive Film() [1,1] uses Cam, Power;
        scenario S [0,9] = { { delay; Shoot() }, { delay; Film() }, choose { Wait()[1,1], Shoot() } }";
    let network = network(text);
    let sketch = Sketch { choices: &[(1, 0)], ..Sketch::default() };
    let good = plan_of_resources(&network, sketch, &[(SHOOT, FILM)], &[peak(1), peak(1)]);
    assert_eq!(violations(&network, &good), []);
    for (first, then, words) in [
        (SHOOT, SHOOT, "ordered with itself"),
        (SHOOT, "Uses(Power)@Film#1", "the same resource"),
        (SHOOT, "Uses(Cam)@Shoot#2", "does not select"),
        ("Uses(Cam)@Shoot#2", FILM, "does not select"),
    ] {
        let mut wrong = good.clone();
        wrong.uses_ordered = vec![UseOrdering { first: used(&network, first), then: used(&network, then) }];
        wrong.windows = windows(&network, &wrong);
        only(&violations(&network, &wrong), Rule::Resource, &[first, then], words);
    }
    let mut unknown = good.clone();
    unknown.uses_ordered[0].then = UseId(99);
    only(&violations(&network, &unknown), Rule::Form, &[], "unknown use");
    // Both ways round there is no schedule.
    let mut round = good.clone();
    let first = round.uses_ordered[0];
    round.uses_ordered.push(UseOrdering { first: first.then, then: first.first });
    let found = violations(&network, &round);
    assert!(matches!(found.as_slice(), [it] if it.rule == Rule::Temporal), "{found:#?}");
    assert!(found[0].message.contains("Uses(Cam)@Shoot#1 must come before Uses(Cam)@Film#1"), "{found:#?}");
}

/// Four users in two pairs: which may meet whom decides, not how many there are.
#[test]
fn the_heaviest_set_is_found_among_many() {
    let text = "resource Power capacity 7;
        primitive A() [2,2] uses Power 4; primitive B() [2,2] uses Power 1;
        primitive C() [2,2] uses Power 3; primitive D() [2,2] uses Power 2;
        scenario S [0,20] = { { A(); B() }, { delay; C(); D() } }";
    // A with C: 7; A with D 6, B with C 4, B with D 3.
    accepted(text, &[], &[peak(7)], 0);
    let text = text.replace("capacity 7", "capacity 6");
    let (network, plan) = made(&text, &[], &[peak(7)], 0);
    let names = ["Uses(Power)@A#1", "Uses(Power)@C#1"];
    only(&violations(&network, &plan), Rule::Resource, &names, "7 of 6");
    accepted(&text, &[("Uses(Power)@A#1", "Uses(Power)@C#1")], &[peak(4)], 0);
}

/// Ten users, some put in order: the heaviest set against all sets.
#[test]
fn the_heaviest_set_is_that_of_all_sets() {
    const USERS: usize = 10;
    for seed in 0..300 {
        let mut rng = Rng::new(seed);
        let amounts: Vec<i64> = (0..USERS).map(|_| rng.between(0, 5)).collect();
        let user = |(index, amount): (usize, &i64)| {
            (format!("primitive U{index}() [1,2] uses Power {amount};"), format!("{{ delay; U{index}() }}"))
        };
        let (declared, threads): (Vec<String>, Vec<String>) = amounts.iter().enumerate().map(user).unzip();
        let (declared, threads) = (declared.concat(), threads.join(", "));
        let network =
            network(&format!("resource Power capacity 99; {declared} scenario S = {{ {threads} }}"));
        let mut plan = plan_without_windows(&network, Sketch::default());
        // Any order of the users, some of whom wait for some before them.
        let mut users: Vec<usize> = (0..USERS).collect();
        for position in 0..USERS {
            users.swap(position, position + rng.below((USERS - position) as u64) as usize);
        }
        let mut is_before = [[false; USERS]; USERS];
        let density = rng.between(5, 60) as u64;
        for (position, &then) in users.iter().enumerate() {
            for &first in &users[..position] {
                if rng.chance(density) {
                    plan.uses_ordered
                        .push(UseOrdering { first: UseId::from_index(first), then: UseId::from_index(then) });
                    is_before[first][then] = true;
                    for row in &mut is_before {
                        row[then] |= row[first];
                    }
                }
            }
        }
        let sum = |set: u32| {
            let chosen: Vec<usize> = (0..USERS).filter(|user| set >> user & 1 == 1).collect();
            let is_free = chosen.iter().all(|&first| chosen.iter().all(|&then| !is_before[first][then]));
            is_free.then(|| chosen.iter().map(|&user| amounts[user]).sum::<i64>())
        };
        let heaviest = (0..1_u32 << USERS).filter_map(sum).max().unwrap_or(0);
        for stated in heaviest - 1..=heaviest + 1 {
            plan.levels = vec![peak(stated)];
            let found = violations(&network, &plan);
            let is_said = found.iter().any(|it| it.rule == Rule::Resource);
            assert_eq!(is_said, stated != heaviest, "seed {seed}: {stated} of {heaviest}");
        }
    }
}

#[test]
fn costs_rewards_and_the_end_are_added_up() {
    let text = case!("o01_optional");
    let network = network(text);
    let sketch = Sketch { choices: &[(1, 0), (2, 1)], ..Sketch::default() };
    let mut good = plan_of_resources(&network, sketch, &[], &[]);
    good.quality.cost = Rational::from_integer(3);
    good.quality.reward = Rational::from_integer(5);
    good.quality.end = time(3);
    assert_eq!(violations(&network, &good), []);
    let changed = |change: fn(&mut Plan)| {
        let mut wrong = good.clone();
        change(&mut wrong);
        violations(&network, &wrong)
    };
    let nought = Rational::default();
    assert!(good.quality.cost != nought);
    only(&changed(|it| it.quality.cost = Rational::default()), Rule::Quality, &[], "cost is 3, not 0");
    only(&changed(|it| it.quality.reward = Rational::ONE), Rule::Quality, &[], "reward is 5, not 1");
    only(&changed(|it| it.quality.end = time(4)), Rule::Quality, &[], "end is 3, not 4");
    // Film is taken, too: 3 + 4, 5 + 2, 3 + 3.
    let sketch = Sketch { choices: &[(1, 0), (2, 0)], ..Sketch::default() };
    let mut both = plan_of_resources(&network, sketch, &[], &[]);
    both.quality = good.quality;
    let found = violations(&network, &both);
    let messages: Vec<&str> = found.iter().map(|it| it.message.as_str()).collect();
    assert_eq!(messages.len(), 3, "{found:#?}");
    for (message, words) in messages.iter().zip(["cost is 7, not 3", "reward is 7, not 5", "end is 6, not 3"])
    {
        assert!(message.contains(words), "{message}");
    }
}

/// A thousand uses with room between them, one after the other, are no more work than what they are.
#[test]
fn a_thousand_uses_in_a_row_are_checked() {
    let mut body = String::new();
    for _ in 0..1000 {
        let _ = write!(body, "delay[0,5]; Shoot()[1,3]; ");
    }
    let text = format!(
        "resource Cam; resource Batt 0..2000 = 1000;
        primitive Shoot() uses Cam consumes Batt 1; scenario S = {{ {body} delay }}"
    );
    let network = network(&text);
    let mut plan = plan_without_windows(&network, Sketch::default());
    plan.levels = vec![peak(1), range(0, 1000)];
    let others = |it: &Violation| it.rule != Rule::Window;
    let found: Vec<Violation> = violations(&network, &plan).into_iter().filter(others).collect();
    assert_eq!(found, []);
}
