//! Playing, pausing and stepping: who is driven, and what drives it.
//!
//! Five things run: time along the plan, time along the run of a mission, the recorded search, the growth of a path's
//! search tree, and a control program. Keys, the menu and the buttons of the timeline send a [`TransportCommand`], which
//! goes to the one [`Track`] that [`AppState::track`] names. Buttons that stand beside a drawing drive that drawing by
//! its own commands. Whatever plays continues by itself in [`AppState::advance`], whichever track the keys drive.

use crate::effect::Effect;
use crate::panel_kind::PanelKind;
use crate::state::AppState;
use crate::state::automaton::AutomatonCommand;
use crate::state::growth::GrowthCommand;
use crate::state::playback::{self, TransportCommand};
use crate::state::search::SearchCommand;
use crate::state::terrain::{Film, TerrainCommand};

/// What playing and stepping drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Track {
    /// The growth of the search tree that the terrain shows.
    Growth,
    /// The control program.
    Program,
    /// The recorded search.
    Search,
    /// Time, from entry to entry of the log of the run that is watched.
    Execution,
    /// Time, from event to event of the plan.
    Plan,
}

/// What continued by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Advanced {
    /// Whether something else is shown now.
    pub is_changed: bool,
    /// Seconds after which the next frame is due; `None` if nothing plays.
    pub next_secs: Option<f64>,
}

impl Advanced {
    fn also(&mut self, is_changed: bool, next_secs: f64) {
        self.is_changed |= is_changed;
        self.next_secs = Some(self.next_secs.map_or(next_secs, |secs| secs.min(next_secs)));
    }
}

/// Searches that take more steps a second than this are drawn in every frame.
const SMOOTH_STEPS_PER_SEC: f64 = 20.0;

impl AppState {
    /// Returns what the keys that play and step drive: a growth on the terrain while the user is there, a control
    /// program where there is one, the search while a step of it or its panel is looked at, and time otherwise.
    pub fn track(&self) -> Track {
        if self.terrain.growth.shown().is_some() && self.window.active_panel == PanelKind::Terrain {
            return Track::Growth;
        }
        if self.automaton.is_control() {
            return Track::Program;
        }
        let shows_time = matches!(self.window.active_panel, PanelKind::Timeline | PanelKind::Terrain);
        let shows_step = self.search.step().is_some() && !shows_time;
        match () {
            () if shows_step || self.window.active_panel == PanelKind::Search => Track::Search,
            () if self.is_executing() => Track::Execution,
            () => Track::Plan,
        }
    }

    /// Returns whether the track that the keys drive plays.
    pub fn is_playing(&self) -> bool {
        match self.track() {
            Track::Growth => self.terrain.growth.is_playing,
            Track::Program => self.automaton.is_playing,
            Track::Search => self.search.is_playing,
            Track::Execution | Track::Plan => self.playback.is_playing,
        }
    }

    /// Does what `command` asks for with the track that the keys drive.
    pub(crate) fn apply_to_transport(&mut self, command: TransportCommand) {
        match self.track() {
            Track::Growth => self.drive_growth(command),
            Track::Program => self.drive_program(command),
            Track::Search => self.drive_search(command),
            Track::Execution | Track::Plan => self.drive_time(command),
        }
    }

    fn drive_growth(&mut self, command: TransportCommand) {
        let command = match command {
            TransportCommand::TogglePlaying => GrowthCommand::TogglePlaying,
            TransportCommand::Step(forwards) => GrowthCommand::Step(if forwards { 1 } else { -1 }),
            TransportCommand::Start => GrowthCommand::GoTo(0),
            TransportCommand::End => GrowthCommand::GoTo(u32::MAX),
            TransportCommand::Speed(factor) => return self.playback.speed(factor),
        };
        self.apply_to_terrain(TerrainCommand::Growth(command));
    }

    fn drive_program(&mut self, command: TransportCommand) {
        let command = match command {
            TransportCommand::TogglePlaying => AutomatonCommand::TogglePlaying,
            TransportCommand::Step(forwards) => AutomatonCommand::Step(if forwards { 1 } else { -1 }),
            TransportCommand::Start => AutomatonCommand::GoTo(0),
            // The last of the steps that were taken: the program itself may never end.
            TransportCommand::End => AutomatonCommand::GoTo(self.automaton.moments().len().saturating_sub(1)),
            TransportCommand::Speed(factor) => return self.playback.speed(factor),
        };
        self.automaton.apply(command);
    }

    fn drive_search(&mut self, command: TransportCommand) {
        self.apply_to_search(match command {
            TransportCommand::TogglePlaying => SearchCommand::TogglePlaying,
            TransportCommand::Step(forwards) => SearchCommand::Step(if forwards { 1 } else { -1 }),
            TransportCommand::Start => SearchCommand::GoTo(0),
            TransportCommand::End => SearchCommand::GoTo(usize::MAX),
            TransportCommand::Speed(factor) => SearchCommand::SetSpeed(self.search.steps_per_sec * factor),
        });
    }

    fn drive_time(&mut self, command: TransportCommand) {
        match command {
            TransportCommand::TogglePlaying => self.playback.toggle(),
            TransportCommand::Step(forwards) => self.step_time(forwards),
            TransportCommand::Start => self.playback.seek(0.0),
            TransportCommand::End => self.playback.seek(f64::MAX),
            TransportCommand::Speed(factor) => self.playback.speed(factor),
        }
    }

    /// To the next or the previous moment of the plan, or of the run that is watched.
    fn step_time(&mut self, forwards: bool) {
        let now = self.playback.time;
        let times: Vec<f64> = match self.execution.run() {
            Some(run) if self.is_executing() => {
                run.log.iter().map(|entry| playback::number(entry.time)).collect()
            }
            _ => {
                let Some(plan) = self.shown().and_then(|shown| shown.plan()) else { return };
                plan.windows.iter().flatten().map(|window| playback::number(window.earliest)).collect()
            }
        };
        let times = times.into_iter();
        let next = if forwards {
            times.filter(|&time| time > now).reduce(f64::min)
        } else {
            times.filter(|&time| time < now).reduce(f64::max)
        };
        if let Some(time) = next {
            self.playback.seek(time);
        }
    }

    /// Ends the video that is recorded, and lets the user save it.
    pub(super) fn end_film(&mut self) {
        if let Some(Film::Rolling(_)) = self.terrain.film.take() {
            self.window.ask(Effect::SaveFilm { name: format!("{}.webm", self.mission) });
        }
    }

    /// Lets `seconds` of the host's clock go by for everything that plays.
    pub fn advance(&mut self, seconds: f64) -> Advanced {
        let mut advanced = Advanced::default();
        let rate = self.playback.rate;
        if self.search.is_playing {
            let shown = self.shown().cloned();
            let is_changed = self.search.advance(seconds, shown.as_ref());
            if is_changed {
                self.reveal_step();
            }
            let is_smooth = self.search.steps_per_sec > SMOOTH_STEPS_PER_SEC;
            advanced.also(is_changed, if is_smooth { 0.0 } else { 0.05 });
        }
        if self.terrain.growth.is_playing {
            advanced.also(self.terrain.growth.advance(seconds, rate), 0.02);
        }
        if self.automaton.is_playing {
            advanced.also(self.automaton.advance(seconds, rate), 0.05);
        }
        if self.playback.is_playing {
            self.playback.advance(seconds);
            advanced.also(true, 0.0);
            if !self.playback.is_playing && matches!(self.terrain.film, Some(Film::Rolling(_))) {
                self.end_film();
            }
        }
        if advanced.is_changed {
            self.derive();
        }
        advanced
    }
}
