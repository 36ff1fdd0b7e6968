//! PDDL 2.1: a domain with a problem as a mission, and actions by the names that they have in it.
//!
//! RMPL plans activities that a mission names. So the mission names every action on objects that can happen and may help,
//! each of them optional, and asks for the goal at its end: every plan of the mission is a plan of the problem. What PDDL
//! calls simultaneous is a matter of [`EPSILON`]: a change takes that long in the mission, and what needs or changes the
//! same thing stays out of that time, as the rules on mutual exclusion demand (Fox and Long 2003, definitions 12 and 13).

mod domain;
mod ground;
mod groups;
mod mission;
mod numbers;
mod tree;

pub use mission::{MAX_TIMES, Translation};

/// The type of everything.
const OBJECT: &str = "object";

/// How far apart things are that may not happen at once: more than the tolerance of 0.01 that VAL takes.
pub const EPSILON: &str = "0.02";

/// Between the words of an action in its name.
const BETWEEN_WORDS: &str = "__";

/// Before what an activity is of an action.
const BEFORE_PART: &str = "___";

/// Why a domain and a problem are no mission.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PddlError {
    /// It is not PDDL, or not well formed.
    #[error("{file}, line {line}: {what}")]
    Shape { file: String, line: u32, what: String },
    /// It is PDDL that no mission can say.
    #[error("{file}, line {line}: {what} is not supported")]
    Unsupported { file: String, line: u32, what: String },
    /// The same, of an action on objects or of the goal.
    #[error("{place}: {what} is not supported")]
    Said { place: String, what: &'static str },
    #[error("{place} speaks of `{name}`, which is not an object; declare it in :objects or :constants")]
    Unknown { place: String, name: String },
    #[error("`{name}` is not a name in RMPL; rename it: letters, digits, and single `-` and `_` inside")]
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

/// Whether a text is PDDL: it begins with `(define`.
pub fn is_pddl(text: &str) -> bool {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows = text.lines().map(|row| row.split(';').next().unwrap_or_default().trim());
    let first = rows.find(|row| !row.is_empty()).unwrap_or_default();
    let inside = first.strip_prefix('(').map(str::trim_start).unwrap_or_default().to_ascii_lowercase();
    inside.strip_prefix("define").is_some_and(|rest| rest.is_empty() || rest.starts_with([' ', '\t', '(']))
}

/// How a problem becomes a mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// How often each action may happen, at most [`MAX_TIMES`].
    pub times: u32,
    /// Whether the mission has the metric as its objective. Without one, any plan is as good as another, and found sooner.
    pub has_metric: bool,
}

/// A problem of a domain as a mission. Each file is given with its name.
pub fn translate(
    domain: (&str, &str),
    problem: (&str, &str),
    settings: Settings,
) -> Result<Translation, PddlError> {
    let mut task = domain::read(domain, problem)?;
    if !settings.has_metric {
        task.metric = None;
    }
    let ground = ground::ground(&task)?;
    mission::write(&task, ground, settings.times)
}

/// An action by the name that it has in a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedAction<'name> {
    /// The action and its objects.
    pub words: Vec<&'name str>,
    /// Whether it takes no time in PDDL.
    pub is_instant: bool,
}

/// The action that an activity of this name is; `None` where the activity is only a part of one.
pub fn named_action(activity: &str) -> Option<NamedAction<'_>> {
    let (name, part) =
        activity.rsplit_once(BEFORE_PART).map_or((activity, None), |(name, part)| (name, Some(part)));
    if part.is_some_and(|part| part != mission::INSTANT) {
        return None;
    }
    let words = name.split(BETWEEN_WORDS).filter(|word| !word.is_empty()).collect();
    Some(NamedAction { words, is_instant: part.is_some() })
}

/// The name of the part of an action that holds its conditions where they rest on its own start: the action is the activity
/// around it.
pub fn body_of(action: &str) -> String {
    format!("{action}{BEFORE_PART}{}", mission::BODY)
}

#[cfg(test)]
mod tests;
