//! A control program as it runs: the automaton with its marking, the plant as it is believed to be, and all steps.
//!
//! Components can be made to fail and observations be changed, to see what the executive makes of it.

mod canvas;
mod chance;
mod components;
mod controls;
mod evidence;
mod hitting_sets;
mod known;
mod legend;
mod log;
mod machine;
mod marks;
mod proof;
mod trajectories;

use std::sync::Arc;

use display::{DisplayList, approximate_text_width};
use egui::{Frame, Margin, RichText, ScrollArea, Ui, Vec2, vec2};
use hca::{Automaton, CompositeId, Marking, TransitionId};
use layout::{AutomatonDrawing, AutomatonItem, AutomatonState};
use plant::Model;
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, Moment, Program, ProgramPart};

use crate::{Context, Panel, show_empty};

/// The panel, with what concerns only it: the drawing and where it is scrolled to.
#[derive(Default)]
pub struct AutomatonPanel {
    drawn: Option<Drawn>,
    machines: Option<components::Machines>,
    canvas: canvas::Canvas,
    /// The step that the log was scrolled to last.
    logged: usize,
    /// The step whose diagnosis was scrolled to.
    diagnosed: Option<u32>,
    /// For so many frames more the conflicts are brought into view: where they are is known once all above them was laid out.
    revealing: u8,
}

/// With less room than this, one part is shown at a time.
const MIN_ROOM: Vec2 = vec2(760.0, 320.0);
const REVEALING_FRAMES: u8 = 3;

/// The drawing of the automaton that was laid out last.
struct Drawn {
    automaton: Arc<Automaton>,
    drawing: AutomatonDrawing,
    /// The display list that was built last, and for what.
    listed: Option<(Listed, DisplayList)>,
}

/// What a display list of an automaton was built for.
#[derive(PartialEq)]
struct Listed {
    marking: Marking,
    fired: Vec<TransitionId>,
    preempted: Vec<CompositeId>,
    selected: Vec<AutomatonItem>,
}

impl Drawn {
    /// The display list at a moment with what is selected; built when either changes.
    fn list(&mut self, moment: &Moment, selected: Vec<AutomatonItem>) -> &DisplayList {
        let (fired, preempted) = moment
            .taken
            .as_ref()
            .map_or_else(Default::default, |taken| (taken.fired.clone(), taken.preempted.clone()));
        let wanted = Listed { marking: moment.marking.clone(), fired, preempted, selected };
        let kept = self.listed.take().filter(|(listed, _)| *listed == wanted);
        let (_, list) = self.listed.insert(kept.unwrap_or_else(|| {
            let state = AutomatonState {
                marking: Some(&wanted.marking),
                fired: &wanted.fired,
                preempted: &wanted.preempted,
                selected: &wanted.selected,
            };
            let list = layout::automaton_list(&self.drawing, &self.automaton, &state).indexed();
            (wanted, list)
        }));
        list
    }
}

/// What the parts of the panel show.
#[derive(Clone, Copy)]
struct Shown<'a> {
    program: &'a Program,
    automaton: &'a Arc<Automaton>,
    moment: &'a Moment,
}

impl Panel for AutomatonPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let state = &context.state.automaton;
        let Some(program) = state.program() else {
            if state.is_control() {
                show_empty(ui, context, "Compiling the program…");
                return;
            }
            show_empty(ui, context, "Open a control program to see its automaton. This text is a mission.");
            return;
        };
        let Some((automaton, moment)) = program.automaton().zip(state.moment()) else {
            match program {
                Program::Plant(_) => show_empty(
                    ui,
                    context,
                    "This text is a plant model. Add a control program below it to run both.",
                ),
                Program::Bound { .. } | Program::Unbound(_) => {
                    show_empty(ui, context, "Running the program…");
                }
                Program::Broken => show_empty(ui, context, "The program has errors. See the Problems panel."),
            }
            return;
        };
        let shown = Shown { program, automaton, moment };
        controls::show(ui, context, commands);
        self.layout(automaton);
        let room = ui.available_size();
        if room.x < MIN_ROOM.x || room.y < MIN_ROOM.y {
            self.one_part(ui, context, shown, commands);
            return;
        }
        let frame = Frame::new().fill(context.tokens.surface).inner_margin(Margin::symmetric(8, 4));
        egui::Panel::right("automaton-plant")
            .resizable(true)
            .default_size((room.x * 0.36).clamp(300.0, 356.0))
            .frame(frame)
            .show(ui, |ui| self.beside(ui, context, shown, commands));
        egui::Panel::bottom("automaton-log")
            .resizable(true)
            .default_size(170.0)
            .frame(frame)
            .show(ui, |ui| log::show(ui, context, shown, &mut self.logged, commands));
        self.drawing(ui, context, shown, commands);
    }
}

impl AutomatonPanel {
    /// One part at a time, with a row to choose it.
    fn one_part(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        shown: Shown<'_>,
        commands: &mut CommandSender,
    ) {
        let has_plant = shown.moment.plant.is_some();
        let parts = ProgramPart::ALL.into_iter().filter(|part| has_plant || !NEEDS_PLANT.contains(part));
        let part = context.state.automaton.part;
        let margin = Margin::symmetric(8, 2);
        Frame::new().inner_margin(margin).show(ui, |ui| {
            ui.horizontal(|ui| {
                for offered in parts {
                    choose(ui, offered, offered == part, has_plant, commands);
                }
            });
        });
        match part {
            ProgramPart::Automaton => self.drawing(ui, context, shown, commands),
            ProgramPart::Plant | ProgramPart::ManyRuns | ProgramPart::Proof => {
                Frame::new().inner_margin(margin).show(ui, |ui| self.side(ui, context, shown, commands));
            }
            ProgramPart::Steps => {
                Frame::new().inner_margin(margin).show(ui, |ui| {
                    log::show(ui, context, shown, &mut self.logged, commands);
                });
            }
        }
    }

    fn drawing(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        shown: Shown<'_>,
        commands: &mut CommandSender,
    ) {
        if let Some(drawn) = &mut self.drawn {
            self.canvas.show(ui, context, shown, drawn, commands);
        }
    }

    /// What is beside the automaton.
    fn beside(&mut self, ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, commands: &mut CommandSender) {
        if shown.moment.plant.is_some() {
            ui.horizontal(|ui| {
                let part = context.state.automaton.part;
                choose(ui, ProgramPart::Plant, !NEEDS_PLANT.contains(&part), true, commands);
                for offered in NEEDS_PLANT {
                    choose(ui, offered, offered == part, true, commands);
                }
            });
        }
        self.side(ui, context, shown, commands);
    }

    /// The plant, or many runs of it, or what is known where there is no plant.
    fn side(&mut self, ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, commands: &mut CommandSender) {
        let plant = shown.program.model().zip(shown.moment.plant.as_ref());
        let part = context.state.automaton.part;
        let of_runs = plant.filter(|_| NEEDS_PLANT.contains(&part)).map(|_| part);
        let mut area = ScrollArea::vertical()
            .id_salt(("automaton-side", of_runs.map(ProgramPart::name)))
            .auto_shrink(false);
        // What is found out in a step is brought into view, and what is believed after the next one again.
        let found = plant.filter(|(_, plant)| of_runs.is_none() && evidence::is_surprising(plant));
        let found = found.map(|_| shown.moment.upcoming.step);
        if found.is_none() && self.diagnosed.is_some() {
            area = area.vertical_scroll_offset(0.0);
        }
        let is_new = found.is_some() && found != self.diagnosed;
        self.diagnosed = found;
        if is_new {
            self.revealing = REVEALING_FRAMES;
        }
        let reveals = self.revealing > 0;
        if reveals {
            self.revealing -= 1;
            ui.ctx().request_repaint();
        }
        area.show(ui, |ui| {
            match of_runs {
                Some(ProgramPart::ManyRuns) => return chance::show(ui, context, commands),
                Some(_) => return proof::show(ui, context, commands),
                None => {}
            }
            goals(ui, context, shown);
            match plant {
                Some((model, plant)) => {
                    self.machines(ui, model).show(ui, context, plant, commands);
                    evidence::show(ui, context, model, plant, reveals, commands);
                }
                None => known::show(ui, context, shown.automaton, commands),
            }
        });
    }

    fn machines(&mut self, ui: &Ui, model: &Arc<Model>) -> &components::Machines {
        let known = self.machines.take().filter(|machines| machines.are_of(model));
        self.machines.insert(known.unwrap_or_else(|| components::Machines::new(ui, model)))
    }

    fn layout(&mut self, automaton: &Arc<Automaton>) {
        if self.drawn.as_ref().is_some_and(|drawn| Arc::ptr_eq(&drawn.automaton, automaton)) {
            return;
        }
        let drawing = layout::automaton(automaton, &approximate_text_width);
        self.drawn = Some(Drawn { automaton: Arc::clone(automaton), drawing, listed: None });
    }
}

/// The parts about all runs, or many of them, which need a plant.
const NEEDS_PLANT: [ProgramPart; 2] = [ProgramPart::ManyRuns, ProgramPart::Proof];

/// A part of the panel, to choose it.
fn choose(ui: &mut Ui, part: ProgramPart, is_chosen: bool, has_plant: bool, commands: &mut CommandSender) {
    let name = match part {
        ProgramPart::Automaton => "Automaton",
        ProgramPart::Plant if has_plant => "Plant",
        ProgramPart::Plant => "Observations",
        ProgramPart::ManyRuns => "Monte Carlo",
        ProgramPart::Proof => "Proof",
        ProgramPart::Steps => "Steps",
    };
    if theme::structure::choice(ui, is_chosen, name).clicked() {
        commands.send(Command::Automaton(AutomatonCommand::Show(part)));
    }
}

/// The title of a part.
fn title(ui: &mut Ui, context: &Context<'_>, text: &str, note: &str) {
    ui.add_space(space::S);
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::strong(text).color(context.tokens.text));
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
        title(ui, context, "Program ended", "no active locations");
        return;
    }
    let has_plant = moment.plant.is_some();
    let note = if has_plant { "goals and commands" } else { "goals" };
    title(ui, context, &format!("Step {}", moment.upcoming.step), note);
    let goals = moment.upcoming.goals.join(", ");
    let goals = if goals.is_empty() { "no goals".to_owned() } else { goals };
    ui.label(RichText::new(format!("Goals: {goals}")).color(tokens.text));
    let Some((model, plant)) = shown.program.model().zip(moment.plant.as_ref()) else { return };
    if let Some(commands) = &plant.next_commands {
        let text = format!("Commands: {}", log::commands_text(model, commands));
        ui.label(RichText::new(text).color(tokens.accent));
    }
    for (goal, reason) in &plant.unachievable {
        ui.label(RichText::new(format!("✗ Cannot pursue {goal}: {reason}")).color(tokens.warning));
    }
}
