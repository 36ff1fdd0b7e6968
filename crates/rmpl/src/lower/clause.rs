//! Primitives and their clauses.

use super::bounds::{bounds_in, expression};
use super::condition::{Formula, formula, is_condition};
use super::declaration::{formals, kinds, moves};
use super::{Lowering, name_of, names, variable_in};
use crate::diagnostics::syntax;
use crate::program::{Amount, Change, Condition, Effect, Per, PrimitiveDecl, Requirement, ResourceUse, Runs};
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode};

impl Lowering<'_> {
    pub(super) fn primitive(&mut self, node: SyntaxNode<'_>) -> Option<PrimitiveDecl> {
        let mut decl = PrimitiveDecl {
            name: names(node).next()?,
            formals: formals(node),
            kinds: kinds(node),
            bounds: bounds_in(node),
            moves: node.child(SyntaxKind::Moves).and_then(moves).map(Box::new),
            runs: node.child(SyntaxKind::Runs).and_then(runs).map(Box::new),
            requires: Vec::new(),
            sets: Vec::new(),
            uses: Vec::new(),
            costs: Vec::new(),
            rewards: Vec::new(),
            aborts: node.child(SyntaxKind::Aborts).and_then(bounds_in).map(Box::new),
            span: node.span(),
        };
        for clause in node.children() {
            match clause.kind() {
                SyntaxKind::Requires => self.requires(clause, &mut decl.requires),
                SyntaxKind::Sets => decl.sets.extend(clause.children().filter_map(effect)),
                SyntaxKind::Uses => self.uses(clause, &mut decl.uses),
                SyntaxKind::Costs => {
                    decl.costs.extend(clause.children().filter_map(|node| self.amount(node, "costs")));
                }
                SyntaxKind::Rewards => decl.rewards.extend(clause.children().find_map(expression)),
                _ => {}
            }
        }
        Some(decl)
    }

    fn requires(&mut self, clause: SyntaxNode<'_>, out: &mut Vec<Requirement>) {
        // The words `requires at start`, or the first of them.
        let is_at_start = names(clause).nth(2).is_some();
        for node in clause.children().filter(|child| is_condition(child.kind())) {
            let Some(formula) = formula(node) else { continue };
            let mut literals = Vec::new();
            if let Err(choice) = all_of(formula, &mut literals) {
                self.diagnostics.push(syntax::choice_required(choice));
                continue;
            }
            out.extend(literals.into_iter().map(|condition| {
                let is_at_start =
                    is_at_start || condition.level.as_ref().is_some_and(|level| level.is_at_start);
                Requirement { condition, is_at_start }
            }));
        }
    }

    fn uses(&mut self, clause: SyntaxNode<'_>, out: &mut Vec<ResourceUse>) {
        let word = names(clause).next().map(|word| word.text);
        let change = match word.as_deref() {
            Some("uses") => Change::Uses,
            Some("consumes") => Change::Consumes,
            _ => Change::Produces,
        };
        for node in clause.children().filter(|child| child.kind() == SyntaxKind::ResourceUse) {
            let Some(resource) = variable_in(node) else { continue };
            let amount = node.child(SyntaxKind::Amount).map(|amount| self.amount(amount, change.word()));
            // A broken amount is not one that is left out.
            let is_complete = amount.as_ref().map_or(change == Change::Uses, Option::is_some);
            if is_complete {
                out.push(ResourceUse { resource, change, amount: amount.flatten(), span: node.span() });
            }
        }
    }

    /// An amount of the clause `word`, of which some count nothing per unit of time.
    fn amount(&mut self, node: SyntaxNode<'_>, word: &str) -> Option<Amount> {
        let value = node.children().find_map(expression)?;
        let mut words = names(node);
        let (start, unit) = (words.next(), words.next());
        let per = unit.as_ref().and_then(|unit| Per::by_name(&unit.text));
        if let (Some(start), Some(unit), Some(Per::Time(_))) = (start, unit, per)
            && matches!(word, "uses" | "costs")
        {
            self.diagnostics.push(syntax::per_time(word, start.span.cover(unit.span)));
        }
        Some(Amount { value, per, span: node.span() })
    }
}

/// The literals of a condition that must all hold; where one of several is enough, the place of the choice.
fn all_of(formula: Formula, out: &mut Vec<Condition>) -> Result<(), Span> {
    match formula {
        Formula::Literal(literal) => out.push(literal),
        Formula::All(parts) => parts.into_iter().try_for_each(|part| all_of(part, out))?,
        Formula::Any(_, span) => return Err(span),
    }
    Ok(())
}

fn effect(node: SyntaxNode<'_>) -> Option<Effect> {
    let variable = variable_in(node)?;
    let is_value = |kind| matches!(kind, SyntaxKind::Name | SyntaxKind::Number);
    let mut behind = node.own_tokens().skip_while(|token| token.kind != SyntaxKind::Equals);
    let value = name_of(behind.find(|token| is_value(token.kind))?);
    let span = variable.span.cover(value.span);
    Some(Effect { variable, value, span })
}

/// The first name is the word `runs` itself.
fn runs(node: SyntaxNode<'_>) -> Option<Runs> {
    let arguments = node.child(SyntaxKind::Arguments).into_iter().flat_map(names).collect();
    Some(Runs { program: names(node).nth(1)?, arguments })
}
