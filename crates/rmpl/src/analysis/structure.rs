//! What follows from two rules that surprise authors (SPEC 3.3): parallel branches start at the same instant, and a
//! sequence never idles.

use exact::{Bound, Time};

use super::check::Meaning;
use super::constant;
use super::index::Namespace;
use crate::diagnostic::Diagnostic;
use crate::diagnostics::{slack, together, window};
use crate::lower::Item;
use crate::program::{
    Condition, Expr, HeaderBound, HeaderBounds, LabelMode, MembersForm, Statement, StatementKind,
};
use crate::span::Span;

/// Least and greatest duration.
type Interval = (Time, Bound);

const ANY: Interval = (Time::ZERO, Bound::Infinite);

/// Oddities of the structure of an activity or a scenario.
pub(super) fn structure(item: &Item, meaning: Meaning<'_>) -> Vec<Diagnostic> {
    let mut structure = Structure { meaning, found: Vec::new() };
    match item {
        Item::Activity(decl) => {
            let body = structure.duration(&decl.body);
            if let HeaderBounds::Sides { lower, upper, span } = &decl.bounds {
                let lower = limit(lower).and_then(Bound::finite).unwrap_or(Time::ZERO);
                let upper = limit(upper).unwrap_or(Bound::Infinite);
                structure.compare(&decl.body, body, (lower, upper), *span, false);
            }
        }
        Item::Scenario(decl) => {
            let body = structure.duration(&decl.body);
            if let Some(bounds) = &decl.bounds
                && let Some(horizon) = constant::interval(bounds)
            {
                structure.compare(&decl.body, body, horizon, bounds.span, false);
            }
        }
        _ => {}
    }
    structure.found
}

fn limit(side: &HeaderBound) -> Option<Bound> {
    match side {
        HeaderBound::Limit(limit) => constant::evaluate(limit).ok(),
        HeaderBound::Parameter(_) => None,
    }
}

struct Structure<'a> {
    meaning: Meaning<'a>,
    found: Vec<Diagnostic>,
}

impl Structure<'_> {
    /// Returns how long `statement` can take, as far as that is constant; reports what does not fit on the way.
    fn duration(&mut self, statement: &Statement) -> Interval {
        let is_leaf;
        let own = match &statement.kind {
            StatementKind::Sequence(parts) => {
                is_leaf = false;
                parts.iter().fold((Time::ZERO, Bound::ZERO), |sum, part| {
                    let part = self.duration(part);
                    let lower = sum.0.checked_add(part.0);
                    let upper = sum.1.checked_add(part.1);
                    lower.zip(upper).unwrap_or(ANY)
                })
            }
            StatementKind::Parallel(branches) => {
                is_leaf = false;
                self.together(branches);
                let least = branches.iter().map(|branch| self.duration(branch).0).max();
                (least.unwrap_or(Time::ZERO), Bound::Infinite)
            }
            StatementKind::Unordered(branches) => {
                is_leaf = false;
                let one_by_one = branches
                    .iter()
                    .try_fold(Time::ZERO, |sum, branch| sum.checked_add(self.duration(branch).0));
                (one_by_one.unwrap_or(Time::ZERO), Bound::Infinite)
            }
            StatementKind::Choose(alternatives) => {
                is_leaf = false;
                let each: Vec<Interval> = alternatives.iter().map(|part| self.duration(part)).collect();
                let lower = each.iter().map(|part| part.0).min().unwrap_or(Time::ZERO);
                (lower, each.iter().map(|part| part.1).max().unwrap_or(Bound::Infinite))
            }
            StatementKind::Maintaining(body, _)
            | StatementKind::Watching(body, _)
            | StatementKind::Telling(body, _)
            | StatementKind::IfThennext(_, body)
            | StatementKind::Named(body, _)
            | StatementKind::Using(body, ..) => {
                is_leaf = false;
                self.duration(body)
            }
            StatementKind::Repeat(count, body) => {
                is_leaf = false;
                let once = self.duration(body);
                repeated(count, once)
            }
            StatementKind::Members(members) => {
                is_leaf = false;
                let once = self.duration(&members.body);
                // How many members there are, other declarations say; there is at least one.
                if members.form == MembersForm::Any { once } else { (once.0, Bound::Infinite) }
            }
            StatementKind::Call(name, _) => {
                is_leaf = true;
                self.declared(&name.text)
            }
            StatementKind::Condition(_, condition) => {
                let called = self.called(condition);
                let instant = statement.bounds.is_none().then_some((Time::ZERO, Bound::ZERO));
                is_leaf = true;
                called.or(instant).unwrap_or(ANY)
            }
            StatementKind::Delay => {
                is_leaf = true;
                ANY
            }
        };
        let Some(bounds) = &statement.bounds else { return own };
        let Some(written) = constant::interval(bounds) else { return own };
        if bounds.is_contingent {
            return written;
        }
        // What a declaration excludes altogether is an error of its own kind.
        let reports = !is_leaf || !is_disjoint(own, written) || self.is_contingent(statement);
        if reports {
            self.compare(statement, own, written, bounds.span, true);
        }
        // Of what the environment chooses, bounds require something and choose nothing.
        if is_leaf && self.is_contingent(statement) {
            return own;
        }
        let both = (own.0.max(written.0), own.1.min(written.1));
        if is_disjoint(own, written) { ANY } else { both }
    }

    /// Compares how long the parts of `statement` can take with the bounds around them.
    fn compare(
        &mut self,
        statement: &Statement,
        own: Interval,
        written: Interval,
        span: Span,
        may_bind: bool,
    ) {
        if own.1 < Bound::Finite(written.0) {
            self.found.push(window::too_short(own.1, written.0, statement, span));
        } else if Bound::Finite(own.0) > written.1 {
            self.found.push(window::too_long(own.0, written.1, span));
        } else if may_bind && written != ANY && written.0 <= own.0 && written.1 >= own.1 && own != written {
            self.found.push(slack::never_binds(own, span));
        }
    }

    fn declared(&self, name: &str) -> Interval {
        let symbol = self.meaning.names.find(name);
        let definition = symbol.and_then(|symbol| self.meaning.index.definition(Namespace::Callable, symbol));
        definition.and_then(|definition| definition.bounds).unwrap_or(ANY)
    }

    /// Returns whether a call or a name that represents one is of a primitive whose duration the environment chooses.
    fn is_contingent(&self, statement: &Statement) -> bool {
        let name = match &statement.kind {
            StatementKind::Call(name, _) => name,
            StatementKind::Condition(_, condition) if self.called(condition).is_some() => &condition.variable,
            _ => return false,
        };
        let symbol = self.meaning.names.find(&name.text);
        let definition = symbol.and_then(|symbol| self.meaning.index.definition(Namespace::Callable, symbol));
        definition.is_some_and(|definition| definition.is_contingent)
    }

    /// The duration of a bare name that is a call.
    fn called(&self, condition: &Condition) -> Option<Interval> {
        let is_plain = condition.values.is_empty()
            && condition.sees.is_none()
            && condition.level.is_none()
            && !condition.negated;
        let symbol = self.meaning.names.find(&condition.variable.text).filter(|_| is_plain)?;
        self.meaning.index.definition(Namespace::Callable, symbol)?;
        Some(self.declared(&condition.variable.text))
    }

    /// Conditions that conflict because their branches start together.
    fn together(&mut self, branches: &[Statement]) {
        let mut starts: Vec<(LabelMode, Condition)> = Vec::new();
        for branch in branches {
            let mut own = Vec::new();
            self.starting(branch, &mut own);
            for (mode, condition) in &own {
                let clash = starts.iter().find(|(_, other)| self.conflict(other, condition));
                if let Some((other_mode, other)) = clash {
                    let pair = [(*other_mode, other), (*mode, condition)];
                    self.found.push(together::conflict(pair, branch.span));
                    return;
                }
            }
            starts.extend(own);
        }
    }

    /// The conditions that hold from the very start of `statement`; gives back whether what follows it starts at the
    /// same instant.
    fn starting(&self, statement: &Statement, out: &mut Vec<(LabelMode, Condition)>) -> bool {
        let is_instant = match &statement.bounds {
            Some(bounds) => constant::interval(bounds) == Some((Time::ZERO, Bound::ZERO)),
            None => matches!(statement.kind, StatementKind::Condition(..)),
        };
        match &statement.kind {
            StatementKind::Condition(mode, condition) => {
                if self.called(condition).is_some() {
                    return false;
                }
                out.push((*mode, condition.clone()));
                is_instant
            }
            StatementKind::Sequence(parts) => parts.iter().all(|part| self.starting(part, out)),
            StatementKind::Parallel(branches) => {
                for branch in branches {
                    self.starting(branch, out);
                }
                false
            }
            StatementKind::Maintaining(body, condition) | StatementKind::IfThennext(condition, body) => {
                out.push((LabelMode::Ask, condition.clone()));
                self.starting(body, out);
                false
            }
            StatementKind::Telling(body, condition) => {
                out.push((LabelMode::Tell, condition.clone()));
                self.starting(body, out)
            }
            StatementKind::Watching(body, condition) => {
                let denied = Condition { negated: !condition.negated, ..condition.clone() };
                out.push((LabelMode::Tell, denied));
                self.starting(body, out);
                false
            }
            StatementKind::Named(body, _) => self.starting(body, out),
            StatementKind::Using(body, ..) => {
                self.starting(body, out);
                false
            }
            StatementKind::Delay => is_instant,
            // Only a copy begins here, and it may be none; of several without order, any may be the first.
            StatementKind::Choose(_)
            | StatementKind::Call(..)
            | StatementKind::Repeat(..)
            | StatementKind::Members(_)
            | StatementKind::Unordered(_) => false,
        }
    }

    /// Returns whether the two can never hold together (SPEC 3.1).
    fn conflict(&self, one: &Condition, other: &Condition) -> bool {
        let (Some(one), Some(other)) = (self.resolve(one), self.resolve(other)) else { return false };
        // What a state variable is before an instant and after it may differ.
        let lasts = || {
            let variable = self.meaning.names.find(&one.0);
            one.0.contains('.') || variable.is_some_and(|variable| self.meaning.is_state(variable))
        };
        if one.0 != other.0 || lasts() {
            return false;
        }
        match (one.2, other.2) {
            (false, false) => one.1 != other.1,
            (true, true) => {
                let names = self.meaning.names;
                let domain = names.find(&one.0).and_then(|variable| self.meaning.domain(variable));
                one.1 != other.1 && domain.is_some_and(|domain| domain.len() == 2)
            }
            _ => one.1 == other.1,
        }
    }

    /// Variable, value and negation after the `X_V` rule.
    fn resolve(&self, condition: &Condition) -> Option<(String, Option<String>, bool)> {
        let text = condition.variable.text.as_str();
        match condition.values.as_slice() {
            [] if condition.sees.is_some() || condition.level.is_some() => return None,
            [] => {}
            [value] => return Some((text.to_owned(), Some(value.text.to_string()), condition.negated)),
            _ => return None,
        }
        let whole = self.meaning.names.find(text)?;
        let split = text.rsplit_once('_').and_then(|(variable, value)| {
            let names = self.meaning.names;
            let pair = (names.find(variable)?, names.find(value)?);
            self.meaning.splits(whole, pair).then(|| (variable.to_owned(), value.to_owned()))
        });
        Some(match split {
            Some((variable, value)) => (variable, Some(value), condition.negated),
            None => (text.to_owned(), None, condition.negated),
        })
    }
}

/// Returns how long so many copies of something take.
fn repeated(count: &Expr, (lower, upper): Interval) -> Interval {
    let Ok(count) = constant::evaluate(count) else { return ANY };
    let times = |bound: Bound| bound.times(count).ok();
    let lower = times(Bound::Finite(lower)).and_then(Bound::finite);
    lower.zip(times(upper)).unwrap_or(ANY)
}

fn is_disjoint(one: Interval, other: Interval) -> bool {
    Bound::Finite(one.0.max(other.0)) > one.1.min(other.1)
}
