//! The environment as an adversary: for a network that is not controllable, durations that make any executive fail,
//! chosen as the run goes.
//!
//! What is left of a network at a moment is a network again. As long as that is not controllable, nature has a next
//! move after which it still is not: to end something at some time, or to let the executive do what it is about to do.

use std::collections::BTreeSet;

use crate::checker::{Stop, Undecided, Verdict, check};
use crate::network::{EdgeId, Link, LinkId, Network, PointId};

/// Returns what is left of a network at `now`, when some points have happened and nothing else has before: a network
/// with one more point, the last, whose time is 0. Links that have started are as long as they can still be.
pub fn residual(network: &Network, times: &[Option<i64>], now: i64) -> Result<Network, Undecided> {
    let mut left = Network::new(network.num_points());
    for edge in network.edges() {
        left.add_edge(edge.from, edge.to, edge.weight);
    }
    let origin = left.add_point();
    let negated = |time: i64| time.checked_neg().ok_or(Undecided::Overflow);
    for (point, &time) in (0..).map(PointId).zip(times) {
        match time {
            Some(time) => {
                left.add_edge(origin, point, time);
                left.add_edge(point, origin, negated(time)?);
            }
            // Ends come no earlier than their links say.
            None if network.link_ending_at(point).is_none() => {
                left.add_edge(point, origin, negated(now)?);
            }
            None => {}
        }
    }
    for link in network.links() {
        let Link { activation, end, lower, upper } = *link;
        let start = times.get(activation.index()).copied().flatten();
        let lower = match (start, times.get(end.index()).copied().flatten()) {
            (_, Some(_)) => continue,
            (Some(start), None) => lower.max(now.checked_sub(start).ok_or(Undecided::Overflow)?).min(upper),
            (None, None) => lower,
        };
        // A link of the network is one of what is left of it.
        let _ = left.add_link(Link { activation, end, lower, upper });
    }
    Ok(left)
}

/// What the executive is about to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Intention {
    /// The points that it executes if nothing happens before.
    pub points: Vec<PointId>,
    pub at: i64,
}

/// How many times between the ends of a range are tried.
const MAX_TIMES: i64 = 1_000;

/// The environment's move at `now`: the link that it ends, and when; `None` is to let the executive do what it intends,
/// or, if it intends nothing, that there is nothing to end. If what is left is not controllable, it is not afterwards,
/// as far as a move at an integer time does it.
pub fn respond(
    network: &Network,
    times: &[Option<i64>],
    now: i64,
    intention: Option<&Intention>,
    stop: Stop<'_>,
) -> Result<Option<(LinkId, i64)>, Undecided> {
    let pending: Vec<(LinkId, i64, i64)> = (0..)
        .map(LinkId)
        .zip(network.links())
        .filter(|(_, link)| times[link.end.index()].is_none())
        .filter_map(|(id, link)| {
            let start = times[link.activation.index()]?;
            Some((id, start.saturating_add(link.lower).max(now), start.saturating_add(link.upper).max(now)))
        })
        .collect();
    let forced = pending.iter().map(|&(id, _, latest)| (latest, id)).min();
    let horizon = match (forced, intention) {
        (Some((latest, _)), Some(intention)) => latest.min(intention.at),
        (Some((latest, _)), None) => latest,
        (None, _) => return Ok(None),
    };
    if let Some(intention) = intention
        && forced.is_none_or(|(latest, _)| latest >= intention.at)
    {
        let mut after = times.to_vec();
        for point in &intention.points {
            after[point.index()] = Some(intention.at);
        }
        if is_lost(network, &after, intention.at, stop)? {
            return Ok(None);
        }
    }
    for &(id, earliest, latest) in &pending {
        let (first, last) = (earliest, latest.min(horizon));
        let between = (first.saturating_add(1)..last).take(MAX_TIMES as usize);
        for time in [first, last].into_iter().chain(between).filter(|&time| time >= first && time <= last) {
            let mut after = times.to_vec();
            after[network.link(id).end.index()] = Some(time);
            if is_lost(network, &after, time, stop)? {
                return Ok(Some((id, time)));
            }
        }
    }
    // Nothing wins: as late as possible.
    Ok(match (forced, intention) {
        (Some((latest, _)), Some(intention)) if latest >= intention.at => None,
        (Some((latest, id)), _) => Some((id, latest)),
        (None, _) => None,
    })
}

fn is_lost(network: &Network, times: &[Option<i64>], now: i64, stop: Stop<'_>) -> Result<bool, Undecided> {
    Ok(check(&residual(network, times, now)?, stop)? != Verdict::Controllable)
}

/// A run that broke a constraint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailingRun {
    /// What happened, in the order of time: the environment's points are the ends of links.
    pub events: Vec<(PointId, i64)>,
    /// The constraint that does not hold, or can no longer.
    pub broken: EdgeId,
    /// When that was certain.
    pub at: i64,
}

/// The run that an executive ends up in that does everything as early as the constraints let it, against the
/// adversary, from time 0 on; `None` if it does not fail.
pub fn failing_run(network: &Network, stop: Stop<'_>) -> Result<Option<FailingRun>, Undecided> {
    let mut times: Vec<Option<i64>> = vec![None; network.num_points()];
    let mut events = Vec::new();
    let mut now = 0;
    let waits: BTreeSet<(PointId, PointId)> =
        network.edges().iter().filter(|edge| edge.weight <= 0).map(|edge| (edge.from, edge.to)).collect();
    loop {
        if let Some(broken) = broken(network, &times, now) {
            return Ok(Some(FailingRun { events, broken, at: now }));
        }
        let earliest = earliest(network, &times, now)?;
        let free = (0..times.len() as u32)
            .map(PointId)
            .filter(|&point| times[point.index()].is_none() && network.link_ending_at(point).is_none());
        let is_pending =
            |link: &Link| times[link.activation.index()].is_some() && times[link.end.index()].is_none();
        // What waits for the environment waits; constraints that wait for each other have to be broken somewhere.
        let is_blocked = blocked(network, &waits, &times);
        let at = |point: PointId| (earliest[point.index()], point);
        let next = match free.clone().filter(|point| !is_blocked[point.index()]).map(at).min() {
            None if !network.links().iter().any(is_pending) => free.map(at).min(),
            next => next,
        };
        let intention = next.map(|(at, point)| Intention { points: vec![point], at });
        if let Some((link, at)) = respond(network, &times, now, intention.as_ref(), stop)? {
            let end = network.link(link).end;
            (times[end.index()], now) = (Some(at), at);
            events.push((end, at));
            continue;
        }
        let Some(Intention { points, at }) = intention else { return Ok(None) };
        now = at;
        for point in points {
            times[point.index()] = Some(at);
            events.push((point, at));
        }
    }
}

/// By point, whether something that must come before it has not; of points that come at one instant, none waits for the
/// other. `waits` are the pairs of which one waits for the other.
fn blocked(network: &Network, waits: &BTreeSet<(PointId, PointId)>, times: &[Option<i64>]) -> Vec<bool> {
    let mut is_blocked = vec![false; times.len()];
    for edge in network.edges().iter().filter(|edge| edge.weight <= 0 && times[edge.to.index()].is_none()) {
        is_blocked[edge.from.index()] |= edge.weight < 0 || !waits.contains(&(edge.to, edge.from));
    }
    is_blocked
}

/// A constraint that is broken at `now`.
pub fn broken(network: &Network, times: &[Option<i64>], now: i64) -> Option<EdgeId> {
    (0..).map(EdgeId).zip(network.edges()).find_map(|(id, edge)| {
        let from = i128::from(times[edge.from.index()]?);
        // What has not happened happens now at the earliest.
        let to = i128::from(times[edge.to.index()].unwrap_or(now));
        (to - from > i128::from(edge.weight)).then_some(id)
    })
}

/// The earliest time of each point, if what the environment ends is as early as it may be.
fn earliest(network: &Network, times: &[Option<i64>], now: i64) -> Result<Vec<i64>, Undecided> {
    let mut earliest: Vec<i64> = times.iter().map(|time| time.unwrap_or(now)).collect();
    for _ in 0..=times.len() {
        let mut changed = false;
        let mut later = |earliest: &mut Vec<i64>, point: PointId, time: Option<i64>| {
            let time = time.ok_or(Undecided::Overflow)?;
            if times[point.index()].is_none() && earliest[point.index()] < time {
                earliest[point.index()] = time;
                changed = true;
            }
            Ok(())
        };
        for edge in network.edges() {
            let time = earliest[edge.to.index()].checked_sub(edge.weight);
            later(&mut earliest, edge.from, time)?;
        }
        for link in network.links() {
            let time = earliest[link.activation.index()].checked_add(link.lower);
            later(&mut earliest, link.end, time)?;
        }
        if !changed {
            break;
        }
    }
    Ok(earliest)
}
