//! The time that timeline, map and network show, and how it runs.

use exact::{Bound, Time};
use tpn::Plan;

/// A moment of the plan, in mission time units from its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playback {
    /// The time shown.
    pub time: f64,
    /// Whether time runs.
    pub is_playing: bool,
    /// How fast, relative to the normal speed that takes 30 seconds for a whole mission.
    pub rate: f64,
    /// Where it ends: the latest of the earliest times of its events.
    pub end: f64,
}

/// What can be asked of whatever plays and steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TransportCommand {
    /// Starts or stops.
    TogglePlaying,
    /// To the next moment (`true`) or the one before (`false`) at which something happens.
    Step(bool),
    Start,
    End,
    /// So many times as fast.
    Speed(f64),
}

/// Seconds that a whole mission takes at rate 1.
const NORMAL_RUN_SECS: f64 = 30.0;

/// How slow and how fast time can run; 1 is normal.
const RATES: [f64; 2] = [0.125, 64.0];

impl Default for Playback {
    fn default() -> Self {
        Self { time: 0.0, is_playing: false, rate: 1.0, end: 0.0 }
    }
}

impl Playback {
    /// Lets `seconds` of the host's clock go by. Stops at the end.
    pub fn advance(&mut self, seconds: f64) {
        if !self.is_playing {
            return;
        }
        self.time += seconds * self.rate * self.end / NORMAL_RUN_SECS;
        if self.time >= self.end {
            self.time = self.end;
            self.is_playing = false;
        }
    }

    /// Starts or stops; at the end it starts over.
    pub fn toggle(&mut self) {
        if !self.is_playing && self.time >= self.end {
            self.time = 0.0;
        }
        self.is_playing = !self.is_playing && self.end > 0.0;
    }

    /// Starts, at the end over again; nothing changes if time runs already.
    pub fn play(&mut self) {
        if !self.is_playing {
            self.toggle();
        }
    }

    /// Goes to a time within the plan.
    pub fn seek(&mut self, time: f64) {
        if time.is_finite() {
            self.time = time.clamp(0.0, self.end.max(0.0));
        }
    }

    /// Sets how fast time runs.
    pub fn set_rate(&mut self, rate: f64) {
        let [slowest, fastest] = RATES;
        self.rate = rate.clamp(slowest, fastest);
    }

    /// Lets time run so many times as fast.
    pub fn speed(&mut self, factor: f64) {
        self.set_rate(self.rate * factor);
    }

    /// Adapts to a plan or a run that ends then.
    pub fn fit(&mut self, end: f64) {
        self.end = end;
        self.time = self.time.min(end);
    }
}

/// When a plan ends: when its last event can happen at the earliest.
pub fn end(plan: &Plan) -> f64 {
    let earliest = |window: &Option<tpn::Window>| window.map(|window| number(window.earliest));
    plan.windows.iter().filter_map(earliest).fold(0.0, f64::max)
}

/// A rational as a float, for drawing only.
pub fn number(value: Time) -> f64 {
    value.to_f64()
}

/// A bound as a float, for drawing only.
pub fn bound(value: Bound) -> f64 {
    value.to_f64()
}
