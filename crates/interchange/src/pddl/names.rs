//! The names that actions have in a mission, and what is the same for all of them.

/// The type of everything.
pub(super) const OBJECT: &str = "object";

/// How far apart things are that may not happen at once: more than the tolerance of 0.01 that VAL takes.
pub const EPSILON: &str = "0.02";

/// Between the words of an action in its name.
pub(super) const BETWEEN_WORDS: &str = "__";

/// Before what an activity is of an action.
pub(super) const BEFORE_PART: &str = "___";

/// What the activity of an action that takes no time is called, behind its name.
pub(super) const INSTANT: &str = "instant";

/// What the conditions of an action are called that its own start makes true.
pub(super) const BODY: &str = "body";

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
    if part.is_some_and(|part| part != INSTANT) {
        return None;
    }
    let words = name.split(BETWEEN_WORDS).filter(|word| !word.is_empty()).collect();
    Some(NamedAction { words, is_instant: part.is_some() })
}

/// The name of the part of an action that holds its conditions where they rest on its own start: the action is the activity
/// around it.
pub fn body_of(action: &str) -> String {
    format!("{action}{BEFORE_PART}{BODY}")
}
