//! Intervals and moments as `PostgreSQL`, Python and ISO 8601 write them, in exact minutes.

use exact::{Rational, Time};

/// Seconds of a unit that is named beside its number.
fn seconds_of(unit: &str) -> Option<Rational> {
    match unit.strip_suffix('s').unwrap_or(unit) {
        "week" => Rational::new(7 * 86_400, 1),
        "day" => Rational::new(86_400, 1),
        "hour" | "hr" => Rational::new(3_600, 1),
        "minute" | "min" => Rational::new(60, 1),
        "second" | "sec" => Rational::new(1, 1),
        "millisecond" | "msec" => Rational::new(1, 1_000),
        "microsecond" | "usec" => Rational::new(1, 1_000_000),
        _ => None,
    }
}

/// Months or years, if there are none of them.
fn no_months(number: &str) -> Option<Time> {
    minutes(number, Rational::new(1, 1)?).filter(|length| *length == Time::ZERO)
}

fn minutes(number: &str, seconds_each: Rational) -> Option<Time> {
    if !number.starts_with(|first: char| first.is_ascii_digit()) {
        return None;
    }
    Time::from_units(number.parse().ok()?).checked_mul(seconds_each.checked_div(Rational::new(60, 1)?)?)
}

/// `1 day -02:30:00.5`, `-1 day, 23:00:00`, `7200 seconds 5 microseconds` or `P1DT2H`: parts are signed by themselves. Months and
/// years have no exact length, so only 0 of them are an interval.
pub(super) fn minutes_of(text: &str) -> Option<Time> {
    let text = text.trim();
    if let Some(parts) = text.strip_prefix('P') {
        return iso_minutes(parts);
    }
    let mut sum = Time::ZERO;
    let mut words =
        text.split(|it: char| it.is_whitespace() || it == ',').filter(|word| !word.is_empty()).peekable();
    words.peek()?;
    while let Some(word) = words.next() {
        let (is_negative, digits) = match word.strip_prefix('-') {
            Some(digits) => (true, digits),
            None => (false, word.strip_prefix('+').unwrap_or(word)),
        };
        let length = match digits.split(':').collect::<Vec<_>>().as_slice() {
            [_] => match words.next()? {
                "year" | "years" | "mon" | "mons" | "month" | "months" => no_months(digits)?,
                unit => minutes(digits, seconds_of(unit)?)?,
            },
            parts if parts.len() <= 3 => {
                let each = [Rational::new(3_600, 1), Rational::new(60, 1), Rational::new(1, 1)];
                let parts = parts.iter().zip(each).map(|(number, each)| minutes(number, each?));
                Time::checked_sum(parts.collect::<Option<Vec<Time>>>()?)?
            }
            _ => return None,
        };
        sum = if is_negative { sum.checked_sub(length)? } else { sum.checked_add(length)? };
    }
    Some(sum)
}

/// Returns what follows the `P`.
fn iso_minutes(parts: &str) -> Option<Time> {
    let (days, clock) = parts.split_once('T').unwrap_or((parts, ""));
    if days.is_empty() && clock.is_empty() || parts.ends_with('T') {
        return None;
    }
    let mut sum = Time::ZERO;
    let units: [(&str, &[(char, &str)]); 2] = [
        (days, &[('Y', "year"), ('M', "month"), ('W', "week"), ('D', "day")]),
        (clock, &[('H', "hour"), ('M', "minute"), ('S', "second")]),
    ];
    for (mut rest, units) in units {
        while !rest.is_empty() {
            let end = rest.find(|it: char| it.is_ascii_alphabetic())?;
            let letter = rest[end..].chars().next()?;
            let (_, unit) = units.iter().find(|(sign, _)| *sign == letter)?;
            let number = &rest[..end];
            let (is_negative, digits) = match number.strip_prefix('-') {
                Some(digits) => (true, digits),
                None => (false, number),
            };
            let length = match *unit {
                "year" | "month" => no_months(digits)?,
                unit => minutes(digits, seconds_of(unit)?)?,
            };
            sum = if is_negative { sum.checked_sub(length)? } else { sum.checked_add(length)? };
            rest = &rest[end + letter.len_utf8()..];
        }
    }
    Some(sum)
}

/// The minutes of a moment since the start of 1970 in UTC: a date, or a day of a year, with its time and maybe an offset.
pub(super) fn moment_of(text: &str) -> Option<Time> {
    let (date, clock) = text.trim().split_once(['T', ' '])?;
    let (clock, offset) = match clock.strip_suffix(['Z', 'z']) {
        Some(clock) => (clock, Time::ZERO),
        None => match clock.rfind(['+', '-']) {
            Some(at) if clock.is_char_boundary(at) => {
                let (clock, offset) = clock.split_at(at);
                let length = clock_minutes(&offset[1..])?;
                (clock, if offset.starts_with('-') { length.checked_neg()? } else { length })
            }
            _ => (clock, Time::ZERO),
        },
    };
    let days = Time::new(days_of(date)?.checked_mul(24 * 60)?, 1)?;
    days.checked_add(clock_minutes(clock)?)?.checked_sub(offset)
}

/// `05:30`, `05:30:00.5` or `0530`.
fn clock_minutes(text: &str) -> Option<Time> {
    if text.len() == 4 && text.bytes().all(|byte| byte.is_ascii_digit()) {
        return minutes_of(&format!("{}:{}", &text[..2], &text[2..]));
    }
    if !text.starts_with(|first: char| first.is_ascii_digit()) {
        return None;
    }
    // An offset may be of hours alone.
    minutes_of(&if text.contains(':') { text.to_owned() } else { format!("{text}:00") })
}

/// The days from the start of 1970 to a date of the Gregorian calendar.
fn days_of(date: &str) -> Option<i64> {
    let is_number = |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let parts: Vec<&str> = date.split('-').collect();
    if !parts.iter().all(is_number) {
        return None;
    }
    let year: i64 = parts.first().filter(|year| year.len() == 4)?.parse().ok()?;
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let before = year - 1;
    // Leap days of all years before this one, and those before 1970.
    let days = (year - 1970) * 365 + (before / 4 - before / 100 + before / 400) - 477;
    let lengths = [31, if is_leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let day_of_year: i64 = match parts.as_slice() {
        [_, day] if day.len() == 3 => day.parse().ok()?,
        [_, month, day] => {
            let month = month.parse::<usize>().ok().filter(|month| (1..=12).contains(month))?;
            let day: i64 = day.parse().ok()?;
            if !(1..=lengths[month - 1]).contains(&day) {
                return None;
            }
            lengths[..month - 1].iter().sum::<i64>() + day
        }
        _ => return None,
    };
    (1..=lengths.iter().sum()).contains(&day_of_year).then_some(days + day_of_year - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_read_exactly_or_not_at_all() {
        for (text, numerator, denominator) in [
            ("24:00:00", 24 * 60, 1),
            ("1 day 02:30:00", 26 * 60 + 30, 1),
            ("-1 days +00:00:30", -(24 * 60 * 2 - 1), 2),
            ("-1 day, 23:00:00", -60, 1),
            ("-00:00:00.000001", -1, 60_000_000),
            ("2 days", 2 * 24 * 60, 1),
            ("0:05", 5, 1),
            ("43200 seconds 0 microseconds", 720, 1),
            ("-30 seconds 500000 microseconds", -59, 120),
            ("1 week 1 hour", 7 * 24 * 60 + 60, 1),
            ("PT1H30M", 90, 1),
            ("P1DT-0.5S", 24 * 60 * 120 - 1, 120),
            ("P2W", 14 * 24 * 60, 1),
            ("P0Y0M0DT0H5M", 5, 1),
            ("P0Y0M", 0, 1),
            ("0 years 0 mons 1 days", 24 * 60, 1),
        ] {
            assert_eq!(minutes_of(text), Time::new(numerator, denominator), "{text}");
        }
        for text in [
            "",
            ",",
            "1y",
            "1 mon",
            "1 year 2 days",
            "5",
            "::",
            "1:2:3:4",
            "--1:00",
            "P",
            "PT",
            "P1Y",
            "P1M",
            "P1H",
            "PT1D",
            "PT5",
            "PT1é",
            "99999999999999999999:00:00",
            "1 s d",
        ] {
            assert_eq!(minutes_of(text), None, "{text}");
        }
    }

    #[test]
    fn moments_are_counted_over_leap_days_and_offsets() {
        let apart = |later: &str, earlier: &str| moment_of(later)?.checked_sub(moment_of(earlier)?);
        assert_eq!(moment_of("1970-01-01T00:00:00Z"), Time::new(0, 1));
        // 2004-01-25T05:05:00Z is 1075007100 s after 1970.
        assert_eq!(moment_of("2004-01-25T05:05:00+00:00"), Time::new(1_075_007_100, 60));
        assert_eq!(moment_of("2004-025T05:05:00"), moment_of("2004-01-25 05:05Z"));
        for (later, earlier, days) in [
            ("2024-03-01T00:00:00", "2024-02-28T00:00:00", 2),
            ("2023-03-01T00:00:00", "2023-02-28T00:00:00", 1),
            ("2100-03-01T00:00:00", "2100-02-28T00:00:00", 1),
            ("2001-01-01T00:00:00", "2000-01-01T00:00:00", 366),
            ("2030-003T00:00:00", "2030-001T00:00:00", 2),
            ("1970-01-01T00:00:00", "1969-12-31T00:00:00", 1),
        ] {
            assert_eq!(apart(later, earlier), Time::new(days * 24 * 60, 1), "{later} {earlier}");
        }
        assert_eq!(apart("2030-01-01T02:00:00+02:00", "2030-01-01T00:00:00.5Z"), Time::new(-1, 120));
        assert_eq!(apart("2030-01-01T00:00-0530", "2030-01-01T00:00+01"), Time::new(6 * 60 + 30, 1));
        for text in [
            "",
            "2030-01-01",
            "2030-13-01T00:00",
            "2030-02-29T00:00",
            "2030-366T00:00",
            "2030-000T00:00",
            "30-01-01T0:0",
            "2030-01-01T",
            "2030-01-01T+",
            "x",
        ] {
            assert_eq!(moment_of(text), None, "{text}");
        }
    }
}
