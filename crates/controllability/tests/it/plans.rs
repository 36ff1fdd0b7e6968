//! Plans with durations that nature chooses: the storm and the drive of SPEC 13, and ranges that end at one event.

use controllability::{PlanNetwork, Refutation, Side, Source, plan_network, scale};
use exact::{Bound, Time};
use rmpl::program::Controllability;
use tpn::selection::closure;
use tpn::{ArcId, Network, NodeId, OccurrenceId, Precedence, Top};

fn compiled(source: &str) -> Network {
    let program = rmpl::parse(source).program();
    let (network, diagnostics) = tpn::compile(&program, &Top::Scenario(None));
    assert!(
        diagnostics.iter().all(|diagnostic| diagnostic.severity != rmpl::Severity::Error),
        "{diagnostics:?}"
    );
    network.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

/// The arc of an occurrence's duration, which the environment chooses from now on.
fn contingent(network: &mut Network, name: &str) -> ArcId {
    let occurrence = named(network, name);
    let arc = network.occurrences[occurrence.index()].arc.expect("a duration");
    network.arcs[arc.index()].is_contingent = true;
    arc
}

fn named(network: &Network, name: &str) -> OccurrenceId {
    let found = network.occurrences.iter().position(|occurrence| occurrence.name == name);
    OccurrenceId::from_index(found.unwrap_or_else(|| panic!("{name}")))
}

fn start(network: &Network, name: &str) -> NodeId {
    network.occurrences[named(network, name).index()].start
}

fn end(network: &Network, name: &str) -> NodeId {
    network.occurrences[named(network, name).index()].end
}

/// Without choices everything is selected.
fn read(network: &Network, precedences: &[Precedence]) -> PlanNetwork {
    let (_, selected_arcs) = closure(network, &[]);
    plan_network(network, &selected_arcs, precedences, scale(network).expect("small times"))
        .expect("small times")
}

fn refute(network: &Network, precedences: &[Precedence]) -> Option<Refutation> {
    read(network, precedences).refute(network.controllability, &mut || false).expect("small times")
}

const DRIVE: &str = "primitive Drive()[20,40]; scenario S = { { Drive(); delay[0,0] }[30,35] }";

#[test]
fn a_drive_of_20_to_40_that_must_end_within_30_and_35_is_refuted_by_its_range_and_that_bound() {
    let mut network = compiled(DRIVE);
    assert_eq!(refute(&network, &[]), None, "the planner chooses 30 to 35");
    let drive = contingent(&mut network, "Drive#1");
    let refutation = refute(&network, &[]).expect("nature may take 40");
    let span = network.arcs.iter().position(|arc| arc.lower == Time::from(30)).map(ArcId::from_index);
    let span = span.expect("the block's bounds");
    let has = |arc, side| refutation.sources.contains(&Source::Arc(arc, side));
    let late = has(drive, Side::Upper) && has(span, Side::Upper);
    let early = has(drive, Side::Lower) && has(span, Side::Lower);
    assert!(late || early, "{refutation:?}");
    network.controllability = Controllability::None;
    assert_eq!(refute(&network, &[]), None, "read as ordinary");
}

#[test]
fn a_wait_of_5_to_10_after_a_drive_needs_a_look_at_when_that_ends() {
    let mut network = compiled("primitive Drive()[20,40]; scenario S = { { Drive(); delay[5,10] }[0,50] }");
    let drive = contingent(&mut network, "Drive#1");
    assert_eq!(refute(&network, &[]), None);
    network.controllability = Controllability::Strong;
    let refutation = refute(&network, &[]).expect("no one time is 5 to 10 after both 20 and 40");
    assert_eq!(refutation.conflict, None);
    assert!(refutation.sources.contains(&Source::Arc(drive, Side::Lower)), "{refutation:?}");
    assert!(refutation.sources.contains(&Source::Arc(drive, Side::Upper)), "{refutation:?}");
}

#[test]
fn what_is_tied_to_an_event_of_natures_needs_no_time_beforehand() {
    let mut network = compiled("primitive Drive()[20,40]; scenario S = { Drive(); delay[0,0]; delay[0,0] }");
    contingent(&mut network, "Drive#1");
    network.controllability = Controllability::Strong;
    assert_eq!(refute(&network, &[]), None);
    let made = read(&network, &[]);
    assert_eq!((made.network.num_points(), made.nodes(made.network.links()[0].end).len() > 1), (2, true));
}

#[test]
fn a_survey_cannot_be_kept_before_a_storm_that_comes_when_it_likes() {
    let mut network =
        compiled("primitive Survey()[10,20]; scenario S = { Survey(), { delay[5,100]; DUST[1,1] } }");
    let storm = "delay#1";
    let before_storm =
        Precedence { earlier: end(&network, "Survey#1"), later: end(&network, storm), least: Time::ZERO };
    assert_eq!(refute(&network, &[before_storm]), None, "the planner moves the storm");
    contingent(&mut network, storm);
    let refutation = refute(&network, &[before_storm]).expect("the storm may come at 5");
    assert!(refutation.sources.contains(&Source::Precedence(0)), "{refutation:?}");
}

#[test]
fn two_ranges_that_end_at_one_event_have_an_end_each_at_the_same_instant() {
    let mut network = compiled("primitive A()[1,5]; primitive B()[1,5]; scenario S = { A(), B() }");
    let (a, b) = (contingent(&mut network, "A#1"), contingent(&mut network, "B#1"));
    assert_eq!(refute(&network, &[]), None, "whoever is first is waited for");
    // Now both end at the event where A ends.
    let shared = end(&network, "A#1");
    network.arcs[b.index()].to = shared;
    let made = read(&network, &[]);
    let ends: Vec<&[NodeId]> = made.network.links().iter().map(|link| made.nodes(link.end)).collect();
    assert_eq!((ends[0].contains(&shared), ends[1]), (true, [].as_slice()));
    let refutation = refute(&network, &[]).expect("nature may end them apart");
    assert!(refutation.sources.contains(&Source::Tie(b)), "{refutation:?}");
    for arc in [a, b] {
        let arc = &mut network.arcs[arc.index()];
        (arc.lower, arc.upper) = (Time::from(3), Bound::Finite(Time::from(3)));
    }
    assert_eq!(refute(&network, &[]), None, "both take 3");
}

#[test]
fn constraints_lead_back_to_what_they_stand_for() {
    let mut network = compiled(DRIVE);
    let drive = contingent(&mut network, "Drive#1");
    let precedence = Precedence {
        earlier: start(&network, "Drive#1"),
        later: end(&network, "delay#1"),
        least: Time::from(1),
    };
    let made = read(&network, &[precedence]);
    assert_eq!(made.link(drive).map(|link| made.arc(link)), Some(drive));
    let sources: Vec<Source> = (0..made.network.edges().len() as u32)
        .map(|id| made.source(stnu::Part::Edge(stnu::EdgeId(id))))
        .collect();
    for (id, source) in (0..).zip(&sources) {
        let edge = *made.network.edge(stnu::EdgeId(id));
        let (from, to) = (Some(edge.from), Some(edge.to));
        let point = |node| made.point(node);
        match *source {
            Source::Arc(arc, Side::Lower) => {
                let arc = &network.arcs[arc.index()];
                assert_eq!(
                    (point(arc.to), point(arc.from), made.scale.time(-edge.weight)),
                    (from, to, arc.lower)
                );
            }
            Source::Arc(arc, Side::Upper) => {
                let arc = &network.arcs[arc.index()];
                let upper = Bound::Finite(made.scale.time(edge.weight));
                assert_eq!((point(arc.from), point(arc.to), upper), (from, to, arc.upper));
            }
            Source::Precedence(place) => {
                assert_eq!((place, from, to), (0, point(precedence.later), point(precedence.earlier)));
            }
            Source::Tie(_) => panic!("nothing ends twice"),
        }
    }
    assert!(sources.contains(&Source::Precedence(0)));
}
