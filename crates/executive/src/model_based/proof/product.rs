//! Everything that a program, its plant and what is believed of the plant can come to: the product of the three.
//!
//! A node is where all three are between two steps. What happens in a step is decided by nature, which picks the modes of
//! the components and makes the program's choices by chance. Nodes from which the same comes next are one node.

use std::collections::{BTreeSet, HashMap, HashSet, VecDeque};
use std::sync::Arc;

use hca::{ChosenBy, LocationId, Standing, StepObserver, TransitionId};
use num_traits::One as _;
use plant::simulate::observation_of;
use plant::{
    Belief, ComponentId, EstimateError, Model, Observation, Probability, Situation, State, Target,
    VariableId, observations, targets,
};
use serde::{Deserialize, Serialize};

use super::property::Condition;
use crate::model_based::closed_loop::{ClosedLoop, Knowledge, ProgramExecution};
use crate::model_based::estimator::{Estimator, StepOutcome};
use crate::model_based::system::System;

/// Index of a node.
pub(super) type NodeId = u32;

/// What the environment decides in a step.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Move {
    /// The components that do not do what is nominal, with the modes that they enter.
    pub modes: Vec<(ComponentId, u8)>,
    /// The variables that show something else than without chance, with their values.
    pub observed: Vec<(VariableId, u8)>,
    /// The alternatives of the choices that come up at the step's end, in their order.
    pub choices: Vec<usize>,
}

impl Move {
    /// The components that do not do what is nominal, with the modes that they enter, by their names.
    pub fn named<'model>(&self, model: &'model Model) -> impl Iterator<Item = (&'model str, &'model str)> {
        self.modes
            .iter()
            .filter_map(|(id, mode)| Some((model.component(*id)?.name.as_str(), model.mode_name(*id, *mode))))
    }

    /// The variables that show something else than without chance, with their values, by their names.
    pub fn shown<'model>(&self, model: &'model Model) -> impl Iterator<Item = (&'model str, &'model str)> {
        self.observed.iter().filter_map(|(id, value)| {
            let variable = model.variables.get(id.0 as usize)?;
            Some((variable.name.as_str(), variable.values.get(usize::from(*value))?.as_str()))
        })
    }
}

/// A step from one node to another.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) to: NodeId,
    pub(super) by: Move,
    /// Whether components fail in it.
    pub(super) is_fault: bool,
}

/// Between two steps.
#[derive(Clone, Debug)]
pub(super) struct Node {
    standing: Standing,
    closed: ClosedLoop,
    faults_left: u32,
    /// The length of the shortest run to it, in steps.
    pub(super) depth: u32,
    /// Whether each condition holds.
    pub(super) judged: Vec<Judged>,
    /// Why it has no next step, if it has none.
    pub(super) end: Option<End>,
    /// Why goals contradict each other in the next step, if some do.
    pub(super) contradiction: Option<String>,
    /// Where the environment can lead it in a step; `None` if that was not explored.
    pub(super) edges: Option<Vec<Edge>>,
}

/// Whether a condition holds in a true state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Judged {
    True,
    False,
    /// Modes, and what is shown of what they leave open, do not decide it.
    Undecided,
}

/// Why a run is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum End {
    Ended,
    Deadlock,
    Refuted,
    /// The limit of states that a belief keeps leaves open whether an observation can be explained.
    Unclear,
}

/// Exploring ends after so many steps in which only the probabilities of beliefs were new: they change in every step, and
/// no state is like another.
const STILL_STEPS: u32 = 200;

/// How far to explore.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) faults: u32,
    pub(super) nodes: usize,
    pub(super) depth: u32,
}

/// What tells nodes apart.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Key {
    standing: Standing,
    modes: Vec<u8>,
    beliefs: Vec<Arc<Belief>>,
    /// What was observed last, where the next commands depend on it.
    observation: Option<Observation>,
    judged: Vec<Judged>,
    faults_left: u32,
    end: Option<End>,
    /// Tells nodes apart whose beliefs have dropped something: what a history is expanded to again may differ.
    unlike: Option<NodeId>,
}

/// What was explored.
#[derive(Default)]
pub(super) struct Product {
    pub(super) nodes: Vec<Node>,
    /// Where runs start, each with the choices made before the first step.
    pub(super) starts: Vec<(NodeId, Move)>,
    /// The locations that are active in some node.
    pub(super) reached: BTreeSet<LocationId>,
    pub(super) fired: BTreeSet<TransitionId>,
    /// What stopped the exploration, if something did.
    pub(super) stopped: Option<String>,
    /// Whether steps are missing from nodes that were explored.
    pub(super) has_cut: bool,
}

/// Notes which transitions fire.
#[derive(Default)]
struct Fired(Vec<TransitionId>);

impl StepObserver for Fired {
    fn fired(&mut self, transition: TransitionId) {
        self.0.push(transition);
    }
}

/// A way through a step: where it leads, and what the environment decided.
pub(super) struct Way {
    standing: Standing,
    closed: ClosedLoop,
    judged: Vec<Judged>,
    pub(super) by: Move,
    pub(super) is_fault: bool,
    faults: u32,
    /// Its share of all ways from the same node, as a product of fractions.
    pub(super) weights: Vec<(u64, u64)>,
}

/// Components have entered their modes.
struct Entered {
    closed: ClosedLoop,
    by: Move,
    faults: u32,
    weights: Vec<(u64, u64)>,
}

/// What is observed then.
#[derive(Clone)]
struct Seen {
    observation: Observation,
    /// The same without errors.
    truth: Observation,
    /// The values that differ from what is shown without chance.
    unusual: Vec<(VariableId, u8)>,
    errors: u32,
    weights: Vec<(u64, u64)>,
}

/// Of a state that admits more observations only the one without chance is explored.
const MAX_OBSERVATIONS: usize = 256;

/// Takes steps in all ways.
pub(super) struct Explorer {
    system: Arc<System>,
    estimator: Estimator,
    program: ProgramExecution,
    conditions: Vec<Condition>,
    /// The groups of components that matter to the program or to a condition, and the components of these.
    groups: BTreeSet<usize>,
    components: BTreeSet<ComponentId>,
    fired: Fired,
    /// By state, what is observed in it without chance, and all that may be observed; `None` where that is too much.
    observed: HashMap<State, (Observation, Option<Vec<Observation>>)>,
    /// Whether not everything that can happen was followed.
    pub(super) has_cut: bool,
}

impl Explorer {
    pub(super) fn new(system: &Arc<System>, conditions: Vec<Condition>) -> Self {
        let mut groups = system.groups_used();
        groups.extend(conditions.iter().flat_map(|condition| system.groups_of(&condition.formula)));
        let of = |at: &usize| system.groups.get(*at).map_or(&[][..], |group| &*group.components);
        let components = groups.iter().flat_map(of).copied().collect();
        Self {
            system: Arc::clone(system),
            estimator: Estimator::new(system, None),
            program: ProgramExecution::new(system),
            conditions,
            groups,
            components,
            fired: Fired::default(),
            observed: HashMap::new(),
            has_cut: false,
        }
    }

    /// Returns where runs may start: in each state that is possible at first, and with each of the first choices.
    pub(super) fn starts(&mut self, knowledge: Knowledge, most: usize) -> Vec<Way> {
        let closed = ClosedLoop::new(&self.system, &mut self.estimator, None);
        let likeliest = closed.true_state().clone();
        self.has_cut |= !closed.belief().is_exact();
        let states: Vec<_> = closed.belief().states().take(most).collect();
        let mut ways = Vec::new();
        for (state, probability) in states {
            let differs = |id: &ComponentId| state.mode(*id) != likeliest.mode(*id);
            let modes = self.system.model.component_ids().filter(differs).map(|id| (id, state.mode(id)));
            let by = Move { modes: modes.collect(), ..Move::default() };
            let mut closed = closed.clone().starting_in(&self.system, state);
            closed = closed.with_knowledge(&self.system, knowledge);
            let standing = ProgramExecution::new(&self.system).stepper.standing();
            // A start that is not known exactly has no share.
            let share = probability.exact().and_then(fraction).unwrap_or((0, 1));
            let judged = self.judge(closed.true_state(), &Observation::default());
            let weights = vec![share];
            let way = Way { standing, closed, judged, by, is_fault: false, faults: 0, weights };
            self.choose(way, &mut ways);
        }
        ways
    }

    /// The ways through the next step, with at most so many faults; and why goals contradict each other in it, if some do.
    pub(super) fn ways(
        &mut self,
        standing: &Standing,
        closed: &ClosedLoop,
        most_faults: u32,
    ) -> Result<(Vec<Way>, Option<String>), EstimateError> {
        let system = Arc::clone(&self.system);
        self.program.stepper.return_to(standing);
        let commanded = closed.command(&system, &[&mut self.program], &mut self.estimator);
        let commands = &commanded.commands;
        let each: Vec<Vec<Target>> = system
            .model
            .component_ids()
            .map(|id| {
                let mut targets = targets(&system.model, id, closed.true_state(), commands)?;
                if !self.components.contains(&id) {
                    targets.truncate(1);
                }
                Ok(targets)
            })
            .collect::<Result<_, _>>()?;
        let mut ways = Vec::new();
        for picked in combinations(&each, most_faults) {
            let next = State(picked.iter().map(|target| target.mode).collect());
            let mut closed = closed.clone();
            // Modes that contradict each other do not occur together.
            if closed.enter(next).is_err() {
                continue;
            }
            let mut by = Move::default();
            let mut weights = Vec::new();
            for ((id, targets), target) in system.model.component_ids().zip(&each).zip(&picked) {
                if targets.first().is_some_and(|nominal| nominal.mode != target.mode) {
                    by.modes.push((id, target.mode));
                }
                if targets.len() > 1 {
                    weights.push((target.weight, targets.iter().map(|target| target.weight).sum()));
                }
            }
            let faults = picked.iter().filter(|target| target.is_fault).count() as u32;
            let entered = Entered { closed, by, faults, weights };
            for seen in self.seen(&entered, most_faults) {
                let mut closed = entered.closed.clone();
                let judged = self.judge(closed.true_state(), &seen.truth);
                self.program.stepper.return_to(standing);
                let programs = &mut [&mut self.program];
                let observers = std::slice::from_mut(&mut self.fired);
                let observation = seen.observation;
                closed.learn(&system, programs, &mut self.estimator, commands, observation, observers)?;
                let by = Move { observed: seen.unusual, ..entered.by.clone() };
                let faults = entered.faults + seen.errors;
                let weights = entered.weights.iter().copied().chain(seen.weights).collect();
                let standing = self.program.stepper.standing();
                let is_fault = faults > 0;
                self.choose(Way { standing, closed, judged, by, is_fault, faults, weights }, &mut ways);
            }
        }
        Ok((ways, commanded.contradiction))
    }

    /// Returns what may be observed once components have entered their modes. An error of a sensor counts as a fault.
    fn seen(&mut self, entered: &Entered, most_faults: u32) -> Vec<Seen> {
        let model = &self.system.model;
        let state = entered.closed.true_state();
        let (shown, possible) = self.observed.entry(state.clone()).or_insert_with(|| {
            let possible = observations(model, state, &self.components, MAX_OBSERVATIONS);
            (observation_of(model, state), possible)
        });
        self.has_cut |= possible.is_none();
        let possible = possible.clone().unwrap_or_else(|| vec![shown.clone()]);
        let count = possible.len() as u64;
        let mut all: Vec<Seen> = possible
            .into_iter()
            .map(|observation| {
                let differs = |(id, value): &(&VariableId, &u8)| shown.0.get(id) != Some(value);
                let unusual = observation.0.iter().filter(differs).map(|(id, value)| (*id, *value)).collect();
                Seen {
                    truth: observation.clone(),
                    observation,
                    unusual,
                    errors: 0,
                    weights: vec![(1, count)],
                }
            })
            .collect();
        for &variable in
            self.groups.iter().filter_map(|at| self.system.groups.get(*at)).flat_map(|it| &it.variables)
        {
            let Some(data) = model.variables.get(variable.0 as usize) else { continue };
            let Some((part, of)) = data.error.filter(|_| data.observable) else { continue };
            let others = data.values.len() as u64 - 1;
            let mut next = Vec::with_capacity(all.len());
            for seen in all {
                let Some(&truth) = seen.observation.0.get(&variable) else {
                    next.push(seen);
                    continue;
                };
                if entered.faults + seen.errors < most_faults && others > 0 {
                    let values = (0..=u8::MAX).zip(&data.values).map(|(value, _)| value);
                    for value in values.filter(|value| *value != truth) {
                        let mut wrong = seen.clone();
                        wrong.observation.0.insert(variable, value);
                        wrong.unusual.retain(|(id, _)| *id != variable);
                        if shown.0.get(&variable) != Some(&value) {
                            wrong.unusual.push((variable, value));
                        }
                        wrong.errors += 1;
                        wrong.weights.push((part, of.saturating_mul(others)));
                        next.push(wrong);
                    }
                }
                let mut right = seen;
                right.weights.push((of - part, of));
                next.push(right);
            }
            all = next;
        }
        all.sort_by_key(|seen| (seen.errors, !seen.unusual.is_empty()));
        all
    }

    /// Adds a way once for each combination of the alternatives at random that are open at its end.
    fn choose(&mut self, mut way: Way, into: &mut Vec<Way>) {
        self.program.stepper.return_to(&way.standing);
        if *way.closed.outcome() == StepOutcome::Explained
            && let Some(choice) = self.program.stepper.open_choice()
        {
            let ChosenBy::Chance(weights) = choice.by.clone() else {
                // The executive decides it by what it knows.
                let standing = way.standing.clone();
                let made = self.estimator.choose(&self.system, standing, way.closed.belief());
                self.program.stepper.return_to(&way.standing);
                self.program.stepper.choose(made.alternative);
                way.standing = self.program.stepper.standing();
                self.choose(way, into);
                return;
            };
            let total = weights.iter().sum();
            for (alternative, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0) {
                self.program.stepper.return_to(&way.standing);
                self.program.stepper.choose(alternative);
                let mut by = way.by.clone();
                by.choices.push(alternative);
                let mut shares = way.weights.clone();
                shares.push((*weight, total));
                let standing = self.program.stepper.standing();
                let (closed, judged) = (way.closed.clone(), way.judged.clone());
                self.choose(Way { standing, closed, judged, by, weights: shares, ..way }, into);
            }
            return;
        }
        let programs = &mut [&mut self.program];
        ClosedLoop::set_aside(programs);
        way.closed.note_deadlock(programs);
        way.standing = self.program.stepper.standing().relative(&self.system.automaton);
        into.push(way);
    }

    /// Whether each condition holds in a state with this observation.
    fn judge(&self, state: &State, truth: &Observation) -> Vec<Judged> {
        if self.conditions.is_empty() {
            return Vec::new();
        }
        let mut situation = Situation::new(&self.system.model, state, truth);
        let judged = self.conditions.iter().map(|condition| {
            if situation.entails(&condition.formula) {
                Judged::True
            } else if situation.entails(&condition.opposite) {
                Judged::False
            } else {
                Judged::Undecided
            }
        });
        judged.collect()
    }

    /// Returns what tells the place apart to which a way leads. What the program has nothing to do with does not
    /// matter.
    pub(super) fn key(&self, way: &Way, faults_left: u32) -> Key {
        // With perfect knowledge, the modes say what is believed.
        let is_estimated = way.closed.knowledge() == Knowledge::Estimated;
        let beliefs = way.closed.belief().beliefs().enumerate();
        let beliefs = beliefs.filter(|(at, _)| is_estimated && self.groups.contains(at));
        let state = way.closed.true_state();
        Key {
            standing: way.standing.clone(),
            modes: self.components.iter().map(|id| state.mode(*id)).collect(),
            beliefs: beliefs.map(|(_, belief)| Arc::clone(belief)).collect(),
            observation: self.system.entailment.as_ref().map(|_| way.closed.observation().clone()),
            judged: way.judged.clone(),
            faults_left,
            end: way.end(),
            unlike: None,
        }
    }

    /// Returns what tells a node apart from those that differ from it in the probabilities of what is believed only.
    fn kind(&self, node: &Node) -> Key {
        let (state, likeliest) = (node.closed.true_state(), node.closed.belief().most_likely());
        let modes = self.components.iter().flat_map(|id| [state.mode(*id), likeliest.mode(*id)]);
        Key {
            standing: node.standing.clone(),
            modes: modes.collect(),
            beliefs: Vec::new(),
            observation: None,
            judged: node.judged.clone(),
            faults_left: node.faults_left,
            end: None,
            unlike: None,
        }
    }

    /// Takes nominal steps from a node until a goal is reached or the run ends, at most `most`. Returns how many were taken.
    pub(super) fn nominal_steps(
        &mut self,
        from: &Node,
        is_goal: &dyn Fn(&[Judged], Option<End>) -> bool,
        most: u32,
    ) -> Result<u32, EstimateError> {
        let (mut standing, mut closed) = (from.standing.clone(), from.closed.clone());
        for step in 0..most {
            let (ways, _) = self.ways(&standing, &closed, 0)?;
            let Some(way) = ways.into_iter().next() else { return Ok(step) };
            let end = way.end();
            if end.is_some() || is_goal(&way.judged, end) {
                return Ok(step);
            }
            (standing, closed) = way.place();
        }
        Ok(most)
    }
}

/// An exploration under way.
pub(super) struct Exploration {
    pub(super) explorer: Explorer,
    pub(super) product: Product,
    limits: Limits,
    known: HashMap<Key, NodeId>,
    /// The nodes that are still to be explored, those first that were come to first.
    queue: VecDeque<NodeId>,
    kinds: HashSet<Key>,
    last_new_kind: u32,
}

impl Exploration {
    pub(super) fn new(mut explorer: Explorer, knowledge: Knowledge, limits: Limits) -> Self {
        let starts = explorer.starts(knowledge, limits.nodes);
        let mut exploration = Self {
            explorer,
            product: Product::default(),
            limits,
            known: HashMap::new(),
            queue: VecDeque::new(),
            kinds: HashSet::new(),
            last_new_kind: 0,
        };
        for way in starts {
            let by = way.by.clone();
            let id = exploration.node(way, limits.faults, 0);
            exploration.product.starts.push((id, by));
        }
        exploration
    }

    /// Explores in breadth until `go_on` returns false; it gets the number of nodes. Returns whether everything is explored.
    pub(super) fn advance(&mut self, go_on: &mut dyn FnMut(usize) -> bool) -> Result<bool, EstimateError> {
        while let Some(id) = self.queue.front().copied() {
            if !go_on(self.product.nodes.len()) {
                return Ok(false);
            }
            self.queue.pop_front();
            let node = &self.product.nodes[id as usize];
            let (depth, faults_left) = (node.depth, node.faults_left);
            if depth >= self.limits.depth {
                let why = format!("runs of more than {depth} steps were not explored");
                self.product.stopped = Some(why);
                continue;
            }
            if self.product.nodes.len() >= self.limits.nodes {
                self.end_early(format!("the limit of {} states was reached", self.limits.nodes));
                break;
            }
            if self.kinds.insert(self.explorer.kind(node)) {
                self.last_new_kind = depth;
            } else if depth - self.last_new_kind > STILL_STEPS {
                let since = self.last_new_kind;
                self.end_early(format!("after {since} steps only the probabilities of beliefs change"));
                break;
            }
            let (standing, closed) = (node.standing.clone(), node.closed.clone());
            let (ways, contradiction) = self.explorer.ways(&standing, &closed, faults_left)?;
            let mut edges: Vec<Edge> = Vec::with_capacity(ways.len());
            for way in ways {
                let (by, is_fault, left) = (way.by.clone(), way.is_fault, faults_left - way.faults);
                let to = self.node(way, left, depth + 1);
                edges.push(Edge { to, by, is_fault });
            }
            self.product.fired.extend(self.explorer.fired.0.drain(..));
            if self.explorer.has_cut {
                self.product.has_cut = true;
                let why = || "not every first state or observation was explored".to_owned();
                self.product.stopped.get_or_insert_with(why);
            }
            let node = &mut self.product.nodes[id as usize];
            node.edges = Some(edges);
            node.contradiction = contradiction;
        }
        Ok(true)
    }

    /// Leaves unexplored what is still to be explored.
    pub(super) fn end_early(&mut self, why: String) {
        self.queue.clear();
        self.product.stopped = Some(why);
    }

    /// The node that a way leads to, added if it is new.
    fn node(&mut self, way: Way, faults_left: u32, depth: u32) -> NodeId {
        let end = way.end();
        let id = self.product.nodes.len() as NodeId;
        let mut key = self.explorer.key(&way, faults_left);
        key.unlike = (!way.closed.belief().is_exact()).then_some(id);
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        self.known.insert(key, id);
        self.product.reached.extend(way.standing.marking().iter());
        let mut edges = None;
        match end {
            None => self.queue.push_back(id),
            Some(End::Unclear) => {
                let why = || "a belief keeps too few states to explain an observation".to_owned();
                self.product.stopped.get_or_insert_with(why);
            }
            Some(_) => edges = Some(vec![Edge { to: id, by: Move::default(), is_fault: false }]),
        }
        self.product.nodes.push(Node {
            standing: way.standing,
            closed: way.closed,
            faults_left,
            depth,
            judged: way.judged,
            end,
            contradiction: None,
            edges,
        });
        id
    }
}

impl Way {
    /// Returns why the run is over where it leads, if it is.
    pub(super) fn end(&self) -> Option<End> {
        match self.closed.outcome() {
            StepOutcome::Refuted { .. } => Some(End::Refuted),
            StepOutcome::LimitReached => Some(End::Unclear),
            StepOutcome::Explained if self.standing.marking().is_empty() => Some(End::Ended),
            StepOutcome::Explained => self.closed.deadlock().map(|_| End::Deadlock),
        }
    }

    /// Returns where it leads.
    pub(super) fn place(self) -> (Standing, ClosedLoop) {
        (self.standing, self.closed)
    }

    /// The probability of what nature decides in it, up to a factor that all ways from the same node have in common.
    pub(super) fn weight(&self) -> Probability {
        let parts = self.weights.iter().map(|(part, of)| Probability::new((*part).into(), (*of).into()));
        parts.fold(Probability::one(), |product, part| product * part)
    }
}

/// A probability as a fraction of machine words, if it is one.
fn fraction(probability: &plant::Probability) -> Option<(u64, u64)> {
    Some((probability.numer().try_into().ok()?, probability.denom().try_into().ok()?))
}

/// All ways to pick one target for each component with at most so many faults.
fn combinations(each: &[Vec<Target>], most_faults: u32) -> Vec<Vec<Target>> {
    let mut found: Vec<(Vec<Target>, u32)> = vec![(Vec::with_capacity(each.len()), 0)];
    for targets in each {
        found = found
            .into_iter()
            .flat_map(|(picked, faults)| {
                targets.iter().filter_map(move |target| {
                    let faults = faults + u32::from(target.is_fault);
                    let mut picked = picked.clone();
                    picked.push(*target);
                    (faults <= most_faults).then_some((picked, faults))
                })
            })
            .collect();
    }
    found.into_iter().map(|(picked, _)| picked).collect()
}
