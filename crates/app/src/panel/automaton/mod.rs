//! A control program as it runs: the automaton with its marking, the plant as it is believed to be, and all steps.
//!
//! Components can be made to fail and observations be changed, to see what the executive makes of it.

mod canvas;
mod chance;
mod components;
mod controls;
mod evidence;
mod known;
mod log;
mod machine;
mod shapes;

use egui::{Frame, Margin, RichText, ScrollArea, Ui};
use hca::Automaton;
use layout::{AutomatonDrawing, approximate_text_width};
use plant::Model;

use crate::command::CommandSender;
use crate::panel::{Context, Panel, show_empty};
use crate::state::automaton::{Moment, Program};
use crate::theme::space;

/// The panel, with what concerns only it: the drawing and where it is scrolled to.
#[derive(Default)]
pub struct AutomatonPanel {
    drawn: Option<Drawn>,
    machines: Option<components::Machines>,
    canvas: canvas::Canvas,
    side: Side,
    /// Whether many runs were being made when the panel was last shown.
    was_sampling: bool,
}

/// What stands beside the automaton.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Side {
    /// The plant at the moment that is looked at.
    #[default]
    Plant,
    /// Many runs with chance.
    ManyRuns,
}

/// The drawing of the automaton that was laid out last.
struct Drawn {
    automaton: Automaton,
    drawing: AutomatonDrawing,
}

/// What the parts of the panel show.
#[derive(Clone, Copy)]
struct Shown<'a> {
    program: &'a Program,
    automaton: &'a Automaton,
    moment: &'a Moment,
}

impl Panel for AutomatonPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let state = &context.state.automaton;
        let Some(program) = state.program() else {
            show_empty(ui, context, "The text is a mission. A control program shows its automaton here.");
            return;
        };
        let Some((automaton, moment)) = program.automaton().zip(state.moment()) else {
            match program {
                Program::Plant(_) => show_empty(
                    ui,
                    context,
                    "The text describes a plant. Add a program below it to see the plant controlled.",
                ),
                _ => show_empty(ui, context, "The program has errors. See the problems."),
            }
            return;
        };
        let shown = Shown { program, automaton, moment };
        controls::show(ui, context, commands);
        let frame = Frame::new().fill(context.tokens.surface).inner_margin(Margin::symmetric(8, 4));
        egui::Panel::right("automaton-plant")
            .resizable(true)
            .default_size(356.0)
            .frame(frame)
            .show(ui, |ui| self.beside(ui, context, shown, commands));
        egui::Panel::bottom("automaton-log").resizable(true).default_size(170.0).frame(frame).show(
            ui,
            |ui| {
                log::show(ui, context, shown, commands);
            },
        );
        self.layout(automaton);
        if let Some(drawn) = &self.drawn {
            self.canvas.show(ui, context, shown, &drawn.drawing, commands);
        }
    }
}

impl AutomatonPanel {
    /// What stands beside the automaton.
    fn beside(&mut self, ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, commands: &mut CommandSender) {
        let is_sampling = context.state.automaton.chance.is_running();
        if is_sampling && !self.was_sampling {
            self.side = Side::ManyRuns;
        }
        self.was_sampling = is_sampling;
        let Some((model, plant)) = shown.program.model().zip(shown.moment.plant.as_ref()) else {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                goals(ui, context, shown);
                known::show(ui, context, shown.automaton, commands);
            });
            return;
        };
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.side, Side::Plant, "Plant");
            ui.selectable_value(&mut self.side, Side::ManyRuns, "Many runs");
        });
        let side = self.side;
        ScrollArea::vertical().id_salt(("automaton-side", side == Side::Plant)).auto_shrink(false).show(
            ui,
            |ui| {
                if side == Side::ManyRuns {
                    chance::show(ui, context, commands);
                    return;
                }
                goals(ui, context, shown);
                self.machines(ui, model).show(ui, context, plant, commands);
                evidence::show(ui, context, model, plant, commands);
            },
        );
    }

    fn machines(&mut self, ui: &Ui, model: &Model) -> &components::Machines {
        let known = self.machines.take().filter(|machines| machines.are_of(model));
        self.machines.insert(known.unwrap_or_else(|| components::Machines::new(ui, model)))
    }

    fn layout(&mut self, automaton: &Automaton) {
        if self.drawn.as_ref().is_some_and(|drawn| drawn.automaton == *automaton) {
            return;
        }
        let drawing = layout::automaton(automaton, &approximate_text_width);
        self.drawn = Some(Drawn { automaton: automaton.clone(), drawing });
    }
}

/// The title of a part.
fn title(ui: &mut Ui, context: &Context<'_>, text: &str, note: &str) {
    ui.add_space(space::S);
    ui.horizontal_wrapped(|ui| {
        ui.label(crate::theme::strong(text).color(context.tokens.text));
        if !note.is_empty() {
            ui.label(RichText::new(note).small().color(context.tokens.text_muted));
        }
    });
}

/// What the next step wants, and what it commands for that.
fn goals(ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>) {
    let tokens = context.tokens;
    let moment = shown.moment;
    if moment.marking.is_empty() {
        title(ui, context, "The program has ended", "nothing is marked");
        return;
    }
    title(ui, context, &format!("Step {}", moment.upcoming.step), "what is wanted, and what is commanded");
    let goals = moment.upcoming.goals.join(", ");
    let goals = if goals.is_empty() { "no goals".to_owned() } else { goals };
    ui.label(RichText::new(format!("Goals: {goals}")).color(tokens.text));
    let Some((model, plant)) = shown.program.model().zip(moment.plant.as_ref()) else { return };
    if let Some(commands) = &plant.next_commands {
        let text = format!("Commands: {}", log::commands_text(model, commands));
        ui.label(RichText::new(text).color(tokens.accent));
    }
    for (goal, reason) in &plant.unachievable {
        ui.label(RichText::new(format!("✗ {goal} is not pursued: {reason}")).color(tokens.warning));
    }
}
