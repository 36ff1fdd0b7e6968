//! The review: a checklist that is computed, and what its board says of it until it approves.
//!
//! Each line leads to its place in all other panels. A state is always a sign and a word, never a color alone.

pub(crate) mod changes;
mod contradict;
mod events;
mod every_plan;
mod history;
mod keys;
mod lines;
mod people;
mod robustness;
mod row;
mod rules;
mod verdict;

use crate::counted;
use std::collections::{BTreeMap, BTreeSet};

use egui::{Frame, Margin, ScrollArea, Ui};
use review::record::{Entry, LineKey};
use review::{Review, Section, Status};
use theme::icon::Icon;
use theme::{Tokens, space};
use workbench::command::{Command, CommandSender};
use workbench::state;
use workbench::state::review::ReviewCommand;

use crate::{Context, Panel, show_empty};

#[derive(Default)]
pub struct ReviewPanel {
    /// The sections that are folded.
    closed: BTreeSet<&'static str>,
    /// The sections of which everything is listed.
    expanded: BTreeSet<&'static str>,
    people: people::People,
    rules: rules::Rules,
    keys: keys::Keys,
    changes: changes::Changes,
}

/// Lines of a section that are listed before "Show all".
const FIRST_LINES: usize = 40;

impl Panel for ReviewPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let state = context.state;
        let is_evaluated = state.status() != state::Status::Working;
        if state.status() == state::Status::Program {
            show_empty(ui, context, "Control programs can't be reviewed. Open a mission to review its plan.");
            return;
        }
        if state.review.is_unasked() && !state.review.is_running() && is_evaluated {
            commands.send(Command::Review(ReviewCommand::Run));
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            Frame::new().inner_margin(Margin::symmetric(10, 8)).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = space::S;
                let shown = state.review.shown();
                let standing = state.review.standing();
                verdict::show(ui, context, shown, standing.as_ref(), &mut self.people, commands);
                self.changes.show(ui, context, &mut self.closed, commands);
                if let Some((review, is_stale)) = shown {
                    let selected = row::selected_names(context);
                    let acknowledged = state.review.record().acknowledgments();
                    let list = List { context, review, is_stale, selected: &selected, acknowledged };
                    self.sections(ui, &list, commands);
                }
                self.rules.show(ui, context, &mut self.closed, commands);
                let Self { people, keys, closed, .. } = self;
                people.waivers(ui, context, closed, commands);
                people.comments(ui, context, standing.as_ref(), closed, commands);
                if let Some(standing) = &standing {
                    people.approval(ui, context, standing, closed, commands);
                }
                history::show(ui, context, closed, commands);
                keys.show(ui, context, people, closed, commands);
            });
        });
    }
}

/// What all lines of one review need.
struct List<'a> {
    context: &'a Context<'a>,
    review: &'a Review,
    is_stale: bool,
    /// The names of what is selected.
    selected: &'a [String],
    /// Who acknowledged which line.
    acknowledged: BTreeMap<&'a LineKey, &'a Entry>,
}

impl ReviewPanel {
    fn sections(&mut self, ui: &mut Ui, list: &List<'_>, commands: &mut CommandSender) {
        for section in Section::ALL {
            if section == Section::Robustness {
                self.robustness(ui, list, commands);
                continue;
            }
            let lines = list.review.lines(section);
            let status = list.review.section_status(section);
            let note = section_note(&lines.iter().map(|line| line.status).collect::<Vec<_>>(), section);
            let is_empty_without_plan =
                lines.is_empty() && !list.review.is_planned() && section != Section::Warnings;
            let shown_status = (!is_empty_without_plan).then_some(status);
            let is_open = header(ui, list.context, &mut self.closed, section.title(), shown_status, &note);
            if is_open {
                ui.push_id(section.title(), |ui| self.section(ui, list, section, commands));
            }
        }
    }

    fn robustness(&mut self, ui: &mut Ui, list: &List<'_>, commands: &mut CommandSender) {
        let figures = list.context.state.robustness().map(AsRef::as_ref);
        let note = robustness::note(figures);
        let line = list.review.robustness.as_ref();
        let title = Section::Robustness.title();
        if header(ui, list.context, &mut self.closed, title, line.map(|line| line.status), &note) {
            if let Some(line) = line {
                lines::line(ui, list, Section::Robustness, 0, line, &mut self.people, commands);
            }
            robustness::show(ui, list.context, figures, commands);
        }
    }

    fn section(&mut self, ui: &mut Ui, list: &List<'_>, section: Section, commands: &mut CommandSender) {
        let lines = list.review.lines(section);
        if lines.is_empty() {
            row::muted(ui, list.context, list.review.nothing(section));
            if let Some(settled) = list.review.settled(section) {
                let of_line = (section, &settled);
                ui.horizontal(|ui| {
                    ui.add_space(row::INDENT);
                    ui.vertical(|ui| contradict::of_line(ui, list.context, list.review, of_line, commands));
                });
            }
            return;
        }
        if section == Section::MissionRules && !list.is_stale {
            ui.horizontal_wrapped(|ui| {
                ui.add_space(row::INDENT);
                every_plan::all(ui, list.context, list.review, commands);
            });
        }
        let is_expanded = self.expanded.contains(section.title());
        let most = if section == Section::Events { events::FIRST_EVENTS } else { FIRST_LINES };
        let count = if is_expanded { lines.len() } else { lines.len().min(most) };
        match section {
            Section::Choices => lines::choices(ui, list, count, &mut self.people, commands),
            Section::Events => events::show(ui, list, count, commands),
            _ => {
                for (index, line) in lines.iter().enumerate().take(count) {
                    lines::line(ui, list, section, index, line, &mut self.people, commands);
                }
            }
        }
        if lines.len() > most {
            let text =
                if is_expanded { "Show fewer".to_owned() } else { format!("Show all {}", lines.len()) };
            ui.horizontal(|ui| {
                ui.add_space(row::INDENT);
                let name = format!("{text}: {}", section.title());
                if ui.button(&text).accessible_name(name).clicked() {
                    if is_expanded {
                        self.expanded.remove(section.title());
                    } else {
                        self.expanded.insert(section.title());
                    }
                }
            });
        }
    }
}

/// Returns whether the review that is shown is of another content than the present one.
fn is_stale(context: &Context<'_>) -> bool {
    let state = context.state;
    state.review.shown().is_some_and(|(_, is_stale)| is_stale)
}

/// The sign, the word and the color of a status. What was reviewed of another text keeps its words, in gray.
fn status_look(tokens: &Tokens, status: Status, is_stale: bool) -> (Icon, &'static str, egui::Color32) {
    if is_stale {
        let word = match status {
            Status::Information => "was information",
            Status::Passed => "had passed",
            Status::Attention => "needed attention",
            Status::Failed => "had failed",
        };
        return (Icon::Nothing, word, tokens.text_faint);
    }
    match status {
        Status::Information => (Icon::Info, "information", tokens.text_muted),
        Status::Passed => (Icon::Check, "passed", tokens.good),
        Status::Attention => (Icon::Warning, "needs attention", tokens.warning),
        Status::Failed => (Icon::Error, "failed", tokens.error),
    }
}

/// Returns how the lines of a section stand, in words.
fn section_note(statuses: &[Status], section: Section) -> String {
    if statuses.is_empty() {
        return String::new();
    }
    if section == Section::Events {
        return format!("{}, tightest first", counted(statuses.len() as u64, "event"));
    }
    [Status::Failed, Status::Attention, Status::Passed, Status::Information]
        .into_iter()
        .filter_map(|status| {
            let count = statuses.iter().filter(|it| **it == status).count();
            let words = match status {
                Status::Attention if count == 1 => "needs attention",
                Status::Attention => "need attention",
                Status::Information => "informational",
                Status::Failed | Status::Passed => status.name(),
            };
            (count > 0).then(|| format!("{count} {words}"))
        })
        .collect::<Vec<_>>()
        .join(", ")
}

/// The heading of a section, which folds it; whether it is open.
fn header(
    ui: &mut Ui,
    context: &Context<'_>,
    closed: &mut BTreeSet<&'static str>,
    title: &'static str,
    status: Option<Status>,
    note: &str,
) -> bool {
    ui.add_space(space::S);
    let is_open = !closed.contains(title);
    if row::heading(ui, context, title, status, note, is_open).clicked() {
        if is_open {
            closed.insert(title);
        } else {
            closed.remove(title);
        }
    }
    is_open
}
