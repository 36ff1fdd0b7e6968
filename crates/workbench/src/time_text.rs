//! Times as people read them.

use exact::{Bound, Time};
use rmpl::program::TimeUnit;

/// A time in mission units, exact: a decimal where there is one, otherwise a fraction.
pub fn time(value: Time) -> String {
    value.to_string()
}

/// A bound; infinity is `∞`.
pub fn bound(value: Bound) -> String {
    value.finite().map_or_else(|| "∞".to_owned(), time)
}

/// A time short enough for a table: exact if that is short, otherwise rounded and marked by `≈`.
pub fn short(value: Time) -> String {
    let exact = time(value);
    if exact.len() <= LONGEST_EXACT {
        return exact;
    }
    format!("≈ {:.2}", value.to_f64())
}

/// A bound short enough for a table.
pub fn short_bound(value: Bound) -> String {
    value.finite().map_or_else(|| "∞".to_owned(), short)
}

/// Characters of an exact number that a table has room for.
const LONGEST_EXACT: usize = 8;

/// `earliest` to `latest`, as intervals are written; each short enough for a table.
pub fn interval(earliest: Time, latest: Bound) -> String {
    format!("[{}, {}]", short(earliest), short_bound(latest))
}

/// Returns what is between the two, short enough for a table; `∞` if the latest is.
pub fn slack(earliest: Time, latest: Bound) -> String {
    match latest.checked_sub(earliest) {
        Some(slack) => short_bound(slack),
        None => format!("≈ {:.2}", latest.to_f64() - earliest.to_f64()),
    }
}

/// The short name of a unit.
pub fn unit(unit: TimeUnit) -> &'static str {
    match unit {
        TimeUnit::Minute => "min",
        TimeUnit::Second => "s",
    }
}

/// A moment while time plays, as `d:hh:mm:ss` without the parts that are zero at the front.
pub fn clock(value: f64, unit: TimeUnit) -> String {
    let total = (value * unit.seconds() as f64).round().max(0.0) as u64;
    let (days, hours, minutes, seconds) = (total / 86_400, total / 3600 % 24, total / 60 % 60, total % 60);
    if days > 0 {
        format!("{days}d {hours:02}:{minutes:02}:{seconds:02}")
    } else {
        format!("{hours:02}:{minutes:02}:{seconds:02}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_times_are_decimals_where_possible_and_fractions_otherwise() {
        assert_eq!(time(Time::new(819, 2).unwrap()), "409.5");
        assert_eq!(time(Time::new(1, 3).unwrap()), "1/3");
        assert_eq!(bound(Bound::Infinite), "∞");
        assert_eq!(short(Time::new(1_580_809, 15_000).unwrap()), "≈ 105.39");
        assert_eq!(short(Time::new(819, 2).unwrap()), "409.5");
        assert_eq!(slack(Time::from(10), Bound::Finite(Time::from(55))), "45");
    }

    #[test]
    fn the_clock_counts_days_only_when_there_are_any() {
        assert_eq!(clock(65.5, TimeUnit::Minute), "01:05:30");
        assert_eq!(clock(1500.0, TimeUnit::Minute), "1d 01:00:00");
        assert_eq!(clock(59.4, TimeUnit::Second), "00:00:59");
    }
}
