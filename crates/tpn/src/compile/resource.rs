//! Resources (SPEC 11): their declarations, who uses how much of them, blocks that use one for their whole length, and
//! `unordered` blocks, whose branches share an unnamed one (SPEC 14). Objectives (SPEC 12) are read here, too.

use exact::{Bound, Rational, Time};
use rmpl::diagnostics::{fleet, kind};
use rmpl::program::{
    self, Amount, Change, Condition, DurationUnit, Expr, Level, Name, Per, ResourceUse, Statement,
};
use rmpl::{Code, Diagnostic, Span};
use smol_str::{SmolStr, format_smolstr};

use super::bounds::{self, E_BOUNDS, Interval};
use super::clauses::Activity;
use super::expander::{Branch, End, Entry, Expander, Piece};
use super::names::E_UNDEF;
use super::scope::Scope;
use crate::network::{
    ArcId, ArcKind, BlockKind, Goal, LevelCondition, NodeId, OccurrenceId, Resource, ResourceId, Supply, Use,
};

/// More is asked of a resource than it can ever give, or something that its kind does not do.
const E_RESOURCE: Code = Code("E-RESOURCE");

/// When and by whom something is asked.
pub(super) struct Asked {
    /// It counts where this arc is selected.
    pub(super) arc: ArcId,
    pub(super) start: NodeId,
    pub(super) end: NodeId,
    pub(super) owner: Option<OccurrenceId>,
    pub(super) is_at_start: bool,
}

impl<'program> Expander<'program> {
    /// Evaluates the declared resources.
    pub(super) fn declare_resources(&mut self) {
        for declared in &self.program.resources {
            if self.resources.contains_key(declared.name.text.as_str()) {
                continue;
            }
            let supply = self.supply(&declared.supply, declared.name.span);
            let id = supply.map(|supply| {
                self.builder.resources.push(Resource {
                    name: declared.name.text.clone(),
                    supply,
                    span: Some(declared.name.span),
                });
                ResourceId::from_index(self.builder.resources.len() - 1)
            });
            self.resources.insert(declared.name.text.as_str(), id);
        }
    }

    fn supply(&mut self, declared: &program::Supply, span: Span) -> Option<Supply> {
        let scope = super::scope::Scope::default();
        match declared {
            program::Supply::Reusable { capacity } => {
                let capacity =
                    capacity.as_ref().map_or(Rational::ONE, |written| self.amount(written, &scope));
                Some(Supply::Reusable { capacity })
            }
            program::Supply::Reservoir { least, greatest, level } => {
                let (lowest, highest, first) =
                    (self.amount(least, &scope), self.amount(greatest, &scope), self.amount(level, &scope));
                if lowest > highest {
                    let message =
                        format!("the minimum level {lowest} is greater than the maximum level {highest}");
                    self.diagnostics.push(Diagnostic::error(E_BOUNDS, span, message));
                    return None;
                }
                if first < lowest || first > highest {
                    let message = format!("the level {first} at the start is outside {lowest}..{highest}");
                    self.diagnostics.push(Diagnostic::error(E_BOUNDS, level.span, message));
                    return None;
                }
                Some(Supply::Reservoir { least: lowest, greatest: highest, level: first })
            }
        }
    }

    /// The value of an amount, which is finite and not negative; nothing, with a diagnostic, otherwise.
    pub(super) fn amount(&mut self, written: &Expr, scope: &super::scope::Scope) -> Rational {
        let value = bounds::value(written, &scope.values(&self.constants)).and_then(|value| {
            let finite = value.finite().map(Time::units).ok_or("an amount must be finite");
            finite
                .and_then(|amount| {
                    if amount.is_negative() { Err("an amount must not be negative") } else { Ok(amount) }
                })
                .map_err(|message| Diagnostic::error(E_BOUNDS, written.span, message))
        });
        value.unwrap_or_else(|error| {
            self.diagnostics.push(error);
            Rational::default()
        })
    }

    /// A clause of a primitive at one call.
    pub(super) fn primitive_use(
        &mut self,
        activity: &Activity<'_>,
        piece: &Piece,
        written: &ResourceUse,
        called: Span,
    ) {
        let Some(resource) = self.resource(&written.resource, activity.scope, called) else { return };
        let mut per_meter = Rational::default();
        let amount = match &written.amount {
            None => Rational::ONE,
            Some(amount) => {
                let value = self.amount(&amount.value, activity.scope);
                match amount.per {
                    None => value,
                    Some(Per::Meter) => {
                        per_meter = value;
                        Rational::default()
                    }
                    Some(Per::Time(unit)) => {
                        self.amount_over(written.change, value, unit, activity.interval, amount)
                    }
                }
            }
        };
        let used = Use {
            resource,
            change: written.change,
            amount,
            at_least: amount,
            per_meter,
            arc: activity.arc,
            start: piece.start,
            end: piece.end,
            owner: Some(activity.occurrence),
            level: None,
            span: Some(written.span),
        };
        self.add_use(used, called, written.span);
    }

    /// An amount per time over a duration: the longest one for what is consumed, the shortest for what is produced.
    fn amount_over(
        &mut self,
        change: Change,
        value: Rational,
        unit: DurationUnit,
        interval: Interval,
        written: &Amount,
    ) -> Rational {
        let duration =
            if change == Change::Produces { Some(interval.lower) } else { interval.upper.finite() };
        let is_finite = interval.upper.finite().is_some();
        let Some(duration) = duration.filter(|_| is_finite) else {
            let message = "an amount per time needs a finite duration, but this one is infinite";
            self.diagnostics.push(
                Diagnostic::error(E_BOUNDS, written.span, message)
                    .with_hint("give the activity a finite maximum, or an amount without `per`"),
            );
            return Rational::default();
        };
        let units = unit.in_units(self.program.options.time_unit);
        let total = units
            .and_then(|units| duration.units().checked_div(units))
            .and_then(|times| times.checked_mul(value));
        total.unwrap_or_else(|| {
            let message = "this amount is too large or too precise to represent exactly";
            self.diagnostics.push(Diagnostic::error(E_BOUNDS, written.span, message));
            Rational::default()
        })
    }

    /// The resource of a use; `called` is where the call stands that says what parameters are.
    fn resource(&mut self, written: &Name, scope: &super::scope::Scope, called: Span) -> Option<ResourceId> {
        let name = scope.owned_name(&written.text);
        if let Some(known) = self.resources.get(name.as_str()) {
            return *known;
        }
        let span = if name == written.text { written.span } else { called };
        let diagnostic = match name.split_once('.') {
            Some((owner, part)) => self.unknown_equipment(owner, part, "resource", span),
            None => Diagnostic::error(E_UNDEF, span, format!("unknown resource `{name}`"))
                .with_hint(format!("declare it: `resource {name};`")),
        };
        self.diagnostics.push(diagnostic);
        None
    }

    /// A resource or a state that a vehicle does not have, or whose vehicle is not declared.
    fn unknown_equipment(&self, owner: &str, part: &str, what: &str, span: Span) -> Diagnostic {
        match self.program.world.vehicles.iter().find(|it| it.name.text == owner) {
            Some(vehicle) => fleet::unknown_equipment(owner, part, &vehicle.model.text, what, span),
            None => Diagnostic::error(E_UNDEF, span, format!("unknown vehicle `{owner}`"))
                .with_hint("declare it: `vehicle V : MODEL at PLACE;`"),
        }
    }

    /// Adds a use, if its resource can ever bear it. `called` is where the call is, `written` where the use does.
    fn add_use(&mut self, used: Use, called: Span, written: Span) {
        let resource = &self.builder.resources[used.resource.index()];
        let name = &resource.name;
        let problem = match (resource.supply, used.change) {
            (Supply::Reusable { capacity }, Change::Uses) => (used.amount > capacity).then(|| {
                let message =
                    format!("this uses {} of `{name}`, but its capacity is {capacity}", used.amount);
                (called, message)
            }),
            (Supply::Reservoir { least, greatest, .. }, Change::Consumes | Change::Produces) => {
                let range = greatest.checked_sub(least).unwrap_or_default();
                (used.amount > range).then(|| {
                    let message = format!(
                        "this {} {} of `{name}`, but its minimum and maximum level are only {range} apart",
                        used.change.word(),
                        used.amount
                    );
                    (called, message)
                })
            }
            (Supply::Reusable { .. }, change) => {
                let message = format!(
                    "`{name}` has a capacity, so activities use it, and nothing {} it",
                    change.word()
                );
                Some((written, message))
            }
            (Supply::Reservoir { .. }, Change::Uses) => Some((
                written,
                format!("`{name}` has a level, so activities consume or produce it, and cannot use it"),
            )),
        };
        if let Some((span, message)) = problem {
            self.diagnostics.push(Diagnostic::error(E_RESOURCE, span, message));
            return;
        }
        self.builder.uses.push(used);
    }

    /// Adds what `condition` requires of a level while `asked.arc` is selected (SPEC 17); `called` is the span of the call that
    /// gives parameters their values.
    pub(super) fn level(&mut self, condition: &Condition, asked: &Asked, scope: &Scope, called: Span) {
        let Some(level) = &condition.level else { return };
        let name = scope.owned_name(&condition.variable.text);
        let span = if name == condition.variable.text { condition.variable.span } else { called };
        if let Some(is) = self.without_level(&name) {
            self.diagnostics.push(kind::no_level(&name, is, span));
            return;
        }
        let Some(resource) = self.resource(&condition.variable, scope, called) else { return };
        let level =
            LevelCondition { order: order(condition, level), bound: self.amount(&level.bound, scope) };
        let ends = [Some(asked.start), (!asked.is_at_start).then_some(asked.end)];
        for end in ends.into_iter().flatten() {
            self.builder.uses.push(Use {
                resource,
                change: level.change(),
                amount: Rational::ZERO,
                at_least: Rational::ZERO,
                per_meter: Rational::ZERO,
                arc: asked.arc,
                start: asked.start,
                end,
                owner: asked.owner,
                level: Some(level),
                span: Some(condition.span),
            });
        }
    }

    /// `R1.battery>=30`
    pub(super) fn level_text(&self, condition: &Condition, level: &Level, scope: &Scope) -> SmolStr {
        let name = scope.owned_name(&condition.variable.text);
        // What has no value is an error of its own.
        let bound = bounds::value(&level.bound, &scope.values(&self.constants)).unwrap_or(Bound::ZERO);
        format_smolstr!("{name}{}{bound}", order(condition, level).symbol())
    }

    /// Returns what a name is, if something without a level is called so.
    fn without_level(&self, name: &str) -> Option<&'static str> {
        if let Some(resource) = self.resources.get(name) {
            let supply = resource.map(|resource| self.builder.resources[resource.index()].supply);
            let is_reusable = matches!(supply, Some(Supply::Reusable { .. }));
            return is_reusable.then_some("a resource with a capacity");
        }
        if self.vocabulary.is_lasting(name) {
            Some(if name.strip_suffix(".at").is_some() { "the place of a vehicle" } else { "a state" })
        } else if self.program.variables.iter().any(|it| it.name.text == name) {
            Some("a variable")
        } else if self.program.constants.iter().any(|it| it.name.text == name) {
            Some("a constant")
        } else {
            None
        }
    }

    /// `do body using resource amount`.
    pub(super) fn using(
        &mut self,
        body: &'program Statement,
        resource: &'program Name,
        amount: Option<&'program Expr>,
        span: Span,
        entry: Entry,
        scope: &super::scope::Scope,
    ) -> Piece {
        let resource_id = self.resource(resource, scope, span);
        let amount = amount.map_or(Rational::ONE, |written| self.amount(written, scope));
        let (piece, arc, owner) = self.with_arc(body, span, entry, scope);
        if let (Some(resource_id), Some(arc)) = (resource_id, arc) {
            let used = Use {
                resource: resource_id,
                change: Change::Uses,
                amount,
                at_least: amount,
                per_meter: Rational::default(),
                arc,
                start: piece.start,
                end: piece.end,
                owner,
                level: None,
                span: Some(resource.span),
            };
            self.add_use(used, resource.span, resource.span);
        }
        piece
    }

    /// `unordered { a; b; … }`: parallel branches that start when they like, and share a resource of capacity 1.
    pub(super) fn unordered(&mut self, branches: &[Branch<'program, '_>], span: Span, entry: Entry) -> Piece {
        if branches.is_empty() {
            return self.nothing(span, entry);
        }
        self.unordered_blocks += 1;
        let resource = ResourceId::from_index(self.builder.resources.len());
        self.builder.resources.push(Resource {
            name: format_smolstr!("unordered#{}", self.unordered_blocks),
            supply: Supply::Reusable { capacity: Rational::ONE },
            span: Some(span),
        });
        let fork = self.enter(entry, End::Structural, span);
        let mut ends = Vec::with_capacity(branches.len());
        let mut blocks = Vec::with_capacity(branches.len());
        for branch in branches {
            let span = branch.statement.span;
            let arc = self.builder.reserve(ArcKind::Fork, Interval::ANY, span);
            let first = self.builder.next_occurrence();
            let piece = self.branch(branch, Entry::Free);
            self.builder.connect(arc, fork, piece.start);
            self.builder.uses.push(Use {
                resource,
                change: Change::Uses,
                amount: Rational::ONE,
                at_least: Rational::ONE,
                per_meter: Rational::default(),
                arc,
                start: piece.start,
                end: piece.end,
                owner: piece.occurrence.or_else(|| self.builder.made(first)),
                level: None,
                span: Some(span),
            });
            ends.push((piece.end, span));
            blocks.push(piece.block);
        }
        let join = self.builder.node();
        for (end, span) in ends {
            self.builder.arc(end, join, ArcKind::Join, Interval::ANY, span);
        }
        let block = self.builder.block(BlockKind::Parallel { branches: blocks }, fork, join, Some(span));
        Piece { start: fork, end: join, end_kind: End::Structural, block, arc: None, occurrence: None }
    }

    /// Returns what plans are to be best in.
    pub(super) fn objective(&self) -> Vec<Goal> {
        let goals = self.program.objectives.first().map(|declared| declared.goals.as_slice());
        goals
            .unwrap_or_default()
            .iter()
            .map(|goal| Goal {
                is_maximized: goal.is_maximized,
                terms: goal.terms.clone(),
                span: Some(goal.span),
            })
            .collect()
    }
}

/// Returns how a level has to compare with its bound.
const fn order(condition: &Condition, level: &Level) -> program::Order {
    if condition.negated { level.order.opposite() } else { level.order }
}
