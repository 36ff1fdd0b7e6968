//! The flight rules: the thresholds that the checklist is held against, to see and to change.

use std::collections::BTreeSet;

use egui::{Button, DragValue, RichText, TextEdit, Ui};
use exact::{Rational, Time};
use review::flight_rule::{self, MissionRule, Outcome};
use review::names;
use review::record::{Act, Entry};
use review::ruling::Proposal;
use review::seat::{MAX_APPROVALS, MAX_SEATS, Seat};
use review::{FlightRules, SuccessRate};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::review::ReviewCommand;

use super::{header, people, row};
use crate::Context;

/// Figures are kept to thousandths.
const PARTS: u32 = 1000;

/// What was changed and is not in force yet.
#[derive(Default)]
pub(super) struct Rules {
    /// The rules in force when the change began, and as they are to be.
    draft: Option<(FlightRules, FlightRules)>,
}

impl Rules {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        closed: &mut BTreeSet<&'static str>,
        commands: &mut CommandSender,
    ) {
        let record = context.state.review.record();
        let present = record.rules().clone();
        // What others have set in the meantime counts.
        let proposals = record.proposals();
        let is_known = |draft: &FlightRules| proposals.iter().any(|proposal| proposal.rules == draft);
        self.draft.take_if(|(before, draft)| *before != present || *draft == present || is_known(draft));
        let note = match (&self.draft, record.ruled()) {
            (Some(_), _) => "unsaved changes".to_owned(),
            (None, Some((ruled, _))) if !ruled.by.is_empty() => format!("set by {}", ruled.by),
            (None, Some(_)) => "from this mission".to_owned(),
            (None, None) => "default".to_owned(),
        };
        if !header(ui, context, closed, "Flight rules", None, &note) {
            return;
        }
        let mut rules = self.draft.as_ref().map_or_else(|| present.clone(), |(_, draft)| draft.clone());
        people::indented(ui, |ui| {
            for entry in record.conflicting_rules() {
                conflict(ui, context, entry, commands);
            }
            for proposal in &proposals {
                agreement(ui, context, proposal, commands);
            }
            let unknown = record.unknown_rules();
            if let Some(entry) = unknown {
                let name = names::one_line(&entry.by);
                let text = format!(
                    "{name}, whose key is unknown, has set flight rules. Trust the key, or confirm these rules."
                );
                ui.label(RichText::new(text).color(context.tokens.warning));
            }
            fields(ui, context, &mut rules);
            ui.add_space(space::S);
            let problem = rules.problem();
            ui.horizontal_wrapped(|ui| {
                let is_confirmation = rules == present && unknown.is_some();
                let is_ready = (rules != present || is_confirmation) && problem.is_none();
                let words = if is_confirmation { "Confirm rules" } else { "Apply rules" };
                if ui.add_enabled(is_ready, Button::new(words)).clicked() {
                    let rules = Box::new(rules.clone());
                    commands.send(Command::Review(ReviewCommand::SetRules(rules)));
                }
                let is_usual = rules == FlightRules::default();
                if ui.add_enabled(!is_usual, Button::new("Restore defaults")).clicked() {
                    rules = FlightRules::default();
                }
                if ui.button("Save rules to file").clicked() {
                    commands.send(Command::Review(ReviewCommand::SaveRules));
                }
            });
            if let Some(problem) = problem {
                ui.label(RichText::new(problem).color(context.tokens.error));
            }
        });
        self.draft = (rules != present).then_some((present, rules));
    }
}

/// One of several sets of flight rules in force, and the button that agrees to it.
fn conflict(ui: &mut Ui, context: &Context<'_>, entry: &Entry, commands: &mut CommandSender) {
    let Act::Rules { rules } = &entry.act else { return };
    let text = format!(
        "In force at the same time, set by {}: required approvals {}.",
        people::who(entry),
        rules.board_in_words()
    );
    ui.label(RichText::new(text).color(context.tokens.warning));
    let ring = context.state.keys.ring();
    let has_key = ring.own_named(&context.state.settings.reviewer).is_some();
    let agree =
        ui.add_enabled(has_key, Button::new("Agree")).on_hover_text("Sign these flight rules and this board");
    if agree.accessible_name(format!("Agree to the rules of {}", entry.by)).clicked() {
        commands.send(Command::Review(ReviewCommand::SetRules(Box::new(rules.clone()))));
    }
    ui.add_space(space::S);
}

/// A change that weakens the board, and the button that agrees to it.
fn agreement(ui: &mut Ui, context: &Context<'_>, proposal: &Proposal<'_>, commands: &mut CommandSender) {
    let names: Vec<String> = proposal.by.iter().map(|entry| people::who(entry)).collect();
    let present = context.state.review.record().rules();
    let same_board = FlightRules { board: present.board.clone(), ..proposal.rules.clone() };
    let more = if same_board == *present { "" } else { " Other flight rules change, too." };
    let text = format!(
        "Proposed by {}: required approvals {}.{more} Consent: {}.",
        names.join(", "),
        proposal.rules.board_in_words(),
        proposal.consent()
    );
    ui.label(RichText::new(text).color(context.tokens.warning));
    let ring = context.state.keys.ring();
    let key = ring.own_named(&context.state.settings.reviewer).map(|person| &person.key);
    let is_ready = key.is_some() && proposal.by.iter().all(|entry| entry.key.as_ref() != key);
    let agree = ui.add_enabled(is_ready, Button::new("Agree"));
    if agree.on_hover_text("Sign these flight rules and this board, too").clicked() {
        commands.send(Command::Review(ReviewCommand::SetRules(Box::new(proposal.rules.clone()))));
    }
    ui.add_space(space::S);
}

fn fields(ui: &mut Ui, context: &Context<'_>, rules: &mut FlightRules) {
    let usual = FlightRules::default();
    let mut margin = rules.margin.map(Time::to_f64);
    if optional(ui, "Minimum margin", &mut margin, 0.0, 1.0e6) {
        rules.margin = margin.and_then(|margin| Time::from_f64_nearest(margin, PARTS));
    }
    optional(ui, "Minimum clearance (m)", &mut rules.clearance_m, 0.25, 1000.0);
    optional(ui, "Maximum slope (°)", &mut rules.slope_deg, 15.0, 90.0);
    let mut reserve = rules.reserve.map(Rational::to_f64);
    if optional(ui, "Minimum reserve per resource", &mut reserve, 0.0, 1.0e6) {
        rules.reserve = reserve.and_then(|reserve| Rational::from_f64_nearest(reserve, PARTS));
    }
    let network = context.snapshot.and_then(|snapshot| snapshot.network.as_deref());
    let resources = network.map(|network| network.resources.as_slice()).unwrap_or_default();
    for resource in resources.iter().filter(|resource| !resource.name.contains('#')) {
        let mut own = rules.reserves.get(&resource.name).map(|reserve| reserve.to_f64());
        if optional(ui, &format!("Minimum reserve of {}", resource.name), &mut own, 0.0, 1.0e6) {
            match own.and_then(|own| Rational::from_f64_nearest(own, PARTS)) {
                Some(own) => rules.reserves.insert(resource.name.clone(), own),
                None => rules.reserves.remove(&resource.name),
            };
        }
    }
    let mut rate =
        rules.success_rate.or(usual.success_rate).unwrap_or(SuccessRate { wanted: 1.0, least: 0.0 });
    let mut is_held = rules.success_rate.is_some();
    let mut wanted = is_held.then_some(rate.wanted * 100.0);
    let mut least = is_held.then_some(rate.least * 100.0);
    let is_changed = optional(ui, "Minimum success rate (%)", &mut wanted, 95.0, 100.0)
        | optional(ui, "Fail below success rate (%)", &mut least, 80.0, 100.0);
    if is_changed {
        // The two are one rule.
        is_held =
            if is_held { wanted.is_some() && least.is_some() } else { wanted.is_some() || least.is_some() };
        rate.wanted = wanted.map_or(rate.wanted, |wanted| wanted / 100.0);
        rate.least = least.map_or(rate.least, |least| least / 100.0);
        rules.success_rate = is_held.then_some(rate);
    }
    mission_rules(ui, context, &mut rules.rules);
    board(ui, context, &mut rules.board);
}

/// What the mission has to keep to in its own language.
fn mission_rules(ui: &mut Ui, context: &Context<'_>, rules: &mut Vec<MissionRule>) {
    ui.add_space(space::S);
    row::muted_word(ui, "Mission rules, such as Battery >= 20 or never Drive while Mast=UP");
    let mut gone = None;
    for (index, rule) in rules.iter_mut().enumerate() {
        let number = index + 1;
        ui.push_id(("mission rule", index), |ui| {
            ui.horizontal_wrapped(|ui| {
                let field =
                    |text, hint, width| TextEdit::singleline(text).hint_text(hint).desired_width(width);
                let name = field(&mut rule.name, "Name", 140.0);
                ui.add(name).accessible_name(format!("Name of rule {number}"));
                let source = field(&mut rule.source, "Source, such as FR 4.2", 150.0);
                ui.add(source).accessible_name(format!("Source of rule {number}"));
                ui.checkbox(&mut rule.waivable, "Can be waived")
                    .on_hover_text("Violations are warnings, not failures")
                    .accessible_name(format!("Rule {number} can be waived"));
                if ui.button("Remove").accessible_name(format!("Remove rule {number}")).clicked() {
                    gone = Some(index);
                }
            });
            let width = ui.available_width().min(420.0);
            let text = TextEdit::singleline(&mut rule.rule)
                .hint_text("never A while B")
                .font(egui::TextStyle::Monospace)
                .desired_width(width);
            ui.add(text).accessible_name(format!("Text of rule {number}"));
            // Always a line, so that nothing below moves while someone writes.
            match problem_of(context, &rule.rule) {
                Some(problem) => {
                    ui.label(RichText::new(problem).color(context.tokens.error));
                }
                None if rule.rule.trim().is_empty() => {
                    row::muted_word(ui, "Enter a condition and when it must hold");
                }
                None if context.snapshot.is_some_and(|snapshot| snapshot.network.is_some()) => {
                    row::muted_word(ui, "All names in this rule are declared");
                }
                None => row::muted_word(ui, "Not checked: the mission has no network"),
            }
        });
    }
    if let Some(index) = gone {
        rules.remove(index);
    }
    if ui.button("Add rule").clicked() {
        let is_new = |name: &String| !rules.iter().any(|rule| rule.name == *name);
        let name =
            (1..=rules.len() + 1).map(|number| format!("Rule {number}")).find(is_new).unwrap_or_default();
        rules.push(MissionRule { name, ..MissionRule::default() });
    }
}

/// Returns what is wrong with a rule in the open mission.
fn problem_of(context: &Context<'_>, rule: &str) -> Option<String> {
    let snapshot = context.snapshot.filter(|_| !rule.trim().is_empty())?;
    let network = snapshot.network.as_deref()?;
    match flight_rule::problem(&snapshot.program, network, rule)? {
        Outcome::Unreadable { column, message } => Some(format!("character {column}: {message}")),
        _ => None,
    }
}

/// Who has to approve, and how many of them.
fn board(ui: &mut Ui, context: &Context<'_>, board: &mut Vec<Seat>) {
    ui.add_space(space::S);
    row::muted_word(ui, "Required approvals: to weaken them later, this board must agree");
    let mut gone = None;
    let is_only = board.len() == 1;
    for (index, seat) in board.iter_mut().enumerate() {
        ui.push_id(index, |ui| {
            ui.horizontal_wrapped(|ui| {
                let number = index + 1;
                let count = DragValue::new(&mut seat.approvals).range(1..=MAX_APPROVALS).speed(0.05);
                ui.add(count).accessible_name(format!("Approvals of role {number}"));
                let role = TextEdit::singleline(&mut seat.role).hint_text("Role").desired_width(160.0);
                ui.add(role).accessible_name(format!("Role {number}"));
                people_of(ui, context, seat, number);
                let remove = ui.add_enabled(!is_only, Button::new("Remove"));
                if remove.accessible_name(format!("Remove role {number}")).clicked() {
                    gone = Some(index);
                }
            });
        });
    }
    if let Some(index) = gone {
        board.remove(index);
    }
    if ui.add_enabled(board.len() < MAX_SEATS, Button::new("Add role")).clicked() {
        board.push(Seat::new("", 1));
    }
}

/// Whose approvals count in a role: anyone's, or those of some whose keys are trusted.
fn people_of(ui: &mut Ui, context: &Context<'_>, seat: &mut Seat, number: usize) {
    let ring = context.state.keys.ring();
    let text = match seat.people.len() {
        0 => "Anyone".to_owned(),
        1 => "1 person".to_owned(),
        count => format!("{count} people"),
    };
    let menu = ui.menu_button(text, |ui| {
        for person in ring.people() {
            let mut is_named = seat.people.contains(&person.key);
            if ui.checkbox(&mut is_named, &person.name).changed() {
                seat.people.retain(|key| *key != person.key);
                seat.people.extend(is_named.then(|| person.key.clone()));
            }
        }
        if ui.button("Anyone").clicked() {
            seat.people.clear();
        }
    });
    menu.response.accessible_name(format!("People of role {number}"));
}

/// A threshold that may be absent. Returns whether it has been changed.
fn optional(ui: &mut Ui, label: &str, value: &mut Option<f64>, usual: f64, most: f64) -> bool {
    let before = *value;
    ui.horizontal(|ui| {
        let mut is_there = value.is_some();
        if ui.checkbox(&mut is_there, label).changed() {
            *value = is_there.then_some(usual);
        }
        if let Some(value) = value {
            let field = DragValue::new(value).range(0.0..=most).speed(0.1).max_decimals(3);
            ui.add(field).accessible_name(label);
        } else {
            row::muted_word(ui, "not checked");
        }
    });
    before != *value
}
