//! The compile rules of SPEC 3.3, one function per construct, over the program with its calls expanded.

use std::rc::Rc;

use exact::{Bound, Time};
use rmpl::diagnostics::{fleet, limit};
use rmpl::program::{Bounds, Expr, LabelMode, Members, MembersForm, ScenarioDecl, Statement, StatementKind};
use rmpl::{Diagnostic, Span};
use smol_str::SmolStr;

use super::bounds::{self, Interval};
use super::build::Root;
use super::call::{Invocation, themselves};
use super::expander::{Branch, End, Entry, Expander, Piece};
use super::names::E_UNDEF;
use super::scope::Scope;
use super::shape::starts_with_decision;
use crate::network::{ArcId, ArcKind, BlockKind, NodeId, OccurrenceId, OccurrenceKind};

/// Networks grow no larger than this many nodes, so that a few lines of doubling calls cannot exhaust the memory.
const MAX_NODES: usize = 500_000;
/// Statements nest no deeper than this, instances included, so that no text can exhaust the stack.
const DEEPEST: usize = 200;

impl<'program> Expander<'program> {
    pub(super) fn scenario(&mut self, scenario: &'program ScenarioDecl) -> Root {
        let occurrence = self.builder.occurrence(
            "scenario".into(),
            OccurrenceKind::Scenario,
            Vec::new(),
            None,
            scenario.span,
        );
        let scope = Scope::new(Some(occurrence), &[], &[]);
        let horizon = match &scenario.bounds {
            Some(written) => Some((self.interval(written, &scope), written.span)),
            // What holds at first needs an arc to stand on.
            None if self.vocabulary.initial_values().next().is_some() => Some((Interval::ANY, scenario.span)),
            None => None,
        };
        let horizon = horizon.map(|(interval, span)| {
            let arc = self.builder.reserve(ArcKind::Span, interval, span);
            self.builder.own(occurrence, arc);
            arc
        });
        let piece = self.spanned(&scenario.body, false, Entry::Free, &scope, horizon);
        self.builder.place(occurrence, piece.start, piece.end);
        let kind = BlockKind::Scope {
            child: piece.block,
            arcs: horizon.into_iter().collect(),
            occurrence: Some(occurrence),
        };
        let block = self.builder.block(kind, piece.start, piece.end, Some(scenario.span));
        Root { block, start: piece.start, end: piece.end, arc: horizon }
    }

    pub(super) fn top_activity(
        &mut self,
        name: &SmolStr,
        lower: Time,
        upper: Bound,
    ) -> Result<Root, Diagnostic> {
        let activity = self.activities.get(name.as_str()).copied();
        let primitive = self.primitives.get(name.as_str()).copied();
        let piece = if let Some(activity) = activity {
            let interval = bounds::checked_interval(Bound::Finite(lower), upper, activity.name.span)?;
            let arguments = themselves(&activity.formals);
            let call = Invocation { name: &activity.name, interval, written: None, span: activity.name.span };
            self.instance(
                activity,
                &arguments,
                &call,
                Entry::Free,
                &Scope::default(),
                OccurrenceKind::Scenario,
            )
        } else if let Some(primitive) = primitive {
            let interval = bounds::checked_interval(Bound::Finite(lower), upper, primitive.name.span)?;
            let arguments = themselves(&primitive.formals);
            let call =
                Invocation { name: &primitive.name, interval, written: None, span: primitive.name.span };
            self.primitive(&primitive.name.text, &arguments, &call, Entry::Free, &Scope::default())
        } else {
            return Err(Diagnostic::error(E_UNDEF, Span::default(), format!("unknown activity `{name}`")));
        };
        let arc = piece.occurrence.and_then(|occurrence| self.builder.arc_of(occurrence));
        Ok(Root { block: piece.block, start: piece.start, end: piece.end, arc })
    }

    pub(super) fn statement(&mut self, statement: &'program Statement, entry: Entry, scope: &Scope) -> Piece {
        if self.is_too_large(statement.span) {
            return self.nothing(statement.span, entry);
        }
        self.depth += 1;
        let piece = match (&statement.kind, &statement.bounds) {
            (StatementKind::Call(..) | StatementKind::Condition(..) | StatementKind::Delay, _)
            | (_, None) => self.unbounded(statement, entry, scope),
            (_, Some(written)) => {
                let interval = self.interval(written, scope);
                let arc = self.builder.reserve(ArcKind::Span, interval, written.span);
                let piece = self.spanned(statement, true, entry, scope, Some(arc));
                self.scope_block(&piece, arc, statement.span)
            }
        };
        self.depth -= 1;
        piece
    }

    /// `statement` without the bounds of a composite; its own bounds if it is a single arc.
    fn unbounded(&mut self, statement: &'program Statement, entry: Entry, scope: &Scope) -> Piece {
        let (span, written) = (statement.span, statement.bounds.as_ref());
        match &statement.kind {
            StatementKind::Sequence(items) => {
                let items = items.iter().map(|statement| Branch { statement, scope, is_copy: false });
                self.sequence(items, span, entry)
            }
            StatementKind::Parallel(branches) => self.parallel(&Branch::all(branches, scope), span, entry),
            StatementKind::Choose(alternatives) => {
                self.choose(&Branch::all(alternatives, scope), span, entry)
            }
            StatementKind::Members(members) => self.members(members, span, entry, scope),
            StatementKind::Maintaining(body, condition) => {
                self.conditional(body, condition, LabelMode::Ask, span, entry, scope)
            }
            StatementKind::Watching(body, condition) => {
                self.conditional(body, condition, LabelMode::Tell, span, entry, scope)
            }
            StatementKind::Telling(body, condition) => {
                let fact = self.told(condition, scope);
                self.labeled(body, fact, LabelMode::Tell, condition, span, entry, scope)
            }
            StatementKind::IfThennext(condition, body) => self.guard(condition, body, span, entry, scope),
            StatementKind::Repeat(count, body) => self.repeat(count, body, span, entry, scope),
            StatementKind::Unordered(branches) => self.unordered(&Branch::all(branches, scope), span, entry),
            StatementKind::Named(body, name) => {
                let piece = self.statement(body, entry, scope);
                self.named.add(name, piece.start, piece.end);
                piece
            }
            StatementKind::Using(body, resource, amount) => {
                self.using(body, resource, amount.as_ref(), span, entry, scope)
            }
            StatementKind::Call(name, arguments) => {
                let arguments = self.arguments(arguments, scope);
                self.call(name, &arguments, written, span, entry, scope)
            }
            StatementKind::Condition(mode, condition) => {
                if let Some(name) = self.called_formal(*mode, condition, scope) {
                    return self.call(&name, &[], written, span, entry, scope);
                }
                self.assertion(*mode, condition, written, span, entry, scope)
            }
            StatementKind::Delay => {
                let interval = written.map_or(Interval::ANY, |written| self.interval(written, scope));
                let arc_span = written.map_or(span, |written| written.span);
                let occurrence = self.builder.occurrence(
                    "delay".into(),
                    OccurrenceKind::Delay,
                    Vec::new(),
                    scope.occurrence,
                    span,
                );
                let piece = self.leaf(occurrence, ArcKind::Delay, interval, arc_span, span, entry);
                if let Some(arc) = piece.arc.filter(|_| written.is_some_and(|written| written.is_contingent))
                {
                    self.builder.leave_to_nature(arc);
                }
                piece
            }
        }
    }

    /// A statement for one member of a group, or for each (SPEC 17).
    fn members(&mut self, members: &'program Members, span: Span, entry: Entry, scope: &Scope) -> Piece {
        let groups = Rc::clone(&self.groups);
        let group = scope.name(&members.group.text);
        let Some(names) = groups.members(&group) else {
            self.diagnostics.push(fleet::unknown_group(&group, members.group.span, None));
            return self.nothing(span, entry);
        };
        let scopes: Vec<Scope> =
            names.iter().map(|member| scope.with_member(&members.variable.text, member)).collect();
        let copy = |scope| Branch { statement: &members.body, scope, is_copy: true };
        let branches: Vec<Branch<'program, '_>> = scopes.iter().map(copy).collect();
        let piece = match (members.form, branches.as_slice()) {
            (MembersForm::Any, branches) => self.choose(branches, span, entry),
            (MembersForm::Unordered, branches) => self.unordered(branches, span, entry),
            // One member has no one beside it.
            (MembersForm::Parallel, [only]) => self.branch(only, entry),
            (MembersForm::Parallel, branches) => self.parallel(branches, span, entry),
            (MembersForm::Sequence, branches) => self.sequence(branches.iter().copied(), span, entry),
        };
        if names.len() > 1 {
            self.builder.copies.insert(piece.block, names.to_vec());
        }
        piece
    }

    /// One of several statements. In copies of one statement, names are those of the copy.
    pub(super) fn branch(&mut self, branch: &Branch<'program, '_>, entry: Entry) -> Piece {
        if branch.is_copy {
            self.named.enter();
        }
        let piece = self.statement(branch.statement, entry, branch.scope);
        if branch.is_copy {
            self.named.leave();
        }
        piece
    }

    /// One after the other.
    fn sequence<'scope>(
        &mut self,
        items: impl Iterator<Item = Branch<'program, 'scope>>,
        span: Span,
        entry: Entry,
    ) -> Piece {
        let mut pieces: Vec<Piece> = Vec::new();
        for item in items {
            if self.is_cut_off {
                break;
            }
            let entry = match pieces.last() {
                None => entry,
                Some(last) => Entry::After { node: last.end, end: last.end_kind, link: ArcKind::Glue },
            };
            let piece = self.branch(&item, entry);
            pieces.push(piece);
        }
        if pieces.len() == 1 {
            return pieces.swap_remove(0);
        }
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
            return self.nothing(span, entry);
        };
        let (start, end, end_kind) = (first.start, last.end, last.end_kind);
        let children = pieces.iter().map(|piece| piece.block).collect();
        let block = self.builder.block(BlockKind::Sequence { children }, start, end, Some(span));
        Piece { start, end, end_kind, block, arc: None, occurrence: None }
    }

    /// So many copies of `body`, one after the other.
    fn repeat(
        &mut self,
        count: &Expr,
        body: &'program Statement,
        span: Span,
        entry: Entry,
        scope: &Scope,
    ) -> Piece {
        let copies = bounds::value(count, &scope.values(&self.constants)).and_then(|value| {
            let whole = value.finite().filter(|value| value.is_integer() && !value.is_negative());
            let copies = whole.map(|value| usize::try_from(value.numerator()).unwrap_or(usize::MAX));
            match copies {
                None => {
                    let message =
                        format!("`repeat` needs a whole number of copies of at least 0, but this is {value}");
                    Err(Diagnostic::error(bounds::E_BOUNDS, count.span, message))
                }
                Some(copies) if copies > MAX_NODES => {
                    Err(limit::events(&format!("{value} copies have"), MAX_NODES, count.span))
                }
                Some(copies) => Ok(copies),
            }
        });
        match copies {
            Ok(copies) => {
                let copy = Branch { statement: body, scope, is_copy: true };
                self.sequence(std::iter::repeat_n(copy, copies), span, entry)
            }
            Err(error) => {
                self.diagnostics.push(error);
                self.nothing(span, entry)
            }
        }
    }

    fn parallel(&mut self, branches: &[Branch<'program, '_>], span: Span, entry: Entry) -> Piece {
        let fork = self.enter(entry, End::Structural, span);
        let mut ends = Vec::with_capacity(branches.len());
        let mut blocks = Vec::with_capacity(branches.len());
        for branch in branches {
            let entry = Entry::After { node: fork, end: End::Event, link: ArcKind::Fork };
            let piece = self.branch(branch, entry);
            ends.push((piece.end, branch.statement.span));
            blocks.push(piece.block);
        }
        let join = self.builder.node();
        for (end, span) in ends {
            self.builder.arc(end, join, ArcKind::Join, Interval::ANY, span);
        }
        let block = self.builder.block(BlockKind::Parallel { branches: blocks }, fork, join, Some(span));
        Piece { start: fork, end: join, end_kind: End::Structural, block, arc: None, occurrence: None }
    }

    fn choose(&mut self, alternatives: &[Branch<'program, '_>], span: Span, entry: Entry) -> Piece {
        if alternatives.is_empty() {
            return self.nothing(span, entry);
        }
        let node = self.enter(entry, End::Structural, span);
        let decision = self.builder.decision(node, span);
        let mut ends = Vec::with_capacity(alternatives.len());
        let mut blocks = Vec::with_capacity(alternatives.len());
        for alternative in alternatives {
            let span = alternative.statement.span;
            let arc = self.builder.reserve(ArcKind::Choice, Interval::ZERO, span);
            self.builder.alternative(decision, arc, span);
            let piece = self.branch(alternative, Entry::Free);
            self.builder.connect(arc, node, piece.start);
            ends.push((piece.end, span));
            blocks.push(piece.block);
        }
        let merge = self.builder.node();
        for (end, span) in ends {
            self.builder.arc(end, merge, ArcKind::Merge, Interval::ZERO, span);
        }
        let kind = BlockKind::Choose { decision, alternatives: blocks };
        let block = self.builder.block(kind, node, merge, Some(span));
        Piece { start: node, end: merge, end_kind: End::Structural, block, arc: None, occurrence: None }
    }

    /// One arc between two events.
    pub(super) fn leaf(
        &mut self,
        occurrence: OccurrenceId,
        kind: ArcKind,
        interval: Interval,
        arc_span: Span,
        span: Span,
        entry: Entry,
    ) -> Piece {
        let end_kind = if kind == ArcKind::Delay { End::Delay } else { End::Event };
        let start = self.enter(entry, end_kind, span);
        let end = self.builder.node();
        let arc = self.builder.arc(start, end, kind, interval, arc_span);
        self.builder.own(occurrence, arc);
        self.builder.place(occurrence, start, end);
        let block = self.builder.block(BlockKind::Leaf { arc }, start, end, Some(span));
        Piece { start, end, end_kind, block, arc: Some(arc), occurrence: Some(occurrence) }
    }

    /// An empty block.
    pub(super) fn nothing(&mut self, span: Span, entry: Entry) -> Piece {
        let start = self.enter(entry, End::Structural, span);
        let end = self.builder.node();
        let arc = self.builder.arc(start, end, ArcKind::Glue, Interval::ZERO, span);
        let block = self.builder.block(BlockKind::Leaf { arc }, start, end, Some(span));
        Piece { start, end, end_kind: End::Structural, block, arc: None, occurrence: None }
    }

    /// `statement` with `arc` from its start to its end; without its own bounds if `arc` is what represents them. If it
    /// starts with a decision it gets a node around each end, because only alternatives may leave a decision (SPEC 3.1).
    pub(super) fn spanned(
        &mut self,
        statement: &'program Statement,
        is_own_bounds: bool,
        entry: Entry,
        scope: &Scope,
        arc: Option<ArcId>,
    ) -> Piece {
        let inner = |expander: &mut Self, entry: Entry| {
            if is_own_bounds {
                expander.unbounded(statement, entry, scope)
            } else {
                expander.statement(statement, entry, scope)
            }
        };
        let piece = if starts_with_decision(statement, is_own_bounds) {
            let start = self.enter(entry, End::Structural, statement.span);
            let before = self.builder.reserve(ArcKind::Glue, Interval::ZERO, statement.span);
            let piece = inner(self, Entry::Free);
            self.builder.connect(before, start, piece.start);
            let end = self.builder.node();
            self.builder.arc(piece.end, end, ArcKind::Glue, Interval::ZERO, statement.span);
            Piece { start, end, end_kind: End::Structural, ..piece }
        } else {
            inner(self, entry)
        };
        if let Some(arc) = arc {
            self.builder.connect(arc, piece.start, piece.end);
        }
        piece
    }

    pub(super) fn scope_block(&mut self, piece: &Piece, arc: ArcId, span: Span) -> Piece {
        let kind = BlockKind::Scope { child: piece.block, arcs: vec![arc], occurrence: None };
        let block = self.builder.block(kind, piece.start, piece.end, Some(span));
        Piece {
            start: piece.start,
            end: piece.end,
            end_kind: piece.end_kind,
            block,
            arc: None,
            occurrence: None,
        }
    }

    /// The first node of a piece.
    pub(super) fn enter(&mut self, entry: Entry, wants: End, span: Span) -> NodeId {
        let Entry::After { node, end, link } = entry else { return self.builder.node() };
        let may_share =
            end == End::Delay || wants == End::Delay || (end, wants) == (End::Structural, End::Structural);
        if may_share {
            return node;
        }
        let start = self.builder.node();
        self.builder.arc(node, start, link, Interval::ZERO, span);
        start
    }

    /// The value of written bounds; anything, with a diagnostic, if they have none.
    pub(super) fn interval(&mut self, written: &Bounds, scope: &Scope) -> Interval {
        bounds::interval(written, &scope.values(&self.constants)).unwrap_or_else(|error| {
            self.diagnostics.push(error);
            Interval::ANY
        })
    }

    fn is_too_large(&mut self, span: Span) -> bool {
        let is_deep = self.depth >= DEEPEST;
        if !self.is_cut_off && (is_deep || self.builder.node_count() >= MAX_NODES) {
            self.is_cut_off = true;
            self.diagnostics.push(if is_deep {
                limit::nested(DEEPEST, span)
            } else {
                limit::events("the mission has", MAX_NODES, span)
            });
        }
        self.is_cut_off
    }
}
