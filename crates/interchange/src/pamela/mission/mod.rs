//! The text of the mission: primitives, activities and scenarios, and the states that conditions speak of.

mod conditions;
mod statements;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::classes::Method;
use super::instances::Instances;
use super::names::{name, number};
use super::tree::Tree;
use crate::Translation;

/// A statement that does nothing.
const NOTHING: &str = "delay[0,0]";

/// A method of an object: their numbers.
type Key = (usize, usize);

/// Where a statement stands.
#[derive(Clone, Copy)]
struct Place<'method, 'file> {
    instance: usize,
    key: Key,
    method: &'method Method<'file>,
}

/// A value that is written, or that an argument of a method gives.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Given {
    Written(String),
    By(Key, usize),
}

/// A state, or a variable that has no value at the start.
#[derive(Default)]
struct State {
    initial: Option<String>,
    values: BTreeSet<Given>,
    /// Whether an activity sets it.
    is_set: bool,
}

/// The value of a state at the start where nothing says another one.
const UNKNOWN: &str = "unknown";

pub(super) struct Writer<'file> {
    instances: &'file Instances<'file>,
    file: &'file str,
    /// The names of methods in the mission.
    names: BTreeMap<Key, String>,
    called: BTreeSet<Key>,
    states: BTreeMap<String, State>,
    /// What calls give to the arguments of methods.
    given: BTreeMap<(Key, usize), BTreeSet<Given>>,
    labels: BTreeSet<&'file str>,
    /// Primitives that stand for a cost and a reward: their name and clauses.
    accounts: BTreeMap<String, String>,
    remarks: Vec<String>,
    left_out: Vec<(u32, String)>,
}

impl<'file> Writer<'file> {
    pub(super) fn new(instances: &'file Instances<'file>, file: &'file str) -> Self {
        let mut count: BTreeMap<&str, usize> = BTreeMap::new();
        instances.methods().for_each(|(_, _, method)| *count.entry(method.name).or_default() += 1);
        let mut taken = BTreeSet::new();
        let names = instances.methods().map(|(at, number, method)| {
            let object = &instances.all[at];
            let class = instances.class(at).name;
            let mut own = name(method.name);
            if count.get(method.name).is_some_and(|count| *count > 1) {
                own = name(&format!(
                    "{}-{}",
                    if object.path.is_empty() { class } else { &object.path },
                    method.name
                ));
            }
            while !taken.insert(own.clone()) {
                own.push_str("_2");
            }
            ((at, number), own)
        });
        let names = names.collect();
        Self {
            instances,
            file,
            names,
            called: BTreeSet::new(),
            states: BTreeMap::new(),
            given: BTreeMap::new(),
            labels: BTreeSet::new(),
            accounts: BTreeMap::new(),
            remarks: instances.remarks.clone(),
            left_out: Vec::new(),
        }
    }

    pub(super) fn write(mut self) -> Translation {
        let instances = self.instances;
        let (mut primitives, mut bodies, mut constraints) = (String::new(), Vec::new(), String::new());
        for class in instances.classes {
            let transitions = class.transitions.first().and_then(|(_, options)| options.values().next());
            let transitions = transitions.map(|option| ("transitions", option.line()));
            for (what, line) in
                transitions.into_iter().chain(class.propositions.map(|line| ("propositions", line)))
            {
                self.leave_out(
                    line,
                    format!("{what} of `{}`: a mission has no models of components", class.name),
                );
            }
        }
        for (at, number, method) in instances.methods() {
            let place = Place { instance: at, key: (at, number), method };
            if method.body.is_none() {
                primitives += &self.primitive((at, number), place);
                continue;
            }
            let body = self.body(place);
            bodies.push(((at, number), method, body));
        }
        for (_, method, _) in &bodies {
            for between in &method.betweens {
                constraints += &self.between(between);
            }
        }
        let (mut activities, mut scenarios) = (String::new(), String::new());
        for (key, method, body) in bodies {
            let own = self.names.get(&key).cloned().unwrap_or_default();
            let bounds = self.bounds(method.options.get("bounds").copied()).unwrap_or_default();
            let arguments = parameters(method);
            if self.called.contains(&key) || !method.arguments.is_empty() {
                let _ = writeln!(activities, "{own}({arguments}){bounds} = {{ {body} }}");
            } else {
                let _ = writeln!(scenarios, "scenario {own}{bounds} = {{ {body} }}");
            }
        }
        let mut text = String::new();
        self.left_out.sort();
        self.left_out.dedup();
        let left_out: Vec<String> =
            self.left_out.iter().map(|(line, what)| format!("{}:{line}: {what}", self.file)).collect();
        text.extend(left_out.iter().map(|what| format!("// Not read: {what}\n")));
        text.extend(self.remarks.iter().map(|remark| format!("// Note: {remark}\n")));
        for (state, known) in &self.states {
            let initial = known.initial.as_deref().or_else(|| known.is_set.then_some(UNKNOWN));
            if let Some(initial) = initial {
                let mut values = BTreeSet::from([initial.to_owned()]);
                let mut seen = BTreeSet::new();
                known.values.iter().for_each(|given| self.written(given, &mut seen, &mut values));
                let values: Vec<&str> = values.iter().map(String::as_str).collect();
                let _ = writeln!(text, "state {state} : {{{}}} = {initial};", values.join(", "));
            }
        }
        for (account, clauses) in &self.accounts {
            let _ = writeln!(text, "primitive {account}()[0,0]{clauses};");
        }
        text += &(primitives + &activities + &constraints + &scenarios);
        let formatted = rmpl::format::format(&text);
        Translation { text: formatted, remarks: self.remarks, left_out }
    }

    /// Adds the values that a state may be given.
    fn written(&self, given: &Given, seen: &mut BTreeSet<(Key, usize)>, into: &mut BTreeSet<String>) {
        match given {
            Given::Written(value) => {
                into.insert(value.clone());
            }
            Given::By(key, argument) => {
                if seen.insert((*key, *argument)) {
                    let all = self.given.get(&(*key, *argument)).into_iter().flatten();
                    all.for_each(|given| self.written(given, seen, into));
                }
            }
        }
    }

    fn leave_out(&mut self, line: u32, what: String) {
        self.left_out.push((line, what));
    }

    fn remark(&mut self, what: &str) {
        if !self.remarks.iter().any(|known| known == what) {
            self.remarks.push(what.to_owned());
        }
    }

    fn primitive(&mut self, key: Key, place: Place<'_, 'file>) -> String {
        let method = place.method;
        let own = self.names.get(&key).cloned().unwrap_or_default();
        let bounds =
            self.bounds(method.options.get("bounds").copied()).unwrap_or_else(|| "[0,inf]".to_owned());
        let mut text = format!("primitive {own}({}){bounds}", parameters(method));
        if let Some(condition) = method.options.get("pre") {
            match self.literals(condition, place) {
                Ok(literals) if !literals.is_empty() => {
                    let _ = write!(text, " requires at start {}", literals.join(", "));
                }
                Ok(_) => {}
                Err(what) => self
                    .leave_out(condition.line(), format!("the condition before `{}`: {what}", method.name)),
            }
        }
        if let Some(effect) = method.options.get("post") {
            match self.literals(effect, place) {
                Ok(literals) if literals.iter().any(|literal| literal.starts_with("not ")) => {
                    self.leave_out(effect.line(), format!("the effect of `{}`: `not`", method.name));
                }
                Ok(literals) if !literals.is_empty() => {
                    let _ = write!(text, " sets {}", literals.join(", "));
                    for name in literals.iter().filter_map(|literal| literal.split('=').next()) {
                        let state = self.states.entry(name.to_owned()).or_default();
                        state.is_set = true;
                        if state.initial.is_none() {
                            self.remark("a state without an initial value starts as `unknown`");
                        }
                    }
                }
                Ok(_) => {}
                Err(what) => {
                    self.leave_out(effect.line(), format!("the effect of `{}`: {what}", method.name));
                }
            }
        }
        text += &self.worth(&method.options);
        self.say_unused(&method.options);
        text + ";\n"
    }

    /// The clauses for a cost and a reward.
    fn worth(&mut self, options: &BTreeMap<&'file str, &'file Tree>) -> String {
        let mut text = String::new();
        for (key, clause) in [("cost", "costs"), ("reward", "rewards")] {
            let Some(given) = options.get(key) else { continue };
            match number(given) {
                Some(number) => {
                    let _ = write!(text, " {clause} {number}");
                }
                None => self.leave_out(given.line(), format!("`:{key}`: expected a number")),
            }
        }
        text
    }

    fn say_unused(&mut self, options: &BTreeMap<&'file str, &'file Tree>) {
        if options.contains_key("probability") {
            self.remark("probabilities of choices are not used: the planner chooses");
        }
        if options.contains_key("controllable") {
            self.remark("whether an activity can be canceled (`:controllable`) is not used");
        }
    }
}

fn parameters(method: &Method<'_>) -> String {
    method.arguments.iter().map(|argument| name(argument)).collect::<Vec<_>>().join(", ")
}
