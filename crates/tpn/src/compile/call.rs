//! Calls: instances of defined activities with their header bounds (SPEC 1.4), and primitives.

use exact::{Bound, Rational, Time};
use rmpl::diagnostics::{bounds as wording, contingent, recursion};
use rmpl::program::{ActivityDecl, Argument, ArgumentValue, Bounds, Expr, HeaderBound, HeaderBounds, Name};
use rmpl::{Diagnostic, Span};
use smol_str::SmolStr;

use super::bounds::{self, Interval, Values as _};
use super::clauses::Activity;
use super::expander::{End, Entry, Expander, Piece};
use super::scope::{Scope, argument_text};
use crate::network::{ArcKind, BlockKind, OccurrenceKind};

/// A call with its bounds evaluated.
pub(super) struct Invocation<'call> {
    pub(super) name: &'call Name,
    pub(super) interval: Interval,
    pub(super) written: Option<&'call Bounds>,
    pub(super) span: Span,
}

impl Invocation<'_> {
    fn bounds_span(&self) -> Option<Span> {
        self.written.map(|written| written.span)
    }

    fn is_contingent(&self) -> bool {
        self.written.is_some_and(|written| written.is_contingent)
    }
}

/// How long an activity takes.
struct Duration {
    interval: Interval,
    is_contingent: bool,
    /// Where it is written.
    span: Span,
    /// What the call requires of what the environment chooses.
    required: Option<Interval>,
}

/// Formals of a top activity represent themselves.
pub(super) fn themselves(formals: &[Name]) -> Vec<ArgumentValue> {
    formals.iter().map(|formal| ArgumentValue::Name(formal.text.clone())).collect()
}

impl<'program> Expander<'program> {
    pub(super) fn call(
        &mut self,
        name: &Name,
        arguments: &[ArgumentValue],
        written: Option<&'program Bounds>,
        span: Span,
        entry: Entry,
        scope: &Scope,
    ) -> Piece {
        let interval = written.map_or(Interval::ANY, |written| self.interval(written, scope));
        let callee = scope.name(&name.text);
        let call = Invocation { name, interval, written, span };
        let Some(&activity) = self.activities.get(callee.as_str()) else {
            return self.primitive(&callee, arguments, &call, entry, scope);
        };
        if let Some(written) = written.filter(|written| written.is_contingent) {
            self.diagnostics.push(contingent::activity(&callee, written.span));
        }
        // Static recursion was refused before; names that are passed as arguments can still close a cycle.
        if self.active.contains(&activity.name.text.as_str()) {
            let message =
                format!("an activity cannot call itself, but `{callee}` does through its arguments");
            self.diagnostics.push(Diagnostic::error(recursion::CODE, name.span, message));
            return self.nothing(span, entry);
        }
        self.instance(activity, arguments, &call, entry, scope, OccurrenceKind::Activity)
    }

    pub(super) fn instance(
        &mut self,
        activity: &'program ActivityDecl,
        arguments: &[ArgumentValue],
        call: &Invocation<'_>,
        entry: Entry,
        around: &Scope,
        kind: OccurrenceKind,
    ) -> Piece {
        let texts = arguments.iter().map(argument_text).collect();
        let occurrence =
            self.builder.occurrence(activity.name.text.clone(), kind, texts, around.occurrence, call.span);
        let mut scope = Scope::new(Some(occurrence), &activity.formals, arguments);
        let (interval, span) = self.header(activity, call, &mut scope);
        let start = self.enter(entry, End::Event, call.span);
        let arc = self.builder.reserve(ArcKind::Composite, interval, span);
        self.builder.own(occurrence, arc);
        self.active.push(activity.name.text.as_str());
        let entry = Entry::After { node: start, end: End::Event, link: ArcKind::Glue };
        self.named.enter();
        let body = self.statement(&activity.body, entry, &scope);
        self.named.leave();
        self.active.pop();
        let end = self.builder.node();
        self.builder.arc(body.end, end, ArcKind::Glue, Interval::ZERO, activity.body.span);
        self.builder.connect(arc, start, end);
        self.builder.place(occurrence, start, end);
        let kind = BlockKind::Scope { child: body.block, arcs: vec![arc], occurrence: Some(occurrence) };
        let block = self.builder.block(kind, start, end, Some(call.span));
        Piece { start, end, end_kind: End::Event, block, arc: None, occurrence: Some(occurrence) }
    }

    /// The bounds of an instance (SPEC 1.4), and where they are written; binds the header's bound parameters.
    fn header(
        &mut self,
        activity: &'program ActivityDecl,
        call: &Invocation<'_>,
        scope: &mut Scope,
    ) -> (Interval, Span) {
        let call_span = call.bounds_span().unwrap_or(call.span);
        let HeaderBounds::Sides { lower, upper, span } = &activity.bounds else {
            return (call.interval, call_span);
        };
        let constants = &self.constants;
        // A plain name declares a bound parameter unless it is a constant.
        let parameter = |side: &'program HeaderBound| match side {
            HeaderBound::Parameter(name) if constants.number(&name.text).is_none() => Some(&name.text),
            _ => None,
        };
        if let Some(name) = parameter(lower) {
            scope.bind(name, Bound::Finite(call.interval.lower));
        }
        if let Some(name) = parameter(upper) {
            scope.bind(name, call.interval.upper);
        }
        let values = scope.values(constants);
        let value = |side: &HeaderBound, default: Bound| match side {
            HeaderBound::Parameter(name) => {
                Ok(constants.number(&name.text).map_or((default, false), |value| (value, true)))
            }
            HeaderBound::Limit(expr) => bounds::value(expr, &values).map(|value| (value, true)),
        };
        let sides = value(lower, Bound::ZERO).and_then(|least| Ok((least, value(upper, Bound::Infinite)?)));
        let ((least, limits_lower), (greatest, limits_upper)) = match sides {
            Ok(sides) => sides,
            Err(error) => {
                self.diagnostics.push(error);
                return (call.interval, call_span);
            }
        };
        let limit = match bounds::checked_interval(least, greatest, *span) {
            Ok(limit) => limit,
            Err(error) => {
                self.diagnostics.push(error);
                return (call.interval, call_span);
            }
        };
        let limits = limits_lower || limits_upper;
        let arc_span = if limits { call.bounds_span().unwrap_or(*span) } else { call_span };
        (self.intersect(call, limit, *span), arc_span)
    }

    /// A primitive, declared or not: its declared bounds intersected with those of the call.
    pub(super) fn primitive(
        &mut self,
        callee: &SmolStr,
        arguments: &[ArgumentValue],
        call: &Invocation<'_>,
        entry: Entry,
        around: &Scope,
    ) -> Piece {
        let declared = self.primitives.get(callee.as_str()).copied();
        let formals = declared.map_or(&[][..], |declared| &declared.formals);
        let scope = Scope::new(None, formals, arguments);
        let written = declared.and_then(|declared| declared.bounds.as_ref());
        let duration = self.duration(call, written, &scope);
        let texts = arguments.iter().map(argument_text).collect();
        let occurrence = self.builder.occurrence(
            callee.clone(),
            OccurrenceKind::Primitive,
            texts,
            around.occurrence,
            call.span,
        );
        let around = duration.required.map(|required| {
            let span = call.bounds_span().unwrap_or(call.span);
            self.builder.reserve(ArcKind::Span, required, span)
        });
        let piece =
            self.leaf(occurrence, ArcKind::Activity, duration.interval, duration.span, call.span, entry);
        if let Some(arc) = piece.arc.filter(|_| duration.is_contingent) {
            self.builder.leave_to_nature(arc);
        }
        if let (Some(declared), Some(arc)) = (declared, piece.arc) {
            let both = duration.required.and_then(|required| required.intersect(duration.interval));
            let interval = both.unwrap_or(duration.interval);
            let activity = Activity { declared, arguments, scope: &scope, occurrence, arc, interval };
            self.clauses(&activity, &piece, call.name.span);
        }
        let Some(around) = around else { return piece };
        self.builder.connect(around, piece.start, piece.end);
        let block = self.scope_block(&piece, around, call.span).block;
        Piece { block, ..piece }
    }

    /// Returns how long a call of a primitive takes, whose own bounds are `written`. Plain bounds of both hold; what
    /// nature chooses, plain bounds of the call do not narrow, and its contingent ones lie within the declared (SPEC
    /// 13.1).
    fn duration(
        &mut self,
        call: &Invocation<'_>,
        written: Option<&'program Bounds>,
        scope: &Scope,
    ) -> Duration {
        let own = Duration {
            interval: call.interval,
            is_contingent: call.is_contingent(),
            span: call.bounds_span().unwrap_or(call.span),
            required: None,
        };
        let Some(written) = written else { return own };
        let declared = self.interval(written, scope);
        if call.is_contingent() {
            if !declared.contains(call.interval) {
                let sides = |interval: Interval| (interval.lower, interval.upper);
                self.diagnostics.push(wording::outside(
                    &call.name.text,
                    sides(call.interval),
                    sides(declared),
                    own.span,
                ));
            }
            return own;
        }
        if written.is_contingent {
            let required = (call.interval != Interval::ANY).then_some(call.interval);
            return Duration { interval: declared, is_contingent: true, span: written.span, required };
        }
        Duration {
            interval: self.intersect(call, declared, written.span),
            span: call.bounds_span().unwrap_or(written.span),
            ..own
        }
    }

    /// The arguments of a call after substitution, with expressions evaluated where the call is.
    pub(super) fn arguments(&mut self, arguments: &[Argument], scope: &Scope) -> Vec<ArgumentValue> {
        let mut values = Vec::with_capacity(arguments.len());
        for argument in arguments {
            let value = match &argument.value {
                ArgumentValue::Name(name) => {
                    let constant = || self.constants.number(name).and_then(Bound::finite);
                    scope
                        .argument(name)
                        .or_else(|| scope.number_argument(name))
                        .or_else(|| constant().map(|number| ArgumentValue::Number(number.units())))
                        .or_else(|| name.contains('.').then(|| ArgumentValue::Name(scope.owned_name(name))))
                }
                ArgumentValue::Expression(expr) => Some(ArgumentValue::Number(self.number(expr, scope))),
                ArgumentValue::Condition(condition) => {
                    Some(ArgumentValue::Condition(scope.condition(condition)))
                }
                ArgumentValue::Number(_) => None,
            };
            values.push(value.unwrap_or_else(|| argument.value.clone()));
        }
        values
    }

    /// The value of an argument, which is finite.
    fn number(&mut self, expr: &Expr, scope: &Scope) -> Rational {
        let value = bounds::value(expr, &scope.values(&self.constants)).and_then(|value| {
            value.finite().map(Time::units).ok_or_else(|| {
                Diagnostic::error(bounds::E_BOUNDS, expr.span, "a numeric argument must be finite")
            })
        });
        // What has no value is reported, and represents some number until then.
        value.unwrap_or_else(|error| {
            self.diagnostics.push(error);
            Rational::default()
        })
    }

    fn intersect(&mut self, call: &Invocation<'_>, limit: Interval, declared_span: Span) -> Interval {
        call.interval.intersect(limit).unwrap_or_else(|| {
            let message = format!(
                "`{}` is declared with {limit}, which does not overlap {}",
                call.name.text, call.interval
            );
            let span = call.bounds_span().unwrap_or(if call.span == Span::default() {
                declared_span
            } else {
                call.span
            });
            self.diagnostics.push(Diagnostic::error(bounds::E_BOUNDS, span, message));
            limit
        })
    }
}
