//! Why a problem cannot become a mission.

/// Why a domain and a problem cannot become a mission.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PddlError {
    /// The file is not PDDL, or not well formed.
    #[error("{file}, line {line}: {what}")]
    Shape { file: String, line: u32, what: String },
    /// The file is PDDL that RMPL cannot express.
    #[error("{file}, line {line}: {what} is not supported")]
    Unsupported { file: String, line: u32, what: String },
    /// RMPL cannot express a part of an action on objects, of the goal or of the metric.
    #[error("{place}: {what} is not supported")]
    Said { place: String, what: &'static str },
    #[error("{place} mentions `{name}`, which is not an object; declare it in :objects or :constants")]
    Unknown { place: String, name: String },
    #[error(
        "`{name}` is not a name in RMPL; rename it with letters, digits, and single `-` or `_` between them"
    )]
    Name { name: String },
    #[error("the problem belongs to the domain `{wanted}`, but the domain is called `{found}`")]
    OtherDomain { wanted: String, found: String },
    #[error("the problem has no :goal")]
    NoGoal,
    #[error("the goal can never be true")]
    NeverTrue,
    #[error("there are more than {most} {what}; use a smaller problem")]
    TooMany { what: &'static str, most: usize },
    #[error("a number is too large to represent exactly")]
    Number,
}
