//! When commands can be used, and what they wait for otherwise.

use crate::panel_kind::PanelKind;
use crate::registry::spec::Availability;
use crate::state::AppState;
use crate::state::automaton::Program;
use crate::state::search::recorded;
use crate::state::snapshots::Status;

/// Whether the planning core works on something.
pub(super) fn while_working(state: &AppState) -> Availability {
    let is_working = state.status() == Status::Working
        || state.is_improving()
        || state.review.is_running()
        || state.chance.is_running()
        || state.contradict.progress().is_some()
        || state.rule_proof.progress().is_some()
        || state.execution.is_working()
        || state.automaton.chance.is_running();
    if is_working { Ok(()) } else { Err("no planning in progress") }
}

/// Whether the caret is in a file beside the main text.
pub(super) fn with_file_at_caret(state: &AppState) -> Availability {
    if state.file_at_caret() > 0 { Ok(()) } else { Err("the cursor is in the main file") }
}

/// Whether activities can be drawn: in a mission, in a panel that draws them.
pub(super) fn with_activities(state: &AppState) -> Availability {
    let is_drawing = matches!(state.window.active_panel, PanelKind::Network | PanelKind::Timeline);
    match state.language.parse() {
        None => Err("control programs cannot be drawn"),
        Some(_) if !is_drawing => Err("click the network or the timeline first"),
        Some(_) => Ok(()),
    }
}

/// Whether an activity is selected that can be changed in a drawing.
pub(super) fn with_statement(state: &AppState) -> Availability {
    with_activities(state)?;
    if state.drawn_statement().is_some() { Ok(()) } else { Err("select an activity first") }
}

pub(super) fn with_network(state: &AppState) -> Availability {
    let has_network = state.shown().is_some_and(|shown| shown.network.is_some());
    if has_network { Ok(()) } else { Err("no network") }
}

pub(super) fn with_plan(state: &AppState) -> Availability {
    let has_plan = state.shown().is_some_and(|shown| shown.plan().is_some());
    if has_plan { Ok(()) } else { Err("no plan") }
}

/// Whether the present text has been reviewed, and has a plan.
pub(super) fn with_review(state: &AppState) -> Availability {
    with_plan(state)?;
    if state.review.current().is_some() { Ok(()) } else { Err("review the current text first") }
}

/// Whether the present text has been reviewed, has a plan, and has rules in its own language.
pub(super) fn with_rules(state: &AppState) -> Availability {
    with_review(state)?;
    let has_rules = !state.review.record().rules().rules.is_empty();
    if has_rules { Ok(()) } else { Err("add a rule in the mission's language first") }
}

/// Whether flight rules are being proven.
pub(super) fn with_rule_proof(state: &AppState) -> Availability {
    if state.rule_proof.progress().is_some() { Ok(()) } else { Err("no proof in progress") }
}

/// Whether counterexamples are being looked for.
pub(super) fn with_trial(state: &AppState) -> Availability {
    if state.contradict.progress().is_some() {
        Ok(())
    } else {
        Err("no search for counterexamples is in progress")
    }
}

pub(super) fn with_program(state: &AppState) -> Availability {
    if state.automaton.moment().is_some() { Ok(()) } else { Err("no control program") }
}

/// Whether there is something that chance can go wrong with: a plan, or a control program with its plant.
pub(super) fn with_chance(state: &AppState) -> Availability {
    if matches!(state.automaton.program(), Some(Program::Bound { .. })) { Ok(()) } else { with_plan(state) }
}

/// Whether there is something to step through: a plan, a recorded search, or a control program.
pub(super) fn with_steps(state: &AppState) -> Availability {
    if with_search(state).is_ok() || state.automaton.program().is_some() { Ok(()) } else { with_plan(state) }
}

pub(super) fn with_search(state: &AppState) -> Availability {
    let is_compared = state.search.recordings(state.shown()).len() > 1;
    let is_recorded = state.shown().is_some_and(|shown| recorded(shown).is_some());
    if is_recorded || is_compared { Ok(()) } else { Err("no search is recorded") }
}

pub(super) fn with_step(state: &AppState) -> Availability {
    if state.search.step().is_some() { Ok(()) } else { Err("no step of the search is shown") }
}

pub(super) fn with_comparison(state: &AppState) -> Availability {
    let is_compared = state.search.recordings(state.shown()).len() > 1;
    if is_compared { Ok(()) } else { Err("no comparison of searches is open") }
}

pub(super) fn with_lesson(state: &AppState) -> Availability {
    if state.lesson.open().is_some() { Ok(()) } else { Err("no lesson is open") }
}

pub(super) fn with_question(state: &AppState) -> Availability {
    let asks = state.lesson.stop().is_some_and(|stop| stop.ask.is_some());
    if asks { Ok(()) } else { Err("this step has no question") }
}

/// Whether the stop has a task that can be shown.
pub(super) fn with_solution(state: &AppState) -> Availability {
    let ask = state.lesson.stop().and_then(|stop| stop.ask.as_ref());
    if ask.is_some_and(|ask| !ask.solution.is_empty()) { Ok(()) } else { Err("this step has no task") }
}

pub(super) fn with_run(state: &AppState) -> Availability {
    if state.is_executing() { Ok(()) } else { Err("no run is in progress") }
}

pub(super) fn with_selection(state: &AppState) -> Availability {
    if state.selection.is_none() { Err("no selection") } else { Ok(()) }
}

/// Somewhere to fly to: what is selected, or what the last sample of a growing tree did.
pub(super) fn with_goal_of_flight(state: &AppState) -> Availability {
    if state.terrain.growth.last_sample().is_some() { Ok(()) } else { with_selection(state) }
}

pub(super) fn with_ground(state: &AppState) -> Availability {
    let has_ground = state.shown().is_some_and(|shown| shown.map.is_some());
    if has_ground { Ok(()) } else { Err("the mission has no places") }
}

pub(super) fn with_paths(state: &AppState) -> Availability {
    let has_paths = state.shown().is_some_and(|shown| !shown.traverses.is_empty());
    if has_paths { Ok(()) } else { Err("the plan has no traverse with a path") }
}

pub(super) fn with_vehicles(state: &AppState) -> Availability {
    let has_vehicles = state.shown().is_some_and(|shown| !shown.program.world.vehicles.is_empty());
    if has_vehicles { Ok(()) } else { Err("the mission has no vehicles") }
}

pub(super) fn with_motion(state: &AppState) -> Availability {
    let has_motion = state.shown().is_some_and(|shown| !shown.motions.is_empty());
    if has_motion { Ok(()) } else { Err("the plan moves no vehicle") }
}

pub(super) fn with_natures_choice(state: &AppState) -> Availability {
    let chosen = state.shown().and_then(|shown| {
        let (network, plan) = (shown.network.as_deref()?, shown.plan()?);
        Some(plan.has_natures_choice(network))
    });
    match chosen {
        Some(true) => Ok(()),
        Some(false) => Err("this plan has no uncontrolled durations"),
        None => Err("no plan"),
    }
}

pub(super) fn with_pins(state: &AppState) -> Availability {
    if state.pins.is_empty() { Err("no event is pinned and no run has started") } else { Ok(()) }
}

pub(super) fn with_undo(state: &AppState) -> Availability {
    if state.document.can_undo() { Ok(()) } else { Err("nothing to undo") }
}

pub(super) fn with_redo(state: &AppState) -> Availability {
    if state.document.can_redo() { Ok(()) } else { Err("nothing to redo") }
}

pub(super) fn with_deleted(state: &AppState) -> Availability {
    if state.library.deleted().is_empty() { Err("no deleted mission") } else { Ok(()) }
}

/// Whether the open mission is one of the library: originals cannot be deleted.
pub(super) fn with_own_mission(state: &AppState) -> Availability {
    if state.library.open_id().is_some() { Ok(()) } else { Err("examples can't be deleted") }
}

pub(super) fn with_problems(state: &AppState) -> Availability {
    let has_problems = !state.snapshots.problems().is_empty();
    if has_problems { Ok(()) } else { Err("no problems") }
}

/// Whether a mission is open that can be reviewed, planned or not.
pub(super) fn with_mission(state: &AppState) -> Availability {
    let is_reviewed = state.automaton.program().is_none() && state.snapshots.latest().is_some();
    if is_reviewed { Ok(()) } else { Err("no mission to review") }
}

pub(super) fn with_approval(state: &AppState) -> Availability {
    let is_approved = state.review.record().last_approval().is_some();
    if is_approved { Ok(()) } else { Err("this mission has no approval yet") }
}

pub(super) fn with_record(state: &AppState) -> Availability {
    if state.review.record().is_empty() { Err("the review history is empty") } else { Ok(()) }
}
