//! Runs through a product that break a property.

use std::collections::{BTreeMap, VecDeque};

use plant::Model;
use serde::{Deserialize, Serialize};

use super::product::{End, Move, NodeId, Product};

/// A run that breaks a property.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counterexample {
    /// Where the plant starts, if not in its most likely state, and the choices made before the first step.
    pub start: Move,
    /// What the environment decides in each step.
    pub moves: Vec<Move>,
    /// If the run then goes round forever: how many of the moves come before the first round.
    pub repeats_after: Option<usize>,
    /// If more than the moves was tried: for how many steps the run continued by what is nominal, and still breaks the
    /// property.
    pub goes_on_for: Option<u32>,
    /// Why the run is over at its end, if it is.
    pub end: Option<End>,
}

impl Counterexample {
    /// The steps in which not everything is nominal, such as `3: EngineA=Failed`.
    pub fn unusual(&self, model: &Model) -> Vec<String> {
        let is_unusual = |by: &Move| !by.modes.is_empty() || !by.observed.is_empty();
        let steps = (1..).zip(&self.moves).filter(|(_, by)| is_unusual(by));
        let shown = steps.map(|(step, by): (u32, _)| {
            let modes = by.named(model).map(|(name, mode)| format!("{name}={mode}"));
            let seen = by.shown(model).map(|(name, value)| format!("{name}={value} observed"));
            format!("{step}: {}", modes.chain(seen).collect::<Vec<_>>().join(", "))
        });
        shown.collect()
    }

    /// Returns how it ends, such as `after 6 steps nothing changes`.
    pub fn ending(&self) -> String {
        let steps = self.moves.len();
        let count = |number: usize| format!("{number} step{}", if number == 1 { "" } else { "s" });
        match (self.end, self.repeats_after) {
            (Some(End::Ended), from) => format!("the program ends after {}", count(from.unwrap_or(steps))),
            (Some(End::Deadlock), _) => "locks deadlock".to_owned(),
            (Some(End::Refuted), _) => "the observation refutes the belief".to_owned(),
            (Some(End::Unclear), _) => {
                "the belief keeps too few states to explain the observation".to_owned()
            }
            (None, Some(from)) if steps - from == 1 => {
                format!("after {} nothing changes", count(from))
            }
            (None, Some(from)) => {
                format!("after {} the last {} repeat forever", count(from), count(steps - from))
            }
            (None, None) => match self.goes_on_for {
                Some(more) => format!("still waiting {} later", count(more as usize)),
                None => format!("broken after {}", count(steps)),
            },
        }
    }
}

/// What a search for a run found.
pub(super) enum Found {
    Run(Box<Counterexample>),
    Nothing,
    /// Nothing, but it met nodes that were not explored.
    Open,
}

/// A path as its first node and the edges that follow.
struct Path {
    start: NodeId,
    edges: Vec<(NodeId, usize)>,
}

impl Product {
    fn is_explored(&self, id: NodeId) -> bool {
        self.nodes[id as usize].edges.is_some()
    }

    fn edges(&self, id: NodeId) -> &[super::product::Edge] {
        self.nodes[id as usize].edges.as_deref().unwrap_or_default()
    }

    fn start_nodes(&self) -> Vec<NodeId> {
        self.starts.iter().map(|(id, _)| *id).collect()
    }

    /// The shortest path from one of `from` to a goal, over nodes that `passes` allows.
    fn path(
        &self,
        from: &[NodeId],
        passes: impl Fn(NodeId) -> bool,
        is_goal: impl Fn(NodeId) -> bool,
    ) -> Option<Path> {
        let mut before: BTreeMap<NodeId, Option<(NodeId, usize)>> = BTreeMap::new();
        let mut queue = VecDeque::new();
        for &id in from.iter().filter(|id| passes(**id)) {
            before.entry(id).or_insert_with(|| {
                queue.push_back(id);
                None
            });
        }
        while let Some(id) = queue.pop_front() {
            if is_goal(id) {
                let mut edges = Vec::new();
                let mut at = id;
                while let Some(Some((earlier, edge))) = before.get(&at) {
                    edges.push((*earlier, *edge));
                    at = *earlier;
                }
                edges.reverse();
                return Some(Path { start: at, edges });
            }
            for (number, edge) in self.edges(id).iter().enumerate() {
                if passes(edge.to) && !before.contains_key(&edge.to) {
                    before.insert(edge.to, Some((id, number)));
                    queue.push_back(edge.to);
                }
            }
        }
        None
    }

    /// The end of a path.
    fn end_of(&self, path: &Path) -> NodeId {
        path.edges.last().map_or(path.start, |(from, edge)| self.edges(*from)[*edge].to)
    }

    fn counterexample(&self, path: &Path, repeats_after: Option<usize>) -> Counterexample {
        let start = self.starts.iter().find(|(id, _)| *id == path.start).map(|(_, by)| by.clone());
        let moves = path.edges.iter().map(|(from, edge)| self.edges(*from)[*edge].by.clone());
        Counterexample {
            start: start.unwrap_or_default(),
            moves: moves.collect(),
            repeats_after,
            goes_on_for: None,
            end: self.nodes[self.end_of(path) as usize].end,
        }
    }

    /// A run to a node that should not be come to.
    pub(super) fn run_to(&self, is_wrong: impl Fn(NodeId) -> bool) -> Found {
        match self.path(&self.start_nodes(), |_| true, is_wrong) {
            Some(path) => Found::Run(Box::new(self.counterexample(&path, None))),
            None if self.stopped.is_some() => Found::Open,
            None => Found::Nothing,
        }
    }

    /// The nodes from which, if nothing fails any more, one of the goals can be come to, or a node that was not explored.
    fn can_come_to(&self, is_goal: impl Fn(NodeId) -> bool) -> Vec<bool> {
        let mut into: Vec<Vec<NodeId>> = vec![Vec::new(); self.nodes.len()];
        let mut queue = VecDeque::new();
        let mut can = vec![false; self.nodes.len()];
        for id in (0..self.nodes.len()).map(|at| at as NodeId) {
            for edge in self.edges(id).iter().filter(|edge| !edge.is_fault) {
                into[edge.to as usize].push(id);
            }
            if is_goal(id) || !self.is_explored(id) {
                can[id as usize] = true;
                queue.push_back(id);
            }
        }
        while let Some(id) = queue.pop_front() {
            for &from in &into[id as usize] {
                if !std::mem::replace(&mut can[from as usize], true) {
                    queue.push_back(from);
                }
            }
        }
        can
    }

    /// A run in which from one of some nodes on, or from its start on if there are none given, no goal is ever come to:
    /// components fail as they please, but what chance decides again and again has each of its outcomes at some time.
    pub(super) fn run_without(
        &self,
        from: Option<&dyn Fn(NodeId) -> bool>,
        is_goal: impl Fn(NodeId) -> bool,
    ) -> Found {
        let can = self.can_come_to(&is_goal);
        let sources = match from {
            None => self.start_nodes(),
            Some(from) => self.all(from),
        };
        let Some(mut path) = self.path(&sources, |id| !is_goal(id), |id| !can[id as usize]) else {
            return if self.stopped.is_some() { Found::Open } else { Found::Nothing };
        };
        if from.is_some() {
            path = self.with_beginning(path);
        }
        // Round and round, by what is nominal where there is a choice.
        let mut seen: BTreeMap<NodeId, usize> = BTreeMap::new();
        let mut at = self.end_of(&path);
        while !seen.contains_key(&at) {
            seen.insert(at, path.edges.len());
            let Some(edge) = self.edges(at).iter().position(|edge| !edge.is_fault) else { break };
            path.edges.push((at, edge));
            at = self.edges(at)[edge].to;
        }
        let repeats_after = seen.get(&at).copied();
        Found::Run(Box::new(self.counterexample(&path, repeats_after)))
    }

    /// The shortest run without a goal to a node that was not explored, with that node.
    pub(super) fn run_to_the_unexplored(
        &self,
        from: Option<&dyn Fn(NodeId) -> bool>,
        is_goal: impl Fn(NodeId) -> bool,
    ) -> Option<(Counterexample, NodeId)> {
        let sources = match from {
            None => self.start_nodes(),
            Some(from) => self.all(from),
        };
        let mut path = self.path(&sources, |id| !is_goal(id), |id| !self.is_explored(id))?;
        if from.is_some() {
            path = self.with_beginning(path);
        }
        Some((self.counterexample(&path, None), self.end_of(&path)))
    }

    /// A run that comes to no goal for so many steps, from one of some nodes on or from its start on.
    pub(super) fn run_too_long(
        &self,
        from: Option<&dyn Fn(NodeId) -> bool>,
        is_goal: impl Fn(NodeId) -> bool,
        steps: u32,
    ) -> Found {
        let sources = match from {
            None => self.start_nodes(),
            Some(from) => self.all(from),
        };
        let mut layer: BTreeMap<NodeId, Option<(NodeId, usize)>> =
            sources.into_iter().filter(|id| !is_goal(*id)).map(|id| (id, None)).collect();
        let mut layers = Vec::new();
        let mut is_open = self.has_cut || (self.stopped.is_some() && from.is_some());
        for _ in 0..steps {
            let mut next = BTreeMap::new();
            for &id in layer.keys() {
                is_open |= !self.is_explored(id);
                for (number, edge) in self.edges(id).iter().enumerate() {
                    if !is_goal(edge.to) {
                        next.entry(edge.to).or_insert(Some((id, number)));
                    }
                }
            }
            layers.push(std::mem::replace(&mut layer, next));
        }
        let Some((&last, _)) = layer.first_key_value() else {
            return if is_open { Found::Open } else { Found::Nothing };
        };
        layers.push(layer);
        let mut edges = Vec::new();
        let mut at = last;
        for layer in layers.iter().rev() {
            if let Some(Some((from, edge))) = layer.get(&at) {
                edges.push((*from, *edge));
                at = *from;
            }
        }
        edges.reverse();
        let mut path = Path { start: at, edges };
        if from.is_some() {
            path = self.with_beginning(path);
        }
        Found::Run(Box::new(self.counterexample(&path, None)))
    }

    fn all(&self, is_such: impl Fn(NodeId) -> bool) -> Vec<NodeId> {
        (0..self.nodes.len()).map(|at| at as NodeId).filter(|id| is_such(*id)).collect()
    }

    /// A path with the shortest way from a start to its first node before it.
    fn with_beginning(&self, path: Path) -> Path {
        let Some(mut beginning) = self.path(&self.start_nodes(), |_| true, |id| id == path.start) else {
            return path;
        };
        beginning.edges.extend(path.edges);
        beginning
    }
}
