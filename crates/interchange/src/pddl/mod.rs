//! PDDL 2.1: a domain with a problem as a mission, and actions by the names that they have in it.
//!
//! RMPL plans activities that a mission names. So the mission names every action on objects that can happen and may help,
//! each of them optional, and asks for the goal at its end: every plan of the mission is a plan of the problem. What PDDL
//! calls simultaneous is a matter of [`EPSILON`]: a change takes that long in the mission, and what needs or changes the
//! same thing stays out of that time, as the rules on mutual exclusion demand (Fox and Long 2003, definitions 12 and 13).

mod domain;
mod error;
mod ground;
mod groups;
mod mission;
mod names;
mod numbers;
mod tree;

pub use error::PddlError;
pub use mission::{MAX_TIMES, Translation};
pub use names::{EPSILON, NamedAction, body_of, named_action};

/// Returns whether a text is PDDL: it begins with `(define`.
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

#[cfg(test)]
mod tests;
