//! Whether a plan in PDDL keeps the rules of PDDL 2.1 (Fox and Long 2003): durations, conditions at the start, throughout and
//! at the end, mutual exclusion, the goal. It shares no code with what reads and writes PDDL, and knows only what the tests'
//! domains say. Times are in thousandths.

use std::collections::{BTreeMap, BTreeSet};

type Words = Vec<String>;
type Bindings = BTreeMap<String, String>;

/// VAL's tolerance: what is nearer is at once.
const TOLERANCE: i64 = 10;

#[derive(Clone, Debug)]
enum Tree {
    Word(String),
    List(Vec<Tree>),
}

impl Tree {
    fn read(text: &str) -> Self {
        let text: String =
            text.lines().map(|row| row.split(';').next().unwrap_or_default()).collect::<Vec<_>>().join(" ");
        let spaced = text.to_lowercase().replace('(', " ( ").replace(')', " ) ");
        let mut open = vec![Vec::new()];
        for word in spaced.split_whitespace() {
            match word {
                "(" => open.push(Vec::new()),
                ")" => {
                    let list = open.pop().expect("an open list");
                    open.last_mut().expect("a list around it").push(Self::List(list));
                }
                word => open.last_mut().expect("a list").push(Self::Word(word.to_owned())),
            }
        }
        open.pop().and_then(|mut all| all.pop()).expect("a file has one list")
    }

    fn list(&self) -> &[Self] {
        match self {
            Self::List(list) => list,
            Self::Word(word) => panic!("`{word}` is no list"),
        }
    }

    fn word(&self) -> &str {
        match self {
            Self::Word(word) => word,
            Self::List(_) => "",
        }
    }

    fn head(&self) -> &str {
        self.list().first().map_or("", Self::word)
    }

    fn put(&self, bindings: &Bindings) -> Words {
        let word =
            |tree: &Self| bindings.get(tree.word()).map_or_else(|| tree.word().to_owned(), String::clone);
        self.list().iter().map(word).collect()
    }
}

/// `a b - t`, each with its type.
fn typed(trees: &[Tree]) -> Vec<(String, String)> {
    let (mut all, mut open) = (Vec::new(), Vec::new());
    let mut words = trees.iter().map(Tree::word);
    while let Some(word) = words.next() {
        if word == "-" {
            let kind = words.next().expect("a type");
            all.extend(open.drain(..).map(|name| (name, kind.to_owned())));
        } else {
            open.push(word.to_owned());
        }
    }
    all.extend(open.into_iter().map(|name| (name, "object".to_owned())));
    all
}

#[derive(Clone, Default)]
struct State {
    facts: BTreeSet<Words>,
    numbers: BTreeMap<Words, f64>,
}

/// What happens at one instant.
#[derive(Default)]
struct Happening {
    at: i64,
    name: String,
    conditions: Vec<(Tree, Bindings)>,
    effects: Vec<(Tree, Bindings)>,
}

#[derive(Default)]
struct Touched {
    needed: BTreeSet<Words>,
    added: BTreeSet<Words>,
    deleted: BTreeSet<Words>,
    read: BTreeSet<Words>,
    written: BTreeSet<Words>,
}

struct Task {
    actions: BTreeMap<String, BTreeMap<String, Tree>>,
    parents: BTreeMap<String, String>,
    objects: Vec<(String, String)>,
    first: State,
    timed: Vec<Happening>,
    goal: Tree,
}

/// Panics where the plan breaks a rule. Returns how many actions it has.
pub(crate) fn check(domain: &str, problem: &str, plan: &str) -> usize {
    let task = Task::read(domain, problem);
    let (mut happenings, mut lasting, mut count) =
        (task.timed.iter().map(copy).collect::<Vec<_>>(), Vec::new(), 0);
    for line in plan.lines().filter(|line| !line.starts_with(';') && !line.trim().is_empty()) {
        task.add(line, &mut happenings, &mut lasting);
        count += 1;
    }
    happenings.sort_by_key(|happening| happening.at);
    for (index, one) in happenings.iter().enumerate() {
        for other in happenings[index + 1..].iter().take_while(|other| other.at - one.at < TOLERANCE) {
            task.keep_apart(one, other);
        }
    }
    let mut state = task.first.clone();
    let times: BTreeSet<i64> = happenings.iter().map(|happening| happening.at).collect();
    for time in times {
        let before = state.clone();
        let now = || happenings.iter().filter(|happening| happening.at == time);
        for happening in now() {
            for (condition, bindings) in &happening.conditions {
                assert!(
                    task.holds(&before, condition, bindings),
                    "{} at {time}: {condition:?} {bindings:?}",
                    happening.name
                );
            }
        }
        for is_added in [false, true] {
            for (effect, bindings) in now().flat_map(|happening| &happening.effects) {
                apply(&before, &mut state, effect, bindings, is_added);
            }
        }
        for (from, until, condition, bindings) in &lasting {
            if *from <= time && time < *until {
                assert!(
                    task.holds(&state, condition, bindings),
                    "throughout, after {time}: {condition:?} {bindings:?}"
                );
            }
        }
    }
    assert!(task.holds(&state, &task.goal, &Bindings::new()), "the goal at the end");
    count
}

fn copy(happening: &Happening) -> Happening {
    Happening {
        at: happening.at,
        name: happening.name.clone(),
        conditions: happening.conditions.clone(),
        effects: happening.effects.clone(),
    }
}

fn thousandths(text: &str) -> i64 {
    (text.trim().parse::<f64>().expect("a number") * 1000.0).round() as i64
}

/// Adds what `effect` says to `state`: deletions and numbers first, additions after them.
fn apply(before: &State, state: &mut State, effect: &Tree, bindings: &Bindings, is_added: bool) {
    match effect.head() {
        "and" => effect.list()[1..].iter().for_each(|part| apply(before, state, part, bindings, is_added)),
        "not" if !is_added => {
            state.facts.remove(&effect.list()[1].put(bindings));
        }
        head @ ("increase" | "decrease") if !is_added => {
            let amount = number(before, &effect.list()[2], bindings);
            let amount = if head == "increase" { amount } else { -amount };
            *state.numbers.get_mut(&effect.list()[1].put(bindings)).expect("a number") += amount;
        }
        "not" | "increase" | "decrease" => {}
        _ if is_added => {
            state.facts.insert(effect.put(bindings));
        }
        _ => {}
    }
}

fn number(state: &State, tree: &Tree, bindings: &Bindings) -> f64 {
    if let Tree::Word(word) = tree {
        return word.parse().unwrap_or_else(|_| panic!("`{word}` is no number"));
    }
    let list = tree.list();
    let side = |index: usize| number(state, &list[index], bindings);
    match tree.head() {
        "+" => side(1) + side(2),
        "-" => side(1) - side(2),
        "*" => side(1) * side(2),
        "/" => side(1) / side(2),
        _ => state.numbers[&tree.put(bindings)],
    }
}

fn is_comparison(head: &str) -> bool {
    ["<", "<=", "=", ">=", ">"].contains(&head)
}

fn compare(head: &str, left: f64, right: f64) -> bool {
    match head {
        "<" => left < right,
        "<=" => left <= right + 1e-6,
        "=" => (left - right).abs() < 1e-3,
        ">=" => left >= right - 1e-6,
        _ => left > right,
    }
}

/// The numbers that an expression speaks of.
fn numbers_in(tree: &Tree, bindings: &Bindings, found: &mut BTreeSet<Words>) {
    if let Tree::List(list) = tree {
        if ["+", "-", "*", "/"].contains(&tree.head()) {
            list[1..].iter().for_each(|part| numbers_in(part, bindings, found));
        } else {
            found.insert(tree.put(bindings));
        }
    }
}

impl Task {
    fn read(domain: &str, problem: &str) -> Self {
        let mut task = Self {
            actions: BTreeMap::new(),
            parents: BTreeMap::new(),
            objects: Vec::new(),
            first: State::default(),
            timed: Vec::new(),
            goal: Tree::List(Vec::new()),
        };
        for section in Tree::read(domain).list().iter().chain(Tree::read(problem).list()) {
            let Tree::List(list) = section else { continue };
            match section.head() {
                ":types" => task.parents.extend(typed(&list[1..])),
                ":constants" | ":objects" => task.objects.extend(typed(&list[1..])),
                ":action" | ":durative-action" => {
                    let parts = list[2..].chunks(2).map(|pair| (pair[0].word().to_owned(), pair[1].clone()));
                    task.actions.insert(list[1].word().to_owned(), parts.collect());
                }
                ":init" => list[1..].iter().for_each(|fact| task.initially(fact)),
                ":goal" => task.goal = list[1].clone(),
                _ => {}
            }
        }
        task
    }

    fn initially(&mut self, fact: &Tree) {
        let none = Bindings::new();
        match (fact.head(), fact.list()) {
            ("=", [_, fluent, value]) => {
                self.first.numbers.insert(fluent.put(&none), number(&State::default(), value, &none));
            }
            ("at", [_, Tree::Word(time), effect @ Tree::List(_)]) => self.timed.push(Happening {
                at: thousandths(time),
                name: "initially".to_owned(),
                effects: vec![(effect.clone(), none)],
                ..Happening::default()
            }),
            _ => {
                self.first.facts.insert(fact.put(&none));
            }
        }
    }

    fn is_of(&self, object: &str, kind: &str) -> bool {
        let mut types = self.objects.iter().filter(|(name, _)| name == object).map(|(_, kind)| kind.as_str());
        let mut next = types.next();
        while let Some(found) = next {
            if found == kind {
                return true;
            }
            next = self.parents.get(found).map(String::as_str);
        }
        kind == "object"
    }

    fn each(&self, names: &Tree, bindings: &Bindings) -> Vec<Bindings> {
        let mut all = vec![bindings.clone()];
        for (name, kind) in typed(names.list()) {
            let objects: Vec<&String> = self.objects.iter().map(|(object, _)| object).collect();
            let fitting = objects.into_iter().filter(|object| self.is_of(object, &kind));
            let with = |object: &String| {
                let with_object = |known: &Bindings| {
                    let mut known = known.clone();
                    known.insert(name.clone(), object.clone());
                    known
                };
                all.iter().map(with_object).collect::<Vec<_>>()
            };
            all = fitting.flat_map(with).collect();
        }
        all
    }

    fn holds(&self, state: &State, formula: &Tree, bindings: &Bindings) -> bool {
        let list = formula.list();
        match formula.head() {
            "" => true,
            "and" => list[1..].iter().all(|part| self.holds(state, part, bindings)),
            "or" => list[1..].iter().any(|part| self.holds(state, part, bindings)),
            "not" => !self.holds(state, &list[1], bindings),
            "forall" => {
                self.each(&list[1], bindings).iter().all(|bindings| self.holds(state, &list[2], bindings))
            }
            head if is_comparison(head) => {
                compare(head, number(state, &list[1], bindings), number(state, &list[2], bindings))
            }
            _ => state.facts.contains(&formula.put(bindings)),
        }
    }

    /// Adds what a line of a plan makes happen, and what has to hold meanwhile.
    fn add(
        &self,
        line: &str,
        happenings: &mut Vec<Happening>,
        lasting: &mut Vec<(i64, i64, Tree, Bindings)>,
    ) {
        let (time, rest) = line.split_once(':').expect("a time");
        let (call, duration) = rest.trim().trim_start_matches('(').split_once(')').expect("an action");
        let mut words = call.split_whitespace().map(str::to_owned);
        let name = words.next().expect("a name");
        let action = self.actions.get(&name).unwrap_or_else(|| panic!("no action `{name}`"));
        let (parameters, objects) = (typed(action[":parameters"].list()), words.collect::<Vec<_>>());
        assert_eq!(parameters.len(), objects.len(), "{line}");
        let mut bindings = Bindings::new();
        for ((parameter, kind), object) in parameters.into_iter().zip(objects) {
            assert!(self.is_of(&object, &kind), "{line}: {object} is no {kind}");
            bindings.insert(parameter, object);
        }
        let start = thousandths(time);
        let happening = |at: i64| Happening { at, name: line.to_owned(), ..Happening::default() };
        let Some(limits) = action.get(":duration") else {
            assert_eq!(duration.trim(), "", "{line} takes no time");
            let condition = (action[":precondition"].clone(), bindings.clone());
            let effect = (action[":effect"].clone(), bindings);
            happenings.push(Happening {
                conditions: vec![condition],
                effects: vec![effect],
                ..happening(start)
            });
            return;
        };
        let duration = thousandths(duration.trim().trim_matches(['[', ']']));
        let limits = if limits.head() == "and" { limits.list()[1..].to_vec() } else { vec![limits.clone()] };
        for limit in limits {
            let limit = limit.list();
            let wanted = number(&self.first, &limit[2], &bindings);
            assert!(compare(limit[0].word(), duration as f64 / 1000.0, wanted), "{line}: its duration");
        }
        let end = start + duration;
        let (mut first, mut last) = (happening(start), happening(end));
        let parts = |key: &str| match action.get(key) {
            Some(tree) if tree.head() == "and" => tree.list()[1..].to_vec(),
            Some(tree) => vec![tree.clone()],
            None => Vec::new(),
        };
        for condition in parts(":condition") {
            let part = (condition.list()[2].clone(), bindings.clone());
            match condition.list()[1].word() {
                "start" => first.conditions.push(part),
                "end" => last.conditions.push(part),
                _ => lasting.push((start, end, part.0, part.1)),
            }
        }
        for effect in parts(":effect") {
            let part = (effect.list()[2].clone(), bindings.clone());
            let happening = if effect.list()[1].word() == "start" { &mut first } else { &mut last };
            happening.effects.push(part);
        }
        happenings.extend([first, last]);
    }

    fn needs(&self, formula: &Tree, bindings: &Bindings, touched: &mut Touched) {
        match formula.head() {
            "" => {}
            "and" | "or" | "not" => {
                formula.list()[1..].iter().for_each(|part| self.needs(part, bindings, touched));
            }
            "forall" => {
                for bindings in self.each(&formula.list()[1], bindings) {
                    self.needs(&formula.list()[2], &bindings, touched);
                }
            }
            head if is_comparison(head) => {
                formula.list()[1..].iter().for_each(|side| numbers_in(side, bindings, &mut touched.read));
            }
            _ => {
                touched.needed.insert(formula.put(bindings));
            }
        }
    }

    fn touched(&self, happening: &Happening) -> Touched {
        let mut touched = Touched::default();
        for (condition, bindings) in &happening.conditions {
            self.needs(condition, bindings, &mut touched);
        }
        let mut effects: Vec<(&Tree, &Bindings)> =
            happening.effects.iter().map(|(tree, bindings)| (tree, bindings)).collect();
        while let Some((effect, bindings)) = effects.pop() {
            match effect.head() {
                "and" => effects.extend(effect.list()[1..].iter().map(|part| (part, bindings))),
                "not" => {
                    touched.deleted.insert(effect.list()[1].put(bindings));
                }
                "increase" | "decrease" => {
                    touched.written.insert(effect.list()[1].put(bindings));
                    numbers_in(&effect.list()[2], bindings, &mut touched.read);
                }
                _ => {
                    touched.added.insert(effect.put(bindings));
                }
            }
        }
        touched
    }

    /// Mutual exclusion. Increases and decreases of one number may be at once, if nothing reads it.
    fn keep_apart(&self, one: &Happening, other: &Happening) {
        let (one_touches, other_touches) = (self.touched(one), self.touched(other));
        for (a, b) in [(&one_touches, &other_touches), (&other_touches, &one_touches)] {
            let interferes = a.needed.iter().any(|atom| b.added.contains(atom) || b.deleted.contains(atom))
                || a.added.iter().any(|atom| b.deleted.contains(atom))
                || a.read.iter().any(|number| b.written.contains(number));
            assert!(
                !interferes,
                "not far enough apart: {} at {}, {} at {}",
                one.name, one.at, other.name, other.at
            );
        }
    }
}
