//! A run against the environment: whoever looks chooses the environment's durations one by one, as the run goes, and
//! sees the executive act and wait. Timeline and network show the same run.

use std::collections::BTreeMap;

use egui::{Frame, Margin, RichText, ScrollArea, Slider, Ui};
use exact::Time;
use executive::{Act, Actor, Course, UnderWay};
use theme::icon::{self, Icon};
use theme::{space, strong};
use tpn::{ArcId, Network};
use workbench::command::{Command, CommandSender};
use workbench::state::pins::{event_name, names_of_events};
use workbench::state::playback::{bound, number};
use workbench::state::selection::duration_name;
use workbench::state::{PinCommand, Selection};
use workbench::time_text;

use crate::plan::{section, selectable_row};
use crate::{Context, Panel, show_empty};

/// The panel, with where the end of each duration is about to be put.
#[derive(Default)]
pub struct StrategyPanel {
    ends: BTreeMap<ArcId, f64>,
}

const EXPLANATION: &str = "You play the environment. Advance time, and end an uncontrolled activity \
                           whenever you like; the executive reacts. Anything you don't end runs to its \
                           maximum duration.";

impl Panel for StrategyPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let plan = context.snapshot.and_then(|it| Some((it.network.as_deref()?, it.plan()?)));
        let Some((network, plan)) = plan else {
            show_empty(ui, context, "No plan to run. The Plan panel explains why.");
            return;
        };
        if !plan.has_natures_choice(network) {
            let text = "This plan has no uncontrolled durations. Mark a duration contingent to let the \
                        environment choose it.";
            show_empty(ui, context, text);
            return;
        }
        let course = context.snapshot.and_then(|snapshot| context.state.pins.course(snapshot));
        let frame = Frame::new().inner_margin(Margin::symmetric(8, 4));
        frame.show(ui, |ui| {
            controls(ui, context, course, commands);
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                let Some(course) = course else {
                    ui.label(RichText::new(EXPLANATION).color(context.tokens.text_muted));
                    return;
                };
                self.natures(ui, context, network, course, commands);
                executives(ui, context, network, course, commands);
                happened(ui, context, network, course, commands);
            });
        });
    }
}

impl StrategyPanel {
    /// What the environment is choosing.
    fn natures(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        network: &Network,
        course: &Course,
        commands: &mut CommandSender,
    ) {
        section(ui, context, "Uncontrolled activities", "");
        self.ends.retain(|arc, _| course.under_way.iter().any(|it| it.natures == *arc));
        if course.under_way.is_empty() {
            let text = "No uncontrolled activity is in progress.";
            ui.label(RichText::new(text).color(context.tokens.text_muted));
        }
        for under_way in &course.under_way {
            self.duration(ui, context, network, (course, under_way), commands);
        }
    }

    /// A duration under way: when it may end, and the way to end it.
    fn duration(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        network: &Network,
        (course, under_way): (&Course, &UnderWay),
        commands: &mut CommandSender,
    ) {
        let tokens = context.tokens;
        let name = duration_name(network, under_way.natures);
        let arc = &network.arcs[under_way.natures.index()];
        let (from, to) = (number(under_way.window.earliest), bound(under_way.window.latest));
        let lasted = course.now.checked_sub(under_way.began).unwrap_or_default();
        let selection = arc.occurrence.map_or(Selection::Arc(under_way.natures), Selection::Occurrence);
        selectable_row(ui, context, &selection, RichText::new(&name).color(tokens.nature), commands);
        let range = format!(
            "elapsed {} of {}, ends at {}",
            time_text::short(lasted),
            time_text::interval(arc.lower, arc.upper),
            time_text::interval(under_way.window.earliest, under_way.window.latest)
        );
        ui.label(RichText::new(range).small().color(tokens.text_muted));
        ui.horizontal_wrapped(|ui| {
            let end = self.ends.entry(under_way.natures).or_insert(from);
            *end = end.clamp(from, to);
            if from < to {
                let slider = Slider::new(end, from..=to).show_value(false);
                ui.add(slider).accessible_name(format!("End time of {name}"));
            }
            let time = Time::from_f64_nearest(*end, 10).unwrap_or(under_way.window.earliest);
            let button = ui.button(format!("End at {}", time_text::short(time)));
            if button.accessible_name(format!("End {name} at {}", time_text::short(time))).clicked() {
                commands.send(Command::Pins(PinCommand::Pin(arc.to, time)));
            }
        });
    }
}

/// The present, and what moves it.
fn controls(ui: &mut Ui, context: &Context<'_>, course: Option<&Course>, commands: &mut CommandSender) {
    ui.horizontal_wrapped(|ui| {
        let begun = course.is_some();
        let is_over = course.is_some_and(|course| course.next.is_none());
        let buttons = [
            (Icon::ToStart, "Restart", PinCommand::ReleaseAll, begun),
            (Icon::StepBack, "Undo last step", PinCommand::TakeBack, begun),
        ];
        for (sign, name, command, is_enabled) in buttons {
            ui.add_enabled_ui(is_enabled, |ui| {
                if icon::button(ui, context.tokens, sign, name).clicked() {
                    commands.send(Command::Pins(command));
                }
            });
        }
        let go_on = if begun { "Advance time" } else { "Start run" };
        let button = ui.add_enabled(!is_over, egui::Button::new(go_on));
        if button.on_hover_text("Advance to the next event").clicked() {
            commands.send(Command::Pins(PinCommand::GoOn));
        }
        if let Some(course) = course {
            ui.add_space(space::M);
            ui.label(strong(format!("at {}", time_text::short(course.now))));
        }
    });
}

/// What the executive does next, and what it waits for.
fn executives(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    course: &Course,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    section(ui, context, "Executive", "");
    for waiting in &course.waiting {
        let text = format!(
            "{} waits for the end of {}, at the latest until {}",
            event_name(network, waiting.event),
            duration_name(network, waiting.natures),
            time_text::short(waiting.until)
        );
        let text = network.readable(&text);
        selectable_row(ui, context, &Selection::Node(waiting.event), RichText::new(text), commands);
    }
    match &course.next {
        None => {
            ui.label(strong("Run complete: the plan held.").color(tokens.good));
        }
        Some(next) => {
            let text = format!("next, unless an activity ends first: {}", act_text(network, next));
            let text = network.readable(&text);
            ui.label(RichText::new(text).color(tokens.text_muted));
        }
    }
}

/// What happened so far, the latest first.
fn happened(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    course: &Course,
    commands: &mut CommandSender,
) {
    section(ui, context, "History", "latest first");
    for act in course.acts.iter().rev().filter(|act| is_told(network, act)) {
        let color = match act.actor {
            Actor::Nature(_) => context.tokens.nature,
            Actor::Executive => context.tokens.text,
        };
        let text = RichText::new(act_text(network, act)).color(color);
        selectable_row(ui, context, &Selection::Node(act.events[0]), text, commands);
    }
}

/// Joints of the network that bear no name are no one's news.
fn is_told(network: &Network, act: &Act) -> bool {
    act.actor != Actor::Executive || !network.nodes[act.events[0].index()].events.is_empty()
}

fn act_text(network: &Network, act: &Act) -> String {
    let time = time_text::short(act.time);
    let mut names = names_of_events(network, &act.events);
    if let Actor::Nature(arc) = act.actor {
        let ended = duration_name(network, arc);
        let end = format!("{ended}.end");
        names.retain(|name| *name != end);
        names.insert(0, format!("the environment ends {ended}"));
    }
    format!("{time}  {}", names.join(", "))
}
