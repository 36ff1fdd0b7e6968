//! What a screen reader announces: the status of the plan, errors, steps, how answers were judged, messages.

use rmpl::Severity;

use crate::state::AppState;
use crate::state::search::wording::event;
use crate::state::snapshots::Status;

/// Returns what is to be said now. It is said when it is other than before; empty while there is nothing new to say.
pub fn announcement(state: &AppState) -> String {
    let words = [plan_words, step_words, program_words, lesson_words, message_words];
    let parts: Vec<String> = words.into_iter().filter_map(|tell| tell(state)).collect();
    parts.join(" ")
}

fn plan_words(state: &AppState) -> Option<String> {
    let problems = state.snapshots.problems();
    let first = || problems.iter().find(|problem| problem.severity == Severity::Error);
    let latest = state.snapshots.latest();
    let verdict = latest.and_then(|latest| latest.planning.as_ref()?.verdict.as_ref());
    Some(match state.status() {
        // Said when it takes long, not with every key.
        Status::Working if state.is_long_at_work() => "Planning.".to_owned(),
        Status::Working | Status::Empty | Status::Program => return None,
        Status::Broken => {
            let count = problems.iter().filter(|it| it.severity == Severity::Error).count();
            let noun = if count == 1 { "error" } else { "errors" };
            // As the list of problems has it: of its own file.
            let place = first().map_or_else(String::new, |problem| {
                let line = match &problem.file {
                    Some(file) => format!("{file}, line {}", problem.line),
                    None => format!("Line {}", problem.line),
                };
                format!("{line}: {}", problem.message.replace('`', ""))
            });
            format!("{count} {noun}. {place}.")
        }
        Status::NoPlan => first()
            .map_or_else(|| "No plan.".to_owned(), |it| format!("No plan. {}.", it.message.replace('`', ""))),
        Status::Undecided => "No result: planning was stopped.".to_owned(),
        Status::Plan if state.is_improving() => "Plan found. Searching for a better one.".to_owned(),
        Status::Plan => match verdict.map(|verdict| verdict.valid) {
            Some(true) => "Plan found and verified.".to_owned(),
            Some(false) => "The independent checker rejected the plan.".to_owned(),
            None => "Plan found.".to_owned(),
        },
    })
}

fn step_words(state: &AppState) -> Option<String> {
    let view = state.search.shown()?;
    let trace = view.recording.trace();
    let entry = trace.events.get(view.step.step)?;
    let words = event(view.recording.network(), trace, &entry.event);
    Some(format!("Step {} of {}: {words}", view.step.step + 1, trace.events.len()))
}

fn program_words(state: &AppState) -> Option<String> {
    let at = state.automaton.at();
    (state.automaton.is_control() && at > 0).then(|| format!("Step {at} of the program."))
}

/// Returns how the last answer was judged; before one is given, which step of the lesson is open.
fn lesson_words(state: &AppState) -> Option<String> {
    let (open, stop) = (state.lesson.open()?, state.lesson.stop()?);
    let place =
        || format!("{}, step {} of {}: {}.", open.title, state.lesson.at() + 1, open.stops.len(), stop.title);
    Some(state.lesson.verdict().unwrap_or_else(place))
}

fn message_words(state: &AppState) -> Option<String> {
    state.window.toasts.shown().last().map(|toast| toast.text.clone())
}
