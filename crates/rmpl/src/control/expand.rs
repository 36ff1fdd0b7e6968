//! Calls replaced by what they call: definitions are macros, and an automaton has no calls.

use std::collections::BTreeMap;

use smol_str::SmolStr;

use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;

use super::check_timed::{check_held, check_numbers};
use super::syntax::{
    Alternative, Argument, Constraint, ConstraintKind, ControlFile, Definition, Expression, ExpressionKind,
    Guard, Held, Name,
};

/// An automaton of more expressions than this is refused: no author means it.
const MAX_EXPRESSIONS: usize = 100_000;
/// Deeper expressions than this are refused, so that no later stage needs a deep stack.
const DEEPEST: usize = 400;

/// The body of the main definition with all calls expanded and all parameters replaced.
///
/// `None` when there is no main definition or it cannot be expanded; the diagnostics say why. Spans are those of the
/// text inside the called definition.
pub fn expand_main(file: &ControlFile) -> (Option<Expression>, Vec<Diagnostic>) {
    let Some(main) = file.main() else {
        let end = file.definitions.last().map_or(Span::default(), |definition| definition.name.span);
        let message = "the program needs a definition without parameters to start from";
        let hint = "add a definition such as `Main ():: (PARALLEL …)`";
        return (None, vec![Diagnostic::error(Code("E-UNDEF"), end, message).with_hint(hint)]);
    };
    let mut expander = Expander { file, diagnostics: Vec::new(), count: 0 };
    let body = expander.expression(&main.body, &Scope::new(), &mut vec![main.name.text.clone()], 0);
    (expander.diagnostics.is_empty().then_some(body), expander.diagnostics)
}

type Scope = BTreeMap<SmolStr, Argument>;

struct Expander<'file> {
    file: &'file ControlFile,
    diagnostics: Vec<Diagnostic>,
    count: usize,
}

impl Expander<'_> {
    fn error(&mut self, code: &'static str, span: Span, message: String) {
        // The same argument may be used in several places; it is one mistake.
        if !self.diagnostics.iter().any(|known| known.span == span && known.code == Code(code)) {
            self.diagnostics.push(Diagnostic::error(Code(code), span, message));
        }
    }

    fn expression(
        &mut self,
        from: &Expression,
        scope: &Scope,
        calls: &mut Vec<SmolStr>,
        depth: usize,
    ) -> Expression {
        self.count += 1;
        let unreadable = Expression { kind: ExpressionKind::Unreadable, span: from.span };
        if self.count > MAX_EXPRESSIONS || depth > DEEPEST {
            if self.count <= MAX_EXPRESSIONS + 1 {
                self.error(
                    "E-RECURSION",
                    from.span,
                    "the program is too large after its calls are expanded".into(),
                );
                self.count = MAX_EXPRESSIONS + 1;
            }
            return unreadable;
        }
        let mut inner = |part: &Expression| self.expression(part, scope, calls, depth + 1);
        let kind = match &from.kind {
            ExpressionKind::Unreadable => ExpressionKind::Unreadable,
            ExpressionKind::Parallel(parts) => ExpressionKind::Parallel(parts.iter().map(inner).collect()),
            ExpressionKind::Sequence(parts) => ExpressionKind::Sequence(parts.iter().map(inner).collect()),
            ExpressionKind::Always(body) => ExpressionKind::Always(Box::new(inner(body))),
            ExpressionKind::IfThenNext { guard, then, otherwise } => {
                let then = Box::new(inner(then));
                let otherwise = otherwise.as_ref().map(|otherwise| Box::new(inner(otherwise)));
                ExpressionKind::IfThenNext { guard: self.guard(guard, scope), then, otherwise }
            }
            ExpressionKind::UnlessThenNext { guard, body } => {
                let body = Box::new(inner(body));
                ExpressionKind::UnlessThenNext { guard: self.guard(guard, scope), body }
            }
            ExpressionKind::WhenDoNext { guard, body } => {
                let body = Box::new(inner(body));
                ExpressionKind::WhenDoNext { guard: self.guard(guard, scope), body }
            }
            ExpressionKind::WheneverDoNext { guard, body } => {
                let body = Box::new(inner(body));
                ExpressionKind::WheneverDoNext { guard: self.guard(guard, scope), body }
            }
            ExpressionKind::DoWatching { guard, body } => {
                let body = Box::new(inner(body));
                ExpressionKind::DoWatching { guard: self.guard(guard, scope), body }
            }
            ExpressionKind::Wait(duration) => ExpressionKind::Wait(self.word(duration, scope)),
            ExpressionKind::Timeout { duration, body, otherwise } => {
                let body = Box::new(inner(body));
                let otherwise = otherwise.as_ref().map(|otherwise| Box::new(inner(otherwise)));
                ExpressionKind::Timeout { duration: self.word(duration, scope), body, otherwise }
            }
            ExpressionKind::Within { least, most, body, otherwise } => {
                let body = Box::new(inner(body));
                let otherwise = otherwise.as_ref().map(|otherwise| Box::new(inner(otherwise)));
                let (least, most) = (self.word(least, scope), self.word(most, scope));
                ExpressionKind::Within { least, most, body, otherwise }
            }
            ExpressionKind::At { time, body } => {
                let body = Box::new(inner(body));
                ExpressionKind::At { time: self.word(time, scope), body }
            }
            ExpressionKind::Every { period, body } => {
                let body = Box::new(inner(body));
                ExpressionKind::Every { period: self.word(period, scope), body }
            }
            ExpressionKind::Warp { factor, body } => {
                let body = Box::new(inner(body));
                ExpressionKind::Warp { factor: self.word(factor, scope), body }
            }
            ExpressionKind::Lock { constraint, body } => {
                let body = Box::new(inner(body));
                ExpressionKind::Lock { constraint: self.constraint(constraint, scope), body }
            }
            ExpressionKind::Reward(reward) => ExpressionKind::Reward(self.word(reward, scope)),
            ExpressionKind::ChooseProb(alternatives) => {
                ExpressionKind::ChooseProb(self.alternatives(alternatives, scope, calls, depth))
            }
            ExpressionKind::ChooseReward(alternatives) => {
                ExpressionKind::ChooseReward(self.alternatives(alternatives, scope, calls, depth))
            }
            ExpressionKind::Assert(constraint) => self.assertion(constraint, scope),
            ExpressionKind::Call { name, arguments, .. } => {
                return self.call(name, arguments, from, scope, calls, depth);
            }
        };
        let expanded = Expression { kind, span: from.span };
        self.check_handed(check_numbers(&expanded, &|_| false));
        expanded
    }

    fn alternatives(
        &mut self,
        from: &[Alternative],
        scope: &Scope,
        calls: &mut Vec<SmolStr>,
        depth: usize,
    ) -> Vec<Alternative> {
        let each = from.iter().map(|alternative| Alternative {
            weight: self.word(&alternative.weight, scope),
            body: self.expression(&alternative.body, scope, calls, depth + 1),
        });
        each.collect()
    }

    /// Numbers that calls hand over are known only now; the others have been checked.
    fn check_handed(&mut self, found: Vec<Diagnostic>) {
        for diagnostic in found {
            let is_same = |known: &Diagnostic| known.span == diagnostic.span && known.code == diagnostic.code;
            if !self.diagnostics.iter().any(is_same) {
                self.diagnostics.push(diagnostic);
            }
        }
    }

    /// A constraint that is asserted; a parameter there may also represent a whole expression.
    fn assertion(&mut self, constraint: &Constraint, scope: &Scope) -> ExpressionKind {
        if let ConstraintKind::Parameter(name) = &constraint.kind
            && let Some(Argument::Expression(expression)) = scope.get(&name.text)
        {
            return expression.kind.clone();
        }
        ExpressionKind::Assert(self.constraint(constraint, scope))
    }

    fn call(
        &mut self,
        name: &Name,
        arguments: &[Argument],
        from: &Expression,
        scope: &Scope,
        calls: &mut Vec<SmolStr>,
        depth: usize,
    ) -> Expression {
        let unreadable = Expression { kind: ExpressionKind::Unreadable, span: from.span };
        match scope.get(&name.text) {
            Some(Argument::Expression(expression)) => return expression.clone(),
            Some(Argument::Guard(guard)) => {
                let message = "non-entailment can be a guard, but not an assertion".into();
                self.error("E-CONSTRAINT", guard.span, message);
                return unreadable;
            }
            Some(Argument::Word(word)) => {
                let word = word.clone();
                return match truth(&word) {
                    Some(kind) => {
                        let constraint = Constraint { kind, span: word.span };
                        Expression { kind: ExpressionKind::Assert(constraint), span: word.span }
                    }
                    None => self.enter(&word, &[], from.span, calls, depth),
                };
            }
            None => {}
        }
        let arguments: Vec<Argument> =
            arguments.iter().map(|argument| self.argument(argument, scope, calls, depth)).collect();
        self.enter(name, &arguments, from.span, calls, depth)
    }

    fn enter(
        &mut self,
        name: &Name,
        arguments: &[Argument],
        span: Span,
        calls: &mut Vec<SmolStr>,
        depth: usize,
    ) -> Expression {
        let unreadable = Expression { kind: ExpressionKind::Unreadable, span };
        let file = self.file;
        let called: Option<&Definition> =
            file.definitions.iter().chain(&file.methods).find(|known| known.name.text == name.text);
        let Some(called) = called.filter(|called| called.parameters.len() == arguments.len()) else {
            self.error("E-UNDEF", name.span, format!("`{}` cannot be used as an expression here", name.text));
            return unreadable;
        };
        if calls.contains(&called.name.text) {
            self.error("E-RECURSION", name.span, format!("`{}` calls itself", name.text));
            return unreadable;
        }
        let scope =
            called.parameters.iter().map(|known| known.text.clone()).zip(arguments.iter().cloned()).collect();
        calls.push(called.name.text.clone());
        let body = self.expression(&called.body, &scope, calls, depth + 1);
        calls.pop();
        body
    }

    fn argument(
        &mut self,
        from: &Argument,
        scope: &Scope,
        calls: &mut Vec<SmolStr>,
        depth: usize,
    ) -> Argument {
        match from {
            Argument::Word(name) => scope.get(&name.text).cloned().unwrap_or_else(|| from.clone()),
            Argument::Guard(guard) => Argument::Guard(self.guard(guard, scope)),
            Argument::Expression(expression) => {
                Argument::Expression(self.expression(expression, scope, calls, depth + 1))
            }
        }
    }

    fn guard(&mut self, from: &Guard, scope: &Scope) -> Guard {
        let held =
            from.held.as_ref().map(|held| Held { duration: self.word(&held.duration, scope), ..*held });
        if let ConstraintKind::Parameter(name) = &from.constraint.kind
            && let Some(Argument::Guard(bound)) = scope.get(&name.text)
        {
            let bound = bound.clone();
            return match held {
                // `~p` with p itself a bar asks whether p does not hold, which is entailment again.
                None => Guard { non_entailed: bound.non_entailed != from.non_entailed, ..bound },
                Some(held) if bound.held.is_none() => {
                    let held = Held { non_entailed: bound.non_entailed != held.non_entailed, ..held };
                    Guard { non_entailed: from.non_entailed, held: Some(held), ..bound }
                }
                Some(_) => {
                    let message =
                        format!("HELD cannot be inside HELD, but the call passes HELD for `{}`", name.text);
                    self.error("E-CONSTRAINT", bound.span, message);
                    bound
                }
            };
        }
        let constraint = self.constraint(&from.constraint, scope);
        let guard = Guard { non_entailed: from.non_entailed, held, constraint, span: from.span };
        self.check_handed(check_held(&guard, &|_| false).into_iter().collect());
        guard
    }

    fn constraint(&mut self, from: &Constraint, scope: &Scope) -> Constraint {
        let kind = match &from.kind {
            ConstraintKind::True => ConstraintKind::True,
            ConstraintKind::False => ConstraintKind::False,
            ConstraintKind::Unreadable => ConstraintKind::Unreadable,
            ConstraintKind::Not(inner) => ConstraintKind::Not(Box::new(self.constraint(inner, scope))),
            ConstraintKind::And(parts) => {
                ConstraintKind::And(parts.iter().map(|part| self.constraint(part, scope)).collect())
            }
            ConstraintKind::Or(parts) => {
                ConstraintKind::Or(parts.iter().map(|part| self.constraint(part, scope)).collect())
            }
            ConstraintKind::Equals { variable, value } => ConstraintKind::Equals {
                variable: self.word(variable, scope),
                value: self.word(value, scope),
            },
            ConstraintKind::Parameter(name) => return self.bound_constraint(name, from.span, scope),
        };
        Constraint { kind, span: from.span }
    }

    fn bound_constraint(&mut self, name: &Name, span: Span, scope: &Scope) -> Constraint {
        let message = match scope.get(&name.text) {
            Some(Argument::Expression(Expression { kind: ExpressionKind::Assert(constraint), .. })) => {
                return constraint.clone();
            }
            Some(Argument::Word(word)) => match truth(word) {
                Some(kind) => return Constraint { kind, span: word.span },
                None => {
                    format!(
                        "`{}` is used as a constraint, but the call passes the word `{}`",
                        name.text, word.text
                    )
                }
            },
            Some(Argument::Expression(_)) => {
                format!("`{}` is used as a constraint, but the call passes an expression", name.text)
            }
            Some(Argument::Guard(_)) => {
                format!("`{}` is used inside a constraint, but the call passes `~…`", name.text)
            }
            None => format!("`{}` is neither a constraint nor a parameter", name.text),
        };
        let code = if scope.contains_key(&name.text) { "E-CONSTRAINT" } else { "E-UNDEF" };
        let place = match scope.get(&name.text) {
            Some(Argument::Expression(given)) => given.span,
            Some(Argument::Guard(given)) => given.span,
            Some(Argument::Word(given)) => given.span,
            None => span,
        };
        self.error(code, place, message);
        Constraint { kind: ConstraintKind::Unreadable, span }
    }

    fn word(&mut self, from: &Name, scope: &Scope) -> Name {
        match scope.get(&from.text) {
            None => from.clone(),
            Some(Argument::Word(word)) => Name { text: word.text.clone(), span: word.span },
            Some(Argument::Expression(Expression { span, .. }) | Argument::Guard(Guard { span, .. })) => {
                let span = *span;
                self.error(
                    "E-CONSTRAINT",
                    span,
                    format!("`{}` is used as a name, but the call passes an expression", from.text),
                );
                from.clone()
            }
        }
    }
}

fn truth(word: &Name) -> Option<ConstraintKind> {
    match word.text.to_ascii_lowercase().as_str() {
        "true" => Some(ConstraintKind::True),
        "false" => Some(ConstraintKind::False),
        _ => None,
    }
}
