//! Finding events, activities, decisions and conditions by a part of their name.

use tpn::{DecisionId, LabelId, Network, NodeId, OccurrenceId};
use workbench::state::Selection;

/// More matches than this are not listed; they would not help.
const MAX_MATCHES: usize = 500;

/// What was looked for, and the match that was shown last.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Search {
    /// What is looked for.
    pub(super) text: String,
    found_for: String,
    found_version: u64,
    matches: Vec<Selection>,
    shown: Option<usize>,
}

impl Search {
    /// Looks again if the text or the drawing, by its version, has changed.
    pub(super) fn follow(&mut self, network: &Network, version: u64) {
        if self.found_for == self.text && self.found_version == version {
            return;
        }
        self.found_for.clone_from(&self.text);
        self.found_version = version;
        self.matches = matches(network, &self.text);
        self.shown = None;
    }

    /// Returns how many matches there are, and which was shown last, from 1.
    pub(super) fn count(&self) -> (usize, Option<usize>) {
        (self.matches.len(), self.shown.map(|at| at + 1))
    }

    /// The next match, or the one before; after the last comes the first.
    pub(super) fn step(&mut self, forwards: bool) -> Option<Selection> {
        let count = self.matches.len();
        if count == 0 {
            return None;
        }
        let next = match self.shown {
            None => 0,
            Some(at) if forwards => (at + 1) % count,
            Some(at) => (at + count - 1) % count,
        };
        self.shown = Some(next);
        self.matches.get(next).cloned()
    }
}

/// Everything whose name contains `text`, whatever the case.
pub(super) fn matches(network: &Network, text: &str) -> Vec<Selection> {
    let wanted = text.trim().to_lowercase();
    if wanted.is_empty() {
        return Vec::new();
    }
    let has = |name: &str| name.to_lowercase().contains(&wanted);
    let occurrences = (0..network.occurrences.len()).map(OccurrenceId::from_index);
    let occurrences = occurrences.filter(|id| {
        let occurrence = &network.occurrences[id.index()];
        has(&occurrence.name) || occurrence.arguments.iter().any(|argument| has(argument))
    });
    let decisions = (0..network.decisions.len()).map(DecisionId::from_index);
    let decisions = decisions.filter(|&id| has(&Network::decision_name(id)));
    let labels = (0..network.labels.len()).map(LabelId::from_index);
    let labels = labels.filter(|&id| has(&network.label_name(id)));
    let nodes = (0..network.nodes.len()).map(NodeId::from_index);
    let nodes = nodes.filter(|id| wanted.parse() == Ok(id.0));
    let mut found: Vec<Selection> = occurrences.map(Selection::Occurrence).collect();
    found.extend(decisions.map(Selection::Decision));
    found.extend(labels.map(Selection::Label));
    found.extend(nodes.map(Selection::Node));
    found.truncate(MAX_MATCHES);
    found
}
