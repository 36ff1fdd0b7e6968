//! Conditions: `maintaining` and `watching`, the guard of an `if`, assertions and explicit requirements.

use rmpl::program::{Bounds, Condition, LabelMode, Statement};
use rmpl::{Diagnostic, Span};

use super::bounds::Interval;
use super::expander::{End, Entry, Expander, Piece};
use super::names::{E_VALUE, Fact};
use super::resource::Asked;
use super::scope::Scope;
use crate::network::{ArcId, ArcKind, BlockKind, Extent, OccurrenceId, OccurrenceKind};

impl<'program> Expander<'program> {
    /// `do body maintaining c` requires `c`, `do body watching c` asserts its negation (SPEC 3.7).
    pub(super) fn conditional(
        &mut self,
        body: &'program Statement,
        condition: &'program Condition,
        mode: LabelMode,
        span: Span,
        entry: Entry,
        scope: &Scope,
    ) -> Piece {
        if condition.level.is_some() {
            return self.with_level(body, mode, condition, span, entry, scope);
        }
        let fact = self.fact(condition, scope).map(|fact| match mode {
            LabelMode::Ask => fact,
            LabelMode::Tell => fact.negation(),
        });
        // Of what keeps its value, `watching` requires that the condition does not come about.
        let is_lasting = fact.as_ref().is_some_and(|fact| self.vocabulary.is_lasting(&fact.variable));
        let mode = if is_lasting { LabelMode::Ask } else { mode };
        self.labeled(body, fact, mode, condition, span, entry, scope)
    }

    /// `body` while a level satisfies `condition`. A level cannot be asserted: rmpl reports that.
    fn with_level(
        &mut self,
        body: &'program Statement,
        mode: LabelMode,
        condition: &'program Condition,
        span: Span,
        entry: Entry,
        scope: &Scope,
    ) -> Piece {
        let (piece, arc, owner) = self.with_arc(body, span, entry, scope);
        if let (Some(arc), LabelMode::Ask) = (arc, mode) {
            let is_at_start = condition.level.as_ref().is_some_and(|level| level.is_at_start);
            let asked = Asked { arc, start: piece.start, end: piece.end, owner, is_at_start };
            self.level(condition, &asked, scope, condition.variable.span);
        }
        piece
    }

    /// `body` with a label of `condition`, which says `fact`.
    #[expect(clippy::too_many_arguments, reason = "what a label needs and what a piece needs")]
    pub(super) fn labeled(
        &mut self,
        body: &'program Statement,
        fact: Option<Fact>,
        mode: LabelMode,
        condition: &'program Condition,
        span: Span,
        entry: Entry,
        scope: &Scope,
    ) -> Piece {
        let (piece, arc, owner) = self.with_arc(body, span, entry, scope);
        if let (Some(arc), Some(fact)) = (arc, fact) {
            self.builder.label(arc, (mode, Extent::Arc), fact, owner, condition.span);
        }
        piece
    }

    /// `body` with the arc that lasts as long as it does, and whose that is: its own, or one around it.
    pub(super) fn with_arc(
        &mut self,
        body: &'program Statement,
        span: Span,
        entry: Entry,
        scope: &Scope,
    ) -> (Piece, Option<ArcId>, Option<OccurrenceId>) {
        if self.is_single_arc(body, scope) {
            let piece = self.statement(body, entry, scope);
            let (arc, owner) = (piece.arc, piece.occurrence);
            return (piece, arc, owner);
        }
        let owner = (!self.is_instance(body, scope)).then(|| {
            self.builder.occurrence("do".into(), OccurrenceKind::Scope, Vec::new(), scope.occurrence, span)
        });
        let arc = self.builder.reserve(ArcKind::Span, Interval::ANY, span);
        let piece = self.spanned(body, false, entry, scope, Some(arc));
        if let Some(owner) = owner {
            self.builder.place(owner, piece.start, piece.end);
            self.builder.own(owner, arc);
        }
        let owner = owner.or(piece.occurrence);
        (self.scope_block(&piece, arc, span), Some(arc), owner)
    }

    /// `if c thennext body`: an instantaneous requirement before the body.
    pub(super) fn guard(
        &mut self,
        condition: &'program Condition,
        body: &'program Statement,
        span: Span,
        entry: Entry,
        scope: &Scope,
    ) -> Piece {
        let start = self.enter(entry, End::Structural, span);
        let arc = self.builder.reserve(ArcKind::Point, Interval::ZERO, condition.span);
        let owner =
            self.builder.occurrence("if".into(), OccurrenceKind::Scope, Vec::new(), scope.occurrence, span);
        self.builder.own(owner, arc);
        if condition.level.is_some() {
            let asked = Asked { arc, start, end: start, owner: Some(owner), is_at_start: true };
            self.level(condition, &asked, scope, condition.variable.span);
        } else if let Some(fact) = self.fact(condition, scope) {
            self.builder.label(arc, (LabelMode::Ask, Extent::Arc), fact, Some(owner), condition.span);
        }
        let piece = self.statement(body, Entry::Free, scope);
        self.builder.connect(arc, start, piece.start);
        self.builder.place(owner, start, piece.start);
        let kind = BlockKind::Guard { arc, child: piece.block };
        let block = self.builder.block(kind, start, piece.end, Some(span));
        Piece { start, end: piece.end, end_kind: piece.end_kind, block, arc: None, occurrence: None }
    }

    /// `c`, `tell c` or `ask c`.
    pub(super) fn assertion(
        &mut self,
        mode: LabelMode,
        condition: &'program Condition,
        written: Option<&'program Bounds>,
        span: Span,
        entry: Entry,
        scope: &Scope,
    ) -> Piece {
        let interval = written.map_or(Interval::ZERO, |written| self.interval(written, scope));
        let arc_span = written.map_or(span, |written| written.span);
        let fact = match mode {
            _ if condition.level.is_some() => None,
            LabelMode::Ask => self.fact(condition, scope),
            LabelMode::Tell => self.told(condition, scope),
        };
        let text = match &condition.level {
            Some(level) => self.level_text(condition, level, scope),
            None => fact.as_ref().map_or_else(|| condition.variable.text.clone(), Fact::text),
        };
        let activity = match mode {
            LabelMode::Ask => format!("Ask({text})"),
            LabelMode::Tell => format!("Tell({text})"),
        };
        let occurrence = self.builder.occurrence(
            activity.into(),
            OccurrenceKind::Assertion,
            Vec::new(),
            scope.occurrence,
            span,
        );
        let piece = self.leaf(occurrence, ArcKind::Assertion, interval, arc_span, span, entry);
        if let Some(arc) = piece.arc.filter(|_| written.is_some_and(|written| written.is_contingent)) {
            self.builder.leave_to_nature(arc);
        }
        if let (Some(arc), Some(fact)) = (piece.arc, fact) {
            self.builder.label(arc, (mode, Extent::Arc), fact, Some(occurrence), condition.span);
        }
        if let (Some(arc), Some(level), LabelMode::Ask) = (piece.arc, &condition.level, mode) {
            let (start, end) = (piece.start, piece.end);
            let asked = Asked { arc, start, end, owner: Some(occurrence), is_at_start: level.is_at_start };
            self.level(condition, &asked, scope, condition.variable.span);
        }
        piece
    }

    /// Returns what is asserted: of a variable that keeps its value, one value.
    pub(super) fn told(&mut self, condition: &Condition, scope: &Scope) -> Option<Fact> {
        let fact = self.fact(condition, scope)?;
        let is_one = !fact.negated && fact.values.len() == 1 && fact.sees.is_none();
        if !self.vocabulary.is_lasting(&fact.variable) || is_one {
            return Some(fact);
        }
        let message = format!(
            "an assertion must set exactly one value of the state `{}`, but `{}` allows several",
            fact.variable,
            fact.text()
        );
        self.diagnostics.push(Diagnostic::error(E_VALUE, condition.span, message));
        None
    }

    pub(super) fn fact(&mut self, condition: &Condition, scope: &Scope) -> Option<Fact> {
        match self.vocabulary.fact(condition, &|name| scope.argument(name)) {
            Ok(fact) => Some(fact),
            Err(error) => {
                self.diagnostics.push(error);
                None
            }
        }
    }
}
