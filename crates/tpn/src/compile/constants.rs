//! The constants of a program and its unit of time: what expressions mean wherever they stand (SPEC 14).

use std::collections::BTreeMap;

use exact::{Bound, Rational};
use rmpl::call_cycles::call_cycles;
use rmpl::diagnostics::recursion;
use rmpl::program::{ConstantDecl, DurationUnit, Expr, ExprKind, Program, TimeUnit};
use rmpl::{Diagnostic, Span};

use super::bounds::{self, E_BOUNDS, Values};

/// The values of a program's constants.
#[derive(Clone, Debug)]
pub(super) struct Constants<'program> {
    values: BTreeMap<&'program str, Bound>,
    unit: TimeUnit,
}

impl<'program> Constants<'program> {
    /// Evaluates the constants of `program`, in whatever order they are written, and says what is wrong with them.
    pub(super) fn new(program: &'program Program) -> (Self, Vec<Diagnostic>) {
        let mut constants = Self { values: BTreeMap::new(), unit: program.options.time_unit };
        let mut by_name: BTreeMap<&str, usize> = BTreeMap::new();
        for (index, declared) in program.constants.iter().enumerate() {
            by_name.entry(declared.name.text.as_str()).or_insert(index);
        }
        let named: Vec<Vec<(usize, Span)>> = program
            .constants
            .iter()
            .map(|declared| {
                let mut named = Vec::new();
                for_each_name(&declared.value, &mut |name, span| {
                    named.extend(by_name.get(name).map(|&index| (index, span)));
                });
                named
            })
            .collect();
        let name = |index: usize| program.constants[index].name.text.as_str();
        let mut found: Vec<Diagnostic> = Vec::new();
        for cycle in call_cycles(&named) {
            let members: Vec<&str> = cycle.members.iter().map(|&member| name(member)).collect();
            found.push(recursion::constants(&members, cycle.closing_call));
        }
        if !found.is_empty() {
            return (constants, found);
        }
        for index in after_what_they_name(&named) {
            let declared = &program.constants[index];
            if by_name.get(name(index)) == Some(&index) {
                constants.evaluate(declared, &mut found);
            }
        }
        (constants, found)
    }

    fn evaluate(&mut self, declared: &'program ConstantDecl, found: &mut Vec<Diagnostic>) {
        match bounds::value(&declared.value, self) {
            Ok(Bound::Infinite) => {
                let message = format!("the constant `{}` must be finite", declared.name.text);
                found.push(Diagnostic::error(E_BOUNDS, declared.value.span, message));
            }
            Ok(value) => {
                self.values.insert(declared.name.text.as_str(), value);
            }
            Err(error) => found.push(error),
        }
    }
}

impl Values for Constants<'_> {
    fn number(&self, name: &str) -> Option<Bound> {
        self.values.get(name).copied()
    }

    fn in_mission_units(&self, unit: DurationUnit) -> Option<Rational> {
        unit.in_units(self.unit)
    }
}

/// All constants, each after those that it names, as far as no cycle prevents that. Linear in the number of names.
fn after_what_they_name(named: &[Vec<(usize, Span)>]) -> Vec<usize> {
    let mut order = Vec::with_capacity(named.len());
    let mut is_seen = vec![false; named.len()];
    for first in 0..named.len() {
        let mut path = Vec::new();
        if !std::mem::replace(&mut is_seen[first], true) {
            path.push((first, 0));
        }
        while let Some((index, next)) = path.last_mut() {
            let Some(&(other, _)) = named[*index].get(*next) else {
                order.push(*index);
                path.pop();
                continue;
            };
            *next += 1;
            if !std::mem::replace(&mut is_seen[other], true) {
                path.push((other, 0));
            }
        }
    }
    order
}

fn for_each_name<'program>(expr: &'program Expr, visit: &mut dyn FnMut(&'program str, Span)) {
    match &expr.kind {
        ExprKind::Name(name) => visit(name, expr.span),
        ExprKind::Percent(inner) => for_each_name(inner, visit),
        ExprKind::Binary(_, left, right) => {
            for_each_name(left, visit);
            for_each_name(right, visit);
        }
        ExprKind::Number(_) | ExprKind::Duration(..) | ExprKind::Infinity => {}
    }
}
