//! What one declaration says wrongly by itself, whatever the rest of the file says.

use exact::{Bound, Rational};

use rustc_hash::{FxHashMap, FxHashSet};
use smol_str::SmolStr;

use super::alike::edit_distance_at_most;
use super::constant::{self, ConstantError};
use crate::diagnostic::Diagnostic;
use crate::diagnostics::{bounds, choice, duplicate, mixed, option, syntax, value};
use crate::lower::{Item, OptionDecl, OptionValue};
use crate::program::{
    Bounds, ConstrainDecl, Controllability, Expr, GoalDecl, HeaderBound, HeaderBounds, LabelMode, Measure,
    Name, ObstacleShape, PrimitiveDecl, Statement, StatementKind, VariableDecl,
};
use crate::span::Span;
use crate::syntax::{Element, SyntaxKind, SyntaxNode};

/// All of it, in no particular order.
pub(crate) fn local_diagnostics(item: &Item, root: SyntaxNode<'_>) -> Vec<Diagnostic> {
    let mut local = Local { found: Vec::new() };
    local.item(item);
    if matches!(item, Item::Activity(_) | Item::Scenario(_)) {
        local.separators(root);
        local.choices(root);
    }
    local.found
}

/// The occurrences that are named so far where a statement is.
#[derive(Default)]
struct Occurrences {
    names: Vec<Name>,
    spans: FxHashMap<SmolStr, Vec<Span>>,
}

impl Occurrences {
    fn add(&mut self, name: Name) {
        self.spans.entry(name.text.clone()).or_default().push(name.span);
        self.names.push(name);
    }

    /// Forgets all but the first `before` names, and gives them back.
    fn forget(&mut self, before: usize) -> Vec<Name> {
        let names = self.names.split_off(before);
        for name in names.iter().rev() {
            self.spans.get_mut(&name.text).and_then(Vec::pop);
        }
        names
    }
}

/// Which bounds there can be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    /// Of durations, which are never negative.
    NotNegative,
    /// Of two events either may be the first.
    Any,
}

struct Local {
    found: Vec<Diagnostic>,
}

impl Local {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Variable(decl) => {
                self.distinct(&decl.values, "value");
                if let Some(initial) = &decl.initial {
                    self.initial(decl, initial);
                }
            }
            Item::Objective(decl) => {
                for goal in &decl.goals {
                    self.goal(goal);
                }
            }
            Item::Primitive(decl) => {
                self.distinct(&decl.formals, "parameter");
                self.bounds(decl.bounds.as_ref());
                if let Some(aborts) = &decl.aborts {
                    self.bounds(Some(aborts));
                    if constant::evaluate(&aborts.upper) == Ok(Bound::Infinite) {
                        self.found.push(bounds::endless_abort(aborts.upper.span));
                    }
                }
                if let Some(moves) = &decl.moves {
                    self.distinct(&moves.vehicles, "vehicle");
                    if let Some((least, greatest)) = moves.speed_mps
                        && (least > greatest || least.is_negative() || !greatest.is_positive())
                    {
                        self.found.push(value::speeds(moves.span));
                    }
                }
                self.effects(decl);
            }
            Item::Activity(decl) => {
                let mut names = decl.formals.clone();
                names.extend(self.header(&decl.bounds));
                self.distinct(&names, "parameter");
                self.statement(&decl.body);
                self.named(&decl.body, &mut Occurrences::default());
            }
            Item::Scenario(decl) => {
                self.bounds(decl.bounds.as_ref());
                self.statement(&decl.body);
                self.named(&decl.body, &mut Occurrences::default());
            }
            Item::Constrain(decl) => {
                let ConstrainDecl { bounds, .. } = &**decl;
                self.sides(Some(&bounds.lower), Some(&bounds.upper), bounds.span, Sign::Any);
            }
            Item::Option(decl) => self.option(decl),
            Item::Terrain(decl) => {
                if decl.cell_m.is_some_and(|cell_m| cell_m <= 0.0) {
                    self.found.push(value::not_positive("the size of a cell", decl.span));
                }
            }
            Item::Obstacle(decl) => {
                if let ObstacleShape::Circle { radius_m, .. } = decl.shape
                    && radius_m <= 0.0
                {
                    self.found.push(value::not_positive("the radius", decl.numbers_span));
                }
            }
            Item::Model(decl) => {
                for state in &decl.states {
                    self.distinct(&state.values, "value");
                    if let Some(initial) = &state.initial {
                        self.initial(state, initial);
                    }
                }
            }
            Item::Control(decl) => {
                let parsed = crate::control::parse(&decl.text);
                let found = parsed.diagnostics.into_iter();
                self.found.extend(found.map(|diagnostic| diagnostic.moved(decl.text_span.start)));
            }
            Item::Location(_)
            | Item::Constant(_)
            | Item::Resource(_)
            | Item::Import(_)
            | Item::Vehicles(_)
            | Item::Group(_) => {}
        }
    }

    fn distinct(&mut self, names: &[Name], what: &str) {
        let mut known = FxHashSet::default();
        for name in names {
            if !known.insert(name.text.as_str()) {
                self.found.push(duplicate::in_list(name, what));
            }
        }
    }

    /// The value at the start is one of the domain.
    fn initial(&mut self, decl: &VariableDecl, initial: &Name) {
        let values: Vec<&str> = decl.values.iter().map(|value| value.text.as_str()).collect();
        let written = initial.text.as_str();
        if !values.contains(&written) {
            let limit = (written.len() / 3).clamp(1, 3);
            let alike = |value: &&&str| edit_distance_at_most(written, value, limit).is_some();
            let nearest = values.iter().find(alike).copied();
            let name = &decl.name.text;
            self.found.push(value::outside_domain(name, written, initial.span, &values, nearest));
        }
    }

    /// An activity changes a variable once.
    fn effects(&mut self, decl: &PrimitiveDecl) {
        for (index, effect) in decl.sets.iter().enumerate() {
            let name = &effect.variable;
            let moved = decl.moves.iter().flat_map(|moves| &moves.vehicles);
            if decl.sets.iter().take(index).any(|earlier| earlier.variable.text == name.text) {
                self.found.push(duplicate::effect(name));
            } else if let Some(vehicle) = name.text.strip_suffix(".at")
                && moved.into_iter().any(|moved| moved.text == vehicle)
            {
                self.found.push(duplicate::movement(name, vehicle));
            }
        }
    }

    /// The end may come later than a plan says, so that later is never better.
    fn goal(&mut self, goal: &GoalDecl) {
        let mut factors = goal.terms.iter().filter(|(_, measure)| *measure == Measure::End).map(|it| it.0);
        let sum = factors.try_fold(Rational::ZERO, |sum: Rational, factor| sum.checked_add(factor));
        let is_maximized = |factor: Rational| factor.is_positive() == goal.is_maximized;
        if sum.is_some_and(|sum| sum != Rational::ZERO && is_maximized(sum)) {
            self.found.push(syntax::end_maximized(goal.span));
        }
    }

    fn option(&mut self, decl: &OptionDecl) {
        let name = decl.name.text.as_str();
        let is_fine = match (name, &decl.value) {
            ("threat_gap", OptionValue::Number(_)) => true,
            ("strict", OptionValue::Number(flag)) => *flag == Rational::ZERO || *flag == Rational::ONE,
            ("control_step", OptionValue::Number(step)) => step.is_positive(),
            ("time_unit", OptionValue::Name(unit)) => unit == "minute" || unit == "second",
            ("controllability", OptionValue::Name(name)) => Controllability::by_name(name).is_some(),
            ("threat_gap" | "strict" | "time_unit" | "control_step" | "controllability", _) => false,
            _ => {
                self.found.push(option::unknown(&decl.name));
                return;
            }
        };
        if !is_fine {
            let wanted = match name {
                "threat_gap" => "a number of time units",
                "control_step" => "a number of time units above 0",
                "strict" => "0 or 1",
                "controllability" => "`dynamic`, `strong` or `none`",
                _ => "`minute` or `second`",
            };
            self.found.push(value::option(name, wanted, decl.value_span));
        }
    }

    // Bounds.

    /// Checks the limits of a header; gives back the names that its bounds declare.
    fn header(&mut self, header: &HeaderBounds) -> Vec<Name> {
        let HeaderBounds::Sides { lower, upper, span } = header else { return Vec::new() };
        let name = |side: &HeaderBound| match side {
            HeaderBound::Parameter(name) => Some(name.clone()),
            HeaderBound::Limit(_) => None,
        };
        let names = [lower, upper].into_iter().filter_map(name).collect();
        let limit = |side: &HeaderBound| match side {
            HeaderBound::Limit(limit) => Some(limit.clone()),
            HeaderBound::Parameter(_) => None,
        };
        let (lower, upper) = (limit(lower), limit(upper));
        self.sides(lower.as_ref(), upper.as_ref(), *span, Sign::NotNegative);
        names
    }

    fn bounds(&mut self, bounds: Option<&Bounds>) {
        let Some(bounds) = bounds else { return };
        self.sides(Some(&bounds.lower), Some(&bounds.upper), bounds.span, Sign::NotNegative);
        if bounds.is_contingent && constant::evaluate(&bounds.upper) == Ok(Bound::Infinite) {
            self.found.push(bounds::unlimited(bounds.upper.span));
        }
    }

    /// Checks the sides that are constants; one mistake is reported once.
    fn sides(&mut self, lower: Option<&Expr>, upper: Option<&Expr>, span: Span, sign: Sign) {
        let mut values = [None, None];
        for (slot, side) in values.iter_mut().zip([lower, upper]) {
            let Some(side) = side else { continue };
            match constant::evaluate(side) {
                Ok(Bound::Finite(time)) if time.is_negative() && sign == Sign::NotNegative => {
                    self.found.push(bounds::negative(time, side.span));
                    return;
                }
                Ok(value) => *slot = Some(value),
                Err(ConstantError::NotConstant) => {}
                Err(ConstantError::Undefined) => {
                    self.found.push(bounds::undefined(side.span));
                    return;
                }
                Err(ConstantError::TooLarge) => {
                    self.found.push(bounds::too_large(side.span));
                    return;
                }
            }
        }
        match (values, lower, upper) {
            ([Some(Bound::Infinite), _], Some(lower), _) => self.found.push(bounds::endless(lower.span)),
            ([Some(low), Some(high)], Some(lower), Some(upper)) if low > high => {
                self.found.push(bounds::reversed((low, lower.span), (high, upper.span), span));
            }
            _ => {}
        }
    }

    fn statement(&mut self, statement: &Statement) {
        self.bounds(statement.bounds.as_ref());
        match &statement.kind {
            StatementKind::Condition(LabelMode::Tell, told) | StatementKind::Telling(_, told)
                if told.level.is_some() =>
            {
                self.found.push(value::level_told(&told.variable.text, told.span));
            }
            StatementKind::Watching(_, watched) if watched.level.is_some() => {
                self.found.push(value::level_watched(&watched.variable.text, watched.span));
            }
            _ => {}
        }
        statement.parts().iter().for_each(|part| self.statement(part));
    }

    /// Names of occurrences that stand twice where both can be selected. `known` are those before, and those in
    /// `statement` after it.
    fn named(&mut self, statement: &Statement, known: &mut Occurrences) {
        match &statement.kind {
            StatementKind::Choose(alternatives) => {
                let before = known.names.len();
                let mut added: Vec<Name> = Vec::new();
                for alternative in alternatives {
                    self.named(alternative, known);
                    added.append(&mut known.forget(before));
                }
                for name in added {
                    known.add(name);
                }
            }
            StatementKind::Named(body, name) => {
                // What `or` copies is in one place.
                if known
                    .spans
                    .get(&name.text)
                    .is_some_and(|spans| spans.iter().any(|span| *span != name.span))
                {
                    self.found.push(duplicate::occurrence(name));
                }
                known.add(name.clone());
                self.named(body, known);
            }
            _ => statement.parts().iter().for_each(|part| self.named(part, known)),
        }
    }

    // What only the tree shows.

    /// Choices with one alternative.
    fn choices(&mut self, root: SyntaxNode<'_>) {
        for choose in root.descendants().filter(|node| node.kind() == SyntaxKind::Choose) {
            let word = choose.token(SyntaxKind::ChooseKeyword);
            if let (Some(word), 1) = (word, choose.children().count()) {
                self.found.push(choice::one_alternative(word.span));
            }
        }
    }

    /// Blocks in which `,` and `;` meet without braces between them.
    fn separators(&mut self, root: SyntaxNode<'_>) {
        for block in root.descendants().filter(|node| node.kind() == SyntaxKind::Block) {
            let steps =
                |child: &SyntaxNode<'_>| matches!(child.kind(), SyntaxKind::Statement | SyntaxKind::Parallel);
            if block.children().filter(steps).count() < 2 {
                continue;
            }
            let mut parallels = block.children().filter(|child| child.kind() == SyntaxKind::Parallel);
            if let Some(parallel) = parallels.next() {
                let comma = parallel.elements().find_map(|element| match element {
                    Element::Token(token) if token.kind == SyntaxKind::Comma => Some(token.span),
                    _ => None,
                });
                let spans: Vec<Span> =
                    std::iter::once(parallel.span()).chain(parallels.map(SyntaxNode::span)).collect();
                self.found.push(mixed::mixed(comma.unwrap_or_else(|| parallel.span()), &spans));
            }
        }
    }
}
