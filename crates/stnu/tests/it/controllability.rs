//! Dynamic and strong controllability: named examples, and random networks against two oracles.

use crate::oracle::{Game, by_reductions, scaled, small, within};
use stnu::generate::{Kind, Random, Shape};
use stnu::{
    Checker, Edge, Link, LinkError, Network, PointId, Refusal, StrongVerdict, Undecided, Verdict, check,
    check_strong, generate,
};

fn is_controllable(network: &Network) -> bool {
    check(network, &mut || false).expect("small numbers") == Verdict::Controllable
}

fn is_strong(network: &Network) -> bool {
    matches!(check_strong(network).expect("small numbers"), StrongVerdict::Controllable(_))
}

fn point(index: u32) -> PointId {
    PointId(index)
}

fn link(activation: u32, end: u32, lower: i64, upper: i64) -> Link {
    Link { activation: point(activation), end: point(end), lower, upper }
}

/// `lower ≤ to − from ≤ upper`
fn bound(network: &mut Network, from: u32, to: u32, lower: i64, upper: i64) {
    network.add_edge(point(from), point(to), upper);
    network.add_edge(point(to), point(from), -lower);
}

/// A drive of [20,40] from 0 to 1 that must end within `window` of 2, where it may start at any time.
fn drive_to_window(from: i64, to: i64) -> Network {
    let mut network = Network::new(3);
    // 0 is the origin, 1 the start of the drive, 2 its end.
    network.add_link(link(1, 2, 20, 40)).expect("a link");
    network.add_edge(point(1), point(0), 0);
    bound(&mut network, 0, 2, from, to);
    network
}

#[test]
fn a_drive_of_20_to_40_fits_a_window_of_20_but_not_of_5() {
    assert!(!is_controllable(&drive_to_window(30, 35)));
    assert!(!is_controllable(&drive_to_window(30, 49)));
    assert!(is_controllable(&drive_to_window(30, 50)));
    assert!(is_strong(&drive_to_window(30, 50)));
    // Not before the origin: started at 0 it ends at 20 at the earliest.
    assert!(!is_controllable(&drive_to_window(10, 39)));
}

#[test]
fn a_wait_ends_the_moment_the_word_is_given() {
    // 0 origin, 1 GO (5 to 20 after the origin), 2 end of the wait: at the instant of GO.
    let mut network = Network::new(3);
    network.add_link(link(0, 1, 5, 20)).expect("a link");
    bound(&mut network, 1, 2, 0, 0);
    assert!(is_controllable(&network), "reaction is instantaneous");
    assert!(!is_strong(&network), "but one has to look");
    // One unit before the word is clairvoyance, one after it is easy.
    let mut before = Network::new(3);
    before.add_link(link(0, 1, 5, 20)).expect("a link");
    bound(&mut before, 2, 1, 1, 1);
    assert!(!is_controllable(&before));
    let mut after = Network::new(3);
    after.add_link(link(0, 1, 5, 20)).expect("a link");
    bound(&mut after, 1, 2, 1, 1);
    assert!(is_controllable(&after));
}

#[test]
fn a_wait_is_enough_where_no_schedule_is() {
    // The end of a link of [1,10] must come at most 3 after X and at most 7 before it: wait for it or until 7.
    let network = |before: i64| {
        let mut network = Network::new(3);
        network.add_link(link(0, 1, 1, 10)).expect("a link");
        bound(&mut network, 2, 1, before, 3);
        network
    };
    // X waits for the end or until 7 after the activation: then it may be up to 3 before the end.
    assert!(is_controllable(&network(-7)));
    assert!(is_controllable(&network(0)) == by_reductions(&network(0)));
    assert!(!is_controllable(&network(1)));
}

#[test]
fn links_in_sequence_and_links_that_nature_starts() {
    // 0 =[1,2]⇒ 1 =[3,5]⇒ 2, which must end within [4,7] of 0: exactly their sum.
    let mut network = Network::new(3);
    network.add_link(link(0, 1, 1, 2)).expect("a link");
    network.add_link(link(1, 2, 3, 5)).expect("a link");
    bound(&mut network, 0, 2, 4, 7);
    assert!(is_controllable(&network));
    assert!(is_strong(&network));
    network.add_edge(point(0), point(2), 6);
    assert!(!is_controllable(&network));
}

#[test]
fn an_inconsistent_network_is_not_controllable() {
    let mut network = Network::new(3);
    network.add_link(link(0, 1, 1, 2)).expect("a link");
    bound(&mut network, 0, 2, 5, 3);
    assert!(!is_controllable(&network));
    assert!(!is_strong(&network));
}

#[test]
fn links_are_refused_with_the_reason() {
    let mut network = Network::new(4);
    assert_eq!(network.add_link(link(0, 1, 3, 2)), Err(LinkError::Range));
    assert_eq!(network.add_link(link(0, 1, -1, 2)), Err(LinkError::Range));
    assert_eq!(network.add_link(link(0, 9, 1, 2)), Err(LinkError::Point));
    assert_eq!(network.add_link(link(0, 0, 1, 2)), Err(LinkError::Circular));
    let first = network.add_link(link(0, 1, 1, 2)).expect("a link");
    assert_eq!(network.add_link(link(2, 1, 1, 2)), Err(LinkError::EndTaken(first)));
    network.add_link(link(1, 2, 1, 2)).expect("a link");
    assert_eq!(network.add_link(link(2, 0, 1, 2)), Err(LinkError::Circular));
}

#[test]
fn what_does_not_fit_is_overflow() {
    let mut network = Network::new(3);
    network.add_link(link(0, 1, 1, i64::MAX)).expect("a link");
    network.add_edge(point(1), point(2), i64::MAX - 1);
    network.add_edge(point(2), point(1), i64::MIN + 1);
    assert_eq!(check(&network, &mut || false), Err(Undecided::Overflow));
}

#[test]
fn a_check_can_be_stopped() {
    let network = drive_to_window(30, 50);
    assert_eq!(check(&network, &mut || true), Err(Undecided::Stopped));
}

#[test]
fn random_networks_agree_with_labeled_reductions() {
    let mut verdicts = [0, 0];
    for seed in 0..40_000 {
        let network = small(seed, 3 + (seed % 6) as usize, 2 + (seed % 9) as i64);
        let expected = by_reductions(&network);
        assert_eq!(is_controllable(&network), expected, "seed {seed}: {network:?}");
        verdicts[usize::from(expected)] += 1;
    }
    assert!(verdicts.iter().all(|&count| count > 4_000), "both verdicts occur: {verdicts:?}");
}

#[test]
fn random_networks_agree_with_the_game() {
    let mut verdicts = [0, 0];
    for seed in 0..3_000 {
        let network = within(&small(seed, 3 + (seed % 3) as usize, 2), 5);
        let expected = is_controllable(&network);
        // Twice as fine a grid: the environment may act between two integers.
        assert_eq!(Game::is_won(&scaled(&network, 2), 10), expected, "seed {seed}: {network:?}");
        verdicts[usize::from(expected)] += 1;
    }
    assert!(verdicts.iter().all(|&count| count > 300), "both verdicts occur: {verdicts:?}");
}

#[test]
fn strong_implies_dynamic_implies_consistent() {
    let mut steps = [0, 0, 0];
    for seed in 0..10_000 {
        let network = small(seed, 3 + (seed % 5) as usize, 5);
        let mut ordinary = Network::new(network.num_points());
        for edge in network.edges() {
            ordinary.add_edge(edge.from, edge.to, edge.weight);
        }
        for link in network.links() {
            bound(&mut ordinary, link.activation.0, link.end.0, link.lower, link.upper);
        }
        let (strong, dynamic, consistent) =
            (is_strong(&network), is_controllable(&network), is_controllable(&ordinary));
        assert!(!strong || dynamic, "seed {seed}");
        assert!(!dynamic || consistent, "seed {seed}");
        steps[0] += u32::from(strong);
        steps[1] += u32::from(dynamic && !strong);
        steps[2] += u32::from(consistent && !dynamic);
    }
    assert!(steps.iter().all(|&count| count > 20), "every step is proper: {steps:?}");
}

#[test]
fn a_strong_schedule_suits_the_ends_of_all_ranges() {
    for seed in 0..4_000 {
        let network = small(seed, 4 + (seed % 4) as usize, 5);
        let StrongVerdict::Controllable(schedule) = check_strong(&network).expect("small numbers") else {
            continue;
        };
        let mut links: Vec<Link> = network.links().to_vec();
        // Activations before ends.
        let depth = |mut at: PointId| {
            let mut depth = 0;
            while let Some(link) = network.link_ending_at(at) {
                at = network.link(link).activation;
                depth += 1;
            }
            depth
        };
        links.sort_by_key(|link| depth(link.end));
        for choice in 0..1_u32 << links.len() {
            let mut times = schedule.clone();
            for (bit, link) in links.iter().enumerate() {
                let duration = if choice >> bit & 1 == 0 { link.lower } else { link.upper };
                times[link.end.index()] = times[link.activation.index()] + duration;
            }
            for edge in network.edges() {
                assert!(times[edge.to.index()] - times[edge.from.index()] <= edge.weight, "seed {seed}");
            }
        }
    }
}

#[test]
fn generated_networks_with_slack_are_controllable_and_without_are_not() {
    for kind in [Kind::Workflow, Kind::JobShop] {
        for seed in 0..20 {
            let shape = Shape { kind, points: 60, links: 20, slack_percent: 0 };
            let network = generate::network(shape, seed);
            assert!(!network.links().is_empty());
            assert!(is_controllable(&network), "{kind:?} {seed}");
            assert!(by_reductions(&network));
            let network = generate::network(Shape { slack_percent: -60, ..shape }, seed);
            assert!(!is_controllable(&network), "{kind:?} {seed}");
        }
    }
    let mut verdicts = [0, 0];
    for kind in [Kind::Tree, Kind::Scattered, Kind::Near] {
        for seed in 0..100 {
            let slack_percent = (seed % 10) as i64 * 10 - 50;
            let network = generate::network(Shape { kind, points: 14, links: 4, slack_percent }, seed);
            let expected = by_reductions(&network);
            assert_eq!(is_controllable(&network), expected, "{kind:?} {seed}");
            verdicts[usize::from(expected)] += 1;
        }
    }
    assert!(verdicts.iter().all(|&count| count > 10), "{verdicts:?}");
}

#[test]
fn insertion_and_undo_agree_with_checking_from_scratch() {
    let mut refused = 0;
    for seed in 0..3_000 {
        let mut random = Random::new(seed);
        let points = 4 + random.below(5);
        let mut checker = Checker::new(points);
        let mut places = Vec::new();
        for _ in 0..30 {
            match random.below(8) {
                0 => places.push((checker.checkpoint(), checker.network().clone())),
                1 => {
                    if let Some((checkpoint, network)) = places.pop() {
                        checker.rollback(checkpoint);
                        assert_eq!(checker.network(), &network);
                    }
                }
                2 | 3 => {
                    let lower = random.between(0, 6);
                    let (from, to) = (random.below(points) as u32, random.below(points) as u32);
                    let link = link(from, to, lower, lower + random.between(0, 6));
                    let mut with = checker.network().clone();
                    if with.add_link(link).is_err() {
                        assert!(matches!(checker.insert_link(link, &mut || false), Err(Refusal::Link(_))));
                        continue;
                    }
                    let result = checker.insert_link(link, &mut || false);
                    assert_eq!(result.is_ok(), is_controllable(&with), "seed {seed}: {with:?}");
                    refused += u32::from(result.is_err());
                }
                4 if random.chance(20) => {
                    checker.add_point();
                }
                _ => {
                    let mut with = checker.network().clone();
                    let mut edges = Vec::new();
                    for _ in 0..=random.below(2) {
                        let (from, to) = (random.below(points) as u32, random.below(points) as u32);
                        let edge = Edge { from: point(from), to: point(to), weight: random.between(-4, 12) };
                        with.add_edge(edge.from, edge.to, edge.weight);
                        edges.push(edge);
                    }
                    let before = checker.network().clone();
                    match checker.insert(&edges, &mut || false) {
                        Ok(()) => assert!(is_controllable(&with), "seed {seed}: {with:?}"),
                        Err(Refusal::Uncontrollable(conflict)) => {
                            assert!(!is_controllable(&with), "seed {seed}: {with:?}");
                            assert!(conflict.deficit > 0);
                            assert_eq!(checker.network(), &before);
                            refused += 1;
                        }
                        Err(other) => panic!("seed {seed}: {other:?}"),
                    }
                }
            }
        }
    }
    assert!(refused > 3_000, "{refused}");
}
