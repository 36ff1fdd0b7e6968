//! What files of JMPL say, as trees.

/// Where something is written: the number of its file, and its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    pub(super) file: usize,
    pub(super) line: u32,
}

#[derive(Clone, Debug, Default)]
pub(super) struct File {
    pub(super) enums: Vec<Enum>,
    pub(super) classes: Vec<Class>,
}

/// `enum name { values } { relations }`.
#[derive(Clone, Debug)]
pub(super) struct Enum {
    pub(super) name: String,
    pub(super) values: Vec<String>,
    /// Values that are names of numbers.
    pub(super) numbers: Vec<(String, String)>,
    pub(super) relations: Vec<Relation>,
}

/// `class name extends parent { … }`.
#[derive(Clone, Debug)]
pub(super) struct Class {
    pub(super) name: String,
    pub(super) parent: Option<String>,
    pub(super) enums: Vec<Enum>,
    pub(super) attributes: Vec<Attribute>,
    /// The attributes of its state vector.
    pub(super) state: Vec<String>,
    pub(super) arcs: Vec<Arc>,
    pub(super) relations: Vec<Relation>,
    pub(super) statements: Vec<Statement>,
    pub(super) place: Place,
}

/// `type name;`.
#[derive(Clone, Debug)]
pub(super) struct Attribute {
    pub(super) name: String,
    pub(super) kind: String,
    pub(super) is_private: bool,
    pub(super) place: Place,
}

/// A transition or a failure.
#[derive(Clone, Debug)]
pub(super) struct Arc {
    pub(super) is_failure: bool,
    /// One for each variable of the state vector: a mode, `*`, `+` or `.`.
    pub(super) from: Vec<String>,
    pub(super) to: Vec<String>,
    /// A cost or a probability.
    pub(super) weight: Option<String>,
    pub(super) body: Vec<Statement>,
    pub(super) place: Place,
}

/// `relation name (type parameter) { … }`.
#[derive(Clone, Debug)]
pub(super) struct Relation {
    pub(super) name: String,
    pub(super) parameters: Vec<String>,
    pub(super) body: Vec<Statement>,
}

/// A statement with its place.
#[derive(Clone, Debug)]
pub(super) struct Statement {
    pub(super) kind: StatementKind,
    pub(super) place: Place,
}

/// The forms of a statement.
#[derive(Clone, Debug)]
pub(super) enum StatementKind {
    Group(Vec<Statement>),
    If { condition: Expression, then: Box<Statement>, otherwise: Option<Box<Statement>> },
    Iff { condition: Expression, body: Box<Statement> },
    Switch { on: Path, cases: Vec<Case> },
    Holds(Expression),
}

/// Values, and what holds if the attribute has one of them.
pub(super) type Case = (Vec<String>, Vec<Statement>);

/// Names joined by points.
pub(super) type Path = Vec<String>;

#[derive(Clone, Debug)]
pub(super) enum Expression {
    Any(Vec<Self>),
    All(Vec<Self>),
    Not(Box<Self>),
    Equal(Path, Path),
    Call(Path, Vec<Path>),
}
