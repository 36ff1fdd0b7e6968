//! What all declarations together declare and use, counted per name, so that one declaration can be exchanged.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use rustc_hash::FxHashMap;
use smol_str::SmolStr;

use super::alike::Alphabet;
use super::names::{Names, Symbol};
use super::summary::{ComponentState, Definition, Equipment, Literal, Origin, Summary, UseKind};
use crate::program::LabelMode;

/// A declaration, as long as it is not parsed again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct DeclarationKey(pub(crate) u32);

impl DeclarationKey {
    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Names of different kinds do not meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Namespace {
    /// Activities and primitives.
    Callable,
    Variable,
    Scenario,
    Option,
    Terrain,
    Location,
    Obstacle,
    Vehicle,
    Constant,
    Resource,
    Objective,
    /// What `as` names inside a declaration.
    Occurrence,
    /// Vehicle models.
    Model,
    /// Groups and fleets.
    Group,
}

impl Namespace {
    pub(crate) const COUNT: usize = 14;

    /// A set of namespaces with this one alone.
    pub(crate) const fn bit(self) -> u16 {
        1 << self as u8
    }
}

/// A condition that something in the file asserts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Told {
    pub(crate) value: Option<Symbol>,
    pub(crate) negated: bool,
    /// It is written `X_V`, and is about `X` only if the file makes it so.
    pub(crate) is_split: bool,
    /// A parameter represents the value.
    pub(crate) is_any: bool,
    /// It keeps a watched condition away, which asserts nothing of a state variable.
    pub(crate) is_watched: bool,
}

/// What a file says about one name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facts {
    pub(crate) definitions: Vec<(Namespace, DeclarationKey)>,
    pub(crate) calls: u32,
    pub(crate) arguments: u32,
    pub(crate) starts: u32,
    pub(crate) vehicles: u32,
    /// Uses as a number in an expression.
    pub(crate) numbers: u32,
    /// Uses as the place of a vehicle.
    pub(crate) places: u32,
    /// Uses as a resource.
    pub(crate) resources: u32,
    /// Occurrences that it names.
    pub(crate) occurrences: u32,
    /// Bounds between events that name such an occurrence.
    pub(crate) constraints: u32,
    /// Conditions about the name, those written `X_V` included.
    pub(crate) literals: u32,
    /// Conditions that compare it with a value.
    pub(crate) compared: u32,
    /// What is asserted of it, each with how often.
    pub(crate) told: BTreeMap<Told, u32>,
    definition_fingerprint: u64,
    told_fingerprint: u64,
    changed_at: u32,
}

/// What the check of a declaration can see of a name.
type Visible = (u64, u64, [bool; 11]);

impl Facts {
    fn visible(&self) -> Visible {
        let uses = [
            self.calls,
            self.arguments,
            self.starts,
            self.vehicles,
            self.numbers,
            self.places,
            self.resources,
            self.occurrences,
            self.constraints,
            self.literals,
            self.compared,
        ];
        let used = uses.map(|count| count > 0);
        (self.definition_fingerprint, self.told_fingerprint, used)
    }

    pub(crate) fn definition(&self, namespace: Namespace) -> Option<DeclarationKey> {
        self.definitions.iter().find(|(found, _)| *found == namespace).map(|&(_, key)| key)
    }
}

/// Of more names than this, only those are compared with a written one that begin or end like it: what one mistake costs
/// is bounded, however many names there are.
pub(crate) const MAX_COMPARED: usize = 256;

/// All facts of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Index {
    facts: Vec<Facts>,
    /// The definitions of each declaration, by key.
    definitions: Vec<Vec<Definition>>,
    revision: u32,
    pub(crate) scenarios: u32,
    strict: u32,
    /// Assertions whose variable is a parameter: they may be about anything.
    pub(crate) told_of_formals: u32,
    /// How many literals are about what a parameter represents.
    pub(crate) literals_of_formals: u32,
    /// Movements of vehicles that parameters represent: they may take any vehicle anywhere.
    pub(crate) moves_of_formals: u32,
    /// Declarations in which the environment chooses some duration.
    contingents: u32,
    global_changed_at: u32,
    /// The names defined in each namespace, in no order.
    defined: [BTreeSet<Symbol>; Namespace::COUNT],
    /// The same in alphabetical order, from when a similar name is looked for until they change.
    alphabets: [OnceLock<Alphabet>; Namespace::COUNT],
    /// Of names that several declarations define, the one that comes first.
    first_of_rivals: FxHashMap<(Namespace, Symbol), DeclarationKey>,
    /// What components of the plant can be, by their states' names.
    components: FxHashMap<Symbol, ComponentState>,
    /// The components of each block that has some.
    components_by_block: FxHashMap<DeclarationKey, Vec<ComponentState>>,
    /// Whether blocks with components have come or gone since the components were found.
    components_changed: bool,
    /// The declarations of states that are read from the plant.
    states_of_plant: BTreeSet<DeclarationKey>,
    names_changed_at: [u32; Namespace::COUNT],
    last_change: u32,
    calls_changed: bool,
    free_keys: Vec<DeclarationKey>,
}

impl Index {
    pub(crate) fn facts(&self, symbol: Symbol) -> &Facts {
        static NOTHING: Facts = Facts {
            definitions: Vec::new(),
            calls: 0,
            arguments: 0,
            starts: 0,
            vehicles: 0,
            numbers: 0,
            places: 0,
            resources: 0,
            occurrences: 0,
            constraints: 0,
            literals: 0,
            compared: 0,
            told: BTreeMap::new(),
            definition_fingerprint: 0,
            told_fingerprint: 0,
            changed_at: 0,
        };
        self.facts.get(symbol.index()).unwrap_or(&NOTHING)
    }

    /// Returns whether the plant has a component with a state of this name.
    pub(crate) fn has_component(&self, state: Symbol) -> bool {
        self.components.contains_key(&state)
    }

    /// The names of the states of the plant's components, in no order.
    pub(crate) fn components(&self) -> impl Iterator<Item = Symbol> + '_ {
        self.components.keys().copied()
    }

    pub(crate) const fn is_strict(&self) -> bool {
        self.strict > 0
    }

    /// Returns whether the environment chooses some duration of the file.
    pub(crate) const fn has_contingents(&self) -> bool {
        self.contingents > 0
    }

    pub(crate) const fn revision(&self) -> u32 {
        self.revision
    }

    pub(crate) fn new_key(&mut self) -> DeclarationKey {
        if let Some(key) = self.free_keys.pop() {
            return key;
        }
        self.definitions.push(Vec::new());
        DeclarationKey(self.definitions.len() as u32 - 1)
    }

    /// Takes back keys of declarations that are gone.
    pub(crate) fn release(&mut self, keys: Vec<DeclarationKey>) {
        self.free_keys.extend(keys);
    }

    /// Returns how many keys were ever given out.
    pub(crate) fn keys(&self) -> usize {
        self.definitions.len()
    }

    /// The definition of `symbol` that counts: the first in the text.
    pub(crate) fn definition(&self, namespace: Namespace, symbol: Symbol) -> Option<&Definition> {
        let own = self.definitions.get(self.first_key(namespace, symbol)?.index())?;
        own.iter().find(|definition| definition.namespace == namespace && definition.name == symbol)
    }

    /// Returns what a name with a dot, such as `R1.battery`, is in the vehicle's model or in one that it extends.
    pub(crate) fn equipment(&self, names: &Names, symbol: Symbol) -> Option<&Equipment> {
        let (owner, part) = names.text(symbol).split_once('.')?;
        let part = names.find(part)?;
        let vehicle = self.definition(Namespace::Vehicle, names.find(owner)?)?;
        self.lineage(vehicle.model?).find_map(|model| model.equipment.iter().find(|own| own.name == part))
    }

    /// The declared models that make up this one, itself first.
    pub(crate) fn lineage(&self, model: Symbol) -> impl Iterator<Item = &Definition> {
        // A circle is an error of its own.
        let declared = self.defined(Namespace::Model).len();
        let next = |definition: &&Definition| self.definition(Namespace::Model, definition.model?);
        std::iter::successors(self.definition(Namespace::Model, model), next).take(declared)
    }

    pub(crate) fn first_key(&self, namespace: Namespace, symbol: Symbol) -> Option<DeclarationKey> {
        let mut found = self.facts(symbol).definitions.iter().filter(|(found, _)| *found == namespace);
        let &(_, only) = found.next()?;
        if found.next().is_none() {
            return Some(only);
        }
        self.first_of_rivals.get(&(namespace, symbol)).copied()
    }

    /// Finds out which declaration of each name and of each component comes first; `keys` are those of all declarations,
    /// in textual order.
    pub(crate) fn find_rivals(&mut self, keys: impl Iterator<Item = DeclarationKey> + Clone) {
        if std::mem::take(&mut self.components_changed) {
            self.find_components(keys.clone());
        }
        self.fill_states_of_plant();
        self.first_of_rivals.clear();
        for key in keys {
            for definition in self.definitions.get(key.index()).into_iter().flatten() {
                let named = (definition.namespace, definition.name);
                let rivals =
                    self.facts.get(definition.name.index()).map_or(0, |facts| facts.definitions.len());
                if rivals > 1 {
                    self.first_of_rivals.entry(named).or_insert(key);
                }
            }
        }
    }

    /// All names defined in `namespace`, in no order.
    pub(crate) const fn defined(&self, namespace: Namespace) -> &BTreeSet<Symbol> {
        &self.defined[namespace as usize]
    }

    /// The name defined in `namespace` that `written` was probably meant to be.
    pub(crate) fn nearest(&self, names: &Names, written: Symbol, namespace: Namespace) -> Option<SmolStr> {
        let defined = self.defined(namespace);
        if defined.len() <= MAX_COMPARED {
            return names.nearest(written, defined.iter().copied());
        }
        let alphabet =
            self.alphabets[namespace as usize].get_or_init(|| Alphabet::new(names, defined.iter().copied()));
        names.nearest(written, alphabet.around(names, names.text(written)))
    }

    /// Returns whether something that the check depended on has changed since revision `at`.
    pub(crate) fn is_stale(&self, summary: &Summary, at: u32, depends_on_names: u16) -> bool {
        let newer = |symbol: Symbol| self.facts(symbol).changed_at > at;
        let has_new_names = |(namespace, &changed_at): (usize, &u32)| {
            depends_on_names & (1 << namespace) != 0 && changed_at > at
        };
        self.global_changed_at > at
            || self.names_changed_at.iter().enumerate().any(has_new_names)
            || summary.symbols().any(newer)
    }

    /// Returns whether the last exchange changed anything that checks of other declarations can see.
    pub(crate) const fn has_changed(&self) -> bool {
        self.last_change == self.revision
    }

    /// Returns whether who calls whom has changed since this was asked last.
    pub(crate) fn take_calls_changed(&mut self) -> bool {
        std::mem::take(&mut self.calls_changed)
    }

    /// Exchanges declarations, and notes what changed for the others.
    pub(crate) fn exchange<'a>(
        &mut self,
        names: &Names,
        old: impl Iterator<Item = (DeclarationKey, &'a Summary)> + Clone,
        new: impl Iterator<Item = (DeclarationKey, &'a Summary)> + Clone,
    ) {
        self.revision += 1;
        self.facts.resize_with(names.len(), Facts::default);
        let is_first = self.revision == 1;
        let mut touched: Vec<Symbol> = Vec::new();
        if !is_first {
            touched.extend(old.clone().chain(new.clone()).flat_map(|(_, summary)| summary.symbols()));
            touched.sort_unstable();
            touched.dedup();
        }
        let before: Vec<Visible> = touched.iter().map(|&symbol| self.facts(symbol).visible()).collect();
        let global_before = self.globals();
        if old.clone().chain(new.clone()).any(|(_, summary)| summary.equips()) {
            self.global_changed_at = self.revision;
            self.last_change = self.revision;
        }
        let names_before = names_defined(old.clone());
        let names_after = names_defined(new.clone());
        for (namespace, changed_at) in self.names_changed_at.iter_mut().enumerate() {
            if names_before[namespace] != names_after[namespace] {
                *changed_at = self.revision;
                self.last_change = self.revision;
                self.alphabets[namespace].take();
            }
        }
        let calls_before = fingerprint_of_calls(old.clone());
        self.calls_changed |= is_first || calls_before != fingerprint_of_calls(new.clone());
        for (key, summary) in old {
            self.count(key, summary, false);
        }
        for (key, summary) in new {
            self.count(key, summary, true);
        }
        for (symbol, before) in touched.into_iter().zip(before) {
            let after = self.facts(symbol).visible();
            if before.0 != after.0 {
                self.calls_changed = true;
            }
            if before != after
                && let Some(facts) = self.facts.get_mut(symbol.index())
            {
                facts.changed_at = self.revision;
                self.last_change = self.revision;
            }
        }
        if global_before != self.globals() {
            self.global_changed_at = self.revision;
            self.last_change = self.revision;
        }
    }

    /// Finds out what the plant is made of: of components with one name the first in the text counts.
    fn find_components(&mut self, keys: impl Iterator<Item = DeclarationKey>) {
        let mut components: FxHashMap<Symbol, ComponentState> = FxHashMap::default();
        for component in keys.filter_map(|key| self.components_by_block.get(&key)).flatten() {
            components.entry(component.name).or_insert_with(|| component.clone());
        }
        let before = std::mem::replace(&mut self.components, components);
        let has_same_names = before.len() == self.components.len()
            && before.keys().all(|name| self.components.contains_key(name));
        // Components that are missing are told by those that are there.
        if !has_same_names && !self.states_of_plant.is_empty() {
            self.global_changed_at = self.revision;
            self.last_change = self.revision;
        }
    }

    /// Gives states that are read from the plant the modes of their components, as these are now.
    fn fill_states_of_plant(&mut self) {
        for key in &self.states_of_plant {
            let own = self.definitions.get_mut(key.index());
            let Some(definition) = own.and_then(|own| own.first_mut()) else { continue };
            let component = self.components.get(&definition.name);
            let initial = component.map(|component| component.initial);
            let values = component.map_or(&[][..], |component| component.modes.as_slice());
            if definition.values != values || definition.initial != initial {
                (definition.values, definition.initial) = (values.to_vec(), initial);
                self.facts[definition.name.index()].changed_at = self.revision;
                self.last_change = self.revision;
            }
        }
    }

    /// Returns what every check can see.
    const fn globals(&self) -> [bool; 6] {
        [
            self.scenarios > 0,
            self.strict > 0,
            self.told_of_formals > 0,
            self.literals_of_formals > 0,
            self.moves_of_formals > 0,
            self.contingents > 0,
        ]
    }

    /// Adds what `summary` says, or takes it away.
    fn count(&mut self, key: DeclarationKey, summary: &Summary, is_added: bool) {
        let step = |count: &mut u32| {
            *count = if is_added { *count + 1 } else { count.saturating_sub(1) };
        };
        for definition in summary.definitions() {
            let facts = &mut self.facts[definition.name.index()];
            let was_defined = facts.definition(definition.namespace).is_some();
            if is_added {
                facts.definitions.push((definition.namespace, key));
                facts.definition_fingerprint =
                    facts.definition_fingerprint.wrapping_add(definition.fingerprint);
            } else {
                facts.definitions.retain(|&other| other != (definition.namespace, key));
                facts.definition_fingerprint =
                    facts.definition_fingerprint.wrapping_sub(definition.fingerprint);
            }
            if was_defined != facts.definition(definition.namespace).is_some() {
                let namespace = definition.namespace as usize;
                if is_added {
                    self.defined[namespace].insert(definition.name);
                } else {
                    self.defined[namespace].remove(&definition.name);
                }
            }
            if definition.namespace == Namespace::Scenario {
                step(&mut self.scenarios);
            }
        }
        if !summary.components.is_empty() {
            self.components_changed = true;
            if is_added {
                self.components_by_block.insert(key, summary.components.clone());
            } else {
                self.components_by_block.remove(&key);
            }
        }
        if summary.definition.as_ref().is_some_and(|definition| definition.is_from_plant) {
            if is_added {
                self.states_of_plant.insert(key);
            } else {
                self.states_of_plant.remove(&key);
            }
        }
        if let Some(slot) = self.definitions.get_mut(key.index()) {
            *slot = if is_added { summary.definitions().cloned().collect() } else { Vec::new() };
        }
        if summary.strict == Some(true) {
            step(&mut self.strict);
        }
        if summary.has_contingents {
            step(&mut self.contingents);
        }
        if summary.moves_a_parameter {
            step(&mut self.moves_of_formals);
        }
        for call in &summary.calls {
            step(&mut self.facts[call.name.index()].calls);
        }
        for &name in &summary.occurrences {
            let named = &mut self.facts[name.index()].occurrences;
            let was_named = *named > 0;
            step(named);
            let defined = &mut self.defined[Namespace::Occurrence as usize];
            match (was_named, *named > 0) {
                (false, true) => {
                    defined.insert(name);
                }
                (true, false) => {
                    defined.remove(&name);
                }
                _ => {}
            }
        }
        for used in &summary.uses {
            let facts = &mut self.facts[used.name.index()];
            match used.kind {
                UseKind::Argument(_) | UseKind::Member => step(&mut facts.arguments),
                UseKind::Start => step(&mut facts.starts),
                UseKind::Vehicle => step(&mut facts.vehicles),
                UseKind::Place => step(&mut facts.places),
                UseKind::Resource(_) | UseKind::Level => step(&mut facts.resources),
                UseKind::Occurrence => step(&mut facts.constraints),
                UseKind::Number | UseKind::HeaderBound => step(&mut facts.numbers),
                // To close an area to something is not to use it.
                UseKind::ClosedTo | UseKind::Model | UseKind::Group => {}
            }
        }
        for literal in &summary.literals {
            self.count_literal(literal, is_added);
        }
    }

    fn count_literal(&mut self, literal: &Literal, is_added: bool) {
        let step = |count: &mut u32| {
            *count = if is_added { *count + 1 } else { count.saturating_sub(1) };
        };
        if literal.variable_is_formal {
            step(&mut self.literals_of_formals);
            if literal.mode == LabelMode::Tell {
                step(&mut self.told_of_formals);
            }
            return;
        }
        if literal.vehicle.is_some_and(|vehicle| vehicle.is_formal) {
            if literal.mode == LabelMode::Tell && literal.origin != Origin::Watched {
                step(&mut self.moves_of_formals);
            }
            return;
        }
        step(&mut self.facts[literal.variable.index()].literals);
        if !literal.values.is_empty() {
            step(&mut self.facts[literal.variable.index()].compared);
        }
        if let Some((variable, _)) = literal.split {
            step(&mut self.facts[variable.index()].literals);
        }
        if literal.mode != LabelMode::Tell {
            return;
        }
        let told = Told {
            value: literal.values.first().map(|&(value, _)| value),
            negated: literal.negated,
            is_split: false,
            is_any: literal.value_is_formal || literal.is_sight || literal.values.len() > 1,
            is_watched: literal.origin == Origin::Watched,
        };
        self.facts[literal.variable.index()].tell(told, is_added);
        if let Some((variable, value)) = literal.split {
            let told = Told { value: Some(value), is_split: true, ..told };
            self.facts[variable.index()].tell(told, is_added);
        }
    }
}

impl Facts {
    fn tell(&mut self, told: Told, is_added: bool) {
        if is_added {
            let count = self.told.entry(told).or_default();
            *count += 1;
            if *count == 1 {
                self.told_fingerprint = self.told_fingerprint.wrapping_add(told.fingerprint());
            }
        } else if let Some(count) = self.told.get_mut(&told) {
            *count -= 1;
            if *count == 0 {
                self.told.remove(&told);
                self.told_fingerprint = self.told_fingerprint.wrapping_sub(told.fingerprint());
            }
        }
    }
}

impl Told {
    /// Returns what holds of a state variable at the scenario's start.
    pub(crate) const fn at_first(value: Symbol) -> Self {
        Self { value: Some(value), negated: false, is_split: false, is_any: false, is_watched: false }
    }

    fn fingerprint(self) -> u64 {
        let value = self.value.map_or(0, |value| value.index() as u64 + 1);
        let bits = [self.negated, self.is_split, self.is_any, self.is_watched];
        let flags = bits.into_iter().fold(0, |flags, bit| flags << 1 | u64::from(bit));
        (value << 4 | flags).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    }
}

fn fingerprint_of_calls<'a>(summaries: impl Iterator<Item = (DeclarationKey, &'a Summary)>) -> u64 {
    let owner = |summary: &Summary| summary.definition.as_ref().map_or(0, |it| it.name.index() as u64 + 1);
    summaries.fold(0, |sum, (_, summary)| {
        sum.wrapping_add(summary.call_fingerprint.wrapping_mul(owner(summary).wrapping_mul(2) | 1))
    })
}

/// For each namespace, a sum that changes when the set of names that these declarations define does.
fn names_defined<'a>(
    summaries: impl Iterator<Item = (DeclarationKey, &'a Summary)>,
) -> [u64; Namespace::COUNT] {
    let mut sums = [0_u64; Namespace::COUNT];
    for (_, summary) in summaries {
        for name in &summary.occurrences {
            let sum = &mut sums[Namespace::Occurrence as usize];
            *sum = sum.wrapping_add((name.index() as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        }
        for definition in summary.definitions() {
            // Among variables, those that keep their value are a kind of their own.
            let named = (definition.name.index() as u64) << 1
                | u64::from(definition.initial.is_some() || definition.is_from_plant);
            let hash = (named + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let sum = &mut sums[definition.namespace as usize];
            *sum = sum.wrapping_add(hash ^ hash >> 29);
        }
    }
    sums
}
