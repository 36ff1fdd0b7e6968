//! The plan: the checker's verdict, choices, links, orderings and windows; or why there is none.

mod demands;
mod failure;
mod windows;

use egui::{RichText, ScrollArea, Ui};
use theme::icon::{self, Icon};
use theme::space;
use tpn::{Extent, LabelId, Network, Plan};
use workbench::command::{Command, CommandSender};
use workbench::state::{Selection, Status};

use crate::counted;
use crate::search::kind_name;
use crate::{Context, Panel, show_empty};

/// Lists of more rows are made as far as they are on screen.
const LONG_LIST: usize = 60;

#[derive(Default)]
pub struct PlanPanel {
    windows: windows::WindowTable,
}

impl Panel for PlanPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        work(ui, context, commands);
        let planning = context.snapshot.and_then(|snapshot| snapshot.planning.as_ref());
        let Some((snapshot, planning)) = context.snapshot.zip(planning) else {
            let text = match context.state.status() {
                Status::Broken | Status::Empty => crate::empty::missing(context, "its plan appears here"),
                Status::Undecided => "This text hasn't been planned yet.".to_owned(),
                _ => "Planning…".to_owned(),
            };
            show_empty(ui, context, &text);
            return;
        };
        let Some(network) = snapshot.network.as_deref() else { return };
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            egui::Frame::new().inner_margin(egui::Margin::symmetric(10, 6)).show(ui, |ui| {
                match context.plan() {
                    Some((network, plan)) => {
                        if let Some(view) = context.step() {
                            show_step(ui, context, view);
                        } else {
                            show_verdict(ui, context, planning);
                            demands::worth(ui, context, network, plan, planning);
                        }
                        show_choices(ui, context, network, plan, commands);
                        show_links(ui, context, network, plan, commands);
                        show_orderings(ui, context, network, plan, commands);
                        demands::resources(ui, context, network, plan, commands);
                        self.windows.show(ui, context, network, plan, commands);
                    }
                    None => failure::show(ui, context, network, planning, commands),
                }
            });
        });
    }
}

/// While the planner works, what stops it; after it was stopped, what that means and what starts it again.
fn work(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let secs = context.state.secs_at_work();
    let (icon, color, text, name, hint, command) = match context.state.status() {
        Status::Working if context.state.is_long_at_work() => (
            Icon::Working,
            tokens.info,
            if secs > 0 { format!("Planning for {secs} s…") } else { "Planning…".to_owned() },
            "Stop",
            "Stop planning; the result stays undecided",
            Command::StopWork,
        ),
        Status::Plan if context.state.is_improving() => (
            Icon::Working,
            tokens.info,
            format!("Best plan so far ({secs} s). Searching for a better one…"),
            "Stop",
            "Stop searching and use this plan",
            Command::StopWork,
        ),
        Status::Undecided => (
            Icon::Warning,
            tokens.warning,
            "No result: planning was stopped.".to_owned(),
            "Plan again",
            "Plan this text again",
            Command::PlanAgain,
        ),
        _ => return,
    };
    egui::Frame::new().inner_margin(egui::Margin::symmetric(10, 6)).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            icon::label(ui, icon, color);
            ui.label(RichText::new(text).color(color));
            if ui.button(name).on_hover_text(hint).clicked() {
                commands.send(command);
            }
        });
    });
}

/// The title of a section.
pub(crate) fn section(ui: &mut Ui, context: &Context<'_>, title: &str, note: &str) {
    ui.add_space(space::M);
    ui.horizontal(|ui| {
        theme::structure::heading(ui, theme::strong(title).color(context.tokens.text), 2);
        if !note.is_empty() {
            ui.label(RichText::new(note).small().color(context.tokens.text_muted));
        }
    });
}

/// Rows of one kind. Of long lists only those on screen are made: thousands of buttons would take longer than a frame.
fn rows(ui: &mut Ui, id: &str, count: usize, mut show: impl FnMut(&mut Ui, usize)) {
    if count <= LONG_LIST {
        (0..count).for_each(|index| show(ui, index));
        return;
    }
    // All rows are as high as the one that was made last.
    let known = ui.scope_id().with(id).with("row height");
    let spacing = ui.spacing().item_spacing.y;
    let height = ui.data(|data| data.get_temp(known)).unwrap_or(ui.spacing().interact_size.y);
    let pitch = height + spacing;
    let (top, clip) = (ui.cursor().top(), ui.clip_rect());
    let row_at = |y: f32| (((y - top) / pitch).max(0.0) as usize).min(count);
    let (first, last) = (row_at(clip.top()), (row_at(clip.bottom()) + 1).min(count));
    ui.add_space(first as f32 * pitch);
    for index in first..last {
        let row = ui.push_id((id, index), |ui| show(ui, index)).response.rect;
        ui.data_mut(|data| data.insert_temp(known, row.height()));
    }
    ui.add_space((count - last) as f32 * pitch);
}

/// A row that selects something, with its text cut where the panel ends.
pub(crate) fn selectable_row(
    ui: &mut Ui,
    context: &Context<'_>,
    selection: &Selection,
    text: RichText,
    commands: &mut CommandSender,
) {
    let is_selected = context.state.selection == *selection;
    let whole = text.text().to_owned();
    let button = egui::Button::selectable(is_selected, text).truncate();
    let response = ui.add(button).on_hover_text(whole);
    theme::structure::mark_current(&response, is_selected);
    if response.hovered() && context.state.hovered != *selection {
        commands.send(Command::Hover(selection.clone()));
    }
    if response.clicked() {
        commands.send(Command::Select(selection.clone()));
    }
    if response.double_clicked() {
        commands.send(Command::SelectAndReveal(selection.clone()));
    }
}

/// Says that what follows is not the plan.
fn show_step(ui: &mut Ui, context: &Context<'_>, view: &workbench::state::search::View) {
    ui.horizontal_wrapped(|ui| {
        let (step, steps) = (view.step.step + 1, view.recording.steps());
        let text = format!("Step {step} / {steps} of the search");
        ui.label(theme::strong(&text).color(context.tokens.accent));
        let note = "choices, orderings and windows at that step";
        ui.label(RichText::new(note).small().color(context.tokens.text_muted));
    });
}

fn show_verdict(ui: &mut Ui, context: &Context<'_>, planning: &snapshot::Planning) {
    let tokens = context.tokens;
    let stats = planning.outcome.stats;
    ui.horizontal_wrapped(|ui| match &planning.verdict {
        // What is of an earlier text says nothing good of what is written now.
        Some(verdict) if verdict.valid && context.is_stale => {
            icon::label(ui, Icon::Nothing, tokens.text_muted);
            let text = "The independent checker verified this plan of a previous version.";
            ui.label(RichText::new(text).color(tokens.text_muted));
        }
        Some(verdict) if verdict.valid => {
            icon::label(ui, Icon::Check, tokens.good);
            ui.label(RichText::new("Verified by the independent checker.").color(tokens.good));
        }
        Some(verdict) => {
            icon::label(ui, Icon::Error, tokens.error);
            let count = counted(verdict.violations.len() as u64, "violation");
            let text = format!("The independent checker rejected this plan: {count}.");
            ui.label(RichText::new(text).color(tokens.error));
        }
        None => {
            icon::label(ui, Icon::Working, tokens.text_muted);
            ui.label(RichText::new("Not checked yet.").color(tokens.text_muted));
        }
    });
    // The search panel may show another one.
    let search = kind_name(context.state.settings.plan.planner());
    let tried = counted(stats.expanded, "alternative");
    let effort = format!("{search}: {tried} tried, {}", counted(stats.conflicts, "failure"));
    ui.label(RichText::new(effort).small().color(tokens.text_muted));
    for violation in planning.verdict.iter().flat_map(|verdict| &verdict.violations) {
        let message = context.readable(&violation.message);
        ui.label(RichText::new(message).color(tokens.error));
    }
    for undrivable in &planning.undrivable {
        let network = context.state.shown().and_then(|shown| shown.network.as_ref());
        let name = network
            .and_then(|network| network.occurrences.get(undrivable.occurrence.index()))
            .map_or("A traverse", |occurrence| occurrence.name.as_str());
        let text = format!("{name} can't be driven {}", undrivable.reason);
        let text = network.map_or_else(|| text.clone(), |network| network.readable(&text));
        ui.label(RichText::new(text).color(tokens.warning));
    }
}

fn show_choices(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    plan: &Plan,
    commands: &mut CommandSender,
) {
    let reached = plan.choices.len();
    if network.decisions.is_empty() {
        return;
    }
    section(ui, context, "Choices", &format!("{reached} of {} decisions made", network.decisions.len()));
    rows(ui, "choices", plan.choices.len(), |ui, index| {
        let choice = &plan.choices[index];
        let Some(decision) = network.decisions.get(choice.decision.index()) else { return };
        ui.horizontal(|ui| {
            let name = Network::decision_name(choice.decision);
            icon::label(ui, Icon::Check, context.tokens.good);
            let text = RichText::new(&name).small().color(context.tokens.decision);
            selectable_row(ui, context, &Selection::Decision(choice.decision), text, commands);
            let others = (0..decision.alternatives.len() as u32).filter(|&it| it != choice.alternative);
            for alternative in std::iter::once(choice.alternative).chain(others) {
                let is_taken = alternative == choice.alternative;
                let text = network.alternative_name(choice.decision, alternative);
                let text = if is_taken {
                    RichText::new(text).color(context.tokens.text)
                } else {
                    RichText::new(format!("instead of {}", tpn::other_choice(&text)))
                        .color(context.tokens.text_muted)
                };
                let selection = Selection::Alternative(choice.decision, alternative);
                selectable_row(ui, context, &selection, text, commands);
            }
        });
    });
}

/// Whose condition an interval is: an activity, or the assertion that is written.
fn owner(network: &Network, label: LabelId) -> String {
    let owner = network.labels.get(label.index()).and_then(|it| network.occurrences.get(it.owner?.index()));
    let unowned = if is_initial(network, label) { "initial value" } else { "the mission" };
    owner.map_or_else(|| unowned.to_owned(), |owner| network.readable(&owner.name))
}

/// Returns whether an interval is of the value that a variable has at the start.
fn is_initial(network: &Network, label: LabelId) -> bool {
    network.labels.get(label.index()).is_some_and(|it| it.extent == Extent::Initial)
}

/// A condition with its owner; an assertion that is written says it itself.
fn condition(network: &Network, label: LabelId) -> String {
    let text = network.labels.get(label.index()).map_or("", |it| &it.text);
    if is_initial(network, label) {
        return format!("{text} (initial value)");
    }
    let owner = owner(network, label);
    if owner.contains(text) { owner } else { format!("{text} of {owner}") }
}

fn show_links(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    plan: &Plan,
    commands: &mut CommandSender,
) {
    if plan.causal_links.is_empty() {
        return;
    }
    section(ui, context, "Causal links", "each requirement with the assertion that supports it");
    rows(ui, "links", plan.causal_links.len(), |ui, index| {
        let link = plan.causal_links[index];
        let condition = network.labels.get(link.ask.index()).map_or("", |label| &label.text);
        let text = format!("{condition}: {} ← {}", owner(network, link.ask), owner(network, link.tell));
        let text = RichText::new(text).color(context.tokens.link);
        selectable_row(ui, context, &Selection::Link(link), text, commands);
    });
}

fn show_orderings(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    plan: &Plan,
    commands: &mut CommandSender,
) {
    let orders = plan.telling_order(network);
    if orders.is_empty() {
        return;
    }
    let added = plan.orderings_added.len();
    let pairs = counted(orders.len() as u64, "conflicting pair");
    let note = format!("{pairs}, {added} ordered by the planner");
    section(ui, context, "Threats and orderings", &note);
    let (added, holding): (Vec<tpn::Ordering>, Vec<tpn::Ordering>) =
        orders.into_iter().partition(|ordering| plan.orderings_added.contains(ordering));
    let mut list = |ui: &mut Ui, id: &str, orders: &[tpn::Ordering], color: egui::Color32| {
        rows(ui, id, orders.len(), |ui, index| {
            let ordering = orders[index];
            let [first, then] = [ordering.first, ordering.then].map(|label| condition(network, label));
            let text = RichText::new(format!("{first} before {then}")).color(color);
            selectable_row(ui, context, &Selection::Ordering(ordering), text, commands);
        });
    };
    list(ui, "orderings", &added, context.tokens.ordering);
    if !holding.is_empty() {
        let title = match holding.len() {
            1 => "1 implied by the bounds".to_owned(),
            count => format!("{count} implied by the bounds"),
        };
        let header = egui::CollapsingHeader::new(title).id_salt("orderings that hold");
        header.show(ui, |ui| list(ui, "holding", &holding, context.tokens.text_muted));
    }
}
