//! Plans that the environment may break (SPEC 13.1): the storm and the drive, what is said of them, and every verdict
//! on tiny networks against the game itself.

use exact::{Bound, Time};
use rmpl::program::Controllability;
use tpn::generate::Rng;
use tpn::{Arc, ArcId, ArcKind, Network, Node, NodeId, Plan, Quality};
use verify::{Rule, Verdict, Violation, check_plan, check_schedule};

use crate::game::Game;
use crate::missions::{Sketch, event, network, plan, time};

/// The environment chooses how long this occurrence takes.
fn leave_to_nature(network: &mut Network, name: &str) {
    let occurrence = network.occurrences.iter().find(|occurrence| occurrence.name == name);
    let arc = occurrence.unwrap_or_else(|| panic!("{name}")).arc.expect("a duration");
    network.arcs[arc.index()].is_contingent = true;
}

fn said(network: &Network, sketch: Sketch<'_>) -> Vec<Violation> {
    check_plan(network, &plan(network, sketch)).violations
}

/// The plan of a sketch with the windows that it has without a gap between conflicting intervals.
fn without_gap(network: &Network, sketch: Sketch<'_>) -> Plan {
    plan(&Network { threat_gap: time(0), ..network.clone() }, sketch)
}

#[track_caller]
fn only(found: &[Violation], events: &[&str], words: &[&str]) {
    let [violation] = found else { panic!("not one violation: {found:#?}") };
    assert_eq!(violation.rule, Rule::Controllability, "{violation:?}");
    assert_eq!(violation.events, events, "{violation:?}");
    for words in words {
        assert!(violation.message.contains(words), "{words}: {violation:?}");
    }
}

#[test]
fn a_drive_that_nature_draws_out_cannot_end_within_a_narrower_range() {
    let mut network = network("scenario S = { { Drive()[20,40]; delay[0,0] }[30,35] }");
    assert_eq!(said(&network, Sketch::default()), []);
    leave_to_nature(&mut network, "Drive#1");
    only(
        &said(&network, Sketch::default()),
        &["Drive#1.start", "Drive#1.end"],
        &["Drive#1 takes [20,40] (uncontrolled)", "[30,35]"],
    );
    network.controllability = Controllability::None;
    assert_eq!(said(&network, Sketch::default()), [], "read as ordinary");
}

#[test]
fn what_must_be_over_before_a_storm_is_over_before_its_earliest() {
    let ordered = [("Tell(V=X)@Tell(V=X)#1", "Tell(V=Y)@Tell(V=Y)#1")];
    let sketch = Sketch { order: &ordered, added: &ordered, ..Sketch::default() };
    let text = |survey: &str| format!("scenario S = {{ V=X {survey}, {{ delay[5,100]; V=Y [1,1] }} }}");
    // With a gap of one the last moment would be 4; before the environment's event there is none.
    for (survey, is_over_in_time) in
        [("[10,20]", false), ("[6,20]", false), ("[5,20]", true), ("[0,5]", true)]
    {
        let mut network = network(&text(survey));
        assert_eq!(said(&network, sketch), [], "the planner moves the storm");
        leave_to_nature(&mut network, "delay#1");
        let found = check_plan(&network, &without_gap(&network, sketch)).violations;
        if is_over_in_time {
            assert_eq!(found, [], "{survey}");
        } else {
            only(&found, &["delay#1.start", "delay#1.end"], &["delay#1 takes [5,100]", "Tell(V=X)"]);
        }
    }
}

#[test]
fn durations_that_only_look_at_each_other_need_no_times_beforehand() {
    let mut network = network("scenario S = { { Drive()[20,40]; delay[5,10] }[0,50] }");
    leave_to_nature(&mut network, "Drive#1");
    assert_eq!(said(&network, Sketch::default()), []);
    network.controllability = Controllability::Strong;
    only(
        &said(&network, Sketch::default()),
        &["Drive#1.start", "Drive#1.end"],
        &["Drive#1 takes [20,40]", "no schedule fixed in advance", "[5,10]"],
    );
}

#[test]
fn what_is_tied_to_an_event_of_natures_needs_no_time_beforehand() {
    let mut network = network("scenario S = { Drive()[20,40]; delay[0,0]; delay[0,0] }");
    leave_to_nature(&mut network, "Drive#1");
    network.controllability = Controllability::Strong;
    assert_eq!(said(&network, Sketch::default()), []);
}

#[test]
fn two_that_nature_ends_cannot_end_together() {
    let mut network = network("scenario S = { A()[1,5], B()[1,5] }");
    leave_to_nature(&mut network, "A#1");
    leave_to_nature(&mut network, "B#1");
    assert_eq!(said(&network, Sketch::default()), []);
    let (a, b) = (event(&network, "A#1.end"), event(&network, "B#1.end"));
    add_arc(&mut network, a, b, (0, 0), false);
    let found = said(&network, Sketch::default());
    only(&found, &["A#1.start", "A#1.end", "B#1.start", "B#1.end"], &["A#1 takes [1,5]", "B#1 takes [1,5]"]);
    // At one event that both end.
    for arc in &mut network.arcs {
        arc.to = if arc.to == b { a } else { arc.to };
        arc.from = if arc.from == b { a } else { arc.from };
    }
    network.arcs.pop();
    join(&mut network);
    let found = said(&network, Sketch::default());
    only(&found, &["A#1.start", "A#1.end", "B#1.start", "B#1.end"], &["A#1 takes [1,5]", "B#1 takes [1,5]"]);
}

#[test]
fn there_is_no_gap_before_an_interval_that_nature_begins() {
    let ordered = [("Tell(V=X)@Tell(V=X)#1", "Tell(V=Y)@Tell(V=Y)#1")];
    let sketch = Sketch { order: &ordered, added: &ordered, ..Sketch::default() };
    // The wait is over the moment the second condition comes.
    let mut network = network("scenario S = { V=X [0,inf], { delay[5,100]; V=Y [1,1] } }");
    assert_eq!(network.threat_gap, time(1));
    let with_gap = plan(&network, sketch);
    let without_gap = without_gap(&network, sketch);
    leave_to_nature(&mut network, "delay#1");
    // Windows are those of a plan without the gap.
    let found = check_plan(&network, &with_gap).violations;
    assert!(found.iter().all(|it| it.rule == Rule::Window) && !found.is_empty(), "{found:?}");
    assert_eq!(check_plan(&network, &without_gap).violations, []);
    assert_eq!(
        check_schedule(&network, &without_gap, &verify::earliest_schedule(&without_gap)).violations,
        []
    );
}

#[test]
fn an_instant_may_be_the_one_at_which_nature_begins_what_comes_after_it() {
    let ordered = [("Tell(V=X)@Tell(V=X)#1", "Tell(V=Y)@Tell(V=Y)#1")];
    let sketch = Sketch { order: &ordered, added: &ordered, ..Sketch::default() };
    let mut network = network("scenario S = { { delay[0,5]; V=X [0,0] }, { delay[5,100]; V=Y [1,1] } }");
    let mut at_once = verify::earliest_schedule(&plan(&network, sketch));
    for name in ["delay#1.end", "Tell(V=X)#1.start", "Tell(V=X)#1.end"] {
        at_once[event(&network, name).index()] = Some(time(5));
    }
    for name in ["delay#2.end", "Tell(V=Y)#1.start"] {
        at_once[event(&network, name).index()] = Some(time(5));
    }
    for name in ["Tell(V=Y)#1.end", "scenario#1.end"] {
        at_once[event(&network, name).index()] = Some(time(6));
    }
    let found = check_schedule(&network, &plan(&network, sketch), &at_once).violations;
    assert!(found.iter().any(|it| it.rule == Rule::Conflict), "{found:?}");
    leave_to_nature(&mut network, "delay#2");
    assert_eq!(check_schedule(&network, &plan(&network, sketch), &at_once).violations, []);
}

#[test]
fn nature_does_not_choose_within_no_bounds() {
    let mut network = network("scenario S = { Drive()[20,40] }");
    leave_to_nature(&mut network, "Drive#1");
    for arc in network.arcs.iter_mut().filter(|arc| arc.is_contingent) {
        arc.upper = Bound::Infinite;
    }
    let found = said(&network, Sketch::default());
    let [violation] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!(violation.rule, Rule::Form);
    assert!(violation.message.contains("needs finite bounds"), "{violation:?}");
}

/// A network of `events` events without names, the first of which is the start.
fn bare(events: usize) -> Network {
    let mut bare = network("scenario S = { delay[0,0] }");
    bare.nodes = vec![Node::default(); events];
    bare.arcs.clear();
    bare.labels.clear();
    bare.occurrences.clear();
    bare.blocks.clear();
    bare.root = None;
    bare.start = NodeId(0);
    bare.end = NodeId::from_index(events - 1);
    bare
}

fn add_arc(network: &mut Network, from: NodeId, to: NodeId, (lower, upper): (i64, i64), is_contingent: bool) {
    let bounds = (Time::from(lower), Bound::Finite(Time::from(upper)));
    network.connect(Arc { is_contingent, ..Arc::bare(from, to, bounds, ArcKind::Span) });
}

/// Makes nodes know their arcs.
fn join(network: &mut Network) {
    for node in &mut network.nodes {
        node.out_arcs.clear();
        node.in_arcs.clear();
    }
    for (index, arc) in network.arcs.iter().enumerate() {
        network.nodes[arc.from.index()].out_arcs.push(ArcId::from_index(index));
        network.nodes[arc.to.index()].in_arcs.push(ArcId::from_index(index));
    }
}

/// Everything happens within the horizon, between bounds and ranges as chance likes.
fn tiny(rng: &mut Rng, events: usize, horizon: i64) -> Network {
    let mut network = bare(events);
    let below = |rng: &mut Rng, bound: usize| NodeId::from_index(rng.below(bound as u64) as usize);
    for event in 1..events {
        add_arc(&mut network, NodeId(0), NodeId::from_index(event), (0, horizon), false);
    }
    let mut ends: Vec<NodeId> = (1..events).map(NodeId::from_index).collect();
    for _ in 0..rng.between(1, 3) {
        let end = ends.remove(rng.below(ends.len() as u64) as usize);
        let from = below(rng, events);
        // Nothing begins with its own end: ranges lead from lower numbers to higher ones.
        if from < end {
            let lower = rng.between(0, 2);
            add_arc(&mut network, from, end, (lower, lower + rng.between(0, 3)), true);
        }
        if ends.is_empty() {
            break;
        }
    }
    for _ in 0..rng.between(1, 2 * events as i64) {
        let (from, to) = (below(rng, events), below(rng, events));
        if from != to {
            let lower = rng.between(-3, 3);
            add_arc(&mut network, from, to, (lower, lower + rng.between(0, 6)), false);
        }
    }
    network
}

/// Everything is selected; windows are left out, since these events have no names.
fn plan_of_everything(network: &Network) -> Plan {
    Plan {
        choices: Vec::new(),
        selected_nodes: vec![true; network.nodes.len()],
        selected_arcs: vec![true; network.arcs.len()],
        causal_links: Vec::new(),
        conflict_order: Vec::new(),
        conflict_order_omitted: 0,
        state_order: Vec::new(),
        orderings_added: Vec::new(),
        uses_ordered: Vec::new(),
        levels: Vec::new(),
        quality: Quality::default(),
        windows: vec![None; network.nodes.len()],
    }
}

/// Returns whether the plan can be kept, whatever else is wrong with it.
fn is_kept(verdict: &Verdict) -> bool {
    let is_broken = |violation: &Violation| matches!(violation.rule, Rule::Temporal | Rule::Controllability);
    !verdict.violations.iter().any(is_broken)
}

#[test]
fn verdicts_on_tiny_networks_are_those_of_the_game() {
    const HORIZON: i64 = 8;
    let (mut kept, mut broken, mut consistent) = (0, 0, 0);
    for seed in 0..1500 {
        let mut rng = Rng::new(seed);
        let events = rng.between(3, 5) as usize;
        let network = tiny(&mut rng, events, HORIZON);
        let verdict = check_plan(&network, &plan_of_everything(&network));
        let ticks = if seed % 10 == 0 { 2 } else { 1 };
        let has_strategy = Game::has_strategy(&network, HORIZON as i32, ticks);
        assert_eq!(
            is_kept(&verdict),
            has_strategy,
            "seed {seed}: {:?}\n{:?}",
            verdict.violations,
            network.arcs
        );
        if has_strategy {
            kept += 1;
        } else {
            broken += 1;
            consistent += i32::from(verdict.violations.iter().any(|it| it.rule == Rule::Controllability));
        }
    }
    assert!(
        kept > 300 && broken > 300 && consistent > 100,
        "{kept} kept, {broken} broken, {consistent} by nature"
    );
}

#[test]
fn one_schedule_suits_all_durations_exactly_where_the_check_says_so() {
    const HORIZON: i64 = 6;
    let (mut suited, mut not_suited) = (0, 0);
    for seed in 0..400 {
        let mut rng = Rng::new(seed + 10_000);
        let mut network = tiny(&mut rng, 4, HORIZON);
        // What is tied to the environment's events has no time beforehand, and the brute force gives it one.
        network.arcs.retain(|arc| !(arc.lower.is_zero() && arc.upper == Bound::ZERO));
        join(&mut network);
        network.controllability = Controllability::Strong;
        let is_found = is_kept(&check_plan(&network, &plan_of_everything(&network)));
        let has_schedule = has_schedule_for_all(&network, HORIZON);
        assert_eq!(is_found, has_schedule, "seed {seed}: {:?}", network.arcs);
        *(if is_found { &mut suited } else { &mut not_suited }) += 1;
    }
    assert!(suited > 40 && not_suited > 40, "{suited} suited, {not_suited} not");
}

/// Tries all times of the executive's events against all durations of the environment's. Ranges lead to higher numbers.
fn has_schedule_for_all(network: &Network, horizon: i64) -> bool {
    let events = network.nodes.len();
    let range_of =
        |event: usize| network.arcs.iter().find(|arc| arc.is_contingent && arc.to.index() == event);
    let free: Vec<usize> = (1..events).filter(|&event| range_of(event).is_none()).collect();
    let natures: Vec<usize> = (1..events).filter(|&event| range_of(event).is_some()).collect();
    combinations(&vec![(0, horizon); free.len()]).into_iter().any(|times| {
        let ranges: Vec<(i64, i64)> = (natures.iter())
            .map(|&event| {
                let arc = range_of(event).expect("one of nature's");
                let Bound::Finite(upper) = arc.upper else { panic!("a finite range") };
                (arc.lower.numerator(), upper.numerator())
            })
            .collect();
        combinations(&ranges).into_iter().all(|durations| {
            let mut at = vec![0; events];
            for (&event, &time) in free.iter().zip(&times) {
                at[event] = time;
            }
            for (&event, &duration) in natures.iter().zip(&durations) {
                at[event] = at[range_of(event).expect("one of nature's").from.index()] + duration;
            }
            network.arcs.iter().all(|arc| {
                let taken = Time::from(at[arc.to.index()] - at[arc.from.index()]);
                arc.lower <= taken && Bound::Finite(taken) <= arc.upper
            })
        })
    })
}

fn combinations(ranges: &[(i64, i64)]) -> Vec<Vec<i64>> {
    let mut all = vec![Vec::new()];
    for &(least, greatest) in ranges {
        all = (all.into_iter())
            .flat_map(|before: Vec<i64>| {
                (least..=greatest).map(move |value| before.iter().copied().chain([value]).collect())
            })
            .collect();
    }
    all
}
