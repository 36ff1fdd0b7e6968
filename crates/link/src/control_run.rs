//! A control program as it runs: what comes from outside, and how things stand between its steps.
//!
//! A run is asked for by its inputs. The front end holds the moments that were answered, and gets the others.

use std::collections::BTreeMap;
use std::sync::Arc;

use executive::model_based::{StepInput, StepRecord};
use hca::{Automaton, Marking, TraceStep};
use plant::{Commands, FactoredBelief, Model, State, StepBranches};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use snapshot::ContentKey;

use crate::Source;

/// A run that is wanted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlRun {
    /// Comes back with the answers.
    pub token: u64,
    /// The revision of the text.
    pub revision: u64,
    pub source: Source,
    /// The plant that a program without one of its own is bound to.
    pub plant: Option<Arc<str>>,
    /// With a seed, components fail by chance.
    pub seed: Option<u64>,
    /// What comes from outside in each step, from the first.
    pub inputs: Vec<Input>,
    /// The program that the asker holds.
    pub held_program: ContentKey,
    /// The run that the asker holds moments of.
    pub held_run: ContentKey,
    /// How many moments of that run the asker holds, from the first, that these inputs lead to.
    pub held: u32,
}

/// How a run stands: some moments of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlStanding {
    /// That of the request.
    pub token: u64,
    pub run: ContentKey,
    pub program: ContentKey,
    /// The program, unless the asker holds it.
    pub content: Option<ControlProgram>,
    /// The number of the first of these moments, from 0; the asker holds those before.
    pub first: u32,
    /// The moments from there on.
    pub moments: Vec<Moment>,
    /// How many moments there will be in all, unless the program ends before.
    pub wanted: u32,
    /// Whether these are all; otherwise more will come.
    pub is_complete: bool,
    /// Why the last step could not be taken.
    pub trouble: Option<String>,
}

/// What a control text comes to, for showing it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ControlProgram {
    /// A program and the plant that it controls.
    Bound { automaton: Arc<Automaton>, model: Arc<Model> },
    /// A program alone: what is known of its variables is typed in.
    Unbound(Arc<Automaton>),
    /// A plant without a program.
    Plant(Arc<Model>),
    /// A text with errors.
    Broken,
}

/// What comes from outside in one step.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Faults and observations, if there is a plant.
    pub plant: StepInput,
    /// What is known of the program's variables, if there is none.
    pub known: BTreeMap<u32, u32>,
}

/// How things stand between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// What is marked.
    pub marking: Marking,
    /// The marked locations, goals and labels of the next step.
    pub upcoming: TraceStep,
    /// What the automaton did in the step that led here; nothing at the start.
    pub taken: Option<TraceStep>,
    /// The plant, if there is one.
    pub plant: Option<PlantMoment>,
}

/// How the plant is between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlantMoment {
    /// What is believed.
    pub belief: FactoredBelief,
    pub true_state: State,
    /// The step that led here; nothing at the start.
    pub record: Option<StepRecord>,
    /// How the belief came from the one before that step; nothing at the start.
    pub branches: Option<StepBranches>,
    /// The commands of the next step; nothing after the end.
    pub next_commands: Option<Commands>,
    /// The goals that the next step does not pursue, with the reasons.
    pub unachievable: Vec<(SmolStr, String)>,
}

impl ControlProgram {
    /// The automaton, if there is one.
    pub const fn automaton(&self) -> Option<&Arc<Automaton>> {
        match self {
            Self::Bound { automaton, .. } | Self::Unbound(automaton) => Some(automaton),
            Self::Plant(_) | Self::Broken => None,
        }
    }

    /// The plant, if there is one.
    pub const fn model(&self) -> Option<&Arc<Model>> {
        match self {
            Self::Bound { model, .. } | Self::Plant(model) => Some(model),
            Self::Unbound(_) | Self::Broken => None,
        }
    }

    /// Returns whether the inputs of steps refer to the same things by number in both.
    pub fn has_names_of(&self, other: &Self) -> bool {
        self.names() == other.names()
    }

    fn names(&self) -> Vec<String> {
        let mut names = Vec::new();
        if let Some(model) = self.model() {
            let modes = |component: &plant::Component| {
                component.modes.iter().map(|mode| mode.name.clone()).collect::<Vec<_>>()
            };
            names.extend(model.components.iter().map(|it| format!("{} {:?}", it.name, modes(it))));
            names.extend(model.variables.iter().map(|it| format!("{} {:?}", it.name, it.values)));
        } else if let Some(automaton) = self.automaton() {
            names.extend(automaton.variables.iter().map(|it| format!("{} {:?}", it.name, it.values)));
        }
        names
    }
}
