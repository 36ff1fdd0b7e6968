//! The checklist of a snapshot.

use std::collections::BTreeSet;

use rmpl::diagnostics::exogenous;
use rmpl::files::Files;
use rmpl::program::{Controllability, Measure, TimeUnit};
use rmpl::{LineIndex, Severity, Span};
use snapshot::Goal;
use snapshot::{Planning, Snapshot, Stage};
use tpn::{ArcKind, Network, NodeId, OccurrenceId};

use super::demand_lines::status_by_checker;
use super::late_drives::late_drives;
use super::place::{ASSUMES, find_places};
use super::plan_lines::{CLOSED, LATE, PlanLines, short_of_its_goal_m};
use super::{FlightRules, Line, Review, Status, content_hash, plan_hash};

/// Reviews a snapshot, by the usual flight rules; `goal` and `seed` are those it was planned with. When `stop` returns `true`,
/// the alternatives that have not been looked at yet are left as [`super::Fate::NotExamined`].
///
/// Alternatives that the plan does not take are planned again each, so this takes as long as planning does, times
/// the number of alternatives; it is meant to be asked for, not to follow every edit.
pub fn review(snapshot: &Snapshot, goal: &Goal, seed: u64, stop: &mut dyn FnMut() -> bool) -> Review {
    let places = Places::new(&snapshot.source);
    let late = match (&snapshot.network, snapshot.plan()) {
        (Some(network), Some(plan)) => late_drives(snapshot, network, plan),
        _ => BTreeSet::new(),
    };
    let mut lines = PlanLines::new(snapshot, &late, &places);
    let scattered = lines.as_ref().map(PlanLines::scattered_formations).unwrap_or_default();
    let unsure = Unsure { late: &late, sets_out: scattered.is_empty() };
    let mut review = Review {
        content_hash: content_hash(&snapshot.source, snapshot.map.as_ref(), goal, seed),
        plan_hash: plan_hash(snapshot),
        rules: FlightRules::default(),
        unit: unit(snapshot).to_owned(),
        status: Status::Passed,
        plan: plan_section(snapshot, unsure, &places),
        choices: Vec::new(),
        causal_links: Vec::new(),
        conflicts: Vec::new(),
        states: Vec::new(),
        resources: Vec::new(),
        overlaps: Vec::new(),
        durations: Vec::new(),
        events: Vec::new(),
        traverses: Vec::new(),
        separation_violations: separation_violations(snapshot, &places),
        runs_programs: snapshot.program.primitives.iter().any(|primitive| primitive.runs.is_some()),
        robustness: None,
        runs: None,
        findings: Vec::new(),
        mission_rules: Vec::new(),
        warnings: warnings(snapshot, &places),
    };
    if let Some(lines) = &mut lines {
        review.choices = lines.choices(stop);
        review.causal_links = lines.causal_links();
        review.conflicts = lines.conflicts();
        review.states = lines.demands().states();
        review.states.extend(lines.short_of_their_goals());
        review.separation_violations.extend(scattered);
        review.resources = lines.demands().resources();
        review.overlaps = lines.overlaps();
        review.durations = lines.durations();
        review.events = lines.events();
        review.traverses = lines.traverses();
    }
    find_places(&mut review, snapshot);
    if let Some(network) = &snapshot.network {
        name_calls(&mut review, network);
    }
    review.judge(&FlightRules::default(), None);
    review
}

/// Writes what people read for calls, with their arguments. The names that files have stay identifiers.
fn name_calls(review: &mut Review, network: &Network) {
    for line in review.every_line() {
        line.text = network.readable(&line.text);
    }
    for alternative in review.choices.iter_mut().flat_map(|choice| &mut choice.alternatives) {
        alternative.name_calls(network);
    }
}

impl Review {
    /// A copy to read: the names of its intervals, events and traverses have calls with their arguments, too.
    pub fn readable(&self, network: &Network) -> Self {
        let mut review = self.clone();
        let links = review.causal_links.iter_mut().flat_map(|it| [&mut it.ask, &mut it.tell]);
        let conflicts = review.conflicts.iter_mut().flat_map(|it| [&mut it.first, &mut it.then]);
        let events = review.events.iter_mut().map(|it| &mut it.name);
        let traverses = review.traverses.iter_mut().map(|it| &mut it.name);
        for name in links.chain(conflicts).chain(events).chain(traverses) {
            *name = network.readable(name);
        }
        review
    }
}

/// Returns what a mission counts time in.
pub(super) fn unit(snapshot: &Snapshot) -> &'static str {
    match snapshot.program.options.time_unit {
        TimeUnit::Minute => "min",
        TimeUnit::Second => "s",
    }
}

/// Makes lines that know where in the text they lead.
pub(super) struct Places<'source> {
    source: &'source str,
    index: LineIndex,
    files: Files,
}

impl<'source> Places<'source> {
    fn new(source: &'source str) -> Self {
        Self { source, index: LineIndex::new(source), files: Files::of(source) }
    }

    pub(super) fn line(
        &self,
        status: Status,
        text: String,
        span: Option<Span>,
        names: Vec<String>,
        nodes: Vec<NodeId>,
    ) -> Line {
        let line_number = span.map(|span| self.files.line_column(self.source, &self.index, span.start).line);
        Line { span, line_number, names, nodes, ..Line::new(status, text) }
    }

    fn plain(&self, status: Status, text: impl Into<String>) -> Line {
        self.line(status, text.into(), None, Vec::new(), Vec::new())
    }
}

/// The line of a mission that has a plan.
pub(crate) const PLAN: &str = "there is a plan";

/// The line of a plan that the checker finds valid.
pub(crate) const ACCEPTED: &str = "the independent checker accepts the plan";

/// How the lines of a plan that the checker finds invalid begin.
pub(crate) const REJECTED: &str = "the independent checker rejects the plan: ";

/// How the line of a plan's objective begins.
pub(crate) const OBJECTIVE: &str = "objective: ";

/// How the line of a dynamically controllable plan begins.
pub(crate) const DYNAMIC: &str = "dynamically controllable: ";

/// How the line of a strongly controllable plan begins.
pub(crate) const STRONG: &str = "strongly controllable: ";

/// What keeps a plan from being executed as it says.
#[derive(Clone, Copy)]
struct Unsure<'a> {
    /// The drives for which it may not leave enough time.
    late: &'a BTreeSet<OccurrenceId>,
    /// Whether the vehicles of each formation are where it sets out.
    sets_out: bool,
}

fn plan_section(snapshot: &Snapshot, unsure: Unsure<'_>, places: &Places<'_>) -> Vec<Line> {
    let Some(network) = &snapshot.network else {
        return vec![places.plain(Status::Failed, "there is no plan, because the text has errors")];
    };
    let Some(planning) = &snapshot.planning else {
        let why = match snapshot.stage {
            Stage::Compiled | Stage::Improving => "planning has not finished",
            Stage::Complete => "the mission has not been planned",
        };
        return vec![places.plain(Status::Failed, why)];
    };
    let mut lines = if planning.outcome.plans.is_empty() {
        failure(planning, network, places)
    } else {
        let mut lines = vec![places.plain(Status::Passed, PLAN)];
        lines.extend(emptiness(planning, network, places));
        lines.extend(controllability(snapshot, planning, network, unsure, places));
        lines.extend(natures(planning, network, places));
        lines.extend(verdict(planning, places));
        lines.extend(assumptions(snapshot, places));
        lines.extend(worth(snapshot, planning, network, places));
        lines
    };
    lines.extend(undrivable(planning, network, places));
    lines
}

/// That the plan does nothing, which someone who approves it should know.
fn emptiness(planning: &Planning, network: &Network, places: &Places<'_>) -> Option<Line> {
    let plan = planning.outcome.plans.first()?;
    let does_something = network.arcs.iter().zip(&plan.selected_arcs).any(|(arc, &is_selected)| {
        is_selected && matches!(arc.kind, ArcKind::Activity | ArcKind::Assertion | ArcKind::Path)
    });
    let text = "the plan is empty: it has no activities and no assertions";
    (!does_something).then(|| places.plain(Status::Attention, text))
}

/// Whether the plan withstands what nature chooses, in the checker's word; nothing if nature chooses nothing (SPEC 13.1).
fn controllability(
    snapshot: &Snapshot,
    planning: &Planning,
    network: &Network,
    Unsure { late, sets_out }: Unsure<'_>,
    places: &Places<'_>,
) -> Option<Line> {
    let plan = planning.outcome.plans.first()?;
    let natures = network.occurrences.iter().filter_map(|occurrence| {
        let id = occurrence.arc?;
        let arc = &network.arcs[id.index()];
        let is_selected = plan.selected_arcs.get(id.index()) == Some(&true);
        (arc.is_contingent && is_selected).then_some((occurrence, arc))
    });
    let (mut names, mut nodes, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
    for (occurrence, arc) in natures {
        names.push(occurrence.name.to_string());
        nodes.push(occurrence.end);
        ranges.push(format!("{} [{}, {}]", occurrence.name, arc.lower.readable(), arc.upper.readable()));
    }
    if names.is_empty() {
        return None;
    }
    let ranges = match ranges.as_slice() {
        [shown @ .., last] if ranges.len() > MAX_RANGES => {
            format!("{}, … {last}", shown[..MAX_RANGES - 1].join(", "))
        }
        all => all.join(", "),
    };
    let (status, mut text) = match (network.controllability, status_by_checker(planning)) {
        (Controllability::None, _) => (
            Status::Attention,
            format!(
                "the plan chooses contingent durations, because of `option controllability = none`: {ranges}"
            ),
        ),
        (_, status @ (Status::Attention | Status::Failed)) => {
            (status, format!("controllability is not verified for these contingent durations: {ranges}"))
        }
        (Controllability::Strong, status) => (
            status,
            format!("{STRONG}one schedule works for all values of these contingent durations: {ranges}"),
        ),
        (Controllability::Dynamic, status) => (
            status,
            format!(
                "{DYNAMIC}the executive can keep all time bounds for all values of these contingent durations, as they are observed: {ranges}"
            ),
        ),
    };
    let is_checked = network.controllability != Controllability::None;
    let is_late = is_checked && !late.is_empty();
    if is_late {
        let names: Vec<&str> =
            late.iter().map(|drive| network.occurrences[drive.index()].name.as_str()).collect();
        text.push_str(&format!("; slow driving in {} {LATE}", names.join(", ")));
    }
    let closable = snapshot.traverses.iter().filter(|it| it.may_be_closed());
    let closable: Vec<&str> =
        closable.map(|it| network.occurrences[it.occurrence.index()].name.as_str()).collect();
    let may_be_closed = is_checked && !closable.is_empty();
    if may_be_closed {
        text.push_str(&format!("; {} may take longer: {CLOSED}", closable.join(", ")));
    }
    let has_meetings = is_checked && !snapshot.separation_violations.is_empty();
    if has_meetings {
        text.push_str("; vehicles that come too close may delay each other beyond that");
    }
    let is_scattered = is_checked && !sets_out;
    if is_scattered {
        text.push_str("; not every formation can set out as planned");
    }
    let is_sure = !is_late && !may_be_closed && !has_meetings && !is_scattered;
    let status = if is_sure { status } else { status.max(Status::Attention) };
    Some(places.line(status, text, None, names, nodes))
}

/// Each duration that the environment chooses.
fn natures(planning: &Planning, network: &Network, places: &Places<'_>) -> Vec<Line> {
    let Some(plan) = planning.outcome.plans.first() else { return Vec::new() };
    let line = |occurrence: &tpn::Occurrence| {
        let id = occurrence.arc?;
        let arc = &network.arcs[id.index()];
        let is_selected = plan.selected_arcs.get(id.index()) == Some(&true);
        if !arc.is_contingent || !is_selected {
            return None;
        }
        let name = occurrence.name.to_string();
        let range = format!("{} to {}", arc.lower.readable(), arc.upper.readable());
        let text = format!("uncontrolled: {name} ends {range} after its start");
        let nodes = vec![occurrence.end];
        Some(places.line(Status::Information, text, occurrence.span, vec![name], nodes))
    };
    network.occurrences.iter().filter_map(line).collect()
}

/// How many of the environment's ranges are listed.
const MAX_RANGES: usize = 6;

/// Returns what the world would have to do as it suits the plan (SPEC 13.3).
fn assumptions(snapshot: &Snapshot, places: &Places<'_>) -> Vec<Line> {
    let assumed = snapshot.problems.iter().filter(|problem| problem.code == exogenous::CODE.0);
    let line = |problem: &snapshot::Problem| {
        let message = problem.message.as_str();
        let text = match (message.strip_prefix(exogenous::WHEN), message.strip_prefix(exogenous::WHAT)) {
            (Some(when), _) => format!("{ASSUMES}timing of external events: {when}"),
            (None, Some(what)) => format!("{ASSUMES}external events: {what}"),
            (None, None) => format!("{ASSUMES}external events: {message}"),
        };
        places.line(Status::Attention, text, Some(problem.span), Vec::new(), Vec::new())
    };
    assumed.map(line).collect()
}

fn failure(planning: &Planning, network: &Network, places: &Places<'_>) -> Vec<Line> {
    let outcome = &planning.outcome;
    let none = || planning.undecided().unwrap_or("there is no plan").to_owned();
    let what = outcome.unplannable_message(network).unwrap_or_else(none);
    let mut lines = vec![places.plain(Status::Failed, what)];
    if let Some(failure) = &planning.outcome.failure {
        lines.extend(failure.reasons.iter().map(|reason| {
            let names = reason.choices.iter().map(|choice| Network::decision_name(choice.decision)).collect();
            let span = reason.spans.first().copied();
            places.line(Status::Failed, reason.message.clone(), span, names, Vec::new())
        }));
        if failure.is_of_gap {
            let text = format!("fix: {}", kirk::GAP_LABEL);
            lines.push(places.line(Status::Attention, text, None, Vec::new(), Vec::new()));
        }
        lines.extend(planning.repairs.iter().map(|repair| {
            let text = format!("fix: {}", repair.label);
            let span = repair.edits.first().map(|edit| edit.span);
            places.line(Status::Attention, text, span, Vec::new(), Vec::new())
        }));
        lines.extend(failure.relaxations.iter().map(|change| {
            let text = format!("fix: {}", change.label);
            places.line(Status::Attention, text, change.span, Vec::new(), Vec::new())
        }));
    }
    lines
}

fn verdict(planning: &Planning, places: &Places<'_>) -> Vec<Line> {
    match &planning.verdict {
        Some(verdict) if verdict.valid => {
            vec![places.plain(Status::Passed, ACCEPTED)]
        }
        Some(verdict) => verdict
            .violations
            .iter()
            .map(|violation| {
                let names = violation.events.iter().chain(&violation.intervals).cloned().collect();
                let text = format!("{REJECTED}{}", violation.message);
                places.line(Status::Failed, text, None, names, Vec::new())
            })
            .collect(),
        None => vec![places.plain(Status::Failed, "the independent checker has not checked the plan")],
    }
}

/// Returns what the plan is worth, as far as its mission counts anything, and whether it is known to be the best. The
/// checker adds up the figures; that nothing is better rests on the planner alone, and the line says that.
fn worth(snapshot: &Snapshot, planning: &Planning, network: &Network, places: &Places<'_>) -> Option<Line> {
    let plan = planning.outcome.plans.first()?;
    let mut text = tpn::worth::words(network, plan)?;
    let mut status = status_by_checker(planning);
    let has_end = tpn::worth::measures(network).contains(&Measure::End);
    // Who has the location itself depends on who comes first, and so do the paths.
    let stops_beside =
        |traverse: &snapshot::Traverse| short_of_its_goal_m(&snapshot.program.world, traverse).is_some();
    let depends_on_order =
        (has_end || network.counts_meters()) && snapshot.traverses.iter().any(stops_beside);
    let is_optimal = plan.quality.is_optimal;
    let standing = match tpn::worth::standing(plan) {
        Some(_) if depends_on_order && is_optimal == Some(false) => Some(
            "not proven optimal: in another order, vehicles that stop beside each other may have shorter paths",
        ),
        standing => standing,
    };
    if let Some(standing) = standing {
        text.push_str("; ");
        text.push_str(standing);
    }
    if is_optimal == Some(false) {
        status = status.max(Status::Attention);
    }
    if has_end {
        text.push_str("; the end is that of the earliest schedule");
    }
    Some(places.plain(status, format!("{OBJECTIVE}{text}")))
}

fn undrivable(planning: &Planning, network: &Network, places: &Places<'_>) -> Vec<Line> {
    let line = |traverse: &snapshot::Undrivable| {
        let occurrence = network.occurrences.get(traverse.occurrence.index())?;
        let name = occurrence.name.to_string();
        let mut text = format!("{name} can't be driven {}", traverse.reason);
        if !planning.outcome.plans.is_empty() {
            text.push_str(", so the planner chose another alternative");
        }
        let nodes = vec![occurrence.start, occurrence.end];
        Some(places.line(Status::Attention, text, occurrence.span, vec![name], nodes))
    };
    planning.undrivable.iter().filter_map(line).collect()
}

fn separation_violations(snapshot: &Snapshot, places: &Places<'_>) -> Vec<Line> {
    let (world, Some(network)) = (&snapshot.program.world, &snapshot.network) else { return Vec::new() };
    let vehicles = &world.vehicles;
    let line = |violation: &snapshot::SeparationViolation| {
        let [first, second] = violation.vehicles.map(|vehicle| vehicles.get(vehicle as usize));
        let (first, second) = (first?, second?);
        let text = violation.words(world, network);
        let names = vec![first.name.text.to_string(), second.name.text.to_string()];
        Some(places.line(Status::Failed, text, Some(first.span), names, Vec::new()))
    };
    snapshot.separation_violations.iter().filter_map(line).collect()
}

fn warnings(snapshot: &Snapshot, places: &Places<'_>) -> Vec<Line> {
    let line = |problem: &snapshot::Problem| {
        let status = match problem.severity {
            Severity::Error => Status::Failed,
            Severity::Warning => Status::Attention,
            Severity::Note => Status::Information,
        };
        let hint = problem.hint.as_ref().map(|hint| format!(" ({hint})")).unwrap_or_default();
        let text = format!("{}: {}{hint}", problem.code, problem.message);
        places.line(status, text, Some(problem.span), Vec::new(), Vec::new())
    };
    // Separation violations and assumptions have lines of their own.
    let has_line = |problem: &&snapshot::Problem| {
        problem.code == snapshot::SeparationViolation::CODE.0
            || (problem.code == exogenous::CODE.0 && snapshot.plan().is_some())
    };
    snapshot.problems.iter().filter(|problem| !has_line(problem)).map(line).collect()
}
