//! The typed tree of control programs and of the model part (SPEC 2.1 and 2.2).

use exact::Rational;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use super::duration::Duration;
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
    /// The methods of the components' classes, each as a definition for its component.
    pub methods: Vec<Definition>,
    /// The options in textual order.
    pub options: Vec<ProgramOption>,
    /// The lengths of a step that the text names, in textual order: one at most is right.
    pub steps: Vec<Name>,
    /// How many seconds a step of the mission takes that the text is in.
    pub mission_step_secs: Option<Rational>,
}

impl ControlFile {
    /// The definition that runs: the last one without parameters.
    pub fn main(&self) -> Option<&Definition> {
        self.definitions.iter().rev().find(|definition| definition.parameters.is_empty())
    }

    /// The length of a step in seconds, if the text declares it.
    pub fn own_step_secs(&self) -> Option<Rational> {
        Duration::read(&self.steps.first()?.text).ok()?.seconds()
    }

    /// Returns how many seconds a step takes: as the text says, otherwise as its mission does, otherwise one.
    pub fn step_secs(&self) -> Rational {
        self.own_step_secs().or(self.mission_step_secs).unwrap_or(Rational::ONE)
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
    /// Lets time pass.
    Wait(Name),
    /// Ends the body when its time is up.
    Timeout {
        duration: Name,
        body: Box<Expression>,
        /// Done next if the time is up.
        otherwise: Option<Box<Expression>>,
    },
    /// Gives the body at least one duration and at most another.
    Within {
        least: Name,
        most: Name,
        body: Box<Expression>,
        /// Done next if the time is up.
        otherwise: Option<Box<Expression>>,
    },
    /// Starts the body at a time of the program.
    At {
        time: Name,
        body: Box<Expression>,
    },
    /// Starts the body again and again.
    Every {
        period: Name,
        body: Box<Expression>,
    },
    /// Divides the durations of the body.
    Warp {
        factor: Name,
        body: Box<Expression>,
    },
    /// Does the body while nothing else contradicts a constraint.
    Lock {
        constraint: Constraint,
        body: Box<Expression>,
    },
    /// Starts one of several by a draw: their weights are probabilities.
    ChooseProb(Vec<Alternative>),
    /// Starts the one of several that promises most: their weights are rewards.
    ChooseReward(Vec<Alternative>),
    /// Counts a reward.
    Reward(Name),
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

impl Expression {
    /// The expressions that it directly consists of, in textual order; those that are handed to a definition too.
    pub fn parts(&self) -> Vec<&Self> {
        match &self.kind {
            ExpressionKind::Parallel(parts) | ExpressionKind::Sequence(parts) => parts.iter().collect(),
            ExpressionKind::IfThenNext { then, otherwise, .. } => {
                std::iter::once(&**then).chain(otherwise.as_deref()).collect()
            }
            ExpressionKind::Timeout { body, otherwise, .. }
            | ExpressionKind::Within { body, otherwise, .. } => {
                std::iter::once(&**body).chain(otherwise.as_deref()).collect()
            }
            ExpressionKind::Always(body)
            | ExpressionKind::UnlessThenNext { body, .. }
            | ExpressionKind::WhenDoNext { body, .. }
            | ExpressionKind::WheneverDoNext { body, .. }
            | ExpressionKind::DoWatching { body, .. }
            | ExpressionKind::At { body, .. }
            | ExpressionKind::Every { body, .. }
            | ExpressionKind::Warp { body, .. }
            | ExpressionKind::Lock { body, .. } => vec![body],
            ExpressionKind::ChooseProb(alternatives) | ExpressionKind::ChooseReward(alternatives) => {
                alternatives.iter().map(|alternative| &alternative.body).collect()
            }
            ExpressionKind::Call { arguments, .. } => {
                let expressions = arguments.iter().filter_map(|argument| match argument {
                    Argument::Expression(inner) => Some(inner),
                    Argument::Word(_) | Argument::Guard(_) => None,
                });
                expressions.collect()
            }
            ExpressionKind::Assert(_)
            | ExpressionKind::Wait(_)
            | ExpressionKind::Reward(_)
            | ExpressionKind::Unreadable => Vec::new(),
        }
    }

    /// Returns what it asks of the estimate itself.
    pub const fn guard(&self) -> Option<&Guard> {
        match &self.kind {
            ExpressionKind::IfThenNext { guard, .. }
            | ExpressionKind::UnlessThenNext { guard, .. }
            | ExpressionKind::WhenDoNext { guard, .. }
            | ExpressionKind::WheneverDoNext { guard, .. }
            | ExpressionKind::DoWatching { guard, .. } => Some(guard),
            _ => None,
        }
    }

    /// Returns what it asserts itself.
    pub const fn asserted(&self) -> Option<&Constraint> {
        match &self.kind {
            ExpressionKind::Assert(constraint) | ExpressionKind::Lock { constraint, .. } => Some(constraint),
            _ => None,
        }
    }

    /// The durations that it names itself.
    pub fn durations(&self) -> Vec<&Name> {
        let held = self.guard().and_then(|guard| guard.held.as_ref()).map(|held| &held.duration);
        let own = match &self.kind {
            ExpressionKind::Wait(duration)
            | ExpressionKind::Timeout { duration, .. }
            | ExpressionKind::At { time: duration, .. }
            | ExpressionKind::Every { period: duration, .. } => vec![duration],
            ExpressionKind::Within { least, most, .. } => vec![least, most],
            _ => Vec::new(),
        };
        held.into_iter().chain(own).collect()
    }
}

/// What CHOOSE-PROB and CHOOSE-REWARD choose from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Alternative {
    /// A probability or a reward, as written.
    pub weight: Name,
    pub body: Expression,
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
    /// With HELD: for how long the constraint has to have been satisfied.
    pub held: Option<Held>,
    /// What is asked about.
    pub constraint: Constraint,
    /// Where it is written.
    pub span: Span,
}

impl Guard {
    /// One for which a diagnostic was given.
    pub(super) const fn unreadable(span: Span) -> Self {
        let constraint = Constraint { kind: ConstraintKind::Unreadable, span };
        Self { non_entailed: false, held: None, constraint, span }
    }
}

/// What `(HELD d c)` says beside `c`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Held {
    pub duration: Name,
    /// Whether it is non-entailment that has to have lasted: `(HELD d ~c)`.
    pub non_entailed: bool,
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
    /// A parameter that represents a constraint.
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
    /// `(VAR name {values} [OBSERVABLE [SHOWS value] [ERROR probability]])`.
    Variable {
        /// What it is called.
        name: Name,
        values: Vec<Name>,
        /// Whether it is observed.
        observable: bool,
        /// What the simulated plant shows where the mode leaves it open.
        shows: Option<Name>,
        /// The probability that another value is observed, as written: a decimal or a fraction.
        error: Option<Name>,
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
    /// `(PART name class (port component)… [INIT initial])`.
    Part {
        /// What it is called.
        name: Name,
        class: Name,
        /// Its ports with what they are connected to, in the names of the class.
        ports: Vec<(Name, Name)>,
        /// The modes in which it may start.
        initial: Initial,
    },
    /// `(METHOD name (parameters) expression)`.
    Method {
        /// What it is called.
        name: Name,
        parameters: Vec<Name>,
        body: Expression,
    },
    /// `(BEHAVIOR expression)`.
    Behavior(Expression),
    /// `(MODE name constraint)`.
    Mode {
        /// What it is called.
        name: Name,
        /// What holds in it.
        constraint: Constraint,
    },
    /// `(TRANSITION from to guard [probability])`.
    Transition {
        /// The mode that is left; `None` for `*`: all but the one that is entered.
        from: Option<Name>,
        /// The mode that is entered.
        to: Name,
        /// What triggers it.
        guard: Constraint,
        /// Its probability as written, if it is one of several outcomes of the guard.
        probability: Option<Name>,
    },
    /// `(FAULT from to probability [guard])`.
    Fault {
        /// The mode that is left; `None` for `*`: all but the one that is entered.
        from: Option<Name>,
        /// The mode that is entered.
        to: Name,
        /// The probability per step as written: a decimal or a fraction.
        probability: Name,
        /// What makes it possible, where it is not always possible.
        guard: Option<Constraint>,
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
