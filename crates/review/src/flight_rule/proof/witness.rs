//! A mission with an instant that meets a requirement, as one network: whatever plans it plans the mission, and finds the
//! instant as well.
//!
//! The instant is one more event between start and end. What has to be between it and other events are bounds between
//! threads, which are in force where a plan has both events; each "or" is a choice; what a plan has to select is a condition
//! that only the selected asserts; and a level is a reservoir of its own, which is filled by the changes that have come.

use exact::{Bound, Rational, Scale, Time};
use rmpl::program::{Change as Changes, Controllability, LabelMode};
use tpn::{
    Arc, ArcId, ArcKind, Block, BlockId, BlockKind, Decision, DecisionId, Extent, Label, LabelId,
    LevelCondition, Literal, Network, Node, NodeId, Resource as NetworkResource, ResourceId, Role, Supply,
    Use, ValueId, ValueSet, Variable, VariableId,
};

use super::super::cut::{Edge, PARTS};
use super::super::level::{Change, Wanted};
use super::question::Requirement;

/// The network of a mission with such an instant; `None` if figures are too large, or the network has no structure.
pub(super) fn with_instant(network: &Network, scale: Scale, requirement: &Requirement) -> Option<Network> {
    let root = network.root?;
    let mut extended = network.clone();
    // Whether a rule holds does not depend on what plans are worth, and the environment does what breaks it.
    extended.objective.clear();
    extended.controllability = Controllability::None;
    // Vertices of a path are no deadlines (SPEC 6.2).
    for segment in extended.arcs.iter_mut().filter(|arc| arc.kind == ArcKind::Path) {
        segment.upper = Bound::Infinite;
    }
    let (start, end) = (network.start, network.end);
    let ticks_per_unit = scale.ticks_per_unit();
    let part = Time::new(1, ticks_per_unit.checked_mul(PARTS)?)?;
    let mut witness =
        Witness { network: extended, part, tick: Time::new(1, ticks_per_unit)?, instant: start, of: network };
    let (block, instant) = witness.event(start, end);
    witness.instant = instant;
    let mut branches = vec![root, block];
    witness.require(requirement, (start, end), &mut branches)?;
    witness.network.root = Some(witness.block(BlockKind::Parallel { branches }, start, end));
    Some(witness.network)
}

struct Witness<'a> {
    network: Network,
    /// The mission's own.
    of: &'a Network,
    /// The part of a tick that is between an instant and an event that it must not touch.
    part: Time,
    tick: Time,
    instant: NodeId,
}

/// What has to be met between two events, at any time.
type Ends = (NodeId, NodeId);

impl Witness<'_> {
    /// Adds what meets a requirement, as branches.
    fn require(&mut self, requirement: &Requirement, ends: Ends, branches: &mut Vec<BlockId>) -> Option<()> {
        match requirement {
            Requirement::All(parts) => {
                for part in parts {
                    self.require(part, ends, branches)?;
                }
            }
            Requirement::Any(parts) => branches.push(self.choose(parts, ends)?),
            Requirement::Edge(edge) => branches.push(self.edge(*edge, ends)?),
            Requirement::Selected(arc) => branches.push(self.selected(*arc, ends)),
            Requirement::Order { earlier, later } => {
                let (block, between) = self.event(ends.0, ends.1);
                self.bound(*earlier, between, Time::ZERO, Bound::Infinite);
                self.bound(between, *later, Time::ZERO, Bound::Infinite);
                branches.push(block);
            }
            Requirement::Level(wanted) => self.level(*wanted, ends, branches)?,
        }
        Some(())
    }

    /// One of several, between two events.
    fn choose(&mut self, parts: &[Requirement], ends: Ends) -> Option<BlockId> {
        self.choose_by(ends, parts.len(), |witness, number, ends, branches| {
            witness.require(&parts[number], ends, branches)
        })
    }

    fn choose_by(
        &mut self,
        (from, to): Ends,
        count: usize,
        mut add: impl FnMut(&mut Self, usize, Ends, &mut Vec<BlockId>) -> Option<()>,
    ) -> Option<BlockId> {
        let (decision_node, merge) = (self.node(Role::Decision), self.node(Role::Structural));
        let decision = DecisionId::from_index(self.network.decisions.len());
        self.network.nodes[decision_node.index()].decision = Some(decision);
        self.network.decisions.push(Decision {
            node: decision_node,
            alternatives: Vec::new(),
            alternative_spans: Vec::new(),
            span: None,
        });
        let before = self.delay(from, decision_node);
        let mut alternatives = Vec::new();
        for number in 0..count {
            let (first, last) = (self.node(Role::Structural), self.node(Role::Structural));
            let taken = self.arc(decision_node, first, Bound::ZERO, ArcKind::Choice);
            self.network.arcs[taken.index()].choice = Some((decision, number as u32));
            self.network.decisions[decision.index()].alternatives.push(taken);
            let mut branches = Vec::new();
            add(self, number, (first, last), &mut branches)?;
            self.arc(last, merge, Bound::ZERO, ArcKind::Merge);
            alternatives.push(self.block(BlockKind::Parallel { branches }, first, last));
        }
        let chosen = self.block(BlockKind::Choose { decision, alternatives }, decision_node, merge);
        let after = self.delay(merge, to);
        Some(self.block(BlockKind::Sequence { children: vec![before, chosen, after] }, from, to))
    }

    /// The instant is after an event, or before it.
    fn edge(&mut self, edge: Edge, (from, to): Ends) -> Option<BlockId> {
        let (block, own) = self.event(from, to);
        let gap = if edge.may_touch { Time::ZERO } else { self.part };
        let offset = self.tick.checked_mul(Rational::from_integer(edge.offset))?;
        // Each has an event of its own at the instant, so that nothing that is before the instant comes before what is after
        // it: they may be at one time, in any order. What is later than the end of the mission, or earlier than its start,
        // comes before it or after it all the same, so that these two are bounds from the other side.
        let has_come = edge.is_past;
        if has_come {
            self.bound(self.instant, own, Time::ZERO, Bound::ZERO);
        } else {
            self.bound(own, self.instant, Time::ZERO, Bound::ZERO);
        }
        let least = if has_come { offset.checked_add(gap)? } else { gap };
        if has_come && edge.node == self.network.end {
            self.bound(own, edge.node, Time::ZERO, Bound::Finite(least.checked_neg()?));
        } else if has_come {
            self.bound(edge.node, own, least, Bound::Infinite);
        } else if edge.node == self.network.start {
            self.bound(edge.node, own, Time::ZERO, Bound::Finite(offset.checked_sub(gap)?));
        } else {
            self.bound(own, edge.node, least, Bound::Infinite);
        }
        Some(block)
    }

    /// The plan selects an arc of the mission.
    fn selected(&mut self, arc: ArcId, (from, to): Ends) -> BlockId {
        let name = format!("arc {} is selected", arc.0);
        let known = self.network.variables.iter().position(|it| it.name == name);
        let variable = VariableId::from_index(known.unwrap_or_else(|| {
            self.network.variables.push(Variable {
                name: name.into(),
                values: vec!["true".into()],
                closed: true,
                is_lasting: false,
            });
            self.network.variables.len() - 1
        }));
        if known.is_none() {
            self.label(arc, LabelMode::Tell, variable);
        }
        let (first, last) = (self.node(Role::Event), self.node(Role::Event));
        let before = self.delay(from, first);
        let asked = self.arc(first, last, Bound::ZERO, ArcKind::Assertion);
        self.label(asked, LabelMode::Ask, variable);
        let asking = self.block(BlockKind::Leaf { arc: asked }, first, last);
        let after = self.delay(last, to);
        self.block(BlockKind::Sequence { children: vec![before, asking, after] }, from, to)
    }

    /// A level at the instant, as that of a reservoir of its own: each change has come, and counts, or is to come.
    fn level(&mut self, wanted: Wanted, (from, to): Ends, branches: &mut Vec<BlockId>) -> Option<()> {
        let uses = self.of.uses.iter().filter(|used| used.resource.index() == wanted.resource);
        let changes: Vec<(ArcId, Change)> =
            uses.flat_map(|used| Change::of_use(used).into_iter().map(|change| (used.arc, change))).collect();
        let first = self.of.resources[wanted.resource].supply.initial_level();
        let sizes = changes.iter().map(|(_, change)| change.size(wanted.is_above));
        let furthest = sizes.collect::<Option<Vec<_>>>()?.into_iter().try_fold(
            // What is compared with counts, too, so that it is within what the reservoir holds.
            if wanted.amount.is_negative() { wanted.amount.checked_neg()? } else { wanted.amount },
            Rational::checked_add,
        )?;
        let resource = ResourceId::from_index(self.network.resources.len());
        self.network.resources.push(NetworkResource {
            name: format!("level {}", resource.0).into(),
            supply: Supply::Reservoir {
                least: first.checked_sub(furthest)?.checked_sub(Rational::ONE)?,
                greatest: first.checked_add(furthest)?.checked_add(Rational::ONE)?,
                level: first,
            },
            span: None,
        });
        let (block, read) = self.event(from, to);
        branches.push(block);
        let condition = LevelCondition { order: wanted.order(), bound: wanted.amount };
        // It is read where one of the arcs around it is selected.
        let arc = self.network.nodes[read.index()].in_arcs[0];
        let reading = Use {
            resource,
            change: condition.change(),
            amount: Rational::ZERO,
            at_least: Rational::ZERO,
            per_meter: Rational::ZERO,
            arc,
            start: read,
            end: read,
            owner: None,
            level: Some(condition),
            span: None,
        };
        self.network.uses.push(reading.clone());
        for (arc, change) in changes {
            let come = change.has_come(wanted.is_instant);
            let more = change.toward(wanted.is_above);
            let block = self.choose_by((from, to), 2, |witness, number, ends, branches| {
                branches.push(witness.edge(if number == 0 { come } else { come.negated() }, ends)?);
                if number > 0 {
                    return Some(());
                }
                branches.push(witness.selected(arc, ends));
                let (first, last) = (witness.node(Role::Event), witness.node(Role::Event));
                let before = witness.delay(ends.0, first);
                let arc = witness.arc(first, last, Bound::ZERO, ArcKind::Delay);
                let counting = witness.block(BlockKind::Leaf { arc }, first, last);
                let after = witness.delay(last, ends.1);
                let children = vec![before, counting, after];
                branches.push(witness.block(BlockKind::Sequence { children }, ends.0, ends.1));
                witness.bound(last, read, Time::ZERO, Bound::Infinite);
                let is_less = more.is_negative();
                let amount = if is_less { more.checked_neg()? } else { more };
                witness.network.uses.push(Use {
                    change: if is_less { Changes::Consumes } else { Changes::Produces },
                    amount,
                    at_least: amount,
                    arc,
                    start: first,
                    end: last,
                    level: None,
                    ..reading.clone()
                });
                Some(())
            })?;
            branches.push(block);
        }
        Some(())
    }

    fn node(&mut self, role: Role) -> NodeId {
        self.network.nodes.push(Node { role, ..Node::default() });
        NodeId::from_index(self.network.nodes.len() - 1)
    }

    /// An arc from nothing to `upper`.
    fn arc(&mut self, from: NodeId, to: NodeId, upper: Bound, kind: ArcKind) -> ArcId {
        self.network.connect(Arc::bare(from, to, (Time::ZERO, upper), kind))
    }

    /// A bound where a plan has both events.
    fn bound(&mut self, from: NodeId, to: NodeId, lower: Time, upper: Bound) {
        self.network.arcs.push(Arc::bare(from, to, (lower, upper), ArcKind::Constraint));
    }

    fn block(&mut self, kind: BlockKind, start: NodeId, end: NodeId) -> BlockId {
        self.network.blocks.push(Block { kind, start, end, span: None });
        BlockId::from_index(self.network.blocks.len() - 1)
    }

    /// Any time between two events.
    fn delay(&mut self, from: NodeId, to: NodeId) -> BlockId {
        let arc = self.arc(from, to, Bound::Infinite, ArcKind::Delay);
        self.block(BlockKind::Leaf { arc }, from, to)
    }

    /// An event at any time between two others.
    fn event(&mut self, from: NodeId, to: NodeId) -> (BlockId, NodeId) {
        let event = self.node(Role::Event);
        let children = vec![self.delay(from, event), self.delay(event, to)];
        (self.block(BlockKind::Sequence { children }, from, to), event)
    }

    fn label(&mut self, arc: ArcId, mode: LabelMode, variable: VariableId) {
        let id = LabelId::from_index(self.network.labels.len());
        let literal = Literal { variable, values: ValueSet::In(vec![ValueId::from_index(0)]) };
        let text = self.network.variables[variable.index()].name.clone();
        let extent = Extent::Arc;
        self.network.labels.push(Label { arc, mode, extent, literal, text, owner: None, span: None });
        self.network.arcs[arc.index()].labels.push(id);
    }
}
