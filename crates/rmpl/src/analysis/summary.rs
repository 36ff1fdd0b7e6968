//! What one declaration declares and uses, in interned names and relative offsets.

use exact::{Bound, Time};

use super::index::Namespace;
use super::names::Symbol;
use crate::program::{Change, LabelMode, Name};
use crate::span::Span;

/// What a declaration declares and uses.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Summary {
    pub(crate) definition: Option<Definition>,
    /// What it declares beside: further vehicles, and those of fleets.
    pub(crate) others: Vec<Definition>,
    pub(crate) calls: Vec<Call>,
    pub(crate) literals: Vec<Literal>,
    pub(crate) uses: Vec<Use>,
    /// The names that `as` gives to occurrences; one that `or` copies more than once.
    pub(crate) occurrences: Vec<Symbol>,
    /// Names that represent numbers in the declaration's expressions: its header's bounds and its parameters.
    pub(crate) numbers: Vec<Name>,
    /// Changes when the calls change: who calls whom decides about recursion.
    pub(crate) call_fingerprint: u64,
    /// `Some` when this is `option strict`.
    pub(crate) strict: Option<bool>,
    /// The environment chooses some duration in it (SPEC 13.1).
    pub(crate) has_contingents: bool,
    /// A parameter represents a vehicle that is moved.
    pub(crate) moves_a_parameter: bool,
    /// The components of the plant that it models.
    pub(crate) components: Vec<ComponentState>,
    /// Where the declaration begins, after the comments before it.
    pub(crate) start: u32,
}

/// What a component of a plant can be, as a state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ComponentState {
    /// `Engine.mode`
    pub(crate) name: Symbol,
    pub(crate) modes: Vec<Symbol>,
    pub(crate) initial: Symbol,
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
    /// The environment chooses within them (SPEC 13.1).
    pub(crate) is_contingent: bool,
    /// The domain of a variable.
    pub(crate) values: Vec<Symbol>,
    /// The first value of a state variable, or the location where a vehicle starts.
    pub(crate) initial: Option<Symbol>,
    /// The domain and the first value of a state variable are those of a component.
    pub(crate) is_from_plant: bool,
    pub(crate) is_activity: bool,
    /// It is a traverse (SPEC 1.8).
    pub(crate) moves: bool,
    /// The model of a vehicle, or the one that a model extends.
    pub(crate) model: Option<Symbol>,
    /// What each vehicle of a model has of its own.
    pub(crate) equipment: Vec<Equipment>,
    /// Changes when anything changes that users of the name depend on.
    pub(crate) fingerprint: u64,
}

/// A resource or a state of a vehicle model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Equipment {
    pub(crate) name: Symbol,
    /// The domain of a state.
    pub(crate) values: Vec<Symbol>,
    /// The first value of a state; a resource has none.
    pub(crate) initial: Option<Symbol>,
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
    /// The bounds, if the environment is to choose within them.
    pub(crate) contingent: Option<Span>,
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
    /// A parameter represents the variable, or for the component whose mode it is.
    pub(crate) variable_is_formal: bool,
    /// A parameter represents the value.
    pub(crate) value_is_formal: bool,
    /// What decides about it is which places see a location, which only the ground tells.
    pub(crate) is_sight: bool,
    pub(crate) is_bare: bool,
    pub(crate) origin: Origin,
    /// The vehicle of a variable `V.at`.
    pub(crate) vehicle: Option<Vehicle>,
}

/// Where a condition is, as far as that decides what it means for a state variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// In a statement that asserts or requires it, or in a `requires`.
    Written,
    /// Behind `watching`: the opposite is kept away, which asserts nothing of a state variable.
    Watched,
    /// Handed to a call.
    Argument,
    /// Behind `sets`.
    Effect,
}

/// A vehicle whose place a condition is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vehicle {
    pub(crate) name: Symbol,
    pub(crate) span: Span,
    pub(crate) is_formal: bool,
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
    /// The place of a vehicle, compared or set: a location.
    Place,
    /// The model of a vehicle, or the one that a model extends.
    Model,
    /// What `any` and `each` range over: a group or a fleet.
    Group,
    /// A member of a group: a vehicle, a fleet, a location, a value, or a group.
    Member,
    /// Whom a keep-out area is closed to: a vehicle, a vehicle model, or an activity that moves vehicles.
    ClosedTo,
    /// A resource that something is done to.
    Resource(Change),
    /// A reservoir whose level is compared. Compilation says what has none.
    Level,
    /// An occurrence that a bound between events names.
    Occurrence,
    /// A number in an expression: a constant, for parameters are not uses.
    Number,
    /// A name in a header's bounds: a constant if there is one of this name, otherwise it declares a parameter.
    HeaderBound,
}

impl Summary {
    /// All that it declares.
    pub(crate) fn definitions(&self) -> impl Iterator<Item = &Definition> {
        self.definition.iter().chain(&self.others)
    }

    /// Returns whether names with a dot in other declarations may mean something else because of it.
    pub(crate) fn equips(&self) -> bool {
        self.definitions().any(|definition| {
            definition.model.is_some()
                || matches!(definition.namespace, Namespace::Model | Namespace::Vehicle)
        })
    }

    /// Every name that checks of this declaration look up; some more than once.
    pub(crate) fn symbols(&self) -> impl Iterator<Item = Symbol> + '_ {
        let defined = self.definitions().map(|definition| definition.name);
        let called = self.calls.iter().map(|call| call.name);
        let used = self.uses.iter().map(|used| used.name);
        let asked = self.literals.iter().map(|literal| literal.variable);
        let split = self.literals.iter().filter_map(|literal| literal.split).map(|(variable, _)| variable);
        let placed = self.literals.iter().filter_map(|literal| literal.vehicle).map(|vehicle| vehicle.name);
        let named = self.occurrences.iter().copied();
        defined.chain(named).chain(called).chain(used).chain(asked).chain(split).chain(placed)
    }
}
