//! What holds in all runs of the program: what is to be proven, and what was found.

use egui::{DragValue, RichText, TextEdit, Ui};
use executive::model_based::Knowledge;
use executive::model_based::proof::{Counterexample, Verdict};
use link::{ProofAnswer, ProofQuestion};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::Program;
use workbench::state::program_proof::{MAX_FAULTS, ProgramProofCommand, can_step_through};

use super::title;
use crate::{Context, counted};
use workbench::sentence;

/// Shows what is asked for and what was found.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    title(ui, context, "Proof", "all runs with at most the maximum faults, and all random choices");
    ask(ui, context, commands);
    let proof = &context.state.automaton.proof;
    if proof.is_running() {
        ui.label(format!("{} found", counted(proof.states() as u64, "state")));
        ui.ctx().request_repaint();
    }
    match proof.answer(context.state.document.revision()) {
        Some((question, Ok(found))) => answer(ui, context, question, found, commands),
        Some((_, Err(trouble))) => {
            ui.label(RichText::new(format!("✗ {trouble}")).color(context.tokens.error));
        }
        None if !proof.is_running() => {
            ui.add_space(space::M);
            let text = "Leave the properties empty to check that the program ends, that goals agree, that \
                        everything can be reached, and that locks do not deadlock.";
            ui.label(RichText::new(text).color(context.tokens.text_muted));
        }
        None => {}
    }
    ui.add_space(space::L);
}

fn ask(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let proof = &context.state.automaton.proof;
    let mut settings = proof.settings.clone();
    let muted = |text: &str| RichText::new(text).color(context.tokens.text_muted);
    let label = ui.label(muted("Properties")).id;
    let hint = "ends; never A = On";
    let edit = TextEdit::singleline(&mut settings.properties).hint_text(hint).desired_width(f32::INFINITY);
    let edited = ui.add(edit).labelled_by(label);
    let is_entered = edited.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    edited.on_hover_text("always C; never C; eventually C; C leads to D; ends");
    ui.horizontal_wrapped(|ui| {
        let label = ui.label(muted("Maximum faults")).id;
        ui.add(DragValue::new(&mut settings.faults).range(0..=MAX_FAULTS).speed(0.05)).labelled_by(label);
        let mut is_perfect = settings.knowledge == Knowledge::Perfect;
        ui.checkbox(&mut is_perfect, "Perfect knowledge")
            .on_hover_text("The program knows all modes, instead of estimating them");
        settings.knowledge = if is_perfect { Knowledge::Perfect } else { Knowledge::Estimated };
    });
    if settings != proof.settings {
        commands.send(Command::ProgramProof(ProgramProofCommand::Set(settings)));
    }
    if proof.is_running() {
        if ui.button("Stop proof").clicked() {
            commands.send(Command::ProgramProof(ProgramProofCommand::Stop));
        }
    } else if ui.button("Prove properties").clicked() || is_entered {
        commands.send(Command::ProgramProof(ProgramProofCommand::Start));
    }
}

fn answer(
    ui: &mut Ui,
    context: &Context<'_>,
    question: &ProofQuestion,
    found: &ProofAnswer,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    ui.add_space(space::M);
    let faults = match question.faults {
        0 => "no faults".to_owned(),
        most => format!("at most {}", counted(u64::from(most), "fault")),
    };
    let states = counted(found.states as u64, "state");
    let transitions = counted(found.transitions as u64, "transition");
    let text = format!("{states}, {transitions}, {faults}");
    ui.label(RichText::new(text).color(tokens.text_muted));
    if let Some(stopped) = &found.stopped {
        let text = format!("Not all states were explored: {stopped}.");
        ui.label(RichText::new(text).color(tokens.warning));
    }
    for (number, (property, verdict)) in found.verdicts.iter().enumerate() {
        ui.add_space(space::S);
        match verdict {
            Verdict::Holds => {
                ui.label(RichText::new(format!("✓ {property}")).color(tokens.good));
            }
            Verdict::Open => {
                let text =
                    format!("? {property}: open, no counterexample within {}", counted(found.depth, "step"));
                ui.label(RichText::new(text).color(tokens.warning));
            }
            Verdict::Never(what) => {
                ui.label(RichText::new(format!("✗ {property}")).color(tokens.error));
                for what in what {
                    ui.label(format!("Never: {what}"));
                }
            }
            Verdict::Broken(run) => {
                ui.label(RichText::new(format!("✗ {property}")).color(tokens.error));
                counterexample(ui, context, run);
                if can_step_through(question, run) && ui.button("Step through counterexample").clicked() {
                    commands.send(Command::ProgramProof(ProgramProofCommand::StepThrough(number)));
                }
            }
        }
    }
}

fn counterexample(ui: &mut Ui, context: &Context<'_>, run: &Counterexample) {
    let model = context.state.automaton.program().and_then(Program::model);
    for step in model.map_or_else(Vec::new, |model| run.unusual(model)) {
        ui.label(format!("Step {step}"));
    }
    let chosen = (1..).zip(&run.moves).filter(|(_, by)| !by.choices.is_empty());
    for (step, by) in chosen {
        let choices: Vec<String> = by.choices.iter().map(|choice| (choice + 1).to_string()).collect();
        ui.label(format!("Step {step}: alternative {}", choices.join(", ")));
    }
    ui.label(format!("{}.", sentence(&run.ending())));
}
