//! In which order the events of a plan happen that happen at one time (SPEC 10.4).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use stn::Overflow;
use tpn::{Network, Plan};

use crate::plan_network::PlanNetwork;

/// By point its rank: of two events that happen at one time the one of lower rank happens first. Whatever happens before
/// another event in the plan has a lower rank; of the others the one that is first in the text, as far as that goes.
///
/// An event that precedes another one, but not always at the same time, is truly before it in some schedule that is near the
/// earliest one: there each constraint without slack gets a little of it, but for those among events at fixed distances. The
/// ranks are the order of that schedule. O(n · log n) after the earliest times are known.
pub(crate) fn ranks(network: &Network, plan: &Plan, made: &PlanNetwork) -> Result<Vec<u32>, Overflow> {
    let count = made.stn.num_points();
    let windows = made.stn.clone().windows(made.origin())?;
    // Foreign networks may have events that nothing keeps after the start.
    let earliest: Option<Vec<i64>> = windows.iter().map(|window| window.earliest).collect();
    let times = earliest.unwrap_or_else(|| made.stn.schedule().to_vec());
    let edges = (0..made.stn.num_edges()).filter_map(|position| made.stn.edge(position));
    let tight: Vec<[usize; 2]> = edges
        .filter(|edge| times[edge.from.index()].checked_add(edge.weight) == Some(times[edge.to.index()]))
        .map(|edge| [edge.from.index(), edge.to.index()])
        .collect();
    let rigid = components(count, &tight);
    // An edge gets slack where its end comes earlier.
    let earlier =
        tight.iter().map(|&[from, to]| [rigid[to], rigid[from]]).filter(|[one, other]| one != other);
    let slack = places(count, &earlier.collect::<Vec<_>>());
    let pairs = plan.instant_order(network).into_iter();
    let pairs =
        pairs.filter_map(|[earlier, later]| Some([made.point(earlier)?.index(), made.point(later)?.index()]));
    let within = places(count, &pairs.collect::<Vec<_>>());
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&point| (times[point], slack[rigid[point]], within[point], point));
    let mut ranks = vec![0; count];
    (0..).zip(order).for_each(|(rank, point)| ranks[point] = rank);
    Ok(ranks)
}

/// For each point the first of those that edges join with it both ways (Kosaraju and Sharir 1981).
fn components(count: usize, edges: &[[usize; 2]]) -> Vec<usize> {
    let mut leaving = vec![Vec::new(); count];
    let mut entering = vec![Vec::new(); count];
    for &[from, to] in edges {
        leaving[from].push(to);
        entering[to].push(from);
    }
    let mut left = Vec::with_capacity(count);
    let mut is_seen = vec![false; count];
    for root in 0..count {
        if std::mem::replace(&mut is_seen[root], true) {
            continue;
        }
        let mut path = vec![(root, 0)];
        while let Some((point, next)) = path.last_mut() {
            let Some(&to) = leaving[*point].get(*next) else {
                left.push(*point);
                path.pop();
                continue;
            };
            *next += 1;
            if !std::mem::replace(&mut is_seen[to], true) {
                path.push((to, 0));
            }
        }
    }
    let mut component = vec![None; count];
    for &root in left.iter().rev() {
        if component[root].is_some() {
            continue;
        }
        let mut members = Vec::new();
        let mut open = vec![root];
        while let Some(point) = open.pop() {
            if component[point].replace(root).is_none() {
                members.push(point);
                open.extend(entering[point].iter().filter(|&&from| component[from].is_none()));
            }
        }
        let first = members.iter().copied().min();
        for member in members {
            component[member] = first;
        }
    }
    component.into_iter().map(Option::unwrap_or_default).collect()
}

/// For each element its place in an order in which the first of each pair is before the second, and otherwise smaller
/// numbers come first (Kahn 1962). Elements on a cycle come last.
fn places(count: usize, pairs: &[[usize; 2]]) -> Vec<usize> {
    let mut later = vec![Vec::new(); count];
    let mut awaited = vec![0_usize; count];
    for &[earlier, then] in pairs {
        later[earlier].push(then);
        awaited[then] += 1;
    }
    let mut free: BinaryHeap<Reverse<usize>> =
        (0..count).filter(|&element| awaited[element] == 0).map(Reverse).collect();
    let mut places = vec![count; count];
    let mut next = 0;
    while let Some(Reverse(element)) = free.pop() {
        places[element] = next;
        next += 1;
        for &then in &later[element] {
            awaited[then] -= 1;
            if awaited[then] == 0 {
                free.push(Reverse(then));
            }
        }
    }
    places
}
