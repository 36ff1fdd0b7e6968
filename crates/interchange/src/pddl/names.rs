//! The names of actions in a mission, and the constants that they share.

/// The type of everything.
pub(super) const OBJECT: &str = "object";

/// The time between changes that must not happen at once. It exceeds the tolerance of VAL, the PDDL plan checker: 0.01.
pub const EPSILON: &str = "0.02";

/// Between the words of an action in its name.
pub(super) const BETWEEN_WORDS: &str = "__";

/// Before the name of a part of an action, such as `start`.
pub(super) const BEFORE_PART: &str = "___";

/// The part that represents an action that takes no time.
pub(super) const INSTANT: &str = "instant";

/// The part with the conditions that the start of the same action makes true.
pub(super) const BODY: &str = "body";

/// An action by the name that it has in a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedAction<'name> {
    /// The action and its objects.
    pub words: Vec<&'name str>,
    /// Whether it takes no time in PDDL.
    pub is_instant: bool,
}

/// The action that an activity of this name represents; `None` if the activity is only a part of an action.
pub fn named_action(activity: &str) -> Option<NamedAction<'_>> {
    let (name, part) =
        activity.rsplit_once(BEFORE_PART).map_or((activity, None), |(name, part)| (name, Some(part)));
    if part.is_some_and(|part| part != INSTANT) {
        return None;
    }
    let words = name.split(BETWEEN_WORDS).filter(|word| !word.is_empty()).collect();
    Some(NamedAction { words, is_instant: part.is_some() })
}

/// The name of the part of an action with the conditions that its own start makes true. The action itself is the activity
/// around this part.
pub fn body_of(action: &str) -> String {
    format!("{action}{BEFORE_PART}{BODY}")
}
