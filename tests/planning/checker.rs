//! The checker finds what is wrong: every plan with one thing changed is refused, by the rule that it breaks.

use acceptance::mission::{all_plans, network, sound};
use acceptance::random::small_mission;
use kirk::Search;
use rmpl::{Bound, Rational};
use tpn::generate::Rng;
use tpn::{Choice, DecisionId, LabelId, Network, Plan};
use verify::{Rule, Violation};

const TEXT: &str = "scenario S[0,40] = { choose { A()[3,5], B()[4,6] },
    { delay[2,2]; c [9,9]; delay[1,1]; c [9,9] }, { delay[0,inf]; do D()[2,3] maintaining c },
    { delay[0,inf]; V=X [4,5] }, { delay[0,inf]; V=Y [2,2] } }";

fn good() -> (Network, Plan) {
    let network = network(TEXT);
    let plan = all_plans(&network, Search::Chronological).plans.swap_remove(0);
    (network, plan)
}

fn rules(network: &Network, plan: &Plan) -> Vec<Rule> {
    let verdict = verify::check_plan(network, plan);
    assert_eq!(verdict.valid, verdict.violations.is_empty());
    verdict.violations.iter().map(|violation: &Violation| violation.rule).collect()
}

/// The rules that a changed plan breaks; at least one.
fn broken(change: impl Fn(&Network, &mut Plan)) -> Vec<Rule> {
    let (network, mut plan) = good();
    change(&network, &mut plan);
    let rules = rules(&network, &plan);
    assert!(!rules.is_empty(), "the checker accepts a wrong plan");
    rules
}

#[test]
fn a_good_plan_is_accepted() {
    let (network, plan) = good();
    assert_eq!(rules(&network, &plan), []);
    assert_eq!((plan.choices.len(), plan.causal_links.len(), plan.conflict_order.len()), (1, 1, 1));
}

#[test]
fn a_plan_of_another_network_is_refused() {
    assert_eq!(
        broken(|_, plan| {
            plan.selected_nodes.pop();
        }),
        [Rule::Form]
    );
    assert_eq!(
        broken(|_, plan| {
            plan.selected_arcs.push(true);
        }),
        [Rule::Form]
    );
    assert_eq!(broken(|_, plan| plan.windows.clear()), [Rule::Form]);
    assert_eq!(broken(|_, plan| plan.causal_links[0].tell = LabelId(99)), [Rule::Form]);
    let stray = Choice { decision: DecisionId(7), alternative: 0 };
    assert_eq!(broken(|_, plan| plan.choices.push(stray)), [Rule::Form]);
}

#[test]
fn a_wrong_selection_is_refused() {
    let only_selection =
        |rules: Vec<Rule>| assert!(rules.iter().all(|&rule| rule == Rule::Selection), "{rules:?}");
    only_selection(broken(|_, plan| plan.choices.clear()));
    only_selection(broken(|_, plan| plan.choices[0].alternative = 1));
    only_selection(broken(|_, plan| plan.choices[0].alternative = 2));
    only_selection(broken(|_, plan| plan.choices.push(plan.choices[0])));
    only_selection(broken(|network, plan| plan.selected_nodes[network.end.index()] = false));
    only_selection(broken(|network, plan| {
        // Both alternatives at once.
        let arc = network.decisions[0].alternatives[1];
        plan.selected_arcs[arc.index()] = true;
    }));
    let (network, plan) = good();
    for arc in 0..network.arcs.len() {
        let mut changed = plan.clone();
        changed.selected_arcs[arc] = !changed.selected_arcs[arc];
        assert!(rules(&network, &changed).contains(&Rule::Selection), "arc {arc}");
    }
}

#[test]
fn a_requirement_needs_exactly_one_fitting_link() {
    assert_eq!(broken(|_, plan| plan.causal_links.clear()), [Rule::Support]);
    assert_eq!(broken(|_, plan| plan.causal_links.push(plan.causal_links[0])), [Rule::Support]);
    // To an assertion of something else.
    let other = broken(|network, plan| {
        let of = (0..network.labels.len())
            .find(|&label| network.labels[label].text == "V=X")
            .expect("it is there");
        plan.causal_links[0].tell = LabelId::from_index(of);
    });
    assert_eq!(other, [Rule::Support]);
}

#[test]
fn contradicting_constraints_are_refused_with_their_names() {
    let (mut network, plan) = good();
    let end = network.end;
    let horizon = network.arcs.iter().position(|arc| arc.to == end && arc.upper == Bound::Finite(40.into()));
    network.arcs[horizon.expect("the horizon")].upper = Bound::Finite(20.into());
    let verdict = verify::check_plan(&network, &plan);
    assert_eq!(verdict.violations.len(), 1);
    assert_eq!(verdict.violations[0].rule, Rule::Temporal);
    assert!(verdict.violations[0].message.contains("takes [0,20]"), "{}", verdict.violations[0].message);
}

#[test]
fn conflicts_need_their_order_said_and_true() {
    assert!(broken(|_, plan| plan.conflict_order.clear()).contains(&Rule::Conflict));
    // Said the wrong way round.
    let turned = broken(|_, plan| {
        let order = &mut plan.conflict_order[0];
        (order.first, order.then) = (order.then, order.first);
    });
    assert!(turned.contains(&Rule::Conflict));
    // Said, but nothing enforces it.
    assert!(broken(|_, plan| plan.orderings_added.clear()).contains(&Rule::Conflict));
    // An order of intervals that do not conflict.
    let stray = broken(|_, plan| {
        let link = plan.causal_links[0];
        plan.conflict_order.push(tpn::Ordering { first: link.ask, then: link.tell });
    });
    assert!(stray.contains(&Rule::Conflict));
}

#[test]
fn every_window_is_checked_at_both_sides() {
    let (network, plan) = good();
    for node in 0..network.nodes.len() {
        let Some(window) = plan.windows[node] else { continue };
        let one = Rational::new(1, 3);
        let latest = match window.latest {
            Bound::Finite(latest) => Bound::Finite(latest + one),
            Bound::Infinite => Bound::Finite(Rational::from_integer(1_000_000)),
        };
        let changes = [
            tpn::Window { earliest: window.earliest - one, ..window },
            tpn::Window { earliest: window.earliest + one, ..window },
            tpn::Window { latest, ..window },
        ];
        for changed in changes {
            let mut wrong = plan.clone();
            wrong.windows[node] = Some(changed);
            assert_eq!(rules(&network, &wrong), [Rule::Window], "node {node}");
        }
        let mut absent = plan.clone();
        absent.windows[node] = None;
        let is_named = !network.nodes[node].events.is_empty();
        assert_eq!(rules(&network, &absent).len(), usize::from(is_named), "node {node}");
    }
    let unselected =
        plan.selected_nodes.iter().position(|&selected| !selected).expect("the other alternative");
    let mut wrong = plan.clone();
    wrong.windows[unselected] = plan.windows[0];
    assert_eq!(rules(&network, &wrong), [Rule::Window]);
}

#[test]
fn a_schedule_is_checked_against_every_rule() {
    let (network, plan) = good();
    let times = verify::earliest_schedule(&plan);
    assert!(verify::check_schedule(&network, &plan, &times).valid);
    let rule = |change: &dyn Fn(&mut Vec<Option<Rational>>)| {
        let mut changed = times.clone();
        change(&mut changed);
        let verdict = verify::check_schedule(&network, &plan, &changed);
        verdict.violations.iter().map(|violation| violation.rule).collect::<Vec<_>>()
    };
    let node = |event: &str| {
        let names = tpn::plan_json::Names::new(&network);
        names.event(event).expect("an event").index()
    };
    assert_eq!(rule(&|times| times.truncate(3)), [Rule::Form]);
    assert_eq!(rule(&|times| times[0] = None), [Rule::Form]);
    // A takes at most 5.
    assert!(rule(&|times| times[node("A#1.end")] = Some(6.into())).contains(&Rule::Duration));
    // D runs from 10 to 12, across the gap between the two times that c holds, [2,11] and [12,21].
    let outside = rule(&|times| {
        times[node("D#1.start")] = Some(10.into());
        times[node("D#1.end")] = Some(12.into());
    });
    assert_eq!(outside, [Rule::Support]);
    let overlapping = rule(&|times| {
        times[node("Tell(V=Y)#1.start")] = Some(3.into());
        times[node("Tell(V=Y)#1.end")] = Some(5.into());
    });
    assert_eq!(overlapping, [Rule::Conflict]);
    // Touching is no overlap: V=X is over at 4.
    let touching = rule(&|times| {
        times[node("Tell(V=Y)#1.start")] = Some(4.into());
        times[node("Tell(V=Y)#1.end")] = Some(6.into());
    });
    assert_eq!(touching, []);
}

#[test]
fn an_instant_must_lie_outside_what_it_conflicts_with() {
    let network = network(
        "scenario S = { { delay[0,inf]; c }, { delay[0,inf]; not c [5,5] }, { delay[0,inf]; not c } }",
    );
    let plan = &all_plans(&network, Search::Chronological).plans[0];
    let names = tpn::plan_json::Names::new(&network);
    let valid = |instant: i64, from: i64, other_instant: i64| {
        let mut times: Vec<Option<Rational>> = vec![Some(0.into()); network.nodes.len()];
        let mut set =
            |event: &str, time: i64| times[names.event(event).expect("an event").index()] = Some(time.into());
        set("Tell(c)#1.start", instant);
        set("Tell(c)#1.end", instant);
        set("Tell(not(c))#1.start", from);
        set("Tell(not(c))#1.end", from + 5);
        set("Tell(not(c))#2.start", other_instant);
        set("Tell(not(c))#2.end", other_instant);
        set("scenario#1.end", 100);
        verify::check_schedule(&network, plan, &times).valid
    };
    assert!(valid(9, 10, 20));
    assert!(!valid(10, 10, 20), "at the start of the interval");
    assert!(!valid(12, 10, 20), "inside");
    assert!(valid(15, 10, 20), "at its end");
    assert!(!valid(20, 10, 20), "two instants at once");
}

/// Random missions, each plan changed in one random way that matters.
#[test]
fn random_plans_with_one_thing_changed_are_refused() {
    let mut rng = Rng::new(7);
    let mut changed = 0;
    for seed in 0..400 {
        let network = network(&small_mission(seed));
        for plan in all_plans(&network, Search::ConflictDirected).plans.iter().take(3) {
            let mut wrong = plan.clone();
            match rng.below(4) {
                0 if !plan.causal_links.is_empty() => {
                    wrong.causal_links.remove(rng.below(plan.causal_links.len() as u64) as usize);
                }
                1 if !plan.conflict_order.is_empty() => {
                    wrong.conflict_order.remove(rng.below(plan.conflict_order.len() as u64) as usize);
                }
                2 => {
                    let arc = rng.below(network.arcs.len() as u64) as usize;
                    wrong.selected_arcs[arc] = !wrong.selected_arcs[arc];
                }
                _ => {
                    let window = wrong.windows.iter_mut().flatten().nth(rng.below(4) as usize);
                    let Some(window) = window else { continue };
                    window.earliest += Rational::new(1, 7);
                }
            }
            assert!(sound(&network, &wrong).is_err(), "seed {seed}");
            changed += 1;
        }
    }
    assert!(changed > 200, "only {changed} plans were changed");
}
