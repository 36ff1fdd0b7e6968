//! Dispatch with waits never fails while the environment keeps to its ranges; where a network is not controllable, the
//! adversary makes every executive fail.

use crate::oracle::{scaled, small, within};
use stnu::adversary::{Intention, broken, failing_run, residual, respond};
use stnu::generate::{Kind, Random, Shape};
use stnu::{
    DispatchError, Dispatchable, Dispatcher, Link, LinkId, Network, PointId, Status, Verdict, check, generate,
};

fn is_controllable(network: &Network) -> bool {
    check(network, &mut || false).expect("small numbers") == Verdict::Controllable
}

fn dispatchable(network: &Network) -> Option<Dispatchable> {
    Dispatchable::new(network, &mut || false).expect("small numbers")
}

/// How the environment chooses a duration.
#[derive(Clone, Copy)]
enum Nature {
    Random,
    /// Only ends of ranges.
    Extreme,
}

/// Runs a network to its end. `eager`: the executive does all as early as it may; else it dawdles at random.
fn run(form: &Dispatchable, nature: Nature, is_eager: bool, random: &mut Random) -> Vec<i64> {
    let network = &form.network;
    let mut dispatcher = Dispatcher::new(form, 0);
    let durations: Vec<i64> = network
        .links()
        .iter()
        .map(|link| match nature {
            Nature::Random => random.between(link.lower, link.upper),
            Nature::Extreme => {
                if random.chance(50) {
                    link.lower
                } else {
                    link.upper
                }
            }
        })
        .collect();
    let mut steps = 0;
    while !dispatcher.is_done() {
        steps += 1;
        assert!(steps < 100_000, "the run comes to an end");
        // The environment first.
        let due = (0..).map(LinkId).zip(network.links()).find(|(id, link)| {
            let start = dispatcher.times()[link.activation.index()];
            dispatcher.times()[link.end.index()].is_none()
                && start.is_some_and(|start| start + durations[id.index()] == dispatcher.now())
        });
        if let Some((link, _)) = due {
            dispatcher.observe(link).expect("within its range");
            continue;
        }
        let executable = dispatcher.executable();
        let deadline = dispatcher.deadline();
        let must = deadline == Some(dispatcher.now());
        if !executable.is_empty() && (is_eager || must || random.chance(50)) {
            let urgent = executable.iter().copied().find(|&point| {
                matches!(dispatcher.status(point), Status::Enabled { until, .. } if until == Some(dispatcher.now()))
            });
            let any = executable[random.below(executable.len())];
            dispatcher.execute(urgent.unwrap_or(any)).expect("what is executable is");
            continue;
        }
        let next_end = (0..).zip(network.links()).filter_map(|(id, link): (usize, _)| {
            let is_open = dispatcher.times()[link.end.index()].is_none();
            Some(dispatcher.times()[link.activation.index()]? + durations[id]).filter(|_| is_open)
        });
        let mut to = dispatcher.next_time().filter(|&time| time > dispatcher.now());
        if !is_eager {
            to = Some(dispatcher.now() + random.between(1, 4));
        }
        for time in next_end.chain(deadline) {
            to = Some(to.map_or(time, |to| to.min(time)));
        }
        let to = to.expect("something is left to happen");
        assert!(to > dispatcher.now(), "nothing can happen: {:?}", dispatcher.times());
        dispatcher.advance(to).expect("not beyond the deadline");
    }
    dispatcher.times().iter().map(|time| time.expect("all have happened")).collect()
}

fn assert_kept(network: &Network, times: &[i64], seed: u64) {
    for edge in network.edges() {
        let difference = times[edge.to.index()] - times[edge.from.index()];
        assert!(difference <= edge.weight, "seed {seed}: {edge:?} in {times:?} of {network:?}");
    }
}

#[test]
fn there_is_a_dispatchable_form_exactly_of_controllable_networks() {
    for seed in 0..20_000 {
        let network = small(seed, 3 + (seed % 6) as usize, 2 + (seed % 9) as i64);
        assert_eq!(dispatchable(&network).is_some(), is_controllable(&network), "seed {seed}: {network:?}");
    }
}

#[test]
fn controllable_networks_never_fail() {
    let mut runs = 0;
    for seed in 0..4_000 {
        let network = small(seed, 3 + (seed % 6) as usize, 2 + (seed % 9) as i64);
        let Some(form) = dispatchable(&network) else { continue };
        let mut random = Random::new(seed);
        for round in 0..8 {
            let nature = if round % 2 == 0 { Nature::Random } else { Nature::Extreme };
            let times = run(&form, nature, round < 4, &mut random);
            assert_kept(&network, &times, seed);
            runs += 1;
        }
    }
    assert!(runs > 10_000, "{runs}");
}

#[test]
fn larger_controllable_networks_never_fail() {
    let mut runs = 0;
    for kind in [Kind::Workflow, Kind::JobShop, Kind::Tree, Kind::Scattered, Kind::Near] {
        for seed in 0..12 {
            let slack_percent = if kind == Kind::Scattered { 400 } else { 0 };
            let network = generate::network(Shape { kind, points: 60, links: 20, slack_percent }, seed);
            let Some(form) = dispatchable(&network) else { continue };
            let mut random = Random::new(seed);
            for round in 0..20 {
                let nature = if round % 2 == 0 { Nature::Random } else { Nature::Extreme };
                let times = run(&form, nature, round < 10, &mut random);
                assert_kept(&network, &times, seed);
                runs += 1;
            }
        }
    }
    assert!(runs > 600, "{runs}");
}

#[test]
fn ten_thousand_runs_of_one_network_never_fail() {
    let shape = Shape { kind: Kind::Workflow, points: 25, links: 10, slack_percent: 0 };
    let network = generate::network(shape, 7);
    let form = dispatchable(&network).expect("controllable");
    let mut random = Random::new(7);
    for round in 0..10_000 {
        let nature = if round % 3 == 0 { Nature::Extreme } else { Nature::Random };
        assert_kept(&network, &run(&form, nature, round % 2 == 0, &mut random), round);
    }
}

#[test]
fn a_wait_ends_with_the_link_or_by_itself() {
    // 0 =[1,10]⇒ 1, and 2 at most 3 after 1 and at most 7 before it.
    let mut network = Network::new(3);
    let link = Link { activation: PointId(0), end: PointId(1), lower: 1, upper: 10 };
    let id = network.add_link(link).expect("a link");
    network.add_edge(PointId(1), PointId(2), 3);
    network.add_edge(PointId(2), PointId(1), 7);
    let form = dispatchable(&network).expect("controllable");
    let waiting =
        |from, waits: &[(LinkId, i64)]| Status::Enabled { from, until: None, waits: waits.to_vec() };
    let mut dispatcher = Dispatcher::new(&form, 0);
    assert_eq!(dispatcher.execute(PointId(2)), Err(DispatchError::Blocked));
    dispatcher.execute(PointId(0)).expect("nothing before it");
    // The end comes at 10 at the latest, which may be 7 after: the wait is until 3.
    assert_eq!(dispatcher.status(PointId(2)), waiting(3, &[(id, 3)]));
    assert_eq!(dispatcher.execute(PointId(2)), Err(DispatchError::Early(3)));
    assert_eq!(dispatcher.observe(id), Err(DispatchError::Early(1)));
    assert_eq!(dispatcher.execute(PointId(1)), Err(DispatchError::Owner));
    assert_eq!(dispatcher.advance(11), Err(DispatchError::Late(10)));
    let windows = dispatcher.windows().expect("small numbers");
    // At the earliest when the link ends as soon as it can.
    assert_eq!((windows[2].earliest, windows[2].latest), (1, Some(13)));
    assert_eq!((windows[1].earliest, windows[1].latest), (1, Some(10)));
    let mut early = dispatcher.clone();
    early.advance(2).expect("before the deadline");
    early.observe(id).expect("within its range");
    assert_eq!(early.status(PointId(2)), Status::Enabled { from: 1, until: Some(5), waits: vec![] });
    early.execute(PointId(2)).expect("the wait is over");
    dispatcher.advance(3).expect("before the deadline");
    dispatcher.execute(PointId(2)).expect("the wait is over by itself");
    assert_eq!(dispatcher.advance(2), Err(DispatchError::Past));
    assert_eq!(dispatcher.execute(PointId(2)), Err(DispatchError::Executed));
}

/// Plays nature's strategy against an executive that does a random thing at a random time that breaks nothing yet.
fn nature_wins(network: &Network, seed: u64) -> bool {
    let mut random = Random::new(seed);
    let mut times: Vec<Option<i64>> = vec![None; network.num_points()];
    times[0] = Some(0);
    let mut now = 0;
    loop {
        if broken(network, &times, now).is_some() {
            return true;
        }
        let free: Vec<PointId> = (0..network.num_points() as u32)
            .map(PointId)
            .filter(|&point| times[point.index()].is_none() && network.link_ending_at(point).is_none())
            .collect();
        let intention = (!free.is_empty()).then(|| {
            // The latest time at which nothing is broken, or sooner.
            let point = free[random.below(free.len())];
            let mut at = now + random.between(0, 4);
            while at > now && broken(network, &times, at).is_some() {
                at -= 1;
            }
            Intention { points: vec![point], at }
        });
        match respond(network, &times, now, intention.as_ref(), &mut || false).expect("small numbers") {
            Some((link, at)) => {
                assert!(at >= now && intention.as_ref().is_none_or(|intention| at <= intention.at));
                let link = network.link(link);
                let duration = at - times[link.activation.index()].expect("it has begun");
                assert!(link.lower <= duration && duration <= link.upper, "nature keeps to its ranges");
                (times[link.end.index()], now) = (Some(at), at);
            }
            None => match intention {
                Some(Intention { points, at }) => {
                    now = at;
                    times[points[0].index()] = Some(at);
                }
                None => return false,
            },
        }
    }
}

#[test]
fn the_adversary_makes_every_executive_fail() {
    let mut failures = 0;
    for seed in 0..3_000 {
        let network = scaled(&within(&small(seed, 3 + (seed % 4) as usize, 2), 6), 4);
        if is_controllable(&network) {
            continue;
        }
        for round in 0..4 {
            assert!(nature_wins(&network, seed * 4 + round), "seed {seed}: {network:?}");
        }
        let run = failing_run(&network, &mut || false).expect("small numbers").expect("it fails");
        assert!(run.events.windows(2).all(|pair| pair[0].1 <= pair[1].1), "seed {seed}");
        failures += 1;
    }
    assert!(failures > 500, "{failures}");
}

#[test]
fn the_drive_fails_where_it_takes_long_or_ends_at_once() {
    let mut network = Network::new(3);
    let drive = Link { activation: PointId(1), end: PointId(2), lower: 20, upper: 40 };
    network.add_link(drive).expect("a link");
    network.add_edge(PointId(1), PointId(0), 0);
    let latest = network.add_edge(PointId(0), PointId(2), 35);
    let earliest = network.add_edge(PointId(2), PointId(0), -30);
    let run = failing_run(&network, &mut || false).expect("small numbers").expect("it fails");
    // Started at once, it is over too soon.
    assert_eq!((run.broken, run.at), (earliest, 20));
    assert_eq!(run.events, [(PointId(0), 0), (PointId(1), 0), (PointId(2), 20)]);
    // Started so that it cannot be over too soon, it takes too long.
    let start = |at: i64| [Some(0), Some(at), None];
    assert_eq!(respond(&network, &start(10), 10, None, &mut || false), Ok(Some((LinkId(0), 50))));
    assert_eq!(broken(&network, &[Some(0), Some(10), Some(50)], 50), Some(latest));
    let started = residual(&network, &[Some(0), Some(10), None], 10).expect("small numbers");
    assert!(!is_controllable(&started));
    let ended = residual(&network, &[Some(0), Some(10), Some(32)], 32).expect("small numbers");
    assert!(is_controllable(&ended), "had it ended in time, nothing would be lost");
}
