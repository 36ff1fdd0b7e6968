//! What one declaration declares and uses, in interned names and relative offsets.

use std::hash::{Hash as _, Hasher as _};

use exact::{Bound, Rational, Time};
use rustc_hash::FxHasher;
use smol_str::SmolStr;

use super::constant;
use super::index::Namespace;
use super::names::{Names, Symbol};
use crate::lower::{Item, OptionValue};
use crate::program::{
    Argument, ArgumentValue, Bounds, Condition, Expr, ExprKind, HeaderBound, HeaderBounds, LabelMode, Name,
    Statement, StatementKind,
};
use crate::span::Span;

/// What a declaration declares and uses.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Summary {
    pub(crate) definition: Option<Definition>,
    pub(crate) calls: Vec<Call>,
    pub(crate) literals: Vec<Literal>,
    pub(crate) uses: Vec<Use>,
    /// Names that stand for numbers in the declaration's expressions: its header's bounds and its parameters.
    pub(crate) numbers: Vec<Name>,
    /// Changes when the calls change: who calls whom decides about recursion.
    pub(crate) call_fingerprint: u64,
    /// `Some` when this is `option strict`.
    pub(crate) strict: Option<bool>,
}

/// A name that the declaration introduces.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Definition {
    pub(crate) namespace: Namespace,
    pub(crate) name: Symbol,
    pub(crate) span: Span,
    pub(crate) arity: u32,
    /// Constant bounds of its header.
    pub(crate) bounds: Option<(Time, Bound)>,
    /// The domain of a variable.
    pub(crate) values: Vec<Symbol>,
    pub(crate) is_activity: bool,
    /// It is a traverse (SPEC 1.8).
    pub(crate) moves: bool,
    /// Changes when anything changes that users of the name depend on.
    pub(crate) fingerprint: u64,
}

/// A call, or a name alone that may be one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Call {
    pub(crate) name: Symbol,
    pub(crate) span: Span,
    /// The name with its arguments.
    pub(crate) with_arguments: Span,
    pub(crate) arguments: u32,
    /// A parameter of the surrounding activity is handed on.
    pub(crate) has_formal_argument: bool,
    pub(crate) bounds: Option<((Time, Bound), Span)>,
    pub(crate) is_bare: bool,
}

/// A condition, asked or told.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Literal {
    pub(crate) mode: LabelMode,
    pub(crate) variable: Symbol,
    pub(crate) variable_span: Span,
    /// The values; an atom has none.
    pub(crate) values: Vec<(Symbol, Span)>,
    /// `X` and `V` of a condition written `X_V`.
    pub(crate) split: Option<(Symbol, Symbol)>,
    pub(crate) negated: bool,
    pub(crate) span: Span,
    /// A parameter stands for the variable.
    pub(crate) variable_is_formal: bool,
    /// A parameter stands for the value.
    pub(crate) value_is_formal: bool,
    pub(crate) is_bare: bool,
}

/// A use of a name that is neither call nor condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Use {
    pub(crate) kind: UseKind,
    pub(crate) name: Symbol,
    pub(crate) span: Span,
}

/// What a name is used as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UseKind {
    /// An argument of the call with this index: a location, or any symbol.
    Argument(u32),
    /// The location where a vehicle starts.
    Start,
    /// A vehicle of a traverse.
    Vehicle,
    /// A number in an expression: a constant, for parameters are no uses.
    Number,
    /// A name in a header's bounds: a constant if there is one of this name, otherwise it declares a parameter.
    HeaderBound,
}

/// Summarises what was lowered. `bare_names` are the starts of names that stand alone as statements.
pub(crate) fn summarize(item: Option<&Item>, bare_names: &[u32], names: &mut Names) -> Summary {
    let mut collector = Collector { names, bare_names, formals: Vec::new(), summary: Summary::default() };
    if let Some(item) = item {
        collector.item(item);
    }
    let mut summary = collector.summary;
    let mut hasher = FxHasher::default();
    for call in &summary.calls {
        (call.name, call.is_bare).hash(&mut hasher);
    }
    summary.call_fingerprint = hasher.finish();
    summary
}

struct Collector<'a> {
    names: &'a mut Names,
    bare_names: &'a [u32],
    formals: Vec<SmolStr>,
    summary: Summary,
}

impl Collector<'_> {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Constant(decl) => {
                self.define(Namespace::Constant, &decl.name, 0, None, Vec::new());
                self.expression(&decl.value);
            }
            Item::Variable(decl) => {
                let values = decl.values.iter().map(|value| self.names.intern(&value.text)).collect();
                self.define(Namespace::Variable, &decl.name, 0, None, values);
            }
            Item::Primitive(decl) => {
                let bounds = decl.bounds.as_ref().and_then(constant::interval);
                self.define(Namespace::Callable, &decl.name, decl.formals.len(), bounds, Vec::new());
                if let Some(definition) = self.summary.definition.as_mut().filter(|_| decl.moves.is_some()) {
                    definition.moves = true;
                    definition.fingerprint ^= 1 << 2;
                }
                self.formals = decl.formals.iter().map(|formal| formal.text.clone()).collect();
                self.summary.numbers.clone_from(&decl.formals);
                self.bounds(decl.bounds.as_ref());
                for vehicle in decl.moves.iter().flat_map(|moves| &moves.vehicles) {
                    if !self.formals.contains(&vehicle.text) {
                        self.name_use(UseKind::Vehicle, &vehicle.text, vehicle.span);
                    }
                }
            }
            Item::Activity(decl) => {
                let bounds = header_interval(&decl.bounds);
                self.define(Namespace::Callable, &decl.name, decl.formals.len(), bounds, Vec::new());
                if let Some(definition) = &mut self.summary.definition {
                    definition.is_activity = true;
                    definition.fingerprint ^= 1;
                }
                self.formals = decl.formals.iter().map(|formal| formal.text.clone()).collect();
                self.summary.numbers.clone_from(&decl.formals);
                self.header(&decl.bounds);
                self.statement(&decl.body);
            }
            Item::Scenario(decl) => {
                self.define(Namespace::Scenario, &decl.name, 0, None, Vec::new());
                self.bounds(decl.bounds.as_ref());
                self.statement(&decl.body);
            }
            Item::Option(decl) => {
                self.define(Namespace::Option, &decl.name, 0, None, Vec::new());
                if decl.name.text == "strict" {
                    self.summary.strict =
                        Some(matches!(decl.value, OptionValue::Number(value) if value == Rational::ONE));
                }
            }
            Item::Terrain(decl) => {
                let name = Name { text: SmolStr::new_static("terrain"), span: decl.asset_span };
                self.define(Namespace::Terrain, &name, 0, None, Vec::new());
            }
            Item::Control(_) => {}
            Item::Location(decl) => self.define(Namespace::Location, &decl.name, 0, None, Vec::new()),
            Item::Obstacle(decl) => self.define(Namespace::Obstacle, &decl.name, 0, None, Vec::new()),
            Item::Vehicle(decl) => {
                self.define(Namespace::Vehicle, &decl.name, 0, None, Vec::new());
                self.name_use(UseKind::Start, &decl.start.text, decl.start.span);
            }
        }
    }

    fn define(
        &mut self,
        namespace: Namespace,
        name: &Name,
        arity: usize,
        bounds: Option<(Time, Bound)>,
        values: Vec<Symbol>,
    ) {
        let symbol = self.names.intern(&name.text);
        let mut hasher = FxHasher::default();
        (namespace, arity, bounds, &values).hash(&mut hasher);
        self.summary.definition = Some(Definition {
            namespace,
            name: symbol,
            span: name.span,
            arity: arity as u32,
            bounds,
            values,
            is_activity: false,
            moves: false,
            // The lowest bit says activity or primitive.
            fingerprint: (hasher.finish() & !1) | 2,
        });
    }

    fn name_use(&mut self, kind: UseKind, text: &SmolStr, span: Span) {
        let name = self.names.intern(text);
        self.summary.uses.push(Use { kind, name, span });
    }

    /// The names of a header's bounds stand for numbers in the body, unless they are constants: which they are is
    /// known once the whole file is.
    fn header(&mut self, bounds: &HeaderBounds) {
        let HeaderBounds::Sides { lower, upper, .. } = bounds else { return };
        for side in [lower, upper] {
            if let HeaderBound::Parameter(name) = side {
                self.summary.numbers.push(name.clone());
                self.name_use(UseKind::HeaderBound, &name.text, name.span);
            }
        }
        for side in [lower, upper] {
            if let HeaderBound::Limit(limit) = side {
                self.expression(limit);
            }
        }
    }

    fn bounds(&mut self, bounds: Option<&Bounds>) {
        for side in bounds.iter().flat_map(|bounds| [&bounds.lower, &bounds.upper]) {
            self.expression(side);
        }
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Name(text) => {
                if self.summary.numbers.iter().all(|name| name.text != *text) {
                    self.name_use(UseKind::Number, text, expr.span);
                }
            }
            ExprKind::Percent(inner) => self.expression(inner),
            ExprKind::Binary(_, left, right) => {
                self.expression(left);
                self.expression(right);
            }
            ExprKind::Number(_) | ExprKind::Duration(..) | ExprKind::Infinity => {}
        }
    }

    fn statement(&mut self, statement: &Statement) {
        self.bounds(statement.bounds.as_ref());
        match &statement.kind {
            StatementKind::Sequence(parts)
            | StatementKind::Parallel(parts)
            | StatementKind::Choose(parts) => {
                for part in parts {
                    self.statement(part);
                }
            }
            StatementKind::Maintaining(body, condition) => {
                self.statement(body);
                self.literal(LabelMode::Ask, condition, false);
            }
            StatementKind::Watching(body, condition) => {
                self.statement(body);
                let denied = Condition { negated: !condition.negated, ..condition.clone() };
                self.literal(LabelMode::Tell, &denied, false);
            }
            StatementKind::IfThennext(condition, body) => {
                self.literal(LabelMode::Ask, condition, false);
                self.statement(body);
            }
            StatementKind::Repeat(count, body) => {
                self.expression(count);
                self.statement(body);
            }
            StatementKind::Call(name, arguments) => {
                let call = self.summary.calls.len() as u32;
                for argument in arguments {
                    match &argument.value {
                        ArgumentValue::Name(text) if !self.formals.contains(text) => {
                            self.name_use(UseKind::Argument(call), text, argument.span);
                        }
                        ArgumentValue::Expression(expr) => self.expression(expr),
                        // What it is used for, asked or told, is known where the parameter stands.
                        ArgumentValue::Condition(condition) => {
                            self.literal(LabelMode::Tell, condition, false);
                        }
                        ArgumentValue::Name(_) | ArgumentValue::Number(_) => {}
                    }
                }
                let is_formal = |argument: &Argument| matches!(&argument.value, ArgumentValue::Name(text) if self.formals.contains(text));
                let has_formal_argument = arguments.iter().any(is_formal);
                self.call(name, arguments.len(), statement, false);
                if let Some(call) = self.summary.calls.last_mut() {
                    call.has_formal_argument = has_formal_argument;
                }
            }
            StatementKind::Condition(mode, condition) => {
                let is_bare = self.bare_names.binary_search(&condition.variable.span.start).is_ok();
                if is_bare {
                    self.call(&condition.variable, 0, statement, true);
                }
                self.literal(*mode, condition, is_bare);
            }
            StatementKind::Delay => {}
        }
    }

    fn call(&mut self, name: &Name, arguments: usize, statement: &Statement, is_bare: bool) {
        if is_bare && self.formals.contains(&name.text) {
            return;
        }
        let bounds = statement.bounds.as_ref();
        let end = bounds.map_or(statement.span.end, |bounds| bounds.span.start);
        let call = Call {
            name: self.names.intern(&name.text),
            span: name.span,
            with_arguments: Span::new(name.span.start, end.max(name.span.end)),
            arguments: arguments as u32,
            has_formal_argument: false,
            bounds: bounds.and_then(|bounds| Some((constant::interval(bounds)?, bounds.span))),
            is_bare,
        };
        self.summary.calls.push(call);
    }

    fn literal(&mut self, mode: LabelMode, condition: &Condition, is_bare: bool) {
        let text = &condition.variable.text;
        let split = text.rsplit_once('_').filter(|_| condition.values.is_empty());
        let split = split.filter(|(variable, value)| !variable.is_empty() && !value.is_empty());
        let literal = Literal {
            mode,
            variable: self.names.intern(text),
            variable_span: condition.variable.span,
            values: condition
                .values
                .iter()
                .map(|value| (self.names.intern(&value.text), value.span))
                .collect(),
            split: split.map(|(variable, value)| {
                (self.names.intern(&SmolStr::new(variable)), self.names.intern(&SmolStr::new(value)))
            }),
            negated: condition.negated,
            span: condition.span,
            variable_is_formal: self.formals.contains(text),
            value_is_formal: condition.values.iter().any(|value| self.formals.contains(&value.text)),
            is_bare,
        };
        self.summary.literals.push(literal);
    }
}

fn header_interval(bounds: &HeaderBounds) -> Option<(Time, Bound)> {
    let HeaderBounds::Sides { lower, upper, .. } = bounds else { return None };
    let lower = match lower {
        HeaderBound::Parameter(_) => Time::ZERO,
        HeaderBound::Limit(limit) => constant::evaluate(limit).ok()?.finite()?,
    };
    let upper = match upper {
        HeaderBound::Parameter(_) => Bound::Infinite,
        HeaderBound::Limit(limit) => constant::evaluate(limit).ok()?,
    };
    (lower >= Time::ZERO && Bound::Finite(lower) <= upper).then_some((lower, upper))
}

impl Summary {
    /// Every name that checks of this declaration look up; some more than once.
    pub(crate) fn symbols(&self) -> impl Iterator<Item = Symbol> + '_ {
        let defined = self.definition.iter().map(|definition| definition.name);
        let called = self.calls.iter().map(|call| call.name);
        let used = self.uses.iter().map(|used| used.name);
        let asked = self.literals.iter().map(|literal| literal.variable);
        let split = self.literals.iter().filter_map(|literal| literal.split).map(|(variable, _)| variable);
        defined.chain(called).chain(used).chain(asked).chain(split)
    }
}
