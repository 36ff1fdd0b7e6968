//! Bounds between events of different threads (SPEC 14): in force where both are selected, and nowhere else.

use acceptance::mission::{all_plans, first_plan, network};
use exact::{Bound, Time};
use kirk::{FailureKind, Options, Search, Status, Unlimited};
use tpn::{ArcKind, Network, Plan};

const DECLARATIONS: &str =
    "primitive Drive()[5,10]; primitive Fast()[1,2]; primitive Pass()[3,4]; primitive Dig()[2,3];";

fn mission(rest: &str) -> Network {
    network(&format!("{DECLARATIONS} {rest}"))
}

#[track_caller]
fn window(network: &Network, plan: &Plan, event: &str) -> (Time, Bound) {
    let named = (0..network.nodes.len())
        .find(|&node| network.nodes[node].events.iter().any(|&it| network.event_name(it) == event))
        .unwrap_or_else(|| panic!("there is no event {event}"));
    let window = plan.windows[named].unwrap_or_else(|| panic!("{event} is not selected"));
    (window.earliest, window.latest)
}

#[track_caller]
fn expect(network: &Network, windows: &[(&str, i64, i64)]) {
    for search in [Search::Chronological, Search::ConflictDirected] {
        let outcome = first_plan(network, search);
        let plan = outcome.plans.first().unwrap_or_else(|| panic!("there is no plan by {search:?}"));
        for &(event, earliest, latest) in windows {
            let expected = (Time::from(earliest), Bound::Finite(Time::from(latest)));
            assert_eq!(window(network, plan, event), expected, "{event} by {search:?}");
        }
    }
}

#[test]
fn a_bound_between_threads_moves_the_windows_of_both() {
    let network = mission(
        "scenario S[0,20] = { { Drive() as Leg }, { delay; Pass()[4,4] as Relay } }
         constrain Leg.end to Relay.start [3,7];",
    );
    // Pass ends by 20, so that it starts by 16, 3 after a drive of 5 at the earliest.
    expect(&network, &[("Drive#1.end", 5, 10), ("Pass#1.start", 8, 16)]);
    let arcs: Vec<_> = network.constraints().collect();
    assert_eq!(arcs.len(), 1);
    let arc = &network.arcs[arcs[0].index()];
    assert!(network.nodes[arc.from.index()].out_arcs.iter().all(|out| *out != arcs[0]));
}

#[test]
fn a_bound_counts_only_where_both_ends_are_selected() {
    let text =
        "scenario S[0,60] = { choose { Drive() as Leg, Fast() }, { delay[20,20]; optional Pass() as Relay } }
         constrain Leg.start to Relay.start [30,40];";
    let plans = all_plans(&mission(text), Search::Chronological).plans;
    let mut choices: Vec<Vec<u32>> =
        plans.iter().map(|plan| plan.choices.iter().map(|choice| choice.alternative).collect()).collect();
    choices.sort();
    // Everything starts at 0, and the relay at 20: not with the drive.
    assert_eq!(choices, [vec![0, 1], vec![1, 0], vec![1, 1]]);
}

#[test]
fn alternatives_share_a_name_which_stands_for_the_selected_one() {
    let network = mission(
        "scenario S[0,60] = { choose { Drive() as Leg, Fast() as Leg }, { delay[20,20]; Pass() as Relay } }
         constrain Leg.end to Relay.start [18,19];",
    );
    let outcome = first_plan(&network, Search::ConflictDirected);
    assert_eq!(outcome.plans[0].choices[0].alternative, 1, "the drive ends 10 to 15 before the relay");
}

#[test]
fn interchangeable_alternatives_are_not_when_one_is_bound() {
    let network = mission(
        "scenario S[0,60] = { choose { Drive() as Leg, Drive() }, { delay[20,20]; Pass() as Relay } }
         constrain Leg.end to Relay.start [30,30];",
    );
    let outcome = first_plan(&network, Search::ConflictDirected);
    assert_eq!(outcome.plans[0].choices[0].alternative, 1);
}

#[test]
fn in_an_activity_and_in_copies_a_bound_is_about_their_own_events() {
    let network = mission(
        "Visit() = { Dig()[2,2] as Digging, { delay; Pass() as Relay } }
         scenario S[0,60] = { Visit(); Visit(); repeat 2 { Dig()[2,2] as Again; delay; Pass()[3,3] as After } }
         constrain Digging.start to Relay.start [4,4];
         constrain Again.end to After.end [7,7];",
    );
    assert_eq!(network.constraints().count(), 4);
    expect(&network, &[("Pass#1.start", 4, 4)]);
    let plan = &first_plan(&network, Search::ConflictDirected).plans[0];
    let earliest = |event: &str| window(&network, plan, event).0;
    // Each visit lasts 7 at least, and each copy 9.
    assert_eq!(earliest("Pass#2.start"), Time::from(11));
    assert_eq!(earliest("Pass#3.end"), Time::from(23));
    assert_eq!(earliest("Pass#4.end"), Time::from(32));
}

#[test]
fn a_name_beyond_the_instances_is_related_to_all_of_them() {
    let network = mission(
        "Visit() = { Dig()[2,2] as Digging }
         scenario S[0,60] = { { Visit(); Visit() }, { delay; Pass() as Relay } }
         constrain Digging.end to Relay.start [1,inf];",
    );
    assert_eq!(network.constraints().count(), 2);
    expect(&network, &[("Pass#1.start", 5, 57)]);
}

#[test]
fn a_contradiction_names_the_bound_and_offers_another() {
    let network = mission(
        "scenario S[0,60] = { Drive() as Leg, { delay[20,30]; Pass() as Relay } } constrain Leg.end to Relay.start [4,4];",
    );
    let outcome = kirk::plan(&network, &Options::default(), &mut Unlimited);
    assert_eq!(outcome.status, Status::NoPlan);
    let failure = outcome.failure.expect("it is explained");
    let reason = &failure.reasons[0];
    assert_eq!(reason.kind, FailureKind::Temporal);
    assert!(reason.message.contains("the bound from Drive#1.end to Pass#1.start"), "{}", reason.message);
    let is_offered = |arc: tpn::ArcId| network.arcs[arc.index()].kind == ArcKind::Constraint;
    let offered = failure.relaxations.iter().find(|relaxation| is_offered(relaxation.arc));
    // The drive ends at 10 at the latest, and the relay starts at 20 at the earliest.
    assert_eq!(offered.map(|offered| offered.new), Some(Time::from(10)), "{:?}", failure.relaxations);
}

#[test]
fn a_bound_over_what_nature_chooses_is_a_requirement() {
    let talk = |bounds: &str| {
        format!(
            "primitive Talk() contingent [5,9]; primitive Dig()[2,3];
             scenario S[0,60] = {{ Talk() as Talking, {{ delay; Dig() as Digging }} }}
             constrain Talking.{bounds};"
        )
    };
    let status = |text: &str| {
        let outcome = kirk::plan(&network(text), &Options::default(), &mut Unlimited);
        outcome.plans.iter().for_each(|plan| {
            acceptance::mission::sound(&network(text), plan).unwrap_or_else(|problem| panic!("{problem}"));
        });
        outcome.status
    };
    // Digging begins the moment the talk is over.
    assert_eq!(status(&talk("end to Digging.start [0,0]")), Status::Plan);
    // No one knows 2 before when that will be.
    assert_eq!(
        status(&talk("start to Digging.start [2,9]; constrain Digging.start to Talking.end [2,2]")),
        Status::NoPlan
    );
}

#[test]
fn with_a_negative_minimum_either_event_may_come_first() {
    let network = mission(
        "scenario S[0,20] = { { delay[6,6]; Drive()[5,5] as Leg }, { delay; Pass()[3,3] as Relay } }
         constrain Leg.start to Relay.start [-4,9];",
    );
    // The drive starts at 6, and the relay ends by 20.
    expect(&network, &[("Drive#1.start", 6, 6), ("Pass#1.start", 2, 15)]);
    let plan = &all_plans(&network, Search::Chronological).plans[0];
    assert!(!plan.instant_order(&network).iter().any(|&[from, to]| {
        let arc = &network.arcs[network.constraints().next().expect("there is one").index()];
        (from, to) == (arc.from, arc.to) || (to, from) == (arc.from, arc.to)
    }));
}

#[test]
fn a_bound_that_only_leads_back_is_the_same_bound_forward() {
    let text = |bound: &str| {
        format!(
            "scenario S[0,20] = {{ {{ delay; Drive() as Leg }}, {{ delay; Pass() as Relay }} }} constrain {bound};"
        )
    };
    let (back, forward) = (
        mission(&text("Leg.start to Relay.start [-7,-3]")),
        mission(&text("Relay.start to Leg.start [3,7]")),
    );
    let ends = |network: &Network| {
        let arc = &network.arcs[network.constraints().next().expect("there is one").index()];
        (arc.from, arc.to, arc.lower, arc.upper)
    };
    assert_eq!(ends(&back), ends(&forward));
    expect(&back, &[("Pass#1.start", 0, 12), ("Drive#1.start", 3, 15)]);
}

#[test]
fn a_negative_bound_that_cannot_be_kept_is_explained_and_another_is_offered() {
    let network = mission(
        "scenario S[0,60] = { Drive()[5,10] as Leg, { delay[2,3]; Pass() as Relay } } constrain Leg.end to Relay.start [-1,9];",
    );
    let outcome = kirk::plan(&network, &Options::default(), &mut Unlimited);
    assert_eq!(outcome.status, Status::NoPlan);
    let failure = outcome.failure.expect("it is explained");
    let message = &failure.reasons[0].message;
    // The drive takes 5, and the relay starts at most 1 before its end.
    let told =
        "Drive and the bound from Drive#1.end to Pass#1.start need at least 4, but the delay lasts at most 3";
    assert_eq!(message, told);
    let fixes: Vec<&str> = failure.relaxations.iter().map(|fix| fix.label.as_str()).collect();
    assert!(
        fixes.contains(&"lower the minimum of the bound from Drive#1.end to Pass#1.start from -1 to -2"),
        "{fixes:?}"
    );
}

/// Times from 0 to 12, tried one by one.
#[test]
fn windows_under_negative_bounds_are_those_of_all_schedules() {
    let mut random = tpn::generate::Rng::new(7);
    for _ in 0..60 {
        let mut draw = |low, high| random.between(low, high);
        let (low, high) = (draw(-8, 4), draw(-2, 8));
        if low > high {
            continue;
        }
        let (wait, back, forth) = (draw(0, 5), draw(-6, 0), draw(0, 6));
        let network = mission(&format!(
            "scenario S[0,12] = {{ {{ delay[{wait},9]; Dig()[2,3] as One }}, {{ delay; Pass()[3,4] as Other }} }}
             constrain One.start to Other.start [{low},{high}]; constrain Other.end to One.end [{back},{forth}];"
        ));
        let mut earliest: Option<i64> = None;
        for (one, one_end, other, other_end) in (0..=12).flat_map(|one| {
            (0..=12).flat_map(move |other| {
                (2..=3).flat_map(move |dig| (3..=4).map(move |pass| (one, one + dig, other, other + pass)))
            })
        }) {
            let is_fine = (wait..=9).contains(&one)
                && one_end.max(other_end) <= 12
                && (low..=high).contains(&(other - one))
                && (back..=forth).contains(&(one_end - other_end));
            if is_fine {
                earliest = Some(earliest.map_or(other, |known| known.min(other)));
            }
        }
        let outcome = first_plan(&network, Search::ConflictDirected);
        let found = outcome.plans.first().map(|plan| window(&network, plan, "Pass#1.start").0);
        assert_eq!(found, earliest.map(Time::from), "[{low},{high}] [{back},{forth}] after {wait}");
    }
}

#[test]
fn documents_keep_bounds_between_threads() {
    let network = mission(
        "scenario S[0,20] = { { Drive() as Leg }, { delay; Pass() as Relay } } constrain Leg.end to Relay.start [3,7];",
    );
    let read = tpn::network_json::network_from_json(&tpn::network_json::network_to_json(&network));
    let read = read.unwrap_or_else(|problem| panic!("{problem}"));
    assert_eq!(read.constraints().collect::<Vec<_>>(), network.constraints().collect::<Vec<_>>());
    let (before, after): (Vec<_>, Vec<_>) = (
        network.nodes.iter().map(|node| &node.out_arcs).collect(),
        read.nodes.iter().map(|node| &node.out_arcs).collect(),
    );
    assert_eq!(before, after);
}
