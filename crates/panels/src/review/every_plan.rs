//! Rules of the mission over all of its plans: whether each holds in this plan only, or in every plan, and the plan that does
//! not keep it.

use egui::{Button, ProgressBar, RichText, Ui};
use review::flight_rule::proof::Verdict;
use review::{Outcome, Review};
use workbench::command::{Command, CommandSender};
use workbench::state::rule_proof::RuleProofCommand;

use crate::Context;
use workbench::sentence;

/// Under the line of a rule: the button that proves it in every plan, and what was found before.
pub(super) fn of_rule(
    ui: &mut Ui,
    context: &Context<'_>,
    review: &Review,
    index: usize,
    commands: &mut CommandSender,
) {
    let Some(rule) = review.rules.rules.get(index) else { return };
    let (tokens, state) = (context.tokens, &context.state.rule_proof);
    let text = RichText::new("Prove").small().color(tokens.text_muted);
    let is_ready = review.is_planned() && state.progress().is_none();
    let button = ui.add_enabled(is_ready, Button::new(text).frame(false));
    let button = button.on_hover_text("Find out whether every plan of this mission keeps the rule");
    if button.accessible_name(format!("Prove: {}", rule.name)).clicked() {
        commands.send(Command::RuleProof(RuleProofCommand::Start(Some(rule.rule.clone()))));
    }
    let Some(proven) = state.of_rule(&review.content_hash, &rule.rule) else { return };
    let color = match &proven.verdict {
        Verdict::Holds | Verdict::NeverApplies => tokens.good,
        Verdict::Broken(_) | Verdict::Unreadable { .. } => tokens.error,
        Verdict::Unsure(_) | Verdict::Open(_) | Verdict::NoPlan => tokens.text_muted,
    };
    let holds_here = review.findings.iter().any(|it| it.rule == rule.rule && it.outcome == Outcome::Holds);
    let is_of_other = proven.verdict.counterexample().is_some_and(|found| !found.is_own);
    let words = sentence(&proven.verdict.sentence());
    let words = if holds_here && is_of_other { format!("Holds in this plan only. {words}") } else { words };
    ui.label(RichText::new(words).small().color(color));
    if let Some(found) = proven.verdict.counterexample() {
        let (label, hint) = if found.is_own {
            ("Replay", "Open the counterexample in Execute")
        } else {
            ("Open plan", "Compare this plan with the one that violates the rule")
        };
        let open = ui.button(label).on_hover_text(hint);
        if open.accessible_name(format!("{label}: {}", rule.name)).clicked() {
            commands.send(Command::RuleProof(RuleProofCommand::Open(rule.rule.clone())));
        }
    }
}

/// Above the rules: the button that proves all of them, and how far that is.
pub(super) fn all(ui: &mut Ui, context: &Context<'_>, review: &Review, commands: &mut CommandSender) {
    if let Some([done, of]) = context.state.rule_proof.progress() {
        let share = done as f32 / of.max(1) as f32;
        let text = format!("{done} of {of} rules");
        ui.add(ProgressBar::new(share).desired_width(220.0).desired_height(16.0).text(text));
        if ui.button("Stop").accessible_name("Stop proving rules").clicked() {
            commands.send(Command::RuleProof(RuleProofCommand::Stop));
        }
        return;
    }
    let button = ui.add_enabled(review.is_planned(), Button::new("Prove all rules"));
    let hint = "Find out which rules hold in every plan of this mission";
    if button.on_hover_text(hint).on_disabled_hover_text("No plan to prove rules about").clicked() {
        commands.send(Command::RuleProof(RuleProofCommand::Start(None)));
    }
}
