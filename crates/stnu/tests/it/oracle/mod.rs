//! What the crate is checked against, written from the definitions: the game on a grid, and the pseudo-polynomial
//! reductions of Morris, Muscettola and Vidal (2001) with Morris and Muscettola's cutoff (2005). Neither shares code
//! with the crate.

use std::collections::HashMap;

use stnu::generate::Random;
use stnu::{Link, Network, PointId};

/// A small network with edges of small weights, between `points` points, with one to three links; none ends at 0.
pub fn small(seed: u64, points: usize, widest: i64) -> Network {
    let mut random = Random::new(seed);
    let mut network = Network::new(points);
    let links = 1 + random.below(3.min(points / 2));
    for _ in 0..links {
        let (activation, end) = (random.below(points) as u32, 1 + random.below(points - 1) as u32);
        let lower = random.between(0, widest);
        let upper = lower + random.between(0, widest);
        let link = Link { activation: PointId(activation), end: PointId(end), lower, upper };
        // Some are refused: then there is one fewer.
        let _ = network.add_link(link);
    }
    for _ in 0..random.below(2 * points + 2) {
        let (from, to) = (random.below(points) as u32, random.below(points) as u32);
        let weight = random.between(-widest, 2 * widest);
        network.add_edge(PointId(from), PointId(to), weight);
    }
    network
}

/// All times multiplied.
pub fn scaled(network: &Network, scale: i64) -> Network {
    let mut scaled = Network::new(network.num_points());
    for edge in network.edges() {
        scaled.add_edge(edge.from, edge.to, edge.weight * scale);
    }
    for link in network.links() {
        let link = Link { lower: link.lower * scale, upper: link.upper * scale, ..*link };
        scaled.add_link(link).expect("a link of the network");
    }
    scaled
}

const INFINITE: i64 = i64::MAX / 4;

/// Dynamic controllability by labeled all-pairs reductions.
pub fn by_reductions(network: &Network) -> bool {
    let n = network.num_points();
    let links = network.links();
    let mut ordinary = vec![vec![INFINITE; n]; n];
    for (point, row) in ordinary.iter_mut().enumerate() {
        row[point] = 0;
    }
    let lower_to = |known: &mut i64, value: i64| {
        let is_lower = value < *known;
        *known = value.min(*known);
        is_lower
    };
    for edge in network.edges() {
        lower_to(&mut ordinary[edge.from.index()][edge.to.index()], edge.weight);
    }
    // waits[i][p]: p waits for the end of link i or until that long after its activation, negated.
    let mut waits = vec![vec![INFINITE; n]; links.len()];
    for (link, waits) in links.iter().zip(&mut waits) {
        lower_to(&mut ordinary[link.activation.index()][link.end.index()], link.upper);
        lower_to(&mut ordinary[link.end.index()][link.activation.index()], -link.lower);
        waits[link.end.index()] = -link.upper;
    }
    let cutoff = n * n + n * links.len() + links.len() + 1;
    for _ in 0..cutoff {
        // With all durations at their longest there must be no negative cycle.
        let mut longest = ordinary.clone();
        for (link, waits) in links.iter().zip(&waits) {
            for (point, &wait) in waits.iter().enumerate() {
                lower_to(&mut longest[point][link.activation.index()], wait);
            }
        }
        close(&mut longest);
        if (0..n).any(|point| longest[point][point] < 0) {
            return false;
        }
        let mut changed = close(&mut ordinary);
        for (index, link) in links.iter().enumerate() {
            for from in 0..n {
                for via in 0..n {
                    let wait = waits[index][via];
                    if wait < INFINITE && ordinary[from][via] < INFINITE {
                        changed |= lower_to(&mut waits[index][from], ordinary[from][via] + wait);
                    }
                }
            }
            for (other, by) in links.iter().enumerate() {
                let wait = waits[index][by.end.index()];
                if other != index && wait < 0 {
                    changed |= lower_to(&mut waits[index][by.activation.index()], by.lower + wait);
                }
            }
            let after_end = ordinary[link.end.index()].clone();
            for (known, weight) in ordinary[link.activation.index()].iter_mut().zip(after_end) {
                if weight < 0 {
                    changed |= lower_to(known, link.lower + weight);
                }
            }
            for from in 0..n {
                let wait = waits[index][from];
                if wait < INFINITE {
                    // The wait lasts at least as long as the shortest duration.
                    let weight = wait.max(-link.lower);
                    changed |= lower_to(&mut ordinary[from][link.activation.index()], weight);
                }
            }
        }
        if !changed {
            return true;
        }
    }
    false
}

fn close(distance: &mut [Vec<i64>]) -> bool {
    let n = distance.len();
    let mut changed = false;
    for via in 0..n {
        for from in 0..n {
            for to in 0..n {
                if distance[from][via] < INFINITE && distance[via][to] < INFINITE {
                    let sum = distance[from][via] + distance[via][to];
                    if sum < distance[from][to] {
                        distance[from][to] = sum;
                        changed = true;
                    }
                }
            }
        }
    }
    changed
}

/// Dynamic controllability as a game on the integers: at each instant nature ends what it likes and the executive
/// executes what it likes, in turns, until both let time pass. Everything happens between point 0's time, 0, and
/// `horizon`; give the network edges that say so.
pub struct Game<'a> {
    network: &'a Network,
    horizon: i8,
    memo: HashMap<(Vec<i8>, i8, bool), bool>,
}

const NOT_YET: i8 = -1;

impl<'a> Game<'a> {
    /// Returns whether the executive wins.
    pub fn is_won(network: &'a Network, horizon: i8) -> bool {
        let mut game = Self { network, horizon, memo: HashMap::new() };
        let mut times = vec![NOT_YET; network.num_points()];
        times[0] = 0;
        game.may_be(&times, 0) && game.nature(times, 0, true)
    }

    /// Returns whether nothing is violated yet at `now`.
    fn may_be(&self, times: &[i8], now: i8) -> bool {
        self.network.edges().iter().all(|edge| {
            let (from, to) = (times[edge.from.index()], times[edge.to.index()]);
            match (from, to) {
                (NOT_YET, NOT_YET) => true,
                (from, NOT_YET) => i64::from(now) - i64::from(from) <= edge.weight,
                // `from` comes now or later.
                (NOT_YET, _) => true,
                (from, to) => i64::from(to) - i64::from(from) <= edge.weight,
            }
        })
    }

    /// The environment's turn at `now`. `executive_moved`: whether the executive gets another turn at this instant.
    fn nature(&mut self, times: Vec<i8>, now: i8, executive_moved: bool) -> bool {
        let key = (times, now, executive_moved);
        if let Some(&known) = self.memo.get(&key) {
            return known;
        }
        let (times, ..) = &key;
        let mut is_won = true;
        let mut must_end = false;
        for link in self.network.links() {
            let (start, end) = (times[link.activation.index()], times[link.end.index()]);
            if start == NOT_YET || end != NOT_YET {
                continue;
            }
            let elapsed = i64::from(now - start);
            if elapsed < link.lower {
                continue;
            }
            must_end |= elapsed == link.upper;
            let mut next = times.clone();
            next[link.end.index()] = now;
            if !(self.may_be(&next, now) && self.nature(next, now, true)) {
                is_won = false;
                break;
            }
        }
        if is_won && !must_end {
            is_won = if executive_moved {
                self.executive(times.clone(), now)
            } else {
                self.pass(times.clone(), now)
            };
        }
        self.memo.insert(key, is_won);
        is_won
    }

    fn executive(&mut self, times: Vec<i8>, now: i8) -> bool {
        // Points without a time may be executed, one after the other.
        for point in 0..times.len() {
            let id = PointId(point as u32);
            if times[point] != NOT_YET || self.network.link_ending_at(id).is_some() {
                continue;
            }
            let mut next = times.clone();
            next[point] = now;
            if self.may_be(&next, now) && self.nature(next, now, true) {
                return true;
            }
        }
        // It lets time pass; the environment may still act now.
        self.nature(times, now, false)
    }

    fn pass(&mut self, times: Vec<i8>, now: i8) -> bool {
        if times.iter().all(|&time| time != NOT_YET) {
            return true;
        }
        let later = now + 1;
        later <= self.horizon && self.may_be(&times, later) && self.nature(times, later, true)
    }
}

/// The network, with everything between point 0 and `horizon` after it. Ends of links are as late as they are.
pub fn within(network: &Network, horizon: i64) -> Network {
    let mut network = network.clone();
    for point in (1..network.num_points() as u32).map(PointId) {
        network.add_edge(PointId(0), point, horizon);
        network.add_edge(point, PointId(0), 0);
    }
    network
}
