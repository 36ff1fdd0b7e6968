//! What people read for the calls of a network: made from their activities and arguments.

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;

use crate::alternative::shortened_call;
use crate::call_names::CallNames;
use crate::network::{Network, Occurrence, OccurrenceKind};

impl CallNames {
    /// `Visit#3` becomes `Visit(S[3], RIDGE)`, or `Visit(S[3], RIDGE)#3` if another call has the same arguments. Of long calls
    /// some arguments are left out, where that leaves them distinct: `Group-Traverse-Path(PATH1_1, …, TAI_POS)`.
    fn new(network: &Network) -> Self {
        let mut alike: BTreeMap<String, BTreeSet<&[SmolStr]>> = BTreeMap::new();
        let mut counts: BTreeMap<(&SmolStr, &[SmolStr]), usize> = BTreeMap::new();
        for call in calls_of(network) {
            alike.entry(shortened_call(call)).or_default().insert(&call.arguments);
            *counts.entry((&call.activity, &call.arguments)).or_default() += 1;
        }
        let shown = |call: &Occurrence| {
            let short = shortened_call(call);
            let is_distinct = alike.get(&short).is_some_and(|alike| alike.len() == 1);
            let complete = || format!("{}({})", call.activity, call.arguments.join(", "));
            let text = if is_distinct { short } else { complete() };
            match call.name.rsplit_once('#') {
                Some((_, number)) if counts[&(&call.activity, call.arguments.as_slice())] > 1 => {
                    format!("{text}#{number}")
                }
                _ => text,
            }
        };
        Self::of(calls_of(network).map(|call| (call.name.clone(), shown(call))).collect())
    }
}

/// The calls that have arguments.
fn calls_of(network: &Network) -> impl Iterator<Item = &Occurrence> {
    network.occurrences.iter().filter(|it| {
        matches!(it.kind, OccurrenceKind::Primitive | OccurrenceKind::Activity) && !it.arguments.is_empty()
    })
}

impl Network {
    /// A text with the identifiers of this network's calls replaced by what people read: `Visit#3` becomes
    /// `Visit(S[3], RIDGE)`.
    pub fn readable(&self, text: &str) -> String {
        self.names.get(|| CallNames::new(self)).in_text(text)
    }
}
