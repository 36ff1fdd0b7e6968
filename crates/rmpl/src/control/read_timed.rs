//! Reading the forms in time: durations, clocks, locks, and choices with weights (SPEC 8.5).

use smol_str::format_smolstr;

use crate::span::Span;

use super::duration::{is_numeral, units};
use super::keyword::{self, TIMED_KEYWORDS};
use super::lexer::TokenKind;
use super::read_program::Reader;
use super::syntax::{Alternative, Expression, ExpressionKind, Guard, Held, Name};
use super::tree::{List, Node};

impl Reader<'_> {
    /// Returns whether a list calls a definition of the text that is named like a form in time.
    pub(super) fn calls_definition(&self, list: &List) -> bool {
        let word = list.items.first().and_then(|head| keyword::word(self.text, head));
        word.is_some_and(|(word, _)| {
            let upper = word.to_ascii_uppercase();
            let is_timed = TIMED_KEYWORDS.contains(&upper.as_str()) || upper == "HELD";
            is_timed && self.defined.contains(word)
        })
    }

    /// Reads the length of a step, `(DEFSTEP 100ms)`.
    pub(super) fn step_length(&mut self, list: &List) -> Option<Name> {
        let items = list.items.get(1..).unwrap_or_default();
        if let Some((length, [])) = self.duration(items) {
            return Some(length);
        }
        let span = list.items.first().map_or(list.span, |head| Span::new(list.span.start, head.span().end));
        self.error("E-ARITY", span, "DEFSTEP takes the length of a step").hint =
            Some("for example `(DEFSTEP 100ms)`".into());
        None
    }

    /// Reads one of the forms in time.
    pub(super) fn timed_form(&mut self, keyword: &str, span: Span, items: &[Node]) -> ExpressionKind {
        match keyword {
            "WAIT" => match self.duration(items) {
                Some((duration, [])) => ExpressionKind::Wait(duration),
                _ => self.wrong_arity(keyword, span, "a duration", items.len()),
            },
            "TIMEOUT" => self.timeout(span, items),
            "WITHIN" => self.within(span, items),
            "AT" => self.with_body(keyword, span, items, "a time and one expression", |time, body| {
                ExpressionKind::At { time, body }
            }),
            "EVERY" => {
                self.with_body(keyword, span, items, "a duration and one expression", |period, body| {
                    ExpressionKind::Every { period, body }
                })
            }
            "WARP" => self.with_body(keyword, span, items, "a factor and one expression", |factor, body| {
                ExpressionKind::Warp { factor, body }
            }),
            "LOCK" => self.lock(span, items),
            "REWARD" => match items {
                [number @ Node::Leaf(token)] if token.kind == TokenKind::Word => {
                    self.name(number).map_or(ExpressionKind::Unreadable, ExpressionKind::Reward)
                }
                _ => self.wrong_arity(keyword, span, "a number", items.len()),
            },
            _ => self.choice(keyword, span, items),
        }
    }

    /// The duration at the front, and what follows it; its unit may stand apart.
    fn duration<'nodes>(&self, items: &'nodes [Node]) -> Option<(Name, &'nodes [Node])> {
        let (first, rest) = items.split_first()?;
        let number = self.name(first)?;
        let is_plain = is_numeral(&number.text) && !number.text.ends_with(char::is_alphabetic);
        let unit = rest
            .first()
            .and_then(|node| self.name(node))
            .filter(|word| units().contains(&word.text.as_str()) && !self.parameters.contains(&word.text));
        match unit.filter(|_| is_plain || number.text == "inf") {
            Some(unit) => {
                let text = format_smolstr!("{} {}", number.text, unit.text);
                Some((Name { text, span: number.span.cover(unit.span) }, rest.get(1..).unwrap_or_default()))
            }
            None => Some((number, rest)),
        }
    }

    fn timeout(&mut self, span: Span, items: &[Node]) -> ExpressionKind {
        let wanted = "a duration, an expression, and perhaps an alternative";
        let Some((duration, rest)) = self.duration(items) else {
            return self.wrong_arity("TIMEOUT", span, wanted, items.len());
        };
        let Some((body, otherwise)) = self.body_and_alternative(rest) else {
            return self.wrong_arity("TIMEOUT", span, wanted, items.len());
        };
        ExpressionKind::Timeout { duration, body, otherwise }
    }

    fn within(&mut self, span: Span, items: &[Node]) -> ExpressionKind {
        let wanted = "two durations, an expression, and perhaps an alternative";
        let bounds = self.duration(items).and_then(|(least, rest)| {
            let (most, rest) = self.duration(rest)?;
            Some((least, most, rest))
        });
        let Some((least, most, rest)) = bounds else {
            return self.wrong_arity("WITHIN", span, wanted, items.len());
        };
        let Some((body, otherwise)) = self.body_and_alternative(rest) else {
            return self.wrong_arity("WITHIN", span, wanted, items.len());
        };
        ExpressionKind::Within { least, most, body, otherwise }
    }

    /// `None` unless one or two expressions are written.
    fn body_and_alternative(&mut self, items: &[Node]) -> Option<(Box<Expression>, Option<Box<Expression>>)> {
        let bodies = Self::parts_of(items);
        if !(1..=2).contains(&bodies.len()) {
            return None;
        }
        let mut bodies = bodies.into_iter().map(|part| Box::new(self.part(part)));
        Some((bodies.next()?, bodies.next()))
    }

    fn with_body(
        &mut self,
        keyword: &str,
        span: Span,
        items: &[Node],
        wanted: &str,
        form: impl FnOnce(Name, Box<Expression>) -> ExpressionKind,
    ) -> ExpressionKind {
        if let Some((number, rest)) = self.duration(items)
            && let [body] = Self::parts_of(rest)[..]
        {
            let body = Box::new(self.part(body));
            return form(number, body);
        }
        self.wrong_arity(keyword, span, wanted, items.len())
    }

    fn lock(&mut self, span: Span, items: &[Node]) -> ExpressionKind {
        if let Some(bar @ Node::Leaf(token)) = items.first()
            && token.kind == TokenKind::Tilde
        {
            self.error("E-CONSTRAINT", bar.span(), "non-entailment cannot be locked").hint =
                Some("to lock the opposite of c, write `(NOT c)`".into());
            return ExpressionKind::Unreadable;
        }
        if let [constraint, rest @ ..] = items
            && let [body] = Self::parts_of(rest)[..]
        {
            let constraint = self.constraint(constraint);
            let body = Box::new(self.part(body));
            return ExpressionKind::Lock { constraint, body };
        }
        self.wrong_arity("LOCK", span, "a constraint and one expression", items.len())
    }

    fn choice(&mut self, keyword: &str, span: Span, items: &[Node]) -> ExpressionKind {
        let weight = if keyword == "CHOOSE-PROB" { "probability" } else { "reward" };
        if items.is_empty() {
            self.error("E-ARITY", span, format!("{keyword} needs at least one alternative")).hint =
                Some(format!("an alternative is a {weight} and an expression in parentheses"));
            return ExpressionKind::Unreadable;
        }
        let mut alternatives = Vec::with_capacity(items.len());
        for item in items {
            if let Node::List(list) = item
                && let Some((number, rest)) = list.items.split_first()
                && let Some(number) = self.name(number)
                && let [body] = Self::parts_of(rest)[..]
            {
                let body = self.part(body);
                alternatives.push(Alternative { weight: number, body });
            } else {
                let message = format!("an alternative of {keyword} takes a {weight} and one expression");
                self.error("E-ARITY", item.span(), message).hint =
                    Some("for example `(0.7 (Camera = On))`".into());
                return ExpressionKind::Unreadable;
            }
        }
        if keyword == "CHOOSE-PROB" {
            ExpressionKind::ChooseProb(alternatives)
        } else {
            ExpressionKind::ChooseReward(alternatives)
        }
    }

    /// Reads `(HELD d c)` as a guard, if that is what a list says.
    pub(super) fn held_guard(&mut self, node: &Node, non_entailed: bool, span: Span) -> Option<Guard> {
        let Node::List(list) = node else { return None };
        let head = keyword::head(self.text, &list.items).filter(|head| head.upper == "HELD")?;
        if self.is_constraint(list) {
            return None;
        }
        let items = list.items.get(head.length..).unwrap_or_default();
        let Some((duration, rest @ [_, ..])) = self.duration(items) else {
            return Some(self.unreadable_held(head.span, items.len(), span));
        };
        let [part] = Self::parts_of(rest)[..] else {
            return Some(self.unreadable_held(head.span, items.len(), span));
        };
        let inner = self.guard(part);
        if let Some(nested) = &inner.held {
            self.error("E-CONSTRAINT", nested.duration.span, "HELD cannot be inside HELD").hint =
                Some("write the longer of the two durations once".into());
        }
        let held = Held { duration, non_entailed: inner.non_entailed };
        Some(Guard { non_entailed, held: Some(held), constraint: inner.constraint, span })
    }

    fn unreadable_held(&mut self, head: Span, given: usize, span: Span) -> Guard {
        self.wrong_arity("HELD", head, "a duration and a condition", given);
        Guard::unreadable(span)
    }

    /// Returns what stands side by side, each with the bar before it.
    pub(super) fn parts_of(items: &[Node]) -> Vec<&[Node]> {
        let mut parts = Vec::with_capacity(items.len());
        let mut rest = items;
        while let Some(first) = rest.first() {
            let is_bar = matches!(first, Node::Leaf(token) if token.kind == TokenKind::Tilde);
            let (part, after) = rest.split_at(if is_bar && rest.len() > 1 { 2 } else { 1 });
            parts.push(part);
            rest = after;
        }
        parts
    }

    /// Reads one part as an expression.
    pub(super) fn part(&mut self, items: &[Node]) -> Expression {
        let span = items.first().map_or(Span::default(), Node::span);
        self.expression_of(items, span)
    }
}
