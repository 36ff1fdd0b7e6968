//! The hitting-set tree, built node by node: diagnoses are the minimal sets of components that have an assumption in every
//! conflict (Reiter 1987; Greiner, Smith and Wilkerson 1989).
//!
//! The caller chooses the next node and what it becomes. A wrong choice is refused, with the reason.

use crate::belief::State;
use crate::diagnosis::{Conflict, conflict_without};
use crate::model::{ComponentId, Model, Observation};

/// Trees do not grow beyond this many nodes.
pub const MAX_NODES: usize = 256;

/// A tree that is being built. The root is node 0, and parents come before their children.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HittingTree {
    nodes: Vec<HittingNode>,
    conflicts: Vec<Conflict>,
}

/// A node: what is no longer assumed there, and what became of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HittingNode {
    pub parent: Option<usize>,
    /// The components of the edges from the root, in ascending order: of these nothing is assumed any more.
    pub without: Vec<ComponentId>,
    /// The component of the edge from its parent.
    pub component: Option<ComponentId>,
    pub label: HittingLabel,
}

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HittingLabel {
    /// Nothing is known of it yet.
    Open,
    /// It has a child for each assumption of this conflict, by its place in the tree's conflicts.
    Conflict(usize),
    /// Without its assumptions, all others can hold: a diagnosis.
    Diagnosis,
    /// This other node makes it superfluous.
    Closed { by: usize },
}

/// What a node is to become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HittingMove {
    /// Expand it by this conflict.
    Expand(usize),
    /// Close it, as another node covers it.
    Close,
    /// Mark it as a diagnosis.
    Diagnose,
}

/// Why a node cannot become that.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// There is no such open node, or no such conflict.
    Unknown,
    /// The path to the node already has this assumption of the conflict.
    IsHit(ComponentId),
    /// No diagnosis is a part of its path, and no other node has the same path.
    NothingCovers,
    /// All assumptions of this conflict are still made.
    Contradicts(usize),
    /// A part of its path is a diagnosis already.
    NotMinimal {
        /// The node of that diagnosis.
        by: usize,
    },
    /// The tree has [`MAX_NODES`] nodes.
    TooLarge,
}

impl HittingTree {
    /// The root alone, over these conflicts.
    pub fn new(conflicts: Vec<Conflict>) -> Self {
        let root =
            HittingNode { parent: None, without: Vec::new(), component: None, label: HittingLabel::Open };
        Self { nodes: vec![root], conflicts }
    }

    /// The nodes, the root first.
    pub fn nodes(&self) -> &[HittingNode] {
        &self.nodes
    }

    /// The conflicts: those that it began with, and those found since.
    pub fn conflicts(&self) -> &[Conflict] {
        &self.conflicts
    }

    /// The diagnoses found so far, each with its node.
    pub fn diagnoses(&self) -> impl Iterator<Item = (usize, &[ComponentId])> {
        let all = self.nodes.iter().enumerate();
        all.filter(|(_, node)| node.label == HittingLabel::Diagnosis)
            .map(|(at, node)| (at, node.without.as_slice()))
    }

    /// Returns whether no node is open: the diagnoses are then all there are.
    pub fn is_finished(&self) -> bool {
        self.nodes.iter().all(|node| node.label != HittingLabel::Open)
    }

    /// Lets a node become something. `modes` and `observation` are what the conflicts are between.
    pub fn apply(
        &mut self,
        at: usize,
        step: HittingMove,
        model: &Model,
        modes: &State,
        observation: &Observation,
    ) -> Result<(), Refusal> {
        let node = self.nodes.get(at).filter(|node| node.label == HittingLabel::Open);
        let without = node.ok_or(Refusal::Unknown)?.without.clone();
        match step {
            HittingMove::Expand(conflict) => self.expand(at, conflict, &without),
            HittingMove::Close => {
                let by = self.covering(at).ok_or(Refusal::NothingCovers)?;
                self.nodes[at].label = HittingLabel::Closed { by };
                Ok(())
            }
            HittingMove::Diagnose => {
                if let Some(conflict) = conflict_without(model, modes, observation, &without) {
                    return Err(Refusal::Contradicts(self.place_of(conflict)));
                }
                if let Some((by, _)) = self.diagnoses().find(|(_, known)| is_part(known, &without)) {
                    return Err(Refusal::NotMinimal { by });
                }
                // A tree that is not built level by level finds some diagnoses before their parts.
                for node in &mut self.nodes {
                    if node.label == HittingLabel::Diagnosis && is_part(&without, &node.without) {
                        node.label = HittingLabel::Closed { by: at };
                    }
                }
                self.nodes[at].label = HittingLabel::Diagnosis;
                Ok(())
            }
        }
    }

    /// Returns what a tree that is built level by level does next, and with which node; nothing if it is finished. A
    /// diagnosis may be refused: the conflict that contradicts it is then listed.
    pub fn next_move(&self) -> Option<(usize, HittingMove)> {
        let open = |(_, node): &(usize, &HittingNode)| node.label == HittingLabel::Open;
        let (at, node) =
            self.nodes.iter().enumerate().filter(open).min_by_key(|(_, node)| node.without.len())?;
        if self.covering(at).is_some() {
            return Some((at, HittingMove::Close));
        }
        let free = |conflict: &Conflict| !conflict.modes.iter().any(|(id, _)| node.without.contains(id));
        let conflict = self.conflicts.iter().position(free);
        Some((at, conflict.map_or(HittingMove::Diagnose, HittingMove::Expand)))
    }

    fn expand(&mut self, at: usize, conflict: usize, without: &[ComponentId]) -> Result<(), Refusal> {
        let components: Vec<ComponentId> =
            self.conflicts.get(conflict).ok_or(Refusal::Unknown)?.modes.iter().map(|(id, _)| *id).collect();
        if let Some(hit) = components.iter().find(|id| without.contains(id)) {
            return Err(Refusal::IsHit(*hit));
        }
        if self.nodes.len() + components.len() > MAX_NODES {
            return Err(Refusal::TooLarge);
        }
        self.nodes[at].label = HittingLabel::Conflict(conflict);
        for component in components {
            let mut without = without.to_vec();
            without.push(component);
            without.sort_unstable();
            self.nodes.push(HittingNode {
                parent: Some(at),
                without,
                component: Some(component),
                label: HittingLabel::Open,
            });
        }
        Ok(())
    }

    /// A node that covers another one: its diagnosis is a part of the other's path, or it came first with the same path.
    fn covering(&self, at: usize) -> Option<usize> {
        let without = &self.nodes.get(at)?.without;
        let diagnosis = self.diagnoses().find(|(_, known)| is_part(known, without)).map(|(node, _)| node);
        diagnosis.or_else(|| {
            let is_same = |node: &HittingNode| {
                node.without == *without && !matches!(node.label, HittingLabel::Closed { .. })
            };
            self.nodes[..at].iter().position(is_same)
        })
    }

    /// The place of a conflict in the list, to which it is added if it is new.
    fn place_of(&mut self, conflict: Conflict) -> usize {
        self.conflicts.iter().position(|known| known.modes == conflict.modes).unwrap_or_else(|| {
            self.conflicts.push(conflict);
            self.conflicts.len() - 1
        })
    }
}

/// Returns whether all components of `part` are among those of `whole`.
fn is_part(part: &[ComponentId], whole: &[ComponentId]) -> bool {
    part.iter().all(|component| whole.contains(component))
}
