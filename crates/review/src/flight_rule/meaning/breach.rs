//! The cases that break a rule: when they are, and with which level of a resource.

use exact::Rational;
use tpn::NodeId;

use super::super::Stretch;
use super::super::cases::Case;
use super::super::cut::{Edge, Times};
use super::super::level::{Change, Resource};

/// A case that breaks a rule, and from when to when.
pub(in crate::flight_rule) struct Breach {
    pub(super) case: Case,
    pub(super) stretch: Stretch,
    pub(super) level: Option<Level>,
}

/// A level that breaks a rule.
#[derive(Clone)]
pub(in crate::flight_rule) struct Level {
    pub(super) resource: usize,
    pub(super) amount: Rational,
    /// What has led to it.
    pub(super) by: Vec<NodeId>,
    /// Which changes have come then, and which have not.
    pub(super) edges: Vec<Edge>,
}

/// Resources with more changes than this are not drawn change by change.
const MAX_DRAWN: usize = 120;

pub(super) fn earliest(breaches: impl IntoIterator<Item = Breach>) -> Option<Breach> {
    breaches.into_iter().min_by_key(|it| (it.stretch.from, it.stretch.to))
}

/// Returns where the levels of a case are as it wants them, and when; `None` if that cannot be told.
pub(super) fn at_levels(
    times: &mut Times,
    resources: &[Resource],
    case: &Case,
    pairs: &mut usize,
) -> Option<Vec<Breach>> {
    let range = times.range(&case.past, &case.future);
    let level = match met(times, resources, case, pairs) {
        Met::Yes(level) => level,
        Met::No => return Some(Vec::new()),
        Met::Unknown => return None,
    };
    let whole = |times: &Times| {
        vec![Breach { case: case.clone(), stretch: times.stretch(range), level: level.clone() }]
    };
    if level.is_none() {
        return Some(whole(times));
    }
    let mut wanted: Vec<usize> = case.levels.iter().map(|wanted| wanted.resource).collect();
    wanted.sort_unstable();
    wanted.dedup();
    let changes = || wanted.iter().flat_map(|&resource| &resources[resource].changes);
    if changes().count() > MAX_DRAWN {
        return Some(whole(times));
    }
    // The level that can be reached changes only where an event can come, or has to have come.
    let start = times.start();
    let mut bounds = vec![range.0];
    bounds.extend(range.1);
    for change in changes() {
        bounds.push(times.earliest(change.node));
        bounds.extend(times.latest(change.node));
    }
    bounds.retain(|&at| at >= range.0 && range.1.is_none_or(|to| at <= to));
    bounds.sort_unstable();
    bounds.dedup();
    let mut found = Vec::new();
    for (index, &at) in bounds.iter().enumerate() {
        let next = bounds.get(index + 1).copied();
        let point = [Edge::past(start, true).after(at), Edge::future(start, true).after(at)];
        let behind: Vec<Edge> = std::iter::once(Edge::past(start, false).after(at))
            .chain(next.map(|next| Edge::future(start, false).after(next)))
            .collect();
        for (edges, stretch) in [(point.to_vec(), (at, Some(at))), (behind, (at, next))] {
            let Some(case) = narrowed(times, case, &edges) else { continue };
            match met(times, resources, &case, pairs) {
                Met::Yes(level) => {
                    let stretch = times.stretch(stretch);
                    found.push(Breach { case, stretch, level });
                }
                Met::No => {}
                Met::Unknown => return None,
            }
        }
    }
    Some(found)
}

/// The case with more said of its events, if an instant still fits.
fn narrowed(times: &mut Times, case: &Case, edges: &[Edge]) -> Option<Case> {
    let mut narrow = case.clone();
    for &edge in edges {
        let others = if edge.is_past { &narrow.future } else { &narrow.past };
        let fits = |other: &Edge| {
            if edge.is_past { times.fits(edge, *other) } else { times.fits(*other, edge) }
        };
        if !others.iter().all(fits) {
            return None;
        }
        if edge.is_past { narrow.past.push(edge) } else { narrow.future.push(edge) }
    }
    Some(narrow)
}

/// Whether the levels of a case can be as it wants them.
enum Met {
    /// They can, with one of them.
    Yes(Option<Level>),
    No,
    /// There are too many ways, or figures that are too large.
    Unknown,
}

/// Whether some instant of a case meets all that it wants of levels. Where no level that is the furthest for one bound meets the
/// others too, a change that is open is taken to have come, and then not to: each leaves fewer levels. `pairs` of events
/// may be looked at for that.
fn met(times: &mut Times, resources: &[Resource], case: &Case, pairs: &mut usize) -> Met {
    let mut shown = None;
    for wanted in &case.levels {
        let resource = &resources[wanted.resource];
        let Some((level, has_come)) = resource.furthest(times, case, wanted) else { return Met::Unknown };
        if !wanted.is_met_by(level) {
            return Met::No;
        }
        let leads = |change: &Change| change.is_gain() == wanted.is_above;
        let come = resource.changes.iter().zip(&has_come);
        let by = come.filter(|(change, has_come)| **has_come && leads(change));
        let by = by.map(|(change, _)| change.node).collect();
        let side = |(change, &has_come): (&Change, &bool)| {
            let edge = change.has_come(wanted.is_instant);
            if has_come { edge } else { edge.negated() }
        };
        let edges = resource.changes.iter().zip(&has_come).map(side).collect();
        let found = Level { resource: wanted.resource, amount: level, by, edges };
        let is_of_one = case.levels.iter().all(|other| other.resource == wanted.resource);
        if is_of_one && resource.meets(&has_come, &case.levels) {
            return Met::Yes(Some(found));
        }
        shown = shown.or(Some(found));
    }
    let Some(open) = largest_open(times, resources, case) else {
        // The case says itself which changes have come.
        return Met::Yes(shown.map(|level| Level { edges: Vec::new(), ..level }));
    };
    let changes: usize = case.levels.iter().map(|wanted| resources[wanted.resource].changes.len()).sum();
    let Some(left) = pairs.checked_sub(changes * changes) else { return Met::Unknown };
    *pairs = left;
    let mut answer = Met::No;
    for edge in [open, open.negated()] {
        let Some(narrow) = narrowed(times, case, &[edge]) else { continue };
        match met(times, resources, &narrow, pairs) {
            Met::No => {}
            Met::Unknown => answer = Met::Unknown,
            met @ Met::Yes(_) => return met,
        }
    }
    answer
}

/// The largest change of a level that a case speaks of which may have come, and may be to come.
fn largest_open(times: &mut Times, resources: &[Resource], case: &Case) -> Option<Edge> {
    let mut largest: Option<(Rational, Edge)> = None;
    for wanted in &case.levels {
        let resource = &resources[wanted.resource];
        for change in resource.open(times, case, wanted.is_instant) {
            let size = change.size(wanted.is_above)?;
            if largest.as_ref().is_none_or(|(other, _)| size > *other) {
                largest = Some((size, change.has_come(wanted.is_instant)));
            }
        }
    }
    largest.map(|(_, edge)| edge)
}
