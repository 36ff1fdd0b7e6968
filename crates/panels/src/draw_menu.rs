//! The menu that a right click opens on a drawing, and the clipboard there: what can be made of the mission's activities,
//! and what each change does to the text.

use egui::accesskit::Role;
use egui::{Event, Response, RichText, Ui};
use rmpl::Span;
use snapshot::Snapshot;
use text_editing::TextCommand;
use tpn::OccurrenceKind;
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::drawing::{
    Callable, Change, DrawCommand, NEW_BOUNDS, Place, Wrapping, callables, conditions,
};
use workbench::state::editor::EditorCommand;
use workbench::state::placing::{NewThing, VehicleStart};
use workbench::state::terrain::TerrainCommand;

use crate::{Context, carry};

/// At most this many activities are listed to start after.
const MAX_LISTED: usize = 24;

/// Shows the menu of network and timeline while it is open. It is about the selection, which a right click sets.
pub(crate) fn activities(response: &Response, context: &Context<'_>, commands: &mut CommandSender) {
    response.context_menu(|ui| {
        ui.set_min_width(200.0);
        theme::structure::part(ui, Role::Menu, "Drawing");
        let Some(snapshot) = context.snapshot else { return };
        let mut menu = Menu { context, snapshot, commands };
        match context.state.drawn_statement() {
            Some(what) => menu.of_statement(ui, what),
            None => menu.of_scenario(ui),
        }
    });
}

/// Shows the menu of the terrain while it is open: about the location, the vehicle or the ground under the pointer.
pub(crate) fn terrain(
    response: &Response,
    context: &Context<'_>,
    at_m: Option<nalgebra::Point2<f64>>,
    commands: &mut CommandSender,
) {
    response.context_menu(|ui| {
        ui.set_min_width(200.0);
        theme::structure::part(ui, Role::Menu, "Map");
        let Some(snapshot) = context.snapshot else { return };
        let world = &snapshot.program.world;
        let mut menu = Menu { context, snapshot, commands };
        match &*context.state.selection {
            Selection::Location(name) => {
                for vehicle in &world.vehicles {
                    let vehicle = &vehicle.name.text;
                    menu.visit(ui, &format!("Send {vehicle} here"), vehicle, name);
                }
                menu.vehicles(ui, &VehicleStart::Location(name.clone()));
            }
            Selection::Vehicle(name) => {
                for location in &world.locations {
                    let location = &location.name.text;
                    menu.visit(ui, &format!("Send to {location}"), name, location);
                }
            }
            _ => {
                let Some(at_m) = at_m else { return };
                menu.place(ui, "Add location here", NewThing::Location(at_m));
                menu.vehicles(ui, &VehicleStart::Ground(at_m));
                let circle = NewThing::Circle { center_m: at_m, radius_m: 5.0 };
                menu.place(ui, "Add obstacle here", circle);
            }
        }
    });
}

/// Cut, copy and paste while network or timeline is the panel in use and no one types.
pub(crate) fn clipboard(ui: &Ui, context: &Context<'_>, commands: &mut CommandSender) {
    if !matches!(context.state.window.active_panel, PanelKind::Network | PanelKind::Timeline) {
        return;
    }
    ui.input_mut(|input| {
        input.events.retain(|event| {
            let command = match event {
                Event::Copy => DrawCommand::Copy { cut: false },
                Event::Cut => DrawCommand::Copy { cut: true },
                Event::Paste(text) => DrawCommand::Paste(text.clone()),
                _ => return true,
            };
            commands.send(Command::Draw(command));
            false
        });
    });
}

/// A menu while it is shown.
struct Menu<'a> {
    context: &'a Context<'a>,
    snapshot: &'a Snapshot,
    commands: &'a mut CommandSender,
}

impl Menu<'_> {
    fn of_statement(&mut self, ui: &mut Ui, what: Span) {
        let known = callables(&self.snapshot.program);
        self.additions(ui, "Add after", &known, Place::After(what));
        self.additions(ui, "Add before", &known, Place::Before(what));
        self.additions(ui, "Add at the same time", &known, Place::Beside(what));
        self.additions(ui, "Add alternative", &known, Place::Instead(what));
        ui.separator();
        self.command(ui, "Move earlier", DrawCommand::Shift { forwards: false });
        self.command(ui, "Move later", DrawCommand::Shift { forwards: true });
        submenu(ui, "Start after", |ui| {
            for (name, span) in self.others(what) {
                self.item(ui, &name, Change::Connect { from: span, to: what });
            }
        });
        self.item(ui, "Set duration", Change::Bound(what, NEW_BOUNDS.to_owned()));
        self.rename(ui, what);
        ui.separator();
        self.item(ui, "Wrap in choice", Change::Wrap(what, Wrapping::Choose));
        self.item(ui, "Make optional", Change::Wrap(what, Wrapping::Optional));
        self.item(ui, "Allow any order with next", Change::Wrap(what, Wrapping::Unordered));
        let conditions = conditions(&self.snapshot.program);
        if !conditions.is_empty() {
            submenu(ui, "Maintain", |ui| {
                for condition in conditions {
                    let wrapping = Wrapping::Maintaining(condition.clone());
                    self.item(ui, &condition, Change::Wrap(what, wrapping));
                }
            });
        }
        self.item(ui, "Remove surrounding construct", Change::Unwrap(what));
        ui.separator();
        self.command(ui, "Cut", DrawCommand::Copy { cut: true });
        self.command(ui, "Copy", DrawCommand::Copy { cut: false });
        self.item(ui, "Delete", Change::Delete(what));
    }

    fn of_scenario(&mut self, ui: &mut Ui) {
        let known = callables(&self.snapshot.program);
        self.additions(ui, "Add at the end", &known, Place::End);
        self.additions(ui, "Add thread", &known, Place::Thread);
        let world = &self.snapshot.program.world;
        for vehicle in &world.vehicles {
            submenu(ui, &format!("Send {} to", vehicle.name.text), |ui| {
                for location in &world.locations {
                    let location = &location.name.text;
                    self.visit(ui, location, &vehicle.name.text, location);
                }
            });
        }
    }

    /// Renames what is called, in all places.
    fn rename(&mut self, ui: &mut Ui, what: Span) {
        if entry(ui, "Rename…").clicked() {
            let at = what.start as usize;
            self.commands.send(Command::Text(TextCommand::Select { anchor: at, head: at }));
            self.commands.send(Command::Editor(EditorCommand::Rename));
            ui.close();
        }
    }

    /// What can be added at a place: a new activity, and the calls of those that are declared.
    fn additions(&mut self, ui: &mut Ui, title: &str, known: &[Callable], at: Place) {
        submenu(ui, title, |ui| {
            self.item(ui, "New activity", Change::New { at });
            self.item(ui, "Delay", Change::Insert { text: "delay[0,10]".to_owned(), at });
            if !known.is_empty() {
                ui.separator();
            }
            for callable in known {
                match callable.calls.as_slice() {
                    [call] => self.item(ui, call, Change::Insert { text: call.clone(), at }),
                    calls => {
                        submenu(ui, &callable.name, |ui| {
                            for call in calls {
                                self.item(ui, call, Change::Insert { text: call.clone(), at });
                            }
                        });
                    }
                }
            }
        });
    }

    /// The other activities that are written in the mission, each once.
    fn others(&self, what: Span) -> Vec<(String, Span)> {
        let occurrences = self.snapshot.network.iter().flat_map(|network| &network.occurrences);
        let mut found: Vec<(String, Span)> = Vec::new();
        for occurrence in occurrences {
            let is_call = matches!(occurrence.kind, OccurrenceKind::Primitive | OccurrenceKind::Activity);
            let Some(span) = occurrence.span.filter(|_| is_call && found.len() < MAX_LISTED) else {
                continue;
            };
            let is_own = what.contains(span);
            if !is_own && !found.iter().any(|(_, known)| *known == span) {
                let text = self.snapshot.source.get(span.range()).unwrap_or_default();
                found.push((text.split_whitespace().collect::<Vec<_>>().join(" "), span));
            }
        }
        found
    }

    /// A change, with what it does to the text.
    fn item(&mut self, ui: &mut Ui, label: &str, change: Change) {
        let context = self.context;
        let item =
            entry(ui, label).on_hover_ui(|ui| match carry::preview(ui.ctx(), context, &change).as_ref() {
                Ok(preview) => {
                    ui.label(RichText::new(preview.as_str()).monospace().small());
                }
                Err(reason) => {
                    ui.label(reason.as_str());
                }
            });
        if item.clicked() {
            self.commands.send(Command::Draw(DrawCommand::Make(change)));
            ui.close();
        }
    }

    fn command(&mut self, ui: &mut Ui, label: &str, command: DrawCommand) {
        if entry(ui, label).clicked() {
            self.commands.send(Command::Draw(command));
            ui.close();
        }
    }

    /// A drive of a vehicle to a location, and its visit there.
    fn visit(&mut self, ui: &mut Ui, label: &str, vehicle: &str, location: &str) {
        self.item(ui, label, Change::Visit { vehicle: vehicle.to_owned(), location: location.to_owned() });
    }

    /// A new vehicle of each model.
    fn vehicles(&mut self, ui: &mut Ui, start: &VehicleStart) {
        for model in &motion::VEHICLE_MODELS {
            let thing = NewThing::Vehicle { model: model.name.into(), start: start.clone() };
            self.place(ui, &format!("Add {} here", model.name), thing);
        }
    }

    fn place(&mut self, ui: &mut Ui, label: &str, thing: NewThing) {
        if entry(ui, label).clicked() {
            self.commands.send(Command::Terrain(TerrainCommand::Place { thing, again: false }));
            ui.close();
        }
    }
}

/// An entry of a menu.
fn entry(ui: &mut Ui, label: &str) -> Response {
    let item = ui.button(label);
    theme::structure::role(&item, Role::MenuItem);
    item
}

/// An entry that opens a menu of its own.
fn submenu(ui: &mut Ui, title: &str, entries: impl FnOnce(&mut Ui)) {
    let opener = ui.menu_button(title, entries).response;
    theme::structure::role(&opener, Role::MenuItem);
}
