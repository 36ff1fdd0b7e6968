//! The clauses of a primitive at one call of it: what it requires, changes, uses and is worth (SPEC 10.1, 11, 12).

use exact::Rational;
use rmpl::diagnostics::model as model_wording;
use rmpl::fleet::said_speed_mps;
use rmpl::program::{ArgumentValue, Condition, LabelMode, Moves, Name, Per, PrimitiveDecl};
use rmpl::{Code, Diagnostic, Span};
use smol_str::{SmolStr, format_smolstr};

use super::bounds::{E_BOUNDS, Interval};
use super::expander::{Expander, Piece};
use super::names::{E_UNDEF, Fact, substituted};
use super::resource::Asked;
use super::scope::Scope;
use crate::network::{ArcId, Extent, OccurrenceId, Worth};

/// One variable is set twice.
const E_DUP: Code = Code("E-DUP");

/// A call of a declared primitive.
pub(super) struct Activity<'a> {
    pub(super) declared: &'a PrimitiveDecl,
    pub(super) arguments: &'a [ArgumentValue],
    /// What the primitive's parameters represent.
    pub(super) scope: &'a Scope,
    pub(super) occurrence: OccurrenceId,
    pub(super) arc: ArcId,
    pub(super) interval: Interval,
}

impl Expander<'_> {
    /// Labels the activity's arc with what it requires and changes, and notes what it uses and is worth. `called` is where
    /// the call names it.
    pub(super) fn clauses(&mut self, activity: &Activity<'_>, piece: &Piece, called: Span) {
        let effects = self.effects(activity, called);
        for required in &activity.declared.requires {
            if required.condition.level.is_some() {
                let asked = Asked {
                    arc: activity.arc,
                    start: piece.start,
                    end: piece.end,
                    owner: Some(activity.occurrence),
                    is_at_start: required.is_at_start,
                };
                self.level(&required.condition, &asked, activity.scope, called);
                continue;
            }
            let Some(fact) = self.fact(&required.condition, activity.scope) else { continue };
            let is_set = effects.iter().any(|(effect, _)| effect.variable == fact.variable);
            let extent = if required.is_at_start || is_set { Extent::Start } else { Extent::Arc };
            let owner = Some(activity.occurrence);
            self.builder.label(activity.arc, (LabelMode::Ask, extent), fact, owner, required.condition.span);
        }
        for (fact, span) in effects {
            let owner = Some(activity.occurrence);
            self.builder.label(activity.arc, (LabelMode::Tell, Extent::Effect), fact, owner, span);
        }
        for written in &activity.declared.uses {
            self.primitive_use(activity, piece, written, called);
        }
        self.worth(activity);
        self.check_speed(activity);
        if let Some(written) = &activity.declared.aborts {
            let interval = self.interval(written, activity.scope);
            if let Some(upper) = interval.upper.finite() {
                self.builder.abortable(activity.occurrence, [interval.lower, upper]);
            }
        }
    }

    /// Returns what the activity changes, each with where that is written: vehicles that it moves are at its last
    /// location then.
    fn effects(&mut self, activity: &Activity<'_>, called: Span) -> Vec<(Fact, Span)> {
        let mut effects: Vec<(Fact, Span)> = Vec::new();
        if let Some(moves) = &activity.declared.moves
            && let Some(place) = self.last_location(activity.arguments)
        {
            for vehicle in moved(moves, activity.scope) {
                let variable = format_smolstr!("{vehicle}.at");
                if self.vocabulary.is_lasting(&variable)
                    && effects.iter().all(|(known, _)| known.variable != variable)
                {
                    let fact = Fact::is(variable, place.clone());
                    effects.push((fact, moves.span));
                }
            }
        }
        for effect in &activity.declared.sets {
            let condition = Condition {
                variable: effect.variable.clone(),
                values: vec![effect.value.clone()],
                sees: None,
                level: None,
                negated: false,
                span: effect.span,
            };
            let Some(fact) = self.fact(&condition, activity.scope) else { continue };
            if !self.vocabulary.is_lasting(&fact.variable) {
                let message =
                    format!("`{}` cannot be set, because it is not a state variable", fact.variable);
                let hint =
                    format!("declare it: `state {} : {{{}, …}} = …;`", fact.variable, effect.value.text);
                self.diagnostics
                    .push(Diagnostic::error(E_UNDEF, effect.variable.span, message).with_hint(hint));
            } else if effects.iter().any(|(known, _)| known.variable == fact.variable) {
                let message = format!("`{}` sets `{}` twice", activity.declared.name.text, fact.variable);
                let is_declared_so = effect.variable.text == fact.variable;
                let span = if is_declared_so { effect.span } else { called };
                self.diagnostics.push(Diagnostic::error(E_DUP, span, message));
            } else {
                effects.push((fact, effect.span));
            }
        }
        effects
    }

    /// Reports vehicles whose declared models do not reach the speed that the traverse is to have (SPEC 17). What the built-in
    /// models reach is not a limit: their speeds are measured on flat ground.
    fn check_speed(&mut self, activity: &Activity<'_>) {
        let Some(moves) = &activity.declared.moves else { return };
        let Some((_, wanted_mps)) = moves.speed_mps else { return };
        let world = &self.program.world;
        for name in moved(moves, activity.scope) {
            let Some(vehicle) = world.vehicles.iter().find(|it| it.name.text == name) else { continue };
            let model = &vehicle.model.text;
            if let Some(max_mps) = said_speed_mps(world, model).filter(|most| wanted_mps > *most) {
                let [wanted, greatest] = [wanted_mps, max_mps].map(|speed| speed.to_f64().to_string());
                self.diagnostics.push(model_wording::too_fast(&wanted, &name, model, &greatest, moves.span));
            }
        }
    }

    fn last_location(&self, arguments: &[ArgumentValue]) -> Option<SmolStr> {
        let is_location =
            |name: &SmolStr| self.program.world.locations.iter().any(|location| location.name.text == *name);
        let names = arguments.iter().rev().filter_map(|argument| match argument {
            ArgumentValue::Name(name) => Some(name),
            _ => None,
        });
        names.into_iter().find(|name| is_location(name)).cloned()
    }

    fn worth(&mut self, activity: &Activity<'_>) {
        let (mut cost, mut cost_per_meter, mut reward) =
            (Rational::default(), Rational::default(), Rational::default());
        let declared = activity.declared;
        for amount in &declared.costs {
            let value = self.amount(&amount.value, activity.scope);
            let sum = if amount.per == Some(Per::Meter) { &mut cost_per_meter } else { &mut cost };
            self.add(sum, value, amount.span);
        }
        for written in &declared.rewards {
            let value = self.amount(written, activity.scope);
            self.add(&mut reward, value, written.span);
        }
        if !declared.costs.is_empty() || !declared.rewards.is_empty() {
            self.builder.worths.push(Worth { arc: activity.arc, cost, cost_per_meter, reward });
        }
    }

    fn add(&mut self, sum: &mut Rational, value: Rational, span: Span) {
        if let Some(total) = sum.checked_add(value) {
            *sum = total;
        } else {
            let message = "these amounts are too large or too precise to add exactly";
            self.diagnostics.push(Diagnostic::error(E_BOUNDS, span, message));
        }
    }
}

/// The vehicles that a traverse moves, after substitution.
fn moved(moves: &Moves, scope: &Scope) -> Vec<SmolStr> {
    let vehicle = |name: &Name| substituted(&name.text, &|name| scope.argument(name));
    moves.vehicles.iter().map(vehicle).collect()
}
