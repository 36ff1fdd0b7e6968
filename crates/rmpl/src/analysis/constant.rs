//! Bounds that are constants, evaluated exactly (SPEC 1.5).

use exact::{Bound, BoundError, Time};

use rustc_hash::FxHashMap;
use smol_str::SmolStr;
use std::cell::{Cell, RefCell};

use crate::program::{BinaryOp, Bounds, Expr, ExprKind, Program, TimeUnit};

/// Why an expression has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ConstantError {
    /// It depends on a bound parameter.
    NotConstant,
    /// The arithmetic has no result: a division by zero, or infinity taken away.
    Undefined,
    /// The result is too large to be exact.
    TooLarge,
}

/// The bounds of a statement when both are constants and make sense together.
pub(crate) fn interval(bounds: &Bounds) -> Option<(Time, Bound)> {
    let lower = evaluate(&bounds.lower).ok()?.finite()?;
    let upper = evaluate(&bounds.upper).ok()?;
    (!lower.is_negative() && Bound::Finite(lower) <= upper).then_some((lower, upper))
}

/// The value of an expression without names.
pub(crate) fn evaluate(expr: &Expr) -> Result<Bound, ConstantError> {
    evaluate_with(expr, None, &|_| None)
}

/// The value of an expression where `lookup` gives the values of names, and `unit` is the mission's, if that is known.
fn evaluate_with(
    expr: &Expr,
    unit: Option<TimeUnit>,
    lookup: &dyn Fn(&str) -> Option<Bound>,
) -> Result<Bound, ConstantError> {
    match &expr.kind {
        ExprKind::Number(number) => Ok(Bound::Finite(Time::from_units(*number))),
        ExprKind::Duration(number, written) => {
            let unit = unit.ok_or(ConstantError::NotConstant)?;
            let value = written.in_units(unit).and_then(|one| one.checked_mul(*number));
            value.map(|value| Bound::Finite(Time::from_units(value))).ok_or(ConstantError::TooLarge)
        }
        ExprKind::Infinity => Ok(Bound::Infinite),
        ExprKind::Name(name) => lookup(name).ok_or(ConstantError::NotConstant),
        ExprKind::Percent(inner) => {
            combine(BinaryOp::Divide, evaluate_with(inner, unit, lookup)?, Bound::Finite(Time::from(100)))
        }
        ExprKind::Binary(operator, left, right) => {
            combine(*operator, evaluate_with(left, unit, lookup)?, evaluate_with(right, unit, lookup)?)
        }
    }
}

fn combine(operator: BinaryOp, left: Bound, right: Bound) -> Result<Bound, ConstantError> {
    let value = match operator {
        BinaryOp::Add => left.plus(right),
        BinaryOp::Subtract => left.minus(right),
        BinaryOp::Multiply => left.times(right),
        // Where infinity is written as a divisor, something else was meant.
        BinaryOp::Divide if right == Bound::Infinite => return Err(ConstantError::Undefined),
        BinaryOp::Divide => left.over(right),
    };
    value.map_err(|error| match error {
        BoundError::Overflow => ConstantError::TooLarge,
        _ => ConstantError::Undefined,
    })
}

/// The values of a file's constants, for the editor: compilation has its own, with what is wrong with them.
#[derive(Debug)]
pub(crate) struct Constants {
    declared: FxHashMap<SmolStr, Expr>,
    unit: TimeUnit,
    /// What has been asked for, or is being worked out.
    known: RefCell<FxHashMap<SmolStr, Option<Bound>>>,
    depth: Cell<u32>,
}

/// Constants that name each other in longer chains have no value here.
const MAX_CHAIN: u32 = 100;

impl Constants {
    pub(crate) fn new(program: &Program) -> Self {
        let mut declared = FxHashMap::default();
        for constant in &program.constants {
            declared.entry(constant.name.text.clone()).or_insert_with(|| constant.value.clone());
        }
        let unit = program.options.time_unit;
        Self { declared, unit, known: RefCell::default(), depth: Cell::new(0) }
    }

    /// The value of a constant; none if it has no value, or depends on itself.
    pub(crate) fn value(&self, name: &str) -> Option<Bound> {
        let known = self.known.borrow().get(name).copied();
        if let Some(known) = known {
            return known;
        }
        let expr = self.declared.get(name).filter(|_| self.depth.get() < MAX_CHAIN)?;
        self.known.borrow_mut().insert(name.into(), None);
        self.depth.set(self.depth.get() + 1);
        let value = self.evaluate(expr, &|_| None);
        self.depth.set(self.depth.get() - 1);
        self.known.borrow_mut().insert(name.into(), value);
        value
    }

    /// The value of an expression: of its names, `lookup` knows those that are not constants.
    pub(crate) fn evaluate(&self, expr: &Expr, lookup: &dyn Fn(&str) -> Option<Bound>) -> Option<Bound> {
        let lookup = |name: &str| lookup(name).or_else(|| self.value(name));
        evaluate_with(expr, Some(self.unit), &lookup).ok()
    }
}
