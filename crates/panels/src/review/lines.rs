//! The lines of the checklist, and where they lead.

use egui::Ui;
use review::record::LineKey;
use review::{Fate, Line, Section, Status};
use snapshot::Snapshot;
use tpn::{CausalLink, DecisionId, LabelId, Ordering};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;

use super::people::People;
use super::{List, contradict, every_plan, row};
use workbench::sentence;

/// Shows a line of any section.
pub(super) fn line(
    ui: &mut Ui,
    list: &List<'_>,
    section: Section,
    index: usize,
    line: &Line,
    people: &mut People,
    commands: &mut CommandSender,
) {
    let is_selected = list.selected.contains(&key(section, line));
    let place = line.line_number.map(|number| format!("line {number}")).unwrap_or_default();
    let shown = row::Row {
        status: Some(line.status),
        text: &sentence(&line.text),
        criterion: line.criterion.as_deref().unwrap_or_default(),
        place: &place,
        is_selected,
        indent: 0.0,
        is_muted: false,
    };
    if row::show(ui, list.context, &shown).clicked() {
        go_to(list, section, line, commands);
        if let (Section::SeparationViolations, Some(snapshot)) = (section, list.context.snapshot)
            && let Some(violation) = snapshot.separation_violations.get(index).filter(|_| !list.is_stale)
        {
            commands.send(Command::Seek(violation.time));
        }
    }
    if line.status == Status::Passed && !list.is_stale {
        ui.horizontal_wrapped(|ui| {
            ui.add_space(row::INDENT);
            contradict::of_line(ui, list.context, list.review, (section, line), commands);
        });
    }
    if section == Section::MissionRules && !list.is_stale {
        ui.horizontal_wrapped(|ui| {
            ui.add_space(row::INDENT);
            every_plan::of_rule(ui, list.context, list.review, index, commands);
        });
    }
    if line.status == Status::Attention && !list.is_stale {
        let known = list.acknowledged.get(&LineKey::new(section, line)).copied();
        ui.push_id((section.title(), index), |ui| {
            people.acknowledgment(ui, list.context, (section, line), known, commands);
        });
    }
}

/// Shows the choices with their alternatives and why they were not taken.
pub(super) fn choices(
    ui: &mut Ui,
    list: &List<'_>,
    count: usize,
    people: &mut People,
    commands: &mut CommandSender,
) {
    for (index, choice) in list.review.choices.iter().enumerate().take(count) {
        line(ui, list, Section::Choices, index, &choice.line, people, commands);
        for alternative in &choice.alternatives {
            let is_said = alternative.text.starts_with(alternative.name.trim_end_matches(')'));
            let what = if is_said { &alternative.text } else { &alternative.name };
            let text = format!("{what}\n{}", sentence(&alternative.fate.sentence()));
            let name = format!("{}={}", choice.name, alternative.number);
            let is_taken = alternative.fate == Fate::Taken;
            let shown = row::Row {
                status: is_taken.then_some(Status::Passed),
                text: &text,
                criterion: "",
                place: "",
                is_selected: list.selected.contains(&name),
                indent: 20.0,
                is_muted: !is_taken,
            };
            if row::show(ui, list.context, &shown).clicked()
                && let Some(id) = decision(&choice.name)
            {
                commands.send(Command::SelectAndReveal(Selection::Alternative(id, alternative.number)));
            }
        }
    }
}

/// Selects in all panels what a line is about, and shows its text.
pub(super) fn go_to(list: &List<'_>, section: Section, line: &Line, commands: &mut CommandSender) {
    let found = list.context.snapshot.and_then(|snapshot| selection(snapshot, section, line));
    match (found, line.span) {
        (Some(selection), _) => commands.send(Command::SelectAndReveal(selection)),
        // Places in an older text are somewhere else now.
        (None, Some(span)) if !list.is_stale => commands.send(Command::Reveal(span)),
        _ => {}
    }
}

/// Returns what a line is about, in the present network.
fn selection(snapshot: &Snapshot, section: Section, line: &Line) -> Option<Selection> {
    let network = snapshot.network.as_deref();
    let label = |name: &String| {
        let network = network?;
        (0..network.labels.len()).map(LabelId::from_index).find(|&id| network.label_name(id) == *name)
    };
    match (section, line.names.as_slice()) {
        (Section::CausalLinks, [ask, tell]) => {
            Some(Selection::Link(CausalLink { ask: label(ask)?, tell: label(tell)? }))
        }
        (Section::Conflicts, [first, then]) => {
            match label(first).zip(label(then)) {
                Some((first, then)) => Some(Selection::Ordering(Ordering { first, then })),
                // Two uses of a resource: the one that has to wait.
                None => Selection::by_name(snapshot, then),
            }
        }
        (_, [first, ..]) => Selection::by_name(snapshot, first),
        (_, []) => None,
    }
}

/// The name under which the selection of a line is known.
fn key(section: Section, line: &Line) -> String {
    match (section, line.names.as_slice()) {
        (Section::CausalLinks, [ask, tell]) => format!("{ask} ← {tell}"),
        (Section::Conflicts, [first, then]) => format!("{first} ≺ {then}"),
        (_, [first, ..]) => first.clone(),
        (_, []) => String::new(),
    }
}

fn decision(name: &str) -> Option<DecisionId> {
    let number: u32 = name.strip_prefix('D')?.parse().ok()?;
    number.checked_sub(1).map(DecisionId)
}
