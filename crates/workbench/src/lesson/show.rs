//! What a stop shows: the `show` block of a lesson.

use serde_json::Value;

use super::{LessonError, entries};
use crate::mission_file;
use crate::panel_kind::PanelKind;
use crate::state::growth::Planners;
use crate::workspace::Workspace;
use kirk::Event;

/// What a stop shows. What it does not name is as it is at first: no step, nothing selected, everything in view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Show {
    /// The panels beside the lesson: rows of columns of tabs. Without any, those of the stop before stay.
    pub panels: Vec<Vec<Vec<PanelKind>>>,
    /// The workspace in which it happens.
    pub workspace: Option<Workspace>,
    /// The search that is turned to, if both are shown: 0 is the chronological one.
    pub side: usize,
    /// The step of the search, with the line that names it.
    pub step: Option<(u32, StepTarget)>,
    /// What is selected, by name, with the line.
    pub select: Option<(u32, String)>,
    /// The panels that show what is selected from near; the others show everything.
    pub near: Vec<PanelKind>,
    /// The time shown, in mission units.
    pub time: Option<f64>,
    /// How many steps the control program has taken.
    pub moments: Option<usize>,
    /// How many samples of the path's search are drawn.
    pub samples: Option<u32>,
    /// Whose searches for a path are shown; without it, that of the one that planned.
    pub planner: Option<Planners>,
    /// The mission from this stop on.
    pub mission: Option<&'static str>,
    /// Commands that are run after all that, by name and with arguments.
    pub commands: Vec<(u32, String, Value)>,
}

/// A step of the search.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepTarget {
    /// By number, from 1.
    Number(usize),
    End,
    /// By what happens in it.
    Kind {
        which: Which,
        kind: StepKind,
        /// Words of the sentence that says what happens; any if empty.
        with: String,
    },
}

impl StepTarget {
    /// `12`, `end`, `first failure`, `2nd threat`, `last backtrack with D1`; what is wrong with it otherwise.
    pub fn read(value: &str) -> Result<Self, String> {
        step(value)
    }
}

/// Which of several steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// From 1.
    Nth(usize),
    Last,
}

/// Kinds of steps of a search, as lessons call them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepKind {
    Decision,
    Expansion,
    Arc,
    Propagation,
    NegativeCycle,
    Failure,
    Link,
    Threat,
    Order,
    Backtrack,
    Jump,
    Lesson,
    Consequence,
    Bound,
    Visit,
    Plan,
}

impl StepKind {
    /// All of them, with the words for them.
    pub const ALL: [(&'static str, Self); 16] = [
        ("decision", Self::Decision),
        ("expansion", Self::Expansion),
        ("arc", Self::Arc),
        ("propagation", Self::Propagation),
        ("negative cycle", Self::NegativeCycle),
        ("failure", Self::Failure),
        ("link", Self::Link),
        ("threat", Self::Threat),
        ("order", Self::Order),
        ("backtrack", Self::Backtrack),
        ("jump", Self::Jump),
        ("lesson", Self::Lesson),
        ("consequence", Self::Consequence),
        ("bound", Self::Bound),
        ("visit", Self::Visit),
        ("plan", Self::Plan),
    ];

    /// Returns whether an event is of this kind.
    pub fn is(self, event: &Event) -> bool {
        match self {
            Self::Decision => matches!(event, Event::Decide { .. }),
            Self::Expansion => matches!(event, Event::Expand { .. }),
            Self::Arc => matches!(event, Event::AddArc { .. }),
            Self::Propagation => matches!(event, Event::Propagate { .. }),
            Self::NegativeCycle => matches!(event, Event::Inconsistent { .. }),
            Self::Failure => crate::state::search::focus::is_failure(event),
            Self::Link => matches!(event, Event::TryLink { .. }),
            Self::Threat => {
                matches!(event, Event::Threat { .. } | Event::Overload { .. } | Event::OutOfRange { .. })
            }
            Self::Order => {
                matches!(event, Event::TryOrder { .. } | Event::TryUseOrder { .. } | Event::TryStart { .. })
            }
            Self::Backtrack => {
                matches!(event, Event::Backtrack { .. } | Event::Backjump { .. } | Event::Restart)
            }
            Self::Jump => matches!(event, Event::Backjump { .. }),
            Self::Lesson => matches!(event, Event::Learn { .. }),
            Self::Consequence => matches!(event, Event::Imply { .. }),
            Self::Bound => matches!(event, Event::Bound { .. }),
            Self::Visit => matches!(event, Event::Visit { .. }),
            Self::Plan => matches!(event, Event::Solution { .. } | Event::Improve { .. }),
        }
    }
}

/// Reads a `show` block whose fence is in line `fence`.
pub(super) fn read(text: &str, fence: u32, errors: &mut Vec<LessonError>) -> Show {
    let mut show = Show::default();
    let mut others = Vec::new();
    let entries = entries(text, fence, |line, text| others.push((line, text)));
    for (line, text) in others {
        errors.push(LessonError::new(
            line,
            format!("expected a line of the form `key: value`, found `{text}`"),
        ));
    }
    for (line, key, value) in entries {
        if let Err(message) = take(&mut show, line, key, &value) {
            errors.push(LessonError::new(line, message));
        }
    }
    show
}

fn take(show: &mut Show, line: u32, key: &str, value: &str) -> Result<(), String> {
    match key {
        "panels" => show.panels = panels(value)?,
        "workspace" => {
            let workspace = Workspace::by_name(value).ok_or_else(|| {
                format!(
                    "unknown workspace `{value}`; use one of {}",
                    Workspace::ALL.map(Workspace::name).join(", ")
                )
            })?;
            show.workspace = Some(workspace);
        }
        "search" => {
            show.side = match value {
                "chronological" => 0,
                "conflict-directed" => 1,
                _ => return Err("`search` must be `chronological` or `conflict-directed`".to_owned()),
            };
        }
        "step" => show.step = Some((line, step(value)?)),
        "select" => show.select = Some((line, value.to_owned())),
        "near" => {
            show.near = value.split(',').map(panel).collect::<Result<_, _>>()?;
            if let Some(other) = show.near.iter().find(|panel| !panel.is_zoomable()) {
                return Err(format!("the panel `{}` cannot be zoomed", other.name()));
            }
        }
        "time" => {
            let time: exact::Time = value.parse().map_err(|_| format!("`{value}` is not a time"))?;
            show.time = Some(time.to_f64());
        }
        "moments" => show.moments = Some(count(value)?),
        "samples" => show.samples = Some(count(value)? as u32),
        "planner" => {
            let planners = Planners::named(value);
            show.planner = Some(planners.ok_or_else(|| format!("unknown path planner `{value}`"))?);
        }
        "mission" => {
            let example = mission_file::example(value).ok_or_else(|| format!("unknown example `{value}`"))?;
            show.mission = Some(example.name);
        }
        "do" => {
            let (id, arguments) = command_of(value)?;
            show.commands.push((line, id, arguments));
        }
        other => {
            return Err(format!(
                "unknown key `{other}` in `show`; use panels, workspace, mission, search, step, select, near, time, moments, \
                 samples, planner or do"
            ));
        }
    }
    Ok(())
}

fn count(value: &str) -> Result<usize, String> {
    value.parse().map_err(|_| format!("`{value}` is not a count"))
}

fn panel(name: &str) -> Result<PanelKind, String> {
    let name = name.trim();
    PanelKind::by_name(name).ok_or_else(|| {
        let known = PanelKind::ALL.map(PanelKind::name).join(", ");
        format!("unknown panel `{name}`; use one of {known}")
    })
}

/// `network / search | editor, timeline`: rows, in each of them columns, in each of them tabs.
fn panels(value: &str) -> Result<Vec<Vec<Vec<PanelKind>>>, String> {
    let column = |column: &str| column.split(',').map(panel).collect::<Result<Vec<_>, _>>();
    let row = |row: &str| row.split('|').map(column).collect::<Result<Vec<_>, _>>();
    let rows = value.split('/').map(row).collect::<Result<Vec<_>, _>>()?;
    let all: Vec<PanelKind> = rows.iter().flatten().flatten().copied().collect();
    for (at, panel) in all.iter().enumerate() {
        if all[..at].contains(panel) {
            return Err(format!("the panel `{}` is listed twice", panel.name()));
        }
    }
    Ok(rows)
}

/// `12`, `end`, `first failure`, `2nd threat`, `last backtrack with D1`.
fn step(value: &str) -> Result<StepTarget, String> {
    if value == "end" {
        return Ok(StepTarget::End);
    }
    if let Ok(number) = value.parse() {
        return Ok(StepTarget::Number(number));
    }
    let (value, with) = value.split_once(" with ").unwrap_or((value, ""));
    let (which, kind) = value.split_once(' ').unwrap_or(("first", value));
    let nth = || {
        let digits = which.trim_end_matches(|letter: char| letter.is_ascii_lowercase());
        digits.parse().ok().filter(|&nth| nth > 0 && digits.len() < which.len())
    };
    let which = match which {
        "first" => Which::Nth(1),
        "second" => Which::Nth(2),
        "third" => Which::Nth(3),
        "last" => Which::Last,
        _ => Which::Nth(
            nth().ok_or_else(|| format!("expected first, second, third, 4th, … or last, found `{which}`"))?,
        ),
    };
    let found = StepKind::ALL.into_iter().find(|(name, _)| *name == kind.trim());
    let (_, kind) = found.ok_or_else(|| {
        let known: Vec<&str> = StepKind::ALL.iter().map(|(name, _)| *name).collect();
        format!("unknown kind of step `{kind}`; use one of {}", known.join(", "))
    })?;
    Ok(StepTarget::Kind { which, kind, with: with.trim().to_owned() })
}

/// `view.panel {"name": "distances"}`: a command's name, and its arguments if it has any.
pub(super) fn command_of(value: &str) -> Result<(String, Value), String> {
    let (id, arguments) = value.split_once(' ').unwrap_or((value, "{}"));
    let arguments =
        serde_json::from_str(arguments).map_err(|error| format!("`{arguments}` is not JSON: {error}"))?;
    Ok((id.to_owned(), arguments))
}
