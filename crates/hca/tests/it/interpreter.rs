//! Random programs: the automaton's trace is that of a direct interpreter of the constructs.
//!
//! The interpreter walks the expression tree and shares nothing with the compiler but the reader.

use std::collections::BTreeMap;

use hca::{Stepper, Vocabulary, compile_text};
use rmpl::control::{Constraint, ConstraintKind, Expression, ExpressionKind, Guard, expand_main, parse};
use smol_str::SmolStr;

type Known = BTreeMap<String, String>;

const DOMAINS: [(&str, [&str; 2]); 3] = [("a", ["p", "q"]), ("b", ["p", "q"]), ("c", ["p", "q"])];

/// A number of steps as a fraction.
type Steps = (u64, u64);

/// What has been seen so far: the estimates at the ends of all steps, this one included. Before the first there is none.
type Seen<'history> = &'history [Known];

/// An expression with its own location's mark.
struct Running<'tree> {
    form: &'tree Expression,
    marked: bool,
    /// Of WAIT, which of the parts of its sequence are marked.
    waits: Vec<bool>,
    /// Of TIMEOUT and EVERY, the steps since the latest start.
    age: u64,
    /// What completed alternatives count in the step that made it.
    earned: i64,
    /// How long a step is, in thousandths of a second, and what durations are divided by.
    scale: (u64, Steps),
    parts: Vec<Running<'tree>>,
}

impl<'tree> Running<'tree> {
    fn idle(form: &'tree Expression, scale: (u64, Steps)) -> Self {
        let inner = match &form.kind {
            ExpressionKind::Warp { factor, .. } => {
                let (over, under) = fraction(&factor.text);
                (scale.0, (scale.1.0 * over, scale.1.1 * under))
            }
            _ => scale,
        };
        let mut idle = Self {
            form,
            marked: false,
            waits: Vec::new(),
            age: 0,
            earned: 0,
            scale,
            parts: form.parts().into_iter().map(|part| Self::idle(part, inner)).collect(),
        };
        if let ExpressionKind::Wait(duration) = &form.kind {
            idle.waits = vec![false; idle.steps(&duration.text) as usize];
        }
        idle
    }

    /// Returns how many steps a duration takes here.
    fn steps(&self, written: &str) -> u64 {
        let (step_millis, (over, under)) = self.scale;
        let end = written.find(|c: char| c.is_alphabetic() || c == ' ').unwrap_or(written.len());
        let (numerator, denominator) = fraction(&written[..end]);
        let (numerator, denominator) = match written[end..].trim() {
            "" => (numerator, denominator),
            "ms" => (numerator, denominator * step_millis),
            "s" => (numerator * 1000, denominator * step_millis),
            unit => panic!("the programs have no durations in {unit}"),
        };
        (numerator * under).div_ceil(denominator * over)
    }

    /// Starts it at the end of a step, for the next one.
    fn start(&mut self, seen: Seen<'_>) {
        self.age = 0;
        match &self.form.kind {
            ExpressionKind::Parallel(_) | ExpressionKind::DoWatching { .. } | ExpressionKind::Warp { .. } => {
                self.parts.iter_mut().for_each(|part| part.start(seen));
            }
            ExpressionKind::Sequence(_) | ExpressionKind::Timeout { .. } => self.parts[0].start(seen),
            ExpressionKind::ChooseReward(_) => {
                let (rewards, best) = self.rewards();
                let chosen = rewards.iter().position(|reward| *reward == best).expect("an alternative");
                self.parts[chosen].start(seen);
            }
            ExpressionKind::Always(_) | ExpressionKind::Every { .. } => {
                self.marked = true;
                self.parts[0].start(seen);
            }
            ExpressionKind::Wait(_) => self.waits[0] = true,
            ExpressionKind::At { time, .. } => {
                if self.steps(&time.text) <= seen.len() as u64 {
                    self.parts[0].start(seen);
                } else {
                    self.marked = true;
                }
            }
            _ => self.marked = true,
        }
    }

    /// The rewards of alternatives, and the largest of them.
    fn rewards(&self) -> (Vec<i64>, i64) {
        let ExpressionKind::ChooseReward(alternatives) = &self.form.kind else { return (Vec::new(), 0) };
        let rewards = alternatives.iter().map(|it| it.weight.text.parse().expect("a whole reward"));
        let rewards: Vec<i64> = rewards.collect();
        let best = rewards.iter().copied().max().expect("an alternative");
        (rewards, best)
    }

    /// Returns what all alternatives that completed count.
    fn all_earned(&self) -> i64 {
        self.earned + self.parts.iter().map(Self::all_earned).sum::<i64>()
    }

    /// Returns what marked rewards count.
    fn marked_rewards(&self) -> i64 {
        let own = match &self.form.kind {
            ExpressionKind::Reward(reward) if self.marked => reward.text.parse().expect("a whole reward"),
            _ => 0,
        };
        own + self.parts.iter().map(Self::marked_rewards).sum::<i64>()
    }

    fn active(&self) -> bool {
        self.marked || self.waits.contains(&true) || self.parts.iter().any(Self::active)
    }

    fn clear(&mut self) {
        self.marked = false;
        self.waits.fill(false);
        self.parts.iter_mut().for_each(Self::clear);
    }

    fn flags(&self, into: &mut Vec<bool>) {
        into.push(self.marked);
        into.extend(&self.waits);
        self.parts.iter().for_each(|part| part.flags(into));
    }

    fn asserted(&self, into: &mut Vec<String>) {
        if self.marked || self.waits.contains(&true) {
            let label = match &self.form.kind {
                ExpressionKind::Assert(constraint) => format!("assert {constraint}"),
                ExpressionKind::Always(_) => "always".into(),
                ExpressionKind::IfThenNext { guard, .. } => format!("if {guard}"),
                ExpressionKind::UnlessThenNext { guard, .. } => format!("unless {guard}"),
                ExpressionKind::WhenDoNext { guard, .. } => format!("when {guard}"),
                ExpressionKind::WheneverDoNext { guard, .. } => format!("whenever {guard}"),
                ExpressionKind::Wait(_) => "wait".into(),
                ExpressionKind::Reward(reward) => format!("reward {}", reward.text),
                ExpressionKind::At { .. } => "at".into(),
                ExpressionKind::Every { .. } => "every".into(),
                _ => unreachable!("only these have a location"),
            };
            into.push(without_durations(&label));
        }
        self.parts.iter().for_each(|part| part.asserted(into));
    }

    /// One step of what is active here: what it marks goes to `next`, which has this tree's shape and holds nothing that is
    /// started from outside. Returns whether it completes (SPEC 8.3).
    fn step(&self, seen: Seen<'_>, next: &mut Self) -> bool {
        let holds = |guard: &Guard| self.holds(guard, seen);
        let known = seen.last().expect("a step has an estimate");
        let is_watched = match &self.form.kind {
            ExpressionKind::DoWatching { guard, .. } => holds(guard),
            _ => false,
        };
        if !self.active() || is_watched {
            return self.active();
        }
        let completed: Vec<bool> =
            self.parts.iter().zip(&mut next.parts).map(|(part, next)| part.step(seen, next)).collect();
        let some_part_completes = completed.contains(&true);
        next.age = self.age + 1;
        match &self.form.kind {
            ExpressionKind::Assert(constraint) => {
                next.marked |= !entailed(constraint, known);
                return !next.marked;
            }
            ExpressionKind::Reward(_) => return true,
            ExpressionKind::ChooseReward(_) => {
                let (rewards, _) = self.rewards();
                let completed = completed.iter().zip(rewards).filter(|(completed, _)| **completed);
                next.earned = completed.map(|(_, reward)| reward).sum();
            }
            ExpressionKind::Parallel(_) => return !next.active(),
            ExpressionKind::Sequence(_) => {
                let (last, before) = completed.split_last().expect("a sequence has parts");
                for (at, _) in before.iter().enumerate().filter(|(_, completed)| **completed) {
                    next.parts[at + 1].start(seen);
                }
                return *last;
            }
            ExpressionKind::Always(_) => {
                if self.marked {
                    next.start(seen);
                }
                return false;
            }
            ExpressionKind::WheneverDoNext { guard, .. } => {
                next.marked |= self.marked;
                if self.marked && holds(guard) {
                    next.parts[0].start(seen);
                }
                return false;
            }
            ExpressionKind::WhenDoNext { guard, .. } if self.marked => {
                if holds(guard) {
                    next.parts[0].start(seen);
                } else {
                    next.marked = true;
                }
            }
            ExpressionKind::IfThenNext { guard, .. } if self.marked => {
                match next.parts.get_mut(usize::from(!holds(guard))) {
                    Some(part) => part.start(seen),
                    None => return true,
                }
            }
            ExpressionKind::UnlessThenNext { guard, .. } if self.marked => {
                if holds(guard) {
                    return true;
                }
                next.parts[0].start(seen);
            }
            ExpressionKind::Wait(_) => {
                let (last, before) = self.waits.split_last().expect("a wait takes a step");
                for (next, before) in next.waits[1..].iter_mut().zip(before) {
                    *next |= before;
                }
                return *last;
            }
            ExpressionKind::Timeout { duration, .. } => {
                let is_up = self.steps(&duration.text) == self.age + 1;
                if is_up && next.parts[0].active() {
                    next.parts[0].clear();
                    if completed[0] {
                        return true;
                    }
                    match next.parts.get_mut(1) {
                        Some(otherwise) => otherwise.start(seen),
                        None => return true,
                    }
                }
            }
            ExpressionKind::At { time, .. } if self.marked => {
                if self.steps(&time.text) <= seen.len() as u64 {
                    next.parts[0].start(seen);
                } else {
                    next.marked = true;
                }
            }
            ExpressionKind::Every { period, .. } => {
                next.marked |= self.marked;
                if self.marked && self.steps(&period.text) == self.age + 1 {
                    next.age = 0;
                    next.parts[0].start(seen);
                }
                return false;
            }
            _ => {}
        }
        some_part_completes
    }

    fn holds(&self, guard: &Guard, seen: Seen<'_>) -> bool {
        let satisfied = |known: &Known, is_barred: bool| entailed(&guard.constraint, known) != is_barred;
        let Some(held) = &guard.held else {
            return satisfied(seen.last().expect("a step has an estimate"), guard.non_entailed);
        };
        let steps = self.steps(&held.duration.text) as usize;
        let lasted = seen.len() >= steps
            && seen[seen.len() - steps..].iter().all(|known| satisfied(known, held.non_entailed));
        lasted != guard.non_entailed
    }
}

/// A decimal as a fraction.
fn fraction(text: &str) -> Steps {
    let (whole, decimals) = text.trim().split_once('.').unwrap_or((text.trim(), ""));
    let digits = format!("{whole}{decimals}");
    (digits.parse().expect("digits"), 10_u64.pow(decimals.len() as u32))
}

/// A label without what it says of durations, which WARP changes.
fn without_durations(label: &str) -> String {
    let first = label.split(' ').next().unwrap_or_default();
    match first {
        "wait" | "at" | "every" => first.into(),
        _ if label.contains("(HELD ") => format!("{first} held"),
        _ => label.into(),
    }
}

/// WITHIN written as what it means.
fn without_within(expression: &mut Expression) {
    let span = expression.span;
    match &mut expression.kind {
        ExpressionKind::Parallel(parts) | ExpressionKind::Sequence(parts) => {
            parts.iter_mut().for_each(without_within);
        }
        ExpressionKind::IfThenNext { then, otherwise, .. } => {
            without_within(then);
            if let Some(otherwise) = otherwise {
                without_within(otherwise);
            }
        }
        ExpressionKind::Timeout { body, otherwise, .. } | ExpressionKind::Within { body, otherwise, .. } => {
            without_within(body);
            if let Some(otherwise) = otherwise {
                without_within(otherwise);
            }
        }
        ExpressionKind::Always(body)
        | ExpressionKind::UnlessThenNext { body, .. }
        | ExpressionKind::WhenDoNext { body, .. }
        | ExpressionKind::WheneverDoNext { body, .. }
        | ExpressionKind::DoWatching { body, .. }
        | ExpressionKind::At { body, .. }
        | ExpressionKind::Every { body, .. }
        | ExpressionKind::Warp { body, .. } => without_within(body),
        ExpressionKind::ChooseReward(alternatives) => {
            for alternative in alternatives {
                without_within(&mut alternative.body);
            }
        }
        _ => {}
    }
    if let ExpressionKind::Within { least, most, body, otherwise } = &expression.kind {
        let wait = Expression { kind: ExpressionKind::Wait(least.clone()), span };
        let both = Expression { kind: ExpressionKind::Parallel(vec![(**body).clone(), wait]), span };
        let (duration, otherwise) = (most.clone(), otherwise.clone());
        expression.kind = ExpressionKind::Timeout { duration, body: Box::new(both), otherwise };
    }
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
        let guard = Self::guard;
        match self.roll(if depth == 0 { 1 } else { 10 }) {
            0 => self.constraint(1),
            1 => format!("(PARALLEL {} {})", part(self), part(self)),
            2 | 3 => format!("(SEQUENCE {} {} {})", part(self), part(self), part(self)),
            4 => format!("(ALWAYS {})", part(self)),
            5 => format!("(IF-THENNEXT-ELSENEXT {} {} {})", guard(self), part(self), part(self)),
            6 => format!("(UNLESS-THENNEXT {} {})", guard(self), part(self)),
            7 => format!("(WHEN-DONEXT {} {})", guard(self), part(self)),
            8 => format!("(WHENEVER-DONEXT {} {})", guard(self), part(self)),
            _ => format!("(DO-WATCHING {} {})", guard(self), part(self)),
        }
    }

    fn duration(&mut self) -> String {
        match self.roll(6) {
            0 => "1".into(),
            1 => "2".into(),
            2 => "3".into(),
            3 => "2.5".into(),
            4 => "1.5s".into(),
            _ => "750 ms".into(),
        }
    }

    fn held_guard(&mut self) -> String {
        let bar = if self.roll(3) == 0 { "~" } else { "" };
        match self.roll(2) {
            0 => format!("{bar}(HELD {} {})", self.duration(), self.guard()),
            _ => self.guard(),
        }
    }

    /// A program in which time matters.
    fn timed(&mut self, depth: u64) -> String {
        let part = |dice: &mut Self| dice.timed(depth.saturating_sub(1));
        let (guard, duration) = (Self::held_guard, Self::duration);
        match self.roll(if depth == 0 { 3 } else { 21 }) {
            0 | 1 => self.constraint(1),
            2 => format!("(WAIT {})", self.duration()),
            3 => format!("(PARALLEL {} {})", part(self), part(self)),
            4 => format!("(SEQUENCE {} {} {})", part(self), part(self), part(self)),
            5 => format!("(ALWAYS {})", part(self)),
            6 => format!("(IF-THENNEXT-ELSENEXT {} {} {})", guard(self), part(self), part(self)),
            7 => format!("(WHEN-DONEXT {} {})", guard(self), part(self)),
            8 => format!("(WHENEVER-DONEXT {} {})", guard(self), part(self)),
            9 => format!("(DO-WATCHING {} {})", guard(self), part(self)),
            10 | 11 => format!("(TIMEOUT {} {} {})", duration(self), part(self), part(self)),
            12 => format!("(TIMEOUT {} {})", duration(self), part(self)),
            13 => format!("(WITHIN 1 3 {} {})", part(self), part(self)),
            14 => format!("(AT {} {})", duration(self), part(self)),
            15 => format!("(EVERY {} {})", duration(self), part(self)),
            16 => format!("(WARP {} {})", ["2", "0.5"][self.roll(2) as usize], part(self)),
            17 => format!("(CHOOSE-REWARD ({} {}) (1 {}))", self.roll(3), part(self), part(self)),
            18 => format!("(REWARD {})", self.roll(9) + 1),
            _ => format!("(WHENEVER-DONEXT {} (TIMEOUT {} {}))", guard(self), duration(self), part(self)),
        }
    }
}

#[test]
fn random_programs_run_as_a_direct_interpreter_runs_them() {
    let moves = compare(0..3000, 1000, |dice| dice.expression(4));
    assert!(moves > 3000, "the programs do move: {moves}");
}

#[test]
fn random_programs_in_time_run_as_a_direct_interpreter_runs_them() {
    for step_millis in [1000, 500, 300] {
        let moves =
            compare(0..3000, step_millis, |dice| format!("(DEFSTEP {step_millis}ms)\n{}", dice.timed(4)));
        assert!(moves > 3000, "the programs do move: {moves}");
    }
}

/// Runs programs both ways, and returns after how many steps something was marked that was not before, or the other way.
fn compare(seeds: std::ops::Range<u64>, step_millis: u64, program: impl Fn(&mut Dice) -> String) -> u32 {
    let vocabulary = Vocabulary {
        domains: DOMAINS
            .iter()
            .map(|(name, values)| (SmolStr::new(*name), values.map(SmolStr::new).to_vec()))
            .collect(),
        ..Vocabulary::default()
    };
    let mut moves = 0;
    for seed in seeds {
        let mut dice = Dice(seed);
        dice.roll(2);
        let text = program(&mut dice);
        let compilation = compile_text(&text, &vocabulary);
        assert_eq!(compilation.diagnostics, [], "seed {seed}: {text}");
        let automaton = compilation.automaton.expect("compiles");
        let mut tree = expand_main(&parse(&text).file).0.expect("expands");
        without_within(&mut tree);
        let scale = (step_millis, (1, 1));
        let mut running = Running::idle(&tree, scale);
        running.start(&[]);
        let mut stepper = Stepper::new(&automaton);
        let mut seen: Vec<Known> = Vec::new();
        for step in 0..12 {
            let mut labels = Vec::new();
            running.asserted(&mut labels);
            labels.sort();
            let mut found: Vec<String> =
                automaton.labels(stepper.marking()).iter().map(|label| without_durations(label)).collect();
            found.sort();
            assert_eq!(found, labels, "seed {seed} step {step}: {text}");
            let mut known = Known::new();
            for (name, values) in DOMAINS {
                if let Some(value) = values.get(dice.roll(3) as usize) {
                    known.insert(name.into(), (*value).into());
                }
            }
            let mut trace = hca::TraceStep::at(&stepper, step + 1);
            let pairs = known.iter().map(|(name, value)| (name.as_str(), value.as_str()));
            stepper.step_observed(&[automaton.estimate(pairs)], &mut trace);
            seen.push(known);
            let mut next = Running::idle(&tree, scale);
            running.step(&seen, &mut next);
            let counted = (running.marked_rewards() + next.all_earned()).to_string();
            assert_eq!(trace.reward.to_string(), counted, "seed {seed} step {step}: {text}");
            let (mut before, mut after) = (Vec::new(), Vec::new());
            running.flags(&mut before);
            next.flags(&mut after);
            moves += u32::from(before != after);
            running = next;
        }
    }
    moves
}
