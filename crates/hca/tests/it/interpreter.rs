//! Random programs: the automaton's trace is that of a direct interpreter of the constructs.
//!
//! The interpreter walks the expression tree and shares nothing with the compiler but the reader.

use std::collections::BTreeMap;

use hca::{Stepper, Vocabulary, compile_text};
use rmpl::control::{Constraint, ConstraintKind, Expression, ExpressionKind, Guard, expand_main, parse};
use smol_str::SmolStr;

type Known = BTreeMap<String, String>;

const DOMAINS: [(&str, [&str; 2]); 3] = [("a", ["p", "q"]), ("b", ["p", "q"]), ("c", ["p", "q"])];

/// An expression with its own location's mark.
struct Running<'tree> {
    form: &'tree Expression,
    marked: bool,
    parts: Vec<Running<'tree>>,
}

impl<'tree> Running<'tree> {
    fn idle(form: &'tree Expression) -> Self {
        let parts: Vec<&Expression> = match &form.kind {
            ExpressionKind::Parallel(parts) | ExpressionKind::Sequence(parts) => parts.iter().collect(),
            ExpressionKind::Always(body)
            | ExpressionKind::UnlessThenNext { body, .. }
            | ExpressionKind::WhenDoNext { body, .. }
            | ExpressionKind::WheneverDoNext { body, .. }
            | ExpressionKind::DoWatching { body, .. } => vec![body],
            ExpressionKind::IfThenNext { then, otherwise, .. } => {
                std::iter::once(&**then).chain(otherwise.as_deref()).collect()
            }
            _ => Vec::new(),
        };
        Self { form, marked: false, parts: parts.into_iter().map(Self::idle).collect() }
    }

    fn start(&mut self) {
        match &self.form.kind {
            ExpressionKind::Parallel(_) | ExpressionKind::DoWatching { .. } => {
                self.parts.iter_mut().for_each(Self::start);
            }
            ExpressionKind::Sequence(_) => self.parts[0].start(),
            ExpressionKind::Always(_) => {
                self.marked = true;
                self.parts[0].start();
            }
            _ => self.marked = true,
        }
    }

    fn active(&self) -> bool {
        self.marked || self.parts.iter().any(Self::active)
    }

    fn clear(&mut self) {
        self.marked = false;
        self.parts.iter_mut().for_each(Self::clear);
    }

    fn flags(&self, into: &mut Vec<bool>) {
        into.push(self.marked);
        self.parts.iter().for_each(|part| part.flags(into));
    }

    fn asserted(&self, into: &mut Vec<String>) {
        if self.marked {
            into.push(match &self.form.kind {
                ExpressionKind::Assert(constraint) => format!("assert {constraint}"),
                ExpressionKind::Always(_) => "always".into(),
                ExpressionKind::IfThenNext { guard, .. } => format!("if {guard}"),
                ExpressionKind::UnlessThenNext { guard, .. } => format!("unless {guard}"),
                ExpressionKind::WhenDoNext { guard, .. } => format!("when {guard}"),
                ExpressionKind::WheneverDoNext { guard, .. } => format!("whenever {guard}"),
                _ => unreachable!("only these have a location"),
            });
        }
        self.parts.iter().for_each(|part| part.asserted(into));
    }

    /// One step of what is active here: what it marks goes to `next`, which has this tree's shape and holds nothing that is
    /// started from outside. Returns whether it completes (SPEC 8.3).
    fn step(&self, known: &Known, next: &mut Self) -> bool {
        let is_watched = match &self.form.kind {
            ExpressionKind::DoWatching { guard, .. } => holds(guard, known),
            _ => false,
        };
        if !self.active() || is_watched {
            return self.active();
        }
        let completed: Vec<bool> =
            self.parts.iter().zip(&mut next.parts).map(|(part, next)| part.step(known, next)).collect();
        let some_part_completes = completed.contains(&true);
        match &self.form.kind {
            ExpressionKind::Assert(constraint) => {
                next.marked |= !entailed(constraint, known);
                return !next.marked;
            }
            ExpressionKind::Parallel(_) => return !next.active(),
            ExpressionKind::Sequence(_) => {
                let (last, before) = completed.split_last().expect("a sequence has parts");
                for (at, _) in before.iter().enumerate().filter(|(_, completed)| **completed) {
                    next.parts[at + 1].start();
                }
                return *last;
            }
            ExpressionKind::Always(_) => {
                if self.marked {
                    next.start();
                }
                return false;
            }
            ExpressionKind::WheneverDoNext { guard, .. } => {
                next.marked |= self.marked;
                if self.marked && holds(guard, known) {
                    next.parts[0].start();
                }
                return false;
            }
            ExpressionKind::WhenDoNext { guard, .. } if self.marked => {
                if holds(guard, known) {
                    next.parts[0].start();
                } else {
                    next.marked = true;
                }
            }
            ExpressionKind::IfThenNext { guard, .. } if self.marked => {
                match next.parts.get_mut(usize::from(!holds(guard, known))) {
                    Some(part) => part.start(),
                    None => return true,
                }
            }
            ExpressionKind::UnlessThenNext { guard, .. } if self.marked => {
                if holds(guard, known) {
                    return true;
                }
                next.parts[0].start();
            }
            _ => {}
        }
        some_part_completes
    }
}

fn holds(guard: &Guard, known: &Known) -> bool {
    entailed(&guard.constraint, known) != guard.non_entailed
}

/// True in every completion, by trying them all.
fn entailed(constraint: &Constraint, known: &Known) -> bool {
    let Some((name, values)) = DOMAINS.iter().find(|(name, _)| !known.contains_key(*name)) else {
        return satisfied(constraint, known);
    };
    values.iter().all(|value| {
        let mut more = known.clone();
        more.insert((*name).into(), (*value).into());
        entailed(constraint, &more)
    })
}

fn satisfied(constraint: &Constraint, known: &Known) -> bool {
    match &constraint.kind {
        ConstraintKind::True => true,
        ConstraintKind::Equals { variable, value } => known[variable.text.as_str()] == value.text.as_str(),
        ConstraintKind::Not(inner) => !satisfied(inner, known),
        ConstraintKind::And(parts) => parts.iter().all(|part| satisfied(part, known)),
        ConstraintKind::Or(parts) => parts.iter().any(|part| satisfied(part, known)),
        _ => false,
    }
}

/// A small reproducible generator (a linear congruential one, high bits used).
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % sides
    }

    fn constraint(&mut self, depth: u64) -> String {
        match self.roll(if depth == 0 { 4 } else { 8 }) {
            0..=3 => {
                let (name, values) = DOMAINS[self.roll(3) as usize];
                format!("({name} = {})", values[self.roll(2) as usize])
            }
            4 => format!("(NOT {})", self.constraint(depth - 1)),
            5 => "true".into(),
            6 => format!("({} AND {})", self.constraint(depth - 1), self.constraint(depth - 1)),
            _ => format!("({} OR {})", self.constraint(depth - 1), self.constraint(depth - 1)),
        }
    }

    fn guard(&mut self) -> String {
        let bar = if self.roll(3) == 0 { "~" } else { "" };
        format!("{bar}{}", self.constraint(1))
    }

    fn expression(&mut self, depth: u64) -> String {
        let part = |dice: &mut Self| dice.expression(depth.saturating_sub(1));
        match self.roll(if depth == 0 { 1 } else { 10 }) {
            0 => self.constraint(1),
            1 => format!("(PARALLEL {} {})", part(self), part(self)),
            2 | 3 => format!("(SEQUENCE {} {} {})", part(self), part(self), part(self)),
            4 => format!("(ALWAYS {})", part(self)),
            5 => format!("(IF-THENNEXT-ELSENEXT {} {} {})", self.guard(), part(self), part(self)),
            6 => format!("(UNLESS-THENNEXT {} {})", self.guard(), part(self)),
            7 => format!("(WHEN-DONEXT {} {})", self.guard(), part(self)),
            8 => format!("(WHENEVER-DONEXT {} {})", self.guard(), part(self)),
            _ => format!("(DO-WATCHING {} {})", self.guard(), part(self)),
        }
    }
}

#[test]
fn random_programs_run_as_a_direct_interpreter_runs_them() {
    let vocabulary = Vocabulary {
        domains: DOMAINS
            .iter()
            .map(|(name, values)| (SmolStr::new(*name), values.map(SmolStr::new).to_vec()))
            .collect(),
        ..Vocabulary::default()
    };
    let mut left_after_steps = 0;
    for seed in 0..3000 {
        let mut dice = Dice(seed);
        dice.roll(2);
        let text = dice.expression(4);
        let compilation = compile_text(&text, &vocabulary);
        assert_eq!(compilation.diagnostics, [], "seed {seed}: {text}");
        let automaton = compilation.automaton.expect("compiles");
        let tree = expand_main(&parse(&text).file).0.expect("expands");
        let mut running = Running::idle(&tree);
        running.start();
        let mut stepper = Stepper::new(&automaton);
        for step in 0..8 {
            let mut labels = Vec::new();
            running.asserted(&mut labels);
            labels.sort();
            assert_eq!(automaton.labels(stepper.marking()), labels, "seed {seed} step {step}: {text}");
            let mut known = Known::new();
            for (name, values) in DOMAINS {
                if let Some(value) = values.get(dice.roll(3) as usize) {
                    known.insert(name.into(), (*value).into());
                }
            }
            let mut next = Running::idle(&tree);
            next.clear();
            running.step(&known, &mut next);
            stepper
                .step(&automaton.estimate(known.iter().map(|(name, value)| (name.as_str(), value.as_str()))));
            let (mut before, mut after) = (Vec::new(), Vec::new());
            running.flags(&mut before);
            next.flags(&mut after);
            left_after_steps += u32::from(before != after);
            running = next;
        }
    }
    assert!(left_after_steps > 3000, "the programs do move: {left_after_steps}");
}
