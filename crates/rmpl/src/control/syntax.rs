//! The typed tree of control programs and of the model part (SPEC 2.1 and 2.2).

use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::span::Span;

/// A name or value as written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Name {
    pub text: SmolStr,
    /// Where it is written.
    pub span: Span,
}

/// Everything one text says.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ControlFile {
    /// The definitions in textual order; an expression without a name becomes one called `main`.
    pub definitions: Vec<Definition>,
    /// The component classes in textual order.
    pub classes: Vec<Class>,
    /// The components in textual order.
    pub instances: Vec<Instance>,
    /// The options in textual order.
    pub options: Vec<ProgramOption>,
}

impl ControlFile {
    /// The definition that runs: the last one without parameters.
    pub fn main(&self) -> Option<&Definition> {
        self.definitions.iter().rev().find(|definition| definition.parameters.is_empty())
    }
}

/// `(DEFOPTION name value)`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramOption {
    /// What it is called.
    pub name: Name,
    pub value: Name,
}

/// `NAME (parameters):: body`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Definition {
    /// What it is called.
    pub name: Name,
    pub parameters: Vec<Name>,
    pub body: Expression,
    /// Where it is written.
    pub span: Span,
}

/// An expression and where it is written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Expression {
    pub kind: ExpressionKind,
    /// Where it is written.
    pub span: Span,
}

/// The forms of an expression.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ExpressionKind {
    /// A constraint to make true.
    Assert(Constraint),
    Parallel(Vec<Expression>),
    /// One after the other.
    Sequence(Vec<Expression>),
    /// Started again at every step.
    Always(Box<Expression>),
    /// A choice by the current knowledge; without `otherwise` for `IF-THENNEXT`.
    IfThenNext {
        /// What is asked.
        guard: Guard,
        /// Done next if it holds.
        then: Box<Expression>,
        /// Done next if it does not hold.
        otherwise: Option<Box<Expression>>,
    },
    /// Done next unless the guard holds.
    UnlessThenNext {
        /// What is asked.
        guard: Guard,
        /// Done next if it does not hold.
        body: Box<Expression>,
    },
    /// Waits for the guard once.
    WhenDoNext {
        /// What is waited for.
        guard: Guard,
        body: Box<Expression>,
    },
    /// Starts the body after every step in which the guard holds.
    WheneverDoNext {
        /// What is waited for.
        guard: Guard,
        /// Done next each time.
        body: Box<Expression>,
    },
    /// Ends the body as soon as the guard holds.
    DoWatching {
        /// What is watched.
        guard: Guard,
        /// What is done meanwhile.
        body: Box<Expression>,
    },
    /// A call of a definition, or the use of a parameter when it has no parentheses.
    Call {
        /// What is called.
        name: Name,
        arguments: Vec<Argument>,
        /// Whether it is written without parentheses, as parameters are.
        bare: bool,
    },
    /// Something unreadable, for which a diagnostic was given.
    Unreadable,
}

/// An argument of a call.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Argument {
    /// A name, a value, or a parameter of the calling definition.
    Word(Name),
    /// A guard `~c`.
    Guard(Guard),
    /// An expression or constraint.
    Expression(Expression),
}

/// A condition on what is known.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Guard {
    /// Whether the guard asks for non-entailment (`~c`) rather than entailment.
    pub non_entailed: bool,
    /// What is asked about.
    pub constraint: Constraint,
    /// Where it is written.
    pub span: Span,
}

/// A constraint and where it is written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Constraint {
    pub kind: ConstraintKind,
    /// Where it is written.
    pub span: Span,
}

/// The forms of a constraint.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ConstraintKind {
    True,
    False,
    /// The variable has the value.
    Equals {
        variable: Name,
        value: Name,
    },
    /// The inner constraint is false.
    Not(Box<Constraint>),
    And(Vec<Constraint>),
    /// At least one holds.
    Or(Vec<Constraint>),
    /// A parameter that stands for a constraint.
    Parameter(Name),
    /// Something unreadable, for which a diagnostic was given.
    Unreadable,
}

/// `(DEFCLASS name (supers) fields)`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Class {
    /// What it is called.
    pub name: Name,
    /// The classes it extends, nearest first.
    pub supers: Vec<Name>,
    /// Its fields in textual order.
    pub fields: Vec<Field>,
    /// Where it is written.
    pub span: Span,
}

/// A field of a class and where it is written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Field {
    /// What it declares.
    pub kind: FieldKind,
    /// Where it is written.
    pub span: Span,
}

/// The fields of a class.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FieldKind {
    /// `(VAR name {values} [OBSERVABLE [SHOWS value]])`.
    Variable {
        /// What it is called.
        name: Name,
        values: Vec<Name>,
        /// Whether it is observed.
        observable: bool,
        /// What the simulated plant shows where the mode leaves it open.
        shows: Option<Name>,
    },
    /// `(COMMAND name {values})`, idle value first.
    Command {
        /// What it is called.
        name: Name,
        values: Vec<Name>,
    },
    /// `(PORT name class)`.
    Port {
        /// What it is called.
        name: Name,
        /// The class of what is connected there.
        class: Name,
    },
    /// `(MODE name constraint)`.
    Mode {
        /// What it is called.
        name: Name,
        /// What holds in it.
        constraint: Constraint,
    },
    /// `(TRANSITION from to guard)`.
    Transition {
        /// The mode that is left.
        from: Name,
        /// The mode that is entered.
        to: Name,
        /// What triggers it.
        guard: Constraint,
    },
    /// `(FAULT from to probability)`.
    Fault {
        /// The mode that is left.
        from: Name,
        /// The mode that is entered.
        to: Name,
        /// The probability per step as written: a decimal or a fraction.
        probability: Name,
    },
}

/// `(DEFINSTANCE name class (port component)… [INIT initial])`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Instance {
    /// What it is called.
    pub name: Name,
    pub class: Name,
    /// The components at its ports.
    pub ports: Vec<(Name, Name)>,
    /// The modes in which it may start.
    pub initial: Initial,
    /// Where it is written.
    pub span: Span,
}

/// The modes in which a component may start.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Initial {
    /// Not said: it starts in the first mode of its class.
    #[default]
    FirstMode,
    /// `INIT mode`: it starts in this one.
    Mode(Name),
    /// `INIT *`: all modes are equally likely.
    AnyMode,
    /// `INIT mode probability …`: modes with their probabilities as written.
    Prior(Vec<(Name, Name)>),
}

impl Initial {
    /// The modes that are named.
    pub fn modes(&self) -> impl Iterator<Item = &Name> {
        let (one, several) = match self {
            Self::FirstMode | Self::AnyMode => (None, &[][..]),
            Self::Mode(mode) => (Some(mode), &[][..]),
            Self::Prior(prior) => (None, prior.as_slice()),
        };
        one.into_iter().chain(several.iter().map(|(mode, _)| mode))
    }
}
