//! What a stop asks, and how an answer is given and judged.

use egui::{Button, Frame, Key, Margin, RichText, TextEdit, Ui};
use markdown::Document;
use theme::icon::{self, Icon};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::lesson::{Answer, Ask, Choice, Forecast};
use workbench::state::lesson::LessonCommand;

use super::{follow_link, prose};
use crate::Context;

/// Shows the question.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    ask: &Ask,
    typed: &mut String,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let given = context.state.lesson.given();
    let is_right = given.is_some_and(|given| given.is_right);
    Frame::new().fill(tokens.raised).corner_radius(6.0).inner_margin(Margin::same(10)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let title = match ask.answer {
            Answer::Task(_) => "Task",
            Answer::Prediction(_) => "Prediction",
            Answer::Choice(_) | Answer::Number(..) | Answer::Word(_) => "Question",
        };
        ui.label(theme::strong(title).color(tokens.accent));
        ui.add_space(space::XS);
        paragraph(ui, context, &ask.text, commands);
        match &ask.answer {
            Answer::Choice(choices) => show_choices(ui, context, choices, commands),
            Answer::Number(..) | Answer::Word(_) => show_field(ui, &ask.answer, typed, commands),
            Answer::Task(_) => show_task(ui, context, ask, is_right, commands),
            Answer::Prediction(forecast) => {
                show_prediction(ui, context, forecast, commands);
                let predictions = context.state.lesson.predictions();
                if predictions.is_over() && !ask.because.is_empty() {
                    paragraph(ui, context, &ask.because, commands);
                } else if predictions.made().last().is_some_and(|last| !last.is_right())
                    && !ask.hint.is_empty()
                {
                    paragraph(ui, context, &ask.hint, commands);
                }
                return;
            }
        }
        ui.add_space(space::S);
        let (sign, color, text) = match (context.state.lesson.verdict(), &ask.answer) {
            (Some(words), _) if is_right => (Icon::Check, tokens.good, words),
            (Some(words), _) => (Icon::Close, tokens.error, words),
            (None, Answer::Task(_)) => {
                (Icon::Working, tokens.text_muted, "Checked automatically.".to_owned())
            }
            (None, _) => return,
        };
        ui.horizontal(|ui| {
            icon::label(ui, sign, color);
            ui.label(RichText::new(text).color(color));
        });
        if is_right && !ask.because.is_empty() {
            paragraph(ui, context, &ask.because, commands);
        } else if given.is_some() && !is_right && !ask.hint.is_empty() {
            paragraph(ui, context, &ask.hint, commands);
        }
    });
}

/// A paragraph of Markdown with what is computed filled in.
fn paragraph(ui: &mut Ui, context: &Context<'_>, text: &str, commands: &mut CommandSender) {
    let blocks = Document::parse(text).blocks;
    let filled = workbench::lesson::filled(&blocks, &mut |text| context.state.lesson_value(text));
    let clicked = prose(context).show(ui, &filled);
    follow_link(clicked, "lessons", commands);
}

fn show_choices(ui: &mut Ui, context: &Context<'_>, choices: &[Choice], commands: &mut CommandSender) {
    let tokens = context.tokens;
    let given = context.state.lesson.given();
    for (at, choice) in choices.iter().enumerate() {
        let text = context.state.lesson_line(&choice.text);
        let is_given = given.is_some_and(|given| given.text == at.to_string());
        let color = match given {
            Some(given) if is_given && given.is_right => tokens.good,
            Some(_) if is_given => tokens.error,
            _ => tokens.text,
        };
        let button = Button::selectable(is_given, RichText::new(text).color(color)).wrap();
        if ui.add(button.min_size(egui::vec2(ui.available_width(), space::ROW + 4.0))).clicked() {
            commands.send(Command::Lesson(LessonCommand::Answer(at.to_string())));
        }
    }
}

fn show_field(ui: &mut Ui, answer: &Answer, typed: &mut String, commands: &mut CommandSender) {
    ui.horizontal(|ui| {
        let name = if matches!(answer, Answer::Word(_)) { "Answer" } else { "Number" };
        let field =
            ui.add(TextEdit::singleline(typed).desired_width(140.0).hint_text(name)).accessible_name(name);
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let is_pressed = ui.add_enabled(!typed.trim().is_empty(), Button::new("Check")).clicked();
        if (is_entered || is_pressed) && !typed.trim().is_empty() {
            commands.send(Command::Lesson(LessonCommand::Answer(typed.trim().to_owned())));
        }
    });
}

fn show_task(ui: &mut Ui, context: &Context<'_>, ask: &Ask, is_done: bool, commands: &mut CommandSender) {
    if is_done {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        if !ask.solution.is_empty()
            && ui.button("Show me").on_hover_text("Apply the solution (can be undone)").clicked()
        {
            commands.send(Command::Lesson(LessonCommand::Solve));
        }
    });
    if !ask.hint.is_empty() {
        egui::CollapsingHeader::new("Hint").id_salt(("hint", ask.line)).show(ui, |ui| {
            paragraph(ui, context, &ask.hint, commands);
        });
    }
}

/// What was predicted last and what came, how often predictions were right, and what can be predicted next.
fn show_prediction(ui: &mut Ui, context: &Context<'_>, forecast: &Forecast, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let predictions = context.state.lesson.predictions();
    if let Some(last) = predictions.made().last() {
        let (sign, color) =
            if last.is_right() { (Icon::Check, tokens.good) } else { (Icon::Close, tokens.error) };
        ui.horizontal_wrapped(|ui| {
            icon::label(ui, sign, color);
            ui.label(RichText::new(last.verdict()).color(color));
        });
        let made = predictions.made().len();
        let predicted = if made == 1 { "prediction" } else { "predictions" };
        let text = format!("{} of {made} {predicted} correct", predictions.right());
        ui.label(RichText::new(text).color(tokens.text_muted));
        ui.add_space(space::S);
    }
    if predictions.is_over() {
        return;
    }
    let choices = context.state.forecasts();
    if choices.is_empty() {
        let text = if predictions.is_pending() || context.state.lesson.is_due() {
            "Computing…"
        } else {
            "The panels already show the result. To predict again, click Reset view."
        };
        ui.label(RichText::new(text).color(tokens.text_muted));
        return;
    }
    let next = match forecast {
        Forecast::Decision => "The next decision:".to_owned(),
        Forecast::Failure => "The last choice of the next failure:".to_owned(),
        Forecast::Estimate(component) => format!("The most likely mode of {component} after the next step:"),
    };
    ui.label(next);
    for choice in choices {
        let button = Button::new(&choice).wrap();
        if ui.add(button.min_size(egui::vec2(ui.available_width(), space::ROW + 4.0))).clicked() {
            commands.send(Command::Lesson(LessonCommand::Answer(choice)));
        }
    }
}
