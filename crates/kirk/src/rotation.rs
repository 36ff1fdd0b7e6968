//! Members of a reason that are needed, found without a search (recursive model rotation; Belov and Marques-Silva 2011).
//!
//! Where a reason without one of its bounds has a solution, that bound is needed. Moving one event of the solution, so that the
//! bound holds, may break another bound and nothing else: then the solution without that one shows that it is needed too, and
//! so on. Only events are moved that no condition and no use of a resource begins or ends at, so that bounds alone say
//! whether the solution remains one.

use std::collections::BTreeSet;

use tpn::NodeId;
use typed_index_collections::TiVec;

use crate::choices::Choices;
use crate::failure::Member;
use crate::model::{Context, Model};
use crate::trace::Constraint;

/// `to − from ≤ weight`.
#[derive(Clone, Copy, Debug)]
struct Bound {
    member: Member,
    from: NodeId,
    to: NodeId,
    weight: i64,
}

impl Bound {
    fn slack(&self, times: &TiVec<NodeId, i64>) -> i64 {
        self.weight - (times[self.to] - times[self.from])
    }

    /// Returns whether it orders two events of one instant: the `from` of the difference is the later one.
    const fn orders_an_instant(&self) -> bool {
        matches!(self.member, Member::Bound(Constraint::Lower(_))) && self.weight == 0
    }

    /// Returns whether it holds, and orders no instant in which others may have another order.
    fn surely_holds(&self, times: &TiVec<NodeId, i64>) -> bool {
        let slack = self.slack(times);
        slack > 0 || slack == 0 && !self.orders_an_instant()
    }
}

/// Returns which of `members` are needed, by a solution of them without `dropped`: those that alone keep it, or what it
/// becomes, from being one of all.
pub(crate) fn needed(
    mission: &Model,
    members: &[Member],
    dropped: &[Member],
    solution: &Choices,
) -> BTreeSet<Member> {
    let mut found = BTreeSet::new();
    let is_bound = |member: &Member| matches!(member, Member::Bound(_));
    if !dropped.iter().all(is_bound) {
        return found;
    }
    let bounds = bounds(mission, members, solution);
    let times: TiVec<NodeId, i64> = solution.times.clone().into();
    let dropped: BTreeSet<Member> = dropped.iter().copied().collect();
    let is_open = |bound: &&Bound| dropped.contains(&bound.member) && !bound.surely_holds(&times);
    let mut open_bounds = bounds.iter().filter(is_open);
    let (Some(&first), None) = (open_bounds.next(), open_bounds.next()) else { return found };
    if first.slack(&times) >= 0 {
        return found;
    }
    let is_fixed = fixed(mission, members);
    let mut at: TiVec<NodeId, Vec<usize>> = vec![Vec::new(); mission.num_nodes].into();
    for (index, bound) in bounds.iter().enumerate() {
        at[bound.from].push(index);
        at[bound.to].push(index);
    }
    found.insert(first.member);
    let mut open = vec![(first, times)];
    while let Some((broken, times)) = open.pop() {
        let missing = -broken.slack(&times);
        for (node, change) in [(broken.to, -missing), (broken.from, missing)] {
            if is_fixed[node] {
                continue;
            }
            let mut moved = times.clone();
            moved[node] += change;
            // What it comes nearer to within an instant may have to be on its other side.
            let is_neared = |bound: &Bound| if change > 0 { bound.to == node } else { bound.from == node };
            let is_kept =
                |bound: &Bound| bound.slack(&moved) >= 0 && (!is_neared(bound) || bound.surely_holds(&moved));
            let mut others = at[node].iter().map(|&index| bounds[index]).filter(|bound| !is_kept(bound));
            if let (Some(next), None) = (others.next(), others.next())
                && next.slack(&moved) < 0
                && found.insert(next.member)
            {
                open.push((next, moved));
            }
        }
    }
    found
}

/// The bounds among some members that count with the choices of a solution.
fn bounds(mission: &Model, members: &[Member], solution: &Choices) -> Vec<Bound> {
    let is_there = |context: Context| {
        context.is_none_or(|choice| solution.alternatives[choice.decision] == Some(choice.alternative))
    };
    let bound = |&member: &Member| {
        let (arc, is_lower) = match member {
            Member::Bound(Constraint::Lower(arc)) => (&mission.arcs[arc], true),
            Member::Bound(Constraint::Upper(arc)) => (&mission.arcs[arc], false),
            _ => return None,
        };
        let [from, to] = [arc.from, arc.to].map(|node| mission.representatives[node]);
        let counts = from != to && is_there(arc.context) && is_there(arc.other_context);
        let (from, to, weight) = if is_lower { (to, from, -arc.lower) } else { (from, to, arc.upper) };
        counts.then_some(Bound { member, from, to, weight })
    };
    members.iter().filter_map(bound).collect()
}

/// Returns whether more than bounds may tell where an event is.
fn fixed(mission: &Model, members: &[Member]) -> TiVec<NodeId, bool> {
    let mut is_fixed: TiVec<NodeId, bool> = vec![false; mission.num_nodes].into();
    let mut fix = |node: NodeId| is_fixed[mission.representatives[node]] = true;
    fix(mission.start);
    if members.iter().any(|member| matches!(member, Member::Condition(_))) {
        for label in &mission.conditions.labels {
            let arc = &mission.arcs[label.arc];
            fix(arc.from);
            fix(arc.to);
        }
    }
    let used: BTreeSet<Member> =
        members.iter().copied().filter(|member| matches!(member, Member::Use(_))).collect();
    for resource in &mission.demands.resources {
        if resource.uses.iter().any(|own| used.contains(&Member::Use(own.id))) {
            for own in &resource.uses {
                fix(own.start);
                fix(own.end);
            }
        }
    }
    is_fixed
}
