//! Whether constraints can be kept whatever durations the environment chooses: dynamic controllability with instantaneous
//! reaction by Morris's characterization (2006), strong controllability by its definition (Vidal and Fargier 1999).
//!
//! A duration that the environment chooses is told by three kinds of edges: its bounds as ordinary ones; the upper
//! case, from its end to its beginning, which counts until the end is seen; and the lower case, which says that the end
//! may come at once after the shortest time. What must happen before the end is seen must happen that soon after the
//! beginning: a path from the end to a point that comes before it, with the lower case in front, is a constraint of its
//! own. There is a strategy exactly if, with all of these, the longest durations leave no negative cycle.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use crate::distance::{Distances, Edge};

/// A duration that the environment chooses. No two end at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) start: u32,
    pub(crate) end: u32,
    pub(crate) lower: i128,
    pub(crate) upper: i128,
}

/// What a contradiction depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    /// That the environment chooses this duration, by its place.
    Link(usize),
    /// The constraint of an edge with this reason.
    Reason(u32),
}

/// A constraint `to − from ≤ weight`, which holds always, or until the end of a link is seen.
#[derive(Clone, Debug)]
struct Step {
    from: u32,
    to: u32,
    weight: i128,
    awaited: Option<usize>,
    origin: Origin,
}

#[derive(Clone, Debug)]
enum Origin {
    Given(u32),
    /// A bound of a link.
    Range(usize),
    /// What follows a link's shortest duration: the steps of a path from its end.
    Shortest(usize, Vec<u32>),
}

/// Returns why no strategy keeps all of `edges`, if none does. `points` is the number of points.
///
/// Constraints that follow from constraints that follow from shortest durations are found in as many rounds as they are
/// deep, at most one for each link; in each, only those links are looked at again from whose ends something new can be
/// reached: O(links² · edges · log points + links · points · edges) at worst.
pub(crate) fn refute_dynamic(points: usize, edges: &[Edge], links: &[Link]) -> Option<Vec<Part>> {
    let mut steps = given(edges, links);
    // The tightest step of each kind that was found, by its place.
    let mut known: BTreeMap<(u32, u32, Option<usize>), u32> = BTreeMap::new();
    let mut is_tightest = vec![true; steps.len()];
    let mut looked_beyond: Vec<Vec<u32>> = vec![Vec::new(); links.len()];
    let mut open: Vec<usize> = (0..links.len()).collect();
    for round in 0..=links.len() {
        let longest = (0..).zip(&steps).zip(&is_tightest).filter(|(_, is_tightest)| **is_tightest);
        let longest = longest.map(|((reason, step), _): ((u32, &Step), _)| Edge {
            from: step.from,
            to: step.to,
            weight: step.weight,
            reason,
        });
        let graph = match Distances::new(points, longest.collect()) {
            Ok(graph) => graph,
            Err(cycle) => return Some(unfold(&steps, cycle.iter().map(|edge| edge.reason).collect())),
        };
        if round == links.len() {
            break;
        }
        let mut found = Vec::new();
        for &link in &open {
            looked_beyond[link] = before_the_end(link, links, &graph, &steps, &mut found);
        }
        let (mut has_new, before) = (vec![false; points], steps.len());
        for step in found {
            let kind = (step.from, step.to, step.awaited);
            if let Some(&tightest) = known.get(&kind) {
                if steps[tightest as usize].weight <= step.weight {
                    continue;
                }
                is_tightest[tightest as usize] = false;
            }
            known.insert(kind, steps.len() as u32);
            has_new[step.from as usize] = true;
            is_tightest.push(true);
            steps.push(step);
        }
        let sees_new = |link: &usize| looked_beyond[*link].iter().any(|&point| has_new[point as usize]);
        open = (0..links.len()).filter(sees_new).collect();
        if steps.len() == before {
            break;
        }
    }
    None
}

fn given(edges: &[Edge], links: &[Link]) -> Vec<Step> {
    let mut steps: Vec<Step> = (edges.iter())
        .map(|edge| Step {
            from: edge.from,
            to: edge.to,
            weight: edge.weight,
            awaited: None,
            origin: Origin::Given(edge.reason),
        })
        .collect();
    for (place, link) in links.iter().enumerate() {
        let mut add = |from, to, weight, awaited| {
            steps.push(Step { from, to, weight, awaited, origin: Origin::Range(place) });
        };
        add(link.start, link.end, link.upper, None);
        add(link.end, link.start, -link.lower, None);
        add(link.end, link.start, -link.upper, Some(place));
    }
    steps
}

/// How a point is reached from a link's end.
#[derive(Clone, Copy, Debug)]
struct Reached {
    /// The distance, less the difference of the potentials.
    reduced: i128,
    /// The last step; none at the end itself.
    by: Option<u32>,
    /// Whether the way leads through a point before the end: what follows for the point follows from that one, too.
    is_implied: bool,
}

/// Returns what must happen before a link's end is seen, as constraints on its start. Points are looked at in the order
/// of distance from the end; the constraint on the start leads to one that is before it, so that from there on only
/// that is found out what follows anyway. Returns the points that were looked beyond.
fn before_the_end(
    place: usize,
    links: &[Link],
    graph: &Distances,
    steps: &[Step],
    found: &mut Vec<Step>,
) -> Vec<u32> {
    let link = &links[place];
    let potential = graph.potential();
    let mut looked_beyond = Vec::new();
    let mut is_settled = vec![false; potential.len()];
    let mut best: Vec<Option<Reached>> = vec![None; potential.len()];
    // Of two ways of one length the implied one comes first.
    let mut queue = BinaryHeap::from([Reverse((0_i128, true, link.end))]);
    best[link.end as usize] = Some(Reached { reduced: 0, by: None, is_implied: false });
    let mut num_open = 1_usize;
    while num_open > 0
        && let Some(Reverse((_, is_own, point))) = queue.pop()
    {
        num_open -= usize::from(is_own);
        let Some(Reached { reduced, is_implied, .. }) = best[point as usize] else { continue };
        if std::mem::replace(&mut is_settled[point as usize], true) {
            continue;
        }
        let distance = reduced + potential[point as usize] - potential[link.end as usize];
        let step_to = |to: u32, distance: i128, awaited: Option<usize>, last: Option<u32>| {
            let mut path: Vec<u32> = last.into_iter().collect();
            let mut at = point;
            while let Some(Reached { by: Some(by), .. }) = best[at as usize] {
                path.push(by);
                at = steps[by as usize].from;
            }
            let weight = link.lower + distance;
            // Nothing that ends is seen before its shortest time.
            let awaited = awaited.filter(|&other| weight < -links[other].lower);
            Step { from: link.start, to, weight, awaited, origin: Origin::Shortest(place, path) }
        };
        let is_before = distance < 0;
        if is_before && !is_implied {
            found.push(step_to(point, distance, None, None));
        }
        if !is_before && !is_implied {
            looked_beyond.push(point);
        }
        let mut next = Vec::new();
        for edge in graph.edges_from(point) {
            let step = &steps[edge.reason as usize];
            if is_before || is_implied {
                if step.awaited.is_some() {
                    continue;
                }
            } else {
                // After the end was observed, nothing waits for it.
                if step.awaited == Some(place) {
                    continue;
                }
                let reached = distance + step.weight;
                if let Some(other) = step.awaited.filter(|&other| reached < -links[other].lower) {
                    found.push(step_to(step.to, reached, Some(other), Some(edge.reason)));
                    continue;
                }
            }
            let through = reduced + edge.weight + potential[point as usize] - potential[step.to as usize];
            next.push((step.to, through, edge.reason));
        }
        let is_implied = is_before || is_implied;
        for (to, through, by) in next {
            let is_better = best[to as usize].is_none_or(|known| {
                through < known.reduced || (through == known.reduced && is_implied && !known.is_implied)
            });
            if is_better && !is_settled[to as usize] {
                best[to as usize] = Some(Reached { reduced: through, by: Some(by), is_implied });
                num_open += usize::from(!is_implied);
                queue.push(Reverse((through, !is_implied, to)));
            }
        }
    }
    looked_beyond
}

/// Returns what a cycle of steps depends on.
fn unfold(steps: &[Step], cycle: Vec<u32>) -> Vec<Part> {
    let mut parts = BTreeSet::new();
    let mut seen = BTreeSet::new();
    let mut open = cycle;
    while let Some(step) = open.pop() {
        if !seen.insert(step) {
            continue;
        }
        match &steps[step as usize].origin {
            Origin::Given(reason) => {
                parts.insert(Part::Reason(*reason));
            }
            Origin::Range(link) => {
                parts.insert(Part::Link(*link));
            }
            Origin::Shortest(link, path) => {
                parts.insert(Part::Link(*link));
                open.extend(path);
            }
        }
    }
    parts.into_iter().collect()
}

/// Returns why no times that are fixed beforehand keep all of `edges`, if none do: each edge must hold for the
/// durations that are worst for it.
pub(crate) fn refute_strong(points: usize, edges: &[Edge], links: &[Link]) -> Option<Vec<Part>> {
    let ending: BTreeMap<u32, usize> =
        links.iter().enumerate().map(|(place, link)| (link.end, place)).collect();
    // The links before a point, the first one of all first.
    let before = |point: u32| {
        let mut before = Vec::new();
        let mut at = point;
        while let Some(&link) = ending.get(&at) {
            before.push(link);
            at = links[link].start;
        }
        before.reverse();
        (at, before)
    };
    let mut worst = Vec::with_capacity(edges.len());
    let mut depends = Vec::with_capacity(edges.len());
    for (reason, edge) in (0..).zip(edges) {
        let ((from, before_from), (to, before_to)) = (before(edge.from), before(edge.to));
        // What both come after counts alike for both.
        let shared = before_from.iter().zip(&before_to).take_while(|(one, other)| one == other).count();
        let (before_from, before_to) = (&before_from[shared..], &before_to[shared..]);
        // (to + longest) − (from + shortest) ≤ weight.
        let longest: i128 = before_to.iter().map(|&link| links[link].upper).sum();
        let shortest: i128 = before_from.iter().map(|&link| links[link].lower).sum();
        worst.push(Edge { from, to, weight: edge.weight + shortest - longest, reason });
        let chosen = before_from.iter().chain(before_to).map(|&link| Part::Link(link));
        depends.push(chosen.chain([Part::Reason(edge.reason)]).collect::<Vec<Part>>());
    }
    let cycle = Distances::new(points, worst).err()?;
    let parts: BTreeSet<Part> = cycle.iter().flat_map(|edge| depends[edge.reason as usize].clone()).collect();
    Some(parts.into_iter().collect())
}
