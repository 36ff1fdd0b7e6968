//! Random networks with insertions and undos, against all pairs by Floyd and Warshall.

use stn::{
    Execution, ExecutionWindows, INFINITE, Inconsistency, Overflow, PairDistances, PointId, Stn,
    dispatchable, execution_windows, rigid_components,
};

/// Splitmix64: a seeded generator that is the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }

    fn between(&mut self, least: i64, greatest: i64) -> i64 {
        least + (self.next() % (greatest - least + 1) as u64) as i64
    }
}

type EdgeList = Vec<(usize, usize, i64)>;

/// All distances, or `None` if there is a negative cycle.
fn floyd_warshall(points: usize, edges: &EdgeList) -> Option<Vec<Vec<Option<i64>>>> {
    let mut distance = vec![vec![None; points]; points];
    for (point, row) in distance.iter_mut().enumerate() {
        row[point] = Some(0);
    }
    for &(from, to, weight) in edges {
        let known = &mut distance[from][to];
        *known = Some(known.map_or(weight, |known: i64| known.min(weight)));
    }
    for middle in 0..points {
        for from in 0..points {
            for to in 0..points {
                if let (Some(first), Some(second)) = (distance[from][middle], distance[middle][to])
                    && distance[from][to].is_none_or(|known| first + second < known)
                {
                    distance[from][to] = Some(first + second);
                }
            }
        }
    }
    (0..points).all(|point| distance[point][point] == Some(0)).then_some(distance)
}

fn point(index: usize) -> PointId {
    PointId(index as u32)
}

fn assert_distances(stn: &mut Stn, points: usize, edges: &EdgeList, seed: u64) {
    let expected = floyd_warshall(points, edges).expect("consistent");
    let matrix = stn.all_pairs().expect("small numbers");
    let pairs = PairDistances::new(stn).expect("small numbers");
    let order: Vec<PointId> = (0..points).map(point).collect();
    let (mut from_origin, mut to_origin) = (Vec::new(), Vec::new());
    stn.sweep_distances(point(0), &order, &mut from_origin, &mut to_origin).expect("small numbers");
    for from in 0..points {
        for to in 0..points {
            let expected = expected[from][to].unwrap_or(INFINITE);
            assert_eq!(matrix.get(point(from), point(to)), expected, "seed {seed}, {from} to {to}");
            let pair = pairs.between(point(from), point(to)).expect("small numbers");
            assert_eq!(pair, Some(expected), "seed {seed}, the pair {from} to {to}");
        }
        assert_eq!(from_origin[from], expected[0][from].unwrap_or(INFINITE), "seed {seed}, sweep to {from}");
        assert_eq!(to_origin[from], expected[from][0].unwrap_or(INFINITE), "seed {seed}, sweep from {from}");
    }
}

fn assert_cycle(stn: &Stn, edges: &EdgeList, new_edge: (usize, usize, i64), seed: u64) {
    let cycle = stn.cycle();
    let total: i64 = cycle.iter().map(|edge| edge.weight).sum();
    assert!(total < 0, "seed {seed}: a cycle of weight {total}");
    for (position, edge) in cycle.iter().enumerate() {
        assert_eq!(edge.to, cycle[(position + 1) % cycle.len()].from, "seed {seed}: not a cycle");
        let known = edges.get(edge.tag as usize).copied().unwrap_or(new_edge);
        assert_eq!(
            (edge.from, edge.to, edge.weight),
            (point(known.0), point(known.1), known.2),
            "seed {seed}"
        );
    }
    let mut starts: Vec<PointId> = cycle.iter().map(|edge| edge.from).collect();
    starts.sort_unstable();
    starts.dedup();
    assert_eq!(
        starts.len(),
        cycle.len(),
        "seed {seed}: a cycle visits each point once, so that it is minimal"
    );
}

#[test]
fn insertions_and_undos_agree_with_floyd_warshall() {
    for seed in 0..400 {
        let mut random = Random(seed);
        let points = 2 + random.below(9);
        let mut stn = Stn::new(points);
        if seed % 2 == 0 {
            // Recognizing contradictions early must not change answers.
            stn.set_origin(point(0));
        }
        let mut edges: EdgeList = Vec::new();
        let mut marks = Vec::new();
        for _ in 0..40 {
            match random.below(8) {
                0 => marks.push((stn.checkpoint(), edges.len())),
                1 => {
                    if let Some((checkpoint, len)) = marks.pop() {
                        stn.rollback(checkpoint);
                        edges.truncate(len);
                        assert_distances(&mut stn, points, &edges, seed);
                    }
                }
                _ => {
                    let edge = (random.below(points), random.below(points), random.between(-8, 20));
                    edges.push(edge);
                    let expected = floyd_warshall(points, &edges).is_some();
                    edges.pop();
                    let tag = edges.len() as u32;
                    let admitted = stn.admits(point(edge.0), point(edge.1), edge.2, tag);
                    assert_eq!(admitted.is_ok(), expected, "seed {seed}");
                    match stn.insert(point(edge.0), point(edge.1), edge.2, tag) {
                        Ok(()) => {
                            assert!(expected, "seed {seed}: accepted a contradiction");
                            edges.push(edge);
                        }
                        Err(Inconsistency::NegativeCycle) => {
                            assert!(!expected, "seed {seed}: refused a consistent edge");
                            assert_cycle(&stn, &edges, edge, seed);
                        }
                        Err(Inconsistency::Overflow(_)) => panic!("seed {seed}: overflow of small numbers"),
                    }
                    let schedule = stn.schedule();
                    let holds =
                        edges.iter().all(|&(from, to, weight)| schedule[to] - schedule[from] <= weight);
                    assert!(holds, "seed {seed}: the schedule breaks an edge");
                }
            }
        }
        assert_distances(&mut stn, points, &edges, seed);
    }
}

#[test]
fn several_edges_are_admitted_only_together_and_move_nothing_where_they_are_not() {
    let mut outcomes = [0, 0];
    for seed in 0..400 {
        let (mut stn, points) = consistent_network(seed);
        let mut random = Random(seed ^ 0xadd);
        let mut edges: EdgeList = (0..stn.num_edges())
            .filter_map(|position| stn.edge(position))
            .map(|edge| (edge.from.index(), edge.to.index(), edge.weight))
            .collect();
        let before = stn.schedule().to_vec();
        let new: EdgeList =
            (0..3).map(|_| (random.below(points), random.below(points), random.between(-6, 12))).collect();
        let links: Vec<_> = new.iter().map(|&(from, to, weight)| (point(from), point(to), weight)).collect();
        let admitted = stn.admits_all(&links, 0).is_ok();
        let num_before = edges.len();
        edges.extend(&new);
        assert_eq!(admitted, floyd_warshall(points, &edges).is_some(), "seed {seed}");
        outcomes[usize::from(admitted)] += 1;
        assert_eq!(stn.num_edges(), num_before, "seed {seed}");
        let keeps = |schedule: &[i64], edges: &EdgeList| {
            edges.iter().all(|&(from, to, weight)| schedule[to] - schedule[from] <= weight)
        };
        if admitted {
            assert!(keeps(stn.schedule(), &edges), "seed {seed}: the schedule breaks an edge");
        } else {
            assert_eq!(stn.schedule(), before, "seed {seed}");
        }
    }
    assert!(outcomes.iter().all(|&count| count > 40), "{outcomes:?}");
}

#[test]
fn tightened_distances_are_those_found_anew() {
    let mut num_shortened = 0;
    for seed in 0..400 {
        let (mut stn, points) = consistent_network(seed);
        let mut random = Random(seed ^ 0x7197);
        let order: Vec<PointId> = (0..points).map(point).collect();
        let (mut from_origin, mut to_origin) = (Vec::new(), Vec::new());
        stn.sweep_distances(point(0), &order, &mut from_origin, &mut to_origin).expect("small numbers");
        let before = (from_origin.clone(), to_origin.clone());
        let first_edge = stn.num_edges();
        for _ in 0..6 {
            let (from, to) = (point(random.below(points)), point(random.below(points)));
            // Those that contradict are not inserted.
            let _ = stn.insert(from, to, random.between(-6, 12), 0);
        }
        stn.tighten_distances(first_edge, &order, &mut from_origin, &mut to_origin).expect("small numbers");
        let (mut from_anew, mut to_anew) = (Vec::new(), Vec::new());
        stn.distances_from(point(0), &mut from_anew).expect("small numbers");
        stn.distances_to(point(0), &mut to_anew).expect("small numbers");
        assert_eq!((&from_origin, &to_origin), (&from_anew, &to_anew), "seed {seed}");
        num_shortened += usize::from((from_origin, to_origin) != before);
    }
    assert!(num_shortened > 100, "only {num_shortened} networks had distances to shorten");
}

#[test]
fn settling_many_edges_at_once_agrees_with_floyd_warshall() {
    let mut num_inconsistent = 0;
    for seed in 1000..1600 {
        let mut random = Random(seed);
        let points = 2 + random.below(12);
        let mut stn = Stn::new(points);
        let mut edges: EdgeList = Vec::new();
        for tag in 0..=random.below(3 * points) {
            let edge = (random.below(points), random.below(points), random.between(-4, 16));
            stn.push(point(edge.0), point(edge.1), edge.2, tag as u32);
            edges.push(edge);
        }
        let mut order: Vec<PointId> = (0..points).map(point).collect();
        for position in (1..points).rev() {
            order.swap(position, random.below(position + 1));
        }
        let settled = stn.settle(&order);
        assert_eq!(settled.is_ok(), floyd_warshall(points, &edges).is_some(), "seed {seed}");
        if settled.is_ok() {
            assert_distances(&mut stn, points, &edges, seed);
        } else {
            num_inconsistent += 1;
            assert_cycle(&stn, &edges, (0, 0, 0), seed);
        }
    }
    assert!((50..550).contains(&num_inconsistent), "both outcomes must be tried: {num_inconsistent}");
}

#[test]
fn a_time_that_does_not_fit_is_reported_and_nothing_changes() {
    let mut stn = Stn::new(3);
    stn.insert(point(0), point(1), -i64::MAX / 2, 0).expect("fits");
    let before = stn.schedule().to_vec();
    let far = stn.insert(point(1), point(2), -i64::MAX / 2 - 10, 1);
    assert_eq!(far, Err(Inconsistency::Overflow(Overflow { point: point(0) })));
    let far = stn.constrain(point(1), point(2), i64::MIN, None, 2);
    assert_eq!(far, Err(Inconsistency::Overflow(Overflow { point: point(2) })));
    assert_eq!((stn.num_edges(), stn.schedule()), (1, before.as_slice()));
    stn.insert(point(1), point(2), -5, 3).expect("fits");
}

/// A consistent random network, its edges, and the number of its points.
fn consistent_network(seed: u64) -> (Stn, usize) {
    let mut random = Random(seed);
    let points = 3 + random.below(8);
    let mut stn = Stn::new(points);
    // Every point is after the origin and within a horizon, as in a plan.
    for other in 1..points {
        stn.constrain(point(0), point(other), 0, Some(200), 0).expect("consistent");
    }
    for _ in 0..3 * points {
        let (from, to) = (random.below(points), random.below(points));
        let lower = random.between(0, 20);
        let upper = lower + if random.below(3) == 0 { 0 } else { random.between(0, 15) };
        // What contradicts is left out.
        let _ = stn.constrain(point(from), point(to), lower, Some(upper), 0);
    }
    (stn, points)
}

#[test]
fn random_dispatches_of_the_dispatchable_form_never_dead_end() {
    for seed in 5000..5400 {
        let (mut stn, points) = consistent_network(seed);
        let distances = stn.all_pairs().expect("small numbers");
        let all: Vec<PointId> = (0..points).map(point).collect();
        let form = dispatchable(&distances, &all);
        for round in 0..5 {
            let mut random = Random(seed * 31 + round);
            let times = dispatch(&form, &distances, points, &mut random)
                .unwrap_or_else(|| panic!("seed {seed}, round {round}: dead end"));
            for from in 0..points {
                for to in 0..points {
                    let bound = distances.get(point(from), point(to));
                    let kept = bound == INFINITE || times[to] - times[from] <= bound;
                    assert!(kept, "seed {seed}, round {round}: {from} to {to} broken");
                }
            }
        }
    }
}

/// Executes the form with random times, propagating to direct neighbors only (SPEC 6.2). `None` at a dead end.
fn dispatch(
    form: &stn::Dispatchable,
    distances: &stn::DistanceMatrix,
    points: usize,
    random: &mut Random,
) -> Option<Vec<i64>> {
    let origin = point(0);
    let mut windows: Vec<(i64, i64)> = (0..points)
        .map(|other| (-distances.get(point(other), origin), distances.get(origin, point(other))))
        .collect();
    let mut times: Vec<Option<i64>> = vec![None; points];
    let mut waiting: Vec<PointId> = form.components.iter().map(|component| component.leader).collect();
    let mut now = i64::MIN;
    while !waiting.is_empty() {
        let is_enabled = |leader: &PointId| {
            let mut edges = form.edges.iter().filter(|edge| edge.from == *leader && edge.weight < 0);
            edges.all(|edge| times[edge.to.index()].is_some())
        };
        let enabled: Vec<PointId> = waiting.iter().copied().filter(is_enabled).collect();
        let deadline = waiting.iter().map(|leader| windows[leader.index()].1).min()?;
        let ready: Vec<PointId> =
            enabled.into_iter().filter(|leader| windows[leader.index()].0.max(now) <= deadline).collect();
        if ready.is_empty() {
            return None;
        }
        let leader = ready[random.below(ready.len())];
        let (earliest, latest) = windows[leader.index()];
        let (least, greatest) = (earliest.max(now), latest.min(deadline));
        if least > greatest {
            return None;
        }
        let time = random.between(least, greatest);
        now = time;
        times[leader.index()] = Some(time);
        waiting.retain(|&other| other != leader);
        for edge in &form.edges {
            if edge.from == leader {
                let window = &mut windows[edge.to.index()];
                window.1 = window.1.min(time + edge.weight);
            }
            if edge.to == leader {
                let window = &mut windows[edge.from.index()];
                window.0 = window.0.max(time - edge.weight);
            }
        }
    }
    let mut all = vec![0; points];
    for component in &form.components {
        for &(member, offset) in &component.members {
            all[member.index()] = times[component.leader.index()]? + offset;
        }
    }
    Some(all)
}

#[test]
fn the_dispatchable_form_keeps_all_distances() {
    for seed in 7000..7200 {
        let (mut stn, points) = consistent_network(seed);
        let distances = stn.all_pairs().expect("small numbers");
        let all: Vec<PointId> = (0..points).map(point).collect();
        let form = dispatchable(&distances, &all);
        let mut pruned = Stn::new(points);
        for edge in &form.edges {
            pruned.insert(edge.from, edge.to, edge.weight, 0).expect("consistent");
        }
        for component in rigid_components(&distances, &all) {
            for &(member, offset) in &component.members {
                pruned.constrain(component.leader, member, offset, Some(offset), 0).expect("consistent");
            }
        }
        assert_eq!(pruned.all_pairs().expect("small numbers"), distances, "seed {seed}");
    }
}

#[test]
fn windows_after_execution_are_those_of_the_network_with_the_observations() {
    let mut stn = Stn::new(3);
    stn.constrain(point(0), point(1), 10, Some(20), 1).expect("consistent");
    stn.constrain(point(1), point(2), 5, Some(9), 2).expect("consistent");
    let execution =
        Execution { origin: point(0), executed: &[(point(1), 12)], pending: &[point(2)], now: 18 };
    let Ok(ExecutionWindows::Consistent(windows)) = execution_windows(&mut stn, execution, 9) else {
        panic!("consistent")
    };
    assert_eq!((windows[2].earliest, windows[2].latest), (Some(18), Some(21)));
    let late = Execution { now: 22, ..execution };
    let Ok(ExecutionWindows::Violated(mut tags)) = execution_windows(&mut stn, late, 9) else {
        panic!("violated")
    };
    tags.sort_unstable();
    assert_eq!(tags, [2, 9, 9], "the upper bound of the second arc, and both observations");
    assert_eq!(stn.num_edges(), 4, "observations are taken back");
}

#[test]
fn edges_withdrawn_out_of_turn_leave_the_others_as_they_are() {
    for seed in 0..200 {
        let mut random = Random(seed ^ 0x5717);
        let points = 2 + random.below(7);
        let mut stn = Stn::new(points);
        // What stands, by position.
        let mut standing: Vec<Option<(usize, usize, i64)>> = Vec::new();
        for _ in 0..60 {
            match random.below(6) {
                0 if !standing.is_empty() => {
                    let position = random.below(standing.len());
                    stn.withdraw(position);
                    standing[position] = None;
                }
                1 => {
                    let checkpoint = stn.checkpoint();
                    let length = standing.len();
                    for _ in 0..random.below(4) {
                        let (from, to) = (random.below(points), random.below(points));
                        let weight = random.between(-2, 9);
                        if stn.insert(point(from), point(to), weight, 0).is_ok() {
                            standing.push(Some((from, to, weight)));
                        }
                    }
                    // Withdrawing what is below the checkpoint outlasts going back to it.
                    if !standing.is_empty() {
                        let position = random.below(standing.len());
                        stn.withdraw(position);
                        standing[position] = None;
                    }
                    stn.rollback(checkpoint);
                    standing.truncate(length);
                }
                _ => {
                    let (from, to) = (random.below(points), random.below(points));
                    let weight = random.between(-2, 9);
                    if stn.insert(point(from), point(to), weight, 0).is_ok() {
                        standing.push(Some((from, to, weight)));
                    }
                }
            }
            assert_eq!(stn.num_edges(), standing.len(), "seed {seed}");
            let edges: EdgeList = standing.iter().flatten().copied().collect();
            assert_distances(&mut stn, points, &edges, seed);
        }
    }
}
