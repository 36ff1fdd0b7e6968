//! Waivers: items that need attention and may be as they are until some day (SPEC 16.3).

use jiff::civil::Date;
use serde::Serialize;

use super::check::{can_lapse, day, day_of};
use super::record::{Act, Entry, LineKey, Record};

/// How a waiver stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WaiverState {
    InForce,
    /// In force, for a week at most.
    AboutToLapse,
    Lapsed,
}

impl WaiverState {
    /// The words for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::InForce => "in force",
            Self::AboutToLapse => "about to lapse",
            Self::Lapsed => "lapsed",
        }
    }

    /// Returns whether the item may be as it is.
    pub const fn is_in_force(self) -> bool {
        matches!(self, Self::InForce | Self::AboutToLapse)
    }
}

/// A waiver that has not been taken back.
#[derive(Clone, Copy, Debug)]
pub struct Waiver<'a> {
    /// Who waived the item and why.
    pub entry: &'a Entry,
    /// What is waived.
    pub line: &'a LineKey,
    /// The day, in UTC, on which it lapses.
    pub until: &'a str,
    pub state: WaiverState,
}

/// For so many days before it lapses, a waiver is about to lapse.
const DAYS_OF_NOTICE: i32 = 7;

impl Record {
    /// The day, in UTC, on which the entries were last checked.
    pub fn today(&self) -> Option<Date> {
        self.now().map(day_of)
    }

    /// Returns whether a waiver that is signed now can lapse on this day, such as `2026-01-31`.
    pub fn may_lapse_on(&self, text: &str) -> bool {
        day(text).is_some_and(|until| can_lapse(self.today(), until))
    }

    /// The waivers that count, oldest first.
    pub fn waivers(&self) -> Vec<Waiver<'_>> {
        let today = self.today();
        let mut waivers = Vec::new();
        for entry in self.standing_entries() {
            if let Act::Waive { line, until, .. } = &entry.act {
                waivers.push(Waiver { entry, line, until, state: state(until, today) });
            }
        }
        waivers
    }
}

fn state(until: &str, today: Option<Date>) -> WaiverState {
    match day(until).zip(today) {
        Some((until, today)) if today < until => {
            let days = (until - today).get_days();
            if days <= DAYS_OF_NOTICE { WaiverState::AboutToLapse } else { WaiverState::InForce }
        }
        _ => WaiverState::Lapsed,
    }
}
