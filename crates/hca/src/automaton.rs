//! The automaton as flat data with typed indices (SPEC 8.1).

use std::collections::BTreeMap;
use std::ops::Range;

use exact::Rational;
use rmpl::Span;
use rmpl::control::Guard;
use serde::{Deserialize, Serialize};
use smol_str::{SmolStr, format_smolstr};

use crate::clock::{Clock, ClockId, HeldCondition};
use crate::condition::Condition;
use crate::knowledge::Estimate;
use crate::locks::{Lock, LockId};
use crate::marking::Marking;
use crate::vocabulary::{Variable, VariableId};

/// Index of a primitive location.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LocationId(pub u32);

/// Index of a composite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CompositeId(pub u32);

/// Index of a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct TransitionId(pub u32);

/// Index of a compiled condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct TestId(pub u32);

/// A location or a composite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Element {
    /// A primitive location.
    Location(LocationId),
    Composite(CompositeId),
}

/// What a primitive location waits for or does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LocationKind {
    /// Asserts a constraint until it holds.
    Assert,
    /// Starts its body at every step.
    Always,
    /// Chooses between two bodies, once.
    If,
    /// Starts its body once unless something holds.
    Unless,
    /// Starts its body the first time that its condition holds.
    When,
    /// Waits again and again.
    Whenever,
    /// Lets time pass.
    Wait,
    /// Starts its body at a time of the program.
    At,
    /// Starts its body again and again.
    Every,
    /// Waits for a lock.
    Lock,
    /// Counts a reward.
    Reward,
}

/// A condition compiled, with the text of its guard.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Test {
    /// The guard as written.
    pub guard: Guard,
    /// With HELD: what has to have lasted, as an index into [`Automaton::held`].
    pub held: Option<u32>,
    pub(crate) condition: Condition,
}

/// What a location asserts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Assertion {
    /// The constraint, which is never a non-entailment.
    pub test: TestId,
    /// The goals that it states: one per equality of a conjunction, or the constraint as a whole.
    pub goals: Vec<SmolStr>,
    /// What it sets of the program's own variables, as variable and value number.
    pub program_settings: Vec<(VariableId, u32)>,
}

/// A primitive location.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Location {
    pub kind: LocationKind,
    /// How traces and drawings call it, such as `assert Camera=Off` or `when (…)`.
    pub label: SmolStr,
    /// What it asserts; `None` when it only waits.
    pub assertion: Option<Assertion>,
    /// What it waits for, if it is a time.
    pub clock: Option<ClockId>,
    /// What it counts in each step in which it is marked.
    pub reward: Option<Rational>,
    /// Its transitions, as indices into [`Automaton::transitions`].
    pub transitions: Range<u32>,
    /// The composite that directly holds it.
    pub parent: CompositeId,
    /// Where its expression is written.
    pub span: Span,
}

/// Which form a composite comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CompositeKind {
    /// The whole program.
    Program,
    /// `PARALLEL`.
    Parallel,
    /// `SEQUENCE`: when a child ends, the next starts.
    Sequence,
    /// `DO-WATCHING`: has a maintenance condition.
    DoWatching,
    /// A location and the bodies that it starts: `ALWAYS`, `IF…`, `UNLESS…`, `WHEN…`, `WHENEVER…`, `AT`, `EVERY`.
    Guarded,
    /// `TIMEOUT` and `WITHIN`: has a clock; the first child is dropped when it is up, and the second, if any, starts.
    Timeout,
    /// `LOCK`: a location that waits, one that asserts what is locked, and what is done meanwhile.
    Lock,
    /// `CHOOSE-PROB` and `CHOOSE-REWARD`: a start starts one of the children.
    Choice,
}

/// A composite: an automaton inside the automaton.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Composite {
    /// Which form it comes from.
    pub kind: CompositeKind,
    /// The composite that directly holds it; `None` for the whole program.
    pub parent: Option<CompositeId>,
    /// What it directly holds, in textual order.
    pub children: Vec<Element>,
    /// The locations that are marked when it starts (Θ); that of AT only until its time has come.
    pub start: Vec<LocationId>,
    /// When what it does first is dropped.
    pub clock: Option<ClockId>,
    /// What must hold for it to stay active (M); for `(DO-WATCHING c e)` the non-entailment of `c`.
    pub maintenance: Option<TestId>,
    /// All locations below it; locations are numbered so that they form a range.
    pub locations: Range<u32>,
    /// Where its expression is written.
    pub span: Span,
}

/// A transition from a location to what it starts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Transition {
    /// The location that it leaves.
    pub source: LocationId,
    /// What must hold; `None` for always.
    pub guard: Option<TestId>,
    /// What it starts.
    pub target: Element,
}

/// A control program compiled.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Automaton {
    pub variables: Vec<Variable>,
    /// The numbers of the variables by their names.
    pub(crate) by_name: BTreeMap<SmolStr, VariableId>,
    /// Its conditions.
    pub tests: Vec<Test>,
    /// Its primitive locations (Σp).
    pub locations: Vec<Location>,
    /// Its composites (Σc); the first is the whole program, parents come before children.
    pub composites: Vec<Composite>,
    /// Its transitions, grouped by source.
    pub transitions: Vec<Transition>,
    /// Its clocks, in textual order.
    pub clocks: Vec<Clock>,
    /// The conditions that have to have lasted.
    pub held: Vec<HeldCondition>,
    /// Its locks, in textual order.
    pub locks: Vec<Lock>,
    /// Its choices by chance and by rewards, in textual order.
    pub choices: Vec<Choice>,
    /// For each composite, what starting it does.
    pub(crate) starts: Vec<Start>,
    /// For each composite, the composites with maintenance that it is in, itself not included.
    pub(crate) watched_by: Vec<Vec<CompositeId>>,
}

/// One of the children of a composite is to be started.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choice {
    pub composite: CompositeId,
    pub by: ChosenBy,
}

/// What decides a choice.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChosenBy {
    /// `CHOOSE-PROB`: the weights of the children; they sum to the common denominator of the probabilities.
    Chance(Vec<u64>),
    /// `CHOOSE-REWARD`: what counts when a child completes.
    Reward(Vec<Rational>),
}

impl Choice {
    /// The alternative that is taken where neither chance nor a plant decides: the most likely one, or that with the largest
    /// reward; of several the first.
    pub fn first_best(&self) -> usize {
        match &self.by {
            ChosenBy::Chance(weights) => first_largest(weights),
            ChosenBy::Reward(rewards) => first_largest(rewards),
        }
    }

    /// Returns what counts when a child completes, if that decides the choice.
    pub fn rewards(&self) -> Option<&[Rational]> {
        match &self.by {
            ChosenBy::Chance(_) => None,
            ChosenBy::Reward(rewards) => Some(rewards),
        }
    }
}

fn first_largest<Value: Ord>(values: &[Value]) -> usize {
    let most = values.iter().max();
    values.iter().position(|value| Some(value) == most).unwrap_or(0)
}

/// What starting an element does.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Start {
    /// These are marked.
    pub(crate) locations: Vec<LocationId>,
    /// These clocks count from now.
    pub(crate) clocks: Vec<ClockId>,
    /// These composites of AT start what they wait for if its time has come, and otherwise wait.
    pub(crate) timed: Vec<CompositeId>,
    /// These locks are waited for.
    pub(crate) locks: Vec<LockId>,
    /// Of the children of these composites one is to be chosen.
    pub(crate) choices: Vec<CompositeId>,
}

impl Start {
    /// Returns whether it does more than marking locations.
    pub(crate) const fn is_timed(&self) -> bool {
        !(self.clocks.is_empty() && self.timed.is_empty() && self.locks.is_empty() && self.choices.is_empty())
    }

    pub(crate) fn extend(&mut self, other: &Self) {
        self.locations.extend(&other.locations);
        self.clocks.extend(&other.clocks);
        self.timed.extend(&other.timed);
        self.locks.extend(&other.locks);
        self.choices.extend(&other.choices);
    }
}

impl Automaton {
    /// The program as a whole.
    pub const ROOT: CompositeId = CompositeId(0);

    /// The location of this id, if the automaton has it.
    pub fn location(&self, id: LocationId) -> Option<&Location> {
        self.locations.get(id.0 as usize)
    }

    /// The composite of this id, if the automaton has it.
    pub fn composite(&self, id: CompositeId) -> Option<&Composite> {
        self.composites.get(id.0 as usize)
    }

    /// A condition's guard as written.
    pub fn guard(&self, id: TestId) -> Option<&Guard> {
        self.tests.get(id.0 as usize).map(|test| &test.guard)
    }

    /// The choice of a composite, if it is one.
    pub fn choice(&self, composite: CompositeId) -> Option<&Choice> {
        self.choices.iter().find(|choice| choice.composite == composite)
    }

    /// Returns what the marked locations count in one step.
    pub fn reward(&self, marking: &Marking) -> Rational {
        let rewards = marking.iter().filter_map(|location| self.location(location)?.reward);
        rewards.fold(Rational::ZERO, |sum, reward| sum.checked_add(reward).unwrap_or(sum))
    }

    /// The clock of this id, if the automaton has it.
    pub fn clock(&self, id: ClockId) -> Option<&Clock> {
        self.clocks.get(id.0 as usize)
    }

    /// The locations of an element.
    pub(crate) fn locations_of(&self, element: Element) -> Range<u32> {
        match element {
            Element::Location(location) => location.0..location.0 + 1,
            Element::Composite(composite) => {
                self.composite(composite).map_or(0..0, |composite| composite.locations.clone())
            }
        }
    }

    /// Returns what a transition waits for, in drawings: its guard, or that the time of its location is up.
    pub fn condition_text(&self, transition: &Transition) -> String {
        if let Some(guard) = transition.guard.and_then(|guard| self.guard(guard)) {
            return guard.to_string();
        }
        let is_timed = self.location(transition.source).is_some_and(|source| source.clock.is_some());
        let leaves = transition.target != Element::Location(transition.source);
        if is_timed && leaves { "time is up".to_owned() } else { "true".to_owned() }
    }

    /// Returns what drawings call a composite with a clock, a lock or a choice.
    pub fn title(&self, id: CompositeId) -> Option<SmolStr> {
        let composite = self.composite(id)?;
        match composite.kind {
            CompositeKind::Timeout => Some(self.clock(composite.clock?)?.label.clone()),
            CompositeKind::Lock => Some(self.locks.iter().find(|lock| lock.composite == id)?.label.clone()),
            CompositeKind::Choice => {
                let weights = match &self.choice(id)?.by {
                    ChosenBy::Chance(weights) => weights,
                    ChosenBy::Reward(rewards) => {
                        let rewards: Vec<String> = rewards.iter().map(Rational::to_string).collect();
                        return Some(format_smolstr!("choose by reward {}", rewards.join(", ")));
                    }
                };
                let total: u64 = weights.iter().sum();
                let share = |weight: &u64| {
                    Rational::from_wide(i128::from(*weight), i128::from(total)).unwrap_or(Rational::ZERO)
                };
                let shares: Vec<String> = weights.iter().map(|weight| share(weight).to_string()).collect();
                Some(format_smolstr!("choose {}", shares.join(", ")))
            }
            _ => None,
        }
    }

    /// The locations that are marked when an element starts.
    pub fn start_of<'data>(&'data self, element: &'data Element) -> &'data [LocationId] {
        match element {
            Element::Location(location) => std::slice::from_ref(location),
            Element::Composite(composite) => {
                self.composite(*composite).map_or(&[], |composite| composite.start.as_slice())
            }
        }
    }

    /// The marking in which the program starts: Θ of the whole.
    pub fn start(&self) -> Marking {
        let mut marking = Marking::empty(self.locations.len());
        for &location in self.start_of(&Element::Composite(Self::ROOT)) {
            marking.insert(location);
        }
        marking
    }

    /// Returns whether any location below a composite is marked.
    pub fn is_active(&self, composite: CompositeId, marking: &Marking) -> bool {
        self.composite(composite).is_some_and(|composite| marking.intersects(&composite.locations))
    }

    /// The number of the variable called `name`.
    pub fn variable(&self, name: &str) -> Option<VariableId> {
        self.by_name.get(name).copied()
    }

    /// An estimate that knows the named values; variables that the program does not speak of are left out.
    pub fn estimate<'name>(&self, known: impl IntoIterator<Item = (&'name str, &'name str)>) -> Estimate {
        let mut estimate = Estimate::unknown(self.variables.len());
        for (name, value) in known {
            if let Some(id) = self.variable(name) {
                estimate.set(
                    id,
                    self.variables.get(id.0 as usize).and_then(|variable| variable.value_number(value)),
                );
            }
        }
        estimate
    }

    /// The goals of a marking, each once, in alphabetical order.
    pub fn goals(&self, marking: &Marking) -> Vec<SmolStr> {
        let mut goals: Vec<SmolStr> = marking
            .iter()
            .filter_map(|location| self.location(location)?.assertion.as_ref())
            .flat_map(|assertion| assertion.goals.iter().cloned())
            .collect();
        goals.sort();
        goals.dedup();
        goals
    }

    /// The labels of a marking's locations in alphabetical order.
    pub fn labels(&self, marking: &Marking) -> Vec<SmolStr> {
        let mut labels: Vec<SmolStr> =
            marking.iter().filter_map(|location| Some(self.location(location)?.label.clone())).collect();
        labels.sort();
        labels
    }

    /// The name of a location in drawings and JSON: `a1`, `w2`, and so on by kind in textual order.
    pub fn location_name(&self, id: LocationId) -> String {
        let letter = |kind: LocationKind| match kind {
            LocationKind::Assert => 'a',
            LocationKind::Always => 'l',
            LocationKind::If | LocationKind::Unless => 'i',
            LocationKind::When | LocationKind::Whenever => 'w',
            LocationKind::Wait | LocationKind::At | LocationKind::Every => 't',
            LocationKind::Lock => 'k',
            LocationKind::Reward => 'r',
        };
        let Some(location) = self.location(id) else { return String::new() };
        let mine = letter(location.kind);
        let number =
            self.locations.iter().take(id.0 as usize + 1).filter(|other| letter(other.kind) == mine).count();
        format!("{mine}{number}")
    }
}
