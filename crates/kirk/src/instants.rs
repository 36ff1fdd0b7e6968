//! The order of events within one instant (SPEC 10.4): a topological order of what must happen before what.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use tpn::NodeId;
use typed_index_collections::TiVec;

/// Where an event comes among those of its instant if nothing else decides: what gives something back comes first, and
/// what takes something last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Turn {
    Gives,
    #[default]
    Neither,
    Takes,
}

/// That one event happens before another, and what that rests on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Before<Reason> {
    pub(crate) first: NodeId,
    pub(crate) then: NodeId,
    pub(crate) reason: Reason,
}

/// The position of each event in an order by time, and within an instant in agreement with `before`. Events without a time
/// have no meaningful position.
///
/// # Errors
///
/// What a circle rests on, if there is one.
pub(crate) fn order<Reason: Copy>(
    times: &TiVec<NodeId, Option<i64>>,
    before: &[Before<Reason>],
    turn: &TiVec<NodeId, Turn>,
) -> Result<TiVec<NodeId, u32>, Vec<Reason>> {
    let mut next: TiVec<NodeId, Vec<usize>> = vec![Vec::new(); times.len()].into();
    let mut waits_for: TiVec<NodeId, u32> = vec![0; times.len()].into();
    for (id, edge) in before.iter().enumerate() {
        let is_at_one_time = times[edge.first].is_some() && times[edge.first] == times[edge.then];
        if is_at_one_time && edge.first != edge.then {
            next[edge.first].push(id);
            waits_for[edge.then] += 1;
        }
    }
    let mut ready = BinaryHeap::new();
    for (node, time) in times.iter_enumerated() {
        if let Some(time) = time
            && waits_for[node] == 0
        {
            ready.push(Reverse((*time, turn[node], node)));
        }
    }
    let mut positions: TiVec<NodeId, u32> = vec![0; times.len()].into();
    let mut position = 0;
    while let Some(Reverse((time, _, node))) = ready.pop() {
        positions[node] = position;
        position += 1;
        for &id in &next[node] {
            let then = before[id].then;
            waits_for[then] -= 1;
            if waits_for[then] == 0 {
                ready.push(Reverse((time, turn[then], then)));
            }
        }
    }
    match waits_for.iter_enumerated().find(|&(_, &count)| count > 0) {
        None => Ok(positions),
        Some((node, _)) => Err(circle(node, before, &next, &waits_for)),
    }
}

/// Returns what a circle rests on: from any event that waits, back along those that it waits for.
fn circle<Reason: Copy>(
    node: NodeId,
    before: &[Before<Reason>],
    next: &TiVec<NodeId, Vec<usize>>,
    waits_for: &TiVec<NodeId, u32>,
) -> Vec<Reason> {
    let mut came_by: TiVec<NodeId, Option<usize>> = vec![None; next.len()].into();
    for edges in next {
        for &id in edges {
            if waits_for[before[id].first] > 0 && waits_for[before[id].then] > 0 {
                came_by[before[id].then] = Some(id);
            }
        }
    }
    let mut path: Vec<(NodeId, usize)> = Vec::new();
    let mut at = node;
    while let Some(id) = came_by[at] {
        if let Some(begin) = path.iter().position(|&(passed, _)| passed == at) {
            return path[begin..].iter().map(|&(_, id)| before[id].reason).collect();
        }
        path.push((at, id));
        at = before[id].first;
    }
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn before(first: u32, then: u32) -> Before<(u32, u32)> {
        Before { first: NodeId(first), then: NodeId(then), reason: (first, then) }
    }

    #[test]
    fn events_of_an_instant_are_in_topological_order_and_those_that_give_come_first() {
        let times: TiVec<NodeId, Option<i64>> = vec![Some(5), Some(5), Some(0), Some(5), None].into();
        let turn: TiVec<NodeId, Turn> =
            vec![Turn::Takes, Turn::Gives, Turn::Neither, Turn::Neither, Turn::Gives].into();
        let positions = order(&times, &[before(3, 1)], &turn).expect("no circle");
        assert_eq!([2, 3, 1, 0].map(|node| positions[NodeId(node)]), [0, 1, 2, 3]);
    }

    #[test]
    fn a_circle_is_told_without_what_leads_to_it() {
        let times: TiVec<NodeId, Option<i64>> = vec![Some(1); 5].into();
        let turn = vec![Turn::Neither; 5].into();
        let edges = [before(0, 1), before(1, 2), before(2, 3), before(3, 1), before(3, 4)];
        let mut circle = order(&times, &edges, &turn).expect_err("1, 2 and 3");
        circle.sort_unstable();
        assert_eq!(circle, [(1, 2), (2, 3), (3, 1)]);
        // At different times nothing waits for what comes later.
        let times: TiVec<NodeId, Option<i64>> = vec![Some(1), Some(1), Some(2), Some(1), Some(1)].into();
        assert!(order(&times, &edges, &vec![Turn::Neither; 5].into()).is_ok());
    }
}
