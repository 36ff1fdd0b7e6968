//! The blocks of a nested network: which arcs are statements and which only structure, which bounds are those of a whole
//! block, and which hold between two events, of which what begins or ends there then has a name.

use std::collections::{BTreeMap, BTreeSet};

use exact::{Bound, Time};

use super::Obstacle;
use super::series_parallel::{Item, Tree, is_bound};
use tpn::network::{ArcId, ArcKind, Network, NodeId, OccurrenceKind};

/// A nested network, and how it is written.
pub(super) struct Blocks {
    pub(super) tree: Tree,
    /// How each item of each sequence is written.
    pub(super) forms: Vec<Vec<Form>>,
    /// By sequence: bounds and conditions of parts of it, outer ones first.
    pub(super) wraps: Vec<Vec<Wrap>>,
    /// Of each block of branches, those that are written.
    pub(super) branches: BTreeMap<Place, Vec<usize>>,
    /// What `constrain` says.
    pub(super) constraints: Vec<Constraint>,
    /// What has a name, and its number.
    pub(super) names: BTreeMap<Place, usize>,
}

/// An item: its sequence, and where it is in there.
pub(super) type Place = (usize, usize);

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// It is how sequences, branches and alternatives are compiled anyway.
    Structure,
    Statement,
    /// It takes no time, and is written so that an event has a name.
    Moment,
}

/// Bounds, conditions or a defined activity around the items `from..to` of a sequence.
#[derive(Clone, Copy)]
pub(super) struct Wrap {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) lower: Time,
    pub(super) upper: Bound,
    /// The arc that says so, unless it is a branch that only waits.
    pub(super) arc: Option<ArcId>,
}

/// An event: where an item begins or ends.
#[derive(Clone, Copy)]
pub(super) struct Event {
    pub(super) item: Place,
    pub(super) is_end: bool,
}

pub(super) struct Constraint {
    pub(super) from: Event,
    pub(super) to: Event,
    pub(super) lower: Time,
    pub(super) upper: Bound,
}

impl Blocks {
    pub(super) fn new(network: &Network, tree: Tree) -> Result<Self, Obstacle> {
        let count = tree.sequences.len();
        let blocks = Self {
            forms: tree
                .sequences
                .iter()
                .map(|sequence| vec![Form::Statement; sequence.items.len()])
                .collect(),
            wraps: (0..count).map(|_| Vec::new()).collect(),
            branches: BTreeMap::new(),
            constraints: Vec::new(),
            names: BTreeMap::new(),
            tree,
        };
        let mut shaping = Shaping {
            network,
            parents: vec![None; count],
            homes: blocks.homes(network),
            is_open_ended: vec![false; count],
            blocks,
        };
        shaping.find_structure();
        shaping.place_bounds()?;
        shaping.nest_wraps()?;
        Ok(shaping.blocks)
    }

    /// The sequence inside of which each node is, and where.
    fn homes(&self, network: &Network) -> Vec<Option<Place>> {
        let mut homes = vec![None; network.nodes.len()];
        for (index, sequence) in self.tree.sequences.iter().enumerate() {
            let last = sequence.nodes.len() - 1;
            for (boundary, node) in sequence.nodes.iter().enumerate() {
                if index == 0 || (boundary != 0 && boundary != last) {
                    homes[node.index()] = Some((index, boundary));
                }
            }
        }
        homes
    }
}

struct Shaping<'network> {
    network: &'network Network,
    /// The block that a sequence is in, and whether it is an alternative there.
    parents: Vec<Option<(usize, bool)>>,
    homes: Vec<Option<Place>>,
    /// Branches whose block continues only when all have ended.
    is_open_ended: Vec<bool>,
    blocks: Blocks,
}

impl Shaping<'_> {
    fn find_structure(&mut self) {
        let bounds = self.network.arcs.iter().filter(|arc| is_bound(arc.kind));
        let touched: BTreeSet<NodeId> = bounds.flat_map(|arc| [arc.from, arc.to]).collect();
        for sequence in 0..self.blocks.tree.sequences.len() {
            for item in 0..self.blocks.tree.sequences[sequence].items.len() {
                let place = (sequence, item);
                match &self.blocks.tree.sequences[sequence].items[item] {
                    Item::Arc(arc) if self.waits(*arc) == Some((Time::ZERO, Bound::ZERO)) => {
                        self.blocks.forms[sequence][item] = Form::Structure;
                    }
                    Item::Arc(_) => {}
                    Item::Choose(alternatives) => {
                        for &alternative in alternatives {
                            self.parents[alternative] = Some((sequence, true));
                        }
                    }
                    Item::Parallel(branches) => self.find_branches(place, &branches.clone(), &touched),
                }
            }
            // What ends a branch is how its block is compiled.
            if self.is_open_ended[sequence]
                && let Some(Item::Arc(arc)) = self.blocks.tree.sequences[sequence].items.last()
                && self.waits(*arc).is_some()
                && let Some(form) = self.blocks.forms[sequence].last_mut()
            {
                *form = Form::Structure;
            }
        }
    }

    /// Which branches are statements; how those end whose end is not just before that of the block.
    fn find_branches(&mut self, place: Place, branches: &[usize], touched: &BTreeSet<NodeId>) {
        let mut written = Vec::new();
        for &branch in branches {
            self.parents[branch] = Some((place.0, false));
            match self.only_waits(branch, touched) {
                Some((Time::ZERO, Bound::Infinite)) => {}
                Some((lower, upper)) => {
                    let wrap = Wrap { from: place.1, to: place.1 + 1, lower, upper, arc: None };
                    self.blocks.wraps[place.0].push(wrap);
                }
                None => written.push(branch),
            }
        }
        if written.len() > 1 {
            for &branch in &written {
                self.is_open_ended[branch] = true;
                let last = self.blocks.tree.sequences[branch].items.len() - 1;
                let waits = match self.blocks.tree.sequences[branch].items[last] {
                    Item::Arc(arc) => self.waits(arc),
                    _ => None,
                };
                let (lower, upper) = waits.unwrap_or((Time::ZERO, Bound::ZERO));
                if (lower, upper) != (Time::ZERO, Bound::Infinite) {
                    let from = if waits.is_some() { self.ending((branch, last - 1)) } else { (branch, last) };
                    self.constrain(
                        Event { item: from, is_end: true },
                        Event { item: place, is_end: true },
                        lower,
                        upper,
                    );
                }
            }
        }
        self.blocks.branches.insert(place, written);
    }

    /// An item that ends where this one does, made one if it is nothing but structure.
    fn ending(&mut self, item: Place) -> Place {
        let (sequence, index) = item;
        if let Item::Arc(arc) = self.blocks.tree.sequences[sequence].items[index]
            && self.waits(arc) == Some((Time::ZERO, Bound::ZERO))
        {
            self.blocks.names.entry(item).or_insert(0);
        }
        item
    }

    /// The bounds of an arc that is no more than these.
    fn waits(&self, id: ArcId) -> Option<(Time, Bound)> {
        let arc = &self.network.arcs[id.index()];
        let is_plain = arc.occurrence.is_none() && arc.labels.is_empty() && !arc.is_contingent;
        is_plain.then_some((arc.lower, arc.upper))
    }

    /// The bounds of a branch that says nothing but these, and at whose inner events nothing is bound.
    fn only_waits(&self, branch: usize, touched: &BTreeSet<NodeId>) -> Option<(Time, Bound)> {
        let sequence = &self.blocks.tree.sequences[branch];
        let inner = &sequence.nodes[1..sequence.nodes.len() - 1];
        if inner.iter().any(|node| touched.contains(node)) {
            return None;
        }
        let mut sum = (Time::ZERO, Bound::ZERO);
        for item in &sequence.items {
            let Item::Arc(arc) = item else { return None };
            let (lower, upper) = self.waits(*arc)?;
            sum.0 = sum.0.checked_add(lower)?;
            sum.1 = match (sum.1, upper) {
                (Bound::Finite(one), Bound::Finite(other)) => Bound::Finite(one.checked_add(other)?),
                _ => Bound::Infinite,
            };
        }
        Some(sum)
    }

    fn place_bounds(&mut self) -> Result<(), Obstacle> {
        for (index, arc) in self.network.arcs.iter().enumerate().filter(|(_, arc)| is_bound(arc.kind)) {
            let id = ArcId::from_index(index);
            let (Some(from), Some(to)) = (self.homes[arc.from.index()], self.homes[arc.to.index()]) else {
                // Bounds of what no plan selects.
                if arc.kind == ArcKind::Constraint || self.homes[arc.from.index()].is_none() {
                    continue;
                }
                return Err(Obstacle::at_arc(id, "leads to an event that no activity leads to"));
            };
            if arc.is_contingent {
                return Err(Obstacle::at_arc(id, "has a contingent duration for several activities"));
            }
            let whole =
                if arc.kind == ArcKind::Constraint { None } else { self.part(arc.from, arc.to, from, to) };
            match whole {
                Some((sequence, from, to)) => {
                    let wrap = Wrap { from, to, lower: arc.lower, upper: arc.upper, arc: Some(id) };
                    self.blocks.wraps[sequence].push(wrap);
                }
                None => self.bind(id, from, to)?,
            }
        }
        Ok(())
    }

    /// The part of one sequence that lies between two events, if that is exact.
    fn part(&self, from: NodeId, to: NodeId, start: Place, end: Place) -> Option<(usize, usize, usize)> {
        let sequence = |place: Place| &self.blocks.tree.sequences[place.0];
        if start.0 == end.0 {
            (start.1 < end.1).then_some((start.0, start.1, end.1))
        } else if sequence(start).nodes.last() == Some(&to) && !self.is_open_ended[start.0] {
            Some((start.0, start.1, sequence(start).items.len()))
        } else if sequence(end).nodes.first() == Some(&from) {
            Some((end.0, 0, end.1))
        } else {
            None
        }
    }

    /// Writes a bound between two events as a constraint, where that means the same.
    fn bind(&mut self, id: ArcId, from: Place, to: Place) -> Result<(), Obstacle> {
        let arc = &self.network.arcs[id.index()];
        let has_name = arc.occurrence.is_some_and(|occurrence| {
            self.network.occurrences[occurrence.index()].kind == OccurrenceKind::Activity
        });
        if !arc.labels.is_empty() || has_name {
            let what = if has_name { "is an activity" } else { "has a condition" };
            return Err(Obstacle::at_arc(id, &format!("{what} that covers no whole block")));
        }
        // A bound that is not a constraint selects its last event.
        if arc.kind != ArcKind::Constraint {
            let around = self.alternatives_around(from.0);
            if !self.alternatives_around(to.0).is_subset(&around) {
                return Err(Obstacle::at_arc(id, "bounds an event inside an alternative from outside"));
            }
        }
        let (lower, upper) = (arc.lower, arc.upper);
        let (from, to) = (self.event(from), self.event(to));
        self.constrain(from, to, lower, upper);
        Ok(())
    }

    fn alternatives_around(&self, sequence: usize) -> BTreeSet<usize> {
        let mut around = BTreeSet::new();
        let mut at = sequence;
        while let Some((parent, is_alternative)) = self.parents[at] {
            if is_alternative {
                around.insert(at);
            }
            at = parent;
        }
        around
    }

    /// An item that begins or ends at a boundary of a sequence; one that takes no time is written if there is no other.
    fn event(&mut self, (sequence, boundary): Place) -> Event {
        let forms = &self.blocks.forms[sequence];
        if boundary > 0 && forms[boundary - 1] != Form::Structure {
            return Event { item: (sequence, boundary - 1), is_end: true };
        }
        if forms.get(boundary).is_some_and(|&form| form != Form::Structure) {
            return Event { item: (sequence, boundary), is_end: false };
        }
        let index = boundary.saturating_sub(1);
        self.blocks.forms[sequence][index] = Form::Moment;
        Event { item: (sequence, index), is_end: boundary > 0 }
    }

    fn constrain(&mut self, from: Event, to: Event, lower: Time, upper: Bound) {
        for event in [from, to] {
            self.blocks.names.entry(event.item).or_insert(0);
        }
        self.blocks.constraints.push(Constraint { from, to, lower, upper });
    }

    /// Puts wraps in order; those that overlap others become constraints.
    fn nest_wraps(&mut self) -> Result<(), Obstacle> {
        for sequence in 0..self.blocks.wraps.len() {
            let mut wraps = std::mem::take(&mut self.blocks.wraps[sequence]);
            wraps.sort_by_key(|wrap| (wrap.from, std::cmp::Reverse(wrap.to), wrap.arc));
            let mut around: Vec<usize> = Vec::new();
            let mut nested = Vec::new();
            for wrap in wraps {
                while around.last().is_some_and(|&end| end <= wrap.from) {
                    around.pop();
                }
                if around.last().is_some_and(|&end| end < wrap.to)
                    && let Some(arc) = wrap.arc
                {
                    self.bind(arc, (sequence, wrap.from), (sequence, wrap.to))?;
                    continue;
                }
                around.push(wrap.to);
                nested.push(wrap);
            }
            self.blocks.wraps[sequence] = nested;
        }
        // What is named and nothing but structure is written as a moment; names count in the order of the text.
        let named: Vec<Place> = self.blocks.names.keys().copied().collect();
        for (number, (sequence, item)) in named.into_iter().enumerate() {
            self.blocks.names.insert((sequence, item), number + 1);
            if self.blocks.forms[sequence][item] == Form::Structure {
                self.blocks.forms[sequence][item] = Form::Moment;
            }
        }
        Ok(())
    }
}
