//! Counterexamples of the lines that have passed: how each was tried, and what was found.

use egui::{Button, ProgressBar, RichText, Ui};
use review::contradict::Verdict;
use review::record::LineKey;
use review::{Line, Review, Section};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::contradict::ContradictCommand;

use crate::Context;
use workbench::sentence;

/// Characters of a line that are in the names of its buttons.
const NAME_LENGTH: usize = 60;

/// Under a line that has passed: the button that looks for a counterexample, and what was found before.
pub(super) fn of_line(
    ui: &mut Ui,
    context: &Context<'_>,
    review: &Review,
    (section, line): (Section, &Line),
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let state = &context.state.contradict;
    let key = LineKey::new(section, line);
    let tried = state.of_line(review, &key);
    let name: String = line.text.chars().take(NAME_LENGTH).collect();
    let text = RichText::new("Contradict").small().color(tokens.text_muted);
    let button = ui.add_enabled(state.progress().is_none(), Button::new(text).frame(false));
    let button = button.on_hover_text("Look for a counterexample in schedules and runs");
    if button.accessible_name(format!("Contradict: {name}")).clicked() {
        commands.send(Command::Contradict(ContradictCommand::Start(Some(key.clone()))));
    }
    let Some(tried) = tried else { return };
    let color = match tried.verdict() {
        Verdict::Contradicted => tokens.error,
        Verdict::Survived => tokens.good,
        Verdict::NotTried => tokens.text_muted,
    };
    ui.label(RichText::new(sentence(&tried.sentence())).small().color(color));
    if tried.counterexample.is_some() {
        let replay = ui.button("Replay").on_hover_text("Open the counterexample in Execute");
        if replay.accessible_name(format!("Replay: {name}")).clicked() {
            commands.send(Command::Contradict(ContradictCommand::Replay(key)));
        }
    }
}

/// In the head of the review: the button that tries all lines, and how far that is.
pub(super) fn all(ui: &mut Ui, context: &Context<'_>, review: &Review, commands: &mut CommandSender) {
    let state = &context.state.contradict;
    if let Some([done, of]) = state.progress() {
        ui.horizontal_wrapped(|ui| {
            let text = format!("{done} of {of} schedules and runs");
            let share = done as f32 / of.max(1) as f32;
            ui.add(ProgressBar::new(share).desired_width(220.0).desired_height(16.0).text(text));
            if ui.button("Stop").accessible_name("Stop contradicting").clicked() {
                commands.send(Command::Contradict(ContradictCommand::Stop));
            }
        });
        return;
    }
    ui.horizontal_wrapped(|ui| {
        let has_plan = review.is_planned();
        let button = ui.add_enabled(has_plan, Button::new("Contradict all"));
        let hint = "Look for counterexamples to all passed items";
        if button.on_hover_text(hint).on_disabled_hover_text("No plan to contradict").clicked() {
            commands.send(Command::Contradict(ContradictCommand::Start(None)));
        }
        let count = |wanted: Verdict| state.of_review(review).filter(|it| it.verdict() == wanted).count();
        let [contradicted, survived, not_tried] =
            [Verdict::Contradicted, Verdict::Survived, Verdict::NotTried].map(count);
        if contradicted + survived + not_tried > 0 {
            ui.add_space(space::S);
            let color = if contradicted > 0 { context.tokens.error } else { context.tokens.text_muted };
            let text = format!("{contradicted} contradicted, {survived} survived, {not_tried} not tried");
            ui.label(RichText::new(text).color(color));
        }
    });
}
