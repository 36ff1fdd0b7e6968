//! Conflicts depend on nothing superfluous and suffice; relaxations resolve, and by the least change.

use crate::oracle::{by_reductions, small};
use stnu::generate::{Kind, Shape};
use stnu::{
    Conflict, Link, LinkId, Network, Part, PointId, Verdict, check, conflict_among, generate, minimal,
    part_edge, relax, relaxations,
};

fn conflict_of(network: &Network) -> Option<Conflict> {
    match check(network, &mut || false).expect("small numbers") {
        Verdict::Controllable => None,
        Verdict::Uncontrollable(conflict) => Some(conflict),
    }
}

fn parts(conflict: &Conflict) -> Vec<Part> {
    conflict.members.iter().map(|member| member.part).collect()
}

/// The network of some parts, for the oracle: a link with one side only is an ordinary edge.
fn network_of(network: &Network, parts: &[Part]) -> Network {
    let mut of = Network::new(network.num_points());
    for &part in parts {
        let is_link = match part {
            Part::Edge(_) => false,
            Part::Lower(id) => parts.contains(&Part::Upper(id)),
            Part::Upper(id) => parts.contains(&Part::Lower(id)),
        };
        match part {
            Part::Lower(id) if is_link => {
                of.add_link(*network.link(id)).expect("a link of the network");
            }
            Part::Upper(_) if is_link => {}
            _ => {
                let edge = part_edge(network, part);
                of.add_edge(edge.from, edge.to, edge.weight);
            }
        }
    }
    of
}

fn assert_is_cycle(network: &Network, conflict: &Conflict, seed: u64) {
    let cycle = conflict.cycle.as_ref().expect("a short cycle");
    let weight: i64 = cycle.iter().map(|step| step.weight).sum();
    assert_eq!(weight, -conflict.deficit, "seed {seed}");
    assert!(weight < 0, "seed {seed}");
    for (step, next) in cycle.iter().zip(cycle.iter().cycle().skip(1)) {
        assert_eq!(step.to, next.from, "seed {seed}: {conflict:?}");
        let edge = part_edge(network, step.part);
        assert_eq!((step.from, step.to, step.weight), (edge.from, edge.to, edge.weight), "seed {seed}");
    }
    for member in &conflict.members {
        let times = cycle.iter().filter(|step| step.part == member.part).count();
        assert_eq!(times as u64, member.multiplicity, "seed {seed}");
    }
    let all: u64 = conflict.members.iter().map(|member| member.multiplicity).sum();
    assert_eq!(all, cycle.len() as u64, "seed {seed}");
}

#[test]
fn conflicts_suffice_and_minimal_ones_need_each_member() {
    let (mut conflicts, mut shortened) = (0, 0);
    for seed in 0..20_000 {
        let network = small(seed, 3 + (seed % 6) as usize, 2 + (seed % 9) as i64);
        let Some(conflict) = conflict_of(&network) else { continue };
        assert_is_cycle(&network, &conflict, seed);
        assert!(!by_reductions(&network_of(&network, &parts(&conflict))), "seed {seed}: {conflict:?}");
        let least = minimal(&network, &conflict, &mut || false).expect("small numbers");
        assert_is_cycle(&network, &least, seed);
        let needed = parts(&least);
        assert!(!by_reductions(&network_of(&network, &needed)), "seed {seed}: {least:?}");
        for &part in &needed {
            let others: Vec<Part> = needed.iter().copied().filter(|&other| other != part).collect();
            assert!(by_reductions(&network_of(&network, &others)), "seed {seed}: {part:?} of {least:?}");
            assert_eq!(conflict_among(&network, &others, &mut || false), Ok(None), "seed {seed}");
        }
        conflicts += 1;
        shortened += u32::from(needed.len() < conflict.members.len());
    }
    assert!(conflicts > 3_000, "{conflicts}");
    assert!(shortened > 0, "{shortened}");
}

#[test]
fn relaxations_are_the_least_changes() {
    let (mut found, mut none) = (0, 0);
    for seed in 0..3_000 {
        let network = small(seed, 3 + (seed % 6) as usize, 2 + (seed % 9) as i64);
        let Some(conflict) = conflict_of(&network) else { continue };
        let least = minimal(&network, &conflict, &mut || false).expect("small numbers");
        for relaxation in relaxations(&network, &least, &mut || false).expect("small numbers") {
            let with = |value: i64| {
                let mut changed = network.clone();
                relax(&mut changed, relaxation.part, value);
                changed
            };
            // Toward what is easier.
            let (step, limit) = match relaxation.part {
                Part::Edge(_) => (1, relaxation.old + 1_000),
                Part::Lower(id) => (1, network.link(id).upper),
                Part::Upper(id) => (-1, network.link(id).lower),
            };
            if let Some(value) = relaxation.sufficient {
                found += 1;
                assert!(by_reductions(&with(value)), "seed {seed}: {relaxation:?}");
                assert!(!by_reductions(&with(value - step)), "seed {seed}: {relaxation:?}");
                assert!((value - relaxation.resolving.expect("at least this one")) * step >= 0);
            } else {
                none += 1;
                assert!(!by_reductions(&with(limit)), "seed {seed}: {relaxation:?}");
            }
            if let Some(value) = relaxation.resolving {
                let is_resolved = |value: i64| by_reductions(&network_of(&with(value), &parts(&least)));
                assert!(is_resolved(value) && !is_resolved(value - step), "seed {seed}: {relaxation:?}");
            }
        }
    }
    assert!(found > 300 && none > 300, "{found}, {none}");
}

#[test]
fn the_drive_to_the_window_needs_a_shorter_drive_or_a_wider_window() {
    // 0 origin, 1 start of the drive, 2 its end, in [20,40] after the start and [30,35] after the origin.
    let mut network = Network::new(3);
    let drive = Link { activation: PointId(1), end: PointId(2), lower: 20, upper: 40 };
    network.add_link(drive).expect("a link");
    let latest = network.add_edge(PointId(0), PointId(2), 35);
    let earliest = network.add_edge(PointId(2), PointId(0), -30);
    let (lower, upper) = (Part::Lower(LinkId(0)), Part::Upper(LinkId(0)));
    let told = |network: &Network| {
        let conflict = conflict_of(network).expect("not controllable");
        let least = minimal(network, &conflict, &mut || false).expect("small numbers");
        let told = relaxations(network, &least, &mut || false).expect("small numbers");
        let told: Vec<_> = told.iter().map(|one| (one.part, one.resolving, one.sufficient)).collect();
        (least.deficit, told)
    };
    // The window is 5 wide, and the drive uncertain by 20: 15 are missing.
    let same = |part: Part, value: i64| (part, Some(value), Some(value));
    let expected =
        [same(Part::Edge(latest), 50), same(Part::Edge(earliest), -15), same(lower, 35), same(upper, 25)];
    assert_eq!(told(&network), (15, expected.to_vec()));
    // If the drive may not start before the origin either, it takes 5 too long already for that. An earlier start
    // would not be enough: the window is too narrow.
    let start = network.add_edge(PointId(1), PointId(0), 0);
    let expected = [
        (Part::Edge(latest), Some(40), Some(50)),
        (Part::Edge(start), Some(5), None),
        (upper, Some(35), Some(25)),
    ];
    assert_eq!(told(&network), (5, expected.to_vec()));
}

#[test]
fn conflicts_of_larger_networks_suffice_too() {
    for kind in [Kind::Workflow, Kind::JobShop, Kind::Tree, Kind::Scattered, Kind::Near] {
        let mut conflicts = 0;
        for seed in 0..12 {
            let shape = Shape { kind, points: 120, links: 30, slack_percent: -40 };
            let network = generate::network(shape, seed);
            let Some(conflict) = conflict_of(&network) else { continue };
            conflicts += 1;
            let least = minimal(&network, &conflict, &mut || false).expect("small numbers");
            assert_is_cycle(&network, &least, seed);
            assert!(conflict_among(&network, &parts(&least), &mut || false).expect("small").is_some());
            for &part in &parts(&least) {
                let others: Vec<Part> = parts(&least).into_iter().filter(|&other| other != part).collect();
                assert_eq!(conflict_among(&network, &others, &mut || false), Ok(None), "{kind:?} {seed}");
            }
        }
        assert!(conflicts > 2, "{kind:?}: {conflicts}");
    }
}

#[test]
fn a_constraint_that_is_used_twice_counts_twice() {
    let mut network = Network::new(7);
    let point = PointId;
    // After 2 comes 4 by 5 to 13; before 4 can come, 3 must have been and 5 six earlier than that …
    let second = Link { activation: point(2), end: point(4), lower: 5, upper: 13 };
    let first = Link { activation: point(5), end: point(6), lower: 1, upper: 4 };
    network.add_link(first).expect("a link");
    network.add_link(second).expect("a link");
    network.add_edge(point(4), point(0), 2);
    let twice = network.add_edge(point(0), point(3), 0);
    network.add_edge(point(3), point(5), -6);
    // … and from 5, by way of 6 and the same 0 and 3, there are at most 6 until 4.
    network.add_edge(point(6), point(0), 5);
    network.add_edge(point(3), point(4), 0);
    let conflict = conflict_of(&network).expect("not controllable");
    assert_is_cycle(&network, &conflict, 0);
    assert_eq!(conflict.multiplicity(Part::Edge(twice)), 2);
    // 5 + 2 + 0 − 6 + 1 + 5 + 0 + 0 − 13
    assert_eq!(conflict.deficit, 6);
    assert_eq!(minimal(&network, &conflict, &mut || false), Ok(conflict.clone()));
    let told = relaxations(&network, &conflict, &mut || false).expect("small numbers");
    let of_twice = told.iter().find(|one| one.part == Part::Edge(twice)).expect("a member");
    assert_eq!(of_twice.sufficient, Some(3), "half of what is missing");
}
