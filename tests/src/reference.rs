//! An exhaustive planner written from SPEC 5 alone: every choice, every link, every ordering, over all-pairs distances.
//! It shares no code with the planner or the checker, and is only for networks of a few dozen nodes.

use exact::{Bound, Time};
use rmpl::program::LabelMode;
use tpn::{ArcId, CausalLink, Choice, DecisionId, LabelId, Network, NodeId, Ordering};

use crate::distances::{FAR, Matrix, Scale, of_arcs};

/// A plan as the reference finds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// In textual order.
    pub choices: Vec<Choice>,
    /// In textual order of the requirements.
    pub links: Vec<CausalLink>,
    /// Every conflicting pair, sorted by the textually earlier interval, then the other.
    pub conflicts: Vec<Ordering>,
    /// By node; `None` if not selected.
    pub windows: Vec<Option<(Time, Bound)>>,
}

/// What the exhaustive search found.
#[derive(Clone, Debug, Default)]
pub struct Answer {
    /// Distinct by choices, links and order of conflicts, in the order of SPEC 5.4.
    pub plans: Vec<Found>,
    pub steps: u64,
}

/// Searches; `None` if it takes more than `most_steps`.
pub fn search(network: &Network, most_steps: u64) -> Option<Answer> {
    let mut search = Exhaustive { network, scale: Scale::of(network), most_steps, answer: Answer::default() };
    search.choices(&mut vec![None; network.decisions.len()])?;
    Some(search.answer)
}

struct Exhaustive<'network> {
    network: &'network Network,
    scale: Scale,
    most_steps: u64,
    answer: Answer,
}

/// A complete choice while its conditions and threats are worked on.
struct Leaf {
    choices: Vec<Choice>,
    nodes: Vec<bool>,
    asks: Vec<LabelId>,
    tells: Vec<LabelId>,
    conflicts: Vec<(LabelId, LabelId)>,
}

impl Exhaustive<'_> {
    fn step(&mut self) -> Option<()> {
        self.answer.steps += 1;
        (self.answer.steps <= self.most_steps).then_some(())
    }

    fn choices(&mut self, taken: &mut Vec<Option<u32>>) -> Option<()> {
        self.step()?;
        let (nodes, arcs, open) = self.reach(taken);
        if let Some(decision) = open {
            let count = self.network.decisions[decision].alternatives.len() as u32;
            for alternative in 0..count {
                taken[decision] = Some(alternative);
                self.choices(taken)?;
            }
            taken[decision] = None;
            return Some(());
        }
        let Some(matrix) = of_arcs(self.network, self.scale, |arc| arcs[arc.index()]) else {
            return Some(());
        };
        let decided = taken.iter().enumerate().filter_map(|(decision, &alternative)| {
            Some(Choice { decision: DecisionId::from_index(decision), alternative: alternative? })
        });
        let selected: Vec<LabelId> = (0..self.network.labels.len())
            .map(LabelId::from_index)
            .filter(|label| arcs[self.network.labels[label.index()].arc.index()])
            .collect();
        let (asks, tells): (Vec<LabelId>, Vec<LabelId>) =
            selected.iter().partition(|label| self.network.labels[label.index()].mode == LabelMode::Ask);
        let mut conflicts = Vec::new();
        for (position, &one) in selected.iter().enumerate() {
            for &other in &selected[position + 1..] {
                if self.literal(one).conflicts(self.literal(other)) {
                    conflicts.push((one, other));
                }
            }
        }
        let leaf = Leaf { choices: decided.collect(), nodes, asks, tells, conflicts };
        self.links(&leaf, &mut Vec::new(), &matrix)
    }

    /// Selected nodes and arcs, and the first reached decision in textual order that is not decided.
    fn reach(&self, taken: &[Option<u32>]) -> (Vec<bool>, Vec<bool>, Option<usize>) {
        let mut nodes = vec![false; self.network.nodes.len()];
        let mut arcs = vec![false; self.network.arcs.len()];
        let mut undecided = Vec::new();
        let mut queue = vec![self.network.start];
        nodes[self.network.start.index()] = true;
        while let Some(node) = queue.pop() {
            let node = &self.network.nodes[node.index()];
            let out: Vec<ArcId> = match node.decision {
                None => node.out_arcs.clone(),
                Some(decision) => {
                    let alternatives = &self.network.decisions[decision.index()].alternatives;
                    let alternative =
                        taken[decision.index()].map(|alternative| alternatives[alternative as usize]);
                    if alternative.is_none() {
                        undecided.push(decision.index());
                    }
                    alternative.into_iter().collect()
                }
            };
            for arc in out {
                arcs[arc.index()] = true;
                let to = self.network.arcs[arc.index()].to;
                if !nodes[to.index()] {
                    nodes[to.index()] = true;
                    queue.push(to);
                }
            }
        }
        (nodes, arcs, undecided.into_iter().min())
    }

    fn links(&mut self, leaf: &Leaf, links: &mut Vec<CausalLink>, matrix: &Matrix) -> Option<()> {
        self.step()?;
        let Some(&ask) = leaf.asks.get(links.len()) else {
            let arc = |label: LabelId| self.network.labels[label.index()].arc;
            if leaf.conflicts.iter().any(|&(one, other)| arc(one) == arc(other)) {
                return Some(());
            }
            return self.orderings(leaf, links, &mut Vec::new(), matrix, matrix);
        };
        let (ask_start, ask_end) = self.ends(ask);
        for &tell in &leaf.tells {
            if !self.literal(tell).supports(self.literal(ask)) {
                continue;
            }
            let (tell_start, tell_end) = self.ends(tell);
            let mut with_link = matrix.clone();
            if with_link.constrain(tell_start, ask_start, 0, None)
                && with_link.constrain(ask_end, tell_end, 0, None)
            {
                links.push(CausalLink { ask, tell });
                self.links(leaf, links, &with_link)?;
                links.pop();
            }
        }
        Some(())
    }

    /// Puts an order to each conflict. Which are threats, and so need the gap, is said by `unordered`, the distances before
    /// any ordering (SPEC 5.3).
    fn orderings(
        &mut self,
        leaf: &Leaf,
        links: &[CausalLink],
        order: &mut Vec<Ordering>,
        unordered: &Matrix,
        matrix: &Matrix,
    ) -> Option<()> {
        self.step()?;
        let Some(&(one, other)) = leaf.conflicts.get(order.len()) else {
            self.found(leaf, links, order, matrix);
            return Some(());
        };
        let ways = [Ordering { first: one, then: other }, Ordering { first: other, then: one }];
        if let Some(&way) = ways.iter().find(|way| self.is_before(unordered, way.first, way.then)) {
            order.push(way);
            self.orderings(leaf, links, order, unordered, matrix)?;
            order.pop();
            return Some(());
        }
        let gap = self.scale.time(self.network.threat_gap);
        // What the orders before put in one order stays in that: without a gap the other one would leave no time to either.
        let is_known = |way: &&Ordering| matrix.get(self.ends(way.then).0, self.ends(way.first).1) <= -gap;
        let known = ways.iter().find(is_known).copied();
        for way in known.map_or(ways.to_vec(), |way| vec![way]) {
            let mut ordered = matrix.clone();
            if ordered.constrain(self.ends(way.first).1, self.ends(way.then).0, gap, None) {
                order.push(way);
                self.orderings(leaf, links, order, unordered, &ordered)?;
                order.pop();
            }
        }
        Some(())
    }

    fn found(&mut self, leaf: &Leaf, links: &[CausalLink], order: &[Ordering], matrix: &Matrix) {
        let start = self.network.start.index();
        let window = |(node, &selected): (usize, &bool)| {
            let latest = match matrix.get(start, node) {
                FAR.. => Bound::Infinite,
                latest => Bound::Finite(self.scale.unscaled(latest)),
            };
            selected.then(|| (self.scale.unscaled(-matrix.get(node, start)), latest))
        };
        // What is in both orders at once, as intervals without length at one instant are, is in the textual one.
        let told = |(&way, &(one, other)): (&Ordering, &(LabelId, LabelId))| {
            if self.is_before(matrix, one, other) { Ordering { first: one, then: other } } else { way }
        };
        let conflicts = order.iter().zip(&leaf.conflicts).map(told).collect();
        let found = Found {
            choices: leaf.choices.clone(),
            links: links.to_vec(),
            conflicts,
            windows: leaf.nodes.iter().enumerate().map(window).collect(),
        };
        let is_known = self.answer.plans.iter().any(|known| {
            known.choices == found.choices && known.links == found.links && known.conflicts == found.conflicts
        });
        if !is_known {
            self.answer.plans.push(found);
        }
    }

    fn is_before(&self, matrix: &Matrix, first: LabelId, then: LabelId) -> bool {
        let arc = &self.network.arcs[self.network.labels[first.index()].arc.index()];
        let is_instant = Bound::Finite(arc.lower) == Bound::ZERO && arc.upper == Bound::ZERO;
        let least = if is_instant { self.scale.time(self.network.threat_gap) } else { 0 };
        matrix.get(self.ends(then).0, self.ends(first).1) <= -least
    }

    fn ends(&self, label: LabelId) -> (usize, usize) {
        let arc = &self.network.arcs[self.network.labels[label.index()].arc.index()];
        let index = |node: NodeId| node.index();
        (index(arc.from), index(arc.to))
    }

    fn literal(&self, label: LabelId) -> &tpn::Literal {
        &self.network.labels[label.index()].literal
    }
}
