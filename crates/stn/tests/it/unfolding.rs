//! Points of random networks that happen one after the other: windows are those of all distances, and who must wait does.

use stn::{PointId, Refusal, Stn, Unfolding};

/// Splitmix64: a seeded generator that is the same everywhere.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: i64) -> i64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % bound as u64) as i64
    }
}

/// A consistent network: a chain after the start, and constraints that a random schedule keeps. `reach` says between
/// points how far apart these are: with little reach the elimination tree holds all, with much there is a core.
fn network(points: usize, constraints: usize, reach: i64, random: &mut Random) -> Stn {
    let mut stn = Stn::new(points);
    let times: Vec<i64> = (0..points as i64).map(|place| 3 * place + random.below(9)).collect();
    let time = |place: usize| if place == 0 { 0 } else { times[place] };
    for place in 1..points {
        let before = if random.below(4) == 0 { 0 } else { place - 1 };
        let apart = time(place) - time(before);
        let (least, most) = (apart.min(0).max(apart - random.below(6)), apart + random.below(6));
        stn.constrain(PointId(before as u32), PointId(place as u32), least.min(apart), Some(most), 0)
            .expect("its schedule keeps it");
    }
    for _ in 0..constraints {
        let one = random.below(points as i64);
        let other = (one + random.below(2 * reach + 1) - reach).clamp(0, points as i64 - 1);
        let slack = random.below(8);
        let apart = time(other as usize) - time(one as usize);
        stn.insert(PointId(one as u32), PointId(other as u32), apart + slack, 0)
            .expect("its schedule keeps it");
    }
    stn
}

/// All points happen, each at some time of its window, in the order of those times; returns how often one had to wait.
fn unfold(points: usize, constraints: usize, reach: i64, seed: u64) -> usize {
    let mut random = Random(seed);
    let mut stn = network(points, constraints, reach, &mut random);
    let distances = stn.all_pairs().expect("small numbers");
    let all = || (0..points as u32).map(PointId);
    let mut unfolding = Unfolding::new(&stn, PointId(0)).expect("small numbers");
    let mut times: Vec<Option<i64>> = vec![None; points];
    let mut refused = 0;
    let mut waiting: Vec<PointId> = Vec::new();
    while times.iter().any(Option::is_none) {
        // The window of each, by the distances to all that has happened.
        let mut earliest_of_all = (i64::MAX, PointId(0));
        for point in all() {
            let happened: Vec<(PointId, i64)> = if times[0].is_none() {
                vec![(PointId(0), 0)]
            } else {
                all().filter_map(|other| Some((other, times[other.index()]?))).collect()
            };
            let bounded = |other: PointId, to: PointId| distances.get(other, to) != stn::INFINITE;
            let latest = happened
                .iter()
                .filter(|it| bounded(it.0, point))
                .map(|it| it.1 + distances.get(it.0, point))
                .min();
            let earliest = happened
                .iter()
                .filter(|it| bounded(point, it.0))
                .map(|it| it.1 - distances.get(point, it.0))
                .max();
            let earliest = earliest.unwrap_or(0);
            assert_eq!(unfolding.window(point), (earliest, latest), "seed {seed}: {point:?} after {times:?}");
            if times[point.index()].is_none() && !waiting.contains(&point) {
                earliest_of_all = earliest_of_all.min((earliest, point));
            }
        }
        let (earliest, point) = earliest_of_all;
        let latest = unfolding.window(point).1.unwrap_or(earliest + 4);
        let time = earliest + random.below(3.min(latest - earliest) + 1);
        let must_wait = all().filter(|other| {
            times[other.index()].is_none() && *other != point && distances.get(point, *other) < 0
        });
        let must_wait: Vec<PointId> = must_wait.collect();
        match unfolding.happen(point, time) {
            Ok(()) => {
                assert!(must_wait.is_empty(), "seed {seed}: {point:?} must wait for {must_wait:?}");
                times[point.index()] = Some(time);
                waiting.clear();
            }
            Err(Refusal::NotYet(other)) => {
                assert!(must_wait.contains(&other), "seed {seed}: {point:?} is told to wait for {other:?}");
                refused += 1;
                waiting.push(point);
            }
            Err(refusal) => panic!("seed {seed}: {refusal:?}"),
        }
    }
    refused
}

#[test]
fn windows_are_exact_in_narrow_networks() {
    (0..60).for_each(|seed| {
        unfold(14, 6, 3, seed);
    });
    (0..6).for_each(|seed| {
        unfold(60, 20, 2, seed);
    });
}

#[test]
fn windows_are_exact_where_there_is_a_core() {
    // Every point has more neighbors than are eliminated.
    (0..4).for_each(|seed| {
        unfold(60, 2400, 60, seed);
    });
}

#[test]
fn who_must_come_later_is_told_for_whom_to_wait() {
    let mut stn = Stn::new(4);
    let [start, one, join, other] = [0, 1, 2, 3].map(PointId);
    // The join comes at least 10 after the one, and at most 5 after the other: which comes at least 5 after the one.
    stn.constrain(start, one, 0, Some(20), 0).expect("consistent");
    stn.constrain(one, join, 10, None, 0).expect("consistent");
    stn.constrain(other, join, 0, Some(5), 0).expect("consistent");
    let mut unfolding = Unfolding::new(&stn, start).expect("small numbers");
    unfolding.happen(start, 0).expect("it is first");
    assert_eq!(unfolding.window(other), (5, None));
    assert_eq!(unfolding.happen(other, 7), Err(Refusal::NotYet(one)));
    assert_eq!(unfolding.window(join), (10, None), "what was refused has changed nothing");
    unfolding.happen(one, 8).expect("nothing comes before it");
    assert_eq!(unfolding.window(other), (13, None));
    unfolding.happen(other, 13).expect("it has waited");
    assert_eq!(unfolding.window(join), (18, Some(18)));
}

#[test]
fn who_is_expected_is_late_when_its_latest_time_comes_before_that() {
    let points = 200;
    let mut stn = Stn::new(points);
    for place in 1..points as u32 {
        stn.constrain(PointId(place - 1), PointId(place), 1, Some(3), 0).expect("consistent");
    }
    let mut unfolding = Unfolding::new(&stn, PointId(0)).expect("small numbers");
    let last = PointId(points as u32 - 1);
    unfolding.happen(PointId(0), 0).expect("it is first");
    unfolding.expect(last, 590);
    for place in 1..points as u32 - 1 {
        let (earliest, _) = unfolding.window(PointId(place));
        unfolding.happen(PointId(place), earliest).expect("within its window");
        let latest = unfolding.window(last).1.expect("it is bounded");
        // 3 for each step is 597; each that takes 1 takes 2 of it.
        assert_eq!(latest, 597 - 2 * i64::from(place));
        let late = unfolding.take_late();
        assert!(late.iter().all(|&point| point == last && place >= 4), "after {place}");
        assert!(place != 4 || !late.is_empty(), "its latest time is 589");
    }
}

#[test]
fn nothing_happens_that_would_have_to_come_no_earlier_than_what_is_expected_later() {
    // Both end together, and both may take from 1 to 9.
    let mut stn = Stn::new(3);
    let [start, one, other] = [0, 1, 2].map(PointId);
    stn.constrain(start, one, 1, Some(9), 0).expect("consistent");
    stn.constrain(start, other, 1, Some(9), 0).expect("consistent");
    stn.constrain(one, other, 0, Some(0), 0).expect("consistent");
    let mut unfolding = Unfolding::new(&stn, start).expect("small numbers");
    unfolding.happen(start, 0).expect("it is first");
    unfolding.expect(one, 6);
    assert_eq!(unfolding.happen(other, 1), Err(Refusal::NotYet(one)));
    assert!(unfolding.take_late().is_empty());
    assert_eq!(unfolding.window(other), (1, Some(9)));
    unfolding.happen(one, 6).expect("as expected");
    assert_eq!(unfolding.window(other), (6, Some(6)));
    unfolding.happen(other, 6).expect("nobody is waited for");
}
