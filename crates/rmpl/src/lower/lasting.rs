//! States, resources and objectives.

use exact::Rational;

use super::bounds::expression;
use super::{names, variable_in};
use crate::program::{GoalDecl, Measure, ObjectiveDecl, ResourceDecl, Supply, VariableDecl};
use crate::syntax::{SyntaxKind, SyntaxNode};

pub(super) fn state(node: SyntaxNode<'_>) -> Option<VariableDecl> {
    if node.child(SyntaxKind::FromPlant).is_some() {
        let name = variable_in(node)?;
        return Some(VariableDecl {
            name,
            values: Vec::new(),
            initial: None,
            is_from_plant: true,
            span: node.span(),
        });
    }
    // The first name is the word `state` itself.
    let name = names(node).nth(1)?;
    let values: Vec<_> = names(node.child(SyntaxKind::Domain)?).collect();
    let initial = node.child(SyntaxKind::Initial).and_then(|initial| names(initial).next());
    // A state whose first value is still to be written is one already.
    let initial = initial.or_else(|| values.first().cloned())?;
    Some(VariableDecl { name, values, initial: Some(initial), is_from_plant: false, span: node.span() })
}

pub(super) fn resource(node: SyntaxNode<'_>) -> Option<ResourceDecl> {
    let name = names(node).nth(1)?;
    let supply = if let Some(range) = node.child(SyntaxKind::Range) {
        let mut parts = range.children().filter_map(expression);
        let (least, greatest, level) = (parts.next()?, parts.next()?, parts.next()?);
        Supply::Reservoir { least, greatest, level }
    } else {
        let capacity = node.child(SyntaxKind::Capacity);
        Supply::Reusable { capacity: capacity.and_then(|capacity| capacity.children().find_map(expression)) }
    };
    Some(ResourceDecl { name, supply, span: node.span() })
}

pub(super) fn objective(node: SyntaxNode<'_>) -> Option<ObjectiveDecl> {
    let goals: Vec<_> = node.children().filter_map(goal).collect();
    (!goals.is_empty()).then_some(ObjectiveDecl { goals, span: node.span() })
}

fn goal(node: SyntaxNode<'_>) -> Option<GoalDecl> {
    let mut tokens = node.own_tokens();
    let is_maximized = tokens.next().filter(|token| token.kind == SyntaxKind::Name)?.text == "maximize";
    let mut terms = Vec::new();
    let mut is_negative = false;
    let mut factor = Rational::ONE;
    for token in tokens {
        match token.kind {
            SyntaxKind::Minus => is_negative = true,
            SyntaxKind::Number => factor = token.text.parse().ok()?,
            SyntaxKind::Name => {
                let signed = if is_negative { factor.checked_neg()? } else { factor };
                terms.push((signed, Measure::by_name(token.text)?));
                (is_negative, factor) = (false, Rational::ONE);
            }
            _ => {}
        }
    }
    (!terms.is_empty()).then_some(GoalDecl { is_maximized, terms, span: node.span() })
}
