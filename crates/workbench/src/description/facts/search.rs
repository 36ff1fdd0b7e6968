//! The recorded search and the step of it that is looked at.

use kirk::Event;
use tpn::Network;

use super::{Row, count, time, truth, words};
use crate::lesson::{StepKind, Value};
use crate::state::search::Counts;
use crate::state::search::wording::event;
use crate::state::selection::node_name;

pub(super) const VALUES: &[Row] = &[
    ("steps", |it, which| count(it.recording(which)?.steps())),
    ("states", |it, which| count(it.counts(which)?.states as usize)),
    ("backtracks", |it, which| count(it.counts(which)?.backtracks as usize)),
    ("failures", |it, which| count(it.counts(which)?.failures as usize)),
    ("failures-before", |it, step| {
        let (recording, step) = it.step_called(step)?;
        count(Counts::until(recording.trace(), step).failures as usize)
    }),
    ("next-decision", |it, step| {
        let (recording, step) = it.step_called(step)?;
        let mut later = recording.trace().events.iter().skip(step + 1);
        words(later.find_map(|entry| match &entry.event {
            Event::Decide { decision, .. } => Some(Network::decision_name(*decision)),
            _ => None,
        })?)
    }),
    ("propagations", |it, which| count(it.counts(which)?.propagations as usize)),
    ("count", |it, kind| {
        let (_, kind) = StepKind::ALL.into_iter().find(|(name, _)| *name == kind)?;
        let recording = it.recording("")?;
        count(recording.trace().events.iter().filter(|entry| kind.is(&entry.event)).count())
    }),
    ("step", |it, _| count(it.search().step)),
    ("step-is", |it, kind| {
        let (_, kind) = StepKind::ALL.into_iter().find(|(name, _)| *name == kind)?;
        truth(it.looked_at().is_some_and(|(_, event)| kind.is(event)))
    }),
    ("sentence", |it, _| {
        let (recording, entry) = it.looked_at()?;
        words(event(recording.network(), recording.trace(), entry))
    }),
    ("shortfall", |it, _| {
        let Event::Inconsistent { cycle } = it.looked_at()?.1 else { return None };
        let total = exact::Time::checked_sum(cycle.iter().map(|member| member.weight))?;
        time(total.checked_neg()?)
    }),
    ("bound", |it, step| {
        let bound = |event: &Event| match event {
            Event::Bound { values } | Event::Visit { values, .. } => values.first().copied(),
            _ => None,
        };
        if step.is_empty() {
            return bound(it.looked_at()?.1).map(Value::Number);
        }
        let (recording, step) = it.step_called(step)?;
        bound(&recording.trace().events.get(step)?.event).map(Value::Number)
    }),
    ("cycle", |it, _| {
        let (recording, event) = it.looked_at()?;
        let Event::Inconsistent { cycle } = event else { return None };
        let names: Vec<String> = cycle.iter().map(|it| node_name(recording.network(), it.from)).collect();
        words(names.join(" → "))
    }),
    ("cycle-length", |it, _| {
        let Event::Inconsistent { cycle } = it.looked_at()?.1 else { return None };
        count(cycle.len())
    }),
    ("compared", |it, _| truth(it.recordings().len() == 2)),
];
