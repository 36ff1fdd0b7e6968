//! Calendar dates of mission times.

use exact::Time;
use jiff::{SignedDuration, Timestamp, civil, tz::TimeZone};
use rmpl::program::TimeUnit;

/// A time in milliseconds since the start of 1970, to the second, as `2026-01-02T03:04:05Z`; empty beyond the calendar.
pub fn utc_text(unix_millis: i64) -> String {
    let time = Timestamp::from_millisecond(unix_millis);
    time.map(|time| time.strftime("%Y-%m-%dT%H:%M:%SZ").to_string()).unwrap_or_default()
}

/// Returns whether the seconds of a date with time are 60.
fn is_leap_second(date: &str) -> bool {
    let clock = date.split_once(['T', 't', ' ']).map_or("", |(_, clock)| clock);
    let seconds = clock.split(':').nth(2).or_else(|| clock.get(4..)).unwrap_or_default();
    seconds.starts_with("60")
}

/// The moment at which a mission starts, and the unit that its times count from there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Calendar {
    epoch: Timestamp,
    unit: TimeUnit,
}

impl Calendar {
    /// Reads an ISO 8601 date, `2004-01-25`, or date with time, `2004-01-25T05:05:00Z`; without an offset it is UTC.
    /// `None` if it is neither, before the year 0, which dates of four digits cannot say, or a leap second, which has no
    /// moment of its own here.
    pub fn new(epoch: &str, unit: TimeUnit) -> Option<Self> {
        if is_leap_second(epoch) {
            return None;
        }
        let in_utc = || {
            let local: civil::DateTime = epoch.parse().ok()?;
            Some(local.to_zoned(TimeZone::UTC).ok()?.timestamp())
        };
        let epoch = epoch.parse::<Timestamp>().ok().or_else(in_utc)?;
        if epoch.to_zoned(TimeZone::UTC).year() < 0 {
            return None;
        }
        Some(Self { epoch, unit })
    }

    /// When a mission time is, to the millisecond before; `None` beyond the calendar.
    pub fn at(&self, time: Time) -> Option<Timestamp> {
        let millis = time.integer_parts(u32::try_from(self.unit.seconds()).ok()?.checked_mul(1000)?)?;
        self.epoch.checked_add(SignedDuration::from_millis(millis)).ok()
    }

    /// The start of the mission.
    pub fn epoch(&self) -> Timestamp {
        self.epoch
    }
}
