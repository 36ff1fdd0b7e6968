//! The hitting-set tree that a student builds over the conflicts of a step, and how it agrees with the estimate.

use std::sync::{Arc, OnceLock};

use plant::hitting_sets::{HittingLabel, HittingMove, HittingTree, Refusal};
use plant::{ComponentId, Conflict, FactoredBelief, Model, Observation, State};

use super::automaton::{Moment, PlantMoment};

/// So many states of an estimate are compared with diagnoses.
const MAX_COMPARED: usize = 4096;

/// A tree that is being built, and what it is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnosing {
    /// What was expected: the modes that the commands lead to without faults.
    expected: State,
    observation: Observation,
    tree: HittingTree,
    /// What was refused last, with its node.
    refused: Option<(usize, Refusal)>,
}

/// How an estimate agrees with diagnoses.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// How many states were compared.
    pub states: usize,
    /// In how many of them the components that are not in their expected modes include a diagnosis.
    pub explained: usize,
    /// For each diagnosis the probability that exactly its components are not in their expected modes.
    pub probabilities: Vec<f64>,
}

/// The conflicts of a step: the tree before anything was built, and the diagnoses that the whole one has.
#[derive(Debug)]
pub struct StepConflicts {
    model: Arc<Model>,
    /// The moments before and after the step.
    between: [Arc<Moment>; 2],
    /// Nothing if the step has no conflicts.
    root: Option<Diagnosing>,
    /// Computed when it is first asked for: the tree may be large.
    diagnoses: OnceLock<Vec<(Vec<ComponentId>, f64)>>,
}

impl StepConflicts {
    /// The conflicts of the step from `before` to `after`.
    pub(super) fn new(model: &Arc<Model>, before: &Arc<Moment>, after: &Arc<Moment>) -> Self {
        let plants = before.plant.as_ref().zip(after.plant.as_ref());
        let root = plants.and_then(|(before, after)| Diagnosing::new(model, before, after));
        let between = [Arc::clone(before), Arc::clone(after)];
        Self { model: Arc::clone(model), between, root, diagnoses: OnceLock::new() }
    }

    /// Returns whether this is the step from `before` to `after`.
    pub(super) fn is_of(&self, model: &Arc<Model>, before: &Arc<Moment>, after: &Arc<Moment>) -> bool {
        let [first, last] = &self.between;
        Arc::ptr_eq(&self.model, model) && Arc::ptr_eq(first, before) && Arc::ptr_eq(last, after)
    }

    /// The root of the tree; nothing if the step has no conflicts.
    pub fn root(&self) -> Option<&Diagnosing> {
        self.root.as_ref()
    }

    /// All diagnoses, each with the probability that the estimate gives to exactly its faults.
    pub fn diagnoses(&self) -> &[(Vec<ComponentId>, f64)] {
        self.diagnoses.get_or_init(|| {
            let [_, after] = &self.between;
            let Some((root, plant)) = self.root.as_ref().zip(after.plant.as_ref()) else { return Vec::new() };
            let whole = root.finished(&self.model);
            let probabilities = whole.agreement(&self.model, &plant.belief).probabilities;
            let sets = whole.tree.diagnoses().map(|(_, set)| set.to_vec());
            sets.zip(probabilities).collect()
        })
    }
}

impl Diagnosing {
    /// The root of the tree over the conflicts of the step from `before` to `after`; nothing if there are none.
    fn new(model: &Model, before: &PlantMoment, after: &PlantMoment) -> Option<Self> {
        let record = after.record.as_ref().filter(|record| !record.conflicts.is_empty())?;
        let expected =
            plant::successor::nominal(model, before.belief.most_likely(), &record.commands).ok()?;
        let tree = HittingTree::new(record.conflicts.clone());
        Some(Self { expected, observation: record.observation.clone(), tree, refused: None })
    }

    /// Returns whether two trees are about the same expectations and observations.
    pub(super) fn is_about(&self, other: &Self) -> bool {
        self.expected == other.expected && self.observation == other.observation
    }

    /// The tree as far as it has been built.
    pub fn tree(&self) -> &HittingTree {
        &self.tree
    }

    /// Returns what was refused last, with its node.
    pub fn refused(&self) -> Option<&(usize, Refusal)> {
        self.refused.as_ref()
    }

    pub(super) fn apply(&mut self, model: &Model, node: usize, step: HittingMove) {
        let outcome = self.tree.apply(node, step, model, &self.expected, &self.observation);
        self.refused = outcome.err().map(|refusal| (node, refusal));
    }

    /// Does the next step of a tree that is built level by level.
    pub(super) fn apply_next(&mut self, model: &Model) {
        while let Some((node, step)) = self.tree.next_move() {
            self.apply(model, node, step);
            // A conflict that was found only now is used at once.
            if !matches!(self.refused.take(), Some((_, Refusal::Contradicts(_)))) {
                return;
            }
        }
    }

    /// The same, finished level by level from its root.
    fn finished(&self, model: &Model) -> Self {
        let mut whole = Self { tree: HittingTree::new(self.tree.conflicts().to_vec()), ..self.clone() };
        for _ in 0..plant::hitting_sets::MAX_NODES {
            whole.apply_next(model);
        }
        whole
    }

    /// Compares the diagnoses of the tree with an estimate.
    pub fn agreement(&self, model: &Model, belief: &FactoredBelief) -> Agreement {
        let diagnoses: Vec<&[ComponentId]> = self.tree.diagnoses().map(|(_, set)| set).collect();
        let mut agreement = Agreement { states: 0, explained: 0, probabilities: vec![0.0; diagnoses.len()] };
        for (state, probability) in belief.states().take(MAX_COMPARED) {
            let deviates = |id: &ComponentId| state.mode(*id) != self.expected.mode(*id);
            let deviating: Vec<ComponentId> = model.component_ids().filter(|id| deviates(id)).collect();
            agreement.states += 1;
            agreement.explained += usize::from(diagnoses.iter().any(|set| set.iter().all(deviates)));
            if let Some(at) = diagnoses.iter().position(|set| **set == *deviating) {
                agreement.probabilities[at] += probability.to_f64().0;
            }
        }
        agreement
    }
}

/// The assumptions of a conflict as a set: `{LampA = Good, LampB = Good}`.
pub fn conflict_text(model: &Model, conflict: &Conflict) -> String {
    let assumption = |&(id, mode): &(ComponentId, u8)| {
        format!("{} = {}", component_name(model, id), model.mode_name(id, mode))
    };
    format!("{{{}}}", conflict.modes.iter().map(assumption).collect::<Vec<_>>().join(", "))
}

/// The observations that a conflict contradicts: `LampA.light = dark`.
pub fn observations_text(model: &Model, conflict: &Conflict) -> String {
    let observed = conflict.observations.iter().filter_map(|(id, value)| {
        let variable = model.variables.get(id.0 as usize)?;
        Some(format!("{} = {}", variable.name, variable.values.get(usize::from(*value))?))
    });
    observed.collect::<Vec<_>>().join(", ")
}

/// A set of components: `{LampA, Battery}`.
pub fn set_text(model: &Model, components: &[ComponentId]) -> String {
    let names: Vec<&str> = components.iter().map(|&id| component_name(model, id)).collect();
    format!("{{{}}}", names.join(", "))
}

/// Returns what became of a node, in words.
pub fn label_text(model: &Model, tree: &HittingTree, label: HittingLabel) -> String {
    match label {
        HittingLabel::Open => "open".to_owned(),
        HittingLabel::Conflict(at) => format!("conflict {}", at + 1),
        HittingLabel::Diagnosis => "diagnosis".to_owned(),
        HittingLabel::Closed { by } => {
            let by = tree.nodes().get(by).map(|node| set_text(model, &node.without)).unwrap_or_default();
            format!("closed: covered by {by}")
        }
    }
}

/// Returns why a node cannot become what someone wanted, and what to do.
pub fn refusal_text(model: &Model, tree: &HittingTree, refusal: &Refusal) -> String {
    match refusal {
        Refusal::Unknown => "This node is no longer open. Choose an open one.".to_owned(),
        Refusal::IsHit(component) => {
            let name = component_name(model, *component);
            format!("The path already has {name}, which this conflict contains. Choose a conflict without it.")
        }
        Refusal::NothingCovers => {
            "Nothing covers this node: no diagnosis is a part of its path, and no earlier node has the same path."
                .to_owned()
        }
        Refusal::Contradicts(at) => {
            format!("Not a diagnosis: all assumptions of conflict {} are still made. Expand the node by it.", at + 1)
        }
        Refusal::NotMinimal { by } => {
            let by = tree.nodes().get(*by).map(|node| set_text(model, &node.without)).unwrap_or_default();
            format!("Not minimal: {by} is a diagnosis already. Close this node.")
        }
        Refusal::TooLarge => "The tree is too large. Restart it, and expand by smaller conflicts.".to_owned(),
    }
}

fn component_name(model: &Model, id: ComponentId) -> &str {
    model.component(id).map_or("?", |component| component.name.as_str())
}
