//! The heaviest set of which no two are in order: what a resource is used at most, over all schedules (SPEC 11).
//!
//! By the weighted form of Dilworth's theorem it weighs as much as all together, less the most that can be passed on
//! from one to a later one (a maximum flow; augmented along shortest paths, Edmonds and Karp 1972).

use std::collections::VecDeque;

/// The heaviest set.
pub(crate) struct Antichain {
    pub(crate) weight: i64,
    /// Positions, in order.
    pub(crate) members: Vec<usize>,
}

/// The heaviest set. `is_before` is transitive; what is before each other (at one instant) is in order, too.
pub(crate) fn heaviest_antichain(weights: &[i64], is_before: &[Vec<bool>]) -> Antichain {
    let count = weights.len();
    let follows = |first: usize, then: usize| {
        // Of two at one instant the first in the list comes first.
        is_before[first][then] && (first < then || !is_before[then][first])
    };
    // What each can still give to later ones, and take from earlier ones.
    let (mut gives, mut takes) = (weights.to_vec(), weights.to_vec());
    let mut passed = vec![vec![0_i64; count]; count];
    // Greedily first: chains need no more.
    for then in 0..count {
        for first in 0..count {
            if takes[then] > 0 && gives[first] > 0 && follows(first, then) {
                pass(&mut gives, &mut takes, &mut passed, first, then);
            }
        }
    }
    let cut = loop {
        match augmenting_path(&gives, &takes, &passed, &follows) {
            Ok(path) => augment(&path, &mut gives, &mut takes, &mut passed),
            Err(cut) => break cut,
        }
    };
    // What can still be passed on from is in the set, unless something can be passed on to it.
    let members = (0..count).filter(|&one| weights[one] > 0 && cut.gives[one] && !cut.takes[one]).collect();
    Antichain { weight: weights.iter().sum::<i64>() - passed.iter().flatten().sum::<i64>(), members }
}

/// What is reached from givers that have something left, where nothing that still needs something is.
struct Cut {
    gives: Vec<bool>,
    takes: Vec<bool>,
}

fn pass(gives: &mut [i64], takes: &mut [i64], passed: &mut [Vec<i64>], first: usize, then: usize) {
    let amount = gives[first].min(takes[then]);
    gives[first] -= amount;
    takes[then] -= amount;
    passed[first][then] += amount;
}

/// Givers and takers in turn, from a giver that has something left to a taker that needs something.
fn augmenting_path(
    gives: &[i64],
    takes: &[i64],
    passed: &[Vec<i64>],
    follows: &dyn Fn(usize, usize) -> bool,
) -> Result<Vec<usize>, Cut> {
    let count = gives.len();
    let mut giver_of: Vec<Option<usize>> = vec![None; count];
    let mut taker_of: Vec<Option<usize>> = vec![None; count];
    let mut is_seen = vec![false; count];
    let mut open: VecDeque<usize> = VecDeque::new();
    for giver in (0..count).filter(|&giver| gives[giver] > 0) {
        is_seen[giver] = true;
        open.push_back(giver);
    }
    while let Some(giver) = open.pop_front() {
        for taker in 0..count {
            if giver_of[taker].is_some() || !follows(giver, taker) {
                continue;
            }
            giver_of[taker] = Some(giver);
            if takes[taker] > 0 {
                let mut path = vec![taker];
                let mut at = taker;
                while let Some(from) = giver_of[at] {
                    path.push(from);
                    let Some(before) = taker_of[from] else { break };
                    path.push(before);
                    at = before;
                }
                path.reverse();
                return Ok(path);
            }
            for other in 0..count {
                if passed[other][taker] > 0 && !is_seen[other] {
                    is_seen[other] = true;
                    taker_of[other] = Some(taker);
                    open.push_back(other);
                }
            }
        }
    }
    Err(Cut { gives: is_seen, takes: giver_of.iter().map(Option::is_some).collect() })
}

/// Passes as much as possible along giver, taker, giver, …, taker: from each giver to the taker behind it, and back from
/// that taker to the next giver.
fn augment(path: &[usize], gives: &mut [i64], takes: &mut [i64], passed: &mut [Vec<i64>]) {
    let (Some(&first), Some(&last)) = (path.first(), path.last()) else { return };
    let mut amount = gives[first].min(takes[last]);
    for pair in path[1..].chunks_exact(2) {
        if let &[taker, giver] = pair {
            amount = amount.min(passed[giver][taker]);
        }
    }
    gives[first] -= amount;
    takes[last] -= amount;
    for pair in path.chunks_exact(2) {
        if let &[giver, taker] = pair {
            passed[giver][taker] += amount;
        }
    }
    for pair in path[1..].chunks_exact(2) {
        if let &[taker, giver] = pair {
            passed[giver][taker] -= amount;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn antichain(weights: &[i64], order: &[(usize, usize)]) -> i64 {
        let mut is_before = vec![vec![false; weights.len()]; weights.len()];
        for &(first, then) in order {
            is_before[first][then] = true;
        }
        close(&mut is_before);
        heaviest_antichain(weights, &is_before).weight
    }

    /// What comes before what comes before something comes before that.
    fn close(is_before: &mut [Vec<bool>]) {
        for middle in 0..is_before.len() {
            let after = is_before[middle].clone();
            for row in is_before.iter_mut().filter(|row| row[middle]) {
                for (then, &is_after) in row.iter_mut().zip(&after) {
                    *then |= is_after;
                }
            }
        }
    }

    #[test]
    fn what_is_in_order_does_not_add_up() {
        assert_eq!(antichain(&[], &[]), 0);
        assert_eq!(antichain(&[3, 2, 2], &[]), 7);
        assert_eq!(antichain(&[3, 2, 2], &[(0, 1), (1, 2)]), 3);
        assert_eq!(antichain(&[3, 2, 2], &[(1, 2)]), 5);
        // 0 before 2 and 3, 1 before 3: {1, 2} or {0, 1} or {2, 3}.
        assert_eq!(antichain(&[4, 3, 2, 5], &[(0, 2), (0, 3), (1, 3)]), 7);
    }

    #[test]
    fn the_heaviest_of_all_subsets_is_found() {
        let mut seed = 7_u64;
        let mut random = |limit: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % limit
        };
        for _ in 0..300 {
            let count = 1 + random(7) as usize;
            let weights: Vec<i64> = (0..count).map(|_| random(5) as i64).collect();
            let mut is_before = vec![vec![false; count]; count];
            for (first, row) in is_before.iter_mut().enumerate() {
                for is_after in &mut row[first + 1..] {
                    *is_after = random(3) == 0;
                }
            }
            close(&mut is_before);
            let best = (0..1_usize << count)
                .filter(|set| {
                    let has = |member: usize| set >> member & 1 == 1;
                    (0..count)
                        .all(|one| (0..count).all(|other| !(has(one) && has(other) && is_before[one][other])))
                })
                .map(|set| {
                    (0..count).filter(|member| set >> member & 1 == 1).map(|member| weights[member]).sum()
                })
                .max();
            let Antichain { weight, members } = heaviest_antichain(&weights, &is_before);
            assert_eq!(Some(weight), best);
            assert_eq!(members.iter().map(|&member| weights[member]).sum::<i64>(), weight);
            assert!(members.iter().all(|&one| members.iter().all(|&other| !is_before[one][other])));
        }
    }
}
