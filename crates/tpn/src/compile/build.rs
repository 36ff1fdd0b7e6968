//! The network while it grows: nodes, arcs reserved before their ends are known, and the last pass that links them.

use std::collections::{BTreeMap, BTreeSet};

use rmpl::Span;
use rmpl::program::{LabelMode, Options};
use smol_str::SmolStr;

use super::bounds::Interval;
use super::names::{Fact, Vocabulary};
use crate::call_names::NamesOnDemand;
use crate::exchange::Exchangeable;
use crate::network::{
    Arc, ArcId, ArcKind, Block, BlockId, BlockKind, Decision, DecisionId, EventEnd, EventRef, Extent, Goal,
    Label, LabelId, Network, Node, NodeId, Occurrence, OccurrenceId, OccurrenceKind, Resource, Role, Use,
    Worth,
};

/// A label before its variable has an id.
struct Draft {
    arc: ArcId,
    mode: LabelMode,
    extent: Extent,
    fact: Fact,
    owner: Option<OccurrenceId>,
    span: Span,
}

/// The outermost piece.
pub(super) struct Root {
    pub(super) block: BlockId,
    pub(super) start: NodeId,
    pub(super) end: NodeId,
    /// An arc from the start that every plan selects, if there is one.
    pub(super) arc: Option<ArcId>,
}

/// Collects the parts of a network. Arcs are created in textual order, outer ones first; their ends may follow later.
#[derive(Default)]
pub(super) struct Builder {
    nodes: Vec<Node>,
    arcs: Vec<Arc>,
    drafts: Vec<Draft>,
    decisions: Vec<Decision>,
    occurrences: Vec<Occurrence>,
    blocks: Vec<Block>,
    pub(super) resources: Vec<Resource>,
    pub(super) uses: Vec<Use>,
    pub(super) worths: Vec<Worth>,
    counts: BTreeMap<SmolStr, u32>,
    /// Blocks whose parts are copies of one statement, with the member of a group that each is for.
    pub(super) copies: BTreeMap<BlockId, Vec<SmolStr>>,
}

/// Stands for an end of a reserved arc that is not known yet.
const UNKNOWN: NodeId = NodeId(u32::MAX);

impl Builder {
    /// Returns how many nodes there are.
    pub(super) fn node_count(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn node(&mut self) -> NodeId {
        self.nodes.push(Node::default());
        NodeId::from_index(self.nodes.len() - 1)
    }

    pub(super) fn arc(
        &mut self,
        from: NodeId,
        to: NodeId,
        kind: ArcKind,
        interval: Interval,
        span: Span,
    ) -> ArcId {
        let arc = Arc::bare(from, to, (interval.lower, interval.upper), kind);
        self.arcs.push(Arc { span: Some(span), ..arc });
        ArcId::from_index(self.arcs.len() - 1)
    }

    /// Lets the environment choose how long `arc` takes (SPEC 13.1).
    pub(super) fn leave_to_nature(&mut self, arc: ArcId) {
        self.arcs[arc.index()].is_contingent = true;
    }

    /// A new arc whose ends [`Builder::connect`] gives.
    pub(super) fn reserve(&mut self, kind: ArcKind, interval: Interval, span: Span) -> ArcId {
        self.arc(UNKNOWN, UNKNOWN, kind, interval, span)
    }

    /// Gives a reserved arc its ends.
    pub(super) fn connect(&mut self, arc: ArcId, from: NodeId, to: NodeId) {
        let arc = &mut self.arcs[arc.index()];
        (arc.from, arc.to) = (from, to);
    }

    /// Makes `arc` the arc of `occurrence`; a `do` or `if` only names an interval, so the arc is not its duration.
    pub(super) fn own(&mut self, occurrence: OccurrenceId, arc: ArcId) {
        let owner = &mut self.occurrences[occurrence.index()];
        owner.arc = Some(arc);
        if owner.kind != OccurrenceKind::Scope {
            self.arcs[arc.index()].occurrence = Some(occurrence);
        }
    }

    /// Says from how long to how long it takes to end an occurrence early.
    pub(super) fn abortable(&mut self, occurrence: OccurrenceId, takes: [exact::Time; 2]) {
        self.occurrences[occurrence.index()].aborts = Some(takes);
    }

    /// Makes `arc` an alternative of `decision`.
    pub(super) fn alternative(&mut self, decision: DecisionId, arc: ArcId, span: Span) {
        let alternatives = &mut self.decisions[decision.index()];
        self.arcs[arc.index()].choice = Some((decision, alternatives.alternatives.len() as u32));
        alternatives.alternatives.push(arc);
        alternatives.alternative_spans.push(span);
    }

    /// Makes `node` a new decision.
    pub(super) fn decision(&mut self, node: NodeId, span: Span) -> DecisionId {
        let id = DecisionId::from_index(self.decisions.len());
        self.nodes[node.index()].decision = Some(id);
        self.decisions.push(Decision {
            node,
            alternatives: Vec::new(),
            alternative_spans: Vec::new(),
            span: Some(span),
        });
        id
    }

    /// A new occurrence, counted among those of the same name; [`Builder::place`] gives its events.
    pub(super) fn occurrence(
        &mut self,
        activity: SmolStr,
        kind: OccurrenceKind,
        arguments: Vec<SmolStr>,
        parent: Option<OccurrenceId>,
        span: Span,
    ) -> OccurrenceId {
        let count = self.counts.entry(activity.clone()).or_insert(0);
        *count += 1;
        self.occurrences.push(Occurrence {
            name: format!("{activity}#{count}").into(),
            activity,
            kind,
            start: UNKNOWN,
            end: UNKNOWN,
            arc: None,
            arguments,
            parent,
            aborts: None,
            span: Some(span),
        });
        OccurrenceId::from_index(self.occurrences.len() - 1)
    }

    /// Gives an occurrence its first and last event.
    pub(super) fn place(&mut self, occurrence: OccurrenceId, start: NodeId, end: NodeId) {
        let placed = &mut self.occurrences[occurrence.index()];
        (placed.start, placed.end) = (start, end);
    }

    /// The occurrence that the next call of [`Builder::occurrence`] makes.
    pub(super) fn next_occurrence(&self) -> OccurrenceId {
        OccurrenceId::from_index(self.occurrences.len())
    }

    /// That occurrence, if it has been made.
    pub(super) fn made(&self, occurrence: OccurrenceId) -> Option<OccurrenceId> {
        (occurrence.index() < self.occurrences.len()).then_some(occurrence)
    }

    /// The arc of an occurrence.
    pub(super) fn arc_of(&self, occurrence: OccurrenceId) -> Option<ArcId> {
        self.occurrences[occurrence.index()].arc
    }

    /// Labels a part of `arc`, unless it already has the same label.
    pub(super) fn label(
        &mut self,
        arc: ArcId,
        (mode, extent): (LabelMode, Extent),
        fact: Fact,
        owner: Option<OccurrenceId>,
        span: Span,
    ) {
        let same = |draft: &Draft| {
            draft.arc == arc && draft.mode == mode && draft.extent == extent && draft.fact == fact
        };
        // Labels of one arc are drafted close together, so the scan from the back ends soon in practice; nested `do`s
        // on one arc are the only case of more than one label.
        if !self.drafts.iter().rev().take(64).any(same) {
            self.drafts.push(Draft { arc, mode, extent, fact, owner, span });
        }
    }

    /// A new block; its children exist already.
    pub(super) fn block(
        &mut self,
        kind: BlockKind,
        start: NodeId,
        end: NodeId,
        span: Option<Span>,
    ) -> BlockId {
        self.blocks.push(Block { kind, start, end, span });
        BlockId::from_index(self.blocks.len() - 1)
    }

    /// Links everything: labels in textual order of their arcs, arcs at their nodes, events at theirs.
    pub(super) fn finish(
        mut self,
        vocabulary: &Vocabulary<'_>,
        root: &Root,
        options: &Options,
        objective: Vec<Goal>,
    ) -> Network {
        if let Some(arc) = root.arc {
            let mentioned: BTreeSet<&str> =
                self.drafts.iter().map(|draft| draft.fact.variable.as_str()).collect();
            let initial: Vec<Draft> = vocabulary
                .initial_values()
                .filter(|(fact, _)| mentioned.contains(fact.variable.as_str()))
                .map(|(fact, span)| Draft {
                    arc,
                    mode: LabelMode::Tell,
                    extent: Extent::Initial,
                    fact,
                    owner: None,
                    span,
                })
                .collect();
            // What holds at first is told first.
            self.drafts.splice(0..0, initial);
        }
        self.drafts.sort_by_key(|draft| draft.arc);
        let facts: Vec<Fact> = self.drafts.iter().map(|draft| draft.fact.clone()).collect();
        let (variables, literals) = vocabulary.literals(&facts);
        let sights = vocabulary.sights(&facts, &variables);
        let mut labels = Vec::with_capacity(self.drafts.len());
        for (draft, literal) in self.drafts.into_iter().zip(literals) {
            self.arcs[draft.arc.index()].labels.push(LabelId::from_index(labels.len()));
            labels.push(Label {
                arc: draft.arc,
                mode: draft.mode,
                extent: draft.extent,
                literal,
                text: draft.fact.text(),
                owner: draft.owner,
                span: Some(draft.span),
            });
        }
        for (index, arc) in self.arcs.iter().enumerate().filter(|(_, arc)| arc.kind != ArcKind::Constraint) {
            self.nodes[arc.from.index()].out_arcs.push(ArcId::from_index(index));
            self.nodes[arc.to.index()].in_arcs.push(ArcId::from_index(index));
        }
        for (index, occurrence) in self.occurrences.iter().enumerate() {
            if occurrence.kind == OccurrenceKind::Scope {
                continue;
            }
            let occurrence_id = OccurrenceId::from_index(index);
            for (node, end) in [(occurrence.start, EventEnd::Start), (occurrence.end, EventEnd::End)] {
                self.nodes[node.index()].events.push(EventRef { occurrence: occurrence_id, end });
            }
        }
        for node in &mut self.nodes {
            node.role = match (node.decision, node.events.is_empty()) {
                (Some(_), _) => Role::Decision,
                (None, false) => Role::Event,
                (None, true) => Role::Structural,
            };
        }
        Network {
            nodes: self.nodes,
            arcs: self.arcs,
            labels,
            decisions: self.decisions,
            occurrences: self.occurrences,
            variables,
            sights,
            resources: self.resources,
            uses: self.uses,
            worths: self.worths,
            departures: Vec::new(),
            distances: Vec::new(),
            objective,
            blocks: self.blocks,
            root: Some(root.block),
            start: root.start,
            end: root.end,
            threat_gap: options.threat_gap,
            controllability: options.controllability,
            exchangeable: Exchangeable { vehicles: Vec::new(), copies: self.copies },
            names: NamesOnDemand::default(),
        }
    }
}
